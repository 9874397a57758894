!> What each step of a period makes of the state: an affine map, for several speeds side by side in the
!> lanes of the processor's vectors. They share a table, so its coefficients are read once for all. A map
!> depends on nothing but what touches, so it is kept for the next motion through the same period.
module gearsweep_maps
  use gearsweep_kinds, only: dp
  use gearsweep_gauss, only: collocate, lanes
  use gearsweep_motion, only: oscillator_t, table_t
  use gearsweep_radau, only: collocate_stiffly
  use gearsweep_step, only: period_t, member_t, all_pairs
  implicit none
  private
  public :: maps_t, begin_maps, need_map, move, chain, forget, hold_lanes, leave_held

  !> Of periods with more than `most_kept` steps only the last map is kept.
  type :: maps_t
    logical :: kept = .false.
    real(dp), allocatable :: map(:, :, :)        !< what x, y and 1 become, two elements each: (lane, element, place)
    integer, allocatable :: touch(:, :)          !< what touches in it, (lane, place)
    logical :: held = .false.                    !< all pairs touch in all of them, then
    real(dp) :: total(lanes, 4) = 0              !< all of them one after the other
  end type maps_t
  integer, parameter :: most_kept = 2048, not_made = -1

  !> A start of which less than this is left tells nothing; on its way to 0 it
  !> would slow the processor down.
  real(dp), parameter :: forgotten = 1e-150_dp

contains

  !> For a table, and durations that stay from now on; the room for them stays for the next ones.
  pure subroutine begin_maps(table, maps)
    type(table_t), intent(in) :: table
    type(maps_t), intent(inout) :: maps
    integer :: places

    maps%kept = table%steps <= most_kept
    places = merge(table%steps, 1, maps%kept)
    if (allocated(maps%touch)) then
      if (size(maps%touch, 2) < places) deallocate (maps%touch, maps%map)
    end if
    if (.not. allocated(maps%touch)) then
      allocate (maps%touch(lanes, places), maps%map(lanes, 6, places))
      ! Lanes that nobody uses go along, at rest.
      maps%map = 0
    end if
    maps%touch(:, :places) = not_made
    maps%held = .false.
  end subroutine begin_maps

  !> Where the map of step i is for the first `n` lanes with these members in contact.
  pure subroutine need_map(osc, table, i, n, duration, touch, member, maps, place)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: i, n, touch(lanes)
    real(dp), intent(in) :: duration(lanes)
    type(member_t), intent(in) :: member(osc%members)
    type(maps_t), intent(inout) :: maps
    integer, intent(out) :: place
    integer :: full(lanes)

    place = merge(i, 1, maps%kept)
    if (maps%kept .and. are_same(touch, maps%touch(:, place))) return
    call note_touch(all_pairs(table, i), full)
    if (are_same(touch, full)) then
      call make_map(osc, table, i, n, duration, maps%map(:, :, place))
    else
      call make_maps(osc, table, i, n, duration, member, maps%map(:, :, place))
    end if
    maps%touch(:, place) = touch
  end subroutine need_map

  pure subroutine note_touch(all, touch)
    integer, intent(in) :: all
    integer, intent(out) :: touch(lanes)

    touch = all
  end subroutine note_touch

  pure logical function are_same(a, b)
    integer, intent(in), dimension(lanes) :: a, b
    integer :: other, l

    other = 0
    do l = 1, lanes
      other = ior(other, ieor(a(l), b(l)))
    end do
    are_same = other == 0
  end function are_same

  !> All pairs in contact: w^2, w and sum of k e at the nodes are those of the table.
  pure subroutine make_map(osc, table, i, n, duration, map)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: i, n
    real(dp), intent(in) :: duration(lanes)
    real(dp), intent(out) :: map(lanes, 6)
    real(dp), dimension(lanes, 3) :: square, drag, push
    real(dp), dimension(3) :: squares, drags, pushes
    real(dp) :: time
    integer :: l

    squares = table%square(:, i)
    drags = 2*osc%damping_ratio*table%omega(:, i)
    pushes = table%push(:, i) + osc%load*sum(1/osc%mass)
    do l = 1, n
      time = duration(l)*table%width(i)
      drag(l, 1) = drags(1)*time
      drag(l, 2) = drags(2)*time
      drag(l, 3) = drags(3)*time
      time = time**2
      square(l, 1) = squares(1)*time
      square(l, 2) = squares(2)*time
      square(l, 3) = squares(3)*time
      push(l, 1) = pushes(1)*time
      push(l, 2) = pushes(2)*time
      push(l, 3) = pushes(3)*time
    end do
    call finish_map(n, table%width(i), table%kind(i)%stiff, square, drag, push, map)
  end subroutine make_map

  !> Each lane with its own members in contact.
  pure subroutine make_maps(osc, table, i, n, duration, member, map)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: i, n
    real(dp), intent(in) :: duration(lanes)
    type(member_t), intent(in) :: member(osc%members)
    real(dp), intent(out) :: map(lanes, 6)
    real(dp), dimension(lanes, 3) :: square, drag, push
    real(dp) :: time, rate, pull
    integer :: j, k, l

    square = 0
    push = 0
    do j = 1, osc%members
      if (j > table%pairs(i) .and. j <= osc%pairs) cycle
      do k = 1, 3
        rate = table%rate(j, k, i)
        pull = rate*table%error(j, k, i)
        do l = 1, n
          square(l, k) = square(l, k) + member(j)%weight(l)*rate
          push(l, k) = push(l, k) + member(j)%weight(l)*pull
        end do
      end do
    end do
    do k = 1, 3
      do l = 1, n
        time = duration(l)*table%width(i)
        drag(l, k) = 2*osc%damping_ratio*sqrt(square(l, k))*time
        time = time**2
        square(l, k) = square(l, k)*time
        push(l, k) = (push(l, k) + osc%load*sum(1/osc%mass))*time
      end do
    end do
    call finish_map(n, table%width(i), table%kind(i)%stiff, square, drag, push, map)
  end subroutine make_maps

  !> From displacements over the step to derivatives over the phase. Divided, as the error of 1/width
  !> would be the same in each of many steps.
  pure subroutine finish_map(n, width, stiff, square, drag, push, map)
    integer, intent(in) :: n
    real(dp), intent(in) :: width
    logical, intent(in) :: stiff
    real(dp), intent(in), dimension(lanes, 3) :: square, drag, push
    real(dp), intent(out) :: map(lanes, 6)
    integer :: l

    if (stiff) then
      call collocate_stiffly(n, square, drag, push, map)
    else
      call collocate(n, square, drag, push, map)
    end if
    do l = 1, n
      map(l, 2) = map(l, 2)/width
      map(l, 3) = map(l, 3)*width
      map(l, 6) = map(l, 6)/width
    end do
  end subroutine finish_map

  !> The state after a step.
  pure subroutine move(map, x, y, x_next, y_next)
    real(dp), intent(in) :: map(lanes, 6)
    real(dp), intent(in), dimension(lanes) :: x, y
    real(dp), intent(out), dimension(lanes) :: x_next, y_next
    integer :: l

    do l = 1, lanes
      x_next(l) = map(l, 1)*x(l) + map(l, 3)*y(l) + map(l, 5)
      y_next(l) = map(l, 2)*x(l) + map(l, 4)*y(l) + map(l, 6)
    end do
  end subroutine move

  !> Lets a step follow what was before: derivative by the first state, columns one after the other.
  pure subroutine chain(map, total)
    real(dp), intent(in) :: map(lanes, 6)
    real(dp), intent(inout) :: total(lanes, 4)
    real(dp) :: x, y
    integer :: k, l

    do k = 1, 3, 2
      do l = 1, lanes
        x = total(l, k)
        y = total(l, k + 1)
        total(l, k) = map(l, 1)*x + map(l, 3)*y
        total(l, k + 1) = map(l, 2)*x + map(l, 4)*y
      end do
    end do
  end subroutine chain

  !> From `held` maps to others after so many steps: what these steps make one after the other.
  pure subroutine leave_held(steps, maps, along, total)
    integer, intent(in) :: steps
    type(maps_t), intent(inout) :: maps
    logical, intent(inout) :: along
    real(dp), intent(inout) :: total(lanes, 4)
    integer :: i

    do i = 1, steps
      call chain(maps%map(:, :, i), total)
      if (modulo(i, 64) == 0) call forget(total)
    end do
    maps%held = .false.
    along = .false.
  end subroutine leave_held

  pure subroutine forget(total)
    real(dp), intent(inout) :: total(lanes, 4)
    integer :: l

    do l = 1, lanes
      if (all(abs(total(l, :)) < forgotten)) total(l, :) = 0
    end do
  end subroutine forget

  !> One period of the first `n` lanes from `start`, in which every pair between A and E stays in contact,
  !> pull or push: the state after it and its derivative by `start`.
  pure subroutine hold_lanes(osc, table, n, duration, start, maps, out)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: n
    real(dp), intent(in) :: duration(lanes), start(2, lanes)
    type(maps_t), intent(inout) :: maps
    type(period_t), intent(inout) :: out(lanes)
    real(dp) :: total(lanes, 4), x(lanes, 2), y(lanes, 2)
    integer :: place, from, to, i, l

    from = 1
    to = 2
    x(:, from) = start(1, :)
    y(:, from) = start(2, :)
    total = 0
    total(:, 1) = 1
    total(:, 4) = 1
    do i = 1, table%steps
      place = merge(i, 1, maps%kept)
      call make_map(osc, table, i, n, duration, maps%map(:, :, place))
      call note_touch(all_pairs(table, i), maps%touch(:, place))
      call chain(maps%map(:, :, place), total)
      if (modulo(i, 64) == 0) call forget(total)
      call move(maps%map(:, :, place), x(:, from), y(:, from), x(:, to), y(:, to))
      from = to
      to = 3 - from
    end do
    maps%held = maps%kept
    maps%total = total
    do l = 1, n
      out(l)%map(:, 1) = total(l, :2)
      out(l)%map(:, 2) = total(l, 3:)
      out(l)%state = [x(l, from), y(l, from)]
    end do
  end subroutine hold_lanes
end module gearsweep_maps
