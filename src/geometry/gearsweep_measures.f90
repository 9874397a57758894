!> How a gear's tooth thickness is measured: span over several teeth, and diameter over pins (ISO 21771:2007, section 8).
!>
!> Both hold for the teeth as they are generated, and need equal pressure angles on both flanks.
module gearsweep_measures
  use gearsweep_kinds, only: dp, pi
  use gearsweep_error, only: error_t, fail, code_input
  use gearsweep_gear, only: gear_t, drive, coast
  use gearsweep_rack, only: generating_shift
  use gearsweep_text, only: str
  implicit none
  private
  public :: measures_t, find_measures, check_pin

  type :: measures_t
    integer :: span_teeth = 0                    !< k; 0: no number of teeth can be spanned
    real(dp) :: span = 0                         !< W_k, m
    real(dp) :: pin_diameter = 0                 !< D_M, m; 0: no pin touches the involutes and stands out
    real(dp) :: over_pins = 0                    !< M_dK, m
  end type measures_t

contains

  !> Span over as many teeth as touch it closest to the V circle, and diameter over pins of the stated diameter, or of
  !> pins that touch at the V circle. What cannot be measured is 0.
  pure function find_measures(gear) result(measures)
    type(gear_t), intent(in) :: gear
    type(measures_t) :: measures

    if (abs(gear%spec%pressure_angle(coast) - gear%spec%pressure_angle(drive)) > 0) return
    call find_span(gear, measures)
    measures%pin_diameter = gear%spec%pin_diameter
    if (measures%pin_diameter <= 0) measures%pin_diameter = pin_at(gear, v_radius(gear))
    if (.not. (touches(gear, measures%pin_diameter) .and. stands_out(gear, measures%pin_diameter))) then
      measures%pin_diameter = 0
      return
    end if
    associate (d => 2*gear%base_radius(drive)/cos(pin_angle(gear, measures%pin_diameter)), z => gear%spec%teeth)
      measures%over_pins = d*merge(1.0_dp, cos(pi/(2*z)), mod(z, 2) == 0) + measures%pin_diameter
    end associate
  end function find_measures

  !> W_k = (k - 1) base pitches and the tooth's thickness on the base circle.
  pure subroutine find_span(gear, measures)
    type(gear_t), intent(in) :: gear
    type(measures_t), intent(inout) :: measures
    real(dp) :: pitch, thickness, wanted
    integer :: k

    associate (base => gear%base_radius(drive), z => gear%spec%teeth)
      pitch = 2*pi*base/z
      thickness = gear%thickness(base)
      wanted = 2*sqrt((v_radius(gear) - base)*(v_radius(gear) + base))
      k = max(2, 1 + nint((wanted - thickness)/pitch))
      ! One more or less where the jaws would leave the involute.
      if (.not. is_spanned()) k = k + merge(1, -1, touched_at() < maxval(gear%form_radius))
      if (k < 2 .or. .not. is_spanned()) return
      measures%span_teeth = k
      measures%span = thickness + (k - 1)*pitch
    end associate

  contains

    pure real(dp) function touched_at()
      touched_at = hypot(gear%base_radius(drive), (thickness + (k - 1)*pitch)/2)
    end function touched_at

    pure logical function is_spanned()
      is_spanned = touched_at() >= maxval(gear%form_radius) .and. touched_at() <= gear%tip_form_radius
    end function is_spanned
  end subroutine find_span

  !> The V circle, r + x_E m, or the end of the involute that is next to it (m).
  pure real(dp) function v_radius(gear) result(radius)
    type(gear_t), intent(in) :: gear

    radius = gear%reference_radius + generating_shift(gear%spec)*gear%spec%module
    radius = min(max(radius, maxval(gear%form_radius)), gear%tip_form_radius)
  end function v_radius

  !> Half the angle of the space on the base circle; negative where the teeth overlap there.
  pure real(dp) function half_space(gear) result(angle)
    type(gear_t), intent(in) :: gear

    angle = pi/gear%spec%teeth - gear%half_angle(drive, gear%base_radius(drive))
  end function half_space

  !> Diameter of the pin that touches both flanks of a space at `radius` (m): its centre lies on the tangent of the
  !> base circle through the contact, and on the axis of the space.
  pure real(dp) function pin_at(gear, radius) result(diameter)
    type(gear_t), intent(in) :: gear
    real(dp), intent(in) :: radius
    real(dp) :: angle

    angle = gear%curvature(drive, radius)/gear%base_radius(drive)
    diameter = 2*gear%base_radius(drive)*(tan(angle + half_space(gear)) - angle)
  end function pin_at

  !> Pressure angle at the pin's centre, from inv(angle) = D_M/(2 r_b) less the half space; by bisection.
  pure real(dp) function pin_angle(gear, diameter) result(angle)
    type(gear_t), intent(in) :: gear
    real(dp), intent(in) :: diameter
    real(dp) :: low, high, target
    integer :: i

    target = diameter/(2*gear%base_radius(drive)) - half_space(gear)
    low = 0
    high = pi/2
    do i = 1, 60
      angle = (low + high)/2
      if (tan(angle) - angle < target) then
        low = angle
      else
        high = angle
      end if
    end do
  end function pin_angle

  !> Does the pin touch the involutes?
  pure logical function touches(gear, diameter)
    type(gear_t), intent(in) :: gear
    real(dp), intent(in) :: diameter
    real(dp) :: curvature

    curvature = gear%base_radius(drive)*tan(pin_angle(gear, diameter)) - diameter/2
    touches = curvature >= 0 .and. hypot(gear%base_radius(drive), curvature) >= maxval(gear%form_radius)*(1 - 1e-12_dp) &
              .and. hypot(gear%base_radius(drive), curvature) <= gear%tip_form_radius*(1 + 1e-12_dp)
  end function touches

  !> Does it stand out beyond the tip circle, and stay above the root?
  pure logical function stands_out(gear, diameter)
    type(gear_t), intent(in) :: gear
    real(dp), intent(in) :: diameter

    associate (centre => gear%base_radius(drive)/cos(pin_angle(gear, diameter)))
      stands_out = centre + diameter/2 > gear%tip_radius .and. centre - diameter/2 > gear%root_radius
    end associate
  end function stands_out

  !> Refuses a stated pin that measures nothing.
  pure subroutine check_pin(gear, error)
    type(gear_t), intent(in) :: gear
    type(error_t), allocatable, intent(inout) :: error
    character(:), allocatable :: what

    if (gear%spec%pin_diameter <= 0) return
    what = trim(gear%spec%name)//' pin diameter (mm) = '//str(1000*gear%spec%pin_diameter)//': '
    if (abs(gear%spec%pressure_angle(coast) - gear%spec%pressure_angle(drive)) > 0) then
      call fail(error, code_input, what//'pins measure teeth with equal pressure angles only; remove it')
    else if (.not. touches(gear, gear%spec%pin_diameter)) then
      call fail(error, code_input, what//'touches no involute; must be from '//str(1000*pin_at(gear, maxval(gear%form_radius)))// &
        ' to '//str(1000*pin_at(gear, gear%tip_form_radius)))
    else if (.not. stands_out(gear, gear%spec%pin_diameter)) then
      call fail(error, code_input, what//'must stand out beyond the tip diameter '//str(2000*gear%tip_radius)// &
        ' mm and stay off the root; '//str(1000*pin_at(gear, v_radius(gear)))//' would touch at the V circle')
    end if
  end subroutine check_pin
end module gearsweep_measures
