!> One operating point to a tolerance: the number of steps follows from an
!> error estimate by step doubling.
module gearsweep_accuracy
  use gearsweep_kinds, only: dp, pi
  use gearsweep_gauss, only: order
  use gearsweep_motion, only: oscillator_t, resolution_t, table_t, tabulate
  use gearsweep_steady, only: steady_t, steady_options_t, find_steady, shoot, distance, has_answer, &
                              point_ok, point_inexact, point_unresolved, by_shooting
  implicit none
  private
  public :: accuracy_t, tables_t, point_t, solve_point, mesh_period

  real(dp), parameter :: root = 1.0_dp/order

  type :: accuracy_t
    type(steady_options_t) :: steady
    integer :: steps = 0                         !< a period; 0: chosen for the tolerance
    integer :: most_steps = 2**18
  end type accuracy_t

  !> The answer at one speed.
  type :: point_t
    type(steady_t) :: steady
    real(dp) :: dynamic_factor = 0
    real(dp) :: estimate = 0                     !< of the error of the dynamic factor
    real(dp) :: step_error = 0                   !< its part that more steps reduce
    integer :: steps = 0                         !< of the period
    type(resolution_t) :: resolution             !< of the table that has them
  end type point_t

  !> Resolutions come in rungs of 2**(1/3), so that many speeds share a table; a table of half the steps
  !> lies `octave` rungs below.
  integer, parameter :: octave = 3, most_rungs = 48

  !> Tables made so far, and where the next point may start looking.
  type :: tables_t
    type(table_t) :: rung(0:most_rungs)
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

  elemental type(resolution_t) function resolution_of(rung)
    integer, intent(in) :: rung

    resolution_of = resolution_t(6*2**(modulo(rung, octave)/real(octave, dp)), 2**(rung/octave))
  end function resolution_of

  !> Steps of a period, before those that the breaks add.
  elemental real(dp) function rung_steps(rung)
    integer, intent(in) :: rung

    rung_steps = 6*2**(rung/real(octave, dp))
  end function rung_steps

  !> The first rung with at least `steps`, and a table of half as many.
  pure integer function rung_for(steps) result(rung)
    real(dp), intent(in) :: steps

    rung = min(most_rungs, octave + max(0, ceiling(octave*log(max(steps, 12.0_dp)/12)/log(2.0_dp) - 1e-9_dp)))
  end function rung_for

  !> Makes the table of a rung unless it is there.
  pure subroutine need_rung(osc, rung, tables)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: rung
    type(tables_t), intent(inout) :: tables

    if (.not. tables%made(rung)) call tabulate(osc, resolution_of(rung), tables%rung(rung))
    tables%made(rung) = .true.
  end subroutine need_rung

  !> Steady motion for a period of `duration` (s) on the branch `start` leads to.
  pure subroutine solve_point(osc, duration, options, tables, point, start)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration
    type(accuracy_t), intent(in) :: options
    type(tables_t), intent(inout) :: tables
    type(point_t), intent(out) :: point
    real(dp), intent(in), optional :: start(2)
    integer, parameter :: most_trials = 12
    real(dp) :: least
    integer :: rung, trial

    if (options%steps > 0) then
      call solve_with_steps(osc, duration, options, point, start)
      return
    end if
    point%steady%status = point_unresolved
    least = 2*resolving_steps(osc, duration)
    rung = rung_for(max(least, first_guess(osc, duration, options, tables)))
    do trial = 1, most_trials
      if (rung_steps(rung) > options%most_steps .or. rung_steps(rung) < least) return
      call need_rung(osc, rung, tables)
      call need_rung(osc, rung - octave, tables)
      call solve_on(osc, tables%rung(rung), tables%rung(rung - octave), duration, options, point, start)
      point%resolution = resolution_of(rung)
      if (.not. has_answer(point%steady%status)) exit
      associate (excess => min(point%step_error/options%steady%tolerance, 1e8_dp))
        tables%steps_per_second = rung_steps(rung)*min(max((2.5_dp*excess)**root, 0.5_dp), 2.0_dp)/duration
        if (excess <= 1) exit
        if (rung_steps(rung + 1) > options%most_steps) exit
        rung = min(rung_for(rung_steps(rung)*min(1.1_dp*excess**root, 4.0_dp)), last_rung(options))
      end associate
    end do
    call note_inexact(options, point)
  end subroutine solve_point

  !> The finest rung that `options` allows.
  pure integer function last_rung(options) result(rung)
    type(accuracy_t), intent(in) :: options

    rung = min(most_rungs, floor(octave*log(options%most_steps/6.0_dp)/log(2.0_dp) + 1e-9_dp))
  end function last_rung

  !> The same with the number of steps given.
  pure subroutine solve_with_steps(osc, duration, options, point, start)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration
    type(accuracy_t), intent(in) :: options
    type(point_t), intent(out) :: point
    real(dp), intent(in), optional :: start(2)
    type(table_t) :: fine, coarse
    type(resolution_t) :: resolution

    point%steady%status = point_unresolved
    if (options%steps < resolving_steps(osc, duration)) return
    resolution = resolution_t(options%steps/2.0_dp, 2)
    call tabulate(osc, resolution, fine)
    call tabulate(osc, resolution_t(resolution%base, 1), coarse)
    call solve_on(osc, fine, coarse, duration, options, point, start)
    point%resolution = resolution
    call note_inexact(options, point)
  end subroutine solve_with_steps

  pure subroutine note_inexact(options, point)
    type(accuracy_t), intent(in) :: options
    type(point_t), intent(inout) :: point

    if (has_answer(point%steady%status) .and. .not. point%estimate <= options%steady%tolerance) &
      point%steady%status = point_inexact
  end subroutine note_inexact

  !> Solves on a table and on its half, and compares.
  pure subroutine solve_on(osc, fine, coarse, duration, options, point, start)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: fine, coarse
    real(dp), intent(in) :: duration
    type(accuracy_t), intent(in) :: options
    type(point_t), intent(out) :: point
    real(dp), intent(in), optional :: start(2)
    type(steady_options_t) :: alike
    type(steady_t) :: half

    call find_steady(osc, fine, duration, options%steady, point%steady, start)
    point%steps = fine%steps
    point%dynamic_factor = point%steady%peak/osc%load
    if (.not. has_answer(point%steady%status)) return

    if (point%steady%partial) then
      call shoot(osc, coarse, duration, point%steady%periods, point%steady%state, half)
    else
      alike = options%steady
      alike%method = by_shooting
      call find_steady(osc, coarse, duration, alike, half)
    end if
    point%step_error = huge(point%step_error)
    if (has_answer(half%status)) point%step_error = &
      doubling_error(abs(point%steady%peak - half%peak)/osc%load, &
                     distance(osc, duration, point%steady%state - half%state))
    point%estimate = point%step_error + point%steady%closure
  end subroutine solve_on

  !> Error of a result of sixth order from its difference to half the steps: a 63rd, three times raised,
  !> as the order is less where the stiffness is less smooth; the state is asked too, as the peaks may
  !> differ little by chance.
  pure real(dp) function doubling_error(peak, state)
    real(dp), intent(in) :: peak, state

    doubling_error = max(peak, state/4)/20
  end function doubling_error

  !> Steps of a period that see the fastest natural motion: 2.6 rad of it, or of its decay, a step.
  pure real(dp) function resolving_steps(osc, duration)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration
    real(dp) :: fastest

    associate (zeta => osc%damping_ratio)
      fastest = osc%highest_frequency
      if (zeta > 1) fastest = fastest*(zeta + sqrt(zeta**2 - 1))
    end associate
    resolving_steps = fastest*duration/2.6_dp
  end function resolving_steps

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
      steps = 1.6_dp*osc%natural_frequency*duration*(1e-6_dp/options%steady%tolerance)**root
    end if
    steps = max(steps, 12*(1e-6_dp/options%steady%tolerance)**root)
  end function first_guess
end module gearsweep_accuracy
