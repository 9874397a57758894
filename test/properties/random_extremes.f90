!> Extreme cases drawn at random, the same in every run: changes to
!> test/properties/extreme/prescribed.nml over many orders of magnitude.
module test_properties_random_extremes
  use, intrinsic :: iso_fortran_env, only: int64
  use gearsweep_base_kinds, only: dp
  use gearsweep_base_text, only: str
  use test_properties_extreme_cases, only: row_t
  use test_support_random_numbers, only: random_t
  implicit none
  private
  public :: random_row

contains

  !> Masses 1e-6 to 1e6 apart, stiffness at the ends down to 1e-6 of that in the middle, contact ratio
  !> 1 + 1e-6 to 3, damping 1e-4 to 1000, 10 to 1e8 rpm, relief none to 100 mm on either gear, coast sides
  !> that may touch, a load of 7 kN.
  type(row_t) function random_row(number) result(row)
    integer, intent(in) :: number
    type(random_t) :: random
    real(dp) :: softer

    random%seed = 7919_int64*number + 12345
    row%title = 'random '//str(number)
    row%base = 'prescribed'
    row%quantity = 'df'
    softer = -random%power(1e-6_dp, 0.999999_dp)
    row%changes = 'pinion effective_mass_kg = '//text(random%power(1e-6_dp, 1e6_dp))// &
      '; mesh coefficients = 400, 0, '//text(400*softer)//'; mesh contact_ratio = '//text(1 + random%power(1e-6_dp, 2.0_dp))// &
      '; dynamics damping_ratio = '//text(random%power(1e-4_dp, 1e3_dp))//'; rpm = '//text(random%power(10.0_dp, 1e8_dp))// &
      '; numerics tolerance = 1e-6'
    if (random%uniform() < 0.7_dp) row%changes = row%changes//'; relief amount_um = '//text(random%power(1e-2_dp, 1e5_dp))// &
      '; relief pinion_fraction = '//text(random%uniform())
    if (random%uniform() < 0.3_dp) row%changes = row%changes//'; pair backlash_um = '//text(random%power(1e-2_dp, 1e3_dp))
  end function random_row

  function text(x)
    real(dp), intent(in) :: x
    character(:), allocatable :: text

    text = str(x, 12)
  end function text
end module test_properties_random_extremes
