!> Keys of mesh and motion: &mesh, &load, &relief, &dynamics, &sweep and &numerics.
module gearsweep_study_case_mesh_keys
  use gearsweep_base, only: code_input, dp, error_t, fail
  use gearsweep_gear, only: linear, parabolic
  use gearsweep_motion, only: all_motions, both, by_marching, by_shooting, down, each, scheme_collocation, scheme_constant, &
    scheme_rk4, scheme_rk4_equal, up
  use gearsweep_study_case_case, only: case_t, for_iso, for_stage
  use gearsweep_study_case_task, only: stage, task_length, task_slot_t
  use gearsweep_study_reader_reader, only: first_nonblank, needs_gears, reader_t, sentence_length, text_unless
  implicit none
  private
  public :: read_model, read_load, read_relief, read_path, read_dynamics, read_sweep, read_numerics

  !> Condition for the keys of the relief to be used.
  character(*), parameter :: relief_matters = 'optimum, deflection_relief or an amount above 0'

contains

  !> Reads the stiffness first, as it decides whether there is a geometry.
  subroutine read_model(reader, case, error)
    type(reader_t), intent(inout) :: reader
    type(case_t), intent(inout) :: case
    type(error_t), allocatable, intent(inout) :: error
    character(*), parameter :: models(*) = [character(10) :: 'polynomial', 'table', 'fe', 'weber', 'iso6336']
    character(*), parameter :: of_model = 'stiffness of one pair of teeth: finite elements, Weber and Banaschek, ISO 6336-1 '// &
                                          'method B, the coefficients of a polynomial, or a table'
    logical :: open
    integer :: i

    case%prescribed = reader%has('mesh', 'contact_ratio')
    call reader%get('mesh', 'contact_ratio', case%contact_ratio, error, above=1.0_dp, at_most=20.0_dp, &
                    default_note='that of the gears', meaning='contact ratio of a prescribed mesh, which has no geometry behind it')
    do i = 1, merge(size(case%tasks), 0, case%prescribed)
      if (case%tasks(i)%needs(stage%geometry)) call fail(error, code_input, '&case tasks = '''// &
        trim(case%tasks(i)%info%name)//''': needs gears; a prescribed mesh (&mesh contact_ratio) has none')
    end do
    case%model = 'fe'
    if (case%prescribed) case%model = ''
    if (case%prescribed) then
      call reader%get('mesh', 'model', case%model, error, required=.true., allowed=models(:2), meaning=of_model)
    else
      call reader%get('mesh', 'model', case%model, error, tasks=case%tasks_for(stage%mesh), &
                      allowed=models([3, 4, 5, 1, 2]), meaning=of_model)
    end if
    if (allocated(error)) return
    ! A missing model is one error; its dependent keys add none.
    open = len(case%model) == 0
    call reader%get('mesh', 'coefficients', case%coefficients, error, unit='N/um', required=.not. open, &
                    at_least=-1e12_dp, at_most=1e12_dp, max_size=20, tasks=case%tasks_for(stage%mesh), &
                    not_allowed=text_unless(open .or. case%model == 'polynomial', 'needs model = ''polynomial'''), &
                    default_note='none; required with model = ''polynomial''', &
                    meaning='stiffness of one pair over the whole face width, in ascending powers of u, which goes from -1 at '// &
                    'A to 1 at E')
    call reader%get('mesh', 'file', case%file, error, required=.not. open, tasks=case%tasks_for(stage%mesh), &
                    not_allowed=text_unless(open .or. case%model == 'table', 'needs model = ''table'''), &
                    default_note='none; required with model = ''table''', &
                    meaning='file with a table of the path coordinate s and the pair stiffness; a relative name lies beside '// &
                    'the case')
  end subroutine read_model

  !> Reads exactly one of the four keys of the load.
  subroutine read_load(reader, case, error)
    type(reader_t), intent(inout) :: reader
    type(case_t), intent(inout) :: case
    type(error_t), allocatable, intent(inout) :: error

    call reader%get('load', 'torque_nm', case%torque, error, unit='N m', one_of=.true., tasks=case%tasks_for(stage%mesh), &
                    at_least=1e-12_dp, at_most=1e12_dp, meaning='torque on the pinion')
    call reader%get('load', 'torques_nm', case%torques, error, unit='N m', one_of=.true., tasks=case%tasks_for(stage%mesh), &
                    at_least=1e-12_dp, at_most=1e12_dp, min_size=1, max_size=20, distinct=.true., &
                    meaning='torques on the pinion over which the task optimum judges reliefs; all else is computed at the '// &
                    'largest of them')
    if (allocated(case%torques)) then
      if (case%torque > 0) call fail(error, code_input, '&load torques_nm: give torque_nm, or several torques_nm, '// &
                                     'not both')
      case%torque = maxval(case%torques)
    end if
    call reader%get('load', 'normal_force_n', case%normal_force, error, unit='N', one_of=.true., tasks=case%tasks_for(stage%mesh), &
                    at_least=1e-12_dp, at_most=1e12_dp, meaning='force on the line of action')
    call reader%get('load', 'line_load_n_mm', case%line_load, error, unit='N/mm', one_of=.true., tasks=case%tasks_for(stage%mesh), &
                    at_least=1e-12_dp, at_most=1e7_dp, meaning='force on the line of action over the face width')
    call reader%get('load', 'application_factor', case%iso%application_factor, error, unused_without=for_iso(case, stage%rims), &
                    at_least=0.1_dp, at_most=10.0_dp, default_note='1, a steady load', &
                    meaning='K_A of ISO 6336-1, for the tasks rating and life; a stiffness by iso6336 takes it '// &
                    'below 100 N/mm of F_t K_A/b')
  end subroutine read_load

  !> Reads &relief after the tasks' own keys, as the mesh need not share the load of the root stress.
  subroutine read_relief(reader, case, error)
    type(reader_t), intent(inout) :: reader
    type(case_t), intent(inout) :: case
    type(error_t), allocatable, intent(inout) :: error
    character(:), allocatable :: shape
    character(sentence_length) :: unused_without, with_relief
    logical :: has_length, has_roll(2)

    with_relief = case%tasks_for(stage%reliefs)
    unused_without = for_stage(case, stage%reliefs)
    allocate (case%amount(1), source=0.0_dp)
    call reader%get('relief', 'amount_um', case%amount, error, unit='um', required=reader%has_group('relief'), &
                    tasks=with_relief, unused_without=unused_without, at_least=0.0_dp, at_most=1e9_dp, max_size=10000, &
                    distinct=.true., &
                    meaning='amounts of tip relief to compute, of gears each 0 or from 0.05 um to a tenth of the module; '// &
                    'required where this group is given')
    ! No requested result depends on the relief.
    if (len_trim(unused_without) > 0) case%amount = [0.0_dp]
    unused_without = first_nonblank(unused_without, text_unless(case%has_relief(), relief_matters))
    call reader%get('relief', 'pinion_fraction', case%fraction(1), error, tasks=with_relief, unused_without=unused_without, &
                    at_least=0.0_dp, &
                    at_most=1000.0_dp, meaning='relief at the pinion''s tip over the amount; 0 leaves the pinion as it is')
    call reader%get('relief', 'gear_fraction', case%fraction(2), error, tasks=with_relief, unused_without=unused_without, &
                    at_least=0.0_dp, &
                    at_most=1000.0_dp, meaning='relief at the gear''s tip over the amount; 0 leaves the gear as it is')
    shape = 'linear'
    call reader%get('relief', 'shape', shape, error, tasks=with_relief, unused_without=unused_without, &
                    allowed=[character(9) :: 'linear', 'parabolic'], &
                    meaning='how relief grows with the path coordinate, and so with the roll angle')
    case%shape = merge(parabolic, linear, shape == 'parabolic')
    call reader%get('relief', 'length_mm', case%length, error, unit='mm', is_stated=has_length, tasks=with_relief, &
                    unused_without=unused_without, at_least=1e-6_dp, at_most=1e6_dp, default_note='none; for start = ''length''', &
                    meaning='length of the relieved part of the path of contact, alike for both gears')
    call reader%get('relief', 'pinion_roll_deg', case%roll(1), error, unit='deg', is_stated=has_roll(1), tasks=with_relief, &
                    unused_without=unused_without, above=0.0_dp, default_note='none; for start = ''roll''', &
                    meaning='roll angle of the pinion at which its relief begins')
    call reader%get('relief', 'gear_roll_deg', case%roll(2), error, unit='deg', is_stated=has_roll(2), tasks=with_relief, &
                    unused_without=unused_without, above=0.0_dp, default_note='none; for start = ''roll''', &
                    meaning='roll angle of the gear at which its relief begins')
    case%start = 'hpstc'
    if (has_length) case%start = 'length'
    if (any(has_roll)) case%start = 'roll'
    call reader%get('relief', 'start', case%start, error, tasks=with_relief, unused_without=unused_without, &
                    allowed=[character(6) :: 'hpstc', 'pitch', 'length', 'roll'], &
                    default_note='hpstc, or what length_mm or a roll angle says', &
                    meaning='where relief begins: at D and B (hpstc), at the pitch point, at a length from the ends of the '// &
                    'path of contact, or at a roll angle')
  end subroutine read_relief

  !> Reads the other keys of a prescribed mesh last, as they depend on all others.
  subroutine read_path(reader, case, error)
    type(reader_t), intent(inout) :: reader
    type(case_t), intent(inout) :: case
    type(error_t), allocatable, intent(inout) :: error
    character(*), parameter :: by_hand = 'needs a prescribed mesh (&mesh contact_ratio)'
    character(sentence_length) :: made, unused_without, geared
    logical :: has_relief, slopes
    character(*), parameter :: relieved = 'has the reliefs in it; remove the amounts above 0 and the task optimum'
    character(*), parameter :: sharing = 'mesh, static, optimum, deflection_relief, precision or transient'
    integer :: i

    made = text_unless(case%prescribed, by_hand)
    has_relief = case%has_relief()
    unused_without = text_unless(case%torque > 0 .or. any(case%inertia > 0) .or. (has_relief .and. case%length > 0) .or. &
                   case%requests('mesh') .or. case%requests('optimum'), 'mesh or optimum')
    call reader%get('mesh', 'base_pitch_mm', case%base_pitch, error, unit='mm', at_least=1e-6_dp, at_most=1e6_dp, &
                    unused_without=unused_without, not_allowed=made, default_note='that of the gears', &
                    meaning='base pitch of a prescribed mesh, for a torque, an inertia or a length of relief')
    unused_without = ''
    slopes = reader%has('deviations', 'pinion_profile_slope_um') .or. reader%has('deviations', 'gear_profile_slope_um')
    if (.not. (has_relief .and. case%start == 'pitch') .and. .not. (slopes .and. case%requests('as_built'))) then
      unused_without = 'as_built'
      if (case%start == 'pitch') unused_without = relief_matters
      if (case%friction > 0) unused_without = for_stage(case, stage%motion)
    end if
    call reader%get('mesh', 'pitch_point', case%pitch_point, error, at_least=0.0_dp, unused_without=unused_without, &
                    not_allowed=first_nonblank(made, text_unless(case%friction > 0 .or. case%start == 'pitch' .or. slopes, &
                    'a prescribed mesh uses it with friction, start = ''pitch'' or a profile slope deviation only; remove it')), &
                    default_note='half the contact ratio', &
                    meaning='path coordinate s of the pitch point of a prescribed mesh, at most the contact ratio')
    call reader%get('mesh', 'shared_compliance_um_n', case%shared_compliance, error, unit='um/N', &
                    tasks=case%tasks_for(stage%mesh), not_allowed=made, at_least=0.0_dp, at_most=1e6_dp, default_note='none', &
                    meaning='how far a load on a pair of a prescribed mesh moves its neighbours too, as all act on the same '// &
                    'bodies: a part of each pair''s compliance')
    ! Stability depends on it only if contact extends beyond A and E.
    unused_without = text_unless(case%model == 'table' .or. case%needs(stage%reliefs), case%tasks_for(stage%reliefs))
    call reader%get('mesh', 'profile_error_file', case%profile_error_file, error, tasks=case%tasks_for(stage%mesh), &
                    unused_without=unused_without, &
                    not_allowed=first_nonblank(made, text_unless(.not. case%has_relief(), relieved)), &
                    default_note='none', &
                    meaning='file with a table of the path coordinate s and the profile error of a prescribed mesh in um, '// &
                    'through which splines go; where s comes twice, a new one begins. As far beyond A and E as it and a '// &
                    'table of the stiffness reach, a pair may be in contact; a relative name lies beside the case')
    geared = text_unless(.not. case%prescribed, needs_gears)
    unused_without = first_nonblank(for_stage(case, stage%mesh), text_unless(case%model == 'fe', 'model = ''fe'''))
    call reader%get('mesh', 'tooth_coupling', case%tooth_coupling, error, tasks=case%tasks_for(stage%mesh), not_allowed=geared, &
                    unused_without=first_nonblank(unused_without, text_unless(case%section%teeth /= 1, &
                    'a section of more than one tooth')), &
                    meaning='whether the load on a tooth moves the next one on the same body, with '// &
                    'model = ''fe''; papers whose pairs of teeth are springs side by side leave it out')
    call reader%get('mesh', 'corner_contact', case%corner_contact, error, tasks=case%tasks_for(stage%mesh), not_allowed=geared, &
                    unused_without=first_nonblank(for_stage(case, stage%mesh), text_unless(case%models_teeth() .and. .not. &
                    case%is_helical(), 'model = ''fe'', ''weber'' or ''iso6336'' and spur gears')), &
                    meaning='whether a loaded pair may touch before A and behind E too, where the tip corner of one tooth '// &
                    'meets the other''s flank, with model = ''fe'', ''weber'' or ''iso6336''; papers whose contact ends at A '// &
                    'and E leave it out')
    unused_without = text_unless(any([(shares_load(case%tasks(i)), i=1, size(case%tasks))]), sharing)
    call reader%get('mesh', 'nonlinear_contact', case%nonlinear_contact, error, tasks=sharing, not_allowed=geared, &
                    unused_without=first_nonblank(unused_without, text_unless(case%model == 'fe', 'model = ''fe''')), &
                    meaning='whether the static load sharing flattens flanks by the load that each pair carries (Hertz), with '// &
                    'model = ''fe''; otherwise by the nominal load, as the motion does')
  end subroutine read_path

  !> True if this task is requested and the mesh shares its static load.
  pure logical function shares_load(slot)
    type(task_slot_t), intent(in) :: slot

    shares_load = slot%needs(stage%reliefs) .and. any(slot%info%name == [character(task_length) :: 'mesh', 'static', 'precision', &
                                                                             'optimum', 'deflection_relief'])
    if (slot%info%name == 'transient') shares_load = slot%needs(stage%reliefs) .and. .not. slot%needs(stage%motion)
  end function shares_load

  subroutine read_dynamics(reader, case, error)
    type(reader_t), intent(inout) :: reader
    type(case_t), intent(inout) :: case
    type(error_t), allocatable, intent(inout) :: error

    call reader%get('dynamics', 'damping_ratio', case%damping_ratio, error, tasks=case%tasks_for(stage%losses), at_least=0.0_dp, &
                    at_most=1000.0_dp, meaning='damping ratio zeta; the damping force follows the stiffness of the pairs in '// &
                    'contact and vanishes when no flanks touch')
    case%has_damping = reader%has('dynamics', 'damping_ratio')
    call reader%get('dynamics', 'friction', case%friction, error, tasks=case%tasks_for(stage%motion), &
                    at_least=0.0_dp, below=1.0_dp, &
                    meaning='coefficient of friction, with the sign of the sliding before and after the pitch point')
  end subroutine read_dynamics

  subroutine read_sweep(reader, case, error)
    type(reader_t), intent(inout) :: reader
    type(case_t), intent(inout) :: case
    type(error_t), allocatable, intent(inout) :: error
    character(*), parameter :: ways(*) = [character(4) :: 'both', 'up', 'down', 'each', 'all']
    integer, parameter :: directions(*) = [both, up, down, each, all_motions]
    character(:), allocatable :: direction
    character(sentence_length) :: over_speed

    over_speed = case%tasks_for(stage%speeds)
    call reader%get('sweep', 'rpm_first', case%rpm_first, error, unit='1/min', required=.true., tasks=over_speed, &
                    at_least=1e-6_dp, at_most=1e9_dp, meaning='first speed of the pinion')
    call reader%get('sweep', 'rpm_last', case%rpm_last, error, unit='1/min', required=.true., tasks=over_speed, &
                    at_least=1e-6_dp, at_most=1e9_dp, meaning='last speed, if the step divides the range; not below rpm_first')
    call reader%get('sweep', 'rpm_step', case%rpm_step, error, unit='1/min', required=.true., tasks=over_speed, &
                    at_least=1e-9_dp, meaning='step from one speed to the next; speeds times reliefs may be at most 1e7')
    direction = 'both'
    call reader%get('sweep', 'direction', direction, error, tasks=case%tasks_for(stage%direction), allowed=ways, &
                    meaning='where several steady motions exist: follow the one found at the speed below (up), at the speed '// &
                    'above (down), or up and, where that loses contact, down too, and take the one of larger dynamic factor '// &
                    '(both); or solve each speed by itself (each), in the sweep counting all that attract there (all)')
    case%direction = sum(pack(directions, ways == direction))
  end subroutine read_sweep

  subroutine read_numerics(reader, case, error)
    type(reader_t), intent(inout) :: reader
    type(case_t), intent(inout) :: case
    type(error_t), allocatable, intent(inout) :: error
    character(*), parameter :: methods(*) = [character(11) :: 'collocation', 'rk4', 'rk4_equal', 'constant']
    integer, parameter :: schemes(*) = [scheme_collocation, scheme_rk4, scheme_rk4_equal, scheme_constant]
    character(:), allocatable :: method

    method = 'collocation'
    call reader%get('numerics', 'method', method, error, tasks=case%tasks_for(stage%accuracy), allowed=methods, &
                    meaning='how the equation of motion is integrated: Gauss collocation with changes of contact located '// &
                    '(collocation), or as in the literature, to reproduce it: Runge-Kutta in steps that end at the breaks '// &
                    '(rk4), in equal steps (rk4_equal, Dogan et al. 2021), or the exact motion over equal steps with '// &
                    'constant coefficients (constant, Karpat et al. 2012)')
    case%accuracy%scheme = sum(pack(schemes, methods == method))
    associate (accuracy => case%accuracy)
      call reader%get('numerics', 'steps_per_period', accuracy%steps, error, tasks=case%tasks_for(stage%accuracy), at_least=0, &
                      at_most=accuracy%most_steps, meaning='steps in a mesh period, about, as steps end where stiffness or '// &
                      'relief has a break; 0 chooses them for the tolerance at each speed, or 200 by the methods of the literature')
      call reader%get('numerics', 'tolerance', accuracy%steady%tolerance, error, tasks=case%tasks_for(stage%accuracy), &
                      at_least=1e-11_dp, at_most=0.1_dp, meaning='largest estimated error of a dynamic factor; the search for '// &
                      'the optimum relief uses 1e-5 where this is smaller')
      method = 'shooting'
      call reader%get('numerics', 'steady_state', method, error, tasks=case%tasks_for(stage%accuracy), &
                      allowed=[character(8) :: 'shooting', 'march'], &
                      meaning='how the steady motion is found: Newton''s method on the map of one period (shooting), or '// &
                      'marching until the transients have died out (march)')
      accuracy%steady%method = merge(by_marching, by_shooting, method == 'march')
    end associate
  end subroutine read_numerics
end module gearsweep_study_case_mesh_keys
