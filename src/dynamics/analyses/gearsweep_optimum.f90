!> What a designer reads off a sweep: the resonances, the worst dynamic factor
!> over the speeds, and the relief that makes it least.
module gearsweep_optimum
  use gearsweep_kinds, only: dp
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan, ieee_quiet_nan, ieee_value
  use gearsweep_error, only: error_t
  use gearsweep_oscillator, only: oscillator_t
  use gearsweep_status, only: status_stopped
  use gearsweep_sweep, only: sweep_t, sweep_options_t, sweep_state_t, run_sweep, progress_of_sweep
  implicit none
  private
  public :: peak_t, find_resonances, worst_of, optimum_t, find_optimum, build_motion

  type :: peak_t
    real(dp) :: rpm = 0                          !< speed of the pinion, 1/min
    real(dp) :: dynamic_factor = 0
  end type peak_t

  !> The curve of the worst dynamic factor over the relief (ascending), and its least.
  type :: optimum_t
    real(dp), allocatable :: amount(:)           !< of the relief, m; (relief)
    real(dp), allocatable :: dynamic_factor(:)   !< largest over the speeds; (relief)
    real(dp), allocatable :: rpm(:)              !< where that is, 1/min; (relief)
    integer, allocatable :: failed(:)            !< speeds without a result; (relief)
    integer :: best = 0                          !< index of the least; 0 where every one failed
    real(dp) :: resolution = 0                   !< the best lies within so much of the true optimum, m
    logical :: stopped = .false.                 !< the caller ended the search: the curve is not whole
  end type optimum_t

  integer, parameter :: scan = 16, inner = 6, rounds = 4
  !> Sweeps of one search.
  integer, parameter, public :: most_sweeps = 1 + rounds
  !> No more reliefs than these are tried.
  integer, parameter, public :: most_tried = 1 + scan + rounds*inner

  abstract interface
    !> Builds the oscillator for one relief (m) from what the caller of
    !> `find_optimum` handed over. A module procedure with this `context`, not an
    !> internal one: those would make the stack of all who link executable.
    subroutine build_motion(context, amount, motion, error)
      import :: dp, oscillator_t, error_t
      class(*), intent(in) :: context
      real(dp), intent(in) :: amount
      type(oscillator_t), intent(out) :: motion
      type(error_t), allocatable, intent(out) :: error
    end subroutine build_motion
  end interface

contains

  !> Maxima of a curve that stand out by at least 0.01 on both sides, at most
  !> five of the largest, by speed; a parabola through three points refines each.
  pure function find_resonances(rpm, dynamic_factor) result(peaks)
    real(dp), intent(in) :: rpm(:)               !< speeds of the pinion, ascending, 1/min
    real(dp), intent(in) :: dynamic_factor(:)    !< at each; NaN where there is none
    type(peak_t), allocatable :: peaks(:)
    real(dp), parameter :: prominence = 0.01_dp
    integer, parameter :: most = 5
    real(dp) :: left, right
    integer :: i, lowest

    allocate (peaks(0))
    do i = 2, size(rpm) - 1
      if (any(ieee_is_nan(dynamic_factor(i - 1:i + 1)))) cycle
      if (.not. (dynamic_factor(i) > dynamic_factor(i - 1) .and. dynamic_factor(i) >= dynamic_factor(i + 1))) cycle
      ! In two statements: in one, gfortran with -O1 or more makes one call of both (-ffrontend-optimize), as
      ! it takes sections for equal that have an end in common and run in opposite directions.
      left = fall(dynamic_factor(i:1:-1))
      right = fall(dynamic_factor(i:))
      if (min(left, right) < prominence) cycle
      peaks = [peaks, vertex(rpm(i - 1:i + 1), dynamic_factor(i - 1:i + 1))]
    end do
    do while (size(peaks) > most)
      lowest = minloc(peaks%dynamic_factor, 1)
      peaks = [peaks(:lowest - 1), peaks(lowest + 1:)]
    end do
  end function find_resonances

  !> How far the curve falls from its first value before it exceeds it or ends.
  pure real(dp) function fall(curve)
    real(dp), intent(in) :: curve(:)
    integer :: i

    fall = 0
    do i = 2, size(curve)
      if (ieee_is_nan(curve(i))) cycle
      if (curve(i) > curve(1)) exit
      fall = max(fall, curve(1) - curve(i))
    end do
  end function fall

  !> Of the parabola through three points at any distances, by Newton's divided differences: it has `slope` at
  !> the middle one.
  pure type(peak_t) function vertex(x, y)
    real(dp), intent(in) :: x(3), y(3)
    real(dp) :: left, right, slope, shift

    left = (y(2) - y(1))/(x(2) - x(1))
    right = (y(3) - y(2))/(x(3) - x(2))
    slope = (left*(x(3) - x(2)) + right*(x(2) - x(1)))/(x(3) - x(1))
    shift = 0
    if (right < left) shift = slope*(x(3) - x(1))/2/(left - right)
    vertex%rpm = x(2) + shift
    vertex%dynamic_factor = y(2) + slope*shift/2
  end function vertex

  !> Largest dynamic factor of a curve and its speed; NaN is passed over, and
  !> comes back with speed 0 where there is nothing else.
  pure type(peak_t) function worst_of(rpm, dynamic_factor)
    real(dp), intent(in) :: rpm(:)               !< speeds of the pinion, 1/min
    real(dp), intent(in) :: dynamic_factor(:)    !< at each
    integer :: i

    worst_of = peak_t(0, -1)
    do i = 1, size(rpm)
      if (ieee_is_nan(dynamic_factor(i))) cycle
      if (dynamic_factor(i) > worst_of%dynamic_factor) worst_of = peak_t(rpm(i), dynamic_factor(i))
    end do
    if (worst_of%rpm <= 0) worst_of%dynamic_factor = ieee_value(1.0_dp, ieee_quiet_nan)
  end function worst_of

  !> The relief whose worst dynamic factor over the speeds is least: a scan, then ever finer scans around the best one,
  !> which ask nothing of the curve's smoothness.
  subroutine find_optimum(build, context, largest, rpm, options, optimum, error, progress, states)
    procedure(build_motion) :: build                       !< makes the oscillator of a relief
    class(*), intent(in) :: context                        !< for `build`
    real(dp), intent(in) :: largest                        !< reliefs from 0 to this are searched, m
    real(dp), intent(in) :: rpm(:)                         !< speeds of the pinion, ascending, 1/min
    type(sweep_options_t), intent(in) :: options
    type(optimum_t), intent(out) :: optimum
    type(error_t), allocatable, intent(out) :: error
    procedure(progress_of_sweep), optional :: progress
    !> One for each sweep: with them, another call goes on from where this one was ended.
    type(sweep_state_t), intent(inout), optional :: states(most_sweeps)
    type(sweep_options_t) :: rough
    real(dp) :: low, high
    integer :: round, i

    ! A dynamic factor to 1e-5 places the optimum far better than it can be made.
    rough = options
    rough%accuracy%steady%tolerance = max(options%accuracy%steady%tolerance, 1e-5_dp)
    allocate (optimum%amount(0), optimum%dynamic_factor(0), optimum%rpm(0), optimum%failed(0))
    call add_reliefs([(largest*i/scan, i=0, scan)], 1)
    do round = 1, rounds
      if (allocated(error) .or. optimum%best == 0 .or. optimum%stopped) return
      low = optimum%amount(max(1, optimum%best - 1))
      high = optimum%amount(min(size(optimum%amount), optimum%best + 1))
      call add_reliefs([(low + (high - low)*i/(inner + 1.0_dp), i=1, inner)], 1 + round)
    end do
    associate (amount => optimum%amount, best => optimum%best)
      if (best > 0) optimum%resolution = max(amount(best) - amount(max(1, best - 1)), &
                                             amount(min(size(amount), best + 1)) - amount(best))
    end associate

  contains

    subroutine add_reliefs(amount, number)
      real(dp), intent(in) :: amount(:)
      integer, intent(in) :: number              ! of the sweep
      type(oscillator_t), allocatable :: motion(:)
      type(sweep_t) :: sweep
      type(peak_t) :: worst
      integer :: i

      if (allocated(error)) return
      allocate (motion(size(amount)))
      do i = 1, size(amount)
        call build(context, amount(i), motion(i), error)
        if (allocated(error)) return
      end do
      if (present(states)) then
        call run_sweep(motion, rpm, rough, sweep, error, progress, states(number))
      else
        call run_sweep(motion, rpm, rough, sweep, error, progress)
      end if
      if (allocated(error)) return
      rough%done_before = rough%done_before + size(sweep%status)
      optimum%stopped = any(sweep%status == status_stopped)
      if (optimum%stopped) return
      do i = 1, size(amount)
        worst = worst_of(rpm, sweep%dynamic_factor(:, i))
        call insert(optimum, amount(i), worst, count(ieee_is_nan(sweep%dynamic_factor(:, i))))
      end do
      optimum%best = minloc(optimum%dynamic_factor, 1, mask=optimum%rpm > 0)
    end subroutine add_reliefs
  end subroutine find_optimum

  !> Keeps the reliefs ascending; one that is there already is passed over.
  pure subroutine insert(optimum, amount, worst, failed)
    type(optimum_t), intent(inout) :: optimum
    real(dp), intent(in) :: amount
    type(peak_t), intent(in) :: worst
    integer, intent(in) :: failed
    integer :: n

    n = count(optimum%amount < amount)
    if (any(abs(optimum%amount - amount) <= 1e-12_dp*amount)) return
    optimum%amount = [optimum%amount(:n), amount, optimum%amount(n + 1:)]
    optimum%dynamic_factor = [optimum%dynamic_factor(:n), worst%dynamic_factor, optimum%dynamic_factor(n + 1:)]
    optimum%rpm = [optimum%rpm(:n), worst%rpm, optimum%rpm(n + 1:)]
    optimum%failed = [optimum%failed(:n), failed, optimum%failed(n + 1:)]
  end subroutine insert
end module gearsweep_optimum
