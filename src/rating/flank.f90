!> Flank contact: Hertz pressure, sliding, flash temperature and film, and the contact stress and load factors of ISO 6336.
!>
!> Contact stress by ISO 6336-2: the factors of the nominal value at the pitch point, and those that convert it to the inner
!> point of single pair contact. Load factors and rim factor convert nominal stresses to those of the tooth.
module gearsweep_rating_flank
  use gearsweep_base, only: dp, no_number, pi
  use gearsweep_gear, only: corner_contact, corner_t, drive, pair_t
  use gearsweep_elastic, only: contact_half_width, harmonic_mean, material_t
  implicit none
  private
  public :: surfaces_t, contact_t, flank_contact, rolling_arm, sliding_ratio, flash_factor, flank_factors_t, flank_factors, &
            nominal_flank_stress, load_factors_t, root_face_load_factor, rim_factor, contact_stress, tooth_root_stress

  !> Flanks and the oil between them.
  type :: surfaces_t
    type(material_t) :: material(2)              !< materials of pinion and gear
    real(dp) :: conductivity(2) = 49             !< thermal conductivities, W/(m K)
    real(dp) :: specific_heat(2) = 484           !< specific heat capacities, J/(kg K)
    real(dp) :: viscosity = 0.03_dp              !< dynamic viscosity of the oil at the inlet of the contact, Pa s
    real(dp) :: pressure_viscosity = 20e-9_dp    !< pressure-viscosity coefficient, 1/Pa
  end type surfaces_t

  !> Contact of a pair. Beyond A and E a sharp corner touches, which has no radius of curvature: there the pressure and all results
  !> that depend on it are NaN, and the film is NaN under any load.
  type :: contact_t
    real(dp) :: rolling(2) = 0                   !< rolling speeds of both flanks, m/s
    real(dp) :: sliding = 0                      !< sliding speed, that of the pinion less that of the gear, m/s
    real(dp) :: specific_sliding(2) = 0          !< specific sliding: sliding speed over the flank's own rolling speed
    real(dp) :: pressure = 0                     !< largest contact pressure, Pa
    real(dp) :: half_width = 0                   !< half width of the contact, m
    real(dp) :: shear_stress = 0                 !< largest shear stress below the surface, Pa
    real(dp) :: shear_depth = 0                  !< its depth, m
    real(dp) :: flash = 0                        !< flash temperature, the rise within the contact, K
    real(dp) :: film = 0                         !< minimum film thickness, m
    real(dp) :: friction_power = 0               !< friction power, W
  end type contact_t

  !> Largest temperature, over q/(B sqrt(2 a v)), of a half plane that moves at the speed v through a band of heat of the half width
  !> a, distributed as Hertz's pressure, with q the power per length and B the thermal contact coefficient: 1.11 by Blok.
  real(dp), parameter :: flash_factor = 1.11155_dp

  !> Factors of the contact stress.
  type :: flank_factors_t
    real(dp) :: zone = 0                         !< zone factor Z_H
    real(dp) :: elasticity = 0                   !< elasticity factor Z_E, Pa**0.5
    real(dp) :: contact_ratio = 0                !< contact ratio factor Z_eps
    real(dp) :: helix = 1                        !< helix angle factor Z_beta
    !> Single pair tooth contact factors Z_B of the pinion and Z_D of the gear: contact stress at the inner point of single
    !> pair contact over that at the pitch point, where it is larger.
    real(dp) :: single_pair(2) = 1
  end type flank_factors_t

  !> Load factors apart from the dynamic factor K_v, which depends on the speed.
  type :: load_factors_t
    real(dp) :: application = 1                  !< application factor K_A
    real(dp) :: face_load = 1                    !< face load factor K_H_beta, for the uneven load over the face width
    real(dp) :: transverse = 1  !< transverse load factors K_H_alpha and K_F_alpha, for the uneven load of the pairs
  end type load_factors_t

contains

  !> Contact of the pair at path coordinate `s` under `load` (N).
  !> Sources: ISO 21771:2007, section 5 (sliding); Johnson 1985, Contact Mechanics, section 4.2 (pressure; largest shear stress in
  !> the plane of rotation); Blok 1937, Institution of Mechanical Engineers, General Discussion on Lubrication 2, 222, as in ISO/TR
  !> 13989-1 (flash temperature); Dowson 1968, Proc. Institution of Mechanical Engineers 182(3A), 151 (film).
  elemental type(contact_t) function flank_contact(pair, surfaces, friction, speed, s, load) result(contact)
    type(pair_t), intent(in) :: pair
    type(surfaces_t), intent(in) :: surfaces
    real(dp), intent(in) :: friction             !< coefficient of friction
    real(dp), intent(in) :: speed                !< speed of the pinion, rad/s
    real(dp), intent(in) :: s, load
    real(dp), parameter :: golden = (sqrt(5.0_dp) - 1)/2
    real(dp) :: line_load, radius(2), share(2)

    associate (z => pair%gear%spec%teeth)
      contact%rolling = speed*rolling_arm(pair, [1, 2], s)*[1.0_dp, real(z(1), dp)/z(2)]
    end associate
    contact%sliding = contact%rolling(1) - contact%rolling(2)
    contact%specific_sliding = no_number()
    where (contact%rolling > 0) contact%specific_sliding = [1, -1]*contact%sliding/contact%rolling
    contact%friction_power = friction*load*abs(contact%sliding)
    if (.not. (s >= 0 .and. s <= pair%contact_ratio)) then
      ! These results do not exist at a corner.
      contact%pressure = no_number()
      contact%half_width = no_number()
      contact%shear_stress = no_number()
      contact%shear_depth = no_number()
      contact%flash = no_number()
      contact%film = no_number()
      return
    end if
    line_load = load/minval(pair%gear%spec%face_width)
    radius = pair%curvature([1, 2], s)
    contact%half_width = contact_half_width(surfaces%material(1), surfaces%material(2), .true., line_load, radius(1), radius(2))
    contact%film = no_number()
    if (.not. contact%half_width > 0) return
    contact%pressure = 2*line_load/(pi*contact%half_width)
    contact%shear_stress = sqrt(golden)*(1 - golden)*contact%pressure
    contact%shear_depth = sqrt(golden)*contact%half_width
    share = sqrt(surfaces%conductivity*surfaces%material%density*surfaces%specific_heat*contact%rolling)
    contact%flash = flash_factor*friction*line_load*abs(contact%sliding)/(sum(share)*sqrt(2*contact%half_width))
    contact%film = film_thickness(surfaces, line_load, sum(contact%rolling)/2, product(radius)/sum(radius))
  end function flank_contact

  !> Minimum film thickness (m) between two cylinders with the reduced radius of curvature `radius` (m) under `line_load` (N/m),
  !> whose surfaces enter at the mean speed `entrainment` (m/s): H = 2.65 U**0.7 G**0.54 W**-0.13 (Dowson 1968).
  elemental real(dp) function film_thickness(surfaces, line_load, entrainment, radius) result(film)
    type(surfaces_t), intent(in) :: surfaces
    real(dp), intent(in) :: line_load, entrainment, radius
    real(dp) :: modulus, speed_number, material_number, load_number

    ! Of the moduli for plane strain, E/(1 - nu**2).
    associate (m => surfaces%material)
      modulus = harmonic_mean(m(1)%young/(1 - m(1)%poisson**2), m(2)%young/(1 - m(2)%poisson**2))
    end associate
    speed_number = surfaces%viscosity*entrainment/(modulus*radius)
    material_number = surfaces%pressure_viscosity*modulus
    load_number = line_load/(modulus*radius)
    film = 2.65_dp*radius*speed_number**0.7_dp*material_number**0.54_dp/load_number**0.13_dp
  end function film_thickness

  !> Distance (m) along the common normal of the flanks from the contact at `s` to the foot of the perpendicular from a gear's
  !> centre: times the gear's angular speed it is the rolling speed of its flank. On the path of contact it is the radius of
  !> curvature.
  elemental real(dp) function rolling_arm(pair, gear, s) result(arm)
    type(pair_t), intent(in) :: pair
    integer, intent(in) :: gear
    real(dp), intent(in) :: s
    type(corner_t) :: corner
    integer :: tooth

    arm = pair%curvature(gear, s)
    if (s >= 0 .and. s <= pair%contact_ratio) return
    corner = corner_contact(pair, s)
    arm = corner%curvature
    tooth = merge(2, 1, s < 0)                   ! gear whose corner touches
    if (gear == tooth) arm = sqrt(pair%radius(tooth, merge(0.0_dp, pair%contact_ratio, s < 0))**2 &
                                    - (corner%lever*pair%gear(tooth)%base_radius(drive))**2)
  end function rolling_arm

  !> Sliding speed over the speed of the base circles, with the sign of `sliding`.
  elemental real(dp) function sliding_ratio(pair, s) result(ratio)
    type(pair_t), intent(in) :: pair
    real(dp), intent(in) :: s

    ratio = rolling_arm(pair, 1, s)/pair%gear(1)%base_radius(drive) - rolling_arm(pair, 2, s)/pair%gear(2)%base_radius(drive)
  end function sliding_ratio

  !> Factors of a pair. They apply to contact ratios from 1 to 2; above 2 no pair carries the full load, and Z_B and Z_D are 1, as
  !> Z_eps covers the load sharing on the safe side.
  !> For helical gears, Z_B - 1 and Z_D - 1 decrease linearly with the overlap ratio, to 0 at an overlap ratio of 1.
  !> Source: ISO 6336-2:2006, clauses 6 (Z_H, Z_B, Z_D), 7 (Z_E), 8 (Z_eps) and 9; Z_beta as its corrigendum
  !> of 2008 has it.
  pure function flank_factors(pair, young, poisson) result(factors)
    type(pair_t), intent(in) :: pair
    real(dp), intent(in) :: young(2)             !< moduli of elasticity of pinion and gear, Pa
    real(dp), intent(in) :: poisson(2)           !< their Poisson's ratios
    type(flank_factors_t) :: factors
    real(dp) :: tangent, single(2), overlap

    associate (angle => pair%gear(1)%transverse_angle(drive), working => pair%working_angle(drive))
      factors%zone = sqrt(2*cos(pair%gear(1)%base_helix())*cos(working)/sin(working))/cos(angle)
    end associate
    overlap = min(pair%overlap_ratio, 1.0_dp)
    factors%elasticity = 1/sqrt(pi*sum((1 - poisson**2)/young))
    factors%contact_ratio = sqrt((4 - pair%contact_ratio)/3*(1 - overlap) + overlap/pair%contact_ratio)
    factors%helix = 1/sqrt(cos(pair%gear(1)%spec%helix_angle))
    if (pair%contact_ratio > 2) return
    ! Products of the radii of curvature: at the pitch point, and where the previous or next pair begins to share.
    tangent = product(pair%gear%base_radius(drive))*tan(pair%working_angle(drive))**2
    single = [product(pair%curvature([1, 2], pair%contact_ratio - 1)), product(pair%curvature([1, 2], 1.0_dp))]
    factors%single_pair = max(1.0_dp, sqrt(tangent/single))
    factors%single_pair = factors%single_pair - overlap*(factors%single_pair - 1)
  end function flank_factors

  !> Nominal contact stress sigma_H0 at the pitch point (Pa), from the tangential load F_t on the reference circle.
  !> Source: ISO 6336-2:2006, clause 5.
  pure real(dp) function nominal_flank_stress(pair, factors, tangential_load) result(stress)
    type(pair_t), intent(in) :: pair
    type(flank_factors_t), intent(in) :: factors
    real(dp), intent(in) :: tangential_load      !< F_t, N
    real(dp) :: ratio

    associate (spec => pair%gear%spec)
      ratio = real(spec(2)%teeth, dp)/spec(1)%teeth
      stress = factors%zone*factors%elasticity*factors%contact_ratio*factors%helix* &
               sqrt(tangential_load/(2*pair%gear(1)%reference_radius*minval(spec%face_width))*(ratio + 1)/ratio)
    end associate
  end function nominal_flank_stress

  !> Face load factor of the root stress, K_F_beta = K_H_beta**N_F, N_F = 1/(1 + h/b + (h/b)^2), with h/b at most 1/3, and h the
  !> larger tooth height of the two.
  !> Source: ISO 6336-1:2006, clause 7.
  pure real(dp) function root_face_load_factor(pair, face_load) result(factor)
    type(pair_t), intent(in) :: pair
    real(dp), intent(in) :: face_load            !< K_H_beta
    real(dp) :: slender

    slender = min(1/3.0_dp, maxval(pair%gear%tip_radius - pair%gear%root_radius)/minval(pair%gear%spec%face_width))
    factor = face_load**(1/(1 + slender + slender**2))
  end function root_face_load_factor

  !> Rim thickness factor Y_B of a rim s_R below a tooth of the height h_t: 1 from s_R/h_t = 1.2 on, and 1.6 ln(2.242 h_t/s_R)
  !> below, down to 0.5, the limit of the standard; 1 for a solid gear (s_R = 0).
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
end module gearsweep_rating_flank
