!> Takes typed values out of namelist text, each with its unit, its bounds and one clear error.
!>
!> A caller writes one `get` for each key of the format, then `finish`, and checks `error` once.
!> Keys that are absent leave their variable as it was: its default.
module gearsweep_reader
  use gearsweep_bounds, only: bound_integer, bound_real, bounds_t
  use gearsweep_error, only: code_input, error_t, fail
  use gearsweep_kinds, only: dp
  use gearsweep_keys, only: keys_t
  use gearsweep_namelist, only: entry_t, name_length, namelist_t, parse_namelist, value_t
  use gearsweep_text, only: closest_word, join, lower, shown, str, to_number
  implicit none
  private
  public :: reader_t, open_reader

  type :: reader_t
    private
    type(namelist_t) :: list
    type(keys_t) :: keys
    !> The first key found missing; told last, as a misspelt key is missing too.
    type(error_t), allocatable :: missing
  contains
    !> `call reader%get(group, key, value, error, [given], [required], ...)`
    generic :: get => get_real, get_reals, get_integer, get_logical, get_text, get_texts
    procedure, private :: get_real, get_reals, get_integer, get_logical, get_text, get_texts
    procedure :: refuse, refuse_groups, has, has_group, finish, write_complete
    procedure, private :: find, settle
  end type reader_t

contains

  pure subroutine open_reader(text, reader, error)
    character(*), intent(in) :: text
    type(reader_t), intent(out) :: reader
    type(error_t), allocatable, intent(inout) :: error

    call parse_namelist(text, reader%list, error)
  end subroutine open_reader

  !> One number; the bounds are in the unit of the key, the result is multiplied by `scale`.
  pure subroutine get_real(self, group, key, value, error, given, required, scale, &
    & above, at_least, below, at_most)
    class(reader_t), intent(inout) :: self
    character(*), intent(in) :: group, key
    real(dp), intent(inout) :: value
    type(error_t), allocatable, intent(inout) :: error
    logical, intent(out), optional :: given
    logical, intent(in), optional :: required
    real(dp), intent(in), optional :: scale, above, at_least, below, at_most
    type(bounds_t) :: bounds
    real(dp), allocatable :: numbers(:)
    integer :: at

    call bound_real(bounds, above, at_least, below, at_most)
    call self%find(group, key, bounds%rule, at, error, given, required)
    if (at == 0 .and. .not. present(given)) call self%settle([value], bounds, scale)
    if (at == 0) return
    call check_size(self%list%entries(at), 'number', error)
    call read_numbers(self%list%entries(at), bounds, numbers, error, scale)
    if (.not. allocated(error)) value = numbers(1)
  end subroutine get_real

  !> A list of numbers; the bounds hold for each, `min_size` and `max_size` for how many there are.
  pure subroutine get_reals(self, group, key, value, error, given, required, scale, &
    & above, at_least, below, at_most, min_size, max_size)
    class(reader_t), intent(inout) :: self
    character(*), intent(in) :: group, key
    real(dp), allocatable, intent(inout) :: value(:)
    type(error_t), allocatable, intent(inout) :: error
    logical, intent(out), optional :: given
    logical, intent(in), optional :: required
    real(dp), intent(in), optional :: scale, above, at_least, below, at_most
    integer, intent(in), optional :: min_size, max_size
    type(bounds_t) :: bounds
    real(dp), allocatable :: numbers(:)
    integer :: at

    call bound_real(bounds, above, at_least, below, at_most)
    call self%find(group, key, bounds%rule, at, error, given, required)
    if (at == 0 .and. allocated(value) .and. .not. present(given)) call self%settle(value, bounds, scale)
    if (at == 0) return
    call check_sizes(self%list%entries(at), 'numbers', error, min_size, max_size)
    call read_numbers(self%list%entries(at), bounds, numbers, error, scale)
    if (.not. allocated(error)) call move_alloc(numbers, value)
  end subroutine get_reals

  pure subroutine get_integer(self, group, key, value, error, given, required, at_least, at_most)
    class(reader_t), intent(inout) :: self
    character(*), intent(in) :: group, key
    integer, intent(inout) :: value
    type(error_t), allocatable, intent(inout) :: error
    logical, intent(out), optional :: given
    logical, intent(in), optional :: required
    integer, intent(in), optional :: at_least, at_most
    type(bounds_t) :: bounds
    real(dp), allocatable :: numbers(:)
    integer :: at

    call bound_integer(bounds, at_least, at_most)
    call self%find(group, key, bounds%rule, at, error, given, required)
    if (at == 0 .and. .not. present(given)) call self%settle([real(value, dp)], bounds)
    if (at == 0) return
    call check_size(self%list%entries(at), 'integer', error)
    call read_numbers(self%list%entries(at), bounds, numbers, error)
    if (.not. allocated(error)) value = nint(numbers(1))
  end subroutine get_integer

  !> `.true.`, `true`, `T` and the same for false.
  pure subroutine get_logical(self, group, key, value, error, given, required)
    class(reader_t), intent(inout) :: self
    character(*), intent(in) :: group, key
    logical, intent(inout) :: value
    type(error_t), allocatable, intent(inout) :: error
    logical, intent(out), optional :: given
    logical, intent(in), optional :: required
    character(*), parameter :: wanted = '.true. or .false.'
    integer :: at

    call self%find(group, key, wanted, at, error, given, required)
    if (at == 0 .and. .not. present(given)) call self%keys%settle(trim(merge('.true. ', '.false.', value)))
    if (at == 0) return
    associate (entry => self%list%entries(at))
      call check_size(entry, 'logical', error)
      if (entry%values(1)%quoted) call fail_entry(entry, 'must be '//wanted, error)
      if (allocated(error)) return
      select case (lower(entry%values(1)%text))
      case ('.true.', 'true', '.t.', 't')
        value = .true.
      case ('.false.', 'false', '.f.', 'f')
        value = .false.
      case default
        call fail_entry(entry, 'must be '//wanted, error)
      end select
    end associate
  end subroutine get_logical

  !> One text; with `allowed`, one of these words in any case, returned in lower case.
  pure subroutine get_text(self, group, key, value, error, given, required, allowed)
    class(reader_t), intent(inout) :: self
    character(*), intent(in) :: group, key
    character(:), allocatable, intent(inout) :: value
    type(error_t), allocatable, intent(inout) :: error
    logical, intent(out), optional :: given
    logical, intent(in), optional :: required
    character(*), intent(in), optional :: allowed(:)
    integer :: at

    call self%find(group, key, text_rule(allowed), at, error, given, required)
    if (at == 0 .and. allocated(value) .and. .not. present(given)) call self%keys%settle(''''//value//'''')
    if (at == 0) return
    associate (entry => self%list%entries(at))
      call check_size(entry, 'text', error)
      call check_texts(entry, error, allowed)
      if (allocated(error)) return
      value = entry%values(1)%text
      if (present(allowed)) value = trim(lower(value))
    end associate
  end subroutine get_text

  !> A list of texts, padded with blanks to the longest.
  pure subroutine get_texts(self, group, key, value, error, given, required, allowed, min_size, max_size)
    class(reader_t), intent(inout) :: self
    character(*), intent(in) :: group, key
    character(:), allocatable, intent(inout) :: value(:)
    type(error_t), allocatable, intent(inout) :: error
    logical, intent(out), optional :: given
    logical, intent(in), optional :: required
    character(*), intent(in), optional :: allowed(:)
    integer, intent(in), optional :: min_size, max_size
    integer :: at, i, longest

    call self%find(group, key, text_rule(allowed), at, error, given, required)
    if (at == 0 .and. allocated(value) .and. .not. present(given)) call self%keys%settle(''''//join(value, ''', ''')//'''')
    if (at == 0) return
    associate (entry => self%list%entries(at))
      call check_sizes(entry, 'texts', error, min_size, max_size)
      call check_texts(entry, error, allowed)
      if (allocated(error)) return
      longest = maxval([(len(entry%values(i)%text), i=1, size(entry%values))])
      if (allocated(value)) deallocate (value)
      allocate (character(longest) :: value(size(entry%values)))
      do i = 1, size(value)
        value(i) = entry%values(i)%text
        if (present(allowed)) value(i) = lower(value(i))
      end do
    end associate
  end subroutine get_texts

  !> Fails if this key is given: for keys that make no sense beside others.
  pure subroutine refuse(self, group, key, why, error)
    class(reader_t), intent(inout) :: self
    character(*), intent(in) :: group, key, why
    type(error_t), allocatable, intent(inout) :: error
    integer :: at

    call self%find(group, key, '', at, error)
    if (at > 0) call fail_entry(self%list%entries(at), why, error)
    call self%keys%forget(group, key)
  end subroutine refuse

  !> Fails if one of these groups is given, be it empty.
  pure subroutine refuse_groups(self, groups, why, error)
    class(reader_t), intent(inout) :: self
    character(*), intent(in) :: groups(:), why
    type(error_t), allocatable, intent(inout) :: error
    integer :: i

    do i = 1, size(groups)
      if (self%has_group(trim(groups(i)))) call fail(error, code_input, '&'//join(groups, ', &')//': '//why)
      call self%keys%forget(groups(i))
    end do
  end subroutine refuse_groups

  !> The key is given, with a value.
  pure logical function has(self, group, key)
    class(reader_t), intent(in) :: self
    character(*), intent(in) :: group, key

    has = position(self%list, group, key) > 0
  end function has

  !> The group is there, be it empty.
  pure logical function has_group(self, group)
    class(reader_t), intent(in) :: self
    character(*), intent(in) :: group

    has_group = .false.
    if (allocated(self%list%groups)) has_group = any(self%list%groups == lower(group))
  end function has_group

  !> Fails if the text has a group or a key that nobody asked for, or lacks a required key.
  pure subroutine finish(self, error)
    class(reader_t), intent(in) :: self
    type(error_t), allocatable, intent(inout) :: error
    character(name_length), allocatable :: known(:)
    character(:), allocatable :: group
    integer :: i

    if (allocated(error)) return
    known = self%keys%groups()
    do i = 1, size(self%list%groups)
      group = trim(self%list%groups(i))
      if (all(known /= group)) call fail(error, code_input, '&'//group//': unknown group' &
        & //guess(group, known, '&')//'; the groups are '//join(known, ', '))
    end do
    do i = 1, size(self%list%entries)
      associate (entry => self%list%entries(i))
        if (.not. entry%used) call fail_entry(entry, self%keys%why_unknown(entry%group, entry%key), error)
      end associate
    end do
    if (allocated(self%missing)) call fail(error, self%missing%code, self%missing%message)
  end subroutine finish

  !> The values in effect as a case: what is given, and the defaults of the rest.
  pure subroutine write_complete(self, text)
    class(reader_t), intent(in) :: self
    character(:), allocatable, intent(out) :: text

    call self%keys%write_case(self%list, text)
  end subroutine write_complete

  !> Default numbers of the key asked for last, to be told in its unit. One that is not allowed stands
  !> for none.
  pure subroutine settle(self, values, bounds, scale)
    class(reader_t), intent(inout) :: self
    real(dp), intent(in) :: values(:)
    type(bounds_t), intent(in) :: bounds
    real(dp), intent(in), optional :: scale
    character(30) :: words(size(values))
    real(dp) :: number
    integer :: i

    do i = 1, size(values)
      number = values(i)
      if (present(scale)) number = number/scale
      if (.not. bounds%allow(number)) return
      words(i) = str(number)
    end do
    call self%keys%settle(join(words, ', '))
  end subroutine settle

  !> Notes that the key belongs to the format; `at` is its entry, or 0 where there is nothing to read.
  pure subroutine find(self, group, key, wanted, at, error, given, required)
    class(reader_t), intent(inout) :: self
    character(*), intent(in) :: group, key, wanted
    integer, intent(out) :: at
    type(error_t), allocatable, intent(inout) :: error
    logical, intent(out), optional :: given
    logical, intent(in), optional :: required

    at = 0
    if (present(given)) given = .false.
    if (allocated(error)) return
    at = position(self%list, group, key)
    call self%keys%add(group, key, at)
    if (present(given)) given = at > 0
    if (at > 0) then
      self%list%entries(at)%used = .true.
    else if (present(required)) then
      if (required) call fail(self%missing, code_input, '&'//group//' '//key//': missing; must be '//wanted)
    end if
  end subroutine find

  pure integer function position(list, group, key) result(at)
    type(namelist_t), intent(in) :: list
    character(*), intent(in) :: group, key
    integer :: i

    at = 0
    if (.not. allocated(list%entries)) return
    do i = 1, size(list%entries)
      if (list%entries(i)%key /= lower(key) .or. list%entries(i)%group /= lower(group)) cycle
      at = i
      return
    end do
  end function position

  !> All values of the entry as numbers within bounds, times `scale`.
  pure subroutine read_numbers(entry, bounds, numbers, error, scale)
    type(entry_t), intent(in) :: entry
    type(bounds_t), intent(in) :: bounds
    real(dp), allocatable, intent(out) :: numbers(:)
    type(error_t), allocatable, intent(inout) :: error
    real(dp), intent(in), optional :: scale
    integer :: i

    if (allocated(error)) return
    allocate (numbers(size(entry%values)))
    do i = 1, size(numbers)
      call read_number(entry%values(i), bounds, numbers(i), error, entry)
      if (allocated(error)) return
    end do
    if (.not. present(scale)) return
    if (any(abs(numbers) > huge(scale)/max(1.0_dp, abs(scale)))) then
      call fail_entry(entry, 'is too large', error)
    else
      numbers = numbers*scale
    end if
  end subroutine read_numbers

  pure subroutine read_number(value, bounds, number, error, entry)
    type(value_t), intent(in) :: value
    type(bounds_t), intent(in) :: bounds
    real(dp), intent(out) :: number
    type(error_t), allocatable, intent(inout) :: error
    type(entry_t), intent(in) :: entry
    integer :: whole
    logical :: ok

    if (bounds%kind == 'an integer') then
      call to_number(value%text, whole, ok)
      number = whole
    else
      call to_number(value%text, number, ok)
    end if
    if (.not. ok .or. value%quoted) then
      call fail_entry(entry, 'must be '//bounds%kind, error)
    else if (.not. bounds%allow(number)) then
      call fail_entry(entry, 'must be '//bounds%rule, error)
    end if
  end subroutine read_number

  pure function text_rule(allowed) result(words)
    character(*), intent(in), optional :: allowed(:)
    character(:), allocatable :: words

    words = 'a text in quotes'
    if (.not. present(allowed)) return
    words = ''''//join(allowed, ''', ''')//''''
    if (size(allowed) > 1) words = 'one of '//words
  end function text_rule

  !> Bare words pass where they are one of the allowed ones: they cannot mean anything else.
  pure subroutine check_texts(entry, error, allowed)
    type(entry_t), intent(in) :: entry
    type(error_t), allocatable, intent(inout) :: error
    character(*), intent(in), optional :: allowed(:)
    logical :: ok
    integer :: i

    if (allocated(error)) return
    do i = 1, size(entry%values)
      ok = entry%values(i)%quoted
      if (present(allowed)) ok = any(lower_all(allowed) == lower(entry%values(i)%text))
      if (.not. ok) call fail_entry(entry, 'must be '//text_rule(allowed), error)
      if (.not. ok) return
    end do
  end subroutine check_texts

  pure function lower_all(words) result(small)
    character(*), intent(in) :: words(:)
    character(len(words)) :: small(size(words))
    integer :: i

    do i = 1, size(words)
      small(i) = lower(words(i))
    end do
  end function lower_all

  pure subroutine check_size(entry, what, error)
    type(entry_t), intent(in) :: entry
    character(*), intent(in) :: what
    type(error_t), allocatable, intent(inout) :: error

    if (size(entry%values) > 1) call fail_entry(entry, 'must be a single '//what, error)
  end subroutine check_size

  pure subroutine check_sizes(entry, what, error, min_size, max_size)
    type(entry_t), intent(in) :: entry
    character(*), intent(in) :: what
    type(error_t), allocatable, intent(inout) :: error
    integer, intent(in), optional :: min_size, max_size

    if (present(min_size)) then
      if (size(entry%values) < min_size) &
        & call fail_entry(entry, 'must be at least '//str(min_size)//' '//what, error)
    end if
    if (present(max_size)) then
      if (size(entry%values) > max_size) &
        & call fail_entry(entry, 'must be at most '//str(max_size)//' '//what, error)
    end if
  end subroutine check_sizes

  !> `&group key = values: why`
  pure subroutine fail_entry(entry, why, error)
    type(entry_t), intent(in) :: entry
    character(*), intent(in) :: why
    type(error_t), allocatable, intent(inout) :: error
    integer, parameter :: enough = 100
    character(:), allocatable :: values
    integer :: i

    values = ''
    do i = 1, size(entry%values)
      if (i > 1) values = values//', '
      associate (value => entry%values(i))
        if (value%quoted) then
          values = values//''''//value%text//''''
        else
          values = values//value%text
        end if
      end associate
      if (len(values) > enough) exit
    end do
    call fail(error, code_input, '&'//shown(entry%group)//' '//shown(entry%key)//' = ' &
      & //shown(values)//': '//why)
  end subroutine fail_entry

  pure function guess(word, words, mark) result(question)
    character(*), intent(in) :: word, words(:), mark
    character(:), allocatable :: question

    question = closest_word(word, words)
    if (question /= '') question = ' (did you mean '//mark//question//'?)'
  end function guess
end module gearsweep_reader
