!> Reported error estimates over random meshes: they may be exceeded twofold by
!> one in twenty at most, and the tolerance by one in a hundred. Half of the errors lie below
!> 20/63 of the estimate, as a result of sixth order errs by 1/63 of its difference to half the steps, and
!> the estimate says 1/20 of it: neither too small nor too large. What is true comes from
!> the library itself at 1e-11; `sh bench/run.sh honesty` asks an independent reference.
!>
!> Then the motions at which both solutions are easily off by the same.
module test_estimate_coverage
  use gearsweep_motion_resolution, only: resolution_t
  use gearsweep_base_error, only: error_t
  use gearsweep_motion_error_estimate, only: accuracy_t, levels_t, point_t
  use gearsweep_motion_gauss, only: batch_size
  use gearsweep_base_kinds, only: dp, pi
  use gearsweep_motion_operating_point, only: solve_batch, solve_point
  use gearsweep_motion_oscillator, only: mesh_period, oscillator_t, resolving_steps
  use gearsweep_motion_period_map, only: discretise, period_map_t, set_durations
  use gearsweep_motion_periodic_orbit, only: shoot, steady_t
  use gearsweep_motion_steady_motion, only: has_result, status_unresolved
  use gearsweep_motion_sweep, only: contact_full, each, run_sweep, sweep_options_t, sweep_t
  use gearsweep_base_text, only: str
  use test_properties_random_meshes, only: draw_t, random_mesh
  use test_properties_random_motions, only: random_motion
  use test_support_random_numbers, only: random_t
  use test_support_solve_one_point, only: mesh_of, solve
  use test_estimate_closed_forms, only: median
  use test_graded_steps, only: closed_form
  use test_support_testing, only: tally_t, check_close, check_equal, check_true
  implicit none
  private
  public :: run

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t

    if (t%wants('random_points')) call random_points(t)
    if (t%wants('strong_damping_in_equal_steps')) call strong_damping_in_equal_steps(t)
    if (t%wants('errors_that_cancel')) call errors_that_cancel(t)
  end subroutine run

  subroutine random_points(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: meshes = 32, speeds = 4
    integer :: i, points, optimistic, beyond, parted, told(2)
    real(dp) :: part(meshes*speeds, 2)

    told = 0
    points = 0
    optimistic = 0
    beyond = 0
    parted = 0
    do i = 1, meshes
      call one_mesh(i)
    end do
    call check_true(t, 'most points have an answer', points >= meshes*speeds*8/10, str(points))
    call check_true(t, 'some lose contact', parted >= meshes*speeds/10, str(parted))
    call check_true(t, 'estimates hold twofold in 95 %', 20*optimistic <= points, str(optimistic)//' of '//str(points))
    call check_true(t, 'the tolerance holds in 99 %', 100*beyond <= points, str(beyond)//' of '//str(points))
    call check_close(t, 'in contact: error over estimate, median', median(part(:told(1), 1)), 20/63.0_dp, 0.4_dp)
    call check_close(t, 'parted: error over estimate, median', median(part(:told(2), 2)), 20/63.0_dp, 0.4_dp)

  contains

    subroutine one_mesh(i)
      integer, intent(in) :: i
      !> What is true is no better than this.
      real(dp), parameter :: rounding = 2e-11_dp
      type(draw_t) :: draw
      type(sweep_t) :: asked, truth
      real(dp) :: error
      integer :: k, kind

      call random_mesh(1000 + i, speeds, draw)
      asked = swept(draw, draw%tolerance)
      truth = swept(draw, 1e-11_dp)
      do k = 1, speeds
        if (.not. (has_result(asked%status(k, 1)) .and. has_result(truth%status(k, 1)))) cycle
        error = abs(asked%dynamic_factor(k, 1) - truth%dynamic_factor(k, 1)) - rounding
        points = points + 1
        if (error > 2*asked%estimate(k, 1)) optimistic = optimistic + 1
        if (error > draw%tolerance) beyond = beyond + 1
        kind = merge(1, 2, asked%contact(k, 1) == contact_full)
        if (kind == 2) parted = parted + 1
        ! Of errors near rounding nothing can be said.
        if (error < 5*rounding) cycle
        told(kind) = told(kind) + 1
        part(told(kind), kind) = error/asked%estimate(k, 1)
      end do
    end subroutine one_mesh
  end subroutine random_points

  type(sweep_t) function swept(draw, tolerance) result(sweep)
    type(draw_t), intent(in) :: draw
    real(dp), intent(in) :: tolerance
    type(sweep_options_t) :: options
    type(error_t), allocatable :: error

    options%direction = each
    options%accuracy%steady%tolerance = tolerance
    call run_sweep([draw%osc], draw%rpm, options, sweep, error)
  end function swept

  !> Piecewise constant stiffness at damping ratios of 0.5 to 50, tolerances down to 1e-10 and speeds of 0.1 to 2.6 of the
  !> resonance, where steps are equal: what a break excites decays within a few of them, and the sixth order hides. True is
  !> the closed form.
  subroutine strong_damping_in_equal_steps(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: draws = 600
    type(oscillator_t) :: osc
    type(accuracy_t) :: options
    type(point_t) :: point
    type(random_t) :: random
    real(dp) :: dynamic_factor, multiplier, zeta, rpm, error
    integer :: i, points, optimistic, beyond

    points = 0
    optimistic = 0
    beyond = 0
    do i = 1, draws
      zeta = random%power(0.5_dp, 50.0_dp)
      osc = mesh_of(1.6_dp, [400.0_dp], [0.0_dp, 0.0_dp], zeta)
      rpm = 60*osc%natural_frequency/(2*pi*25)*random%power(0.1_dp, 2.6_dp)
      options%steady%tolerance = random%power(1e-10_dp, 1e-5_dp)
      call solve(osc, rpm, options, point)
      if (point%steady%partial .or. point%resolution%graded_for > 0) cycle
      call closed_form(osc%natural_frequency, zeta, mesh_period(25, rpm), dynamic_factor, multiplier)
      error = abs(point%dynamic_factor - dynamic_factor)
      if (error < 2e-12_dp) cycle
      points = points + 1
      if (error > 2*point%estimate) optimistic = optimistic + 1
      if (error > options%steady%tolerance) beyond = beyond + 1
    end do
    call check_true(t, 'points in equal steps', points >= draws/10, str(points))
    ! 1.26 % of 3493 such points are above twice their estimate: 97 % leaves room for so few draws.
    call check_true(t, 'estimates hold twofold in 97 %', 33*optimistic <= points, str(optimistic)//' of '//str(points))
    call check_equal(t, 'beyond the tolerance', beyond, 0)
  end subroutine strong_damping_in_equal_steps

  !> The draws of `random_motion` among the first 1250 that were least honest before, of each kind the worst: smooth intervals
  !> so short that both solutions had one step in them; damping above half of the critical one in equal steps; stiffness
  !> through many knots, where the largest load was that of a polynomial. Speeds of a batch, and each by itself. True is what four
  !> times as many steps and more give, cut otherwise. A quarter, more than half and half of these errors were above twice the
  !> estimate; of those left most are of one draw, 869, in which a pair parts too briefly for the steps to see.
  subroutine errors_that_cancel(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: short(*) = [204, 934, 966, 1230, 1129, 687, 237, 834, 46, 245, 740, 449, 430], &
                          damped(*) = [223, 1069, 284, 1171, 869, 1111, 300, 1175, 260, 865, 1197, 1247, 798, 324, 411], &
                          knots(*) = [1112, 424, 800, 744, 856, 368, 272, 1192, 176, 608, 568, 1064, 128, 328, 992]

    call look_at(t, 'short intervals', short)
    call look_at(t, 'strong damping', damped)
    call look_at(t, 'many knots', knots)
  end subroutine errors_that_cancel

  subroutine look_at(t, name, draws)
    type(tally_t), intent(inout) :: t
    character(*), intent(in) :: name
    integer, intent(in) :: draws(:)
    !> What is true is no better than this.
    real(dp), parameter :: rounding = 1e-12_dp
    type(draw_t) :: draw
    type(accuracy_t) :: options
    type(levels_t), allocatable :: levels
    type(point_t) :: points(2*batch_size)
    logical :: solved(batch_size)
    real(dp) :: duration(batch_size), error, part(2*batch_size*size(draws))
    integer :: i, k, n, optimistic, beyond

    n = 0
    optimistic = 0
    beyond = 0
    do i = 1, size(draws)
      call random_motion(draws(i), batch_size, draw)
      options%steady%tolerance = draw%tolerance
      duration = mesh_period(draw%osc%mesh%teeth(1), draw%rpm)
      levels = levels_t()
      call solve_batch(draw%osc, duration, options, levels, points(:batch_size), solved)
      do k = 1, batch_size
        levels = levels_t()
        call solve_point(draw%osc, duration(k), options, levels, points(batch_size + k))
        if (.not. solved(k)) points(k)%steady%status = status_unresolved
      end do
      do k = 1, size(points)
        if (.not. has_result(points(k)%steady%status)) cycle
        error = abs(points(k)%dynamic_factor - in_many_steps(draw%osc, duration(1 + modulo(k - 1, batch_size)), points(k)))
        if (error < rounding) cycle
        n = n + 1
        part(n) = error/points(k)%estimate
        if (error > 2*points(k)%estimate) optimistic = optimistic + 1
        if (error > draw%tolerance) beyond = beyond + 1
      end do
    end do
    call check_true(t, name//': most have an answer', n > size(draws)*batch_size, str(n))
    call check_true(t, name//': estimates hold twofold in 90 %', 10*optimistic <= n, str(optimistic)//' of '//str(n))
    call check_equal(t, name//': beyond the tolerance', beyond, 0)
    call check_true(t, name//': estimates are no larger than they need be', median(part(:n)) > 0.02_dp, str(median(part(:n))))
  end subroutine look_at

  !> The dynamic factor of the motion of a point.
  real(dp) function in_many_steps(osc, duration, point) result(dynamic_factor)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration
    type(point_t), intent(in) :: point
    type(period_map_t) :: map
    type(steady_t) :: steady
    real(dp) :: steps

    steps = max(1500.0_dp, 4.0_dp*point%steps, 16*resolving_steps(osc, duration))
    call discretise(osc, resolution_t(steps/7, 7), map)
    call set_durations(map, [duration])
    call shoot(map, 1e-12_dp, point%steady%periods, point%steady%state, steady)
    dynamic_factor = merge(steady%peak/osc%load, huge(dynamic_factor), has_result(steady%status))
  end function in_many_steps
end module test_estimate_coverage
