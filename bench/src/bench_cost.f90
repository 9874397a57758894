!> What a sweep costs over its number of speeds and over the damping. Every setting takes its turn in every
!> round, but for those that are slow; medians.
module bench_cost
  use bench_problem, only: problem_t
  use bench_tools, only: check, median, numbers, seconds
  use gearsweep, only: dp, error_t, make_oscillator, oscillator_t, run_sweep, sweep_t, sweep_options_t
  use gearsweep_motion_coefficients, only: coefficients_t, tabulate
  use gearsweep_motion_resolution, only: resolution_t
  use gearsweep_motion_sweep, only: contact_full, each
  use gearsweep_motion_steady_motion, only: by_marching, by_shooting
  use gearsweep_motion_steady_motion, only: has_result
  implicit none
  private
  public :: cost_over_speeds, cost_over_damping, table_time

  integer, parameter :: rounds = 11
  real(dp), parameter :: slow = 0.2_dp           !< s: once is enough
  !> Kinds of points: all pairs always in contact; contact that changes in a motion that repeats with the
  !> mesh; motions that repeat later or never.
  integer, parameter :: full = 1, changing = 2, other = 3
  integer, parameter :: share = 8                !< every so many points are marched

  !> A damping ratio, and the seconds taken under it.
  type :: setting_t
    type(oscillator_t), allocatable :: osc(:)
    integer, allocatable :: kind(:, :)           !< of each point (speeds, reliefs)
    real(dp) :: steps = 0                        !< mean, of the points in full contact
    real(dp) :: taken(rounds, 5) = 0             !< in each round, of each thing that is timed
    integer :: times(5) = 0
    integer :: marched(2) = 0                    !< points, and how many without an answer
  end type setting_t

contains

  !> For each count a line: speeds in the problem's range, seconds for all reliefs, for those in full contact,
  !> how many these are; seconds that the tables of all take, mean steps of a point.
  subroutine cost_over_speeds(problem, wanted, counts)
    type(problem_t), intent(in) :: problem
    real(dp), intent(in) :: wanted
    integer, intent(in) :: counts(:)
    type(sweep_t) :: sweep
    type(oscillator_t), allocatable :: held(:)
    real(dp) :: taken(rounds, 2, size(counts)), tables(size(counts)), steps(size(counts))
    integer :: k, i, n

    call solve(problem%osc, problem%rpm, problem%case%direction, by_shooting, wanted, sweep, taken(1, 1, 1))
    held = pack(problem%osc, all(sweep%contact == contact_full, 1))
    do i = 1, rounds
      do k = 1, size(counts)
        call solve(problem%osc, spread_out(counts(k)), problem%case%direction, by_shooting, wanted, sweep, taken(i, 1, k))
        if (i == 1) tables(k) = table_time(problem%osc, sweep%steps)
        steps(k) = sum(sweep%steps)/real(size(sweep%steps), dp)
        call solve(held, spread_out(counts(k)), problem%case%direction, by_shooting, wanted, sweep, taken(i, 2, k))
      end do
    end do
    do k = 1, size(counts)
      print numbers, counts(k), median(taken(:, 1, k)), median(taken(:, 2, k)), size(held), tables(k), steps(k)
    end do

  contains

    function spread_out(count) result(rpm)
      integer, intent(in) :: count
      real(dp) :: rpm(count)

      associate (first => problem%rpm(1), last => problem%rpm(size(problem%rpm)))
        rpm = [(first + (last - first)*(n - 1)/(count - 1), n=1, count)]
      end associate
    end function spread_out
  end subroutine cost_over_speeds

  !> For each ratio a line: the ratio; points of each kind, mean steps of those in full contact; seconds for all
  !> points as the problem's sweep takes them, and for those of each kind alone, each by itself; points in full
  !> contact that were marched from rest, how many of them without an answer, their seconds.
  subroutine cost_over_damping(problem, wanted, ratios)
    type(problem_t), intent(in) :: problem
    real(dp), intent(in) :: wanted, ratios(:)
    type(setting_t) :: setting(size(ratios))
    integer :: i, k, what

    do k = 1, size(ratios)
      call damp(problem, wanted, ratios(k), setting(k))
    end do
    do i = 1, rounds
      do k = 1, size(ratios)
        do what = 1, 5
          call take(problem, wanted, what, setting(k))
        end do
      end do
    end do
    do k = 1, size(ratios)
      associate (one => setting(k))
        print numbers, ratios(k), (count(one%kind == what), what=full, other), one%steps, &
          (median(one%taken(:one%times(what), what)), what=1, 4), one%marched, median(one%taken(:one%times(5), 5))
      end associate
    end do
  end subroutine cost_over_damping

  !> The problem's oscillators with other damping, and what kind of point each speed then is.
  subroutine damp(problem, wanted, ratio, setting)
    type(problem_t), intent(in) :: problem
    real(dp), intent(in) :: wanted, ratio
    type(setting_t), intent(out) :: setting
    type(error_t), allocatable :: error
    type(sweep_t) :: sweep
    real(dp) :: taken
    integer :: i

    setting%osc = problem%osc
    setting%osc%damping_ratio = ratio
    do i = 1, size(setting%osc)
      call make_oscillator(setting%osc(i), error)
      call check(error)
    end do
    call solve(setting%osc, problem%rpm, each, by_shooting, wanted, sweep, taken)
    setting%kind = kind_of(sweep)
    setting%steps = sum(sweep%steps, mask=setting%kind == full)/real(max(1, count(setting%kind == full)), dp)
  end subroutine damp

  !> Once more what is timed: 1 all points, 2 to 4 those of a kind, 5 marching; not again what is slow.
  subroutine take(problem, wanted, what, setting)
    type(problem_t), intent(in) :: problem
    real(dp), intent(in) :: wanted
    integer, intent(in) :: what
    type(setting_t), intent(inout) :: setting
    type(sweep_t) :: sweep

    if (setting%times(what) > 0 .and. setting%taken(1, what) > slow) return
    setting%times(what) = setting%times(what) + 1
    associate (osc => setting%osc, taken => setting%taken(setting%times(what), what))
      select case (what)
      case (1)
        call solve(osc, problem%rpm, problem%case%direction, by_shooting, wanted, sweep, taken)
      case (5)
        call solve_some(osc, problem%rpm, thinned(setting%kind == full), by_marching, wanted, taken, setting%marched)
      case default
        call solve_some(osc, problem%rpm, setting%kind == what - 1, by_shooting, wanted, taken)
      end select
    end associate
  end subroutine take

  pure function kind_of(sweep) result(kind)
    type(sweep_t), intent(in) :: sweep
    integer :: kind(size(sweep%rpm), size(sweep%status, 2))

    kind = other
    where (has_result(sweep%status) .and. sweep%periods == 1) kind = merge(full, changing, sweep%contact == contact_full)
  end function kind_of

  !> Every so many of them.
  pure function thinned(wanted) result(kept)
    logical, intent(in) :: wanted(:, :)
    logical :: kept(size(wanted, 1), size(wanted, 2))
    integer :: i, j, n

    n = 0
    do j = 1, size(wanted, 2)
      do i = 1, size(wanted, 1)
        if (wanted(i, j)) n = n + 1
        kept(i, j) = wanted(i, j) .and. modulo(n, share) == 1
      end do
    end do
  end function thinned

  !> Those speeds of each relief alone; how many points, and how many of them without an answer.
  subroutine solve_some(osc, rpm, chosen, method, wanted, taken, points)
    type(oscillator_t), intent(in) :: osc(:)
    real(dp), intent(in) :: rpm(:)
    logical, intent(in) :: chosen(:, :)
    integer, intent(in) :: method
    real(dp), intent(in) :: wanted
    real(dp), intent(out) :: taken
    integer, intent(out), optional :: points(2)
    type(sweep_t) :: sweep
    real(dp) :: part
    integer :: i, lost

    taken = 0
    lost = 0
    do i = 1, size(osc)
      if (.not. any(chosen(:, i))) cycle
      call solve(osc(i:i), pack(rpm, chosen(:, i)), each, method, wanted, sweep, part)
      taken = taken + part
      lost = lost + count(.not. has_result(sweep%status))
    end do
    if (present(points)) points = [count(chosen), lost]
  end subroutine solve_some

  subroutine solve(osc, rpm, direction, method, wanted, sweep, taken)
    type(oscillator_t), intent(in) :: osc(:)
    real(dp), intent(in) :: rpm(:), wanted
    integer, intent(in) :: direction, method
    type(sweep_t), intent(out) :: sweep
    real(dp), intent(out) :: taken
    type(sweep_options_t) :: options
    type(error_t), allocatable :: error

    options%direction = direction
    options%threads = 1
    options%accuracy%steady%method = method
    options%accuracy%steady%tolerance = wanted
    taken = seconds()
    call run_sweep(osc, rpm, options, sweep, error)
    taken = seconds() - taken
    call check(error)
  end subroutine solve

  !> Tables of as many steps as the points have, each made once a relief.
  real(dp) function table_time(osc, steps) result(total)
    type(oscillator_t), intent(in) :: osc(:)
    integer, intent(in) :: steps(:, :)
    type(coefficients_t) :: table
    real(dp) :: from
    integer :: i, k

    total = 0
    do i = 1, size(osc)
      do k = minval(steps(:, i)), maxval(steps(:, i))
        if (.not. any(steps(:, i) == k)) cycle
        from = seconds()
        call tabulate(osc(i), resolution_t(real(k, dp), 1), table)
        call tabulate(osc(i), resolution_t(k/2.0_dp, 1), table)
        total = total + seconds() - from
      end do
    end do
  end function table_time
end module bench_cost
