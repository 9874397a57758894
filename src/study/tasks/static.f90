!> The task `static`: root stress of one gear under the moving load, with the values by ISO 6336-3 and Lewis for comparison.
module gearsweep_study_tasks_static
  use gearsweep_base, only: axis, dp, each, error_t, lines_t, str, table_t
  use gearsweep_gear, only: coast, drive, pair_t
  use gearsweep_elastic, only: make_section, root_stress, root_stress_t, section_t
  use gearsweep_mesh, only: mesh_t
  use gearsweep_rating, only: find_stress_field, load_positions, load_radius, rate_root, root_options_t, root_rating_t, &
    shared_by_mesh, shared_equally, shares_stated, spaced_on_flank, spaced_on_path, stress_field_t
  use gearsweep_study_case_task, only: gear_names, stage, task_info_t
  use gearsweep_study_reader_reader, only: first_nonblank, is_prescribed, needs_gears, reader_t, sentence_length, text_unless
  use gearsweep_study_run_grid_tables, only: fill_elements, fill_nodes, fill_section, grid_of_section
  use gearsweep_study_run_inputs, only: same, unit_inputs_t
  use gearsweep_study_run_points, only: add_caution, add_equal_flanks
  use gearsweep_study_run_stages, only: runnable_t, stages_t
  implicit none
  private
  public :: static_task_t

  type, extends(runnable_t) :: static_task_t
    type(root_options_t) :: options
    !> Root stress under unit loads, which depends on no load, relief or stiffness, and its inputs.
    type(root_stress_t), allocatable :: unit_stress
    type(unit_inputs_t) :: unit_inputs
  contains
    procedure, nopass :: describe
    procedure :: read_keys, run, add_report
    procedure :: uses
    procedure, private :: find_unit_stress, add_field
  end type static_task_t

  character(*), parameter :: group = 'static'
  integer, parameter :: stages_needed(*) = [stage%geometry, stage%section, stage%body, stage%mesh, stage%reliefs, stage%amounts]
  character(*), parameter :: sides(2) = [character(5) :: 'drive', 'coast']
  character(*), parameter :: of_relief = 'amount of relief'

contains

  pure subroutine describe(info)
    type(task_info_t), intent(out) :: info

    info = task_info_t(group, needs=stages_needed, tables='static root_stress root_rating stress_load section', &
                       fields='nodes elements stress', &
                       summary='root stress of one gear under the moving load, beside the values by ISO 6336-3 and Lewis')
  end subroutine describe

  !> Relief has no effect if the mesh does not share the load.
  pure logical function uses(self, which)
    class(static_task_t), intent(in) :: self
    integer, intent(in) :: which                 !< index of the stage in `stage`

    uses = any(stages_needed == which) .and. (which /= stage%reliefs .or. self%options%sharing == shared_by_mesh)
  end function uses

  subroutine read_keys(self, reader, error)
    class(static_task_t), intent(inout) :: self
    type(reader_t), intent(inout) :: reader
    type(error_t), allocatable, intent(inout) :: error
    character(:), allocatable :: sharing, spacing
    character(sentence_length) :: geared
    logical :: stated

    call reader%add_group(group, 'The task static: root stress under the moving load.')
    geared = text_unless(.not. is_prescribed(reader), needs_gears)
    associate (root => self%options)
      call reader%get(group, 'shares', root%shares, error, is_stated=stated, tasks=group, not_allowed=geared, &
                      at_least=0.0_dp, at_most=1.0_dp, min_size=2, default_note='as sharing says', &
                      meaning='share of the static load at each position, from the outermost point of contact inwards in '// &
                      'equal arcs of the flank')
      call reader%get(group, 'positions', root%positions, error, at_least=2, at_most=1000, tasks=group, &
                      not_allowed=first_nonblank(geared, text_unless(.not. stated, 'there are as many as shares; remove it')), &
                      meaning='positions of the load on the flank; not with shares, of which there is one for each')
      spacing = 'path'
      call reader%get(group, 'spacing', spacing, error, allowed=[character(5) :: 'path', 'flank'], tasks=group, &
                      not_allowed=first_nonblank(geared, text_unless(.not. stated, &
                      'stated shares stand at equal arcs of the flank; remove it')), &
                      meaning='path: equal steps along the path of contact from A to E, and either side of the places where '// &
                      'the share jumps; flank: equal arcs of the flank, from the outermost point of contact inwards')
      root%spacing = merge(spaced_on_flank, spaced_on_path, stated .or. spacing == 'flank')
      sharing = 'mesh'
      call reader%get(group, 'sharing', sharing, error, allowed=[character(5) :: 'mesh', 'equal'], tasks=group, &
                      not_allowed=first_nonblank(geared, text_unless(.not. stated, 'the shares are stated; give one of the two')), &
                      meaning='load on the tooth: as stiffness and relief share it (mesh), or the same for all pairs in '// &
                      'contact (equal); not with shares')
      root%sharing = merge(shared_equally, shared_by_mesh, sharing == 'equal')
      call reader%get(group, 'tangent_deg', root%tangent, error, unit='deg', tasks=group, not_allowed=geared, &
                      above=0.0_dp, below=90.0_dp, &
                      meaning='angle between the tangent to the fillet and the axis of the tooth where the table gives the '// &
                      'stress; such a point must lie on the fillet')
      call reader%get(group, 'field_position', root%field_position, error, at_least=0, at_most=2000, tasks=group, &
                      not_allowed=geared, default_note='no such table', &
                      meaning='position of the load, counted from 1 in the table static, for the stress all over the section '// &
                      'in the table stress; 0: where the tension is largest')
      if (.not. stated .or. allocated(error)) return
      root%sharing = shares_stated
      root%positions = size(root%shares)
    end associate
  end subroutine read_keys

  subroutine run(self, stages, error)
    class(static_task_t), intent(inout) :: self
    type(stages_t), intent(in) :: stages
    type(error_t), allocatable, intent(inout) :: error
    type(root_rating_t), allocatable :: root(:)
    type(mesh_t), allocatable :: meshes(:)
    type(section_t) :: section
    integer :: i, n, m

    if (allocated(error)) return
    self%options%gear = stages%gear
    call self%find_unit_stress(stages, error)
    if (allocated(error)) return
    meshes = stages%motion%mesh
    call rate_root(stages%pair, meshes, stages%load, self%unit_stress, self%options, root, error)
    if (allocated(error)) return
    associate (table => self%tables(self%place('static')))
      m = size(root)
      n = size(root(1)%s)
      call table%begin('stress at tangent_deg of the fillet for each relief and position of the load', 2*n*m, error, &
                       extent=[m, n, 2])
      if (allocated(error)) return
      call table%add_index(axis('relief_um', 'um', of_relief, each(stages%amount, 2*n)))
      call table%add_index(axis('s', '', 'path coordinate of the load, in base pitches from A', [(each(root(i)%s, 2), i=1, m)]))
      call table%add('radius_mm', 'mm', 'radius at which it acts on this gear', [(each(root(i)%radius, 2), i=1, m)])
      call table%add('load_share', '', 'load of this pair over the whole load', [(each(root(i)%share, 2), i=1, m)])
      call table%add_index(axis('side', '', 'drive (the loaded side: tension) or coast', sides([(drive, coast, i=1, n*m)])))
      call table%add('sigma_mpa', 'MPa', 'stress along the surface', [(root(i)%along, i=1, m)])
      call table%add('sigma_x_mpa', 'MPa', 'component across the tooth, x to its drive side', &
                     [(root(i)%components(1, :, :), i=1, m)])
      call table%add('sigma_y_mpa', 'MPa', 'component along the tooth''s axis y', [(root(i)%components(2, :, :), i=1, m)])
      call table%add('tau_xy_mpa', 'MPa', 'shear component', [(root(i)%components(3, :, :), i=1, m)])
    end associate
    associate (table => self%tables(self%place('root_stress')), stress => root%stress)
      call table%over('largest stress in the root fillets over the path of contact', error, &
                      axis('relief_um', 'um', of_relief, stages%amount))
      if (allocated(error)) return
      call table%add('tension_mpa', 'MPa', 'largest tension along the surface', [stress%tension%stress])
      call table%add('tension_deg', 'deg', 'angle of the fillet tangent there to the tooth''s axis', [stress%tension%tangent])
      call table%add('compression_mpa', 'MPa', 'largest compression along the surface, negative', [stress%compression%stress])
      call table%add('compression_deg', 'deg', 'angle of the fillet tangent there to the tooth''s axis', &
                     [stress%compression%tangent])
      call table%add('error_estimate', '', 'estimated error of the stresses, relative', [stress%error_estimate])
    end associate
    call fill_rating(root(1), stages%gear, stages%pair, self%tables(self%place('root_rating')), error)
    if (allocated(stages%running%bodies)) section = stages%running%bodies(1)%section
    ! Stress of an earlier study needs no grid.
    if (.not. allocated(stages%running%bodies)) &
      call make_section(stages%body_inputs%gear, stages%body_inputs%options, section, error)
    call fill_section(section, gear_names(stages%gear), self%tables(self%place('section')), error)
    if (allocated(error)) return
    if (self%options%field_position >= 0) call self%add_field(stages, root, error)
    self%is_done = .true.
    self%log = 'static: root stress at '//str(self%options%positions)//' positions of the load'
  end subroutine run

  !> Computes the root stress under unit loads, or copies it from an earlier study with the same body and positions.
  subroutine find_unit_stress(self, stages, error)
    class(static_task_t), intent(inout) :: self
    type(stages_t), intent(in) :: stages
    type(error_t), allocatable, intent(inout) :: error

    self%unit_inputs%body = stages%body_inputs
    allocate (self%unit_inputs%radius, source=load_radius(stages%pair, self%options, &
                                                          load_positions(stages%pair, self%options, stages%mesh%reach)))
    if (associated(stages%running%earlier)) then
      select type (before => stages%running%earlier)
      type is (static_task_t)
        self%is_reused = same(self%unit_inputs, before%unit_inputs)
        if (self%is_reused) self%unit_stress = before%unit_stress
      end select
    end if
    if (self%is_reused) return
    call stages%running%need_bodies(stages%body_inputs, error)
    if (allocated(error)) return
    allocate (self%unit_stress)
    call root_stress(stages%running%bodies, self%unit_inputs%radius, spread(1.0_dp, 1, size(self%unit_inputs%radius)), &
                     self%unit_stress, error)
  end subroutine find_unit_stress

  !> Adds the stress field of the section, on the finer of the two grids.
  subroutine add_field(self, stages, root, error)
    class(static_task_t), intent(inout) :: self
    type(stages_t), intent(in) :: stages
    type(root_rating_t), intent(in) :: root(:)
    type(error_t), allocatable, intent(inout) :: error
    type(stress_field_t) :: field
    integer :: i

    call stages%running%need_bodies(stages%body_inputs, error)
    if (allocated(error)) return
    call find_stress_field(stages%running%bodies(1), root, stages%load/minval(stages%pair%gear%spec%face_width), &
                           self%options%field_position, field, error)
    if (allocated(error)) return
    associate (amount => stages%amount(field%relief), root => root(field%relief), table => self%tables(self%place('stress_load')))
      call table%begin('the load under which the stress is given all over the section', 1, error)
      if (allocated(error)) return
      associate (k => field%position)
        call table%add('relief_um', 'um', 'amount of relief: the one with the largest tension', [amount])
        call table%add('position', '', 'of the load, counted from 1 in the table static', [k])
        call table%add('s', '', 'path coordinate of the load, in base pitches from A', root%s(k:k))
        call table%add('radius_mm', 'mm', 'radius at which it acts on this gear', root%radius(k:k))
        call table%add('load_share', '', 'load of this pair over the whole load', root%share(k:k))
      end associate
    end associate
    associate (table => self%tables(self%place('stress')), n => size(field%stress, 2))
      call table%over('stress at the nodes of the section''s grid under the load of the table stress_load', error, &
                      axis('node', '', 'its number', [(i, i=1, n)]), grid=grid_of_section)
      if (allocated(error)) return
      call table%add('sigma_x_mpa', 'MPa', 'component across the middle tooth, x to its drive side', field%stress(1, :))
      call table%add('sigma_y_mpa', 'MPa', 'component along that tooth''s axis y', field%stress(2, :))
      call table%add('tau_xy_mpa', 'MPa', 'shear component', field%stress(3, :))
    end associate
    call fill_nodes(field%grid, self%tables(self%place('nodes')), error)
    call fill_elements(field%grid, self%tables(self%place('elements')), error)
    self%grid = field%grid
    call stages%running%note('static: stress all over the section under one position of the load')
  end subroutine add_field

  !> Fills the values by ISO 6336-3 and Lewis for the full load at the outer point of single contact.
  pure subroutine fill_rating(root, gear, pair, table, error)
    type(root_rating_t), intent(in) :: root
    integer, intent(in) :: gear
    type(pair_t), intent(in) :: pair
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error

    call table%begin('nominal root stress by ISO 6336-3 and by Lewis, the whole load at the outer point of single contact', &
                     1, error)
    if (allocated(error)) return
    call table%add_words('gear', 'pinion or gear', [gear_names(gear)])
    call table%add_words('point', 'of the path of contact where the load acts', [merge('D', 'B', gear == 1)])
    call table%add('iso_mpa', 'MPa', 'sigma_F0 of ISO 6336-3, which takes the load there up to a contact ratio of 2', &
                   [root%iso_stress])
    call table%add('iso_form_factor', '', 'Y_F', [root%iso%form_factor])
    call table%add('iso_stress_correction', '', 'Y_S', [root%iso%correction])
    call table%add('iso_thickness_mm', 'mm', 's_Fn, thickness of the tooth at the 30 degree tangents', [root%iso%thickness])
    call table%add('iso_lever_mm', 'mm', 'h_Fe, lever of the load over that section', [root%iso%lever])
    call table%add('iso_radius_mm', 'mm', 'rho_F, radius of the fillet there', [root%iso%radius])
    call table%add('iso_angle_deg', 'deg', 'alpha_Fen, angle of the load to the normal of the tooth''s axis', [root%iso%load_angle])
    call add_equal_flanks(pair, 1, table)
    call table%add('lewis_mpa', 'MPa', 'by Lewis: F_n cos(alpha_L)/(b m Y), alpha_L the angle of the load to the normal of '// &
                   'the tooth axis', [root%lewis_stress])
    call table%add('lewis_form_factor', '', 'Y = s^2/(6 h m): s tooth thickness and h lever arm where Lewis''s parabola '// &
                   'touches the fillet', [root%lewis])
  end subroutine fill_rating

  pure subroutine add_report(self, lines)
    class(static_task_t), intent(in) :: self
    type(lines_t), intent(inout) :: lines

    associate (rating => self%tables(self%place('root_rating')))
      call lines%add('')
      call lines%add('Root stress of the '//trim(rating%word('gear', 1))//', largest over the path of contact')
      associate (stress => self%tables(self%place('root_stress')))
        call stress%show(lines, 'relief_um tension_mpa tension_deg compression_mpa compression_deg error_estimate')
      end associate
      call lines%add('   ISO 6336-3: sigma_F0 '//str(rating%number('iso_mpa'), 5)//' MPa (Y_F '// &
                     str(rating%number('iso_form_factor'), 4)//', Y_S '//str(rating%number('iso_stress_correction'), 4)// &
                     '); Lewis '//str(rating%number('lewis_mpa'), 5)//' MPa (Y '//str(rating%number('lewis_form_factor'), 4)// &
                     '); for the whole load at point '//trim(rating%word('point', 1)))
      call add_caution(rating, lines)
    end associate
  end subroutine add_report
end module gearsweep_study_tasks_static
