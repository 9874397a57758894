!> Steady motion at one speed: x(T) = x(0), by Newton's method on the period
!> map or by marching, with its stability.
module gearsweep_steady
  use gearsweep_kinds, only: dp
  use gearsweep_motion, only: oscillator_t, table_t
  use gearsweep_gauss, only: lanes
  use gearsweep_hold, only: lane_work_t, hold_maps, hold_motion
  use gearsweep_lanes, only: run_lanes
  use gearsweep_period, only: period_t, run_period
  implicit none
  private
  public :: steady_t, steady_options_t, find_steady, find_in_lanes, settled, shoot, distance, largest_multiplier
  public :: name_of, has_answer

  !> What is known of an operating point. Up to `inexact` there is a dynamic factor.
  integer, parameter, public :: &
    point_ok = 0, &            !< stable and periodic with the mesh
    point_marginal = 1, &      !< periodic, but transients never die (|multiplier| = 1)
    point_subharmonic = 2, &   !< stable and periodic with several mesh periods
    point_inexact = 3, &       !< the error estimate stays above the tolerance
    point_unstable = 4, &      !< the periodic motion repels; no steady motion was reached
    point_aperiodic = 5, &     !< no periodic motion was found
    point_unresolved = 6, &    !< stability needs more steps than given or allowed
    point_chatter = 7          !< contact changes without end

  integer, parameter, public :: by_shooting = 1, by_marching = 2

  type :: steady_options_t
    integer :: method = by_shooting
    real(dp) :: tolerance = 1e-6_dp              !< of the dynamic factor
    integer :: most_cycles = 2000                !< mesh periods marched at most
    integer :: most_periods = 8                  !< longest subharmonic looked for
  end type steady_options_t

  type :: steady_t
    integer :: status = point_aperiodic
    real(dp) :: state(2) = 0
    real(dp) :: peak = 0                         !< largest load on one pair, N
    real(dp) :: multiplier = 0                   !< largest modulus of the Floquet multipliers
    real(dp) :: residual = 0                     !< of x(T) = x(0), in static deflections
    real(dp) :: closure = 0                      !< error of the state that the residual leaves, the same unit
    integer :: periods = 1                       !< mesh periods until the motion repeats
    logical :: partial = .false., flight = .false., coast = .false.
  end type steady_t

  !> A solution within so many static deflections of where Newton's method
  !> started belongs to the motion it started from.
  real(dp), parameter :: near = 0.5_dp

  !> Modulus above 1 by more than this means that a motion repels.
  real(dp), parameter :: neutral = 1e-7_dp

contains

  pure function name_of(status) result(name)
    integer, intent(in) :: status
    character(:), allocatable :: name
    character(11), parameter :: names(0:7) = [character(11) :: 'ok', 'marginal', 'subharmonic', 'inexact', &
                                              'unstable', 'aperiodic', 'unresolved', 'chatter']

    name = trim(names(status))
  end function name_of

  elemental logical function has_answer(status)
    integer, intent(in) :: status

    has_answer = status <= point_inexact
  end function has_answer

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

    rest = [osc%static_scale, 0.0_dp]
    from = rest
    if (options%method == by_shooting .and. .not. present(start)) then
      call solve_in_contact(osc, table, duration, from, steady)
      if (settled(steady)) return
      ! Far from rest Newton's method may find a motion that no start leads to.
      if (distance(osc, duration, from - rest) > near) from = rest
    end if
    if (present(start)) from = start
    if (options%method == by_shooting) then
      call shoot(osc, table, duration, options%tolerance, 1, from, steady)
      if (settled(steady) .and. distance(osc, duration, steady%state - from) < near) return
    end if
    if (.not. present(start)) from = rest
    call march(osc, table, duration, options, from, steady)
  end subroutine find_steady

  elemental logical function settled(steady)
    type(steady_t), intent(in) :: steady

    settled = steady%status == point_ok .or. steady%status == point_marginal
  end function settled

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
    state = merge(step, [osc%static_scale, 0.0_dp], solved)
    if (.not. solved) return
    call run_period(osc, table, duration, state, .false., run)
    if (run%partial .or. run%failed) return
    call judge(osc, duration, state, run, 1, steady)
  end subroutine solve_in_contact

  !> `find_steady` without its marching at several speeds at once. With `guide`, the motions of a finer
  !> table: lanes that part there start from there. What stays unsettled is for `find_steady`.
  pure subroutine find_in_lanes(osc, table, duration, tolerance, work, steady, guide)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    real(dp), intent(in) :: duration(lanes), tolerance
    type(lane_work_t), intent(inout) :: work
    type(steady_t), intent(out) :: steady(lanes)
    type(steady_t), intent(in), optional :: guide(lanes)
    real(dp) :: from(2, lanes), rest(2)
    logical :: free(lanes)
    integer :: l

    rest = [osc%static_scale, 0.0_dp]
    free = .false.
    if (present(guide)) free = guide%partial .and. settled(guide)
    if (.not. all(free)) call hold_in_lanes(osc, table, duration, work, steady, from)
    if (present(guide)) then
      do l = 1, lanes
        if (free(l)) from(:, l) = guide(l)%state
      end do
    else
      free = .not. settled(steady)
      do l = 1, lanes
        if (distance(osc, duration(l), from(:, l) - rest) > near) from(:, l) = rest
      end do
    end if
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
    real(dp) :: state(2, lanes), step(2), residual
    logical :: open(lanes)
    integer :: iteration, l

    state = from
    open = free
    do iteration = 1, most_iterations
      call run_lanes(osc, table, duration, state, open, run)
      do l = 1, lanes
        if (.not. open(l)) cycle
        residual = distance(osc, duration(l), run(l)%state - state(:, l))
        open(l) = .not. is_closed(osc, duration(l), tolerance, residual, run(l)%map)
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

  !> Solves (I - map) step = defect.
  pure subroutine newton_step(map, defect, step, solved)
    real(dp), intent(in) :: map(2, 2), defect(2)
    real(dp), intent(out) :: step(2)
    logical, intent(out) :: solved
    real(dp) :: a(2, 2), determinant

    a = -map
    a(1, 1) = a(1, 1) + 1
    a(2, 2) = a(2, 2) + 1
    determinant = a(1, 1)*a(2, 2) - a(1, 2)*a(2, 1)
    solved = abs(determinant) > 1e-14_dp*max(1.0_dp, abs(a(1, 1)*a(2, 2)))
    step = 0
    if (solved) step = [a(2, 2)*defect(1) - a(1, 2)*defect(2), a(1, 1)*defect(2) - a(2, 1)*defect(1)]/determinant
    solved = solved .and. all(abs(step) < huge(step))
  end subroutine newton_step

  !> Several periods in a row, as one map.
  pure subroutine run_periods(osc, table, duration, start, periods, run)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    real(dp), intent(in) :: duration, start(2)
    integer, intent(in) :: periods
    type(period_t), intent(out) :: run
    type(period_t) :: next
    integer :: i

    call run_period(osc, table, duration, start, .false., run)
    do i = 2, periods
      if (run%failed) return
      call run_period(osc, table, duration, run%state, .false., next)
      run%state = next%state
      run%map = matmul(next%map, run%map)
      run%peak = max(run%peak, next%peak)
      run%partial = run%partial .or. next%partial
      run%flight = run%flight .or. next%flight
      run%coast = run%coast .or. next%coast
      run%failed = next%failed
    end do
  end subroutine run_periods

  !> Newton's method on the map of `periods` periods, steps halved while the residual grows, until what
  !> it leaves is far below the tolerance of the dynamic factor.
  pure subroutine shoot(osc, table, duration, tolerance, periods, start, steady)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    real(dp), intent(in) :: duration, tolerance, start(2)
    integer, intent(in) :: periods
    type(steady_t), intent(out) :: steady
    integer, parameter :: most_iterations = 20, most_halvings = 4
    real(dp), parameter :: acceptable = 1e-9_dp
    type(period_t) :: run, trial_run
    real(dp) :: state(2), trial(2), step(2), residual, trial_residual
    integer :: iteration, halving
    logical :: solved

    state = start
    call run_periods(osc, table, duration, state, periods, run)
    residual = distance(osc, duration, run%state - state)
    do iteration = 1, most_iterations
      if (run%failed .or. is_closed(osc, duration, tolerance, residual, run%map)) exit
      call newton_step(run%map, run%state - state, step, solved)
      if (.not. solved) exit
      do halving = 0, most_halvings
        trial = state + step/2**halving
        call run_periods(osc, table, duration, trial, periods, trial_run)
        trial_residual = distance(osc, duration, trial_run%state - trial)
        if (trial_residual < residual .and. .not. trial_run%failed) exit
      end do
      if (halving > most_halvings) exit
      state = trial
      run = trial_run
      residual = trial_residual
    end do
    if (.not. run%failed .and. (residual < acceptable .or. is_closed(osc, duration, tolerance, residual, run%map))) then
      call judge(osc, duration, state, run, periods, steady)
    else if (run%failed) then
      steady%status = point_chatter
    end if
  end subroutine shoot

  !> Is what the residual leaves far below the tolerance of the dynamic factor, or rounding?
  pure logical function is_closed(osc, duration, tolerance, residual, map)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration, tolerance, residual, map(2, 2)

    is_closed = residual < 1e-12_dp
    if (.not. is_closed .and. residual < tolerance) is_closed = residual*sensitivity(osc, duration, map) < 1e-3_dp*tolerance
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
  pure subroutine judge(osc, duration, state, run, periods, steady)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration, state(2)
    type(period_t), intent(in) :: run
    integer, intent(in) :: periods
    type(steady_t), intent(out) :: steady

    steady%state = state
    steady%peak = run%peak
    steady%partial = run%partial
    steady%flight = run%flight
    steady%coast = run%coast
    steady%periods = periods
    steady%residual = distance(osc, duration, run%state - state)
    steady%closure = steady%residual*sensitivity(osc, duration, run%map)
    steady%multiplier = largest_multiplier(run%map)
    if (steady%multiplier > 1 + neutral) then
      steady%status = point_unstable
    else if (steady%multiplier > 1 - neutral) then
      steady%status = point_marginal
    else if (periods > 1) then
      steady%status = point_subharmonic
    else
      steady%status = point_ok
    end if
  end subroutine judge

  !> Norm of (I - map)^-1 in scaled states: how much a residual moves the solution.
  pure real(dp) function sensitivity(osc, duration, map)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration, map(2, 2)
    real(dp) :: unit, column(2, 2)
    logical :: solved(2)

    unit = max(1.0_dp, osc%natural_frequency*duration)
    call newton_step(map, [1.0_dp, 0.0_dp], column(:, 1), solved(1))
    call newton_step(map, [0.0_dp, unit], column(:, 2), solved(2))
    sensitivity = huge(1.0_dp)
    if (all(solved)) sensitivity = max(sum(abs(column(1, :))), sum(abs(column(2, :)))/unit)
  end function sensitivity

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

  !> A motion found over several periods may repeat after fewer.
  pure subroutine shorten(osc, table, duration, tolerance, steady)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    real(dp), intent(in) :: duration, tolerance
    type(steady_t), intent(inout) :: steady
    real(dp), parameter :: same = 1e-7_dp
    type(steady_t) :: trial
    type(period_t) :: run
    integer :: periods

    do periods = 1, steady%periods/2
      if (modulo(steady%periods, periods) /= 0) cycle
      call run_periods(osc, table, duration, steady%state, periods, run)
      if (distance(osc, duration, run%state - steady%state) > same) cycle
      call shoot(osc, table, duration, tolerance, periods, steady%state, trial)
      if (has_answer(trial%status)) steady = trial
      return
    end do
  end subroutine shorten

  !> Follows the transient until it repeats. Now and then, where the motion
  !> nearly recurs after some periods, Newton's method takes it to the end. If
  !> nothing settles, an `unstable` motion met on the way is what is reported.
  pure subroutine march(osc, table, duration, options, start, steady)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    real(dp), intent(in) :: duration
    type(steady_options_t), intent(in) :: options
    real(dp), intent(in) :: start(2)
    type(steady_t), intent(inout) :: steady
    type(period_t) :: run
    type(steady_t) :: trial
    real(dp) :: past(2, 0:options%most_periods), moved
    integer :: period, next_shot, periods

    if (steady%status /= point_unstable) steady = steady_t()
    past = huge(1.0_dp)
    past(:, 0) = start
    next_shot = 10
    do period = 1, options%most_cycles
      call run_period(osc, table, duration, past(:, 0), .false., run)
      if (run%failed) then
        steady%status = point_chatter
        return
      end if
      moved = distance(osc, duration, run%state - past(:, 0))
      if (.not. moved < huge(moved)) exit
      if (arrived(run, moved)) then
        call judge(osc, duration, past(:, 0), run, 1, trial)
        if (settled(trial)) then
          steady = trial
          return
        end if
      end if
      past(:, 1:) = past(:, :options%most_periods - 1)
      past(:, 0) = run%state
      if (options%method == by_marching .or. period < next_shot) cycle
      next_shot = 2*next_shot
      do periods = 1, options%most_periods
        if (distance(osc, duration, past(:, 0) - past(:, periods)) > near/2) cycle
        call shoot(osc, table, duration, options%tolerance, periods, past(:, 0), trial)
        if (has_answer(trial%status) .and. distance(osc, duration, trial%state - past(:, 0)) < near) then
          steady = trial
          if (periods > 1) call shorten(osc, table, duration, options%tolerance, steady)
          return
        end if
        if (trial%status == point_unstable) steady = trial
      end do
    end do

  contains

    !> What is left of the transient is far below the tolerance.
    pure logical function arrived(run, moved)
      type(period_t), intent(in) :: run
      real(dp), intent(in) :: moved
      real(dp) :: decay

      decay = min(largest_multiplier(run%map), 1 - 1e-9_dp)
      arrived = moved*max(1.0_dp, decay/(1 - decay)) < 1e-3_dp*options%tolerance
    end function arrived
  end subroutine march
end module gearsweep_steady
