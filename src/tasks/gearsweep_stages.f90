!> What a task runs on: products of the stages that several tasks share, and a task that can be run.
module gearsweep_stages
  use, intrinsic :: iso_c_binding, only: c_ptr
  use gearsweep_error, only: error_t
  use gearsweep_inputs, only: body_inputs_t, elements_inputs_t, motions_inputs_t, solid_inputs_t
  use gearsweep_kinds, only: dp
  use gearsweep_material, only: material_t
  use gearsweep_member_section, only: member_section_t
  use gearsweep_mesh, only: mesh_t
  use gearsweep_oscillator, only: oscillator_t
  use gearsweep_pair, only: pair_t
  use gearsweep_steady_motion, only: accuracy_t
  use gearsweep_stiffness, only: iso_options_t
  use gearsweep_sweep_state, only: all_motions, both, counter_t, each, progress_of_sweep, sweep_options_t, sweep_state_t
  use gearsweep_task, only: stage, task_t
  use gearsweep_teeth, only: teeth_t
  implicit none
  private
  public :: runnable_t, running_t, stages_t, points_of

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
    type(teeth_t) :: teeth                       !< by finite elements: those of this pair, and some of earlier studies
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
    procedure :: sweep_options, has_corners
  end type stages_t

  !> A task that runs.
  type, abstract, extends(task_t) :: runnable_t
  contains
    procedure(run_task), deferred :: run
    procedure :: take_files => no_files
    procedure :: count_points
    procedure :: list_speeds, list_reliefs
  end type runnable_t

  abstract interface
    !> Computes the result from what the stages have, and fills the tables.
    subroutine run_task(self, stages, error)
      import :: error_t, runnable_t, stages_t
      class(runnable_t), intent(inout) :: self
      type(stages_t), intent(in) :: stages
      type(error_t), allocatable, intent(inout) :: error
    end subroutine run_task
  end interface

contains

  !> Takes what it needs of the texts of its files, which the study has read, with the gears at hand: so that a wrong file costs no
  !> time. This one has none.
  subroutine no_files(self, stages, error)
    class(runnable_t), intent(inout) :: self
    type(stages_t), intent(in) :: stages         !< with the gears only
    type(error_t), allocatable, intent(inout) :: error

    ! The compiler asks for some use of the arguments.
    if (.not. allocated(error) .and. stages%member < 0) self%is_done = .false.
  end subroutine no_files

  !> How many operating points a task solves, for progress.
  integer function points_of(task, stages)
    class(task_t), intent(in) :: task
    type(stages_t), intent(in) :: stages

    points_of = 0
    select type (task)
    class is (runnable_t)
      points_of = task%count_points(stages)
    end select
  end function points_of

  !> How many operating points it solves, for progress: speeds times reliefs, of tasks without a motion none.
  integer function count_points(self, stages) result(points)
    class(runnable_t), intent(in) :: self
    type(stages_t), intent(in) :: stages
    real(dp), allocatable :: rpm(:)
    integer, allocatable :: which(:)

    points = 0
    if (.not. self%uses(stage%motion)) return
    call self%list_speeds(stages, rpm)
    call self%list_reliefs(stages, which)
    points = size(rpm)*merge(size(which), 1, self%uses(stage%amounts))
  end function count_points

  !> The speeds that it takes (1/min).
  pure subroutine list_speeds(self, stages, rpm)
    class(runnable_t), intent(in) :: self
    type(stages_t), intent(in) :: stages
    real(dp), allocatable, intent(out) :: rpm(:)

    if (allocated(self%own_rpm)) rpm = self%own_rpm
    if (.not. allocated(self%own_rpm)) rpm = stages%rpm
  end subroutine list_speeds

  !> Which of the case's reliefs it takes.
  pure subroutine list_reliefs(self, stages, which)
    class(runnable_t), intent(in) :: self
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
end module gearsweep_stages
