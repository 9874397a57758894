!> Tooth profile in the transverse section: involute flanks and trochoidal fillets, and the outline of the gear as points.
!>
!> The origin is the gear's centre and y the tooth axis; the points of a tooth are on the side of positive x. In the outline for
!> CAD and plots every junction of two curves is a point, and every point is on the true profile.
module gearsweep_gear_profile
  use gearsweep_base, only: dp, pi
  use gearsweep_gear_gear, only: chamfer_base, coast, drive, gear_t, involute
  use gearsweep_gear_rack, only: corner_place, trochoid_parameter, trochoid_point
  implicit none
  private
  public :: involute_point, tip_break_point, fillet_point, fillet_parameter, root_angle, tooth_outline, gear_outline, &
            shown_outline

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

  !> Point of the chamfer or rounding at the tip: `share` from 0, at the end of the involute, to 1 on the tip circle.
  pure function tip_break_point(gear, side, share) result(point)
    type(gear_t), intent(in) :: gear
    integer, intent(in) :: side
    real(dp), intent(in) :: share
    real(dp) :: point(2)
    real(dp) :: from, radius, angle, normal, base

    from = gear%flank_end(side)
    if (gear%spec%tip_rounding > 0) then
      ! Angle about its centre, from the involute's normal to the ray.
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

  !> Point of a flank's fillet. The parameter `beta` (rad) is the slope of the rack's normal at the cutting point: `fillet_start`
  !> of the gear at the junction with the involute, pi/2 at that with the root circle.
  pure function fillet_point(gear, side, beta) result(point)
    type(gear_t), intent(in) :: gear
    integer, intent(in) :: side
    real(dp), intent(in) :: beta
    real(dp) :: point(2)

    point = trochoid_point(gear%spec, side, beta)
  end function fillet_point

  !> Parameter at which the fillet's tangent is at the angle `tangent` (rad) to the tooth axis, limited to the fillet.
  pure real(dp) function fillet_parameter(gear, side, tangent) result(beta)
    type(gear_t), intent(in) :: gear
    integer, intent(in) :: side
    real(dp), intent(in) :: tangent

    beta = trochoid_parameter(gear%spec, side, gear%fillet_start(side), tangent)
  end function fillet_parameter

  !> Angle from the tooth axis to the junction of fillet and root circle (rad).
  pure real(dp) function root_angle(gear, side)
    type(gear_t), intent(in) :: gear
    integer, intent(in) :: side

    root_angle = corner_place(gear%spec, side)/gear%reference_radius
  end function root_angle

  !> Number of curves of one tooth: two fillets, two involutes and the tip land; two chamfers or roundings more, if any.
  pure integer function tooth_curves(gear)
    type(gear_t), intent(in) :: gear

    tooth_curves = merge(7, 5, gear%tip_form_radius < gear%tip_radius)
  end function tooth_curves

  !> Outline of one tooth with its axis along y, from root circle to root circle: coast fillet and involute, tip land, drive
  !> involute and fillet (2, 5 steps + 1), with chamfers or roundings next to the tip land (2, 7 steps + 1), m; the drive side has
  !> positive x. `steps` per curve, at least 1.
  pure function tooth_outline(gear, steps) result(points)
    type(gear_t), intent(in) :: gear
    integer, intent(in) :: steps
    real(dp) :: points(2, 0:tooth_curves(gear)*steps)
    real(dp) :: left, right, angle
    integer :: i, side, all

    side = (tooth_curves(gear) - 1)/2*steps
    all = tooth_curves(gear)*steps
    points(:, 0:side) = one_side(gear, coast, steps)
    points(1, 0:side) = -points(1, 0:side)
    points(:, all:all - side:-1) = one_side(gear, drive, steps)
    left = -gear%tip_half_angle(coast)
    right = gear%tip_half_angle(drive)
    do i = 1, steps - 1
      angle = left + (right - left)*i/steps
      points(:, side + i) = gear%tip_radius*[sin(angle), cos(angle)]
    end do
  end function tooth_outline

  !> Points of fillet, involute and chamfer or rounding of one side, upwards, on positive x.
  pure function one_side(gear, side, steps) result(points)
    type(gear_t), intent(in) :: gear
    integer, intent(in) :: side, steps
    real(dp) :: points(2, 0:(tooth_curves(gear) - 1)/2*steps)
    real(dp) :: share
    integer :: i

    do i = 0, steps
      share = real(i, dp)/steps
      points(:, i) = fillet_point(gear, side, pi/2 + (gear%fillet_start(side) - pi/2)*share)
      points(:, steps + i) = involute_point(gear, side, &
        sqrt(gear%form_radius(side)**2*(1 - share) + gear%flank_end(side)**2*share))
      if (gear%tip_form_radius < gear%tip_radius) points(:, 2*steps + i) = tip_break_point(gear, side, share)
    end do
  end function one_side

  !> Outline of all teeth, clockwise, each followed by `steps` - 1 points inside its root land (2, teeth times steps times one
  !> more than `tooth_curves`), m; the last point joins the first.
  pure function gear_outline(gear, steps) result(points)
    type(gear_t), intent(in) :: gear
    integer, intent(in) :: steps
    real(dp) :: points(2, (tooth_curves(gear) + 1)*steps*gear%spec%teeth)
    real(dp) :: tooth(2, (tooth_curves(gear) + 1)*steps), from, to, angle
    integer :: i, k, n, last

    n = (tooth_curves(gear) + 1)*steps
    last = tooth_curves(gear)*steps + 1
    tooth(:, :last) = tooth_outline(gear, steps)
    from = root_angle(gear, drive)
    to = 2*pi/gear%spec%teeth - root_angle(gear, coast)
    do i = 1, steps - 1
      angle = from + (to - from)*i/steps
      tooth(:, last + i) = gear%root_radius*[sin(angle), cos(angle)]
    end do
    do k = 0, gear%spec%teeth - 1
      angle = 2*pi*k/gear%spec%teeth
      points(1, k*n + 1:(k + 1)*n) = tooth(1, :)*cos(angle) + tooth(2, :)*sin(angle)
      points(2, k*n + 1:(k + 1)*n) = tooth(2, :)*cos(angle) - tooth(1, :)*sin(angle)
    end do
  end function gear_outline

  !> Computes the outline for all interfaces (2, points), m: the complete gear, or one tooth of a gear with more than 500.
  pure subroutine shown_outline(gear, points)
    type(gear_t), intent(in) :: gear
    real(dp), allocatable, intent(out) :: points(:, :)
    integer, parameter :: steps = 12, most_teeth = 500

    if (gear%spec%teeth > most_teeth) then
      points = tooth_outline(gear, steps)
    else
      points = gear_outline(gear, steps)
    end if
  end subroutine shown_outline
end module gearsweep_gear_profile
