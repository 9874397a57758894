!> Natural frequencies of a gear section, with their discretisation error.
module gearsweep_modal
  use gearsweep_kinds, only: dp
  use gearsweep_body, only: body_t, make_body
  use gearsweep_error, only: error_t
  use gearsweep_gear, only: gear_t
  use gearsweep_material, only: material_t
  use gearsweep_modes, only: modes_t, find_modes
  use gearsweep_section, only: section_t, section_options_t, make_section
  implicit none
  private
  public :: section_modes, modal_t

  type :: modal_t
    type(section_t) :: section
    type(modes_t) :: modes
    real(dp), allocatable :: error_estimate(:)   !< of each frequency, relative
  end type modal_t

contains

  !> The lowest `count` modes of a section of `gear`. The error estimate is what
  !> a grid of half the fineness differs by, over the ratio of steps squared
  !> less one: second order, between the fourth of smooth fields and the 1.5 or so
  !> of the singular held corners.
  subroutine section_modes(gear, material, options, count, product, error)
    type(gear_t), intent(in) :: gear
    type(material_t), intent(in) :: material
    type(section_options_t), intent(in) :: options
    integer, intent(in) :: count
    type(modal_t), intent(out) :: product
    type(error_t), allocatable, intent(out) :: error
    type(section_options_t) :: coarser
    type(section_t) :: section
    type(modes_t) :: coarse
    real(dp) :: ratio

    call on_one_grid(options, product%section, product%modes)
    if (allocated(error)) return
    coarser = options
    coarser%elements_across = max(3, options%elements_across/2)
    if (coarser%elements_across == options%elements_across) coarser%elements_across = options%elements_across + 1
    coarser%others_across = merge(0, max(3, options%others_across/2), options%others_across == 0)
    call on_one_grid(coarser, section, coarse)
    if (allocated(error)) return
    ratio = real(options%elements_across, dp)/coarser%elements_across
    product%error_estimate = abs((coarse%frequency/product%modes%frequency - 1)/(ratio**2 - 1))

  contains

    subroutine on_one_grid(grid_options, part, modes)
      type(section_options_t), intent(in) :: grid_options
      type(section_t), intent(out) :: part
      type(modes_t), intent(out) :: modes
      type(body_t) :: body

      call make_section(gear, grid_options, part, error)
      if (allocated(error)) return
      call make_body(part%grid, material, options%plane_strain, gear%spec%face_width, &
                     spread(part%is_held(), 1, 2), options%most_memory, body, error)
      if (allocated(error)) return
      call find_modes(body, count, modes, error)
    end subroutine on_one_grid
  end subroutine section_modes
end module gearsweep_modal
