!> Changes of contact within a step, in the lanes that have them: where they are, and what the motion and
!> its map do there. Each lane goes through the step in stretches of its own, from one change to the next;
!> the vectors carry the stretches of all lanes.
module gearsweep_contact
  use gearsweep_kinds, only: dp
  use gearsweep_gauss, only: lanes
  use gearsweep_motion, only: oscillator_t, table_t
  use gearsweep_quintic, only: evaluate, first_zero, may_pass, quintic, slope_of, value_of
  use gearsweep_peaks, only: may_top, raise_to_top
  use gearsweep_step, only: period_t, member_t, touches, set_contact, note_contact
  use gearsweep_stretch, only: crossing_t, search_t, make_crossing, take_step, sum_up, follow, move_end, slopes_of, bends_of, &
                               motion_bends, last
  use gearsweep_trace, only: trace_t, record
  implicit none
  private
  public :: crossing_t, make_crossing, cross

  !> Changes of contact within one step, and beyond those of free oscillation
  !> within one period; with more, contact chatters.
  integer, parameter :: most_events = 40, most_extra = 1000

  !> What one change costs, in steps.
  real(dp), parameter :: cost = 20

  !> A hair beyond the zero of an overlap, as the zero itself is on neither side; the force is continuous
  !> there.
  real(dp), parameter :: hair = 1e-13_dp

contains

  !> Takes the lanes `changes` through step i, which begins at x_start, y_start and would end at x, y after
  !> `map`. Where contact does change, these become what they are then; `changes` tells. The peaks are not
  !> wanted everywhere.
  pure subroutine cross(osc, table, i, x_start, y_start, changes, peaks, c, touch, member, x, y, map, peak, out, trace)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: i
    real(dp), intent(in), dimension(lanes) :: x_start, y_start
    logical, intent(inout) :: changes(lanes)
    logical, intent(in) :: peaks
    type(crossing_t), intent(inout) :: c
    integer, intent(inout) :: touch(lanes)
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
    c%peaks = peaks
    c%touch = touch
    c%x(:, 1) = x_start
    c%y(:, 1) = y_start
    c%x(:, 2) = x
    c%y(:, 2) = y
    call sum_up(osc, table, member, 1, c)
    call sum_up(osc, table, member, last, c)
    do
      do l = 1, c%n
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
    do l = 1, c%n
      if (.not. changes(l)) cycle
      x(l) = c%x(l, 1)
      y(l) = c%y(l, 1)
      map(l, :4) = c%search(l)%map
      touch(l) = c%touch(l)
    end do
  end subroutine cross

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
        call accept(osc, table, l, c, peak, trace)
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
    real(dp) :: motion(0:1, 2), overlap(0:2, 2), zero
    logical :: found
    integer :: j

    part = 1
    which = 0
    if (.not. c%width(l) > 0) return
    motion(0, :) = c%x(l, :)
    motion(1, :) = c%width(l)*table%width(c%i)*c%y(l, :)
    do j = 1, osc%members
      if (j > table%pairs(c%i) .and. j <= osc%pairs) cycle
      overlap(:1, :) = member(j)%sense(l)*(motion - slopes_of(c, l, c%error(:, j)))
      if (.not. may_pass(overlap(0, 1), overlap(0, 2), overlap(1, 1), overlap(1, 2))) cycle
      overlap(2, :) = member(j)%sense(l)*(motion_bends(osc, table, l, c) - bends_of(c, l, c%error(:, j)))
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
    real(dp) :: error, error_slope, overlap, slope, miss

    associate (search => c%search(l), sense => member(c%search(l)%member)%sense(l))
      call evaluate(c%error(:, search%member), c%left(l) + c%width(l), error, error_slope)
      overlap = sense*(c%x(l, 2) - error)
      slope = sense*search%room*(table%width(c%i)*c%y(l, 2) - error_slope)
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
    call accept(osc, table, l, c, peak, trace)
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
    real(dp) :: approach

    associate (search => c%search(l), j => c%search(l)%member)
      approach = c%y(l, 1) - slope_of(c%error(:, j), c%left(l))/table%width(c%i)
      search%jumps = abs(approach) > 0
      if (search%jumps) search%ratio = c%y(l, 1)/approach
      search%before = c%square(l, last)
      call set_contact(osc, l, j, .not. touches(c%touch(l), j), c%touch(l), member(j))
      call note_contact(osc, c%touch(l), out)
      search%events = search%events + 1
      search%member = 0
    end associate
    out%events = out%events + 1
    out%work = out%work + cost
  end subroutine switch_contact

  !> Moves lane l to the end of its stretch, and begins the next one.
  pure subroutine accept(osc, table, l, c, peak, trace)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: l
    type(crossing_t), intent(inout) :: c
    real(dp), intent(inout) :: peak
    type(trace_t), intent(inout), optional :: trace

    if (c%peaks) call raise_peak(osc, table, l, c, peak)
    if (present(trace)) call note(osc, table, l, c, trace)
    c%search(l)%map = chained(c%map(l, :4), c%search(l)%map)
    c%x(l, 1) = c%x(l, 2)
    c%y(l, 1) = c%y(l, 2)
    c%left(l) = c%left(l) + c%width(l)
    c%width(l) = max(0.0_dp, min(1 - c%left(l), c%longest(l)))
  end subroutine accept

  !> The loads over the stretch of lane l.
  pure subroutine raise_peak(osc, table, l, c, peak)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: l
    type(crossing_t), intent(in) :: c
    real(dp), intent(inout) :: peak
    real(dp) :: motion(0:1, 2), stiffness(0:1, 2), gap(0:1, 2), load(0:2, 2)
    integer :: j

    motion(0, :) = c%x(l, :)
    motion(1, :) = c%width(l)*table%width(c%i)*c%y(l, :)
    do j = 1, table%pairs(c%i)
      if (.not. touches(c%touch(l), j)) cycle
      stiffness = slopes_of(c, l, c%stiffness(:, j))
      gap = motion - slopes_of(c, l, c%error(:, j))
      load(0, :) = stiffness(0, :)*gap(0, :)
      load(1, :) = stiffness(1, :)*gap(0, :) + stiffness(0, :)*gap(1, :)
      peak = max(peak, load(0, 1), load(0, 2))
      if (.not. may_top(load, peak)) cycle
      load(2, :) = bends_of(c, l, c%stiffness(:, j))*gap(0, :) + 2*stiffness(1, :)*gap(1, :) &
                   + stiffness(0, :)*(motion_bends(osc, table, l, c) - bends_of(c, l, c%error(:, j)))
      call raise_to_top(load, peak)
    end do
  end subroutine raise_peak

  !> The map of a stretch after that of what was before; columns one after the other.
  pure function chained(map, before) result(c)
    real(dp), intent(in) :: map(:), before(4)
    real(dp) :: c(4)

    c(1) = map(1)*before(1) + map(3)*before(2)
    c(2) = map(2)*before(1) + map(4)*before(2)
    c(3) = map(1)*before(3) + map(3)*before(4)
    c(4) = map(2)*before(3) + map(4)*before(4)
  end function chained

  pure subroutine note(osc, table, l, c, trace)
    type(oscillator_t), intent(in) :: osc
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
        reshape([((value_of(c%error(:, j), ends(k)), j=1, pairs), k=1, 2)], [pairs, 2]), &
        [(touches(c%touch(l), j), j=1, osc%members)])
    end associate
  end subroutine note
end module gearsweep_contact
