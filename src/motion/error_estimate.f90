!> Error estimate of an operating point from the solution with half the steps, and the number of steps that a tolerance needs.
!>
!> Numbers of steps are refinement levels of 2**(1/3), so that many speeds share the coefficients of a level.
module gearsweep_motion_error_estimate
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan, ieee_quiet_nan, ieee_value
  use gearsweep_base, only: dp
  use gearsweep_motion_resolution, only: resolution_t, scheme_collocation, scheme_rk4
  use gearsweep_motion_gauss, only: order
  use gearsweep_motion_oscillator, only: oscillator_t, resolving_steps
  use gearsweep_motion_period_map, only: discretise, period_map_t
  use gearsweep_motion_periodic_orbit, only: distance, unbounded
  use gearsweep_motion_steady_motion, only: accuracy_t, has_result, point_t, status_inexact, status_marginal, steady_t
  implicit none
  private
  public :: accuracy_t, point_t, compare, is_estimated, leave_unknown, mark_inexact, levels_t, work_of, forget_levels, &
            resolution_of, level_steps, first_level, last_level, search_level, need_level, next_level, &
            first_guess, root, need_given, need_graded, given_resolution, given_steps

  real(dp), parameter :: root = 1.0_dp/order

  !> Levels between a number of steps and half of it.
  integer, parameter, public :: per_doubling = 3
  integer, parameter :: most_levels = 48
  !> Indices of maps of other numbers of steps, and of half as many: graded steps, and a specified number.
  integer, parameter, public :: graded = -1, half_graded = -2, given = -3, half_given = -4

  type :: level_t
    type(period_map_t), allocatable :: map
  end type level_t

  !> Levels discretised so far, and the start for the next operating point.
  type :: levels_t
    type(level_t) :: level(half_given:most_levels)
    logical :: made(half_given:most_levels) = .false.
    logical :: lacks = .false.                   !< memory was too small for one: points have no result
    real(dp) :: steps_per_second = 0             !< steps per second that the last point needed, over its period
  end type levels_t

contains

  !> Computes the dynamic factor of a point from its steady motion, and its error from the solution with half the steps.
  elemental subroutine compare(osc, duration, half, point)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration             !< duration of the mesh period, s
    type(steady_t), intent(in) :: half           !< motion with half the steps
    type(point_t), intent(inout) :: point
    real(dp) :: peak, state, dte

    if (point%resolution%scheme == scheme_rk4 .and. .not. has_result(half%status)) then
      call leave_unknown(osc, point)
      return
    end if
    point%dynamic_factor = point%steady%peak/osc%load
    point%step_error = unbounded
    point%dte_estimate = unbounded
    if (has_result(half%status)) then
      peak = abs(point%steady%peak - half%peak)/osc%load
      state = max(distance(osc, duration, point%steady%state - half%state), &
                  abs(point%steady%checksum - half%checksum)/osc%static_deflection)
      if (point%resolution%scheme == scheme_rk4) then
        point%step_error = fourth_order_error(max(peak, state), point%steady%departs)
      else
        point%step_error = doubling_error(peak, state, raise_for(osc, duration, point))
      end if
      dte = max(abs(point%steady%dte_rms - half%dte_rms), abs(point%steady%dte_range - half%dte_range))
      point%dte_estimate = raise_for(osc, duration, point)*fourth_order_error(dte, point%steady%departs) + &
                           2*point%steady%closure*osc%static_deflection
      ! The peak is so near to 1 that the error of the steps decides on which side it is.
      if (has_result(point%steady%status) .and. &
          abs(point%steady%multiplier - 1) < abs(point%steady%multiplier - half%multiplier)) point%steady%status = status_marginal
    end if
    point%estimate = point%step_error + point%steady%closure
  end subroutine compare

  !> Error of a result of sixth order from its difference to half the steps: three times 1/63 of it, as the order is less where
  !> the stiffness is less smooth. The difference of the motions counts too, as the largest loads may differ little by chance.
  !> Where the order may hide, the estimate is multiplied by `raise`, and the part from the motions by `raise` once more, as it
  !> shows the remainder of errors made right after the breaks.
  pure real(dp) function doubling_error(peak, state, raise)
    real(dp), intent(in) :: peak                 !< difference of the dynamic factors
    real(dp), intent(in) :: state                !< difference of the motions, in static deflections
    integer, intent(in) :: raise                 !< factor of `raise_for`

    doubling_error = raise*max(peak, raise*state/4)/20
  end function doubling_error

  !> Factor on the estimate where less than the sixth order may show: 3 in graded steps, down to the third order, and where
  !> contact changes while half the steps are too long for the natural motion (more than 1.7 rad); 5 where damping lets the motion
  !> excited by a break decay within a few equal steps, and the largest loads of both solutions may have nearly the same error.
  pure integer function raise_for(osc, duration, point) result(raise)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration             !< duration of the mesh period, s
    type(point_t), intent(in) :: point
    real(dp), parameter :: strong = 0.5_dp

    raise = 1
    if (point%resolution%graded_for > 0) then
      raise = 3
    else if (osc%damping_ratio > strong) then
      raise = 5
    else if (point%steady%departs) then
      if (point%steps < 3*resolving_steps(osc, duration)*osc%mesh%deviations%periods) raise = 3
    end if
  end function raise_for

  !> Error of a result of fourth order, as by Runge-Kutta steps that end at the breaks: three times a fifteenth of the difference.
  !> Where contact changes within steps the order is not known: five times the difference.
  pure real(dp) function fourth_order_error(difference, partial)
    real(dp), intent(in) :: difference  !< difference of dynamic factors, motions in static deflections or transmission errors
    logical, intent(in) :: partial               !< contact changes

    fourth_order_error = merge(5*difference, difference/5, partial)
  end function fourth_order_error

  !> True if the solution with half the steps shows the error. Where breaks lie somewhere within equal steps, both solutions may
  !> agree by chance.
  elemental logical function is_estimated(scheme)
    integer, intent(in) :: scheme                !< scheme of gearsweep_motion_resolution

    is_estimated = scheme == scheme_collocation .or. scheme == scheme_rk4
  end function is_estimated

  !> Computes the dynamic factor of a point with an unknown error: its estimate is NaN.
  elemental subroutine leave_unknown(osc, point)
    type(oscillator_t), intent(in) :: osc
    type(point_t), intent(inout) :: point        !< with its steady motion

    point%dynamic_factor = point%steady%peak/osc%load
    point%step_error = ieee_value(1.0_dp, ieee_quiet_nan)
    point%estimate = point%step_error
    point%dte_estimate = point%step_error
  end subroutine leave_unknown

  !> Marks a result whose estimate exceeds the tolerance.
  elemental subroutine mark_inexact(options, point)
    type(accuracy_t), intent(in) :: options
    type(point_t), intent(inout) :: point

    if (.not. has_result(point%steady%status) .or. ieee_is_nan(point%estimate)) return
    if (.not. point%estimate <= options%steady%tolerance) point%steady%status = status_inexact
  end subroutine mark_inexact

  !> Steps computed so far, of all motions.
  pure real(dp) function work_of(levels)
    type(levels_t), intent(in) :: levels
    integer :: i

    work_of = 0
    do i = half_given, most_levels
      if (allocated(levels%level(i)%map)) work_of = work_of + levels%level(i)%map%work
    end do
  end function work_of

  !> Marks all levels as invalid for a new oscillator, but keeps their memory.
  pure subroutine forget_levels(levels)
    type(levels_t), allocatable, intent(inout) :: levels

    if (.not. allocated(levels)) allocate (levels)
    levels%made = .false.
  end subroutine forget_levels

  !> Resolution of a level.
  elemental type(resolution_t) function resolution_of(level)
    integer, intent(in) :: level

    resolution_of = resolution_t(6*2**(modulo(level, per_doubling)/real(per_doubling, dp)), 2**(level/per_doubling))
  end function resolution_of

  !> Steps of a period at a level, without those added by the breaks.
  elemental real(dp) function level_steps(level)
    integer, intent(in) :: level

    level_steps = 6*2**(level/real(per_doubling, dp))
  end function level_steps

  !> Lowest level with at least this many steps for which a level of half as many exists.
  pure integer function level_for(steps) result(level)
    real(dp), intent(in) :: steps                !< number of steps of a period

    level = min(most_levels, &
                per_doubling + max(0, ceiling(per_doubling*log(max(steps, 12.0_dp)/12)/log(2.0_dp) - 1e-9_dp)))
  end function level_for

  !> Level at which an operating point begins and the natural motion is resolved.
  pure integer function first_level(osc, duration, options, levels) result(level)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration             !< duration of the mesh period, s
    type(accuracy_t), intent(in) :: options
    type(levels_t), intent(in) :: levels

    level = level_for(max(2*resolving_steps(osc, duration), first_guess(osc, duration, options, levels)))
  end function first_level

  !> Level on which motions are sought. It depends on the oscillator and the speed alone, so that neither the tolerance nor other
  !> points decide which motion is found.
  pure integer function search_level(osc, duration, options) result(level)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration             !< duration of the mesh period, s
    type(accuracy_t), intent(in) :: options
    real(dp), parameter :: per_radian = 1.5_dp, fewest = 24

    level = level_for(max(fewest, per_radian*osc%natural_frequency*duration, 2*resolving_steps(osc, duration)))
    level = min(level, last_level(osc, options))
  end function search_level

  !> Highest level that the options and the memory allow.
  pure integer function last_level(osc, options) result(level)
    type(oscillator_t), intent(in) :: osc
    type(accuracy_t), intent(in) :: options
    real(dp) :: steps

    steps = options%most_steps*min(1.0_dp, 4.0_dp/osc%contacts)
    level = min(most_levels, floor(per_doubling*log(steps/6)/log(2.0_dp) + 1e-9_dp))
  end function last_level

  !> Discretises a level and that of half its steps unless they exist. Of large levels no others are kept: one of 2**18 steps
  !> takes 0.2 GB.
  pure subroutine need_level(osc, level, levels)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: level
    type(levels_t), intent(inout) :: levels      !< lacks: memory is too small
    real(dp), parameter :: large = 2**15
    integer :: i

    do i = 0, merge(most_levels, -1, level_steps(level) > large .and. .not. levels%made(level))
      if (level_steps(i) <= large .or. i == level - per_doubling) cycle
      if (allocated(levels%level(i)%map)) deallocate (levels%level(i)%map)
      levels%made(i) = .false.
    end do
    do i = level - per_doubling, level, per_doubling
      if (.not. levels%made(i)) call make_level(osc, resolution_of(i), i, levels)
    end do
  end subroutine need_level

  !> Discretises the steps of one index.
  pure subroutine make_level(osc, resolution, i, levels)
    type(oscillator_t), intent(in) :: osc
    type(resolution_t), intent(in) :: resolution
    integer, intent(in) :: i
    type(levels_t), intent(inout) :: levels      !< lacks: memory is too small

    if (.not. allocated(levels%level(i)%map)) allocate (levels%level(i)%map)
    call discretise(osc, resolution, levels%level(i)%map)
    levels%made(i) = levels%level(i)%map%steps > 0
    levels%lacks = levels%lacks .or. .not. levels%made(i)
  end subroutine make_level

  !> Discretises the specified number of steps, and half of it, unless they exist.
  pure subroutine need_given(osc, options, levels)
    type(oscillator_t), intent(in) :: osc
    type(accuracy_t), intent(in) :: options
    type(levels_t), intent(inout) :: levels      !< lacks: memory is too small
    type(resolution_t) :: resolution

    resolution = given_resolution(options)
    if (.not. levels%made(given)) call make_level(osc, resolution, given, levels)
    resolution%times = resolution%times/2
    if (.not. levels%made(half_given)) call make_level(osc, resolution, half_given, levels)
  end subroutine need_given

  !> Resolution for a specified number of steps.
  pure type(resolution_t) function given_resolution(options) result(resolution)
    type(accuracy_t), intent(in) :: options

    resolution = resolution_t(given_steps(options)/2.0_dp, 2, scheme=options%scheme)
  end function given_resolution

  !> Specified number of steps; by default that of Karpat et al. 2012.
  pure integer function given_steps(options) result(steps)
    type(accuracy_t), intent(in) :: options
    integer, parameter :: of_the_literature = 200

    steps = options%steps
    if (steps == 0) steps = of_the_literature
  end function given_steps

  !> Discretises graded steps, and half of them.
  pure subroutine need_graded(osc, resolution, levels)
    type(oscillator_t), intent(in) :: osc
    type(resolution_t), intent(in) :: resolution
    type(levels_t), intent(inout) :: levels      !< lacks: memory is too small

    type(resolution_t) :: half

    call make_level(osc, resolution, graded, levels)
    half = resolution
    half%times = resolution%times/2
    call make_level(osc, half, half_graded, levels)
  end subroutine need_graded

  !> Checks whether the error of a level is small enough; if not, selects the next level.
  pure subroutine next_level(osc, options, step_error, duration, levels, level, done)
    type(oscillator_t), intent(in) :: osc
    type(accuracy_t), intent(in) :: options
    real(dp), intent(in) :: step_error           !< error of the dynamic factor
    real(dp), intent(in) :: duration             !< duration of the mesh period, s
    type(levels_t), intent(inout) :: levels      !< updated by the number of steps needed
    integer, intent(inout) :: level
    logical, intent(out) :: done
    real(dp) :: excess

    excess = min(step_error/options%steady%tolerance, 1e8_dp)
    levels%steps_per_second = level_steps(level)*min(max((2.5_dp*excess)**root, 0.5_dp), 2.0_dp)/duration
    done = excess <= 1 .or. level >= last_level(osc, options)
    if (.not. done) level = min(level_for(level_steps(level)*min(1.1_dp*excess**root, 4.0_dp)), last_level(osc, options))
  end subroutine next_level

  !> Steps of a period that the tolerance may need: as for the last point, or by the angle of the natural motion in the period.
  pure real(dp) function first_guess(osc, duration, options, levels) result(steps)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration             !< duration of the mesh period, s
    type(accuracy_t), intent(in) :: options
    type(levels_t), intent(in) :: levels

    if (levels%steps_per_second > 0) then
      steps = levels%steps_per_second*duration
    else
      steps = 1.2_dp*osc%natural_frequency*duration*(1e-6_dp/options%steady%tolerance)**root
    end if
    steps = max(steps, 12*(1e-6_dp/options%steady%tolerance)**root)
  end function first_guess
end module gearsweep_motion_error_estimate
