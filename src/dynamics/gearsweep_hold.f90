!> One mesh period of several speeds at once, side by side in the lanes of the processor's vectors: they
!> share a table, so its coefficients are read once for all. Every pair between A and E stays in contact
!> here; a lane whose motion would not let it is marked, and is a matter for `gearsweep_period`.
module gearsweep_hold
  use gearsweep_kinds, only: dp
  use gearsweep_gauss, only: collocate, lanes
  use gearsweep_motion, only: oscillator_t, table_t
  use gearsweep_radau, only: collocate_stiffly
  use gearsweep_step, only: period_t, begins_zone, track_pair
  implicit none
  private
  public :: lane_work_t, hold_maps, hold_motion

  !> The steps of one period: what each makes of x, y and 1 (two elements each), and the states between.
  type :: lane_work_t
    real(dp), allocatable :: map(:, :, :)        !< (lane, element, step)
    real(dp), allocatable :: x(:, :), y(:, :)    !< (lane, 0 to step)
  end type lane_work_t

  !> Steps within which a load has a maximum that may be the largest; looked at in the end.
  integer, parameter :: most_tops = 16
  type :: tops_t
    integer :: count = 0
    integer :: step(most_tops), pair(most_tops)
    real(dp) :: bound(most_tops)                 !< the load stays below
  end type tops_t

  !> One pair at the last end of a step; slopes over the step. Where a zone begins, it begins anew.
  type :: side_t
    real(dp), dimension(lanes) :: gap = 1, gap_slope = 0, load = 0, load_slope = 0
  end type side_t

contains

  !> Room for `steps` steps, which stays for the next period.
  pure subroutine make_room(steps, work)
    integer, intent(in) :: steps
    type(lane_work_t), intent(inout) :: work

    if (allocated(work%map)) then
      if (size(work%map, 3) >= steps) return
      deallocate (work%map, work%x, work%y)
    end if
    allocate (work%map(lanes, 6, steps), work%x(lanes, 0:steps), work%y(lanes, 0:steps))
  end subroutine make_room

  !> The maps of all steps into `work`, and that of the period: state after it when it begins at zero,
  !> and the derivative by the initial state.
  pure subroutine hold_maps(osc, table, duration, work, out)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    real(dp), intent(in) :: duration(lanes)
    type(lane_work_t), intent(inout) :: work
    type(period_t), intent(inout) :: out(lanes)
    real(dp) :: total(lanes, 6)
    integer :: i, l

    call make_room(table%steps, work)
    total = 0
    total(:, 1) = 1
    total(:, 4) = 1
    do i = 1, table%steps
      call step_maps(osc, duration, table%width(i), table%square(:, i), table%omega(:, i), table%push(:, i), &
                     table%stiff(i), work%map(:, :, i))
      call append(work%map(:, :, i), total)
    end do
    do l = 1, lanes
      out(l)%map(:, 1) = total(l, 1:2)
      out(l)%map(:, 2) = total(l, 3:4)
      out(l)%state = total(l, 5:)
    end do
  end subroutine hold_maps

  !> One step for all lanes.
  pure subroutine step_maps(osc, duration, width, square_sum, omega_sum, push_sum, stiff, map)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration(lanes), width, square_sum(3), omega_sum(3), push_sum(3)
    logical, intent(in) :: stiff
    real(dp), intent(out) :: map(lanes, 6)
    real(dp), dimension(lanes, 3) :: square, drag, push
    real(dp) :: time(lanes), load
    integer :: k

    load = osc%load*sum(1/osc%mass)
    time = duration*width
    do k = 1, 3
      square(:, k) = time**2*square_sum(k)
      drag(:, k) = 2*osc%damping_ratio*time*omega_sum(k)
      push(:, k) = time**2*(push_sum(k) + load)
    end do
    if (stiff) then
      call collocate_stiffly(lanes, square, drag, push, map)
    else
      call collocate(lanes, square, drag, push, map)
    end if
    call unscale(width, map)
  end subroutine step_maps

  !> From displacements over the step to derivatives over the phase.
  pure subroutine unscale(width, map)
    real(dp), intent(in) :: width
    real(dp), intent(inout) :: map(lanes, 6)

    map(:, 2) = map(:, 2)*(1/width)
    map(:, 3) = map(:, 3)*width
    map(:, 6) = map(:, 6)*(1/width)
  end subroutine unscale

  !> Lets a step follow what was before.
  pure subroutine append(map, total)
    real(dp), intent(in) :: map(lanes, 6)
    real(dp), intent(inout) :: total(lanes, 6)
    real(dp) :: x, y
    integer :: k, l

    do k = 1, 5, 2
      do l = 1, lanes
        x = total(l, k)
        y = total(l, k + 1)
        total(l, k) = map(l, 1)*x + map(l, 3)*y
        total(l, k + 1) = map(l, 2)*x + map(l, 4)*y
      end do
    end do
    total(:, 5:) = total(:, 5:) + map(:, 5:)
  end subroutine append

  !> The motion from `start` by the maps of `hold_maps`: final state, largest load on one pair, and
  !> whether a pair might part or the coast sides touch (`partial`).
  pure subroutine hold_motion(osc, table, duration, start, work, out)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    real(dp), intent(in) :: duration(lanes), start(2, lanes)
    type(lane_work_t), intent(inout) :: work
    type(period_t), intent(inout) :: out(lanes)
    type(side_t) :: side(osc%members)
    type(tops_t) :: tops(lanes)
    logical :: contact(osc%members)
    real(dp), dimension(lanes) :: lowest, peak, top, mark
    integer :: i, j, l

    work%x(:, 0) = start(1, :)
    work%y(:, 0) = start(2, :)
    lowest = huge(lowest)
    peak = 0
    mark = 0
    do i = 1, table%steps
      call move(work%map(:, :, i), work%x(:, i - 1), work%y(:, i - 1), work%x(:, i), work%y(:, i))
      associate (width => table%width(i), pairs => table%pairs(i))
        if (begins_zone(table, i)) then
          side = side_t()
          mark = mark + work%x(:, i - 1)
          do j = 1, pairs
            call look(width, table%end_stiffness(:, j, 1, i), table%end_error(:, j, 1, i), &
                      work%x(:, i - 1), work%y(:, i - 1), side(j), lowest, peak, top)
          end do
        end if
        do j = 1, pairs
          call look(width, table%end_stiffness(:, j, 2, i), table%end_error(:, j, 2, i), &
                    work%x(:, i), work%y(:, i), side(j), lowest, peak, top)
          if (any_above(top, peak)) call note_tops(i, j, top, peak, tops)
        end do
      end associate
    end do
    if (osc%has_backlash) lowest = min(lowest, minval(work%x(:, :table%steps), 2) + osc%backlash)
    do l = 1, lanes
      out(l)%partial = lowest(l) < 0
      out(l)%state = [work%x(l, table%steps), work%y(l, table%steps)]
      out(l)%peak = peak(l)
      out(l)%mark = mark(l)
      call settle_tops(osc, table, l, duration(l), work, contact, tops(l), out(l))
    end do
  end subroutine hold_motion

  pure subroutine move(map, x, y, x_next, y_next)
    real(dp), intent(in) :: map(lanes, 6)
    real(dp), intent(in), dimension(lanes) :: x, y
    real(dp), intent(out), dimension(lanes) :: x_next, y_next

    x_next = map(:, 1)*x + map(:, 3)*y + map(:, 5)
    y_next = map(:, 2)*x + map(:, 4)*y + map(:, 6)
  end subroutine move

  !> Moves a pair from the last end of a step to the one at x, y: raises `peak`, lowers `lowest` to what
  !> the overlap stays above between them, and tells in `top` what the load stays below: a convex curve
  !> stays above its tangents, a concave one below. Stiffness and error: value and derivatives.
  pure subroutine look(width, stiffness, error, x, y, side, lowest, peak, top)
    real(dp), intent(in) :: width, stiffness(0:2), error(0:2)
    real(dp), intent(in), dimension(lanes) :: x, y
    type(side_t), intent(inout) :: side
    real(dp), intent(inout), dimension(lanes) :: lowest, peak
    real(dp), intent(out) :: top(lanes)
    real(dp) :: gap, gap_slope, load, load_slope, fall, rise
    integer :: l

    do l = 1, lanes
      gap = x(l) - error(0)
      gap_slope = width*(y(l) - error(1))
      load = stiffness(0)*gap
      load_slope = width*stiffness(1)*gap + stiffness(0)*gap_slope
      fall = max(0.0_dp, -side%gap_slope(l))
      rise = max(0.0_dp, gap_slope)
      lowest(l) = min(lowest(l), min(side%gap(l), gap) - min(fall, rise, (fall + rise)/4))
      rise = max(0.0_dp, side%load_slope(l))
      fall = max(0.0_dp, -load_slope)
      top(l) = max(side%load(l), load) + min(rise, fall, (rise + fall)/4)
      peak(l) = max(peak(l), load)
      side%gap(l) = gap
      side%gap_slope(l) = gap_slope
      side%load(l) = load
      side%load_slope(l) = load_slope
    end do
  end subroutine look

  pure logical function any_above(top, peak)
    real(dp), intent(in), dimension(lanes) :: top, peak
    real(dp) :: most
    integer :: l

    most = 0
    do l = 1, lanes
      most = max(most, top(l) - peak(l))
    end do
    any_above = most > 0
  end function any_above

  !> Notes the lanes whose load of pair j may have its maximum within step i; too many are told by the
  !> count, and what the peak has passed meanwhile is forgotten first.
  pure subroutine note_tops(i, j, bound, peak, tops)
    integer, intent(in) :: i, j
    real(dp), intent(in), dimension(lanes) :: bound, peak
    type(tops_t), intent(inout) :: tops(lanes)
    integer :: l, k, kept

    do l = 1, lanes
      if (bound(l) <= peak(l) .or. tops(l)%count > most_tops) cycle
      if (tops(l)%count == most_tops) then
        kept = 0
        do k = 1, most_tops
          if (tops(l)%bound(k) <= peak(l)) cycle
          kept = kept + 1
          tops(l)%bound(kept) = tops(l)%bound(k)
          tops(l)%step(kept) = tops(l)%step(k)
          tops(l)%pair(kept) = tops(l)%pair(k)
        end do
        tops(l)%count = kept
      end if
      tops(l)%count = tops(l)%count + 1
      if (tops(l)%count > most_tops) cycle
      tops(l)%bound(tops(l)%count) = bound(l)
      tops(l)%step(tops(l)%count) = i
      tops(l)%pair(tops(l)%count) = j
    end do
  end subroutine note_tops

  !> Raises the peak by the maxima between steps; the highest bound first, which spares most others.
  pure subroutine settle_tops(osc, table, l, duration, work, contact, tops, out)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: l
    real(dp), intent(in) :: duration
    type(lane_work_t), intent(in) :: work
    logical, intent(inout) :: contact(:)
    type(tops_t), intent(inout) :: tops
    type(period_t), intent(inout) :: out
    integer :: k, i

    if (out%partial) return
    if (tops%count > most_tops) then
      out%partial = .true.
      return
    end if
    do while (tops%count > 0)
      k = maxloc(tops%bound(:tops%count), 1)
      if (tops%bound(k) <= out%peak) return
      i = tops%step(k)
      contact = .false.
      contact(:table%pairs(i)) = .true.
      call track_pair(osc, table, i, tops%pair(k), duration, contact, [work%x(l, i - 1), work%x(l, i)], &
                      [work%y(l, i - 1), work%y(l, i)], out%peak)
      tops%bound(k) = 0
    end do
  end subroutine settle_tops
end module gearsweep_hold
