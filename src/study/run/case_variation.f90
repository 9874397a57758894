!> Variation of a case by its numbers: their names, units and values, and the oscillator that they lead to.
module gearsweep_study_run_case_variation
  use gearsweep_base, only: code_input, dp, error_t, fail, piecewise_t, str
  use gearsweep_gear, only: add_corners, drive, profile_error, relief_t
  use gearsweep_motion, only: make_oscillator, mesh_period, oscillator_t
  use gearsweep_study_run_inputs, only: motions_inputs_t, relief_inputs_t
  implicit none
  private
  public :: case_variation_t, with_relief, build_motion, find_profile_error, largest_relief, relief_start

  integer, parameter, public :: vary_rpm = 1, vary_damping = 2, vary_relief = 3, vary_force = 4, vary_friction = 5, &
    vary_mass(2) = [6, 7], vary_stiffness = 8, vary_amount(2) = [9, 10], vary_start(2) = [11, 12], vary_profile = 13, &
    vary_backlash = 14
  !> Names of the numbers, as keys and columns have them.
  character(*), parameter, public :: number_names(14) = [character(20) :: 'rpm', 'damping_ratio', 'relief_um', 'normal_force_n', &
    'friction', 'pinion_mass_kg', 'gear_mass_kg', 'stiffness_factor', 'pinion_relief_um', 'gear_relief_um', 'pinion_relief_start', &
    'gear_relief_start', 'profile_factor', 'backlash_um']
  !> SI value of one unit of each number.
  real(dp), parameter, public :: number_units(14) = [1.0_dp, 1.0_dp, 1e-6_dp, 1.0_dp, 1.0_dp, 1.0_dp, 1.0_dp, 1.0_dp, 1e-6_dp, &
                                                     1e-6_dp, 1.0_dp, 1.0_dp, 1.0_dp, 1e-6_dp]

  type :: case_variation_t
    type(motions_inputs_t) :: inputs
    real(dp) :: relief = 0                       !< amount, which the fractions of `inputs` multiply, m
    real(dp) :: rpm = 0                          !< speed of the pinion, 1/min
  contains
    procedure :: number, set, set_reliefs, build, duration
  end type case_variation_t

contains

  !> Value of a number in SI units: for the start of the relief its shift from that of the case, for factors 1.
  pure real(dp) function number(self, which)
    class(case_variation_t), intent(in) :: self
    integer, intent(in) :: which
    real(dp) :: all(size(number_names))

    associate (motion => self%inputs%motion)
      all = [self%rpm, motion%damping_ratio, self%relief, motion%load, motion%friction, motion%mass, 1.0_dp, &
             self%relief*motion%relief%fraction, motion%relief%shift, 1.0_dp, motion%backlash]
    end associate
    number = all(which)
  end function number

  !> Sets a number of the case to another value. The stiffness changes as by another modulus of elasticity: pair compliance, shared
  !> compliance and compliance of the bodies by the same factor.
  pure subroutine set(self, which, value)
    class(case_variation_t), intent(inout) :: self
    integer, intent(in) :: which
    real(dp), intent(in) :: value
    real(dp) :: amount(2)

    associate (motion => self%inputs%motion)
      select case (which)
      case (vary_rpm)
        self%rpm = value
      case (vary_damping)
        motion%damping_ratio = value
      case (vary_relief)
        self%relief = value
      case (vary_force)
        motion%load = value
      case (vary_friction)
        motion%friction = value
      case (vary_stiffness)
        self%inputs%stiffness%coef = value*self%inputs%stiffness%coef
        associate (motion => self%inputs%motion, disc => self%inputs%motion%disc)
          motion%flattening = motion%flattening%scaled(1/value)
          disc%turn = disc%turn/value
          disc%shared = disc%shared/value
          disc%change = disc%change/value
          disc%decline = disc%decline/value
          disc%twist = disc%twist/value
        end associate
      case (vary_profile)
        self%inputs%profile_error%coef = value*self%inputs%profile_error%coef
      case (vary_backlash)
        motion%backlash = value
      case default
        ! The relief of one of the gears.
        amount = self%relief*motion%relief%fraction
        where (vary_amount == which) amount = value
        if (any(vary_amount == which)) call self%set_reliefs(amount)
        where (vary_mass == which) motion%mass = value
        where (vary_start == which) motion%relief%shift = value
      end select
    end associate
  end subroutine set

  !> Sets the amounts of relief at the tips of pinion and gear (m).
  pure subroutine set_reliefs(self, amount)
    class(case_variation_t), intent(inout) :: self
    real(dp), intent(in) :: amount(2)

    self%inputs%motion%relief%fraction = amount
    self%relief = merge(1.0_dp, 0.0_dp, any(amount > 0))
  end subroutine set_reliefs

  subroutine build(self, osc, error)
    class(case_variation_t), intent(in) :: self
    type(oscillator_t), intent(out) :: osc
    type(error_t), allocatable, intent(out) :: error

    call build_motion(self%inputs, self%relief, osc, error)
  end subroutine build

  !> Duration of the mesh period, s.
  pure real(dp) function duration(self)
    class(case_variation_t), intent(in) :: self

    duration = mesh_period(self%inputs%motion%teeth(1), self%rpm)
  end function duration

  !> Builds the oscillator of a case with another amount of relief (m), for `find_optimum`; `context` is the case.
  subroutine with_relief(context, amount, motion, error)
    class(*), intent(in) :: context
    real(dp), intent(in) :: amount
    type(oscillator_t), intent(out) :: motion
    type(error_t), allocatable, intent(out) :: error

    select type (context)
    type is (motions_inputs_t)
      call build_motion(context, amount, motion, error)
    end select
  end subroutine with_relief

  !> Builds the oscillator of a case with this amount of relief (m), unless its profile error is prescribed.
  subroutine build_motion(inputs, amount, motion, error)
    type(motions_inputs_t), intent(in) :: inputs
    real(dp), intent(in) :: amount
    type(oscillator_t), intent(out) :: motion
    type(error_t), allocatable, intent(out) :: error

    associate (of => inputs%motion)
      motion%mesh%contact_ratio = of%relief%contact_ratio
      motion%mesh%spacing = of%spacing
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
        call find_profile_error(of%relief, amount, motion%mesh%profile_error, error, of%reach)
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

  !> Computes the profile error (m over s) of an amount of relief (m), with what the tip corners add up to the `reach` of contact.
  subroutine find_profile_error(inputs, amount, curve, error, reach)
    type(relief_inputs_t), intent(in) :: inputs
    real(dp), intent(in) :: amount
    type(piecewise_t), intent(out) :: curve
    type(error_t), allocatable, intent(inout) :: error
    real(dp), intent(in), optional :: reach(2)   !< path coordinates; absent: from A to E
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
      if (present(reach) .and. .not. (allocated(error) .or. inputs%prescribed)) call add_corners(inputs%pair, relief, reach, curve)
    end if
  end subroutine find_profile_error

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
end module gearsweep_study_run_case_variation
