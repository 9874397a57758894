!> The derivative of a function by differences of sixth order over seven places, and of fifth or fourth order over fewer of them.
!> Source: Fornberg 1988, Generation of finite difference formulas on arbitrarily spaced grids.
module gearsweep_difference
  use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
  use gearsweep_kinds, only: dp
  implicit none
  private
  public :: difference_t, make_difference

  !> Places around one where the function is wanted: three on each side or, where there is nothing below, six above.
  type :: difference_t
    logical :: one_sided = .false.
    real(dp) :: step = 1
    real(dp) :: offset(0:6) = 0                  !< of the places from that one, which is the first
  contains
    procedure :: slope, rougher_slope, slope_below, slope_above
  end type difference_t

  !> At 0, 1, 2, 3, -1, -2, -3 steps, and at 0, 1 ... 6.
  real(dp), parameter :: central(0:6) = [0, 45, -9, 1, -45, 9, -1]/60.0_dp, &
    central_rough(0:6) = [0, 8, -1, 0, -8, 1, 0]/12.0_dp, &
    ahead(0:6) = [-147, 360, -450, 400, -225, 72, -10]/60.0_dp, &
    ahead_rough(0:6) = [-137, 300, -300, 200, -75, 12, 0]/60.0_dp, &
    one_side(0:3) = [-11, 18, -9, 2]/6.0_dp

contains

  !> Differences around `value` with `step` between the places.
  pure type(difference_t) function make_difference(value, least, step) result(difference)
    real(dp), intent(in) :: value, least         !< the function has no value below `least`
    real(dp), intent(in) :: step
    integer :: i

    difference%step = step
    difference%one_sided = value - 3*step < least
    difference%offset = step*[0, 1, 2, 3, -1, -2, -3]
    if (difference%one_sided) difference%offset = step*[(i, i=0, 6)]
  end function make_difference

  pure real(dp) function slope(self, value)
    class(difference_t), intent(in) :: self
    real(dp), intent(in) :: value(0:6)           !< of the function, at `offset`

    slope = dot_product(merge(ahead, central, self%one_sided), value)/self%step
  end function slope

  !> By fewer places: how far it differs tells how far the slope is uncertain.
  pure real(dp) function rougher_slope(self, value) result(slope)
    class(difference_t), intent(in) :: self
    real(dp), intent(in) :: value(0:6)

    slope = dot_product(merge(ahead_rough, central_rough, self%one_sided), value)/self%step
  end function rougher_slope

  !> By the places below alone; NaN where there are none.
  pure real(dp) function slope_below(self, value) result(slope)
    class(difference_t), intent(in) :: self
    real(dp), intent(in) :: value(0:6)

    slope = ieee_value(1.0_dp, ieee_quiet_nan)
    if (.not. self%one_sided) slope = -dot_product(one_side, [value(0), value(4:)])/self%step
  end function slope_below

  !> By the places above alone.
  pure real(dp) function slope_above(self, value) result(slope)
    class(difference_t), intent(in) :: self
    real(dp), intent(in) :: value(0:6)

    slope = dot_product(one_side, value(:3))/self%step
    if (self%one_sided) slope = self%slope(value)
  end function slope_above
end module gearsweep_difference
