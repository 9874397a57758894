!> The section of a gear as tables: its size, and the nodes and elements of its grid.
module gearsweep_study_run_grid_tables
  use gearsweep_base, only: axis, dp, error_t, lines_t, str, table_t
  use gearsweep_elastic, only: grid_t, section_t
  implicit none
  private
  public :: fill_section, fill_nodes, fill_elements, add_section

  !> Name of the grid for tables whose rows are its nodes or elements.
  character(*), parameter, public :: grid_of_section = 'section'

contains

  !> Fills the table of the section.
  pure subroutine fill_section(section, gear, table, error)
    type(section_t), intent(in) :: section
    character(*), intent(in) :: gear             !< pinion or gear
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error

    if (allocated(error)) return
    call table%begin('section of one gear and its grid', 1, error)
    if (allocated(error)) return
    associate (grid => section%grid)
      call table%add_words('gear', 'pinion or gear', [trim(gear)])
      call table%add('teeth', '', 'teeth of the section', [section%options%teeth])
      call table%add('gear_teeth', '', 'teeth of the whole gear', [section%gear%spec%teeth])
      call table%add('half_angle_deg', 'deg', 'half of the sector''s angle', [section%half_angle])
      call table%add('inner_radius_mm', 'mm', 'where the section ends inwards', [section%inner_radius])
      call table%add('elements', '', 'of eight nodes', [size(grid%element, 2)])
      call table%add('nodes', '', 'each with two displacements', [size(grid%x, 2)])
      call table%add('smallest_scaled_jacobian', '', 'of the elements: 1 is a rectangle, 0 useless', [grid%quality()])
      call table%add('area_mm2', 'mm2', 'of all elements', [grid%area()])
    end associate
  end subroutine fill_section

  pure subroutine fill_nodes(grid, table, error)
    type(grid_t), intent(in) :: grid
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    integer :: i

    if (allocated(error)) return
    associate (n => size(grid%x, 2))
      call table%over('nodes of the section''s grid', error, axis('node', '', 'its number', [(i, i=1, n)]), grid=grid_of_section)
      if (allocated(error)) return
      call table%add('x_mm', 'mm', 'across the middle tooth, towards its drive side', grid%x(1, :))
      call table%add('y_mm', 'mm', 'along the axis of that tooth', grid%x(2, :))
    end associate
  end subroutine fill_nodes

  !> Fills the nodes of each element: corners anticlockwise, then the midsides in the same order.
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

  !> Reports the section: its teeth, its size and its grid.
  pure subroutine add_section(section, lines)
    type(table_t), intent(in) :: section         !< table of `fill_section`
    type(lines_t), intent(inout) :: lines

    call lines%add('   section: '//str(nint(section%number('teeth')))//' of '//str(nint(section%number('gear_teeth')))// &
                   ' teeth, +/-'//str(section%number('half_angle_deg'), 5)//' deg, inner radius '// &
                   str(section%number('inner_radius_mm'), 6)//' mm, area '//str(section%number('area_mm2'), 6)//' mm2')
    call lines%add('   grid: '//str(nint(section%number('elements')))//' elements, '//str(nint(section%number('nodes')))// &
                   ' nodes, smallest scaled Jacobian '//str(section%number('smallest_scaled_jacobian'), 2))
  end subroutine add_section
end module gearsweep_study_run_grid_tables
