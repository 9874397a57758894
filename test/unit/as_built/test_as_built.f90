!> Motions of gears whose teeth have errors of their own: against six motions of a solver written apart
!> (test/reference/as_built.dat), and identities.
module test_as_built
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use gearsweep_study_case_case, only: case_t
  use gearsweep_api_case_reader, only: read_case
  use gearsweep_mesh_deviations, only: deviations_t, make_deviations, wave_t
  use gearsweep_base_error, only: error_t
  use gearsweep_motion_error_estimate, only: accuracy_t, levels_t
  use gearsweep_mesh_flank_deviations, only: draw_deviations, flank_deviations_t, frame_t, is_within, place_deviations
  use gearsweep_rating_form, only: iso_form, nominal_root_stress
  use gearsweep_gear_gear, only: gear_t, make_gear
  use gearsweep_mesh_harmonics, only: find_harmonics, find_orders, harmonics_t, static_range
  use gearsweep_gear_pair, only: free_centre_distance, make_pair, pair_t
  use gearsweep_base_kinds, only: dp, pi
  use gearsweep_motion_oscillator, only: make_oscillator, oscillator_t
  use gearsweep_base_piecewise, only: piecewise_t, polynomial
  use gearsweep_base_random_stream, only: begin_stream, random_stream_t
  use gearsweep_motion_spectrum, only: find_spectrum, spectrum_t
  use gearsweep_motion_steady_motion, only: has_result, status_name
  use gearsweep_study_results_report, only: failed_points, write_report
  use gearsweep_study_run_study, only: run_study
  use gearsweep_base_text, only: str
  use gearsweep_base, only: sorted
  use gearsweep_gear_measures, only: find_tolerances, tolerances_t
  use gearsweep_motion_response, only: find_turn, turn_t
  use test_support_ask_by_name, only: answer_t, ask, refusal
  use test_support_reference_rows, only: next_row
  use test_support_testing, only: check_close, check_equal, check_error, check_no_error, check_true, new_folder, &
    remove_folder, tally_t
  implicit none
  private
  public :: run, given_t, read_given, springs

  real(dp), parameter :: um = 1e-6_dp
  !> Gears without profile shift, whose flanks are measured; lengths in mm, from Euclid: reference, base and tip circles, and the
  !> pinion's rolls at A, E and the pitch point, which is on both measuring circles.
  integer, parameter :: teeth(2) = [18, 36]
  real(dp), parameter :: angle = pi/9, radius(2) = 1.5_dp*teeth, between = sum(radius), base(2) = radius*cos(angle), &
                         roll_a = between*sin(angle) - sqrt((radius(2) + 3)**2 - base(2)**2), &
                         roll_e = sqrt((radius(1) + 3)**2 - base(1)**2), &
                         pitch_point = (radius(1)*sin(angle) - roll_a)/(roll_e - roll_a)
  character(6), parameter :: gears(2) = [character(6) :: 'pinion', 'gear']
  !> Pairs of constant stiffness under a load.
  character(*), parameter :: springs = '&case tasks = ''as_built'' / &load normal_force_n = 7000 / &mesh model = '// &
    '''polynomial'', contact_ratio = 1.6, coefficients = 400 / '

  type :: given_t
    character(8) :: name = ''
    type(oscillator_t) :: osc
    real(dp) :: rpm = 0
    integer :: periods = 0, tooth(2) = 0, changes = 0
    real(dp) :: dynamic_factor = 0, least = 0, largest = 0, modulus = 0, state(2) = 0, dynamic(10) = 0, static(10) = 0, range = 0
  end type given_t

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t
    type(given_t), allocatable :: given(:)

    call read_given(given)
    if (t%wants('given_motions')) call given_motions(t, given)
    if (t%wants('estimated')) call estimated(t, given)
    if (t%wants('by_keys')) call by_keys(t, given)
    if (t%wants('with_friction')) call with_friction(t)
    if (t%wants('moved')) call moved(t, given)
    if (t%wants('scaled')) call scaled(t, given)
    if (t%wants('alike')) call alike(t)
    if (t%wants('marched')) call marched(t)
    if (t%wants('patterns')) call patterns(t)
    if (t%wants('excited')) call excited(t)
    if (t%wants('stressed')) call stressed(t)
    if (t%wants('repelling')) call repelling(t, given)
    if (t%wants('classes')) call classes(t)
    if (t%wants('drawn')) call drawn(t)
    if (t%wants('inspected')) call inspected(t)
    if (t%wants('inspected_again')) call inspected_again(t)
    if (t%wants('followed')) call followed(t)
    if (t%wants('each_turn')) call each_turn(t)
    if (t%wants('told_again')) call told_again(t)
    if (t%wants('unanswered')) call unanswered(t)
    if (t%wants('not_counted')) call not_counted(t)
    if (t%wants('measuring_point')) call measuring_point(t)
    if (t%wants('unknown_sample')) call unknown_sample(t)
    if (t%wants('refused')) call refused(t)
    if (t%wants('measured_flanks')) call measured_flanks(t)
    if (t%wants('changed_file')) call changed_file(t)
    if (t%wants('wrong_files')) call wrong_files(t)
    if (t%wants('stress_of_each_relief')) call stress_of_each_relief(t)
    if (t%wants('off_the_path')) call off_the_path(t)
  end subroutine run

  subroutine read_given(given)
    type(given_t), allocatable, intent(out) :: given(:)
    character(1000) :: line
    type(given_t) :: one
    type(wave_t), allocatable :: waves(:)
    real(dp), allocatable :: k(:), pinion(:, :), gear(:, :)
    real(dp) :: ratio, relief(2), start(2)
    integer :: unit, n, i

    allocate (given(0))
    open (newunit=unit, file='test/reference/as_built.dat', status='old', action='read')
    do while (next_row(unit, line))
      one = given_t()
      one%name = line(:8)
      associate (osc => one%osc, mesh => one%osc%mesh)
        read (unit, *) mesh%teeth, one%rpm, ratio, osc%load, osc%damping_ratio, osc%mass
        read (unit, '(a)') line
        read (line, *) n
        allocate (k(n))
        read (line, *) n, k
        read (unit, *) relief, start
        read (unit, *) n
        allocate (waves(n), pinion(0:2, mesh%teeth(1)), gear(0:2, mesh%teeth(2)))
        do i = 1, n
          read (unit, *) waves(i)%gear, waves(i)%order, waves(i)%amplitude, waves(i)%phase
          waves(i)%amplitude = um*waves(i)%amplitude
        end do
        read (unit, *) pinion, gear
        mesh%contact_ratio = ratio
        mesh%reach = [0.0_dp, ratio]
        mesh%stiffness = polynomial(0.0_dp, ratio, 1e6_dp*k)
        mesh%profile_error = tip_relief(ratio, um*relief, start)
        mesh%deviations = make_deviations(mesh%teeth, um*pinion, um*gear, waves, 0)
        deallocate (k, waves, pinion, gear)
      end associate
      read (unit, *) one%periods, one%dynamic_factor, one%tooth, one%least, one%largest, one%modulus, one%changes, one%state
      read (unit, *) one%dynamic
      read (unit, *) one%static
      read (unit, *) one%range
      given = [given, one]
    end do
    close (unit)
  end subroutine read_given

  !> Linear relief at the tips of pinion and gear.
  type(piecewise_t) function tip_relief(ratio, amount, start) result(error)
    real(dp), intent(in) :: ratio, amount(2), start(2)
    real(dp) :: breaks(4)

    ! Where the reliefs overlap, both count; here they do not.
    breaks = [0.0_dp, min(start(2), ratio/2), max(start(1), ratio/2), ratio]
    allocate (error%breaks, source=breaks)
    allocate (error%coef(0:1, 3), source=0.0_dp)
    error%coef(:, 1) = amount(2)/2*[1, -1]
    error%coef(:, 3) = amount(1)/2*[1, 1]
  end function tip_relief

  subroutine given_motions(t, given)
    type(tally_t), intent(inout) :: t
    type(given_t), intent(in) :: given(:)
    type(error_t), allocatable :: error
    type(accuracy_t) :: options
    type(levels_t), allocatable :: levels
    type(oscillator_t) :: osc
    type(turn_t) :: turn
    type(spectrum_t) :: dynamic
    type(harmonics_t) :: static
    integer :: i

    options%steady%tolerance = 1e-11_dp
    do i = 1, size(given)
      associate (one => given(i))
        osc = one%osc
        call make_oscillator(osc, error)
        call check_true(t, 'accepted', .not. allocated(error), one%name)
        if (allocated(error)) cycle
        call check_true(t, 'periods of the turn', osc%mesh%deviations%periods == one%periods, one%name)
        if (allocated(levels)) deallocate (levels)
        allocate (levels)
        call find_turn(osc, one%rpm, options, levels, turn)
        call check_close(t, 'dynamic factor', turn%point%dynamic_factor, one%dynamic_factor, absolute=1e-9_dp)
        if (.not. allocated(turn%load)) cycle
        call check_close(t, 'largest load of a pair', maxval(turn%load)/osc%load, one%dynamic_factor, absolute=1e-9_dp)
        call check_true(t, 'where the largest load is', &
                        all(modulo(maxloc(turn%load, 1) - 1, osc%mesh%teeth) == one%tooth), one%name)
        call find_spectrum(turn%left, turn%width, turn%error, 0, dynamic)
        call check_close(t, 'least transmission error', dynamic%least, um*one%least, absolute=1e-9_dp*um)
        call check_close(t, 'largest transmission error', dynamic%largest, um*one%largest, absolute=1e-9_dp*um)
        call check_close(t, 'state', turn%point%steady%state(1), um*one%state(1), absolute=1e-9_dp*um)
        call check_close(t, 'derivative', turn%point%steady%state(2), um*one%state(2), absolute=1e-8_dp*um)
        call check_orders(t, one, osc, turn)
        call find_harmonics(osc%mesh, osc%load, 0, static)
        ! Where pairs part at rest the given ranges come short of values that the curve takes, by less than 1e-6 um.
        call check_true(t, 'static range', static%largest - static%least > um*(one%range - 1e-9_dp) .and. &
                        static%largest - static%least < um*(one%range + merge(2e-6_dp, 1e-9_dp, one%changes > 0)), one%name)
      end associate
    end do
  end subroutine given_motions

  !> The estimates of the errors hold, at tolerances that are used: against the given dynamic factors.
  subroutine estimated(t, given)
    type(tally_t), intent(inout) :: t
    type(given_t), intent(in) :: given(:)
    real(dp), parameter :: tolerance(3) = [1e-3_dp, 1e-6_dp, 1e-9_dp]
    type(error_t), allocatable :: error
    type(accuracy_t) :: options
    type(levels_t), allocatable :: levels
    type(oscillator_t) :: osc
    type(turn_t) :: turn
    integer :: i, k

    do i = 1, size(given)
      osc = given(i)%osc
      call make_oscillator(osc, error)
      do k = 1, size(tolerance)
        options%steady%tolerance = tolerance(k)
        if (allocated(levels)) deallocate (levels)
        allocate (levels)
        call find_turn(osc, given(i)%rpm, options, levels, turn)
        associate (off => abs(turn%point%dynamic_factor - given(i)%dynamic_factor))
          call check_true(t, 'error within twice its estimate', off < 2*turn%point%estimate + 1e-11_dp, &
                          given(i)%name//str(off)//', estimated '//str(turn%point%estimate))
          call check_true(t, 'error within the tolerance', off < tolerance(k), given(i)%name//str(off))
        end associate
        associate (off => abs(turn%point%steady%dte_range - um*(given(i)%largest - given(i)%least)))
          call check_true(t, 'peak-to-peak within twice its estimate', off < 2*turn%point%dte_estimate + 1e-9_dp*um, &
                          given(i)%name//str(off/um)//', estimated '//str(turn%point%dte_estimate/um))
        end associate
      end do
    end do
  end subroutine estimated

  !> The order of so many cycles over so many mesh periods, m.
  complex(dp) function amplitude_of(turn, cycles, periods) result(amplitude)
    type(turn_t), intent(in) :: turn
    integer, intent(in) :: cycles, periods
    type(spectrum_t) :: spectrum

    call find_spectrum(turn%left, turn%width, turn%error, cycles, spectrum, base=1.0_dp/periods)
    amplitude = spectrum%amplitude(cycles)*exp(cmplx(0.0_dp, spectrum%phase(cycles), dp))
  end function amplitude_of

  !> The largest transmission error in motion, m.
  real(dp) function largest_of(turn) result(largest)
    type(turn_t), intent(in) :: turn
    type(spectrum_t) :: spectrum

    call find_spectrum(turn%left, turn%width, turn%error, 0, spectrum)
    largest = spectrum%largest
  end function largest_of

  !> Orders in motion and at rest: mean, first and sidebands of both gears, of the mesh, and of the whole period.
  subroutine check_orders(t, given, osc, turn)
    type(tally_t), intent(inout) :: t
    type(given_t), intent(in) :: given
    type(oscillator_t), intent(in) :: osc
    type(turn_t), intent(in) :: turn
    type(spectrum_t) :: moving
    type(harmonics_t) :: resting(1)
    integer :: cycles(10), k

    associate (n => given%periods)
      cycles = [0, n/osc%mesh%teeth(1), n/osc%mesh%teeth(2), n, 2*n, 0, 0, 0, 0, 1]
      cycles(6:9) = n + [-1, 1, -1, 1]*cycles([2, 2, 3, 3])
      call find_spectrum(turn%left, turn%width, turn%error, maxval(cycles), moving, base=1.0_dp/n)
      call find_orders(osc%mesh, osc%load, [maxval(cycles)], [1.0_dp/n], resting)
    end associate
    call check_close(t, given%name//'dynamic mean', moving%mean, um*given%dynamic(1), absolute=1e-9_dp*um)
    call check_close(t, given%name//'static mean', resting(1)%mean, um*given%static(1), absolute=1e-9_dp*um)
    do k = 2, 10
      call check_close(t, given%name//'dynamic order '//str(k), moving%amplitude(cycles(k)), um*given%dynamic(k), &
                       absolute=1e-9_dp*um)
      call check_close(t, given%name//'static order '//str(k), resting(1)%amplitude(cycles(k)), um*given%static(k), &
                       absolute=1e-9_dp*um)
    end do
  end subroutine check_orders

  !> The same motions by the keys of a case: numbers of teeth against the direction of engagement and with it, from other first
  !> teeth.
  subroutine by_keys(t, given)
    type(tally_t), intent(inout) :: t
    type(given_t), intent(in) :: given(:)
    type(answer_t) :: answer
    character(:), allocatable :: text
    real(dp), allocatable :: load(:), place(:)
    integer :: i, k, worst(2)

    do i = 1, size(given)
      associate (one => given(i), teeth => given(i)%osc%mesh%teeth)
        do k = 1, 2
          call write_case(one, k == 1, [3, 7]*(k - 1) + 1, text)
          call ask(t, text, answer)
          call check_close(t, one%name//'dynamic factor', answer%one('as_built.dynamic_factor'), one%dynamic_factor, &
                           absolute=1e-9_dp)
          worst = 1 + modulo([3, 7]*(k - 1) + merge(1, -1, k == 1)*one%tooth, teeth)
          call check_close(t, one%name//'pinion '// &
            'tooth', answer%one('as_built_worst.pinion_tooth'), real(worst(1), dp), absolute=0.1_dp)
          call check_close(t, one%name//'gear tooth', answer%one('as_built_worst.gear_tooth'), real(worst(2), dp), absolute=0.1_dp)
          load = answer%all_of('as_built_loads.load_n')
          place = answer%all_of('as_built_loads.s')
          call check_close(t, one%name//'place of the largest load', answer%one('as_built_worst.s'), place(maxloc(load, 1)))
          call check_close(t, one%name//'range', answer%one('as_built.dte_peak_to_peak_um'), (one%largest - one%least), &
                           absolute=1e-6_dp)
          ! The other solver took samples at rest, which miss up to so much of a corner.
          associate (missed => answer%one('as_built_worst.ste_peak_to_peak_um') - one%range)
            call check_true(t, one%name//'static range', missed > -1e-9_dp .and. &
                            missed < merge(2e-6_dp, 1e-9_dp, one%changes > 0), str(missed))
          end associate
          call check_close(t, one%name//'largest load', maxval(answer%all_of('as_built_loads.load_ratio')), one%dynamic_factor, &
                           absolute=1e-9_dp)
          call check_close(t, one%name//'modulus', answer%one('as_built.multiplier'), one%modulus**(1.0_dp/one%periods), &
                           absolute=merge(1e-6_dp, 1.0_dp, one%modulus > 1e-200_dp))
        end do
      end associate
    end do
  end subroutine by_keys

  !> Friction, waves and pairs that part for a twentieth of a mesh period: against DOP853 with located changes of contact
  !> (tools/reference/make_turn_with_friction.py). At each tolerance the error is below twice its estimate.
  subroutine with_friction(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: dynamic_factor = 2.366433441471_dp, of_pair_28 = 1.373202269366_dp
    character(*), parameter :: tolerance(3) = [character(5) :: '1e-6', '1e-9', '1e-11']
    character(*), parameter :: text = &
      '&case tasks = ''as_built'' / &load normal_force_n = 2471.162 / &as_built rpm = 115654.02 / &mesh model = '// &
      '''polynomial'', contact_ratio = 1.880688, pitch_point = 0.89915, coefficients = 422.865 0 -149.424 0 -2.592 0 '// &
      '47.765 0 -33.716 / &dynamics damping_ratio = 0.10853, friction = 0.0406 / &pinion teeth = 10, effective_mass_kg '// &
      '= 0.3011 / &gear teeth = 35, effective_mass_kg = 0.3012 / &pair pressure_angle_deg = 21.33146835576881 / &relief '// &
      'amount_um = 17.513, shape = ''parabolic'', gear_fraction = 0 / &deviations pinion_counting = '// &
      '''counterclockwise'', pinion_flank = ''left'', pinion_tooth = 4, pinion_cumulative_pitch_um = -3.05996209253904 '// &
      '0.43505776151152636 -1.0255146410281473 -1.7366209661028416 1.2763940215143295 -0.949237562293664 '// &
      '-6.387296971953901 3.5248232270608577 2.4565136448982146 3.935957953618669, pinion_profile_form_um = '// &
      '-1.23131372238288 0.4711267154654208 -3.390556076915558 1.2240628983085249 -4.638582064542988 '// &
      '0.05261268688099199 -0.37500908413829753 1.302230318817427 1.0025590653053567 -2.1574738608560065, '// &
      'pinion_wave_order = 21, pinion_wave_um = 0.6805, pinion_wave_phase_deg = 27.886428846812297, gear_wave_order = '// &
      '11 1, gear_wave_um = 0.4482 2.4939, gear_wave_phase_deg = 83.96352712965137 -80.29545132522384 / &numerics '// &
      'tolerance = '
    type(answer_t) :: answer
    real(dp), allocatable :: load_ratio(:)
    real(dp) :: off
    integer :: k

    do k = 1, size(tolerance)
      call ask(t, text//tolerance(k)//' /', answer)
      off = abs(answer%one('as_built.dynamic_factor') - dynamic_factor)
      call check_true(t, 'estimate at '//tolerance(k), off < 2*answer%one('as_built.error_estimate') + 1e-12_dp, str(off))
    end do
    call check_close(t, 'dynamic factor', answer%one('as_built.dynamic_factor'), dynamic_factor, absolute=2e-11_dp)
    load_ratio = answer%all_of('as_built_loads.load_ratio')
    call check_close(t, 'pair 28', load_ratio(28), of_pair_28, absolute=2e-11_dp)
  end subroutine with_friction

  !> A given motion as the text of a case.
  subroutine write_case(given, ascends, first, text)
    type(given_t), intent(in) :: given
    logical, intent(in) :: ascends
    integer, intent(in) :: first(2)              ! numbers of the teeth that enter at A at the time 0
    character(:), allocatable, intent(out) :: text
    character(6), parameter :: gear(2) = [character(6) :: 'pinion', 'gear']
    real(dp) :: ratio, relief(2)
    integer :: i, k

    associate (osc => given%osc, mesh => given%osc%mesh)
      ratio = mesh%contact_ratio
      relief = [mesh%profile_error%value(ratio), mesh%profile_error%value(0.0_dp)]
      text = '&case tasks = ''as_built'' /'
      call add('&mesh model = ''polynomial'', contact_ratio', [ratio])
      call add('coefficients', mesh%stiffness%coef(:, 1)*um)
      call add('/ &load normal_force_n', [osc%load])
      call add('/ &dynamics damping_ratio', [osc%damping_ratio])
      call add('/ &as_built with_ste = .true. rpm', [given%rpm])
      call add('/ &numerics tolerance', [1e-11_dp])
      do i = 1, 2
        text = text//'/ &'//trim(gear(i))//' teeth = '//str(mesh%teeth(i))
        call add('effective_mass_kg', osc%mass(i:i))
      end do
      if (any(relief > 0)) then
        call add('/ &relief amount_um', [maxval(relief)/um])
        call add('pinion_fraction', [relief(1)/maxval(relief)])
        call add('gear_fraction', [relief(2)/maxval(relief)])
      end if
      text = text//'/ &deviations '
      call add_lists(1, mesh%deviations%pinion)
      call add_lists(2, mesh%deviations%gear)
      do k = 1, size(mesh%deviations%waves)
        associate (wave => mesh%deviations%waves(k), name => gear(mesh%deviations%waves(k)%gear))
          text = text//' '//trim(name)//'_wave_order = '//str(wave%order)
          call add(trim(name)//'_wave_um', [wave%amplitude/um])
          call add(trim(name)//'_wave_phase_deg', [wave%phase*180/pi])
        end associate
      end do
      text = text//'/'
    end associate

  contains

    !> A key with all digits.
    subroutine add(key, values)
      character(*), intent(in) :: key
      real(dp), intent(in) :: values(:)
      character(28) :: word
      integer :: n

      text = text//' '//key//' ='
      do n = 1, size(values)
        write (word, '(es25.17e3)') values(n)
        text = text//' '//trim(adjustl(word))
      end do
      text = text//new_line('a')
    end subroutine add

    !> The lists of a gear, from its c_n.
    subroutine add_lists(i, c)
      integer, intent(in) :: i
      real(dp), intent(in) :: c(0:, :)
      real(dp) :: pitch(size(c, 2)), slope(size(c, 2)), form(size(c, 2))
      integer :: tooth, k, sense

      sense = merge(1, -1, ascends)
      do k = 1, size(c, 2)
        tooth = 1 + modulo(first(i) - 1 + sense*(k - 1), size(c, 2))
        form(tooth) = c(2, k)*ratio**2/4/um
        slope(tooth) = merge(-1, 1, i == 1)*c(1, k)*ratio/um
        pitch(tooth) = sense*merge(1, -1, i == 1)*(c(0, k)/um + form(tooth)/3)
      end do
      ! The pinion drives, so that it turns clockwise where its right flanks carry; counted against that, teeth engage in the order
      ! of their numbers.
      text = text//trim(gear(i))//'_counting = ''clockwise'' '//trim(gear(i))//'_flank = '''// &
             trim(merge('right', 'left ', ascends .neqv. i == 1))//''' '//trim(gear(i))//'_tooth = '//str(first(i))
      call add(trim(gear(i))//'_cumulative_pitch_um', pitch)
      if (any(abs(slope) > 0)) call add(trim(gear(i))//'_profile_slope_um', slope)
      if (any(abs(form) > 0)) call add(trim(gear(i))//'_profile_form_um', form)
    end subroutine add_lists
  end subroutine write_case

  !> The motion at 1/min, to a tight tolerance.
  subroutine solve(t, osc, rpm, turn)
    type(tally_t), intent(inout) :: t
    type(oscillator_t), intent(inout) :: osc     ! to be completed
    real(dp), intent(in) :: rpm
    type(turn_t), intent(out) :: turn
    type(error_t), allocatable :: error
    type(accuracy_t) :: options
    type(levels_t), allocatable :: levels

    osc%by_load = .false.
    call make_oscillator(osc, error)
    call check_no_error(t, 'oscillator', error)
    options%steady%tolerance = 1e-10_dp
    allocate (levels)
    call find_turn(osc, rpm, options, levels, turn)
    call check_true(t, 'there is a motion', allocated(turn%load))
    if (.not. allocated(turn%load)) allocate (turn%load(1), turn%place(1), source=0.0_dp)
  end subroutine solve

  !> A constant goes from the pinion's teeth to the gear's where it changes nothing, or onto all teeth, which moves the motion by as
  !> much; both numberings shifted by n teeth begin the motion n periods later.
  subroutine moved(t, given)
    type(tally_t), intent(inout) :: t
    type(given_t), intent(in) :: given(:)
    real(dp), parameter :: much = 4*um
    integer, parameter :: n = 6
    type(oscillator_t) :: osc
    type(turn_t) :: turn
    integer :: i

    do i = 1, 5
      associate (one => given(i), pinion => given(i)%osc%mesh%deviations%pinion, gear => given(i)%osc%mesh%deviations%gear)
        osc = one%osc
        osc%mesh%deviations%pinion(0, :) = pinion(0, :) - much
        osc%mesh%deviations%gear(0, :) = gear(0, :) + 2*much
        call solve(t, osc, one%rpm, turn)
        call check_close(t, 'dynamic factor with all teeth moved', turn%point%dynamic_factor, one%dynamic_factor, absolute=1e-9_dp)
        call check_close(t, 'state', turn%point%steady%state(1), um*one%state(1) + much, absolute=1e-8_dp*um)
        osc = one%osc
        osc%mesh%deviations%pinion = cshift(pinion, n, 2)
        osc%mesh%deviations%gear = cshift(gear, n, 2)
        osc%mesh%deviations%waves%phase = osc%mesh%deviations%waves%phase + 2*pi*n/osc%mesh%teeth(1)
        call solve(t, osc, one%rpm, turn)
        call check_close(t, 'dynamic factor of another first '// &
          'tooth', turn%point%dynamic_factor, one%dynamic_factor, absolute=1e-9_dp)
        call check_true(t, 'where the largest load is then', all(modulo(maxloc(turn%load, 1) - 1 + n - one%tooth, &
                                                                       osc%mesh%teeth) == 0), one%name)
      end associate
    end do
  end subroutine moved

  !> Load, errors and relief times a number: the motion too. Load, stiffness and masses: the motion as it was.
  subroutine scaled(t, given)
    type(tally_t), intent(inout) :: t
    type(given_t), intent(in) :: given(:)
    real(dp), parameter :: times = 3
    type(oscillator_t) :: osc
    type(turn_t) :: turn
    integer :: i

    do i = 1, 5
      associate (one => given(i))
        osc = one%osc
        osc%load = times*osc%load
        osc%mesh%profile_error = osc%mesh%profile_error%scaled(times)
        osc%mesh%deviations%pinion = times*osc%mesh%deviations%pinion
        osc%mesh%deviations%gear = times*osc%mesh%deviations%gear
        osc%mesh%deviations%waves%amplitude = times*osc%mesh%deviations%waves%amplitude
        call solve(t, osc, one%rpm, turn)
        call check_close(t, 'dynamic factor, all larger', turn%point%dynamic_factor, one%dynamic_factor, absolute=1e-9_dp)
        call check_close(t, 'largest transmission error, all larger', largest_of(turn), times*um*one%largest, absolute=1e-8_dp*um)
        osc = one%osc
        osc%load = times*osc%load
        osc%mass = times*osc%mass
        osc%mesh%stiffness = osc%mesh%stiffness%scaled(times)
        call solve(t, osc, one%rpm, turn)
        call check_close(t, 'largest transmission error, all stiffer', largest_of(turn), um*one%largest, absolute=1e-8_dp*um)
      end associate
    end do
  end subroutine scaled

  !> All teeth with the same polynomial: the motion of the nominal mesh with that as its profile error, over one mesh period; with
  !> friction, backlash and a compliance that pairs share.
  subroutine alike(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: ratio = 1.7_dp, rpm(3) = [5200.0_dp, 9100.0_dp, 13700.0_dp], c(0:2) = [3.0_dp, -4.0_dp, 9.0_dp]*um
    type(oscillator_t) :: nominal, osc
    type(turn_t) :: expected, turn
    integer :: i, teeth(2), which

    teeth = [12, 18]
    do which = 1, 3
      nominal%mesh%contact_ratio = ratio
      nominal%mesh%reach = [0.0_dp, ratio]
      nominal%mesh%teeth = teeth
      nominal%mesh%pitch_point = 0.9_dp
      nominal%mesh%tan_angle = 0.36_dp
      nominal%mesh%stiffness = polynomial(0.0_dp, ratio, [3e8_dp, 2e7_dp, -9e7_dp])
      nominal%mass = [0.6_dp, 0.9_dp]
      nominal%load = 2500
      nominal%damping_ratio = 0.06_dp
      nominal%friction = merge(0.07_dp, 0.0_dp, which /= 2)
      nominal%has_backlash = which == 3
      nominal%backlash = 1e-6_dp
      nominal%mesh%disc%shared = merge(4e-10_dp, 0.0_dp, which == 2)
      osc = nominal
      ! Over u, from -1 at A to 1 at E.
      nominal%mesh%profile_error = polynomial(0.0_dp, ratio, c*[1.0_dp, ratio/2, (ratio/2)**2])
      osc%mesh%profile_error = polynomial(0.0_dp, ratio, [0.0_dp])
      osc%mesh%deviations = make_deviations(teeth, spread(c*[2, 0, 1], 2, teeth(1)), spread(c*[-1, 1, 0], 2, teeth(2)), &
                                            [wave_t ::], 5)
      do i = 1, size(rpm)
        call solve(t, nominal, rpm(i), expected)
        call solve(t, osc, rpm(i), turn)
        call check_close(t, 'dynamic factor of teeth that are alike', turn%point%dynamic_factor, &
                         expected%point%dynamic_factor, absolute=1e-9_dp)
        call check_true(t, 'over the hunting period', size(turn%load) == 36)
        call check_true(t, 'each pair carries as much', all(abs(turn%load - expected%load(1)) < 1e-8_dp*osc%load))
      end do
    end do
  end subroutine alike

  !> Single teeth's errors with friction and backlash, lightly loaded so that flanks part: against a march by Runge and Kutta in
  !> many
  !> small steps, written here from the equations alone. Its error falls with the steps: 1e-4 with 2500 a mesh period, 2e-5 with
  !> 20000.
  subroutine marched(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: ratio = 1.7_dp, zeta = 0.09_dp, friction = 0.08_dp, mass(2) = [0.6_dp, 0.9_dp], backlash = 4e-6_dp, &
                           force = 900, pitch_point = 0.8_dp, slope = 0.36_dp, rpm(3) = [6000.0_dp, 11000.0_dp, 16500.0_dp], &
                           stiffness(0:2) = [3e8_dp, 2e7_dp, -9e7_dp]
    integer, parameter :: teeth(2) = [12, 18], turn = 36, parts = 20000
    type(oscillator_t) :: osc
    type(turn_t) :: found
    real(dp) :: pinion(0:1, 12), gear(0:1, 18), largest(turn), duration
    integer :: i

    do i = 1, 12
      pinion(:, i) = um*[modulo(5*i, 12)*0.5_dp - 3, modulo(7*i, 12)*0.3_dp - 1.5_dp]
    end do
    do i = 1, 18
      gear(:, i) = um*[modulo(7*i, 18)*0.3_dp - 2, 2 - modulo(5*i, 18)*0.2_dp]
    end do
    osc%mesh%contact_ratio = ratio
    osc%mesh%reach = [0.0_dp, ratio]
    osc%mesh%teeth = teeth
    osc%mesh%pitch_point = pitch_point
    osc%mesh%tan_angle = slope
    osc%mesh%stiffness = polynomial(0.0_dp, ratio, stiffness)
    osc%mesh%profile_error = polynomial(0.0_dp, ratio, [0.0_dp])
    osc%mesh%deviations = make_deviations(teeth, pinion, gear, [wave_t(2, 1, 2*um, 0.5_dp)], 4)
    osc%mass = mass
    osc%load = force
    osc%damping_ratio = zeta
    osc%friction = friction
    osc%has_backlash = .true.
    osc%backlash = backlash
    do i = 1, size(rpm)
      call solve(t, osc, rpm(i), found)
      duration = 60/(teeth(1)*rpm(i))
      call march()
      call check_true(t, 'flanks part', found%point%steady%lost)
      call check_close(t, 'dynamic factor against a march', found%point%dynamic_factor, maxval(largest)/force, absolute=4e-5_dp)
      call check_true(t, 'each pair against a march', maxval(abs(found%load - largest)) < 2e-4_dp*force, &
                      str(maxval(abs(found%load - largest))/force))
    end do

  contains

    !> Three turns, and the largest loads of the pairs in the last.
    subroutine march()
      real(dp) :: state(2), k(2, 4), load(0:1), h, time
      integer :: n

      h = 1.0_dp/parts
      state = [force/3e8_dp, 0.0_dp]
      largest = 0
      do n = 0, 3*turn*parts - 1
        time = real(n, dp)/parts
        k(:, 1) = change(time, state, load)
        if (n >= 2*turn*parts) call note(n, load)
        k(:, 2) = change(time + h/2, state + h/2*k(:, 1))
        k(:, 3) = change(time + h/2, state + h/2*k(:, 2))
        k(:, 4) = change(time + h*(1 - 1e-9_dp), state + h*k(:, 3))
        state = state + h/6*(k(:, 1) + 2*k(:, 2) + 2*k(:, 3) + k(:, 4))
      end do
    end subroutine march

    !> The loads of the last two pairs that entered.
    subroutine note(n, load)
      integer, intent(in) :: n
      real(dp), intent(in) :: load(0:1)
      integer :: j, pair

      do j = 0, 1
        pair = 1 + modulo(n/parts - j, turn)
        largest(pair) = max(largest(pair), load(j))
      end do
    end subroutine note

    !> Derivative of the state over the mesh phase.
    function change(time, state, load) result(rate)
      real(dp), intent(in) :: time, state(2)
      real(dp), intent(out), optional :: load(0:1)
      real(dp) :: rate(2), s, d, pair, error, square, pull, k, arms
      integer :: j, number

      square = 0
      pull = force*sum(1/mass)
      if (present(load)) load = 0
      do j = 0, 1
        number = int(time) - j
        s = time - number
        if (s >= ratio) cycle
        d = s - ratio/2
        k = sum(stiffness*[1.0_dp, 2*d/ratio, (2*d/ratio)**2])
        error = dot_product([1.0_dp, d], pinion(:, 1 + modulo(number, 12)) + gear(:, 1 + modulo(number + 4, 18))) + &
                2*um*sin(2*pi*(time + 4)/18 + 0.5_dp)
        arms = 0
        if (state(1) > error) then
          arms = (slope + (s - pitch_point)*2*pi/12)/mass(1) + (slope - (s - pitch_point)*2*pi/18)/mass(2)
          pair = k*(state(1) - error)
          arms = sum(1/mass) + sign(friction, s - pitch_point)*arms
          square = square + k*arms
          pull = pull - pair*arms
          if (present(load)) load(j) = pair
        end if
        if (state(1) < -backlash) then
          square = square + k*sum(1/mass)
          pull = pull - k*(state(1) + backlash)*sum(1/mass)
        end if
      end do
      rate = [state(2), duration**2*pull - 2*zeta*sqrt(square)*duration*state(2)]
    end function change
  end subroutine marched

  !> Pitch errors that repeat after 4 of 24 teeth: the motion repeats after 4 mesh periods, so that all orders of the turn but each
  !> sixth vanish. Pairs in full contact add up: the motion of two gears is the sum of those of each with a nominal one.
  subroutine patterns(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: ratio = 1.4_dp, rpm = 7300
    integer, parameter :: teeth(2) = [24, 20]
    type(oscillator_t) :: osc
    type(turn_t) :: turn, part(2)
    real(dp) :: pinion(0:0, 24), gear(0:0, 20), none(0:0, 0)
    integer :: k

    osc%mesh%contact_ratio = ratio
    osc%mesh%reach = [0.0_dp, ratio]
    osc%mesh%teeth = teeth
    osc%mesh%stiffness = polynomial(0.0_dp, ratio, [3e8_dp, 0.0_dp, -9e7_dp])
    osc%mesh%profile_error = polynomial(0.0_dp, ratio, [0.0_dp])
    osc%mass = 0.7_dp
    osc%load = 6000
    osc%damping_ratio = 0.1_dp
    pinion(0, :) = [([1.0_dp, -2.0_dp, 0.5_dp, 0.0_dp]*um, k=1, 6)]
    osc%mesh%deviations = make_deviations(teeth, pinion, none, [wave_t ::], 0)
    call solve(t, osc, rpm, turn)
    call check_true(t, 'a gear without deviations does not count', size(turn%load) == 24)
    do k = 1, 11
      if (modulo(k, 6) == 0) cycle
      call check_true(t, 'order that a pattern has not', abs(amplitude_of(turn, k, 24)) < 1e-9_dp*um, str(k))
    end do
    call check_true(t, 'order that it has', abs(amplitude_of(turn, 6, 24)) > 0.1_dp*um)
    gear(0, :) = [(modulo(7*k, 5)*0.4_dp*um, k=1, 20)]
    part(1) = turn
    osc%mesh%deviations = make_deviations(teeth, none, gear, [wave_t(2, 3, 1.5_dp*um, 0.4_dp)], 0)
    call solve(t, osc, rpm, part(2))
    osc%mesh%deviations = make_deviations(teeth, pinion, gear, [wave_t(2, 3, 1.5_dp*um, 0.4_dp)], 0)
    call solve(t, osc, rpm, turn)
    call check_true(t, 'full contact', .not. turn%point%steady%departs)
    call check_true(t, 'hunting period', size(turn%load) == 120)
    ! Fifths of a pinion's pattern are orders of the gear too.
    do k = 1, 5
      associate (pinion_part => merge(amplitude_of(part(1), 1, 4), (0.0_dp, 0.0_dp), k == 5))
        call check_true(t, 'sum of the parts', abs(amplitude_of(turn, k, 20) - amplitude_of(part(2), k, 20) - &
                                                   pinion_part) < 1e-9_dp*um, str(k))
      end associate
    end do
  end subroutine patterns

  !> Constant stiffness of all pairs together and one wave: the linear oscillator with a moving base, in closed form.
  subroutine excited(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: amplitude = 0.7_dp*um, stiffness = 2.5e8_dp, zeta = 0.08_dp, mass = 0.8_dp
    integer, parameter :: teeth(2) = [21, 34], order(3) = [1, 20, 42]
    type(oscillator_t) :: osc
    type(turn_t) :: turn
    real(dp) :: rpm, ratio, natural, none(0:0, 0)
    complex(dp) :: expected
    integer :: i, gear

    do gear = 1, 2
      do i = 1, size(order)
        osc = oscillator_t()
        osc%mesh%contact_ratio = 2
        osc%mesh%reach = [0.0_dp, 2.0_dp]
        osc%mesh%teeth = teeth
        osc%mesh%stiffness = polynomial(0.0_dp, 2.0_dp, [stiffness])
        osc%mesh%profile_error = polynomial(0.0_dp, 2.0_dp, [0.0_dp])
        osc%mass = mass
        osc%load = 5000
        osc%damping_ratio = zeta
        osc%mesh%deviations = make_deviations(teeth, none, none, [wave_t(gear, order(i), amplitude, 0.3_dp)], 0)
        natural = sqrt(2*stiffness*2/mass)
        ratio = 0.4_dp + 0.3_dp*i
        rpm = ratio*natural*60/(2*pi*order(i))*teeth(gear)/teeth(1)
        call solve(t, osc, rpm, turn)
        expected = amplitude*exp(cmplx(0.0_dp, 0.3_dp - pi/2, dp))/cmplx(1 - ratio**2, 2*zeta*ratio, dp)
        call check_true(t, 'wave in closed form', abs(amplitude_of(turn, order(i), teeth(gear)) - expected) < &
                        1e-7_dp*amplitude, str(order(i)))
        call check_close(t, 'range at rest in closed form', static_range(osc%mesh, osc%load), 2*amplitude, 1e-12_dp)
        ! Each of the two pairs carries half of the load and of what moves them.
        call check_close(t, 'load in closed form', maxval(turn%load), 2500 + stiffness*abs(expected - amplitude* &
                         exp(cmplx(0.0_dp, 0.3_dp - pi/2, dp))), 1e-5_dp)
      end do
    end do
  end subroutine excited

  !> Without deviations each pair of teeth is stressed as the rows of the task `load` say: the nominal stress of ISO 6336-3 by the
  !> form of the tooth for each row's load and place, and Hertz pressure by Johnson's Eq. 4.45 from radii of curvature.
  subroutine stressed(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: text = '&case tasks = ''as_built'', ''load'' / &pair module_mm = 3, face_width_mm = 20 / '// &
      '&pinion teeth = 21 '// &
      '/ &gear teeth = 34 / &load torque_nm = 100 / &mesh model = ''weber'', corner_contact = .false. / &sweep load_rpm = '// &
      '9000 / &as_built rpm = 9000 with_root_stress = .true. / &deviations pinion_runout_um = 0 pinion_runout_phase_deg = 0 /'
    real(dp), parameter :: young = 206e9_dp, poisson = 0.3_dp
    type(answer_t) :: answer
    type(case_t) :: case
    type(error_t), allocatable :: error
    type(gear_t) :: gears(2)
    type(pair_t) :: pair
    real(dp), allocatable :: s(:), load(:), column(:)
    real(dp) :: curvature(2), place, force, expected
    integer :: i, k

    call ask(t, text, answer)
    call read_case(text, case, error)
    do i = 1, 2
      call make_gear(case%spec(i), gears(i), error)
    end do
    call make_pair(gears(1), gears(2), free_centre_distance(gears(1), gears(2)), pair, error)
    call check_no_error(t, 'pair', error)
    s = answer%all_of('load.s')
    load = answer%all_of('load.pair_load_n')
    do i = 1, 2
      expected = maxval([(nominal_root_stress(pair, i, iso_form(gears(i), pair%radius(i, s(k))), load(k)), k=1, size(s))])/1e6_dp
      column = answer%all_of('as_built_loads.'//trim(merge('pinion', 'gear  ', i == 1))//'_root_stress_mpa')
      call check_true(t, 'root stress', size(column) == 1 .and. all(abs(column - expected) < 1e-3_dp*expected), str(expected))
      do k = 1, 2
        call check_close(t, 'root stress of each pair of gears', answer%one('as_built_worst.'//trim(merge('nominal_', '        ', &
          k == 1))//trim(merge('pinion', 'gear  ', i == 1))//'_root_stress_mpa'), expected, 1e-3_dp)
      end do
    end do
    place = answer%one('as_built_loads.s')
    force = answer%one('as_built_loads.load_n')
    curvature(1) = pair%start_curvature + place*pair%base_pitch
    curvature(2) = pair%centre_distance*sin(pair%working_angle(1)) - curvature(1)
    expected = sqrt(force/0.02_dp*sum(1/curvature)/(pi*2*(1 - poisson**2)/young))/1e6_dp
    call check_close(t, 'Hertz pressure', answer%one('as_built_loads.pressure_mpa'), expected, 1e-9_dp)
    ! Where teeth deviate, the largest stress of the turn is that of one of its pairs.
    call ask(t, text(:index(text, '&deviations') - 1)//'&deviations pinion_class = 6 gear_class = 6 draws = 1 /', answer)
    do i = 1, 2
      column = answer%all_of('as_built_loads.'//trim(merge('pinion', 'gear  ', i == 1))//'_root_stress_mpa')
      call check_true(t, 'pairs of a turn', size(column) == 21*34 .and. maxval(column) > minval(column) + 1)
      call check_close(t, 'largest root stress of the pairs', &
                       answer%one('as_built_worst.'//trim(merge('pinion', 'gear  ', i == 1))//'_root_stress_mpa'), maxval(column))
    end do
  end subroutine stressed

  !> G5 with less damping, at another speed: its orbit over a turn repels with the modulus 3.696, and so do those over several turns
  !> (the solver that made the six). It is not told.
  subroutine repelling(t, given)
    type(tally_t), intent(inout) :: t
    type(given_t), intent(in) :: given(:)
    type(oscillator_t) :: osc
    type(accuracy_t) :: options
    type(error_t), allocatable :: error
    type(levels_t), allocatable :: levels
    type(turn_t) :: turn

    osc = given(5)%osc
    osc%damping_ratio = 0.05_dp
    call make_oscillator(osc, error)
    allocate (levels)
    call find_turn(osc, 11000.0_dp, options, levels, turn)
    call check_true(t, 'an orbit that repels has no loads', .not. allocated(turn%load))
    call check_true(t, 'nor a result', .not. has_result(turn%point%steady%status), status_name(turn%point%steady%status))
    call tiny_multiplier(t)
  end subroutine repelling

  !> Multiplier of a mesh period, in closed form where the stiffness is constant by parts, beside that which the turn of 220
  !> periods returns: over the whole turn it would be below the smallest number.
  subroutine tiny_multiplier(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: ratio = 1.4_dp, zeta = 0.02_dp, stiffness = 3e8_dp, mass = 0.7_dp, rpm = 437.5_dp
    integer, parameter :: teeth(2) = [20, 11]
    type(oscillator_t) :: osc
    type(error_t), allocatable :: error
    type(accuracy_t) :: options
    type(levels_t), allocatable :: levels
    type(turn_t) :: turn
    real(dp) :: pinion(0:0, 20), gear(0:0, 11), product(2, 2), part(2), half, expected
    integer :: k

    osc%mesh%contact_ratio = ratio
    osc%mesh%reach = [0.0_dp, ratio]
    osc%mesh%teeth = teeth
    osc%mesh%stiffness = polynomial(0.0_dp, ratio, [stiffness])
    osc%mesh%profile_error = polynomial(0.0_dp, ratio, [0.0_dp])
    osc%mass = mass
    osc%load = 60000
    osc%damping_ratio = zeta
    pinion(0, :) = [(modulo(7*k, 5)*0.2_dp*um, k=1, 20)]
    gear(0, :) = [(modulo(3*k, 4)*0.2_dp*um, k=1, 11)]
    osc%mesh%deviations = make_deviations(teeth, pinion, gear, [wave_t ::], 0)
    call make_oscillator(osc, error)
    call check_no_error(t, 'oscillator', error)
    options%steady%tolerance = 1e-8_dp
    allocate (levels)
    call find_turn(osc, rpm, options, levels, turn)
    part = [ratio - 1, 2 - ratio]*60/(rpm*teeth(1))
    product = matmul(decayed(sqrt(2*stiffness/mass), part(2)), decayed(sqrt(4*stiffness/mass), part(1)))
    half = (product(1, 1) + product(2, 2))/2
    expected = sqrt(product(1, 1)*product(2, 2) - product(1, 2)*product(2, 1))
    if (abs(half) > expected) expected = abs(half) + sqrt(half**2 - expected**2)
    call check_true(t, 'a turn of many mesh periods in full contact', size(turn%load) == 220 .and. &
                    .not. turn%point%steady%departs)
    call check_true(t, 'below the smallest number over the turn', 220*log(expected) < log(tiny(expected)))
    call check_close(t, 'multiplier of a mesh period in closed form', turn%point%steady%mesh_multiplier, expected, 1e-7_dp)

  contains

    !> Propagator of (x, x') over a time with constant coefficients.
    pure function decayed(omega, time) result(matrix)
      real(dp), intent(in) :: omega, time
      real(dp) :: matrix(2, 2), damped, c, s

      damped = omega*sqrt(1 - zeta**2)
      c = cos(damped*time)
      s = sin(damped*time)/damped
      matrix = exp(-zeta*omega*time)*reshape([c + zeta*omega*s, -omega**2*s, s, c - zeta*omega*s], [2, 2])
    end function decayed
  end subroutine tiny_multiplier

  !> Tolerances of ISO 1328-1:2013 as printed in a table of the finding that this project keeps, for d 79.5, m 3.18, b 25.4 mm.
  subroutine classes(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: tenths(9, 5) = reshape([45, 140, 38, 48, 60, 44, 49, 65, 120, &
                                                  65, 190, 55, 65, 85, 60, 70, 95, 170, &
                                                  90, 270, 75, 95, 120, 90, 95, 130, 250, &
                                                  130, 390, 110, 130, 170, 120, 140, 190, 350, &
                                                  180, 550, 150, 190, 240, 180, 190, 260, 490], [9, 5])    ! um
    real(dp), parameter :: exact(9) = [6.3515_dp, 19.2890_dp, 5.3515_dp, 6.7490_dp, 8.6132_dp, 6.2098_dp, 6.8921_dp, 9.2769_dp, &
                                       17.3601_dp]
    type(tolerances_t) :: found, spur
    type(error_t), allocatable :: error
    integer :: class

    do class = 4, 8
      call find_tolerances(class, 25, 3.18_dp, 25.4_dp, found, error)
      call check_no_error(t, 'tolerances', error)
      call check_true(t, 'rounded tolerances', all(abs(list(found) - tenths(:, class - 3)/10.0_dp) < 1e-9_dp), str(class))
    end do
    call find_tolerances(5, 25, 3.18_dp, 25.4_dp, found, error, exactly=.true.)
    call check_true(t, 'exact tolerances', all(abs(list(found) - exact) < 6e-5_dp))
    ! Class 6, m 3, d 120, b 30 and class 5, m 2, d 100, b 20 of two public programs.
    call find_tolerances(6, 40, 3.0_dp, 30.0_dp, found, error)
    call check_true(t, 'of a public program', all(abs([found%single_pitch, found%cumulative_pitch, found%profile] - &
                                                      [9.0_dp, 29.0_dp, 12.0_dp]) < 1e-9_dp))
    ! Of a helical gear with the reference diameter of a spur gear.
    call find_tolerances(5, 25, 3.18_dp, 25.4_dp, found, error, exactly=.true., helix_angle=-acos(25/28.0_dp))
    call check_no_error(t, 'tolerances of a helical gear', error)
    call find_tolerances(5, 28, 3.18_dp, 25.4_dp, spur, error, exactly=.true.)
    call check_true(t, 'of a helical gear', all(abs(list(found) - list(spur)) < 1e-12_dp))
    call find_tolerances(5, 25, 3.18_dp, 25.4_dp, found, error, helix_angle=46*pi/180)
    call check_error(t, 'beyond 45 degrees', error, 'helix angle (deg) = 46')
    call find_tolerances(12, 25, 3.18_dp, 25.4_dp, found, error)
    call check_error(t, 'class 12', error, 'flank tolerance class = 12')
    call find_tolerances(6, 25, 3.18_dp, 2.0_dp, found, error)
    call check_error(t, 'narrow', error, 'face width (mm) = 2')

  contains

    pure function list(t) result(values)
      type(tolerances_t), intent(in) :: t
      real(dp) :: values(9)

      values = [t%single_pitch, t%cumulative_pitch, t%profile_slope, t%profile_form, t%profile, t%helix_slope, t%helix_form, &
                t%helix, t%runout]
    end function list
  end subroutine classes

  !> Random numbers as L'Ecuyer prints the first of his generator (0.127011 and 0.318528); flanks with the distributions that the
  !> page tells, within five times the scatter of so many.
  subroutine drawn(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: first(2) = [0.127011_dp, 0.318528_dp]
    integer, parameter :: teeth = 4000, many = 2000
    type(random_stream_t) :: random
    type(deviations_t) :: laid
    type(flank_deviations_t) :: flanks
    type(tolerances_t) :: tolerances
    real(dp) :: number(1), of_seed(3, many)
    integer :: i, within

    call random%draw_normal(number)
    call check_close(t, 'first normal number', number(1), sqrt(-2*log(first(1)))*cos(2*pi*first(2)), absolute=1e-5_dp)
    tolerances%single_pitch = 9
    tolerances%profile_slope = 7.5_dp
    tolerances%runout = 25
    random = begin_stream(7)
    flanks%wave_order = [40]
    flanks%wave = [2*um]
    flanks%wave_phase = [0.5_dp]
    call draw_deviations(tolerances, teeth, random, flanks)
    ! What a case tells beside the class adds to it.
    laid = place_deviations([flanks, flank_deviations_t()], frame_t(), [teeth, 30], 1.5_dp, 0)
    call check_true(t, 'waves beside a class', any(laid%waves%order == 40 .and. abs(laid%waves%amplitude - 2*um) < 1e-12_dp*um &
                                                   .and. abs(laid%waves%phase - 0.5_dp) < 1e-12_dp), str(size(laid%waves)))
    call check_close(t, 'scatter of positions', spread_of(flanks%cumulative_pitch), 9*um/(3*sqrt(2.0_dp)), 5/sqrt(2.0_dp*teeth))
    call check_close(t, 'scatter of slopes', spread_of(flanks%slope), 0.2_dp*7.5_dp*um, 5/sqrt(2.0_dp*teeth))
    within = 0
    do i = 1, many
      call draw_deviations(tolerances, 5, random, flanks)
      if (flanks%runout < 25*um) within = within + 1
    end do
    call check_close(t, 'run-outs within the tolerance', within/real(many, dp), 0.99_dp, absolute=5*sqrt(0.99_dp*0.01_dp/many))
    ! Numbers of neighbouring seeds are independent.
    do i = 1, many
      random = begin_stream(i)
      call random%draw_normal(of_seed(:, i))
    end do
    do i = 1, 20
      call check_true(t, 'numbers of seeds beside', &
                      all(abs(sum(of_seed(:, :many - i)*of_seed(:, 1 + i:), 2)) < 5*sqrt(real(many, dp))), str(i))
    end do

  contains

    pure real(dp) function spread_of(values)
      real(dp), intent(in) :: values(:)

      spread_of = sqrt(sum((values - sum(values)/size(values))**2)/(size(values) - 1))
    end function spread_of
  end subroutine drawn

  !> An inspection: the least deviation that each of the four tolerances rejects, of single teeth and of an eccentric gear whose
  !> teeth are a quarter of a turn apart; and the part of gears drawn that are within the class by their slopes alone, of which each
  !> is 0.25 times a normal number of the gear and 0.2 times one of the tooth, by Simpson's rule.
  subroutine inspected(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: teeth = 24, draws = 4000, points = 4000
    real(dp), parameter :: wide = 1e6_dp
    type(random_stream_t) :: random
    type(flank_deviations_t) :: flanks
    type(frame_t) :: frame
    real(dp) :: part, u
    integer :: i, within

    flanks%cumulative_pitch = um*[0, 0, 3, 5, 4, 0, -2, 0]
    flanks%slope = um*[1, -4, 2, 3, 0, 0, 0, 0]
    call look(tolerances_t(single_pitch=4.001_dp, cumulative_pitch=7.001_dp, profile_slope=4.001_dp), .true.)
    call look(tolerances_t(single_pitch=3.999_dp, cumulative_pitch=7.001_dp, profile_slope=4.001_dp), .false.)
    call look(tolerances_t(single_pitch=4.001_dp, cumulative_pitch=6.999_dp, profile_slope=4.001_dp), .false.)
    call look(tolerances_t(single_pitch=4.001_dp, cumulative_pitch=7.001_dp, profile_slope=3.999_dp), .false.)
    flanks%cumulative_pitch = 0*um*[1, 2, 3, 4]
    flanks%slope = flanks%cumulative_pitch
    flanks%runout = 8*um
    frame%along = 0.8_dp
    call look(tolerances_t(single_pitch=5.001_dp, cumulative_pitch=10.001_dp, runout=8.001_dp), .true.)
    call look(tolerances_t(single_pitch=4.999_dp, cumulative_pitch=10.001_dp, runout=8.001_dp), .false.)
    call look(tolerances_t(single_pitch=5.001_dp, cumulative_pitch=9.999_dp, runout=8.001_dp), .false.)
    call look(tolerances_t(single_pitch=5.001_dp, cumulative_pitch=10.001_dp, runout=7.999_dp), .false.)
    ! Pitch that takes the run-out back, on the pinion; on the gear, whose late flanks touch early, it is the other way.
    flanks%cumulative_pitch = -5*um*[0, 1, 0, -1]
    call look(tolerances_t(single_pitch=0.001_dp, cumulative_pitch=0.001_dp, runout=8.001_dp), .true.)
    call check_true(t, 'of the gear', is_within(flanks, tolerances_t(single_pitch=10.001_dp, cumulative_pitch=20.001_dp, &
                                                                     runout=9.0_dp), frame, 2) .and. .not. &
                    is_within(flanks, tolerances_t(single_pitch=10.001_dp, cumulative_pitch=19.999_dp, runout=9.0_dp), frame, 2))

    flanks = flank_deviations_t()
    frame = frame_t()
    random = begin_stream(3)
    within = 0
    do i = 1, draws
      call draw_deviations(tolerances_t(profile_slope=7.5_dp), teeth, random, flanks)
      if (is_within(flanks, tolerances_t(wide, wide, 7.5_dp, runout=wide), frame, 1)) within = within + 1
    end do
    part = 0
    do i = 0, points
      u = -8 + 16.0_dp*i/points
      part = part + merge(1, merge(4, 2, modulo(i, 2) == 1), i == 0 .or. i == points)*exp(-u**2/2)* &
             ((erf((1 - 0.25_dp*u)/(0.2_dp*sqrt(2.0_dp))) + erf((1 + 0.25_dp*u)/(0.2_dp*sqrt(2.0_dp))))/2)**teeth
    end do
    part = part*16/(3*points)/sqrt(2*pi)
    call check_close(t, 'within the class by slopes', within/real(draws, dp), part, absolute=5*sqrt(part*(1 - part)/draws))

  contains

    subroutine look(tolerances, accepted)
      type(tolerances_t), intent(in) :: tolerances
      logical, intent(in) :: accepted

      call check_true(t, 'accepted or not', is_within(flanks, tolerances, frame, 1) .eqv. accepted, &
                      str(tolerances%single_pitch)//' '//str(tolerances%cumulative_pitch))
    end subroutine look
  end subroutine inspected

  !> Gears that are accepted are those of all draws of the same seed that are within their class, in the same order.
  subroutine inspected_again(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: text = '&case tasks = ''as_built'' / &pair module_mm = 3, face_width_mm = 20 / &pinion teeth = '// &
      '20 / &gear teeth = 21 / &load torque_nm = 100 / &mesh model = ''weber'' / &sweep rpm_first = 9000, rpm_last = 9000, '// &
      'rpm_step = 100 / &dynamics damping_ratio = 0.1 / &deviations pinion_class = 6, draws = 30'
    type(answer_t) :: all_drawn, accepted
    real(dp), allocatable :: factor(:), of_all(:), within(:)
    integer :: i, met

    call ask(t, text//' /', all_drawn)
    call ask(t, text//', accepted = .true. /', accepted)
    of_all = all_drawn%all_of('as_built.dynamic_factor')
    factor = accepted%all_of('as_built.dynamic_factor')
    met = 0
    do i = 1, size(of_all)
      if (abs(of_all(i) - factor(met + 1)) <= 0) met = met + 1
    end do
    within = all_drawn%all_of('as_built_summary.within_class')
    call check_true(t, 'some are rejected', met > 15 .and. met < 30, str(met))
    call check_close(t, 'the part that is within', within(1), met/30.0_dp, absolute=1e-12_dp)
    within = accepted%all_of('as_built_summary.within_class')
    call check_close(t, 'all are accepted', within(1), 1.0_dp, absolute=0.0_dp)
  end subroutine inspected_again

  !> Gears without errors are nominal: so are their dynamic factors and their root stress, of each relief at the speed of its own
  !> largest dynamic factor.
  subroutine stress_of_each_relief(t)
    type(tally_t), intent(inout) :: t
    type(answer_t) :: answer
    real(dp), allocatable :: nominal(:), own(:), rpm(:)
    integer :: i

    call ask(t, '&case tasks = ''as_built'' / &pair module_mm = 3, face_width_mm = 20 / &pinion teeth = 21 / '// &
             '&gear teeth = 34 / '// &
             '&load torque_nm = 100 / &relief amount_um = 0, 8, 16 / &mesh model = ''weber'' / '// &
             '&sweep rpm_first = 3000, rpm_last = 18000, rpm_step = 1500 / &as_built with_root_stress = .true. / '// &
             '&deviations pinion_runout_um = 0, pinion_runout_phase_deg = 0 /', answer)
    rpm = answer%all_of('as_built_worst.rpm')
    call check_true(t, 'largest at different speeds', size(rpm) == 3 .and. maxval(rpm) > minval(rpm) + 1, str(maxval(rpm)))
    do i = 1, 2
      own = answer%all_of('as_built_worst.'//trim(merge('pinion', 'gear  ', i == 1))//'_root_stress_mpa')
      nominal = answer%all_of('as_built_worst.nominal_'//trim(merge('pinion', 'gear  ', i == 1))//'_root_stress_mpa')
      call check_true(t, 'root stress of each relief', size(own) == 3 .and. all(abs(own - nominal) < 1e-4_dp*own))
    end do
    ! Nor have they another dynamic factor, each to the tolerance of the case.
    own = answer%all_of('as_built_worst.dynamic_factor')
    nominal = answer%all_of('as_built_worst.nominal_factor')
    call check_true(t, 'different factors', size(own) == 3 .and. maxval(own) > minval(own) + 0.01_dp)
    call check_true(t, 'nominal factor of each relief', all(abs(own - nominal) < 2e-6_dp*own))
    call check_true(t, 'and in the summary', all(abs(own - answer%all_of('as_built_summary.nominal_factor')) < 2e-6_dp*own))
    call check_true(t, 'and at each speed', all(abs(answer%all_of('as_built.dynamic_factor') - &
                                                    answer%all_of('as_built.nominal_factor')) < 2e-6_dp*maxval(own)))
  end subroutine stress_of_each_relief

  !> The pair of gears and the assembly that are followed are those that are asked for: the largest load of their turn is their
  !> largest dynamic factor, and the summary names those with the largest of all.
  subroutine followed(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: draws = 3, assemblies = 5
    type(answer_t) :: answer
    real(dp), allocatable :: factor(:), largest(:)
    integer, allocatable :: tooth(:)
    integer :: a, best, draw, k, worst

    do k = 1, 2
      call ask(t, '&case tasks = ''as_built'' / &pair module_mm = 3, face_width_mm = 20 / &pinion teeth = 20 / '// &
               '&gear teeth = 25 / &load torque_nm = 100 / &mesh model = ''iso6336'' / &as_built rpm = 9000, turn_draw = '// &
               str(4 - k)// &
               ', turn_assembly = '//str(2*k)//' / &deviations pinion_class = 7, gear_class = 7, draws = '//str(draws)// &
               ', assembly = ''all'', pinion_wave_order = 13, pinion_wave_um = 1, pinion_wave_phase_deg = 0 /', answer)
      factor = answer%all_of('as_built_worst.dynamic_factor')
      call check_true(t, 'pairs of gears and assemblies', size(factor) == draws*assemblies)
      ! The least common multiple of the numbers of teeth.
      call check_true(t, 'until the same teeth meet', all(nint(answer%all_of('as_built.mesh_periods')) == 100))
      largest = answer%all_of('as_built_loads.load_ratio')
      ! Each to the tolerance of the case.
      call check_close(t, 'the pair of gears that is followed', maxval(largest), factor(assemblies*(3 - k) + 2*k), 1e-6_dp)
      ! Teeth that meet differ by what the first ones do, and a multiple of what both numbers of teeth have in common.
      tooth = nint(answer%all_of('as_built_worst.gear_tooth') - answer%all_of('as_built_worst.pinion_tooth') - &
                   answer%all_of('as_built_worst.first_gear_tooth')) + 1
      call check_true(t, 'teeth that meet', size(tooth) == draws*assemblies .and. all(modulo(tooth, assemblies) == 0))
      tooth = nint(answer%all_of('as_built_worst.first_gear_tooth'))
      call check_true(t, 'first tooth of the gear', all(tooth == [((a, a=1, assemblies), draw=1, draws)]))
      ! The first pair of the turn that is followed enters with the first teeth of its assembly; teeth of a pair count alike.
      tooth = nint(answer%all_of('as_built_loads.gear_tooth'))
      call check_true(t, 'teeth of the turn', tooth(1) == 2*k .and. all(modulo(tooth - 2*k - &
                      nint(answer%all_of('as_built_loads.pinion_tooth')) + 1, assemblies) == 0))
    end do
    worst = maxloc(factor, 1) - 1
    best = minloc(factor, 1) - 1
    call check_close(t, 'worst pair of gears', answer%one('as_built_summary.worst_draw'), 1.0_dp + worst/assemblies)
    call check_close(t, 'worst assembly', answer%one('as_built_summary.worst_assembly'), 1.0_dp + modulo(worst, assemblies))
    call check_close(t, 'best pair of gears', answer%one('as_built_summary.best_draw'), 1.0_dp + best/assemblies)
    call check_close(t, 'best assembly', answer%one('as_built_summary.best_assembly'), 1.0_dp + modulo(best, assemblies))
    call summarised(t)
  end subroutine followed

  !> The distribution in the summary is that of the largest dynamic factor of each pair of gears over the speeds, and its speed that
  !> of the largest of all: order statistics of the points, the quantile between two of them in proportion.
  subroutine summarised(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: draws = 5, speeds = 6
    type(answer_t) :: answer
    real(dp), allocatable :: rpm(:)
    real(dp) :: factor(speeds, draws), largest(draws)
    integer :: at(2)

    call ask(t, '&case tasks = ''as_built'' / &pair module_mm = 3, face_width_mm = 20 / &pinion teeth = 20 / '// &
             '&gear teeth = 25 / &load torque_nm = 100 / &mesh model = ''iso6336'' / '// &
             '&sweep rpm_first = 3000, rpm_last = 18000, rpm_step = 3000 / '// &
             '&deviations pinion_class = 7, gear_class = 7, draws = '//str(draws)//' /', answer)
    factor = reshape(answer%all_of('as_built.dynamic_factor'), [speeds, draws])
    rpm = answer%all_of('as_built.rpm')
    largest = sorted(maxval(factor, 1))
    at = maxloc(factor)
    call check_close(t, 'speed of the largest', answer%one('as_built_summary.rpm'), rpm(at(1)))
    call check_close(t, 'draw of the largest', answer%one('as_built_summary.worst_draw'), real(at(2), dp))
    call check_close(t, 'least', answer%one('as_built_summary.least_factor'), largest(1))
    call check_close(t, 'median', answer%one('as_built_summary.median_factor'), largest(3))
    call check_close(t, '95th percentile', answer%one('as_built_summary.quantile_95_factor'), 0.2_dp*largest(4) + 0.8_dp*largest(5))
    call check_close(t, 'largest', answer%one('as_built_summary.largest_factor'), largest(5))
    call check_true(t, 'speeds differ', any(abs(answer%all_of('as_built_worst.rpm') - rpm(at(1))) > 1))
  end subroutine summarised

  !> Turns at two speeds have the rows of either speed alone.
  subroutine each_turn(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: pairs = 20
    character(*), parameter :: speeds(*) = [character(10) :: '6000, 9000', '6000', '9000'], &
      columns(*) = [character(10) :: 'load_n', 's', 'gear_tooth']
    type(answer_t) :: answer
    real(dp) :: rows(2*pairs, size(columns), size(speeds))
    integer :: i, k, n

    rows = 0
    do k = 1, size(speeds)
      call ask(t, '&case tasks = ''as_built'' / &pair module_mm = 3, face_width_mm = 20 / &pinion teeth = 20 / '// &
               '&gear teeth = 20 / &load torque_nm = 100 / &mesh model = ''weber'' / &as_built rpm = 3000, turn_rpm = '// &
               trim(speeds(k))//' / &deviations pinion_class = 7, gear_class = 7 /', answer)
      n = merge(2, 1, k == 1)*pairs
      do i = 1, size(columns)
        call check_equal(t, 'rows of '//trim(columns(i)), size(answer%all_of('as_built_loads.'//trim(columns(i)))), n)
        rows(:n, i, k) = answer%all_of('as_built_loads.'//trim(columns(i)))
      end do
    end do
    call check_true(t, 'different places', any(abs(rows(:pairs, 2, 2) - rows(:pairs, 2, 3)) > 1e-3_dp))
    do i = 1, size(columns)
      call check_true(t, 'both speeds: '//trim(columns(i)), &
                      all(abs(rows(:, i, 1) - [rows(:pairs, i, 2), rows(:pairs, i, 3)]) <= 0))
    end do
  end subroutine each_turn

  !> A drawn pair of gears has the same motion where its errors are told by lists, as the table of its teeth has them.
  subroutine told_again(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: design = '&case tasks = ''as_built'' / &pair module_mm = 3, face_width_mm = 20 / &pinion teeth '// &
      '= 20 / &gear teeth = 25 / &load torque_nm = 100 / &mesh model = ''iso6336'' / &as_built rpm = 5000, 9000'
    type(answer_t) :: by_lists, by_class
    real(dp), allocatable :: expected(:)

    call ask(t, design//', turn_draw = 2 / &deviations pinion_class = 7, gear_class = 8, draws = 2 /', by_class)
    ! So counted, teeth engage in the order of their numbers.
    call ask(t, design//' / &deviations'//keys('pinion', 'clockwise', 1, 20)//keys('gear', 'counterclockwise', 21, 45)//' /', &
             by_lists)
    associate (factor => by_lists%all_of('as_built.dynamic_factor'))
      expected = by_class%all_of('as_built.dynamic_factor')
      call check_true(t, 'dynamic factors of errors told again', size(factor) == 2 .and. size(expected) == 4)
      call check_true(t, 'the same', all(abs(factor - expected(3:)) < 1e-9_dp))
    end associate
    associate (error => by_lists%all_of('as_built_turn.transmission_error_um'))
      expected = by_class%all_of('as_built_turn.transmission_error_um')
      call check_close(t, 'their transmission error', maxval(error), maxval(expected), 1e-9_dp)
    end associate

  contains

    !> The keys of one gear, whose rows of the table are these.
    function keys(gear, counting, first, last) result(text)
      character(*), intent(in) :: gear, counting
      integer, intent(in) :: first, last
      character(:), allocatable :: text

      text = ' '//gear//'_counting = '''//counting//''' '//gear//'_flank = ''left'' '//gear//'_tooth = 1 '// &
             gear//'_cumulative_pitch_um ='//numbers('cumulative_pitch_um', first, last)//' '// &
             gear//'_profile_slope_um ='//numbers('profile_slope_um', first, last)//' '// &
             gear//'_runout_um ='//numbers('runout_um', first, first)//' '// &
             gear//'_runout_phase_deg ='//numbers('runout_phase_deg', first, first)
    end function keys

    function numbers(column, first, last) result(text)
      character(*), intent(in) :: column
      integer, intent(in) :: first, last
      character(:), allocatable :: text
      integer :: i

      text = ''
      associate (values => by_class%all_of('as_built_teeth.'//column))
        do i = first, last
          text = text//' '//str(values(i), 17)
        end do
      end associate
    end function numbers
  end subroutine told_again

  !> A speed at which the motion is to be followed, but where none repeats (`sweep` of the same speed says so too): the study is not
  !> complete, and nothing is known of the multiplier.
  subroutine unanswered(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: text = springs//'&pinion teeth = 15, effective_mass_kg = 1 / &gear teeth = 15, '// &
      'effective_mass_kg = 1 / &dynamics damping_ratio = 0.005 / &numerics steps_per_period = 20 / &deviations '// &
      'pinion_runout_um = 50, pinion_runout_phase_deg = 0 / &as_built turn_rpm = 1, rpm = '
    type(answer_t) :: answer
    character(:), allocatable :: screen

    call ask(t, text//'30000 /', answer)
    call check_true(t, 'the speed has an answer', all(answer%all_of('as_built.multiplier') > 0))
    call check_true(t, 'the turn has none', size(answer%all_of('as_built_loads.load_n')) == 0)
    call check_true(t, 'the study tells so', failed_points(answer%study) > 0)
    call write_report(answer%study, screen)
    call check_true(t, 'and the screen', index(screen, 'no motion to follow at a relief of 0 um and 1 1/min: ') > 0)
    call ask(t, text//'1 /', answer)
    call check_true(t, 'no multiplier', all(ieee_is_nan(answer%all_of('as_built.multiplier'))))
  end subroutine unanswered

  !> Without a list, teeth have no numbers of their own: what is told of their counting is named as not used, and changes nothing.
  subroutine not_counted(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: text = springs//'&pinion teeth = 9, effective_mass_kg = 1 / &gear teeth = 6, '// &
      'effective_mass_kg = 1 / &as_built rpm = 3000 / &deviations pinion_runout_um = 5, pinion_runout_phase_deg = 0'
    type(answer_t) :: answer
    integer :: k

    call ask(t, text//', pinion_profile_slope_um = 4, gear_profile_form_um = -2 /', answer)
    call check_true(t, 'one slope for all teeth of the pinion', all(abs(answer%all_of('as_built_teeth.profile_slope_um') - &
                                                                        [(4, k=1, 9), (0, k=1, 6)]) < 1e-9_dp))
    call check_true(t, 'one form for all teeth of the gear', all(abs(answer%all_of('as_built_teeth.profile_form_um') - &
                                                                     [(0, k=1, 9), (-2, k=1, 6)]) < 1e-9_dp))
    call ask(t, text//', pinion_tooth = 30, pinion_counting = ''clockwise'', pinion_flank = ''right'' /', answer)
    call check_true(t, 'teeth in the order of engagement', all(nint(answer%all_of('as_built_loads.pinion_tooth')) == &
                                                               [1, 2, 3, 4, 5, 6, 7, 8, 9]))
  end subroutine not_counted

  !> Where a profile slope is measured from, on a prescribed mesh: with the pitch point moved by so many base pitches, all flanks
  !> are out of place by the slope times this over the path of contact, and the transmission error with them.
  subroutine measuring_point(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: ratio = 1.6_dp, slope_um = 20, point(2) = [0.3_dp, 0.7_dp]
    type(answer_t) :: answer
    real(dp) :: factor(2), mean(2)
    integer :: k

    do k = 1, 2
      call ask(t, '&case tasks = ''as_built'' / &pinion teeth = 25, effective_mass_kg = 0.8 / &gear teeth = 30, '// &
               'effective_mass_kg = 0.8 / &load normal_force_n = 7000 / &mesh model = ''polynomial'', contact_ratio = '// &
               str(ratio)//', coefficients = 400, 0, -120, pitch_point = '//str(point(k))//' / &as_built rpm = 9000 / '// &
               '&deviations pinion_profile_slope_um = '//str(slope_um)//' /', answer)
      factor(k) = answer%one('as_built.dynamic_factor')
      associate (error => answer%all_of('as_built_turn.transmission_error_um'))
        mean(k) = error(1)
      end associate
    end do
    call check_close(t, 'a slope measured elsewhere', mean(2) - mean(1), slope_um*(point(2) - point(1))/ratio, 1e-9_dp)
    call check_close(t, 'moves no load', factor(2), factor(1), 1e-9_dp)
  end subroutine measuring_point

  !> Where no motion of the sample has an answer, the quick way's error is not known, and 0 must not be told.
  subroutine unknown_sample(t)
    type(tally_t), intent(inout) :: t
    type(answer_t) :: answer
    real(dp), allocatable :: factor(:)
    real(dp) :: sample_error

    call ask(t, '&case tasks = ''as_built'' / &pair module_mm = 3, face_width_mm = 20 / &pinion teeth = 25 / '// &
             '&gear teeth = 25 / &load torque_nm = 40 / &dynamics damping_ratio = 0.035 / &relief amount_um = 0 / '// &
             '&as_built rpm = 6000, quick = .true. / &deviations pinion_class = 8, gear_class = 8, draws = 3, seed = 4 /', answer)
    factor = answer%all_of('as_built.dynamic_factor')
    sample_error = answer%one('as_built_summary.sample_error')
    call check_true(t, 'error of a sample without an answer', ieee_is_nan(sample_error) .eqv. ieee_is_nan(factor(1)), &
                    str(sample_error))
  end subroutine unknown_sample

  !> One clear error each.
  subroutine refused(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: counted = ', pinion_counting = ''clockwise'', pinion_flank = ''right'', pinion_tooth = 1'

    call refuse('pinion_class = 12', 'pinion_class = 12')
    call refuse('pinion_class = 0', 'pinion_class = 0')
    call refuse('pinion_single_pitch_um = 6*0', 'pinion_counting: missing')
    call refuse('pinion_single_pitch_um = 5*0'//counted, 'pinion_single_pitch_um: numbers given: 5; must have one for each '// &
      'of 6 teeth')
    call refuse('pinion_single_pitch_um = 5*0, 3'//counted, 'add up to 3 um')
    call refuse('pinion_profile_slope_um = 1, 2'//counted, 'pinion_profile_slope_um: numbers given: 2')
    call refuse('pinion_cumulative_pitch_um = 6*0, pinion_counting = ''clockwise'', pinion_tooth = 1', 'pinion_flank: missing')
    call refuse('pinion_cumulative_pitch_um = 6*0, pinion_counting = ''clockwise'', '// &
                'pinion_flank = ''right'', pinion_tooth = 7', 'pinion_tooth = 7')
    call refuse('pinion_wave_order = 3, pinion_wave_um = 1', 'pinion_wave_phase_deg: missing')
    call refuse('pinion_wave_order = 3, pinion_wave_um = 1, pinion_wave_phase_deg = 1, 2', 'pinion_wave_phase_deg: numbers '// &
      'given: 2')
    call refuse('pinion_wave_order = 2.5, pinion_wave_um = 1, pinion_wave_phase_deg = 1', 'pinion_wave_order = 2.5')
    call refuse('pinion_runout_um = 9', 'pinion_runout_phase_deg: missing')
    call refuse('gear_class = 6, gear_runout_um = 9, gear_runout_phase_deg = 0', 'gear_runout_um')
    call refuse('gear_class = 6, assembly = ''some''', 'assembly = ''some''')
    call refuse('gear_class = 6 / &numerics method = ''rk4''', '&numerics method')
    call refuse('', '&deviations: tells of no deviation of either gear')
    call refuse('draws = 3', '&deviations: tells of no deviation of either gear')
    call refuse('pinion_wave_um = 2, pinion_wave_phase_deg = 0', '&deviations: tells of no deviation of either gear')
    call refuse('gear_class = 6, draws = 2 / &as_built turn_draw = 3', 'turn_draw = 3: must be at most &deviations draws, 2')
    call refuse('gear_class = 6, pinion_class = 6, assembly = ''all'' / &as_built turn_assembly = 7', &
                'turn_assembly = 7: must be at most the number of assemblies, 6')
    call refuse('gear_class = 6, assembly = ''all'' / &as_built quick = .true.', '&as_built quick: does not go with a single pair')

  contains

    subroutine refuse(keys, words)
      character(*), intent(in) :: keys, words
      character(*), parameter :: rest = '&case tasks = ''as_built'' / &pair module_mm = 3, face_width_mm = 20 / &pinion '// &
        'teeth = 6, profile_shift = 0.6 / &gear teeth = 30 / &load torque_nm = 50 / &mesh model = ''iso6336'' / '// &
        '&sweep rpm_first = 1000, rpm_last = 1000, rpm_step = 1000 / '

      call check_contains(t, keys, refusal(rest//'&deviations '//keys//' /'), words)
    end subroutine refuse
  end subroutine refused

  !> Files of known slopes, parabolas and constants for both flanks give the motion that the lists of these give; the constants do
  !> not count. Eight points over 80 % of the path, with a part beside that no polynomial up to the sixth degree has: alternating
  !> binomial coefficients, whose squares add up to the middle one of the next row but six.
  subroutine measured_flanks(t)
    type(tally_t), intent(inout) :: t
    type(answer_t) :: by_lists, by_file
    character(:), allocatable :: folder, name, lists, file
    logical :: ascends
    integer :: flank, i, k

    folder = new_folder()
    do i = 1, 2
      call write_file(folder//'/'//trim(gears(i))//'.csv', points_of(i, 0.02_dp))
    end do
    do k = 1, 2
      ascends = k == 1
      lists = keys_of(ascends, [5, 30])
      file = lists
      do i = 1, 2
        name = trim(gears(i))
        flank = merge(1, 2, ascends .eqv. i == 1)
        lists = lists//name//'_profile_slope_um ='//list(i, flank, 1)//name//'_profile_form_um ='//list(i, flank, 2)
        file = file//name//'_flanks_file = '''//name//'.csv'' '//name//'_cumulative_pitch_um ='//list(i, flank, 3)
      end do
      call ask_in(t, folder, lists, by_lists)
      call ask_in(t, folder, file, by_file)
      call check_close(t, 'dynamic factor by files', by_file%one('as_built.dynamic_factor'), &
                       by_lists%one('as_built.dynamic_factor'), absolute=1e-9_dp)
      call check_true(t, 'the deviations count', abs(by_file%one('as_built.dynamic_factor') - &
                                                     by_file%one('as_built.nominal_factor')) > 0.01_dp)
      call check_close(t, 'transmission error by files', by_file%one('as_built.dte_rms_um'), by_lists%one('as_built.dte_rms_um'), &
                       absolute=1e-8_dp)
      call check_true(t, 'largest loads by files', all(abs(by_file%all_of('as_built_loads.load_ratio') - &
                                                           by_lists%all_of('as_built_loads.load_ratio')) < 1e-8_dp))
      ! 0.02 um times the root of 3432/8.
      do i = 1, 2
        call check_true(t, 'what is left of the points', index(by_file%study%log, 'leave 0.414 um (root mean square) of '// &
                                                               trim(gears(i))//'_flanks_file') > 0, by_file%study%log)
      end do
    end do
    call remove_folder(folder)

  contains

    !> Slope, form, or the pitch by which the form of the list, whose mean is 0, differs from that of the file, which is 0 at the
    !> pitch point.
    function list(gear, flank, what) result(words)
      integer, intent(in) :: gear, flank, what
      character(:), allocatable :: words
      real(dp) :: values(3), shift
      integer :: tooth

      words = ''
      do tooth = 1, teeth(gear)
        values(:2) = [slope(gear, flank, tooth), form(gear, flank, tooth)]
        shift = values(2)*(2/3.0_dp - 4*pitch_point*(1 - pitch_point))/cos(angle)
        values(3) = merge(1, -1, ascends)*merge(1, -1, gear == 1)*shift
        words = words//' '//str(values(what), 17)
      end do
      words = words//new_line('a')
    end function list
  end subroutine measured_flanks

  pure real(dp) function slope(gear, flank, tooth)
    integer, intent(in) :: gear, flank, tooth

    slope = 4*sin(1.3_dp*tooth + 2*flank + gear)
  end function slope

  pure real(dp) function form(gear, flank, tooth)
    integer, intent(in) :: gear, flank, tooth

    form = 3*cos(0.7_dp*tooth + flank - gear)
  end function form

  !> The file of a gear, with `more` um beside the polynomials, tooth after tooth against the order of the numbers.
  function points_of(gear, more) result(text)
    integer, intent(in) :: gear
    real(dp), intent(in) :: more
    character(:), allocatable :: text
    integer :: flank, tooth, k

    text = '# measured'//new_line('a')//new_line('a')//'tooth,flank,roll_mm,deviation_um'//new_line('a')
    do tooth = teeth(gear), 1, -1
      do k = 0, 7
        do flank = 1, 2
          text = text//point(gear, flank, tooth, k, 0.1_dp + 0.8_dp*k/7, more)
        end do
      end do
    end do
  end function points_of

  !> A row: point number k, from 0, at the part u of the path.
  function point(gear, flank, tooth, k, u, more) result(row)
    integer, intent(in) :: gear, flank, tooth, k
    real(dp), intent(in) :: u, more
    integer, parameter :: binomial(0:7) = [1, -7, 21, -35, 35, -21, 7, -1]
    character(:), allocatable :: row
    real(dp) :: roll, deviation

    roll = roll_a + u*(roll_e - roll_a)
    if (gear == 2) roll = between*sin(angle) - roll
    ! The tip of the pinion is at E.
    deviation = merge(1, -1, gear == 1)*slope(gear, flank, tooth)*(u - pitch_point) + &
                form(gear, flank, tooth)*4*u*(1 - u) + tooth + more*binomial(k)
    row = str(tooth)//', '//trim(merge('left ', 'right', flank == 1))//', '//str(roll, 17)//', '//str(deviation, 17)//new_line('a')
  end function point

  subroutine write_file(path, text)
    character(*), intent(in) :: path, text
    integer :: unit

    open (newunit=unit, file=path, status='replace', action='write', access='stream', form='unformatted')
    write (unit) text
    close (unit)
  end subroutine write_file

  !> How the teeth are counted. The pinion drives: turning counterclockwise it carries on the left.
  function keys_of(ascends, first) result(keys)
    logical, intent(in) :: ascends
    integer, intent(in) :: first(2)
    character(:), allocatable :: keys, name
    integer :: i

    keys = ''
    do i = 1, 2
      name = trim(gears(i))
      keys = keys//name//'_counting = ''clockwise'' '//name//'_flank = '''// &
             trim(merge('left ', 'right', ascends .eqv. i == 1))//''' '//name//'_tooth = '//str(first(i))//' '
    end do
  end function keys_of

  !> A case with these keys of &deviations.
  function case_with(keys, more) result(text)
    character(*), intent(in) :: keys
    character(*), intent(in), optional :: more
    character(:), allocatable :: text

    text = '&case tasks = ''as_built'' / &pair module_mm = 3, face_width_mm = 20 / &load torque_nm = 60 / '// &
           '&mesh model = ''iso6336'', corner_contact = .false. / &as_built rpm = 4000 / &numerics tolerance = 1e-11 / '
    if (.not. present(more)) text = text//'&pinion teeth = 18 / &gear teeth = 36 / '
    if (present(more)) text = text//more
    text = text//'&deviations '//keys//' /'
  end function case_with

  subroutine ask_in(t, folder, keys, answer)
    type(tally_t), intent(inout) :: t
    character(*), intent(in) :: folder, keys
    type(answer_t), intent(out) :: answer
    type(case_t) :: case
    type(error_t), allocatable :: error

    call read_case(case_with(keys), case, error)
    if (.not. allocated(error)) call run_study(case, folder//'/', 1, answer%study, error)
    call check_no_error(t, 'measured flanks', error)
  end subroutine ask_in

  !> What stands in a file is an input: where it changes, nothing is taken over from an earlier study.
  subroutine changed_file(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: taken = 'as_built, taken over'
    type(answer_t) :: first, second, third
    type(case_t) :: case
    type(error_t), allocatable :: error
    character(:), allocatable :: folder, path

    folder = new_folder()
    path = folder//'/pinion.csv'
    call write_file(path, points_of(1, 0.0_dp))
    call read_case(case_with(keys_of(.true., [1, 1])//'pinion_flanks_file = ''pinion.csv'''), case, error)
    call check_true(t, 'counting of a gear without a file or list', index(case%unused, 'gear_counting') > 0, case%unused)
    call run_study(case, folder//'/', 1, first%study, error)
    call check_no_error(t, 'with a file', error)
    call run_study(case, folder//'/', 1, second%study, error, earlier=first%study)
    call check_true(t, 'the same file: taken over', index(second%study%log, 'pinion_flanks_file, taken over') > 0, second%study%log)
    ! Another constant at the end of the row of the last point.
    call write_file(path, points_of(1, 0.0_dp)//'1, left, '//str(roll_a, 9)//', 40'//new_line('a'))
    call run_study(case, folder//'/', 1, third%study, error, earlier=first%study)
    call check_no_error(t, 'another file', error)
    call check_true(t, 'another file: not taken over', index(third%study%log, 'taken over') == 0, third%study%log)
    call check_true(t, 'another file: another motion', abs(third%one('as_built.dynamic_factor') - &
                                                           first%one('as_built.dynamic_factor')) > 1e-3_dp)
    call remove_folder(folder)
  end subroutine changed_file

  !> One clear error each.
  subroutine wrong_files(t)
    type(tally_t), intent(inout) :: t
    character, parameter :: lf = new_line('a')
    character(*), parameter :: header = 'tooth,flank,roll_mm,deviation_um'//lf, given = 'pinion_flanks_file = ''pinion.csv'' '
    character(16), parameter :: counted(3) = [character(16) :: 'pinion_counting', 'pinion_flank', 'pinion_tooth']
    character(:), allocatable :: folder, good, part
    integer :: k

    folder = new_folder()
    good = points_of(1, 0.0_dp)
    call refuse('', ': lacks the line tooth,flank,roll_mm,deviation_um')
    call refuse('# '//header, ': lacks the line tooth,flank,roll_mm,deviation_um')
    call refuse('tooth,flank,roll,deviation'//lf//good, ' line 1: tooth,flank,roll,deviation: must be tooth,flank,'// &
                'roll_mm,deviation_um')
    ! As a spreadsheet may write it.
    call refuse(achar(239)//achar(187)//achar(191)//'tooth, flank, roll_mm, deviation_um'//lf// &
                good(index(good, header) + len(header):)//'1, Left, 9, 1'//lf, '')
    call refuse(header//'1,left,9'//lf, ' line 2: must have four fields: tooth,flank,roll_mm,deviation_um')
    call refuse(header//lf//'1,left,9,1,2'//lf, ' line 3: must have four fields: tooth,flank,roll_mm,deviation_um')
    call refuse(header//'0,left,9,1', ' line 2: tooth = 0: must be a whole number from 1 to 18')
    call refuse(header//'19,right,9,1', ' line 2: tooth = 19: must be a whole number from 1 to 18')
    call refuse(header//'1.5,left,9,1', ' line 2: tooth = 1.5: must be a whole number from 1 to 18')
    call refuse(header//'1,top,9,1', ' line 2: flank = top: must be left or right')
    call refuse(header//'1,left,NaN,1', ' line 2: roll_mm = NaN: must be a number from 0 to 100000')
    call refuse(header//'1,left,-1,1', ' line 2: roll_mm = -1: must be a number from 0 to 100000')
    call refuse(header//'1,right,9,Infinity', ' line 2: deviation_um = Infinity: must be a number from -10000 to 10000')
    call refuse(header//'1,left,9,2e4', ' line 2: deviation_um = 2e4: must be a number from -10000 to 10000')
    call refuse(header//'1,left,9,', ' line 2: deviation_um = : must be a number from -10000 to 10000')
    call refuse(good//achar(7), ' line 292: a control character (code 7)')
    part = 'roll '//str(roll_a, 5)//' to '//str(roll_e, 5)//' mm'
    call refuse(without(7, 8), ': tooth 7: points of this flank on the path of contact, '//part//': 0; must be at least 8')
    call refuse(without(7, 1), ': tooth 7: points of this flank on the path of contact, '//part//': 7; must be at least 8')
    ! Points beyond the path do not count.
    call refuse(without(7, 1)//point(1, 1, 7, 0, 1.01_dp, 0.0_dp), &
                ': tooth 7: points of this flank on the path of contact, '//part//': 7;')
    call refuse(without(7, 1)//point(1, 1, 7, 0, 0.88_dp, 0.0_dp), &
                ': tooth 7: its points reach over 78 % of the path of contact, '//part//'; must be at least 80 %')
    call refuse(without(7, 8)//rows([0.0_dp, 0.1_dp, 0.2_dp, 0.3_dp, 0.55_dp, 0.7_dp, 0.8_dp, 0.9_dp]), &
                ': tooth 7: has no point within roll '//str(roll_a + 0.3_dp*(roll_e - roll_a), 5)//' to '// &
                str(roll_a + 0.55_dp*(roll_e - roll_a), 5)//' mm; a gap must be at most '//str(0.2_dp*(roll_e - roll_a), 4)//' mm')
    ! Five places are the least that there can be.
    call refuse(without(7, 8)//rows([0.1_dp, 0.3_dp, 0.5_dp, 0.5_dp, 0.5_dp, 0.7_dp, 0.9_dp, 0.9_dp]), '')
    call check_contains(t, 'no file', said(keys_of(.true., [1, 1])//'pinion_flanks_file = ''none.csv'''), &
                        'cannot read '//folder//'/none.csv: ')
    call write_file(folder//'/pinion.csv', good)
    do k = 1, size(counted)
      call check_contains(t, 'no '//trim(counted(k)), said(given//pick(k)), trim(counted(k))//': missing')
    end do
    call check_contains(t, 'slope beside a file', said(given//keys_of(.true., [1, 1])//'pinion_profile_slope_um = 1'), &
                        'pinion_profile_slope_um = 1: does not go with pinion_flanks_file; remove one')
    call check_contains(t, 'form beside a file', said(given//keys_of(.true., [1, 1])//'pinion_profile_form_um = 1'), &
                        'pinion_profile_form_um = 1: does not go with pinion_flanks_file; remove one')
    call check_contains(t, 'class beside a file', said(given//keys_of(.true., [1, 1])//'pinion_class = 6'), &
                        'pinion_flanks_file = ''pinion.csv'': does not go with pinion_class; remove one')
    call check_contains(t, 'a prescribed mesh', refusal('&case tasks = ''as_built'' / &mesh contact_ratio = 1.6, '// &
      'model = ''polynomial'', coefficients = 400 / &pinion teeth = 18, effective_mass_kg = 1 / &gear teeth = 36, '// &
      'effective_mass_kg = 1 / &load normal_force_n = 1000 / &as_built rpm = 4000 / &deviations '// &
      given//keys_of(.true., [1, 1])//' /'), 'pinion_flanks_file = ''pinion.csv'': not used by a prescribed mesh')
    call remove_folder(folder)

  contains

    !> The whole message behind the file's name; none for a file that is good.
    subroutine refuse(text, words)
      character(*), intent(in) :: text, words
      character(:), allocatable :: message

      call write_file(folder//'/pinion.csv', text)
      message = said(given//keys_of(.true., [1, 1]))
      if (words == '') call check_true(t, 'a good file', message == '', message)
      if (words /= '') call check_true(t, words//' is told', index(message, folder//'/pinion.csv'//words) == 1, message)
    end subroutine refuse

    function said(keys) result(message)
      character(*), intent(in) :: keys
      character(:), allocatable :: message
      type(case_t) :: case
      type(answer_t) :: answer
      type(error_t), allocatable :: error

      message = ''
      call read_case(case_with(keys), case, error)
      if (.not. allocated(error)) call run_study(case, folder//'/', 1, answer%study, error)
      if (allocated(error)) message = error%message
    end function said

    !> The good file without the last n rows of the left flank of a tooth.
    function without(tooth, n) result(text)
      integer, intent(in) :: tooth, n
      character(:), allocatable :: text, row
      integer :: i, at

      text = good
      do i = 8 - n, 7
        row = lf//point(1, 1, tooth, i, 0.1_dp + 0.8_dp*i/7, 0.0_dp)
        at = index(text, row)
        call check_true(t, 'a row to leave out', at > 0, row)
        text = text(:at)//text(at + len(row):)
      end do
    end function without

    !> Of tooth 7, at these parts of the path.
    function rows(u) result(text)
      real(dp), intent(in) :: u(:)
      character(:), allocatable :: text
      integer :: i

      text = ''
      do i = 1, size(u)
        text = text//point(1, 1, 7, 0, u(i), 0.0_dp)
      end do
    end function rows

    !> The keys of counting of the pinion without one.
    function pick(which) result(keys)
      integer, intent(in) :: which
      character(:), allocatable :: keys

      keys = ''
      if (which /= 1) keys = keys//'pinion_counting = ''clockwise'' '
      if (which /= 2) keys = keys//'pinion_flank = ''left'' '
      if (which /= 3) keys = keys//'pinion_tooth = 1 '
    end function pick
  end subroutine wrong_files

  !> The gear ends below its reference circle, so that the pinion's lies off the path: what is taken off there is what was measured
  !> beside it. Slopes of the file and of the list give the same motion.
  subroutine off_the_path(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: z(2) = [25, 50]
    real(dp), parameter :: r(2) = 1.5_dp*z, tip(2) = r + 3*[1 + 0.6_dp, 0.5_dp - 0.6_dp], b(2) = r*cos(angle), &
                           a = sum(r)*sin(angle) - sqrt(tip(2)**2 - b(2)**2), e = sqrt(tip(1)**2 - b(1)**2), &
                           reference = r(1)*sin(angle)
    character(*), parameter :: given = ' pinion_flanks_file = ''pinion.csv'''
    type(answer_t) :: by_lists, by_file
    type(case_t) :: case
    type(error_t), allocatable :: error
    character(:), allocatable :: folder, list, text

    folder = new_folder()
    call write_slopes(text, list, reference - 0.9_dp)
    call write_file(folder//'/pinion.csv', text)
    call ask_shifted(list, by_lists)
    call check_no_error(t, 'slopes from off the path by a list', error)
    call ask_shifted(given, by_file)
    call check_no_error(t, 'slopes from off the path by a file', error)
    call check_close(t, 'dynamic factor with a measuring circle off the path', by_file%one('as_built.dynamic_factor'), &
                     by_lists%one('as_built.dynamic_factor'), absolute=1e-9_dp)
    call check_true(t, 'slopes from off the path count', abs(by_file%one('as_built.dynamic_factor') - &
                                                            by_file%one('as_built.nominal_factor')) > 0.01_dp)
    call write_slopes(text, list, a)
    call write_file(folder//'/pinion.csv', text)
    call ask_shifted(given, by_file)
    call check_error(t, 'nothing beside the measuring circle', error, &
                     folder//'/pinion.csv: tooth 1: has no points beside the reference circle, roll '//str(reference, 5)//' mm')
    call remove_folder(folder)

  contains

    subroutine ask_shifted(keys, answer)
      character(*), intent(in) :: keys
      type(answer_t), intent(out) :: answer

      call read_case(case_with(keys_of(.true., [3, 1])//keys, '&pinion teeth = 25, profile_shift = 0.6 / '// &
                               '&gear teeth = 50, profile_shift = -0.6, addendum = 0.5 / '), case, error)
      if (.not. allocated(error)) call run_study(case, folder//'/', 1, answer%study, error)
    end subroutine ask_shifted

    !> A slope and a constant of each tooth: points from this roll (mm) on to the tip; the same as a list.
    subroutine write_slopes(text, list, from)
      character(:), allocatable, intent(out) :: text, list
      real(dp), intent(in) :: from
      real(dp) :: roll
      integer :: tooth, k

      text = 'tooth,flank,roll_mm,deviation_um'//new_line('a')
      list = ' pinion_profile_slope_um ='
      do tooth = 1, z(1)
        list = list//' '//str(slope(1, 1, tooth), 17)
        do k = 0, 12
          roll = from + (e - from)*k/12
          text = text//str(tooth)//',left,'//str(roll, 17)//','// &
                 str(slope(1, 1, tooth)*(roll - reference)/(e - a) + tooth, 17)//new_line('a')
        end do
      end do
    end subroutine write_slopes
  end subroutine off_the_path

  subroutine check_contains(t, name, text, words)
    type(tally_t), intent(inout) :: t
    character(*), intent(in) :: name, text, words

    call check_true(t, name//' is refused', index(text, words) > 0, text)
  end subroutine check_contains
end module test_as_built
