!> One mesh period of the motion, at several speeds side by side, with what each lane has in contact: Gauss
!> collocation in mesh phase, with steps that end at every break, a contact set that is frozen within a
!> step, and changes of contact located inside it. The lanes share a table, so its coefficients are read
!> once for all.
module gearsweep_period
  use gearsweep_kinds, only: dp
  use gearsweep_contact, only: crossing_t, make_crossing, cross
  use gearsweep_gauss, only: collocate, lanes
  use gearsweep_motion, only: oscillator_t, table_t
  use gearsweep_radau, only: collocate_stiffly
  use gearsweep_step, only: period_t, member_t, touching, set_contact, note_contact, begins_zone, track_pair
  use gearsweep_trace, only: trace_t, record
  implicit none
  private
  public :: period_t, run_period, run_lanes

  !> A start of which less than this is left tells nothing; on its way to 0 it
  !> would slow the processor down.
  real(dp), parameter :: forgotten = 1e-150_dp

contains

  !> Follows the motion from `start` over one period of duration `duration` (s).
  !> With `hold` every pair between A and E stays in contact: an affine map.
  pure subroutine run_period(osc, table, duration, start, hold, out, trace)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    real(dp), intent(in) :: duration, start(2)
    logical, intent(in) :: hold
    type(period_t), intent(out) :: out
    type(trace_t), intent(inout), optional :: trace
    type(period_t) :: outs(lanes)
    real(dp) :: starts(2, lanes)
    integer :: l

    starts(1, :) = start(1)
    starts(2, :) = start(2)
    call follow(osc, table, 1, [(duration, l=1, lanes)], starts, [(.not. hold, l=1, lanes)], outs, trace)
    out = outs(1)
  end subroutine run_period

  !> The same for all lanes at once. Those that are not `open` stay in contact.
  pure subroutine run_lanes(osc, table, duration, start, open, out)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    real(dp), intent(in) :: duration(lanes), start(2, lanes)
    logical, intent(in) :: open(lanes)
    type(period_t), intent(out) :: out(lanes)

    call follow(osc, table, lanes, duration, start, open, out)
  end subroutine run_lanes

  !> The first `n` lanes; the trace is that of the first.
  pure subroutine follow(osc, table, n, duration, start, open, out, trace)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: n
    real(dp), intent(in) :: duration(lanes), start(2, lanes)
    logical, intent(in) :: open(lanes)
    type(period_t), intent(out) :: out(lanes)
    type(trace_t), intent(inout), optional :: trace
    type(crossing_t) :: crossing
    type(member_t) :: member(osc%members)
    real(dp) :: map(lanes, 6), total(lanes, 4), state(lanes, 2), x(lanes), y(lanes), peak(lanes), top(lanes)
    logical, dimension(lanes) :: free, changes
    integer :: i, l

    call make_crossing(osc, n, duration, crossing)
    state = transpose(start)
    peak = 0
    free = open
    total = 0
    total(:, [1, 4]) = 1
    do i = 1, table%steps
      if (begins_zone(table, i)) call enter_zone(osc, table, i, n, state, free, crossing%contact, member, peak, out)
      call make_maps(osc, n, duration, table%width(i), table%rate(:, :, i), table%error(:, :, i), table%stiff(i), &
                     member, map)
      call move(n, map, state, x, y)
      call find_changes(osc, table, i, n, x, y, free, member, changes)
      if (any(changes(:n))) then
        call cross(osc, table, i, state, changes, crossing, member, x, y, map, peak, out, trace)
        if (all(out(:n)%failed)) return
        free = free .and. .not. out%failed
      end if
      call watch(table, i, 2, n, x, y, member, peak, top)
      do l = 1, n
        if (top(l) <= peak(l) .or. changes(l)) cycle
        call look_between(osc, table, i, l, duration(l), [state(l, 1), x(l)], [state(l, 2), y(l)], crossing%contact, &
                          member, peak(l))
      end do
      if (present(trace) .and. .not. changes(1)) &
        call note(table, i, [state(1, 1), x(1)], crossing%contact, member, trace)
      call chain(n, map, total)
      if (modulo(i, 64) == 0) call forget(total)
      state(:, 1) = x
      state(:, 2) = y
    end do
    do l = 1, n
      out(l)%peak = peak(l)
      out(l)%state = state(l, :)
      out(l)%map(:, 1) = total(l, :2)
      out(l)%map(:, 2) = total(l, 3:)
      out(l)%work = out(l)%work + table%steps
    end do
  end subroutine follow

  !> Which members touch where the zone of step i begins.
  pure subroutine enter_zone(osc, table, i, n, state, free, contact, member, peak, out)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: i, n
    real(dp), intent(in) :: state(lanes, 2)
    logical, intent(in) :: free(lanes)
    logical, intent(inout) :: contact(:)
    type(member_t), intent(out) :: member(osc%members)
    real(dp), intent(inout) :: peak(lanes)
    type(period_t), intent(inout) :: out(lanes)
    real(dp) :: top(lanes)
    integer :: j, l

    associate (pairs => table%pairs(i))
      do l = 1, n
        contact = .false.
        contact(:pairs) = .not. free(l) .or. state(l, 1) > table%end_error(0, :pairs, 1, i)
        if (osc%has_backlash .and. free(l)) contact(osc%members) = state(l, 1) < -osc%backlash
        do j = 1, osc%members
          call set_contact(osc, l, j, contact(j), member(j))
        end do
        if (.not. all(contact(:pairs)) .or. count(contact) > pairs) call note_contact(osc, contact, out(l))
        out(l)%mark = out(l)%mark + state(l, 1)
      end do
    end associate
    call watch(table, i, 1, n, state(:, 1), state(:, 2), member, peak, top)
  end subroutine enter_zone

  !> One step for all lanes: what x, y and 1 become, two elements each; rate and error: (member, node).
  pure subroutine make_maps(osc, n, duration, width, rate, error, stiff, member, map)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: n
    real(dp), intent(in) :: duration(lanes), width
    real(dp), intent(in), dimension(osc%members, 3) :: rate, error
    logical, intent(in) :: stiff
    type(member_t), intent(in) :: member(osc%members)
    real(dp), intent(out) :: map(lanes, 6)
    real(dp), dimension(lanes, 3) :: square, drag, push
    real(dp) :: time
    integer :: j, k, l

    square = 0
    push = osc%load*sum(1/osc%mass)
    do j = 1, osc%members
      do k = 1, 3
        do l = 1, n
          square(l, k) = square(l, k) + member(j)%weight(l)*rate(j, k)
          push(l, k) = push(l, k) + member(j)%weight(l)*(rate(j, k)*error(j, k))
        end do
      end do
    end do
    do k = 1, 3
      do l = 1, n
        time = duration(l)*width
        drag(l, k) = 2*osc%damping_ratio*time*sqrt(square(l, k))
        square(l, k) = time**2*square(l, k)
        push(l, k) = time**2*push(l, k)
      end do
    end do
    if (stiff) then
      call collocate_stiffly(n, square, drag, push, map)
    else
      call collocate(n, square, drag, push, map)
    end if
    ! Divided, as the error of 1/width would be the same in each of many steps.
    do l = 1, n
      map(l, 2) = map(l, 2)/width
      map(l, 3) = map(l, 3)*width
      map(l, 6) = map(l, 6)/width
    end do
  end subroutine make_maps

  pure subroutine move(n, map, state, x, y)
    integer, intent(in) :: n
    real(dp), intent(in) :: map(lanes, 6), state(lanes, 2)
    real(dp), intent(out), dimension(lanes) :: x, y
    integer :: l

    do l = 1, n
      x(l) = map(l, 1)*state(l, 1) + map(l, 3)*state(l, 2) + map(l, 5)
      y(l) = map(l, 2)*state(l, 1) + map(l, 4)*state(l, 2) + map(l, 6)
    end do
  end subroutine move

  !> Lets a step follow what was before.
  pure subroutine chain(n, map, total)
    integer, intent(in) :: n
    real(dp), intent(in) :: map(lanes, 6)
    real(dp), intent(inout) :: total(lanes, 4)
    real(dp) :: x, y
    integer :: k, l

    do k = 1, 3, 2
      do l = 1, n
        x = total(l, k)
        y = total(l, k + 1)
        total(l, k) = map(l, 1)*x + map(l, 3)*y
        total(l, k + 1) = map(l, 2)*x + map(l, 4)*y
      end do
    end do
  end subroutine chain

  pure subroutine forget(total)
    real(dp), intent(inout) :: total(lanes, 4)
    integer :: l

    do l = 1, lanes
      if (all(abs(total(l, :)) < forgotten)) total(l, :) = 0
    end do
  end subroutine forget

  !> The free lanes in which a member may touch or leave during step i, which ends at x, y.
  pure subroutine find_changes(osc, table, i, n, x, y, free, member, changes)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: i, n
    real(dp), intent(in), dimension(lanes) :: x, y
    logical, intent(in) :: free(lanes)
    type(member_t), intent(in) :: member(osc%members)
    logical, intent(out) :: changes(lanes)
    real(dp) :: lowest(lanes), gap, before, fall, rise, error(0:1), width
    integer :: j, l

    lowest = 0
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
      end do
    end do
    changes = free .and. lowest < 0
  end subroutine find_changes

  !> Moves the members to an end of step i, where the lanes are at x, y: raises `peak`, and tells in `top`
  !> what the loads stay below on the way: a concave one stays below its tangents.
  pure subroutine watch(table, i, end, n, x, y, member, peak, top)
    type(table_t), intent(in) :: table
    integer, intent(in) :: i, end, n
    real(dp), intent(in), dimension(lanes) :: x, y
    type(member_t), intent(inout) :: member(:)
    real(dp), intent(inout) :: peak(lanes)
    real(dp), intent(out) :: top(lanes)
    real(dp) :: stiffness(0:1), error(0:1), width, gap, gap_slope, load, load_slope, rise, fall
    integer :: j, l

    top = 0
    width = table%width(i)
    do j = 1, size(member)
      error = table%end_error(:1, j, end, i)
      stiffness = 0
      if (j <= table%pairs(i)) stiffness = table%end_stiffness(:1, j, end, i)
      do l = 1, n
        gap = x(l) - error(0)
        gap_slope = width*(y(l) - error(1))
        load = member(j)%weight(l)*stiffness(0)*gap
        load_slope = member(j)%weight(l)*(width*stiffness(1)*gap + stiffness(0)*gap_slope)
        rise = max(0.0_dp, member(j)%load_slope(l))
        fall = max(0.0_dp, -load_slope)
        top(l) = max(top(l), max(member(j)%load(l), load) + min(rise, fall, (rise + fall)/4))
        peak(l) = max(peak(l), load)
        member(j)%gap(l) = gap
        member(j)%gap_slope(l) = gap_slope
        member(j)%load(l) = load
        member(j)%load_slope(l) = load_slope
      end do
    end do
  end subroutine watch

  !> Peaks within step i of lane l, which has x, y at its ends.
  pure subroutine look_between(osc, table, i, l, duration, x, y, contact, member, peak)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: i, l
    real(dp), intent(in) :: duration, x(2), y(2)
    logical, intent(inout) :: contact(:)
    type(member_t), intent(in) :: member(osc%members)
    real(dp), intent(inout) :: peak
    integer :: j

    call touching(member, l, contact)
    do j = 1, table%pairs(i)
      if (contact(j)) call track_pair(osc, table, i, j, duration, contact, x, y, peak)
    end do
  end subroutine look_between

  pure subroutine note(table, i, x, contact, member, trace)
    type(table_t), intent(in) :: table
    integer, intent(in) :: i
    real(dp), intent(in) :: x(2)
    logical, intent(inout) :: contact(:)
    type(member_t), intent(in) :: member(:)
    type(trace_t), intent(inout) :: trace

    call touching(member, 1, contact)
    call record(trace, table%pairs(i), table%left(i) + [0.0_dp, table%width(i)], x, table%end_stiffness(0, :, :, i), &
                table%end_error(0, :, :, i), contact)
  end subroutine note
end module gearsweep_period
