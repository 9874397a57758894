!> Symmetric positive definite band matrices: factored once, then solved for
!> many right-hand sides.
module gearsweep_band
  use gearsweep_kinds, only: dp
  use gearsweep_error, only: error_t, fail, code_memory, code_numerical
  use gearsweep_lapack, only: dpbtrf, dtbsv, dtrsm, dgemm
  use gearsweep_text, only: str
  implicit none
  private
  public :: band_t, make_band

  !> Lower triangle in LAPACK's band storage: element (i, j) is at a(1+i-j, j).
  type :: band_t
    integer :: n = 0
    integer :: width = 0                         !< sub-diagonals
    real(dp), allocatable :: a(:, :)             !< (width+1, n)
  contains
    procedure :: factor
    procedure :: solve
    procedure :: solve_one
    procedure :: forward
  end type band_t

contains

  !> A zero matrix of order `n`; refuses one that takes more than `most_bytes`.
  subroutine make_band(n, width, most_bytes, matrix, error)
    integer, intent(in) :: n, width
    real(dp), intent(in) :: most_bytes
    type(band_t), intent(out) :: matrix
    type(error_t), allocatable, intent(out) :: error
    real(dp) :: bytes
    integer :: status

    bytes = 8.0_dp*n*(width + 1.0_dp)
    status = 0
    if (bytes <= most_bytes) allocate (matrix%a(width + 1, n), stat=status)
    if (bytes > most_bytes .or. status /= 0) then
      call fail(error, code_memory, '&section elements_across: the grid has '//str(n)//' unknowns and needs '// &
        str(bytes/1e9_dp, 3)//' GB; at most '//str(most_bytes/1e9_dp, 3)//' GB')
      return
    end if
    matrix%n = n
    matrix%width = width
    matrix%a = 0
  end subroutine make_band

  !> Replaces the matrix by its Cholesky factor.
  subroutine factor(matrix, error)
    class(band_t), intent(inout) :: matrix
    type(error_t), allocatable, intent(out) :: error
    integer :: info

    call dpbtrf('L', matrix%n, matrix%width, matrix%a, matrix%width + 1, info)
    if (info /= 0) call fail(error, code_numerical, &
      'the stiffness matrix is not positive definite at unknown '//str(info)//': the body is not held')
  end subroutine factor

  !> Solves for one right-hand side, in place, with the factor.
  subroutine solve_one(matrix, x)
    class(band_t), intent(in) :: matrix
    real(dp), intent(inout), contiguous :: x(:)

    call dtbsv('L', 'N', 'N', matrix%n, matrix%width, matrix%a, matrix%width + 1, x, 1)
    call dtbsv('L', 'T', 'N', matrix%n, matrix%width, matrix%a, matrix%width + 1, x, 1)
  end subroutine solve_one

  !> Solves for the columns of `x`, in place, with the factor.
  subroutine solve(matrix, x)
    class(band_t), intent(in) :: matrix
    real(dp), intent(inout), contiguous :: x(:, :)

    call sweep(matrix, size(x, 2), x, 1, .false.)
    call sweep(matrix, size(x, 2), x, 1, .true.)
  end subroutine solve

  !> Only L y = x, in place; rows before `first` are zero in all columns of x.
  !> Two such solutions y1, y2 give x1' A^-1 x2 = y1' y2.
  subroutine forward(matrix, x, first)
    class(band_t), intent(in) :: matrix
    real(dp), intent(inout), contiguous :: x(:, :)
    integer, intent(in) :: first

    call sweep(matrix, size(x, 2), x, first, .false.)
  end subroutine forward

  !> One triangular sweep in blocks, so that matrix products do the work. Within
  !> a block of columns the band is a triangle, a rectangle and a second
  !> triangle, each dense when read with the leading dimension less one.
  subroutine sweep(matrix, sides, x, first, backward)
    type(band_t), intent(in) :: matrix
    integer, intent(in) :: sides, first
    real(dp), intent(inout) :: x(matrix%n, sides)
    logical, intent(in) :: backward
    integer, parameter :: most_columns = 32
    integer :: b, blocks, block, j, columns

    block = max(1, min(most_columns, matrix%width))
    blocks = (matrix%n - first)/block + 1
    do b = 1, blocks
      j = first + merge(blocks - b, b - 1, backward)*block
      columns = min(block, matrix%n - j + 1)
      if (backward) call below(matrix, sides, x, j, columns, backward)
      call dtrsm('L', 'L', merge('T', 'N', backward), 'N', columns, sides, 1.0_dp, &
                 matrix%a(1, j), matrix%width, x(j, 1), matrix%n)
      if (.not. backward) call below(matrix, sides, x, j, columns, backward)
    end do
  end subroutine sweep

  !> What couples the block of columns at j with the rows below it.
  subroutine below(matrix, sides, x, j, columns, backward)
    type(band_t), intent(in) :: matrix
    integer, intent(in) :: sides, j, columns
    real(dp), intent(inout) :: x(matrix%n, sides)
    logical, intent(in) :: backward
    real(dp) :: corner(columns, columns)
    integer :: left, full, tail, c, t

    left = matrix%n - j - columns + 1
    full = min(matrix%width + 1 - columns, left)
    tail = min(columns - 1, left - full)
    if (full > 0) call product(matrix%a(columns + 1, j), matrix%width, full, j + columns)
    if (tail <= 0) return
    corner = 0
    do c = 2, columns
      do t = 1, min(tail, c - 1)
        corner(t, c) = matrix%a(matrix%width + 2 + t - c, j + c - 1)
      end do
    end do
    call product(corner, columns, tail, j + columns + full)

  contains

    subroutine product(a, lda, rows, at)
      integer, intent(in) :: lda, rows, at
      real(dp), intent(in) :: a(lda, *)

      if (backward) then
        call dgemm('T', 'N', columns, sides, rows, -1.0_dp, a, lda, x(at, 1), matrix%n, &
                   1.0_dp, x(j, 1), matrix%n)
      else
        call dgemm('N', 'N', rows, sides, columns, -1.0_dp, a, lda, x(j, 1), matrix%n, &
                   1.0_dp, x(at, 1), matrix%n)
      end if
    end subroutine product
  end subroutine below
end module gearsweep_band
