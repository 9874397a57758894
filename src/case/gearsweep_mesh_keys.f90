!> What a case says of the mesh: &mesh, &load and &relief.
module gearsweep_mesh_keys
  use gearsweep_kinds, only: dp
  use gearsweep_case, only: case_t, for_iso, for_stage
  use gearsweep_error, only: code_input, error_t, fail
  use gearsweep_reader, only: reader_t
  use gearsweep_relief, only: linear, parabolic
  use gearsweep_task, only: stage, task_length, task_slot_t
  use gearsweep_uses, only: first_of, needs_gears, sentence_length, unless
  implicit none
  private
  public :: read_model, read_load, read_relief, read_path

  !> What keys of the relief need to be used.
  character(*), parameter :: relief_matters = 'optimum, deflection_relief or an amount above 0'

contains

  !> The stiffness; first, as it decides whether there is a geometry.
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
                    otherwise='that of the gears', meaning='contact ratio of a prescribed mesh, which has no geometry behind it')
    do i = 1, merge(size(case%tasks), 0, case%prescribed)
      if (case%tasks(i)%takes(stage%geometry)) call fail(error, code_input, '&case tasks = '''// &
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
    ! What belongs to a missing model is no error of its own.
    open = len(case%model) == 0
    call reader%get('mesh', 'coefficients', case%coefficients, error, unit='N/um', required=.not. open, &
                    at_least=-1e12_dp, at_most=1e12_dp, max_size=20, tasks=case%tasks_for(stage%mesh), &
                    refused=unless(open .or. case%model == 'polynomial', 'needs model = ''polynomial'''), &
                    otherwise='none; required with model = ''polynomial''', &
                    meaning='stiffness of one pair over the whole face width, in ascending powers of u, which goes from -1 at '// &
                    'A to 1 at E')
    call reader%get('mesh', 'file', case%file, error, required=.not. open, tasks=case%tasks_for(stage%mesh), &
                    refused=unless(open .or. case%model == 'table', 'needs model = ''table'''), &
                    otherwise='none; required with model = ''table''', &
                    meaning='file with a table of the path coordinate s and the pair stiffness; a relative name lies beside '// &
                    'the case')
  end subroutine read_model

  !> Exactly one of the three.
  subroutine read_load(reader, case, error)
    type(reader_t), intent(inout) :: reader
    type(case_t), intent(inout) :: case
    type(error_t), allocatable, intent(inout) :: error

    call reader%get('load', 'torque_nm', case%torque, error, unit='N m', one_of=.true., tasks=case%tasks_for(stage%mesh), &
                    at_least=1e-12_dp, at_most=1e12_dp, meaning='torque on the pinion')
    call reader%get('load', 'normal_force_n', case%normal_force, error, unit='N', one_of=.true., tasks=case%tasks_for(stage%mesh), &
                    at_least=1e-12_dp, at_most=1e12_dp, meaning='force on the line of action')
    call reader%get('load', 'line_load_n_mm', case%line_load, error, unit='N/mm', one_of=.true., tasks=case%tasks_for(stage%mesh), &
                    at_least=1e-12_dp, at_most=1e7_dp, meaning='force on the line of action over the face width')
    call reader%get('load', 'application_factor', case%iso%application_factor, error, lacks=for_iso(case, stage%rims), &
                    at_least=0.1_dp, at_most=10.0_dp, otherwise='1, a steady load', &
                    meaning='K_A of ISO 6336-1, for the tasks rating and life; a stiffness by iso6336 takes it '// &
                    'below 100 N/mm of F_t K_A/b')
  end subroutine read_load

  !> After the tasks' own keys, as the load of the root stress need not be shared by the mesh.
  subroutine read_relief(reader, case, error)
    type(reader_t), intent(inout) :: reader
    type(case_t), intent(inout) :: case
    type(error_t), allocatable, intent(inout) :: error
    character(:), allocatable :: shape
    character(sentence_length) :: lacks, with_relief
    logical :: has_length, has_roll(2)

    with_relief = case%tasks_for(stage%reliefs)
    lacks = for_stage(case, stage%reliefs)
    allocate (case%amount(1), source=0.0_dp)
    call reader%get('relief', 'amount_um', case%amount, error, unit='um', required=reader%has_group('relief'), &
                    tasks=with_relief, lacks=lacks, at_least=0.0_dp, at_most=1e9_dp, max_size=10000, distinct=.true., &
                    meaning='amounts of tip relief to compute, of gears each 0 or from 0.05 um to a tenth of the module; '// &
                    'required where this group is given')
    ! Nothing that is wanted differs between the reliefs.
    if (len_trim(lacks) > 0) case%amount = [0.0_dp]
    lacks = first_of(lacks, unless(case%relieves(), relief_matters))
    call reader%get('relief', 'pinion_fraction', case%fraction(1), error, tasks=with_relief, lacks=lacks, at_least=0.0_dp, &
                    at_most=1000.0_dp, meaning='relief at the pinion''s tip over the amount; 0 leaves the pinion as it is')
    call reader%get('relief', 'gear_fraction', case%fraction(2), error, tasks=with_relief, lacks=lacks, at_least=0.0_dp, &
                    at_most=1000.0_dp, meaning='relief at the gear''s tip over the amount; 0 leaves the gear as it is')
    shape = 'linear'
    call reader%get('relief', 'shape', shape, error, tasks=with_relief, lacks=lacks, &
                    allowed=[character(9) :: 'linear', 'parabolic'], &
                    meaning='how relief grows with the path coordinate, and so with the roll angle')
    case%shape = merge(parabolic, linear, shape == 'parabolic')
    call reader%get('relief', 'length_mm', case%length, error, unit='mm', given=has_length, tasks=with_relief, lacks=lacks, &
                    at_least=1e-6_dp, at_most=1e6_dp, otherwise='none; for start = ''length''', &
                    meaning='length of the relieved part of the path of contact, alike for both gears')
    call reader%get('relief', 'pinion_roll_deg', case%roll(1), error, unit='deg', given=has_roll(1), tasks=with_relief, &
                    lacks=lacks, above=0.0_dp, otherwise='none; for start = ''roll''', &
                    meaning='roll angle of the pinion at which its relief begins')
    call reader%get('relief', 'gear_roll_deg', case%roll(2), error, unit='deg', given=has_roll(2), tasks=with_relief, &
                    lacks=lacks, above=0.0_dp, otherwise='none; for start = ''roll''', &
                    meaning='roll angle of the gear at which its relief begins')
    case%start = 'hpstc'
    if (has_length) case%start = 'length'
    if (any(has_roll)) case%start = 'roll'
    call reader%get('relief', 'start', case%start, error, tasks=with_relief, lacks=lacks, &
                    allowed=[character(6) :: 'hpstc', 'pitch', 'length', 'roll'], &
                    otherwise='hpstc, or what length_mm or a roll angle says', &
                    meaning='where relief begins: at D and B (hpstc), at the pitch point, at a length from the ends of the '// &
                    'path of contact, or at a roll angle')
  end subroutine read_relief

  !> What else a prescribed mesh needs to be told: last, as it depends on the rest.
  subroutine read_path(reader, case, error)
    type(reader_t), intent(inout) :: reader
    type(case_t), intent(inout) :: case
    type(error_t), allocatable, intent(inout) :: error
    character(*), parameter :: by_hand = 'needs a prescribed mesh (&mesh contact_ratio)'
    character(sentence_length) :: made, lacks
    logical :: relieves, slopes

    made = unless(case%prescribed, by_hand)
    relieves = case%relieves()
    lacks = unless(case%torque > 0 .or. any(case%inertia > 0) .or. (relieves .and. case%length > 0) .or. case%asks('mesh'), 'mesh')
    call reader%get('mesh', 'base_pitch_mm', case%base_pitch, error, unit='mm', at_least=1e-6_dp, at_most=1e6_dp, &
                    lacks=lacks, refused=made, otherwise='that of the gears', &
                    meaning='base pitch of a prescribed mesh, for a torque, an inertia or a length of relief')
    lacks = ''
    slopes = reader%has('deviations', 'pinion_profile_slope_um') .or. reader%has('deviations', 'gear_profile_slope_um')
    if (.not. (relieves .and. case%start == 'pitch') .and. .not. (slopes .and. case%asks('as_built'))) then
      lacks = 'as_built'
      if (case%start == 'pitch') lacks = relief_matters
      if (case%friction > 0) lacks = for_stage(case, stage%motion)
    end if
    call reader%get('mesh', 'pitch_point', case%pitch_point, error, at_least=0.0_dp, lacks=lacks, &
                    refused=first_of(made, unless(case%friction > 0 .or. case%start == 'pitch' .or. slopes, &
                    'a prescribed mesh uses it with friction, start = ''pitch'' or a profile slope deviation only; remove it')), &
                    otherwise='half the contact ratio', &
                    meaning='path coordinate s of the pitch point of a prescribed mesh, at most the contact ratio')
    call read_beyond(reader, case, made, error)
    call read_contact(reader, case, error)
  end subroutine read_path

  !> What the stiffness of teeth by a model has beyond that of a pair on the path.
  subroutine read_contact(reader, case, error)
    type(reader_t), intent(inout) :: reader
    type(case_t), intent(inout) :: case
    type(error_t), allocatable, intent(inout) :: error
    character(*), parameter :: sharing = 'mesh, static, deflection_relief, precision or transient'
    character(sentence_length) :: geared, lacks
    integer :: i

    geared = unless(.not. case%prescribed, needs_gears)
    lacks = first_of(for_stage(case, stage%mesh), unless(case%model == 'fe', 'model = ''fe'''))
    call reader%get('mesh', 'tooth_coupling', case%tooth_coupling, error, tasks=case%tasks_for(stage%mesh), refused=geared, &
                    lacks=first_of(lacks, unless(case%section%teeth /= 1, 'a section of more than one tooth')), &
                    meaning='whether the load on a tooth moves the next one on the same body, with '// &
                    'model = ''fe''; papers whose pairs of teeth are springs side by side leave it out')
    call reader%get('mesh', 'corner_contact', case%corner_contact, error, tasks=case%tasks_for(stage%mesh), refused=geared, &
                    lacks=first_of(for_stage(case, stage%mesh), unless(case%models_teeth(), &
                    'model = ''fe'', ''weber'' or ''iso6336''')), &
                    meaning='whether a loaded pair may touch before A and behind E too, where the tip corner of one tooth '// &
                    'meets the other''s flank, with model = ''fe'', ''weber'' or ''iso6336''; papers whose contact ends at A '// &
                    'and E leave it out')
    lacks = unless(any([(shares_load(case%tasks(i)), i=1, size(case%tasks))]), sharing)
    call reader%get('mesh', 'nonlinear_contact', case%nonlinear_contact, error, tasks=sharing, refused=geared, &
                    lacks=first_of(lacks, unless(case%model == 'fe', 'model = ''fe''')), &
                    meaning='whether the static load sharing flattens flanks by the load that each pair carries (Hertz), with '// &
                    'model = ''fe''; otherwise by the nominal load, as the motion does')
  end subroutine read_contact

  !> Is this a task that is wanted, and shares the static load by the mesh?
  pure logical function shares_load(slot)
    type(task_slot_t), intent(in) :: slot

    shares_load = slot%takes(stage%reliefs) .and. any(slot%info%name == [character(task_length) :: 'mesh', 'static', 'precision', &
                                                                             'deflection_relief'])
    if (slot%info%name == 'transient') shares_load = slot%takes(stage%reliefs) .and. .not. slot%takes(stage%motion)
  end function shares_load

  !> What a prescribed mesh may have beside the stiffness of its pairs; `refused` where the mesh is not prescribed.
  subroutine read_beyond(reader, case, refused, error)
    type(reader_t), intent(inout) :: reader
    type(case_t), intent(inout) :: case
    character(*), intent(in) :: refused
    type(error_t), allocatable, intent(inout) :: error
    character(*), parameter :: relieved = 'has the reliefs in it; remove the amounts above 0 and the task optimum'
    character(sentence_length) :: lacks

    call reader%get('mesh', 'shared_compliance_um_n', case%shared_compliance, error, unit='um/N', &
                    tasks=case%tasks_for(stage%mesh), refused=refused, at_least=0.0_dp, at_most=1e6_dp, otherwise='none', &
                    meaning='how far a load on a pair of a prescribed mesh moves its neighbours too, as all act on the same '// &
                    'bodies: a part of each pair''s compliance')
    ! Stability feels it only where contact reaches beyond A and E.
    lacks = unless(case%model == 'table' .or. case%needs(stage%reliefs), case%tasks_for(stage%reliefs))
    call reader%get('mesh', 'profile_error_file', case%profile_error_file, error, tasks=case%tasks_for(stage%mesh), &
                    lacks=lacks, &
                    refused=first_of(refused, unless(.not. case%relieves(), relieved)), &
                    otherwise='none', &
                    meaning='file with a table of the path coordinate s and the profile error of a prescribed mesh in um, '// &
                    'through which splines go; where s comes twice, a new one begins. As far beyond A and E as it and a '// &
                    'table of the stiffness reach, a pair may be in contact; a relative name lies beside the case')
  end subroutine read_beyond
end module gearsweep_mesh_keys
