!> Keys of the gears: &pair, &pinion, &gear, &material, and &section for the gear bodies.
!>
!> &material applies to both gears; the same keys of &pinion and &gear apply to one.
module gearsweep_study_case_gear_keys
  use gearsweep_base, only: code_input, dp, error_t, fail, join, pi, str
  use gearsweep_gear, only: coast, drive, gear_spec_t
  use gearsweep_elastic, only: material_t
  use gearsweep_study_case_case, only: case_t, for_iso, for_stage
  use gearsweep_study_case_task, only: sentence_of, stage, task_length
  use gearsweep_study_reader_reader, only: first_nonblank, needs_gears, reader_t, sentence_length, text_unless
  implicit none
  private
  public :: read_materials, read_section, read_pair, read_gear, read_direction

  integer, parameter :: young = 1, poisson = 2, density = 3
  !> Impossible values, which mark properties that are not stated.
  type(material_t), parameter :: not_given = material_t(0.0_dp, -1.0_dp, 0.0_dp)

contains

  !> Reads the materials, after the section, which names a gear, and the gears, whose masses decide about the density.
  subroutine read_materials(reader, case, error)
    type(reader_t), intent(inout) :: reader
    type(case_t), intent(inout) :: case
    type(error_t), allocatable, intent(inout) :: error
    character(sentence_length), parameter :: users(*) = [character(sentence_length) :: &
      'modal, deflection_relief, as_built, precision, flank, rating, transient, harmonic, body_modes or a stiffness that is '// &
      'computed', &
      'static, modal, deflection_relief, as_built, precision, flank, rating, transient, harmonic, body_modes or a stiffness '// &
      'that depends on it', &
      'modal, precision, flank, transient, harmonic, body_modes or a mass that is not stated']
    logical :: counts(3, 2), own(3, 2)
    character(sentence_length) :: geared, unused_without(3)
    type(material_t) :: common
    integer :: i

    if (allocated(error)) return
    geared = text_unless(.not. case%prescribed, needs_gears)
    do i = 1, 2
      counts(:, i) = uses_of(case, i)
      unused_without = ''
      where (.not. counts(:, &
        i)) unused_without = 'a stiffness or mass that depends on it, or a task that takes this gear (&section gear)'
      case%material(i) = not_given
      call read_group(reader, trim(case%spec(i)%name), unused_without, geared, case%material(i), error)
      own(:, i) = [case%material(i)%young > 0, case%material(i)%poisson >= 0, case%material(i)%density > 0]
    end do
    do i = 1, 3
      unused_without(i) = first_nonblank(text_unless(any(counts(i, :)), users(i)), &
                          text_unless(any(counts(i, :) .and. .not. own(i, :)), 'a gear without its own'))
    end do
    call read_group(reader, 'material', unused_without, geared, common, error)
    do i = 1, 2
      if (.not. own(young, i)) case%material(i)%young = common%young
      if (.not. own(poisson, i)) case%material(i)%poisson = common%poisson
      if (.not. own(density, i)) case%material(i)%density = common%density
    end do
  end subroutine read_materials

  !> Flags for modulus, Poisson's ratio and density of a gear: true if a result depends on it.
  pure function uses_of(case, gear) result(uses)
    type(case_t), intent(in) :: case
    integer, intent(in) :: gear
    logical :: uses(3), deflects, vibrates, touches

    deflects = case%needs(stage%mesh) .and. case%models_teeth()
    ! Printed values may be those of a tooth as a beam.
    vibrates = case%requests('modal') .or. case%requests('precision') .or. case%requests('transient') .or. &
               case%requests('harmonic') .or. case%needs(stage%solid) .or. allocated(case%published)
    vibrates = vibrates .and. gear == case%gear
    touches = case%needs(stage%elasticity)
    uses(young) = deflects .or. vibrates .or. touches
    uses(poisson) = (deflects .and. case%model /= 'iso6336') .or. touches .or. &
                    ((case%needs(stage%body) .or. case%needs(stage%solid)) .and. gear == case%gear)
    uses(density) = case%computes_mass(gear) .or. vibrates .or. case%needs(stage%density)
  end function uses_of

  !> Reads the keys of one group; for a single gear without defaults.
  subroutine read_group(reader, group, unused_without, geared, material, error)
    type(reader_t), intent(inout) :: reader
    character(*), intent(in) :: group, unused_without(:), geared
    type(material_t), intent(inout) :: material
    type(error_t), allocatable, intent(inout) :: error
    character(:), allocatable :: common          !< not allocated: not stated

    if (group /= 'material') common = 'that of &material'
    call reader%get(group, 'young_gpa', material%young, error, unit='GPa', at_least=1e-3_dp, at_most=1e4_dp, &
                    unused_without=unused_without(young), not_allowed=geared, default_note=common, &
                    meaning='Young''s modulus, for a stiffness that is computed, natural modes and contact pressure; root '// &
                    'stress depends on it only in how pairs share the load')
    call reader%get(group, 'poisson', material%poisson, error, at_least=0.0_dp, below=0.5_dp, &
                    unused_without=unused_without(poisson), not_allowed=geared, default_note=common, &
                    meaning='Poisson''s ratio, for a stiffness by fe or weber, root stress, natural modes and contact pressure')
    call reader%get(group, 'density_kgm3', material%density, error, unit='kg/m^3', at_least=1.0_dp, at_most=1e5_dp, &
                    unused_without=unused_without(density), not_allowed=geared, default_note=common, &
                    meaning='density, for natural modes, flash temperature and gears with neither mass nor inertia given')
  end subroutine read_group

  subroutine read_section(reader, case, error)
    type(reader_t), intent(inout) :: reader
    type(case_t), intent(inout) :: case
    type(error_t), allocatable, intent(inout) :: error
    character(2*sentence_length) :: with_body, with_support
    character(sentence_length) :: geared, shape, fineness, support, looks
    character(:), allocatable :: fixed(:), plane, gear

    if (allocated(error)) return
    geared = text_unless(.not. case%prescribed, needs_gears)
    with_body = sentence_of(case%tasks, stage%section, other=stage%mesh)
    with_support = 'modal, '//case%tasks_for(stage%mesh)
    shape = text_unless(case%needs(stage%section) .or. case%needs_elements(), &
                   'static, modal, precision, transient, harmonic or a stiffness by elements')
    ! The task precision has a grid refinement of its own.
    fineness = text_unless(case%requests('static') .or. case%requests('modal') .or. &
                      case%requests('transient') .or. case%requests('harmonic') .or. case%needs_elements(), &
                      'static, modal, transient, harmonic or a stiffness by elements')
    support = text_unless(case%needs(stage%body) .or. case%needs_elements(), &
                     'static, modal, precision, transient, harmonic or a stiffness by elements')
    ! Printed values may be those of a tooth of this gear.
    looks = text_unless(case%needs(stage%section) .or. case%needs(stage%solid) .or. allocated(case%published), &
                   'static, modal, precision, transient, harmonic or body_modes')
    associate (section => case%section)
      section%elements_across = 16
      section%others_across = 0
      call reader%get('section', 'teeth', section%teeth, error, tasks=with_body, unused_without=shape, not_allowed=geared, &
                      at_least=0, at_most=100000, is_stated=case%has_extent, &
                      default_note='3; without fixed, the pair stiffness is that of the whole gear', &
                      meaning='teeth in the section, the middle one (of an even number, the left one of the two) loaded; '// &
                      '0, or as many as the gear has without half_angle_deg, for the whole gear')
      call reader%get('section', 'half_angle_deg', section%half_angle, error, unit='deg', tasks=with_body, unused_without=shape, &
                      not_allowed=geared, above=0.0_dp, below=180.0_dp, default_note='to the middle of the outer spaces', &
                      meaning='angle from the section''s axis to either of its cut sides, which must lie between the fillets '// &
                      'of the outer teeth and the next teeth')
      call reader%get('section', 'rim_mm', section%rim, error, unit='mm', tasks=with_body, unused_without=shape, &
                      not_allowed=geared, above=0.0_dp, default_note='down to the bore, or 2.5 tooth heights', &
                      meaning='thickness of the body below the root circle; it must leave room to the bore; without it and '// &
                      'fixed, the pair stiffness of a gear with a web takes its rim_thickness_mm, free inside')
      call reader%get('section', 'elements_across', section%elements_across, error, tasks=with_body, unused_without=fineness, &
                      not_allowed=geared, at_least=3, at_most=200, &
                      meaning='finite elements across the loaded tooth, which all else follows')
      allocate (fixed, source=[character(5) :: 'sides', 'rim'])
      call reader%get('section', 'fixed', fixed, error, tasks=with_support, unused_without=support, not_allowed=geared, &
                      allowed=[character(5) :: 'sides', 'rim'], &
                      is_stated=case%has_support, &
                      default_note='sides and rim; without teeth, a whole gear''s pair stiffness is held at the bore', &
                      meaning='what is held: the two cut sides, the inner edge; a whole gear has no sides, so its inner '// &
                      'edge must be held')
      case%has_extent = case%has_extent .or. reader%has('section', 'half_angle_deg')
      section%fixed_sides = any(fixed == 'sides')
      section%fixed_rim = any(fixed == 'rim')
      plane = 'strain'
      call reader%get('section', 'plane', plane, error, tasks=with_support, unused_without=support, not_allowed=geared, &
                      allowed=[character(6) :: 'stress', 'strain'], &
                      meaning='plane strain suits a wide gear, plane stress a thin one')
      section%plane_strain = plane == 'strain'
    end associate
    gear = 'pinion'
    call reader%get('section', 'gear', gear, error, unused_without=looks, not_allowed=geared, &
                    allowed=[character(6) :: 'pinion', 'gear'], &
                    meaning='the gear whose section the tasks static, modal, precision, transient and harmonic take, '// &
                    'and whose body body_modes')
    case%gear = merge(2, 1, gear == 'gear')
  end subroutine read_section

  !> Reads &pair after load and friction, which decide which of its keys a prescribed mesh needs.
  subroutine read_pair(reader, case, error)
    type(reader_t), intent(inout) :: reader
    type(case_t), intent(inout) :: case
    type(error_t), allocatable, intent(inout) :: error
    real(dp), parameter :: degree = pi/180
    real(dp) :: module, width, drive_angle, coast_angle, helix_angle
    character(sentence_length) :: geared, slides
    character(:), allocatable :: hand
    logical :: cut, inclined

    cut = .not. case%prescribed
    ! Run-out moves drive and coast flanks by the angle between their lines of action.
    inclined = case%friction > 0 .or. (reader%has('pair', 'backlash_um') .and. &
                                       (reader%has('deviations', 'pinion_runout_um') .or. &
                                        reader%has('deviations', 'gear_runout_um')))
    geared = text_unless(cut, needs_gears)
    slides = ''
    if (case%prescribed) slides = for_stage(case, stage%motion)
    module = 0
    width = 0
    drive_angle = 20*degree
    call reader%get('pair', 'module_mm', module, error, unit='mm', required=.true., not_allowed=geared, &
                    at_least=0.05_dp, at_most=1000.0_dp, meaning='normal module')
    call reader%get('pair', 'face_width_mm', width, error, unit='mm', required=cut, not_allowed=text_unless(cut .or. &
                    case%line_load > 0, &
                    'a prescribed mesh uses it with line_load_n_mm only; remove it'), at_least=0.005_dp, at_most=1e5_dp, &
                    meaning='common face width of the two gears, at least a tenth of the module')
    call reader%get('pair', 'pressure_angle_deg', drive_angle, error, unit='deg', unused_without=slides, &
                    not_allowed=text_unless(cut .or. inclined, &
                    'a prescribed mesh uses it with friction, or with run-out and backlash, '// &
                                   'only; remove it'), above=3.0_dp, below=45.0_dp, &
                    meaning='pressure angle of the rack on the drive flanks; of a prescribed mesh with friction, or with '// &
                    'run-out and backlash, the working pressure angle')
    helix_angle = 0
    call reader%get('pair', 'helix_angle_deg', helix_angle, error, unit='deg', not_allowed=geared, at_least=0.0_dp, &
                    at_most=35.0_dp, default_note='0, spur gears', &
                    meaning='helix angle on the reference circle; module, pressure angle and the factors of the rack are then '// &
                    'those of the normal section; the tasks geometry, face_load, sweep, rating and life only, a load over the '// &
                    'face up to 30')
    if (helix_angle > 0) call refuse_tasks(case, helix_angle/degree, error)
    hand = 'right'
    call reader%get('pair', 'pinion_hand', hand, error, allowed=[character(5) :: 'right', 'left'], default_note='right', &
                    not_allowed=first_nonblank(geared, text_unless(helix_angle > 0, &
                    'is for helical gears, helix_angle_deg; remove it')), &
                    meaning='hand of the helix of the pinion; that of the gear is opposite')
    coast_angle = drive_angle
    call reader%get('pair', 'coast_angle_deg', coast_angle, error, unit='deg', not_allowed=first_nonblank(geared, &
                    text_unless(.not. helix_angle > 0, 'helical gears have equal pressure angles; remove it')), &
                    above=3.0_dp, below=45.0_dp, &
                    default_note='as pressure_angle_deg', &
                    meaning='pressure angle of the rack on the coast flanks, for asymmetric teeth')
    call reader%get('pair', 'centre_distance_mm', case%centre_distance, error, unit='mm', not_allowed=geared, above=0.0_dp, &
                    default_note='without backlash', &
                    meaning='working centre distance, at least the one without backlash')
    call reader%get('pair', 'tip_alteration', case%tip_alteration, error, not_allowed=geared, &
                    meaning='shortens the tips so that the rack''s bottom clearance is kept at this centre distance '// &
                    '(ISO 21771); never lengthens them')
    call reader%get('pair', 'shorten_path', case%shorten_path, error, not_allowed=geared, &
                    meaning='where undercut takes flank that the partner''s tip would work on, ends the path of contact '// &
                    'where the involute ends; without it such gears are refused')
    call reader%get('pair', 'backlash_um', case%backlash, error, unit='um', is_stated=case%has_backlash, &
                    tasks=text_unless(cut, trim(case%tasks_for(stage%losses))), at_least=0.0_dp, at_most=1e9_dp, &
                    default_note='where a gear has a thickness allowance, what follows from it; else the coast flanks never '// &
                    'touch', &
                    meaning='backlash along the line of action: the coast flanks touch once the drive flanks are this far '// &
                    'apart')
    case%spec%pressure_angle(1) = drive_angle
    if (cut) case%spec%pressure_angle(2) = coast_angle
    case%spec%module = module
    case%spec%helix_angle = helix_angle*merge([-1, 1], [1, -1], hand == 'left')
    case%spec%face_width = width
  end subroutine read_pair

  !> Refuses tasks that are for spur gears only, of a case with this helix angle (degrees).
  subroutine refuse_tasks(case, helix_angle, error)
    type(case_t), intent(in) :: case
    real(dp), intent(in) :: helix_angle
    type(error_t), allocatable, intent(inout) :: error
    character(task_length), allocatable :: helical(:)
    integer :: i

    helical = [(case%tasks(i)%info%name, i=1, size(case%tasks))]
    helical = pack(helical, [(case%tasks(i)%info%has_helical, i=1, size(case%tasks))])
    do i = 1, size(case%tasks)
      associate (slot => case%tasks(i))
        if (slot%is_requested .and. .not. slot%info%has_helical) call fail(error, code_input, '&pair helix_angle_deg = '// &
          str(helix_angle)//': the task '//trim(slot%info%name)//' is for spur gears; for helical gears &case tasks can have '// &
          join(helical, ', ')//' only')
      end associate
    end do
  end subroutine refuse_tasks

  !> Reads the group of one gear, after the section, which may end at the bore.
  subroutine read_gear(reader, group, gear, case, error)
    type(reader_t), intent(inout) :: reader
    character(*), intent(in) :: group
    integer, intent(in) :: gear
    type(case_t), intent(inout) :: case
    type(error_t), allocatable, intent(inout) :: error
    character(sentence_length) :: geared, unused_without
    logical :: cut, rolls
    real(dp), parameter :: largest = 2

    cut = .not. case%prescribed
    geared = text_unless(cut, needs_gears)
    call reader%get(group, 'effective_mass_kg', case%mass(gear), error, unit='kg', tasks=case%tasks_for(stage%mesh), &
                    unused_without=text_unless(case%uses_masses(), 'spur gears, rating or sweep'), &
                    at_least=1e-12_dp, at_most=1e12_dp, default_note='that of a solid disc, or of rim and web', &
                    meaning='mass on the line of action: moment of inertia over the square of the base radius')
    call reader%get(group, 'inertia_kgm2', case%inertia(gear), error, unit='kg m^2', tasks=case%tasks_for(stage%mesh), &
                    unused_without=text_unless(case%uses_masses(), 'spur gears, rating or sweep'), &
                    at_least=1e-15_dp, at_most=1e15_dp, default_note='that of a solid disc, or of rim and web', &
                    meaning='polar moment of inertia, instead of the effective mass')
    call reader%get(group, 'hub_inertia_kgm2', case%hub_inertia(gear), error, unit='kg m^2', tasks=case%tasks_for(stage%mesh), &
                    unused_without=text_unless(case%uses_masses(), 'spur gears, rating or sweep'), &
                    at_least=0.0_dp, at_most=1e15_dp, not_allowed=geared, &
                    meaning='polar moment of inertia of what turns with the bore (shaft, coupling, motor), beside the gear''s '// &
                    'own; the body of a whole gear of finite elements turns between the two')
    rolls = cut .or. gear == 1 .or. case%inertia(gear) > 0
    associate (spec => case%spec(gear))
      spec%name = group
      unused_without = ''
      if (.not. rolls) unused_without = first_nonblank(for_stage(case, stage%motion), &
                                        text_unless(case%friction > 0 .or. case%requests('as_built'), 'friction or as_built'))
      call reader%get(group, 'teeth', spec%teeth, error, required=cut .or. gear == 1, unused_without=unused_without, &
                      not_allowed=text_unless(rolls .or. case%friction > 0 .or. reader%has_group('deviations') .or. &
                      case%requests('as_built'), &
                      'a prescribed mesh uses it with friction, inertia_kgm2, &deviations or the task as_built only; remove it'), &
                      at_least=5, at_most=100000, &
                      meaning='number of teeth')
      call reader%get(group, 'profile_shift', spec%profile_shift, error, not_allowed=geared, above=-5.0_dp, below=5.0_dp, &
                      meaning='profile shift coefficient x: the rack is moved outwards by x modules')
      call read_allowance(reader, group, spec, case%has_allowance, geared, error)
      call read_tip(reader, group, spec, case%tip_alteration, geared, error)
      call reader%get(group, 'dedendum', spec%dedendum, error, not_allowed=geared, above=0.0_dp, at_most=5.0_dp, &
                      meaning='dedendum of the rack in modules, h_fP*')
      call reader%get(group, 'rack_tip_radius', spec%rack_tip_radius(drive), error, not_allowed=geared, at_least=0.0_dp, &
                      at_most=largest, meaning='radius of the rack''s tips in modules, rho_fP*; it must leave a tip land')
      spec%rack_tip_radius(coast) = spec%rack_tip_radius(drive)
      call reader%get(group, 'coast_rack_tip_radius', spec%rack_tip_radius(coast), error, not_allowed=geared, at_least=0.0_dp, &
                      at_most=largest, default_note='as rack_tip_radius', &
                      meaning='radius of the rack''s tip that cuts the fillets of the coast flanks, for asymmetric teeth')
      call reader%get(group, 'protuberance_mm', spec%protuberance, error, unit='mm', not_allowed=geared, at_least=0.0_dp, &
                      meaning='by how much the rounded tips of the tool that cuts the fillets stand out of its flanks, pr; at '// &
                      'least grinding_stock_mm')
      call reader%get(group, 'grinding_stock_mm', spec%grinding_stock, error, unit='mm', not_allowed=geared, at_least=0.0_dp, &
                      meaning='stock that this tool leaves on each flank, normal to it, and that is ground off without '// &
                      'reaching the fillets, q')
      call reader%get(group, 'pin_diameter_mm', spec%pin_diameter, error, unit='mm', not_allowed=geared, above=0.0_dp, &
                      default_note='one that touches at or near the V circle', &
                      meaning='diameter of the pins, of helical gears the balls, over which the gear is measured; equal '// &
                      'pressure angles only')
      call read_web(reader, group, gear, case, geared, error)
      call reader%get(group, 'bore_mm', spec%bore_radius, error, unit='mm', factor=0.5_dp, not_allowed=geared, &
                      unused_without=without_bore(case, gear), at_least=0.0_dp, &
                      required=case%needs(stage%solid) .and. gear == case%gear, &
                      default_note='none; required by the task body_modes', &
                      meaning='bore diameter, below the root diameter; it ends the section where rim_mm is not given, and '// &
                      'the body of the task body_modes, and takes its part off the mass of a solid disc')
    end associate
  end subroutine read_gear

  !> Reads, after the gears, which of two unlike flanks carries the load. The loaded flanks are the drive flanks: with the load on
  !> the other ones, the two sides are exchanged.
  subroutine read_direction(reader, case, error)
    type(reader_t), intent(inout) :: reader
    type(case_t), intent(inout) :: case
    type(error_t), allocatable, intent(inout) :: error
    character(:), allocatable :: flanks
    logical :: are_alike
    integer :: i

    are_alike = abs(case%spec(1)%pressure_angle(drive) - case%spec(1)%pressure_angle(coast)) <= 0
    do i = 1, 2
      are_alike = are_alike .and. abs(case%spec(i)%rack_tip_radius(drive) - case%spec(i)%rack_tip_radius(coast)) <= 0
    end do
    flanks = 'drive'
    call reader%get('pair', 'loaded_flanks', flanks, error, allowed=[character(5) :: 'drive', 'coast'], default_note='drive', &
                    not_allowed=first_nonblank(text_unless(.not. case%prescribed, needs_gears), &
                                     text_unless(.not. are_alike, &
                                     'is for asymmetric teeth, and these flanks are alike; remove it')), &
                    meaning='the flanks that carry the load: drive, those of pressure_angle_deg, or coast, those of '// &
                    'coast_angle_deg, which are then the drive flanks of all results: the other direction of rotation, of '// &
                    'asymmetric teeth')
    if (flanks == 'drive') return
    do i = 1, 2
      associate (spec => case%spec(i))
        spec%pressure_angle = spec%pressure_angle([coast, drive])
        spec%rack_tip_radius = spec%rack_tip_radius([coast, drive])
      end associate
    end do
  end subroutine read_direction

  !> Reads the tip of the tooth: its diameter or addendum, and a chamfer, rounding or tip form diameter.
  subroutine read_tip(reader, group, spec, is_altered, geared, error)
    type(reader_t), intent(inout) :: reader
    character(*), intent(in) :: group, geared
    type(gear_spec_t), intent(inout) :: spec
    logical, intent(in) :: is_altered
    type(error_t), allocatable, intent(inout) :: error
    logical :: has_diameter, given(3)

    call reader%get(group, 'tip_diameter_mm', spec%tip_diameter, error, unit='mm', is_stated=has_diameter, above=0.0_dp, &
                    not_allowed=first_nonblank(geared, text_unless(.not. is_altered, &
                    'does not go with &pair tip_alteration; remove one')), &
                    default_note='from addendum, profile shift and tip alteration', &
                    meaning='tip diameter d_a, instead of the addendum')
    call reader%get(group, 'addendum', spec%addendum, error, above=0.0_dp, at_most=5.0_dp, &
                    not_allowed=first_nonblank(geared, text_unless(.not. has_diameter, &
                    'does not go with tip_diameter_mm; remove one')), meaning='addendum of the rack in modules, h_aP*')
    call reader%get(group, 'tip_chamfer_mm', spec%tip_chamfer, error, unit='mm', is_stated=given(1), not_allowed=geared, &
                    at_least=0.0_dp, default_note='none', &
                    meaning='height of the chamfer at the tip, h_K, as an edge of the tool at 45 degrees cuts it')
    call reader%get(group, 'tip_rounding_mm', spec%tip_rounding, error, unit='mm', is_stated=given(2), not_allowed=geared, &
                    at_least=0.0_dp, default_note='none', &
                    meaning='radius of the rounding between flank and tip circle, instead of a chamfer')
    call reader%get(group, 'tip_form_diameter_mm', spec%tip_form_diameter, error, unit='mm', is_stated=given(3), &
                    not_allowed=geared, above=0.0_dp, default_note='the tip diameter, or where a chamfer or rounding begins', &
                    meaning='tip form diameter d_Na, where the involute ends: a chamfer stated by where it begins')
    if (count(given) > 1) call fail(error, code_input, '&'//group//' '//trim(merge('tip_form_diameter_mm', &
      'tip_rounding_mm     ', given(3)))//': give one of tip_chamfer_mm, tip_rounding_mm and tip_form_diameter_mm')
  end subroutine read_tip

  !> Reads how much thinner the tooth is generated than with its profile shift: as a length, or as the generating shift.
  subroutine read_allowance(reader, group, spec, has_allowance, geared, error)
    type(reader_t), intent(inout) :: reader
    character(*), intent(in) :: group, geared
    type(gear_spec_t), intent(inout) :: spec
    logical, intent(inout) :: has_allowance
    type(error_t), allocatable, intent(inout) :: error
    real(dp) :: allowance, shift
    logical :: given(2)

    allowance = 0
    shift = 0
    call reader%get(group, 'thickness_allowance_um', allowance, error, unit='um', is_stated=given(1), not_allowed=geared, &
                    at_least=-1e9_dp, at_most=0.0_dp, default_note='none', &
                    meaning='tooth-thickness allowance A_s on the reference circle, negative: how much thinner the tooth is '// &
                    'than with profile_shift alone; backlash follows from it')
    call reader%get(group, 'generating_shift', shift, error, is_stated=given(2), not_allowed=geared, above=-5.0_dp, below=5.0_dp, &
                    default_note='profile_shift, less what thickness_allowance_um takes', &
                    meaning='generating profile shift coefficient x_E, at most profile_shift; instead of '// &
                    'thickness_allowance_um')
    has_allowance = has_allowance .or. any(given)
    if (all(given)) call fail(error, code_input, '&'//group// &
      ' generating_shift: give thickness_allowance_um or generating_shift, not both')
    if (allocated(error)) return
    if (given(1)) spec%thinning = allowance/(spec%module*sum(tan(spec%pressure_angle)))
    if (given(2)) spec%thinning = shift - spec%profile_shift
    if (spec%thinning > 0) call fail(error, code_input, '&'//group//' generating_shift = '//str(shift)// &
      ': must be at most profile_shift = '//str(spec%profile_shift))
  end subroutine read_allowance

  !> Reads the gear body below the teeth, for ISO 6336-1.
  subroutine read_web(reader, group, gear, case, geared, error)
    type(reader_t), intent(inout) :: reader
    character(*), intent(in) :: group, geared
    integer, intent(in) :: gear
    type(case_t), intent(inout) :: case
    type(error_t), allocatable, intent(inout) :: error
    character(sentence_length) :: web, rim
    logical :: given(2)

    web = for_iso(case, stage%webs)
    rim = for_iso(case, stage%rims)
    if (case%needs(stage%solid) .and. gear == case%gear) then
      web = ''
      rim = ''
    end if
    ! The web changes the mass; it also implies a rim, whose thickness the stiffness by elements uses too.
    if (case%computes_mass(gear) .or. (case%needs_elements() .and. .not. case%has_support .and. case%section%rim <= 0)) then
      web = ''
      rim = ''
    end if
    call reader%get(group, 'web_thickness_mm', case%iso%web_thickness(gear), error, unit='mm', is_stated=given(1), &
                    unused_without=web, not_allowed=geared, above=0.0_dp, default_note='a solid disc', &
                    meaning='thickness of the web b_s, for a mass that is not stated, C_R of a stiffness by iso6336 and '// &
                    'the task body_modes')
    call reader%get(group, 'rim_thickness_mm', case%iso%rim_thickness(gear), error, unit='mm', is_stated=given(2), &
                    unused_without=rim, not_allowed=geared, above=0.0_dp, default_note='a solid disc', &
                    meaning='thickness of the rim s_R below the root circle, for a mass that is not stated, the pair stiffness '// &
                    'by elements where &section says neither fixed nor rim_mm, C_R of a stiffness by iso6336 and Y_B of '// &
                    'the tasks rating and life, and for the task body_modes')
    if (given(1) .neqv. given(2)) call fail(error, code_input, '&'//group//' '//trim(merge('rim_thickness_mm', &
      'web_thickness_mm', given(1)))//': missing; a web has web_thickness_mm and rim_thickness_mm')
  end subroutine read_web

  !> What the bore lacks: it ends the section if no rim is stated, and reduces the mass of a solid body.
  pure function without_bore(case, gear) result(unused_without)
    type(case_t), intent(in) :: case
    integer, intent(in) :: gear
    character(sentence_length) :: unused_without
    logical :: ends

    ends = case%section%rim <= 0 .and. (case%needs_elements() .or. (case%needs(stage%section) .and. gear == case%gear))
    ends = ends .or. (case%needs(stage%solid) .and. gear == case%gear)
    unused_without = text_unless(case%computes_mass(gear) .or. ends, 'a section that ends at it or a mass that is not stated')
  end function without_bore
end module gearsweep_study_case_gear_keys
