!> Natural frequencies of a gear section, with their discretisation error.
module gearsweep_modal
  use gearsweep_kinds, only: dp
  use gearsweep_error, only: error_t
  use gearsweep_modes, only: modes_t, find_modes
  use gearsweep_section, only: section_t
  use gearsweep_section_body, only: section_body_t, step_ratio
  implicit none
  private
  public :: section_modes, modal_t

  type :: modal_t
    type(section_t) :: section
    type(modes_t) :: modes
    type(modes_t) :: coarse                      !< those of the second grid
    real(dp), allocatable :: error_estimate(:)   !< of each frequency, relative
  end type modal_t

contains

  !> The lowest `count` modes of a section, from its two grids (make_two_grids). The error estimate is
  !> their difference over the ratio of steps squared less one: second order, between the fourth of smooth
  !> fields and the 1.5 or so of the singular held corners.
  subroutine section_modes(grids, count, product, error)
    type(section_body_t), intent(in) :: grids(2)
    integer, intent(in) :: count
    type(modal_t), intent(out) :: product
    type(error_t), allocatable, intent(out) :: error

    product%section = grids(1)%section
    call modes_of(grids(1), count, product%modes, error)
    if (allocated(error)) return
    call modes_of(grids(2), count, product%coarse, error)
    if (allocated(error)) return
    product%error_estimate = abs((product%coarse%frequency/product%modes%frequency - 1)/(step_ratio(grids)**2 - 1))
  end subroutine section_modes

  !> Modes for the section's own stiffness and width.
  subroutine modes_of(grid, count, modes, error)
    type(section_body_t), intent(in) :: grid
    integer, intent(in) :: count
    type(modes_t), intent(out) :: modes
    type(error_t), allocatable, intent(out) :: error

    call find_modes(grid%body, count, modes, error)
    if (allocated(error)) return
    modes%frequency = modes%frequency*sqrt(grid%material%young/grid%body%material%young)
    modes%shape = modes%shape*sqrt(grid%body%thickness/grid%section%gear%spec%face_width)
  end subroutine modes_of
end module gearsweep_modal
