!> Derivatives of motions by the numbers of a case: against closed forms of a linear motion, identities of the equation of motion
!> between the numbers, differences of motions that are solved each by itself, and places where there is no derivative.
module test_sensitivity
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use gearsweep_nonlinear_sensitivity, only: amplitude_slopes, difference_t, make_difference, slopes_t
  use gearsweep_base_error, only: error_t
  use gearsweep_base_kinds, only: dp, pi
  use gearsweep_base_table, only: table_t
  use gearsweep_api_tables, only: make_table
  use gearsweep_base_text, only: str
  use test_support_ask_by_name, only: answer_t, ask
  use test_support_testing, only: check_close, check_true, tally_t
  implicit none
  private
  public :: run

  integer, parameter :: word = 32

  !> Two pairs at any time, of constant stiffness, and reliefs from the pitch point: the motion is linear, with constant
  !> coefficients, and forced by straight lines.
  type :: linear_t
    real(dp) :: stiffness = 200e6_dp, load = 3000, mass(2) = [0.7_dp, 1.1_dp], relief(2) = [6e-6_dp, 2.4e-6_dp]
    real(dp) :: zeta = 0.04_dp, rpm = 5200
  end type linear_t

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t

    if (t%wants('polynomials')) call polynomials(t)
    if (t%wants('harmonics_in_closed_form')) call harmonics_in_closed_form(t)
    if (t%wants('factor_in_closed_form')) call factor_in_closed_form(t)
    if (t%wants('seen_later')) call seen_later(t)
    if (t%wants('scales')) call scales(t)
    if (t%wants('what_does_not_count')) call what_does_not_count(t)
    if (t%wants('motions_by_themselves')) call motions_by_themselves(t)
    if (t%wants('no_derivative')) call no_derivative(t)
  end subroutine run

  !> Differences are exact for polynomials of their order, and not for one more.
  subroutine polynomials(t)
    type(tally_t), intent(inout) :: t
    type(difference_t) :: d
    real(dp), parameter :: at = 0.7_dp, step = 0.1_dp
    integer :: n

    d = make_difference(at, 0.0_dp, step)
    do n = 1, 6
      call check_close(t, 'central, degree '//str(n), d%slope((at + d%offset)**n), n*at**(n - 1), 1e-13_dp)
      if (n <= 4) call check_close(t, 'fewer places', d%rougher_slope((at + d%offset)**n), n*at**(n - 1), 1e-13_dp)
      if (n <= 3) call check_close(t, 'below', d%slope_below((at + d%offset)**n), n*at**(n - 1), 1e-13_dp)
      if (n <= 3) call check_close(t, 'above', d%slope_above((at + d%offset)**n), n*at**(n - 1), 1e-13_dp)
    end do
    call check_true(t, 'the seventh is beyond it', abs(d%slope((at + d%offset)**7) - 7*at**6) > 1e-7_dp)
    d = make_difference(at, 0.65_dp, step)
    call check_true(t, 'none below', d%one_sided .and. all(at + d%offset >= 0.65_dp))
    call check_true(t, 'nothing below', ieee_is_nan(d%slope_below((at + d%offset)**2)))
    do n = 1, 6
      call check_close(t, 'one-sided, degree '//str(n), d%slope((at + d%offset)**n), n*at**(n - 1), 1e-12_dp)
      if (n <= 5) call check_close(t, 'one-sided, fewer', d%rougher_slope((at + d%offset)**n), n*at**(n - 1), 1e-12_dp)
    end do
  end subroutine polynomials

  !> The same motion seen a quarter of the harmonic's period later, so that its parts change places, has the same derivative of the
  !> amplitude with the same error; a harmonic of 3 and 4 that grows by 6 and 8 grows by 10.
  subroutine seen_later(t)
    type(tally_t), intent(inout) :: t
    type(slopes_t) :: now, later
    real(dp), parameter :: value(3) = [7.0_dp, 3.0_dp, 4.0_dp], slope(3) = [1.0_dp, 6.0_dp, 8.0_dp], &
                           estimate(3) = [0.1_dp, 0.02_dp, 0.3_dp]
    integer, parameter :: order(3) = [1, 3, 2], sense(3) = [1, -1, 1]

    allocate (now%amplitude(0:1), now%amplitude_estimate(0:1))
    later = now
    call amplitude_slopes(value, slope, estimate, now)
    call amplitude_slopes(sense*value(order), sense*slope(order), estimate(order), later)
    call check_close(t, 'derivative of an amplitude', now%amplitude(1), 10.0_dp, 1e-14_dp)
    call check_close(t, 'seen later', later%amplitude(1), now%amplitude(1), 1e-14_dp)
    call check_close(t, 'its error seen later', later%amplitude_estimate(1), now%amplitude_estimate(1), 1e-14_dp)
    call check_true(t, 'its error is not below that of a part', now%amplitude_estimate(1) >= maxval(estimate(2:)))
    call check_close(t, 'derivative of the mean', now%amplitude(0), 1.0_dp, 1e-14_dp)
    call check_close(t, 'error of the mean', now%amplitude_estimate(0), 0.1_dp, 1e-14_dp)
  end subroutine seen_later

  subroutine ask_linear(t, linear, answer)
    type(tally_t), intent(inout) :: t
    type(linear_t), intent(in) :: linear
    type(answer_t), intent(out) :: answer

    call ask(t, '&case tasks = ''sensitivity'' / &pinion teeth = 25 effective_mass_kg = '//str(linear%mass(1))// &
             ' / &gear effective_mass_kg = '//str(linear%mass(2))//' / &load normal_force_n = '//str(linear%load)// &
             ' / &mesh model = ''polynomial'' contact_ratio = 2 coefficients = '//str(1e-6_dp*linear%stiffness)// &
             ' / &relief start = ''pitch'' amount_um = '//str(1e6_dp*linear%relief(1))//' gear_fraction = '// &
             str(linear%relief(2)/linear%relief(1))//' / &dynamics damping_ratio = '//str(linear%zeta)// &
             ' / &sensitivity rpm = '//str(linear%rpm, 17)//' /', answer)
  end subroutine ask_linear

  !> A column's value in the row of a number, and of a harmonic and a speed where these are given.
  real(dp) function value_of(answer, name, column, number, harmonic, rpm) result(value)
    type(answer_t), intent(in) :: answer
    character(*), intent(in) :: name, column, number
    integer, intent(in), optional :: harmonic
    real(dp), intent(in), optional :: rpm
    type(table_t) :: table
    type(error_t), allocatable :: error
    integer :: i

    value = -huge(value)
    call make_table(answer%study, name, table, error)
    do i = 1, table%rows
      if (table%word('number', i) /= number) cycle
      if (present(harmonic)) then
        if (nint(table%number('harmonic', i)) /= harmonic) cycle
      end if
      if (present(rpm)) then
        if (abs(table%number('rpm', i) - rpm) > 0) cycle
      end if
      value = table%number(column, i)
      return
    end do
  end function value_of

  !> The forcing is a sawtooth, of which the motion has each harmonic times that of a linear oscillator.
  subroutine harmonics_in_closed_form(t)
    type(tally_t), intent(inout) :: t
    type(linear_t) :: linear
    type(answer_t) :: answer
    real(dp) :: omega, r, amplitude, by_r, divisor, saw, mobility
    integer :: k, i

    call ask_linear(t, linear, answer)
    mobility = sum(1/linear%mass)
    omega = sqrt(2*linear%stiffness*mobility)
    saw = linear%relief(1) - linear%relief(2)
    do k = 1, 3
      r = k*2*pi*25*linear%rpm/60/omega
      divisor = (1 - r**2)**2 + (2*linear%zeta*r)**2
      amplitude = 1e6_dp*saw/(2*pi*k)/sqrt(divisor)
      by_r = -amplitude*(-2*r*(1 - r**2) + 4*linear%zeta**2*r)/divisor
      call check('damping_ratio', -4*amplitude*linear%zeta*r**2/divisor)
      call check('rpm', by_r*r/linear%rpm)
      call check('stiffness_factor', -by_r*r/2)
      call check('normal_force_n', 0.0_dp)
      call check('pinion_relief_um', 1e-6_dp*amplitude/saw)
      call check('gear_relief_um', -1e-6_dp*amplitude/saw)
      do i = 1, 2
        call check(trim(merge('pinion', 'gear  ', i == 1))//'_mass_kg', by_r*r/2/linear%mass(i)**2/mobility)
      end do
      ! The mesh at rest has the sawtooth itself.
      call check_close(t, 'at rest', value_of(answer, 'ste_sensitivity', 'ste_slope_um', 'pinion_relief_um', k), 1/(2*pi*k), &
                       1e-9_dp)
    end do
    k = 0
    call check('normal_force_n', 1e6_dp/(2*linear%stiffness))
    call check('stiffness_factor', -1e6_dp*linear%load/(2*linear%stiffness))
    call check('pinion_relief_um', 0.25_dp)
    call check('damping_ratio', 0.0_dp)
    call check('pinion_relief_start', -1e6_dp*linear%relief(1)/4)
    call check('gear_relief_start', 1e6_dp*linear%relief(2)/4)
    call check_close(t, 'at rest', value_of(answer, 'ste_sensitivity', 'ste_slope_um', 'normal_force_n', 0), &
                     1e6_dp/(2*linear%stiffness), 1e-9_dp)

  contains

    subroutine check(number, expected)
      character(*), intent(in) :: number
      real(dp), intent(in) :: expected
      real(dp) :: unit

      ! What a change by a hundredth of the number makes, in um: below 1e-8 um nothing counts.
      unit = value_of(answer, 'sensitivity', 'value', number)/100
      associate (slope => value_of(answer, 'dte_sensitivity', 'dte_slope_um', number, k))
        call check_close(t, number//', harmonic '//str(k), unit*slope, unit*expected, absolute=1e-8_dp*abs(unit*expected) + 1e-8_dp)
        call check_true(t, number//', estimate', abs(slope - expected) <= &
                        2*value_of(answer, 'dte_sensitivity', 'error_estimate', number, k) + 1e-9_dp/abs(unit))
      end associate
    end subroutine check
  end subroutine harmonics_in_closed_form

  !> The largest load of the linear motion in closed form: over the mesh period x is a straight line and a decaying
  !> oscillation, which repeat. Its derivatives are differences of that.
  subroutine factor_in_closed_form(t)
    type(tally_t), intent(inout) :: t
    type(linear_t) :: linear
    type(answer_t) :: answer
    real(dp), parameter :: speeds(3) = [5200.0_dp, 9000.0_dp, 26000.0_dp], step = 2e-4_dp
    character(*), parameter :: names(6) = [character(16) :: 'rpm', 'damping_ratio', 'normal_force_n', 'stiffness_factor', &
                                           'pinion_mass_kg', 'pinion_relief_um']
    real(dp) :: slope, expected
    integer :: i, k

    do i = 1, size(speeds)
      linear = linear_t(rpm=speeds(i))
      call ask_linear(t, linear, answer)
      call check_close(t, 'dynamic factor', value_of(answer, 'sensitivity', 'dynamic_factor', 'rpm'), factor_of(linear), 1e-6_dp)
      do k = 1, size(names)
        expected = (8*(changed(step) - changed(-step)) - (changed(2*step) - changed(-2*step)))/(12*step)
        slope = value_of(answer, 'sensitivity', 'slope', names(k))*value_of(answer, 'sensitivity', 'value', names(k))
        call check_close(t, names(k)//' at '//str(speeds(i)), slope, expected, absolute=1e-8_dp*(1 + abs(expected)))
      end do
    end do

  contains

    !> The dynamic factor with this part more of number k.
    real(dp) function changed(part)
      real(dp), intent(in) :: part
      type(linear_t) :: other

      other = linear
      if (k == 1) other%rpm = (1 + part)*other%rpm
      if (k == 2) other%zeta = (1 + part)*other%zeta
      if (k == 3) other%load = (1 + part)*other%load
      if (k == 4) other%stiffness = (1 + part)*other%stiffness
      if (k == 5) other%mass(1) = (1 + part)*other%mass(1)
      if (k == 6) other%relief(1) = (1 + part)*other%relief(1)
      changed = factor_of(other)
    end function changed
  end subroutine factor_in_closed_form

  !> DF of the linear motion, and where on the path, in base pitches from A, a pair has it.
  real(dp) function factor_of(linear, place) result(factor)
    type(linear_t), intent(in) :: linear
    real(dp), intent(out), optional :: place
    integer, parameter :: places = 4000
    real(dp), parameter :: golden = (sqrt(5.0_dp) - 1)/2
    real(dp) :: rate, decay, c(0:1), m(2, 2), right(2), a(2), load, low, high, left_place, right_place
    integer :: i, k, pair, best

    associate (period => 60/(25*linear%rpm), omega => sqrt(2*linear%stiffness*sum(1/linear%mass)))
      rate = omega*sqrt(1 - linear%zeta**2)*period
      decay = linear%zeta*omega*period
      ! x = c0 + c1 tau + exp(-decay tau)*(a1 cos(rate tau) + a2 sin(rate tau)), forced by half of the sum of the reliefs.
      c(1) = (linear%relief(1) - linear%relief(2))/2
      c(0) = linear%load/(2*linear%stiffness) + linear%relief(2)/2 - 2*linear%zeta*c(1)/(omega*period)
    end associate
    m(1, :) = [exp(-decay)*cos(rate) - 1, exp(-decay)*sin(rate)]
    m(2, :) = [-decay*m(1, 1) - rate*exp(-decay)*sin(rate), -decay*m(1, 2) + rate*(exp(-decay)*cos(rate) - 1)]
    right = [-c(1), 0.0_dp]
    a = [m(2, 2)*right(1) - m(1, 2)*right(2), m(1, 1)*right(2) - m(2, 1)*right(1)]/(m(1, 1)*m(2, 2) - m(1, 2)*m(2, 1))
    factor = 0
    do pair = 1, 2
      best = 0
      load = -huge(load)
      do i = 0, places
        if (load_at(pair, i/real(places, dp)) <= load) cycle
        best = i
        load = load_at(pair, i/real(places, dp))
      end do
      low = max(0, best - 1)/real(places, dp)
      high = min(places, best + 1)/real(places, dp)
      do k = 1, 60
        left_place = high - golden*(high - low)
        right_place = low + golden*(high - low)
        if (load_at(pair, left_place) < load_at(pair, right_place)) then
          low = left_place
        else
          high = right_place
        end if
      end do
      load = max(load, load_at(pair, (low + high)/2))/linear%load
      if (present(place) .and. load > factor) place = pair - 1 + (low + high)/2
      factor = max(factor, load)
    end do

  contains

    pure real(dp) function load_at(pair, tau)
      integer, intent(in) :: pair
      real(dp), intent(in) :: tau
      real(dp) :: x

      x = c(0) + c(1)*tau + exp(-decay*tau)*(a(1)*cos(rate*tau) + a(2)*sin(rate*tau))
      load_at = linear%stiffness*(x - merge(linear%relief(2)*(1 - tau), linear%relief(1)*tau, pair == 1))
    end function load_at
  end function factor_of

  !> The equation of motion has three scales, so that a change of all numbers with one of them does not change DF: of load,
  !> reliefs and backlash together; of masses and of one over the square of the speed; of stiffness, load and the square of the
  !> speed. The transmission error grows with the first.
  subroutine scales(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: cases(5) = [character(160) :: &
      '&dynamics damping_ratio = 0.1 / &sensitivity rpm = 4100, 6200, 9300, 15000 /', &
      ! With coast contact.
      '&dynamics damping_ratio = 0.01 / &sensitivity rpm = 6450, 11600, 11800 /', &
      '&dynamics damping_ratio = 0.03 friction = 0.08 / &sensitivity rpm = 3500, 5100, 12000 /', &
      '&dynamics damping_ratio = 0.01 / &sensitivity rpm = 2900, 7300 /', &
      '&dynamics damping_ratio = 3 / &sensitivity rpm = 700, 9000 /']
    real(dp), allocatable :: rpm(:), of(:)
    type(answer_t) :: answer
    real(dp) :: by(4)
    integer :: i, k, compared, sides

    compared = 0
    sides = 0
    do i = 1, size(cases)
      call ask(t, pair_text(i)//trim(cases(i)), answer)
      rpm = answer%all_of('sensitivity.rpm')
      of = pack(rpm, [.true., abs(rpm(2:) - rpm(:size(rpm) - 1)) > 0])
      do k = 1, size(of)
        by(1) = weighted('normal_force_n', of(k))
        by(2) = weighted('pinion_relief_um', of(k)) + weighted('gear_relief_um', of(k))
        by(3) = weighted('rpm', of(k))
        by(4) = weighted('backlash_um', of(k))
        if (any(ieee_is_nan(by))) cycle
        compared = compared + 1
        if (abs(by(4)) > 1e-3_dp) call check_both_sides('backlash_um', of(k))
        call check_close(t, 'load, reliefs, backlash: '//trim(cases(i)(:40))//' '//str(of(k)), by(1) + by(2) + by(4), 0.0_dp, &
                         absolute=1e-7_dp*(1 + sum(abs(by))))
        by(2) = weighted('pinion_mass_kg', of(k)) + weighted('gear_mass_kg', of(k))
        call check_close(t, 'masses, speed: '//str(of(k)), by(2) - by(3)/2, 0.0_dp, absolute=1e-7_dp*(1 + sum(abs(by))))
        by(2) = weighted('stiffness_factor', of(k))
        call check_close(t, 'stiffness, load, speed: '//str(of(k)), by(2) + by(1) + by(3)/2, 0.0_dp, &
                         absolute=1e-7_dp*(1 + sum(abs(by))))
      end do
    end do
    call check_true(t, 'derivatives', compared >= 10, str(compared))
    call check_true(t, 'derivatives by the backlash', sides > 0, str(sides))

  contains

    !> In the unit of the number on either side: of a smooth derivative both are what it is.
    subroutine check_both_sides(number, speed)
      character(*), intent(in) :: number
      real(dp), intent(in) :: speed
      real(dp) :: slope

      sides = sides + 1
      slope = value_of(answer, 'sensitivity', 'slope', number, rpm=speed)
      call check_close(t, 'below', value_of(answer, 'sensitivity', 'slope_below', number, rpm=speed), slope, 1e-5_dp)
      call check_close(t, 'above', value_of(answer, 'sensitivity', 'slope_above', number, rpm=speed), slope, 1e-5_dp)
    end subroutine check_both_sides

    real(dp) function weighted(number, speed)
      character(*), intent(in) :: number
      real(dp), intent(in) :: speed

      weighted = 0
      if (number == 'backlash_um' .and. i /= 2) return
      weighted = value_of(answer, 'sensitivity', 'slope', number, rpm=speed)* &
                 value_of(answer, 'sensitivity', 'value', number, rpm=speed)
    end function weighted
  end subroutine scales

  !> A prescribed mesh with unequal masses and reliefs; the second with backlash, the third ready for friction.
  function pair_text(i) result(text)
    integer, intent(in) :: i
    character(:), allocatable :: text

    text = '&case tasks = ''sensitivity'' / '
    if (i == 2) text = text//'&pair backlash_um = 6 / '
    if (i == 3) text = text//'&pair pressure_angle_deg = 20 / '
    text = text//'&pinion teeth = 25 effective_mass_kg = 0.8 / &gear '
    if (i == 3) text = text//'teeth = 31 '
    text = text//'effective_mass_kg = 1.1 / &load normal_force_n = 7000 / '// &
           '&mesh model = ''polynomial'' contact_ratio = 1.6 coefficients = 400, 0, -110 / '// &
           '&relief amount_um = 9 gear_fraction = 0.6 / '
  end function pair_text

  !> Without relief and backlash the load is a scale of the motion, and DF does not depend on it, whether contact is kept or
  !> lost: what rounding leaves is below its estimate.
  subroutine what_does_not_count(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: speeds(6) = [2900.0_dp, 4100.0_dp, 6200.0_dp, 9300.0_dp, 12000.0_dp, 15000.0_dp]
    type(answer_t) :: answer
    real(dp) :: slope, estimate
    integer :: i, compared

    compared = 0
    do i = 1, size(speeds)
      call ask(t, '&case tasks = ''sensitivity'' / &pinion teeth = 25 effective_mass_kg = 0.8 / '// &
               '&gear effective_mass_kg = 1.1 / &load normal_force_n = 7000 / &mesh model = ''polynomial'' '// &
               'contact_ratio = 1.6 coefficients = 400, 0, -110 / '// &
               '&dynamics damping_ratio = 0.03 / &sensitivity rpm = '//str(speeds(i))//' /', answer)
      slope = value_of(answer, 'sensitivity', 'slope', 'normal_force_n')
      estimate = value_of(answer, 'sensitivity', 'error_estimate', 'normal_force_n')
      if (ieee_is_nan(slope)) cycle
      compared = compared + 1
      call check_true(t, 'load at '//str(speeds(i)), abs(slope) <= estimate .and. 7000*estimate < 1e-9_dp, &
                      str(slope)//' '//str(estimate))
    end do
    call check_true(t, 'slopes', compared >= 3, str(compared))
  end subroutine what_does_not_count

  !> Differences of dynamic factors that are solved each by itself, to 1e-10: with all pairs in contact, with some and with none for
  !> a while, and of a motion of two mesh periods.
  subroutine motions_by_themselves(t)
    type(tally_t), intent(inout) :: t

    call check(t, 0.17_dp, 5000.0_dp)
    call check(t, 0.05_dp, 7800.0_dp)
    call check(t, 0.03_dp, 10900.0_dp)
    call check(t, 0.01_dp, 2600.0_dp)
  end subroutine motions_by_themselves

  subroutine check(t, zeta, rpm)
    type(tally_t), intent(inout) :: t
    real(dp), intent(in) :: zeta, rpm
    real(dp), parameter :: part = 2e-4_dp
    type(answer_t) :: answer
    character(:), allocatable :: name

    name = ' at '//str(zeta)//', '//str(rpm)
    call ask(t, text_of('sensitivity', zeta, rpm, 7000.0_dp, 0.8_dp, 9.0_dp, 1.0_dp), answer)
    call compare('rpm', slope(rpm*[-2, -1, 1, 2], 1), rpm)
    call compare('damping_ratio', slope(zeta*[-2, -1, 1, 2], 2), zeta)
    call compare('normal_force_n', slope(7000.0_dp*[-2, -1, 1, 2], 3), 7000.0_dp)
    call compare('pinion_mass_kg', slope(0.8_dp*[-2, -1, 1, 2], 4), 0.8_dp)
    call compare('stiffness_factor', slope(1.0_dp*[-2, -1, 1, 2], 6), 1.0_dp)
    ! One key changes both reliefs.
    call check_close(t, 'reliefs'//name, 9*value_of(answer, 'sensitivity', 'slope', 'pinion_relief_um') + &
                     9*0.6_dp*value_of(answer, 'sensitivity', 'slope', 'gear_relief_um'), slope(9.0_dp*[-2, -1, 1, 2], 5)*9, &
                     absolute=1e-5_dp)

  contains

    subroutine compare(number, expected, value)
      character(*), intent(in) :: number
      real(dp), intent(in) :: expected, value

      associate (found => value_of(answer, 'sensitivity', 'slope', number))
        call check_close(t, number//name, value*found, value*expected, absolute=1e-5_dp*(1 + abs(value*expected)))
      end associate
    end subroutine compare

    !> By four motions with `part` of these changes of one number.
    real(dp) function slope(changes, which)
      real(dp), intent(in) :: changes(4)
      integer, intent(in) :: which
      real(dp) :: number(6), factor(4)
      integer :: i

      do i = 1, 4
        number = [rpm, zeta, 7000.0_dp, 0.8_dp, 9.0_dp, 1.0_dp]
        number(which) = number(which) + part*changes(i)
        factor(i) = factor_at(t, number)
      end do
      slope = (factor(1) - 8*factor(2) + 8*factor(3) - factor(4))/(12*part*changes(3))
    end function slope
  end subroutine check

  real(dp) function factor_at(t, number) result(factor)
    type(tally_t), intent(inout) :: t
    real(dp), intent(in) :: number(6)
    type(answer_t) :: answer
    real(dp), allocatable :: factors(:)

    ! Each speed by itself, as the derivatives are of that motion.
    call ask(t, text_of('sweep', number(2), number(1), number(3), number(4), number(5), number(6)), answer)
    factors = answer%all_of('sweep.dynamic_factor')
    factor = factors(1)
  end function factor_at

  function text_of(task, zeta, rpm, load, mass, relief, stiffness) result(text)
    character(*), intent(in) :: task
    real(dp), intent(in) :: zeta, rpm, load, mass, relief, stiffness
    character(:), allocatable :: text

    text = '&case tasks = '''//task//''' / &pinion teeth = 25 effective_mass_kg = '//str(mass, 17)// &
           ' / &gear effective_mass_kg = 1.1 / &load normal_force_n = '//str(load, 17)// &
           ' / &mesh model = ''polynomial'' contact_ratio = 1.6 coefficients = '//str(400*stiffness, 17)//', 0, '// &
           str(-110*stiffness, 17)//' / &relief amount_um = '//str(relief, 17)//' gear_fraction = 0.6 / '// &
           '&dynamics damping_ratio = '//str(zeta, 17)//' / &numerics tolerance = 1e-10 / '
    if (task == 'sweep') text = text//'&sweep direction = ''each'' rpm_step = 1 rpm_first = '//str(rpm, 17)//' rpm_last = '// &
                                str(rpm, 17)//' /'
    if (task /= 'sweep') text = text//'&sensitivity rpm = '//str(rpm, 17)//' /'
  end function text_of

  !> Where contact grazes, as the task `branches` has it; where two pairs have the largest load alike; and where there is no motion.
  subroutine no_derivative(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: pair = '&pinion teeth = 25 effective_mass_kg = 0.8 / &gear effective_mass_kg = 0.8 / '// &
      '&load normal_force_n = 7000 / &mesh model = ''polynomial'' contact_ratio = 1.6 coefficients = 400, 0, -110 / '// &
      '&dynamics damping_ratio = 0.05 / '
    type(answer_t) :: branches, answer
    type(table_t) :: table
    type(error_t), allocatable :: error
    character(word) :: kind, beside
    integer :: i, compared

    call ask(t, '&case tasks = ''branches'' / '//pair//'&branches first = 5500 last = 14000 seeds = 3 most_periods = 1 /', branches)
    call make_table(branches%study, 'branch_changes', table, error)
    compared = 0
    do i = 1, table%rows
      if (table%word('kind', i) /= 'grazing' .or. table%word('stability', i) /= 'stable') cycle
      associate (rpm => table%number('rpm', i))
        call ask(t, '&case tasks = ''sensitivity'' / '//pair//'&sensitivity rpm = '//str(rpm, 17)//', '// &
                 str(1.002_dp*rpm, 17)//' /', answer)
        kind = word_of(answer, 'rpm', rpm)
        beside = word_of(answer, 'rpm', 1.002_dp*rpm)
        ! The motion of this speed may be another than the one that grazes.
        if (abs(value_of(answer, 'sensitivity', 'dynamic_factor', 'rpm', rpm=rpm) - table%number('dynamic_factor', i)) > &
            1e-4_dp) cycle
        compared = compared + 1
        call check_true(t, 'grazing at '//str(rpm), any(kind == [character(word) :: 'grazing', 'contact']), kind)
        call check_true(t, 'beside it', all(beside /= [character(word) :: 'grazing', 'contact']), beside)
        call check_true(t, 'no slope', ieee_is_nan(value_of(answer, 'sensitivity', 'slope', 'rpm', rpm=rpm)))
      end associate
    end do
    call check_true(t, 'grazings', compared > 0, str(compared))
    call two_largest_loads(t)
    call ask(t, '&case tasks = ''sensitivity'' / &pinion teeth = 25 effective_mass_kg = 1 / &gear effective_mass_kg = 1 / '// &
             '&load normal_force_n = 3000 / &mesh model = ''polynomial'' contact_ratio = 1.6 coefficients = 300 / '// &
             '&dynamics damping_ratio = 0 / &sensitivity rpm = 9000 /', answer)
    kind = word_of(answer, 'damping_ratio', 9000.0_dp)
    call check_true(t, 'without damping, only more of it', any(kind == [character(word) :: 'least', 'none']), kind)
  end subroutine no_derivative

  !> Between two speeds of the linear motion, its largest load changes its place: there DF over the speed has a corner upwards.
  subroutine two_largest_loads(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: first = 2000, step = 20
    type(linear_t) :: linear
    type(answer_t) :: answer
    real(dp) :: low, high, place(2), here
    integer :: i, corners

    corners = 0
    place = 0
    do i = 0, 600
      here = factor_of(linear_t(rpm=first + i*step), place(2))
      if (i > 0 .and. abs(place(2) - place(1)) > 0.2_dp) then
        low = first + (i - 1)*step
        high = first + i*step
        do while (high - low > 1e-12_dp*high)
          linear = linear_t(rpm=(low + high)/2)
          here = factor_of(linear, place(2))
          if (abs(place(2) - place(1)) < 0.1_dp) low = linear%rpm
          if (.not. abs(place(2) - place(1)) < 0.1_dp) high = linear%rpm
        end do
        corners = corners + 1
        call ask_linear(t, linear, answer)
        call check_true(t, 'two largest loads at '//str(low), word_of(answer, 'rpm', linear%rpm) == 'peak', &
                        word_of(answer, 'rpm', linear%rpm))
        call check_true(t, 'a corner upwards', value_of(answer, 'sensitivity', 'slope_above', 'rpm') > &
                        value_of(answer, 'sensitivity', 'slope_below', 'rpm') + 1e-5_dp)
        call check_true(t, 'no slope', ieee_is_nan(value_of(answer, 'sensitivity', 'slope', 'rpm')))
        here = factor_of(linear_t(rpm=first + i*step), place(2))
      end if
      place(1) = place(2)
    end do
    call check_true(t, 'corners', corners > 0, str(corners))
  end subroutine two_largest_loads

  character(word) function word_of(answer, number, rpm) result(found)
    type(answer_t), intent(in) :: answer
    character(*), intent(in) :: number
    real(dp), intent(in) :: rpm
    type(table_t) :: table
    type(error_t), allocatable :: error
    integer :: i

    found = ''
    call make_table(answer%study, 'sensitivity', table, error)
    do i = 1, table%rows
      if (table%word('number', i) == number .and. .not. abs(table%number('rpm', i) - rpm) > 0) found = table%word('derivative', i)
    end do
  end function word_of
end module test_sensitivity
