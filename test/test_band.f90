!> Band matrices against dense products.
module test_band
  use gearsweep_band, only: band_t, make_band
  use gearsweep_error, only: error_t
  use gearsweep_kinds, only: dp
  use gearsweep_text, only: str
  use testing, only: tally_t, check_true, check_close, check_error, check_no_error
  implicit none
  private
  public :: run

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t

    if (t%wants('solves')) call solves(t, 1, 1)
    if (t%wants('solves')) call solves(t, 7, 3)
    if (t%wants('solves')) call solves(t, 40, 32)
    if (t%wants('solves')) call solves(t, 150, 33)
    if (t%wants('solves')) call solves(t, 200, 100)
    if (t%wants('solves')) call solves(t, 60, 90)
    if (t%wants('refusals')) call refusals(t)
  end subroutine run

  !> A matrix of order n with pseudo-random entries within the width.
  subroutine make_sample(n, width, matrix, dense)
    integer, intent(in) :: n, width
    type(band_t), intent(out) :: matrix
    real(dp), intent(out) :: dense(n, n)
    type(error_t), allocatable :: error
    integer :: i, j

    call make_band(n, width, 1e9_dp, matrix, error)
    dense = 0
    do j = 1, n
      do i = j, min(n, j + width)
        dense(i, j) = merge(2.0_dp*width + 1, sin(1.7_dp*i*j), i == j)
        dense(j, i) = dense(i, j)
        matrix%a(1 + i - j, j) = dense(i, j)
      end do
    end do
  end subroutine make_sample

  subroutine solves(t, n, width)
    type(tally_t), intent(inout) :: t
    integer, intent(in) :: n, width
    type(band_t) :: matrix
    type(error_t), allocatable :: error
    real(dp) :: dense(n, n), wanted(n, 3), x(n, 3), one(n), energy
    character(:), allocatable :: name
    integer :: i, j

    name = ', order '//str(n)//', width '//str(width)
    call make_sample(n, width, matrix, dense)
    do j = 1, 3
      wanted(:, j) = [(cos(real(i*j, dp)), i=1, n)]
    end do
    call matrix%factor(error)
    call check_no_error(t, 'factor'//name, error)
    x = matmul(dense, wanted)
    one = x(:, 2)
    call matrix%solve(x)
    call check_close(t, 'many right-hand sides'//name, maxval(abs(x - wanted)), 0.0_dp, absolute=1e-12_dp)
    call matrix%solve_one(one)
    call check_close(t, 'one right-hand side'//name, maxval(abs(one - wanted(:, 2))), 0.0_dp, absolute=1e-12_dp)
    ! Loads on the last third only.
    x = matmul(dense, wanted)
    x(:2*n/3, :) = 0
    one = x(:, 1)
    call matrix%solve_one(one)
    energy = dot_product(one, x(:, 2))
    call matrix%forward(x, 2*n/3 + 1)
    call check_close(t, 'forward sweep'//name, dot_product(x(:, 1), x(:, 2)), energy, relative=1e-11_dp, absolute=1e-12_dp)
  end subroutine solves

  subroutine refusals(t)
    type(tally_t), intent(inout) :: t
    type(band_t) :: matrix
    type(error_t), allocatable :: error
    real(dp) :: dense(5, 5)

    call make_band(1000000, 10000, 1e9_dp, matrix, error)
    call check_error(t, 'too large', error, '80 GB; at most 1 GB')
    call make_sample(5, 2, matrix, dense)
    matrix%a(1, 3) = -1
    call matrix%factor(error)
    call check_error(t, 'indefinite', error, 'not positive definite at unknown 3')
    call check_true(t, 'kept its order', matrix%n == 5)
  end subroutine refusals
end module test_band
