!> Stiffness of a pair whose tip corner is in contact, outside A and E, and the contact of an edge with a flank.
!>
!> The tooth whose corner touches is loaded there along the normal of the mate's flank, the mate at the point of contact. The
!> finite elements of both bodies determine the deflection below the contact, and an edge on a cylinder the deflection above.
!>
!> The contact ends at an edge, so that neither Hertz's pressure nor his half plane holds for that tooth. The tooth is a wedge
!> between its flank and its tip land with a grid of its own, in steps that shrink towards the edge; the mate is a half plane in
!> closed form. The pressure is found cell by cell, so that both surfaces fit under pressure, and it is zero where they are apart.
module gearsweep_elastic_corner_stiffness
  use gearsweep_base, only: begin_products, claim_memory, code_numerical, dgesv, dp, end_products, error_t, fail, str
  use gearsweep_gear, only: corner_contact, corner_t, drive, pair_t
  use gearsweep_elastic_body, only: body_t, make_body
  use gearsweep_elastic_compliance, only: most_tilt, tooth_t
  use gearsweep_elastic_flattening, only: contact_half_width, surface_to_depth
  use gearsweep_elastic_grid, only: grid_t, make_grid
  use gearsweep_elastic_material, only: material_t
  use gearsweep_elastic_q8, only: nodes_per_element, shape_functions
  implicit none
  private
  public :: edge_t, make_edge, edge_compliance, edge_deflection, corner_compliance, compliance_slope, moved_contact, edge_zone

  !> Wedge, prepared for contacts at its edge. The edge is the origin; its face is the positive x axis, and the material is below,
  !> between the face and the angle.
  type :: edge_t
    type(material_t) :: mate                     !< material of the half plane
    logical :: plane_strain = .true.
    real(dp) :: depth = 0                        !< reference depth of the deflection, m
    real(dp), allocatable :: ends(:)             !< ends of the cells along the face, m; (0:cells)
    !> Mean displacement of a cell under a unit load on another, both along x or y (m2/N): (of, at, of cell, on cell).
    real(dp), allocatable :: influence(:, :, :, :)
    type(grid_t) :: grid
    !> Displacement of the nodes under a unit load on the edge, m2/N: (2, nodes, load along x or y).
    real(dp), allocatable :: apex(:, :, :)
  end type edge_t

  !> Grid: ratio of neighbouring steps along the face; rows over the angle; extent in depths; first step, in half widths of
  !> Hertz's contact.
  real(dp), parameter :: growth = 1.25_dp, farthest = 40, first_step = 1.2e-3_dp
  integer, parameter :: rows = 8
  !> Largest distance of contact from the edge, in half widths, and in depths.
  real(dp), parameter :: widest = 6, deepest = 0.8_dp

contains

  !> Prepares the wedge with the included `angle` (rad). Deflections refer to `depth` (m) and twice of it, along the line of the
  !> load through the edge, as gearsweep_elastic_compliance evaluates them on the tooth's own grid. `half_width` (m): that of
  !> Hertz's contact without the edge, which decides how fine the grid must be. `material`: of the wedge and of its mate.
  subroutine make_edge(material, plane_strain, angle, depth, half_width, edge, error)
    type(material_t), intent(in) :: material(2)
    logical, intent(in) :: plane_strain
    real(dp), intent(in) :: angle, depth, half_width
    type(edge_t), intent(out) :: edge
    type(error_t), allocatable, intent(out) :: error
    type(body_t) :: body
    real(dp), allocatable :: points(:, :, :), radius(:), x(:, :), u(:, :), share(:, :)
    integer, allocatable :: part(:, :)
    logical, allocatable :: held(:)
    real(dp) :: nearest, skew
    integer :: columns, cells, i, j, d

    edge%mate = material(2)
    edge%plane_strain = plane_strain
    edge%depth = depth
    nearest = first_step*min(half_width, depth)
    columns = ceiling(log(farthest*depth/nearest)/log(growth))
    radius = [(nearest*(farthest*depth/nearest)**(i/(2.0_dp*columns)), i=0, 2*columns)]
    allocate (points(2, 0:2*columns, 0:2*rows), part(columns, rows))
    part = 0
    do j = 0, 2*rows
      associate (direction => -angle*(1 - j/(2.0_dp*rows)))
        do i = 0, 2*columns
          points(:, i, j) = radius(i + 1)*[cos(direction), sin(direction)]
        end do
      end associate
    end do
    call make_grid(points, part, .false., edge%grid, error)
    if (allocated(error)) return
    allocate (held(size(edge%grid%x, 2)), source=.false.)
    held(edge%grid%column_nodes(2*columns)) = .true.
    call make_body(edge%grid, material(1), plane_strain, 1.0_dp, spread(held, 1, 2), 1e9_dp, body, error)
    if (allocated(error)) return
    cells = count(radius(3::2) <= min(widest*half_width, deepest*depth))
    edge%ends = radius(1:2*cells + 1:2)
    call claim_memory(24.0_dp*body%unknowns*(2*cells + 2), 'corner contact: the edge on '//str(body%unknowns)//' unknowns', &
                      error)
    if (allocated(error)) return
    allocate (x(body%unknowns, 2*cells + 2), share(3, cells))
    do i = 1, cells
      ! Weights of the nodes of a quadratic edge in the mean over its length.
      skew = (radius(2*i - 1) + radius(2*i + 1) - 2*radius(2*i))/(3*(radius(2*i + 1) - radius(2*i - 1)))
      share(:, i) = [1/6.0_dp - skew, 2/3.0_dp, 1/6.0_dp + skew]
      do d = 1, 2
        x(:, 2*(i - 1) + d) = body%gather(on_face(2*(i - 1), share(:, i), d))
      end do
    end do
    do d = 1, 2
      x(:, 2*cells + d) = body%gather(on_face(0, [1.0_dp, 0.0_dp, 0.0_dp], d))
    end do
    call body%stiffness%solve(x, error)
    if (allocated(error)) return
    allocate (edge%influence(2, 2, cells, cells), edge%apex(2, size(edge%grid%x, 2), 2))
    do i = 1, cells
      do d = 1, 2
        u = body%spread_out(x(:, 2*(i - 1) + d))
        do j = 1, cells
          edge%influence(:, d, j, i) = matmul(u(:, edge%grid%node(2*j - 2:2*j, 2*rows)), share(:, j))
        end do
      end do
    end do
    do d = 1, 2
      edge%apex(:, :, d) = body%spread_out(x(:, 2*cells + d))
    end do

  contains

    !> Nodal forces along x or y on the three nodes of the face from lattice line `line` on.
    function on_face(line, weights, direction) result(force)
      integer, intent(in) :: line, direction
      real(dp), intent(in) :: weights(3)
      real(dp) :: force(2, size(edge%grid%x, 2))

      force = 0
      force(direction, edge%grid%node(line:line + 2, 2*rows)) = weights
    end function on_face
  end subroutine make_edge

  !> Computes the compliance (m2/N) of edge and mate in contact under `line_load` (N/m): their approach over the load, minus the
  !> displacement of the tooth at its depth by a point load on the edge (twice that minus the one at twice the depth), and minus
  !> that of the mate at `mate_depth` (m).
  !>
  !> Without load the mate touches the edge, and its distance from the face at x is tilt x + curvature x**2/2: `tilt` (rad)
  !> between mate and face, `curvature` (1/m) of both together. The load acts along the mate's normal. Under pressure the surfaces
  !> fit: Johnson 1985, Contact Mechanics, section 5.9.
  !>
  !> The bodies deflect less by `fall` (m/N) per length of the load's distance from the edge: half of that turns the surfaces
  !> against each other, half reduces the deflection at the load (see `moved_contact` of gearsweep_elastic_corner_stiffness).
  subroutine edge_compliance(edge, line_load, tilt, curvature, fall, mate_depth, compliance, error)
    type(edge_t), intent(in) :: edge
    real(dp), intent(in) :: line_load, tilt, curvature, fall, mate_depth
    real(dp), intent(out) :: compliance
    type(error_t), allocatable, intent(inout) :: error
    real(dp), dimension(size(edge%ends) - 1) :: gap, pressure
    real(dp) :: matrix(size(gap), size(gap)), along(2), approach
    logical :: presses(size(gap)), solved
    integer :: i, j

    compliance = 0
    along = [sin(tilt), -cos(tilt)]
    associate (a => edge%ends(:size(gap)), b => edge%ends(2:))
      gap = (tilt - fall*line_load/2)*(a + b)/2 + curvature/6*(a**2 + a*b + b**2)
      do j = 1, size(gap)
        do i = 1, size(gap)
          matrix(i, j) = dot_product(along, matmul(edge%influence(:, :, i, j), along)) &
                         + surface_to_depth(edge%mate, edge%plane_strain, &
                                            2*exp(0.5_dp + mean_logarithm(a(i), b(i), a(j), b(j))), mate_depth)
        end do
      end do
    end associate
    presses = .true.
    do i = 1, size(gap)
      call press(matrix, gap, line_load, presses, pressure, approach, solved)
      if (.not. (solved .and. any(presses .and. pressure < 0))) exit
      presses = presses .and. pressure >= 0
    end do
    if (.not. (solved .and. any(presses))) then
      call fail(error, code_numerical, 'corner contact: the pressure at the tip corner is not found')
      return
    end if
    associate (middle => (edge%ends(:size(gap)) + edge%ends(2:))/2)
      compliance = approach/line_load - fall/2*sum(pressure*middle)/line_load
    end associate
    compliance = compliance - 2*edge_deflection(edge, edge%depth, tilt) + edge_deflection(edge, 2*edge%depth, tilt)
  end subroutine edge_compliance

  !> Mean of log |x - y| for x from a to b and y from c to d (m).
  elemental real(dp) function mean_logarithm(a, b, c, d) result(mean)
    real(dp), intent(in) :: a, b, c, d

    mean = (twice(b - c) + twice(a - d) - twice(a - c) - twice(b - d))/((b - a)*(d - c))

  contains

    !> Second integral of log |t|.
    pure real(dp) function twice(t)
      real(dp), intent(in) :: t

      twice = 0
      if (abs(t) > 0) twice = t**2*(log(abs(t))/2 - 0.75_dp)
    end function twice
  end function mean_logarithm

  !> Finds the loads (N/m) on the cells under pressure, with one approach (m) of the surfaces there and the line load as their
  !> sum.
  subroutine press(matrix, gap, line_load, presses, pressure, approach, solved)
    real(dp), intent(in) :: matrix(:, :), gap(:), line_load
    logical, intent(in) :: presses(:)
    real(dp), intent(out) :: pressure(:), approach
    logical, intent(out) :: solved
    real(dp), allocatable :: a(:, :), b(:)
    integer, allocatable :: list(:), pivot(:)
    integer :: n, i, info

    list = pack([(i, i=1, size(gap))], presses)
    n = size(list)
    allocate (a(n + 1, n + 1), b(n + 1), pivot(n + 1))
    a(:n, :n) = matrix(list, list)
    a(:n, n + 1) = -1
    a(n + 1, :n) = 1
    a(n + 1, n + 1) = 0
    b(:n) = -gap(list)
    b(n + 1) = line_load
    call begin_products()
    call dgesv(n + 1, 1, a, n + 1, pivot, b, n + 1, info)
    call end_products()
    solved = info == 0
    pressure = 0
    pressure(list) = b(:n)
    approach = b(n + 1)
  end subroutine press

  !> Displacement (m2/N) of the point at a `depth` (m) under a unit line load on the edge, both along the line with this `tilt`
  !> (rad) against the face's normal. Only its differences count, as the grid is held far from the edge.
  pure real(dp) function edge_deflection(edge, depth, tilt) result(moved)
    type(edge_t), intent(in) :: edge
    real(dp), intent(in) :: depth, tilt
    real(dp) :: along(2), local(2), share(nodes_per_element)
    integer :: element, d

    moved = 0
    along = [sin(tilt), -cos(tilt)]
    call edge%grid%find(depth*along, 0, element, local)
    if (element == 0) return
    share = shape_functions(local)
    do d = 1, 2
      moved = moved + along(d)*dot_product(along, matmul(edge%apex(:, edge%grid%element(:, element), d), share))
    end do
  end function edge_deflection

  !> Computes the compliance (m2/N) of the pair at the path coordinates `s` beyond A or E, all on one side, under each `line_load`
  !> (N/m; the largest first), the secant; (place, load). At A and E themselves the edge cuts the contact in half. The compliance
  !> is along the line of action: deflection and load along the mate's normal are divided and multiplied by `part_along`
  !> (corner_t).
  subroutine corner_compliance(pair, tooth, material, plane_strain, line_load, s, compliance, error)
    type(pair_t), intent(in) :: pair
    type(tooth_t), intent(in) :: tooth(2)
    type(material_t), intent(in) :: material(2)
    logical, intent(in) :: plane_strain
    real(dp), intent(in) :: line_load(:), s(:)
    real(dp), intent(out) :: compliance(:, :)
    type(error_t), allocatable, intent(out) :: error
    type(edge_t) :: edge
    type(corner_t) :: corner
    real(dp) :: tip, end_of_path, close_up, curvature(2)
    integer :: k, l, gear

    gear = merge(2, 1, sum(s) < 0)
    end_of_path = merge(0.0_dp, pair%contact_ratio, gear == 2)
    tip = pair%curvature(gear, end_of_path)
    compliance = 0
    call make_edge(material([gear, 3 - gear]), plane_strain, pair%gear(gear)%edge_angle(drive, tip), &
                   tooth(gear)%corner_depth, contact_half_width(material(1), material(2), plane_strain, line_load(1), tip, &
                   pair%curvature(3 - gear, end_of_path)), edge, error)
    do k = 1, size(s)
      corner = corner_contact(pair, s(k))
      curvature(gear) = tip
      curvature(3 - gear) = corner%curvature
      do l = 1, size(line_load)
        if (allocated(error)) return
        call edge_compliance(edge, line_load(l), corner%tilt, 1/tip + 1/corner%curvature, &
                             merge(-1, 1, gear == 2)*compliance_slope(pair, tooth, curvature), pair%gear(1)%spec%module, &
                             close_up, error)
        compliance(k, l) = tooth(gear)%corner%value(min(most_tilt, corner%tilt)) &
                           + tooth(3 - gear)%compliance%value(corner%curvature) + close_up
      end do
      compliance(k, :) = compliance(k, :)/corner%part_along**2
    end do
  end subroutine corner_compliance

  !> Change of the compliance of a pair without its flattening as the contact moves along the flanks towards the pinion's tip, per
  !> length of flank (m/N). `curvature` (m): radii of curvature of both drive flanks at the contact.
  pure real(dp) function compliance_slope(pair, tooth, curvature) result(slope)
    type(pair_t), intent(in) :: pair
    type(tooth_t), intent(in) :: tooth(2)
    real(dp), intent(in) :: curvature(2)
    integer :: i

    slope = 0
    do i = 1, 2
      ! The arc of an involute grows with the square of its radius of curvature.
      slope = slope + merge(1, -1, i == 1)*tooth(i)%compliance%slope(curvature(i))*pair%gear(i)%base_radius(drive)/curvature(i)
    end do
  end function compliance_slope

  !> Reduction of a pair's deflection (m2/N) under `line_load` (N/m), as its contact moves to where the teeth are stiffer.
  !>
  !> A load F at the place u of the flanks turns them against each other by F C'/2 there, with the slope C' of the compliance: by
  !> reciprocity half of it is due to the place of the load, half to the place of the displacement. Where the curvature 1/R of
  !> both flanks together compensates for that, they touch: u = -F C' R/2, and F C + u**2/(2 R) is less by 3/8 F**2 C'**2 R. F is
  !> the load of a pair near the path's ends, where C' is largest: 0.2 to 0.4 of the full load.
  pure real(dp) function moved_contact(line_load, slope, curvature) result(less)
    real(dp), intent(in) :: line_load
    real(dp), intent(in) :: slope                !< result of `compliance_slope`, m/N
    real(dp), intent(in) :: curvature(2)         !< radii of curvature of both flanks, m
    real(dp), parameter :: share = 0.3_dp

    less = 3*share*line_load*slope**2/(8*sum(1/curvature))
  end function moved_contact

  !> Distance from A and from E, in base pitches, within which a contact on the path is affected by the edge under `line_load`
  !> (N/m).
  pure function edge_zone(pair, material, plane_strain, line_load) result(zone)
    type(pair_t), intent(in) :: pair
    type(material_t), intent(in) :: material(2)
    logical, intent(in) :: plane_strain
    real(dp), intent(in) :: line_load
    real(dp) :: zone(2)
    !> Distance from the edge, in half widths of Hertz's contact, at which an edge on a cylinder and the same on a half plane
    !> nearly agree (suite elastic_corner).
    real(dp), parameter :: half_widths = 1.4_dp
    real(dp) :: tip, arc
    integer :: i

    do i = 1, 2
      associate (gear => 3 - i, s => merge(0.0_dp, pair%contact_ratio, i == 1))
        tip = pair%curvature(gear, s)
        arc = half_widths*contact_half_width(material(1), material(2), plane_strain, line_load, pair%curvature(1, s), &
                                             pair%curvature(2, s))
        ! The arc of an involute grows with the square of its radius of curvature.
        zone(i) = (tip - sqrt(max(0.0_dp, tip**2 - 2*pair%gear(gear)%base_radius(drive)*arc)))/pair%base_pitch
      end associate
    end do
    zone = min(zone, pair%contact_ratio/8)
  end function edge_zone
end module gearsweep_elastic_corner_stiffness
