!> Interface between a case and a task: the stages that the task needs, the keys of its own group, and the tables of its result.
!> `runnable_t` (gearsweep_study_run_stages), which every task extends, adds how it runs.
!>
!> While a case is read, each task reads its keys. In a run, each requested task receives the products of the stages that it needs
!> and fills its tables. Tables of an earlier study with the same keys and products are reused.
module gearsweep_study_case_task
  use gearsweep_base, only: code_input, dp, error_t, fail, lines_t, str, table_t
  use gearsweep_gear, only: gear_spec_t
  use gearsweep_elastic, only: grid_t
  use gearsweep_study_reader_reader, only: reader_t, sentence_length
  implicit none
  private
  public :: task_t, task_info_t, task_slot_t, case_facts_t, check_reliefs, needs_moving, sentence_of, split_names

  integer, parameter, public :: task_length = 20, table_length = 18
  character(*), parameter, public :: gear_names(2) = [character(6) :: 'pinion', 'gear']

  !> Stages and choices of a case on which a result may depend.
  type :: stage_names_t
    integer :: geometry                          !< gears, absent with a prescribed mesh
    integer :: section                           !< the section of one gear
    integer :: body                              !< that section by finite elements, fixed and factored
    integer :: solid                             !< the gear in three dimensions: teeth, bore, web and rim, with its material
    integer :: elasticity                        !< moduli and Poisson's ratios of the materials, even if the mesh does not use them
    integer :: density                           !< densities of the materials
    integer :: rims                              !< application factor and the gears' rims, even if the mesh does not use them
    integer :: webs                              !< webs of the gears
    integer :: mesh                              !< load, masses and stiffness
    integer :: reliefs                           !< the result depends on the relief
    integer :: amounts                           !< there is one result for each amount of relief
    integer :: motion                            !< the equation of motion, and so friction
    integer :: losses                            !< damping, and what follows once flanks part: backlash
    integer :: accuracy                          !< choices of &numerics
    integer :: speeds                            !< speeds of &sweep
    integer :: direction                         !< direction of a sweep through the speeds
    integer :: face                              !< misalignment, leads and the pinion's shaft
  end type stage_names_t

  !> Indices of the stages, as in `stage%mesh`.
  type(stage_names_t), parameter, public :: stage = stage_names_t(1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17)

  !> Names of the stages in descriptions of a task.
  character(*), parameter, public :: stage_words(*) = [character(10) :: 'geometry', 'section', 'body', 'solid', 'elasticity', &
    'density', 'rims', 'webs', 'mesh', 'reliefs', 'amounts', 'motion', 'losses', 'accuracy', 'speeds', 'direction', 'face']

  !> Description of a task.
  type :: task_info_t
    character(task_length) :: name = ''
    integer, allocatable :: needs(:)             !< needed stages, indices in `stage`
    character(:), allocatable :: summary           !< result of the task, without a full stop
    character(:), allocatable :: tables          !< names of all its possible tables, separated by blanks
    character(:), allocatable :: fields          !< names of those whose rows are nodes or elements of a grid
    logical :: is_always = .false.               !< true if it runs for every case that has gears, even if not requested
    logical :: has_helical = .false.             !< true if it computes helical gears too
    logical :: has_uneven_motion = .false.       !< true if its motion is that with the faces as they meet
  end type task_info_t

  !> Values of the case's other groups with which a task's keys must agree.
  type :: case_facts_t
    real(dp), allocatable :: amount(:)           !< amounts of relief, m
    type(gear_spec_t) :: spec(2)                 !< pinion and gear; without teeth if a prescribed mesh does not state them
    integer :: scheme = 0                        !< integration scheme, of gearsweep_motion_resolution
    real(dp), allocatable :: torque(:)           !< torques of &load torques_nm, N m; empty without
  end type case_facts_t

  !> A file that a key of a task names. Its text is an input like the key.
  type :: task_file_t
    character(:), allocatable :: name            !< name in the case; relative to the folder of the case
    character(:), allocatable :: path            !< path of the file that was read, in a study
    character(:), allocatable :: text            !< its text, in a study
  end type task_file_t

  !> Task with the values of its keys and, after its run, its result.
  type, abstract :: task_t
    integer :: needs(size(stage_words)) = 0      !< needed stages, indices in `stage`, as in its description; other elements 0
    ! Keys that several tasks have, each in its own group:
    real(dp), allocatable :: own_rpm(:)          !< speeds, 1/min; not allocated: those of &sweep
    real(dp), allocatable :: own_relief(:)       !< reliefs, m; not allocated: all of the case
    type(task_file_t), allocatable :: files(:)   !< files that its keys name; not allocated if none
    ! Result:
    type(table_t), allocatable :: tables(:)      !< tables in the order of `describe`
    type(grid_t), allocatable :: grid            !< grid whose nodes or elements the rows of tables are
    logical :: is_done = .false.                 !< true if there is a result
    logical :: is_stopped = .false.              !< true if the caller ended the run: the result is incomplete
    logical :: is_reused = .false.                !< true if the expensive results are an earlier study's
    integer :: failed = 0                        !< number of operating points that did not converge
    character(:), allocatable :: log             !< steps of the run, a line each
  contains
    procedure(describe_task), deferred, nopass :: describe
    procedure :: read_keys => no_keys
    procedure(report_task), deferred :: add_report
    procedure :: check => check_reliefs
    procedure :: uses => uses_stage
    procedure :: has_same_files
    procedure :: prepare, place, read_speeds, read_reliefs
  end type task_t

  !> A task, and its use in a case.
  type :: task_slot_t
    type(task_info_t) :: info
    class(task_t), allocatable :: task
    logical :: is_requested = .false.               !< true if the case requests it
    character(:), allocatable :: key_text           !< values of its keys in the case, as text
  contains
    procedure :: needs
  end type task_slot_t

  abstract interface
    pure subroutine describe_task(info)
      import :: task_info_t
      type(task_info_t), intent(out) :: info
    end subroutine describe_task

    !> Adds lines for the screen, from the tables.
    pure subroutine report_task(self, lines)
      import :: lines_t, task_t
      class(task_t), intent(in) :: self
      type(lines_t), intent(inout) :: lines
    end subroutine report_task
  end interface

contains

  !> Declares and reads the task's keys, requested or not. This default is for a task without keys.
  subroutine no_keys(self, reader, error)
    class(task_t), intent(inout) :: self
    type(reader_t), intent(inout) :: reader
    type(error_t), allocatable, intent(inout) :: error

    ! Avoids a warning about unused arguments.
    if (.not. allocated(error) .and. reader%requests('')) self%is_done = .false.
  end subroutine no_keys

  !> True if the task needs this stage with its present keys. With speeds of its own it does not use those of &sweep.
  pure logical function uses_stage(self, which) result(uses)
    class(task_t), intent(in) :: self
    integer, intent(in) :: which                 !< index of the stage in `stage`

    uses = any(self%needs == which) .and. .not. (which == stage%speeds .and. allocated(self%own_rpm))
  end function uses_stage

  !> True if both tasks' input files have the same content; their keys are the same.
  pure logical function has_same_files(self, other) result(same)
    class(task_t), intent(in) :: self, other
    integer :: i

    same = allocated(self%files) .eqv. allocated(other%files)
    if (.not. (same .and. allocated(self%files))) return
    same = size(self%files) == size(other%files)
    do i = 1, merge(size(self%files), 0, same)
      ! Fortran treats texts as equal that differ in trailing blanks.
      same = same .and. len(self%files(i)%text) == len(other%files(i)%text) .and. self%files(i)%text == other%files(i)%text
    end do
  end function has_same_files

  !> Prepares the run: gives the tables, which are still empty, their names.
  subroutine prepare(self)
    class(task_t), intent(inout) :: self
    type(task_info_t) :: info
    character(table_length), allocatable :: names(:)
    integer :: i

    call self%describe(info)
    call split_names(info%tables//' '//info%fields, names)
    allocate (self%tables(size(names)))
    do i = 1, size(names)
      self%tables(i)%name = trim(names(i))
    end do
  end subroutine prepare

  !> Index of the table with this name; 0 if the task has none.
  pure integer function place(self, name) result(at)
    class(task_t), intent(in) :: self
    character(*), intent(in) :: name

    do at = size(self%tables), 1, -1
      if (self%tables(at)%name == name) exit
    end do
  end function place

  !> True if a task with these `needs` needs this stage. `moving`: it uses the load of the motion; otherwise no stage of the motion
  !> counts.
  pure logical function needs_moving(needs, which, moving)
    integer, intent(in) :: needs(:), which       !< indices of stages in `stage`
    logical, intent(in) :: moving

    needs_moving = any(needs == which) .and. (moving .or. .not. any([stage%motion, stage%losses, stage%accuracy] == which))
  end function needs_moving

  !> Splits a list of words with blanks between them.
  pure subroutine split_names(list, names)
    character(*), intent(in) :: list
    character(table_length), allocatable, intent(out) :: names(:)
    integer :: i, n, pass

    do pass = 1, 2
      n = 0
      do i = 1, len(list)
        if (list(i:i) == ' ') cycle
        if (i > 1) then
          if (list(i - 1:i - 1) /= ' ') cycle
        end if
        n = n + 1
        if (pass == 2) names(n) = list(i:i + index(list(i:)//' ', ' ') - 2)
      end do
      if (pass == 1) allocate (names(n))
    end do
  end subroutine split_names

  !> Reads the key `rpm` of the task's group, which has the task's name. `order`: description of the order of the speeds; without it
  !> they must ascend.
  subroutine read_speeds(self, reader, group, error, order)
    class(task_t), intent(inout) :: self
    type(reader_t), intent(inout) :: reader
    character(*), intent(in) :: group
    type(error_t), allocatable, intent(inout) :: error
    character(*), intent(in), optional :: order
    integer, parameter :: most = 100000
    character(:), allocatable :: meaning
    integer :: i

    meaning = 'speeds of the pinion, ascending'
    if (present(order)) meaning = 'speeds of the pinion, '//order
    call reader%get(group, 'rpm', self%own_rpm, error, unit='1/min', tasks=group, at_least=1e-6_dp, at_most=1e9_dp, &
                    max_size=most, distinct=.true., default_note='those of &sweep', meaning=meaning)
    if (present(order) .or. .not. allocated(self%own_rpm)) return
    do i = 2, size(self%own_rpm)
      if (self%own_rpm(i) <= self%own_rpm(i - 1)) call fail(error, code_input, '&'//group//' rpm: must ascend; '// &
        str(self%own_rpm(i))//' comes after '//str(self%own_rpm(i - 1)))
    end do
  end subroutine read_speeds

  !> Reads the key `relief_um` of the task's group, which has the task's name.
  subroutine read_reliefs(self, reader, group, error)
    class(task_t), intent(inout) :: self
    type(reader_t), intent(inout) :: reader
    character(*), intent(in) :: group
    type(error_t), allocatable, intent(inout) :: error

    call reader%get(group, 'relief_um', self%own_relief, error, unit='um', tasks=group, at_least=0.0_dp, at_most=1e9_dp, &
                    max_size=10000, distinct=.true., default_note='all of &relief amount_um', &
                    meaning='tip reliefs, from those of &relief amount_um')
  end subroutine read_reliefs

  !> Checks the task's keys against the case: its reliefs must be among those of the case.
  subroutine check_reliefs(self, facts, error)
    class(task_t), intent(in) :: self
    type(case_facts_t), intent(in) :: facts
    type(error_t), allocatable, intent(inout) :: error
    type(task_info_t) :: info
    integer :: i

    if (.not. allocated(self%own_relief)) return
    call self%describe(info)
    do i = 1, size(self%own_relief)
      if (minval(abs(facts%amount - self%own_relief(i))) > 1e-9_dp*self%own_relief(i)) call fail(error, code_input, &
        '&'//trim(info%name)//' relief_um = '//str(1e6_dp*self%own_relief(i))//': is none of &relief amount_um')
    end do
  end subroutine check_reliefs

  !> True if the case requests this task and the task uses this stage.
  pure logical function needs(self, which)
    class(task_slot_t), intent(in) :: self
    integer, intent(in) :: which                 !< index of the stage in `stage`

    needs = self%is_requested .and. self%task%uses(which)
  end function needs

  !> Tasks that need this stage, or the other one, as in `load, sweep or optimum`.
  pure function sentence_of(slots, which, other) result(words)
    type(task_slot_t), intent(in) :: slots(:)
    integer, intent(in) :: which                 !< index of the stage in `stage`
    integer, intent(in), optional :: other
    character(sentence_length) :: words
    character(task_length + 4) :: word
    integer :: list(size(slots)), i, n, last
    logical :: used

    n = 0
    do i = 1, size(slots)
      used = slots(i)%task%uses(which)
      if (present(other)) used = used .or. slots(i)%task%uses(other)
      if (.not. used) cycle
      n = n + 1
      list(n) = i
    end do
    words = ''
    last = 0
    do i = 1, n
      word = slots(list(i))%info%name
      if (i > 1) word = ', '//slots(list(i))%info%name
      if (i > 1 .and. i == n) word = ' or '//slots(list(i))%info%name
      words(last + 1:last + len(word)) = word
      last = last + len_trim(word)
    end do
  end function sentence_of
end module gearsweep_study_case_task
