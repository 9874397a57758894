!> Grids of bodies without teeth, whose stresses and modes have closed forms: a quadrilateral, and the sector of a ring.
module test_support_plain_grids
  use gearsweep_base_error, only: error_t
  use gearsweep_base_kinds, only: dp, pi
  use gearsweep_body_modes_sector, only: extrude, sector_t
  use gearsweep_elastic_grid, only: grid_t, make_grid
  implicit none
  private
  public :: rectangle_grid, make_ring_sector

contains

  !> Builds the grid of a straight-sided quadrilateral body, in metres, corners anticlockwise (2, 4), with equal steps along its
  !> sides and no rim or teeth.
  subroutine rectangle_grid(corners, columns, rows, grid, error)
    real(dp), intent(in) :: corners(2, 4)
    integer, intent(in) :: columns, rows
    type(grid_t), intent(out) :: grid
    type(error_t), allocatable, intent(out) :: error
    real(dp) :: points(2, 0:2*columns, 0:2*rows), u, v
    integer :: part(columns, rows), i, j

    do j = 0, 2*rows
      do i = 0, 2*columns
        u = real(i, dp)/(2*columns)
        v = real(j, dp)/(2*rows)
        points(:, i, j) = (1 - u)*(1 - v)*corners(:, 1) + u*(1 - v)*corners(:, 2) &
                          + u*v*corners(:, 3) + (1 - u)*v*corners(:, 4)
      end do
    end do
    part = 0
    call make_grid(points, part, .false., grid, error)
  end subroutine rectangle_grid

  !> Builds the sector of a ring without teeth, `radii(2)` and width in m: `counts` columns around, rows across and layers up to the
  !> face.
  subroutine make_ring_sector(radii, width, sectors, counts, sector, error)
    real(dp), intent(in) :: radii(2), width
    integer, intent(in) :: sectors, counts(3)
    type(sector_t), intent(out) :: sector
    type(error_t), allocatable, intent(inout) :: error
    type(error_t), allocatable :: folded
    real(dp) :: points(2, 0:2*counts(1), 0:2*counts(2)), level(0:2*counts(3)), radius, angle
    integer :: part(counts(1), counts(2)), i, j

    do j = 0, 2*counts(2)
      radius = radii(1) + (radii(2) - radii(1))*j/(2*counts(2))
      do i = 0, 2*counts(1)
        angle = pi/sectors*(i/real(counts(1), dp) - 1)
        points(:, i, j) = radius*[sin(angle), cos(angle)]
      end do
    end do
    part = 0
    call make_grid(points, part, .false., sector%plane, folded)
    if (allocated(folded)) call move_alloc(folded, error)
    if (allocated(error)) return
    level = [(width/2*i/(2*counts(3)), i=0, 2*counts(3))]
    sector%sectors = sectors
    call extrude(sector, level, spread(counts(3), 1, size(sector%plane%element, 2)))
  end subroutine make_ring_sector
end module test_support_plain_grids
