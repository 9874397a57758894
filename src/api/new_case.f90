!> Template of a case: every key of the requested tasks, with its default and its meaning.
module gearsweep_api_new_case
  use gearsweep_base, only: closest_word, code_input, error_t, fail, join, lines_t, shown
  use gearsweep_study, only: key_t, keys_t, task_length
  use gearsweep_api_case_reader, only: list_keys
  use gearsweep_api_tasks, only: find_former_task, list_task_names
  implicit none
  private
  public :: write_new_case

contains

  !> Writes the text for these tasks. It runs once the keys marked REQUIRED have a value. Keys that are only used with another value
  !> of a key are commented out by `!`, with that condition. With `--short` among the tasks the text has only the required and the
  !> common keys.
  subroutine write_new_case(words, text, error)
    character(*), intent(in) :: words(:)
    character(:), allocatable, intent(out) :: text
    type(error_t), allocatable, intent(inout) :: error
    character(*), parameter :: option = '--short'
    character(len(words)), allocatable :: tasks(:)
    type(keys_t) :: keys
    type(lines_t) :: lines
    character(:), allocatable :: wanted, now
    logical :: opened, is_short
    integer :: i, k, closest
    character(task_length), allocatable :: names(:)

    is_short = any(words == option)
    tasks = pack(words, words /= option)
    call list_task_names(names)
    if (size(tasks) == 0) call fail(error, code_input, 'name at least one task; the tasks are '//join(names, ', '))
    do i = 1, size(tasks)
      if (any(names == tasks(i))) cycle
      call find_former_task(trim(tasks(i)), now)
      if (len(now) > 0) call fail(error, code_input, trim(tasks(i))//' is '//now)
      closest = closest_word(trim(tasks(i)), names)
      if (closest > 0) call fail(error, code_input, shown(trim(tasks(i)))//': no such task (did you mean '// &
                                 trim(names(closest))//'?)')
      call fail(error, code_input, shown(trim(tasks(i)))//': no such task; the tasks are '//join(names, ', '))
    end do
    if (allocated(error)) return
    call list_keys(tasks, keys)
    wanted = ' '//join(tasks, ' ')//' '
    call lines%add('! A case for gearsweep. Each key has its default and its meaning beside it; keys marked REQUIRED have no')
    call lines%add('! default. What stands behind a ! is not read: remove the ! to use it. gearsweep --help KEY has more.')
    if (is_short) call lines%add('! Without --short there is every key of these tasks.')
    do i = 1, size(keys%groups)
      opened = .false.
      do k = 1, keys%known
        if (keys%key(k)%group /= keys%groups(i)%name .or. .not. keys%key(k)%is_for(wanted)) cycle
        if (is_short .and. .not. is_common(keys%key(k))) cycle
        if (.not. opened) call lines%add('')
        if (.not. opened) call lines%add('&'//trim(keys%groups(i)%name)//'   ! '//keys%groups(i)%meaning)
        opened = .true.
        call add_key(keys%key(k), tasks, lines)
      end do
      if (opened) call lines%add('/')
    end do
    text = lines%text()
  end subroutine write_new_case

  !> True for a key that most cases state.
  pure logical function is_common(key)
    type(key_t), intent(in) :: key
    character(*), parameter :: common(*) = [character(24) :: 'case title', 'case tasks', 'pinion profile_shift', &
      'gear profile_shift', 'pinion bore_mm', 'gear bore_mm', 'relief amount_um', 'dynamics damping_ratio', 'rating material', &
      'rating accuracy_grade', 'rating face_load_factor', 'load application_factor', 'face misalignment_um', &
      'pinion crowning_um', 'gear crowning_um']

    is_common = any(common == trim(key%group)//' '//key%name)
    if (len(key%not_allowed) == 0) is_common = is_common .or. key%is_required .or. key%is_one_of
  end function is_common

  subroutine add_key(key, tasks, lines)
    type(key_t), intent(in) :: key
    character(*), intent(in) :: tasks(:)
    type(lines_t), intent(inout) :: lines
    character(:), allocatable :: line, remark, allowed, why
    integer, parameter :: beside = 34, wide = 86
    integer :: at

    why = key%not_allowed
    if (len(why) == 0) why = key%unused_without
    line = '  '
    if (len(why) > 0) line = '  ! '
    line = line//trim(key%name)//' ='
    if (key%name == 'tasks') then
      line = line//' '''//join(tasks, ''', ''')//''''
    else if (allocated(key%default) .and. len(key%default_note) == 0 .and. .not. key%is_required) then
      line = line//' '//key%default
    end if
    call key%list_allowed(allowed)
    remark = ''
    if (key%is_required .and. len(why) == 0) remark = 'REQUIRED. '
    if (key%is_one_of) remark = 'REQUIRED: one of these. '
    remark = remark//key%meaning//' ('
    if (len(key%unit) > 0) remark = remark//key%unit//', '
    remark = remark//allowed
    if (len(key%default_note) > 0) remark = remark//'; default: '//key%default_note
    if (len(key%not_allowed) > 0) remark = remark//'; '//why
    if (len(key%not_allowed) == 0 .and. len(key%unused_without) > 0) remark = remark//'; for '//why
    remark = remark//')'
    ! The comment continues on the next lines.
    call lines%put(line//repeat(' ', max(0, beside - len(line))))
    do while (len(remark) > wide)
      at = index(remark(:wide), ' ', back=.true.)
      call lines%add(' ! '//remark(:at - 1))
      call lines%put(repeat(' ', beside))
      remark = '  '//remark(at + 1:)
    end do
    call lines%add(' ! '//remark)
  end subroutine add_key
end module gearsweep_api_new_case
