!> One mesh period of the motion, for a batch of speeds with contact sets of their own: collocation over the mesh
!> phase in steps that end at every break. Within a step the contact set stays as it is, unless an event is located.
module gearsweep_period
  use gearsweep_coefficients, only: coefficients_t
  use gearsweep_contact_events, only: locate_events
  use gearsweep_contact_set, only: contact_t, full_contact, in_contact, period_t, record_contact, set_contact
  use gearsweep_gauss, only: batch_size
  use gearsweep_integrator, only: integrator_t
  use gearsweep_kinds, only: dp
  use gearsweep_literature_period, only: run_literature_period
  use gearsweep_load_peaks, only: add_candidate, candidate_t, settle_candidates
  use gearsweep_oscillator, only: oscillator_t
  use gearsweep_period_map, only: compose, flush_to_zero, leave_full_contact, need_propagator, period_map_t, take_step
  use gearsweep_trace, only: record, trace_t
  implicit none
  private
  public :: run_period, run_batch

  !> A height above all profile errors, m.
  real(dp), parameter :: far = 1e30_dp

contains

  !> Follows the motion at the first speed of a map over one period.
  pure subroutine run_period(map, start, period, trace)
    type(period_map_t), intent(inout) :: map         !< with the duration of one speed
    real(dp), intent(in) :: start(2)                 !< x, y at the begin, m
    type(period_t), intent(out) :: period
    type(trace_t), intent(inout), optional :: trace  !< the motion is added to it
    type(period_t) :: periods(batch_size)

    if (allocated(map%literature)) then
      call run_literature_period(map%osc, map%literature, map%duration(1), start, .false., period, trace)
      return
    end if
    call follow(map, reshape(start, [2, 1]), [.true.], .true., periods, trace)
    period = periods(1)
  end subroutine run_period

  !> Follows the motions at all speeds of a map over one period.
  pure subroutine run_batch(map, start, active, peaks, period)
    type(period_map_t), intent(inout) :: map
    real(dp), intent(in) :: start(:, :)              !< x, y at the begin, m; (2, speed)
    logical, intent(in) :: active(:)                 !< the others are followed in full contact; (speed)
    logical, intent(in) :: peaks                     !< the largest loads are wanted
    type(period_t), intent(out) :: period(batch_size)

    call follow(map, start, active, peaks, period)
  end subroutine run_batch

  !> The trace is that of the first motion.
  pure subroutine follow(map, start, active, peaks, period, trace)
    type(period_map_t), intent(inout) :: map
    real(dp), intent(in) :: start(:, :)
    logical, intent(in) :: active(:), peaks
    type(period_t), intent(out) :: period(batch_size)
    type(trace_t), intent(inout), optional :: trace
    type(integrator_t) :: state
    integer :: i, l

    call begin(map, start, active, peaks, state)
    do i = 1, map%table%steps
      if (map%table%kind(i)%begins) call enter_interval(map, i, state, period)
      if (map%table%kind(i)%widens) call begin_loads(map%table, i, state)
      call advance(map, i, state, period, trace)
      if (all(period(:map%speeds)%failed)) return
      if (peaks) call watch_loads(map, i, state)
      if (present(trace) .and. .not. state%changes(1)) &
        call record_step(map, i, state%x(1, [state%from, state%to]), state%contact_set(1), trace)
      if (modulo(i, 64) == 0) call flush_to_zero(state%monodromy)
      state%from = state%to
      state%to = 3 - state%from
    end do
    if (state%all_full) state%monodromy = map%monodromy
    do l = 1, map%speeds
      call settle_candidates(map%osc, map%table, map%duration(l), state%candidates(l), state%peak(l))
      period(l)%peak = state%peak(l)
      period(l)%state = [state%x(l, state%from), state%y(l, state%from)]
      period(l)%monodromy(:, 1) = state%monodromy(l, :2)
      period(l)%monodromy(:, 2) = state%monodromy(l, 3:)
      period(l)%work = period(l)%work + map%table%steps
    end do
  end subroutine follow

  pure subroutine begin(map, start, active, peaks, state)
    type(period_map_t), intent(in) :: map
    real(dp), intent(in) :: start(:, :)
    logical, intent(in) :: active(:), peaks
    type(integrator_t), intent(inout) :: state

    allocate (state%contacts(map%osc%contacts))
    state%x(:, state%from) = 0
    state%y(:, state%from) = 0
    state%x(:map%speeds, state%from) = start(1, :)
    state%y(:map%speeds, state%from) = start(2, :)
    state%monodromy = 0
    state%monodromy(:, 1) = 1
    state%monodromy(:, 4) = 1
    state%held = far
    where (active) state%held(:map%speeds) = 0
    state%all_full = map%all_full
    state%peaks = peaks
    state%peak = 0
    state%candidates%count = 0
  end subroutine begin

  !> The contact sets where a smooth interval begins.
  pure subroutine enter_interval(map, step, state, period)
    type(period_map_t), intent(in) :: map
    integer, intent(in) :: step
    type(integrator_t), intent(inout) :: state
    type(period_t), intent(inout) :: period(batch_size)
    logical :: closed
    integer :: full, j, l

    associate (osc => map%osc, table => map%table)
      state%contact_set = 0
      do j = 1, osc%contacts
        do l = 1, batch_size
          if (j > osc%pairs) then
            closed = state%x(l, state%from) + state%held(l) < -osc%backlash
          else
            closed = j <= table%pairs(step)
            if (closed) closed = state%x(l, state%from) + state%held(l) > table%end_profile_error(0, j, 1, step)
          end if
          call set_contact(osc, l, j, closed, state%contact_set(l), state%contacts(j))
        end do
      end do
      full = full_contact(table, step)
      state%full_contact = all(state%contact_set == full)
      do l = 1, map%speeds
        if (state%contact_set(l) /= full) call record_contact(osc, state%contact_set(l), period(l))
        period(l)%checksum = period(l)%checksum + state%x(l, state%from)
      end do
    end associate
  end subroutine enter_interval

  !> The loads where a step begins, after a break or a step of another width.
  pure subroutine begin_loads(table, step, state)
    type(coefficients_t), intent(in) :: table
    integer, intent(in) :: step
    type(integrator_t), intent(inout) :: state
    real(dp) :: bound(batch_size)
    integer :: j

    do j = 1, table%pairs(step)
      call move_load(table%width(step), table%end_stiffness(:1, j, 1, step), table%end_profile_error(:1, j, 1, step), &
                     state%x(:, state%from), state%y(:, state%from), state%contacts(j), state%peak, bound)
    end do
  end subroutine begin_loads

  !> The state at the end of a step, with the events in it, and the monodromy matrix so far.
  pure subroutine advance(map, step, state, period, trace)
    type(period_map_t), intent(inout) :: map
    integer, intent(in) :: step
    type(integrator_t), intent(inout) :: state
    type(period_t), intent(inout) :: period(batch_size)
    type(trace_t), intent(inout), optional :: trace
    real(dp) :: propagator(batch_size, 6)
    integer :: place

    if (state%all_full .and. .not. state%full_contact) call leave(map, step, state)
    place = step
    if (.not. state%all_full) call need_propagator(map, step, state%contact_set, state%contacts, place)
    call take_step(map%propagator(:, :, place), state%x(:, state%from), state%y(:, state%from), state%x(:, state%to), &
                   state%y(:, state%to))
    state%changes = .false.
    if (.not. (state%full_contact .and. stays_above(map%table, step, state))) call find_changes(map, step, state)
    if (any(state%changes)) then
      if (state%all_full) call leave(map, step, state)
      propagator = map%propagator(:, :, place)
      call locate_events(map, step, state, propagator, period, trace)
      where (period%failed) state%held = far
      state%full_contact = all(state%contact_set == full_contact(map%table, step))
      call compose(propagator, state%monodromy)
    else if (.not. state%all_full) then
      call compose(map%propagator(:, :, place), state%monodromy)
    end if
  end subroutine advance

  !> Full contact ends in this step: the monodromy matrix so far is that of the steps before.
  pure subroutine leave(map, step, state)
    type(period_map_t), intent(inout) :: map
    integer, intent(in) :: step
    type(integrator_t), intent(inout) :: state

    call leave_full_contact(map, step - 1, state%monodromy)
    state%all_full = .false.
  end subroutine leave

  !> Do the motions that are not held stay above all profile errors during a step? A convex curve stays above its
  !> tangents.
  pure logical function stays_above(table, step, state)
    type(coefficients_t), intent(in) :: table
    integer, intent(in) :: step
    type(integrator_t), intent(in) :: state
    real(dp) :: lowest(batch_size), quarter
    integer :: l

    quarter = table%width(step)/4
    do l = 1, batch_size
      lowest(l) = min(state%x(l, 1), state%x(l, 2)) - (abs(state%y(l, 1)) + abs(state%y(l, 2)))*quarter + state%held(l)
    end do
    stays_above = minval(lowest) > table%upper_bound(step)
  end function stays_above

  !> The motions in which a contact may change during a step.
  pure subroutine find_changes(map, step, state)
    type(period_map_t), intent(in) :: map
    integer, intent(in) :: step
    type(integrator_t), intent(inout) :: state
    real(dp) :: lowest(batch_size)
    integer :: j

    lowest = huge(lowest)
    do j = 1, map%osc%contacts
      if (j > map%table%pairs(step) .and. j <= map%osc%pairs) cycle
      call lower(map%table%width(step), map%table%end_profile_error(:1, j, :, step), state%x(:, state%from), &
                 state%y(:, state%from), state%x(:, state%to), state%y(:, state%to), state%contacts(j)%sense, lowest)
    end do
    state%changes = lowest < 0 .and. .not. state%held > 0
  end subroutine find_changes

  !> Lowers `lowest` to what the overlaps, positive until the contact changes, stay above: a convex curve stays above
  !> its tangents.
  pure subroutine lower(width, error, x, y, x_next, y_next, sense, lowest)
    real(dp), intent(in) :: width, error(0:, :)
    real(dp), intent(in), dimension(batch_size) :: x, y, x_next, y_next, sense
    real(dp), intent(inout) :: lowest(batch_size)
    real(dp) :: before, after, fall, rise
    integer :: l

    do l = 1, batch_size
      before = max(0.0_dp, sense(l)*(x(l) - error(0, 1)))
      after = sense(l)*(x_next(l) - error(0, 2))
      fall = max(0.0_dp, sense(l)*(error(1, 1) - y(l))*width)
      rise = max(0.0_dp, sense(l)*(y_next(l) - error(1, 2))*width)
      lowest(l) = min(lowest(l), min(before, after) - min(fall, rise, (fall + rise)/4))
    end do
  end subroutine lower

  !> The loads over a step: raises the largest, and notes candidates for larger ones within the step.
  pure subroutine watch_loads(map, step, state)
    type(period_map_t), intent(in) :: map
    integer, intent(in) :: step
    type(integrator_t), intent(inout) :: state
    real(dp) :: bound(batch_size)
    integer :: ends(2), j, l

    ends = [state%from, state%to]
    associate (table => map%table)
      do j = 1, table%pairs(step)
        call move_load(table%width(step), table%end_stiffness(:1, j, 2, step), table%end_profile_error(:1, j, 2, step), &
                       state%x(:, state%to), state%y(:, state%to), state%contacts(j), state%peak, bound)
        if (.not. any(bound > state%peak)) cycle
        do l = 1, map%speeds
          if (state%changes(l) .or. bound(l) <= state%peak(l)) cycle
          call add_candidate(map%osc, table, map%duration(l), candidate_t(bound(l), state%x(l, ends), state%y(l, ends), &
                             step, j, state%contact_set(l)), state%candidates(l), state%peak(l))
        end do
      end do
    end associate
  end subroutine watch_loads

  !> Moves the load of a pair to the state x, y: raises `peak`, and tells the bound that the load stays below on the way,
  !> as a concave curve stays below its tangents.
  pure subroutine move_load(width, stiffness, error, x, y, pair, peak, bound)
    real(dp), intent(in) :: width
    real(dp), intent(in) :: stiffness(0:1), error(0:1)         ! with the derivative over the phase
    real(dp), intent(in), dimension(batch_size) :: x, y
    type(contact_t), intent(inout) :: pair
    real(dp), intent(inout) :: peak(batch_size)
    real(dp), intent(out) :: bound(batch_size)
    real(dp) :: gap, load, load_slope, rise, fall
    integer :: l

    do l = 1, batch_size
      gap = x(l) - error(0)
      load = pair%weight(l)*stiffness(0)*gap
      load_slope = pair%weight(l)*width*(stiffness(1)*gap + stiffness(0)*(y(l) - error(1)))
      rise = max(0.0_dp, pair%load_slope(l))
      fall = max(0.0_dp, -load_slope)
      bound(l) = max(pair%load(l), load) + min(rise, fall, (rise + fall)/4)
      peak(l) = max(peak(l), load)
      pair%load(l) = load
      pair%load_slope(l) = load_slope
    end do
  end subroutine move_load

  pure subroutine record_step(map, step, x, contact_set, trace)
    type(period_map_t), intent(in) :: map
    integer, intent(in) :: step, contact_set
    real(dp), intent(in) :: x(2)
    type(trace_t), intent(inout) :: trace
    integer :: j

    associate (table => map%table)
      call record(trace, table%pairs(step), table%left(step) + [0.0_dp, table%width(step)], x, &
                  table%end_stiffness(0, :, :, step), table%end_profile_error(0, :, :, step), &
                  [(in_contact(contact_set, j), j=1, map%osc%contacts)])
    end associate
  end subroutine record_step
end module gearsweep_period
