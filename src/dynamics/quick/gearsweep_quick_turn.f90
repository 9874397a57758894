!> The motion of gears whose teeth have errors of their own, at one speed, in few long steps (gearsweep_quick_steps): first until
!> the transient has died away, then over a whole turn. What the motion is at the end of a turn has to be what it was at its begin.
module gearsweep_quick_turn
  use gearsweep_deviations, only: deviations_t
  use gearsweep_kinds, only: dp, pi
  use gearsweep_quick_changes, only: change, go_through, look_inside, quick_motion_t, raise, state_t, top_load
  use gearsweep_quick_steps, only: most_pairs, need_law, need_map, quick_maps_t, quick_law_t, quick_steps_t
  implicit none
  private
  public :: quick_motion_t, lay_errors, follow_quickly

contains

  !> The profile errors (m) at all nodes over the turn; (pair, node of all steps, mesh period).
  pure subroutine lay_errors(steps, deviations, errors)
    type(quick_steps_t), intent(in) :: steps
    type(deviations_t), intent(in) :: deviations           !< whose waves have the orders of the steps' ones
    real(dp), allocatable, intent(inout) :: errors(:, :, :)
    real(dp), allocatable :: c(:)
    real(dp) :: cosine, e, rate, sine
    integer :: first, i, j, k, last, n

    if (.not. allocated(errors)) allocate (errors(most_pairs, size(steps%phase), 0:deviations%periods - 1), source=0.0_dp)
    associate (teeth => deviations%teeth)
      do k = 0, deviations%periods - 1
        last = 0
        do while (last < steps%steps)
          first = last + 1
          last = first + count(steps%interval == steps%interval(first)) - 1
          do j = 1, steps%pairs(first)
            call deviations%of_both_teeth(k - (j + steps%offset(first) - 1), c)
            do i = 3*first - 2, 3*last
              e = c(ubound(c, 1))
              do n = ubound(c, 1) - 1, 0, -1
                e = e*steps%along(i, j) + c(n)
              end do
              errors(j, i, k) = e + steps%nominal(j, i)
            end do
          end do
        end do
        do i = 1, size(deviations%waves)
          associate (wave => deviations%waves(i))
            rate = 2*pi*wave%order/teeth(wave%gear)
            rate = rate*modulo(k + merge(deviations%offset, 0, wave%gear == 2), teeth(wave%gear)) + wave%phase
            cosine = wave%amplitude*sin(rate)
            sine = wave%amplitude*cos(rate)
            do n = 1, size(errors, 2)
              errors(:, n, k) = errors(:, n, k) + (cosine*steps%cosine(n, i) + sine*steps%sine(n, i))
            end do
          end associate
        end do
      end do
    end associate
  end subroutine lay_errors

  !> The motion over a turn.
  pure subroutine follow_quickly(steps, maps, errors, beside, motion)
    type(quick_steps_t), intent(inout) :: steps
    type(quick_maps_t), intent(inout) :: maps    !< of the speed
    real(dp), contiguous, intent(in) :: errors(:, :, 0:)   !< of `lay_errors`
    type(quick_motion_t), intent(in) :: beside   !< of a speed beside, from which the transient begins, if one is found
    type(quick_motion_t), intent(out) :: motion
    ! What is left of the transient, and how near the ends of a turn have to be, in static deflections. The motion of a speed beside
    ! is nearer than the mean deflection.
    real(dp), parameter :: rest = 1e-4_dp, rest_beside = 5e-4_dp, near = 3e-4_dp
    integer, parameter :: most_turns = 4, most_periods = 2000
    type(state_t) :: state
    type(quick_motion_t) :: passing
    real(dp) :: before(2), decay
    integer :: k, last, periods, turn

    associate (forgets => steps%osc%damping_ratio*maps%turning, static => steps%osc%static_deflection)
      periods = size(errors, 3)
      passing%peak = huge(passing%peak)
      decay = -log(merge(rest_beside, rest, beside%is_found))
      if (decay > most_periods*forgets) return
      state%x = steps%osc%mean_deflection
      if (beside%is_found) then
        state%x = beside%begin(1)
        state%v = beside%begin(2)
      end if
      last = ceiling(decay/forgets) - 1
      do k = 0, last
        call follow_period(steps, maps, errors(:, :, modulo(k, periods)), k, state, passing)
      end do
      do turn = 1, most_turns
        before = [state%x, state%v]
        motion = quick_motion_t()
        do k = last + 1, last + periods
          if (modulo(k, periods) == 0) motion%begin = [state%x, state%v]
          call follow_period(steps, maps, errors(:, :, modulo(k, periods)), k, state, motion)
        end do
        if (.not. abs(state%x) < 1e4_dp*static) return
        if (hypot(state%x - before(1), state%v - before(2)) < near*static) exit
      end do
      motion%is_found = turn <= most_turns .and. .not. (steps%osc%has_backlash .and. motion%least < -steps%osc%backlash)
      motion%pair = modulo(motion%pair, periods)
      motion%sums = motion%sums/periods
    end associate
  end subroutine follow_quickly

  !> Follows the motion over one mesh period.
  pure subroutine follow_period(steps, maps, errors, period, state, motion)
    type(quick_steps_t), intent(inout) :: steps
    type(quick_maps_t), intent(inout) :: maps
    real(dp), contiguous, intent(in) :: errors(:, :)        ! (pair, node of all steps)
    integer, intent(in) :: period
    type(state_t), intent(inout) :: state
    type(quick_motion_t), intent(inout) :: motion
    type(state_t) :: next
    real(dp) :: bend, middle, span, static, top
    real(dp), dimension(most_pairs) :: between, bound, curve, hollow, right
    logical :: inside, wrong
    integer :: i, n

    static = steps%osc%static_deflection
    do i = 1, steps%steps
      n = 3*i
      if (steps%begins(i)) call begin_interval(steps, errors, i, period, state, motion)
      if (.not. maps%map(state%set, i)%is_known) call need_map(steps, state%set, i, maps)
      span = steps%width(i)*maps%turning
      associate (law => steps%law(state%set, i), map => maps%map(state%set, i)%of, half => errors(:, n - 1), &
                 whole => errors(:, n))
        middle = static + ((law%pull(1, 2)*half(1) + law%pull(2, 2)*half(2)) + (law%pull(3, 2)*half(3) + law%pull(4, 2)*half(4)))
        next%r = static + ((law%pull(1, 3)*whole(1) + law%pull(2, 3)*whole(2)) + &
                           (law%pull(3, 3)*whole(3) + law%pull(4, 3)*whole(4)))
        next%x = (map(1, 1)*state%x + map(1, 2)*state%v) + ((map(1, 3)*state%r + map(1, 4)*middle) + map(1, 5)*next%r)
        next%v = (map(2, 1)*state%x + map(2, 2)*state%v) + ((map(2, 3)*state%r + map(2, 4)*middle) + map(2, 5)*next%r)
        next%set = state%set
        next%gap = gaps_at(law, 3, whole, next%x)
        ! By the cubic through the states at the ends, x in the middle is the mean and `bend`; a pair's gap is more by what the
        ! error is less than its mean there. The parabola through the three gaps may touch in between.
        bend = span/8*(state%v - next%v)
        hollow = (errors(:, n - 2) + whole)/2 - half
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
        if (top <= motion%peak .and. .not. inside) call change(steps, errors, i, span, state, next, wrong)
        if (.not. wrong) wrong = top_load(steps%law(next%set, i), span, hollow, state, next) > motion%peak
      end if
      if (wrong .or. inside) then
        next = state
        call go_through(steps, errors, i, period, span, next, motion)
      else if (top > motion%peak) then
        call look_inside(steps, errors, i, period, span, state, next, motion)
      end if
      call note_error(span, steps%width(i), steps%osc%mean_deflection, state, next, motion)
      state = next
    end do
  end subroutine follow_period

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

  !> Counts the pairs of the interval that begins, and finds those in contact: the first that touches on the wrong side changes
  !> until there is none.
  pure subroutine begin_interval(steps, errors, step, period, state, motion)
    type(quick_steps_t), intent(inout) :: steps
    real(dp), contiguous, intent(in) :: errors(:, :)
    integer, intent(in) :: step, period
    type(state_t), intent(inout) :: state
    type(quick_motion_t), intent(inout) :: motion
    integer :: before, j

    before = merge(steps%steps, step - 1, step == 1)
    associate (shift => steps%offset(before) - steps%offset(step) + merge(1, 0, step == 1))
      state%set = iand(ishft(state%set, shift), 2**steps%pairs(step) - 1)
    end associate
    do j = 1, 4*2**steps%pairs(step)
      if (.not. steps%law(state%set, step)%is_known) call need_law(steps, state%set, step)
      associate (law => steps%law(state%set, step))
        state%gap = gaps_at(law, 1, errors(:, 3*step - 2), state%x)
        if (least_of(law%sense*state%gap + law%spare) > 0) exit
        state%set = ieor(state%set, ibset(0, findloc(law%sense*state%gap + law%spare > 0, .false., 1) - 1))
      end associate
    end do
    associate (law => steps%law(state%set, step), p => steps%pairs(step))
      state%r = steps%osc%static_deflection + sum(law%pull(:, 1)*errors(:, 3*step - 2))
      do j = 1, p
        if (law%effective(j, 1)*state%gap(j) > motion%peak) &
          call raise(steps, step, period, 0.0_dp, law%effective(j, 1)*state%gap(j), j, motion)
      end do
    end associate
  end subroutine begin_interval

  !> Extremes and sums of the transmission error, by the cubic through the states at both ends.
  pure subroutine note_error(span, width, centre, state, next, motion)
    real(dp), intent(in) :: span, width, centre
    type(state_t), intent(in) :: state, next
    type(quick_motion_t), intent(inout) :: motion
    real(dp) :: at, c(0:3), left, middle, right, slope, x

    left = state%x - centre
    right = next%x - centre
    middle = (left + right)/2 + span/8*(state%v - next%v)
    motion%sums(1) = motion%sums(1) + width/6*(left + 4*middle + right)
    motion%sums(2) = motion%sums(2) + width/6*(left**2 + 4*middle**2 + right**2)
    motion%least = min(motion%least, next%x)
    motion%largest = max(motion%largest, next%x)
    if (state%v*next%v >= 0) return
    c(0) = state%x
    c(1) = span*state%v
    c(2) = 3*(next%x - state%x) - span*(2*state%v + next%v)
    c(3) = 2*(state%x - next%x) + span*(state%v + next%v)
    at = state%v/(state%v - next%v)
    slope = 2*c(2) + 6*at*c(3)
    if (abs(slope) > abs(c(2))/8) at = max(0.0_dp, min(1.0_dp, at - (c(1) + at*(2*c(2) + 3*at*c(3)))/slope))
    x = c(0) + at*(c(1) + at*(c(2) + at*c(3)))
    motion%least = min(motion%least, x)
    motion%largest = max(motion%largest, x)
  end subroutine note_error
end module gearsweep_quick_turn
