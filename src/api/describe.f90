!> Describes tasks, groups and keys as JSON, from the declarations of the keys.
module gearsweep_api_describe
  use gearsweep_base, only: closest_word, code_input, dp, error_t, fail, join, lines_t, shown, str, version
  use gearsweep_study, only: key_t, keys_t, kind_number, kind_text, stage_words, task_length, task_slot_t
  use gearsweep_api_case_reader, only: list_keys
  use gearsweep_api_help, only: find_key, help_on
  use gearsweep_api_tasks, only: list_tasks
  implicit none
  private
  public :: describe

  character(*), parameter :: kind_names(kind_number:kind_text) = [character(7) :: 'number', 'integer', 'logical', 'text']

contains

  !> Describes in JSON: `all`, or one of `tasks`, `groups`, `keys`, or `key GROUP KEY`. As text: `help WORDS`, as in `help_on`.
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
      if (index(what, 'help ') == 1) then
        call help_on(what(6:), words, error)
        return
      end if
      if (index(what, 'key ') == 1) then
        call find_key(keys, what(5:), at, error)
        if (.not. allocated(error)) call put_key(keys%key(at), lines)
      else
        at = closest_word(what, choices)
        if (at > 0) call fail(error, code_input, shown(what)//': cannot be described (did you mean '//trim(choices(at))//'?)')
        call fail(error, code_input, shown(what)//': cannot be described; '//join(choices, ', ')// &
                  ', key GROUP KEY and help WORDS can')
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
        call lines%json_text(task%summary)
        call lines%put(', "needs": ')
        call put_words(join(stage_words(task%needs), ' '), lines)
        call lines%put(', "tables": ')
        call put_words(task%tables//' '//task%fields, lines)
        call lines%add('}'//trim(merge(',', ' ', i < size(slots))))
      end associate
    end do
    call lines%put(']')
  end subroutine put_tasks

  !> Puts words with blanks or commas between them, and `or` before the last.
  subroutine put_words(list, lines)
    character(*), intent(in) :: list
    type(lines_t), intent(inout) :: lines
    character(*), parameter :: letters = 'abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_0123456789-'
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
                   truth(key%is_required .and. key%default_note /= 'none')//', "one_of": '//truth(key%is_one_of)//', "default": ')
    if (has_default(key)) call lines%json_text(key%default)
    if (.not. has_default(key)) call lines%put('null')
    call lines%put(', "otherwise": ')
    call lines%json_text(key%default_note)
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

    !> True if the key has a default. A value with which the text `otherwise` does not begin only marks an absent key.
    pure logical function has_default(key)
      type(key_t), intent(in) :: key

      has_default = allocated(key%default)
      if (.not. has_default .or. len(key%default_note) == 0) return
      has_default = index(key%default_note, trim(adjustl(unquoted(key%default)))) == 1
    end function has_default

    pure function unquoted(text)
      character(*), intent(in) :: text
      character(len(text)) :: unquoted

      unquoted = text
      if (len(text) > 1 .and. text(1:1) == '''') unquoted = text(2:len(text) - 1)
    end function unquoted

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
end module gearsweep_api_describe
