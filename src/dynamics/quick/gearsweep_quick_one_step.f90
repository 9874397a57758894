!> One step of a quick turn (gearsweep_quick_turn) at one speed, whatever happens within it.
module gearsweep_quick_one_step
  use gearsweep_kinds, only: dp
  use gearsweep_quick_changes, only: change, go_through, look_inside, quick_motion_t, raise, state_t, top_load
  use gearsweep_quick_steps, only: most_pairs, need_law, need_map, quick_law_t, quick_maps_t, quick_steps_t
  implicit none
  private
  public :: follow_step

contains

  !> Follows the motion at one speed over a step.
  pure subroutine follow_step(steps, maps, errors, step, period, lane, state, motion)
    type(quick_steps_t), intent(inout) :: steps
    type(quick_maps_t), intent(inout) :: maps
    real(dp), contiguous, intent(in) :: errors(:, :)       !< (pair, node of all steps)
    integer, intent(in) :: step, period, lane
    type(state_t), intent(inout) :: state        !< x, its derivative and the contact set at the begin, then at the end
    type(quick_motion_t), intent(inout) :: motion
    type(state_t) :: next
    real(dp) :: bend, middle, span, static, top
    real(dp), dimension(most_pairs) :: between, bound, curve, hollow, right
    logical :: inside, wrong
    integer :: n

    static = steps%osc%static_deflection
    n = 3*step
    if (steps%begins(step)) call begin_interval(steps, errors, step, period, state, motion)
    if (.not. maps%is_known(state%set, step)) call need_map(steps, state%set, step, maps)
    span = steps%width(step)*maps%turning(lane)
    associate (law => steps%law(state%set, step), map => maps%of(lane, :, :, state%set, step), first => errors(:, n - 2), &
               half => errors(:, n - 1), whole => errors(:, n))
      state%r = static + sum(law%pull(:, 1)*first)
      middle = static + sum(law%pull(:, 2)*half)
      next%r = static + sum(law%pull(:, 3)*whole)
      state%gap = gaps_at(law, 1, first, state%x)
      next%x = sum(map(:, 1)*[state%x, state%v, state%r, middle, next%r])
      next%v = sum(map(:, 2)*[state%x, state%v, state%r, middle, next%r])
      next%set = state%set
      next%gap = gaps_at(law, 3, whole, next%x)
      ! By the cubic through the states at the ends, x in the middle is the mean and `bend`; a pair's gap is more by what the
      ! error is less than its mean there. The parabola through the three gaps may touch in between.
      bend = span/8*(state%v - next%v)
      hollow = (first + whole)/2 - half
      right = law%sense*next%gap + law%spare
      curve = -2*law%sense*(bend + hollow)
      between = law%sense*(state%gap + next%gap)/2 - curve/2 + law%spare
      wrong = least_of(right) <= 0
      inside = any(abs(next%gap - state%gap) < 2*curve .and. 8*curve*between <= (next%gap - state%gap)**2 .and. right > 0)
      bound = law%stiffest*(merge(state%gap, next%gap, state%gap > next%gap) + 1.25_dp*abs(bend + hollow))
      top = 0
      if (-least_of(-bound) > motion%peak .or. wrong) top = top_load(law, span, hollow, state, next)
    end associate
    if (wrong) then
      if (top <= motion%peak .and. .not. inside) call change(steps, errors, step, span, state, next, wrong)
      if (.not. wrong) wrong = top_load(steps%law(next%set, step), span, hollow, state, next) > motion%peak
    end if
    if (wrong .or. inside) then
      next = state
      call go_through(steps, errors, step, period, span, next, motion)
    else if (top > motion%peak) then
      call look_inside(steps, errors, step, period, span, state, next, motion)
    end if
    state = next
  end subroutine follow_step

  !> The gaps (m) at a node of a step.
  pure function gaps_at(law, node, error, x) result(gap)
    type(quick_law_t), intent(in) :: law
    integer, intent(in) :: node
    real(dp), intent(in) :: error(most_pairs)    ! m; (pair)
    real(dp), intent(in) :: x                    ! m
    real(dp) :: gap(most_pairs)

    gap = x - ((law%touching(:, 1, node)*error(1) + law%touching(:, 2, node)*error(2)) + &
               (law%touching(:, 3, node)*error(3) + law%touching(:, 4, node)*error(4)))
  end function gaps_at

  !> The least of four.
  pure real(dp) function least_of(values) result(least)
    real(dp), intent(in) :: values(4)
    real(dp) :: other

    ! So the processor's own instructions do.
    least = merge(values(1), values(2), values(1) < values(2))
    other = merge(values(3), values(4), values(3) < values(4))
    least = merge(least, other, least < other)
  end function least_of

  !> Finds the pairs in contact at the begin of an interval: the first that touches on the wrong side changes until there is none.
  pure subroutine begin_interval(steps, errors, step, period, state, motion)
    type(quick_steps_t), intent(inout) :: steps
    real(dp), contiguous, intent(in) :: errors(:, :)
    integer, intent(in) :: step, period
    type(state_t), intent(inout) :: state
    type(quick_motion_t), intent(inout) :: motion
    integer :: j

    do j = 1, 4*2**steps%pairs(step)
      if (.not. steps%law(state%set, step)%is_known) call need_law(steps, state%set, step)
      associate (law => steps%law(state%set, step))
        state%gap = gaps_at(law, 1, errors(:, 3*step - 2), state%x)
        if (least_of(law%sense*state%gap + law%spare) > 0) exit
        state%set = ieor(state%set, ibset(0, findloc(law%sense*state%gap + law%spare > 0, .false., 1) - 1))
      end associate
    end do
    associate (law => steps%law(state%set, step), p => steps%pairs(step))
      do j = 1, p
        if (law%effective(j, 1)*state%gap(j) > motion%peak) &
          call raise(steps, step, period, 0.0_dp, law%effective(j, 1)*state%gap(j), j, motion)
      end do
    end associate
  end subroutine begin_interval
end module gearsweep_quick_one_step
