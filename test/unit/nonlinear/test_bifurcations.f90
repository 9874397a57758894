!> Whole branches of periodic motions and where they change: against places known to many digits from closed forms, and
!> identities between one parameter and another.
module test_bifurcations
  use gearsweep_nonlinear_motion_equations, only: tangent_of
  use gearsweep_motion_continuation, only: branch_options_t, branch_t, follow_branch, follow_ramp, level_t, ramp_options_t, ramp_t
  use gearsweep_base_error, only: error_t
  use gearsweep_motion_error_estimate, only: accuracy_t, point_t
  use gearsweep_base_kinds, only: dp
  use gearsweep_motion_oscillator, only: make_oscillator, oscillator_t
  use gearsweep_motion_steady_motion, only: has_result
  use gearsweep_base_table, only: table_t
  use gearsweep_api_tables, only: make_table
  use gearsweep_base_text, only: str
  use test_support_ask_by_name, only: answer_t, ask, refusal
  use test_support_reference_rows, only: next_row, prescribed
  use test_support_solve_one_point, only: solve
  use test_support_testing, only: check_close, check_equal, check_true, tally_t
  implicit none
  private
  public :: run

  integer, parameter :: word = 32

  !> 25 teeth, 0.8 kg, 7000 N, contact ratio 1.6; stiffness in N/um.
  character(*), parameter :: pair = '&case tasks = ''branches'' / &pinion teeth = 25 effective_mass_kg = 0.8 /'// &
    '&gear effective_mass_kg = 0.8 / &load normal_force_n = 7000 / ', &
    flat = '&mesh model = ''polynomial'' contact_ratio = 1.6 coefficients = 400 / ', &
    curved = '&mesh model = ''polynomial'' contact_ratio = 1.6 coefficients = 400, 0, -110 / ', &
    damped = '&dynamics damping_ratio = 0.05 / '

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t

    if (t%wants('many_digits')) call many_digits(t)
    if (t%wants('doubling_of_meissner')) call doubling_of_meissner(t)
    if (t%wants('slow_sweeps')) call slow_sweeps(t)
    if (t%wants('ramps')) call ramps(t)
    if (t%wants('creeping_ramp')) call creeping_ramp(t)
    if (t%wants('delays')) call delays(t)
    if (t%wants('whole_branches')) call whole_branches(t)
    if (t%wants('motions_of_the_sweep')) call motions_of_the_sweep(t)
    if (t%wants('fold_over_damping')) call fold_over_damping(t)
    if (t%wants('load_and_relief')) call load_and_relief(t)
    if (t%wants('corners_keep_their_sense')) call corners_keep_their_sense(t)
    if (t%wants('refused')) call refused(t)
    if (t%wants('nothing_in_silence')) call nothing_in_silence(t)
    if (t%wants('vertical_line')) call vertical_line(t)
  end subroutine run

  !> The changes of a study: their kinds, mesh periods, places and dynamic factors.
  subroutine changes_of(answer, name, kind, periods, place, factor)
    type(answer_t), intent(in) :: answer
    character(*), intent(in) :: name             ! of the parameter's column
    character(word), allocatable, intent(out) :: kind(:)
    integer, allocatable, intent(out) :: periods(:)
    real(dp), allocatable, intent(out) :: place(:), factor(:)
    type(table_t) :: table
    type(error_t), allocatable :: error
    integer :: i

    call make_table(answer%study, 'branch_changes', table, error)
    allocate (kind(table%rows))
    do i = 1, table%rows
      kind(i) = table%word('kind', i)
    end do
    periods = nint(answer%all_of('branch_changes.mesh_periods'))
    place = answer%all_of('branch_changes.'//name)
    factor = answer%all_of('branch_changes.dynamic_factor')
  end subroutine changes_of

  !> bifurcations.dat: folds, doublings and grazing by Newton's method with 30 digits on closed forms and Taylor series.
  subroutine many_digits(t)
    type(tally_t), intent(inout) :: t
    character(word), allocatable :: kind(:)
    integer, allocatable :: periods(:)
    real(dp), allocatable :: place(:), factor(:)
    type(answer_t) :: answer
    real(dp) :: coef(3), rpm, there, last
    character(1000) :: line
    character(8) :: what
    integer :: unit, n, rows, i

    rows = 0
    last = 1
    open (newunit=unit, file='test/reference/bifurcations.dat', status='old', action='read')
    do while (next_row(unit, line))
      rows = rows + 1
      read (line, *) coef, n, what, rpm, there
      if (abs(coef(3) - last) > 0) then
        if (coef(3) < 0) then
          call ask(t, pair//curved//damped//'&branches first = 5500 last = 14000 seeds = 5 most_periods = 1 /', answer)
        else
          call ask(t, pair//flat//damped//'&branches first = 6000 last = 12000 seeds = 7 /', answer)
        end if
        call changes_of(answer, 'rpm', kind, periods, place, factor)
        last = coef(3)
      end if
      i = minloc(abs(place - rpm), 1, mask=kind == what .and. periods == n)
      call check_true(t, 'row '//str(rows)//', known', i > 0)
      if (i == 0) cycle
      call check_close(t, 'row '//str(rows)//', place', place(i), rpm, relative=1e-9_dp)
      call check_close(t, 'row '//str(rows)//', dynamic factor', factor(i), there, relative=1e-6_dp)
    end do
    close (unit)
    call check_equal(t, 'rows', rows, 14)
  end subroutine many_digits

  !> While all pairs carry, the stiffness is a square wave, whose map is the product of two closed ones: the edges of its first
  !> tongue, where the period doubles.
  subroutine doubling_of_meissner(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: zeta = 0.03_dp
    character(word), allocatable :: kind(:)
    integer, allocatable :: periods(:)
    real(dp), allocatable :: place(:), factor(:)
    type(answer_t) :: answer
    real(dp) :: edge(2), low, high, middle
    integer :: side, i

    call ask(t, pair//flat//'&dynamics damping_ratio = 0.03 / &branches first = 24000 last = 38000 seeds = 2 '// &
             'most_periods = 1 /', answer)
    call changes_of(answer, 'rpm', kind, periods, place, factor)
    do side = 1, 2
      low = merge(24000, 30500, side == 1)
      high = merge(30500, 38000, side == 1)
      do i = 1, 100
        middle = (low + high)/2
        if ((square_wave(zeta, middle) > 0) .eqv. side == 1) then
          low = middle
        else
          high = middle
        end if
      end do
      edge(side) = low
      call check_close(t, 'edge '//str(side), minval(abs(pack(place, kind == 'doubling') - edge(side))), 0.0_dp, &
                       absolute=1e-9_dp*edge(side))
    end do
    call check_true(t, 'the tongue is open', edge(2) > 1.02_dp*edge(1))
  end subroutine doubling_of_meissner

  !> det(M + 1) of the pair above in full contact: 0.6 of a period with two pairs, then one.
  real(dp) function square_wave(zeta, rpm)
    real(dp), intent(in) :: zeta, rpm
    real(dp) :: m(2, 2), part(2, 2), omega, damped, time, decay
    integer :: pairs

    m = reshape([1, 0, 0, 1], [2, 2])
    do pairs = 2, 1, -1
      omega = sqrt(pairs*400e6_dp*2/0.8_dp)
      damped = omega*sqrt(1 - zeta**2)
      time = merge(0.6_dp, 0.4_dp, pairs == 2)*60/(25*rpm)
      decay = exp(-zeta*omega*time)
      part(1, :) = decay*[cos(damped*time) + zeta*omega/damped*sin(damped*time), sin(damped*time)/damped]
      part(2, :) = decay*[-omega**2/damped*sin(damped*time), cos(damped*time) - zeta*omega/damped*sin(damped*time)]
      m = matmul(part, m)
    end do
    square_wave = 1 + m(1, 1) + m(2, 2) + m(1, 1)*m(2, 2) - m(1, 2)*m(2, 1)
  end function square_wave

  !> slow_sweeps.dat: a march through all mesh periods while the speed rises slowly jumps behind the fold, the less the slower,
  !> and the fold that two rates make of it is ours.
  subroutine slow_sweeps(t)
    type(tally_t), intent(inout) :: t
    character(word), allocatable :: kind(:)
    integer, allocatable :: periods(:)
    real(dp), allocatable :: place(:), factor(:)
    type(answer_t) :: answer
    real(dp) :: zeta, jump, extrapolated, fold, last_zeta, last_jump
    character(1000) :: line
    integer :: unit, marched, rows

    rows = 0
    last_zeta = 0
    last_jump = huge(last_jump)
    fold = 0
    open (newunit=unit, file='test/reference/slow_sweeps.dat', status='old', action='read')
    do while (next_row(unit, line))
      rows = rows + 1
      read (line, *) zeta, marched, jump, extrapolated
      if (abs(zeta - last_zeta) > 0) then
        call ask(t, pair//flat//'&dynamics damping_ratio = '//str(zeta)//' / &branches first = 10000 last = 12000 seeds = 3 '// &
                 'most_periods = 1 /', answer)
        call changes_of(answer, 'rpm', kind, periods, place, factor)
        fold = maxval(place, mask=kind == 'fold')
        last_jump = huge(last_jump)
      end if
      call check_true(t, 'row '//str(rows)//', behind the fold', jump > fold .and. jump < fold + 0.5_dp)
      call check_true(t, 'row '//str(rows)//', the less the slower', jump < last_jump)
      if (marched > 200000) call check_close(t, 'row '//str(rows)//', fold', fold, extrapolated, absolute=2e-3_dp)
      last_zeta = zeta
      last_jump = jump
    end do
    close (unit)
    call check_equal(t, 'rows', rows, 6)
  end subroutine slow_sweeps

  !> slow_sweeps.dat again: a ramp at the rate of its march jumps where that does. That march comes to its first speed by a slow
  !> rise and its speed rises by equal steps a mesh period, ours by equal steps a second: 2 % of the delay are left to both.
  subroutine ramps(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: speeds(4) = [10000.0_dp, 10700.0_dp, 11400.0_dp, 11440.0_dp], zeta = 0.05_dp, fold = 11430.13333_dp
    type(oscillator_t) :: osc
    type(branch_t) :: branch
    type(ramp_t) :: ramp
    type(error_t), allocatable :: error
    character(1000) :: line
    real(dp) :: row_zeta, jump, rate
    integer :: unit, marched, rows

    call prescribed(1.6_dp, [400.0_dp, 0.0_dp, 0.0_dp], [0.0_dp, 0.0_dp], 1, osc)
    osc%mesh%teeth = 25
    osc%mass = 0.8_dp
    osc%load = 7000
    osc%damping_ratio = zeta
    call make_oscillator(osc, error)
    call follow_branch(osc, speeds(:3), branch_options_t(accuracy_t(), 0.02_dp, 1e-6_dp), branch)
    rows = 0
    open (newunit=unit, file='test/reference/slow_sweeps.dat', status='old', action='read')
    do while (next_row(unit, line))
      read (line, *) row_zeta, marched, jump
      if (abs(row_zeta - zeta) > 0 .or. marched > 200000) cycle
      rows = rows + 1
      ! The march's speed rises by so much each mesh period.
      rate = (speeds(4) - speeds(3))/marched/(60/(25*jump))
      associate (steady => branch%point(3)%steady)
        call follow_ramp(osc, speeds(3:), steady%state/[1.0_dp, 60/(25*speeds(3))], [level_t(speeds(3), 1.25_dp*1.48_dp)], &
                         ramp_options_t(rate), ramp)
      end associate
      call check_close(t, 'jump at '//str(rate)//' 1/min a second', ramp%passed(1), jump, absolute=0.02_dp*(jump - fold))
    end do
    close (unit)
    call check_equal(t, 'rows', rows, 2)
  end subroutine ramps

  !> As slowly as 1 rpm in ten mesh periods, with all pairs in contact, a ramp has the dynamic factor of the steady motion, up and
  !> down; of those between two speeds it is the largest.
  subroutine creeping_ramp(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: speeds(3) = [5000.0_dp, 5002.0_dp, 5004.0_dp]
    type(oscillator_t) :: osc
    type(branch_t) :: branch
    type(ramp_t) :: ramp
    type(error_t), allocatable :: error
    integer :: i

    call prescribed(1.6_dp, [400.0_dp, 0.0_dp, -110.0_dp], [0.0_dp, 0.0_dp], 1, osc)
    osc%mesh%teeth = 25
    osc%mass = 0.8_dp
    osc%load = 7000
    osc%damping_ratio = 0.1_dp
    call make_oscillator(osc, error)
    call follow_branch(osc, speeds, branch_options_t(accuracy_t(), 0.02_dp, 1e-6_dp), branch)
    associate (first => branch%point(1), last => branch%point(3))
      call follow_ramp(osc, speeds, first%steady%state/[1.0_dp, 60/(25*speeds(1))], [level_t ::], &
                       ramp_options_t(200.0_dp, 0.05_dp), ramp)
      do i = 2, 3
        call check_close(t, 'a creeping ramp', ramp%factor(i), maxval(branch%point(i - 1:i)%dynamic_factor), 1e-4_dp)
      end do
      call follow_ramp(osc, [(speeds(i), i=3, 1, -1)], last%steady%state/[1.0_dp, 60/(25*speeds(3))], [level_t ::], &
                       ramp_options_t(200.0_dp, 0.05_dp), ramp)
      call check_close(t, 'a creeping ramp down', ramp%factor(3), maxval(branch%point(:2)%dynamic_factor), 1e-4_dp)
      call check_true(t, 'it is a motion with a dynamic factor', first%dynamic_factor > 1.05_dp, str(first%dynamic_factor))
    end associate
  end subroutine creeping_ramp

  !> Behind a fold, the delay grows as the 2/3 power of the rate: in speed by 4 where that grows by 8. That holds in the limit of
  !> slow runs near the fold; at these rates a tenth is left to what comes next in the rate.
  subroutine delays(t)
    type(tally_t), intent(inout) :: t
    type(answer_t) :: answer
    real(dp), allocatable :: later(:), jump(:), known(:)
    real(dp) :: rate, behind(2)
    integer :: i

    do i = 1, 2
      rate = merge(8, 64, i == 1)
      call ask(t, '&case tasks = ''hysteresis'' / '//pair(index(pair, '&pinion'):)//flat//damped// &
               '&hysteresis rpm = 11300, 11400, 11500 ramp_rpm_s = '//str(rate)//' /', answer)
      later = answer%all_of('hysteresis_delays.delay_s')
      call check_equal(t, 'a jump at '//str(rate), size(later), 1)
      if (size(later) /= 1) return
      behind(i) = later(1)*rate
      ! It is a whole number of mesh periods, of which the jump's own is one.
      jump = answer%all_of('hysteresis_delays.ramp_rpm')
      known = answer%all_of('hysteresis_delays.error_estimate_s')
      call check_true(t, 'known to no less than a mesh period', known(1) >= 60/(25*jump(1)))
    end do
    call check_close(t, '4 times the speed', behind(2)/behind(1), 4.0_dp, 0.1_dp)
  end subroutine delays

  !> Every branch goes on until it leaves the range, closes or meets the motion whose period doubles, over corners and nearly
  !> grazing parts too; neighbouring points are close, and between folds the stability only changes at doublings.
  subroutine whole_branches(t)
    type(tally_t), intent(inout) :: t
    type(answer_t) :: answer
    type(table_t) :: table
    type(error_t), allocatable :: error
    character(word) :: ends(2)
    real(dp), allocatable :: branch(:), rpm(:), modulus(:), after(:), of_change(:), factor(:)
    character(word), allocatable :: kind(:)
    integer, allocatable :: periods(:)
    real(dp), allocatable :: place(:), there(:)
    integer :: i, changes
    logical :: joined

    call ask(t, pair//flat//damped//'&branches first = 6000 last = 12000 seeds = 5 most_periods = 8 /', &
             answer)
    call make_table(answer%study, 'branches', table, error)
    call check_true(t, 'several', table%rows > 6, str(table%rows))
    do i = 1, table%rows
      ends(1) = table%word('first_end', i)
      ends(2) = table%word('last_end', i)
      call check_true(t, 'branch '//str(i)//' is whole', all(ends == 'range' .or. ends == 'doubling' .or. ends == 'closed'))
    end do
    call doubled_branches(t, answer)
    branch = answer%all_of('branch_points.branch')
    rpm = answer%all_of('branch_points.rpm')
    modulus = answer%all_of('branch_points.floquet_modulus')
    factor = answer%all_of('branch_points.dynamic_factor')
    after = answer%all_of('branch_changes.after_point')
    of_change = answer%all_of('branch_changes.branch')
    call changes_of(answer, 'rpm', kind, periods, place, there)
    joined = .true.
    changes = 0
    do i = 1, size(rpm) - 1
      if (abs(branch(i) - branch(i + 1)) > 0) cycle
      joined = joined .and. abs(rpm(i) - rpm(i + 1)) <= 1.001_dp*6000/200 .and. abs(factor(i) - factor(i + 1)) < 0.2_dp
      if ((modulus(i) < 1) .eqv. (modulus(i + 1) < 1)) cycle
      if (abs(modulus(i) - 1) < 1e-6_dp .or. abs(modulus(i + 1) - 1) < 1e-6_dp) cycle
      changes = changes + 1
      call check_true(t, 'stability changes at a fold or doubling, near '//str(rpm(i)), &
                      any(kind /= 'grazing' .and. nint(of_change) == nint(branch(i)) .and. &
                          min(rpm(i), rpm(i + 1)) - 5 < place .and. place < max(rpm(i), rpm(i + 1)) + 5))
    end do
    call check_true(t, 'points are close', joined)
    call check_true(t, 'stability changes', changes > 5)
    call check_true(t, 'after_point', all(after > 0))
  end subroutine whole_branches

  !> Wherever the period doubles, a branch of twice the period ends.
  subroutine doubled_branches(t, answer)
    type(tally_t), intent(inout) :: t
    type(answer_t), intent(in) :: answer
    character(word), allocatable :: kind(:)
    integer, allocatable :: periods(:), owner(:), periods_of(:)
    real(dp), allocatable :: place(:), factor(:), rpm(:)
    integer :: i, k, doublings
    logical :: found

    call changes_of(answer, 'rpm', kind, periods, place, factor)
    owner = nint(answer%all_of('branch_points.branch'))
    rpm = answer%all_of('branch_points.rpm')
    periods_of = nint(answer%all_of('branches.mesh_periods'))
    doublings = 0
    do i = 1, size(place)
      if (kind(i) /= 'doubling' .or. periods(i) > 4) cycle
      doublings = doublings + 1
      found = .false.
      do k = 1, size(periods_of)
        if (periods_of(k) /= 2*periods(i)) cycle
        associate (first => rpm(findloc(owner, k, 1)), last => rpm(findloc(owner, k, 1, back=.true.)))
          found = found .or. min(abs(first - place(i)), abs(last - place(i))) < 1e-6_dp*place(i)
        end associate
      end do
      call check_true(t, 'a branch of twice the period ends at '//str(place(i), 8), found)
    end do
    call check_true(t, 'periods double', doublings > 5, str(doublings))
  end subroutine doubled_branches

  !> Where a branch attracts, an operating point that starts on it is the same motion.
  subroutine motions_of_the_sweep(t)
    type(tally_t), intent(inout) :: t
    type(answer_t) :: answer
    type(oscillator_t) :: osc
    type(point_t) :: point
    type(error_t), allocatable :: error
    real(dp), allocatable :: rpm(:), modulus(:), factor(:), x(:), v(:)
    integer :: i, compared

    call ask(t, pair//curved//damped//'&branches first = 6000 last = 14000 seeds = 3 most_periods = 2 /', answer)
    rpm = answer%all_of('branch_points.rpm')
    modulus = answer%all_of('branch_points.floquet_modulus')
    factor = answer%all_of('branch_points.dynamic_factor')
    x = 1e-6_dp*answer%all_of('branch_points.dte_um')
    v = 1e-3_dp*answer%all_of('branch_points.dte_rate_mm_s')
    call prescribed(1.6_dp, [400.0_dp, 0.0_dp, -110.0_dp], [0.0_dp, 0.0_dp], 1, osc)
    osc%mesh%teeth = 25
    osc%mass = 0.8_dp
    osc%load = 7000
    osc%damping_ratio = 0.05_dp
    call make_oscillator(osc, error)
    compared = 0
    do i = 1, size(rpm), 17
      if (modulus(i) > 0.99_dp) cycle
      call solve(osc, rpm(i), accuracy_t(), point, [x(i), v(i)*60/(25*rpm(i))])
      if (.not. has_result(point%steady%status)) cycle
      if (abs(point%steady%state(1) - x(i)) > 1e-3_dp*osc%static_deflection) cycle
      compared = compared + 1
      call check_close(t, 'dynamic factor at '//str(rpm(i)), point%dynamic_factor, factor(i), absolute=2*point%estimate + 1e-8_dp)
    end do
    call check_true(t, 'motions compared', compared > 10)
  end subroutine motions_of_the_sweep

  !> At the speed of a fold over the speed there is one over the damping ratio, at the case's.
  subroutine fold_over_damping(t)
    type(tally_t), intent(inout) :: t
    type(answer_t) :: over_speed, over_damping
    character(word), allocatable :: kind(:)
    integer, allocatable :: periods(:)
    real(dp), allocatable :: place(:), factor(:)
    real(dp) :: rpm

    call ask(t, pair//flat//damped//'&branches first = 10000 last = 12000 seeds = 2 most_periods = 1 /', &
             over_speed)
    call changes_of(over_speed, 'rpm', kind, periods, place, factor)
    call check_equal(t, 'folds', count(kind == 'fold'), 1)
    rpm = sum(place, kind == 'fold')
    call ask(t, pair//flat//'&branches parameter = ''damping_ratio'' first = 0.02 last = 0.1 seeds = 3 most_periods = 1 '// &
             'rpm = '//str(rpm, 17)//'/', over_damping)
    call changes_of(over_damping, 'damping_ratio', kind, periods, place, factor)
    call check_close(t, 'damping ratio', minval(abs(pack(place, kind == 'fold') - 0.05_dp)), 0.0_dp, absolute=1e-9_dp)
  end subroutine fold_over_damping

  !> Motions only depend on the relief over the load: where the motion changes over one, it does over the other.
  subroutine load_and_relief(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: rest = flat//damped//'&relief amount_um = 8 /', &
      more = ' seeds = 5 most_periods = 2 rpm = 7000 /'
    type(answer_t) :: over_relief, over_load
    character(word), allocatable :: kind(:), kind_there(:)
    integer, allocatable :: periods(:), periods_there(:)
    real(dp), allocatable :: relief(:), load(:), factor(:), factor_there(:), width(:), width_there(:)
    real(dp) :: known, apart
    integer :: i, k, compared

    call ask(t, pair//rest//'&branches parameter = ''relief_um'' first = 2 last = 32'//more, over_relief)
    call ask(t, pair//rest//'&branches parameter = ''normal_force_n'' first = 1750 last = 28000'//more, over_load)
    call changes_of(over_relief, 'relief_um', kind, periods, relief, factor)
    call changes_of(over_load, 'normal_force_n', kind_there, periods_there, load, factor_there)
    width = over_relief%all_of('branch_changes.enclosed')
    width_there = over_load%all_of('branch_changes.enclosed')
    compared = 0
    do i = 1, size(relief)
      known = 7000*8/relief(i)
      k = minloc(abs(load - known), 1, mask=kind_there == kind(i) .and. periods_there == periods(i))
      if (k == 0) cycle
      if (abs(load(k) - known) > 1e-3_dp*known) cycle
      ! Behind some grazings Newton's method fails, and both places are only enclosed.
      apart = width_there(k) + known*width(i)/relief(i)
      if (apart < 1e-8_dp*known) compared = compared + 1
      call check_close(t, trim(kind(i))//' at '//str(relief(i))//' um', load(k), known, absolute=1e-8_dp*known + apart)
    end do
    call check_true(t, 'changes compared', compared > 3, str(compared)//' of '//str(size(relief)))
  end subroutine load_and_relief

  !> Two linear pieces that meet in a face: along the broken line of zeros the tangents of both lead through the face to the
  !> same side, also where the line turns back.
  subroutine corners_keep_their_sense(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: face(3) = [0.6_dp, -0.3_dp, 0.2_dp]
    real(dp) :: a(2, 3), b(2, 3), first(3), second(3)
    integer :: i, back

    a = reshape([1.0_dp, 0.2_dp, -0.5_dp, 1.3_dp, 0.7_dp, -0.4_dp], [2, 3])
    back = 0
    do i = -20, 20
      b = a
      b(1, :) = b(1, :) + 0.37_dp*i*face
      b(2, :) = b(2, :) - 0.61_dp*i*face
      first = tangent_of(a)
      second = tangent_of(b)
      call check_true(t, 'through the face, '//str(i), dot_product(first, face)*dot_product(second, face) > 0)
      call check_close(t, 'a tangent of length 1', norm2(second), 1.0_dp, 1e-14_dp)
      call check_close(t, 'along the zeros', maxval(abs(matmul(b, second))), 0.0_dp, absolute=1e-13_dp)
      if (first(3)*second(3) < 0) back = back + 1
    end do
    call check_true(t, 'some turn back', back > 0)
  end subroutine corners_keep_their_sense

  !> What the parameter asks for.
  subroutine refused(t)
    type(tally_t), intent(inout) :: t

    call refuses('&branches parameter = ''damping_ratio'' first = 0 last = 0.1 /', 'needs rpm')
    call refuses('&branches first = 3000 last = 4000 rpm = 3500 /', 'the speed is the parameter')
    call refuses('&branches first = 5000 last = 4000 /', 'must be above first')
    call refuses('&branches first = 0 last = 4000 /', 'must be above 0')
    call refuses('&branches first = 30000 /', 'last')
    call refuses('&branches parameter = ''relief_um'' first = 0 last = 10 rpm = 5000 relief_um = 0 / &relief amount_um = 0 /', &
                 'the relief is the parameter')
    call refuses('&branches parameter = ''torque'' /', 'parameter')
    call refuses('&branches first = 5000 last = 6000 second = ''damping_ratio'' second_first = 0.01 second_last = 0.1 /', &
                 'curves over two numbers are no longer computed')
    call refuses('&branches first = 5000 last = 6000 second_last = 0.1 /', 'curves over two numbers are no longer computed')

  contains

    subroutine refuses(branches, words)
      character(*), intent(in) :: branches, words
      character(:), allocatable :: message

      message = refusal(pair//flat//branches)
      call check_true(t, branches, index(message, '&branches') > 0 .and. index(message, words) > 0, message)
    end subroutine refuses
  end subroutine refused
  !> With relief, backlash and little damping, behind some grazings the multipliers grow without bound, and Newton's method fails
  !> there: still, wherever contact or stability differ between two points of a branch, a row of the changes is told between them.
  subroutine nothing_in_silence(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: relief = '&relief amount_um = 9 gear_fraction = 0.6667 / &dynamics damping_ratio = 0.06 / '// &
      '&pair backlash_um = 15 / '
    type(answer_t) :: answer
    type(table_t) :: points, changes
    type(error_t), allocatable :: error
    real(dp), allocatable :: branch(:), point(:), modulus(:), of_change(:), after(:)
    integer :: i, silent, seen
    logical :: differs

    call ask(t, pair//curved//relief//'&branches first = 6000 last = 14000 seeds = 5 most_periods = 2 /', answer)
    call make_table(answer%study, 'branch_points', points, error)
    call make_table(answer%study, 'branch_changes', changes, error)
    branch = points%numbers('branch')
    point = points%numbers('point')
    modulus = points%numbers('floquet_modulus')
    of_change = changes%numbers('branch')
    after = changes%numbers('after_point')
    silent = 0
    seen = 0
    do i = 1, size(branch) - 1
      if (abs(branch(i + 1) - branch(i)) > 0) cycle
      differs = points%word('contact', i) /= points%word('contact', i + 1) .or. &
                (modulus(i) - 1)*(modulus(i + 1) - 1) < 0 .and. min(abs(modulus(i) - 1), abs(modulus(i + 1) - 1)) > 1e-5_dp
      if (.not. differs) cycle
      seen = seen + 1
      if (.not. any(nint(of_change) == nint(branch(i)) .and. nint(after) == nint(point(i)))) silent = silent + 1
    end do
    call check_true(t, 'changes', seen > 10, str(seen))
    call check_equal(t, 'in silence', silent, 0)
  end subroutine nothing_in_silence

  !> Where the period doubles in full contact, the map is linear: at that speed, motions of twice the period have any amplitude
  !> up to grazing, and det(M - 1) is 0 for all of them, but for rounding. They are one row, and no folds.
  subroutine vertical_line(t)
    type(tally_t), intent(inout) :: t
    character(word), allocatable :: kind(:)
    integer, allocatable :: periods(:)
    real(dp), allocatable :: place(:), factor(:)
    type(answer_t) :: answer
    real(dp) :: edge
    integer :: i

    call ask(t, pair//flat//'&dynamics damping_ratio = 0.03 / &branches first = 24000 last = 38000 seeds = 2 '// &
             'most_periods = 2 /', answer)
    call changes_of(answer, 'rpm', kind, periods, place, factor)
    call check_true(t, 'there is one', any(kind == 'vertical' .and. periods == 2))
    do i = 1, size(kind)
      if (periods(i) /= 2 .or. kind(i) /= 'fold' .and. kind(i) /= 'vertical') cycle
      edge = minval(abs(place - place(i)), mask=kind == 'doubling' .and. periods == 1)
      if (kind(i) == 'vertical') call check_true(t, 'where the period doubles', edge < 1e-7_dp*place(i))
      if (kind(i) == 'fold') call check_true(t, 'no fold', edge > 1e-7_dp*place(i), str(place(i), 12))
    end do
  end subroutine vertical_line
end module test_bifurcations
