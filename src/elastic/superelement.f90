!> Teeth of a complete gear beyond those of its grid, as a superelement between the two sides of the grid.
!>
!> These teeth are alike. Static condensation of one of them to its sides gives a stiffness that is the same for each in radial and
!> tangential displacements; two in a row, condensed to their outer sides, are one superelement of twice as many teeth
!> (Przemieniecki 1963, AIAA J. 1). Nothing is approximated, and the cost hardly grows with the number of teeth.
module gearsweep_elastic_superelement
  use gearsweep_base, only: claim_memory, code_numerical, dp, dposv, elements_t, error_t, factor_inner, fail, sparse_t
  use gearsweep_elastic_grid, only: grid_t
  use gearsweep_elastic_q8, only: element_mass, element_stiffness, nodes_per_element
  implicit none
  private
  public :: superelement_t, make_superelement, add_angular_momentum

  type :: superelement_t
    integer :: teeth = 0                         !< number of teeth; 0: none
    integer, allocatable :: node(:)              !< nodes of the grid's last side, then of its first, without those held
    real(dp), allocatable :: stiffness(:, :)     !< N/m; (2 x nodes, 2 x nodes)
    !> Weights of the displacements in the angular momentum about the origin, for unit density, m3; (2, node)
    real(dp), allocatable :: momentum(:, :)
    real(dp) :: inertia = 0                      !< moment of inertia for unit density and thickness, m4
  end type superelement_t

  !> Teeth in a row, condensed to their near and far side, in radial and tangential displacements; components as in
  !> `superelement_t`.
  type :: row_t
    real(dp), allocatable :: stiffness(:, :), momentum(:)
  end type row_t

contains

  !> Condenses the teeth between the last and the first side of a grid. `error`: memory is too small.
  subroutine make_superelement(grid, columns, teeth, law, held, product, error)
    type(grid_t), intent(in) :: grid             !< grid of adjacent teeth
    integer, intent(in) :: columns               !< columns of its first tooth, which the others are like
    integer, intent(in) :: teeth                 !< number of the others
    real(dp), intent(in) :: law(3)               !< result of `elastic_law` times thickness, N/m
    logical, intent(in) :: held(:)               !< true: the node is fixed; (node)
    type(superelement_t), intent(out) :: product
    type(error_t), allocatable, intent(inout) :: error
    type(row_t) :: doubled, row
    integer, allocatable :: sides(:)
    integer :: left

    product%teeth = teeth
    sides = [unheld(0), unheld(2*columns)]
    call condense_tooth(grid, columns, law, held, sides, doubled, product%inertia, error)
    if (allocated(error)) return
    product%inertia = teeth*product%inertia
    call turn_axes(grid%x(:, sides), doubled)
    left = teeth
    do
      if (mod(left, 2) == 1) then
        if (allocated(row%momentum)) then
          row = in_a_row(row, doubled)
        else
          row = doubled
        end if
      end if
      left = left/2
      if (left == 0) exit
      doubled = in_a_row(doubled, doubled)
    end do
    product%node = [unheld(ubound(grid%node, 1)), unheld(0)]
    call turn_axes(grid%x(:, product%node), row)
    product%momentum = reshape(row%momentum, [2, size(product%node)])
    call move_alloc(row%stiffness, product%stiffness)

  contains

    !> Nodes of a column line that are not held.
    pure function unheld(line) result(list)
      integer, intent(in) :: line
      integer, allocatable :: list(:)

      list = grid%column_nodes(line)
      list = pack(list, .not. held(list))
    end function unheld

    !> Condenses two rows to their outer sides.
    type(row_t) function in_a_row(first, second) result(both)
      type(row_t), intent(in) :: first, second
      real(dp), dimension(size(first%momentum)/2, size(first%momentum)/2) :: inner
      real(dp) :: right(size(first%momentum)/2, size(first%momentum) + 1), coupling(size(first%momentum), size(first%momentum)/2)
      integer :: info

      associate (m => size(first%momentum)/2, n => size(first%momentum))
        inner = first%stiffness(m + 1:, m + 1:) + second%stiffness(:m, :m)
        coupling(:m, :) = first%stiffness(:m, m + 1:)
        coupling(m + 1:, :) = second%stiffness(m + 1:, :m)
        right(:, :n) = transpose(coupling)
        right(:, n + 1) = first%momentum(m + 1:) + second%momentum(:m)
        call dposv('L', m, n + 1, inner, m, right, m, info)
        if (info /= 0 .and. .not. allocated(error)) call fail(error, code_numerical, &
          'the stiffness matrix is not positive definite: the body is not held')
        both%stiffness = -matmul(coupling, right(:, :n))
        both%stiffness(:m, :m) = both%stiffness(:m, :m) + first%stiffness(:m, :m)
        both%stiffness(m + 1:, m + 1:) = both%stiffness(m + 1:, m + 1:) + second%stiffness(m + 1:, m + 1:)
        both%stiffness = (both%stiffness + transpose(both%stiffness))/2
        both%momentum = [first%momentum(:m), second%momentum(m + 1:)] - matmul(coupling, right(:, n + 1))
      end associate
    end function in_a_row
  end subroutine make_superelement

  !> Condenses the first tooth of a grid to its sides, in Cartesian displacements.
  subroutine condense_tooth(grid, columns, law, held, sides, row, inertia, error)
    type(grid_t), intent(in) :: grid
    integer, intent(in) :: columns, sides(:)     ! sides: nodes of the near side, then of the far one
    real(dp), intent(in) :: law(3)
    logical, intent(in) :: held(:)
    type(row_t), intent(out) :: row
    real(dp), intent(out) :: inertia             ! m4
    type(error_t), allocatable, intent(inout) :: error
    character(*), parameter :: what = 'elements across a tooth: a tooth of the complete gear'
    integer, parameter :: own = 2*nodes_per_element
    type(elements_t) :: matrices
    type(sparse_t) :: inner
    logical :: within(size(held)), on_side(size(held))
    logical, allocatable :: of_tooth(:)
    integer :: equation(2, size(held)), n, i, e
    real(dp), allocatable :: momentum(:, :), forces(:, :), reduced(:, :)

    within = .false.
    do i = 0, 2*columns
      within(grid%column_nodes(i)) = .true.
    end do
    of_tooth = [(all(within(grid%element(:, e))), e=1, size(grid%element, 2))]
    call claim_memory(count(of_tooth)*(4.0_dp*own*(own + 1) + 4.0_dp*(own + 1)) + 16.0_dp*size(sides)**2 + &
                      40.0_dp*size(held), what, error)
    if (allocated(error)) return
    on_side = .false.
    on_side(sides) = .true.
    equation = 0
    n = 0
    do i = 1, size(held)
      if (.not. within(i) .or. on_side(i) .or. held(i)) cycle
      equation(:, i) = n + [1, 2]
      n = n + 2
    end do
    do i = 1, size(sides)
      equation(:, sides(i)) = n + [1, 2]
      n = n + 2
    end do
    allocate (momentum(2, size(held)), source=0.0_dp)
    inertia = 0
    call matrices%begin(count(of_tooth), own)
    do e = 1, size(grid%element, 2)
      if (.not. of_tooth(e)) cycle
      associate (nodes => grid%element(:, e))
        call matrices%add(reshape(equation(:, nodes), [own]), element_stiffness(grid%x(:, nodes), law))
        call add_angular_momentum(grid%x(:, nodes), nodes, momentum, inertia)
      end associate
    end do
    call matrices%finish()
    allocate (row%stiffness(2*size(sides), 2*size(sides)), reduced(2*size(sides), 1), forces(n, 1))
    call factor_inner(n, matrices%first, matrices%at, matrices%values, what, inner, row%stiffness, error)
    do i = 1, size(held)
      if (equation(1, i) > 0) forces(equation(:, i), 1) = momentum(:, i)
    end do
    call inner%condense(forces, reduced, error)
    if (.not. allocated(error)) row%momentum = reduced(:, 1)
  end subroutine condense_tooth

  !> Changes between Cartesian displacements and radial and tangential ones, in either direction: the matrix of each node is its
  !> own inverse.
  pure subroutine turn_axes(x, row)
    real(dp), intent(in) :: x(:, :)              ! places of the nodes, m (2, node)
    type(row_t), intent(inout) :: row
    real(dp) :: axes(2, 2)
    integer :: i

    do i = 1, size(x, 2)
      axes = reshape([x(1, i), x(2, i), x(2, i), -x(1, i)], [2, 2])/norm2(x(:, i))
      associate (own => 2*i - 1)
        row%stiffness(own:own + 1, :) = matmul(axes, row%stiffness(own:own + 1, :))
        row%stiffness(:, own:own + 1) = matmul(row%stiffness(:, own:own + 1), axes)
        row%momentum(own:own + 1) = matmul(axes, row%momentum(own:own + 1))
      end associate
    end do
  end subroutine turn_axes

  !> Adds the part of an element to the weights of the nodes' displacements in the angular momentum about the origin and to the
  !> moment of inertia, for unit density and thickness.
  pure subroutine add_angular_momentum(x, nodes, momentum, inertia)
    real(dp), intent(in) :: x(:, :)              !< places of the element's nodes, m (2, node of the element)
    integer, intent(in) :: nodes(:)              !< their indices in `momentum`
    real(dp), intent(inout) :: momentum(:, :)    !< m3; (2, node)
    real(dp), intent(inout) :: inertia           !< m4
    real(dp) :: moment(2, nodes_per_element)

    moment = matmul(x, element_mass(x))
    momentum(1, nodes) = momentum(1, nodes) - moment(2, :)
    momentum(2, nodes) = momentum(2, nodes) + moment(1, :)
    inertia = inertia + sum(moment*x)
  end subroutine add_angular_momentum
end module gearsweep_elastic_superelement
