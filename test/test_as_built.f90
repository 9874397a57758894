!> Motions of gears whose teeth have errors of their own: against six motions of a solver written apart
!> (test/reference/as_built.dat), and identities.
module test_as_built
  use gearsweep_deviations, only: make_deviations, wave_t
  use gearsweep_error, only: error_t
  use gearsweep_error_estimate, only: accuracy_t
  use gearsweep_kinds, only: dp, pi
  use gearsweep_oscillator, only: make_oscillator, oscillator_t
  use gearsweep_piecewise, only: piecewise_t, polynomial
  use gearsweep_refinement, only: levels_t
  use gearsweep_status, only: has_result, status_name
  use gearsweep_text, only: str
  use gearsweep_tolerances, only: find_tolerances, tolerances_t
  use gearsweep_turn, only: curve_t, find_amplitudes, find_static_turn, find_turn, turn_t
  use quantities, only: answer_t, ask, refusal
  use reference_rows, only: next_row
  use testing, only: check_close, check_error, check_no_error, check_true, tally_t
  implicit none
  private
  public :: run

  real(dp), parameter :: um = 1e-6_dp

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
    if (t%wants('by_keys')) call by_keys(t, given)
    if (t%wants('moved')) call moved(t, given)
    if (t%wants('scaled')) call scaled(t, given)
    if (t%wants('alike')) call alike(t)
    if (t%wants('patterns')) call patterns(t)
    if (t%wants('excited')) call excited(t)
    if (t%wants('repelling')) call repelling(t, given)
    if (t%wants('classes')) call classes(t)
    if (t%wants('refused')) call refused(t)
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
    type(curve_t) :: static
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
        call check_close(t, 'least transmission error', turn%error%least, um*one%least, absolute=1e-9_dp*um)
        call check_close(t, 'largest transmission error', turn%error%largest, um*one%largest, absolute=1e-9_dp*um)
        call check_close(t, 'state', turn%point%steady%state(1), um*one%state(1), absolute=1e-9_dp*um)
        call check_close(t, 'derivative', turn%point%steady%state(2), um*one%state(2), absolute=1e-8_dp*um)
        call check_orders(t, one, turn%error, one%dynamic, 'dynamic')
        call find_static_turn(osc, static)
        call check_orders(t, one, static, one%static, 'static')
        ! Where pairs part at rest the given ranges come short of values that the curve takes, by less than 1e-6 um.
        call check_true(t, 'static range', static%largest - static%least > um*(one%range - 1e-9_dp) .and. &
                        static%largest - static%least < um*(one%range + merge(2e-6_dp, 1e-9_dp, one%changes > 0)), one%name)
      end associate
    end do
  end subroutine given_motions

  !> The amplitude of one harmonic; with 0, the mean.
  complex(dp) function amplitude_of(curve, harmonic) result(amplitude)
    type(curve_t), intent(in) :: curve
    real(dp), intent(in) :: harmonic
    complex(dp) :: first(1)

    call find_amplitudes(curve, harmonic, first)
    amplitude = first(1)
    if (.not. harmonic > 0) amplitude = amplitude/2
  end function amplitude_of

  subroutine check_orders(t, given, curve, expected, what)
    type(tally_t), intent(inout) :: t
    type(given_t), intent(in) :: given
    type(curve_t), intent(in) :: curve
    real(dp), intent(in) :: expected(10)
    character(*), intent(in) :: what
    real(dp) :: harmonic(10), pinion, gear
    integer :: k

    pinion = 1.0_dp/given%osc%mesh%teeth(1)
    gear = 1.0_dp/given%osc%mesh%teeth(2)
    harmonic = [0.0_dp, pinion, gear, 1.0_dp, 2.0_dp, 1 - pinion, 1 + pinion, 1 - gear, 1 + gear, 1.0_dp/given%periods]
    do k = 1, 10
      call check_close(t, given%name//what//' order '//str(k), abs(amplitude_of(curve, harmonic(k))), um*expected(k), &
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
          call check_close(t, one%name//'range', answer%one('as_built.dte_peak_to_peak_um'), (one%largest - one%least), &
                           absolute=1e-6_dp)
          call check_close(t, one%name//'largest load', maxval(answer%all_of('as_built_loads.load_ratio')), one%dynamic_factor, &
                           absolute=1e-9_dp)
          call check_close(t, one%name//'modulus', answer%one('as_built.multiplier'), one%modulus**(1.0_dp/one%periods), &
                           absolute=merge(1e-6_dp, 1.0_dp, one%modulus > 1e-200_dp))
        end do
      end associate
    end do
  end subroutine by_keys

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
      call add('/ &as_built rpm', [given%rpm])
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
        call check_close(t, 'largest transmission error, all larger', turn%error%largest, times*um*one%largest, absolute=1e-8_dp*um)
        osc = one%osc
        osc%load = times*osc%load
        osc%mass = times*osc%mass
        osc%mesh%stiffness = osc%mesh%stiffness%scaled(times)
        call solve(t, osc, one%rpm, turn)
        call check_close(t, 'largest transmission error, all stiffer', turn%error%largest, um*one%largest, absolute=1e-8_dp*um)
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

  !> Pitch errors that repeat after 4 of 24 teeth: the motion repeats after 4 mesh periods, so that all orders of the turn vanish
  !> but
  !> each sixth. Pairs in full contact add up: the motion of two gears is the sum of those of each with a nominal one.
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
      call check_true(t, 'order that a pattern has not', abs(amplitude_of(turn%error, k/24.0_dp)) < 1e-9_dp*um, str(k))
    end do
    call check_true(t, 'order that it has', abs(amplitude_of(turn%error, 6/24.0_dp)) > 0.1_dp*um)
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
      associate (pinion_part => merge(amplitude_of(part(1)%error, 0.25_dp), (0.0_dp, 0.0_dp), k == 5))
        call check_true(t, 'sum of the parts', abs(amplitude_of(turn%error, k/20.0_dp) - amplitude_of(part(2)%error, k/20.0_dp) - &
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
        call check_true(t, 'wave in closed form', abs(amplitude_of(turn%error, order(i)/real(teeth(gear), dp)) - expected) < &
                        1e-7_dp*amplitude, str(order(i)))
        ! Each of the two pairs carries half of the load and of what moves them.
        call check_close(t, 'load in closed form', maxval(turn%load), 2500 + stiffness*abs(expected - amplitude* &
                         exp(cmplx(0.0_dp, 0.3_dp - pi/2, dp))), 1e-5_dp)
      end do
    end do
  end subroutine excited

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
  end subroutine repelling

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
    type(tolerances_t) :: found
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

  !> One clear error each.
  subroutine refused(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: counted = ', pinion_counting = ''clockwise'', pinion_flank = '// &
      '''right'''// &
                                         ', pinion_tooth = 1'

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

  contains

    subroutine refuse(keys, words)
      character(*), intent(in) :: keys, words
      character(*), parameter :: rest = '&case tasks = ''as_built'' / &pair module_mm = 3, face_width_mm = 20 / &pinion '// &
        'teeth = 6, '// &
        'profile_shift = 0.6 / &gear teeth = 30 / &load torque_nm = 50 / &mesh model = ''iso6336'' / &as_built rpm = 1000 / '

      call check_contains(t, keys, refusal(rest//'&deviations '//keys//' /'), words)
    end subroutine refuse
  end subroutine refused

  subroutine check_contains(t, name, text, words)
    type(tally_t), intent(inout) :: t
    character(*), intent(in) :: name, text, words

    call check_true(t, name//' is refused', index(text, words) > 0, text)
  end subroutine check_contains
end module test_as_built
