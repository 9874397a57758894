!> What each step of a period makes of the state: an affine map, for several speeds side by side in the
!> lanes of the processor's vectors. They share a table, so its coefficients are read once for all. A map
!> depends on nothing but what touches, so it is kept for the next motion through the same period.
module gearsweep_maps
  use gearsweep_kinds, only: dp
  use gearsweep_gauss, only: collocate, lanes
  use gearsweep_motion, only: oscillator_t, table_t
  use gearsweep_step, only: period_t, member_t, all_pairs
  implicit none
  private
  public :: maps_t, begin_maps, need_map, move, chain, hold_lanes

  !> Of periods with more than `most_kept` steps only the last map is kept.
  type :: maps_t
    logical :: kept = .false.
    real(dp), allocatable :: map(:, :, :)        !< what x, y and 1 become, two elements each: (lane, element, place)
    integer, allocatable :: touch(:, :)          !< what touches in it, (lane, place)
  end type maps_t
  integer, parameter :: most_kept = 2048, not_made = -1

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
    if (.not. allocated(maps%touch)) allocate (maps%touch(lanes, places), maps%map(lanes, 6, places))
    maps%touch(:, :places) = not_made
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
    integer :: other, full, l

    place = merge(i, 1, maps%kept)
    other = merge(0, 1, maps%kept)
    do l = 1, n
      other = ior(other, ieor(touch(l), maps%touch(l, place)))
    end do
    if (other == 0) return
    full = all_pairs(table, i)
    other = 0
    do l = 1, n
      other = ior(other, ieor(touch(l), full))
    end do
    if (other == 0) then
      call make_map(osc, n, duration, table%width(i), table%square(:, i), table%omega(:, i), table%push(:, i), &
                    maps%map(:, :, place))
    else
      call make_maps(osc, n, duration, table%width(i), table%rate(:, :, i), table%error(:, :, i), member, &
                     maps%map(:, :, place))
    end if
    maps%touch(:n, place) = touch(:n)
  end subroutine need_map

  !> All pairs in contact: w^2, w and sum of k e at the nodes are those of the table.
  pure subroutine make_map(osc, n, duration, width, square_sum, omega_sum, push_sum, map)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: n
    real(dp), intent(in) :: duration(lanes), width, square_sum(3), omega_sum(3), push_sum(3)
    real(dp), intent(out) :: map(lanes, 6)
    real(dp), dimension(lanes, 3) :: square, drag, push
    real(dp) :: time, pushes, drags
    integer :: k, l

    do k = 1, 3
      pushes = push_sum(k) + osc%load*sum(1/osc%mass)
      drags = 2*osc%damping_ratio*omega_sum(k)
      do l = 1, n
        time = duration(l)*width
        square(l, k) = time**2*square_sum(k)
        drag(l, k) = drags*time
        push(l, k) = time**2*pushes
      end do
    end do
    call finish_map(n, width, square, drag, push, map)
  end subroutine make_map

  !> Each lane with its own members in contact; rate and error: (member, node).
  pure subroutine make_maps(osc, n, duration, width, rate, error, member, map)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: n
    real(dp), intent(in) :: duration(lanes), width
    real(dp), intent(in), dimension(osc%members, 3) :: rate, error
    type(member_t), intent(in) :: member(osc%members)
    real(dp), intent(out) :: map(lanes, 6)
    real(dp), dimension(lanes, 3) :: square, drag, push
    real(dp) :: time
    integer :: j, k, l

    square = 0
    push = 0
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
        drag(l, k) = 2*osc%damping_ratio*sqrt(square(l, k))*time
        square(l, k) = time**2*square(l, k)
        push(l, k) = time**2*(push(l, k) + osc%load*sum(1/osc%mass))
      end do
    end do
    call finish_map(n, width, square, drag, push, map)
  end subroutine make_maps

  !> From displacements over the step to derivatives over the phase. Divided, as the error of 1/width
  !> would be the same in each of many steps.
  pure subroutine finish_map(n, width, square, drag, push, map)
    integer, intent(in) :: n
    real(dp), intent(in) :: width
    real(dp), intent(in), dimension(lanes, 3) :: square, drag, push
    real(dp), intent(out) :: map(lanes, 6)
    integer :: l

    call collocate(n, square, drag, push, map)
    do l = 1, n
      map(l, 2) = map(l, 2)/width
      map(l, 3) = map(l, 3)*width
      map(l, 6) = map(l, 6)/width
    end do
  end subroutine finish_map

  !> The state after a step.
  pure subroutine move(n, map, x, y, x_next, y_next)
    integer, intent(in) :: n
    real(dp), intent(in) :: map(lanes, 6)
    real(dp), intent(in), dimension(lanes) :: x, y
    real(dp), intent(out), dimension(lanes) :: x_next, y_next
    integer :: l

    do l = 1, n
      x_next(l) = map(l, 1)*x(l) + map(l, 3)*y(l) + map(l, 5)
      y_next(l) = map(l, 2)*x(l) + map(l, 4)*y(l) + map(l, 6)
    end do
  end subroutine move

  !> Lets a step follow what was before: derivative by the first state, columns one after the other.
  pure subroutine chain(n, map, total)
    integer, intent(in) :: n
    real(dp), intent(in) :: map(lanes, 6)
    real(dp), intent(inout) :: total(lanes, 4)
    real(dp) :: x, y
    integer :: l

    do l = 1, n
      x = total(l, 1)
      y = total(l, 2)
      total(l, 1) = map(l, 1)*x + map(l, 3)*y
      total(l, 2) = map(l, 2)*x + map(l, 4)*y
      x = total(l, 3)
      y = total(l, 4)
      total(l, 3) = map(l, 1)*x + map(l, 3)*y
      total(l, 4) = map(l, 2)*x + map(l, 4)*y
    end do
  end subroutine chain

  !> One period of the first `n` lanes from `start`, in which every pair between A and E stays in contact,
  !> pull or push: the state after it and its derivative by `start`.
  pure subroutine hold_lanes(osc, table, n, duration, start, maps, out)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: n
    real(dp), intent(in) :: duration(lanes), start(2, lanes)
    type(maps_t), intent(inout) :: maps
    type(period_t), intent(inout) :: out(lanes)
    real(dp) :: total(lanes, 4)
    real(dp), dimension(lanes) :: x, y, x_next, y_next
    integer :: i, l, place

    x = start(1, :)
    y = start(2, :)
    total = 0
    total(:, 1) = 1
    total(:, 4) = 1
    do i = 1, table%steps
      place = merge(i, 1, maps%kept)
      call make_map(osc, n, duration, table%width(i), table%square(:, i), table%omega(:, i), table%push(:, i), &
                    maps%map(:, :, place))
      maps%touch(:n, place) = all_pairs(table, i)
      call move(n, maps%map(:, :, place), x, y, x_next, y_next)
      call chain(n, maps%map(:, :, place), total)
      x(:n) = x_next(:n)
      y(:n) = y_next(:n)
    end do
    do l = 1, n
      out(l)%map(:, 1) = total(l, :2)
      out(l)%map(:, 2) = total(l, 3:)
      out(l)%state = [x(l), y(l)]
    end do
  end subroutine hold_lanes
end module gearsweep_maps
