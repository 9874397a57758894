!> The answer for the screen: what the pair is, where it resonates, which relief is best.
module gearsweep_report
  use gearsweep_kinds, only: dp, pi
  use gearsweep_gear, only: coast, drive
  use gearsweep_body_report, only: add_modes, add_published, add_root, add_section
  use gearsweep_lines, only: lines_t, right
  use gearsweep_optimum, only: peak_t, worst_of
  use gearsweep_steady, only: has_answer, name_of, point_chaotic
  use gearsweep_study, only: study_t
  use gearsweep_text, only: str
  implicit none
  private
  public :: report, failed_points

  real(dp), parameter :: micro = 1e6_dp, milli = 1e3_dp, degree = pi/180

contains

  !> The answer as text, without timings, so that it is the same in every run.
  pure function report(study) result(text)
    type(study_t), intent(in) :: study
    character(:), allocatable :: text
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
    if (allocated(study%published)) call add_published(study, lines)
    text = lines%text()
  end function report

  !> `label` in a column of its own, then the text.
  pure function row(label, words) result(line)
    character(*), intent(in) :: label, words
    character(:), allocatable :: line
    character(19) :: column

    column = label
    line = column//words
  end function row

  pure subroutine add_pair(study, lines)
    type(study_t), intent(in) :: study
    type(lines_t), intent(inout) :: lines
    character(:), allocatable :: angle
    real(dp) :: s(5)

    associate (pair => study%pair, spec => study%pair%gear%spec)
      angle = str(spec(1)%pressure_angle(drive)/degree)//' deg'
      if (abs(spec(1)%pressure_angle(coast) - spec(1)%pressure_angle(drive)) > 0) &
        angle = angle//' (coast '//str(spec(1)%pressure_angle(coast)/degree)//')'
      call lines%add(row('Pair', str(spec(1)%teeth)//'/'//str(spec(2)%teeth)//' teeth, module '// &
                         str(milli*spec(1)%module)//' mm, '//angle//', face width '// &
                         str(milli*minval(spec%face_width))//' mm'))
      call lines%add(row('', 'centre distance '//str(milli*pair%centre_distance, 7)//' mm, working angle '// &
                         str(pair%working_angle(drive)/degree, 7)//' deg, backlash '// &
                         str(micro*max(0.0_dp, pair%backlash), 4)//' um'))
      call lines%add(row('Diameters', 'tip '//both(2*milli*pair%gear%tip_radius)//', reference '// &
                         both(2*milli*pair%gear%reference_radius)//', base '// &
                         both(2*milli*pair%gear%base_radius(drive))//', root '//both(2*milli*pair%gear%root_radius)//' mm'))
      s = pair%points()
      call lines%add(row('Path of contact', 'contact ratio '//str(pair%contact_ratio, 7)//'; pinion radius at A '// &
                         str(milli*pair%radius(1, s(1)), 7)//', B '//str(milli*pair%radius(1, s(2)), 7)//', P '// &
                         str(milli*pair%radius(1, s(3)), 7)//', D '//str(milli*pair%radius(1, s(4)), 7)//', E '// &
                         str(milli*pair%radius(1, s(5)), 7)//' mm'))
    end associate
  end subroutine add_pair

  pure function both(values) result(text)
    real(dp), intent(in) :: values(2)
    character(:), allocatable :: text

    text = str(values(1), 7)//'/'//str(values(2), 7)
  end function both

  pure subroutine add_mesh(study, lines)
    type(study_t), intent(in) :: study
    type(lines_t), intent(inout) :: lines
    real(dp) :: hertz, width

    associate (motion => study%motion(1), case => study%case)
      hertz = motion%natural_frequency/(2*pi)
      width = case%spec(1)%face_width
      call lines%add(row('Stiffness', case%model//': pair '//str(motion%mesh%stiffness%minimum()/micro, 4)//' to '// &
                         str(motion%mesh%stiffness%maximum()/micro, 4)//', mesh mean '// &
                         str(motion%mesh%mean_stiffness()/micro, 4)//' N/um'//per_width()))
      call lines%add(row('Load', str(study%load, 5)//' N on the line of action, effective masses '// &
                         str(study%mass(1), 4)//' and '//str(study%mass(2), 4)//' kg, damping ratio '// &
                         str(case%damping_ratio)//', friction '//str(case%friction)))
      call lines%add(row('Natural frequency', str(hertz, 5)//' Hz: the mesh excites it at '// &
                         str(60*hertz/motion%mesh%teeth(1), 5)//' rpm of the pinion'))
    end associate

  contains

    pure function per_width() result(words)
      character(:), allocatable :: words

      words = ''
      if (width > 0) words = ' ('//str(study%mesh%mean_stiffness()/width*1e-9_dp, 4)//' N/um per mm of width)'
    end function per_width
  end subroutine add_mesh

  pure subroutine add_sharing(study, lines)
    type(study_t), intent(in) :: study
    type(lines_t), intent(inout) :: lines
    character(:), allocatable :: line
    integer :: i, k

    call lines%add('')
    call lines%add('Static transmission error')
    call lines%add('   relief um   peak-to-peak um   mean um   harmonics 1, 2, 3 um         largest pair load/static')
    do i = 1, size(study%sharing)
      associate (ste => study%harmonics(i))
        line = right(str(micro*study%case%amount(i)), 12)//right(str(micro*ste%peak_to_peak(), 4), 18)// &
               right(str(micro*ste%mean, 4), 10)//'  '
        do k = 1, 3
          if (k > size(ste%amplitude)) line = line//repeat(' ', 9)
          if (k <= size(ste%amplitude)) line = line//right(str(micro*ste%amplitude(k), 3), 9)
        end do
        call lines%add(line//right(fixed(maxval(study%sharing(i)%load)/study%load, 4), 26))
      end associate
    end do
  end subroutine add_sharing

  pure subroutine add_responses(study, lines)
    type(study_t), intent(in) :: study
    type(lines_t), intent(inout) :: lines
    integer :: i, k

    call lines%add('')
    call lines%add('Dynamic factor at chosen speeds')
    call lines%add('   relief um         rpm        DF     error est.   status')
    do k = 1, size(study%response, 2)
      do i = 1, size(study%response, 1)
        associate (response => study%response(i, k))
          if (has_answer(response%point%steady%status)) then
            call lines%add(right(str(micro*study%case%amount(i)), 12)//right(str(response%rpm), 12)// &
                           right(fixed(response%point%dynamic_factor, 4), 10)//right(str(response%point%estimate, 2), 15)// &
                           '   '//name_of(response%point%steady%status))
          else
            call lines%add(right(str(micro*study%case%amount(i)), 12)//right(str(response%rpm), 12)// &
                           right('none', 10)//right('-', 15)//'   '//name_of(response%point%steady%status))
          end if
        end associate
      end do
    end do
  end subroutine add_responses

  pure subroutine add_sweep(study, lines)
    type(study_t), intent(in) :: study
    type(lines_t), intent(inout) :: lines
    type(peak_t) :: worst
    character(:), allocatable :: line
    integer :: i, k, best
    real(dp) :: least

    associate (sweep => study%sweep, amount => study%case%amount)
      call lines%add('')
      call lines%add('Dynamic factor over '//str(size(sweep%rpm))//' speeds, '//str(sweep%rpm(1))//' to '// &
                     str(sweep%rpm(size(sweep%rpm)))//' rpm')
      line = '   relief um     worst    at rpm'
      if (size(study%resonance) > 0) line = line//'   in resonance at rpm (within 15 %)'
      call lines%add(line)
      line = repeat(' ', 32)
      do k = 1, size(study%resonance)
        line = line//right(str(anint(study%resonance(k)%rpm)), 10)
      end do
      if (size(study%resonance) > 0) call lines%add(line)
      best = 0
      least = huge(least)
      do i = 1, size(amount)
        worst = worst_of(sweep%rpm, sweep%dynamic_factor(:, i))
        if (.not. worst%rpm > 0) then
          call lines%add(right(str(micro*amount(i)), 12)//right('none', 10))
          cycle
        end if
        if (worst%dynamic_factor < least) best = i
        least = min(least, worst%dynamic_factor)
        line = right(str(micro*amount(i)), 12)//right(fixed(worst%dynamic_factor, 4), 10)//right(str(worst%rpm), 10)
        do k = 1, size(study%resonance)
          line = line//right(near(sweep%rpm, sweep%dynamic_factor(:, i), study%resonance(k)%rpm), 10)
        end do
        call lines%add(line)
      end do
      if (best > 0 .and. size(amount) > 1) call lines%add(row('Best of the list', str(micro*amount(best))// &
        ' um: worst DF '//fixed(least, 4)))
      call add_quality(study, lines)
    end associate
  end subroutine add_sweep

  !> How exact, and what failed.
  pure subroutine add_quality(study, lines)
    type(study_t), intent(in) :: study
    type(lines_t), intent(inout) :: lines
    character(:), allocatable :: error
    integer :: status, n

    associate (sweep => study%sweep)
      n = count(.not. has_answer(sweep%status))
      error = ''
      if (n < size(sweep%status)) error = '; estimated error of DF at most '// &
        str(maxval(sweep%estimate, mask=has_answer(sweep%status)), 2)// &
        ' (asked for '//str(study%case%accuracy%steady%tolerance)//')'
      call lines%add(row('Points', str(size(sweep%status))//', without an answer '//str(n)//error))
      do status = 1, point_chaotic
        n = count(sweep%status == status)
        if (n > 0) call lines%add(row('', str(n)//' '//name_of(status)//': '//meaning(status)))
      end do
      n = count(sweep%contact >= 2)
      if (n > 0) call lines%add(row('', str(n)//' with loss of contact'))
    end associate
  end subroutine add_quality

  pure function meaning(status) result(words)
    integer, intent(in) :: status
    character(:), allocatable :: words

    select case (name_of(status))
    case ('marginal')
      words = 'periodic, but transients do not die out'
    case ('subharmonic')
      words = 'the motion repeats only after several mesh periods'
    case ('inexact')
      words = 'the estimated error exceeds the tolerance'
    case ('unstable')
      words = 'the periodic motion repels, and no steady motion was reached'
    case ('aperiodic')
      words = 'no periodic motion was found'
    case ('chaotic')
      words = 'no periodic motion was found, and disturbances keep growing'
    case ('unresolved')
      words = 'the speed is too low for the steps given or allowed'
    case default
      words = 'contact changes without end'
    end select
  end function meaning

  pure subroutine add_optimum(study, lines)
    type(study_t), intent(in) :: study
    type(lines_t), intent(inout) :: lines

    associate (optimum => study%optimum)
      if (optimum%best == 0) then
        call lines%add(row('Optimum relief', 'none: no operating point has an answer'))
      else
        call lines%add(row('Optimum relief', str(micro*optimum%amount(optimum%best), 4)//' um (within '// &
                           str(micro*optimum%resolution, 1)//'): worst DF '// &
                           fixed(optimum%dynamic_factor(optimum%best), 4)//' at '//str(optimum%rpm(optimum%best))//' rpm'))
        if (optimum%best == size(optimum%amount)) call lines%add(row('', 'at the end of the range searched: more '// &
                                                                     'relief may be better still'))
        if (optimum%failed(optimum%best) > 0) call lines%add(row('', str(optimum%failed(optimum%best))// &
                                                                 ' speeds have no answer there'))
      end if
    end associate
  end subroutine add_optimum

  !> Largest value within 15 % of a speed.
  pure function near(rpm, dynamic_factor, centre) result(words)
    real(dp), intent(in) :: rpm(:), dynamic_factor(:), centre
    character(:), allocatable :: words
    type(peak_t) :: worst

    worst = worst_of(pack(rpm, abs(rpm - centre) <= 0.15_dp*centre), &
                     pack(dynamic_factor, abs(rpm - centre) <= 0.15_dp*centre))
    words = 'none'
    if (worst%rpm > 0) words = fixed(worst%dynamic_factor, 4)
  end function near

  !> Operating points without an answer, in the sweep, at the chosen speeds and
  !> at the optimum relief.
  pure integer function failed_points(study) result(n)
    type(study_t), intent(in) :: study

    n = 0
    if (allocated(study%sweep)) n = count(.not. has_answer(study%sweep%status))
    if (allocated(study%response)) n = n + count(.not. has_answer(study%response%point%steady%status))
    if (allocated(study%optimum)) then
      if (study%optimum%best == 0) then
        n = n + sum(study%optimum%failed)
      else
        n = n + study%optimum%failed(study%optimum%best)
      end if
    end if
  end function failed_points

  pure function fixed(x, decimals) result(words)
    real(dp), intent(in) :: x
    integer, intent(in) :: decimals
    character(:), allocatable :: words
    character(40) :: buffer

    words = str(x)
    if (.not. abs(x) < 1e6_dp) return
    write (buffer, '(f0.'//str(decimals)//')') x
    words = trim(buffer)
    if (words(1:1) == '.') words = '0'//words
  end function fixed
end module gearsweep_report
