!> The search for all attracting motions at one speed: trajectories from spread starts run side by side, each until a known
!> motion has captured it. Where the maps of a trajectory's last mesh periods predict a periodic motion, Newton's method finds it.
module gearsweep_attractor_search
  use gearsweep_coefficients, only: resolution_t
  use gearsweep_contact_set, only: period_t
  use gearsweep_error_estimate, only: accuracy_t
  use gearsweep_gauss, only: batch_size
  use gearsweep_kinds, only: dp
  use gearsweep_known_motion, only: approach_t, are_same, begin_approach, find_nearest, go_on, known_t, make_known, scale_of
  use gearsweep_oscillator, only: oscillator_t
  use gearsweep_period, only: run_batch
  use gearsweep_period_map, only: discretise, period_map_t, set_durations
  use gearsweep_periodic_orbit, only: distance, largest_multiplier, newton_step, run_periods, shoot, solve_full_contact, steady_t
  use gearsweep_status, only: has_result, status_ok, status_stopped, status_unresolved, status_unstable
  use gearsweep_stop, only: wants_stop
  implicit none
  private
  public :: attractor_options_t, search_motions, start_states

  type :: attractor_options_t
    type(accuracy_t) :: accuracy
    integer :: starts = 8                        !< along each axis of their grid
    real(dp) :: span = 4                         !< from its middle to its edge, in static deflections
    integer :: most_cycles = 0                   !< mesh periods that a start is followed at most; 0: `by_damping`
    integer :: most_periods = 8                  !< mesh periods after which a motion that is looked for repeats, at most
    integer :: threads = 0                       !< 0: as many as the machine has
  end type attractor_options_t

  !> One of the trajectories that run side by side.
  type :: trajectory_t
    integer :: start = 0                         !< which start it comes from; 0: none
    integer :: length = 0                        !< mesh periods followed
    integer :: next_try = 0                      !< length at which Newton's method is tried next from anywhere
    integer :: next_shot = 0                     !< and from where the motion nearly repeats
    integer :: in_full_contact = 0               !< periods in a row
    type(approach_t) :: approach
    real(dp), allocatable :: state(:, :)         !< last states, the newest first, m; (2, 0:periods)
    real(dp), allocatable :: monodromy(:, :, :)  !< of the last 1, 2, ... periods; (2, 2, periods)
  end type trajectory_t

  !> The search at one speed.
  type :: search_t
    type(period_map_t) :: single, batch          !< for one motion, and for many at the same speed
    real(dp) :: duration = 0                     !< of the mesh period, s
    real(dp) :: scale(2) = 1                     !< of `scale_of`
    type(known_t), allocatable :: known(:)       !< periodic motions found, attracting or not
    integer :: in_full_contact = 0               !< which of them is that in full contact; 0: none attracts
    integer, allocatable :: to(:)                !< of each start, which of them captured it; 0: none
    integer :: most_cycles = 0                   !< mesh periods that a start is followed at most
    type(trajectory_t) :: trajectory(batch_size)
  end type search_t

  !> A step of this angle (rad) of the natural motion makes errors of some 1e-7.
  real(dp), parameter :: angle = 0.4_dp
  integer, parameter :: fewest_steps = 16, most_steps = 2**16

  !> Newton's method ends where what is left is far below this, in static deflections.
  real(dp), parameter :: shot_tolerance = 1e-7_dp

  !> Beside so many, no further motions that repel are remembered, as chaos has them without end.
  integer, parameter :: most_known = 100

  !> So many static deflections from a known motion, a motion may be on its way to it.
  real(dp), parameter :: reach = 0.5_dp

contains

  !> The periodic motions that starts lead to, as the search has them, in the order found, and where each start leads to.
  pure subroutine search_motions(osc, duration, options, known, to, status)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration             !< of the mesh period, s
    type(attractor_options_t), intent(in) :: options
    type(known_t), allocatable, intent(out) :: known(:)  !< those that repel are among them
    integer, allocatable, intent(out) :: to(:)   !< of each start, which of these; 0: none; (start)
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
    ! Without damping nothing is captured.
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
    real(dp), intent(in) :: duration             !< of the mesh period, s
    real(dp), parameter :: decays = 5, fewest = 2000, most = 1e5_dp

    by_damping = ceiling(max(fewest, decays/max(decays/most, osc%damping_ratio*osc%natural_frequency*duration)))
  end function by_damping

  !> States from which motions start (m), the middles of the cells of a grid: displacements about the mean deflection, and
  !> velocities with which the natural motion has such amplitudes. (2, start), the displacement varies fastest.
  pure function start_states(osc, duration, options) result(start)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration             !< of the mesh period, s
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

  !> The maps, and the motion in full contact or what Newton's method makes of it.
  pure subroutine begin_search(osc, duration, starts, search, status)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration
    integer, intent(in) :: starts                ! how many
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

  !> A start takes a trajectory.
  pure subroutine enter(start, state, periods, trajectory)
    integer, intent(in) :: start                 ! which
    real(dp), intent(in) :: state(2)
    integer, intent(in) :: periods               ! remembered
    type(trajectory_t), intent(inout) :: trajectory

    trajectory%start = start
    trajectory%length = 0
    trajectory%next_try = 1
    trajectory%next_shot = 1
    trajectory%in_full_contact = 0
    trajectory%approach = approach_t()
    if (.not. allocated(trajectory%state)) allocate (trajectory%state(2, 0:periods), trajectory%monodromy(2, 2, periods))
    trajectory%state(:, 0) = state
  end subroutine enter

  !> A trajectory after one mesh period more: captured, at its end, or to be followed further.
  pure subroutine take_period(run, search, trajectory)
    type(period_t), intent(in) :: run
    type(search_t), intent(inout) :: search
    type(trajectory_t), intent(inout) :: trajectory
    !> Periods in a row in full contact after which a motion stays there: as many phases of its oscillation have been seen.
    integer, parameter :: enough = 12
    integer :: attractor

    if (run%failed .or. .not. distance(search%single%osc, search%duration, run%state) < huge(1.0_dp)) then
      trajectory%start = 0
      return
    end if
    call remember(run, trajectory)
    trajectory%in_full_contact = merge(0, trajectory%in_full_contact + 1, run%departs)
    attractor = 0
    if (trajectory%in_full_contact >= enough) attractor = search%in_full_contact
    if (attractor == 0) call watch(search, trajectory, attractor)
    if (attractor == 0) call try_newton(search, trajectory)
    search%to(trajectory%start) = attractor
    if (attractor > 0 .or. trajectory%length >= search%most_cycles) trajectory%start = 0
  end subroutine take_period

  !> Adds a period to what is remembered of a trajectory.
  pure subroutine remember(run, trajectory)
    type(period_t), intent(in) :: run
    type(trajectory_t), intent(inout) :: trajectory
    integer :: k

    do k = min(trajectory%length + 1, size(trajectory%monodromy, 3)), 2, -1
      trajectory%state(:, k) = trajectory%state(:, k - 1)
      trajectory%monodromy(:, :, k) = matmul(run%monodromy, trajectory%monodromy(:, :, k - 1))
    end do
    trajectory%state(:, 1) = trajectory%state(:, 0)
    trajectory%monodromy(:, :, 1) = run%monodromy
    trajectory%state(:, 0) = run%state
    trajectory%length = trajectory%length + 1
  end subroutine remember

  !> Has a known motion captured that of a trajectory?
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

  !> Newton's method from where the linear maps of the last 1, 2, ... mesh periods promise a periodic motion, unless one is
  !> known there: nearby, where the motion nearly repeats and what is left of its transient decays; now and then, wherever.
  pure subroutine try_newton(search, trajectory)
    type(search_t), intent(inout) :: search
    type(trajectory_t), intent(inout) :: trajectory
    real(dp), parameter :: promising = 2, nearby = 0.25_dp    ! static deflections
    type(steady_t) :: steady
    real(dp) :: defect(2), step(2), difference(2)
    integer :: periods, motion, which
    logical :: solved, anywhere, repeats

    anywhere = trajectory%length >= trajectory%next_try
    if (.not. (anywhere .or. trajectory%length >= trajectory%next_shot)) return
    do periods = 1, min(size(trajectory%monodromy, 3), trajectory%length)
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
      trajectory%next_shot = trajectory%length + 5 + trajectory%length/5
      exit
    end do
    if (anywhere) trajectory%next_try = 2*trajectory%length
  end subroutine try_newton

  !> Newton's method in full steps, given up as soon as these do not shrink: most tries lead nowhere.
  pure subroutine try_shooting(map, periods, start, steady)
    type(period_map_t), intent(inout) :: map
    integer, intent(in) :: periods               ! mesh periods after which the motion is to repeat
    real(dp), intent(in) :: start(2)             ! m
    type(steady_t), intent(out) :: steady        ! without a result where it does not converge
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

  !> A motion that Newton's method found is known from now on.
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
end module gearsweep_attractor_search
