!> Steps that grow behind the breaks: slow and heavily damped motions against closed forms and equal steps.
module test_graded_steps
  use, intrinsic :: iso_fortran_env, only: int64
  use gearsweep_base_kinds, only: dp, pi
  use gearsweep_base_error, only: error_t
  use gearsweep_motion_error_estimate, only: accuracy_t, levels_t, point_t, work_of
  use gearsweep_motion_operating_point, only: solve_point
  use gearsweep_motion_oscillator, only: make_oscillator, mesh_period, oscillator_t
  use gearsweep_motion_periodic_orbit, only: largest_multiplier
  use gearsweep_motion_response, only: find_response, response_t
  use gearsweep_motion_sweep, only: run_sweep, sweep_options_t, sweep_t
  use gearsweep_mesh_sharing, only: share_load, sharing_t
  use gearsweep_motion_steady_motion, only: status_ok
  use gearsweep_base_text, only: str
  use test_support_reference_rows, only: next_row, oscillator_of, row_of, row_t
  use test_support_solve_one_point, only: mesh_of, solve
  use test_support_testing, only: tally_t, check_true, check_close, check_equal, check_no_error
  implicit none
  private
  public :: run, closed_form

  real(dp), parameter :: none(2) = 0, ratio = 1.6_dp

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t

    if (t%wants('piecewise_constant')) call piecewise_constant(t)
    if (t%wants('slow_limit')) call slow_limit(t)
    if (t%wants('as_equal_steps')) call as_equal_steps(t)
    if (t%wants('bounded_steps')) call bounded_steps(t)
    if (t%wants('same_bits')) call same_bits(t)
    if (t%wants('slow_path_of_a_pair')) call slow_path_of_a_pair(t)
    if (t%wants('parted_pairs')) call parted_pairs(t)
    if (t%wants('creeping_with_relief')) call creeping_with_relief(t)
  end subroutine run

  !> Constant pair stiffness, where the motion has a closed form: dynamic factor within the tolerance, and the
  !> multiplier; within twice the estimate but for one in twenty, as errors of two tables may be the same by chance.
  subroutine piecewise_constant(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: zeta(8) = [0.05_dp, 0.1_dp, 0.17_dp, 0.4_dp, 0.7_dp, 1.5_dp, 50.0_dp, 1000.0_dp], &
                           rpm(6) = [1e-6_dp, 1e-3_dp, 1.0_dp, 30.0_dp, 300.0_dp, 1000.0_dp]
    type(oscillator_t) :: osc
    type(accuracy_t) :: options
    type(point_t) :: point
    real(dp) :: dynamic_factor, multiplier
    character(:), allocatable :: name
    integer :: i, k, misses

    options%steady%tolerance = 1e-9_dp
    misses = 0
    do i = 1, size(zeta)
      osc = mesh_of(ratio, [400.0_dp], none, zeta(i))
      do k = 1, size(rpm)
        name = 'zeta '//str(zeta(i))//', '//str(rpm(k))//' rpm'
        call closed_form(osc%natural_frequency, zeta(i), mesh_period(25, rpm(k)), dynamic_factor, multiplier)
        call solve(osc, rpm(k), options, point)
        call check_equal(t, name//': status', point%steady%status, status_ok)
        call check_close(t, name, point%dynamic_factor, dynamic_factor, absolute=1e-9_dp)
        if (abs(point%dynamic_factor - dynamic_factor) > 2*point%estimate + 1e-12_dp) misses = misses + 1
        call check_true(t, name//': kept', point%estimate <= options%steady%tolerance)
        call check_close(t, name//': multiplier', point%steady%multiplier, multiplier, absolute=1e-8_dp)
        if (rpm(k) <= 1) call check_true(t, name//': graded', point%resolution%graded_for > 0)
      end do
    end do
    call check_true(t, 'estimates', misses <= size(zeta)*size(rpm)/20.0_dp, str(misses))
  end subroutine piecewise_constant

  !> Two pairs over 0.6 of the period, one over the rest, each of the same constant stiffness, whose mean
  !> gives the natural frequency `natural`; load and pair stiffness are the units.
  subroutine closed_form(natural, zeta, duration, dynamic_factor, multiplier)
    real(dp), intent(in) :: natural, zeta, duration
    real(dp), intent(out) :: dynamic_factor, multiplier
    real(dp) :: w(2), rest(2), time(2), m(2, 2, 2), a(2, 2), b(2), start(2), state(2)
    integer :: i

    w = natural*sqrt([2.0_dp, 1.0_dp]/ratio)
    rest = [0.5_dp, 1.0_dp]
    time = duration*[ratio - 1, 2 - ratio]
    m(:, :, 1) = transition(w(1), zeta, time(1))
    m(:, :, 2) = transition(w(2), zeta, time(2))
    ! The second smooth interval after the first leads back: start = a start + b.
    a = matmul(m(:, :, 2), m(:, :, 1))
    b = matmul(m(:, :, 2), [rest(1) - rest(2), 0.0_dp] - m(:, 1, 1)*rest(1)) + [rest(2), 0.0_dp]
    multiplier = largest_multiplier(a)
    start = matmul(reshape([1 - a(2, 2), a(2, 1), a(1, 2), 1 - a(1, 1)], [2, 2]), b) &
            /((1 - a(1, 1))*(1 - a(2, 2)) - a(1, 2)*a(2, 1))
    dynamic_factor = 0
    do i = 1, 2
      state = start - [rest(i), 0.0_dp]
      dynamic_factor = max(dynamic_factor, start(1), rest(i) + highest(w(i), zeta, time(i), state))
      start = matmul(m(:, :, i), state) + [rest(i), 0.0_dp]
    end do
  end subroutine closed_form

  !> What a deviation from rest and its velocity become after a time.
  pure function transition(w, zeta, time) result(m)
    real(dp), intent(in) :: w, zeta, time
    real(dp) :: m(2, 2), turn, slow, fast, e(2)

    if (zeta < 1) then
      turn = w*sqrt(1 - zeta**2)
      e = exp(-zeta*w*time)*[cos(turn*time), sin(turn*time)/turn]
      m(:, 1) = [e(1) + zeta*w*e(2), -w**2*e(2)]
      m(:, 2) = [e(2), e(1) - zeta*w*e(2)]
    else
      fast = w*(zeta + sqrt(zeta**2 - 1))
      slow = w**2/fast
      e = exp(-[slow, fast]*time)/(fast - slow)
      m(:, 1) = [fast*e(1) - slow*e(2), -slow*fast*(e(1) - e(2))]
      m(:, 2) = [e(1) - e(2), fast*e(2) - slow*e(1)]
    end if
  end function transition

  !> The largest deviation at the first two turning points within the time.
  pure real(dp) function highest(w, zeta, time, state)
    real(dp), intent(in) :: w, zeta, time, state(2)
    real(dp) :: turn, slow, fast, part, places(2)
    integer :: i

    places = 0
    if (zeta < 1) then
      turn = w*sqrt(1 - zeta**2)
      places = (modulo(atan2(state(2)*turn, zeta*w*state(2) + w**2*state(1)), pi) + [0.0_dp, pi])/turn
    else
      fast = w*(zeta + sqrt(zeta**2 - 1))
      slow = w**2/fast
      part = slow*(state(2) + fast*state(1))/(fast*(state(2) + slow*state(1)))
      if (part > 0 .and. part < 1) places = -log(part)/(fast - slow)
    end if
    highest = -huge(highest)
    do i = 1, 2
      if (places(i) < time) highest = max(highest, dot_product(matmul([1.0_dp, 0.0_dp], transition(w, zeta, places(i))), state))
    end do
  end function highest

  !> Stiffness that varies, tips relieved: far below resonance the motion follows the static deflection, and
  !> overshoots the load where the second pair leaves, by its share: DF = 1 + (1 - K x/F) exp(-pi
  !> zeta/sqrt(1 - zeta^2)), K of the pair that stays, x of both. Nearer with the speed, as coefficients change
  !> meanwhile. With much damping nothing overshoots.
  subroutine slow_limit(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: coef(3) = [400.0_dp, 0.0_dp, -110.0_dp], zeta(4) = [0.1_dp, 0.6_dp, 3.0_dp, 100.0_dp]
    type(oscillator_t) :: osc
    type(accuracy_t) :: options
    type(point_t) :: point
    real(dp) :: stays, leaves, deflection, limit
    integer :: i, k

    stays = coef(1) + coef(3)*(2*(ratio - 1)/ratio - 1)**2
    leaves = coef(1) + coef(3)
    do i = 1, size(zeta)
      osc = mesh_of(ratio, coef, [2.0_dp, 2.0_dp], zeta(i))
      deflection = (7000 + leaves*2)/(stays + leaves)
      limit = 1
      if (zeta(i) < 1) limit = 1 + (1 - stays*deflection/7000)*exp(-pi*zeta(i)/sqrt(1 - zeta(i)**2))
      do k = 1, 3
        call solve(osc, 10.0_dp**(-2*k), options, point)
        call check_close(t, 'slow limit, zeta '//str(zeta(i)), point%dynamic_factor, limit, &
                         absolute=1e-6_dp + (1 + 2*zeta(i))*10.0_dp**(-2*k)/100)
        call check_true(t, 'within the tolerance', point%estimate <= options%steady%tolerance)
      end do
    end do
  end subroutine slow_limit

  !> Equal steps that see the natural motion everywhere give the same, with friction, relief and stiffness
  !> that varies.
  subroutine as_equal_steps(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: zeta(6) = [0.05_dp, 0.17_dp, 0.9_dp, 1.1_dp, 5.0_dp, 50.0_dp], &
                           rpm(6) = [20.0_dp, 60.0_dp, 60.0_dp, 60.0_dp, 200.0_dp, 2000.0_dp]
    integer, parameter :: steps(6) = [60000, 20000, 20000, 20000, 30000, 30000]
    type(oscillator_t) :: osc
    type(accuracy_t) :: options, equal
    type(point_t) :: one, other
    integer :: i

    options%steady%tolerance = 1e-9_dp
    do i = 1, size(zeta)
      osc = mesh_of(ratio, [400.0_dp, 30.0_dp, -110.0_dp, 20.0_dp], [2.0_dp, 3.0_dp], zeta(i), 0.06_dp)
      call solve(osc, rpm(i), options, one)
      equal%steps = steps(i)
      call solve(osc, rpm(i), equal, other)
      call check_true(t, 'graded, zeta '//str(zeta(i)), one%resolution%graded_for > 0 .and. .not. one%steady%partial)
      call check_close(t, 'as in equal steps, zeta '//str(zeta(i)), one%dynamic_factor, other%dynamic_factor, &
                       absolute=1e-9_dp)
      call check_true(t, 'estimate, zeta '//str(zeta(i)), &
                      abs(one%dynamic_factor - other%dynamic_factor) <= 2*one%estimate + 1e-11_dp)
      call check_close(t, 'multiplier, zeta '//str(zeta(i)), one%steady%multiplier, other%steady%multiplier, &
                       absolute=1e-8_dp)
    end do
  end subroutine as_equal_steps

  !> The cost of a point stays what it is, however slow or damped.
  subroutine bounded_steps(t)
    type(tally_t), intent(inout) :: t
    type(oscillator_t) :: osc
    type(accuracy_t) :: options
    type(point_t) :: point
    type(levels_t), allocatable :: levels
    real(dp) :: slow
    integer :: i

    osc = mesh_of(ratio, [400.0_dp, 0.0_dp, -110.0_dp], none, 0.17_dp)
    do i = -1, 5
      if (i == 0) cycle
      allocate (levels)
      call solve_point(osc, mesh_period(osc%mesh%teeth(1), 10.0_dp**(-i)), options, levels, point)
      if (i == -1) slow = work_of(levels)
      call check_true(t, 'steps at 1e'//str(-i)//' rpm', work_of(levels) <= 2*slow, str(work_of(levels))//', at 10 rpm '//str(slow))
      deallocate (levels)
    end do
    do i = 1, 3
      osc = mesh_of(ratio, [400.0_dp, 0.0_dp, -110.0_dp], none, 10.0_dp**i)
      call solve(osc, 1000.0_dp, options, point)
      call check_true(t, 'steps at zeta 1e'//str(i), point%steps <= 300, str(point%steps))
    end do
  end subroutine bounded_steps

  !> An answer depends neither on what was solved before nor on the number of threads; eight speeds side by
  !> side come to the same within the tolerance.
  subroutine same_bits(t)
    type(tally_t), intent(inout) :: t
    type(oscillator_t) :: osc
    type(sweep_options_t) :: options
    type(sweep_t) :: one, two
    type(error_t), allocatable :: error
    type(levels_t), allocatable :: tables
    type(point_t) :: alone, after
    real(dp) :: rpm(40)
    integer :: i

    osc = mesh_of(ratio, [400.0_dp, 0.0_dp, -110.0_dp], [2.0_dp, 2.0_dp], 0.17_dp)
    rpm = [(0.5_dp*i**2, i=1, size(rpm))]
    options%threads = 1
    call run_sweep([osc], rpm, options, one, error)
    call check_no_error(t, 'slow sweep', error)
    options%threads = 2
    call run_sweep([osc], rpm, options, two, error)
    call check_true(t, 'threads', all(transfer(one%dynamic_factor, [0]) == transfer(two%dynamic_factor, [0])))
    allocate (tables)
    do i = 1, size(rpm)
      call solve(osc, rpm(i), options%accuracy, alone)
      call check_close(t, 'side by side', one%dynamic_factor(i, 1), alone%dynamic_factor, absolute=2e-6_dp)
      if (.not. alone%resolution%graded_for > 0) cycle
      call solve_point(osc, mesh_period(25, rpm(i)), options%accuracy, tables, after)
      call check_true(t, 'after others', transfer(after%dynamic_factor, 0_int64) == transfer(alone%dynamic_factor, 0_int64))
    end do
  end subroutine same_bits

  !> Followed over its path, a pair has the largest load at the dynamic factor, and enough places.
  subroutine slow_path_of_a_pair(t)
    type(tally_t), intent(inout) :: t
    type(oscillator_t) :: osc
    type(accuracy_t) :: options
    type(response_t) :: response

    osc = mesh_of(ratio, [400.0_dp, 0.0_dp, -110.0_dp], [2.0_dp, 2.0_dp], 50.0_dp)
    call find_response(osc, 1.0_dp, options, response)
    call check_true(t, 'path covered', response%s(1) <= 0 .and. abs(response%s(size(response%s)) - ratio) < 1e-12_dp)
    call check_true(t, 'enough places', size(response%s) >= 400, str(size(response%s)))
    call check_close(t, 'largest load', maxval(response%load)/osc%load, response%point%dynamic_factor, 1e-4_dp)
  end subroutine slow_path_of_a_pair

  !> Where relief parts pairs, or the motion does, graded steps find what an integrator written apart finds
  !> (tools/reference/motions/make_slow.py).
  subroutine parted_pairs(t)
    type(tally_t), intent(inout) :: t
    type(row_t) :: row
    type(oscillator_t) :: osc
    type(accuracy_t) :: options
    type(point_t) :: point
    character(1000) :: line
    real(dp) :: columns(22), dynamic_factor
    integer :: unit, graded, loss, misses, rows

    graded = 0
    misses = 0
    rows = 0
    open (newunit=unit, file='test/reference/slow_motions.dat', status='old', action='read')
    do while (next_row(unit, line))
      row = row_of(line)
      read (line, *) columns, dynamic_factor, loss
      call oscillator_of(row, osc)
      call solve(osc, row%rpm, options, point)
      rows = rows + 1
      if (point%resolution%graded_for > 0 .and. loss > 0) graded = graded + 1
      associate (name => 'row '//str(row%id))
        call check_equal(t, name//': status', point%steady%status, status_ok)
        call check_close(t, name, point%dynamic_factor, dynamic_factor, absolute=options%steady%tolerance)
        call check_true(t, name//': pairs part', point%steady%partial .eqv. loss > 0)
      end associate
      if (abs(point%dynamic_factor - dynamic_factor) > 2*point%estimate + 1e-10_dp) misses = misses + 1
    end do
    close (unit)
    call check_true(t, 'most in graded steps', graded > rows/2, str(graded))
    call check_true(t, 'estimates', misses <= 1, str(misses))
  end subroutine parted_pairs

  !> With so much relief that pairs take the load over without a jump, one of them carries all of it for a while, and at creeping
  !> speed nothing more; with any damping, and with backlash. What the largest load is off by grows with the speed.
  subroutine creeping_with_relief(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: zeta(3) = [1e-3_dp, 1e-2_dp, 0.17_dp], relief(3) = [20.0_dp, 25.0_dp, 40.0_dp], &
                           rpm(4) = [0.1_dp, 0.5_dp, 1.0_dp, 5.0_dp], micro = 1e-6_dp
    type(oscillator_t) :: osc
    type(sweep_options_t) :: options
    type(sweep_t) :: sweep
    type(error_t), allocatable :: error
    type(sharing_t) :: sharing
    integer :: i, k

    do i = 1, size(zeta)
      do k = 1, size(relief)
        osc = mesh_of(ratio, [400.0_dp, 0.0_dp, -110.0_dp], [relief(k), relief(k)], zeta(i))
        osc%has_backlash = k == 2
        osc%backlash = 5*micro
        call make_oscillator(osc, error)
        call check_no_error(t, 'the mesh', error)
        call run_sweep([osc], rpm, options, sweep, error)
        call check_no_error(t, 'the sweep', error)
        call share_load(osc%mesh, osc%load, 20000, sharing)
        call check_true(t, 'a pair carries all of it', maxval(sharing%load) > (1 - 1e-9_dp)*osc%load)
        call check_true(t, 'every speed has a result, zeta '//str(zeta(i))//', '//str(relief(k))//' um', &
                        all(sweep%status(:, 1) == status_ok), str(count(sweep%status(:, 1) /= status_ok)))
        call check_true(t, 'within the tolerance', all(sweep%estimate(:, 1) <= options%accuracy%steady%tolerance))
        call check_true(t, 'the load at rest', all(abs(sweep%dynamic_factor(:, 1) - 1) <= 2e-4_dp*rpm), &
                        str(maxval(abs(sweep%dynamic_factor(:, 1) - 1)/rpm)))
      end do
    end do
  end subroutine creeping_with_relief
end module test_graded_steps
