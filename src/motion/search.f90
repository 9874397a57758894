!> Search for a steady motion at a speed at which pairs separate: from the most likely strategy to the longest.
!>
!> Each strategy is tried where those before it failed. Where several motions attract, this order alone decides the result.
!>
!> 1. Newton's method from the motion that full contact would have.
!> 2. Where it ends on a motion that repels through a multiplier below -1: the motion of twice as many periods near it, and so on
!> up to the longest period sought.
!> 3. A short transient from rest.
!> 4. The motion under strong damping, which is then lowered step by step.
!> 5. Newton's method from eight starts spread over the plane of states, on the maps of one and several mesh periods. Most runs
!> end on motions that repel, or on none; the first that attracts is used.
!> 6. The full transient from rest.
module gearsweep_motion_search
  use gearsweep_base, only: dp, pi, wants_stop
  use gearsweep_motion_contact_set, only: period_t
  use gearsweep_motion_gauss, only: batch_size
  use gearsweep_motion_period, only: run_batch
  use gearsweep_motion_period_map, only: period_map_t, set_durations
  use gearsweep_motion_periodic_orbit, only: adopt, closure_of, distance, has_converged, is_closed, largest_multiplier, &
    most_negative_direction, most_work, newton_step, run_periods, shoot, solve_full_contact, steady_t
  use gearsweep_motion_steady_motion, only: has_result, status_chatter, status_unstable
  use gearsweep_motion_transient, only: march, shorten, steady_options_t
  implicit none
  private
  public :: try_in_turn, double

  !> Few starts for motions of gears as built: displacement from the mean deflection and velocity over the natural frequency, in
  !> static deflections: rest, and around it. Two whose ends are nearer than `start_alike` are on one motion, once the natural
  !> motion has decayed by exp(-start_decay).
  real(dp), parameter, public :: few_starts(2, 6) = reshape( &
    [0.0_dp, 0.0_dp, 3.5_dp, -3.5_dp, 3.5_dp, 3.5_dp, 3.0_dp, 0.0_dp, -2.0_dp, 2.0_dp, -2.0_dp, -2.0_dp], [2, 6])
  real(dp), parameter, public :: start_alike = 0.05_dp, start_decay = 5.3_dp


  !> Mesh periods of the motions sought, and number of batches of starts for each.
  integer, parameter :: periods(*) = [1, 2, 1, 2, 3, 4, 1], batches(*) = [2, 2, 2, 2, 2, 2, 8]

  !> Mesh periods of a short transient: from rest, and after a motion ends under lowered damping.
  integer, parameter :: from_rest = 100, beyond_end = 40

contains

  !> Finds the first attracting motion from the starts.
  pure subroutine try_starts(map, options, steady)
    type(period_map_t), intent(inout) :: map         !< map with the duration of one speed
    type(steady_options_t), intent(in) :: options
    type(steady_t), intent(out) :: steady            !< motion; without a result if none was found
    real(dp) :: duration, state(2, batch_size), work
    logical :: attracts(batch_size)
    integer :: i, k, next

    duration = map%duration(1)
    next = 0
    do i = 1, size(periods)
      if (periods(i) > options%most_periods) cycle
      do k = 1, batches(i)
        if (wants_stop(options%stop) .or. steady%work > most_work) exit
        call set_durations(map, spread(duration, 1, batch_size))
        call spread_starts(map, next, state)
        next = next + batch_size
        call close_motions(map, options%tolerance, periods(i), state, attracts, work)
        steady%work = steady%work + work
        if (.not. any(attracts)) cycle
        call set_durations(map, [duration])
        call take_first(map, options, periods(i), state, attracts, steady)
        if (has_result(steady%status)) return
      end do
    end do
    call set_durations(map, [duration])
  end subroutine try_starts

  !> Applies Newton's method without halving its steps: where those fail, another start is as good.
  pure subroutine close_motions(map, tolerance, periods, state, attracts, work)
    type(period_map_t), intent(inout) :: map
    real(dp), intent(in) :: tolerance
    integer, intent(in) :: periods
    real(dp), intent(inout) :: state(2, batch_size)  !< m; (:, start)
    logical, intent(out) :: attracts(batch_size)     !< true: converged there, and attracts
    real(dp), intent(out) :: work
    integer, parameter :: most_iterations = 12
    ! Eight motions in parallel lanes take about as long as four.
    real(dp), parameter :: side_by_side = 0.5_dp
    type(period_t) :: run(batch_size)
    real(dp) :: step(2)
    logical :: active(batch_size)
    integer :: iteration, l

    active = .true.
    attracts = .false.
    work = 0
    do iteration = 1, most_iterations
      call run_periods_side_by_side(map, periods, state, active, run)
      work = work + side_by_side*sum(run%work)
      do l = 1, batch_size
        if (.not. active(l)) cycle
        if (is_closed(closure_of(map%osc, map%duration(l), state(:, l), run(l)), tolerance)) then
          active(l) = .false.
          attracts(l) = largest_multiplier(run(l)%monodromy) < 1 + 1e-6_dp
        else
          call newton_step(run(l)%monodromy, run(l)%state - state(:, l), step, active(l))
          active(l) = active(l) .and. .not. run(l)%failed
          state(:, l) = state(:, l) + step
        end if
      end do
      if (.not. any(active)) exit
    end do
  end subroutine close_motions

  !> Integrates several periods of all motions in a row as one.
  pure subroutine run_periods_side_by_side(map, periods, start, active, run)
    type(period_map_t), intent(inout) :: map
    integer, intent(in) :: periods
    real(dp), intent(in) :: start(2, batch_size)
    logical, intent(in) :: active(batch_size)
    type(period_t), intent(out) :: run(batch_size)
    type(period_t) :: next(batch_size)
    real(dp) :: state(2, batch_size)
    integer :: i, l

    call run_batch(map, start, active, .false., run)
    do i = 2, periods
      do l = 1, batch_size
        state(:, l) = run(l)%state
      end do
      call run_batch(map, state, active, .false., next)
      do l = 1, batch_size
        run(l)%state = next(l)%state
        run(l)%monodromy = matmul(next(l)%monodromy, run(l)%monodromy)
        run(l)%failed = run(l)%failed .or. next(l)%failed
        run(l)%work = run(l)%work + next(l)%work
      end do
    end do
  end subroutine run_periods_side_by_side

  !> Selects the first of the converged motions, run by itself.
  pure subroutine take_first(map, options, periods, state, attracts, steady)
    type(period_map_t), intent(inout) :: map
    type(steady_options_t), intent(in) :: options
    integer, intent(in) :: periods
    real(dp), intent(in) :: state(2, batch_size)
    logical, intent(in) :: attracts(batch_size)
    type(steady_t), intent(inout) :: steady
    type(steady_t) :: found
    integer :: l

    do l = 1, batch_size
      if (.not. attracts(l)) cycle
      call shoot(map, options%tolerance, periods, state(:, l), found)
      if (has_result(found%status)) then
        if (periods > 1) call shorten(map, options%tolerance, found)
        call adopt(found, steady)
        return
      end if
      steady%work = steady%work + found%work
    end do
  end subroutine take_first

  !> Computes starts after the first `before` ones: on a spiral about rest with the golden angle between them, so that they never
  !> line up; the distances repeat after eight, up to `widest` static deflections.
  pure subroutine spread_starts(map, before, state)
    type(period_map_t), intent(in) :: map
    integer, intent(in) :: before
    real(dp), intent(out) :: state(2, batch_size)
    real(dp), parameter :: widest = 6, golden = pi*(3 - sqrt(5.0_dp))
    real(dp) :: radius, angle
    integer :: l

    associate (osc => map%osc, duration => map%duration(1))
      do l = 1, batch_size
        radius = widest*(l - 0.5_dp)/batch_size*osc%static_deflection
        angle = golden*(before + l)
        state(:, l) = [osc%mean_deflection, 0.0_dp] &
                      + radius*[cos(angle), sin(angle)*max(1.0_dp, osc%natural_frequency*duration)]
      end do
    end associate
  end subroutine spread_starts

  !> Tries the strategies in turn for the steady motion, or finds why there is none.
  pure subroutine try_in_turn(map, options, linear, steady)
    type(period_map_t), intent(inout) :: map         !< map with the duration of one speed
    type(steady_options_t), intent(in) :: options
    real(dp), intent(in) :: linear(2)                !< state of the motion in full contact, m
    type(steady_t), intent(inout) :: steady          !< in: without a result
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
      ! If contact changes without end from rest, it does so from other starts too.
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

  !> Continues from a motion that repels through a multiplier below -1 to one of twice as many periods, until that attracts.
  pure subroutine double(map, options, repelling, steady)
    type(period_map_t), intent(inout) :: map         !< map with the duration of one speed
    type(steady_options_t), intent(in) :: options
    type(steady_t), intent(in) :: repelling          !< otherwise unchanged
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

  !> Finds the motion of twice as many periods, from starts along the direction in which disturbances grow.
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

  !> Follows the motion from strong damping, if it exists there, down to the damping of the map.
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
        ! The motion repels from here on, or ends: a repelling one is replaced by its doubled one, else smaller steps follow it to
        ! its end.
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
      ! The period of a doubled motion may have halved again.
      if (here%periods > 1) call shorten(map, options%tolerance, here)
      steady = here
    else
      steady%work = work
    end if
  end subroutine lower_damping

  !> Replaces a repelling motion by its doubled one.
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

  !> Runs a short transient, and finds the motion it leads to.
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
end module gearsweep_motion_search
