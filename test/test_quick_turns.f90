!> Whole turns of gears as built in few long steps: against the motions of the solver written apart (test/reference/as_built.dat),
!> and against the motions to the tolerance.
module test_quick_turns
  use gearsweep_deviations, only: deviations_t, make_deviations, wave_t
  use gearsweep_error, only: error_t
  use gearsweep_error_estimate, only: accuracy_t
  use gearsweep_kinds, only: dp, pi
  use gearsweep_oscillator, only: frequency_ratio, make_oscillator, oscillator_t
  use gearsweep_piecewise, only: polynomial
  use gearsweep_quick_steps, only: lay_maps, lay_steps, quick_maps_t, quick_steps_t
  use gearsweep_quick_sweep, only: quick_motion_t, run_quickly
  use gearsweep_quick_turn, only: follow_quickly, lay_errors
  use gearsweep_refinement, only: levels_t
  use gearsweep_text, only: str
  use gearsweep_turn, only: find_turn, turn_t
  use quantities, only: answer_t, ask, refusal
  use test_as_built, only: given_t, read_given, springs
  use testing, only: check_close, check_true, tally_t
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
    if (t%wants('near_ends')) call near_ends(t)
    if (t%wants('waves')) call waves(t)
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
        call check_true(t, 'found', motion%is_found, one%name)
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
    type(quick_motion_t) :: beside, motion(1)
    real(dp), allocatable :: errors(:, :, :)
    integer :: k

    associate (one => given(2))
      do k = 1, 3
        call lay_steps(nominal(one%osc), one%osc%mesh%deviations%waves, 0.2_dp/2**k, steps)
        call lay_maps(steps, [2*pi/frequency_ratio(steps%osc, one%rpm)], maps)
        if (allocated(errors)) deallocate (errors)
        call lay_errors(steps, one%osc%mesh%deviations, errors)
        beside = quick_motion_t()
        ! A turn from the end of the last one leaves nothing of the transient.
        call follow_quickly(steps, maps, errors, beside, motion)
        beside = motion(1)
        call follow_quickly(steps, maps, errors, beside, motion)
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
    type(deviations_t) :: deviations(3)
    type(quick_motion_t) :: among(40, 3), single(40, 1)
    integer :: i, k

    rpm = [(800*1.08_dp**k, k=1, 40)]
    associate (osc => nominal(given(3)%osc))
      deviations = given(3)%osc%mesh%deviations
      do i = 2, 3
        deviations(i)%pinion = cshift(deviations(i)%pinion, i, 2)
      end do
      call run_quickly(osc, deviations, rpm, 2, c_null_ptr, among)
      do i = 1, 3
        call run_quickly(osc, deviations(i:i), rpm, 1, c_null_ptr, single)
        call check_true(t, 'the same bits', all(same(single(:, 1), among(:, i))))
      end do
    end associate

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
             '&deviations pinion_class = '//str(class)//', gear_class = '//str(class)//', draws = 12 / '
      if (class == 8) text = text//'&dynamics friction = 0.06 / '
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
    end do
  end subroutine by_keys

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
  end subroutine waves

  subroutine refused(t)
    type(tally_t), intent(inout) :: t
    character(:), allocatable :: said

    said = refusal('&case tasks = ''as_built'' / &pair module_mm = 3, face_width_mm = 20 / &pinion teeth = 18 / '// &
                   '&gear teeth = 36 / &load torque_nm = 50 / &mesh model = ''iso6336'' / &deviations pinion_class = 6 / '// &
                   '&as_built rpm = 1000, quick = .true. /')
    call check_true(t, 'a single pair is refused', index(said, '&as_built quick') > 0, said)
  end subroutine refused
end module test_quick_turns
