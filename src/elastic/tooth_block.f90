!> One tooth above its fillets' 60 degree points, as a block of a mapped grid.
module gearsweep_elastic_tooth_block
  use gearsweep_base, only: dp, pi
  use gearsweep_gear, only: coast, drive, fillet_parameter, fillet_point, gear_t, involute_point
  use gearsweep_elastic_q8, only: edge_functions, edge_slopes
  implicit none
  private
  public :: tooth_block_t, make_tooth_block, turned, fillet_excess

  !> Start of the block: angle of the fillet's tangent to the tooth axis, rad.
  real(dp), parameter, public :: split_angle = pi/3

  type :: tooth_block_t
    integer :: across = 0                        !< elements across the tooth
    integer :: upper = 0                         !< number of rows
    integer :: fillet = 0                        !< rows that belong to the fillets
    integer :: lower = 0                         !< columns along each fillet below the block
    real(dp) :: width = 0                        !< width at the start of the block, m
    real(dp) :: split(2) = 0                     !< fillet parameter there, drive and coast
    real(dp), allocatable :: bottom(:, :)        !< lower edge (2, 0:2 across)
    real(dp), allocatable :: points(:, :, :)     !< (2, 0:2 across, 0:2 upper), m
  end type tooth_block_t

  !> Fraction by which the steps across the tooth shrink towards the flanks.
  real(dp), parameter :: side_grading = 0.3_dp
  !> Lower limit and exponent of the shrinking of the steps along the involute towards the tip, with the tooth's thickness.
  real(dp), parameter :: least_taper = 0.15_dp, tapering = 0.7_dp
  !> Sag of the lower edge, which makes three equal angles at the fillets.
  real(dp), parameter :: sag = 0.17_dp

contains

  !> Builds the lattice of a tooth with `across` elements across, its axis along y.
  pure subroutine make_tooth_block(gear, across, block)
    type(gear_t), intent(in) :: gear
    integer, intent(in) :: across
    type(tooth_block_t), intent(out) :: block
    real(dp), allocatable :: left(:, :), right(:, :), up(:), share(:), top(:, :)
    real(dp) :: point(2)
    integer :: side, i

    block%across = across
    block%fillet = fillet_rows(across)
    block%lower = lower_columns(across)
    block%upper = block%fillet + max(2, across)
    do side = drive, coast
      block%split(side) = fillet_parameter(gear, side, split_angle)
      point = fillet_point(gear, side, block%split(side))
      block%width = block%width + abs(point(1))
    end do
    right = flank(gear, block, drive)
    left = flank(gear, block, coast)
    left(1, :) = -left(1, :)
    ! Positions across the tooth, 0 to 1, finer at both flanks.
    share = [(real(i, dp)/across - 1, i=0, 2*across)]
    share = ((1 - side_grading)*share + side_grading*sin(pi/2*share) + 1)/2
    ! Relative length along a flank.
    allocate (up(size(right, 2)), source=0.0_dp)
    do i = 2, size(up)
      up(i) = up(i - 1) + norm2(right(:, i) - right(:, i - 1))
    end do
    up = up/up(size(up))
    block%bottom = lower_edge(left(:, 1), right(:, 1), share)
    top = upper_edge(left(:, size(left, 2)), right(:, size(right, 2)), share)
    call transfinite(left, right, block%bottom, top, share, up, block%points)
  end subroutine make_tooth_block

  pure integer function fillet_rows(across)
    integer, intent(in) :: across

    fillet_rows = max(3, nint(0.5_dp*across))
  end function fillet_rows

  pure integer function lower_columns(across)
    integer, intent(in) :: across

    lower_columns = max(2, nint(0.25_dp*across))
  end function lower_columns

  !> Excess area (m2) of a tooth of the grid over the gear's, with `across` elements across, as its elements follow the fillets by
  !> parabolas. Grids of few elements have the same number of them along a fillet, so that their results do not show this error,
  !> the largest of the outline for undercut teeth.
  pure real(dp) function fillet_excess(gear, across) result(excess)
    type(gear_t), intent(in) :: gear
    integer, intent(in) :: across
    real(dp) :: split
    integer :: side

    excess = 0
    do side = drive, coast
      split = fillet_parameter(gear, side, split_angle)
      excess = excess + excess_along(gear, side, [pi/2, split], lower_columns(across)) &
               + excess_along(gear, side, [split, gear%fillet_start(side)], fillet_rows(across))
    end do
  end function fillet_excess

  !> Excess area along a fillet between two of its parameters, upwards, in this many elements of equal steps of the parameter: the
  !> integral of the distance over their edges, by the midpoint rule.
  pure real(dp) function excess_along(gear, side, between, elements) result(excess)
    type(gear_t), intent(in) :: gear
    integer, intent(in) :: side, elements
    real(dp), intent(in) :: between(2)
    integer, parameter :: points = 16
    real(dp) :: edge(2, 3), beyond(2), along(2), t
    integer :: e, i

    excess = 0
    do e = 1, elements
      do i = 1, 3
        edge(:, i) = at(i - 2.0_dp)
      end do
      do i = 1, points
        t = (2*i - 1.0_dp)/points - 1
        beyond = matmul(edge, edge_functions(t)) - at(t)
        along = matmul(edge, edge_slopes(t))*2/points
        excess = excess + beyond(1)*along(2) - beyond(2)*along(1)
      end do
    end do

  contains

    !> Point of the fillet at a place of the element's edge, -1 to 1.
    pure function at(place) result(point)
      real(dp), intent(in) :: place
      real(dp) :: point(2)

      point = fillet_point(gear, side, between(1) + (between(2) - between(1))*(e - 0.5_dp + place/2)/elements)
    end function at
  end function excess_along

  !> Points of one side from the start of the block to the tip (2, 1 + 2 upper), on positive x: fillet in equal steps of its
  !> parameter, involute in shrinking lengths.
  pure function flank(gear, block, side) result(points)
    type(gear_t), intent(in) :: gear
    type(tooth_block_t), intent(in) :: block
    integer, intent(in) :: side
    real(dp) :: points(2, 2*block%upper + 1)
    real(dp) :: share, radius, taper
    integer :: i, n, m

    n = 2*block%fillet
    m = 2*(block%upper - block%fillet)
    do i = 0, n - 1
      share = real(i, dp)/n
      points(:, i + 1) = fillet_point(gear, side, &
        (1 - share)*block%split(side) + share*gear%fillet_start(side))
    end do
    taper = max(least_taper, min(0.99_dp, (gear%thickness(gear%tip_radius)/block%width)**tapering))
    do i = 0, m
      share = (1 - taper**(real(i, dp)/m))/(1 - taper)
      radius = sqrt((1 - share)*gear%form_radius(side)**2 + share*gear%tip_radius**2)
      points(:, n + 1 + i) = involute_point(gear, side, radius)
    end do
  end function flank

  !> Cubic that leaves both ends inwards.
  pure function lower_edge(left, right, share) result(edge)
    real(dp), intent(in) :: left(2), right(2), share(0:)
    real(dp) :: edge(2, 0:ubound(share, 1))
    real(dp) :: inward(2)
    integer :: i

    inward = [right(2) - left(2), left(1) - right(1)]
    do i = 0, ubound(share, 1)
      associate (u => share(i))
        edge(:, i) = (1 - u)*left + u*right + 3*sag*u*(1 - u)*inward
      end associate
    end do
  end function lower_edge

  !> Points of the tip circle between the two flanks.
  pure function upper_edge(left, right, share) result(edge)
    real(dp), intent(in) :: left(2), right(2), share(0:)
    real(dp) :: edge(2, 0:ubound(share, 1))
    real(dp) :: angle(0:ubound(share, 1))

    angle = (1 - share)*atan2(left(1), left(2)) + share*atan2(right(1), right(2))
    edge(1, :) = norm2(right)*sin(angle)
    edge(2, :) = norm2(right)*cos(angle)
    edge(:, 0) = left
    edge(:, ubound(edge, 2)) = right
  end function upper_edge

  !> Blends the four edges (Coons).
  pure subroutine transfinite(left, right, bottom, top, share, up, points)
    real(dp), intent(in) :: left(:, 0:), right(:, 0:), bottom(:, 0:), top(:, 0:), share(0:), up(0:)
    real(dp), allocatable, intent(out) :: points(:, :, :)
    integer :: i, j, n, m

    n = ubound(share, 1)
    m = ubound(up, 1)
    allocate (points(2, 0:n, 0:m))
    do j = 0, m
      do i = 0, n
        associate (u => share(i), v => up(j))
          points(:, i, j) = (1 - u)*left(:, j) + u*right(:, j) &
            + (1 - v)*(bottom(:, i) - (1 - u)*left(:, 0) - u*right(:, 0)) &
            + v*(top(:, i) - (1 - u)*left(:, m) - u*right(:, m))
        end associate
      end do
    end do
    points(:, 0, :) = left
    points(:, n, :) = right
  end subroutine transfinite

  !> Points (2, n) turned towards positive x by an angle (rad).
  pure function turned(points, angle) result(moved)
    real(dp), intent(in) :: points(:, :), angle
    real(dp) :: moved(2, size(points, 2))

    moved(1, :) = points(1, :)*cos(angle) + points(2, :)*sin(angle)
    moved(2, :) = points(2, :)*cos(angle) - points(1, :)*sin(angle)
  end function turned
end module gearsweep_elastic_tooth_block
