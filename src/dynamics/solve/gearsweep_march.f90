!> The transient, followed period by period until the motion repeats, or until it
!> is clear that it will not.
module gearsweep_march
  use, intrinsic :: iso_c_binding, only: c_null_ptr, c_ptr
  use gearsweep_kinds, only: dp
  use gearsweep_motion, only: oscillator_t, table_t
  use gearsweep_period, only: period_t, maps_t, run_period
  use gearsweep_orbit, only: steady_t, near, most_work, adopt, shoot, newton_step, closure_of, run_periods, judge, distance, &
                             largest_multiplier
  use gearsweep_status, only: has_result, status_aperiodic, status_chaotic, status_chatter, status_stopped, status_unstable
  use gearsweep_stop, only: wants_stop
  implicit none
  private
  public :: march, steady_options_t, sure_growth

  integer, parameter, public :: by_shooting = 1, by_marching = 2

  type :: steady_options_t
    integer :: method = by_shooting
    real(dp) :: tolerance = 1e-6_dp              !< of the dynamic factor
    integer :: most_cycles = 2000                !< mesh periods marched at most
    integer :: most_periods = 8                  !< longest subharmonic looked for
    type(c_ptr) :: stop = c_null_ptr             !< an integer of the caller; the search ends where it is not 0
  end type steady_options_t

  !> The end of a march: its last states, the newest first, the maps of the last
  !> 1, 2, ... periods, and by how much a disturbance has grown.
  type :: trail_t
    real(dp), allocatable :: state(:, :)         !< (2, 0:periods)
    real(dp), allocatable :: map(:, :, :)        !< (2, 2, periods)
    integer :: length = 0                        !< mesh periods marched
    real(dp) :: decay = 0                        !< -log of the determinant of all maps, by the damping
    real(dp) :: disturbance(2) = 1               !< x, and y over its unit; of length 1
    real(dp) :: growth = 0                       !< logarithm, since `first_counted`
  end type trail_t

  !> A bounded motion whose disturbances grow by more than exp(40) cannot be
  !> periodic over the periods that this took; `enough` of them are asked for.
  real(dp), parameter :: sure_growth = 40
  integer, parameter :: first_counted = 50, enough = 500

contains

  !> Follows the transient until it repeats after some periods. By shooting,
  !> Newton's method takes it to the end as soon as the maps of the last periods
  !> promise an attracting motion nearby. Where nothing settles, an `unstable`
  !> motion found before is what is reported, unless the motion is chaotic.
  pure subroutine march(osc, table, duration, options, start, maps, steady)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    real(dp), intent(in) :: duration
    type(steady_options_t), intent(in) :: options
    real(dp), intent(in) :: start(2)
    type(maps_t), intent(inout) :: maps
    type(steady_t), intent(inout) :: steady
    type(trail_t) :: trail
    type(period_t) :: run
    type(steady_t) :: trial
    integer :: next_shot, periods, most_cycles
    real(dp) :: before

    if (steady%status /= status_unstable) steady = steady_t(work=steady%work)
    ! Without damping nothing settles.
    if (.not. osc%damping_ratio > 0) return
    call begin(trail, options%most_periods, start)
    next_shot = 1
    before = steady%work
    most_cycles = min(options%most_cycles, max(1, int(most_work/table%steps)))
    do while (trail%length < most_cycles .and. steady%work - before < most_work)
      if (wants_stop(options%stop)) then
        steady%status = status_stopped
        return
      end if
      call run_period(osc, table, duration, trail%state(:, 0), maps, run)
      steady%work = steady%work + run%work
      if (run%failed) steady%status = status_chatter
      if (run%failed .or. .not. distance(osc, duration, run%state) < huge(1.0_dp)) return
      call follow(trail, run, max(1.0_dp, osc%natural_frequency*duration))
      if (trail%length >= next_shot) then
        call settle(osc, table, duration, options, trail, maps, periods, trial)
        if (has_result(trial%status)) then
          call adopt(trial, steady)
          if (periods > 1) call shorten(osc, table, duration, options%tolerance, maps, steady)
          return
        end if
        steady%work = steady%work + trial%work
        if (periods > 0) next_shot = trail%length + 5 + trail%length/5
      end if
      if (trail%length < enough) cycle
      ! Chaos, or damping that tells in none of the periods to come.
      if (trail%growth > sure_growth .or. trail%decay*most_cycles < 8*trail%length) exit
    end do
    if (.not. trail%growth > sure_growth) return
    steady = steady_t(status=status_chaotic, multiplier=exp(trail%growth/(trail%length - first_counted)), &
                      partial=run%partial, flight=run%flight, coast=run%coast, work=steady%work)
  end subroutine march

  pure subroutine begin(trail, periods, start)
    type(trail_t), intent(out) :: trail
    integer, intent(in) :: periods
    real(dp), intent(in) :: start(2)

    allocate (trail%state(2, 0:periods), trail%map(2, 2, periods))
    trail%state = spread(start, 2, periods + 1)
    trail%map = 0
  end subroutine begin

  !> Adds one period; `unit` is that of y in a disturbance.
  pure subroutine follow(trail, run, unit)
    type(trail_t), intent(inout) :: trail
    type(period_t), intent(in) :: run
    real(dp), intent(in) :: unit
    real(dp) :: size
    integer :: k

    do k = ubound(trail%map, 3), 2, -1
      trail%state(:, k) = trail%state(:, k - 1)
      trail%map(:, :, k) = matmul(run%map, trail%map(:, :, k - 1))
    end do
    trail%state(:, 1) = trail%state(:, 0)
    trail%map(:, :, 1) = run%map
    trail%state(:, 0) = run%state
    trail%length = trail%length + 1
    trail%decay = trail%decay - log(max(determinant(run%map), tiny(size)))
    trail%disturbance = matmul(run%map, trail%disturbance*[1.0_dp, unit])/[1.0_dp, unit]
    size = max(norm2(trail%disturbance), tiny(size))
    trail%disturbance = trail%disturbance/size
    if (trail%length > first_counted) trail%growth = trail%growth + log(size)
  end subroutine follow

  pure real(dp) function determinant(map)
    real(dp), intent(in) :: map(2, 2)

    determinant = map(1, 1)*map(2, 2) - map(1, 2)*map(2, 1)
  end function determinant

  !> Tries to end the march: `periods` is after how many the motion nearly
  !> repeats, 0 where it does not; `found` has an answer where it settled.
  pure subroutine settle(osc, table, duration, options, trail, maps, periods, found)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    real(dp), intent(in) :: duration
    type(steady_options_t), intent(in) :: options
    type(trail_t), intent(in) :: trail
    type(maps_t), intent(inout) :: maps
    integer, intent(out) :: periods
    type(steady_t), intent(out) :: found
    type(period_t) :: run
    real(dp) :: defect(2), step(2), rest, close
    logical :: solved

    ! Marching ends where what is left of the transient is far below the tolerance.
    close = merge(1e-3_dp*options%tolerance, near/2, options%method == by_marching)
    do periods = 1, min(options%most_periods, trail%length)
      defect = trail%state(:, 0) - trail%state(:, periods)
      if (distance(osc, duration, defect) > close) cycle
      if (largest_multiplier(trail%map(:, :, periods)) > 1) cycle
      ! The motion that repeats, by the linear map, and how far the last state is from it.
      call newton_step(trail%map(:, :, periods), defect, step, solved)
      rest = distance(osc, duration, step - defect)
      if (solved .and. rest < close) exit
    end do
    if (periods > min(options%most_periods, trail%length)) then
      periods = 0
    else if (options%method == by_marching) then
      call run_periods(osc, table, duration, trail%state(:, 0), periods, maps, run)
      call judge(osc, duration, trail%state(:, 0), run, closure_of(osc, duration, trail%state(:, 0), run), periods, found)
      found%work = run%work
    else
      call shoot(osc, table, duration, options%tolerance, periods, trail%state(:, periods) + step, maps, found)
      if (has_result(found%status) .and. distance(osc, duration, found%state - trail%state(:, 0)) > near) &
        found%status = status_aperiodic
    end if
  end subroutine settle

  !> A motion found over several periods may repeat after fewer.
  pure subroutine shorten(osc, table, duration, tolerance, maps, steady)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    real(dp), intent(in) :: duration, tolerance
    type(maps_t), intent(inout) :: maps
    type(steady_t), intent(inout) :: steady
    real(dp) :: same
    type(steady_t) :: trial
    type(period_t) :: run
    integer :: periods

    ! Marching leaves a thousandth of the tolerance in each of the periods.
    same = max(1e-7_dp, 1e-2_dp*tolerance)
    do periods = 1, steady%periods/2
      if (modulo(steady%periods, periods) /= 0) cycle
      call run_periods(osc, table, duration, steady%state, periods, maps, run)
      steady%work = steady%work + run%work
      if (distance(osc, duration, run%state - steady%state) > same) cycle
      call shoot(osc, table, duration, tolerance, periods, steady%state, maps, trial)
      if (has_result(trial%status)) call adopt(trial, steady)
      return
    end do
  end subroutine shorten
end module gearsweep_march
