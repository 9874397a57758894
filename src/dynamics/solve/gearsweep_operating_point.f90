!> Operating points to a tolerance: each is solved with some number of steps and with half of it, and the number grows
!> until the estimate of the error is small enough.
module gearsweep_operating_point
  use gearsweep_coefficients, only: resolution_t, scheme_collocation
  use gearsweep_error_estimate, only: accuracy_t, compare, is_estimated, leave_unknown, mark_inexact, point_t
  use gearsweep_gauss, only: batch_size
  use gearsweep_graded_point, only: graded_resolution, most_trials, solve_graded, solve_one_graded
  use gearsweep_kinds, only: dp
  use gearsweep_oscillator, only: oscillator_t, resolving_steps
  use gearsweep_period_map, only: period_map_t, set_durations
  use gearsweep_periodic_orbit, only: distance, has_converged, near, shoot, solve_full_contact, steady_t
  use gearsweep_refinement, only: first_level, given_resolution, given_steps, last_level, level_steps, levels_t, need_given, &
                                  need_batch_level, need_level, next_level, per_doubling, resolution_of, search_level
  use gearsweep_status, only: has_result, status_transient, status_unresolved
  use gearsweep_steady, only: find_batch, find_beside, find_converged, find_steady, is_one_branch
  use gearsweep_superposition, only: superpose
  use gearsweep_transient, only: by_shooting, steady_options_t
  implicit none
  private
  public :: solve_point, solve_batch, solve_family

  !> What was found on the level on which motions are looked for.
  type :: search_t
    integer :: least = 0                         !< that level, at least
    logical :: done = .false.
    type(steady_t) :: motion
  end type search_t

contains

  !> The operating point at one speed, on the branch that `start` leads to.
  pure subroutine solve_point(osc, duration, options, levels, point, start)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration             !< of the mesh period, s
    type(accuracy_t), intent(in) :: options
    type(levels_t), intent(inout) :: levels      !< of this oscillator; lacks: the memory does not hold the steps
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
        ! Where a motion only just separates a pair, the period map has a jump as large as the error of a step, and there may be no
        ! motion that repeats; in finer steps it is as large as rounding.
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
  end subroutine solve_point

  !> The motion in the steps of a level. Where it is not in full contact, or beside `start`, it is looked for on a level of
  !> its own, once for all levels; from what is found there Newton's method goes on.
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
      point%work = point%work + search%motion%work
    end if
    associate (fine => levels%level(level)%map)
      if (.not. found .and. search%done) call go_on(fine, duration, options, search%motion, point, found)
      if (.not. found) then
        call set_durations(fine, [duration])
        call find_steady(fine, options%steady, point%steady, start)
        point%work = point%work + point%steady%work
      end if
      point%steps = fine%steps
    end associate
  end subroutine solve_on_level

  !> The motion in full contact, or the one beside `start`.
  pure subroutine try_at_once(map, duration, options, point, found, start)
    type(period_map_t), intent(inout) :: map
    real(dp), intent(in) :: duration
    type(accuracy_t), intent(in) :: options
    type(point_t), intent(inout) :: point
    logical, intent(out) :: found
    real(dp), intent(in), optional :: start(2)

    call set_durations(map, [duration])
    if (present(start)) then
      call find_beside(map, options%steady, start, point%steady)
      found = has_result(point%steady%status)
    else
      call find_converged(map, options%steady%tolerance, point%steady)
      found = has_converged(point%steady) .and. (.not. point%steady%departs .or. is_one_branch(map%osc, point%steady%partial))
    end if
    point%work = point%work + point%steady%work
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
    call set_durations(levels%level(level)%map, [duration])
    call find_steady(levels%level(level)%map, alike, search%motion, start)
    search%done = .true.
  end subroutine look_for

  !> From the motion that a search found to the same one in other steps; also where none was found.
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
    call set_durations(map, [duration])
    call shoot(map, options%steady%tolerance, motion%periods, motion%state, point%steady)
    point%work = point%work + point%steady%work
    found = has_result(point%steady%status) .and. distance(map%osc, duration, point%steady%state - motion%state) < near
  end subroutine go_on

  !> The operating points at all speeds of a batch, as far as Newton's method converges. The number of steps is chosen.
  pure subroutine solve_batch(osc, duration, options, levels, points, solved)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration(batch_size)     !< of the mesh period at each speed, s
    type(accuracy_t), intent(in) :: options
    type(levels_t), intent(inout) :: levels          !< of this oscillator; lacks: the memory does not hold the steps
    type(point_t), intent(out) :: points(batch_size)
    logical, intent(out) :: solved(batch_size)       !< the others are for `solve_point`
    type(resolution_t) :: graded

    solved = .false.
    if (levels%lacks) return
    graded = graded_resolution(osc, duration, options, levels)
    if (graded%graded_for > 0) then
      call solve_graded(osc, duration, options, graded, levels, points, solved)
      if (any(solved)) return
    end if
    call refine_batch(osc, [1.0_dp], duration, options, levels, points, solved)
  end subroutine solve_batch

  !> The operating points at all speeds of a batch for many amounts of one relief, as far as all pairs stay in contact. The
  !> number of steps is that of the amount that needs most.
  pure subroutine solve_family(osc, part, duration, options, levels, points, solved)
    type(oscillator_t), intent(in) :: osc            !< that with the largest profile error
    real(dp), intent(in) :: part(:)                  !< of its profile error; (amount), more than one
    real(dp), intent(in) :: duration(batch_size)     !< of the mesh period at each speed, s
    type(accuracy_t), intent(in) :: options
    type(levels_t), intent(inout) :: levels          !< of this oscillator; lacks: the memory does not hold the steps
    type(point_t), intent(out) :: points(batch_size, size(part))  !< (speed, amount)
    logical, intent(out) :: solved(batch_size, size(part))  !< the others are to be solved by themselves; (speed, amount)
    type(resolution_t) :: graded

    solved = .false.
    if (levels%lacks) return
    graded = graded_resolution(osc, duration, options, levels)
    if (graded%graded_for == 0) call refine_batch(osc, part, duration, options, levels, points, solved)
  end subroutine solve_family

  !> The same in equal steps, whose number grows until the estimate of the error is small enough. One amount is solved by Newton's
  !> method, several by superposition.
  pure subroutine refine_batch(osc, part, duration, options, levels, points, solved)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: part(:)                  !< of its profile error; (amount)
    real(dp), intent(in) :: duration(batch_size)     !< of the mesh period at each speed, s
    type(accuracy_t), intent(in) :: options
    type(levels_t), intent(inout) :: levels          !< of this oscillator; lacks: the memory does not hold the steps
    type(point_t), intent(out) :: points(batch_size, size(part))  !< (speed, amount); of one amount also (speed)
    logical, intent(out) :: solved(batch_size, size(part))
    ! The solution with half the steps counts a twentieth, so that its Newton iterations may end so much earlier.
    real(dp), parameter :: loose = 1000
    type(steady_t), dimension(batch_size, size(part)) :: half, full
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
        call set_durations(coarse, duration)
        if (size(part) == 1) then
          call find_batch(coarse, loose*options%steady%tolerance, half(:, 1))
        else
          call superpose(coarse, part, options%with_dte, half)
        end if
        if (.not. any(has_converged(half))) return
        call set_durations(fine, duration)
        if (size(part) == 1) then
          call find_batch(fine, options%steady%tolerance, full(:, 1), half(:, 1))
        else
          call superpose(fine, part, options%with_dte, full)
        end if
        points%steps = fine%table%steps
      end associate
      points%steady = full
      solved = has_converged(half) .and. has_converged(full)
      if (.not. any(solved)) return
      points%resolution = resolution_of(level)
      call compare(osc, spread(duration, 2, size(part)), half, points)
      call next_level(osc, options, maxval(points%step_error, mask=solved), longest, levels, level, done)
      if (done) exit
    end do
    call mark_inexact(options, points)
  end subroutine refine_batch

  !> One speed with the number of steps given.
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
      call set_durations(fine, [duration])
      call find_steady(fine, options%steady, point%steady, start)
      point%steps = fine%steps
      point%work = point%work + point%steady%work
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
    real(dp) :: linear(2), work

    call set_durations(coarse, [duration])
    if (.not. point%steady%departs) call solve_full_contact(coarse, linear, half)
    work = half%work
    if (.not. has_converged(half)) then
      call shoot(coarse, options%steady%tolerance, point%steady%periods, point%steady%state, half)
      work = work + half%work
      ! Where changes of contact are not located the map has jumps, so that Newton's method may not converge.
      if (options%scheme /= scheme_collocation .and. .not. has_result(half%status)) then
        alike = options%steady
        alike%method = by_shooting
        call find_steady(coarse, alike, half, point%steady%state)
        work = work + half%work
      end if
    end if
    point%work = point%work + work
    call compare(coarse%osc, duration, half, point)
  end subroutine compare_with_half
end module gearsweep_operating_point
