!> Gauss-Legendre quadrature.
module gearsweep_base_quadrature
  use gearsweep_base_kinds, only: dp, pi
  implicit none
  private
  public :: gauss_legendre

contains

  !> Computes nodes on (-1, 1), ascending, and weights: exact for polynomials of degree 2 size(node) - 1. Source: Abramowitz,
  !> Stegun 1964, 25.4.29; nodes by Newton's method.
  pure subroutine gauss_legendre(node, weight)
    real(dp), intent(out) :: node(:), weight(:)
    real(dp) :: x, p(0:size(node)), slope
    integer :: i, k, n, again

    n = size(node)
    do i = 1, n
      x = -cos(pi*(i - 0.25_dp)/(n + 0.5_dp))
      do again = 1, 8
        p(0) = 1
        p(1) = x
        do k = 2, n
          p(k) = ((2*k - 1)*x*p(k - 1) - (k - 1)*p(k - 2))/k
        end do
        slope = n*(x*p(n) - p(n - 1))/(x**2 - 1)
        x = x - p(n)/slope
      end do
      node(i) = x
      weight(i) = 2/((1 - x**2)*slope**2)
    end do
  end subroutine gauss_legendre
end module gearsweep_base_quadrature
