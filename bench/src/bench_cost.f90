!> What a sweep costs over its number of speeds and over the damping. Every setting takes its turn in every
!> round, but for those that are slow; medians.
module bench_cost
  use bench_problem, only: problem_t
  use bench_tools, only: check, median, numbers, seconds
  use gearsweep, only: dp, error_t, make_oscillator, oscillator_t, run_sweep, sweep_t, sweep_options_t
  use gearsweep_motion, only: resolution_t, table_t, tabulate
  use gearsweep_steady, only: by_marching, by_shooting, has_answer
  use gearsweep_sweep, only: contact_full, each
  implicit none
  private
  public :: cost_over_speeds, cost_over_damping, table_time

  integer, parameter :: rounds = 11
  real(dp), parameter :: slow = 0.2_dp           !< s: once is enough
  !> Kinds of points: all pairs always in contact; contact that changes in a motion that repeats with the
  !> mesh; motions that repeat later or never.
  integer, parameter :: full = 1, changing = 2, other = 3
  integer, parameter :: share = 8                !< every so many points are marched

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
    type(oscillator_t) :: osc(size(problem%osc))
    type(sweep_t) :: sweep
    real(dp) :: taken(rounds, 5, size(ratios)), steps(size(ratios))
    integer :: kind(size(problem%rpm), size(problem%osc), size(ratios)), marched(2, size(ratios)), n(5, size(ratios))
    integer :: i, k, what

    do i = 1, rounds
      do k = 1, size(ratios)
        call damp(problem, ratios(k), osc)
        if (i == 1) then
          n(:, k) = 0
          call solve(osc, problem%rpm, each, by_shooting, wanted, sweep, taken(1, 1, k))
          kind(:, :, k) = kind_of(sweep)
          steps(k) = sum(sweep%steps, mask=kind(:, :, k) == full)/real(max(1, count(kind(:, :, k) == full)), dp)
        end if
        do what = 1, 5
          if (n(what, k) > 0) then
            if (taken(1, what, k) > slow) cycle
          end if
          n(what, k) = i
          select case (what)
          case (1)
            call solve(osc, problem%rpm, problem%case%direction, by_shooting, wanted, sweep, taken(i, 1, k))
          case (2:4)
            call solve_some(osc, problem%rpm, kind(:, :, k) == what - 1, by_shooting, wanted, taken(i, what, k))
          case (5)
            call solve_some(osc, problem%rpm, thinned(kind(:, :, k) == full), by_marching, wanted, taken(i, 5, k), marched(:, k))
          end select
        end do
      end do
    end do
    do k = 1, size(ratios)
      print numbers, ratios(k), (count(kind(:, :, k) == what), what=full, other), steps(k), &
        (median(taken(:n(what, k), what, k)), what=1, 4), marched(:, k), median(taken(:n(5, k), 5, k))
    end do
  end subroutine cost_over_damping

  !> The problem's oscillators, with other damping.
  subroutine damp(problem, ratio, osc)
    type(problem_t), intent(in) :: problem
    real(dp), intent(in) :: ratio
    type(oscillator_t), intent(out) :: osc(:)
    type(error_t), allocatable :: error
    integer :: i

    osc = problem%osc
    osc%damping_ratio = ratio
    do i = 1, size(osc)
      call make_oscillator(osc(i), error)
      call check(error)
    end do
  end subroutine damp

  pure function kind_of(sweep) result(kind)
    type(sweep_t), intent(in) :: sweep
    integer :: kind(size(sweep%rpm), size(sweep%status, 2))

    kind = other
    where (has_answer(sweep%status) .and. sweep%periods == 1) kind = merge(full, changing, sweep%contact == contact_full)
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
      lost = lost + count(.not. has_answer(sweep%status))
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
    type(table_t) :: table
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
