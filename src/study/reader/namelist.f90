!> Splits Fortran namelist text into groups, keys and values, without regard to their meaning.
!>
!> Fortran's own namelist input is not used, as it does not report unknown, missing or wrong keys. A key without a value after its
!> `=` counts as absent. Strings end on their line.
module gearsweep_study_reader_namelist
  use gearsweep_base, only: claim_memory, dp, error_t, find_control, find_odd, lower, shown, str, to_number, utf8
  use gearsweep_study_reader_entries, only: builder_t, entry_t, fail_at, longest_text, name_length, namelist_t, value_t
  implicit none
  private
  public :: value_t, entry_t, namelist_t, name_length, parse_namelist

  integer, parameter :: largest_count = 100000

  !> State of the scan of the text.
  type :: scanner_t
    integer :: at = 1, line = 1
    integer :: item = 1                          !< position of the start of the last item
    type(builder_t) :: builder
  end type scanner_t

  character, parameter :: tab = achar(9), lf = achar(10), cr = achar(13), end_mark = achar(26)
  character(*), parameter :: blanks = ' '//tab//end_mark, line_ends = cr//lf, quotes = '''"'
  character(*), parameter :: word_ends = blanks//line_ends//quotes//',/!=&'
  character(*), parameter :: figures = '0123456789'

contains

  !> Splits the text. Lines end in LF, CRLF or CR. Every error names its line.
  pure subroutine parse_namelist(text, namelist, error)
    character(*), intent(in) :: text
    type(namelist_t), intent(out) :: namelist
    type(error_t), allocatable, intent(inout) :: error
    character(*), parameter :: bom = char(239)//char(187)//char(191)
    type(scanner_t) :: s

    call claim_memory(30.0_dp*len(text), 'the text of the case', error)
    if (allocated(error)) return
    call check_characters(text, error)
    if (index(text(:min(3, len(text))), bom) == 1) s%at = len(bom) + 1
    do while (.not. allocated(error))
      call skip_blanks(text, s)
      if (s%at > len(text)) exit
      call read_item(text, s, error)
    end do
    call s%builder%finish(s%line, namelist, error)
  end subroutine parse_namelist

  !> Reads one item; its first character decides its kind.
  pure subroutine read_item(text, s, error)
    character(*), intent(in) :: text
    type(scanner_t), intent(inout) :: s
    type(error_t), allocatable, intent(inout) :: error
    character :: next

    next = text(s%at:s%at)
    s%item = s%at
    if (next == '&' .or. next == '$') then
      call read_group_mark(text, s, error)
    else if (.not. s%builder%in_group) then
      call refuse_odd(text, s%at, word_end(text, s%at), s, error)
      call fail_at(s%line, 'text outside a group: '//shown(text(s%at:line_end(text, s%at))), error)
    else if (next == '/') then
      s%at = s%at + 1
      call s%builder%close_group(s%item)
    else if (next == ',') then
      s%at = s%at + 1
      call s%builder%add_comma(s%line, error)
    else if (next == '=') then
      call fail_at(s%line, 'no key in front of =', error)
    else if (scan(next, quotes) == 1) then
      call read_string(text, s, 1, error)
    else
      call read_word(text, s, error)
    end if
  end subroutine read_item

  !> Reads a group mark: `&name` opens a group, `&end` or `&` closes one; old Fortran has `$` for `&`.
  pure subroutine read_group_mark(text, s, error)
    character(*), intent(in) :: text
    type(scanner_t), intent(inout) :: s
    type(error_t), allocatable, intent(inout) :: error
    integer :: last

    last = word_end(text, s%at + 1)
    associate (name => text(s%at + 1:last))
      call refuse_odd(text, s%at, last, s, error)
      if (s%builder%in_group .and. (lower(name) == 'end' .or. len(name) == 0)) then
        call s%builder%close_group(s%item)
      else
        call s%builder%open_group(lower(name), s%line, error)
      end if
    end associate
    s%at = last + 1
  end subroutine read_group_mark

  !> Reads a bare word: a key if `=` follows, otherwise a value.
  pure subroutine read_word(text, s, error)
    character(*), intent(in) :: text
    type(scanner_t), intent(inout) :: s
    type(error_t), allocatable, intent(inout) :: error
    integer :: first, last, line, count

    first = s%at
    last = index_end(text, first)
    line = s%line
    s%at = last + 1
    call refuse_odd(text, first, last, s, error)
    call take_count(text, first, last, line, count, error)
    if (next_is(text, s%at, quotes)) then
      if (first <= last) call fail_at(line, 'a quote inside '//shown(text(first:s%at)), error)
      call read_string(text, s, count, error)
      return
    end if
    call skip_blanks(text, s)
    if (count == 1 .and. next_is(text, s%at, '=')) then
      s%at = s%at + 1
      call s%builder%open_key(lower(text(first:last)), s%item, line, error)
    else
      if (first > last) call fail_at(line, 'a repeat count without a value', error)
      call s%builder%add_value(value_t(text(first:last), .false.), count, s%item, last, line, error)
    end if
  end subroutine read_word

  !> Reads a repeat count such as `3*` at the start of the word, and moves `first` past it.
  pure subroutine take_count(text, first, last, line, count, error)
    character(*), intent(in) :: text
    integer, intent(inout) :: first
    integer, intent(in) :: last, line
    integer, intent(out) :: count
    type(error_t), allocatable, intent(inout) :: error
    integer :: star
    logical :: ok

    count = 1
    star = verify(text(first:last), figures)
    if (star < 2) return
    star = first + star - 1
    if (text(star:star) /= '*') return
    call to_number(text(first:star - 1), count, ok)
    if (ok) ok = count >= 1 .and. count <= largest_count
    if (.not. ok) call fail_at(line, 'a repeat count must be 1 to '//str(largest_count) &
      & //': '//shown(text(first:last)), error)
    first = star + 1
  end subroutine take_count

  !> Reads a string in either kind of quotes; a doubled quote inside is one quote.
  pure subroutine read_string(text, s, count, error)
    character(*), intent(in) :: text
    type(scanner_t), intent(inout) :: s
    integer, intent(in) :: count
    type(error_t), allocatable, intent(inout) :: error
    character :: quote
    character(:), allocatable :: string
    integer :: first, n

    if (allocated(error)) return
    quote = text(s%at:s%at)
    first = s%at
    do
      s%at = s%at + 1
      if (s%at > len(text) .or. next_is(text, s%at, line_ends)) then
        call fail_at(s%line, 'a string is never closed: '//shown(text(first:line_end(text, first))), error)
        return
      end if
      if (text(s%at:s%at) /= quote) cycle
      if (.not. next_is(text, s%at + 1, quote)) exit
      s%at = s%at + 1
    end do
    call undouble(text(first + 1:s%at - 1), quote, string, n)
    string = utf8(string(:n))
    s%at = s%at + 1
    if (s%at <= len(text) .and. .not. next_is(text, s%at, blanks//line_ends//',/!&=')) &
      & call fail_at(s%line, 'no blank or comma behind '//shown(text(first:s%at)), error)
    call s%builder%add_value(value_t(string, .true.), count, s%item, s%at - 1, s%line, error)
  end subroutine read_string

  !> Replaces each doubled quote by one.
  pure subroutine undouble(text, quote, string, n)
    character(*), intent(in) :: text
    character, intent(in) :: quote
    character(:), allocatable, intent(out) :: string
    integer, intent(out) :: n
    integer :: i

    string = text
    n = 0
    i = 0
    do while (i < len(text))
      i = i + 1
      if (text(i:i) == quote) i = i + 1
      n = n + 1
      string(n:n) = text(i:i)
    end do
  end subroutine undouble

  !> Skips blanks, line ends and comments.
  pure subroutine skip_blanks(text, s)
    character(*), intent(in) :: text
    type(scanner_t), intent(inout) :: s

    do while (s%at <= len(text))
      if (next_is(text, s%at, line_ends)) then
        if (.not. (text(s%at:s%at) == cr .and. next_is(text, s%at + 1, lf))) s%line = s%line + 1
      else if (text(s%at:s%at) == '!') then
        s%at = line_end(text, s%at)
      else if (scan(text(s%at:s%at), blanks) == 0) then
        exit
      end if
      s%at = s%at + 1
    end do
  end subroutine skip_blanks

  !> Refuses control characters other than tabs and line ends.
  pure subroutine check_characters(text, error)
    character(*), intent(in) :: text
    type(error_t), allocatable, intent(inout) :: error
    character(:), allocatable :: control
    integer :: line

    if (len(text) > longest_text) then
      call fail_at(1, 'the text is longer than 10 MB', error)
      return
    end if
    call find_control(text, line, control)
    if (line > 0) call fail_at(line, control, error)
  end subroutine check_characters

  pure logical function next_is(text, at, characters)
    character(*), intent(in) :: text, characters
    integer, intent(in) :: at

    next_is = .false.
    if (at <= len(text)) next_is = scan(text(at:at), characters) == 1
  end function next_is

  !> Position of the last character of the word, or of the line, that starts at `first`.
  pure integer function word_end(text, first)
    character(*), intent(in) :: text
    integer, intent(in) :: first

    word_end = scan(text(first:), word_ends) + first - 2
    if (word_end == first - 2) word_end = len(text)
  end function word_end

  !> Position of the end of the word that begins at `first`, including an index in brackets if = follows.
  pure integer function index_end(text, first) result(last)
    character(*), intent(in) :: text
    integer, intent(in) :: first
    integer :: behind

    last = word_end(text, first)
    if (index(text(first:last), '(') == 0 .and. .not. next_is(text, next_at(text, last + 1), '(')) return
    behind = first - 1 + scan(text(first:), ')'//line_ends)
    if (.not. next_is(text, behind, ')')) return
    if (next_is(text, next_at(text, behind + 1), '=')) last = max(last, behind)
  end function index_end

  !> Position of the next nonblank character on the line.
  pure integer function next_at(text, from) result(at)
    character(*), intent(in) :: text
    integer, intent(in) :: from

    at = from
    do while (next_is(text, at, blanks))
      at = at + 1
    end do
  end function next_at

  !> Refuses characters other than ASCII outside quotation marks; the error names the first one.
  pure subroutine refuse_odd(text, first, last, s, error)
    character(*), intent(in) :: text
    integer, intent(in) :: first, last           !< first and last character of the word
    type(scanner_t), intent(in) :: s
    type(error_t), allocatable, intent(inout) :: error
    character(:), allocatable :: odd, place

    call find_odd(text(first:last), odd, alike=.false.)
    if (len(odd) == 0) return
    call s%builder%tell_place(.not. next_is(text, next_at(text, last + 1), '='), place)
    call fail_at(s%line, place//shown(text(first:last))//': '//odd, error)
  end subroutine refuse_odd

  pure integer function line_end(text, first)
    character(*), intent(in) :: text
    integer, intent(in) :: first

    line_end = scan(text(first:), line_ends) + first - 2
    if (line_end == first - 2) line_end = len(text)
  end function line_end
end module gearsweep_study_reader_namelist
