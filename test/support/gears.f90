!> Gears of published papers, and pairs of gears as a designer states them with the closed forms of ISO 21771 for them, which see
!> nothing of the library.
module test_support_gears
  use gearsweep_base_error, only: error_t
  use gearsweep_base_kinds, only: dp, pi
  use gearsweep_base_text, only: str
  use gearsweep_elastic_section, only: section_options_t
  use gearsweep_gear_gear, only: gear_spec_t, gear_t, make_gear
  use gearsweep_gear_pair, only: make_pair, pair_t
  implicit none
  private
  public :: stated_t, examples, text_of, involute, base_radius, tip_radius, working_angle, first_curvature, base_pitch
  public :: contact_ratio, half_tooth, dogan_gear, dogan_pair, hassan_gear, hassan_pair, hassan_options

  real(dp), parameter, public :: degree = pi/180
  integer, parameter, public :: drive = 1, coast = 2

  !> A pair as a designer states it: the closed forms below see nothing else. Lengths in mm, angles in degrees.
  type :: stated_t
    real(dp) :: module = 3, angle(2) = 20
    integer :: teeth(2) = 0
    real(dp) :: shift(2) = 0, addendum(2) = 1, dedendum(2) = 1.25_dp, rounding(2) = 0.25_dp
    real(dp) :: distance = 0                     !< of the centres
    real(dp) :: helix = 0                        !< helix angle of the pinion; only the outline as cut has one
  end type stated_t

contains

  !> Spur gears: even and shifted, spread apart, equal and unequal flanks, teeth that are not the standard's.
  function examples() result(list)
    type(stated_t) :: list(5)

    list(1) = stated_t(teeth=[21, 34], distance=82.5_dp)
    list(2) = stated_t(teeth=[19, 42], shift=[0.4_dp, 0.15_dp], distance=93.2_dp)
    list(3) = stated_t(angle=[25, 18], teeth=[24, 31], shift=[0.3_dp, -0.1_dp], rounding=[0.2_dp, 0.15_dp], distance=83.4_dp)
    list(4) = stated_t(angle=[18, 25], teeth=[31, 24], shift=[0.1_dp, 0.3_dp], rounding=[0.2_dp, 0.15_dp], distance=84.0_dp)
    list(5) = stated_t(module=2.5_dp, angle=[22, 22], teeth=[17, 60], shift=[0.25_dp, -0.05_dp], addendum=[0.9_dp, 1.05_dp], &
                       dedendum=[1.2_dp, 1.3_dp], rounding=[0.1_dp, 0.3_dp], distance=97.0_dp)
  end function examples

  !> The case's groups of gears, with what else each group is given.
  function text_of(pair, pinion, gear) result(text)
    type(stated_t), intent(in) :: pair
    character(*), intent(in), optional :: pinion, gear
    character(:), allocatable :: text

    text = '&pair module_mm='//str(pair%module, 17)//' face_width_mm=20 pressure_angle_deg='//str(pair%angle(1), 17)// &
      ' coast_angle_deg='//str(pair%angle(2), 17)//' centre_distance_mm='//str(pair%distance, 17)//' / '
    text = text//'&pinion '//keys_of(1)
    if (present(pinion)) text = text//pinion
    text = text//' / &gear '//keys_of(2)
    if (present(gear)) text = text//gear
    text = text//' / '

  contains

    function keys_of(i) result(words)
      integer, intent(in) :: i
      character(:), allocatable :: words

      words = 'teeth='//str(pair%teeth(i))//' profile_shift='//str(pair%shift(i), 17)//' addendum='// &
        str(pair%addendum(i), 17)//' dedendum='//str(pair%dedendum(i), 17)//' rack_tip_radius='//str(pair%rounding(i), 17)//' '
    end function keys_of
  end function text_of

  pure real(dp) function involute(angle)
    real(dp), intent(in) :: angle

    involute = tan(angle) - angle
  end function involute

  !> ISO 21771:2007: r = m z/2, r_b = r cos(alpha), r_a = r + m (h_aP + x), r_f = r - m (h_fP - x).
  pure function base_radius(pair, side) result(rb)
    type(stated_t), intent(in) :: pair
    integer, intent(in) :: side
    real(dp) :: rb(2)

    rb = pair%module*pair%teeth/2*cos(pair%angle(side)*degree)
  end function base_radius

  pure function tip_radius(pair) result(ra)
    type(stated_t), intent(in) :: pair
    real(dp) :: ra(2)

    ra = pair%module*(pair%teeth/2.0_dp + pair%addendum + pair%shift)
  end function tip_radius

  !> alpha_w, rad: the base circles' common tangent, at the distance of the centres.
  pure real(dp) function working_angle(pair, side)
    type(stated_t), intent(in) :: pair
    integer, intent(in) :: side

    working_angle = acos(sum(base_radius(pair, side))/pair%distance)
  end function working_angle

  !> Radius of curvature of the pinion's flank at A, where the gear's tip circle cuts the line of action.
  pure real(dp) function first_curvature(pair) result(rho)
    type(stated_t), intent(in) :: pair
    real(dp) :: ra(2), rb(2)

    ra = tip_radius(pair)
    rb = base_radius(pair, drive)
    rho = pair%distance*sin(working_angle(pair, drive)) - sqrt(ra(2)**2 - rb(2)**2)
  end function first_curvature

  pure real(dp) function base_pitch(pair)
    type(stated_t), intent(in) :: pair

    base_pitch = pi*pair%module*cos(pair%angle(1)*degree)
  end function base_pitch

  pure real(dp) function contact_ratio(pair)
    type(stated_t), intent(in) :: pair
    real(dp) :: ra(2), rb(2)

    ra = tip_radius(pair)
    rb = base_radius(pair, drive)
    contact_ratio = (sqrt(ra(1)**2 - rb(1)**2) - first_curvature(pair))/base_pitch(pair)
  end function contact_ratio

  !> Half the angle of the tooth on one side, at `radius`: what its share of the reference thickness,
  !> m (pi/4 + x tan(alpha)), and the involute leave.
  pure real(dp) function half_tooth(pair, gear, side, radius) result(angle)
    type(stated_t), intent(in) :: pair
    integer, intent(in) :: gear, side
    real(dp), intent(in) :: radius
    real(dp) :: rb(2)

    rb = base_radius(pair, side)
    associate (alpha => pair%angle(side)*degree)
      angle = pair%module*(pi/4 + pair%shift(gear)*tan(alpha))/(pair%module*pair%teeth(gear)/2) &
              + involute(alpha) - involute(acos(rb(gear)/radius))
    end associate
  end function half_tooth

  !> Gear of Dogan et al. 2021: module 3.18 mm, 25.4 mm wide, of the standard rack unless said. `bore`: radius, m; `angles`:
  !> pressure angles of the drive and the coast flank, degrees.
  type(gear_t) function dogan_gear(teeth, bore, angles) result(gear)
    integer, intent(in) :: teeth
    real(dp), intent(in), optional :: bore, angles(2)
    type(gear_spec_t) :: spec
    type(error_t), allocatable :: error

    spec = gear_spec_t('pinion', teeth, 0.00318_dp, face_width=0.0254_dp)
    if (present(bore)) spec%bore_radius = bore
    if (present(angles)) spec%pressure_angle = angles*pi/180
    ! Between steeper flanks there is no room for the standard's rounding.
    if (present(angles)) spec%rack_tip_radius = 0.1_dp
    call make_gear(spec, gear, error)
    if (allocated(error)) error stop 'test_support_gears: gear of dogan'
  end function dogan_gear

  !> Two gears of Dogan et al. without backlash.
  type(pair_t) function dogan_pair(teeth, bore, angles) result(pair)
    integer, intent(in) :: teeth(2)
    real(dp), intent(in), optional :: bore, angles(2)
    type(gear_t) :: gear(2)
    type(error_t), allocatable :: error

    gear(1) = dogan_gear(teeth(1), bore, angles)
    gear(2) = dogan_gear(teeth(2), bore, angles)
    call make_pair(gear(1), gear(2), sum(gear%reference_radius), pair, error)
    if (allocated(error)) error stop 'test_support_gears: pair of dogan'
  end function dogan_pair

  !> Gear of Hassan et al. 2009: module 25 mm, 125 mm wide; the rack tip radius is inferred. The pinion has 30 teeth, the gear 60.
  type(gear_t) function hassan_gear(teeth) result(gear)
    integer, intent(in) :: teeth
    type(error_t), allocatable :: error

    call make_gear(gear_spec_t('pinion', teeth, 0.025_dp, face_width=0.125_dp, rack_tip_radius=0.30_dp), gear, error)
    if (allocated(error)) error stop 'test_support_gears: gear of hassan'
  end function hassan_gear

  type(pair_t) function hassan_pair() result(pair)
    type(error_t), allocatable :: error

    call make_pair(hassan_gear(30), hassan_gear(60), 1.125_dp, pair, error)
    if (allocated(error)) error stop 'test_support_gears: pair of hassan'
  end function hassan_pair

  !> The paper's section of three teeth.
  type(section_options_t) function hassan_options(across) result(options)
    integer, intent(in) :: across

    options%half_angle = 17.5_dp*pi/180
    options%rim = 0.140625_dp
    options%elements_across = across
  end function hassan_options
end module test_support_gears
