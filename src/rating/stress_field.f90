!> Stress field of a section under one position of the load, for pictures of the root rating.
module gearsweep_rating_stress_field
  use gearsweep_base, only: code_input, dp, error_t, fail, str
  use gearsweep_elastic, only: grid_t, loaded_stress, section_body_t
  use gearsweep_rating_root_rating, only: root_rating_t
  implicit none
  private
  public :: stress_field_t, find_stress_field

  type :: stress_field_t
    integer :: relief = 0                        !< index of the relief
    integer :: position = 0                      !< index of the load position
    type(grid_t) :: grid
    real(dp), allocatable :: stress(:, :)        !< sigma_x, sigma_y, tau_xy at the nodes (3, nodes), Pa
  end type stress_field_t

contains

  !> Finds the stress field of the relief with the largest tension, under the load position of that tension or under another one.
  subroutine find_stress_field(section, rating, load, position, field, error)
    type(section_body_t), intent(in) :: section  !< section of `rating`, the finer of the two
    type(root_rating_t), intent(in) :: rating(:)  !< one for each relief
    real(dp), intent(in) :: load                 !< static load over the face width, N/m
    integer, intent(in) :: position              !< index of the load position, from 1; 0: that of the largest tension
    type(stress_field_t), intent(out) :: field
    type(error_t), allocatable, intent(inout) :: error   !< position out of range, or out of memory

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
end module gearsweep_rating_stress_field
