!> All attracting motions of operating points, and the largest of them in a sweep.
!>
!> Each motion that the search finds is solved to the tolerance; its share of the starts is reported. The points are divided among
!> threads, and the results are the same for any number of them. Where a sweep needs only the motion of largest dynamic factor, a
!> few starts run at many speeds until the motion they excite has decayed; where one ends elsewhere than on a known motion,
!> Newton's method continues from there.
module gearsweep_motion_attractors
  use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
  use, intrinsic :: iso_c_binding, only: c_ptr
  use gearsweep_base, only: claim_memory, code_memory, dp, error_t, fail, has_memory, leader_traps, release_claim, share_traps, &
    str, team, wants_stop
  use gearsweep_motion_contact_set, only: period_t
  use gearsweep_motion_error_estimate, only: accuracy_t, levels_t, need_level, per_doubling, point_t, search_level
  use gearsweep_motion_gauss, only: batch_size
  use gearsweep_motion_known_motions, only: find_nearest_state, known_t, scale_of
  use gearsweep_motion_operating_point, only: refine, solve_point
  use gearsweep_motion_oscillator, only: mesh_period, oscillator_t
  use gearsweep_motion_period, only: run_batch
  use gearsweep_motion_period_map, only: discretise, period_map_t, set_durations
  use gearsweep_motion_periodic_orbit, only: distance
  use gearsweep_motion_resolution, only: resolution_t, scheme_collocation
  use gearsweep_motion_search, only: few_starts, find_first, follow_starts, search_t, start_alike, start_decay
  use gearsweep_motion_steady_motion, only: by_shooting, has_result, status_ok, status_stopped, status_unresolved, &
    steady_options_t, steady_t
  implicit none
  private
  public :: attractor_options_t, attractor_t, attractors_t, all_motions_t, search_motions, start_states, find_attractors, &
            largest_motion, count_motions, largest_reached, take_largest

  !> Attracting motion.
  type :: attractor_t
    type(point_t) :: point                       !< solved to the tolerance
    type(known_t) :: known                       !< result of the search
    integer :: starts = 0                        !< number of starts that lead to it
  end type attractor_t

  !> Attracting motions at one speed, in falling order of the starts that lead to them.
  type :: attractors_t
    type(attractor_t), allocatable :: motion(:)
    integer, allocatable :: to(:)                !< of each start, index of the motion that it leads to; 0: none; (start)
    type(point_t) :: alone                       !< the motion of a sweep that solves each speed by itself
    integer :: alone_is = 0                      !< index of that motion; 0: not among these
    integer :: status = status_stopped           !< ok; unresolved: too many steps; stopped
    logical :: lacks = .false.                   !< memory is too small: nothing was found
  end type attractors_t

  !> Counts of attracting motions; NaN where no search was made, or the speed is too low for it; (speed, relief).
  type :: all_motions_t
    real(dp), allocatable :: motions(:, :)       !< number of attracting motions
    real(dp), allocatable :: largest(:, :)       !< largest dynamic factor found by starts or by a sweep of single speeds
    real(dp), allocatable :: share(:, :)         !< part of the starts that leads to the motion of a sweep of single speeds; 0: none
    logical :: stopped = .false.                 !< true: the caller stopped the search
  end type all_motions_t

  type :: attractor_options_t
    type(accuracy_t) :: accuracy
    integer :: starts = 8                        !< starts along each axis of their grid
    real(dp) :: span = 4                         !< half the width of the grid, in static deflections
    integer :: most_cycles = 0                   !< largest number of mesh periods for a start; 0: `by_damping`
    integer :: most_periods = 8                  !< largest period of the motions sought, in mesh periods
    integer :: threads = 0                       !< 0: all threads of the machine
  end type attractor_options_t

  !> Tolerance of the dynamic factor of the motions that starts lead to.
  real(dp), parameter :: search_tolerance = 1e-7_dp

  !> Speeds in memory at a time.
  integer, parameter :: portion = 256

contains

  !> Finds the periodic motions that starts lead to, in the order found, and the motion that each start leads to.
  pure subroutine search_motions(osc, duration, options, known, to, status)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration             !< duration of the mesh period, s
    type(attractor_options_t), intent(in) :: options
    type(known_t), allocatable, intent(out) :: known(:)  !< including those that repel
    integer, allocatable, intent(out) :: to(:)   !< index of the motion; 0: none; (start)
    integer, intent(out) :: status               !< ok; unresolved: too many steps; stopped
    ! Angle of the natural motion in a step, rad. The errors of such steps are about 1e-7.
    real(dp), parameter :: angle = 0.4_dp
    integer, parameter :: fewest_steps = 16, most_steps = 2**16
    type(period_map_t) :: map
    type(search_t) :: search
    type(steady_options_t) :: limits
    real(dp) :: steps

    allocate (known(0))
    allocate (to(options%starts**2), source=0)
    status = status_unresolved
    steps = max(osc%natural_frequency, osc%highest_frequency*max(0.5_dp, osc%damping_ratio))*duration/angle
    if (steps > most_steps) return
    call discretise(osc, resolution_t(max(steps, real(fewest_steps, dp))), map)
    if (map%table%steps == 0) return
    call set_durations(map, [duration])
    limits = steady_options_t(by_shooting, search_tolerance, options%most_cycles, options%most_periods, &
                              options%accuracy%steady%stop)
    if (limits%most_cycles == 0) limits%most_cycles = by_damping(osc, duration)
    call find_first(map, limits, search)
    call follow_starts(map, limits, start_states(osc, duration, options), .false., search)
    status = merge(status_stopped, status_ok, search%stopped)
    call move_alloc(search%known, known)
    to = search%ends%motion
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

  !> Finds all attracting motions at many speeds.
  subroutine find_attractors(osc, rpm, options, found)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm(:)               !< speeds of the pinion, 1/min
    type(attractor_options_t), intent(in) :: options
    type(attractors_t), intent(out) :: found(:)  !< (speed)
    integer :: i
    type(c_ptr) :: traps

    call release_claim()
    traps = leader_traps()
    !$omp parallel default(none) shared(osc, rpm, options, found, traps) num_threads(team(options%threads, size(rpm)))
    call share_traps(traps, 1)
    !$omp do schedule(dynamic, 1)
    do i = 1, size(rpm)
      call attractors_at(osc, mesh_period(osc%mesh%teeth(1), rpm(i)), options, found(i))
    end do
    !$omp end do
    call release_claim()
    call share_traps(traps, 0)
    !$omp end parallel
  end subroutine find_attractors

  !> Finds all attracting motions at one speed.
  pure subroutine attractors_at(osc, duration, options, found)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration             !< duration of the mesh period, s
    type(attractor_options_t), intent(in) :: options
    type(attractors_t), intent(out) :: found
    type(levels_t) :: levels

    call solve_point(osc, duration, options%accuracy, levels, found%alone)
    call search_beside(osc, duration, options, levels, found)
  end subroutine attractors_at

  !> Finds the motion of largest dynamic factor at one speed, among those that starts lead to and the one found without a search.
  !> Where the natural motion decays between the breaks of the stiffness only one motion exists, and no search is made. Nor is one
  !> made with a method of the literature, which does not reproduce every motion of the search.
  pure subroutine largest_motion(osc, duration, options, point, motions, lacks)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration             !< duration of the mesh period, s
    type(attractor_options_t), intent(in) :: options
    type(point_t), intent(out) :: point
    integer, intent(out) :: motions              !< number of motions; 0: unknown, or the search takes too many steps
    logical, intent(out) :: lacks                !< memory is too small
    type(levels_t) :: levels
    type(attractors_t) :: found
    logical :: fits
    integer :: i

    motions = 0
    call solve_point(osc, duration, options%accuracy, levels, point)
    call has_memory(1e4_dp + 40.0_dp*options%starts**2, fits)
    lacks = levels%lacks .or. .not. fits
    if (lacks .or. point%steady%status == status_stopped .or. options%accuracy%scheme /= scheme_collocation) return
    motions = 1
    if (point%resolution%graded_for > 0) return
    found%alone = point
    call search_beside(osc, duration, options, levels, found)
    lacks = found%lacks
    if (found%status == status_stopped) point%steady%status = status_stopped
    if (found%status /= status_ok) motions = 0
    if (lacks .or. motions == 0) return
    motions = count(found%motion%starts > 0)
    if (has_result(point%steady%status)) then
      if (found%alone_is == 0) motions = motions + 1
      if (found%alone_is > 0) motions = motions + count([found%motion(found%alone_is)%starts == 0])
    end if
    do i = 1, size(found%motion)
      if (found%motion(i)%starts > 0 .and. i /= found%alone_is .and. is_larger(found%motion(i)%point, point)) &
        point = found%motion(i)%point
    end do
  end subroutine largest_motion

  !> True if this dynamic factor is clearly larger. Of two that agree to rounding the first is kept.
  pure logical function is_larger(point, than)
    type(point_t), intent(in) :: point, than
    real(dp), parameter :: alike = 1e-6_dp

    is_larger = has_result(point%steady%status)
    if (is_larger .and. has_result(than%steady%status)) is_larger = point%dynamic_factor > (1 + alike)*than%dynamic_factor
  end function is_larger

  !> Finds all motions at one speed, given the one found without a search.
  pure subroutine search_beside(osc, duration, options, levels, found)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration             !< duration of the mesh period, s
    type(attractor_options_t), intent(in) :: options
    type(levels_t), intent(inout) :: levels
    type(attractors_t), intent(inout) :: found   !< `alone` is known
    type(known_t), allocatable :: known(:)
    integer, allocatable :: to(:), rank(:)
    integer :: i

    call search_motions(osc, duration, options, known, to, found%status)
    allocate (found%motion(count(known%attracts)), found%to(size(to)))
    found%to = 0
    if (found%status == status_stopped) return
    rank = most_first(known, [(count(to == i), i=1, size(known))])
    do i = 1, size(rank)
      where (to == rank(i)) found%to = i
      found%motion(i)%known = known(rank(i))
      found%motion(i)%starts = count(to == rank(i))
      if (is_of(osc, duration, found%alone, known(rank(i)))) then
        if (found%alone_is == 0) found%alone_is = i
        found%motion(i)%point = found%alone
      else
        call solve_known(osc, duration, options%accuracy, levels, found%motion(i))
      end if
      if (found%motion(i)%point%steady%status == status_stopped) found%status = status_stopped
    end do
    if (found%alone%steady%status == status_stopped) found%status = status_stopped
    found%lacks = levels%lacks
  end subroutine search_beside

  !> Ranks the attracting motions by falling number of starts; equal ones in the order found.
  pure function most_first(known, starts) result(rank)
    type(known_t), intent(in) :: known(:)
    integer, intent(in) :: starts(:)             ! number of starts that lead to each
    integer, allocatable :: rank(:)
    integer :: i, k

    allocate (rank(0))
    do i = 1, size(starts)
      if (.not. known(i)%attracts) cycle
      k = count(starts(rank) >= starts(i))
      rank = [rank(:k), i, rank(k + 1:)]
    end do
  end function most_first

  !> Solves a motion to the tolerance: as an operating point that starts on it or, if that leads elsewhere, by Newton's method
  !> over its mesh periods.
  pure subroutine solve_known(osc, duration, options, levels, motion)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration
    type(accuracy_t), intent(in) :: options
    type(levels_t), intent(inout) :: levels
    type(attractor_t), intent(inout) :: motion
    type(accuracy_t) :: by_newton
    type(point_t) :: points(1)
    logical :: solved(1)

    levels%steps_per_second = 0
    if (motion%known%steady%departs) then
      call solve_point(osc, duration, options, levels, motion%point, motion%known%state(:, 1))
    else
      call solve_point(osc, duration, options, levels, motion%point)
    end if
    if (motion%point%steady%status == status_stopped .or. levels%lacks) return
    if (is_of(osc, duration, motion%point, motion%known)) return
    if (options%scheme /= scheme_collocation .or. options%steps > 0) return
    by_newton = options
    by_newton%steady%method = by_shooting
    call refine(osc, [duration], by_newton, resolution_t(), levels, points, solved, motion%known%steady)
    motion%point = points(1)
  end subroutine solve_known

  !> True if this point, solved to the tolerance, is a known motion.
  pure logical function is_of(osc, duration, point, known)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration
    type(point_t), intent(in) :: point
    type(known_t), intent(in) :: known
    real(dp), parameter :: close = 0.01_dp       ! static deflections
    real(dp) :: difference(2)
    integer :: i

    is_of = has_result(point%steady%status) .and. point%steady%periods == size(known%state, 2)
    if (.not. is_of) return
    call find_nearest_state(known, point%steady%state, scale_of(osc, duration), i, difference)
    is_of = maxval(abs(difference)) < close
  end function is_of

  !> Searches at all speeds and with all reliefs if it is wanted, else sets the counts to NaN.
  subroutine count_motions(osc, rpm, options, wanted, found, error)
    type(oscillator_t), intent(in) :: osc(:)     !< one for each relief
    real(dp), intent(in) :: rpm(:)               !< speeds of the pinion, 1/min
    type(attractor_options_t), intent(in) :: options
    logical, intent(in) :: wanted
    type(all_motions_t), intent(out) :: found
    type(error_t), allocatable, intent(inout) :: error
    type(attractors_t), allocatable :: some(:)
    integer :: i, first, last

    allocate (found%motions(size(rpm), size(osc)), source=ieee_value(1.0_dp, ieee_quiet_nan))
    found%largest = found%motions
    found%share = found%motions
    if (.not. wanted) return
    call claim_memory(portion*(1e4_dp + 40.0_dp*options%starts**2), 'all motions at '//str(portion)//' speeds', error)
    do i = 1, size(osc)
      do first = 1, size(rpm), portion
        if (allocated(error) .or. found%stopped) return
        last = min(first + portion - 1, size(rpm))
        allocate (some(last - first + 1))
        call find_attractors(osc(i), rpm(first:last), options, some)
        if (any(some%lacks)) call fail(error, code_memory, 'sweep: the memory does not hold all motions at a speed')
        found%stopped = any(some%status == status_stopped)
        if (.not. found%stopped) call summarise(some, found%motions(first:last, i), found%largest(first:last, i), &
                                                found%share(first:last, i))
        deallocate (some)
      end do
    end do
  end subroutine count_motions

  elemental subroutine summarise(found, motions, largest, share)
    type(attractors_t), intent(in) :: found
    real(dp), intent(inout) :: motions, largest, share

    if (found%status /= status_ok) return
    motions = size(found%motion)
    largest = largest_reached(found)
    share = 0
    if (found%alone_is > 0) share = found%motion(found%alone_is)%starts/real(size(found%to), dp)
  end subroutine summarise

  !> Largest dynamic factor of the motions reached by a start or by a sweep of single speeds; NaN if there is none.
  pure real(dp) function largest_reached(found) result(largest)
    type(attractors_t), intent(in) :: found
    logical :: counts(size(found%motion))

    largest = ieee_value(1.0_dp, ieee_quiet_nan)
    counts = found%motion%starts > 0
    if (found%alone_is > 0) counts(found%alone_is) = .true.
    counts = counts .and. has_result(found%motion%point%steady%status)
    if (any(counts)) largest = maxval(found%motion%point%dynamic_factor, mask=counts)
  end function largest_reached

  !> Replaces the motion at each solved speed by the one of largest dynamic factor, and counts the motions found. Where the
  !> natural motion decays between the breaks of the stiffness there is only one.
  subroutine take_largest(osc, rpm, options, levels, points)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm(:)               !< speeds of the pinion, ascending, 1/min
    type(accuracy_t), intent(in) :: options
    type(levels_t), intent(inout) :: levels      !< levels of this oscillator
    type(point_t), intent(inout) :: points(:)    !< in: found by themselves; out: the largest; (speed)
    integer, allocatable :: here(:), level(:)
    integer :: first, i, last

    points%motions = merge(1, 0, has_result(points%steady%status))
    here = pack([(i, i=1, size(rpm))], points%motions > 0 .and. points%resolution%graded_for == 0)
    if (.not. osc%damping_ratio > 0 .or. size(here) == 0) return
    level = [(search_level(osc, mesh_period(osc%mesh%teeth(1), rpm(here(i))), options), i=1, size(here))]
    first = 1
    do while (first <= size(here))
      if (levels%lacks .or. wants_stop(options%steady%stop)) return
      last = first
      do while (last < min(size(here), first + batch_size - 1))
        if (level(last + 1) /= level(first)) exit
        last = last + 1
      end do
      call compare_ends(osc, rpm(here(first:last)), level(first), options, levels, points, here(first:last))
      first = last + 1
    end do
  end subroutine take_largest

  !> Accuracy options that stop early from a start that leads to no motion.
  pure type(accuracy_t) function in_brief(options)
    type(accuracy_t), intent(in) :: options

    in_brief = options
    in_brief%steady%most_cycles = min(options%steady%most_cycles, 20)
  end function in_brief

  !> Searches the motions of a few speeds on one refinement level.
  subroutine compare_ends(osc, rpm, level, options, levels, points, at)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm(:)
    integer, intent(in) :: level
    type(accuracy_t), intent(in) :: options
    type(levels_t), intent(inout) :: levels
    type(point_t), intent(inout) :: points(:)
    integer, intent(in) :: at(:)                 ! indices of the points
    type(point_t) :: new
    real(dp) :: duration(size(rpm)), end(2, size(rpm), size(few_starts, 2)), known(2, size(few_starts, 2) + 1)
    logical :: bounded(size(rpm), size(few_starts, 2))
    integer :: i, n, s

    duration = mesh_period(osc%mesh%teeth(1), rpm)
    call need_level(osc, level, levels)
    if (levels%lacks) return
    call run_starts(osc, duration, level - per_doubling, levels, end, bounded)
    do i = 1, size(rpm)
      n = 1
      known(:, 1) = points(at(i))%steady%state
      do s = 1, size(few_starts, 2)
        if (.not. bounded(i, s)) cycle
        if (is_known(end(:, i, s))) cycle
        call solve_point(osc, duration(i), in_brief(options), levels, new, end(:, i, s))
        if (levels%lacks) return
        if (.not. has_result(new%steady%status)) cycle
        if (is_known(new%steady%state)) cycle
        n = n + 1
        known(:, n) = new%steady%state
        associate (point => points(at(i)))
          ! Only the first state of a motion that repeats after several periods is known.
          if (new%steady%periods == point%steady%periods .and. new%steady%periods > 1 .and. &
              abs(new%dynamic_factor - point%dynamic_factor) <= new%estimate + point%estimate) cycle
          new%motions = point%motions + 1
          point%motions = new%motions
          if (new%dynamic_factor > point%dynamic_factor) point = new
        end associate
      end do
    end do

  contains

    pure logical function is_known(state)
      real(dp), intent(in) :: state(2)
      integer :: k

      is_known = any([(distance(osc, duration(i), state - known(:, k)) < start_alike, k=1, n)])
    end function is_known
  end subroutine compare_ends

  !> Integrates each start over the number of turns in which the natural motion decays to a small part.
  subroutine run_starts(osc, duration, level, levels, end, bounded)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration(:)          ! duration of the mesh period, s; (speed)
    integer, intent(in) :: level
    type(levels_t), intent(inout) :: levels
    real(dp), intent(out) :: end(:, :, :)        ! m; (2, speed, start)
    logical, intent(out) :: bounded(:, :)
    real(dp), parameter :: most_periods = 1000
    type(period_t) :: run(batch_size)
    real(dp) :: state(2, batch_size), periods
    integer :: i, k, l, n, s, turn, turns

    n = size(duration)
    periods = start_decay/(osc%damping_ratio*osc%natural_frequency*minval(duration))
    turns = ceiling(min(periods, most_periods)/osc%mesh%deviations%periods)
    associate (map => levels%level(level)%map)
      do k = 0, size(bounded) - 1, batch_size
        call set_durations(map, [(duration(1 + modulo(min(k + l, size(bounded) - 1), n)), l=0, batch_size - 1)])
        do l = 1, batch_size
          s = 1 + min(k + l - 1, size(bounded) - 1)/n
          state(:, l) = [osc%mean_deflection + osc%static_deflection*few_starts(1, s), &
                         osc%static_deflection*osc%natural_frequency*map%duration(l)*few_starts(2, s)]
        end do
        do turn = 1, turns
          call run_batch(map, state, [(.true., l=1, batch_size)], .false., run)
          do l = 1, batch_size
            state(:, l) = run(l)%state
          end do
        end do
        do l = 1, min(batch_size, size(bounded) - k)
          i = 1 + modulo(k + l - 1, n)
          s = 1 + (k + l - 1)/n
          end(:, i, s) = state(:, l)
          bounded(i, s) = .not. run(l)%failed .and. distance(osc, duration(i), state(:, l)) < 1e4_dp
        end do
      end do
    end associate
  end subroutine run_starts
end module gearsweep_motion_attractors
