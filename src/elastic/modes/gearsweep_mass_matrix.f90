!> The mass matrix of a plane body's nodes, the same for both directions, in compressed symmetric storage.
module gearsweep_mass_matrix
  use gearsweep_kinds, only: dp
  implicit none
  private
  public :: mass_matrix_t, assemble_mass

  !> Row i has its diagonal entry, and beyond it the entries `first(i)` to `first(i + 1) - 1`.
  type :: mass_matrix_t
    real(dp), allocatable :: diagonal(:)         !< kg
    integer, allocatable :: first(:), column(:)
    real(dp), allocatable :: beyond(:)           !< entries right of the diagonal, kg
  contains
    procedure :: times
  end type mass_matrix_t

contains

  !> The sum of element matrices `masses(:, :, element)` (kg); `element(:, element)` lists the nodes of each, of `nodes`.
  pure function assemble_mass(nodes, element, masses) result(matrix)
    integer, intent(in) :: nodes, element(:, :)
    real(dp), intent(in) :: masses(:, :, :)
    type(mass_matrix_t) :: matrix
    integer :: around(nodes + 1), place(nodes), corner(2, size(element)), count, i, j, k, e, a

    call list_elements(element, around, corner)
    ! At most as many as the element matrices have right of their diagonals.
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

  !> Which elements a node belongs to: `corner(:, around(i):around(i + 1) - 1)` are an element and the node's place in it.
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

  !> Forces `f(2, nodes)` (N) that accelerations `u(2, nodes)` (m/s2) of the nodes take.
  pure subroutine times(matrix, u, f)
    class(mass_matrix_t), intent(in) :: matrix
    real(dp), intent(in), contiguous :: u(:, :)
    real(dp), intent(out), contiguous :: f(:, :)

    call multiply(size(matrix%diagonal), matrix%diagonal, matrix%first, matrix%column, matrix%beyond, u, f)
  end subroutine times

  !> The same with arrays of explicit shape, which compilers index faster.
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
end module gearsweep_mass_matrix
