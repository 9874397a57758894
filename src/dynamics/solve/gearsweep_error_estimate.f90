!> The estimate of its error from the solution with half the steps.
module gearsweep_error_estimate
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan, ieee_quiet_nan, ieee_value
  use gearsweep_coefficients, only: scheme_collocation, scheme_rk4
  use gearsweep_kinds, only: dp
  use gearsweep_oscillator, only: oscillator_t, resolving_steps
  use gearsweep_periodic_orbit, only: distance, unbounded
  use gearsweep_status, only: has_result, status_inexact, status_marginal
  use gearsweep_steady_motion, only: accuracy_t, point_t, steady_t
  implicit none
  private
  public :: accuracy_t, point_t, compare, is_estimated, leave_unknown, mark_inexact

contains

  !> The dynamic factor of a point whose steady motion is found, and its error by the solution with half the steps.
  elemental subroutine compare(osc, duration, half, point)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration             !< of the mesh period, s
    type(steady_t), intent(in) :: half           !< the motion with half the steps
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
      if (point%steps < 3*resolving_steps(osc, duration)*osc%mesh%deviations%periods) raise = 3
    end if
  end function raise_for

  !> The same of what is of fourth order, as by Runge-Kutta steps that end at the breaks: a fifteenth of the difference, three
  !> times raised. Where contact changes somewhere within steps no order shows: five times the difference.
  pure real(dp) function fourth_order_error(difference, partial)
    real(dp), intent(in) :: difference           !< of dynamic factors, motions in static deflections or transmission errors
    logical, intent(in) :: partial               !< contact changes

    fourth_order_error = merge(5*difference, difference/5, partial)
  end function fourth_order_error

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
    point%dte_estimate = point%step_error
  end subroutine leave_unknown

  !> Marks a result whose estimate exceeds the tolerance.
  elemental subroutine mark_inexact(options, point)
    type(accuracy_t), intent(in) :: options
    type(point_t), intent(inout) :: point

    if (.not. has_result(point%steady%status) .or. ieee_is_nan(point%estimate)) return
    if (.not. point%estimate <= options%steady%tolerance) point%steady%status = status_inexact
  end subroutine mark_inexact
end module gearsweep_error_estimate
