!> What a text gives and what a format asks for: its groups and keys, which of them are used, unknown or missing.
!> gearsweep_reader asks for the keys and reads their values.
module gearsweep_format
  use gearsweep_error, only: code_input, error_t, fail
  use gearsweep_kinds, only: dp
  use gearsweep_key, only: key_t, kind_logical, kind_text
  use gearsweep_keys, only: keys_t
  use gearsweep_namelist, only: name_length, namelist_t
  use gearsweep_text, only: closest_word, join, lower
  use gearsweep_values, only: describe_texts, fail_entry
  implicit none
  private
  public :: format_t

  type :: format_t
    type(namelist_t) :: list
    type(keys_t) :: keys
    logical :: keeps_defaults = .false.
    logical :: is_brief = .false.                !< keys that are not given, and need not be, are not kept
    character(:), allocatable :: tasks           !< those that are wanted, a blank in front of and behind each
    !> The first key found missing; told last, as a misspelt key is missing too.
    type(error_t), allocatable :: missing
    character(:), allocatable :: missing_too     !< the others, a comma and a blank in front of each
  contains
    procedure :: add_group, want, wants, has, has_used, has_group, finish, check_key, write_complete, passes, find
    procedure, private :: miss, check_names, check_group
  end type format_t

contains

  !> A group of the format and what it is about.
  pure subroutine add_group(self, name, meaning)
    class(format_t), intent(inout) :: self
    character(*), intent(in) :: name, meaning

    call self%keys%add_group(name, meaning)
  end subroutine add_group

  !> From now on, keys for other tasks are not used.
  pure subroutine want(self, tasks)
    class(format_t), intent(inout) :: self
    character(*), intent(in) :: tasks(:)

    self%tasks = ' '//join(tasks, ' ')//' '
  end subroutine want

  !> Is this task wanted?
  pure logical function wants(self, task)
    class(format_t), intent(in) :: self
    character(*), intent(in) :: task

    wants = index(self%tasks, ' '//trim(task)//' ') > 0
  end function wants

  !> The key is given, with a value.
  pure logical function has(self, group, key)
    class(format_t), intent(in) :: self
    character(*), intent(in) :: group, key

    has = self%list%position(lower(group), lower(key)) > 0
  end function has

  !> The key is given, with a value, and has been asked for.
  pure logical function has_used(self, group, key)
    class(format_t), intent(in) :: self
    character(*), intent(in) :: group, key
    integer :: at

    at = self%list%position(lower(group), lower(key))
    has_used = at > 0
    if (has_used) has_used = self%list%entries(at)%used
  end function has_used

  !> The group is there, be it empty.
  pure logical function has_group(self, group)
    class(format_t), intent(in) :: self
    character(*), intent(in) :: group

    has_group = .false.
    if (allocated(self%list%groups)) has_group = any(self%list%groups == lower(group))
  end function has_group

  !> Fails if the text has a group or a key that nobody asked for, or lacks a required key.
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
    if (closest > 0) why = ' (did you mean &'//trim(names(closest))//'?)'
    call fail(error, code_input, '&'//group//': unknown group'//why//'; the groups are '//join(names, ', '))
  end subroutine check_group

  !> Fails unless the format has this key: one that has been asked for, whether it is given or not.
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

  !> The values in effect as a case: what is given, and the defaults of the rest.
  pure subroutine write_complete(self, text)
    class(format_t), intent(in) :: self
    character(:), allocatable, intent(out) :: text

    call self%keys%write_case(self%list, text)
  end subroutine write_complete

  !> Is there nothing to do for this key? Names in lower case.
  pure logical function passes(self, group, key, required)
    class(format_t), intent(in) :: self
    character(*), intent(in) :: group, key
    logical, intent(in), optional :: required

    passes = self%is_brief
    if (passes .and. present(required)) passes = .not. required
    if (passes) passes = self%list%position(group, key) == 0
  end function passes

  !> Notes that the key belongs to the format; `at` is its entry, or 0 where there is nothing to read.
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

  pure subroutine miss(self, key)
    class(format_t), intent(inout) :: self
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
end module gearsweep_format
