!> Keys of a format: declaration, bounds in numbers and in words, and the values in effect.
!>
!> The reader, its errors, the help, the reference and new cases all use one declaration of each key.
module gearsweep_study_reader_keys
  use gearsweep_base, only: closest_word, dp, join, lines_t, lower, str
  use gearsweep_study_reader_namelist, only: name_length, namelist_t, value_t
  implicit none
  private
  public :: bounds_t, bound_real, bound_integer, key_t, declare, keys_t

  type :: bounds_t
    logical :: is_integer = .false.                   !< true for integers only
    real(dp) :: low = -huge(1.0_dp), high = huge(1.0_dp)
    logical :: low_is_out = .false., high_is_out = .false.
    character(12) :: unit = ''                   !< unit of the numbers
  contains
    procedure :: allow, describe, describe_range
  end type bounds_t

  !> Kinds of values of a key.
  integer, parameter, public :: kind_number = 1, kind_integer = 2, kind_logical = 3, kind_text = 4

  !> Length of the allowed words of a text.
  integer, parameter, public :: word_length = 20

  type :: key_t
    character(name_length) :: group = '', name = ''
    character(:), allocatable :: meaning         !< one sentence
    character(:), allocatable :: unit            !< empty for none
    character(:), allocatable :: tasks           !< tasks that use the key, as in `load, sweep or optimum`; empty: all
    integer :: kind = kind_number
    type(bounds_t) :: bounds                     !< in the key's unit
    character(word_length), allocatable :: words(:)  !< allowed words of a text; not allocated: any text
    logical :: is_list = .false.
    integer :: fewest = 0, most = 0              !< least and largest number of values of a list; 0: any number
    logical :: is_required = .false.             !< true if the key is required where it is used
    logical :: is_one_of = .false.               !< true if exactly one of the group's keys with this mark is required
    !> Default value, as written in a case; not allocated if there is none.
    character(:), allocatable :: default
    character(:), allocatable :: default_note       !< description of what applies instead of a default; may be empty
    ! In this case:
    integer :: entry = 0                         !< index of the key's entry in the namelist; 0: none
    integer :: turn = 0                          !< number of keys declared before the last declaration of this one, and this one
    character(:), allocatable :: unused_without           !< tasks or values that would use the key; empty if it is used
    character(:), allocatable :: not_allowed         !< reason why the key is not allowed; empty if it is
    character(:), allocatable :: caution         !< reason why its number is unusual; not allocated if it is not
  contains
    procedure :: allow_list, list_allowed, is_for
  end type key_t

  type :: group_t
    character(name_length) :: name = ''
    character(:), allocatable :: meaning         !< one sentence
  end type group_t

  type :: keys_t
    type(group_t), allocatable :: groups(:)      !< groups of the format
    type(key_t), allocatable :: key(:)           !< keys; the first `known` are set
    integer :: known = 0, last = 0               !< number of keys, and the key added last
    integer :: asked = 0                         !< number of declarations so far
  contains
    procedure :: add_group, add, set_default, list_groups, has, why_unknown, list_missing, list_unused, list_cautions
    procedure :: write_case, write_given
  end type keys_t

contains

  !> Sets at most one lower and one upper bound.
  pure subroutine bound_real(bounds, unit, above, at_least, below, at_most)
    type(bounds_t), intent(out) :: bounds
    character(*), intent(in) :: unit
    real(dp), intent(in), optional :: above, at_least, below, at_most

    bounds%unit = unit
    bounds%low_is_out = present(above)
    bounds%high_is_out = present(below)
    if (present(above)) bounds%low = above
    if (present(at_least)) bounds%low = at_least
    if (present(below)) bounds%high = below
    if (present(at_most)) bounds%high = at_most
  end subroutine bound_real

  pure subroutine bound_integer(bounds, at_least, at_most)
    type(bounds_t), intent(out) :: bounds
    integer, intent(in), optional :: at_least, at_most

    bounds%is_integer = .true.
    if (present(at_least)) bounds%low = at_least
    if (present(at_most)) bounds%high = at_most
  end subroutine bound_integer

  pure logical function allow(self, number)
    class(bounds_t), intent(in) :: self
    real(dp), intent(in) :: number

    allow = .not. (number < self%low .or. number > self%high &
      & .or. (self%low_is_out .and. number <= self%low) &
      & .or. (self%high_is_out .and. number >= self%high))
  end function allow

  !> Describes the bounds, as in `above 0 and at most 1000`; without bounds, the kind of number.
  pure subroutine describe(self, words, farthest)
    class(bounds_t), intent(in) :: self
    character(:), allocatable, intent(out) :: words
    real(dp), intent(in), optional :: farthest   !< size beyond which bounds are omitted; absent: all bounds
    real(dp) :: most

    most = huge(most)
    if (present(farthest)) most = farthest
    words = ''
    if (self%low > -most) words = trim(merge('above   ', 'at least', self%low_is_out))//' '//str(self%low, 12)
    if (self%high < most) then
      if (len(words) > 0) words = words//' and '
      words = words//trim(merge('below  ', 'at most', self%high_is_out))//' '//str(self%high, 12)
    end if
    if (len(words) == 0) words = trim(merge('an integer', 'a number  ', self%is_integer))
  end subroutine describe

  !> Describes the bounds for a table, as in `0.001 to 1000` or `above 3, below 45`; empty without bounds.
  pure subroutine describe_range(self, words)
    class(bounds_t), intent(in) :: self
    character(:), allocatable, intent(out) :: words
    logical :: has_low, has_high

    has_low = self%low > -huge(self%low)
    has_high = self%high < huge(self%high)
    words = ''
    if (has_low .and. has_high .and. .not. (self%low_is_out .or. self%high_is_out)) then
      words = trim(in_short(self%low))//' to '//trim(in_short(self%high))
      return
    end if
    if (has_low) words = trim(merge('above   ', 'at least', self%low_is_out))//' '//trim(in_short(self%low))
    if (has_low .and. has_high) words = words//', '
    if (has_high) words = words//trim(merge('below  ', 'at most', self%high_is_out))//' '//trim(in_short(self%high))
  end subroutine describe_range

  !> Number in short form, as in 0.001, 100000 or 1e9.
  pure function in_short(number) result(words)
    real(dp), intent(in) :: number
    character(20) :: words
    integer :: power

    words = str(number, 12)
    if (abs(number) < 1e6_dp) return
    power = nint(log10(abs(number)))
    if (abs(abs(number) - 10.0_dp**power) > 0) return
    words = '1e'//str(power)
    if (number < 0) words = '-'//words
  end function in_short

  !> Declares a key without bounds, words and default.
  pure subroutine declare(key, group, name, meaning, kind, unit, tasks, default_note, required, one_of)
    type(key_t), intent(out) :: key
    character(*), intent(in) :: group, name, meaning
    integer, intent(in) :: kind
    character(*), intent(in), optional :: unit, tasks, default_note
    logical, intent(in), optional :: required, one_of

    key%group = lower(group)
    key%name = lower(name)
    key%meaning = meaning
    key%kind = kind
    key%unit = ''
    key%tasks = ''
    key%default_note = ''
    if (present(unit)) key%unit = unit
    if (present(tasks)) key%tasks = trim(tasks)
    if (present(default_note)) key%default_note = default_note
    if (present(required)) key%is_required = required
    if (present(one_of)) key%is_one_of = one_of
    key%unused_without = ''
    key%not_allowed = ''
  end subroutine declare

  !> Allows several values, between `fewest` and `most`.
  pure subroutine allow_list(self, fewest, most)
    class(key_t), intent(inout) :: self
    integer, intent(in), optional :: fewest, most

    self%is_list = .true.
    if (present(fewest)) self%fewest = fewest
    if (present(most)) self%most = most
  end subroutine allow_list

  !> Describes the allowed values, as in `0 to 1` or `list of up to 20 numbers, above 0 each`.
  pure subroutine list_allowed(self, allowed)
    class(key_t), intent(in) :: self
    character(:), allocatable, intent(out) :: allowed
    character(:), allocatable :: range

    select case (self%kind)
    case (kind_logical)
      allowed = '.true., .false.'
    case (kind_text)
      if (.not. allocated(self%words)) then
        allowed = trim(merge('texts', 'text ', self%is_list))
      else
        allowed = ''''//join(self%words, ''', ''')//''''
        if (self%is_list) allowed = 'one or more of '//allowed
      end if
    case default
      call self%bounds%describe_range(range)
      if (.not. self%is_list) then
        allowed = trim(merge('integer', 'number ', self%kind == kind_integer))
        if (self%kind == kind_integer .and. len(range) > 0) allowed = allowed//', '//range
        if (self%kind == kind_number .and. len(range) > 0) allowed = range
        return
      end if
      allowed = 'list of numbers'
      if (self%fewest > 0) allowed = 'list of '//str(self%fewest)//' or more numbers'
      if (self%most > 0) allowed = 'list of up to '//str(self%most)//' numbers'
      if (len(range) > 0) allowed = allowed//', '//range//' each'
    end select
  end subroutine list_allowed

  !> True if some of these tasks use the key. The list has a blank before and after each task.
  pure logical function is_for(self, tasks)
    class(key_t), intent(in) :: self
    character(*), intent(in) :: tasks
    character(*), parameter :: letters = 'abcdefghijklmnopqrstuvwxyz_'
    integer :: from, length

    is_for = len(self%tasks) == 0
    from = 1
    do while (from <= len(self%tasks) .and. .not. is_for)
      length = verify(self%tasks(from:)//',', letters) - 1
      if (length > 0) is_for = index(tasks, ' '//self%tasks(from:from + length - 1)//' ') > 0
      from = from + length + 1
    end do
  end function is_for

  !> Adds a group to the format, in the order in which a case is written.
  pure subroutine add_group(self, name, meaning)
    class(keys_t), intent(inout) :: self
    character(*), intent(in) :: name, meaning
    type(group_t), allocatable :: more(:)
    integer :: n

    if (.not. allocated(self%groups)) allocate (self%groups(0))
    n = size(self%groups)
    ! gfortran does not free the texts of an array constructor's elements.
    allocate (more(n + 1))
    more(:n) = self%groups
    more(n + 1)%name = name
    more(n + 1)%meaning = meaning
    call move_alloc(more, self%groups)
  end subroutine add_group

  !> Lists the names of the groups.
  pure subroutine list_groups(self, names)
    class(keys_t), intent(in) :: self
    character(name_length), allocatable, intent(out) :: names(:)
    integer :: i

    allocate (names(size(self%groups)))
    do i = 1, size(names)
      names(i) = self%groups(i)%name
    end do
  end subroutine list_groups

  !> Adds a key; adding an existing key replaces it.
  pure subroutine add(self, key)
    class(keys_t), intent(inout) :: self
    type(key_t), intent(in) :: key
    integer, parameter :: first_size = 64
    type(key_t), allocatable :: more(:)
    integer :: i

    if (.not. allocated(self%key)) allocate (self%key(first_size))
    do i = 1, self%known
      if (self%key(i)%name == key%name .and. self%key(i)%group == key%group) exit
    end do
    if (i > size(self%key)) then
      allocate (more(2*size(self%key)))
      more(:size(self%key)) = self%key
      call move_alloc(more, self%key)
    end if
    self%last = i
    self%known = max(i, self%known)
    self%key(i) = key
    self%asked = self%asked + 1
    self%key(i)%turn = self%asked
  end subroutine add

  !> Sets the default of the key added last, if the text does not have the key.
  pure subroutine set_default(self, default)
    class(keys_t), intent(inout) :: self
    character(*), intent(in) :: default

    self%key(self%last)%default = default
  end subroutine set_default

  !> True if this key is declared. Names in lower case.
  pure logical function has(self, group, name)
    class(keys_t), intent(in) :: self
    character(*), intent(in) :: group, name
    integer :: i

    has = any([(self%key(i)%group == group .and. self%key(i)%name == name, i=1, self%known)])
  end function has

  !> Explains that there is no such key, and suggests the right one.
  pure subroutine why_unknown(self, group, name, why)
    class(keys_t), intent(in) :: self
    character(*), intent(in) :: group, name
    character(:), allocatable, intent(out) :: why
    character(name_length), allocatable :: names(:), homes(:)
    integer :: closest, i

    call self%list_groups(homes)
    homes = pack(homes, [(self%has(trim(homes(i)), name), i=1, size(homes))])
    names = pack([(self%key(i)%name, i=1, self%known)], [(self%key(i)%group == group, i=1, self%known)])
    closest = closest_word(name, names)
    why = 'unknown key'
    if (index(name, 'diametral_pitch') > 0) then
      why = 'unknown key: module_mm = 25.4/(diametral pitch)'
      return
    end if
    if (group == 'branches' .and. index(name, 'second') == 1) then
      why = 'unknown key: curves over two numbers are no longer computed; run the case at several values of the second one'
      return
    end if
    if (closest > 0) then
      why = why//' (did you mean '//trim(names(closest))//'?)'
    else if (size(homes) > 0) then
      why = why//'; it belongs to &'//trim(homes(1))
    end if
    why = why//'; the keys of &'//group//' are '//join(names, ', ')
  end subroutine why_unknown

  !> Lists keys of which exactly one is required, if none is present, with a comma before the list; otherwise empty.
  pure subroutine list_missing(self, words)
    class(keys_t), intent(in) :: self
    character(:), allocatable, intent(out) :: words
    integer :: i

    words = ''
    do i = 1, self%known
      associate (key => self%key(i))
        if (.not. key%is_one_of .or. len(key%unused_without) > 0) cycle
        if (key%entry > 0) exit
        if (len(words) == 0) words = ', one of &'//trim(key%group)
        words = words//' '//trim(key%name)
      end associate
    end do
    if (i <= self%known) words = ''
  end subroutine list_missing

  !> Lists the keys of the text that are not used: for each set of tasks a line `tasks: &group key, key; &group key`.
  pure subroutine list_unused(self, text)
    class(keys_t), intent(in) :: self
    character(:), allocatable, intent(out) :: text
    type(lines_t) :: lines
    logical :: is_listed(self%known)
    integer :: i, k, before

    is_listed = .false.
    do i = 1, self%known
      if (is_listed(i) .or. .not. is_unused(i)) cycle
      call lines%put(self%key(i)%unused_without//':')
      before = 0
      do k = i, self%known
        if (.not. is_unused(k)) cycle
        if (self%key(k)%unused_without /= self%key(i)%unused_without) cycle
        if (before == 0) then
          call lines%put(' &'//trim(self%key(k)%group)//' ')
        else if (self%key(k)%group == self%key(before)%group) then
          call lines%put(', ')
        else
          call lines%put('; &'//trim(self%key(k)%group)//' ')
        end if
        call lines%put(trim(self%key(k)%name))
        is_listed(k) = .true.
        before = k
      end do
      call lines%add('')
    end do
    text = lines%text()

  contains

    pure logical function is_unused(i)
      integer, intent(in) :: i

      is_unused = self%key(i)%entry > 0 .and. len(self%key(i)%unused_without) > 0
    end function is_unused
  end subroutine list_unused

  !> Lists unusual numbers of the text, a line for each.
  pure subroutine list_cautions(self, text)
    class(keys_t), intent(in) :: self
    character(:), allocatable, intent(out) :: text
    type(lines_t) :: lines
    integer :: i

    do i = 1, self%known
      associate (key => self%key(i))
        if (allocated(key%caution)) call lines%add('&'//trim(key%group)//' '//trim(key%name)//': '//key%caution)
      end associate
    end do
    text = lines%text()
  end subroutine list_cautions

  !> Writes all values in effect as a case: those of `list`, and the other keys' defaults.
  pure subroutine write_case(self, list, text)
    class(keys_t), intent(in) :: self
    type(namelist_t), intent(in) :: list
    character(:), allocatable, intent(out) :: text
    type(lines_t) :: lines
    logical :: opened
    integer :: i, k

    do i = 1, size(self%groups)
      opened = .false.
      do k = 1, self%known
        associate (key => self%key(k))
          if (key%group /= self%groups(i)%name .or. .not. (key%entry > 0 .or. counts(key))) cycle
          if (.not. opened) call lines%add('&'//trim(self%groups(i)%name))
          opened = .true.
          if (key%entry > 0) then
            call add_values(lines, trim(key%name), list%entries(key%entry)%values)
          else
            call lines%add('  '//trim(key%name)//' = '//key%default)
          end if
        end associate
      end do
      if (opened) call lines%add('/')
    end do
    text = lines%text()

  contains

    !> True if the default of this key has an effect.
    pure logical function counts(key)
      type(key_t), intent(in) :: key

      counts = allocated(key%default) .and. len(key%unused_without) == 0 .and. len(key%not_allowed) == 0
    end function counts
  end subroutine write_case

  !> Writes the values in `list` of the keys declared since `asked` had the value `before`, as assignments.
  pure subroutine write_given(self, list, before, text)
    class(keys_t), intent(in) :: self
    type(namelist_t), intent(in) :: list
    integer, intent(in) :: before                !< value of `asked` at that time
    character(:), allocatable, intent(out) :: text
    type(lines_t) :: lines
    integer :: k

    do k = 1, self%known
      associate (key => self%key(k))
        if (key%entry > 0 .and. key%turn > before) call add_values(lines, trim(key%name), list%entries(key%entry)%values)
      end associate
    end do
    text = lines%text()
  end subroutine write_given

  !> Adds an assignment, on as many lines as it needs.
  pure subroutine add_values(lines, name, values)
    type(lines_t), intent(inout) :: lines
    character(*), intent(in) :: name
    type(value_t), intent(in) :: values(:)
    integer, parameter :: wide = 100
    integer :: i, k, width

    call lines%put('  '//name//' =')
    width = 0
    do i = 1, size(values)
      if (width > wide) then
        call lines%add('')
        call lines%put('   ')
        width = 0
      end if
      call lines%put(' ')
      ! Quotes inside a text are doubled.
      if (values(i)%quoted) call lines%put('''')
      do k = 1, len(values(i)%text)
        call lines%put(values(i)%text(k:k))
        if (values(i)%quoted .and. values(i)%text(k:k) == '''') call lines%put('''')
      end do
      if (values(i)%quoted) call lines%put('''')
      if (i < size(values)) call lines%put(',')
      width = width + len(values(i)%text) + 2
    end do
    call lines%add('')
  end subroutine add_values
end module gearsweep_study_reader_keys
