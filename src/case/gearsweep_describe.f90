!> What a case can say, from the declarations of its keys: the help, a list in JSON, a case to begin with, and the
!> tables of doc/case.md.
module gearsweep_describe
  use gearsweep_case_reader, only: list_keys
  use gearsweep_error, only: code_input, error_t, fail
  use gearsweep_kinds, only: dp
  use gearsweep_key, only: key_t, kind_integer, kind_logical, kind_number, kind_text
  use gearsweep_keys, only: keys_t
  use gearsweep_lines, only: lines_t
  use gearsweep_namelist, only: name_length
  use gearsweep_task, only: task_info_t, task_length
  use gearsweep_tasks, only: list_tasks, task_slot_t
  use gearsweep_text, only: closest_word, join, lower, shown, str
  use gearsweep_version, only: version
  implicit none
  private
  public :: describe, help_on, write_key_table

  character, parameter :: lf = new_line('a')
  character(*), parameter :: kind_names(kind_number:kind_text) = [character(7) :: 'number', 'integer', 'logical', 'text']

contains

  ! --- JSON -------------------------------------------------------------------

  !> In JSON: `all`, or one of `tasks`, `groups`, `keys`, or `key GROUP KEY`.
  subroutine describe(what, words, error)
    character(*), intent(in) :: what
    character(:), allocatable, intent(out) :: words
    type(error_t), allocatable, intent(inout) :: error
    type(keys_t) :: keys
    character(*), parameter :: choices(*) = [character(6) :: 'all', 'tasks', 'groups', 'keys']
    type(lines_t) :: lines
    integer :: at

    call list_keys([character(task_length) ::], keys)
    select case (what)
    case ('all')
      call lines%put('{"version": ')
      call lines%json_text(version)
      call lines%put(', "tasks": ')
      call put_tasks(lines)
      call lines%put(', "groups": ')
      call put_groups(keys, lines)
      call lines%put(', "keys": ')
      call put_keys(keys, lines)
      call lines%put('}')
    case ('tasks')
      call put_tasks(lines)
    case ('groups')
      call put_groups(keys, lines)
    case ('keys')
      call put_keys(keys, lines)
    case default
      if (index(what, 'key ') == 1) then
        call find_key(keys, what(5:), at, error)
        if (.not. allocated(error)) call put_key(keys%key(at), lines)
      else
        at = closest_word(what, choices)
        if (at > 0) call fail(error, code_input, shown(what)//': cannot be described (did you mean '//trim(choices(at))//'?)')
        call fail(error, code_input, shown(what)//': cannot be described; '//join(choices, ', ')//' and key GROUP KEY can')
      end if
    end select
    if (allocated(error)) return
    call lines%add('')
    words = lines%text()
  end subroutine describe

  subroutine put_tasks(lines)
    type(lines_t), intent(inout) :: lines
    type(task_slot_t), allocatable :: slots(:)
    integer :: i

    call list_tasks(slots)
    call lines%add('[')
    do i = 1, size(slots)
      associate (task => slots(i)%info)
        call lines%put('  {"name": "'//trim(task%name)//'", "meaning": ')
        call lines%json_text(task%gives)
        call lines%put(', "needs": ')
        call put_words(task%needs, lines)
        call lines%put(', "tables": ')
        call put_words(task%tables//' '//task%fields, lines)
        call lines%add('}'//trim(merge(',', ' ', i < size(slots))))
      end associate
    end do
    call lines%put(']')
  end subroutine put_tasks

  !> Words with blanks or commas between them, and `or` before the last.
  subroutine put_words(list, lines)
    character(*), intent(in) :: list
    type(lines_t), intent(inout) :: lines
    character(*), parameter :: letters = 'abcdefghijklmnopqrstuvwxyz_0123456789'
    integer :: from, length, n

    call lines%put('[')
    from = 1
    n = 0
    do while (from <= len(list))
      length = verify(list(from:)//',', letters) - 1
      if (length > 0) then
        if (list(from:from + length - 1) /= 'or') then
          if (n > 0) call lines%put(', ')
          call lines%json_text(list(from:from + length - 1))
          n = n + 1
        end if
      end if
      from = from + length + 1
    end do
    call lines%put(']')
  end subroutine put_words

  subroutine put_groups(keys, lines)
    type(keys_t), intent(in) :: keys
    type(lines_t), intent(inout) :: lines
    integer :: i

    call lines%add('[')
    do i = 1, size(keys%groups)
      call lines%put('  {"name": "'//trim(keys%groups(i)%name)//'", "meaning": ')
      call lines%json_text(keys%groups(i)%meaning)
      call lines%add('}'//trim(merge(',', ' ', i < size(keys%groups))))
    end do
    call lines%put(']')
  end subroutine put_groups

  subroutine put_keys(keys, lines)
    type(keys_t), intent(in) :: keys
    type(lines_t), intent(inout) :: lines
    integer :: i

    call lines%add('[')
    do i = 1, keys%known
      call lines%put('  ')
      call put_key(keys%key(i), lines)
      call lines%add(trim(merge(',', ' ', i < keys%known)))
    end do
    call lines%put(']')
  end subroutine put_keys

  subroutine put_key(key, lines)
    type(key_t), intent(in) :: key
    type(lines_t), intent(inout) :: lines
    character(:), allocatable :: allowed

    call key%list_allowed(allowed)
    call lines%put('{"group": "'//trim(key%group)//'", "name": "'//trim(key%name)//'", "unit": ')
    call lines%json_text(key%unit)
    call lines%put(', "kind": "'//trim(kind_names(key%kind))//'", "list": '//truth(key%is_list)//', "required": '// &
                   truth(key%is_required)//', "one_of": '//truth(key%is_one_of)//', "default": ')
    if (allocated(key%default)) call lines%json_text(key%default)
    if (.not. allocated(key%default)) call lines%put('null')
    call lines%put(', "otherwise": ')
    call lines%json_text(key%otherwise)
    call lines%put(', "allowed": ')
    call lines%json_text(allowed)
    call lines%put(', "low": '//trim(bound(key%bounds%low, -1))//', "low_is_allowed": '//truth(.not. key%bounds%low_is_out)// &
                   ', "high": '//trim(bound(key%bounds%high, 1))//', "high_is_allowed": '//truth(.not. key%bounds%high_is_out)// &
                   ', "words": ')
    if (allocated(key%words)) call put_words(join(key%words, ' '), lines)
    if (.not. allocated(key%words)) call lines%put('[]')
    call lines%put(', "tasks": ')
    call put_words(key%tasks, lines)
    call lines%put(', "meaning": ')
    call lines%json_text(key%meaning)
    call lines%put('}')

  contains

    pure function truth(is_so) result(word)
      logical, intent(in) :: is_so
      character(merge(4, 5, is_so)) :: word

      word = merge('true ', 'false', is_so)
    end function truth

    function bound(value, side) result(word)
      real(dp), intent(in) :: value
      integer, intent(in) :: side
      character(24) :: word

      word = str(value, 12)
      if (side*value >= huge(value)) word = 'null'
    end function bound
  end subroutine put_key

  ! --- help -------------------------------------------------------------------

  !> Help on a task, a group, a key, or a key of a group, `words` being its name or `GROUP KEY`.
  subroutine help_on(words, text, error)
    character(*), intent(in) :: words
    character(:), allocatable, intent(out) :: text
    type(error_t), allocatable, intent(inout) :: error
    type(keys_t) :: keys
    type(task_slot_t), allocatable :: slots(:)
    type(lines_t) :: lines
    character(name_length), allocatable :: names(:), groups(:)
    character(:), allocatable :: name
    integer :: i, at

    call list_keys([character(task_length) ::], keys)
    call list_tasks(slots)
    name = lower(trim(adjustl(words)))
    if (index(name, '&') == 1) name = name(2:)
    if (index(name, ' ') > 0) then
      call find_key(keys, name, at, error)
      if (.not. allocated(error)) call tell_key(keys%key(at), lines)
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
    if (.not. allocated(error)) text = lines%text()
    if (.not. allocated(text)) return
    if (len(text) > 0) return
    call keys%list_groups(groups)
    names = [groups, [(keys%key(i)%name, i=1, keys%known)]]
    do i = 1, size(slots)
      names = [character(name_length) :: names, slots(i)%info%name]
    end do
    at = closest_word(name, names)
    if (at > 0) call fail(error, code_input, shown(name)//': no such task, group or key (did you mean '//trim(names(at))//'?)')
    call fail(error, code_input, shown(name)//': no such task, group or key; the groups are '//join(groups, ', '))
  end subroutine help_on

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
    character(24) :: name
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

  ! --- the reference ----------------------------------------------------------

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
end module gearsweep_describe
