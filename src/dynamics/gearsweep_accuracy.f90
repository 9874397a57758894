!> One operating point to a tolerance: the number of steps follows from an
!> error estimate by step doubling.
module gearsweep_accuracy
  use gearsweep_kinds, only: dp, pi
  use gearsweep_motion, only: oscillator_t, table_t, tabulate
  use gearsweep_steady, only: steady_t, steady_options_t, find_steady, shoot, distance, has_answer, &
                              near, unbounded, point_marginal, point_inexact, point_unresolved, by_shooting
  implicit none
  private
  public :: accuracy_t, tables_t, point_t, solve_point, mesh_period, most_rungs, rung_steps

  type :: accuracy_t
    type(steady_options_t) :: steady
    integer :: steps = 0                         !< a period; 0: chosen for the tolerance
    integer :: most_steps = 2**18                !< a period; fewer where more than four pairs touch
  end type accuracy_t

  !> The answer at one speed.
  type :: point_t
    type(steady_t) :: steady
    real(dp) :: dynamic_factor = 0
    real(dp) :: estimate = 0                     !< of the error of the dynamic factor
    real(dp) :: step_error = 0                   !< its part that more steps reduce
    integer :: steps = 0                         !< of the period
    real(dp) :: work = 0                         !< Runge-Kutta steps in all, on every table tried
    integer :: wanted_steps = 0                  !< the number that `tabulate` makes these from
  end type point_t

  !> Numbers of steps come in rungs of 2**(1/3), so that many speeds share a table.
  integer, parameter :: most_rungs = 48

  !> Tables made so far, and where the next point may start looking.
  type :: tables_t
    type(table_t) :: fine(0:most_rungs), coarse(0:most_rungs)
    logical :: made(0:most_rungs) = .false.
    real(dp) :: steps_per_second = 0             !< wanted by the last point, over its period
  end type tables_t

contains

  !> Duration of one mesh period (s).
  elemental real(dp) function mesh_period(teeth, rpm)
    integer, intent(in) :: teeth
    real(dp), intent(in) :: rpm

    mesh_period = 60/(teeth*rpm)
  end function mesh_period

  elemental integer function rung_steps(rung)
    integer, intent(in) :: rung

    rung_steps = 2*nint(8*2**(rung/3.0_dp))
  end function rung_steps

  !> The first rung with at least `steps`.
  pure integer function rung_for(steps) result(rung)
    real(dp), intent(in) :: steps

    do rung = max(0, min(most_rungs, floor(3*log(max(steps, 1.0_dp)/16)/log(2.0_dp)))), most_rungs - 1
      if (rung_steps(rung) >= steps) exit
    end do
  end function rung_for

  !> The last rung with at most `steps`.
  pure integer function last_rung(steps)
    integer, intent(in) :: steps

    last_rung = rung_for(real(steps, dp))
    if (rung_steps(last_rung) > steps) last_rung = last_rung - 1
  end function last_rung

  !> Tabulates the period for a rung, once. Of the large tables only one is kept:
  !> with 2**18 steps it takes 0.2 GB.
  pure subroutine make_tables(osc, rung, tables)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: rung
    type(tables_t), intent(inout) :: tables
    integer, parameter :: large = 2**15
    integer :: i

    if (tables%made(rung)) return
    do i = 0, merge(most_rungs, -1, rung_steps(rung) > large)
      if (.not. tables%made(i) .or. rung_steps(i) <= large) cycle
      tables%fine(i) = table_t()
      tables%coarse(i) = table_t()
      tables%made(i) = .false.
    end do
    call tabulate(osc, rung_steps(rung), 2, tables%fine(rung))
    call tabulate(osc, rung_steps(rung)/2, 1, tables%coarse(rung))
    tables%made(rung) = .true.
  end subroutine make_tables

  !> Steady motion for a period of `duration` (s) on the branch `start` leads to.
  pure subroutine solve_point(osc, duration, options, tables, point, start)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration
    type(accuracy_t), intent(in) :: options
    type(tables_t), intent(inout) :: tables
    type(point_t), intent(out) :: point
    real(dp), intent(in), optional :: start(2)
    integer, parameter :: most_trials = 12
    type(table_t) :: fine, coarse
    real(dp) :: least
    integer :: rung, most, trial

    least = stable_steps(osc, duration, options)
    point%steady%status = point_unresolved
    if (options%steps > 0) then
      if (options%steps < least) return
      call tabulate(osc, options%steps, 2, fine)
      call tabulate(osc, options%steps/2, 1, coarse)
      call solve_on(osc, fine, coarse, duration, options, point, start)
      point%wanted_steps = options%steps
      if (has_answer(point%steady%status) .and. .not. point%estimate <= options%steady%tolerance) &
        point%steady%status = point_inexact
      return
    end if

    most = last_rung(options%most_steps/((osc%members + 3)/4))
    rung = rung_for(least)
    if (rung > most .or. rung_steps(rung) < least) return
    rung = max(rung, min(most, rung_for(first_guess(osc, duration, options, tables))))
    do trial = 1, most_trials
      call make_tables(osc, rung, tables)
      call solve_on(osc, tables%fine(rung), tables%coarse(rung), duration, options, point, start)
      point%wanted_steps = rung_steps(rung)
      if (.not. has_answer(point%steady%status)) exit
      associate (excess => min(point%step_error/options%steady%tolerance, 1e8_dp))
        tables%steps_per_second = rung_steps(rung)*min(max((2.5_dp*excess)**0.25_dp, 0.5_dp), 2.0_dp)/duration
        if (excess <= 1) exit
        if (rung == most) exit
        rung = min(most, rung_for(rung_steps(rung)*min(1.1_dp*excess**0.25_dp, 4.0_dp)))
      end associate
    end do
    if (has_answer(point%steady%status) .and. .not. point%estimate <= options%steady%tolerance) &
      point%steady%status = point_inexact
  end subroutine solve_point

  !> Solves on a table and on its half, and compares.
  pure subroutine solve_on(osc, fine, coarse, duration, options, point, start)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: fine, coarse
    real(dp), intent(in) :: duration
    type(accuracy_t), intent(in) :: options
    type(point_t), intent(inout) :: point
    real(dp), intent(in), optional :: start(2)
    type(steady_options_t) :: alike
    type(steady_t) :: half

    call follow_or_find(osc, fine, duration, options, point%steady, start)
    point%steps = fine%steps
    point%work = point%work + point%steady%work
    point%dynamic_factor = point%steady%peak/osc%load
    if (.not. has_answer(point%steady%status)) return

    if (point%steady%partial) then
      call shoot(osc, coarse, duration, point%steady%periods, point%steady%state, half)
    else
      alike = options%steady
      alike%method = by_shooting
      call find_steady(osc, coarse, duration, alike, half)
    end if
    point%work = point%work + half%work
    point%step_error = unbounded
    if (has_answer(half%status)) then
      point%step_error = doubling_error(abs(point%steady%peak - half%peak)/osc%load, &
                                        distance(osc, duration, point%steady%state - half%state))
      ! So near to 1 that the steps' error decides on which side.
      if (abs(point%steady%multiplier - 1) < abs(point%steady%multiplier - half%multiplier)) &
        point%steady%status = point_marginal
    end if
    point%estimate = point%step_error + point%steady%closure
  end subroutine solve_on

  !> `steady` is known from fewer steps, or not yet; with changes of contact the
  !> search is long, and Newton's method may go on from what was found.
  pure subroutine follow_or_find(osc, table, duration, options, steady, start)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    real(dp), intent(in) :: duration
    type(accuracy_t), intent(in) :: options
    type(steady_t), intent(inout) :: steady
    real(dp), intent(in), optional :: start(2)
    type(steady_t) :: before
    real(dp) :: work

    work = 0
    if (has_answer(steady%status) .and. steady%partial .and. options%steady%method == by_shooting) then
      before = steady
      call shoot(osc, table, duration, before%periods, before%state, steady)
      if (has_answer(steady%status) .and. distance(osc, duration, steady%state - before%state) < near) return
      work = steady%work
    end if
    call find_steady(osc, table, duration, options%steady, steady, start)
    steady%work = steady%work + work
  end subroutine follow_or_find

  !> Error of a fourth-order result from its difference to half the steps: a
  !> 15th, raised by a half; the state is asked too, as the peaks may differ
  !> little by chance.
  pure real(dp) function doubling_error(peak, state)
    real(dp), intent(in) :: peak, state

    doubling_error = max(peak, state/4)/10
  end function doubling_error

  !> Runge-Kutta's stability bound on a period, with a margin (-2.785 on the
  !> real and 2.83 on the imaginary axis).
  pure real(dp) function stable_steps(osc, duration, options)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration
    type(accuracy_t), intent(in) :: options
    real(dp), parameter :: bound = 2.6_dp
    real(dp) :: fastest

    associate (zeta => osc%damping_ratio)
      fastest = osc%highest_frequency
      if (zeta > 1) fastest = fastest*(zeta + sqrt(zeta**2 - 1))
    end associate
    stable_steps = fastest*duration/bound
    ! The half table must be stable too, and with a stiff damping it must converge.
    if (options%steps <= 0) stable_steps = stable_steps*merge(4, 2, osc%damping_ratio > 1)
  end function stable_steps

  !> Steps for the tolerance, by the last point or by the phase that the
  !> natural motion goes through.
  pure real(dp) function first_guess(osc, duration, options, tables) result(steps)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration
    type(accuracy_t), intent(in) :: options
    type(tables_t), intent(in) :: tables

    if (tables%steps_per_second > 0) then
      steps = tables%steps_per_second*duration
    else
      steps = 5*osc%natural_frequency*duration*(1e-6_dp/options%steady%tolerance)**0.25_dp
    end if
    steps = max(steps, 32.0_dp*(1e-6_dp/options%steady%tolerance)**0.25_dp)
  end function first_guess
end module gearsweep_accuracy
