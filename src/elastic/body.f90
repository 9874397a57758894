!> An elastic body: a grid with its material, supports and factored stiffness.
module gearsweep_elastic_body
  use gearsweep_base, only: claim_memory, code_input, dp, elements_t, error_t, factor, fail, sparse_t, str
  use gearsweep_elastic_grid, only: grid_t
  use gearsweep_elastic_material, only: check_material, material_t
  use gearsweep_elastic_q8, only: element_mass, element_stiffness, nodes_per_element
  use gearsweep_elastic_superelement, only: superelement_t
  implicit none
  private
  public :: body_t, make_body, elastic_law

  !> Number of entries of an element's lower triangle.
  integer, parameter :: triangle = nodes_per_element*(2*nodes_per_element + 1)

  type :: body_t
    type(grid_t) :: grid
    type(material_t) :: material
    logical :: plane_strain = .false.
    real(dp) :: thickness = 0                    !< m
    integer, allocatable :: equation(:, :)       !< numbers of each node's two unknowns, 0 if held (2, nodes)
    integer :: unknowns = 0
    type(sparse_t) :: stiffness                  !< factored
    type(superelement_t) :: rest                 !< other teeth of a complete gear; its forces and mass are not in the procedures
  contains
    procedure :: spread_out
    procedure :: gather
    procedure :: stiffness_times
    procedure :: mass_matrices
    procedure :: mass
  end type body_t

contains

  !> Factors the stiffness of `grid`; frees the previous content of `body`.
  !>
  !> `held(2, nodes)` is true where a displacement is zero; together they must exclude every rigid motion. `thickness` in m,
  !> `most_bytes` for the factor. `rest`: the teeth of a complete gear that the grid does not have.
  subroutine make_body(grid, material, plane_strain, thickness, held, most_bytes, body, error, rest)
    type(grid_t), intent(in) :: grid
    type(material_t), intent(in) :: material
    logical, intent(in) :: plane_strain, held(:, :)
    real(dp), intent(in) :: thickness, most_bytes
    type(body_t), intent(inout) :: body
    type(error_t), allocatable, intent(out) :: error
    type(superelement_t), intent(in), optional :: rest
    type(elements_t) :: matrices
    character(:), allocatable :: what
    real(dp) :: law(3)
    integer :: n, d, e

    call body%stiffness%free()
    call check_material(material, error)
    if (.not. thickness > 0) call fail(error, code_input, 'face width: must be above 0')
    if (.not. excludes_rigid_motion(grid%x, held)) call fail(error, code_input, &
      'support of the section: the section is not held; must be at the ''sides'' (of a sector) or the ''rim'' (or bore)')
    if (allocated(error)) return
    body%grid = grid
    body%material = material
    body%plane_strain = plane_strain
    body%thickness = thickness
    if (allocated(body%equation)) deallocate (body%equation)
    allocate (body%equation(2, size(held, 2)), source=0)
    body%rest = superelement_t()
    if (present(rest)) body%rest = rest
    body%unknowns = 0
    do n = 1, size(held, 2)
      do d = 1, 2
        if (held(d, n)) cycle
        body%unknowns = body%unknowns + 1
        body%equation(d, n) = body%unknowns
      end do
    end do
    what = 'elements across a tooth: the grid with '//str(body%unknowns)//' unknowns'
    call claim_memory(size(grid%element, 2)*(8.0_dp*triangle + 4.0_dp*(2*nodes_per_element + 1)), what, error)
    if (allocated(error)) return
    n = 0
    if (body%rest%teeth > 0) n = size(body%rest%stiffness, 1)
    call matrices%begin(size(grid%element, 2), 2*nodes_per_element, larger=n)
    law = thickness*elastic_law(material, plane_strain)
    do e = 1, size(grid%element, 2)
      associate (nodes => grid%element(:, e))
        call matrices%add(reshape(body%equation(:, nodes), [2*nodes_per_element]), element_stiffness(grid%x(:, nodes), law))
      end associate
    end do
    if (n > 0) call matrices%add(reshape(body%equation(:, body%rest%node), [n]), body%rest%stiffness)
    call matrices%finish()
    call factor(body%unknowns, matrices%first, matrices%at, matrices%values, most_bytes, what, body%stiffness, error)
  end subroutine make_body

  !> True if the held displacements exclude rigid motion: their matrix of two translations and a rotation has rank 3.
  pure logical function excludes_rigid_motion(x, held) result(safe)
    real(dp), intent(in) :: x(:, :)
    logical, intent(in) :: held(:, :)
    real(dp) :: gram(3, 3), row(3), centre(2), size_squared
    integer :: n, d

    centre = sum(x, 2)/size(x, 2)
    size_squared = sum((x(1, :) - centre(1))**2 + (x(2, :) - centre(2))**2)/size(x, 2)
    gram = 0
    do n = 1, size(x, 2)
      do d = 1, 2
        if (.not. held(d, n)) cycle
        row(d) = 1
        row(3 - d) = 0
        row(3) = merge(-(x(2, n) - centre(2)), x(1, n) - centre(1), d == 1)/sqrt(size_squared)
        gram = gram + spread(row, 1, 3)*spread(row, 2, 3)
      end do
    end do
    associate (g => gram)
      safe = g(1, 1)*(g(2, 2)*g(3, 3) - g(2, 3)**2) - g(1, 2)*(g(1, 2)*g(3, 3) - g(2, 3)*g(1, 3)) &
             + g(1, 3)*(g(1, 2)*g(2, 3) - g(2, 2)*g(1, 3)) > 1e-9_dp
    end associate
  end function excludes_rigid_motion

  !> Constants c11, c12 and c33 of the plane law (Pa).
  pure function elastic_law(material, plane_strain) result(c)
    type(material_t), intent(in) :: material
    logical, intent(in) :: plane_strain
    real(dp) :: c(3)

    associate (e => material%young, nu => material%poisson)
      if (plane_strain) then
        c(1:2) = e/((1 + nu)*(1 - 2*nu))*[1 - nu, nu]
      else
        c(1:2) = e/(1 - nu**2)*[1.0_dp, nu]
      end if
      c(3) = e/(2*(1 + nu))
    end associate
  end function elastic_law

  !> Converts unknowns to displacements of all nodes (2, nodes).
  pure function spread_out(body, x) result(u)
    class(body_t), intent(in) :: body
    real(dp), intent(in) :: x(:)
    real(dp) :: u(2, size(body%equation, 2))
    integer :: n, d

    u = 0
    do n = 1, size(u, 2)
      do d = 1, 2
        if (body%equation(d, n) > 0) u(d, n) = x(body%equation(d, n))
      end do
    end do
  end function spread_out

  !> Converts nodal values (2, nodes) to unknowns; held ones are dropped.
  pure function gather(body, u) result(x)
    class(body_t), intent(in) :: body
    real(dp), intent(in) :: u(:, :)
    real(dp) :: x(body%unknowns)
    integer :: n, d

    do n = 1, size(u, 2)
      do d = 1, 2
        if (body%equation(d, n) > 0) x(body%equation(d, n)) = u(d, n)
      end do
    end do
  end function gather

  !> Nodal forces (2 x nodes, N) of displacements (2 x nodes, m), column by column.
  pure function stiffness_times(body, u) result(f)
    class(body_t), intent(in) :: body
    real(dp), intent(in) :: u(:, :)
    real(dp) :: f(size(u, 1), size(u, 2))
    integer, parameter :: own = 2*nodes_per_element
    real(dp) :: k(own, own), of_element(own), law(3)
    integer :: list(own), e, c, i

    law = body%thickness*elastic_law(body%material, body%plane_strain)
    f = 0
    do e = 1, size(body%grid%element, 2)
      k = element_stiffness(body%grid%x(:, body%grid%element(:, e)), law)
      list(1::2) = 2*body%grid%element(:, e) - 1
      list(2::2) = list(1::2) + 1
      do c = 1, size(u, 2)
        of_element = 0
        do i = 1, own
          of_element = of_element + k(:, i)*u(list(i), c)
        end do
        do i = 1, own
          f(list(i), c) = f(list(i), c) + of_element(i)
        end do
      end do
    end do
  end function stiffness_times

  !> Consistent mass matrices of all elements, the same for both directions (8, 8, elements), kg.
  pure function mass_matrices(body) result(m)
    class(body_t), intent(in) :: body
    real(dp) :: m(nodes_per_element, nodes_per_element, size(body%grid%element, 2))
    integer :: e

    do e = 1, size(m, 3)
      m(:, :, e) = body%material%density*body%thickness*element_mass(body%grid%x(:, body%grid%element(:, e)))
    end do
  end function mass_matrices

  !> Mass (kg).
  pure real(dp) function mass(body)
    class(body_t), intent(in) :: body

    mass = body%material%density*body%thickness*body%grid%area()
  end function mass
end module gearsweep_elastic_body
