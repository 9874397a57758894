!> Gear and pair geometry against published examples and closed forms.
module test_geometry
  use gearsweep_base_kinds, only: dp, pi
  use gearsweep_base_error, only: error_t
  use gearsweep_base_text, only: str
  use gearsweep_gear_gear, only: coast, drive, gear_spec_t, gear_t, involute, make_gear
  use gearsweep_gear_profile, only: fillet_parameter, fillet_point, involute_point, root_angle
  use gearsweep_gear_pair, only: free_centre_distance, make_pair, pair_t, tip_alteration
  use gearsweep_base_piecewise, only: piecewise_t
  use gearsweep_gear_relief, only: parabolic, profile_error, relief_t
  use test_support_testing, only: tally_t, check_true, check_close, check_error, check_no_error
  implicit none
  private
  public :: run

  real(dp), parameter :: degree = pi/180, mm = 1e-3_dp

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t

    if (t%wants('shifted_pair')) call shifted_pair(t)
    if (t%wants('shifted_pair_at_distance')) call shifted_pair_at_distance(t)
    if (t%wants('maitra_pair')) call maitra_pair(t)
    if (t%wants('shifted_thickness')) call shifted_thickness(t)
    if (t%wants('helical_pairs')) call helical_pairs(t)
    if (t%wants('helical_undercut')) call helical_undercut(t)
    if (t%wants('dogan_cases')) call dogan_cases(t)
    if (t%wants('asymmetric_teeth')) call asymmetric_teeth(t)
    if (t%wants('path_identities')) call path_identities(t)
    if (t%wants('high_contact_ratio')) call high_contact_ratio(t)
    if (t%wants('outline_closes')) call outline_closes(t)
    if (t%wants('fewest_teeth')) call fewest_teeth(t)
    if (t%wants('undercut_pairs')) call undercut_pairs(t)
    if (t%wants('refusals')) call refusals(t)
    if (t%wants('relief_shapes')) call relief_shapes(t)
  end subroutine run

  type(gear_spec_t) function spec_of(name, teeth, module_mm, shift) result(spec)
    character(*), intent(in) :: name
    integer, intent(in) :: teeth
    real(dp), intent(in) :: module_mm, shift

    spec%name = name
    spec%teeth = teeth
    spec%module = module_mm*mm
    spec%profile_shift = shift
    spec%face_width = 20*mm
  end function spec_of

  !> Pinion and gear, one by one: in an array constructor, gfortran never frees what a function gives (seen with GCC 12).
  subroutine make_specs(teeth, module_mm, shift, spec)
    integer, intent(in) :: teeth(2)
    real(dp), intent(in) :: module_mm, shift(2)
    type(gear_spec_t), intent(out) :: spec(2)

    spec(1) = spec_of('pinion', teeth(1), module_mm, shift(1))
    spec(2) = spec_of('gear', teeth(2), module_mm, shift(2))
  end subroutine make_specs

  !> Two gears without backlash, or at `distance`; with tip alteration on request.
  subroutine build(spec, pair, error, distance, altered)
    type(gear_spec_t), intent(inout) :: spec(2)
    type(pair_t), intent(out) :: pair
    type(error_t), allocatable, intent(out) :: error
    real(dp), intent(in), optional :: distance
    logical, intent(in), optional :: altered
    type(gear_t) :: gear(2)
    real(dp) :: a

    call make_gear(spec(1), gear(1), error)
    if (.not. allocated(error)) call make_gear(spec(2), gear(2), error)
    if (allocated(error)) return
    a = free_centre_distance(gear(1), gear(2))
    if (present(distance)) a = distance
    if (present(altered)) then
      spec%tip_alteration = tip_alteration(gear(1), gear(2), a)
      call make_gear(spec(1), gear(1), error)
      call make_gear(spec(2), gear(2), error)
    end if
    call make_pair(gear(1), gear(2), a, pair, error)
  end subroutine build

  !> KHK Gear Technical Reference, profile shifted spur gear: m 3, z 12/24,
  !> x 0.6/0.36, tips shortened; half a unit of the last printed digit.
  subroutine shifted_pair(t)
    type(tally_t), intent(inout) :: t
    type(gear_spec_t) :: spec(2)
    type(pair_t) :: pair
    type(error_t), allocatable :: error

    call make_specs([12, 24], 3.0_dp, [0.6_dp, 0.36_dp], spec)
    call build(spec, pair, error, altered=.true.)
    call check_no_error(t, 'shifted pair', error)
    call check_close(t, 'inv working angle', involute(pair%working_angle(drive)), 0.034316_dp, absolute=5e-7_dp)
    call check_close(t, 'working angle', pair%working_angle(drive)/degree, 26.0886_dp, absolute=5e-5_dp)
    call check_close(t, 'centre distance', pair%centre_distance/mm, 56.4999_dp, absolute=5e-5_dp)
    call check_close(t, 'base diameter 1', 2*pair%gear(1)%base_radius(drive)/mm, 33.8289_dp, absolute=5.1e-5_dp)
    call check_close(t, 'base diameter 2', 2*pair%gear(2)%base_radius(drive)/mm, 67.6579_dp, absolute=5e-5_dp)
    call check_close(t, 'tip diameter 1', 2*pair%gear(1)%tip_radius/mm, 44.840_dp, absolute=5e-4_dp)
    call check_close(t, 'tip diameter 2', 2*pair%gear(2)%tip_radius/mm, 79.400_dp, absolute=5e-4_dp)
    call check_close(t, 'root diameter 1', 2*pair%gear(1)%root_radius/mm, 32.100_dp, absolute=1e-9_dp)
    call check_close(t, 'root diameter 2', 2*pair%gear(2)%root_radius/mm, 66.660_dp, absolute=1e-9_dp)
    call check_close(t, 'contact ratio', pair%contact_ratio, 1.202_dp, absolute=5e-4_dp)
    call check_close(t, 'no backlash', pair%backlash, 0.0_dp, absolute=1e-15_dp)
  end subroutine shifted_pair

  !> Helical gears, in half a unit of the last printed digit:
  !> KHK Gear Technical Reference, profile shifted helical gear of the normal system: m_n 3, beta 30 deg, z 12/60, x 0.09809/0.
  !> ISO/TR 6336-30, example 1, as printed in MATISO_6336.m of github.com/gfsReboucas/Drivetrain: m_n 8, beta 15.8 deg, z 17/103,
  !> x 0.145/0, b 100, a 500, d_a 159.66/872.35, T_1 9000 N m; what ISO 6336 computes from this geometry alone.
  !> Tests of github.com/tkuhn39/semesterthesis: a pair of the FVA-Workbench, m_n 2, beta 20 deg, z 25/40, a 69.172; RIKOR 001,
  !> m_n 8, beta 11 deg, z 14, b 127, K_A T_1 8962.5 N m.
  subroutine helical_pairs(t)
    type(tally_t), intent(inout) :: t
    type(gear_spec_t) :: spec(2)
    type(gear_t) :: gear
    type(pair_t) :: pair
    type(error_t), allocatable :: error
    real(dp) :: z_n(2), force, factors(3), stiffness

    call make_specs([12, 60], 3.0_dp, [0.09809_dp, 0.0_dp], spec)
    spec%helix_angle = [30, -30]*degree
    call build(spec, pair, error, altered=.true.)
    call check_no_error(t, 'helical pair', error)
    call check_close(t, 'transverse pressure angle', pair%gear(1)%transverse_angle(drive)/degree, 22.79588_dp, absolute=5e-6_dp)
    call check_close(t, 'inv working angle', involute(pair%working_angle(drive)), 0.023405_dp, absolute=5e-7_dp)
    call check_close(t, 'working angle', pair%working_angle(drive)/degree, 23.1126_dp, absolute=5e-5_dp)
    call check_close(t, 'centre distance', pair%centre_distance/mm, 125.000_dp, absolute=5e-4_dp)
    call check_close(t, 'reference diameter 1', 2*pair%gear(1)%reference_radius/mm, 41.569_dp, absolute=5e-4_dp)
    call check_close(t, 'reference diameter 2', 2*pair%gear(2)%reference_radius/mm, 207.846_dp, absolute=5e-4_dp)
    call check_close(t, 'base diameter 1', 2*pair%gear(1)%base_radius(drive)/mm, 38.322_dp, absolute=5e-4_dp)
    call check_close(t, 'base diameter 2', 2*pair%gear(2)%base_radius(drive)/mm, 191.611_dp, absolute=5e-4_dp)
    ! Sums of rounded diameters, addenda and tooth heights.
    call check_close(t, 'tip diameter 1', 2*pair%gear(1)%tip_radius/mm, 48.153_dp, absolute=1.5e-3_dp)
    call check_close(t, 'tip diameter 2', 2*pair%gear(2)%tip_radius/mm, 213.842_dp, absolute=1.5e-3_dp)
    call check_close(t, 'root diameter 1', 2*pair%gear(1)%root_radius/mm, 34.657_dp, absolute=2.5e-3_dp)
    call check_close(t, 'root diameter 2', 2*pair%gear(2)%root_radius/mm, 200.346_dp, absolute=2.5e-3_dp)
    call check_close(t, 'no backlash', pair%backlash, 0.0_dp, absolute=1e-15_dp)

    call make_specs([17, 103], 8.0_dp, [0.145_dp, 0.0_dp], spec)
    spec%helix_angle = [15.8_dp, -15.8_dp]*degree
    ! The narrower face decides.
    spec%face_width = [120, 100]*mm
    call build(spec, pair, error, distance=500*mm)
    call check_no_error(t, 'ISO/TR 6336-30, example 1', error)
    call check_close(t, 'tip diameter 1', 2*pair%gear(1)%tip_radius/mm, 159.66_dp, absolute=5e-3_dp)
    call check_close(t, 'tip diameter 2', 2*pair%gear(2)%tip_radius/mm, 872.35_dp, absolute=5e-3_dp)
    associate (radius => pair%centre_distance*spec%teeth/sum(spec%teeth))
      call check_close(t, 'backlash on the working circles', pair%backlash, cos(pair%working_angle(drive)) &
                       *(2*pi*radius(1)/17 - sum(pair%gear%thickness(radius))), absolute=1e-15_dp)
    end associate
    spec%tip_diameter = [159.66_dp, 872.35_dp]*mm
    call build(spec, pair, error, distance=500*mm)
    call check_close(t, 'contact ratio', pair%contact_ratio, 1.5491_dp, absolute=5e-5_dp)
    call check_close(t, 'overlap ratio', pair%overlap_ratio, 1.0834_dp, absolute=5e-5_dp)
    force = 9000/pair%gear(1)%reference_radius
    call check_close(t, 'tangential force', force, 127352.0_dp, absolute=0.5_dp)
    z_n = spec%teeth/(cos(pair%gear%base_helix())**2*cos(spec%helix_angle))
    call check_close(t, 'virtual teeth 1', z_n(1), 18.905_dp, absolute=5e-4_dp)
    call check_close(t, 'virtual teeth 2', z_n(2), 114.543_dp, absolute=5e-4_dp)
    associate (at => pair%gear(1)%transverse_angle(drive), awt => pair%working_angle(drive), e => pair%contact_ratio, &
               d => 2*pair%gear(1)%reference_radius/mm, u => 103/17.0_dp, x => spec(1)%profile_shift)
      factors = [sqrt(2*cos(pair%gear(1)%base_helix())*cos(awt)/(cos(at)**2*sin(awt))), sqrt(1/e), &
                 1/sqrt(cos(spec(1)%helix_angle))]
      call check_close(t, 'Z_H', factors(1), 2.39533_dp, absolute=5e-6_dp)
      call check_close(t, 'Z_eps', factors(2), 0.803_dp, absolute=5e-4_dp)
      call check_close(t, 'Z_beta', factors(3), 1.01944_dp, absolute=5e-6_dp)
      call check_close(t, 'sigma_H0', product(factors)*sqrt(206e3_dp/(2*pi*(1 - 0.3_dp**2))*force/(d*100)*(u + 1)/u), &
                       1206.58207_dp, absolute=5e-6_dp)
      stiffness = 1/(0.04723_dp + 0.15551_dp/z_n(1) + 0.25791_dp/z_n(2) - 0.00635_dp*x - 0.11654_dp*x/z_n(1) + 0.00529_dp*x**2)
      call check_close(t, 'theoretical single stiffness', stiffness, 17.85584_dp, absolute=5e-6_dp)
      stiffness = 0.8_dp*0.9_dp*cos(spec(1)%helix_angle)*stiffness
      call check_close(t, 'single stiffness', stiffness, 12.37047_dp, absolute=5e-6_dp)
      stiffness = (0.75_dp*e + 0.25_dp)*stiffness
      call check_close(t, 'c_gamma alpha', stiffness, 17.46485_dp, absolute=5e-6_dp)
      call check_close(t, 'c_gamma beta', 0.85_dp*stiffness, 14.84512_dp, absolute=5e-6_dp)
    end associate

    call make_specs([25, 40], 2.0_dp, [0.0_dp, 0.0_dp], spec)
    spec%helix_angle = [20, -20]*degree
    call build(spec, pair, error, distance=69.172_dp*mm)
    call check_no_error(t, 'pair of the FVA-Workbench', error)
    call check_close(t, 'its tip diameter', 2*pair%gear(1)%tip_radius/mm, 57.209_dp, absolute=5e-4_dp)
    call check_close(t, 'its contact ratio', pair%contact_ratio, 1.527_dp, absolute=5e-4_dp)
    call check_close(t, 'its virtual teeth', 25/(cos(pair%gear(1)%base_helix())**2*cos(20*degree)), 29.67_dp, absolute=5e-3_dp)

    spec(1) = spec_of('pinion', 14, 8.0_dp, 0.4713_dp)
    spec(1)%helix_angle = -11*degree
    call make_gear(spec(1), gear, error)
    call check_no_error(t, 'RIKOR 001', error)
    force = 8962.5_dp/gear%base_radius(drive)
    call check_close(t, 'F_bt', force, 167555.8_dp, absolute=0.05_dp)
    call check_close(t, 'F_bt/b', force/127, 1319.34_dp, absolute=5e-3_dp)
    call check_close(t, 'F_bn', force/cos(gear%base_helix()), 170316.0_dp, absolute=0.5_dp)
    call check_close(t, 'F_bx', -force*tan(gear%base_helix()), 30538.0_dp, absolute=0.5_dp)
  end subroutine helical_pairs

  !> Least profile shift without undercut of a helical gear: the end of the rack's straight flank at the end of the line of action,
  !> x = h_fP - rho_fP (1 - sin(alpha_n)) - z sin(alpha_t)^2/(2 cos(beta)).
  subroutine helical_undercut(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: beta = 25*degree, tiny = 1e-9_dp
    type(gear_spec_t) :: spec(2)
    type(gear_t) :: gear
    type(pair_t) :: pair
    type(error_t), allocatable :: error
    real(dp) :: least

    least = 1.25_dp - 0.25_dp*(1 - sin(20*degree)) - 6*sin(atan(tan(20*degree)/cos(beta)))**2/cos(beta)
    call make_specs([12, 40], 2.0_dp, [least + tiny, 0.0_dp], spec)
    spec%helix_angle = [beta, -beta]
    call make_gear(spec(1), gear, error)
    call check_true(t, 'no undercut of a helical gear', .not. gear%is_undercut(drive))
    call check_close(t, 'involute from the base circle', gear%form_radius(drive), gear%base_radius(drive), 1e-12_dp)
    spec%profile_shift = [least - tiny, 0.0_dp]
    call make_gear(spec(1), gear, error)
    call check_true(t, 'undercut of a helical gear', gear%is_undercut(drive))
    spec%profile_shift = [-0.6_dp, 0.0_dp]
    call build(spec, pair, error)
    call check_error(t, 'undercut that takes working flank', error, 'to have none it must be at least '//str(least)//', or')
    spec%helix_angle = [beta, beta]
    spec%profile_shift = 0.3_dp
    call build(spec, pair, error)
    call check_error(t, 'two right-handed gears', error, 'helix angle: one gear must be right-handed and the other left-handed')
    spec(1)%helix_angle = 0.9_dp
    call make_gear(spec(1), gear, error)
    call check_error(t, 'a steep helix', error, 'pinion helix angle (rad) = 0.9: must lie between -0.8 and 0.8')
  end subroutine helical_undercut

  !> The same gears at a given 56.5 mm, as tabulated in "Profile Shifted
  !> External Spur Gears" (bolsover.com), sum of shifts rounded to 0.960 there.
  subroutine shifted_pair_at_distance(t)
    type(tally_t), intent(inout) :: t
    type(gear_spec_t) :: spec(2)
    type(pair_t) :: pair
    type(error_t), allocatable :: error

    call make_specs([12, 24], 3.0_dp, [0.6_dp, 0.36_dp], spec)
    call build(spec, pair, error, distance=56.5_dp*mm, altered=.true.)
    call check_no_error(t, 'given distance', error)
    call check_close(t, 'angle at a', pair%working_angle(drive)/degree, 26.0888_dp, absolute=5e-5_dp)
    call check_close(t, 'inv angle at a', involute(pair%working_angle(drive)), 0.034317_dp, absolute=5e-7_dp)
    call check_close(t, 'tip diameter at a', 2*pair%gear(1)%tip_radius/mm, 44.840_dp, absolute=5e-4_dp)
    call check_close(t, 'contact ratio at a', pair%contact_ratio, 1.202_dp, absolute=5e-4_dp)
    call check_true(t, 'a hair of backlash', pair%backlash > 0 .and. pair%backlash < 0.2e-6_dp)
  end subroutine shifted_pair_at_distance

  !> T. Eritenel, notebook "Spur Gear Design" (drivetrainhub, 2019), after
  !> Maitra's Handbook of Gear Design: m 3, z 17/53, a 110, 0.1 mm backlash on
  !> the working circle, printed in full; its shifts with our tips.
  subroutine maitra_pair(t)
    type(tally_t), intent(inout) :: t
    type(gear_spec_t) :: spec(2)
    type(pair_t) :: pair
    type(error_t), allocatable :: error

    call make_specs([17, 53], 3.0_dp, [0.7143818731061048_dp, 1.1683670161543263_dp], spec)
    spec%tip_alteration = -0.4660822225937642_dp
    call build(spec, pair, error, distance=110*mm)
    ! Its topping takes the clearance twice, which leaves a contact ratio of 0.8868.
    call check_error(t, 'contact ratio below 1', error, '0.886807')
    call check_close(t, 'angle after Maitra', pair%working_angle(drive)/degree, 26.23619006066304_dp, 1e-13_dp)
    call check_close(t, 'tip thickness 1', pair%gear(1)%thickness(pair%gear(1)%tip_radius)/(3*mm), &
                     0.9500923153558003_dp, 1e-12_dp)
    call check_close(t, 'tip thickness 2', pair%gear(2)%thickness(pair%gear(2)%tip_radius)/(3*mm), &
                     0.9920027069886594_dp, 1e-12_dp)
    call check_close(t, 'backlash on the line of action', pair%backlash, &
                     0.1_dp*mm*cos(pair%working_angle(drive)), 1e-9_dp)
  end subroutine maitra_pair

  !> SDP/SI, Elements of Metric Gear Technology, Table 10-1: m 10, z 12, x 0.3.
  subroutine shifted_thickness(t)
    type(tally_t), intent(inout) :: t
    type(gear_t) :: gear
    type(error_t), allocatable :: error
    type(gear_spec_t) :: spec

    spec = spec_of('pinion', 12, 10.0_dp, 0.3_dp)
    spec%rack_tip_radius = 0.38_dp
    call make_gear(spec, gear, error)
    call check_close(t, 'reference thickness', gear%thickness(gear%reference_radius)/mm, 17.8918_dp, absolute=5e-5_dp)
  end subroutine shifted_thickness

  !> Dogan et al. 2021, Eqs. 5, 6 written out here, and Table 1.
  subroutine dogan_cases(t)
    type(tally_t), intent(inout) :: t
    type(gear_spec_t) :: spec(2)
    type(pair_t) :: pair
    type(error_t), allocatable :: error
    real(dp) :: s(5), rb(2), ra(2), pitch

    call make_specs([25, 116], 7.0_dp, [0.0_dp, 0.0_dp], spec)
    call build(spec, pair, error)
    call check_no_error(t, 'case 2', error)
    s = pair%points()
    rb = [175, 812]/2.0_dp*cos(20*degree)
    ra = [189, 826]/2.0_dp
    pitch = pi*7*cos(20*degree)
    call check_close(t, 'LPSTC', pair%radius(1, s(2))/mm, hypot(rb(1), sqrt(ra(1)**2 - rb(1)**2) - pitch), 1e-13_dp)
    call check_close(t, 'HPSTC', pair%radius(1, s(4))/mm, &
                     hypot(rb(1), sum(rb)*tan(20*degree) - sqrt(ra(2)**2 - rb(2)**2) + pitch), 1e-13_dp)
    call check_close(t, 'pitch point', pair%radius(1, s(3))/mm, 87.5_dp, 1e-13_dp)
    call check_close(t, 'contact ratio 2', pair%contact_ratio, 1.7398531_dp, absolute=5e-8_dp)
    call check_close(t, 'sliding at the pitch point', pair%sliding_speed(s(3), 100.0_dp), 0.0_dp, absolute=1e-12_dp)
    ! At E the speeds of the two flanks along the tangent differ by w1 rho1 - w2 rho2.
    call check_close(t, 'sliding at E', pair%sliding_speed(s(5), 100.0_dp), 100*pair%curvature(1, s(5)) &
                     - 100*25/116.0_dp*pair%curvature(2, s(5)), 1e-12_dp)
  end subroutine dogan_cases

  !> Contact ratios by the prototypes' independent calculation; the coast side
  !> does not touch them.
  subroutine asymmetric_teeth(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: expected(3) = [1.611651_dp, 1.335049_dp, 1.611651_dp]
    real(dp), parameter :: angle(2, 3) = reshape([20, 20, 30, 20, 20, 30], [2, 3])*degree
    type(gear_spec_t) :: spec(2)
    type(pair_t) :: pair
    type(error_t), allocatable :: error
    integer :: i

    do i = 1, 3
      call make_specs([25, 25], 3.18_dp, [0.0_dp, 0.0_dp], spec)
      spec(1)%pressure_angle = angle(:, i)
      spec(2)%pressure_angle = angle(:, i)
      call build(spec, pair, error)
      call check_no_error(t, 'asymmetric', error)
      call check_close(t, 'asymmetric contact ratio', pair%contact_ratio, expected(i), absolute=5e-7_dp)
    end do
    ! Half thickness of each flank on the reference circle grows with its own angle.
    spec%profile_shift = 0.5_dp
    call build(spec, pair, error)
    associate (gear => pair%gear(1))
      call check_close(t, 'drive half', gear%half_angle(drive, gear%reference_radius), &
                       (pi/2 + tan(20*degree))/25, 1e-13_dp)
      call check_close(t, 'coast half', gear%half_angle(coast, gear%reference_radius), &
                       (pi/2 + tan(30*degree))/25, 1e-13_dp)
    end associate
    call check_close(t, 'free of backlash on both sides', pair%backlash, 0.0_dp, absolute=1e-15_dp)
  end subroutine asymmetric_teeth

  !> rho1 + rho2 = a sin alpha_w; swapping the gears mirrors the path.
  subroutine path_identities(t)
    type(tally_t), intent(inout) :: t
    type(gear_spec_t) :: spec(2), swapped(2)
    type(pair_t) :: pair, mirror
    type(error_t), allocatable :: error
    real(dp) :: s

    call make_specs([23, 57], 4.0_dp, [0.3_dp, -0.1_dp], spec)
    swapped = spec([2, 1])
    call build(spec, pair, error)
    call build(swapped, mirror, error)
    s = 0.37_dp
    call check_close(t, 'curvatures', pair%curvature(1, s) + pair%curvature(2, s), &
                     pair%centre_distance*sin(pair%working_angle(drive)), 1e-13_dp)
    call check_close(t, 'mirrored ratio', mirror%contact_ratio, pair%contact_ratio, 1e-13_dp)
    call check_close(t, 'mirrored radius', mirror%radius(2, pair%contact_ratio - s), pair%radius(1, s), 1e-13_dp)
    call check_close(t, 'E on the tip circle', pair%radius(1, pair%contact_ratio), pair%gear(1)%tip_radius, 1e-14_dp)
    call check_close(t, 'A on the tip circle', pair%radius(2, 0.0_dp), pair%gear(2)%tip_radius, 1e-14_dp)
  end subroutine path_identities

  subroutine high_contact_ratio(t)
    type(tally_t), intent(inout) :: t
    type(gear_spec_t) :: spec(2)
    type(pair_t) :: pair
    type(error_t), allocatable :: error
    real(dp) :: s(5)

    call make_specs([40, 60], 3.0_dp, [0.0_dp, 0.0_dp], spec)
    spec%addendum = 1.3_dp
    spec%dedendum = 1.6_dp
    spec(1)%rack_tip_radius = 0.1_dp
    spec(2)%rack_tip_radius = 0.1_dp
    call build(spec, pair, error)
    call check_no_error(t, 'high contact ratio', error)
    call check_true(t, 'above 2', pair%contact_ratio > 2)
    s = pair%points()
    ! From B to A and from D to E one pair more touches.
    call check_close(t, 'B', s(2), pair%contact_ratio - 2, 1e-13_dp)
    call check_close(t, 'D', s(4), 2.0_dp, 1e-13_dp)
  end subroutine high_contact_ratio

  !> The fillet meets the involute in position and slope and the root circle
  !> tangentially, for both flanks of an asymmetric tooth. Each side is that of a gear whose rack has this side's rounding on both.
  subroutine outline_closes(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: tiny = 1e-7_dp
    type(gear_spec_t) :: spec
    type(gear_t) :: gear, alike
    type(error_t), allocatable :: error
    real(dp) :: fillet(2), flank(2), root(2), beta
    integer :: side

    spec = spec_of('pinion', 22, 5.0_dp, 0.2_dp)
    spec%pressure_angle = [25, 18]*degree
    spec%rack_tip_radius = [0.2_dp, 0.1_dp]
    call make_gear(spec, gear, error)
    call check_no_error(t, 'outline', error)
    do side = drive, coast
      associate (angle => gear%spec%pressure_angle(side), form => gear%form_radius(side))
        fillet = fillet_point(gear, side, angle)
        flank = involute_point(gear, side, form)
        call check_close(t, 'join', norm2(fillet - flank), 0.0_dp, absolute=1e-15_dp)
        fillet = fillet_point(gear, side, angle + tiny) - fillet
        flank = flank - involute_point(gear, side, form*(1 + tiny))
        call check_close(t, 'tangents', (fillet(1)*flank(2) - fillet(2)*flank(1))/norm2(fillet)/norm2(flank), 0.0_dp, &
                         absolute=1e-5_dp)
        root = fillet_point(gear, side, pi/2)
        call check_close(t, 'root circle', norm2(root), gear%root_radius, 1e-14_dp)
        call check_close(t, 'root angle', atan2(root(1), root(2)), root_angle(gear, side), 1e-13_dp)
        beta = fillet_parameter(gear, side, 40*degree)
        fillet = fillet_point(gear, side, beta + tiny) - fillet_point(gear, side, beta - tiny)
        call check_close(t, 'tangent of 40 degrees', atan2(fillet(1), -fillet(2))/degree, 40.0_dp, absolute=1e-4_dp)
        spec = gear%spec
        spec%rack_tip_radius = gear%spec%rack_tip_radius(side)
        call make_gear(spec, alike, error)
        call check_no_error(t, 'one rounding', error)
        call check_close(t, 'a side of its own', norm2(fillet_point(alike, side, beta) - fillet_point(gear, side, beta)), 0.0_dp, &
                         absolute=1e-15_dp)
      end associate
    end do
  end subroutine outline_closes

  !> Textbooks: with depth h = 1 below the pitch line undercut begins at z = 2/sin^2(20) = 17.1.
  subroutine fewest_teeth(t)
    type(tally_t), intent(inout) :: t
    type(gear_spec_t) :: spec
    type(gear_t) :: gear
    type(error_t), allocatable :: error
    real(dp) :: radius

    radius = 0.25_dp/(1 - sin(20*degree))
    spec = spec_of('pinion', 18, 3.0_dp, 0.0_dp)
    spec%rack_tip_radius = radius
    call make_gear(spec, gear, error)
    call check_no_error(t, '18 teeth', error)
    spec%teeth = 17
    call make_gear(spec, gear, error)
    call check_no_error(t, '17 teeth', error)
    call check_true(t, '17 teeth are undercut, 18 not', gear%is_undercut(drive))
    spec%profile_shift = 1 - 17*sin(20*degree)**2/2 + 1e-9_dp
    call make_gear(spec, gear, error)
    call check_no_error(t, '17 teeth, least shift', error)
    call check_true(t, 'with the least shift they are not', .not. any(gear%is_undercut([drive, coast])))
    call check_close(t, 'involute from the base circle', gear%form_radius(drive), gear%base_radius(drive), 1e-9_dp)
  end subroutine fewest_teeth

  !> Gears that undercut does no harm, and gears that lose working flank. Where their involutes begin and how deep contact
  !> goes (mm) is from a program that cuts the gears with a rack as a solid; one unit of its last digit.
  !> FZG type A has its tips shortened for its centre distance.
  subroutine undercut_pairs(t)
    type(tally_t), intent(inout) :: t
    type(gear_spec_t) :: spec(2)
    type(gear_t) :: gears(2)
    type(pair_t) :: pair
    type(error_t), allocatable :: error

    call make_specs([17, 43], 2.0_dp, [0.0_dp, 0.0_dp], spec)
    spec(1)%rack_tip_radius = 0.38_dp
    spec(2)%rack_tip_radius = 0.38_dp
    call begins('17/43', 1, 15.9748_dp, 15.9908_dp)
    spec(1)%teeth = 16
    call begins('16/43', 1, 15.0362_dp, 15.0397_dp)
    call make_specs([18, 18], 4.0_dp, [0.0_dp, 0.0_dp], spec)
    call begins('18/18', 2, 33.8294_dp, 33.9876_dp)
    call make_specs([12, 40], 4.0_dp, [0.3_dp, -0.1_dp], spec)
    call begins('12/40', 1, 22.5575_dp, 22.5852_dp)
    call make_specs([16, 24], 4.5_dp, [0.8532_dp, -0.5_dp], spec)
    spec(1)%rack_tip_radius = 0.38_dp
    spec(2)%rack_tip_radius = 0.38_dp
    call begins('FZG A', 2, 101.494_dp/2, 102.291_dp/2, 91.5_dp)
    call make_specs([12, 43], 2.0_dp, [0.0_dp, 0.0_dp], spec)
    spec(1)%rack_tip_radius = 0.38_dp
    spec(2)%rack_tip_radius = 0.38_dp
    call build(spec, pair, error)
    call check_error(t, '12/43', error, 'undercut with 12 teeth takes working flank')
    spec(1)%teeth = 14
    call build(spec, pair, error)
    call check_error(t, '14/43', error, 'undercut with 14 teeth takes working flank')
    gears = pair%gear
    call make_pair(gears(1), gears(2), 57*mm, pair, error, shorten=.true.)
    call check_no_error(t, '14/43, shortened', error)
    call check_close(t, 'the path begins at the involute', pair%radius(1, 0.0_dp), gears(1)%form_radius(drive), 1e-14_dp)
    call check_close(t, 'and ends at the tip', pair%radius(1, pair%contact_ratio), gears(1)%tip_radius, 1e-14_dp)
    call check_close(t, 'what is lost', pair%lost(1), pair%curvature(1, 0.0_dp) - (57*mm*sin(20*degree) &
                     - sqrt(gears(2)%tip_radius**2 - gears(2)%base_radius(drive)**2)), 1e-12_dp)
    call check_true(t, 'the gear loses nothing', .not. abs(pair%lost(2)) > 0)
    ! Mirrored, the path loses its other end.
    call make_pair(gears(2), gears(1), 57*mm, pair, error, shorten=.true.)
    call check_close(t, 'mirrored', pair%radius(2, pair%contact_ratio), pair%gear(2)%form_radius(drive), 1e-14_dp)
    call check_true(t, 'the pinion loses nothing', .not. abs(pair%lost(1)) > 0 .and. pair%lost(2) > 0)
    call make_specs([6, 60], 2.0_dp, [-0.8_dp, 0.0_dp], spec)
    call build(spec, pair, error)
    call check_error(t, 'cut through', error, 'undercut with 6 teeth leaves no tooth')

  contains

    !> Radii (mm) at which the involute of one gear begins and at which the other's tip touches it.
    subroutine begins(name, gear, form, contact, distance)
      character(*), intent(in) :: name
      integer, intent(in) :: gear
      real(dp), intent(in) :: form, contact
      real(dp), intent(in), optional :: distance
      real(dp) :: digit

      digit = 1e-4_dp
      if (present(distance)) then
        digit = 5e-4_dp
        call build(spec, pair, error, distance=distance*mm, altered=.true.)
      else
        call build(spec, pair, error)
      end if
      call check_no_error(t, name, error)
      call check_true(t, name//': undercut', pair%gear(gear)%is_undercut(drive))
      call check_close(t, name//': form radius', pair%gear(gear)%form_radius(drive)/mm, form, absolute=digit)
      call check_close(t, name//': contact from', pair%radius(gear, merge(0.0_dp, pair%contact_ratio, gear == 1))/mm, &
                       contact, absolute=digit)
    end subroutine begins
  end subroutine undercut_pairs

  subroutine refusals(t)
    type(tally_t), intent(inout) :: t
    type(gear_spec_t) :: spec(2), good(2)
    type(pair_t) :: pair
    type(error_t), allocatable :: error

    call make_specs([25, 40], 3.0_dp, [0.0_dp, 0.0_dp], good)
    spec = good
    call build(spec, pair, error, distance=97.4_dp*mm)
    call check_error(t, 'jammed', error, 'must be at least 97.5')
    call build(spec, pair, error, distance=103*mm)
    call check_error(t, 'too far apart', error, 'contact ratio')
    spec(1)%profile_shift = 2
    spec(1)%teeth = 12
    call build(spec, pair, error)
    call check_error(t, 'pointed', error, 'pointed')
    spec = good
    spec(1)%pressure_angle = 30*degree
    call build(spec, pair, error)
    call check_error(t, 'rack tip radius', error, 'does not fit the rack')
    spec = good
    spec(2)%teeth = 200
    spec(2)%addendum = 1.4_dp
    call build(spec, pair, error)
    call check_error(t, 'tip in the root', error, 'interference')
    spec = good
    spec(1)%bore_radius = 40*mm
    call build(spec, pair, error)
    call check_error(t, 'bore', error, 'bore diameter (mm)')
    spec = good
    spec(2)%module = 4*mm
    call build(spec, pair, error)
    call check_error(t, 'two modules', error, 'same module')
  end subroutine refusals

  subroutine relief_shapes(t)
    type(tally_t), intent(inout) :: t
    type(relief_t) :: relief
    type(piecewise_t) :: e
    type(error_t), allocatable :: error

    relief%amount = [10e-6_dp, 4e-6_dp]
    relief%start = [1.0_dp, 0.6_dp]
    call profile_error(relief, 1.6_dp, e, error)
    call check_no_error(t, 'relief', error)
    call check_close(t, 'at E', e%value(1.6_dp), 10e-6_dp)
    call check_close(t, 'at A', e%value(0.0_dp), 4e-6_dp)
    call check_close(t, 'half way', e%value(1.3_dp), 5e-6_dp)
    call check_close(t, 'between B and D', e%value(0.8_dp), 0.0_dp)
    relief%shape = parabolic
    call profile_error(relief, 1.6_dp, e, error)
    call check_close(t, 'parabola half way', e%value(1.3_dp), 2.5e-6_dp)
    call check_close(t, 'parabola leaves level', e%slope(1.0_dp), 0.0_dp, absolute=1e-18_dp)
    ! Long reliefs of both gears overlap and add up.
    relief%start = [0.5_dp, 1.1_dp]
    call profile_error(relief, 1.6_dp, e, error)
    call check_close(t, 'overlap', e%value(0.8_dp), 10e-6_dp*(0.3_dp/1.1_dp)**2 + 4e-6_dp*(0.3_dp/1.1_dp)**2)
    relief%start = [1.7_dp, 0.6_dp]
    call profile_error(relief, 1.6_dp, e, error)
    call check_error(t, 'relief off the path', error, 'the pinion''s relief begins at 1.7 base pitches, off the path')
    relief%start = [1.6_dp, 0.6_dp]
    call profile_error(relief, 1.6_dp, e, error)
    call check_error(t, 'no room at E', error, 'the pinion''s relief begins at 1.6')
    relief%start = [0.0_dp, 1.6_dp]
    call profile_error(relief, 1.6_dp, e, error)
    call check_no_error(t, 'from end to end', error)
    relief%start = [1.0_dp, 0.0_dp]
    call profile_error(relief, 1.6_dp, e, error)
    call check_error(t, 'no room at A', error, 'the gear''s relief begins at 0')
    relief%start = [1.0_dp, 1.61_dp]
    call profile_error(relief, 1.6_dp, e, error)
    call check_error(t, 'the gear''s off the path', error, 'the gear''s relief begins at 1.61')
    relief%amount(2) = -1e-9_dp
    call profile_error(relief, 1.6_dp, e, error)
    call check_error(t, 'negative relief', error, 'amount of relief: must be at least 0')
  end subroutine relief_shapes
end module test_geometry
