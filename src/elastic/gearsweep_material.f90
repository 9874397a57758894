!> Elastic material; steel unless said.
module gearsweep_material
  use gearsweep_kinds, only: dp
  use gearsweep_error, only: error_t, fail, code_input
  implicit none
  private
  public :: material_t, check_material, harmonic_mean

  type :: material_t
    real(dp) :: young = 206e9_dp       !< E, Pa
    real(dp) :: poisson = 0.3_dp       !< nu
    real(dp) :: density = 7850         !< kg/m^3
  end type material_t

contains

  !> 2 a b/(a + b) of two positive numbers: the modulus that stands for those of two bodies in series, each of which takes half.
  !> The same to the last bit whichever comes first; of two equal ones, that one.
  elemental real(dp) function harmonic_mean(a, b) result(mean)
    real(dp), intent(in) :: a, b

    mean = min(a, b)*(2*max(a, b)/(a + b))
  end function harmonic_mean

  !> Refuses what no elastic body has.
  pure subroutine check_material(material, error)
    type(material_t), intent(in) :: material
    type(error_t), allocatable, intent(inout) :: error

    if (.not. material%young > 0) call fail(error, code_input, 'Young''s modulus: must be above 0')
    if (.not. (material%poisson > -1 .and. material%poisson < 0.5_dp)) then
      call fail(error, code_input, 'Poisson''s ratio: must lie between -1 and 0.5')
    end if
  end subroutine check_material
end module gearsweep_material
