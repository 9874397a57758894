!> Steady motion at one speed: x(T) = x(0), by Newton's method on the period
!> map or by marching, with its stability.
module gearsweep_steady
  use gearsweep_kinds, only: dp
  use gearsweep_motion, only: oscillator_t, table_t
  use gearsweep_period, only: period_t, run_period
  implicit none
  private
  public :: steady_t, steady_options_t, find_steady, shoot, distance, largest_multiplier, name_of, has_answer

  !> What is known of an operating point. Up to `inexact` there is a dynamic factor.
  integer, parameter, public :: &
    point_ok = 0, &            !< stable and periodic with the mesh
    point_marginal = 1, &      !< periodic, but transients never die (|multiplier| = 1)
    point_subharmonic = 2, &   !< stable and periodic with several mesh periods
    point_inexact = 3, &       !< the error estimate stays above the tolerance
    point_unstable = 4, &      !< the periodic motion repels; no steady motion was reached
    point_aperiodic = 5, &     !< no periodic motion was found
    point_unresolved = 6, &    !< stability needs more steps than given or allowed
    point_chatter = 7, &       !< contact changes without end
    point_chaotic = 8          !< no periodic motion was found, and disturbances keep growing

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
    !> Largest modulus of the Floquet multipliers; of a chaotic motion, the mean
    !> growth of a disturbance over a mesh period.
    real(dp) :: multiplier = 0
    real(dp) :: residual = 0                     !< of x(T) = x(0), in static deflections
    real(dp) :: closure = 0                      !< error of the state that the residual leaves, the same unit
    integer :: periods = 1                       !< mesh periods until the motion repeats
    integer :: cycles = 0                        !< mesh periods followed in all: the work
    logical :: partial = .false., flight = .false., coast = .false.
  end type steady_t

  !> The end of a march: its last states, the newest first, the maps of the last
  !> 1, 2, ... periods, and by how much a disturbance has grown.
  type :: trail_t
    real(dp), allocatable :: state(:, :)         !< (2, 0:periods)
    real(dp), allocatable :: map(:, :, :)        !< (2, 2, periods)
    integer :: length = 0                        !< mesh periods marched
    real(dp) :: decay = 0                        !< -log of the determinant of all maps
    real(dp) :: disturbance(2) = 1               !< x and y over `unit_of`, of length 1
    real(dp) :: growth = 0                       !< logarithm, since `first_counted`
  end type trail_t

  !> A solution within so many static deflections of where Newton's method
  !> started belongs to the motion it started from.
  real(dp), parameter :: near = 0.5_dp

  !> An error of which nothing is known.
  real(dp), parameter, public :: unbounded = 1e30_dp

  !> Modulus above 1 by more than this means that a motion repels.
  real(dp), parameter :: neutral = 1e-7_dp

  !> A bounded motion whose disturbances grow by more than exp(40) cannot be
  !> periodic over the periods that this took; `enough` of them are asked for.
  real(dp), parameter :: much = 40
  integer, parameter :: first_counted = 50, enough = 500

  !> Runge-Kutta steps marched at most.
  integer, parameter :: most_work = 2*10**7

contains

  pure function name_of(status) result(name)
    integer, intent(in) :: status
    character(:), allocatable :: name
    character(11), parameter :: names(0:8) = [character(11) :: 'ok', 'marginal', 'subharmonic', 'inexact', &
                                              'unstable', 'aperiodic', 'unresolved', 'chatter', 'chaotic']

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
    integer :: cycles

    rest = [osc%rest, 0.0_dp]
    from = rest
    cycles = 0
    if (options%method == by_shooting .and. .not. present(start)) then
      call solve_in_contact(osc, table, duration, from, steady)
      if (settled(steady)) return
      cycles = steady%cycles
      ! Far from rest Newton's method may find a motion that no start leads to.
      if (distance(osc, duration, from - rest) > near) from = rest
    end if
    if (present(start)) from = start
    if (options%method == by_shooting) then
      call shoot(osc, table, duration, 1, from, steady)
      steady%cycles = steady%cycles + cycles
      if (settled(steady) .and. distance(osc, duration, steady%state - from) < near) return
    end if
    if (.not. present(start)) from = rest
    call march(osc, table, duration, options, from, steady)
  end subroutine find_steady

  pure logical function settled(steady)
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
    steady%cycles = 1
    call newton_step(run%map, run%state, step, solved)
    state = merge(step, [osc%rest, 0.0_dp], solved)
    if (.not. solved) return
    call run_period(osc, table, duration, state, .false., run)
    steady%cycles = 2
    if (run%partial .or. run%failed) return
    call judge(osc, duration, state, run, 1, steady)
  end subroutine solve_in_contact

  !> Solves (I - map) step = defect, unless rounding decides the answer: map is
  !> near 1 far above resonance, so that its products tell, not its elements.
  pure subroutine newton_step(map, defect, step, solved)
    real(dp), intent(in) :: map(2, 2), defect(2)
    real(dp), intent(out) :: step(2)
    logical, intent(out) :: solved
    real(dp) :: a(2, 2), determinant

    a = -map
    a(1, 1) = a(1, 1) + 1
    a(2, 2) = a(2, 2) + 1
    determinant = a(1, 1)*a(2, 2) - a(1, 2)*a(2, 1)
    solved = abs(determinant) > 1e-14_dp*max(abs(a(1, 1)*a(2, 2)), abs(a(1, 2)*a(2, 1)), abs(a(1, 1)) + abs(a(2, 2)))
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
      run%decay = run%decay + next%decay
      run%peak = max(run%peak, next%peak)
      run%partial = run%partial .or. next%partial
      run%flight = run%flight .or. next%flight
      run%coast = run%coast .or. next%coast
      run%failed = next%failed
    end do
  end subroutine run_periods

  !> Newton's method on the map of `periods` periods, steps halved while the
  !> residual grows. A small residual alone proves little: far above resonance
  !> any state hardly moves in a period.
  pure subroutine shoot(osc, table, duration, periods, start, steady)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    real(dp), intent(in) :: duration, start(2)
    integer, intent(in) :: periods
    type(steady_t), intent(out) :: steady
    integer, parameter :: most_iterations = 20, most_halvings = 4
    real(dp), parameter :: converged = 1e-12_dp, acceptable = 1e-9_dp, near_enough = 1e-6_dp
    type(period_t) :: run, trial_run
    real(dp) :: state(2), trial(2), step(2), residual, trial_residual
    integer :: iteration, halving, cycles
    logical :: solved

    state = start
    call run_periods(osc, table, duration, state, periods, run)
    cycles = periods
    residual = distance(osc, duration, run%state - state)
    do iteration = 0, most_iterations
      if (run%failed) exit
      call newton_step(run%map, run%state - state, step, solved)
      if (.not. solved .or. distance(osc, duration, step) < converged) exit
      do halving = 0, most_halvings
        trial = state + step/2**halving
        call run_periods(osc, table, duration, trial, periods, trial_run)
        cycles = cycles + periods
        trial_residual = distance(osc, duration, trial_run%state - trial)
        if (trial_residual < residual .and. .not. trial_run%failed) exit
      end do
      if (halving > most_halvings) exit
      state = trial
      run = trial_run
      residual = trial_residual
    end do
    if (run%failed) then
      steady%status = point_chatter
    else if (residual < acceptable .and. distance(osc, duration, step) < near_enough) then
      call judge(osc, duration, state, run, periods, steady)
    end if
    steady%cycles = cycles
  end subroutine shoot

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
    steady%closure = closure_of(osc, duration, state, run)
    steady%multiplier = largest_multiplier(run%map, run%decay)
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

  !> How far the state is from the periodic one: (I - map)^-1 times the residual,
  !> which is taken to be no smaller than rounding.
  pure real(dp) function closure_of(osc, duration, state, run)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration, state(2)
    type(period_t), intent(in) :: run
    real(dp) :: angle, residual(2), column(2, 2)
    logical :: solved(2)

    angle = osc%natural_frequency*duration
    residual = max(abs(run%state - state), epsilon(1.0_dp)* &
                   [abs(state(1)), abs(state(2)) + angle*min(1.0_dp, angle)*abs(state(1))])
    call newton_step(run%map, [residual(1), 0.0_dp], column(:, 1), solved(1))
    call newton_step(run%map, [0.0_dp, residual(2)], column(:, 2), solved(2))
    closure_of = unbounded
    if (all(solved)) closure_of = distance(osc, duration, sum(abs(column), 2))
  end function closure_of

  !> Largest modulus of the eigenvalues of a 2 x 2 map. The determinant is
  !> exp(-decay) exactly (Liouville), also through changes of contact; the map's own
  !> has the steps' error, as if there were a little more or less damping.
  pure real(dp) function largest_multiplier(map, decay) result(modulus)
    real(dp), intent(in) :: map(2, 2)
    real(dp), intent(in), optional :: decay
    real(dp) :: half_trace, determinant, square

    half_trace = (map(1, 1) + map(2, 2))/2
    if (present(decay)) then
      determinant = exp(-decay)
      square = half_trace**2 - determinant
    else
      determinant = map(1, 1)*map(2, 2) - map(1, 2)*map(2, 1)
      square = ((map(1, 1) - map(2, 2))/2)**2 + map(1, 2)*map(2, 1)
    end if
    if (square < 0) then
      modulus = sqrt(max(0.0_dp, determinant))
    else
      modulus = abs(half_trace) + sqrt(square)
    end if
  end function largest_multiplier

  !> A motion found over several periods may repeat after fewer.
  pure subroutine shorten(osc, table, duration, steady)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    real(dp), intent(in) :: duration
    type(steady_t), intent(inout) :: steady
    real(dp), parameter :: same = 1e-7_dp
    type(steady_t) :: trial
    type(period_t) :: run
    integer :: periods

    do periods = 1, steady%periods/2
      if (modulo(steady%periods, periods) /= 0) cycle
      call run_periods(osc, table, duration, steady%state, periods, run)
      steady%cycles = steady%cycles + periods
      if (distance(osc, duration, run%state - steady%state) > same) cycle
      call shoot(osc, table, duration, periods, steady%state, trial)
      if (has_answer(trial%status)) call adopt(trial, steady)
      return
    end do
  end subroutine shorten

  !> Follows the transient until it repeats after some periods. By shooting,
  !> Newton's method takes it to the end as soon as the maps of the last periods
  !> promise an attracting motion nearby. Where nothing settles, an `unstable`
  !> motion found before is what is reported, unless the motion is chaotic.
  pure subroutine march(osc, table, duration, options, start, steady)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    real(dp), intent(in) :: duration
    type(steady_options_t), intent(in) :: options
    real(dp), intent(in) :: start(2)
    type(steady_t), intent(inout) :: steady
    type(trail_t) :: trail
    type(period_t) :: run
    type(steady_t) :: trial
    integer :: next_shot, periods, most_cycles

    if (steady%status /= point_unstable) steady = steady_t(cycles=steady%cycles)
    ! Without damping nothing settles.
    if (.not. osc%damping_ratio > 0) return
    call begin(trail, options%most_periods, start)
    next_shot = 1
    most_cycles = min(options%most_cycles, max(1, most_work/table%steps))
    do while (trail%length < most_cycles)
      call run_period(osc, table, duration, trail%state(:, 0), .false., run)
      steady%cycles = steady%cycles + 1
      if (run%failed) steady%status = point_chatter
      if (run%failed .or. .not. distance(osc, duration, run%state) < huge(1.0_dp)) return
      call follow(trail, run, max(1.0_dp, osc%natural_frequency*duration))
      if (trail%length >= next_shot) then
        call settle(osc, table, duration, options, trail, periods, trial)
        steady%cycles = steady%cycles + trial%cycles
        if (has_answer(trial%status)) then
          call adopt(trial, steady)
          if (periods > 1) call shorten(osc, table, duration, steady)
          return
        end if
        if (periods > 0) next_shot = trail%length + 5 + trail%length/5
      end if
      if (trail%length < enough) cycle
      ! Chaos, or damping that tells in none of the periods to come.
      if (trail%growth > much .or. trail%decay*most_cycles < 2*trail%length) exit
    end do
    if (.not. trail%growth > much) return
    steady = steady_t(status=point_chaotic, multiplier=exp(trail%growth/(trail%length - first_counted)), &
                      partial=run%partial, flight=run%flight, coast=run%coast, cycles=steady%cycles)
  end subroutine march

  !> Takes over a result, and adds what it cost.
  pure subroutine adopt(found, steady)
    type(steady_t), intent(in) :: found
    type(steady_t), intent(inout) :: steady
    integer :: cycles

    cycles = steady%cycles
    steady = found
    steady%cycles = cycles + found%cycles
  end subroutine adopt

  pure subroutine begin(trail, periods, start)
    type(trail_t), intent(out) :: trail
    integer, intent(in) :: periods
    real(dp), intent(in) :: start(2)

    allocate (trail%state(2, 0:periods), trail%map(2, 2, periods))
    trail%state = spread(start, 2, periods + 1)
    trail%map = 0
  end subroutine begin

  !> Adds one period; `unit` is that of y in a disturbance.
  pure subroutine follow(trail, run, unit)
    type(trail_t), intent(inout) :: trail
    type(period_t), intent(in) :: run
    real(dp), intent(in) :: unit
    real(dp) :: size
    integer :: k

    do k = ubound(trail%map, 3), 2, -1
      trail%state(:, k) = trail%state(:, k - 1)
      trail%map(:, :, k) = matmul(run%map, trail%map(:, :, k - 1))
    end do
    trail%state(:, 1) = trail%state(:, 0)
    trail%map(:, :, 1) = run%map
    trail%state(:, 0) = run%state
    trail%length = trail%length + 1
    trail%decay = trail%decay + run%decay
    trail%disturbance = matmul(run%map, trail%disturbance*[1.0_dp, unit])/[1.0_dp, unit]
    size = norm2(trail%disturbance)
    trail%disturbance = trail%disturbance/size
    if (trail%length > first_counted) trail%growth = trail%growth + log(size)
  end subroutine follow

  !> Tries to end the march: `periods` is after how many the motion nearly
  !> repeats, 0 where it does not; `found` has an answer where it settled.
  pure subroutine settle(osc, table, duration, options, trail, periods, found)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    real(dp), intent(in) :: duration
    type(steady_options_t), intent(in) :: options
    type(trail_t), intent(in) :: trail
    integer, intent(out) :: periods
    type(steady_t), intent(out) :: found
    type(period_t) :: run
    real(dp) :: defect(2), step(2), rest, close
    logical :: solved

    ! Marching ends where what is left of the transient is far below the tolerance.
    close = merge(1e-3_dp*options%tolerance, near/2, options%method == by_marching)
    do periods = 1, min(options%most_periods, trail%length)
      defect = trail%state(:, 0) - trail%state(:, periods)
      if (distance(osc, duration, defect) > close) cycle
      if (largest_multiplier(trail%map(:, :, periods)) > 1) cycle
      ! The motion that repeats, by the linear map, and how far the last state is from it.
      call newton_step(trail%map(:, :, periods), defect, step, solved)
      rest = distance(osc, duration, step - defect)
      if (solved .and. rest < close) exit
    end do
    if (periods > min(options%most_periods, trail%length)) then
      periods = 0
    else if (options%method == by_marching) then
      call run_periods(osc, table, duration, trail%state(:, 0), periods, run)
      call judge(osc, duration, trail%state(:, 0), run, periods, found)
      found%cycles = periods
    else
      call shoot(osc, table, duration, periods, trail%state(:, periods) + step, found)
      if (has_answer(found%status) .and. distance(osc, duration, found%state - trail%state(:, 0)) > near) &
        found%status = point_aperiodic
    end if
  end subroutine settle
end module gearsweep_steady
