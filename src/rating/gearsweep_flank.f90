!> What happens where the flanks of a pair of teeth touch: how fast they roll and slide, Hertz pressure and the shear stress
!> below the surface, flash temperature and lubricant film.
module gearsweep_flank
  use gearsweep_corner, only: corner_contact, corner_t
  use gearsweep_flattening, only: contact_half_width
  use gearsweep_gear, only: drive
  use gearsweep_kinds, only: dp, pi
  use gearsweep_material, only: harmonic_mean, material_t
  use gearsweep_pair, only: pair_t
  use gearsweep_table, only: no_number
  implicit none
  private
  public :: surfaces_t, contact_t, flank_contact, rolling_arm, sliding_ratio, flash_factor

  !> Both flanks and the oil between them.
  type :: surfaces_t
    type(material_t) :: material(2)              !< of pinion and gear
    real(dp) :: conductivity(2) = 49             !< of heat, W/(m K)
    real(dp) :: specific_heat(2) = 484           !< J/(kg K)
    real(dp) :: viscosity = 0.03_dp              !< dynamic, of the oil where it enters the contact, Pa s
    real(dp) :: pressure_viscosity = 20e-9_dp    !< how fast its logarithm grows with the pressure, 1/Pa
  end type surfaces_t

  !> One contact. Beyond A and E a sharp corner touches, which has no radius of curvature: there pressure and all that
  !> follows from it is NaN, and a film is where there is a load.
  type :: contact_t
    real(dp) :: rolling(2) = 0                   !< speed of either flank past the contact, m/s
    real(dp) :: sliding = 0                      !< that of the pinion's less that of the gear's, m/s
    real(dp) :: specific_sliding(2) = 0          !< of either flank: sliding over its own rolling speed
    real(dp) :: pressure = 0                     !< largest, Pa
    real(dp) :: half_width = 0                   !< of the band of contact, m
    real(dp) :: shear_stress = 0                 !< largest below the surface, Pa
    real(dp) :: shear_depth = 0                  !< where, below the surface, m
    real(dp) :: flash = 0                        !< by how much the flanks become hotter within the contact, K
    real(dp) :: film = 0                         !< least thickness of the film, m
    real(dp) :: friction_power = 0               !< W
  end type contact_t

  !> Largest temperature, over q/(B sqrt(2 a v)), of a half plane that moves at the speed v through a band of heat of the
  !> half width a, distributed as Hertz's pressure, with q the power per length and B the thermal contact coefficient:
  !> Blok has 1.11.
  real(dp), parameter :: flash_factor = 1.11155_dp

contains

  !> The contact of the pair at path coordinate `s` under `load` (N).
  !> Sources: ISO 21771:2007, section 5 (sliding); Johnson 1985, Contact Mechanics, section 4.2 (pressure; largest shear
  !> stress in the plane of rotation); Blok 1937, Institution of Mechanical Engineers, General Discussion on Lubrication 2, 222,
  !> as in ISO/TR 13989-1 (flash temperature); Dowson 1968, Proc. Institution of Mechanical Engineers 182(3A), 151 (film).
  elemental type(contact_t) function flank_contact(pair, surfaces, friction, speed, s, load) result(contact)
    type(pair_t), intent(in) :: pair
    type(surfaces_t), intent(in) :: surfaces
    real(dp), intent(in) :: friction             !< coefficient
    real(dp), intent(in) :: speed                !< of the pinion, rad/s
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
      call leave_open(contact)
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

  !> What a corner has no number for.
  elemental subroutine leave_open(contact)
    type(contact_t), intent(inout) :: contact

    contact%pressure = no_number()
    contact%half_width = no_number()
    contact%shear_stress = no_number()
    contact%shear_depth = no_number()
    contact%flash = no_number()
    contact%film = no_number()
  end subroutine leave_open

  !> Least thickness (m) of the film between two cylinders with the reduced radius of curvature `radius` (m) under `line_load`
  !> (N/m), whose surfaces enter at the mean speed `entrainment` (m/s): H = 2.65 U**0.7 G**0.54 W**-0.13 (Dowson 1968).
  elemental real(dp) function film_thickness(surfaces, line_load, entrainment, radius) result(film)
    type(surfaces_t), intent(in) :: surfaces
    real(dp), intent(in) :: line_load, entrainment, radius
    real(dp) :: modulus, speed_number, material_number, load_number

    modulus = harmonic_mean(plane(surfaces%material(1)), plane(surfaces%material(2)))
    speed_number = surfaces%viscosity*entrainment/(modulus*radius)
    material_number = surfaces%pressure_viscosity*modulus
    load_number = line_load/(modulus*radius)
    film = 2.65_dp*radius*speed_number**0.7_dp*material_number**0.54_dp/load_number**0.13_dp
  end function film_thickness

  !> E/(1 - nu**2), Pa.
  elemental real(dp) function plane(material)
    type(material_t), intent(in) :: material

    plane = material%young/(1 - material%poisson**2)
  end function plane

  !> Distance (m) along the common normal of the flanks from the contact at `s` to the foot of the perpendicular from a
  !> gear's centre: times its speed of rotation, it is the speed at which its flank rolls through the contact. On the path of
  !> contact it is the radius of curvature.
  elemental real(dp) function rolling_arm(pair, member, s) result(arm)
    type(pair_t), intent(in) :: pair
    integer, intent(in) :: member
    real(dp), intent(in) :: s
    type(corner_t) :: corner
    integer :: tooth

    arm = pair%curvature(member, s)
    if (s >= 0 .and. s <= pair%contact_ratio) return
    corner = corner_contact(pair, s)
    arm = corner%curvature
    tooth = merge(2, 1, s < 0)                   ! whose corner it is
    if (member == tooth) arm = sqrt(pair%radius(tooth, merge(0.0_dp, pair%contact_ratio, s < 0))**2 &
                                    - (corner%lever*pair%gear(tooth)%base_radius(drive))**2)
  end function rolling_arm

  !> Sliding speed over the speed of the base circles, with the sign of `sliding`.
  elemental real(dp) function sliding_ratio(pair, s) result(ratio)
    type(pair_t), intent(in) :: pair
    real(dp), intent(in) :: s

    ratio = rolling_arm(pair, 1, s)/pair%gear(1)%base_radius(drive) - rolling_arm(pair, 2, s)/pair%gear(2)%base_radius(drive)
  end function sliding_ratio
end module gearsweep_flank
