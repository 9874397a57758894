!> Steady motion at one speed, by Newton's method on the period map or by
!> marching.
module gearsweep_steady
  use gearsweep_kinds, only: dp
  use gearsweep_motion, only: oscillator_t, table_t
  use gearsweep_gauss, only: lanes
  use gearsweep_period, only: period_t, maps_t, begin_maps, run_period, hold_period, run_lanes, hold_lanes
  use gearsweep_orbit, only: steady_t, near, settled, shoot, is_closed, closure_of, newton_step, judge, distance, &
                             largest_multiplier, unbounded
  use gearsweep_march, only: march, steady_options_t, by_shooting, by_marching
  implicit none
  private
  public :: find_steady, find_in_lanes, solve_in_contact, settled, steady_options_t, by_shooting, by_marching
  public :: steady_t, shoot, distance, largest_multiplier, near, unbounded

contains

  !> Steady motion for a mesh period of `duration` (s), on the branch that
  !> `start` leads to; without `start`, the motion with all pairs in contact if
  !> there is one, else what a start at rest under the static load leads to.
  pure subroutine find_steady(osc, table, duration, options, steady, start)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    real(dp), intent(in) :: duration
    type(steady_options_t), intent(in) :: options
    type(steady_t), intent(out) :: steady
    real(dp), intent(in), optional :: start(2)
    real(dp) :: rest(2), from(2), work
    type(maps_t) :: maps

    call begin_maps(table, maps)
    rest = [osc%rest, 0.0_dp]
    from = rest
    work = 0
    if (options%method == by_shooting .and. .not. present(start)) then
      call solve_in_contact(osc, table, duration, maps, from, steady)
      if (settled(steady)) return
      work = steady%work
      ! Far from rest Newton's method may find a motion that no start leads to.
      if (distance(osc, duration, from - rest) > near) from = rest
    end if
    if (present(start)) from = start
    if (options%method == by_shooting) then
      call shoot(osc, table, duration, options%tolerance, 1, from, maps, steady)
      steady%work = steady%work + work
      if (settled(steady) .and. distance(osc, duration, steady%state - from) < near) return
    end if
    if (.not. present(start)) from = rest
    call march(osc, table, duration, options, from, maps, steady)
  end subroutine find_steady

  !> While all pairs stay in contact the map is affine: one period gives it,
  !> a second one checks that nothing separates and finds the peak.
  pure subroutine solve_in_contact(osc, table, duration, maps, state, steady)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    real(dp), intent(in) :: duration
    type(maps_t), intent(inout) :: maps
    real(dp), intent(out) :: state(2)
    type(steady_t), intent(out) :: steady
    type(period_t) :: run
    real(dp) :: step(2)
    logical :: solved

    call hold_period(osc, table, duration, [0.0_dp, 0.0_dp], maps, run)
    call newton_step(run%map, run%state, step, solved)
    state = merge(step, [osc%rest, 0.0_dp], solved)
    steady%work = table%steps
    if (.not. solved) return
    call run_period(osc, table, duration, state, maps, run)
    if (.not. (run%partial .or. run%failed)) &
      call judge(osc, duration, state, run, closure_of(osc, duration, state, run), 1, steady)
    steady%work = 2*table%steps
  end subroutine solve_in_contact

  !> `find_steady` without its marching at several speeds at once. With `guide`, the motions of a coarser
  !> table: lanes that part there start from there. What stays unsettled is for `find_steady`.
  pure subroutine find_in_lanes(osc, table, duration, tolerance, maps, steady, guide)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    real(dp), intent(in) :: duration(lanes), tolerance
    type(maps_t), intent(inout) :: maps
    type(steady_t), intent(out) :: steady(lanes)
    type(steady_t), intent(in), optional :: guide(lanes)
    real(dp) :: start(2, lanes)
    logical :: parts(lanes), open(lanes)
    integer :: l

    parts = .false.
    open = .true.
    if (present(guide)) then
      parts = guide%partial .or. .not. settled(guide)
      open = settled(guide)
      do l = 1, lanes
        start(:, l) = guide(l)%state
      end do
    end if
    call begin_maps(table, maps)
    if (.not. all(parts)) call hold_in_lanes(osc, table, duration, parts, maps, start)
    if (any(open)) call shoot_in_lanes(osc, table, duration, tolerance, start, parts, maps, open, steady)
  end subroutine find_in_lanes

  !> What the motions with all pairs in contact start from, where they are wanted and there are any: while
  !> all pairs stay in contact the map is affine.
  pure subroutine hold_in_lanes(osc, table, duration, parts, maps, start)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    real(dp), intent(in) :: duration(lanes)
    logical, intent(in) :: parts(lanes)
    type(maps_t), intent(inout) :: maps
    real(dp), intent(inout) :: start(2, lanes)
    real(dp), parameter :: zero(2, lanes) = 0
    type(period_t) :: run(lanes)
    real(dp) :: step(2)
    logical :: solved
    integer :: l

    call hold_lanes(osc, table, lanes, duration, zero, maps, run)
    do l = 1, lanes
      if (parts(l)) cycle
      call newton_step(run(l)%map, run(l)%state, step, solved)
      start(:, l) = merge(step, [osc%rest, 0.0_dp], solved)
    end do
  end subroutine hold_in_lanes

  !> Newton's method as in `shoot`, but without halving its steps, in the lanes `open`. A start at which all
  !> pairs should stay in contact, but do not, may be far from rest: then rest is the start.
  pure subroutine shoot_in_lanes(osc, table, duration, tolerance, start, parts, maps, open, steady)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    real(dp), intent(in) :: duration(lanes), tolerance, start(2, lanes)
    logical, intent(in) :: parts(lanes)
    type(maps_t), intent(inout) :: maps
    logical, intent(inout) :: open(lanes)
    type(steady_t), intent(inout) :: steady(lanes)
    integer, parameter :: most_iterations = 8
    type(period_t) :: run(lanes)
    real(dp) :: state(2, lanes), from(2, lanes), step(2), rest(2), closure
    logical :: peaks, last
    integer :: iteration, l

    rest = [osc%rest, 0.0_dp]
    from = start
    state = start
    ! Only a run that closes the motion needs the peaks; the next one may be it where Newton's step was small.
    peaks = .not. all(parts)
    do iteration = 1, most_iterations
      call run_lanes(osc, table, duration, state, open, peaks, maps, run)
      last = .false.
      do l = 1, lanes
        if (.not. open(l)) cycle
        closure = closure_of(osc, duration(l), state(:, l), run(l))
        if (is_closed(closure, tolerance)) then
          last = .true.
          open(l) = .not. peaks
          if (peaks .and. distance(osc, duration(l), state(:, l) - from(:, l)) < near) &
            call judge(osc, duration(l), state(:, l), run(l), closure, 1, steady(l))
        else if (iteration == 1 .and. .not. parts(l) .and. distance(osc, duration(l), state(:, l) - rest) > near) then
          from(:, l) = rest
          state(:, l) = rest
        else
          call newton_step(run(l)%map, run(l)%state - state(:, l), step, open(l))
          state(:, l) = state(:, l) + step
          open(l) = open(l) .and. .not. run(l)%failed .and. distance(osc, duration(l), state(:, l) - from(:, l)) < 2*near
          last = last .or. distance(osc, duration(l), step)**2 < tolerance
        end if
      end do
      peaks = last
      if (.not. any(open)) exit
    end do
  end subroutine shoot_in_lanes
end module gearsweep_steady
