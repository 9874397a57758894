!> Describes tasks, groups and keys as text, from the declarations of the keys: the help.
module gearsweep_api_help
  use gearsweep_base, only: closest_word, code_input, error_t, fail, join, lines_t, lower, shown, with_blanks
  use gearsweep_study, only: key_t, keys_t, name_length, task_info_t, task_length, task_slot_t
  use gearsweep_api_case_reader, only: list_keys
  use gearsweep_api_tasks, only: list_tasks
  implicit none
  private
  public :: default_of, find_key, help_on

  !> A technical term that is no key or task, and the key to use instead, or that gearsweep does not compute it.
  type :: entry_t
    character(40) :: words
    character(300) :: meaning
  end type entry_t

  type(entry_t), parameter :: glossary(*) = [ &
    entry_t('noise quiet sound', 'Gear noise follows the transmission error: its peak-to-peak value and harmonics are in '// &
      'the table mesh (task mesh), its dynamic values in the table sweep (task sweep); task optimum finds a tip relief.'), &
    entry_t('rms', 'Columns with rms in their name are root mean squares over a steady period, such as dte_rms_um of the '// &
      'table sweep (task sweep).'), &
    entry_t('quality accuracy tolerance class', 'The accuracy class by ISO 1328-1 is &rating accuracy_grade for the dynamic '// &
      'factor K_v, and &deviations pinion_class and gear_class for drawn flank deviations.'), &
    entry_t('helix helical beta', 'Helical gears have &pair helix_angle_deg. The task geometry has their dimensions, contact '// &
      'ratios, span and diameter over balls, face_load the load over their face, sweep '// &
      'their motion, rating their safety and life their fatigue by ISO 6336; the other tasks are for spur gears.'), &
    entry_t('scuffing', 'Scuffing is not rated; the task flank has the flash temperature, film thickness and sliding speed '// &
      'that a rating needs.'), &
    entry_t('wear micropitting', 'Wear and micropitting are not computed; the task flank has pressure, sliding speed and '// &
      'film thickness.'), &
    entry_t('bearing bearings shaft', 'Bearings are not computed. &face shaft_diameter_mm is the pinion''s shaft, which twists '// &
      'and bends under the load over the face width. In motion the gears turn about fixed axes: hub_inertia_kgm2 of a gear '// &
      'adds the inertia of what turns with it.'), &
    entry_t('rexs dxf cad', 'The Python package reads a stage of a REXS file (gearsweep.read_rexs) and writes '// &
      'the outlines of both gears as a DXF drawing (gearsweep.write_dxf).'), &
    entry_t('internal bevel worm planetary rack', 'gearsweep is for pairs of external gears.')]

contains

  !> Help on a task, a group, a key, or a key of a group; `words` is its name or `GROUP KEY`. Other words are searched in the
  !> descriptions.
  subroutine help_on(words, text, error)
    character(*), intent(in) :: words
    character(:), allocatable, intent(out) :: text
    type(error_t), allocatable, intent(inout) :: error
    type(keys_t) :: keys
    type(task_slot_t), allocatable :: slots(:)
    type(lines_t) :: lines
    type(error_t), allocatable :: unknown
    character(name_length), allocatable :: names(:), groups(:)
    character(:), allocatable :: name, allowed
    integer :: i, k, at
    character(26) :: key_name

    call list_keys([character(task_length) ::], keys)
    call list_tasks(slots)
    name = lower(trim(adjustl(words)))
    if (index(name, '&') == 1) name = name(2:)
    if (index(name, ' ') > 0) then
      call find_key(keys, name, at, unknown)
      if (.not. allocated(unknown)) call add_key_help(keys%key(at), lines)
    else
      do i = 1, size(slots)
        associate (task => slots(i)%info)
          if (task%name /= name) cycle
          call lines%add('task '//trim(task%name))
          call lines%add_wrapped(task%summary//'.', '  ')
          call lines%add('  tables    '//trim(task%tables//' '//task%fields))
          call lines%add('')
        end associate
      end do
      do i = 1, size(keys%groups)
        if (keys%groups(i)%name == name) then
          call lines%add('group &'//trim(keys%groups(i)%name))
          call lines%add_wrapped(keys%groups(i)%meaning, '  ')
          do k = 1, keys%known
            if (keys%key(k)%group /= keys%groups(i)%name) cycle
            call keys%key(k)%list_allowed(allowed)
            key_name = keys%key(k)%name
            call lines%add('  '//key_name//' '//trim(default_of(keys%key(k)))//trim(' '//keys%key(k)%unit)//' ('//allowed//')')
          end do
          call lines%add('')
        end if
      end do
      do i = 1, keys%known
        if (keys%key(i)%name == name) call add_key_help(keys%key(i), lines)
      end do
    end if
    if (len(lines%text()) == 0) call search_descriptions(keys, slots, name, lines)
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

  !> Searches the descriptions: first the keys whose name, group or group's meaning has all `words` (lower case, any order), those
  !> of a group named by a word before the others; then the tasks, the keys whose own meaning has them, and the glossary.
  !> A key of several groups is printed once.
  subroutine search_descriptions(keys, slots, words, lines)
    type(keys_t), intent(in) :: keys
    type(task_slot_t), intent(in) :: slots(:)
    character(*), intent(in) :: words
    type(lines_t), intent(inout) :: lines
    logical :: in_group(keys%known), named(keys%known), meant(keys%known)
    integer :: i, of_group

    do i = 1, keys%known
      associate (key => keys%key(i))
        of_group = index_of(key%group)
        named(i) = has_words(trim(key%group)//' '//trim(key%name)//' '//keys%groups(of_group)%meaning, words)
        in_group(i) = named(i) .and. index(' '//words//' ', ' '//trim(key%group)//' ') > 0
        meant(i) = .not. named(i) .and. has_words(trim(key%name)//' '//key%meaning, words)
      end associate
    end do
    call add_keys(in_group)
    call add_keys(named .and. .not. in_group)
    do i = 1, size(slots)
      if (.not. has_words(trim(slots(i)%info%name)//' '//slots(i)%info%summary, words)) cycle
      call lines%add('task '//trim(slots(i)%info%name))
      call lines%add_wrapped(slots(i)%info%summary//'.', '  ')
    end do
    call add_keys(meant)
    do i = 1, size(glossary)
      if (.not. has_words(trim(glossary(i)%words), words)) cycle
      call lines%add(words)
      call lines%add_wrapped(trim(glossary(i)%meaning), '  ')
    end do

  contains

    !> Index of the key's group; every key has a declared group.
    pure integer function index_of(group)
      character(*), intent(in) :: group

      do index_of = 1, size(keys%groups) - 1
        if (keys%groups(index_of)%name == group) exit
      end do
    end function index_of

    subroutine add_keys(found)
      logical, intent(in) :: found(:)
      character(:), allocatable :: groups
      integer :: k, n

      do k = 1, size(found)
        if (.not. found(k)) cycle
        if (any([(found(n) .and. is_same(n, k), n=1, k - 1)])) cycle
        groups = '&'//trim(keys%key(k)%group)
        do n = k + 1, size(found)
          if (found(n) .and. is_same(n, k)) groups = groups//', &'//trim(keys%key(n)%group)
        end do
        call lines%add_wrapped(groups//' '//trim(keys%key(k)%name), '')
        call lines%add_wrapped(keys%key(k)%meaning//'.', '  ')
      end do
    end subroutine add_keys

    logical function is_same(n, k)
      integer, intent(in) :: n, k

      is_same = keys%key(n)%name == keys%key(k)%name .and. keys%key(n)%meaning == keys%key(k)%meaning
    end function is_same
  end subroutine search_descriptions

  !> True if `text` has each of these words (lower case) as a complete word. Its underscores match blanks, and the underscores of a
  !> symbol may be absent (K_Hbeta).
  pure logical function has_words(text, words)
    character(*), intent(in) :: text, words
    character(:), allocatable :: padded, blanks, bare, remaining, word
    integer :: gap

    padded = ' '//lower(text)//' '
    blanks = with_blanks(padded)
    bare = without_underscores(padded)
    remaining = trim(adjustl(words))
    has_words = len(remaining) > 0
    do while (len(remaining) > 0 .and. has_words)
      gap = index(remaining//' ', ' ')
      word = remaining(:gap - 1)
      remaining = trim(adjustl(remaining(min(gap, len(remaining) + 1):)))
      has_words = holds(padded, word) .or. holds(blanks, word)
      if (index(word, '_') > 0 .and. .not. has_words) has_words = holds(bare, trim(without_underscores(word)))
    end do
  end function has_words

  !> Removes each underscore; blanks are added at the end.
  pure function without_underscores(text) result(other)
    character(*), intent(in) :: text
    character(len(text)) :: other
    integer :: k, n

    other = ''
    n = 0
    do k = 1, len(text)
      if (text(k:k) == '_') cycle
      n = n + 1
      other(n:n) = text(k:k)
    end do
  end function without_underscores

  !> True if `word` is a complete word of `text`, which begins and ends with a blank.
  pure logical function holds(text, word)
    character(*), intent(in) :: text, word
    character(*), parameter :: letters = 'abcdefghijklmnopqrstuvwxyz_0123456789'
    integer :: at, next

    at = 1
    holds = .false.
    do
      next = index(text(at + 1:), word)
      if (next == 0 .or. holds) exit
      at = at + next
      holds = verify(text(at - 1:at - 1), letters) > 0 .and. verify(text(at + len(word):at + len(word)), letters) > 0
    end do
  end function holds

  !> Finds the index of a key from `GROUP KEY`.
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

  subroutine add_key_help(key, lines)
    type(key_t), intent(in) :: key
    type(lines_t), intent(inout) :: lines
    character(:), allocatable :: allowed

    call key%list_allowed(allowed)
    call lines%add('&'//trim(key%group)//' '//trim(key%name))
    call lines%add_wrapped(key%meaning//'.', '  ')
    if (len(key%unit) > 0) call lines%add('  unit      '//key%unit)
    call lines%add('  default   '//trim(default_of(key)))
    call lines%add('  allowed   '//allowed)
    if (len(key%tasks) > 0) call lines%add('  for       '//key%tasks)
    call lines%add('')
  end subroutine add_key_help

  !> Default of a key, in words.
  pure function default_of(key) result(words)
    type(key_t), intent(in) :: key
    character(100) :: words

    words = 'none'
    if (allocated(key%default)) words = key%default
    if (len(key%default_note) > 0) words = key%default_note
    if (key%is_one_of) words = 'exactly one of the group''s keys must be given'
    if (key%is_required .and. len(key%default_note) == 0) words = 'required'
    if (words == '''''') words = 'empty'
  end function default_of
end module gearsweep_api_help
