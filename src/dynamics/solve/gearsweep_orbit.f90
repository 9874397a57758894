!> A periodic motion: x(T) = x(0) after one or several mesh periods, by Newton's
!> method on the period map, and whether it attracts.
module gearsweep_orbit
  use gearsweep_kinds, only: dp
  use gearsweep_motion, only: oscillator_t, table_t
  use gearsweep_period, only: period_t, maps_t, run_period
  use gearsweep_status, only: status_aperiodic, status_chatter, status_marginal, status_ok, status_subharmonic, status_unstable
  implicit none
  private
  public :: steady_t, settled, adopt
  public :: shoot, is_closed, closure_of, newton_step, run_periods, judge, distance, largest_multiplier

  type :: steady_t
    integer :: status = status_aperiodic
    real(dp) :: state(2) = 0
    real(dp) :: peak = 0                         !< largest load on one pair, N
    real(dp) :: mark = 0                         !< sum of x where zones begin, mean of the periods, m
    !> Largest modulus of the Floquet multipliers; of a chaotic motion, the mean
    !> growth of a disturbance over a mesh period.
    real(dp) :: multiplier = 0
    real(dp) :: residual = 0                     !< of x(T) = x(0), in static deflections
    real(dp) :: closure = 0                      !< error of the state that the residual leaves, the same unit
    integer :: periods = 1                       !< mesh periods until the motion repeats
    real(dp) :: work = 0                         !< to find it, in steps
    logical :: partial = .false., flight = .false., coast = .false.
  end type steady_t

  !> A solution within so many static deflections of where Newton's method
  !> started belongs to the motion it started from.
  real(dp), parameter, public :: near = 0.5_dp

  !> Steps spent at most on one search.
  real(dp), parameter, public :: most_work = 5e6_dp

  !> An error of which nothing is known.
  real(dp), parameter, public :: unbounded = 1e30_dp

  !> Modulus above 1 by more than this means that a motion repels.
  real(dp), parameter :: neutral = 1e-7_dp

contains

  elemental logical function settled(steady)
    type(steady_t), intent(in) :: steady

    settled = steady%status == status_ok .or. steady%status == status_marginal
  end function settled

  !> Takes over a result, and adds what it cost.
  pure subroutine adopt(found, steady)
    type(steady_t), intent(in) :: found
    type(steady_t), intent(inout) :: steady
    real(dp) :: work

    work = steady%work
    steady = found
    steady%work = work + found%work
  end subroutine adopt

  !> Solves (I - map) step = defect, unless rounding decides the answer: map is
  !> near 1 far above resonance, so that its products tell, not its elements.
  pure subroutine newton_step(map, defect, step, solved)
    real(dp), intent(in) :: map(2, 2), defect(2)
    real(dp), intent(out) :: step(2)
    logical, intent(out) :: solved
    real(dp) :: inverse(2, 2)

    call invert(map, inverse, solved)
    step = 0
    if (solved) step = inverse(:, 1)*defect(1) + inverse(:, 2)*defect(2)
    solved = solved .and. all(abs(step) < huge(step))
  end subroutine newton_step

  !> (I - map)^-1.
  pure subroutine invert(map, inverse, solved)
    real(dp), intent(in) :: map(2, 2)
    real(dp), intent(out) :: inverse(2, 2)
    logical, intent(out) :: solved
    real(dp) :: a(2, 2), determinant

    a = -map
    a(1, 1) = a(1, 1) + 1
    a(2, 2) = a(2, 2) + 1
    determinant = a(1, 1)*a(2, 2) - a(1, 2)*a(2, 1)
    solved = abs(determinant) > 1e-14_dp*max(abs(a(1, 1)*a(2, 2)), abs(a(1, 2)*a(2, 1)), abs(a(1, 1)) + abs(a(2, 2)))
    inverse = 0
    if (.not. solved) return
    inverse(:, 1) = [a(2, 2), -a(2, 1)]/determinant
    inverse(:, 2) = [-a(1, 2), a(1, 1)]/determinant
  end subroutine invert

  !> Several periods in a row, as one map.
  pure subroutine run_periods(osc, table, duration, start, periods, maps, run)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    real(dp), intent(in) :: duration, start(2)
    integer, intent(in) :: periods
    type(maps_t), intent(inout) :: maps
    type(period_t), intent(out) :: run
    type(period_t) :: next
    integer :: i

    call run_period(osc, table, duration, start, maps, run)
    do i = 2, periods
      if (run%failed) return
      call run_period(osc, table, duration, run%state, maps, next)
      run%state = next%state
      run%map = matmul(next%map, run%map)
      run%work = run%work + next%work
      run%peak = max(run%peak, next%peak)
      run%mark = run%mark + next%mark
      run%partial = run%partial .or. next%partial
      run%flight = run%flight .or. next%flight
      run%coast = run%coast .or. next%coast
      run%failed = next%failed
    end do
  end subroutine run_periods

  !> Newton's method on the map of `periods` periods, steps halved while the
  !> residual grows, until what it leaves is far below the tolerance of the
  !> dynamic factor.
  pure subroutine shoot(osc, table, duration, tolerance, periods, start, maps, steady)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    real(dp), intent(in) :: duration, tolerance, start(2)
    integer, intent(in) :: periods
    type(maps_t), intent(inout) :: maps
    type(steady_t), intent(out) :: steady
    integer, parameter :: most_iterations = 20, most_halvings = 4
    real(dp), parameter :: acceptable = 1e-9_dp
    type(period_t) :: run, trial_run
    real(dp) :: state(2), trial(2), step(2), closure, residual, trial_residual, work
    integer :: iteration, halving
    logical :: solved

    state = start
    call run_periods(osc, table, duration, state, periods, maps, run)
    work = run%work
    residual = distance(osc, duration, run%state - state)
    do iteration = 1, most_iterations
      closure = closure_of(osc, duration, state, run)
      if (run%failed .or. work > most_work .or. is_closed(closure, tolerance)) exit
      call newton_step(run%map, run%state - state, step, solved)
      if (.not. solved) exit
      do halving = 0, most_halvings
        trial = state + step/2**halving
        call run_periods(osc, table, duration, trial, periods, maps, trial_run)
        work = work + trial_run%work
        trial_residual = distance(osc, duration, trial_run%state - trial)
        if (trial_residual < residual .and. .not. trial_run%failed) exit
      end do
      if (halving > most_halvings) exit
      state = trial
      run = trial_run
      residual = trial_residual
    end do
    if (run%failed) then
      steady%status = status_chatter
    else
      closure = closure_of(osc, duration, state, run)
      if (closure < acceptable .or. is_closed(closure, tolerance) .or. (.not. solved .and. residual < acceptable)) &
        call judge(osc, duration, state, run, closure, periods, steady)
    end if
    steady%work = work
  end subroutine shoot

  !> Is what the residual leaves far below the tolerance of the dynamic factor, or rounding? A small
  !> residual alone proves little: far above resonance any state hardly moves in a period.
  pure logical function is_closed(closure, tolerance)
    real(dp), intent(in) :: closure, tolerance

    is_closed = closure < max(1e-3_dp*tolerance, 1e-12_dp)
  end function is_closed

  !> Size of a difference of states, in static deflections.
  pure real(dp) function distance(osc, duration, difference)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration, difference(2)

    distance = max(abs(difference(1)), abs(difference(2))/max(1.0_dp, osc%natural_frequency*duration)) &
               /osc%static_scale
    if (.not. distance < huge(distance)) distance = huge(distance)
  end function distance

  !> Fills in a converged motion and whether it attracts.
  pure subroutine judge(osc, duration, state, run, closure, periods, steady)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration, state(2), closure
    type(period_t), intent(in) :: run
    integer, intent(in) :: periods
    type(steady_t), intent(out) :: steady

    steady%state = state
    steady%peak = run%peak
    steady%mark = run%mark/periods
    steady%partial = run%partial
    steady%flight = run%flight
    steady%coast = run%coast
    steady%periods = periods
    steady%residual = distance(osc, duration, run%state - state)
    steady%closure = closure
    steady%multiplier = largest_multiplier(run%map)
    if (steady%multiplier > 1 + neutral) then
      steady%status = status_unstable
    else if (steady%multiplier > 1 - neutral) then
      steady%status = status_marginal
    else if (periods > 1) then
      steady%status = status_subharmonic
    else
      steady%status = status_ok
    end if
  end subroutine judge

  !> How far the state is from the periodic one: (I - map)^-1 times the residual,
  !> which is taken to be no smaller than rounding.
  pure real(dp) function closure_of(osc, duration, state, run)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration, state(2)
    type(period_t), intent(in) :: run
    real(dp) :: angle, residual(2), inverse(2, 2)
    logical :: solved

    angle = osc%natural_frequency*duration
    residual = max(abs(run%state - state), epsilon(1.0_dp)* &
                   [abs(state(1)), abs(state(2)) + angle*min(1.0_dp, angle)*abs(state(1))])
    call invert(run%map, inverse, solved)
    closure_of = unbounded
    if (solved) closure_of = distance(osc, duration, abs(inverse(:, 1))*residual(1) + abs(inverse(:, 2))*residual(2))
  end function closure_of

  !> Largest modulus of the eigenvalues of a 2 x 2 map.
  pure real(dp) function largest_multiplier(map) result(modulus)
    real(dp), intent(in) :: map(2, 2)
    real(dp) :: half_trace, determinant, square

    half_trace = (map(1, 1) + map(2, 2))/2
    determinant = map(1, 1)*map(2, 2) - map(1, 2)*map(2, 1)
    square = ((map(1, 1) - map(2, 2))/2)**2 + map(1, 2)*map(2, 1)
    if (square < 0) then
      modulus = sqrt(max(0.0_dp, determinant))
    else
      modulus = abs(half_trace) + sqrt(square)
    end if
  end function largest_multiplier
end module gearsweep_orbit
