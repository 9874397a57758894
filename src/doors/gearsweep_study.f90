!> From a case to its results, stage by stage; a stage runs only when a wanted
!> result needs it.
module gearsweep_study
  use, intrinsic :: iso_c_binding, only: c_int, c_loc
  use gearsweep_kinds, only: dp
  use gearsweep_error, only: code_memory, error_t, fail
  use gearsweep_error_estimate, only: point_t
  use gearsweep_optimum, only: optimum_t, find_optimum, most_sweeps, most_tried, peak_t, find_resonances
  use gearsweep_oscillator, only: oscillator_t, make_oscillator
  use gearsweep_response, only: response_t, find_response
  use gearsweep_sweep, only: sweep_t, sweep_options_t, sweep_state_t, run_sweep, progress_of_sweep
  use gearsweep_blas, only: hold_blas, release_blas
  use gearsweep_case, only: case_t, speed_count, speeds
  use gearsweep_disc, only: disc_t
  use gearsweep_files, only: beside, read_text
  use gearsweep_harmonics, only: harmonics_t, find_harmonics
  use gearsweep_memory, only: claim_memory, settle_memory
  use gearsweep_mesh, only: mesh_t
  use gearsweep_modal, only: modal_t, section_modes
  use gearsweep_pair, only: pair_t
  use gearsweep_piecewise, only: piecewise_t
  use gearsweep_published, only: published_t, read_published
  use gearsweep_root_rating, only: root_rating_t, rate_root
  use gearsweep_section, only: section_t, make_section
  use gearsweep_section_body, only: section_body_t, make_two_grids
  use gearsweep_sharing, only: sharing_t, share_load
  use gearsweep_stages, only: build_mesh, build_pair, deepest_relief, find_load, relieve
  use gearsweep_status, only: status_stopped
  use gearsweep_stop, only: wants_stop
  use gearsweep_text, only: str
  implicit none
  private
  public :: study_t, run_study, record_t

  !> Everything a case asked for; what it did not ask for stays unallocated.
  type :: study_t
    type(case_t) :: case
    type(pair_t), allocatable :: pair            !< none for a prescribed mesh
    type(mesh_t), allocatable :: mesh            !< without relief
    real(dp) :: base_pitch = 0                   !< m; 0: not known of a prescribed mesh
    real(dp) :: load = 0                         !< static load on the line of action, N
    real(dp) :: mass(2) = 0                      !< effective masses, kg
    type(oscillator_t), allocatable :: motion(:) !< one for each relief
    type(sharing_t), allocatable :: sharing(:)   !< one for each relief
    type(harmonics_t), allocatable :: harmonics(:)  !< of the static transmission error, one for each relief
    type(response_t), allocatable :: response(:, :)  !< one for each relief and load_rpm
    type(section_t), allocatable :: section      !< of the member that is looked at
    type(modal_t), allocatable :: modal          !< of that section
    type(root_rating_t), allocatable :: root(:)  !< of that member, one for each relief
    type(sweep_t), allocatable :: sweep
    type(peak_t), allocatable :: resonance(:)    !< of the least relieved mesh
    type(optimum_t), allocatable :: optimum
    type(published_t), allocatable :: published(:)  !< printed values to set beside ours
    character(:), allocatable :: log             !< stages run and left out, a line each
    integer :: threads = 0
    logical :: stopped = .false.                 !< the caller ended it: something that was asked for is missing
  end type study_t

  !> How far the sweeps of a study are: that of the task sweep, then those of the optimum.
  type :: record_t
    type(sweep_state_t) :: states(1 + most_sweeps)
  end type record_t

contains

  !> Runs what the case's tasks need. `folder` is where its files lie, with the
  !> slash; `threads` 0 takes all. `stiffness` is that of one pair (N/m over s)
  !> where it is known already, with its `disc`: of the same gears, material, section
  !> and load. Any number of callers at once.
  !>
  !> `watch(1)` not 0 ends the run soon, whoever sets it: another thread, a signal, `progress`; what is done by then is
  !> in the study, and points that are not have the status `stopped`. `watch(2)` and `watch(3)` tell how many operating
  !> points are done, of how many. With the `record` of a run that was ended, the next one takes over what was done.
  subroutine run_study(case, folder, threads, study, error, progress, stiffness, disc, watch, record)
    type(case_t), intent(in) :: case
    character(*), intent(in) :: folder
    integer, intent(in) :: threads
    type(study_t), intent(out) :: study
    type(error_t), allocatable, intent(out) :: error
    procedure(progress_of_sweep), optional :: progress
    type(piecewise_t), intent(in), optional :: stiffness
    type(disc_t), intent(in), optional :: disc
    integer(c_int), intent(inout), target, optional :: watch(3)
    type(record_t), intent(inout), optional :: record
    type(sweep_options_t) :: options

    options%accuracy = case%accuracy
    options%direction = case%direction
    options%threads = threads
    if (present(watch)) options%accuracy%steady%stop = c_loc(watch)
    call hold_blas()
    call claim_memory(0.0_dp, '&case tasks', error)
    if (.not. allocated(error)) call run_stages(case, folder, options, study, error, progress, stiffness, disc, record)
    call settle_memory()
    call release_blas()
  end subroutine run_study

  !> The same, whatever BLAS does with threads.
  subroutine run_stages(case, folder, options, study, error, progress, stiffness, disc, record)
    type(case_t), intent(in) :: case
    character(*), intent(in) :: folder
    type(sweep_options_t), intent(inout) :: options
    type(study_t), intent(inout) :: study
    type(error_t), allocatable, intent(inout) :: error
    procedure(progress_of_sweep), optional :: progress
    type(piecewise_t), intent(in), optional :: stiffness
    type(disc_t), intent(in), optional :: disc
    type(record_t), intent(inout), optional :: record

    study%case = case
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
      call mesh_and_motion(study, folder, error, stiffness, disc)
    else
      call note(study, 'mesh and motion left out: no task needs them')
    end if
    if (allocated(error)) return
    if (case%needs_section()) then
      if (ends_here(study, options, 'section')) return
      call look_at_body(study, error)
    end if
    if (allocated(error) .or. .not. case%needs_load()) return
    if (case%needs_motion()) then
      if (ends_here(study, options, 'motion')) return
      call move(study, options, error, progress, record)
    end if
    call note_left_out(study)
  end subroutine run_stages

  !> The tasks that need the motion.
  subroutine move(study, options, error, progress, record)
    type(study_t), intent(inout) :: study
    type(sweep_options_t), intent(inout) :: options
    type(error_t), allocatable, intent(inout) :: error
    procedure(progress_of_sweep), optional :: progress
    type(record_t), intent(inout), optional :: record

    associate (case => study%case)
      if (case%asks('sweep') .or. case%asks('optimum')) options%all_points = size(speeds(case))* &
        (merge(size(case%amount), 0, case%asks('sweep')) + merge(most_tried, 0, case%asks('optimum')))
      if (case%asks('sweep')) call sweep_all(study, options, error, progress, record)
      if (case%asks('load') .and. .not. allocated(error)) call respond(study, options, error)
      if (case%asks('optimum') .and. .not. allocated(error)) call optimise(study, options, error, progress, record)
    end associate
  end subroutine move

  !> Did the caller end the run? Then the log says what comes no more.
  logical function ends_here(study, options, what)
    type(study_t), intent(inout) :: study
    type(sweep_options_t), intent(in) :: options
    character(*), intent(in) :: what

    ends_here = wants_stop(options%accuracy%steady%stop)
    if (ends_here) call note(study, what//' left out: the run was interrupted')
    study%stopped = study%stopped .or. ends_here
  end function ends_here

  subroutine note(study, line)
    type(study_t), intent(inout) :: study
    character(*), intent(in) :: line

    study%log = study%log//line//new_line('a')
  end subroutine note

  subroutine note_left_out(study)
    type(study_t), intent(inout) :: study

    associate (case => study%case)
      if (.not. case%asks('mesh')) call note(study, 'static load sharing left out: not among the tasks')
      if (.not. case%asks('load')) call note(study, 'pair loads along the path left out: not among the tasks')
      if (.not. case%asks('sweep')) call note(study, 'sweep left out: not among the tasks')
      if (.not. case%asks('optimum')) call note(study, 'optimum relief left out: not among the tasks')
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

  !> What all that needs a load starts from.
  subroutine mesh_and_motion(study, folder, error, stiffness, disc)
    type(study_t), intent(inout) :: study
    character(*), intent(in) :: folder
    type(error_t), allocatable, intent(out) :: error
    type(piecewise_t), intent(in), optional :: stiffness
    type(disc_t), intent(in), optional :: disc

    call find_load(study%case, study%pair, study%base_pitch, study%load, study%mass)
    allocate (study%mesh)
    call build_mesh(study%case, study%pair, study%load, folder, study%mesh, error, stiffness, disc)
    if (present(stiffness)) call note(study, 'mesh: pair stiffness as passed in')
    if (.not. present(stiffness)) call note(study, 'mesh: pair stiffness by model '//study%case%model)
    if (allocated(error)) return
    call build_motion(study, error)
    if (allocated(error)) return
    if (study%case%asks('mesh')) call share_all(study, error)
  end subroutine mesh_and_motion

  !> One member's section: its grid, its modes and its root stress, from the same two factored grids.
  subroutine look_at_body(study, error)
    type(study_t), intent(inout) :: study
    type(error_t), allocatable, intent(out) :: error
    type(section_body_t) :: grids(2)
    type(mesh_t), allocatable :: meshes(:)

    associate (case => study%case, gear => study%pair%gear(study%case%root%member))
      if (case%asks_any('static, modal')) then
        call make_two_grids(gear, case%material, case%section, grids, error)
        call note(study, 'section: two grids made and factored')
      else
        call make_section(gear, case%section, grids(1)%section, error)
        call note(study, 'section: grid made')
      end if
      if (allocated(error)) return
      if (case%asks('section')) study%section = grids(1)%section
      if (case%asks('modal')) then
        allocate (study%modal)
        call section_modes(grids, case%modes, study%modal, error)
        call note(study, 'modal: '//str(case%modes)//' modes on the two grids')
      end if
      if (allocated(error)) return
      if (case%asks('static')) then
        meshes = study%motion%mesh
        call rate_root(study%pair, meshes, study%load, grids, case%root, study%root, error)
        call note(study, 'static: root stress at '//str(case%root%positions)//' positions of the load')
      end if
    end associate
  end subroutine look_at_body

  !> One oscillator for each relief.
  subroutine build_motion(study, error)
    type(study_t), intent(inout) :: study
    type(error_t), allocatable, intent(out) :: error
    integer :: i

    ! Each has a mesh of its own.
    associate (curve => study%mesh%stiffness)
      call claim_memory(size(study%case%amount)*(8000 + 8.0_dp*(size(curve%coef) + size(curve%breaks))), &
                        '&relief amount_um: '//str(size(study%case%amount))//' reliefs', error)
    end associate
    if (allocated(error)) return
    allocate (study%motion(size(study%case%amount)))
    do i = 1, size(study%motion)
      call relieved(study, study%case%amount(i), study%motion(i), error)
      if (allocated(error)) return
    end do
  end subroutine build_motion

  !> The oscillator for one amount of relief (m).
  subroutine relieved(study, amount, motion, error)
    type(study_t), intent(in) :: study
    real(dp), intent(in) :: amount
    type(oscillator_t), intent(out) :: motion
    type(error_t), allocatable, intent(out) :: error

    motion%mesh = study%mesh
    call relieve(study%case, study%pair, study%base_pitch, amount, motion%mesh, error)
    if (allocated(error)) return
    motion%mass = study%mass
    motion%load = study%load
    motion%damping_ratio = study%case%damping_ratio
    motion%friction = study%case%friction
    motion%has_backlash = study%case%has_backlash
    motion%backlash = study%case%backlash
    call make_oscillator(motion, error)
  end subroutine relieved

  subroutine share_all(study, error)
    type(study_t), intent(inout) :: study
    type(error_t), allocatable, intent(inout) :: error
    integer, parameter :: samples = 200
    integer :: i

    allocate (study%sharing(size(study%motion)), study%harmonics(size(study%motion)))
    do i = 1, size(study%motion)
      ! The first tells what the others take.
      if (i == 2) call claim_memory(size(study%motion)*(1000 + 24.0_dp*study%case%harmonics + size(study%sharing(1)%phase)* &
        (28.0_dp + 16*size(study%sharing(1)%s, 1))), '&relief amount_um: '//str(size(study%motion))//' reliefs', error)
      if (allocated(error)) return
      call share_load(study%motion(i)%mesh, study%load, samples, study%sharing(i))
      call find_harmonics(study%motion(i)%mesh, study%load, study%case%harmonics, study%harmonics(i))
    end do
    call note(study, 'mesh: static load sharing and transmission error')
  end subroutine share_all

  !> One operating point has one answer: what a sweep of this run found, or follows from there, is taken over.
  subroutine respond(study, options, error)
    type(study_t), intent(inout) :: study
    type(sweep_options_t), intent(in) :: options
    type(error_t), allocatable, intent(inout) :: error
    type(point_t) :: none
    integer :: i, k

    none%steady%status = status_stopped
    call claim_memory(1000.0_dp*size(study%motion)*size(study%case%load_rpm), &
                      '&sweep load_rpm: '//str(size(study%motion)*size(study%case%load_rpm))//' motions', error)
    if (allocated(error)) return
    allocate (study%response(size(study%motion), size(study%case%load_rpm)))
    associate (rpm => study%case%load_rpm, accuracy => options%accuracy)
      do k = 1, size(rpm)
        do i = 1, size(study%motion)
          if (allocated(study%sweep)) then
            call find_response(study%motion(i), rpm(k), accuracy, study%response(i, k), study%sweep%kept(k, i))
          else if (wants_stop(accuracy%steady%stop)) then
            call find_response(study%motion(i), rpm(k), accuracy, study%response(i, k), none)
          else
            call find_response(study%motion(i), rpm(k), accuracy, study%response(i, k))
          end if
          if (study%response(i, k)%lacks) call fail(error, code_memory, &
            '&sweep load_rpm = '//str(rpm(k))//': the memory does not hold the motion')
          if (allocated(error)) return
        end do
      end do
    end associate
    study%stopped = study%stopped .or. any(study%response%point%steady%status == status_stopped)
    call note(study, 'load: '//str(size(study%response))//' motions followed over the path')
  end subroutine respond

  subroutine sweep_all(study, options, error, progress, record)
    type(study_t), intent(inout) :: study
    type(sweep_options_t), intent(inout) :: options
    type(error_t), allocatable, intent(out) :: error
    procedure(progress_of_sweep), optional :: progress
    type(record_t), intent(inout), optional :: record
    type(sweep_options_t) :: keeping
    integer :: left

    call claim_memory(24.0_dp*speed_count(study%case), '&sweep: '//str(speed_count(study%case))//' speeds', error)
    if (allocated(error)) return
    keeping = options
    if (study%case%asks('load')) keeping%keep = study%case%load_rpm
    allocate (study%sweep)
    if (present(record)) then
      call run_sweep(study%motion, speeds(study%case), keeping, study%sweep, error, progress, record%states(1))
    else
      call run_sweep(study%motion, speeds(study%case), keeping, study%sweep, error, progress)
    end if
    if (allocated(error)) return
    options%done_before = size(study%sweep%status)
    left = count(study%sweep%status == status_stopped)
    study%stopped = study%stopped .or. left > 0
    if (left == 0) then
      study%resonance = find_resonances(study%sweep%rpm, study%sweep%dynamic_factor(:, minloc(study%case%amount, 1)))
      call note(study, 'sweep: '//str(size(study%sweep%status))//' operating points')
    else
      ! Part of a curve may end at what is no resonance.
      allocate (study%resonance(0))
      call note(study, 'sweep: interrupted, '//str(size(study%sweep%status) - left)//' of '//str(size(study%sweep%status))// &
                ' operating points computed')
    end if
  end subroutine sweep_all

  subroutine optimise(study, options, error, progress, record)
    type(study_t), intent(inout) :: study
    type(sweep_options_t), intent(in) :: options
    type(error_t), allocatable, intent(out) :: error
    procedure(progress_of_sweep), optional :: progress
    type(record_t), intent(inout), optional :: record
    type(optimum_t), allocatable :: optimum
    real(dp) :: largest

    if (ends_here(study, options, 'optimum relief')) return
    ! Beyond some 1.5 static deflections of one pair, pairs no longer share the load.
    largest = max(maxval(study%case%amount), 1.5_dp*study%load &
                  /study%mesh%stiffness%value(study%mesh%contact_ratio/2)/maxval(study%case%fraction))
    largest = min(largest, deepest_relief(study%case, study%pair))
    call claim_memory(24.0_dp*speed_count(study%case), '&sweep: '//str(speed_count(study%case))//' speeds', error)
    if (allocated(error)) return
    allocate (optimum)
    if (present(record)) then
      call find_optimum(relieved_study, study, largest, speeds(study%case), options, optimum, error, progress, &
                        record%states(2:))
    else
      call find_optimum(relieved_study, study, largest, speeds(study%case), options, optimum, error, progress)
    end if
    if (allocated(error)) return
    if (optimum%stopped) then
      study%stopped = .true.
      call note(study, 'optimum relief left out: the run was interrupted')
      return
    end if
    call move_alloc(optimum, study%optimum)
    call note(study, 'optimum: '//str(size(study%optimum%amount))//' reliefs swept')
  end subroutine optimise

  subroutine relieved_study(context, amount, motion, error)
    class(*), intent(in) :: context
    real(dp), intent(in) :: amount
    type(oscillator_t), intent(out) :: motion
    type(error_t), allocatable, intent(out) :: error

    select type (context)
    type is (study_t)
      call relieved(context, amount, motion, error)
    end select
  end subroutine relieved_study
end module gearsweep_study
