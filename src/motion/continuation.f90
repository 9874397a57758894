!> Steady motions followed up and down over the speed, slowly or at a finite rate.
!>
!> The slow run finds the speeds at which motions change: jumps to another motion, doubled periods, the end of periodic motion. In
!> the run at a finite rate the speed changes a little from one mesh period to the next, and every mesh period is computed. Where
!> the steady motion ends, in a fold, the motion leaves its neighbourhood only after a delay, which grows as the 2/3 power of the
!> rate.
!> Source: Jung, Gray, Roy, Mandel 1990, Scaling law for dynamical hysteresis (Phys. Rev. Lett. 65) for the power.
module gearsweep_motion_continuation
  use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
  use, intrinsic :: iso_c_binding, only: c_null_ptr, c_ptr
  use gearsweep_base, only: dp, has_memory, wants_stop
  use gearsweep_motion_resolution, only: resolution_t
  use gearsweep_motion_contact_set, only: period_t
  use gearsweep_motion_error_estimate, only: accuracy_t, levels_t, point_t
  use gearsweep_motion_operating_point, only: solve_point
  use gearsweep_motion_oscillator, only: mesh_period, oscillator_t
  use gearsweep_motion_period, only: run_period
  use gearsweep_motion_period_map, only: discretise, period_map_t, set_durations
  use gearsweep_motion_periodic_orbit, only: is_bounded
  use gearsweep_motion_poincare, only: sample_section, section_points_t
  use gearsweep_motion_steady_motion, only: has_result, status_chatter, status_stopped, status_unbounded, status_unresolved
  implicit none
  private
  public :: branch_t, change_t, branch_options_t, follow_branch, continue_to, carried, level_t, ramp_options_t, ramp_t, &
            follow_ramp, periods_of_ramp

  !> Change of the motion between two speeds: the motion before and the motion after.
  type :: change_t
    real(dp) :: rpm(2) = 0                       !< in the direction of travel, 1/min
    type(point_t) :: point(2)
  end type change_t

  type :: branch_t
    type(point_t), allocatable :: point(:)       !< points at each speed; (speed)
    type(change_t), allocatable :: change(:)     !< in the order met
    logical :: lacks = .false.                   !< memory is too small: nothing was computed
  end type branch_t

  !> Limits that define a change of the motion.
  type :: branch_options_t
    type(accuracy_t) :: accuracy
    real(dp) :: jump = 0.01_dp                   !< change of the dynamic factor between two speeds
    real(dp) :: closeness = 1e-4_dp              !< distance of the speeds between which a change is located, relative
  end type branch_options_t

  !> Point of the continuation: a motion and its speed; `state` also where it has no result.
  type :: continuation_point_t
    real(dp) :: rpm = 0
    real(dp) :: state(2) = 0
    type(point_t) :: point
  end type continuation_point_t

  !> Mesh periods over which a motion without a result is integrated at each speed.
  integer, parameter :: lingering = 300

  !> Dynamic factor that the motion passes some time after a speed.
  type :: level_t
    real(dp) :: after = 0                        !< speed, 1/min
    real(dp) :: factor = 0
    logical :: rises = .true.                    !< true: it passes upwards
  end type level_t

  type :: ramp_options_t
    real(dp) :: rate = 1                         !< rate of the speed, (1/min)/s
    real(dp) :: angle = 0.2_dp                   !< angle of the natural motion in a step, rad
    type(c_ptr) :: stop = c_null_ptr             !< the caller's flag
  end type ramp_options_t

  type :: ramp_t
    !> Largest load of a pair over the static load in the mesh periods between the previous speed and this one; NaN at the first
    !> speed, where no period lies between, and where the motion cannot be computed; (speed)
    real(dp), allocatable :: factor(:)
    real(dp), allocatable :: passed(:)           !< speed at which each level is passed, 1/min; 0: never; (level)
    logical :: lacks = .false.                   !< memory is too small for the steps
    logical :: stopped = .false.                 !< stopped by the caller
  end type ramp_t

contains

  !> Follows the motion over the speeds, in steps so small that the dynamic factor changes by less than a jump. Where it changes
  !> more between speeds that are close, the motion changes there. If the caller stops it, the remaining points have the status
  !> `stopped`.
  pure subroutine follow_branch(osc, rpm, options, branch)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm(:)               !< speeds of the pinion in the direction of travel, 1/min
    type(branch_options_t), intent(in) :: options
    type(branch_t), intent(out) :: branch
    type(levels_t), allocatable :: levels
    type(continuation_point_t) :: here
    logical :: fits
    integer :: i

    call has_memory(size(rpm)*storage_size(here%point)/8.0_dp, fits)
    branch%lacks = .not. fits
    if (branch%lacks) return
    allocate (levels, branch%point(size(rpm)), branch%change(0))
    do i = 1, size(rpm)
      if (i == 1) call move_to(osc, rpm(i), options%accuracy, levels, here)
      if (i > 1) call step_to(osc, rpm(i), options, levels, here, branch%change)
      branch%lacks = levels%lacks
      if (branch%lacks) return
      if (wants_stop(options%accuracy%steady%stop)) branch%point(i:)%steady%status = status_stopped
      if (branch%point(i)%steady%status == status_stopped) return
      branch%point(i) = here%point
    end do
  end subroutine follow_branch

  !> Continues to the next speed, with the step halved while the motion there is another one.
  pure subroutine step_to(osc, rpm, options, levels, here, changes)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm
    type(branch_options_t), intent(in) :: options
    type(levels_t), intent(inout) :: levels
    type(continuation_point_t), intent(inout) :: here
    type(change_t), allocatable, intent(inout) :: changes(:)
    type(accuracy_t) :: enough
    type(continuation_point_t) :: there
    real(dp) :: step

    step = rpm - here%rpm
    do while (abs(rpm - here%rpm) > 0 .and. .not. (levels%lacks .or. wants_stop(options%accuracy%steady%stop)))
      if (abs(step) > 0.7_dp*abs(rpm - here%rpm)) step = rpm - here%rpm
      ! A few periods show whether the motion still exists.
      enough = options%accuracy
      if (has_result(here%point%steady%status)) enough%steady%most_cycles = min(options%accuracy%steady%most_cycles, 200)
      there = here
      call move_to(osc, merge(rpm, here%rpm + step, .not. abs(rpm - here%rpm) > abs(step)), enough, levels, there)
      if (is_alike(here%point, there%point, options%jump)) then
        here = there
        step = 2*step
      else if (abs(step) > options%closeness*rpm) then
        step = step/2
      else
        call accept_change(osc, rpm, options, levels, here, there, changes)
      end if
    end do
  end subroutine step_to

  !> Records a change of the motion between `here` and `there`, which are close to each other. Just after the change the old
  !> motion may persist for so long that no result is found: then the next speed with a result is used, at most `rpm`.
  pure subroutine accept_change(osc, rpm, options, levels, here, there, changes)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm
    type(branch_options_t), intent(in) :: options
    type(levels_t), intent(inout) :: levels
    type(continuation_point_t), intent(inout) :: here
    type(continuation_point_t), intent(in) :: there
    type(change_t), allocatable, intent(inout) :: changes(:)
    type(accuracy_t) :: patient
    type(continuation_point_t) :: beyond
    real(dp) :: step
    logical :: last

    patient = options%accuracy
    beyond = there
    step = there%rpm - here%rpm
    last = .false.
    do while (.not. (last .or. has_result(beyond%point%steady%status) .or. levels%lacks))
      step = 8*step
      last = abs(step) >= abs(rpm - here%rpm)
      if (last) patient%steady%most_cycles = 10*options%accuracy%steady%most_cycles
      beyond = here
      call move_to(osc, merge(rpm, here%rpm + step, last), patient, levels, beyond)
    end do
    if (.not. is_alike(here%point, beyond%point, options%jump)) &
      changes = [changes, change_t([here%rpm, there%rpm], [here%point, beyond%point])]
    here = beyond
  end subroutine accept_change

  !> Computes the motion at `rpm` that the present one leads to; the first motion, by itself.
  pure subroutine move_to(osc, rpm, options, levels, here)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm
    type(accuracy_t), intent(in) :: options
    type(levels_t), intent(inout) :: levels
    type(continuation_point_t), intent(inout) :: here
    type(section_points_t) :: section
    type(point_t) :: next
    real(dp) :: duration, start(2)

    duration = mesh_period(osc%mesh%teeth(1), rpm)
    start = here%state*[1.0_dp, here%rpm/rpm]
    if (has_result(here%point%steady%status) .or. .not. here%rpm > 0) then
      call continue_to(osc, rpm, options, levels, here%point, here%rpm, next)
    else
      call solve_point(osc, duration, options, levels, next, start)
    end if
    here = continuation_point_t(rpm, next%steady%state, next)
    if (has_result(next%steady%status)) return
    call sample_section(osc, [rpm], lingering, 1, section, start/[1.0_dp, duration])
    here%state = start
    if (section%lacks) levels%lacks = .true.
    if (section%lacks) return
    if (all(section%status(1) /= [status_unresolved, status_chatter, status_unbounded])) &
      here%state = [section%x(1, 1), section%v(1, 1)*duration]
  end subroutine move_to

  !> Computes the steady motion that the one at a neighbouring speed leads to or, where that has no result, that of the speed by
  !> itself. While all pairs stay in contact there is only one periodic motion, and no continuation is needed.
  pure subroutine continue_to(osc, rpm, options, levels, neighbour, rpm_there, point)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm                  !< speed of the pinion, 1/min
    type(accuracy_t), intent(in) :: options
    type(levels_t), intent(inout) :: levels      !< levels of this oscillator
    type(point_t), intent(in) :: neighbour
    real(dp), intent(in) :: rpm_there            !< speed of the neighbour, 1/min
    type(point_t), intent(out) :: point
    real(dp) :: duration
    logical :: known

    duration = mesh_period(osc%mesh%teeth(1), rpm)
    known = has_result(neighbour%steady%status)
    if (.not. (known .and. neighbour%steady%partial)) then
      call solve_point(osc, duration, options, levels, point)
      if (.not. (known .and. point%steady%partial)) return
    end if
    call solve_point(osc, duration, options, levels, point, carried(neighbour, rpm_there, rpm))
  end subroutine continue_to

  !> Converts position and velocity to a state (m) at another speed: the derivative over the phase scales with the period.
  pure function carried(point, rpm_from, rpm_to) result(state)
    type(point_t), intent(in) :: point
    real(dp), intent(in) :: rpm_from, rpm_to     !< 1/min
    real(dp) :: state(2)

    state = point%steady%state*[1.0_dp, rpm_from/rpm_to]
  end function carried

  !> True if these motions at neighbouring speeds are the same. Motions without a result count as the same.
  pure logical function is_alike(a, b, jump)
    type(point_t), intent(in) :: a, b
    real(dp), intent(in) :: jump

    is_alike = has_result(a%steady%status) .eqv. has_result(b%steady%status)
    if (is_alike .and. has_result(a%steady%status)) is_alike = a%steady%periods == b%steady%periods .and. &
      abs(a%dynamic_factor - b%dynamic_factor) < jump
  end function is_alike

  !> Number of mesh periods in a ramp.
  pure real(dp) function periods_of_ramp(osc, rpm, rate) result(periods)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm(:)               !< 1/min
    real(dp), intent(in) :: rate                 !< (1/min)/s

    ! Time between two speeds, times the mesh frequency in the middle.
    associate (first => rpm(1), last => rpm(size(rpm)))
      periods = abs(last - first)/rate/mesh_period(osc%mesh%teeth(1), (first + last)/2)
    end associate
  end function periods_of_ramp

  !> Integrates the motion from the first speed to the last one.
  subroutine follow_ramp(osc, rpm, start, levels, options, ramp)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm(:)               !< ascending or descending, 1/min
    real(dp), intent(in) :: start(2)             !< x (m) and its rate (m/s) at the first speed, as a new pair enters
    type(level_t), intent(in) :: levels(:)
    type(ramp_options_t), intent(in) :: options
    type(ramp_t), intent(out) :: ramp
    real(dp) :: speed, state(2)
    integer :: k
    logical :: goes_on

    allocate (ramp%factor(size(rpm)), source=ieee_value(1.0_dp, ieee_quiet_nan))
    allocate (ramp%passed(size(levels)), source=0.0_dp)
    speed = rpm(1)
    state = start
    do k = 2, size(rpm)
      call follow_segment(osc, rpm(k - 1:k), levels, options, speed, state, ramp%factor(k), ramp, goes_on)
      if (.not. goes_on) return
    end do
  end subroutine follow_ramp

  !> Integrates the motion from one speed to the next.
  subroutine follow_segment(osc, rpm, levels, options, speed, state, largest, ramp, goes_on)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm(2)
    type(level_t), intent(in) :: levels(:)
    type(ramp_options_t), intent(in) :: options
    real(dp), intent(inout) :: speed             ! speed of the next mesh period, 1/min
    real(dp), intent(inout) :: state(2)          ! state at its start, m and m/s
    real(dp), intent(inout) :: largest
    type(ramp_t), intent(inout) :: ramp
    logical, intent(out) :: goes_on
    integer, parameter :: fewest_steps = 24, most_steps = 2**16
    type(period_map_t) :: map
    type(period_t) :: run
    real(dp) :: duration, steps, factor, sense

    sense = sign(1.0_dp, rpm(2) - rpm(1))
    duration = mesh_period(osc%mesh%teeth(1), minval(rpm))
    steps = max(osc%natural_frequency, osc%highest_frequency*max(0.5_dp, osc%damping_ratio))*duration/options%angle
    goes_on = steps <= most_steps
    if (.not. goes_on) return
    call discretise(osc, resolution_t(max(steps, real(fewest_steps, dp))), map)
    ramp%lacks = map%steps == 0
    goes_on = .not. ramp%lacks
    if (.not. goes_on) return
    factor = 0
    do while (sense*(rpm(2) - speed) > 0)
      ramp%stopped = wants_stop(options%stop)
      goes_on = .not. ramp%stopped
      if (.not. goes_on) return
      duration = mesh_period(osc%mesh%teeth(1), speed)
      call set_durations(map, [duration])
      call run_period(map, state*[1.0_dp, duration], run)
      goes_on = .not. run%failed
      if (goes_on) goes_on = is_bounded(osc, duration, run%state)
      if (.not. goes_on) return
      state = run%state/[1.0_dp, duration]
      call pass_levels(levels, sense, speed, run%peak/osc%load, ramp%passed)
      factor = max(factor, run%peak/osc%load)
      speed = speed + sense*options%rate*duration
    end do
    if (factor > 0) largest = factor
  end subroutine follow_segment

  !> Records the speed for each level that the dynamic factor passes for the first time in this mesh period.
  pure subroutine pass_levels(levels, sense, speed, factor, passed)
    type(level_t), intent(in) :: levels(:)
    real(dp), intent(in) :: sense, speed, factor
    real(dp), intent(inout) :: passed(:)
    integer :: i

    do i = 1, size(levels)
      if (passed(i) > 0 .or. sense*(speed - levels(i)%after) < 0) cycle
      if (merge(factor > levels(i)%factor, factor < levels(i)%factor, levels(i)%rises)) passed(i) = speed
    end do
  end subroutine pass_levels
end module gearsweep_motion_continuation
