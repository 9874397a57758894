!> Stress all over a section under one position of the load, for pictures of what the root rating found.
module gearsweep_stress_field
  use gearsweep_error, only: code_input, error_t, fail
  use gearsweep_grid, only: grid_t
  use gearsweep_kinds, only: dp
  use gearsweep_root_rating, only: root_rating_t
  use gearsweep_section_body, only: section_body_t
  use gearsweep_section_stress, only: loaded_stress
  use gearsweep_text, only: str
  implicit none
  private
  public :: stress_field_t, find_stress_field

  type :: stress_field_t
    integer :: relief = 0                        !< which of the reliefs
    integer :: position = 0                      !< which of the positions of the load
    type(grid_t) :: grid
    real(dp), allocatable :: stress(:, :)        !< sigma_x, sigma_y, tau_xy at the nodes (3, nodes), Pa
  end type stress_field_t

contains

  !> The field of the relief with the largest tension, under the load where that tension occurs or at another position.
  subroutine find_stress_field(section, rating, load, position, field, error)
    type(section_body_t), intent(in) :: section  !< that `rating` was found with, the finer of the two
    type(root_rating_t), intent(in) :: rating(:)  !< one for each relief
    real(dp), intent(in) :: load                 !< static load over the face width, N/m
    integer, intent(in) :: position              !< of the load, from 1; 0: where the tension is largest
    type(stress_field_t), intent(out) :: field
    type(error_t), allocatable, intent(inout) :: error   !< there is no such position, or no memory

    field%relief = maxloc(rating%stress%tension%stress, 1)
    associate (worst => rating(field%relief))
      field%position = position
      if (position == 0) field%position = worst%stress%tension%load
      if (field%position > size(worst%s)) then
        call fail(error, code_input, 'position of the load of the stress field = '//str(position)//': must be at most '// &
                  str(size(worst%s))// &
                  ', as the load has so many positions')
        return
      end if
      call loaded_stress(section, worst%radius(field%position), load*worst%share(field%position), field%stress, error)
      field%grid = section%section%grid
    end associate
  end subroutine find_stress_field
end module gearsweep_stress_field
