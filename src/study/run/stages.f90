!> Products of the stages that several tasks use, the section of a gear among them, and the type of a task that can be run.
!>
!> A gear's section is stored, factored and solved for its modes once for all tasks that need it.
module gearsweep_study_run_stages
  use, intrinsic :: iso_c_binding, only: c_ptr
  use gearsweep_base, only: dp, error_t, piecewise_t, str
  use gearsweep_gear, only: pair_t
  use gearsweep_elastic, only: make_two_grids, material_t, modal_t, section_body_t, section_modes, teeth_t
  use gearsweep_face, only: face_load_t, face_mesh_t
  use gearsweep_mesh, only: iso_options_t, mesh_t
  use gearsweep_motion, only: accuracy_t, all_motions, both, counter_t, each, oscillator_t, progress_of_sweep, sweep_options_t
  use gearsweep_study_case_case, only: case_t, faces_t
  use gearsweep_study_case_published, only: published_t
  use gearsweep_study_case_task, only: stage, task_slot_t, task_t
  use gearsweep_study_run_inputs, only: body_inputs_t, elements_inputs_t, motions_inputs_t
  implicit none
  private
  public :: runnable_t, running_t, stages_t, points_of, study_t

  type :: gear_section_t
    type(section_body_t), allocatable :: bodies(:)  !< factored bodies on two grids
    type(modal_t), allocatable :: modal          !< the lowest modes, as many as the last task needed
    character(:), allocatable :: log             !< log of the study: stages that ran and those that did not, a line each
  contains
    procedure :: note, need_bodies, need_modes
  end type gear_section_t

  !> Data that exist only during a run.
  type, extends(gear_section_t) :: running_t
    integer :: threads = 0                       !< number of threads; 0: all of the machine
    procedure(progress_of_sweep), pointer, nopass :: progress => null()
    integer :: done = 0, all_points = 0          !< numbers of finished and of all operating points
    class(task_t), pointer :: earlier => null()  !< the same task of an earlier study, with its result
  contains
    procedure :: report_progress
  end type running_t

  !> Products of the stages that several tasks use. Products that no requested task needs are not allocated.
  type :: stages_t
    type(pair_t), allocatable :: pair            !< gear pair; none for a prescribed mesh
    type(material_t) :: material(2)              !< materials of pinion and gear
    type(iso_options_t) :: iso                   !< application factor and gear bodies for ISO 6336-1
    integer :: gear = 1                        !< gear whose section is analysed: 1 pinion, 2 gear
    type(body_inputs_t) :: body_inputs           !< inputs of its section
    type(body_inputs_t) :: solid_inputs          !< inputs of its body in three dimensions
    type(faces_t) :: faces                       !< how the faces meet: misalignment, leads, shaft of the pinion
    type(face_load_t), allocatable :: face_loads(:)        !< load over the face width with each relief
    type(face_mesh_t), allocatable :: face_mesh  !< mesh over the face width, without relief; not allocated where not used
    type(elements_inputs_t), allocatable :: elements_inputs  !< inputs of the pair stiffness, if it is by finite elements
    type(teeth_t) :: teeth                       !< teeth by finite elements: those of this pair, and some of earlier studies
    type(mesh_t), allocatable :: mesh            !< mesh without relief
    type(mesh_t), allocatable :: second_grid     !< mesh with the stiffness of another grid, if the task `mesh` compares both
    real(dp) :: base_pitch = 0                   !< base pitch, m; 0: not known of a prescribed mesh
    real(dp) :: load = 0                         !< static load on the line of action, N
    real(dp) :: mass(2) = 0                      !< effective masses of pinion and gear, kg
    real(dp) :: hub_mass(2) = 0                  !< part of these masses at the hubs, kg
    type(oscillator_t), allocatable :: motion(:)  !< oscillators, one for each relief; of parallel faces
    !> The same with the faces as they meet; not allocated where they are parallel, or no task has such a motion.
    type(oscillator_t), allocatable :: uneven_motion(:)
    type(piecewise_t), allocatable :: profile_error(:)     !< of helical gears, one for each relief, m over s
    type(motions_inputs_t) :: motions_inputs     !< inputs of the oscillators, and so of all later results but for the section's
    real(dp), allocatable :: torque(:)           !< torques of &load torques_nm, N m; not allocated: there is one load
    type(motions_inputs_t), allocatable :: of_torque(:)  !< the inputs `motions_inputs` for each torque
    real(dp), allocatable :: amount(:)           !< amounts of relief, m
    real(dp), allocatable :: rpm(:)              !< speeds of &sweep, 1/min, ascending; empty: not requested
    integer :: direction = both                  !< direction of a sweep through the speeds
    type(accuracy_t) :: accuracy                 !< accuracy of the motions, with the flag that ends the run
    type(running_t), pointer :: running => null()
  contains
    procedure :: sweep_options, has_corners, profile_error_of
  end type stages_t

  !> Products and results of a case; those that it did not request are not allocated.
  type, extends(stages_t) :: study_t
    type(case_t) :: case
    type(task_slot_t), allocatable :: tasks(:)   !< tasks with their results
    type(published_t), allocatable :: published(:)  !< printed values for comparison
    character(:), allocatable :: log             !< stages that ran and those that did not, a line each
    logical :: stopped = .false.                 !< true if the caller ended the run: some requested result is missing
  end type study_t

  !> Task that can be run.
  type, abstract, extends(task_t) :: runnable_t
  contains
    procedure(run_task), deferred :: run
    procedure :: parse_files => no_files
    procedure :: count_points
    procedure :: list_speeds, list_reliefs
  end type runnable_t

  abstract interface
    !> Computes the task's result from the products of the stages, and fills its tables.
    subroutine run_task(self, stages, error)
      import :: error_t, runnable_t, stages_t
      class(runnable_t), intent(inout) :: self
      type(stages_t), intent(in) :: stages
      type(error_t), allocatable, intent(inout) :: error
    end subroutine run_task
  end interface

contains

  !> Adds a line to the log.
  subroutine note(self, line)
    class(gear_section_t), intent(inout) :: self
    character(*), intent(in) :: line

    self%log = self%log//line//new_line('a')
  end subroutine note

  !> Builds the gear's bodies, factored on two grids, for all tasks that need them, unless they exist.
  subroutine need_bodies(self, inputs, error)
    class(gear_section_t), intent(inout) :: self
    type(body_inputs_t), intent(in) :: inputs
    type(error_t), allocatable, intent(inout) :: error

    if (allocated(self%bodies) .or. allocated(error)) return
    allocate (self%bodies(2))
    call make_two_grids(inputs%gear, inputs%material, inputs%options, self%bodies, error)
    call self%note('section: two grids made and factored')
  end subroutine need_bodies

  !> Computes the lowest `count` modes of the gear's section on two grids, unless exactly these exist.
  subroutine need_modes(self, inputs, count, error)
    class(gear_section_t), intent(inout) :: self
    type(body_inputs_t), intent(in) :: inputs
    integer, intent(in) :: count
    type(error_t), allocatable, intent(inout) :: error

    call self%need_bodies(inputs, error)
    if (allocated(error)) return
    if (allocated(self%modal)) then
      if (size(self%modal%modes%frequency) == count) return
      deallocate (self%modal)
    end if
    allocate (self%modal)
    call section_modes(self%bodies, count, self%modal, error)
    if (allocated(error)) then
      deallocate (self%modal)
    else
      call self%note('section: '//str(count)//' natural modes on both grids')
    end if
  end subroutine need_modes

  !> Parses the texts of the task's files, which the study has read, once the gears are known, so that a wrong file fails early.
  !> This default is for a task without files.
  subroutine no_files(self, stages, error)
    class(runnable_t), intent(inout) :: self
    type(stages_t), intent(in) :: stages         !< stages with the gears only
    type(error_t), allocatable, intent(inout) :: error

    ! Avoids a warning about unused arguments.
    if (.not. allocated(error) .and. stages%gear < 0) self%is_done = .false.
  end subroutine no_files

  !> Number of operating points of a task, for progress.
  integer function points_of(task, stages)
    class(task_t), intent(in) :: task
    type(stages_t), intent(in) :: stages

    points_of = 0
    select type (task)
    class is (runnable_t)
      points_of = task%count_points(stages)
    end select
  end function points_of

  !> Number of operating points, for progress: speeds times reliefs; 0 for tasks without a motion.
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

  !> Lists the speeds of the task (1/min).
  pure subroutine list_speeds(self, stages, rpm)
    class(runnable_t), intent(in) :: self
    type(stages_t), intent(in) :: stages
    real(dp), allocatable, intent(out) :: rpm(:)

    if (allocated(self%own_rpm)) rpm = self%own_rpm
    if (.not. allocated(self%own_rpm)) rpm = stages%rpm
  end subroutine list_speeds

  !> Lists the indices of the case's reliefs that the task uses.
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

  !> Options of a speed sweep.
  type(sweep_options_t) function sweep_options(self) result(options)
    class(stages_t), intent(in) :: self

    options%accuracy = self%accuracy
    options%direction = merge(each, self%direction, self%direction == all_motions)
    options%threads = self%running%threads
    options%done_before = self%running%done
    options%all_points = self%running%all_points
  end function sweep_options

  !> Profile error (m over s) of a pair with the relief of this index.
  pure type(piecewise_t) function profile_error_of(self, relief) result(curve)
    class(stages_t), intent(in) :: self
    integer, intent(in) :: relief

    if (allocated(self%profile_error)) then
      curve = self%profile_error(relief)
    else
      curve = self%motion(relief)%mesh%profile_error
    end if
  end function profile_error_of

  !> True if tip corners of the teeth may touch. A prescribed mesh has none, even if its tables extend beyond A and E.
  pure logical function has_corners(self)
    class(stages_t), intent(in) :: self
    integer :: i

    has_corners = .false.
    if (allocated(self%pair)) has_corners = any([(self%motion(i)%mesh%reaches_beyond(), i=1, size(self%motion))])
  end function has_corners

  !> Reports that `points` more operating points are finished; `stop` is the flag of the run, whose next numbers hold the count.
  subroutine report_progress(self, points, stop)
    class(running_t), intent(inout) :: self
    integer, intent(in) :: points
    type(c_ptr), intent(in) :: stop
    type(counter_t) :: counter

    self%done = self%done + points
    counter = counter_t(before=self%done, total=self%all_points, watch=stop)
    if (associated(self%progress)) counter%progress => self%progress
    call counter%tell()
  end subroutine report_progress
end module gearsweep_study_run_stages
