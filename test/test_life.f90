!> Fatigue: rainflow cycles, mean stress, S-N curves and Miner's sum, and the task `life`, against the standard's example, what
!> defines the rainflow method, textbook formulas, and spectra whose damage follows from the curve alone.
module test_life
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use gearsweep_case, only: case_t
  use gearsweep_case_reader, only: read_case
  use gearsweep_error, only: error_t
  use gearsweep_fatigue, only: by_gerber, by_goodman, by_soderberg, count_cycles, curve_t, cycle_t, damage_of, &
    equivalent_amplitude, mean_ignored, strength_t, structural_steel
  use gearsweep_form, only: iso_form, nominal_root_stress
  use gearsweep_gear, only: gear_spec_t, gear_t, make_gear
  use gearsweep_kinds, only: dp
  use gearsweep_pair, only: make_pair, pair_t
  use gearsweep_root_life, only: root_life, root_life_t
  use gearsweep_study, only: run_study, study_t
  use gearsweep_table, only: table_t
  use gearsweep_tables, only: make_table
  use random_numbers, only: random_t
  use testing, only: check_close, check_equal, check_no_error, check_true, tally_t
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
    if (t%wants('spectra')) call spectra(t)
    if (t%wants('idlers')) call idlers(t)
    if (t%wants('overloaded')) call overloaded(t)
    if (t%wants('equal_engagements')) call equal_engagements(t)
    if (t%wants('thin_rims')) call thin_rims(t)
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
    curve = structural_steel()
    call check_close(t, 'structural steel at 214 MPa', damage_of(curve, 214*mega), 1/20000.0_dp, 1e-12_dp)
    call check_close(t, 'structural steel at 86.2 MPa', damage_of(curve, 86.2000001_dp*mega), 1e-6_dp, 1e-6_dp)
    call check_close(t, 'structural steel at 86 MPa', damage_of(curve, 86*mega), 0.0_dp, 0.0_dp)
  end subroutine curves

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
  subroutine solve_case(t, groups, name, table)
    type(tally_t), intent(inout) :: t
    character(*), intent(in) :: groups, name
    type(table_t), intent(out) :: table
    type(study_t) :: study
    type(case_t) :: case
    type(error_t), allocatable :: error

    call read_case('&case tasks = ''life'', ''rating'' / &pair module_mm = 3 face_width_mm = 20 / '// &
                   '&load normal_force_n = 4000 / &rating rpm = 3000 / '//groups, case, error)
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
      one = root_life(pair, i, [(1, k=1, 5)], s, load, 0.0_dp, 0.0_dp, strength_t(by_goodman, 900*mega), structural_steel())
      two = root_life(pair, i, [(1, k=1, 5), (2, k=1, 5)], [s, s], [load, load], 0.0_dp, 0.0_dp, &
                      strength_t(by_goodman, 900*mega), structural_steel())
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
    type(root_life_t) :: solid, thin
    integer :: i

    call make_stated_pair(t, pair)
    do i = 1, 2
      solid = root_life(pair, i, [1, 1, 1], s, load, 0.0_dp, 0.0_dp, strength_t(by_goodman, 900*mega), structural_steel())
      thin = root_life(pair, i, [1, 1, 1], s, load, height/2, 0.0_dp, strength_t(by_goodman, 900*mega), structural_steel())
      call check_close(t, 'a thin rim', thin%largest/solid%largest, 1.6_dp*log(4.484_dp), 1e-12_dp)
    end do
  end subroutine thin_rims

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
    character(6), parameter :: members(2) = [character(6) :: 'pinion', 'gear']
    integer :: i

    do i = 1, 2
      call make_gear(gear_spec_t(trim(members(i)), teeth(i), 0.003_dp, face_width=0.02_dp), gear(i), error)
      call check_no_error(t, 'gear', error)
    end do
    call make_pair(gear(1), gear(2), 0.0825_dp, pair, error)
    call check_no_error(t, 'pair', error)
  end subroutine make_stated_pair

  !> Root stress (Pa) of one engagement under the motion m/2 (x" + 2 zeta w x' + w^2 x) = F, w^2 = n k 2/m, with n pairs of
  !> stiffness k in contact, once it repeats; each carries k x.
  subroutine swinging_stress(pair, member, load, stiffness, mass, damping, period, stress)
    type(pair_t), intent(in) :: pair
    integer, intent(in) :: member
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
      radius = min(pair%gear(member)%tip_radius, pair%radius(member, s))
      stress(i) = nominal_root_stress(pair, member, iso_form(pair%gear(member), radius), &
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
