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
  public :: crossing_t, make_crossing, cross

  !> Changes of contact within one step, and beyond those of free oscillation
  !> within one period; with more, contact chatters.
  integer, parameter :: most_events = 40, most_extra = 1000

  !> What one change costs, in steps.
  real(dp), parameter :: cost = 20

  !> Places in a stretch at which its coefficients are known: both ends, and the nodes between.
  real(dp), parameter :: places(5) = [0.0_dp, nodes, 1.0_dp]
  integer, parameter :: last = size(places)

  !> A hair beyond the zero of an overlap, as the zero itself is on neither side; the force is continuous
  !> there.
  real(dp), parameter :: hair = 1e-13_dp

  !> What a lane does in its step.
  type :: search_t
    logical :: active = .false.
    logical :: begun = .false.                   !< it goes in stretches: its contact does change
    integer :: member = 0                        !< closing in on its change; 0: looking for one
    integer :: trials = 0, events = 0
    real(dp) :: room = 1, part = 1, low = 0, high = 1   !< the stretch looked at; guess and bounds as parts of it
    logical :: jumps = .false.                   !< contact has just changed:
    real(dp) :: before = 0, ratio = 0            !< w^2 before, y over the speed of approach
    real(dp) :: map(4) = [1, 0, 0, 1]            !< of the stretches so far
  end type search_t

  !> Lanes on their way through step `i`. Stiffness and profile error are quintics through what the table
  !> knows of the step's ends, (0:5, pair) and (0:5, member), the mobility is linear, (0:1, pair). A stretch
  !> is a part of the step with the contact as it is; its places count from 0 to 1 over the step.
  type :: crossing_t
    integer :: i = 0, lanes = 0
    real(dp), allocatable :: stiffness(:, :), error(:, :), mobility(:, :)
    real(dp), dimension(lanes) :: duration = 0, longest = 1
    type(search_t) :: search(lanes)
    real(dp), dimension(lanes) :: left = 0, width = 0
    real(dp), dimension(lanes, last) :: square = 0, push = 0           !< w^2 and sum of k e
    real(dp), dimension(lanes, 2) :: x = 0, y = 0                      !< at the stretch's ends
    real(dp) :: map(lanes, 6) = 0
    logical, allocatable :: contact(:)                                 !< of the lane at hand
  end type crossing_t

contains

  !> Room for the steps of a period at `n` speeds.
  pure subroutine make_crossing(osc, n, duration, c)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: n
    real(dp), intent(in) :: duration(lanes)
    type(crossing_t), intent(out) :: c

    c%lanes = n
    c%duration = duration
    allocate (c%stiffness(0:5, osc%pairs), c%error(0:5, osc%members), c%mobility(0:1, osc%pairs))
    allocate (c%contact(osc%members))
  end subroutine make_crossing

  !> Takes the lanes `changes` through step i, which begins at `start` and would end at x, y after `map`.
  !> Where contact does change, these become what they are then; `changes` tells.
  pure subroutine cross(osc, table, i, start, changes, c, member, x, y, map, peak, out, trace)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: i
    real(dp), intent(in) :: start(lanes, 2)
    logical, intent(inout) :: changes(lanes)
    type(crossing_t), intent(inout) :: c
    type(member_t), intent(inout) :: member(osc%members)
    real(dp), intent(inout) :: x(lanes), y(lanes), map(lanes, 6), peak(lanes)
    type(period_t), intent(inout) :: out(lanes)
    type(trace_t), intent(inout), optional :: trace
    integer :: l

    call take_step(osc, table, i, c)
    c%search = search_t()
    c%search%active = changes
    c%left = 0
    c%width = 1
    c%x(:, 1) = start(:, 1)
    c%y(:, 1) = start(:, 2)
    c%x(:, 2) = x
    c%y(:, 2) = y
    call sum_up(osc, table, member, 1, c)
    call sum_up(osc, table, member, last, c)
    do
      do l = 1, c%lanes
        if (.not. c%search(l)%active) cycle
        if (c%search(l)%member == 0) then
          call look(osc, table, l, member, c, peak(l), out(l), trace)
        else
          call close_in(osc, table, l, member, c, peak(l), out(l), trace)
        end if
      end do
      if (.not. any(c%search%active)) exit
      call follow(osc, table, member, c)
    end do
    changes = c%search%begun
    do l = 1, c%lanes
      if (.not. changes(l)) cycle
      x(l) = c%x(l, 1)
      y(l) = c%y(l, 1)
      map(l, :4) = c%search(l)%map
    end do
  end subroutine cross

  pure subroutine take_step(osc, table, i, c)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: i
    type(crossing_t), intent(inout) :: c
    real(dp) :: scale(0:2)
    integer :: j

    c%i = i
    scale = [1.0_dp, table%width(i), table%width(i)**2]
    do j = 1, table%pairs(i)
      c%stiffness(:, j) = quintic(scale*table%end_stiffness(:, j, 1, i), scale*table%end_stiffness(:, j, 2, i))
      associate (left => table%left(i) + j - 1, recess => osc%zones(table%zone(i))%recess(j))
        c%mobility(0, j) = mobility(osc, left, recess)
        c%mobility(1, j) = mobility(osc, left + table%width(i), recess) - c%mobility(0, j)
      end associate
    end do
    do j = 1, osc%members
      c%error(:, j) = quintic(scale*table%end_error(:, j, 1, i), scale*table%end_error(:, j, 2, i))
    end do
    if (osc%damping_ratio > 1) c%longest = longest_stretch(osc, c%duration*table%width(i))
  end subroutine take_step

  !> The longest stretch as a part of a step of this time (s), under strong damping. Changes of contact cut
  !> stretches to the same length in every table, so that step doubling does not tell their error: where
  !> contact lasts shorter than a step, and drag changes the motion within it, they are made short.
  elemental real(dp) function longest_stretch(osc, time)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: time
    real(dp), parameter :: decay = 0.05_dp

    longest_stretch = 1
    if (time > 0) longest_stretch = min(1.0_dp, decay/(2*osc%damping_ratio*osc%highest_frequency*time))
  end function longest_stretch

  !> Sums over the members in contact at the place k of the stretches: w^2 and sum of k e.
  pure subroutine sum_up(osc, table, member, k, c)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    type(member_t), intent(in) :: member(osc%members)
    integer, intent(in) :: k
    type(crossing_t), intent(inout) :: c
    real(dp) :: place(lanes), square(lanes), push(lanes), slack(0:5)
    integer :: j

    place = c%left + c%width*places(k)
    square = 0
    push = 0
    do j = 1, table%pairs(c%i)
      call add_pair(c%lanes, c%stiffness(:, j), c%error(:, j), c%mobility(:, j), place, member(j)%weight, square, push)
    end do
    if (osc%has_backlash) then
      slack = 0
      slack(0) = -osc%backlash
      do j = 1, table%pairs(c%i)
        call add_pair(c%lanes, c%stiffness(:, j), slack, [sum(1/osc%mass), 0.0_dp], place, member(osc%members)%weight, &
                      square, push)
      end do
    end if
    c%square(:, k) = square
    c%push(:, k) = push
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

  !> The motion over the stretches, whose places are set; no lane is harmed by one of no width.
  pure subroutine follow(osc, table, member, c)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    type(member_t), intent(in) :: member(osc%members)
    type(crossing_t), intent(inout) :: c
    real(dp), dimension(lanes, size(nodes)) :: square, drag, push
    real(dp) :: time, width, load
    integer :: k, l

    do k = 1, last
      call sum_up(osc, table, member, k, c)
    end do
    load = osc%load*sum(1/osc%mass)
    do k = 1, size(nodes)
      do l = 1, c%lanes
        time = c%duration(l)*(c%width(l)*table%width(c%i))
        square(l, k) = time**2*c%square(l, k + 1)
        drag(l, k) = 2*osc%damping_ratio*time*sqrt(c%square(l, k + 1))
        push(l, k) = time**2*(c%push(l, k + 1) + load)
      end do
    end do
    call collocate(c%lanes, square, drag, push, c%map)
    do l = 1, c%lanes
      width = c%width(l)*table%width(c%i)
      c%map(l, 2) = c%map(l, 2)/max(width, tiny(width))
      c%map(l, 3) = c%map(l, 3)*width
      c%map(l, 6) = c%map(l, 6)/max(width, tiny(width))
      c%x(l, 2) = c%map(l, 1)*c%x(l, 1) + c%map(l, 3)*c%y(l, 1) + c%map(l, 5)
      c%y(l, 2) = c%map(l, 2)*c%x(l, 1) + c%map(l, 4)*c%y(l, 1) + c%map(l, 6)
    end do
  end subroutine follow

  !> Lane l, whose contact stays as it is over its stretch if there is no change in it: closes in on the
  !> first one, goes on, or is through.
  pure subroutine look(osc, table, l, member, c, peak, out, trace)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: l
    type(member_t), intent(in) :: member(osc%members)
    type(crossing_t), intent(inout) :: c
    real(dp), intent(inout) :: peak
    type(period_t), intent(inout) :: out
    type(trace_t), intent(inout), optional :: trace
    real(dp) :: part
    logical :: through
    integer :: which

    call find_change(osc, table, l, member, c, part, which)
    associate (search => c%search(l))
      if (search%jumps) call jump(osc, l, c)
      if (.not. search%begun) then
        search%active = which > 0
        search%begun = search%active
        if (.not. search%begun) return
        c%width(l) = c%longest(l)
        if (c%width(l) < 1) return
      end if
      if (which > 0) then
        out%failed = search%events == most_events .or. &
                     out%events > most_extra + osc%members*osc%highest_frequency*c%duration(l)
        search%active = .not. out%failed
        search%member = which
        search%trials = 0
        search%room = c%width(l)
        search%part = max(part, hair)
        search%low = 0
        search%high = 1
        c%width(l) = search%part*search%room
      else
        through = c%width(l) >= 1 - c%left(l)
        call accept(osc, table, l, member, c, peak, trace)
        search%active = .not. through
      end if
    end associate
  end subroutine look

  !> Only damping jumps with the contact, which the map feels through the moment of the change (saltation).
  pure subroutine jump(osc, l, c)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: l
    type(crossing_t), intent(inout) :: c
    real(dp) :: drag

    associate (search => c%search(l))
      drag = 2*osc%damping_ratio*c%duration(l)*(sqrt(c%square(l, 1)) - sqrt(search%before))
      search%map(2::2) = search%map(2::2) - drag*search%ratio*search%map(1::2)
      search%jumps = .false.
    end associate
  end subroutine jump

  !> The first change of contact in the stretch of lane l: its place as a part of it and the member; 0
  !> where there is none.
  pure subroutine find_change(osc, table, l, member, c, part, which)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: l
    type(member_t), intent(in) :: member(osc%members)
    type(crossing_t), intent(in) :: c
    real(dp), intent(out) :: part
    integer, intent(out) :: which
    real(dp) :: motion(0:2, 2), overlap(0:2, 2), zero
    logical :: found
    integer :: j

    part = 1
    which = 0
    if (.not. c%width(l) > 0) return
    motion = motion_of(osc, table, l, c)
    do j = 1, osc%members
      if (j > table%pairs(c%i) .and. j <= osc%pairs) cycle
      overlap = member(j)%sense(l)*(motion - ends_of(c, l, c%error(:, j)))
      if (.not. may_pass(overlap(0, 1), overlap(0, 2), overlap(1, 1), overlap(1, 2))) cycle
      call first_zero(quintic(overlap(:, 1), overlap(:, 2)), zero, found)
      if (.not. found .or. zero >= part) cycle
      part = zero
      which = j
    end do
  end subroutine find_change

  !> Lane l, whose stretch ends near the change of a member's contact: goes on from where its overlap has
  !> just changed its sign, or moves the end of the stretch.
  pure subroutine close_in(osc, table, l, member, c, peak, out, trace)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: l
    type(member_t), intent(inout) :: member(osc%members)
    type(crossing_t), intent(inout) :: c
    real(dp), intent(inout) :: peak
    type(period_t), intent(inout) :: out
    type(trace_t), intent(inout), optional :: trace
    ! What is closer is gone without a stretch of its own.
    real(dp), parameter :: close = 1e-7_dp
    integer, parameter :: most_trials = 50
    real(dp) :: error(0:2), overlap, slope, miss

    associate (search => c%search(l), sense => member(c%search(l)%member)%sense(l))
      error = shape_of(c%error(:, search%member), c%left(l) + c%width(l))
      overlap = sense*(c%x(l, 2) - error(0))
      slope = sense*search%room*(table%width(c%i)*c%y(l, 2) - error(1))
      miss = huge(miss)
      if (slope < 0) miss = hair - overlap/slope
      if (abs(miss) <= close) then
        call move_end(osc, table, l, min(miss, 1 - search%part)*search%room, c)
      else
        if (overlap > 0) then
          search%low = search%part
        else
          search%high = search%part
        end if
        search%trials = search%trials + 1
        if (search%high - search%low > hair .and. search%trials < most_trials) then
          search%part = search%part + miss
          if (.not. (search%part > search%low .and. search%part < search%high)) search%part = (search%low + search%high)/2
          c%width(l) = search%part*search%room
          return
        end if
      end if
    end associate
    call accept(osc, table, l, member, c, peak, trace)
    call switch_contact(osc, table, l, member, c, out)
  end subroutine close_in

  !> Switches the contact of the member that lane l has closed in on.
  pure subroutine switch_contact(osc, table, l, member, c, out)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: l
    type(member_t), intent(inout) :: member(osc%members)
    type(crossing_t), intent(inout) :: c
    type(period_t), intent(inout) :: out
    real(dp) :: error(0:2), approach

    associate (search => c%search(l), j => c%search(l)%member)
      error = shape_of(c%error(:, j), c%left(l))
      approach = c%y(l, 1) - error(1)/table%width(c%i)
      search%jumps = abs(approach) > 0
      if (search%jumps) search%ratio = c%y(l, 1)/approach
      search%before = c%square(l, last)
      c%contact(j) = .not. c%contact(j)
      call set_contact(osc, l, j, c%contact(j), member(j))
      call note_contact(osc, c%contact, out)
      search%events = search%events + 1
      search%member = 0
    end associate
    out%events = out%events + 1
    out%work = out%work + cost
  end subroutine switch_contact

  !> Moves the end of the stretch of lane l by a tiny part of the step.
  pure subroutine move_end(osc, table, l, part, c)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: l
    real(dp), intent(in) :: part
    type(crossing_t), intent(inout) :: c
    real(dp) :: bend, by, square, drag

    by = part*table%width(c%i)
    bend = curvature(osc, l, last, c)
    c%width(l) = c%width(l) + part
    c%x(l, 2) = c%x(l, 2) + by*(c%y(l, 2) + by/2*bend)
    c%y(l, 2) = c%y(l, 2) + by*bend
    square = c%duration(l)**2*c%square(l, last)
    drag = 2*osc%damping_ratio*c%duration(l)*sqrt(c%square(l, last))
    c%map(l, 1:3:2) = c%map(l, 1:3:2) + by*c%map(l, 2:4:2)
    c%map(l, 2:4:2) = c%map(l, 2:4:2) - by*(square*c%map(l, 1:3:2) + drag*c%map(l, 2:4:2))
  end subroutine move_end

  !> Second derivative of the motion over the phase at an end of the stretch of lane l, its place k.
  pure real(dp) function curvature(osc, l, k, c)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: l, k
    type(crossing_t), intent(in) :: c
    integer :: end

    end = merge(1, 2, k == 1)
    curvature = acceleration(osc, c%square(l, k), c%push(l, k), c%duration(l), c%x(l, end), c%y(l, end))
  end function curvature

  !> Value, first and second derivative over the stretch of lane l, at both ends, of the motion.
  pure function motion_of(osc, table, l, c) result(f)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: l
    type(crossing_t), intent(in) :: c
    real(dp) :: f(0:2, 2), width

    width = c%width(l)*table%width(c%i)
    f(0, :) = c%x(l, :)
    f(1, :) = width*c%y(l, :)
    f(2, 1) = width**2*curvature(osc, l, 1, c)
    f(2, 2) = width**2*curvature(osc, l, last, c)
  end function motion_of

  !> The same of a quintic over the step.
  pure function ends_of(c, l, q) result(f)
    type(crossing_t), intent(in) :: c
    integer, intent(in) :: l
    real(dp), intent(in) :: q(0:5)
    real(dp) :: f(0:2, 2), scale(0:2)

    scale = [1.0_dp, c%width(l), c%width(l)**2]
    f(:, 1) = scale*shape_of(q, c%left(l))
    f(:, 2) = scale*shape_of(q, c%left(l) + c%width(l))
  end function ends_of

  !> Moves lane l to the end of its stretch, and begins the next one.
  pure subroutine accept(osc, table, l, member, c, peak, trace)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: l
    type(member_t), intent(in) :: member(osc%members)
    type(crossing_t), intent(inout) :: c
    real(dp), intent(inout) :: peak
    type(trace_t), intent(inout), optional :: trace
    real(dp), dimension(0:2, 2) :: motion, stiffness, gap, load
    integer :: j

    call touching(member, l, c%contact)
    motion = motion_of(osc, table, l, c)
    do j = 1, table%pairs(c%i)
      if (.not. c%contact(j)) cycle
      stiffness = ends_of(c, l, c%stiffness(:, j))
      gap = motion - ends_of(c, l, c%error(:, j))
      load(0, :) = stiffness(0, :)*gap(0, :)
      load(1, :) = stiffness(1, :)*gap(0, :) + stiffness(0, :)*gap(1, :)
      load(2, :) = stiffness(2, :)*gap(0, :) + 2*stiffness(1, :)*gap(1, :) + stiffness(0, :)*gap(2, :)
      peak = max(peak, load(0, 1), load(0, 2))
      if (may_top(load, peak)) call raise_to_top(load, peak)
    end do
    if (present(trace)) call note(table, l, c, trace)
    c%search(l)%map = chained(c%map(l, :4), c%search(l)%map)
    c%x(l, 1) = c%x(l, 2)
    c%y(l, 1) = c%y(l, 2)
    c%left(l) = c%left(l) + c%width(l)
    c%width(l) = max(0.0_dp, min(1 - c%left(l), c%longest(l)))
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

  pure subroutine note(table, l, c, trace)
    type(table_t), intent(in) :: table
    integer, intent(in) :: l
    type(crossing_t), intent(in) :: c
    type(trace_t), intent(inout) :: trace
    real(dp) :: ends(2)
    integer :: j, k

    ends = c%left(l) + [0.0_dp, c%width(l)]
    associate (i => c%i, pairs => table%pairs(c%i))
      call record(trace, pairs, table%left(i) + table%width(i)*ends, c%x(l, :), &
        reshape([((value_of(c%stiffness(:, j), ends(k)), j=1, pairs), k=1, 2)], [pairs, 2]), &
        reshape([((value_of(c%error(:, j), ends(k)), j=1, pairs), k=1, 2)], [pairs, 2]), c%contact)
    end associate
  end subroutine note
end module gearsweep_contact
