!> An operating point, and the estimate of its error from the solution with half the steps.
module gearsweep_error_estimate
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan, ieee_quiet_nan, ieee_value
  use gearsweep_coefficients, only: resolution_t, scheme_collocation, scheme_rk4
  use gearsweep_kinds, only: dp
  use gearsweep_oscillator, only: oscillator_t, resolving_steps
  use gearsweep_periodic_orbit, only: distance, steady_t, unbounded
  use gearsweep_status, only: has_result, status_inexact, status_marginal
  use gearsweep_transient, only: steady_options_t
  implicit none
  private
  public :: accuracy_t, step_choice_t, point_t, compare, is_estimated, leave_unknown, mark_inexact

  !> The method of integration, and how many steps there are.
  type :: step_choice_t
    integer :: scheme = scheme_collocation       !< of gearsweep_coefficients
    integer :: steps = 0                         !< of a period; 0: chosen for the tolerance, or 200 by another scheme
    integer :: most_steps = 2**18                !< of a period; fewer where there are more than four contacts
  end type step_choice_t

  !> What an operating point is asked for.
  type, extends(step_choice_t) :: accuracy_t
    type(steady_options_t) :: steady
  end type accuracy_t

  !> The result at one speed.
  type :: point_t
    type(steady_t) :: steady
    real(dp) :: dynamic_factor = 0               !< largest load on one pair over the static load
    real(dp) :: estimate = 0                     !< of the error of the dynamic factor; NaN: not known
    real(dp) :: step_error = 0                   !< its part that more steps reduce
    real(dp) :: work = 0                         !< steps in all, at every level tried; not counted in batches
    integer :: steps = 0                         !< of the period
    type(resolution_t) :: resolution             !< that has them
    !> In a sweep up or down: the motion at the speed before led to none, and this one was found without it.
    logical :: branch_lost = .false.
    !> In a sweep up and down: the direction that led to this motion, 1 up, -1 down, 0 both; and what the other led to, the
    !> same motion or one of smaller dynamic factor.
    integer :: direction = 0
    integer :: other_status = 0                  !< of gearsweep_status
    real(dp) :: other_factor = 0                 !< its dynamic factor
  end type point_t

contains

  !> The dynamic factor of a point whose steady motion is found, and its error by the solution with half the steps.
  elemental subroutine compare(osc, duration, half, point)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration             !< of the mesh period, s
    type(steady_t), intent(in) :: half           !< the motion with half the steps
    type(point_t), intent(inout) :: point
    real(dp) :: peak, state

    if (point%resolution%scheme == scheme_rk4 .and. .not. has_result(half%status)) then
      call leave_unknown(osc, point)
      return
    end if
    point%dynamic_factor = point%steady%peak/osc%load
    point%step_error = unbounded
    if (has_result(half%status)) then
      peak = abs(point%steady%peak - half%peak)/osc%load
      state = max(distance(osc, duration, point%steady%state - half%state), &
                  abs(point%steady%checksum - half%checksum)/osc%static_deflection)
      if (point%resolution%scheme == scheme_rk4) then
        point%step_error = rk4_error(max(peak, state), point%steady%departs)
      else
        point%step_error = doubling_error(peak, state, raise_for(osc, duration, point))
      end if
      ! So near to 1 that the error of the steps decides on which side.
      if (has_result(point%steady%status) .and. &
          abs(point%steady%multiplier - 1) < abs(point%steady%multiplier - half%multiplier)) point%steady%status = status_marginal
    end if
    point%estimate = point%step_error + point%steady%closure
  end subroutine compare

  !> Error of a result of sixth order from its difference to half the steps: a 63rd of it, three times raised, as the
  !> order is less where the stiffness is less smooth. The difference of the motions counts too, as the largest loads
  !> may differ little by chance. Where the order may hide, the estimate is raised again, and what the motions differ by once
  !> more, as it shows what is left of errors made right behind the breaks.
  pure real(dp) function doubling_error(peak, state, raise)
    real(dp), intent(in) :: peak                 !< difference of the dynamic factors
    real(dp), intent(in) :: state                !< difference of the motions, in static deflections
    integer, intent(in) :: raise                 !< of `raise_for`

    doubling_error = raise*max(peak, raise*state/4)/20
  end function doubling_error

  !> How much the estimate is raised where less than the sixth order may show: 3 in graded steps, down to the third order, and where
  !> contact changes while half the steps are too long for the natural motion (more than 1.7 rad); 5 where damping lets what a
  !> break excites decay within a few equal steps, and the largest loads of both solutions may be off by much the same.
  pure integer function raise_for(osc, duration, point) result(raise)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration             !< of the mesh period, s
    type(point_t), intent(in) :: point
    real(dp), parameter :: strong = 0.5_dp

    raise = 1
    if (point%resolution%graded_for > 0) then
      raise = 3
    else if (osc%damping_ratio > strong) then
      raise = 5
    else if (point%steady%departs) then
      if (point%steps < 3*resolving_steps(osc, duration)) raise = 3
    end if
  end function raise_for

  !> The same by Runge-Kutta steps that end at the breaks. While all pairs stay in contact they are of fourth order: a
  !> fifteenth of the difference, three times raised. Changes of contact lie somewhere within steps, so that no order
  !> shows: five times the difference.
  pure real(dp) function rk4_error(difference, partial)
    real(dp), intent(in) :: difference           !< of dynamic factors, or motions in static deflections
    logical, intent(in) :: partial               !< contact changes

    rk4_error = merge(5*difference, difference/5, partial)
  end function rk4_error

  !> Does the solution with half the steps show the error? Where breaks lie somewhere within equal steps, both solutions
  !> may come as near to each other as chance has it.
  elemental logical function is_estimated(scheme)
    integer, intent(in) :: scheme                !< of gearsweep_coefficients

    is_estimated = scheme == scheme_collocation .or. scheme == scheme_rk4
  end function is_estimated

  !> The dynamic factor of a point whose error is not known: its estimate is NaN.
  elemental subroutine leave_unknown(osc, point)
    type(oscillator_t), intent(in) :: osc
    type(point_t), intent(inout) :: point        !< its steady motion is found

    point%dynamic_factor = point%steady%peak/osc%load
    point%step_error = ieee_value(1.0_dp, ieee_quiet_nan)
    point%estimate = point%step_error
  end subroutine leave_unknown

  !> Marks a result whose estimate exceeds the tolerance.
  elemental subroutine mark_inexact(options, point)
    type(accuracy_t), intent(in) :: options
    type(point_t), intent(inout) :: point

    if (.not. has_result(point%steady%status) .or. ieee_is_nan(point%estimate)) return
    if (.not. point%estimate <= options%steady%tolerance) point%steady%status = status_inexact
  end subroutine mark_inexact
end module gearsweep_error_estimate
