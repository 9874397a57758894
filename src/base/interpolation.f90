!> Smooth curves as polynomials, and curves joined piece by piece.
module gearsweep_base_interpolation
  use gearsweep_base_kinds, only: dp, pi
  use gearsweep_base_piecewise, only: piecewise_t, polynomial
  implicit none
  private
  public :: interpolated, joined

contains

  !> Polynomial over [first, last] with these `values` at v = -cos(pi k/n), k = 0 to n, which are denser towards both ends: there
  !> it is exact, and between it is nearly the best of its degree n.
  !> Source: Trefethen 2013, Approximation Theory and Approximation Practice, chapters 3 and 15.
  pure function interpolated(first, last, values) result(p)
    real(dp), intent(in) :: first, last, values(0:)
    type(piecewise_t) :: p
    real(dp), dimension(0:ubound(values, 1)) :: chebyshev, before, term, power
    integer :: n, j, k

    n = ubound(values, 1)
    do j = 0, n
      chebyshev(j) = 0
      do k = 0, n
        chebyshev(j) = chebyshev(j) + values(k)*cos(pi*j*(n - k)/n)/merge(2, 1, k == 0 .or. k == n)
      end do
      chebyshev(j) = 2*chebyshev(j)/n/merge(2, 1, j == 0 .or. j == n)
    end do
    ! Chebyshev polynomials by their recurrence, in powers of v.
    before = 0
    term = 0
    term(0) = 1
    power = chebyshev(0)*term
    do j = 1, n
      associate (next => merge(1, 2, j == 1)*eoshift(term, -1) - before)
        before = term
        term = next
      end associate
      power = power + chebyshev(j)*term
    end do
    p = polynomial(first, last, power)
  end function interpolated

  !> Curve `left` up to its end, then `right`.
  pure function joined(left, right) result(p)
    type(piecewise_t), intent(in) :: left, right
    type(piecewise_t) :: p
    integer :: n, m

    n = size(left%coef, 2)
    m = size(right%coef, 2)
    p%breaks = [left%breaks, right%breaks(2:)]
    allocate (p%coef(0:max(ubound(left%coef, 1), ubound(right%coef, 1)), n + m), source=0.0_dp)
    p%coef(:ubound(left%coef, 1), :n) = left%coef
    p%coef(:ubound(right%coef, 1), n + 1:) = right%coef
  end function joined
end module gearsweep_base_interpolation
