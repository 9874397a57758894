!> Parametric stability of the motion in full contact over speed and damping, and the tongues of instability.
!>
!> Full contact: all pairs between A and E are in contact or, if contact extends beyond, those that carry the static load. A
!> disturbance d of that motion obeys Hill's equation, d" + 2 zeta omega d' + omega^2 d = 0 with omega of mesh period T: load and
!> relief cancel. The two Floquet multipliers follow from the trace of its monodromy matrix and from the determinant, exp(-2 zeta T
!> mean omega) by Liouville's formula. As the determinant is at most 1, the motion can only lose stability through a real
!> multiplier: at 1 (fold) or at -1 (flip).
!>
!> A tongue is the interval of speeds in which that motion repels, for each damping ratio; it closes at some damping ratio. Over the
!> duration T of the mesh period the trace falls from 2 and then oscillates between extremes of both signs that, without damping,
!> are never below 2 in magnitude: the n-th is the middle of tongue n. Near it a real multiplier of sign (-1)^n lies beyond 1 if
!> (-1)^n trace > 1 + determinant.
!> Source: Magnus, Winkler, Hill's Equation, chapter II (oscillation theorem).
module gearsweep_nonlinear_stability
  use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
  use, intrinsic :: iso_c_binding, only: c_null_ptr, c_ptr
  use gearsweep_base, only: bracket_t, code_memory, code_numerical, constant, dp, error_t, fail, has_memory, pi, str, &
    wants_stop
  use gearsweep_motion, only: batch_size, coefficients_t, damping, discretise, make_oscillator, mesh_period, oscillator_t, &
    period_map_t, period_t, resolution_t, run_full_contact, set_durations
  implicit none
  private
  public :: stability_t, map_stability, tongue_t, find_tongues

  !> Hill's equation, discretised.
  type :: hill_t
    type(oscillator_t) :: osc
    type(period_map_t) :: map
    real(dp) :: frequency = 0                    !< mean of omega over the period, rad/s
    logical :: lacks = .false.                   !< true if out of memory for the steps
    type(c_ptr) :: stop = c_null_ptr             !< flag of the caller: once it is not 0, the computation ends
  end type hill_t

  type :: stability_t
    real(dp), allocatable :: modulus(:, :)       !< largest Floquet multiplier; NaN where unresolved; (speed, damping)
    integer, allocatable :: sense(:, :)          !< sign of a real multiplier, 0 for a complex pair; (speed, damping)
    logical :: lacks = .false.                   !< true if out of memory: no results
  end type stability_t

  integer, parameter :: most_steps = 2**16

  type :: tongue_t
    real(dp) :: closing_damping = 0              !< damping ratio at which it closes; NaN: above 1
    real(dp) :: closing_rpm = 0                  !< speed (1/min) at which it closes
    real(dp), allocatable :: edge(:, :)          !< lower and upper speed (1/min), NaN: closed; (2, damping ratio)
  end type tongue_t

  !> State of the search for one tongue: durations of its neighbours, and its sign.
  type :: search_t
    real(dp) :: low = 0, high = 0
    integer :: sign = 1
  end type search_t

  !> Excess below which it is rounding.
  real(dp), parameter :: nothing = 1e-12_dp

contains

  !> Computes the multipliers over speeds and damping ratios; the oscillator's own damping is not used. Once the integer of `stop`
  !> is not 0 the computation ends, and the map is not valid.
  subroutine map_stability(osc, rpm, damping_ratio, tolerance, map, stop)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm(:)               !< speeds of the pinion, ascending, 1/min
    real(dp), intent(in) :: damping_ratio(:)
    real(dp), intent(in) :: tolerance            !< tolerance of the trace of the monodromy matrix
    type(stability_t), intent(out) :: map
    type(c_ptr), intent(in), optional :: stop
    type(hill_t) :: hill
    real(dp) :: duration(batch_size), longest
    logical :: resolved, fits
    integer :: first, last, i, k

    call has_memory(12.0_dp*size(rpm)*size(damping_ratio), fits)
    map%lacks = .not. fits
    if (map%lacks) return
    allocate (map%modulus(size(rpm), size(damping_ratio)), map%sense(size(rpm), size(damping_ratio)))
    if (size(damping_ratio) == 0) return
    if (present(stop)) hill%stop = stop
    longest = huge(longest)
    first = 1
    do while (first <= size(rpm))
      last = first
      do while (last < min(first + batch_size - 1, size(rpm)))
        if (rpm(last + 1) > 2*rpm(first)) exit
        last = last + 1
      end do
      duration = mesh_period(osc%mesh%teeth(1), [(rpm(min(i, last)), i=first, first + batch_size - 1)])
      ! A discretisation is reused until half its steps would do.
      if (duration(1) < longest/2) then
        longest = duration(1)
        call make_hill(osc, longest, [minval(damping_ratio), maxval(damping_ratio)], tolerance, hill, resolved)
        map%lacks = hill%lacks
        if (map%lacks) return
      end if
      do k = 1, size(damping_ratio)
        if (wants_stop(hill%stop)) return
        call find_multipliers(hill, damping_ratio(k), duration, resolved, map%modulus(first:last, k), map%sense(first:last, k))
      end do
      first = last + 1
    end do
  end subroutine map_stability

  !> Computes the largest multipliers of the first speeds of a batch.
  pure subroutine find_multipliers(hill, damping_ratio, duration, resolved, modulus, sense)
    type(hill_t), intent(inout) :: hill
    real(dp), intent(in) :: damping_ratio, duration(batch_size)
    logical, intent(in) :: resolved
    real(dp), intent(out) :: modulus(:)
    integer, intent(out) :: sense(:)
    real(dp) :: trace(batch_size), determinant(batch_size), square
    integer :: l

    modulus = ieee_value(1.0_dp, ieee_quiet_nan)
    sense = 0
    if (.not. resolved) return
    call disturb(hill, damping_ratio, duration, trace, determinant)
    do l = 1, size(modulus)
      square = trace(l)**2/4 - determinant(l)
      modulus(l) = sqrt(determinant(l))
      if (square < 0) cycle
      modulus(l) = abs(trace(l))/2 + sqrt(square)
      sense(l) = merge(1, -1, trace(l) > 0)
    end do
  end subroutine find_multipliers

  !> Computes trace and determinant of the monodromy matrix, for a batch of durations.
  pure subroutine disturb(hill, damping_ratio, duration, trace, determinant)
    type(hill_t), intent(inout) :: hill
    real(dp), intent(in) :: damping_ratio
    real(dp), intent(in) :: duration(batch_size)                     !< mesh periods, s
    real(dp), intent(out), dimension(batch_size) :: trace, determinant   !< at each duration
    type(period_t) :: run(batch_size)
    real(dp), parameter :: rest(2, batch_size) = 0
    integer :: l

    hill%map%osc%damping_ratio = damping_ratio
    call set_durations(hill%map, duration)
    call run_full_contact(hill%map, rest, run)
    do l = 1, batch_size
      trace(l) = run(l)%monodromy(1, 1) + run(l)%monodromy(2, 2)
    end do
    determinant = exp(-damping(hill%map%osc, hill%frequency)*duration)
  end subroutine disturb

  !> Doubles the steps until the trace at the slowest speed is within the tolerance with each damping ratio: a method of sixth order
  !> leaves less than a twentieth of the difference to half the steps, also at the knots of splines.
  subroutine make_hill(osc, duration, damping_ratio, tolerance, hill, resolved)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration             !< mesh period at the slowest speed, s
    real(dp), intent(in) :: damping_ratio(:)
    real(dp), intent(in) :: tolerance            !< tolerance of the trace
    type(hill_t), intent(inout) :: hill
    logical, intent(out) :: resolved             !< false if the speed is too low for the largest number of steps
    real(dp) :: coarse(size(damping_ratio)), fine(size(damping_ratio)), fastest
    type(error_t), allocatable :: error
    integer :: steps

    hill%osc = osc
    resolved = .false.
    if (osc%mesh%reaches_beyond()) then
      ! The contact is that under the static load, with relief.
      hill%osc%mesh%profile_error = osc%mesh%profile_error%scaled(0.0_dp)
    else
      hill%osc%mesh%profile_error = constant(0.0_dp, osc%mesh%contact_ratio, 0.0_dp)
      call make_oscillator(hill%osc, error)
      if (allocated(error)) return
    end if
    fastest = osc%highest_frequency*max(1.0_dp, 2*maxval(damping_ratio))
    steps = 8
    do while (steps < fastest*duration)
      steps = 2*steps
      if (steps > most_steps) return
    end do
    call find_traces(hill, steps, duration, damping_ratio, fine)
    do while (steps < most_steps .and. .not. (hill%lacks .or. wants_stop(hill%stop)))
      steps = 2*steps
      coarse = fine
      call find_traces(hill, steps, duration, damping_ratio, fine)
      if (hill%lacks .or. wants_stop(hill%stop)) exit
      resolved = all(abs(fine - coarse) <= 20*tolerance*max(1.0_dp, abs(fine)))
      if (resolved) return
    end do
  end subroutine make_hill

  !> Discretises with about `steps` steps, and computes the trace with each damping ratio.
  pure subroutine find_traces(hill, steps, duration, damping_ratio, trace)
    type(hill_t), intent(inout) :: hill
    integer, intent(in) :: steps
    real(dp), intent(in) :: duration, damping_ratio(:)
    real(dp), intent(out) :: trace(size(damping_ratio))
    real(dp), dimension(batch_size) :: of_speed, determinant
    integer :: k
    real(dp), parameter :: weight(3) = [5, 8, 5]/18.0_dp

    call discretise(hill%osc, resolution_t(real(steps, dp)), hill%map)
    hill%lacks = hill%map%table%steps == 0
    if (hill%lacks) return
    ! Mean of omega over the period (rad/s), by Gauss.
    hill%frequency = sum(hill%map%table%width*matmul(weight, hill%map%table%omega(:, :hill%map%table%steps)))
    trace = 0
    do k = 1, size(damping_ratio)
      if (wants_stop(hill%stop)) return
      call disturb(hill, damping_ratio(k), spread(duration, 1, batch_size), of_speed, determinant)
      trace(k) = of_speed(1)
    end do
  end subroutine find_traces

  !> Finds the first tongues, from the highest speed on. Excesses are accurate to some 1e-12. Once the integer of `stop` is not 0
  !> the search ends, and the tongues are not valid.
  subroutine find_tongues(osc, damping, tongues, error, stop)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: damping(:)           !< damping ratios of the edges
    type(tongue_t), intent(out) :: tongues(:)    !< one tongue for each element
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
    if (resolved) call find_extremes(hill, middle, resolved)
    do n = 1, size(tongues)
      if (resolved) call make_hill(osc, middle(n + 1), [0.0_dp, 1.0_dp], nothing, hill, resolved)
      if (wants_stop(hill%stop)) return
      if (hill%lacks) call fail(error, code_memory, 'tongue '//str(n)//': the memory does not hold a mesh period''s steps')
      if (.not. resolved) then
        call fail(error, code_numerical, 'tongue '//str(n)//' was not found')
        return
      end if
      search = search_t(middle(n - 1), middle(n + 1), (-1)**n)
      call find_closing_point(hill, search, tongues(n))
      call trace_edges(hill, search, damping, tongues(n))
    end do
  end subroutine find_tongues

  !> Finds the durations at which the undamped trace has its extremes; `found` is false if some lie outside the range of the table.
  subroutine find_extremes(hill, middle, found)
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
  end subroutine find_extremes

  !> Excess, sign*trace - 1 - determinant: above 0 where a multiplier of the tongue's sign lies beyond 1.
  subroutine exceed(hill, damping, sign, duration, excess)
    type(hill_t), intent(inout) :: hill
    real(dp), intent(in) :: damping, duration(batch_size)
    integer, intent(in) :: sign
    real(dp), intent(out) :: excess(batch_size)
    real(dp), dimension(batch_size) :: trace, determinant

    call disturb(hill, damping, duration, trace, determinant)
    excess = sign*trace - 1 - determinant
  end subroutine exceed

  !> Finds the largest excess. It has one maximum in the range; all speeds of a batch are used in the search, and a parabola ends
  !> it.
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

  !> Finds the damping ratio at which the largest excess vanishes (regula falsi, Illinois).
  subroutine find_closing_point(hill, search, tongue)
    type(hill_t), intent(inout) :: hill
    type(search_t), intent(in) :: search
    type(tongue_t), intent(inout) :: tongue
    type(bracket_t) :: damping
    real(dp) :: next, last, place, excess
    integer :: iteration

    damping = bracket_t(0.0_dp, 1.0_dp)
    call find_maximum(hill, damping%low, search, place, damping%value(1))
    tongue%closing_rpm = rpm_of(hill, place)
    if (damping%value(1) <= nothing) return
    call find_maximum(hill, damping%high, search, place, damping%value(2))
    tongue%closing_damping = ieee_value(1.0_dp, ieee_quiet_nan)
    if (damping%value(2) > 0) return
    last = 0
    do iteration = 1, 100
      next = (damping%low*damping%value(2) - damping%high*damping%value(1))/(damping%value(2) - damping%value(1))
      call find_maximum(hill, next, search, place, excess)
      if (abs(next - last) <= 1e-15_dp) exit
      call damping%narrow(next, excess)
      last = next
    end do
    tongue%closing_damping = next
    tongue%closing_rpm = rpm_of(hill, place)
  end subroutine find_closing_point

  !> Finds the edges at each damping ratio.
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

  !> Finds the first zero of the excess on the way from `inside` the tongue to `outside`: bisection with all speeds of a batch.
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

  !> Speed for a duration of the mesh period (1/min), or the reverse: both are proportional to the reciprocal of the other.
  pure real(dp) function rpm_of(hill, duration)
    type(hill_t), intent(in) :: hill
    real(dp), intent(in) :: duration

    rpm_of = mesh_period(hill%osc%mesh%teeth(1), duration)
  end function rpm_of
end module gearsweep_nonlinear_stability
