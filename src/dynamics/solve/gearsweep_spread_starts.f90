!> Steady motions from starts spread over the plane of states: Newton's method on the maps of one and several mesh periods,
!> from eight starts side by side. Most runs end on motions that repel, or on none; the first that attracts is taken.
module gearsweep_spread_starts
  use gearsweep_contact_set, only: period_t
  use gearsweep_gauss, only: batch_size
  use gearsweep_kinds, only: dp, pi
  use gearsweep_period, only: run_batch
  use gearsweep_period_map, only: period_map_t, set_durations
  use gearsweep_periodic_orbit, only: adopt, closure_of, is_closed, largest_multiplier, most_work, newton_step, shoot, steady_t
  use gearsweep_status, only: has_result
  use gearsweep_stop, only: wants_stop
  use gearsweep_transient, only: shorten, steady_options_t
  implicit none
  private
  public :: try_starts

  !> Mesh periods that the motions looked for have, and from how many batches of starts.
  integer, parameter :: periods(*) = [1, 2, 1, 2, 3, 4, 1], batches(*) = [2, 2, 2, 2, 2, 2, 8]

contains

  !> The first motion found that attracts.
  pure subroutine try_starts(map, options, steady)
    type(period_map_t), intent(inout) :: map         !< with the duration of one speed
    type(steady_options_t), intent(in) :: options
    type(steady_t), intent(out) :: steady            !< without a result where none was found
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

  !> Newton's method without halving its steps: from where those lead astray, another start is as good.
  pure subroutine close_motions(map, tolerance, periods, state, attracts, work)
    type(period_map_t), intent(inout) :: map
    real(dp), intent(in) :: tolerance
    integer, intent(in) :: periods
    real(dp), intent(inout) :: state(2, batch_size)  !< m; (:, start)
    logical, intent(out) :: attracts(batch_size)     !< there it is closed, and attracts
    real(dp), intent(out) :: work
    integer, parameter :: most_iterations = 12
    ! Eight motions side by side take about as long as four.
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

  !> Several periods in a row, as one.
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

  !> The first of the closed motions, run by itself.
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

  !> Starts after the first `before` ones: on a spiral about rest whose turns are the golden angle, so that they never line
  !> up; the distances come in turns of eight, up to `widest` static deflections.
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
end module gearsweep_spread_starts
