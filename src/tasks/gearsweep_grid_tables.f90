!> The grid of a section as tables: its nodes and its elements.
module gearsweep_grid_tables
  use gearsweep_error, only: error_t
  use gearsweep_grid, only: grid_t
  use gearsweep_kinds, only: dp
  use gearsweep_table, only: axis, table_t
  use gearsweep_text, only: str
  implicit none
  private
  public :: fill_nodes, fill_elements

  !> The grid whose nodes or elements the rows of a table are.
  character(*), parameter, public :: grid_of_section = 'section'

contains

  pure subroutine fill_nodes(grid, table, error)
    type(grid_t), intent(in) :: grid
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    integer :: i

    if (allocated(error)) return
    associate (n => size(grid%x, 2))
      call table%over('nodes of the section''s grid', error, axis('node', '', 'its number', [(i, i=1, n)]), grid=grid_of_section)
      if (allocated(error)) return
      call table%add('x_mm', 'mm', 'across the middle tooth, towards its drive side', 1e3_dp*grid%x(1, :))
      call table%add('y_mm', 'mm', 'along the axis of that tooth', 1e3_dp*grid%x(2, :))
    end associate
  end subroutine fill_nodes

  !> Corners anticlockwise, then the midsides in the same order.
  pure subroutine fill_elements(grid, table, error)
    type(grid_t), intent(in) :: grid
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    integer :: i

    if (allocated(error)) return
    associate (n => size(grid%element, 2))
      call table%over('elements of the section''s grid: four corners anticlockwise, then the midsides behind each', error, &
                      axis('element', '', 'its number', [(i, i=1, n)]), grid=grid_of_section)
      if (allocated(error)) return
      do i = 1, size(grid%element, 1)
        call table%add('node_'//str(i), '', 'number of this node', grid%element(i, :))
      end do
      call table%add('tooth', '', 'that it belongs to, from the coast side; 0: the rim', grid%part)
    end associate
  end subroutine fill_elements
end module gearsweep_grid_tables
