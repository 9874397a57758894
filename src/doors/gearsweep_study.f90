!> From a case to its results, stage by stage; a stage runs only when a wanted
!> result needs it.
module gearsweep_study
  use gearsweep_kinds, only: dp, pi
  use gearsweep_error, only: error_t, fail, code_input
  use gearsweep_blas, only: hold_blas, release_blas
  use gearsweep_case, only: case_t, speeds
  use gearsweep_files, only: read_table, read_text
  use gearsweep_published, only: published_t, read_published
  use gearsweep_gear, only: gear_t, gear_spec_t, make_gear, drive
  use gearsweep_pair, only: pair_t, make_pair, free_centre_distance, tip_alteration
  use gearsweep_relief, only: relief_t, profile_error
  use gearsweep_piecewise, only: piecewise_t
  use gearsweep_stiffness, only: iso_stiffness, polynomial_stiffness, table_stiffness
  use gearsweep_weber, only: weber_stiffness
  use gearsweep_fe_stiffness, only: fe_options_t, fe_stiffness
  use gearsweep_section, only: section_t, section_options_t, make_section
  use gearsweep_modal, only: modal_t, section_modes
  use gearsweep_root_rating, only: root_rating_t, rate_root
  use gearsweep_mesh, only: mesh_t
  use gearsweep_sharing, only: sharing_t, share_load
  use gearsweep_harmonics, only: harmonics_t, find_harmonics
  use gearsweep_motion, only: oscillator_t, make_oscillator
  use gearsweep_sweep, only: sweep_t, sweep_options_t, run_sweep, progress_of_sweep
  use gearsweep_response, only: response_t, find_response
  use gearsweep_optimum, only: optimum_t, find_optimum, peak_t, find_resonances
  use gearsweep_text, only: str
  implicit none
  private
  public :: study_t, run_study

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
  end type study_t

contains

  !> Runs what the case's tasks need. `folder` is where its files lie, with the
  !> slash; `threads` 0 takes all. `stiffness` is that of one pair (N/m over s)
  !> where it is known already: of the same gears, material, section and load.
  !> Any number of callers at once.
  subroutine run_study(case, folder, threads, study, error, progress, stiffness)
    type(case_t), intent(in) :: case
    character(*), intent(in) :: folder
    integer, intent(in) :: threads
    type(study_t), intent(out) :: study
    type(error_t), allocatable, intent(out) :: error
    procedure(progress_of_sweep), optional :: progress
    type(piecewise_t), intent(in), optional :: stiffness

    call hold_blas()
    call run_stages(case, folder, threads, study, error, progress, stiffness)
    call release_blas()
  end subroutine run_study

  !> The same, whatever BLAS does with threads.
  subroutine run_stages(case, folder, threads, study, error, progress, stiffness)
    type(case_t), intent(in) :: case
    character(*), intent(in) :: folder
    integer, intent(in) :: threads
    type(study_t), intent(inout) :: study
    type(error_t), allocatable, intent(inout) :: error
    procedure(progress_of_sweep), optional :: progress
    type(piecewise_t), intent(in), optional :: stiffness
    type(sweep_options_t) :: options

    study%case = case
    study%threads = threads
    study%log = ''
    if (allocated(case%published)) call find_published(study, folder, error)
    if (allocated(error)) return
    if (case%prescribed) then
      call note(study, 'geometry left out: the mesh is prescribed')
    else
      call build_pair(study, error)
    end if
    if (allocated(error)) return
    call look_at_section(study, error)
    if (allocated(error)) return
    if (.not. case%needs_load()) then
      call note(study, 'mesh and motion left out: no task needs them')
      return
    end if
    call find_load(study)
    call build_mesh(study, folder, error, stiffness)
    if (allocated(error)) return
    call build_motion(study, error)
    if (allocated(error)) return
    if (case%asks('mesh')) call share_all(study)
    if (case%asks('static')) then
      call rate_root(study%pair, study%motion%mesh, study%load, case%material, case%section, case%root, study%root, error)
      call note(study, 'static: root stress at '//str(case%root%positions)//' positions of the load')
    end if
    if (allocated(error)) return

    options%accuracy = case%accuracy
    options%direction = case%direction
    options%threads = threads
    if (case%asks('load')) call respond(study)
    if (case%asks('sweep')) call sweep_all(study, options, error, progress)
    if (case%asks('optimum') .and. .not. allocated(error)) call optimise(study, options, error, progress)
    call note_left_out(study)
  end subroutine run_stages

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
    if (allocated(error)) return
    ! As in the case reader: one at a time.
    !$omp critical (gearsweep_texts)
    call read_published(path, text, study%published, error)
    !$omp end critical (gearsweep_texts)
  end subroutine find_published

  !> Gears, centre distance and path of contact.
  subroutine build_pair(study, error)
    type(study_t), intent(inout) :: study
    type(error_t), allocatable, intent(out) :: error
    type(gear_spec_t) :: spec(2)
    type(gear_t) :: gear(2)
    real(dp) :: distance
    integer :: i

    spec = study%case%spec
    do i = 1, 2
      call make_gear(spec(i), gear(i), error)
      if (allocated(error)) return
    end do
    distance = study%case%centre_distance
    if (distance <= 0) distance = free_centre_distance(gear(1), gear(2))
    if (study%case%tip_alteration) then
      spec%tip_alteration = tip_alteration(gear(1), gear(2), distance)
      do i = 1, 2
        call make_gear(spec(i), gear(i), error)
        if (allocated(error)) return
      end do
    end if
    allocate (study%pair)
    call make_pair(gear(1), gear(2), distance, study%pair, error)
    call note(study, 'geometry: pair built')
  end subroutine build_pair

  !> Static load and effective masses on the line of action.
  subroutine find_load(study)
    type(study_t), intent(inout) :: study
    real(dp) :: base_radius(2)
    integer :: i

    associate (case => study%case)
      if (allocated(study%pair)) then
        study%base_pitch = study%pair%base_pitch
      else
        study%base_pitch = case%base_pitch
      end if
      base_radius = study%base_pitch*case%spec%teeth/(2*pi)
      if (case%torque > 0) study%load = case%torque/base_radius(1)
      if (case%normal_force > 0) study%load = case%normal_force
      if (case%line_load > 0) study%load = case%line_load*case%spec(1)%face_width
      do i = 1, 2
        if (case%mass(i) > 0) then
          study%mass(i) = case%mass(i)
        else if (case%inertia(i) > 0) then
          study%mass(i) = case%inertia(i)/base_radius(i)**2
        else
          study%mass(i) = solid_inertia(study%pair%gear(i), case%material%density)/base_radius(i)**2
        end if
      end do
    end associate
  end subroutine find_load

  !> Polar inertia of a disc up to the reference circle, less its bore (kg m^2).
  pure real(dp) function solid_inertia(gear, density)
    type(gear_t), intent(in) :: gear
    real(dp), intent(in) :: density

    solid_inertia = pi/2*density*gear%spec%face_width*(gear%reference_radius**4 - gear%spec%bore_radius**4)
  end function solid_inertia

  !> Stiffness by the chosen model unless it is known, and the path's other data.
  subroutine build_mesh(study, folder, error, known)
    type(study_t), intent(inout) :: study
    character(*), intent(in) :: folder
    type(error_t), allocatable, intent(out) :: error
    type(piecewise_t), intent(in), optional :: known
    real(dp), allocatable :: s(:), stiffness(:)
    real(dp) :: line_load, points(5)

    allocate (study%mesh)
    associate (case => study%case, mesh => study%mesh)
      mesh%teeth = case%spec%teeth
      if (case%prescribed) then
        mesh%contact_ratio = case%contact_ratio
        mesh%pitch_point = case%pitch_point
        if (case%pitch_point < 0) mesh%pitch_point = case%contact_ratio/2
        mesh%tan_angle = tan(case%spec(1)%pressure_angle(drive))
      else
        mesh%contact_ratio = study%pair%contact_ratio
        points = study%pair%points()
        mesh%pitch_point = points(3)
        mesh%tan_angle = tan(study%pair%working_angle(drive))
        line_load = study%load/case%spec(1)%face_width
      end if
      if (present(known)) then
        mesh%stiffness = known
        call note(study, 'mesh: pair stiffness as passed in')
        return
      end if
      select case (case%model)
      case ('fe')
        call fe_stiffness(study%pair, case%material, fe_options_t(section=support(case)), line_load, mesh%stiffness, error)
      case ('weber')
        call weber_stiffness(study%pair, case%material, line_load, mesh%stiffness, error)
      case ('iso6336')
        call iso_stiffness(study%pair, case%material, line_load, mesh%stiffness, error)
      case ('polynomial')
        call polynomial_stiffness(mesh%contact_ratio, case%coefficients, mesh%stiffness, error)
      case ('table')
        call read_table(beside(folder, case%file), s, stiffness, error)
        if (.not. allocated(error)) call table_stiffness(mesh%contact_ratio, s, 1e6_dp*stiffness, mesh%stiffness, error)
      end select
      call note(study, 'mesh: pair stiffness by model '//case%model)
    end associate
  end subroutine build_mesh

  !> The section behind the teeth for the stiffness: the unloaded teeth may be coarser.
  pure function support(case) result(options)
    type(case_t), intent(in) :: case
    type(section_options_t) :: options

    options = case%section
    options%others_across = min(4, options%elements_across)
  end function support

  !> Grid and modes of the section of one member.
  subroutine look_at_section(study, error)
    type(study_t), intent(inout) :: study
    type(error_t), allocatable, intent(out) :: error

    associate (case => study%case)
      if (case%asks('section')) then
        allocate (study%section)
        call make_section(study%pair%gear(case%root%member), case%section, study%section, error)
        call note(study, 'section: grid made')
      end if
      if (allocated(error)) return
      if (case%asks('modal')) then
        allocate (study%modal)
        call section_modes(study%pair%gear(case%root%member), case%material, case%section, case%modes, study%modal, error)
        call note(study, 'modal: '//str(case%modes)//' modes on two grids')
      end if
    end associate
  end subroutine look_at_section

  !> A relative file lies in the case's folder.
  pure function beside(folder, file) result(path)
    character(*), intent(in) :: folder, file
    character(len(file) + merge(0, len(folder), index(file, '/') == 1)) :: path

    path = folder//file
    if (index(file, '/') == 1) path = file
  end function beside

  !> One oscillator for each relief.
  subroutine build_motion(study, error)
    type(study_t), intent(inout) :: study
    type(error_t), allocatable, intent(out) :: error
    integer :: i

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
    type(relief_t) :: relief

    relief%amount = amount*study%case%fraction
    relief%start = relief_start(study)
    relief%shape = study%case%shape
    motion%mesh = study%mesh
    if (amount > 0 .and. study%case%start == 'hpstc' .and. &
        .not. modulo(study%mesh%contact_ratio, 1.0_dp) > 0) then
      call fail(error, code_input, '&relief start = ''hpstc'': short relief has no room at a contact ratio of '// &
                str(study%mesh%contact_ratio)//'; use start = ''pitch'' or length_mm')
    else if (amount > deepest_relief(study)) then
      call fail(error, code_input, '&relief amount_um = '//str(1e6_dp*amount)// &
        ': deeper than the tooth; with these fractions at most '//str(1e6_dp*deepest_relief(study)))
    else
      call profile_error(relief, motion%mesh%contact_ratio, motion%mesh%profile_error, error)
    end if
    if (allocated(error)) return
    motion%mass = study%mass
    motion%load = study%load
    motion%damping_ratio = study%case%damping_ratio
    motion%friction = study%case%friction
    motion%has_backlash = study%case%has_backlash
    motion%backlash = study%case%backlash
    call make_oscillator(motion, error)
  end subroutine relieved

  !> Half the tooth's thickness at the tip, over the larger fraction (m); for a
  !> prescribed mesh nothing is known of the tooth.
  pure real(dp) function deepest_relief(study) result(deepest)
    type(study_t), intent(in) :: study
    integer :: i

    deepest = huge(deepest)
    if (.not. allocated(study%pair)) return
    do i = 1, 2
      associate (gear => study%pair%gear(i))
        if (study%case%fraction(i) > 0) deepest = min(deepest, gear%thickness(gear%tip_radius)/2/study%case%fraction(i))
      end associate
    end do
  end function deepest_relief

  !> Path coordinates at which the reliefs of pinion and gear begin.
  pure function relief_start(study) result(start)
    type(study_t), intent(in) :: study
    real(dp) :: start(2)

    associate (case => study%case, ratio => study%mesh%contact_ratio, pitch => study%base_pitch)
      select case (case%start)
      case ('pitch')
        start = study%mesh%pitch_point
      case ('length')
        start = [ratio - case%length/pitch, case%length/pitch]
      case ('roll')
        associate (pair => study%pair)
          start(1) = (case%roll(1)*pair%gear(1)%base_radius(drive) - pair%start_curvature)/pitch
          start(2) = (pair%curvature(2, 0.0_dp) - case%roll(2)*pair%gear(2)%base_radius(drive))/pitch
        end associate
      case default
        start = [aint(ratio), ratio - aint(ratio)]
      end select
    end associate
  end function relief_start

  subroutine share_all(study)
    type(study_t), intent(inout) :: study
    integer, parameter :: samples = 200
    integer :: i

    allocate (study%sharing(size(study%motion)), study%harmonics(size(study%motion)))
    do i = 1, size(study%motion)
      call share_load(study%motion(i)%mesh, study%load, samples, study%sharing(i))
      call find_harmonics(study%motion(i)%mesh, study%load, study%case%harmonics, study%harmonics(i))
    end do
    call note(study, 'mesh: static load sharing and transmission error')
  end subroutine share_all

  subroutine respond(study)
    type(study_t), intent(inout) :: study
    integer :: i, k

    allocate (study%response(size(study%motion), size(study%case%load_rpm)))
    do k = 1, size(study%case%load_rpm)
      do i = 1, size(study%motion)
        call find_response(study%motion(i), study%case%load_rpm(k), study%case%accuracy, study%response(i, k))
      end do
    end do
    call note(study, 'load: '//str(size(study%response))//' motions followed over the path')
  end subroutine respond

  subroutine sweep_all(study, options, error, progress)
    type(study_t), intent(inout) :: study
    type(sweep_options_t), intent(in) :: options
    type(error_t), allocatable, intent(out) :: error
    procedure(progress_of_sweep), optional :: progress

    allocate (study%sweep)
    call run_sweep(study%motion, speeds(study%case), options, study%sweep, error, progress)
    if (allocated(error)) return
    study%resonance = find_resonances(study%sweep%rpm, study%sweep%dynamic_factor(:, minloc(study%case%amount, 1)))
    call note(study, 'sweep: '//str(size(study%sweep%status))//' operating points')
  end subroutine sweep_all

  subroutine optimise(study, options, error, progress)
    type(study_t), intent(inout) :: study
    type(sweep_options_t), intent(in) :: options
    type(error_t), allocatable, intent(out) :: error
    procedure(progress_of_sweep), optional :: progress
    type(optimum_t), allocatable :: optimum
    real(dp) :: largest

    ! Beyond some 1.5 static deflections of one pair, pairs no longer share the load.
    largest = max(maxval(study%case%amount), 1.5_dp*study%load &
                  /study%mesh%stiffness%value(study%mesh%contact_ratio/2)/maxval(study%case%fraction))
    largest = min(largest, deepest_relief(study))
    allocate (optimum)
    call find_optimum(relieved_study, study, largest, speeds(study%case), options, optimum, error, progress)
    if (allocated(error)) return
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
