!> Splits Fortran namelist text into groups, keys and values; what they mean is not its concern.
!>
!> Own code, as Fortran's namelist input cannot say what is unknown, missing or wrong.
!> A key with nothing behind its `=` counts as not given. Strings end on their line.
module gearsweep_namelist
  use, intrinsic :: iso_fortran_env, only: int64
  use gearsweep_error, only: code_input, error_t, fail
  use gearsweep_text, only: lower, shown, str, to_number
  implicit none
  private
  public :: value_t, entry_t, namelist_t, parse_namelist

  !> Names are as long as Fortran's at most.
  integer, parameter, public :: name_length = 63
  !> Beyond these sizes no text is a case.
  integer, parameter :: longest_text = 10*1000*1000, largest_count = 100000, most_names = 1000

  type :: value_t
    character(:), allocatable :: text
    logical :: quoted = .false.
  end type value_t

  !> One key that was given, with all its values (at least one).
  type :: entry_t
    character(:), allocatable :: group, key
    type(value_t), allocatable :: values(:)
    integer :: line = 0
    !> Places in the text: the key's first character, its values' first and last.
    integer :: at = 0, first = 0, last = 0
    !> For the reader: somebody asked for this key.
    logical :: used = .false.
  end type entry_t

  type :: namelist_t
    character(name_length), allocatable :: groups(:)
    integer, allocatable :: ends(:)              !< places in the text where the groups are closed
    type(entry_t), allocatable :: entries(:)
  end type namelist_t

  !> How far the text has been read, and what is open at that place.
  type :: scanner_t
    integer :: at = 1, line = 1
    integer :: item = 1                          !< where the last item began
    logical :: in_group = .false., in_key = .false.
    integer :: group_line = 0
    !> Values of the open key, and commas since the last of them.
    integer :: values = 0, commas = 0
    !> All groups, entries and keys so far; keys without a value make no entry.
    integer :: groups = 0, entries = 0, keys = 0
    !> Room that the values take, which repeat counts could blow up.
    integer(int64) :: stored = 0
  end type scanner_t

  character, parameter :: tab = achar(9), lf = achar(10), cr = achar(13)
  character(*), parameter :: blanks = ' '//tab//cr, quotes = '''"'
  character(*), parameter :: word_ends = blanks//lf//quotes//',/!=&'
  character(*), parameter :: figures = '0123456789', letters = 'abcdefghijklmnopqrstuvwxyz_'

contains

  !> Lines end in LF or CRLF. Every failure names its line.
  pure subroutine parse_namelist(text, namelist, error)
    character(*), intent(in) :: text
    type(namelist_t), intent(out) :: namelist
    type(error_t), allocatable, intent(inout) :: error
    character(*), parameter :: bom = char(239)//char(187)//char(191)
    type(scanner_t) :: s

    if (allocated(error)) return
    allocate (namelist%groups(most_names), namelist%ends(most_names), namelist%entries(most_names))
    call check_characters(text, error)
    if (index(text(:min(3, len(text))), bom) == 1) s%at = len(bom) + 1
    do while (.not. allocated(error))
      call skip_blanks(text, s)
      if (s%at > len(text)) exit
      call read_item(text, s, namelist, error)
    end do
    if (s%in_group) call fail_open(s, namelist, error)
    if (s%groups == 0) call fail_at(s%line, 'there is no group, such as &pair ... /', error)
    namelist%groups = namelist%groups(:s%groups)
    namelist%ends = namelist%ends(:s%groups)
    namelist%entries = namelist%entries(:s%entries)
  end subroutine parse_namelist

  !> One step: the next character decides what comes.
  pure subroutine read_item(text, s, namelist, error)
    character(*), intent(in) :: text
    type(scanner_t), intent(inout) :: s
    type(namelist_t), intent(inout) :: namelist
    type(error_t), allocatable, intent(inout) :: error
    character :: next

    next = text(s%at:s%at)
    s%item = s%at
    if (next == '&') then
      call read_group_mark(text, s, namelist, error)
    else if (.not. s%in_group) then
      call fail_at(s%line, 'text outside a group: '//shown(text(s%at:line_end(text, s%at))), error)
    else if (next == '/') then
      s%at = s%at + 1
      call close_group(s, namelist)
    else if (next == ',') then
      s%at = s%at + 1
      s%commas = s%commas + 1
      if (.not. s%in_key) call fail_at(s%line, 'a comma without a key', error)
      if (s%commas > 1) call fail_at(s%line, 'no value between two commas', error)
    else if (next == '=') then
      call fail_at(s%line, 'no key in front of =', error)
    else if (scan(next, quotes) == 1) then
      call read_string(text, s, 1, namelist, error)
    else
      call read_word(text, s, namelist, error)
    end if
  end subroutine read_item

  !> `&name` opens a group, `&end` closes one.
  pure subroutine read_group_mark(text, s, namelist, error)
    character(*), intent(in) :: text
    type(scanner_t), intent(inout) :: s
    type(namelist_t), intent(inout) :: namelist
    type(error_t), allocatable, intent(inout) :: error
    character(:), allocatable :: name

    name = lower(text(s%at + 1:word_end(text, s%at + 1)))
    s%at = s%at + 1 + len(name)
    if (s%in_group .and. name == 'end') then
      call close_group(s, namelist)
    else if (s%in_group) then
      call fail_open(s, namelist, error)
    else if (name == 'end' .or. .not. is_name(name)) then
      call fail_at(s%line, 'no group can be called &'//shown(name), error)
    else if (any(namelist%groups(:s%groups) == name)) then
      call fail_at(s%line, 'group &'//name//' is given twice', error)
    else if (s%groups == most_names) then
      call fail_at(s%line, 'more than '//str(most_names)//' groups', error)
    else
      s%groups = s%groups + 1
      namelist%groups(s%groups) = name
      s%in_group = .true.
      s%group_line = s%line
    end if
  end subroutine read_group_mark

  !> A bare word is a key if `=` follows, and a value otherwise.
  pure subroutine read_word(text, s, namelist, error)
    character(*), intent(in) :: text
    type(scanner_t), intent(inout) :: s
    type(namelist_t), intent(inout) :: namelist
    type(error_t), allocatable, intent(inout) :: error
    integer :: first, last, line, count

    first = s%at
    last = word_end(text, first)
    line = s%line
    s%at = last + 1
    call take_count(text, first, last, line, count, error)
    if (next_is(text, s%at, quotes)) then
      if (first <= last) call fail_at(line, 'a quote inside '//shown(text(first:s%at)), error)
      call read_string(text, s, count, namelist, error)
      return
    end if
    call skip_blanks(text, s)
    if (count == 1 .and. next_is(text, s%at, '=')) then
      s%at = s%at + 1
      call open_key(lower(text(first:last)), line, s, namelist, error)
    else
      if (first > last) call fail_at(line, 'a repeat count without a value', error)
      call add_value(value_t(text(first:last), .false.), count, line, last, s, namelist, error)
    end if
  end subroutine read_word

  !> Moves `first` behind a repeat count such as `3*`, if the word starts with one.
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

  !> A string in either kind of quotes, which stand for themselves when doubled.
  pure subroutine read_string(text, s, count, namelist, error)
    character(*), intent(in) :: text
    type(scanner_t), intent(inout) :: s
    integer, intent(in) :: count
    type(namelist_t), intent(inout) :: namelist
    type(error_t), allocatable, intent(inout) :: error
    character :: quote
    character(:), allocatable :: string
    integer :: first, n

    if (allocated(error)) return
    quote = text(s%at:s%at)
    first = s%at
    do
      s%at = s%at + 1
      if (s%at > len(text) .or. next_is(text, s%at, lf)) then
        call fail_at(s%line, 'a string is never closed: '//shown(text(first:line_end(text, first))), error)
        return
      end if
      if (text(s%at:s%at) /= quote) cycle
      if (.not. next_is(text, s%at + 1, quote)) exit
      s%at = s%at + 1
    end do
    call undouble(text(first + 1:s%at - 1), quote, string, n)
    s%at = s%at + 1
    if (s%at <= len(text) .and. .not. next_is(text, s%at, blanks//lf//',/!&=')) &
      & call fail_at(s%line, 'no blank or comma behind '//shown(text(first:s%at)), error)
    call add_value(value_t(string(:n), .true.), count, s%line, s%at - 1, s, namelist, error)
  end subroutine read_string

  !> Every quote that stands for itself comes twice: keeps one.
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

  pure subroutine open_key(key, line, s, namelist, error)
    character(*), intent(in) :: key
    integer, intent(in) :: line
    type(scanner_t), intent(inout) :: s
    type(namelist_t), intent(inout) :: namelist
    type(error_t), allocatable, intent(inout) :: error
    integer :: i

    call close_key(s, namelist)
    if (index(key, '(') > 0) call fail_at(line, 'keys with an index are not supported: '//shown(key), error)
    if (index(key, '%') > 0) call fail_at(line, 'keys with parts are not supported: '//shown(key), error)
    if (.not. is_name(key)) call fail_at(line, 'this is no key: '//shown(key), error)
    s%keys = s%keys + 1
    if (s%keys > most_names) call fail_at(line, 'more than '//str(most_names)//' keys', error)
    if (allocated(error)) return
    do i = 1, s%entries
      if (namelist%entries(i)%key /= key) cycle
      if (namelist%entries(i)%group /= namelist%groups(s%groups)) cycle
      call fail_at(line, 'key '//key//' is given twice in &'//trim(namelist%groups(s%groups)), error)
      return
    end do
    s%in_key = .true.
    s%entries = s%entries + 1
    associate (entry => namelist%entries(s%entries))
      entry%group = trim(namelist%groups(s%groups))
      entry%key = key
      entry%at = s%item
      entry%line = line
    end associate
  end subroutine open_key

  !> Keeps the open key if it got values.
  pure subroutine close_key(s, namelist)
    type(scanner_t), intent(inout) :: s
    type(namelist_t), intent(inout) :: namelist

    if (s%in_key .and. s%values == 0) s%entries = s%entries - 1
    if (s%values > 0) call resize(namelist%entries(s%entries)%values, s%values, s%values)
    s%in_key = .false.
    s%values = 0
    s%commas = 0
  end subroutine close_key

  pure subroutine close_group(s, namelist)
    type(scanner_t), intent(inout) :: s
    type(namelist_t), intent(inout) :: namelist

    call close_key(s, namelist)
    namelist%ends(s%groups) = s%item
    s%in_group = .false.
  end subroutine close_group

  !> `line` and `last` are where it stands.
  pure subroutine add_value(value, count, line, last, s, namelist, error)
    type(value_t), intent(in) :: value
    integer, intent(in) :: count, line, last
    type(scanner_t), intent(inout) :: s
    type(namelist_t), intent(inout) :: namelist
    type(error_t), allocatable, intent(inout) :: error
    integer :: i

    s%stored = s%stored + int(count, int64)*(len(value%text) + 1)
    if (.not. s%in_key) call fail_at(line, 'a value without a key: '//shown(value%text), error)
    if (s%values == 0 .and. s%commas > 0) call fail_at(line, 'no value in front of a comma', error)
    if (s%stored > longest_text + 1) call fail_at(line, 'the repeated values are too many', error)
    if (allocated(error)) return
    s%commas = 0
    associate (entry => namelist%entries(s%entries))
      if (.not. allocated(entry%values)) allocate (entry%values(0))
      if (s%values == 0) entry%first = s%item
      entry%last = last
      if (s%values + count > size(entry%values)) &
        & call resize(entry%values, s%values, 2*(s%values + count))
      do i = s%values + 1, s%values + count
        entry%values(i) = value
      end do
    end associate
    s%values = s%values + count
  end subroutine add_value

  !> Keeps the first `kept` values and moves their texts instead of copying them.
  pure subroutine resize(values, kept, length)
    type(value_t), allocatable, intent(inout) :: values(:)
    integer, intent(in) :: kept, length
    type(value_t), allocatable :: old(:)
    integer :: i

    if (length == size(values)) return
    call move_alloc(values, old)
    allocate (values(length))
    do i = 1, kept
      call move_alloc(old(i)%text, values(i)%text)
      values(i)%quoted = old(i)%quoted
    end do
  end subroutine resize

  !> Blanks, line ends and comments.
  pure subroutine skip_blanks(text, s)
    character(*), intent(in) :: text
    type(scanner_t), intent(inout) :: s

    do while (s%at <= len(text))
      if (text(s%at:s%at) == lf) then
        s%line = s%line + 1
      else if (text(s%at:s%at) == '!') then
        s%at = line_end(text, s%at)
      else if (scan(text(s%at:s%at), blanks) == 0) then
        exit
      end if
      s%at = s%at + 1
    end do
  end subroutine skip_blanks

  !> Control characters have no place in a case; tabs and line ends have.
  pure subroutine check_characters(text, error)
    character(*), intent(in) :: text
    type(error_t), allocatable, intent(inout) :: error
    integer :: i, line

    line = 1
    if (len(text) > longest_text) call fail_at(line, 'the text is longer than 10 MB', error)
    if (allocated(error)) return
    do i = 1, len(text)
      if (text(i:i) == lf) line = line + 1
      if (text(i:i) >= ' ' .and. text(i:i) /= achar(127)) cycle
      if (text(i:i) == lf .or. text(i:i) == tab) cycle
      if (text(i:i) == cr .and. (i == len(text) .or. next_is(text, i + 1, lf))) cycle
      call fail_at(line, 'a control character (code '//str(iachar(text(i:i)))//')', error)
      return
    end do
  end subroutine check_characters

  pure logical function next_is(text, at, characters)
    character(*), intent(in) :: text, characters
    integer, intent(in) :: at

    next_is = .false.
    if (at <= len(text)) next_is = scan(text(at:at), characters) == 1
  end function next_is

  !> The last character of the word, or of the line, that starts at `first`.
  pure integer function word_end(text, first)
    character(*), intent(in) :: text
    integer, intent(in) :: first

    word_end = scan(text(first:), word_ends) + first - 2
    if (word_end == first - 2) word_end = len(text)
  end function word_end

  pure integer function line_end(text, first)
    character(*), intent(in) :: text
    integer, intent(in) :: first

    line_end = index(text(first:), lf) + first - 2
    if (line_end == first - 2) line_end = len(text)
  end function line_end

  pure logical function is_name(text)
    character(*), intent(in) :: text

    is_name = .false.
    if (len(text) == 0 .or. len(text) > name_length) return
    is_name = scan(text(1:1), letters) == 1 .and. verify(text, letters//figures) == 0
  end function is_name

  pure subroutine fail_open(s, namelist, error)
    type(scanner_t), intent(in) :: s
    type(namelist_t), intent(in) :: namelist
    type(error_t), allocatable, intent(inout) :: error

    call fail_at(s%group_line, 'group &'//trim(namelist%groups(s%groups))//' is never closed with /', error)
  end subroutine fail_open

  pure subroutine fail_at(line, message, error)
    integer, intent(in) :: line
    character(*), intent(in) :: message
    type(error_t), allocatable, intent(inout) :: error

    call fail(error, code_input, 'line '//str(line)//': '//message)
  end subroutine fail_at
end module gearsweep_namelist
