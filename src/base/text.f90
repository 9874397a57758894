!> Text helpers for messages, tables and readers, and names of characters that cannot be seen.
!>
!> All results have stated lengths, not `len=:`: gfortran 12 keeps the length of such a result in static memory at the call, so
!> that two callers at once would corrupt each other's texts.
module gearsweep_base_text
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite, ieee_is_nan
  use, intrinsic :: iso_fortran_env, only: int64
  use gearsweep_base_kinds, only: dp
  implicit none
  private
  public :: str, fixed, lower, join, split, shown, closest_word, to_number, first_control, find_control, find_odd, utf8, visible, &
            with_blanks

  !> Shortest sensible text of a number or logical: `3.18`, `1600`, `1.2e-7`, `true`.
  interface str
    module procedure str_integer, str_real, str_digits, str_logical
  end interface str

  !> Reads all of `text` as one plain decimal number; `ok` is false for anything else.
  interface to_number
    module procedure to_integer, to_real
  end interface to_number

  character(*), parameter :: figures = '0123456789'
  !> Largest number of characters of a number; longer ones are refused.
  integer, parameter :: longest_number = 100
  integer, parameter :: longest_shown = 60

  character, parameter :: lf = achar(10), cr = achar(13)
  !> End mark of files of some old programs.
  character, parameter :: end_mark = achar(26)
  character(*), parameter :: hex_figures = '0123456789ABCDEF'

  !> Name of a key or column in earlier versions, and its present one.
  character(*), parameter :: former_names(2, 1) = reshape(['member', 'gear  '], [2, 1])

contains

  !> Number of characters of an integer: digits and sign.
  pure integer function integer_length(x) result(length)
    integer, intent(in) :: x
    integer :: remainder

    length = merge(2, 1, x < 0)
    remainder = x/10
    do while (remainder /= 0)
      length = length + 1
      remainder = remainder/10
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

  !> Text of a number with at most 6 significant digits, and without trailing zeros.
  pure function str_real(x) result(text)
    real(dp), intent(in) :: x
    character(real_length(x, 6)) :: text

    text = str_digits(x, 6)
  end function str_real

  !> Text of a number with at most `digits` significant digits (1 to 17).
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
    ! Plainly if that is short, otherwise with an exponent.
    if (exponent < -4 .or. exponent >= max(n, len(mantissa))) then
      text = mantissa(1:1)
      if (len(mantissa) > 1) text = text//'.'//mantissa(2:)
      text = text//'e'//str_integer(exponent)
    else if (exponent < 0) then
      text = '0.'//repeat('0', -exponent - 1)//mantissa
    else if (len(mantissa) <= exponent + 1) then
      text = mantissa//repeat('0', exponent + 1 - len(mantissa))
    else
      text = mantissa(:exponent + 1)//'.'//mantissa(exponent + 2:)
    end if
    if (x < 0) text = '-'//text
  end subroutine write_real

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

  !> Text of a number with this many decimals; very large numbers as in `str`.
  pure function fixed(x, decimals) result(text)
    real(dp), intent(in) :: x
    integer, intent(in) :: decimals
    character(fixed_length(x, decimals)) :: text

    text = fixed_padded(x, decimals)
  end function fixed

  !> Text with ASCII letters in lower case, others unchanged.
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

  !> Replaces each underscore by a blank.
  pure function with_blanks(text) result(other)
    character(*), intent(in) :: text
    character(len(text)) :: other
    integer :: k

    do k = 1, len(text)
      other(k:k) = merge(' ', text(k:k), text(k:k) == '_')
    end do
  end function with_blanks

  pure integer function joined_length(words, separator) result(length)
    character(*), intent(in) :: words(:), separator
    integer :: i

    length = len(separator)*max(0, size(words) - 1)
    do i = 1, size(words)
      length = length + len_trim(words(i))
    end do
  end function joined_length

  !> Trimmed words with the separator between them.
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

  !> Splits a text at blanks into words, padded with blanks; longer words are cut.
  pure subroutine split(text, words)
    character(*), intent(in) :: text
    character(*), allocatable, intent(out) :: words(:)
    integer :: i, n

    ! A word begins after a blank, or at the start of the text.
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

  !> Number of bytes at the start of a long text shown in a message; no character is cut in two.
  pure integer function shown_until(text) result(last)
    character(*), intent(in) :: text

    last = len(text)
    if (last <= longest_shown) return
    last = longest_shown - 3
    do while (last > longest_shown - 6)
      ! Bytes that continue a character of UTF-8.
      if (iand(iachar(text(last + 1:last + 1)), 192) /= 128) exit
      last = last - 1
    end do
  end function shown_until

  pure integer function shown_length(text) result(length)
    character(*), intent(in) :: text
    integer :: last

    last = shown_until(text)
    length = utf8_length(text(:last), .true.) + merge(3, 0, last < len(text))
  end function shown_length

  !> Text for a one-line message: about 60 characters, with `<U+00A0>` and the like for invisible characters.
  pure function shown(text) result(clean)
    character(*), intent(in) :: text
    character(shown_length(text)) :: clean

    clean = visible(text(:shown_until(text)))
    if (shown_until(text) < len(text)) clean(len(clean) - 2:) = '...'
  end function shown

  !> Index of the present name where `word` is a former one, otherwise of the word most similar to it; 0 if none is similar enough.
  pure integer function closest_word(word, words) result(best)
    character(*), intent(in) :: word, words(:)
    integer :: distances(0:len(words)), i, d, least

    best = 0
    least = 2*max(2, len(word)/3) + 2
    do i = 1, size(words)
      if (any(former_names(1, :) == word .and. former_names(2, :) == words(i))) then
        best = i
        return
      end if
    end do
    do i = 1, size(words)
      distances = edit_distances(word, words(i))
      d = 2*distances(len_trim(words(i)))
      ! A missing or superfluous ending, such as a unit, is a likely error: more than two characters, less than one.
      d = min(d, 2*minval(distances) + 3)
      if (index(word, trim(words(i))) == 1) d = min(d, 3)
      if (d >= least .or. d >= 2*len(word)) cycle
      least = d
      best = i
    end do
  end function closest_word

  !> Numbers of characters to insert, delete or replace (Levenshtein) between `a` and the first 0, 1 ... characters of `b`.
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

  !> Converts `1`, `1.`, `.5`, `-1e3`, `1d3`; refuses Infinity, NaN and numbers of 1e308 and more.
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
    associate (number => text(first:mark - 1))
      ! Digits with at most one point, and at least one digit.
      ok = verify(number, figures//'.') == 0 .and. scan(number, figures) > 0 .and. &
           scan(number, '.') == scan(number, '.', back=.true.)
    end associate
    if (.not. ok) return
    ! Checked here, as the run-time library overflows silently or traps.
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

  !> Power of ten of the first digit that is not zero; very low for zero itself.
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

  !> Position of the first control character, 0 for none: of ASCII all but tabs, line ends, and end marks at the end, and the
  !> controls from 128 to 159, as UTF-8 or as a byte that is part of no UTF-8 character.
  pure integer function first_control(text) result(at)
    character(*), intent(in) :: text
    integer :: length, code

    at = 1
    do while (at <= len(text))
      call read_character(text, at, code, length)
      select case (code)
      case (9, 10, 13)
      case (26)
        if (verify(text(at:), end_mark//lf//cr) > 0) return
      case (0:8, 11:12, 14:25, 27:31, 127:159)
        return
      case default
      end select
      at = at + length
    end do
    at = 0
  end function first_control

  !> Finds the line of the first control character, 0 for none, and its name, for a message.
  pure subroutine find_control(text, line, words)
    character(*), intent(in) :: text
    integer, intent(out) :: line
    character(:), allocatable, intent(out) :: words
    character(*), parameter :: wide(*) = [achar(255)//achar(254), achar(254)//achar(255)]
    character(3) :: number
    integer :: at, code, length, i

    line = 0
    at = first_control(text)
    if (at == 0) return
    line = 1
    if (any(wide == text(:min(2, len(text)))) .or. count([text(:1), text(2:min(2, len(text)))] == achar(0)) == 1) then
      words = 'the text is in UTF-16; save it in UTF-8'
      return
    end if
    do i = 1, at - 1
      if (text(i:i) == lf) line = line + 1
      if (text(i:i) == cr .and. text(i + 1:i + 1) /= lf) line = line + 1
    end do
    call read_character(text, at, code, length)
    write (number, '(i0)') code
    words = 'a control character (code '//trim(number)//')'
    if (code > 127) words = words//'; save the text in UTF-8'
  end subroutine find_control

  !> Finds the first character outside ASCII, in words that suggest a replacement; empty for none. With `alike` only characters
  !> that look like one of ASCII, or are invisible.
  pure subroutine find_odd(text, words, alike)
    character(*), intent(in) :: text
    character(:), allocatable, intent(out) :: words
    logical, intent(in) :: alike
    character(:), allocatable :: name, cure
    integer :: at, code, length

    words = ''
    at = 1
    do while (at <= len(text))
      call read_character(text, at, code, length)
      if (code > 127) then
        call explain(code, name, cure)
        if (len(name) > 0 .or. .not. alike) exit
      end if
      at = at + length
    end do
    if (at > len(text)) return
    if (.not. is_unseen(code)) words = ''''//utf8(text(at:at + length - 1))//''' is '
    words = words//'U+'//hexadecimal(code)
    if (len(name) == 0) then
      words = words//', which may be in quotation marks and remarks only'
    else if (is_unseen(code)) then
      words = words//' is '//name//'; '//cure
    else
      words = words//', '//name//'; '//cure
    end if
  end subroutine find_odd

  !> Explains characters that text programs and web pages write for one of ASCII; empty for others.
  pure subroutine explain(code, name, cure)
    integer, intent(in) :: code
    character(:), allocatable, intent(out) :: name, cure

    name = ''
    cure = 'type '''
    select case (code)
    case (int(z'2212'))
      name = 'a minus sign of text programs'
    case (int(z'2010'), int(z'2011'), int(z'FE63'), int(z'FF0D'))
      name = 'a hyphen of text programs'
    case (int(z'2012'), int(z'2013'))
      name = 'an en dash'
    case (int(z'2014'), int(z'2015'))
      name = 'an em dash'
    case (int(z'B4'), int(z'2018'):int(z'201F'), int(z'2032'), int(z'2033'), int(z'AB'), int(z'BB'), int(z'2039'), int(z'203A'))
      name = 'a quotation mark of text programs'
      cure = 'type a plain one'
      return
    case (int(z'D7'), int(z'B7'), int(z'22C5'), int(z'2217'))
      name = 'a multiplication sign'
      cure = cure//'*'''
      return
    case (int(z'FF01'):int(z'FF0C'), int(z'FF0E'):int(z'FF5E'))
      name = 'a character of full width'
      cure = cure//achar(code - int(z'FF01') + iachar('!'))//''''
      return
    case (int(z'A0'), int(z'202F'), int(z'2007'))
      name = 'a no-break space'
      cure = 'type a plain blank'
      return
    case (int(z'2000'):int(z'2006'), int(z'2008'):int(z'200A'), int(z'205F'), int(z'3000'))
      name = 'a space of text programs'
      cure = 'type a plain blank'
      return
    case (int(z'200B'))
      name = 'a zero-width space'
    case (int(z'AD'))
      name = 'a soft hyphen'
    case (int(z'2028'), int(z'2029'))
      name = 'a line end of text programs'
    case (int(z'FEFF'))
      name = 'a byte order mark of zero width'
    case default
      if (is_unseen(code)) name = 'a character of zero width'
    end select
    cure = cure//'-'''
    if (is_unseen(code)) cure = 'remove it'
  end subroutine explain

  !> True for controls, spaces other than the plain one, and characters without width or that change the direction of writing.
  pure logical function is_unseen(code)
    integer, intent(in) :: code

    select case (code)
    case (0:31, 127:160, int(z'AD'), int(z'61C'), int(z'180E'), int(z'2000'):int(z'200F'), int(z'2028'):int(z'202F'), &
          int(z'205F'):int(z'206F'), int(z'3000'), int(z'FE00'):int(z'FE0F'), int(z'FEFF'), int(z'FFF9'):int(z'FFFB'))
      is_unseen = .true.
    case default
      is_unseen = .false.
    end select
  end function is_unseen

  !> Reads the code of the character that begins here, and its number of bytes. A byte that is part of no UTF-8 character is read
  !> as Latin-1.
  pure subroutine read_character(text, at, code, length)
    character(*), intent(in) :: text
    integer, intent(in) :: at
    integer, intent(out) :: code, length
    !> For characters of one, two, three and four bytes: the mark in the first byte, and the smallest code.
    integer, parameter :: mark(4) = [0, 192, 224, 240], least(4) = [0, 128, 2048, 65536]
    integer :: i

    code = iachar(text(at:at))
    length = 1
    if (code < 194 .or. code > 244) return
    length = 2 + count(code >= mark(3:))
    if (at + length - 1 <= len(text)) then
      code = code - mark(length)
      do i = at + 1, at + length - 1
        if (iand(iachar(text(i:i)), 192) /= 128) exit
        code = 64*code + iachar(text(i:i)) - 128
      end do
      ! Neither too long an encoding, nor half of a pair of UTF-16, nor above the last code.
      if (i == at + length .and. code >= least(length) .and. code < int(z'110000') .and. code/2048 /= 27) return
    end if
    code = iachar(text(at:at))
    length = 1
  end subroutine read_character

  !> Number of bytes of the text in UTF-8; if invisible characters are `named`, with these as `<U+00A0>`.
  pure integer function utf8_length(text, named) result(n)
    character(*), intent(in) :: text
    logical, intent(in) :: named
    integer :: at, code, length

    n = 0
    at = 1
    do while (at <= len(text))
      call read_character(text, at, code, length)
      n = n + merge(8, merge(2, length, length == 1 .and. code > 127), named .and. is_unseen(code))
      at = at + length
    end do
  end function utf8_length

  !> Text in UTF-8; other bytes are read as Latin-1.
  pure function utf8(text) result(clean)
    character(*), intent(in) :: text
    character(utf8_length(text, .false.)) :: clean
    integer :: at, code, length, n

    n = 0
    at = 1
    do while (at <= len(text))
      call read_character(text, at, code, length)
      if (length == 1 .and. code > 127) then
        clean(n + 1:n + 2) = achar(192 + code/64)//achar(128 + modulo(code, 64))
        n = n + 2
      else
        clean(n + 1:n + length) = text(at:at + length - 1)
        n = n + length
      end if
      at = at + length
    end do
  end function utf8

  !> Text in UTF-8 on one line, with invisible characters as `<U+00A0>`.
  pure function visible(text) result(clean)
    character(*), intent(in) :: text
    character(utf8_length(text, .true.)) :: clean
    integer :: at, code, length, n

    n = 0
    at = 1
    do while (at <= len(text))
      call read_character(text, at, code, length)
      if (is_unseen(code)) then
        clean(n + 1:n + 8) = '<U+'//hexadecimal(code)//'>'
        n = n + 8
      else
        clean(n + 1:n + merge(2, length, length == 1 .and. code > 127)) = utf8(text(at:at + length - 1))
        n = n + merge(2, length, length == 1 .and. code > 127)
      end if
      at = at + length
    end do
  end function visible

  !> Hexadecimal name of a code below 65536; larger ones, with five or six digits, do not occur in messages.
  pure function hexadecimal(code) result(word)
    integer, intent(in) :: code
    character(merge(4, 6, code < 65536)) :: word
    integer :: i, remainder

    remainder = code
    do i = len(word), 1, -1
      word(i:i) = hex_figures(modulo(remainder, 16) + 1:modulo(remainder, 16) + 1)
      remainder = remainder/16
    end do
  end function hexadecimal
end module gearsweep_base_text
