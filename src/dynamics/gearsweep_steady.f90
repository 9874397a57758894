!> Steady motion at one speed, by Newton's method on the period map or by
!> marching. What it consists of comes along from below.
module gearsweep_steady
  use gearsweep_kinds, only: dp
  use gearsweep_motion, only: oscillator_t, table_t
  use gearsweep_gauss, only: lanes
  use gearsweep_hold, only: lane_work_t, hold_maps, hold_motion
  use gearsweep_period, only: period_t, run_period, run_lanes
  use gearsweep_orbit, only: steady_t, near, name_of, has_answer, settled, shoot, is_closed, newton_step, judge, distance, &
    largest_multiplier, unbounded, point_ok, point_marginal, point_subharmonic, point_inexact, point_unstable, &
    point_aperiodic, point_unresolved, point_chatter, point_chaotic
  use gearsweep_march, only: march, steady_options_t, by_shooting, by_marching
  implicit none
  private
  public :: find_steady, find_in_lanes, solve_in_contact, settled, steady_options_t, by_shooting, by_marching
  public :: steady_t, name_of, has_answer, shoot, distance, largest_multiplier, near, unbounded
  public :: point_ok, point_marginal, point_subharmonic, point_inexact, point_unstable, point_aperiodic, &
            point_unresolved, point_chatter, point_chaotic

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
    real(dp) :: rest(2), from(2)
    real(dp) :: work

    rest = [osc%rest, 0.0_dp]
    from = rest
    work = 0
    if (options%method == by_shooting .and. .not. present(start)) then
      call solve_in_contact(osc, table, duration, from, steady)
      if (settled(steady)) return
      work = steady%work
      ! Far from rest Newton's method may find a motion that no start leads to.
      if (distance(osc, duration, from - rest) > near) from = rest
    end if
    if (present(start)) from = start
    if (options%method == by_shooting) then
      call shoot(osc, table, duration, options%tolerance, 1, from, steady)
      steady%work = steady%work + work
      if (settled(steady) .and. distance(osc, duration, steady%state - from) < near) return
    end if
    if (.not. present(start)) from = rest
    call march(osc, table, duration, options, from, steady)
  end subroutine find_steady

  !> While all pairs stay in contact the map is affine: one period gives it,
  !> a second one checks that nothing separates and finds the peak.
  pure subroutine solve_in_contact(osc, table, duration, state, steady)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    real(dp), intent(in) :: duration
    real(dp), intent(out) :: state(2)
    type(steady_t), intent(out) :: steady
    type(period_t) :: run
    real(dp) :: step(2)
    logical :: solved

    call run_period(osc, table, duration, [0.0_dp, 0.0_dp], .true., run)
    call newton_step(run%map, run%state, step, solved)
    state = merge(step, [osc%rest, 0.0_dp], solved)
    steady%work = table%steps
    if (.not. solved) return
    call run_period(osc, table, duration, state, .false., run)
    if (.not. (run%partial .or. run%failed)) call judge(osc, duration, state, run, 1, steady)
    steady%work = 2*table%steps
  end subroutine solve_in_contact

  !> `find_steady` without its marching at several speeds at once. With `guide`, the motions of a coarser
  !> table: lanes that part there start from there. What stays unsettled is for `find_steady`.
  pure subroutine find_in_lanes(osc, table, duration, tolerance, work, steady, guide)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    real(dp), intent(in) :: duration(lanes), tolerance
    type(lane_work_t), intent(inout) :: work
    type(steady_t), intent(out) :: steady(lanes)
    type(steady_t), intent(in), optional :: guide(lanes)
    real(dp) :: from(2, lanes), rest(2)
    logical :: parts(lanes), free(lanes)
    integer :: l

    parts = .false.
    if (present(guide)) parts = guide%partial .or. .not. settled(guide)
    if (.not. all(parts)) call hold_in_lanes(osc, table, duration, work, steady, from)
    free = .not. settled(steady)
    if (present(guide)) free = free .and. settled(guide)
    rest = [osc%rest, 0.0_dp]
    do l = 1, lanes
      if (present(guide)) then
        from(:, l) = guide(l)%state
      else if (distance(osc, duration(l), from(:, l) - rest) > near) then
        from(:, l) = rest
      end if
    end do
    if (any(free)) call shoot_in_lanes(osc, table, duration, tolerance, from, free, steady)
  end subroutine find_in_lanes

  !> Motions with all pairs in contact; what they start from, which may be of use where a pair parts.
  pure subroutine hold_in_lanes(osc, table, duration, work, steady, from)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    real(dp), intent(in) :: duration(lanes)
    type(lane_work_t), intent(inout) :: work
    type(steady_t), intent(inout) :: steady(lanes)
    real(dp), intent(out) :: from(2, lanes)
    type(period_t) :: run(lanes)
    logical :: solved(lanes)
    integer :: l

    call hold_maps(osc, table, duration, work, run)
    do l = 1, lanes
      call newton_step(run(l)%map, run(l)%state, from(:, l), solved(l))
    end do
    call hold_motion(osc, table, duration, from, work, run)
    do l = 1, lanes
      if (solved(l) .and. .not. run(l)%partial) call judge(osc, duration(l), from(:, l), run(l), 1, steady(l))
    end do
  end subroutine hold_in_lanes

  !> Newton's method as in `shoot`, but without halving its steps, in the lanes `free`.
  pure subroutine shoot_in_lanes(osc, table, duration, tolerance, from, free, steady)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    real(dp), intent(in) :: duration(lanes), tolerance, from(2, lanes)
    logical, intent(in) :: free(lanes)
    type(steady_t), intent(inout) :: steady(lanes)
    integer, parameter :: most_iterations = 8
    type(period_t) :: run(lanes)
    real(dp) :: state(2, lanes), step(2)
    logical :: open(lanes)
    integer :: iteration, l

    state = from
    open = free
    do iteration = 1, most_iterations
      call run_lanes(osc, table, duration, state, open, run)
      do l = 1, lanes
        if (.not. open(l)) cycle
        open(l) = .not. is_closed(osc, duration(l), tolerance, state(:, l), run(l))
        if (.not. open(l)) then
          if (distance(osc, duration(l), state(:, l) - from(:, l)) < near) &
            call judge(osc, duration(l), state(:, l), run(l), 1, steady(l))
        else
          call newton_step(run(l)%map, run(l)%state - state(:, l), step, open(l))
          state(:, l) = state(:, l) + step
          open(l) = open(l) .and. .not. run(l)%failed .and. distance(osc, duration(l), state(:, l) - from(:, l)) < 2*near
        end if
      end do
      if (.not. any(open)) exit
    end do
  end subroutine shoot_in_lanes
end module gearsweep_steady
