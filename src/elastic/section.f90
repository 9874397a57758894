!> Section of a gear, from one tooth to the complete gear: its grid, its root surface, and the factored stiffness.
!>
!> Each tooth is a block that begins between its fillets, where their tangents are at 60 degrees to the tooth axis; below is the
!> rim, whose column lines are radial. The tooth's own axis is y, angles grow towards x, and the drive flank is on the side of x.
!> The loaded tooth is the middle one; of an even number, the one at the left of the y axis, which then halves the middle space.
!> The root surface between two teeth is the lower fillet and the root land. Stress and modes use the same two grids, whose
!> difference estimates the error.
module gearsweep_elastic_section
  use gearsweep_base, only: bracket_t, claim_memory, code_input, code_memory, dp, error_t, fail, pi, str
  use gearsweep_gear, only: coast, drive, fillet_parameter, fillet_point, gear_t, root_angle, teeth_around
  use gearsweep_elastic_body, only: body_t, make_body
  use gearsweep_elastic_grid, only: grid_t, make_grid, no_element
  use gearsweep_elastic_material, only: check_material, material_t, on_second_grid, section_options_t
  use gearsweep_elastic_tooth_block, only: make_tooth_block, split_angle, tooth_block_t, turned
  implicit none
  private
  public :: append, fillet_run, section_options_t, section_t, make_section, assumed_bore_radius, section_body_t, &
            make_section_body, make_two_grids, mean_step_ratio, select_near_teeth, stress_error_share

  type :: section_t
    type(gear_t) :: gear
    type(section_options_t) :: options
    type(grid_t) :: grid
    real(dp) :: inner_radius = 0                 !< m
    real(dp) :: half_angle = 0                   !< rad; pi for a complete gear
    real(dp) :: middle = 0                       !< angle of the sector's middle: 0 between equal flanks
    real(dp), allocatable :: axis(:)             !< angle of each tooth's axis, rad
    integer, allocatable :: first_column(:)      !< number of columns before each tooth
    integer, allocatable :: across(:)            !< number of columns of each tooth
    integer :: rim_rows = 0
    integer :: loaded = 0                        !< the middle tooth
  contains
    procedure :: flank_line
    procedure :: surface
    procedure :: is_held
  end type section_t

  !> Length of the rim's elements: this fraction of their depth below the root, or of their radius where that is less, over the
  !> number of elements across a tooth.
  real(dp), parameter :: growth = 1.6_dp
  integer, parameter :: most_across = 200

  !> Body of a section, one metre wide and as stiff as steel, for any material: stress depends on neither, and frequencies and
  !> shapes follow by a factor.
  type :: section_body_t
    type(section_t) :: section
    type(material_t) :: material
    type(body_t) :: body
  end type section_body_t

contains

  !> Appends a run of points that begins at the end of the last one.
  pure subroutine append(top, run)
    real(dp), allocatable, intent(inout) :: top(:, :)
    real(dp), intent(in) :: run(:, :)
    real(dp), allocatable :: joined(:, :)
    integer :: n

    n = size(top, 2)
    if (n == 0) then
      top = run
    else
      allocate (joined(2, n + size(run, 2) - 1))
      joined(:, :n) = top
      joined(:, n + 1:) = run(:, 2:)
      call move_alloc(joined, top)
    end if
  end subroutine append

  !> Lower fillet and root land of one side of the tooth with this `axis`, between the tooth's block and the ray at angle `ray`;
  !> left to right.
  pure function fillet_run(gear, block, side, axis, ray) result(run)
    type(gear_t), intent(in) :: gear
    type(tooth_block_t), intent(in) :: block
    integer, intent(in) :: side
    real(dp), intent(in) :: axis, ray
    real(dp), allocatable :: run(:, :)
    real(dp) :: reach, first, last, angle, p(2)
    integer :: land, i, n
    type(bracket_t) :: beta

    reach = abs(ray - axis)
    first = block%split(side)
    last = pi/2
    land = 0
    if (reach < root_angle(gear, side)*(1 - 1e-9_dp)) then
      ! Parameter of the fillet at this angle from the tooth axis, by bisection.
      beta = bracket_t(first, pi/2)
      do while (beta%is_open())
        p = fillet_point(gear, side, beta%middle())
        call beta%halve(atan2(p(1), p(2)) < reach)
      end do
      last = beta%middle()
    else if (reach > root_angle(gear, side)*(1 + 1e-9_dp)) then
      land = max(1, nint(block%across*gear%root_radius*(reach - root_angle(gear, side))/block%width))
    end if
    n = 2*block%lower
    allocate (run(2, 0:n + 2*land))
    do i = 0, n
      run(:, i) = fillet_point(gear, side, first + (last - first)*i/n)
    end do
    do i = n + 1, n + 2*land
      angle = root_angle(gear, side) + (reach - root_angle(gear, side))*(i - n)/(2*land)
      run(:, i) = gear%root_radius*[sin(angle), cos(angle)]
    end do
    if (side == coast) run(1, :) = -run(1, :)
    if (side == coast) run = run(:, ubound(run, 2):0:-1)
    run = turned(run, axis)
  end function fillet_run

  !> Builds the grid of a section of `gear`.
  subroutine make_section(gear, options, section, error)
    type(gear_t), intent(in) :: gear
    type(section_options_t), intent(in) :: options
    type(section_t), intent(out) :: section
    type(error_t), allocatable, intent(out) :: error
    type(tooth_block_t), allocatable :: block(:)
    real(dp), allocatable :: top(:, :), points(:, :, :)
    integer, allocatable :: part(:, :)
    integer :: across, k
    type(tooth_block_t) :: other
    real(dp), parameter :: lattice_bytes = 100, grid_bytes = 120
    real(dp) :: rim_rows

    section%gear = gear
    section%options = options
    if (options%teeth == 0) section%options%teeth = gear%spec%teeth
    call check_options(gear, section%options, error)
    if (allocated(error)) return
    call set_extent(section, error)
    if (allocated(error)) return
    ! Memory of the points of each tooth, about 2 across by 3 across, and of its columns in the grid.
    across = options%elements_across
    if (options%others_across > 0) across = options%others_across
    call claim_memory(section%options%teeth*(1000 + 16.0_dp*(2*across + 3)*(3*across + 12)) &
                      + 300.0_dp*options%elements_across**2, 'teeth of the section = '//str(section%options%teeth), error)
    if (allocated(error)) return
    allocate (block(section%options%teeth))
    call make_tooth_block(gear, options%elements_across, block(section%loaded))
    other = block(section%loaded)
    if (options%others_across > 0) call make_tooth_block(gear, options%others_across, other)
    do k = 1, size(block)
      if (k /= section%loaded) block(k) = other
    end do
    call place_columns(section, block, top)
    call check_size(section, block, (size(top, 2) - 1)/2, error)
    ! Memory of the points of the lattice, and of nodes and elements of the grid, which is copied with the section and the body.
    rim_rows = max(1.0_dp, block(section%loaded)%across*rim_steps(section, block, section%inner_radius)/growth)
    call claim_memory((size(top, 2) - 1)/2*((lattice_bytes + grid_bytes)*(rim_rows + 1) + lattice_bytes*maxval(block%upper)) &
                      + grid_bytes*sum(real(block%across, dp)*block%upper), &
                      'elements across a tooth = '//str(section%options%elements_across)//': the grid', error)
    if (allocated(error)) return
    call fill_lattice(section, block, top, points, part)
    call make_grid(points, part, is_closed(section), section%grid, error)
    if (allocated(error)) then
      deallocate (error)
      call fail(error, code_input, 'rim (mm) = '//str(1000*(gear%root_radius - section%inner_radius))// &
                ': the rim below the root circle is too thin for a grid; must be thicker (or the bore smaller)')
    end if
  end subroutine make_section

  subroutine check_options(gear, options, error)
    type(gear_t), intent(in) :: gear
    type(section_options_t), intent(in) :: options
    type(error_t), allocatable, intent(inout) :: error

    if (options%teeth < 1 .or. options%teeth > gear%spec%teeth) call fail(error, code_input, &
      'teeth of the section = '//str(options%teeth)//': must lie between 1 and the gear''s '//str(gear%spec%teeth))
    if (options%elements_across < 3 .or. options%elements_across > most_across) call fail(error, code_input, &
      'elements across a tooth = '//str(options%elements_across)//': must lie between 3 and '//str(most_across))
    if (options%others_across /= 0 .and. (options%others_across < 3 .or. &
                                          options%others_across > options%elements_across)) then
      call fail(error, code_input, 'elements across the other teeth = '//str(options%others_across)// &
      ': must be 0 or lie between 3 and '//str(options%elements_across))
    end if
    if (.not. options%rim >= 0 .or. options%rim >= gear%root_radius) call fail(error, code_input, &
      'rim (mm) = '//str(1000*options%rim)//': must be above 0 and below the root radius '// &
      str(1000*gear%root_radius)//' mm')
    if (.not. (options%half_angle >= 0 .and. options%half_angle < pi)) call fail(error, code_input, &
      'half angle of the section (deg) = '//str(options%half_angle*180/pi)//': must lie between 0 and 180')
  end subroutine check_options

  !> Computes inner radius, tooth axes and half angle.
  subroutine set_extent(section, error)
    type(section_t), intent(inout) :: section
    type(error_t), allocatable, intent(inout) :: error
    real(dp) :: pitch, least, most
    integer :: i

    associate (gear => section%gear, options => section%options)
      section%inner_radius = gear%root_radius - options%rim
      if (options%rim <= 0) section%inner_radius = gear%spec%bore_radius
      if (section%inner_radius <= 0 .and. is_closed(section)) section%inner_radius = assumed_bore_radius(gear)
      if (section%inner_radius <= 0) section%inner_radius = &
        max(gear%root_radius - 2.5_dp*(gear%tip_radius - gear%root_radius), gear%root_radius/10)
      pitch = 2*pi/teeth_around(gear%spec)
      section%axis = [((i - (options%teeth + 1)/2.0_dp)*pitch, i=1, options%teeth)]
      section%loaded = (options%teeth + 1)/2
      section%half_angle = options%half_angle
      if (options%half_angle <= 0) section%half_angle = options%teeth*pitch/2
      if (section%inner_radius < gear%spec%bore_radius*(1 - 1e-9_dp)) call fail(error, code_input, &
        'rim (mm) = '//str(1000*options%rim)//': reaches into the bore; at most '// &
        str(1000*(gear%root_radius - gear%spec%bore_radius)))
      if (is_closed(section)) return
      ! Cut in the middle of the root lands, which unequal flanks shift.
      section%middle = (root_angle(gear, drive) - root_angle(gear, coast))/2
      least = section%axis(options%teeth) + max(edge_angle(gear, drive) - section%middle, &
                                                edge_angle(gear, coast) + section%middle)
      most = min(pi, section%axis(options%teeth) + pitch - max(root_angle(gear, coast) + section%middle, &
                                                               root_angle(gear, drive) - section%middle))
      if (section%half_angle <= least .or. section%half_angle > most*(1 + 1e-12_dp)) call fail(error, code_input, &
        'half angle of the section (deg) = '//str(section%half_angle*180/pi)//': with '//str(options%teeth)// &
        ' teeth it must lie between '//str(least*180/pi)//' (teeth cut) and '//str(most*180/pi)// &
        ' (overlaps the next tooth)')
    end associate
  end subroutine set_extent

  !> Radius (m) of the bore at which a complete gear without a stated bore is held: a third of the reference radius, as for common
  !> shafts.
  pure real(dp) function assumed_bore_radius(gear) result(radius)
    type(gear_t), intent(in) :: gear

    radius = gear%reference_radius/3
  end function assumed_bore_radius

  !> Selects the section of the loaded tooth and its neighbours for a complete gear, whose other teeth are a superelement. Other
  !> sections, and gears with few teeth, stay as they are.
  pure subroutine select_near_teeth(gear, options, near, others)
    type(gear_t), intent(in) :: gear
    type(section_options_t), intent(in) :: options
    type(section_options_t), intent(out) :: near
    integer, intent(out) :: others               !< number of teeth of the superelement
    ! The tooth after the next one of the loaded tooth is the last.
    integer, parameter :: teeth = 5
    real(dp) :: bore_radius

    near = options
    others = 0
    if (.not. (options%teeth == 0 .or. options%teeth == gear%spec%teeth) .or. options%half_angle > 0) return
    if (gear%spec%teeth <= teeth + 1) return
    near%teeth = teeth
    others = gear%spec%teeth - teeth
    near%fixed_sides = .false.
    bore_radius = gear%spec%bore_radius
    if (bore_radius <= 0) bore_radius = assumed_bore_radius(gear)
    if (options%rim <= 0) near%rim = gear%root_radius - bore_radius
  end subroutine select_near_teeth

  !> Angle from the tooth axis to the start of the tooth's block, with a small margin.
  pure real(dp) function edge_angle(gear, side)
    type(gear_t), intent(in) :: gear
    integer, intent(in) :: side
    real(dp) :: p(2)

    p = fillet_point(gear, side, fillet_parameter(gear, side, split_angle))
    edge_angle = atan2(p(1), p(2)) + 0.05_dp*(root_angle(gear, side) - atan2(p(1), p(2)))
  end function edge_angle

  pure logical function is_closed(section)
    type(section_t), intent(in) :: section

    is_closed = section%options%teeth == section%gear%spec%teeth .and. section%options%half_angle <= 0
  end function is_closed

  !> Computes the points along the top of the rim at all column half steps, from left to right.
  subroutine place_columns(section, block, top)
    type(section_t), intent(inout) :: section
    type(tooth_block_t), intent(in) :: block(:)
    real(dp), allocatable, intent(out) :: top(:, :)
    real(dp) :: pitch, from, to
    integer :: k, teeth

    teeth = section%options%teeth
    pitch = 2*pi/teeth_around(section%gear%spec)
    section%across = block%across
    allocate (section%first_column(teeth))
    from = section%middle - section%half_angle
    if (is_closed(section)) from = section%axis(1)
    allocate (top(2, 0))
    do k = 1, teeth
      if (.not. (is_closed(section) .and. k == 1)) then
        call append(top, fillet_run(section%gear, block(k), coast, section%axis(k), from))
      end if
      section%first_column(k) = max(0, size(top, 2) - 1)/2
      call append(top, turned(block(k)%bottom, section%axis(k)))
      to = section%middle + section%half_angle
      if (k < teeth .or. is_closed(section)) to = &
        section%axis(k) + (pitch + root_angle(section%gear, drive) - root_angle(section%gear, coast))/2
      call append(top, fillet_run(section%gear, block(k), drive, section%axis(k), to))
      from = to
    end do
    if (is_closed(section)) call append(top, fillet_run(section%gear, block(1), coast, section%axis(1) + 2*pi, from))
  end subroutine place_columns

  !> Refuses a grid whose stiffness matrix would not fit, before it is built.
  pure subroutine check_size(section, block, columns, error)
    type(section_t), intent(in) :: section
    type(tooth_block_t), intent(in) :: block(:)
    integer, intent(in) :: columns
    type(error_t), allocatable, intent(inout) :: error
    real(dp) :: elements, unknowns, width, reach

    reach = rim_steps(section, block, section%inner_radius)
    elements = columns*block(section%loaded)%across*reach/growth + sum(real(block%across, dp)*block%upper)
    unknowns = 6*elements
    width = 6*(block(section%loaded)%across*reach/growth + block(section%loaded)%upper)
    if (is_closed(section)) width = 2*width
    if (8*unknowns*width > section%options%most_memory) call fail(error, code_memory, &
      'elements across a tooth = '//str(section%options%elements_across)//': the grid has some '// &
      str(unknowns, 2)//' unknowns and needs '//str(8e-9_dp*unknowns*width, 2)//' GB; at most '// &
      str(section%options%most_memory*1e-9_dp, 3)//' GB')
  end subroutine check_size

  !> Radial distance of `radius` in rows of the rim: the integral of dr over their length. Rows grow in proportion to the depth
  !> below the root, as the teeth's stress spreads, and shrink again with the radius towards a small bore.
  pure real(dp) function rim_steps(section, block, radius) result(steps)
    type(section_t), intent(in) :: section
    type(tooth_block_t), intent(in) :: block(:)
    real(dp), intent(in) :: radius
    real(dp) :: first, turn

    first = block(section%loaded)%width/growth
    turn = turning_radius(section, first)
    steps = log(1 + (section%gear%root_radius - max(radius, turn))/first)
    if (radius < turn) steps = steps + log(turn/radius)
  end function rim_steps

  !> Radius at which the depth, and the first step beyond it, equal the radius.
  pure real(dp) function turning_radius(section, first) result(radius)
    type(section_t), intent(in) :: section
    real(dp), intent(in) :: first

    radius = min(section%gear%root_radius, (section%gear%root_radius + first)/2)
  end function turning_radius

  !> Fills the lattice: rim below, teeth above.
  subroutine fill_lattice(section, block, top, points, part)
    type(section_t), intent(inout) :: section
    type(tooth_block_t), intent(in) :: block(:)
    real(dp), intent(in) :: top(:, 0:)
    real(dp), allocatable, intent(out) :: points(:, :, :)
    integer, allocatable, intent(out) :: part(:, :)
    real(dp) :: reach, share, radius, steps, first, turn, outer, level
    integer :: i, j, k, c, rows, rim, columns

    columns = ubound(top, 2)/2
    reach = rim_steps(section, block, section%inner_radius)
    rim = max(1, nint(block(section%loaded)%across*reach/growth))
    section%rim_rows = rim
    rows = rim + maxval(block%upper)
    allocate (points(2, 0:2*columns, 0:2*rows), source=0.0_dp)
    allocate (part(columns, rows), source=no_element)
    part(:, :rim) = 0
    first = block(section%loaded)%width/growth
    turn = turning_radius(section, first)
    outer = rim_steps(section, block, turn)
    do j = 0, 2*rim
      steps = reach*(2*rim - j)/(2.0_dp*rim)
      level = section%gear%root_radius - first*(exp(min(steps, outer)) - 1)
      if (steps > outer) level = turn*exp(outer - steps)
      share = (section%gear%root_radius - level)/(section%gear%root_radius - section%inner_radius)
      do i = 0, 2*columns
        radius = norm2(top(:, i))
        points(:, i, j) = top(:, i)*(radius + (section%inner_radius - radius)*share)/radius
      end do
    end do
    do k = 1, section%options%teeth
      c = section%first_column(k)
      associate (tooth => block(k))
        part(c + 1:c + tooth%across, rim + 1:rim + tooth%upper) = k
        do j = 1, 2*tooth%upper
          points(:, 2*c:2*(c + tooth%across), 2*rim + j) = turned(tooth%points(:, :, j), section%axis(k))
        end do
      end associate
    end do
    if (is_closed(section)) points(:, 2*columns, :) = points(:, 0, :)
  end subroutine fill_lattice

  !> Lattice column line of a flank of tooth `k`.
  pure integer function flank_line(section, k, side) result(line)
    class(section_t), intent(in) :: section
    integer, intent(in) :: k, side

    line = 2*section%first_column(k)
    if (side == drive) line = line + 2*section%across(k)
  end function flank_line

  !> Nodes along one side of tooth `k`, from the middle of the next space, or the cut, up to the tip.
  pure function surface(section, k, side) result(nodes)
    class(section_t), intent(in) :: section
    integer, intent(in) :: k, side
    integer, allocatable :: nodes(:)
    integer :: line, last, far, from
    logical :: is_cut

    line = section%flank_line(k, side)
    last = ubound(section%grid%node, 1)
    if (side == drive) then
      is_cut = k == section%options%teeth .and. .not. section%grid%closed
      far = last
      if (k < section%options%teeth) far = section%flank_line(k + 1, coast)
    else
      is_cut = k == 1 .and. .not. section%grid%closed
      far = 0
      if (k == 1 .and. section%grid%closed) line = last
      if (k > 1) far = section%flank_line(k - 1, drive)
      if (k == 1 .and. section%grid%closed) far = section%flank_line(section%options%teeth, drive)
    end if
    from = merge(far, line + 2*((far - line)/4), is_cut)
    nodes = [section%grid%node(from:line:merge(-1, 1, side == drive), 2*section%rim_rows), &
             section%grid%node(line, 2*section%rim_rows + 1:)]
  end function surface

  !> True for the nodes held by the supports.
  pure function is_held(section) result(held)
    class(section_t), intent(in) :: section
    logical :: held(size(section%grid%x, 2))
    integer :: last

    held = .false.
    last = ubound(section%grid%node, 1)
    if (section%options%fixed_rim) held(section%grid%row_nodes(0)) = .true.
    if (section%options%fixed_sides .and. .not. section%grid%closed) then
      held(section%grid%column_nodes(0)) = .true.
      held(section%grid%column_nodes(last)) = .true.
    end if
  end function is_held

  !> Builds and factors a section of `gear`; frees the previous content of `product`.
  subroutine make_section_body(gear, material, options, product, error)
    type(gear_t), intent(in) :: gear
    type(material_t), intent(in) :: material
    type(section_options_t), intent(in) :: options
    type(section_body_t), intent(inout) :: product
    type(error_t), allocatable, intent(out) :: error

    call check_material(material, error)
    if (allocated(error)) return
    product%material = material
    call make_section(gear, options, product%section, error)
    if (allocated(error)) return
    call make_body(product%section%grid, material_t(poisson=material%poisson, density=material%density), &
                   options%plane_strain, 1.0_dp, spread(product%section%is_held(), 1, 2), options%most_memory, &
                   product%body, error)
  end subroutine make_section_body

  !> Builds the requested grid, and one of half the fineness.
  subroutine make_two_grids(gear, material, options, grids, error)
    type(gear_t), intent(in) :: gear
    type(material_t), intent(in) :: material
    type(section_options_t), intent(in) :: options
    type(section_body_t), intent(inout) :: grids(2)
    type(error_t), allocatable, intent(out) :: error

    call make_section_body(gear, material, options, grids(1), error)
    if (allocated(error)) return
    call make_section_body(gear, material, on_second_grid(options), grids(2), error)
  end subroutine make_two_grids

  !> Mean element size of the second grid over that of the first. Columns along the fillets and rows of the rim have minimum
  !> numbers, so that coarse grids differ less in it than in the elements across a tooth.
  pure real(dp) function mean_step_ratio(grids)
    type(section_body_t), intent(in) :: grids(2)

    mean_step_ratio = sqrt(real(size(grids(1)%section%grid%element, 2), dp)/size(grids(2)%section%grid%element, 2))
  end function mean_step_ratio

  !> Error of stress on the first grid over its difference to that on the second. Stress converges with second order once the grid
  !> suits the fillet; on coarser grids the order is lower and differs from gear to gear (`sh bench/run.sh honesty`).
  pure real(dp) function stress_error_share(grids) result(share)
    type(section_body_t), intent(in) :: grids(2)
    integer, parameter :: fine = 8
    real(dp) :: order

    associate (across => grids%section%options%elements_across)
      order = merge(2.0_dp, 1.5_dp, across(1) >= fine)
      share = 1/abs((real(across(1), dp)/across(2))**order - 1)
    end associate
  end function stress_error_share
end module gearsweep_elastic_section
