!> Periodic motions known at one speed, and whether one of them has captured another motion.
!>
!> Capture is decided by the known motion's map of disturbances over all its mesh periods, d -> M d, and by the Lyapunov function
!> d'Qd of that map, Q = sum of (M^k)' M^k over all k, which each return lowers by d'd.
module gearsweep_motion_known_motions
  use gearsweep_base, only: dp
  use gearsweep_motion_contact_set, only: period_t
  use gearsweep_motion_oscillator, only: oscillator_t
  use gearsweep_motion_period, only: run_period
  use gearsweep_motion_period_map, only: period_map_t
  use gearsweep_motion_periodic_orbit, only: closure_of, judge, run_periods
  use gearsweep_motion_steady_motion, only: has_result, status_unstable, steady_t
  implicit none
  private
  public :: known_t, approach_t, scale_of, add_known, find_nearest, find_nearest_state, watch_approach

  type :: known_t
    type(steady_t) :: steady                     !< steady motion, from the first of its states
    logical :: attracts = .false.
    real(dp), allocatable :: state(:, :)         !< once a mesh period, x and y, m; (2, period)
    ! For disturbances in static deflections (`scale_of`):
    real(dp), allocatable :: map(:, :, :)        !< M from each state to itself; (2, 2, period)
    real(dp), allocatable :: form(:, :, :)       !< Q of that map; (2, 2, period)
  end type known_t

  !> Approach of a motion to a known one.
  type :: approach_t
    integer :: motion = 0                        !< index of the known motion; 0: none
    integer :: state = 0                         !< index of that motion's state at the first disturbance
    integer :: periods = 0                       !< mesh periods since then
    real(dp) :: first = 0                        !< Lyapunov function at the start
    real(dp) :: expected(2) = 0                  !< first disturbance after the linear map so far
  end type approach_t

  !> Distance below which states count as the same, in static deflections.
  real(dp), parameter :: same = 1e-5_dp

  !> Number of known motions from which on repelling ones are no longer added: a chaotic motion passes infinitely many of them.
  integer, parameter :: most_known = 100

contains

  !> Divisors of a difference of states (m) that convert it to static deflections, as in `distance`.
  pure function scale_of(osc, duration) result(scale)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration             !< duration of the mesh period, s
    real(dp) :: scale(2)

    scale = osc%static_deflection*[1.0_dp, max(1.0_dp, osc%natural_frequency*duration)]
  end function scale_of

  !> Computes the states and maps of a motion found by Newton's method, once a mesh period. If it repeats after fewer mesh
  !> periods, only these are stored.
  pure subroutine make_known(map, steady, known)
    type(period_map_t), intent(inout) :: map     !< map with the duration of one speed
    type(steady_t), intent(in) :: steady         !< periodic, attracting or not
    type(known_t), intent(out) :: known
    type(period_t) :: run
    real(dp) :: state(2, steady%periods), each(2, 2, steady%periods), scale(2)
    integer :: periods, i, k

    scale = scale_of(map%osc, map%duration(1))
    state(:, 1) = steady%state
    do periods = 1, steady%periods
      call run_period(map, state(:, periods), run, peaks=.false.)
      each(:, :, periods) = in_scale(run%monodromy, scale)
      if (all(abs(run%state - steady%state) < same*scale)) exit
      if (periods < steady%periods) state(:, periods + 1) = run%state
    end do
    periods = min(periods, steady%periods)
    known%steady = steady
    if (periods < steady%periods) then
      call run_periods(map, steady%state, periods, .true., run)
      call judge(map%osc, map%duration(1), steady%state, run, closure_of(map%osc, map%duration(1), steady%state, run), periods, &
                 known%steady)
    end if
    known%attracts = has_result(known%steady%status)
    known%state = state(:, :periods)
    allocate (known%map(2, 2, periods), known%form(2, 2, periods))
    do i = 1, periods
      known%map(:, :, i) = each(:, :, i)
      do k = i + 1, i + periods - 1
        known%map(:, :, i) = matmul(each(:, :, modulo(k - 1, periods) + 1), known%map(:, :, i))
      end do
      known%form(:, :, i) = lyapunov_form(known%map(:, :, i))
    end do
  end subroutine make_known

  !> Converts a derivative of the state by the state to disturbances in static deflections.
  pure function in_scale(monodromy, scale) result(scaled)
    real(dp), intent(in) :: monodromy(2, 2), scale(2)
    real(dp) :: scaled(2, 2)

    scaled = monodromy
    scaled(1, 2) = monodromy(1, 2)*scale(2)/scale(1)
    scaled(2, 1) = monodromy(2, 1)*scale(1)/scale(2)
  end function in_scale

  !> Sum of (M^k)' M^k, doubling the number of terms each time; of a map that does not contract, many terms.
  pure function lyapunov_form(map) result(form)
    real(dp), intent(in) :: map(2, 2)
    integer, parameter :: most_doublings = 30
    real(dp) :: form(2, 2), power(2, 2)
    integer :: i

    form = reshape([1.0_dp, 0.0_dp, 0.0_dp, 1.0_dp], [2, 2])
    power = map
    do i = 1, most_doublings
      if (maxval(abs(power)) < 1e-12_dp .or. maxval(abs(power)) > 1e12_dp) exit
      form = form + matmul(transpose(power), matmul(form, power))
      power = matmul(power, power)
    end do
  end function lyapunov_form

  !> True if these are one motion, for any state at the start of its period.
  pure logical function are_same(a, b, scale)
    type(known_t), intent(in) :: a, b
    real(dp), intent(in) :: scale(2)             !< result of `scale_of`
    real(dp) :: difference(2)
    integer :: i

    are_same = size(a%state, 2) == size(b%state, 2)
    if (.not. are_same) return
    call find_nearest_state(a, b%state(:, 1), scale, i, difference)
    are_same = maxval(abs(difference)) < same
  end function are_same

  !> Finds the known motion, attracting or not, that is nearest to a state, and the index of its nearest state; 0 if none is
  !> known.
  pure subroutine find_nearest(known, state, scale, motion, which, difference)
    type(known_t), intent(in) :: known(:)
    real(dp), intent(in) :: state(2)             !< m
    real(dp), intent(in) :: scale(2)             !< result of `scale_of`
    integer, intent(out) :: motion, which
    real(dp), intent(out) :: difference(2)       !< state minus that state, in static deflections
    real(dp) :: d(2)
    integer :: i, k

    motion = 0
    which = 0
    difference = huge(1.0_dp)
    do k = 1, size(known)
      call find_nearest_state(known(k), state, scale, i, d)
      if (maxval(abs(d)) >= maxval(abs(difference))) cycle
      motion = k
      which = i
      difference = d
    end do
  end subroutine find_nearest

  !> Finds the state of a known motion that is nearest to a state.
  pure subroutine find_nearest_state(known, state, scale, which, difference)
    type(known_t), intent(in) :: known
    real(dp), intent(in) :: state(2)             !< m
    real(dp), intent(in) :: scale(2)             !< result of `scale_of`
    integer, intent(out) :: which                !< index of the nearest state
    real(dp), intent(out) :: difference(2)       !< state minus that state, in static deflections
    real(dp) :: d(2)
    integer :: i

    which = 1
    difference = (state - known%state(:, 1))/scale
    do i = 2, size(known%state, 2)
      d = (state - known%state(:, i))/scale
      if (maxval(abs(d)) >= maxval(abs(difference))) cycle
      which = i
      difference = d
    end do
  end subroutine find_nearest_state

  !> Observes a motion after one more mesh period: whether a known motion that attracts has captured it.
  pure subroutine watch_approach(known, state, scale, approach, motion)
    type(known_t), intent(in) :: known(:)
    real(dp), intent(in) :: state(2)             !< present state, m
    real(dp), intent(in) :: scale(2)             !< result of `scale_of`
    type(approach_t), intent(inout) :: approach
    integer, intent(out) :: motion               !< index of the motion that captured it; 0: none so far
    real(dp), parameter :: reach = 0.5_dp        ! static deflections, within which a motion may be approaching a known one
    real(dp) :: difference(2)
    integer :: nearest, which
    logical :: captured

    motion = 0
    if (approach%motion > 0) then
      nearest = approach%motion
      call go_on(known, state, scale, approach, captured)
      if (captured) motion = nearest
      if (approach%motion > 0) return
    end if
    call find_nearest(known, state, scale, nearest, which, difference)
    if (nearest == 0 .or. maxval(abs(difference)) > reach) return
    if (.not. known(nearest)%attracts) return
    if (maxval(abs(difference)) < same) then
      motion = nearest
    else
      approach = approach_t(nearest, which, 0, &
                            dot_product(difference, matmul(known(nearest)%form(:, :, which), difference)), difference)
    end if
  end subroutine watch_approach

  !> Continues an approach by one mesh period. A motion is captured if it equals the known one, or if its Lyapunov function has
  !> fallen to a third at least over the returns in which the linear map's falls to a tenth.
  pure subroutine go_on(known, state, scale, approach, captured)
    type(known_t), intent(in) :: known(:)
    real(dp), intent(in) :: state(2)             !< present state, m
    real(dp), intent(in) :: scale(2)             !< result of `scale_of`
    type(approach_t), intent(inout) :: approach  !< out: motion 0 if it has not come nearer
    logical, intent(out) :: captured
    real(dp), parameter :: clear = 0.1_dp, farthest = 1.0_dp
    integer, parameter :: most_returns = 200
    real(dp) :: d(2), now, expected

    captured = .false.
    approach%periods = approach%periods + 1
    associate (motion => known(approach%motion), i => approach%state)
      if (modulo(approach%periods, size(motion%state, 2)) /= 0) return
      d = (state - motion%state(:, i))/scale
      captured = maxval(abs(d)) < same
      if (captured) return
      approach%expected = matmul(motion%map(:, :, i), approach%expected)
      expected = dot_product(approach%expected, matmul(motion%form(:, :, i), approach%expected))
      if (expected > clear*approach%first .and. approach%periods < most_returns*size(motion%state, 2) .and. &
          maxval(abs(d)) < farthest) return
      now = dot_product(d, matmul(motion%form(:, :, i), d))
      captured = maxval(abs(d)) < farthest .and. now <= sqrt(approach%first*expected)
    end associate
    if (.not. captured) approach%motion = 0
  end subroutine go_on

  !> Adds a motion to the known ones unless it is among them.
  pure subroutine add_known(map, steady, known, which)
    type(period_map_t), intent(inout) :: map     !< map with the duration of one speed
    type(steady_t), intent(in) :: steady
    type(known_t), allocatable, intent(inout) :: known(:)
    integer, intent(out) :: which                !< index of the motion; 0: it is none, or not added
    type(known_t) :: new

    which = 0
    if (.not. has_result(steady%status) .and. (steady%status /= status_unstable .or. size(known) >= most_known)) return
    call make_known(map, steady, new)
    do which = 1, size(known)
      if (are_same(known(which), new, scale_of(map%osc, map%duration(1)))) return
    end do
    known = [known, new]
  end subroutine add_known
end module gearsweep_motion_known_motions
