!> Builds the oscillator from a mesh and an amount of tip relief.
module gearsweep_study_run_motions
  use gearsweep_base, only: code_input, dp, error_t, fail, piecewise_t, str
  use gearsweep_gear, only: add_corners, drive, profile_error, relief_t
  use gearsweep_motion, only: make_oscillator, oscillator_t
  use gearsweep_study_run_inputs, only: motions_inputs_t, relief_inputs_t
  implicit none
  private
  public :: build_motion, largest_relief, relief_start

contains

  !> Builds the oscillator of a case with this amount of relief (m), unless its profile error is prescribed.
  subroutine build_motion(inputs, amount, motion, error)
    type(motions_inputs_t), intent(in) :: inputs
    real(dp), intent(in) :: amount
    type(oscillator_t), intent(out) :: motion
    type(error_t), allocatable, intent(out) :: error

    associate (of => inputs%motion)
      motion%mesh%contact_ratio = of%relief%contact_ratio
      motion%mesh%reach = of%reach
      motion%mesh%flattening = of%flattening
      motion%mesh%pitch_point = of%relief%pitch_point
      motion%mesh%tan_angle = of%tan_angle
      motion%mesh%arm_change = of%arm_change
      motion%mesh%teeth = of%teeth
      motion%mesh%stiffness = inputs%stiffness
      motion%mesh%disc = of%disc
      if (allocated(inputs%profile_error%breaks)) then
        motion%mesh%profile_error = inputs%profile_error
      else
        call relieve(of%relief, amount, of%reach, motion%mesh%profile_error, error)
        if (allocated(error)) return
      end if
      motion%mass = of%mass
      motion%load = of%load
      motion%damping_ratio = of%damping_ratio
      motion%friction = of%friction
      motion%has_backlash = of%has_backlash
      motion%backlash = of%backlash
    end associate
    call make_oscillator(motion, error)
  end subroutine build_motion

  !> Profile error of one amount of relief (m), over `reach` (base pitches).
  subroutine relieve(inputs, amount, reach, curve, error)
    type(relief_inputs_t), intent(in) :: inputs
    real(dp), intent(in) :: amount, reach(2)
    type(piecewise_t), intent(out) :: curve
    type(error_t), allocatable, intent(out) :: error
    type(relief_t) :: relief

    relief%amount = amount*inputs%fraction
    relief%start = relief_start(inputs)
    relief%shape = inputs%shape
    if (amount > 0 .and. inputs%start == 'hpstc' .and. .not. modulo(inputs%contact_ratio, 1.0_dp) > 0) then
      call fail(error, code_input, '&relief start = ''hpstc'': short relief has no room at a contact ratio of '// &
                str(inputs%contact_ratio)//'; use start = ''pitch'' or length_mm')
    else if (amount > deepest_relief(inputs)) then
      call fail(error, code_input, '&relief amount_um = '//str(1e6_dp*amount)// &
        ': deeper than the tooth; with these fractions at most '//str(1e6_dp*deepest_relief(inputs)))
    else
      call profile_error(relief, inputs%contact_ratio, curve, error)
      if (.not. (allocated(error) .or. inputs%prescribed)) call add_corners(inputs%pair, relief, reach, curve)
    end if
  end subroutine relieve

  !> Largest amount of relief (m) of a search. Beyond some 1.5 static deflections of one pair, pairs no longer share the load.
  pure real(dp) function largest_relief(inputs) result(largest)
    type(motions_inputs_t), intent(in) :: inputs

    largest = max(maxval(inputs%amount), 1.5_dp*inputs%motion%load &
                  /inputs%stiffness%value(inputs%motion%relief%contact_ratio/2)/maxval(inputs%motion%relief%fraction))
    largest = min(largest, deepest_relief(inputs%motion%relief))
  end function largest_relief

  !> Half the tooth thickness at the tip over the larger fraction (m); without limit for a prescribed mesh, whose teeth are not
  !> known.
  pure real(dp) function deepest_relief(inputs) result(deepest)
    type(relief_inputs_t), intent(in) :: inputs
    integer :: i

    deepest = huge(deepest)
    if (inputs%prescribed) return
    do i = 1, 2
      associate (gear => inputs%pair%gear(i))
        if (inputs%fraction(i) > 0) deepest = min(deepest, gear%thickness(gear%tip_form_radius)/2/inputs%fraction(i))
      end associate
    end do
  end function deepest_relief

  !> Path coordinates at which the reliefs of pinion and gear begin.
  pure function relief_start(inputs) result(start)
    type(relief_inputs_t), intent(in) :: inputs
    real(dp) :: start(2)

    associate (ratio => inputs%contact_ratio, pair => inputs%pair)
      select case (inputs%start)
      case ('pitch')
        start = inputs%pitch_point
      case ('length')
        start = [ratio - inputs%length/inputs%base_pitch, inputs%length/inputs%base_pitch]
      case ('roll')
        start(1) = (inputs%roll(1)*pair%gear(1)%base_radius(drive) - pair%start_curvature)/inputs%base_pitch
        start(2) = (pair%curvature(2, 0.0_dp) - inputs%roll(2)*pair%gear(2)%base_radius(drive))/inputs%base_pitch
      case default
        start = [aint(ratio), ratio - aint(ratio)]
      end select
      start = start + inputs%shift
    end associate
  end function relief_start
end module gearsweep_study_run_motions
