!> The motions of gears whose teeth have errors of their own, at some speeds side by side, in few long steps
!> (gearsweep_quick_steps): first until the transient has died away, then over a whole turn. What the motion is at the end of a
!> turn has to be what it was at its begin. Neighbouring speeds mostly have the same pairs in contact, and then share all but
!> their own motions.
module gearsweep_quick_turn
  use gearsweep_deviations, only: deviations_t
  use gearsweep_kinds, only: dp, pi
  use gearsweep_quick_changes, only: quick_motion_t, state_t
  use gearsweep_quick_one_step, only: follow_step
  use gearsweep_quick_steps, only: by_errors, lanes, most_pairs, need_map, quick_maps_t, quick_steps_t
  implicit none
  private
  public :: quick_motion_t, lay_errors, follow_quickly

  type :: speeds_t
    integer :: set(lanes) = 0                    !< contact sets
    real(dp), dimension(lanes) :: x = 0, v = 0   !< m
    real(dp), dimension(lanes) :: least = huge(1.0_dp), largest = -huge(1.0_dp)      !< transmission error, m
    real(dp) :: sums(lanes, 2) = 0               !< as of quick_motion_t
    type(quick_motion_t) :: motion(lanes)
  end type speeds_t

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

  !> The motions over a turn.
  pure subroutine follow_quickly(steps, maps, errors, beside, motions)
    type(quick_steps_t), intent(inout) :: steps
    type(quick_maps_t), intent(inout) :: maps    !< of the speeds
    real(dp), contiguous, intent(in) :: errors(:, :, 0:)   !< of `lay_errors`
    type(quick_motion_t), intent(in) :: beside   !< of a speed beside, from which the transients begin, if one is found
    type(quick_motion_t), intent(out) :: motions(:)        !< (speed)
    ! What is left of the transient, and how near the ends of a turn have to be, in static deflections. The motion of a speed beside
    ! is nearer than the mean deflection.
    real(dp), parameter :: rest = 1e-4_dp, rest_beside = 5e-4_dp, near = 3e-4_dp
    integer, parameter :: most_turns = 4, most_periods = 2000
    type(speeds_t) :: now
    real(dp) :: before(lanes, 2), begin(lanes, 2), decay, forgets
    logical :: awaited(lanes)
    integer :: i, k, last, periods, turn

    associate (static => steps%osc%static_deflection, n => maps%speeds)
      periods = size(errors, 3)
      forgets = steps%osc%damping_ratio*minval(maps%turning)
      decay = -log(merge(rest_beside, rest, beside%is_found))
      if (decay > most_periods*forgets) return
      now%x = steps%osc%mean_deflection
      if (beside%is_found) then
        now%x = beside%begin(1)
        now%v = beside%begin(2)
      end if
      now%motion%peak = huge(1.0_dp)
      last = ceiling(decay/forgets) - 1
      do k = 0, last
        call follow_period(steps, maps, errors(:, :, modulo(k, periods)), k, .false., now)
      end do
      awaited = [(i <= n, i=1, lanes)]
      do turn = 1, most_turns
        before(:, 1) = now%x
        before(:, 2) = now%v
        now = speeds_t(now%set, now%x, now%v)
        do k = last + 1, last + periods
          if (modulo(k, periods) == 0) then
            begin(:, 1) = now%x
            begin(:, 2) = now%v
          end if
          call follow_period(steps, maps, errors(:, :, modulo(k, periods)), k, .true., now)
        end do
        do i = 1, n
          if (.not. awaited(i)) cycle
          awaited(i) = abs(now%x(i)) < 1e4_dp*static
          if (.not. awaited(i) .or. hypot(now%x(i) - before(i, 1), now%v(i) - before(i, 2)) >= near*static) cycle
          awaited(i) = .false.
          motions(i) = quick_motion_t(.not. (steps%osc%has_backlash .and. now%least(i) < -steps%osc%backlash), &
                                      now%motion(i)%peak, modulo(now%motion(i)%pair, periods), now%motion(i)%place, &
                                      now%least(i), now%largest(i), begin(i, :), now%sums(i, :)/periods)
        end do
        if (.not. any(awaited)) return
        where (.not. abs(now%x) < 1e4_dp*static)
          now%x = 0
          now%v = 0
        end where
      end do
    end associate
  end subroutine follow_quickly

  !> Follows the motions over one mesh period.
  pure subroutine follow_period(steps, maps, errors, period, is_noted, now)
    type(quick_steps_t), intent(inout) :: steps
    type(quick_maps_t), intent(inout) :: maps
    real(dp), contiguous, intent(in) :: errors(:, :)        ! (pair, node of all steps)
    integer, intent(in) :: period
    logical, intent(in) :: is_noted              ! whether extremes and sums are
    type(speeds_t), intent(inout) :: now
    real(dp), dimension(lanes) :: apart, bend, off, peak, trouble, v, x
    real(dp) :: hollow, r(3), touching(3)
    type(state_t) :: state
    integer :: usual, i, j, k, l, shift

    peak = now%motion%peak
    usual = most_common(now%set(:maps%speeds))
    apart = merge(-1, 1, now%set == usual)
    do i = 1, steps%steps
      if (steps%begins(i)) then
        k = merge(steps%steps, i - 1, i == 1)
        shift = steps%offset(k) - steps%offset(i) + merge(1, 0, i == 1)
        now%set = iand(ishft(now%set, shift), 2**steps%pairs(i) - 1)
        usual = iand(ishft(usual, shift), 2**steps%pairs(i) - 1)
      end if
      if (.not. maps%is_known(usual, i)) call need_map(steps, usual, i, maps)
      associate (law => steps%law(usual, i), a => maps%of(:, :, :, usual, i), error => errors(:, 3*i - 2:3*i))
        r = steps%osc%static_deflection + by_errors(law%pull, error)
        do l = 1, lanes
          x(l) = (a(l, 1, 1)*now%x(l) + a(l, 2, 1)*now%v(l)) + (a(l, 3, 1)*r(1) + a(l, 4, 1)*r(2) + a(l, 5, 1)*r(3))
          v(l) = (a(l, 1, 2)*now%x(l) + a(l, 2, 2)*now%v(l)) + (a(l, 3, 2)*r(1) + a(l, 4, 2)*r(2) + a(l, 5, 2)*r(3))
          bend(l) = steps%width(i)/8*maps%turning(l)*(now%v(l) - v(l))
        end do
        trouble = apart
        do j = 1, steps%pairs(i)
          touching = by_errors(law%touching(:, :, j), error)
          hollow = (touching(1) + touching(3))/2 - touching(2)
          if (btest(usual, j - 1)) then
            do l = 1, lanes
              off(l) = abs(bend(l) + hollow)
              trouble(l) = max(trouble(l), off(l) - min(now%x(l) - touching(1), x(l) - touching(3)), &
                               law%stiffest(j)*(max(now%x(l) - touching(1), x(l) - touching(3)) + 1.25_dp*off(l)) - peak(l))
            end do
          else
            do l = 1, lanes
              trouble(l) = max(trouble(l), max(now%x(l) - touching(1), x(l) - touching(3)) + abs(bend(l) + hollow))
            end do
          end if
        end do
      end associate
      if (largest_of(trouble) > 0) then
        do l = 1, maps%speeds
          if (.not. trouble(l) > 0) cycle
          state = state_t(now%x(l), now%v(l), set=now%set(l))
          call follow_step(steps, maps, errors(:, 3*i - 2:3*i), i, period, l, state, now%motion(l))
          x(l) = state%x
          v(l) = state%v
          now%set(l) = state%set
          peak(l) = now%motion(l)%peak
        end do
        usual = most_common(now%set(:maps%speeds))
        apart = merge(-1, 1, now%set == usual)
      end if
      if (is_noted) call note_errors(maps%turning, steps%width(i), steps%osc%mean_deflection, x, v, now)
      now%x = x
      now%v = v
    end do
  end subroutine follow_period

  !> The largest of all lanes.
  pure real(dp) function largest_of(values) result(largest)
    real(dp), intent(in) :: values(lanes)
    real(dp) :: half(lanes/2), quarter(lanes/4)

    ! So the processor's own instructions do.
    half = max(values(:lanes/2), values(lanes/2 + 1:))
    quarter = max(half(:lanes/4), half(lanes/4 + 1:))
    largest = maxval(quarter)
  end function largest_of

  !> The contact set of most speeds.
  pure integer function most_common(set)
    integer, intent(in) :: set(:)
    integer :: i, most

    most_common = set(1)
    if (all(set == set(1))) return
    most = 0
    do i = 1, size(set)
      if (count(set == set(i)) <= most) cycle
      most_common = set(i)
      most = count(set == set(i))
    end do
  end function most_common

  !> Extremes and sums of the transmission error over a step, by the cubic through the states at both ends.
  pure subroutine note_errors(turning, width, centre, x, v, now)
    real(dp), intent(in) :: turning(lanes), width, centre
    real(dp), intent(in) :: x(lanes), v(lanes)   ! at the end
    type(speeds_t), intent(inout) :: now         ! at the begin
    real(dp) :: at, beyond(lanes), c(0:3), extreme, middle(lanes), slope, span
    integer :: l

    do l = 1, lanes
      middle(l) = width/8*turning(l)*(now%v(l) - v(l))
      ! Between velocities of different sign, the cubic is beyond its ends by 32/27 of this at most.
      beyond(l) = max(max(now%x(l), x(l)) - now%largest(l), now%least(l) - min(now%x(l), x(l))) + 1.25_dp*abs(middle(l))
      middle(l) = (now%x(l) + x(l))/2 - centre + middle(l)
      now%sums(l, 1) = now%sums(l, 1) + width/6*(now%x(l) + x(l) - 2*centre + 4*middle(l))
      now%sums(l, 2) = now%sums(l, 2) + width/6*((now%x(l) - centre)**2 + (x(l) - centre)**2 + 4*middle(l)**2)
      now%least(l) = min(now%least(l), x(l))
      now%largest(l) = max(now%largest(l), x(l))
    end do
    if (.not. largest_of(beyond) > 0) return
    do l = 1, lanes
      if (.not. beyond(l) > 0 .or. now%v(l)*v(l) >= 0) cycle
      span = width*turning(l)
      c(0) = now%x(l)
      c(1) = span*now%v(l)
      c(2) = 3*(x(l) - now%x(l)) - span*(2*now%v(l) + v(l))
      c(3) = 2*(now%x(l) - x(l)) + span*(now%v(l) + v(l))
      at = now%v(l)/(now%v(l) - v(l))
      slope = 2*c(2) + 6*at*c(3)
      if (abs(slope) > abs(c(2))/8) at = max(0.0_dp, min(1.0_dp, at - (c(1) + at*(2*c(2) + 3*at*c(3)))/slope))
      extreme = c(0) + at*(c(1) + at*(c(2) + at*c(3)))
      now%least(l) = min(now%least(l), extreme)
      now%largest(l) = max(now%largest(l), extreme)
    end do
  end subroutine note_errors
end module gearsweep_quick_turn
