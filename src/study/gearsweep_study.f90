!> From a case to its results, stage by stage; a stage runs only when a wanted
!> result needs it, and its product is taken over where an earlier study has it of the same inputs.
module gearsweep_study
  use, intrinsic :: iso_c_binding, only: c_int, c_loc
  use gearsweep_blas, only: hold_blas, release_blas
  use gearsweep_body_stage, only: look_at_body
  use gearsweep_case, only: case_t, speeds
  use gearsweep_error, only: error_t
  use gearsweep_files, only: beside, read_text
  use gearsweep_kinds, only: dp
  use gearsweep_memory, only: claim_memory, settle_memory
  use gearsweep_mesh_stage, only: mesh_and_motion
  use gearsweep_motion_stage, only: move
  use gearsweep_products, only: ends_here, note, record_t, study_t
  use gearsweep_published, only: read_published
  use gearsweep_stages, only: build_pair
  use gearsweep_sweep, only: progress_of_sweep, sweep_options_t
  implicit none
  private
  public :: study_t, run_study, record_t

contains

  !> Runs what the case's tasks need. `folder` is where its files lie, with the
  !> slash; `threads` 0 takes all. Any number of callers at once.
  !>
  !> `watch(1)` not 0 ends the run soon, whoever sets it: another thread, a signal, `progress`; what is done by then is
  !> in the study, and points that are not have the status `stopped`. `watch(2)` and `watch(3)` tell how many operating
  !> points are done, of how many. With the `record` of a run that was ended, the next one takes over what was done.
  !> What an `earlier` study has whole, made from the same inputs, is taken over; the result is the same bits.
  subroutine run_study(case, folder, threads, study, error, progress, watch, record, earlier)
    type(case_t), intent(in) :: case
    character(*), intent(in) :: folder
    integer, intent(in) :: threads
    type(study_t), intent(out) :: study
    type(error_t), allocatable, intent(out) :: error
    procedure(progress_of_sweep), optional :: progress
    integer(c_int), intent(inout), target, optional :: watch(3)
    type(record_t), intent(inout), optional :: record
    type(study_t), intent(in), optional :: earlier
    type(sweep_options_t) :: options

    options%threads = threads
    if (present(watch)) options%accuracy%steady%stop = c_loc(watch)
    call hold_blas()
    call claim_memory(0.0_dp, '&case tasks', error)
    if (.not. allocated(error)) call run_stages(case, folder, options, study, error, progress, record, earlier)
    call settle_memory()
    call release_blas()
  end subroutine run_study

  !> The same, whatever BLAS does with threads.
  subroutine run_stages(case, folder, options, study, error, progress, record, earlier)
    type(case_t), intent(in) :: case
    character(*), intent(in) :: folder
    type(sweep_options_t), intent(inout) :: options
    type(study_t), intent(inout) :: study
    type(error_t), allocatable, intent(inout) :: error
    procedure(progress_of_sweep), optional :: progress
    type(record_t), intent(inout), optional :: record
    type(study_t), intent(in), optional :: earlier

    study%case = case
    study%tasks = case%tasks
    study%amount = case%amount
    study%accuracy = case%accuracy
    study%accuracy%steady%stop = options%accuracy%steady%stop
    study%threads = options%threads
    study%log = ''
    if (allocated(case%published)) call find_published(study, folder, error)
    if (allocated(error)) return
    if (case%prescribed) then
      call note(study, 'geometry left out: the mesh is prescribed')
    else
      allocate (study%pair)
      call build_pair(case, study%pair, error)
      call note(study, 'geometry: pair built')
    end if
    if (allocated(error)) return
    if (case%needs_load()) then
      call mesh_and_motion(study, folder, error, earlier)
    else
      call note(study, 'mesh and motion left out: no task needs them')
    end if
    if (allocated(error)) return
    if (case%needs_section()) then
      if (ends_here(study, options, 'section')) return
      call look_at_body(study, error, earlier)
    end if
    if (allocated(error) .or. .not. case%needs_load()) return
    if (case%needs_motion()) then
      if (ends_here(study, options, 'motion')) return
      call move(study, options, error, progress, record, earlier)
      if (.not. allocated(error)) call run_tasks(study, options, error)
    end if
    call note_left_out(study)
  end subroutine run_stages

  !> The tasks that are one file each.
  subroutine run_tasks(study, options, error)
    type(study_t), intent(inout) :: study
    type(sweep_options_t), intent(in) :: options
    type(error_t), allocatable, intent(inout) :: error
    integer :: i

    if (study%case%needs('speeds')) study%rpm = speeds(study%case)
    do i = 1, size(study%tasks)
      if (.not. study%tasks(i)%is_wanted .or. .not. allocated(study%tasks(i)%task)) cycle
      if (ends_here(study, options, trim(study%tasks(i)%info%name))) cycle
      call study%tasks(i)%task%run(study%stages_t, error)
      if (allocated(error)) return
      if (study%tasks(i)%task%is_done) then
        call note(study, study%tasks(i)%task%log)
      else
        study%stopped = ends_here(study, options, trim(study%tasks(i)%info%name))
      end if
    end do
  end subroutine run_tasks

  subroutine note_left_out(study)
    type(study_t), intent(inout) :: study
    integer :: i

    associate (case => study%case)
      if (.not. case%asks('mesh')) call note(study, 'static load sharing left out: not among the tasks')
      if (.not. case%asks('load')) call note(study, 'pair loads along the path left out: not among the tasks')
      if (.not. case%asks('sweep')) call note(study, 'sweep left out: not among the tasks')
      if (.not. case%asks('optimum')) call note(study, 'optimum relief left out: not among the tasks')
      do i = 1, size(study%tasks)
        if (allocated(study%tasks(i)%task) .and. .not. study%tasks(i)%is_wanted) &
          call note(study, trim(study%tasks(i)%info%name)//' left out: not among the tasks')
      end do
      if (case%needs_motion() .and. case%friction <= 0) call note(study, 'friction left out: it is 0')
      if (case%needs_motion() .and. .not. case%has_backlash) call note(study, 'coast side left out: no backlash given')
    end associate
  end subroutine note_left_out

  !> First of all, so that a wrong file costs no time.
  subroutine find_published(study, folder, error)
    type(study_t), intent(inout) :: study
    character(*), intent(in) :: folder
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: path, text

    path = beside(folder, study%case%published)
    call read_text(path, text, error)
    if (.not. allocated(error)) call read_published(path, text, study%published, error)
  end subroutine find_published
end module gearsweep_study
