!> From a case to its results, stage by stage; a stage runs only when a wanted
!> result needs it, and its product is taken over where an earlier study has it of the same inputs.
module gearsweep_study
  use, intrinsic :: iso_c_binding, only: c_int, c_loc, c_null_ptr
  use gearsweep_blas, only: hold_blas, release_blas
  use gearsweep_case, only: case_t, speed_count, speeds
  use gearsweep_error, only: error_t
  use gearsweep_files, only: beside, read_text
  use gearsweep_inputs, only: body_inputs_t, choice_t, same, same_but_amounts, solid_inputs_t
  use gearsweep_key_names, only: name_key
  use gearsweep_kinds, only: dp
  use gearsweep_memory, only: claim_memory, release_claim
  use gearsweep_mesh_stage, only: mesh_and_motion
  use gearsweep_products, only: record_t, study_t
  use gearsweep_published, only: read_published
  use gearsweep_first_stages, only: build_pair
  use gearsweep_stages, only: points_of, runnable_t
  use gearsweep_stop, only: wants_stop
  use gearsweep_sweep_state, only: progress_of_sweep, untold
  use gearsweep_taken, only: has_begun, is_taken, take_up, taken_of, tell_taken
  use gearsweep_task, only: stage, task_info_t, task_slot_t
  use gearsweep_text, only: str
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
  !> What an `earlier` study has whole, made from the same inputs, is taken over; the result is the same bits. Without `is_told`,
  !> `watch` is for ending only, as of many runs.
  subroutine run_study(case, folder, threads, study, error, progress, watch, record, earlier, is_told)
    type(case_t), intent(in) :: case
    character(*), intent(in) :: folder
    integer, intent(in) :: threads
    type(study_t), intent(out) :: study
    type(error_t), allocatable, intent(out) :: error
    procedure(progress_of_sweep), optional :: progress
    integer(c_int), intent(inout), target, optional :: watch(3)
    type(record_t), intent(inout), target, optional :: record
    type(study_t), intent(in), target, optional :: earlier
    logical, intent(in), optional :: is_told

    allocate (study%running)
    study%running%threads = threads
    if (present(progress)) study%running%progress => progress
    study%running%log = ''
    if (present(is_told)) study%running%all_points = merge(0, untold, is_told)
    if (present(watch) .and. study%running%all_points == 0) watch(2:3) = 0
    if (present(record)) then
      if (taken_of(record, case) /= 'nothing') call study%running%note('resumed: '//trim(taken_of(record, case)))
      study%running%states => record%states
      call move_alloc(record%tasks, study%before)
    end if
    study%case = case
    study%tasks = case%tasks
    study%amount = case%amount
    study%material = case%material
    study%iso = case%iso
    study%member = case%member
    study%direction = case%direction
    study%accuracy = case%accuracy
    if (present(watch)) study%accuracy%steady%stop = c_loc(watch)
    call hold_blas()
    call claim_memory(0.0_dp, '&case tasks', error)
    if (.not. allocated(error)) call run_stages(study, folder, error, earlier)
    call name_key(error)
    call release_claim()
    call release_blas()
    if (present(record) .and. study%stopped) record%tasks = study%tasks
    if (allocated(study%before)) deallocate (study%before)
    study%log = study%running%log
    deallocate (study%running)
    study%accuracy%steady%stop = c_null_ptr
  end subroutine run_study

  !> The same, whatever BLAS does with threads.
  subroutine run_stages(study, folder, error, earlier)
    type(study_t), intent(inout) :: study
    character(*), intent(in) :: folder
    type(error_t), allocatable, intent(inout) :: error
    type(study_t), intent(in), target, optional :: earlier

    associate (case => study%case)
      if (allocated(case%published)) call find_published(study, folder, error)
      if (allocated(error)) return
      if (case%prescribed) then
        call study%running%note('geometry left out: the mesh is prescribed')
      else
        allocate (study%pair)
        call build_pair(case, study%pair, error)
        if (allocated(error)) return
        study%body_inputs = body_inputs_t(study%pair%gear(case%member), case%material(case%member), case%section)
        study%solid_inputs = solid_inputs_t(study%pair%gear(case%member), case%material(case%member), &
                                            case%iso%web_thickness(case%member), case%iso%rim_thickness(case%member))
      end if
      call read_files(study, folder, error)
      if (allocated(error)) return
      if (case%needs(stage%mesh)) then
        call mesh_and_motion(study, folder, error, earlier)
      else
        call study%running%note('mesh and motion left out: no task needs them')
      end if
    end associate
    if (.not. allocated(error)) call list_speeds(study, error)
    call run_tasks(study, error, earlier)
    if (.not. allocated(error)) call note_left_out(study)
  end subroutine run_stages

  !> The files of the tasks that the case names.
  subroutine read_files(study, folder, error)
    type(study_t), intent(inout) :: study
    character(*), intent(in) :: folder
    type(error_t), allocatable, intent(inout) :: error
    integer :: i, k

    do i = 1, size(study%tasks)
      associate (slot => study%tasks(i))
        if (.not. (slot%is_wanted .and. allocated(slot%task%files))) cycle
        do k = 1, size(slot%task%files)
          slot%task%files(k)%path = beside(folder, slot%task%files(k)%name)
          call read_text(slot%task%files(k)%path, slot%task%files(k)%text, error)
          if (allocated(error)) return
        end do
        select type (task => slot%task)
        class is (runnable_t)
          call task%take_files(study%stages_t, error)
        end select
        if (allocated(error)) return
      end associate
    end do
  end subroutine read_files

  !> The speeds of the sweep, and how many points there will be.
  subroutine list_speeds(study, error)
    type(study_t), intent(inout) :: study
    type(error_t), allocatable, intent(inout) :: error
    integer :: i

    allocate (study%rpm(0))
    if (study%case%needs(stage%speeds)) then
      call claim_memory(24.0_dp*speed_count(study%case), '&sweep: '//str(speed_count(study%case))//' speeds', error)
      if (allocated(error)) return
      study%rpm = speeds(study%case)
    end if
    do i = 1, size(study%tasks)
      associate (slot => study%tasks(i))
        if (.not. slot%is_wanted) cycle
        study%running%all_points = study%running%all_points + points_of(slot%task, study%stages_t)
      end associate
    end do
    call tell_taken(study)
  end subroutine list_speeds

  !> The tasks that the case names, and those that run for all, one after the other.
  subroutine run_tasks(study, error, earlier)
    type(study_t), intent(inout) :: study
    type(error_t), allocatable, intent(inout) :: error
    type(study_t), intent(in), target, optional :: earlier
    integer :: i, k

    do i = 1, size(study%tasks)
      if (allocated(error)) return
      associate (slot => study%tasks(i))
        if (.not. (slot%is_wanted .or. (slot%info%is_always .and. allocated(study%pair)))) cycle
        if (slot%takes(stage%body) .or. slot%takes(stage%solid) .or. slot%takes(stage%motion)) then
          if (.not. (is_taken(study, i) .or. has_begun(study, i))) then
            if (ends_here(study, slot%info)) cycle
          end if
        end if
      end associate
      call run_task(study, i, error, earlier)
      if (allocated(study%running%bodies) .and. .not. any([(study%tasks(k)%takes(stage%body), k=i + 1, size(study%tasks))])) &
        deallocate (study%running%bodies)
    end do
  end subroutine run_tasks

  !> Task number `i`, or what an earlier study has of it.
  subroutine run_task(study, i, error, earlier)
    type(study_t), intent(inout) :: study
    integer, intent(in) :: i
    type(error_t), allocatable, intent(inout) :: error
    type(study_t), intent(in), target, optional :: earlier
    logical :: known
    integer :: before, k

    associate (slot => study%tasks(i), running => study%running)
      before = running%done
      known = .false.
      nullify (running%earlier)
      if (present(earlier)) then
        known = is_known(study, earlier, i)
        if (earlier%tasks(i)%task%is_done) running%earlier => earlier%tasks(i)%task
      end if
      if (known) call take_over(earlier%tasks(i), slot, error)
      if (.not. known .and. is_taken(study, i)) then
        known = .true.
        call take_up(study%before(i)%task, slot%task)
        ! They were counted as the run began.
        if (slot%is_wanted) before = before - points_of(slot%task, study%stages_t)
      end if
      if (.not. known) then
        call slot%task%prepare()
        select type (task => slot%task)
        class is (runnable_t)
          call task%run(study%stages_t, error)
        end select
        ! Of columns that the memory did not hold.
        do k = 1, size(slot%task%tables)
          if (allocated(slot%task%tables(k)%error) .and. .not. allocated(error)) error = slot%task%tables(k)%error
        end do
      end if
      if (allocated(error)) return
      if (slot%task%is_done) then
        call running%note(slot%task%log//trim(merge(', taken over', '            ', known .or. slot%task%is_taken)))
        study%stopped = study%stopped .or. slot%task%is_stopped
        if (.not. slot%is_wanted .or. slot%task%is_stopped) return
        before = before + points_of(slot%task, study%stages_t)
        ! Of those that told nothing on their way, all points at once. What is taken over was told as the run began.
        if (.not. known) call running%tell(before - running%done, study%accuracy%steady%stop)
        running%done = before
      else
        study%stopped = .true.
        call running%note(trim(slot%info%name)//' left out: the run was interrupted')
      end if
    end associate
  end subroutine run_task

  !> Does the earlier study have this task whole, with the same keys and from the same products of all stages that it
  !> needs? What costs nothing is made anew.
  pure logical function is_known(study, earlier, i) result(known)
    type(study_t), intent(in) :: study, earlier
    integer, intent(in) :: i                     ! which task

    associate (slot => study%tasks(i), before => earlier%tasks(i))
      known = before%is_wanted .and. before%given == slot%given
      if (known) known = slot%takes(stage%mesh) .or. slot%takes(stage%body) .or. slot%takes(stage%solid)
      if (known) known = before%task%is_done .and. .not. before%task%is_stopped
      if (known) known = slot%task%has_same_files(before%task)
      if (known) known = same_gears(study, earlier, slot)
      if (known .and. slot%takes(stage%mesh)) known = same_but_amounts(study%motions_inputs, earlier%motions_inputs)
      if (known .and. slot%takes(stage%reliefs)) known = same(maxval(study%amount), maxval(earlier%amount))
      if (known .and. slot%takes(stage%amounts)) known = same(study%amount, earlier%amount)
      if (known .and. slot%takes(stage%accuracy)) known = same(choice_of(study), choice_of(earlier))
      if (known .and. slot%takes(stage%speeds)) known = same(study%rpm, earlier%rpm)
      if (known .and. slot%takes(stage%direction)) known = study%direction == earlier%direction
    end associate
  end function is_known

  !> Are the gears the same, as far as the task in this slot takes something of them beside the mesh?
  pure logical function same_gears(study, earlier, slot) result(known)
    type(study_t), intent(in) :: study, earlier
    type(task_slot_t), intent(in) :: slot

    known = .true.
    if (slot%takes(stage%body)) known = same(study%body_inputs, earlier%body_inputs)
    if (slot%takes(stage%solid)) known = known .and. same(study%solid_inputs, earlier%solid_inputs)
    associate (a => study%material, b => earlier%material)
      if (known .and. slot%takes(stage%elasticity)) known = same([a%young, a%poisson], [b%young, b%poisson])
      if (known .and. slot%takes(stage%density)) known = same([a%density], [b%density])
    end associate
    associate (a => study%iso, b => earlier%iso)
      if (known .and. slot%takes(stage%rims)) known = same([a%application_factor, a%rim_thickness], &
                                                       [b%application_factor, b%rim_thickness])
      if (known .and. slot%takes(stage%webs)) known = same([a%web_thickness], [b%web_thickness])
    end associate
  end function same_gears

  !> What the results at a speed depend on beside the oscillator.
  pure type(choice_t) function choice_of(study)
    type(study_t), intent(in) :: study

    choice_of = choice_t(steps=study%accuracy%step_choice_t, steady=study%accuracy%steady%steady_choice_t)
  end function choice_of

  !> The result of the same task, as it stands.
  subroutine take_over(before, slot, error)
    type(task_slot_t), intent(in) :: before
    type(task_slot_t), intent(inout) :: slot
    type(error_t), allocatable, intent(inout) :: error
    integer :: i

    call claim_memory(sum([(before%task%tables(i)%bytes(), i=1, size(before%task%tables))]), &
                      'the results of the task '//trim(slot%info%name), error)
    if (allocated(error)) return
    deallocate (slot%task)
    allocate (slot%task, source=before%task)
  end subroutine take_over

  subroutine note_left_out(study)
    type(study_t), intent(inout) :: study
    integer :: i

    associate (case => study%case, running => study%running)
      do i = 1, size(study%tasks)
        if (.not. (study%tasks(i)%is_wanted .or. study%tasks(i)%info%is_always)) &
          call running%note(trim(study%tasks(i)%info%name)//' left out: not among the tasks')
      end do
      if (case%needs(stage%motion) .and. case%friction <= 0) call running%note('friction left out: it is 0')
      if (case%needs(stage%motion) .and. .not. case%has_backlash) call running%note('coast side left out: no backlash given')
    end associate
  end subroutine note_left_out

  !> Did the caller end the run? Then the log says what comes no more.
  logical function ends_here(study, task)
    type(study_t), intent(inout) :: study
    type(task_info_t), intent(in) :: task

    ends_here = wants_stop(study%accuracy%steady%stop)
    if (ends_here) call study%running%note(trim(task%name)//' left out: the run was interrupted')
    study%stopped = study%stopped .or. ends_here
  end function ends_here

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
