!> A body of equal sectors (gearsweep_cyclic) for one nodal diameter n: only the small dense matrix of the near cut is
!> complex, and factored anew for each n.
module gearsweep_diameter
  use gearsweep_arpack, only: pencil_t
  use gearsweep_blas, only: begin_products, end_products
  use gearsweep_cyclic, only: cyclic_t, unknowns_each
  use gearsweep_error, only: code_numerical, error_t, fail
  use gearsweep_h20, only: brick_nodes
  use gearsweep_kinds, only: dp, pi
  use gearsweep_text, only: str
  implicit none
  private
  public :: diameter_t, take_diameter

  !> Its pencil for one nodal diameter. The eigenvalue problem is Hermitian; with the real and the imaginary part as two
  !> vectors one below the other it is real and symmetric, of twice the order, and has each eigenvalue twice: ARPACK's
  !> Lanczos iteration and MUMPS' real factor serve it as they are, while a complex iteration would be one for general
  !> matrices. Without an imaginary part (`parts` = 1: n = 0, and n half the number of sectors) it stays single.
  type, extends(pencil_t) :: diameter_t
    type(cyclic_t), pointer :: cyclic => null()
    integer :: diameter = 0
    integer :: parts = 2
    real(dp) :: phase(2) = [1.0_dp, 0.0_dp]      !< cosine and sine of n pitch
    complex(dp), allocatable, private :: border(:, :)  !< factored
  contains
    procedure :: solve => solve_stiffness
    procedure :: times => mass_times
    procedure :: stiffness_times
    procedure :: spread_out
    procedure, private :: gather
  end type diameter_t

  interface
    !> LAPACK: factors a Hermitian positive definite matrix (Cholesky).
    subroutine zpotrf(uplo, n, a, lda, info)
      import :: dp
      character, intent(in) :: uplo
      integer, intent(in) :: n, lda
      complex(dp), intent(inout) :: a(lda, n)
      integer, intent(out) :: info
    end subroutine zpotrf

    !> LAPACK: solves with it.
    subroutine zpotrs(uplo, n, nrhs, a, lda, b, ldb, info)
      import :: dp
      character, intent(in) :: uplo
      integer, intent(in) :: n, nrhs, lda, ldb
      complex(dp), intent(in) :: a(lda, n)
      complex(dp), intent(inout) :: b(ldb, nrhs)
      integer, intent(out) :: info
    end subroutine zpotrs
  end interface

contains

  !> The pencil for nodal diameter `diameter`, 0 to half the number of sectors. `cyclic` must live as long.
  subroutine take_diameter(cyclic, diameter, pencil, error)
    type(cyclic_t), intent(in), target :: cyclic
    integer, intent(in) :: diameter
    type(diameter_t), intent(inout) :: pencil
    type(error_t), allocatable, intent(inout) :: error
    complex(dp) :: phase
    integer :: info

    if (allocated(error)) return
    pencil%cyclic => cyclic
    pencil%diameter = diameter
    pencil%parts = merge(1, 2, diameter == 0 .or. 2*diameter == cyclic%sector%sectors)
    pencil%n = pencil%parts*(cyclic%inner + cyclic%cut)
    pencil%phase = [cos(2*pi*diameter/cyclic%sector%sectors), sin(2*pi*diameter/cyclic%sector%sectors)]
    if (pencil%parts == 1) pencil%phase = [merge(1.0_dp, -1.0_dp, diameter == 0), 0.0_dp]
    phase = cmplx(pencil%phase(1), pencil%phase(2), dp)
    associate (m => cyclic%cut, s => cyclic%border)
      pencil%border = s(:m, :m) + s(m + 1:, m + 1:) + phase*s(:m, m + 1:) + conjg(phase)*s(m + 1:, :m)
      call begin_products()
      call zpotrf('L', m, pencil%border, m, info)
      call end_products()
    end associate
    if (info /= 0) call fail(error, code_numerical, 'the stiffness of nodal diameter '//str(diameter)//' is not positive definite')
  end subroutine take_diameter

  !> x becomes (K + shift M)^-1 x.
  subroutine solve_stiffness(pencil, x, error)
    class(diameter_t), intent(in) :: pencil
    real(dp), intent(inout), contiguous :: x(:)
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: sides(:, :), reduced(:, :)
    complex(dp), allocatable :: u(:, :)
    complex(dp) :: phase
    integer :: part, own, info

    associate (cyclic => pencil%cyclic, m => pencil%cyclic%cut, parts => pencil%parts)
      own = cyclic%inner + m
      phase = cmplx(pencil%phase(1), pencil%phase(2), dp)
      allocate (sides(own + m, parts), source=0.0_dp)
      allocate (reduced(2*m, parts), u(m, 1))
      do part = 1, parts
        sides(:own, part) = x((part - 1)*own + 1:part*own)
      end do
      call cyclic%factor%condense(sides, reduced, error)
      if (allocated(error)) return
      u(:, 1) = combined(reduced(:m, :)) + conjg(phase)*combined(reduced(m + 1:, :))
      call begin_products()
      call zpotrs('L', m, 1, pencil%border, m, u, m, info)
      call end_products()
      reduced(:m, 1) = real(u(:, 1))
      reduced(m + 1:, 1) = real(phase*u(:, 1))
      if (parts == 2) then
        reduced(:m, 2) = aimag(u(:, 1))
        reduced(m + 1:, 2) = aimag(phase*u(:, 1))
      end if
      call cyclic%factor%expand(sides, reduced, error)
      do part = 1, parts
        x((part - 1)*own + 1:part*own) = sides(:own, part)
      end do
    end associate

  contains

    pure function combined(part) result(z)
      real(dp), intent(in) :: part(:, :)
      complex(dp) :: z(size(part, 1))

      z = part(:, 1)
      if (size(part, 2) == 2) z = cmplx(part(:, 1), part(:, 2), dp)
    end function combined
  end subroutine solve_stiffness

  !> y = M x.
  subroutine mass_times(pencil, x, y)
    class(diameter_t), intent(in) :: pencil
    real(dp), intent(in) :: x(:)
    real(dp), intent(out) :: y(:)
    real(dp), allocatable :: u(:, :, :), f(:, :, :)
    integer :: e

    call pencil%spread_out(x, u)
    call turn(u, pencil%cyclic%frame, 1)
    allocate (f, mold=u)
    f = 0
    associate (element => pencil%cyclic%sector%element, mass => pencil%cyclic%mass)
      do e = 1, size(mass, 3)
        call add_products([size(u, 1)*size(u, 2), size(u, 3)], element(:, e), mass(:, :, e), u, f)
      end do
    end associate
    call turn(f, pencil%cyclic%frame, -1)
    call pencil%gather(f, y)
  end subroutine mass_times

  !> f = f + u mass for one element, all displacements of a node at once: `extent` tells how many, and how many nodes.
  pure subroutine add_products(extent, list, mass, u, f)
    integer, intent(in) :: extent(2), list(brick_nodes)
    real(dp), intent(in) :: mass(brick_nodes, brick_nodes), u(extent(1), extent(2))
    real(dp), intent(inout) :: f(extent(1), extent(2))
    real(dp) :: from(extent(1), brick_nodes), sum(extent(1))
    integer :: i, j

    do i = 1, brick_nodes
      from(:, i) = u(:, list(i))
    end do
    do j = 1, brick_nodes
      sum = 0
      do i = 1, brick_nodes
        sum = sum + from(:, i)*mass(i, j)
      end do
      f(:, list(j)) = f(:, list(j)) + sum
    end do
  end subroutine add_products

  !> From the nodes' own directions to x and y (`way` 1), or back (-1).
  pure subroutine turn(u, frame, way)
    real(dp), intent(inout) :: u(:, :, :)
    real(dp), intent(in) :: frame(:, :)
    integer, intent(in) :: way
    real(dp) :: first
    integer :: p, part

    do p = 1, size(u, 3)
      do part = 1, size(u, 2)
        first = frame(1, p)*u(1, part, p) - way*frame(2, p)*u(2, part, p)
        u(2, part, p) = frame(1, p)*u(2, part, p) + way*frame(2, p)*u(1, part, p)
        u(1, part, p) = first
      end do
    end do
  end subroutine turn

  !> y = (K + shift M) x.
  subroutine stiffness_times(pencil, x, y)
    class(diameter_t), intent(in) :: pencil
    real(dp), intent(in) :: x(:)
    real(dp), intent(out) :: y(:)
    real(dp), allocatable :: u(:, :, :), f(:, :, :)
    real(dp) :: product(3, brick_nodes)
    integer :: e, part

    call pencil%spread_out(x, u)
    allocate (f, mold=u)
    f = 0
    do e = 1, size(pencil%cyclic%stiffness, 3)
      associate (list => pencil%cyclic%sector%element(:, e))
        do part = 1, pencil%parts
          product = reshape(matmul(pencil%cyclic%stiffness(:, :, e), reshape(u(:, part, list), [unknowns_each])), &
                            [3, brick_nodes])
          f(:, part, list) = f(:, part, list) + product
        end do
      end associate
    end do
    call pencil%gather(f, y)
  end subroutine stiffness_times

  !> Unknowns as radial, tangential and axial displacements of all nodes, real and imaginary part: `u(3, parts, nodes)`.
  pure subroutine spread_out(pencil, x, u)
    class(diameter_t), intent(in) :: pencil
    real(dp), intent(in) :: x(:)
    real(dp), allocatable, intent(out) :: u(:, :, :)
    real(dp) :: z(2)
    integer :: p, d, q, own, parts

    parts = pencil%parts
    own = pencil%n/parts
    allocate (u(3, parts, size(pencil%cyclic%equation, 2)))
    do p = 1, size(u, 3)
      do d = 1, 3
        q = pencil%cyclic%equation(d, p)
        z = 0
        if (q > 0 .and. q <= own) then
          z(:parts) = x(q::own)
        else if (q > own) then
          z(:parts) = x(q - pencil%cyclic%cut::own)
          z = [pencil%phase(1)*z(1) - pencil%phase(2)*z(2), pencil%phase(1)*z(2) + pencil%phase(2)*z(1)]
        end if
        u(d, :, p) = z(:parts)
      end do
    end do
  end subroutine spread_out

  !> Forces at all nodes as those of the unknowns: the far cut's act on the near one's with the phase turned back.
  pure subroutine gather(pencil, f, y)
    class(diameter_t), intent(in) :: pencil
    real(dp), intent(in) :: f(:, :, :)
    real(dp), intent(out) :: y(:)
    real(dp) :: z(2)
    integer :: p, d, q, own, parts

    parts = pencil%parts
    own = pencil%n/parts
    y = 0
    do p = 1, size(f, 3)
      do d = 1, 3
        q = pencil%cyclic%equation(d, p)
        if (q == 0) cycle
        z = 0
        z(:parts) = f(d, :, p)
        if (q > own) then
          q = q - pencil%cyclic%cut
          z = [pencil%phase(1)*z(1) + pencil%phase(2)*z(2), pencil%phase(1)*z(2) - pencil%phase(2)*z(1)]
        end if
        y(q::own) = y(q::own) + z(:parts)
      end do
    end do
  end subroutine gather
end module gearsweep_diameter
