!> What a key of a format is: its declaration, which the reader, its errors, the help, the reference and new cases share.
module gearsweep_key
  use gearsweep_bounds, only: bounds_t
  use gearsweep_namelist, only: name_length
  use gearsweep_text, only: join, lower, str
  implicit none
  private
  public :: key_t, declare

  !> What a key's values are.
  integer, parameter, public :: kind_number = 1, kind_integer = 2, kind_logical = 3, kind_text = 4

  !> Of the words that a text may be.
  integer, parameter, public :: word_length = 20

  type :: key_t
    character(name_length) :: group = '', name = ''
    character(:), allocatable :: meaning         !< one sentence
    character(:), allocatable :: unit            !< empty for none
    character(:), allocatable :: tasks           !< that use it, as in `load, sweep or optimum`; empty: all
    integer :: kind = kind_number
    type(bounds_t) :: bounds                     !< in the key's unit
    character(word_length), allocatable :: words(:)  !< that a text may be; not allocated: any text
    logical :: is_list = .false.
    integer :: fewest = 0, most = 0              !< values of a list; 0: any number
    logical :: is_required = .false.             !< where it is used
    logical :: is_one_of = .false.               !< exactly one of the group's keys that are so marked must be given
    !> The value of a case that does not give it, as a case has it; not allocated where there is none.
    character(:), allocatable :: default
    character(:), allocatable :: otherwise       !< what holds instead of a default; may be empty
    ! In the case at hand:
    integer :: entry = 0                         !< where it is given, its entry in the namelist
    character(:), allocatable :: lacks           !< what would use it; empty where something does
    character(:), allocatable :: refused         !< why it must not be given; empty where it may
  contains
    procedure :: allow_list, list_allowed, is_for
  end type key_t

contains

  !> A key without bounds, words and a default.
  pure subroutine declare(key, group, name, meaning, kind, unit, tasks, otherwise, required, one_of)
    type(key_t), intent(out) :: key
    character(*), intent(in) :: group, name, meaning
    integer, intent(in) :: kind
    character(*), intent(in), optional :: unit, tasks, otherwise
    logical, intent(in), optional :: required, one_of

    key%group = lower(group)
    key%name = lower(name)
    key%meaning = meaning
    key%kind = kind
    key%unit = ''
    key%tasks = ''
    key%otherwise = ''
    if (present(unit)) key%unit = unit
    if (present(tasks)) key%tasks = trim(tasks)
    if (present(otherwise)) key%otherwise = otherwise
    if (present(required)) key%is_required = required
    if (present(one_of)) key%is_one_of = one_of
    key%lacks = ''
    key%refused = ''
  end subroutine declare

  !> Several values may be given, at least and at most so many.
  pure subroutine allow_list(self, fewest, most)
    class(key_t), intent(inout) :: self
    integer, intent(in), optional :: fewest, most

    self%is_list = .true.
    if (present(fewest)) self%fewest = fewest
    if (present(most)) self%most = most
  end subroutine allow_list

  !> What may be given, as in `0 to 1` or `list of up to 20 numbers, above 0 each`.
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

  !> Do these tasks use it? They stand with a blank in front of and behind each.
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
end module gearsweep_key
