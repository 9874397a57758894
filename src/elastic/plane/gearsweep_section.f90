!> A section of a gear, from one tooth to the whole gear, as a grid.
!>
!> Each tooth is a block that begins between its fillets, where their tangents
!> make 60 degrees with the tooth axis; below lies the rim, whose column lines
!> are radial. The tooth's own axis is y, angles grow towards x, and the drive
!> flank is on the side of x. The loaded tooth is the middle one; of an even number,
!> the one left of the y axis, which then halves the middle space.
module gearsweep_section
  use gearsweep_kinds, only: dp, pi
  use gearsweep_error, only: error_t, fail, code_input, code_memory
  use gearsweep_gear, only: gear_t, drive, coast
  use gearsweep_grid, only: grid_t, make_grid, no_element
  use gearsweep_memory, only: claim_memory
  use gearsweep_outline, only: fillet_point, fillet_parameter, root_angle
  use gearsweep_elastic_options, only: section_options_t
  use gearsweep_root_run, only: append, fillet_run
  use gearsweep_text, only: str
  use gearsweep_tooth_block, only: tooth_block_t, make_tooth_block, turned, split_angle
  implicit none
  private
  public :: section_options_t, section_t, make_section

  type :: section_t
    type(gear_t) :: gear
    type(section_options_t) :: options
    type(grid_t) :: grid
    real(dp) :: inner_radius = 0                 !< m
    real(dp) :: half_angle = 0                   !< rad; pi for a whole gear
    real(dp) :: middle = 0                       !< angle of the sector's middle: 0 between equal flanks
    real(dp), allocatable :: axis(:)             !< angle of each tooth's axis, rad
    integer, allocatable :: first_column(:)      !< columns before each tooth
    integer, allocatable :: across(:)            !< columns of each tooth
    integer :: rim_rows = 0
    integer :: loaded = 0                        !< the middle tooth
  contains
    procedure :: flank_line
    procedure :: surface
    procedure :: is_held
  end type section_t

  !> Elements of the rim are as long as this share of their depth below the root, or of their
  !> radius where that is less, over the number across a tooth.
  real(dp), parameter :: growth = 1.6_dp
  integer, parameter :: most_across = 200

contains

  !> Makes the grid of a section of `gear`.
  subroutine make_section(gear, options, section, error)
    type(gear_t), intent(in) :: gear
    type(section_options_t), intent(in) :: options
    type(section_t), intent(out) :: section
    type(error_t), allocatable, intent(out) :: error
    type(tooth_block_t), allocatable :: block(:)
    real(dp), allocatable :: top(:, :), points(:, :, :)
    integer, allocatable :: part(:, :)

    section%gear = gear
    section%options = options
    if (options%teeth == 0) section%options%teeth = gear%spec%teeth
    call check_options(gear, section%options, error)
    if (allocated(error)) return
    call set_extent(section, error)
    if (allocated(error)) return
    call claim_teeth(section%options, error)
    if (allocated(error)) return
    allocate (block(section%options%teeth))
    call make_tooth_block(gear, options%elements_across, block(section%loaded))
    call fill_others(section, block)
    call lay_columns(section, block, top)
    call check_size(section, block, (size(top, 2) - 1)/2, error)
    call claim_lattice(section, block, (size(top, 2) - 1)/2, error)
    if (allocated(error)) return
    call fill_lattice(section, block, top, points, part)
    call make_grid(points, part, is_closed(section), section%grid, error)
    if (allocated(error)) then
      deallocate (error)
      call fail(error, code_input, 'rim (mm) = '//str(1000*(gear%root_radius - section%inner_radius))// &
                ': the rim below the root circle is too thin for a grid; must be thicker (or the bore smaller)')
    end if
  end subroutine make_section

  !> Each tooth has its own points, some 2 `across` by 3 `across`, and its columns in the grid.
  subroutine claim_teeth(options, error)
    type(section_options_t), intent(in) :: options
    type(error_t), allocatable, intent(inout) :: error
    integer :: across

    across = options%elements_across
    if (options%others_across > 0) across = options%others_across
    call claim_memory(options%teeth*(1000 + 16.0_dp*(2*across + 3)*(3*across + 12)) + 300.0_dp*options%elements_across**2, &
                      'teeth of the section = '//str(options%teeth), error)
  end subroutine claim_teeth

  !> Points of the lattice, and nodes and elements of the grid, which is copied with the section and the body.
  subroutine claim_lattice(section, block, columns, error)
    type(section_t), intent(in) :: section
    type(tooth_block_t), intent(in) :: block(:)
    integer, intent(in) :: columns
    type(error_t), allocatable, intent(inout) :: error
    real(dp), parameter :: lattice = 100, grid = 120
    real(dp) :: rim

    rim = max(1.0_dp, block(section%loaded)%across*rim_steps(section, block, section%inner_radius)/growth)
    call claim_memory(columns*((lattice + grid)*(rim + 1) + lattice*maxval(block%upper)) &
                      + grid*sum(real(block%across, dp)*block%upper), &
                      'elements across a tooth = '//str(section%options%elements_across)//': the grid', error)
  end subroutine claim_lattice

  !> The unloaded teeth are equal to the loaded one, or coarser.
  pure subroutine fill_others(section, block)
    type(section_t), intent(in) :: section
    type(tooth_block_t), intent(inout) :: block(:)
    type(tooth_block_t) :: other
    integer :: k

    other = block(section%loaded)
    if (section%options%others_across > 0) call make_tooth_block(section%gear, section%options%others_across, other)
    do k = 1, size(block)
      if (k /= section%loaded) block(k) = other
    end do
  end subroutine fill_others

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

  !> Inner radius, tooth axes and half angle.
  subroutine set_extent(section, error)
    type(section_t), intent(inout) :: section
    type(error_t), allocatable, intent(inout) :: error
    real(dp) :: pitch, least, most
    integer :: i

    associate (gear => section%gear, options => section%options)
      section%inner_radius = gear%root_radius - options%rim
      if (options%rim <= 0) section%inner_radius = gear%spec%bore_radius
      if (section%inner_radius <= 0) section%inner_radius = &
        max(gear%root_radius - 2.5_dp*(gear%tip_radius - gear%root_radius), gear%root_radius/10)
      pitch = 2*pi/gear%spec%teeth
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

  !> Angle from the tooth axis to where the tooth's block begins, with a little room.
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

  !> Points along the top of the rim at all column half steps, from left to right.
  subroutine lay_columns(section, block, top)
    type(section_t), intent(inout) :: section
    type(tooth_block_t), intent(in) :: block(:)
    real(dp), allocatable, intent(out) :: top(:, :)
    real(dp) :: pitch, from, to
    integer :: k, teeth

    teeth = section%options%teeth
    pitch = 2*pi/section%gear%spec%teeth
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
  end subroutine lay_columns

  !> Refuses a grid whose stiffness matrix would not fit, before it is made.
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

  !> Rows of the rim grow in proportion to the depth below the root, as the teeth's stress spreads, and
  !> shrink again with the radius towards a small bore. How far `radius` lies inwards, counted in
  !> such steps: the integral of dr over their length.
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

  !> The radius so many steps inwards.
  pure real(dp) function rim_radius(section, block, steps) result(radius)
    type(section_t), intent(in) :: section
    type(tooth_block_t), intent(in) :: block(:)
    real(dp), intent(in) :: steps
    real(dp) :: first, turn, outer

    first = block(section%loaded)%width/growth
    turn = turning_radius(section, first)
    outer = rim_steps(section, block, turn)
    radius = section%gear%root_radius - first*(exp(min(steps, outer)) - 1)
    if (steps > outer) radius = turn*exp(outer - steps)
  end function rim_radius

  !> Where the depth, and the first step beyond it, equal the radius.
  pure real(dp) function turning_radius(section, first) result(radius)
    type(section_t), intent(in) :: section
    real(dp), intent(in) :: first

    radius = min(section%gear%root_radius, (section%gear%root_radius + first)/2)
  end function turning_radius

  !> Rim below, teeth above.
  subroutine fill_lattice(section, block, top, points, part)
    type(section_t), intent(inout) :: section
    type(tooth_block_t), intent(in) :: block(:)
    real(dp), intent(in) :: top(:, 0:)
    real(dp), allocatable, intent(out) :: points(:, :, :)
    integer, allocatable, intent(out) :: part(:, :)
    real(dp) :: reach, share, radius
    integer :: i, j, k, c, rows, rim, columns

    columns = ubound(top, 2)/2
    reach = rim_steps(section, block, section%inner_radius)
    rim = max(1, nint(block(section%loaded)%across*reach/growth))
    section%rim_rows = rim
    rows = rim + maxval(block%upper)
    allocate (points(2, 0:2*columns, 0:2*rows), source=0.0_dp)
    allocate (part(columns, rows), source=no_element)
    part(:, :rim) = 0
    do j = 0, 2*rim
      share = (section%gear%root_radius - rim_radius(section, block, reach*(2*rim - j)/(2.0_dp*rim))) &
              /(section%gear%root_radius - section%inner_radius)
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

  !> Lattice column line that is a flank of tooth `k`.
  pure integer function flank_line(section, k, side) result(line)
    class(section_t), intent(in) :: section
    integer, intent(in) :: k, side

    line = 2*section%first_column(k)
    if (side == drive) line = line + 2*section%across(k)
  end function flank_line

  !> Nodes along one side of tooth `k`, from the middle of the next space, or the
  !> cut, up to the tip.
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

  !> Which nodes the supports hold.
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
end module gearsweep_section
