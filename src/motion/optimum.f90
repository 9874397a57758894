!> Resonances, worst dynamic factor over the speeds, and the amount of relief that minimises it.
module gearsweep_motion_optimum
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan, ieee_quiet_nan, ieee_value
  use gearsweep_base, only: dp, error_t
  use gearsweep_motion_oscillator, only: oscillator_t
  use gearsweep_motion_steady_motion, only: status_stopped
  use gearsweep_motion_sweep, only: each, progress_of_sweep, run_sweep, sweep_options_t, sweep_t
  implicit none
  private
  public :: peak_t, find_resonances, worst_of, optimum_t, find_optimum

  type :: peak_t
    real(dp) :: rpm = 0                          !< speed of the pinion, 1/min
    real(dp) :: dynamic_factor = 0
  end type peak_t

  !> Curve of the worst dynamic factor over the relief (ascending), and its minimum.
  type :: optimum_t
    real(dp), allocatable :: amount(:)           !< amount of the relief, m; (relief)
    real(dp), allocatable :: dynamic_factor(:)   !< largest over the speeds; (relief)
    real(dp), allocatable :: rpm(:)              !< speed of that, 1/min; (relief)
    integer, allocatable :: failed(:)            !< speeds without a result; (relief)
    !> True if only some speeds were computed, as they show that the relief is not the best; (relief)
    logical, allocatable :: is_bound(:)
    logical, allocatable :: repeats(:)           !< true if the motions at all speeds tried repeat in each mesh period; (relief)
    integer :: best = 0                          !< index of the minimum; 0 if every relief failed
    real(dp) :: resolution = 0                   !< largest distance of the best from the true optimum, m
    logical :: stopped = .false.                 !< true: the caller stopped the search, the curve is incomplete
  end type optimum_t

  integer, parameter :: scan = 16, inner = 6, rounds = 4
  !> Reliefs of the scan swept at once.
  integer, parameter :: at_once = 4
  !> Largest number of reliefs tried.
  integer, parameter, public :: most_tried = 1 + scan + rounds*inner

  abstract interface
    !> Builds the oscillator for one relief (m) from the `context` that the caller of `find_optimum` passed. A module procedure
    !> with this `context`, not an internal one: that would make the stack of every program that links it executable.
    subroutine build_motion(context, amount, motion, error)
      import :: dp, oscillator_t, error_t
      class(*), intent(in) :: context
      real(dp), intent(in) :: amount
      type(oscillator_t), intent(out) :: motion
      type(error_t), allocatable, intent(out) :: error
    end subroutine build_motion
  end interface

contains

  !> Finds maxima of a curve that exceed its minima on both sides by at least 0.01, at most five of the largest, by speed; a
  !> parabola through three points refines each.
  pure function find_resonances(rpm, dynamic_factor) result(peaks)
    real(dp), intent(in) :: rpm(:)               !< speeds of the pinion, ascending, 1/min
    real(dp), intent(in) :: dynamic_factor(:)    !< dynamic factor at each speed; NaN if it has none
    type(peak_t), allocatable :: peaks(:)
    real(dp), parameter :: prominence = 0.01_dp
    integer, parameter :: most = 5
    real(dp) :: left, right
    integer :: i, lowest

    allocate (peaks(0))
    do i = 2, size(rpm) - 1
      if (any(ieee_is_nan(dynamic_factor(i - 1:i + 1)))) cycle
      if (.not. (dynamic_factor(i) > dynamic_factor(i - 1) .and. dynamic_factor(i) >= dynamic_factor(i + 1))) cycle
      ! Two statements: in one, gfortran with -O1 or more merges both calls (-ffrontend-optimize), as it treats sections as equal
      ! that have an end in common and run in opposite directions.
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

  !> Largest drop below the first value of a curve, up to the first point above that value.
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

  !> Vertex of the parabola through three points at any distances, by Newton's divided differences: it has `slope` at the middle
  !> one.
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

  !> Finds the largest dynamic factor of a curve and its speed. NaN is ignored; if all are NaN, returns NaN with speed 0.
  pure type(peak_t) function worst_of(rpm, dynamic_factor)
    real(dp), intent(in) :: rpm(:)               !< speeds of the pinion, 1/min
    real(dp), intent(in) :: dynamic_factor(:)    !< dynamic factor at each speed
    integer :: i

    worst_of = peak_t(0, -1)
    do i = 1, size(rpm)
      if (ieee_is_nan(dynamic_factor(i))) cycle
      if (dynamic_factor(i) > worst_of%dynamic_factor) worst_of = peak_t(rpm(i), dynamic_factor(i))
    end do
    if (worst_of%rpm <= 0) worst_of%dynamic_factor = ieee_value(1.0_dp, ieee_quiet_nan)
  end function worst_of

  !> Finds the relief whose worst dynamic factor over the speeds is least: a scan, then finer and finer scans around the best one,
  !> which do not need a smooth curve. Motions that do not repeat in each mesh period are expensive to find: from the first relief
  !> with one on, the scan drops a relief at the first speed that rules it out.
  subroutine find_optimum(build, context, largest, rpm, options, optimum, error, progress)
    procedure(build_motion) :: build                       !< builds the oscillator of a relief
    class(*), intent(in) :: context                        !< passed to `build`
    real(dp), intent(in) :: largest                        !< upper end of the search from 0, m
    real(dp), intent(in) :: rpm(:)                         !< speeds of the pinion, ascending, 1/min
    type(sweep_options_t), intent(in) :: options
    type(optimum_t), intent(out) :: optimum
    type(error_t), allocatable, intent(out) :: error
    procedure(progress_of_sweep), optional :: progress
    type(sweep_options_t) :: rough
    real(dp) :: low, high
    integer :: round, i

    ! A dynamic factor to 1e-5 locates the optimum far more exactly than it can be made.
    rough = options
    rough%accuracy%steady%tolerance = max(options%accuracy%steady%tolerance, 1e-5_dp)
    allocate (optimum%amount(0), optimum%dynamic_factor(0), optimum%rpm(0), optimum%failed(0), optimum%is_bound(0), &
              optimum%repeats(0))
    do round = 0, scan/at_once - 1
      call add_reliefs([(largest*i/scan, i=at_once*round + min(round, 1), at_once*(round + 1))], in_scan=.true.)
      if (allocated(error) .or. optimum%stopped) return
    end do
    do round = 1, rounds
      if (allocated(error) .or. optimum%best == 0 .or. optimum%stopped) return
      low = optimum%amount(max(1, optimum%best - 1))
      high = optimum%amount(min(size(optimum%amount), optimum%best + 1))
      call add_reliefs([(low + (high - low)*i/(inner + 1.0_dp), i=1, inner)], in_scan=.false.)
    end do
    associate (amount => optimum%amount, best => optimum%best)
      if (best > 0) optimum%resolution = max(amount(best) - amount(max(1, best - 1)), &
                                             amount(min(size(amount), best + 1)) - amount(best))
    end associate

  contains

    subroutine add_reliefs(amount, in_scan)
      real(dp), intent(in) :: amount(:)
      logical, intent(in) :: in_scan
      type(oscillator_t), allocatable :: motion(:), remaining(:)
      logical :: may_be_best(size(amount))
      integer :: i

      if (allocated(error)) return
      allocate (motion(size(amount)))
      do i = 1, size(amount)
        call build(context, amount(i), motion(i), error)
        if (allocated(error)) return
      end do
      do i = 1, size(amount)
        may_be_best(i) = .true.
        if (in_scan .and. all(optimum%repeats)) cycle
        call try_some_speeds(motion(i:i), amount(i), rpm, rough, optimum, may_be_best(i), error)
        if (allocated(error) .or. optimum%stopped) return
      end do
      rough%done_before = rough%done_before + count(.not. may_be_best)*size(rpm)
      if (.not. any(may_be_best)) return
      allocate (remaining(count(may_be_best)))
      remaining(:) = motion(pack([(i, i=1, size(amount))], may_be_best))
      call try_all_speeds(remaining, pack(amount, may_be_best), rpm, rough, optimum, error, progress)
      rough%done_before = rough%done_before + size(remaining)*size(rpm)
    end subroutine add_reliefs
  end subroutine find_optimum

  !> Tries the speeds around the worst one of the nearest relief: if they are worse than the best relief at its worst speed, this
  !> relief is not the best. Where a motion of the nearest relief does not repeat, tries the worst speed alone first.
  subroutine try_some_speeds(motion, amount, rpm, options, optimum, may_be_best, error)
    type(oscillator_t), intent(in) :: motion(1)
    real(dp), intent(in) :: amount, rpm(:)
    type(sweep_options_t), intent(in) :: options
    type(optimum_t), intent(inout) :: optimum
    logical, intent(out) :: may_be_best          !< true: the relief may still be the best
    type(error_t), allocatable, intent(inout) :: error
    integer, parameter :: some = 8
    type(sweep_options_t) :: alone
    type(sweep_t) :: sweep
    type(peak_t) :: worst
    integer :: nearest, worst_speed, first, last, try

    may_be_best = .true.
    if (optimum%best == 0 .or. size(rpm) <= some) return
    nearest = minloc(abs(optimum%amount - amount), 1, mask=optimum%rpm > 0)
    worst_speed = minloc(abs(rpm - optimum%rpm(nearest)), 1)
    alone = options
    alone%direction = each
    alone%is_counted = .false.
    do try = merge(2, 1, optimum%repeats(nearest)), 2
      first = merge(worst_speed, max(1, min(worst_speed - some/2, size(rpm) - some + 1)), try == 1)
      last = merge(worst_speed, first + some - 1, try == 1)
      call run_sweep(motion, rpm(first:last), alone, sweep, error)
      if (allocated(error)) return
      optimum%stopped = any(sweep%status == status_stopped)
      if (optimum%stopped) return
      worst = worst_of(sweep%rpm, sweep%dynamic_factor(:, 1))
      may_be_best = .not. (worst%rpm > 0 .and. worst%dynamic_factor > optimum%dynamic_factor(optimum%best) + &
                       2*options%accuracy%steady%tolerance)
      if (may_be_best) cycle
      call insert(optimum, amount, worst, sweep, 1, is_bound=.true.)
      return
    end do
  end subroutine try_some_speeds

  !> Sweeps all speeds for some reliefs.
  subroutine try_all_speeds(motion, amount, rpm, options, optimum, error, progress)
    type(oscillator_t), intent(in) :: motion(:)
    real(dp), intent(in) :: amount(:), rpm(:)
    type(sweep_options_t), intent(in) :: options
    type(optimum_t), intent(inout) :: optimum
    type(error_t), allocatable, intent(inout) :: error
    procedure(progress_of_sweep), optional :: progress
    type(sweep_t) :: sweep
    integer :: i

    call run_sweep(motion, rpm, options, sweep, error, progress)
    if (allocated(error)) return
    optimum%stopped = any(sweep%status == status_stopped)
    if (optimum%stopped) return
    do i = 1, size(amount)
      call insert(optimum, amount(i), worst_of(rpm, sweep%dynamic_factor(:, i)), sweep, i, is_bound=.false.)
    end do
  end subroutine try_all_speeds

  !> Inserts a relief, keeping them ascending; one that exists already is ignored.
  pure subroutine insert(optimum, amount, worst, sweep, relief, is_bound)
    type(optimum_t), intent(inout) :: optimum
    real(dp), intent(in) :: amount
    type(peak_t), intent(in) :: worst
    type(sweep_t), intent(in) :: sweep
    integer, intent(in) :: relief                !< index of the relief in the sweep
    logical, intent(in) :: is_bound              !< some speeds that may be worst were not tried
    integer :: n

    n = count(optimum%amount < amount)
    if (any(abs(optimum%amount - amount) <= 1e-12_dp*amount)) return
    optimum%amount = [optimum%amount(:n), amount, optimum%amount(n + 1:)]
    optimum%dynamic_factor = [optimum%dynamic_factor(:n), worst%dynamic_factor, optimum%dynamic_factor(n + 1:)]
    optimum%rpm = [optimum%rpm(:n), worst%rpm, optimum%rpm(n + 1:)]
    optimum%failed = [optimum%failed(:n), count(ieee_is_nan(sweep%dynamic_factor(:, relief))), optimum%failed(n + 1:)]
    optimum%repeats = [optimum%repeats(:n), all(sweep%periods(:, relief) <= 1 .and. sweep%seen_periods(:, relief) == 0), &
                       optimum%repeats(n + 1:)]
    optimum%is_bound = [optimum%is_bound(:n), is_bound, optimum%is_bound(n + 1:)]
    optimum%best = minloc(optimum%dynamic_factor, 1, mask=optimum%rpm > 0 .and. .not. optimum%is_bound)
  end subroutine insert
end module gearsweep_motion_optimum
