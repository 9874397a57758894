!> Tables of the tasks `section`, `static` and `modal`: one member's body.
module gearsweep_body_tables
  use gearsweep_contour, only: shown_contour
  use gearsweep_decimal, only: in_um
  use gearsweep_error, only: error_t
  use gearsweep_gear, only: coast, drive
  use gearsweep_grid, only: grid_t
  use gearsweep_kinds, only: dp, pi
  use gearsweep_study, only: study_t
  use gearsweep_table, only: each, over_and_over, table_t
  use gearsweep_text, only: str
  implicit none
  private
  public :: find_grid, section_table, outline_table, static_table, root_stress_table, root_rating_table, modal_table
  public :: mode_energy_table, nodes_table, elements_table, mode_shapes_table, stress_load_table, stress_table

  real(dp), parameter :: milli = 1e3_dp, mega = 1e-6_dp, degree = pi/180
  character(*), parameter :: members(2) = [character(6) :: 'pinion', 'gear'], sides(2) = [character(5) :: 'drive', 'coast']

  !> The grid that nodes, elements and mode shapes belong to.
  character(*), parameter :: grid_of_section = 'section'

contains

  !> The section of one member.
  pure subroutine section_table(study, table, error)
    type(study_t), intent(in) :: study
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error

    if (.not. allocated(study%section)) return
    call table%begin('section of one member and its grid', 1, 9, error)
    if (allocated(error)) return
    associate (section => study%section, grid => study%section%grid)
      call table%add_words('member', 'pinion or gear', [members(study%case%root%member)])
      call table%add('teeth', '', 'teeth of the section', [section%options%teeth])
      call table%add('gear_teeth', '', 'teeth of the whole member', [section%gear%spec%teeth])
      call table%add('half_angle_deg', 'deg', 'half of the sector''s angle', [section%half_angle/degree])
      call table%add('inner_radius_mm', 'mm', 'where the section ends inwards', [milli*section%inner_radius])
      call table%add('elements', '', 'of eight nodes', [size(grid%element, 2)])
      call table%add('nodes', '', 'each with two displacements', [size(grid%x, 2)])
      call table%add('smallest_scaled_jacobian', '', 'of the elements: 1 is a rectangle, 0 useless', [grid%quality()])
      call table%add('area_mm2', 'mm2', 'of all elements', [milli**2*grid%area()])
    end associate
  end subroutine section_table

  !> Outlines of both gears as points, clockwise, centres at the origin.
  pure subroutine outline_table(study, table, error)
    type(study_t), intent(in) :: study
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: pinion(:, :), gear(:, :)
    integer :: i

    if (.not. allocated(study%section)) return
    call shown_contour(study%pair%gear(1), pinion)
    call shown_contour(study%pair%gear(2), gear)
    associate (n => size(pinion, 2), m => size(gear, 2))
      call table%begin('outline of both gears, each about its own centre', n + m, 6, error)
      if (allocated(error)) return
      call table%add_index('member', '', 'pinion or gear', members([(1, i=1, n), (2, i=1, m)]))
      call table%add('x_mm', 'mm', 'across the tooth that stands upright, towards its drive side', &
                     milli*[pinion(1, :), gear(1, :)])
      call table%add('y_mm', 'mm', 'along the axis of that tooth', milli*[pinion(2, :), gear(2, :)])
    end associate
  end subroutine outline_table

  !> Root stress of one member under the moving load, at the fillet tangent of the case.
  pure subroutine static_table(study, table, error)
    type(study_t), intent(in) :: study
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    integer :: i, n, m

    if (.not. allocated(study%root)) return
    associate (root => study%root)
      m = size(root)
      n = size(root(1)%s)
      call table%begin('stress at tangent_deg of the fillet for each relief and position of the load', 2*n*m, 9, error, &
                       extent=[m, n, 2])
      if (allocated(error)) return
      call table%add_index('relief_um', 'um', 'amount of relief', each(in_um(study%case%amount), 2*n))
      call table%add_index('s', '', 'path coordinate of the load, in base pitches from A', [(each(root(i)%s, 2), i=1, m)])
      call table%add('radius_mm', 'mm', 'radius at which it acts on this member', [(each(milli*root(i)%radius, 2), i=1, m)])
      call table%add('load_share', '', 'load of this pair over the whole load', [(each(root(i)%share, 2), i=1, m)])
      call table%add_index('side', '', 'drive (the loaded side: tension) or coast', sides(over_and_over([drive, coast], n*m)))
      call table%add('sigma_mpa', 'MPa', 'stress along the surface', [(mega*root(i)%along, i=1, m)])
      call table%add('sigma_x_mpa', 'MPa', 'component across the tooth, x to its drive side', &
                     [(mega*root(i)%components(1, :, :), i=1, m)])
      call table%add('sigma_y_mpa', 'MPa', 'component along the tooth''s axis y', [(mega*root(i)%components(2, :, :), i=1, m)])
      call table%add('tau_xy_mpa', 'MPa', 'shear component', [(mega*root(i)%components(3, :, :), i=1, m)])
    end associate
  end subroutine static_table

  !> Largest stress in the root fillets over the path of contact, for each relief.
  pure subroutine root_stress_table(study, table, error)
    type(study_t), intent(in) :: study
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error

    if (.not. allocated(study%root)) return
    associate (stress => study%root%stress, m => size(study%root))
      call table%begin('largest stress in the root fillets over the path of contact', m, 6, error, extent=[m])
      if (allocated(error)) return
      call table%add_index('relief_um', 'um', 'amount of relief', in_um(study%case%amount))
      call table%add('tension_mpa', 'MPa', 'largest tension along the surface', [mega*stress%tension%stress])
      call table%add('tension_deg', 'deg', 'angle of the fillet tangent there to the tooth''s axis', &
                     [stress%tension%tangent/degree])
      call table%add('compression_mpa', 'MPa', 'largest compression along the surface, negative', &
                     [mega*stress%compression%stress])
      call table%add('compression_deg', 'deg', 'angle of the fillet tangent there to the tooth''s axis', &
                     [stress%compression%tangent/degree])
      call table%add('error_estimate', '', 'estimated error of the stresses, relative', [stress%error_estimate])
    end associate
  end subroutine root_stress_table

  !> What the standard and Lewis give for the whole load at the outer point of single contact.
  pure subroutine root_rating_table(study, table, error)
    type(study_t), intent(in) :: study
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error

    if (.not. allocated(study%root)) return
    call table%begin('nominal root stress by ISO 6336-3 and by Lewis, the whole load at the outer point of single contact', &
                     1, 7, error)
    if (allocated(error)) return
    associate (root => study%root(1))
      call table%add_words('member', 'pinion or gear', [members(study%case%root%member)])
      call table%add_words('point', 'of the path of contact where the load acts', &
                           [merge('D', 'B', study%case%root%member == 1)])
      call table%add('iso_mpa', 'MPa', 'sigma_F0 of ISO 6336-3', [mega*root%iso_stress])
      call table%add('iso_form_factor', '', 'Y_F', [root%iso%form_factor])
      call table%add('iso_stress_correction', '', 'Y_S', [root%iso%correction])
      call table%add('lewis_mpa', 'MPa', 'by Lewis', [mega*root%lewis_stress])
      call table%add('lewis_form_factor', '', 'Y', [root%lewis])
    end associate
  end subroutine root_rating_table

  !> Natural frequencies of the section.
  pure subroutine modal_table(study, table, error)
    type(study_t), intent(in) :: study
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    integer :: i

    if (.not. allocated(study%modal)) return
    associate (modes => study%modal%modes, n => size(study%modal%modes%frequency))
      call table%begin('natural frequencies of the section', n, 5, error, extent=[n])
      if (allocated(error)) return
      call table%add_index('mode', '', 'from the lowest frequency', [(i, i=1, n)])
      call table%add('frequency_hz', 'Hz', 'natural frequency', modes%frequency)
      call table%add('error_estimate', '', 'estimated discretisation error, relative', study%modal%error_estimate)
      call table%add('residual', '', 'residual of the eigenvalue problem, relative', modes%residual)
      call table%add('rim_share', '', 'kinetic energy of the body below the teeth over the whole', modes%participation(0, :))
    end associate
  end subroutine modal_table


  !> Where the kinetic energy of each mode is.
  pure subroutine mode_energy_table(study, table, error)
    type(study_t), intent(in) :: study
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    integer :: i, n, parts

    if (.not. allocated(study%modal)) return
    associate (energy => study%modal%modes%participation)
      parts = size(energy, 1)
      n = size(energy, 2)
      call table%begin('kinetic energy of each mode by part of the section', parts*n, 3, error, extent=[n, parts])
      if (allocated(error)) return
      call table%add_index('mode', '', 'from the lowest frequency', each([(i, i=1, n)], parts))
      call table%add_index('tooth', '', 'counted from the coast side; 0 for the body below the teeth', &
                     over_and_over([(i, i=0, parts - 1)], n))
      call table%add('energy_share', '', 'kinetic energy of this part over the whole', [energy])
    end associate
  end subroutine mode_energy_table

  !> Nodes of the section's grid.
  pure subroutine nodes_table(study, table, error)
    type(study_t), intent(in) :: study
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    type(grid_t), allocatable :: grid
    integer :: i

    call find_grid(study, grid)
    if (.not. allocated(grid)) return
    associate (n => size(grid%x, 2))
      call table%begin('nodes of the section''s grid', n, 3, error, extent=[n], grid=grid_of_section)
      if (allocated(error)) return
      call table%add_index('node', '', 'its number', [(i, i=1, n)])
      call table%add('x_mm', 'mm', 'across the middle tooth, towards its drive side', milli*grid%x(1, :))
      call table%add('y_mm', 'mm', 'along the axis of that tooth', milli*grid%x(2, :))
    end associate
  end subroutine nodes_table

  !> Its elements: corners anticlockwise, then the midsides in the same order.
  pure subroutine elements_table(study, table, error)
    type(study_t), intent(in) :: study
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    type(grid_t), allocatable :: grid
    integer :: i

    call find_grid(study, grid)
    if (.not. allocated(grid)) return
    associate (n => size(grid%element, 2))
      call table%begin('elements of the section''s grid: four corners anticlockwise, then the midsides behind each', n, 10, &
                       error, extent=[n], grid=grid_of_section)
      if (allocated(error)) return
      call table%add_index('element', '', 'its number', [(i, i=1, n)])
      do i = 1, size(grid%element, 1)
        call table%add('node_'//str(i), '', 'number of this node', grid%element(i, :))
      end do
      call table%add('tooth', '', 'that it belongs to, from the coast side; 0: the rim', grid%part)
    end associate
  end subroutine elements_table

  !> Mode shapes at the nodes.
  pure subroutine mode_shapes_table(study, table, error)
    type(study_t), intent(in) :: study
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    integer :: i, n, m

    if (.not. allocated(study%modal)) return
    associate (shape => study%modal%modes%shape)
      m = size(shape, 2)
      n = size(shape, 3)
      call table%begin('mode shapes at the nodes of the section''s grid, for unit modal mass', n*m, 4, error, extent=[n, m], &
                       grid=grid_of_section)
      if (allocated(error)) return
      call table%add_index('mode', '', 'from the lowest frequency', each([(i, i=1, n)], m))
      call table%add_index('node', '', 'its number', over_and_over([(i, i=1, m)], n))
      call table%add('shape_x', 'kg**-0.5', 'displacement in x over the modal coordinate', [shape(1, :, :)])
      call table%add('shape_y', 'kg**-0.5', 'displacement in y over the modal coordinate', [shape(2, :, :)])
    end associate
  end subroutine mode_shapes_table

  !> The load under which the table `stress` is.
  pure subroutine stress_load_table(study, table, error)
    type(study_t), intent(in) :: study
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error

    if (.not. allocated(study%field)) return
    call table%begin('the load under which the stress is given all over the section', 1, 5, error)
    if (allocated(error)) return
    associate (i => study%field%relief, k => study%field%position)
      call table%add('relief_um', 'um', 'amount of relief: the one with the largest tension', in_um(study%case%amount(i:i)))
      call table%add('position', '', 'of the load, counted from 1 in the table static', [k])
      call table%add('s', '', 'path coordinate of the load, in base pitches from A', study%root(i)%s(k:k))
      call table%add('radius_mm', 'mm', 'radius at which it acts on this member', milli*study%root(i)%radius(k:k))
      call table%add('load_share', '', 'load of this pair over the whole load', study%root(i)%share(k:k))
    end associate
  end subroutine stress_load_table

  !> Stress at the nodes.
  pure subroutine stress_table(study, table, error)
    type(study_t), intent(in) :: study
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    integer :: i

    if (.not. allocated(study%field)) return
    associate (stress => study%field%stress, n => size(study%field%stress, 2))
      call table%begin('stress at the nodes of the section''s grid under the load of the table stress_load', n, 4, error, &
                       extent=[n], grid=grid_of_section)
      if (allocated(error)) return
      call table%add_index('node', '', 'its number', [(i, i=1, n)])
      call table%add('sigma_x_mpa', 'MPa', 'component across the middle tooth, x to its drive side', mega*stress(1, :))
      call table%add('sigma_y_mpa', 'MPa', 'component along that tooth''s axis y', mega*stress(2, :))
      call table%add('tau_xy_mpa', 'MPa', 'shear component', mega*stress(3, :))
    end associate
  end subroutine stress_table

  !> The grid that section, modes and stress share.
  pure subroutine find_grid(study, grid)
    type(study_t), intent(in) :: study
    type(grid_t), allocatable, intent(out) :: grid

    if (allocated(study%section)) then
      grid = study%section%grid
    else if (allocated(study%modal)) then
      grid = study%modal%section%grid
    else if (allocated(study%field)) then
      grid = study%field%grid
    end if
  end subroutine find_grid
end module gearsweep_body_tables
