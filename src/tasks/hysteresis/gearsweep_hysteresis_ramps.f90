!> Runs of the task `hysteresis` through the speeds at a finite rate, beside the slow ones, and their tables.
module gearsweep_hysteresis_ramps
  use gearsweep_continuation, only: branch_t
  use gearsweep_decimal, only: in_um
  use gearsweep_error, only: error_t
  use gearsweep_kinds, only: dp
  use gearsweep_oscillator, only: mesh_period, oscillator_t
  use gearsweep_ramp, only: follow_ramp, level_t, ramp_options_t, ramp_t
  use gearsweep_status, only: has_result
  use gearsweep_table, only: axis, no_number, table_t
  implicit none
  private
  public :: ramps_t, run_ramps, fill_ramps, fill_delays

  !> One run, with steps as wanted and with steps twice as long, which tell its error.
  type :: ramps_t
    type(ramp_t) :: fine, coarse
    type(level_t), allocatable :: level(:)       !< halfway between the dynamic factors before and after each jump
    integer, allocatable :: change(:)            !< which change of the slow run each of them is
    integer :: teeth = 0                         !< of the pinion
  end type ramps_t

  character(4), parameter :: ways(2) = [character(4) :: 'up', 'down']

contains

  !> The run at a finite rate from the first motion of a slow one, in whose direction the speeds are.
  subroutine run_ramps(osc, rpm, branch, jump, options, ramps)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm(:)               !< 1/min
    type(branch_t), intent(in) :: branch         !< the slow run
    real(dp), intent(in) :: jump                 !< of the dynamic factor, from which on a change counts
    type(ramp_options_t), intent(in) :: options
    type(ramps_t), intent(out) :: ramps
    type(ramp_options_t) :: longer
    real(dp) :: start(2)

    call list_levels(branch, jump, ramps)
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

  !> The levels that tell when the motion has jumped.
  pure subroutine list_levels(branch, jump, ramps)
    type(branch_t), intent(in) :: branch
    real(dp), intent(in) :: jump
    type(ramps_t), intent(inout) :: ramps
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
  end subroutine list_levels

  !> A row for each relief, direction and speed. `rpm`: ascending, 1/min; `relief`: m.
  pure subroutine fill_ramps(rpm, relief, ramps, table, error)
    real(dp), intent(in) :: rpm(:), relief(:)
    type(ramps_t), intent(in) :: ramps(:, :)     !< up and down, for each relief
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: values(:, :)
    integer :: n, i, way, row

    if (allocated(error)) return
    n = size(rpm)
    call table%over('runs through the speeds at a finite rate', error, &
                    axis('relief_um', 'um', 'tip relief, as amount_um of the case', in_um(relief)), &
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

  !> A row for each jump of the slow runs.
  pure subroutine fill_delays(relief, branch, ramps, rate, table, error)
    real(dp), intent(in) :: relief(:)            !< m
    type(branch_t), intent(in) :: branch(:, :)   !< up and down, for each relief
    type(ramps_t), intent(in) :: ramps(:, :)
    real(dp), intent(in) :: rate                 !< of the speed, (1/min)/s
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: values(:, :)
    character(4), allocatable :: direction(:)
    integer :: rows, row, i, way, k

    if (allocated(error)) return
    rows = sum([((size(ramps(way, i)%level), way=1, 2), i=1, size(relief))])
    call table%begin('how late the runs at a finite rate jump', rows, error)
    if (allocated(error)) return
    allocate (values(rows, 6), direction(rows))
    row = 0
    do i = 1, size(relief)
      do way = 1, 2
        do k = 1, size(ramps(way, i)%level)
          row = row + 1
          direction(row) = ways(way)
          associate (change => ramps(way, i)%change(k))
            values(row, :) = [in_um(relief(i)), real(change, dp), branch(way, i)%change(change)%rpm(2), &
                              delay(branch(way, i)%change(change)%rpm(2), ramps(way, i)%fine%passed(k), &
                                    ramps(way, i)%coarse%passed(k), rate, ramps(way, i)%teeth)]
          end associate
        end do
      end do
    end do
    call table%add_index(axis('relief_um', 'um', 'tip relief, as amount_um of the case', values(:, 1)))
    call table%add_index(axis('direction', '', 'of the run through the speeds', direction))
    call table%add_index(axis('change', '', 'which change of this direction in hysteresis_changes', nint(values(:, 2))))
    call table%add('rpm', '1/min', 'speed of the pinion just after the jump of the slow run', values(:, 3))
    call table%add('ramp_rpm', '1/min', 'speed at which the largest load of a mesh period is first halfway from that before to '// &
                   'that after the jump; NaN where it never is', values(:, 4))
    call table%add('delay_s', 's', 'time from the jump of the slow run to that', values(:, 5))
    call table%add('error_estimate_s', 's', 'estimated error of the delay: its change with steps twice as long, and a mesh '// &
                   'period, of which it is a whole number', values(:, 6))
  end subroutine fill_delays

  !> Speed of the jump (1/min), delay and its error (s).
  pure function delay(slow, fine, coarse, rate, teeth)
    real(dp), intent(in) :: slow, fine, coarse   ! speeds, 1/min; 0: none
    real(dp), intent(in) :: rate
    integer, intent(in) :: teeth                 ! of the pinion
    real(dp) :: delay(3)

    delay = no_number()
    if (fine > 0) delay(:2) = [fine, abs(fine - slow)/rate]
    if (fine > 0 .and. coarse > 0) delay(3) = abs(fine - coarse)/rate + mesh_period(teeth, fine)
  end function delay
end module gearsweep_hysteresis_ramps
