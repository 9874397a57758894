!> The tooth's outline: involute flanks and the fillets that the rack's rounded
!> tip generates (trochoids), in Cartesian coordinates with the origin in the
!> gear's centre and y along the tooth axis. Points lie on the side of positive x.
module gearsweep_outline
  use gearsweep_kinds, only: dp, pi
  use gearsweep_gear, only: chamfer_base, gear_t, involute
  use gearsweep_rack, only: corner_place, trochoid_parameter, trochoid_point
  implicit none
  private
  public :: involute_point, tip_break_point, fillet_point, fillet_parameter, root_angle

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

  !> Point of the chamfer or rounding at the tip: `share` from 0, where the involute ends, to 1 on the tip circle.
  pure function tip_break_point(gear, side, share) result(point)
    type(gear_t), intent(in) :: gear
    integer, intent(in) :: side
    real(dp), intent(in) :: share
    real(dp) :: point(2)
    real(dp) :: from, radius, angle, normal, base

    from = gear%flank_end(side)
    if (gear%spec%tip_rounding > 0) then
      ! About its centre, from the involute's normal to the ray.
      angle = gear%tip_half_angle(side)
      normal = gear%half_angle(side, from) - acos(min(1.0_dp, gear%base_radius(side)/from)) + pi/2
      point = (gear%tip_radius - gear%spec%tip_rounding)*[sin(angle), cos(angle)]
      angle = normal + (angle - normal)*share
      point = point + gear%spec%tip_rounding*[sin(angle), cos(angle)]
    else
      radius = from + (gear%tip_radius - from)*share
      base = chamfer_base(gear)
      angle = gear%half_angle(side, from) + involute(acos(min(1.0_dp, base/from))) - involute(acos(min(1.0_dp, base/radius)))
      point = radius*[sin(angle), cos(angle)]
    end if
  end function tip_break_point

  !> Point of a flank's fillet. The parameter `beta` (rad) is the slope of the
  !> rack's normal at the cutting point: `fillet_start` of the gear where the fillet
  !> joins the involute, pi/2 where it joins the root circle.
  pure function fillet_point(gear, side, beta) result(point)
    type(gear_t), intent(in) :: gear
    integer, intent(in) :: side
    real(dp), intent(in) :: beta
    real(dp) :: point(2)

    point = trochoid_point(gear%spec, side, beta)
  end function fillet_point

  !> The parameter at which the fillet's tangent makes the angle `tangent`
  !> (rad) with the tooth axis, clipped to the fillet.
  pure real(dp) function fillet_parameter(gear, side, tangent) result(beta)
    type(gear_t), intent(in) :: gear
    integer, intent(in) :: side
    real(dp), intent(in) :: tangent

    beta = trochoid_parameter(gear%spec, side, gear%fillet_start(side), tangent)
  end function fillet_parameter

  !> Angle from the tooth axis to where the fillet meets the root circle (rad).
  pure real(dp) function root_angle(gear, side)
    type(gear_t), intent(in) :: gear
    integer, intent(in) :: side

    root_angle = corner_place(gear%spec, side)/gear%reference_radius
  end function root_angle
end module gearsweep_outline
