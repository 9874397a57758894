!> What a case knows of a task: the stages that it needs, the keys of its own group, and the tables that are its result. How it runs
!> is said by `runnable_t` (gearsweep_stages), which every task in src/tasks extends.
!>
!> As a case is read, each task takes its keys. In a run, a task that the case names gets the products of the stages
!> that it needs, and fills its tables: these are its result. Where an earlier study has it with the same keys and from
!> the same products, they are taken over.
module gearsweep_task
  use gearsweep_decimal, only: in_um
  use gearsweep_error, only: code_input, error_t, fail
  use gearsweep_grid, only: grid_t
  use gearsweep_kinds, only: dp
  use gearsweep_lines, only: lines_t
  use gearsweep_rack, only: gear_spec_t
  use gearsweep_reader, only: reader_t
  use gearsweep_table, only: table_t
  use gearsweep_text, only: str
  use gearsweep_uses, only: sentence_length
  implicit none
  private
  public :: task_t, task_info_t, task_slot_t, task_file_t, case_facts_t, check_reliefs, needs_moving, sentence_of, split_names

  integer, parameter, public :: task_length = 20, table_length = 18
  character(*), parameter, public :: members(2) = [character(6) :: 'pinion', 'gear']

  !> The stages and choices of a case that a result may depend on.
  type :: stage_names_t
    integer :: geometry                          !< gears, which a prescribed mesh has not
    integer :: section                           !< the section of one gear
    integer :: body                              !< the same held and factored, by finite elements
    integer :: solid                             !< the gear in three dimensions: teeth, bore, web and rim, with its material
    integer :: elasticity                        !< moduli and Poisson's ratios of the materials, whatever the mesh takes of them
    integer :: density                           !< their densities
    integer :: rims                              !< application factor and the gears' rims, whatever the mesh takes of them
    integer :: webs                              !< their webs
    integer :: mesh                              !< load, masses and stiffness
    integer :: reliefs                           !< the result depends on the relief
    integer :: amounts                           !< there is one result for each amount of relief
    integer :: motion                            !< the equation of motion, and so friction
    integer :: losses                            !< damping, and what follows once flanks part: backlash
    integer :: accuracy                          !< &numerics
    integer :: speeds                            !< those of &sweep
    integer :: direction                         !< in which the speeds are gone through
  end type stage_names_t

  !> Their numbers: `stage%mesh` is one of them.
  type(stage_names_t), parameter, public :: stage = stage_names_t(1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16)

  !> What they are called where a task is described.
  character(*), parameter, public :: stage_words(*) = [character(10) :: 'geometry', 'section', 'body', 'solid', 'elasticity', &
    'density', 'rims', 'webs', 'mesh', 'reliefs', 'amounts', 'motion', 'losses', 'accuracy', 'speeds', 'direction']

  !> What is said of a task.
  type :: task_info_t
    character(task_length) :: name = ''
    integer, allocatable :: needs(:)             !< of `stage`
    character(:), allocatable :: gives           !< what it computes, without a full stop
    character(:), allocatable :: tables          !< names of all tables that it can fill, blanks between them
    character(:), allocatable :: fields          !< the same of those whose rows are nodes or elements of a grid
    logical :: is_always = .false.               !< it runs for every case that has gears, named or not
  end type task_info_t

  !> What the other groups of a case say that a task's keys must agree with.
  type :: case_facts_t
    real(dp), allocatable :: amount(:)           !< of relief, m
    type(gear_spec_t) :: spec(2)                 !< of pinion and gear; without teeth where a prescribed mesh does not tell them
    integer :: scheme = 0                        !< of integration, of gearsweep_coefficient_table
  end type case_facts_t

  !> A file that a key of a task names. What stands in it is an input as the key is.
  type :: task_file_t
    character(:), allocatable :: name            !< as the case has it; a relative one lies beside the case
    character(:), allocatable :: path            !< where it was read, in a study
    character(:), allocatable :: text            !< what stood in it, in a study
  end type task_file_t

  !> A task with the values of its keys and, after its run, its result.
  type, abstract :: task_t
    integer :: needs(size(stage_words)) = 0      !< of `stage`, as its description says; the rest 0
    ! Keys that several tasks have, each in its own group:
    real(dp), allocatable :: own_rpm(:)          !< 1/min; not allocated: it takes the speeds of &sweep
    real(dp), allocatable :: own_relief(:)       !< m; not allocated: it takes all of the case
    type(task_file_t), allocatable :: files(:)   !< that its keys name; not allocated where none does
    ! Result:
    type(table_t), allocatable :: tables(:)      !< in the order of `describe`
    type(grid_t), allocatable :: grid            !< of those whose rows are nodes or elements
    logical :: is_done = .false.                 !< there is a result
    logical :: is_stopped = .false.              !< the caller ended the run: the result is not whole
    logical :: is_taken = .false.                !< what takes time is an earlier study's
    integer :: failed = 0                        !< operating points without a result
    character(:), allocatable :: log             !< what was done, a line without its end
  contains
    procedure(describe_task), deferred, nopass :: describe
    procedure :: read_keys => no_keys
    procedure(report_task), deferred :: add_report
    procedure :: check => check_reliefs
    procedure :: uses => uses_stage
    procedure :: has_same_files
    procedure :: prepare, place, read_speeds, read_reliefs
  end type task_t

  !> A task, and what the case at hand says of it.
  type :: task_slot_t
    type(task_info_t) :: info
    class(task_t), allocatable :: task
    logical :: is_wanted = .false.               !< by the case at hand
    character(:), allocatable :: given           !< what the case says of its keys, as text
  contains
    procedure :: takes
  end type task_slot_t

  abstract interface
    pure subroutine describe_task(info)
      import :: task_info_t
      type(task_info_t), intent(out) :: info
    end subroutine describe_task

    !> Some lines for the screen, from the tables.
    pure subroutine report_task(self, lines)
      import :: lines_t, task_t
      class(task_t), intent(in) :: self
      type(lines_t), intent(inout) :: lines
    end subroutine report_task
  end interface

contains

  !> Adds the groups of its keys and takes these, whether the case names the task or not; this one has none.
  subroutine no_keys(self, reader, error)
    class(task_t), intent(inout) :: self
    type(reader_t), intent(inout) :: reader
    type(error_t), allocatable, intent(inout) :: error

    ! The compiler asks for some use of the arguments.
    if (.not. allocated(error) .and. reader%wants('')) self%is_done = .false.
  end subroutine no_keys

  !> Does it need this stage, as its keys are? Speeds of its own make those of &sweep idle.
  pure logical function uses_stage(self, which) result(uses)
    class(task_t), intent(in) :: self
    integer, intent(in) :: which                 !< of `stage`

    uses = any(self%needs == which) .and. .not. (which == stage%speeds .and. allocated(self%own_rpm))
  end function uses_stage

  !> Stands the same in its files as in those of the other, which has the same keys?
  pure logical function has_same_files(self, other) result(same)
    class(task_t), intent(in) :: self, other
    integer :: i

    same = allocated(self%files) .eqv. allocated(other%files)
    if (.not. (same .and. allocated(self%files))) return
    same = size(self%files) == size(other%files)
    do i = 1, merge(size(self%files), 0, same)
      ! Fortran takes texts for the same that differ in blanks at their ends.
      same = same .and. len(self%files(i)%text) == len(other%files(i)%text) .and. self%files(i)%text == other%files(i)%text
    end do
  end function has_same_files

  !> Before its run: its tables, which are not there yet, have their names.
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

  !> Of the table with this name among its own; 0 where it has none.
  pure integer function place(self, name) result(at)
    class(task_t), intent(in) :: self
    character(*), intent(in) :: name

    do at = size(self%tables), 1, -1
      if (self%tables(at)%name == name) exit
    end do
  end function place

  !> Does a task with these `needs` need this stage, which takes the load of the motion only sometimes: when it does not (`moving`),
  !> nothing of the motion counts.
  pure logical function needs_moving(needs, which, moving)
    integer, intent(in) :: needs(:), which       !< of `stage`
    logical, intent(in) :: moving

    needs_moving = any(needs == which) .and. (moving .or. .not. any([stage%motion, stage%losses, stage%accuracy] == which))
  end function needs_moving

  !> The words of a list with blanks between them.
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

  !> The key `rpm` of the group that is called as the task. `order`: what is said of their order; without, they must
  !> ascend.
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
                    max_size=most, distinct=.true., otherwise='those of &sweep', meaning=meaning)
    if (present(order) .or. .not. allocated(self%own_rpm)) return
    do i = 2, size(self%own_rpm)
      if (self%own_rpm(i) <= self%own_rpm(i - 1)) call fail(error, code_input, '&'//group//' rpm: must ascend; '// &
        str(self%own_rpm(i))//' comes after '//str(self%own_rpm(i - 1)))
    end do
  end subroutine read_speeds

  !> The key `relief_um` of the group that is called as the task.
  subroutine read_reliefs(self, reader, group, error)
    class(task_t), intent(inout) :: self
    type(reader_t), intent(inout) :: reader
    character(*), intent(in) :: group
    type(error_t), allocatable, intent(inout) :: error

    call reader%get(group, 'relief_um', self%own_relief, error, unit='um', tasks=group, at_least=0.0_dp, at_most=1e9_dp, &
                    max_size=10000, distinct=.true., otherwise='all of &relief amount_um', &
                    meaning='amounts of tip relief to take, each of which &relief amount_um has')
  end subroutine read_reliefs

  !> Its keys beside the reliefs of the case: those that it takes must be among these.
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
        '&'//trim(info%name)//' relief_um = '//str(in_um(self%own_relief(i)))//': is none of &relief amount_um')
    end do
  end subroutine check_reliefs

  !> Does the case at hand name this task, and needs it this stage?
  pure logical function takes(self, which)
    class(task_slot_t), intent(in) :: self
    integer, intent(in) :: which                 !< of `stage`

    takes = self%is_wanted .and. self%task%uses(which)
  end function takes

  !> The tasks that need this stage, or this other one, as in `load, sweep or optimum`.
  pure function sentence_of(slots, which, other) result(words)
    type(task_slot_t), intent(in) :: slots(:)
    integer, intent(in) :: which                 !< of `stage`
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
end module gearsweep_task
