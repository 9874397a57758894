!> One operating point has one answer in one run: what the tasks load, flank, rating and sweep say of it is the same.
module test_points
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use, intrinsic :: iso_fortran_env, only: int64
  use gearsweep_case, only: case_t
  use gearsweep_case_reader, only: read_case
  use gearsweep_error, only: error_t
  use gearsweep_kinds, only: dp
  use gearsweep_response, only: response_t
  use gearsweep_study, only: run_study, study_t
  use gearsweep_table, only: table_t
  use gearsweep_tables, only: column_of, make_table
  use gearsweep_text, only: str
  use random_numbers, only: random_t
  use testing, only: check_close, check_equal, check_no_error, check_true, tally_t
  implicit none
  private
  public :: run

  character(4), parameter :: directions(3) = ['each', 'up  ', 'down']

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t

    if (t%wants('the_point_that_differed')) call the_point_that_differed(t)
    if (t%wants('random_points')) call random_points(t)
    if (t%wants('between_the_speeds')) call between_the_speeds(t)
    if (t%wants('alone')) call alone(t)
    if (t%wants('of_all_tasks')) call of_all_tasks(t)
  end subroutine run

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

  !> 2.112 by load and 1.790 by sweep, before load took over what the sweep found.
  subroutine the_point_that_differed(t)
    type(tally_t), intent(inout) :: t
    type(study_t) :: study

    call study_of(t, 0.01_dp, 2.0_dp, 'each', 'rpm_first = 2000 rpm_last = 16000 rpm_step = 100', '6800', &
                  '''load'', ''sweep''', study)
    call same_answer(t, study, 1, 49)
  end subroutine the_point_that_differed

  !> Damping, relief, speeds and direction at random, at speeds of the sweep.
  subroutine random_points(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: cases = 30
    type(random_t) :: random
    type(study_t) :: study
    real(dp) :: first, step
    integer :: i, k(3), several, j

    random%seed = 6800
    several = 0
    do i = 1, cases
      ! Every fourth in the first parametric tongue, where the period doubles.
      first = anint(random%between(4000.0_dp, 8000.0_dp))*merge(4, 1, modulo(i, 4) == 0)
      step = anint(random%between(40.0_dp, 200.0_dp))
      k = 1 + [(int(40*random%uniform()), j=1, 3)]
      call study_of(t, random%power(0.003_dp, 0.03_dp), random%between(0.0_dp, 8.0_dp), directions(1 + modulo(i, 3)), &
                    'rpm_first = '//str(first)//' rpm_step = '//str(step)//' rpm_last = '//str(first + 40*step), &
                    str(first + (k(1) - 1)*step)//', '//str(first + (k(2) - 1)*step)//', '//str(first + (k(3) - 1)*step), &
                    '''load'', ''sweep''', study)
      do j = 1, 3
        call same_answer(t, study, j, k(j))
        if (nint(at(column_of(study, 'load_points', 'mesh_periods'), j)) > 1) several = several + 1
      end do
    end do
    call check_true(t, 'some repeat only after several periods', several > 0, str(several))
  end subroutine random_points

  !> Response j is speed k of the sweep, to the last bit; and the largest load on the pairs' paths is that dynamic
  !> factor, up to what the peak between two rows adds.
  subroutine same_answer(t, study, j, k)
    type(tally_t), intent(inout) :: t
    type(study_t), intent(in) :: study
    integer, intent(in) :: j, k
    character(:), allocatable :: what
    type(table_t) :: points, sweep
    type(error_t), allocatable :: error
    type(response_t) :: response

    call make_table(study, 'load_points', points, error)
    call make_table(study, 'sweep', sweep, error)
    call response_of(study, points, j, response)
    what = str(response%rpm)//' rpm'
    call check_close(t, what//': the speed', response%rpm, sweep%number('rpm', k))
    call check_equal(t, what//': status', trim(points%word('status', j)), trim(sweep%word('status', k)))
    call check_equal(t, what//': periods', response%point%steady%periods, nint(sweep%number('mesh_periods', k)))
    if (ieee_is_nan(sweep%number('dynamic_factor', k))) then
      call check_true(t, what//': one row without numbers', size(response%s) == 1 .and. all(ieee_is_nan(response%load)))
    else
      call check_true(t, what//': the same bits', transfer(response%point%dynamic_factor, 0_int64) == &
                      transfer(sweep%number('dynamic_factor', k), 0_int64))
      call rows_fit(t, what, study, response)
    end if
  end subroutine same_answer

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

  pure real(dp) function at(numbers, i)
    real(dp), intent(in) :: numbers(:)
    integer, intent(in) :: i

    at = numbers(i)
  end function at

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

  !> A speed that the sweep does not have is as in a sweep that has it.
  subroutine between_the_speeds(t)
    type(tally_t), intent(inout) :: t
    type(study_t) :: between, among
    integer :: i

    do i = 1, size(directions)
      call study_of(t, 0.02_dp, 5.0_dp, directions(i), 'rpm_first = 11000 rpm_last = 15000 rpm_step = 100', '13050, 10000, 16000', &
                    '''load'', ''sweep''', between)
      call study_of(t, 0.02_dp, 5.0_dp, directions(i), 'rpm_first = 11000 rpm_last = 15000 rpm_step = 50', '13050', &
                    '''load'', ''sweep''', among)
      call check_close(t, 'between, '//directions(i), at(column_of(between, 'load_points', 'dynamic_factor'), 1), &
                       at(column_of(among, 'load_points', 'dynamic_factor'), 1), absolute=2e-6_dp)
      call check_true(t, 'beyond, '//directions(i), .not. any(ieee_is_nan(column_of(between, 'load_points', 'dynamic_factor'))))
    end do
  end subroutine between_the_speeds

  !> Without a sweep, each speed by itself: as a sweep of this speed alone.
  subroutine alone(t)
    type(tally_t), intent(inout) :: t
    type(study_t) :: load, sweep

    call study_of(t, 0.01_dp, 2.0_dp, 'up', 'rpm_first = 6800 rpm_last = 6800 rpm_step = 1', '6800', '''load''', load)
    call study_of(t, 0.01_dp, 2.0_dp, 'up', 'rpm_first = 6800 rpm_last = 6800 rpm_step = 1', '6800', '''sweep''', sweep)
    call check_true(t, 'one speed', transfer(at(column_of(load, 'load_points', 'dynamic_factor'), 1), 0_int64) == &
                    transfer(at(column_of(sweep, 'sweep', 'dynamic_factor'), 1), 0_int64))
  end subroutine alone

  !> Gears, lightly damped over a resonance, and speeds that each task has in an order of its own.
  subroutine of_all_tasks(t)
    type(tally_t), intent(inout) :: t
    type(study_t) :: study
    type(case_t) :: case
    type(error_t), allocatable :: error
    type(table_t) :: sweep, flank, rating
    integer :: i

    call read_case('&case tasks = ''sweep'', ''load'', ''flank'', ''rating'' / &pair module_mm = 3 face_width_mm = 20 /'// &
                   '&pinion teeth = 21 / &gear teeth = 34 / &load normal_force_n = 4000 / &relief amount_um = 5 /'// &
                   '&mesh model = ''polynomial'' coefficients = 400, 0, -60 / &dynamics damping_ratio = 0.01 /'// &
                   '&sweep rpm_first = 14000 rpm_last = 24000 rpm_step = 500 load_rpm = 17000 /'// &
                   '&flank rpm = 21000, 16500, 19000 / &rating rpm = 19000, 15000, 21000, 16500 /', case, error)
    call check_no_error(t, 'gears: the case', error)
    call run_study(case, '', 1, study, error)
    call check_no_error(t, 'gears: the study', error)
    call make_table(study, 'sweep', sweep, error)
    call make_table(study, 'flank_losses', flank, error)
    call make_table(study, 'dynamic_factors', rating, error)
    call check_no_error(t, 'gears: the tables', error)
    do i = 1, flank%rows
      if (flank%word('loading', i) == 'dynamic') call same_factor(t, 'flank', sweep, flank, i)
    end do
    do i = 1, rating%rows
      call same_factor(t, 'rating', sweep, rating, i)
    end do
    call check_true(t, 'gears: contact is lost somewhere', any([(sweep%word('contact', i) == 'lost', i=1, sweep%rows)]))
  end subroutine of_all_tasks

  !> Row `i` of another task's table has the sweep's dynamic factor, bit for bit.
  subroutine same_factor(t, name, sweep, table, i)
    type(tally_t), intent(inout) :: t
    character(*), intent(in) :: name
    type(table_t), intent(in) :: sweep, table
    integer, intent(in) :: i
    integer :: k

    k = findloc(abs(sweep%numbers('rpm') - table%number('rpm', i)) < 1e-9_dp, .true., 1)
    call check_true(t, name//' at '//str(table%number('rpm', i))//' rpm: as the sweep', &
                    transfer(table%number('dynamic_factor', i), 0_int64) == transfer(sweep%number('dynamic_factor', k), 0_int64))
  end subroutine same_factor
end module test_points
