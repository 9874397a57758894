!> Interfaces of LAPACK.
module gearsweep_base_lapack
  use gearsweep_base_kinds, only: dp
  implicit none
  private
  public :: dgesv, dlasrt, dposv, zpotrf, zpotrs

  interface
    !> Solves a general linear system.
    pure subroutine dgesv(n, nrhs, a, lda, ipiv, b, ldb, info)
      import :: dp
      integer, intent(in) :: n, nrhs, lda, ldb
      real(dp), intent(inout) :: a(lda, n), b(ldb, nrhs)
      integer, intent(out) :: ipiv(n), info
    end subroutine dgesv

    !> Sorts numbers in ascending order (`id` 'I') or in descending order ('D').
    pure subroutine dlasrt(id, n, d, info)
      import :: dp
      character, intent(in) :: id
      integer, intent(in) :: n
      real(dp), intent(inout) :: d(*)
      integer, intent(out) :: info
    end subroutine dlasrt

    !> Solves a symmetric positive definite system by Cholesky's method.
    pure subroutine dposv(uplo, n, nrhs, a, lda, b, ldb, info)
      import :: dp
      character, intent(in) :: uplo
      integer, intent(in) :: n, nrhs, lda, ldb
      real(dp), intent(inout) :: a(lda, n), b(ldb, nrhs)
      integer, intent(out) :: info
    end subroutine dposv

    !> Computes the Cholesky factor of a Hermitian positive definite matrix.
    pure subroutine zpotrf(uplo, n, a, lda, info)
      import :: dp
      character, intent(in) :: uplo
      integer, intent(in) :: n, lda
      complex(dp), intent(inout) :: a(lda, n)
      integer, intent(out) :: info
    end subroutine zpotrf

    !> Solves a Hermitian positive definite system with the factor of its matrix that `zpotrf` computed.
    pure subroutine zpotrs(uplo, n, nrhs, a, lda, b, ldb, info)
      import :: dp
      character, intent(in) :: uplo
      integer, intent(in) :: n, nrhs, lda, ldb
      complex(dp), intent(in) :: a(lda, n)
      complex(dp), intent(inout) :: b(ldb, nrhs)
      integer, intent(out) :: info
    end subroutine zpotrs
  end interface
end module gearsweep_base_lapack
