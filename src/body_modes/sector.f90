!> Sector of an extruded gear as a grid of twenty-node bricks: one tooth with its part of the body.
!>
!> The grid reaches from the bore to the tip and from the middle plane to one face. Repeated by rotations through the pitch angle it
!> makes the gear, and its mirror image in the middle plane the other half. The brick is of the serendipity family: its bottom and
!> its top are the eight nodes of gearsweep_elastic_q8 each, corners first, then midsides; then come four nodes halfway between the
!> corners.
module gearsweep_body_modes_sector
  use gearsweep_base, only: claim_memory, code_input, dp, error_t, fail, pi, str
  use gearsweep_gear, only: coast, drive, gear_t, root_angle
  use gearsweep_elastic, only: append, fillet_run, gauss_place, gauss_weight, grid_t, make_grid, make_tooth_block, no_element, &
    tooth_block_t
  implicit none
  private
  public :: brick_matrices, gear_blank_t, sector_t, make_gear_sector, extrude

  integer, parameter, public :: brick_nodes = 20

  !> Local coordinates of the nodes.
  real(dp), parameter, public :: brick_node(3, brick_nodes) = reshape(real([ &
    -1, -1, -1, 1, -1, -1, 1, 1, -1, -1, 1, -1, 0, -1, -1, 1, 0, -1, 0, 1, -1, -1, 0, -1, &
    -1, -1, 1, 1, -1, 1, 1, 1, 1, -1, 1, 1, 0, -1, 1, 1, 0, 1, 0, 1, 1, -1, 0, 1, &
    -1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0], dp), [3, brick_nodes])

  !> Gear body below the teeth. With a web, rim and hub are as wide as the teeth.
  type :: gear_blank_t
    real(dp) :: web = 0                          !< width of the web, m; 0: the body is as wide as the teeth
    real(dp) :: rim = 0                          !< thickness of the rim below the root circle, m
    real(dp) :: hub_radius = 0                   !< outer radius of the hub, m; 0: the web reaches the bore
  end type gear_blank_t

  !> Near and far are the two cuts: far is near rotated by the pitch angle, anticlockwise as seen from the front.
  type :: sector_t
    integer :: sectors = 0                       !< number of sectors of the complete gear
    type(grid_t) :: plane                        !< grid of its outline: x to the right, y up, seen from the front
    real(dp), allocatable :: x(:, :)             !< nodes, m (3, nodes); z is 0 in the middle plane
    integer, allocatable :: element(:, :)        !< nodes of each brick, in the order above (20, elements)
    integer, allocatable :: near(:), far(:)      !< nodes in the cuts, in the same order
    integer, allocatable :: front(:)             !< nodes on the front, for each node of `plane`
    logical, allocatable :: in_bore(:), in_middle(:)  !< flags of the nodes
  end type sector_t

  !> Ratio of the row length to the size that it follows, over the number of elements across a tooth.
  real(dp), parameter :: growth = 1.6_dp

contains

  !> Shape functions and their derivatives by the local coordinates (20, 3) at `p` in [-1, 1]^3 (Zienkiewicz, Taylor, Zhu 2013, The
  !> finite element method, section 6.2).
  pure subroutine brick_functions(p, f, d)
    real(dp), intent(in) :: p(3)
    real(dp), intent(out) :: f(brick_nodes), d(brick_nodes, 3)
    real(dp) :: factor(3), slope(3), total
    integer :: k, i

    do k = 1, brick_nodes
      associate (at => brick_node(:, k))
        do i = 1, 3
          if (abs(at(i)) > 0) then
            factor(i) = (1 + at(i)*p(i))/2
            slope(i) = at(i)/2
          else
            factor(i) = 1 - p(i)**2
            slope(i) = -2*p(i)
          end if
        end do
        f(k) = product(factor)
        d(k, :) = [slope(1)*factor(2)*factor(3), factor(1)*slope(2)*factor(3), factor(1)*factor(2)*slope(3)]
        if (all(abs(at) > 0)) then
          total = dot_product(at, p) - 2
          d(k, :) = d(k, :)*total + f(k)*at
          f(k) = f(k)*total
        end if
      end associate
    end do
  end subroutine brick_functions

  !> Stiffness (N/m) and consistent mass (kg) of an element.
  !>
  !> `x(3, 20)`: its nodes, m. `lame(2)`: lambda and the shear modulus, Pa. `density` in kg/m^3. `k(60, 60)`: unknowns
  !> u1 v1 w1 u2 ...; `m(20, 20)`: the same for each direction. Three Gauss points each way.
  pure subroutine brick_matrices(x, lame, density, k, m)
    real(dp), intent(in) :: x(3, brick_nodes), lame(2), density
    real(dp), intent(out) :: k(3*brick_nodes, 3*brick_nodes), m(brick_nodes, brick_nodes)
    real(dp) :: products(brick_nodes, brick_nodes, 3, 3), g(brick_nodes, 3), f(brick_nodes), d(brick_nodes, 3), weight, det
    real(dp) :: inverse(3, 3)
    integer :: a, b, c, i, j, n

    products = 0
    m = 0
    do c = 1, 3
      do b = 1, 3
        do a = 1, 3
          call brick_functions([gauss_place(a), gauss_place(b), gauss_place(c)], f, d)
          call invert(matmul(x, d), inverse, det)
          g = matmul(d, inverse)
          weight = det*gauss_weight(a)*gauss_weight(b)*gauss_weight(c)
          do n = 1, brick_nodes
            m(:, n) = m(:, n) + f*(density*weight*f(n))
            do j = 1, 3
              do i = 1, j
                products(:, n, i, j) = products(:, n, i, j) + g(:, i)*(weight*g(n, j))
              end do
            end do
          end do
        end do
      end do
    end do
    do j = 1, 3
      do i = 1, j
        if (i < j) products(:, :, j, i) = transpose(products(:, :, i, j))
      end do
    end do
    do j = 1, 3
      do i = 1, 3
        k(i::3, j::3) = lame(1)*products(:, :, i, j) + lame(2)*products(:, :, j, i)
        if (i == j) k(i::3, j::3) = k(i::3, j::3) &
                                    + lame(2)*(products(:, :, 1, 1) + products(:, :, 2, 2) + products(:, :, 3, 3))
      end do
    end do
  end subroutine brick_matrices

  !> Inverts a three by three matrix; returns its determinant too.
  pure subroutine invert(a, inverse, det)
    real(dp), intent(in) :: a(3, 3)
    real(dp), intent(out) :: inverse(3, 3), det
    integer :: i, j, i1, i2, j1, j2

    do j = 1, 3
      j1 = 1 + mod(j, 3)
      j2 = 1 + mod(j + 1, 3)
      do i = 1, 3
        i1 = 1 + mod(i, 3)
        i2 = 1 + mod(i + 1, 3)
        inverse(j, i) = a(i1, j1)*a(i2, j2) - a(i1, j2)*a(i2, j1)
      end do
    end do
    det = dot_product(a(1, :), inverse(:, 1))
    inverse = inverse/det
  end subroutine invert

  !> Builds the sector of a gear with a bore.
  !>
  !> `across`: elements across a tooth; the other sizes follow from it. `error`: code 2 if the gear has no bore, or web, rim and hub
  !> do not fit.
  subroutine make_gear_sector(gear, blank, across, sector, error)
    type(gear_t), intent(in) :: gear
    type(gear_blank_t), intent(in) :: blank
    integer, intent(in) :: across
    type(sector_t), intent(out) :: sector
    type(error_t), allocatable, intent(inout) :: error
    type(tooth_block_t) :: block
    type(error_t), allocatable :: folded
    real(dp), allocatable :: top(:, :), radius(:), points(:, :, :), level(:)
    integer, allocatable :: part(:, :), row_layers(:), layers(:)
    integer :: first, n, i
    real(dp) :: middle, half

    call check_blank(gear, blank, error)
    if (allocated(error)) return
    call make_tooth_block(gear, across, block)
    ! Points along the root from cut to cut, at all half steps of the columns.
    half = pi/gear%spec%teeth
    ! The cuts lie in the middle of the root lands, which unequal flanks shift.
    middle = (root_angle(gear, drive) - root_angle(gear, coast))/2
    allocate (top(2, 0))
    call append(top, fillet_run(gear, block, coast, 0.0_dp, middle - half))
    first = (size(top, 2) - 1)/2
    call append(top, block%bottom)
    call append(top, fillet_run(gear, block, drive, 0.0_dp, middle + half))
    call place_rows(gear, blank, across, block%width, radius, row_layers)
    call fill_lattice(gear, blank, block, top, first, radius, points, part)
    call make_grid(points, part, .false., sector%plane, folded)
    if (allocated(folded)) then
      call fail(error, code_input, trim(gear%spec%name)//trim(merge(' rim thickness (mm):', ' bore diameter (mm):', &
                blank%web > 0))//' leaves a rim of '//str(1e3_dp*rim_of(gear, blank))// &
                ' mm below the root circle, too thin for a grid')
      return
    end if
    ! Heights of all half steps of the layers: up to half the web, then up to half the face width.
    n = max(1, nint(across/2.0_dp))
    associate (face => gear%spec%face_width/2)
      if (blank%web > 0) then
        level = [0.0_dp, blank%web/2*graded(n, n, [.false., .true.]), &
                 blank%web/2 + (face - blank%web/2)*graded(n, n, [.true., .false.])]
      else
        level = [(face*i/(2*n), i=0, 2*n)]
      end if
    end associate
    ! Half of the layers in the web.
    row_layers = [row_layers, spread(2, 1, block%upper)]
    layers = pack(spread(merge(size(level)/2/2, size(level)/2, row_layers == 1), 1, size(part, 1)), part /= no_element)
    sector%sectors = gear%spec%teeth
    call extrude(sector, level, layers)
  end subroutine make_gear_sector

  subroutine check_blank(gear, blank, error)
    type(gear_t), intent(in) :: gear
    type(gear_blank_t), intent(in) :: blank
    type(error_t), allocatable, intent(inout) :: error
    real(dp) :: inner

    if (.not. gear%spec%bore_radius > 0) call fail(error, code_input, trim(gear%spec%name)// &
      ' bore diameter (mm) = 0: must be above 0, as a sector of the body cannot end in a point')
    if (blank%hub_radius > 0 .and. .not. blank%web > 0) call fail(error, code_input, 'hub diameter (mm) = '// &
      str(2e3_dp*blank%hub_radius)//': there is no web around a hub; needs a web')
    if (.not. blank%web > 0) return
    inner = max(gear%spec%bore_radius, blank%hub_radius)
    if (.not. blank%web < gear%spec%face_width) call fail(error, code_input, trim(gear%spec%name)// &
      ' web thickness (mm) = '//str(1e3_dp*blank%web)// &
      ': must be below the face width '//str(1e3_dp*gear%spec%face_width)//' mm')
    if (blank%hub_radius > 0 .and. blank%hub_radius <= gear%spec%bore_radius) call fail(error, code_input, &
      'hub diameter (mm) = '//str(2e3_dp*blank%hub_radius)//': must be above the bore '// &
      str(2e3_dp*gear%spec%bore_radius)//' mm')
    if (.not. (blank%rim > 0 .and. blank%rim < gear%root_radius - inner)) call fail(error, code_input, &
      trim(gear%spec%name)//' rim thickness (mm) = '//str(1e3_dp*blank%rim)//': must be above 0 and below '// &
      str(1e3_dp*(gear%root_radius - inner))//', which the root circle leaves to the hub or bore')
  end subroutine check_blank

  !> Rim thickness; without a web the rim extends to the bore.
  pure real(dp) function rim_of(gear, blank)
    type(gear_t), intent(in) :: gear
    type(gear_blank_t), intent(in) :: blank

    rim_of = gear%root_radius - gear%spec%bore_radius
    if (blank%web > 0) rim_of = blank%rim
  end function rim_of

  !> Places the radii of all half steps of the rows below the root (0:), from the bore up, and the layers of each row: 1 for those
  !> of the web, 2 for those that are as wide as the teeth. A body with a web is graded towards the corners between the two, and a
  !> web that reaches the bore also towards the bore, where it is clamped.
  pure subroutine place_rows(gear, blank, across, width, radius, row_layers)
    type(gear_t), intent(in) :: gear
    type(gear_blank_t), intent(in) :: blank
    integer, intent(in) :: across
    real(dp), intent(in) :: width
    real(dp), allocatable, intent(out) :: radius(:)
    integer, allocatable, intent(out) :: row_layers(:)
    real(dp), allocatable :: bound(:), share(:)
    logical :: is_sharp(2)
    integer :: k, rows, i

    bound = [gear%spec%bore_radius]
    if (blank%web > 0 .and. blank%hub_radius > 0) bound = [bound, blank%hub_radius]
    if (blank%web > 0) bound = [bound, gear%root_radius - blank%rim]
    bound = [bound, gear%root_radius]
    radius = bound(:1)
    row_layers = [integer ::]
    do k = 1, size(bound) - 1
      associate (from => steps(bound(k)), to => steps(bound(k + 1)))
        is_sharp = blank%web > 0 .and. [k > 1 .or. size(bound) == 3, k < size(bound) - 1]
        rows = max(1, nint(across/growth*(to - from)))
        ! The added rows keep those in the middle from growing.
        rows = min(2*rows, rows + count(is_sharp)*across/2)
        share = graded(rows, across, is_sharp)
        radius = [radius, [(place(from + (to - from)*share(i)), i=1, 2*rows)]]
      end associate
      row_layers = [row_layers, spread(merge(1, 2, blank%web > 0 .and. k == size(bound) - 2), 1, rows)]
    end do
    radius(size(radius)) = gear%root_radius

  contains

    !> Number of rows up to a radius: the integral of dr over the row length, which follows the depth below the root, as the field
    !> of the teeth spreads, or the radius if that is less.
    pure real(dp) function steps(r)
      real(dp), intent(in) :: r
      real(dp) :: turn

      turn = turning()
      steps = log(min(r, turn)/turn)
      if (r > turn) steps = log(turn/(gear%root_radius - r + width/growth))
    end function steps

    !> Radius with that number of rows.
    pure real(dp) function place(count)
      real(dp), intent(in) :: count

      place = turning()*exp(count)
      if (count > 0) place = gear%root_radius + width/growth - turning()*exp(-count)
    end function place

    !> Radius equal to the depth.
    pure real(dp) function turning()
      turning = (gear%root_radius + width/growth)/2
    end function turning
  end subroutine place_rows

  !> Ends of all half steps of `steps` elements, from 0 (omitted) to 1. Towards ends with a sharp corner between web and rim or hub,
  !> where the field is singular, the last `most` of them shrink with the square of the distance.
  pure function graded(steps, most, is_sharp) result(share)
    integer, intent(in) :: steps, most
    logical, intent(in) :: is_sharp(2)           ! at 0 and at 1
    real(dp) :: share(2*steps)
    real(dp) :: end(0:steps), shrinking(2)
    integer :: i

    shrinking = merge(min(real(most, dp), real(steps, dp)/max(1, count(is_sharp))), 0.0_dp, is_sharp)
    do i = 0, steps
      associate (moved => max(0.0_dp, shrinking - [i, steps - i])**2/(2*max(1.0_dp, shrinking)))
        end(i) = i + moved(1) - moved(2)
      end associate
    end do
    end = (end - end(0))/(end(steps) - end(0))
    share(2::2) = end(1:)
    share(1::2) = (end(:steps - 1) + end(1:))/2
  end function graded

  !> Places the lattice: body below, tooth above, as in gearsweep_elastic_section: column lines are radial below the root, and even
  !> out to circles at the rim's inner radius.
  pure subroutine fill_lattice(gear, blank, block, top, first, radius, points, part)
    type(gear_t), intent(in) :: gear
    type(gear_blank_t), intent(in) :: blank
    type(tooth_block_t), intent(in) :: block
    real(dp), intent(in) :: top(:, 0:), radius(0:)
    integer, intent(in) :: first
    real(dp), allocatable, intent(out) :: points(:, :, :)
    integer, allocatable, intent(out) :: part(:, :)
    real(dp) :: inner, share, here
    integer :: columns, rows, i, j

    columns = ubound(top, 2)/2
    rows = ubound(radius, 1)/2
    inner = gear%root_radius - rim_of(gear, blank)
    allocate (points(2, 0:2*columns, 0:2*(rows + block%upper)), source=0.0_dp)
    allocate (part(columns, rows + block%upper), source=no_element)
    part(:, :rows) = 0
    part(first + 1:first + block%across, rows + 1:) = 1
    do j = 0, 2*rows
      share = max(0.0_dp, radius(j) - inner)/(gear%root_radius - inner)
      do i = 0, 2*columns
        here = norm2(top(:, i))
        points(:, i, j) = top(:, i)/here*(min(radius(j), inner) + (here - inner)*share)
      end do
    end do
    do j = 1, 2*block%upper
      points(:, 2*first:2*(first + block%across), 2*rows + j) = block%points(:, :, j)
    end do
  end subroutine fill_lattice

  !> Builds bricks on the elements of the plane: `layers(elements)` of them on each, between the heights `level(0:)` of all half
  !> steps.
  pure subroutine extrude(sector, level, layers)
    type(sector_t), intent(inout) :: sector
    real(dp), intent(in) :: level(0:)
    integer, intent(in) :: layers(:)
    integer, allocatable :: node(:, :), high(:)
    logical, allocatable :: is_corner(:)
    integer :: flat, e, k, n, p, j

    associate (plane => sector%plane)
      flat = size(plane%x, 2)
      allocate (high(flat), source=0)
      allocate (is_corner(flat), source=.false.)
      do e = 1, size(layers)
        high(plane%element(:, e)) = max(high(plane%element(:, e)), layers(e))
        is_corner(plane%element(:4, e)) = .true.
      end do
      allocate (node(0:ubound(level, 1), flat), source=0)
      n = 0
      do p = 1, flat
        do j = 0, 2*high(p), merge(1, 2, is_corner(p))
          n = n + 1
          node(j, p) = n
        end do
      end do
      allocate (sector%x(3, n), sector%element(brick_nodes, sum(layers)), sector%front(flat))
      allocate (sector%in_bore(n), sector%in_middle(n), source=.false.)
      do p = 1, flat
        do j = 0, 2*high(p)
          if (node(j, p) > 0) sector%x(:, node(j, p)) = [plane%x(:, p), level(j)]
        end do
        sector%in_middle(node(0, p)) = .true.
        sector%front(p) = node(2*high(p), p)
      end do
      n = 0
      do e = 1, size(layers)
        do k = 0, 2*layers(e) - 2, 2
          n = n + 1
          sector%element(:, n) = [node(k, plane%element(:, e)), node(k + 2, plane%element(:, e)), &
                                  node(k + 1, plane%element(:4, e))]
        end do
      end do
      sector%near = all_levels(plane%column_nodes(ubound(plane%node, 1)))
      sector%far = all_levels(plane%column_nodes(0))
      sector%in_bore(all_levels(plane%row_nodes(0))) = .true.
    end associate

  contains

    !> Nodes above those of a list in the plane, these included.
    pure function all_levels(list) result(nodes)
      integer, intent(in) :: list(:)
      integer, allocatable :: nodes(:)

      nodes = pack(node(:, list), node(:, list) > 0)
    end function all_levels
  end subroutine extrude
end module gearsweep_body_modes_sector
