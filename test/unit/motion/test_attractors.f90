!> All attracting motions of operating points: against an independent solver from starts of its own, and what does not depend
!> on how they are found.
module test_attractors
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use, intrinsic :: iso_c_binding, only: c_int, c_loc
  use gearsweep_motion_attractors, only: attractors_t, find_attractors, largest_reached
  use gearsweep_motion_attractors, only: attractor_options_t, start_states
  use gearsweep_study_case_case, only: case_t
  use gearsweep_api_case_reader, only: read_case
  use gearsweep_base_error, only: error_t
  use gearsweep_base_kinds, only: dp
  use gearsweep_motion_oscillator, only: mesh_period, oscillator_t
  use gearsweep_motion_steady_motion, only: has_result, status_ok, status_stopped, status_unresolved
  use gearsweep_study_run_study, only: run_study, study_t
  use gearsweep_api_tables, only: column_of
  use gearsweep_base_text, only: str
  use test_support_ask_by_name, only: answer_t, ask
  use test_support_reference_rows, only: next_row, oscillator_of, row_of, row_t
  use test_support_testing, only: check_close, check_equal, check_no_error, check_true, tally_t
  implicit none
  private
  public :: run

  !> A row of motions.dat with its motions.
  type :: known_row_t
    type(row_t) :: row
    integer, allocatable :: periods(:)
    real(dp), allocatable :: factor(:), share(:)
    real(dp) :: nowhere = 0
  end type known_row_t

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t

    if (t%wants('independent_solver')) call independent_solver(t)
    if (t%wants('one_motion')) call one_motion(t)
    if (t%wants('any_threads')) call any_threads(t)
    if (t%wants('no_damping')) call no_damping(t)
    if (t%wants('ended_and_too_slow')) call ended_and_too_slow(t)
    if (t%wants('grid_of_starts')) call grid_of_starts(t)
    if (t%wants('in_a_sweep')) call in_a_sweep(t)
    if (t%wants('reached')) call reached(t)
    if (t%wants('followed_by_damping')) call followed_by_damping(t)
  end subroutine run

  !> A pair of which the independent solver knows three motions at 8000 rpm, two of them with dynamic factors of 1.017275, where all
  !> pairs carry, and 2.244301; with strong damping there is one.
  subroutine in_a_sweep(t)
    type(tally_t), intent(inout) :: t
    type(case_t) :: case
    type(study_t) :: study
    type(error_t), allocatable :: error
    character(4), parameter :: damping(2) = ['1e-3', '0.5 ']
    real(dp), dimension(2) :: motions, largest, share, factor
    integer :: i

    do i = 1, 2
      call read_case('&case tasks = ''sweep'' / &pinion teeth = 25 effective_mass_kg = 1 / &gear effective_mass_kg = 1 /'// &
                     '&load normal_force_n = 3000 / &relief amount_um = 0 / &mesh model = ''polynomial'' contact_ratio = 1.6'// &
                     ' coefficients = 300 / &dynamics damping_ratio = '//damping(i)//' / &sweep rpm_first = 8000'// &
                     ' rpm_last = 8000 rpm_step = 1 direction = ''all'' /', case, error)
      call check_no_error(t, 'the case', error)
      call run_study(case, '', 1, study, error)
      call check_no_error(t, 'the study', error)
      motions(i:i) = column_of(study, 'sweep', 'motions')
      largest(i:i) = column_of(study, 'sweep', 'largest_dynamic_factor')
      share(i:i) = column_of(study, 'sweep', 'share')
      factor(i:i) = column_of(study, 'sweep', 'dynamic_factor')
    end do
    call check_close(t, 'the sweep tells the linear motion', factor(1), 1.017275_dp, absolute=1e-6_dp)
    call check_true(t, 'others are known', motions(1) >= 3, str(motions(1)))
    call check_true(t, 'the largest of all', largest(1) > 2.244300_dp, str(largest(1)))
    call check_true(t, 'a part of the starts leads to it', share(1) > 0 .and. share(1) < 1, str(share(1)))
    call check_close(t, 'damped: the largest is its own', largest(2), factor(2), absolute=2e-6_dp)
    call check_close(t, 'damped: all starts lead to it', share(2), 1.0_dp)
    call check_close(t, 'damped: one motion', motions(2), 1.0_dp)
  end subroutine in_a_sweep

  !> A motion that no start reaches counts for no largest value, unless a sweep shows it; one without a result never does.
  subroutine reached(t)
    type(tally_t), intent(inout) :: t
    type(attractors_t) :: found

    allocate (found%motion(3))
    found%motion%point%dynamic_factor = [1.2_dp, 7.0_dp, 996.0_dp]
    found%motion%point%steady%status = status_ok
    found%motion%starts = [60, 3, 0]
    call check_close(t, 'reached by starts', largest_reached(found), 7.0_dp)
    found%motion(2)%point%steady%status = status_stopped
    call check_close(t, 'with a result', largest_reached(found), 1.2_dp)
    found%alone_is = 3
    call check_close(t, 'shown by a sweep', largest_reached(found), 996.0_dp)
    found%motion%starts = 0
    found%alone_is = 0
    call check_true(t, 'reached by none', ieee_is_nan(largest_reached(found)))
  end subroutine reached

  !> motions.dat: what the solver knows from its starts, and what is found here from others.
  subroutine independent_solver(t)
    type(tally_t), intent(inout) :: t
    type(known_row_t), allocatable :: rows(:)
    type(oscillator_t) :: osc
    type(attractors_t) :: found(1)
    integer :: i, k, m, large, listed, shares, apart
    character(:), allocatable :: name
    real(dp) :: spread

    call read_motions('test/reference/motions.dat', rows)
    large = 0
    listed = 0
    shares = 0
    apart = 0
    do i = 1, size(rows)
      call oscillator_of(rows(i)%row, osc)
      call find_attractors(osc, [rows(i)%row%rpm], attractor_options_t(), found)
      name = 'row '//str(i)//', '
      do k = 1, size(rows(i)%periods)
        m = place_of(rows(i)%periods(k), rows(i)%factor(k), found(1))
        if (rows(i)%share(k) > 0.01_dp) large = large + 1
        if (m == 0) cycle
        if (rows(i)%share(k) > 0.01_dp) listed = listed + 1
        associate (motion => found(1)%motion(m), s => rows(i)%share(k))
          call check_close(t, name//'dynamic factor', motion%point%dynamic_factor, rows(i)%factor(k), &
                           absolute=2*motion%point%estimate + 1e-9_dp)
          ! Four standard deviations of two samples, and a start of ours.
          spread = 4*sqrt(s*(1 - s)*(1/100.0_dp + 1/64.0_dp)) + 1/64.0_dp
          shares = shares + 1
          if (abs(motion%starts/64.0_dp - s) > spread + rows(i)%nowhere) apart = apart + 1
        end associate
      end do
      call check_close(t, name//'every start counts once', real(sum(found(1)%motion%starts) + count(found(1)%to == 0), dp), &
                       64.0_dp, absolute=0.0_dp)
    end do
    call check_true(t, 'of the attractors that the solver knows, some have a share', large > size(rows))
    call check_true(t, 'of these, 99 % are listed', listed >= 0.99_dp*large, str(listed)//' of '//str(large))
    call check_true(t, 'shares are those of the solver', apart <= 0.02_dp*shares, str(apart)//' of '//str(shares))
  end subroutine independent_solver

  !> Which of the motions found has these periods and this dynamic factor; 0: none.
  pure integer function place_of(periods, factor, found) result(m)
    integer, intent(in) :: periods
    real(dp), intent(in) :: factor
    type(attractors_t), intent(in) :: found

    do m = size(found%motion), 1, -1
      associate (point => found%motion(m)%point)
        if (has_result(point%steady%status) .and. point%steady%periods == periods .and. &
            abs(point%dynamic_factor - factor) < 1e-4_dp*factor) return
      end associate
    end do
  end function place_of

  subroutine read_motions(path, rows)
    character(*), intent(in) :: path
    type(known_row_t), allocatable, intent(out) :: rows(:)
    type(known_row_t) :: none
    character(1000) :: line
    character(10) :: word
    real(dp) :: factor, modulus, x, v, share
    integer :: unit, periods, loss

    allocate (rows(0))
    open (newunit=unit, file=path, status='old', action='read')
    do while (next_row(unit, line))
      read (line, *) word
      select case (word)
      case ('row')
        none = known_row_t(row_of(line(4:)), [integer ::], [real(dp) ::], [real(dp) ::])
        rows = [rows, none]
      case ('motion')
        read (line(7:), *) periods, factor, modulus, x, v, loss, share
        associate (row => rows(size(rows)))
          row%periods = [row%periods, periods]
          row%factor = [row%factor, factor]
          row%share = [row%share, share]
        end associate
      case ('nowhere')
        read (line(8:), *) rows(size(rows))%nowhere
      case default
        error stop 'motions.dat'
      end select
    end do
    close (unit)
  end subroutine read_motions

  !> Much damping: the motion is linear, and all starts lead to it.
  subroutine one_motion(t)
    type(tally_t), intent(inout) :: t
    type(attractors_t) :: found(3)

    call find_attractors(oscillator(0.5_dp), [2000.0_dp, 9000.0_dp, 40000.0_dp], attractor_options_t(), found)
    call check_true(t, 'one motion', all([size(found(1)%motion), size(found(2)%motion), size(found(3)%motion)] == 1))
    call check_true(t, 'all starts lead to it', all([found(1)%to, found(2)%to, found(3)%to] == 1))
    call check_true(t, 'it is that of the speed by itself', all(found%alone_is == 1))
  end subroutine one_motion

  !> 25 teeth, 0.8 kg, 7000 N, contact ratio 1.6, 400 N/um, no relief.
  type(oscillator_t) function oscillator(damping_ratio)
    real(dp), intent(in) :: damping_ratio

    call oscillator_of(row_of('1 25 25 20 1.6 0.8 1 400 0 0 0 0 0.8 0.8 7000 '//str(damping_ratio)//' 0 -1 0 0 1 9000'), oscillator)
  end function oscillator

  !> The same bits for one thread and for two, and for a speed by itself.
  subroutine any_threads(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: rpm(*) = [5000.0_dp, 7000.0_dp, 9000.0_dp, 11000.0_dp]
    type(attractors_t) :: one(size(rpm)), two(size(rpm)), alone(1)
    type(attractor_options_t) :: options
    integer :: i

    options%starts = 5
    options%threads = 1
    call find_attractors(oscillator(0.02_dp), rpm, options, one)
    options%threads = 2
    call find_attractors(oscillator(0.02_dp), rpm, options, two)
    call find_attractors(oscillator(0.02_dp), rpm(3:3), options, alone)
    do i = 1, size(rpm)
      call check_true(t, str(rpm(i))//' rpm, two threads', are_same(one(i), two(i)))
    end do
    call check_true(t, 'a speed by itself', are_same(one(3), alone(1)))
    call check_true(t, 'somewhere several motions attract', any([(size(one(i)%motion) > 1, i=1, size(rpm))]))
  end subroutine any_threads

  pure logical function are_same(a, b)
    type(attractors_t), intent(in) :: a, b

    are_same = size(a%motion) == size(b%motion)
    if (.not. are_same) return
    are_same = all(a%to == b%to) .and. all(a%motion%starts == b%motion%starts) .and. &
               .not. any(abs(a%motion%point%dynamic_factor - b%motion%point%dynamic_factor) > 0)
  end function are_same

  !> Without damping nothing is captured, and the motion in full contact is known all the same.
  subroutine no_damping(t)
    type(tally_t), intent(inout) :: t
    type(attractors_t) :: found(1)

    call find_attractors(oscillator(0.0_dp), [30000.0_dp], attractor_options_t(), found)
    call check_equal(t, 'searched', found(1)%status, status_ok)
    call check_true(t, 'a motion is known', size(found(1)%motion) > 0)
  end subroutine no_damping

  subroutine ended_and_too_slow(t)
    type(tally_t), intent(inout) :: t
    type(attractors_t) :: found(2)
    type(attractor_options_t) :: options
    integer(c_int), target :: stop

    call find_attractors(oscillator(0.02_dp), [1e-3_dp, 9000.0_dp], options, found)
    call check_equal(t, 'too slow', found(1)%status, status_unresolved)
    call check_equal(t, 'too slow: no motions', size(found(1)%motion), 0)
    call check_equal(t, 'the other is not', found(2)%status, status_ok)
    stop = 1
    options%accuracy%steady%stop = c_loc(stop)
    call find_attractors(oscillator(0.02_dp), [9000.0_dp, 9100.0_dp], options, found)
    call check_true(t, 'ended by the caller', all(found%status == status_stopped))
  end subroutine ended_and_too_slow

  !> The starts fill their grid evenly about rest.
  subroutine grid_of_starts(t)
    type(tally_t), intent(inout) :: t
    type(oscillator_t) :: osc
    type(attractor_options_t) :: options
    real(dp), allocatable :: start(:, :)
    real(dp) :: duration

    osc = oscillator(0.02_dp)
    duration = mesh_period(25, 9000.0_dp)
    start = start_states(osc, duration, options)
    call check_equal(t, 'how many', size(start, 2), options%starts**2)
    call check_close(t, 'middle', sum(start(1, :))/size(start, 2), osc%mean_deflection, 1e-12_dp)
    call check_close(t, 'as wide as asked for', maxval(start(1, :)) - minval(start(1, :)), &
                     2*options%span*osc%static_deflection*(1 - 1.0_dp/options%starts), 1e-12_dp)
    call check_close(t, 'velocities', maxval(start(2, :)), options%span*osc%static_deflection*osc%natural_frequency*duration* &
                     (1 - 1.0_dp/options%starts), 1e-12_dp)
  end subroutine grid_of_starts
  !> The transient decays as exp(-zeta omega t): at this speed to a tenth over the 2000 mesh periods that were the default, of
  !> which most starts need more.
  subroutine followed_by_damping(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: begin = '&case tasks = ''attractors'' / &pinion teeth = 25 effective_mass_kg = 0.8 / '// &
      '&gear effective_mass_kg = 0.8 / &load normal_force_n = 7000 / &mesh model = ''polynomial'' contact_ratio = 1.6 '// &
      'coefficients = 400 / &dynamics damping_ratio = 2e-4 / &attractors rpm = 52000 starts = 4 '
    type(answer_t) :: short, enough

    call ask(t, begin//'followed_periods = 2000 /', short)
    call ask(t, begin//'/', enough)
    call check_true(t, '2000 periods are too few', short%one('attractor_points.unsettled_share') > 0.5_dp)
    call check_true(t, 'as many as it takes', enough%one('attractor_points.unsettled_share') < 0.25_dp)
  end subroutine followed_by_damping
end module test_attractors
