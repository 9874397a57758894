!> Measures of a gear: body mass and inertia, span and diameter over pins, flank tolerances.
!>
!> Span and pins: ISO 21771:2007, section 8, for teeth as generated with equal pressure angles on both flanks. Of helical gears,
!> the span is normal to the flanks, and the pins are balls with their centres in one transverse section. Flank
!> tolerances: ISO 1328-1:2013, the formulas of class 5 and the factor sqrt(2) from class to class; the run-out tolerance is
!> the standard's informative one. The standard's text was not at hand: the formulas are those of several public programs.
module gearsweep_gear_measures
  use gearsweep_base, only: bracket_t, code_input, dp, error_t, fail, pi, str
  use gearsweep_gear_gear, only: coast, drive, gear_t
  use gearsweep_gear_profile, only: fillet_point, involute_point, root_angle
  use gearsweep_gear_rack, only: generating_shift
  implicit none
  private
  public :: has_web, solid_inertia, web_inertia, measures_t, find_measures, check_pin, tolerances_t, find_tolerances

  integer, parameter :: steps = 400              !< along a fillet or a flank

  type :: measures_t
    integer :: span_teeth = 0                    !< k; 0: no number of teeth can be spanned
    real(dp) :: span = 0                         !< W_k, m
    real(dp) :: pin_diameter = 0                 !< D_M of pins or balls, m; 0: none touches the involutes and is beyond the tip
    real(dp) :: over_pins = 0                    !< M_dK, m
  end type measures_t

  !> Flank tolerances, all in um.
  type :: tolerances_t
    real(dp) :: single_pitch = 0                 !< f_p
    real(dp) :: cumulative_pitch = 0             !< F_p
    real(dp) :: profile_slope = 0                !< f_Halpha
    real(dp) :: profile_form = 0                 !< f_falpha
    real(dp) :: profile = 0                      !< F_alpha
    real(dp) :: helix_slope = 0                  !< f_Hbeta
    real(dp) :: helix_form = 0                   !< f_fbeta
    real(dp) :: helix = 0                        !< F_beta
    real(dp) :: runout = 0                       !< F_r
  end type tolerances_t

contains

  !> Polar inertia of a disc out to the reference circle, less its bore (kg m^2).
  pure real(dp) function solid_inertia(gear, density)
    type(gear_t), intent(in) :: gear
    real(dp), intent(in) :: density              !< kg/m^3

    solid_inertia = pi/2*density*gear%spec%face_width*(gear%reference_radius**4 - gear%spec%bore_radius**4)
  end function solid_inertia

  !> True if there is a web between the rim (thickness below the root circle, m) and the bore that is narrower than the teeth.
  !> `web`: its thickness, m; 0 if none is stated.
  pure logical function has_web(gear, web, rim)
    type(gear_t), intent(in) :: gear
    real(dp), intent(in) :: web, rim

    has_web = web > 0 .and. web < gear%spec%face_width .and. rim > 0 .and. rim < gear%root_radius - gear%spec%bore_radius
  end function has_web

  !> Polar moment of inertia (kg m^2) of teeth, rim and web: that within the true outline, without reliefs and chamfers, minus the
  !> bore and minus the part between web and face width, from the bore to the rim. `density` in kg/m^3.
  pure real(dp) function web_inertia(gear, web, rim, density) result(inertia)
    type(gear_t), intent(in) :: gear
    real(dp), intent(in) :: web, rim, density
    real(dp) :: point(2, 0:2*steps), radius(0:2*steps), angle(0:2*steps), land, moment
    integer :: side, i

    associate (bore => pi/2*gear%spec%bore_radius**4, gap => pi/2*(gear%root_radius - rim)**4)
      ! Integral of r^4/4 over the angle within the outline of the teeth (m^4).
      moment = 0
      land = 2*pi/gear%spec%teeth
      do side = drive, coast
        do i = 0, steps
          associate (share => real(i, dp)/steps)
            point(:, i) = fillet_point(gear, side, pi/2 + (gear%fillet_start(side) - pi/2)*share)
            point(:, steps + i) = involute_point(gear, side, (1 - share)*gear%form_radius(side) + share*gear%tip_radius)
          end associate
        end do
        radius = norm2(point, 1)
        angle = atan2(point(1, :), point(2, :))
        moment = moment + sum((radius(:2*steps - 1)**4 + radius(1:)**4)/2*(angle(:2*steps - 1) - angle(1:))) &
                 + radius(2*steps)**4*angle(2*steps)
        land = land - root_angle(gear, side)
      end do
      moment = gear%spec%teeth*(moment + gear%root_radius**4*land)/4
      inertia = density*(gear%spec%face_width*(moment - bore) - (gear%spec%face_width - web)*(gap - bore))
    end associate
  end function web_inertia

  !> Computes the span over the number of teeth whose contact is closest to the V circle, and the diameter over pins of the stated
  !> diameter or, by default, of pins with contact at the V circle or, if these would be below the tip circle, closest to it.
  !> Measures that do not exist are 0.
  pure function find_measures(gear) result(measures)
    type(gear_t), intent(in) :: gear
    type(measures_t) :: measures

    if (abs(gear%spec%pressure_angle(coast) - gear%spec%pressure_angle(drive)) > 0) return
    call find_span(gear, measures)
    measures%pin_diameter = gear%spec%pin_diameter
    if (measures%pin_diameter <= 0) measures%pin_diameter = usual_pin(gear)
    if (.not. (touches(gear, measures%pin_diameter) .and. projects(gear, measures%pin_diameter))) then
      measures%pin_diameter = 0
      return
    end if
    associate (d => 2*gear%base_radius(drive)/cos(pin_angle(gear, measures%pin_diameter)), z => gear%spec%teeth)
      measures%over_pins = d*merge(1.0_dp, cos(pi/(2*z)), mod(z, 2) == 0) + measures%pin_diameter
    end associate
  end function find_measures

  !> Computes the span W_k = (k - 1) base pitches plus the tooth's thickness on the base circle, times cos(beta_b). Helical gears
  !> with narrow faces have it over fewer teeth: the face must be wider than W_k sin(beta_b).
  pure subroutine find_span(gear, measures)
    type(gear_t), intent(in) :: gear
    type(measures_t), intent(inout) :: measures
    real(dp) :: pitch, thickness, wanted
    integer :: k

    associate (base => gear%base_radius(drive), z => gear%spec%teeth, slope => gear%base_helix())
      pitch = 2*pi*base/z
      thickness = gear%thickness(base)
      wanted = 2*sqrt((v_radius(gear) - base)*(v_radius(gear) + base))
      k = max(2, 1 + nint((wanted/cos(slope)**2 - thickness)/pitch))
      ! One more or less if the jaws would leave the involute.
      if (.not. is_spanned()) k = k + merge(1, -1, touched_at() < maxval(gear%form_radius))
      if (abs(slope) > 0) k = min(k, 1 + int((gear%spec%face_width/abs(sin(slope)*cos(slope)) - thickness)/pitch))
      if (k < 2 .or. .not. is_spanned()) return
      measures%span_teeth = k
      measures%span = (thickness + (k - 1)*pitch)*cos(slope)
    end associate

  contains

    pure real(dp) function touched_at()
      touched_at = hypot(gear%base_radius(drive), (thickness + (k - 1)*pitch)/2*cos(gear%base_helix())**2)
    end function touched_at

    pure logical function is_spanned()
      is_spanned = touched_at() >= maxval(gear%form_radius) .and. touched_at() <= gear%tip_form_radius
    end function is_spanned
  end subroutine find_span

  !> Radius of the V circle, r + x_E m, or of the nearest end of the involute (m).
  pure real(dp) function v_radius(gear) result(radius)
    type(gear_t), intent(in) :: gear

    radius = gear%reference_radius + generating_shift(gear%spec)*gear%spec%module
    radius = min(max(radius, maxval(gear%form_radius)), gear%tip_form_radius)
  end function v_radius

  !> Half the angle of the space on the base circle; negative if the teeth overlap there.
  pure real(dp) function half_space(gear) result(angle)
    type(gear_t), intent(in) :: gear

    angle = pi/gear%spec%teeth - gear%half_angle(drive, gear%base_radius(drive))
  end function half_space

  !> Diameter of the pin that touches both flanks of a space at `radius` (m): its centre is on the tangent of the base circle
  !> through the contact, and on the axis of the space. A ball touches helical flanks in other transverse sections than its
  !> centre's, at the angle beta_b; by bisection for the pressure angle at its centre.
  pure real(dp) function pin_at(gear, radius) result(diameter)
    type(gear_t), intent(in) :: gear
    real(dp), intent(in) :: radius
    real(dp) :: angle
    type(bracket_t) :: centre

    angle = gear%curvature(drive, radius)/gear%base_radius(drive)
    diameter = 2*gear%base_radius(drive)*(tan(angle + half_space(gear)) - angle)
    associate (slope => gear%base_helix())
      if (.not. abs(slope) > 0) return
      centre = bracket_t(0.0_dp, pi/2)
      do while (centre%is_open())
        call centre%halve(centre%middle() + (tan(centre%middle()) - angle)*tan(slope)**2 < angle + half_space(gear))
      end do
      diameter = 2*gear%base_radius(drive)*(tan(centre%middle()) - angle)/cos(slope)
    end associate
  end function pin_at

  !> Diameter (m) of the pin with contact at the V circle. For thin teeth: of the pin that touches closest to it and extends a
  !> tenth of a module beyond the tip circle; by bisection.
  pure real(dp) function usual_pin(gear) result(diameter)
    type(gear_t), intent(in) :: gear
    type(bracket_t) :: radius

    diameter = pin_at(gear, v_radius(gear))
    if (projects(gear, diameter)) return
    radius = bracket_t(v_radius(gear), gear%tip_form_radius)
    do while (radius%is_open())
      diameter = pin_at(gear, radius%middle())
      call radius%halve(gear%base_radius(drive)/cos(pin_angle(gear, diameter)) + diameter/2 &
                        < gear%tip_radius + gear%spec%module/10)
    end do
    diameter = pin_at(gear, radius%middle())
  end function usual_pin

  !> Pressure angle at the pin's centre, from inv(angle) = D_M/(2 r_b cos(beta_b)) minus half of the space; by bisection.
  pure real(dp) function pin_angle(gear, diameter)
    type(gear_t), intent(in) :: gear
    real(dp), intent(in) :: diameter
    type(bracket_t) :: angle

    angle = bracket_t(0.0_dp, pi/2)
    do while (angle%is_open())
      call angle%halve(tan(angle%middle()) - angle%middle() &
                       < diameter/(2*gear%base_radius(drive)*cos(gear%base_helix())) - half_space(gear))
    end do
    pin_angle = angle%middle()
  end function pin_angle

  !> True if the pin touches the involutes.
  pure logical function touches(gear, diameter)
    type(gear_t), intent(in) :: gear
    real(dp), intent(in) :: diameter
    real(dp) :: curvature

    curvature = gear%base_radius(drive)*tan(pin_angle(gear, diameter)) - diameter/2*cos(gear%base_helix())
    touches = curvature >= 0 .and. hypot(gear%base_radius(drive), curvature) >= maxval(gear%form_radius)*(1 - 1e-12_dp) &
              .and. hypot(gear%base_radius(drive), curvature) <= gear%tip_form_radius*(1 + 1e-12_dp)
  end function touches

  !> True if the pin extends beyond the tip circle, and stays above the root.
  pure logical function projects(gear, diameter)
    type(gear_t), intent(in) :: gear
    real(dp), intent(in) :: diameter

    associate (centre => gear%base_radius(drive)/cos(pin_angle(gear, diameter)))
      projects = centre + diameter/2 > gear%tip_radius .and. centre - diameter/2 > gear%root_radius
    end associate
  end function projects

  !> Refuses a stated pin without a measure.
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
    else if (.not. projects(gear, gear%spec%pin_diameter)) then
      call fail(error, code_input, what//'must stand out beyond the tip diameter '//str(2000*gear%tip_radius)// &
        ' mm and stay off the root; '//str(1000*usual_pin(gear))//' is the default')
    end if
  end subroutine check_pin

  !> Computes the tolerances of a class, rounded as the standard does, or exactly.
  pure subroutine find_tolerances(class, teeth, module_mm, face_width_mm, tolerances, error, exactly, helix_angle)
    integer, intent(in) :: class                 !< flank tolerance class A, 1 to 11
    integer, intent(in) :: teeth                 !< 5 to 1000
    real(dp), intent(in) :: module_mm            !< normal module, 0.5 to 70 mm
    real(dp), intent(in) :: face_width_mm        !< 4 to 1200 mm
    type(tolerances_t), intent(out) :: tolerances
    type(error_t), allocatable, intent(out) :: error       !< a value out of the standard's range
    logical, intent(in), optional :: exactly     !< true: without rounding
    real(dp), intent(in), optional :: helix_angle  !< on the reference circle, rad, up to 45 degrees
    real(dp) :: d, factor
    logical :: rounds

    d = teeth*module_mm
    if (present(helix_angle)) then
      call demand('helix angle (deg)', abs(helix_angle)*180/pi, 0.0_dp, 45.0_dp, error)
      d = d/cos(helix_angle)
    end if
    call demand('flank tolerance class', real(class, dp), 1.0_dp, 11.0_dp, error)
    call demand('number of teeth', real(teeth, dp), 5.0_dp, 1000.0_dp, error)
    call demand('module (mm)', module_mm, 0.5_dp, 70.0_dp, error)
    call demand('reference diameter (mm)', d, 5.0_dp, 15000.0_dp, error)
    call demand('face width (mm)', face_width_mm, 4.0_dp, 1200.0_dp, error)
    if (allocated(error)) return
    rounds = .true.
    if (present(exactly)) rounds = .not. exactly
    factor = sqrt(2.0_dp)**(class - 5)
    associate (m => module_mm, b => face_width_mm, t => tolerances)
      t%single_pitch = factor*(0.001_dp*d + 0.4_dp*m + 5)
      t%cumulative_pitch = factor*(0.002_dp*d + 0.55_dp*sqrt(d) + 0.7_dp*m + 12)
      t%profile_slope = factor*(0.4_dp*m + 0.001_dp*d + 4)
      t%profile_form = factor*(0.55_dp*m + 5)
      t%profile = hypot(t%profile_slope, t%profile_form)
      t%helix_slope = factor*(0.05_dp*sqrt(d) + 0.35_dp*sqrt(b) + 4)
      t%helix_form = factor*(0.07_dp*sqrt(d) + 0.45_dp*sqrt(b) + 4)
      t%helix = hypot(t%helix_slope, t%helix_form)
      t%runout = 0.9_dp*t%cumulative_pitch
      if (rounds) t = tolerances_t(rounded(t%single_pitch), rounded(t%cumulative_pitch), rounded(t%profile_slope), &
                                   rounded(t%profile_form), rounded(t%profile), rounded(t%helix_slope), rounded(t%helix_form), &
                                   rounded(t%helix), rounded(t%runout))
    end associate
  end subroutine find_tolerances

  pure subroutine demand(what, value, least, largest, error)
    character(*), intent(in) :: what
    real(dp), intent(in) :: value, least, largest
    type(error_t), allocatable, intent(inout) :: error

    if (.not. (value >= least .and. value <= largest)) call fail(error, code_input, what//' = '//str(value)// &
      ': ISO 1328-1 has tolerances from '//str(least)//' to '//str(largest))
  end subroutine demand

  !> Rounds to full um above 10 um, to 0.5 um from 5 to 10, to 0.1 um below 5; halves away from 0.
  elemental real(dp) function rounded(value)
    real(dp), intent(in) :: value                !< um

    if (value > 10) then
      rounded = anint(value)
    else if (value >= 5) then
      rounded = anint(2*value)/2
    else
      rounded = anint(10*value)/10
    end if
  end function rounded
end module gearsweep_gear_measures
