!> Small text helpers for messages, tables and readers.
!>
!> All results have stated lengths, not `len=:`: where a function with such a
!> result is called, gfortran keeps its length in static memory (seen with GCC 12),
!> so that callers at once would spoil each other's texts.
module gearsweep_text
  use gearsweep_kinds, only: dp
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite, ieee_is_nan
  use, intrinsic :: iso_fortran_env, only: int64
  implicit none
  private
  public :: str, fixed, lower, join, split, shown, closest_word, to_number

  !> The shortest sensible text of a number or logical: `3.18`, `1600`, `1.2e-7`, `true`.
  interface str
    module procedure str_integer, str_real, str_digits, str_logical
  end interface str

  !> Reads all of `text` as one plain decimal number; `ok` is false for anything else.
  interface to_number
    module procedure to_integer, to_real
  end interface to_number

  character(*), parameter :: figures = '0123456789'
  !> Longer numbers are no numbers that anyone wrote.
  integer, parameter :: longest_number = 100
  integer, parameter :: longest_shown = 60

contains

  !> Digits and sign.
  pure integer function integer_length(x) result(length)
    integer, intent(in) :: x
    integer :: rest

    length = merge(2, 1, x < 0)
    rest = x/10
    do while (rest /= 0)
      length = length + 1
      rest = rest/10
    end do
  end function integer_length

  pure integer function real_length(x, digits) result(length)
    real(dp), intent(in) :: x
    integer, intent(in) :: digits
    character(:), allocatable :: words

    call write_real(x, digits, words)
    length = len(words)
  end function real_length

  pure function str_integer(x) result(text)
    integer, intent(in) :: x
    character(integer_length(x)) :: text

    write (text, '(i0)') x
  end function str_integer

  pure function str_logical(x) result(text)
    logical, intent(in) :: x
    character(merge(4, 5, x)) :: text

    text = merge('true ', 'false', x)
  end function str_logical

  !> At most 6 significant digits, and no zeros that say nothing.
  pure function str_real(x) result(text)
    real(dp), intent(in) :: x
    character(real_length(x, 6)) :: text

    text = str_digits(x, 6)
  end function str_real

  !> At most `digits` significant digits (1 to 17).
  pure function str_digits(x, digits) result(text)
    real(dp), intent(in) :: x
    integer, intent(in) :: digits
    character(real_length(x, digits)) :: text
    character(:), allocatable :: words

    call write_real(x, digits, words)
    text = words
  end function str_digits

  pure subroutine write_real(x, digits, text)
    real(dp), intent(in) :: x
    integer, intent(in) :: digits
    character(:), allocatable, intent(out) :: text
    character(48) :: buffer, form
    character(:), allocatable :: mantissa
    integer :: n, exponent

    if (.not. ieee_is_finite(x)) then
      text = 'NaN'
      if (ieee_is_nan(x)) return
      text = trim(merge('-Infinity', 'Infinity ', x < 0))
      return
    end if
    n = max(1, min(17, digits))
    write (form, '(a, i0, a)') '(es40.', n - 1, 'e3)'
    write (buffer, form) abs(x)
    buffer = adjustl(buffer)
    read (buffer(index(buffer, 'E') + 1:), *) exponent
    mantissa = buffer(1:1)//buffer(3:n + 1)
    mantissa = mantissa(:max(1, verify(mantissa, '0', back=.true.)))
    call place(mantissa, exponent, n, text)
    if (x < 0) text = '-'//text
  end subroutine write_real

  !> The digits d1 d2 d3.. mean d1.d2d3.. 10^exponent: written plainly where that is short.
  pure subroutine place(digits, exponent, n, text)
    character(*), intent(in) :: digits
    integer, intent(in) :: exponent, n
    character(:), allocatable, intent(out) :: text

    if (exponent < -4 .or. exponent >= max(n, len(digits))) then
      text = digits(1:1)
      if (len(digits) > 1) text = text//'.'//digits(2:)
      text = text//'e'//str_integer(exponent)
    else if (exponent < 0) then
      text = '0.'//repeat('0', -exponent - 1)//digits
    else if (len(digits) <= exponent + 1) then
      text = digits//repeat('0', exponent + 1 - len(digits))
    else
      text = digits(:exponent + 1)//'.'//digits(exponent + 2:)
    end if
  end subroutine place

  pure integer function fixed_length(x, decimals) result(length)
    real(dp), intent(in) :: x
    integer, intent(in) :: decimals

    length = len_trim(fixed_padded(x, decimals))
  end function fixed_length

  pure function fixed_padded(x, decimals) result(text)
    real(dp), intent(in) :: x
    integer, intent(in) :: decimals
    character(48) :: text, form

    text = str_real(x)
    if (.not. abs(x) < 1e6_dp) return
    write (form, '(a, i0, a)') '(f48.', decimals, ')'
    write (text, form) x
    text = adjustl(text)
  end function fixed_padded

  !> With so many decimals; very large numbers as `str` has them.
  pure function fixed(x, decimals) result(text)
    real(dp), intent(in) :: x
    integer, intent(in) :: decimals
    character(fixed_length(x, decimals)) :: text

    text = fixed_padded(x, decimals)
  end function fixed

  !> ASCII letters in lower case, all else as it is.
  pure function lower(text) result(small)
    character(*), intent(in) :: text
    character(len(text)) :: small
    integer :: i

    do i = 1, len(text)
      select case (text(i:i))
      case ('A':'Z')
        small(i:i) = achar(iachar(text(i:i)) + 32)
      case default
        small(i:i) = text(i:i)
      end select
    end do
  end function lower

  pure integer function joined_length(words, separator) result(length)
    character(*), intent(in) :: words(:), separator
    integer :: i

    length = len(separator)*max(0, size(words) - 1)
    do i = 1, size(words)
      length = length + len_trim(words(i))
    end do
  end function joined_length

  !> The trimmed words with the separator between them.
  pure function join(words, separator) result(text)
    character(*), intent(in) :: words(:), separator
    character(joined_length(words, separator)) :: text
    integer :: i, from

    from = 1
    do i = 1, size(words)
      if (i > 1) text(from:from + len(separator) - 1) = separator
      if (i > 1) from = from + len(separator)
      text(from:from + len_trim(words(i)) - 1) = words(i)
      from = from + len_trim(words(i))
    end do
  end function join

  !> The words of a text that blanks separate, padded with blanks; what is longer than these are is cut.
  pure subroutine split(text, words)
    character(*), intent(in) :: text
    character(*), allocatable, intent(out) :: words(:)
    integer :: i, n

    ! A word begins where a blank, or the text's begin, stands before it.
    n = count([(text(i:i) /= ' ' .and. (i == 1 .or. text(max(1, i - 1):max(1, i - 1)) == ' '), i=1, len(text))])
    allocate (words(n))
    n = 0
    do i = 1, len(text)
      if (text(i:i) == ' ') cycle
      if (i > 1) then
        if (text(i - 1:i - 1) /= ' ') cycle
      end if
      n = n + 1
      words(n) = text(i:i + index(text(i:)//' ', ' ') - 2)
    end do
  end subroutine split

  !> Text fit for a one-line message: at most 60 characters, `?` for what is not plain ASCII.
  pure function shown(text) result(clean)
    character(*), intent(in) :: text
    character(min(len(text), longest_shown)) :: clean
    integer :: i

    clean = text(:len(clean))
    if (len(text) > longest_shown) clean(longest_shown - 2:) = '...'
    do i = 1, len(clean)
      if (clean(i:i) < ' ' .or. clean(i:i) > '~') clean(i:i) = '?'
    end do
  end function shown

  !> Which of the words is most like `word`; 0 where none is close enough to be meant.
  pure integer function closest_word(word, words) result(best)
    character(*), intent(in) :: word, words(:)
    integer :: distances(0:len(words)), i, d, least

    best = 0
    least = 2*max(2, len(word)/3) + 2
    do i = 1, size(words)
      distances = edit_distances(word, words(i))
      d = 2*distances(len_trim(words(i)))
      ! A forgotten or superfluous ending, such as a unit, is a likely slip: more so than two characters, less than one.
      d = min(d, 2*minval(distances) + 3)
      if (index(word, trim(words(i))) == 1) d = min(d, 3)
      if (d >= least .or. d >= 2*len(word)) cycle
      least = d
      best = i
    end do
  end function closest_word

  !> How many characters to insert, delete or replace (Levenshtein) between `a` and the first 0, 1 ... characters of `b`.
  pure function edit_distances(a, b) result(row)
    character(*), intent(in) :: a, b
    integer :: row(0:len(b)), i, j, diagonal, above

    row = [(j, j=0, len(b))]
    do i = 1, len(a)
      diagonal = row(0)
      row(0) = i
      do j = 1, len(b)
        above = row(j)
        row(j) = min(above + 1, row(j - 1) + 1, diagonal + merge(0, 1, a(i:i) == b(j:j)))
        diagonal = above
      end do
    end do
  end function edit_distances

  pure subroutine to_integer(text, value, ok)
    character(*), intent(in) :: text
    integer, intent(out) :: value
    logical, intent(out) :: ok
    integer(int64) :: total
    integer :: i, first

    value = 0
    first = 1 + sign_length(text)
    ok = len(text) >= first .and. len(text) <= longest_number .and. verify(text(first:), figures) == 0
    if (.not. ok) return
    total = 0
    do i = first, len(text)
      total = min(10*total + iachar(text(i:i)) - iachar('0'), 10_int64**17)
    end do
    ok = total <= huge(value)
    if (.not. ok) return
    value = int(total)
    if (text(1:1) == '-') value = -value
  end subroutine to_integer

  !> Takes `1`, `1.`, `.5`, `-1e3`, `1d3`; refuses Infinity, NaN and what reaches 1e308.
  pure subroutine to_real(text, value, ok)
    character(*), intent(in) :: text
    real(dp), intent(out) :: value
    logical, intent(out) :: ok
    integer :: first, mark, exponent, status

    value = 0
    first = 1 + sign_length(text)
    mark = scan(text, 'eEdD')
    exponent = 0
    ok = len(text) >= first .and. len(text) <= longest_number
    if (.not. ok) return
    if (mark > 0) call to_integer(text(mark + 1:), exponent, ok)
    if (mark == 0) mark = len(text) + 1
    if (mark <= first) ok = .false.
    if (.not. ok) return
    ok = is_plain(text(first:mark - 1))
    if (.not. ok) return
    ! Decided here, as the run-time library overflows silently or traps.
    exponent = leading_power(text(first:mark - 1)) + max(-100000, min(100000, exponent))
    ok = exponent < 308
    if (.not. ok .or. exponent < -330) return
    read (text, *, iostat=status) value
    ok = status == 0
  end subroutine to_real

  pure integer function sign_length(text)
    character(*), intent(in) :: text

    sign_length = 0
    if (len(text) > 0) sign_length = merge(1, 0, scan(text(1:1), '+-') == 1)
  end function sign_length

  !> Digits with at most one point, and at least one digit.
  pure logical function is_plain(text)
    character(*), intent(in) :: text

    is_plain = verify(text, figures//'.') == 0 .and. scan(text, figures) > 0 &
      & .and. scan(text, '.') == scan(text, '.', back=.true.)
  end function is_plain

  !> The power of ten of the first digit that is not zero; very low for zero itself.
  pure integer function leading_power(text) result(power)
    character(*), intent(in) :: text
    integer :: first, point

    power = -1000000
    first = scan(text, '123456789')
    if (first == 0) return
    point = index(text, '.')
    if (point == 0) point = len(text) + 1
    power = point - first
    if (first < point) power = power - 1
  end function leading_power
end module gearsweep_text
