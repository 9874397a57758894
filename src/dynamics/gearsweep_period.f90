!> One mesh period of the motion, at several speeds side by side, with what each lane has in contact: Gauss
!> collocation in mesh phase, with steps that end at every break, a contact set that is frozen within a
!> step, and changes of contact located inside it.
module gearsweep_period
  use gearsweep_kinds, only: dp
  use gearsweep_contact, only: crossing_t, make_crossing, cross
  use gearsweep_gauss, only: lanes
  use gearsweep_maps, only: maps_t, begin_maps, need_map, move, chain, hold_lanes
  use gearsweep_motion, only: oscillator_t, table_t
  use gearsweep_peaks, only: top_t, tops_t, note_top, settle_tops
  use gearsweep_step, only: period_t, member_t, touches, all_pairs, set_contact, note_contact, begins_zone
  use gearsweep_trace, only: trace_t, record
  implicit none
  private
  public :: period_t, maps_t, begin_maps, run_period, hold_period, run_lanes, hold_lanes

  !> A start of which less than this is left tells nothing; on its way to 0 it
  !> would slow the processor down.
  real(dp), parameter :: forgotten = 1e-150_dp

contains

  !> Follows the motion from `start` over one period of duration `duration` (s). `maps` begun for it.
  pure subroutine run_period(osc, table, duration, start, maps, out, trace)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    real(dp), intent(in) :: duration, start(2)
    type(maps_t), intent(inout) :: maps
    type(period_t), intent(out) :: out
    type(trace_t), intent(inout), optional :: trace
    type(period_t) :: outs(lanes)
    logical :: open(lanes)

    open = .true.
    call follow(osc, table, 1, spread(duration, 1, lanes), spread(start, 2, lanes), open, .true., maps, outs, trace)
    out = outs(1)
  end subroutine run_period

  !> The same with every pair between A and E in contact, an affine map; no peak.
  pure subroutine hold_period(osc, table, duration, start, maps, out)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    real(dp), intent(in) :: duration, start(2)
    type(maps_t), intent(inout) :: maps
    type(period_t), intent(out) :: out
    type(period_t) :: outs(lanes)

    call hold_lanes(osc, table, 1, spread(duration, 1, lanes), spread(start, 2, lanes), maps, outs)
    out = outs(1)
  end subroutine hold_period

  !> `run_period` for all lanes at once. Those that are not `open` stay in contact. The peaks are not
  !> wanted everywhere.
  pure subroutine run_lanes(osc, table, duration, start, open, peaks, maps, out)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    real(dp), intent(in) :: duration(lanes), start(2, lanes)
    logical, intent(in) :: open(lanes), peaks
    type(maps_t), intent(inout) :: maps
    type(period_t), intent(out) :: out(lanes)

    call follow(osc, table, lanes, duration, start, open, peaks, maps, out)
  end subroutine run_lanes

  !> The first `n` lanes; the trace is that of the first.
  pure subroutine follow(osc, table, n, duration, start, open, peaks, maps, out, trace)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: n
    real(dp), intent(in) :: duration(lanes), start(2, lanes)
    logical, intent(in) :: open(lanes), peaks
    type(maps_t), intent(inout) :: maps
    type(period_t), intent(out) :: out(lanes)
    type(trace_t), intent(inout), optional :: trace
    type(crossing_t), allocatable :: crossing
    type(member_t) :: member(osc%members)
    type(tops_t) :: tops(lanes)
    real(dp), dimension(lanes) :: x, y, x_next, y_next, peak
    real(dp) :: map(lanes, 6), total(lanes, 4)
    logical, dimension(lanes) :: free, changes
    integer :: touch(lanes), place, i, l

    x = start(1, :)
    y = start(2, :)
    free = open
    peak = 0
    total = 0
    total(:, 1) = 1
    total(:, 4) = 1
    tops%count = 0
    do i = 1, table%steps
      if (begins_zone(table, i)) call enter_zone(osc, table, i, n, x, y, free, touch, member, peak, out)
      call need_map(osc, table, i, n, duration, touch, member, maps, place)
      call move(n, maps%map(:, :, place), x, y, x_next, y_next)
      call find_changes(osc, table, i, n, x_next, y_next, free, member, changes)
      if (any(changes)) then
        if (.not. allocated(crossing)) call make_crossing(osc, n, duration, crossing)
        map = maps%map(:, :, place)
        call cross(osc, table, i, x, y, changes, peaks, crossing, touch, member, x_next, y_next, map, peak, out, trace)
        if (all(out(:n)%failed)) return
        free = free .and. .not. out%failed
        call chain(n, map, total)
      else
        call chain(n, maps%map(:, :, place), total)
      end if
      call note_gaps(osc, table, i, 2, n, x_next, y_next, member)
      if (peaks) call watch(osc, table, i, n, duration, x, y, x_next, y_next, changes, touch, member, tops, peak)
      if (present(trace) .and. .not. changes(1)) call note(osc, table, i, [x(1), x_next(1)], touch(1), trace)
      if (modulo(i, 64) == 0) call forget(total)
      x(:n) = x_next(:n)
      y(:n) = y_next(:n)
    end do
    do l = 1, n
      call settle_tops(osc, table, duration(l), tops(l), peak(l))
      out(l)%peak = peak(l)
      out(l)%state = [x(l), y(l)]
      out(l)%map(:, 1) = total(l, :2)
      out(l)%map(:, 2) = total(l, 3:)
      out(l)%work = out(l)%work + table%steps
    end do
  end subroutine follow

  !> Which members touch where the zone of step i begins.
  pure subroutine enter_zone(osc, table, i, n, x, y, free, touch, member, peak, out)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: i, n
    real(dp), intent(in), dimension(lanes) :: x, y
    logical, intent(in) :: free(lanes)
    integer, intent(inout) :: touch(lanes)
    type(member_t), intent(inout) :: member(osc%members)
    real(dp), intent(inout) :: peak(lanes)
    type(period_t), intent(inout) :: out(lanes)
    real(dp) :: bound(lanes), excess
    logical :: contact
    integer :: j, l

    touch = 0
    do j = 1, osc%members
      do l = 1, n
        contact = j <= table%pairs(i)
        if (contact .and. free(l)) contact = x(l) > table%end_error(0, j, 1, i)
        if (j > osc%pairs .and. free(l)) contact = x(l) < -osc%backlash
        call set_contact(osc, l, j, contact, touch(l), member(j))
      end do
    end do
    do l = 1, n
      if (touch(l) /= all_pairs(table, i)) call note_contact(osc, touch(l), out(l))
      out(l)%mark = out(l)%mark + x(l)
    end do
    call note_gaps(osc, table, i, 1, n, x, y, member)
    do j = 1, table%pairs(i)
      call load_pair(n, table%width(i), table%end_stiffness(:1, j, 1, i), member(j), peak, bound, excess)
    end do
  end subroutine enter_zone

  !> The free lanes in which a member may touch or leave during step i, which ends at x, y.
  pure subroutine find_changes(osc, table, i, n, x, y, free, member, changes)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: i, n
    real(dp), intent(in), dimension(lanes) :: x, y
    logical, intent(in) :: free(lanes)
    type(member_t), intent(in) :: member(osc%members)
    logical, intent(out) :: changes(lanes)
    real(dp) :: lowest(lanes), least, gap, before, fall, rise, error(0:1), width
    integer :: j, l

    lowest = 0
    least = 0
    width = table%width(i)
    do j = 1, osc%members
      if (j > table%pairs(i) .and. j <= osc%pairs) cycle
      error = table%end_error(:1, j, 2, i)
      do l = 1, n
        gap = member(j)%sense(l)*(x(l) - error(0))
        before = max(0.0_dp, member(j)%sense(l)*member(j)%gap(l))
        fall = max(0.0_dp, -member(j)%sense(l)*member(j)%gap_slope(l))
        rise = max(0.0_dp, member(j)%sense(l)*(width*(y(l) - error(1))))
        ! A convex curve stays above its tangents.
        lowest(l) = min(lowest(l), gap, max(0.0_dp, min(gap, before)) - min(fall, rise, (fall + rise)/4))
        least = min(least, lowest(l))
      end do
    end do
    changes = .false.
    if (least < 0) changes(:n) = free(:n) .and. lowest(:n) < 0
  end subroutine find_changes

  !> Moves the members to an end of step i, where the lanes are at x, y.
  pure subroutine note_gaps(osc, table, i, end, n, x, y, member)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: i, end, n
    real(dp), intent(in), dimension(lanes) :: x, y
    type(member_t), intent(inout) :: member(osc%members)
    real(dp) :: error(0:1), width
    integer :: j, l

    width = table%width(i)
    do j = 1, osc%members
      error = table%end_error(:1, j, end, i)
      do l = 1, n
        member(j)%gap(l) = x(l) - error(0)
        member(j)%gap_slope(l) = width*(y(l) - error(1))
      end do
    end do
  end subroutine note_gaps

  !> The loads over step i from x, y to x_next, y_next, where the gaps are known: raises `peak`, and notes
  !> where a load may be larger on the way.
  pure subroutine watch(osc, table, i, n, duration, x, y, x_next, y_next, changes, touch, member, tops, peak)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: i, n, touch(lanes)
    real(dp), intent(in), dimension(lanes) :: duration, x, y, x_next, y_next
    logical, intent(in) :: changes(lanes)
    type(member_t), intent(inout) :: member(osc%members)
    type(tops_t), intent(inout) :: tops(lanes)
    real(dp), intent(inout) :: peak(lanes)
    real(dp) :: bound(lanes), excess
    integer :: j, l

    do j = 1, table%pairs(i)
      call load_pair(n, table%width(i), table%end_stiffness(:1, j, 2, i), member(j), peak, bound, excess)
      if (.not. excess > 0) cycle
      do l = 1, n
        if (changes(l) .or. bound(l) <= peak(l)) cycle
        call note_top(osc, table, duration(l), top_t(bound(l), [x(l), x_next(l)], [y(l), y_next(l)], i, j, touch(l)), &
                      tops(l), peak(l))
      end do
    end do
  end subroutine watch

  !> Moves the load of a pair to where its gap is and its stiffness has this value and derivative: raises
  !> `peak`, and tells what the load stays below on the way, `excess` of them over the peaks at most.
  pure subroutine load_pair(n, width, stiffness, pair, peak, bound, excess)
    integer, intent(in) :: n
    real(dp), intent(in) :: width, stiffness(0:1)
    type(member_t), intent(inout) :: pair
    real(dp), intent(inout) :: peak(lanes)
    real(dp), intent(out) :: bound(lanes), excess
    real(dp) :: load, slope, rise, fall
    integer :: l

    excess = 0
    do l = 1, n
      load = pair%weight(l)*stiffness(0)*pair%gap(l)
      slope = pair%weight(l)*(width*stiffness(1)*pair%gap(l) + stiffness(0)*pair%gap_slope(l))
      rise = max(0.0_dp, pair%load_slope(l))
      fall = max(0.0_dp, -slope)
      ! A concave curve stays below its tangents.
      bound(l) = max(pair%load(l), load) + min(rise, fall, (rise + fall)/4)
      peak(l) = max(peak(l), load)
      excess = max(excess, bound(l) - peak(l))
      pair%load(l) = load
      pair%load_slope(l) = slope
    end do
  end subroutine load_pair

  pure subroutine forget(total)
    real(dp), intent(inout) :: total(lanes, 4)
    integer :: l

    do l = 1, lanes
      if (all(abs(total(l, :)) < forgotten)) total(l, :) = 0
    end do
  end subroutine forget

  pure subroutine note(osc, table, i, x, touch, trace)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: i, touch
    real(dp), intent(in) :: x(2)
    type(trace_t), intent(inout) :: trace
    integer :: j

    call record(trace, table%pairs(i), table%left(i) + [0.0_dp, table%width(i)], x, table%end_stiffness(0, :, :, i), &
                table%end_error(0, :, :, i), [(touches(touch, j), j=1, osc%members)])
  end subroutine note
end module gearsweep_period
