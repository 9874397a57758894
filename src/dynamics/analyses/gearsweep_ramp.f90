!> A run through the speeds at a finite rate: the speed changes a little from one mesh period to the next, and every mesh period
!> is followed. Where the steady motion ends, in a fold, the motion leaves its neighbourhood only after a delay, which grows as
!> the 2/3 power of the rate.
!> Source: Jung, Gray, Roy, Mandel 1990, Scaling law for dynamical hysteresis (Phys. Rev. Lett. 65) for the power.
module gearsweep_ramp
  use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
  use, intrinsic :: iso_c_binding, only: c_null_ptr, c_ptr
  use gearsweep_coefficients, only: resolution_t
  use gearsweep_contact_set, only: period_t
  use gearsweep_kinds, only: dp
  use gearsweep_oscillator, only: mesh_period, oscillator_t
  use gearsweep_period, only: run_period
  use gearsweep_period_map, only: discretise, period_map_t, set_durations
  use gearsweep_periodic_orbit, only: is_bounded
  use gearsweep_stop, only: wants_stop
  implicit none
  private
  public :: level_t, ramp_options_t, ramp_t, follow_ramp, periods_of_ramp

  !> A dynamic factor that the motion passes some time after a speed.
  type :: level_t
    real(dp) :: after = 0                        !< speed, 1/min
    real(dp) :: factor = 0
    logical :: rises = .true.                    !< it passes upwards
  end type level_t

  type :: ramp_options_t
    real(dp) :: rate = 1                         !< of the speed, (1/min)/s
    real(dp) :: angle = 0.2_dp                   !< of the natural motion in a step, rad
    type(c_ptr) :: stop = c_null_ptr             !< the caller's flag
  end type ramp_options_t

  type :: ramp_t
    !> Largest load of a pair over the static load in the mesh periods between the speed before and this one; NaN at the first
    !> speed, where none lies between, and where the motion cannot be followed; (speed)
    real(dp), allocatable :: factor(:)
    real(dp), allocatable :: passed(:)           !< speed at which each level is passed, 1/min; 0: never; (level)
    logical :: lacks = .false.                   !< the memory does not hold the steps
    logical :: stopped = .false.                 !< by the caller
  end type ramp_t

contains

  !> How many mesh periods a ramp takes.
  pure real(dp) function periods_of_ramp(osc, rpm, rate) result(periods)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm(:)               !< 1/min
    real(dp), intent(in) :: rate                 !< (1/min)/s

    ! The time between two speeds, times the mesh frequency in the middle.
    associate (first => rpm(1), last => rpm(size(rpm)))
      periods = abs(last - first)/rate/mesh_period(osc%mesh%teeth(1), (first + last)/2)
    end associate
  end function periods_of_ramp

  !> Follows the motion from the first speed to the last one.
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

  !> From one speed to the next.
  subroutine follow_segment(osc, rpm, levels, options, speed, state, largest, ramp, goes_on)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm(2)
    type(level_t), intent(in) :: levels(:)
    type(ramp_options_t), intent(in) :: options
    real(dp), intent(inout) :: speed             ! of the next mesh period, 1/min
    real(dp), intent(inout) :: state(2)          ! at its begin, m and m/s
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

  !> Notes the speed for all levels that this mesh period is the first to pass.
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
end module gearsweep_ramp
