!> The lowest eigenvalues of K u = lambda M u by ARPACK's implicitly restarted Lanczos method in shift-invert mode
!> about zero (Lehoucq, Sorensen, Yang 1998, ARPACK users' guide).
module gearsweep_base_arpack
  use gearsweep_base_system, only: begin_products, end_products
  use gearsweep_base_error, only: code_numerical, error_t, fail
  use gearsweep_base_kinds, only: dp
  use gearsweep_base_text, only: str
  implicit none
  private
  public :: pencil_t, lowest_eigenpairs, residual_of, work_bytes

  !> Pair of symmetric matrices, K positive definite, M positive semidefinite.
  type, abstract :: pencil_t
    integer :: n = 0                             !< order
  contains
    procedure(solve_k), deferred :: solve
    procedure(times_m), deferred :: times
  end type pencil_t

  abstract interface
    !> Replaces x by K^-1 x.
    subroutine solve_k(pencil, x, error)
      import :: dp, error_t, pencil_t
      class(pencil_t), intent(in) :: pencil
      real(dp), intent(inout), contiguous :: x(:)
      type(error_t), allocatable, intent(inout) :: error
    end subroutine solve_k

    !> Computes y = M x.
    subroutine times_m(pencil, x, y)
      import :: dp, pencil_t
      class(pencil_t), intent(in) :: pencil
      real(dp), intent(in) :: x(:)
      real(dp), intent(out) :: y(:)
    end subroutine times_m
  end interface

  !> Relative tolerance of the eigenvalues that ARPACK iterates on, 1/lambda.
  real(dp), parameter :: tolerance = 1e-8_dp
  integer, parameter :: most_restarts = 300

  interface
    subroutine enter_arpack() bind(c, name='gearsweep_enter_arpack')
    end subroutine enter_arpack

    subroutine leave_arpack() bind(c, name='gearsweep_leave_arpack')
    end subroutine leave_arpack

    subroutine dsaupd(ido, bmat, n, which, nev, tol, resid, ncv, v, ldv, iparam, ipntr, workd, workl, lworkl, info)
      import :: dp
      integer, intent(inout) :: ido, iparam(11), ipntr(11), info
      character, intent(in) :: bmat
      character(2), intent(in) :: which
      integer, intent(in) :: n, nev, ncv, ldv, lworkl
      real(dp), intent(in) :: tol
      real(dp), intent(inout) :: resid(n), v(ldv, ncv), workd(3*n), workl(lworkl)
    end subroutine dsaupd

    subroutine dseupd(rvec, howmny, select, d, z, ldz, sigma, bmat, n, which, nev, tol, resid, ncv, v, ldv, iparam, ipntr, &
                      workd, workl, lworkl, info)
      import :: dp
      logical, intent(in) :: rvec
      character, intent(in) :: howmny, bmat
      character(2), intent(in) :: which
      integer, intent(in) :: ldz, n, nev, ncv, ldv, lworkl
      logical, intent(inout) :: select(ncv)
      real(dp), intent(in) :: sigma, tol
      integer, intent(inout) :: iparam(11), ipntr(11), info
      real(dp), intent(inout) :: d(nev), z(ldz, nev), resid(n), v(ldv, ncv), workd(3*n), workl(lworkl)
    end subroutine dseupd
  end interface

contains

  !> Residual |K x - lambda M x| / |K x|.
  pure real(dp) function residual_of(pulled, value, moved)
    real(dp), intent(in) :: pulled(:)            !< K x
    real(dp), intent(in) :: value                !< lambda
    real(dp), intent(in) :: moved(:)             !< M x

    residual_of = norm2(pulled - value*moved)/norm2(pulled)
  end function residual_of

  !> Number of vectors in the basis. A smaller basis is restarted more often, a larger one needs more solutions before the first
  !> check. `extra`: vectors beyond the wanted ones, at least; 10 by default.
  pure integer function basis_size(n, count, extra)
    integer, intent(in) :: n, count
    integer, intent(in), optional :: extra
    integer :: more

    more = 10
    if (present(extra)) more = extra
    basis_size = min(n, max(2*count, count + more))
  end function basis_size

  !> Bytes needed by `lowest_eigenpairs`, result included.
  pure real(dp) function work_bytes(n, count, extra)
    integer, intent(in) :: n, count
    integer, intent(in), optional :: extra
    integer :: most

    most = basis_size(n, count, extra)
    work_bytes = 8.0_dp*n*(most + 2.0_dp*count + 6) + 8.0_dp*most*(most + 10)
  end function work_bytes

  !> Finds the lowest `count` eigenvalues, ascending, and their vectors (n, count), M-orthonormal. One thread at a time iterates;
  !> others wait.
  !>
  !> `found(n, :)`, if it has columns: known vectors, M-orthonormal; the wanted ones are M-orthogonal to them. A single vector's
  !> Krylov space has one direction of each eigenspace. So where eigenvalues are equal in pairs, a second call with the vectors of
  !> the first finds the twins. `extra`: of the basis, see `basis_size`.
  subroutine lowest_eigenpairs(pencil, count, found, values, vectors, error, extra)
    class(pencil_t), intent(in) :: pencil
    integer, intent(in) :: count
    real(dp), intent(in), contiguous :: found(:, :)
    real(dp), allocatable, intent(out) :: values(:), vectors(:, :)
    type(error_t), allocatable, intent(inout) :: error
    integer, intent(in), optional :: extra

    call enter_arpack()
    call iterate(pencil, count, found, basis_size(pencil%n, count, extra), values, vectors, error)
    call leave_arpack()
  end subroutine lowest_eigenpairs

  subroutine iterate(pencil, count, found, most, values, vectors, error)
    class(pencil_t), intent(in) :: pencil
    integer, intent(in) :: count, most
    real(dp), intent(in), contiguous :: found(:, :)
    real(dp), allocatable, intent(out) :: values(:), vectors(:, :)
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: v(:, :), workd(:), workl(:), resid(:), weighted(:, :)
    logical, allocatable :: select(:)
    integer :: ido, iparam(11), ipntr(11), info, n, i

    n = pencil%n
    allocate (v(n, most), workd(3*n), workl(most*(most + 8)), resid(n), weighted(n, size(found, 2)), select(most))
    do i = 1, size(found, 2)
      call pencil%times(found(:, i), weighted(:, i))
    end do
    ! Start vector, the same for every run, with a part in every mode.
    do i = 1, n
      resid(i) = 0.1_dp + modulo(i*0.6180339887498949_dp, 1.0_dp)
    end do
    call remove_found(resid)
    iparam = 0
    iparam(1) = 1                                ! exact shifts
    iparam(3) = most_restarts
    iparam(7) = 3                                ! shift-invert
    ipntr = 0
    ido = 0
    info = 1                                     ! `resid` is the start
    do
      call begin_products()
      call dsaupd(ido, 'G', n, 'LM', count, tolerance, resid, most, v, n, iparam, ipntr, workd, workl, size(workl), info)
      call end_products()
      associate (from => ipntr(1), to => ipntr(2), at_hand => ipntr(3))
        select case (ido)
        case (-1)
          call pencil%times(workd(from:from + n - 1), workd(to:to + n - 1))
        case (1)
          workd(to:to + n - 1) = workd(at_hand:at_hand + n - 1)
        case (2)
          call pencil%times(workd(from:from + n - 1), workd(to:to + n - 1))
          cycle
        case default
          exit
        end select
        call pencil%solve(workd(to:to + n - 1), error)
        if (allocated(error)) return
        call remove_found(workd(to:to + n - 1))
      end associate
    end do
    if (info == 0 .and. iparam(5) >= count) then
      allocate (values(count), vectors(n, count))
      call begin_products()
      call dseupd(.true., 'A', select, values, vectors, n, 0.0_dp, 'G', n, 'LM', count, tolerance, resid, most, v, n, iparam, &
                  ipntr, workd, workl, size(workl), info)
      call end_products()
    else if (info == 0) then
      info = 1
    end if
    if (info /= 0) call fail(error, code_numerical, 'no convergence of the modes with '//str(most)// &
                             ' vectors: ARPACK''s info = '//str(info))

  contains

    !> Makes x M-orthogonal to the known vectors.
    subroutine remove_found(x)
      real(dp), intent(inout) :: x(:)
      integer :: k

      do k = 1, size(found, 2)
        x = x - dot_product(weighted(:, k), x)*found(:, k)
      end do
    end subroutine remove_found
  end subroutine iterate
end module gearsweep_base_arpack
