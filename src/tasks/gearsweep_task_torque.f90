!> The task `torque`: at chosen speeds, the torque that the mesh takes from the pinion and gives to the gear, over time.
module gearsweep_task_torque
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use gearsweep_decimal, only: in_um
  use gearsweep_error, only: code_input, code_memory, error_t, fail
  use gearsweep_error_estimate, only: point_t
  use gearsweep_gear, only: drive
  use gearsweep_kinds, only: dp
  use gearsweep_lines, only: lines_t, right
  use gearsweep_memory, only: claim_memory
  use gearsweep_mesh_torque, only: find_torque, mesh_torque_t
  use gearsweep_oscillator, only: mesh_period
  use gearsweep_points, only: of_estimate, of_factor, of_periods, of_relief, of_speed, of_status, words_of
  use gearsweep_reader, only: reader_t
  use gearsweep_response, only: trace_motion
  use gearsweep_status, only: has_result, status_stopped
  use gearsweep_stop, only: wants_stop
  use gearsweep_table, only: each, no_number, over_and_over, table_t
  use gearsweep_task, only: check_reliefs, stages_t, task_info_t, task_t
  use gearsweep_text, only: str
  use gearsweep_trace, only: trace_t
  use gearsweep_uses, only: is_prescribed, needs_gears, unless
  implicit none
  private
  public :: torque_task_t

  type, extends(task_t) :: torque_task_t
  contains
    procedure, nopass :: describe
    procedure :: read_keys, check, run, add_report
    procedure, private :: fill_time, fill_points
  end type torque_task_t

  !> Of one relief and speed.
  type :: run_t
    type(point_t) :: point
    type(mesh_torque_t) :: mesh                  !< without rows where the point has no result
  end type run_t

  character(*), parameter :: group = 'torque'
  real(dp), parameter :: micro = 1e6_dp

contains

  pure subroutine describe(info)
    type(task_info_t), intent(out) :: info

    info = task_info_t(group, needs='geometry mesh reliefs amounts motion losses accuracy kept', tables='torque torque_points', &
                       fields='', gives='transmitted torque of both gears over time at chosen speeds, with friction''s share')
  end subroutine describe

  subroutine read_keys(self, reader, error)
    class(torque_task_t), intent(inout) :: self
    type(reader_t), intent(inout) :: reader
    type(error_t), allocatable, intent(inout) :: error

    call reader%add_group(group, 'The task torque: what the mesh takes from the pinion and gives to the gear.')
    call reader%get(group, 'rpm', self%own_rpm, error, unit='1/min', required=.true., tasks=group, &
                    refused=unless(.not. is_prescribed(reader), needs_gears), at_least=1e-6_dp, at_most=1e9_dp, max_size=1000, &
                    meaning='speeds of the pinion')
    if (allocated(self%own_rpm)) self%keep = self%own_rpm
    call self%read_reliefs(reader, group, error)
  end subroutine read_keys

  !> So many motions are followed and no more.
  subroutine check(self, amount, error)
    class(torque_task_t), intent(in) :: self
    real(dp), intent(in) :: amount(:)
    type(error_t), allocatable, intent(inout) :: error
    integer, parameter :: most = 10000
    integer :: reliefs

    call check_reliefs(self, amount, error)
    if (.not. allocated(self%own_rpm)) return
    reliefs = size(amount)
    if (allocated(self%own_relief)) reliefs = size(self%own_relief)
    if (size(self%own_rpm)*reliefs > most) call fail(error, code_input, &
      '&torque rpm: with '//str(reliefs)//' reliefs more than '//str(most)//' motions')
  end subroutine check

  subroutine run(self, stages, error)
    class(torque_task_t), intent(inout) :: self
    type(stages_t), intent(in) :: stages
    type(error_t), allocatable, intent(inout) :: error
    type(run_t), allocatable :: runs(:, :)                 ! (speed, relief)
    integer, allocatable :: which(:)
    integer :: i, k

    call self%list_reliefs(stages, which)
    call claim_memory(1000.0_dp*size(which)*size(self%own_rpm), '&torque rpm: '//str(size(which)*size(self%own_rpm))// &
                      ' motions', error)
    if (allocated(error)) return
    allocate (runs(size(self%own_rpm), size(which)))
    do i = 1, size(which)
      do k = 1, size(self%own_rpm)
        if (wants_stop(stages%accuracy%steady%stop)) return
        call follow(stages, which(i), self%own_rpm(k), runs(k, i), error)
        if (allocated(error)) return
        call stages%running%tell(1, stages%accuracy%steady%stop)
      end do
    end do
    call self%fill_time(stages, which, runs, error)
    call self%fill_points(stages, which, runs, error)
    self%is_done = .true.
    associate (status => runs%point%steady%status)
      self%is_stopped = any(status == status_stopped)
      self%failed = count(.not. has_result(status))
    end associate
    self%log = 'torque: '//str(size(runs))//' motions followed over time'
  end subroutine run

  !> The forces of the motion with relief number `relief` at a speed (1/min).
  subroutine follow(stages, relief, rpm, run, error)
    type(stages_t), intent(in) :: stages
    integer, intent(in) :: relief
    real(dp), intent(in) :: rpm
    type(run_t), intent(inout) :: run
    type(error_t), allocatable, intent(inout) :: error
    type(trace_t), allocatable :: trace(:)
    real(dp) :: duration
    logical :: lacks

    associate (motion => stages%motion(relief))
      duration = mesh_period(motion%mesh%teeth(1), rpm)
      call stages%find_point(relief, rpm, run%point, lacks)
      if (.not. lacks .and. has_result(run%point%steady%status)) then
        call trace_motion(motion, duration, stages%accuracy, run%point, trace, lacks)
        if (.not. lacks) call find_torque(motion, duration, trace, run%mesh)
      end if
    end associate
    if (lacks) call fail(error, code_memory, '&torque rpm = '//str(rpm)//': the memory does not hold the motion')
  end subroutine follow

  !> Torques over the time after which the motion repeats (Karpat et al. 2012, Fig. 6).
  subroutine fill_time(self, stages, which, runs, error)
    class(torque_task_t), intent(inout) :: self
    type(stages_t), intent(in) :: stages
    integer, intent(in) :: which(:)
    type(run_t), intent(in) :: runs(:, :)
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: values(:, :)
    real(dp) :: radius(2)
    integer :: i, k, from, n, rows

    radius = [(stages%pair%gear(i)%base_radius(drive), i=1, 2)]
    rows = 0
    do i = 1, size(runs, 2)
      rows = rows + sum([(rows_of(runs(k, i)), k=1, size(runs, 1))])
    end do
    associate (table => self%tables(self%place('torque')))
      call table%begin('transmitted torque over the time after which the motion repeats', rows, 10, error)
      if (allocated(error)) return
      allocate (values(rows, 10), source=no_number())
      from = 1
      do i = 1, size(runs, 2)
        do k = 1, size(runs, 1)
          n = rows_of(runs(k, i)) - 1
          values(from:from + n, 1) = in_um(stages%amount(which(i)))
          values(from:from + n, 2) = self%own_rpm(k)
          if (has_result(runs(k, i)%point%steady%status)) call fill_run(runs(k, i)%mesh, radius, &
            mesh_period(stages%motion(1)%mesh%teeth(1), self%own_rpm(k)), values(from:from + n, 3:))
          from = from + n + 1
        end do
      end do
      call table%add_index('relief_um', 'um', of_relief, values(:, 1))
      call table%add_index('rpm', '1/min', of_speed, values(:, 2))
      call table%add_index('tau', '', 'time in mesh periods since a pair entered at A; both ends of each step', values(:, 3))
      call table%add('time_s', 's', 'the same time', values(:, 4))
      call table%add('pinion_torque_nm', 'N*m', 'torque that the mesh takes from the pinion', values(:, 5))
      call table%add('gear_torque_nm', 'N*m', 'torque that the mesh gives to the gear', values(:, 6))
      call table%add('pinion_friction_nm', 'N*m', 'friction''s share of the pinion''s torque', values(:, 7))
      call table%add('gear_friction_nm', 'N*m', 'friction''s share of the gear''s torque', values(:, 8))
      call table%add('pinion_damping_nm', 'N*m', 'what damping carries of the pinion''s torque; of the gear''s it carries as '// &
                     'much as the base radii have it', values(:, 9))
      call table%add('dte_um', 'um', 'dynamic transmission error along the line of action, without the turning of whole '// &
                     'gears about their bores', values(:, 10))
    end associate
  end subroutine fill_time

  !> A row of nothing where there is no result.
  pure integer function rows_of(run)
    type(run_t), intent(in) :: run

    rows_of = 1
    if (allocated(run%mesh%tau)) rows_of = size(run%mesh%tau)
  end function rows_of

  !> Time (mesh periods, s), torques of both gears, friction's shares, damping's (N m), and the transmission error (um).
  pure subroutine fill_run(mesh, radius, period, values)
    type(mesh_torque_t), intent(in) :: mesh
    real(dp), intent(in) :: radius(2)            ! base radii, m
    real(dp), intent(in) :: period               ! s
    real(dp), intent(inout) :: values(:, :)      ! (row, column)
    integer :: i

    values(:, 1) = mesh%tau
    values(:, 2) = mesh%tau*period
    do i = 1, 2
      values(:, 2 + i) = radius(i)*(mesh%elastic + mesh%damping + mesh%friction(i, :))
      values(:, 4 + i) = radius(i)*mesh%friction(i, :)
    end do
    values(:, 7) = radius(1)*mesh%damping
    values(:, 8) = micro*mesh%error
  end subroutine fill_run

  !> A row for each relief and speed: mean, least and largest torque, and what the mesh loses.
  subroutine fill_points(self, stages, which, runs, error)
    class(torque_task_t), intent(inout) :: self
    type(stages_t), intent(in) :: stages
    integer, intent(in) :: which(:)
    type(run_t), intent(in) :: runs(:, :)
    type(error_t), allocatable, intent(inout) :: error
    real(dp) :: values(size(runs), 9)
    real(dp), dimension(size(runs)) :: factor, estimate
    integer, dimension(size(runs)) :: status, periods
    integer :: i, k, member, row

    values = no_number()
    do i = 1, size(runs, 2)
      do k = 1, size(runs, 1)
        row = (i - 1)*size(runs, 1) + k
        if (.not. allocated(runs(k, i)%mesh%tau)) cycle
        do member = 1, 2
          values(row, 4*member - 3:4*member) = stages%pair%gear(member)%base_radius(drive)*figures(runs(k, i)%mesh, member)
        end do
        values(row, 9) = 1 - runs(k, i)%mesh%mean(2)/runs(k, i)%mesh%mean(1)
      end do
    end do
    factor = [((runs(k, i)%point%dynamic_factor, k=1, size(runs, 1)), i=1, size(runs, 2))]
    estimate = [((runs(k, i)%point%estimate, k=1, size(runs, 1)), i=1, size(runs, 2))]
    status = [((runs(k, i)%point%steady%status, k=1, size(runs, 1)), i=1, size(runs, 2))]
    periods = [((runs(k, i)%point%steady%periods, k=1, size(runs, 1)), i=1, size(runs, 2))]
    where (.not. has_result(status))
      factor = no_number()
      estimate = no_number()
    end where
    associate (table => self%tables(self%place('torque_points')), m => size(runs, 2), n => size(runs, 1))
      call table%begin('mean, least and largest transmitted torque at the speeds of the task torque', m*n, 16, error, &
                       extent=[m, n])
      if (allocated(error)) return
      call table%add_index('relief_um', 'um', of_relief, each(in_um(stages%amount(which)), n))
      call table%add_index('rpm', '1/min', of_speed, over_and_over(self%own_rpm, m))
      call add_member('pinion', values(:, 1:4), table)
      call add_member('gear', values(:, 5:8), table)
      call table%add('friction_loss', '', 'part of the pinion''s power that friction between the flanks takes', values(:, 9))
      call table%add('dynamic_factor', '', of_factor, factor)
      call table%add('error_estimate', '', of_estimate, estimate)
      call table%add_words('status', of_status, words_of(status))
      call table%add('mesh_periods', '', of_periods, periods)
    end associate
  end subroutine fill_points

  pure subroutine add_member(name, values, table)
    character(*), intent(in) :: name
    real(dp), contiguous, intent(in) :: values(:, :)   ! mean, least, largest, friction's share, N m; (row, 4)
    type(table_t), intent(inout) :: table

    call table%add(name//'_mean_nm', 'N*m', 'mean torque of the '//name//'; without friction it is the static one', values(:, 1))
    call table%add(name//'_least_nm', 'N*m', 'least torque at the ends of the steps', values(:, 2))
    call table%add(name//'_largest_nm', 'N*m', 'largest torque at the ends of the steps', values(:, 3))
    call table%add(name//'_friction_mean_nm', 'N*m', 'friction''s share of the mean torque', values(:, 4))
  end subroutine add_member

  !> Mean, least and largest force on a member, and friction's mean share (N).
  pure function figures(mesh, member)
    type(mesh_torque_t), intent(in) :: mesh
    integer, intent(in) :: member
    real(dp) :: figures(4)
    real(dp), allocatable :: force(:)

    force = mesh%elastic + mesh%damping + mesh%friction(member, :)
    figures = [mesh%mean(member), minval(force), maxval(force), mesh%mean_friction(member)]
  end function figures

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
