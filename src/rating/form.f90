!> Form factors of the tooth root from its true shape: Lewis's parabola and
!> ISO 6336-3's 30 degree tangent. The load acts on the drive flank.
module gearsweep_rating_form
  use gearsweep_base, only: bracket_t, dp, pi
  use gearsweep_gear, only: coast, corner_depth, drive, fillet_parameter, fillet_point, gear_t, pair_t, teeth_around
  implicit none
  private
  public :: nominal_root_stress, lewis_factor, iso_form_t, iso_form, outer_single_contact, virtual_outer_contact, helix_factor, &
            deep_tooth_factor

  !> Root section and factors of ISO 6336-3:2006, method B.
  type :: iso_form_t
    real(dp) :: lever = 0                        !< bending lever h_Fe, m
    real(dp) :: thickness = 0                    !< root thickness s_Fn, m
    real(dp) :: radius = 0                       !< fillet radius rho_F, m
    real(dp) :: load_angle = 0                   !< load angle alpha_Fen, rad
    real(dp) :: form_factor = 0                  !< form factor Y_F
    real(dp) :: correction = 0                   !< stress correction factor Y_S
  end type iso_form_t

contains

  !> Lewis form factor Y = s^2/(6 h m) for a load at `radius` (m) on the drive flank: the weakest section s at the distance h below
  !> the intersection of line of action and tooth axis, searched over the fillet.
  !> The bending stress is F_n cos(load angle)/(b m Y).
  !> Source: Lewis 1892; Norton, Machine Design, section 12.
  pure real(dp) function lewis_factor(gear, radius) result(factor)
    type(gear_t), intent(in) :: gear
    real(dp), intent(in) :: radius
    real(dp), parameter :: golden = 0.6180339887498949_dp
    real(dp) :: low, high, apex
    integer :: i

    apex = gear%base_radius(drive)/cos(load_angle(gear, radius))
    low = gear%fillet_start(drive)
    high = pi/2
    do i = 1, 80
      if (section_factor(high - golden*(high - low)) < section_factor(low + golden*(high - low))) then
        high = low + golden*(high - low)
      else
        low = high - golden*(high - low)
      end if
    end do
    factor = section_factor((low + high)/2)

  contains

    !> Form factor of the section through a point of the drive fillet.
    pure real(dp) function section_factor(beta)
      real(dp), intent(in) :: beta
      real(dp) :: p(2), other(2), coast_x
      type(bracket_t) :: parameter

      p = fillet_point(gear, drive, beta)
      ! Distance of the coast fillet from the tooth axis at the same height, by bisection.
      parameter = bracket_t(gear%fillet_start(coast), pi/2)
      do while (parameter%is_open())
        other = fillet_point(gear, coast, parameter%middle())
        call parameter%halve(other(2) > p(2))
      end do
      other = fillet_point(gear, coast, parameter%middle())
      coast_x = other(1)
      section_factor = (p(1) + coast_x)**2/(6*(apex - p(2))*gear%spec%module)
    end function section_factor
  end function lewis_factor

  !> Angle (rad) between the load at `radius` (m) and the normal of the tooth axis.
  pure real(dp) function load_angle(gear, radius)
    type(gear_t), intent(in) :: gear
    real(dp), intent(in) :: radius

    load_angle = acos(min(1.0_dp, gear%base_radius(drive)/radius)) - gear%half_angle(drive, radius)
  end function load_angle

  !> Section at the 30 degree tangents and its factors, for a load at `radius` (m), in the standard the outer point of single pair
  !> contact. Unequal flanks have the height of the drive side. sigma_F0 = F_t/(b m) Y_F Y_S.
  !> Source: ISO 6336-3:2006, Eqs. 9 and 19; rho_F by Euler and Savary.
  pure function iso_form(gear, radius) result(form)
    type(gear_t), intent(in) :: gear
    real(dp), intent(in) :: radius
    type(iso_form_t) :: form
    real(dp) :: p(2), q(2), beta, way, ratio, notch

    beta = fillet_parameter(gear, drive, pi/6)
    p = fillet_point(gear, drive, beta)
    q = fillet_point(gear, coast, fillet_parameter(gear, coast, pi/6))
    form%load_angle = load_angle(gear, radius)
    form%lever = gear%base_radius(drive)/cos(form%load_angle) - p(2)
    form%thickness = p(1) + q(1)
    associate (spec => gear%spec)
      way = corner_depth(spec, drive)/sin(beta)
      form%radius = spec%rack_tip_radius(drive)*spec%module + way**2/(way + gear%reference_radius*sin(beta))
      form%form_factor = 6*form%lever/spec%module*cos(form%load_angle) &
        /((form%thickness/spec%module)**2*cos(spec%pressure_angle(drive)))
    end associate
    ratio = form%thickness/form%lever
    notch = form%thickness/(2*form%radius)
    form%correction = (1.2_dp + 0.13_dp*ratio)*notch**(1/(1.21_dp + 2.3_dp/ratio))
  end function iso_form

  !> Nominal tooth root stress sigma_F0 = F_t/(b m) Y_F Y_S (Pa) under a load on the line of action.
  !> Source: ISO 6336-3:2006, clause 5.
  pure real(dp) function nominal_root_stress(pair, gear, form, load) result(stress)
    type(pair_t), intent(in) :: pair
    integer, intent(in) :: gear                !< 1 pinion, 2 gear
    type(iso_form_t), intent(in) :: form         !< form factors for the radius of the load
    real(dp), intent(in) :: load                 !< load, N

    associate (spec => pair%gear(gear)%spec)
      stress = load*cos(pair%gear(gear)%transverse_angle(drive))/(minval(pair%gear%spec%face_width)*spec%module) &
               *form%form_factor*form%correction*helix_factor(pair)
    end associate
  end function nominal_root_stress

  !> Radius (m) of the load in ISO 6336-3: below the outer end of the path of contact by as many base pitches as the contact ratio
  !> exceeds 1. Up to a contact ratio of 2 it is the outermost radius at which a gear carries the full load, point D on the pinion,
  !> B on the gear.
  !> Source: ISO 6336-3:2006, clause 6, d_en.
  pure real(dp) function outer_single_contact(pair, gear) result(radius)
    type(pair_t), intent(in) :: pair
    integer, intent(in) :: gear

    radius = pair%radius(gear, merge(1.0_dp, pair%contact_ratio - 1, gear == 1))
  end function outer_single_contact

  !> That radius (m) on the virtual gear of a helical gear of a pair, whose contact ratio in the normal section is
  !> epsilon_alpha/cos(beta_b)**2.
  pure real(dp) function virtual_outer_contact(pair, virtual) result(radius)
    type(pair_t), intent(in) :: pair
    type(gear_t), intent(in) :: virtual
    real(dp) :: pitch

    pitch = 2*pi*virtual%base_radius(drive)/teeth_around(virtual%spec)
    radius = hypot(virtual%base_radius(drive), virtual%curvature(drive, virtual%flank_end(drive)) &
                   - pitch*(pair%contact_ratio/cos(pair%gear(1)%base_helix())**2 - 1))
  end function virtual_outer_contact

  !> Helix angle factor Y_beta = 1 - min(epsilon_beta, 1) min(beta, 30 deg)/120 deg.
  !> Source: ISO 6336-3:2006, clause 8.
  pure real(dp) function helix_factor(pair) result(factor)
    type(pair_t), intent(in) :: pair

    factor = 1 - min(pair%overlap_ratio, 1.0_dp)*min(abs(pair%gear(1)%spec%helix_angle), pi/6)/(2*pi/3)
  end function helix_factor

  !> Deep tooth factor Y_DT: below 1 if two pairs share the load at that radius, which requires an accuracy grade of 4 or finer.
  !> Source: ISO 6336-3:2006, clause 10.
  pure real(dp) function deep_tooth_factor(contact_ratio, grade) result(factor)
    real(dp), intent(in) :: contact_ratio
    integer, intent(in) :: grade                 !< accuracy grade of ISO 1328-1
    integer, parameter :: coarsest = 4

    factor = 1
    if (contact_ratio > 2.05_dp .and. grade <= coarsest) factor = max(0.7_dp, min(1.0_dp, 2.366_dp - 0.666_dp*contact_ratio))
  end function deep_tooth_factor
end module gearsweep_rating_form
