!> Deflection of one loaded tooth by a formula: bending with its body, and flattening at the contact.
!>
!> Source: Markovic, Vrcan 2016 (Influence of tip relief profile modification on involute spur gear stress, Trans. FAMENA 40(2)), as
!> Thamba et al. 2020 print them (Eqs. 2 to 15), with their misprints corrected: doc/deflection_relief.md tells of each.
module gearsweep_deflection_formula
  use gearsweep_gear, only: drive, gear_t
  use gearsweep_kinds, only: dp, pi
  use gearsweep_material, only: material_t
  implicit none
  private
  public :: formula_deflection_t, formula_deflection, formula_relief

  type :: formula_deflection_t
    real(dp) :: height = 0                       !< y_p: of the load along the tooth's axis, above the root circle, m
    real(dp) :: bending = 0                      !< delta_b: of the tooth on its body, m
    real(dp) :: flattening = 0                   !< delta_H: of this flank at the contact, m
  end type formula_deflection_t

contains

  !> Deflection of a tooth of `gear` under `line_load` (N/m) at `radius` (m) of its drive flank, along the line of action.
  !> `half_width` (m): of the contact there (Hertz), above 0.
  pure type(formula_deflection_t) function formula_deflection(gear, material, line_load, half_width, radius) result(tooth)
    type(gear_t), intent(in) :: gear
    type(material_t), intent(in) :: material
    real(dp), intent(in) :: line_load, half_width, radius
    real(dp), parameter :: milli = 1e3_dp
    real(dp) :: unit_deflection

    unit_deflection = line_load*(1 - material%poisson**2)/material%young
    associate (x => gear%spec%profile_shift, z => real(gear%spec%teeth, dp), m => gear%spec%module)
      ! Eqs. 8 to 13: the angle alpha_b - omega_b is that between the tooth's axis and the ray to the point.
      tooth%height = radius*cos(gear%half_angle(drive, radius)) - gear%root_radius
      tooth%bending = unit_deflection*(-1.05_dp + 153*exp(-8.1_dp*x)*z**(-(1.75_dp - 1.6_dp*x)) &
                                + (0.63_dp + (7.35_dp - 0.924_dp*x)/z)*exp((1.28_dp - (2.88_dp + 3.68_dp*x)/z)*tooth%height/m) &
                                - 1.06_dp + 0.638_dp*log(milli*m*z))
      tooth%flattening = 2/pi*unit_deflection*(1.27_dp + 0.781_dp*log(m/half_width))
    end associate
  end function formula_deflection

  !> The tip relief (m) that Eq. 16 has for this deflection: bending and half the flattening, or `all` of it.
  elemental real(dp) function formula_relief(tooth, all) result(relief)
    type(formula_deflection_t), intent(in) :: tooth
    logical, intent(in) :: all

    relief = tooth%bending + merge(1.0_dp, 0.5_dp, all)*tooth%flattening
  end function formula_relief
end module gearsweep_deflection_formula
