!> One operating point has one answer: what the tasks load, flank, rating, life, torque and sensitivity say of it is the same,
!> whatever other tasks a case names and however its sweep goes through the speeds.
module test_same_point_in_all_tasks
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use, intrinsic :: iso_fortran_env, only: int64
  use gearsweep_study_case_case, only: case_t
  use gearsweep_api_case_reader, only: read_case
  use gearsweep_base_error, only: error_t
  use gearsweep_motion_error_estimate, only: accuracy_t, point_t
  use gearsweep_base_kinds, only: dp
  use gearsweep_study_run_case_variation, only: build_motion
  use gearsweep_motion_oscillator, only: oscillator_t
  use gearsweep_motion_response, only: response_t
  use gearsweep_motion_steady_motion, only: has_result
  use gearsweep_study_run_study, only: run_study, study_t
  use gearsweep_base_table, only: table_t
  use gearsweep_api_tables, only: column_of, make_table
  use gearsweep_base_text, only: str
  use test_support_random_numbers, only: random_t
  use test_support_solve_one_point, only: solve
  use test_support_testing, only: check_close, check_equal, check_no_error, check_true, tally_t
  implicit none
  private
  public :: run

  character(4), parameter :: directions(4) = ['each', 'up  ', 'down', 'both']

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t

    if (t%wants('the_point_that_differed')) call the_point_that_differed(t)
    if (t%wants('random_points')) call random_points(t)
    if (t%wants('of_all_tasks')) call of_all_tasks(t)
    if (t%wants('the_largest_motion')) call the_largest_motion(t)
    if (t%wants('one_motion')) call one_motion(t)
    if (t%wants('at_the_brink')) call at_the_brink(t)
  end subroutine run

  !> As the relief grows, a pair parts from its mate somewhere. Halving between two reliefs leads to where it only just does: there
  !> too each has a motion, and as the dynamic factor has no jump, it is that of the last relief with which no pair parts, within
  !> the tolerance.
  subroutine at_the_brink(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: halvings = 45
    real(dp), parameter :: rpm = 15000
    type(case_t) :: case
    type(study_t) :: study
    type(oscillator_t) :: osc
    type(accuracy_t) :: options
    type(point_t) :: points(halvings)
    type(error_t), allocatable :: error
    real(dp) :: least, most, relief(halvings)
    integer :: i, last

    call read_case('&case tasks = ''sweep'' / &pair module_mm = 3.18 face_width_mm = 25.4 / &pinion teeth = 25 '// &
                   'effective_mass_kg = 0.8113 / &gear teeth = 25 effective_mass_kg = 0.8113 / &load line_load_n_mm = 276 / '// &
                   '&mesh model = ''weber'' corner_contact = .false. nonlinear_contact = .false. / '// &
                   '&dynamics damping_ratio = 0.12 / &sweep rpm_first = '//str(rpm)//' rpm_last = '//str(rpm)// &
                   ' rpm_step = 1 /', case, error)
    if (.not. allocated(error)) call run_study(case, '', 1, study, error)
    least = 10e-6_dp
    most = 25e-6_dp
    last = 0
    do i = 1, halvings
      relief(i) = (least + most)/2
      if (.not. allocated(error)) call build_motion(study%motions_inputs, relief(i), osc, error)
      call check_no_error(t, 'the case', error)
      if (allocated(error)) return
      call solve(osc, rpm, options, points(i))
      if (points(i)%steady%partial .or. .not. has_result(points(i)%steady%status)) then
        most = relief(i)
      else
        least = relief(i)
        last = i
      end if
    end do
    call check_true(t, 'some part and some do not', last > 0 .and. any(points%steady%partial))
    do i = 1, halvings
      call check_true(t, 'a motion', has_result(points(i)%steady%status), str(1e6_dp*relief(i), 17)//' um')
      if (abs(relief(i) - relief(last)) < 1e-12_dp) call check_close(t, 'dynamic factor', points(i)%dynamic_factor, &
        points(last)%dynamic_factor, absolute=2*options%steady%tolerance)
    end do
  end subroutine at_the_brink

  !> A prescribed mesh over a resonance, where motions with and without loss of contact exist side by side.
  subroutine study_of(t, damping, relief, direction, sweep, load, tasks, study)
    type(tally_t), intent(inout) :: t
    real(dp), intent(in) :: damping, relief
    character(*), intent(in) :: direction, sweep, load, tasks
    type(study_t), intent(out) :: study
    type(case_t) :: case
    type(error_t), allocatable :: error

    call read_case('&case tasks = '//tasks//' / &pinion teeth = 25 effective_mass_kg = 0.8 /'// &
                   '&gear effective_mass_kg = 0.9 / &load normal_force_n = 6858 / &relief amount_um = '//str(relief)// &
                   ' / &mesh model = ''polynomial'' contact_ratio = 1.6 coefficients = 400, 0, -120 /'// &
                   '&dynamics damping_ratio = '//str(damping)//' / &sweep '//sweep//' load_rpm = '//load// &
                   ' direction = '''//trim(direction)//''' /', case, error)
    call check_no_error(t, 'the case', error)
    if (.not. allocated(error)) call run_study(case, '', 1, study, error)
    call check_no_error(t, 'the study', error)
  end subroutine study_of

  !> With a sweep beside it this was 2.112 or 1.790, as the sweep went.
  subroutine the_point_that_differed(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: speeds = 'rpm_first = 2000 rpm_last = 16000 rpm_step = 100'
    type(study_t) :: alone, beside
    integer :: i

    call study_of(t, 0.01_dp, 2.0_dp, 'up', speeds, '6800', '''load''', alone)
    do i = 1, size(directions)
      call study_of(t, 0.01_dp, 2.0_dp, directions(i), speeds, '6800', '''load'', ''sweep''', beside)
      call same_answer(t, alone, beside)
    end do
  end subroutine the_point_that_differed

  !> Damping, relief, speeds and direction at random; a speed of the sweep, one between two and one beyond.
  subroutine random_points(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: cases = 12
    type(random_t) :: random
    type(study_t) :: alone, beside
    character(:), allocatable :: speeds, load
    real(dp) :: first, step, damping, relief
    integer :: i, several

    random%seed = 6800
    several = 0
    do i = 1, cases
      ! Every fourth in the first parametric tongue, where the period doubles.
      first = anint(random%between(4000.0_dp, 8000.0_dp))*merge(4, 1, modulo(i, 4) == 0)
      step = anint(random%between(40.0_dp, 200.0_dp))
      damping = random%power(0.003_dp, 0.03_dp)
      relief = random%between(0.0_dp, 8.0_dp)
      speeds = 'rpm_first = '//str(first)//' rpm_step = '//str(step)//' rpm_last = '//str(first + 8*step)
      load = str(first + 3*step)//', '//str(first + 5.5_dp*step)//', '//str(first + 9*step)
      call study_of(t, damping, relief, 'up', speeds, load, '''load''', alone)
      call study_of(t, damping, relief, directions(1 + modulo(i, 4)), speeds, load, '''load'', ''sweep''', beside)
      call same_answer(t, alone, beside)
      several = several + count(column_of(alone, 'load_points', 'mesh_periods') > 1)
    end do
    call check_true(t, 'some repeat only after several periods', several > 0, str(several))
  end subroutine random_points

  !> What the task load found is the same in both studies, to the last bit; and the largest load on the pairs' paths is the
  !> dynamic factor, up to what the peak between two rows adds.
  subroutine same_answer(t, alone, beside)
    type(tally_t), intent(inout) :: t
    type(study_t), intent(in) :: alone, beside
    character(:), allocatable :: what
    type(table_t) :: points, others
    type(error_t), allocatable :: error
    type(response_t) :: response
    integer :: j

    call make_table(alone, 'load_points', points, error)
    call make_table(beside, 'load_points', others, error)
    call check_true(t, 'the same bits beside a sweep', &
                    same_bits(column_of(alone, 'load', 'pair_load_n'), column_of(beside, 'load', 'pair_load_n')) .and. &
                    same_bits(points%numbers('dynamic_factor'), others%numbers('dynamic_factor')))
    do j = 1, points%rows
      call response_of(alone, points, j, response)
      what = str(response%rpm)//' rpm'
      call check_equal(t, what//': status', trim(points%word('status', j)), trim(others%word('status', j)))
      if (ieee_is_nan(response%point%dynamic_factor)) then
        call check_true(t, what//': one row without numbers', size(response%s) == 1 .and. all(ieee_is_nan(response%load)))
      else
        call rows_fit(t, what, alone, response)
      end if
    end do
  end subroutine same_answer

  pure logical function same_bits(a, b)
    real(dp), intent(in) :: a(:), b(:)

    same_bits = size(a) == size(b) .and. size(a) > 0
    if (same_bits) same_bits = all(transfer(a, [0_int64]) == transfer(b, [0_int64]))
  end function same_bits

  !> What the tables say of speed j. A speed that is asked for twice has its rows twice.
  subroutine response_of(study, points, j, response)
    type(study_t), intent(in) :: study
    type(table_t), intent(in) :: points          ! load_points
    integer, intent(in) :: j
    type(response_t), intent(out) :: response
    logical, allocatable :: here(:)
    integer :: n

    response%rpm = points%number('rpm', j)
    response%point%dynamic_factor = points%number('dynamic_factor', j)
    response%point%steady%periods = nint(points%number('mesh_periods', j))
    here = .not. abs(column_of(study, 'load', 'rpm') - response%rpm) > 0
    n = count(here)/count(.not. abs(points%numbers('rpm') - response%rpm) > 0)
    response%s = rows('s')
    response%load = rows('pair_load_n')
    response%error = rows('dte_um')
    response%pair = nint(rows('pair'))

  contains

    function rows(column)
      character(*), intent(in) :: column
      real(dp), allocatable :: rows(:)

      rows = pack(column_of(study, 'load', column), here)
      rows = rows(:n)
    end function rows
  end subroutine response_of

  subroutine rows_fit(t, what, study, response)
    type(tally_t), intent(inout) :: t
    character(*), intent(in) :: what
    type(study_t), intent(in) :: study
    type(response_t), intent(in) :: response
    integer :: i

    call check_close(t, what//': largest load', maxval(response%load)/study%load, response%point%dynamic_factor, 2e-3_dp)
    call check_equal(t, what//': as many pairs as periods', maxval(response%pair), response%point%steady%periods)
    do i = 1, maxval(response%pair)
      associate (s => pack(response%s, response%pair == i))
        call check_true(t, what//': each over its whole path', abs(s(1)) < 1e-12_dp .and. abs(s(size(s)) - 1.6_dp) < 1e-12_dp &
                        .and. all(s(2:) > s(:size(s) - 1) - 1e-12_dp))
      end associate
      ! The flanks of a pair that leaves one period and enters the next are the same flanks.
      associate (x => pack(response%error, response%pair == i .and. abs(response%s - 1) < 1e-9_dp))
        call check_true(t, what//': without a jump', maxval(x) - minval(x) < 1e-6_dp*maxval(abs(response%error)))
      end associate
    end do
  end subroutine rows_fit

  !> Gears, lightly damped over a resonance, and speeds that each task has in an order of its own.
  subroutine of_all_tasks(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: motions = '''load'', ''flank'', ''rating'', ''life'', ''sensitivity'''
    type(study_t) :: alone, beside
    type(table_t) :: load
    type(error_t), allocatable :: error

    call study_of_gears(t, motions, alone)
    call study_of_gears(t, '''sweep'', '//motions, beside)
    call make_table(alone, 'load_points', load, error)
    call check_no_error(t, 'gears: the table', error)
    call same_factors(t, 'load_points', load, beside)
    call same_factors(t, 'flank_losses', load, alone)
    call same_factors(t, 'dynamic_factors', load, alone)
    call same_factors(t, 'life_parts', load, alone)
    call same_factors(t, 'torque_points', load, alone)
  end subroutine of_all_tasks

  !> It is no less than what sweeps up and down follow, and the largest that the task `attractors` has a start for, which also says
  !> how many there are. Up to now it was whichever the search without starts came upon, here the one of least factor.
  subroutine the_largest_motion(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: speeds = 'rpm_first = 6000 rpm_last = 15000 rpm_step = 100', &
      chosen = '6500, 7000, 9500, 10500, 12000, 14500'
    type(study_t) :: rising, falling, load, search, coarse
    type(table_t) :: up, down, points, motions
    type(error_t), allocatable :: error
    real(dp), allocatable :: reached(:)
    real(dp) :: swept
    integer :: i, k, several

    call study_of(t, 0.02_dp, 0.0_dp, 'up', speeds, chosen, '''sweep''', rising)
    call study_of(t, 0.02_dp, 0.0_dp, 'down', speeds, chosen, '''sweep''', falling)
    call study_of(t, 0.02_dp, 0.0_dp, 'up', speeds, chosen, '''load''', load)
    call study_of(t, 0.02_dp, 0.0_dp, 'up', speeds, chosen, '''attractors'' / &attractors rpm = '//chosen, search)
    call make_table(rising, 'sweep', up, error)
    call make_table(falling, 'sweep', down, error)
    call make_table(load, 'load_points', points, error)
    call make_table(search, 'attractors', motions, error)
    call check_no_error(t, 'the tables', error)
    several = 0
    do i = 1, points%rows
      associate (factor => points%number('dynamic_factor', i), rpm => points%number('rpm', i))
        k = findloc(abs(up%numbers('rpm') - rpm) < 1e-6_dp, .true., 1)
        swept = max(up%number('dynamic_factor', k), down%number('dynamic_factor', k))
        call check_true(t, 'no less than the sweeps at '//str(rpm), factor > swept - 1e-5_dp, str(factor)//' and '//str(swept))
        if (abs(up%number('dynamic_factor', k) - down%number('dynamic_factor', k)) > 0.5_dp) several = several + 1
        reached = pack(motions%numbers('dynamic_factor'), abs(motions%numbers('rpm') - rpm) < 1e-6_dp .and. &
                       motions%numbers('share') > 0)
        call check_close(t, 'the largest that a start reaches at '//str(rpm), factor, maxval(reached), absolute=1e-5_dp)
        call check_true(t, 'as many motions at '//str(rpm), abs(points%number('motions', i) - size(reached)) < 0.5_dp, &
                        str(points%number('motions', i))//' and '//str(size(reached)))
      end associate
    end do
    call check_true(t, 'up and down differ at some of these speeds', several > 0)
    ! A method of the literature does not hold all of them, and does not say how many there are.
    call study_of(t, 0.02_dp, 0.0_dp, 'up', speeds, chosen, '''load'' / &numerics method = ''rk4''', coarse)
    call check_true(t, 'not known by Runge-Kutta', all(ieee_is_nan(column_of(coarse, 'load_points', 'motions'))))
  end subroutine the_largest_motion

  !> Well damped motions and slow ones are single, and said to be so.
  subroutine one_motion(t)
    type(tally_t), intent(inout) :: t
    type(study_t) :: study

    call study_of(t, 0.17_dp, 0.0_dp, 'up', 'rpm_first = 6000 rpm_last = 6000 rpm_step = 1', '1, 100, 3000, 14000, 30000', &
                  '''load''', study)
    call check_true(t, 'one motion at each speed', all(abs(column_of(study, 'load_points', 'motions') - 1) < 0.5_dp))
  end subroutine one_motion

  subroutine study_of_gears(t, tasks, study)
    type(tally_t), intent(inout) :: t
    character(*), intent(in) :: tasks
    type(study_t), intent(out) :: study
    type(case_t) :: case
    type(error_t), allocatable :: error

    call read_case('&case tasks = '//tasks//' / &pair module_mm = 3 face_width_mm = 20 /'// &
                   '&pinion teeth = 21 / &gear teeth = 34 / &load normal_force_n = 4000 / &relief amount_um = 5 /'// &
                   '&mesh model = ''polynomial'' coefficients = 400, 0, -60 / &dynamics damping_ratio = 0.01 /'// &
                   '&sweep rpm_first = 14000 rpm_last = 24000 rpm_step = 500 direction = ''down'' '// &
                   'load_rpm = 15000, 16500, 19000, 21000 load_torque = .true. / &flank rpm = 21000, 16500, 19000 / '// &
                   '&rating rpm = 19000, 15000, 21000, 16500 / &life rpm = 16500, 21000 duration_h = 1, 1 '// &
                   'curve_cycles = 1e3, 1e6 curve_stress_mpa = 500, 86 '// &
                   'mean_stress = ''none'' / &sensitivity rpm = 19000, 16500 /', case, error)
    call check_no_error(t, 'gears: the case', error)
    call run_study(case, '', 1, study, error)
    call check_no_error(t, 'gears: the study', error)
  end subroutine study_of_gears

  !> Each row of another table with a motion has the dynamic factor of the table `load`, bit for bit.
  subroutine same_factors(t, name, load, study)
    type(tally_t), intent(inout) :: t
    character(*), intent(in) :: name
    type(table_t), intent(in) :: load
    type(study_t), intent(in) :: study
    type(table_t) :: table
    type(error_t), allocatable :: error
    integer :: i, k

    call make_table(study, name, table, error)
    call check_no_error(t, 'gears: the table '//name, error)
    do i = 1, table%rows
      if (name == 'flank_losses') then
        if (table%word('loading', i) == 'static') cycle
      end if
      k = findloc(abs(load%numbers('rpm') - table%number('rpm', i)) < 1e-9_dp, .true., 1)
      call check_true(t, name//' at '//str(table%number('rpm', i))//' rpm: as load', &
                      same_bits([table%number('dynamic_factor', i)], [load%number('dynamic_factor', k)]), &
                      str(table%number('dynamic_factor', i))//' and '//str(load%number('dynamic_factor', k)))
    end do
  end subroutine same_factors
end module test_same_point_in_all_tasks
