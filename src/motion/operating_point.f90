!> Operating points to a tolerance: each is solved with some number of steps and with half of it until the estimated error is
!> small.
!>
!> Graded steps are used where the natural motion decays from break to break, so that one motion attracts: they are short after
!> breaks and grow as it decays. After its decay the motion follows the static one, so that pairs close and open near the places
!> where they begin and cease to carry the static load: those are breaks too.
module gearsweep_motion_operating_point
  use gearsweep_base, only: dp, wants_stop
  use gearsweep_motion_resolution, only: graded_steps, resolution_t, scheme_collocation
  use gearsweep_motion_error_estimate, only: accuracy_t, compare, first_guess, first_level, given, given_resolution, given_steps, &
    graded, half_given, half_graded, is_estimated, last_level, leave_unknown, level_steps, levels_t, mark_inexact, need_given, &
    need_graded, need_level, next_level, per_doubling, point_t, resolution_of, root, search_level
  use gearsweep_motion_gauss, only: batch_size
  use gearsweep_motion_oscillator, only: oscillator_t, resolving_steps, split_by_load
  use gearsweep_motion_period_map, only: period_map_t, set_durations
  use gearsweep_motion_periodic_orbit, only: distance, has_converged, near, shoot, solve_full_contact, steady_t
  use gearsweep_motion_steady, only: find_batch, find_converged, find_steady, is_one_branch
  use gearsweep_motion_steady_motion, only: by_shooting, has_result, status_aperiodic, status_stopped, status_transient, &
    status_unresolved, steady_options_t
  implicit none
  private
  public :: solve_point, solve_batch, refine

  !> Largest number of resolutions tried for one operating point.
  integer, parameter :: most_trials = 12
  !> Largest number of equal steps for a batch of speeds.
  real(dp), parameter :: most_batch_steps = 4096

contains

  !> Selects graded steps, as many as the tolerance may need, if they are fewer than half of equal ones; else equal steps
  !> (`graded_for` 0).
  pure type(resolution_t) function graded_resolution(osc, duration, options, levels) result(resolution)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration(:)          !< duration of the mesh period at each speed, s
    type(accuracy_t), intent(in) :: options
    type(levels_t), intent(in) :: levels
    ! Steps per radian after the break in the coarser of the two solutions, at a tolerance of 1e-6 or more.
    real(dp), parameter :: dense = 0.8_dp
    real(dp) :: shortest, longest, equal

    shortest = minval(duration)
    longest = maxval(duration)
    equal = osc%mesh%deviations%periods*max(2*resolving_steps(osc, longest), first_guess(osc, longest, options, levels))
    resolution = resolution_t(dense*max(1.0_dp, 1e-6_dp/options%steady%tolerance)**root*longest/shortest, 2, shortest, &
                              by_load=.true.)
    if (options%steady%method /= by_shooting .or. graded_steps(osc, resolution) > min(equal/2, real(options%most_steps, dp))) &
      resolution = resolution_t()
  end function graded_resolution

  !> Solves one speed, or all of a batch, in steps whose number grows until the estimate of the error is small enough: from full
  !> contact or, at one speed, from a motion found before.
  pure subroutine refine(osc, duration, options, first, levels, points, solved, motion, least)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration(:)          !< duration of the mesh period at each speed, s
    type(accuracy_t), intent(in) :: options
    type(resolution_t), intent(in) :: first      !< first resolution, if it is graded; else equal steps are chosen
    type(levels_t), intent(inout) :: levels      !< levels of this oscillator; lacks: memory is too small for the steps
    type(point_t), intent(inout) :: points(:)    !< (speed)
    logical, intent(out) :: solved(:)            !< (speed)
    !> Motion found with another number of steps, from which Newton's method starts. With marching, its state begins the transient.
    type(steady_t), intent(in), optional :: motion
    integer, intent(in), optional :: least       !< lowest level of equal steps
    type(steady_t) :: full(size(duration)), half(size(duration))
    type(oscillator_t) :: split
    type(resolution_t) :: resolution
    real(dp) :: excess, longest, most_steps
    integer :: level, trial, fine, coarse
    logical :: is_graded, done

    solved = .false.
    points%steady%status = status_unresolved
    resolution = first
    is_graded = first%graded_for > 0
    longest = maxval(duration)
    if (is_graded) then
      split = osc
      call split_by_load(split)
      fine = graded
      coarse = half_graded
    else
      level = first_level(osc, longest, options, levels)
      if (present(least)) level = max(level, least)
      level = min(level, last_level(osc, options))
      most_steps = options%most_steps
      if (size(duration) > 1) most_steps = min(most_steps, most_batch_steps)
    end if
    do trial = 1, most_trials
      solved = .false.
      if (is_graded) then
        call need_graded(split, resolution, levels)
      else
        if (level_steps(level) > most_steps .or. level_steps(level) < 2*resolving_steps(osc, longest)) return
        call need_level(osc, level, levels)
        resolution = resolution_of(level)
        fine = level
        coarse = level - per_doubling
      end if
      if (levels%lacks) return
      call solve_pair(levels%level(fine)%map, levels%level(coarse)%map, duration, options, is_graded, full, half, solved, motion)
      points%steady = full
      if (.not. any(solved)) return
      points%steps = levels%level(fine)%map%steps
      points%resolution = resolution
      call compare(osc, duration, half, points)
      if (is_graded) then
        excess = maxval(points%step_error, mask=solved)/options%steady%tolerance
        resolution%base = resolution%base*min(1.2_dp*excess**0.2_dp, 4.0_dp)
        done = excess <= 1
        if (.not. done) done = graded_steps(split, resolution) > options%most_steps
      else
        call next_level(osc, options, maxval(points%step_error, mask=solved), longest, levels, level, done)
      end if
      if (done) exit
    end do
    call mark_inexact(options, points)
  end subroutine refine

  !> Finds the motions with some number of steps and with half of it: of a batch first with half of it, as a guide.
  pure subroutine solve_pair(fine, coarse, duration, options, is_graded, full, half, solved, motion)
    type(period_map_t), intent(inout) :: fine, coarse
    real(dp), intent(in) :: duration(:)
    type(accuracy_t), intent(in) :: options
    logical, intent(in) :: is_graded
    type(steady_t), intent(out) :: full(:), half(:)
    logical, intent(out) :: solved(:)            !< (speed)
    type(steady_t), intent(in), optional :: motion
    ! The solution with half the steps has a weight of a twentieth, so that its Newton iterations may end earlier.
    real(dp), parameter :: loose = 1000

    call set_durations(fine, duration, options%steady%stop)
    if (size(duration) == batch_size) then
      solved = .false.
      call set_durations(coarse, duration, options%steady%stop)
      call find_batch(coarse, loose*options%steady%tolerance, half)
      if (.not. any(has_converged(half))) return
      call find_batch(fine, options%steady%tolerance, full, half)
      solved = has_converged(half) .and. has_converged(full)
    else
      if (options%steady%method /= by_shooting) then
        call find_steady(fine, options%steady, full(1), motion%state)
        solved = has_result(full(1)%status)
      else if (present(motion)) then
        call shoot(fine, options%steady%tolerance, motion%periods, motion%state, full(1))
        solved = has_result(full(1)%status) .and. distance(fine%osc, duration(1), full(1)%state - motion%state) < near
      else
        call find_converged(fine, options%steady%tolerance, full(1))
        ! In graded steps one motion attracts.
        solved = has_converged(full(1)) .and. (is_graded .or. .not. full(1)%departs .or. is_one_branch(fine%osc, full(1)%partial))
      end if
      if (solved(1)) call find_half(coarse, duration(1), options, full(1), half(1))
    end if
  end subroutine solve_pair

  !> Finds a motion in other steps.
  pure subroutine find_half(coarse, duration, options, motion, half)
    type(period_map_t), intent(inout) :: coarse
    real(dp), intent(in) :: duration
    type(accuracy_t), intent(in) :: options
    type(steady_t), intent(in) :: motion         !< with a result
    type(steady_t), intent(out) :: half          !< without a result if there is none near
    type(steady_options_t) :: alike
    real(dp) :: linear(2)

    call set_durations(coarse, [duration], options%steady%stop)
    if (.not. motion%departs) call solve_full_contact(coarse, linear, half)
    if (has_converged(half)) return
    call shoot(coarse, options%steady%tolerance, motion%periods, motion%state, half)
    ! The methods of the literature do not locate changes of contact: their period map has jumps, and Newton's method may fail.
    if (options%scheme == scheme_collocation .or. has_result(half%status)) return
    alike = options%steady
    alike%method = by_shooting
    call find_steady(coarse, alike, half, motion%state)
  end subroutine find_half

  !> Solves the operating point at one speed, on the branch that `start` leads to.
  pure subroutine solve_point(osc, duration, options, levels, point, start)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration             !< duration of the mesh period, s
    type(accuracy_t), intent(in) :: options
    type(levels_t), intent(inout) :: levels      !< levels of this oscillator; lacks: memory is too small for the steps
    type(point_t), intent(out) :: point
    real(dp), intent(in), optional :: start(2)   !< state, m; without it, see `find_steady`

    point%steady%status = status_unresolved
    if (levels%lacks) return
    if (options%steps > 0 .or. options%scheme /= scheme_collocation) then
      call solve_with_steps(osc, duration, options, levels, point, start)
    else
      call solve_by_levels(osc, duration, options, levels, point, start)
    end if
    if (wants_stop(options%steady%stop)) point%steady%status = status_stopped
  end subroutine solve_point

  !> Solves one speed with steps chosen for the tolerance. If the motion is neither in full contact nor near `start`, it is searched
  !> on a level of its own, and found from there on the others.
  pure subroutine solve_by_levels(osc, duration, options, levels, point, start)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration
    type(accuracy_t), intent(in) :: options
    type(levels_t), intent(inout) :: levels
    type(point_t), intent(inout) :: point
    real(dp), intent(in), optional :: start(2)
    type(point_t) :: points(1)
    type(resolution_t) :: resolution
    type(steady_t) :: motion
    type(steady_options_t) :: limits
    integer :: level, least, trial
    logical :: solved(1)

    resolution = graded_resolution(osc, [duration], options, levels)
    if (resolution%graded_for > 0) then
      call refine(osc, [duration], options, resolution, levels, points, solved)
      point = points(1)
      if (solved(1) .and. present(start)) solved = distance(osc, duration, point%steady%state - start) < near
      if (solved(1) .or. levels%lacks) return
    end if
    point%steady%status = status_unresolved
    if (level_steps(last_level(osc, options)) < 2*resolving_steps(osc, duration)) return
    if (options%steady%method /= by_shooting) then
      motion%state = [osc%mean_deflection, 0.0_dp]
      if (present(start)) motion%state = start
      call refine(osc, [duration], options, resolution_t(), levels, points, solved, motion)
      point = points(1)
      return
    end if
    if (.not. present(start)) then
      call refine(osc, [duration], options, resolution_t(), levels, points, solved)
      point = points(1)
      if (solved(1) .or. levels%lacks) return
    end if
    limits = options%steady
    limits%tolerance = 1e-6_dp
    level = search_level(osc, duration, options)
    least = 0
    do trial = 1, 2
      call need_level(osc, level, levels)
      if (levels%lacks) return
      associate (map => levels%level(level)%map)
        call set_durations(map, [duration], options%steady%stop)
        call find_steady(map, limits, motion, start)
        point%steady = motion
        point%steps = map%steps
      end associate
      if (has_result(motion%status)) then
        call refine(osc, [duration], options, resolution_t(), levels, points, solved, motion, least)
        point = points(1)
        if (solved(1) .or. levels%lacks) return
      else if (motion%status /= status_transient) then
        return
      end if
      ! At grazing separation the period map has a jump as large as the error of a step, and a periodic motion may not exist; in
      ! finer steps the jump shrinks to rounding.
      least = min(last_level(osc, options), max(level, first_level(osc, duration, options, levels)) + per_doubling)
      if (least == level) exit
      level = least
    end do
    point%steady = steady_t(status=merge(status_transient, status_aperiodic, osc%damping_ratio > 0))
  end subroutine solve_by_levels

  !> Solves the operating points at all speeds of a batch, as far as Newton's method converges. The number of steps is chosen.
  pure subroutine solve_batch(osc, duration, options, levels, points, solved)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration(batch_size)     !< duration of the mesh period at each speed, s
    type(accuracy_t), intent(in) :: options
    type(levels_t), intent(inout) :: levels          !< levels of this oscillator; lacks: memory is too small for the steps
    type(point_t), intent(out) :: points(batch_size)
    logical, intent(out) :: solved(batch_size)       !< false: use `solve_point`
    type(resolution_t) :: resolution

    solved = .false.
    if (levels%lacks) return
    resolution = graded_resolution(osc, duration, options, levels)
    if (resolution%graded_for > 0) call refine(osc, duration, options, resolution, levels, points, solved)
    if (.not. (any(solved) .or. levels%lacks)) call refine(osc, duration, options, resolution_t(), levels, points, solved)
  end subroutine solve_batch

  !> Solves one speed with the specified number of steps.
  pure subroutine solve_with_steps(osc, duration, options, levels, point, start)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration
    type(accuracy_t), intent(in) :: options
    type(levels_t), intent(inout) :: levels
    type(point_t), intent(inout) :: point
    real(dp), intent(in), optional :: start(2)
    type(steady_t) :: half

    if (given_steps(options) < resolving_steps(osc, duration)) return
    call need_given(osc, options, levels)
    if (levels%lacks) return
    point%resolution = given_resolution(options)
    associate (map => levels%level(given)%map)
      call set_durations(map, [duration], options%steady%stop)
      call find_steady(map, options%steady, point%steady, start)
      point%steps = map%steps
    end associate
    if (.not. has_result(point%steady%status)) return
    if (is_estimated(options%scheme)) then
      call find_half(levels%level(half_given)%map, duration, options, point%steady, half)
      call compare(osc, duration, half, point)
    else
      call leave_unknown(osc, point)
    end if
    call mark_inexact(options, point)
  end subroutine solve_with_steps
end module gearsweep_motion_operating_point
