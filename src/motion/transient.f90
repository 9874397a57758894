!> The transient, integrated period by period until the motion repeats, or until it is clear that it will not.
module gearsweep_motion_transient
  use gearsweep_base, only: dp, wants_stop
  use gearsweep_motion_contact_set, only: join, period_t
  use gearsweep_motion_period, only: run_period
  use gearsweep_motion_period_map, only: period_map_t
  use gearsweep_motion_periodic_orbit, only: adopt, closure_of, distance, is_bounded, judge, largest_multiplier, most_work, near, &
    newton_step, run_periods, shoot
  use gearsweep_motion_steady_motion, only: by_marching, by_shooting, has_result, seen_t, status_aperiodic, status_chaotic, &
    status_chatter, status_stopped, status_transient, status_unbounded, status_unstable, steady_options_t, steady_t
  implicit none
  private
  public :: march, shorten, by_marching, by_shooting, steady_options_t, sure_growth, growth_t

  !> Growth of a disturbance of a motion, by the monodromy matrices of its mesh periods.
  type :: growth_t
    real(dp) :: disturbance(2) = 1               !< x, and y over its unit; of length 1
    real(dp) :: logarithm = 0                    !< logarithm of its growth since the period `first_counted`
    integer :: periods = 0                       !< mesh periods
  contains
    procedure :: add
    procedure :: is_sure
    procedure :: per_period
  end type growth_t

  !> Last states and maps of a transient.
  type :: history_t
    real(dp), allocatable :: state(:, :)         !< last states, the newest first, m; (2, 0:periods)
    real(dp), allocatable :: monodromy(:, :, :)  !< monodromy matrices of the last 1, 2, ... periods; (2, 2, periods)
    real(dp) :: decay = 0                        !< -log of the determinant of all monodromy matrices, by the damping
    type(growth_t) :: growth
    type(seen_t) :: seen                         !< after the decay of the initial excitation
  end type history_t

  !> Logarithmic growth above which a bounded motion cannot be periodic: its disturbances have grown by more than exp(40) over its
  !> periods, of which there must be at least `enough`.
  real(dp), parameter :: sure_growth = 40
  integer, parameter :: first_counted = 50, enough = 500

  !> Decay of the natural motion to exp(-faded/2), a hundredth, after which loads count; with little damping, they count after
  !> half of `enough` periods.
  real(dp), parameter :: faded = 9.2_dp

contains

  !> Integrates the transient until it repeats after some periods. With shooting, Newton's method completes it as soon as the
  !> monodromy matrices of the last periods predict an attracting motion nearby.
  pure subroutine march(map, options, start, steady)
    type(period_map_t), intent(inout) :: map     !< map with the duration of one speed
    type(steady_options_t), intent(in) :: options
    real(dp), intent(in) :: start(2)             !< state, m
    !> Result; where no transient dies away, an unstable motion found before is kept, unless the motion is chaotic.
    type(steady_t), intent(inout) :: steady
    type(history_t) :: history
    type(period_t) :: run
    type(steady_t) :: trial
    integer :: next_shot, periods, most_cycles
    real(dp) :: before

    if (steady%status /= status_unstable) steady = steady_t(work=steady%work)
    ! Without damping no transient dies away.
    if (.not. map%osc%damping_ratio > 0) then
      if (steady%status /= status_unstable) steady%status = status_aperiodic
      return
    end if
    call begin(history, options%most_periods, start)
    next_shot = 1
    before = steady%work
    most_cycles = min(options%most_cycles, max(1, int(most_work/map%steps)))
    do while (history%growth%periods < most_cycles .and. steady%work - before < most_work)
      if (wants_stop(options%stop)) then
        steady%status = status_stopped
        return
      end if
      call run_period(map, history%state(:, 0), run)
      steady%work = steady%work + run%work
      if (run%failed) steady%status = status_chatter
      if (.not. (run%failed .or. is_bounded(map%osc, map%duration(1), run%state))) steady%status = status_unbounded
      if (run%failed .or. steady%status == status_unbounded) return
      if (history%decay > faded .or. 2*history%growth%periods >= enough) &
        call watch(run, map%osc%mesh%deviations%periods, history%seen)
      call append(history, run, max(1.0_dp, map%osc%natural_frequency*map%duration(1)))
      if (history%growth%periods >= next_shot) then
        call try_to_end(map, options, history, periods, trial)
        if (has_result(trial%status)) then
          call adopt(trial, steady)
          if (periods > 1) call shorten(map, options%tolerance, steady)
          return
        end if
        steady%work = steady%work + trial%work
        if (periods > 0) next_shot = history%growth%periods + 5 + history%growth%periods/5
      end if
      if (history%growth%periods < enough) cycle
      ! Chaos, or so little damping that the transient never dies away.
      if (history%growth%is_sure() .or. history%decay*most_cycles < 8*history%growth%periods) exit
    end do
    if (history%growth%is_sure()) &
      steady = steady_t(status=status_chaotic, multiplier=exp(history%growth%per_period()), &
                        departs=run%departs, partial=run%partial, lost=run%lost, coast=run%coast, work=steady%work)
    steady%seen = history%seen
  end subroutine march

  !> Adds the observations of one run of the map, over this many mesh periods.
  pure subroutine watch(run, periods, seen)
    type(period_t), intent(in) :: run
    integer, intent(in) :: periods
    type(seen_t), intent(inout) :: seen

    seen%periods = seen%periods + periods
    seen%peak = max(seen%peak, run%peak)
    seen%dte = join(seen%dte, run%dte)
  end subroutine watch

  pure subroutine begin(history, periods, start)
    type(history_t), intent(out) :: history
    integer, intent(in) :: periods
    real(dp), intent(in) :: start(2)

    allocate (history%state(2, 0:periods), history%monodromy(2, 2, periods))
    history%state = spread(start, 2, periods + 1)
    history%monodromy = 0
  end subroutine begin

  !> Adds one period; `unit` is that of y in a disturbance.
  pure subroutine append(history, run, unit)
    type(history_t), intent(inout) :: history
    type(period_t), intent(in) :: run
    real(dp), intent(in) :: unit
    real(dp) :: one(2, 2)
    integer :: k

    one = limited(run%monodromy)
    do k = ubound(history%monodromy, 3), 2, -1
      history%state(:, k) = history%state(:, k - 1)
      history%monodromy(:, :, k) = limited(matmul(one, history%monodromy(:, :, k - 1)))
    end do
    history%state(:, 1) = history%state(:, 0)
    history%monodromy(:, :, 1) = one
    history%state(:, 0) = run%state
    history%decay = history%decay - log(max(determinant(one), tiny(unit)))
    call history%growth%add(one, unit)
  end subroutine append

  !> Follows the disturbance over one more mesh period.
  pure subroutine add(self, monodromy, unit)
    class(growth_t), intent(inout) :: self
    real(dp), intent(in) :: monodromy(2, 2)
    real(dp), intent(in) :: unit                 !< unit of y
    real(dp) :: size

    self%periods = self%periods + 1
    self%disturbance = matmul(monodromy, self%disturbance*[1.0_dp, unit])/[1.0_dp, unit]
    size = max(norm2(self%disturbance), tiny(size))
    self%disturbance = self%disturbance/size
    if (self%periods > first_counted) self%logarithm = self%logarithm + log(size)
  end subroutine add

  !> True if a bounded motion is chaotic.
  pure logical function is_sure(self)
    class(growth_t), intent(in) :: self

    is_sure = self%periods >= enough .and. self%logarithm > sure_growth
  end function is_sure

  !> Logarithm of the mean growth over a mesh period.
  pure real(dp) function per_period(self)
    class(growth_t), intent(in) :: self

    per_period = self%logarithm/(self%periods - first_counted)
  end function per_period

  !> Limits disturbances over many turns, which may overflow; their size beyond the limit does not matter.
  pure function limited(a) result(b)
    real(dp), intent(in) :: a(2, 2)
    real(dp), parameter :: largest = 1e140_dp    ! its square does not overflow
    real(dp) :: b(2, 2)

    b = a
    if (maxval(abs(a)) > largest) b = a*(largest/maxval(abs(a)))
  end function limited

  pure real(dp) function determinant(a)
    real(dp), intent(in) :: a(2, 2)

    determinant = a(1, 1)*a(2, 2) - a(1, 2)*a(2, 1)
  end function determinant

  !> Tries to end the transient: `periods` is the number after which the motion nearly repeats (0: it does not); `found` has a
  !> result if the transient died away.
  pure subroutine try_to_end(map, options, history, periods, found)
    type(period_map_t), intent(inout) :: map
    type(steady_options_t), intent(in) :: options
    type(history_t), intent(in) :: history
    integer, intent(out) :: periods
    type(steady_t), intent(out) :: found
    type(period_t) :: run
    real(dp) :: defect(2), step(2), remainder, small
    logical :: solved

    associate (osc => map%osc, duration => map%duration(1))
      ! Marching ends where the remaining transient is far below the tolerance.
      small = merge(1e-3_dp*options%tolerance, near/2, options%method == by_marching)
      do periods = 1, min(options%most_periods, history%growth%periods)
        defect = history%state(:, 0) - history%state(:, periods)
        if (distance(osc, duration, defect) > small) cycle
        if (largest_multiplier(history%monodromy(:, :, periods)) > 1) cycle
        ! Periodic motion of the linear map, and the distance of the last state from it.
        call newton_step(history%monodromy(:, :, periods), defect, step, solved)
        remainder = distance(osc, duration, step - defect)
        if (solved .and. remainder < small) exit
      end do
      if (periods > min(options%most_periods, history%growth%periods)) then
        periods = 0
      else if (options%method == by_marching) then
        call run_periods(map, history%state(:, 0), periods, run)
        call judge(osc, duration, history%state(:, 0), run, closure_of(osc, duration, history%state(:, 0), run), periods, found)
        found%work = run%work
      else
        call shoot(map, options%tolerance, periods, history%state(:, periods) + step, found)
        if (has_result(found%status) .and. distance(osc, duration, found%state - history%state(:, 0)) > near) &
          found%status = status_transient
      end if
    end associate
  end subroutine try_to_end

  !> Shortens the period of a motion found over several periods if it repeats after fewer.
  pure subroutine shorten(map, tolerance, steady)
    type(period_map_t), intent(inout) :: map
    real(dp), intent(in) :: tolerance
    type(steady_t), intent(inout) :: steady
    real(dp) :: same
    type(steady_t) :: trial
    type(period_t) :: run
    integer :: periods

    ! Marching leaves an error of a thousandth of the tolerance in each of the periods.
    same = max(1e-7_dp, 1e-2_dp*tolerance)
    do periods = 1, steady%periods/2
      if (modulo(steady%periods, periods) /= 0) cycle
      call run_periods(map, steady%state, periods, run)
      steady%work = steady%work + run%work
      if (distance(map%osc, map%duration(1), run%state - steady%state) > same) cycle
      call shoot(map, tolerance, periods, steady%state, trial)
      if (has_result(trial%status)) call adopt(trial, steady)
      return
    end do
  end subroutine shorten
end module gearsweep_motion_transient
