!> Reads a case, one text for every door: takes each key once, in its unit, and checks it. A key that
!> contradicts others is refused; one that the case has no use for is listed.
module gearsweep_case_reader
  use gearsweep_body_keys, only: read_modal, read_section, read_static
  use gearsweep_case, only: case_t, task_names
  use gearsweep_case_checks, only: check_case
  use gearsweep_error, only: error_t
  use gearsweep_gear_keys, only: read_material, read_member, read_pair
  use gearsweep_mesh_keys, only: read_load, read_model, read_path, read_relief
  use gearsweep_motion_keys, only: read_dynamics, read_numerics, read_sweep
  use gearsweep_reader, only: open_reader, reader_t
  implicit none
  private
  public :: read_case, complete_case, check_key

  character(*), parameter :: groups(*) = [character(8) :: 'case', 'pair', 'pinion', 'gear', 'material', 'load', 'relief', &
                                          'mesh', 'section', 'static', 'modal', 'dynamics', 'sweep', 'numerics']

contains

  !> Reads and checks a case; the error names group, key, value and what is allowed. Any number of
  !> callers at once.
  subroutine read_case(text, case, error)
    character(*), intent(in) :: text
    type(case_t), intent(out) :: case
    type(error_t), allocatable, intent(out) :: error
    type(reader_t) :: reader

    call open_reader(text, groups, reader, error)
    call read_all(text, reader, case, error)
  end subroutine read_case

  !> Reads and checks a case and writes it with all its defaults.
  subroutine complete_case(text, complete, error)
    character(*), intent(in) :: text
    character(:), allocatable, intent(out) :: complete
    type(error_t), allocatable, intent(out) :: error
    type(case_t) :: case
    type(reader_t) :: reader

    call open_reader(text, groups, reader, error, completes=.true.)
    call read_all(text, reader, case, error)
    if (.not. allocated(error)) call reader%write_complete(complete)
  end subroutine complete_case

  !> Fails where no case has such a key; the error names the closest one.
  subroutine check_key(group, key, error)
    character(*), intent(in) :: group, key
    type(error_t), allocatable, intent(inout) :: error
    type(case_t) :: case
    type(reader_t) :: reader
    type(error_t), allocatable :: missing

    ! Reading asks for every key; that this case lacks some does not matter here.
    call open_reader('&case tasks = ''geometry'' /', groups, reader, error)
    if (allocated(error)) return
    call read_all('', reader, case, missing)
    call reader%check_key(group, key, error)
  end subroutine check_key

  !> What a key is good for depends on others, which are read before it.
  subroutine read_all(text, reader, case, error)
    character(*), intent(in) :: text
    type(reader_t), intent(inout) :: reader
    type(case_t), intent(inout) :: case
    type(error_t), allocatable, intent(inout) :: error

    case%text = text
    call read_tasks(reader, case, error)
    call read_model(reader, case, error)
    call read_load(reader, case, error)
    call read_dynamics(reader, case, error)
    call read_sweep(reader, case, error)
    call read_numerics(reader, case, error)
    call read_section(reader, case, error)
    call read_static(reader, case, error)
    call read_modal(reader, case, error)
    call read_relief(reader, case, error)
    call read_pair(reader, case, error)
    call read_member(reader, 'pinion', 1, case, error)
    call read_member(reader, 'gear', 2, case, error)
    call read_material(reader, case, error)
    call read_path(reader, case, error)
    call reader%finish(error)
    if (allocated(error)) return
    call check_case(case, error)
    call reader%list_waiting(case%unused)
  end subroutine read_all

  subroutine read_tasks(reader, case, error)
    type(reader_t), intent(inout) :: reader
    type(case_t), intent(inout) :: case
    type(error_t), allocatable, intent(inout) :: error
    character(:), allocatable :: tasks(:)
    integer :: i

    case%title = ''
    call reader%get('case', 'title', case%title, error)
    call reader%get('case', 'published', case%published, error)
    allocate (tasks, source=[character(8) :: 'mesh', 'sweep'])
    call reader%get('case', 'tasks', tasks, error, allowed=task_names)
    case%wants = [(any(tasks == task_names(i)), i=1, size(task_names))]
  end subroutine read_tasks
end module gearsweep_case_reader
