!> Search for all attracting motions at one speed, from starts spread over the plane of states.
!>
!> The trajectories run in parallel lanes, each until a known motion has captured it. Where the linear maps of a trajectory's last
!> mesh periods predict a periodic motion, Newton's method finds it. Capture is decided by the known motion's map of disturbances
!> over all its mesh periods, d -> M d, and by the Lyapunov function d'Qd of that map, Q = sum of (M^k)' M^k over all k, which
!> each return lowers by d'd.
module gearsweep_motion_attractor_search
  use gearsweep_base, only: dp, wants_stop
  use gearsweep_motion_resolution, only: resolution_t
  use gearsweep_motion_contact_set, only: period_t
  use gearsweep_motion_error_estimate, only: accuracy_t
  use gearsweep_motion_gauss, only: batch_size
  use gearsweep_motion_oscillator, only: oscillator_t
  use gearsweep_motion_period, only: run_batch, run_period
  use gearsweep_motion_period_map, only: discretise, period_map_t, set_durations
  use gearsweep_motion_periodic_orbit, only: closure_of, distance, judge, largest_multiplier, newton_step, run_periods, shoot, &
    solve_full_contact, steady_t
  use gearsweep_motion_steady_motion, only: has_result, status_ok, status_stopped, status_unresolved, status_unstable
  use gearsweep_motion_transient, only: growth_t
  implicit none
  private
  public :: known_t, attractor_options_t, search_motions, start_states

  type :: known_t
    type(steady_t) :: steady                     !< steady motion, from the first of its states
    logical :: attracts = .false.
    real(dp), allocatable :: state(:, :)         !< once a mesh period, x and y, m; (2, period)
    ! For disturbances in static deflections (`scale_of`):
    real(dp), allocatable :: map(:, :, :)        !< M from each state to itself; (2, 2, period)
    real(dp), allocatable :: form(:, :, :)       !< Q of that map; (2, 2, period)
  end type known_t

  !> Approach of a motion to a known one.
  type :: approach_t
    integer :: motion = 0                        !< index of the known motion; 0: none
    integer :: state = 0                         !< index of that motion's state at the first disturbance
    integer :: periods = 0                       !< mesh periods since then
    real(dp) :: first = 0                        !< Lyapunov function at the start
    real(dp) :: expected(2) = 0                  !< first disturbance after the linear map so far
  end type approach_t

  !> Distance below which states count as the same, in static deflections.
  real(dp), parameter :: same = 1e-5_dp

  type :: attractor_options_t
    type(accuracy_t) :: accuracy
    integer :: starts = 8                        !< starts along each axis of their grid
    real(dp) :: span = 4                         !< half the width of the grid, in static deflections
    integer :: most_cycles = 0                   !< largest number of mesh periods for a start; 0: `by_damping`
    integer :: most_periods = 8                  !< largest period of the motions sought, in mesh periods
    integer :: threads = 0                       !< 0: all threads of the machine
  end type attractor_options_t

  !> Trajectory in a lane of the batch.
  type :: trajectory_t
    integer :: start = 0                         !< index of its start; 0: none
    integer :: next_try = 0                      !< periods at the next try of Newton's method from any state
    integer :: next_shot = 0                     !< periods at the next try where the motion nearly repeats
    integer :: in_full_contact = 0               !< periods in a row
    type(growth_t) :: growth
    type(approach_t) :: approach
    real(dp), allocatable :: state(:, :)         !< last states, the newest first, m; (2, 0:periods)
    real(dp), allocatable :: monodromy(:, :, :)  !< monodromy matrices of the last 1, 2, ... periods; (2, 2, periods)
  end type trajectory_t

  !> State of the search at one speed.
  type :: search_t
    type(period_map_t) :: single, batch          !< maps for one motion, and for many at the same speed
    real(dp) :: duration = 0                     !< duration of the mesh period, s
    real(dp) :: scale(2) = 1                     !< result of `scale_of`
    type(known_t), allocatable :: known(:)       !< periodic motions found, attracting or not
    integer :: in_full_contact = 0               !< index of the one in full contact; 0: none attracts
    integer, allocatable :: to(:)                !< of each start, index of the motion that captured it; 0: none
    integer :: most_cycles = 0                   !< largest number of mesh periods for a start
    type(trajectory_t) :: trajectory(batch_size)
  end type search_t

  !> Step angle of the natural motion (rad); its errors are about 1e-7.
  real(dp), parameter :: angle = 0.4_dp
  integer, parameter :: fewest_steps = 16, most_steps = 2**16

  !> Newton's method ends where its correction is far below this, in static deflections.
  real(dp), parameter :: shot_tolerance = 1e-7_dp

  !> Largest number of known motions up to which repelling ones are added, as chaos has infinitely many.
  integer, parameter :: most_known = 100

  !> Distance from a known motion, in static deflections, within which a motion may be approaching it.
  real(dp), parameter :: reach = 0.5_dp

contains

  !> Divisors of a difference of states (m) that convert it to static deflections, as in `distance`.
  pure function scale_of(osc, duration) result(scale)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration             !< duration of the mesh period, s
    real(dp) :: scale(2)

    scale = osc%static_deflection*[1.0_dp, max(1.0_dp, osc%natural_frequency*duration)]
  end function scale_of

  !> Computes the states and maps of a motion found by Newton's method, once a mesh period. If it repeats after fewer mesh
  !> periods, only these are stored.
  pure subroutine make_known(map, steady, known)
    type(period_map_t), intent(inout) :: map     !< map with the duration of one speed
    type(steady_t), intent(in) :: steady         !< periodic, attracting or not
    type(known_t), intent(out) :: known
    type(period_t) :: run
    real(dp) :: state(2, steady%periods), each(2, 2, steady%periods), scale(2)
    integer :: periods, i, k

    scale = scale_of(map%osc, map%duration(1))
    state(:, 1) = steady%state
    do periods = 1, steady%periods
      call run_period(map, state(:, periods), run)
      each(:, :, periods) = in_scale(run%monodromy, scale)
      if (all(abs(run%state - steady%state) < same*scale)) exit
      if (periods < steady%periods) state(:, periods + 1) = run%state
    end do
    periods = min(periods, steady%periods)
    known%steady = steady
    if (periods < steady%periods) then
      call run_periods(map, steady%state, periods, run)
      call judge(map%osc, map%duration(1), steady%state, run, closure_of(map%osc, map%duration(1), steady%state, run), periods, &
                 known%steady)
    end if
    known%attracts = has_result(known%steady%status)
    known%state = state(:, :periods)
    allocate (known%map(2, 2, periods), known%form(2, 2, periods))
    do i = 1, periods
      known%map(:, :, i) = each(:, :, i)
      do k = i + 1, i + periods - 1
        known%map(:, :, i) = matmul(each(:, :, modulo(k - 1, periods) + 1), known%map(:, :, i))
      end do
      known%form(:, :, i) = lyapunov_form(known%map(:, :, i))
    end do
  end subroutine make_known

  !> Converts a derivative of the state by the state to disturbances in static deflections.
  pure function in_scale(monodromy, scale) result(scaled)
    real(dp), intent(in) :: monodromy(2, 2), scale(2)
    real(dp) :: scaled(2, 2)

    scaled = monodromy
    scaled(1, 2) = monodromy(1, 2)*scale(2)/scale(1)
    scaled(2, 1) = monodromy(2, 1)*scale(1)/scale(2)
  end function in_scale

  !> Sum of (M^k)' M^k, doubling the number of terms each time; of a map that does not contract, many terms.
  pure function lyapunov_form(map) result(form)
    real(dp), intent(in) :: map(2, 2)
    integer, parameter :: most_doublings = 30
    real(dp) :: form(2, 2), power(2, 2)
    integer :: i

    form = reshape([1.0_dp, 0.0_dp, 0.0_dp, 1.0_dp], [2, 2])
    power = map
    do i = 1, most_doublings
      if (maxval(abs(power)) < 1e-12_dp .or. maxval(abs(power)) > 1e12_dp) exit
      form = form + matmul(transpose(power), matmul(form, power))
      power = matmul(power, power)
    end do
  end function lyapunov_form

  !> True if these are one motion, for any state at the start of its period.
  pure logical function are_same(a, b, scale)
    type(known_t), intent(in) :: a, b
    real(dp), intent(in) :: scale(2)             !< result of `scale_of`
    integer :: i

    are_same = .false.
    if (size(a%state, 2) /= size(b%state, 2)) return
    do i = 1, size(a%state, 2)
      are_same = all(abs(a%state(:, i) - b%state(:, 1)) < same*scale)
      if (are_same) return
    end do
  end function are_same

  !> Finds the known motion, attracting or not, that is nearest to a state, and the index of its nearest state; 0 if none is
  !> known.
  pure subroutine find_nearest(known, state, scale, motion, which, difference)
    type(known_t), intent(in) :: known(:)
    real(dp), intent(in) :: state(2)             !< m
    real(dp), intent(in) :: scale(2)             !< result of `scale_of`
    integer, intent(out) :: motion, which
    real(dp), intent(out) :: difference(2)       !< state minus that state, in static deflections
    real(dp) :: d(2)
    integer :: i, k

    motion = 0
    which = 0
    difference = huge(1.0_dp)
    do k = 1, size(known)
      do i = 1, size(known(k)%state, 2)
        d = (state - known(k)%state(:, i))/scale
        if (maxval(abs(d)) >= maxval(abs(difference))) cycle
        motion = k
        which = i
        difference = d
      end do
    end do
  end subroutine find_nearest

  !> Begins the observation of a motion near a known one.
  pure subroutine begin_approach(known, motion, which, difference, approach)
    type(known_t), intent(in) :: known(:)
    integer, intent(in) :: motion, which         !< index of the known motion, and of its state
    real(dp), intent(in) :: difference(2)        !< difference from that state, in static deflections
    type(approach_t), intent(out) :: approach

    approach = approach_t(motion, which, 0, dot_product(difference, matmul(known(motion)%form(:, :, which), difference)), &
                          difference)
  end subroutine begin_approach

  !> Continues an approach by one mesh period. A motion is captured if it equals the known one, or if over enough returns its
  !> Lyapunov function has fallen by at least half of the fall in the linear map.
  pure subroutine go_on(known, state, scale, approach, captured)
    type(known_t), intent(in) :: known(:)
    real(dp), intent(in) :: state(2)             !< present state, m
    real(dp), intent(in) :: scale(2)             !< result of `scale_of`
    type(approach_t), intent(inout) :: approach  !< out: motion 0 if it has not come nearer
    logical, intent(out) :: captured
    real(dp), parameter :: clear = 0.72_dp, farthest = 1.0_dp
    integer, parameter :: most_returns = 200
    real(dp) :: d(2), now, expected

    captured = .false.
    approach%periods = approach%periods + 1
    associate (motion => known(approach%motion), i => approach%state)
      if (modulo(approach%periods, size(motion%state, 2)) /= 0) return
      d = (state - motion%state(:, i))/scale
      captured = maxval(abs(d)) < same
      if (captured) return
      approach%expected = matmul(motion%map(:, :, i), approach%expected)
      expected = dot_product(approach%expected, matmul(motion%form(:, :, i), approach%expected))
      if (expected > clear*approach%first .and. approach%periods < most_returns*size(motion%state, 2) .and. &
          maxval(abs(d)) < farthest) return
      now = dot_product(d, matmul(motion%form(:, :, i), d))
      captured = maxval(abs(d)) < farthest .and. now <= (approach%first + expected)/2
    end associate
    if (.not. captured) approach%motion = 0
  end subroutine go_on

  !> Finds the periodic motions that starts lead to, in the order found, and the motion that each start leads to.
  pure subroutine search_motions(osc, duration, options, known, to, status)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration             !< duration of the mesh period, s
    type(attractor_options_t), intent(in) :: options
    type(known_t), allocatable, intent(out) :: known(:)  !< including those that repel
    integer, allocatable, intent(out) :: to(:)   !< index of the motion; 0: none; (start)
    integer, intent(out) :: status               !< ok; unresolved: too many steps; stopped
    type(search_t) :: search
    type(period_t) :: run(batch_size)
    real(dp) :: state(2, batch_size)
    real(dp), allocatable :: start(:, :)
    integer :: next, l

    start = start_states(osc, duration, options)
    call begin_search(osc, duration, size(start, 2), search, status)
    search%most_cycles = options%most_cycles
    if (options%most_cycles == 0) search%most_cycles = by_damping(osc, duration)
    ! Without damping no motion captures another.
    if (.not. osc%damping_ratio > 0) search%most_cycles = 2*options%most_periods
    next = 1
    do while (status == status_ok)
      do l = 1, batch_size
        if (search%trajectory(l)%start == 0 .and. next <= size(start, 2)) then
          call enter(next, start(:, next), options%most_periods, search%trajectory(l))
          next = next + 1
        end if
        state(:, l) = [osc%mean_deflection, 0.0_dp]
        if (search%trajectory(l)%start > 0) state(:, l) = search%trajectory(l)%state(:, 0)
      end do
      if (all(search%trajectory%start == 0)) exit
      call run_batch(search%batch, state, search%trajectory%start > 0, .false., run)
      do l = 1, batch_size
        if (search%trajectory(l)%start > 0) call take_period(run(l), search, search%trajectory(l))
      end do
      if (wants_stop(options%accuracy%steady%stop)) status = status_stopped
    end do
    call move_alloc(search%known, known)
    call move_alloc(search%to, to)
  end subroutine search_motions

  !> Mesh periods in which the natural motion decays to exp(-5) of its amplitude, at least 2000 and at most 100 000.
  pure integer function by_damping(osc, duration)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration             !< duration of the mesh period, s
    real(dp), parameter :: decays = 5, fewest = 2000, most = 1e5_dp

    by_damping = ceiling(max(fewest, decays/max(decays/most, osc%damping_ratio*osc%natural_frequency*duration)))
  end function by_damping

  !> States from which motions start (m), the middles of the cells of a grid: displacements about the mean deflection, and
  !> velocities at which the natural motion has the same amplitudes. (2, start), the displacement varies fastest.
  pure function start_states(osc, duration, options) result(start)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration             !< duration of the mesh period, s
    type(attractor_options_t), intent(in) :: options
    real(dp), allocatable :: start(:, :)
    real(dp) :: offset(options%starts)
    integer :: i, j

    associate (n => options%starts)
      offset = [(options%span*osc%static_deflection*((2*i - 1)/real(n, dp) - 1), i=1, n)]
      allocate (start(2, n**2))
      do j = 1, n
        do i = 1, n
          start(:, (j - 1)*n + i) = [osc%mean_deflection + offset(i), osc%natural_frequency*duration*offset(j)]
        end do
      end do
    end associate
  end function start_states

  !> Prepares the maps, and finds the motion in full contact by Newton's method.
  pure subroutine begin_search(osc, duration, starts, search, status)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration
    integer, intent(in) :: starts                ! their number
    type(search_t), intent(out) :: search
    integer, intent(out) :: status
    type(steady_t) :: steady
    real(dp) :: steps, state(2)
    integer :: l

    allocate (search%known(0), search%to(starts))
    search%to = 0
    status = status_unresolved
    steps = max(osc%natural_frequency, osc%highest_frequency*max(0.5_dp, osc%damping_ratio))*duration/angle
    if (steps > most_steps) return
    call discretise(osc, resolution_t(max(steps, real(fewest_steps, dp))), search%single)
    if (search%single%table%steps == 0) return
    status = status_ok
    search%batch = search%single
    call set_durations(search%single, [duration])
    call set_durations(search%batch, [(duration, l=1, batch_size)])
    search%duration = duration
    search%scale = scale_of(osc, duration)
    call solve_full_contact(search%single, state, steady)
    if (has_result(steady%status)) then
      call add_known(steady, search)
      search%in_full_contact = size(search%known)
    else
      call shoot(search%single, shot_tolerance, 1, state, steady)
      call add_known(steady, search)
    end if
  end subroutine begin_search

  !> Assigns a start to a trajectory.
  pure subroutine enter(start, state, periods, trajectory)
    integer, intent(in) :: start                 ! index of the start
    real(dp), intent(in) :: state(2)
    integer, intent(in) :: periods               ! number of periods stored
    type(trajectory_t), intent(inout) :: trajectory

    trajectory%start = start
    trajectory%next_try = 1
    trajectory%next_shot = 1
    trajectory%in_full_contact = 0
    trajectory%growth = growth_t()
    trajectory%approach = approach_t()
    if (.not. allocated(trajectory%state)) allocate (trajectory%state(2, 0:periods), trajectory%monodromy(2, 2, periods))
    trajectory%state(:, 0) = state
  end subroutine enter

  !> Updates a trajectory after one more mesh period: captured, chaotic, at its end, or continued.
  pure subroutine take_period(run, search, trajectory)
    type(period_t), intent(in) :: run
    type(search_t), intent(inout) :: search
    type(trajectory_t), intent(inout) :: trajectory
    !> Periods in a row in full contact after which a motion stays there: that many phases of its oscillation have occurred.
    integer, parameter :: enough = 12
    integer :: attractor

    if (run%failed .or. .not. distance(search%single%osc, search%duration, run%state) < huge(1.0_dp)) then
      trajectory%start = 0
      return
    end if
    call remember(run, trajectory)
    call trajectory%growth%add(run%monodromy, search%scale(2)/search%scale(1))
    trajectory%in_full_contact = merge(0, trajectory%in_full_contact + 1, run%departs)
    attractor = 0
    if (trajectory%in_full_contact >= enough) attractor = search%in_full_contact
    if (attractor == 0) call watch(search, trajectory, attractor)
    if (attractor == 0) call try_newton(search, trajectory)
    search%to(trajectory%start) = attractor
    if (attractor > 0 .or. trajectory%growth%is_sure() .or. trajectory%growth%periods >= search%most_cycles) trajectory%start = 0
  end subroutine take_period

  !> Adds a period to the stored history of a trajectory.
  pure subroutine remember(run, trajectory)
    type(period_t), intent(in) :: run
    type(trajectory_t), intent(inout) :: trajectory
    integer :: k

    do k = min(trajectory%growth%periods + 1, size(trajectory%monodromy, 3)), 2, -1
      trajectory%state(:, k) = trajectory%state(:, k - 1)
      trajectory%monodromy(:, :, k) = matmul(run%monodromy, trajectory%monodromy(:, :, k - 1))
    end do
    trajectory%state(:, 1) = trajectory%state(:, 0)
    trajectory%monodromy(:, :, 1) = run%monodromy
    trajectory%state(:, 0) = run%state
  end subroutine remember

  !> Checks whether a known motion has captured a trajectory.
  pure subroutine watch(search, trajectory, attractor)
    type(search_t), intent(in) :: search
    type(trajectory_t), intent(inout) :: trajectory
    integer, intent(out) :: attractor               ! 0: none so far
    real(dp) :: difference(2)
    integer :: motion, which
    logical :: captured

    attractor = 0
    if (trajectory%approach%motion > 0) then
      call go_on(search%known, trajectory%state(:, 0), search%scale, trajectory%approach, captured)
      if (captured) attractor = trajectory%approach%motion
      if (trajectory%approach%motion > 0) return
    end if
    call find_nearest(search%known, trajectory%state(:, 0), search%scale, motion, which, difference)
    if (motion == 0 .or. maxval(abs(difference)) > reach) return
    if (search%known(motion)%attracts) call begin_approach(search%known, motion, which, difference, trajectory%approach)
  end subroutine watch

  !> Tries Newton's method where the linear maps of the last 1, 2, ... mesh periods predict a periodic motion, unless one is known
  !> there: nearby, where the motion nearly repeats while its transient decays; from time to time, anywhere.
  pure subroutine try_newton(search, trajectory)
    type(search_t), intent(inout) :: search
    type(trajectory_t), intent(inout) :: trajectory
    real(dp), parameter :: promising = 2, nearby = 0.25_dp    ! static deflections
    type(steady_t) :: steady
    real(dp) :: defect(2), step(2), difference(2)
    integer :: periods, motion, which
    logical :: solved, anywhere, repeats

    anywhere = trajectory%growth%periods >= trajectory%next_try
    if (.not. (anywhere .or. trajectory%growth%periods >= trajectory%next_shot)) return
    do periods = 1, min(size(trajectory%monodromy, 3), trajectory%growth%periods)
      defect = trajectory%state(:, 0) - trajectory%state(:, periods)
      repeats = all(abs(defect) < nearby*search%scale)
      if (.not. (repeats .or. anywhere)) cycle
      call newton_step(trajectory%monodromy(:, :, periods), defect, step, solved)
      if (repeats) repeats = largest_multiplier(trajectory%monodromy(:, :, periods)) < 1
      if (.not. solved .or. any(abs(step) > merge(nearby, promising, repeats .and. .not. anywhere)*search%scale)) cycle
      if (.not. (repeats .or. anywhere)) cycle
      call find_nearest(search%known, trajectory%state(:, periods) + step, search%scale, motion, which, difference)
      if (maxval(abs(difference)) < 0.1_dp*min(1.0_dp, maxval(abs(step)/search%scale))) cycle
      call try_shooting(search%single, periods, trajectory%state(:, periods) + step, steady)
      call add_known(steady, search)
      trajectory%next_shot = trajectory%growth%periods + 5 + trajectory%growth%periods/5
      exit
    end do
    if (anywhere) trajectory%next_try = 2*trajectory%growth%periods
  end subroutine try_newton

  !> Tries Newton's method in full steps, and gives up as soon as these do not shrink: most tries fail.
  pure subroutine try_shooting(map, periods, start, steady)
    type(period_map_t), intent(inout) :: map
    integer, intent(in) :: periods               ! mesh periods after which the motion is to repeat
    real(dp), intent(in) :: start(2)             ! m
    type(steady_t), intent(out) :: steady        ! motion; without a result if it does not converge
    integer, parameter :: most_iterations = 10
    real(dp), parameter :: small = 1e-3_dp     ! static deflections
    type(period_t) :: run
    real(dp) :: state(2), step(2), size, last
    integer :: iteration
    logical :: solved

    state = start
    last = huge(last)
    do iteration = 1, most_iterations
      call run_periods(map, state, periods, run)
      if (run%failed) return
      call newton_step(run%monodromy, run%state - state, step, solved)
      size = distance(map%osc, map%duration(1), step)
      if (.not. solved .or. size > 0.7_dp*last .and. iteration > 2) return
      state = state + step
      last = size
      if (size > small) cycle
      call shoot(map, shot_tolerance, periods, state, steady)
      return
    end do
  end subroutine try_shooting

  !> Adds a motion found by Newton's method to the known ones.
  pure subroutine add_known(steady, search)
    type(steady_t), intent(in) :: steady
    type(search_t), intent(inout) :: search
    type(known_t) :: new
    integer :: k

    if (.not. has_result(steady%status) .and. (steady%status /= status_unstable .or. size(search%known) >= most_known)) return
    call make_known(search%single, steady, new)
    do k = 1, size(search%known)
      if (are_same(search%known(k), new, search%scale)) return
    end do
    search%known = [search%known, new]
  end subroutine add_known
end module gearsweep_motion_attractor_search
