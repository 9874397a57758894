!> One change of contact within a step, without sub-steps, on the dense polynomial of the step.
!>
!> After the event the motion starts from the same state under the new contact set; extrapolated back to the start of the step,
!> it uses that set's propagator over the full step. This serves where a pair closes or opens once in the step and nothing else
!> happens, as at tip corners in every period; gearsweep_motion_contact_events serves all else.
!>
!> The polynomial of seventh degree matches the value and the first three derivatives at both ends, which follow from the equation
!> of motion. Its degree is two above the order of the step, so that the motion may leave a step half way without loss of
!> accuracy. Places run from 0 to 1 over the step; the state is x and v, its derivative over the step (both m).
module gearsweep_motion_single_event
  use gearsweep_base, only: derivative_of, dp, may_cross_zero, quintic, value_of
  use gearsweep_motion_coefficients, only: need_law
  use gearsweep_motion_contact_set, only: in_contact, period_t, record_contact, set_contact
  use gearsweep_motion_gauss, only: batch_size
  use gearsweep_motion_integrator, only: change_t, integrator_t, raise_peaks
  use gearsweep_motion_oscillator, only: damping, touches_coast
  use gearsweep_motion_period_map, only: period_map_t, propagate_alike
  implicit none
  private
  public :: cross_events, has_simple_steps

  !> Indices of the parts of a motion: by unit x and unit v at the start, and by load and profile error.
  integer, parameter, public :: by_place = 1, by_speed = 2, by_force = 3

  !> Values at both ends of a step: x" = f - k x - d v with the slopes of k, d and f, all over the step; (speed, end).
  type :: ends_t
    real(dp), dimension(batch_size, 2) :: k, k_slope, d, d_slope, f, f_slope
  end type ends_t

  !> Values in place of a pair index: no pair changes; the ends of the step do not decide.
  integer, parameter :: none = 0, unclear = -1

contains

  !> Finds propagator and polynomials of a step in the map, and computes them if they are missing. The contact set is the same at
  !> all speeds.
  pure subroutine find_dense_step(map, step, contact_set, which)
    type(period_map_t), intent(inout) :: map
    integer, intent(in) :: step, contact_set
    integer, intent(out) :: which                !< index into map%dense
    real(dp) :: weight(batch_size, 6)
    integer :: law

    do which = 1, min(map%denses, size(map%dense))
      if (map%dense(which)%step == step .and. map%dense(which)%contact_set == contact_set) return
    end do
    ! Without free room the oldest is replaced.
    which = modulo(map%denses, size(map%dense)) + 1
    map%denses = map%denses + 1
    associate (dense => map%dense(which))
      dense%step = step
      dense%contact_set = contact_set
      call need_law(map%osc, step, contact_set, map%table, law)
      call propagate_alike(map%osc, map%table, step, map%duration, law, dense%propagator, weight)
      call describe_step(map, step, law, dense%propagator, dense%c)
    end associate
  end subroutine find_dense_step

  !> Computes the polynomials of a step at all speeds of a map.
  pure subroutine describe_step(map, step, law, propagator, c)
    type(period_map_t), intent(in) :: map
    integer, intent(in) :: step, law
    real(dp), intent(in) :: propagator(batch_size, 6)    ! propagator of this contact set
    real(dp), intent(out) :: c(batch_size, 0:7, 3)       ! coefficients in ascending powers; (speed, power, by what)
    real(dp), dimension(0:1, 2) :: omega_squared, forcing
    real(dp), dimension(batch_size, 2) :: begin, last
    type(ends_t) :: ends
    real(dp) :: time, load, width
    integer :: end, l

    width = map%table%width(step)
    omega_squared = map%table%end_omega_squared(:1, :, law)
    forcing = map%table%end_forcing(:1, :, law)
    omega_squared(1, :) = width*omega_squared(1, :)
    forcing(1, :) = width*forcing(1, :)
    load = map%osc%load*sum(1/map%osc%mass)
    do end = 1, 2
      do l = 1, batch_size
        time = map%duration(l)*width
        ends%k(l, end) = omega_squared(0, end)*time**2
        ends%k_slope(l, end) = omega_squared(1, end)*time**2
        ends%d(l, end) = damping(map%osc, sqrt(omega_squared(0, end))*time)
        ends%d_slope(l, end) = ends%d(l, end)*omega_squared(1, end)/(2*omega_squared(0, end))
        ends%f(l, end) = (forcing(0, end) + load)*time**2
        ends%f_slope(l, end) = forcing(1, end)*time**2
      end do
    end do
    begin(:, 1) = 0
    begin(:, 2) = 0
    last(:, 1) = propagator(:, 5)
    last(:, 2) = propagator(:, 6)*width
    call interpolate(ends, begin, last, c(:, :, by_force))
    ends%f = 0
    ends%f_slope = 0
    begin(:, 1) = 1
    last(:, 1) = propagator(:, 1)
    last(:, 2) = propagator(:, 2)*width
    call interpolate(ends, begin, last, c(:, :, by_place))
    begin(:, 1) = 0
    begin(:, 2) = 1
    last(:, 1) = propagator(:, 3)/width
    last(:, 2) = propagator(:, 4)
    call interpolate(ends, begin, last, c(:, :, by_speed))
  end subroutine describe_step

  !> Interpolates the states (x, v) at both ends.
  pure subroutine interpolate(ends, begin, last, c)
    type(ends_t), intent(in) :: ends
    real(dp), intent(in), dimension(batch_size, 2) :: begin, last        ! m; (speed, x or v)
    real(dp), intent(out) :: c(batch_size, 0:7)
    real(dp) :: a0, j0, a1, j1, value, slope, curvature, jerk
    integer :: l

    associate (k => ends%k, d => ends%d, f => ends%f)
      do l = 1, batch_size
        a0 = f(l, 1) - k(l, 1)*begin(l, 1) - d(l, 1)*begin(l, 2)
        j0 = ends%f_slope(l, 1) - ends%k_slope(l, 1)*begin(l, 1) - (k(l, 1) + ends%d_slope(l, 1))*begin(l, 2) - d(l, 1)*a0
        a1 = f(l, 2) - k(l, 2)*last(l, 1) - d(l, 2)*last(l, 2)
        j1 = ends%f_slope(l, 2) - ends%k_slope(l, 2)*last(l, 1) - (k(l, 2) + ends%d_slope(l, 2))*last(l, 2) - d(l, 2)*a1
        value = last(l, 1) - (begin(l, 1) + begin(l, 2) + a0/2 + j0/6)
        slope = last(l, 2) - (begin(l, 2) + a0 + j0/2)
        curvature = a1 - (a0 + j0)
        jerk = j1 - j0
        c(l, 0) = begin(l, 1)
        c(l, 1) = begin(l, 2)
        c(l, 2) = a0/2
        c(l, 3) = j0/6
        c(l, 4) = 35*value - 15*slope + 2.5_dp*curvature - jerk/6
        c(l, 5) = -84*value + 39*slope - 7*curvature + jerk/2
        c(l, 6) = 70*value - 34*slope + 6.5_dp*curvature - jerk/2
        c(l, 7) = -20*value + 10*slope - 2*curvature + jerk/6
      end do
    end associate
  end subroutine interpolate

  !> Computes the polynomials of the motions from the states at the start of the step.
  pure subroutine motions_from(dense, x, v, c)
    real(dp), intent(in) :: dense(batch_size, 0:7, 3)
    real(dp), intent(in), dimension(batch_size) :: x, v  !< m
    real(dp), intent(out) :: c(batch_size, 0:7)
    integer :: k, l

    do k = 0, 7
      do l = 1, batch_size
        c(l, k) = x(l)*dense(l, k, by_place) + v(l)*dense(l, k, by_speed) + dense(l, k, by_force)
      end do
    end do
  end subroutine motions_from

  !> Computes value and first derivative of a polynomial of each speed at its own place.
  pure subroutine evaluate(c, place, f, slope)
    real(dp), intent(in) :: c(batch_size, 0:7)
    real(dp), intent(in) :: place(batch_size)
    real(dp), intent(out), dimension(batch_size) :: f, slope
    integer :: k, l

    f = c(:, 7)
    slope = 0
    do k = 6, 0, -1
      do l = 1, batch_size
        slope(l) = slope(l)*place(l) + f(l)
        f(l) = f(l)*place(l) + c(l, k)
      end do
    end do
  end subroutine evaluate

  !> Computes the second derivative of a polynomial of each speed at its own place.
  pure subroutine evaluate_curvature(c, place, curvature)
    real(dp), intent(in) :: c(batch_size, 0:7)
    real(dp), intent(in) :: place(batch_size)
    real(dp), intent(out) :: curvature(batch_size)
    integer :: k, l

    curvature = 0
    do k = 7, 2, -1
      do l = 1, batch_size
        curvature(l) = curvature(l)*place(l) + k*(k - 1)*c(l, k)
      end do
    end do
  end subroutine evaluate_curvature

  !> True if `cross_events` may be tried in the steps of this map.
  pure logical function has_simple_steps(map)
    type(period_map_t), intent(in) :: map

    has_simple_steps = map%speeds == batch_size .and. map%osc%mesh%reaches_beyond() .and. .not. map%osc%damping_ratio > 1
    if (has_simple_steps) has_simple_steps = .not. any(map%table%kind%stiff)
  end function has_simple_steps

  !> Integrates motions whose contact may change (`state%changes`) over a step, if one pair closes or opens in it. The other
  !> motions keep `state%changes`.
  pure subroutine cross_events(map, step, state, propagator, period, crossed)
    type(period_map_t), intent(inout) :: map
    integer, intent(in) :: step
    type(integrator_t), intent(inout) :: state   !< in: the end of the step is that without events
    real(dp), intent(inout) :: propagator(batch_size, 6)
    type(period_t), intent(inout) :: period(:)   !< results at each speed
    logical, intent(out) :: crossed(batch_size)  !< the contact changes, exactly once
    type(change_t) :: change
    integer :: pair(batch_size), l

    crossed = .false.
    call find_changing_pairs(map, step, state, pair)
    state%changes = state%changes .and. pair /= none
    do l = 1, batch_size
      if (pair(l) < 1) cycle
      change%step = step
      change%pair = pair(l)
      change%before = state%contact_set(l)
      change%behind = ieor(change%before, ibset(0, change%pair - 1))
      change%alike = pair == change%pair .and. state%contact_set == change%before
      where (change%alike) pair = none
      call find_change(map, state, change)
      call check_rest(map, state, change)
      call make_change(map, change, state, propagator, period)
      if (state%peaks) call note_loads(map, change, state)
      crossed = crossed .or. change%alike
    end do
    state%changes = state%changes .and. .not. crossed
  end subroutine cross_events

  !> Defers the loads of a change to the end of the period, when most are known to be too low to matter.
  pure subroutine note_loads(map, change, state)
    type(period_map_t), intent(inout) :: map
    type(change_t), intent(in) :: change
    type(integrator_t), intent(inout) :: state

    if (state%noted == size(state%change)) then
      call raise_peaks(map, change, state%peak)
    else
      state%noted = state%noted + 1
      state%change(state%noted) = change
    end if
  end subroutine note_loads

  !> Finds the only pair that closes or opens in the step, from the states at its ends.
  pure subroutine find_changing_pairs(map, step, state, pair)
    type(period_map_t), intent(inout) :: map
    integer, intent(in) :: step
    type(integrator_t), intent(in) :: state
    integer, intent(out) :: pair(batch_size)
    real(dp) :: touch(0:2, 2), overlap(2), slope(2)
    integer :: contact_set, j, l

    pair = none
    contact_set = -1
    associate (width => map%table%width(step), from => state%from, to => state%to)
      do j = 1, map%table%pairs(step)
        do l = 1, batch_size
          if (.not. state%changes(l) .or. pair(l) == unclear) cycle
          if (state%contact_set(l) /= contact_set .or. l == 1) call find_touching(map, step, state%contact_set(l), j, touch)
          contact_set = state%contact_set(l)
          associate (sense => state%contacts(j)%sense(l))
            overlap(1) = sense*(state%x(l, from) - touch(0, 1))
            overlap(2) = sense*(state%x(l, to) - touch(0, 2))
            slope(1) = sense*(width*state%y(l, from) - touch(1, 1))
            slope(2) = sense*(width*state%y(l, to) - touch(1, 2))
          end associate
          if (overlap(2) < 0) then
            pair(l) = merge(j, unclear, pair(l) == none)
          else if (may_cross_zero(overlap(1), overlap(2), slope(1), slope(2))) then
            pair(l) = unclear
          end if
        end do
        contact_set = -1
      end do
      do l = 1, batch_size
        if (pair(l) > 0) then
          ! Few periods have an event at which the last pair parts or the first one meets: the sub-steps locate it.
          if (state%contact_set(l) == 0 .or. state%contact_set(l) == ibset(0, pair(l) - 1)) pair(l) = unclear
        end if
        if (.not. map%osc%has_backlash) cycle
        if (touches_coast(map%osc, state%contact_set(l)) .or. min(state%x(l, 1), state%x(l, 2)) - &
            (abs(state%y(l, 1)) + abs(state%y(l, 2)))*width/4 < map%osc%coast_below) pair(l) = unclear
      end do
    end associate
  end subroutine find_changing_pairs

  !> Finds where the contact changes, the motion there and at the end of the step, and its propagator.
  pure subroutine find_change(map, state, change)
    type(period_map_t), intent(inout) :: map
    type(integrator_t), intent(in) :: state
    type(change_t), intent(inout) :: change
    real(dp) :: touch(0:5), touch_ends(0:2, 2), overlap(batch_size, 0:7)
    real(dp), dimension(batch_size) :: x, v, begin_x, begin_v, acceleration, jump
    real(dp), dimension(batch_size) :: a11, a21, a12, a22, b11, b21, b12, b22, p11, p21, p12, p22, f1, f2
    integer :: before, behind, k, l

    call find_dense_step(map, change%step, change%behind, behind)
    call find_dense_step(map, change%step, change%before, before)
    ! The second call may have replaced the first result in the cache.
    call find_dense_step(map, change%step, change%behind, behind)
    associate (step => change%step, width => map%table%width(change%step), sense => state%contacts(change%pair)%sense, &
               first => map%dense(before)%c, second => map%dense(behind)%c, of_second => map%dense(behind)%propagator)
      call find_touching(map, step, change%before, change%pair, touch_ends)
      touch = quintic(touch_ends(:, 1), touch_ends(:, 2))
      x = merge(state%x(:, state%from), 0.0_dp, change%alike)
      v = merge(width*state%y(:, state%from), 0.0_dp, change%alike)
      call motions_from(first, x, v, change%first)
      do k = 0, 7
        overlap(:, k) = sense*change%first(:, k)
      end do
      do k = 0, 5
        overlap(:, k) = overlap(:, k) - sense*touch(k)
      end do
      call find_events(overlap, change%alike, change%place)
      call evaluate(change%first, change%place, change%x, change%v)
      call evaluate_curvature(change%first, change%place, acceleration)
      call evaluate(second(:, :, by_place), change%place, b11, b21)
      call evaluate(second(:, :, by_speed), change%place, b12, b22)
      call evaluate(second(:, :, by_force), change%place, f1, f2)
      do l = 1, batch_size
        ! Inverse of the matrix b.
        jump(l) = 1/(b11(l)*b22(l) - b12(l)*b21(l))
        a11(l) = jump(l)*b22(l)
        a12(l) = -jump(l)*b12(l)
        a21(l) = -jump(l)*b21(l)
        a22(l) = jump(l)*b11(l)
        begin_x(l) = a11(l)*(change%x(l) - f1(l)) + a12(l)*(change%v(l) - f2(l))
        begin_v(l) = a21(l)*(change%x(l) - f1(l)) + a22(l)*(change%v(l) - f2(l))
        p11(l) = of_second(l, 1)
        p21(l) = of_second(l, 2)*width
        p12(l) = of_second(l, 3)/width
        p22(l) = of_second(l, 4)
        change%last_x(l) = p11(l)*begin_x(l) + p12(l)*begin_v(l) + of_second(l, 5)
        change%last_v(l) = p21(l)*begin_x(l) + p22(l)*begin_v(l) + of_second(l, 6)*width
      end do
      call motions_from(second, begin_x, begin_v, change%second)
      call evaluate_curvature(change%second, change%place, jump)
      call evaluate(first(:, :, by_place), change%place, b11, b21)
      call evaluate(first(:, :, by_speed), change%place, b12, b22)
      do l = 1, batch_size
        ! Rate at which the overlap falls. Only damping jumps with the contact; it enters the propagator by the derivative of the
        ! event's time.
        f1(l) = sense(l)*(change%v(l) - derivative_of(touch, change%place(l)))
        change%alike(l) = change%alike(l) .and. f1(l) < 0
        jump(l) = sense(l)*(jump(l) - acceleration(l))/merge(f1(l), -1.0_dp, change%alike(l))
        b21(l) = b21(l) + jump(l)*b11(l)
        b22(l) = b22(l) + jump(l)*b12(l)
        f1(l) = a11(l)*b11(l) + a12(l)*b21(l)
        f2(l) = a21(l)*b11(l) + a22(l)*b21(l)
        change%propagator(l, 1) = p11(l)*f1(l) + p12(l)*f2(l)
        change%propagator(l, 2) = p21(l)*f1(l) + p22(l)*f2(l)
        f1(l) = a11(l)*b12(l) + a12(l)*b22(l)
        f2(l) = a21(l)*b12(l) + a22(l)*b22(l)
        change%propagator(l, 3) = p11(l)*f1(l) + p12(l)*f2(l)
        change%propagator(l, 4) = p21(l)*f1(l) + p22(l)*f2(l)
      end do
    end associate
  end subroutine find_change

  !> Selects the speeds at which no further contact changes between the event and the end of the step.
  pure subroutine check_rest(map, state, change)
    type(period_map_t), intent(inout) :: map
    type(integrator_t), intent(in) :: state
    type(change_t), intent(inout) :: change
    real(dp) :: touch(0:2, 2), curve(0:5), overlap(2), slope(2), sense
    integer :: j, l

    do j = 1, map%table%pairs(change%step)
      call find_touching(map, change%step, change%behind, j, touch)
      curve = quintic(touch(:, 1), touch(:, 2))
      do l = 1, batch_size
        sense = state%contacts(j)%sense(l)
        if (j == change%pair) sense = -sense
        overlap(1) = sense*(change%x(l) - value_of(curve, change%place(l)))
        if (j == change%pair) overlap(1) = 0
        overlap(2) = sense*(change%last_x(l) - touch(0, 2))
        slope(1) = sense*(1 - change%place(l))*(change%v(l) - derivative_of(curve, change%place(l)))
        slope(2) = sense*(1 - change%place(l))*(change%last_v(l) - touch(1, 2))
        change%alike(l) = change%alike(l) .and. .not. may_cross_zero(overlap(1), overlap(2), slope(1), slope(2))
      end do
    end do
    if (.not. map%osc%has_backlash) return
    do l = 1, batch_size
      change%alike(l) = change%alike(l) .and. min(change%x(l), change%last_x(l)) - (abs(change%v(l)) + abs(change%last_v(l)))/4 &
                        > map%osc%coast_below
    end do
  end subroutine check_rest

  !> Updates state, propagator and contacts by the changes.
  pure subroutine make_change(map, change, state, propagator, period)
    type(period_map_t), intent(in) :: map
    type(change_t), intent(in) :: change
    type(integrator_t), intent(inout) :: state
    real(dp), intent(inout) :: propagator(batch_size, 6)
    type(period_t), intent(inout) :: period(:)
    real(dp), parameter :: cost = 1              ! computing time, in steps
    integer :: l

    associate (j => change%pair, step => change%step, width => map%table%width(change%step))
      do l = 1, batch_size
        if (.not. change%alike(l)) cycle
        state%x(l, state%to) = change%last_x(l)
        state%y(l, state%to) = change%last_v(l)/width
        propagator(l, 1) = change%propagator(l, 1)
        propagator(l, 2) = change%propagator(l, 2)/width
        propagator(l, 3) = change%propagator(l, 3)*width
        propagator(l, 4) = change%propagator(l, 4)
        call set_contact(map%osc, l, j, .not. in_contact(change%before, j), state%contact_set(l), state%contacts(j))
        call record_contact(map%osc, state%contact_set(l), map%table%full(step), map%table%between(step), period(l))
        period(l)%events = period(l)%events + 1
        period(l)%work = period(l)%work + cost
      end do
    end associate
  end subroutine make_change

  !> Finds the deflection (m) at which a pair touches while the other pairs of a contact set are in contact, at both ends of a
  !> step, with its derivatives over the step; (derivative, end).
  pure subroutine find_touching(map, step, contact_set, j, touch)
    type(period_map_t), intent(inout) :: map
    integer, intent(in) :: step, contact_set, j
    real(dp), intent(out) :: touch(0:2, 2)
    integer :: law

    call need_law(map%osc, step, contact_set, map%table, law)
    touch = map%table%touching(:, j, :, law)
    touch(1, :) = touch(1, :)*map%table%width(step)
    touch(2, :) = touch(2, :)*map%table%width(step)**2
  end subroutine find_touching

  !> Finds where overlaps fall below zero in a step, by Newton's method within brackets for all speeds at once.
  pure subroutine find_events(c, wanted, place)
    real(dp), intent(in) :: c(batch_size, 0:7)   ! coefficients; below 0 at 1 where wanted
    logical, intent(in) :: wanted(batch_size)
    real(dp), intent(out) :: place(batch_size)
    real(dp), parameter :: tight = 1e-8_dp       ! the next correction would be its square
    integer, parameter :: most_iterations = 60
    real(dp), dimension(batch_size) :: low, high, f, slope, moved
    integer :: iteration, l

    low = 0
    high = 1
    place = 0.5_dp
    do l = 1, batch_size
      if (wanted(l)) place(l) = max(0.0_dp, c(l, 0))/(max(0.0_dp, c(l, 0)) - sum(c(l, :)))
    end do
    do iteration = 1, most_iterations
      call evaluate(c, place, f, slope)
      do l = 1, batch_size
        low(l) = merge(place(l), low(l), f(l) >= 0)
        high(l) = merge(high(l), place(l), f(l) >= 0)
        moved(l) = place(l) - f(l)/merge(slope(l), -1.0_dp, slope(l) < 0)
        moved(l) = merge(moved(l), (low(l) + high(l))/2, slope(l) < 0 .and. moved(l) >= low(l) .and. moved(l) <= high(l))
        f(l) = abs(moved(l) - place(l))
        place(l) = moved(l)
      end do
      if (.not. any(f > tight .and. wanted)) exit
    end do
  end subroutine find_events
end module gearsweep_motion_single_event
