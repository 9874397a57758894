!> Operating points in graded steps, which are short behind breaks and grow as the natural motion decays. They serve
!> where all pairs between A and E stay in contact: a change of that would need short steps behind it, too.
!> A pair beyond A or E closes and opens near a break, under next to no load.
module gearsweep_graded_point
  use gearsweep_coefficients, only: graded_steps, resolution_t
  use gearsweep_error_estimate, only: accuracy_t, compare, mark_inexact, point_t, resolving_steps
  use gearsweep_gauss, only: batch_size
  use gearsweep_kinds, only: dp
  use gearsweep_oscillator, only: oscillator_t
  use gearsweep_period_map, only: discretise, period_map_t, set_durations
  use gearsweep_periodic_orbit, only: distance, near, settled, steady_t
  use gearsweep_refinement, only: first_guess, levels_t, root
  use gearsweep_steady, only: find_batch, find_settled, is_one_branch
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
    equal = max(2*resolving_steps(osc, longest), first_guess(osc, longest, options, levels))
    resolution = resolution_t(dense*max(1.0_dp, 1e-6_dp/options%steady%tolerance)**root*longest/shortest, 2, shortest)
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
    logical, intent(out) :: solved(:)            !< all pairs stay in contact; (speed)
    type(steady_t) :: half(size(duration)), full(size(duration))
    type(period_map_t) :: fine, coarse
    type(resolution_t) :: resolution
    real(dp) :: excess
    integer :: trial, l

    resolution = first
    do trial = 1, most_trials
      solved = .false.
      call discretise(osc, resolution, fine)
      levels%lacks = fine%table%steps == 0
      if (levels%lacks) return
      call solve_in_contact(fine, duration, options, full)
      points%steady = full
      solved = [(is_gradable(osc, full(l)), l=1, size(full))]
      if (.not. any(solved)) return
      call discretise(osc, resolution_t(resolution%base, 1, resolution%graded_for), coarse)
      levels%lacks = coarse%table%steps == 0
      if (levels%lacks) solved = .false.
      if (levels%lacks) return
      call solve_in_contact(coarse, duration, options, half)
      solved = solved .and. [(is_gradable(osc, half(l)), l=1, size(half))]
      points%steps = fine%table%steps
      points%work = points%work + 2*(fine%table%steps + coarse%table%steps)
      points%resolution = resolution
      call compare(osc, duration, half, points)
      ! In coarse steps a pair may seem to part.
      excess = 10
      if (any(solved)) excess = maxval(points%step_error, mask=solved)/options%steady%tolerance
      if (excess <= 1) exit
      resolution%base = resolution%base*min(1.2_dp*excess**0.2_dp, 4.0_dp)
      if (graded_steps(osc, resolution) > options%most_steps) exit
    end do
    call mark_inexact(options, points)
  end subroutine solve_graded

  !> Motions in full contact, at one speed or at all of a batch.
  pure subroutine solve_in_contact(map, duration, options, steady)
    type(period_map_t), intent(inout) :: map
    real(dp), intent(in) :: duration(:)
    type(accuracy_t), intent(in) :: options
    type(steady_t), intent(out) :: steady(:)

    call set_durations(map, duration)
    if (size(duration) == batch_size) then
      call find_batch(map, options%steady%tolerance, steady)
    else
      call find_settled(map, options%steady%tolerance, steady(1))
    end if
  end subroutine solve_in_contact

  !> Is this a motion for graded steps: in full contact, or with changes only of pairs beyond A and E?
  pure logical function is_gradable(osc, steady)
    type(oscillator_t), intent(in) :: osc
    type(steady_t), intent(in) :: steady

    is_gradable = settled(steady) .and. (.not. steady%departs .or. is_one_branch(osc, steady%partial))
  end function is_gradable

  !> One speed in graded steps, on the branch that `start` leads to.
  pure subroutine solve_one_graded(osc, duration, options, resolution, levels, point, solved, start)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration             !< of the mesh period, s
    type(accuracy_t), intent(in) :: options
    type(resolution_t), intent(in) :: resolution  !< to begin with
    type(levels_t), intent(inout) :: levels
    type(point_t), intent(inout) :: point
    logical, intent(out) :: solved               !< all pairs stay in contact, and `start` leads there
    real(dp), intent(in), optional :: start(2)   !< state, m
    type(point_t) :: points(1)
    logical :: all_solved(1)

    call solve_graded(osc, [duration], options, resolution, levels, points, all_solved)
    solved = all_solved(1)
    if (solved .and. present(start)) solved = distance(osc, duration, points(1)%steady%state - start) < near
    if (solved) point = points(1)
  end subroutine solve_one_graded
end module gearsweep_graded_point
