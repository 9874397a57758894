!> Interval that contains the zero of a function, and how it is narrowed: the root finder of all rooms.
!>
!> The caller evaluates the function, which may be a formula or the motion over a mesh period. A rising one is bisected by
!>
!>     zero = bracket_t(low, high)
!>     do while (zero%is_open())
!>       call zero%halve(f(zero%middle()) < 0)
!>     end do
!>
!> and `zero%middle()` is the result. Bisection uses signs only: it needs neither slope nor smoothness, and ends at a jump as at a
!> zero. Without a change of sign the result is one of the ends. The Illinois method (Dowell and Jarratt 1971, BIT 11, 168) uses
!> values, and few of them: it is for functions that are expensive.
module gearsweep_base_bracket
  use gearsweep_base_kinds, only: dp
  implicit none
  private
  public :: bracket_t

  type bracket_t
    real(dp) :: low, high                        !< ends; `low` may be the larger number
    real(dp) :: value(2) = [-1, 1]               !< function at both ends, for the Illinois method
    integer, private :: halvings = 0
    integer, private :: replaced = 0             ! end that was replaced last, 1 or 2
  contains
    procedure :: middle
    procedure :: is_open
    procedure :: halve
    procedure :: chord_zero
    procedure :: narrow
  end type bracket_t

contains

  !> Middle of the interval; once it is not open any more, the zero to rounding.
  elemental real(dp) function middle(self)
    class(bracket_t), intent(in) :: self

    middle = (self%low + self%high)/2
  end function middle

  !> True if another number lies between the ends. False after 120 halvings too, as a zero at 0 has a thousand.
  elemental logical function is_open(self)
    class(bracket_t), intent(in) :: self
    integer, parameter :: most = 120

    is_open = is_inside(self, self%middle()) .and. self%halvings < most
  end function is_open

  elemental logical function is_inside(self, at)
    type(bracket_t), intent(in) :: self
    real(dp), intent(in) :: at

    is_inside = at > min(self%low, self%high) .and. at < max(self%low, self%high)
  end function is_inside

  !> Keeps the half from the middle to `high`, or the other one.
  elemental subroutine halve(self, keep_high)
    class(bracket_t), intent(inout) :: self
    logical, intent(in) :: keep_high

    self%halvings = self%halvings + 1
    if (keep_high) then
      self%low = self%middle()
    else
      self%high = self%middle()
    end if
  end subroutine halve

  !> Zero of the straight line through the values at both ends, or the middle if it is not between them.
  elemental real(dp) function chord_zero(self) result(at)
    class(bracket_t), intent(in) :: self

    at = self%low + (self%high - self%low)*self%value(1)/(self%value(1) - self%value(2))
    if (.not. is_inside(self, at)) at = self%middle()
  end function chord_zero

  !> Replaces the end of the same sign by the place `at` with its `value`. If the other end stays a second time, its value is
  !> halved, so that the next chord meets zero beyond the function's.
  elemental subroutine narrow(self, at, value)
    class(bracket_t), intent(inout) :: self
    real(dp), intent(in) :: at, value
    integer :: side

    side = merge(1, 2, value > 0 .eqv. self%value(1) > 0)
    if (side == 1) then
      self%low = at
    else
      self%high = at
    end if
    self%value(side) = value
    if (self%replaced == side) self%value(3 - side) = self%value(3 - side)/2
    self%replaced = side
  end subroutine narrow
end module gearsweep_base_bracket
