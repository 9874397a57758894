!> The task `geometry`: the gear pair, its circles and its path of contact. It runs for every case that has gears.
module gearsweep_task_geometry
  use gearsweep_error, only: error_t
  use gearsweep_gear, only: coast, drive
  use gearsweep_kinds, only: dp, pi
  use gearsweep_lines, only: left, lines_t
  use gearsweep_pair, only: pair_t
  use gearsweep_table, only: table_t
  use gearsweep_task, only: stages_t, task_info_t, task_t
  use gearsweep_text, only: str
  implicit none
  private
  public :: geometry_task_t

  type, extends(task_t) :: geometry_task_t
  contains
    procedure, nopass :: describe
    procedure :: run, add_report
  end type geometry_task_t

  real(dp), parameter :: micro = 1e6_dp, milli = 1e3_dp, degree = pi/180

contains

  pure subroutine describe(info)
    type(task_info_t), intent(out) :: info

    info = task_info_t('geometry', needs='geometry', tables='geometry gears contact_points', fields='', is_always=.true., &
                       gives='diameters, centre distance, working pressure angle, path of contact')
  end subroutine describe

  subroutine run(self, stages, error)
    class(geometry_task_t), intent(inout) :: self
    type(stages_t), intent(in) :: stages
    type(error_t), allocatable, intent(inout) :: error

    call fill_pair(stages%pair, self%tables(self%place('geometry')), error)
    call fill_gears(stages%pair, self%tables(self%place('gears')), error)
    call fill_points(stages%pair, self%tables(self%place('contact_points')), error)
    self%is_done = .true.
    self%log = 'geometry: pair built'
  end subroutine run

  !> The gear pair.
  pure subroutine fill_pair(pair, table, error)
    type(pair_t), intent(in) :: pair
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error

    call table%begin('the gear pair', 1, 11, error)
    if (allocated(error)) return
    associate (spec => pair%gear(1)%spec, widths => pair%gear%spec%face_width)
      call table%add('module_mm', 'mm', 'normal module', [milli*spec%module])
      call table%add('pressure_angle_deg', 'deg', 'of the drive flanks on the reference circle', &
                     [spec%pressure_angle(drive)/degree])
      call table%add('coast_angle_deg', 'deg', 'of the coast flanks on the reference circle', &
                     [spec%pressure_angle(coast)/degree])
      call table%add('face_width_mm', 'mm', 'face width of the contact', [milli*minval(widths)])
      call table%add('centre_distance_mm', 'mm', 'centre distance', [milli*pair%centre_distance])
      call table%add('working_angle_deg', 'deg', 'working pressure angle of the drive flanks', &
                     [pair%working_angle(drive)/degree])
      call table%add('coast_working_angle_deg', 'deg', 'working pressure angle of the coast flanks', &
                     [pair%working_angle(coast)/degree])
      call table%add('backlash_um', 'um', 'along the line of action', [micro*abs(max(0.0_dp, pair%backlash))])
      call table%add('contact_ratio', '', 'transverse contact ratio: the path of contact in base pitches', &
                     [pair%contact_ratio])
      call table%add('base_pitch_mm', 'mm', 'of the drive flanks', [milli*pair%base_pitch])
    end associate
  end subroutine fill_pair

  !> The two gears and their circles.
  pure subroutine fill_gears(pair, table, error)
    type(pair_t), intent(in) :: pair
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    character(*), parameter :: members(2) = [character(6) :: 'pinion', 'gear']
    integer :: i

    call table%begin('the two gears', 2, 9, error, extent=[2])
    if (allocated(error)) return
    associate (gear => pair%gear)
      call table%add_index('member', '', 'pinion or gear', members)
      call table%add('teeth', '', 'number of teeth', [gear%spec%teeth])
      call table%add('tip_diameter_mm', 'mm', 'tip circle', [2*milli*gear%tip_radius])
      call table%add('reference_diameter_mm', 'mm', 'reference circle', [2*milli*gear%reference_radius])
      call table%add('base_diameter_mm', 'mm', 'base circle of the drive flanks', &
                     [(2*milli*gear(i)%base_radius(drive), i=1, 2)])
      call table%add('coast_base_diameter_mm', 'mm', 'base circle of the coast flanks', &
                     [(2*milli*gear(i)%base_radius(coast), i=1, 2)])
      call table%add('root_diameter_mm', 'mm', 'root circle', [2*milli*gear%root_radius])
      call table%add('form_diameter_mm', 'mm', 'circle where the involute of the drive flank begins', &
                     [(2*milli*gear(i)%form_radius(drive), i=1, 2)])
    end associate
  end subroutine fill_gears

  !> Points of the path of contact.
  pure subroutine fill_points(pair, table, error)
    type(pair_t), intent(in) :: pair
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp) :: s(5)

    call table%begin('points of the path of contact: A start, B and D where another pair leaves and enters, P pitch point, '// &
                     'E end', 5, 4, error, extent=[5])
    if (allocated(error)) return
    s = pair%points()
    call table%add_index('point', '', 'its letter', ['A', 'B', 'P', 'D', 'E'])
    call table%add('s', '', 'path coordinate from A, in base pitches', s)
    call table%add('pinion_radius_mm', 'mm', 'radius at which the pinion touches', milli*pair%radius(1, s))
    call table%add('gear_radius_mm', 'mm', 'radius at which the gear touches', milli*pair%radius(2, s))
  end subroutine fill_points

  pure subroutine add_report(self, lines)
    class(geometry_task_t), intent(in) :: self
    type(lines_t), intent(inout) :: lines
    integer :: i

    associate (pair => self%tables(self%place('geometry')), gears => self%tables(self%place('gears')), &
               points => self%tables(self%place('contact_points')))
      call lines%put(left('Pair', 19)//str(nint(gears%number('teeth')))//'/'//str(nint(gears%number('teeth', 2)))// &
                     ' teeth, module '//str(pair%number('module_mm'))//' mm, '//str(pair%number('pressure_angle_deg'))//' deg')
      if (abs(pair%number('coast_angle_deg') - pair%number('pressure_angle_deg')) > 0) &
        call lines%put(' (coast '//str(pair%number('coast_angle_deg'))//')')
      call lines%add(', face width '//str(pair%number('face_width_mm'))//' mm')
      call lines%add(left('', 19)//'centre distance '//str(pair%number('centre_distance_mm'), 7)//' mm, working angle '// &
                     str(pair%number('working_angle_deg'), 7)//' deg, backlash '//str(pair%number('backlash_um'), 4)//' um')
      call lines%add(left('Diameters', 19)//'tip '//trim(both(gears, 'tip'))//', reference '//trim(both(gears, 'reference'))// &
                     ', base '//trim(both(gears, 'base'))//', root '//trim(both(gears, 'root'))//' mm')
      call lines%add(left('', 19)//'involute from '//trim(both(gears, 'form'))//' mm')
      call lines%put(left('Path of contact', 19)//'contact ratio '//str(pair%number('contact_ratio'), 7)//'; pinion radius at ')
      do i = 1, points%rows
        if (i > 1) call lines%put(', ')
        call lines%put(trim(points%word('point', i))//' '//str(points%number('pinion_radius_mm', i), 7))
      end do
      call lines%add(' mm')
    end associate
  end subroutine add_report

  !> A circle's diameters of pinion and gear.
  pure function both(gears, circle) result(words)
    type(table_t), intent(in) :: gears
    character(*), intent(in) :: circle
    character(40) :: words

    words = str(gears%number(circle//'_diameter_mm'), 7)//'/'//str(gears%number(circle//'_diameter_mm', 2), 7)
  end function both
end module gearsweep_task_geometry
