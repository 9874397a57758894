!> Splits Fortran namelist text into groups, keys and values; what they mean is not its concern.
!>
!> Own code instead of Fortran's namelist input, which cannot say what is unknown, missing or wrong.
!> Each value keeps its text. A key with nothing behind its `=` counts as not given.
module gearsweep_namelist
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

  !> One key that was given, with all its values.
  type :: entry_t
    character(:), allocatable :: group, key
    type(value_t), allocatable :: values(:)
    integer :: line = 0
    !> For the reader: somebody asked for this key.
    logical :: used = .false.
  end type entry_t

  type :: namelist_t
    character(name_length), allocatable :: groups(:)
    type(entry_t), allocatable :: entries(:)
  end type namelist_t

  !> How far the text has been read, and what is open at that place.
  type :: scanner_t
    integer :: at = 1, line = 1
    logical :: in_group = .false., in_key = .false.
    integer :: group_line = 0
    !> Values of the open key and the commas since the last of them.
    integer :: count = 0, commas = 0
    !> Groups, entries and characters of values so far.
    integer :: groups = 0, entries = 0, stored = 0
  end type scanner_t

  character, parameter :: tab = achar(9), lf = achar(10), cr = achar(13)
  character(*), parameter :: blanks = ' '//tab//cr, word_ends = blanks//lf//',/!=&''"'
  character(*), parameter :: name_characters = 'abcdefghijklmnopqrstuvwxyz0123456789_'

contains

  !> Lines end in LF or CRLF. Every failure names its line.
  pure subroutine parse_namelist(text, namelist, error)
    character(*), intent(in) :: text
    type(namelist_t), intent(out) :: namelist
    type(error_t), allocatable, intent(inout) :: error
    character(*), parameter :: bom = char(239)//char(187)//char(191)
    type(scanner_t) :: s

    if (allocated(error)) return
    allocate (namelist%groups(most_names), namelist%entries(most_names))
    call check_characters(text, error)
    if (index(text, bom) == 1) s%at = len(bom) + 1
    do while (.not. allocated(error))
      call skip_blanks(text, s)
      if (s%at > len(text)) exit
      call read_item(text, s, namelist, error)
    end do
    if (allocated(error)) return
    if (s%in_group) then
      s%line = s%group_line
      call fail_at(s, 'group &'//trim(namelist%groups(s%groups))//' is never closed with /', error)
    else if (s%groups == 0) then
      call fail_at(s, 'no group, such as &pair ... /', error)
    end if
    namelist%groups = namelist%groups(:s%groups)
    call drop_surplus(namelist%entries, s%entries)
  end subroutine parse_namelist

  !> One step: the next character decides what comes.
  pure subroutine read_item(text, s, namelist, error)
    character(*), intent(in) :: text
    type(scanner_t), intent(inout) :: s
    type(namelist_t), intent(inout) :: namelist
    type(error_t), allocatable, intent(inout) :: error

    if (text(s%at:s%at) == '&') then
      call read_group_mark(text, s, namelist, error)
    else if (.not. s%in_group) then
      call fail_at(s, 'text outside a group: '//shown(rest_of_line(text, s%at)), error)
    else
      select case (text(s%at:s%at))
      case ('/')
        s%at = s%at + 1
        call close_group(s, namelist)
      case (',')
        s%at = s%at + 1
        s%commas = s%commas + 1
        if (.not. s%in_key) call fail_at(s, 'a comma without a key', error)
        if (s%commas > 1) call fail_at(s, 'no value between two commas', error)
      case ('=')
        call fail_at(s, 'no key before =', error)
      case ('''', '"')
        call read_string(text, s, 1, namelist, error)
      case default
        call read_word(text, s, namelist, error)
      end select
    end if
  end subroutine read_item

  !> `&name` opens a group, `&end` closes one.
  pure subroutine read_group_mark(text, s, namelist, error)
    character(*), intent(in) :: text
    type(scanner_t), intent(inout) :: s
    type(namelist_t), intent(inout) :: namelist
    type(error_t), allocatable, intent(inout) :: error
    character(:), allocatable :: name
    integer :: last

    last = word_end(text, s%at + 1)
    name = lower(text(s%at + 1:last))
    s%at = last + 1
    if (name == 'end' .and. s%in_group) then
      call close_group(s, namelist)
    else if (s%in_group) then
      s%line = s%group_line
      call fail_at(s, 'group &'//trim(namelist%groups(s%groups))//' is never closed with /', error)
    else if (.not. is_name(name) .or. name == 'end') then
      call fail_at(s, 'no group can be called &'//shown(name), error)
    else if (any(namelist%groups(:s%groups) == name)) then
      call fail_at(s, 'group &'//name//' is given twice', error)
    else if (s%groups == most_names) then
      call fail_at(s, 'more than '//str(most_names)//' groups', error)
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
    integer :: first, last, line, count, star

    first = s%at
    line = s%line
    last = word_end(text, first)
    count = 1
    star = index(text(first:last), '*')
    if (star > 1) call read_count(text(first:first + star - 2), s, count, star, error)
    if (star > 1) first = first + star
    s%at = last + 1
    if (first > last .and. next_is(text, s%at, '''"')) then
      call read_string(text, s, count, namelist, error)
      return
    end if
    if (next_is(text, s%at, '''"&')) call fail_at(s, 'no blank or comma between values', error)
    call skip_blanks(text, s)
    if (star <= 1 .and. next_is(text, s%at, '=')) then
      s%at = s%at + 1
      call open_key(lower(text(first:last)), line, s, namelist, error)
    else
      if (first > last) call fail_at(s, 'a repeat count without a value', error)
      call add_value(text(first:last), .false., count, line, s, namelist, error)
    end if
  end subroutine read_word

  !> The count of `3*0.5`; `star` is set to 0 where the text before the star is no count.
  pure subroutine read_count(text, s, count, star, error)
    character(*), intent(in) :: text
    type(scanner_t), intent(in) :: s
    integer, intent(inout) :: count, star
    type(error_t), allocatable, intent(inout) :: error
    logical :: ok

    if (verify(text, '0123456789') > 0) then
      star = 0
      return
    end if
    call to_number(text, count, ok)
    if (ok) ok = count >= 1 .and. count <= largest_count
    if (.not. ok) call fail_at(s, 'the repeat count '//shown(text)//' is not between 1 and ' &
      & //str(largest_count), error)
  end subroutine read_count

  !> A string in either kind of quotes, which stand for themselves when doubled.
  pure subroutine read_string(text, s, count, namelist, error)
    character(*), intent(in) :: text
    type(scanner_t), intent(inout) :: s
    integer, intent(in) :: count
    type(namelist_t), intent(inout) :: namelist
    type(error_t), allocatable, intent(inout) :: error
    character(:), allocatable :: string
    integer :: first, i, n

    first = s%at
    string = rest_of_line(text, first + 1)
    i = first
    n = 0
    do
      i = i + 1
      if (.not. next_is(text, i, '''"') .and. n + 1 > len(string)) exit
      if (text(i:i) == text(first:first)) then
        if (.not. next_is(text, i + 1, text(first:first))) exit
        i = i + 1
      end if
      n = n + 1
      string(n:n) = text(i:i)
    end do
    s%at = i + 1
    call add_value(string(:n), .true., count, s%line, s, namelist, error)
  end subroutine read_string
end module gearsweep_namelist
