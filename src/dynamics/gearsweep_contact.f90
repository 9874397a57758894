!> Changes of contact within a step: whether there is one, where, and what the
!> motion and its map do there.
module gearsweep_contact
  use gearsweep_kinds, only: dp
  use gearsweep_gauss, only: nodes
  use gearsweep_motion, only: oscillator_t, table_t, mobility, acceleration, end_acceleration
  use gearsweep_quintic, only: first_zero, may_pass, quintic, shape_of, value_of
  use gearsweep_step, only: period_t, walk_t, step_t, step_of, follow, chain, note_contact, track, track_top
  use gearsweep_trace, only: trace_t, record
  implicit none
  private
  public :: contact_changes, cross

  !> Changes of contact within one step, and beyond those of free oscillation
  !> within one period; with more, contact chatters.
  integer, parameter :: most_events = 40, most_extra = 1000

  !> What one change costs, in steps.
  real(dp), parameter :: cost = 20

  !> A part of step `i` with the contact as it is; places count from 0 to 1 over the step.
  type :: stretch_t
    integer :: i
    real(dp) :: left, width
    type(step_t) :: step
    real(dp) :: x(2), y(2)                       !< at its ends
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
    do j = 1, table%members
      if (j > table%pairs(i) .and. j <= osc%pairs) cycle
      sense = merge(1, -1, walk%contact(j) .eqv. j <= osc%pairs)
      associate (left => table%end_error(:, j, 1, i), right => table%end_error(:, j, 2, i))
        changes = may_pass(sense*(walk%x - left(1)), sense*(x - right(1)), &
                           sense*width*(walk%y - left(2)), sense*width*(y - right(2)))
      end associate
      if (changes) return
    end do
  end function contact_changes

  !> Goes through step i, which would end at `state`, from one change of contact to the next, if there is
  !> one: `changed`. Within the step, stiffness and profile error are then taken as quintics through what
  !> the table knows of its ends.
  pure subroutine cross(osc, table, i, duration, state, walk, out, changed, trace)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: i
    real(dp), intent(in) :: duration, state(2)
    type(walk_t), intent(inout) :: walk
    type(period_t), intent(inout) :: out
    logical, intent(out) :: changed
    type(trace_t), intent(inout), optional :: trace
    type(stretch_t) :: stretch
    real(dp) :: part
    integer :: count, member

    call first_change_of_step(osc, table, i, duration, walk, state, part, member)
    changed = member > 0
    if (.not. changed) return
    call take_step(osc, table, i, walk)
    stretch%i = i
    stretch%left = 0
    stretch%width = 1
    do count = 1, most_events
      if (out%events > most_extra + osc%members*osc%highest_frequency*duration) exit
      call close_in(osc, table, duration, walk, part, member, stretch)
      call accept(osc, table, duration, stretch, walk, out, trace)
      stretch%left = stretch%left + stretch%width
      stretch%width = 1 - stretch%left
      call switch_contact(osc, table, i, duration, stretch%left, member, walk)
      out%events = out%events + 1
      out%work = out%work + cost
      call note_contact(osc, walk%contact, out)
      if (stretch%width <= 0) return
      call follow_stretch(osc, table, duration, walk, stretch)
      call first_change(osc, table, duration, walk, stretch, part, member)
      if (member > 0) cycle
      call accept(osc, table, duration, stretch, walk, out, trace)
      return
    end do
    out%failed = .true.
  end subroutine cross

  !> The first change of contact in step i as the table knows it: its place in the step and the member; 0
  !> where there is none.
  pure subroutine first_change_of_step(osc, table, i, duration, walk, state, place, member)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: i
    real(dp), intent(in) :: duration, state(2)
    type(walk_t), intent(in) :: walk
    real(dp), intent(out) :: place
    integer, intent(out) :: member
    real(dp) :: motion(0:2, 2), overlap(0:2, 2)
    integer :: j, k

    motion(0, :) = [walk%x, state(1)]
    motion(1, :) = [walk%y, state(2)]
    do k = 1, 2
      motion(2, k) = end_acceleration(osc, table, i, k, walk%contact, duration, motion(0, k), motion(1, k))
    end do
    place = 1
    member = 0
    do j = 1, osc%members
      if (j > table%pairs(i) .and. j <= osc%pairs) cycle
      do k = 0, 2
        overlap(k, :) = table%width(i)**k*(motion(k, :) - table%end_error(k, j, :, i))
      end do
      call take_earlier(osc, walk, overlap, j, place, member)
    end do
  end subroutine first_change_of_step

  !> Takes member j's change of contact, if there is one and it is earlier than that at `place`.
  pure subroutine take_earlier(osc, walk, overlap, j, place, member)
    type(oscillator_t), intent(in) :: osc
    type(walk_t), intent(in) :: walk
    real(dp), intent(in) :: overlap(0:2, 2)
    integer, intent(in) :: j
    real(dp), intent(inout) :: place
    integer, intent(inout) :: member
    real(dp) :: zero
    logical :: found

    call first_zero(quintic(overlap(:, 1), overlap(:, 2)), walk%contact(j) .eqv. j <= osc%pairs, zero, found)
    if (.not. found .or. zero >= place) return
    place = zero
    member = j
  end subroutine take_earlier

  !> The quintics of step i.
  pure subroutine take_step(osc, table, i, walk)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: i
    type(walk_t), intent(inout) :: walk
    real(dp) :: scale(0:2)
    integer :: j

    scale = [1.0_dp, table%width(i), table%width(i)**2]
    do j = 1, table%pairs(i)
      walk%stiffness(:, j) = quintic(scale*table%end_stiffness(:, j, 1, i), scale*table%end_stiffness(:, j, 2, i))
    end do
    do j = 1, table%members
      walk%error(:, j) = quintic(scale*table%end_error(:, j, 1, i), scale*table%end_error(:, j, 2, i))
    end do
  end subroutine take_step

  !> Sums over the members in contact at a place of step i: w^2 and sum of k e.
  pure subroutine sum_up(osc, table, i, walk, place, square, push)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: i
    type(walk_t), intent(in) :: walk
    real(dp), intent(in) :: place
    real(dp), intent(out) :: square, push
    real(dp) :: stiffness, rate, s, coast
    integer :: j

    square = 0
    push = 0
    coast = 0
    s = table%left(i) + place*table%width(i)
    associate (zone => osc%zones(table%zone(i)))
      do j = 1, zone%pairs
        stiffness = value_of(walk%stiffness(:, j), place)
        coast = coast + stiffness
        if (.not. walk%contact(j)) cycle
        rate = stiffness*mobility(osc, s + j - 1, zone%recess(j))
        square = square + rate
        push = push + rate*value_of(walk%error(:, j), place)
      end do
    end associate
    if (.not. osc%has_backlash) return
    if (.not. walk%contact(osc%members)) return
    rate = coast*(1/osc%mass(1) + 1/osc%mass(2))
    square = square + rate
    push = push - rate*osc%backlash
  end subroutine sum_up

  !> The motion over the stretch, whose place is set.
  pure subroutine follow_stretch(osc, table, duration, walk, stretch)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    real(dp), intent(in) :: duration
    type(walk_t), intent(in) :: walk
    type(stretch_t), intent(inout) :: stretch
    real(dp) :: square(3), push(3), state(2)
    integer :: k

    associate (i => stretch%i, left => stretch%left, width => stretch%width)
      do k = 1, size(nodes)
        call sum_up(osc, table, i, walk, left + width*nodes(k), square(k), push(k))
      end do
      stretch%step = step_of(osc, square, push, sqrt(square), duration, width*table%width(i))
    end associate
    state = follow(stretch%step, walk%x, walk%y)
    stretch%x = [walk%x, state(1)]
    stretch%y = [walk%y, state(2)]
  end subroutine follow_stretch

  !> Second derivative of the motion over the stretch at its ends.
  pure function curvature(osc, table, duration, walk, stretch) result(c)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    real(dp), intent(in) :: duration
    type(walk_t), intent(in) :: walk
    type(stretch_t), intent(in) :: stretch
    real(dp) :: c(2), square, push
    integer :: k

    do k = 1, 2
      call sum_up(osc, table, stretch%i, walk, stretch%left + (k - 1)*stretch%width, square, push)
      c(k) = (stretch%width*table%width(stretch%i))**2 &
             *acceleration(osc, square, push, duration, stretch%x(k), stretch%y(k))
    end do
  end function curvature

  !> Value, first and second derivative over the stretch, at both its ends, of a quintic over the step.
  pure function ends_of(stretch, c) result(f)
    type(stretch_t), intent(in) :: stretch
    real(dp), intent(in) :: c(0:5)
    real(dp) :: f(0:2, 2)
    integer :: k

    do k = 1, 2
      f(:, k) = shape_of(c, stretch%left + (k - 1)*stretch%width)*[1.0_dp, stretch%width, stretch%width**2]
    end do
  end function ends_of

  !> The first change of contact in the stretch: its place as a part of it and the member; 1 and 0 where
  !> there is none.
  pure subroutine first_change(osc, table, duration, walk, stretch, part, member)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    real(dp), intent(in) :: duration
    type(walk_t), intent(in) :: walk
    type(stretch_t), intent(in) :: stretch
    real(dp), intent(out) :: part
    integer, intent(out) :: member
    real(dp) :: motion(0:2, 2)
    integer :: j

    part = 1
    member = 0
    motion(0, :) = stretch%x
    motion(1, :) = stretch%width*table%width(stretch%i)*stretch%y
    motion(2, :) = curvature(osc, table, duration, walk, stretch)
    do j = 1, osc%members
      if (j > table%pairs(stretch%i) .and. j <= osc%pairs) cycle
      call take_earlier(osc, walk, motion - ends_of(stretch, walk%error(:, j)), j, part, member)
    end do
  end subroutine first_change

  !> Shortens the stretch to where the member's overlap has just changed its sign.
  pure subroutine close_in(osc, table, duration, walk, guess, member, stretch)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: member
    real(dp), intent(in) :: duration, guess
    type(walk_t), intent(in) :: walk
    type(stretch_t), intent(inout) :: stretch
    ! A hair beyond the zero, as the zero itself is on neither side; the force is continuous there.
    real(dp), parameter :: hair = 1e-13_dp, close = 1e-11_dp
    real(dp) :: width, low, high, part, error(0:2), overlap, slope, miss
    integer :: iteration

    width = stretch%width
    low = 0
    high = 1
    part = guess
    do iteration = 1, 50
      stretch%width = part*width
      call follow_stretch(osc, table, duration, walk, stretch)
      error = shape_of(walk%error(:, member), stretch%left + stretch%width)
      overlap = stretch%x(2) - error(0)
      slope = width*(table%width(stretch%i)*stretch%y(2) - error(1))
      miss = huge(miss)
      if (abs(slope) > 0) miss = overlap/slope
      if ((walk%contact(member) .eqv. member <= osc%pairs) .eqv. overlap > 0) then
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
  pure subroutine accept(osc, table, duration, stretch, walk, out, trace)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    real(dp), intent(in) :: duration
    type(stretch_t), intent(in) :: stretch
    type(walk_t), intent(inout) :: walk
    type(period_t), intent(inout) :: out
    type(trace_t), intent(inout), optional :: trace
    real(dp), dimension(0:2, 2) :: motion, stiffness, gap, load
    real(dp) :: ends(2)
    logical :: more, known
    integer :: j, k

    associate (i => stretch%i, pairs => table%pairs(stretch%i))
      motion(0, :) = stretch%x
      motion(1, :) = stretch%width*table%width(i)*stretch%y
      known = .false.
      do j = 1, pairs
        if (.not. walk%contact(j)) cycle
        stiffness = ends_of(stretch, walk%stiffness(:, j))
        gap = ends_of(stretch, walk%error(:, j))
        gap(:1, :) = motion(:1, :) - gap(:1, :)
        load(0, :) = stiffness(0, :)*gap(0, :)
        load(1, :) = stiffness(1, :)*gap(0, :) + stiffness(0, :)*gap(1, :)
        call track(load, out%peak, more)
        if (.not. more) cycle
        if (.not. known) motion(2, :) = curvature(osc, table, duration, walk, stretch)
        known = .true.
        gap(2, :) = motion(2, :) - gap(2, :)
        load(2, :) = stiffness(2, :)*gap(0, :) + 2*stiffness(1, :)*gap(1, :) + stiffness(0, :)*gap(2, :)
        call track_top(load, out%peak)
      end do
      if (present(trace)) then
        ends = stretch%left + [0.0_dp, stretch%width]
        call record(trace, pairs, table%left(i) + table%width(i)*ends, stretch%x, &
          reshape([((value_of(walk%stiffness(:, j), ends(k)), j=1, pairs), k=1, 2)], [pairs, 2]), &
          reshape([((value_of(walk%error(:, j), ends(k)), j=1, pairs), k=1, 2)], [pairs, 2]), walk%contact)
      end if
    end associate
    call chain(stretch%step, walk%map)
    walk%x = stretch%x(2)
    walk%y = stretch%y(2)
  end subroutine accept

  !> Switches a member's contact; only damping jumps there, which the map feels
  !> through the moment of the change (saltation).
  pure subroutine switch_contact(osc, table, i, duration, place, member, walk)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: i, member
    real(dp), intent(in) :: duration, place
    type(walk_t), intent(inout) :: walk
    real(dp) :: before, after, push, shape(0:2), approach

    call sum_up(osc, table, i, walk, place, before, push)
    walk%contact(member) = .not. walk%contact(member)
    call sum_up(osc, table, i, walk, place, after, push)
    shape = shape_of(walk%error(:, member), place)
    approach = walk%y - shape(1)/table%width(i)
    if (abs(approach) > 0) walk%map(2, :) = walk%map(2, :) &
      - 2*osc%damping_ratio*duration*(sqrt(after) - sqrt(before))*walk%y/approach*walk%map(1, :)
  end subroutine switch_contact
end module gearsweep_contact
