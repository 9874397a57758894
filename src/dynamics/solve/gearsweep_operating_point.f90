!> Operating points to a tolerance: each is solved with some number of steps and with half of it, and the number grows
!> until the estimate of the error is small enough.
module gearsweep_operating_point
  use gearsweep_coefficients, only: resolution_t, scheme_collocation
  use gearsweep_error_estimate, only: accuracy_t, compare, is_estimated, leave_unknown, mark_inexact, point_t, resolving_steps
  use gearsweep_gauss, only: batch_size
  use gearsweep_graded_point, only: graded_resolution, most_trials, solve_graded, solve_one_graded
  use gearsweep_kinds, only: dp
  use gearsweep_oscillator, only: oscillator_t
  use gearsweep_period_map, only: period_map_t, set_durations
  use gearsweep_periodic_orbit, only: distance, near, settled, shoot, steady_t
  use gearsweep_refinement, only: first_level, given_resolution, given_steps, last_level, level_steps, levels_t, need_given, &
                                  need_level, next_level, per_doubling, resolution_of
  use gearsweep_status, only: has_result, status_unresolved
  use gearsweep_steady, only: find_batch, find_steady
  use gearsweep_transient, only: by_shooting, steady_options_t
  implicit none
  private
  public :: solve_point, solve_batch

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
      call need_level(osc, level, levels)
      if (levels%lacks) exit
      call solve_twice(levels%level(level)%map, levels%level(level - per_doubling)%map, duration, options, point, start)
      point%resolution = resolution_of(level)
      if (.not. has_result(point%steady%status)) exit
      call next_level(osc, options, point%step_error, duration, levels, level, done)
      if (done) exit
    end do
    if (levels%lacks) point%steady%status = status_unresolved
    call mark_inexact(options, point)
  end subroutine solve_point

  !> The operating points at all speeds of a batch, as far as Newton's method settles. The number of steps is chosen.
  pure subroutine solve_batch(osc, duration, options, levels, points, solved)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration(batch_size)     !< of the mesh period at each speed, s
    type(accuracy_t), intent(in) :: options
    type(levels_t), intent(inout) :: levels          !< of this oscillator; lacks: the memory does not hold the steps
    type(point_t), intent(out) :: points(batch_size)
    logical, intent(out) :: solved(batch_size)       !< the others are for `solve_point`
    ! The solution with half the steps counts a twentieth, so that its Newton iterations may end so much earlier.
    real(dp), parameter :: most_batch_steps = 4096, loose = 1000
    type(steady_t) :: half(batch_size), full(batch_size)
    type(resolution_t) :: graded
    real(dp) :: longest
    integer :: level, trial
    logical :: done

    solved = .false.
    if (levels%lacks) return
    longest = maxval(duration)
    graded = graded_resolution(osc, duration, options, levels)
    if (graded%graded_for > 0) then
      call solve_graded(osc, duration, options, graded, levels, points, solved)
      if (any(solved)) return
      points = point_t(steady_t(), resolution=resolution_t())
    end if
    level = first_level(osc, longest, options, levels)
    do trial = 1, most_trials
      solved = .false.
      if (level_steps(level) > min(most_batch_steps, real(options%most_steps, dp)) .or. &
          level_steps(level) < 2*resolving_steps(osc, longest)) return
      call need_level(osc, level, levels)
      if (levels%lacks) return
      associate (coarse => levels%level(level - per_doubling)%map, fine => levels%level(level)%map)
        call set_durations(coarse, duration)
        call find_batch(coarse, loose*options%steady%tolerance, half)
        if (.not. any(settled(half))) return
        call set_durations(fine, duration)
        call find_batch(fine, options%steady%tolerance, full, half)
        points%steps = fine%table%steps
      end associate
      points%steady = full
      solved = settled(half) .and. settled(full)
      if (.not. any(solved)) return
      points%resolution = resolution_of(level)
      call compare(osc, duration, half, points)
      call next_level(osc, options, maxval(points%step_error, mask=solved), longest, levels, level, done)
      if (done) exit
    end do
    call mark_inexact(options, points)
  end subroutine solve_batch

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
    call solve_twice(levels%given(1)%map, levels%given(2)%map, duration, options, point, start)
    call mark_inexact(options, point)
  end subroutine solve_with_steps

  !> Solves with some number of steps and with half of it, and compares.
  pure subroutine solve_twice(fine, coarse, duration, options, point, start)
    type(period_map_t), intent(inout) :: fine, coarse
    real(dp), intent(in) :: duration
    type(accuracy_t), intent(in) :: options
    type(point_t), intent(inout) :: point
    real(dp), intent(in), optional :: start(2)
    type(steady_options_t) :: alike
    type(steady_t) :: half

    call set_durations(fine, [duration])
    call follow_or_find(fine, options, point%steady, start)
    point%steps = fine%steps
    point%work = point%work + point%steady%work
    if (.not. has_result(point%steady%status)) return
    if (.not. is_estimated(options%scheme)) then
      call leave_unknown(fine%osc, point)
      return
    end if
    call set_durations(coarse, [duration])
    alike = options%steady
    alike%method = by_shooting
    if (.not. point%steady%departs) then
      call find_steady(coarse, alike, half)
    else
      call shoot(coarse, options%steady%tolerance, point%steady%periods, point%steady%state, half)
      ! Where changes of contact are not located the map has jumps, so that Newton's method may not settle.
      if (options%scheme /= scheme_collocation .and. .not. has_result(half%status)) &
        call find_steady(coarse, alike, half, point%steady%state)
    end if
    point%work = point%work + half%work
    call compare(fine%osc, duration, half, point)
  end subroutine solve_twice

  !> The motion `steady` is known from fewer steps, or not yet. Where the search was long, Newton's method goes on from
  !> what it found.
  pure subroutine follow_or_find(map, options, steady, start)
    type(period_map_t), intent(inout) :: map
    type(accuracy_t), intent(in) :: options
    type(steady_t), intent(inout) :: steady
    real(dp), intent(in), optional :: start(2)
    real(dp), parameter :: long = 40
    type(steady_t) :: before
    real(dp) :: work

    work = 0
    if (has_result(steady%status) .and. steady%work > long*map%steps .and. options%steady%method == by_shooting) then
      before = steady
      call shoot(map, options%steady%tolerance, before%periods, before%state, steady)
      if (has_result(steady%status) .and. distance(map%osc, map%duration(1), steady%state - before%state) < near) return
      work = steady%work
    end if
    call find_steady(map, options%steady, steady, start)
    steady%work = steady%work + work
  end subroutine follow_or_find
end module gearsweep_operating_point
