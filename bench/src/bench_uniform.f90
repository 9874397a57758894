!> A section on elements of equal size, as a grid without grading would have:
!> same outline, same blocks, but equal lengths along each of them.
module bench_uniform
  use bench_tools, only: check
  use gearsweep_base_error, only: error_t
  use gearsweep_gear_gear, only: drive, gear_t
  use gearsweep_elastic_grid, only: make_grid, no_element
  use gearsweep_base_kinds, only: dp
  use gearsweep_elastic_q8, only: shape_functions
  use gearsweep_elastic_section, only: make_section, section_options_t, section_t
  implicit none
  private
  public :: make_uniform

  !> Elements across a tooth of the graded grid whose lattice gives the shape.
  integer, parameter :: fine_across = 48

contains

  !> `options%elements_across` elements across each tooth; no closed sections.
  subroutine make_uniform(gear, options, section)
    type(gear_t), intent(in) :: gear
    type(section_options_t), intent(in) :: options
    type(section_t), intent(out) :: section
    type(error_t), allocatable :: error
    type(section_options_t) :: finely
    type(section_t) :: fine
    real(dp), allocatable :: column(:), row(:)

    finely = options
    finely%elements_across = fine_across
    call make_section(gear, finely, fine, error)
    call check(error)
    section = fine
    section%options = options
    section%across = options%elements_across
    call place_columns(fine, section, column)
    call place_rows(fine, section, row)
    call fill(fine, section, column, row)
  end subroutine make_uniform

  !> Places of the new lattice's columns in the fine one: equal lengths along the
  !> top of the rim within each tooth, and within each space.
  subroutine place_columns(fine, section, column)
    type(section_t), intent(in) :: fine
    type(section_t), intent(inout) :: section
    real(dp), allocatable, intent(out) :: column(:)
    real(dp), allocatable :: along(:)
    real(dp) :: size_of_element
    integer :: k, from

    along = lengths(fine%grid%x(:, fine%grid%node(:, 2*fine%rim_rows)))
    size_of_element = tooth_width(fine, along)/section%options%elements_across
    column = [0.0_dp]
    from = 0
    do k = 1, fine%options%teeth
      associate (left => 2*fine%first_column(k), right => 2*(fine%first_column(k) + fine%across(k)))
        call extend(column, along, from, left, even(along(left + 1) - along(from + 1), size_of_element))
        section%first_column(k) = (size(column) - 1)/2
        call extend(column, along, left, right, section%across(k))
        from = right
      end associate
    end do
    call extend(column, along, from, size(along) - 1, even(along(size(along)) - along(from + 1), size_of_element))
  end subroutine place_columns

  !> The same for the rows, along the loaded tooth's drive flank and the line below it.
  subroutine place_rows(fine, section, row)
    type(section_t), intent(in) :: fine
    type(section_t), intent(inout) :: section
    real(dp), allocatable, intent(out) :: row(:)
    real(dp), allocatable :: along(:), across(:)
    real(dp) :: size_of_element
    integer :: rim

    across = lengths(fine%grid%x(:, fine%grid%node(:, 2*fine%rim_rows)))
    size_of_element = tooth_width(fine, across)/section%options%elements_across
    along = lengths(fine%grid%x(:, fine%grid%node(fine%flank_line(fine%loaded, drive), :)))
    rim = 2*fine%rim_rows
    section%rim_rows = max(1, nint(along(rim + 1)/size_of_element))
    row = [0.0_dp]
    call extend(row, along, 0, rim, section%rim_rows)
    call extend(row, along, rim, size(along) - 1, max(2, nint((along(size(along)) - along(rim + 1))/size_of_element)))
  end subroutine place_rows

  pure real(dp) function tooth_width(fine, along)
    type(section_t), intent(in) :: fine
    real(dp), intent(in) :: along(0:)

    associate (first => fine%first_column(fine%loaded))
      tooth_width = along(2*(first + fine%across(fine%loaded))) - along(2*first)
    end associate
  end function tooth_width

  pure function lengths(points) result(along)
    real(dp), intent(in) :: points(:, :)
    real(dp) :: along(size(points, 2))
    integer :: i

    along(1) = 0
    do i = 2, size(along)
      along(i) = along(i - 1) + norm2(points(:, i) - points(:, i - 1))
    end do
  end function lengths

  pure integer function even(length, size_of_element)
    real(dp), intent(in) :: length, size_of_element

    even = 2*max(1, nint(length/size_of_element/2))
  end function even

  !> Appends the places of `elements` elements of equal length between two places of the fine lattice.
  pure subroutine extend(place, along, from, until, elements)
    real(dp), allocatable, intent(inout) :: place(:)
    real(dp), intent(in) :: along(0:)
    integer, intent(in) :: from, until, elements
    real(dp) :: wanted
    integer :: i, k

    if (until == from) return
    do i = 1, 2*elements
      wanted = along(from) + (along(until) - along(from))*i/(2*elements)
      k = from + count(along(from + 1:until - 1) <= wanted)
      place = [place, k + (wanted - along(k))/(along(k + 1) - along(k))]
    end do
    place(size(place)) = until
  end subroutine extend

  !> Maps the new lattice through the fine elements.
  subroutine fill(fine, section, column, row)
    type(section_t), intent(in) :: fine
    type(section_t), intent(inout) :: section
    real(dp), intent(in) :: column(0:), row(0:)
    type(error_t), allocatable :: error
    real(dp) :: points(2, 0:ubound(column, 1), 0:ubound(row, 1))
    integer :: part(ubound(column, 1)/2, ubound(row, 1)/2), i, j, k

    part = no_element
    part(:, :section%rim_rows) = 0
    do k = 1, section%options%teeth
      part(section%first_column(k) + 1:section%first_column(k) + section%across(k), section%rim_rows + 1:) = k
    end do
    points = 0
    do j = 0, ubound(row, 1)
      do i = 0, ubound(column, 1)
        if (any(part(max(1, (i + 1)/2):min(size(part, 1), i/2 + 1), max(1, (j + 1)/2):min(size(part, 2), j/2 + 1)) &
                /= no_element)) points(:, i, j) = point_at(fine, column(i), row(j))
      end do
    end do
    call make_grid(points, part, .false., section%grid, error)
    call check(error)
  end subroutine fill

  !> Where a place of the fine lattice lies.
  function point_at(fine, column, row) result(point)
    type(section_t), intent(in) :: fine
    real(dp), intent(in) :: column, row
    real(dp) :: point(2)
    integer, parameter :: di(8) = [0, 2, 2, 0, 1, 2, 1, 0], dj(8) = [0, 0, 2, 2, 0, 1, 2, 1]
    integer :: c, r, nodes(8), k, tries

    ! On a line between elements either side will do, but above the rim only one may be there.
    do tries = 0, 3
      c = 2*min(max(0, ceiling(column/2 - 1e-9_dp) - 1 + mod(tries, 2)), ubound(fine%grid%node, 1)/2 - 1)
      r = 2*min(max(0, ceiling(row/2 - 1e-9_dp) - 1 + tries/2), ubound(fine%grid%node, 2)/2 - 1)
      nodes = [(fine%grid%node(c + di(k), r + dj(k)), k=1, 8)]
      if (all(nodes > 0) .and. abs(column - c - 1) < 1 + 1e-6_dp .and. abs(row - r - 1) < 1 + 1e-6_dp) exit
    end do
    point = matmul(fine%grid%x(:, nodes), shape_functions([column - c - 1, row - r - 1]))
  end function point_at
end module bench_uniform
