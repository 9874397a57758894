!> One mesh period of several speeds at once as in `gearsweep_hold`, but with the contact that each lane
!> has: the vectors carry what all lanes do, and a lane in which contact changes goes through that step
!> by itself.
module gearsweep_lanes
  use gearsweep_kinds, only: dp
  use gearsweep_contact, only: cross
  use gearsweep_gauss, only: collocate, lanes
  use gearsweep_hold, only: append, begins_zone, any_above, move, unscale
  use gearsweep_motion, only: oscillator_t, table_t
  use gearsweep_period, only: track_step
  use gearsweep_step, only: period_t, walk_t, note_contact
  implicit none
  private
  public :: run_lanes

  !> One member at the last end of a step; slopes over the step. `sense` is the overlap's sign while its
  !> contact stays as it is, `weight` 1 in contact and 0 apart.
  type :: member_t
    real(dp), dimension(lanes) :: weight = 0, sense = 1
    real(dp), dimension(lanes) :: gap = 0, gap_slope = 0, load = 0, load_slope = 0
  end type member_t

  !> All lanes at one phase.
  type :: flock_t
    real(dp), dimension(lanes) :: x, y, peak
    real(dp) :: total(lanes, 6)                  !< what the start and 1 have become
    logical :: open(lanes)                       !< lanes that are asked for; the others stay in contact
  end type flock_t

contains

  !> Follows the lanes `open` from `start` over one period of duration `duration` (s).
  pure subroutine run_lanes(osc, table, duration, start, open, out)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    real(dp), intent(in) :: duration(lanes), start(2, lanes)
    logical, intent(in) :: open(lanes)
    type(period_t), intent(out) :: out(lanes)
    type(flock_t) :: flock
    type(member_t) :: member(osc%members)
    type(walk_t) :: walk
    real(dp) :: map(lanes, 6), total(lanes, 6), x(lanes), y(lanes), top(lanes)
    logical :: changes(lanes)
    integer :: i, l

    allocate (walk%contact(osc%members), walk%stiffness(0:5, osc%pairs), walk%error(0:5, osc%members))
    flock%x = start(1, :)
    flock%y = start(2, :)
    flock%peak = 0
    flock%open = open
    flock%total = 0
    flock%total(:, 1) = 1
    flock%total(:, 4) = 1
    do i = 1, table%steps
      if (begins_zone(table, i)) call enter_zone(osc, table, i, flock, member, out)
      call mixed_maps(osc, duration, table%width(i), table%rate(:, :, i), table%error(:, :, i), member, map)
      call move(map, flock%x, flock%y, x, y)
      total = flock%total
      call append(map, total)
      call find_changes(osc, table, i, x, y, flock%open, member, changes)
      if (any(changes)) call cross_lanes(osc, table, i, duration, changes, flock, walk, member, x, y, total, out)
      call watch(table, i, 2, x, y, member, flock%peak, top)
      if (any_above(top, flock%peak)) call look_between(osc, table, i, duration, changes, top, x, y, walk, member, flock)
      flock%x = x
      flock%y = y
      flock%total = total
    end do
    do l = 1, lanes
      out(l)%peak = flock%peak(l)
      out(l)%state = [flock%x(l), flock%y(l)]
      out(l)%map(:, 1) = flock%total(l, 1:2)
      out(l)%map(:, 2) = flock%total(l, 3:4)
    end do
  end subroutine run_lanes

  !> Which members touch where the zone of step i begins.
  pure subroutine enter_zone(osc, table, i, flock, member, out)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: i
    type(flock_t), intent(inout) :: flock
    type(member_t), intent(out) :: member(osc%members)
    type(period_t), intent(inout) :: out(lanes)
    real(dp) :: top(lanes)
    logical :: contact(osc%members)
    integer :: j, l

    associate (pairs => table%pairs(i))
      do l = 1, lanes
        contact = .false.
        contact(:pairs) = .not. flock%open(l) .or. flock%x(l) > table%end_error(0, :pairs, 1, i)
        if (osc%has_backlash .and. flock%open(l)) contact(osc%members) = flock%x(l) < -osc%backlash
        call set_contact(osc, contact, l, member)
        if (.not. all(contact(:pairs)) .or. count(contact) > pairs) call note_contact(osc, contact, out(l))
      end do
    end associate
    do j = 1, osc%members
      member(j)%gap = flock%x - table%end_error(0, j, 1, i)
      member(j)%gap_slope = table%width(i)*(flock%y - table%end_error(1, j, 1, i))
    end do
    call watch(table, i, 1, flock%x, flock%y, member, flock%peak, top)
  end subroutine enter_zone

  pure subroutine set_contact(osc, contact, l, member)
    type(oscillator_t), intent(in) :: osc
    logical, intent(in) :: contact(osc%members)
    integer, intent(in) :: l
    type(member_t), intent(inout) :: member(osc%members)
    integer :: j

    do j = 1, osc%members
      member(j)%weight(l) = merge(1, 0, contact(j))
      member(j)%sense(l) = merge(1, -1, contact(j) .eqv. j <= osc%pairs)
    end do
  end subroutine set_contact

  !> One step for all lanes; rate and error: (member, node).
  pure subroutine mixed_maps(osc, duration, width, rate, error, member, map)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration(lanes), width
    real(dp), intent(in), dimension(osc%members, 3) :: rate, error
    type(member_t), intent(in) :: member(osc%members)
    real(dp), intent(out) :: map(lanes, 6)
    real(dp), dimension(lanes, 3) :: square, drag, push
    real(dp), dimension(lanes) :: time, stiff, pull
    integer :: j, k

    time = duration*width
    do k = 1, 3
      stiff = 0
      pull = osc%load*sum(1/osc%mass)
      do j = 1, osc%members
        stiff = stiff + member(j)%weight*rate(j, k)
        pull = pull + member(j)%weight*(rate(j, k)*error(j, k))
      end do
      square(:, k) = time**2*stiff
      drag(:, k) = 2*osc%damping_ratio*time*sqrt(stiff)
      push(:, k) = time**2*pull
    end do
    call collocate(lanes, square, drag, push, map)
    call unscale(width, map)
  end subroutine mixed_maps

  !> The open lanes in which a member may touch or leave during step i, which ends at x, y.
  pure subroutine find_changes(osc, table, i, x, y, open, member, changes)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: i
    real(dp), intent(in), dimension(lanes) :: x, y
    logical, intent(in) :: open(lanes)
    type(member_t), intent(in) :: member(osc%members)
    logical, intent(out) :: changes(lanes)
    real(dp) :: lowest(lanes), gap, fall, rise, error(0:1)
    integer :: j, l

    lowest = huge(lowest)
    do j = 1, osc%members
      if (j > table%pairs(i) .and. j <= osc%pairs) cycle
      error = table%end_error(:1, j, 2, i)
      do l = 1, lanes
        gap = member(j)%sense(l)*(x(l) - error(0))
        fall = max(0.0_dp, -member(j)%sense(l)*member(j)%gap_slope(l))
        rise = max(0.0_dp, member(j)%sense(l)*table%width(i)*(y(l) - error(1)))
        ! A convex curve stays above its tangents.
        lowest(l) = min(lowest(l), gap, max(0.0_dp, min(gap, member(j)%sense(l)*member(j)%gap(l))) &
                        - min(fall, rise, (fall + rise)/4))
      end do
    end do
    changes = open .and. lowest < 0
  end subroutine find_changes

  !> Takes lanes through step i one by one; `changes` keeps those in which contact did change.
  pure subroutine cross_lanes(osc, table, i, duration, changes, flock, walk, member, x, y, total, out)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: i
    real(dp), intent(in) :: duration(lanes)
    logical, intent(inout) :: changes(lanes)
    type(flock_t), intent(inout) :: flock
    type(walk_t), intent(inout) :: walk
    type(member_t), intent(inout) :: member(osc%members)
    real(dp), intent(inout) :: x(lanes), y(lanes), total(lanes, 6)
    type(period_t), intent(inout) :: out(lanes)
    integer :: l

    do l = 1, lanes
      if (.not. changes(l)) cycle
      call take_lane(osc, l, flock, member, walk)
      out(l)%peak = flock%peak(l)
      call cross(osc, table, i, duration(l), [x(l), y(l)], walk, out(l), changes(l))
      if (.not. changes(l)) cycle
      flock%peak(l) = out(l)%peak
      flock%open(l) = .not. out(l)%failed
      x(l) = walk%x
      y(l) = walk%y
      total(l, 1:2) = walk%map(:, 1)
      total(l, 3:4) = walk%map(:, 2)
      call set_contact(osc, walk%contact, l, member)
    end do
  end subroutine cross_lanes

  !> One lane by itself.
  pure subroutine take_lane(osc, l, flock, member, walk)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: l
    type(flock_t), intent(in) :: flock
    type(member_t), intent(in) :: member(osc%members)
    type(walk_t), intent(inout) :: walk
    integer :: j

    walk%x = flock%x(l)
    walk%y = flock%y(l)
    walk%map(:, 1) = flock%total(l, 1:2)
    walk%map(:, 2) = flock%total(l, 3:4)
    do j = 1, osc%members
      walk%contact(j) = member(j)%weight(l) > 0.5_dp
    end do
  end subroutine take_lane

  !> Moves the members to an end of step i, where the lanes are at x, y: raises `peak`, and tells in `top`
  !> what the loads stay below on the way: a concave one stays below its tangents.
  pure subroutine watch(table, i, end, x, y, member, peak, top)
    type(table_t), intent(in) :: table
    integer, intent(in) :: i, end
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
      do l = 1, lanes
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

  !> Peaks within step i of the lanes whose loads may have one there; a lane that has crossed was looked
  !> at on the way.
  pure subroutine look_between(osc, table, i, duration, crossed, top, x, y, walk, member, flock)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: i
    real(dp), intent(in), dimension(lanes) :: duration, top, x, y
    logical, intent(in) :: crossed(lanes)
    type(walk_t), intent(inout) :: walk
    type(member_t), intent(in) :: member(osc%members)
    type(flock_t), intent(inout) :: flock
    integer :: l

    do l = 1, lanes
      if (crossed(l) .or. top(l) <= flock%peak(l) .or. .not. flock%open(l)) cycle
      call take_lane(osc, l, flock, member, walk)
      call track_step(osc, table, i, duration(l), walk, [x(l), y(l)], flock%peak(l))
    end do
  end subroutine look_between
end module gearsweep_lanes
