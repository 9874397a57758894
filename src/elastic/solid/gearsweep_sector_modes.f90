!> Natural modes of a body of equal sectors, for each nodal diameter and either symmetry about the middle plane.
module gearsweep_sector_modes
  use, intrinsic :: iso_c_binding, only: c_ptr
  use gearsweep_arpack, only: lowest_eigenpairs, residual_of, work_bytes
  use gearsweep_cyclic, only: cyclic_t, make_cyclic
  use gearsweep_diameter, only: diameter_t, take_diameter
  use gearsweep_error, only: code_input, error_t, fail
  use gearsweep_kinds, only: dp, pi
  use gearsweep_material, only: material_t
  use gearsweep_memory, only: claim_memory
  use gearsweep_sector, only: sector_t
  use gearsweep_stop, only: wants_stop
  use gearsweep_text, only: str
  implicit none
  private
  public :: sector_mode_t, support_t, find_sector_modes, rigid_motions

  integer, parameter, public :: radial = 1, tangential = 2, axial = 3
  !> Displacements in the plane the same on both sides of the middle plane, and the axial ones opposite; or the other way.
  integer, parameter, public :: symmetric = 1, antisymmetric = 2
  !> Of the iteration's basis: with fewer vectors it is restarted, with more it finds twins (see find_distinct).
  integer, parameter :: basis_extra = 16

  !> What the bore cannot do.
  type :: support_t
    logical :: held(3) = .true.                  !< radial, tangential, axial displacement
  end type support_t

  type :: sector_mode_t
    real(dp) :: frequency = 0                    !< Hz
    real(dp) :: residual = 0                     !< |K u - w^2 M u| / |K u|
    real(dp) :: share(3) = 0                     !< of the kinetic energy: radial, tangential, axial
    integer :: diameter = 0                      !< n
    integer :: symmetry = symmetric
    integer :: order = 0                         !< 1, 2 ...: from the lowest of this nodal diameter and symmetry
    integer :: count = 1                         !< 2: there is another one of the same frequency, a quarter wave on
    !> Radial, tangential and axial displacement of the nodes on the front, for unit modal mass of the whole body,
    !> kg**-0.5 (3, nodes of the plane); the k-th sector on has the real part of exp(i n k pitch) times these.
    complex(dp), allocatable :: shape(:, :)
  end type sector_mode_t

contains

  !> The lowest `count` elastic modes of each nodal diameter `diameters(1)` to `diameters(2)` and each symmetry; motions as a
  !> rigid body are left out.
  !>
  !> `modes(count, 2, diameters(1):diameters(2))`: by order, symmetry and nodal diameter; not allocated where the caller's flag
  !> `stop` ended the search. `error`: code 5 or 6 where the iteration does not converge or memory does not do, 2 where
  !> the grid is too coarse for so many.
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
    integer :: symmetry, n, k

    allocate (modes(count, 2, diameters(1):diameters(2)))
    outer = maxval(norm2(sector%x(:2, :), 1))
    do symmetry = symmetric, antisymmetric
      ! Small beside any elastic frequency: a hundredth of what a shear wave does in a second over the radius.
      call make_cyclic(sector, material, held_nodes(sector, support, symmetry), &
                       1e-4_dp*material%young/(material%density*outer**2), cyclic, error)
      do n = diameters(1), diameters(2)
        call take_diameter(cyclic, n, pencil, error)
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

  !> Bore and middle plane.
  pure function held_nodes(sector, support, symmetry) result(held)
    type(sector_t), intent(in) :: sector
    type(support_t), intent(in) :: support
    integer, intent(in) :: symmetry
    logical :: held(3, size(sector%x, 2))
    integer :: d

    do d = 1, 3
      held(d, :) = (sector%in_bore .and. support%held(d)) .or. &
                   (sector%in_middle .and. (d == axial .eqv. symmetry == symmetric))
    end do
  end function held_nodes

  !> How many motions as a rigid body the support leaves to nodal diameter `n`, 0 or 1; each with n = 1 counts twice in the
  !> whole body.
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

  !> The iteration of a real problem that has each eigenvalue twice finds one vector of each pair: in exact arithmetic the
  !> Krylov space of one vector has no other. Where rounding brought the second one of a pair too, it is dropped, and
  !> the iteration goes on beside all that is known.
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

    !> A vector of unit length, and the same times i.
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

  !> The one motion as a rigid body of this nodal diameter and symmetry: rotation about the axis, translation along it,
  !> translation across it, rotation about a diameter.
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

  !> Frequency, residual, energies and shape of an eigenvector.
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
      ! Both halves of all sectors; of two parts the squares of sine and cosine.
      in_all = 2.0_dp*cyclic%sector%sectors/pencil%parts*dot_product(vector, moved)
      call take_shape(u(:, :, cyclic%sector%front), sqrt(in_all), mode%shape)
    end associate
  end subroutine describe

  !> Of all phases of a shape that one in which the sum of all displacements, with weights that differ, is real and
  !> above 0.
  pure subroutine take_shape(u, length, shape)
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
  end subroutine take_shape
end module gearsweep_sector_modes
