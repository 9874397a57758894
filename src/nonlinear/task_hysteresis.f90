!> The task `hysteresis`: steady motions of a slow run up and a slow run down through the speeds, and the speeds of their
!> jumps.
!>
!> Runs at a finite rate are added on request (see gearsweep_motion_continuation).
module gearsweep_nonlinear_task_hysteresis
  use gearsweep_base, only: axis, code_input, code_memory, dp, error_t, fail, left, lines_t, no_number, str, table_t
  use gearsweep_motion, only: branch_options_t, branch_t, change_t, contact_name, contact_of, follow_branch, follow_ramp, &
    has_result, level_t, mesh_period, oscillator_t, periods_of_ramp, point_t, ramp_options_t, ramp_t, status_name, status_stopped
  use gearsweep_study, only: of_dte_estimate, of_dte_range, of_dte_rms, reader_t, runnable_t, stage, stages_t, task_info_t, &
    words_of
  implicit none
  private
  public :: ramps_t, fill_ramps, fill_delays, hysteresis_task_t

  !> One run, with chosen steps and with steps twice as long for its error estimate.
  type :: ramps_t
    type(ramp_t) :: fine, coarse
    type(level_t), allocatable :: level(:)       !< halfway between the dynamic factors before and after each jump
    integer, allocatable :: change(:)            !< index of the slow run's change for each of them
    integer :: teeth = 0                         !< number of teeth of the pinion
  end type ramps_t

  character(4), parameter :: ways(2) = [character(4) :: 'up', 'down']

  type, extends(runnable_t) :: hysteresis_task_t
    real(dp) :: jump = 0.02_dp                   !< change of the dynamic factor above which a motion is another one
    real(dp) :: closeness = 1e-6_dp              !< relative distance of the speeds before and after a change
    real(dp) :: rate = 0                         !< rate of the speed on a ramp, (1/min)/s; 0: no ramp
  contains
    procedure, nopass :: describe
    procedure :: read_keys, run, add_report
  end type hysteresis_task_t

  !> Row of hysteresis_changes.
  type :: change_row_t
    real(dp) :: relief                           !< m
    integer :: way, number                       !< index of the direction, and of the change in its run
    type(change_t) :: change
  end type change_row_t

  !> Row of hysteresis_delays.
  type :: delay_row_t
    real(dp) :: relief                           !< m
    integer :: way, change                       !< index of the direction, and of the change in its slow run
    real(dp) :: rpm                              !< speed just after the jump of the slow run, 1/min
    real(dp) :: delay(3)                         !< speed of the jump, 1/min, delay and its error, s
  end type delay_row_t

  character(*), parameter :: group = 'hysteresis'
  integer, parameter :: word = 12

contains

  !> Computes the run at a finite rate from the first motion of a slow one, whose direction the speeds have.
  subroutine run_ramps(osc, rpm, branch, jump, options, ramps)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm(:)               !< 1/min
    type(branch_t), intent(in) :: branch         !< the slow run
    real(dp), intent(in) :: jump                 !< change of the dynamic factor above which it counts
    type(ramp_options_t), intent(in) :: options
    type(ramps_t), intent(out) :: ramps
    type(ramp_options_t) :: longer
    real(dp) :: start(2)
    integer :: i

    allocate (ramps%level(0), ramps%change(0))
    do i = 1, size(branch%change)
      associate (change => branch%change(i))
        if (.not. all(has_result(change%point%steady%status))) cycle
        associate (before => change%point(1)%dynamic_factor, after => change%point(2)%dynamic_factor)
          if (.not. abs(after - before) > jump) cycle
          ramps%level = [ramps%level, level_t(change%rpm(1), (before + after)/2, after > before)]
          ramps%change = [ramps%change, i]
        end associate
      end associate
    end do
    ramps%teeth = osc%mesh%teeth(1)
    start = [osc%mean_deflection, 0.0_dp]
    associate (steady => branch%point(1)%steady)
      if (has_result(steady%status)) start = steady%state/[1.0_dp, mesh_period(osc%mesh%teeth(1), rpm(1))]
    end associate
    call follow_ramp(osc, rpm, start, ramps%level, options, ramps%fine)
    longer = options
    longer%angle = 2*options%angle
    call follow_ramp(osc, rpm, start, ramps%level, longer, ramps%coarse)
  end subroutine run_ramps

  !> Fills a row for each relief, direction and speed. `rpm`: ascending, 1/min; `relief`: m.
  pure subroutine fill_ramps(rpm, relief, ramps, table, error)
    real(dp), intent(in) :: rpm(:), relief(:)
    type(ramps_t), intent(in) :: ramps(:, :)     !< up and down, for each relief
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: values(:, :)
    integer :: n, i, way, row

    n = size(rpm)
    call table%over('runs through the speeds at a finite rate', error, &
                    axis('relief_um', 'um', 'tip relief, as amount_um of the case', relief), &
                    axis('direction', '', 'of the run through the speeds', ways), &
                    axis('rpm', '1/min', 'speed of the pinion', rpm))
    if (allocated(error)) return
    allocate (values(size(ramps)*n, 2))
    row = 0
    do i = 1, size(relief)
      do way = 1, 2
        associate (to => row + merge(1, n, way == 1), until => row + merge(n, 1, way == 1))
          values(to:until:merge(1, -1, way == 1), 1) = ramps(way, i)%fine%factor
          values(to:until:merge(1, -1, way == 1), 2) = abs(ramps(way, i)%fine%factor - ramps(way, i)%coarse%factor)
        end associate
        row = row + n
      end do
    end do
    call table%add('dynamic_factor', '', 'largest load of a pair over the static load in the mesh periods between the speed '// &
                   'before and this one; NaN at the first speed, and where no mesh period lies between', values(:, 1))
    call table%add('error_estimate', '', 'estimated error of the dynamic factor: its change with steps twice as long', values(:, 2))
  end subroutine fill_ramps

  !> Fills a row for each jump of the slow runs.
  pure subroutine fill_delays(relief, branch, ramps, rate, table, error)
    real(dp), intent(in) :: relief(:)            !< m
    type(branch_t), intent(in) :: branch(:, :)   !< up and down, for each relief
    type(ramps_t), intent(in) :: ramps(:, :)
    real(dp), intent(in) :: rate                 !< rate of the speed, (1/min)/s
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    type(delay_row_t), allocatable :: rows(:)
    integer :: i, way, k, n

    n = sum([((size(ramps(way, i)%level), way=1, 2), i=1, size(relief))])
    call table%begin('how late the runs at a finite rate jump', n, error)
    if (allocated(error)) return
    allocate (rows(n))
    n = 0
    do i = 1, size(relief)
      do way = 1, 2
        associate (ramp => ramps(way, i))
          do k = 1, size(ramp%level)
            n = n + 1
            associate (rpm => branch(way, i)%change(ramp%change(k))%rpm(2))
              rows(n) = delay_row_t(relief(i), way, ramp%change(k), rpm, &
                                    delay(rpm, ramp%fine%passed(k), ramp%coarse%passed(k), rate, ramp%teeth))
            end associate
          end do
        end associate
      end do
    end do
    call table%add_index(axis('relief_um', 'um', 'tip relief, as amount_um of the case', [rows%relief]))
    call table%add_index(axis('direction', '', 'of the run through the speeds', ways(rows%way)))
    call table%add_index(axis('change', '', 'which change of this direction in hysteresis_changes', [rows%change]))
    call table%add('rpm', '1/min', 'speed of the pinion just after the jump of the slow run', [rows%rpm])
    call table%add('ramp_rpm', '1/min', 'speed at which the largest load of a mesh period is first halfway from that before to '// &
                   'that after the jump; NaN where it never is', [rows%delay(1)])
    call table%add('delay_s', 's', 'time from the jump of the slow run to that', [rows%delay(2)])
    call table%add('error_estimate_s', 's', 'estimated error of the delay: its change with steps twice as long, and a mesh '// &
                   'period, of which it is a whole number', [rows%delay(3)])
  end subroutine fill_delays

  !> Computes speed of the jump (1/min), delay and its error (s).
  pure function delay(slow, fine, coarse, rate, teeth)
    real(dp), intent(in) :: slow, fine, coarse   ! speeds, 1/min; 0: none
    real(dp), intent(in) :: rate
    integer, intent(in) :: teeth                 ! number of teeth of the pinion
    real(dp) :: delay(3)

    delay = no_number()
    if (fine > 0) delay(:2) = [fine, abs(fine - slow)/rate]
    if (fine > 0 .and. coarse > 0) delay(3) = abs(fine - coarse)/rate + mesh_period(teeth, fine)
  end function delay

  pure subroutine describe(info)
    type(task_info_t), intent(out) :: info

    info = task_info_t(group, needs=[stage%mesh, stage%reliefs, stage%amounts, stage%motion, stage%losses, stage%accuracy, &
                                     stage%speeds], &
      tables='hysteresis hysteresis_changes hysteresis_ramps hysteresis_delays', fields='', &
      summary='the steady motions that a slow run up through the speeds and one down meet, and the speeds at which they change')
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
                    default_note='none', meaning='rate of runs in which the speed changes at this rate, beside the slow ones')
  end subroutine read_keys

  subroutine run(self, stages, error)
    class(hysteresis_task_t), intent(inout) :: self
    type(stages_t), intent(in) :: stages
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: rpm(:)              ! ascending
    real(dp), allocatable :: period(:)           ! mesh periods at the speeds, s
    real(dp), allocatable :: relief(:)           ! m
    type(branch_t), allocatable :: branch(:, :)  ! up and down, for each relief; points in the direction of travel
    type(ramps_t), allocatable :: ramps(:, :)    ! up and down, for each relief
    integer, allocatable :: which(:)
    real(dp), parameter :: most = 1e7_dp         ! mesh periods of a ramp
    real(dp) :: periods
    integer :: i, way

    call self%list_speeds(stages, rpm)
    call self%list_reliefs(stages, which)
    period = mesh_period(stages%motion(1)%mesh%teeth(1), rpm)
    allocate (branch(2, size(which)), ramps(2, size(which)))
    if (self%rate > 0) then
      periods = periods_of_ramp(stages%motion(1), rpm, self%rate)
      if (periods > most) call fail(error, code_input, '&hysteresis ramp_rpm_s = '//str(self%rate)//': from '// &
        str(rpm(1))//' to '//str(rpm(size(rpm)))//' rpm are '//str(periods, 3)//' mesh periods; at most '//str(most)// &
        ' can be followed')
    end if
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
        call stages%running%report_progress(n, stages%accuracy%steady%stop)
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

  !> Fills a row for each relief, direction and speed.
  pure subroutine fill_motions(rpm, period, relief, branch, table, error)
    real(dp), intent(in) :: rpm(:), period(:), relief(:)   ! 1/min, s, m
    type(branch_t), intent(in) :: branch(:, :)
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    type(point_t), allocatable :: points(:)
    logical, allocatable :: known(:)
    integer :: i, n

    n = size(rpm)
    call table%over('steady motions that a slow run up through the speeds and one down meet', error, &
                    axis('relief_um', 'um', 'tip relief, as amount_um of the case', relief), &
                    axis('direction', '', 'of the slow run through the speeds', ways), &
                    axis('rpm', '1/min', 'speed of the pinion', rpm))
    if (allocated(error)) return
    allocate (points(table%rows))
    do i = 1, size(relief)
      points(2*n*(i - 1) + 1:2*n*i - n) = branch(1, i)%point
      points(2*n*i - n + 1:2*n*i) = branch(2, i)%point(n:1:-1)
    end do
    associate (steady => points%steady)
      known = has_result(steady%status)
      call table%add('dynamic_factor', '', 'largest load of a pair over the static load', &
                     merge(points%dynamic_factor, no_number(), known))
      call table%add('error_estimate', '', 'estimated error of the dynamic factor', merge(points%estimate, no_number(), known))
      call table%add_words('status', 'how the calculation of the operating point ended', words_of(steady%status))
      call table%add_words('contact', 'full; partial: a pair was apart for a while; lost: all were; coast: the coast sides '// &
                           'touched', contact_name(contact_of(steady)))
      call table%add('floquet_modulus', '', 'largest modulus of the Floquet multipliers', [steady%multiplier])
      call table%add('mesh_periods', '', 'mesh periods until the motion repeats', [steady%periods])
      call table%add('dte_um', 'um', 'dynamic transmission error as a new pair enters', merge(steady%state(1), no_number(), known))
      call table%add('dte_rate_mm_s', 'mm/s', 'rate of the dynamic transmission error as a new pair enters: the motion can be '// &
                     'continued from both', merge(steady%state(2)/table%along(3, period), no_number(), known))
      call table%add('dte_rms_um', 'um', of_dte_rms, merge(steady%dte_rms, no_number(), known))
      call table%add('dte_peak_to_peak_um', 'um', of_dte_range, merge(steady%dte_range, no_number(), known))
      call table%add('dte_error_estimate_um', 'um', of_dte_estimate, merge(points%dte_estimate, no_number(), known))
    end associate
  end subroutine fill_motions

  !> Fills a row for each change, in the order of travel.
  pure subroutine fill_changes(relief, branch, table, error)
    real(dp), intent(in) :: relief(:)            ! m
    type(branch_t), intent(in) :: branch(:, :)
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    type(change_row_t), allocatable :: rows(:)
    real(dp), allocatable :: factor(:, :)
    integer :: i, way, k, n

    n = sum([((size(branch(way, i)%change), way=1, 2), i=1, size(relief))])
    call table%begin('speeds at which the motion of a slow run changes, in the order met', n, error)
    if (allocated(error)) return
    allocate (rows(n), factor(n, 2))
    n = 0
    do i = 1, size(relief)
      do way = 1, 2
        do k = 1, size(branch(way, i)%change)
          n = n + 1
          rows(n) = change_row_t(relief(i), way, k, branch(way, i)%change(k))
          factor(n, :) = merge(rows(n)%change%point%dynamic_factor, no_number(), has_result(rows(n)%change%point%steady%status))
        end do
      end do
    end do
    call table%add_index(axis('relief_um', 'um', 'tip relief, as amount_um of the case', [rows%relief]))
    call table%add_index(axis('direction', '', 'of the slow run through the speeds', ways(rows%way)))
    call table%add_index(axis('change', '', 'which change of this run', [rows%number]))
    call table%add_words('kind', 'doubling or halving of the period, or a jump to another motion; where there is no result '// &
                         'before or after, the status there', [(change_name(rows(i)%change%point), i=1, n)])
    associate (before => rows%change%point(1)%steady, after => rows%change%point(2)%steady)
      call table%add('rpm_before', '1/min', 'speed of the pinion just before', [rows%change%rpm(1)])
      call table%add('rpm_after', '1/min', 'speed of the pinion just after', [rows%change%rpm(2)])
      call table%add('dynamic_factor_before', '', 'largest load of a pair over the static load, before', factor(:, 1))
      call table%add('dynamic_factor_after', '', 'largest load of a pair over the static load, after', factor(:, 2))
      call table%add_words('status_before', 'status of the motion before', words_of(before%status))
      call table%add_words('status_after', 'status of the motion after', words_of(after%status))
      call table%add('mesh_periods_before', '', 'mesh periods until the motion repeats, before', [before%periods])
      call table%add('mesh_periods_after', '', 'mesh periods until the motion repeats, after', [after%periods])
    end associate
  end subroutine fill_changes

  !> Word for the change.
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

    associate (rpm => self%tables(self%place('hysteresis'))%numbers('rpm'), &
               changes => self%tables(self%place('hysteresis_changes')))
      call lines%add('')
      call lines%add('Slow run up and down, '//str(self%tables(self%place('hysteresis'))%extent(3))//' speeds, '// &
                     str(minval(rpm))//' to '//str(maxval(rpm))//' rpm')
      call changes%show(lines, 'relief_um direction rpm_before dynamic_factor_before dynamic_factor_after kind')
      call lines%add(left('Changes', 19)//str(changes%rows)//'; operating points without a result '//str(self%failed))
    end associate
    if (.not. self%rate > 0) return
    associate (delays => self%tables(self%place('hysteresis_delays')))
      call lines%add('At '//str(self%rate)//' rpm a second')
      call delays%show(lines, 'relief_um direction rpm delay_s')
    end associate
  end subroutine add_report
end module gearsweep_nonlinear_task_hysteresis
