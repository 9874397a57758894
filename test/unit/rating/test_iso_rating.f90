!> Rating by ISO 6336: factors of the contact stress and the dynamic factor by Method B, against printed examples of other
!> programs, Hertz's formula and what follows from the form of the equations.
module test_iso_rating
  use gearsweep_study_case_case, only: case_t
  use gearsweep_api_case_reader, only: read_case
  use gearsweep_rating_dynamic_factor, only: deviations_of, dynamic_factor_b, is_in_range, method_b_t, resonance_ratio
  use gearsweep_base_error, only: error_t
  use gearsweep_rating_flank, only: flank_factors, flank_factors_t, nominal_flank_stress, rim_factor, root_face_load_factor
  use gearsweep_gear_gear, only: drive, gear_spec_t, gear_t, make_gear, make_virtual_gear
  use gearsweep_rating_form, only: helix_factor
  use gearsweep_rating_nominal_stress, only: nominal_of, nominal_t
  use gearsweep_rating_gear_materials, only: common_names, contact_number, gear_materials, root_number
  use gearsweep_base_kinds, only: dp, pi
  use gearsweep_elastic_material, only: material_t
  use gearsweep_gear_pair, only: free_centre_distance, make_pair, pair_t
  use gearsweep_base_piecewise, only: piecewise_t
  use gearsweep_mesh_stiffness, only: iso_stiffness
  use gearsweep_study_run_study, only: run_study, study_t
  use gearsweep_base_table, only: table_t
  use gearsweep_api_tables, only: make_table
  use test_support_testing, only: check_close, check_equal, check_error, check_no_error, check_true, tally_t
  implicit none
  private
  public :: run, make, solve

  real(dp), parameter :: steel(2) = 206e9_dp, poisson(2) = 0.3_dp

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t

    if (t%wants('din_3990_example')) call din_3990_example(t)
    if (t%wants('fzg_reports')) call fzg_reports(t)
    if (t%wants('hertz')) call hertz(t)
    if (t%wants('method_b_ranges')) call method_b_ranges(t)
    if (t%wants('method_b_coefficients')) call method_b_coefficients(t)
    if (t%wants('method_b_reports')) call method_b_reports(t)
    if (t%wants('accuracy_grades')) call accuracy_grades(t)
    if (t%wants('load_factors')) call load_factors(t)
    if (t%wants('helical_example')) call helical_example(t)
    if (t%wants('helical_form')) call helical_form(t)
    if (t%wants('helical_limits')) call helical_limits(t)
    if (t%wants('helical_task')) call helical_task(t)
    if (t%wants('task')) call task(t)
    if (t%wants('materials')) call materials(t)
  end subroutine run

  subroutine make(t, module, teeth, shifts, width, distance, pair, tips)
    type(tally_t), intent(inout) :: t
    real(dp), intent(in) :: module, shifts(2), width, distance    ! m; distance 0: without backlash
    integer, intent(in) :: teeth(2)
    type(pair_t), intent(out) :: pair
    real(dp), intent(in), optional :: tips(2)                     ! tip diameters, m
    type(gear_spec_t) :: spec
    type(gear_t) :: gear(2)
    type(error_t), allocatable :: error
    real(dp) :: apart
    integer :: i

    do i = 1, 2
      spec = gear_spec_t('gear', teeth(i), module, profile_shift=shifts(i), face_width=width)
      if (present(tips)) spec%tip_diameter = tips(i)
      call make_gear(spec, gear(i), error)
      call check_no_error(t, 'a gear', error)
    end do
    apart = distance
    if (.not. apart > 0) apart = free_centre_distance(gear(1), gear(2))
    call make_pair(gear(1), gear(2), apart, pair, error)
    call check_no_error(t, 'a pair', error)
  end subroutine make

  !> 19/104 teeth, module 4, in the tests of the package din3990 (hanslhansl), by DIN 3990-11, whose factors are those of
  !> ISO 6336-2; its Z_E is rounded to 189.8.
  subroutine din_3990_example(t)
    type(tally_t), intent(inout) :: t
    type(pair_t) :: pair
    type(flank_factors_t) :: factors

    call make(t, 0.004_dp, [19, 104], [0.5_dp, 0.15_dp], 0.04864_dp, 0.0_dp, pair)
    factors = flank_factors(pair, steel, poisson)
    call check_close(t, 'DIN 3990: Z_H', factors%zone, 2.3959406670899934_dp, 1e-9_dp)
    call check_close(t, 'DIN 3990: Z_eps', factors%contact_ratio, 0.906214912960638_dp, 1e-9_dp)
    call check_close(t, 'DIN 3990: Z_B', factors%single_pair(1), 1.00554704549864_dp, 1e-9_dp)
    call check_close(t, 'DIN 3990: Z_D', factors%single_pair(2), 1.0_dp, 1e-15_dp)
    call check_close(t, 'DIN 3990: sigma_H0', nominal_flank_stress(pair, factors, 14103.41869503906_dp)/factors%elasticity, &
                     875.3827378988153_dp*1e6_dp/189.8e3_dp, 1e-9_dp)
    call check_true(t, 'DIN 3990: range of Method C is that of Method B', &
                    .not. is_in_range(3.89976368065613_dp, 19, 104/19.0_dp) .and. &
                    is_in_range(3.89976368065613_dp*3/0.7288910289850654_dp*1.0001_dp, 19, 104/19.0_dp) .and. &
                    .not. is_in_range(3.89976368065613_dp*3/0.7288910289850654_dp*0.9999_dp, 19, 104/19.0_dp))
  end subroutine din_3990_example

  !> The pair of ISO/TR 6336-30, example 1, with a dedendum for which C_B is 0.9.
  subroutine make_example(t, pair, virtual)
    type(tally_t), intent(inout) :: t
    type(pair_t), intent(out) :: pair
    type(gear_t), intent(out) :: virtual(2)
    integer, parameter :: teeth(2) = [17, 103]
    real(dp), parameter :: shift(2) = [0.145_dp, 0.0_dp], tip(2) = [0.15966_dp, 0.87235_dp]
    type(gear_spec_t) :: spec
    type(gear_t) :: gear(2)
    type(error_t), allocatable :: error
    integer :: i

    do i = 1, 2
      spec = gear_spec_t('gear', teeth(i), 8e-3_dp, profile_shift=shift(i), face_width=0.1_dp, dedendum=1.4_dp, &
                         rack_tip_radius=[0.39_dp, 0.39_dp], tip_diameter=tip(i), helix_angle=merge(1, -1, i == 1)*15.8_dp*pi/180)
      call make_gear(spec, gear(i), error)
      call check_no_error(t, 'gear', error)
      call make_virtual_gear(gear(i), .false., virtual(i), error)
      call check_no_error(t, 'virtual gear', error)
    end do
    call make_pair(gear(1), gear(2), 0.5_dp, pair, error)
    call check_no_error(t, 'pair', error)
  end subroutine make_example

  !> ISO/TR 6336-30, example 1, as a public program prints it (gfsReboucas/Drivetrain, MATISO_6336.m), to the printed digits; Z_eps
  !> is printed with three, and sigma_H with a K_v that is rounded to 1.003. z_n is that of the virtual gears.
  subroutine helical_example(t)
    type(tally_t), intent(inout) :: t
    type(pair_t) :: pair
    type(gear_t) :: virtual(2)
    type(nominal_t) :: nominal
    type(material_t) :: material(2)

    call make_example(t, pair, virtual)
    nominal = nominal_of(pair, material, 9000/pair%gear(1)%base_radius(drive), [0.0_dp, 0.0_dp], 1.16_dp, 5, virtual)
    call check_close(t, 'z_n of the pinion', virtual(1)%spec%virtual_teeth, 18.905_dp, absolute=6e-4_dp)
    call check_close(t, 'z_n of the gear', virtual(2)%spec%virtual_teeth, 114.543_dp, absolute=6e-4_dp)
    call check_close(t, 'F_t', nominal%load, 127352.0_dp, absolute=0.6_dp)
    call check_close(t, 'Z_H', nominal%flank%zone, 2.39533_dp, absolute=6e-6_dp)
    call check_close(t, 'Z_E', nominal%flank%elasticity/1e3_dp, 189.8117_dp, absolute=6e-5_dp)
    call check_close(t, 'Z_eps', nominal%flank%contact_ratio, 0.803_dp, absolute=6e-4_dp)
    call check_close(t, 'Z_beta', nominal%flank%helix, 1.01944_dp, absolute=6e-6_dp)
    call check_close(t, 'Z_B and Z_D', maxval(nominal%flank%single_pair), 1.0_dp)
    call check_close(t, 'sigma_H0', nominal%contact/1e6_dp, 1206.58207_dp, 1e-6_dp)
    call check_close(t, 'sigma_H', nominal%contact/1e6_dp*sqrt(1.003_dp*1.16_dp), 1301.35343_dp, 2e-4_dp)
    call check_close(t, 'K_F_beta', nominal%root_face_load, 1.12803_dp, 4e-4_dp)
    call check_close(t, 'Y_beta', nominal%helix, 1 - 15.8_dp/120)
  end subroutine helical_example

  !> Y_F of both gears of that example by the equations of the standard for a rack of any number of teeth, 6336-3:2006, clause 6, in
  !> the normal section, and sigma_F0 with it.
  subroutine helical_form(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: alpha = pi/9, rack = 1.4_dp, rounding = 0.39_dp
    type(pair_t) :: pair
    type(gear_t) :: virtual(2)
    type(nominal_t) :: nominal
    type(material_t) :: material(2)
    real(dp) :: z, x, e, g, h, theta, thickness, outer, angle, gamma, load_angle, lever, form, base, tip, slant
    integer :: i, k

    call make_example(t, pair, virtual)
    nominal = nominal_of(pair, material, 9000/pair%gear(1)%base_radius(drive), [0.0_dp, 0.0_dp], 1.0_dp, 5, virtual)
    slant = cos(asin(sin(15.8_dp*pi/180)*cos(alpha)))
    do i = 1, 2
      x = pair%gear(i)%spec%profile_shift
      z = pair%gear(i)%spec%teeth/(slant**2*cos(15.8_dp*pi/180))
      e = pi/4 - rack*tan(alpha) - (1 - sin(alpha))*rounding/cos(alpha)
      g = rounding - rack + x
      h = 2/z*(pi/2 - e) - pi/3
      theta = pi/6
      do k = 1, 100
        theta = 2*g/z*tan(theta) - h
      end do
      thickness = z*sin(pi/3 - theta) + sqrt(3.0_dp)*(g/cos(theta) - rounding)
      ! In modules: base and tip diameter of the virtual gear, and that of the load.
      base = z*cos(alpha)
      tip = z + (pair%gear(i)%spec%tip_diameter - 2*pair%gear(i)%reference_radius)/8e-3_dp
      outer = 2*sqrt((sqrt((tip/2)**2 - (base/2)**2) - pi*cos(alpha)*(pair%contact_ratio/slant**2 - 1))**2 + (base/2)**2)
      angle = acos(base/outer)
      gamma = (pi/2 + 2*x*tan(alpha))/z + tan(alpha) - alpha - (tan(angle) - angle)
      load_angle = angle - gamma
      lever = ((cos(gamma) - sin(gamma)*tan(load_angle))*outer - z*cos(pi/3 - theta) - g/cos(theta) + rounding)/2
      form = 6*lever*cos(load_angle)/(thickness**2*cos(alpha))
      call check_close(t, 'Y_F', nominal%form(i)%form_factor, form, 1e-9_dp)
      call check_close(t, 'rho_F', nominal%form(i)%radius/8e-3_dp, rounding + 2*g**2/(cos(theta)*(z*cos(theta)**2 - 2*g)), 1e-9_dp)
      call check_close(t, 'sigma_F0', nominal%root(i), nominal%load/(0.1_dp*8e-3_dp)*form*nominal%form(i)%correction &
                       *(1 - 15.8_dp/120), 1e-9_dp)
    end do
  end subroutine helical_form

  !> A helix of a millionth of a radian has the factors of a spur pair. Z_B falls in a straight line over the overlap ratio to 1;
  !> Y_beta stays from an overlap ratio of 1 and from 30 degrees on.
  subroutine helical_limits(t)
    type(tally_t), intent(inout) :: t
    type(pair_t) :: pair, spur
    type(flank_factors_t) :: found, straight
    type(gear_t) :: gear(2), virtual(2)
    type(nominal_t) :: nominal(2)
    type(material_t) :: material(2)
    type(gear_spec_t) :: spec
    type(error_t), allocatable :: error
    real(dp) :: single(2)
    integer :: i, k

    call make(t, 0.003_dp, [17, 40], [0.3_dp, -0.2_dp], 0.02_dp, 0.0_dp, spur)
    straight = flank_factors(spur, steel, poisson)
    do k = 1, 2
      do i = 1, 2
        spec = spur%gear(i)%spec
        spec%helix_angle = merge(1, -1, i == 1)*merge(1e-6_dp, 0.2_dp, k == 1)
        if (k == 2) spec%face_width = 0.4_dp*pi*spec%module/sin(0.2_dp)
        call make_gear(spec, gear(i), error)
        call make_virtual_gear(gear(i), .false., virtual(i), error)
        call check_no_error(t, 'virtual gear', error)
      end do
      call make_pair(gear(1), gear(2), free_centre_distance(gear(1), gear(2)), pair, error)
      call check_no_error(t, 'pair', error)
      found = flank_factors(pair, steel, poisson)
      if (k == 2) exit
      call check_close(t, 'Z_H', found%zone, straight%zone, 1e-9_dp)
      call check_close(t, 'Z_eps', found%contact_ratio, straight%contact_ratio, 1e-5_dp)
      call check_close(t, 'Z_B', found%single_pair(1), straight%single_pair(1), 1e-5_dp)
      call check_close(t, 'Z_beta', found%helix, 1.0_dp, 1e-9_dp)
      nominal(1) = nominal_of(pair, material, 7e3_dp, [0.0_dp, 0.0_dp], 1.0_dp, 5, virtual)
      nominal(2) = nominal_of(spur, material, 7e3_dp, [0.0_dp, 0.0_dp], 1.0_dp, 5)
      call check_close(t, 'root stress', maxval(abs(nominal(1)%root/nominal(2)%root - 1)), 0.0_dp, absolute=1e-5_dp)
    end do
    call check_close(t, 'overlap ratio', pair%overlap_ratio, 0.4_dp, 1e-12_dp)
    associate (tangent => product(pair%gear%base_radius(drive))*tan(pair%working_angle(drive))**2, e => pair%contact_ratio)
      single = sqrt(tangent/[product(pair%curvature([1, 2], e - 1)), product(pair%curvature([1, 2], 1.0_dp))])
      call check_true(t, 'Z_B counts', single(1) > 1)
      call check_close(t, 'Z_B between', found%single_pair(1), single(1) - 0.4_dp*(single(1) - 1), 1e-12_dp)
      call check_close(t, 'Z_eps between', found%contact_ratio**2, (4 - e)/3*0.6_dp + 0.4_dp/e, 1e-12_dp)
    end associate
    pair%overlap_ratio = 3
    call check_close(t, 'Y_beta', helix_factor(pair), 1 - 0.2_dp*180/pi/120, 1e-12_dp)
    pair%gear(1)%spec%helix_angle = 0.6_dp
    call check_close(t, 'least Y_beta', helix_factor(pair), 0.75_dp, 1e-12_dp)
  end subroutine helical_limits

  !> The task of helical gears. K_v of Method A is the dynamic factor of a sweep at that speed over that at 1 rpm, where a pair's
  !> largest load is that at rest within 1e-4; both with even faces, as K_H_beta has the misalignment. K_v of Method B has the total
  !> contact ratio. K_H_beta and K_F_beta are those of the load over the face.
  subroutine helical_task(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: gears = '&pair module_mm = 3 face_width_mm = 30 helix_angle_deg = 18 / &pinion teeth = 22 / '// &
      '&gear teeth = 41 / &load line_load_n_mm = 250 / &section elements_across = 4 / &dynamics damping_ratio = 0.05 / '
    type(study_t) :: study
    type(table_t) :: rating, factors, dynamic, summary, sweep
    type(case_t) :: case
    type(error_t), allocatable :: error
    type(method_b_t) :: of
    real(dp) :: speed, overlap, larger

    call solve_text(t, '&case tasks = ''sweep'' / '//gears//'&sweep rpm_first = 1 rpm_last = 8000 rpm_step = 7999 /')
    call make_table(study, 'sweep', sweep, error)
    call check_no_error(t, 'table of the sweep', error)
    call solve_text(t, '&case tasks = ''face_load'', ''rating'' / '//gears//'&face misalignment_um = 25 / &rating rpm = 8000 /')
    call make_table(study, 'rating', rating, error)
    call make_table(study, 'rating_factors', factors, error)
    call make_table(study, 'dynamic_factors', dynamic, error)
    call make_table(study, 'face_load_summary', summary, error)
    call check_no_error(t, 'tables', error)
    call check_close(t, 'K_H_beta', factors%number('face_load_factor', 1), summary%number('mean_face_load_factor', 1), 1e-14_dp)
    call check_close(t, 'K_F_beta', factors%number('root_face_load_factor', 1), summary%number('root_face_load_factor', 1), &
                     1e-14_dp)
    call check_true(t, 'both above 1', factors%number('root_face_load_factor', 1) > 1.05_dp .and. &
                    factors%number('face_load_factor', 1) > factors%number('root_face_load_factor', 1))
    speed = 8000
    overlap = study%pair%overlap_ratio
    associate (pair => study%pair)
      of = method_b_t(22, pair%contact_ratio + overlap, single_stiffness=1e9_dp*factors%number('single_stiffness_n_mm_um', 1), &
                      mesh_stiffness=1e9_dp*factors%number('mesh_stiffness_n_mm_um', 1), &
                      mass=1e3_dp*factors%number('reduced_mass_kg_mm', 1), &
                      line_load=factors%number('tangential_load_n', 1)/0.03_dp, &
                      pitch_deviation=1e-6_dp*factors%number('pitch_deviation_um', 1), &
                      profile_deviation=1e-6_dp*factors%number('profile_deviation_um', 1))
      call check_close(t, 'F_t', factors%number('tangential_load_n', 1), 7500*cos(pair%gear(1)%transverse_angle(drive)), 1e-12_dp)
    end associate
    call check_close(t, 'K_v of Method B', dynamic%number('dynamic_factor_b', 1), dynamic_factor_b(of, speed), 1e-9_dp)
    call check_close(t, 'K_v of Method A', dynamic%number('dynamic_factor_a', 1), &
                     sweep%number('dynamic_factor', 2)/sweep%number('dynamic_factor', 1), 1e-4_dp)
    call check_true(t, 'the motion counts', dynamic%number('dynamic_factor_a', 1) > 1.05_dp)
    larger = max(dynamic%number('dynamic_factor_a', 1), dynamic%number('dynamic_factor_b', 1))
    call check_close(t, 'sigma_H', rating%number('contact_stress_mpa', 1), factors%number('nominal_contact_mpa', 1) &
                     *factors%number('single_pair_factor', 1)*sqrt(larger*factors%number('face_load_factor', 1)), 1e-9_dp)
    call check_close(t, 'sigma_F', rating%number('root_stress_mpa', 2), factors%number('nominal_root_mpa', 2) &
                     *larger*factors%number('root_face_load_factor', 1), 1e-9_dp)
    call read_case('&case tasks = ''rating'' / '//gears//'&rating rpm = 8000 /', case, error)
    call check_no_error(t, 'even faces', error)
    call check_equal(t, 'the motion uses section and damping', case%unused, '')

  contains

    subroutine solve_text(t, words)
      type(tally_t), intent(inout) :: t
      character(*), intent(in) :: words
      type(case_t) :: case
      type(error_t), allocatable :: error

      call read_case(words, case, error)
      call check_no_error(t, 'case', error)
      call run_study(case, '', 1, study, error)
      call check_no_error(t, 'study', error)
    end subroutine solve_text
  end subroutine helical_task

  !> FZG type C and a variant of it in reports of the program GEARpie (C40, REP): printed digits. It takes the tangential
  !> load on the working pitch circle. Z_B over Z_D is the ratio of its two contact stresses, and Z_D is 1.
  subroutine fzg_reports(t)
    type(tally_t), intent(inout) :: t
    type(pair_t) :: pair
    type(flank_factors_t) :: factors

    call make(t, 0.0045_dp, [16, 24], [0.1817_dp, 0.1715_dp], 0.04_dp, 0.0915_dp, pair)
    factors = flank_factors(pair, steel, poisson)
    call check_close(t, 'C40: Z_E', factors%elasticity*1e-3_dp, 189.812_dp, absolute=6e-4_dp)
    call check_close(t, 'C40: Z_H', factors%zone, 2.342_dp, absolute=6e-4_dp)
    call check_close(t, 'C40: Z_eps', factors%contact_ratio, 0.920_dp, absolute=6e-4_dp)
    call check_close(t, 'C40: Z_B', factors%single_pair(1), 999.48_dp/933.91_dp, absolute=2e-5_dp)
    call check_close(t, 'C40: sigma_H0', 1e-6_dp*nominal_flank_stress(pair, factors, 5888.3_dp), 754.69_dp, absolute=0.01_dp)
    call make(t, 0.0045_dp, [16, 24], [0.1817_dp, 0.1715_dp], 0.014_dp, 0.0915_dp, pair, [0.082456_dp, 0.118364_dp])
    factors = flank_factors(pair, steel, poisson)
    call check_close(t, 'REP: Z_eps', factors%contact_ratio, 0.924_dp, absolute=6e-4_dp)
    call check_close(t, 'REP: Z_B', factors%single_pair(1), 1421.69_dp/1322.65_dp, absolute=2e-4_dp)
    call check_close(t, 'REP: sigma_H0', 1e-6_dp*nominal_flank_stress(pair, factors, 4688.1_dp), 1143.79_dp, absolute=0.05_dp)
  end subroutine fzg_reports

  !> Without Z_eps, sigma_H0 is Hertz's pressure of the whole load at the pitch point, and with Z_B and Z_D that at the
  !> inner points of single pair contact, for unlike materials too.
  subroutine hertz(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: young(2) = [206e9_dp, 105e9_dp], nu(2) = [0.3_dp, 0.25_dp], force = 7000
    type(pair_t) :: pair
    type(flank_factors_t) :: factors
    real(dp) :: nominal, tangential

    call make(t, 0.003_dp, [17, 40], [0.3_dp, -0.2_dp], 0.02_dp, 0.0_dp, pair)
    factors = flank_factors(pair, young, nu)
    tangential = force*cos(pair%gear(1)%spec%pressure_angle(drive))
    nominal = nominal_flank_stress(pair, factors, tangential)/factors%contact_ratio
    call check_close(t, 'Hertz at the pitch point', nominal, pressure([pair%gear(1)%base_radius(drive), &
      pair%gear(2)%base_radius(drive)]*tan(pair%working_angle(drive))), 1e-12_dp)
    call check_true(t, 'Z_B counts', factors%single_pair(1) > 1)
    call check_close(t, 'Hertz at B', nominal*factors%single_pair(1), at(pair%contact_ratio - 1), 1e-12_dp)
    call check_close(t, 'Hertz at D', nominal*factors%single_pair(2), max(nominal, at(1.0_dp)), 1e-12_dp)

  contains

    real(dp) function at(s)
      real(dp), intent(in) :: s

      at = pressure([pair%curvature(1, s), pair%curvature(2, s)])
    end function at

    !> Largest pressure between two cylinders (Johnson, Contact mechanics, section 4.2).
    real(dp) function pressure(radii)
      real(dp), intent(in) :: radii(2)

      pressure = sqrt(force/0.02_dp*sum(1/radii)/(pi*sum((1 - nu**2)/young)))
    end function pressure
  end subroutine hertz

  !> The ranges of K_v over the speed, for numbers such that B_p = 0.3, B_f = 0.2 and B_k = 0.6.
  subroutine method_b_ranges(t)
    type(tally_t), intent(inout) :: t
    type(method_b_t) :: of
    real(dp) :: resonance
    integer :: i

    of = method_b_t(20, 1.6_dp, 14e9_dp, 20e9_dp, 4.5_dp, 350e3_dp, 7.5e-6_dp, 5e-6_dp, [10e-6_dp, 15e-6_dp])
    ! n_E1 = 30000/(pi z_1) sqrt(c_gamma/m_red), in N/(mm um) and kg/mm.
    resonance = 30000/(pi*20)*sqrt(20/4.5e-3_dp)
    call check_close(t, 'N at n_E1', resonance_ratio(of, resonance), 1.0_dp, 1e-14_dp)
    call check_close(t, 'below: half of resonance', dynamic_factor_b(of, resonance/2), &
                     1 + 0.5_dp*(0.32_dp*0.3_dp + 0.34_dp*0.2_dp + 0.23_dp*0.6_dp), 1e-14_dp)
    call check_close(t, 'in resonance', dynamic_factor_b(of, resonance), &
                     1 + 0.32_dp*0.3_dp + 0.34_dp*0.2_dp + 0.9_dp*0.6_dp, 1e-14_dp)
    call check_close(t, 'above', dynamic_factor_b(of, 2*resonance), &
                     0.47_dp*0.3_dp + 0.47_dp*0.2_dp + 0.125_dp*sin(-0.4_dp*pi) + 0.875_dp, 1e-14_dp)
    call check_close(t, 'between, in the middle', dynamic_factor_b(of, 1.325_dp*resonance), &
                     (dynamic_factor_b(of, resonance) + dynamic_factor_b(of, 2*resonance))/2, 1e-13_dp)
    do i = 1, 2
      associate (n => merge(1.15_dp, 1.5_dp, i == 1)*resonance)
        call check_close(t, 'no jump where the range between begins and ends', dynamic_factor_b(of, n*(1 - 1e-12_dp)), &
                         dynamic_factor_b(of, n*(1 + 1e-12_dp)), 1e-9_dp)
      end associate
    end do
    ! N_S falls below 100 N/mm; at 25 N/mm it is 0.675.
    of%line_load = 25e3_dp
    call check_close(t, 'light load: below', (dynamic_factor_b(of, 0.67_dp*resonance) - 1)/0.67_dp, &
                     (dynamic_factor_b(of, 0.1_dp*resonance) - 1)/0.1_dp, 1e-12_dp)
    call check_close(t, 'light load: in resonance', dynamic_factor_b(of, 0.68_dp*resonance), dynamic_factor_b(of, resonance), &
                     1e-14_dp)
    of = method_b_t(20, 1.6_dp, 14e9_dp, 20e9_dp, 4.5_dp, 350e3_dp, 0.0_dp, 0.0_dp, 350e3_dp/14e9_dp*[1, 1])
    call check_close(t, 'relief that fits and no deviations', dynamic_factor_b(of, resonance), 1.0_dp, 1e-15_dp)
  end subroutine method_b_ranges

  !> One term at a time, at contact ratios either side of 2 and 2.5: Table 8 of the standard, in resonance and above it.
  subroutine method_b_coefficients(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: ratio(4) = [1.4_dp, 1.8_dp, 2.2_dp, 2.7_dp]
    real(dp), parameter :: cv2(4) = [0.34_dp, 0.34_dp, 0.57_dp/1.9_dp, 0.57_dp/2.4_dp], &
      cv4(4) = [0.9_dp, 0.9_dp, 0.46_dp/0.76_dp, 0.435_dp/1.26_dp], &
      cv3(4) = [0.23_dp, 0.23_dp, 0.096_dp/0.64_dp, 0.096_dp/1.14_dp], &
      cv6(4) = [0.47_dp, 0.47_dp, 0.12_dp/0.46_dp, 0.12_dp/0.96_dp], &
      cv7(4) = [0.75_dp, 0.875_dp - 0.125_dp*0.5877852522924731_dp, 0.875_dp + 0.125_dp*0.5877852522924731_dp, 1.0_dp]
    type(method_b_t) :: fits
    real(dp) :: resonance
    integer :: i

    resonance = 30000/(pi*20)*sqrt(20/4.5e-3_dp)
    do i = 1, 4
      ! Relief that fits the load; deviations of 25 um make B_p or B_f 1, and no relief makes B_k 1.
      fits = method_b_t(20, ratio(i), 14e9_dp, 20e9_dp, 4.5_dp, 350e3_dp, 0.0_dp, 0.0_dp, [25e-6_dp, 25e-6_dp])
      call check_close(t, 'C_v1', in_resonance(25e-6_dp, 0.0_dp, 25e-6_dp, resonance), 0.32_dp, 1e-12_dp)
      call check_close(t, 'C_v2', in_resonance(0.0_dp, 25e-6_dp, 25e-6_dp, resonance), cv2(i), 1e-12_dp)
      call check_close(t, 'C_v4', in_resonance(0.0_dp, 0.0_dp, 0.0_dp, resonance), cv4(i), 1e-12_dp)
      call check_close(t, 'C_v3', 2*in_resonance(0.0_dp, 0.0_dp, 0.0_dp, resonance/2), cv3(i), 1e-12_dp)
      call check_close(t, 'C_v7', in_resonance(0.0_dp, 0.0_dp, 0.0_dp, 2*resonance) + 1, cv7(i), 1e-12_dp)
      call check_close(t, 'C_v5', in_resonance(25e-6_dp, 0.0_dp, 0.0_dp, 2*resonance) + 1 - cv7(i), 0.47_dp, 1e-12_dp)
      call check_close(t, 'C_v6', in_resonance(0.0_dp, 25e-6_dp, 0.0_dp, 2*resonance) + 1 - cv7(i), cv6(i), 1e-12_dp)
    end do

  contains

    !> K_v less 1.
    real(dp) function in_resonance(pitch, profile, relief, rpm)
      real(dp), intent(in) :: pitch, profile, relief, rpm
      type(method_b_t) :: of

      of = fits
      of%pitch_deviation = pitch
      of%profile_deviation = profile
      of%relief = relief
      in_resonance = dynamic_factor_b(of, rpm) - 1
    end function in_resonance
  end subroutine method_b_coefficients

  !> K_v to the two decimals that the reports of GEARpie print: grade 5 of the larger gear, K_A = 1.25, no relief, solid
  !> gears of 7830 kg/m^3 up to their mean diameters.
  subroutine method_b_reports(t)
    type(tally_t), intent(inout) :: t

    call report('C40', 0.04_dp, 5888.3_dp, 1800.0_dp, 1.04_dp, [0.082636_dp, 0.118544_dp])
    call report('REP', 0.014_dp, 4688.1_dp, 300.0_dp, 1.01_dp, [0.082456_dp, 0.118364_dp])

  contains

    subroutine report(name, width, load, rpm, printed, tips)
      character(*), intent(in) :: name
      real(dp), intent(in) :: width, load, rpm, printed, tips(2)
      type(pair_t) :: pair
      type(piecewise_t) :: stiffness
      type(error_t), allocatable :: error
      type(method_b_t) :: of
      real(dp) :: mean(2), mass(2), deviations(2)

      call make(t, 0.0045_dp, [16, 24], [0.1817_dp, 0.1715_dp], width, 0.0915_dp, pair, tips)
      call iso_stiffness(pair, spread(material_t(), 1, 2), load*1.25_dp/width/cos(pi/9), stiffness, error)
      mean = pair%gear%tip_radius + pair%gear%root_radius
      mass = pi/32*7830*mean**4/pair%gear%base_radius(drive)**2
      deviations = deviations_of(5, 0.0045_dp, 0.108_dp, 0.0_dp)*[1 - 0.0758_dp, 1 - 0.075_dp]
      of = method_b_t(16, pair%contact_ratio, stiffness%maximum()/width, 0.0_dp, product(mass)/sum(mass), load*1.25_dp/width, &
                      deviations(1), deviations(2))
      of%mesh_stiffness = of%single_stiffness*(0.75_dp*pair%contact_ratio + 0.25_dp)
      call check_close(t, name//': K_v', dynamic_factor_b(of, rpm), printed, absolute=0.006_dp)
    end subroutine report
  end subroutine method_b_reports

  !> Grade 5, module 2, diameter 100 mm: 6.0 and 6.0 um once rounded (tests of the package gearcore, by ISO 1328-1). A grade
  !> more is the square root of two.
  subroutine accuracy_grades(t)
    type(tally_t), intent(inout) :: t
    real(dp) :: five(2)

    five = deviations_of(5, 0.002_dp, 0.1_dp, 0.0_dp)
    call check_true(t, 'f_pt and f_f_alpha, rounded', all(nint(1e6_dp*five) == 6))
    call check_close(t, 'two grades double', maxval(abs(deviations_of(7, 0.002_dp, 0.1_dp, 0.0_dp)/five - 2)), 0.0_dp, &
                     absolute=1e-14_dp)
  end subroutine accuracy_grades

  !> K_F_beta from K_H_beta as the reports of GEARpie print them, and the rim factor: 1 where the standard says that it begins.
  subroutine load_factors(t)
    type(tally_t), intent(inout) :: t
    type(pair_t) :: pair

    call make(t, 0.0045_dp, [16, 24], [0.1817_dp, 0.1715_dp], 0.04_dp, 0.0915_dp, pair)
    call check_close(t, 'C40: K_F_beta', root_face_load_factor(pair, 1.17_dp), 1.13_dp, absolute=6e-3_dp)
    call make(t, 0.0045_dp, [16, 24], [0.1817_dp, 0.1715_dp], 0.014_dp, 0.0915_dp, pair)
    call check_close(t, 'REP: K_F_beta, wide teeth', root_face_load_factor(pair, 1.06_dp), 1.04_dp, absolute=6e-3_dp)
    call check_close(t, 'no rim stated', rim_factor(0.0_dp, 0.01_dp), 1.0_dp, 1e-15_dp)
    call check_close(t, 'a thick rim', rim_factor(0.013_dp, 0.01_dp), 1.0_dp, 1e-15_dp)
    call check_close(t, 'where Y_B begins', rim_factor(0.011999999_dp, 0.01_dp), 1.0_dp, absolute=3e-4_dp)
    call check_close(t, 'a rim of half a tooth height', rim_factor(0.005_dp, 0.01_dp), 1.6_dp*log(4.484_dp), 1e-14_dp)
  end subroutine load_factors

  !> FZG type C as a case: printed stresses of the report C40, whose tangential load is that of the working pitch circle and
  !> whose load factors are printed to two decimals; and the products of the factors, put together once more, with each K_v.
  subroutine task(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: text = '&case tasks = ''rating'' / &pair module_mm = 4.5 face_width_mm = 40 '// &
      'centre_distance_mm = 91.5 / &pinion teeth = 16 profile_shift = 0.1817 rack_tip_radius = 0.375 / &gear teeth = 24 '// &
      'profile_shift = 0.1715 rack_tip_radius = 0.375 / &material density_kgm3 = 7830 / &load torque_nm = 215.513 '// &
      'application_factor = 1.25 / &relief amount_um = 0, 10 / &rating rpm = 1800, 6000 face_load_factor = 1.17 '// &
      'transverse_load_factor = 1.1 contact_limit_mpa = 1490.03 root_limit_mpa = 818.25, 819.58 dynamic_factor_method = '
    real(dp), parameter :: on_working = 36.6_dp/36, limits(2) = [818.25_dp, 819.58_dp]
    character(6), parameter :: methods(3) = ['larger', 'a     ', 'b     ']
    type(table_t) :: rating, factors, dynamic
    real(dp) :: k_v, contact, root
    integer :: i, gear, point, method

    do method = 1, 3
      call solve(t, text//''''//trim(methods(method))//''' /', 'rating', rating)
      call solve(t, text//''''//trim(methods(method))//''' /', 'rating_factors', factors)
      call solve(t, text//''''//trim(methods(method))//''' /', 'dynamic_factors', dynamic)
      do i = 1, rating%rows
        gear = merge(1, 2, rating%word('gear', i) == 'pinion')
        point = (i + 1)/2
        associate (a => dynamic%number('dynamic_factor_a', point), b => dynamic%number('dynamic_factor_b', point))
          k_v = merge(a, b, method == 2 .or. (method == 1 .and. a >= b))
          call check_true(t, 'the method that counts', rating%word('method', i) == merge('a', 'b', k_v >= a .and. k_v <= a))
        end associate
        contact = rating%number('contact_stress_mpa', i)
        root = rating%number('root_stress_mpa', i)
        call check_close(t, 'its K_v', rating%number('internal_dynamic_factor', i), k_v, 1e-15_dp)
        call check_close(t, 'sigma_H from its factors', contact**2, &
                         (factors%number('single_pair_factor', gear)*factors%number('nominal_contact_mpa', gear))**2* &
                         1.25_dp*k_v*1.17_dp*1.1_dp, 1e-12_dp)
        call check_close(t, 'sigma_F from its factors', root, factors%number('nominal_root_mpa', gear)*1.25_dp*k_v*1.1_dp* &
                         factors%number('root_face_load_factor', gear), 1e-12_dp)
        call check_close(t, 'S_H', contact*rating%number('contact_safety', i), 1490.03_dp, 1e-12_dp)
        call check_close(t, 'S_F', root*rating%number('root_safety', i), limits(gear), 1e-12_dp)
        call check_true(t, 'its row of the dynamic factors', &
                        abs(rating%number('relief_um', i) - dynamic%number('relief_um', point)) <= 0 .and. &
                        abs(rating%number('rpm', i) - dynamic%number('rpm', point)) <= 0)
      end do
    end do
    call check_close(t, 'C40: sigma_H', rating%number('contact_stress_mpa', 1)/sqrt(on_working*1.1_dp), 999.48_dp, 5e-3_dp)
    call check_close(t, 'C40: sigma_F', rating%number('root_stress_mpa', 1)/(on_working*1.1_dp), 150.70_dp, 1e-2_dp)
    call check_true(t, 'relief lowers K_v by Method B', &
                    dynamic%number('dynamic_factor_b', 3) < dynamic%number('dynamic_factor_b', 1))
  end subroutine task

  !> One table of a case.
  subroutine solve(t, text, name, table)
    type(tally_t), intent(inout) :: t
    character(*), intent(in) :: text, name
    type(table_t), intent(out) :: table
    type(case_t) :: case
    type(study_t) :: study
    type(error_t), allocatable :: error

    call read_case(text, case, error)
    if (.not. allocated(error)) call run_study(case, '', 1, study, error)
    call check_no_error(t, 'the study', error)
    if (.not. allocated(error)) call make_table(study, name, table, error)
    call check_no_error(t, 'the table '//name, error)
  end subroutine solve

  !> A material's numbers, by hand from the lines of ISO 6336-5, Table 1, and the safety factors that follow; and that a better
  !> grade bears no less.
  subroutine materials(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: begin = '&case tasks = ''rating'' / &pair module_mm = 3 face_width_mm = 20 / '// &
      '&pinion teeth = 21 / &gear teeth = 34 / &load torque_nm = 100 / &mesh model = ''weber'' / &rating rpm = 1800 material = '
    real(dp), parameter :: contact(2) = [1650.0_dp, 923.9_dp], root(2) = [525.0_dp, 338.4_dp]
    type(case_t) :: case
    type(study_t) :: study
    type(error_t), allocatable :: error
    type(table_t) :: rating, factors
    integer :: i

    call read_case(begin//'''case_hardened'', ''alloy_steel'' material_grade = ''me'' /', case, error)
    if (.not. allocated(error)) call run_study(case, '', 1, study, error)
    call check_no_error(t, 'two materials', error)
    call make_table(study, 'rating', rating, error)
    call make_table(study, 'rating_factors', factors, error)
    do i = 1, 2
      call check_close(t, 'sigma_Hlim', factors%number('contact_number_mpa', i), contact(i), 1e-12_dp)
      call check_close(t, 'sigma_Flim', factors%number('root_number_mpa', i), root(i), 1e-12_dp)
      call check_close(t, 'S_H of a material', rating%number('contact_stress_mpa', i)*rating%number('contact_safety', i), &
                       contact(i), 1e-12_dp)
      call check_close(t, 'S_F of a material', rating%number('root_stress_mpa', i)*rating%number('root_safety', i), &
                       2*root(i), 1e-12_dp)
    end do
    do i = 1, size(gear_materials)
      associate (contact => contact_number(gear_materials(i), [1, 2, 3]), root => root_number(gear_materials(i), [1, 2, 3]))
        call check_true(t, 'a better grade bears no less: '//trim(gear_materials(i)%name), &
                        all(contact(2:) >= contact(:2)) .and. all(root(2:) >= root(:2)))
        call check_true(t, 'the root bears less than the flank', all(root < contact))
      end associate
    end do
    ! Common names, in any case.
    call solve(t, begin//'''18CRNIMO7-6'', ''42CrMo4'' material_grade = ''me'' /', 'rating_factors', factors)
    do i = 1, 2
      call check_close(t, 'sigma_Hlim by a common name', factors%number('contact_number_mpa', i), contact(i), 1e-12_dp)
      call check_close(t, 'sigma_Flim by a common name', factors%number('root_number_mpa', i), root(i), 1e-12_dp)
    end do
    call check_true(t, 'what the material is and what it is called', factors%word('material', 1) == 'case_hardened' .and. &
                    factors%word('material_name', 1) == '18CrNiMo7-6' .and. factors%word('material_grade', 2) == 'me')
    do i = 1, size(common_names)
      call check_true(t, 'a common name of a material: '//trim(common_names(i)%name), &
                      any(gear_materials%name == common_names(i)%material))
    end do
    call read_case(begin//'''case_hardened'' root_limit_mpa = 900 /', case, error)
    call check_error(t, 'a material and a limit', error, '&rating root_limit_mpa')
    call read_case(begin//'''butter'' /', case, error)
    call check_error(t, 'no such material', error, 'must be one of ''normalized_steel''')
    call check_error(t, 'no such material', error, '''18CrNiMo7-6''')
  end subroutine materials
end module test_iso_rating
