!> The root finder against zeros known in closed form, and where functions are flat, jump, have no zero or no value.
module test_bracket
  use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
  use gearsweep_base_bracket, only: bracket_t
  use gearsweep_base_kinds, only: dp, pi
  use gearsweep_base_memory, only: bring_traps_back, set_traps_aside
  use gearsweep_base_text, only: str
  use test_support_testing, only: tally_t, check_true, check_close
  implicit none
  private
  public :: run

  !> Functions and their zeros in [0, 2]; all are negative at 0 but `constant` and `nothing`.
  integer, parameter :: square = 1, sine = 2, ninth = 3, jump = 4, flat = 5, at_start = 6, at_end = 7, constant = 8, nothing = 9
  real(dp), parameter :: zeros(7) = [sqrt(2.0_dp), pi/2, 1.0_dp, 0.3_dp, 0.4_dp, 0.0_dp, 2.0_dp]

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t

    if (t%wants('bisection')) call bisection(t)
    if (t%wants('no_zero')) call no_zero(t)
    if (t%wants('illinois')) call illinois(t)
  end subroutine run

  elemental real(dp) function f(function, x)
    integer, intent(in) :: function
    real(dp), intent(in) :: x

    select case (function)
    case (square)
      f = x**2 - 2
    case (sine)
      f = -cos(x)
    case (ninth)
      f = (x - 1)**9
    case (jump)
      f = merge(-1, 1, x < 0.3_dp)
    case (flat)
      f = min(x - 0.4_dp, 0.0_dp) + max(x - 1.5_dp, 0.0_dp)
    case (at_start)
      f = x
    case (at_end)
      f = x - 2
    case (constant)
      f = 1
    case default
      f = ieee_value(x, ieee_quiet_nan)
    end select
  end function f

  !> Bisects, counts the evaluations, and returns the interval that remains.
  pure subroutine bisect(function, zero, evaluations)
    integer, intent(in) :: function
    type(bracket_t), intent(inout) :: zero
    integer, intent(out) :: evaluations

    evaluations = 0
    do while (zero%is_open())
      evaluations = evaluations + 1
      call zero%halve(f(function, zero%middle()) < 0 .eqv. zero%low < zero%high)
    end do
  end subroutine bisect

  !> From both sides, the interval that remains is one step of the last bit, with the change of sign in it. `flat` is zero from 0.4
  !> to 1.5: the sign changes at 0.4.
  subroutine bisection(t)
    type(tally_t), intent(inout) :: t
    type(bracket_t) :: zero
    integer :: function, evaluations, side

    do function = square, at_end
      do side = 1, 2
        zero = merge(bracket_t(0.0_dp, 2.0_dp), bracket_t(2.0_dp, 0.0_dp), side == 1)
        call bisect(function, zero, evaluations)
        call check_close(t, 'zero of function '//str(function), zero%middle(), zeros(function), absolute=2*epsilon(1.0_dp))
        if (function == at_start) cycle
        call check_true(t, 'one step remains of function '//str(function), &
                        nearest(min(zero%low, zero%high), 1.0_dp) >= max(zero%low, zero%high), str(zero%high - zero%low))
        call check_true(t, 'a halving a bit for function '//str(function), evaluations <= digits(1.0_dp) + 3, str(evaluations))
      end do
    end do
    zero = bracket_t(0.0_dp, 2.0_dp)
    call bisect(at_start, zero, evaluations)
    call check_true(t, 'a zero at 0 ends', evaluations == 120 .and. zero%high <= 2*0.5_dp**120, str(evaluations))
  end subroutine bisection

  !> Without a change of sign, and without a value, bisection ends at the end that it comes to. Traps are disabled as during a call,
  !> where a value that is not a number may come.
  subroutine no_zero(t)
    type(tally_t), intent(inout) :: t
    type(bracket_t) :: zero
    integer :: evaluations

    call set_traps_aside()
    zero = bracket_t(0.5_dp, 2.0_dp)
    call bisect(constant, zero, evaluations)
    call check_close(t, 'positive everywhere: the lower end', zero%middle(), 0.5_dp, absolute=0.0_dp)
    zero = bracket_t(0.5_dp, 2.0_dp)
    call bisect(nothing, zero, evaluations)
    call check_close(t, 'no value anywhere: the lower end', zero%middle(), 0.5_dp, absolute=0.0_dp)
    zero = bracket_t(1.0_dp, 1.0_dp)
    call check_true(t, 'an empty interval is not open', .not. zero%is_open())
    zero = bracket_t(0.0_dp, ieee_value(1.0_dp, ieee_quiet_nan))
    call check_true(t, 'an interval without an end is not open', .not. zero%is_open())
    zero = bracket_t(0.0_dp, 2.0_dp, [1.0_dp, 1.0_dp])
    call check_close(t, 'a chord without a zero: the middle', zero%chord_zero(), 1.0_dp, absolute=0.0_dp)
    zero = bracket_t(0.0_dp, 2.0_dp, [-1.0_dp, ieee_value(1.0_dp, ieee_quiet_nan)])
    call check_close(t, 'a chord without an end: the middle', zero%chord_zero(), 1.0_dp, absolute=0.0_dp)
    call bring_traps_back()
  end subroutine no_zero

  !> The Illinois method keeps the zero between its ends. Its order is 1.44 (Dowell and Jarratt 1971): the digits of a simple zero
  !> come in a dozen evaluations for 53, and a ninefold zero, where chords are of no use, in a finite number.
  subroutine illinois(t)
    type(tally_t), intent(inout) :: t
    type(bracket_t) :: zero
    real(dp) :: at
    integer :: function, evaluations
    logical :: inside

    do function = square, ninth
      zero = bracket_t(0.0_dp, 2.25_dp, f(function, [0.0_dp, 2.25_dp]))
      inside = .true.
      do evaluations = 1, 400
        at = zero%chord_zero()
        inside = inside .and. zero%low <= zeros(function) + epsilon(at) .and. zero%high >= zeros(function) - epsilon(at)
        if (abs(at - zeros(function)) <= merge(1e-3_dp, 1e-15_dp, function == ninth)) exit
        call zero%narrow(at, f(function, at))
      end do
      call check_true(t, 'the zero stays inside, function '//str(function), inside)
      call check_true(t, 'few evaluations of function '//str(function), evaluations <= merge(200, 12, function == ninth), &
                      str(evaluations))
    end do
  end subroutine illinois
end module test_bracket
