!> Format of a text: its groups and keys, and which of them are used, unknown or missing. gearsweep_study_reader_reader declares the
!> keys and reads their values.
module gearsweep_study_reader_format
  use gearsweep_base, only: closest_word, code_input, dp, error_t, fail, join, lower
  use gearsweep_study_reader_keys, only: key_t, keys_t, kind_logical, kind_text
  use gearsweep_study_reader_namelist, only: name_length, namelist_t
  use gearsweep_study_reader_unit_slips, only: find_slip
  use gearsweep_study_reader_values, only: describe_texts, fail_entry
  implicit none
  private
  public :: format_t

  type :: format_t
    type(namelist_t) :: list
    type(keys_t) :: keys
    logical :: keeps_defaults = .false.
    logical :: is_brief = .false.                !< true: optional keys that the text does not have are not stored
    character(:), allocatable :: tasks           !< requested tasks, with a blank before and after each
    !> Error of the first missing key; reported last, as a misspelt key is missing too.
    type(error_t), allocatable :: missing
    character(:), allocatable :: missing_too     !< other missing keys, with a comma and a blank before each
  contains
    procedure :: add_group, want, wants, has, has_used, has_group, finish, check_key, write_complete, passes, find, judge
    procedure, private :: miss, check_names, check_group
  end type format_t

contains

  !> Adds a group to the format, with its subject.
  pure subroutine add_group(self, name, meaning)
    class(format_t), intent(inout) :: self
    character(*), intent(in) :: name, meaning

    call self%keys%add_group(name, meaning)
  end subroutine add_group

  !> Requests tasks: keys declared later for other tasks are not used.
  pure subroutine want(self, tasks)
    class(format_t), intent(inout) :: self
    character(*), intent(in) :: tasks(:)

    self%tasks = ' '//join(tasks, ' ')//' '
  end subroutine want

  !> True if this task is requested.
  pure logical function wants(self, task)
    class(format_t), intent(in) :: self
    character(*), intent(in) :: task

    wants = index(self%tasks, ' '//trim(task)//' ') > 0
  end function wants

  !> True if the text has the key with a value.
  pure logical function has(self, group, key)
    class(format_t), intent(in) :: self
    character(*), intent(in) :: group, key

    has = self%list%position(lower(group), lower(key)) > 0
  end function has

  !> True if the text has the key with a value, and the key is declared.
  pure logical function has_used(self, group, key)
    class(format_t), intent(in) :: self
    character(*), intent(in) :: group, key
    integer :: at

    at = self%list%position(lower(group), lower(key))
    has_used = at > 0
    if (has_used) has_used = self%list%entries(at)%used
  end function has_used

  !> True if the text has the group, even an empty one.
  pure logical function has_group(self, group)
    class(format_t), intent(in) :: self
    character(*), intent(in) :: group

    has_group = .false.
    if (allocated(self%list%groups)) has_group = any(self%list%groups == lower(group))
  end function has_group

  !> Fails if the text has an undeclared group or key, or lacks a required key.
  pure subroutine finish(self, error)
    class(format_t), intent(in) :: self
    type(error_t), allocatable, intent(inout) :: error
    character(:), allocatable :: others

    if (allocated(error)) return
    call self%check_names(error)
    if (.not. allocated(self%missing)) return
    call self%keys%find_lacking(others)
    others = self%missing_too//others
    if (len(others) > 0) call fail(error, self%missing%code, self%missing%message//'; missing too: '//others(3:))
    call fail(error, self%missing%code, self%missing%message)
  end subroutine finish

  pure subroutine check_names(self, error)
    class(format_t), intent(in) :: self
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
    class(format_t), intent(in) :: self
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
    class(format_t), intent(in) :: self
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
    class(format_t), intent(in) :: self
    character(:), allocatable, intent(out) :: text

    call self%keys%write_case(self%list, text)
  end subroutine write_complete

  !> True if nothing is to do for this key. Names in lower case.
  pure logical function passes(self, group, key, required)
    class(format_t), intent(in) :: self
    character(*), intent(in) :: group, key
    logical, intent(in), optional :: required

    passes = self%is_brief
    if (passes .and. present(required)) passes = .not. required
    if (passes) passes = self%list%position(group, key) == 0
  end function passes

  !> Adds the key to the format; `at` is its entry, or 0 if there is nothing to read.
  pure subroutine find(self, key, at, error, given, lacks, refused)
    class(format_t), intent(inout) :: self
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

  !> Stores a warning if the numbers of the key declared last are used and are unusual in its unit.
  pure subroutine judge(self, numbers)
    class(format_t), intent(inout) :: self
    real(dp), intent(in) :: numbers(:)
    character(:), allocatable :: words

    associate (key => self%keys%key(self%keys%last))
      if (len(key%lacks) > 0) return
      call find_slip(trim(key%name), key%unit, numbers, words)
      if (len(words) > 0) key%caution = words
    end associate
  end subroutine judge

  pure subroutine miss(self, key)
    class(format_t), intent(inout) :: self
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
  end subroutine miss
end module gearsweep_study_reader_format
