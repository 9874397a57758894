!> What one step and one period of the motion consist of: members and their contact side by side in
!> lanes, and the largest load between the ends of a step.
!>
!> The state is x (m) and its derivative y over the mesh phase (m).
module gearsweep_step
  use gearsweep_kinds, only: dp
  use gearsweep_gauss, only: lanes
  use gearsweep_motion, only: oscillator_t, table_t, end_acceleration
  use gearsweep_quintic, only: quintic, top_of, value_of
  implicit none
  private
  public :: period_t, member_t, touching, set_contact, note_contact, begins_zone, may_top, track_pair, raise_to_top

  !> What one period does.
  type :: period_t
    real(dp) :: state(2) = 0           !< at the end of the period
    real(dp) :: map(2, 2) = 0          !< derivative of that by the initial state
    real(dp) :: peak = 0               !< largest load on one pair, N
    real(dp) :: mark = 0               !< sum of x where zones begin, m: shows errors that the peak may not
    integer :: events = 0              !< changes of contact within the period
    real(dp) :: work = 0               !< what it cost, in steps
    logical :: partial = .false.       !< a pair between A and E was apart for a while
    logical :: flight = .false.        !< all flanks were apart for a while
    logical :: coast = .false.         !< the coast sides touched
    logical :: failed = .false.        !< contact changed too often
  end type period_t

  !> One member, a pair or the coast side, at the last end of a step; slopes over the step. `sense` is the
  !> overlap's sign while its contact stays as it is, `weight` 1 in contact and 0 apart.
  type :: member_t
    real(dp), dimension(lanes) :: weight = 0, sense = 1
    real(dp), dimension(lanes) :: gap = 0, gap_slope = 0, load = 0, load_slope = 0
  end type member_t

contains

  !> The members that touch in lane l.
  pure subroutine touching(member, l, contact)
    type(member_t), intent(in) :: member(:)
    integer, intent(in) :: l
    logical, intent(out) :: contact(:)
    integer :: j

    do j = 1, size(contact)
      contact(j) = member(j)%weight(l) > 0
    end do
  end subroutine touching

  pure subroutine set_contact(osc, l, j, contact, member)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: l, j
    logical, intent(in) :: contact
    type(member_t), intent(inout) :: member

    member%weight(l) = merge(1, 0, contact)
    member%sense(l) = merge(1, -1, contact .eqv. j <= osc%pairs)
  end subroutine set_contact

  !> Notes that not every pair carries.
  pure subroutine note_contact(osc, contact, out)
    type(oscillator_t), intent(in) :: osc
    logical, intent(in) :: contact(:)
    type(period_t), intent(inout) :: out

    out%partial = .true.
    out%flight = out%flight .or. .not. any(contact)
    if (osc%has_backlash) out%coast = out%coast .or. contact(size(contact))
  end subroutine note_contact

  pure logical function begins_zone(table, i)
    type(table_t), intent(in) :: table
    integer, intent(in) :: i

    begins_zone = table%begins(i)
  end function begins_zone

  !> May a load be larger than `peak` between two ends? Given there with its slopes: a concave one stays
  !> below its tangents.
  pure logical function may_top(load, peak)
    real(dp), intent(in) :: load(0:, :), peak

    may_top = load(1, 1) > 0 .and. load(1, 2) < 0
    if (may_top) may_top = max(load(0, 1), load(0, 2)) + (load(1, 1) - load(1, 2))/4 > peak
  end function may_top

  !> Raises `peak` to the largest load between the ends, where it is given with slope and curvature.
  pure subroutine raise_to_top(load, peak)
    real(dp), intent(in) :: load(0:2, 2)
    real(dp), intent(inout) :: peak
    real(dp) :: c(0:5)

    c = quintic(load(:, 1), load(:, 2))
    peak = max(peak, value_of(c, top_of(c)))
  end subroutine raise_to_top

  !> The peak of pair j's load within step i with the contact as it is; x, y at its ends.
  pure subroutine track_pair(osc, table, i, j, duration, contact, x, y, peak)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: i, j
    logical, intent(in) :: contact(:)
    real(dp), intent(in) :: duration, x(2), y(2)
    real(dp), intent(inout) :: peak
    real(dp) :: gap(0:2, 2), load(0:2, 2)
    integer :: k

    associate (stiffness => table%end_stiffness(:, j, :, i), width => table%width(i))
      gap(0, :) = x - table%end_error(0, j, :, i)
      gap(1, :) = y - table%end_error(1, j, :, i)
      load(0, :) = stiffness(1, :)*gap(0, :)
      load(1, :) = width*(stiffness(2, :)*gap(0, :) + stiffness(1, :)*gap(1, :))
      if (.not. may_top(load, peak)) return
      if (is_resolved(table, i, duration, contact)) then
        do k = 1, 2
          gap(2, k) = end_acceleration(osc, table, i, k, contact, duration, x(k), y(k)) - table%end_error(2, j, k, i)
        end do
      else
        gap(2, :) = cubic_curvature(gap(0, :), width*gap(1, :))/width**2
      end if
      load(2, :) = width**2*(stiffness(3, :)*gap(0, :) + 2*stiffness(2, :)*gap(1, :) + stiffness(1, :)*gap(2, :))
    end associate
    call raise_to_top(load, peak)
  end subroutine track_pair

  !> Does acceleration count? In steps of very many rad it is a small difference of large forces.
  pure logical function is_resolved(table, i, duration, contact)
    type(table_t), intent(in) :: table
    integer, intent(in) :: i
    real(dp), intent(in) :: duration
    logical, intent(in) :: contact(:)
    real(dp), parameter :: most = 3e4_dp         ! rad of the natural motion

    is_resolved = duration*table%width(i)*sqrt(maxval(sum(table%end_rate(:, :, i), 1, spread(contact, 2, 2)))) < most
  end function is_resolved

  !> Second derivatives at both ends of the cubic with these values and slopes there, over 0 ... 1.
  pure function cubic_curvature(value, slope) result(curvature)
    real(dp), intent(in) :: value(2), slope(2)
    real(dp) :: curvature(2)

    associate (rise => value(2) - value(1))
      curvature = [6*rise - 4*slope(1) - 2*slope(2), -6*rise + 2*slope(1) + 4*slope(2)]
    end associate
  end function cubic_curvature
end module gearsweep_step
