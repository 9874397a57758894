!> What searches cost beside that of which they are made: the best relief beside sweeps, all motions that attract at a speed beside
!> the march to one of them. Each in turn in one process; seconds, medians.
module bench_searches
  use bench_problem, only: problem_t
  use bench_tools, only: check, median, numbers, seconds
  use gearsweep, only: dp, error_t, run_sweep, sweep_options_t, sweep_t
  use gearsweep_motion_attractors, only: attractor_options_t
  use gearsweep_motion_attractors, only: attractors_t, find_attractors
  use gearsweep_motion_optimum, only: find_optimum, optimum_t
  use gearsweep_motion_oscillator, only: make_oscillator, oscillator_t
  use gearsweep_motion_sweep, only: contact_full
  use gearsweep_motion_steady_motion, only: by_marching
  implicit none
  private
  public :: time_optimum, time_attractors

  integer, parameter :: rounds = 31

contains

  !> A line: points of the sweep over all reliefs, its seconds, those of the largest relief in full contact and of the largest of
  !> all by themselves, and those of the search for the best relief.
  subroutine time_optimum(problem, wanted)
    type(problem_t), intent(in) :: problem       !< reliefs ascending, linear in the amount
    real(dp), intent(in) :: wanted               !< tolerance of the dynamic factor
    type(sweep_options_t) :: options
    type(sweep_t) :: sweep, alone
    type(optimum_t) :: optimum
    type(error_t), allocatable :: error
    real(dp) :: taken(rounds, 4), from, largest
    integer :: i, n, full

    options%direction = problem%case%direction
    options%threads = 1
    options%accuracy%steady%tolerance = wanted
    n = size(problem%osc)
    associate (mesh => problem%osc(n)%mesh)
      largest = max(1.0_dp, 1.5_dp*problem%osc(n)%load/mesh%stiffness%value(mesh%contact_ratio/2)/mesh%profile_error%maximum())
    end associate
    do i = 1, rounds
      from = seconds()
      call run_sweep(problem%osc, problem%rpm, options, sweep, error)
      taken(i, 1) = seconds() - from
      call check(error)
      full = findloc(all(sweep%contact == contact_full, 1), .true., 1, back=.true.)
      from = seconds()
      call run_sweep(problem%osc(full:full), problem%rpm, options, alone, error)
      taken(i, 2) = seconds() - from
      call check(error)
      from = seconds()
      call run_sweep(problem%osc(n:n), problem%rpm, options, alone, error)
      taken(i, 3) = seconds() - from
      call check(error)
      from = seconds()
      call find_optimum(with_part, problem%osc(n), largest, problem%rpm, options, optimum, error)
      taken(i, 4) = seconds() - from
      call check(error)
    end do
    print numbers, size(sweep%status), median(taken(:, 1)), median(taken(:, 2)), median(taken(:, 3)), median(taken(:, 4))
  end subroutine time_optimum

  !> The mesh with this part of its relief.
  subroutine with_part(context, amount, motion, error)
    class(*), intent(in) :: context
    real(dp), intent(in) :: amount
    type(oscillator_t), intent(out) :: motion
    type(error_t), allocatable, intent(out) :: error

    select type (context)
    type is (oscillator_t)
      motion = context
      motion%mesh%profile_error%coef = amount*context%mesh%profile_error%coef
      call make_oscillator(motion, error)
    end select
  end subroutine with_part

  !> A line: motions found at the first speed, seconds of finding all of them, and of the march to one.
  subroutine time_attractors(problem, wanted)
    type(problem_t), intent(in) :: problem       !< of one relief
    real(dp), intent(in) :: wanted               !< tolerance of the dynamic factor
    type(attractor_options_t) :: all_options
    type(attractors_t) :: found(1)
    type(sweep_options_t) :: options
    type(sweep_t) :: sweep
    type(error_t), allocatable :: error
    real(dp) :: taken(rounds, 2), from
    integer :: i

    all_options%accuracy%steady%tolerance = wanted
    all_options%threads = 1
    options%threads = 1
    options%accuracy%steady%tolerance = wanted
    options%accuracy%steady%method = by_marching
    do i = 1, rounds
      from = seconds()
      call find_attractors(problem%osc(1), problem%rpm(:1), all_options, found)
      taken(i, 1) = seconds() - from
      from = seconds()
      call run_sweep(problem%osc(:1), problem%rpm(:1), options, sweep, error)
      taken(i, 2) = seconds() - from
      call check(error)
    end do
    print numbers, size(found(1)%motion), median(taken(:, 1)), median(taken(:, 2))
  end subroutine time_attractors
end module bench_searches
