!> Reads typed values from namelist text, each with its unit, its bounds and one clear error.
!>
!> A caller writes one `get` for each key of the format, then `finish`, and checks `error` once. The `get` is the only declaration
!> of the key: its meaning, unit, allowed values and the tasks that use it. Its variable holds the default before, in SI units, and
!> the value of the text afterwards. A key that contradicts other keys of the case is declared with `not_allowed`, the reason: an
!> error if the text has it. A key without effect in this case, as no task in `tasks` is requested or the case does not have what
!> `unused_without` names, is read and listed as not used. `default_note` describes what applies instead of a default.
module gearsweep_study_reader_reader
  use gearsweep_base, only: closest_word, code_input, dp, error_t, fail, in_si, join, lower
  use gearsweep_study_reader_keys, only: bound_integer, bound_real, bounds_t, declare, key_t, keys_t, kind_integer, kind_logical, &
    kind_number, kind_text
  use gearsweep_study_reader_namelist, only: name_length, namelist_t, parse_namelist
  use gearsweep_study_reader_unit_slips, only: find_slip
  use gearsweep_study_reader_values, only: check_distinct, check_size, check_sizes, describe_texts, fail_entry, read_logical, &
    read_numbers, read_texts, shortest_digits
  implicit none
  private
  public :: reader_t, open_list, open_reader, text_unless, first_nonblank, is_prescribed

  !> Length of a list of tasks in a sentence: room for the 32 tasks that gearsweep_api_tasks may hold, with the separators.
  integer, parameter, public :: sentence_length = 32*24
  character(*), parameter, public :: needs_gears = 'not used by a prescribed mesh (&mesh contact_ratio); remove it'

  !> Format of a text, whose keys are read as they are declared: its groups and keys, and which are used, unknown or missing.
  type :: reader_t
    type(namelist_t) :: list
    type(keys_t) :: keys
    logical :: keeps_defaults = .false.
    logical :: is_brief = .false.                !< true: optional keys that the text does not have are not stored
    character(:), allocatable :: tasks           !< requested tasks, with a blank before and after each
    !> Error of the first missing key; reported last, as a misspelt key is missing too.
    type(error_t), allocatable :: missing
    character(:), allocatable :: missing_too     !< other missing keys, with a comma and a blank before each
  contains
    procedure :: add_group, request, requests, has, has_used, has_group, finish, check_key, write_complete
    !> `call reader%get(group, key, value, error, meaning, [unit], [is_stated], [tasks], [unused_without], [not_allowed], ...)`
    generic :: get => get_real, get_reals, get_integer, get_logical, get_text, get_texts
    procedure, private :: get_real, get_reals, get_integer, get_logical, get_text, get_texts
    procedure, private :: set_default, is_skipped, find, check_magnitude, add_missing, check_group
  end type reader_t

contains

  !> Splits the text; the format's groups are added afterwards. `keeps_defaults`: required for `write_complete` and for a
  !> description of the keys. `is_brief`: for a text that is read again in full after an error, whose message is not used.
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

  !> Opens a reader on a text that is already split.
  pure subroutine open_list(list, reader, is_brief)
    type(namelist_t), intent(in) :: list
    type(reader_t), intent(out) :: reader
    logical, intent(in) :: is_brief

    reader%is_brief = is_brief
    reader%tasks = ''
    reader%missing_too = ''
    reader%list = list
  end subroutine open_list

  !> Reads one number. The bounds are in the key's unit; the value is converted to SI units, then multiplied by `factor`.
  pure subroutine get_real(self, group, key, value, error, meaning, unit, factor, is_stated, required, one_of, tasks, &
                           unused_without, not_allowed, default_note, above, at_least, below, at_most)
    class(reader_t), intent(inout) :: self
    character(*), intent(in) :: group, key, meaning
    real(dp), intent(inout) :: value
    type(error_t), allocatable, intent(inout) :: error
    character(*), intent(in), optional :: unit, tasks, unused_without, not_allowed, default_note
    logical, intent(out), optional :: is_stated
    logical, intent(in), optional :: required, one_of
    real(dp), intent(in), optional :: factor, above, at_least, below, at_most
    type(key_t) :: wanted
    real(dp), allocatable :: numbers(:)
    real(dp) :: scale
    integer :: at

    if (present(is_stated)) is_stated = .false.
    if (self%is_skipped(group, key, required)) return
    call declare(wanted, group, key, meaning, kind_number, unit, tasks, default_note, required, one_of)
    call bound_real(wanted%bounds, wanted%unit, above, at_least, below, at_most)
    call self%find(wanted, at, error, is_stated, unused_without, not_allowed)
    scale = in_si(wanted%unit)
    if (present(factor)) scale = scale*factor
    if (.not. present(is_stated)) call self%set_default([value], wanted%bounds, scale)
    if (at == 0) return
    call check_size(self%list%entries(at), 'number', error)
    call read_numbers(self%list%entries(at), wanted%bounds, numbers, error, scale)
    if (allocated(error)) return
    value = numbers(1)
    call self%check_magnitude(numbers/scale)
  end subroutine get_real

  !> Reads a list of numbers; the bounds are those of each number, `min_size` and `max_size` of their count. `distinct`: no
  !> duplicates.
  pure subroutine get_reals(self, group, key, value, error, meaning, unit, is_stated, required, one_of, tasks, unused_without, &
                            not_allowed, default_note, above, at_least, below, at_most, min_size, max_size, distinct)
    class(reader_t), intent(inout) :: self
    character(*), intent(in) :: group, key, meaning
    real(dp), allocatable, intent(inout) :: value(:)
    type(error_t), allocatable, intent(inout) :: error
    character(*), intent(in), optional :: unit, tasks, unused_without, not_allowed, default_note
    logical, intent(out), optional :: is_stated
    logical, intent(in), optional :: required, one_of, distinct
    real(dp), intent(in), optional :: above, at_least, below, at_most
    integer, intent(in), optional :: min_size, max_size
    type(key_t) :: wanted
    real(dp), allocatable :: numbers(:)
    real(dp) :: scale
    integer :: at

    if (present(is_stated)) is_stated = .false.
    if (self%is_skipped(group, key, required)) return
    call declare(wanted, group, key, meaning, kind_number, unit, tasks, default_note, required, one_of)
    call bound_real(wanted%bounds, wanted%unit, above, at_least, below, at_most)
    call wanted%allow_list(min_size, max_size)
    call self%find(wanted, at, error, is_stated, unused_without, not_allowed)
    scale = in_si(wanted%unit)
    if (allocated(value) .and. .not. present(is_stated)) call self%set_default(value, wanted%bounds, scale)
    if (at == 0) return
    call check_sizes(self%list%entries(at), 'numbers', error, min_size, max_size)
    call read_numbers(self%list%entries(at), wanted%bounds, numbers, error, scale)
    if (present(distinct)) call check_distinct(self%list%entries(at), numbers, error)
    if (allocated(error)) return
    call move_alloc(numbers, value)
    call self%check_magnitude(value/scale)
  end subroutine get_reals

  pure subroutine get_integer(self, group, key, value, error, meaning, is_stated, required, one_of, tasks, unused_without, &
                              not_allowed, default_note, at_least, at_most)
    class(reader_t), intent(inout) :: self
    character(*), intent(in) :: group, key, meaning
    integer, intent(inout) :: value
    type(error_t), allocatable, intent(inout) :: error
    character(*), intent(in), optional :: tasks, unused_without, not_allowed, default_note
    logical, intent(out), optional :: is_stated
    logical, intent(in), optional :: required, one_of
    integer, intent(in), optional :: at_least, at_most
    type(key_t) :: wanted
    real(dp), allocatable :: numbers(:)
    integer :: at

    if (present(is_stated)) is_stated = .false.
    if (self%is_skipped(group, key, required)) return
    call declare(wanted, group, key, meaning, kind_integer, '', tasks, default_note, required, one_of)
    call bound_integer(wanted%bounds, at_least, at_most)
    call self%find(wanted, at, error, is_stated, unused_without, not_allowed)
    if (.not. present(is_stated)) call self%set_default([real(value, dp)], wanted%bounds, 1.0_dp)
    if (at == 0) return
    call check_size(self%list%entries(at), 'integer', error)
    call read_numbers(self%list%entries(at), wanted%bounds, numbers, error)
    if (.not. allocated(error)) value = nint(numbers(1))
  end subroutine get_integer

  !> Reads a logical: `.true.`, `true`, `T` and the same for false.
  pure subroutine get_logical(self, group, key, value, error, meaning, is_stated, required, one_of, tasks, unused_without, &
                              not_allowed, default_note)
    class(reader_t), intent(inout) :: self
    character(*), intent(in) :: group, key, meaning
    logical, intent(inout) :: value
    type(error_t), allocatable, intent(inout) :: error
    character(*), intent(in), optional :: tasks, unused_without, not_allowed, default_note
    logical, intent(out), optional :: is_stated
    logical, intent(in), optional :: required, one_of
    type(key_t) :: wanted
    integer :: at

    if (present(is_stated)) is_stated = .false.
    if (self%is_skipped(group, key, required)) return
    call declare(wanted, group, key, meaning, kind_logical, '', tasks, default_note, required, one_of)
    call self%find(wanted, at, error, is_stated, unused_without, not_allowed)
    if (.not. present(is_stated)) call self%keys%set_default(trim(merge('.true. ', '.false.', value)))
    if (at == 0) return
    call check_size(self%list%entries(at), 'logical', error)
    call read_logical(self%list%entries(at), value, error)
  end subroutine get_logical

  !> Reads one text; with `allowed`, one of these words in any case, returned in lower case.
  pure subroutine get_text(self, group, key, value, error, meaning, is_stated, required, one_of, tasks, unused_without, &
                           not_allowed, default_note, allowed)
    class(reader_t), intent(inout) :: self
    character(*), intent(in) :: group, key, meaning
    character(:), allocatable, intent(inout) :: value
    type(error_t), allocatable, intent(inout) :: error
    character(*), intent(in), optional :: tasks, unused_without, not_allowed, default_note
    logical, intent(out), optional :: is_stated
    logical, intent(in), optional :: required, one_of
    character(*), intent(in), optional :: allowed(:)
    type(key_t) :: wanted
    character(:), allocatable :: texts(:)
    integer :: at

    if (present(is_stated)) is_stated = .false.
    if (self%is_skipped(group, key, required)) return
    call declare(wanted, group, key, meaning, kind_text, '', tasks, default_note, required, one_of)
    if (present(allowed)) wanted%words = allowed
    call self%find(wanted, at, error, is_stated, unused_without, not_allowed)
    if (allocated(value) .and. .not. present(is_stated)) call self%keys%set_default(''''//value//'''')
    if (at == 0) return
    call check_size(self%list%entries(at), 'text', error)
    call read_texts(self%list%entries(at), texts, error, allowed)
    if (.not. allocated(error)) value = texts(1)
    if (present(allowed) .and. .not. allocated(error)) value = trim(value)
  end subroutine get_text

  !> Reads a list of texts, padded with blanks to the longest.
  pure subroutine get_texts(self, group, key, value, error, meaning, is_stated, required, one_of, tasks, unused_without, &
                            not_allowed, default_note, allowed, min_size, max_size)
    class(reader_t), intent(inout) :: self
    character(*), intent(in) :: group, key, meaning
    character(:), allocatable, intent(inout) :: value(:)
    type(error_t), allocatable, intent(inout) :: error
    character(*), intent(in), optional :: tasks, unused_without, not_allowed, default_note
    logical, intent(out), optional :: is_stated
    logical, intent(in), optional :: required, one_of
    character(*), intent(in), optional :: allowed(:)
    integer, intent(in), optional :: min_size, max_size
    type(key_t) :: wanted
    integer :: at

    if (present(is_stated)) is_stated = .false.
    if (self%is_skipped(group, key, required)) return
    call declare(wanted, group, key, meaning, kind_text, '', tasks, default_note, required, one_of)
    if (present(allowed)) wanted%words = allowed
    call wanted%allow_list(min_size, max_size)
    call self%find(wanted, at, error, is_stated, unused_without, not_allowed)
    if (allocated(value) .and. .not. present(is_stated)) call self%keys%set_default(''''//join(value, ''', ''')//'''')
    if (at == 0) return
    call check_sizes(self%list%entries(at), 'texts', error, min_size, max_size)
    call read_texts(self%list%entries(at), value, error, allowed)
  end subroutine get_texts

  !> Sets default numbers of the key declared last, written in its unit so that they read back to the same bits. A default out of
  !> bounds counts as none.
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
      call shortest_digits(values(i), scale, words(i), number, found)
      if (.not. found .or. .not. bounds%allow(number)) return
    end do
    call self%keys%set_default(join(words, ', '))
  end subroutine set_default

  !> Adds a group to the format, with its subject.
  pure subroutine add_group(self, name, meaning)
    class(reader_t), intent(inout) :: self
    character(*), intent(in) :: name, meaning

    call self%keys%add_group(name, meaning)
  end subroutine add_group

  !> Requests tasks: keys declared later for other tasks are not used.
  pure subroutine request(self, tasks)
    class(reader_t), intent(inout) :: self
    character(*), intent(in) :: tasks(:)

    self%tasks = ' '//join(tasks, ' ')//' '
  end subroutine request

  !> True if this task is requested.
  pure logical function requests(self, task)
    class(reader_t), intent(in) :: self
    character(*), intent(in) :: task

    requests = index(self%tasks, ' '//trim(task)//' ') > 0
  end function requests

  !> True if the text has the key with a value.
  pure logical function has(self, group, key)
    class(reader_t), intent(in) :: self
    character(*), intent(in) :: group, key

    has = self%list%position(lower(group), lower(key)) > 0
  end function has

  !> True if the text has the key with a value, and the key is declared.
  pure logical function has_used(self, group, key)
    class(reader_t), intent(in) :: self
    character(*), intent(in) :: group, key
    integer :: at

    at = self%list%position(lower(group), lower(key))
    has_used = at > 0
    if (has_used) has_used = self%list%entries(at)%used
  end function has_used

  !> True if the text has the group, even an empty one.
  pure logical function has_group(self, group)
    class(reader_t), intent(in) :: self
    character(*), intent(in) :: group

    has_group = .false.
    if (allocated(self%list%groups)) has_group = any(self%list%groups == lower(group))
  end function has_group

  !> Fails if the text has an undeclared group or key, or lacks a required key.
  pure subroutine finish(self, error)
    class(reader_t), intent(in) :: self
    type(error_t), allocatable, intent(inout) :: error
    character(:), allocatable :: others, why
    integer :: i

    if (allocated(error)) return
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
    if (.not. allocated(self%missing)) return
    call self%keys%list_missing(others)
    others = self%missing_too//others
    if (len(others) > 0) call fail(error, self%missing%code, self%missing%message//'; missing too: '//others(3:))
    call fail(error, self%missing%code, self%missing%message)
  end subroutine finish

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
    if (group == 'torque') why = ' (its keys are load_rpm, motion_harmonics and load_torque of &sweep)'
    if (closest > 0) why = ' (did you mean &'//trim(names(closest))//'?)'
    call fail(error, code_input, '&'//group//': unknown group'//why//'; the groups are '//join(names, ', '))
  end subroutine check_group

  !> Fails unless the format has this key, i.e. it is declared; the text need not have it.
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

  !> Writes the values in effect as a case: those of the text and the other keys' defaults.
  pure subroutine write_complete(self, text)
    class(reader_t), intent(in) :: self
    character(:), allocatable, intent(out) :: text

    call self%keys%write_case(self%list, text)
  end subroutine write_complete

  !> True if nothing is to do for this key. Names in lower case.
  pure logical function is_skipped(self, group, key, required)
    class(reader_t), intent(in) :: self
    character(*), intent(in) :: group, key
    logical, intent(in), optional :: required

    is_skipped = self%is_brief
    if (is_skipped .and. present(required)) is_skipped = .not. required
    if (is_skipped) is_skipped = self%list%position(group, key) == 0
  end function is_skipped

  !> Adds the key to the format; `at` is its entry, or 0 if there is nothing to read.
  pure subroutine find(self, key, at, error, is_stated, unused_without, not_allowed)
    class(reader_t), intent(inout) :: self
    type(key_t), intent(inout) :: key
    integer, intent(out) :: at
    type(error_t), allocatable, intent(inout) :: error
    logical, intent(out), optional :: is_stated
    character(*), intent(in), optional :: unused_without, not_allowed
    logical :: is_allowed

    at = 0
    if (present(unused_without)) key%unused_without = trim(unused_without)
    if (present(not_allowed)) key%not_allowed = trim(not_allowed)
    if (len(key%unused_without) == 0 .and. .not. key%is_for(self%tasks)) key%unused_without = key%tasks
    is_allowed = len(key%not_allowed) == 0
    if (.not. allocated(error)) then
      at = self%list%position(key%group, key%name)
      if (at > 0 .and. .not. is_allowed) call fail_entry(self%list%entries(at), key%not_allowed, error)
      if (.not. is_allowed) at = 0
    end if
    key%entry = at
    call self%keys%add(key)
    if (at > 0) self%list%entries(at)%used = .true.
    if (present(is_stated)) is_stated = at > 0
    if (key%is_required .and. at == 0 .and. is_allowed .and. len(key%unused_without) == 0) call self%add_missing(key)
  end subroutine find

  !> Stores a warning if the numbers of the key declared last are used and are unusual in its unit.
  pure subroutine check_magnitude(self, numbers)
    class(reader_t), intent(inout) :: self
    real(dp), intent(in) :: numbers(:)
    character(:), allocatable :: words

    associate (key => self%keys%key(self%keys%last))
      if (len(key%unused_without) > 0) return
      call find_slip(trim(key%name), key%unit, numbers, words)
      if (len(words) > 0) key%caution = words
    end associate
  end subroutine check_magnitude

  pure subroutine add_missing(self, key)
    class(reader_t), intent(inout) :: self
    type(key_t), intent(in) :: key
    ! A bound that only limits the range of computation does not help a user who looks for a value.
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
    if (allocated(self%missing)) then
      ! A key that two tasks require is reported once.
      if (index(self%missing%message, '&'//trim(key%group)//' '//trim(key%name)//':') == 1) return
      if (index(self%missing_too//',', '&'//trim(key%group)//' '//trim(key%name)//',') > 0) return
      self%missing_too = self%missing_too//', &'//trim(key%group)//' '//trim(key%name)
    end if
    call fail(self%missing, code_input, '&'//trim(key%group)//' '//trim(key%name)//': missing; must be '//rule// &
              ' ('//key%meaning//')')
  end subroutine add_missing

  !> Returns the words unless the condition holds.
  pure function text_unless(holds, words) result(what)
    logical, intent(in) :: holds
    character(*), intent(in) :: words
    character(sentence_length) :: what

    what = ''
    if (.not. holds) what = words
  end function text_unless

  pure function first_nonblank(one, other) result(words)
    character(*), intent(in) :: one, other
    character(sentence_length) :: words

    words = one
    if (len_trim(one) == 0) words = other
  end function first_nonblank

  !> True if the mesh is prescribed, without gears.
  pure logical function is_prescribed(reader)
    type(reader_t), intent(in) :: reader

    is_prescribed = reader%has('mesh', 'contact_ratio')
  end function is_prescribed
end module gearsweep_study_reader_reader
