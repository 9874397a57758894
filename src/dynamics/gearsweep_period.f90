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
    ! At the begin of a step and its end, which change places.
    real(dp) :: x(lanes, 2), y(lanes, 2), gap(lanes, osc%members, 2), slope(lanes, osc%members, 2)
    real(dp), dimension(lanes) :: held, lowest, peak
    real(dp) :: map(lanes, 6), total(lanes, 4)
    logical :: changes(lanes)
    integer :: touch(lanes), place, from, to, i, l

    from = 1
    to = 2
    x(:, from) = start(1, :)
    y(:, from) = start(2, :)
    held = merge(0, 1, open .and. [(l <= n, l=1, lanes)])
    changes = .false.
    peak = 0
    total = 0
    total(:, 1) = 1
    total(:, 4) = 1
    tops%count = 0
    do i = 1, table%steps
      if (begins_zone(table, i)) then
        call enter_zone(osc, table, i, n, x(:, from), held, touch, member, out)
        call begin_gaps(table, i, x(:, from), y(:, from), gap(:, :, from), slope(:, :, from))
        call begin_loads(table, i, gap(:, :, from), slope(:, :, from), member, peak)
      end if
      call need_map(osc, table, i, n, duration, touch, member, maps, place)
      call move(maps%map(:, :, place), x(:, from), y(:, from), x(:, to), y(:, to))
      call look(osc, table, i, x(:, to), y(:, to), gap(:, :, from), slope(:, :, from), held, member, &
                gap(:, :, to), slope(:, :, to), lowest)
      if (any(lowest < 0)) then
        changes = lowest < 0
        map = maps%map(:, :, place)
        if (.not. allocated(crossing)) call make_crossing(osc, n, duration, crossing)
        call cross(osc, table, i, x(:, from), y(:, from), changes, peaks, crossing, touch, member, x(:, to), y(:, to), &
                   map, peak, out, trace)
        if (all(out(:n)%failed)) return
        where (out%failed) held = 1
        call chain(map, total)
        call look(osc, table, i, x(:, to), y(:, to), gap(:, :, from), slope(:, :, from), held, member, &
                  gap(:, :, to), slope(:, :, to), lowest)
      else
        changes = .false.
        call chain(maps%map(:, :, place), total)
      end if
      if (peaks) call watch(osc, table, i, n, duration, x, y, from, to, gap(:, :, to), slope(:, :, to), changes, touch, &
                            member, tops, peak)
      if (present(trace) .and. .not. changes(1)) call note(osc, table, i, x(1, [from, to]), touch(1), trace)
      if (modulo(i, 64) == 0) call forget(total)
      from = to
      to = 3 - from
    end do
    do l = 1, n
      call settle_tops(osc, table, duration(l), tops(l), peak(l))
      out(l)%peak = peak(l)
      out(l)%state = [x(l, from), y(l, from)]
      out(l)%map(:, 1) = total(l, :2)
      out(l)%map(:, 2) = total(l, 3:)
      out(l)%work = out(l)%work + table%steps
    end do
  end subroutine follow

  !> Which members touch where the zone of step i begins.
  pure subroutine enter_zone(osc, table, i, n, x, held, touch, member, out)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: i, n
    real(dp), intent(in) :: x(lanes), held(lanes)
    integer, intent(inout) :: touch(lanes)
    type(member_t), intent(inout) :: member(osc%members)
    type(period_t), intent(inout) :: out(lanes)
    logical :: contact
    integer :: j, l

    touch = 0
    do j = 1, osc%members
      do l = 1, lanes
        if (held(l) > 0) then
          contact = j <= table%pairs(i)
        else if (j > osc%pairs) then
          contact = x(l) < -osc%backlash
        else
          contact = j <= table%pairs(i) .and. x(l) > table%end_error(0, j, 1, i)
        end if
        call set_contact(osc, l, j, contact, touch(l), member(j))
      end do
    end do
    do l = 1, n
      if (touch(l) /= all_pairs(table, i)) call note_contact(osc, touch(l), out(l))
      out(l)%mark = out(l)%mark + x(l)
    end do
  end subroutine enter_zone

  !> Overlap of each member, and its slope over the step, where the zone of step i begins.
  pure subroutine begin_gaps(table, i, x, y, gap, slope)
    type(table_t), intent(in) :: table
    integer, intent(in) :: i
    real(dp), intent(in), dimension(lanes) :: x, y
    real(dp), intent(out), dimension(lanes, table%members) :: gap, slope
    integer :: j

    do j = 1, table%members
      gap(:, j) = x - table%end_error(0, j, 1, i)
      slope(:, j) = (y - table%end_error(1, j, 1, i))*table%width(i)
    end do
  end subroutine begin_gaps

  !> The same where step i ends, at x, y; and what the overlaps, turned so that they are positive while
  !> contact stays as it is, stay above on the way. Below 0 contact may change; where it is `held`, it does not.
  pure subroutine look(osc, table, i, x, y, gap, slope, held, member, gap_next, slope_next, lowest)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: i
    real(dp), intent(in), dimension(lanes) :: x, y, held
    real(dp), intent(in), dimension(lanes, osc%members) :: gap, slope
    type(member_t), intent(in) :: member(osc%members)
    real(dp), intent(out), dimension(lanes, osc%members) :: gap_next, slope_next
    real(dp), intent(out) :: lowest(lanes)
    integer :: j

    lowest = huge(lowest)
    do j = 1, osc%members
      if (j > table%pairs(i) .and. j <= osc%pairs) cycle
      call look_at(table%width(i), table%end_error(:1, j, 2, i), x, y, member(j)%sense, gap(:, j), slope(:, j), &
                   gap_next(:, j), slope_next(:, j), lowest)
    end do
    where (held > 0) lowest = 0
  end subroutine look

  !> One member: a convex curve stays above its tangents.
  pure subroutine look_at(width, error, x, y, sense, gap, slope, gap_next, slope_next, lowest)
    real(dp), intent(in) :: width, error(0:1)
    real(dp), intent(in), dimension(lanes) :: x, y, sense, gap, slope
    real(dp), intent(out), dimension(lanes) :: gap_next, slope_next
    real(dp), intent(inout) :: lowest(lanes)
    real(dp) :: before, after, fall, rise
    integer :: l

    do l = 1, lanes
      gap_next(l) = x(l) - error(0)
      slope_next(l) = (y(l) - error(1))*width
      before = max(0.0_dp, sense(l)*gap(l))
      after = sense(l)*gap_next(l)
      fall = max(0.0_dp, -sense(l)*slope(l))
      rise = max(0.0_dp, sense(l)*slope_next(l))
      lowest(l) = min(lowest(l), min(before, after) - min(fall, rise, (fall + rise)/4))
    end do
  end subroutine look_at

  !> The loads where the zone of step i begins.
  pure subroutine begin_loads(table, i, gap, slope, member, peak)
    type(table_t), intent(in) :: table
    integer, intent(in) :: i
    real(dp), intent(in), dimension(lanes, table%members) :: gap, slope
    type(member_t), intent(inout) :: member(:)
    real(dp), intent(inout) :: peak(lanes)
    real(dp) :: bound(lanes)
    integer :: j

    do j = 1, table%pairs(i)
      call load_pair(table%width(i), table%end_stiffness(:1, j, 1, i), gap(:, j), slope(:, j), member(j), peak, bound)
    end do
  end subroutine begin_loads

  !> The loads over step i from x, y to where the gaps are given: raises `peak`, and notes
  !> where a load may be larger on the way.
  pure subroutine watch(osc, table, i, n, duration, x, y, from, to, gap, slope, changes, touch, member, tops, peak)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: i, n, from, to, touch(lanes)
    real(dp), intent(in) :: duration(lanes), x(lanes, 2), y(lanes, 2)
    real(dp), intent(in), dimension(lanes, osc%members) :: gap, slope
    logical, intent(in) :: changes(lanes)
    type(member_t), intent(inout) :: member(osc%members)
    type(tops_t), intent(inout) :: tops(lanes)
    real(dp), intent(inout) :: peak(lanes)
    real(dp) :: bound(lanes)
    integer :: j, l

    do j = 1, table%pairs(i)
      call load_pair(table%width(i), table%end_stiffness(:1, j, 2, i), gap(:, j), slope(:, j), member(j), peak, bound)
      if (.not. any(bound > peak)) cycle
      do l = 1, n
        if (changes(l) .or. bound(l) <= peak(l)) cycle
        call note_top(osc, table, duration(l), top_t(bound(l), x(l, [from, to]), y(l, [from, to]), i, j, touch(l)), tops(l), &
                      peak(l))
      end do
    end do
  end subroutine watch

  !> Moves the load of a pair to where its stiffness has this value and derivative: raises `peak`, and tells
  !> what the load stays below on the way: a concave curve stays below its tangents.
  pure subroutine load_pair(width, stiffness, gap, slope, pair, peak, bound)
    real(dp), intent(in) :: width, stiffness(0:1)
    real(dp), intent(in), dimension(lanes) :: gap, slope
    type(member_t), intent(inout) :: pair
    real(dp), intent(inout) :: peak(lanes)
    real(dp), intent(out) :: bound(lanes)
    real(dp) :: load, load_slope, rise, fall
    integer :: l

    do l = 1, lanes
      load = pair%weight(l)*stiffness(0)*gap(l)
      load_slope = pair%weight(l)*(width*stiffness(1)*gap(l) + stiffness(0)*slope(l))
      rise = max(0.0_dp, pair%load_slope(l))
      fall = max(0.0_dp, -load_slope)
      bound(l) = max(pair%load(l), load) + min(rise, fall, (rise + fall)/4)
      peak(l) = max(peak(l), load)
      pair%load(l) = load
      pair%load_slope(l) = load_slope
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
