!> The polynomial of fifth degree through value, slope and curvature at both ends of a step: between
!> the steps as exact as the steps themselves.
module gearsweep_quintic
  use gearsweep_kinds, only: dp
  implicit none
  private
  public :: quintic, value_of, slope_of, bend_of, evaluate, top_of, first_zero, may_pass

contains

  !> Coefficients in ascending powers of 0 ... 1 over the step; `left` and `right` hold value, slope and
  !> curvature over that variable.
  pure function quintic(left, right) result(c)
    real(dp), intent(in) :: left(0:2), right(0:2)
    real(dp) :: c(0:5), value, slope, curvature

    value = right(0) - left(0) - left(1) - left(2)/2
    slope = right(1) - left(1) - left(2)
    curvature = right(2) - left(2)
    c(:2) = [left(0), left(1), left(2)/2]
    c(3) = 10*value - 4*slope + curvature/2
    c(4) = -15*value + 7*slope - curvature
    c(5) = 6*value - 3*slope + curvature/2
  end function quintic

  pure real(dp) function value_of(c, t)
    real(dp), intent(in) :: c(0:5), t

    value_of = ((((c(5)*t + c(4))*t + c(3))*t + c(2))*t + c(1))*t + c(0)
  end function value_of

  pure real(dp) function slope_of(c, t)
    real(dp), intent(in) :: c(0:5), t

    slope_of = (((5*c(5)*t + 4*c(4))*t + 3*c(3))*t + 2*c(2))*t + c(1)
  end function slope_of

  !> Both together.
  pure subroutine evaluate(c, t, value, slope)
    real(dp), intent(in) :: c(0:5), t
    real(dp), intent(out) :: value, slope

    value = value_of(c, t)
    slope = slope_of(c, t)
  end subroutine evaluate

  !> Second derivative.
  pure real(dp) function bend_of(c, t)
    real(dp), intent(in) :: c(0:5), t

    bend_of = ((20*c(5)*t + 12*c(4))*t + 6*c(3))*t + 2*c(2)
  end function bend_of

  pure function derivative(c) result(d)
    real(dp), intent(in) :: c(0:5)
    real(dp) :: d(0:5)

    d = [c(1), 2*c(2), 3*c(3), 4*c(4), 5*c(5), 0.0_dp]
  end function derivative

  !> Where the slope changes sign, given that it does from one end to the other.
  pure real(dp) function top_of(c)
    real(dp), intent(in) :: c(0:5)

    top_of = zero_between(derivative(c), 0.0_dp, 1.0_dp)
  end function top_of

  !> First place at which a function that is positive after 0 passes zero, and whether there is one: seen
  !> by the ends, or by the turning point between them.
  pure subroutine first_zero(c, place, found)
    real(dp), intent(in) :: c(0:5)
    real(dp), intent(out) :: place
    logical, intent(out) :: found

    place = 1
    found = value_of(c, 1.0_dp) < 0
    if (.not. found .and. c(1) < 0 .and. value_of(derivative(c), 1.0_dp) > 0) then
      place = top_of(c)
      found = value_of(c, place) < 0
    end if
    if (found) place = zero_between(c, 0.0_dp, place)
  end subroutine first_zero

  !> Ends a, b and slopes da, db over the step of a function that is positive at the left: may it pass
  !> zero? A convex one stays above its tangents.
  elemental logical function may_pass(a, b, da, db)
    real(dp), intent(in) :: a, b, da, db

    may_pass = b < 0 .or. (da < 0 .and. db > 0 .and. min(a, b) < (db - da)/4)
  end function may_pass

  !> Newton's method kept within a bracket, from where the chord passes zero. The sign at `high` is that
  !> beyond the zero.
  pure real(dp) function zero_between(c, low_end, high_end) result(t)
    real(dp), intent(in) :: c(0:5), low_end, high_end
    ! The correction after the last one would be its square.
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
end module gearsweep_quintic
