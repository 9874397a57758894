!> Fatigue: rainflow cycles, mean stress, S-N curves and Miner's sum, and the task `life`, against the standard's example, what
!> defines the rainflow method, textbook formulas, and spectra whose damage follows from the curve alone.
module test_life
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use gearsweep_study_case_case, only: case_t
  use gearsweep_api_case_reader, only: read_case
  use gearsweep_base_error, only: error_t
  use gearsweep_rating_root_life, only: by_gerber, by_goodman, by_iso, by_soderberg, count_cycles, curve_t, cycle_t, damage_of, &
            equivalent_amplitude, mean_ignored, root_history, root_life, root_life_t, strength_t
  use gearsweep_rating_gear_materials, only: contact_life_curve, gear_materials, life_curve_t, life_factor, root_life_curve, &
            sn_curve
  use gearsweep_rating_form, only: iso_form, nominal_root_stress
  use gearsweep_gear_gear, only: gear_spec_t, gear_t, make_gear
  use gearsweep_base_kinds, only: dp
  use gearsweep_gear_pair, only: make_pair, pair_t
  use gearsweep_study_run_study, only: run_study, study_t
  use gearsweep_base_table, only: table_t
  use gearsweep_api_tables, only: make_table
  use test_support_random_numbers, only: random_t
  use test_support_testing, only: check_close, check_equal, check_error, check_no_error, check_true, tally_t
  implicit none
  private
  public :: run

  real(dp), parameter :: mega = 1e6_dp

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t

    if (t%wants('standard_example')) call standard_example(t)
    if (t%wants('flat_histories')) call flat_histories(t)
    if (t%wants('level_crossings_of_intervals')) call level_crossings_of_intervals(t)
    if (t%wants('mean_stress')) call mean_stress(t)
    if (t%wants('curves')) call curves(t)
    if (t%wants('life_factors')) call life_factors(t)
    if (t%wants('iso_mean_stress')) call iso_mean_stress(t)
    if (t%wants('safety_for_a_life')) call safety_for_a_life(t)
    if (t%wants('miner_by_hand')) call miner_by_hand(t)
    if (t%wants('curves_refused')) call curves_refused(t)
    if (t%wants('spectra')) call spectra(t)
    if (t%wants('idlers')) call idlers(t)
    if (t%wants('overloaded')) call overloaded(t)
    if (t%wants('equal_engagements')) call equal_engagements(t)
    if (t%wants('thin_rims')) call thin_rims(t)
    if (t%wants('helical_teeth')) call helical_teeth(t)
    if (t%wants('loads_of_motions')) call loads_of_motions(t)
    if (t%wants('histories_of_motions')) call histories_of_motions(t)
  end subroutine run

  ! --- cycles ----------------------------------------------------------------------

  !> ASTM E1049-85, figure 7: ranges 3, 4, 7 and 9, once each.
  subroutine standard_example(t)
    type(tally_t), intent(inout) :: t
    type(cycle_t), allocatable :: cycles(:)
    integer :: range

    cycles = count_cycles([-2.0_dp, 1.0_dp, -3.0_dp, 5.0_dp, -1.0_dp, 3.0_dp, -4.0_dp, 4.0_dp])
    call check_equal(t, 'example of the standard: cycles', size(cycles), 4)
    do range = 1, 10
      call check_equal(t, 'example of the standard: cycles of one range', &
                       count(abs(2*cycles%amplitude - range) < 1e-12_dp), merge(1, 0, any(range == [3, 4, 7, 9])))
    end do
    call check_close(t, 'example of the standard: mean of the largest', &
                     cycles(maxloc(cycles%amplitude, 1))%mean, 0.5_dp, 1e-14_dp)
  end subroutine standard_example

  subroutine flat_histories(t)
    type(tally_t), intent(inout) :: t
    type(cycle_t), allocatable :: cycles(:)

    call check_equal(t, 'a constant stress has no cycle', size(count_cycles([2.0_dp, 2.0_dp, 2.0_dp])), 0)
    call check_equal(t, 'a single value has no cycle', size(count_cycles([2.0_dp])), 0)
    cycles = count_cycles([0.0_dp, 0.5_dp, 1.0_dp, 1.0_dp, 0.2_dp, 0.0_dp, 0.0_dp])
    call check_equal(t, 'up and down is one cycle', size(cycles), 1)
    call check_close(t, 'its amplitude', cycles(1)%amplitude, 0.5_dp, 1e-15_dp)
    cycles = count_cycles([0.0_dp, 0.5_dp, 0.5_dp - 1e-14_dp, 0.5_dp, 1.0_dp, 0.2_dp])
    call check_equal(t, 'what rounding does to a rise is no cycle', size(cycles), 1)
  end subroutine flat_histories

  !> What defines the rainflow method: as many cycles span an interval of stress as the history crosses it upwards
  !> (Rychlik 1987).
  subroutine level_crossings_of_intervals(t)
    type(tally_t), intent(inout) :: t
    type(random_t) :: random
    type(cycle_t), allocatable :: cycles(:)
    real(dp), allocatable :: stress(:)
    real(dp) :: low, high
    integer :: i, k, n

    do i = 1, 300
      n = 2 + int(30*random%uniform())
      stress = [(random%between(-1.0_dp, 1.0_dp), k=1, n)]
      cycles = count_cycles(stress)
      call check_close(t, 'the largest cycle spans the history', 2*maxval(cycles%amplitude), maxval(stress) - minval(stress), &
                       1e-14_dp)
      do k = 1, 10
        low = random%between(-1.0_dp, 1.0_dp)
        high = random%between(low, 1.0_dp)
        call check_equal(t, 'cycles that span an interval', count(cycles%mean - cycles%amplitude < low .and. &
                         cycles%mean + cycles%amplitude > high), level_crossings(stress, low, high))
      end do
    end do
  end subroutine level_crossings_of_intervals

  !> How often a repeating history goes from below an interval to above it.
  pure integer function level_crossings(stress, low, high)
    real(dp), intent(in) :: stress(:), low, high
    logical :: is_below
    integer :: i

    level_crossings = 0
    is_below = .false.
    ! The second turn counts; in the first, it is found whether the history is below.
    do i = 1, 2*size(stress)
      associate (now => stress(1 + modulo(i - 1, size(stress))))
        if (now < low) is_below = .true.
        if (now > high .and. is_below) then
          is_below = .false.
          if (i > size(stress)) level_crossings = level_crossings + 1
        end if
      end associate
    end do
  end function level_crossings

  ! --- mean stress and curve -------------------------------------------------------

  !> Each rule's line meets the axis of mean stress at its strength; half way there Goodman leaves half of the amplitude, Gerber
  !> three quarters.
  subroutine mean_stress(t)
    type(tally_t), intent(inout) :: t
    type(cycle_t), parameter :: cycle = cycle_t(100*mega, 300*mega)
    real(dp), parameter :: limit = 600*mega

    call check_close(t, 'no rule', equivalent_amplitude(cycle, strength_t(mean_ignored, 0.0_dp)), 100*mega, 1e-15_dp)
    call check_close(t, 'Goodman', equivalent_amplitude(cycle, strength_t(by_goodman, limit)), 200*mega, 1e-14_dp)
    call check_close(t, 'Soderberg', equivalent_amplitude(cycle, strength_t(by_soderberg, limit)), 200*mega, 1e-14_dp)
    call check_close(t, 'Gerber', equivalent_amplitude(cycle, strength_t(by_gerber, limit)), 400*mega/3, 1e-14_dp)
    call check_close(t, 'compression does not count', &
                     equivalent_amplitude(cycle_t(100*mega, -300*mega), strength_t(by_goodman, limit)), 100*mega, 1e-15_dp)
    call check_true(t, 'a mean stress above the strength', &
                    equivalent_amplitude(cycle_t(mega, 600*mega), strength_t(by_gerber, limit)) < 0)
  end subroutine mean_stress

  subroutine curves(t)
    type(tally_t), intent(inout) :: t
    type(curve_t) :: curve
    integer :: i

    ! Basquin's line with the slope 5.
    curve%cycles = [1e4_dp, 1e9_dp]
    curve%stress = [500*mega, 50*mega]
    do i = 100, 400, 100
      call check_close(t, 'a straight line', damage_of(curve, i*mega), (i/500.0_dp)**5*1e-4_dp, 1e-12_dp)
    end do
    call check_close(t, 'above its first point the line goes on', damage_of(curve, 1000*mega), 32e-4_dp, 1e-12_dp)
    call check_close(t, 'no cycle costs more than the life', damage_of(curve, 1e6_dp*mega), 1.0_dp, 1e-15_dp)
    call check_close(t, 'below the last point no harm', damage_of(curve, 49.9_dp*mega), 0.0_dp, 0.0_dp)
    curve%is_endless = .false.
    call check_close(t, 'or the last line goes on', damage_of(curve, 25*mega), 1e-9_dp/32, 1e-12_dp)
    call check_close(t, 'no stress, no harm', damage_of(curve, 0.0_dp), 0.0_dp, 0.0_dp)
    ! Points of ASME BPV VIII-2, table 5-110.1.
    curve = of_three_points()
    call check_close(t, 'three points: at the one in the middle', damage_of(curve, 200*mega), 1e-6_dp, 1e-12_dp)
    call check_close(t, 'three points: at the last', damage_of(curve, 100.0000001_dp*mega), 1e-8_dp, 1e-6_dp)
    call check_close(t, 'three points: below the last', damage_of(curve, 99*mega), 0.0_dp, 0.0_dp)
  end subroutine curves

  !> A curve whose slope changes at its middle point.
  pure type(curve_t) function of_three_points() result(curve)
    curve%cycles = [1e3_dp, 1e6_dp, 1e8_dp]
    curve%stress = [800*mega, 200*mega, 100*mega]
  end function of_three_points

  !> Y_NT and Z_NT by hand: exponents log(factor)/log(cycles) of ISO 6336-3:2006, Table 1, and ISO 6336-2:2006, Table 2, whose
  !> static ends and knees textbooks print.
  subroutine life_factors(t)
    type(tally_t), intent(inout) :: t
    type(life_curve_t) :: root, contact
    type(curve_t) :: sn
    integer :: i

    i = findloc(gear_materials%name == 'case_hardened', .true., 1)
    root = root_life_curve(gear_materials(i), 0.85_dp)
    contact = contact_life_curve(gear_materials(i), 0.85_dp)
    call check_close(t, 'Y_NT up to 1000 cycles', life_factor(root, 10.0_dp), 2.5_dp, 1e-14_dp)
    call check_close(t, 'Y_NT at 1e5 cycles', life_factor(root, 1e5_dp), 2.5_dp*100**(-log(2.5_dp)/log(3e3_dp)), 1e-12_dp)
    call check_close(t, 'Y_NT: 1/8.74 is the slope that handbooks give', log(life_factor(root, 1e4_dp)/life_factor(root, 1e5_dp)) &
                     /log(10.0_dp), 1/8.74_dp, 1e-3_dp)
    call check_close(t, 'Y_NT at the knee', life_factor(root, 3e6_dp), 1.0_dp, 1e-14_dp)
    call check_close(t, 'Y_NT half-way to 1e10 on the paper', life_factor(root, sqrt(3e6_dp*1e10_dp)), sqrt(0.85_dp), 1e-12_dp)
    call check_close(t, 'Y_NT beyond', life_factor(root, 1e12_dp), 0.85_dp, 1e-14_dp)
    call check_close(t, 'Z_NT up to 1e5 cycles', life_factor(contact, 1e4_dp), 1.6_dp, 1e-14_dp)
    call check_close(t, 'Z_NT at the knee', life_factor(contact, 5e7_dp), 1.0_dp, 1e-14_dp)
    call check_close(t, 'Z_NT at 5e6', life_factor(contact, 5e6_dp), 1.6_dp**(log(10.0_dp)/log(500.0_dp)), 1e-12_dp)
    root = root_life_curve(gear_materials(i), 1.0_dp)
    call check_close(t, 'Y_NT with optimum conditions', life_factor(root, 1e9_dp), 1.0_dp, 1e-14_dp)
    sn = sn_curve(400*mega, root)
    call check_true(t, 'then the S-N curve ends at the knee', size(sn%cycles) == 2 .and. sn%is_endless)
    do i = 1, size(gear_materials)
      root = root_life_curve(gear_materials(i), 0.85_dp)
      contact = contact_life_curve(gear_materials(i), 0.85_dp)
      call check_true(t, 'through-hardened roots are static up to 1e4 cycles, others up to 1e3: '//gear_materials(i)%name, &
                      abs(root%cycles(1) - merge(1e4_dp, 1e3_dp, any(gear_materials(i)%name == [character(20) :: &
                      'carbon_steel', 'alloy_steel', 'nodular_cast_iron', 'malleable_cast_iron']))) < 1)
      call check_true(t, 'hardened and through-hardened roots bear 2.5 times, others 1.6: '//gear_materials(i)%name, &
                      abs(root%factor(1) - merge(1.6_dp, 2.5_dp, any(gear_materials(i)%name == [character(20) :: &
                      'normalized_steel', 'grey_cast_iron', 'nitriding_steel', 'nitrided_alloy_steel']))) < 1e-12_dp)
      call check_true(t, 'flanks of grey iron and nitrided ones bear 1.3 times, others 1.6: '//gear_materials(i)%name, &
                      abs(contact%factor(1) - merge(1.3_dp, 1.6_dp, any(gear_materials(i)%name == [character(20) :: &
                      'grey_cast_iron', 'nitriding_steel', 'nitrided_alloy_steel']))) < 1e-12_dp)
    end do
  end subroutine life_factors

  !> ISO 6336-3:2006, Annex B: sigma/Y_M with Y_M = 1/(1 - R (1 - M)/(1 + M)), M = 0.4, as the stress that rises from zero.
  subroutine iso_mean_stress(t)
    type(tally_t), intent(inout) :: t
    type(cycle_t) :: cycle
    real(dp) :: ratio, y_m
    integer :: i

    do i = -4, 2
      ratio = i/2.0_dp - 0.25_dp
      cycle = cycle_t(300*mega*(1 - ratio)/2, 300*mega*(1 + ratio)/2)
      y_m = 1/(1 - ratio*0.6_dp/1.4_dp)
      call check_close(t, 'equivalent stress from zero', 2*equivalent_amplitude(cycle, strength_t(by_iso, 1e3_dp*mega)), &
                       300*mega/y_m, 1e-12_dp)
    end do
    call check_close(t, 'an idler has the 0.7 of clause 5', equivalent_amplitude(cycle_t(70*mega, 0.0_dp), &
                     strength_t(by_iso, 1e3_dp*mega)), 50*mega, 1e-12_dp)
    call check_true(t, 'above the static strength', equivalent_amplitude(cycle_t(70*mega, 70*mega), &
                    strength_t(by_iso, 69*mega)) < 0)
  end subroutine iso_mean_stress

  !> S_H and S_F for a life are those of endurance times Z_NT and Y_NT at 60 n L_h cycles of the pinion, z1/z2 as many of the gear.
  subroutine safety_for_a_life(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: cycles(2) = 60*3000*8000.0_dp*[1.0_dp, 21/34.0_dp]
    type(table_t) :: rating
    real(dp) :: z, y
    integer :: i

    call solve_case(t, '&pinion teeth = 21 / &gear teeth = 34 / &mesh model = ''iso6336'' / &life rpm = 3000 duration_h = 1 / ', &
                    'rating', rating, ' material = ''case_hardened'' life_h = 8000')
    do i = 1, 2
      ! Both beyond their knees: 0.85 after log(1e10/knee).
      z = 0.85_dp**(log(cycles(i)/5e7_dp)/log(200.0_dp))
      y = 0.85_dp**(log(cycles(i)/3e6_dp)/log(1e10_dp/3e6_dp))
      call check_close(t, 'N_L', rating%number('load_cycles', i), cycles(i), 1e-12_dp)
      call check_close(t, 'Z_NT', rating%number('contact_life_factor', i), z, 1e-12_dp)
      call check_close(t, 'Y_NT', rating%number('root_life_factor', i), y, 1e-12_dp)
      call check_close(t, 'S_H', rating%number('contact_life_safety', i), &
                       z*1500/rating%number('contact_stress_mpa', i), 1e-12_dp)
      call check_close(t, 'S_F', rating%number('root_life_safety', i), y*850/rating%number('root_stress_mpa', i), 1e-12_dp)
    end do
    ! A nitrided gear has the knee of its own material, 2e6 for the flank.
    call solve_case(t, '&pinion teeth = 21 / &gear teeth = 34 / &mesh model = ''iso6336'' / &life rpm = 3000 duration_h = 1 / ', &
                    'rating', rating, ' material = ''case_hardened'', ''nitriding_steel'' life_h = 8000')
    z = 0.85_dp**(log(cycles(1)/5e7_dp)/log(200.0_dp))
    call check_close(t, 'Z_NT of the pinion', rating%number('contact_life_factor', 1), z, 1e-12_dp)
    z = 0.85_dp**(log(cycles(2)/2e6_dp)/log(5000.0_dp))
    call check_close(t, 'Z_NT of the gear', rating%number('contact_life_factor', 2), z, 1e-12_dp)
  end subroutine safety_for_a_life

  !> The material's curves by hand, under static loads high enough that both parts harm: root stresses are in proportion to the load
  !> and contact stresses to its root. And where a single load takes the life that `life` gives, S_F of `rating` for that life is 1.
  subroutine miner_by_hand(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: gears = '&pinion teeth = 21 / &gear teeth = 34 / &mesh model = ''iso6336'' '// &
      'corner_contact = .false. / '
    real(dp), parameter :: factor(2) = [5.0_dp, 6.0_dp], hours(2) = [90.0_dp, 10.0_dp]
    type(table_t) :: life, rating
    real(dp) :: root, contact, sums(2), turns
    character(30) :: hours_of_life
    integer :: i, k

    call solve_case(t, gears//'&life dynamic_load = .false. rpm = 3000, 3000 load_factor = 5, 6 duration_h = 90, 10 / ', 'life', &
                    life, ' material = ''case_hardened'' dynamic_factor_method = ''a''')
    call solve_case(t, gears//'&life rpm = 3000 duration_h = 1 / ', 'rating', rating, ' material = ''case_hardened''')
    do i = 1, 2
      sums = 0
      do k = 1, 2
        turns = 60*3000*hours(k)*merge(1.0_dp, 21/34.0_dp, i == 1)
        root = life%number('largest_root_stress_mpa', i)*factor(k)/6
        contact = life%number('largest_contact_stress_mpa', i)*sqrt(factor(k)/6)
        ! N of Y_NT or Z_NT = stress over strength, between static end and knee.
        sums(1) = sums(1) + turns/(1e3_dp*3e3_dp**(log(2.5_dp*850/root)/log(2.5_dp)))
        sums(2) = sums(2) + turns/(1e5_dp*500**(log(1.6_dp*1500/contact)/log(1.6_dp)))
        call check_true(t, 'between static end and knee', root > 850 .and. root < 2.5_dp*850 .and. contact > 1500 .and. &
                        contact < 2400)
      end do
      call check_close(t, 'Miner''s sum of the root', life%number('damage', i), sums(1), 1e-9_dp)
      call check_close(t, 'life of the root', life%number('life_h', i), 100/sums(1), 1e-9_dp)
      call check_close(t, 'Miner''s sum of the flank', life%number('contact_damage', i), sums(2), 1e-9_dp)
      call check_close(t, 'life of the flank', life%number('contact_life_h', i), 100/sums(2), 1e-9_dp)
      call check_close(t, 'the part that harms the flank most', life%number('worst_contact_part', i), &
                       merge(1.0_dp, 2.0_dp, 9 > 1.2_dp**(log(500.0_dp)/log(1.6_dp)/2)), 0.0_dp)
    end do
    call solve_case(t, gears//'&load normal_force_n = 24000 / &life dynamic_load = .false. rpm = 3000 duration_h = 1 / ', 'life', &
                    life, ' material = ''case_hardened''')
    write (hours_of_life, '(es24.16)') life%number('contact_life_h', 1)
    call solve_case(t, gears//'&load normal_force_n = 24000 / &life rpm = 3000 duration_h = 1 / ', 'rating', rating, &
                    ' material = ''case_hardened'' life_h = '//hours_of_life)
    call check_close(t, 'S_H is sqrt(1/K_v) for the life under the static load', rating%number('contact_life_safety', 1), &
                     1/sqrt(rating%number('internal_dynamic_factor', 1)), 1e-9_dp)
  end subroutine miner_by_hand

  !> Without material and curve there is no life; what belongs to a curve of one's own is refused beside that of the material.
  subroutine curves_refused(t)
    type(tally_t), intent(inout) :: t

    call refuse(' ', ' ', '&rating material: missing; must be one of ''normalized_steel''')
    call refuse(' material = ''C45''', ' tensile_strength_mpa = 900', '&life tensile_strength_mpa = 900: needs curve_cycles')
    call refuse(' material = ''C45''', ' endless = .false.', '&life endless = .false.: needs curve_cycles')
    call refuse(' material = ''C45''', ' mean_stress = ''gerber''', '&life mean_stress = ''gerber'': needs curve_cycles')
    call refuse(' long_life_factor = 0.9', ' ', '&rating long_life_factor = 0.9: needs a material')
    call refuse(' life_h = 100', ' ', '&rating life_h = 100: needs a material')
    call refuse(' material = ''C45'' long_life_factor = 0.8', ' ', '&rating long_life_factor = 0.8: must be at least 0.85')

  contains

    subroutine refuse(rating, life, message)
      character(*), intent(in) :: rating, life, message
      type(case_t) :: case
      type(error_t), allocatable :: error

      call read_case('&case tasks = ''life'', ''rating'' / &pair module_mm = 3 face_width_mm = 20 / &pinion teeth = 21 / '// &
                     '&gear teeth = 34 / &load normal_force_n = 4000 / &rating rpm = 3000'//rating// &
                     ' / &life rpm = 3000 duration_h = 1'//life//' /', case, error)
      call check_error(t, message, error, message)
    end subroutine refuse
  end subroutine curves_refused

  ! --- the task ---------------------------------------------------------------------

  !> Table of a case with gears without relief or corner contact, on a straight line of slope 5. It ends at 20 MPa, so that of an
  !> engagement only the cycle from zero to the largest stress counts.
  subroutine solve(t, keys, name, table)
    type(tally_t), intent(inout) :: t
    character(*), intent(in) :: keys, name
    type(table_t), intent(out) :: table

    call solve_case(t, '&pinion teeth = 21 / &gear teeth = 34 / &mesh model = ''iso6336'' corner_contact = .false. / '// &
                    '&life curve_cycles = 1e4, 9.765625e10 curve_stress_mpa = 500, 20 '//keys//' /', name, table)
  end subroutine solve

  !> The same with all these groups beside what all cases have.
  subroutine solve_case(t, groups, name, table, rating)
    type(tally_t), intent(inout) :: t
    character(*), intent(in) :: groups, name
    type(table_t), intent(out) :: table
    character(*), intent(in), optional :: rating     !< keys of the group
    type(study_t) :: study
    type(case_t) :: case
    type(error_t), allocatable :: error

    character(:), allocatable :: pair, load, damping, keys

    pair = ''
    if (index(groups, '&pair') == 0) pair = '&pair module_mm = 3 face_width_mm = 20 / '
    damping = ''
    if (index(groups, '&dynamics') == 0) damping = '&dynamics damping_ratio = 0.17 / '
    load = ''
    if (index(groups, '&load') == 0) load = '&load normal_force_n = 4000 / '
    keys = ''
    if (present(rating)) keys = rating
    call read_case('&case tasks = ''life'', ''rating'' / '//pair//damping//load//'&rating rpm = 3000'//keys//' / '//groups, case, &
                   error)
    call check_no_error(t, 'the case', error)
    call run_study(case, '', 1, study, error)
    call check_no_error(t, 'the study', error)
    call make_table(study, name, table, error)
    call check_no_error(t, 'the table', error)
  end subroutine solve_case

  !> The static load, whose root stress is in proportion: damage by the fifth power of the load, by the time, and by the teeth.
  subroutine spectra(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: still = 'dynamic_load = .false. mean_stress = ''none'' '
    type(table_t) :: life, parts, factors
    real(dp) :: amplitude
    integer :: i

    call solve(t, still//'rpm = 3000 duration_h = 10', 'life', life)
    call solve(t, still//'rpm = 3000 duration_h = 10', 'rating_factors', factors)
    do i = 1, 2
      ! One pair carries the whole load to the outer point of single contact, where ISO 6336-3 takes it.
      call check_close(t, 'largest root stress', life%number('largest_root_stress_mpa', i), &
                       factors%number('nominal_root_mpa', i), 1e-3_dp)
      amplitude = life%number('largest_root_stress_mpa', i)/2
      call check_close(t, 'life by Basquin''s line', life%number('life_h', i), &
                       1e4_dp*(500/amplitude)**5/(60*3000*merge(1.0_dp, 21/34.0_dp, i == 1)), 1e-9_dp)
      call check_close(t, 'passes', life%number('passes', i), life%number('life_h', i)/10, 1e-12_dp)
      call check_true(t, 'a life that ends', life%word('kind', i) == 'finite')
    end do
    call solve(t, still//'rpm = 3000, 3000, 6000 duration_h = 10, 5, 1 load_factor = 1, 2, 0.5', 'life_parts', parts)
    do i = 1, 2
      call check_close(t, 'twice the load, half the time', parts%number('damage', 2 + i), 16*parts%number('damage', i), 1e-9_dp)
      call check_close(t, 'half the load, twice the speed, a tenth of the time', parts%number('damage', 4 + i), &
                       0.2_dp/32*parts%number('damage', i), 1e-9_dp)
    end do
    call solve(t, still//'rpm = 3000, 3000, 6000 duration_h = 10, 5, 1 load_factor = 1, 2, 0.5', 'life', life)
    do i = 1, 2
      call check_close(t, 'Miner''s sum', life%number('damage', i), parts%number('damage', i)*(1 + 16 + 0.2_dp/32), 1e-9_dp)
      call check_close(t, 'the part that does most harm', life%number('worst_part', i), 2.0_dp, 0.0_dp)
    end do
  end subroutine spectra

  !> An idler's teeth see twice the amplitude without a mean; teeth loaded on one flank, half of the largest stress as a mean,
  !> which Goodman's rule counts.
  subroutine idlers(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: still = 'dynamic_load = .false. rpm = 3000 duration_h = 10 '
    type(table_t) :: one, both, goodman
    real(dp) :: half
    integer :: i

    call solve(t, still//'mean_stress = ''none''', 'life_parts', one)
    call solve(t, still//'mean_stress = ''none'' stress_ratio = -1', 'life_parts', both)
    call solve(t, still//'tensile_strength_mpa = 900', 'life_parts', goodman)
    do i = 1, 2
      call check_close(t, 'an idler''s damage', both%number('damage', i), 32*one%number('damage', i), 1e-9_dp)
      call check_close(t, 'an idler''s mean stress', both%number('mean_mpa', i), 0.0_dp, absolute=1e-9_dp)
      half = one%number('root_stress_mpa', i)/2
      call check_close(t, 'mean stress of one flank', one%number('mean_mpa', i), half, 1e-12_dp)
      call check_close(t, 'by Goodman''s rule', goodman%number('equivalent_amplitude_mpa', i), half/(1 - half/900), 1e-12_dp)
    end do
  end subroutine idlers

  !> The mean stress is half of the largest. Of two parts of which one brings it above the tensile strength, the spectrum is
  !> overloaded and has no life; the other part by itself has one.
  subroutine overloaded(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: still = 'dynamic_load = .false. tensile_strength_mpa = 900 rpm = 3000'
    type(table_t) :: one, two
    character(8) :: factor
    integer :: i

    call solve(t, still//' duration_h = 10', 'life', one)
    ! With it the pinion's mean stress is three times the strength; the gear's is not far from that.
    write (factor, '(f8.3)') 2*3*900/one%number('largest_root_stress_mpa', 1)
    call solve(t, still//', 3000 duration_h = 10, 1 load_factor = 1, '//factor, 'life', two)
    do i = 1, 2
      call check_true(t, 'the lesser load by itself', one%word('kind', i) == 'finite' .and. one%number('life_h', i) > 0)
      call check_true(t, 'one part of two above the strength', two%word('kind', i) == 'overloaded')
      call check_true(t, 'and no life', ieee_is_nan(two%number('life_h', i)) .and. ieee_is_nan(two%number('passes', i)))
    end do
  end subroutine overloaded

  !> A motion that repeats after two mesh periods, both alike, does what one of one mesh period does.
  subroutine equal_engagements(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: s(*) = [0.0_dp, 0.4_dp, 0.8_dp, 1.2_dp, 1.6_dp], load(*) = [500.0_dp, 4000.0_dp, 2500.0_dp, &
                                                                                      4500.0_dp, 300.0_dp]
    type(pair_t) :: pair
    type(root_life_t) :: one, two
    integer :: i, k

    call make_stated_pair(t, pair)
    do i = 1, 2
      associate (stress => root_history(pair, i, s, load, 0.0_dp), strength => strength_t(by_goodman, 900*mega))
        one = root_life([(1, k=1, 5)], stress, 0.0_dp, strength, of_three_points())
        two = root_life([(1, k=1, 5), (2, k=1, 5)], [stress, stress], 0.0_dp, strength, of_three_points())
      end associate
      call check_true(t, 'an engagement does harm', one%damage > 0 .and. one%cycles > 1)
      call check_close(t, 'damage of two alike', two%damage, one%damage, 1e-14_dp)
      call check_close(t, 'cycles of two alike', two%cycles, one%cycles, 1e-14_dp)
      call check_close(t, 'largest stress of two alike', two%largest, one%largest, 1e-14_dp)
    end do
  end subroutine equal_engagements

  !> A rim half as thick as the teeth are high, 2.25 modules, raises the stress as ISO 6336-3, clause 9, has it: 1.6 ln(2.242*2).
  subroutine thin_rims(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: s(*) = [0.0_dp, 0.7_dp, 1.5_dp], load(*) = [500.0_dp, 4000.0_dp, 300.0_dp], height = 2.25_dp*0.003_dp
    type(pair_t) :: pair
    integer :: i

    call make_stated_pair(t, pair)
    do i = 1, 2
      call check_close(t, 'a thin rim', maxval(root_history(pair, i, s, load, height/2))/ &
                       maxval(root_history(pair, i, s, load, 0.0_dp)), 1.6_dp*log(4.484_dp), 1e-12_dp)
    end do
  end subroutine thin_rims

  !> Life of helical teeth. In motion, the stresses of a part are those of the task `rating` with K_v of Method A. Under the static
  !> load, root stresses are in proportion to the load, contact stresses to its square root. An engagement is one load cycle from
  !> zero; its damage follows from the S-N curve by hand. On an idler the stress counts 1/0.7 times (ISO 6336-3:2006, clause 5).
  subroutine helical_teeth(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: gears = '&pair module_mm = 3 face_width_mm = 20 helix_angle_deg = 18 / &pinion teeth = 21 / '// &
      '&gear teeth = 34 / ', &
      material = ' material = ''case_hardened'' dynamic_factor_method = ''a'''
    real(dp), parameter :: factor(2) = [1.0_dp, 6.0_dp]
    type(table_t) :: parts, rating, factors, idler, motion
    real(dp) :: turns, harm
    integer :: i, k, row

    call solve_case(t, gears//'&life rpm = 3000 duration_h = 1 / ', 'life_parts', parts, material)
    call solve_case(t, gears//'&life rpm = 3000 duration_h = 1 / ', 'rating', rating, material)
    call solve_case(t, gears//'&life rpm = 3000 duration_h = 1 / ', 'rating_factors', factors, material)
    do i = 1, 2
      call check_true(t, 'above rest', rating%number('internal_dynamic_factor', i) > 1)
      call check_close(t, 'root stress of the rating', parts%number('root_stress_mpa', i), &
                       rating%number('root_stress_mpa', i), 1e-12_dp)
      call check_close(t, 'contact stress of the rating', parts%number('contact_stress_mpa', i), &
                       rating%number('contact_stress_mpa', i), 1e-12_dp)
    end do
    ! A part of the spectrum has the same motion as a case whose load is that of the part.
    call solve_case(t, gears//'&life rpm = 3000 load_factor = 1.5 duration_h = 1 / ', 'life_parts', parts, material)
    call solve_case(t, gears//'&load normal_force_n = 6000 / &life rpm = 3000 duration_h = 1 / ', 'dynamic_factors', motion, &
                    material)
    call check_close(t, 'motion under the load of a part', parts%number('dynamic_factor', 1), motion%number('dynamic_factor', 1), &
                     1e-9_dp)
    call solve_case(t, gears//'&life dynamic_load = .false. rpm = 3000, 3000 load_factor = 1, 6 duration_h = 1, 1 / ', &
                    'life_parts', parts, material)
    call solve_case(t, gears//'&life dynamic_load = .false. rpm = 3000 load_factor = 6 duration_h = 1 stress_ratio = -1 / ', &
                    'life_parts', idler, material)
    do k = 1, 2
      do i = 1, 2
        row = 2*(k - 1) + i
        turns = 60*3000*merge(1.0_dp, 21/34.0_dp, i == 1)
        associate (root => factor(k)*factors%number('nominal_root_mpa', i))
          call check_close(t, 'root stress at rest', parts%number('root_stress_mpa', row), root, 1e-12_dp)
          call check_close(t, 'amplitude', parts%number('amplitude_mpa', row), root/2, 1e-12_dp)
          call check_close(t, 'one load cycle', parts%number('cycles', row), 1.0_dp, 0.0_dp)
          call check_close(t, 'contact stress at rest', parts%number('contact_stress_mpa', row), &
                           sqrt(factor(k))*parts%number('contact_stress_mpa', i), 1e-12_dp)
          harm = 0
          if (root > 850) harm = turns/(1e3_dp*3e3_dp**(log(2.5_dp*850/root)/log(2.5_dp)))
          call check_true(t, 'only the larger load does harm', (root > 850) .eqv. k == 2)
          call check_close(t, 'Miner''s sum of the root', parts%number('damage', row), harm, 1e-9_dp)
          if (k == 2) call check_close(t, 'equivalent amplitude on an idler', idler%number('equivalent_amplitude_mpa', i), &
                                       root/1.4_dp, 1e-12_dp)
        end associate
      end do
    end do
    ! Faces that meet unevenly: K_H_beta of the rating for the flanks, its K_F_beta for the roots.
    call solve_case(t, gears//'&face misalignment_um = 20 / &life dynamic_load = .false. rpm = 3000 duration_h = 1 / ', &
                    'life_parts', idler, material)
    call solve_case(t, gears//'&face misalignment_um = 20 / &life rpm = 3000 duration_h = 1 / ', 'rating_factors', rating, material)
    do i = 1, 2
      call check_true(t, 'an uneven load', rating%number('root_face_load_factor', i) > 1.1_dp)
      call check_close(t, 'K_F_beta', idler%number('root_stress_mpa', i)/parts%number('root_stress_mpa', i), &
                       rating%number('root_face_load_factor', i), 1e-12_dp)
      call check_close(t, 'K_H_beta', (idler%number('contact_stress_mpa', i)/parts%number('contact_stress_mpa', i))**2, &
                       rating%number('face_load_factor', i), 1e-12_dp)
    end do
  end subroutine helical_teeth

  !> Without relief and backlash the motion is in proportion to the load, and so is the stress.
  subroutine loads_of_motions(t)
    type(tally_t), intent(inout) :: t
    type(table_t) :: parts
    integer :: i

    call solve(t, 'rpm = 3000, 3000, 3000 duration_h = 1, 1, 1 load_factor = 1, 2, 0.5 mean_stress = ''none''', &
               'life_parts', parts)
    do i = 1, 2
      call check_close(t, 'twice the load, the same dynamic factor', parts%number('dynamic_factor', 2 + i), &
                       parts%number('dynamic_factor', i), 2e-6_dp)
      call check_close(t, 'twice the load, twice the stress', parts%number('root_stress_mpa', 2 + i), &
                       2*parts%number('root_stress_mpa', i), 2e-6_dp)
      call check_close(t, 'half the load, half the stress', parts%number('root_stress_mpa', 4 + i), &
                       parts%number('root_stress_mpa', i)/2, 2e-6_dp)
      call check_true(t, 'the motion loads the teeth more than the static load does', parts%number('dynamic_factor', i) > 1.01_dp)
    end do
  end subroutine loads_of_motions

  !> Between pairs of constant stiffness the motion swings several times within an engagement, and each swing is a cycle. It is
  !> followed here by Runge-Kutta from rest until it repeats; with a curve of the slope 1 the damage is in proportion to the sum
  !> of all amplitudes, small ones too.
  subroutine histories_of_motions(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: masses = 'effective_mass_kg = 0.5 / '
    type(pair_t) :: pair
    type(table_t) :: parts
    type(cycle_t), allocatable :: cycles(:)
    real(dp), allocatable :: stress(:)
    integer :: i

    call solve_case(t, '&pinion teeth = 21 '//masses//'&gear teeth = 34 '//masses//'&dynamics damping_ratio = 0.05 / '// &
                    '&mesh model = ''polynomial'' coefficients = 300 / &life mean_stress = ''none'' rpm = 3000 duration_h = 1 '// &
                    'curve_cycles = 1e4, 5e9 curve_stress_mpa = 500, 1e-3 /', 'life_parts', parts)
    call make_stated_pair(t, pair)
    do i = 1, 2
      call swinging_stress(pair, i, 4000.0_dp, 3e8_dp, 0.5_dp, 0.05_dp, 60/(21*3000.0_dp), stress)
      cycles = count_cycles([stress, 0.0_dp])
      call check_true(t, 'a history with swings', count(cycles%amplitude > 0.02_dp*maxval(stress)) > 3)
      call check_close(t, 'largest stress of the history', parts%number('root_stress_mpa', i), maxval(stress)/mega, 2e-3_dp)
      call check_close(t, 'sum of the amplitudes', parts%number('damage', i)/parts%number('engagements', i), &
                       sum(cycles%amplitude)/(5e6_dp*mega), 5e-3_dp)
    end do
  end subroutine histories_of_motions

  !> The pair of the cases above.
  subroutine make_stated_pair(t, pair)
    type(tally_t), intent(inout) :: t
    type(pair_t), intent(out) :: pair
    type(gear_t) :: gear(2)
    type(error_t), allocatable :: error
    integer, parameter :: teeth(2) = [21, 34]
    character(6), parameter :: gear_names(2) = [character(6) :: 'pinion', 'gear']
    integer :: i

    do i = 1, 2
      call make_gear(gear_spec_t(trim(gear_names(i)), teeth(i), 0.003_dp, face_width=0.02_dp), gear(i), error)
      call check_no_error(t, 'gear', error)
    end do
    call make_pair(gear(1), gear(2), 0.0825_dp, pair, error)
    call check_no_error(t, 'pair', error)
  end subroutine make_stated_pair

  !> Root stress (Pa) of one engagement under the motion m/2 (x" + 2 zeta w x' + w^2 x) = F, w^2 = n k 2/m, with n pairs of
  !> stiffness k in contact, once it repeats; each carries k x.
  subroutine swinging_stress(pair, gear, load, stiffness, mass, damping, period, stress)
    type(pair_t), intent(in) :: pair
    integer, intent(in) :: gear
    real(dp), intent(in) :: load, stiffness, mass, damping, period
    real(dp), allocatable, intent(out) :: stress(:)
    integer, parameter :: steps = 2000, turns = 200
    real(dp) :: x(2), slope(2, 4), h, deflection(0:2*steps), s, radius
    integer :: i, n, turn, pairs

    x = [load/(2*stiffness), 0.0_dp]
    do turn = 1, turns
      do i = 0, 2*steps - 1
        ! Two pairs while the one ahead has not left, and one from there to the period's end; so no step meets the change.
        if (i < steps) then
          h = (pair%contact_ratio - 1)*period/steps
          pairs = 2
        else
          h = (2 - pair%contact_ratio)*period/steps
          pairs = 1
        end if
        deflection(i) = x(1)
        slope(:, 1) = rate(x)
        slope(:, 2) = rate(x + h/2*slope(:, 1))
        slope(:, 3) = rate(x + h/2*slope(:, 2))
        slope(:, 4) = rate(x + h*slope(:, 3))
        x = x + h/6*(slope(:, 1) + 2*slope(:, 2) + 2*slope(:, 3) + slope(:, 4))
      end do
      deflection(2*steps) = x(1)
    end do
    ! A pair goes through two pairs, one, and two again.
    allocate (stress(3*steps))
    do i = 1, 3*steps
      n = modulo(i - 1, steps)
      if (i <= steps) s = (pair%contact_ratio - 1)*n/steps
      if (i > steps) s = pair%contact_ratio - 1 + (2 - pair%contact_ratio)*n/steps
      if (i > 2*steps) s = 1 + (pair%contact_ratio - 1)*n/steps
      radius = min(pair%gear(gear)%tip_radius, pair%radius(gear, s))
      stress(i) = nominal_root_stress(pair, gear, iso_form(pair%gear(gear), radius), &
                                      stiffness*deflection(modulo(i - 1, 2*steps)))
    end do

  contains

    pure function rate(now)
      real(dp), intent(in) :: now(2)
      real(dp) :: rate(2), w

      w = sqrt(2*pairs*stiffness/mass)
      rate = [now(2), 2*load/mass - 2*damping*w*now(2) - w**2*now(1)]
    end function rate
  end subroutine swinging_stress
end module test_life
