!> What turns the nominal stresses of ISO 6336 into those that a tooth must bear: load factors, and the rim below the tooth.
module gearsweep_load_factors
  use gearsweep_kinds, only: dp
  use gearsweep_pair, only: pair_t
  implicit none
  private
  public :: load_factors_t, root_face_load_factor, rim_factor, contact_stress, tooth_root_stress

  !> Apart from the dynamic factor K_v, which depends on the speed.
  type :: load_factors_t
    real(dp) :: application = 1                  !< K_A
    real(dp) :: face_load = 1                    !< K_H_beta, how unevenly the load lies over the face width
    real(dp) :: transverse = 1                   !< K_H_alpha and K_F_alpha, how unevenly the pairs share it
  end type load_factors_t

contains

  !> Face load factor of the root stress, K_F_beta = K_H_beta**N_F, N_F = 1/(1 + h/b + (h/b)^2), where h/b counts as 1/3
  !> at most, and h is the larger tooth height of the two.
  !> Source: ISO 6336-1:2006, clause 7.
  pure real(dp) function root_face_load_factor(pair, face_load) result(factor)
    type(pair_t), intent(in) :: pair
    real(dp), intent(in) :: face_load            !< K_H_beta
    real(dp) :: slender

    slender = min(1/3.0_dp, maxval(pair%gear%tip_radius - pair%gear%root_radius)/minval(pair%gear%spec%face_width))
    factor = face_load**(1/(1 + slender + slender**2))
  end function root_face_load_factor

  !> Rim thickness factor Y_B of a rim s_R below a tooth of the height h_t: 1 from s_R/h_t = 1.2 on, and 1.6 ln(2.242 h_t/s_R)
  !> below, down to 0.5, below which the standard has none; 1 for a solid gear (s_R = 0).
  !> Source: ISO 6336-3:2006, clause 9.
  elemental real(dp) function rim_factor(rim, height) result(factor)
    real(dp), intent(in) :: rim                  !< s_R, m
    real(dp), intent(in) :: height               !< h_t, m

    factor = 1
    if (rim > 0 .and. rim < 1.2_dp*height) factor = max(1.0_dp, 1.6_dp*log(2.242_dp*height/rim))
  end function rim_factor

  !> Contact stress sigma_H (Pa) of a gear.
  !> Source: ISO 6336-2:2006, clause 5.
  elemental real(dp) function contact_stress(nominal, single_pair, factors, dynamic) result(stress)
    real(dp), intent(in) :: nominal              !< sigma_H0, Pa
    real(dp), intent(in) :: single_pair          !< Z_B or Z_D
    type(load_factors_t), intent(in) :: factors
    real(dp), intent(in) :: dynamic              !< K_v

    stress = single_pair*nominal*sqrt(factors%application*dynamic*factors%face_load*factors%transverse)
  end function contact_stress

  !> Tooth root stress sigma_F (Pa).
  !> Source: ISO 6336-3:2006, clause 5.
  elemental real(dp) function tooth_root_stress(nominal, factors, root_face_load, dynamic) result(stress)
    real(dp), intent(in) :: nominal              !< sigma_F0, Pa
    type(load_factors_t), intent(in) :: factors
    real(dp), intent(in) :: root_face_load       !< K_F_beta
    real(dp), intent(in) :: dynamic              !< K_v

    stress = nominal*factors%application*dynamic*root_face_load*factors%transverse
  end function tooth_root_stress
end module gearsweep_load_factors
