!> Natural modes of a body of equal sectors for each nodal diameter and either symmetry about the middle plane.
!>
!> For one nodal diameter n only the small dense matrix of the near cut is complex, and is factored for each n (see
!> gearsweep_body_modes_cyclic).
module gearsweep_body_modes_sector_modes
  use, intrinsic :: iso_c_binding, only: c_ptr
  use gearsweep_base, only: begin_products, claim_memory, code_input, code_numerical, dp, end_products, error_t, fail, &
    lowest_eigenpairs, pencil_t, pi, residual_of, str, wants_stop, work_bytes, zpotrf, zpotrs
  use gearsweep_elastic, only: material_t
  use gearsweep_body_modes_cyclic, only: cyclic_t, make_cyclic, unknowns_each
  use gearsweep_body_modes_sector, only: brick_nodes, sector_t
  implicit none
  private
  public :: sector_mode_t, support_t, find_sector_modes, rigid_motions

  integer, parameter, public :: radial = 1, tangential = 2, axial = 3
  !> Symmetric: displacements in the plane equal on both sides of the middle plane, axial ones opposite; antisymmetric: the reverse.
  integer, parameter, public :: symmetric = 1, antisymmetric = 2
  !> Additional vectors of the iteration's basis: with fewer it needs restarts, with more it finds twins (see find_distinct).
  integer, parameter :: basis_extra = 16

  !> Support of the bore.
  type :: support_t
    logical :: held(3) = .true.                  !< true if the radial, tangential, axial displacement is fixed
  end type support_t

  type :: sector_mode_t
    real(dp) :: frequency = 0                    !< frequency, Hz
    real(dp) :: residual = 0                     !< residual |K u - w^2 M u| / |K u|
    real(dp) :: share(3) = 0                     !< parts of the kinetic energy: radial, tangential, axial
    integer :: diameter = 0                      !< nodal diameter n
    integer :: symmetry = symmetric
    integer :: order = 0                         !< 1, 2 ...: order from the lowest of this nodal diameter and symmetry
    integer :: count = 1                         !< 2: there is another mode of the same frequency, a quarter wave further
    !> Radial, tangential and axial displacement of the nodes on the front, for unit modal mass of the complete body, kg**-0.5 (3,
    !> nodes of the plane); the k-th sector from here has the real part of exp(i n k pitch) times these.
    complex(dp), allocatable :: shape(:, :)
  end type sector_mode_t

  !> Pencil of a sector for one nodal diameter. The eigenvalue problem is Hermitian; with real and imaginary part as one vector of
  !> twice the length it is real and symmetric, and has each eigenvalue twice: ARPACK's Lanczos iteration and MUMPS' real factor
  !> apply unchanged, while ARPACK's complex iteration is for general matrices. Without an imaginary part (`parts` = 1: n = 0, and n
  !> half the number of sectors) eigenvalues are simple.
  type, extends(pencil_t) :: diameter_t
    type(cyclic_t), pointer :: cyclic => null()
    integer :: diameter = 0
    integer :: parts = 2
    real(dp) :: phase(2) = [1.0_dp, 0.0_dp]      !< cosine and sine of n pitch
    complex(dp), allocatable, private :: border(:, :)  !< factored border matrix
  contains
    procedure :: solve => solve_stiffness
    procedure :: times => mass_times
    procedure :: stiffness_times
    procedure :: spread_out
    procedure, private :: gather
  end type diameter_t

contains

  !> Finds the lowest `count` elastic modes of each nodal diameter `diameters(1)` to `diameters(2)` and each symmetry; rigid-body
  !> modes are omitted.
  !>
  !> `modes(count, 2, diameters(1):diameters(2))`: by order, symmetry and nodal diameter; not allocated if the caller's flag
  !> `stop` ended the search. `error`: code 5 if the iteration does not converge, 6 if memory is short, 2 if the grid is too coarse
  !> for so many.
  subroutine find_sector_modes(sector, material, support, count, diameters, stop, modes, error)
    type(sector_t), intent(in) :: sector
    type(material_t), intent(in) :: material
    type(support_t), intent(in) :: support
    integer, intent(in) :: count, diameters(2)
    type(c_ptr), intent(in) :: stop
    type(sector_mode_t), allocatable, intent(out) :: modes(:, :, :)
    type(error_t), allocatable, intent(inout) :: error
    type(cyclic_t), target :: cyclic
    type(diameter_t) :: pencil
    real(dp), allocatable :: values(:), vectors(:, :)
    real(dp) :: outer
    integer :: symmetry, n, k, d
    logical :: held(3, size(sector%x, 2))

    allocate (modes(count, 2, diameters(1):diameters(2)))
    outer = maxval(norm2(sector%x(:2, :), 1))
    do symmetry = symmetric, antisymmetric
      do d = 1, 3
        held(d, :) = (sector%in_bore .and. support%held(d)) .or. &
                     (sector%in_middle .and. (d == axial .eqv. symmetry == symmetric))
      end do
      ! Small compared with any elastic frequency: a hundredth of what a shear wave does in a second over the radius.
      call make_cyclic(sector, material, held, 1e-4_dp*material%young/(material%density*outer**2), cyclic, error)
      do n = diameters(1), diameters(2)
        call prepare_diameter(cyclic, n, pencil, error)
        if (2*(2*count + 2) + basis_extra > pencil%n) call fail(error, code_input, 'number of body modes = '//str(count)// &
          ': the grid is too coarse for so many; must be fewer, or more elements across a tooth')
        if (wants_stop(stop)) deallocate (modes)
        if (allocated(error) .or. .not. allocated(modes)) return
        call claim_memory(work_bytes(pencil%n, count, basis_extra) + 8.0_dp*pencil%n*(4*count + 4) + 200.0_dp*size(sector%x, 2), &
                          'number of body modes = '//str(count), error, blas=.true.)
        call find_distinct(pencil, support, symmetry, count, values, vectors, error)
        if (allocated(error)) return
        do k = 1, count
          modes(k, symmetry, n)%symmetry = symmetry
          modes(k, symmetry, n)%order = k
          call describe(pencil, values(k), vectors(:, k), modes(k, symmetry, n))
        end do
      end do
    end do
  end subroutine find_sector_modes

  !> Number of rigid-body motions of nodal diameter `n` that the support allows, 0 or 1; each with n = 1 counts twice in the
  !> complete body.
  pure integer function rigid_motions(support, symmetry, n)
    type(support_t), intent(in) :: support
    integer, intent(in) :: symmetry, n
    logical :: can_move

    can_move = .false.
    associate (held => support%held)
      if (n == 0 .and. symmetry == symmetric) can_move = .not. held(tangential)
      if (n == 0 .and. symmetry == antisymmetric) can_move = .not. held(axial)
      if (n == 1 .and. symmetry == symmetric) can_move = .not. (held(radial) .or. held(tangential))
      if (n == 1 .and. symmetry == antisymmetric) can_move = .not. any(held)
    end associate
    rigid_motions = merge(1, 0, can_move)
  end function rigid_motions

  !> Finds one vector of each pair of a real problem that has each eigenvalue twice: in exact arithmetic the Krylov space of one
  !> vector has no other. If rounding brings in the second one of a pair, it is dropped, and the iteration continues orthogonally to
  !> all known vectors.
  subroutine find_distinct(pencil, support, symmetry, count, values, vectors, error)
    type(diameter_t), intent(in) :: pencil
    type(support_t), intent(in) :: support
    integer, intent(in) :: symmetry, count
    real(dp), allocatable, intent(out) :: values(:), vectors(:, :)
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: more(:), others(:, :), known(:, :), weighted(:)
    integer :: found, used, k

    if (allocated(error)) return
    allocate (values(count), vectors(pencil%n, count), known(pencil%n, 2*count + 2), weighted(pencil%n))
    used = 0
    found = 0
    if (rigid_motions(support, symmetry, pencil%diameter) > 0) call add_rigid()
    do while (found < count)
      call lowest_eigenpairs(pencil, count - found, known(:, :used), more, others, error, basis_extra)
      if (allocated(error)) return
      do k = 1, size(more)
        call pencil%times(others(:, k), weighted)
        if (sum(matmul(weighted, known(:, :used))**2) > 0.5_dp) cycle
        found = found + 1
        values(found) = more(k)
        vectors(:, found) = others(:, k)
        call add_known(others(:, k))
      end do
    end do

  contains

    !> Adds a vector of unit length, and its product with i.
    subroutine add_known(x)
      real(dp), intent(in) :: x(:)
      integer :: half

      used = used + 1
      known(:, used) = x
      if (pencil%parts == 1) return
      half = pencil%n/2
      used = used + 1
      known(:half, used) = -x(half + 1:)
      known(half + 1:, used) = x(:half)
    end subroutine add_known

    subroutine add_rigid()
      real(dp) :: x(pencil%n)

      call rigid_vector(pencil, symmetry, x)
      call pencil%times(x, weighted)
      call add_known(x/sqrt(dot_product(x, weighted)))
    end subroutine add_rigid
  end subroutine find_distinct

  !> Rigid-body motion of this nodal diameter and symmetry: rotation about the axis, translation along it, translation across it, or
  !> rotation about a diameter.
  pure subroutine rigid_vector(pencil, symmetry, x)
    type(diameter_t), intent(in) :: pencil
    integer, intent(in) :: symmetry
    real(dp), intent(out) :: x(:)
    complex(dp) :: u(3), turn
    real(dp) :: radius
    integer :: p, d, q, own

    own = pencil%n/pencil%parts
    associate (cyclic => pencil%cyclic)
      do p = 1, size(cyclic%equation, 2)
        radius = norm2(cyclic%sector%x(:2, p))
        turn = cmplx(cyclic%frame(1, p), cyclic%frame(2, p), dp)
        if (pencil%diameter == 0) then
          u = [0.0_dp, merge(radius, 0.0_dp, symmetry == symmetric), merge(0.0_dp, 1.0_dp, symmetry == symmetric)]
        else if (symmetry == symmetric) then
          u = turn*[(1.0_dp, 0.0_dp), (0.0_dp, 1.0_dp), (0.0_dp, 0.0_dp)]
        else
          u = turn*[(1.0_dp, 0.0_dp)*cyclic%sector%x(3, p), (0.0_dp, 1.0_dp)*cyclic%sector%x(3, p), cmplx(-radius, 0, dp)]
        end if
        do d = 1, 3
          q = cyclic%equation(d, p)
          if (q == 0 .or. q > own) cycle
          x(q) = real(u(d))
          if (pencil%parts == 2) x(own + q) = aimag(u(d))
        end do
      end do
    end associate
  end subroutine rigid_vector

  !> Computes frequency, residual, energies and shape of an eigenvector.
  subroutine describe(pencil, value, vector, mode)
    type(diameter_t), intent(in) :: pencil
    real(dp), intent(in) :: value, vector(:)
    type(sector_mode_t), intent(inout) :: mode
    real(dp), allocatable :: u(:, :, :)
    real(dp) :: pulled(size(vector)), moved(size(vector)), square, in_all
    integer :: e, part, d

    associate (cyclic => pencil%cyclic)
      call pencil%times(vector, moved)
      call pencil%stiffness_times(vector, pulled)
      pulled = pulled - cyclic%shift*moved
      square = max(0.0_dp, value - cyclic%shift)
      mode%frequency = sqrt(square)/(2*pi)
      mode%residual = residual_of(pulled, square, moved)
      mode%diameter = pencil%diameter
      mode%count = pencil%parts
      call pencil%spread_out(vector, u)
      do e = 1, size(cyclic%mass, 3)
        associate (list => cyclic%sector%element(:, e))
          do part = 1, pencil%parts
            do d = 1, 3
              mode%share(d) = mode%share(d) + dot_product(u(d, part, list), matmul(cyclic%mass(:, :, e), u(d, part, list)))
            end do
          end do
        end associate
      end do
      mode%share = mode%share/sum(mode%share)
      ! Both halves of all sectors; with two parts, the mean square of sine and cosine.
      in_all = 2.0_dp*cyclic%sector%sectors/pencil%parts*dot_product(vector, moved)
      call set_phase(u(:, :, cyclic%sector%front), sqrt(in_all), mode%shape)
    end associate
  end subroutine describe

  !> Rotates the phase of a shape so that a weighted sum of all displacements, with unequal weights, is real and above 0.
  pure subroutine set_phase(u, length, shape)
    real(dp), intent(in) :: u(:, :, :), length
    complex(dp), allocatable, intent(out) :: shape(:, :)
    complex(dp) :: total
    integer :: p, d

    allocate (shape(3, size(u, 3)))
    shape = u(:, 1, :)
    if (size(u, 2) == 2) shape = cmplx(u(:, 1, :), u(:, 2, :), dp)
    total = 0
    do p = 1, size(shape, 2)
      do d = 1, 3
        total = total + (1 + modulo((3*p + d)*0.7548776662466927_dp, 1.0_dp))*shape(d, p)
      end do
    end do
    shape = shape*(conjg(total)/abs(total)/length)
  end subroutine set_phase

  !> Prepares the pencil for nodal diameter `diameter`, 0 to half the number of sectors. `cyclic` must exist as long.
  subroutine prepare_diameter(cyclic, diameter, pencil, error)
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
  end subroutine prepare_diameter

  !> Replaces x by (K + shift M)^-1 x.
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

  !> Computes y = M x.
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

  !> Adds u mass to f for one element, all displacements of a node at once; `extent`: numbers of displacements and of nodes.
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

  !> Rotates from the nodes' own directions to x and y (`way` 1), or back (-1).
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

  !> Computes y = (K + shift M) x.
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

  !> Expands the unknowns to radial, tangential and axial displacements of all nodes, real and imaginary part: `u(3, parts, nodes)`.
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

  !> Gathers forces at all nodes into those of the unknowns: forces of the far cut act on the near one with the phase reversed.
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
end module gearsweep_body_modes_sector_modes
