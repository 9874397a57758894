!> A periodic motion that is known, and whether another motion comes to it: by the map of its disturbances over all its
!> mesh periods, d -> M d, and the Lyapunov function d'Qd of that map, Q = sum of (M^k)' M^k over all k, which each return
!> lowers by d'd.
module gearsweep_known_motion
  use gearsweep_contact_set, only: period_t
  use gearsweep_kinds, only: dp
  use gearsweep_oscillator, only: oscillator_t
  use gearsweep_period, only: run_period
  use gearsweep_period_map, only: period_map_t
  use gearsweep_periodic_orbit, only: closure_of, judge, run_periods, steady_t
  use gearsweep_status, only: has_result
  implicit none
  private
  public :: known_t, make_known, are_same, scale_of, find_nearest, approach_t, begin_approach, go_on

  type :: known_t
    type(steady_t) :: steady                     !< at the first of its states
    logical :: attracts = .false.
    real(dp), allocatable :: state(:, :)         !< once a mesh period, x and y, m; (2, period)
    ! Of disturbances in static deflections, as `scale_of` makes them:
    real(dp), allocatable :: map(:, :, :)        !< M from each state to itself; (2, 2, period)
    real(dp), allocatable :: form(:, :, :)       !< Q of that; (2, 2, period)
  end type known_t

  !> A motion near a known one, and how it has come nearer.
  type :: approach_t
    integer :: motion = 0                        !< which known one; 0: none
    integer :: state = 0                         !< which of its states the first disturbance is of
    integer :: periods = 0                       !< mesh periods since then
    real(dp) :: first = 0                        !< Lyapunov function at first
    real(dp) :: expected(2) = 0                  !< what the linear map makes of the first disturbance
  end type approach_t

  !> States this close are the same, in static deflections.
  real(dp), parameter :: same = 1e-5_dp

contains

  !> What divides a difference of states (m) to have it in static deflections, as in `distance`.
  pure function scale_of(osc, duration) result(scale)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration             !< of the mesh period, s
    real(dp) :: scale(2)

    scale = osc%static_deflection*[1.0_dp, max(1.0_dp, osc%natural_frequency*duration)]
  end function scale_of

  !> The motion that Newton's method found, once a mesh period. If it repeats after fewer of them, these are its periods.
  pure subroutine make_known(map, steady, known)
    type(period_map_t), intent(inout) :: map     !< with the duration of one speed
    type(steady_t), intent(in) :: steady         !< periodic, attracting or not
    type(known_t), intent(out) :: known
    type(period_t) :: run
    real(dp) :: state(2, steady%periods), each(2, 2, steady%periods), scale(2)
    integer :: periods, i, k

    scale = scale_of(map%osc, map%duration(1))
    state(:, 1) = steady%state
    do periods = 1, steady%periods
      call run_period(map, state(:, periods), run)
      each(:, :, periods) = in_scale(run%monodromy, scale)
      if (all(abs(run%state - steady%state) < same*scale)) exit
      if (periods < steady%periods) state(:, periods + 1) = run%state
    end do
    periods = min(periods, steady%periods)
    known%steady = steady
    if (periods < steady%periods) then
      call run_periods(map, steady%state, periods, run)
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

  !> A derivative of the state by the state, for disturbances in static deflections.
  pure function in_scale(monodromy, scale) result(scaled)
    real(dp), intent(in) :: monodromy(2, 2), scale(2)
    real(dp) :: scaled(2, 2)

    scaled = monodromy
    scaled(1, 2) = monodromy(1, 2)*scale(2)/scale(1)
    scaled(2, 1) = monodromy(2, 1)*scale(1)/scale(2)
  end function in_scale

  !> The sum of (M^k)' M^k, twice as many terms at a time; of a map that does not contract, many terms.
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

  !> Are these one motion, wherever in its period it begins?
  pure logical function are_same(a, b, scale)
    type(known_t), intent(in) :: a, b
    real(dp), intent(in) :: scale(2)             !< of `scale_of`
    integer :: i

    are_same = .false.
    if (size(a%state, 2) /= size(b%state, 2)) return
    do i = 1, size(a%state, 2)
      are_same = all(abs(a%state(:, i) - b%state(:, 1)) < same*scale)
      if (are_same) return
    end do
  end function are_same

  !> The known motion, attracting or not, that a state is nearest to, and which of its states; 0 if none is known.
  pure subroutine find_nearest(known, state, scale, motion, which, difference)
    type(known_t), intent(in) :: known(:)
    real(dp), intent(in) :: state(2)             !< m
    real(dp), intent(in) :: scale(2)             !< of `scale_of`
    integer, intent(out) :: motion, which
    real(dp), intent(out) :: difference(2)       !< from that state, in static deflections
    real(dp) :: d(2)
    integer :: i, k

    motion = 0
    which = 0
    difference = huge(1.0_dp)
    do k = 1, size(known)
      do i = 1, size(known(k)%state, 2)
        d = (state - known(k)%state(:, i))/scale
        if (maxval(abs(d)) >= maxval(abs(difference))) cycle
        motion = k
        which = i
        difference = d
      end do
    end do
  end subroutine find_nearest

  !> A motion is near a known one from now on.
  pure subroutine begin_approach(known, motion, which, difference, approach)
    type(known_t), intent(in) :: known(:)
    integer, intent(in) :: motion, which         !< of these, and of its states
    real(dp), intent(in) :: difference(2)        !< from that state, in static deflections
    type(approach_t), intent(out) :: approach

    approach = approach_t(motion, which, 0, dot_product(difference, matmul(known(motion)%form(:, :, which), difference)), &
                          difference)
  end subroutine begin_approach

  !> One mesh period later. Captured is a motion whose Lyapunov function has fallen, over as many returns as it takes to show,
  !> by at least half of what the linear map says, or that is the known one.
  pure subroutine go_on(known, state, scale, approach, captured)
    type(known_t), intent(in) :: known(:)
    real(dp), intent(in) :: state(2)             !< now, m
    real(dp), intent(in) :: scale(2)             !< of `scale_of`
    type(approach_t), intent(inout) :: approach  !< motion 0: it has not come nearer
    logical, intent(out) :: captured
    real(dp), parameter :: clear = 0.72_dp, farthest = 1.0_dp
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
      captured = maxval(abs(d)) < farthest .and. now <= (approach%first + expected)/2
    end associate
    if (.not. captured) approach%motion = 0
  end subroutine go_on
end module gearsweep_known_motion
