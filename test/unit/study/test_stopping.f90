!> A run that its caller ends keeps what is done, with the bits of a run to the end, and says what is missing.
module test_stopping
  use, intrinsic :: iso_c_binding, only: c_int, c_loc
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use, intrinsic :: iso_fortran_env, only: int64
  use gearsweep_study_case_case, only: case_t
  use gearsweep_study_case_task, only: split_names, table_length
  use gearsweep_api_case_reader, only: read_case
  use gearsweep_base_error, only: error_t
  use gearsweep_base_kinds, only: dp
  use gearsweep_motion_resolution, only: resolution_t
  use gearsweep_motion_contact_set, only: period_t
  use gearsweep_motion_oscillator, only: make_oscillator, mesh_period, oscillator_t
  use gearsweep_motion_period, only: run_period
  use gearsweep_motion_period_map, only: discretise, period_map_t, set_durations
  use gearsweep_motion_steady_motion, only: status_name, status_stopped
  use gearsweep_study_run_study, only: run_study, study_t
  use gearsweep_base_table, only: table_t
  use gearsweep_api_tables, only: column_of, make_table
  use gearsweep_base_text, only: str
  use test_support_reference_rows, only: prescribed
  use test_support_reproducible, only: write_reproducible
  use test_support_testing, only: check_equal, check_no_error, check_true, tally_t
  implicit none
  private
  public :: run

  character(*), parameter :: gears = '&pinion teeth = 25 effective_mass_kg = 0.8 / &gear effective_mass_kg = 0.9 /'// &
    '&load normal_force_n = 6858 / &relief amount_um = 0, 2, 15 / &dynamics damping_ratio = 0.01 /'// &
    '&mesh model = ''polynomial'' contact_ratio = 1.6 coefficients = 400, 0, -120 /'

  !> Stop flag and counts of a run, and how many points it may do; only the tests of this module use them, one after the other.
  integer(c_int), target :: watch(3)
  integer :: last_done, allowed
  logical :: fell, beyond

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t

    if (t%wants('ended up')) call ended(t, 'up', '''sweep'', ''load''', '', 1, [60, 150, 240])
    if (t%wants('ended down')) call ended(t, 'down', '''sweep'', ''load''', '', 2, [60, 150, 240])
    if (t%wants('ended both')) call ended(t, 'both', '''sweep'', ''load''', '', 2, [60, 150, 200, 240])
    if (t%wants('ended each')) call ended(t, 'each', '''sweep'', ''load''', '', 2, [60, 150, 240])
    if (t%wants('ended optimum')) call ended(t, 'up', '''sweep'', ''optimum''', '', 2, [100, 400, 1200])
    if (t%wants('ended march')) &
      call ended(t, 'each', '''sweep''', '&numerics steady_state = ''march'' tolerance = 1e-4 /', 1, [30, 150])
    if (t%wants('ended tasks')) call ended(t, 'up', &
      '''stability'', ''hysteresis'', ''poincare'', ''attractors'', ''load''', &
      '&stability damping_count = 3 tongues = 1 / &hysteresis rpm = 6700, 6800, 6900 closeness = 1e-2 /'// &
      '&poincare rpm = 6800, 7000 settling_periods = 20 kept_periods = 9 / &attractors rpm = 6800, 7000 starts = 2 /', 2, &
      [1, 6, 87, 88, 96])
    if (t%wants('ended_at_once')) call ended_at_once(t)
    if (t%wants('cut')) call cut(t)
  end subroutine run

  subroutine read(t, direction, tasks, more, case)
    type(tally_t), intent(inout) :: t
    character(*), intent(in) :: direction, tasks, more
    type(case_t), intent(out) :: case
    type(error_t), allocatable :: error

    call read_case('&case tasks = '//tasks//' / '//gears//more//'&sweep rpm_first = 5000 rpm_last = 9000 rpm_step = 50 '// &
                   'load_rpm = 6800, 7010 direction = '''//direction//''' /', case, error)
    call check_no_error(t, 'the case', error)
  end subroutine read

  !> Counts, and ends the run once as many points are done as it was allowed.
  subroutine follow(done, total)
    integer, intent(in) :: done, total

    fell = fell .or. done < last_done
    beyond = beyond .or. done > total
    if (done >= allowed) watch(1) = 1
    last_done = done
  end subroutine follow

  !> Ends a run after each of these numbers of points.
  subroutine ended(t, direction, tasks, more, threads, points)
    type(tally_t), intent(inout) :: t
    character(*), intent(in) :: direction, tasks, more
    integer, intent(in) :: threads, points(:)
    type(case_t) :: case
    type(study_t) :: whole, piece
    type(error_t), allocatable :: error
    character(:), allocatable :: what
    integer :: i

    call read(t, direction, tasks, more, case)
    call run_study(case, '', 1, whole, error)
    call check_no_error(t, direction//' '//tasks//more//': to the end', error)
    do i = 1, size(points)
      what = direction//' '//tasks//more//' '//str(points(i))//': '
      watch = 0
      allowed = points(i)
      last_done = 0
      fell = .false.
      beyond = .false.
      call run_study(case, '', threads, piece, error, follow, watch=watch)
      call check_no_error(t, what//'ended', error)
      call check_true(t, what//'it is stopped', piece%stopped .and. .not. whole%stopped)
      call check_true(t, what//'the count never falls, nor passes the whole', .not. (fell .or. beyond))
      call check_true(t, what//'the caller reads the count', watch(2) == last_done .and. watch(3) >= watch(2))
      call check_tasks(t, what, piece, whole)
    end do
  end subroutine ended

  !> A finished task has all its tables, to the bit; one that is not finished has none, and the log names it; the sweep has its
  !> finished points.
  subroutine check_tasks(t, what, piece, whole)
    type(tally_t), intent(inout) :: t
    character(*), intent(in) :: what
    type(study_t), intent(in) :: piece, whole
    character(table_length), allocatable :: names(:)
    character(:), allocatable :: one, other
    type(error_t), allocatable :: error
    logical :: alike
    integer :: i, k

    do i = 1, size(whole%tasks)
      associate (info => whole%tasks(i)%info, task => piece%tasks(i)%task)
        if (.not. whole%tasks(i)%is_requested) cycle
        if (task%is_stopped .and. info%name == 'sweep') then
          call check_part(t, what, piece, whole)
          cycle
        end if
        call split_names(info%tables//' '//info%fields, names)
        alike = .true.
        do k = 1, size(names)
          call write_reproducible(piece, names(k), one, error)
          call write_reproducible(whole, names(k), other, error)
          if (.not. task%is_done) alike = alike .and. .not. allocated(one)
          if (.not. (task%is_done .and. allocated(other))) cycle
          alike = alike .and. allocated(one)
          if (allocated(one)) alike = alike .and. one == other
        end do
        if (task%is_done) call check_true(t, what//trim(info%name)//' is finished, with its bits', &
                                          alike .and. .not. task%is_stopped)
        if (.not. task%is_done) call check_true(t, what//trim(info%name)//' has no table, and the log says so', alike .and. &
          index(piece%log, trim(info%name)//' left out: the run was interrupted') > 0, piece%log)
      end associate
    end do
  end subroutine check_tasks

  !> What is there is right, and what is not says so and has no number.
  subroutine check_part(t, what, piece, whole)
    type(tally_t), intent(inout) :: t
    character(*), intent(in) :: what
    type(study_t), intent(in) :: piece, whole
    type(table_t) :: some, all_points
    type(error_t), allocatable :: error

    call make_table(piece, 'sweep', some, error)
    call make_table(whole, 'sweep', all_points, error)
    associate (status => some%columns(some%position('status'))%words, &
               right => all_points%columns(all_points%position('status'))%words, factor => some%numbers('dynamic_factor'))
      associate (done => status /= status_name(status_stopped))
        call check_true(t, what//'some points are missing', .not. all(done))
        call check_true(t, what//'done points have their status', all(status == right .or. .not. done))
        call check_true(t, what//'and their bits', all(bits(factor) == bits(all_points%numbers('dynamic_factor')) .or. .not. done))
        call check_true(t, what//'the others have no number', all(ieee_is_nan(factor) .or. done))
        call check_true(t, what//'the log counts them', index(piece%log, 'sweep: interrupted, '//str(count(done))//' of '// &
                        str(size(done))//' operating points computed') > 0, piece%log)
      end associate
    end associate
  end subroutine check_part

  pure function bits(x)
    real(dp), intent(in) :: x(:)
    integer(int64) :: bits(size(x))

    bits = transfer(x, [0_int64])
  end function bits

  !> A flag that is set before: nothing is computed, and nothing goes wrong.
  subroutine ended_at_once(t)
    type(tally_t), intent(inout) :: t
    type(case_t) :: case
    type(study_t) :: study
    type(error_t), allocatable :: error

    call read(t, 'up', '''mesh'', ''sweep''', '', case)
    watch = [1, 0, 0]
    call run_study(case, '', 2, study, error, watch=watch)
    call check_no_error(t, 'ended at once', error)
    call check_true(t, 'the mesh is there', size(column_of(study, 'mesh', 'ste_um')) > 0)
    call check_true(t, 'the sweep is not', study%stopped .and. size(column_of(study, 'sweep', 'rpm')) == 0)
    call check_true(t, 'the log says so', index(study%log, 'sweep left out: the run was interrupted') > 0)
    call check_equal(t, 'nothing was counted', int(watch(2)), 0)
  end subroutine ended_at_once

  !> A period of many steps, as that of hunting teeth, ends before its end.
  subroutine cut(t)
    type(tally_t), intent(inout) :: t
    integer(c_int), target :: flag
    type(oscillator_t) :: osc
    type(period_map_t) :: map
    type(period_t) :: period
    type(error_t), allocatable :: error
    real(dp) :: before
    integer :: i

    call prescribed(1.6_dp, [400.0_dp, 0.0_dp, -120.0_dp], [14.0_dp, 9.0_dp], 1, osc)
    osc%load = 7000
    osc%mass = [0.8_dp, 0.9_dp]
    osc%damping_ratio = 0.1_dp
    osc%mesh%teeth = [25, 25]
    call make_oscillator(osc, error)
    call check_no_error(t, 'oscillator', error)
    call discretise(osc, resolution_t(10000.0_dp), map)
    do i = 0, 1
      flag = int(i, c_int)
      call set_durations(map, [mesh_period(osc%mesh%teeth(1), 5000.0_dp)], c_loc(flag))
      before = map%work
      call run_period(map, [2*osc%static_deflection, 0.0_dp], period)
      call check_true(t, merge('cut  ', 'whole', i == 1), period%failed .eqv. i == 1)
      call check_true(t, 'steps', merge(map%work - before < 0.9_dp*map%steps, map%work - before >= map%steps, i == 1), &
                      str(map%work - before))
    end do
  end subroutine cut
end module test_stopping
