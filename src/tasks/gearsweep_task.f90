!> What a task of a case is. A task is one file that extends `task_t`: what it needs, the keys of its own group, how it
!> runs and what it says on the screen. One line in gearsweep_tasks lists it.
!>
!> As a case is read, each task takes its keys. In a run, a task that the case names gets the products of the stages
!> that it needs, and fills its tables: these are its result. Where an earlier study has it with the same keys and from
!> the same products, they are taken over.
module gearsweep_task
  use, intrinsic :: iso_c_binding, only: c_ptr
  use gearsweep_attractor_search, only: attractor_options_t
  use gearsweep_attractors, only: largest_motion
  use gearsweep_decimal, only: in_um
  use gearsweep_error, only: code_input, error_t, fail
  use gearsweep_error_estimate, only: accuracy_t, point_t
  use gearsweep_grid, only: grid_t
  use gearsweep_inputs, only: body_inputs_t, elements_inputs_t, motions_inputs_t, solid_inputs_t
  use gearsweep_kinds, only: dp
  use gearsweep_lines, only: lines_t
  use gearsweep_material, only: material_t
  use gearsweep_member_section, only: member_section_t
  use gearsweep_mesh, only: mesh_t
  use gearsweep_oscillator, only: mesh_period, oscillator_t
  use gearsweep_pair, only: pair_t
  use gearsweep_reader, only: reader_t
  use gearsweep_response, only: find_response, response_t
  use gearsweep_sweep_state, only: all_motions, both, counter_t, each, progress_of_sweep, sweep_options_t, sweep_state_t
  use gearsweep_stiffness, only: iso_options_t
  use gearsweep_table, only: table_t
  use gearsweep_text, only: str
  implicit none
  private
  public :: task_t, task_info_t, stages_t, running_t, check_reliefs, includes, includes_if_moving, split_names

  integer, parameter, public :: task_length = 20, table_length = 18
  character(*), parameter, public :: members(2) = [character(6) :: 'pinion', 'gear']

  !> What there is only while a study is made.
  type, extends(member_section_t) :: running_t
    integer :: threads = 0                       !< 0: as many as the machine has
    procedure(progress_of_sweep), pointer, nopass :: progress => null()
    integer :: done = 0, all_points = 0          !< operating points, for progress
    type(sweep_state_t), pointer :: states(:) => null()  !< how far the sweeps were when a run was ended
    class(task_t), pointer :: earlier => null()  !< the same task of an earlier study, with its result
  contains
    procedure :: tell
  end type running_t

  !> Products of the stages that several tasks share. Those that no wanted task needs are not allocated.
  type :: stages_t
    type(pair_t), allocatable :: pair            !< none for a prescribed mesh
    type(material_t) :: material(2)              !< of pinion and gear
    type(iso_options_t) :: iso                   !< application factor and the gears' blanks
    integer :: member = 1                        !< the gear whose body is looked at: 1 pinion, 2 gear
    type(body_inputs_t) :: body_inputs           !< of that body
    type(solid_inputs_t) :: solid_inputs         !< of the same in three dimensions
    type(elements_inputs_t), allocatable :: elements_inputs  !< of the pair stiffness, where that is by finite elements
    type(mesh_t), allocatable :: mesh            !< without relief
    real(dp) :: base_pitch = 0                   !< m; 0: not known of a prescribed mesh
    real(dp) :: load = 0                         !< static load on the line of action, N
    real(dp) :: mass(2) = 0                      !< effective masses, kg
    real(dp) :: hub_mass(2) = 0                  !< what of these sits at the hubs, kg
    type(oscillator_t), allocatable :: motion(:)  !< one for each relief
    type(motions_inputs_t) :: motions_inputs     !< of these, and so of all that follows but for the section
    real(dp), allocatable :: amount(:)           !< the reliefs, m
    real(dp), allocatable :: rpm(:)              !< speeds of &sweep, 1/min, ascending; empty: not wanted
    integer :: direction = both                  !< in which a sweep goes through them
    type(accuracy_t) :: accuracy                 !< with the flag that ends the run
    type(running_t), pointer :: running => null()
  contains
    procedure :: sweep_options, find_point, find_motion, has_corners
  end type stages_t

  !> What is said of a task. `needs` names stages, blanks between them:
  !>   geometry  gears, which a prescribed mesh has not
  !>   section   the section of one gear
  !>   body      the same held and factored, by finite elements
  !>   solid     the gear in three dimensions: teeth, bore, web and rim, with its material
  !>   elasticity  the moduli and Poisson's ratios of the materials, whatever the mesh takes of them
  !>   density   their densities
  !>   rims      application factor and the gears' rims, whatever the mesh takes of them
  !>   webs      their webs
  !>   mesh      load, masses and stiffness
  !>   reliefs   the result depends on the relief
  !>   amounts   there is one result for each amount of relief
  !>   motion    the equation of motion, and so friction
  !>   losses    damping, and what follows once flanks part: backlash
  !>   accuracy  &numerics
  !>   speeds    those of &sweep
  !>   direction  in which the speeds are gone through
  type :: task_info_t
    character(task_length) :: name = ''
    character(:), allocatable :: needs
    character(:), allocatable :: gives           !< what it computes, without a full stop
    character(:), allocatable :: tables          !< names of all tables that it can fill, blanks between them
    character(:), allocatable :: fields          !< the same of those whose rows are nodes or elements of a grid
    logical :: is_always = .false.               !< it runs for every case that has gears, named or not
  end type task_info_t

  !> A task with the values of its keys and, after its run, its result.
  type, abstract :: task_t
    ! Keys that several tasks have, each in its own group:
    real(dp), allocatable :: own_rpm(:)          !< 1/min; not allocated: it takes the speeds of &sweep
    real(dp), allocatable :: own_relief(:)       !< m; not allocated: it takes all of the case
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
    procedure(run_task), deferred :: run
    procedure(report_task), deferred :: add_report
    procedure :: check => check_reliefs
    procedure :: uses => uses_stage
    procedure :: count_points
    procedure :: prepare, place, read_speeds, read_reliefs, list_speeds, list_reliefs
  end type task_t

  abstract interface
    pure subroutine describe_task(info)
      import :: task_info_t
      type(task_info_t), intent(out) :: info
    end subroutine describe_task

    !> Computes the result from what the stages have, and fills the tables.
    subroutine run_task(self, stages, error)
      import :: error_t, stages_t, task_t
      class(task_t), intent(inout) :: self
      type(stages_t), intent(in) :: stages
      type(error_t), allocatable, intent(inout) :: error
    end subroutine run_task

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
  pure logical function uses_stage(self, stage) result(uses)
    class(task_t), intent(in) :: self
    character(*), intent(in) :: stage
    type(task_info_t) :: info

    call self%describe(info)
    uses = includes(info%needs, stage) .and. .not. (stage == 'speeds' .and. allocated(self%own_rpm))
  end function uses_stage

  !> How many operating points it solves, for progress: speeds times reliefs, of tasks without a motion none.
  integer function count_points(self, stages) result(points)
    class(task_t), intent(in) :: self
    type(stages_t), intent(in) :: stages
    real(dp), allocatable :: rpm(:)
    integer, allocatable :: which(:)

    points = 0
    if (.not. self%uses('motion')) return
    call self%list_speeds(stages, rpm)
    call self%list_reliefs(stages, which)
    points = size(rpm)*merge(size(which), 1, self%uses('amounts'))
  end function count_points

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

  !> Does a task with these `needs` need this stage?
  pure logical function includes(needs, stage)
    character(*), intent(in) :: needs, stage

    includes = index(' '//needs//' ', ' '//stage//' ') > 0
  end function includes

  !> The same of a task that takes the load of the motion only sometimes: when it does not (`moving`), nothing of the motion counts.
  pure logical function includes_if_moving(needs, stage, moving) result(includes_it)
    character(*), intent(in) :: needs, stage
    logical, intent(in) :: moving

    includes_it = includes(needs, stage)
    if (.not. moving) includes_it = includes_it .and. .not. includes('motion losses accuracy', stage)
  end function includes_if_moving

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

  !> Its keys beside the reliefs of the case, `amount` (m): those that it takes must be among these.
  subroutine check_reliefs(self, amount, error)
    class(task_t), intent(in) :: self
    real(dp), intent(in) :: amount(:)
    type(error_t), allocatable, intent(inout) :: error
    type(task_info_t) :: info
    integer :: i

    if (.not. allocated(self%own_relief)) return
    call self%describe(info)
    do i = 1, size(self%own_relief)
      if (minval(abs(amount - self%own_relief(i))) > 1e-9_dp*self%own_relief(i)) call fail(error, code_input, &
        '&'//trim(info%name)//' relief_um = '//str(in_um(self%own_relief(i)))//': is none of &relief amount_um')
    end do
  end subroutine check_reliefs

  !> The speeds that it takes (1/min).
  pure subroutine list_speeds(self, stages, rpm)
    class(task_t), intent(in) :: self
    type(stages_t), intent(in) :: stages
    real(dp), allocatable, intent(out) :: rpm(:)

    if (allocated(self%own_rpm)) rpm = self%own_rpm
    if (.not. allocated(self%own_rpm)) rpm = stages%rpm
  end subroutine list_speeds

  !> Which of the case's reliefs it takes.
  pure subroutine list_reliefs(self, stages, which)
    class(task_t), intent(in) :: self
    type(stages_t), intent(in) :: stages
    integer, allocatable, intent(out) :: which(:)
    integer :: i

    if (allocated(self%own_relief)) then
      which = [(minloc(abs(stages%amount - self%own_relief(i)), 1), i=1, size(self%own_relief))]
    else
      which = [(i, i=1, size(stages%amount))]
    end if
  end subroutine list_reliefs

  !> How speeds are swept.
  type(sweep_options_t) function sweep_options(self) result(options)
    class(stages_t), intent(in) :: self

    options%accuracy = self%accuracy
    options%direction = merge(each, self%direction, self%direction == all_motions)
    options%threads = self%running%threads
    options%done_before = self%running%done
    options%all_points = self%running%all_points
  end function sweep_options

  !> The operating point at a speed (1/min): of the motions that attract there, the one of largest dynamic factor that a start
  !> reaches. So it depends on the case alone, and not on how a sweep comes to this speed.
  subroutine find_point(self, motion, rpm, point, motions, lacks)
    class(stages_t), intent(in) :: self
    type(oscillator_t), intent(in) :: motion
    real(dp), intent(in) :: rpm
    type(point_t), intent(out) :: point
    integer, intent(out) :: motions              !< how many there are; 0: not known
    logical, intent(out) :: lacks                !< the memory does not hold it

    call largest_motion(motion, mesh_period(motion%mesh%teeth(1), rpm), attractor_options_t(self%accuracy), point, motions, lacks)
  end subroutine find_point

  !> The same, followed over the path of contact.
  subroutine find_motion(self, motion, rpm, response, motions, harmonics)
    class(stages_t), intent(in) :: self
    type(oscillator_t), intent(in) :: motion
    real(dp), intent(in) :: rpm
    type(response_t), intent(out) :: response
    integer, intent(out) :: motions              !< how many there are; 0: not known
    integer, intent(in), optional :: harmonics   !< with it there is a summary, with so many of the mesh frequency
    type(point_t) :: point
    logical :: lacks

    call self%find_point(motion, rpm, point, motions, lacks)
    if (.not. lacks) call find_response(motion, rpm, self%accuracy, response, point, harmonics)
    response%lacks = response%lacks .or. lacks
  end subroutine find_motion

  !> May tip corners of the teeth touch? A prescribed mesh has none, whatever its tables say beyond A and E.
  pure logical function has_corners(self)
    class(stages_t), intent(in) :: self
    integer :: i

    has_corners = .false.
    if (allocated(self%pair)) has_corners = any([(self%motion(i)%mesh%reaches_beyond(), i=1, size(self%motion))])
  end function has_corners

  !> So many operating points more are done; `stop` is the flag of the run, where the count is told too.
  subroutine tell(self, points, stop)
    class(running_t), intent(inout) :: self
    integer, intent(in) :: points
    type(c_ptr), intent(in) :: stop
    type(counter_t) :: counter

    self%done = self%done + points
    counter = counter_t(before=self%done, total=self%all_points, watch=stop)
    if (associated(self%progress)) counter%progress => self%progress
    call counter%tell()
  end subroutine tell
end module gearsweep_task
