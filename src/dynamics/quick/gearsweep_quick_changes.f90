!> What happens within a step of a quick turn (gearsweep_quick_turn): where a pair begins or ceases to touch, the motion is
!> corrected from there on by a series; where more happens, the step is gone through in small parts; and the largest loads.
module gearsweep_quick_changes
  use gearsweep_kinds, only: dp
  use gearsweep_quick_steps, only: advance, by_errors, most_pairs, need_law, parabola, quick_law_t, quick_steps_t
  use gearsweep_quintic, only: derivative_of, first_zero, quintic, value_of
  implicit none
  private
  public :: quick_motion_t, state_t, change, close_gaps, go_through, look_inside, raise, top_load

  type :: quick_motion_t
    logical :: is_found = .false.                !< the motion repeats after a turn, and the coast sides stay apart
    real(dp) :: peak = 0                         !< largest load of a pair, N
    integer :: pair = -1                         !< number of that pair, from 0
    real(dp) :: place = 0                        !< where: its path coordinate, base pitches
    real(dp) :: least = huge(1.0_dp), largest = -huge(1.0_dp)        !< transmission error, m
    real(dp) :: begin(2) = 0                     !< x and its derivative at the time 0, m
    real(dp) :: sums(2) = 0                      !< of what it is more than the mean deflection, and the squares, over the turn
  end type quick_motion_t

  type :: state_t
    real(dp) :: x = 0, v = 0                     !< m
    real(dp) :: r = 0                            !< at the begin of the step, m
    integer :: set = 0                           !< contact set
    real(dp) :: gap(most_pairs) = 0              !< x less the touching deflections, m
  end type state_t

contains

  !> About the largest load (N) within a step and at its end, rather more: by the parabola through the values at begin, middle and
  !> end.
  pure real(dp) function top_load(law, span, hollow, state, next) result(top)
    type(quick_law_t), intent(in) :: law
    real(dp), intent(in) :: span
    real(dp), intent(in) :: hollow(most_pairs)   ! what the gaps are more in the middle, as the errors are less, m
    type(state_t), intent(in) :: state, next
    real(dp), parameter :: margin = 1/32.0_dp
    real(dp) :: bend, curve, load(3)
    integer :: j

    top = 0
    bend = span/8*(state%v - next%v)
    do j = 1, most_pairs
      load = law%effective(j, :)*[state%gap(j), (state%gap(j) + next%gap(j))/2 + bend + hollow(j), next%gap(j)]
      top = max(top, load(3))
      curve = 2*load(2) - load(1) - load(3)
      if (abs(load(3) - load(1)) < 3*curve) top = max(top, load(2) + (load(3) - load(1))**2/(8*curve) + margin*curve)
    end do
  end function top_load

  !> The pairs in contact at a place of a step, and the gaps.
  pure subroutine close_gaps(steps, error, step, at, state)
    type(quick_steps_t), intent(inout) :: steps
    real(dp), intent(in) :: error(most_pairs, 3)           ! of the pairs at the nodes, m
    integer, intent(in) :: step
    real(dp), intent(in) :: at                   ! 0 to 1
    type(state_t), intent(inout) :: state
    integer :: i, j

    associate (p => steps%pairs(step))
      do i = 1, 4*2**p
        if (.not. steps%law(state%set, step)%is_known) call need_law(steps, state%set, step)
        do j = 1, p
          state%gap(j) = state%x - parabola(by_errors(steps%law(state%set, step)%touching(:, :, j), error), at)
        end do
        do j = 1, p
          if (btest(state%set, j - 1) .neqv. state%gap(j) > 0) exit
        end do
        if (j > p) exit
        state%set = ieor(state%set, ibset(0, j - 1))
      end do
    end associate
  end subroutine close_gaps

  !> The quintic of x over the step.
  pure function course(law, span, state, next) result(c)
    type(quick_law_t), intent(in) :: law
    real(dp), intent(in) :: span
    type(state_t), intent(in) :: state, next
    real(dp) :: c(0:5)

    c = quintic([state%x, span*state%v, span**2*(state%r - law%omega_squared(1)*state%x - law%rate(1)*state%v)], &
                [next%x, span*next%v, span**2*(next%r - law%omega_squared(3)*next%x - law%rate(3)*next%v)])
  end function course

  !> One pair begins or ceases to touch within a step. From there on the motion differs from that under the law before by y,
  !>
  !>   y" + rate y' + omega^2 y = -(change of omega^2) gap - (change of the rate) x',
  !>
  !> where the right side is that of the motion under the law before, and y a series up to the sixth derivative.
  pure subroutine change(steps, error, step, span, state, next, wrong)
    type(quick_steps_t), intent(inout) :: steps
    real(dp), intent(in) :: error(most_pairs, 3)           ! of the pairs at the nodes, m
    integer, intent(in) :: step
    real(dp), intent(in) :: span
    type(state_t), intent(in) :: state
    type(state_t), intent(inout) :: next         ! the end under the law before, then as it is
    logical, intent(out) :: wrong                ! more than that happens
    real(dp) :: at, c(0:5), d, gap(0:5), right(3), t(3), u, w, y(2:6)
    integer :: j, k, p
    logical :: found

    wrong = .true.
    p = steps%pairs(step)
    do j = 1, p
      if (btest(state%set, j - 1) .neqv. next%gap(j) > 0) exit
    end do
    next%set = ieor(state%set, ibset(0, j - 1))
    if (.not. steps%law(next%set, step)%is_known) call need_law(steps, next%set, step)
    associate (old => steps%law(state%set, step), new => steps%law(next%set, step), &
               sense => merge(1, -1, btest(state%set, j - 1)))
      t = by_errors(old%touching(:, :, j), error)
      c = course(old, span, state, next)
      gap = c
      gap(:2) = gap(:2) - [t(1), 4*t(2) - 3*t(1) - t(3), 2*(t(1) - 2*t(2) + t(3))]
      call first_zero(sense*gap, at, found)
      if (.not. found) return
      u = span*(1 - at)
      do k = 1, 3
        associate (place => at + (k - 1)*(1 - at)/2)
          right(k) = -parabola(new%omega_squared - old%omega_squared, place)*value_of(gap, place) - &
                     parabola(new%rate - old%rate, place)*derivative_of(c, place)/span
        end associate
      end do
      w = parabola(new%omega_squared, (1 + at)/2)
      d = parabola(new%rate, (1 + at)/2)
      y(2) = right(1)
      y(3) = (4*right(2) - 3*right(1) - right(3))/max(u, tiny(u)) - d*y(2)
      y(4) = 4*(right(1) - 2*right(2) + right(3))/max(u**2, tiny(u)) - w*y(2) - d*y(3)
      y(5) = -w*y(3) - d*y(4)
      y(6) = -w*y(4) - d*y(5)
      next%x = next%x + u**2*(y(2)/2 + u*(y(3)/6 + u*(y(4)/24 + u*(y(5)/120 + u*y(6)/720))))
      next%v = next%v + u*(y(2) + u*(y(3)/2 + u*(y(4)/6 + u*(y(5)/24 + u*y(6)/120))))
      t = steps%osc%static_deflection + by_errors(new%pull, error)
      next%r = t(3)
      wrong = .false.
      do j = 1, p
        t = by_errors(new%touching(:, :, j), error)
        next%gap(j) = next%x - t(3)
        wrong = wrong .or. (btest(next%set, j - 1) .neqv. next%gap(j) > 0)
      end do
    end associate
  end subroutine change

  !> Goes through a step in small parts. Where a pair begins or ceases to touch within a part, it does so where the straight line
  !> through the gaps at its ends says.
  pure subroutine go_through(steps, error, step, period, span, state, motion)
    type(quick_steps_t), intent(inout) :: steps
    real(dp), intent(in) :: error(most_pairs, 3)           ! of the pairs at the nodes, m
    integer, intent(in) :: step, period
    real(dp), intent(in) :: span
    type(state_t), intent(inout) :: state
    type(quick_motion_t), intent(inout) :: motion
    integer, parameter :: parts = 24
    type(state_t) :: before
    real(dp) :: at, from, r(3), to
    integer :: j, k

    do k = 1, parts
      from = (k - 1.0_dp)/parts
      to = real(k, dp)/parts
      before = state
      call go_on(steps, error, step, span, from, to, state)
      associate (p => steps%pairs(step))
        do j = 1, p
          state%gap(j) = state%x - parabola(by_errors(steps%law(state%set, step)%touching(:, :, j), error), to)
          if (btest(state%set, j - 1) .neqv. state%gap(j) > 0) exit
        end do
        if (j <= p) then
          at = before%gap(j)/(before%gap(j) - state%gap(j))
          at = from + (to - from)*merge(at, 0.0_dp, at > 0 .and. at < 1)
          state = before
          call go_on(steps, error, step, span, from, at, state)
          state%set = ieor(state%set, ibset(0, j - 1))
          call go_on(steps, error, step, span, at, to, state)
        end if
        call close_gaps(steps, error, step, to, state)
        do j = 1, p
          call raise(steps, step, period, to, parabola(steps%law(state%set, step)%effective(j, :), to)*state%gap(j), j, motion)
        end do
      end associate
    end do
    r = steps%osc%static_deflection + by_errors(steps%law(state%set, step)%pull, error)
    state%r = r(3)
  end subroutine go_through

  !> Follows the motion over a part of a step under the law of its contact set.
  pure subroutine go_on(steps, error, step, span, from, to, state)
    type(quick_steps_t), intent(inout) :: steps
    real(dp), intent(in) :: error(most_pairs, 3)           ! of the pairs at the nodes, m
    integer, intent(in) :: step
    real(dp), intent(in) :: span, from, to
    type(state_t), intent(inout) :: state
    real(dp) :: r(3, 1), x(1), v(1)

    if (.not. steps%law(state%set, step)%is_known) call need_law(steps, state%set, step)
    r(:, 1) = steps%osc%static_deflection + by_errors(steps%law(state%set, step)%pull, error)
    x = state%x
    v = state%v
    call advance(steps%law(state%set, step), span, from, to, 1, r, x, v)
    state%x = x(1)
    state%v = v(1)
  end subroutine go_on

  !> The largest loads within a step.
  pure subroutine look_inside(steps, error, step, period, span, state, next, motion)
    type(quick_steps_t), intent(in) :: steps
    real(dp), intent(in) :: error(most_pairs, 3)           ! of the pairs at the nodes, m
    integer, intent(in) :: step, period
    real(dp), intent(in) :: span
    type(state_t), intent(in) :: state, next
    type(quick_motion_t), intent(inout) :: motion
    integer, parameter :: parts = 8
    real(dp) :: c(0:5), load(0:parts), t(3), off
    integer :: j, k

    associate (law => steps%law(state%set, step))
      c = course(law, span, state, next)
      do j = 1, steps%pairs(step)
        if (.not. btest(state%set, j - 1)) cycle
        t = by_errors(law%touching(:, :, j), error)
        do k = 0, parts
          associate (at => real(k, dp)/parts)
            load(k) = parabola(law%effective(j, :), at)*(value_of(c, at) - parabola(t, at))
          end associate
        end do
        k = maxloc(load, 1) - 1
        call raise(steps, step, period, real(k, dp)/parts, load(k), j, motion)
        k = max(1, min(parts - 1, k))
        off = (load(k + 1) - load(k - 1))/2
        associate (curve => 2*load(k) - load(k + 1) - load(k - 1))
          if (abs(off) < curve) call raise(steps, step, period, (k + off/curve)/parts, load(k) + off**2/(2*curve), j, motion)
        end associate
      end do
    end associate
  end subroutine look_inside

  !> Raises the largest load.
  pure subroutine raise(steps, step, period, at, load, j, motion)
    type(quick_steps_t), intent(in) :: steps
    integer, intent(in) :: step, period, j
    real(dp), intent(in) :: at                   ! of the step, 0 to 1
    real(dp), intent(in) :: load                 ! N
    type(quick_motion_t), intent(inout) :: motion

    if (load <= motion%peak) return
    motion%peak = load
    motion%pair = period - (j + steps%offset(step) - 1)
    motion%place = steps%left(step) + at*steps%width(step) + (j + steps%offset(step) - 1)
  end subroutine raise
end module gearsweep_quick_changes
