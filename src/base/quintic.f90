!> The polynomial of fifth degree through value, first and second derivative at both ends of a step: between the ends it is as
!> exact as the steps themselves. Its variable runs from 0 to 1 over the step; `c` are its coefficients in ascending powers, and
!> all values and derivatives have the unit of its quantity.
module gearsweep_base_quintic
  use gearsweep_base_kinds, only: dp
  implicit none
  private
  public :: quintic, bounds_of, value_of, derivative_of, evaluate, over_part
  public :: maximum_of, place_of_largest, first_zero, may_cross_zero

contains

  !> Coefficients of the polynomial.
  pure function quintic(left, right) result(c)
    real(dp), intent(in) :: left(0:2), right(0:2)    !< value, first and second derivative at 0 and at 1
    real(dp) :: c(0:5), value, slope, curvature

    value = right(0) - left(0) - left(1) - left(2)/2
    slope = right(1) - left(1) - left(2)
    curvature = right(2) - left(2)
    c(:2) = [left(0), left(1), left(2)/2]
    c(3) = 10*value - 4*slope + curvature/2
    c(4) = -15*value + 7*slope - curvature
    c(5) = 6*value - 3*slope + curvature/2
  end function quintic

  !> Bounds of the polynomial from 0 to 1: the least and the largest of its Bernstein coefficients.
  pure function bounds_of(c) result(bounds)
    real(dp), intent(in) :: c(0:5)     !< coefficients
    real(dp) :: bounds(2), b(0:5)

    b(0) = c(0)
    b(1) = c(0) + c(1)/5
    b(2) = c(0) + (4*c(1) + c(2))/10
    b(3) = c(0) + (6*c(1) + 3*c(2) + c(3))/10
    b(4) = c(0) + (4*c(1) + 3*c(2) + 2*c(3) + c(4))/5
    b(5) = c(0) + c(1) + c(2) + c(3) + c(4) + c(5)
    bounds = [min(b(0), b(1), b(2), b(3), b(4), b(5)), max(b(0), b(1), b(2), b(3), b(4), b(5))]
  end function bounds_of

  !> Value at t.
  pure real(dp) function value_of(c, t)
    real(dp), intent(in) :: c(0:5)     !< coefficients
    real(dp), intent(in) :: t          !< place, 0 to 1

    value_of = ((((c(5)*t + c(4))*t + c(3))*t + c(2))*t + c(1))*t + c(0)
  end function value_of

  !> First derivative at t.
  pure real(dp) function derivative_of(c, t)
    real(dp), intent(in) :: c(0:5)     !< coefficients
    real(dp), intent(in) :: t          !< place, 0 to 1

    derivative_of = (((5*c(5)*t + 4*c(4))*t + 3*c(3))*t + 2*c(2))*t + c(1)
  end function derivative_of

  !> Value and first derivative at t.
  pure subroutine evaluate(c, t, value, derivative)
    real(dp), intent(in) :: c(0:5)     !< coefficients
    real(dp), intent(in) :: t          !< place, 0 to 1
    real(dp), intent(out) :: value, derivative

    value = value_of(c, t)
    derivative = derivative_of(c, t)
  end subroutine evaluate

  !> Value, first and second derivative of a polynomial of any degree at two places, over the part between them; (0:2, place).
  pure function over_part(c, places) result(f)
    real(dp), intent(in) :: c(0:)      !< coefficients in ascending powers
    real(dp), intent(in) :: places(2)
    real(dp) :: f(0:2, 2), length
    integer :: i, k

    length = places(2) - places(1)
    f = 0
    do i = 1, 2
      do k = ubound(c, 1), 0, -1
        f(2, i) = f(2, i)*places(i) + f(1, i)
        f(1, i) = f(1, i)*places(i) + f(0, i)
        f(0, i) = f(0, i)*places(i) + c(k)
      end do
    end do
    f(1, :) = length*f(1, :)
    f(2, :) = 2*length**2*f(2, :)
  end function over_part

  !> Coefficients of the first derivative.
  pure function differentiated(c) result(d)
    real(dp), intent(in) :: c(0:5)
    real(dp) :: d(0:5)

    d = [c(1), 2*c(2), 3*c(3), 4*c(4), 5*c(5), 0.0_dp]
  end function differentiated

  !> Place of the sign change of the first derivative, which must have different signs at both ends; 0 to 1.
  pure real(dp) function maximum_of(c)
    real(dp), intent(in) :: c(0:5)     !< coefficients

    maximum_of = zero_between(differentiated(c), 0.0_dp, 1.0_dp)
  end function maximum_of

  !> Place of the polynomial's largest value from 0 to 1. Two extremes within an eighth of this interval are not seen.
  pure real(dp) function place_of_largest(c) result(place)
    real(dp), intent(in) :: c(0:5)     !< coefficients
    integer, parameter :: parts = 8
    real(dp) :: at, slope(0:parts)
    integer :: i

    slope = [(derivative_of(c, real(i, dp)/parts), i=0, parts)]
    place = 0
    if (value_of(c, 1.0_dp) > c(0)) place = 1
    do i = 1, parts
      if (.not. (slope(i - 1) > 0 .and. slope(i) < 0)) cycle
      at = zero_between(differentiated(c), (i - 1.0_dp)/parts, real(i, dp)/parts)
      if (value_of(c, at) > value_of(c, place)) place = at
    end do
  end function place_of_largest

  !> Finds the first zero of a function that is positive just after 0, as far as the ends or one minimum between them show it.
  pure subroutine first_zero(c, place, found)
    real(dp), intent(in) :: c(0:5)     !< coefficients
    real(dp), intent(out) :: place     !< 0 to 1
    logical, intent(out) :: found

    place = 1
    found = value_of(c, 1.0_dp) < 0
    if (.not. found .and. c(1) < 0 .and. value_of(differentiated(c), 1.0_dp) > 0) then
      place = maximum_of(c)
      found = value_of(c, place) < 0
    end if
    if (found) place = zero_between(c, 0.0_dp, place)
  end subroutine first_zero

  !> True if a function that is positive at the left end may cross zero: a convex one stays above its tangents.
  elemental logical function may_cross_zero(a, b, da, db)
    real(dp), intent(in) :: a, b       !< values at the left and the right end
    real(dp), intent(in) :: da, db     !< derivatives there, over the step

    may_cross_zero = b < 0 .or. (da < 0 .and. db > 0 .and. min(a, b) < (db - da)/4)
  end function may_cross_zero

  !> Zero by Newton's method kept within a bracket, from the zero of the chord. The sign at `high_end` is that beyond the zero.
  pure real(dp) function zero_between(c, low_end, high_end) result(t)
    real(dp), intent(in) :: c(0:5), low_end, high_end
    ! The next correction would be its square.
    real(dp), parameter :: tight = 1e-5_dp
    real(dp) :: low, high, ends(2), f, slope, sense, moved
    integer :: iteration, k

    low = low_end
    high = high_end
    ends = [value_of(c, low), value_of(c, high)]
    sense = sign(1.0_dp, ends(2))
    t = (low + high)/2
    if (ends(1)*ends(2) < 0) t = (low*ends(2) - high*ends(1))/(ends(2) - ends(1))
    do iteration = 1, 60
      f = 0
      slope = 0
      do k = 5, 0, -1
        slope = slope*t + f
        f = f*t + c(k)
      end do
      if (sense*f > 0) then
        high = t
      else
        low = t
      end if
      moved = t
      if (abs(slope) > 0) t = t - f/slope
      if (.not. (t >= low .and. t <= high)) t = (low + high)/2
      if (abs(t - moved) <= tight) exit
    end do
  end function zero_between
end module gearsweep_base_quintic
