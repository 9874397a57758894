!> Explicit interfaces of the BLAS, LAPACK and ARPACK procedures in use.
module gearsweep_lapack
  use gearsweep_kinds, only: dp
  implicit none
  private
  public :: dpbtrf, dtbsv, dtrsm, dgemm, dsaupd, dseupd

  interface
    subroutine dpbtrf(uplo, n, kd, ab, ldab, info)
      import :: dp
      character, intent(in) :: uplo
      integer, intent(in) :: n, kd, ldab
      real(dp), intent(inout) :: ab(ldab, *)
      integer, intent(out) :: info
    end subroutine dpbtrf

    subroutine dtbsv(uplo, trans, diag, n, k, a, lda, x, incx)
      import :: dp
      character, intent(in) :: uplo, trans, diag
      integer, intent(in) :: n, k, lda, incx
      real(dp), intent(in) :: a(lda, *)
      real(dp), intent(inout) :: x(*)
    end subroutine dtbsv

    subroutine dtrsm(side, uplo, transa, diag, m, n, alpha, a, lda, b, ldb)
      import :: dp
      character, intent(in) :: side, uplo, transa, diag
      integer, intent(in) :: m, n, lda, ldb
      real(dp), intent(in) :: alpha, a(lda, *)
      real(dp), intent(inout) :: b(ldb, *)
    end subroutine dtrsm

    subroutine dgemm(transa, transb, m, n, k, alpha, a, lda, b, ldb, beta, c, ldc)
      import :: dp
      character, intent(in) :: transa, transb
      integer, intent(in) :: m, n, k, lda, ldb, ldc
      real(dp), intent(in) :: alpha, beta, a(lda, *), b(ldb, *)
      real(dp), intent(inout) :: c(ldc, *)
    end subroutine dgemm

    !> ARPACK writes to `tol`, and keeps saved state: one caller at a time.
    subroutine dsaupd(ido, bmat, n, which, nev, tol, resid, ncv, v, ldv, iparam, ipntr, workd, workl, lworkl, info)
      import :: dp
      character, intent(in) :: bmat
      character(2), intent(in) :: which
      integer, intent(in) :: n, nev, ncv, ldv, lworkl
      integer, intent(inout) :: ido, iparam(11), ipntr(11), info
      real(dp), intent(inout) :: tol, resid(n), v(ldv, ncv), workd(3*n), workl(lworkl)
    end subroutine dsaupd

    subroutine dseupd(rvec, howmny, select, d, z, ldz, sigma, bmat, n, which, nev, tol, resid, ncv, v, ldv, &
                      iparam, ipntr, workd, workl, lworkl, info)
      import :: dp
      logical, intent(in) :: rvec
      character, intent(in) :: howmny, bmat
      character(2), intent(in) :: which
      integer, intent(in) :: ldz, n, nev, ncv, ldv, lworkl
      logical, intent(inout) :: select(ncv)
      integer, intent(inout) :: iparam(7), ipntr(11), info
      real(dp), intent(inout) :: d(nev), z(ldz, nev), tol, resid(n), v(ldv, ncv), workd(2*n), workl(lworkl)
      real(dp), intent(in) :: sigma
    end subroutine dseupd
  end interface
end module gearsweep_lapack
