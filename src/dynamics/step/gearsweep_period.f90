!> One mesh period of the motion, at several speeds side by side, with what each lane has in contact: Gauss
!> collocation in mesh phase, with steps that end at every break, a contact set that is frozen within a
!> step, and changes of contact located inside it.
module gearsweep_period
  use gearsweep_kinds, only: dp
  use gearsweep_contact, only: crossing_t, make_crossing, cross
  use gearsweep_gauss, only: lanes
  use gearsweep_maps, only: maps_t, begin_maps, need_map, move, chain, forget, hold_lanes, leave_held
  use gearsweep_motion, only: oscillator_t, table_t
  use gearsweep_peaks, only: top_t, tops_t, note_top, settle_tops
  use gearsweep_step, only: period_t, member_t, touches, all_pairs, set_contact, note_contact
  use gearsweep_trace, only: trace_t, record
  implicit none
  private
  public :: period_t, maps_t, begin_maps, run_period, hold_period, run_lanes, hold_lanes

  !> Above all profile errors.
  real(dp), parameter :: far = 1e30_dp

  !> Motions on their way through the period; at the begin and at the end of a step, which change places.
  type :: course_t
    integer :: from = 1, to = 2
    real(dp), dimension(lanes, 2) :: x, y
    real(dp) :: total(lanes, 4)                  !< derivative by the first state, columns one after the other
    real(dp) :: held(lanes)                      !< 0 where contact may change, else `far`
    type(member_t), allocatable :: member(:)
    integer :: touch(lanes)
    logical :: whole                             !< every pair between A and E touches in every lane
    logical :: along                             !< so it was in all steps, whose maps and their total are there
    logical :: changes(lanes)                    !< of contact within the step
    type(crossing_t), allocatable :: crossing
    real(dp) :: peak(lanes)
    type(tops_t) :: tops(lanes)
  end type course_t

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
    type(course_t) :: c
    integer :: i, l

    call begin(osc, start, open .and. [(l <= n, l=1, lanes)], maps, c)
    do i = 1, table%steps
      if (table%kind(i)%begins) call enter_zone(osc, table, i, n, c, out)
      if (table%kind(i)%widens) call begin_loads(table, i, c)
      call advance(osc, table, i, n, duration, peaks, maps, c, out, trace)
      if (all(out(:n)%failed)) return
      if (peaks) call watch(osc, table, i, n, duration, c)
      if (present(trace) .and. .not. c%changes(1)) call note(osc, table, i, c%x(1, [c%from, c%to]), c%touch(1), trace)
      if (modulo(i, 64) == 0) call forget(c%total)
      c%from = c%to
      c%to = 3 - c%from
    end do
    if (c%along) c%total = maps%total
    do l = 1, n
      call settle_tops(osc, table, duration(l), c%tops(l), c%peak(l))
      out(l)%peak = c%peak(l)
      out(l)%state = [c%x(l, c%from), c%y(l, c%from)]
      out(l)%map(:, 1) = c%total(l, :2)
      out(l)%map(:, 2) = c%total(l, 3:)
      out(l)%work = out(l)%work + table%steps
    end do
  end subroutine follow

  pure subroutine begin(osc, start, open, maps, c)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: start(2, lanes)
    logical, intent(in) :: open(lanes)
    type(maps_t), intent(in) :: maps
    type(course_t), intent(inout) :: c

    allocate (c%member(osc%members))
    c%x(:, c%from) = start(1, :)
    c%y(:, c%from) = start(2, :)
    c%total = 0
    c%total(:, 1) = 1
    c%total(:, 4) = 1
    c%held = merge(0.0_dp, far, open)
    c%along = maps%held
    c%peak = 0
    c%tops%count = 0
  end subroutine begin

  !> Which members touch where the zone of step i begins.
  pure subroutine enter_zone(osc, table, i, n, c, out)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: i, n
    type(course_t), intent(inout) :: c
    type(period_t), intent(inout) :: out(lanes)
    logical :: contact
    integer :: j, l

    c%touch = 0
    do j = 1, osc%members
      do l = 1, lanes
        if (j > osc%pairs) then
          contact = c%x(l, c%from) + c%held(l) < -osc%backlash
        else
          contact = j <= table%pairs(i)
          if (contact) contact = c%x(l, c%from) + c%held(l) > table%end_error(0, j, 1, i)
        end if
        call set_contact(osc, l, j, contact, c%touch(l), c%member(j))
      end do
    end do
    c%whole = all(c%touch == all_pairs(table, i))
    do l = 1, n
      if (c%touch(l) /= all_pairs(table, i)) call note_contact(osc, c%touch(l), out(l))
      out(l)%mark = out(l)%mark + c%x(l, c%from)
    end do
  end subroutine enter_zone

  !> The loads where step i begins, after a break or a step of another width.
  pure subroutine begin_loads(table, i, c)
    type(table_t), intent(in) :: table
    integer, intent(in) :: i
    type(course_t), intent(inout) :: c
    real(dp) :: bound(lanes)
    integer :: j

    do j = 1, table%pairs(i)
      call load_pair(table%width(i), table%end_stiffness(:1, j, 1, i), table%end_error(:1, j, 1, i), c%x(:, c%from), &
                     c%y(:, c%from), c%member(j), c%peak, bound)
    end do
  end subroutine begin_loads

  !> The state at the end of step i, changes of contact on the way, and the derivative so far.
  pure subroutine advance(osc, table, i, n, duration, peaks, maps, c, out, trace)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: i, n
    real(dp), intent(in) :: duration(lanes)
    logical, intent(in) :: peaks
    type(maps_t), intent(inout) :: maps
    type(course_t), intent(inout) :: c
    type(period_t), intent(inout) :: out(lanes)
    type(trace_t), intent(inout), optional :: trace
    real(dp) :: map(lanes, 6)
    integer :: place

    if (c%along .and. .not. c%whole) call leave_held(i - 1, maps, c%along, c%total)
    place = i
    if (.not. c%along) call need_map(osc, table, i, n, duration, c%touch, c%member, maps, place)
    call move(maps%map(:, :, place), c%x(:, c%from), c%y(:, c%from), c%x(:, c%to), c%y(:, c%to))
    c%changes = .false.
    if (.not. (c%whole .and. stays_above(table, i, c%x, c%y, c%held))) call find_changes(osc, table, i, c)
    if (any(c%changes)) then
      if (c%along) call leave_held(i - 1, maps, c%along, c%total)
      if (.not. allocated(c%crossing)) call make_crossing(osc, n, duration, c%crossing)
      map = maps%map(:, :, place)
      call cross(osc, table, i, c%x(:, c%from), c%y(:, c%from), c%changes, peaks, c%crossing, c%touch, c%member, &
                 c%x(:, c%to), c%y(:, c%to), map, c%peak, out, trace)
      where (out%failed) c%held = far
      c%whole = all(c%touch == all_pairs(table, i))
      call chain(map, c%total)
    else if (.not. c%along) then
      call chain(maps%map(:, :, place), c%total)
    end if
  end subroutine advance

  !> Do the lanes that are not `held` stay above the highest profile error during step i? A convex curve
  !> stays above its tangents.
  pure logical function stays_above(table, i, x, y, held)
    type(table_t), intent(in) :: table
    integer, intent(in) :: i
    real(dp), intent(in) :: x(lanes, 2), y(lanes, 2), held(lanes)
    real(dp) :: lowest(lanes)
    integer :: l

    do l = 1, lanes
      lowest(l) = min(x(l, 1), x(l, 2)) - (abs(y(l, 1)) + abs(y(l, 2)))*(table%width(i)/4) + held(l)
    end do
    stays_above = minval(lowest) > table%crest(i)
  end function stays_above

  !> The lanes in which a member may touch or leave during step i.
  pure subroutine find_changes(osc, table, i, c)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: i
    type(course_t), intent(inout) :: c
    real(dp) :: lowest(lanes)
    integer :: j

    lowest = huge(lowest)
    do j = 1, osc%members
      if (j > table%pairs(i) .and. j <= osc%pairs) cycle
      call lower(table%width(i), table%end_error(:1, j, :, i), c%x(:, c%from), c%y(:, c%from), c%x(:, c%to), c%y(:, c%to), &
                 c%member(j)%sense, lowest)
    end do
    c%changes = lowest < 0 .and. .not. c%held > 0
  end subroutine find_changes

  !> Lowers what overlaps, turned so that they are positive while contact stays as it is, stay above: a convex
  !> curve stays above its tangents.
  pure subroutine lower(width, error, x, y, x_next, y_next, sense, lowest)
    real(dp), intent(in) :: width, error(0:, :)
    real(dp), intent(in), dimension(lanes) :: x, y, x_next, y_next, sense
    real(dp), intent(inout) :: lowest(lanes)
    real(dp) :: before, after, fall, rise
    integer :: l

    do l = 1, lanes
      before = max(0.0_dp, sense(l)*(x(l) - error(0, 1)))
      after = sense(l)*(x_next(l) - error(0, 2))
      fall = max(0.0_dp, sense(l)*(error(1, 1) - y(l))*width)
      rise = max(0.0_dp, sense(l)*(y_next(l) - error(1, 2))*width)
      lowest(l) = min(lowest(l), min(before, after) - min(fall, rise, (fall + rise)/4))
    end do
  end subroutine lower

  !> The loads over step i: raises the peaks, and notes where a load may be larger on the way.
  pure subroutine watch(osc, table, i, n, duration, c)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: i, n
    real(dp), intent(in) :: duration(lanes)
    type(course_t), intent(inout) :: c
    real(dp) :: bound(lanes)
    integer :: ends(2), j, l

    ends = [c%from, c%to]
    do j = 1, table%pairs(i)
      call load_pair(table%width(i), table%end_stiffness(:1, j, 2, i), table%end_error(:1, j, 2, i), c%x(:, c%to), &
                     c%y(:, c%to), c%member(j), c%peak, bound)
      if (.not. any(bound > c%peak)) cycle
      do l = 1, n
        if (c%changes(l) .or. bound(l) <= c%peak(l)) cycle
        call note_top(osc, table, duration(l), top_t(bound(l), c%x(l, ends), c%y(l, ends), i, j, c%touch(l)), c%tops(l), &
                      c%peak(l))
      end do
    end do
  end subroutine watch

  !> Moves the load of a pair to x, y, where its stiffness and profile error have this value and derivative:
  !> raises `peak`, and tells what the load stays below on the way: a concave curve stays below its tangents.
  pure subroutine load_pair(width, stiffness, error, x, y, pair, peak, bound)
    real(dp), intent(in) :: width, stiffness(0:1), error(0:1)
    real(dp), intent(in), dimension(lanes) :: x, y
    type(member_t), intent(inout) :: pair
    real(dp), intent(inout) :: peak(lanes)
    real(dp), intent(out) :: bound(lanes)
    real(dp) :: gap, load, load_slope, rise, fall
    integer :: l

    do l = 1, lanes
      gap = x(l) - error(0)
      load = pair%weight(l)*stiffness(0)*gap
      load_slope = pair%weight(l)*width*(stiffness(1)*gap + stiffness(0)*(y(l) - error(1)))
      rise = max(0.0_dp, pair%load_slope(l))
      fall = max(0.0_dp, -load_slope)
      bound(l) = max(pair%load(l), load) + min(rise, fall, (rise + fall)/4)
      peak(l) = max(peak(l), load)
      pair%load(l) = load
      pair%load_slope(l) = load_slope
    end do
  end subroutine load_pair

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
