!> The task `section`: the grid of a section of one gear, and the outlines of both.
module gearsweep_task_section
  use gearsweep_contour, only: shown_outline
  use gearsweep_error, only: error_t
  use gearsweep_grid_tables, only: fill_elements, fill_nodes
  use gearsweep_kinds, only: dp, pi
  use gearsweep_lines, only: lines_t
  use gearsweep_pair, only: pair_t
  use gearsweep_section, only: make_section, section_t
  use gearsweep_table, only: axis, table_t
  use gearsweep_stages, only: runnable_t, stages_t
  use gearsweep_task, only: members, stage, task_info_t
  use gearsweep_text, only: str
  implicit none
  private
  public :: section_task_t

  type, extends(runnable_t) :: section_task_t
  contains
    procedure, nopass :: describe
    procedure :: run, add_report
  end type section_task_t

  real(dp), parameter :: milli = 1e3_dp, degree = pi/180

contains

  pure subroutine describe(info)
    type(task_info_t), intent(out) :: info

    info = task_info_t('section', needs=[stage%geometry, stage%section], tables='section outline', fields='nodes elements', &
                       gives='the grid of a section of one gear')
  end subroutine describe

  subroutine run(self, stages, error)
    class(section_task_t), intent(inout) :: self
    type(stages_t), intent(in) :: stages
    type(error_t), allocatable, intent(inout) :: error
    type(section_t) :: section

    call make_section(stages%body_inputs%gear, stages%body_inputs%options, section, error)
    if (allocated(error)) return
    call fill_section(section, trim(members(stages%member)), self%tables(self%place('section')), error)
    call fill_outline(stages%pair, self%tables(self%place('outline')), error)
    call fill_nodes(section%grid, self%tables(self%place('nodes')), error)
    call fill_elements(section%grid, self%tables(self%place('elements')), error)
    self%grid = section%grid
    self%is_done = .true.
    self%log = 'section: grid made'
  end subroutine run

  !> `member`: pinion or gear.
  pure subroutine fill_section(section, member, table, error)
    type(section_t), intent(in) :: section
    character(*), intent(in) :: member
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error

    call table%begin('section of one gear and its grid', 1, error)
    if (allocated(error)) return
    associate (grid => section%grid)
      call table%add_words('member', 'pinion or gear', [member])
      call table%add('teeth', '', 'teeth of the section', [section%options%teeth])
      call table%add('gear_teeth', '', 'teeth of the whole gear', [section%gear%spec%teeth])
      call table%add('half_angle_deg', 'deg', 'half of the sector''s angle', [section%half_angle/degree])
      call table%add('inner_radius_mm', 'mm', 'where the section ends inwards', [milli*section%inner_radius])
      call table%add('elements', '', 'of eight nodes', [size(grid%element, 2)])
      call table%add('nodes', '', 'each with two displacements', [size(grid%x, 2)])
      call table%add('smallest_scaled_jacobian', '', 'of the elements: 1 is a rectangle, 0 useless', [grid%quality()])
      call table%add('area_mm2', 'mm2', 'of all elements', [milli**2*grid%area()])
    end associate
  end subroutine fill_section

  !> Outlines of both gears as points, clockwise, centres at the origin.
  pure subroutine fill_outline(pair, table, error)
    type(pair_t), intent(in) :: pair
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: pinion(:, :), gear(:, :)
    integer :: i

    if (allocated(error)) return
    call shown_outline(pair%gear(1), pinion)
    call shown_outline(pair%gear(2), gear)
    associate (n => size(pinion, 2), m => size(gear, 2))
      call table%begin('outline of both gears, each about its own centre', n + m, error)
      if (allocated(error)) return
      call table%add_index(axis('member', '', 'pinion or gear', members([(1, i=1, n), (2, i=1, m)])))
      call table%add('x_mm', 'mm', 'across the tooth that stands upright, towards its drive side', &
                     milli*[pinion(1, :), gear(1, :)])
      call table%add('y_mm', 'mm', 'along the axis of that tooth', milli*[pinion(2, :), gear(2, :)])
    end associate
  end subroutine fill_outline

  pure subroutine add_report(self, lines)
    class(section_task_t), intent(in) :: self
    type(lines_t), intent(inout) :: lines

    associate (section => self%tables(self%place('section')))
      call lines%add('')
      call lines%add('Section of the '//trim(section%word('member', 1))//': '//str(nint(section%number('teeth')))//' of '// &
                     str(nint(section%number('gear_teeth')))//' teeth, +/-'//str(section%number('half_angle_deg'), 5)// &
                     ' deg, inner radius '//str(section%number('inner_radius_mm'), 6)//' mm')
      call lines%add('   grid '//str(nint(section%number('elements')))//' elements, '//str(nint(section%number('nodes')))// &
                     ' nodes, smallest scaled Jacobian '//str(section%number('smallest_scaled_jacobian'), 2)//', area '// &
                     str(section%number('area_mm2'), 6)//' mm2')
    end associate
  end subroutine add_report
end module gearsweep_task_section
