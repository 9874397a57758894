!> The task `torque`: at chosen speeds, the torque that the mesh takes from the pinion and gives to the gear, over time.
module gearsweep_task_torque
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use gearsweep_error, only: code_input, code_memory, error_t, fail
  use gearsweep_gear, only: drive
  use gearsweep_kinds, only: dp
  use gearsweep_largest_motion, only: find_point
  use gearsweep_lines, only: lines_t, right
  use gearsweep_memory, only: claim_memory
  use gearsweep_mesh_torque, only: find_torque, mesh_torque_t
  use gearsweep_oscillator, only: mesh_period
  use gearsweep_points, only: add_several
  use gearsweep_reader, only: reader_t
  use gearsweep_response, only: trace_motion
  use gearsweep_status, only: has_result, status_stopped
  use gearsweep_stop, only: wants_stop
  use gearsweep_table, only: table_t
  use gearsweep_stages, only: runnable_t, stages_t
  use gearsweep_task, only: case_facts_t, check_reliefs, stage, task_info_t
  use gearsweep_text, only: str
  use gearsweep_torque_tables, only: fill_harmonics, fill_points, fill_time, harmonic_bytes, row_bytes, torque_run_t
  use gearsweep_trace, only: trace_t
  use gearsweep_uses, only: is_prescribed, needs_gears, sentence_length, unless
  implicit none
  private
  public :: torque_task_t

  type, extends(runnable_t) :: torque_task_t
    integer :: harmonics = 8                     !< of the mesh frequency
  contains
    procedure, nopass :: describe
    procedure :: read_keys, check, run, add_report
  end type torque_task_t

  character(*), parameter :: group = 'torque'

contains

  pure subroutine describe(info)
    type(task_info_t), intent(out) :: info

    info = task_info_t(group, needs=[stage%geometry, stage%mesh, stage%reliefs, stage%amounts, stage%motion, stage%losses, &
                                     stage%accuracy], &
                       tables='torque torque_points torque_harmonics', fields='', &
                       gives='transmitted torque of both gears over time at chosen speeds, with friction''s share, and its '// &
                       'harmonics')
  end subroutine describe

  subroutine read_keys(self, reader, error)
    class(torque_task_t), intent(inout) :: self
    type(reader_t), intent(inout) :: reader
    type(error_t), allocatable, intent(inout) :: error
    character(sentence_length) :: geared

    geared = unless(.not. is_prescribed(reader), needs_gears)
    call reader%add_group(group, 'The task torque: what the mesh takes from the pinion and gives to the gear.')
    call reader%get(group, 'rpm', self%own_rpm, error, unit='1/min', required=.true., tasks=group, &
                    refused=geared, at_least=1e-6_dp, at_most=1e9_dp, max_size=1000, distinct=.true., &
                    meaning='speeds of the pinion')
    call self%read_reliefs(reader, group, error)
    call reader%get(group, 'harmonics', self%harmonics, error, tasks=group, refused=geared, at_least=1, at_most=1000, &
                    meaning='harmonics of the mesh frequency in the table torque_harmonics')
  end subroutine read_keys

  !> So many motions are followed and no more.
  subroutine check(self, facts, error)
    class(torque_task_t), intent(in) :: self
    type(case_facts_t), intent(in) :: facts
    type(error_t), allocatable, intent(inout) :: error
    integer, parameter :: most = 10000
    integer :: reliefs

    call check_reliefs(self, facts, error)
    if (.not. allocated(self%own_rpm)) return
    reliefs = size(facts%amount)
    if (allocated(self%own_relief)) reliefs = size(self%own_relief)
    if (size(self%own_rpm)*reliefs > most) call fail(error, code_input, &
      '&torque rpm: with '//str(reliefs)//' reliefs more than '//str(most)//' motions')
  end subroutine check

  subroutine run(self, stages, error)
    class(torque_task_t), intent(inout) :: self
    type(stages_t), intent(in) :: stages
    type(error_t), allocatable, intent(inout) :: error
    type(torque_run_t), allocatable :: runs(:)             ! of the first relief, one for each speed, and so on
    real(dp), parameter :: fewest_rows = 400
    real(dp) :: radius(2)
    integer, allocatable :: which(:)
    integer :: i, k, n

    call self%list_reliefs(stages, which)
    n = size(which)*size(self%own_rpm)
    call claim_memory((row_bytes*fewest_rows + harmonic_bytes*self%harmonics)*n, '&torque rpm: '//str(n)//' motions', error)
    if (allocated(error)) return
    allocate (runs(n))
    n = 0
    do i = 1, size(which)
      do k = 1, size(self%own_rpm)
        if (wants_stop(stages%accuracy%steady%stop)) return
        n = n + 1
        call follow(stages, which(i), self%own_rpm(k), self%harmonics, runs(n), error)
        if (allocated(error)) return
        call stages%running%tell(1, stages%accuracy%steady%stop)
      end do
    end do
    radius = [(stages%pair%gear(i)%base_radius(drive), i=1, 2)]
    call fill_time(runs, radius, self%tables(self%place('torque')), error)
    call fill_points(runs, size(self%own_rpm), radius, self%tables(self%place('torque_points')), error)
    call fill_harmonics(runs, radius, self%tables(self%place('torque_harmonics')), error)
    self%is_done = .true.
    associate (status => runs%point%steady%status)
      self%is_stopped = any(status == status_stopped)
      self%failed = count(.not. has_result(status))
    end associate
    self%log = 'torque: '//str(size(runs))//' motions followed over time'
  end subroutine run

  !> The forces of the motion with relief number `relief` at a speed (1/min), and in half as many steps what is read off them.
  subroutine follow(stages, relief, rpm, harmonics, run, error)
    type(stages_t), intent(in) :: stages
    integer, intent(in) :: relief
    real(dp), intent(in) :: rpm
    integer, intent(in) :: harmonics             ! of the mesh frequency
    type(torque_run_t), intent(inout) :: run
    type(error_t), allocatable, intent(inout) :: error
    type(trace_t), allocatable :: trace(:)
    type(mesh_torque_t) :: half
    logical :: lacks

    associate (motion => stages%motion(relief))
      run%relief = stages%amount(relief)
      run%rpm = rpm
      run%period = mesh_period(motion%mesh%teeth(1), rpm)
      call find_point(motion, rpm, stages%accuracy, run%point, run%motions, lacks)
      if (.not. lacks .and. has_result(run%point%steady%status)) then
        run%left_open = stages%load*(stages%accuracy%steady%tolerance + run%point%estimate - run%point%step_error)
        call trace_motion(motion, run%period, stages%accuracy, run%point, trace, lacks, in_half=.true.)
        if (.not. lacks) then
          call find_torque(motion, run%period, trace, harmonics*size(trace), half)
          run%half = half%force
          call trace_motion(motion, run%period, stages%accuracy, run%point, trace, lacks)
        end if
        if (.not. lacks) call find_torque(motion, run%period, trace, harmonics*size(trace), run%mesh)
      end if
    end associate
    if (lacks) call fail(error, code_memory, '&torque rpm = '//str(rpm)//': the memory does not hold the motion')
  end subroutine follow

  pure subroutine add_report(self, lines)
    class(torque_task_t), intent(in) :: self
    type(lines_t), intent(inout) :: lines
    integer :: row

    call lines%add('')
    call lines%add('Transmitted torque (N m): mean, least to largest')
    call lines%add('   relief um         rpm      pinion                      gear                        friction loss')
    associate (points => self%tables(self%place('torque_points')))
      do row = 1, points%rows
        call lines%put(right(str(points%number('relief_um', row)), 12)//right(str(points%number('rpm', row)), 12)//'   ')
        if (ieee_is_nan(points%number('pinion_mean_nm', row))) then
          call lines%add('   '//trim(points%word('status', row)))
          cycle
        end if
        call lines%add('   '//torques('pinion', points, row)//torques('gear', points, row)// &
                       str(points%number('friction_loss', row), 4))
      end do
      call add_several(points, lines)
    end associate
  end subroutine add_report

  pure function torques(member, points, row) result(words)
    character(*), intent(in) :: member
    type(table_t), intent(in) :: points
    integer, intent(in) :: row
    character(28) :: words

    words = str(points%number(member//'_mean_nm', row), 5)//', '//str(points%number(member//'_least_nm', row), 5)//' to '// &
            str(points%number(member//'_largest_nm', row), 5)
  end function torques
end module gearsweep_task_torque
