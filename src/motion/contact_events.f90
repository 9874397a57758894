!> Changes of contact within a step (events): detected, bracketed and accepted one by one.
!>
!> The motion and its propagator follow from the sub-steps between the events. Only the speeds of a batch with events take part.
!> Loads are those of the pairs, followed with backlash by those of the coast sides, at both ends of a step or sub-step with first
!> and second derivative over it. A trace also records the overlaps of all contacts over a step or sub-step.
module gearsweep_motion_contact_events
  use gearsweep_base, only: derivative_of, dp, evaluate, first_zero, may_cross_zero, quintic
  use gearsweep_motion_coefficients, only: need_law
  use gearsweep_motion_contact_set, only: in_contact, period_t, record_contact, set_contact
  use gearsweep_motion_gauss, only: batch_size
  use gearsweep_motion_integrator, only: derivatives, enter_step, integrator_t, load_over, may_have_more, motion_over_sub_step, &
    move_end, need_curves, raise_peak, range_of_motion, sum_contacts, take_sub_step
  use gearsweep_motion_load_peaks, only: load_over_step, may_exceed, motion_over_step, raise_to_maximum
  use gearsweep_motion_oscillator, only: damping, resolving_steps, touches_coast
  use gearsweep_motion_period_map, only: event_t, last, period_map_t, sub_steps_t
  use gearsweep_motion_trace, only: overlaps_t, record, trace_t, watch_contact
  implicit none
  private
  public :: loads_over_step, raise_coast_over_step, watch_step, locate_events

  !> Largest number of events within one step, and within one period beyond those of free oscillation; contact with more events
  !> chatters.
  integer, parameter :: most_events = 40, most_extra = 1000

  !> Computing time of an event, in steps.
  real(dp), parameter :: cost = 20

  !> Overlap beyond zero at which an event is accepted: at zero itself the side is undefined. The force is continuous there.
  real(dp), parameter :: tolerance = 1e-13_dp

contains

  !> Computes the motion and the loads over a step without a change of contact.
  pure subroutine loads_over_step(map, step, contact_set, duration, state, x, load)
    type(period_map_t), intent(inout) :: map
    integer, intent(in) :: step, contact_set
    real(dp), intent(in) :: duration             !< duration of the mesh period, s
    real(dp), intent(in) :: state(2, 2)          !< x and its derivative over the phase (m) at both ends; (x or y, end)
    real(dp), intent(out) :: x(0:2, 2)           !< m; (derivative, end)
    real(dp), intent(out) :: load(0:2, map%osc%contacts, 2)  !< N; (derivative, contact, end)
    real(dp) :: of_contact(0:2, 2)
    integer :: j, law

    call need_law(map%osc, step, contact_set, map%table, law)
    call motion_over_step(map%osc, map%table, step, law, duration, state, x)
    load = 0
    do j = 1, map%osc%contacts
      if (.not. in_contact(contact_set, j)) cycle
      call load_over_step(map%table, step, law, j, x, of_contact)
      load(:, j, :) = merge(-of_contact, of_contact, j > map%osc%pairs)
    end do
  end subroutine loads_over_step

  !> Computes the motion and the loads over the sub-step of one motion of a batch.
  pure subroutine loads_over_sub_step(map, l, c, contact_set, x, load)
    type(period_map_t), intent(in) :: map
    integer, intent(in) :: l                     !< index of the speed in the batch
    type(sub_steps_t), intent(in) :: c
    integer, intent(in) :: contact_set           !< contact set of the motion
    real(dp), intent(out) :: x(0:2, 2)           !< m; (derivative, end)
    real(dp), intent(out) :: load(0:2, map%osc%contacts, 2)  !< N; (derivative, contact, end)
    integer :: j

    x = motion_over_sub_step(map, l, c)
    load = 0
    do j = 1, map%osc%contacts
      if (.not. in_contact(contact_set, j)) cycle
      load(:, j, :) = load_over(c%curves(c%curve(l)), j, c%left(l) + [0.0_dp, c%width(l)], x)
      if (j > map%osc%pairs) load(:, j, :) = -load(:, j, :)
    end do
  end subroutine loads_over_sub_step

  !> Raises the largest load on the coast sides by that over a step, where they are in contact.
  pure subroutine raise_coast_over_step(map, step, contact_set, duration, state, peak)
    type(period_map_t), intent(inout) :: map
    integer, intent(in) :: step, contact_set
    real(dp), intent(in) :: duration             !< duration of the mesh period, s
    real(dp), intent(in) :: state(2, 2)          !< x and its derivative over the phase (m) at both ends; (x or y, end)
    real(dp), intent(inout) :: peak              !< largest load so far, N
    real(dp) :: x(0:2, 2), load(0:2, map%osc%contacts, 2)

    if (.not. touches_coast(map%osc, contact_set)) return
    call loads_over_step(map, step, contact_set, duration, state, x, load)
    call raise(sum(load(:, map%osc%pairs + 1:, :), 2), peak)
  end subroutine raise_coast_over_step

  !> Raises the largest load on the coast sides by that over a sub-step.
  pure subroutine raise_coast_over_sub_step(map, l, c, contact_set, peak)
    type(period_map_t), intent(in) :: map
    integer, intent(in) :: l                     !< index of the speed in the batch
    type(sub_steps_t), intent(in) :: c
    integer, intent(in) :: contact_set           !< contact set of the motion
    real(dp), intent(inout) :: peak              !< largest load so far, N
    real(dp) :: x(0:2, 2), load(0:2, map%osc%contacts, 2)

    if (.not. touches_coast(map%osc, contact_set)) return
    call loads_over_sub_step(map, l, c, contact_set, x, load)
    call raise(sum(load(:, map%osc%pairs + 1:, :), 2), peak)
  end subroutine raise_coast_over_sub_step

  pure subroutine raise(load, peak)
    real(dp), intent(in) :: load(0:2, 2)
    real(dp), intent(inout) :: peak

    peak = max(peak, load(0, 1), load(0, 2))
    if (may_exceed(load, peak)) call raise_to_maximum(load, peak)
  end subroutine raise

  !> Records the overlaps over a step without events, of the first motion of the map.
  pure subroutine watch_step(map, step, states, contact_set, overlaps)
    type(period_map_t), intent(inout) :: map
    integer, intent(in) :: step, contact_set
    real(dp), intent(in) :: states(2, 2)         !< states at both ends, m; (x or y, end)
    type(overlaps_t), intent(inout) :: overlaps
    real(dp), dimension(0:2, 2) :: motion, overlap
    real(dp) :: scale(0:2)
    integer :: j, end, law

    call need_law(map%osc, step, contact_set, map%table, law)
    associate (osc => map%osc, table => map%table, width => map%table%width(step))
      scale = [1.0_dp, width, width**2]
      call motion_over_step(osc, table, step, law, map%duration(1), states, motion)
      do j = 1, osc%contacts
        if (j > table%pairs(step) .and. j <= osc%pairs) cycle
        do end = 1, 2
          overlap(:, end) = motion(:, end) - scale*table%touching(:, j, end, law)
        end do
        if (j > osc%pairs) overlap = -overlap
        call watch_contact(j, table%left(step) + [0.0_dp, width], breaks_at(map, step), overlap, overlaps)
      end do
    end associate
  end subroutine watch_step

  !> True for the start and for the end of a step at a break; (2).
  pure function breaks_at(map, step) result(breaks)
    type(period_map_t), intent(in) :: map
    integer, intent(in) :: step
    logical :: breaks(2)

    breaks(1) = map%table%kind(step)%begins
    breaks(2) = step == map%table%steps
    if (.not. breaks(2)) breaks(2) = map%table%kind(step + 1)%begins
  end function breaks_at

  !> Records the overlaps over the sub-step of motion l.
  pure subroutine watch_sub_step(map, l, c, overlaps)
    type(period_map_t), intent(in) :: map
    integer, intent(in) :: l
    type(sub_steps_t), intent(in) :: c
    type(overlaps_t), intent(inout) :: overlaps
    real(dp), dimension(0:2, 2) :: motion, overlap
    real(dp) :: place(2)
    logical :: breaks(2)
    integer :: j

    place = c%left(l) + [0.0_dp, c%width(l)]
    breaks = breaks_at(map, c%step) .and. [.not. c%left(l) > 0, c%left(l) + c%width(l) >= 1]
    motion = motion_over_sub_step(map, l, c)
    associate (osc => map%osc, table => map%table)
      do j = 1, osc%contacts
        if (j > table%pairs(c%step) .and. j <= osc%pairs) cycle
        overlap = motion - derivatives(c%curves(c%curve(l))%touching(:, j), place)
        if (j > osc%pairs) overlap = -overlap
        call watch_contact(j, table%left(c%step) + table%width(c%step)*place, breaks, overlap, overlaps)
      end do
    end associate
  end subroutine watch_sub_step

  !> Integrates the motions whose contact may change (`state%changes`) over a step. Where it does change, updates the final state,
  !> propagator, contacts and largest loads; elsewhere sets `state%changes` to false.
  pure subroutine locate_events(map, step, state, propagator, period, trace)
    type(period_map_t), intent(inout) :: map
    integer, intent(in) :: step
    type(integrator_t), intent(inout) :: state   !< in: the end of the step is that without events
    real(dp), intent(inout) :: propagator(batch_size, 6)
    type(period_t), intent(inout) :: period(:)   !< results at each speed
    type(trace_t), intent(inout), optional :: trace    !< trace of the first motion
    integer :: l

    if (.not. allocated(state%sub_steps)) call move_alloc(map%sub_steps, state%sub_steps)
    if (.not. allocated(state%sub_steps)) allocate (state%sub_steps)
    call begin_step(map, step, state)
    do
      do l = 1, map%speeds
        if (.not. state%sub_steps%event(l)%active) cycle
        if (state%sub_steps%event(l)%contact == 0) then
          call detect(map, l, state, period(l), trace)
        else
          call bracket(map, l, state, period(l), trace)
        end if
      end do
      if (.not. any(state%sub_steps%event%active)) exit
      call take_sub_step(map, state%sub_steps)
    end do
    associate (c => state%sub_steps)
      state%changes = c%event%found
      do l = 1, map%speeds
        if (.not. state%changes(l)) cycle
        state%x(l, state%to) = c%x(l, 1)
        state%y(l, state%to) = c%y(l, 1)
        propagator(l, :4) = c%event(l)%propagator
      end do
    end associate
  end subroutine locate_events

  !> Begins a step with the complete step as the first sub-step.
  pure subroutine begin_step(map, step, state)
    type(period_map_t), intent(inout) :: map
    integer, intent(in) :: step
    type(integrator_t), intent(inout) :: state
    integer :: l

    associate (c => state%sub_steps)
      call enter_step(map, step, c)
      c%event%active = .false.
      c%event%found = .false.
      do l = 1, map%speeds
        if (.not. state%changes(l)) cycle
        c%event(l) = event_t(active=.true.)
        call need_curves(map, l, state%contact_set(l), c)
      end do
      c%left = 0
      c%width = 1
      c%x(:, 1) = state%x(:, state%from)
      c%y(:, 1) = state%y(:, state%from)
      c%x(:, 2) = state%x(:, state%to)
      c%y(:, 2) = state%y(:, state%to)
      call sum_contacts(map%speeds, 1, c)
      call sum_contacts(map%speeds, last, c)
    end associate
  end subroutine begin_step

  !> Searches for the first event in the sub-step of motion l: brackets it, or accepts the sub-step.
  pure subroutine detect(map, l, state, period, trace)
    type(period_map_t), intent(inout) :: map
    integer, intent(in) :: l
    type(integrator_t), intent(inout) :: state
    type(period_t), intent(inout) :: period
    type(trace_t), intent(inout), optional :: trace
    real(dp) :: part
    logical :: through
    integer :: which

    call find_event(map, l, state, part, which)
    associate (c => state%sub_steps, event => state%sub_steps%event(l))
      if (event%jumps) call jump(map, l, c)
      if (.not. event%found) then
        event%active = which > 0
        event%found = event%active
        if (.not. event%found) return
        c%width(l) = c%longest(l)
        if (c%width(l) < 1) return
      end if
      if (which > 0) then
        period%failed = event%events == most_events .or. &
                        period%events > most_extra + map%osc%contacts*map%osc%highest_frequency*map%duration(l)* &
                                        map%osc%mesh%deviations%periods
        event%active = .not. period%failed
        event%contact = which
        event%trials = 0
        event%length = c%width(l)
        event%part = max(part, tolerance)
        event%low = 0
        event%high = 1
        c%width(l) = event%part*event%length
      else
        through = c%width(l) >= 1 - c%left(l)
        call accept(map, l, state, trace)
        event%active = .not. through
      end if
    end associate
  end subroutine detect

  !> Adds to the propagator the jump of the damping at an event, by the derivative of the event's time (saltation).
  pure subroutine jump(map, l, c)
    type(period_map_t), intent(in) :: map
    integer, intent(in) :: l
    type(sub_steps_t), intent(inout) :: c
    real(dp) :: change

    associate (event => c%event(l))
      change = damping(map%osc, map%duration(l))*(sqrt(c%omega_squared(l, 1)) - sqrt(event%before))
      event%propagator(2::2) = event%propagator(2::2) - change*event%ratio*event%propagator(1::2)
      event%jumps = .false.
    end associate
  end subroutine jump

  !> Finds the first event in the sub-step of motion l: its place as a fraction of the sub-step, and the contact (0: no event).
  pure subroutine find_event(map, l, state, part, which)
    type(period_map_t), intent(in) :: map
    integer, intent(in) :: l
    type(integrator_t), intent(inout) :: state
    real(dp), intent(out) :: part
    integer, intent(out) :: which
    real(dp), dimension(0:2, 2) :: motion, overlap
    real(dp) :: range(2), zero
    logical :: found
    integer :: j

    part = 1
    which = 0
    associate (c => state%sub_steps, osc => map%osc, curves => state%sub_steps%curves(state%sub_steps%curve(l)))
      if (.not. c%width(l) > 0) return
      motion = motion_over_sub_step(map, l, c)
      range = range_of_motion(map, l, c)
      do j = 1, osc%contacts
        if (j > curves%pairs .and. j <= osc%pairs) cycle
        associate (sense => state%contacts(j)%sense(l))
          ! Most contacts are far from a change.
          if (sense > 0 .and. range(1) > curves%touching_bounds(2, j)) cycle
          if (sense < 0 .and. range(2) < curves%touching_bounds(1, j)) cycle
          overlap = sense*(motion - derivatives(curves%touching(:, j), c%left(l) + [0.0_dp, c%width(l)]))
          if (.not. may_cross_zero(overlap(0, 1), overlap(0, 2), overlap(1, 1), overlap(1, 2))) cycle
        end associate
        call first_zero(quintic(overlap(:, 1), overlap(:, 2)), zero, found)
        if (.not. found .or. zero >= part) cycle
        part = zero
        which = j
      end do
    end associate
  end subroutine find_event

  !> Brackets an event near the end of the sub-step of motion l: accepts the sub-step if the overlap has just changed its sign,
  !> else moves the sub-step's end.
  pure subroutine bracket(map, l, state, period, trace)
    type(period_map_t), intent(inout) :: map
    integer, intent(in) :: l
    type(integrator_t), intent(inout) :: state
    type(period_t), intent(inout) :: period
    type(trace_t), intent(inout), optional :: trace
    ! An event closer than this fraction of the length is reached by a Taylor series instead of another sub-step; the error of the
    ! series grows with the square of the distance.
    real(dp), parameter :: close = 1e-5_dp
    integer, parameter :: most_trials = 50
    real(dp) :: touching, touching_slope, overlap, slope, miss

    associate (c => state%sub_steps, event => state%sub_steps%event(l))
      associate (sense => state%contacts(event%contact)%sense(l))
        call evaluate(c%curves(c%curve(l))%touching(:, event%contact), c%left(l) + c%width(l), touching, touching_slope)
        overlap = sense*(c%x(l, 2) - touching)
        slope = sense*event%length*(map%table%width(c%step)*c%y(l, 2) - touching_slope)
      end associate
      miss = huge(miss)
      if (slope < 0) miss = tolerance - overlap/slope
      if (abs(miss) <= close) then
        call move_end(map, l, min(miss, 1 - event%part)*event%length, c)
      else
        if (overlap > 0) then
          event%low = event%part
        else
          event%high = event%part
        end if
        event%trials = event%trials + 1
        if (event%high - event%low > tolerance .and. event%trials < most_trials) then
          event%part = event%part + miss
          if (.not. (event%part > event%low .and. event%part < event%high)) event%part = (event%low + event%high)/2
          c%width(l) = event%part*event%length
          return
        end if
      end if
    end associate
    call accept(map, l, state, trace)
    call change_contact(map, l, state, period)
  end subroutine bracket

  !> Opens or closes the contact at the event that motion l has reached.
  pure subroutine change_contact(map, l, state, period)
    type(period_map_t), intent(inout) :: map
    integer, intent(in) :: l
    type(integrator_t), intent(inout) :: state
    type(period_t), intent(inout) :: period
    real(dp) :: approach

    associate (c => state%sub_steps, event => state%sub_steps%event(l))
      associate (j => event%contact)
        approach = c%y(l, 1) - derivative_of(c%curves(c%curve(l))%touching(:, j), c%left(l))/map%table%width(c%step)
        event%jumps = abs(approach) > 0
        if (event%jumps) event%ratio = c%y(l, 1)/approach
        event%before = c%omega_squared(l, last)
        call set_contact(map%osc, l, j, .not. in_contact(state%contact_set(l), j), state%contact_set(l), state%contacts(j))
        call need_curves(map, l, state%contact_set(l), c)
        call record_contact(map%osc, state%contact_set(l), map%table%full(c%step), map%table%between(c%step), period)
        event%events = event%events + 1
      end associate
      period%failed = period%failed .or. excites(map, l, abs(approach), c)
      event%contact = 0
    end associate
    period%events = period%events + 1
    period%work = period%work + cost
  end subroutine change_contact

  !> True if a change of contact excites a natural motion that the remainder of the step is too long to follow.
  pure logical function excites(map, l, approach, c)
    type(period_map_t), intent(in) :: map
    integer, intent(in) :: l
    real(dp), intent(in) :: approach             ! relative speed of the flanks that meet or part, m over the phase
    type(sub_steps_t), intent(in) :: c
    ! `negligible`: amplitude of the natural motion (static deflections) that may be neglected. `near`: angle of the natural motion
    ! (rad) by which damping advances the closing and opening of pairs.
    real(dp), parameter :: negligible = 1e-7_dp, near = 4

    excites = map%table%kind(c%step)%stiff
    if (excites) excites = approach > negligible*map%osc%static_deflection*map%osc%natural_frequency*map%duration(l) .and. &
                           (1 - c%left(l))*map%table%width(c%step)*resolving_steps(map%osc, map%duration(l)) > near
  end function excites

  !> Moves motion l to the end of its sub-step, and begins the next one.
  pure subroutine accept(map, l, state, trace)
    type(period_map_t), intent(in) :: map
    integer, intent(in) :: l
    type(integrator_t), intent(inout) :: state
    type(trace_t), intent(inout), optional :: trace

    if (state%peaks) then
      call raise_over_sub_step(map, l, state%sub_steps, state%peak(l))
      call raise_coast_over_sub_step(map, l, state%sub_steps, state%contact_set(l), state%coast_peak(l))
    end if
    if (present(trace)) call record_sub_step(map, l, state%contact_set(l), state%sub_steps, trace)
    associate (c => state%sub_steps)
      c%event(l)%propagator = composed(c%propagator(l, :4), c%event(l)%propagator)
      c%x(l, 1) = c%x(l, 2)
      c%y(l, 1) = c%y(l, 2)
      c%left(l) = c%left(l) + c%width(l)
      c%width(l) = max(0.0_dp, min(1 - c%left(l), c%longest(l)))
    end associate
  end subroutine accept

  !> Raises the largest load of motion l by those over its sub-step.
  pure subroutine raise_over_sub_step(map, l, c, peak)
    type(period_map_t), intent(in) :: map
    integer, intent(in) :: l
    type(sub_steps_t), intent(in) :: c
    real(dp), intent(inout) :: peak
    real(dp) :: range(2)

    range = range_of_motion(map, l, c)
    associate (curves => c%curves(c%curve(l)))
      if (may_have_more(curves, range(2), peak)) &
        call raise_peak(curves, c%left(l) + [0.0_dp, c%width(l)], motion_over_sub_step(map, l, c), peak)
    end associate
  end subroutine raise_over_sub_step

  !> Product of the propagator of a sub-step and that of the time before it; columns one after the other.
  pure function composed(propagator, before) result(c)
    real(dp), intent(in) :: propagator(:), before(4)
    real(dp) :: c(4)

    c(1) = propagator(1)*before(1) + propagator(3)*before(2)
    c(2) = propagator(2)*before(1) + propagator(4)*before(2)
    c(3) = propagator(1)*before(3) + propagator(3)*before(4)
    c(4) = propagator(2)*before(3) + propagator(4)*before(4)
  end function composed

  pure subroutine record_sub_step(map, l, contact_set, c, trace)
    type(period_map_t), intent(in) :: map
    integer, intent(in) :: l, contact_set
    type(sub_steps_t), intent(in) :: c
    type(trace_t), intent(inout) :: trace
    real(dp) :: x(0:2, 2), load(0:2, map%osc%contacts, 2)

    call loads_over_sub_step(map, l, c, contact_set, x, load)
    associate (table => map%table, i => c%step)
      associate (interval => map%osc%intervals(table%interval(i)))
        call record(trace, table%pairs(i), spread(interval%offset - interval%period, 1, 2), &
                    interval%period + (table%left(i) + table%width(i)*(c%left(l) + [0.0_dp, c%width(l)])), &
                    spread(contact_set, 1, 2), x, load)
      end associate
    end associate
    if (allocated(trace%overlaps)) call watch_sub_step(map, l, c, trace%overlaps)
  end subroutine record_sub_step
end module gearsweep_motion_contact_events
