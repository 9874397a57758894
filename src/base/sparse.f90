!> Sparse symmetric positive definite matrices: factored once by MUMPS, then solved for many right-hand sides.
!>
!> MUMPS is a multifrontal method (Amestoy, Duff, L'Excellent, Koster 2001, SIAM J. Matrix Anal. Appl. 23). The matrix is a sum of
!> small dense ones, as from finite elements, so that it needs no assembly of its own.
module gearsweep_base_sparse
  use, intrinsic :: iso_c_binding, only: c_associated, c_double, c_int, c_null_ptr, c_ptr
  use gearsweep_base_error, only: code_memory, code_numerical, error_t, fail
  use gearsweep_base_kinds, only: dp
  use gearsweep_base_memory, only: claim_memory
  use gearsweep_base_text, only: str
  implicit none
  private
  public :: sparse_t, elements_t, factor, factor_inner

  !> Factored matrix. It must not be copied: the first copy to end would free the factor of both.
  type :: sparse_t
    integer :: n = 0                             !< order
    type(c_ptr), private :: factor = c_null_ptr
    ! Read by MUMPS at each call.
    integer(c_int), pointer, contiguous, private :: first(:) => null(), at(:) => null(), kept(:) => null()
  contains
    generic :: solve => solve_one, solve_many
    procedure :: condense, expand
    procedure :: free
    procedure, private :: solve_one, solve_many
    final :: end_of_life
  end type sparse_t

  !> Dense symmetric matrices of elements in the form of `factor`.
  type :: elements_t
    integer, allocatable :: first(:), at(:)
    real(dp), allocatable :: values(:)
    integer, private :: elements = 0, unknowns = 0, entries = 0
  contains
    procedure :: begin, add, finish
  end type elements_t

  !> Number of right sides solved at a time: more need memory, and save little time.
  integer, parameter :: most_columns = 32

  interface
    type(c_ptr) function c_analyse(n, elements, first, at, kept, list, bytes, info, detail) &
      bind(c, name='gearsweep_sparse_analyse')
      import :: c_double, c_int, c_ptr
      integer(c_int), value :: n, elements, kept
      integer(c_int), intent(in) :: first(*), at(*), list(*)
      real(c_double), intent(out) :: bytes
      integer(c_int), intent(out) :: info, detail
    end function c_analyse

    integer(c_int) function c_factor(matrix, values, schur, negative, detail) bind(c, name='gearsweep_sparse_factor')
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: matrix
      real(c_double), intent(in) :: values(*)
      real(c_double), intent(inout) :: schur(*)
      integer(c_int), intent(out) :: negative, detail
    end function c_factor

    integer(c_int) function c_solve(matrix, sides, columns, x, part, kept, detail) bind(c, name='gearsweep_sparse_solve')
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: matrix
      integer(c_int), value :: sides, columns, part
      real(c_double), intent(inout) :: x(*), kept(*)
      integer(c_int), intent(out) :: detail
    end function c_solve

    subroutine c_free(matrix) bind(c, name='gearsweep_sparse_free')
      import :: c_ptr
      type(c_ptr), value :: matrix
    end subroutine c_free
  end interface

contains

  !> Begins a list of at most `elements` elements with `size` unknowns each, and of one more with `larger` unknowns.
  pure subroutine begin(self, elements, size, larger)
    class(elements_t), intent(inout) :: self
    integer, intent(in) :: elements, size
    integer, intent(in), optional :: larger
    integer :: more

    more = 0
    if (present(larger)) more = larger
    allocate (self%first(elements + 1 + min(1, more)), source=1)
    allocate (self%at(size*elements + more), self%values(size*(size + 1)/2*elements + more*(more + 1)/2))
  end subroutine begin

  !> Adds an element's matrix: of its unknowns `list`, those that are not held (0), and the lower triangle. An element with all
  !> unknowns held is omitted.
  pure subroutine add(self, list, matrix)
    class(elements_t), intent(inout) :: self
    integer, intent(in) :: list(:)
    real(dp), intent(in) :: matrix(:, :)
    integer :: i, j

    if (all(list == 0)) return
    do j = 1, size(list)
      if (list(j) == 0) cycle
      self%unknowns = self%unknowns + 1
      self%at(self%unknowns) = list(j)
      do i = j, size(list)
        if (list(i) == 0) cycle
        self%entries = self%entries + 1
        self%values(self%entries) = matrix(i, j)
      end do
    end do
    self%elements = self%elements + 1
    self%first(self%elements + 1) = self%unknowns + 1
  end subroutine add

  !> Ends the list: drops the places that were not used.
  pure subroutine finish(self)
    class(elements_t), intent(inout) :: self

    self%first = self%first(:self%elements + 1)
    self%at = self%at(:self%unknowns)
  end subroutine finish

  !> Factors the sum of dense symmetric matrices, which must be positive definite.
  !>
  !> `n`: order. `first(elements + 1)`, `at(:)`: element e belongs to the unknowns `at(first(e):first(e + 1) - 1)`. `values(:)`:
  !> the elements' lower triangles one after the other, column by column. `most_bytes`: memory limit of the factor. `what`:
  !> subject of a message. `matrix`: its previous content is freed. `error`: code 6 if memory is too small, 5 if the matrix is not
  !> positive definite.
  subroutine factor(n, first, at, values, most_bytes, what, matrix, error)
    integer, intent(in) :: n, first(:), at(:)
    real(dp), intent(in) :: values(:), most_bytes
    character(*), intent(in) :: what
    type(sparse_t), intent(inout) :: matrix
    type(error_t), allocatable, intent(inout) :: error
    real(dp) :: none(0, 0)

    call make_factor(n, first, at, values, most_bytes, what, matrix, none, error)
  end subroutine factor

  !> Factors all unknowns but the last ones, and computes their dense matrix after elimination of the others (the Schur
  !> complement).
  !>
  !> `schur(kept, kept)`: that matrix, symmetric. The other arguments are those of `factor`; only the available memory limits the
  !> matrix.
  subroutine factor_inner(n, first, at, values, what, matrix, schur, error)
    integer, intent(in) :: n, first(:), at(:)
    real(dp), intent(in) :: values(:)
    character(*), intent(in) :: what
    type(sparse_t), intent(inout) :: matrix
    real(dp), intent(out), contiguous :: schur(:, :)
    type(error_t), allocatable, intent(inout) :: error
    integer :: i

    schur = 0
    call make_factor(n, first, at, values, huge(1.0_dp), what, matrix, schur, error)
    ! MUMPS writes rows up to the diagonal, which here are the parts of columns above it.
    do i = 2, size(schur, 2)
      schur(i, :i - 1) = schur(:i - 1, i)
    end do
  end subroutine factor_inner

  subroutine make_factor(n, first, at, values, most_bytes, what, matrix, schur, error)
    integer, intent(in) :: n, first(:), at(:)
    real(dp), intent(in) :: values(:), most_bytes
    character(*), intent(in) :: what
    type(sparse_t), intent(inout) :: matrix
    real(dp), intent(inout), contiguous :: schur(:, :)
    type(error_t), allocatable, intent(inout) :: error
    real(c_double) :: bytes
    integer(c_int) :: info, detail, negative
    integer :: i

    call matrix%free()
    call claim_memory(400.0_dp*n + 100.0_dp*size(at) + 1e6_dp, what, error, blas=.true.)
    if (allocated(error)) return
    matrix%n = n
    allocate (matrix%first, source=int(first, c_int))
    allocate (matrix%at, source=int(at, c_int))
    allocate (matrix%kept, source=[(int(i, c_int), i=n - size(schur, 2) + 1, n)])
    matrix%factor = c_analyse(int(n, c_int), size(first, kind=c_int) - 1_c_int, matrix%first, matrix%at, &
                              size(matrix%kept, kind=c_int), matrix%kept, bytes, info, detail)
    if (info < 0) then
      call refuse(info, detail, what, error)
    else if (bytes > most_bytes) then
      call fail(error, code_memory, what//' needs '//str(bytes/1e9_dp, 3)//' GB; at most '//str(most_bytes/1e9_dp, 3)//' GB')
    end if
    ! The estimate is in integer megabytes.
    call claim_memory(bytes + 1e6_dp, what, error, blas=.true.)
    if (.not. allocated(error)) then
      info = c_factor(matrix%factor, values, schur, negative, detail)
      if (info < 0) then
        call refuse(info, detail, what, error)
      else if (negative > 0) then
        call refuse_indefinite(error)
      end if
    end if
    if (allocated(error)) call matrix%free()
  end subroutine make_factor

  !> Reports MUMPS' codes of failure, INFOG(1) and INFOG(2), in words.
  subroutine refuse(info, detail, what, error)
    integer(c_int), intent(in) :: info, detail
    character(*), intent(in) :: what
    type(error_t), allocatable, intent(inout) :: error

    select case (info)
    case (-5, -9:-7, -11, -15:-13, -17, -19, -20)
      call fail(error, code_memory, what//' needs more memory than the machine has')
    case (-10, -40)
      call refuse_indefinite(error)
    case default
      call fail(error, code_numerical, what//': MUMPS failed with INFOG(1) = '//str(int(info))//', INFOG(2) = '//str(int(detail)))
    end select
  end subroutine refuse

  subroutine refuse_indefinite(error)
    type(error_t), allocatable, intent(inout) :: error

    call fail(error, code_numerical, 'the stiffness matrix is not positive definite: the body is not held')
  end subroutine refuse_indefinite

  !> Solves for the columns of `x` (n, right sides), in place. Any number of threads may call; they wait for each other. `error`:
  !> code 6 if memory is too small.
  subroutine solve_many(matrix, x, error)
    class(sparse_t), intent(in) :: matrix
    real(dp), intent(inout), contiguous :: x(:, :)
    type(error_t), allocatable, intent(inout) :: error

    call solve_columns(matrix, size(x, 2), x, error)
  end subroutine solve_many

  !> Solves for one right side (n), in place.
  subroutine solve_one(matrix, x, error)
    class(sparse_t), intent(in) :: matrix
    real(dp), intent(inout), contiguous :: x(:)
    type(error_t), allocatable, intent(inout) :: error

    call solve_columns(matrix, 1, x, error)
  end subroutine solve_one

  subroutine solve_columns(matrix, sides, x, error)
    type(sparse_t), intent(in) :: matrix
    integer, intent(in) :: sides
    real(dp), intent(inout) :: x(matrix%n, sides)
    type(error_t), allocatable, intent(inout) :: error
    real(dp) :: none(1)
    character(:), allocatable :: what
    integer(c_int) :: info, detail
    integer :: columns

    if (allocated(error) .or. sides == 0) return
    columns = min(most_columns, sides)
    what = 'the solution for '//str(sides)//' loads on '//str(matrix%n)//' unknowns'
    call claim_memory(24.0_dp*matrix%n*columns + 1e6_dp, what, error, blas=.true.)
    if (allocated(error)) return
    info = c_solve(matrix%factor, int(sides, c_int), int(columns, c_int), x, 0_c_int, none, detail)
    if (info < 0) call refuse(info, detail, what, error)
  end subroutine solve_columns

  !> Reduces right sides `x` (n, columns) to the kept unknowns by elimination of the others: `reduced` (kept, columns). `expand`
  !> must follow, with the same matrix and no other call for it between.
  subroutine condense(matrix, x, reduced, error)
    class(sparse_t), intent(in) :: matrix
    real(dp), intent(inout), contiguous :: x(:, :)
    real(dp), intent(out), contiguous :: reduced(:, :)
    type(error_t), allocatable, intent(inout) :: error

    call solve_part(matrix, 1, x, reduced, error)
  end subroutine condense

  !> Computes all unknowns `x` (n, columns) from the kept ones, `reduced` (kept, columns).
  subroutine expand(matrix, x, reduced, error)
    class(sparse_t), intent(in) :: matrix
    real(dp), intent(inout), contiguous :: x(:, :), reduced(:, :)
    type(error_t), allocatable, intent(inout) :: error

    call solve_part(matrix, 2, x, reduced, error)
  end subroutine expand

  subroutine solve_part(matrix, part, x, reduced, error)
    type(sparse_t), intent(in) :: matrix
    integer, intent(in) :: part
    real(dp), intent(inout), contiguous :: x(:, :), reduced(:, :)
    type(error_t), allocatable, intent(inout) :: error
    integer(c_int) :: info, detail, sides

    if (allocated(error)) return
    sides = size(x, 2, kind=c_int)
    call claim_memory(24.0_dp*size(x) + 1e6_dp, 'the grid', error, blas=.true.)
    if (allocated(error)) return
    info = c_solve(matrix%factor, sides, sides, x, int(part, c_int), reduced, detail)
    if (info < 0) call refuse(info, detail, 'the grid', error)
  end subroutine solve_part

  !> Frees the memory of the matrix.
  subroutine free(matrix)
    class(sparse_t), intent(inout) :: matrix

    if (c_associated(matrix%factor)) call c_free(matrix%factor)
    matrix%factor = c_null_ptr
    if (associated(matrix%first)) deallocate (matrix%first)
    if (associated(matrix%at)) deallocate (matrix%at)
    if (associated(matrix%kept)) deallocate (matrix%kept)
    matrix%n = 0
  end subroutine free

  impure elemental subroutine end_of_life(matrix)
    type(sparse_t), intent(inout) :: matrix

    call matrix%free()
  end subroutine end_of_life
end module gearsweep_base_sparse
