!> Error estimates from both sides: neither too small nor too large against errors that closed forms tell; how
!> exact the optimum is; what a point says of itself where its motion repeats after several periods; the
!> largest load of every pair while contact changes.
module test_estimate_closed_forms
  use gearsweep_base_kinds, only: dp, pi
  use gearsweep_base_error, only: error_t
  use gearsweep_motion_coefficients, only: coefficients_t, tabulate
  use gearsweep_motion_resolution, only: resolution_t
  use gearsweep_motion_contact_set, only: period_t
  use gearsweep_motion_error_estimate, only: accuracy_t, levels_t, point_t, work_of
  use gearsweep_motion_operating_point, only: solve_point
  use gearsweep_motion_gauss, only: batch_size
  use gearsweep_motion_load_peaks, only: may_exceed
  use gearsweep_motion_optimum, only: find_optimum, optimum_t
  use gearsweep_motion_oscillator, only: mesh_period, oscillator_t
  use gearsweep_motion_period, only: run_batch, run_period
  use gearsweep_motion_period_map, only: discretise, period_map_t, set_durations
  use gearsweep_motion_periodic_orbit, only: shoot, solve_full_contact, steady_t
  use gearsweep_motion_poincare, only: sample_section, section_points_t
  use gearsweep_motion_sweep, only: each, run_sweep, sweep_options_t, sweep_t
  use gearsweep_base_text, only: str
  use test_support_random_numbers, only: random_t
  use test_support_solve_one_point, only: mesh_of, solve
  use test_graded_steps, only: closed_form
  use test_support_testing, only: check_close, check_equal, check_no_error, check_true, tally_t
  implicit none
  private
  public :: run, median

  real(dp), parameter :: none(2) = 0, ratio = 1.6_dp

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t

    if (t%wants('against_closed_form')) call against_closed_form(t)
    if (t%wants('optimum_lies_within')) call optimum_lies_within(t)
    if (t%wants('optimum_without_answers')) call optimum_without_answers(t)
    if (t%wants('two_periods_of_one')) call two_periods_of_one(t)
    if (t%wants('loads_while_contact_changes')) call loads_while_contact_changes(t)
    if (t%wants('steps_that_are_told')) call steps_that_are_told(t)
    if (t%wants('derivative_of_a_period')) call derivative_of_a_period(t)
    if (t%wants('speeds_side_by_side')) call speeds_side_by_side(t)
    if (t%wants('stroboscopic_points')) call stroboscopic_points(t)
    if (t%wants('many_bounces')) call many_bounces(t)
    if (t%wants('loads_within_steps')) call loads_within_steps(t)
    if (t%wants('growth_of_a_disturbance')) call growth_of_a_disturbance(t)
  end subroutine run

  !> Concave loads -sqrt((u - c)^2 + w^2) over a step, almost a kink at c, whose largest is -w: none is left out as too low.
  subroutine loads_within_steps(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: w = 1e-3_dp, u(2) = [0.0_dp, 1.0_dp]
    real(dp) :: load(0:2, 2), c
    integer :: i

    do i = 1, 9
      c = 0.1_dp*i
      load(0, :) = -hypot(u - c, w)
      load(1, :) = (u - c)/load(0, :)
      load(2, :) = w**2/load(0, :)**3
      call check_true(t, 'a load within a step, at '//str(c), may_exceed(load, -2*w))
      call check_true(t, 'nor is one kept that is low, at '//str(c), .not. may_exceed(load, 1.0_dp))
    end do
  end subroutine loads_within_steps

  !> Piecewise constant stiffness. A result of sixth order errs by 1/63 of its difference to half the steps; the
  !> estimate says 1/20 of it, so that the error is 20/63 = 0.32 of it. In graded steps it is raised three times
  !> more, to 0.11, as the order may sink to the third: 20/(3*7) = 0.95.
  subroutine against_closed_form(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: dampings = 12, speeds = 20
    type(oscillator_t) :: osc
    type(accuracy_t) :: options
    type(point_t) :: point
    real(dp) :: dynamic_factor, multiplier, zeta, rpm, error, found(dampings*speeds, 2)
    integer :: i, k, kind, n(2)

    options%steady%tolerance = 1e-5_dp
    n = 0
    do i = 1, dampings
      zeta = 0.03_dp*1.7_dp**(i - 1)
      osc = mesh_of(ratio, [400.0_dp], none, zeta)
      do k = 1, speeds
        rpm = 0.01_dp*2.1_dp**(k - 1)
        call solve(osc, rpm, options, point)
        ! The closed form is that of pairs in contact; what is near rounding has no ratio.
        if (point%steady%partial) cycle
        call closed_form(osc%natural_frequency, zeta, mesh_period(25, rpm), dynamic_factor, multiplier)
        error = abs(point%dynamic_factor - dynamic_factor)
        if (error < 2e-12_dp) cycle
        kind = merge(2, 1, point%resolution%graded_for > 0)
        n(kind) = n(kind) + 1
        found(n(kind), kind) = error/point%estimate
      end do
    end do
    call check_true(t, 'points with equal and with graded steps', all(n >= 20), str(n(1))//' and '//str(n(2)))
    call check_close(t, 'equal steps: error over estimate, median', median(found(:n(1), 1)), 20/63.0_dp, 0.5_dp)
    call check_close(t, 'graded steps: error over estimate, median', median(found(:n(2), 2)), 20/189.0_dp, 0.5_dp)
    call check_close(t, 'graded steps: error over estimate, largest', maxval(found(:n(2), 2)), 20/21.0_dp, 0.2_dp)
  end subroutine against_closed_form

  !> Half of the values lie below.
  pure real(dp) function median(values)
    real(dp), intent(in) :: values(:)
    integer :: i

    median = 0
    do i = 1, size(values)
      if (count(values < values(i)) <= size(values)/2 .and. count(values <= values(i)) > size(values)/2) median = values(i)
    end do
  end function median

  subroutine build(context, amount, motion, error)
    class(*), intent(in) :: context
    real(dp), intent(in) :: amount
    type(oscillator_t), intent(out) :: motion
    type(error_t), allocatable, intent(out) :: error

    select type (context)
    type is (real(dp))
      motion = mesh_of(ratio, [400.0_dp, 0.0_dp, -110.0_dp], amount*[1e6_dp, 1e6_dp], context)
    end select
  end subroutine build

  !> A curve with one valley has its least between the neighbours of the lowest point: so exact is the optimum,
  !> and no more. A fine scan finds nothing lower elsewhere.
  subroutine optimum_lies_within(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: scan = 60
    real(dp), parameter :: rpm(5) = [6000, 7000, 8000, 13000, 15000], largest = 30e-6_dp
    type(optimum_t) :: optimum
    type(oscillator_t) :: osc(0:scan)
    type(sweep_options_t) :: options
    type(sweep_t) :: sweep
    type(error_t), allocatable :: error
    integer :: i, best

    call find_optimum(build, 0.17_dp, largest, rpm, options, optimum, error)
    call check_no_error(t, 'optimum', error)
    best = optimum%best
    associate (amount => optimum%amount)
      call check_true(t, 'ascending', all(amount(2:) > amount(:size(amount) - 1)))
      call check_true(t, 'from none to the largest', abs(amount(1)) < 1e-15_dp .and. abs(amount(size(amount)) - largest) < 1e-15_dp)
      call check_true(t, 'the best lies inside', best > 1 .and. best < size(amount))
      call check_close(t, 'as exact as its neighbours are near', optimum%resolution, &
                       max(amount(best + 1) - amount(best), amount(best) - amount(best - 1)), 1e-6_dp)
      do i = 0, scan
        call build(0.17_dp, largest*i/scan, osc(i), error)
      end do
      options%direction = each
      call run_sweep(osc, rpm, options, sweep, error)
      call check_no_error(t, 'scan', error)
      call check_true(t, 'nothing is lower', optimum%dynamic_factor(best) <= minval(maxval(sweep%dynamic_factor, 1)) + 1e-5_dp)
      i = minloc(maxval(sweep%dynamic_factor, 1), 1) - 1
      call check_close(t, 'the scan finds it, too', amount(best), largest*i/scan, absolute=largest/scan)
    end associate
  end subroutine optimum_lies_within

  !> Speeds too slow for the steps given have no answer: all are counted, and there is no best.
  subroutine optimum_without_answers(t)
    type(tally_t), intent(inout) :: t
    type(optimum_t) :: optimum
    type(sweep_options_t) :: options
    type(error_t), allocatable :: error

    options%accuracy%steps = 12
    call find_optimum(build, 0.17_dp, 30e-6_dp, [1.0_dp, 2.0_dp, 3.0_dp], options, optimum, error)
    call check_no_error(t, 'no answers', error)
    call check_equal(t, 'no best', optimum%best, 0)
    call check_true(t, 'all failed', all(optimum%failed == 3))
    call find_optimum(build, 0.17_dp, 30e-6_dp, [1.0_dp, 9000.0_dp], options, optimum, error)
    call check_true(t, 'one failed', optimum%best > 0 .and. all(optimum%failed == 1))
    call check_true(t, 'the other counts', all(abs(optimum%rpm - 9000) < 1e-9_dp))
  end subroutine optimum_without_answers

  !> A motion that repeats every period repeats after two and three, too: the same state, peak and checksum,
  !> which is a mean over the periods; multipliers multiply.
  subroutine two_periods_of_one(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: rpm(3) = [3000, 7000, 12000]
    type(oscillator_t) :: osc
    type(period_map_t) :: map
    type(steady_t) :: one, more
    real(dp) :: duration
    integer :: i, periods

    osc = mesh_of(ratio, [400.0_dp, 30.0_dp, -110.0_dp], [2.0_dp, 3.0_dp], 0.17_dp)
    call discretise(osc, resolution_t(40.0_dp, 2), map)
    do i = 1, size(rpm)
      duration = mesh_period(25, rpm(i))
      call set_durations(map, [duration])
      call shoot(map, 1e-8_dp, 1, [osc%mean_deflection, 0.0_dp], one)
      do periods = 2, 3
        call set_durations(map, [duration])
        call shoot(map, 1e-8_dp, periods, one%state, more)
        call check_equal(t, 'periods', more%periods, periods)
        call check_close(t, 'checksum', more%checksum, one%checksum, 1e-9_dp)
        call check_close(t, 'peak', more%peak, one%peak, 1e-9_dp)
        call check_close(t, 'multiplier', more%multiplier, one%multiplier**periods, 1e-7_dp)
      end do
      associate (deflections => one%checksum/osc%static_deflection)
        call check_true(t, 'the checksum is a sum of deflections', deflections > 1 .and. deflections < 10)
      end associate
    end do
  end subroutine two_periods_of_one

  !> From random states, many without full contact, over a period in few steps: end and largest load of a pair
  !> as tiny steps of the classical Runge-Kutta method find them.
  subroutine loads_while_contact_changes(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: starts = 1000
    type(oscillator_t) :: osc
    type(period_map_t) :: map
    type(period_t) :: run
    type(random_t) :: random
    real(dp) :: duration, start(2), state(2), peak(2), worst(2)
    integer :: i, changed, second

    osc = mesh_of(ratio, [400.0_dp, 30.0_dp, -110.0_dp], [14.0_dp, 14.0_dp], 0.08_dp)
    worst = 0
    changed = 0
    second = 0
    do i = 1, starts
      duration = mesh_period(25, random%between(4000.0_dp, 15000.0_dp))
      start = osc%static_deflection*[random%between(-1.0_dp, 2.0_dp), random%between(-6.0_dp, 6.0_dp)]
      ! So few that a pair may touch and have its largest load within one step: two radians of the natural motion.
      call discretise(osc, resolution_t(osc%natural_frequency*duration/2, 1), map)
      call set_durations(map, [duration])
      call run_period(map, start, run)
      if (run%failed) cycle
      call small_steps(osc, duration, start, state, peak)
      if (run%events > 0) changed = changed + 1
      if (run%events > 0 .and. peak(2) > peak(1)) second = second + 1
      worst(1) = max(worst(1), abs(run%peak - maxval(peak))/osc%load)
      worst(2) = max(worst(2), abs(run%state(1) - state(1))/osc%static_deflection)
    end do
    call check_close(t, 'largest loads', worst(1), 0.0_dp, absolute=3e-3_dp)
    call check_close(t, 'ends', worst(2), 0.0_dp, absolute=1e-2_dp)
    call check_true(t, 'contact changes in most', changed >= starts/2, str(changed))
    call check_true(t, 'the second pair has the largest load in some', second >= 3, str(second))
  end subroutine loads_while_contact_changes

  !> x'' = w^2 (F/m - sum k gap/m) - 2 zeta w x', the sums over the pairs that touch, whose stiffness over the
  !> mass is the square of w as well; time in periods. Peaks of the pair that goes and of the one that comes.
  subroutine small_steps(osc, duration, start, state, peak)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration, start(2)
    real(dp), intent(out) :: state(2), peak(2)
    integer, parameter :: steps = 2000
    real(dp) :: h, time, k(2, 4), load(2)
    integer :: i

    h = 1.0_dp/steps
    state = start
    call loads(osc, 0.0_dp, state(1), load)
    peak = max(0.0_dp, load)
    do i = 1, steps
      time = (i - 1)*h
      k(:, 1) = slope(osc, duration, time, state)
      k(:, 2) = slope(osc, duration, time + h/2, state + h/2*k(:, 1))
      k(:, 3) = slope(osc, duration, time + h/2, state + h/2*k(:, 2))
      k(:, 4) = slope(osc, duration, time + h*(1 - 1e-12_dp), state + h*k(:, 3))
      state = state + h*(k(:, 1) + 2*k(:, 2) + 2*k(:, 3) + k(:, 4))/6
      call loads(osc, time + h*(1 - 1e-12_dp), state(1), load)
      peak = max(peak, load)
    end do
  end subroutine small_steps

  !> Of the pair that came at phase 0, and of the one before; stiffness and relief of `mesh_of`, as stated there.
  subroutine loads(osc, phase, x, load, stiffness)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: phase, x
    real(dp), intent(out) :: load(2)
    real(dp), intent(out), optional :: stiffness(2)
    real(dp) :: s(2), k(2)
    integer :: j

    s = phase + [0, 1]
    load = 0
    k = 0
    do j = 1, 2
      if (s(j) > ratio) cycle
      k(j) = osc%mesh%stiffness%value(s(j))
      load(j) = max(0.0_dp, k(j)*(x - osc%mesh%profile_error%value(s(j))))
      if (.not. load(j) > 0) k(j) = 0
    end do
    if (present(stiffness)) stiffness = k
  end subroutine loads

  function slope(osc, duration, phase, state)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration, phase, state(2)
    real(dp) :: slope(2), load(2), stiffness(2), inverse_mass

    inverse_mass = sum(1/osc%mass)
    call loads(osc, phase, state(1), load, stiffness)
    slope(1) = state(2)
    slope(2) = duration**2*inverse_mass*(osc%load - sum(load)) &
               - 2*osc%damping_ratio*duration*sqrt(inverse_mass*sum(stiffness))*state(2)
  end function slope

  !> The steps of a point are those of its table: as many as asked for and what the breaks add, or the number that
  !> the resolution makes.
  subroutine steps_that_are_told(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: rpm(3) = [0.5_dp, 5000.0_dp, 9000.0_dp]
    type(oscillator_t) :: osc
    type(accuracy_t) :: options
    type(point_t) :: point
    type(levels_t), allocatable :: levels
    type(coefficients_t) :: table
    integer :: i

    osc = mesh_of(ratio, [400.0_dp, 0.0_dp, -110.0_dp], none, 0.03_dp)
    do i = 1, size(rpm)
      call solve(osc, rpm(i), options, point)
      call tabulate(osc, point%resolution, table)
      call check_equal(t, 'steps chosen at '//str(rpm(i)), point%steps, table%steps)
    end do
    options%steps = 300
    allocate (levels)
    call solve_point(osc, mesh_period(osc%mesh%teeth(1), 9000.0_dp), options, levels, point)
    call check_true(t, 'steps asked for', point%steps >= 300 .and. point%steps <= 304, str(point%steps))
    call check_true(t, 'work counts both solutions', work_of(levels) >= 450, str(work_of(levels)))
  end subroutine steps_that_are_told

  !> The derivative of a period by its start is that of small differences, where pairs part and touch, too; and
  !> what the map was used for before, here a motion in contact, changes nothing.
  subroutine derivative_of_a_period(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: starts = 40
    real(dp), parameter :: h = 1e-5_dp
    type(oscillator_t) :: osc
    type(period_map_t) :: map, used
    type(period_t) :: run, again, above, below
    type(steady_t) :: steady
    type(random_t) :: random
    real(dp) :: duration, start(2), unit(2), ignored(2), difference(2, 2), worst(2)
    integer :: i, k, changed

    osc = mesh_of(ratio, [400.0_dp, 30.0_dp, -110.0_dp], [14.0_dp, 14.0_dp], 0.08_dp)
    worst = 0
    changed = 0
    do i = 1, starts
      duration = mesh_period(25, random%between(4000.0_dp, 15000.0_dp))
      call discretise(osc, resolution_t(2*osc%natural_frequency*duration, 1), map)
      used = map
      unit = osc%static_deflection*[1.0_dp, osc%natural_frequency*duration]
      start = unit*[random%between(0.2_dp, 2.0_dp), random%between(-0.5_dp, 0.5_dp)]
      call set_durations(map, [duration])
      call run_period(map, start, run)
      call set_durations(used, [duration])
      call solve_full_contact(used, ignored, steady)
      call run_period(used, start, again)
      worst(1) = max(worst(1), maxval(abs(again%state - run%state)/unit), abs(again%peak - run%peak)/osc%load, &
                     maxval(abs(again%monodromy - run%monodromy)*spread(unit, 1, 2)/spread(unit, 2, 2)))
      do k = 1, 2
        call run_period(map, start + h*unit*[2 - k, k - 1], above)
        call run_period(map, start - h*unit*[2 - k, k - 1], below)
        difference(:, k) = (above%state - below%state)/(2*h*unit(k))
      end do
      if (run%failed .or. above%events /= run%events .or. below%events /= run%events) cycle
      if (run%events > 0) changed = changed + 1
      worst(2) = max(worst(2), maxval(abs(difference - run%monodromy)*spread(unit, 1, 2)/spread(unit, 2, 2)))
    end do
    call check_true(t, 'contact changes', changed >= starts/4, str(changed))
    call check_close(t, 'map used before', worst(1), 0.0_dp, absolute=1e-10_dp)
    call check_close(t, 'derivative', worst(2), 0.0_dp, absolute=1e-3_dp)
  end subroutine derivative_of_a_period

  !> Several periods side by side are each what it is alone, with all that is told of it, while contact changes.
  subroutine speeds_side_by_side(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: groups = 60
    type(oscillator_t) :: osc
    type(period_map_t) :: map, alone
    type(period_t) :: run, all(batch_size)
    type(random_t) :: random
    real(dp) :: duration(batch_size), start(2, batch_size), worst
    integer :: i, l, changed, unlike

    osc = mesh_of(ratio, [400.0_dp, 30.0_dp, -110.0_dp], [14.0_dp, 14.0_dp], 0.08_dp)
    call discretise(osc, resolution_t(8.0_dp, 1), map)
    alone = map
    worst = 0
    changed = 0
    unlike = 0
    do i = 1, groups
      do l = 1, batch_size
        duration(l) = mesh_period(25, random%between(6000.0_dp, 15000.0_dp))
        start(:, l) = osc%static_deflection*[random%between(-1.0_dp, 2.0_dp), random%between(-6.0_dp, 6.0_dp)]
      end do
      call set_durations(map, duration)
      call run_batch(map, start, [(.true., l=1, batch_size)], .true., all)
      do l = 1, batch_size
        call set_durations(alone, duration(l:l))
        call run_period(alone, start(:, l), run)
        worst = max(worst, maxval(abs(all(l)%state - run%state))/osc%static_deflection, &
                    maxval(abs(all(l)%monodromy - run%monodromy)), &
                    abs(all(l)%peak - run%peak)/osc%load, abs(all(l)%checksum - run%checksum)/osc%static_deflection)
        if (run%events > 0) changed = changed + 1
        if (all(l)%events /= run%events .or. (all(l)%partial .neqv. run%partial) .or. (all(l)%lost .neqv. run%lost) &
            .or. (all(l)%failed .neqv. run%failed)) unlike = unlike + 1
      end do
    end do
    call check_true(t, 'contact changes at many speeds', changed > groups*batch_size/2, str(changed))
    call check_equal(t, 'events of a speed of the batch', unlike, 0)
    call check_close(t, 'motion of a speed of the batch', worst, 0.0_dp, absolute=1e-9_dp)
  end subroutine speeds_side_by_side

  !> A transient that has died out shows the steady motion once a period, to some 1e-9 by its steps.
  subroutine stroboscopic_points(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: rpm(3) = [3000, 7000, 14000]
    type(oscillator_t) :: osc
    type(accuracy_t) :: options
    type(point_t) :: point
    type(section_points_t) :: section
    real(dp) :: worst
    integer :: i

    osc = mesh_of(ratio, [400.0_dp, 30.0_dp, -110.0_dp], [2.0_dp, 3.0_dp], 0.17_dp)
    options%steady%tolerance = 1e-11_dp
    call sample_section(osc, rpm, 60, 8, section)
    worst = 0
    do i = 1, size(rpm)
      call solve(osc, rpm(i), options, point)
      worst = max(worst, maxval(abs(section%x(:, i) - point%steady%state(1)))/osc%static_deflection)
    end do
    call check_close(t, 'stroboscopic points', worst, 0.0_dp, absolute=4e-9_dp)
  end subroutine stroboscopic_points

  !> Without damping a pair that was thrown out of contact bounces on: in a long period contact changes more than a
  !> thousand times, and that is no chatter.
  subroutine many_bounces(t)
    type(tally_t), intent(inout) :: t
    type(oscillator_t) :: osc
    type(period_map_t) :: map
    type(period_t) :: run
    real(dp) :: duration

    osc = mesh_of(ratio, [400.0_dp], none, 0.0_dp)
    duration = mesh_period(25, 15.0_dp)
    call discretise(osc, resolution_t(osc%natural_frequency*duration, 1), map)
    call set_durations(map, [duration])
    call run_period(map, [-2*osc%static_deflection, 0.0_dp], run)
    call check_true(t, 'no chatter', .not. run%failed)
    call check_true(t, 'more than a thousand changes', run%events > 1100, str(run%events))
  end subroutine many_bounces

  !> Much damped, both multipliers of piecewise constant stiffness are real: soon every disturbance shrinks by the
  !> larger one, whose logarithm is the exponent.
  subroutine growth_of_a_disturbance(t)
    type(tally_t), intent(inout) :: t
    type(oscillator_t) :: osc
    type(section_points_t) :: section
    real(dp) :: dynamic_factor, multiplier

    osc = mesh_of(ratio, [400.0_dp], none, 1.5_dp)
    call sample_section(osc, [20000.0_dp], 40, 8, section)
    call closed_form(osc%natural_frequency, 1.5_dp, mesh_period(25, 20000.0_dp), dynamic_factor, multiplier)
    call check_close(t, 'exponent', section%exponent(1), log(multiplier), 1e-6_dp)
    call check_equal(t, 'it repeats every period', section%periods(1), 1)
  end subroutine growth_of_a_disturbance
end module test_estimate_closed_forms
