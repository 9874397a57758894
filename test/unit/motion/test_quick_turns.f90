!> Whole turns of gears as built in few long steps: against the motions of the solver written apart (test/reference/as_built.dat),
!> and against the motions to the tolerance.
module test_quick_turns
  use gearsweep_motion_attractors, only: attractors_t, find_attractors, largest_reached
  use gearsweep_motion_attractors, only: attractor_options_t
  use gearsweep_mesh_deviations, only: deviations_t, make_deviations, wave_t
  use gearsweep_base_error, only: error_t
  use gearsweep_motion_error_estimate, only: accuracy_t, levels_t
  use gearsweep_base_kinds, only: dp, pi
  use gearsweep_motion_oscillator, only: frequency_ratio, make_oscillator, oscillator_t
  use gearsweep_base_piecewise, only: polynomial
  use gearsweep_motion_quick_steps, only: lay_maps, lay_steps, quick_maps_t, quick_steps_t
  use gearsweep_motion_quick_turn, only: follow_again, follow_quickly, lay_errors, quick_motion_t, run_quickly
  use gearsweep_base_table, only: table_t
  use gearsweep_api_tables, only: make_table
  use gearsweep_base_text, only: str
  use gearsweep_motion_response, only: find_turn, turn_t
  use test_support_ask_by_name, only: answer_t, ask, refusal
  use test_as_built, only: given_t, read_given, springs
  use test_support_testing, only: check_close, check_true, tally_t
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use, intrinsic :: iso_c_binding, only: c_null_ptr
  implicit none
  private
  public :: run

  real(dp), parameter :: um = 1e-6_dp, told = 1e-3_dp      !< to which dynamic factors are told

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t
    type(given_t), allocatable :: given(:)

    call read_given(given)
    if (t%wants('given_motions')) call given_motions(t, given)
    if (t%wants('order')) call order(t, given)
    if (t%wants('repelling')) call repelling(t, given)
    if (t%wants('alike')) call alike(t)
    if (t%wants('alone')) call alone(t, given)
    if (t%wants('by_keys')) call by_keys(t)
    if (t%wants('estimates')) call estimates(t)
    if (t%wants('near_ends')) call near_ends(t)
    if (t%wants('waves')) call waves(t)
    if (t%wants('several_motions')) call several_motions(t, given)
    if (t%wants('refused')) call refused(t)
  end subroutine run

  !> The nominal teeth of an oscillator.
  type(oscillator_t) function nominal(osc)
    type(oscillator_t), intent(in) :: osc
    type(deviations_t) :: none
    type(error_t), allocatable :: error

    nominal = osc
    nominal%mesh%deviations = none
    call make_oscillator(nominal, error)
  end function nominal

  subroutine given_motions(t, given)
    type(tally_t), intent(inout) :: t
    type(given_t), intent(in) :: given(:)
    type(quick_motion_t) :: found(1, 1)
    integer :: i

    do i = 1, size(given)
      associate (one => given(i), motion => found(1, 1))
        call run_quickly(nominal(one%osc), [one%osc%mesh%deviations], [one%rpm], 1, c_null_ptr, found)
        ! A start leads G5 to a motion that does not repeat after a turn; that speed is for the exact way.
        call check_true(t, 'found', motion%is_found .neqv. one%name == 'G5', one%name)
        call check_close(t, 'dynamic factor '//one%name, motion%peak/one%osc%load, one%dynamic_factor, absolute=told)
        call check_true(t, 'where the largest load is', all(modulo(motion%pair, one%osc%mesh%teeth) == one%tooth), one%name)
        call check_close(t, 'least transmission error', motion%least, um*one%least, absolute=told*um*one%range)
        call check_close(t, 'largest transmission error', motion%largest, um*one%largest, absolute=told*um*one%range)
      end associate
    end do
  end subroutine given_motions

  !> With all pairs in contact the motion at tau = 0 comes nearer to the given one by 2**3 at least as the steps are halved.
  subroutine order(t, given)
    type(tally_t), intent(inout) :: t
    type(given_t), intent(in) :: given(:)
    real(dp) :: off(3)
    type(quick_steps_t) :: steps
    type(quick_maps_t) :: maps
    type(quick_motion_t) :: motion(1)
    real(dp), allocatable :: apart(:), errors(:, :, :)
    integer :: k

    associate (one => given(2))
      apart = spread(-huge(1.0_dp), 1, one%periods)
      do k = 1, 3
        call lay_steps(nominal(one%osc), one%osc%mesh%deviations%waves, 0.2_dp/2**k, steps)
        call lay_maps(steps, [2*pi/frequency_ratio(steps%osc, one%rpm)], maps)
        if (allocated(errors)) deallocate (errors)
        call lay_errors(steps, one%osc%mesh%deviations, errors)
        ! A turn from the end of the last one leaves nothing of the transient.
        call follow_quickly(steps, maps, errors, apart, motion)
        call follow_again(steps, maps, errors, apart, motion)
        off(k) = abs(motion(1)%begin(1)/um - one%state(1))
      end do
    end associate
    call check_true(t, 'error of the halved steps', off(2) < off(1)/8 .and. off(3) < off(2)/8, &
                    str(off(1))//' '//str(off(2))//' '//str(off(3)))
  end subroutine order

  !> Where the motion of a turn repels, none is told.
  subroutine repelling(t, given)
    type(tally_t), intent(inout) :: t
    type(given_t), intent(in) :: given(:)
    type(oscillator_t) :: osc
    type(quick_motion_t) :: found(1, 1)

    osc = given(5)%osc
    osc%damping_ratio = 0.05_dp
    call run_quickly(nominal(osc), [osc%mesh%deviations], [11000.0_dp], 1, c_null_ptr, found)
    call check_true(t, 'no motion that repels', .not. found(1, 1)%is_found)
  end subroutine repelling

  !> All teeth with the same polynomial, with friction and a compliance that pairs share: the motion to the tolerance of a nominal
  !> mesh with that as its profile error.
  subroutine alike(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: ratio = 1.7_dp, rpm(3) = [5200.0_dp, 9100.0_dp, 13700.0_dp], c(0:2) = [3.0_dp, -4.0_dp, 9.0_dp]*um
    type(accuracy_t) :: options
    type(error_t), allocatable :: error
    type(levels_t), allocatable :: levels
    type(oscillator_t) :: expected, osc
    type(quick_motion_t) :: found(3, 1)
    type(turn_t) :: turn
    integer :: i

    osc%mesh%contact_ratio = ratio
    osc%mesh%reach = [0.0_dp, ratio]
    osc%mesh%teeth = [12, 18]
    osc%mesh%pitch_point = 0.9_dp
    osc%mesh%tan_angle = 0.36_dp
    osc%mesh%stiffness = polynomial(0.0_dp, ratio, [3e8_dp, 2e7_dp, -9e7_dp])
    osc%mesh%disc%shared = 4e-10_dp
    osc%mass = [0.6_dp, 0.9_dp]
    osc%load = 2500
    osc%damping_ratio = 0.06_dp
    osc%friction = 0.07_dp
    expected = osc
    expected%mesh%profile_error = polynomial(0.0_dp, ratio, c*[1.0_dp, ratio/2, (ratio/2)**2])
    call make_oscillator(expected, error)
    osc%mesh%profile_error = polynomial(0.0_dp, ratio, [0.0_dp])
    call run_quickly(nominal(osc), [make_deviations([12, 18], spread(c*[2, 0, 1], 2, 12), spread(c*[-1, 1, 0], 2, 18), &
                                                    [wave_t ::], 5)], rpm, 1, c_null_ptr, found)
    allocate (levels)
    do i = 1, size(rpm)
      call find_turn(expected, rpm(i), options, levels, turn)
      call check_true(t, 'found', found(i, 1)%is_found)
      call check_close(t, 'dynamic factor of teeth that are alike', found(i, 1)%peak/osc%load, turn%point%dynamic_factor, &
                       absolute=told)
    end do
  end subroutine alike

  !> Gears by themselves, and by one thread: the same bits as among others, and by two.
  subroutine alone(t, given)
    type(tally_t), intent(inout) :: t
    type(given_t), intent(in) :: given(:)
    real(dp) :: rpm(40)
    type(oscillator_t) :: osc
    type(deviations_t) :: deviations(3)
    type(quick_motion_t) :: among(40, 3), single(40, 1)
    integer :: i, k

    rpm = [(800*1.08_dp**k, k=1, 40)]
    osc = nominal(given(3)%osc)
    deviations = given(3)%osc%mesh%deviations
    do i = 2, 3
      deviations(i)%pinion = cshift(deviations(i)%pinion, i, 2)
    end do
    call run_quickly(osc, deviations, rpm, 2, c_null_ptr, among)
    do i = 1, 3
      call run_quickly(osc, deviations(i:i), rpm, 1, c_null_ptr, single)
      call check_true(t, 'the same bits', all(same(single(:, 1), among(:, i))))
    end do

  contains

    elemental logical function same(a, b)
      type(quick_motion_t), intent(in) :: a, b

      same = a%is_found .and. b%is_found .and. a%pair == b%pair .and. .not. abs(a%peak - b%peak) > 0 .and. &
             .not. abs(a%place - b%place) > 0 .and. .not. abs(a%largest - b%largest) > 0
    end function same
  end subroutine alone

  !> By keys, with contact beyond A and E and teeth that share compliance, in class 8 with friction and teeth that strike: each
  !> dynamic factor within 1e-3 of that to the tolerance, and the sample tells so, the range of the transmission error within 2e-3
  !> of itself; what is in the sample to the same bits.
  subroutine by_keys(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: quick = '&as_built quick = .true. / '
    type(answer_t) :: exact, found
    real(dp), allocatable :: off(:)
    character(:), allocatable :: text
    integer :: class

    do class = 5, 8, 3
      text = '&case tasks = ''as_built'' / &pair module_mm = 3, face_width_mm = 20 / &pinion teeth = 20 / &gear teeth = 20 / '// &
             '&load torque_nm = 100 / &relief amount_um = 0, 8 / &sweep rpm_first = 2000, rpm_last = 16000, rpm_step = 2000 / '// &
             '&deviations pinion_class = '//str(class)//', gear_class = '//str(class)//', draws = 12 / '// &
             '&section teeth = 3 / &dynamics damping_ratio = 0.17'
      if (class == 8) text = text//', friction = 0.06'
      text = text//' / '
      call ask(t, text, exact)
      call ask(t, text//quick, found)
      off = abs(found%all_of('as_built.dynamic_factor') - exact%all_of('as_built.dynamic_factor'))
      call check_true(t, 'dynamic factors', size(off) == 192 .and. maxval(off) < told, str(maxval(off)))
      call check_true(t, 'told by the sample', maxval(found%all_of('as_built_summary.sample_error')) < told .and. &
                      minval(found%all_of('as_built_summary.sample_error')) > 1e-6_dp)
      call check_true(t, 'the sample is to the tolerance', all(off(:8) < 1e-12_dp))
      call check_true(t, 'the others are not', count(off > 1e-6_dp) > 50)
      off = abs(found%all_of('as_built_summary.median_factor') - exact%all_of('as_built_summary.median_factor'))
      call check_true(t, 'median', maxval(off) < told, str(maxval(off)))
      off = abs(found%all_of('as_built.dte_peak_to_peak_um')/exact%all_of('as_built.dte_peak_to_peak_um') - 1)
      call check_true(t, 'transmission error', maxval(off) < 2*told, str(maxval(off)))
      ! The sample itself is to the tolerance.
      off = abs(found%all_of('as_built.dte_peak_to_peak_um') - exact%all_of('as_built.dte_peak_to_peak_um'))
      associate (estimate => found%all_of('as_built.dte_error_estimate_um'))
        call check_true(t, 'estimate of the transmission error', count(off > estimate) < 2 .and. maxval(estimate(:8)) < 0.05_dp &
                        .and. maxval(estimate/found%all_of('as_built.dte_peak_to_peak_um')) < 5e-3_dp, &
                        str(maxval(off/estimate))//' '//str(maxval(estimate)))
      end associate
    end do
  end subroutine by_keys

  !> With and without relief, in classes 6 and 8, with flanks that part: of the points out of the sample at most one in 200 is off
  !> by more than twice its estimate, and none that is `ok` by more than 1e-3; nor is any `ok` whose estimate is above: what is
  !> found quickly, and has no multiplier, is `inexact` there.
  subroutine estimates(t)
    type(tally_t), intent(inout) :: t
    type(answer_t) :: exact, found
    real(dp), allocatable :: estimate(:), off(:)
    character(:), allocatable :: text
    logical, allocatable :: is_inexact(:), is_ok(:), is_quick(:), out(:)
    type(table_t) :: table
    type(error_t), allocatable :: error
    integer :: above, class, i, inexact, points

    above = 0
    inexact = 0
    points = 0
    do class = 6, 8, 2
      text = '&case tasks = ''as_built'' / &pair module_mm = 3, face_width_mm = 20 / &pinion teeth = 20 / &gear teeth = 20 / '// &
             '&load torque_nm = 60 / &relief amount_um = 0, 10 / &dynamics damping_ratio = 0.1 / '// &
             '&sweep rpm_first = 3000, rpm_last = 20000, rpm_step = 1000 / &deviations pinion_class = '//str(class)// &
             ', gear_class = '//str(class)//', draws = 12 / '
      call ask(t, text, exact)
      call ask(t, text//'&as_built quick = .true. / ', found)
      off = abs(found%all_of('as_built.dynamic_factor') - exact%all_of('as_built.dynamic_factor'))
      estimate = found%all_of('as_built.error_estimate')
      call make_table(found%study, 'as_built', table, error)
      is_ok = [(table%word('status', i) == 'ok', i=1, size(off))]
      is_inexact = [(table%word('status', i) == 'inexact', i=1, size(off))]
      is_quick = ieee_is_nan(found%all_of('as_built.multiplier')) .and. (is_ok .or. is_inexact)
      out = off > 0
      points = points + count(out)
      above = above + count(out .and. .not. off <= 2*estimate)
      call check_true(t, 'ok to 1e-3', .not. any(is_ok .and. off > told), str(maxval(off, mask=is_ok)))
      call check_true(t, 'the others are not ok', .not. any(is_ok .and. estimate > told) .and. count(is_ok) > 100)
      call check_true(t, 'inexact above 1e-3 alone', all((estimate > told .eqv. is_inexact) .or. .not. is_quick))
      inexact = inexact + count(is_quick .and. estimate > told .and. estimate < 2e-2_dp)
    end do
    call check_true(t, 'some are between 1e-3 and 2e-2', inexact > 0)
    call check_true(t, 'above twice the estimate', points > 400 .and. 200*above <= points, str(above)//' of '//str(points))
  end subroutine estimates

  !> Without relief and in class 8, loads that are largest shortly before the end of a step, where the parabola through three loads
  !> still rises: within 1e-3 of those to the tolerance, at all speeds side by side.
  subroutine near_ends(t)
    type(tally_t), intent(inout) :: t
    type(answer_t) :: exact, found
    real(dp), allocatable :: off(:)
    character(:), allocatable :: text

    text = '&case tasks = ''as_built'' / &pair module_mm = 3, face_width_mm = 20 / &pinion teeth = 20 / &gear teeth = 20 / '// &
           '&load torque_nm = 100 / &relief amount_um = 0 / &mesh corner_contact = .false. / '// &
           '&sweep rpm_first = 2500, rpm_last = 4000, rpm_step = 100 / '// &
           '&deviations pinion_class = 8, gear_class = 8, draws = 12 / '
    call ask(t, text, exact)
    call ask(t, text//'&as_built quick = .true. / ', found)
    off = abs(found%all_of('as_built.dynamic_factor') - exact%all_of('as_built.dynamic_factor'))
    call check_true(t, 'loads near the ends of steps', size(off) == 192 .and. maxval(off) < told, str(maxval(off)))
  end subroutine near_ends

  !> Waves of which seven pass in a mesh period: within 1e-3 of the motions to the tolerance.
  subroutine waves(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: text = springs//'&pinion teeth = 20, effective_mass_kg = 1 / &gear teeth = 20, '// &
      'effective_mass_kg = 1 / &dynamics damping_ratio = 0.1 / &deviations pinion_wave_order = 140, pinion_wave_um = 2, '// &
      'pinion_wave_phase_deg = 30, gear_cumulative_pitch_um = 3, 19*0, gear_counting = ''clockwise'', gear_flank = ''left'', '// &
      'gear_tooth = 1, assembly = ''all'' / &as_built rpm = 12000, 20000, 40000'
    type(answer_t) :: exact, found
    real(dp), allocatable :: off(:)

    call ask(t, text//' /', exact)
    call ask(t, text//', quick = .true. /', found)
    off = abs(found%all_of('as_built.dynamic_factor') - exact%all_of('as_built.dynamic_factor'))
    call check_true(t, 'waves', size(off) == 60 .and. maxval(off) < told, str(maxval(off)))
    ! A wave of the gear moves with its teeth from assembly to assembly.
    call ask(t, with_wave(text)//' /', exact)
    call ask(t, with_wave(text)//', quick = .true. /', found)
    off = abs(found%all_of('as_built.dynamic_factor') - exact%all_of('as_built.dynamic_factor'))
    call check_true(t, 'waves of the gear', size(off) == 60 .and. maxval(off) < told, str(maxval(off)))

  contains

    function with_wave(text) result(longer)
      character(*), intent(in) :: text
      character(:), allocatable :: longer
      integer :: at

      at = index(text, 'gear_tooth = 1')
      longer = text(:at - 1)//'gear_wave_order = 3, gear_wave_um = 5, gear_wave_phase_deg = 40, '//text(at:)
    end function with_wave
  end subroutine waves

  !> Where several motions attract, both ways have the one of largest dynamic factor: that of the search of the task `attractors`
  !> from 64 starts, which captures trajectories, and how many there are.
  subroutine several_motions(t, given)
    type(tally_t), intent(inout) :: t
    type(given_t), intent(in) :: given(:)
    real(dp), parameter :: rpm(6) = [8000.0_dp, 9000.0_dp, 10000.0_dp, 11000.0_dp, 12000.0_dp, 13000.0_dp]
    type(attractors_t) :: all_there(size(rpm))
    type(levels_t), allocatable :: levels
    type(oscillator_t) :: osc
    type(quick_motion_t) :: found(size(rpm), 1)
    type(turn_t) :: turn
    type(error_t), allocatable :: error
    integer :: by_both, i, k, several

    several = 0
    by_both = 0
    do i = 1, size(given)
      osc = given(i)%osc
      if (osc%mesh%deviations%periods > 60) cycle
      osc%damping_ratio = 0.07_dp
      call make_oscillator(osc, error)
      call find_attractors(osc, rpm, attractor_options_t(accuracy_t()), all_there)
      call run_quickly(nominal(osc), [osc%mesh%deviations], rpm, 1, c_null_ptr, found)
      allocate (levels)
      do k = 1, size(rpm)
        call find_turn(osc, rpm(k), accuracy_t(), levels, turn)
        call check_close(t, 'the largest of '//given(i)%name, turn%point%dynamic_factor, &
                         largest_reached(all_there(k)), absolute=2e-6_dp)
        call check_true(t, 'how many', turn%point%motions >= size(all_there(k)%motion), str(turn%point%motions))
        if (size(all_there(k)%motion) > 1) several = several + 1
        if (.not. found(k, 1)%is_found) cycle
        by_both = by_both + merge(1, 0, found(k, 1)%motions > 1)
        call check_close(t, 'quickly '//given(i)%name, found(k, 1)%peak/osc%load, turn%point%dynamic_factor, absolute=5*told)
      end do
      deallocate (levels)
    end do
    call check_true(t, 'some have several motions', several > 3 .and. by_both > 1, str(several)//' '//str(by_both))
  end subroutine several_motions

  subroutine refused(t)
    type(tally_t), intent(inout) :: t
    character(:), allocatable :: said

    said = refusal('&case tasks = ''as_built'' / &pair module_mm = 3, face_width_mm = 20 / &pinion teeth = 18 / '// &
                   '&gear teeth = 36 / &load torque_nm = 50 / &mesh model = ''iso6336'' / &deviations pinion_class = 6 / '// &
                   '&as_built rpm = 1000, quick = .true. /')
    call check_true(t, 'a single pair is refused', index(said, '&as_built quick') > 0, said)
  end subroutine refused
end module test_quick_turns
