!> Changes of contact within a step: whether there is one, where, and what the
!> motion and its map do there.
module gearsweep_contact
  use gearsweep_kinds, only: dp
  use gearsweep_motion, only: oscillator_t, table_t, evaluate, pair_slopes
  use gearsweep_step, only: period_t, walk_t, step_t, advance, advance_map, decay_over, blend, note_contact, &
                            may_change, turning_point, track
  use gearsweep_trace, only: trace_t, record
  implicit none
  private
  public :: contact_changes, cross

  !> Changes of contact within one step, and beyond those of free oscillation
  !> within one period; with more, contact chatters.
  integer, parameter :: most_events = 40, most_extra = 1000

  !> What one change costs, in Runge-Kutta steps.
  real(dp), parameter :: cost = 50

contains

  !> Does a member touch or leave during step i, which ends at x, y?
  pure logical function contact_changes(osc, table, i, walk, x, y) result(changes)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: i
    type(walk_t), intent(in) :: walk
    real(dp), intent(in) :: x, y
    integer :: j

    changes = .false.
    do j = 1, table%pairs(i)
      changes = changes .or. may_change(walk%contact(j), walk%x - table%error(j, 1, i), x - table%error(j, 3, i), &
                                        table%width(i)*(walk%y - table%error_slope(j, 1, i)), &
                                        table%width(i)*(y - table%error_slope(j, 2, i)))
    end do
    if (osc%has_backlash) changes = changes .or. &
      may_change(walk%contact(table%members), -walk%x - osc%backlash, -x - osc%backlash, &
                 -table%width(i)*walk%y, -table%width(i)*y)
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
    real(dp) :: left, rest, part, piece
    integer :: count, member, k

    left = table%left(i)
    rest = table%width(i)
    out%failed = out%events > most_extra + osc%members*osc%highest_frequency*duration
    do count = 1, merge(0, most_events, out%failed)
      call next_event(osc, table, i, duration, walk, left, rest, part, member)
      piece = part*rest/table%parts
      do k = 0, merge(table%parts, 0, piece > 0) - 1
        call accept(osc, table, i, duration, left + k*piece, piece, walk, out, trace)
      end do
      if (member == 0) return
      left = left + part*rest
      rest = (1 - part)*rest
      call switch_contact(osc, table, i, duration, left, member, walk)
      out%events = out%events + 1
      out%work = out%work + cost
      call note_contact(osc, walk%contact, out)
      if (rest <= 0) return
    end do
    out%failed = .true.
  end subroutine cross

  !> The first change of contact in the stretch: its place as a part of the
  !> stretch and the member; 1 and 0 where there is none.
  pure subroutine next_event(osc, table, i, duration, walk, left, width, part, member)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: i
    real(dp), intent(in) :: duration, left, width
    type(walk_t), intent(in) :: walk
    real(dp), intent(out) :: part
    integer, intent(out) :: member
    real(dp), dimension(table%members) :: first, first_slope, last, last_slope
    real(dp) :: until
    integer :: j

    part = 0
    call probe(osc, table, i, duration, walk, left, width, part, first, first_slope)
    do member = 1, table%members
      ! Pairs with the same profile error change together, one by one.
      if (can_change(member) .and. .not. is_same_side(member, first)) return
    end do
    part = 1
    member = 0
    call probe(osc, table, i, duration, walk, left, width, part, last, last_slope)
    do j = 1, table%members
      if (.not. can_change(j)) cycle
      if (member > 0) then
        if (.not. abs(last(j) - last(member)) > 0) cycle
      end if
      until = part
      if (is_same_side(j, last)) then
        if (.not. may_change(walk%contact(j), first(j), last(j), part*first_slope(j), part*last_slope(j))) cycle
        until = turning_point([first(j), last(j)], part*[first_slope(j), last_slope(j)])*part
        call probe(osc, table, i, duration, walk, left, width, until, last, last_slope)
        if (is_same_side(j, last)) then
          call probe(osc, table, i, duration, walk, left, width, part, last, last_slope)
          cycle
        end if
      end if
      part = first_crossing(j, until)
      member = j
      call probe(osc, table, i, duration, walk, left, width, part, last, last_slope)
    end do

  contains

    pure logical function can_change(j)
      integer, intent(in) :: j

      can_change = j <= table%pairs(i) .or. (osc%has_backlash .and. j == table%members)
    end function can_change

    pure logical function is_same_side(j, overlap)
      integer, intent(in) :: j
      real(dp), intent(in) :: overlap(:)

      is_same_side = walk%contact(j) .eqv. overlap(j) > 0
    end function is_same_side

    !> Newton's method kept within a bracket, each time a hair beyond the root, so
    !> that both ends close in; ends on the far side of the change, so that the
    !> switched state is consistent.
    pure real(dp) function first_crossing(j, until) result(high)
      integer, intent(in) :: j
      real(dp), intent(in) :: until
      real(dp), parameter :: hair = 1e-14_dp
      real(dp), dimension(table%members) :: value, slope
      real(dp) :: low, trial, beyond
      integer :: iteration

      low = 0
      high = until
      trial = high
      do iteration = 1, 60
        call probe(osc, table, i, duration, walk, left, width, trial, value, slope)
        if (is_same_side(j, value)) then
          low = trial
          beyond = hair
        else
          high = trial
          beyond = -hair
        end if
        if (high - low <= 4*hair) exit
        if (abs(slope(j)) > 0) trial = trial - value(j)/slope(j) + beyond
        if (.not. (trial > low .and. trial < high)) trial = (low + high)/2
      end do
    end function first_crossing
  end subroutine next_event

  !> Overlaps of all members and their slopes over the stretch, after a part of it.
  pure subroutine probe(osc, table, i, duration, walk, left, width, part, overlap, slope)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: i
    real(dp), intent(in) :: duration, left, width, part
    type(walk_t), intent(in) :: walk
    real(dp), dimension(table%members), intent(out) :: overlap, slope
    real(dp), dimension(table%members, 3) :: rate, error, stiffness
    real(dp), dimension(table%members) :: stiffness_slope, error_slope
    type(step_t) :: step
    real(dp) :: x, y, piece
    integer :: k

    x = walk%x
    y = walk%y
    piece = part*width/table%parts
    if (piece > 0) then
      do k = 0, table%parts - 1
        call stretch(osc, table, i, duration, walk, left + k*piece, piece, step, rate, error, stiffness)
        call advance(step, x, y)
      end do
    else
      call evaluate(osc, table%zones(table%zone(i)), left, rate(:, 3), error(:, 3), stiffness(:, 3))
    end if
    call pair_slopes(osc, table%zones(table%zone(i)), left + part*width, stiffness_slope, error_slope)
    overlap = x - error(:, 3)
    slope = width*(y - error_slope)
    if (.not. osc%has_backlash) return
    overlap(table%members) = -overlap(table%members)
    slope(table%members) = -width*y
  end subroutine probe

  !> Coefficients of a stretch within step i, at its ends and its middle.
  pure subroutine stretch(osc, table, i, duration, walk, left, width, step, rate, error, stiffness)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: i
    real(dp), intent(in) :: duration, left, width
    type(walk_t), intent(in) :: walk
    type(step_t), intent(out) :: step
    real(dp), dimension(table%members, 3), intent(out) :: rate, error, stiffness
    integer :: place

    do place = 1, 3
      call evaluate(osc, table%zones(table%zone(i)), left + width*(place - 1)/2, &
                    rate(:, place), error(:, place), stiffness(:, place))
    end do
    step%width = width
    call blend(osc, rate, error, walk%contact, duration, step)
  end subroutine stretch

  !> Moves the walk over a stretch within step i.
  pure subroutine accept(osc, table, i, duration, left, width, walk, out, trace)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: i
    real(dp), intent(in) :: duration, left, width
    type(walk_t), intent(inout) :: walk
    type(period_t), intent(inout) :: out
    type(trace_t), intent(inout), optional :: trace
    real(dp), dimension(table%members, 3) :: rate, error, stiffness
    real(dp), dimension(table%members, 2) :: stiffness_slope, error_slope
    type(step_t) :: step
    real(dp) :: x, y
    integer :: j

    call stretch(osc, table, i, duration, walk, left, width, step, rate, error, stiffness)
    x = walk%x
    y = walk%y
    call advance(step, x, y)
    associate (zone => table%zones(table%zone(i)))
      call pair_slopes(osc, zone, left, stiffness_slope(:, 1), error_slope(:, 1))
      call pair_slopes(osc, zone, left + width, stiffness_slope(:, 2), error_slope(:, 2))
    end associate
    do j = 1, table%pairs(i)
      if (walk%contact(j)) call track(width, stiffness(j, ::2), stiffness_slope(j, :), &
                                      [walk%x, x] - error(j, ::2), [walk%y, y] - error_slope(j, :), out%peak)
    end do
    if (present(trace)) call record(trace, table%pairs(i), left + [0.0_dp, width], [walk%x, x], &
                                    stiffness(:, ::2), error(:, ::2), walk%contact)
    call advance_map(step, walk%map)
    out%decay = out%decay + decay_over(step)
    walk%x = x
    walk%y = y
  end subroutine accept

  !> Switches a member's contact; only damping jumps there, which the map feels
  !> through the moment of the change (saltation).
  pure subroutine switch_contact(osc, table, i, duration, phase, member, walk)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: i, member
    real(dp), intent(in) :: duration, phase
    type(walk_t), intent(inout) :: walk
    real(dp), dimension(table%members) :: rate, error, stiffness, stiffness_slope, error_slope
    real(dp) :: before, after, approach

    associate (zone => table%zones(table%zone(i)))
      call evaluate(osc, zone, phase, rate, error, stiffness)
      call pair_slopes(osc, zone, phase, stiffness_slope, error_slope)
    end associate
    if (osc%has_backlash .and. member == table%members) error_slope(member) = 0
    before = sqrt(sum(rate, mask=walk%contact))
    walk%contact(member) = .not. walk%contact(member)
    after = sqrt(sum(rate, mask=walk%contact))
    approach = walk%y - error_slope(member)
    if (abs(approach) > 0) walk%map(2, :) = walk%map(2, :) &
      - 2*osc%damping_ratio*duration*(after - before)*walk%y/approach*walk%map(1, :)
  end subroutine switch_contact
end module gearsweep_contact
