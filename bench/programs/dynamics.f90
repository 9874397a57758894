!> Dynamic factors of a problem, timed; prints plain numbers for bench/dynamics.py.
!>
!>     dynamics problem FILE
!>         the problem for the other contenders
!>     dynamics METHOD FILE ERROR STEPS [ERROR STEPS ...]
!>         for each pair a line: seconds, then the dynamic factors, relief by relief
!>     dynamics parts FILE ERROR
!>         for all reliefs together and for each alone a line: seconds, points in which contact changes,
!>         calls of the collocation at least, seconds that the tables take; then seconds of one call,
!>         operations a second in it, and the most that this build reaches
!>     dynamics speeds FILE ERROR COUNT [COUNT ...]
!>     dynamics damping FILE ERROR RATIO [RATIO ...]
!>         what so many speeds, or such damping, cost: bench_cost tells the numbers
!>     dynamics threads FILE ERROR
!>         seconds with one thread and with two, in turn
!>     dynamics optimum FILE ERROR
!>     dynamics attractors FILE ERROR
!>         what these searches cost: bench_searches tells the numbers
!>     dynamics corners FILE ERROR
!>         with each pair by itself and with what neighbouring teeth share a line: seconds and mean steps of a point
!>         with the path from A to E, and the same with contact beyond it
!>
!> METHOD is the library's `shooting` or `marching` (STEPS = 0 are chosen
!> for the ERROR), or of the literature: `rk4`, `rk4_aligned`, `rk4_shooting`,
!> `constant`, `constant_aligned`.
program dynamics
  use bench_cost, only: cost_over_damping, cost_over_speeds, table_time
  use bench_fixed_steps, only: solve_with_steps, runge_kutta, constant, marched => by_marching, shot => by_shooting
  use bench_kernel, only: collocation_rate, best_rate
  use bench_problem, only: problem_t, read_problem, write_problem
  use bench_searches, only: time_attractors, time_optimum
  use bench_tools, only: word, number, real_number, seconds, median, check, numbers
  use gearsweep, only: dp, error_t, run_sweep, sweep_t, sweep_options_t
  use gearsweep_motion_gauss, only: batch_size
  use gearsweep_motion_oscillator, only: oscillator_t
  use gearsweep_motion_sweep, only: contact_full
  use gearsweep_motion_steady_motion, only: by_marching, by_shooting
  implicit none

  type(problem_t) :: problem
  integer :: i

  if (word(1) == 'corners') then
    call compare_corners(word(2), real_number(3))
    stop
  end if
  call read_problem(word(2), problem)
  if (word(1) == 'problem') then
    call write_problem(problem%osc, problem%rpm)
  else if (word(1) == 'parts') then
    call take_apart(real_number(3))
  else if (word(1) == 'speeds') then
    call cost_over_speeds(problem, real_number(3), [(number(i), i=4, command_argument_count())])
  else if (word(1) == 'damping') then
    call cost_over_damping(problem, real_number(3), [(real_number(i), i=4, command_argument_count())])
  else if (word(1) == 'optimum') then
    call time_optimum(problem, real_number(3))
  else if (word(1) == 'attractors') then
    call time_attractors(problem, real_number(3))
  else if (word(1) == 'threads') then
    call compare_threads(real_number(3))
  else
    do i = 3, command_argument_count(), 2
      call time_one(word(1), real_number(i), number(i + 1))
    end do
  end if

contains

  !> The median of as many runs as fit into a twentieth of a second, at least one.
  subroutine time_one(method, wanted, steps)
    character(*), intent(in) :: method
    real(dp), intent(in) :: wanted
    integer, intent(in) :: steps
    integer, parameter :: most = 201
    real(dp), parameter :: enough = 0.05_dp
    real(dp) :: taken(most), dynamic_factor(size(problem%rpm), size(problem%osc)), from
    integer :: n

    do n = 1, most
      from = seconds()
      call solve(method, wanted, steps, dynamic_factor)
      taken(n) = seconds() - from
      if (sum(taken(:n)) > enough) exit
    end do
    print numbers, median(taken(:min(n, most))), dynamic_factor
  end subroutine time_one

  subroutine solve(method, wanted, steps, dynamic_factor)
    character(*), intent(in) :: method
    real(dp), intent(in) :: wanted
    integer, intent(in) :: steps
    real(dp), intent(out) :: dynamic_factor(:, :)

    select case (method)
    case ('shooting')
      call solve_ours(by_shooting, 1, wanted, steps, dynamic_factor)
    case ('marching')
      call solve_ours(by_marching, 1, wanted, steps, dynamic_factor)
    case ('rk4')
      call solve_fixed(runge_kutta, marched, .false., wanted, steps, dynamic_factor)
    case ('rk4_aligned')
      call solve_fixed(runge_kutta, marched, .true., wanted, steps, dynamic_factor)
    case ('rk4_shooting')
      call solve_fixed(runge_kutta, shot, .true., wanted, steps, dynamic_factor)
    case ('constant')
      call solve_fixed(constant, marched, .false., wanted, steps, dynamic_factor)
    case ('constant_aligned')
      call solve_fixed(constant, marched, .true., wanted, steps, dynamic_factor)
    case default
      error stop 'dynamics: unknown method'
    end select
  end subroutine solve

  !> Where the sweep's time goes.
  subroutine take_apart(wanted)
    real(dp), intent(in) :: wanted
    real(dp) :: rate, call_time
    integer :: i

    call time_part(problem%osc, wanted)
    do i = 1, size(problem%osc)
      call time_part(problem%osc(i:i), wanted)
    end do
    call collocation_rate(rate, call_time)
    print numbers, call_time, rate, best_rate()
  end subroutine take_apart

  subroutine compare_threads(wanted)
    real(dp), intent(in) :: wanted
    integer, parameter :: rounds = 101
    real(dp) :: taken(rounds, 2), dynamic_factor(size(problem%rpm), size(problem%osc)), from
    integer :: i, threads

    do i = 1, rounds
      do threads = 1, 2
        from = seconds()
        call solve_ours(by_shooting, threads, wanted, 0, dynamic_factor)
        taken(i, threads) = seconds() - from
      end do
    end do
    print numbers, median(taken(:, 1)), median(taken(:, 2))
  end subroutine compare_threads

  !> What contact beyond A and E costs.
  subroutine compare_corners(path, wanted)
    character(*), intent(in) :: path
    real(dp), intent(in) :: wanted
    integer, parameter :: rounds = 51
    type(problem_t) :: problems(4)
    type(sweep_options_t) :: options
    type(sweep_t) :: sweep
    type(error_t), allocatable :: error
    real(dp) :: taken(rounds, 4), steps(4), from
    integer :: i, k

    options%threads = 1
    options%accuracy%steady%tolerance = wanted
    do k = 1, 4
      call read_problem(path, problems(k), corners=modulo(k, 2) == 0, coupling=k > 2)
    end do
    do i = 1, rounds
      do k = 1, 4
        options%direction = problems(k)%case%direction
        from = seconds()
        call run_sweep(problems(k)%osc, problems(k)%rpm, options, sweep, error)
        taken(i, k) = seconds() - from
        call check(error)
        steps(k) = sum(sweep%steps)/real(size(sweep%steps), dp)
      end do
    end do
    do k = 1, 3, 2
      print numbers, size(sweep%steps), median(taken(:, k)), steps(k), median(taken(:, k + 1)), steps(k + 1)
    end do
  end subroutine compare_corners

  subroutine time_part(osc, wanted)
    type(oscillator_t), intent(in) :: osc(:)
    real(dp), intent(in) :: wanted
    integer, parameter :: rounds = 51
    type(sweep_options_t) :: options
    type(sweep_t) :: sweep
    type(error_t), allocatable :: error
    real(dp) :: taken(rounds), from
    integer :: i

    options%direction = problem%case%direction
    options%threads = 1
    options%accuracy%steady%tolerance = wanted
    do i = 1, rounds
      from = seconds()
      call run_sweep(osc, problem%rpm, options, sweep, error)
      taken(i) = seconds() - from
      call check(error)
    end do
    ! A whole and a half for eight points at once: a bound, as other rungs may have been tried.
    print numbers, median(taken), count(sweep%contact /= contact_full), 1.5_dp*sum(sweep%steps)/batch_size, &
      table_time(osc, sweep%steps)
  end subroutine time_part

  !> The library's sweep.
  subroutine solve_ours(method, threads, wanted, steps, dynamic_factor)
    integer, intent(in) :: method, threads, steps
    real(dp), intent(in) :: wanted
    real(dp), intent(out) :: dynamic_factor(:, :)
    type(sweep_options_t) :: options
    type(sweep_t) :: sweep
    type(error_t), allocatable :: error

    options%direction = problem%case%direction
    options%threads = threads
    options%accuracy%steps = steps
    options%accuracy%steady%method = method
    options%accuracy%steady%tolerance = wanted
    call run_sweep(problem%osc, problem%rpm, options, sweep, error)
    call check(error)
    dynamic_factor = sweep%dynamic_factor
  end subroutine solve_ours

  subroutine solve_fixed(method, steady_by, aligned, wanted, steps, dynamic_factor)
    integer, intent(in) :: method, steady_by, steps
    logical, intent(in) :: aligned
    real(dp), intent(in) :: wanted
    real(dp), intent(out) :: dynamic_factor(:, :)
    integer :: i

    do i = 1, size(problem%osc)
      call solve_with_steps(problem%osc(i), problem%rpm, method, steady_by, aligned, steps, wanted, dynamic_factor(:, i))
    end do
  end subroutine solve_fixed
end program dynamics
