!> What is read off a motion beside its dynamic factor: against closed forms of polynomials, identities of the equation of motion,
!> the static transmission error, and a march that knows nothing of the library.
module test_motion_summary
  use gearsweep_study_case_case, only: case_t
  use gearsweep_api_case_reader, only: read_case
  use gearsweep_base_error, only: error_t
  use gearsweep_base_kinds, only: dp, pi
  use gearsweep_motion_spectrum, only: find_spectrum, spectrum_t
  use gearsweep_study_run_study, only: run_study, study_t
  use gearsweep_api_tables, only: column_of
  use gearsweep_base_text, only: str
  use test_support_random_numbers, only: random_t
  use test_support_testing, only: check_close, check_no_error, check_true, tally_t
  implicit none
  private
  public :: run

  real(dp), parameter :: ratio = 1.6_dp, stiffness(0:2) = [400e6_dp, 0.0_dp, -120e6_dp]      ! N/m over u
  real(dp), parameter :: load = 3000, mass(2) = [0.8_dp, 0.9_dp], backlash = 2e-6_dp
  integer, parameter :: teeth = 25

  !> What a march tells of a mesh period: the names are those of the columns.
  type :: march_t
    real(dp) :: dynamic_factor = 0, coast_factor = 0, mean_load_ratio = 0, load_rms_ratio = 0, separation_share = 0
    real(dp) :: dte_mean_um = 0, dte_rms_um = 0, dte_peak_to_peak_um = 0, damping_share = 0, impacts = 0
    real(dp) :: load_reversals = 0, pair_load_rms_ratio = 0
    complex(dp) :: dte(3) = 0, mesh_load(3) = 0            ! of harmonic 1, 2, 3; um, N
  end type march_t

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t

    if (t%wants('polynomials')) call polynomials(t)
    if (t%wants('without_damping')) call without_damping(t)
    if (t%wants('slow')) call slow(t)
    if (t%wants('marched')) call marched(t)
    if (t%wants('several_periods')) call several_periods(t)
    if (t%wants('over_speed')) call over_speed(t)
  end subroutine run

  !> Random polynomials of fifth degree in steps of random length: Fourier integrals by Simpson's rule in many parts, and
  !> Parseval's theorem: what the first harmonics leave of the mean square falls as that of a function with jumps does.
  subroutine polynomials(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: steps = 5, count = 60, parts = 4000
    type(random_t) :: random
    type(spectrum_t) :: spectrum
    real(dp) :: left(steps), width(steps), c(0:5, steps), weight, value, place, mean, square
    complex(dp) :: part(count)
    integer :: i, k, n

    random%seed = 60
    width = [(random%between(0.1_dp, 1.0_dp), i=1, steps)]
    width = width/sum(width)
    left = [(sum(width(:i - 1)), i=1, steps)]
    c = reshape([(random%between(-1.0_dp, 1.0_dp), i=1, size(c))], [6, steps])
    call find_spectrum(left, width, c, count, spectrum)
    part = 0
    mean = 0
    square = 0
    do i = 1, steps
      do k = 0, 2*parts
        weight = merge(1, merge(4, 2, modulo(k, 2) == 1), k == 0 .or. k == 2*parts)*width(i)/(6*parts)
        place = k/(2.0_dp*parts)
        value = sum(c(:, i)*[(place**n, n=0, 5)])
        mean = mean + weight*value
        square = square + weight*value**2
        part = part + 2*weight*value*exp(cmplx(0.0_dp, -2*pi*(left(i) + width(i)*place)*[(n, n=1, count)], dp))
      end do
    end do
    call check_close(t, 'mean', spectrum%mean, mean, absolute=1e-12_dp)
    call check_close(t, 'root mean square', spectrum%rms, sqrt(square - mean**2), 1e-11_dp)
    do k = 1, count
      call check_true(t, 'harmonics', abs(spectrum%amplitude(k)*exp(cmplx(0.0_dp, spectrum%phase(k), dp)) - part(k)) < 1e-9_dp, &
                      str(k))
    end do
    call check_close(t, 'what the harmonics leave of the mean square', &
                     (spectrum%rms**2 - sum(spectrum%amplitude**2)/2)/jumps(c)*count*2*pi**2, 1.0_dp, absolute=0.05_dp)

  contains

    !> Sum of the squares of the jumps, of which each harmonic k has on average sum/(2 (pi k)**2) in its mean square.
    pure real(dp) function jumps(c)
      real(dp), intent(in) :: c(0:, :)
      integer :: i

      jumps = sum([((sum(c(:, i)) - c(0, 1 + modulo(i, size(c, 2))))**2, i=1, size(c, 2))])
    end function jumps
  end subroutine polynomials

  !> A prescribed mesh, without relief unless `reliefs` has some. `speeds`, `method`: further keys of &sweep and &numerics.
  subroutine study_of(t, damping, more, rpm, tasks, study, reliefs, speeds, method)
    type(tally_t), intent(inout) :: t
    real(dp), intent(in) :: damping, rpm
    character(*), intent(in) :: more, tasks
    type(study_t), intent(out) :: study
    character(*), intent(in), optional :: reliefs, speeds, method
    type(case_t) :: case
    type(error_t), allocatable :: error
    character(:), allocatable :: amounts, sweep, numerics

    amounts = '0'
    if (present(reliefs)) amounts = reliefs
    sweep = ''
    if (present(speeds)) sweep = speeds
    numerics = 'tolerance = 1e-9'
    if (present(method)) numerics = method

    call read_case('&case tasks = '//tasks//' / &pinion teeth = '//str(teeth)//' effective_mass_kg = '//str(mass(1))// &
                   ' / &gear effective_mass_kg = '//str(mass(2))//' / &load normal_force_n = '//str(load)// &
                   ' / &relief amount_um = '//amounts//' / &mesh model = ''polynomial'' contact_ratio = '//str(ratio)// &
                   ' coefficients = 400, 0, -120 ste_harmonics = 3 / &dynamics damping_ratio = '//str(damping)//' / '//more// &
                   ' &sweep load_rpm = '//str(rpm)//' motion_harmonics = 200 '//sweep//' / &numerics '//numerics//' /', case, error)
    call check_no_error(t, 'the case', error)
    if (.not. allocated(error)) call run_study(case, '', 1, study, error)
    call check_no_error(t, 'the study', error)
  end subroutine study_of

  pure real(dp) function first(numbers)
    real(dp), intent(in) :: numbers(:)

    first = numbers(1)
  end function first

  !> Without damping the mesh carries the static load in the mean; the harmonics of load and transmission error hold nearly all of
  !> their mean squares (Parseval), and the inertia force, which is what the load lacks of the static one, is that of the
  !> transmission error: harmonic by harmonic (2 pi f)**2 m times it.
  subroutine without_damping(t)
    type(tally_t), intent(inout) :: t
    type(study_t) :: study
    real(dp), allocatable :: error(:), force(:), phase(:), frequency(:)
    integer :: n

    call study_of(t, 0.0_dp, '', 7000.0_dp, '''load''', study)
    call check_close(t, 'mean load', first(column_of(study, 'load_points', 'mean_load_ratio')), 1.0_dp, 1e-11_dp)
    error = column_of(study, 'motion_harmonics', 'dte_amplitude_um')
    force = column_of(study, 'motion_harmonics', 'mesh_load_amplitude_n')
    phase = column_of(study, 'motion_harmonics', 'dte_phase_deg') - column_of(study, 'motion_harmonics', 'mesh_load_phase_deg')
    frequency = column_of(study, 'motion_harmonics', 'frequency_hz')
    n = size(error)
    call check_true(t, 'a row for each harmonic', n == 201)
    call check_close(t, 'mesh frequency', frequency(2), teeth*7000/60.0_dp)
    call check_close(t, 'mean of the transmission error', error(1), first(column_of(study, 'load_points', 'dte_mean_um')), 1e-13_dp)
    call check_close(t, 'Parseval: transmission error', sqrt(sum(error(2:)**2)/2), &
                     first(column_of(study, 'load_points', 'dte_rms_um')), 1e-6_dp)
    call check_close(t, 'Parseval: load', sqrt(sum(force(2:)**2)/2)/load, &
                     first(column_of(study, 'load_points', 'load_rms_ratio')), 1e-3_dp)
    call check_close(t, 'the load lacks the inertia force', &
                     maxval(abs(force(2:40) - (2*pi*frequency(2:40))**2*product(mass)/sum(mass)*1e-6_dp*error(2:40))), 0.0_dp, &
                     absolute=1e-6_dp*load)
    call check_close(t, 'in phase', maxval(abs(sin(phase(2:20)*pi/180))), 0.0_dp, absolute=1e-5_dp)
  end subroutine without_damping

  !> At low speed the transmission error is the static one, whose harmonics come from another integral.
  subroutine slow(t)
    type(tally_t), intent(inout) :: t
    type(study_t) :: study
    real(dp), allocatable :: moving(:), still(:)

    call study_of(t, 0.8_dp, '', 1.0_dp, '''load'', ''mesh''', study)
    moving = column_of(study, 'motion_harmonics', 'dte_amplitude_um')
    still = column_of(study, 'harmonics', 'amplitude_um')
    call check_close(t, 'mean', moving(1), still(1), 1e-3_dp)
    call check_close(t, 'harmonics', maxval(abs(moving(2:4) - still(2:4))), 0.0_dp, absolute=1e-2_dp*still(2))
    call check_close(t, 'peak-to-peak', first(column_of(study, 'load_points', 'dte_peak_to_peak_um')), &
                     first(column_of(study, 'transmission_error', 'peak_to_peak_um')), 0.6_dp)
    call check_close(t, 'mean load', first(column_of(study, 'load_points', 'mean_load_ratio')), 1.0_dp, 1e-2_dp)
  end subroutine slow

  !> Motions that lose contact and touch the coast sides, marched by Runge-Kutta steps that know contact by the overlap alone.
  subroutine marched(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: rpm(3) = [12000.0_dp, 14500.0_dp, 7000.0_dp], damping(3) = [0.06_dp, 0.06_dp, 0.06_dp]
    type(study_t) :: study
    type(march_t) :: found
    integer :: i, coast

    coast = 0
    do i = 1, size(rpm)
      call study_of(t, damping(i), '&pair backlash_um = '//str(1e6_dp*backlash)//' /', rpm(i), '''load''', study)
      call march(damping(i), rpm(i), found)
      if (found%coast_factor > 0) coast = coast + 1
      call as_marched('dynamic_factor', found%dynamic_factor, 1e-4_dp)
      call as_marched('coast_factor', found%coast_factor, 1e-4_dp)
      call as_marched('mean_load_ratio', found%mean_load_ratio, 1e-4_dp)
      call as_marched('load_rms_ratio', found%load_rms_ratio, 1e-4_dp)
      call as_marched('pair_load_rms_ratio', found%pair_load_rms_ratio, 1e-4_dp)
      call as_marched('separation_share', found%separation_share, 1e-3_dp)
      call as_marched('dte_mean_um', found%dte_mean_um, 1e-3_dp)
      call as_marched('dte_rms_um', found%dte_rms_um, 1e-3_dp)
      call as_marched('dte_peak_to_peak_um', found%dte_peak_to_peak_um, 1e-3_dp)
      call as_marched('impacts', found%impacts, 1e-12_dp)
      call as_marched('load_reversals', found%load_reversals, 1e-12_dp)
      call check_close(t, 'what the mesh does not carry is damped', found%mean_load_ratio + found%damping_share, 1.0_dp, 1e-4_dp)
      call harmonics_as_marched
    end do
    call check_true(t, 'some touch the coast sides', coast > 0, str(coast))

  contains

    subroutine as_marched(column, expected, tolerance)
      character(*), intent(in) :: column
      real(dp), intent(in) :: expected, tolerance

      call check_close(t, column, first(column_of(study, 'load_points', column)), expected, absolute=tolerance)
    end subroutine as_marched

    subroutine harmonics_as_marched
      complex(dp) :: error(3), force(3)

      associate (x => column_of(study, 'motion_harmonics', 'dte_amplitude_um'), &
                 f => column_of(study, 'motion_harmonics', 'mesh_load_amplitude_n'), &
                 x_phase => column_of(study, 'motion_harmonics', 'dte_phase_deg')*pi/180, &
                 f_phase => column_of(study, 'motion_harmonics', 'mesh_load_phase_deg')*pi/180)
        error = x(2:4)*exp(cmplx(0.0_dp, x_phase(2:4), dp))
        force = f(2:4)*exp(cmplx(0.0_dp, f_phase(2:4), dp))
      end associate
      call check_close(t, 'harmonics of the transmission error', maxval(abs(error - found%dte)), 0.0_dp, absolute=1e-3_dp)
      call check_close(t, 'harmonics of the load', maxval(abs(force - found%mesh_load)), 0.0_dp, absolute=1e-4_dp*load)
    end subroutine harmonics_as_marched
  end subroutine marched

  !> Marches until the transient has died away, and a period in finer steps.
  subroutine march(damping, rpm, found)
    real(dp), intent(in) :: damping, rpm
    type(march_t), intent(out) :: found
    integer, parameter :: first = 1500, rough = 500, fine = 40000
    real(dp) :: state(2)
    integer :: side, i

    state = [load/700e6_dp, 0.0_dp]
    side = 1
    do i = 1, first
      call march_period(damping, rpm, rough, state, side, found)
    end do
    do i = 1, 60
      call march_period(damping, rpm, fine/10, state, side, found)
    end do
    do i = 1, 4
      call march_period(damping, rpm, fine, state, side, found)
    end do
  end subroutine march

  subroutine march_period(damping, rpm, steps, state, side, found)
    real(dp), intent(in) :: damping, rpm
    integer, intent(in) :: steps
    real(dp), intent(inout) :: state(2)          ! x (m) and its derivative over time
    integer, intent(inout) :: side               ! that was loaded last: 1 drive, -1 coast
    type(march_t), intent(out) :: found
    real(dp) :: h, slope(2, 4), pair(2), coast, damped, phase, x, force, highest, lowest
    logical :: apart
    integer :: i, k

    h = 60/(rpm*teeth)/steps
    apart = .false.
    highest = -huge(highest)
    lowest = huge(lowest)
    do i = 0, steps - 1
      phase = i/real(steps, dp)
      call forces(damping, state, [phase, phase + 0.5_dp/steps], pair, coast, damped)
      if (apart .and. (any(pair > 0) .or. coast > 0)) found%impacts = found%impacts + 1
      apart = .not. (any(pair > 0) .or. coast > 0)
      if (.not. apart) then
        if (side /= merge(-1, 1, coast > 0)) found%load_reversals = found%load_reversals + 1
        side = merge(-1, 1, coast > 0)
      end if
      x = 1e6_dp*state(1)
      force = sum(pair) - coast
      found%dynamic_factor = max(found%dynamic_factor, maxval(pair)/load)
      found%coast_factor = max(found%coast_factor, coast/load)
      found%mean_load_ratio = found%mean_load_ratio + force/load/steps
      found%load_rms_ratio = found%load_rms_ratio + (force/load)**2/steps
      found%pair_load_rms_ratio = found%pair_load_rms_ratio + sum((pair/load)**2)/steps/ratio
      found%damping_share = found%damping_share + damped/load/steps
      found%separation_share = found%separation_share + merge(1, 0, apart)/real(steps, dp)
      found%dte_mean_um = found%dte_mean_um + x/steps
      found%dte_rms_um = found%dte_rms_um + x**2/steps
      highest = max(highest, x)
      lowest = min(lowest, x)
      do k = 1, 3
        found%dte(k) = found%dte(k) + 2*x*exp(cmplx(0.0_dp, -2*pi*k*phase, dp))/steps
        found%mesh_load(k) = found%mesh_load(k) + 2*force*exp(cmplx(0.0_dp, -2*pi*k*phase, dp))/steps
      end do
      do k = 1, 4
        call derive(state, merge(0.0_dp, merge(1.0_dp, 0.5_dp, k == 4), k == 1))
      end do
      state = state + h/6*(slope(:, 1) + 2*(slope(:, 2) + slope(:, 3)) + slope(:, 4))
    end do
    found%load_rms_ratio = sqrt(found%load_rms_ratio - found%mean_load_ratio**2)
    found%dte_rms_um = sqrt(found%dte_rms_um - found%dte_mean_um**2)
    found%pair_load_rms_ratio = sqrt(found%pair_load_rms_ratio)
    found%dte_peak_to_peak_um = highest - lowest

  contains

    subroutine derive(from, part)
      real(dp), intent(in) :: from(2), part
      real(dp) :: stage(2)

      stage = from
      if (k > 1) stage = from + part*h*slope(:, k - 1)
      call forces(damping, stage, [(i + part)/steps, (i + 0.5_dp)/steps], pair, coast, damped)
      slope(:, k) = [stage(2), (load - sum(pair) + coast - damped)*(1/mass(1) + 1/mass(2))]
    end subroutine derive
  end subroutine march_period

  !> Loads of the pairs and the coast sides, and the damping force (N), at a mesh phase; which pairs there are, the second of
  !> the phases says, at a distance from where a pair leaves.
  pure subroutine forces(damping, state, phase, pair, coast, damped)
    real(dp), intent(in) :: damping, state(2), phase(2)
    real(dp), intent(out) :: pair(2), coast, damped
    real(dp) :: k(2), closed
    integer :: j

    k = 0
    do j = 0, 1
      if (phase(2) + j < ratio) k(j + 1) = sum(stiffness*[1.0_dp, 0.0_dp, (2*(phase(1) + j)/ratio - 1)**2])
    end do
    pair = max(0.0_dp, k*state(1))
    coast = max(0.0_dp, -sum(k)*(state(1) + backlash))
    closed = merge(sum(k), 0.0_dp, state(1) > 0 .or. state(1) < -backlash)
    associate (m => 1/sum(1/mass))
      damped = 2*damping*sqrt(closed*m)*state(2)
    end associate
  end subroutine forces

  !> A motion that repeats after two mesh periods has harmonics between those of the mesh frequency.
  subroutine several_periods(t)
    type(tally_t), intent(inout) :: t
    type(study_t) :: study
    real(dp), allocatable :: harmonic(:), frequency(:)
    integer :: n

    call study_of(t, 0.03_dp, '&pair backlash_um = 12 /', 28000.0_dp, '''load''', study)
    n = nint(first(column_of(study, 'load_points', 'mesh_periods')))
    harmonic = column_of(study, 'motion_harmonics', 'harmonic')
    frequency = column_of(study, 'motion_harmonics', 'frequency_hz')
    call check_true(t, 'it repeats after several periods', n > 1, str(n))
    call check_true(t, 'so many harmonics more', size(harmonic) == 1 + 200*n)
    call check_close(t, 'the first harmonic', harmonic(2), 1.0_dp/n)
    call check_close(t, 'its frequency', frequency(2), teeth*28000/60.0_dp/n)
  end subroutine several_periods

  !> Root mean square and peak-to-peak transmission error of a sweep, from sums over its steps, are those of the task `load`, from
  !> quintics: in full contact, of one relief and of several that one map serves, with contact lost, on the coast sides, after
  !> several mesh periods, in graded steps, and by another method. In finer steps they come nearer.
  subroutine over_speed(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: coast = '&pair backlash_um = 12 /'

    call as_of_load('full', 0.2_dp, '', 9000.0_dp)
    call as_of_load('several reliefs', 0.2_dp, '', 9000.0_dp, reliefs='0, 0.5, 1.5')
    call as_of_load('lost', 0.06_dp, coast, 13000.0_dp)
    call as_of_load('coast', 0.06_dp, coast, 11500.0_dp)
    call as_of_load('several periods', 0.03_dp, coast, 28000.0_dp)
    call as_of_load('graded', 0.3_dp, '', 40.0_dp)
    call as_of_load('rk4', 0.2_dp, '', 9000.0_dp, method='method = ''rk4'' steps_per_period = 400')

  contains

    subroutine as_of_load(name, damping, more, rpm, reliefs, method)
      character(*), intent(in) :: name, more
      character(*), intent(in), optional :: reliefs, method
      real(dp), intent(in) :: damping, rpm
      character(*), parameter :: columns(2) = [character(19) :: 'dte_rms_um', 'dte_peak_to_peak_um']
      type(study_t) :: study
      real(dp), allocatable :: speed(:), found(:), expected(:), estimate(:)
      integer :: i

      call study_of(t, damping, more, rpm, '''load'', ''sweep''', study, reliefs, 'rpm_first = '//str(0.99_dp*rpm)// &
                    ' rpm_last = '//str(1.015_dp*rpm)//' rpm_step = '//str(0.01_dp*rpm)//' direction = ''each''', method)
      speed = column_of(study, 'sweep', 'rpm')
      do i = 1, size(columns)
        found = pack(column_of(study, 'sweep', trim(columns(i))), abs(speed - rpm) < 1e-6_dp*rpm)
        estimate = pack(column_of(study, 'sweep', 'dte_error_estimate_um'), abs(speed - rpm) < 1e-6_dp*rpm)
        expected = column_of(study, 'load_points', trim(columns(i)))
        call check_true(t, name//': the speed is there', size(found) == size(expected), str(size(found)))
        if (size(found) /= size(expected)) return
        call check_true(t, name//': '//trim(columns(i))//' within its estimate', all(abs(found - expected) <= estimate), &
                        str(maxval(abs(found - expected)))//' '//str(maxval(estimate)))
        call check_true(t, name//': the estimate is small', all(estimate < 1e-3_dp*expected), str(maxval(estimate/expected)))
      end do
    end subroutine as_of_load
  end subroutine over_speed
end module test_motion_summary
