!> Operating points in graded steps, which are short behind breaks and grow as the natural motion decays. Where that has decayed,
!> the motion follows the static one, so that pairs close and open near where they begin and cease to carry the static load:
!> there are breaks too. Steps are only graded where the natural motion decays from break to break, so that one motion attracts.
module gearsweep_graded_point
  use gearsweep_coefficients, only: graded_steps, resolution_t
  use gearsweep_error_estimate, only: accuracy_t, compare, mark_inexact, point_t
  use gearsweep_gauss, only: batch_size
  use gearsweep_kinds, only: dp
  use gearsweep_oscillator, only: oscillator_t, resolving_steps, split_by_load
  use gearsweep_period_map, only: discretise, period_map_t, set_durations
  use gearsweep_periodic_orbit, only: distance, has_converged, near, steady_t
  use gearsweep_refinement, only: first_guess, levels_t, root
  use gearsweep_steady, only: find_batch, find_converged
  use gearsweep_transient, only: by_shooting
  implicit none
  private
  public :: graded_resolution, solve_graded, solve_one_graded, most_trials

  !> Resolutions tried for one operating point.
  integer, parameter :: most_trials = 12

contains

  !> Graded steps, as many as the tolerance may need, where they are fewer than half of equal ones; else equal steps
  !> (`graded_for` 0).
  pure type(resolution_t) function graded_resolution(osc, duration, options, levels) result(resolution)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration(:)          !< of the mesh period at each speed, s
    type(accuracy_t), intent(in) :: options
    type(levels_t), intent(in) :: levels
    ! Steps of a radian behind the break in the coarser of the two solutions, at a tolerance of 1e-6 or more.
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

  !> One speed, or all of a batch, in graded steps.
  pure subroutine solve_graded(osc, duration, options, first, levels, points, solved)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration(:)          !< of the mesh period at each speed, s
    type(accuracy_t), intent(in) :: options
    type(resolution_t), intent(in) :: first      !< to begin with
    type(levels_t), intent(inout) :: levels      !< lacks: the memory does not hold the steps
    type(point_t), intent(inout) :: points(:)    !< (speed)
    logical, intent(out) :: solved(:)            !< (speed)
    type(steady_t) :: half(size(duration)), full(size(duration))
    type(period_map_t) :: fine, coarse
    type(oscillator_t) :: split
    type(resolution_t) :: resolution
    real(dp) :: excess
    integer :: trial

    split = osc
    call split_by_load(split)
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
      points%steps = fine%table%steps
      points%work = points%work + 2*(fine%table%steps + coarse%table%steps)
      points%resolution = resolution
      call compare(osc, duration, half, points)
      ! A pair may seem to part in coarse steps: then finer ones follow, as for ten times the allowed error.
      excess = 10
      if (any(solved)) excess = maxval(points%step_error, mask=solved)/options%steady%tolerance
      if (excess <= 1) exit
      resolution%base = resolution%base*min(1.2_dp*excess**0.2_dp, 4.0_dp)
      if (graded_steps(split, resolution) > options%most_steps) exit
    end do
    call mark_inexact(options, points)
  end subroutine solve_graded

  !> The motions at one speed or at all of a batch, from those about which they are linear.
  pure subroutine find_motions(map, duration, options, steady)
    type(period_map_t), intent(inout) :: map
    real(dp), intent(in) :: duration(:)
    type(accuracy_t), intent(in) :: options
    type(steady_t), intent(out) :: steady(:)

    call set_durations(map, duration)
    if (size(duration) == batch_size) then
      call find_batch(map, options%steady%tolerance, steady)
    else
      call find_converged(map, options%steady%tolerance, steady(1))
    end if
  end subroutine find_motions

  !> One speed in graded steps, on the branch that `start` leads to.
  pure subroutine solve_one_graded(osc, duration, options, resolution, levels, point, solved, start)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration             !< of the mesh period, s
    type(accuracy_t), intent(in) :: options
    type(resolution_t), intent(in) :: resolution  !< to begin with
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
end module gearsweep_graded_point
