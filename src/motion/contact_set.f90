!> Contact sets, and the result of one mesh period of the motion with the mean square and range of its transmission error.
!>
!> A contact is a pair that may be in contact or, after these and only with backlash, the coast sides: all together or, where
!> teeth have position errors, those next to each pair. A contact set is an integer: bit j - 1 is set where contact j is closed.
!> The state of the motion is x (m) and its derivative y over the mesh phase (m).
!>
!> The dynamic transmission error is integrated to the fourth order of the steps. It is measured from a level near its mean, so
!> that a small motion is not lost in the rounding of a large mean. Its extrema are the zeros of its continuous derivative, on the
!> cubic through the states at the ends of a step.
module gearsweep_motion_contact_set
  use gearsweep_base, only: dp
  use gearsweep_motion_gauss, only: batch_size
  use gearsweep_motion_oscillator, only: oscillator_t, touches_coast
  implicit none
  private
  public :: dte_t, dte_batch_t, add_to_dte, add_batch_to_dte, dte_of, join, rms_of, &
            range_of, period_t, contact_t, in_contact, set_contact, set_contacts, record_contact, keep_derivative

  !> Dynamic transmission error over a mesh period, or several.
  type :: dte_t
    real(dp) :: first = 0              !< integral over the phase, m
    real(dp) :: second = 0             !< integral of the square, m^2
    real(dp) :: least = huge(1.0_dp), largest = -huge(1.0_dp)      !< m
  end type dte_t

  !> Dynamic transmission error of all motions of a batch.
  type :: dte_batch_t
    real(dp), dimension(batch_size) :: first = 0, second = 0, least = huge(1.0_dp), largest = -huge(1.0_dp)
  end type dte_batch_t

  !> Result of one mesh period of the motion.
  type :: period_t
    real(dp) :: state(2) = 0           !< x, y at the end of the period, m
    real(dp) :: monodromy(2, 2) = 0    !< derivative of that by the initial state; 0 where it underflows
    real(dp) :: scaled(2, 2) = 0       !< monodromy matrix over exp(shrunk), which does not underflow
    real(dp) :: shrunk = 0             !< below 0 where the monodromy matrix is 0
    real(dp) :: peak = 0               !< largest load on one pair, N
    real(dp) :: coast_peak = 0         !< largest load on the coast sides, N
    !> Phase checksum (m): the sum of x at the starts of smooth intervals. It shows errors that the largest load may hide.
    real(dp) :: checksum = 0
    type(dte_t) :: dte                 !< with largest loads only; from the mean static deflection
    integer :: events = 0              !< number of changes of contact
    logical :: departs = .false.       !< contact was not always full, as linear motion needs
    logical :: partial = .false.       !< a pair between A and E was apart for a while
    logical :: lost = .false.          !< all flanks were apart for a while
    logical :: coast = .false.         !< the coast sides came into contact
    logical :: failed = .false.        !< contact changed too often
  end type period_t

  !> One contact in all motions of a batch, with the load at the end of the last step.
  type :: contact_t
    real(dp), dimension(batch_size) :: sense = 1       !< sign that makes the overlap positive until the contact changes
    real(dp), dimension(batch_size) :: load = 0        !< N
    real(dp), dimension(batch_size) :: load_slope = 0  !< its derivative over the step, N
  end type contact_t

contains

  !> Weights of the deflection and its derivative at the end of a step in the integral over the phase, by the Euler-Maclaurin
  !> formula on either side: the corrections of steps of one width cancel.
  pure subroutine weights_of_end(width, next, place, slope)
    real(dp), intent(in) :: width, next          !< widths of this and the next step, in mesh phase; the first step follows the last
    real(dp), intent(out) :: place, slope        !< of the deflection, and of its derivative over the phase

    place = (width + next)/2
    slope = (next + width)*(next - width)/12
  end subroutine weights_of_end

  !> Adds a step of one motion.
  pure subroutine add_to_dte(width, next, x, y, dte)
    real(dp), intent(in) :: width, next          !< widths of this and the next step, in mesh phase
    real(dp), intent(in) :: x(2)                 !< deflections at the ends of the step minus the level, m
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
    real(dp), intent(in) :: width, next          !< widths of this and the next step, in mesh phase
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

  !> True if a derivative passes zero in a step.
  pure logical function some_turn(left, right)
    real(dp), intent(in), dimension(batch_size) :: left, right     !< at both ends, m
    integer, parameter :: half = batch_size/2, quarter = batch_size/4
    real(dp) :: least(half)

    least = min(left(:half)*right(:half), left(half + 1:)*right(half + 1:))
    least(:quarter) = min(least(:quarter), least(quarter + 1:))
    some_turn = .not. min(least(1), least(quarter)) > 0
  end function some_turn

  !> Extends the range of each motion of a batch that has an extremum in a step.
  pure subroutine raise_range(width, left_x, left_y, right_x, right_y, dte)
    real(dp), intent(in) :: width                !< width of the step, in mesh phase
    !> Deflections at both ends minus the level, with their derivatives over the phase, m.
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

  !> Transmission error of one motion of a batch.
  pure type(dte_t) function dte_of(batch, l)
    type(dte_batch_t), intent(in) :: batch
    integer, intent(in) :: l                     !< index of the motion

    dte_of = dte_t(batch%first(l), batch%second(l), batch%least(l), batch%largest(l))
  end function dte_of

  !> Transmission error over both of two times.
  pure type(dte_t) function join(a, b)
    type(dte_t), intent(in) :: a, b

    join = dte_t(a%first + b%first, a%second + b%second, min(a%least, b%least), max(a%largest, b%largest))
  end function join

  !> Root mean square of the deviation of the transmission error from its mean, m.
  elemental real(dp) function rms_of(dte, periods)
    type(dte_t), intent(in) :: dte
    integer, intent(in) :: periods               !< number of mesh periods

    rms_of = sqrt(max(0.0_dp, dte%second/periods - (dte%first/periods)**2))
  end function rms_of

  !> Largest minus least transmission error, m; 0 if it has no extremum.
  elemental real(dp) function range_of(dte)
    type(dte_t), intent(in) :: dte

    range_of = 0
    if (dte%largest > dte%least) range_of = dte%largest - dte%least
  end function range_of

  !> Value at the zero of the derivative within a step, if there is one; without branches, for the lanes of a batch.
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

  !> Stores a period's derivative, in columns one after the other, scaled by exp(-shrunk).
  pure subroutine keep_derivative(columns, shrunk, period)
    real(dp), intent(in) :: columns(:), shrunk     ! 4 elements, not always adjacent
    type(period_t), intent(inout) :: period

    period%scaled(:, 1) = columns(1:2)
    period%scaled(:, 2) = columns(3:4)
    period%shrunk = shrunk
    period%monodromy = 0
    if (.not. shrunk < 0) period%monodromy = period%scaled
  end subroutine keep_derivative

  !> True if contact j is closed.
  elemental logical function in_contact(contact_set, j)
    integer, intent(in) :: contact_set
    integer, intent(in) :: j           !< index of the contact

    in_contact = btest(contact_set, j - 1)
  end function in_contact

  !> Closes or opens a contact of one motion.
  elemental subroutine set_contact(osc, l, j, closed, contact_set, contact)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: l           !< index of the motion in the batch
    integer, intent(in) :: j           !< index of the contact
    logical, intent(in) :: closed
    integer, intent(inout) :: contact_set      !< contact set of this motion
    type(contact_t), intent(inout) :: contact  !< contact j

    contact_set = merge(ibset(contact_set, j - 1), ibclr(contact_set, j - 1), closed)
    contact%sense(l) = merge(1, -1, closed .eqv. j <= osc%pairs)
  end subroutine set_contact

  !> Sets contact j of all motions of a batch from their contact sets.
  pure subroutine set_contacts(osc, j, contact_set, contact)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: j           !< index of the contact
    integer, intent(in) :: contact_set(batch_size)     !< (motion)
    type(contact_t), intent(inout) :: contact  !< contact j
    integer :: l

    do l = 1, batch_size
      contact%sense(l) = merge(1, -1, in_contact(contact_set(l), j) .eqv. j <= osc%pairs)
    end do
  end subroutine set_contacts

  !> Records the state of contact in a period.
  pure subroutine record_contact(osc, contact_set, full, between, period)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: contact_set
    integer, intent(in) :: full                !< contact set of full contact
    integer, intent(in) :: between             !< contact set of all pairs between A and E
    type(period_t), intent(inout) :: period
    logical :: coast

    coast = touches_coast(osc, contact_set)
    period%departs = period%departs .or. contact_set /= full
    period%partial = period%partial .or. iand(contact_set, between) /= between .or. coast
    period%lost = period%lost .or. contact_set == 0
    period%coast = period%coast .or. coast
  end subroutine record_contact
end module gearsweep_motion_contact_set
