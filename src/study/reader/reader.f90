!> Reads typed values from namelist text, each with its unit, its bounds and one clear error.
!>
!> A caller writes one `get` for each key of the format, then `finish`, and checks `error` once. The `get` is the only declaration
!> of the key: its meaning, unit, allowed values and the tasks that use it. Its variable holds the default before, in SI units, and
!> the value of the text afterwards. A key that can have no effect is declared with `refused`, the reason: it is then not allowed in
!> the text. A key without effect in this case, as no task in `tasks` is requested or for the reason in `lacks`, is read and listed
!> as not used.
module gearsweep_study_reader_reader
  use gearsweep_base, only: dp, error_t, in_si, join
  use gearsweep_study_reader_format, only: format_t
  use gearsweep_study_reader_keys, only: bound_integer, bound_real, bounds_t, declare, key_t, kind_integer, kind_logical, &
    kind_number, kind_text
  use gearsweep_study_reader_namelist, only: namelist_t, parse_namelist
  use gearsweep_study_reader_values, only: check_distinct, check_size, check_sizes, read_logical, read_numbers, read_texts, &
    tell_number
  implicit none
  private
  public :: reader_t, open_list, open_reader

  !> Format whose keys are read as they are declared.
  type, extends(format_t) :: reader_t
  contains
    !> `call reader%get(group, key, value, error, meaning, [unit], [given], [required], [tasks], [lacks], [refused], ...)`
    generic :: get => get_real, get_reals, get_integer, get_logical, get_text, get_texts
    procedure, private :: get_real, get_reals, get_integer, get_logical, get_text, get_texts
    procedure, private :: set_default
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
    if (allocated(error)) return
    value = numbers(1)
    call self%judge(numbers/scale)
  end subroutine get_real

  !> Reads a list of numbers; the bounds are those of each number, `min_size` and `max_size` of their count. `distinct`: no
  !> duplicates.
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
    if (allocated(error)) return
    call move_alloc(numbers, value)
    call self%judge(value/scale)
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

  !> Reads a logical: `.true.`, `true`, `T` and the same for false.
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

  !> Reads one text; with `allowed`, one of these words in any case, returned in lower case.
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

  !> Reads a list of texts, padded with blanks to the longest.
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
      call tell_number(values(i), scale, words(i), number, found)
      if (.not. found .or. .not. bounds%allow(number)) return
    end do
    call self%keys%set_default(join(words, ', '))
  end subroutine set_default
end module gearsweep_study_reader_reader
