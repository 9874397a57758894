!> What a case can say, from the declarations of its keys, as text: the help, and the tables of doc/case.md.
module gearsweep_help
  use gearsweep_case_reader, only: list_keys
  use gearsweep_error, only: code_input, error_t, fail
  use gearsweep_key, only: key_t, kind_logical, kind_text
  use gearsweep_keys, only: keys_t
  use gearsweep_lines, only: lines_t
  use gearsweep_namelist, only: name_length
  use gearsweep_task, only: task_info_t, task_length, task_slot_t
  use gearsweep_tasks, only: list_tasks
  use gearsweep_text, only: closest_word, join, lower, shown
  implicit none
  private
  public :: find_key, help_on, write_key_table

contains

  !> Help on a task, a group, a key, or a key of a group, `words` being its name or `GROUP KEY`. What has no such name is
  !> looked for in the meanings.
  subroutine help_on(words, text, error)
    character(*), intent(in) :: words
    character(:), allocatable, intent(out) :: text
    type(error_t), allocatable, intent(inout) :: error
    type(keys_t) :: keys
    type(task_slot_t), allocatable :: slots(:)
    type(lines_t) :: lines
    type(error_t), allocatable :: unknown
    character(name_length), allocatable :: names(:), groups(:)
    character(:), allocatable :: name
    integer :: i, at

    call list_keys([character(task_length) ::], keys)
    call list_tasks(slots)
    name = lower(trim(adjustl(words)))
    if (index(name, '&') == 1) name = name(2:)
    if (index(name, ' ') > 0) then
      call find_key(keys, name, at, unknown)
      if (.not. allocated(unknown)) call tell_key(keys%key(at), lines)
    else
      do i = 1, size(slots)
        if (slots(i)%info%name == name) call tell_task(slots(i)%info, lines)
      end do
      do i = 1, size(keys%groups)
        if (keys%groups(i)%name == name) call tell_group(keys, i, lines)
      end do
      do i = 1, keys%known
        if (keys%key(i)%name == name) call tell_key(keys%key(i), lines)
      end do
    end if
    if (len(lines%text()) == 0) call tell_matches(keys, slots, name, lines)
    text = lines%text()
    if (len(text) > 0) return
    if (allocated(unknown)) call move_alloc(unknown, error)
    call keys%list_groups(groups)
    names = [groups, [(keys%key(i)%name, i=1, keys%known)]]
    do i = 1, size(slots)
      names = [character(name_length) :: names, slots(i)%info%name]
    end do
    at = closest_word(name, names)
    if (at > 0) call fail(error, code_input, shown(name)//': no such task, group or key (did you mean '//trim(names(at))//'?)')
    call fail(error, code_input, shown(name)//': no such task, group or key; the groups are '//join(groups, ', '))
  end subroutine help_on

  !> The tasks and keys whose names or meanings have these words, in lower case, in them.
  subroutine tell_matches(keys, slots, words, lines)
    type(keys_t), intent(in) :: keys
    type(task_slot_t), intent(in) :: slots(:)
    character(*), intent(in) :: words
    type(lines_t), intent(inout) :: lines
    integer :: i

    do i = 1, size(slots)
      if (.not. has(trim(slots(i)%info%name)//' '//slots(i)%info%gives)) cycle
      call lines%add('task '//trim(slots(i)%info%name))
      call add_wrapped(slots(i)%info%gives//'.', '  ', lines)
    end do
    do i = 1, keys%known
      associate (key => keys%key(i))
        if (.not. has(trim(key%name)//' '//key%meaning)) cycle
        call lines%add('&'//trim(key%group)//' '//trim(key%name))
        call add_wrapped(key%meaning//'.', '  ', lines)
      end associate
    end do

  contains

    !> Does it have these words as a whole? Its underscores may stand for blanks, and those of symbols may be left out (K_Hbeta).
    logical function has(text)
      character(*), intent(in) :: text
      character(len(text)) :: blanks, nothing
      character(len(words)) :: symbol

      call replace_underscores(lower(text), ' ', blanks)
      call replace_underscores(lower(text), '', nothing)
      call replace_underscores(words, '', symbol)
      has = holds(' '//lower(text)//' ', words) .or. holds(' '//blanks//' ', words)
      if (symbol /= words) has = has .or. holds(' '//nothing//' ', trim(symbol))
    end function has

    !> `other` is as long as the text.
    subroutine replace_underscores(text, by, other)
      character(*), intent(in) :: text, by
      character(len(text)), intent(out) :: other
      integer :: at, k

      other = ''
      at = 0
      do k = 1, len(text)
        if (text(k:k) == '_') then
          other(at + 1:at + len(by)) = by
          at = at + len(by)
        else
          at = at + 1
          other(at:at) = text(k:k)
        end if
      end do
    end subroutine replace_underscores

    logical function holds(text, words)
      character(*), intent(in) :: text, words
      character(*), parameter :: letters = 'abcdefghijklmnopqrstuvwxyz_0123456789'
      integer :: at, next

      at = 1
      holds = .false.
      do
        next = index(text(at + 1:), words)
        if (next == 0 .or. holds) exit
        at = at + next
        holds = verify(text(at - 1:at - 1), letters) > 0 .and. verify(text(at + len(words):at + len(words)), letters) > 0
      end do
    end function holds
  end subroutine tell_matches

  !> The place of a key by `GROUP KEY`.
  subroutine find_key(keys, words, at, error)
    type(keys_t), intent(in) :: keys
    character(*), intent(in) :: words
    integer, intent(out) :: at
    type(error_t), allocatable, intent(inout) :: error
    character(name_length), allocatable :: names(:)
    character(:), allocatable :: why
    character(name_length) :: group, name
    integer :: gap, closest

    gap = index(words, ' ')
    group = lower(words(:gap - 1))
    name = lower(adjustl(words(gap:)))
    do at = keys%known, 1, -1
      if (keys%key(at)%group == group .and. keys%key(at)%name == name) return
    end do
    call keys%list_groups(names)
    if (any(names == group)) then
      call keys%why_unknown(trim(group), trim(name), why)
      call fail(error, code_input, '&'//trim(group)//' '//trim(name)//': '//why)
      return
    end if
    closest = closest_word(trim(group), names)
    why = ''
    if (closest > 0) why = ' (did you mean &'//trim(names(closest))//'?)'
    call fail(error, code_input, '&'//trim(group)//': unknown group'//why//'; the groups are '//join(names, ', '))
  end subroutine find_key

  subroutine tell_task(task, lines)
    type(task_info_t), intent(in) :: task
    type(lines_t), intent(inout) :: lines

    call lines%add('task '//trim(task%name))
    call add_wrapped(task%gives//'.', '  ', lines)
    call lines%add('  tables    '//trim(task%tables//' '//task%fields))
    call lines%add('')
  end subroutine tell_task

  !> The group and its keys, a line each.
  subroutine tell_group(keys, at, lines)
    type(keys_t), intent(in) :: keys
    integer, intent(in) :: at
    type(lines_t), intent(inout) :: lines
    character(:), allocatable :: allowed
    character(26) :: name
    integer :: i

    call lines%add('group &'//trim(keys%groups(at)%name))
    call add_wrapped(keys%groups(at)%meaning, '  ', lines)
    do i = 1, keys%known
      if (keys%key(i)%group /= keys%groups(at)%name) cycle
      call keys%key(i)%list_allowed(allowed)
      name = keys%key(i)%name
      call lines%add('  '//name//' '//trim(default_of(keys%key(i)))//trim(' '//keys%key(i)%unit)//' ('//allowed//')')
    end do
    call lines%add('')
  end subroutine tell_group

  subroutine tell_key(key, lines)
    type(key_t), intent(in) :: key
    type(lines_t), intent(inout) :: lines
    character(:), allocatable :: allowed

    call key%list_allowed(allowed)
    call lines%add('&'//trim(key%group)//' '//trim(key%name))
    call add_wrapped(key%meaning//'.', '  ', lines)
    if (len(key%unit) > 0) call lines%add('  unit      '//key%unit)
    call lines%add('  default   '//trim(default_of(key)))
    call lines%add('  allowed   '//allowed)
    if (len(key%tasks) > 0) call lines%add('  for       '//key%tasks)
    call lines%add('')
  end subroutine tell_key

  !> In words.
  function default_of(key) result(words)
    type(key_t), intent(in) :: key
    character(100) :: words

    words = 'none'
    if (allocated(key%default)) words = key%default
    if (len(key%otherwise) > 0) words = key%otherwise
    if (key%is_one_of) words = 'exactly one of the group''s keys must be given'
    if (key%is_required .and. len(key%otherwise) == 0) words = 'required'
    if (words == '''''') words = 'empty'
  end function default_of

  !> A sentence on as many lines as it needs, its first letter made large.
  subroutine add_wrapped(words, indent, lines)
    character(*), intent(in) :: words, indent
    type(lines_t), intent(inout) :: lines
    integer, parameter :: wide = 90
    character(:), allocatable :: rest
    integer :: at

    rest = words
    if (rest(1:1) >= 'a' .and. rest(1:1) <= 'z') rest(1:1) = achar(iachar(rest(1:1)) - 32)
    do while (len(rest) > wide)
      at = index(rest(:wide), ' ', back=.true.)
      if (at == 0) exit
      call lines%add(indent//rest(:at - 1))
      rest = rest(at + 1:)
    end do
    call lines%add(indent//rest)
  end subroutine add_wrapped

  !> The keys of a group as a table of doc/case.md.
  subroutine write_key_table(group, text)
    character(*), intent(in) :: group
    character(:), allocatable, intent(out) :: text
    type(keys_t) :: keys
    type(lines_t) :: lines
    character(:), allocatable :: allowed
    character(100) :: default
    logical :: has_unit
    integer :: i

    call list_keys([character(task_length) ::], keys)
    has_unit = any([(keys%key(i)%group == group .and. len(keys%key(i)%unit) > 0, i=1, keys%known)])
    call lines%put('| key |')
    if (has_unit) call lines%put(' unit |')
    call lines%add(' default | allowed | meaning |')
    call lines%put('|---|')
    if (has_unit) call lines%put('---|')
    call lines%add('---|---|---|')
    do i = 1, keys%known
      associate (key => keys%key(i))
        if (key%group /= group) cycle
        call key%list_allowed(allowed)
        if (key%kind == kind_logical .or. allocated(key%words)) allowed = '`'//allowed//'`'
        default = default_of(key)
        if (default == 'required') default = '**required**'
        if (key%is_one_of) default = '**one of these**'
        if (default == 'none') default = '-'
        if (allocated(key%default) .and. len(key%otherwise) == 0) then
          if (key%kind == kind_logical .or. key%kind == kind_text) default = '`'//key%default//'`'
          if (key%default == '''''') default = 'empty'
        end if
        call lines%put('| `'//trim(key%name)//'` |')
        if (has_unit) call lines%put(' '//key%unit//trim(merge(' |', '| ', len(key%unit) > 0)))
        call lines%add(' '//trim(default)//' | '//allowed//' | '//key%meaning//' |')
      end associate
    end do
    text = lines%text()
  end subroutine write_key_table
end module gearsweep_help
