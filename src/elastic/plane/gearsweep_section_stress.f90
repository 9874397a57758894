!> Stress all over a section whose tooth is loaded, for pictures.
module gearsweep_section_stress
  use gearsweep_kinds, only: dp
  use gearsweep_compliance, only: flank_load
  use gearsweep_error, only: error_t
  use gearsweep_gear, only: gear_t
  use gearsweep_material, only: material_t
  use gearsweep_memory, only: claim_memory
  use gearsweep_text, only: str
  use gearsweep_nodal_stress, only: nodal_stress
  use gearsweep_section, only: section_options_t
  use gearsweep_section_body, only: section_body_t, make_section_body
  implicit none
  private
  public :: section_stress, loaded_stress

contains

  !> Stress components sigma_x, sigma_y, tau_xy at the nodes of the section's
  !> grid (3, nodes), Pa, under `line_load` (N/m) on the drive flank at `radius` (m).
  subroutine section_stress(gear, material, options, radius, line_load, stress, error)
    type(gear_t), intent(in) :: gear
    type(material_t), intent(in) :: material
    type(section_options_t), intent(in) :: options
    real(dp), intent(in) :: radius, line_load
    real(dp), allocatable, intent(out) :: stress(:, :)
    type(error_t), allocatable, intent(out) :: error
    type(section_body_t) :: grid

    call make_section_body(gear, material, options, grid, error)
    if (.not. allocated(error)) call loaded_stress(grid, radius, line_load, stress, error)
  end subroutine section_stress

  !> The same on a section that is made and factored already.
  subroutine loaded_stress(grid, radius, line_load, stress, error)
    type(section_body_t), intent(in) :: grid
    real(dp), intent(in) :: radius               !< where the load acts on the drive flank, m
    real(dp), intent(in) :: line_load            !< N/m
    real(dp), allocatable, intent(out) :: stress(:, :)   !< sigma_x, sigma_y, tau_xy at the nodes (3, nodes), Pa
    type(error_t), allocatable, intent(inout) :: error   !< the memory does not hold it, or the radius is not on the flank
    real(dp), allocatable :: x(:, :)

    call claim_memory(100.0_dp*grid%body%unknowns, 'static stress: the stress on '//str(grid%body%unknowns)//' unknowns', error, &
                      blas=.true.)
    if (allocated(error)) return
    allocate (x(grid%body%unknowns, 1), source=0.0_dp)
    call flank_load(grid%section, grid%body, radius, x(:, 1), error)
    if (allocated(error)) return
    call grid%body%stiffness%solve(x, error)
    if (allocated(error)) return
    stress = line_load*nodal_stress(grid%body, grid%body%spread_out(x(:, 1)))
  end subroutine loaded_stress
end module gearsweep_section_stress
