!> One change of contact within a step, without sub-steps: the motion before it is that of the step's polynomials
!> (gearsweep_dense_step), and the motion behind it is the one of the new contact set that goes through the
!> same state there, which is followed back to the begin of the step and from there to its end.
!>
!> That serves where a pair closes or opens once in the step and nothing else happens, as at tip corners in every period. All
!> else is for gearsweep_contact_events.
module gearsweep_event_crossing
  use gearsweep_change_loads, only: change_t, raise_peaks
  use gearsweep_coefficients, only: need_law
  use gearsweep_contact_set, only: in_contact, period_t, record_contact, set_contact
  use gearsweep_dense_step, only: by_force, by_place, by_speed, evaluate, evaluate_curvature, find_dense_step, motions_from
  use gearsweep_gauss, only: batch_size
  use gearsweep_integrator, only: integrator_t
  use gearsweep_kinds, only: dp
  use gearsweep_period_map, only: period_map_t
  use gearsweep_quintic, only: derivative_of, may_cross_zero, quintic, value_of
  implicit none
  private
  public :: cross_events, has_simple_steps

  !> In place of a pair: none changes; the ends of the step do not tell.
  integer, parameter :: none = 0, unclear = -1

contains

  !> Are changes of contact in the steps of this map for `cross_events` to try?
  pure logical function has_simple_steps(map)
    type(period_map_t), intent(in) :: map

    has_simple_steps = map%speeds == batch_size .and. map%osc%mesh%reaches_beyond() .and. .not. map%osc%damping_ratio > 1
    if (has_simple_steps) has_simple_steps = .not. any(map%table%kind%stiff)
  end function has_simple_steps

  !> Takes motions whose contact may change (`state%changes`) through a step, as far as one pair closes or opens in it. The
  !> others are left in `state%changes`.
  pure subroutine cross_events(map, step, state, propagator, period, crossed)
    type(period_map_t), intent(inout) :: map
    integer, intent(in) :: step
    type(integrator_t), intent(inout) :: state   !< the end of the step is that without events
    real(dp), intent(inout) :: propagator(batch_size, 6)
    type(period_t), intent(inout) :: period(:)   !< of each speed
    logical, intent(out) :: crossed(batch_size)  !< the contact does change, once
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

  !> The loads of a change wait for the end of the period, when most are known to be too low to matter.
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

  !> The pair that alone closes or opens in the step, as its ends show.
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
          ! Few periods have an instant at which the last pair parts or the first one meets: the sub-steps locate it.
          if (state%contact_set(l) == 0 .or. state%contact_set(l) == ibset(0, pair(l) - 1)) pair(l) = unclear
        end if
        if (.not. map%osc%has_backlash) cycle
        if (in_contact(state%contact_set(l), map%osc%contacts) .or. min(state%x(l, 1), state%x(l, 2)) - &
            (abs(state%y(l, 1)) + abs(state%y(l, 2)))*width/4 < -map%osc%backlash) pair(l) = unclear
      end do
    end associate
  end subroutine find_changing_pairs

  !> Where the contact changes, what the motion is there and at the end of the step, and its propagator.
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
    ! The second may have taken the place of the first.
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
        ! The inverse.
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
        ! How fast the overlap falls. Only damping jumps with the contact: the propagator feels that through the moment of
        ! the change.
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

  !> Keeps the speeds at which the contact set stays as it is behind the change, until the step ends.
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
                        > -map%osc%backlash
    end do
  end subroutine check_rest

  !> Takes the changes over.
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

  !> The deflection (m) at which a pair touches while the others of a contact set do, at both ends of a step, with its derivatives
  !> over the step; (derivative, end).
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

  !> Where overlaps fall below zero in a step: Newton's method within brackets, for all speeds side by side.
  pure subroutine find_events(c, wanted, place)
    real(dp), intent(in) :: c(batch_size, 0:7)   ! coefficients; below 0 at 1 where wanted
    logical, intent(in) :: wanted(batch_size)
    real(dp), intent(out) :: place(batch_size)
    real(dp), parameter :: tight = 1e-8_dp       ! the correction after the last one would be its square
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
end module gearsweep_event_crossing
