!> Steady motion at one speed, by Newton's method on the period map or by
!> marching. What it consists of comes along from below.
module gearsweep_steady
  use gearsweep_kinds, only: dp
  use gearsweep_motion, only: oscillator_t, table_t
  use gearsweep_period, only: period_t, run_period
  use gearsweep_orbit, only: steady_t, near, name_of, has_answer, settled, shoot, newton_step, judge, distance, &
    largest_multiplier, unbounded, point_ok, point_marginal, point_subharmonic, point_inexact, point_unstable, &
    point_aperiodic, point_unresolved, point_chatter, point_chaotic
  use gearsweep_march, only: march, steady_options_t, by_shooting, by_marching
  implicit none
  private
  public :: find_steady, steady_options_t, by_shooting, by_marching
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
      call shoot(osc, table, duration, 1, from, steady)
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
end module gearsweep_steady
