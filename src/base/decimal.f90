!> Numbers as text, digit for digit as Fortran's ES editing rounds them, but many times as fast: tables of thousands of points
!> should not take longer than the points.
module gearsweep_base_decimal
  use gearsweep_base_kinds, only: dp
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite, ieee_is_nan
  use, intrinsic :: iso_fortran_env, only: int64
  implicit none
  private
  public :: write_decimal

  integer, parameter :: wide = selected_int_kind(38)
  integer, parameter :: binary = digits(1.0_dp)
  integer :: i
  !> Largest exponent of five whose power times the 53 bits of a number is below 2**127.
  integer, parameter :: most_fives = 31
  integer(wide), parameter :: five(0:most_fives) = [(5_wide**i, i=0, most_fives)]

contains

  !> Writes `x` with 2 to 17 significant digits, as `-1.25E-003`, into the first `length` characters of `text`.
  pure subroutine write_decimal(x, figures, text, length)
    real(dp), intent(in) :: x
    integer, intent(in) :: figures
    character(24), intent(out) :: text
    integer, intent(out) :: length
    integer(int64) :: mantissa
    integer :: power
    character(20) :: form

    call round_decimal(x, figures, mantissa, power)
    if (mantissa > 0) then
      call write_digits(merge(1, 0, x < 0), figures, mantissa, power, text, length)
    else if (ieee_is_nan(x)) then
      ! An interrupted sweep has millions of NaN.
      text = 'NaN'
      length = 3
    else
      write (form, '(a, i0, a)') '(es24.', figures - 1, 'e3)'
      write (text, form) x
      text = adjustl(text)
      length = len_trim(text)
    end if
  end subroutine write_decimal

  !> Computes |x| = mantissa*10**(power - figures + 1), rounded to nearest, ties to even; mantissa 0 if x is too small or too
  !> large for this method. Exact: x is m 2**q, and m 5**k fits into 127 bits.
  pure subroutine round_decimal(x, figures, mantissa, power)
    real(dp), intent(in) :: x
    integer, intent(in) :: figures
    integer(int64), intent(out) :: mantissa
    integer, intent(out) :: power
    integer(wide) :: exact, remainder, half
    integer :: k, shift

    mantissa = 0
    power = 0
    if (.not. ieee_is_finite(x)) return
    if (.not. (abs(x) > 1e-20_dp .and. abs(x) < 1e20_dp)) return
    power = floor(log10(abs(x)))
    do
      k = figures - 1 - power
      shift = binary - exponent(x) - k
      if (k < 0 .or. k > most_fives .or. shift < 1 .or. shift > 126) exit
      exact = int(scale(fraction(abs(x)), binary), wide)*five(k)
      half = shiftl(1_wide, shift - 1)
      remainder = iand(exact, 2*half - 1)
      mantissa = int(shiftr(exact, shift), int64)
      if (remainder > half .or. (remainder == half .and. btest(mantissa, 0))) mantissa = mantissa + 1
      if (mantissa >= 10_int64**(figures - 1) .and. mantissa < 10_int64**figures) return
      power = power + merge(1, -1, mantissa >= 10_int64**figures)
    end do
    mantissa = 0
  end subroutine round_decimal

  pure subroutine write_digits(sign, figures, mantissa, power, text, length)
    integer, intent(in) :: sign, figures, power
    integer(int64), intent(in) :: mantissa
    character(24), intent(out) :: text
    integer, intent(out) :: length
    integer(int64) :: remainder
    integer :: at

    text = '-'
    remainder = mantissa
    do at = sign + figures + 1, sign + 3, -1
      text(at:at) = figure(remainder)
      remainder = remainder/10
    end do
    text(sign + 1:sign + 2) = figure(remainder)//'.'
    length = sign + figures + 6
    text(length - 4:length) = 'E'//merge('-', '+', power < 0)//figure(int(abs(power)/100, int64))// &
                              figure(int(abs(power)/10, int64))//figure(int(abs(power), int64))
  end subroutine write_digits

  !> Last digit of `n`.
  pure character function figure(n)
    integer(int64), intent(in) :: n

    figure = achar(iachar('0') + int(modulo(n, 10_int64)))
  end function figure
end module gearsweep_base_decimal
