!> The gear's outline as points, for CAD and plots. Every junction of two
!> curves is a point, and every point lies on the true outline.
module gearsweep_contour
  use gearsweep_kinds, only: dp, pi
  use gearsweep_gear, only: gear_t, drive, coast
  use gearsweep_outline, only: fillet_point, involute_point, root_angle, tip_break_point
  implicit none
  private
  public :: tooth_outline, gear_outline, shown_outline, tooth_curves

contains

  !> Curves of one tooth: two fillets, two involutes and the tip land; two chamfers or roundings more where there are some.
  pure integer function tooth_curves(gear)
    type(gear_t), intent(in) :: gear

    tooth_curves = merge(7, 5, has_tip_break(gear))
  end function tooth_curves

  pure logical function has_tip_break(gear)
    type(gear_t), intent(in) :: gear

    has_tip_break = gear%tip_form_radius < gear%tip_radius
  end function has_tip_break

  !> One tooth with its axis along y, from root circle to root circle: coast
  !> fillet and involute, tip land, drive involute and fillet (2, 5 steps + 1), with chamfers or roundings beside the tip
  !> land (2, 7 steps + 1), m; the drive side has positive x. `steps` per curve, at least 1.
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

  !> Fillet, involute and chamfer or rounding of one side, upwards, on positive x.
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
      if (has_tip_break(gear)) points(:, 2*steps + i) = tip_break_point(gear, side, share)
    end do
  end function one_side

  !> All teeth, clockwise, each followed by `steps` - 1 points inside its root
  !> land (2, teeth times steps times one more than `tooth_curves`), m; the last point joins the first.
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

  !> The outline as every interface shows it (2, points), m: the whole gear, or one tooth
  !> of a gear with more than 500.
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
end module gearsweep_contour
