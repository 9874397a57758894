!> Stages of gear pair, load, masses, pair stiffness, and of one oscillator for each relief.
module gearsweep_study_run_mesh_stage
  use gearsweep_base, only: claim_memory, code_input, dp, error_t, fail, find_rows, pi, rows_t, str
  use gearsweep_gear, only: add_corner_stiffness, arm_change, check_pin, drive, free_centre_distance, gear_spec_t, gear_t, &
    has_web, make_gear, make_pair, pair_t, solid_inertia, tip_alteration, web_inertia
  use gearsweep_elastic, only: contact_half_width, fe_options_t, fe_stiffness, on_second_grid, teeth_t
  use gearsweep_mesh, only: iso_stiffness, mesh_of, mesh_t, polynomial_stiffness, profile_table, table_stiffness, weber_stiffness
  use gearsweep_study_case_case, only: case_t
  use gearsweep_study_run_files, only: path_in, read_text
  use gearsweep_study_run_inputs, only: elements_inputs_t, motion_inputs_t, motions_inputs_t, relief_inputs_t, same
  use gearsweep_study_run_case_variation, only: build_motion, find_profile_error
  use gearsweep_study_run_stages, only: study_t
  implicit none
  private
  public :: build_pair, name_load, pressure_at_pitch, rim_teeth, rims, mesh_and_motion

contains

  !> Builds gears, centre distance and path of contact.
  subroutine build_pair(case, pair, error)
    type(case_t), intent(in) :: case
    type(pair_t), intent(out) :: pair
    type(error_t), allocatable, intent(out) :: error
    type(gear_spec_t) :: spec(2)
    type(gear_t) :: gear(2)
    real(dp) :: distance
    integer :: i

    spec = case%spec
    call make_gears(spec, gear, error)
    if (allocated(error)) return
    distance = case%centre_distance
    if (distance <= 0) distance = free_centre_distance(gear(1), gear(2))
    if (case%tip_alteration) then
      spec%tip_alteration = tip_alteration(gear(1), gear(2), distance)
      call make_gears(spec, gear, error)
      if (allocated(error)) return
    end if
    call make_pair(gear(1), gear(2), distance, pair, error, shorten=case%shorten_path)
    ! The key's backlash is that of the pair.
    if (case%has_backlash) pair%backlash = case%backlash
    do i = 1, 2
      call check_pin(gear(i), error)
    end do
  end subroutine build_pair

  subroutine make_gears(spec, gear, error)
    type(gear_spec_t), intent(in) :: spec(2)
    type(gear_t), intent(out) :: gear(2)
    type(error_t), allocatable, intent(out) :: error
    integer :: i

    do i = 1, 2
      call make_gear(spec(i), gear(i), error)
      if (allocated(error)) return
    end do
  end subroutine make_gears

  !> Computes the static load (N) and effective masses (kg) on the line of action, the part of these masses at the hubs, and the
  !> base pitch (m), 0 if it is not known. `pair`: not allocated for a prescribed mesh.
  pure subroutine find_load(case, pair, base_pitch, load, mass, hub_mass)
    type(case_t), intent(in) :: case
    type(pair_t), allocatable, intent(in) :: pair
    real(dp), intent(out) :: base_pitch, load, mass(2), hub_mass(2)
    real(dp) :: base_radius(2)
    integer :: i

    base_pitch = case%base_pitch
    if (allocated(pair)) base_pitch = pair%base_pitch
    base_radius = base_pitch*case%spec%teeth/(2*pi)
    load = 0
    hub_mass = 0
    if (case%torque > 0) load = case%torque/base_radius(1)
    if (case%normal_force > 0) load = case%normal_force
    if (case%line_load > 0) load = case%line_load*case%spec(1)%face_width
    do i = 1, 2
      if (case%mass(i) > 0) then
        mass(i) = case%mass(i)
      else if (case%inertia(i) > 0) then
        mass(i) = case%inertia(i)/base_radius(i)**2
      else
        associate (gear => pair%gear(i), web => case%iso%web_thickness(i), rim => case%iso%rim_thickness(i))
          if (has_web(gear, web, rim)) then
            mass(i) = web_inertia(gear, web, rim, case%material(i)%density)/base_radius(i)**2
          else
            mass(i) = solid_inertia(gear, case%material(i)%density)/base_radius(i)**2
          end if
        end associate
      end if
      if (case%hub_inertia(i) > 0) hub_mass(i) = case%hub_inertia(i)/base_radius(i)**2
      mass(i) = mass(i) + hub_mass(i)
    end do
  end subroutine find_load

  !> Refuses a load (N on the line of action) that flattens the flanks somewhere on the path over more than a module, where
  !> teeth are no half planes. Such loads, and such narrow faces, come from numbers in another unit than their key's.
  pure subroutine check_load(case, pair, load, error)
    type(case_t), intent(in) :: case
    type(pair_t), intent(in) :: pair
    real(dp), intent(in) :: load
    type(error_t), allocatable, intent(inout) :: error
    real(dp) :: flat, given, scale, middle
    character(:), allocatable :: key

    ! The contact is widest where the curvatures of both flanks are equal, or at the nearest place on the path.
    middle = ((pair%curvature(1, 0.0_dp) + pair%curvature(2, 0.0_dp))/2 - pair%start_curvature)/pair%base_pitch
    associate (module => case%spec(1)%module)
      flat = 2*half_width(case, pair, load, min(max(middle, 0.0_dp), pair%contact_ratio))
      if (flat <= module) return
      scale = (module/flat)**2
    end associate
    call name_load(case, key, given)
    call fail(error, code_input, '&load '//key//' = '//str(given)//': flattens the flanks over '//str(1000*flat, 3)// &
              ' mm, more than the module; with this face width it must be at most '//str(given*scale, 3)// &
              trim(merge('; if N mm is meant, divide by 1000', repeat(' ', 34), case%torque > 0)))
  end subroutine check_load

  !> Returns the key of &load in the case, and its value in the key's unit.
  pure subroutine name_load(case, key, given)
    type(case_t), intent(in) :: case
    character(:), allocatable, intent(out) :: key
    real(dp), intent(out) :: given

    key = 'torque_nm'
    if (allocated(case%torques)) key = 'torques_nm'
    given = case%torque
    if (case%normal_force > 0) key = 'normal_force_n'
    if (case%normal_force > 0) given = case%normal_force
    if (case%line_load > 0) key = 'line_load_n_mm'
    if (case%line_load > 0) given = case%line_load/1000
  end subroutine name_load

  !> Contact pressure by Hertz (Pa) of one pair at the pitch point under the full load (N on the line of action).
  !> Source: Johnson 1985, Contact Mechanics, Eqs. 4.43 and 4.45.
  pure real(dp) function pressure_at_pitch(case, pair, load) result(pressure)
    type(case_t), intent(in) :: case
    type(pair_t), intent(in) :: pair
    real(dp), intent(in) :: load
    real(dp) :: points(5)

    points = pair%points()
    pressure = 2*load/minval(case%spec%face_width)/(pi*half_width(case, pair, load, points(3)))
  end function pressure_at_pitch

  !> Half width (m) of the contact of one pair at path coordinate `s` under the full load (N on the line of action).
  pure real(dp) function half_width(case, pair, load, s)
    type(case_t), intent(in) :: case
    type(pair_t), intent(in) :: pair
    real(dp), intent(in) :: load, s

    associate (slant => cos(pair%gear(1)%base_helix()))
      half_width = contact_half_width(case%material(1), case%material(2), .true., load/minval(case%spec%face_width), &
                                      pair%curvature(1, s)/slant, pair%curvature(2, s)/slant)
    end associate
  end function half_width

  !> Rim thicknesses (m) at which the sections of pinion and gear end for the pair stiffness by elements, if the case has webs and
  !> no key for the fixed edge; 0: as in &section.
  pure function rims(case, pair)
    type(case_t), intent(in) :: case
    type(pair_t), intent(in) :: pair
    real(dp) :: rims(2)
    integer :: i

    rims = 0
    if (case%has_support .or. case%section%rim > 0 .or. case%section%teeth == 0) return
    do i = 1, 2
      associate (gear => pair%gear(i), rim => case%iso%rim_thickness(i))
        if (rim_teeth(case) < gear%spec%teeth .and. has_web(gear, case%iso%web_thickness(i), rim)) rims(i) = rim
      end associate
    end do
  end function rims

  !> Number of teeth of such a section: that of the case, or five. Between its sides the rim then deflects about as much as a beam
  !> on the elastic foundation of its web.
  pure integer function rim_teeth(case)
    type(case_t), intent(in) :: case

    rim_teeth = 5
    if (case%has_extent) rim_teeth = case%section%teeth
  end function rim_teeth

  !> Sets the data of the path of contact. `pair`: not allocated for a prescribed mesh.
  subroutine place_mesh(case, pair, mesh)
    type(case_t), intent(in) :: case
    type(pair_t), allocatable, intent(in) :: pair
    type(mesh_t), intent(out) :: mesh

    if (allocated(pair)) then
      mesh = mesh_of(pair)
      return
    end if
    mesh%teeth = case%spec%teeth
    mesh%contact_ratio = case%contact_ratio
    mesh%pitch_point = case%pitch_point
    if (case%pitch_point < 0) mesh%pitch_point = case%contact_ratio/2
    mesh%tan_angle = tan(case%spec(1)%pressure_angle(drive))
    mesh%reach = [0.0_dp, mesh%contact_ratio]
  end subroutine place_mesh

  !> Reads two columns of numbers, with or without a line of names.
  subroutine read_table(path, first, second, error)
    character(*), intent(in) :: path
    real(dp), allocatable, intent(out) :: first(:), second(:)
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: text, fields(:)
    type(rows_t) :: table
    logical :: ok(3)
    integer :: i

    call read_text(path, text, error)
    if (allocated(error)) return
    call find_rows(text, path, '', table, error)
    if (allocated(error)) return
    allocate (first(size(table%rows)), second(size(table%rows)))
    do i = 1, size(first)
      call table%fields(i, 2, fields, ok(1))
      call table%number(fields(1), first(i), ok(2))
      call table%number(fields(2), second(i), ok(3))
      if (.not. all(ok)) then
        call table%refuse(i, 'must be two numbers', error)
        return
      end if
    end do
  end subroutine read_table

  !> Builds what all loaded tasks start from. Products of an `earlier` study with the same inputs are reused.
  subroutine mesh_and_motion(study, folder, error, earlier)
    type(study_t), intent(inout) :: study
    character(*), intent(in) :: folder
    type(error_t), allocatable, intent(inout) :: error
    type(study_t), intent(in), optional :: earlier
    integer :: i

    call find_load(study%case, study%pair, study%base_pitch, study%load, study%mass, study%hub_mass)
    if (allocated(study%pair)) call check_load(study%case, study%pair, study%load, error)
    if (allocated(error)) return
    allocate (study%mesh)
    call place_mesh(study%case, study%pair, study%mesh)
    if (study%case%is_helical()) then
      call find_reliefs(study, error)
      return
    end if
    if (study%case%model == 'fe') then
      call find_by_elements(study, error, earlier)
    else
      call by_model(study, folder, study%load, study%mesh, error)
      call study%running%note('mesh: pair stiffness by model '//study%case%model)
    end if
    if (allocated(error)) return
    call reach_beyond(study, study%mesh)
    ! Each relief has a mesh of its own.
    associate (curve => study%mesh%stiffness)
      call claim_memory((size(study%case%amount) + 1)*(8000 + 8.0_dp*(size(curve%coef) + size(curve%breaks))), &
                        '&relief amount_um: '//str(size(study%case%amount))//' reliefs', error)
    end associate
    if (allocated(error)) return
    call list_inputs(study, study%mesh, study%load, study%motions_inputs)
    allocate (study%motion(size(study%case%amount)))
    do i = 1, size(study%motion)
      call build_motion(study%motions_inputs, study%case%amount(i), study%motion(i), error)
      if (allocated(error)) return
    end do
    if (allocated(study%case%torques) .and. .not. allocated(error)) call find_other_loads(study, folder, error)
  end subroutine mesh_and_motion

  !> Finds the profile errors of helical gears for each relief, and the inputs of the load over their face width, from which their
  !> motion follows: no stiffness of a pair over the path of the transverse section describes their mesh.
  subroutine find_reliefs(study, error)
    type(study_t), intent(inout) :: study
    type(error_t), allocatable, intent(inout) :: error
    integer :: i

    study%elements_inputs = elements_of(study)
    call claim_memory((size(study%case%amount) + 1)*8000.0_dp, '&relief amount_um: '//str(size(study%case%amount))//' reliefs', &
                      error)
    if (allocated(error)) return
    call list_inputs(study, study%mesh, study%load, study%motions_inputs)
    deallocate (study%mesh)
    allocate (study%profile_error(size(study%case%amount)))
    do i = 1, size(study%profile_error)
      call find_profile_error(study%motions_inputs%motion%relief, study%case%amount(i), study%profile_error(i), error)
      if (allocated(error)) return
    end do
    call study%running%note('mesh: helical gears, without a pair stiffness')
  end subroutine find_reliefs

  !> Lists the inputs of the pair stiffness by elements.
  pure type(elements_inputs_t) function elements_of(study) result(inputs)
    type(study_t), intent(in) :: study

    inputs = elements_inputs_t(study%pair, study%case%material, fe_options_t( &
      section=study%case%stiffness_body(), tooth_coupling=study%case%tooth_coupling, rim=rims(study%case, study%pair), &
      rim_teeth=rim_teeth(study%case), hub_share=study%hub_mass/study%mass, corner_contact=study%case%corner_contact), &
      study%load/study%case%spec(1)%face_width)
  end function elements_of

  !> Lists the inputs of the motions under each torque of the case, with the stiffness under that torque.
  subroutine find_other_loads(study, folder, error)
    type(study_t), intent(inout) :: study
    character(*), intent(in) :: folder
    type(error_t), allocatable, intent(inout) :: error
    type(elements_inputs_t) :: inputs
    type(mesh_t) :: mesh
    real(dp) :: load
    integer :: i

    study%torque = study%case%torques
    allocate (study%of_torque(size(study%torque)))
    do i = 1, size(study%torque)
      load = study%load*study%torque(i)/study%case%torque
      call place_mesh(study%case, study%pair, mesh)
      if (study%case%model == 'fe') then
        inputs = study%elements_inputs
        inputs%line_load = load/study%case%spec(1)%face_width
        call by_elements(inputs, mesh, study%teeth, error)
      else
        call by_model(study, folder, load, mesh, error)
      end if
      if (allocated(error)) return
      call reach_beyond(study, mesh)
      call list_inputs(study, mesh, load, study%of_torque(i))
    end do
  end subroutine find_other_loads

  !> Computes the stiffness of one pair (N/m over s) by a model other than finite elements, under a load (N). A prescribed mesh
  !> also has its shared compliance and a profile error from a table, which may extend beyond A and E as far as a table of the
  !> stiffness does. `folder`: of the case's files.
  subroutine by_model(study, folder, load, mesh, error)
    type(study_t), intent(in) :: study
    character(*), intent(in) :: folder
    real(dp), intent(in) :: load
    type(mesh_t), intent(inout) :: mesh
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: s(:), values(:)
    real(dp) :: softest

    associate (case => study%case)
      select case (case%model)
      case ('weber')
        call weber_stiffness(study%pair, case%material, load/case%spec(1)%face_width, mesh%stiffness, error)
      case ('iso6336')
        call iso_stiffness(study%pair, case%material, load/case%spec(1)%face_width, mesh%stiffness, error, case%iso)
      case ('polynomial')
        call polynomial_stiffness(mesh%contact_ratio, case%coefficients, mesh%stiffness, error)
      case ('table')
        call read_table(path_in(folder, case%file), s, values, error)
        if (.not. allocated(error)) then
          call claim_memory(200.0_dp*size(s), '&mesh file: '//str(size(s))//' rows', error)
          ! Values out of range are refused by their row.
          if (.not. allocated(error)) call table_stiffness(mesh%contact_ratio, s, 1e6_dp*max(-1e300_dp, min(1e300_dp, values)), &
                                                           mesh%stiffness, error)
        end if
      case default  ! the reader of the case allows no other
      end select
      if (case%has_corner_contact() .and. .not. allocated(error)) call add_corner_stiffness(study%pair, load, mesh%stiffness)
      if (case%prescribed .and. .not. allocated(error)) then
        mesh%disc%shared = case%shared_compliance
        softest = 1/mesh%stiffness%maximum()
        if (mesh%disc%shared >= softest) call fail(error, code_input, '&mesh shared_compliance_um_n = '// &
          str(1e6_dp*mesh%disc%shared)//': is a part of each pair''s compliance, which falls to '//str(1e6_dp*softest)//' um/N')
        if (allocated(error) .or. .not. allocated(case%profile_error_file)) return
        call read_table(path_in(folder, case%profile_error_file), s, values, error)
        if (allocated(error)) return
        call claim_memory(400.0_dp*size(s), '&mesh profile_error_file: '//str(size(s))//' rows', error)
        if (.not. allocated(error)) call profile_table(mesh%contact_ratio, s, 1e-6_dp*max(-1e300_dp, min(1e300_dp, values)), &
                                                       mesh%profile_error, error)
        if (allocated(error) .or. case%model /= 'table') return
        associate (known => mesh%stiffness%breaks([1, size(mesh%stiffness%breaks)]))
          mesh%reach = [min(mesh%reach(1), max(known(1), s(1))), max(mesh%reach(2), min(known(2), s(size(s))))]
        end associate
      end if
    end associate
  end subroutine by_model

  !> Extends the reach of contact as far as the stiffness is known.
  pure subroutine reach_beyond(study, mesh)
    type(study_t), intent(in) :: study
    type(mesh_t), intent(inout) :: mesh
    integer :: end, gear

    if (.not. study%case%has_corner_contact()) return
    mesh%reach = mesh%stiffness%breaks([1, size(mesh%stiffness%breaks)])
    ! Lever arms of friction are straight lines up to half of the reach; on the line of action they change by 2 pi/z per base pitch.
    if (mesh%reaches_beyond()) then
      do end = 1, 2
        associate (s => merge(mesh%reach(1), mesh%contact_ratio + mesh%reach(2), end == 1)/2)
          do gear = 1, 2
            mesh%arm_change(gear, end) = arm_change(study%pair, gear, end, s) - merge(2*pi, -2*pi, gear == 1)/mesh%teeth(gear)
          end do
        end associate
      end do
    end if
  end subroutine reach_beyond

  subroutine find_by_elements(study, error, earlier)
    type(study_t), intent(inout) :: study
    type(error_t), allocatable, intent(inout) :: error
    type(study_t), intent(in), optional :: earlier
    character(40) :: how
    logical :: known
    type(elements_inputs_t) :: inputs

    study%elements_inputs = elements_of(study)
    known = .false.
    if (present(earlier)) known = allocated(earlier%elements_inputs)
    if (known) study%teeth%list = earlier%teeth%list
    if (known) known = same(study%elements_inputs, earlier%elements_inputs)
    if (known) then
      study%mesh%stiffness = earlier%mesh%stiffness
      study%mesh%disc = earlier%mesh%disc
      study%mesh%flattening = earlier%mesh%flattening
      call study%running%note('mesh: pair stiffness by model fe, taken over')
    else
      call by_elements(study%elements_inputs, study%mesh, study%teeth, error)
      how = ''
      if (study%teeth%taken > 0) how = ', one gear''s teeth taken over'
      if (study%teeth%taken > 0 .and. study%teeth%solved == 0) how = ', the teeth taken over'
      call study%running%note('mesh: pair stiffness by model fe'//trim(how))
    end if
    ! The task `mesh` reports the error of the grid.
    if (study%case%requests('mesh') .and. .not. allocated(error)) then
      inputs = study%elements_inputs
      inputs%options%section = on_second_grid(inputs%options%section)
      study%second_grid = study%mesh
      call by_elements(inputs, study%second_grid, study%teeth, error)
      if (.not. allocated(error)) call reach_beyond(study, study%second_grid)
    end if
  end subroutine find_by_elements

  subroutine by_elements(inputs, mesh, teeth, error)
    type(elements_inputs_t), intent(in) :: inputs
    type(mesh_t), intent(inout) :: mesh
    type(teeth_t), intent(inout) :: teeth
    type(error_t), allocatable, intent(inout) :: error

    call fe_stiffness(inputs%pair, inputs%material, inputs%options, inputs%line_load, mesh%stiffness, mesh%disc, error, &
                      mesh%flattening, teeth)
  end subroutine by_elements

  !> Collects the inputs of the oscillators under a load (N).
  pure subroutine list_inputs(study, mesh, load, inputs)
    type(study_t), intent(in) :: study
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: load
    type(motions_inputs_t), intent(out) :: inputs
    type(relief_inputs_t) :: relief

    associate (case => study%case)
      relief = relief_inputs_t(prescribed=case%prescribed, base_pitch=study%base_pitch, contact_ratio=mesh%contact_ratio, &
                               pitch_point=mesh%pitch_point, fraction=case%fraction, shape=case%shape, start=case%start, &
                               length=case%length, roll=case%roll)
      if (allocated(study%pair)) relief%pair = study%pair
      inputs%motion = motion_inputs_t( &
        relief=relief, disc=mesh%disc, reach=mesh%reach, teeth=mesh%teeth, &
        tan_angle=mesh%tan_angle, arm_change=mesh%arm_change, load=load, mass=study%mass, damping_ratio=case%damping_ratio, &
        friction=case%friction, has_backlash=case%has_backlash, backlash=case%backlash)
      if (case%nonlinear_contact) inputs%motion%flattening = mesh%flattening
      ! Thinner teeth of a gear than usual imply backlash.
      if (case%has_allowance .and. .not. case%has_backlash) then
        inputs%motion%has_backlash = .true.
        inputs%motion%backlash = max(0.0_dp, study%pair%backlash)
      end if
      inputs%stiffness = mesh%stiffness
      inputs%profile_error = mesh%profile_error
      inputs%amount = case%amount
    end associate
  end subroutine list_inputs
end module gearsweep_study_run_mesh_stage
