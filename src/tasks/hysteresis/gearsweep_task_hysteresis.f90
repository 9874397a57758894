!> The task `hysteresis`: the steady motions that a slow run up through the speeds and one down meet, and where they
!> change (see gearsweep_continuation).
module gearsweep_task_hysteresis
  use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
  use gearsweep_continuation, only: branch_options_t, branch_t, follow_branch
  use gearsweep_decimal, only: in_um
  use gearsweep_error, only: code_input, code_memory, error_t, fail
  use gearsweep_error_estimate, only: point_t
  use gearsweep_hysteresis_ramps, only: fill_delays, fill_ramps, ramps_t, run_ramps
  use gearsweep_kinds, only: dp
  use gearsweep_lines, only: left, lines_t, right
  use gearsweep_memory, only: claim_memory
  use gearsweep_oscillator, only: mesh_period
  use gearsweep_ramp, only: periods_of_ramp, ramp_options_t
  use gearsweep_reader, only: reader_t
  use gearsweep_status, only: has_result, status_name, status_stopped
  use gearsweep_sweep, only: contact_name, contact_of
  use gearsweep_table, only: axis, table_t
  use gearsweep_stages, only: runnable_t, stages_t
  use gearsweep_task, only: stage, task_info_t
  use gearsweep_text, only: fixed, str
  implicit none
  private
  public :: hysteresis_task_t

  type, extends(runnable_t) :: hysteresis_task_t
    real(dp) :: jump = 0.02_dp                   !< of the dynamic factor, from which on a motion is another one
    real(dp) :: closeness = 1e-6_dp              !< of the speeds before and after a change, relative
    real(dp) :: rate = 0                         !< of the speed on a ramp, (1/min)/s; 0: there is none
  contains
    procedure, nopass :: describe
    procedure :: read_keys, run, add_report
  end type hysteresis_task_t

  character(*), parameter :: group = 'hysteresis'
  character(4), parameter :: ways(2) = [character(4) :: 'up', 'down']
  integer, parameter :: word = 12

contains

  pure subroutine describe(info)
    type(task_info_t), intent(out) :: info

    info = task_info_t(group, needs=[stage%mesh, stage%reliefs, stage%amounts, stage%motion, stage%losses, stage%accuracy, &
                                     stage%speeds], &
      tables='hysteresis hysteresis_changes hysteresis_ramps hysteresis_delays', fields='', &
      gives='the steady motions that a slow run up through the speeds and one down meet, and the speeds at which they change')
  end subroutine describe

  subroutine read_keys(self, reader, error)
    class(hysteresis_task_t), intent(inout) :: self
    type(reader_t), intent(inout) :: reader
    type(error_t), allocatable, intent(inout) :: error

    call reader%add_group(group, 'The task hysteresis, over the speeds of &sweep, up and down, or its own.')
    call self%read_speeds(reader, group, error)
    call self%read_reliefs(reader, group, error)
    call reader%get(group, 'jump', self%jump, error, tasks=group, at_least=1e-6_dp, at_most=1e6_dp, &
                    meaning='a motion is another one where the dynamic factor changes by more at once')
    call reader%get(group, 'closeness', self%closeness, error, tasks=group, at_least=1e-12_dp, at_most=1.0_dp, &
                    meaning='largest relative distance of the speeds before and after a change')
    call reader%get(group, 'ramp_rpm_s', self%rate, error, unit='1/min/s', tasks=group, above=0.0_dp, at_most=1e9_dp, &
                    otherwise='none', meaning='rate of runs in which the speed changes at this rate, beside the slow ones')
  end subroutine read_keys

  subroutine run(self, stages, error)
    class(hysteresis_task_t), intent(inout) :: self
    type(stages_t), intent(in) :: stages
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: rpm(:)              ! ascending
    real(dp), allocatable :: period(:)           ! mesh periods at the speeds, s
    real(dp), allocatable :: relief(:)           ! m
    type(branch_t), allocatable :: branch(:, :)  ! up and down, for each relief; its points in the direction of travel
    type(ramps_t), allocatable :: ramps(:, :)    ! the same
    integer, allocatable :: which(:)
    integer :: i, way

    call self%list_speeds(stages, rpm)
    call self%list_reliefs(stages, which)
    period = mesh_period(stages%motion(1)%mesh%teeth(1), rpm)
    allocate (branch(2, size(which)), ramps(2, size(which)))
    call check_ramp(self, stages, rpm, error)
    if (allocated(error)) return
    associate (n => size(rpm))
      do i = 1, size(which)
        do way = 1, 2
          call follow_branch(stages%motion(which(i)), merge(rpm, rpm(n:1:-1), way == 1), &
                             branch_options_t(stages%accuracy, self%jump, self%closeness), branch(way, i))
          if (branch(way, i)%lacks) call fail(error, code_memory, '&hysteresis: the memory does not hold the motions')
          if (allocated(error)) return
          self%failed = self%failed + count(.not. has_result(branch(way, i)%point%steady%status))
          if (any(branch(way, i)%point%steady%status == status_stopped)) return
          if (.not. self%rate > 0) cycle
          call run_ramps(stages%motion(which(i)), merge(rpm, rpm(n:1:-1), way == 1), branch(way, i), self%jump, &
                         ramp_options_t(self%rate, stop=stages%accuracy%steady%stop), ramps(way, i))
          if (ramps(way, i)%coarse%stopped .or. ramps(way, i)%fine%stopped) return
          if (ramps(way, i)%coarse%lacks .or. ramps(way, i)%fine%lacks) &
            call fail(error, code_memory, '&hysteresis ramp_rpm_s: the memory does not hold the steps')
          if (allocated(error)) return
        end do
        call stages%running%tell(n, stages%accuracy%steady%stop)
      end do
    end associate
    relief = stages%amount(which)
    call fill_motions(rpm, period, relief, branch, self%tables(self%place('hysteresis')), error)
    call fill_changes(relief, branch, self%tables(self%place('hysteresis_changes')), error)
    if (self%rate > 0) then
      call fill_ramps(rpm, relief, ramps, self%tables(self%place('hysteresis_ramps')), error)
      call fill_delays(relief, branch, ramps, self%rate, self%tables(self%place('hysteresis_delays')), error)
    end if
    self%is_done = .true.
    self%log = 'hysteresis: '//str(size(branch))//' runs through '//str(size(rpm))//' speeds'
  end subroutine run

  !> A ramp is no longer than can be followed.
  subroutine check_ramp(self, stages, rpm, error)
    class(hysteresis_task_t), intent(in) :: self
    type(stages_t), intent(in) :: stages
    real(dp), intent(in) :: rpm(:)
    type(error_t), allocatable, intent(inout) :: error
    real(dp), parameter :: most = 1e7_dp
    real(dp) :: periods

    if (.not. self%rate > 0) return
    periods = periods_of_ramp(stages%motion(1), rpm, self%rate)
    if (periods > most) call fail(error, code_input, '&hysteresis ramp_rpm_s = '//str(self%rate)//': from '// &
      str(rpm(1))//' to '//str(rpm(size(rpm)))//' rpm are '//str(periods, 3)//' mesh periods; at most '//str(most)// &
      ' can be followed')
  end subroutine check_ramp

  !> A row for each relief, direction and speed.
  pure subroutine fill_motions(rpm, period, relief, branch, table, error)
    real(dp), intent(in) :: rpm(:), period(:), relief(:)   ! 1/min, s, m
    type(branch_t), intent(in) :: branch(:, :)
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    type(point_t), allocatable :: point(:)
    real(dp), allocatable :: values(:, :)
    character(word), allocatable :: words(:, :)
    integer :: n, rows, row, i, way, k

    n = size(rpm)
    rows = n*size(branch)
    call table%over('steady motions that a slow run up through the speeds and one down meet', error, &
                    axis('relief_um', 'um', 'tip relief, as amount_um of the case', in_um(relief)), &
                    axis('direction', '', 'of the slow run through the speeds', ways), &
                    axis('rpm', '1/min', 'speed of the pinion', rpm))
    if (.not. allocated(error)) call claim_memory(100.0_dp*rows, 'the table hysteresis', error)
    if (allocated(error)) return
    allocate (values(rows, 6), words(rows, 2))
    row = 0
    do i = 1, size(relief)
      do way = 1, 2
        point = branch(way, i)%point
        if (way == 2) point = point(n:1:-1)
        do k = 1, n
          row = row + 1
          associate (steady => point(k)%steady)
            values(row, 1:4) = numbers_of(point(k), period(k))
            values(row, 5) = steady%multiplier
            values(row, 6) = steady%periods
            words(row, 1) = status_name(steady%status)
            words(row, 2) = contact_name(contact_of(steady))
          end associate
        end do
      end do
    end do
    call table%add('dynamic_factor', '', 'largest load of a pair over the static load', values(:, 1))
    call table%add('error_estimate', '', 'estimated error of the dynamic factor', values(:, 2))
    call table%add_words('status', 'how the calculation of the operating point ended', words(:, 1))
    call table%add_words('contact', 'full; partial: a pair was apart for a while; lost: all were; coast: the coast sides '// &
                         'touched', words(:, 2))
    call table%add('floquet_modulus', '', 'largest modulus of the Floquet multipliers', values(:, 5))
    call table%add('mesh_periods', '', 'mesh periods until the motion repeats', nint(values(:, 6)))
    call table%add('dte_um', 'um', 'dynamic transmission error as a new pair enters', values(:, 3))
    call table%add('dte_rate_mm_s', 'mm/s', 'rate of the dynamic transmission error as a new pair enters: the motion can be '// &
                   'continued from both', values(:, 4))
  end subroutine fill_motions

  !> Dynamic factor, its error, dynamic transmission error (um) and its rate (mm/s); NaN without a result. `period`: of
  !> the mesh, s.
  pure function numbers_of(point, period) result(numbers)
    type(point_t), intent(in) :: point
    real(dp), intent(in) :: period
    real(dp) :: numbers(4)

    numbers = ieee_value(1.0_dp, ieee_quiet_nan)
    if (has_result(point%steady%status)) numbers = [point%dynamic_factor, point%estimate, 1e6_dp*point%steady%state(1), &
                                                    1e3_dp*point%steady%state(2)/period]
  end function numbers_of

  !> A row for each change, in the order met.
  pure subroutine fill_changes(relief, branch, table, error)
    real(dp), intent(in) :: relief(:)            ! m
    type(branch_t), intent(in) :: branch(:, :)
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: values(:, :)
    character(word), allocatable :: words(:, :)
    integer :: rows, row, i, way, k

    rows = sum([((size(branch(way, i)%change), way=1, 2), i=1, size(relief))])
    call table%begin('speeds at which the motion of a slow run changes, in the order met', rows, error)
    if (allocated(error)) return
    allocate (values(rows, 8), words(rows, 4))
    row = 0
    do i = 1, size(relief)
      do way = 1, 2
        do k = 1, size(branch(way, i)%change)
          row = row + 1
          associate (change => branch(way, i)%change(k))
            values(row, :) = [in_um(relief(i)), real(k, dp), change%rpm, factors_of(change%point), &
                              real(change%point%steady%periods, dp)]
            words(row, :) = [character(word) :: ways(way), change_name(change%point), &
                             status_name(change%point(1)%steady%status), status_name(change%point(2)%steady%status)]
          end associate
        end do
      end do
    end do
    call table%add_index(axis('relief_um', 'um', 'tip relief, as amount_um of the case', values(:, 1)))
    call table%add_index(axis('direction', '', 'of the slow run through the speeds', words(:, 1)))
    call table%add_index(axis('change', '', 'which change of this run', nint(values(:, 2))))
    call table%add_words('kind', 'doubling or halving of the period, or a jump to another motion; where there is no result '// &
                         'before or after, the status there', words(:, 2))
    call table%add('rpm_before', '1/min', 'speed of the pinion just before', values(:, 3))
    call table%add('rpm_after', '1/min', 'speed of the pinion just after', values(:, 4))
    call table%add('dynamic_factor_before', '', 'largest load of a pair over the static load, before', values(:, 5))
    call table%add('dynamic_factor_after', '', 'largest load of a pair over the static load, after', values(:, 6))
    call table%add_words('status_before', 'status of the motion before', words(:, 3))
    call table%add_words('status_after', 'status of the motion after', words(:, 4))
    call table%add('mesh_periods_before', '', 'mesh periods until the motion repeats, before', nint(values(:, 7)))
    call table%add('mesh_periods_after', '', 'mesh periods until the motion repeats, after', nint(values(:, 8)))
  end subroutine fill_changes

  pure function factors_of(points) result(factors)
    type(point_t), intent(in) :: points(2)
    real(dp) :: factors(2)

    factors = merge(points%dynamic_factor, ieee_value(1.0_dp, ieee_quiet_nan), has_result(points%steady%status))
  end function factors_of

  !> The change in a word.
  pure function change_name(points) result(name)
    type(point_t), intent(in) :: points(2)
    character(word) :: name
    integer :: k

    associate (periods => points%steady%periods)
      name = 'jump'
      if (periods(1) == 2*periods(2)) name = 'halving'
      if (periods(2) == 2*periods(1)) name = 'doubling'
    end associate
    do k = 1, 2
      if (.not. has_result(points(k)%steady%status)) name = status_name(points(k)%steady%status)
    end do
  end function change_name

  pure subroutine add_report(self, lines)
    class(hysteresis_task_t), intent(in) :: self
    type(lines_t), intent(inout) :: lines
    integer, parameter :: most = 20
    integer :: i

    associate (rpm => self%tables(self%place('hysteresis'))%numbers('rpm'), &
               changes => self%tables(self%place('hysteresis_changes')))
      call lines%add('')
      call lines%add('Slow run up and down, '//str(self%tables(self%place('hysteresis'))%extent(3))//' speeds, '// &
                     str(minval(rpm))//' to '//str(maxval(rpm))//' rpm')
      call lines%add('   relief um   direction      at rpm     DF before      after   change')
      do i = 1, min(changes%rows, most)
        call lines%add(right(str(changes%number('relief_um', i)), 12)//right(trim(changes%word('direction', i)), 12)// &
                       right(str(changes%number('rpm_before', i), 6), 12)// &
                       right(fixed(changes%number('dynamic_factor_before', i), 4), 14)// &
                       right(fixed(changes%number('dynamic_factor_after', i), 4), 11)//'   '//trim(changes%word('kind', i)))
      end do
      call lines%add(left('Changes', 19)//str(changes%rows)//'; operating points without a result '//str(self%failed))
    end associate
    if (.not. self%rate > 0) return
    associate (delays => self%tables(self%place('hysteresis_delays')))
      call lines%add('At '//str(self%rate)//' rpm a second')
      call lines%add('   relief um   direction      at rpm     later, s')
      do i = 1, min(delays%rows, most)
        call lines%add(right(str(delays%number('relief_um', i)), 12)//right(trim(delays%word('direction', i)), 12)// &
                       right(str(delays%number('rpm', i), 6), 12)//right(str(delays%number('delay_s', i), 4), 13))
      end do
    end associate
  end subroutine add_report
end module gearsweep_task_hysteresis
