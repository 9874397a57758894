!> One spur or helical gear in its transverse section, as its basic rack generates it (ISO 21771, ISO 53).
!>
!> Each flank has its own pressure angle: `drive` determines the path of contact, `coast` only the tooth thickness. Lengths in m,
!> angles in rad.
module gearsweep_gear_gear
  use gearsweep_base, only: bracket_t, code_input, dp, error_t, fail, pi, str
  use gearsweep_gear_rack, only: check_rack_tip, coast, drive, fillet_undercut, gear_spec_t, generating_shift, least_shift, &
    reference_radius, straight_end, teeth_around, transverse_angle, trochoid_parameter, trochoid_point
  implicit none
  private
  public :: gear_t, gear_spec_t, make_gear, make_virtual_gear, involute, chamfer_base, tip_quantity, drive, coast

  !> Gear with the dimensions that follow from its specification.
  type :: gear_t
    type(gear_spec_t) :: spec
    real(dp) :: transverse_angle(2) = 0          !< alpha_t on the reference circle, rad
    real(dp) :: reference_radius = 0
    real(dp) :: base_radius(2) = 0
    real(dp) :: tip_radius = 0
    real(dp) :: root_radius = 0
    real(dp) :: form_radius(2) = 0               !< radius at the end of the fillet and start of the involute
    real(dp) :: fillet_start(2) = 0              !< parameter of the fillet there, rad (gearsweep_gear_rack)
    real(dp) :: tip_form_radius = 0              !< radius at the end of the involute at the tip, d_Na/2
  contains
    procedure :: half_angle
    procedure :: thickness
    procedure :: curvature
    procedure :: base_helix
    procedure :: is_undercut
    procedure :: flank_end
    procedure :: tip_half_angle
    procedure :: edge_angle
  end type gear_t

contains

  !> Involute function inv(angle) = tan(angle) - angle.
  elemental real(dp) function involute(angle)
    real(dp), intent(in) :: angle

    involute = tan(angle) - angle
  end function involute

  !> Computes the radii and refuses a gear that cannot be cut: a rack whose tip radius does not fit, undercut through the tooth,
  !> pointed teeth, a bore that reaches the root.
  !> Source: ISO 21771:2007, sections 4 and 7.
  subroutine make_gear(spec, gear, error)
    type(gear_spec_t), intent(in) :: spec
    type(gear_t), intent(out) :: gear
    type(error_t), allocatable, intent(out) :: error
    real(dp) :: curvature
    integer :: side
    character(:), allocatable :: what

    call check_spec(spec, error)
    if (allocated(error)) return
    gear%spec = spec
    associate (m => spec%module, r => gear%reference_radius)
      r = reference_radius(spec)
      gear%transverse_angle = transverse_angle(spec%pressure_angle, spec%helix_angle)
      gear%base_radius = r*cos(gear%transverse_angle)
      gear%tip_radius = r + (spec%addendum + spec%profile_shift + spec%tip_alteration)*m
      if (spec%tip_diameter > 0) gear%tip_radius = spec%tip_diameter/2
      gear%root_radius = r - (spec%dedendum - generating_shift(spec))*m
    end associate
    call check_rack_tip(spec, error)
    ! Start of the involute: the end of the straight flank of the rack; with undercut or a protuberance, its intersection with the
    ! trochoid.
    do side = drive, coast
      curvature = straight_end(gear%spec, side)
      gear%fillet_start(side) = gear%transverse_angle(side)
      gear%form_radius(side) = hypot(gear%base_radius(side), max(curvature, 0.0_dp))
      if (gear%is_undercut(side) .or. fillet_undercut(gear%spec) > 0) call cross_undercut(gear, side, error)
    end do
    gear%tip_form_radius = gear%flank_end(drive)
    call check_tooth(gear, error)
    if (allocated(error)) return
    ! A chamfer or rounding must begin on the involute and leave a tip land.
    what = trim(spec%name)
    if (spec%tip_chamfer > 0) what = what//' tip chamfer (mm) = '//str(1000*spec%tip_chamfer)
    if (spec%tip_rounding > 0) what = what//' tip rounding (mm) = '//str(1000*spec%tip_rounding)
    if (spec%tip_form_diameter > 0) what = what//' tip form diameter (mm) = '//str(1000*spec%tip_form_diameter)
    if (spec%tip_form_diameter > 2*gear%tip_radius) then
      call fail(error, code_input, what//': must be at most the tip diameter '//str(2000*gear%tip_radius)//' mm')
    else if (spec%tip_rounding > gear%tip_radius - maxval(gear%base_radius)) then
      call fail(error, code_input, what//': must be at most '//str(1000*(gear%tip_radius - maxval(gear%base_radius)))// &
                ', the height of the tip above the base circle')
    else if (gear%tip_half_angle(drive) + gear%tip_half_angle(coast) <= 0) then
      call fail(error, code_input, what//': takes the whole tip, which is '//str(1000*gear%thickness(gear%tip_radius))// &
                ' mm thick; must leave some of it')
    end if
  end subroutine make_gear

  !> Makes the virtual gear of a helical gear: the spur gear of the normal section, with the same rack. Its number of teeth is
  !> z_n = z/(cos(beta_b)**2 cos(beta)) (ISO 21771:2007, section 4); with `is_whole` it is rounded, as a complete body has a whole
  !> number of teeth. Both gears have the same tip height above the reference circle, and the same ratio of bore to reference
  !> diameter, so that both bodies rotate by the same angle under a moment.
  subroutine make_virtual_gear(gear, is_whole, virtual, error)
    type(gear_t), intent(in) :: gear
    logical, intent(in) :: is_whole
    type(gear_t), intent(out) :: virtual
    type(error_t), allocatable, intent(out) :: error
    type(gear_spec_t) :: spec

    spec = gear%spec
    spec%virtual_teeth = spec%teeth/(cos(gear%base_helix())**2*cos(spec%helix_angle))
    spec%teeth = nint(spec%virtual_teeth)
    if (is_whole) spec%virtual_teeth = spec%teeth
    spec%helix_angle = 0
    associate (farther => reference_radius(spec) - gear%reference_radius)
      if (spec%tip_diameter > 0) spec%tip_diameter = spec%tip_diameter + 2*farther
      if (spec%tip_form_diameter > 0) spec%tip_form_diameter = spec%tip_form_diameter + 2*farther
    end associate
    spec%bore_radius = spec%bore_radius*reference_radius(spec)/gear%reference_radius
    call make_gear(spec, virtual, error)
  end subroutine make_virtual_gear

  subroutine check_spec(spec, error)
    type(gear_spec_t), intent(in) :: spec
    type(error_t), allocatable, intent(inout) :: error
    integer, parameter :: fewest = 5

    call demand(spec%teeth >= fewest, 'number of teeth', real(spec%teeth, dp), 'must be at least '//str(fewest))
    call demand(spec%module > 0, 'module (m)', spec%module, 'must be above 0')
    call demand(spec%face_width > 0, 'face width (m)', spec%face_width, 'must be above 0')
    call demand(spec%pressure_angle(drive) > 0.05_dp .and. spec%pressure_angle(drive) < 0.8_dp, 'pressure angle (rad)', &
                spec%pressure_angle(drive), 'must lie between 0.05 and 0.8')
    call demand(spec%pressure_angle(coast) > 0.05_dp .and. spec%pressure_angle(coast) < 0.8_dp, 'coast angle (rad)', &
                spec%pressure_angle(coast), 'must lie between 0.05 and 0.8')
    call demand(spec%addendum > 0, 'addendum', spec%addendum, 'must be above 0')
    call demand(spec%dedendum > 0, 'dedendum', spec%dedendum, 'must be above 0')
    call demand(all(spec%rack_tip_radius >= 0), 'rack tip radius', minval(spec%rack_tip_radius), 'must be at least 0')
    call demand(abs(spec%helix_angle) < 0.8_dp, 'helix angle (rad)', spec%helix_angle, 'must lie between -0.8 and 0.8')
    call demand(abs(spec%profile_shift) < 5, 'profile shift', spec%profile_shift, 'must lie between -5 and 5')

  contains

    subroutine demand(met, quantity, value, allowed)
      logical, intent(in) :: met
      character(*), intent(in) :: quantity, allowed
      real(dp), intent(in) :: value

      if (.not. met) call fail(error, code_input, trim(spec%name)//' '//quantity//' = '//str(value)//': '//allowed)
    end subroutine demand
  end subroutine check_spec

  !> Finds the intersection of an undercut flank's trochoid with the involute, by bisection: along the trochoid the radius falls
  !> from beyond the base circle to the root, and the point moves from the space into the tooth. With a protuberance the point is
  !> in the tooth already at the end of the rack's straight flank: then the tool's rounding continues from there, in small steps
  !> of its parameter, until the point is in the space again.
  pure subroutine cross_undercut(gear, side, error)
    type(gear_t), intent(inout) :: gear
    integer, intent(in) :: side
    type(error_t), allocatable, intent(inout) :: error
    real(dp), parameter :: step = 0.98_dp
    type(bracket_t) :: beta
    real(dp) :: missed, point(2)

    beta = bracket_t(gear%transverse_angle(side), pi/2)
    do while (.not. is_in_space(gear, side, beta%low) .and. beta%low > 0.01_dp)
      beta = bracket_t(step*beta%low, beta%low)
    end do
    do while (beta%is_open())
      call beta%halve(is_in_space(gear, side, beta%middle()))
    end do
    gear%fillet_start(side) = beta%high
    point = trochoid_point(gear%spec, side, beta%high)
    gear%form_radius(side) = max(gear%base_radius(side), norm2(point))
    missed = gear%form_radius(side)*abs(atan2(point(1), point(2)) - gear%half_angle(side, gear%form_radius(side)))
    ! Narrowest place below, where the trochoid's tangent is along the tooth's axis.
    point = trochoid_point(gear%spec, side, trochoid_parameter(gear%spec, side, beta%high, 0.0_dp))
    if (missed <= 1e-9_dp*gear%reference_radius .and. point(1) > 0) return
    if (fillet_undercut(gear%spec) > 0) call fail(error, code_input, trim(gear%spec%name)//' protuberance (mm) = '// &
      str(1000*gear%spec%protuberance)//': its undercut leaves no tooth')
    call fail(error, code_input, trim(gear%spec%name)//' profile shift = '//str(gear%spec%profile_shift)// &
      ': undercut with '//str(gear%spec%teeth)//' teeth leaves no tooth'// &
      trim(merge(' as thin as generating shift or allowance make it', repeat(' ', 49), &
      gear%spec%thinning < 0))//'; must be at least '//str(least_shift(gear%spec, side))//' to have none')
  end subroutine cross_undercut

  !> True if the trochoid's point is beyond the base circle and in the space next to the involute.
  pure logical function is_in_space(gear, side, beta)
    type(gear_t), intent(in) :: gear
    integer, intent(in) :: side
    real(dp), intent(in) :: beta
    real(dp) :: point(2)

    point = trochoid_point(gear%spec, side, beta)
    is_in_space = norm2(point) > gear%base_radius(side)
    if (is_in_space) is_in_space = atan2(point(1), point(2)) > gear%half_angle(side, norm2(point))
  end function is_in_space

  pure subroutine check_tooth(gear, error)
    type(gear_t), intent(in) :: gear
    type(error_t), allocatable, intent(inout) :: error
    character(:), allocatable :: which
    type(bracket_t) :: bracket
    real(dp) :: pointed

    which = trim(gear%spec%name)//' '
    if (.not. gear%spec%bore_radius >= 0 .or. gear%spec%bore_radius >= gear%root_radius) then
      call fail(error, code_input, which//'bore diameter (mm) = '//str(2000*gear%spec%bore_radius)// &
      ': must be at least 0 and below the root diameter '//str(2000*gear%root_radius)//' mm')
    end if
    if (min(gear%tip_form_radius, gear%flank_end(coast)) <= maxval(gear%form_radius)) then
      call fail(error, code_input, which//trim(tip_setting(gear))// &
        ': no involute is left between fillet and tip'//trim(merge(' with this chamfer or rounding', repeat(' ', 30), &
        gear%tip_form_radius < gear%tip_radius)))
    else if (gear%thickness(gear%tip_radius) <= 0) then
      ! Radius at which the two flanks meet, by bisection.
      bracket = bracket_t(maxval(gear%form_radius), gear%tip_radius)
      do while (bracket%is_open())
        call bracket%halve(gear%thickness(bracket%middle()) > 0)
      end do
      pointed = bracket%middle()
      call fail(error, code_input, which//trim(tip_setting(gear))// &
        ': pointed teeth; the tip diameter must stay below '//str(2000*pointed)//' mm'// &
        trim(merge(' with this thickness allowance', repeat(' ', 30), gear%spec%thinning < 0)))
    end if
  end subroutine check_tooth

  !> Name of the quantity that determines the tip circle, for messages.
  pure function tip_quantity(gear) result(words)
    type(gear_t), intent(in) :: gear
    character(17) :: words

    words = merge('tip diameter (mm)', 'addendum         ', gear%spec%tip_diameter > 0)
  end function tip_quantity

  !> Name and value of the quantity that determines the tip circle.
  pure function tip_setting(gear) result(words)
    type(gear_t), intent(in) :: gear
    character(48) :: words

    words = trim(tip_quantity(gear))//' = '//str(gear%spec%addendum)
    if (gear%spec%tip_diameter > 0) words = trim(tip_quantity(gear))//' = '//str(1000*gear%spec%tip_diameter)
  end function tip_setting

  !> Radius (m) at the end of a side's involute: at the tip circle, at its chamfer, or at the start of its rounding, which touches
  !> involute and tip circle.
  elemental real(dp) function flank_end(gear, side) result(radius)
    class(gear_t), intent(in) :: gear
    integer, intent(in) :: side
    real(dp) :: centre

    associate (spec => gear%spec, base => gear%base_radius(side))
      radius = gear%tip_radius - spec%tip_chamfer
      if (spec%tip_form_diameter > 0) radius = spec%tip_form_diameter/2
      if (spec%tip_rounding > 0) then
        centre = gear%tip_radius - spec%tip_rounding
        radius = hypot(base, spec%tip_rounding + sqrt(max(0.0_dp, (centre - base)*(centre + base))))
      end if
    end associate
  end function flank_end

  !> Angle (rad) from the tooth axis to the end of a side's flank, chamfer or rounding on the tip circle. A chamfer is cut as the
  !> rack's edge break of 45 degrees cuts it: an involute of a smaller base circle.
  elemental real(dp) function tip_half_angle(gear, side) result(angle)
    class(gear_t), intent(in) :: gear
    integer, intent(in) :: side
    real(dp) :: from, base

    from = gear%flank_end(side)
    angle = gear%half_angle(side, from)
    if (gear%spec%tip_rounding > 0) then
      ! The rounding's centre is on the involute's normal, and on the ray to its contact with the tip circle.
      base = gear%base_radius(side)
      angle = angle - acos(min(1.0_dp, base/from)) + acos(min(1.0_dp, base/(gear%tip_radius - gear%spec%tip_rounding)))
    else if (from < gear%tip_radius) then
      base = chamfer_base(gear)
      angle = angle + involute(acos(min(1.0_dp, base/from))) - involute(acos(min(1.0_dp, base/gear%tip_radius)))
    end if
  end function tip_half_angle

  !> Included angle (rad) of the material at the edge where a side's involute ends, at this radius of curvature (m): to the tip
  !> circle or to the chamfer, whose slope to the ray follows from its own base circle. A rounding's end counts as an edge to the
  !> tip circle.
  elemental real(dp) function edge_angle(gear, side, curvature) result(angle)
    class(gear_t), intent(in) :: gear
    integer, intent(in) :: side
    real(dp), intent(in) :: curvature
    real(dp) :: slope

    slope = atan2(curvature, gear%base_radius(side))
    angle = pi/2 + slope
    if (gear%spec%tip_rounding > 0 .or. .not. gear%flank_end(side) < gear%tip_radius) return
    angle = pi + slope - acos(min(1.0_dp, chamfer_base(gear)/hypot(gear%base_radius(side), curvature)))
  end function edge_angle

  !> Base radius (m) of the chamfer's involute.
  elemental real(dp) function chamfer_base(gear)
    class(gear_t), intent(in) :: gear

    chamfer_base = gear%reference_radius*cos(transverse_angle(pi/4, gear%spec%helix_angle))
  end function chamfer_base

  !> Angle from the tooth axis to the involute at `radius` (m), rad. The axis
  !> halves the reference thickness of the unshifted tooth.
  elemental real(dp) function half_angle(gear, side, radius)
    class(gear_t), intent(in) :: gear
    integer, intent(in) :: side
    real(dp), intent(in) :: radius

    associate (angle => gear%spec%pressure_angle(side))
      half_angle = (pi/2 + 2*generating_shift(gear%spec)*tan(angle))/teeth_around(gear%spec) &
                   + involute(gear%transverse_angle(side)) - involute(acos(min(1.0_dp, gear%base_radius(side)/radius)))
    end associate
  end function half_angle

  !> Tooth thickness along the circle of `radius` (m), on the involutes.
  elemental real(dp) function thickness(gear, radius)
    class(gear_t), intent(in) :: gear
    real(dp), intent(in) :: radius

    thickness = radius*(gear%half_angle(drive, radius) + gear%half_angle(coast, radius))
  end function thickness

  !> Base helix angle (rad), positive: right-handed: sin(beta_b) = sin(beta) cos(alpha_n). Source: ISO 21771:2007, section 4.
  elemental real(dp) function base_helix(gear)
    class(gear_t), intent(in) :: gear

    base_helix = asin(sin(gear%spec%helix_angle)*cos(gear%spec%pressure_angle(drive)))
  end function base_helix

  !> True if the rack's corner cuts into this side's involute.
  elemental logical function is_undercut(gear, side)
    class(gear_t), intent(in) :: gear
    integer, intent(in) :: side

    is_undercut = straight_end(gear%spec, side) < -1e-12_dp*gear%reference_radius
  end function is_undercut

  !> Radius of curvature of a flank at `radius` (m): the length of its generating line.
  elemental real(dp) function curvature(gear, side, radius)
    class(gear_t), intent(in) :: gear
    integer, intent(in) :: side
    real(dp), intent(in) :: radius

    curvature = sqrt(max(0.0_dp, (radius - gear%base_radius(side))*(radius + gear%base_radius(side))))
  end function curvature
end module gearsweep_gear_gear
