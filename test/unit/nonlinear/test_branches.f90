!> Branches of the steady motion, the speeds at which they end, doubled periods and chaos: independent
!> methods, and the tongues.
module test_branches
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use gearsweep_study_case_case, only: case_t
  use gearsweep_api_case_reader, only: read_case
  use gearsweep_base_kinds, only: dp
  use gearsweep_motion_continuation, only: branch_options_t, branch_t, follow_branch
  use gearsweep_motion_error_estimate, only: accuracy_t, levels_t, point_t
  use gearsweep_motion_operating_point, only: solve_point
  use gearsweep_motion_oscillator, only: make_oscillator, mesh_period, oscillator_t
  use gearsweep_motion_poincare, only: sample_section, section_points_t
  use gearsweep_nonlinear_stability, only: find_tongues, tongue_t
  use gearsweep_motion_steady_motion, only: steady_options_t
  use gearsweep_base_error, only: error_t
  use gearsweep_motion_steady_motion, only: has_result, status_chaotic, status_name, status_ok, status_subharmonic
  use gearsweep_study_run_study, only: run_study, study_t
  use gearsweep_api_tables, only: column_of
  use gearsweep_base_text, only: str
  use test_support_reference_rows, only: next_row, prescribed
  use test_support_testing, only: tally_t, check_true, check_close, check_equal, check_no_error
  implicit none
  private
  public :: run

  real(dp), parameter :: constant(1) = 400, curved(3) = [400, 0, -110]

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t

    if (t%wants('ends_of_motions')) call ends_of_motions(t)
    if (t%wants('doubling_at_the_tongue')) call doubling_at_the_tongue(t)
    if (t%wants('chaos')) call chaos(t)
    if (t%wants('seen_of_chaos')) call seen_of_chaos(t)
    if (t%wants('one_speed_alone')) call one_speed_alone(t)
    if (t%wants('section_of_a_steady_motion')) call section_of_a_steady_motion(t)
    if (t%wants('too_slow')) call too_slow(t)
    if (t%wants('nothing_left')) call nothing_left(t)
  end subroutine run

  !> 25 teeth, 0.8 kg, 7000 N, contact ratio 1.6, no relief; stiffness in N/um.
  type(oscillator_t) function mesh_of(coef, damping_ratio) result(osc)
    real(dp), intent(in) :: coef(:), damping_ratio
    type(error_t), allocatable :: error

    call prescribed(1.6_dp, coef, [0.0_dp, 0.0_dp], 1, osc)
    osc%mesh%teeth = 25
    osc%mass = 0.8_dp
    osc%load = 7000
    osc%damping_ratio = damping_ratio
    call make_oscillator(osc, error)
    if (allocated(error)) error stop 'test mesh'
  end function mesh_of

  !> jumps.dat: the last speed at which a motion is found by Newton's method on a map of closed forms or Taylor
  !> series. Near a fold, the dynamic factor depends on the speed as a square root.
  subroutine ends_of_motions(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: jump = 0.02_dp, closeness = 1e-6_dp
    type(branch_t) :: branch
    real(dp) :: coef(3), zeta, rpm, rpm_end, factor, last_step
    character(1000) :: line
    character(:), allocatable :: name
    integer :: unit, row, direction, kind, i

    row = 0
    open (newunit=unit, file='test/reference/jumps.dat', status='old', action='read')
    do while (next_row(unit, line))
      row = row + 1
      name = 'row '//str(row)//', '
      read (line, *) coef, zeta, rpm, direction, rpm_end, kind, factor, last_step
      call follow_branch(mesh_of(coef, zeta), rpm + [(i, i=0, 10)]/9.5_dp*(rpm_end - rpm), &
                         branch_options_t(accuracy_t(), jump, closeness), branch)
      call check_true(t, name//'it ends', size(branch%change) > 0)
      if (size(branch%change) == 0) cycle
      associate (change => branch%change(1))
        call check_close(t, name//'speed', change%rpm(1), rpm_end, absolute=closeness*rpm_end + last_step)
        call check_close(t, name//'dynamic factor', change%point(1)%dynamic_factor, factor, absolute=sqrt(closeness))
        if (kind == 1) call check_true(t, name//'it jumps', abs(change%point(2)%dynamic_factor - factor) > jump)
        if (kind == -1) call check_equal(t, name//'it doubles', change%point(2)%steady%periods, 2)
      end associate
    end do
    close (unit)
    call check_equal(t, 'ends read', row, 6)
  end subroutine ends_of_motions

  !> Where the motion with all pairs in contact enters the first tongue, its period doubles: the edge by
  !> `find_tongues`, whose tests have closed forms.
  subroutine doubling_at_the_tongue(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: zeta = 0.03_dp
    type(oscillator_t) :: osc
    type(tongue_t) :: tongue(1)
    type(branch_t) :: branch
    type(section_points_t) :: section
    type(error_t), allocatable :: error
    integer :: side, i

    osc = mesh_of(curved, zeta)
    call find_tongues(osc, [zeta], tongue, error)
    call check_no_error(t, 'tongue', error)
    do side = 1, 2
      associate (edge => tongue(1)%edge(side, 1), inwards => 3 - 2*side)
        call follow_branch(osc, edge*(1 + inwards*0.01_dp*[(i, i=-3, 1)]), branch_options_t(accuracy_t(), 0.02_dp, 1e-7_dp), branch)
        call check_equal(t, 'changes', size(branch%change), 1)
        associate (change => branch%change(1))
          call check_close(t, 'at the edge', change%rpm(1), edge, relative=2e-6_dp)
          call check_true(t, 'doubled', all(change%point%steady%periods == [1, 2]))
        end associate
        call sample_section(osc, edge*(1 + inwards*0.01_dp*[-1, 1]), 1000, 100, section)
        call check_true(t, 'named', all(section%status == [status_ok, status_subharmonic]) .and. all(section%periods == [1, 2]))
      end associate
    end do
  end subroutine doubling_at_the_tongue

  !> chaos.dat: Lyapunov exponents by differences of motions in closed form, and their standard error, which
  !> a shorter run has more of. The search starts at rest under the load on two pairs, as there.
  subroutine chaos(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: kept = 2000, kept_there = 20000
    real(dp), parameter :: rest(2) = [7000/800e6_dp, 0.0_dp]
    type(section_points_t) :: section
    type(point_t) :: point
    type(levels_t), allocatable :: tables
    type(oscillator_t) :: osc
    real(dp) :: zeta, rpm, exponent, deviation, start(2)
    character(1000) :: line
    integer :: unit, rows

    rows = 0
    open (newunit=unit, file='test/reference/chaos.dat', status='old', action='read')
    do while (next_row(unit, line))
      rows = rows + 1
      read (line, *) zeta, rpm, exponent, deviation
      osc = mesh_of(constant, zeta)
      allocate (tables)
      call solve_point(osc, mesh_period(25, rpm), accuracy_t(), tables, point, rest)
      deallocate (tables)
      call check_equal(t, 'named by the sweep', point%steady%status, merge(status_chaotic, status_ok, exponent > 0))
      call check_close(t, 'growth by the sweep', log(point%steady%multiplier), exponent, &
                       absolute=4*deviation*(1 + sqrt(real(kept_there)/450)))
      start = rest
      if (has_result(point%steady%status)) start = point%steady%state/[1.0_dp, mesh_period(25, rpm)]
      call sample_section(osc, [rpm], 500, kept, section, start)
      call check_equal(t, 'named', section%status(1), merge(status_chaotic, status_ok, exponent > 0))
      call check_equal(t, 'periods', section%periods(1), merge(0, 1, exponent > 0))
      call check_close(t, 'exponent '//str(rows), section%exponent(1), exponent, &
                       absolute=4*deviation*(1 + sqrt(real(kept_there)/kept)))
    end do
    close (unit)
    call check_equal(t, 'motions read', rows, 5)
  end subroutine chaos

  !> What a sweep has seen of chaotic motions, against as many mesh periods in Runge-Kutta steps that know contact by the overlap
  !> alone. Both chaotic motions soon differ, even by the last bit, so that the means over 70 speeds close to each other are
  !> compared, within four standard errors. A motion is watched from its 250th period on, to the 500th, or later where disturbances
  !> have grown by less than exp(40); in Runge-Kutta steps from where the integral of twice the damping over the time has reached
  !> 2 ln 100. As built, with a run-out of 1e-12 m, whole turns are watched, and longer, so that the load and the range are
  !> larger than the means.
  subroutine seen_of_chaos(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: zeta(3) = [0.01_dp, 0.01_dp, 0.02_dp], rpm(3) = [2050.0_dp, 2250.0_dp, 2250.0_dp]
    real(dp), parameter :: faded = 2*log(100.0_dp), apart = 1e-5_dp
    integer, parameter :: runs = 70
    type(case_t) :: case
    type(study_t) :: study
    type(error_t), allocatable :: error
    real(dp), dimension(runs) :: speed, factor, rms, range, length
    character(:), allocatable :: text
    integer :: i, k

    do i = 1, size(rpm)
      text = ' &pinion teeth = 25 effective_mass_kg = 1.6 / &load normal_force_n = 7000 / &relief amount_um = 0 / '// &
             '&mesh model = ''polynomial'' contact_ratio = 1.6 coefficients = 400 / &dynamics damping_ratio = '// &
             str(zeta(i))//' / &sweep direction = ''each'' rpm_first = '//str(rpm(i))
      call read_case('&case tasks = ''sweep'' / &gear effective_mass_kg = 1.6 /'//text//' rpm_last = '// &
                     str(rpm(i)*(1 + (runs - 0.5_dp)*apart))//' rpm_step = '//str(rpm(i)*apart)//' /', case, error)
      call check_no_error(t, 'the case', error)
      if (.not. allocated(error)) call run_study(case, '', 1, study, error)
      call check_no_error(t, 'the study', error)
      if (allocated(error)) return
      speed = column_of(study, 'sweep', 'rpm')
      length = column_of(study, 'sweep', 'seen_periods')
      do k = 1, runs
        call march_on(zeta(i), speed(k), faded, nint(length(k)), factor(k), rms(k), range(k))
      end do
      call check_true(t, 'no dynamic factor', all(ieee_is_nan(column_of(study, 'sweep', 'dynamic_factor'))))
      call check_mean('load', column_of(study, 'sweep', 'seen_dynamic_factor'), factor)
      call check_mean('range', column_of(study, 'sweep', 'seen_dte_peak_to_peak_um'), range)
      call check_mean('root mean square', column_of(study, 'sweep', 'seen_dte_rms_um'), rms)
      call check_mean('periods', length, max(500.0_dp, 50 + 40/log(column_of(study, 'sweep', 'floquet_modulus'))) - 250)

      call read_case('&case tasks = ''as_built'' / &gear teeth = 25 effective_mass_kg = 1.6 /'//text//' rpm_last = '// &
                     str(rpm(i))//' rpm_step = 1 / &deviations pinion_runout_um = 1e-6 pinion_runout_phase_deg = 0 /', case, error)
      call check_no_error(t, 'the case as built', error)
      if (.not. allocated(error)) call run_study(case, '', 1, study, error)
      call check_no_error(t, 'the study as built', error)
      if (allocated(error)) return
      call check_true(t, 'none as built', all(ieee_is_nan(column_of(study, 'as_built', 'dynamic_factor'))))
      call check_true(t, 'load as built', all(column_of(study, 'as_built', 'seen_dynamic_factor') > mean_of(factor)))
      call check_true(t, 'range as built', all(column_of(study, 'as_built', 'seen_dte_peak_to_peak_um') > mean_of(range)))
      length(:1) = column_of(study, 'as_built', 'seen_periods')
      call check_true(t, 'whole turns', modulo(nint(length(1)), 25) == 0 .and. length(1) > 5000)
    end do

  contains

    !> Checks that two means are equal within four standard errors of their difference.
    subroutine check_mean(name, seen, expected)
      character(*), intent(in) :: name
      real(dp), intent(in) :: seen(:), expected(:)

      call check_close(t, name, mean_of(seen), mean_of(expected), absolute=4*sqrt((variance_of(seen) + variance_of(expected))/runs))
    end subroutine check_mean

    pure real(dp) function mean_of(values)
      real(dp), intent(in) :: values(:)

      mean_of = sum(values)/size(values)
    end function mean_of

    pure real(dp) function variance_of(values)
      real(dp), intent(in) :: values(:)

      variance_of = sum((values - mean_of(values))**2)/(size(values) - 1)
    end function variance_of
  end subroutine seen_of_chaos

  !> The motion of constant pair stiffness from rest, over `periods` mesh periods after that in which twice the damping has summed
  !> up to `faded`: its largest load on a pair over the static load, root mean square and range of x (um).
  pure subroutine march_on(zeta, rpm, faded, periods, factor, rms, range)
    real(dp), intent(in) :: zeta, rpm, faded
    integer, intent(in) :: periods
    real(dp), intent(out) :: factor, rms, range
    real(dp), parameter :: k = 400e6_dp, mass = 0.8_dp, load = 7000, ratio = 1.6_dp
    integer, parameter :: steps = 500
    real(dp) :: h, state(2), slope(2, 4), stage(2), decay, lowest, highest, mean
    integer :: i, j, n, pairs, watched

    h = mesh_period(25, rpm)/steps
    state = [load/(ratio*k), 0.0_dp]
    decay = 0
    factor = 0
    mean = 0
    rms = 0
    lowest = huge(lowest)
    highest = -huge(highest)
    watched = 0
    do i = 1, 100000
      if (decay > faded) watched = watched + 1
      if (watched > periods) exit
      do j = 1, steps
        pairs = merge(2, 1, j - 0.5_dp < (ratio - 1)*steps)
        do n = 1, 4
          stage = state
          if (n > 1) stage = state + h*slope(:, n - 1)*merge(1.0_dp, 0.5_dp, n == 4)
          slope(:, n) = [stage(2), (load - merge(pairs*k*stage(1) + 2*zeta*sqrt(pairs*k*mass)*stage(2), 0.0_dp, stage(1) > 0))/mass]
        end do
        state = state + h/6*(slope(:, 1) + 2*(slope(:, 2) + slope(:, 3)) + slope(:, 4))
        if (state(1) > 0) decay = decay + 2*zeta*sqrt(pairs*k/mass)*h
        if (watched == 0) cycle
        factor = max(factor, k*state(1)/load)
        lowest = min(lowest, 1e6_dp*state(1))
        highest = max(highest, 1e6_dp*state(1))
        mean = mean + 1e6_dp*state(1)
        rms = rms + (1e6_dp*state(1))**2
      end do
    end do
    mean = mean/(steps*periods)
    rms = sqrt(rms/(steps*periods) - mean**2)
    range = highest - lowest
  end subroutine march_on

  !> What a branch has at a speed is what that speed has from the branch's state.
  subroutine one_speed_alone(t)
    type(tally_t), intent(inout) :: t
    type(oscillator_t) :: osc
    type(branch_t) :: up, down
    type(point_t) :: point
    type(levels_t), allocatable :: tables
    real(dp) :: rpm(5)
    integer :: i

    osc = mesh_of(curved, 0.05_dp)
    rpm = [(9000 + 1000*i, i=0, 4)]
    call follow_branch(osc, rpm, branch_options_t(accuracy_t(), 0.02_dp, 1e-6_dp), up)
    call follow_branch(osc, rpm(5:1:-1), branch_options_t(accuracy_t(), 0.02_dp, 1e-6_dp), down)
    call check_true(t, 'all answered', all(has_result(up%point%steady%status)) .and. all(has_result(down%point%steady%status)))
    call check_true(t, 'two motions', down%point(4)%dynamic_factor > up%point(2)%dynamic_factor + 0.5_dp)
    call check_close(t, 'one motion', down%point(1)%dynamic_factor, up%point(5)%dynamic_factor, absolute=2e-6_dp)
    allocate (tables)
    do i = 1, 5
      call solve_point(osc, mesh_period(25, rpm(6 - i)), accuracy_t(), tables, point, down%point(i)%steady%state)
      call check_close(t, 'from its state', point%dynamic_factor, down%point(i)%dynamic_factor, absolute=2e-6_dp)
    end do
  end subroutine one_speed_alone

  !> It stays where the sweep's motion is, and disturbances shrink by its multiplier.
  subroutine section_of_a_steady_motion(t)
    type(tally_t), intent(inout) :: t
    type(oscillator_t) :: osc
    type(section_points_t) :: section
    type(point_t) :: point
    type(levels_t), allocatable :: tables
    real(dp) :: duration, v

    osc = mesh_of(curved, 0.1_dp)
    duration = mesh_period(25, 9000.0_dp)
    allocate (tables)
    call solve_point(osc, duration, accuracy_t(steady=steady_options_t(tolerance=1e-10_dp)), tables, point)
    v = point%steady%state(2)/duration
    call sample_section(osc, [9000.0_dp], 300, 200, section, [0.0_dp, 0.0_dp])
    call check_close(t, 'x', maxval(abs(section%x - point%steady%state(1))), 0.0_dp, absolute=1e-7_dp*osc%static_deflection)
    call check_close(t, 'v', maxval(abs(section%v - v)), 0.0_dp, absolute=1e-6_dp*abs(v))
    ! A complex pair turns disturbances on their way, which the mean forgets as 1/periods.
    call check_close(t, 'exponent', section%exponent(1), log(point%steady%multiplier), absolute=0.01_dp)
    call sample_section(osc, [9000.0_dp, 9001.0_dp], 0, 3, section, [point%steady%state(1), v])
    call check_close(t, 'from its state', maxval(abs(section%x(:, 1) - point%steady%state(1))), 0.0_dp, &
                     absolute=1e-7_dp*osc%static_deflection)
    call check_true(t, 'on from there', all(abs(section%x(:, 2) - point%steady%state(1)) < 0.01_dp*osc%static_deflection))
  end subroutine section_of_a_steady_motion

  subroutine too_slow(t)
    type(tally_t), intent(inout) :: t
    type(section_points_t) :: section
    type(branch_t) :: branch

    call sample_section(mesh_of(curved, 0.1_dp), [1e-3_dp, 9000.0_dp], 100, 40, section)
    call check_equal(t, 'too slow', status_name(section%status(1)), 'unresolved')
    call check_true(t, 'no numbers', all(ieee_is_nan(section%x(:, 1))))
    call check_equal(t, 'fast enough', status_name(section%status(2)), 'ok')
    call follow_branch(mesh_of(curved, 0.1_dp), [1e-3_dp, 9000.0_dp], branch_options_t(accuracy_t(), 0.02_dp, 1e-3_dp), branch)
    call check_equal(t, 'a branch from there', status_name(branch%point(2)%steady%status), 'ok')
  end subroutine too_slow

  !> While pairs of constant stiffness carry, the motion is a damped linear oscillator of frequency w, whose disturbances shrink by
  !> exp(-zeta w T) in a time T; w^2 = n K (1/m_1 + 1/m_2) with n pairs in contact. So slow that nothing is left of them within
  !> a mesh period: exp(-1190) is no number. Where n changes a disturbance may grow by the ratio of both w, once a period.
  subroutine nothing_left(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: kept = 40
    real(dp), parameter :: ratio(2) = [2.0_dp, 1.6_dp], slow = 9
    type(section_points_t) :: section
    type(oscillator_t) :: osc
    type(error_t), allocatable :: error
    real(dp) :: decay, two
    integer :: i

    do i = 1, 2
      call prescribed(ratio(i), constant, [0.0_dp, 0.0_dp], 1, osc)
      osc%mesh%teeth = 25
      osc%mass = 0.8_dp
      osc%load = 7000
      osc%damping_ratio = 0.1_dp
      call make_oscillator(osc, error)
      call check_no_error(t, 'oscillator', error)
      two = ratio(i) - 1
      decay = osc%damping_ratio*mesh_period(25, slow)*sqrt(2/0.8_dp*400e6_dp)*(two*sqrt(2.0_dp) + 1 - two)
      call check_true(t, 'it underflows', decay > 800, str(decay))
      call sample_section(osc, [slow], 2, kept, section)
      call check_equal(t, 'it repeats', status_name(section%status(1)), 'ok')
      call check_close(t, 'its exponent, contact ratio '//str(ratio(i)), section%exponent(1), -decay, &
                       absolute=merge(1.0_dp/kept, log(2.0_dp)/2, i == 1))
    end do
  end subroutine nothing_left
end module test_branches
