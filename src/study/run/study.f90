!> A study: from a case to its results, stage by stage. A stage runs only if a requested result needs it; products of an earlier
!> study with the same inputs are reused.
module gearsweep_study_run_study
  use, intrinsic :: iso_c_binding, only: c_int, c_loc, c_null_ptr
  use gearsweep_base, only: claim_memory, dp, error_t, hold_blas, release_blas, release_claim, str, wants_stop
  use gearsweep_gear, only: drive, gear_t
  use gearsweep_elastic, only: material_t
  use gearsweep_face, only: shaft_t
  use gearsweep_motion, only: progress_of_sweep, untold
  use gearsweep_study_case_case, only: case_t, speed_count, speeds
  use gearsweep_study_case_key_names, only: name_key
  use gearsweep_study_case_published, only: read_published
  use gearsweep_study_case_task, only: stage, task_info_t, task_slot_t
  use gearsweep_study_run_face_stage, only: build_face_motions, build_faces, find_face_loads
  use gearsweep_study_run_files, only: path_in, read_text
  use gearsweep_study_run_inputs, only: body_inputs_t, choice_t, same, same_but_amounts
  use gearsweep_study_run_mesh_stage, only: build_pair, mesh_and_motion
  use gearsweep_study_run_stages, only: points_of, runnable_t, study_t
  implicit none
  private
  public :: study_t, run_study

contains

  !> Runs the stages and tasks of a case. `folder`: of its files, with the slash; `threads`: 0 uses all. Any number of callers at
  !> once.
  !>
  !> `watch(1)` not 0 ends the run soon, whoever sets it: another thread, a signal or `progress`. The study then holds the finished
  !> results; unfinished points have the status `stopped`. `watch(2)` and `watch(3)` report the numbers of finished and of all
  !> operating points. Complete results of an `earlier` study with the same inputs are reused, with the same bits. Without
  !> `has_progress`, `watch` only ends the run, as one of many.
  subroutine run_study(case, folder, threads, study, error, progress, watch, earlier, has_progress)
    type(case_t), intent(in) :: case
    character(*), intent(in) :: folder
    integer, intent(in) :: threads
    type(study_t), intent(out) :: study
    type(error_t), allocatable, intent(out) :: error
    procedure(progress_of_sweep), optional :: progress
    integer(c_int), intent(inout), target, optional :: watch(3)
    type(study_t), intent(in), target, optional :: earlier
    logical, intent(in), optional :: has_progress

    allocate (study%running)
    study%running%threads = threads
    if (present(progress)) study%running%progress => progress
    study%running%log = ''
    if (present(has_progress)) study%running%all_points = merge(0, untold, has_progress)
    if (present(watch) .and. study%running%all_points == 0) watch(2:3) = 0
    study%case = case
    study%tasks = case%tasks
    study%amount = case%amount
    study%material = case%material
    study%iso = case%iso
    study%gear = case%gear
    study%direction = case%direction
    study%accuracy = case%accuracy
    if (present(watch)) study%accuracy%steady%stop = c_loc(watch)
    call hold_blas()
    call claim_memory(0.0_dp, '&case tasks', error)
    if (.not. allocated(error)) call run_stages(study, folder, error, earlier)
    call name_key(error)
    call release_claim()
    call release_blas()
    study%log = study%running%log
    deallocate (study%running)
    study%accuracy%steady%stop = c_null_ptr
  end subroutine run_study

  !> Runs all stages on the calling thread, whatever the threads of BLAS.
  subroutine run_stages(study, folder, error, earlier)
    type(study_t), intent(inout) :: study
    character(*), intent(in) :: folder
    type(error_t), allocatable, intent(inout) :: error
    type(study_t), intent(in), target, optional :: earlier
    character(:), allocatable :: path, text
    integer :: i

    associate (case => study%case)
      if (allocated(case%published)) then
        ! Read first, so that a wrong file fails before anything is computed.
        path = path_in(folder, case%published)
        call read_text(path, text, error)
        if (.not. allocated(error)) call read_published(path, text, study%published, error)
      end if
      if (allocated(error)) return
      if (case%prescribed) then
        call study%running%note('geometry left out: the mesh is prescribed')
      else
        allocate (study%pair)
        call build_pair(case, study%pair, error)
        if (allocated(error)) return
        study%body_inputs = body_inputs_t(study%pair%gear(case%gear), case%material(case%gear), case%section)
        study%solid_inputs = body_inputs_t(study%pair%gear(case%gear), case%material(case%gear), &
                                           web=case%iso%web_thickness(case%gear), rim=case%iso%rim_thickness(case%gear))
        study%faces = case%faces
        call complete_shaft(study%pair%gear(1), case%material(1), study%faces%shaft)
      end if
      call read_files(study, folder, error)
      if (allocated(error)) return
      if (case%needs(stage%mesh)) then
        call mesh_and_motion(study, folder, error, earlier)
        call run_faces(study, error)
      else
        call study%running%note('mesh and motion left out: no task needs them')
      end if
    end associate
    if (.not. allocated(error)) then
      allocate (study%rpm(0))
      if (study%case%needs(stage%speeds)) then
        call claim_memory(24.0_dp*speed_count(study%case), '&sweep: '//str(speed_count(study%case))//' speeds', error)
        if (allocated(error)) return
        study%rpm = speeds(study%case)
      end if
      do i = 1, size(study%tasks)
        if (study%tasks(i)%is_requested) &
          study%running%all_points = study%running%all_points + points_of(study%tasks(i)%task, study%stages_t)
      end do
    end if
    call run_tasks(study, error, earlier)
    if (allocated(error)) return
    associate (case => study%case, running => study%running)
      do i = 1, size(study%tasks)
        if (.not. (study%tasks(i)%is_requested .or. study%tasks(i)%info%is_always)) &
          call running%note(trim(study%tasks(i)%info%name)//' left out: not among the tasks')
      end do
      if (case%needs(stage%motion) .and. case%friction <= 0) call running%note('friction left out: it is 0')
      if (case%needs(stage%motion) .and. .not. case%has_backlash) call running%note('coast side left out: no backlash given')
    end associate
  end subroutine run_stages

  !> Finds the load over the face width, and the motions that follow from it.
  subroutine run_faces(study, error)
    type(study_t), intent(inout) :: study
    type(error_t), allocatable, intent(inout) :: error
    logical :: has_helical_motion

    associate (case => study%case)
      has_helical_motion = case%is_helical() .and. case%needs(stage%motion)
      if (has_helical_motion .or. case%has_uneven_motion() .or. case%needs_face_load()) &
        call build_faces(study%stages_t, study%face_mesh, error)
      if (has_helical_motion) call build_face_motions(study%stages_t, .false., study%motion, error)
      if (case%has_uneven_motion()) call build_face_motions(study%stages_t, .true., study%uneven_motion, error)
      if (case%needs_face_load()) &
        call find_face_loads(study%stages_t, [study%faces%alignment], study%face_loads, error)
    end associate
  end subroutine run_faces

  !> Completes the shaft by the pinion's numbers: it twists within its reference diameter less the dedendum of the rack on one side.
  pure subroutine complete_shaft(gear, material, shaft)
    type(gear_t), intent(in) :: gear             ! pinion
    type(material_t), intent(in) :: material
    type(shaft_t), intent(inout) :: shaft

    shaft%pinion_diameter = 2*gear%reference_radius
    shaft%core_diameter = 2*gear%reference_radius - gear%spec%dedendum*gear%spec%module
    shaft%base_radius = gear%base_radius(drive)
    shaft%young = material%young
    shaft%poisson = material%poisson
  end subroutine complete_shaft

  !> Reads the files of the case's tasks.
  subroutine read_files(study, folder, error)
    type(study_t), intent(inout) :: study
    character(*), intent(in) :: folder
    type(error_t), allocatable, intent(inout) :: error
    integer :: i, k

    do i = 1, size(study%tasks)
      associate (slot => study%tasks(i))
        if (.not. (slot%is_requested .and. allocated(slot%task%files))) cycle
        do k = 1, size(slot%task%files)
          slot%task%files(k)%path = path_in(folder, slot%task%files(k)%name)
          call read_text(slot%task%files(k)%path, slot%task%files(k)%text, error)
          if (allocated(error)) return
        end do
        select type (task => slot%task)
        class is (runnable_t)
          call task%parse_files(study%stages_t, error)
        end select
        if (allocated(error)) return
      end associate
    end do
  end subroutine read_files

  !> Runs the tasks of the case and those that run for every case, one after the other.
  subroutine run_tasks(study, error, earlier)
    type(study_t), intent(inout) :: study
    type(error_t), allocatable, intent(inout) :: error
    type(study_t), intent(in), target, optional :: earlier
    integer :: i, k

    do i = 1, size(study%tasks)
      if (allocated(error)) return
      associate (slot => study%tasks(i))
        if (.not. (slot%is_requested .or. (slot%info%is_always .and. allocated(study%pair)))) cycle
        if (slot%needs(stage%body) .or. slot%needs(stage%solid) .or. slot%needs(stage%motion)) then
          if (wants_stop(study%accuracy%steady%stop)) then
            call study%running%note(trim(slot%info%name)//' left out: the run was interrupted')
            study%stopped = .true.
            cycle
          end if
        end if
      end associate
      call run_task(study, i, error, earlier)
      if (allocated(study%running%bodies) .and. .not. any([(study%tasks(k)%needs(stage%body), k=i + 1, size(study%tasks))])) &
        deallocate (study%running%bodies)
    end do
  end subroutine run_tasks

  !> Runs task number `i`, or copies its result from an earlier study.
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
        known = is_current(study, earlier, i)
        if (earlier%tasks(i)%task%is_done) running%earlier => earlier%tasks(i)%task
      end if
      if (known) call take_over(earlier%tasks(i), slot, error)
      if (.not. known) then
        call slot%task%prepare()
        select type (task => slot%task)
        class is (runnable_t)
          call task%run(study%stages_t, error)
        end select
        ! Reports columns that did not fit into memory.
        do k = 1, size(slot%task%tables)
          if (allocated(slot%task%tables(k)%error) .and. .not. allocated(error)) error = slot%task%tables(k)%error
        end do
      end if
      if (allocated(error)) return
      if (slot%task%is_done) then
        call running%note(slot%task%log//trim(merge(', taken over', '            ', known .or. slot%task%is_reused)))
        study%stopped = study%stopped .or. slot%task%is_stopped
        if (.not. slot%is_requested .or. slot%task%is_stopped) return
        before = before + points_of(slot%task, study%stages_t)
        ! Tasks without progress of their own report all their points here.
        if (.not. known) call running%report_progress(before - running%done, study%accuracy%steady%stop)
        running%done = before
      else
        study%stopped = .true.
        call running%note(trim(slot%info%name)//' left out: the run was interrupted')
      end if
    end associate
  end subroutine run_task

  !> True if the earlier study has complete results of this task, from the same keys and from the same products of all stages that
  !> it needs. Cheap results are recomputed.
  pure logical function is_current(study, earlier, i) result(known)
    type(study_t), intent(in) :: study, earlier
    integer, intent(in) :: i                     ! index of the task

    associate (slot => study%tasks(i), before => earlier%tasks(i))
      known = before%is_requested .and. before%key_text == slot%key_text
      if (known) known = slot%needs(stage%mesh) .or. slot%needs(stage%body) .or. slot%needs(stage%solid)
      if (known) known = before%task%is_done .and. .not. before%task%is_stopped
      if (known) known = slot%task%has_same_files(before%task)
      if (known) known = same_gears(study, earlier, slot)
      if (known .and. slot%needs(stage%mesh)) known = same_but_amounts(study%motions_inputs, earlier%motions_inputs) .and. &
                                                      same_torques(study, earlier)
      if (known .and. slot%needs(stage%reliefs)) known = same(maxval(study%amount), maxval(earlier%amount))
      if (known .and. slot%needs(stage%amounts)) known = same(study%amount, earlier%amount)
      if (known .and. slot%needs(stage%accuracy)) known = same(choice_of(study), choice_of(earlier))
      if (known .and. slot%needs(stage%speeds)) known = same(study%rpm, earlier%rpm)
      if (known .and. slot%needs(stage%direction)) known = study%direction == earlier%direction
    end associate
  end function is_current

  !> True if the torques are the same, for a task that uses several.
  pure logical function same_torques(study, earlier) result(known)
    type(study_t), intent(in) :: study, earlier
    integer :: i

    known = allocated(study%torque) .eqv. allocated(earlier%torque)
    if (.not. (known .and. allocated(study%torque))) return
    known = same(study%torque, earlier%torque)
    if (known) known = all([(same_but_amounts(study%of_torque(i), earlier%of_torque(i)), i=1, size(study%torque))])
  end function same_torques

  !> True if the gears are the same, as far as the task in this slot uses them apart from the mesh.
  pure logical function same_gears(study, earlier, slot) result(known)
    type(study_t), intent(in) :: study, earlier
    type(task_slot_t), intent(in) :: slot

    known = .true.
    if (slot%needs(stage%face)) known = same(study%faces, earlier%faces) .and. same_elements_of(study, earlier)
    if (slot%needs(stage%body)) known = known .and. same(study%body_inputs, earlier%body_inputs)
    if (slot%needs(stage%solid)) known = known .and. same(study%solid_inputs, earlier%solid_inputs)
    associate (a => study%material, b => earlier%material)
      if (known .and. slot%needs(stage%elasticity)) known = same([a%young, a%poisson], [b%young, b%poisson])
      if (known .and. slot%needs(stage%density)) known = same([a%density], [b%density])
    end associate
    associate (a => study%iso, b => earlier%iso)
      if (known .and. slot%needs(stage%rims)) known = same([a%application_factor, a%rim_thickness], &
                                                       [b%application_factor, b%rim_thickness])
      if (known .and. slot%needs(stage%webs)) known = same([a%web_thickness], [b%web_thickness])
    end associate
  end function same_gears

  !> True if the inputs of the teeth by finite elements are the same, which the load over the face width uses.
  pure logical function same_elements_of(study, earlier) result(known)
    type(study_t), intent(in) :: study, earlier

    known = allocated(study%elements_inputs) .eqv. allocated(earlier%elements_inputs)
    if (known .and. allocated(study%elements_inputs)) known = same(study%elements_inputs, earlier%elements_inputs)
  end function same_elements_of

  !> Inputs of the results at a speed, apart from the oscillator.
  pure type(choice_t) function choice_of(study)
    type(study_t), intent(in) :: study

    choice_of = choice_t(steps=study%accuracy%step_choice_t, steady=study%accuracy%steady%steady_choice_t)
  end function choice_of

  !> Copies the result of the same task unchanged.
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
end module gearsweep_study_run_study
