!> Systems of a few linear equations, solved at each place of a motion: a call of LAPACK, which is not pure, takes longer than the
!> solution.
module gearsweep_base_small_system
  use gearsweep_base_kinds, only: dp
  implicit none
  private
  public :: solve_small

contains

  !> Solves matrix x = b for several right-hand sides by Gauss elimination with partial pivoting; x replaces b. If the matrix is
  !> singular, x is undefined.
  pure subroutine solve_small(matrix, b)
    real(dp), intent(in) :: matrix(:, :)         !< (equation, unknown)
    real(dp), intent(inout) :: b(:, :)           !< (equation, right-hand side)
    real(dp) :: a(size(matrix, 1), size(matrix, 1) + size(b, 2)), row(size(matrix, 1) + size(b, 2))
    integer :: i, k, n, pivot

    n = size(matrix, 1)
    a(:, :n) = matrix
    a(:, n + 1:) = b
    do k = 1, n
      pivot = k - 1 + maxloc(abs(a(k:, k)), 1)
      row = a(pivot, :)
      a(pivot, :) = a(k, :)
      a(k, :) = row/row(k)
      do i = k + 1, n
        a(i, k:) = a(i, k:) - a(i, k)*a(k, k:)
      end do
    end do
    do k = n, 2, -1
      do i = 1, k - 1
        a(i, n + 1:) = a(i, n + 1:) - a(i, k)*a(k, n + 1:)
      end do
    end do
    b = a(:, n + 1:)
  end subroutine solve_small
end module gearsweep_base_small_system
