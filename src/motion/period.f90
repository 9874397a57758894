!> One mesh period of the motion, for a batch of speeds with contact sets of their own.
!>
!> Collocation over the mesh phase in steps that end at every break. Within a step the contact set stays as it is, unless an
!> event is located. In full contact the motion is linear, and its period has a routine of its own. Where teeth deviate, the period
!> is that of all mesh periods after which the deviations repeat.
module gearsweep_motion_period
  use gearsweep_base, only: dp
  use gearsweep_motion_coefficients, only: coefficients_t, contact_sets_at_begin, need_law
  use gearsweep_motion_contact_events, only: locate_events
  use gearsweep_motion_contact_set, only: dte_batch_t, dte_of, dte_t, keep_derivative, period_t, record_contact, set_contacts
  use gearsweep_motion_dense_step, only: is_smooth
  use gearsweep_motion_gauss, only: batch_size
  use gearsweep_motion_integrator, only: integrator_t, raise_by_arcs, raise_coast, record_part, watch_dte
  use gearsweep_motion_literature, only: run_literature_period
  use gearsweep_motion_load_peaks, only: add_candidate, candidate_t, evaluate_candidates, motion_over_step
  use gearsweep_motion_oscillator, only: touches_coast
  use gearsweep_motion_period_map, only: compose, enter, flush_to_zero, is_cut, leave_full_contact, need_laws, need_propagator, &
    period_map_t, take_step
  use gearsweep_motion_trace, only: trace_t
  implicit none
  private
  public :: run_full_contact, run_period, run_batch

  !> Deflection above all profile errors (m): added to a motion, it keeps all pairs in contact.
  real(dp), parameter :: far = 1e30_dp

  !> Start and end of a whole step.
  real(dp), parameter :: whole(2) = [0, 1]

contains

  !> Integrates one period in permanent full contact, whether a pair pushes or pulls: returns the final state and the monodromy
  !> matrix, but no loads.
  pure subroutine run_full_contact(map, start, period)
    type(period_map_t), intent(inout) :: map
    real(dp), intent(in) :: start(:, :)                    !< x, y (m) at the start; (2, speed)
    type(period_t), intent(inout) :: period(:)             !< results at each speed
    real(dp) :: x(batch_size, 2), y(batch_size, 2)
    integer :: contact_set(batch_size), place, from, to, i, k, l

    if (allocated(map%literature)) then
      map%work = map%work + map%steps
      call run_literature_period(map%osc, map%literature, map%duration(1), start(:, 1), .true., period(1))
      return
    end if
    from = 1
    to = 2
    x(:, from) = 0
    y(:, from) = 0
    x(:map%speeds, from) = start(1, :)
    y(:map%speeds, from) = start(2, :)
    call begin_monodromy(map%mesh_monodromy, map%mesh_shrunk)
    call begin_monodromy(map%monodromy, map%shrunk)
    do k = 0, map%osc%mesh%deviations%periods - 1
      call enter(map, k)
      do i = 1, map%table%steps
        if (is_cut(map, i)) exit
        contact_set = map%table%full(i)
        call need_propagator(map, i, contact_set, place)
        if (k == 0) call compose(map%propagator(:, :4, place), map%mesh_monodromy)
        if (k == 0 .and. modulo(i, 64) == 0) call flush_to_zero(map%mesh_monodromy, map%mesh_shrunk)
        call take_step(map%propagator(:, :, place), x(:, from), y(:, from), x(:, to), y(:, to))
        from = to
        to = 3 - from
      end do
      if (i <= map%table%steps) exit
      call compose(map%mesh_monodromy, map%monodromy)
      map%shrunk = map%shrunk + map%mesh_shrunk
      call flush_to_zero(map%monodromy, map%shrunk)
    end do
    map%all_full = map%cached
    map%work = map%work + map%steps*map%speeds
    do l = 1, map%speeds
      call keep_derivative(map%monodromy(l, :), map%shrunk(l), period(l))
      period(l)%state = [x(l, from), y(l, from)]
    end do
  end subroutine run_full_contact

  !> Sets a monodromy matrix to that of no time.
  pure subroutine begin_monodromy(monodromy, shrunk)
    real(dp), intent(out) :: monodromy(batch_size, 4), shrunk(batch_size)

    monodromy = 0
    monodromy(:, 1) = 1
    monodromy(:, 4) = 1
    shrunk = 0
  end subroutine begin_monodromy

  !> Integrates the motion at the first speed of a map over one period.
  pure subroutine run_period(map, start, period, trace, peaks)
    type(period_map_t), intent(inout) :: map         !< map with the duration of one speed
    real(dp), intent(in) :: start(2)                 !< x, y at the start, m
    type(period_t), intent(out) :: period
    type(trace_t), intent(inout), optional :: trace  !< trace to which the motion is added
    logical, intent(in), optional :: peaks           !< false: compute no largest loads and no transmission error
    type(period_t) :: periods(batch_size)
    logical :: with_peaks

    if (allocated(map%literature)) then
      map%work = map%work + map%steps
      call run_literature_period(map%osc, map%literature, map%duration(1), start, .false., period, trace)
      return
    end if
    with_peaks = .true.
    if (present(peaks)) with_peaks = peaks
    call follow(map, reshape(start, [2, 1]), [.true.], with_peaks, periods, trace)
    period = periods(1)
  end subroutine run_period

  !> Integrates the motions at all speeds of a map over one period.
  pure subroutine run_batch(map, start, active, peaks, period)
    type(period_map_t), intent(inout) :: map
    real(dp), intent(in) :: start(:, :)              !< x, y at the start, m; (2, speed)
    logical, intent(in) :: active(:)                 !< false: the motion stays in full contact; (speed)
    logical, intent(in) :: peaks                     !< true: compute the largest loads
    type(period_t), intent(out) :: period(batch_size)

    call follow(map, start, active, peaks, period)
  end subroutine run_batch

  !> Integrates all motions over one period; a trace records the first of them.
  pure subroutine follow(map, start, active, peaks, period, trace)
    type(period_map_t), intent(inout) :: map
    real(dp), intent(in) :: start(:, :)
    logical, intent(in) :: active(:), peaks
    type(period_t), intent(out) :: period(batch_size)
    type(trace_t), intent(inout), optional :: trace
    type(integrator_t) :: state
    integer :: i, k, l

    call begin(map, start, active, peaks, state)
    do k = 0, map%osc%mesh%deviations%periods - 1
      call enter(map, k)
      do i = 1, map%table%steps
        if (map%table%kind(i)%begins) call enter_interval(map, i, state, period)
        if (peaks .and. map%table%kind(i)%widens) call begin_loads(map, i, state)
        call advance(map, i, state, period, trace)
        map%work = map%work + map%speeds
        if (is_cut(map, i)) period%failed = .true.
        if (all(period(:map%speeds)%failed)) return
        if (peaks) then
          call watch_loads(map, i, state)
          call watch_dte(map%table, map%speeds, map%osc%mean_deflection, i, state)
        end if
        if (present(trace) .and. .not. state%changes(1)) call record_step(map, i, state, trace)
        if (modulo(k*map%table%steps + i, 64) == 0) call flush_to_zero(state%monodromy, state%shrunk)
        state%from = state%to
        state%to = 3 - state%from
      end do
      do l = 1, map%speeds
        call evaluate_candidates(map%osc, map%table, map%duration(l), state%candidates(l), state%peak(l))
      end do
      call raise_by_arcs(map, state)
    end do
    if (state%all_full) state%monodromy = map%monodromy
    if (state%all_full) state%shrunk = map%shrunk
    do l = 1, map%speeds
      period(l)%peak = state%peak(l)
      period(l)%coast_peak = state%coast_peak(l)
      period(l)%dte = dte_of(state%dte, l)
      if (map%speeds == 1) period(l)%dte = state%single_dte
      period(l)%state = [state%x(l, state%from), state%y(l, state%from)]
      call keep_derivative(state%monodromy(l, :), state%shrunk(l), period(l))
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
    call begin_monodromy(state%monodromy, state%shrunk)
    state%held = far
    where (active) state%held(:map%speeds) = 0
    state%all_full = map%all_full
    state%peaks = peaks
    state%peak = 0
    state%coast_peak = 0
    state%dte = dte_batch_t()
    state%single_dte = dte_t()
    state%candidates%count = 0
    state%arcs = 0
  end subroutine begin

  !> Finds the contact sets at the start of a smooth interval.
  pure subroutine enter_interval(map, step, state, period)
    type(period_map_t), intent(inout) :: map
    integer, intent(in) :: step
    type(integrator_t), intent(inout) :: state
    type(period_t), intent(inout) :: period(batch_size)
    integer :: j, l

    associate (osc => map%osc, table => map%table)
      call contact_sets_at_begin(osc, step, state%x(:, state%from), state%held > 0, table, state%contact_set)
      do j = 1, osc%contacts
        call set_contacts(osc, j, state%contact_set, state%contacts(j))
      end do
      state%full_contact = all(state%contact_set == table%full(step))
      do l = 1, map%speeds
        call record_contact(osc, state%contact_set(l), table%full(step), table%between(step), period(l))
        period(l)%checksum = period(l)%checksum + state%x(l, state%from)
      end do
    end associate
  end subroutine enter_interval

  !> Computes the loads at the start of a step, after a break or a step of another width.
  pure subroutine begin_loads(map, step, state)
    type(period_map_t), intent(inout) :: map
    integer, intent(in) :: step
    type(integrator_t), intent(inout) :: state
    real(dp) :: bound(batch_size)
    integer :: j

    call take_laws(map, step, state)
    do j = 1, map%table%pairs(step)
      call move_load(map%table, lanes_of(map), step, 1, j, state, bound)
    end do
  end subroutine begin_loads

  !> Finds the contact laws of the contact sets in a step.
  pure subroutine take_laws(map, step, state)
    type(period_map_t), intent(inout) :: map
    integer, intent(in) :: step
    type(integrator_t), intent(inout) :: state

    if (state%full_contact) then
      state%law = step
    else
      call need_laws(map, step, state%contact_set, state%law)
    end if
  end subroutine take_laws

  !> Computes the state at the end of a step, with the events in it, and the monodromy matrix up to there.
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
    if (.not. state%all_full .or. map%osc%mesh%deviations%periods > 1) call need_propagator(map, step, state%contact_set, place)
    call take_step(map%propagator(:, :, place), state%x(:, state%from), state%y(:, state%from), state%x(:, state%to), &
                   state%y(:, state%to))
    state%changes = .false.
    if (map%speeds == batch_size .and. map%osc%mesh%reaches_beyond() .and. is_smooth(map, step) .and. .not. state%peaks) then
      call find_changes_at_end(map, step, state)
    else if (.not. (state%full_contact .and. stays_full(map%table, step, state))) then
      call find_changes(map, step, state)
    end if
    if (any(state%changes)) then
      if (state%all_full) call leave(map, step, state)
      propagator = map%propagator(:, :, place)
      call locate_events(map, step, state, propagator, period, trace)
      where (period%failed) state%held = far
      state%full_contact = all(state%contact_set == map%table%full(step))
      call compose(propagator(:, :4), state%monodromy)
    else if (.not. state%all_full) then
      call compose(map%propagator(:, :4, place), state%monodromy)
    end if
  end subroutine advance

  !> Ends full contact in this step: the monodromy matrix so far is that of the previous steps.
  pure subroutine leave(map, step, state)
    type(period_map_t), intent(inout) :: map
    integer, intent(in) :: step
    type(integrator_t), intent(inout) :: state

    call leave_full_contact(map, step - 1, state%monodromy, state%shrunk)
    state%all_full = .false.
  end subroutine leave

  !> True if the motions that are not held stay in full contact during a step: a convex curve stays above its tangents, a concave
  !> one below.
  pure logical function stays_full(table, step, state)
    type(coefficients_t), intent(in) :: table
    integer, intent(in) :: step
    type(integrator_t), intent(in) :: state
    real(dp), dimension(batch_size) :: lowest, highest
    real(dp) :: quarter
    integer :: l

    quarter = table%width(step)/4
    do l = 1, batch_size
      lowest(l) = min(state%x(l, 1), state%x(l, 2)) - (abs(state%y(l, 1)) + abs(state%y(l, 2)))*quarter + state%held(l)
    end do
    stays_full = minval(lowest) > table%upper_bound(step)
    if (.not. stays_full .or. table%lower_bound(step) > far) return
    do l = 1, batch_size
      highest(l) = max(state%x(l, 1), state%x(l, 2)) + (abs(state%y(l, 1)) + abs(state%y(l, 2)))*quarter - state%held(l)
    end do
    stays_full = maxval(highest) < table%lower_bound(step)
  end function stays_full

  !> Number of lanes of a batch that are computed: one for one motion, else all of them, as a loop over a constant number of lanes
  !> is one of vectors.
  pure integer function lanes_of(map)
    type(period_map_t), intent(in) :: map

    lanes_of = merge(1, batch_size, map%speeds == 1)
  end function lanes_of

  !> Finds the motions in which a contact may change during a step.
  pure subroutine find_changes(map, step, state)
    type(period_map_t), intent(inout) :: map
    integer, intent(in) :: step
    type(integrator_t), intent(inout) :: state
    real(dp) :: lowest(batch_size)
    integer :: j, l

    lowest = huge(lowest)
    call take_laws(map, step, state)
    associate (touching => map%table%touching, width => map%table%width(step), from => state%from, to => state%to, &
               lanes => lanes_of(map))
      do j = 1, map%osc%contacts
        if (j > map%table%pairs(step) .and. j <= map%osc%pairs) cycle
        associate (sense => state%contacts(j)%sense)
          do l = 1, lanes
            lowest(l) = min(lowest(l), least_overlap(sense(l)*(state%x(l, from) - touching(0, j, 1, state%law(l))), &
                                                     sense(l)*(state%x(l, to) - touching(0, j, 2, state%law(l))), &
                                                     sense(l)*(state%y(l, from) - touching(1, j, 1, state%law(l)))*width, &
                                                     sense(l)*(state%y(l, to) - touching(1, j, 2, state%law(l)))*width))
          end do
        end associate
      end do
    end associate
    state%changes = lowest < 0 .and. .not. state%held > 0
  end subroutine find_changes

  !> Finds the motions in which a contact has changed at the end of a step. This is enough while a periodic motion is sought; the
  !> last run also checks the inside of the steps.
  pure subroutine find_changes_at_end(map, step, state)
    type(period_map_t), intent(inout) :: map
    integer, intent(in) :: step
    type(integrator_t), intent(inout) :: state
    real(dp) :: lowest(batch_size)
    integer :: j, l

    lowest = huge(lowest)
    call take_laws(map, step, state)
    do j = 1, map%osc%contacts
      if (j > map%table%pairs(step) .and. j <= map%osc%pairs) cycle
      associate (sense => state%contacts(j)%sense)
        do l = 1, lanes_of(map)
          lowest(l) = min(lowest(l), sense(l)*(state%x(l, state%to) - map%table%touching(0, j, 2, state%law(l))))
        end do
      end associate
    end do
    state%changes = lowest < 0 .and. .not. state%held > 0
  end subroutine find_changes_at_end

  !> Lower bound within a step of an overlap that is positive until the contact changes: a convex curve stays above its tangents.
  elemental real(dp) function least_overlap(first, last, first_slope, last_slope) result(lowest)
    real(dp), intent(in) :: first, last                  ! at both ends, m
    real(dp), intent(in) :: first_slope, last_slope      ! derivatives over the step there, m
    real(dp) :: fall, rise

    fall = max(0.0_dp, -first_slope)
    rise = max(0.0_dp, last_slope)
    lowest = min(max(0.0_dp, first), last) - min(fall, rise, (fall + rise)/4)
  end function least_overlap

  !> Raises the largest load by the loads over a step, and notes candidates for larger ones within the step.
  pure subroutine watch_loads(map, step, state)
    type(period_map_t), intent(inout) :: map
    integer, intent(in) :: step
    type(integrator_t), intent(inout) :: state
    real(dp) :: bound(batch_size), motion(0:2, 2)
    integer :: ends(2), j, l

    ends = [state%from, state%to]
    call take_laws(map, step, state)
    associate (table => map%table)
      do j = 1, table%pairs(step)
        call move_load(table, lanes_of(map), step, 2, j, state, bound)
        if (.not. any(bound(:map%speeds) > state%peak(:map%speeds))) cycle
        do l = 1, map%speeds
          if (state%changes(l) .or. bound(l) <= state%peak(l)) cycle
          call add_candidate(map%osc, table, map%duration(l), candidate_t(bound(l), state%x(l, ends), state%y(l, ends), &
                             step, j, state%contact_set(l)), state%candidates(l), state%peak(l))
        end do
      end do
      if (.not. map%osc%has_backlash) return
      do l = 1, map%speeds
        if (state%changes(l) .or. .not. touches_coast(map%osc, state%contact_set(l))) cycle
        call motion_over_step(map%osc, map%table, step, state%law(l), map%duration(l), states_of(state, l), motion)
        call raise_coast(map, step, state%contact_set(l), whole, motion, state%coast_peak(l))
      end do
    end associate
  end subroutine watch_loads

  !> Updates the load of pair j at one end of a step: raises the largest load, and returns an upper bound within the step (a
  !> concave curve stays below its tangents).
  pure subroutine move_load(table, lanes, step, end, j, state, bound)
    type(coefficients_t), intent(in) :: table
    integer, intent(in) :: lanes, step, end, j
    type(integrator_t), intent(inout) :: state
    real(dp), intent(out) :: bound(batch_size)
    real(dp), dimension(batch_size) :: load, load_slope
    real(dp) :: gap, rise, fall
    integer :: at, l

    at = merge(state%from, state%to, end == 1)
    associate (pair => state%contacts(j), peak => state%peak, width => table%width(step), law => state%law)
      do l = 1, lanes
        gap = state%x(l, at) - table%touching(0, j, end, law(l))
        load(l) = table%effective(0, j, end, law(l))*gap
        load_slope(l) = width*(table%effective(1, j, end, law(l))*gap + &
                               table%effective(0, j, end, law(l))*(state%y(l, at) - table%touching(1, j, end, law(l))))
      end do
      do l = 1, lanes
        rise = max(0.0_dp, pair%load_slope(l))
        fall = max(0.0_dp, -load_slope(l))
        bound(l) = max(pair%load(l), load(l)) + min(rise, fall, (rise + fall)/4)
        peak(l) = max(peak(l), load(l))
        pair%load(l) = load(l)
        pair%load_slope(l) = load_slope(l)
      end do
    end associate
  end subroutine move_load

  !> Adds a step of the first motion to a trace.
  pure subroutine record_step(map, step, state, trace)
    type(period_map_t), intent(inout) :: map
    integer, intent(in) :: step
    type(integrator_t), intent(in) :: state
    type(trace_t), intent(inout) :: trace
    real(dp) :: motion(0:2, 2)
    integer :: law

    call need_law(map%osc, step, state%contact_set(1), map%table, law)
    call motion_over_step(map%osc, map%table, step, law, map%duration(1), states_of(state, 1), motion)
    call record_part(map, step, state%contact_set(1), whole, motion, trace)
  end subroutine record_step

  !> States of motion l at both ends of the step; (x or y, end).
  pure function states_of(state, l) result(states)
    type(integrator_t), intent(in) :: state
    integer, intent(in) :: l
    real(dp) :: states(2, 2)

    states(1, :) = state%x(l, [state%from, state%to])
    states(2, :) = state%y(l, [state%from, state%to])
  end function states_of
end module gearsweep_motion_period
