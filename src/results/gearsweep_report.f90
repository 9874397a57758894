!> The answer for the screen: what the pair is and what its tasks found.
module gearsweep_report
  use gearsweep_kinds, only: dp, pi
  use gearsweep_body_report, only: add_modes, add_published, add_root, add_section
  use gearsweep_disc, only: disc_t
  use gearsweep_gear, only: coast, drive
  use gearsweep_lines, only: left, lines_t, right
  use gearsweep_motion_report, only: add_optimum, add_responses, add_sweep
  use gearsweep_status, only: has_result
  use gearsweep_study, only: study_t
  use gearsweep_text, only: fixed, str
  implicit none
  private
  public :: report, write_report, failed_points

  real(dp), parameter :: micro = 1e6_dp, milli = 1e3_dp, degree = pi/180

contains

  !> The answer as text, without timings, so that it is the same in every run.
  pure function report(study) result(text)
    type(study_t), intent(in) :: study
    character(:), allocatable :: text

    call write_report(study, text)
  end function report

  !> The same for several callers at once.
  pure subroutine write_report(study, text)
    type(study_t), intent(in) :: study
    character(:), allocatable, intent(out) :: text
    type(lines_t) :: lines

    if (len(study%case%title) > 0) call lines%add(study%case%title)
    if (allocated(study%pair)) call add_pair(study, lines)
    if (allocated(study%motion)) call add_mesh(study, lines)
    if (allocated(study%section)) call add_section(study, lines)
    if (allocated(study%modal)) call add_modes(study, lines)
    if (allocated(study%root)) call add_root(study, lines)
    if (allocated(study%sharing)) call add_sharing(study, lines)
    if (allocated(study%response)) call add_responses(study, lines)
    if (allocated(study%sweep)) call add_sweep(study, lines)
    if (allocated(study%optimum)) call add_optimum(study, lines)
    if (allocated(study%tasks)) call add_tasks(study, lines)
    if (study%stopped) call lines%add(left('Interrupted', 19)//'what is missing above was not computed')
    if (allocated(study%published)) call add_published(study, lines)
    if (allocated(study%case%unused)) call add_unused(study, lines)
    text = lines%text()
  end subroutine write_report

  !> The tasks that are one file each.
  pure subroutine add_tasks(study, lines)
    type(study_t), intent(in) :: study
    type(lines_t), intent(inout) :: lines
    integer :: i

    do i = 1, size(study%tasks)
      if (.not. allocated(study%tasks(i)%task)) cycle
      if (study%tasks(i)%task%is_done) call study%tasks(i)%task%add_report(lines)
    end do
  end subroutine add_tasks

  !> Keys that the case gives but does not use.
  pure subroutine add_unused(study, lines)
    type(study_t), intent(in) :: study
    type(lines_t), intent(inout) :: lines
    integer :: from, until

    associate (text => study%case%unused)
      from = 1
      do while (from <= len(text))
        until = from + index(text(from:), new_line('a')) - 2
        call lines%add(left(merge('Not used', '        ', from == 1), 19)//'for '//text(from:until))
        from = until + 2
      end do
    end associate
  end subroutine add_unused

  pure subroutine add_pair(study, lines)
    type(study_t), intent(in) :: study
    type(lines_t), intent(inout) :: lines
    real(dp) :: s(5)

    associate (pair => study%pair, spec => study%pair%gear%spec)
      call lines%put(left('Pair', 19)//str(spec(1)%teeth)//'/'//str(spec(2)%teeth)//' teeth, module '// &
                     str(milli*spec(1)%module)//' mm, '//str(spec(1)%pressure_angle(drive)/degree)//' deg')
      if (abs(spec(1)%pressure_angle(coast) - spec(1)%pressure_angle(drive)) > 0) &
        call lines%put(' (coast '//str(spec(1)%pressure_angle(coast)/degree)//')')
      call lines%add(', face width '//str(milli*minval(spec%face_width))//' mm')
      call lines%add(left('', 19)//'centre distance '//str(milli*pair%centre_distance, 7)//' mm, working angle '// &
                     str(pair%working_angle(drive)/degree, 7)//' deg, backlash '//str(micro*max(0.0_dp, pair%backlash), 4)//' um')
      call lines%add(left('Diameters', 19)//'tip '//trim(both(2*milli*pair%gear%tip_radius))//', reference '// &
                     trim(both(2*milli*pair%gear%reference_radius))//', base '//trim(both(2*milli*pair%gear%base_radius(drive)))// &
                     ', root '//trim(both(2*milli*pair%gear%root_radius))//' mm')
      call lines%add(left('', 19)//'involute from '//trim(both(2*milli*pair%gear%form_radius(drive)))//' mm')
      s = pair%points()
      call lines%add(left('Path of contact', 19)//'contact ratio '//str(pair%contact_ratio, 7)//'; pinion radius at A '// &
                     str(milli*pair%radius(1, s(1)), 7)//', B '//str(milli*pair%radius(1, s(2)), 7)//', P '// &
                     str(milli*pair%radius(1, s(3)), 7)//', D '//str(milli*pair%radius(1, s(4)), 7)//', E '// &
                     str(milli*pair%radius(1, s(5)), 7)//' mm')
    end associate
  end subroutine add_pair

  !> Of pinion and gear.
  pure function both(values) result(words)
    real(dp), intent(in) :: values(2)
    character(40) :: words

    words = str(values(1), 7)//'/'//str(values(2), 7)
  end function both

  pure subroutine add_mesh(study, lines)
    type(study_t), intent(in) :: study
    type(lines_t), intent(inout) :: lines
    real(dp) :: hertz, width

    associate (motion => study%motion(1), case => study%case)
      hertz = motion%natural_frequency/(2*pi)
      width = case%spec(1)%face_width
      call lines%put(left('Stiffness', 19)//case%model//': pair '//str(motion%mesh%stiffness%minimum()/micro, 4)//' to '// &
                     str(motion%mesh%stiffness%maximum()/micro, 4)//', mesh mean '// &
                     str(motion%mesh%mean_stiffness()/micro, 4)//' N/um')
      if (width > 0) call lines%put(' ('//str(motion%mesh%mean_stiffness()/width*1e-9_dp, 4)//' N/um per mm of width)')
      call lines%add('')
      if (motion%mesh%disc%turn > 0) call add_disc(motion%mesh%disc, study%load, lines)
      call lines%put(left('Load', 19)//str(study%load, 5)//' N on the line of action, effective masses '// &
                     str(study%mass(1), 4)//' and '//str(study%mass(2), 4)//' kg')
      if (case%needs('losses')) call lines%put(', damping ratio '//str(case%damping_ratio))
      if (case%needs('motion')) call lines%put(', friction '//str(case%friction))
      call lines%add('')
      call lines%add(left('Natural frequency', 19)//str(hertz, 5)//' Hz: the mesh excites it at '// &
                     str(60*hertz/motion%mesh%teeth(1), 5)//' rpm of the pinion')
    end associate
  end subroutine add_mesh

  !> What no pair's stiffness has.
  pure subroutine add_disc(disc, load, lines)
    type(disc_t), intent(in) :: disc
    real(dp), intent(in) :: load
    type(lines_t), intent(inout) :: lines

    call lines%add(left('Discs', 19)//'turn by '//str(micro*load*disc%turn, 4)//' um on the line of action about their bores: '// &
                   'in the static transmission error,')
    call lines%add(left('', 19)//'not in the pairs'' stiffness nor in the motion; neighbouring teeth share '// &
                   str(micro*load*disc%shared, 4)//' um')
  end subroutine add_disc

  pure subroutine add_sharing(study, lines)
    type(study_t), intent(in) :: study
    type(lines_t), intent(inout) :: lines
    integer :: i, k

    call lines%add('')
    call lines%add('Static transmission error')
    call lines%add('   relief um   peak-to-peak um   mean um   harmonics 1, 2, 3 um         largest pair load/static')
    do i = 1, size(study%sharing)
      associate (ste => study%harmonics(i))
        call lines%put(right(str(micro*study%case%amount(i)), 12)//right(str(micro*ste%peak_to_peak(), 4), 18)// &
                       right(str(micro*ste%mean, 4), 10)//'  ')
        do k = 1, 3
          if (k > size(ste%amplitude)) call lines%put(repeat(' ', 9))
          if (k <= size(ste%amplitude)) call lines%put(right(str(micro*ste%amplitude(k), 3), 9))
        end do
        call lines%add(right(fixed(maxval(study%sharing(i)%load)/study%load, 4), 26))
      end associate
    end do
  end subroutine add_sharing

  !> Operating points without an answer, in the sweep, at the chosen speeds,
  !> at the optimum relief and in the tasks that are one file each.
  pure integer function failed_points(study) result(n)
    type(study_t), intent(in) :: study
    integer :: i

    n = 0
    if (allocated(study%sweep)) n = count(.not. has_result(study%sweep%status))
    if (allocated(study%response)) n = n + count(.not. has_result(study%response%point%steady%status))
    if (allocated(study%optimum)) then
      if (study%optimum%best == 0) then
        n = n + sum(study%optimum%failed)
      else
        n = n + study%optimum%failed(study%optimum%best)
      end if
    end if
    if (.not. allocated(study%tasks)) return
    do i = 1, size(study%tasks)
      if (allocated(study%tasks(i)%task)) n = n + study%tasks(i)%task%failed
    end do
  end function failed_points
end module gearsweep_report
