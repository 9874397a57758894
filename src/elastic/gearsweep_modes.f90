!> Natural frequencies and mode shapes of a held body, by ARPACK in shift-invert mode about zero with the
!> factored stiffness.
module gearsweep_modes
  use gearsweep_kinds, only: dp, pi
  use gearsweep_arpack, only: lowest_eigenpairs, pencil_t, work_bytes
  use gearsweep_body, only: body_t
  use gearsweep_error, only: error_t, fail, code_input
  use gearsweep_memory, only: claim_memory
  use gearsweep_q8, only: nodes_per_element
  use gearsweep_text, only: str
  implicit none
  private
  public :: modes_t, find_modes

  type :: modes_t
    real(dp), allocatable :: frequency(:)        !< Hz, ascending
    real(dp), allocatable :: shape(:, :, :)      !< displacements for unit modal mass (2, nodes, modes), kg**-0.5
    real(dp), allocatable :: residual(:)         !< |K u - w^2 M u| / |K u|
    !> Share of each part's kinetic energy: rim (0), then the teeth (0:parts, modes).
    real(dp), allocatable :: participation(:, :)
  end type modes_t

  !> Stiffness and mass of a body, as the eigenvalue problem knows them.
  type, extends(pencil_t) :: body_pencil_t
    type(body_t), pointer :: body => null()
    real(dp), allocatable :: masses(:, :, :)     !< of the elements, kg (8, 8, elements)
    integer, allocatable :: dof(:, :, :)         !< their unknowns, 0 where held (2, 8, elements)
  contains
    procedure :: solve => solve_stiffness
    procedure :: times => mass_times
  end type body_pencil_t

contains

  !> The lowest `count` modes of `body`.
  subroutine find_modes(body, count, modes, error)
    type(body_t), intent(in), target :: body
    integer, intent(in) :: count
    type(modes_t), intent(out) :: modes
    type(error_t), allocatable, intent(out) :: error
    type(body_pencil_t) :: pencil
    real(dp), allocatable :: values(:), vectors(:, :)

    if (count < 1 .or. 2*count + 2 > body%unknowns) then
      call fail(error, code_input, 'number of modes = '//str(count)//': must lie between 1 and '// &
        str(body%unknowns/2 - 1))
      return
    end if
    if (.not. body%material%density > 0) then
      call fail(error, code_input, 'density: must be above 0')
      return
    end if
    call claim_modes(body, count, error)
    if (allocated(error)) return
    pencil%n = body%unknowns
    pencil%body => body
    allocate (pencil%masses, source=body%mass_matrices())
    pencil%dof = reshape(body%equation(:, reshape(body%grid%element, [size(body%grid%element)])), &
                         [2, nodes_per_element, size(pencil%masses, 3)])
    if (body%grid%closed) then
      call find_twins(pencil, count, values, vectors, error)
    else
      call lowest_eigenpairs(pencil, count, reshape([real(dp) ::], [body%unknowns, 0]), values, vectors, error)
    end if
    if (allocated(error)) return
    call describe(body, pencil, values, vectors, modes)
  end subroutine find_modes

  !> What ARPACK takes, the modes in several forms, and the elements' masses.
  subroutine claim_modes(body, count, error)
    type(body_t), intent(in) :: body
    integer, intent(in) :: count
    type(error_t), allocatable, intent(inout) :: error
    real(dp) :: others

    others = 8.0_dp*body%unknowns*(5*count + 20) + 16.0_dp*size(body%grid%x, 2)*(7*count + 10) &
             + 1300.0_dp*size(body%grid%element, 2)
    if (body%grid%closed) others = 2*others
    call claim_memory(work_bytes(body%unknowns, count) + others, 'number of modes = '//str(count), error, blas=.true.)
  end subroutine claim_modes

  !> The same for a whole gear: where all its teeth are alike, most of its frequencies come in pairs, of which an
  !> iteration finds one. So it is repeated beside what is known, until it finds nothing below the last one wanted.
  subroutine find_twins(pencil, count, values, vectors, error)
    type(body_pencil_t), intent(in) :: pencil
    integer, intent(in) :: count
    real(dp), allocatable, intent(out) :: values(:), vectors(:, :)
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: more(:), others(:, :)
    integer, allocatable :: order(:)

    call lowest_eigenpairs(pencil, count, reshape([real(dp) ::], [pencil%n, 0]), values, vectors, error)
    do while (.not. allocated(error))
      if (size(values) + (count + 1)/2 > pencil%n) exit
      call lowest_eigenpairs(pencil, (count + 1)/2, vectors, more, others, error)
      if (allocated(error)) exit
      values = [values, more]
      vectors = reshape([vectors, others], [pencil%n, size(values)])
      order = ascending(values)
      values = values(order)
      vectors = vectors(:, order)
      if (more(size(more)) >= values(count)) exit
    end do
    if (allocated(error)) return
    values = values(:count)
    vectors = vectors(:, :count)
  end subroutine find_twins

  !> The order in which values rise.
  pure function ascending(values) result(order)
    real(dp), intent(in) :: values(:)
    integer :: order(size(values))
    logical :: left(size(values))
    integer :: i

    left = .true.
    do i = 1, size(values)
      order(i) = minloc(values, 1, mask=left)
      left(order(i)) = .false.
    end do
  end function ascending

  subroutine solve_stiffness(pencil, x, error)
    class(body_pencil_t), intent(in) :: pencil
    real(dp), intent(inout), contiguous :: x(:)
    type(error_t), allocatable, intent(inout) :: error

    call pencil%body%stiffness%solve(x, error)
  end subroutine solve_stiffness

  !> y = M x on the unknowns, element by element, in both directions at once. What is held reads a zero before the
  !> first unknown, and what it gets there is dropped.
  subroutine mass_times(pencil, x, y)
    class(body_pencil_t), intent(in) :: pencil
    real(dp), intent(in) :: x(:)
    real(dp), intent(out) :: y(:)
    real(dp) :: from(0:pencil%n), to(0:pencil%n), ye(nodes_per_element, 2)
    integer :: e, i

    from(0) = 0
    from(1:) = x
    to = 0
    do e = 1, size(pencil%masses, 3)
      associate (dof => pencil%dof(:, :, e), mass => pencil%masses(:, :, e))
        ye = 0
        do i = 1, nodes_per_element
          ye(:, 1) = ye(:, 1) + mass(:, i)*from(dof(1, i))
          ye(:, 2) = ye(:, 2) + mass(:, i)*from(dof(2, i))
        end do
        do i = 1, nodes_per_element
          to(dof(1, i)) = to(dof(1, i)) + ye(i, 1)
          to(dof(2, i)) = to(dof(2, i)) + ye(i, 2)
        end do
      end associate
    end do
    y = to(1:)
  end subroutine mass_times

  !> Frequencies, shapes, residuals and energy shares.
  !> Of the two signs of a shape that one in which the sum of all displacements, with weights that differ, is above 0.
  subroutine describe(body, pencil, values, vectors, modes)
    type(body_t), intent(in) :: body
    type(body_pencil_t), intent(in) :: pencil
    real(dp), intent(in) :: values(:), vectors(:, :)
    type(modes_t), intent(out) :: modes
    real(dp), allocatable :: u(:, :), forces(:, :), weight(:)
    real(dp) :: pulled(body%unknowns), moved(body%unknowns), energy
    integer :: count, nodes, k, e, d

    count = size(values)
    nodes = size(body%grid%x, 2)
    modes%frequency = sqrt(values)/(2*pi)
    weight = [(1 + modulo(k*0.7548776662466927_dp, 1.0_dp), k=1, body%unknowns)]
    allocate (modes%shape(2, nodes, count), modes%residual(count))
    allocate (modes%participation(0:maxval(body%grid%part), count), source=0.0_dp)
    do k = 1, count
      modes%shape(:, :, k) = body%spread_out(sign(1.0_dp, sum(vectors(:, k)*weight))*vectors(:, k))
      do e = 1, size(pencil%masses, 3)
        associate (list => body%grid%element(:, e), part => body%grid%part(e))
          do d = 1, 2
            energy = dot_product(modes%shape(d, list, k), matmul(pencil%masses(:, :, e), modes%shape(d, list, k)))
            modes%participation(part, k) = modes%participation(part, k) + energy
          end do
        end associate
      end do
      modes%shape(:, :, k) = modes%shape(:, :, k)/sqrt(sum(modes%participation(:, k)))
      modes%participation(:, k) = modes%participation(:, k)/sum(modes%participation(:, k))
    end do
    u = reshape(modes%shape, [2*nodes, count])
    forces = body%stiffness_times(u)
    do k = 1, count
      pulled = body%gather(reshape(forces(:, k), [2, nodes]))
      call pencil%times(body%gather(modes%shape(:, :, k)), moved)
      modes%residual(k) = norm2(pulled - values(k)*moved)/norm2(pulled)
    end do
  end subroutine describe
end module gearsweep_modes
