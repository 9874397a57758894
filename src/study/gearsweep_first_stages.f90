!> From a case to the products of the first stages: gear pair, load and masses, mesh.
module gearsweep_first_stages
  use gearsweep_kinds, only: dp, pi
  use gearsweep_blank, only: has_web, web_inertia
  use gearsweep_case, only: case_t
  use gearsweep_error, only: error_t, fail, code_input
  use gearsweep_files, only: beside
  use gearsweep_flattening, only: contact_half_width
  use gearsweep_gear, only: drive, gear_spec_t, gear_t, make_gear
  use gearsweep_measures, only: check_pin
  use gearsweep_memory, only: claim_memory
  use gearsweep_mesh, only: mesh_t
  use gearsweep_pair, only: free_centre_distance, make_pair, pair_t, tip_alteration
  use gearsweep_piecewise, only: piecewise_t
  use gearsweep_profile_table, only: profile_table
  use gearsweep_stiffness, only: iso_stiffness, polynomial_stiffness, table_stiffness
  use gearsweep_table_file, only: read_table
  use gearsweep_text, only: str
  use gearsweep_weber, only: weber_stiffness
  implicit none
  private
  public :: build_pair, check_load, find_load, name_load, pressure_at_pitch, place_mesh, rim_teeth, rims, build_stiffness
  public :: build_profile_error

contains

  !> Gears, centre distance and path of contact.
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
    ! The backlash that is stated is that of the pair.
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

  !> Static load (N) and effective masses (kg) on the line of action, and what of these sits at the hubs; its base pitch
  !> (m), 0 where it is not known. `pair`: not allocated for a prescribed mesh.
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
  !> teeth are no half planes: such loads, and such narrow faces, come about where a number is in another unit than its key.
  pure subroutine check_load(case, pair, load, error)
    type(case_t), intent(in) :: case
    type(pair_t), intent(in) :: pair
    real(dp), intent(in) :: load
    type(error_t), allocatable, intent(inout) :: error
    real(dp) :: flat, given, scale, middle
    character(:), allocatable :: key

    ! The contact is widest where both flanks are curved alike, or nearest to there.
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

  !> The key of &load that the case gives, and its value in the key's unit.
  pure subroutine name_load(case, key, given)
    type(case_t), intent(in) :: case
    character(:), allocatable, intent(out) :: key
    real(dp), intent(out) :: given

    key = 'torque_nm'
    given = case%torque
    if (case%normal_force > 0) key = 'normal_force_n'
    if (case%normal_force > 0) given = case%normal_force
    if (case%line_load > 0) key = 'line_load_n_mm'
    if (case%line_load > 0) given = case%line_load/1000
  end subroutine name_load

  !> Hertz's pressure (Pa) between one pair at the pitch point under the whole load (N on the line of action).
  !> Source: Johnson 1985, Contact Mechanics, Eqs. 4.43 and 4.45.
  pure real(dp) function pressure_at_pitch(case, pair, load) result(pressure)
    type(case_t), intent(in) :: case
    type(pair_t), intent(in) :: pair
    real(dp), intent(in) :: load
    real(dp) :: points(5)

    points = pair%points()
    pressure = 2*load/minval(case%spec%face_width)/(pi*half_width(case, pair, load, points(3)))
  end function pressure_at_pitch

  !> Half width (m) of the contact of one pair at path coordinate `s` under the whole load (N on the line of action).
  pure real(dp) function half_width(case, pair, load, s)
    type(case_t), intent(in) :: case
    type(pair_t), intent(in) :: pair
    real(dp), intent(in) :: load, s

    half_width = contact_half_width(case%material(1), case%material(2), .true., load/minval(case%spec%face_width), &
                                    pair%curvature(1, s), pair%curvature(2, s))
  end function half_width

  !> Polar inertia of a disc up to the reference circle, less its bore (kg m^2).
  pure real(dp) function solid_inertia(gear, density)
    type(gear_t), intent(in) :: gear
    real(dp), intent(in) :: density

    solid_inertia = pi/2*density*gear%spec%face_width*(gear%reference_radius**4 - gear%spec%bore_radius**4)
  end function solid_inertia

  !> Thickness (m) of the rims at which the sections of pinion and gear end for the pair stiffness by elements, as the case has
  !> webs and does not say what is held; 0: as &section says.
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

  !> Teeth of such a section: as the case says, or five. Between its sides the rim then deflects about as much as a beam on elastic
  !> foundation, its web.
  pure integer function rim_teeth(case)
    type(case_t), intent(in) :: case

    rim_teeth = 5
    if (case%has_extent) rim_teeth = case%section%teeth
  end function rim_teeth

  !> The path's data. `pair`: not allocated for a prescribed mesh.
  subroutine place_mesh(case, pair, mesh)
    type(case_t), intent(in) :: case
    type(pair_t), allocatable, intent(in) :: pair
    type(mesh_t), intent(out) :: mesh
    real(dp) :: points(5)

    mesh%teeth = case%spec%teeth
    if (case%prescribed) then
      mesh%contact_ratio = case%contact_ratio
      mesh%pitch_point = case%pitch_point
      if (case%pitch_point < 0) mesh%pitch_point = case%contact_ratio/2
      mesh%tan_angle = tan(case%spec(1)%pressure_angle(drive))
    else
      points = pair%points()
      mesh%contact_ratio = pair%contact_ratio
      mesh%pitch_point = points(3)
      mesh%tan_angle = tan(pair%working_angle(drive))
    end if
    mesh%reach = [0.0_dp, mesh%contact_ratio]
  end subroutine place_mesh

  !> Stiffness of one pair (N/m over s) by a model other than finite elements, under `load` (N). `folder` is where the
  !> case's files lie.
  subroutine build_stiffness(case, pair, load, folder, contact_ratio, stiffness, error)
    type(case_t), intent(in) :: case
    type(pair_t), allocatable, intent(in) :: pair
    real(dp), intent(in) :: load, contact_ratio
    character(*), intent(in) :: folder
    type(piecewise_t), intent(out) :: stiffness
    type(error_t), allocatable, intent(out) :: error
    real(dp), allocatable :: s(:), values(:)

    select case (case%model)
    case ('weber')
      call weber_stiffness(pair, case%material, line_load(), stiffness, error)
    case ('iso6336')
      call iso_stiffness(pair, case%material, line_load(), stiffness, error, case%iso)
    case ('polynomial')
      call polynomial_stiffness(contact_ratio, case%coefficients, stiffness, error)
    case ('table')
      call read_table(beside(folder, case%file), s, values, error)
      if (.not. allocated(error)) then
        call claim_memory(200.0_dp*size(s), '&mesh file: '//str(size(s))//' rows', error)
        ! What is out of range either way is refused by its row.
        if (.not. allocated(error)) call table_stiffness(contact_ratio, s, 1e6_dp*max(-1e300_dp, min(1e300_dp, values)), &
                                                         stiffness, error)
      end if
    case default  ! the reader of the case knows no other
    end select

  contains

    real(dp) function line_load()
      line_load = load/case%spec(1)%face_width
    end function line_load
  end subroutine build_stiffness

  !> What a prescribed mesh with a stiffness has besides: shared compliance, and profile error from a table, which may
  !> reach beyond A and E as far as a table of the stiffness does.
  subroutine build_profile_error(case, folder, mesh, error)
    type(case_t), intent(in) :: case
    character(*), intent(in) :: folder
    type(mesh_t), intent(inout) :: mesh
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: s(:), values(:)
    real(dp) :: softest

    mesh%disc%shared = case%shared_compliance
    softest = 1/mesh%stiffness%maximum()
    if (mesh%disc%shared >= softest) call fail(error, code_input, '&mesh shared_compliance_um_n = '// &
      str(1e6_dp*mesh%disc%shared)//': is a part of each pair''s compliance, which falls to '//str(1e6_dp*softest)//' um/N')
    if (allocated(error) .or. .not. allocated(case%profile_error_file)) return
    call read_table(beside(folder, case%profile_error_file), s, values, error)
    if (allocated(error)) return
    call claim_memory(400.0_dp*size(s), '&mesh profile_error_file: '//str(size(s))//' rows', error)
    if (.not. allocated(error)) call profile_table(mesh%contact_ratio, s, 1e-6_dp*max(-1e300_dp, min(1e300_dp, values)), &
                                                   mesh%profile_error, error)
    if (allocated(error) .or. case%model /= 'table') return
    associate (known => mesh%stiffness%breaks([1, size(mesh%stiffness%breaks)]))
      mesh%reach = [min(mesh%reach(1), max(known(1), s(1))), max(mesh%reach(2), min(known(2), s(size(s))))]
    end associate
  end subroutine build_profile_error
end module gearsweep_first_stages
