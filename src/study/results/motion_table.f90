!> Table and screen of the motion's inputs, load, masses and stiffness, with warnings of likely unit slips.
!>
!> The warnings concern loads, masses and tables; gearsweep_study_reader_unit_slips has those of single numbers.
module gearsweep_study_results_motion_table
  use gearsweep_base, only: dp, error_t, left, lines_t, no_number, pi, piecewise_t, str, table_t
  use gearsweep_gear, only: drive, gear_t, has_web, solid_inertia
  use gearsweep_elastic, only: assumed_bore_radius, chain_frequencies, felt_twist, material_t, section_options_t
  use gearsweep_mesh, only: gear_blank_factor, iso_options_t, iso_stiffness, weber_stiffness
  use gearsweep_study_case_task, only: stage
  use gearsweep_study_run_mesh_stage, only: name_load, pressure_at_pitch, rim_teeth, rims
  use gearsweep_study_run_study, only: study_t
  implicit none
  private
  public :: motion_table, add_motion

  real(dp), parameter :: micro = 1e6_dp, milli = 1e3_dp
  character(*), parameter :: of_web = 'rim and web', is_assumed = ' (assumed)'

contains

  !> Warns of a load that no flank bears, usually from a torque in another unit than its key's. Rolling bearing steel, harder than
  !> that of gears, is dented permanently from 4000 MPa on in line contacts (ISO 76:2006, static load rating of roller bearings).
  pure subroutine check_pressure(study, lines)
    type(study_t), intent(in) :: study
    type(lines_t), intent(inout) :: lines
    real(dp), parameter :: most = 4e9_dp, least = 4e7_dp, stiff = 1e11_dp
    character(:), allocatable :: key
    real(dp) :: pressure, given

    pressure = pressure_at_pitch(study%case, study%pair, study%load)
    call name_load(study%case, key, given)
    ! Metal flanks at so low a pressure are nearly unloaded: they are designed for a thousand times as much.
    if (pressure < least .and. all(study%case%material%young > stiff)) then
      call lines%add(left('', 19)//'caution: &load '//key//' = '//str(given)//' makes a pressure of '//str(pressure/micro, 3)// &
                     ' MPa at the pitch point, next to none')
      if (index(key, 'torque') == 1) call lines%add(left('', 19)//'if kN m is meant, write '//str(1000*given))
    end if
    if (pressure <= most) return
    call lines%add(left('', 19)//'caution: &load '//key//' = '//str(given)//' makes a pressure of '//str(pressure/micro, 4)// &
                   ' MPa at the pitch point; hardened steel bears '//str(most/micro))
    if (index(key, 'torque') == 1) call lines%add(left('', 19)//'if N mm is meant, write '//str(given/1000))
  end subroutine check_pressure

  !> Warns of masses far from those of solid discs, usually from a number in another unit than its key's.
  pure subroutine check_masses(study, lines)
    type(study_t), intent(in) :: study
    type(lines_t), intent(inout) :: lines
    real(dp), parameter :: most = 300, most_hub = 3e4_dp  ! a rotor on the shaft may be a motor
    real(dp) :: disc
    integer :: i

    do i = 1, 2
      disc = solid_inertia(study%pair%gear(i), study%case%material(i)%density)
      associate (case => study%case, gear => '&'//trim(study%case%spec(i)%name)//' ')
        call check_mass(gear//'effective_mass_kg', case%mass(i), disc/study%pair%gear(i)%base_radius(drive)**2, most, '1000 g', &
                       lines)
        call check_mass(gear//'inertia_kgm2', case%inertia(i), disc, most, '1e6 kg mm^2', lines)
        ! Any small inertia at the bore is usual.
        call check_mass(gear//'hub_inertia_kgm2', max(case%hub_inertia(i), 0.01_dp*disc), disc, most_hub, '1e6 kg mm^2', lines)
      end associate
    end do
  end subroutine check_masses

  pure subroutine check_mass(key, given, disc, most, unit, lines)
    character(*), intent(in) :: key
    real(dp), intent(in) :: given, disc          !< value of the key, 0 if not stated; that of a disc
    real(dp), intent(in) :: most                 !< largest usual ratio to a disc
    character(*), intent(in) :: unit             !< value of one of the key's units in a smaller unit
    type(lines_t), intent(inout) :: lines
    real(dp), parameter :: least = 0.01_dp

    if (given <= 0 .or. (given >= least*disc .and. given <= most*disc)) return
    call lines%add(left('', 19)//'caution: '//key//' = '//str(given)//' is '//str(given/disc, 2)// &
                   ' times that of a solid disc of this gear; 1 of its unit is '//unit)
  end subroutine check_mass

  !> Warns of tables of stiffness and profile error whose numbers are likely in another unit.
  pure subroutine check_tables(study, table, lines)
    type(study_t), intent(in) :: study
    type(table_t), intent(in) :: table
    type(lines_t), intent(inout) :: lines
    real(dp), parameter :: most = 1e5_dp, least = 0.1_dp  ! N/um, um
    real(dp) :: largest

    if (study%case%model == 'table' .and. table%number('largest_pair_stiffness_n_um') > most) call lines%add(left('', 19)// &
      'caution: &mesh file has more than '//str(most)//' N/um; if N/mm is meant, divide by 1000')
    if (.not. allocated(study%case%profile_error_file)) return
    largest = micro*max(abs(study%mesh%profile_error%maximum()), abs(study%mesh%profile_error%minimum()))
    if (largest > 0 .and. largest < least) call lines%add(left('', 19)//'caution: &mesh profile_error_file has at most '// &
      str(largest)//' um; if mm is meant, multiply by 1000')
  end subroutine check_tables

  !> Adds columns of the other inputs of ISO 6336-1, and of the stiffness by another model for comparison.
  pure subroutine add_iso_columns(study, table)
    type(study_t), intent(in) :: study
    type(table_t), intent(inout) :: table
    type(piecewise_t) :: curve
    type(material_t) :: steel(2)
    type(error_t), allocatable :: error
    real(dp) :: weber

    associate (spec => study%pair%gear%spec, iso => study%case%iso)
      call table%add('iso_line_load_n_mm', 'N/mm', 'F_t K_A/b, below 100 N/mm of which ISO 6336-1 lowers the stiffness', &
                     [iso%application_factor*study%load/spec(1)%face_width*cos(spec(1)%pressure_angle(drive))])
      call table%add('iso_blank_factor', '', 'C_R, the smaller one of both gears', &
                     [minval(gear_blank_factor(iso%web_thickness, iso%rim_thickness, spec%face_width, spec%module))])
      ! The standard does not use Poisson's ratio; that of steel is assumed.
      steel%young = study%case%material%young
      call weber_stiffness(study%pair, steel, study%load/spec(1)%face_width, curve, error)
    end associate
    weber = no_number()
    if (.not. allocated(error)) weber = curve%integral(0.0_dp, study%pair%contact_ratio)
    call table%add('weber_mesh_stiffness_n_um', 'N/um', 'mean mesh stiffness by the model weber, to compare', [weber])
  end subroutine add_iso_columns

  !> Fills the table of the motion's inputs.
  pure subroutine motion_table(study, table, error)
    type(study_t), intent(in) :: study
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp) :: frequency, mean, width, felt, iso

    if (.not. allocated(study%motion)) return
    call table%begin('load, masses and stiffness of the mesh, and its natural frequency', 1, error)
    if (allocated(error)) return
    associate (mesh => study%motion(1)%mesh, case => study%case)
      frequency = study%motion(1)%natural_frequency/(2*pi)
      mean = mesh%mean_stiffness()
      if (allocated(study%uneven_motion)) then
        frequency = study%uneven_motion(1)%natural_frequency/(2*pi)
        mean = study%uneven_motion(1)%natural_frequency**2/sum(1/study%mass)
      end if
      width = case%spec(1)%face_width
      call table%add('load_n', 'N', 'static load on the line of action', [study%load])
      call table%add('pinion_mass_kg', 'kg', 'effective mass of the pinion on the line of action, with what sits at its '// &
                     'bore', study%mass(1:1))
      call table%add('gear_mass_kg', 'kg', 'effective mass of the gear on the line of action, with what sits at its bore', &
                     study%mass(2:2))
      call table%add('least_pair_stiffness_n_um', 'N/um', 'least stiffness of a pair on its path, whole face width', &
                     [mesh%stiffness%minimum()])
      call table%add('largest_pair_stiffness_n_um', 'N/um', 'largest stiffness of a pair on its path, whole face width', &
                     [mesh%stiffness%maximum()])
      call table%add('mean_mesh_stiffness_n_um', 'N/um', 'mean over a mesh period of all pairs in contact', [mean])
      if (width > 0) call table%add('mean_mesh_stiffness_n_um_mm', 'N/(mm um)', 'the same per mm of face width', &
                                    [mean/width])
      if (case%model == 'iso6336') call add_iso_columns(study, table)
      call table%add('natural_frequency_hz', 'Hz', 'of the mean mesh stiffness and the effective masses', [frequency])
      call table%add('resonance_rpm', '1/min', 'speed of the pinion at which the mesh excites it', &
                     [60*frequency/mesh%teeth(1)])
      iso = iso_resonance(study)
      if (iso > 0) call table%add('iso_resonance_rpm', '1/min', 'resonance running speed n_E1 of ISO 6336-1, method B, with '// &
                                  'the same masses', [iso])
      felt = sum(felt_twist(study%hub_mass/study%mass, mesh%disc%twist))
      call table%add('body_rotation_um', 'um', 'rotation of whole gears about their bores under the load, on the line of '// &
                     'action: not in the motion, except for felt_rotation_um', [study%load*(mesh%disc%turn + felt)])
      if (.not. case%is_helical()) call table%add('body_coupling_um', 'um', 'what neighbouring teeth share beyond that: in the '// &
                                                  'stiffness of each pair', [study%load*(mesh%disc%shared - felt)])
      if (felt > 0) call add_hubs(study, felt, mean, table)
      if (case%model == 'fe') call add_body(study, table)
      if (case%needs(stage%losses)) call table%add('backlash_um', 'um', 'of the motion; NaN where the coast flanks never touch', &
                                                   [merge(study%motions_inputs%motion%backlash, no_number(), &
                                                          study%motions_inputs%motion%has_backlash)])
      if (case%needs(stage%losses)) call table%add('damping_ratio', '', 'as in the case', [case%damping_ratio])
      if (case%needs(stage%motion)) call table%add('friction', '', 'friction coefficient, as in the case', [case%friction])
    end associate
  end subroutine motion_table

  !> Resonance running speed n_E1 (1/min) of the pinion; 0 if the stiffness is stated or that of the standard is not valid.
  !> Source: ISO 6336-1:2006, 6.5.3, with c_gamma_alpha of clause 9, method B.
  pure real(dp) function iso_resonance(study) result(rpm)
    type(study_t), intent(in) :: study
    type(iso_options_t) :: options
    type(piecewise_t) :: curve
    type(error_t), allocatable :: error

    rpm = 0
    if (.not. study%case%models_teeth() .or. study%case%model == 'iso6336') return
    ! The motion has the load of the case, without the increase by K_A.
    options = study%case%iso
    options%application_factor = 1
    call iso_stiffness(study%pair, study%case%material, study%load/study%case%spec(1)%face_width, curve, error, options)
    if (allocated(error)) return
    rpm = 30/pi*sqrt(curve%integral(0.0_dp, study%pair%contact_ratio)*sum(1/study%mass))/study%pair%gear(1)%spec%teeth
  end function iso_resonance

  !> Adds columns on the gear body for the pair stiffness.
  pure subroutine add_body(study, table)
    type(study_t), intent(in) :: study
    type(table_t), intent(inout) :: table
    type(section_options_t) :: body
    real(dp) :: bore(2)
    integer :: teeth(2), i

    body = study%case%stiffness_body()
    bore = no_number()
    do i = 1, 2
      teeth(i) = body%teeth
      if (any(rims(study%case, study%pair) > 0)) then
        associate (rim => rims(study%case, study%pair))
          if (rim(i) > 0) teeth(i) = rim_teeth(study%case)
        end associate
      end if
      if (teeth(i) == 0) bore(i) = held_bore(study%pair%gear(i), body)
    end do
    call table%add('pinion_body_teeth', '', 'teeth of the body behind the pair stiffness of the pinion; 0: the whole gear', &
                   teeth(1:1))
    call table%add('gear_body_teeth', '', 'the same of the gear', teeth(2:2))
    call table%add('pinion_held_bore_mm', 'mm', 'diameter at which a whole pinion is held; NaN of other bodies', bore(1:1))
    call table%add('gear_held_bore_mm', 'mm', 'the same of the gear', bore(2:2))
  end subroutine add_body

  !> Adds columns on the effect of hub inertia on the gear-body rotation, and the frequencies of the chain of all four inertias.
  !> `felt`: compliance of the rotation (m/N) in the `mean` stiffness (N/m) of the mesh.
  pure subroutine add_hubs(study, felt, mean, table)
    type(study_t), intent(in) :: study
    real(dp), intent(in) :: felt, mean
    type(table_t), intent(inout) :: table
    real(dp) :: frequencies(2)

    frequencies = chain_frequencies(study%mass - study%hub_mass, study%hub_mass, 1/mean - felt, study%mesh%disc%twist)/(2*pi)
    call table%add('felt_rotation_um', 'um', 'part of the bodies'' rotation that inertia at the hubs brings into the '// &
                   'motion: in the stiffness of each pair', [study%load*felt])
    call table%add('chain_frequency_hz', 'Hz', 'lowest natural frequency of the chain hub, body, mean mesh stiffness, body, hub', &
                   frequencies(1:1))
    call table%add('next_chain_frequency_hz', 'Hz', 'its next one, at which a body turns against its hub: not in the motion', &
                   frequencies(2:2))
  end subroutine add_hubs

  pure subroutine add_motion(study, lines)
    type(study_t), intent(in) :: study
    type(lines_t), intent(inout) :: lines
    type(table_t) :: table
    type(error_t), allocatable :: error

    table%name = 'motion'
    call motion_table(study, table, error)
    if (.not. table%is_there()) return
    call lines%put(left('Stiffness', 19)//study%case%model//': pair '//str(table%number('least_pair_stiffness_n_um'), 4)// &
                   ' to '//str(table%number('largest_pair_stiffness_n_um'), 4)//', mesh mean '// &
                   str(table%number('mean_mesh_stiffness_n_um'), 4)//' N/um')
    if (table%position('mean_mesh_stiffness_n_um_mm') > 0) &
      call lines%put(' ('//str(table%number('mean_mesh_stiffness_n_um_mm'), 4)//' N/um per mm of width)')
    call lines%add('')
    if (table%position('iso_blank_factor') > 0) call add_iso(study, table, lines)
    if (table%number('body_rotation_um') > 0) then
      call lines%add(left('Discs', 19)//'turn by '//str(table%number('body_rotation_um'), 4)//' um on the line of action '// &
                     'about their bores: in the static transmission error,')
      call lines%put(left('', 19)//'not in the pairs'' stiffness nor in the motion')
      if (table%position('body_coupling_um') > 0) call lines%put('; neighbouring teeth share '// &
        str(table%number('body_coupling_um'), 4)//' um')
      call lines%add('')
    end if
    if (table%position('felt_rotation_um') > 0) call add_hub_lines(table, lines)
    call lines%put(left('Load', 19)//str(table%number('load_n'), 5)//' N on the line of action, effective masses '// &
                   str(table%number('pinion_mass_kg'), 4)//' and '//str(table%number('gear_mass_kg'), 4)//' kg ('// &
                   trim(origin(study, 1)))
    if (origin(study, 1) /= origin(study, 2)) call lines%put('; '//trim(origin(study, 2)))
    call lines%put(')')
    if (table%position('friction') > 0) call lines%put(', friction '//str(table%number('friction')))
    call lines%add('')
    if (allocated(study%torque)) call lines%add(left('', 19)//'at '//str(study%case%torque)//' N m, the largest of torques_nm')
    if (allocated(study%pair)) then
      call check_pressure(study, lines)
      call check_masses(study, lines)
    end if
    call check_tables(study, table, lines)
    call add_webs(study, lines)
    call add_decisive_inputs(study, lines)
    if (study%case%faces%are_uneven() .and. study%case%needs(stage%face) .and. study%case%needs(stage%losses)) then
      if (allocated(study%uneven_motion)) then
        call lines%add(left('Faces', 19)//'uneven in the sweep, the mean mesh stiffness and the natural frequency; parallel in '// &
                       'all other motions')
        if (study%case%has_corner_contact()) call lines%add(left('', 19)//'the sweep has no contact of tip corners: compare it '// &
                                                            'with corner_contact = .false. of parallel faces')
      else
        call lines%add(left('Faces', 19)//'parallel in the motion')
      end if
    end if
    call lines%put(left('Natural frequency', 19)//str(table%number('natural_frequency_hz'), 5)//' Hz: the mesh excites it at '// &
                   str(table%number('resonance_rpm'), 5)//' rpm of the pinion')
    if (table%position('iso_resonance_rpm') > 0) &
      call lines%put('; ISO 6336-1: n_E1 '//str(table%number('iso_resonance_rpm'), 5)//' rpm')
    call lines%add('')
  end subroutine add_motion

  !> Adds the inputs with most effect on the motion that drawings rarely state: damping, gear body and backlash. Values that the
  !> case does not state are marked as assumed.
  pure subroutine add_decisive_inputs(study, lines)
    type(study_t), intent(in) :: study
    type(lines_t), intent(inout) :: lines
    character(:), allocatable :: body
    character(*), parameter :: label = 'Decisive inputs'

    associate (case => study%case)
      call describe_body(study, body)
      if (.not. case%needs(stage%losses)) then
        if (len(body) > 0) call lines%add(left(label, 19)//body)
        return
      end if
      call lines%put(left(label, 19)//'damping ratio '//str(case%damping_ratio)//when(.not. case%has_damping, is_assumed))
      if (len(body) > 0) call lines%add('; '//body)
      call lines%put(when(len(body) == 0, '; ')//when(len(body) > 0, left('', 19)))
      associate (motion => study%motions_inputs%motion)
        if (motion%has_backlash) then
          call lines%add('backlash '//str(micro*motion%backlash, 4)//' um'// &
                         when(.not. case%has_backlash, ', as the thickness allowances leave'))
        else
          call lines%add('the coast flanks never touch (assumed: no backlash_um and no thickness allowance)')
        end if
      end associate
    end associate
  end subroutine add_decisive_inputs

  !> Returns the words if the condition holds, otherwise none.
  pure function when(condition, words) result(shown)
    logical, intent(in) :: condition
    character(*), intent(in) :: words
    character(merge(len(words), 0, condition)) :: shown

    shown = words
  end function when

  !> Describes the gear body of a stiffness by elements in words; empty for other models.
  pure subroutine describe_body(study, words)
    type(study_t), intent(in) :: study
    character(:), allocatable, intent(out) :: words
    type(section_options_t) :: body
    logical :: is_stated

    words = ''
    if (study%case%model /= 'fe' .or. .not. allocated(study%pair)) return
    body = study%case%stiffness_body()
    is_stated = study%case%has_extent .or. study%case%has_support
    associate (gears => study%pair%gear, rim => rims(study%case, study%pair))
      if (all(rim > 0)) then
        words = 'rims on webs, held at the sides of '//str(rim_teeth(study%case))//' teeth'
      else if (body%teeth == 0) then
        words = 'whole gears held at bores of '//str(milli*held_bore(gears(1), body), 4)//' and '// &
                str(milli*held_bore(gears(2), body), 4)//' mm'
        is_stated = is_stated .and. (body%rim > 0 .or. all(gears%spec%bore_radius > 0))
        if (any(rim > 0)) words = words//', that with a web at the sides of its rim'
      else
        words = 'bodies of '//str(body%teeth)//' teeth, held at '//when(body%fixed_sides, 'the sides')// &
                when(body%fixed_sides .and. body%fixed_rim, ' and ')//when(body%fixed_rim, 'the inner edge')
      end if
    end associate
    words = words//when(.not. is_stated, is_assumed)
  end subroutine describe_body

  !> Diameter (m) at which a complete gear is fixed.
  pure real(dp) function held_bore(gear, body) result(diameter)
    type(gear_t), intent(in) :: gear
    type(section_options_t), intent(in) :: body

    diameter = 2*gear%spec%bore_radius
    if (.not. diameter > 0) diameter = 2*assumed_bore_radius(gear)
    if (body%rim > 0) diameter = 2*(gear%root_radius - body%rim)
  end function held_bore

  !> Source of a gear's effective mass, in words.
  pure function origin(study, gear) result(words)
    type(study_t), intent(in) :: study
    integer, intent(in) :: gear
    character(11) :: words

    words = 'stated'
    if (study%case%mass(gear) > 0 .or. study%case%inertia(gear) > 0) return
    words = 'solid disc'
    if (is_webbed(study, gear)) words = of_web
  end function origin

  !> True if the case describes a web of this gear.
  pure logical function is_webbed(study, gear)
    type(study_t), intent(in) :: study
    integer, intent(in) :: gear

    is_webbed = allocated(study%pair)
    if (is_webbed) is_webbed = has_web(study%pair%gear(gear), study%case%iso%web_thickness(gear), &
                                       study%case%iso%rim_thickness(gear))
  end function is_webbed

  !> Reports the effect of rims and webs on masses and stiffness, if the case describes any.
  pure subroutine add_webs(study, lines)
    type(study_t), intent(in) :: study
    type(lines_t), intent(inout) :: lines
    character(:), allocatable :: words
    integer :: i

    if (.not. any([(is_webbed(study, i), i=1, 2)])) return
    words = 'count in the masses'
    if (.not. any([(origin(study, i) == of_web, i=1, 2)])) words = 'do not count in the masses, which are stated'
    select case (study%case%model)
    case ('iso6336')
      words = words//'; in the stiffness by C_R'
    case ('fe')
      if (any(rims(study%case, study%pair) > 0)) then
        words = words//'; in the stiffness as rims that sections of '//str(rim_teeth(study%case))// &
          ' teeth hold at their sides: that the webs hold them too is left out'
      else
        words = words//'; not in the stiffness, as &section says what is held'
      end if
    case default
      words = words//'; not in the stiffness by '//study%case%model
    end select
    call lines%add(left('Rim and web', 19)//words)
  end subroutine add_webs

  !> Reports the part of the gear-body rotation in the motion, and the difference of one degree of freedom from the chain of all
  !> inertias.
  pure subroutine add_hub_lines(table, lines)
    type(table_t), intent(in) :: table
    type(lines_t), intent(inout) :: lines
    real(dp), parameter :: much = 0.01_dp
    real(dp) :: more

    call lines%add(left('Hubs', 19)//'their inertia makes the motion feel '//str(table%number('felt_rotation_um'), 4)// &
                   ' um of that turn; as a chain of four inertias the gears have')
    call lines%add(left('', 19)//'natural frequencies of '//str(table%number('chain_frequency_hz'), 5)//' and '// &
                   str(table%number('next_chain_frequency_hz'), 5)//' Hz, of which the motion has one')
    more = table%number('natural_frequency_hz')/table%number('chain_frequency_hz') - 1
    if (more > much) call lines%add(left('', 19)//'caution: its natural frequency lies '//str(100*more, 2)// &
      ' % above the chain''s, as the bodies turn too softly about these hubs')
  end subroutine add_hub_lines

  !> Reports the inputs of the standard, and the difference to another model.
  pure subroutine add_iso(study, table, lines)
    type(study_t), intent(in) :: study
    type(table_t), intent(in) :: table
    type(lines_t), intent(inout) :: lines
    real(dp), parameter :: wide = 0.15_dp
    !> Range of validity of q': ISO 6336-1:2006, 9.3.1.1.
    real(dp), parameter :: least_sum = -0.5_dp, most_sum = 2
    !> Contact ratio below which c_gamma may be up to a tenth less than by its formula: ISO 6336-1:2006, 9.3.2.
    real(dp), parameter :: least_ratio = 1.2_dp
    real(dp) :: more

    call lines%add(left('', 19)//'F_t K_A/b '//str(table%number('iso_line_load_n_mm'), 4)//' N/mm, C_R '// &
                   str(table%number('iso_blank_factor'), 4))
    more = table%number('weber_mesh_stiffness_n_um')/table%number('mean_mesh_stiffness_n_um') - 1
    if (abs(more) > wide) call lines%add(left('', 19)//'the model weber has a mesh mean of '// &
      str(table%number('weber_mesh_stiffness_n_um'), 4)//' N/um, '//str(100*abs(more), 2)//' % '// &
      merge('more', 'less', more > 0)//'; ISO 6336-1 is a mean of usual gears')
    associate (x => study%pair%gear%spec%profile_shift)
      if (x(1) < x(2) .or. sum(x) < least_sum .or. sum(x) > most_sum) call lines%add(left('', 19)//'caution: the standard has '// &
        'its formula for profile shifts of the pinion at least as large as the gear''s, with a sum from '//str(least_sum)// &
        ' to '//str(most_sum))
    end associate
    if (study%pair%contact_ratio < least_ratio) call lines%add(left('', 19)//'caution: below a contact ratio of '// &
      str(least_ratio)//' the standard has a mesh stiffness up to a tenth less')
  end subroutine add_iso
end module gearsweep_study_results_motion_table
