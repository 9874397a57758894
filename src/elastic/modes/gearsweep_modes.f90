!> Natural frequencies and mode shapes of a held body, by ARPACK in shift-invert mode about zero with the
!> factored stiffness.
module gearsweep_modes
  use gearsweep_kinds, only: dp, pi
  use gearsweep_arpack, only: lowest_eigenpairs, pencil_t, residual_of, work_bytes
  use gearsweep_body, only: body_t
  use gearsweep_error, only: error_t, fail, code_input
  use gearsweep_mass_matrix, only: assemble_mass, mass_matrix_t
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
    type(mass_matrix_t) :: mass
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
    real(dp), allocatable :: masses(:, :, :), values(:), vectors(:, :)

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
    allocate (masses, source=body%mass_matrices())
    pencil%mass = assemble_mass(size(body%grid%x, 2), body%grid%element, masses)
    if (body%grid%closed) then
      call find_twins(pencil, count, values, vectors, error)
    else
      call lowest_eigenpairs(pencil, count, reshape([real(dp) ::], [body%unknowns, 0]), values, vectors, error)
    end if
    if (allocated(error)) return
    call describe(body, pencil, masses, values, vectors, modes)
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
  !> iteration finds one. So it is repeated, orthogonal to the shapes found, until it finds none below the last one wanted.
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

  !> y = M x on the unknowns.
  subroutine mass_times(pencil, x, y)
    class(body_pencil_t), intent(in) :: pencil
    real(dp), intent(in) :: x(:)
    real(dp), intent(out) :: y(:)
    real(dp) :: u(2, size(pencil%body%equation, 2)), f(2, size(pencil%body%equation, 2))

    u = pencil%body%spread_out(x)
    call pencil%mass%times(u, f)
    y = pencil%body%gather(f)
  end subroutine mass_times

  !> Frequencies, shapes, residuals and energy shares.
  !> Of the two signs of a shape that one in which the sum of all displacements, with weights that differ, is above 0.
  !> `masses(:, :, element)`: kg.
  subroutine describe(body, pencil, masses, values, vectors, modes)
    type(body_t), intent(in) :: body
    type(body_pencil_t), intent(in) :: pencil
    real(dp), intent(in) :: masses(:, :, :), values(:), vectors(:, :)
    type(modes_t), intent(out) :: modes
    real(dp), allocatable :: u(:, :), forces(:, :), weight(:)
    real(dp) :: pulled(body%unknowns), moved(body%unknowns)
    integer :: count, nodes, k, e

    count = size(values)
    nodes = size(body%grid%x, 2)
    modes%frequency = sqrt(values)/(2*pi)
    weight = [(1 + modulo(k*0.7548776662466927_dp, 1.0_dp), k=1, body%unknowns)]
    allocate (modes%shape(2, nodes, count), modes%residual(count))
    allocate (modes%participation(0:maxval(body%grid%part), count), source=0.0_dp)
    do k = 1, count
      modes%shape(:, :, k) = body%spread_out(sign(1.0_dp, sum(vectors(:, k)*weight))*vectors(:, k))
      do e = 1, size(masses, 3)
        associate (share => modes%participation(body%grid%part(e), k))
          share = share + energy(masses(:, :, e), modes%shape(:, :, k), body%grid%element(:, e))
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
      modes%residual(k) = residual_of(pulled, values(k), moved)
    end do
  end subroutine describe

  !> u'M u of one element in both directions: `mass(:, :)` (kg) of its nodes `list(:)`, `u(2, nodes)`.
  pure real(dp) function energy(mass, u, list)
    real(dp), intent(in) :: mass(nodes_per_element, nodes_per_element), u(:, :)
    integer, intent(in) :: list(nodes_per_element)
    real(dp) :: ue(nodes_per_element, 2), f(nodes_per_element, 2)
    integer :: i

    do i = 1, nodes_per_element
      ue(i, :) = u(:, list(i))
    end do
    f = 0
    do i = 1, nodes_per_element
      f(:, 1) = f(:, 1) + mass(:, i)*ue(i, 1)
      f(:, 2) = f(:, 2) + mass(:, i)*ue(i, 2)
    end do
    energy = sum(ue*f)
  end function energy
end module gearsweep_modes
