!> Natural frequencies and mode shapes of a gear section, with their discretisation error.
!>
!> The consistent mass matrix is the same for both directions, in compressed symmetric storage. ARPACK finds the lowest modes
!> in shift-invert mode about zero with the factored stiffness.
module gearsweep_elastic_modes
  use gearsweep_base, only: claim_memory, code_input, dp, error_t, fail, lowest_eigenpairs, pencil_t, pi, residual_of, str, &
    work_bytes
  use gearsweep_elastic_body, only: body_t
  use gearsweep_elastic_q8, only: nodes_per_element
  use gearsweep_elastic_section, only: mean_step_ratio, section_body_t, section_t
  use gearsweep_elastic_tooth_block, only: fillet_excess
  implicit none
  private
  public :: mass_matrix_t, assemble_mass, modes_t, find_modes, section_modes, modal_t, estimated_errors

  !> Symmetric matrix: row i has its diagonal entry and the entries `first(i)` to `first(i + 1) - 1` right of it.
  type :: mass_matrix_t
    real(dp), allocatable :: diagonal(:)         !< kg
    integer, allocatable :: first(:), column(:)
    real(dp), allocatable :: beyond(:)           !< entries right of the diagonal, kg
  contains
    procedure :: times
  end type mass_matrix_t

  type :: modes_t
    real(dp), allocatable :: frequency(:)        !< Hz, ascending
    real(dp), allocatable :: shape(:, :, :)      !< displacements for unit modal mass (2, nodes, modes), kg**-0.5
    real(dp), allocatable :: residual(:)         !< |K u - w^2 M u| / |K u|
    !> Fraction of each part's kinetic energy: rim (0), then the teeth (0:parts, modes).
    real(dp), allocatable :: participation(:, :)
  end type modes_t

  !> Stiffness and mass of a body for the eigenvalue problem.
  type, extends(pencil_t) :: body_pencil_t
    type(body_t), pointer :: body => null()
    type(mass_matrix_t) :: mass
  contains
    procedure :: solve => solve_stiffness
    procedure :: times => mass_times
  end type body_pencil_t

  type :: modal_t
    type(section_t) :: section
    type(modes_t) :: modes
    type(modes_t) :: coarse                      !< modes of the second grid
    real(dp), allocatable :: error_estimate(:)   !< relative error of each frequency
  end type modal_t

contains

  !> Assembles the sum of element matrices `masses(:, :, element)` (kg); `element(:, element)` lists the nodes of each, of
  !> `nodes`.
  pure function assemble_mass(nodes, element, masses) result(matrix)
    integer, intent(in) :: nodes, element(:, :)
    real(dp), intent(in) :: masses(:, :, :)
    type(mass_matrix_t) :: matrix
    integer :: around(nodes + 1), place(nodes), corner(2, size(element)), count, i, j, k, e, a

    call list_elements(element, around, corner)
    ! Upper bound: the entries of the element matrices right of their diagonals.
    count = size(masses, 3)*size(element, 1)*(size(element, 1) - 1)/2
    allocate (matrix%diagonal(nodes), source=0.0_dp)
    allocate (matrix%first(nodes + 1), matrix%column(count), matrix%beyond(count))
    place = 0
    count = 0
    do i = 1, nodes
      matrix%first(i) = count + 1
      do k = around(i), around(i + 1) - 1
        e = corner(1, k)
        a = corner(2, k)
        do j = 1, size(element, 1)
          associate (node => element(j, e))
            if (node == i) then
              matrix%diagonal(i) = matrix%diagonal(i) + masses(j, a, e)
            else if (node > i) then
              if (place(node) < matrix%first(i)) then
                count = count + 1
                place(node) = count
                matrix%column(count) = node
                matrix%beyond(count) = 0
              end if
              matrix%beyond(place(node)) = matrix%beyond(place(node)) + masses(j, a, e)
            end if
          end associate
        end do
      end do
    end do
    matrix%first(nodes + 1) = count + 1
    matrix%column = matrix%column(:count)
    matrix%beyond = matrix%beyond(:count)
  end function assemble_mass

  !> Lists the elements of each node: `corner(:, around(i):around(i + 1) - 1)` are an element and the node's place in it.
  pure subroutine list_elements(element, around, corner)
    integer, intent(in) :: element(:, :)
    integer, intent(out) :: around(:), corner(:, :)
    integer :: next(size(around) - 1), e, a, i

    around = 0
    do e = 1, size(element, 2)
      around(element(:, e) + 1) = around(element(:, e) + 1) + 1
    end do
    around(1) = 1
    do i = 2, size(around)
      around(i) = around(i) + around(i - 1)
    end do
    next = around(:size(next))
    do e = 1, size(element, 2)
      do a = 1, size(element, 1)
        i = element(a, e)
        corner(:, next(i)) = [e, a]
        next(i) = next(i) + 1
      end do
    end do
  end subroutine list_elements

  !> Computes the forces `f(2, nodes)` (N) of accelerations `u(2, nodes)` (m/s2) of the nodes.
  pure subroutine times(matrix, u, f)
    class(mass_matrix_t), intent(in) :: matrix
    real(dp), intent(in), contiguous :: u(:, :)
    real(dp), intent(out), contiguous :: f(:, :)

    call multiply(size(matrix%diagonal), matrix%diagonal, matrix%first, matrix%column, matrix%beyond, u, f)
  end subroutine times

  !> Multiplies with arrays of explicit shape, which compilers index faster.
  pure subroutine multiply(nodes, diagonal, first, column, beyond, u, f)
    integer, intent(in) :: nodes, first(nodes + 1)
    integer, intent(in), contiguous :: column(:)
    real(dp), intent(in) :: diagonal(nodes), u(2, nodes)
    real(dp), intent(in), contiguous :: beyond(:)
    real(dp), intent(out) :: f(2, nodes)
    real(dp) :: x, y, along_x, along_y, m
    integer :: i, j, k

    f = 0
    do i = 1, nodes
      x = u(1, i)
      y = u(2, i)
      along_x = f(1, i) + diagonal(i)*x
      along_y = f(2, i) + diagonal(i)*y
      do k = first(i), first(i + 1) - 1
        j = column(k)
        m = beyond(k)
        along_x = along_x + m*u(1, j)
        along_y = along_y + m*u(2, j)
        f(1, j) = f(1, j) + m*x
        f(2, j) = f(2, j) + m*y
      end do
      f(1, i) = along_x
      f(2, i) = along_y
    end do
  end subroutine multiply

  !> Finds the lowest `count` modes of `body`.
  subroutine find_modes(body, count, modes, error)
    type(body_t), intent(in), target :: body
    integer, intent(in) :: count
    type(modes_t), intent(out) :: modes
    type(error_t), allocatable, intent(out) :: error
    type(body_pencil_t) :: pencil
    real(dp), allocatable :: masses(:, :, :), values(:), vectors(:, :)
    real(dp) :: others

    if (count < 1 .or. 2*count + 2 > body%unknowns) then
      call fail(error, code_input, 'number of modes = '//str(count)//': must lie between 1 and '// &
        str(body%unknowns/2 - 1))
      return
    end if
    if (.not. body%material%density > 0) then
      call fail(error, code_input, 'density: must be above 0')
      return
    end if
    ! Memory of ARPACK, of the modes in several forms, and of the element masses.
    others = 8.0_dp*body%unknowns*(5*count + 20) + 16.0_dp*size(body%grid%x, 2)*(7*count + 10) &
             + 1300.0_dp*size(body%grid%element, 2)
    if (body%grid%closed) others = 2*others
    call claim_memory(work_bytes(body%unknowns, count) + others, 'number of modes = '//str(count), error, blas=.true.)
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

  !> Finds the modes of a complete gear: if all its teeth are alike, most of its frequencies come in pairs, of which an iteration
  !> finds one. So it is repeated, orthogonal to the shapes found, until it finds none below the last one wanted.
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

  !> Permutation that sorts values in ascending order.
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

  !> Computes y = M x on the unknowns.
  subroutine mass_times(pencil, x, y)
    class(body_pencil_t), intent(in) :: pencil
    real(dp), intent(in) :: x(:)
    real(dp), intent(out) :: y(:)
    real(dp) :: u(2, size(pencil%body%equation, 2)), f(2, size(pencil%body%equation, 2))

    u = pencil%body%spread_out(x)
    call pencil%mass%times(u, f)
    y = pencil%body%gather(f)
  end subroutine mass_times

  !> Computes frequencies, shapes, residuals and energy shares. The sign of a shape is that with a positive sum of all
  !> displacements, with different weights. `masses(:, :, element)`: kg.
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

  !> Energy u'M u of one element in both directions: `mass(:, :)` (kg) of its nodes `list(:)`, `u(2, nodes)`.
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

  !> Finds the lowest `count` modes of a section, from its two grids (make_two_grids), with their errors: the difference of the
  !> grids, and the error of the fillets' outline, which coarse grids share.
  subroutine section_modes(grids, count, product, error)
    type(section_body_t), intent(in) :: grids(2)
    integer, intent(in) :: count
    type(modal_t), intent(out) :: product
    type(error_t), allocatable, intent(out) :: error
    real(dp) :: excess
    integer :: k

    product%section = grids(1)%section
    call modes_of(grids(1), count, product%modes, error)
    if (allocated(error)) return
    call modes_of(grids(2), count, product%coarse, error)
    if (allocated(error)) return
    ! Excess area of the fillets of the grid: a change of mass changes frequencies by about as much.
    associate (section => product%section)
      excess = abs(sum([(fillet_excess(section%gear, section%across(k)), k=1, size(section%across))]))/section%grid%area()
    end associate
    product%error_estimate = excess &
                             + estimated_errors(product%modes%frequency, product%coarse%frequency, mean_step_ratio(grids))
  end subroutine section_modes

  !> Relative errors of `frequency(:)` (Hz), ascending, from those of a grid whose elements are `step_ratio` times as large: their
  !> difference over the ratio's square minus one. Second order is between the fourth of smooth fields and about 1.5 of the
  !> singular held corners. Modes that are closer together than their change between the grids may have swapped, so that the
  !> difference is not that of one mode: each gets the largest error among them.
  pure function estimated_errors(frequency, coarse, step_ratio) result(errors)
    real(dp), intent(in) :: frequency(:), coarse(:), step_ratio
    real(dp) :: errors(size(frequency))
    real(dp) :: moved(size(frequency))
    integer :: k

    moved = abs(coarse - frequency)
    do k = 1, size(frequency)
      errors(k) = maxval(moved/frequency, mask=abs(frequency - frequency(k)) <= max(moved, moved(k)))
    end do
    errors = errors/abs(step_ratio**2 - 1)
  end function estimated_errors

  !> Finds the modes for the section's own stiffness and width.
  subroutine modes_of(grid, count, modes, error)
    type(section_body_t), intent(in) :: grid
    integer, intent(in) :: count
    type(modes_t), intent(out) :: modes
    type(error_t), allocatable, intent(out) :: error

    call find_modes(grid%body, count, modes, error)
    if (allocated(error)) return
    modes%frequency = modes%frequency*sqrt(grid%material%young/grid%body%material%young)
    modes%shape = modes%shape*sqrt(grid%body%thickness/grid%section%gear%spec%face_width)
  end subroutine modes_of
end module gearsweep_elastic_modes
