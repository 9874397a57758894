!> The eight-node quadrilateral of the serendipity family: shape functions,
!> stiffness and mass. Corners first, then midsides, anticlockwise, as in VTK.
module gearsweep_elastic_q8
  use gearsweep_base, only: dp
  implicit none
  private
  public :: shape_functions, jacobian, edge_functions, edge_slopes
  public :: element_gradients, element_stiffness, element_mass

  integer, parameter, public :: nodes_per_element = 8
  !> Three-point Gauss rule.
  real(dp), parameter, public :: gauss_place(3) = [-sqrt(0.6_dp), 0.0_dp, sqrt(0.6_dp)]
  real(dp), parameter, public :: gauss_weight(3) = [5, 8, 5]/9.0_dp

  real(dp), parameter :: corner_x(4) = [-1, 1, 1, -1], corner_y(4) = [-1, -1, 1, 1]
  integer, parameter :: gauss_points = 9

contains

  !> The eight shape functions at local coordinates `p` in [-1, 1]^2.
  pure function shape_functions(p) result(f)
    real(dp), intent(in) :: p(2)
    real(dp) :: f(nodes_per_element)

    f(1:4) = (1 + corner_x*p(1))*(1 + corner_y*p(2))*(corner_x*p(1) + corner_y*p(2) - 1)/4
    f(5) = (1 - p(1)**2)*(1 - p(2))/2
    f(6) = (1 + p(1))*(1 - p(2)**2)/2
    f(7) = (1 - p(1)**2)*(1 + p(2))/2
    f(8) = (1 - p(1))*(1 - p(2)**2)/2
  end function shape_functions

  !> Derivatives of the shape functions by the local coordinates (8, 2).
  pure function shape_slopes(p) result(d)
    real(dp), intent(in) :: p(2)
    real(dp) :: d(nodes_per_element, 2)

    d(1:4, 1) = corner_x*(1 + corner_y*p(2))*(2*corner_x*p(1) + corner_y*p(2))/4
    d(1:4, 2) = corner_y*(1 + corner_x*p(1))*(2*corner_y*p(2) + corner_x*p(1))/4
    d(5:8, 1) = [-p(1)*(1 - p(2)), (1 - p(2)**2)/2, -p(1)*(1 + p(2)), -(1 - p(2)**2)/2]
    d(5:8, 2) = [-(1 - p(1)**2)/2, -p(2)*(1 + p(1)), (1 - p(1)**2)/2, -p(2)*(1 - p(1))]
  end function shape_slopes

  !> Jacobian matrix d(x, y)/d(local), for element nodes at `x` (2, 8).
  pure function jacobian(x, p) result(j)
    real(dp), intent(in) :: x(2, nodes_per_element), p(2)
    real(dp) :: j(2, 2)

    j = matmul(x, shape_slopes(p))
  end function jacobian

  !> The three shape functions of an edge: first end, middle, second end; t in [-1, 1].
  pure function edge_functions(t) result(f)
    real(dp), intent(in) :: t
    real(dp) :: f(3)

    f = [t*(t - 1)/2, 1 - t**2, t*(t + 1)/2]
  end function edge_functions

  !> Derivatives of the shape functions of an edge.
  pure function edge_slopes(t) result(d)
    real(dp), intent(in) :: t
    real(dp) :: d(3)

    d = [t - 0.5_dp, -2*t, t + 0.5_dp]
  end function edge_slopes

  !> Stiffness matrix (16, 16), unknowns u1 v1 u2 v2 ..., per unit thickness.
  !>
  !> `elastic` holds c11, c12 and c33 of the isotropic plane law (Pa).
  pure function element_stiffness(x, elastic) result(k)
    real(dp), intent(in) :: x(2, nodes_per_element), elastic(3)
    real(dp) :: k(2*nodes_per_element, 2*nodes_per_element)
    real(dp) :: g(nodes_per_element, 2, gauss_points), weight(gauss_points)
    real(dp), dimension(nodes_per_element) :: xx, xy, yx, yy
    integer :: a, b, n, i, p

    do a = 1, 3
      do b = 1, 3
        p = 3*(a - 1) + b
        call element_gradients(x, [gauss_place(a), gauss_place(b)], g(:, :, p), weight(p))
        weight(p) = weight(p)*gauss_weight(a)*gauss_weight(b)
      end do
    end do
    do n = 1, nodes_per_element
      xx = 0
      xy = 0
      yx = 0
      yy = 0
      do p = 1, gauss_points
        associate (by_x => weight(p)*g(n, 1, p), by_y => weight(p)*g(n, 2, p))
          xx = xx + g(:, 1, p)*by_x
          yx = yx + g(:, 2, p)*by_x
          xy = xy + g(:, 1, p)*by_y
          yy = yy + g(:, 2, p)*by_y
        end associate
      end do
      do i = 1, nodes_per_element
        k(2*i - 1, 2*n - 1) = elastic(1)*xx(i) + elastic(3)*yy(i)
        k(2*i, 2*n - 1) = elastic(2)*yx(i) + elastic(3)*xy(i)
        k(2*i - 1, 2*n) = elastic(2)*xy(i) + elastic(3)*yx(i)
        k(2*i, 2*n) = elastic(1)*yy(i) + elastic(3)*xx(i)
      end do
    end do
  end function element_stiffness

  !> Computes the derivatives of the shape functions by x and y (8, 2), and the Jacobian's determinant.
  pure subroutine element_gradients(x, p, g, det)
    real(dp), intent(in) :: x(2, nodes_per_element), p(2)
    real(dp), intent(out) :: g(nodes_per_element, 2), det
    real(dp) :: d(nodes_per_element, 2), j(2, 2)

    d = shape_slopes(p)
    j = matmul(x, d)
    det = j(1, 1)*j(2, 2) - j(1, 2)*j(2, 1)
    g(:, 1) = (d(:, 1)*j(2, 2) - d(:, 2)*j(2, 1))/det
    g(:, 2) = (d(:, 2)*j(1, 1) - d(:, 1)*j(1, 2))/det
  end subroutine element_gradients

  !> Consistent mass matrix (8, 8), the same for both directions, per unit thickness and density.
  pure function element_mass(x) result(m)
    real(dp), intent(in) :: x(2, nodes_per_element)
    real(dp) :: m(nodes_per_element, nodes_per_element)
    real(dp) :: f(nodes_per_element), j(2, 2), weight
    integer :: a, b, n

    m = 0
    do a = 1, 3
      do b = 1, 3
        f = shape_functions([gauss_place(a), gauss_place(b)])
        j = jacobian(x, [gauss_place(a), gauss_place(b)])
        weight = gauss_weight(a)*gauss_weight(b)*(j(1, 1)*j(2, 2) - j(1, 2)*j(2, 1))
        do n = 1, nodes_per_element
          m(:, n) = m(:, n) + f*(weight*f(n))
        end do
      end do
    end do
  end function element_mass
end module gearsweep_elastic_q8
