!> Splits Fortran namelist text into groups, keys and values, without regard to their meaning.
!>
!> Fortran's own namelist input is not used, as it does not report unknown, missing or wrong keys. A key without a value after its
!> `=` counts as absent. Strings end on their line.
module gearsweep_study_reader_namelist
  use, intrinsic :: iso_fortran_env, only: int64
  use gearsweep_base, only: claim_memory, code_input, dp, error_t, fail, find_control, find_odd, lower, shown, str, to_number, utf8
  implicit none
  private
  public :: value_t, entry_t, namelist_t, parse_namelist

  !> Largest length of a name, as in Fortran.
  integer, parameter, public :: name_length = 63
  !> Largest sizes of the text of a case.
  integer, parameter :: longest_text = 10*1000*1000
  integer, parameter :: most_names = 1000

  type :: value_t
    character(:), allocatable :: text
    logical :: quoted = .false.
  end type value_t

  !> One key of the text, with all its values (at least one).
  type :: entry_t
    character(:), allocatable :: group, key
    type(value_t), allocatable :: values(:)
    !> Positions in the text: of the key's first character, and of its values' first and last.
    integer :: at = 0, first = 0, last = 0
    !> Numbers of gaps between its values: commas without a blank, and blanks on one line without a comma.
    integer :: bare_commas = 0, bare_blanks = 0
    !> Number of gaps as in 0,5, 10,5: a comma without a blank within a pair of values, a comma and a blank between two pairs.
    integer :: paired = 0
    !> True once the reader has used this key.
    logical :: used = .false.
  end type entry_t

  type :: namelist_t
    character(name_length), allocatable :: groups(:)
    integer, allocatable :: ends(:)              !< positions in the text where the groups end
    type(entry_t), allocatable :: entries(:)
  contains
    procedure :: position
  end type namelist_t

  !> Namelist under construction, with its open group and key. Every error names the line.
  type :: builder_t
    type(namelist_t) :: list
    logical :: in_group = .false.
    logical :: in_key = .false.
    integer :: group_line = 0
    !> Values of the open key, and commas since the last value.
    integer :: values = 0, commas = 0
    integer :: value_line = 0                    ! line of the last value
    !> Numbers of groups, entries and keys so far; keys without a value make no entry.
    integer :: groups = 0, entries = 0, keys = 0
    !> Memory of the values, which repeat counts could inflate.
    integer(int64) :: stored = 0
  contains
    procedure :: open_group, close_group, open_key, add_comma, add_value, finish, describe_place
    procedure, private :: close_key, go_on
  end type builder_t

  character(*), parameter :: figures = '0123456789', letters = 'abcdefghijklmnopqrstuvwxyz_'

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

contains

  !> Splits the text. Lines end in LF, CRLF or CR. Every error names its line.
  pure subroutine parse_namelist(text, namelist, error)
    character(*), intent(in) :: text
    type(namelist_t), intent(out) :: namelist
    type(error_t), allocatable, intent(inout) :: error
    character(*), parameter :: bom = char(239)//char(187)//char(191)
    type(scanner_t) :: s
    character(:), allocatable :: control
    character :: next
    integer :: last, line

    call claim_memory(30.0_dp*len(text), 'the text of the case', error)
    if (allocated(error)) return
    if (len(text) > longest_text) then
      call fail_at(1, 'the text is longer than 10 MB', error)
    else
      ! Control characters other than tabs and line ends.
      call find_control(text, line, control)
      if (line > 0) call fail_at(line, control, error)
    end if
    if (index(text(:min(3, len(text))), bom) == 1) s%at = len(bom) + 1
    do while (.not. allocated(error))
      call skip_blanks(text, s)
      if (s%at > len(text)) exit
      next = text(s%at:s%at)
      s%item = s%at
      if (next == '&' .or. next == '$') then
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
    end do
    call s%builder%finish(s%line, namelist, error)
  end subroutine parse_namelist

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
    integer :: first, i, n

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
    string = text(first + 1:s%at - 1)
    n = 0
    i = first
    do while (i < s%at - 1)
      i = i + 1
      if (text(i:i) == quote) i = i + 1
      n = n + 1
      string(n:n) = text(i:i)
    end do
    string = utf8(string(:n))
    s%at = s%at + 1
    if (s%at <= len(text) .and. .not. next_is(text, s%at, blanks//line_ends//',/!&=')) &
      & call fail_at(s%line, 'no blank or comma behind '//shown(text(first:s%at)), error)
    call s%builder%add_value(value_t(string, .true.), count, s%item, s%at - 1, s%line, error)
  end subroutine read_string

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
    call s%builder%describe_place(.not. next_is(text, next_at(text, last + 1), '='), place)
    call fail_at(s%line, place//shown(text(first:last))//': '//odd, error)
  end subroutine refuse_odd

  pure integer function line_end(text, first)
    character(*), intent(in) :: text
    integer, intent(in) :: first

    line_end = scan(text(first:), line_ends) + first - 2
    if (line_end == first - 2) line_end = len(text)
  end function line_end

  !> Position of the entry of this key; 0 if it is not in the text. Names in lower case.
  pure integer function position(self, group, key) result(at)
    class(namelist_t), intent(in) :: self
    character(*), intent(in) :: group, key
    integer :: group_length, key_length

    at = 0
    if (.not. allocated(self%entries)) return
    group_length = len_trim(group)
    key_length = len_trim(key)
    do at = size(self%entries), 1, -1
      associate (entry => self%entries(at))
        ! Lengths are compared first, as this runs for every pair of key and entry.
        if (len(entry%key) /= key_length .or. len(entry%group) /= group_length) cycle
        if (entry%key == key(:key_length) .and. entry%group == group(:group_length)) return
      end associate
    end do
  end function position

  !> Opens a group; `name` in lower case.
  pure subroutine open_group(self, name, line, error)
    class(builder_t), intent(inout) :: self
    character(*), intent(in) :: name
    integer, intent(in) :: line
    type(error_t), allocatable, intent(inout) :: error

    if (.not. allocated(self%list%groups)) &
      allocate (self%list%groups(most_names), self%list%ends(most_names), self%list%entries(most_names))
    if (self%in_group) then
      call fail_open(self, error)
    else if (name == 'end' .or. .not. is_name(name)) then
      call fail_at(line, 'no group can be called &'//shown(name), error)
    else if (any(self%list%groups(:self%groups) == name)) then
      call fail_at(line, 'group &'//name//' is given twice', error)
    else if (self%groups == most_names) then
      call fail_at(line, 'more than '//str(most_names)//' groups', error)
    else
      self%groups = self%groups + 1
      self%list%groups(self%groups) = name
      self%in_group = .true.
      self%group_line = line
    end if
  end subroutine open_group

  !> Closes the group; `at`: position of its end in the text.
  pure subroutine close_group(self, at)
    class(builder_t), intent(inout) :: self
    integer, intent(in) :: at

    call self%close_key()
    self%list%ends(self%groups) = at
    self%in_group = .false.
  end subroutine close_group

  !> Opens a key; `key` in lower case; `at`: its position in the text.
  pure subroutine open_key(self, key, at, line, error)
    class(builder_t), intent(inout) :: self
    character(*), intent(in) :: key
    integer, intent(in) :: at, line
    type(error_t), allocatable, intent(inout) :: error
    integer :: i, place
    logical :: goes_on, ok
    character(:), allocatable :: number

    place = 1
    if (index(key, '(') > 0) then
      number = adjustl(key(index(key, '(') + 1:max(index(key, '('), len(key) - 1)))
      call to_number(trim(number), place, ok)
      if (ok) ok = key(len(key):) == ')' .and. place >= 1
      if (.not. ok) call fail_at(line, shown(key)//': an index must be one whole number from 1 on, as in key(1) = 0 '// &
                                 'key(2) = 5; or give the list as key = 0, 5', error)
      call self%go_on(key(:name_end(key)), place, goes_on)
      if (goes_on .or. allocated(error)) return
      if (place /= 1) call fail_at(line, shown(key)//': the values of a list must follow each other, from the index 1 on', error)
    end if
    call self%close_key()
    if (index(key, '%') > 0) call fail_at(line, 'keys with parts are not supported: '//shown(key), error)
    if (.not. is_name(key(:name_end(key)))) call fail_at(line, 'this is no key: '//shown(key), error)
    self%keys = self%keys + 1
    if (self%keys > most_names) call fail_at(line, 'more than '//str(most_names)//' keys', error)
    if (allocated(error)) return
    do i = 1, self%entries
      if (self%list%entries(i)%key /= key(:name_end(key))) cycle
      if (self%list%entries(i)%group /= self%list%groups(self%groups)) cycle
      call fail_at(line, 'key '//key(:name_end(key))//' is given twice in &'//trim(self%list%groups(self%groups)), error)
      return
    end do
    self%in_key = .true.
    self%entries = self%entries + 1
    associate (entry => self%list%entries(self%entries))
      entry%group = trim(self%list%groups(self%groups))
      entry%key = key(:name_end(key))
      entry%at = at
    end associate
  end subroutine open_key

  !> Length of the name of a key that may have an index.
  pure integer function name_end(key)
    character(*), intent(in) :: key

    name_end = len_trim(key(:index(key//'(', '(') - 1))
  end function name_end

  !> True if this index continues the values of the open key.
  pure subroutine go_on(self, name, place, goes_on)
    class(builder_t), intent(inout) :: self
    character(*), intent(in) :: name
    integer, intent(in) :: place
    logical, intent(out) :: goes_on

    goes_on = self%in_key .and. place == self%values + 1 .and. place > 1
    if (goes_on) goes_on = self%list%entries(self%entries)%key == name
    if (.not. goes_on) return
    self%commas = 0
    self%value_line = 0
  end subroutine go_on

  !> Describes the open group, and with `is_value` the open key, for messages.
  pure subroutine describe_place(self, is_value, words)
    class(builder_t), intent(in) :: self
    logical, intent(in) :: is_value
    character(:), allocatable, intent(out) :: words

    words = ''
    if (.not. self%in_group) return
    words = '&'//trim(self%list%groups(self%groups))//' '
    if (is_value .and. self%in_key) words = words//self%list%entries(self%entries)%key//' = '
  end subroutine describe_place

  !> Closes the open key, and keeps it if it has values.
  pure subroutine close_key(self)
    class(builder_t), intent(inout) :: self

    if (self%in_key .and. self%values == 0) self%entries = self%entries - 1
    if (self%values > 0) call resize(self%list%entries(self%entries)%values, self%values, self%values)
    self%in_key = .false.
    self%values = 0
    self%commas = 0
  end subroutine close_key

  pure subroutine add_comma(self, line, error)
    class(builder_t), intent(inout) :: self
    integer, intent(in) :: line
    type(error_t), allocatable, intent(inout) :: error

    self%commas = self%commas + 1
    if (.not. self%in_key) call fail_at(line, 'a comma without a key', error)
    if (self%commas > 1) call fail_at(line, 'no value between two commas', error)
  end subroutine add_comma

  !> Adds a value `count` times; it is at `first` to `last` in the text.
  pure subroutine add_value(self, value, count, first, last, line, error)
    class(builder_t), intent(inout) :: self
    type(value_t), intent(in) :: value
    integer, intent(in) :: count, first, last, line
    type(error_t), allocatable, intent(inout) :: error
    integer, parameter :: few = 1000
    integer :: i

    self%stored = self%stored + int(count, int64)*(len(value%text) + 1)
    if (.not. self%in_key) call fail_at(line, 'a value without a key: '//shown(value%text), error)
    if (self%values == 0 .and. self%commas > 0) call fail_at(line, 'no value in front of a comma', error)
    if (self%stored > longest_text + 1) call fail_at(line, 'the repeated values are too many', error)
    if (allocated(error)) return
    associate (entry => self%list%entries(self%entries), n => self%values)
      if (.not. allocated(entry%values)) allocate (entry%values(0))
      if (n == 0) entry%first = first
      if (n > 0 .and. self%commas == 1 .and. first == entry%last + 2) entry%bare_commas = entry%bare_commas + 1
      if (n > 0 .and. self%commas == 1 .and. line == self%value_line .and. (first == entry%last + 2 .eqv. mod(n, 2) == 1)) &
        entry%paired = entry%paired + 1
      if (n > 0 .and. self%commas == 0 .and. line == self%value_line) entry%bare_blanks = entry%bare_blanks + 1
      entry%last = last
      if (n + count > size(entry%values)) then
        ! Memory of the longer list, its texts, and a second copy when the list is finished.
        if (n + count > few) call claim_memory(400.0_dp*(n + count), '&'//shown(entry%group)//' '//shown(entry%key)// &
                                               ': the values', error)
        if (allocated(error)) return
        call resize(entry%values, n, 2*(n + count))
      end if
      do i = n + 1, n + count
        entry%values(i) = value
      end do
    end associate
    self%values = self%values + count
    self%commas = 0
    self%value_line = line
  end subroutine add_value

  !> Finishes the list of all entries; `line` is the last line.
  pure subroutine finish(self, line, list, error)
    class(builder_t), intent(inout) :: self
    integer, intent(in) :: line
    type(namelist_t), intent(out) :: list
    type(error_t), allocatable, intent(inout) :: error

    if (self%in_group) call fail_open(self, error)
    if (self%groups == 0) call fail_at(line, 'there is no group, such as &pair ... /', error)
    if (allocated(error)) return
    list%groups = self%list%groups(:self%groups)
    list%ends = self%list%ends(:self%groups)
    list%entries = self%list%entries(:self%entries)
  end subroutine finish

  !> Resizes the list, keeping the first `kept` values; their texts are moved, not copied.
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

  pure logical function is_name(text)
    character(*), intent(in) :: text

    is_name = .false.
    if (len(text) == 0 .or. len(text) > name_length) return
    is_name = scan(text(1:1), letters) == 1 .and. verify(text, letters//figures) == 0
  end function is_name

  pure subroutine fail_open(self, error)
    type(builder_t), intent(in) :: self
    type(error_t), allocatable, intent(inout) :: error

    call fail_at(self%group_line, 'group &'//trim(self%list%groups(self%groups))//' is never closed with /', error)
  end subroutine fail_open

  pure subroutine fail_at(line, message, error)
    integer, intent(in) :: line
    character(*), intent(in) :: message
    type(error_t), allocatable, intent(inout) :: error

    call fail(error, code_input, 'line '//str(line)//': '//message)
  end subroutine fail_at
end module gearsweep_study_reader_namelist
