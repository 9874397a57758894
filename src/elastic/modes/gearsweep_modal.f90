!> Natural frequencies of a gear section, with their discretisation error.
module gearsweep_modal
  use gearsweep_kinds, only: dp
  use gearsweep_error, only: error_t
  use gearsweep_modes, only: modes_t, find_modes
  use gearsweep_section, only: section_t
  use gearsweep_section_body, only: section_body_t, mean_step_ratio
  use gearsweep_tooth_block, only: fillet_excess
  implicit none
  private
  public :: section_modes, modal_t, estimated_errors

  type :: modal_t
    type(section_t) :: section
    type(modes_t) :: modes
    type(modes_t) :: coarse                      !< those of the second grid
    real(dp), allocatable :: error_estimate(:)   !< of each frequency, relative
  end type modal_t

contains

  !> The lowest `count` modes of a section, from its two grids (make_two_grids), with their errors:
  !> what the grids differ in, and the fillets' outline, which coarse grids have alike.
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
    product%error_estimate = outline_error(product%section) &
                             + estimated_errors(product%modes%frequency, product%coarse%frequency, mean_step_ratio(grids))
  end subroutine section_modes

  !> How much the fillets of the grid are too large, of its area: a change of mass changes frequencies by about as much.
  pure real(dp) function outline_error(section)
    type(section_t), intent(in) :: section
    integer :: k

    outline_error = abs(sum([(fillet_excess(section%gear, section%across(k)), k=1, size(section%across))]))/section%grid%area()
  end function outline_error

  !> Relative errors of `frequency(:)` (Hz), ascending, from those of a grid whose elements are `step_ratio` times as large:
  !> their difference over the ratio's square less one. Second order lies between the fourth of smooth fields and the
  !> 1.5 or so of the singular held corners. Modes that lie closer together than they move between the grids may have changed
  !> places, so that the difference is none of one mode: each gets the largest error among them.
  pure function estimated_errors(frequency, coarse, step_ratio) result(errors)
    real(dp), intent(in) :: frequency(:), coarse(:), step_ratio
    real(dp) :: errors(size(frequency))
    real(dp) :: moved(size(frequency))
    integer :: k

    moved = abs(coarse - frequency)
    do k = 1, size(frequency)
      errors(k) = maxval(moved/frequency, mask=abs(frequency - frequency(k)) <= max(moved, moved(k)))
    end do
    errors = errors/abs(step_ratio**2 - 1)
  end function estimated_errors

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
