!> What a designer reads off a sweep: the resonances, the worst dynamic factor
!> over the speeds, and the relief that makes it least.
module gearsweep_optimum
  use gearsweep_kinds, only: dp
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan, ieee_quiet_nan, ieee_value
  use gearsweep_convex_bounds, only: bound_curves, known_curve_t, may_be_largest
  use gearsweep_error, only: error_t
  use gearsweep_oscillator, only: oscillator_t
  use gearsweep_status, only: status_stopped
  use gearsweep_stop, only: wants_stop
  use gearsweep_sweep, only: contact_full, run_sweep, sweep_t
  use gearsweep_sweep_state, only: each, most_sweeps, progress_of_sweep, sweep_options_t, sweep_state_t
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
    !> Some speeds were tried and no more, as these show that the relief is not the best; (relief)
    logical, allocatable :: is_bound(:)
    integer :: best = 0                          !< index of the least; 0 where every one failed
    real(dp) :: resolution = 0                   !< the best lies within so much of the true optimum, m
    logical :: stopped = .false.                 !< the caller ended the search: the curve is not whole
  end type optimum_t

  integer, parameter :: scan = 16, inner = 6, rounds = most_sweeps - 1
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
    type(known_curve_t), allocatable :: known(:)
    real(dp) :: low, high
    integer :: round, i

    ! A dynamic factor to 1e-5 places the optimum far better than it can be made.
    rough = options
    rough%accuracy%steady%tolerance = max(options%accuracy%steady%tolerance, 1e-5_dp)
    allocate (optimum%amount(0), optimum%dynamic_factor(0), optimum%rpm(0), optimum%failed(0), optimum%is_bound(0), known(0))
    call add_reliefs([(largest*i/scan, i=0, scan)], 1)
    do round = 1, rounds
      if (allocated(error) .or. optimum%best == 0 .or. optimum%stopped) return
      low = optimum%amount(max(1, optimum%best - 1))
      high = optimum%amount(min(size(optimum%amount), optimum%best + 1))
      call keep_bracket(optimum, known)
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
      type(oscillator_t), allocatable :: motion(:), left(:)
      logical :: is_left(size(amount))
      integer :: i

      if (allocated(error)) return
      allocate (motion(size(amount)))
      do i = 1, size(amount)
        call build(context, amount(i), motion(i), error)
        if (allocated(error)) return
      end do
      call try_full_contact(motion, amount, rpm, rough, optimum, known, is_left, error)
      if (allocated(error) .or. optimum%stopped) return
      do i = 1, size(amount)
        if (is_left(i)) call try_some_speeds(motion(i:i), amount(i), rpm, rough, optimum, is_left(i), error)
        if (allocated(error) .or. optimum%stopped) return
      end do
      rough%done_before = rough%done_before + count(.not. is_left)*size(rpm)
      if (.not. any(is_left)) return
      allocate (left(count(is_left)))
      left(:) = motion(pack([(i, i=1, size(amount))], is_left))
      if (present(states)) then
        call try_all_speeds(left, pack(amount, is_left), rpm, rough, optimum, error, progress, states(number))
      else
        call try_all_speeds(left, pack(amount, is_left), rpm, rough, optimum, error, progress)
      end if
      rough%done_before = rough%done_before + size(left)*size(rpm)
    end subroutine add_reliefs
  end subroutine find_optimum

  !> The best relief and its neighbours are all that the next round takes from what is known.
  pure subroutine keep_bracket(optimum, known)
    type(optimum_t), intent(in) :: optimum
    type(known_curve_t), allocatable, intent(inout) :: known(:)  !< by place
    type(known_curve_t) :: three(3)
    integer :: i, k

    do i = 1, 3
      k = optimum%best + i - 2
      if (k < 1 .or. k > size(optimum%amount)) cycle
      three(i)%place = optimum%amount(k)
      k = findloc(abs(known%place - three(i)%place) <= 0, .true., 1)
      if (k > 0) three(i) = known(k)
    end do
    known = three
  end subroutine keep_bracket

  !> Reliefs with which all pairs stay in contact: one map serves all of them, and as their dynamic factors are convex in the
  !> amount, only those speeds are solved that may have the largest one.
  subroutine try_full_contact(motion, amount, rpm, options, optimum, known, is_left, error)
    type(oscillator_t), intent(in) :: motion(:)
    real(dp), intent(in) :: amount(:), rpm(:)
    type(sweep_options_t), intent(in) :: options
    type(optimum_t), intent(inout) :: optimum
    type(known_curve_t), allocatable, intent(inout) :: known(:)
    logical, intent(out) :: is_left(:)           !< of the other reliefs nothing is known yet; (relief)
    type(error_t), allocatable, intent(inout) :: error
    type(sweep_options_t) :: of_linear
    type(sweep_t) :: sweep
    type(known_curve_t) :: more(size(amount))
    logical :: needed(size(rpm))
    integer :: i

    needed = .true.
    if (size(known) == 3) call may_be_largest(known, amount, 2*options%accuracy%steady%tolerance, needed)
    of_linear = options
    of_linear%full_contact_only = .true.
    of_linear%accuracy%with_dte = .false.
    of_linear%is_counted = .false.
    call run_sweep(motion, pack(rpm, needed), of_linear, sweep, error)
    if (allocated(error)) return
    do i = 1, size(amount)
      call solve_missing(motion(i:i), sweep%rpm, options, sweep%dynamic_factor(:, i), error)
      if (allocated(error)) return
    end do
    optimum%stopped = wants_stop(options%accuracy%steady%stop)
    is_left = any(ieee_is_nan(sweep%dynamic_factor), 1)
    if (optimum%stopped) return
    do i = 1, size(amount)
      if (is_left(i)) cycle
      more(i)%place = amount(i)
      allocate (more(i)%lower(size(rpm)), more(i)%upper(size(rpm)), source=0.0_dp)
      if (.not. all(needed)) call bound_curves(known, amount(i), more(i)%lower, more(i)%upper)
      more(i)%lower = unpack(sweep%dynamic_factor(:, i), needed, more(i)%lower)
      more(i)%upper = unpack(sweep%dynamic_factor(:, i), needed, more(i)%upper)
      call insert(optimum, amount(i), worst_of(sweep%rpm, sweep%dynamic_factor(:, i)), 0, .false.)
    end do
    known = [known, more]
  end subroutine try_full_contact

  !> A few speeds at which it could not be told at once whether all pairs stay in contact, by themselves: they count where the
  !> pairs do at all of them.
  subroutine solve_missing(motion, rpm, options, dynamic_factor, error)
    type(oscillator_t), intent(in) :: motion(:)
    real(dp), intent(in) :: rpm(:)
    type(sweep_options_t), intent(in) :: options
    real(dp), intent(inout) :: dynamic_factor(:)     ! NaN where it is missing; (speed)
    type(error_t), allocatable, intent(inout) :: error
    integer, parameter :: most_share = 8
    type(sweep_options_t) :: alone
    type(sweep_t) :: sweep
    logical :: is_missing(size(rpm))

    is_missing = ieee_is_nan(dynamic_factor)
    if (.not. any(is_missing) .or. most_share*count(is_missing) > size(rpm)) return
    alone = options
    alone%direction = each
    alone%is_counted = .false.
    call run_sweep(motion, pack(rpm, is_missing), alone, sweep, error)
    if (allocated(error)) return
    if (all(sweep%contact == contact_full)) dynamic_factor = unpack(sweep%dynamic_factor(:, 1), is_missing, dynamic_factor)
  end subroutine solve_missing

  !> The speeds around that at which the nearest relief is worst: where they are worse than the best relief at its worst
  !> speed, this one is not the best.
  subroutine try_some_speeds(motion, amount, rpm, options, optimum, is_left, error)
    type(oscillator_t), intent(in) :: motion(1)
    real(dp), intent(in) :: amount, rpm(:)
    type(sweep_options_t), intent(in) :: options
    type(optimum_t), intent(inout) :: optimum
    logical, intent(out) :: is_left              !< the relief may still be the best
    type(error_t), allocatable, intent(inout) :: error
    integer, parameter :: some = 8
    type(sweep_options_t) :: alone
    type(sweep_t) :: sweep
    type(peak_t) :: worst
    integer :: nearest, first

    is_left = .true.
    if (optimum%best == 0 .or. size(rpm) <= some) return
    nearest = minloc(abs(optimum%amount - amount), 1, mask=optimum%rpm > 0)
    first = max(1, min(minloc(abs(rpm - optimum%rpm(nearest)), 1) - some/2, size(rpm) - some + 1))
    alone = options
    alone%direction = each
    alone%is_counted = .false.
    call run_sweep(motion, rpm(first:first + some - 1), alone, sweep, error)
    if (allocated(error)) return
    optimum%stopped = any(sweep%status == status_stopped)
    if (optimum%stopped) return
    worst = worst_of(sweep%rpm, sweep%dynamic_factor(:, 1))
    if (.not. worst%rpm > 0) return
    if (.not. worst%dynamic_factor > optimum%dynamic_factor(optimum%best) + &
             2*options%accuracy%steady%tolerance) return
    is_left = .false.
    call insert(optimum, amount, worst, count(ieee_is_nan(sweep%dynamic_factor)), .true.)
  end subroutine try_some_speeds

  !> Reliefs with which pairs part, at all speeds.
  subroutine try_all_speeds(motion, amount, rpm, options, optimum, error, progress, state)
    type(oscillator_t), intent(in) :: motion(:)
    real(dp), intent(in) :: amount(:), rpm(:)
    type(sweep_options_t), intent(in) :: options
    type(optimum_t), intent(inout) :: optimum
    type(error_t), allocatable, intent(inout) :: error
    procedure(progress_of_sweep), optional :: progress
    type(sweep_state_t), intent(inout), optional :: state
    type(sweep_t) :: sweep
    integer :: i

    call run_sweep(motion, rpm, options, sweep, error, progress, state)
    if (allocated(error)) return
    optimum%stopped = any(sweep%status == status_stopped)
    if (optimum%stopped) return
    do i = 1, size(amount)
      call insert(optimum, amount(i), worst_of(rpm, sweep%dynamic_factor(:, i)), &
                  count(ieee_is_nan(sweep%dynamic_factor(:, i))), .false.)
    end do
  end subroutine try_all_speeds

  !> Keeps the reliefs ascending; one that is there already is passed over.
  pure subroutine insert(optimum, amount, worst, failed, is_bound)
    type(optimum_t), intent(inout) :: optimum
    real(dp), intent(in) :: amount
    type(peak_t), intent(in) :: worst
    integer, intent(in) :: failed
    logical, intent(in) :: is_bound              !< not all speeds were tried that may be worst
    integer :: n

    n = count(optimum%amount < amount)
    if (any(abs(optimum%amount - amount) <= 1e-12_dp*amount)) return
    optimum%amount = [optimum%amount(:n), amount, optimum%amount(n + 1:)]
    optimum%dynamic_factor = [optimum%dynamic_factor(:n), worst%dynamic_factor, optimum%dynamic_factor(n + 1:)]
    optimum%rpm = [optimum%rpm(:n), worst%rpm, optimum%rpm(n + 1:)]
    optimum%failed = [optimum%failed(:n), failed, optimum%failed(n + 1:)]
    optimum%is_bound = [optimum%is_bound(:n), is_bound, optimum%is_bound(n + 1:)]
    optimum%best = minloc(optimum%dynamic_factor, 1, mask=optimum%rpm > 0 .and. .not. optimum%is_bound)
  end subroutine insert
end module gearsweep_optimum
