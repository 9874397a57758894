!> Coast flanks of gears as built: against motions of an integrator written apart (tools/reference/make_coast_flanks.py), against
!> the kinematics of involutes on displaced centres, and what a measurement's zero, numbering and assembly must not change.
module test_coast_flanks
  use gearsweep_mesh_deviations, only: deviations_t, make_deviations, wave_t
  use gearsweep_base_error, only: error_t
  use gearsweep_motion_error_estimate, only: accuracy_t, levels_t
  use gearsweep_mesh_flank_deviations, only: flank_deviations_t, frame_t, place_deviations, make_frame
  use gearsweep_gear_gear, only: coast, drive, gear_spec_t, gear_t, make_gear
  use gearsweep_base_kinds, only: dp, pi
  use gearsweep_motion_oscillator, only: make_oscillator, oscillator_t
  use gearsweep_gear_pair, only: free_centre_distance, make_pair, pair_t
  use gearsweep_base_piecewise, only: piecewise_t, polynomial
  use gearsweep_motion_spectrum, only: find_spectrum, spectrum_t
  use gearsweep_base_text, only: str
  use gearsweep_motion_response, only: find_turn, turn_t
  use test_support_ask_by_name, only: answer_t, ask, refusal
  use test_support_reference_rows, only: next_row
  use test_support_testing, only: check_close, check_no_error, check_true, tally_t
  implicit none
  private
  public :: run

  real(dp), parameter :: um = 1e-6_dp

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t

    if (t%wants('given_motions')) call given_motions(t)
    if (t%wants('eccentric')) call eccentric(t)
    if (t%wants('zero')) call zero(t)
    if (t%wants('shared_by_all')) call shared_by_all(t)
    if (t%wants('quickly')) call quickly(t)
    if (t%wants('prescribed_angle')) call prescribed_angle(t)
  end subroutine run

  !> Dynamic factor, loads of each pair, coast load, least transmission error and state of motions with coast contact.
  subroutine given_motions(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: enough = 1e-7_dp
    type(flank_deviations_t) :: flanks(2)
    type(frame_t) :: frame
    type(oscillator_t) :: osc
    type(turn_t) :: turn
    character(1000) :: name
    real(dp), allocatable :: k(:), late(:), peaks(:)
    real(dp) :: angle, eccentricity, direction, factor, coast_factor, least, rpm, state(2)
    integer :: i, n, offset, unit

    open (newunit=unit, file='test/reference/coast_flanks.dat', status='old', action='read')
    do while (next_row(unit, name))
      osc = oscillator_t(has_backlash=.true.)
      associate (mesh => osc%mesh)
        read (unit, *) mesh%teeth, offset, rpm, mesh%contact_ratio, osc%load, osc%damping_ratio, osc%mass
        read (unit, '(i2)', advance='no') n
        allocate (k(n))
        read (unit, *) k
        read (unit, *) osc%backlash, osc%friction, mesh%disc%shared, angle
        mesh%reach = [0.0_dp, mesh%contact_ratio]
        mesh%stiffness = in_middle(k, mesh%contact_ratio)
        mesh%profile_error = polynomial(0.0_dp, mesh%contact_ratio, [0.0_dp])
        mesh%pitch_point = mesh%contact_ratio/2
        mesh%tan_angle = tan(angle)
        frame = frame_t(between_lines=2*angle)
        flanks = flank_deviations_t()
        do i = 1, 2
          allocate (late(mesh%teeth(i)))
          read (unit, *) late
          flanks(i)%cumulative_pitch = late
          ! From another zero.
          read (unit, *) late
          flanks(i)%coast_pitch = late + 11*um
          read (unit, *) eccentricity, direction
          flanks(i)%runout = 2*eccentricity
          ! Where the centre's direction makes the drive flanks' gap a sine: directions count from the motion of the pitch point to
          ! the gear, against which the pinion turns.
          flanks(i)%runout_phase = merge(1.5_dp*pi - direction + angle, direction - angle + pi/2, i == 1)
          deallocate (late)
        end do
        mesh%deviations = place_deviations(flanks, frame, mesh%teeth, mesh%contact_ratio, offset)
        allocate (peaks(mesh%deviations%periods))
      end associate
      read (unit, *) factor, coast_factor, least, state
      read (unit, *) peaks
      call solve(t, osc, rpm, turn)
      call check_true(t, 'coast flanks touch', turn%point%steady%coast .and. coast_factor > 0, trim(name))
      call check_close(t, 'dynamic factor: '//trim(name), turn%point%dynamic_factor, factor, absolute=enough)
      call check_close(t, 'coast load: '//trim(name), turn%point%steady%coast_peak/osc%load, coast_factor, absolute=enough)
      call check_true(t, 'load of each pair', maxval(abs(turn%load/osc%load - peaks)) < enough, &
                      trim(name)//': '//str(maxval(abs(turn%load/osc%load - peaks))))
      call check_close(t, 'least transmission error', least_of(turn), least, absolute=enough*um)
      call check_close(t, 'state', turn%point%steady%state(1), state(1), absolute=enough*um)
      deallocate (k, peaks)
    end do
    close (unit)
  end subroutine given_motions

  !> A polynomial in s as one over 2 s/ratio - 1.
  function in_middle(k, ratio) result(curve)
    real(dp), intent(in) :: k(:), ratio
    type(piecewise_t) :: curve
    real(dp) :: c(size(k))
    integer :: i, n

    c = k*[((ratio/2)**i, i=0, size(k) - 1)]
    do i = 1, size(k) - 1
      do n = size(k) - 1, i, -1
        c(n) = c(n) + c(n + 1)
      end do
    end do
    curve = polynomial(0.0_dp, ratio, c)
  end function in_middle

  real(dp) function least_of(turn) result(least)
    type(turn_t), intent(in) :: turn
    type(spectrum_t) :: spectrum

    call find_spectrum(turn%left, turn%width, turn%error, 0, spectrum)
    least = spectrum%least
  end function least_of

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

  !> An eccentric gear opens and closes the gaps of drive and coast flanks as involutes on displaced centres do, whose flanks touch
  !> where the length of a line that unwinds from one base circle onto the other says: for small eccentricities, of symmetric and of
  !> asymmetric teeth.
  subroutine eccentric(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: degree = pi/180, small = 1e-8_dp, phase = 0.7_dp
    integer, parameter :: teeth(2) = [21, 34]
    type(error_t), allocatable :: error
    type(flank_deviations_t) :: flanks(2)
    type(deviations_t) :: deviations
    type(gear_t) :: gear(2)
    type(oscillator_t) :: osc
    type(pair_t) :: pair
    real(dp) :: exact(2), w(0:2, 2)
    integer :: asymmetric, i, k

    do asymmetric = 0, 1
      do i = 1, 2
        call make_gear(gear_spec_t(teeth=teeth(i), module=3e-3_dp, face_width=0.02_dp, &
                                   pressure_angle=[20 + 6*asymmetric, 20]*degree, rack_tip_radius=[0.2_dp, 0.2_dp]), gear(i), error)
        call check_no_error(t, 'gear', error)
      end do
      call make_pair(gear(1), gear(2), free_centre_distance(gear(1), gear(2)) + 1e-3_dp, pair, error)
      call check_no_error(t, 'pair', error)
      do i = 1, 2
        flanks = flank_deviations_t()
        flanks(i)%runout = 2*small
        flanks(i)%runout_phase = phase
        deviations = place_deviations(flanks, make_frame(osc%mesh, pair), teeth, 1.5_dp, 0)
        do k = 0, teeth(i) - 1
          w(:, 1) = deviations%wave_at(k, 0.25_dp)
          w(:, 2) = deviations%coast_wave_at(k, 0.25_dp)
          exact = [opened(pair, i, drive, (k + 0.25_dp)*2*pi/teeth(i) + phase), &
                   opened(pair, i, coast, (k + 0.25_dp)*2*pi/teeth(i) + phase)]
          call check_close(t, 'gap of drive flanks', w(0, 1), exact(1), absolute=1e-5_dp*small)
          call check_close(t, 'gap of coast flanks', w(0, 2), exact(2), absolute=1e-5_dp*small)
        end do
      end do
    end do

  contains

    !> By how much an eccentric gear opens the gap on a side (m of transmission error), turned so that it opens that of the drive
    !> flanks by the sine of `turned`. Pinion at the origin, gear above it; the pinion turns counterclockwise.
    real(dp) function opened(pair, gear, side, turned)
      type(pair_t), intent(in) :: pair
      integer, intent(in) :: gear, side
      real(dp), intent(in) :: turned
      real(dp) :: direction, base

      ! Normal of the drive flanks, from pinion to gear, points to 180 degrees less the pressure angle. An eccentric pinion opens
      ! the gap where its centre lies against it, a gear where along it; both are a quarter of a turn before that at the phase 0.
      direction = pi - pair%working_angle(drive)
      if (gear == 1) then
        direction = direction + pi + (turned - pi/2)
      else
        direction = direction - (turned - pi/2)
      end if
      base = sum(pair%gear%base_radius(side))
      opened = unwound(pair%centre_distance, base, merge(-small, small, gear == 1)*[cos(direction), sin(direction)], side)
      opened = opened - unwound(pair%centre_distance, base, [0.0_dp, 0.0_dp], side)
      opened = opened*sum(pair%gear%base_radius(drive))/base
    end function opened

    !> Length that unwinds less the arcs to the points where it begins and ends, with the gear's centre moved.
    real(dp) function unwound(distance, base, moved, side)
      real(dp), intent(in) :: distance, base     ! sum of the base radii
      real(dp), intent(in) :: moved(2)
      integer, intent(in) :: side
      real(dp) :: way(2)

      way = [0.0_dp, distance] + moved
      unwound = sqrt(sum(way**2) - base**2) - base*acos(base/norm2(way)) + &
                merge(1, -1, side == drive)*base*(atan2(way(2), way(1)) - pi/2)
    end function unwound
  end subroutine eccentric

  !> One gear measured from any zero, with any tooth as the first, has one dynamic factor.
  subroutine zero(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: springs = '&case tasks = ''as_built'' / &pair backlash_um = 20 / &pinion teeth = 10, '// &
      'effective_mass_kg = 0.8 / &gear teeth = 10, effective_mass_kg = 0.9 / &load normal_force_n = 3000 / &mesh model = '// &
      '''polynomial'', contact_ratio = 1.6, coefficients = 300 / &dynamics damping_ratio = 0.1 / &sweep rpm_first = 3000, '// &
      'rpm_last = 3000, rpm_step = 100 / &deviations pinion_counting = ''clockwise'', pinion_flank = ''right'', '// &
      'pinion_tooth = 1, pinion_cumulative_pitch_um = 10*'
    character(*), parameter :: gears = '&case tasks = ''as_built'' / &pair module_mm = 3, face_width_mm = 20 / &pinion '// &
      'teeth = 25, thickness_allowance_um = -10 / &gear teeth = 25, thickness_allowance_um = -10 / &load torque_nm = 100 / '// &
      '&mesh model = ''weber'' / &dynamics damping_ratio = 0.17 / &sweep rpm_first = 3000, rpm_last = 3000, rpm_step = 100 / '// &
      '&deviations gear_counting = ''counterclockwise'', gear_flank = ''left'', gear_tooth = '
    type(answer_t) :: answer
    real(dp) :: wave(25), factor(7)
    integer :: i, k

    do i = 1, 3
      call ask(t, springs//str(30*(i - 1))//' /', answer)
      factor(i) = answer%one('as_built.dynamic_factor')
    end do
    call check_close(t, 'nominal, whatever the zero', factor(1), answer%one('as_built.nominal_factor'), absolute=1e-9_dp)
    call check_true(t, 'one for each zero', maxval(abs(factor(2:3) - factor(1))) < 1e-6_dp, str(factor(3)))
    wave = [(20 - 20*cos(2*pi*(k - 1)/25), k=1, 25)]
    do i = 1, 3
      call ask(t, gears//'1, gear_cumulative_pitch_um ='//list(wave - 20*(i - 1))//' /', answer)
      factor(i) = answer%one('as_built.dynamic_factor')
    end do
    do i = 0, 3
      associate (turned => cshift(wave, 6*i))
        call ask(t, gears//str(1 + modulo(-6*i, 25))//', gear_single_pitch_um ='//list(turned - cshift(turned, -1))//' /', answer)
        factor(4 + i) = answer%one('as_built.dynamic_factor')
      end associate
    end do
    call check_true(t, 'one gear, one dynamic factor', maxval(abs(factor - factor(1))) < 2e-6_dp, str(maxval(factor)))

  contains

    function list(values) result(text)
      real(dp), intent(in) :: values(:)
      character(:), allocatable :: text
      integer :: n

      text = ''
      do n = 1, size(values)
        text = text//' '//str(values(n), 12)
      end do
    end function list
  end subroutine zero

  !> What all teeth share changes no load: with friction, shared compliance and contact beyond A and E, in any assembly, while coast
  !> flanks touch. The transmission error moves by it.
  subroutine shared_by_all(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: teeth(2) = [8, 12]
    real(dp), parameter :: none(0:0, 0) = 0, moved(2) = [37*um, -21*um]
    type(turn_t) :: as_stated, turn
    type(oscillator_t) :: osc
    real(dp) :: place(12, 2)
    integer :: i, offset, kind

    place = 1.5_dp*um*reshape([(modulo(5*i, 8) - 3.5_dp, i=1, 12), (0.7_dp*modulo(7*i, 12) - 3, i=1, 12)], [12, 2])
    do kind = 1, 3
      do offset = 0, 1
        osc = oscillator_t(mass=[0.6_dp, 0.8_dp], load=600.0_dp, damping_ratio=0.12_dp, has_backlash=.true., backlash=2*um)
        osc%mesh%teeth = teeth
        osc%mesh%contact_ratio = 1.7_dp
        osc%mesh%reach = [0.0_dp, 1.7_dp]
        osc%mesh%pitch_point = 0.8_dp
        osc%mesh%tan_angle = 0.36_dp
        if (kind == 1) osc%friction = 0.07_dp
        if (kind == 2) osc%mesh%disc%shared = 8e-10_dp
        osc%mesh%stiffness = polynomial(0.0_dp, 1.7_dp, [3e8_dp, 2e7_dp, -9e7_dp])
        osc%mesh%profile_error = polynomial(0.0_dp, 1.7_dp, [0.0_dp])
        if (kind == 3) then
          osc%mesh%reach = [-0.1_dp, 1.8_dp]
          osc%mesh%stiffness = polynomial(-0.1_dp, 1.8_dp, [3e8_dp, 2e7_dp, -9e7_dp])
          osc%mesh%profile_error = polynomial(-0.1_dp, 1.8_dp, [-2*um, 0.0_dp, 6*um])
        end if
        call lay([0.0_dp, 0.0_dp])
        call solve(t, osc, 8000.0_dp, as_stated)
        call check_true(t, 'coast flanks touch', as_stated%point%steady%coast, str(kind))
        call lay(moved)
        call solve(t, osc, 8000.0_dp, turn)
        call check_true(t, 'no load changes', maxval(abs(turn%load - as_stated%load)) < 1e-6_dp*osc%load .and. &
                        abs(turn%point%steady%coast_peak - as_stated%point%steady%coast_peak) < 1e-6_dp*osc%load, &
                        str(kind)//': '//str(maxval(abs(turn%load - as_stated%load))))
        call check_close(t, 'the transmission error moves', turn%point%steady%state(1) - as_stated%point%steady%state(1), &
                         sum(moved), absolute=1e-6_dp*um)
      end do
    end do

  contains

    subroutine lay(more)
      real(dp), intent(in) :: more(2)

      associate (p => place(:8, 1) + more(1), g => place(:, 2) + more(2))
        osc%mesh%deviations = make_deviations(teeth, reshape(p, [1, 8]), reshape(g, [1, 12]), [wave_t ::], offset, p, g)
      end associate
    end subroutine lay
  end subroutine shared_by_all

  !> The quick way leaves motions with coast contact to the exact one, as coast flanks are where the teeth are.
  subroutine quickly(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: text = '&case tasks = ''as_built'' / &pair module_mm = 3, face_width_mm = 20, '// &
      'backlash_um = 10 / &pinion teeth = 20 / &gear teeth = 20 / &load torque_nm = 20 / &mesh model = ''weber'' / '// &
      '&dynamics damping_ratio = 0.1 / &sweep rpm_first = 9000, rpm_last = 12000, rpm_step = 1000 / &numerics '// &
      'tolerance = 1e-7 / &deviations pinion_class = 7, gear_class = 7, draws = 12 / '
    type(answer_t) :: exact, quick
    real(dp), allocatable :: off(:)

    call ask(t, text, exact)
    call ask(t, text//'&as_built quick = .true. /', quick)
    off = abs(quick%all_of('as_built.dynamic_factor') - exact%all_of('as_built.dynamic_factor'))
    call check_true(t, 'as to the tolerance', maxval(off, mask=off >= 0) < 2e-3_dp, str(maxval(off, mask=off >= 0)))
  end subroutine quickly

  !> A prescribed mesh has the angle between the lines of action of its pressure angle: run-out moves its coast flanks by it, and
  !> without backlash the angle is refused.
  subroutine prescribed_angle(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: text = ' / &case tasks = ''as_built'' / &pinion teeth = 10, effective_mass_kg = 0.8 / &gear '// &
      'teeth = 10, effective_mass_kg = 0.9 / &load normal_force_n = 400 / &mesh model = ''polynomial'', contact_ratio = 1.6, '// &
      'coefficients = 300 / &dynamics damping_ratio = 0.1 / &sweep rpm_first = 9000, rpm_last = 9000, rpm_step = 100 / '// &
      '&deviations pinion_runout_um = 30, pinion_runout_phase_deg = 20 /'
    type(answer_t) :: narrow, usual, wide
    character(:), allocatable :: said

    call ask(t, '&pair backlash_um = 4, pressure_angle_deg = 5'//text, narrow)
    call ask(t, '&pair backlash_um = 4'//text, usual)
    call ask(t, '&pair backlash_um = 4, pressure_angle_deg = 20'//text, wide)
    call check_close(t, '20 degrees without the key', wide%one('as_built.dynamic_factor'), usual%one('as_built.dynamic_factor'), &
                     absolute=0.0_dp)
    call check_true(t, 'counts', abs(wide%one('as_built.dynamic_factor') - narrow%one('as_built.dynamic_factor')) > 1e-3_dp, &
                    str(narrow%one('as_built.dynamic_factor')))
    said = refusal('&pair pressure_angle_deg = 5'//text)
    call check_true(t, 'refused without backlash', index(said, 'with run-out and backlash') > 0, said)
  end subroutine prescribed_angle
end module test_coast_flanks
