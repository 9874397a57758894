!> The task `body_modes`: natural modes of a whole gear in three dimensions, of every nodal diameter (see
!> gearsweep_body_modes_body_modes).
module gearsweep_body_modes_task_body_modes
  use gearsweep_base, only: axis, code_input, dp, error_t, fail, lines_t, str, table_t
  use gearsweep_study, only: gear_names, is_prescribed, needs_gears, reader_t, runnable_t, sentence_length, stage, stages_t, &
    task_info_t, text_unless
  use gearsweep_body_modes_body_modes, only: body_modes_t, body_options_t, find_body_modes, name_length, name_of
  use gearsweep_body_modes_sector, only: gear_blank_t, sector_t
  use gearsweep_body_modes_sector_modes, only: axial, radial, sector_mode_t
  implicit none
  private
  public :: body_modes_task_t

  type, extends(runnable_t) :: body_modes_task_t
    type(body_options_t) :: options
    real(dp) :: hub_radius = 0                   !< outer radius of the hub, m; 0: no hub
    integer :: shapes = 6                        !< number of modes with their shapes
    integer :: harmonics = 3                     !< number of mesh harmonics in the table of speeds
  contains
    procedure, nopass :: describe
    procedure :: read_keys, run, add_report
    procedure, private :: read_held
  end type body_modes_task_t

  character(*), parameter :: group = 'body_modes'
  character(*), parameter :: of_mode = 'from the lowest frequency', of_node = 'its number'
  character(*), parameter :: directions(3) = [character(10) :: 'radial', 'tangential', 'axial']
  character(*), parameter :: about_middle(2) = [character(13) :: 'symmetric', 'antisymmetric']

contains

  pure subroutine describe(info)
    type(task_info_t), intent(out) :: info

    info = task_info_t(group, needs=[stage%geometry, stage%solid], &
                       tables='gear_body body_modes body_campbell body_nodes body_elements body_shapes', &
                       fields='', summary='natural modes of a whole gear in three dimensions, by nodal diameter, '// &
                       'and the speeds at which the mesh excites them')
  end subroutine describe

  subroutine read_keys(self, reader, error)
    class(body_modes_task_t), intent(inout) :: self
    type(reader_t), intent(inout) :: reader
    type(error_t), allocatable, intent(inout) :: error
    character(sentence_length) :: geared

    call reader%add_group(group, 'The task body_modes: natural modes of the gear &section gear, teeth and body, extruded.')
    geared = text_unless(.not. is_prescribed(reader), needs_gears)
    associate (options => self%options)
      call reader%get(group, 'modes', options%modes, error, tasks=group, not_allowed=geared, at_least=1, at_most=100, &
                      meaning='natural modes from the lowest, of each nodal diameter and each of both symmetries about the '// &
                      'middle plane')
      call reader%get(group, 'nodal_diameters', options%most_diameters, error, tasks=group, not_allowed=geared, at_least=0, &
                      default_note='all, half the number of teeth', meaning='nodal diameters from 0 up to this one')
      call self%read_held(reader, geared, error)
      call reader%get(group, 'hub_diameter_mm', self%hub_radius, error, unit='mm', factor=0.5_dp, tasks=group, &
                      not_allowed=geared, above=0.0_dp, default_note='none: the web reaches the bore', &
                      meaning='outer diameter of a hub as wide as the teeth, inside a web (web_thickness_mm)')
      call reader%get(group, 'elements_across', options%across, error, tasks=group, not_allowed=geared, at_least=2, at_most=20, &
                      meaning='finite elements across a tooth, which all else follows; a second grid has half as many')
    end associate
    call reader%get(group, 'shapes', self%shapes, error, tasks=group, not_allowed=geared, at_least=1, at_most=1000, &
                    meaning='modes from the lowest of all whose shapes are given')
    call reader%get(group, 'harmonics', self%harmonics, error, tasks=group, not_allowed=geared, at_least=1, at_most=100, &
                    meaning='harmonics of the mesh frequency in the table body_campbell')
  end subroutine read_keys

  subroutine read_held(self, reader, geared, error)
    class(body_modes_task_t), intent(inout) :: self
    type(reader_t), intent(inout) :: reader
    character(*), intent(in) :: geared
    type(error_t), allocatable, intent(inout) :: error
    character(:), allocatable :: held(:)
    integer :: i

    allocate (held, source=directions)
    call reader%get(group, 'held', held, error, tasks=group, not_allowed=geared, &
                    allowed=[character(10) :: directions, 'nothing'], &
                    meaning='what the surface of the bore cannot do: all three on a shaft that holds it fast, ''radial'' and '// &
                    '''tangential'' on a hub along which it slides, ''nothing'' for a free gear')
    if (allocated(error)) return
    self%options%support%held = [(any(held == directions(i)), i=1, 3)]
    if (any(held == 'nothing') .and. size(held) > 1) call fail(error, code_input, &
      '&body_modes held: ''nothing'' stands alone')
  end subroutine read_held

  subroutine run(self, stages, error)
    class(body_modes_task_t), intent(inout) :: self
    type(stages_t), intent(in) :: stages
    type(error_t), allocatable, intent(inout) :: error
    type(body_options_t) :: options
    type(body_modes_t) :: found
    integer :: shapes, i

    options = self%options
    associate (inputs => stages%solid_inputs)
      options%blank = gear_blank_t(inputs%web, inputs%rim, self%hub_radius)
      call find_body_modes(inputs%gear, inputs%material, options, stages%accuracy%steady%stop, found, error)
    end associate
    if (allocated(error) .or. .not. allocated(found%modes)) return
    shapes = min(self%shapes, size(found%modes))
    associate (table => self%tables(self%place('gear_body')))
      call table%begin('the gear as a body, and the grid of half a tooth sector', 1, error)
      if (allocated(error)) return
      call table%add_words('gear', 'pinion or gear', [trim(gear_names(stages%gear))])
      call table%add('mass_kg', 'kg', 'mass', [found%mass])
      call table%add('polar_inertia_kgm2', 'kg m^2', 'moment of inertia about the axis', [found%inertia])
      call table%add('rigid_motions', '', 'motions as a rigid body that the bore leaves; they are not among the modes', &
                     [found%rigid])
      call table%add('sectors', '', 'tooth sectors', [found%sector%sectors])
      call table%add('nodes', '', 'nodes of the grid, three displacements each', [size(found%sector%x, 2)])
      call table%add('elements', '', 'its bricks', [size(found%sector%element, 2)])
    end associate
    call fill_modes(found, self%tables(self%place('body_modes')), error)
    associate (teeth => stages%pair%gear%spec%teeth)
      call fill_speeds(found%modes, teeth(stages%gear), teeth(1), self%harmonics, self%tables(self%place('body_campbell')), error)
    end associate
    associate (table => self%tables(self%place('body_nodes')), front => found%sector%front, x => found%sector%x)
      call table%over('nodes on the front of the tooth sector', error, axis('node', '', of_node, [(i, i=1, size(front))]))
      if (allocated(error)) return
      call table%add('x_mm', 'mm', 'across the tooth', [x(1, front)])
      call table%add('y_mm', 'mm', 'along the tooth, from the axis of the gear', [x(2, front)])
      call table%add('z_mm', 'mm', 'along the axis of the gear, from the middle plane', [x(3, front)])
    end associate
    call fill_elements(found%sector, self%tables(self%place('body_elements')), error)
    call fill_shapes(found%modes(:shapes), self%tables(self%place('body_shapes')), error)
    self%is_done = .not. allocated(error)
    self%log = 'body_modes: '//str(size(found%modes))//' modes'
  end subroutine run

  pure subroutine fill_modes(found, table, error)
    type(body_modes_t), intent(in) :: found
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    character(name_length) :: names(size(found%modes))
    integer :: i, k

    if (allocated(error)) return
    associate (modes => found%modes, n => size(found%modes))
      names = name_of(modes)
      call table%over('natural modes of the gear body', error, axis('mode', '', of_mode, [(i, i=1, n)]))
      if (allocated(error)) return
      call table%add('frequency_hz', 'Hz', 'natural frequency', [modes%frequency])
      call table%add_words('mode_name', 'torsion, umbrella, rocking, ... by nodal diameter, symmetry and energy', names)
      call table%add('nodal_diameter', '', 'waves around the gear', [modes%diameter])
      call table%add_words('symmetry', 'of the displacements in the plane about the middle plane', &
                           about_middle(modes%symmetry))
      call table%add('order', '', 'from the lowest of this nodal diameter and symmetry', [modes%order])
      call table%add('multiplicity', '', 'modes of this frequency, equal but for a turn about the axis', [modes%count])
      call table%add('error_estimate', '', 'estimated discretisation error, relative', found%error_estimate)
      call table%add('residual', '', 'residual of the eigenvalue problem, relative', [modes%residual])
      do i = radial, axial
        call table%add(trim(directions(i))//'_share', '', 'kinetic energy of the '//trim(directions(i))// &
                       ' motion over the whole', [(modes(k)%share(i), k=1, n)])
      end do
    end associate
  end subroutine fill_modes

  !> Fills the speeds of resonance. The load is fixed in space while the gear rotates through it, so that harmonic k of the mesh
  !> frequency excites a mode of n nodal diameters k z + n and k z - n times per revolution of the gear with z teeth, and the steady
  !> load (k = 0) n times.
  pure subroutine fill_speeds(modes, teeth, pinion_teeth, harmonics, table, error)
    type(sector_mode_t), intent(in) :: modes(:)
    integer, intent(in) :: teeth, pinion_teeth, harmonics
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    integer :: mode(size(modes)*(2*harmonics + 1)), per_turn(size(mode)), harmonic(size(mode)), i, k, n, way

    if (allocated(error)) return
    n = 0
    do i = 1, size(modes)
      do k = 0, harmonics
        do way = -1, 1, 2
          ! A mode without a second one of its frequency has 0 or z/2 nodal diameters: both signs have the same orders.
          if (way < 0 .and. (k == 0 .or. modes(i)%count == 1) .or. k*teeth + modes(i)%diameter == 0) cycle
          n = n + 1
          mode(n) = i
          harmonic(n) = k
          per_turn(n) = k*teeth + way*modes(i)%diameter
        end do
      end do
    end do
    call table%begin('speeds at which the mesh excites the modes of the gear body as it turns past the load', n, error)
    if (allocated(error)) return
    call table%add_index(axis('mode', '', of_mode, mode(:n)))
    call table%add_index(axis('per_turn', '', 'excitations in a turn of the gear: harmonic times teeth, plus or minus nodal '// &
                              'diameters', per_turn(:n)))
    call table%add('harmonic', '', 'of the mesh frequency; 0: the steady load', harmonic(:n))
    call table%add('nodal_diameter', '', 'waves around the gear', [(modes(mode(i))%diameter, i=1, n)])
    call table%add('frequency_hz', 'Hz', 'natural frequency', [(modes(mode(i))%frequency, i=1, n)])
    call table%add('rpm', '1/min', 'speed of the pinion at which these meet it', &
                   [(60*modes(mode(i))%frequency*teeth/pinion_teeth/per_turn(i), i=1, n)])
  end subroutine fill_speeds

  !> Fills the elements: corners anticlockwise, then the midsides in the same order.
  pure subroutine fill_elements(sector, table, error)
    type(sector_t), intent(in) :: sector
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    integer :: i

    if (allocated(error)) return
    associate (element => sector%plane%element)
      call table%over('elements on the front of the tooth sector: four corners anticlockwise, then the midsides behind each', &
                      error, axis('element', '', of_node, [(i, i=1, size(element, 2))]))
      if (allocated(error)) return
      do i = 1, size(element, 1)
        call table%add('node_'//str(i), '', 'number of this node', [element(i, :)])
      end do
    end associate
  end subroutine fill_elements

  pure subroutine fill_shapes(modes, table, error)
    type(sector_mode_t), intent(in) :: modes(:)
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    complex(dp), allocatable :: shape(:, :)
    integer :: nodes, i, d

    if (allocated(error)) return
    nodes = size(modes(1)%shape, 2)
    call table%over('mode shapes on the front, for unit modal mass of the gear: k sectors on, against the clock, the '// &
                    'displacement is cos(n k pitch) times the first part less sin(n k pitch) times the second', error, &
                    axis('mode', '', of_mode, [(i, i=1, size(modes))]), axis('node', '', of_node, [(i, i=1, nodes)]))
    if (allocated(error)) return
    allocate (shape(nodes, size(modes)))
    do d = radial, axial
      do i = 1, size(modes)
        shape(:, i) = modes(i)%shape(d, :)
      end do
      call table%add(trim(directions(d))//'_cos', 'kg**-0.5', trim(directions(d))//' displacement, first part', [real(shape)])
      call table%add(trim(directions(d))//'_sin', 'kg**-0.5', trim(directions(d))//' displacement, second part', [aimag(shape)])
    end do
  end subroutine fill_shapes

  pure subroutine add_report(self, lines)
    class(body_modes_task_t), intent(in) :: self
    type(lines_t), intent(inout) :: lines

    associate (body => self%tables(self%place('gear_body')), modes => self%tables(self%place('body_modes')))
      call lines%add('')
      call lines%add('Natural modes of the '//trim(body%word('gear', 1))//' as a body: '//str(body%number('mass_kg', 1), 4)// &
                     ' kg, '//str(body%number('polar_inertia_kgm2', 1), 4)//' kg m^2')
      if (body%number('rigid_motions', 1) > 0) call lines%add('Motions as a rigid body, left out: '// &
        str(nint(body%number('rigid_motions', 1))))
      call modes%show(lines, 'mode frequency_hz error_estimate residual mode_name multiplicity')
    end associate
  end subroutine add_report
end module gearsweep_body_modes_task_body_modes
