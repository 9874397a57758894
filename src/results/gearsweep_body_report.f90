!> The answer for the screen: what the tasks say of one member's body, and printed values beside ours.
module gearsweep_body_report
  use gearsweep_kinds, only: dp, pi
  use gearsweep_lines, only: left, lines_t, right
  use gearsweep_quantities, only: our_value
  use gearsweep_study, only: study_t
  use gearsweep_text, only: str
  implicit none
  private
  public :: add_section, add_root, add_modes, add_published

  real(dp), parameter :: micro = 1e6_dp, mega = 1e-6_dp, milli = 1e3_dp, degree = pi/180
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
        call lines%add(right(str(micro*study%case%amount(i)), 12)//right(str(mega*stress%tension%stress, 5), 14)// &
                       right(str(stress%tension%tangent/degree, 3), 15)//right(str(mega*stress%compression%stress, 5), 18)// &
                       right(str(stress%compression%tangent/degree, 3), 15)//right(str(100*stress%error_estimate, 2), 15))
      end associate
    end do
    associate (root => study%root(1))
      call lines%add('   ISO 6336-3: sigma_F0 '//str(mega*root%iso_stress, 5)//' MPa (Y_F '//str(root%iso%form_factor, 4)// &
                     ', Y_S '//str(root%iso%correction, 4)//'); Lewis '//str(mega*root%lewis_stress, 5)//' MPa (Y '// &
                     str(root%lewis, 4)//'); for the whole load at point '//merge('D', 'B', study%case%root%member == 1))
    end associate
  end subroutine add_root

  pure subroutine add_modes(study, lines)
    type(study_t), intent(in) :: study
    type(lines_t), intent(inout) :: lines
    integer, parameter :: most_teeth = 7
    integer :: i, part

    associate (modes => study%modal%modes)
      call lines%add('')
      call lines%add('Natural frequencies of the section')
      call lines%add('   mode          Hz   error est. %   residual   kinetic energy of rim and teeth %')
      do i = 1, size(modes%frequency)
        call lines%put(right(str(i), 7)//right(str(modes%frequency(i), 6), 12)// &
                       right(str(100*study%modal%error_estimate(i), 2), 15)//right(str(modes%residual(i), 1), 11)//'   ')
        do part = 0, min(ubound(modes%participation, 1), most_teeth)
          call lines%put(right(str(nint(100*modes%participation(part, i))), 4))
        end do
        call lines%add('')
      end do
    end associate
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
        call lines%put('   '//left(row%quantity, 28)//left(row%place, 12)//right(str(row%printed), 11))
        if (known) then
          call lines%add(right(str(value), 12)//right(trim(percent(value/row%printed - 1)), 12)//'   '//row%status)
        else
          call lines%add(right('-', 12)//right('-', 12)//'   not computed by these tasks')
        end if
      end associate
    end do
  end subroutine add_published

  !> With its sign.
  pure function percent(x) result(words)
    real(dp), intent(in) :: x
    character(24) :: words

    words = str(100*x, 3)//' %'
    if (x > 0) words = '+'//words
  end function percent
end module gearsweep_body_report
