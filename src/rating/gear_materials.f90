!> Allowable stress numbers of common gear materials by quality grade, and their life factors.
!>
!> Source of the numbers: ISO 6336-5:2016, Table 1 (Method B): sigma_Hlim and sigma_Flim = A x + B with the surface hardness x,
!> for which each material has one value within its range. The text of the standard was not available: A and B are those of public
!> programs. They apply to test gears with a failure probability of 1 %.
!>
!> Life factors Y_NT of the tooth root and Z_NT of the flank: the strength at a number of load cycles over the endurance strength,
!> straight lines over both logarithms between a static end, a knee at 1 and 1e10 cycles, where the factor falls to 0.85 or, with
!> optimum lubrication, material, manufacturing and experience, remains up to 1.
!> Source: ISO 6336-3:2006, Table 1 (Y_NT), and ISO 6336-2:2006, Table 2 (Z_NT, without pitting). The texts of the standards were
!> not available: Z_NT is that of a public program, Y_NT that of textbooks.
module gearsweep_rating_gear_materials
  use gearsweep_base, only: dp, str
  use gearsweep_rating_root_life, only: curve_t
  implicit none
  private
  public :: gear_materials, common_names, grades, contact_number, root_number, life_curve_t, contact_life_curve, life_curve_words, &
            life_factor, root_life_curve, sn_curve

  !> Quality grades: lowest, usual and highest demands on material and heat treatment.
  character(*), parameter :: grades(3) = ['ml', 'mq', 'me']
  integer, parameter, public :: material_length = 20
  real(dp), parameter :: mega = 1e6_dp
  !> Stress correction factor Y_ST of the test gears, in sigma_FE.
  real(dp), parameter, public :: test_gear_correction = 2

  type :: gear_material_t
    character(material_length) :: name = ''
    real(dp) :: hardness = 0                     !< surface hardness, HBW or HV
    real(dp) :: contact(2, 3) = 0                !< A and B of sigma_Hlim, MPa; (coefficient, grade)
    real(dp) :: root(2, 3) = 0                   !< A and B of sigma_Flim, MPa; (coefficient, grade)
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

  !> Common names of steels and irons, and the material of each in its usual treatment.
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

  !> Life factor over the load cycles.
  type :: life_curve_t
    real(dp) :: cycles(3) = 0                    !< load cycles at static end, knee and 1e10
    real(dp) :: factor(3) = 1                    !< life factors there
  end type life_curve_t

  real(dp), parameter :: last = 1e10_dp

contains

  !> Allowable stress number sigma_Hlim (Pa) of a material; `grade` is an index in `grades`.
  elemental real(dp) function contact_number(material, grade) result(number)
    type(gear_material_t), intent(in) :: material
    integer, intent(in) :: grade

    number = mega*(material%contact(1, grade)*material%hardness + material%contact(2, grade))
  end function contact_number

  !> Nominal stress number for bending sigma_Flim (Pa) of a material; `grade` is an index in `grades`.
  elemental real(dp) function root_number(material, grade) result(number)
    type(gear_material_t), intent(in) :: material
    integer, intent(in) :: grade

    number = mega*(material%root(1, grade)*material%hardness + material%root(2, grade))
  end function root_number

  !> Life factor curve Y_NT of a material.
  pure type(life_curve_t) function root_life_curve(material, end) result(curve)
    type(gear_material_t), intent(in) :: material
    real(dp), intent(in) :: end                  !< factor at 1e10 cycles, 0.85 to 1
    real(dp), parameter :: knee = 3e6_dp

    select case (material%name)
    case ('carbon_steel', 'alloy_steel', 'nodular_cast_iron', 'malleable_cast_iron')
      ! V, GGG (perlitic, bainitic) and GTS (perlitic).
      curve = life_curve_t([1e4_dp, knee, last], [2.5_dp, 1.0_dp, end])
    case ('case_hardened', 'induction_hardened')
      curve = life_curve_t([1e3_dp, knee, last], [2.5_dp, 1.0_dp, end])
    case default
      ! St, GG, NT and NV (nitrided).
      curve = life_curve_t([1e3_dp, knee, last], [1.6_dp, 1.0_dp, end])
    end select
  end function root_life_curve

  !> Life factor curve Z_NT of a material, without pitting.
  pure type(life_curve_t) function contact_life_curve(material, end) result(curve)
    type(gear_material_t), intent(in) :: material
    real(dp), intent(in) :: end                  !< factor at 1e10 cycles, 0.85 to 1

    select case (material%name)
    case ('grey_cast_iron', 'nitriding_steel', 'nitrided_alloy_steel')
      curve = life_curve_t([1e5_dp, 2e6_dp, last], [1.3_dp, 1.0_dp, end])
    case default
      curve = life_curve_t([1e5_dp, 5e7_dp, last], [1.6_dp, 1.0_dp, end])
    end select
  end function contact_life_curve

  !> Life factor at a number of load cycles; constant below the static end and above 1e10.
  elemental real(dp) function life_factor(curve, cycles) result(factor)
    type(life_curve_t), intent(in) :: curve
    real(dp), intent(in) :: cycles
    integer :: i

    if (cycles <= curve%cycles(1)) then
      factor = curve%factor(1)
    else if (cycles >= curve%cycles(3)) then
      factor = curve%factor(3)
    else
      i = merge(1, 2, cycles < curve%cycles(2))
      associate (n => curve%cycles(i:i + 1), f => curve%factor(i:i + 1))
        factor = f(1)*(cycles/n(1))**(log(f(2)/f(1))/log(n(2)/n(1)))
      end associate
    end if
  end function life_factor

  !> Describes the curve in words: static end, knee and last point.
  pure function life_curve_words(symbol, curve) result(words)
    character(*), intent(in) :: symbol           !< Y_NT or Z_NT
    type(life_curve_t), intent(in) :: curve
    character(120) :: words

    words = symbol//' '//str(curve%factor(1))//' up to '//str(curve%cycles(1))//' cycles, 1 at the knee '// &
            str(curve%cycles(2))//', '//str(curve%factor(3))//' from '//str(curve%cycles(3))//' on'
  end function life_curve_words

  !> S-N curve from an endurance strength (Pa) and a life factor: points from the static end to the end of the curve.
  pure type(curve_t) function sn_curve(strength, curve) result(sn)
    real(dp), intent(in) :: strength
    type(life_curve_t), intent(in) :: curve
    integer :: n

    n = merge(3, 2, curve%factor(3) < curve%factor(2))
    sn%cycles = curve%cycles(:n)
    sn%stress = strength*curve%factor(:n)
    sn%is_endless = .true.
  end function sn_curve
end module gearsweep_rating_gear_materials
