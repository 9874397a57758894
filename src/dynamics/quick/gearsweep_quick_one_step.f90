!> One step of a quick turn (gearsweep_quick_turn) at one speed, whatever happens within it.
module gearsweep_quick_one_step
  use gearsweep_kinds, only: dp
  use gearsweep_quick_changes, only: change, close_gaps, go_through, look_inside, quick_motion_t, raise, state_t, top_load
  use gearsweep_quick_steps, only: by_errors, most_pairs, need_map, quick_maps_t, quick_steps_t
  implicit none
  private
  public :: follow_step

contains

  !> Follows the motion at one speed over a step.
  pure subroutine follow_step(steps, maps, error, step, period, lane, state, motion)
    type(quick_steps_t), intent(inout) :: steps
    type(quick_maps_t), intent(inout) :: maps
    real(dp), intent(in) :: error(most_pairs, 3)           !< of the pairs at the nodes, m
    integer, intent(in) :: step, period, lane
    type(state_t), intent(inout) :: state        !< x, its derivative and the contact set at the begin, then at the end
    type(quick_motion_t), intent(inout) :: motion
    type(state_t) :: next
    real(dp) :: bend, r(3), span, top, touching(3, most_pairs)
    real(dp), dimension(most_pairs) :: between, bound, curve, hollow, right
    logical :: inside, wrong
    integer :: j

    if (steps%begins(step)) call begin_interval(steps, error, step, period, state, motion)
    if (.not. maps%is_known(state%set, step)) call need_map(steps, state%set, step, maps)
    span = steps%width(step)*maps%turning(lane)
    associate (law => steps%law(state%set, step), map => maps%of(lane, :, :, state%set, step))
      r = steps%osc%static_deflection + by_errors(law%pull, error)
      touching = 0
      do j = 1, steps%pairs(step)
        touching(:, j) = by_errors(law%touching(:, :, j), error)
      end do
      state%r = r(1)
      state%gap = state%x - touching(1, :)
      next%x = sum(map(:, 1)*[state%x, state%v, r])
      next%v = sum(map(:, 2)*[state%x, state%v, r])
      next%r = r(3)
      next%set = state%set
      next%gap = next%x - touching(3, :)
      ! By the cubic through the states at the ends, x in the middle is the mean and `bend`; a pair's gap is more by what
      ! its touching deflection is less than the mean there. The parabola through the three gaps may touch in between.
      bend = span/8*(state%v - next%v)
      hollow = (touching(1, :) + touching(3, :))/2 - touching(2, :)
      right = law%sense*next%gap + law%spare
      curve = -2*law%sense*(bend + hollow)
      between = law%sense*(state%gap + next%gap)/2 - curve/2 + law%spare
      wrong = any(right <= 0)
      inside = any(abs(next%gap - state%gap) < 2*curve .and. 8*curve*between <= (next%gap - state%gap)**2 .and. right > 0)
      bound = law%stiffest*(merge(state%gap, next%gap, state%gap > next%gap) + 1.25_dp*abs(bend + hollow))
      top = 0
      if (any(bound > motion%peak) .or. wrong) top = top_load(law, span, hollow, state, next)
    end associate
    if (wrong) then
      if (top <= motion%peak .and. .not. inside) call change(steps, error, step, span, state, next, wrong)
      if (.not. wrong) wrong = top_load(steps%law(next%set, step), span, hollow, state, next) > motion%peak
    end if
    if (wrong .or. inside) then
      next = state
      call go_through(steps, error, step, period, span, next, motion)
    else if (top > motion%peak) then
      call look_inside(steps, error, step, period, span, state, next, motion)
    end if
    state = next
  end subroutine follow_step

  !> Finds the pairs in contact at the begin of an interval, and what they carry.
  pure subroutine begin_interval(steps, error, step, period, state, motion)
    type(quick_steps_t), intent(inout) :: steps
    real(dp), intent(in) :: error(most_pairs, 3)           ! of the pairs at the nodes, m
    integer, intent(in) :: step, period
    type(state_t), intent(inout) :: state
    type(quick_motion_t), intent(inout) :: motion
    integer :: j

    call close_gaps(steps, error, step, 0.0_dp, state)
    associate (law => steps%law(state%set, step))
      do j = 1, steps%pairs(step)
        call raise(steps, step, period, 0.0_dp, law%effective(j, 1)*state%gap(j), j, motion)
      end do
    end associate
  end subroutine begin_interval
end module gearsweep_quick_one_step
