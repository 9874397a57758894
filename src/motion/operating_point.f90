!> Operating points to a tolerance: each is solved with some number of steps and with half of it until the estimated error is
!> small.
!>
!> Graded steps are used where the natural motion decays from break to break, so that one motion attracts: they are short after
!> breaks and grow as it decays. After its decay the motion follows the static one, so that pairs close and open near the places
!> where they begin and cease to carry the static load: those are breaks too.
module gearsweep_motion_operating_point
  use gearsweep_base, only: dp, wants_stop
  use gearsweep_motion_resolution, only: graded_steps, resolution_t, scheme_collocation
  use gearsweep_motion_error_estimate, only: accuracy_t, compare, first_guess, first_level, given_resolution, given_steps, &
    is_estimated, last_level, leave_unknown, level_steps, levels_t, mark_inexact, need_batch_level, need_given, need_level, &
    next_level, per_doubling, point_t, resolution_of, root, search_level
  use gearsweep_motion_gauss, only: batch_size
  use gearsweep_motion_oscillator, only: oscillator_t, resolving_steps, split_by_load
  use gearsweep_motion_period_map, only: discretise, period_map_t, set_durations
  use gearsweep_motion_periodic_orbit, only: distance, has_converged, near, shoot, solve_full_contact, steady_t
  use gearsweep_motion_steady, only: find_batch, find_beside, find_converged, find_steady, is_one_branch
  use gearsweep_motion_steady_motion, only: by_shooting, has_result, status_stopped, status_transient, status_unresolved, &
    steady_options_t
  implicit none
  private
  public :: solve_point, solve_batch

  !> Largest number of resolutions tried for one operating point.
  integer, parameter :: most_trials = 12

  !> Result of the search on its own refinement level.
  type :: search_t
    integer :: least = 0                         !< lowest level of the search
    logical :: done = .false.
    type(steady_t) :: motion
  end type search_t

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

  !> Solves one speed, or all of a batch, in graded steps.
  pure subroutine solve_graded(osc, duration, options, first, levels, points, solved)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration(:)          !< duration of the mesh period at each speed, s
    type(accuracy_t), intent(in) :: options
    type(resolution_t), intent(in) :: first      !< first resolution
    type(levels_t), intent(inout) :: levels      !< lacks: memory is too small for the steps
    type(point_t), intent(inout) :: points(:)    !< (speed)
    logical, intent(out) :: solved(:)            !< (speed)
    type(steady_t) :: half(size(duration)), full(size(duration))
    type(oscillator_t) :: split
    type(resolution_t) :: resolution
    real(dp) :: excess
    integer :: trial

    split = osc
    call split_by_load(split)
    do trial = 1, 2
      if (.not. allocated(levels%graded(trial)%map)) allocate (levels%graded(trial)%map)
    end do
    associate (fine => levels%graded(1)%map, coarse => levels%graded(2)%map)
    resolution = first
    do trial = 1, most_trials
      solved = .false.
      call discretise(split, resolution, fine)
      levels%lacks = fine%table%steps == 0
      if (levels%lacks) return
      call find_motions(fine, duration, options, full)
      points%steady = full
      solved = has_converged(full)
      if (.not. any(solved)) return
      call discretise(split, resolution_t(resolution%base, 1, resolution%graded_for), coarse)
      levels%lacks = coarse%table%steps == 0
      if (levels%lacks) solved = .false.
      if (levels%lacks) return
      call find_motions(coarse, duration, options, half)
      solved = solved .and. has_converged(half)
      points%steps = fine%steps
      points%resolution = resolution
      call compare(osc, duration, half, points)
      ! A pair may seem to part in coarse steps: finer ones follow, as for ten times the allowed error.
      excess = 10
      if (any(solved)) excess = maxval(points%step_error, mask=solved)/options%steady%tolerance
      if (excess <= 1) exit
      resolution%base = resolution%base*min(1.2_dp*excess**0.2_dp, 4.0_dp)
      if (graded_steps(split, resolution) > options%most_steps) exit
    end do
    end associate
    call mark_inexact(options, points)
  end subroutine solve_graded

  !> Finds the motions at one speed or at all of a batch by Newton's method from full contact.
  pure subroutine find_motions(map, duration, options, steady)
    type(period_map_t), intent(inout) :: map
    real(dp), intent(in) :: duration(:)
    type(accuracy_t), intent(in) :: options
    type(steady_t), intent(out) :: steady(:)

    call set_durations(map, duration, options%steady%stop)
    if (size(duration) == batch_size) then
      call find_batch(map, options%steady%tolerance, steady)
    else
      call find_converged(map, options%steady%tolerance, steady(1))
    end if
  end subroutine find_motions

  !> Solves one speed in graded steps, on the branch that `start` leads to.
  pure subroutine solve_one_graded(osc, duration, options, resolution, levels, point, solved, start)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration             !< duration of the mesh period, s
    type(accuracy_t), intent(in) :: options
    type(resolution_t), intent(in) :: resolution  !< first resolution
    type(levels_t), intent(inout) :: levels
    type(point_t), intent(inout) :: point
    logical, intent(out) :: solved               !< `start` leads to the motion found
    real(dp), intent(in), optional :: start(2)   !< state, m
    type(point_t) :: points(1)
    logical :: all_solved(1)

    call solve_graded(osc, [duration], options, resolution, levels, points, all_solved)
    solved = all_solved(1)
    if (solved .and. present(start)) solved = distance(osc, duration, points(1)%steady%state - start) < near
    if (solved) point = points(1)
  end subroutine solve_one_graded

  !> Solves the operating point at one speed, on the branch that `start` leads to.
  pure subroutine solve_point(osc, duration, options, levels, point, start)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration             !< duration of the mesh period, s
    type(accuracy_t), intent(in) :: options
    type(levels_t), intent(inout) :: levels      !< levels of this oscillator; lacks: memory is too small for the steps
    type(point_t), intent(out) :: point
    real(dp), intent(in), optional :: start(2)   !< state, m; without it, see `find_steady`
    type(resolution_t) :: graded
    type(search_t) :: search
    integer :: level, last, trial
    logical :: done

    point%steady%status = status_unresolved
    if (levels%lacks) return
    if (options%steps > 0 .or. options%scheme /= scheme_collocation) then
      call solve_with_steps(osc, duration, options, levels, point, start)
      if (wants_stop(options%steady%stop)) point%steady%status = status_stopped
      return
    end if
    graded = graded_resolution(osc, [duration], options, levels)
    if (graded%graded_for > 0) then
      call solve_one_graded(osc, duration, options, graded, levels, point, done, start)
      if (done) return
    end if
    point%steady%status = status_unresolved
    last = last_level(osc, options)
    if (level_steps(last) < 2*resolving_steps(osc, duration)) return
    level = min(last, first_level(osc, duration, options, levels))
    do trial = 1, most_trials
      call solve_on_level(osc, level, duration, options, levels, search, point, start)
      if (point%steady%status == status_transient .and. search%least == 0 .and. level < last) then
        ! At grazing separation the period map has a jump as large as the error of a step, and a periodic motion may not exist; in
        ! finer steps the jump shrinks to rounding.
        level = min(last, level + per_doubling)
        search = search_t(least=level)
        cycle
      end if
      if (levels%lacks .or. .not. has_result(point%steady%status)) exit
      point%resolution = resolution_of(level)
      call compare_with_half(levels%level(level - per_doubling)%map, duration, options, point)
      call next_level(osc, options, point%step_error, duration, levels, level, done)
      if (done) exit
    end do
    if (levels%lacks) point%steady%status = status_unresolved
    call mark_inexact(options, point)
    if (wants_stop(options%steady%stop)) point%steady%status = status_stopped
  end subroutine solve_point

  !> Finds the motion in the steps of a level. If it is neither in full contact nor near `start`, it is searched on a level of its
  !> own, once for all levels; Newton's method continues from the motion found there.
  pure subroutine solve_on_level(osc, level, duration, options, levels, search, point, start)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: level
    real(dp), intent(in) :: duration
    type(accuracy_t), intent(in) :: options
    type(levels_t), intent(inout) :: levels
    type(search_t), intent(inout) :: search
    type(point_t), intent(inout) :: point
    real(dp), intent(in), optional :: start(2)
    logical :: found

    call need_level(osc, level, levels)
    if (levels%lacks) return
    found = .false.
    if (options%steady%method == by_shooting .and. .not. search%done) then
      call try_at_once(levels%level(level)%map, duration, options, point, found, start)
      if (.not. found) call look_for(osc, duration, options, levels, search, start)
      if (.not. (found .or. levels%lacks)) call need_level(osc, level, levels)
      if (levels%lacks) return
    end if
    associate (fine => levels%level(level)%map)
      if (.not. found .and. search%done) call go_on(fine, duration, options, search%motion, point, found)
      if (.not. found) then
        call set_durations(fine, [duration], options%steady%stop)
        call find_steady(fine, options%steady, point%steady, start)
      end if
      point%steps = fine%steps
    end associate
  end subroutine solve_on_level

  !> Tries the motion in full contact, or the one near `start`.
  pure subroutine try_at_once(map, duration, options, point, found, start)
    type(period_map_t), intent(inout) :: map
    real(dp), intent(in) :: duration
    type(accuracy_t), intent(in) :: options
    type(point_t), intent(inout) :: point
    logical, intent(out) :: found
    real(dp), intent(in), optional :: start(2)

    call set_durations(map, [duration], options%steady%stop)
    if (present(start)) then
      call find_beside(map, options%steady, start, point%steady)
      found = has_result(point%steady%status)
    else
      call find_converged(map, options%steady%tolerance, point%steady)
      found = has_converged(point%steady) .and. (.not. point%steady%departs .or. is_one_branch(map%osc, point%steady%partial))
    end if
  end subroutine try_at_once

  pure subroutine look_for(osc, duration, options, levels, search, start)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration
    type(accuracy_t), intent(in) :: options
    type(levels_t), intent(inout) :: levels
    type(search_t), intent(inout) :: search
    real(dp), intent(in), optional :: start(2)
    type(steady_options_t) :: alike
    integer :: level

    level = max(search%least, search_level(osc, duration, options))
    call need_level(osc, level, levels)
    if (levels%lacks) return
    alike = options%steady
    alike%tolerance = 1e-6_dp
    call set_durations(levels%level(level)%map, [duration], options%steady%stop)
    call find_steady(levels%level(level)%map, alike, search%motion, start)
    search%done = .true.
  end subroutine look_for

  !> Refines the motion found by a search in other steps; reports also that none was found.
  pure subroutine go_on(map, duration, options, motion, point, found)
    type(period_map_t), intent(inout) :: map
    real(dp), intent(in) :: duration
    type(accuracy_t), intent(in) :: options
    type(steady_t), intent(in) :: motion
    type(point_t), intent(inout) :: point
    logical, intent(out) :: found

    found = .not. has_result(motion%status)
    point%steady = motion
    if (found) return
    call set_durations(map, [duration], options%steady%stop)
    call shoot(map, options%steady%tolerance, motion%periods, motion%state, point%steady)
    found = has_result(point%steady%status) .and. distance(map%osc, duration, point%steady%state - motion%state) < near
  end subroutine go_on

  !> Solves the operating points at all speeds of a batch, as far as Newton's method converges. The number of steps is chosen.
  pure subroutine solve_batch(osc, duration, options, levels, points, solved)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration(batch_size)     !< duration of the mesh period at each speed, s
    type(accuracy_t), intent(in) :: options
    type(levels_t), intent(inout) :: levels          !< levels of this oscillator; lacks: memory is too small for the steps
    type(point_t), intent(out) :: points(batch_size)
    logical, intent(out) :: solved(batch_size)       !< false: use `solve_point`
    type(resolution_t) :: graded

    solved = .false.
    if (levels%lacks) return
    graded = graded_resolution(osc, duration, options, levels)
    if (graded%graded_for > 0) then
      call solve_graded(osc, duration, options, graded, levels, points, solved)
      if (any(solved)) return
    end if
    call refine_batch(osc, duration, options, levels, points, solved)
  end subroutine solve_batch

  !> Solves a batch in equal steps, whose number grows until the estimate of the error is small enough.
  pure subroutine refine_batch(osc, duration, options, levels, points, solved)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration(batch_size)     !< duration of the mesh period at each speed, s
    type(accuracy_t), intent(in) :: options
    type(levels_t), intent(inout) :: levels          !< levels of this oscillator; lacks: memory is too small for the steps
    type(point_t), intent(out) :: points(batch_size)
    logical, intent(out) :: solved(batch_size)
    ! The solution with half the steps has a weight of a twentieth, so that its Newton iterations may end earlier.
    real(dp), parameter :: loose = 1000
    type(steady_t), dimension(batch_size) :: half, full
    real(dp) :: longest
    integer :: level, trial
    logical :: done, ready

    longest = maxval(duration)
    level = first_level(osc, longest, options, levels)
    do trial = 1, most_trials
      solved = .false.
      call need_batch_level(osc, level, longest, options, levels, ready)
      if (.not. ready) return
      associate (coarse => levels%level(level - per_doubling)%map, fine => levels%level(level)%map)
        call set_durations(coarse, duration, options%steady%stop)
        call find_batch(coarse, loose*options%steady%tolerance, half)
        if (.not. any(has_converged(half))) return
        call set_durations(fine, duration, options%steady%stop)
        call find_batch(fine, options%steady%tolerance, full, half)
        points%steps = fine%steps
      end associate
      points%steady = full
      solved = has_converged(half) .and. has_converged(full)
      if (.not. any(solved)) return
      points%resolution = resolution_of(level)
      call compare(osc, duration, half, points)
      call next_level(osc, options, maxval(points%step_error, mask=solved), longest, levels, level, done)
      if (done) exit
    end do
    call mark_inexact(options, points)
  end subroutine refine_batch

  !> Solves one speed with the specified number of steps.
  pure subroutine solve_with_steps(osc, duration, options, levels, point, start)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration
    type(accuracy_t), intent(in) :: options
    type(levels_t), intent(inout) :: levels
    type(point_t), intent(out) :: point
    real(dp), intent(in), optional :: start(2)

    point%steady%status = status_unresolved
    if (given_steps(options) < resolving_steps(osc, duration)) return
    call need_given(osc, options, levels)
    if (levels%lacks) return
    point%resolution = given_resolution(options)
    associate (fine => levels%given(1)%map)
      call set_durations(fine, [duration], options%steady%stop)
      call find_steady(fine, options%steady, point%steady, start)
      point%steps = fine%steps
    end associate
    if (.not. has_result(point%steady%status)) return
    if (is_estimated(options%scheme)) then
      call compare_with_half(levels%given(2)%map, duration, options, point)
    else
      call leave_unknown(osc, point)
    end if
    call mark_inexact(options, point)
  end subroutine solve_with_steps

  !> Solves with half the steps, and compares.
  pure subroutine compare_with_half(coarse, duration, options, point)
    type(period_map_t), intent(inout) :: coarse
    real(dp), intent(in) :: duration
    type(accuracy_t), intent(in) :: options
    type(point_t), intent(inout) :: point        !< with a result
    type(steady_options_t) :: alike
    type(steady_t) :: half
    real(dp) :: linear(2)

    call set_durations(coarse, [duration], options%steady%stop)
    if (.not. point%steady%departs) call solve_full_contact(coarse, linear, half)
    if (.not. has_converged(half)) then
      call shoot(coarse, options%steady%tolerance, point%steady%periods, point%steady%state, half)
      ! Where changes of contact are not located the map has jumps, so that Newton's method may not converge.
      if (options%scheme /= scheme_collocation .and. .not. has_result(half%status)) then
        alike = options%steady
        alike%method = by_shooting
        call find_steady(coarse, alike, half, point%steady%state)
      end if
    end if
    call compare(coarse%osc, duration, half, point)
  end subroutine compare_with_half
end module gearsweep_motion_operating_point
