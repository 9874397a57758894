!> Sparse factorisation by MUMPS and eigenvalues by ARPACK, against dense products and LAPACK's dense solver.
module test_sparse
  use gearsweep_base_arpack, only: lowest_eigenpairs, pencil_t, residual_of
  use gearsweep_base_error, only: code_memory, code_numerical, error_t
  use gearsweep_base_kinds, only: dp
  use gearsweep_base_sparse, only: factor, sparse_t
  use gearsweep_base_text, only: str
  use test_support_testing, only: tally_t, check_close, check_equal, check_error, check_no_error, check_true
  implicit none
  private
  public :: run

  !> A sum of dense elements, and the same as one dense matrix.
  type :: sample_t
    integer :: n = 0
    integer, allocatable :: first(:), at(:)
    real(dp), allocatable :: values(:), dense(:, :)
  end type sample_t

  !> K by MUMPS, M = the diagonal 1, 2, 3, ... n over n; or 1, 1, 2, 2, ... n/2 over n/2.
  type, extends(pencil_t) :: sample_pencil_t
    type(sparse_t), pointer :: k => null()
    integer :: copies = 1
  contains
    procedure :: solve => solve_sample
    procedure :: times => times_diagonal
  end type sample_pencil_t

  interface
    subroutine dsygv(itype, jobz, uplo, n, a, lda, b, ldb, w, work, lwork, info)
      import :: dp
      character, intent(in) :: jobz, uplo
      integer, intent(in) :: itype, n, lda, ldb, lwork
      real(dp), intent(inout) :: a(lda, n), b(ldb, n)
      real(dp), intent(out) :: w(n), work(lwork)
      integer, intent(out) :: info
    end subroutine dsygv
  end interface

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t

    if (t%wants('solves')) call solves(t, 1, 1, 1)
    if (t%wants('solves')) call solves(t, 7, 3, 2)
    if (t%wants('solves')) call solves(t, 40, 8, 40)
    if (t%wants('solves')) call solves(t, 150, 33, 90)
    if (t%wants('solves')) call solves(t, 400, 16, 800)
    if (t%wants('solves')) call solves(t, 60, 60, 3)
    if (t%wants('many_threads')) call many_threads(t)
    if (t%wants('eigenpairs')) call eigenpairs(t)
    if (t%wants('twins')) call twins(t)
    if (t%wants('used_again')) call used_again(t)
    if (t%wants('refusals')) call refusals(t)
  end subroutine run

  !> Pseudo-random elements of some order on unknowns strewn over 1 to n, each diagonally dominant; and one on each
  !> unknown alone, so that none is left out.
  subroutine make_sample(n, order, elements, sample)
    integer, intent(in) :: n, order, elements
    type(sample_t), intent(out) :: sample
    integer :: e, i, j, k, entries, list(order)
    real(dp) :: entry

    sample%n = n
    sample%first = [(1 + order*e, e=0, elements), (1 + order*elements + e, e=1, n)]
    allocate (sample%at(order*elements + n), sample%values(elements*order*(order + 1)/2 + n), sample%dense(n, n))
    sample%dense = 0
    entries = 0
    do e = 1, elements
      ! Neighbours beside unknowns far away.
      list = [(1 + modulo(7*e + i + i**2/5*(n/order), n), i=1, order)]
      do i = 1, order
        do while (any(list(:i - 1) == list(i)))
          list(i) = 1 + modulo(list(i), n)
        end do
      end do
      sample%at(order*(e - 1) + 1:order*e) = list
      do j = 1, order
        do i = j, order
          entry = merge(1.5_dp*order, sin(1.7_dp*i*j + e), i == j)
          entries = entries + 1
          sample%values(entries) = entry
          sample%dense(list(i), list(j)) = sample%dense(list(i), list(j)) + entry
          if (i > j) sample%dense(list(j), list(i)) = sample%dense(list(j), list(i)) + entry
        end do
      end do
    end do
    do k = 1, n
      sample%at(order*elements + k) = k
      sample%values(entries + k) = 1 + modulo(0.618_dp*k, 1.0_dp)
      sample%dense(k, k) = sample%dense(k, k) + sample%values(entries + k)
    end do
  end subroutine make_sample

  subroutine factor_sample(sample, matrix, error)
    type(sample_t), intent(in) :: sample
    type(sparse_t), intent(inout) :: matrix
    type(error_t), allocatable, intent(inout) :: error

    call factor(sample%n, sample%first, sample%at, sample%values, 1e9_dp, 'the sample', matrix, error)
  end subroutine factor_sample

  subroutine solves(t, n, order, elements)
    type(tally_t), intent(inout) :: t
    integer, intent(in) :: n, order, elements
    type(sample_t) :: sample
    type(sparse_t) :: matrix
    type(error_t), allocatable :: error
    real(dp) :: wanted(n, 70), x(n, 70), one(n)
    character(:), allocatable :: name
    integer :: i, j

    name = ', order '//str(n)//', elements of '//str(order)
    call make_sample(n, order, elements, sample)
    do j = 1, size(wanted, 2)
      wanted(:, j) = [(cos(real(i*j, dp)), i=1, n)]
    end do
    call factor_sample(sample, matrix, error)
    call check_no_error(t, 'factor'//name, error)
    ! More right sides than are solved for at a time.
    x = matmul(sample%dense, wanted)
    one = x(:, 2)
    call matrix%solve(x, error)
    call check_no_error(t, 'solve'//name, error)
    call check_close(t, 'many right sides'//name, maxval(abs(x - wanted)), 0.0_dp, absolute=1e-12_dp)
    call matrix%solve(one, error)
    call check_close(t, 'one right side'//name, maxval(abs(one - wanted(:, 2))), 0.0_dp, absolute=1e-12_dp)
  end subroutine solves

  !> Threads that factor and solve at once get the bits that one thread alone gets.
  subroutine many_threads(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: n = 150, threads = 8
    type(sample_t) :: sample
    type(sparse_t) :: alone, shared
    type(error_t), allocatable :: error
    real(dp) :: wanted(n), values(3), x(n)
    real(dp), allocatable :: alone_values(:), vectors(:, :)
    type(sample_pencil_t) :: pencil
    integer :: i, differ

    call make_sample(n, 12, 90, sample)
    call factor_sample(sample, alone, error)
    wanted = [(sin(real(i, dp)), i=1, n)]
    call alone%solve(wanted, error)
    call eigenpairs_of(sample, alone_values, vectors, error)
    values = alone_values
    call factor_sample(sample, shared, error)
    call check_no_error(t, 'one thread', error)
    differ = 0
    !$omp parallel do num_threads(threads) default(none) shared(sample, shared, wanted, values) &
    !$omp private(x, error, alone_values, vectors, pencil) reduction(+: differ)
    do i = 1, 3*threads
      block
        type(sparse_t) :: own
        integer :: k

        call factor_sample(sample, own, error)
        x = [(sin(real(k, dp)), k=1, n)]
        call own%solve(x, error)
        if (allocated(error) .or. any(abs(x - wanted) > 0)) differ = differ + 1
        x = [(sin(real(k, dp)), k=1, n)]
        call shared%solve(x, error)
        if (allocated(error) .or. any(abs(x - wanted) > 0)) differ = differ + 1
        call eigenpairs_of(sample, alone_values, vectors, error)
        if (allocated(error)) then
          differ = differ + 1
        else if (any(abs(alone_values - values) > 0)) then
          differ = differ + 1
        end if
        call own%free()
      end block
    end do
    !$omp end parallel do
    call check_equal(t, 'many threads at once: the same bits', differ, 0)
  end subroutine many_threads

  !> The three lowest eigenpairs of a sample.
  subroutine eigenpairs_of(sample, values, vectors, error)
    type(sample_t), intent(in) :: sample
    real(dp), allocatable, intent(out) :: values(:), vectors(:, :)
    type(error_t), allocatable, intent(inout) :: error
    type(sparse_t), target :: k
    type(sample_pencil_t) :: pencil

    call factor_sample(sample, k, error)
    pencil%n = sample%n
    pencil%k => k
    if (.not. allocated(error)) call lowest_eigenpairs(pencil, 3, none(sample%n), values, vectors, error)
    call k%free()
  end subroutine eigenpairs_of

  pure function none(n) result(vectors)
    integer, intent(in) :: n
    real(dp) :: vectors(n, 0)

    vectors = 0
  end function none

  subroutine solve_sample(pencil, x, error)
    class(sample_pencil_t), intent(in) :: pencil
    real(dp), intent(inout), contiguous :: x(:)
    type(error_t), allocatable, intent(inout) :: error

    call pencil%k%solve(x, error)
  end subroutine solve_sample

  subroutine times_diagonal(pencil, x, y)
    class(sample_pencil_t), intent(in) :: pencil
    real(dp), intent(in) :: x(:)
    real(dp), intent(out) :: y(:)
    integer :: i

    y = [(((i - 1)/pencil%copies + 1)*x(i)/(pencil%n/pencil%copies), i=1, pencil%n)]
  end subroutine times_diagonal

  !> Against LAPACK's dsygv.
  subroutine eigenpairs(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: n = 150
    type(sample_t) :: sample
    type(error_t), allocatable :: error
    real(dp) :: mass(n, n), w(n), work(40*n)
    real(dp), allocatable :: values(:), vectors(:, :), k(:, :), weighted(:, :), forces(:)
    integer :: i, info

    call make_sample(n, 12, 90, sample)
    call eigenpairs_of(sample, values, vectors, error)
    call check_no_error(t, 'eigenvalues', error)
    k = sample%dense
    mass = 0
    do i = 1, n
      mass(i, i) = real(i, dp)/n
    end do
    weighted = matmul(mass, vectors)
    call check_close(t, 'eigenvectors have unit mass', maxval(abs(matmul(transpose(vectors), weighted) - identity(3))), &
                     0.0_dp, absolute=1e-12_dp)
    do i = 1, 3
      forces = matmul(k, vectors(:, i))
      call check_close(t, 'residual of eigenvector '//str(i), norm2(forces - values(i)*weighted(:, i))/norm2(forces), 0.0_dp, &
                       absolute=1e-6_dp)
    end do
    ! Of K = diag(1, 4), M = 1 and the first eigenvector with 1e-4 of the other: K x - x = (0, 3e-4).
    call check_close(t, 'residual of a mixture', residual_of([1.0_dp, 4e-4_dp], 1.0_dp, [1.0_dp, 1e-4_dp]), &
                     3e-4_dp/sqrt(1 + 16e-8_dp), 1e-12_dp)
    call dsygv(1, 'N', 'L', n, k, n, mass, n, w, work, size(work), info)
    do i = 1, 3
      call check_close(t, 'eigenvalue '//str(i), values(i), w(i), relative=1e-12_dp)
    end do
  end subroutine eigenpairs

  pure function identity(n) result(unit)
    integer, intent(in) :: n
    real(dp) :: unit(n, n)
    integer :: i

    unit = 0
    do i = 1, n
      unit(i, i) = 1
    end do
  end function identity

  !> Two equal blocks have each eigenvalue of one twice. A first run and a second beside what that found
  !> have both between them.
  subroutine twins(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: half = 60
    type(sample_t) :: one, two
    type(sparse_t), target :: k
    type(sample_pencil_t) :: pencil
    type(error_t), allocatable :: error
    real(dp), allocatable :: alone(:), values(:), vectors(:, :), more(:), others(:, :)
    real(dp) :: weighted(2*half)
    integer :: i, j, e

    call make_sample(half, 12, 40, one)
    call eigenpairs_of(one, alone, vectors, error)
    ! The unknowns of both blocks in turn.
    two%n = 2*half
    two%first = [one%first, (one%first(size(one%first)) + one%first(e) - 1, e=2, size(one%first))]
    two%at = [2*one%at - 1, 2*one%at]
    two%values = [one%values, one%values]
    call factor_sample(two, k, error)
    pencil%n = 2*half
    pencil%copies = 2
    pencil%k => k
    call lowest_eigenpairs(pencil, 2, none(2*half), values, vectors, error)
    call check_no_error(t, 'first run', error)
    call lowest_eigenpairs(pencil, 2, vectors, more, others, error)
    call check_no_error(t, 'second run', error)
    values = [values, more]
    do i = 1, 2
      do j = 1, 2
        call check_close(t, 'eigenvalue '//str(i)//', which comes twice', minval(values), alone(i), relative=1e-10_dp)
        values(minloc(values, 1)) = huge(values)
      end do
    end do
    do i = 1, 2
      call pencil%times(others(:, i), weighted)
      do j = 1, 2
        call check_close(t, 'at right angles', dot_product(vectors(:, j), weighted), 0.0_dp, absolute=1e-10_dp)
      end do
    end do
  end subroutine twins

  !> What a matrix held is freed when it is factored again.
  subroutine used_again(t)
    type(tally_t), intent(inout) :: t
    type(sample_t) :: sample
    type(sparse_t) :: matrix
    type(error_t), allocatable :: error
    real(dp), allocatable :: x(:), wanted(:)
    integer :: n, i

    do n = 20, 40, 20
      call make_sample(n, 5, 30, sample)
      call factor_sample(sample, matrix, error)
      wanted = [(1.0_dp/i, i=1, n)]
      x = matmul(sample%dense, wanted)
      call matrix%solve(x, error)
      call check_close(t, 'factored again', maxval(abs(x - wanted)), 0.0_dp, absolute=1e-12_dp)
    end do
  end subroutine used_again

  subroutine refusals(t)
    type(tally_t), intent(inout) :: t
    type(sample_t) :: sample
    type(sparse_t) :: matrix
    type(error_t), allocatable :: error
    real(dp), allocatable :: values(:)

    call make_sample(400, 16, 800, sample)
    call factor(sample%n, sample%first, sample%at, sample%values, 1e5_dp, 'the sample', matrix, error)
    call check_error(t, 'too large', error, 'the sample needs 0.00')
    call check_error(t, 'too large: the limit', error, ' GB; at most 0.0001 GB')
    if (allocated(error)) call check_equal(t, 'code of too large', error%code, code_memory)
    if (allocated(error)) deallocate (error)
    values = sample%values
    values(size(values)) = -1e6_dp
    call factor(sample%n, sample%first, sample%at, values, 1e9_dp, 'the sample', matrix, error)
    call check_error(t, 'indefinite', error, 'not positive definite')
    if (allocated(error)) call check_equal(t, 'code of indefinite', error%code, code_numerical)
    if (allocated(error)) deallocate (error)
    ! Singular: an unknown without stiffness.
    values = sample%values
    values = 0
    call factor(sample%n, sample%first, sample%at, values, 1e9_dp, 'the sample', matrix, error)
    call check_error(t, 'singular', error, 'not positive definite')
  end subroutine refusals
end module test_sparse
