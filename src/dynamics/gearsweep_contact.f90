!> Changes of contact within a step: whether there is one, where, and what the
!> motion and its map do there.
module gearsweep_contact
  use gearsweep_kinds, only: dp
  use gearsweep_gauss, only: nodes
  use gearsweep_motion, only: oscillator_t, table_t, evaluate, pair_shapes, acceleration
  use gearsweep_quintic, only: first_zero, may_pass, quintic
  use gearsweep_step, only: period_t, walk_t, step_t, step_of, follow, note_contact, track
  use gearsweep_trace, only: trace_t, record
  implicit none
  private
  public :: contact_changes, cross

  integer, parameter :: most_events = 40         ! within one step; beyond, contact chatters

  !> A part of a step with the contact as it is: its ends and what happens between.
  type :: stretch_t
    real(dp) :: left, width
    type(step_t) :: step
    real(dp) :: x(2), y(2), acceleration(2)
    real(dp), allocatable :: stiffness(:, :, :), error(:, :, :)   !< (0:2, pair, end)
  end type stretch_t

contains

  !> Does a member touch or leave during step i, which ends at x, y?
  pure logical function contact_changes(osc, table, i, walk, x, y) result(changes)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: i
    type(walk_t), intent(in) :: walk
    real(dp), intent(in) :: x, y
    real(dp) :: sense, width
    integer :: j

    changes = .false.
    width = table%width(i)
    do j = 1, table%pairs(i)
      sense = merge(1, -1, walk%contact(j))
      associate (left => table%end_error(:, j, 1, i), right => table%end_error(:, j, 2, i))
        changes = changes .or. may_pass(sense*(walk%x - left(1)), sense*(x - right(1)), &
                                        sense*width*(walk%y - left(2)), sense*width*(y - right(2)))
      end associate
    end do
    if (.not. osc%has_backlash) return
    sense = merge(-1, 1, walk%contact(table%members))
    changes = changes .or. may_pass(sense*(walk%x + osc%backlash), sense*(x + osc%backlash), &
                                    sense*width*walk%y, sense*width*y)
  end function contact_changes

  !> Goes through step i from one change of contact to the next.
  pure subroutine cross(osc, table, i, duration, walk, out, trace)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: i
    real(dp), intent(in) :: duration
    type(walk_t), intent(inout) :: walk
    type(period_t), intent(inout) :: out
    type(trace_t), intent(inout), optional :: trace
    type(stretch_t) :: stretch
    real(dp) :: left, rest, part
    integer :: count, member

    left = table%left(i)
    rest = table%width(i)
    do count = 1, most_events
      call make_stretch(osc, table, i, duration, walk, left, rest, stretch)
      call first_change(osc, table%pairs(i), walk, stretch, part, member)
      if (member > 0) call close_in(osc, table, i, duration, walk, part, member, stretch)
      call accept(table%pairs(i), stretch, walk, out, trace)
      if (member == 0) return
      rest = left + rest - (stretch%left + stretch%width)
      left = stretch%left + stretch%width
      call switch_contact(osc, table, i, duration, left, member, walk)
      out%events = out%events + 1
      call note_contact(osc, walk%contact, out)
      if (rest <= 0) return
    end do
    out%failed = .true.
  end subroutine cross

  !> The motion over [left, left + width] within step i.
  pure subroutine make_stretch(osc, table, i, duration, walk, left, width, stretch)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: i
    real(dp), intent(in) :: duration, left, width
    type(walk_t), intent(in) :: walk
    type(stretch_t), intent(inout) :: stretch
    real(dp) :: rate(table%members), error(table%members), square(3), push(3), state(2)
    integer :: place

    if (.not. allocated(stretch%error)) allocate (stretch%stiffness(0:2, osc%pairs, 2), stretch%error(0:2, osc%pairs, 2))
    associate (zone => table%zones(table%zone(i)))
      do place = 1, size(nodes)
        call evaluate(osc, zone, left + width*nodes(place), rate, error)
        square(place) = sum(rate, mask=walk%contact)
        push(place) = sum(rate*error, mask=walk%contact)
      end do
      stretch%left = left
      stretch%width = width
      stretch%step = step_of(osc, square, push, sqrt(square), duration, width)
      state = follow(stretch%step, walk%x, walk%y)
      stretch%x = [walk%x, state(1)]
      stretch%y = [walk%y, state(2)]
      do place = 1, 2
        call evaluate(osc, zone, left + width*(place - 1), rate, error)
        call pair_shapes(osc, zone, left + width*(place - 1), stretch%stiffness(:, :, place), stretch%error(:, :, place))
        stretch%acceleration(place) = acceleration(osc, rate, error, walk%contact, duration, stretch%x(place), stretch%y(place))
      end do
    end associate
  end subroutine make_stretch

  !> Overlap of member j at both ends of the stretch: value, first and second derivative over it.
  pure function overlap(osc, stretch, j) result(o)
    type(oscillator_t), intent(in) :: osc
    type(stretch_t), intent(in) :: stretch
    integer, intent(in) :: j
    real(dp) :: o(0:2, 2)
    integer :: k

    o(0, :) = stretch%x
    o(1, :) = stretch%y
    o(2, :) = stretch%acceleration
    if (j <= osc%pairs) then
      o = o - stretch%error(:, j, :)
    else
      o(0, :) = o(0, :) + osc%backlash
      o = -o
    end if
    do k = 1, 2
      o(k, :) = o(k, :)*stretch%width**k
    end do
  end function overlap

  !> The first change of contact in the stretch: its place as a part of it and the member; 1 and 0 where
  !> there is none.
  pure subroutine first_change(osc, pairs, walk, stretch, part, member)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: pairs
    type(walk_t), intent(in) :: walk
    type(stretch_t), intent(in) :: stretch
    real(dp), intent(out) :: part
    integer, intent(out) :: member
    real(dp) :: o(0:2, 2), place
    logical :: found
    integer :: j

    part = 1
    member = 0
    do j = 1, osc%members
      if (j > pairs .and. j <= osc%pairs) cycle
      o = overlap(osc, stretch, j)
      call first_zero(quintic(o(:, 1), o(:, 2)), walk%contact(j), place, found)
      if (.not. found .or. place >= part) cycle
      part = place
      member = j
    end do
  end subroutine first_change

  !> Shortens the stretch to where the member's overlap has just changed its sign.
  pure subroutine close_in(osc, table, i, duration, walk, guess, member, stretch)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: i, member
    real(dp), intent(in) :: duration, guess
    type(walk_t), intent(in) :: walk
    type(stretch_t), intent(inout) :: stretch
    ! A hair beyond the zero, as the zero itself is on neither side; the force is continuous there.
    real(dp), parameter :: hair = 1e-13_dp, close = 1e-11_dp
    real(dp) :: left, width, low, high, part, o(0:2, 2), miss
    integer :: iteration

    left = stretch%left
    width = stretch%width
    low = 0
    high = 1
    part = guess
    do iteration = 1, 50
      call make_stretch(osc, table, i, duration, walk, left, part*width, stretch)
      o = overlap(osc, stretch, member)
      miss = huge(miss)
      if (abs(o(1, 2)) > 0) miss = o(0, 2)/o(1, 2)*part
      if (walk%contact(member) .eqv. o(0, 2) > 0) then
        low = part
      else
        high = part
        if (abs(miss) <= close) exit
      end if
      if (high - low <= hair) exit
      part = part - miss + hair
      if (.not. (part > low .and. part < high)) part = (low + high)/2
    end do
  end subroutine close_in

  !> Moves the walk to the end of the stretch.
  pure subroutine accept(pairs, stretch, walk, out, trace)
    integer, intent(in) :: pairs
    type(stretch_t), intent(in) :: stretch
    type(walk_t), intent(inout) :: walk
    type(period_t), intent(inout) :: out
    type(trace_t), intent(inout), optional :: trace
    real(dp), dimension(0:2, 2) :: stiffness, gap
    integer :: j, k

    do j = 1, pairs
      if (.not. walk%contact(j)) cycle
      gap(0, :) = stretch%x - stretch%error(0, j, :)
      gap(1, :) = stretch%y - stretch%error(1, j, :)
      gap(2, :) = stretch%acceleration - stretch%error(2, j, :)
      do k = 0, 2
        stiffness(k, :) = stretch%stiffness(k, j, :)*stretch%width**k
        gap(k, :) = gap(k, :)*stretch%width**k
      end do
      call track(stiffness, gap, out%peak)
    end do
    if (present(trace)) call record(trace, pairs, stretch%left + [0.0_dp, stretch%width], stretch%x, &
                                    stretch%stiffness(0, :, :), stretch%error(0, :, :), walk%contact)
    walk%map = matmul(stretch%step%map, walk%map)
    walk%x = stretch%x(2)
    walk%y = stretch%y(2)
  end subroutine accept

  !> Switches a member's contact; only damping jumps there, which the map feels
  !> through the moment of the change (saltation).
  pure subroutine switch_contact(osc, table, i, duration, phase, member, walk)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: i, member
    real(dp), intent(in) :: duration, phase
    type(walk_t), intent(inout) :: walk
    real(dp) :: rate(table%members), error(table%members), stiffness(0:2, osc%pairs), shape(0:2, osc%pairs)
    real(dp) :: before, after, approach

    associate (zone => table%zones(table%zone(i)))
      call evaluate(osc, zone, phase, rate, error)
      call pair_shapes(osc, zone, phase, stiffness, shape)
    end associate
    before = sqrt(sum(rate, mask=walk%contact))
    walk%contact(member) = .not. walk%contact(member)
    after = sqrt(sum(rate, mask=walk%contact))
    approach = walk%y
    if (member <= osc%pairs) approach = approach - shape(1, member)
    if (abs(approach) > 0) walk%map(2, :) = walk%map(2, :) &
      - 2*osc%damping_ratio*duration*(after - before)*walk%y/approach*walk%map(1, :)
  end subroutine switch_contact
end module gearsweep_contact
