!> From a mesh and an amount of tip relief to the oscillator.
module gearsweep_motions
  use gearsweep_corner, only: add_corners
  use gearsweep_error, only: error_t, fail, code_input
  use gearsweep_gear, only: drive
  use gearsweep_inputs, only: motion_inputs_t, motions_inputs_t, relief_inputs_t
  use gearsweep_kinds, only: dp
  use gearsweep_oscillator, only: make_oscillator, oscillator_t
  use gearsweep_piecewise, only: piecewise_t
  use gearsweep_relief, only: profile_error, relief_t
  use gearsweep_text, only: str
  implicit none
  private
  public :: build_motion, largest_relief, relief_start, with_relief

contains

  !> The oscillator of a mesh with this pair stiffness (N/m over s) and amount of relief (m) or, where it is prescribed,
  !> this profile error (m over s).
  subroutine build_motion(inputs, stiffness, prescribed, amount, motion, error)
    type(motion_inputs_t), intent(in) :: inputs
    type(piecewise_t), intent(in) :: stiffness, prescribed   !< without breaks: the relief makes the profile error
    real(dp), intent(in) :: amount
    type(oscillator_t), intent(out) :: motion
    type(error_t), allocatable, intent(out) :: error

    motion%mesh%contact_ratio = inputs%relief%contact_ratio
    motion%mesh%reach = inputs%reach
    motion%mesh%flattening = inputs%flattening
    motion%mesh%pitch_point = inputs%relief%pitch_point
    motion%mesh%tan_angle = inputs%tan_angle
    motion%mesh%arm_change = inputs%arm_change
    motion%mesh%teeth = inputs%teeth
    motion%mesh%stiffness = stiffness
    motion%mesh%disc = inputs%disc
    if (allocated(prescribed%breaks)) then
      motion%mesh%profile_error = prescribed
    else
      call relieve(inputs%relief, amount, inputs%reach, motion%mesh%profile_error, error)
      if (allocated(error)) return
    end if
    motion%mass = inputs%mass
    motion%load = inputs%load
    motion%damping_ratio = inputs%damping_ratio
    motion%friction = inputs%friction
    motion%has_backlash = inputs%has_backlash
    motion%backlash = inputs%backlash
    call make_oscillator(motion, error)
  end subroutine build_motion

  !> The same for `find_optimum`, whose `context` are the motions' inputs.
  subroutine with_relief(context, amount, motion, error)
    class(*), intent(in) :: context
    real(dp), intent(in) :: amount
    type(oscillator_t), intent(out) :: motion
    type(error_t), allocatable, intent(out) :: error

    select type (context)
    type is (motions_inputs_t)
      call build_motion(context%motion, context%stiffness, context%profile_error, amount, motion, error)
    end select
  end subroutine with_relief

  !> The profile error of one amount of relief (m), over `reach` (base pitches).
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

  !> The largest amount of relief (m) that a search tries. Beyond some 1.5 static deflections of one pair, pairs no longer share
  !> the load.
  pure real(dp) function largest_relief(inputs) result(largest)
    type(motions_inputs_t), intent(in) :: inputs

    largest = max(maxval(inputs%amount), 1.5_dp*inputs%motion%load &
                  /inputs%stiffness%value(inputs%motion%relief%contact_ratio/2)/maxval(inputs%motion%relief%fraction))
    largest = min(largest, deepest_relief(inputs%motion%relief))
  end function largest_relief

  !> Half the tooth's thickness at the tip, over the larger fraction (m); for a
  !> prescribed mesh nothing is known of the tooth.
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
end module gearsweep_motions
