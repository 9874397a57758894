!> Numbers in ascending order, by LAPACK.
module gearsweep_base_sorting
  use gearsweep_base_kinds, only: dp
  use gearsweep_base_lapack, only: dlasrt
  implicit none
  private
  public :: sorted

contains

  !> Values in ascending order; none may be NaN.
  pure function sorted(values) result(list)
    real(dp), intent(in) :: values(:)
    real(dp) :: list(size(values))
    integer :: info

    list = values
    call dlasrt('I', size(list), list, info)
  end function sorted
end module gearsweep_base_sorting
