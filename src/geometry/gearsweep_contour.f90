!> The gear's outline as points, for CAD and plots. Every junction of two
!> curves is a point, and every point lies on the true outline.
module gearsweep_contour
  use gearsweep_kinds, only: dp, pi
  use gearsweep_gear, only: gear_t, drive, coast
  use gearsweep_outline, only: fillet_point, involute_point, root_angle
  implicit none
  private
  public :: tooth_contour, gear_contour, shown_contour

contains

  !> One tooth with its axis along y, from root circle to root circle: coast
  !> fillet and involute, tip land, drive involute and fillet (2, 5 steps + 1),
  !> m; the drive side has positive x. `steps` per curve, at least 1.
  pure function tooth_contour(gear, steps) result(points)
    type(gear_t), intent(in) :: gear
    integer, intent(in) :: steps
    real(dp) :: points(2, 0:5*steps)
    real(dp) :: left, right, angle
    integer :: i

    points(:, 0:2*steps) = one_side(gear, coast, steps)
    points(1, 0:2*steps) = -points(1, 0:2*steps)
    points(:, 5*steps:3*steps:-1) = one_side(gear, drive, steps)
    left = -gear%half_angle(coast, gear%tip_radius)
    right = gear%half_angle(drive, gear%tip_radius)
    do i = 1, steps - 1
      angle = left + (right - left)*i/steps
      points(:, 2*steps + i) = gear%tip_radius*[sin(angle), cos(angle)]
    end do
  end function tooth_contour

  !> Fillet and involute of one side, upwards, on positive x.
  pure function one_side(gear, side, steps) result(points)
    type(gear_t), intent(in) :: gear
    integer, intent(in) :: side, steps
    real(dp) :: points(2, 0:2*steps)
    real(dp) :: share
    integer :: i

    do i = 0, steps
      share = real(i, dp)/steps
      points(:, i) = fillet_point(gear, side, pi/2 + (gear%spec%pressure_angle(side) - pi/2)*share)
      points(:, steps + i) = involute_point(gear, side, &
        sqrt(gear%form_radius(side)**2*(1 - share) + gear%tip_radius**2*share))
    end do
  end function one_side

  !> All teeth, clockwise, each followed by `steps` - 1 points inside its root
  !> land (2, 6 steps teeth), m; the last point joins the first.
  pure function gear_contour(gear, steps) result(points)
    type(gear_t), intent(in) :: gear
    integer, intent(in) :: steps
    real(dp) :: points(2, 6*steps*gear%spec%teeth)
    real(dp) :: tooth(2, 6*steps), from, to, angle
    integer :: i, k, n

    n = 6*steps
    tooth(:, :5*steps + 1) = tooth_contour(gear, steps)
    from = root_angle(gear, drive)
    to = 2*pi/gear%spec%teeth - root_angle(gear, coast)
    do i = 1, steps - 1
      angle = from + (to - from)*i/steps
      tooth(:, 5*steps + 1 + i) = gear%root_radius*[sin(angle), cos(angle)]
    end do
    do k = 0, gear%spec%teeth - 1
      angle = 2*pi*k/gear%spec%teeth
      points(1, k*n + 1:(k + 1)*n) = tooth(1, :)*cos(angle) + tooth(2, :)*sin(angle)
      points(2, k*n + 1:(k + 1)*n) = tooth(2, :)*cos(angle) - tooth(1, :)*sin(angle)
    end do
  end function gear_contour

  !> The outline as doors show it (2, points), m: the whole gear, or one tooth
  !> of a gear with more than 500.
  pure subroutine shown_contour(gear, points)
    type(gear_t), intent(in) :: gear
    real(dp), allocatable, intent(out) :: points(:, :)
    integer, parameter :: steps = 12, most_teeth = 500

    if (gear%spec%teeth > most_teeth) then
      points = tooth_contour(gear, steps)
    else
      points = gear_contour(gear, steps)
    end if
  end subroutine shown_contour
end module gearsweep_contour
