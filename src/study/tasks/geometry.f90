!> The task `geometry`: the gear pair, its circles and its path of contact. It runs for every case that has gears; the
!> outlines of both gears only if the case names it.
module gearsweep_study_tasks_geometry
  use gearsweep_base, only: axis, dp, error_t, left, lines_t, no_number, str, table_t
  use gearsweep_gear, only: coast, drive, find_measures, generating_shift, measures_t, pair_t, shown_outline
  use gearsweep_study_case_task, only: gear_names, stage, task_info_t
  use gearsweep_study_reader_reader, only: reader_t
  use gearsweep_study_run_stages, only: runnable_t, stages_t
  implicit none
  private
  public :: geometry_task_t

  type, extends(runnable_t) :: geometry_task_t
    logical :: is_named = .false.                !< true if the case names the task
  contains
    procedure, nopass :: describe
    procedure :: read_keys, run, add_report
  end type geometry_task_t

contains

  pure subroutine describe(info)
    type(task_info_t), intent(out) :: info

    info = task_info_t('geometry', needs=[stage%geometry], tables='geometry gears contact_points outline', fields='', &
                       is_always=.true., has_helical=.true., &
                       summary='diameters, centre distance, working pressure angle, path of contact; outlines of both gears')
  end subroutine describe

  !> The task has no keys.
  subroutine read_keys(self, reader, error)
    class(geometry_task_t), intent(inout) :: self
    type(reader_t), intent(inout) :: reader
    type(error_t), allocatable, intent(inout) :: error

    if (.not. allocated(error)) self%is_named = reader%requests('geometry')
  end subroutine read_keys

  subroutine run(self, stages, error)
    class(geometry_task_t), intent(inout) :: self
    type(stages_t), intent(in) :: stages
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: pinion(:, :), gear(:, :)
    integer :: i
    real(dp) :: s(5)

    associate (table => self%tables(self%place('geometry')))
      call table%begin('the gear pair', 1, error)
      if (allocated(error)) return
      associate (spec => stages%pair%gear(1)%spec, widths => stages%pair%gear%spec%face_width)
        call table%add('module_mm', 'mm', 'normal module', [spec%module])
        call table%add('pressure_angle_deg', 'deg', 'of the drive flanks on the reference circle', [spec%pressure_angle(drive)])
        call table%add('coast_angle_deg', 'deg', 'of the coast flanks on the reference circle', [spec%pressure_angle(coast)])
        call table%add('face_width_mm', 'mm', 'face width of the contact', [minval(widths)])
        call table%add('centre_distance_mm', 'mm', 'centre distance', [stages%pair%centre_distance])
        call table%add('working_angle_deg', 'deg', 'working pressure angle of the drive flanks', [stages%pair%working_angle(drive)])
        call table%add('coast_working_angle_deg', 'deg', 'working pressure angle of the coast flanks', &
          [stages%pair%working_angle(coast)])
        call table%add('backlash_um', 'um', 'along the line of action: as backlash_um of &pair states it, '// &
                       'else what centre distance and tooth thickness leave', [max(0.0_dp, stages%pair%backlash)])
        call table%add('rounding_um', 'um', 'how far the centre distance lies below the one without backlash, by rounding of '// &
                       'the inputs', [stages%pair%rounding])
        call table%add('shorten_path', '', '1 where the path of contact may end where undercut ends an involute, else 0', &
                       [merge(1, 0, stages%pair%may_shorten)])
        call table%add('contact_ratio', '', 'transverse contact ratio: the path of contact in base pitches', &
                       [stages%pair%contact_ratio])
        call table%add('coast_contact_ratio', '', 'the same of the coast flanks, where they carry; undercut takes its part off', &
                       [stages%pair%coast_contact_ratio])
        call table%add('base_pitch_mm', 'mm', 'of the drive flanks', [stages%pair%base_pitch])
        if (abs(spec%helix_angle) > 0) then
          call table%add('transverse_module_mm', 'mm', 'module of helical gears in the transverse section', &
                         [spec%module/cos(spec%helix_angle)])
          call table%add('transverse_angle_deg', 'deg', 'pressure angle of helical gears in the transverse section', &
                         [stages%pair%gear(1)%transverse_angle(drive)])
          call table%add('overlap_ratio', '', 'overlap ratio of helical gears: face width over axial pitch', &
                         [stages%pair%overlap_ratio])
          call table%add('total_contact_ratio', '', 'total contact ratio of helical gears: contact ratio plus overlap ratio', &
                         [stages%pair%contact_ratio + stages%pair%overlap_ratio])
        end if
      end associate
    end associate
    call fill_gears(stages%pair, self%tables(self%place('gears')), error)
    associate (table => self%tables(self%place('contact_points')))
      call table%over('points of the path of contact: A start, B and D where another pair leaves and enters, P pitch point, '// &
                      'E end', error, axis('point', '', 'its letter', ['A', 'B', 'P', 'D', 'E']))
      if (allocated(error)) return
      s = stages%pair%points()
      call table%add('s', '', 'path coordinate from A, in base pitches', s)
      call table%add('pinion_radius_mm', 'mm', 'radius at which the pinion touches', stages%pair%radius(1, s))
      call table%add('gear_radius_mm', 'mm', 'radius at which the gear touches', stages%pair%radius(2, s))
    end associate
    if (self%is_named) then
      associate (table => self%tables(self%place('outline')))
        call shown_outline(stages%pair%gear(1), pinion)
        call shown_outline(stages%pair%gear(2), gear)
        associate (n => size(pinion, 2), m => size(gear, 2))
          call table%begin('outline of both gears, each about its own centre', n + m, error)
          if (allocated(error)) return
          call table%add_index(axis('gear', '', 'pinion or gear', gear_names([(1, i=1, n), (2, i=1, m)])))
          call table%add('x_mm', 'mm', 'across the tooth that stands upright, towards its drive side', [pinion(1, :), gear(1, :)])
          call table%add('y_mm', 'mm', 'along the axis of that tooth', [pinion(2, :), gear(2, :)])
        end associate
      end associate
    end if
    self%is_done = .true.
    self%log = 'geometry: pair built'
  end subroutine run

  !> Fills the table of the two gears and their circles.
  pure subroutine fill_gears(pair, table, error)
    type(pair_t), intent(in) :: pair
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    type(measures_t) :: measures(2)
    integer :: i

    call table%over('the two gears', error, axis('gear', '', 'pinion or gear', gear_names))
    if (allocated(error)) return
    associate (gear => pair%gear)
      call table%add('teeth', '', 'number of teeth', [gear%spec%teeth])
      call table%add('profile_shift', '', 'profile shift coefficient x', [gear%spec%profile_shift])
      call table%add('tip_diameter_mm', 'mm', 'tip circle', [2*gear%tip_radius])
      call table%add('tip_form_diameter_mm', 'mm', 'circle where the involute of the drive flank ends: the tip circle, or '// &
                     'where its chamfer or rounding begins', 2*gear%tip_form_radius)
      call table%add('tip_thickness_mm', 'mm', 'of the tooth on the tip circle, between its chamfers or roundings', &
                     [(gear(i)%tip_radius*(gear(i)%tip_half_angle(drive) + gear(i)%tip_half_angle(coast)), i=1, 2)])
      call table%add('reference_diameter_mm', 'mm', 'reference circle', [2*gear%reference_radius])
      call table%add('base_diameter_mm', 'mm', 'base circle of the drive flanks', [(2*gear(i)%base_radius(drive), i=1, 2)])
      call table%add('coast_base_diameter_mm', 'mm', 'base circle of the coast flanks', [(2*gear(i)%base_radius(coast), i=1, 2)])
      call table%add('root_diameter_mm', 'mm', 'root circle', [2*gear%root_radius])
      call table%add('form_diameter_mm', 'mm', 'circle where the involute of the drive flank begins', &
                     [(2*gear(i)%form_radius(drive), i=1, 2)])
      call table%add('coast_form_diameter_mm', 'mm', 'circle where the involute of the coast flank begins', &
                     [(2*gear(i)%form_radius(coast), i=1, 2)])
      call table%add('active_diameter_mm', 'mm', 'circle where contact on the drive flank begins, d_Nf', &
                     2*[pair%radius(1, 0.0_dp), pair%radius(2, pair%contact_ratio)])
      call table%add('undercut', '', '1 where undercut of the drive flank cuts into the involute above the base circle, else 0', &
                     [(merge(1, 0, gear(i)%is_undercut(drive)), i=1, 2)])
      call table%add('fillet_undercut_mm', 'mm', 'how deep a tool with protuberance cut the fillet in beside the finished '// &
                     'flank, s_pr', &
                     [((gear(i)%spec%protuberance - gear(i)%spec%grinding_stock), i=1, 2)])
      call table%add('lost_path_mm', 'mm', 'what undercut of this gear takes off the path of contact (shorten_path)', pair%lost)
      call table%add('generating_shift', '', 'generating profile shift coefficient x_E', &
                     [(generating_shift(gear(i)%spec), i=1, 2)])
      call table%add('reference_thickness_mm', 'mm', 'tooth thickness on the reference circle, as generated', &
                     [(gear(i)%thickness(gear(i)%reference_radius), i=1, 2)])
    end associate
    do i = 1, 2
      measures(i) = find_measures(pair%gear(i))
    end do
    call table%add('span_teeth', '', 'number of teeth k that the span measurement takes; 0: none can be spanned', &
                   [measures%span_teeth])
    call table%add('span_mm', 'mm', 'span measurement W_k, base tangent length', measured(measures%span))
    call table%add('pin_diameter_mm', 'mm', 'pins that the gear is measured over', measured(measures%pin_diameter))
    call table%add('over_pins_mm', 'mm', 'diameter over pins M_dK', measured(measures%over_pins))
    if (.not. any(abs(pair%gear%spec%helix_angle) > 0)) return
    call table%add('helix_angle_deg', 'deg', 'helix angle of helical gears on the reference circle; positive: right-handed', &
                   [pair%gear%spec%helix_angle])
    call table%add('base_helix_angle_deg', 'deg', 'helix angle of helical gears on the base circle; positive: right-handed', &
                   [pair%gear%base_helix()])
  end subroutine fill_gears

  !> The measured length, or NaN for none.
  elemental real(dp) function measured(length)
    real(dp), intent(in) :: length

    measured = length
    if (.not. length > 0) measured = no_number()
  end function measured

  pure subroutine add_report(self, lines)
    class(geometry_task_t), intent(in) :: self
    type(lines_t), intent(inout) :: lines
    logical :: is_helical
    integer :: i

    associate (pair => self%tables(self%place('geometry')), gears => self%tables(self%place('gears')), &
               points => self%tables(self%place('contact_points')))
      call lines%put(left('Pair', 19)//str(nint(gears%number('teeth')))//'/'//str(nint(gears%number('teeth', 2)))// &
                     ' teeth, module '//str(pair%number('module_mm'))//' mm, '//str(pair%number('pressure_angle_deg'))//' deg')
      if (abs(pair%number('coast_angle_deg') - pair%number('pressure_angle_deg')) > 0) &
        call lines%put(' (coast '//str(pair%number('coast_angle_deg'))//')')
      is_helical = pair%position('overlap_ratio') > 0
      if (is_helical) call lines%put(', helix '//str(abs(gears%number('helix_angle_deg')))//' deg, pinion '// &
        trim(merge('right', 'left ', gears%number('helix_angle_deg') > 0))//'-handed')
      call lines%add(', face width '//str(pair%number('face_width_mm'))//' mm')
      call lines%put(left('', 19)//'centre distance '//str(pair%number('centre_distance_mm'), 7)//' mm, working angle '// &
                     str(pair%number('working_angle_deg'), 7)//' deg, ')
      if (pair%number('backlash_um') > 0) call lines%put('backlash '//str(pair%number('backlash_um'), 4)//' um')
      if (.not. pair%number('backlash_um') > 0) call lines%put('nominally without backlash')
      call lines%add('')
      call lines%add(left('Diameters', 19)//'tip '//trim(both(gears, 'tip'))//', reference '//trim(both(gears, 'reference'))// &
                     ', base '//trim(both(gears, 'base'))//', root '//trim(both(gears, 'root'))//' mm')
      call lines%add(left('', 19)//'involute from '//trim(both(gears, 'form'))//' mm')
      call lines%put(left('Path of contact', 19)//'contact ratio '//str(pair%number('contact_ratio'), 7))
      if (is_helical) call lines%put(', overlap ratio '//str(pair%number('overlap_ratio'), 7)//', total '// &
        str(pair%number('total_contact_ratio'), 7))
      call lines%put('; pinion radius at ')
      do i = 1, points%rows
        if (i > 1) call lines%put(', ')
        call lines%put(trim(points%word('point', i))//' '//str(points%number('pinion_radius_mm', i), 7))
      end do
      call lines%add(' mm')
    end associate
    associate (pair => self%tables(self%place('geometry')), gears => self%tables(self%place('gears')))
      do i = 1, 2
        associate (tip => gears%number('tip_diameter_mm', i), form => gears%number('tip_form_diameter_mm', i))
          if (tip > form) call lines%add(left('Tip', 19)//'of the '//trim(gear_names(i))//': chamfer or rounding from '// &
            str(form, 7)//' to '//str(tip, 7)//' mm diameter; stiffness, stress and modes are without it')
        end associate
      end do
      do i = 1, 2
        if (max(gears%number('undercut', i), gears%number('fillet_undercut_mm', i)) > 0) &
          call lines%add(left('Undercut', 19)//'of the '//trim(gear_names(i))//' up to '// &
          str(gears%number('form_diameter_mm', i), 7)//' mm diameter; contact from '// &
          str(gears%number('active_diameter_mm', i), 7)//' mm on')
      end do
      if (pair%number('shorten_path') > 0) call lines%add(left('', 19)//'path of contact shortened by '// &
        str(gears%number('lost_path_mm'), 7)//' mm for the pinion, '//str(gears%number('lost_path_mm', 2), 7)//' for the gear')
      if (pair%number('rounding_um') > 0) call lines%add(left('', 19)//'centre distance '//str(pair%number('rounding_um'), 3)// &
        ' um below the one without backlash: taken for rounding of the inputs')
      do i = 1, 2
        if (.not. abs(gears%number('generating_shift', i) - gears%number('profile_shift', i)) > 0) cycle
        call lines%put(left('Tooth thickness', 19)//'of the '//trim(gear_names(i))//': generating profile shift '// &
                       str(gears%number('generating_shift', i)))
        if (gears%number('span_teeth', i) > 0) call lines%put(', span over '//str(nint(gears%number('span_teeth', i)))// &
          ' teeth '//str(gears%number('span_mm', i), 7)//' mm')
        if (gears%number('over_pins_mm', i) > 0) call lines%put(', over '//trim(merge('balls', 'pins ', is_helical))//' of '// &
          str(gears%number('pin_diameter_mm', i), 4)//' mm '//str(gears%number('over_pins_mm', i), 7)//' mm')
        call lines%add('')
      end do
    end associate
  end subroutine add_report

  !> Diameters of a circle of pinion and gear, in words.
  pure function both(gears, circle) result(words)
    type(table_t), intent(in) :: gears
    character(*), intent(in) :: circle
    character(40) :: words

    words = str(gears%number(circle//'_diameter_mm'), 7)//'/'//str(gears%number(circle//'_diameter_mm', 2), 7)
  end function both
end module gearsweep_study_tasks_geometry
