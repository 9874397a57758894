!> Takes typed values out of namelist text, each with its unit, its bounds and one clear error.
!>
!> A caller writes one `get` for each key of the format, then `finish`, and checks `error` once.
!> Keys that are absent leave their variable as it was: its default. A key that can have no effect is
!> asked for with `refused`, the reason why: then it must not be given. One that has none for what the
!> caller wants this time is asked for with `waits`, what it waits for: it is read and listed.
module gearsweep_reader
  use gearsweep_bounds, only: bound_integer, bound_real, bounds_t
  use gearsweep_error, only: code_input, error_t, fail
  use gearsweep_kinds, only: dp
  use gearsweep_keys, only: keys_t
  use gearsweep_namelist, only: name_length, namelist_t, parse_namelist
  use gearsweep_text, only: closest_word, join, lower
  use gearsweep_values, only: check_size, check_sizes, describe_texts, fail_entry, read_logical, read_numbers, read_texts, &
                             tell_number
  implicit none
  private
  public :: reader_t, open_reader

  type :: reader_t
    private
    type(namelist_t) :: list
    type(keys_t) :: keys
    logical :: completes = .false.               !< defaults are wanted, too
    !> The first key found missing; told last, as a misspelt key is missing too.
    type(error_t), allocatable :: missing
  contains
    !> `call reader%get(group, key, value, error, [given], [required], [waits], [refused], ...)`
    generic :: get => get_real, get_reals, get_integer, get_logical, get_text, get_texts
    procedure, private :: get_real, get_reals, get_integer, get_logical, get_text, get_texts
    procedure :: has, has_group, finish, check_key, list_waiting, write_complete
    procedure, private :: find, miss, miss_number, miss_text, settle, check_names, check_group
  end type reader_t

contains

  !> `groups` are those of the format; `completes`: `write_complete` will be called.
  pure subroutine open_reader(text, groups, reader, error, completes)
    character(*), intent(in) :: text, groups(:)
    type(reader_t), intent(out) :: reader
    type(error_t), allocatable, intent(inout) :: error
    logical, intent(in), optional :: completes

    reader%keys%groups = groups
    if (present(completes)) reader%completes = completes
    call parse_namelist(text, reader%list, error)
  end subroutine open_reader

  !> One number; the bounds are in the unit of the key, the result is multiplied by `scale`.
  pure subroutine get_real(self, group, key, value, error, given, required, waits, refused, scale, &
    & above, at_least, below, at_most)
    class(reader_t), intent(inout) :: self
    character(*), intent(in) :: group, key
    real(dp), intent(inout) :: value
    type(error_t), allocatable, intent(inout) :: error
    logical, intent(out), optional :: given
    logical, intent(in), optional :: required
    character(*), intent(in), optional :: waits, refused
    real(dp), intent(in), optional :: scale, above, at_least, below, at_most
    type(bounds_t) :: bounds
    real(dp), allocatable :: numbers(:)
    logical :: lacks
    integer :: at

    call bound_real(bounds, above, at_least, below, at_most)
    call self%find(group, key, at, lacks, error, given, required, waits, refused)
    if (lacks) call self%miss_number(group, key, bounds)
    if (at == 0 .and. .not. present(given)) call self%settle([value], bounds, scale)
    if (at == 0) return
    call check_size(self%list%entries(at), 'number', error)
    call read_numbers(self%list%entries(at), bounds, numbers, error, scale)
    if (.not. allocated(error)) value = numbers(1)
  end subroutine get_real

  !> A list of numbers; the bounds hold for each, `min_size` and `max_size` for how many there are.
  pure subroutine get_reals(self, group, key, value, error, given, required, waits, refused, scale, &
    & above, at_least, below, at_most, min_size, max_size)
    class(reader_t), intent(inout) :: self
    character(*), intent(in) :: group, key
    real(dp), allocatable, intent(inout) :: value(:)
    type(error_t), allocatable, intent(inout) :: error
    logical, intent(out), optional :: given
    logical, intent(in), optional :: required
    character(*), intent(in), optional :: waits, refused
    real(dp), intent(in), optional :: scale, above, at_least, below, at_most
    integer, intent(in), optional :: min_size, max_size
    type(bounds_t) :: bounds
    real(dp), allocatable :: numbers(:)
    logical :: lacks
    integer :: at

    call bound_real(bounds, above, at_least, below, at_most)
    call self%find(group, key, at, lacks, error, given, required, waits, refused)
    if (lacks) call self%miss_number(group, key, bounds)
    if (at == 0 .and. allocated(value) .and. .not. present(given)) call self%settle(value, bounds, scale)
    if (at == 0) return
    call check_sizes(self%list%entries(at), 'numbers', error, min_size, max_size)
    call read_numbers(self%list%entries(at), bounds, numbers, error, scale)
    if (.not. allocated(error)) call move_alloc(numbers, value)
  end subroutine get_reals

  pure subroutine get_integer(self, group, key, value, error, given, required, waits, refused, at_least, at_most)
    class(reader_t), intent(inout) :: self
    character(*), intent(in) :: group, key
    integer, intent(inout) :: value
    type(error_t), allocatable, intent(inout) :: error
    logical, intent(out), optional :: given
    logical, intent(in), optional :: required
    character(*), intent(in), optional :: waits, refused
    integer, intent(in), optional :: at_least, at_most
    type(bounds_t) :: bounds
    real(dp), allocatable :: numbers(:)
    logical :: lacks
    integer :: at

    call bound_integer(bounds, at_least, at_most)
    call self%find(group, key, at, lacks, error, given, required, waits, refused)
    if (lacks) call self%miss_number(group, key, bounds)
    if (at == 0 .and. .not. present(given)) call self%settle([real(value, dp)], bounds)
    if (at == 0) return
    call check_size(self%list%entries(at), 'integer', error)
    call read_numbers(self%list%entries(at), bounds, numbers, error)
    if (.not. allocated(error)) value = nint(numbers(1))
  end subroutine get_integer

  !> `.true.`, `true`, `T` and the same for false.
  pure subroutine get_logical(self, group, key, value, error, given, required, waits, refused)
    class(reader_t), intent(inout) :: self
    character(*), intent(in) :: group, key
    logical, intent(inout) :: value
    type(error_t), allocatable, intent(inout) :: error
    logical, intent(out), optional :: given
    logical, intent(in), optional :: required
    character(*), intent(in), optional :: waits, refused
    logical :: lacks
    integer :: at

    call self%find(group, key, at, lacks, error, given, required, waits, refused)
    if (lacks) call self%miss(group, key, '.true. or .false.')
    if (at == 0 .and. .not. present(given)) call self%keys%settle(trim(merge('.true. ', '.false.', value)))
    if (at == 0) return
    call check_size(self%list%entries(at), 'logical', error)
    call read_logical(self%list%entries(at), value, error)
  end subroutine get_logical

  !> One text; with `allowed`, one of these words in any case, returned in lower case.
  pure subroutine get_text(self, group, key, value, error, given, required, waits, refused, allowed)
    class(reader_t), intent(inout) :: self
    character(*), intent(in) :: group, key
    character(:), allocatable, intent(inout) :: value
    type(error_t), allocatable, intent(inout) :: error
    logical, intent(out), optional :: given
    logical, intent(in), optional :: required
    character(*), intent(in), optional :: waits, refused
    character(*), intent(in), optional :: allowed(:)
    character(:), allocatable :: texts(:)
    logical :: lacks
    integer :: at

    call self%find(group, key, at, lacks, error, given, required, waits, refused)
    if (lacks) call self%miss_text(group, key, allowed)
    if (at == 0 .and. allocated(value) .and. .not. present(given)) call self%keys%settle(''''//value//'''')
    if (at == 0) return
    call check_size(self%list%entries(at), 'text', error)
    call read_texts(self%list%entries(at), texts, error, allowed)
    if (.not. allocated(error)) value = texts(1)
    if (present(allowed) .and. .not. allocated(error)) value = trim(value)
  end subroutine get_text

  !> A list of texts, padded with blanks to the longest.
  pure subroutine get_texts(self, group, key, value, error, given, required, waits, refused, allowed, min_size, max_size)
    class(reader_t), intent(inout) :: self
    character(*), intent(in) :: group, key
    character(:), allocatable, intent(inout) :: value(:)
    type(error_t), allocatable, intent(inout) :: error
    logical, intent(out), optional :: given
    logical, intent(in), optional :: required
    character(*), intent(in), optional :: waits, refused
    character(*), intent(in), optional :: allowed(:)
    integer, intent(in), optional :: min_size, max_size
    logical :: lacks
    integer :: at

    call self%find(group, key, at, lacks, error, given, required, waits, refused)
    if (lacks) call self%miss_text(group, key, allowed)
    if (at == 0 .and. allocated(value) .and. .not. present(given)) call self%keys%settle(''''//join(value, ''', ''')//'''')
    if (at == 0) return
    call check_sizes(self%list%entries(at), 'texts', error, min_size, max_size)
    call read_texts(self%list%entries(at), value, error, allowed)
  end subroutine get_texts

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

    if (allocated(error)) return
    call self%check_names(error)
    if (allocated(self%missing)) call fail(error, self%missing%code, self%missing%message)
  end subroutine finish

  pure subroutine check_names(self, error)
    class(reader_t), intent(in) :: self
    type(error_t), allocatable, intent(inout) :: error
    character(:), allocatable :: why
    integer :: i

    do i = 1, size(self%list%groups)
      call self%check_group(trim(self%list%groups(i)), error)
    end do
    do i = 1, size(self%list%entries)
      associate (entry => self%list%entries(i))
        if (entry%used) cycle
        call self%keys%why_unknown(entry%group, entry%key, why)
        call fail_entry(entry, why, error)
      end associate
    end do
  end subroutine check_names

  !> Fails unless the format has this group.
  pure subroutine check_group(self, group, error)
    class(reader_t), intent(in) :: self
    character(*), intent(in) :: group
    type(error_t), allocatable, intent(inout) :: error
    character(:), allocatable :: why
    integer :: closest

    if (any(self%keys%groups == group)) return
    closest = closest_word(group, self%keys%groups)
    why = ''
    if (closest > 0) why = ' (did you mean &'//trim(self%keys%groups(closest))//'?)'
    call fail(error, code_input, '&'//group//': unknown group'//why//'; the groups are '//join(self%keys%groups, ', '))
  end subroutine check_group

  !> Fails unless the format has this key: one that has been asked for, whether it is given or not.
  pure subroutine check_key(self, group, key, error)
    class(reader_t), intent(in) :: self
    character(*), intent(in) :: group, key
    type(error_t), allocatable, intent(inout) :: error
    character(:), allocatable :: why

    call self%check_group(lower(group), error)
    if (allocated(error) .or. self%keys%has(lower(group), lower(key))) return
    call self%keys%why_unknown(lower(group), lower(key), why)
    call fail(error, code_input, '&'//lower(group)//' '//lower(key)//': '//why)
  end subroutine check_key

  !> The keys that wait: for each set of tasks a line `tasks: &group key, key; &group key`.
  pure subroutine list_waiting(self, text)
    class(reader_t), intent(in) :: self
    character(:), allocatable, intent(out) :: text

    call self%keys%list_waiting(text)
  end subroutine list_waiting

  !> The values in effect as a case: what is given, and the defaults of the rest.
  pure subroutine write_complete(self, text)
    class(reader_t), intent(in) :: self
    character(:), allocatable, intent(out) :: text

    call self%keys%write_case(self%list, text)
  end subroutine write_complete

  !> Default numbers of the key asked for last, to be told in its unit, so that they read back to the same
  !> bits. One that is not allowed stands for none.
  pure subroutine settle(self, values, bounds, scale)
    class(reader_t), intent(inout) :: self
    real(dp), intent(in) :: values(:)
    type(bounds_t), intent(in) :: bounds
    real(dp), intent(in), optional :: scale
    character(30) :: words(size(values))
    real(dp) :: number, unit
    logical :: found
    integer :: i

    if (.not. self%completes) return
    unit = 1
    if (present(scale)) unit = scale
    do i = 1, size(values)
      call tell_number(values(i), unit, words(i), number, found)
      if (.not. found .or. .not. bounds%allow(number)) return
    end do
    call self%keys%settle(join(words, ', '))
  end subroutine settle

  !> Notes that the key belongs to the format; `at` is its entry, or 0 where there is nothing to read;
  !> `lacks`: it must be given and is not.
  pure subroutine find(self, group, key, at, lacks, error, given, required, waits, refused)
    class(reader_t), intent(inout) :: self
    character(*), intent(in) :: group, key
    integer, intent(out) :: at
    logical, intent(out) :: lacks
    type(error_t), allocatable, intent(inout) :: error
    logical, intent(out), optional :: given
    logical, intent(in), optional :: required
    character(*), intent(in), optional :: waits, refused
    logical :: may

    at = 0
    lacks = .false.
    if (present(given)) given = .false.
    if (allocated(error)) return
    may = is_blank(refused)
    at = position(self%list, group, key)
    if (at > 0 .and. .not. may) call fail_entry(self%list%entries(at), trim(refused), error)
    if (.not. may) at = 0
    call self%keys%add(group, key, at, may, waits)
    if (at > 0) self%list%entries(at)%used = .true.
    if (present(given)) given = at > 0
    if (present(required)) lacks = required .and. at == 0 .and. may .and. is_blank(waits)
  end subroutine find

  pure subroutine miss(self, group, key, wanted)
    class(reader_t), intent(inout) :: self
    character(*), intent(in) :: group, key, wanted

    call fail(self%missing, code_input, '&'//group//' '//key//': missing; must be '//wanted)
  end subroutine miss

  pure subroutine miss_number(self, group, key, bounds)
    class(reader_t), intent(inout) :: self
    character(*), intent(in) :: group, key
    type(bounds_t), intent(in) :: bounds
    character(:), allocatable :: rule

    call bounds%describe(rule)
    call self%miss(group, key, rule)
  end subroutine miss_number

  pure subroutine miss_text(self, group, key, allowed)
    class(reader_t), intent(inout) :: self
    character(*), intent(in) :: group, key
    character(*), intent(in), optional :: allowed(:)
    character(:), allocatable :: rule

    call describe_texts(rule, allowed)
    call self%miss(group, key, rule)
  end subroutine miss_text

  pure logical function is_blank(words)
    character(*), intent(in), optional :: words

    is_blank = .true.
    if (present(words)) is_blank = len_trim(words) == 0
  end function is_blank

  pure integer function position(list, group, key) result(at)
    type(namelist_t), intent(in) :: list
    character(*), intent(in) :: group, key
    character(name_length) :: in_group, of_name

    in_group = lower(group)
    of_name = lower(key)
    if (.not. allocated(list%entries)) then
      at = 0
      return
    end if
    do at = size(list%entries), 1, -1
      if (list%entries(at)%key == of_name .and. list%entries(at)%group == in_group) return
    end do
  end function position
end module gearsweep_reader
