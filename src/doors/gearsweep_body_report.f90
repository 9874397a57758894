!> The answers of the tasks that look at one member's body, for screen and tables.
module gearsweep_body_report
  use gearsweep_kinds, only: dp, pi
  use gearsweep_contour, only: shown_contour
  use gearsweep_gear, only: coast, drive
  use gearsweep_lines, only: lines_t, field, left, right
  use gearsweep_quantities, only: our_value
  use gearsweep_study, only: study_t
  use gearsweep_text, only: str
  implicit none
  private
  public :: add_section, add_root, add_modes, add_published
  public :: outline_rows, root_rows, mode_rows, published_rows

  real(dp), parameter :: mega = 1e-6_dp, milli = 1e3_dp, degree = pi/180
  character(*), parameter :: members(2) = [character(6) :: 'pinion', 'gear']

contains

  pure subroutine add_section(study, lines)
    type(study_t), intent(in) :: study
    type(lines_t), intent(inout) :: lines

    associate (section => study%section, grid => study%section%grid)
      call lines%add('')
      call lines%add('Section of the '//trim(members(study%case%root%member))//': '// &
                     str(section%options%teeth)//' of '//str(section%gear%spec%teeth)//' teeth, +/-'// &
                     str(section%half_angle/degree, 5)//' deg, inner radius '//str(milli*section%inner_radius, 6)//' mm')
      call lines%add('   grid '//str(size(grid%element, 2))//' elements, '//str(size(grid%x, 2))//' nodes, smallest scaled '// &
                     'Jacobian '//str(grid%quality(), 2)//', area '//str(milli**2*grid%area(), 6)//' mm2')
    end associate
  end subroutine add_section

  pure subroutine add_root(study, lines)
    type(study_t), intent(in) :: study
    type(lines_t), intent(inout) :: lines
    integer :: i

    call lines%add('')
    call lines%add('Root stress of the '//trim(members(study%case%root%member))//', largest over the path of contact')
    call lines%add('   relief um   tension MPa at tangent deg   compression MPa at tangent deg   error est. %')
    do i = 1, size(study%root)
      associate (stress => study%root(i)%stress)
        call lines%add(right(str(1e6_dp*study%case%amount(i)), 12)//right(str(mega*stress%tension%stress, 5), 14)// &
                       right(str(stress%tension%tangent/degree, 3), 15)//right(str(mega*stress%compression%stress, 5), 18)// &
                       right(str(stress%compression%tangent/degree, 3), 15)//right(str(100*stress%error_estimate, 2), 15))
      end associate
    end do
    associate (root => study%root(1))
      call lines%add('   ISO 6336-3: sigma_F0 '//str(mega*root%iso_stress, 5)//' MPa (Y_F '//str(root%iso%form_factor, 4)// &
                     ', Y_S '//str(root%iso%correction, 4)//'); Lewis '//str(mega*root%lewis_stress, 5)//' MPa (Y '// &
                     str(root%lewis, 4)//'); for the whole load at point '//trim(merge('D', 'B', study%case%root%member == 1))//'')
    end associate
  end subroutine add_root

  pure subroutine add_modes(study, lines)
    type(study_t), intent(in) :: study
    type(lines_t), intent(inout) :: lines
    integer :: i

    associate (modes => study%modal%modes)
      call lines%add('')
      call lines%add('Natural frequencies of the section')
      call lines%add('   mode          Hz   error est. %   residual   kinetic energy of rim and teeth %')
      do i = 1, size(modes%frequency)
        call lines%add(right(str(i), 7)//right(str(modes%frequency(i), 6), 12)// &
                       right(str(100*study%modal%error_estimate(i), 2), 15)//right(str(modes%residual(i), 1), 11)//'   '// &
                       shares(modes%participation(:, i)))
      end do
    end associate

  contains

    pure function shares(part) result(words)
      real(dp), intent(in) :: part(0:)
      character(:), allocatable :: words
      integer :: tooth

      words = ''
      do tooth = 0, ubound(part, 1)
        if (tooth > 7) exit
        words = words//right(str(nint(100*part(tooth))), 4)
      end do
    end function shares
  end subroutine add_modes

  !> Printed values beside ours, for the screen.
  pure subroutine add_published(study, lines)
    type(study_t), intent(in) :: study
    type(lines_t), intent(inout) :: lines
    real(dp) :: value
    logical :: known
    integer :: i

    call lines%add('')
    call lines%add('Printed values and ours')
    call lines%add('   quantity                    place           printed        ours   deviation   status')
    do i = 1, size(study%published)
      associate (row => study%published(i))
        call our_value(study, row%quantity, value, known)
        if (known) then
          call lines%add('   '//left(row%quantity, 28)//left(row%place, 12)//right(str(row%printed), 11)// &
                         right(str(value), 12)//right(percent(value/row%printed - 1), 12)//'   '//row%status)
        else
          call lines%add('   '//left(row%quantity, 28)//left(row%place, 12)//right(str(row%printed), 11)// &
                         right('-', 12)//right('-', 12)//'   not computed by these tasks')
        end if
      end associate
    end do
  end subroutine add_published

  !> The same as table rows.
  pure subroutine published_rows(study, lines)
    type(study_t), intent(in) :: study
    type(lines_t), intent(inout) :: lines
    character(:), allocatable :: ours
    real(dp) :: value
    logical :: known
    integer :: i

    do i = 1, size(study%published)
      associate (row => study%published(i))
        call our_value(study, row%quantity, value, known)
        ours = 'NaN,NaN'
        if (known) ours = field(value)//','//field(value/row%printed - 1)
        call lines%add(row%quantity//','//row%place//','//field(row%printed)//','//ours//','//row%unit//','// &
                       row%status//',"'//quoted(row%reason)//'"')
      end associate
    end do
  end subroutine published_rows

  !> Quotation marks doubled, as CSV wants them.
  pure function quoted(words) result(text)
    character(*), intent(in) :: words
    character(:), allocatable :: text
    integer :: i

    text = ''
    do i = 1, len(words)
      text = text//words(i:i)
      if (words(i:i) == '"') text = text//'"'
    end do
  end function quoted

  !> Outline of both gears, centres at 0.
  pure subroutine outline_rows(study, lines)
    type(study_t), intent(in) :: study
    type(lines_t), intent(inout) :: lines
    real(dp), allocatable :: points(:, :)
    integer :: i, k

    do i = 1, 2
      call shown_contour(study%pair%gear(i), points)
      do k = 1, size(points, 2)
        call lines%add(trim(members(i))//','//field(milli*points(1, k))//','//field(milli*points(2, k)))
      end do
    end do
  end subroutine outline_rows

  pure subroutine root_rows(study, lines)
    type(study_t), intent(in) :: study
    type(lines_t), intent(inout) :: lines
    integer :: i, k, side

    do i = 1, size(study%root)
      associate (root => study%root(i))
        do k = 1, size(root%s)
          do side = drive, coast
            call lines%add(field(1e6_dp*study%case%amount(i))//','//field(root%s(k))//','//field(milli*root%radius(k))//','// &
                           field(root%share(k))//','//trim(merge('drive', 'coast', side == drive))//','// &
                           field(mega*root%along(side, k))//','//field(mega*root%components(1, side, k))//','// &
                           field(mega*root%components(2, side, k))//','//field(mega*root%components(3, side, k)))
          end do
        end do
      end associate
    end do
  end subroutine root_rows

  pure subroutine mode_rows(study, lines)
    type(study_t), intent(in) :: study
    type(lines_t), intent(inout) :: lines
    integer :: i

    associate (modes => study%modal%modes)
      do i = 1, size(modes%frequency)
        call lines%add(field(i)//','//field(modes%frequency(i))//','//field(study%modal%error_estimate(i))//','// &
                       field(modes%residual(i))//','//field(modes%participation(0, i)))
      end do
    end associate
  end subroutine mode_rows

  pure function percent(x) result(words)
    real(dp), intent(in) :: x
    character(:), allocatable :: words

    words = str(100*x, 3)//' %'
    if (x > 0) words = '+'//words
  end function percent
end module gearsweep_body_report
