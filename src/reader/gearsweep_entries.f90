!> The groups, keys and values of a namelist text, as they come one after the other.
module gearsweep_entries
  use, intrinsic :: iso_fortran_env, only: int64
  use gearsweep_error, only: code_input, error_t, fail
  use gearsweep_kinds, only: dp
  use gearsweep_memory, only: claim_memory
  use gearsweep_text, only: lower, shown, str
  implicit none
  private
  public :: value_t, entry_t, namelist_t, builder_t, fail_at

  !> Names are as long as Fortran's at most.
  integer, parameter, public :: name_length = 63
  !> Beyond these sizes no text is a case.
  integer, parameter, public :: longest_text = 10*1000*1000
  integer, parameter :: most_names = 1000

  type :: value_t
    character(:), allocatable :: text
    logical :: quoted = .false.
  end type value_t

  !> One key that was given, with all its values (at least one).
  type :: entry_t
    character(:), allocatable :: group, key
    type(value_t), allocatable :: values(:)
    !> Places in the text: the key's first character, its values' first and last.
    integer :: at = 0, first = 0, last = 0
    !> What stands between its values: a comma and no blank so often, blanks of one line and no comma so often.
    integer :: bare_commas = 0, bare_blanks = 0
    !> Gaps as between 0,5, 10,5: a comma and no blank within a pair of values, a comma and a blank between two pairs.
    integer :: paired = 0
    !> For the reader: somebody asked for this key.
    logical :: used = .false.
  end type entry_t

  type :: namelist_t
    character(name_length), allocatable :: groups(:)
    integer, allocatable :: ends(:)              !< places in the text where the groups are closed
    type(entry_t), allocatable :: entries(:)
  contains
    procedure :: position
  end type namelist_t

  !> A namelist that grows, and what is open. Every failure names the line.
  type :: builder_t
    private
    type(namelist_t) :: list
    logical, public :: in_group = .false.
    logical :: in_key = .false.
    integer :: group_line = 0
    !> Values of the open key, and commas since the last of them.
    integer :: values = 0, commas = 0
    integer :: value_line = 0                    ! of the last of them
    !> All groups, entries and keys so far; keys without a value make no entry.
    integer :: groups = 0, entries = 0, keys = 0
    !> Room that the values take, which repeat counts could blow up.
    integer(int64) :: stored = 0
  contains
    procedure :: open_group, close_group, open_key, add_comma, add_value, finish
    procedure, private :: close_key
  end type builder_t

  character(*), parameter :: figures = '0123456789', letters = 'abcdefghijklmnopqrstuvwxyz_'

contains

  !> Of the entry of this key; 0 where it is not given. Names in lower case.
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
        ! Lengths first, as this is asked for every key beside every entry.
        if (len(entry%key) /= key_length .or. len(entry%group) /= group_length) cycle
        if (entry%key == key(:key_length) .and. entry%group == group(:group_length)) return
      end associate
    end do
  end function position

  !> `name` in lower case.
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

  !> `at`: place of its end in the text.
  pure subroutine close_group(self, at)
    class(builder_t), intent(inout) :: self
    integer, intent(in) :: at

    call self%close_key()
    self%list%ends(self%groups) = at
    self%in_group = .false.
  end subroutine close_group

  !> `key` in lower case; `at`: its place in the text.
  pure subroutine open_key(self, key, at, line, error)
    class(builder_t), intent(inout) :: self
    character(*), intent(in) :: key
    integer, intent(in) :: at, line
    type(error_t), allocatable, intent(inout) :: error
    integer :: i

    call self%close_key()
    if (index(key, '(') > 0) call fail_at(line, 'keys with an index are not supported: '//shown(key), error)
    if (index(key, '%') > 0) call fail_at(line, 'keys with parts are not supported: '//shown(key), error)
    if (.not. is_name(key)) call fail_at(line, 'this is no key: '//shown(key), error)
    self%keys = self%keys + 1
    if (self%keys > most_names) call fail_at(line, 'more than '//str(most_names)//' keys', error)
    if (allocated(error)) return
    do i = 1, self%entries
      if (self%list%entries(i)%key /= key) cycle
      if (self%list%entries(i)%group /= self%list%groups(self%groups)) cycle
      call fail_at(line, 'key '//key//' is given twice in &'//trim(self%list%groups(self%groups)), error)
      return
    end do
    self%in_key = .true.
    self%entries = self%entries + 1
    associate (entry => self%list%entries(self%entries))
      entry%group = trim(self%list%groups(self%groups))
      entry%key = key
      entry%at = at
    end associate
  end subroutine open_key

  !> Keeps the open key if it got values.
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

  !> The value, `count` times; it stands from `first` to `last` in the text.
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
        ! Room for more, their texts, and all of that again as the list is handed over.
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

  !> Hands over all that was added; `line` is the last one.
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
end module gearsweep_entries
