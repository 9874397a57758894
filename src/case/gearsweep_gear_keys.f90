!> What a case says of the gears: &pair, &pinion and &gear.
module gearsweep_gear_keys
  use gearsweep_kinds, only: dp, pi
  use gearsweep_case, only: case_t, for_iso, for_stage
  use gearsweep_error, only: code_input, error_t, fail
  use gearsweep_gear, only: coast, drive, gear_spec_t
  use gearsweep_reader, only: reader_t
  use gearsweep_task, only: stage
  use gearsweep_text, only: str
  use gearsweep_uses, only: first_of, needs_gears, sentence_length, unless
  implicit none
  private
  public :: read_pair, read_member, read_direction

contains

  !> After load and friction, which decide what a prescribed mesh needs of it.
  subroutine read_pair(reader, case, error)
    type(reader_t), intent(inout) :: reader
    type(case_t), intent(inout) :: case
    type(error_t), allocatable, intent(inout) :: error
    real(dp), parameter :: degree = pi/180
    real(dp) :: module, width, drive_angle, coast_angle
    character(sentence_length) :: geared, slides
    logical :: cut

    cut = .not. case%prescribed
    geared = unless(cut, needs_gears)
    slides = ''
    if (case%prescribed) slides = for_stage(case, stage%motion)
    module = 0
    width = 0
    drive_angle = 20*degree
    call reader%get('pair', 'module_mm', module, error, unit='mm', required=.true., refused=geared, &
                    at_least=0.05_dp, at_most=1000.0_dp, meaning='normal module')
    call reader%get('pair', 'face_width_mm', width, error, unit='mm', required=cut, refused=unless(cut .or. case%line_load > 0, &
                    'a prescribed mesh uses it with line_load_n_mm only; remove it'), at_least=0.005_dp, at_most=1e5_dp, &
                    meaning='common face width of the two gears, at least a tenth of the module')
    call reader%get('pair', 'pressure_angle_deg', drive_angle, error, unit='deg', lacks=slides, &
                    refused=unless(cut .or. case%friction > 0, 'a prescribed mesh uses it with friction only; remove it'), &
                    above=3.0_dp, below=45.0_dp, meaning='pressure angle of the rack on the drive flanks; of a prescribed '// &
                    'mesh with friction, the working pressure angle')
    coast_angle = drive_angle
    call reader%get('pair', 'coast_angle_deg', coast_angle, error, unit='deg', refused=geared, above=3.0_dp, below=45.0_dp, &
                    otherwise='as pressure_angle_deg', &
                    meaning='pressure angle of the rack on the coast flanks, for asymmetric teeth')
    call reader%get('pair', 'centre_distance_mm', case%centre_distance, error, unit='mm', refused=geared, above=0.0_dp, &
                    otherwise='without backlash', &
                    meaning='working centre distance, at least the one without backlash')
    call reader%get('pair', 'tip_alteration', case%tip_alteration, error, refused=geared, &
                    meaning='shortens the tips so that the rack''s bottom clearance is kept at this centre distance '// &
                    '(ISO 21771); never lengthens them')
    call reader%get('pair', 'shorten_path', case%shorten_path, error, refused=geared, &
                    meaning='where undercut takes flank that the partner''s tip would work on, ends the path of contact '// &
                    'where the involute ends; without it such gears are refused')
    call reader%get('pair', 'backlash_um', case%backlash, error, unit='um', given=case%has_backlash, &
                    tasks=unless(cut, trim(case%tasks_for(stage%losses))), at_least=0.0_dp, at_most=1e9_dp, &
                    otherwise='where a gear has a thickness allowance, what follows from it; else the coast flanks never '// &
                    'touch', &
                    meaning='backlash along the line of action: the coast flanks touch once the drive flanks are this far '// &
                    'apart')
    case%spec%pressure_angle(1) = drive_angle
    if (cut) case%spec%pressure_angle(2) = coast_angle
    case%spec%module = module
    case%spec%face_width = width
  end subroutine read_pair

  !> After the section, which may end at the bore.
  subroutine read_member(reader, group, member, case, error)
    type(reader_t), intent(inout) :: reader
    character(*), intent(in) :: group
    integer, intent(in) :: member
    type(case_t), intent(inout) :: case
    type(error_t), allocatable, intent(inout) :: error
    character(sentence_length) :: geared, lacks
    logical :: cut, rolls

    cut = .not. case%prescribed
    geared = unless(cut, needs_gears)
    call reader%get(group, 'effective_mass_kg', case%mass(member), error, unit='kg', tasks=case%tasks_for(stage%mesh), &
                    at_least=1e-12_dp, at_most=1e12_dp, otherwise='that of a solid disc, or of rim and web', &
                    meaning='mass on the line of action: moment of inertia over the square of the base radius')
    call reader%get(group, 'inertia_kgm2', case%inertia(member), error, unit='kg m^2', tasks=case%tasks_for(stage%mesh), &
                    at_least=1e-15_dp, at_most=1e15_dp, otherwise='that of a solid disc, or of rim and web', &
                    meaning='polar moment of inertia, instead of the effective mass')
    call reader%get(group, 'hub_inertia_kgm2', case%hub_inertia(member), error, unit='kg m^2', tasks=case%tasks_for(stage%mesh), &
                    at_least=0.0_dp, at_most=1e15_dp, refused=geared, &
                    meaning='polar moment of inertia of what turns with the bore (shaft, coupling, motor), beside the gear''s '// &
                    'own; the body of a whole gear of finite elements turns between the two')
    rolls = cut .or. member == 1 .or. case%inertia(member) > 0
    associate (spec => case%spec(member))
      spec%name = group
      lacks = ''
      if (.not. rolls) lacks = first_of(for_stage(case, stage%motion), &
                                        unless(case%friction > 0 .or. case%asks('as_built'), 'friction or as_built'))
      call reader%get(group, 'teeth', spec%teeth, error, required=cut .or. member == 1, lacks=lacks, &
                      refused=unless(rolls .or. case%friction > 0 .or. reader%has_group('deviations') .or. case%asks('as_built'), &
                      'a prescribed mesh uses it with friction, inertia_kgm2, &deviations or the task as_built only; remove it'), &
                      at_least=5, at_most=100000, &
                      meaning='number of teeth')
      call reader%get(group, 'profile_shift', spec%profile_shift, error, refused=geared, above=-5.0_dp, below=5.0_dp, &
                      meaning='profile shift coefficient x: the rack is moved outwards by x modules')
      call read_allowance(reader, group, spec, case%has_allowance, geared, error)
      call read_tip(reader, group, spec, case%tip_alteration, geared, error)
      call reader%get(group, 'dedendum', spec%dedendum, error, refused=geared, above=0.0_dp, at_most=5.0_dp, &
                      meaning='dedendum of the rack in modules, h_fP*')
      call read_rack_tips(reader, group, spec%rack_tip_radius, geared, error)
      call reader%get(group, 'protuberance_mm', spec%protuberance, error, unit='mm', refused=geared, at_least=0.0_dp, &
                      meaning='by how much the rounded tips of the tool that cuts the fillets stand out of its flanks, pr; at '// &
                      'least grinding_stock_mm')
      call reader%get(group, 'grinding_stock_mm', spec%grinding_stock, error, unit='mm', refused=geared, at_least=0.0_dp, &
                      meaning='stock that this tool leaves on each flank, normal to it, and that is ground off without '// &
                      'reaching the fillets, q')
      call reader%get(group, 'pin_diameter_mm', spec%pin_diameter, error, unit='mm', refused=geared, above=0.0_dp, &
                      otherwise='one that touches at the V circle', &
                      meaning='diameter of the pins over which the gear is measured; equal pressure angles only')
      call read_web(reader, group, member, case, geared, error)
      call reader%get(group, 'bore_mm', spec%bore_radius, error, unit='mm', factor=0.5_dp, refused=geared, &
                      lacks=without_bore(case, member), at_least=0.0_dp, &
                      required=case%needs(stage%solid) .and. member == case%member, &
                      otherwise='none; required by the task body_modes', &
                      meaning='bore diameter, below the root diameter; it ends the section where rim_mm is not given, and '// &
                      'the body of the task body_modes, and takes its part off the mass of a solid disc')
    end associate
  end subroutine read_member

  !> The rounded corners of the rack, which cut the fillets.
  subroutine read_rack_tips(reader, group, radius, geared, error)
    type(reader_t), intent(inout) :: reader
    character(*), intent(in) :: group, geared
    real(dp), intent(inout) :: radius(2)         ! of the drive and the coast side
    type(error_t), allocatable, intent(inout) :: error
    real(dp), parameter :: largest = 2

    call reader%get(group, 'rack_tip_radius', radius(drive), error, refused=geared, at_least=0.0_dp, at_most=largest, &
                    meaning='radius of the rack''s tips in modules, rho_fP*; it must leave a tip land')
    radius(coast) = radius(drive)
    call reader%get(group, 'coast_rack_tip_radius', radius(coast), error, refused=geared, at_least=0.0_dp, at_most=largest, &
                    otherwise='as rack_tip_radius', &
                    meaning='radius of the rack''s tip that cuts the fillets of the coast flanks, for asymmetric teeth')
  end subroutine read_rack_tips

  !> After the gears: which of two unlike flanks carries the load. Drive flanks are those that carry it, so that with the load
  !> on the others the two sides change places.
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
    call reader%get('pair', 'loaded_flanks', flanks, error, allowed=[character(5) :: 'drive', 'coast'], otherwise='drive', &
                    refused=first_of(unless(.not. case%prescribed, needs_gears), &
                                     unless(.not. are_alike, 'is for asymmetric teeth, and these flanks are alike; remove it')), &
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

  !> Where the tooth ends, and how.
  subroutine read_tip(reader, group, spec, is_altered, geared, error)
    type(reader_t), intent(inout) :: reader
    character(*), intent(in) :: group, geared
    type(gear_spec_t), intent(inout) :: spec
    logical, intent(in) :: is_altered
    type(error_t), allocatable, intent(inout) :: error
    logical :: has_diameter, given(3)

    call reader%get(group, 'tip_diameter_mm', spec%tip_diameter, error, unit='mm', given=has_diameter, above=0.0_dp, &
                    refused=first_of(geared, unless(.not. is_altered, 'does not go with &pair tip_alteration; remove one')), &
                    otherwise='from addendum, profile shift and tip alteration', &
                    meaning='tip diameter d_a, instead of the addendum')
    call reader%get(group, 'addendum', spec%addendum, error, above=0.0_dp, at_most=5.0_dp, &
                    refused=first_of(geared, unless(.not. has_diameter, 'does not go with tip_diameter_mm; remove one')), &
                    meaning='addendum of the rack in modules, h_aP*')
    call reader%get(group, 'tip_chamfer_mm', spec%tip_chamfer, error, unit='mm', given=given(1), refused=geared, &
                    at_least=0.0_dp, otherwise='none', &
                    meaning='height of the chamfer at the tip, h_K, as an edge of the tool at 45 degrees cuts it')
    call reader%get(group, 'tip_rounding_mm', spec%tip_rounding, error, unit='mm', given=given(2), refused=geared, &
                    at_least=0.0_dp, otherwise='none', &
                    meaning='radius of the rounding between flank and tip circle, instead of a chamfer')
    call reader%get(group, 'tip_form_diameter_mm', spec%tip_form_diameter, error, unit='mm', given=given(3), refused=geared, &
                    above=0.0_dp, otherwise='the tip diameter, or where a chamfer or rounding begins', &
                    meaning='tip form diameter d_Na, where the involute ends: a chamfer stated by where it begins')
    if (count(given) > 1) call fail(error, code_input, '&'//group//' '//trim(merge('tip_form_diameter_mm', &
      'tip_rounding_mm     ', given(3)))//': give one of tip_chamfer_mm, tip_rounding_mm and tip_form_diameter_mm')
  end subroutine read_tip

  !> How much thinner than its profile shift says the tooth is generated: stated as such, or by the shift that generates it.
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
    call reader%get(group, 'thickness_allowance_um', allowance, error, unit='um', given=given(1), refused=geared, &
                    at_least=-1e9_dp, at_most=0.0_dp, otherwise='none', &
                    meaning='tooth-thickness allowance A_s on the reference circle, negative: by so much the tooth is thinner '// &
                    'than profile_shift says; backlash follows from it')
    call reader%get(group, 'generating_shift', shift, error, given=given(2), refused=geared, above=-5.0_dp, below=5.0_dp, &
                    otherwise='profile_shift, less what thickness_allowance_um takes', &
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

  !> What lies below the teeth, for ISO 6336-1.
  subroutine read_web(reader, group, member, case, geared, error)
    type(reader_t), intent(inout) :: reader
    character(*), intent(in) :: group, geared
    integer, intent(in) :: member
    type(case_t), intent(inout) :: case
    type(error_t), allocatable, intent(inout) :: error
    character(sentence_length) :: web, rim
    logical :: given(2)

    web = for_iso(case, stage%webs)
    rim = for_iso(case, stage%rims)
    if (case%needs(stage%solid) .and. member == case%member) then
      web = ''
      rim = ''
    end if
    ! The web counts in the mass; it also says that there is a rim, whose thickness the stiffness by elements takes too.
    if (case%weighs(member) .or. (case%needs_elements() .and. .not. case%has_support .and. case%section%rim <= 0)) then
      web = ''
      rim = ''
    end if
    call reader%get(group, 'web_thickness_mm', case%iso%web_thickness(member), error, unit='mm', given=given(1), &
                    lacks=web, refused=geared, above=0.0_dp, otherwise='a solid disc', &
                    meaning='thickness of the web b_s, for a mass that is not stated, C_R of a stiffness by iso6336 and '// &
                    'the task body_modes')
    call reader%get(group, 'rim_thickness_mm', case%iso%rim_thickness(member), error, unit='mm', given=given(2), &
                    lacks=rim, refused=geared, above=0.0_dp, otherwise='a solid disc', &
                    meaning='thickness of the rim s_R below the root circle, for a mass that is not stated, the pair stiffness '// &
                    'by elements where &section says neither fixed nor rim_mm, C_R of a stiffness by iso6336 and Y_B of '// &
                    'the tasks rating and life, and for the task body_modes')
    if (given(1) .neqv. given(2)) call fail(error, code_input, '&'//group//' '//trim(merge('rim_thickness_mm', &
      'web_thickness_mm', given(1)))//': missing; a web has web_thickness_mm and rim_thickness_mm')
  end subroutine read_web

  !> The bore ends the section where no rim is stated, and takes its part off the mass of a solid body.
  pure function without_bore(case, member) result(lacks)
    type(case_t), intent(in) :: case
    integer, intent(in) :: member
    character(sentence_length) :: lacks
    logical :: ends

    ends = case%section%rim <= 0 .and. (case%needs_elements() .or. (case%needs(stage%section) .and. member == case%member))
    ends = ends .or. (case%needs(stage%solid) .and. member == case%member)
    lacks = unless(case%weighs(member) .or. ends, 'a section that ends at it or a mass that is not stated')
  end function without_bore
end module gearsweep_gear_keys
