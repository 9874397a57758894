!> Allowable stress numbers of some common gear materials, by quality grade.
!>
!> Source: ISO 6336-5:2016, Table 1 (Method B): sigma_Hlim and sigma_Flim = A x + B with the surface hardness x, for which each
!> material stands here with one value within its range. The text of the standard was not at hand: A and B are as public programs
!> have them. They hold for test gears with a failure probability of 1 %.
module gearsweep_gear_materials
  use gearsweep_kinds, only: dp
  implicit none
  private
  public :: gear_material_t, gear_materials, common_name_t, common_names, grades, contact_number, root_number

  !> Quality grades: lowest, usual and highest demands on material and heat treatment.
  character(*), parameter :: grades(3) = ['ml', 'mq', 'me']
  integer, parameter, public :: material_length = 20
  real(dp), parameter :: mega = 1e6_dp
  !> Of sigma_FE: the stress correction factor Y_ST of the test gears.
  real(dp), parameter, public :: test_gear_correction = 2

  type :: gear_material_t
    character(material_length) :: name = ''
    real(dp) :: hardness = 0                     !< of the surface, HBW or HV
    real(dp) :: contact(2, 3) = 0                !< A and B of sigma_Hlim, MPa; (coefficient, grade)
    real(dp) :: root(2, 3) = 0                   !< the same of sigma_Flim
  end type gear_material_t

  type(gear_material_t), parameter :: gear_materials(*) = [ &
    & gear_material_t('normalized_steel', 160, &
    &   reshape([1.0_dp, 190.0_dp, 1.0_dp, 190.0_dp, 1.52_dp, 250.0_dp], [2, 3]), &
    &   reshape([0.455_dp, 69.0_dp, 0.455_dp, 69.0_dp, 0.386_dp, 147.0_dp], [2, 3])), &
    & gear_material_t('grey_cast_iron', 200, &
    &   reshape([1.033_dp, 132.0_dp, 1.033_dp, 132.0_dp, 1.465_dp, 122.0_dp], [2, 3]), &
    &   reshape([0.256_dp, 8.0_dp, 0.256_dp, 8.0_dp, 0.2_dp, 53.0_dp], [2, 3])), &
    & gear_material_t('malleable_cast_iron', 200, &
    &   reshape([1.371_dp, 143.0_dp, 1.371_dp, 143.0_dp, 1.333_dp, 267.0_dp], [2, 3]), &
    &   reshape([0.345_dp, 77.0_dp, 0.345_dp, 77.0_dp, 0.403_dp, 128.0_dp], [2, 3])), &
    & gear_material_t('nodular_cast_iron', 250, &
    &   reshape([1.434_dp, 211.0_dp, 1.434_dp, 211.0_dp, 1.5_dp, 250.0_dp], [2, 3]), &
    &   reshape([0.35_dp, 119.0_dp, 0.35_dp, 119.0_dp, 0.38_dp, 134.0_dp], [2, 3])), &
    & gear_material_t('carbon_steel', 200, &
    &   reshape([0.963_dp, 283.0_dp, 0.925_dp, 360.0_dp, 0.838_dp, 432.0_dp], [2, 3]), &
    &   reshape([0.25_dp, 108.0_dp, 0.24_dp, 163.0_dp, 0.283_dp, 202.0_dp], [2, 3])), &
    & gear_material_t('alloy_steel', 300, &
    &   reshape([1.313_dp, 188.0_dp, 1.313_dp, 373.0_dp, 2.213_dp, 260.0_dp], [2, 3]), &
    &   reshape([0.423_dp, 104.0_dp, 0.425_dp, 187.0_dp, 0.358_dp, 231.0_dp], [2, 3])), &
    & gear_material_t('induction_hardened', 550, &
    &   reshape([0.74_dp, 602.0_dp, 0.541_dp, 882.0_dp, 0.505_dp, 1013.0_dp], [2, 3]), &
    &   reshape([0.305_dp, 76.0_dp, 0.138_dp, 290.0_dp, 0.271_dp, 237.0_dp], [2, 3])), &
    & gear_material_t('case_hardened', 700, &
    &   reshape([0.0_dp, 1300.0_dp, 0.0_dp, 1500.0_dp, 0.0_dp, 1650.0_dp], [2, 3]), &
    &   reshape([0.0_dp, 312.0_dp, 0.0_dp, 425.0_dp, 0.0_dp, 525.0_dp], [2, 3])), &
    & gear_material_t('nitrided_alloy_steel', 550, &
    &   reshape([0.0_dp, 788.0_dp, 0.0_dp, 998.0_dp, 0.0_dp, 1217.0_dp], [2, 3]), &
    &   reshape([0.0_dp, 258.0_dp, 0.0_dp, 363.0_dp, 0.0_dp, 432.0_dp], [2, 3])), &
    & gear_material_t('nitriding_steel', 750, &
    &   reshape([0.0_dp, 1125.0_dp, 0.0_dp, 1250.0_dp, 0.0_dp, 1450.0_dp], [2, 3]), &
    &   reshape([0.0_dp, 270.0_dp, 0.0_dp, 420.0_dp, 0.0_dp, 468.0_dp], [2, 3]))]

  !> What steels and irons are called by common names, and which material each is in its usual treatment.
  type :: common_name_t
    character(material_length) :: name = ''
    character(material_length) :: material = ''
  end type common_name_t

  type(common_name_t), parameter :: common_names(*) = [ &
    & common_name_t('C45', 'carbon_steel'), &
    & common_name_t('34CrNiMo6', 'alloy_steel'), &
    & common_name_t('42CrMo4', 'alloy_steel'), &
    & common_name_t('16MnCr5', 'case_hardened'), &
    & common_name_t('17CrNi6-6', 'case_hardened'), &
    & common_name_t('18CrNiMo7-6', 'case_hardened'), &
    & common_name_t('20MnCr5', 'case_hardened'), &
    & common_name_t('20MoCr4', 'case_hardened'), &
    & common_name_t('31CrMoV9', 'nitriding_steel'), &
    & common_name_t('34CrAlNi7-10', 'nitriding_steel'), &
    & common_name_t('GJL', 'grey_cast_iron'), &
    & common_name_t('GG', 'grey_cast_iron'), &
    & common_name_t('GJMB', 'malleable_cast_iron'), &
    & common_name_t('GTS', 'malleable_cast_iron'), &
    & common_name_t('GJS', 'nodular_cast_iron'), &
    & common_name_t('GGG', 'nodular_cast_iron')]

contains

  !> sigma_Hlim (Pa) of a material in the quality grade of this place in `grades`.
  elemental real(dp) function contact_number(material, grade) result(number)
    type(gear_material_t), intent(in) :: material
    integer, intent(in) :: grade

    number = mega*(material%contact(1, grade)*material%hardness + material%contact(2, grade))
  end function contact_number

  !> sigma_Flim (Pa), the nominal stress number for bending, in the same way.
  elemental real(dp) function root_number(material, grade) result(number)
    type(gear_material_t), intent(in) :: material
    integer, intent(in) :: grade

    number = mega*(material%root(1, grade)*material%hardness + material%root(2, grade))
  end function root_number
end module gearsweep_gear_materials
