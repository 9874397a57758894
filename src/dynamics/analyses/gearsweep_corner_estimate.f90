!> What the stiffness at tip corners leaves open of a dynamic factor.
module gearsweep_corner_estimate
  use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
  use gearsweep_error, only: error_t
  use gearsweep_error_estimate, only: accuracy_t, point_t
  use gearsweep_kinds, only: dp
  use gearsweep_mesh, only: corner_uncertainty
  use gearsweep_operating_point, only: solve_point
  use gearsweep_oscillator, only: make_oscillator, mesh_period, oscillator_t
  use gearsweep_refinement, only: levels_t
  use gearsweep_status, only: has_result
  implicit none
  private
  public :: find_corner_estimate

contains

  !> By how much the dynamic factor changes where the stiffness beyond A and E is less by `corner_uncertainty` of it; NaN
  !> where one of both has no result. With tip corners that much softer the motion is looked for beside the `known` one;
  !> without `known`, both are solved by themselves.
  subroutine find_corner_estimate(osc, rpm, options, estimate, known)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm                  !< speed of the pinion, 1/min
    type(accuracy_t), intent(in) :: options
    real(dp), intent(out) :: estimate            !< of the dynamic factor
    type(point_t), intent(in), optional :: known
    type(oscillator_t) :: softer
    type(point_t) :: point, other
    type(error_t), allocatable :: error

    estimate = ieee_value(1.0_dp, ieee_quiet_nan)
    if (present(known)) then
      point = known
    else
      call solve(osc, point)
    end if
    if (.not. has_result(point%steady%status)) return
    softer = osc
    softer%mesh = osc%mesh%with_softer_corners(corner_uncertainty)
    call make_oscillator(softer, error)
    if (allocated(error)) return
    if (present(known)) then
      call solve(softer, other, known%steady%state)
    else
      call solve(softer, other)
    end if
    if (has_result(other%steady%status)) estimate = abs(other%dynamic_factor - point%dynamic_factor)

  contains

    subroutine solve(one, found, start)
      type(oscillator_t), intent(in) :: one
      type(point_t), intent(out) :: found
      real(dp), intent(in), optional :: start(2)
      type(levels_t), allocatable :: levels

      allocate (levels)
      call solve_point(one, mesh_period(one%mesh%teeth(1), rpm), options, levels, found, start)
    end subroutine solve
  end subroutine find_corner_estimate
end module gearsweep_corner_estimate
