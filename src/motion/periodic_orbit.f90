!> A periodic motion: x(T) = x(0) after one or several mesh periods, by Newton's method on the period map (shooting), and whether
!> it attracts. The state is x and its derivative over the mesh phase, both in m.
module gearsweep_motion_periodic_orbit
  use gearsweep_base, only: dp
  use gearsweep_motion_contact_set, only: join, period_t, range_of, rms_of
  use gearsweep_motion_oscillator, only: oscillator_t
  use gearsweep_motion_period, only: run_full_contact, run_period
  use gearsweep_motion_period_map, only: period_map_t
  use gearsweep_motion_steady_motion, only: status_chatter, status_marginal, status_ok, status_subharmonic, status_unstable, &
    steady_t
  implicit none
  private
  public :: steady_t, has_converged, solve_full_contact
  public :: shoot, is_closed, closure_of, newton_step, run_periods, judge, distance, is_bounded, largest_multiplier
  public :: most_negative_direction

  !> Distance in static deflections within which a solution belongs to the motion from which Newton's method started.
  real(dp), parameter, public :: near = 0.5_dp

  !> Largest computing time of one search, in steps.
  real(dp), parameter, public :: most_work = 5e6_dp

  !> Value of an unknown error.
  real(dp), parameter, public :: unbounded = 1e30_dp

  !> Excess of a multiplier over 1 above which the motion repels.
  real(dp), parameter :: neutral = 1e-7_dp

contains

  !> True if the search has found a motion that repeats with the mesh.
  elemental logical function has_converged(steady)
    type(steady_t), intent(in) :: steady

    has_converged = steady%status == status_ok .or. steady%status == status_marginal
  end function has_converged

  !> Solves (I - monodromy) step = defect, unless rounding decides the result: the monodromy matrix is near 1 far above resonance,
  !> so that the test compares products, not elements.
  pure subroutine newton_step(monodromy, defect, step, solved)
    real(dp), intent(in) :: monodromy(2, 2)
    real(dp), intent(in) :: defect(2)            !< state after the period minus that before, m
    real(dp), intent(out) :: step(2)             !< step to the periodic state, m
    logical, intent(out) :: solved
    real(dp) :: inverse(2, 2)

    call invert(monodromy, inverse, solved)
    step = 0
    if (solved) step = inverse(:, 1)*defect(1) + inverse(:, 2)*defect(2)
    solved = solved .and. all(abs(step) < huge(step))
  end subroutine newton_step

  !> Computes (I - monodromy)^-1.
  pure subroutine invert(monodromy, inverse, solved)
    real(dp), intent(in) :: monodromy(2, 2)
    real(dp), intent(out) :: inverse(2, 2)
    logical, intent(out) :: solved
    real(dp) :: a(2, 2), determinant

    a = -monodromy
    a(1, 1) = a(1, 1) + 1
    a(2, 2) = a(2, 2) + 1
    determinant = a(1, 1)*a(2, 2) - a(1, 2)*a(2, 1)
    solved = abs(determinant) > 1e-14_dp*max(abs(a(1, 1)*a(2, 2)), abs(a(1, 2)*a(2, 1)), abs(a(1, 1)) + abs(a(2, 2)))
    inverse = 0
    if (.not. solved) return
    inverse(:, 1) = [a(2, 2), -a(2, 1)]/determinant
    inverse(:, 2) = [-a(1, 2), a(1, 1)]/determinant
  end subroutine invert

  !> Integrates several periods in a row as one.
  pure subroutine run_periods(map, start, periods, peaks, run)
    type(period_map_t), intent(inout) :: map
    real(dp), intent(in) :: start(2)             !< state, m
    integer, intent(in) :: periods               !< number of periods
    logical, intent(in) :: peaks                 !< true: compute the largest loads and the transmission error
    type(period_t), intent(out) :: run           !< result of all periods: the last state, composed maps, sums and maxima
    type(period_t) :: next
    integer :: i

    call run_period(map, start, run, peaks=peaks)
    do i = 2, periods
      if (run%failed) return
      call run_period(map, run%state, next, peaks=peaks)
      run%state = next%state
      run%monodromy = matmul(next%monodromy, run%monodromy)
      run%peak = max(run%peak, next%peak)
      run%coast_peak = max(run%coast_peak, next%coast_peak)
      run%checksum = run%checksum + next%checksum
      run%dte = join(run%dte, next%dte)
      run%departs = run%departs .or. next%departs
      run%partial = run%partial .or. next%partial
      run%lost = run%lost .or. next%lost
      run%coast = run%coast .or. next%coast
      run%failed = next%failed
    end do
  end subroutine run_periods

  !> Applies Newton's method to the map of several periods. Steps are halved while the residual grows. It ends where the remaining
  !> error is far below the tolerance of the dynamic factor.
  pure subroutine shoot(map, tolerance, periods, start, steady)
    type(period_map_t), intent(inout) :: map
    real(dp), intent(in) :: tolerance            !< tolerance of the dynamic factor
    integer, intent(in) :: periods               !< mesh periods after which the motion must repeat
    real(dp), intent(in) :: start(2)             !< state, m
    type(steady_t), intent(out) :: steady
    integer, parameter :: most_iterations = 20, most_halvings = 4
    real(dp), parameter :: acceptable = 1e-9_dp
    type(period_t) :: run, trial_run
    real(dp) :: state(2), trial(2), step(2), closure, residual, trial_residual, before
    integer :: iteration, halving
    logical :: solved, peaks, has_peaks

    associate (osc => map%osc, duration => map%duration(1))
      state = start
      before = map%work
      has_peaks = .false.
      call run_periods(map, state, periods, has_peaks, run)
      residual = distance(osc, duration, run%state - state)
      do iteration = 1, most_iterations
        closure = closure_of(osc, duration, state, run)
        if (run%failed .or. map%work - before > most_work .or. is_closed(closure, tolerance)) exit
        call newton_step(run%monodromy, run%state - state, step, solved)
        if (.not. solved) exit
        ! The largest loads are needed only in the run that confirms the motion, the one after a small step.
        peaks = distance(osc, duration, step)**2 < tolerance
        do halving = 0, most_halvings
          trial = state + step/2**halving
          call run_periods(map, trial, periods, peaks, trial_run)
          trial_residual = distance(osc, duration, trial_run%state - trial)
          if (trial_residual < residual .and. .not. trial_run%failed) exit
        end do
        if (halving > most_halvings) exit
        state = trial
        run = trial_run
        has_peaks = peaks
        residual = trial_residual
      end do
      if (run%failed) then
        steady%status = status_chatter
      else
        closure = closure_of(osc, duration, state, run)
        if (closure < acceptable .or. is_closed(closure, tolerance) .or. (.not. solved .and. residual < acceptable)) then
          if (.not. has_peaks) call run_periods(map, state, periods, .true., run)
          call judge(osc, duration, state, run, closure, periods, steady)
        end if
      end if
    end associate
  end subroutine shoot

  !> Solves the motion in full contact. Its period map is affine: one period gives the periodic state, a second one checks that no
  !> pair separates, and finds the largest load.
  pure subroutine solve_full_contact(map, state, steady)
    type(period_map_t), intent(inout) :: map         !< map with the duration of one speed
    real(dp), intent(out) :: state(2)                !< periodic if no pair separates, m
    type(steady_t), intent(out) :: steady            !< motion; without a result if a pair separates
    type(period_t) :: run(1)
    real(dp) :: step(2)
    logical :: solved

    call run_full_contact(map, reshape([0.0_dp, 0.0_dp], [2, 1]), run)
    call newton_step(run(1)%monodromy, run(1)%state, step, solved)
    state = merge(step, [map%osc%mean_deflection, 0.0_dp], solved)
    if (.not. solved) return
    call run_period(map, state, run(1))
    associate (osc => map%osc, duration => map%duration(1))
      if (.not. (run(1)%departs .or. run(1)%failed)) &
        call judge(osc, duration, state, run(1), closure_of(osc, duration, state, run(1)), 1, steady)
    end associate
  end subroutine solve_full_contact

  !> True if the remaining error is far below the tolerance, or rounding. A small residual alone proves little: far above
  !> resonance any state hardly moves in a period.
  pure logical function is_closed(closure, tolerance)
    real(dp), intent(in) :: closure              !< error of the state, in static deflections
    real(dp), intent(in) :: tolerance            !< tolerance of the dynamic factor

    is_closed = closure < max(1e-3_dp*tolerance, 1e-12_dp)
  end function is_closed

  !> Size of a difference of states, in static deflections; huge beyond any motion's.
  pure real(dp) function distance(osc, duration, difference)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration             !< duration of the mesh period, s
    real(dp), intent(in) :: difference(2)        !< m

    distance = max(abs(difference(1)), abs(difference(2))/max(1.0_dp, osc%natural_frequency*duration)) &
               /osc%static_deflection
    if (.not. distance < 1e50_dp) distance = huge(distance)
  end function distance

  !> True if the motion is within the reach of bounded ones. A harmonic of the mesh drives a linear one to 1/(2 damping ratio)
  !> static deflections at most. Far beyond, where only the stiffness of either flank matters, the motion has no bound.
  pure logical function is_bounded(osc, duration, state)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration             !< duration of the mesh period, s
    real(dp), intent(in) :: state(2)             !< m
    real(dp), parameter :: least = 1e-6_dp, most = 1e-4_dp       ! damping ratios
    real(dp) :: bound

    bound = 1/max(least, min(most, osc%damping_ratio))
    is_bounded = distance(osc, duration, state) < &
                 bound*(1 + (osc%backlash + abs(osc%mean_deflection) + osc%largest_error)/osc%static_deflection)
  end function is_bounded

  !> Computes the result of a converged motion, and whether it attracts.
  pure subroutine judge(osc, duration, state, run, closure, periods, steady)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration             !< duration of the mesh period, s
    real(dp), intent(in) :: state(2)             !< where the motion starts, m
    type(period_t), intent(in) :: run            !< result of the periods until it repeats
    real(dp), intent(in) :: closure              !< error of the state, in static deflections
    integer, intent(in) :: periods               !< mesh periods until it repeats
    type(steady_t), intent(out) :: steady

    steady%state = state
    steady%peak = run%peak
    steady%coast_peak = run%coast_peak
    steady%checksum = run%checksum/(periods*osc%mesh%deviations%periods)
    steady%dte_rms = rms_of(run%dte, periods*osc%mesh%deviations%periods)
    steady%dte_range = range_of(run%dte)
    steady%departs = run%departs
    steady%partial = run%partial
    steady%lost = run%lost
    steady%coast = run%coast
    steady%periods = periods
    steady%residual = distance(osc, duration, run%state - state)
    steady%closure = closure
    steady%multiplier = largest_multiplier(run%monodromy)
    steady%mesh_multiplier = steady%multiplier
    if (osc%mesh%deviations%any()) steady%mesh_multiplier = mean_multiplier(run, periods, osc%mesh%deviations%periods)
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

  !> Distance of a state from the periodic one, in static deflections: (I - monodromy)^-1 times the residual, which is set to at
  !> least rounding.
  pure real(dp) function closure_of(osc, duration, state, run)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration             !< duration of the mesh period, s
    real(dp), intent(in) :: state(2)             !< m
    type(period_t), intent(in) :: run            !< result of the periods from there
    real(dp) :: angle, residual(2), inverse(2, 2)
    logical :: solved

    angle = osc%natural_frequency*duration
    residual = max(abs(run%state - state), epsilon(1.0_dp)* &
                   [abs(state(1)), abs(state(2)) + angle*min(1.0_dp, angle)*abs(state(1))])
    call invert(run%monodromy, inverse, solved)
    closure_of = unbounded
    if (solved) closure_of = distance(osc, duration, abs(inverse(:, 1))*residual(1) + abs(inverse(:, 2))*residual(2))
  end function closure_of

  !> Largest modulus of the Floquet multipliers, the eigenvalues of the monodromy matrix.
  pure real(dp) function largest_multiplier(monodromy) result(modulus)
    real(dp), intent(in) :: monodromy(2, 2)
    real(dp) :: half_trace, determinant, square

    half_trace = (monodromy(1, 1) + monodromy(2, 2))/2
    determinant = monodromy(1, 1)*monodromy(2, 2) - monodromy(1, 2)*monodromy(2, 1)
    square = ((monodromy(1, 1) - monodromy(2, 2))/2)**2 + monodromy(1, 2)*monodromy(2, 1)
    if (square < 0) then
      modulus = sqrt(max(0.0_dp, determinant))
    else
      modulus = abs(half_trace) + sqrt(square)
    end if
  end function largest_multiplier

  !> Geometric mean of the largest modulus over the mesh periods of some turns: one turn is scaled, as that modulus may be 1e-300
  !> and less.
  pure real(dp) function mean_multiplier(run, turns, periods) result(modulus)
    type(period_t), intent(in) :: run
    integer, intent(in) :: turns                 !< number of turns until the motion repeats
    integer, intent(in) :: periods               !< number of mesh periods in a turn

    modulus = largest_multiplier(run%scaled)
    if (turns == 1 .and. modulus > 0) then
      modulus = exp((log(modulus) + run%shrunk)/periods)
    else
      modulus = largest_multiplier(run%monodromy)**(1.0_dp/(turns*periods))
    end if
  end function mean_multiplier

  !> Finds the direction in which a motion repels whose lowest multiplier is real and below -1, as at period doubling.
  pure subroutine most_negative_direction(osc, duration, monodromy, direction, doubles)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration             !< duration of the mesh period, s
    real(dp), intent(in) :: monodromy(2, 2)
    real(dp), intent(out) :: direction(2)        !< of length one static deflection, m
    logical, intent(out) :: doubles              !< true: there is such a multiplier
    real(dp) :: square, multiplier, other(2)

    direction = 0
    square = ((monodromy(1, 1) - monodromy(2, 2))/2)**2 + monodromy(1, 2)*monodromy(2, 1)
    multiplier = (monodromy(1, 1) + monodromy(2, 2))/2 - sqrt(max(0.0_dp, square))
    doubles = square >= 0 .and. multiplier < -1
    if (.not. doubles) return
    direction = [monodromy(1, 2), multiplier - monodromy(1, 1)]
    other = [multiplier - monodromy(2, 2), monodromy(2, 1)]
    if (distance(osc, duration, other) > distance(osc, duration, direction)) direction = other
    doubles = distance(osc, duration, direction) > 0
    if (doubles) direction = direction/distance(osc, duration, direction)
  end subroutine most_negative_direction
end module gearsweep_motion_periodic_orbit
