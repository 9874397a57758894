!> A steady motion of a speed at which pairs part: ways to one, from the likeliest to the longest, each tried where those
!> before it led to none. Where several motions attract, this order alone decides the result.
!>
!> 1. Newton's method from the motion that full contact would have.
!> 2. Where it ends on a motion that repels through a multiplier below -1: the motion of twice as many periods beside it,
!>    and so on up to the longest that is looked for.
!> 3. A short transient from rest.
!> 4. The motion under strong damping, which is then lowered step by step.
!> 5. Newton's method from starts spread over the plane of states.
!> 6. The whole transient from rest.
module gearsweep_ladder
  use gearsweep_contact_set, only: period_t
  use gearsweep_kinds, only: dp
  use gearsweep_period_map, only: period_map_t, set_durations
  use gearsweep_periodic_orbit, only: adopt, distance, has_converged, most_negative_direction, most_work, run_periods, shoot, &
                                      solve_full_contact, steady_t
  use gearsweep_spread_starts, only: try_starts
  use gearsweep_status, only: has_result, status_chatter, status_unstable
  use gearsweep_stop, only: wants_stop
  use gearsweep_transient, only: march, shorten, steady_options_t
  implicit none
  private
  public :: try_in_turn, double

  !> Mesh periods of a short transient: from rest, and where a motion ends under lowered damping.
  integer, parameter :: from_rest = 100, beyond_end = 40

contains

  !> The steady motion, or why there is none.
  pure subroutine try_in_turn(map, options, linear, steady)
    type(period_map_t), intent(inout) :: map         !< with the duration of one speed
    type(steady_options_t), intent(in) :: options
    real(dp), intent(in) :: linear(2)                !< state of the motion in full contact, m
    type(steady_t), intent(inout) :: steady          !< without a result so far
    integer, parameter :: last = 6
    type(steady_t) :: found
    real(dp) :: rest(2)
    integer :: attempt

    rest = [map%osc%mean_deflection, 0.0_dp]
    do attempt = 1, last
      ! Where changes of contact are not located, the map has jumps: Newton's method converges only from nearby.
      if (allocated(map%literature) .and. attempt > 1 .and. attempt < last) cycle
      if (attempt < last .and. (wants_stop(options%stop) .or. steady%work > most_work)) cycle
      found = steady_t()
      select case (attempt)
      case (1)
        call shoot(map, options%tolerance, 1, linear, found)
      case (2)
        call double(map, options, steady, found)
      case (3)
        call run_transient(map, options, from_rest, rest, found)
      case (4)
        call lower_damping(map, options, found)
      case (5)
        call try_starts(map, options, found)
      case default
        call march(map, options, rest, steady)
        return
      end select
      call take(found, steady)
      if (has_result(steady%status)) return
      ! Where contact changes without end from rest, so it does from elsewhere.
      if (attempt == 3 .and. found%status == status_chatter) steady%status = status_chatter
      if (steady%status == status_chatter) return
    end do
  end subroutine try_in_turn

  !> Keeps a motion that attracts, or the first that repels.
  pure subroutine take(found, steady)
    type(steady_t), intent(in) :: found
    type(steady_t), intent(inout) :: steady

    if (has_result(found%status) .or. (found%status == status_unstable .and. steady%status /= status_unstable)) then
      call adopt(found, steady)
    else
      steady%work = steady%work + found%work
    end if
  end subroutine take

  !> From a motion that repels through a multiplier below -1 to one of twice as many periods, until that attracts.
  pure subroutine double(map, options, repelling, steady)
    type(period_map_t), intent(inout) :: map         !< with the duration of one speed
    type(steady_options_t), intent(in) :: options
    type(steady_t), intent(in) :: repelling          !< else nothing is done
    type(steady_t), intent(out) :: steady            !< with a result if one was found; its work is that done here
    type(steady_t) :: last, next
    real(dp) :: work

    work = 0
    last = repelling
    do while (last%status == status_unstable .and. 2*last%periods <= options%most_periods)
      call double_once(map, options%tolerance, last, next)
      work = work + next%work
      last = next
    end do
    if (has_result(last%status)) then
      last%work = 0
      call shorten(map, options%tolerance, last)
      steady = last
    end if
    steady%work = steady%work + work
  end subroutine double

  !> The motion of twice as many periods, from starts along the direction in which disturbances grow.
  pure subroutine double_once(map, tolerance, last, next)
    type(period_map_t), intent(inout) :: map
    real(dp), intent(in) :: tolerance
    type(steady_t), intent(in) :: last
    type(steady_t), intent(out) :: next
    real(dp), parameter :: away(*) = [0.1_dp, 0.3_dp, 1.0_dp], same = 1e-5_dp
    type(period_t) :: run
    type(steady_t) :: found
    real(dp) :: direction(2)
    logical :: doubles
    integer :: i

    associate (osc => map%osc, duration => map%duration(1))
      call run_periods(map, last%state, last%periods, run)
      next%work = run%work
      call most_negative_direction(osc, duration, run%monodromy, direction, doubles)
      if (.not. doubles) return
      do i = 1, size(away)
        call shoot(map, tolerance, 2*last%periods, last%state + away(i)*osc%static_deflection*direction, found)
        if (distance(osc, duration, found%state - last%state) > same .and. &
            (has_result(found%status) .or. (found%status == status_unstable .and. next%status /= status_unstable))) then
          call adopt(found, next)
          if (has_result(next%status)) return
        else
          next%work = next%work + found%work
        end if
      end do
    end associate
  end subroutine double_once

  !> Follows the motion from strong damping, where there is one, down to the damping of the map.
  pure subroutine lower_damping(map, options, steady)
    type(period_map_t), intent(inout) :: map
    type(steady_options_t), intent(in) :: options
    type(steady_t), intent(out) :: steady
    real(dp), parameter :: strong = 0.5_dp, weakest = 1e-5_dp, stride = 0.7_dp, shortest = 0.9_dp
    integer, parameter :: most_solves = 40
    type(steady_t) :: here, there
    real(dp) :: damping, state(2), at, next, factor, work
    integer :: solve

    damping = map%osc%damping_ratio
    if (damping >= strong) return
    at = strong
    factor = stride
    call set_damping(map, at)
    call solve_full_contact(map, state, here)
    if (.not. has_converged(here)) call shoot(map, options%tolerance, 1, state, here)
    work = 0
    do solve = 1, most_solves
      if (.not. has_result(here%status) .or. .not. at > damping .or. work > most_work) exit
      next = max(damping, factor*at)
      if (next < weakest) next = damping
      call set_damping(map, next)
      call shoot(map, options%tolerance, here%periods, here%state, there)
      work = work + there%work
      if (.not. has_result(there%status) .and. factor < shortest) then
        ! The motion repels from here on, or ends: the one is left by doubling, else in smaller steps as far as it goes.
        call leave_repelling(map, options, there, work)
        if (.not. has_result(there%status)) then
          factor = sqrt(factor)
          cycle
        end if
      else if (.not. has_result(there%status)) then
        call run_transient(map, options, beyond_end, here%state, there)
        work = work + there%work
      end if
      here = there
      at = next
      factor = stride
    end do
    call set_damping(map, damping)
    if (has_result(here%status) .and. .not. at > damping) then
      here%work = work
      ! A doubled motion may have become the single one again.
      if (here%periods > 1) call shorten(map, options%tolerance, here)
      steady = here
    else
      steady%work = work
    end if
  end subroutine lower_damping

  !> Where a motion repels, its doubled one takes its place.
  pure subroutine leave_repelling(map, options, motion, work)
    type(period_map_t), intent(inout) :: map
    type(steady_options_t), intent(in) :: options
    type(steady_t), intent(inout) :: motion
    real(dp), intent(inout) :: work
    type(steady_t) :: found

    call double(map, options, motion, found)
    work = work + found%work
    if (has_result(found%status)) motion = found
  end subroutine leave_repelling

  !> What a short transient leads to.
  pure subroutine run_transient(map, options, cycles, start, motion)
    type(period_map_t), intent(inout) :: map
    type(steady_options_t), intent(in) :: options
    integer, intent(in) :: cycles                    ! mesh periods
    real(dp), intent(in) :: start(2)
    type(steady_t), intent(out) :: motion
    type(steady_options_t) :: brief

    brief = options
    brief%most_cycles = min(cycles, options%most_cycles)
    call march(map, brief, start, motion)
  end subroutine run_transient

  pure subroutine set_damping(map, damping_ratio)
    type(period_map_t), intent(inout) :: map
    real(dp), intent(in) :: damping_ratio

    map%osc%damping_ratio = damping_ratio
    call set_durations(map, [map%duration(1)])
  end subroutine set_damping
end module gearsweep_ladder
