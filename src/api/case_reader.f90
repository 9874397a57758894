!> Reads a case, one text for every interface: reads each key once, in its unit, and checks it. A key that contradicts others is
!> refused; one that the case does not use is listed.
module gearsweep_api_case_reader
  use gearsweep_base, only: code_input, error_t, fail, join, lower, utf8
  use gearsweep_study, only: add_length_cautions, case_t, check_case, keys_t, namelist_t, open_list, open_reader, parse_namelist, &
    read_direction, read_dynamics, read_face, read_gear, read_load, read_materials, read_model, read_numerics, read_pair, &
    read_path, read_relief, read_section, read_sweep, reader_t, task_length
  use gearsweep_api_tasks, only: find_former_task, list_task_names, list_tasks
  implicit none
  private
  public :: read_case, read_list, complete_case, check_keys, list_keys

contains

  !> Reads and checks a case; the error names group, key, value and what is allowed. Any number of
  !> callers at once.
  subroutine read_case(text, case, error)
    character(*), intent(in) :: text
    type(case_t), intent(out) :: case
    type(error_t), allocatable, intent(out) :: error

    type(namelist_t) :: list

    call parse_namelist(text, list, error)
    ! Without memory for the text there is none for the keys.
    if (.not. allocated(error)) call read_list(text, list, case, error)
  end subroutine read_case

  !> Reads a case whose text is already split into `list`.
  subroutine read_list(text, list, case, error)
    character(*), intent(in) :: text
    type(namelist_t), intent(in) :: list
    type(case_t), intent(out) :: case
    type(error_t), allocatable, intent(out) :: error

    call read_once(text, list, .true., case, error)
    ! The message may name keys that the text does not have.
    if (allocated(error)) call read_once(text, list, .false., case, error)
  end subroutine read_list

  subroutine read_once(text, list, is_brief, case, error)
    character(*), intent(in) :: text
    type(namelist_t), intent(in) :: list
    logical, intent(in) :: is_brief
    type(case_t), intent(out) :: case
    type(error_t), allocatable, intent(out) :: error
    type(reader_t) :: reader

    call open_list(list, reader, is_brief)
    call read_all(text, reader, case, error)
  end subroutine read_once

  !> Reads and checks a case and writes it with all its defaults.
  subroutine complete_case(text, complete, error)
    character(*), intent(in) :: text
    character(:), allocatable, intent(out) :: complete
    type(error_t), allocatable, intent(out) :: error
    type(case_t) :: case
    type(reader_t) :: reader

    call open_reader(text, reader, error, keeps_defaults=.true.)
    if (.not. allocated(error)) call read_all(text, reader, case, error)
    if (.not. allocated(error)) call reader%write_complete(complete)
  end subroutine complete_case

  !> Fails if no case can have one of these keys of the text; the error names the closest one.
  subroutine check_keys(text, keys, error)
    character(*), intent(in) :: text
    type(namelist_t), intent(in) :: keys
    type(error_t), allocatable, intent(inout) :: error
    type(case_t) :: case
    type(reader_t) :: reader
    type(error_t), allocatable :: unusable
    integer :: i

    if (allocated(error)) return
    ! It does not matter here if this case can be run.
    call open_reader(text, reader, unusable, is_brief=.true.)
    if (.not. allocated(unusable)) call read_all(text, reader, case, unusable)
    do i = 1, size(keys%entries)
      associate (entry => keys%entries(i))
        if (.not. reader%has_used(entry%group, entry%key)) call check_key(entry%group, entry%key, error)
      end associate
    end do
  end subroutine check_keys

  subroutine check_key(group, key, error)
    character(*), intent(in) :: group, key
    type(error_t), allocatable, intent(inout) :: error
    type(case_t) :: case
    type(reader_t) :: reader
    type(error_t), allocatable :: missing

    ! Reading declares every key; missing values do not matter here.
    if (allocated(error)) return
    call open_reader('&case tasks = ''geometry'' /', reader, error)
    if (allocated(error)) return
    call read_all('', reader, case, missing)
    call reader%check_key(group, key, error)
  end subroutine check_key

  !> Lists all keys with their declarations, as in a case that requests these tasks, or all tasks, and has no other keys.
  subroutine list_keys(tasks, keys)
    character(*), intent(in) :: tasks(:)
    type(keys_t), intent(out) :: keys
    type(case_t) :: case
    type(reader_t) :: reader
    type(error_t), allocatable :: error, missing
    character(task_length), allocatable :: names(:)

    call list_task_names(names)
    if (size(tasks) > 0) names = tasks
    call open_reader('&case tasks = '''//join(names, ''', ''')//''' /', reader, error, keeps_defaults=.true.)
    call read_all('', reader, case, missing)
    keys = reader%keys
  end subroutine list_keys

  !> Reads all keys in the order in which they depend on each other.
  subroutine read_all(text, reader, case, error)
    character(*), intent(in) :: text
    type(reader_t), intent(inout) :: reader
    type(case_t), intent(inout) :: case
    type(error_t), allocatable, intent(inout) :: error
    integer :: i, before

    case%text = utf8(text)
    ! The groups are in the order in which a case is written.
    call reader%add_group('case', 'What the case is called and what to compute.')
    call reader%add_group('pair', 'What the two gears have in common.')
    call reader%add_group('pinion', 'The driving gear. Its tooth factors are in modules.')
    call reader%add_group('gear', 'The driven gear. Its tooth factors are in modules.')
    call reader%add_group('material', 'The material of both gears; a gear of another has keys of its own.')
    call reader%add_group('face', 'How the faces of the gears meet: the load over the face width.')
    call reader%add_group('load', 'The static load; exactly one of its keys.')
    call reader%add_group('relief', 'Tip relief, which grows from its start to the tip. Without this group there is none.')
    call reader%add_group('mesh', 'The stiffness of the pairs of teeth in mesh.')
    call reader%add_group('section', 'The body behind the teeth, for finite elements.')
    call reader%add_group('dynamics', 'Damping and friction of the motion.')
    call reader%add_group('sweep', 'The speeds of the pinion.')
    call reader%add_group('numerics', 'How exactly and by which method the motion is found; the defaults suit nearly every case.')
    call read_tasks(reader, case, error)
    call read_model(reader, case, error)
    call read_load(reader, case, error)
    do i = 1, size(case%tasks)
      associate (slot => case%tasks(i))
        ! An absent group has no keys to read, or a brief reading ends with an error. A prescribed mesh changes the keys that tasks
        ! use.
        if (reader%is_brief .and. .not. (slot%is_requested .or. case%prescribed .or. reader%has_group(slot%info%name))) cycle
        before = reader%keys%asked
        call slot%task%read_keys(reader, error)
        call reader%keys%write_given(reader%list, before, slot%key_text)
      end associate
    end do
    call read_dynamics(reader, case, error)
    call read_sweep(reader, case, error)
    call read_numerics(reader, case, error)
    call read_section(reader, case, error)
    call read_relief(reader, case, error)
    call read_pair(reader, case, error)
    call read_gear(reader, 'pinion', 1, case, error)
    call read_gear(reader, 'gear', 2, case, error)
    call read_face(reader, case, error)
    call read_direction(reader, case, error)
    call read_materials(reader, case, error)
    call read_path(reader, case, error)
    call reader%finish(error)
    if (allocated(error)) return
    call check_case(case, error)
    call reader%keys%list_unused(case%unused)
    call reader%keys%list_cautions(case%cautions)
    call add_length_cautions(case)
  end subroutine read_all

  subroutine read_tasks(reader, case, error)
    type(reader_t), intent(inout) :: reader
    type(case_t), intent(inout) :: case
    type(error_t), allocatable, intent(inout) :: error
    character(task_length), allocatable :: names(:)
    character(:), allocatable :: tasks(:), now
    integer :: i, at

    case%title = ''
    call reader%get('case', 'title', case%title, error, meaning='printed above the results')
    call reader%get('case', 'published', case%published, error, default_note='none', &
                    meaning='file of printed values to set beside the results; a relative name lies beside the case')
    call list_tasks(case%tasks)
    names = [(case%tasks(i)%info%name, i=1, size(case%tasks))]
    allocate (tasks, source=[character(8) :: 'mesh', 'sweep'])
    at = reader%list%position('case', 'tasks')
    if (at > 0) then
      associate (values => reader%list%entries(at)%values)
        do i = 1, size(values)
          call find_former_task(lower(values(i)%text), now)
          if (len(now) > 0) call fail(error, code_input, '&case tasks: '''//lower(values(i)%text)//''' is '//now)
        end do
      end associate
    end if
    call reader%get('case', 'tasks', tasks, error, allowed=names, meaning='what to compute, and nothing else')
    call case%request(tasks)
    call reader%request(tasks)
  end subroutine read_tasks
end module gearsweep_api_case_reader
