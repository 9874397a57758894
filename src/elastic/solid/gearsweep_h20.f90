!> The twenty-node brick of the serendipity family: shape functions, stiffness and mass. Its bottom and its top are the
!> eight nodes of gearsweep_q8 each, corners first, then midsides; four nodes halfway between the corners follow.
module gearsweep_h20
  use gearsweep_kinds, only: dp
  use gearsweep_q8, only: gauss_place, gauss_weight
  implicit none
  private
  public :: brick_functions, brick_matrices

  integer, parameter, public :: brick_nodes = 20

  !> Local coordinates of the nodes.
  real(dp), parameter, public :: brick_node(3, brick_nodes) = reshape(real([ &
    -1, -1, -1, 1, -1, -1, 1, 1, -1, -1, 1, -1, 0, -1, -1, 1, 0, -1, 0, 1, -1, -1, 0, -1, &
    -1, -1, 1, 1, -1, 1, 1, 1, 1, -1, 1, 1, 0, -1, 1, 1, 0, 1, 0, 1, 1, -1, 0, 1, &
    -1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0], dp), [3, brick_nodes])

contains

  !> The functions and their derivatives by the local coordinates (20, 3) at `p` in [-1, 1]^3 (Zienkiewicz, Taylor, Zhu
  !> 2013, The finite element method, section 6.2).
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

  !> Of a three by three matrix; its determinant.
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
end module gearsweep_h20
