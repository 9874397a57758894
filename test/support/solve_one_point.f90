!> A plain prescribed mesh, and one operating point by itself.
module test_support_solve_one_point
  use gearsweep_base_kinds, only: dp, pi
  use gearsweep_base_error, only: error_t
  use gearsweep_motion_error_estimate, only: accuracy_t, levels_t, point_t
  use gearsweep_motion_operating_point, only: solve_point
  use gearsweep_motion_oscillator, only: make_oscillator, mesh_period, oscillator_t
  use test_support_reference_rows, only: prescribed
  implicit none
  private
  public :: mesh_of, solve

contains

  !> A damped prescribed mesh, ready for use; N/um and um. Without friction unless given.
  type(oscillator_t) function mesh_of(contact_ratio, coef, relief, zeta, friction) result(osc)
    real(dp), intent(in) :: contact_ratio, coef(:), relief(2), zeta
    real(dp), intent(in), optional :: friction
    type(error_t), allocatable :: error

    call prescribed(contact_ratio, coef, relief, 1, osc)
    osc%mesh%teeth = 25
    osc%mesh%pitch_point = contact_ratio/2
    osc%mesh%tan_angle = tan(20*pi/180)
    osc%mass = 0.8_dp
    osc%load = 7000
    osc%damping_ratio = zeta
    if (present(friction)) osc%friction = friction
    call make_oscillator(osc, error)
    if (allocated(error)) error stop 'test mesh'
  end function mesh_of

  subroutine solve(osc, rpm, options, point, start)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm
    type(accuracy_t), intent(in) :: options
    type(point_t), intent(out) :: point
    real(dp), intent(in), optional :: start(2)
    type(levels_t), allocatable :: tables

    allocate (tables)
    call solve_point(osc, mesh_period(osc%mesh%teeth(1), rpm), options, tables, point, start)
  end subroutine solve
end module test_support_solve_one_point
