!> Reads a case, one text for every door: takes each key once, in its unit, checks it, and refuses what
!> the case at hand does not use.
module gearsweep_case_reader
  use gearsweep_kinds, only: dp, pi
  use gearsweep_error, only: error_t, fail, code_input
  use gearsweep_case, only: case_t, task_names
  use gearsweep_reader, only: reader_t, open_reader
  use gearsweep_relief, only: linear, parabolic
  use gearsweep_root_rating, only: shared_by_mesh, shared_equally, shares_stated, spaced_on_flank, spaced_on_path
  use gearsweep_steady, only: by_shooting, by_marching
  use gearsweep_sweep, only: each, up, down, most_points
  use gearsweep_text, only: str
  implicit none
  private
  public :: read_case, complete_case

  !> Speeds times reliefs whose pair loads are followed over the path.
  integer, parameter :: most_paths = 10000

contains

  !> Reads and checks a case; the error names group, key, value and what is allowed.
  subroutine read_case(text, case, error)
    character(*), intent(in) :: text
    type(case_t), intent(out) :: case
    type(error_t), allocatable, intent(out) :: error
    type(reader_t) :: reader

    ! Its texts have lengths that gfortran keeps in static memory; see gearsweep_text.
    !$omp critical (gearsweep_texts)
    call read_all(text, reader, case, error)
    !$omp end critical (gearsweep_texts)
  end subroutine read_case

  !> Reads and checks a case and writes it with all its defaults.
  subroutine complete_case(text, complete, error)
    character(*), intent(in) :: text
    character(:), allocatable, intent(out) :: complete
    type(error_t), allocatable, intent(out) :: error
    type(case_t) :: case
    type(reader_t) :: reader

    !$omp critical (gearsweep_texts)
    call read_all(text, reader, case, error)
    if (.not. allocated(error)) call reader%write_complete(complete)
    !$omp end critical (gearsweep_texts)
  end subroutine complete_case

  subroutine read_all(text, reader, case, error)
    character(*), intent(in) :: text
    type(reader_t), intent(inout) :: reader
    type(case_t), intent(inout) :: case
    type(error_t), allocatable, intent(inout) :: error

    case%text = text
    call open_reader(text, reader, error)
    call read_tasks(reader, case, error)
    call read_mesh(reader, case, error)
    call read_pair(reader, case, error)
    call read_member(reader, 'pinion', 1, case, error)
    call read_member(reader, 'gear', 2, case, error)
    call read_material(reader, case, error)
    call read_load(reader, case, error)
    call read_relief(reader, case, error)
    call read_dynamics(reader, case, error)
    call read_sweep(reader, case, error)
    call read_numerics(reader, case, error)
    call read_section(reader, case, error)
    call reader%finish(error)
  end subroutine read_all

  subroutine read_tasks(reader, case, error)
    type(reader_t), intent(inout) :: reader
    type(case_t), intent(inout) :: case
    type(error_t), allocatable, intent(inout) :: error
    character(:), allocatable :: tasks(:)
    integer :: i

    case%title = ''
    call reader%get('case', 'title', case%title, error)
    call reader%get('case', 'published', case%published, error)
    allocate (tasks, source=[character(8) :: 'mesh', 'sweep'])
    call reader%get('case', 'tasks', tasks, error, allowed=task_names)
    case%wants = [(any(tasks == task_names(i)), i=1, size(task_names))]
  end subroutine read_tasks

  !> First, as it decides whether there is a geometry.
  subroutine read_mesh(reader, case, error)
    type(reader_t), intent(inout) :: reader
    type(case_t), intent(inout) :: case
    type(error_t), allocatable, intent(inout) :: error
    character(*), parameter :: by_hand = 'needs a prescribed mesh (&mesh contact_ratio)'

    call reader%get('mesh', 'ste_harmonics', case%harmonics, error, at_least=1, at_most=1000)
    case%prescribed = reader%has('mesh', 'contact_ratio')
    case%model = 'weber'
    if (case%prescribed) then
      case%model = ''
      call reader%get('mesh', 'model', case%model, error, required=.true., &
                      allowed=[character(10) :: 'polynomial', 'table'])
      call reader%get('mesh', 'contact_ratio', case%contact_ratio, error, above=1.0_dp, at_most=20.0_dp)
      call reader%get('mesh', 'base_pitch_mm', case%base_pitch, error, at_least=1e-6_dp, at_most=1e6_dp, scale=1e-3_dp)
      call reader%get('mesh', 'pitch_point', case%pitch_point, error, at_least=0.0_dp)
      if (case%pitch_point > case%contact_ratio) call fail(error, code_input, &
        '&mesh pitch_point = '//str(case%pitch_point)//': must be at most the contact ratio')
      if (case%asks('geometry') .or. case%needs_section()) call fail(error, code_input, &
        '&case tasks: geometry, section, static and modal need a gear; a prescribed mesh (&mesh contact_ratio) has none')
    else
      call reader%get('mesh', 'model', case%model, error, &
                      allowed=[character(10) :: 'fe', 'weber', 'iso6336', 'polynomial', 'table'])
      call reader%get('mesh', 'contact_ratio', case%contact_ratio, error, above=1.0_dp)
      call reader%refuse('mesh', 'base_pitch_mm', by_hand, error)
      call reader%refuse('mesh', 'pitch_point', by_hand, error)
    end if
    if (allocated(error)) return
    if (case%model == '') then
      ! The missing model is told later; what belongs to either is no error of its own.
      call reader%get('mesh', 'coefficients', case%coefficients, error)
      call reader%get('mesh', 'file', case%file, error)
      return
    end if
    if (case%model == 'polynomial') then
      call reader%get('mesh', 'coefficients', case%coefficients, error, required=.true., &
                      at_least=-1e12_dp, at_most=1e12_dp, scale=1e6_dp, max_size=20)
    else
      call reader%refuse('mesh', 'coefficients', 'needs model = ''polynomial''', error)
    end if
    if (case%model == 'table') then
      call reader%get('mesh', 'file', case%file, error, required=.true.)
    else
      call reader%refuse('mesh', 'file', 'needs model = ''table''', error)
    end if
  end subroutine read_mesh

  subroutine read_pair(reader, case, error)
    type(reader_t), intent(inout) :: reader
    type(case_t), intent(inout) :: case
    type(error_t), allocatable, intent(inout) :: error
    character(*), parameter :: useless = 'not used by a prescribed mesh (&mesh contact_ratio); remove it'
    real(dp), parameter :: degree = pi/180
    real(dp) :: module, width, drive_angle, coast_angle
    logical :: given

    module = 0
    width = 0
    drive_angle = 20*degree
    if (case%prescribed) then
      call reader%refuse('pair', 'module_mm', useless, error)
      call reader%refuse('pair', 'coast_angle_deg', useless, error)
      call reader%refuse('pair', 'centre_distance_mm', useless, error)
      call reader%refuse('pair', 'tip_alteration', useless, error)
      call reader%get('pair', 'face_width_mm', width, error, above=0.0_dp, scale=1e-3_dp)
      call reader%get('pair', 'pressure_angle_deg', drive_angle, error, above=3.0_dp, below=45.0_dp, scale=degree)
    else
      call reader%get('pair', 'module_mm', module, error, required=.true., at_least=1e-3_dp, at_most=1000.0_dp, scale=1e-3_dp)
      call reader%get('pair', 'face_width_mm', width, error, required=.true., at_least=1e-3_dp, at_most=1e5_dp, scale=1e-3_dp)
      call reader%get('pair', 'pressure_angle_deg', drive_angle, error, above=3.0_dp, below=45.0_dp, scale=degree)
      coast_angle = drive_angle
      call reader%get('pair', 'coast_angle_deg', coast_angle, error, above=3.0_dp, below=45.0_dp, scale=degree)
      call reader%get('pair', 'centre_distance_mm', case%centre_distance, error, above=0.0_dp, scale=1e-3_dp)
      call reader%get('pair', 'tip_alteration', case%tip_alteration, error)
      case%spec%pressure_angle(2) = coast_angle
    end if
    case%spec%pressure_angle(1) = drive_angle
    case%spec%module = module
    case%spec%face_width = width
    call reader%get('pair', 'backlash_um', case%backlash, error, given=given, at_least=0.0_dp, at_most=1e9_dp, &
                    scale=1e-6_dp)
    case%has_backlash = given
  end subroutine read_pair

  subroutine read_member(reader, group, member, case, error)
    type(reader_t), intent(inout) :: reader
    character(*), intent(in) :: group
    integer, intent(in) :: member
    type(case_t), intent(inout) :: case
    type(error_t), allocatable, intent(inout) :: error
    character(*), parameter :: shape_keys(*) = [character(15) :: 'profile_shift', 'addendum', 'dedendum', &
                                                'rack_tip_radius', 'bore_mm']
    integer :: i
    logical :: needs_teeth

    associate (spec => case%spec(member))
      spec%name = group
      needs_teeth = .not. case%prescribed .or. member == 1
      call reader%get(group, 'teeth', spec%teeth, error, required=needs_teeth, at_least=5, at_most=100000)
      if (case%prescribed) then
        do i = 1, size(shape_keys)
          call reader%refuse(group, trim(shape_keys(i)), 'not used by a prescribed mesh (&mesh contact_ratio); remove it', error)
        end do
      else
        call reader%get(group, 'profile_shift', spec%profile_shift, error, above=-5.0_dp, below=5.0_dp)
        call reader%get(group, 'addendum', spec%addendum, error, above=0.0_dp, at_most=5.0_dp)
        call reader%get(group, 'dedendum', spec%dedendum, error, above=0.0_dp, at_most=5.0_dp)
        call reader%get(group, 'rack_tip_radius', spec%rack_tip_radius, error, at_least=0.0_dp, at_most=2.0_dp)
        call reader%get(group, 'bore_mm', spec%bore_radius, error, at_least=0.0_dp, scale=0.5e-3_dp)
      end if
    end associate
    call reader%get(group, 'effective_mass_kg', case%mass(member), error, at_least=1e-12_dp, at_most=1e12_dp)
    call reader%get(group, 'inertia_kgm2', case%inertia(member), error, at_least=1e-15_dp, at_most=1e15_dp)
    if (case%mass(member) > 0 .and. case%inertia(member) > 0) call fail(error, code_input, &
      '&'//group//' inertia_kgm2: give effective_mass_kg or inertia_kgm2, not both')
    if (case%prescribed .and. case%mass(member) <= 0 .and. case%inertia(member) <= 0) call fail(error, code_input, &
      '&'//group//' effective_mass_kg: missing; a prescribed mesh has no body to take it from; must be above 0')
  end subroutine read_member

  subroutine read_material(reader, case, error)
    type(reader_t), intent(inout) :: reader
    type(case_t), intent(inout) :: case
    type(error_t), allocatable, intent(inout) :: error
    character(*), parameter :: no_body = 'not used: the stiffness is stated'
    logical :: elements
    integer :: i

    if (allocated(error)) return
    elements = case%model == 'fe' .or. case%needs_section()
    if (.not. elements .and. (case%model == 'polynomial' .or. case%model == 'table')) then
      call reader%refuse('material', 'young_gpa', no_body, error)
      call reader%refuse('material', 'poisson', no_body, error)
    else
      call reader%get('material', 'young_gpa', case%material%young, error, at_least=1e-3_dp, at_most=1e4_dp, scale=1e9_dp)
      if (case%model == 'iso6336' .and. .not. elements) then
        call reader%refuse('material', 'poisson', 'not used by model = ''iso6336''', error)
      else
        call reader%get('material', 'poisson', case%material%poisson, error, at_least=0.0_dp, below=0.5_dp)
      end if
    end if
    if (all(case%mass > 0 .or. case%inertia > 0) .and. .not. case%asks('modal')) then
      call reader%refuse('material', 'density_kgm3', 'not used: both masses or inertias are stated', error)
    else
      call reader%get('material', 'density_kgm3', case%material%density, error, at_least=1.0_dp, at_most=1e5_dp)
    end if
    do i = 1, 2
      if (.not. elements .and. (case%mass(i) > 0 .or. case%inertia(i) > 0)) call reader%refuse( &
        case%spec(i)%name, 'bore_mm', 'not used: the mass or inertia is stated and no task looks at the body', error)
    end do
  end subroutine read_material

  subroutine read_load(reader, case, error)
    type(reader_t), intent(inout) :: reader
    type(case_t), intent(inout) :: case
    type(error_t), allocatable, intent(inout) :: error
    integer :: given

    call reader%get('load', 'torque_nm', case%torque, error, at_least=1e-12_dp, at_most=1e12_dp)
    call reader%get('load', 'normal_force_n', case%normal_force, error, at_least=1e-12_dp, at_most=1e12_dp)
    call reader%get('load', 'line_load_n_mm', case%line_load, error, at_least=1e-12_dp, at_most=1e7_dp, scale=1e3_dp)
    given = count([case%torque, case%normal_force, case%line_load] > 0)
    if (given > 1 .or. (given == 0 .and. case%needs_load())) call fail(error, code_input, &
      '&load: give one of torque_nm (on the pinion), normal_force_n and line_load_n_mm; '//str(given)//' are given')
    if (.not. case%prescribed) return
    if (case%torque > 0 .and. case%base_pitch <= 0) call fail(error, code_input, &
      '&mesh base_pitch_mm: missing; a torque on a prescribed mesh needs it; must be above 0')
    if (any(case%inertia > 0) .and. case%base_pitch <= 0) call fail(error, code_input, &
      '&mesh base_pitch_mm: missing; an inertia on a prescribed mesh needs it; must be above 0')
    if (case%line_load > 0 .and. case%spec(1)%face_width <= 0) call fail(error, code_input, &
      '&pair face_width_mm: missing; a line load needs it; must be above 0')
    if (case%line_load <= 0 .and. case%spec(1)%face_width > 0) call reader%refuse('pair', 'face_width_mm', &
      'a prescribed mesh uses it with line_load_n_mm only; remove it', error)
  end subroutine read_load

  subroutine read_relief(reader, case, error)
    type(reader_t), intent(inout) :: reader
    type(case_t), intent(inout) :: case
    type(error_t), allocatable, intent(inout) :: error
    character(:), allocatable :: shape
    logical :: has_length, has_roll(2)

    allocate (case%amount(1), source=0.0_dp)
    call reader%get('relief', 'amount_um', case%amount, error, required=reader%has_group('relief'), &
                    at_least=0.0_dp, at_most=1e9_dp, scale=1e-6_dp, max_size=10000)
    call reader%get('relief', 'pinion_fraction', case%fraction(1), error, at_least=0.0_dp, at_most=1000.0_dp)
    call reader%get('relief', 'gear_fraction', case%fraction(2), error, at_least=0.0_dp, at_most=1000.0_dp)
    shape = 'linear'
    call reader%get('relief', 'shape', shape, error, allowed=[character(9) :: 'linear', 'parabolic'])
    case%shape = merge(parabolic, linear, shape == 'parabolic')
    call reader%get('relief', 'length_mm', case%length, error, given=has_length, at_least=1e-6_dp, at_most=1e6_dp, &
                    scale=1e-3_dp)
    call reader%get('relief', 'pinion_roll_deg', case%roll(1), error, given=has_roll(1), above=0.0_dp, scale=pi/180)
    call reader%get('relief', 'gear_roll_deg', case%roll(2), error, given=has_roll(2), above=0.0_dp, scale=pi/180)
    case%start = 'hpstc'
    if (has_length) case%start = 'length'
    if (any(has_roll)) case%start = 'roll'
    call reader%get('relief', 'start', case%start, error, allowed=[character(6) :: 'hpstc', 'pitch', 'length', 'roll'])
    if (allocated(error)) return

    if (all(case%fraction <= 0)) call fail(error, code_input, &
      '&relief gear_fraction = 0: with pinion_fraction = 0 no member is relieved')
    if (has_length .neqv. case%start == 'length') call fail(error, code_input, &
      '&relief length_mm: goes with start = ''length'' and only with it')
    if (any(has_roll .neqv. (case%start == 'roll' .and. case%fraction > 0))) call fail(error, code_input, &
      '&relief pinion_roll_deg, gear_roll_deg: go with start = ''roll'', one for each relieved member')
    if (case%prescribed .and. case%start == 'roll') call fail(error, code_input, &
      '&relief start = ''roll'': a prescribed mesh has no roll angles; use length_mm')
    if (case%prescribed .and. has_length .and. case%base_pitch <= 0) call fail(error, code_input, &
      '&mesh base_pitch_mm: missing; &relief length_mm needs it; must be above 0')
  end subroutine read_relief

  subroutine read_dynamics(reader, case, error)
    type(reader_t), intent(inout) :: reader
    type(case_t), intent(inout) :: case
    type(error_t), allocatable, intent(inout) :: error
    character(*), parameter :: only_friction = 'a prescribed mesh uses it with friction only; remove it'

    call reader%get('dynamics', 'damping_ratio', case%damping_ratio, error, at_least=0.0_dp, at_most=1000.0_dp)
    call reader%get('dynamics', 'friction', case%friction, error, at_least=0.0_dp, below=1.0_dp)
    if (allocated(error) .or. .not. case%prescribed) return
    if (case%friction > 0) then
      if (case%spec(2)%teeth == 0) call fail(error, code_input, &
        '&gear teeth: missing; friction needs it; must be at least 5')
    else
      call reader%refuse('gear', 'teeth', only_friction, error)
      call reader%refuse('pair', 'pressure_angle_deg', only_friction, error)
      if (case%start /= 'pitch') call reader%refuse('mesh', 'pitch_point', &
        'a prescribed mesh uses it with friction or start = ''pitch'' only; remove it', error)
    end if
  end subroutine read_dynamics

  subroutine read_sweep(reader, case, error)
    type(reader_t), intent(inout) :: reader
    type(case_t), intent(inout) :: case
    type(error_t), allocatable, intent(inout) :: error
    character(:), allocatable :: direction
    logical :: needed

    needed = case%asks('sweep') .or. case%asks('optimum')
    call reader%get('sweep', 'rpm_first', case%rpm_first, error, required=needed, at_least=1e-6_dp, at_most=1e9_dp)
    call reader%get('sweep', 'rpm_last', case%rpm_last, error, required=needed, at_least=1e-6_dp, at_most=1e9_dp)
    call reader%get('sweep', 'rpm_step', case%rpm_step, error, required=needed, at_least=1e-9_dp)
    direction = 'up'
    call reader%get('sweep', 'direction', direction, error, allowed=[character(4) :: 'up', 'down', 'each'])
    call reader%get('sweep', 'load_rpm', case%load_rpm, error, required=case%asks('load'), at_least=1e-6_dp, &
                    at_most=1e9_dp, max_size=1000)
    if (allocated(error)) return
    select case (direction)
    case ('down')
      case%direction = down
    case ('each')
      case%direction = each
    case default
      case%direction = up
    end select
    if (case%rpm_last < case%rpm_first) call fail(error, code_input, '&sweep rpm_last = '//str(case%rpm_last)// &
      ': must not lie below rpm_first = '//str(case%rpm_first)//'; to sweep downwards, direction = ''down''')
    if (allocated(case%load_rpm)) then
      if (size(case%load_rpm)*size(case%amount) > most_paths) call fail(error, code_input, &
        '&sweep load_rpm: with '//str(size(case%amount))//' reliefs more than '//str(most_paths)//' paths')
    end if
    if (case%rpm_step > 0) then
      if ((1 + (case%rpm_last - case%rpm_first)/case%rpm_step)*size(case%amount) > most_points) call fail(error, code_input, &
        '&sweep rpm_step = '//str(case%rpm_step)//': more than '//str(most_points)//' operating points')
    end if
  end subroutine read_sweep

  subroutine read_numerics(reader, case, error)
    type(reader_t), intent(inout) :: reader
    type(case_t), intent(inout) :: case
    type(error_t), allocatable, intent(inout) :: error
    character(:), allocatable :: method

    associate (accuracy => case%accuracy)
      call reader%get('numerics', 'steps_per_period', accuracy%steps, error, at_least=0, at_most=accuracy%most_steps)
      call reader%get('numerics', 'tolerance', accuracy%steady%tolerance, error, at_least=1e-11_dp, at_most=0.1_dp)
      method = 'shooting'
      call reader%get('numerics', 'steady_state', method, error, allowed=[character(8) :: 'shooting', 'march'])
      accuracy%steady%method = merge(by_marching, by_shooting, method == 'march')
    end associate
  end subroutine read_numerics

  !> The body behind the teeth, the load positions at the root, and the modes.
  subroutine read_section(reader, case, error)
    type(reader_t), intent(inout) :: reader
    type(case_t), intent(inout) :: case
    type(error_t), allocatable, intent(inout) :: error
    character(:), allocatable :: fixed(:), plane, member, sharing, spacing
    logical :: stated

    associate (section => case%section, root => case%root)
      section%elements_across = 16
      section%others_across = 0
      call reader%get('section', 'teeth', section%teeth, error, at_least=0, at_most=100000)
      call reader%get('section', 'half_angle_deg', section%half_angle, error, above=0.0_dp, below=180.0_dp, scale=pi/180)
      call reader%get('section', 'rim_mm', section%rim, error, above=0.0_dp, scale=1e-3_dp)
      allocate (fixed, source=[character(5) :: 'sides', 'rim'])
      call reader%get('section', 'fixed', fixed, error, allowed=[character(5) :: 'sides', 'rim'])
      section%fixed_sides = any(fixed == 'sides')
      section%fixed_rim = any(fixed == 'rim')
      plane = 'strain'
      call reader%get('section', 'plane', plane, error, allowed=[character(6) :: 'stress', 'strain'])
      section%plane_strain = plane == 'strain'
      call reader%get('section', 'elements_across', section%elements_across, error, at_least=3, at_most=200)
      member = 'pinion'
      call reader%get('section', 'member', member, error, allowed=[character(6) :: 'pinion', 'gear'])
      root%member = merge(2, 1, member == 'gear')
      if (.not. case%needs_section()) call reader%refuse('section', 'member', &
        'not used: the stiffness takes both members', error)
      call reader%get('static', 'positions', root%positions, error, at_least=2, at_most=1000)
      spacing = 'path'
      call reader%get('static', 'spacing', spacing, error, allowed=[character(5) :: 'path', 'flank'])
      root%spacing = merge(spaced_on_flank, spaced_on_path, spacing == 'flank')
      sharing = 'mesh'
      call reader%get('static', 'sharing', sharing, error, allowed=[character(5) :: 'mesh', 'equal'])
      root%sharing = merge(shared_equally, shared_by_mesh, sharing == 'equal')
      call reader%get('static', 'shares', root%shares, error, given=stated, at_least=0.0_dp, at_most=1.0_dp)
      if (stated) then
        root%sharing = shares_stated
        call reader%refuse('static', 'sharing', 'the shares are stated; give one of the two', error)
        call reader%refuse('static', 'positions', 'there are as many as shares; remove it', error)
        call reader%refuse('static', 'spacing', 'stated shares stand at equal arcs of the flank; remove it', error)
        root%spacing = spaced_on_flank
        root%positions = size(root%shares)
        if (root%positions < 2) call fail(error, code_input, '&static shares: must be at least 2 numbers')
      end if
      call reader%get('static', 'tangent_deg', root%tangent, error, above=0.0_dp, below=90.0_dp, scale=pi/180)
    end associate
    call reader%get('modal', 'modes', case%modes, error, at_least=1, at_most=1000)
    if (case%prescribed) call reader%refuse_groups([character(7) :: 'section', 'static', 'modal'], &
                                                   'not used by a prescribed mesh (&mesh contact_ratio)', error)
  end subroutine read_section
end module gearsweep_case_reader
