!> A whole body of equal sectors assembled from turned copies of one, node by node in x, y and z, without nodal diameters:
!> what gearsweep_body_modes_cyclic is set beside. Its elements' matrices and the eigenvalue iteration are the library's.
module test_support_whole_bodies
  use gearsweep_base_arpack, only: lowest_eigenpairs, pencil_t
  use gearsweep_base_error, only: error_t
  use gearsweep_body_modes_sector, only: brick_matrices, brick_nodes, sector_t
  use gearsweep_base_kinds, only: dp, pi
  use gearsweep_elastic_material, only: material_t
  use gearsweep_base_sparse, only: factor, sparse_t
  implicit none
  private
  public :: whole_frequencies

  integer, parameter :: all_of_one = 3*brick_nodes

  type, extends(pencil_t) :: whole_t
    type(sparse_t) :: stiffness
    integer, allocatable :: list(:, :)           !< unknowns of each element, 0 where held (60, elements)
    real(dp), allocatable :: mass(:, :, :)       !< (20, 20, elements)
  contains
    procedure :: solve
    procedure :: times
  end type whole_t

contains

  !> The lowest `count` frequencies (Hz) of a body whose bore is held; of one symmetry about the middle plane: with
  !> `in_plane`, the axial displacement vanishes there, else the other two.
  subroutine whole_frequencies(sector, material, in_plane, count, frequency, error)
    type(sector_t), intent(in) :: sector
    type(material_t), intent(in) :: material
    logical, intent(in) :: in_plane
    integer, intent(in) :: count
    real(dp), allocatable, intent(out) :: frequency(:)
    type(error_t), allocatable, intent(inout) :: error
    type(whole_t) :: whole
    real(dp), allocatable :: values(:), more(:), vectors(:, :), others(:, :)

    call assemble(sector, material, in_plane, whole, error)
    allocate (values(0), vectors(whole%n, 0))
    do
      call lowest_eigenpairs(whole, count, vectors, more, others, error)
      if (allocated(error)) return
      values = [values, more]
      vectors = reshape([vectors, others], [whole%n, size(values)])
      if (size(values) > count) then
        if (minval(more) >= nth(values, count)) exit
      end if
    end do
    call sort(values)
    frequency = sqrt(values(:count))/(2*pi)
  end subroutine whole_frequencies

  pure real(dp) function nth(values, n)
    real(dp), intent(in) :: values(:)
    integer, intent(in) :: n
    real(dp) :: sorted(size(values))

    sorted = values
    call sort(sorted)
    nth = sorted(n)
  end function nth

  pure subroutine sort(values)
    real(dp), intent(inout) :: values(:)
    integer :: i, k

    do i = 1, size(values)
      k = i - 1 + minloc(values(i:), 1)
      values([i, k]) = values([k, i])
    end do
  end subroutine sort

  subroutine assemble(sector, material, in_plane, whole, error)
    type(sector_t), intent(in) :: sector
    type(material_t), intent(in) :: material
    logical, intent(in) :: in_plane
    type(whole_t), intent(inout) :: whole
    type(error_t), allocatable, intent(inout) :: error
    integer, allocatable :: number(:, :, :), first(:), at(:)
    real(dp), allocatable :: values(:)
    real(dp) :: k(all_of_one, all_of_one), x(3, brick_nodes), turn(2, 2), angle, lame(2)
    integer :: s, e, i, j, d, p, own, entries, unknowns
    integer :: list(all_of_one)
    logical :: held

    associate (z => sector%sectors, elements => size(sector%element, 2))
      allocate (number(3, size(sector%x, 2), 0:z - 1), source=-1)
      whole%n = 0
      do s = 0, z - 1
        number(:, sector%far, s) = 0
        do p = 1, size(sector%x, 2)
          do d = 1, 3
            if (number(d, p, s) == 0) cycle
            held = sector%in_bore(p) .or. (sector%in_middle(p) .and. (d == 3 .eqv. in_plane))
            number(d, p, s) = 0
            if (held) cycle
            whole%n = whole%n + 1
            number(d, p, s) = whole%n
          end do
        end do
      end do
      do s = 0, z - 1
        number(:, sector%far, s) = number(:, sector%near, modulo(s + 1, z))
      end do
      own = elements*z
      allocate (whole%list(all_of_one, own), whole%mass(brick_nodes, brick_nodes, own))
      allocate (first(own + 1), at(all_of_one*own), values(own*all_of_one*(all_of_one + 1)/2))
      lame = material%young/(2*(1 + material%poisson))*[2*material%poisson/(1 - 2*material%poisson), 1.0_dp]
      first(1) = 1
      own = 0
      entries = 0
      unknowns = 0
      do s = 0, z - 1
        angle = 2*pi*s/z
        turn = reshape([cos(angle), sin(angle), -sin(angle), cos(angle)], [2, 2])
        do e = 1, elements
          own = own + 1
          x = sector%x(:, sector%element(:, e))
          x(:2, :) = matmul(turn, x(:2, :))
          call brick_matrices(x, lame, material%density, k, whole%mass(:, :, own))
          list = reshape(number(:, sector%element(:, e), s), [all_of_one])
          whole%list(:, own) = list
          do j = 1, all_of_one
            if (list(j) == 0) cycle
            unknowns = unknowns + 1
            at(unknowns) = list(j)
            do i = j, all_of_one
              if (list(i) == 0) cycle
              entries = entries + 1
              values(entries) = k(i, j)
            end do
          end do
          first(own + 1) = unknowns + 1
        end do
      end do
    end associate
    call factor(whole%n, first, at(:unknowns), values(:entries), 4e9_dp, 'the whole body', whole%stiffness, error)
  end subroutine assemble

  subroutine solve(pencil, x, error)
    class(whole_t), intent(in) :: pencil
    real(dp), intent(inout), contiguous :: x(:)
    type(error_t), allocatable, intent(inout) :: error

    call pencil%stiffness%solve(x, error)
  end subroutine solve

  subroutine times(pencil, x, y)
    class(whole_t), intent(in) :: pencil
    real(dp), intent(in) :: x(:)
    real(dp), intent(out) :: y(:)
    real(dp) :: from(0:pencil%n), to(0:pencil%n), u(all_of_one)
    integer :: e, i

    from(0) = 0
    from(1:) = x
    to = 0
    do e = 1, size(pencil%mass, 3)
      u = reshape(matmul(reshape(from(pencil%list(:, e)), [3, brick_nodes]), pencil%mass(:, :, e)), [all_of_one])
      do i = 1, all_of_one
        to(pencil%list(i, e)) = to(pencil%list(i, e)) + u(i)
      end do
    end do
    y = to(1:)
  end subroutine times
end module test_support_whole_bodies
