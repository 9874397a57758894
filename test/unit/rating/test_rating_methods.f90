!> Rating by ISO 6336: the dynamic factor by Method A, deep teeth, in which accuracy grades relief counts, and what the tasks
!> `rating`, `flank` and `life` have in common.
module test_rating_methods
  use gearsweep_study_case_case, only: case_t
  use gearsweep_api_case_reader, only: read_case
  use gearsweep_rating_dynamic_factor, only: counted_relief, deviations_of, dynamic_factor_a, grade_of, no_grade
  use gearsweep_base_error, only: error_t
  use gearsweep_rating_form, only: deep_tooth_factor, iso_form, nominal_root_stress, outer_single_contact
  use gearsweep_gear_gear, only: drive
  use gearsweep_base_kinds, only: dp, pi
  use gearsweep_gear_pair, only: pair_t
  use gearsweep_study_run_study, only: run_study, study_t
  use gearsweep_base_table, only: table_t
  use gearsweep_api_tables, only: make_table
  use gearsweep_base_text, only: str
  use test_iso_rating, only: make, solve
  use test_support_ask_by_name, only: answer_t, ask, refusal
  use test_support_testing, only: check_close, check_no_error, check_true, tally_t
  implicit none
  private
  public :: run

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t

    if (t%wants('method_a')) call method_a(t)
    if (t%wants('deep_teeth')) call deep_teeth(t)
    if (t%wants('relief_and_grade')) call relief_and_grade(t)
    if (t%wants('beside_flank_and_life')) call beside_flank_and_life(t)
    if (t%wants('over_the_face')) call over_the_face(t)
  end subroutine run

  !> With &face or a lead K_H_beta and K_F_beta are those of the task face_load, and stresses grow with them as with stated ones;
  !> without, and with a rigid and parallel face almost, they are 1.
  subroutine over_the_face(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: gears = ' tasks = ''rating'', ''face_load'', ''life'' / &pair module_mm = 3 '// &
      'face_width_mm = 30 / &pinion teeth = 25 / &load torque_nm = 250 / &mesh model = ''fe'' / &section elements_across = 6 / '// &
      '&life rpm = 3000 duration_h = 1 / &rating rpm = 3000 material = ''C45'''
    type(answer_t) :: plain, tilted, crowned
    character(:), allocatable :: said
    real(dp) :: face, root

    call ask(t, '&case'//gears//' / &gear teeth = 38 /', plain)
    call ask(t, '&case'//gears//' / &gear teeth = 38 / &face misalignment_um = 25 /', tilted)
    call ask(t, '&case'//gears//' / &gear teeth = 38 crowning_um = 10 /', crowned)
    call check_true(t, 'not computed', all(.not. abs(plain%all_of('rating_factors.face_load_factor') - 1) > 0))
    face = tilted%one('face_load_summary.face_load_factor')
    root = tilted%one('face_load_summary.root_face_load_factor')
    call check_true(t, 'bending spreads the load', root > 1.1_dp .and. root < face, str(root)//' and '//str(face))
    associate (h => tilted%all_of('rating_factors.face_load_factor'), f => tilted%all_of('rating_factors.root_face_load_factor'))
      call check_close(t, 'K_H_beta', h(1), face, 1e-15_dp)
      call check_close(t, 'K_F_beta', f(2), root, 1e-15_dp)
    end associate
    associate (of => tilted%all_of('rating.contact_stress_mpa'), without => plain%all_of('rating.contact_stress_mpa'))
      call check_close(t, 'sigma_H', of(1), without(1)*sqrt(face))
    end associate
    associate (of => tilted%all_of('rating.root_stress_mpa'), without => plain%all_of('rating.root_stress_mpa'))
      call check_close(t, 'sigma_F', of(2), without(2)*root)
    end associate
    associate (of => tilted%all_of('life_parts.contact_stress_mpa'), without => plain%all_of('life_parts.contact_stress_mpa'))
      call check_close(t, 'contact stress of life', of(1), without(1)*sqrt(face))
    end associate
    associate (h => crowned%all_of('rating_factors.face_load_factor'))
      call check_true(t, 'a lead alone', h(1) > 1.1_dp, str(h(1)))
    end associate
    said = refusal('&case'//gears//' face_load_factor = 1.2 / &gear teeth = 38 / &face misalignment_um = 25 /')
    call check_true(t, 'both', index(said, '&rating face_load_factor = 1.2: the load over the face width has it') == 1, said)
  end subroutine over_the_face

  !> K_v by Method A is a ratio of loads of the same mesh: at creeping speed 1, and never less, below a contact ratio of 2 and
  !> above it, where one pair carries hardly more than half of the load. There sigma_H with it is no less than Hertz's pressure at
  !> the pitch point; the dynamic factor in its place gave 412 MPa there where that is 482 MPa.
  subroutine method_a(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: begin = '&pair module_mm = 3 face_width_mm = 20 / &pinion teeth = 40 addendum = ', &
      middle = ' dedendum = 1.6 / &gear teeth = 60 addendum = ', &
      ends = ' dedendum = 1.6 / &load torque_nm = 200 / &mesh model = ''fe'' / &section elements_across = 8 / '// &
             '&flank rpm = 10 / &rating rpm = 10, 12000 dynamic_factor_method = ''a'' / &life rpm = 10 duration_h = 1 '// &
             'curve_cycles = 1e3, 1e6 curve_stress_mpa = 500, 86 '// &
             'mean_stress = ''none'' dynamic_load = .false. / &case tasks = ''rating'', ''flank'', ''life'' /'
    character(4), parameter :: addendum(2) = ['1.00', '1.35']
    type(case_t) :: case
    type(study_t) :: study
    type(error_t), allocatable :: error
    type(table_t) :: rating, dynamic, losses, flank, life, factors
    real(dp) :: at_pitch
    integer :: i, k

    call check_close(t, 'never below 1', dynamic_factor_a(0.6_dp, 0.8_dp), 1.0_dp, 1e-15_dp)
    call check_close(t, 'a ratio of loads', dynamic_factor_a(0.6_dp, 0.5_dp), 1.2_dp, 1e-15_dp)
    do i = 1, 2
      associate (text => begin//addendum(i)//middle//addendum(i)//ends)
        call read_case(text, case, error)
      end associate
      if (.not. allocated(error)) call run_study(case, '', 1, study, error)
      call check_no_error(t, 'contact ratio on both sides of 2', error)
      call make_table(study, 'rating', rating, error)
      call make_table(study, 'dynamic_factors', dynamic, error)
      call make_table(study, 'flank_losses', losses, error)
      call make_table(study, 'flank', flank, error)
      call make_table(study, 'life', life, error)
      call make_table(study, 'rating_factors', factors, error)
      call check_close(t, 'at creeping speed', dynamic%number('dynamic_factor_a', 1), 1.0_dp, absolute=2e-3_dp)
      call check_true(t, 'at any speed', all(dynamic%numbers('dynamic_factor_a') >= 1))
      call check_close(t, 'the load of the task flank', dynamic%number('dynamic_factor', 1), &
                       losses%number('dynamic_factor', 2), 1e-15_dp)
      call check_true(t, 'one pair carries the whole load below a contact ratio of 2 only', &
                      dynamic%number('static_share', 1) > 0.999_dp .eqv. i == 1, str(dynamic%number('static_share', 1)))
      if (i == 1) cycle
      ! Specific sliding is nothing at the pitch point.
      at_pitch = 0
      do k = 1, flank%rows
        if (flank%word('loading', k) == 'static' .and. abs(flank%number('pinion_specific_sliding', k)) < 0.05_dp) &
          at_pitch = max(at_pitch, flank%number('pressure_mpa', k))
      end do
      call check_true(t, 'sigma_H is no less than the pressure at the pitch point', &
                      rating%number('contact_stress_mpa', 1) > at_pitch .and. at_pitch > 400, &
                      str(rating%number('contact_stress_mpa', 1))//' and '//str(at_pitch))
      call check_true(t, 'sigma_F0 is no less than the root stress of life', all(factors%numbers('nominal_root_mpa') > &
                      life%numbers('largest_root_stress_mpa')) .and. life%rows == 2, str(life%number('largest_root_stress_mpa', 1)))
    end do
  end subroutine method_a

  !> d_en as ISO 6336-3 writes it, below and above a contact ratio of 2; sigma_F0 without a jump there; and Y_DT.
  subroutine deep_teeth(t)
    type(tally_t), intent(inout) :: t
    type(pair_t) :: pair
    real(dp) :: stress(2, 2), tip(2)
    integer :: i, k

    do k = 1, 2
      ! Tips that make the contact ratio 1.9997 and 2.0003.
      tip = [0.126_dp, 0.186_dp] + merge(0.9686e-3_dp, 0.9707e-3_dp, k == 1)
      call make(t, 0.003_dp, [40, 60], [0.0_dp, 0.0_dp], 0.02_dp, 0.0_dp, pair, tip)
      call check_true(t, 'below 2 and above', pair%contact_ratio < 2 .eqv. k == 1, str(pair%contact_ratio, 8))
      do i = 1, 2
        associate (gear => pair%gear(i), base => pair%gear(i)%base_radius(drive))
          call check_close(t, 'd_en/2', outer_single_contact(pair, i), &
                           sqrt((sqrt(gear%tip_radius**2 - base**2) - pair%base_pitch*(pair%contact_ratio - 1))**2 + base**2), &
                           1e-12_dp)
          stress(i, k) = nominal_root_stress(pair, i, iso_form(gear, outer_single_contact(pair, i)), 4000.0_dp)
        end associate
      end do
    end do
    call check_close(t, 'no jump at a contact ratio of 2', maxval(abs(stress(:, 2)/stress(:, 1) - 1)), 0.0_dp, absolute=2e-3_dp)
    call check_close(t, 'Y_DT in its line', deep_tooth_factor(2.3_dp, 4), 0.8342_dp, 1e-12_dp)
    call check_close(t, 'Y_DT beyond', deep_tooth_factor(2.7_dp, 0), 0.7_dp, 1e-15_dp)
    call check_close(t, 'Y_DT below', deep_tooth_factor(2.05_dp, 0), 1.0_dp, 1e-15_dp)
    call check_close(t, 'Y_DT of coarse teeth', deep_tooth_factor(2.3_dp, 5), 1.0_dp, 1e-15_dp)
  end subroutine deep_teeth

  !> Relief counts in grades 0 to 5; the grade of deviations is that which allows them.
  subroutine relief_and_grade(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: text = '&case tasks = ''rating'' / &pair module_mm = 3 face_width_mm = 20 / '// &
      '&pinion teeth = 21 / &gear teeth = 34 / &load torque_nm = 100 / &mesh model = ''weber'' / '// &
      '&relief amount_um = 0, 10 / &rating rpm = 8000 '
    type(table_t) :: exact, coarse, stated, factors
    real(dp) :: allowed(2)
    integer :: grade

    do grade = 0, 12
      allowed = deviations_of(grade, 0.003_dp, 0.102_dp, pi/9)
      call check_true(t, 'the grade of what it allows', grade_of(allowed, 0.003_dp, 0.102_dp, pi/9) == grade)
      call check_true(t, 'the next for a little more', &
                      grade_of(allowed*[1.0_dp, 1.001_dp], 0.003_dp, 0.102_dp, pi/9) == grade + 1)
      call check_true(t, 'relief counts up to grade 5', counted_relief(1e-5_dp, grade) > 0 .eqv. grade <= 5)
    end do
    call check_true(t, 'no grade', grade_of(allowed*2, 0.003_dp, 0.102_dp, pi/9) == no_grade)
    call solve(t, text//'accuracy_grade = 5 /', 'dynamic_factors', exact)
    call solve(t, text//'accuracy_grade = 6 /', 'dynamic_factors', coarse)
    call check_true(t, 'grade 5: relief counts', exact%number('dynamic_factor_b', 2) < exact%number('dynamic_factor_b', 1))
    call check_close(t, 'grade 6: B_k = 1', coarse%number('dynamic_factor_b', 2), coarse%number('dynamic_factor_b', 1), 1e-15_dp)
    ! Deviations that grade 6 allows and grade 5 does not.
    allowed = 0.99e6_dp*deviations_of(6, 0.003_dp, 0.102_dp, pi/9)
    call solve(t, text//'pitch_deviation_um = '//str(allowed(1))//' profile_deviation_um = '//str(allowed(2))//' /', &
               'dynamic_factors', stated)
    call solve(t, text//'pitch_deviation_um = '//str(allowed(1))//' profile_deviation_um = '//str(allowed(2))//' /', &
               'rating_factors', factors)
    call check_close(t, 'stated deviations of grade 6', factors%number('accuracy_grade', 1), 6.0_dp, 1e-15_dp)
    call check_close(t, 'stated deviations: B_k = 1', stated%number('dynamic_factor_b', 2), stated%number('dynamic_factor_b', 1), &
                     1e-15_dp)
  end subroutine relief_and_grade

  !> At rest and without relief, where one pair carries the whole load: the largest Hertz pressure of the task flank is
  !> Z_B sigma_H0/Z_eps, and the largest root stress of the task life K_A sigma_F0; and in motion the three have one dynamic factor.
  subroutine beside_flank_and_life(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: text = '&case tasks = ''rating'', ''flank'', ''life'' / '// &
      '&pair module_mm = 3 face_width_mm = 20 / &pinion teeth = 17 profile_shift = 0.3 / &gear teeth = 40 / '// &
      '&load torque_nm = 100 application_factor = 1.25 / '// &
      '&mesh model = ''weber'' corner_contact = .false. / &rating rpm = 3000 / &flank rpm = 3000 / '// &
      '&life rpm = 3000 duration_h = 1 curve_cycles = 1e3, 1e6 '// &
      'curve_stress_mpa = 500, 86 mean_stress = ''none'' '
    type(table_t) :: factors, losses, life, dynamic
    integer :: i

    call solve(t, text//'/', 'rating_factors', factors)
    call solve(t, text//'/', 'flank_losses', losses)
    call solve(t, text//'dynamic_load = .false. /', 'life', life)
    call solve(t, text//'/', 'dynamic_factors', dynamic)
    call check_close(t, 'the pressure of flank', losses%number('largest_pressure_mpa', 1), &
                     factors%number('nominal_contact_mpa', 1)*maxval(factors%numbers('single_pair_factor'))/ &
                     factors%number('contact_ratio_factor', 1), 1e-6_dp)
    do i = 1, 2
      call check_close(t, 'the root stress of life', life%number('largest_root_stress_mpa', i), &
                       1.25_dp*factors%number('nominal_root_mpa', i), 1e-6_dp)
    end do
    call check_close(t, 'the dynamic factor of flank', dynamic%number('dynamic_factor', 1), losses%number('dynamic_factor', 2), &
                     1e-15_dp)
    call solve(t, text//'/', 'life_parts', life)
    call check_close(t, 'the dynamic factor of life', dynamic%number('dynamic_factor', 1), life%number('dynamic_factor', 1), &
                     1e-15_dp)
  end subroutine beside_flank_and_life
end module test_rating_methods
