!> Contact stress of a gear pair by ISO 6336-2: the factors of the nominal value at the pitch point, and those that take it
!> to where one pair carries the whole load.
module gearsweep_flank_factors
  use gearsweep_gear, only: drive
  use gearsweep_kinds, only: dp, pi
  use gearsweep_pair, only: pair_t
  implicit none
  private
  public :: flank_factors_t, flank_factors, nominal_flank_stress

  !> For a spur gear the helix angle factor Z_beta is 1.
  type :: flank_factors_t
    real(dp) :: zone = 0                         !< zone factor Z_H
    real(dp) :: elasticity = 0                   !< elasticity factor Z_E, Pa**0.5
    real(dp) :: contact_ratio = 0                !< contact ratio factor Z_eps
    !> Single pair tooth contact factors Z_B of the pinion and Z_D of the gear: contact stress at the inner point of single
    !> pair contact over that at the pitch point, where it is larger.
    real(dp) :: single_pair(2) = 1
  end type flank_factors_t

contains

  !> The factors of a pair. Contact ratios from 1 to 2; above 2 no pair carries the whole load, and Z_B and Z_D stay 1, as
  !> Z_eps says on the safe side how the load is shared.
  !> Source: ISO 6336-2:2006, clauses 6 (Z_H, Z_B, Z_D), 7 (Z_E) and 8 (Z_eps).
  pure function flank_factors(pair, young, poisson) result(factors)
    type(pair_t), intent(in) :: pair
    real(dp), intent(in) :: young(2)             !< moduli of elasticity of pinion and gear, Pa
    real(dp), intent(in) :: poisson(2)           !< their Poisson's ratios
    type(flank_factors_t) :: factors
    real(dp) :: tangent, single(2)

    associate (angle => pair%gear(1)%spec%pressure_angle(drive), working => pair%working_angle(drive))
      factors%zone = sqrt(2*cos(working)/sin(working))/cos(angle)
    end associate
    factors%elasticity = 1/sqrt(pi*sum((1 - poisson**2)/young))
    factors%contact_ratio = sqrt((4 - pair%contact_ratio)/3)
    if (pair%contact_ratio > 2) return
    ! Products of the radii of curvature: at the pitch point, and where the pair before or behind begins to share.
    tangent = product(pair%gear%base_radius(drive))*tan(pair%working_angle(drive))**2
    single = [product(curvatures(pair, pair%contact_ratio - 1)), product(curvatures(pair, 1.0_dp))]
    factors%single_pair = max(1.0_dp, sqrt(tangent/single))
  end function flank_factors

  !> Radii of curvature (m) of both flanks at a path coordinate.
  pure function curvatures(pair, s) result(radii)
    type(pair_t), intent(in) :: pair
    real(dp), intent(in) :: s
    real(dp) :: radii(2)

    radii = [pair%curvature(1, s), pair%curvature(2, s)]
  end function curvatures

  !> Nominal contact stress sigma_H0 at the pitch point (Pa), from the tangential load F_t on the reference circle.
  !> Source: ISO 6336-2:2006, clause 5.
  pure real(dp) function nominal_flank_stress(pair, factors, tangential_load) result(stress)
    type(pair_t), intent(in) :: pair
    type(flank_factors_t), intent(in) :: factors
    real(dp), intent(in) :: tangential_load      !< F_t, N
    real(dp) :: ratio

    associate (spec => pair%gear%spec)
      ratio = real(spec(2)%teeth, dp)/spec(1)%teeth
      stress = factors%zone*factors%elasticity*factors%contact_ratio* &
               sqrt(tangential_load/(2*pair%gear(1)%reference_radius*minval(spec%face_width))*(ratio + 1)/ratio)
    end associate
  end function nominal_flank_stress
end module gearsweep_flank_factors
