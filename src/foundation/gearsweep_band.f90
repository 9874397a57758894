!> Symmetric positive definite band matrices: factored once, then solved for
!> many right-hand sides.
module gearsweep_band
  use gearsweep_kinds, only: dp
  use gearsweep_blas, only: begin_products, end_products
  use gearsweep_error, only: error_t, fail, code_memory, code_numerical
  use gearsweep_memory, only: claim_memory
  use gearsweep_lapack, only: dpbtrf, dtrsm, dgemm
  use gearsweep_text, only: str
  implicit none
  private
  public :: band_t, make_band

  !> Lower triangle in LAPACK's band storage: element (i, j) is at a(1+i-j, j).
  type :: band_t
    integer :: n = 0
    integer :: width = 0                         !< sub-diagonals
    real(dp), allocatable :: a(:, :)             !< (width+1, n)
    integer, allocatable :: last(:)              !< row that each column of the factor reaches down to
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
    ! Of a block of columns while it is factored.
    integer, parameter :: columns = 32
    real(dp) :: bytes
    character(:), allocatable :: limit
    integer :: status

    bytes = 8.0_dp*n*(width + 1.0_dp)
    if (bytes <= most_bytes) call claim_memory(bytes + 4.0_dp*n + 16.0_dp*columns*(width + columns), &
      '&section elements_across: the grid with '//str(n)//' unknowns', error, blas=.true.)
    if (allocated(error)) return
    status = 0
    if (bytes <= most_bytes) allocate (matrix%a(width + 1, n), stat=status)
    if (bytes > most_bytes .or. status /= 0) then
      limit = 'at most '//str(most_bytes/1e9_dp, 3)//' GB'
      if (status /= 0) limit = 'the machine does not have it'
      call fail(error, code_memory, '&section elements_across: the grid has '//str(n)//' unknowns and needs '// &
        str(bytes/1e9_dp, 3)//' GB; '//limit)
      return
    end if
    matrix%n = n
    matrix%width = width
    matrix%a = 0
  end subroutine make_band

  !> Replaces the matrix by its Cholesky factor, block of columns by block, as
  !> LAPACK's dpbtrf does; but no further down than the matrix reaches there.
  subroutine factor(matrix, error)
    class(band_t), intent(inout) :: matrix
    type(error_t), allocatable, intent(out) :: error
    real(dp), allocatable :: panel(:, :)
    integer :: j, columns, rows, info

    call find_reach(matrix)
    call begin_products()
    do j = 1, matrix%n, block_size(matrix)
      columns = min(block_size(matrix), matrix%n - j + 1)
      call dpbtrf('L', columns, columns - 1, matrix%a(1, j), matrix%width + 1, info)
      if (info /= 0) then
        call fail(error, code_numerical, &
          'the stiffness matrix is not positive definite at unknown '//str(j - 1 + info)//': the body is not held')
        exit
      end if
      rows = matrix%last(j + columns - 1) - (j + columns - 1)
      if (rows == 0) cycle
      call take_panel(matrix, j, columns, rows, panel)
      call dtrsm('R', 'L', 'T', 'N', rows, columns, 1.0_dp, matrix%a(1, j), matrix%width, panel, rows)
      call put_panel(matrix, j, columns, rows, panel)
      call subtract_square(matrix, j + columns, columns, rows, panel)
    end do
    call end_products()
  end subroutine factor

  !> Below row `last(j)` column j of the factor is zero.
  subroutine find_reach(matrix)
    type(band_t), intent(inout) :: matrix
    integer :: i, j, last

    allocate (matrix%last(matrix%n))
    last = 0
    do j = 1, matrix%n
      do i = min(matrix%n, j + matrix%width), max(last, j) + 1, -1
        if (abs(matrix%a(1 + i - j, j)) > 0) exit
      end do
      last = i
      matrix%last(j) = last
    end do
  end subroutine find_reach

  pure integer function block_size(matrix)
    type(band_t), intent(in) :: matrix
    integer, parameter :: most_columns = 32

    block_size = max(1, min(most_columns, matrix%width))
  end function block_size

  !> The rows below the triangle of a block of columns, as a rectangle.
  pure subroutine take_panel(matrix, j, columns, rows, panel)
    type(band_t), intent(in) :: matrix
    integer, intent(in) :: j, columns, rows
    real(dp), allocatable, intent(out) :: panel(:, :)
    integer :: c, m

    allocate (panel(rows, columns))
    do c = 1, columns
      m = min(rows, matrix%width - columns + c)
      panel(:m, c) = matrix%a(columns - c + 2:columns - c + 1 + m, j + c - 1)
      panel(m + 1:, c) = 0
    end do
  end subroutine take_panel

  pure subroutine put_panel(matrix, j, columns, rows, panel)
    type(band_t), intent(inout) :: matrix
    integer, intent(in) :: j, columns, rows
    real(dp), intent(in) :: panel(:, :)
    integer :: c, m

    do c = 1, columns
      m = min(rows, matrix%width - columns + c)
      matrix%a(columns - c + 2:columns - c + 1 + m, j + c - 1) = panel(:m, c)
    end do
  end subroutine put_panel

  !> Subtracts `panel` times its transpose from the triangle that begins at column j.
  subroutine subtract_square(matrix, j, depth, rows, panel)
    type(band_t), intent(inout) :: matrix
    integer, intent(in) :: j, depth, rows
    real(dp), intent(in) :: panel(rows, depth)
    real(dp) :: square(depth, depth)
    integer :: k, c, columns, left

    do k = 1, rows, depth
      columns = min(depth, rows - k + 1)
      call dgemm('N', 'T', columns, columns, depth, 1.0_dp, panel(k, 1), rows, panel(k, 1), rows, 0.0_dp, square, depth)
      do c = 1, columns
        associate (column => matrix%a(:columns - c + 1, j + k + c - 2))
          column = column - square(c:columns, c)
        end associate
      end do
      left = rows - k - columns + 1
      if (left > 0) call dgemm('N', 'T', left, columns, depth, -1.0_dp, panel(k + columns, 1), rows, &
                               panel(k, 1), rows, 1.0_dp, matrix%a(columns + 1, j + k - 1), matrix%width)
    end do
  end subroutine subtract_square

  !> Solves for one right-hand side, in place, with the factor.
  subroutine solve_one(matrix, x)
    class(band_t), intent(in) :: matrix
    real(dp), intent(inout), contiguous :: x(:)

    call sweep(matrix, 1, x, 1, .false.)
    call sweep(matrix, 1, x, 1, .true.)
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
    integer :: b, blocks, block, j, columns

    block = block_size(matrix)
    blocks = (matrix%n - first)/block + 1
    call begin_products()
    do b = 1, blocks
      j = first + merge(blocks - b, b - 1, backward)*block
      columns = min(block, matrix%n - j + 1)
      if (backward) call below(matrix, sides, x, j, columns, backward)
      call dtrsm('L', 'L', merge('T', 'N', backward), 'N', columns, sides, 1.0_dp, &
                 matrix%a(1, j), matrix%width, x(j, 1), matrix%n)
      if (.not. backward) call below(matrix, sides, x, j, columns, backward)
    end do
    call end_products()
  end subroutine sweep

  !> What couples the block of columns at j with the rows below it.
  subroutine below(matrix, sides, x, j, columns, backward)
    type(band_t), intent(in) :: matrix
    integer, intent(in) :: sides, j, columns
    real(dp), intent(inout) :: x(matrix%n, sides)
    logical, intent(in) :: backward
    real(dp) :: corner(columns, columns)
    integer :: left, full, tail, c, t

    left = matrix%last(j + columns - 1) - j - columns + 1
    full = min(matrix%width + 1 - columns, left)
    tail = left - full
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
