!> The tooth's outline: involute flanks and the fillets that the rack's rounded
!> tip generates (trochoids), in Cartesian coordinates with the origin in the
!> gear's centre and y along the tooth axis. Points lie on the side of positive x.
module gearsweep_outline
  use gearsweep_kinds, only: dp, pi
  use gearsweep_gear, only: gear_t
  implicit none
  private
  public :: involute_point, fillet_point, fillet_parameter, root_angle

contains

  !> Point of a flank's involute at `radius` (m), at or above the form radius.
  pure function involute_point(gear, side, radius) result(point)
    type(gear_t), intent(in) :: gear
    integer, intent(in) :: side
    real(dp), intent(in) :: radius
    real(dp) :: point(2)
    real(dp) :: angle

    angle = gear%half_angle(side, radius)
    point = radius*[sin(angle), cos(angle)]
  end function involute_point

  !> Point of a flank's fillet. The parameter `beta` (rad) is the slope of the
  !> rack's normal at the cutting point: the pressure angle where the fillet
  !> joins the involute, pi/2 where it joins the root circle.
  pure function fillet_point(gear, side, beta) result(point)
    type(gear_t), intent(in) :: gear
    integer, intent(in) :: side
    real(dp), intent(in) :: beta
    real(dp) :: point(2)
    real(dp) :: across, x, y, turn

    across = rolled(gear, beta)
    associate (rounding => gear%spec%rack_tip_radius*gear%spec%module)
      x = across - rounding*cos(beta)
      y = gear%reference_radius - centre_depth(gear) - rounding*sin(beta)
    end associate
    turn = (across - corner(gear, side))/gear%reference_radius
    point = [x*cos(turn) - y*sin(turn), x*sin(turn) + y*cos(turn)]
  end function fillet_point

  !> The parameter at which the fillet's tangent makes the angle `tangent`
  !> (rad) with the tooth axis, clipped to the fillet; by bisection, as the
  !> angle grows towards the root.
  pure real(dp) function fillet_parameter(gear, side, tangent) result(beta)
    type(gear_t), intent(in) :: gear
    integer, intent(in) :: side
    real(dp), intent(in) :: tangent
    real(dp) :: low, high
    integer :: i

    low = gear%spec%pressure_angle(side)
    high = pi/2
    do i = 1, 60
      beta = (low + high)/2
      if (beta + (rolled(gear, beta) - corner(gear, side))/gear%reference_radius < tangent) then
        low = beta
      else
        high = beta
      end if
    end do
  end function fillet_parameter

  !> Angle from the tooth axis to where the fillet meets the root circle (rad).
  pure real(dp) function root_angle(gear, side)
    type(gear_t), intent(in) :: gear
    integer, intent(in) :: side

    root_angle = corner(gear, side)/gear%reference_radius
  end function root_angle

  !> Depth of the centre of the rack's rounded corner below the pitch line (m).
  pure real(dp) function centre_depth(gear)
    type(gear_t), intent(in) :: gear

    associate (spec => gear%spec)
      centre_depth = (spec%dedendum - spec%rack_tip_radius - spec%profile_shift)*spec%module
    end associate
  end function centre_depth

  !> Where that centre stands beside the pitch point when the corner cuts at `beta` (m).
  pure real(dp) function rolled(gear, beta)
    type(gear_t), intent(in) :: gear
    real(dp), intent(in) :: beta

    rolled = -centre_depth(gear)*cos(beta)/sin(beta)
  end function rolled

  !> Distance of that centre from the axis of the rack's space (m).
  pure real(dp) function corner(gear, side)
    type(gear_t), intent(in) :: gear
    integer, intent(in) :: side

    associate (spec => gear%spec, angle => gear%spec%pressure_angle(side))
      corner = spec%module*(pi/4 + (spec%dedendum - spec%rack_tip_radius)*tan(angle) &
                            + spec%rack_tip_radius/cos(angle))
    end associate
  end function corner
end module gearsweep_outline
