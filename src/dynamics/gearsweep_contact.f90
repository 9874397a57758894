!> Changes of contact within a step, in the lanes that have them: where they are, and what the motion and
!> its map do there. Each lane goes through the step in stretches of its own, from one change to the next;
!> the vectors carry the stretches of all lanes.
module gearsweep_contact
  use gearsweep_kinds, only: dp
  use gearsweep_gauss, only: collocate, lanes, nodes
  use gearsweep_motion, only: oscillator_t, table_t, mobility, acceleration
  use gearsweep_quintic, only: first_zero, may_pass, quintic, shape_of, value_of
  use gearsweep_step, only: period_t, member_t, touching, set_contact, note_contact, may_top, raise_to_top
  use gearsweep_trace, only: trace_t, record
  implicit none
  private
  public :: course_t, make_course, cross

  !> Changes of contact within one step, and beyond those of free oscillation
  !> within one period; with more, contact chatters.
  integer, parameter :: most_events = 40, most_extra = 1000

  !> What one change costs, in steps.
  real(dp), parameter :: cost = 20

  !> The step at hand: stiffness and profile error as quintics through what the table knows of its ends,
  !> (0:5, pair) and (0:5, member), and the mobility, which is linear, (0:1, pair).
  type :: course_t
    real(dp), allocatable :: stiffness(:, :), error(:, :), mobility(:, :)
    logical, allocatable :: contact(:)           !< of the lane at hand
  end type course_t

  !> Places in a stretch at which its coefficients are known: both ends, and the nodes between.
  real(dp), parameter :: places(5) = [0.0_dp, nodes, 1.0_dp]

  !> A part of the step in each lane, with the contact as it is; places count from 0 to 1 over the step.
  type :: stretch_t
    real(dp), dimension(lanes) :: left = 0, width = 0
    real(dp), dimension(lanes, size(places)) :: square = 0, push = 0   !< w^2 and sum of k e
    real(dp), dimension(lanes, 2) :: x = 0, y = 0                      !< at its ends
    real(dp) :: map(lanes, 6) = 0
  end type stretch_t

  !> What a lane looks for.
  type :: search_t
    logical :: active = .false.
    integer :: member = 0                        !< closing in on its change; 0: looking for one
    integer :: trials = 0
    real(dp) :: room, part, low, high            !< the stretch looked at; guess and bounds as parts of it
    integer :: events = 0
    real(dp) :: before = 0, ratio = 0            !< the last change: w^2, y over the speed of approach
    real(dp) :: map(4) = [1, 0, 0, 1]            !< of the stretches so far
  end type search_t

contains

  pure subroutine make_course(osc, course)
    type(oscillator_t), intent(in) :: osc
    type(course_t), intent(out) :: course

    allocate (course%stiffness(0:5, osc%pairs), course%error(0:5, osc%members), course%mobility(0:1, osc%pairs))
    allocate (course%contact(osc%members))
  end subroutine make_course

  !> Takes the lanes `changes`, of the first `n`, through step i, which begins at `start` and would end
  !> at x, y after `map`. Where contact does change, these become what they are then; `changes` tells.
  pure subroutine cross(osc, table, i, n, duration, start, changes, course, member, x, y, map, peak, out, trace)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: i, n
    real(dp), intent(in) :: duration(lanes), start(lanes, 2)
    logical, intent(inout) :: changes(lanes)
    type(course_t), intent(inout) :: course
    type(member_t), intent(inout) :: member(osc%members)
    real(dp), intent(inout) :: x(lanes), y(lanes), map(lanes, 6), peak(lanes)
    type(period_t), intent(inout) :: out(lanes)
    type(trace_t), intent(inout), optional :: trace
    type(stretch_t) :: stretch
    type(search_t) :: search(lanes)
    integer :: l

    call take_step(osc, table, i, course)
    search%active = changes
    changes = .false.
    stretch%width(:n) = 1
    stretch%x(:, 1) = start(:, 1)
    stretch%y(:, 1) = start(:, 2)
    stretch%x(:, 2) = x
    stretch%y(:, 2) = y
    call sum_up(osc, course, member, table%pairs(i), n, 1, stretch)
    call sum_up(osc, course, member, table%pairs(i), n, size(places), stretch)
    do
      do l = 1, n
        if (.not. search(l)%active) cycle
        if (search(l)%member == 0) then
          call look(osc, table, i, l, duration(l), course, member, stretch, search(l), peak(l), out(l), trace)
          changes(l) = search(l)%events > 0
          if (search(l)%active .or. .not. changes(l)) cycle
          x(l) = stretch%x(l, 1)
          y(l) = stretch%y(l, 1)
          map(l, :4) = search(l)%map
        else
          call close_in(osc, table, i, l, duration(l), course, member, stretch, search(l), peak(l), out(l), trace)
        end if
      end do
      if (.not. any(search(:n)%active)) return
      call follow(osc, table, i, n, duration, course, member, stretch)
    end do
  end subroutine cross

  pure subroutine take_step(osc, table, i, course)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: i
    type(course_t), intent(inout) :: course
    real(dp) :: scale(0:2)
    integer :: j

    scale = [1.0_dp, table%width(i), table%width(i)**2]
    do j = 1, table%pairs(i)
      course%stiffness(:, j) = quintic(scale*table%end_stiffness(:, j, 1, i), scale*table%end_stiffness(:, j, 2, i))
      associate (left => table%left(i) + j - 1, recess => osc%zones(table%zone(i))%recess(j))
        course%mobility(0, j) = mobility(osc, left, recess)
        course%mobility(1, j) = mobility(osc, left + table%width(i), recess) - course%mobility(0, j)
      end associate
    end do
    do j = 1, osc%members
      course%error(:, j) = quintic(scale*table%end_error(:, j, 1, i), scale*table%end_error(:, j, 2, i))
    end do
  end subroutine take_step

  !> Sums over the members in contact at the place k of the stretches: w^2 and sum of k e.
  pure subroutine sum_up(osc, course, member, pairs, n, k, stretch)
    type(oscillator_t), intent(in) :: osc
    type(course_t), intent(in) :: course
    type(member_t), intent(in) :: member(osc%members)
    integer, intent(in) :: pairs, n, k
    type(stretch_t), intent(inout) :: stretch
    real(dp) :: place(lanes), square(lanes), push(lanes), slack(0:5)
    integer :: j

    place = stretch%left + stretch%width*places(k)
    square = 0
    push = 0
    do j = 1, pairs
      call add_pair(n, course%stiffness(:, j), course%error(:, j), course%mobility(:, j), place, member(j)%weight, square, push)
    end do
    if (osc%has_backlash) then
      slack = 0
      slack(0) = -osc%backlash
      do j = 1, pairs
        call add_pair(n, course%stiffness(:, j), slack, [sum(1/osc%mass), 0.0_dp], place, member(osc%members)%weight, square, push)
      end do
    end if
    stretch%square(:, k) = square
    stretch%push(:, k) = push
  end subroutine sum_up

  pure subroutine add_pair(n, stiffness, error, mobility, place, weight, square, push)
    integer, intent(in) :: n
    real(dp), intent(in) :: stiffness(0:5), error(0:5), mobility(0:1)
    real(dp), intent(in), dimension(lanes) :: place, weight
    real(dp), intent(inout), dimension(lanes) :: square, push
    real(dp) :: t, k, e, rate
    integer :: l

    do l = 1, n
      t = place(l)
      k = ((((stiffness(5)*t + stiffness(4))*t + stiffness(3))*t + stiffness(2))*t + stiffness(1))*t + stiffness(0)
      e = ((((error(5)*t + error(4))*t + error(3))*t + error(2))*t + error(1))*t + error(0)
      rate = weight(l)*k*(mobility(0) + mobility(1)*t)
      square(l) = square(l) + rate
      push(l) = push(l) + rate*e
    end do
  end subroutine add_pair

  !> The motion over the stretches, whose places are set; none is harmed by having no width.
  pure subroutine follow(osc, table, i, n, duration, course, member, stretch)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: i, n
    real(dp), intent(in) :: duration(lanes)
    type(course_t), intent(in) :: course
    type(member_t), intent(in) :: member(osc%members)
    type(stretch_t), intent(inout) :: stretch
    real(dp), dimension(lanes, size(nodes)) :: square, drag, push
    real(dp) :: time, width, load
    integer :: k, l

    do k = 1, size(places)
      call sum_up(osc, course, member, table%pairs(i), n, k, stretch)
    end do
    load = osc%load*sum(1/osc%mass)
    do k = 1, size(nodes)
      do l = 1, n
        time = duration(l)*(stretch%width(l)*table%width(i))
        square(l, k) = time**2*stretch%square(l, k + 1)
        drag(l, k) = 2*osc%damping_ratio*time*sqrt(stretch%square(l, k + 1))
        push(l, k) = time**2*(stretch%push(l, k + 1) + load)
      end do
    end do
    call collocate(n, square, drag, push, stretch%map)
    do l = 1, n
      width = stretch%width(l)*table%width(i)
      stretch%map(l, 2) = stretch%map(l, 2)/max(width, tiny(width))
      stretch%map(l, 3) = stretch%map(l, 3)*width
      stretch%map(l, 6) = stretch%map(l, 6)/max(width, tiny(width))
      stretch%x(l, 2) = stretch%map(l, 1)*stretch%x(l, 1) + stretch%map(l, 3)*stretch%y(l, 1) + stretch%map(l, 5)
      stretch%y(l, 2) = stretch%map(l, 2)*stretch%x(l, 1) + stretch%map(l, 4)*stretch%y(l, 1) + stretch%map(l, 6)
    end do
  end subroutine follow

  !> Lane l, whose stretch goes to the end of the step: closes in on the first change of contact in it, or
  !> is through.
  pure subroutine look(osc, table, i, l, duration, course, member, stretch, search, peak, out, trace)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: i, l
    real(dp), intent(in) :: duration
    type(course_t), intent(inout) :: course
    type(member_t), intent(in) :: member(osc%members)
    type(stretch_t), intent(inout) :: stretch
    type(search_t), intent(inout) :: search
    real(dp), intent(inout) :: peak
    type(period_t), intent(inout) :: out
    type(trace_t), intent(inout), optional :: trace

    ! Only damping jumps with the contact, which the map feels through the moment of the change (saltation).
    associate (jump => sqrt(stretch%square(l, 1)) - sqrt(search%before), map => search%map)
      if (search%events > 0) map([2, 4]) = map([2, 4]) - 2*osc%damping_ratio*duration*jump*search%ratio*map([1, 3])
    end associate
    call find_change(osc, table, i, l, duration, course, member, stretch, search%part, search%member)
    if (search%member > 0) then
      out%failed = search%events == most_events .or. out%events > most_extra + osc%members*osc%highest_frequency*duration
      search%active = .not. out%failed
      search%room = stretch%width(l)
      search%low = 0
      search%high = 1
      search%trials = 0
      stretch%width(l) = search%part*search%room
    else
      search%active = .false.
      if (search%events > 0) call accept(osc, table, i, l, duration, course, member, stretch, search, peak, trace)
    end if
  end subroutine look

  !> The first change of contact in the stretch of lane l: its place as a part of it and the member; 0
  !> where there is none.
  pure subroutine find_change(osc, table, i, l, duration, course, member, stretch, part, which)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: i, l
    real(dp), intent(in) :: duration
    type(course_t), intent(in) :: course
    type(member_t), intent(in) :: member(osc%members)
    type(stretch_t), intent(in) :: stretch
    real(dp), intent(out) :: part
    integer, intent(out) :: which
    real(dp) :: motion(0:2, 2), overlap(0:2, 2), zero
    logical :: found
    integer :: j

    part = 1
    which = 0
    if (.not. stretch%width(l) > 0) return
    motion = motion_of(osc, table, i, l, duration, stretch)
    do j = 1, osc%members
      if (j > table%pairs(i) .and. j <= osc%pairs) cycle
      overlap = member(j)%sense(l)*(motion - ends_of(stretch, l, course%error(:, j)))
      if (.not. may_pass(overlap(0, 1), overlap(0, 2), overlap(1, 1), overlap(1, 2))) cycle
      call first_zero(quintic(overlap(:, 1), overlap(:, 2)), zero, found)
      if (.not. found .or. zero >= part) cycle
      part = zero
      which = j
    end do
  end subroutine find_change

  !> Lane l, whose stretch ends near the change of a member's contact: goes on from where its overlap has
  !> just changed its sign, or shortens or lengthens the stretch.
  pure subroutine close_in(osc, table, i, l, duration, course, member, stretch, search, peak, out, trace)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: i, l
    real(dp), intent(in) :: duration
    type(course_t), intent(inout) :: course
    type(member_t), intent(inout) :: member(osc%members)
    type(stretch_t), intent(inout) :: stretch
    type(search_t), intent(inout) :: search
    real(dp), intent(inout) :: peak
    type(period_t), intent(inout) :: out
    type(trace_t), intent(inout), optional :: trace
    ! A hair beyond the zero, as the zero itself is on neither side; the force is continuous there. What
    ! is closer is gone without a step of its own.
    real(dp), parameter :: hair = 1e-13_dp, close = 1e-7_dp
    integer, parameter :: most_trials = 50
    real(dp) :: error(0:2), overlap, slope, miss, approach

    associate (part => search%part, sense => member(search%member)%sense(l))
      error = shape_of(course%error(:, search%member), stretch%left(l) + stretch%width(l))
      overlap = sense*(stretch%x(l, 2) - error(0))
      slope = sense*search%room*(table%width(i)*stretch%y(l, 2) - error(1))
      miss = huge(miss)
      if (slope < 0) miss = hair - overlap/slope
      if (abs(miss) <= close) then
        call move_end(osc, table, i, l, duration, min(miss, 1 - part)*search%room, stretch)
      else
        if (overlap > 0) then
          search%low = part
        else
          search%high = part
        end if
        search%trials = search%trials + 1
        if (search%high - search%low > hair .and. search%trials < most_trials) then
          part = part + miss
          if (.not. (part > search%low .and. part < search%high)) part = (search%low + search%high)/2
          stretch%width(l) = part*search%room
          return
        end if
      end if
      call accept(osc, table, i, l, duration, course, member, stretch, search, peak, trace)
      error = shape_of(course%error(:, search%member), stretch%left(l))
      approach = stretch%y(l, 1) - error(1)/table%width(i)
      search%before = stretch%square(l, size(places))
      search%ratio = 0
      if (abs(approach) > 0) search%ratio = stretch%y(l, 1)/approach
    end associate
    call set_contact(osc, l, search%member, .not. course%contact(search%member), member(search%member))
    call touching(member, l, course%contact)
    call note_contact(osc, course%contact, out)
    search%member = 0
    search%events = search%events + 1
    out%events = out%events + 1
    out%work = out%work + cost
  end subroutine close_in

  !> Moves the end of the stretch of lane l by a tiny part of the step.
  pure subroutine move_end(osc, table, i, l, duration, part, stretch)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: i, l
    real(dp), intent(in) :: duration, part
    type(stretch_t), intent(inout) :: stretch
    real(dp) :: bend, by

    by = part*table%width(i)
    bend = curvature(osc, l, size(places), duration, stretch)
    stretch%width(l) = stretch%width(l) + part
    stretch%x(l, 2) = stretch%x(l, 2) + by*(stretch%y(l, 2) + by/2*bend)
    stretch%y(l, 2) = stretch%y(l, 2) + by*bend
    associate (map => stretch%map(l, :), square => stretch%square(l, size(places)))
      map([1, 3]) = map([1, 3]) + by*map([2, 4])
      map([2, 4]) = map([2, 4]) - by*(duration**2*square*map([1, 3]) + 2*osc%damping_ratio*duration*sqrt(square)*map([2, 4]))
    end associate
  end subroutine move_end

  !> Second derivative of the motion over the phase at an end of the stretch of lane l, its place k.
  pure real(dp) function curvature(osc, l, k, duration, stretch)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: l, k
    real(dp), intent(in) :: duration
    type(stretch_t), intent(in) :: stretch
    integer :: end

    end = merge(1, 2, k == 1)
    curvature = acceleration(osc, stretch%square(l, k), stretch%push(l, k), duration, stretch%x(l, end), stretch%y(l, end))
  end function curvature

  !> Value, first and second derivative over the stretch of lane l, at both ends, of the motion.
  pure function motion_of(osc, table, i, l, duration, stretch) result(f)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: i, l
    real(dp), intent(in) :: duration
    type(stretch_t), intent(in) :: stretch
    real(dp) :: f(0:2, 2)

    associate (width => stretch%width(l)*table%width(i))
      f(0, :) = stretch%x(l, :)
      f(1, :) = width*stretch%y(l, :)
      f(2, 1) = width**2*curvature(osc, l, 1, duration, stretch)
      f(2, 2) = width**2*curvature(osc, l, size(places), duration, stretch)
    end associate
  end function motion_of

  !> The same of a quintic over the step.
  pure function ends_of(stretch, l, c) result(f)
    type(stretch_t), intent(in) :: stretch
    integer, intent(in) :: l
    real(dp), intent(in) :: c(0:5)
    real(dp) :: f(0:2, 2), scale(0:2)

    scale = [1.0_dp, stretch%width(l), stretch%width(l)**2]
    f(:, 1) = scale*shape_of(c, stretch%left(l))
    f(:, 2) = scale*shape_of(c, stretch%left(l) + stretch%width(l))
  end function ends_of

  !> Moves lane l to the end of its stretch; the next one goes to the end of the step.
  pure subroutine accept(osc, table, i, l, duration, course, member, stretch, search, peak, trace)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: i, l
    real(dp), intent(in) :: duration
    type(course_t), intent(inout) :: course
    type(member_t), intent(in) :: member(osc%members)
    type(stretch_t), intent(inout) :: stretch
    type(search_t), intent(inout) :: search
    real(dp), intent(inout) :: peak
    type(trace_t), intent(inout), optional :: trace
    real(dp), dimension(0:2, 2) :: motion, stiffness, gap, load
    integer :: j

    call touching(member, l, course%contact)
    motion = motion_of(osc, table, i, l, duration, stretch)
    do j = 1, table%pairs(i)
      if (.not. course%contact(j)) cycle
      stiffness = ends_of(stretch, l, course%stiffness(:, j))
      gap = motion - ends_of(stretch, l, course%error(:, j))
      load(0, :) = stiffness(0, :)*gap(0, :)
      load(1, :) = stiffness(1, :)*gap(0, :) + stiffness(0, :)*gap(1, :)
      load(2, :) = stiffness(2, :)*gap(0, :) + 2*stiffness(1, :)*gap(1, :) + stiffness(0, :)*gap(2, :)
      peak = max(peak, load(0, 1), load(0, 2))
      if (may_top(load, peak)) call raise_to_top(load, peak)
    end do
    if (present(trace)) call note(table, i, l, course, stretch, trace)
    search%map = chained(stretch%map(l, :4), search%map)
    stretch%x(l, 1) = stretch%x(l, 2)
    stretch%y(l, 1) = stretch%y(l, 2)
    stretch%left(l) = stretch%left(l) + stretch%width(l)
    stretch%width(l) = max(0.0_dp, 1 - stretch%left(l))
  end subroutine accept

  !> The map of a stretch after that of what was before; columns one after the other.
  pure function chained(map, before) result(c)
    real(dp), intent(in) :: map(4), before(4)
    real(dp) :: c(4)

    c(1) = map(1)*before(1) + map(3)*before(2)
    c(2) = map(2)*before(1) + map(4)*before(2)
    c(3) = map(1)*before(3) + map(3)*before(4)
    c(4) = map(2)*before(3) + map(4)*before(4)
  end function chained

  pure subroutine note(table, i, l, course, stretch, trace)
    type(table_t), intent(in) :: table
    integer, intent(in) :: i, l
    type(course_t), intent(in) :: course
    type(stretch_t), intent(in) :: stretch
    type(trace_t), intent(inout) :: trace
    real(dp) :: ends(2)
    integer :: j, k

    ends = stretch%left(l) + [0.0_dp, stretch%width(l)]
    associate (pairs => table%pairs(i))
      call record(trace, pairs, table%left(i) + table%width(i)*ends, stretch%x(l, :), &
        reshape([((value_of(course%stiffness(:, j), ends(k)), j=1, pairs), k=1, 2)], [pairs, 2]), &
        reshape([((value_of(course%error(:, j), ends(k)), j=1, pairs), k=1, 2)], [pairs, 2]), course%contact)
    end associate
  end subroutine note
end module gearsweep_contact
