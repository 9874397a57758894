!> An operating point, and the estimate of its error from the solution with half the steps.
module gearsweep_error_estimate
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan, ieee_quiet_nan, ieee_value
  use gearsweep_coefficients, only: resolution_t, scheme_collocation, scheme_rk4
  use gearsweep_kinds, only: dp
  use gearsweep_oscillator, only: oscillator_t
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
  end type point_t

contains

  !> The dynamic factor of a point whose steady motion is found, and its error by the solution with half the steps.
  elemental subroutine compare(osc, duration, half, point)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration             !< of the mesh period, s
    type(steady_t), intent(in) :: half           !< the motion with half the steps
    type(point_t), intent(inout) :: point

    if (point%resolution%scheme == scheme_rk4 .and. .not. has_result(half%status)) then
      call leave_unknown(osc, point)
      return
    end if
    point%dynamic_factor = point%steady%peak/osc%load
    point%step_error = unbounded
    if (has_result(half%status)) then
      point%step_error = doubling_error(abs(point%steady%peak - half%peak)/osc%load, &
                                        max(distance(osc, duration, point%steady%state - half%state), &
                                            abs(point%steady%checksum - half%checksum)/osc%static_deflection))
      if (point%resolution%scheme == scheme_rk4) &
        point%step_error = rk4_error(max(abs(point%steady%peak - half%peak)/osc%load, &
                                         distance(osc, duration, point%steady%state - half%state)), point%steady%departs)
      ! Where strong damping ends contact within a step or two, the order does not show.
      if (osc%damping_ratio > 1 .and. point%steady%departs) point%step_error = 20*point%step_error
      if (point%resolution%graded_for > 0) &
        point%step_error = graded_error(point%step_error, abs(point%steady%checksum - half%checksum)/osc%static_deflection)
      ! So near to 1 that the error of the steps decides on which side.
      if (has_result(point%steady%status) .and. &
          abs(point%steady%multiplier - 1) < abs(point%steady%multiplier - half%multiplier)) point%steady%status = status_marginal
    end if
    point%estimate = point%step_error + point%steady%closure
  end subroutine compare

  !> Error of a result of sixth order from its difference to half the steps: a 63rd of it, three times raised, as the
  !> order is less where the stiffness is less smooth. The difference of the motions counts too, as the largest loads
  !> may differ little by chance.
  pure real(dp) function doubling_error(peak, state)
    real(dp), intent(in) :: peak                 !< difference of the dynamic factors
    real(dp), intent(in) :: state                !< difference of the motions, in static deflections

    doubling_error = max(peak, state/4)/20
  end function doubling_error

  !> The same in graded steps: again three times raised, as in long steps the order is less, down to the third where the
  !> stiffness is least smooth. The checksum counts in full: it is taken soon behind the breaks, where the steps are
  !> short, and at the end of an interval the motion no longer shows the error made there.
  pure real(dp) function graded_error(equal, behind)
    real(dp), intent(in) :: equal                !< estimate as in equal steps
    real(dp), intent(in) :: behind               !< difference of the checksums, in static deflections

    graded_error = 3*max(equal, doubling_error(0.0_dp, 3*behind))
  end function graded_error

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
