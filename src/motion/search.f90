!> Search for the periodic motions that starts lead to.
!>
!> The motions from the starts are computed side by side, each until a known motion has captured it or until it is chaotic. Where
!> the linear maps of its last mesh periods predict a periodic motion, Newton's method finds that motion and adds it to the known
!> ones. With marching, Newton's method is not used: a motion is found when it repeats.
!>
!> The first start of Newton's method is the motion that full contact would have. If it finds a motion that repels through a
!> multiplier below -1, a motion of twice as many periods is sought near that.
module gearsweep_motion_search
  use gearsweep_base, only: dp, wants_stop
  use gearsweep_motion_contact_set, only: join, period_t
  use gearsweep_motion_gauss, only: batch_size
  use gearsweep_motion_known_motions, only: add_known, approach_t, find_nearest, find_nearest_state, known_t, scale_of, &
    watch_approach
  use gearsweep_motion_period, only: run_batch, run_period
  use gearsweep_motion_period_map, only: period_map_t, set_durations
  use gearsweep_motion_periodic_orbit, only: closure_of, distance, is_bounded, judge, largest_multiplier, most_negative_direction, &
    most_work, near, newton_step, run_periods, shoot, solve_full_contact
  use gearsweep_motion_steady_motion, only: by_marching, has_result, seen_t, status_chaotic, status_chatter, status_transient, &
    status_unbounded, status_unstable, steady_options_t, steady_t
  implicit none
  private
  public :: growth_t, search_t, find_first, find_from, follow_starts, double, few_starts, start_alike, start_decay, sure_growth

  !> Starts around rest: displacement from the mean deflection, and velocity over the natural frequency, in static deflections. Two
  !> whose ends are nearer than `start_alike` are on one motion, once the natural motion has decayed by exp(-start_decay).
  real(dp), parameter :: few_starts(2, 6) = reshape( &
    [0.0_dp, 0.0_dp, 3.5_dp, -3.5_dp, 3.5_dp, 3.5_dp, 3.0_dp, 0.0_dp, -2.0_dp, 2.0_dp, -2.0_dp, -2.0_dp], [2, 6])
  real(dp), parameter :: start_alike = 0.05_dp, start_decay = 5.3_dp

  !> Growth of a small disturbance of a motion, computed from the monodromy matrix of each mesh period.
  type :: growth_t
    real(dp) :: disturbance(2) = 1               !< x, and y over its unit; of length 1
    real(dp) :: logarithm = 0                    !< logarithm of its growth since the period `first_counted`
    integer :: periods = 0                       !< mesh periods
  contains
    procedure :: add
    procedure :: is_sure
    procedure :: per_period
  end type growth_t

  !> Motion that is followed from one start.
  type :: trajectory_t
    integer :: start = 0                         !< index of its start; 0: none
    integer :: next_try = 1                      !< mesh periods after which any motion is tried next
    integer :: next_shot = 1                     !< mesh periods after which a motion that nearly repeats is tried next
    integer :: in_full_contact = 0               !< periods in a row
    type(growth_t) :: growth
    type(approach_t) :: approach
    real(dp), allocatable :: state(:, :)         !< last states, the newest first, m; (2, 0:periods)
    real(dp), allocatable :: monodromy(:, :, :)  !< monodromy matrices of the last 1, 2, ... periods; (2, 2, periods)
  end type trajectory_t

  !> Where the motion from a start ends.
  type :: end_t
    integer :: motion = 0                        !< index of the known motion that captured it; 0: none
    integer :: status = status_transient         !< without such a motion: chatter, unbounded, chaotic or transient
    real(dp) :: growth = 0                       !< logarithmic growth of a disturbance over a mesh period
    real(dp) :: state(2) = 0                     !< last state, m
  end type end_t

  !> Result of the search at one speed.
  type :: search_t
    type(known_t), allocatable :: known(:)       !< periodic motions found, attracting or not
    integer :: in_full_contact = 0               !< index of the one in full contact; 0: none attracts
    type(end_t), allocatable :: ends(:)          !< (start)
    !> Observations of the motion from a single start, and its contact, from the period `first_watched` on.
    type(steady_t) :: watched
    logical :: stopped = .false.                 !< the caller ended the search
  end type search_t

  !> Logarithmic growth above which a bounded motion cannot be periodic: its disturbances have grown by more than exp(40) over its
  !> periods, of which there must be at least `enough`.
  real(dp), parameter :: sure_growth = 40
  integer, parameter :: first_counted = 50, enough = 500, first_watched = 250

contains

  !> Finds the motion in full contact or, by Newton's method from there, another one and those of twice as many periods.
  pure subroutine find_first(map, options, search)
    type(period_map_t), intent(inout) :: map     !< map with the duration of one speed
    type(steady_options_t), intent(in) :: options
    type(search_t), intent(out) :: search
    type(steady_t) :: steady, doubled
    real(dp) :: linear(2)
    integer :: which

    allocate (search%known(0))
    if (options%method == by_marching) return
    call solve_full_contact(map, linear, steady)
    if (.not. has_result(steady%status)) call shoot(map, options%tolerance, 1, linear, steady)
    call add_known(map, steady, search%known, which)
    if (has_result(steady%status) .and. .not. steady%departs) search%in_full_contact = which
    if (steady%status /= status_unstable .or. allocated(map%literature)) return
    call double(map, options, steady, doubled)
    call add_known(map, doubled, search%known, which)
  end subroutine find_first

  !> Finds a motion from some starts within a number of mesh periods: one that a start leads to or, of several starts, one that
  !> attracts and was found on the way.
  pure subroutine find_from(map, options, most_cycles, starts, search, motion)
    type(period_map_t), intent(inout) :: map     !< map with the duration of one speed
    type(steady_options_t), intent(in) :: options
    integer, intent(in) :: most_cycles           !< mesh periods, if the options do not allow fewer
    real(dp), intent(in) :: starts(:, :)         !< states, m; (2, start)
    type(search_t), intent(inout) :: search      !< in: motions known before
    integer, intent(out) :: motion               !< index of the known motion; 0: none
    type(steady_options_t) :: brief

    brief = options
    brief%most_cycles = min(most_cycles, options%most_cycles)
    ! Without damping no motion captures another, and those that repeat soon are near the starts.
    if (.not. map%osc%damping_ratio > 0) brief%most_cycles = min(brief%most_cycles, 2)
    call follow_starts(map, brief, starts, .true., search)
    motion = maxval(search%ends%motion)
    if (motion == 0 .and. size(starts, 2) > 1) motion = findloc(search%known%attracts, .true., 1)
  end subroutine find_from

  !> Follows the motions from some starts to their ends.
  pure subroutine follow_starts(map, options, starts, is_one_enough, search)
    type(period_map_t), intent(inout) :: map     !< map with the duration of one speed
    type(steady_options_t), intent(in) :: options
    real(dp), intent(in) :: starts(:, :)         !< states, m; (2, start)
    logical, intent(in) :: is_one_enough         !< true: ends as soon as one motion is found
    type(search_t), intent(inout) :: search      !< in: motions known before
    type(period_map_t), allocatable :: batch
    type(trajectory_t) :: lane(min(size(starts, 2), batch_size))
    type(period_t) :: run(batch_size)
    real(dp) :: state(2, batch_size)
    logical :: active(batch_size)
    real(dp) :: before
    integer :: next, l, most_cycles

    before = map%work
    most_cycles = options%most_cycles
    if (.not. map%osc%damping_ratio > 0) most_cycles = min(most_cycles, 2*options%most_periods)
    search%ends = [(end_t(state=starts(:, l)), l=1, size(starts, 2))]
    search%watched = steady_t()
    if (size(lane) > 1) then
      batch = map
      call set_durations(batch, [(map%duration(1), l=1, batch_size)])
    end if
    next = 1
    active = .false.
    state = spread(starts(:, 1), 2, batch_size)
    do
      do l = 1, size(lane)
        if (lane(l)%start == 0 .and. next <= size(starts, 2)) then
          call enter(next, starts(:, next), options%most_periods, lane(l))
          if (size(lane) == 1) lane(l)%next_try = huge(1)
          next = next + 1
        end if
        active(l) = lane(l)%start > 0
        if (active(l)) state(:, l) = lane(l)%state(:, 0)
      end do
      if (.not. any(active)) exit
      search%stopped = wants_stop(options%stop)
      if (search%stopped) exit
      if (size(lane) > 1) then
        call run_batch(batch, state, active, .false., run)
        map%work = map%work + real(map%steps, dp)*count(active)
      else
        call run_period(map, state(:, 1), run(1), peaks=lane(1)%growth%periods >= first_watched)
        if (lane(1)%growth%periods >= first_watched .and. .not. run(1)%failed) &
          call watch(run(1), map%osc%mesh%deviations%periods, search%watched)
      end if
      do l = 1, size(lane)
        if (.not. active(l)) cycle
        call continue_by(run(l), map, options, is_one_enough, search, lane(l))
        if (lane(l)%growth%periods >= min(most_cycles, max(1, int(most_work/map%steps)))) lane(l)%start = 0
      end do
      if (.not. is_one_enough) cycle
      if (any(search%ends%motion > 0) .or. size(lane) > 1 .and. any(search%known%attracts)) exit
      if (map%work - before > most_work) exit
    end do
  end subroutine follow_starts

  !> Adds the observations of one run of the map, over this many mesh periods.
  pure subroutine watch(run, periods, watched)
    type(period_t), intent(in) :: run
    integer, intent(in) :: periods
    type(steady_t), intent(inout) :: watched

    watched%departs = watched%departs .or. run%departs
    watched%partial = watched%partial .or. run%partial
    watched%lost = watched%lost .or. run%lost
    watched%coast = watched%coast .or. run%coast
    watched%seen = seen_t(watched%seen%periods + periods, max(watched%seen%peak, run%peak), join(watched%seen%dte, run%dte))
  end subroutine watch

  !> Assigns a start to a lane.
  pure subroutine enter(start, state, periods, trajectory)
    integer, intent(in) :: start                 ! index of the start
    real(dp), intent(in) :: state(2)
    integer, intent(in) :: periods               ! number of periods stored
    type(trajectory_t), intent(out) :: trajectory

    trajectory%start = start
    allocate (trajectory%state(2, 0:periods), trajectory%monodromy(2, 2, periods), source=0.0_dp)
    trajectory%state(:, 0) = state
  end subroutine enter

  !> Continues a motion by one mesh period: it is captured, is chaotic, ends or goes on.
  pure subroutine continue_by(run, map, options, is_one_enough, search, trajectory)
    type(period_t), intent(in) :: run
    type(period_map_t), intent(inout) :: map     ! map with the duration of one speed
    type(steady_options_t), intent(in) :: options
    logical, intent(in) :: is_one_enough
    type(search_t), intent(inout) :: search
    type(trajectory_t), intent(inout) :: trajectory
    ! Mesh periods in a row with all pairs in contact after which the motion in full contact has captured a motion.
    integer, parameter :: stays = 12
    real(dp) :: scale(2)
    integer :: motion, status

    scale = scale_of(map%osc, map%duration(1))
    motion = 0
    status = status_transient
    if (run%failed) then
      status = status_chatter
    else if (.not. is_bounded(map%osc, map%duration(1), run%state)) then
      status = status_unbounded
    else
      call remember(run, scale(2)/scale(1), trajectory)
      if (options%method == by_marching) then
        call watch_return(map, options, scale, search%known, trajectory, motion)
      else
        if (trajectory%in_full_contact >= stays) motion = search%in_full_contact
        if (motion == 0) call watch_approach(search%known, run%state, scale, trajectory%approach, motion)
        if (motion == 0) call try_newton(map, options, scale, is_one_enough, search%known, trajectory, motion)
      end if
      if (trajectory%growth%is_sure()) status = status_chaotic
    end if
    search%ends(trajectory%start) = end_t(motion, status, trajectory%growth%per_period(), trajectory%state(:, 0))
    if (motion > 0 .or. status /= status_transient) trajectory%start = 0
  end subroutine continue_by

  !> Adds a period to the stored history of a motion; `unit` is that of y in a disturbance.
  pure subroutine remember(run, unit, trajectory)
    type(period_t), intent(in) :: run
    real(dp), intent(in) :: unit
    type(trajectory_t), intent(inout) :: trajectory
    real(dp) :: one(2, 2)
    integer :: k

    one = limited(run%monodromy)
    do k = min(trajectory%growth%periods + 1, size(trajectory%monodromy, 3)), 2, -1
      trajectory%state(:, k) = trajectory%state(:, k - 1)
      trajectory%monodromy(:, :, k) = limited(matmul(one, trajectory%monodromy(:, :, k - 1)))
    end do
    trajectory%state(:, 1) = trajectory%state(:, 0)
    trajectory%monodromy(:, :, 1) = one
    trajectory%state(:, 0) = run%state
    trajectory%in_full_contact = merge(0, trajectory%in_full_contact + 1, run%departs)
    call trajectory%growth%add(one, unit)
  end subroutine remember

  !> Limits disturbances over many turns, which may overflow; their size beyond the limit does not matter.
  pure function limited(a) result(b)
    real(dp), intent(in) :: a(2, 2)
    real(dp), parameter :: largest = 1e140_dp    ! its square does not overflow
    real(dp) :: b(2, 2)

    b = a
    if (maxval(abs(a)) > largest) b = a*(largest/maxval(abs(a)))
  end function limited

  !> Follows the disturbance over one more mesh period.
  pure subroutine add(self, monodromy, unit)
    class(growth_t), intent(inout) :: self
    real(dp), intent(in) :: monodromy(2, 2)
    real(dp), intent(in) :: unit                 !< unit of y
    real(dp) :: size

    self%periods = self%periods + 1
    self%disturbance = matmul(monodromy, self%disturbance*[1.0_dp, unit])/[1.0_dp, unit]
    size = max(norm2(self%disturbance), tiny(size))
    self%disturbance = self%disturbance/size
    if (self%periods > first_counted) self%logarithm = self%logarithm + log(size)
  end subroutine add

  !> True if a bounded motion is chaotic.
  pure logical function is_sure(self)
    class(growth_t), intent(in) :: self

    is_sure = self%periods >= enough .and. self%logarithm > sure_growth
  end function is_sure

  !> Logarithm of the mean growth over a mesh period.
  pure real(dp) function per_period(self)
    class(growth_t), intent(in) :: self

    per_period = self%logarithm/max(1, self%periods - first_counted)
  end function per_period

  !> Tries Newton's method where the linear maps of the last 1, 2, ... mesh periods predict a periodic motion that is not known. A
  !> motion that nearly repeats, while its transient decays, is tried a few periods after the last try; any motion, at intervals
  !> that grow. If one motion is enough, the predicted one captures a motion that nearly repeats in its neighbourhood.
  pure subroutine try_newton(map, options, scale, is_one_enough, known, trajectory, captured)
    type(period_map_t), intent(inout) :: map
    type(steady_options_t), intent(in) :: options
    real(dp), intent(in) :: scale(2)
    logical, intent(in) :: is_one_enough
    type(known_t), allocatable, intent(inout) :: known(:)
    type(trajectory_t), intent(inout) :: trajectory
    integer, intent(inout) :: captured           ! index of the motion predicted
    type(steady_t) :: steady
    real(dp) :: step(2), difference(2)
    integer :: periods, motion, which
    logical :: anywhere, repeats, is_promising, is_known

    anywhere = trajectory%growth%periods >= trajectory%next_try
    if (.not. (anywhere .or. trajectory%growth%periods >= trajectory%next_shot)) return
    do periods = 1, min(size(trajectory%monodromy, 3), trajectory%growth%periods)
      call predict(trajectory, periods, scale, anywhere, step, repeats, is_promising)
      if (.not. is_promising) cycle
      call find_nearest(known, trajectory%state(:, periods) + step, scale, motion, which, difference)
      is_known = maxval(abs(difference)) < 0.1_dp*min(1.0_dp, maxval(abs(step)/scale))
      if (.not. is_known) then
        call try_shooting(map, options%tolerance, periods, trajectory%state(:, periods) + step, steady)
        call add_known(map, steady, known, motion)
      else if (is_one_enough) then
        is_known = known(motion)%attracts
      end if
      if (repeats .and. .not. is_known) trajectory%next_shot = trajectory%growth%periods + 5 + trajectory%growth%periods/5
      if (motion > 0 .and. repeats .and. is_one_enough) then
        call find_nearest_state(known(motion), trajectory%state(:, 0), scale, which, difference)
        if (known(motion)%attracts .and. maxval(abs(difference)) < near) captured = motion
      end if
      if (captured > 0 .or. (repeats .or. is_one_enough) .and. .not. is_known) exit
    end do
    if (anywhere) trajectory%next_try = trajectory%growth%periods &
                                        + max(1, trajectory%growth%periods/merge(4, 2, is_one_enough))
  end subroutine try_newton

  !> Predicts a periodic motion from the linear map of the last mesh periods.
  pure subroutine predict(trajectory, periods, scale, anywhere, step, repeats, is_promising)
    type(trajectory_t), intent(in) :: trajectory
    integer, intent(in) :: periods               ! their number
    real(dp), intent(in) :: scale(2)
    logical, intent(in) :: anywhere              ! true: the motion need not nearly repeat
    real(dp), intent(out) :: step(2)             ! from the state before these periods to that of the periodic motion, m
    logical, intent(out) :: repeats              ! the motion nearly repeats, and its disturbances decay
    logical, intent(out) :: is_promising         ! Newton's method may find a motion there
    real(dp), parameter :: farthest = 2, nearby = 0.25_dp     ! static deflections
    real(dp) :: defect(2)

    step = 0
    is_promising = .false.
    defect = trajectory%state(:, 0) - trajectory%state(:, periods)
    repeats = all(abs(defect) < nearby*scale)
    if (repeats) repeats = largest_multiplier(trajectory%monodromy(:, :, periods)) < 1
    if (.not. (repeats .or. anywhere)) return
    call newton_step(trajectory%monodromy(:, :, periods), defect, step, is_promising)
    if (any(abs(step) > merge(farthest, nearby, anywhere)*scale)) is_promising = .false.
  end subroutine predict

  !> Tries Newton's method in full steps, and gives up as soon as these do not shrink: most tries fail.
  pure subroutine try_shooting(map, tolerance, periods, start, steady)
    type(period_map_t), intent(inout) :: map
    real(dp), intent(in) :: tolerance            ! tolerance of the dynamic factor
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
      call run_periods(map, state, periods, .false., run)
      if (run%failed) return
      call newton_step(run%monodromy, run%state - state, step, solved)
      size = distance(map%osc, map%duration(1), step)
      if (.not. solved .or. size > 0.7_dp*last .and. iteration > 2) return
      state = state + step
      last = size
      if (size > small) cycle
      call shoot(map, tolerance, periods, state, steady)
      return
    end do
  end subroutine try_shooting

  !> Finds whether a motion repeats: its distance from the periodic motion that the linear map of its last periods predicts is far
  !> below the tolerance.
  pure subroutine watch_return(map, options, scale, known, trajectory, motion)
    type(period_map_t), intent(inout) :: map
    type(steady_options_t), intent(in) :: options
    real(dp), intent(in) :: scale(2)
    type(known_t), allocatable, intent(inout) :: known(:)
    type(trajectory_t), intent(in) :: trajectory
    integer, intent(inout) :: motion             ! index of that motion, added to the known ones
    type(period_t) :: run
    type(steady_t) :: steady
    real(dp) :: step(2), defect(2)
    integer :: periods
    logical :: repeats, is_promising

    associate (osc => map%osc, duration => map%duration(1), state => trajectory%state(:, 0))
      do periods = 1, min(options%most_periods, trajectory%growth%periods)
        call predict(trajectory, periods, scale, .false., step, repeats, is_promising)
        if (.not. is_promising) cycle
        defect = state - trajectory%state(:, periods)
        if (max(distance(osc, duration, defect), distance(osc, duration, step - defect)) > 1e-3_dp*options%tolerance) cycle
        call run_periods(map, state, periods, .true., run)
        call judge(osc, duration, state, run, closure_of(osc, duration, state, run), periods, steady)
        if (has_result(steady%status)) call add_known(map, steady, known, motion)
        return
      end do
    end associate
  end subroutine watch_return

  !> Continues from a motion that repels through a multiplier below -1 to one of twice as many periods, until that attracts.
  pure subroutine double(map, options, repelling, steady)
    type(period_map_t), intent(inout) :: map         !< map with the duration of one speed
    type(steady_options_t), intent(in) :: options
    type(steady_t), intent(in) :: repelling          !< otherwise unchanged
    type(steady_t), intent(out) :: steady            !< with a result if one was found
    type(steady_t) :: last

    last = repelling
    do while (last%status == status_unstable .and. 2*last%periods <= options%most_periods)
      call double_once(map, options%tolerance, last, steady)
      last = steady
    end do
  end subroutine double

  !> Finds the motion of twice as many periods, from starts along the direction in which disturbances grow.
  pure subroutine double_once(map, tolerance, last, next)
    type(period_map_t), intent(inout) :: map
    real(dp), intent(in) :: tolerance
    type(steady_t), intent(in) :: last
    type(steady_t), intent(out) :: next
    real(dp), parameter :: away(*) = [0.1_dp, 0.3_dp, 1.0_dp], same = 1e-5_dp
    type(period_t) :: run
    type(steady_t) :: found
    real(dp) :: direction(2)
    logical :: doubles
    integer :: i

    associate (osc => map%osc, duration => map%duration(1))
      call run_periods(map, last%state, last%periods, .false., run)
      call most_negative_direction(osc, duration, run%monodromy, direction, doubles)
      if (.not. doubles) return
      do i = 1, size(away)
        call shoot(map, tolerance, 2*last%periods, last%state + away(i)*osc%static_deflection*direction, found)
        if (.not. distance(osc, duration, found%state - last%state) > same) cycle
        if (has_result(found%status) .or. (found%status == status_unstable .and. next%status /= status_unstable)) next = found
        if (has_result(next%status)) return
      end do
    end associate
  end subroutine double_once
end module gearsweep_motion_search
