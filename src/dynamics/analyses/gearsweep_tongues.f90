!> The parametric tongues: the speeds between which the motion with all pairs in contact repels, at any
!> damping, and the damping that closes them.
!>
!> Over the duration T of the mesh period, the trace of the monodromy matrix (see gearsweep_stability)
!> falls from 2 and then swings between extremes of both signs that, without damping, are never below 2
!> in size: the n-th is the middle of tongue n. Near it a real multiplier of sign (-1)^n lies beyond 1
!> where (-1)^n trace > 1 + determinant.
!> Source: Magnus, Winkler, Hill's Equation, chapter II (oscillation theorem).
module gearsweep_tongues
  use gearsweep_kinds, only: dp, pi
  use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
  use, intrinsic :: iso_c_binding, only: c_ptr
  use gearsweep_error, only: error_t, fail, code_memory, code_numerical
  use gearsweep_gauss, only: batch_size
  use gearsweep_oscillator, only: mesh_period, oscillator_t
  use gearsweep_stability, only: hill_t, make_hill, disturb
  use gearsweep_stop, only: wants_stop
  use gearsweep_text, only: str
  implicit none
  private
  public :: tongue_t, find_tongues

  type :: tongue_t
    real(dp) :: closing_damping = 0              !< damping ratio from which it is closed; NaN: above 1
    real(dp) :: closing_rpm = 0                  !< speed (1/min) of its last point
    real(dp), allocatable :: edge(:, :)          !< lower and upper speed (1/min), NaN: closed; (2, damping ratio)
  end type tongue_t

  !> One tongue while it is looked for: durations at which its neighbours are, and its sign.
  type :: search_t
    real(dp) :: low = 0, high = 0
    integer :: sign = 1
  end type search_t

  !> An excess below this is rounding.
  real(dp), parameter :: nothing = 1e-12_dp

contains

  !> The first tongues, from the highest speed on. Excesses are known to some 1e-12. Once the integer behind `stop` is not 0 the
  !> rest is left out, and the tongues are not to be used.
  subroutine find_tongues(osc, damping, tongues, error, stop)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: damping(:)           !< damping ratios at which the edges are wanted
    type(tongue_t), intent(out) :: tongues(:)    !< as many as there are elements
    type(error_t), allocatable, intent(out) :: error
    type(c_ptr), intent(in), optional :: stop
    type(hill_t) :: hill
    type(search_t) :: search
    real(dp) :: middle(0:size(tongues) + 1)
    logical :: resolved
    integer :: n

    if (size(tongues) == 0) return
    if (present(stop)) hill%stop = stop
    ! Extremes are about half a cycle of the natural motion apart.
    call make_hill(osc, 2*pi*(size(tongues) + 2)/osc%natural_frequency, [0.0_dp], 1e-6_dp, hill, resolved)
    if (resolved) call find_middles(hill, middle, resolved)
    do n = 1, size(tongues)
      if (resolved) call make_hill(osc, middle(n + 1), [0.0_dp, 1.0_dp], nothing, hill, resolved)
      if (wants_stop(hill%stop)) return
      if (hill%lacks) call fail(error, code_memory, 'tongue '//str(n)//': the memory does not hold a mesh period''s steps')
      if (.not. resolved) then
        call fail(error, code_numerical, 'tongue '//str(n)//' was not found')
        return
      end if
      search = search_t(middle(n - 1), middle(n + 1), (-1)**n)
      call close_tongue(hill, search, tongues(n))
      call trace_edges(hill, search, damping, tongues(n))
    end do
  end subroutine find_tongues

  !> The durations at which the undamped trace has its extremes; `found` unless they do not all lie within
  !> reach of the table.
  subroutine find_middles(hill, middle, found)
    type(hill_t), intent(inout) :: hill
    real(dp), intent(out) :: middle(0:)
    logical, intent(out) :: found
    integer, parameter :: a_cycle = 32
    real(dp) :: step, duration(batch_size), trace(-1:batch_size), determinant(batch_size), top
    integer :: n, i, k

    step = 2*pi/hill%frequency/a_cycle
    middle(0) = 0
    n = 1
    trace(0) = 2
    trace(-1) = 3
    do k = 0, a_cycle*size(middle), batch_size
      duration = step*[(k + i, i=1, batch_size)]
      call disturb(hill, 0.0_dp, duration, trace(1:), determinant)
      do i = 0, batch_size - 1
        if ((-1)**n*(trace(i) - trace(i - 1)) < 0 .or. (-1)**n*(trace(i) - trace(i + 1)) < 0) cycle
        call find_maximum(hill, 0.0_dp, search_t(step*(k + i - 1), step*(k + i + 1), (-1)**n), middle(n), top)
        n = n + 1
        found = n == size(middle)
        if (found) return
      end do
      trace(-1:0) = trace(batch_size - 1:)
    end do
  end subroutine find_middles

  !> By how much a multiplier of the tongue's sign lies beyond 1 or, where below 0, does not.
  subroutine exceed(hill, damping, sign, duration, excess)
    type(hill_t), intent(inout) :: hill
    real(dp), intent(in) :: damping, duration(batch_size)
    integer, intent(in) :: sign
    real(dp), intent(out) :: excess(batch_size)
    real(dp), dimension(batch_size) :: trace, determinant

    call disturb(hill, damping, duration, trace, determinant)
    excess = sign*trace - 1 - determinant
  end subroutine exceed

  !> Where the excess is largest. It has one maximum in the range; all speeds of a batch share in the search, and
  !> a parabola ends it.
  subroutine find_maximum(hill, damping, search, place, top)
    type(hill_t), intent(inout) :: hill
    real(dp), intent(in) :: damping
    type(search_t), intent(in) :: search
    real(dp), intent(out) :: place, top
    real(dp), parameter :: tight = 1e-4_dp
    real(dp) :: low, high, step, duration(batch_size), excess(batch_size), rise, bend
    integer :: i, best

    low = search%low
    high = search%high
    do
      step = (high - low)/(batch_size + 1)
      duration = low + step*[(i, i=1, batch_size)]
      call exceed(hill, damping, search%sign, duration, excess)
      best = maxloc(excess, 1)
      place = duration(best)
      top = excess(best)
      if (step <= tight*high .and. best > 1 .and. best < batch_size) exit
      if (step <= epsilon(step)*high) return
      if (best > 1) low = duration(best - 1)
      if (best < batch_size) high = duration(best + 1)
    end do
    rise = (excess(best + 1) - excess(best - 1))/2
    bend = excess(best + 1) - 2*top + excess(best - 1)
    if (.not. bend < 0) return
    place = place - step*rise/bend
    top = top - rise**2/bend/2
  end subroutine find_maximum

  !> The damping at which the largest excess vanishes (regula falsi, Illinois).
  subroutine close_tongue(hill, search, tongue)
    type(hill_t), intent(inout) :: hill
    type(search_t), intent(in) :: search
    type(tongue_t), intent(inout) :: tongue
    real(dp) :: damping(2), top(2), next, last, place, excess
    integer :: iteration, side, side_before

    damping = [0, 1]
    do side = 1, 2
      call find_maximum(hill, damping(side), search, place, top(side))
      if (side == 1) tongue%closing_rpm = rpm_of(hill, place)
      if (side == 1 .and. top(1) <= nothing) return
    end do
    tongue%closing_damping = ieee_value(1.0_dp, ieee_quiet_nan)
    if (top(2) > 0) return
    last = 0
    side_before = 0
    do iteration = 1, 100
      next = (damping(1)*top(2) - damping(2)*top(1))/(top(2) - top(1))
      call find_maximum(hill, next, search, place, excess)
      if (abs(next - last) <= 1e-15_dp) exit
      side = merge(1, 2, excess > 0)
      if (side == side_before) top(3 - side) = top(3 - side)/2
      damping(side) = next
      top(side) = excess
      last = next
      side_before = side
    end do
    tongue%closing_damping = next
    tongue%closing_rpm = rpm_of(hill, place)
  end subroutine close_tongue

  !> The edges at each damping.
  subroutine trace_edges(hill, search, damping, tongue)
    type(hill_t), intent(inout) :: hill
    type(search_t), intent(in) :: search
    real(dp), intent(in) :: damping(:)
    type(tongue_t), intent(inout) :: tongue
    real(dp) :: place, top, low, high
    integer :: k

    allocate (tongue%edge(2, size(damping)), source=ieee_value(1.0_dp, ieee_quiet_nan))
    do k = 1, size(damping)
      if (wants_stop(hill%stop)) return
      if (damping(k) >= tongue%closing_damping) cycle
      call find_maximum(hill, damping(k), search, place, top)
      if (.not. top > nothing) cycle
      call descend(hill, damping(k), search%sign, place, search%high, high)
      call descend(hill, damping(k), search%sign, place, search%low, low)
      tongue%edge(:, k) = [rpm_of(hill, high), rpm_of(hill, low)]
    end do
  end subroutine trace_edges

  !> Where the excess first vanishes on the way from `inside` the tongue to `outside`: bisection with all
  !> speeds of a batch.
  subroutine descend(hill, damping, sign, inside, outside, place)
    type(hill_t), intent(inout) :: hill
    real(dp), intent(in) :: damping, inside, outside
    integer, intent(in) :: sign
    real(dp), intent(out) :: place
    real(dp) :: from, until, duration(batch_size), excess(batch_size)
    integer :: i

    from = inside
    until = outside
    do while (abs(until - from) > 1e-14_dp*inside)
      duration = from + (until - from)/(batch_size + 1)*[(i, i=1, batch_size)]
      call exceed(hill, damping, sign, duration, excess)
      i = findloc(excess > 0, .false., 1)
      if (i /= 1) from = duration(merge(batch_size, i - 1, i == 0))
      if (i /= 0) until = duration(i)
    end do
    place = (from + until)/2
  end subroutine descend

  !> Speed and duration are each other's reciprocals, but for a factor.
  pure real(dp) function rpm_of(hill, duration)
    type(hill_t), intent(in) :: hill
    real(dp), intent(in) :: duration

    rpm_of = mesh_period(hill%osc%mesh%teeth(1), duration)
  end function rpm_of
end module gearsweep_tongues
