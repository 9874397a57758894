!> The methods of the literature beside ours: their orders, where they are exact, what their estimates cover, and what
!> was published with them. The reference is Gauss collocation with contact events located, at a tolerance of 1e-11; it
!> has references of its own (suites motion, extremes).
module test_methods
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use, intrinsic :: iso_fortran_env, only: int64
  use gearsweep_motion_resolution, only: resolution_t, scheme_constant, scheme_rk4, scheme_rk4_equal
  use gearsweep_motion_contact_set, only: period_t
  use gearsweep_base_error, only: error_t
  use gearsweep_motion_error_estimate, only: accuracy_t, point_t
  use gearsweep_base_kinds, only: dp
  use gearsweep_motion_oscillator, only: make_oscillator, mesh_period, oscillator_t
  use gearsweep_motion_period, only: run_period
  use gearsweep_motion_period_map, only: discretise, period_map_t, set_durations
  use gearsweep_motion_steady_motion, only: has_result, status_inexact
  use gearsweep_motion_sweep, only: contact_full, each, run_sweep, sweep_options_t, sweep_t
  use gearsweep_base_text, only: str
  use gearsweep_motion_steady_motion, only: by_marching
  use test_support_random_numbers, only: random_t
  use test_support_solve_one_point, only: mesh_of, solve
  use test_support_testing, only: check_close, check_true, tally_t
  implicit none
  private
  public :: run

  real(dp), parameter :: none(2) = 0
  integer, parameter :: schemes(3) = [scheme_rk4, scheme_rk4_equal, scheme_constant]

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t

    if (t%wants('orders')) call orders(t)
    if (t%wants('smooth_coefficients')) call smooth_coefficients(t)
    if (t%wants('constant_coefficients')) call constant_coefficients(t)
    if (t%wants('one_period')) call one_period(t)
    if (t%wants('estimates')) call estimates(t)
    if (t%wants('threads')) call threads(t)
    if (t%wants('marched')) call marched(t)
    if (t%wants('published')) call published(t)
  end subroutine run

  !> Mean errors of the dynamic factor over speeds and contact ratios, while all pairs stay in contact, with some number
  !> of steps and with more. Between breaks Runge-Kutta is of fourth order; with breaks somewhere within steps, a method
  !> is of first.
  subroutine orders(t)
    type(tally_t), intent(inout) :: t
    real(dp) :: few(3), many(3)

    few = mean_error(100)
    many = mean_error(800)
    associate (order => log(few/many)/log(8.0_dp))
      call check_true(t, 'rk4: fourth order', order(1) > 3.6_dp .and. order(1) < 4.5_dp, str(order(1)))
      call check_true(t, 'rk4_equal: first order', order(2) > 0.7_dp .and. order(2) < 1.5_dp, str(order(2)))
      call check_true(t, 'constant: first order', order(3) > 0.7_dp .and. order(3) < 1.5_dp, str(order(3)))
    end associate
    call check_true(t, 'breaks at the ends of steps make the difference', few(1) < few(2)/50, str(few(1))//' '//str(few(2)))
  end subroutine orders

  function mean_error(steps) result(error)
    integer, intent(in) :: steps
    real(dp) :: error(3)
    integer, parameter :: ratios = 20
    real(dp), parameter :: golden = 0.61803398874989_dp    ! places that no grid has
    type(oscillator_t) :: osc
    type(point_t) :: truth, point
    integer :: i, k, m, points

    error = 0
    points = 0
    do i = 1, ratios
      osc = mesh_of(1.3_dp + 0.5_dp*modulo(i*golden, 1.0_dp), [400.0_dp, 30.0_dp, -110.0_dp], none, 0.15_dp)
      do k = 1, 4
        call solve(osc, 3000.0_dp + 2330*k, exactly(), truth)
        if (truth%steady%partial) cycle
        points = points + 1
        do m = 1, 3
          call solve(osc, 3000.0_dp + 2330*k, in_steps(schemes(m), steps), point)
          error(m) = error(m) + abs(point%dynamic_factor - truth%dynamic_factor)
        end do
      end do
    end do
    error = error/points
  end function mean_error

  !> Contact ratio 2 and a curve that begins and ends with the same stiffness: nothing jumps. Then equal steps are as
  !> good as any, Runge-Kutta is of fourth order in the multiplier, which knows nothing of loads, and constant
  !> coefficients, those of the middle, are of second.
  subroutine smooth_coefficients(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: steps(2) = [100, 400]
    type(oscillator_t) :: osc
    type(point_t) :: truth, point
    real(dp) :: error(2, 2), order(2)
    integer :: i, k, m

    osc = mesh_of(2.0_dp, [400.0_dp, 0.0_dp, -110.0_dp], none, 0.1_dp)
    error = 0
    do k = 1, 10
      call solve(osc, 5000.0_dp + 1330*k, exactly(), truth)
      do i = 1, 2
        do m = 1, 2
          call solve(osc, 5000.0_dp + 1330*k, in_steps(schemes(1 + m), steps(i)), point)
          error(i, m) = error(i, m) + abs(point%steady%multiplier - truth%steady%multiplier)
        end do
      end do
    end do
    order = log(error(1, :)/error(2, :))/log(4.0_dp)
    call check_true(t, 'rk4_equal: fourth order', order(1) > 3.7_dp .and. order(1) < 5.2_dp, str(order(1)))
    call check_true(t, 'constant: second order', order(2) > 1.8_dp .and. order(2) < 2.3_dp, str(order(2)))
  end subroutine smooth_coefficients

  !> Each pair's stiffness is constant, and with a contact ratio of 1.6 the breaks lie at ends of 200 equal steps: steps
  !> with constant coefficients are exact, at any damping. The other schemes are not.
  subroutine constant_coefficients(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: zeta(3) = [0.2_dp, 1.0_dp, 1.7_dp]
    type(oscillator_t) :: osc
    type(point_t) :: truth, point
    integer :: i

    do i = 1, size(zeta)
      osc = mesh_of(1.6_dp, [400.0_dp], none, zeta(i))
      call solve(osc, 9000.0_dp, exactly(), truth)
      call solve(osc, 9000.0_dp, in_steps(scheme_constant, 200), point)
      call check_true(t, 'full contact', .not. truth%steady%partial)
      associate (name => ', damping ratio '//str(zeta(i)))
        call check_close(t, 'multiplier'//name, point%steady%multiplier, truth%steady%multiplier, absolute=1e-10_dp)
        call check_close(t, 'state'//name, maxval(abs(point%steady%state - truth%steady%state))/osc%static_deflection, 0.0_dp, &
                         absolute=1e-8_dp)
      end associate
      call solve(osc, 9000.0_dp, in_steps(scheme_rk4, 50), point)
      call check_true(t, 'Runge-Kutta errs', maxval(abs(point%steady%state - truth%steady%state)) > 1e-8_dp*osc%static_deflection)
    end do
  end subroutine constant_coefficients

  !> One period from random states, with friction, coast contact and changes of contact, in very many steps: end, largest
  !> load and what was in contact are those with events located.
  subroutine one_period(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: starts = 30
    type(oscillator_t) :: osc
    type(period_map_t) :: map(0:3)
    type(period_t) :: truth, run
    type(random_t) :: random
    type(error_t), allocatable :: error
    real(dp) :: duration, start(2), worst(3)
    integer :: i, m, coasts, unlike

    osc = mesh_of(1.6_dp, [400.0_dp, 30.0_dp, -110.0_dp], [8.0_dp, 8.0_dp], 0.08_dp, 0.1_dp)
    osc%has_backlash = .true.
    osc%backlash = 0.3_dp*osc%static_deflection
    call make_oscillator(osc, error)
    call discretise(osc, resolution_t(100.0_dp), map(0))
    do m = 1, 3
      call discretise(osc, resolution_t(40000.0_dp, scheme=schemes(m)), map(m))
    end do
    worst = 0
    coasts = 0
    unlike = 0
    do i = 1, starts
      duration = mesh_period(25, random%between(6000.0_dp, 15000.0_dp))
      start = osc%static_deflection*[random%between(-1.0_dp, 2.0_dp), random%between(-6.0_dp, 6.0_dp)]
      call set_durations(map(0), [duration])
      call run_period(map(0), start, truth)
      if (truth%coast) coasts = coasts + 1
      do m = 1, 3
        call set_durations(map(m), [duration])
        call run_period(map(m), start, run)
        worst(m) = max(worst(m), maxval(abs(run%state - truth%state))/osc%static_deflection, &
                       abs(run%peak - truth%peak)/osc%load)
        if ((run%coast .neqv. truth%coast) .or. (run%partial .neqv. truth%partial)) unlike = unlike + 1
      end do
    end do
    do m = 1, 3
      call check_close(t, 'scheme '//str(schemes(m)), worst(m), 0.0_dp, absolute=2e-3_dp)
    end do
    call check_true(t, 'the coast sides touch in some', 4*coasts >= starts, str(coasts))
    call check_true(t, 'contact is told alike', unlike <= 2, str(unlike))
  end subroutine one_period

  !> Estimates of rk4 cover the error, also where contact changes; those of equal steps are not known, and say so.
  subroutine estimates(t)
    type(tally_t), intent(inout) :: t
    integer :: k
    real(dp), parameter :: rpm(40) = [(3000 + 400.0_dp*k, k=1, 40)]
    type(sweep_t) :: truth, sweep
    type(sweep_options_t) :: options
    type(error_t), allocatable :: error
    type(oscillator_t) :: osc(3)
    logical, allocatable :: both(:, :)
    real(dp), allocatable :: off(:, :)
    real(dp) :: covered
    integer :: i

    osc = [mesh_of(1.6_dp, [400.0_dp, 30.0_dp, -110.0_dp], none, 0.1_dp), &
           mesh_of(1.6_dp, [400.0_dp, 30.0_dp, -110.0_dp], [8.0_dp, 6.0_dp], 0.1_dp), &
           mesh_of(1.6_dp, [400.0_dp, 30.0_dp, -110.0_dp], [20.0_dp, 20.0_dp], 0.1_dp)]
    options%direction = each
    options%accuracy = exactly()
    call run_sweep(osc, rpm, options, truth, error)
    options%accuracy = in_steps(scheme_rk4, 200)
    call run_sweep(osc, rpm, options, sweep, error)
    both = has_result(truth%status) .and. has_result(sweep%status) .and. truth%contact == sweep%contact .and. &
           .not. ieee_is_nan(sweep%estimate)
    off = merge(abs(sweep%dynamic_factor - truth%dynamic_factor), 0.0_dp, both)
    associate (estimate => merge(sweep%estimate, 0.0_dp, both), full => both .and. truth%contact == contact_full)
      covered = count(both .and. off <= estimate)/real(count(both), dp)
      call check_true(t, 'most points are found', count(both) >= 100, str(count(both)))
      call check_true(t, 'contact changes in many', count(both .and. .not. full) >= 20)
      call check_true(t, 'the error is within its estimate', covered >= 0.95_dp, str(covered))
      call check_true(t, 'the estimate is no more than it need be', 2*count(full .and. off > estimate/30) >= count(full))
    end associate
    do i = 2, 3
      options%accuracy = in_steps(schemes(i), 200)
      call run_sweep(osc, rpm, options, sweep, error)
      call check_true(t, 'not known', all(ieee_is_nan(sweep%estimate)) .and. .not. any(sweep%status == status_inexact))
      call check_true(t, 'so many steps', all(sweep%steps == 200 .or. .not. has_result(sweep%status)))
    end do
  end subroutine estimates

  !> The same bits for any number of threads, along a branch and with contact lost.
  subroutine threads(t)
    type(tally_t), intent(inout) :: t
    integer :: k
    real(dp), parameter :: rpm(60) = [(6000 + 150.0_dp*k, k=1, 60)]
    type(sweep_options_t) :: options
    type(sweep_t) :: one, three
    type(error_t), allocatable :: error
    type(oscillator_t) :: osc(2)
    integer :: m

    osc = [mesh_of(1.6_dp, [400.0_dp, 30.0_dp, -110.0_dp], [4.0_dp, 4.0_dp], 0.05_dp), &
           mesh_of(1.6_dp, [400.0_dp, 30.0_dp, -110.0_dp], [20.0_dp, 20.0_dp], 0.1_dp)]
    do m = 1, 3
      options%accuracy = in_steps(schemes(m), 100)
      options%threads = 1
      call run_sweep(osc, rpm, options, one, error)
      options%threads = 3
      call run_sweep(osc, rpm, options, three, error)
      call check_true(t, 'some lose contact', any(one%contact > contact_full))
      call check_true(t, 'scheme '//str(schemes(m)), all(one%status == three%status) .and. &
                      all(transfer(one%dynamic_factor, 0_int64, size(one%status)) == &
                          transfer(three%dynamic_factor, 0_int64, size(one%status))))
    end do
  end subroutine threads

  !> From rest until the motion repeats, as the papers have it, comes to what Newton's method finds.
  subroutine marched(t)
    type(tally_t), intent(inout) :: t
    type(oscillator_t) :: osc
    type(accuracy_t) :: options
    type(point_t) :: shot, point
    integer :: m

    osc = mesh_of(1.6_dp, [400.0_dp, 30.0_dp, -110.0_dp], [2.0_dp, 2.0_dp], 0.17_dp)
    do m = 1, 3
      options = in_steps(schemes(m), 200)
      call solve(osc, 8000.0_dp, options, shot)
      options%steady%method = by_marching
      options%steady%tolerance = 1e-4_dp
      call solve(osc, 8000.0_dp, options, point)
      call check_close(t, 'scheme '//str(schemes(m)), point%dynamic_factor, shot%dynamic_factor, absolute=1e-5_dp)
      call check_close(t, 'multiplier by scheme '//str(schemes(m)), point%steady%multiplier, shot%steady%multiplier, &
                       absolute=1e-4_dp)
    end do
  end subroutine marched

  !> Dogan et al. 2021, case 1 without relief, by their method: dynamic factors 1.25 at 1600 rpm, about 1.30 in the first
  !> resonance and 1.48 in the second, as printed; 200 points of a period are those of Karpat et al. 2012. The stiffness
  !> is a polynomial through that by finite elements, which the papers print in pictures only.
  subroutine published(t)
    type(tally_t), intent(inout) :: t
    type(oscillator_t) :: osc
    type(sweep_options_t) :: options
    type(sweep_t) :: sweep
    type(error_t), allocatable :: error
    integer :: k
    real(dp), parameter :: rpm(197) = [(400 + 100.0_dp*k, k=0, 196)]

    osc = mesh_of(1.611651_dp, [422.71_dp, 0.0_dp, -148.96_dp, 0.0_dp, 12.77_dp], none, 0.17_dp)
    osc%mass = 0.8113_dp
    osc%load = 7010.4_dp
    call make_oscillator(osc, error)
    options%accuracy%scheme = scheme_rk4_equal
    call run_sweep([osc], rpm, options, sweep, error)
    associate (factor => sweep%dynamic_factor(:, 1))
      call check_close(t, 'at 1600 rpm', factor(13), 1.25_dp, absolute=0.03_dp)
      call check_close(t, 'first resonance', maxval(factor, mask=rpm > 5500 .and. rpm < 9000), 1.30_dp, absolute=0.03_dp)
      call check_close(t, 'second resonance', maxval(factor), 1.48_dp, absolute=0.03_dp)
      call check_true(t, 'at twice the speed of the first', rpm(maxloc(factor, 1)) > 12000 .and. rpm(maxloc(factor, 1)) < 16000)
    end associate
  end subroutine published

  type(accuracy_t) function exactly() result(options)
    options%steady%tolerance = 1e-11_dp
  end function exactly

  type(accuracy_t) function in_steps(scheme, steps) result(options)
    integer, intent(in) :: scheme, steps

    options%scheme = scheme
    options%steps = steps
  end function in_steps
end module test_methods
