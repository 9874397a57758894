!> Mean square and range of the dynamic transmission error, taken along with the motion: exact to the fourth order of the steps.
!>
!> The deflection counts from a level near all of it, so that a small motion does not drown in the rounding of a large mean. As its
!> derivative is continuous, it is largest and least where that passes zero; within a step the motion is the cubic through
!> the states at its ends.
module gearsweep_dte
  use gearsweep_gauss, only: batch_size
  use gearsweep_kinds, only: dp
  implicit none
  private
  public :: dte_t, dte_batch_t, add_to_dte, add_batch_to_dte, some_turn, raise_range, weights_of_end, dte_of, join, rms_of, range_of

  !> Over a mesh period, or several.
  type :: dte_t
    real(dp) :: first = 0              !< integral over the phase, m
    real(dp) :: second = 0             !< integral of the square, m^2
    real(dp) :: least = huge(1.0_dp), largest = -huge(1.0_dp)      !< m
  end type dte_t

  !> The same of all motions of a batch.
  type :: dte_batch_t
    real(dp), dimension(batch_size) :: first = 0, second = 0, least = huge(1.0_dp), largest = -huge(1.0_dp)
  end type dte_batch_t

contains

  !> What the deflection where a step ends and its derivative there contribute to the integral over the phase, by Euler and
  !> Maclaurin's formula on either side: the corrections of steps of one width cancel.
  pure subroutine weights_of_end(width, next, place, slope)
    real(dp), intent(in) :: width, next          !< of the step and the next one, in mesh phase; the first one follows on the last
    real(dp), intent(out) :: place, slope        !< of the deflection, and of its derivative over the phase

    place = (width + next)/2
    slope = (next + width)*(next - width)/12
  end subroutine weights_of_end

  !> Adds a step of one motion.
  pure subroutine add_to_dte(width, next, x, y, dte)
    real(dp), intent(in) :: width, next          !< of the step and the next one, in mesh phase
    real(dp), intent(in) :: x(2)                 !< deflections at the ends of the step less the level, m
    real(dp), intent(in) :: y(2)                 !< their derivatives over the phase, m
    type(dte_t), intent(inout) :: dte
    real(dp) :: place, slope, extreme

    call weights_of_end(width, next, place, slope)
    dte%first = dte%first + place*x(2) + slope*y(2)
    dte%second = dte%second + (place*x(2) + 2*slope*y(2))*x(2)
    if (y(1)*y(2) > 0) return
    extreme = extreme_within(width, x(1), y(1), x(2), y(2))
    dte%least = min(dte%least, extreme)
    dte%largest = max(dte%largest, extreme)
  end subroutine add_to_dte

  !> Adds a step of all motions of a batch.
  pure subroutine add_batch_to_dte(width, next, level, left_x, left_y, right_x, right_y, dte)
    real(dp), intent(in) :: width, next          !< of the step and the next one, in mesh phase
    real(dp), intent(in) :: level                !< m
    !> Deflections at both ends with their derivatives over the phase, m.
    real(dp), intent(in), dimension(batch_size) :: left_x, left_y, right_x, right_y
    type(dte_batch_t), intent(inout) :: dte
    real(dp) :: x, place, slope
    integer :: l

    call weights_of_end(width, next, place, slope)
    do l = 1, batch_size
      x = right_x(l) - level
      dte%first(l) = dte%first(l) + place*x + slope*right_y(l)
      dte%second(l) = dte%second(l) + (place*x + 2*slope*right_y(l))*x
    end do
    if (some_turn(left_y, right_y)) call raise_range(width, left_x - level, left_y, right_x - level, right_y, dte)
  end subroutine add_batch_to_dte

  !> Does a derivative pass zero in a step?
  pure logical function some_turn(left, right)
    real(dp), intent(in), dimension(batch_size) :: left, right     !< at both ends, m
    integer, parameter :: half = batch_size/2, quarter = batch_size/4
    real(dp) :: least(half)

    least = min(left(:half)*right(:half), left(half + 1:)*right(half + 1:))
    least(:quarter) = min(least(:quarter), least(quarter + 1:))
    some_turn = .not. min(least(1), least(quarter)) > 0
  end function some_turn

  !> Raises the range of each motion of a batch that turns in a step.
  pure subroutine raise_range(width, left_x, left_y, right_x, right_y, dte)
    real(dp), intent(in) :: width                !< of the step, in mesh phase
    !> Deflections at both ends less the level, with their derivatives over the phase, m.
    real(dp), intent(in), dimension(batch_size) :: left_x, left_y, right_x, right_y
    type(dte_batch_t), intent(inout) :: dte
    real(dp) :: extreme
    integer :: l

    do l = 1, batch_size
      extreme = extreme_within(width, left_x(l), left_y(l), right_x(l), right_y(l))
      dte%least(l) = merge(dte%least(l), min(dte%least(l), extreme), left_y(l)*right_y(l) > 0)
      dte%largest(l) = merge(dte%largest(l), max(dte%largest(l), extreme), left_y(l)*right_y(l) > 0)
    end do
  end subroutine raise_range

  !> That of one motion of a batch.
  pure type(dte_t) function dte_of(batch, l)
    type(dte_batch_t), intent(in) :: batch
    integer, intent(in) :: l                     !< which motion

    dte_of = dte_t(batch%first(l), batch%second(l), batch%least(l), batch%largest(l))
  end function dte_of

  !> That of both of two times.
  pure type(dte_t) function join(a, b)
    type(dte_t), intent(in) :: a, b

    join = dte_t(a%first + b%first, a%second + b%second, min(a%least, b%least), max(a%largest, b%largest))
  end function join

  !> Root mean square of what the transmission error differs from its mean, m.
  pure real(dp) function rms_of(dte, periods)
    type(dte_t), intent(in) :: dte
    integer, intent(in) :: periods               !< mesh periods that it is of

    rms_of = sqrt(max(0.0_dp, dte%second/periods - (dte%first/periods)**2))
  end function rms_of

  !> Largest less least transmission error, m; 0 where it nowhere turns.
  pure real(dp) function range_of(dte)
    type(dte_t), intent(in) :: dte

    range_of = 0
    if (dte%largest > dte%least) range_of = dte%largest - dte%least
  end function range_of

  !> Where the derivative passes zero within a step, if it does; without branches, for the lanes of a batch.
  elemental real(dp) function extreme_within(width, x, y, next_x, next_y) result(extreme)
    real(dp), intent(in) :: width, x, y, next_x, next_y
    real(dp) :: left, right, rise, square, cube, root, t

    left = width*y
    right = width*next_y
    rise = next_x - x
    square = 3*rise - 2*left - right
    cube = left + right - 2*rise
    root = sqrt(max(0.0_dp, square**2 - 3*cube*left)) - sign(1.0_dp, left)*square
    t = merge(abs(left)/merge(root, 1.0_dp, root > 0), 0.0_dp, root > 0)
    extreme = x + t*(left + t*(square + t*cube))
  end function extreme_within
end module gearsweep_dte
