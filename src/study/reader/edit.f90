!> Changes one key in the text of a case; all other text, comments included, remains unchanged.
module gearsweep_study_reader_edit
  use gearsweep_base, only: code_input, error_t, fail, find_control, lower, shown
  use gearsweep_study_reader_namelist, only: namelist_t, parse_namelist
  implicit none
  private
  public :: change_key, change_keys

  character, parameter :: lf = new_line('a')
  character(*), parameter :: blanks = ' '//achar(9)

contains

  !> Changes a key to `value`, the text after the `=`; an empty value removes the key. A missing key is added, and its group if that
  !> is missing too. Only the form is checked.
  pure subroutine change_key(text, group, key, value, changed, error)
    character(*), intent(in) :: text, group, key, value
    character(:), allocatable, intent(out) :: changed
    type(error_t), allocatable, intent(out) :: error
    type(namelist_t) :: list
    integer :: i

    call check_value(group, key, value, error)
    if (allocated(error)) return
    if (len_trim(text) > 0) then
      call parse_namelist(text, list, error)
      if (allocated(error)) return
    else
      allocate (list%groups(0), list%entries(0))
    end if
    do i = 1, size(list%entries)
      if (list%entries(i)%group /= lower(group) .or. list%entries(i)%key /= lower(key)) cycle
      associate (entry => list%entries(i))
        if (len(value) > 0) then
          changed = text(:entry%first - 1)//value//text(entry%last + 1:)
        else
          changed = text(:entry%at - 1)//text(behind_comma(text, entry%last + 1):)
        end if
      end associate
      return
    end do
    if (len(value) == 0) then
      changed = text
    else if (any(list%groups == lower(group))) then
      call insert_key(text, list%ends(findloc(list%groups == lower(group), .true., 1)), key//' = '//value, changed)
    else
      changed = trim(text)
      if (len(changed) > 0) then
        if (changed(len(changed):) /= lf) changed = changed//lf
      end if
      changed = changed//'&'//group//' '//key//' = '//value//' /'//lf
    end if
  end subroutine change_key

  !> Changes all keys of the text `changes`; `keys` lists them.
  pure subroutine change_keys(text, changes, changed, keys, error)
    character(*), intent(in) :: text, changes
    character(:), allocatable, intent(out) :: changed
    type(namelist_t), intent(out) :: keys
    type(error_t), allocatable, intent(inout) :: error
    character(:), allocatable :: next
    integer :: i

    call parse_namelist(changes, keys, error)
    if (allocated(error)) return
    changed = text
    do i = 1, size(keys%entries)
      associate (entry => keys%entries(i))
        call change_key(changed, entry%group, entry%key, changes(entry%first:entry%last), next, error)
      end associate
      if (allocated(error)) return
      call move_alloc(next, changed)
    end do
  end subroutine change_keys

  !> Refuses group, key and value unless they make exactly one assignment.
  pure subroutine check_value(group, key, value, error)
    character(*), intent(in) :: group, key, value
    type(error_t), allocatable, intent(inout) :: error
    type(namelist_t) :: list
    type(error_t), allocatable :: wrong
    character(:), allocatable :: control
    integer :: line
    logical :: fits

    call find_control(value, line, control)
    if (line > 0) then
      call fail(error, code_input, '&'//shown(group)//' '//shown(key)//' = '//shown(value)//': must not have '//control)
      return
    end if
    call parse_namelist('&'//group//' '//key//' = '//value//' /', list, wrong)
    fits = .not. allocated(wrong)
    if (fits) fits = size(list%groups) == 1 .and. size(list%entries) == min(1, len(value))
    if (fits) fits = list%groups(1) == lower(group)
    if (fits .and. len(value) > 0) fits = list%entries(1)%key == lower(key)
    if (.not. fits) call fail(error, code_input, '&'//shown(group)//' '//shown(key)//' = '//shown(value)// &
                              ': expected a group, a key and a value')
  end subroutine check_value

  !> Position after the comma that separates a key from the next one, if there is one.
  pure integer function behind_comma(text, from) result(at)
    character(*), intent(in) :: text
    integer, intent(in) :: from
    integer :: k

    at = from
    k = verify(text(from:), blanks)
    if (k == 0) return
    if (text(from + k - 1:from + k - 1) == ',') at = from + k
  end function behind_comma

  !> Inserts an assignment before the group's end at `last`, on a line of its own if the end has one.
  pure subroutine insert_key(text, last, assignment, changed)
    character(*), intent(in) :: text, assignment
    integer, intent(in) :: last
    character(:), allocatable, intent(out) :: changed
    integer :: line

    line = index(text(:last), lf, back=.true.) + 1
    if (line > 1 .and. verify(text(line:last - 1), blanks) == 0) then
      changed = text(:line - 1)//'  '//assignment//lf//text(line:)
    else
      changed = text(:last - 1)
      if (scan(text(last - 1:last - 1), blanks) == 0) changed = changed//' '
      changed = changed//assignment//' '//text(last:)
    end if
  end subroutine insert_key
end module gearsweep_study_reader_edit
