!> The largest load on one pair, also between the ends of steps.
module gearsweep_peaks
  use gearsweep_kinds, only: dp
  use gearsweep_motion, only: oscillator_t, table_t, end_acceleration
  use gearsweep_quintic, only: quintic, top_of, value_of
  implicit none
  private
  public :: top_t, tops_t, note_top, settle_tops, may_top, raise_to_top

  !> A step within which a pair's load has a maximum below `bound` (N): x, y at its ends, and what touches.
  type :: top_t
    real(dp) :: bound, x(2), y(2)
    integer :: step, pair, touch
  end type top_t

  !> Those that may be the largest; looked at in the end.
  integer, parameter :: most_tops = 16
  type :: tops_t
    integer :: count
    type(top_t) :: top(most_tops)
  end type tops_t

contains

  !> Adds one; forgets what the peak has passed meanwhile if there are too many, or settles them.
  pure subroutine note_top(osc, table, duration, top, tops, peak)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    real(dp), intent(in) :: duration
    type(top_t), intent(in) :: top
    type(tops_t), intent(inout) :: tops
    real(dp), intent(inout) :: peak
    integer :: k, kept

    if (tops%count == most_tops) then
      kept = 0
      do k = 1, most_tops
        if (tops%top(k)%bound <= peak) cycle
        kept = kept + 1
        tops%top(kept) = tops%top(k)
      end do
      tops%count = kept
      if (kept == most_tops) call settle_tops(osc, table, duration, tops, peak)
    end if
    tops%count = tops%count + 1
    tops%top(tops%count) = top
  end subroutine note_top

  !> Raises the peak by all of them; the highest bound first, which spares most others.
  pure subroutine settle_tops(osc, table, duration, tops, peak)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    real(dp), intent(in) :: duration
    type(tops_t), intent(inout) :: tops
    real(dp), intent(inout) :: peak
    integer :: k

    do while (tops%count > 0)
      k = maxloc(tops%top(:tops%count)%bound, 1)
      if (tops%top(k)%bound > peak) call track(osc, table, duration, tops%top(k), peak)
      tops%top(k) = tops%top(tops%count)
      tops%count = tops%count - 1
    end do
  end subroutine settle_tops

  !> Raises `peak` by the load within the step.
  pure subroutine track(osc, table, duration, top, peak)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    real(dp), intent(in) :: duration
    type(top_t), intent(in) :: top
    real(dp), intent(inout) :: peak
    ! In steps of more rad of the natural motion acceleration is a small difference of large forces.
    real(dp), parameter :: most = 3e3_dp
    real(dp) :: gap(0:2, 2), load(0:2, 2)
    integer :: k

    associate (i => top%step, j => top%pair)
      associate (stiffness => table%end_stiffness(:, j, :, i), width => table%width(i))
        gap(0, :) = top%x - table%end_error(0, j, :, i)
        gap(1, :) = top%y - table%end_error(1, j, :, i)
        load(0, :) = stiffness(1, :)*gap(0, :)
        load(1, :) = width*(stiffness(2, :)*gap(0, :) + stiffness(1, :)*gap(1, :))
        if (.not. may_top(load, peak)) return
        if (duration*width*sqrt(maxval(sum(table%end_rate(:table%pairs(i), :, i), 1))) < most) then
          do k = 1, 2
            gap(2, k) = end_acceleration(osc, table, i, k, top%touch, duration, top%x(k), top%y(k)) &
                        - table%end_error(2, j, k, i)
          end do
        else
          gap(2, :) = cubic_curvature(gap(0, :), width*gap(1, :))/width**2
        end if
        load(2, :) = width**2*(stiffness(3, :)*gap(0, :) + 2*stiffness(2, :)*gap(1, :) + stiffness(1, :)*gap(2, :))
      end associate
    end associate
    call raise_to_top(load, peak)
  end subroutine track

  !> May a load be larger than `peak` between two ends? Given there with its slopes (the curvatures are not
  !> asked for): a concave one stays below its tangents.
  pure logical function may_top(load, peak)
    real(dp), intent(in) :: load(0:2, 2), peak

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

  !> Second derivatives at both ends of the cubic with these values and slopes there, over 0 ... 1.
  pure function cubic_curvature(value, slope) result(curvature)
    real(dp), intent(in) :: value(:), slope(2)
    real(dp) :: curvature(2)

    associate (rise => value(2) - value(1))
      curvature = [6*rise - 4*slope(1) - 2*slope(2), -6*rise + 2*slope(1) + 4*slope(2)]
    end associate
  end function cubic_curvature
end module gearsweep_peaks
