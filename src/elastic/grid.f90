!> Mapped grids of eight-node quadrilaterals, from a lattice of points.
!>
!> Columns count along the body, rows across it; the lattice has a point at each half step, so that element (c, r) has its corners
!> at (2c-2, 2r-2) ... (2c, 2r) and the midside nodes between. Not every place needs an element: a gear section has rows above the
!> rim only in its teeth.
module gearsweep_elastic_grid
  use gearsweep_base, only: code_numerical, dp, error_t, fail, str
  use gearsweep_elastic_q8, only: gauss_place, gauss_weight, jacobian, nodes_per_element, shape_functions
  implicit none
  private
  public :: grid_t, make_grid

  integer, parameter, public :: no_element = -1

  type :: grid_t
    real(dp), allocatable :: x(:, :)             !< node positions, m (2, nodes)
    integer, allocatable :: element(:, :)        !< corners, then midsides, anticlockwise (8, elements)
    integer, allocatable :: part(:)              !< tooth that each element belongs to, 0 for the rim
    integer, allocatable :: node(:, :)           !< node at a lattice point, or 0 (0:2 columns, 0:2 rows)
    logical :: closed = .false.                  !< the last column line is the first
  contains
    procedure :: column_nodes
    procedure :: row_nodes
    procedure :: quality
    procedure :: find
    procedure :: area
  end type grid_t

contains

  !> Numbers the nodes of a lattice and checks its elements.
  !>
  !> `points(2, 0:2*columns, 0:2*rows)` in m; `part(columns, rows)` is `no_element` or the part of each element. A `closed`
  !> lattice repeats its first column line as its last.
  subroutine make_grid(points, part, closed, grid, error)
    real(dp), intent(in) :: points(:, 0:, 0:)
    integer, intent(in) :: part(:, :)
    logical, intent(in) :: closed
    type(grid_t), intent(out) :: grid
    type(error_t), allocatable, intent(out) :: error
    integer :: nodes, i, j, c, r, e, k
    integer, parameter :: di(8) = [0, 2, 2, 0, 1, 2, 1, 0], dj(8) = [0, 0, 2, 2, 0, 1, 2, 1]

    grid%closed = closed
    call number_nodes(part, closed, grid%node, nodes)
    allocate (grid%x(2, nodes))
    do j = ubound(grid%node, 2), 0, -1
      do i = ubound(grid%node, 1), 0, -1
        if (grid%node(i, j) > 0) grid%x(:, grid%node(i, j)) = points(:, i, j)
      end do
    end do
    allocate (grid%element(nodes_per_element, count(part /= no_element)))
    grid%part = pack(part, part /= no_element)
    e = 0
    do r = 1, size(part, 2)
      do c = 1, size(part, 1)
        if (part(c, r) == no_element) cycle
        e = e + 1
        do k = 1, nodes_per_element
          grid%element(k, e) = grid%node(2*c - 2 + di(k), 2*r - 2 + dj(k))
        end do
      end do
    end do
    if (.not. grid%quality() > 0) call fail(error, code_numerical, &
      'the grid is folded: smallest scaled Jacobian '//str(grid%quality()))
  end subroutine make_grid

  !> Numbers the nodes up the column lines, one line after the other. In a closed grid lines from both ends alternate, so that
  !> neighbours have close numbers.
  subroutine number_nodes(part, closed, node, nodes)
    integer, intent(in) :: part(:, :)
    logical, intent(in) :: closed
    integer, allocatable, intent(out) :: node(:, :)
    integer, intent(out) :: nodes
    integer :: columns, rows, lines, k, i, j

    columns = size(part, 1)
    rows = size(part, 2)
    lines = merge(2*columns, 2*columns + 1, closed)
    allocate (node(0:2*columns, 0:2*rows), source=0)
    nodes = 0
    do k = 1, lines
      i = k - 1
      if (closed) i = merge(k/2, lines - k/2, mod(k, 2) == 0 .or. k == 1)
      do j = 0, 2*rows
        if (mod(i, 2) == 1 .and. mod(j, 2) == 1) cycle
        if (.not. occupied(i, j)) cycle
        nodes = nodes + 1
        node(i, j) = nodes
      end do
    end do
    if (closed) node(2*columns, :) = node(0, :)

  contains

    !> True if an element touches this lattice point.
    pure logical function occupied(i, j)
      integer, intent(in) :: i, j
      integer :: c, r, cc

      occupied = .false.
      do c = (i + 1)/2, i/2 + 1
        cc = c
        if (closed .and. c == 0) cc = columns
        if (cc < 1 .or. cc > columns) cycle
        do r = max(1, (j + 1)/2), min(rows, j/2 + 1)
          if (part(cc, r) /= no_element) occupied = .true.
        end do
      end do
    end function occupied
  end subroutine number_nodes

  !> Nodes on lattice line `i` (0 to twice the columns), in ascending rows.
  pure function column_nodes(grid, i) result(list)
    class(grid_t), intent(in) :: grid
    integer, intent(in) :: i
    integer, allocatable :: list(:)

    list = pack(grid%node(i, :), grid%node(i, :) > 0)
  end function column_nodes

  !> Nodes on lattice row `j` (0 to twice the rows), in ascending columns.
  pure function row_nodes(grid, j) result(list)
    class(grid_t), intent(in) :: grid
    integer, intent(in) :: j
    integer, allocatable :: list(:)
    integer :: last

    last = ubound(grid%node, 1)
    if (grid%closed) last = last - 1
    list = pack(grid%node(:last, j), grid%node(:last, j) > 0)
  end function row_nodes

  !> Smallest Jacobian over all elements, scaled by each element's mean: 1 for
  !> parallelograms, not above 0 where an element is folded.
  pure real(dp) function quality(grid)
    class(grid_t), intent(in) :: grid
    real(dp), parameter :: place(3) = [-1.0_dp, 0.0_dp, 1.0_dp]
    real(dp) :: det(9), j(2, 2)
    integer :: e, a, b

    quality = huge(quality)
    do e = 1, size(grid%element, 2)
      do b = 1, 3
        do a = 1, 3
          j = jacobian(grid%x(:, grid%element(:, e)), [place(a), place(b)])
          det(3*(b - 1) + a) = j(1, 1)*j(2, 2) - j(1, 2)*j(2, 1)
        end do
      end do
      if (.not. sum(det) > 0) then
        quality = min(quality, -1.0_dp)
      else
        quality = min(quality, 9*minval(det)/sum(det))
      end if
    end do
  end function quality

  !> Finds the element that contains a point, and the local coordinates there; element 0 if there is none. Only elements of `part`
  !> are searched.
  pure subroutine find(grid, point, part, element, local)
    class(grid_t), intent(in) :: grid
    real(dp), intent(in) :: point(2)
    integer, intent(in) :: part
    integer, intent(out) :: element
    real(dp), intent(out) :: local(2)
    real(dp) :: corners(2, nodes_per_element), margin(2), slope(2, 2), gap(2), step(2)
    integer :: e, k

    do e = 1, size(grid%element, 2)
      if (grid%part(e) /= part) cycle
      corners = grid%x(:, grid%element(:, e))
      margin = 0.1_dp*(maxval(corners, 2) - minval(corners, 2))
      if (any(point < minval(corners, 2) - margin) .or. any(point > maxval(corners, 2) + margin)) cycle
      ! Newton iteration on the map of the element.
      local = 0
      do k = 1, 20
        gap = point - matmul(corners, shape_functions(local))
        slope = jacobian(corners, local)
        step = [slope(2, 2)*gap(1) - slope(1, 2)*gap(2), slope(1, 1)*gap(2) - slope(2, 1)*gap(1)] &
               /(slope(1, 1)*slope(2, 2) - slope(1, 2)*slope(2, 1))
        local = max(-2.0_dp, min(2.0_dp, local + step))
        if (maxval(abs(step)) < 1e-13_dp) exit
      end do
      element = e
      if (all(abs(local) <= 1 + 1e-6_dp)) return
    end do
    element = 0
    local = 0
  end subroutine find

  !> Area (m2) of the elements.
  pure real(dp) function area(grid)
    class(grid_t), intent(in) :: grid
    real(dp) :: j(2, 2)
    integer :: e, a, b

    area = 0
    do e = 1, size(grid%element, 2)
      do b = 1, 3
        do a = 1, 3
          j = jacobian(grid%x(:, grid%element(:, e)), [gauss_place(a), gauss_place(b)])
          area = area + gauss_weight(a)*gauss_weight(b)*(j(1, 1)*j(2, 2) - j(1, 2)*j(2, 1))
        end do
      end do
    end do
  end function area
end module gearsweep_elastic_grid
