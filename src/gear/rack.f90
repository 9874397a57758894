!> The basic rack that generates a gear, and the fillet cut by its rounded tip, a trochoid (ISO 53, ISO 21771).
!>
!> The fillet's parameter `beta` (rad) is the slope of the rack's normal at the cutting point: the pressure angle at the end of
!> the straight flank, pi/2 on the root circle. A tool with protuberance cuts the fillet deeper into the tooth than the finished
!> flank. Then the trochoid continues to smaller parameters until it meets that flank. Lengths in m, angles in rad.
!>
!> The rack of a helical gear is that of the normal section. In the transverse section, which all points and radii are in, its
!> lengths along the pitch line are longer by 1/cos(helix angle), and its rounded corner is an ellipse.
module gearsweep_gear_rack
  use gearsweep_base, only: bracket_t, code_input, dp, error_t, fail, pi, str
  implicit none
  private
  public :: gear_spec_t, generating_shift, fillet_undercut, check_rack_tip, straight_end, least_shift, reference_radius, &
            teeth_around, transverse_angle
  public :: corner_depth, corner_place, trochoid_point, trochoid_parameter

  integer, parameter, public :: drive = 1, coast = 2

  !> Specification of a gear by its designer. Factors are in modules.
  type :: gear_spec_t
    character(6) :: name = ''                    !< for messages: pinion or gear
    integer :: teeth = 0
    real(dp) :: module = 0                       !< normal module, m
    real(dp) :: pressure_angle(2) = 20*pi/180    !< pressure angle of the rack, in the normal section: drive, coast
    real(dp) :: profile_shift = 0                !< x
    real(dp) :: addendum = 1                     !< h_aP*
    real(dp) :: dedendum = 1.25_dp               !< h_fP*
    real(dp) :: rack_tip_radius(2) = 0.25_dp     !< rho_fP*: drive, coast
    real(dp) :: tip_alteration = 0               !< k*, negative where the tip is cut back
    real(dp) :: face_width = 0
    real(dp) :: bore_radius = 0
    real(dp) :: thinning = 0                     !< x_E - x, the shift of the rack, inwards if negative
    real(dp) :: tip_diameter = 0                 !< d_a, m; 0: from addendum, profile shift and tip alteration
    real(dp) :: tip_chamfer = 0                  !< height h_K of the chamfer at the tip, m
    real(dp) :: tip_rounding = 0                 !< radius of the rounding at the tip instead, m
    real(dp) :: tip_form_diameter = 0            !< d_Na, m: start of the chamfer, instead of its height; 0: not stated
    real(dp) :: protuberance = 0                 !< height of the tool's rounded tip above its flank, pr, m
    real(dp) :: grinding_stock = 0               !< stock on the flank after that tool, normal to it, ground off later, q, m
    real(dp) :: pin_diameter = 0                 !< pin diameter for measuring, m; 0: one with contact at or near the V circle
    !> Helix angle on the reference circle, rad, positive: right-handed; 0: a spur gear, which all rooms but this one are for.
    real(dp) :: helix_angle = 0
    real(dp) :: virtual_teeth = 0                !< of the virtual gear of a helical gear: z_n, with a fraction; 0: `teeth`
  end type gear_spec_t

contains

  !> Angle in the transverse section (rad) of a rack's line at this angle in the normal section.
  !> Source: ISO 21771:2007, section 4: tan(alpha_t) = tan(alpha_n)/cos(beta).
  elemental real(dp) function transverse_angle(normal_angle, helix_angle) result(angle)
    real(dp), intent(in) :: normal_angle, helix_angle

    angle = normal_angle
    if (abs(helix_angle) > 0) angle = atan(tan(normal_angle)/cos(helix_angle))
  end function transverse_angle

  !> Number of pitches around the gear: the number of teeth, of a virtual gear with a fraction.
  elemental real(dp) function teeth_around(spec) result(teeth)
    type(gear_spec_t), intent(in) :: spec

    teeth = spec%teeth
    if (spec%virtual_teeth > 0) teeth = spec%virtual_teeth
  end function teeth_around

  !> Reference radius r = z m_n/(2 cos(beta)) (m).
  elemental real(dp) function reference_radius(spec) result(radius)
    type(gear_spec_t), intent(in) :: spec

    radius = teeth_around(spec)*spec%module/2*transverse_factor(spec)
  end function reference_radius

  !> Length along the pitch line in the transverse section over that in the normal section, 1/cos(beta); without the cosine for
  !> spur gears.
  elemental real(dp) function transverse_factor(spec)
    type(gear_spec_t), intent(in) :: spec

    transverse_factor = 1
    if (abs(spec%helix_angle) > 0) transverse_factor = 1/cos(spec%helix_angle)
  end function transverse_factor

  !> Generating profile shift coefficient x_E: with the tooth-thickness allowance A_s on the reference circle,
  !> x_E = x + A_s/(2 m tan(alpha)) (ISO 21771:2007, section 8); unequal flanks share it by their tangents.
  elemental real(dp) function generating_shift(spec) result(shift)
    type(gear_spec_t), intent(in) :: spec

    shift = spec%profile_shift + spec%thinning
  end function generating_shift

  !> Residual fillet undercut in modules: depth of the fillet in the tooth below the finished flank, s_pr = pr - q (ISO
  !> 6336-3:2006, 6.2).
  elemental real(dp) function fillet_undercut(spec) result(depth)
    type(gear_spec_t), intent(in) :: spec

    depth = 0
    if (abs(spec%protuberance - spec%grinding_stock) > 0) depth = (spec%protuberance - spec%grinding_stock)/spec%module
  end function fillet_undercut

  !> Checks that the rounded corners of the rack's tooth leave a tip land.
  pure subroutine check_rack_tip(spec, error)
    type(gear_spec_t), intent(in) :: spec
    type(error_t), allocatable, intent(inout) :: error
    real(dp) :: land, taken(2)

    associate (angle => spec%pressure_angle)
      land = sum(pi/4 - spec%dedendum*tan(angle) + fillet_undercut(spec)/cos(angle))
      taken = (1 - sin(angle))/cos(angle)
    end associate
    if (land < 0) then
      call fail(error, code_input, trim(spec%name)//' dedendum = '//str(spec%dedendum)// &
        ': the rack tooth is pointed above '//str(pi/2/sum(tan(spec%pressure_angle))))
    else if (sum(spec%rack_tip_radius*taken) > land*(1 + 1e-12_dp)) then
      if (abs(spec%rack_tip_radius(coast) - spec%rack_tip_radius(drive)) > 0) then
        call fail(error, code_input, trim(spec%name)//' rack tip radii = '//str(spec%rack_tip_radius(drive))//', '// &
          str(spec%rack_tip_radius(coast))//' (drive, coast): do not fit the rack together; at most '// &
          str(land/taken(drive))//' on the drive side with a sharp corner on the other, '//str(land/taken(coast))// &
          ' on the coast side')
      else
        call fail(error, code_input, trim(spec%name)//' rack tip radius = '//str(spec%rack_tip_radius(drive))// &
          ': does not fit the rack; at most '//str(land/sum(taken)))
      end if
    end if
    if (spec%grinding_stock > spec%protuberance) call fail(error, code_input, trim(spec%name)// &
      ' grinding stock (mm) = '//str(1000*spec%grinding_stock)//': must be at most the protuberance '// &
      str(1000*spec%protuberance)//' mm, else the ground flank ends in a step')
    if (any(spec%rack_tip_radius > spec%dedendum)) call fail(error, code_input, trim(spec%name)// &
      ' rack tip radius = '//str(maxval(spec%rack_tip_radius))//': must not exceed the dedendum')
  end subroutine check_rack_tip

  !> Radius of curvature (m) of the involute at the end of the rack's straight flank; negative if that end extends beyond the base
  !> circle: undercut.
  pure real(dp) function straight_end(spec, side) result(curvature)
    type(gear_spec_t), intent(in) :: spec
    integer, intent(in) :: side

    associate (angle => transverse_angle(spec%pressure_angle(side), spec%helix_angle))
      curvature = reference_radius(spec)*sin(angle) &
                  - (straight_depth(spec, side) - generating_shift(spec))*spec%module/sin(angle)
    end associate
  end function straight_end

  !> Least profile shift coefficient x without undercut of a side.
  pure real(dp) function least_shift(spec, side) result(shift)
    type(gear_spec_t), intent(in) :: spec
    integer, intent(in) :: side

    associate (angle => transverse_angle(spec%pressure_angle(side), spec%helix_angle))
      shift = straight_depth(spec, side) - teeth_around(spec)*transverse_factor(spec)*sin(angle)**2/2 - spec%thinning
    end associate
  end function least_shift

  !> Depth (modules) of the end of the rack's straight flank below its reference line.
  pure real(dp) function straight_depth(spec, side) result(depth)
    type(gear_spec_t), intent(in) :: spec
    integer, intent(in) :: side

    depth = spec%dedendum - spec%rack_tip_radius(side)*(1 - sin(spec%pressure_angle(side)))
  end function straight_depth

  !> Depth of the centre of a side's rounded corner of the rack below the pitch line (m).
  pure real(dp) function corner_depth(spec, side)
    type(gear_spec_t), intent(in) :: spec
    integer, intent(in) :: side

    corner_depth = (spec%dedendum - spec%rack_tip_radius(side) - generating_shift(spec))*spec%module
  end function corner_depth

  !> Distance of that centre from the axis of the rack's space in the transverse section (m).
  pure real(dp) function corner_place(spec, side)
    type(gear_spec_t), intent(in) :: spec
    integer, intent(in) :: side

    associate (angle => spec%pressure_angle(side))
      corner_place = spec%module*(pi/4 + (spec%dedendum - spec%rack_tip_radius(side))*tan(angle) &
                                  + (spec%rack_tip_radius(side) - fillet_undercut(spec))/cos(angle))*transverse_factor(spec)
    end associate
  end function corner_place

  !> Point of a side's trochoid, on positive x, with the tooth's axis along y (m).
  pure function trochoid_point(spec, side, beta) result(point)
    type(gear_spec_t), intent(in) :: spec
    integer, intent(in) :: side
    real(dp), intent(in) :: beta
    real(dp) :: point(2)
    real(dp) :: across, x, y, turn, radius, corner(2)

    radius = reference_radius(spec)
    across = rolled(spec, side, beta)
    corner = rounding(spec, side, beta)
    x = across - corner(1)
    y = radius - corner_depth(spec, side) - corner(2)
    turn = (across - corner_place(spec, side))/radius
    point = [x*cos(turn) - y*sin(turn), x*sin(turn) + y*cos(turn)]
  end function trochoid_point

  !> Parameter, from `least` to pi/2, at which the trochoid's tangent is at the angle `tangent` (rad) to the tooth axis; by
  !> bisection, as the angle grows towards the root.
  pure real(dp) function trochoid_parameter(spec, side, least, tangent)
    type(gear_spec_t), intent(in) :: spec
    integer, intent(in) :: side
    real(dp), intent(in) :: least, tangent
    type(bracket_t) :: beta
    real(dp) :: place, radius

    beta = bracket_t(least, pi/2)
    place = corner_place(spec, side)
    radius = reference_radius(spec)
    do while (beta%is_open())
      call beta%halve(beta%middle() + (rolled(spec, side, beta%middle()) - place)/radius < tangent)
    end do
    trochoid_parameter = beta%middle()
  end function trochoid_parameter

  !> Distance of the corner's centre from the pitch point when the corner cuts at `beta` (m).
  pure real(dp) function rolled(spec, side, beta)
    type(gear_spec_t), intent(in) :: spec
    integer, intent(in) :: side
    real(dp), intent(in) :: beta

    real(dp) :: corner(2)

    rolled = -corner_depth(spec, side)*cos(beta)/sin(beta)
    if (.not. abs(spec%helix_angle) > 0) return
    ! The normal of an ellipse does not pass through its centre.
    corner = rounding(spec, side, beta)
    rolled = rolled + corner(1) - corner(2)*cos(beta)/sin(beta)
  end function rolled

  !> Place of the cutting point on the rounded corner from the corner's centre, across the rack and downwards (m): on a circle, or
  !> on the ellipse that a helical gear's transverse section makes of it.
  pure function rounding(spec, side, beta) result(corner)
    type(gear_spec_t), intent(in) :: spec
    integer, intent(in) :: side
    real(dp), intent(in) :: beta
    real(dp) :: corner(2)
    real(dp) :: normal_beta

    normal_beta = beta
    if (abs(spec%helix_angle) > 0) normal_beta = atan2(sin(beta), cos(beta)*transverse_factor(spec))
    corner = spec%rack_tip_radius(side)*spec%module*[cos(normal_beta)*transverse_factor(spec), sin(normal_beta)]
  end function rounding
end module gearsweep_gear_rack
