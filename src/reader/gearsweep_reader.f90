!> Takes typed values out of namelist text, each with its unit, its bounds and one clear error.
!>
!> A caller writes one `get` for each key of the format, then `finish`, and checks `error` once. The `get` is all that
!> is said of the key anywhere: what it means, its unit, what may be given and the tasks that use it; its variable holds
!> the default before, in SI units, and what is given after. A key that can have no effect is asked for with `refused`,
!> the reason why: then it must not be given. One that has none for what the caller wants this time, as no task in
!> `tasks` is wanted or for the reason in `lacks`, is read and listed.
module gearsweep_reader
  use gearsweep_bounds, only: bound_integer, bound_real, bounds_t
  use gearsweep_error, only: code_input, error_t, fail
  use gearsweep_kinds, only: dp
  use gearsweep_key, only: declare, key_t, kind_integer, kind_logical, kind_number, kind_text
  use gearsweep_keys, only: keys_t
  use gearsweep_namelist, only: name_length, namelist_t, parse_namelist
  use gearsweep_text, only: closest_word, join, lower
  use gearsweep_units, only: in_si
  use gearsweep_values, only: check_distinct, check_size, check_sizes, describe_texts, fail_entry, read_logical, read_numbers, &
                             read_texts, tell_number
  implicit none
  private
  public :: reader_t, open_list, open_reader

  type :: reader_t
    private
    type(namelist_t), public :: list
    type(keys_t), public :: keys
    logical :: keeps_defaults = .false.
    logical :: is_brief = .false.                !< keys that are not given, and need not be, are not kept
    character(:), allocatable :: tasks           !< those that are wanted, a blank in front of and behind each
    !> The first key found missing; told last, as a misspelt key is missing too.
    type(error_t), allocatable :: missing
    character(:), allocatable :: missing_too     !< the others, a comma and a blank in front of each
  contains
    !> `call reader%get(group, key, value, error, meaning, [unit], [given], [required], [tasks], [lacks], [refused], ...)`
    generic :: get => get_real, get_reals, get_integer, get_logical, get_text, get_texts
    procedure, private :: get_real, get_reals, get_integer, get_logical, get_text, get_texts
    procedure :: add_group, want, wants, has, has_used, has_group, finish, check_key, write_complete
    procedure, private :: passes, find, miss, set_default, check_names, check_group
  end type reader_t

contains

  !> Reads the text's form; then the format's groups are added. `keeps_defaults`: `write_complete` will be called, or
  !> the keys be described. `is_brief`: for a text that will be read in full where this ends with an error, whose message
  !> does not count.
  pure subroutine open_reader(text, reader, error, keeps_defaults, is_brief)
    character(*), intent(in) :: text
    type(reader_t), intent(out) :: reader
    type(error_t), allocatable, intent(inout) :: error
    logical, intent(in), optional :: keeps_defaults, is_brief

    if (present(keeps_defaults)) reader%keeps_defaults = keeps_defaults
    if (present(is_brief)) reader%is_brief = is_brief
    reader%tasks = ''
    reader%missing_too = ''
    call parse_namelist(text, reader%list, error)
  end subroutine open_reader

  !> The same for a text whose form has been read.
  pure subroutine open_list(list, reader, is_brief)
    type(namelist_t), intent(in) :: list
    type(reader_t), intent(out) :: reader
    logical, intent(in) :: is_brief

    reader%is_brief = is_brief
    reader%tasks = ''
    reader%missing_too = ''
    reader%list = list
  end subroutine open_list

  !> A group of the format and what it is about.
  pure subroutine add_group(self, name, meaning)
    class(reader_t), intent(inout) :: self
    character(*), intent(in) :: name, meaning

    call self%keys%add_group(name, meaning)
  end subroutine add_group

  !> From now on, keys for other tasks are not used.
  pure subroutine want(self, tasks)
    class(reader_t), intent(inout) :: self
    character(*), intent(in) :: tasks(:)

    self%tasks = ' '//join(tasks, ' ')//' '
  end subroutine want

  !> Is this task wanted?
  pure logical function wants(self, task)
    class(reader_t), intent(in) :: self
    character(*), intent(in) :: task

    wants = index(self%tasks, ' '//trim(task)//' ') > 0
  end function wants

  !> One number. The bounds are in the key's unit; what is given is converted to SI units, then multiplied by `factor`.
  pure subroutine get_real(self, group, key, value, error, meaning, unit, factor, given, required, one_of, tasks, lacks, &
                           refused, otherwise, above, at_least, below, at_most)
    class(reader_t), intent(inout) :: self
    character(*), intent(in) :: group, key, meaning
    real(dp), intent(inout) :: value
    type(error_t), allocatable, intent(inout) :: error
    character(*), intent(in), optional :: unit, tasks, lacks, refused, otherwise
    logical, intent(out), optional :: given
    logical, intent(in), optional :: required, one_of
    real(dp), intent(in), optional :: factor, above, at_least, below, at_most
    type(key_t) :: wanted
    real(dp), allocatable :: numbers(:)
    real(dp) :: scale
    integer :: at

    if (present(given)) given = .false.
    if (self%passes(group, key, required)) return
    call declare(wanted, group, key, meaning, kind_number, unit, tasks, otherwise, required, one_of)
    call bound_real(wanted%bounds, wanted%unit, above, at_least, below, at_most)
    call self%find(wanted, at, error, given, lacks, refused)
    scale = in_si(wanted%unit)
    if (present(factor)) scale = scale*factor
    if (.not. present(given)) call self%set_default([value], wanted%bounds, scale)
    if (at == 0) return
    call check_size(self%list%entries(at), 'number', error)
    call read_numbers(self%list%entries(at), wanted%bounds, numbers, error, scale)
    if (.not. allocated(error)) value = numbers(1)
  end subroutine get_real

  !> A list of numbers; the bounds hold for each, `min_size` and `max_size` for how many there are. `distinct`: none twice.
  pure subroutine get_reals(self, group, key, value, error, meaning, unit, given, required, one_of, tasks, lacks, &
                            refused, otherwise, above, at_least, below, at_most, min_size, max_size, distinct)
    class(reader_t), intent(inout) :: self
    character(*), intent(in) :: group, key, meaning
    real(dp), allocatable, intent(inout) :: value(:)
    type(error_t), allocatable, intent(inout) :: error
    character(*), intent(in), optional :: unit, tasks, lacks, refused, otherwise
    logical, intent(out), optional :: given
    logical, intent(in), optional :: required, one_of, distinct
    real(dp), intent(in), optional :: above, at_least, below, at_most
    integer, intent(in), optional :: min_size, max_size
    type(key_t) :: wanted
    real(dp), allocatable :: numbers(:)
    real(dp) :: scale
    integer :: at

    if (present(given)) given = .false.
    if (self%passes(group, key, required)) return
    call declare(wanted, group, key, meaning, kind_number, unit, tasks, otherwise, required, one_of)
    call bound_real(wanted%bounds, wanted%unit, above, at_least, below, at_most)
    call wanted%allow_list(min_size, max_size)
    call self%find(wanted, at, error, given, lacks, refused)
    scale = in_si(wanted%unit)
    if (allocated(value) .and. .not. present(given)) call self%set_default(value, wanted%bounds, scale)
    if (at == 0) return
    call check_sizes(self%list%entries(at), 'numbers', error, min_size, max_size)
    call read_numbers(self%list%entries(at), wanted%bounds, numbers, error, scale)
    if (present(distinct)) call check_distinct(self%list%entries(at), numbers, error)
    if (.not. allocated(error)) call move_alloc(numbers, value)
  end subroutine get_reals

  pure subroutine get_integer(self, group, key, value, error, meaning, given, required, one_of, tasks, lacks, refused, &
                              otherwise, at_least, at_most)
    class(reader_t), intent(inout) :: self
    character(*), intent(in) :: group, key, meaning
    integer, intent(inout) :: value
    type(error_t), allocatable, intent(inout) :: error
    character(*), intent(in), optional :: tasks, lacks, refused, otherwise
    logical, intent(out), optional :: given
    logical, intent(in), optional :: required, one_of
    integer, intent(in), optional :: at_least, at_most
    type(key_t) :: wanted
    real(dp), allocatable :: numbers(:)
    integer :: at

    if (present(given)) given = .false.
    if (self%passes(group, key, required)) return
    call declare(wanted, group, key, meaning, kind_integer, '', tasks, otherwise, required, one_of)
    call bound_integer(wanted%bounds, at_least, at_most)
    call self%find(wanted, at, error, given, lacks, refused)
    if (.not. present(given)) call self%set_default([real(value, dp)], wanted%bounds, 1.0_dp)
    if (at == 0) return
    call check_size(self%list%entries(at), 'integer', error)
    call read_numbers(self%list%entries(at), wanted%bounds, numbers, error)
    if (.not. allocated(error)) value = nint(numbers(1))
  end subroutine get_integer

  !> `.true.`, `true`, `T` and the same for false.
  pure subroutine get_logical(self, group, key, value, error, meaning, given, required, one_of, tasks, lacks, refused, &
                              otherwise)
    class(reader_t), intent(inout) :: self
    character(*), intent(in) :: group, key, meaning
    logical, intent(inout) :: value
    type(error_t), allocatable, intent(inout) :: error
    character(*), intent(in), optional :: tasks, lacks, refused, otherwise
    logical, intent(out), optional :: given
    logical, intent(in), optional :: required, one_of
    type(key_t) :: wanted
    integer :: at

    if (present(given)) given = .false.
    if (self%passes(group, key, required)) return
    call declare(wanted, group, key, meaning, kind_logical, '', tasks, otherwise, required, one_of)
    call self%find(wanted, at, error, given, lacks, refused)
    if (.not. present(given)) call self%keys%set_default(trim(merge('.true. ', '.false.', value)))
    if (at == 0) return
    call check_size(self%list%entries(at), 'logical', error)
    call read_logical(self%list%entries(at), value, error)
  end subroutine get_logical

  !> One text; with `allowed`, one of these words in any case, returned in lower case.
  pure subroutine get_text(self, group, key, value, error, meaning, given, required, one_of, tasks, lacks, refused, &
                           otherwise, allowed)
    class(reader_t), intent(inout) :: self
    character(*), intent(in) :: group, key, meaning
    character(:), allocatable, intent(inout) :: value
    type(error_t), allocatable, intent(inout) :: error
    character(*), intent(in), optional :: tasks, lacks, refused, otherwise
    logical, intent(out), optional :: given
    logical, intent(in), optional :: required, one_of
    character(*), intent(in), optional :: allowed(:)
    type(key_t) :: wanted
    character(:), allocatable :: texts(:)
    integer :: at

    if (present(given)) given = .false.
    if (self%passes(group, key, required)) return
    call declare(wanted, group, key, meaning, kind_text, '', tasks, otherwise, required, one_of)
    if (present(allowed)) wanted%words = allowed
    call self%find(wanted, at, error, given, lacks, refused)
    if (allocated(value) .and. .not. present(given)) call self%keys%set_default(''''//value//'''')
    if (at == 0) return
    call check_size(self%list%entries(at), 'text', error)
    call read_texts(self%list%entries(at), texts, error, allowed)
    if (.not. allocated(error)) value = texts(1)
    if (present(allowed) .and. .not. allocated(error)) value = trim(value)
  end subroutine get_text

  !> A list of texts, padded with blanks to the longest.
  pure subroutine get_texts(self, group, key, value, error, meaning, given, required, one_of, tasks, lacks, refused, &
                            otherwise, allowed, min_size, max_size)
    class(reader_t), intent(inout) :: self
    character(*), intent(in) :: group, key, meaning
    character(:), allocatable, intent(inout) :: value(:)
    type(error_t), allocatable, intent(inout) :: error
    character(*), intent(in), optional :: tasks, lacks, refused, otherwise
    logical, intent(out), optional :: given
    logical, intent(in), optional :: required, one_of
    character(*), intent(in), optional :: allowed(:)
    integer, intent(in), optional :: min_size, max_size
    type(key_t) :: wanted
    integer :: at

    if (present(given)) given = .false.
    if (self%passes(group, key, required)) return
    call declare(wanted, group, key, meaning, kind_text, '', tasks, otherwise, required, one_of)
    if (present(allowed)) wanted%words = allowed
    call wanted%allow_list(min_size, max_size)
    call self%find(wanted, at, error, given, lacks, refused)
    if (allocated(value) .and. .not. present(given)) call self%keys%set_default(''''//join(value, ''', ''')//'''')
    if (at == 0) return
    call check_sizes(self%list%entries(at), 'texts', error, min_size, max_size)
    call read_texts(self%list%entries(at), value, error, allowed)
  end subroutine get_texts

  !> The key is given, with a value.
  pure logical function has(self, group, key)
    class(reader_t), intent(in) :: self
    character(*), intent(in) :: group, key

    has = self%list%position(group, key) > 0
  end function has

  !> The key is given, with a value, and has been asked for.
  pure logical function has_used(self, group, key)
    class(reader_t), intent(in) :: self
    character(*), intent(in) :: group, key
    integer :: at

    at = self%list%position(group, key)
    has_used = at > 0
    if (has_used) has_used = self%list%entries(at)%used
  end function has_used

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
    if (.not. allocated(self%missing)) return
    associate (others => self%missing_too//self%keys%lacking_choice())
      if (len(others) > 0) call fail(error, self%missing%code, self%missing%message//'; missing too: '//others(3:))
    end associate
    call fail(error, self%missing%code, self%missing%message)
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
    character(name_length), allocatable :: names(:)
    character(:), allocatable :: why
    integer :: closest

    call self%keys%list_groups(names)
    if (any(names == group)) return
    closest = closest_word(group, names)
    why = ''
    if (closest > 0) why = ' (did you mean &'//trim(names(closest))//'?)'
    call fail(error, code_input, '&'//group//': unknown group'//why//'; the groups are '//join(names, ', '))
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

  !> The values in effect as a case: what is given, and the defaults of the rest.
  pure subroutine write_complete(self, text)
    class(reader_t), intent(in) :: self
    character(:), allocatable, intent(out) :: text

    call self%keys%write_case(self%list, text)
  end subroutine write_complete

  !> Default numbers of the key asked for last, to be told in its unit, so that they read back to the same
  !> bits. One that is not allowed stands for none.
  pure subroutine set_default(self, values, bounds, scale)
    class(reader_t), intent(inout) :: self
    real(dp), intent(in) :: values(:), scale
    type(bounds_t), intent(in) :: bounds
    character(30) :: words(size(values))
    real(dp) :: number
    logical :: found
    integer :: i

    if (.not. self%keeps_defaults) return
    do i = 1, size(values)
      call tell_number(values(i), scale, words(i), number, found)
      if (.not. found .or. .not. bounds%allow(number)) return
    end do
    call self%keys%set_default(join(words, ', '))
  end subroutine set_default

  !> Is there nothing to do for this key?
  pure logical function passes(self, group, key, required)
    class(reader_t), intent(in) :: self
    character(*), intent(in) :: group, key
    logical, intent(in), optional :: required

    passes = self%is_brief
    if (passes .and. present(required)) passes = .not. required
    if (passes) passes = .not. self%has(group, key)
  end function passes

  !> Notes that the key belongs to the format; `at` is its entry, or 0 where there is nothing to read.
  pure subroutine find(self, key, at, error, given, lacks, refused)
    class(reader_t), intent(inout) :: self
    type(key_t), intent(inout) :: key
    integer, intent(out) :: at
    type(error_t), allocatable, intent(inout) :: error
    logical, intent(out), optional :: given
    character(*), intent(in), optional :: lacks, refused
    logical :: may_be

    at = 0
    if (present(lacks)) key%lacks = trim(lacks)
    if (present(refused)) key%refused = trim(refused)
    if (len(key%lacks) == 0 .and. .not. key%is_for(self%tasks)) key%lacks = key%tasks
    may_be = len(key%refused) == 0
    if (.not. allocated(error)) then
      at = self%list%position(key%group, key%name)
      if (at > 0 .and. .not. may_be) call fail_entry(self%list%entries(at), key%refused, error)
      if (.not. may_be) at = 0
    end if
    key%entry = at
    call self%keys%add(key)
    if (at > 0) self%list%entries(at)%used = .true.
    if (present(given)) given = at > 0
    if (key%is_required .and. at == 0 .and. may_be .and. len(key%lacks) == 0) call self%miss(key)
  end subroutine find

  pure subroutine miss(self, key)
    class(reader_t), intent(inout) :: self
    type(key_t), intent(in) :: key
    ! A bound that only keeps computation within its range helps nobody who has yet to give a number.
    real(dp), parameter :: farthest = 1e6_dp
    character(:), allocatable :: rule

    select case (key%kind)
    case (kind_logical)
      rule = '.true. or .false.'
    case (kind_text)
      if (allocated(key%words)) call describe_texts(rule, key%words)
      if (.not. allocated(key%words)) call describe_texts(rule)
    case default
      call key%bounds%describe(rule, farthest)
    end select
    if (allocated(self%missing)) self%missing_too = self%missing_too//', &'//trim(key%group)//' '//trim(key%name)
    call fail(self%missing, code_input, '&'//trim(key%group)//' '//trim(key%name)//': missing; must be '//rule)
  end subroutine miss
end module gearsweep_reader
