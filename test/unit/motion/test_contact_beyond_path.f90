!> Contact before A and behind E, and shared compliance: statics against closed forms, the motion against an integrator
!> written apart, and what must not depend on how it is computed.
module test_contact_beyond_path
  use gearsweep_motion_resolution, only: resolution_t, scheme_constant, scheme_rk4, scheme_rk4_equal
  use gearsweep_motion_contact_set, only: period_t
  use gearsweep_elastic_disc, only: disc_t
  use gearsweep_base_error, only: error_t
  use gearsweep_motion_error_estimate, only: accuracy_t, point_t
  use gearsweep_motion_gauss, only: batch_size
  use gearsweep_mesh_harmonics, only: find_harmonics, harmonics_t
  use gearsweep_base_kinds, only: dp, pi
  use gearsweep_mesh_mesh, only: mesh_t
  use gearsweep_motion_oscillator, only: make_oscillator, mesh_period, oscillator_t
  use gearsweep_motion_period, only: run_batch
  use gearsweep_motion_period_map, only: discretise, period_map_t, set_durations
  use gearsweep_base_piecewise, only: piecewise_t, polynomial, spline
  use gearsweep_mesh_smooth_intervals, only: profile_table
  use gearsweep_gear_relief, only: linear, profile_error, relief_t
  use gearsweep_motion_response, only: find_response, response_t
  use gearsweep_mesh_sharing, only: load_share, share_load, sharing_t
  use gearsweep_motion_steady_motion, only: status_ok
  use gearsweep_nonlinear_stability, only: map_stability, stability_t
  use gearsweep_motion_sweep, only: down, each, run_sweep, sweep_options_t, sweep_t, up
  use gearsweep_base_text, only: str
  use test_support_reference_rows, only: complete, next_row, row_t
  use test_support_solve_one_point, only: solve
  use test_support_testing, only: check_close, check_error, check_no_error, check_true, tally_t
  implicit none
  private
  public :: run

  type, extends(row_t) :: corner_row_t
    integer :: events = 0, beyond = 0, apart = 0
    real(dp) :: soften = 0, gap(2) = 0, reach(2) = 0, shared = 0, change(2) = 0, decline = 0, &
                state(2) = 0, difference = 0
  end type corner_row_t

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t

    if (t%wants('quadratic_gap')) call quadratic_gap(t)
    if (t%wants('begins_under_load')) call begins_under_load(t)
    if (t%wants('out_of_reach')) call out_of_reach(t)
    if (t%wants('references')) call references(t)
    if (t%wants('references_in_batches')) call references_in_batches(t)
    if (t%wants('estimates_in_batches')) call estimates_in_batches(t)
    if (t%wants('derivative_in_batches')) call derivative_in_batches(t)
    if (t%wants('sixth_order')) call sixth_order(t)
    if (t%wants('one_by_one_and_in_batches')) call one_by_one_and_in_batches(t)
    if (t%wants('slow_motion')) call slow_motion(t)
    if (t%wants('graded_steps')) call graded_steps(t)
    if (t%wants('stiffness_in_series')) call stiffness_in_series(t)
    if (t%wants('path_of_a_pair')) call path_of_a_pair(t)
    if (t%wants('methods_of_the_literature')) call methods_of_the_literature(t)
    if (t%wants('disturbances')) call disturbances(t)
    if (t%wants('up_and_down')) call up_and_down(t)
    if (t%wants('tables')) call tables(t)
  end subroutine run

  subroutine read_rows(rows)
    type(corner_row_t), allocatable, intent(out) :: rows(:)
    type(corner_row_t) :: r
    character(1000) :: line
    integer :: unit

    allocate (rows(0))
    open (newunit=unit, file='test/reference/corner_motion.dat', status='old', action='read')
    do while (next_row(unit, line))
      read (line, *) r%id, r%contact_ratio, r%n_coef, r%coef, r%soften, r%gap, r%reach, r%relief, r%shared, r%change, &
        r%decline, r%mass, r%load, &
        r%zeta, r%friction, r%angle, r%teeth, r%pitch_point, r%backlash, r%rpm, r%dynamic_factor, r%state, r%difference, &
        r%events, r%beyond, r%apart
      rows = [rows, r]
    end do
    close (unit)
  end subroutine read_rows

  !> The oscillator of a row.
  subroutine make(r, osc)
    type(corner_row_t), intent(in) :: r
    type(oscillator_t), intent(out) :: osc

    call make_curves(r, osc)
    call complete(r, osc)
  end subroutine make

  !> Stiffness, with the shared compliance in it as a mesh has it, and profile error.
  subroutine make_curves(r, osc)
    type(corner_row_t), intent(in) :: r
    type(oscillator_t), intent(inout) :: osc
    type(error_t), allocatable :: error
    real(dp), parameter :: square(0:3) = [1, 2, 1, 0]/4.0_dp, cube(0:3) = [1, 3, 3, 1]/8.0_dp, mirror(0:3) = [1, -1, 1, -1]

    associate (mesh => osc%mesh, c => r%contact_ratio, coef => 1e6_dp*r%coef(:r%n_coef), d => r%reach)
      mesh%contact_ratio = c
      mesh%disc = disc_t(shared=1e-6_dp*r%shared, change=1e-6_dp*r%change, decline=1e-6_dp*r%decline)
      mesh%reach = [-d(1), c + d(2)]
      mesh%stiffness = with_shared(polynomial(0.0_dp, c, coef), mesh%disc%shared)
      call profile_error(relief_t(1e-6_dp*r%relief, [aint(c), c - aint(c)], linear), c, mesh%profile_error, error)
      if (allocated(error)) error stop 'relief of test_beyond'
      ! (1 - v)/2 and (1 + v)/2 of the reach away from the path, v from -1 to 1.
      if (d(1) > 0) then
        mesh%stiffness = joined(with_shared(polynomial(-d(1), 0.0_dp, at_end(coef, -1)*[1 - r%soften*d(1)/2, r%soften*d(1)/2]), &
                                            mesh%disc%shared), mesh%stiffness)
        mesh%profile_error = joined(polynomial(-d(1), 0.0_dp, 1e-6_dp*([r%relief(2), 0.0_dp, 0.0_dp, 0.0_dp] + &
          mirror*(r%gap(1)*d(1)**2*square + r%gap(2)*d(1)**3*cube))), mesh%profile_error)
      end if
      if (d(2) > 0) then
        mesh%stiffness = joined(mesh%stiffness, with_shared(polynomial(c, c + d(2), at_end(coef, 1)*[1 - r%soften*d(2)/2, &
          -r%soften*d(2)/2]), mesh%disc%shared))
        mesh%profile_error = joined(mesh%profile_error, polynomial(c, c + d(2), 1e-6_dp*([r%relief(1), 0.0_dp, 0.0_dp, 0.0_dp] + &
          r%gap(1)*d(2)**2*square + r%gap(2)*d(2)**3*cube)))
      end if
    end associate
  end subroutine make_curves

  pure real(dp) function at_end(coef, u)
    real(dp), intent(in) :: coef(:)
    integer, intent(in) :: u
    integer :: i

    at_end = sum(coef*[(real(u, dp)**(i - 1), i=1, size(coef))])
  end function at_end

  !> From the own stiffness of a pair, one polynomial, to that with the shared compliance in it: a fine spline.
  function with_shared(own, shared) result(curve)
    type(piecewise_t), intent(in) :: own
    real(dp), intent(in) :: shared
    type(piecewise_t) :: curve
    integer, parameter :: knots = 400
    real(dp) :: s(knots), k(knots)
    integer :: i

    curve = own
    if (.not. shared > 0) return
    do i = 1, knots
      s(i) = own%breaks(1) + (own%breaks(2) - own%breaks(1))*(i - 1)/(knots - 1)
      k(i) = own%value(s(i))
    end do
    curve = spline(s, k/(1 + shared*k))
  end function with_shared

  !> One curve, and another from where it ends.
  function joined(left, right) result(curve)
    type(piecewise_t), intent(in) :: left, right
    type(piecewise_t) :: curve
    integer :: n

    n = size(left%coef, 2)
    curve%breaks = [left%breaks, right%breaks(2:)]
    allocate (curve%coef(0:max(ubound(left%coef, 1), ubound(right%coef, 1)), n + size(right%coef, 2)), source=0.0_dp)
    curve%coef(:ubound(left%coef, 1), :n) = left%coef
    curve%coef(:ubound(right%coef, 1), n + 1:) = right%coef
  end function joined

  !> Constant stiffness and no relief: the next pair closes where its gap, a square, is how far one pair deflects, and with both
  !> in contact x = F/2K + gap/2. So x is piecewise quadratic, with a kink where contact begins and ends, and its
  !> harmonics follow from the jumps of its derivatives by partial integration.
  subroutine quadratic_gap(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: ratio = 1.6_dp, load = 6000, stiffness = 4e8_dp, gap = 3e-3_dp
    type(corner_row_t) :: r
    type(oscillator_t) :: osc
    type(harmonics_t) :: harmonics
    real(dp) :: d, at(4), kink(4), bend(4), mean
    complex(dp) :: c, turns
    integer :: k

    r = constant_row(ratio, load, 1e-6_dp*stiffness, 1e6_dp*gap)
    call make(r, osc)
    d = sqrt(load/stiffness/gap)
    call find_harmonics(osc%mesh, load, 30, harmonics)
    call check_close(t, 'effective contact ratio', harmonics%effective_contact_ratio, ratio + 2*d, 1e-12_dp)
    call check_close(t, 'peak to peak', harmonics%peak_to_peak(), load/stiffness/2, 1e-12_dp)
    ! One pair from where the leaving one opens to where the next one closes.
    mean = load/stiffness*(1 - (ratio - 1) - 2*d) + load/stiffness/2*(ratio - 1) + 2*(load/stiffness/2*d + gap*d**3/6)
    call check_close(t, 'mean', harmonics%mean, mean, 1e-12_dp)
    at = [0.0_dp, ratio - 1, ratio - 1 + d, 1 - d]
    kink = gap*d*[0, 0, -1, -1]
    bend = gap*[-1, 1, -1, 1]
    do k = 1, 30
      turns = cmplx(0.0_dp, 2*pi*k, dp)
      c = sum((kink/turns**2 + bend/turns**3)*exp(-turns*at))
      call check_close(t, 'harmonic', abs(harmonics%amplitude(k)/2*exp(cmplx(0.0_dp, harmonics%phase(k), dp)) - c) &
                       *stiffness/load, 0.0_dp, absolute=1e-12_dp)
    end do
    call check_true(t, 'error estimate', harmonics%error_estimate < 1e-12_dp*load/stiffness)
  end subroutine quadratic_gap

  type(corner_row_t) function constant_row(ratio, load, stiffness, gap) result(r)
    real(dp), intent(in) :: ratio, load, stiffness, gap

    r = corner_row_t(n_coef=1, teeth=25, events=2, beyond=1, contact_ratio=ratio, coef=stiffness*[1, 0, 0, 0, 0], &
                     gap=[gap, 0.0_dp], reach=0.15_dp, mass=0.8_dp, load=load, zeta=0.1_dp, angle=20.0_dp, pitch_point=ratio/2, &
                     rpm=5000.0_dp)
  end function constant_row

  !> The same mesh: a pair before A carries 1/2 - K gap/(2 F) of the load, down to 0 where contact begins.
  subroutine begins_under_load(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: ratio = 1.6_dp, load = 6000, stiffness = 4e8_dp, gap = 3e-3_dp
    type(corner_row_t) :: r
    type(oscillator_t) :: osc
    type(mesh_t) :: softer
    type(sharing_t) :: sharing
    real(dp) :: d, s
    integer :: k

    r = constant_row(ratio, load, 1e-6_dp*stiffness, 1e6_dp*gap)
    call make(r, osc)
    d = sqrt(load/stiffness/gap)
    do k = 0, 10
      s = d*k/10
      call check_close(t, 'share before A', load_share(osc%mesh, load, -s), (1 - (s/d)**2)/2, absolute=1e-12_dp)
      call check_close(t, 'share behind E', load_share(osc%mesh, load, ratio + s), (1 - (s/d)**2)/2, absolute=1e-12_dp)
      call check_close(t, 'share of the pair beside', load_share(osc%mesh, load, 1 - s), (1 + (s/d)**2)/2, absolute=1e-12_dp)
    end do
    ! A pair that is softer there by a part p of its stiffness carries (1 - p)/(2 - p) in place of a half; within the path nothing
    ! changes.
    softer = osc%mesh%with_softer_corners(0.3_dp)
    do k = 1, 9
      s = d*k/10
      call check_close(t, 'share of a softer corner', load_share(softer, load, -s), 0.7_dp/1.7_dp*(1 - (s/d)**2), &
                       absolute=1e-12_dp)
      call check_close(t, 'behind E', load_share(softer, load, ratio + s), 0.7_dp/1.7_dp*(1 - (s/d)**2), absolute=1e-12_dp)
    end do
    call check_close(t, 'within the path', load_share(softer, load, 0.3_dp), 0.5_dp, absolute=1e-12_dp)
    call check_true(t, 'nothing farther off', maxval([load_share(osc%mesh, load, -d - 1e-9_dp), &
                                                      load_share(osc%mesh, load, ratio + d + 1e-9_dp)]) <= 0)
    call share_load(osc%mesh, load, 400, sharing)
    call check_close(t, 'the loads balance', maxval(abs(sum(sharing%load, 1) - load)), 0.0_dp, absolute=1e-9_dp)
    call check_true(t, 'pairs stand before A and behind E', minval(sharing%s) < -0.14_dp .and. maxval(sharing%s) > ratio + 0.14_dp)
  end subroutine begins_under_load

  !> Beyond A and E the gap is larger than any deflection: all is as where contact ends there.
  subroutine out_of_reach(t)
    type(tally_t), intent(inout) :: t
    type(corner_row_t), allocatable :: rows(:)
    type(corner_row_t) :: r
    type(oscillator_t) :: osc, plain
    type(accuracy_t) :: options
    type(point_t) :: point, same
    type(harmonics_t) :: far, near
    type(error_t), allocatable :: error
    integer :: i

    call read_rows(rows)
    options%steady%tolerance = 1e-9_dp
    do i = 1, size(rows)
      if (.not. rows(i)%reach(1) > 0) cycle
      r = rows(i)
      call make(r, osc)
      osc%mesh%profile_error%coef(:, 1) = [1e-3_dp, 0.0_dp, 0.0_dp, 0.0_dp]
      osc%mesh%profile_error%coef(:, size(osc%mesh%profile_error%coef, 2)) = [1e-3_dp, 0.0_dp, 0.0_dp, 0.0_dp]
      call make_oscillator(osc, error)
      call check_no_error(t, 'out of reach', error)
      plain = osc
      plain%mesh%reach = [0.0_dp, r%contact_ratio]
      call make_oscillator(plain, error)
      call find_harmonics(osc%mesh, r%load, 8, far)
      call find_harmonics(plain%mesh, r%load, 8, near)
      call check_close(t, 'harmonics out of reach', maxval(abs(far%amplitude - near%amplitude)), 0.0_dp, &
                       absolute=1e-11_dp*near%mean)
      call solve(osc, r%rpm, options, point)
      call solve(plain, r%rpm, options, same)
      call check_close(t, 'motion out of reach, row '//str(r%id), point%dynamic_factor, same%dynamic_factor, &
                       absolute=point%estimate + same%estimate)
    end do
  end subroutine out_of_reach

  !> Every row of the table: the dynamic factor to what both claim, and what contact there was. The multistep halving of the
  !> reference changed its own by `difference`, of which a fifteenth is left.
  subroutine references(t)
    type(tally_t), intent(inout) :: t
    type(corner_row_t), allocatable :: rows(:)
    type(oscillator_t) :: osc
    type(accuracy_t) :: options
    type(point_t) :: point
    character(:), allocatable :: row
    integer :: i

    call read_rows(rows)
    call check_true(t, 'rows', size(rows) >= 14)
    options%steady%tolerance = 1e-9_dp
    do i = 1, size(rows)
      row = 'row '//str(rows(i)%id)
      call make(rows(i), osc)
      if (rows(i)%apart > 0) then
        call solve(osc, rows(i)%rpm, options, point, 1e-6_dp*rows(i)%state)
      else
        call solve(osc, rows(i)%rpm, options, point)
      end if
      call check_close(t, row, point%dynamic_factor, rows(i)%dynamic_factor, absolute=1e-9_dp + rows(i)%difference/5)
      call check_close(t, row//' x at phase 0', 1e6_dp*point%steady%state(1), rows(i)%state(1), absolute=1e-6_dp)
      call check_true(t, row//' keeps to the tolerance', point%estimate <= options%steady%tolerance, str(point%estimate))
      call check_true(t, row//' estimate', abs(point%dynamic_factor - rows(i)%dynamic_factor) <= 2*point%estimate &
                      + rows(i)%difference/5 + 1e-11_dp)
      call check_true(t, row//' contact', point%steady%partial .eqv. rows(i)%apart > 0)
      call check_true(t, row//' status', point%steady%status == status_ok)
    end do
  end subroutine references

  !> The same rows, each beside seven speeds close by: there changes of contact take another way through their steps.
  subroutine references_in_batches(t)
    type(tally_t), intent(inout) :: t
    type(corner_row_t), allocatable :: rows(:)
    type(oscillator_t) :: osc
    type(sweep_options_t) :: options
    type(sweep_t) :: sweep
    type(error_t), allocatable :: error
    integer :: i, k

    call read_rows(rows)
    options%direction = each
    options%accuracy%steady%tolerance = 1e-9_dp
    do i = 1, size(rows)
      if (rows(i)%apart > 0) cycle
      call make(rows(i), osc)
      call run_sweep([osc], rows(i)%rpm*[(1 + 0.01_dp*k, k=-3, 4)], options, sweep, error)
      call check_no_error(t, 'sweep', error)
      call check_close(t, 'row '//str(rows(i)%id)//' in a batch', sweep%dynamic_factor(4, 1), rows(i)%dynamic_factor, &
                       absolute=1e-9_dp + rows(i)%difference/5)
      call check_true(t, 'row '//str(rows(i)%id)//' estimate in a batch', &
                      abs(sweep%dynamic_factor(4, 1) - rows(i)%dynamic_factor) <= 2*sweep%estimate(4, 1) &
                      + rows(i)%difference/5 + 1e-11_dp)
      call check_true(t, 'row '//str(rows(i)%id)//' status in a batch', all(sweep%status == status_ok))
    end do
  end subroutine references_in_batches

  !> Errors of a sweep, against many more steps, keep to their estimates also where the intervals in which contact changes are
  !> shorter than a step.
  subroutine estimates_in_batches(t)
    type(tally_t), intent(inout) :: t
    type(corner_row_t), allocatable :: rows(:)
    type(oscillator_t) :: osc
    type(sweep_options_t) :: options, many
    type(sweep_t) :: sweep, truth
    type(error_t), allocatable :: error
    real(dp) :: rpm(40)
    integer :: i, k, above

    call read_rows(rows)
    rpm = [(5000 + 400.0_dp*k, k=0, 39)]
    options%direction = each
    many%direction = each
    many%accuracy%steady%tolerance = 1e-10_dp
    do i = 1, size(rows)
      if (rows(i)%beyond == 0 .or. rows(i)%zeta < 0.09_dp) cycle
      call make(rows(i), osc)
      call run_sweep([osc], rpm, options, sweep, error)
      call check_no_error(t, 'sweep', error)
      call run_sweep([osc], rpm, many, truth, error)
      call check_no_error(t, 'sweep in many steps', error)
      above = count(.not. abs(sweep%dynamic_factor - truth%dynamic_factor) <= 2*sweep%estimate + truth%estimate)
      call check_true(t, 'errors within twice their estimates, row '//str(rows(i)%id), above <= 1, str(above))
    end do
  end subroutine estimates_in_batches

  !> What a period does to a small change of its first state is the monodromy matrix, by central differences; contact changes in
  !> every period.
  subroutine derivative_in_batches(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: change = 1e-4_dp      ! static deflections
    type(corner_row_t), allocatable :: rows(:)
    type(oscillator_t) :: osc
    type(period_map_t) :: map
    type(period_t) :: run(batch_size), more(batch_size), less(batch_size)
    real(dp) :: start(2, batch_size), step(2, batch_size), worst
    logical :: active(batch_size)
    integer :: changes, i, k, l

    call read_rows(rows)
    active = .true.
    changes = 0
    worst = 0
    do i = 1, size(rows)
      if (rows(i)%beyond == 0 .or. rows(i)%apart > 0) cycle
      call make(rows(i), osc)
      call discretise(osc, resolution_t(40.0_dp, 2), map)
      call set_durations(map, mesh_period(rows(i)%teeth(1), rows(i)%rpm*[(1 + 0.01_dp*l, l=1, batch_size)]))
      start = spread(1e-6_dp*rows(i)%state, 2, batch_size)
      call run_batch(map, start, active, .false., run)
      changes = changes + minval(run%events)
      do k = 1, 2
        step = 0
        step(k, :) = change*osc%static_deflection
        call run_batch(map, start + step, active, .false., more)
        call run_batch(map, start - step, active, .false., less)
        do l = 1, batch_size
          worst = max(worst, maxval(abs((more(l)%state - less(l)%state)/(2*step(k, l)) - run(l)%monodromy(:, k)) &
                                    /[1.0_dp, max(1.0_dp, osc%natural_frequency*map%duration(l))]))
        end do
      end do
    end do
    call check_true(t, 'contact changes in each period', changes > 0, str(changes))
    call check_close(t, 'derivative of a period', worst, 0.0_dp, absolute=1e-5_dp)
  end subroutine derivative_in_batches

  !> Halves the steps twice, from two a radian of the natural motion, and finds by which power of the step the error of the state
  !> falls, against a solution to a tolerance of 1e-12; mean over the rows.
  subroutine sixth_order(t)
    type(tally_t), intent(inout) :: t
    type(corner_row_t), allocatable :: rows(:)
    type(oscillator_t) :: osc
    type(accuracy_t) :: options, exact
    type(point_t) :: point, truth
    real(dp) :: deviation(2), duration, order
    integer :: i, k

    call read_rows(rows)
    exact%steady%tolerance = 1e-12_dp
    order = 0
    do i = 1, size(rows)
      call make(rows(i), osc)
      duration = mesh_period(rows(i)%teeth(1), rows(i)%rpm)
      call solve(osc, rows(i)%rpm, exact, truth, 1e-6_dp*rows(i)%state)
      options%steady%tolerance = 1e-12_dp
      do k = 1, 2
        options%steps = ceiling(osc%natural_frequency*duration)*2**(2*k - 1)
        call solve(osc, rows(i)%rpm, options, point, truth%steady%state)
        deviation(k) = abs(point%steady%state(1) - truth%steady%state(1))/osc%static_deflection
      end do
      order = order + log(deviation(1)/deviation(2))/log(4.0_dp)/size(rows)
    end do
    call check_true(t, 'sixth order', order > 5.4_dp .and. order < 7.5_dp, str(order))
  end subroutine sixth_order

  !> A sweep in batches finds what each speed by itself does, with the same bits for any number of threads; so do the
  !> classical Runge-Kutta steps of the literature, to what they claim.
  subroutine one_by_one_and_in_batches(t)
    type(tally_t), intent(inout) :: t
    type(corner_row_t), allocatable :: rows(:)
    type(oscillator_t) :: osc
    type(sweep_options_t) :: options
    type(sweep_t) :: one, two
    type(error_t), allocatable :: error
    type(point_t) :: point
    real(dp) :: rpm(48)
    integer :: i, k, worse

    call read_rows(rows)
    rpm = [(600 + 420.0_dp*k, k=0, 47)]
    options%direction = each
    do i = 1, size(rows)
      if (rows(i)%zeta < 0.09_dp) cycle
      call make(rows(i), osc)
      options%threads = 1
      call run_sweep([osc], rpm, options, one, error)
      call check_no_error(t, 'sweep', error)
      options%threads = 2
      call run_sweep([osc], rpm, options, two, error)
      call check_true(t, 'threads', all(abs(one%dynamic_factor - two%dynamic_factor) <= 0))
      worse = 0
      do k = 1, size(rpm), 5
        call solve(osc, rpm(k), options%accuracy, point)
        if (.not. abs(point%dynamic_factor - one%dynamic_factor(k, 1)) <= 1.5_dp*(point%estimate + one%estimate(k, 1))) &
          worse = worse + 1
      end do
      call check_true(t, 'one by one, row '//str(rows(i)%id), worse <= 1, str(worse))
      call check_true(t, 'every speed has a result, row '//str(rows(i)%id), all(one%status == status_ok), &
                      str(count(one%status /= status_ok)))
    end do
  end subroutine one_by_one_and_in_batches

  !> Slow motions in steps that grow behind the breaks find what many equal steps find, and at creeping speed the largest
  !> load is the largest static one.
  subroutine graded_steps(t)
    type(tally_t), intent(inout) :: t
    type(corner_row_t), allocatable :: rows(:)
    type(oscillator_t) :: osc
    type(accuracy_t) :: options, equal
    type(point_t) :: point, same
    type(sharing_t) :: sharing
    integer :: i

    call read_rows(rows)
    do i = 1, size(rows)
      if (rows(i)%beyond == 0 .or. rows(i)%zeta < 0.09_dp .or. rows(i)%friction > 0) cycle
      call make(rows(i), osc)
      call solve(osc, 60.0_dp, options, point)
      equal%steps = ceiling(6*osc%natural_frequency*mesh_period(rows(i)%teeth(1), 60.0_dp))
      call solve(osc, 60.0_dp, equal, same)
      call check_true(t, 'graded', point%resolution%graded_for > 0 .and. point%steps < same%steps/4, str(point%steps))
      call check_close(t, 'graded and equal steps', point%dynamic_factor, same%dynamic_factor, &
                       absolute=point%estimate + same%estimate)
      ! The largest static load may lie at a kink, between two samples.
      call share_load(osc%mesh, osc%load, 200000, sharing)
      call solve(osc, 1e-4_dp, options, point)
      call check_close(t, 'creeping', point%dynamic_factor, maxval(sharing%load)/osc%load, absolute=6e-6_dp)
    end do
  end subroutine graded_steps

  !> The slower the motion, the nearer its largest load comes to the largest static one: by twice the speed, twice as far.
  subroutine slow_motion(t)
    type(tally_t), intent(inout) :: t
    type(corner_row_t), allocatable :: rows(:)
    type(corner_row_t) :: r
    type(oscillator_t) :: osc
    type(accuracy_t) :: options
    type(point_t) :: point
    type(sharing_t) :: sharing
    real(dp) :: apart(2)
    integer :: k

    call read_rows(rows)
    r = rows(11)
    r%zeta = 0.5_dp
    call make(r, osc)
    call share_load(osc%mesh, osc%load, 4000, sharing)
    do k = 1, 2
      call solve(osc, 2.0_dp**k*40, options, point)
      call check_true(t, 'slow motion is found', point%steady%status == status_ok)
      apart(k) = point%dynamic_factor - maxval(sharing%load)/osc%load
    end do
    call check_true(t, 'slow motion nears the static load', apart(2) < 0.1_dp .and. apart(1) > 0 .and. &
                    apart(2)/apart(1) > 1.5_dp .and. apart(2)/apart(1) < 4.5_dp, str(apart(1))//' '//str(apart(2)))
  end subroutine slow_motion

  !> Constant own stiffness: one pair in series with the compliance, or two.
  subroutine stiffness_in_series(t)
    type(tally_t), intent(inout) :: t
    type(corner_row_t) :: r
    type(oscillator_t) :: osc
    real(dp), parameter :: k = 4e8_dp, c = 5e-10_dp

    r = constant_row(1.6_dp, 6000.0_dp, 1e-6_dp*k, 0.0_dp)
    r%reach = 0
    r%shared = 1e6_dp*c
    call make(r, osc)
    call check_close(t, 'mean stiffness in series', osc%mesh%mean_stiffness(), 0.6_dp*2*k/(1 + 2*c*k) + 0.4_dp*k/(1 + c*k), &
                     1e-10_dp)
    call check_close(t, 'natural frequency', osc%natural_frequency, sqrt(osc%mesh%mean_stiffness()*2/0.8_dp), 1e-12_dp)
  end subroutine stiffness_in_series

  !> The loads of a pair along its path begin before A at 0, end behind E at 0, and their largest is the dynamic factor.
  subroutine path_of_a_pair(t)
    type(tally_t), intent(inout) :: t
    type(corner_row_t), allocatable :: rows(:)
    type(oscillator_t) :: osc
    type(accuracy_t) :: options
    type(response_t) :: response
    integer :: i, first, last

    call read_rows(rows)
    do i = 1, size(rows)
      if (rows(i)%beyond == 0 .or. rows(i)%apart > 0) cycle
      call make(rows(i), osc)
      call find_response(osc, rows(i)%rpm, options, response)
      associate (s => response%s, load => response%load)
        call check_true(t, 's ascends', all(s(2:) >= s(:size(s) - 1) - 1e-14_dp))
        call check_close(t, 'begins', s(1), -rows(i)%reach(1), absolute=1e-12_dp)
        call check_close(t, 'ends', s(size(s)), rows(i)%contact_ratio + rows(i)%reach(2), absolute=1e-12_dp)
        first = findloc(load > 0, .true., 1)
        last = findloc(load > 0, .true., 1, back=.true.)
        call check_true(t, 'carries before A and behind E', s(first) < -0.01_dp .and. s(last) > rows(i)%contact_ratio + 0.01_dp)
        call check_true(t, 'begins and ends without a jump', max(load(first), load(last)) < 0.05_dp*osc%load, &
                        str(max(load(first), load(last))/osc%load))
        call check_close(t, 'largest load', maxval(load)/osc%load, rows(i)%dynamic_factor, absolute=2e-3_dp)
      end associate
    end do
  end subroutine path_of_a_pair

  !> The methods of the literature come to the same dynamic factors as their steps shrink: Runge-Kutta in steps that end at
  !> the breaks, where contact changes within steps, in equal steps, and with constant coefficients.
  subroutine methods_of_the_literature(t)
    type(tally_t), intent(inout) :: t
    type(corner_row_t), allocatable :: rows(:)
    type(oscillator_t) :: osc
    type(accuracy_t) :: options
    type(point_t) :: point
    integer, parameter :: scheme(3) = [scheme_rk4, scheme_rk4_equal, scheme_constant]
    real(dp), parameter :: enough(3) = [2e-4_dp, 8e-3_dp, 1.6e-2_dp]
    integer :: i, k

    call read_rows(rows)
    do i = 1, size(rows)
      ! Where pairs between A and E part, jumps of the map keep Newton's method from an end.
      if (rows(i)%apart > 0) cycle
      call make(rows(i), osc)
      do k = 1, 3
        options%scheme = scheme(k)
        options%steps = 2000
        call solve(osc, rows(i)%rpm, options, point, 1e-6_dp*rows(i)%state)
        call check_close(t, 'row '//str(rows(i)%id)//' by method '//str(k), point%dynamic_factor, rows(i)%dynamic_factor, &
                         absolute=enough(k))
      end do
    end do
  end subroutine methods_of_the_literature

  !> The multipliers of a steady motion whose contact is that under the static load all the time are those of a
  !> disturbance of it; where contact beyond A and E is out of reach, they are those of the mesh without it.
  subroutine disturbances(t)
    type(tally_t), intent(inout) :: t
    type(corner_row_t), allocatable :: rows(:)
    type(corner_row_t) :: r
    type(oscillator_t) :: osc, plain
    type(stability_t) :: map, same
    type(error_t), allocatable :: error
    type(point_t) :: point
    type(accuracy_t) :: options
    real(dp) :: rpm(3)

    call read_rows(rows)
    r = rows(11)
    call make(r, osc)
    osc%mesh%profile_error%coef(:, 1) = [1e-3_dp, 0.0_dp, 0.0_dp, 0.0_dp]
    osc%mesh%profile_error%coef(:, size(osc%mesh%profile_error%coef, 2)) = [1e-3_dp, 0.0_dp, 0.0_dp, 0.0_dp]
    call make_oscillator(osc, error)
    plain = osc
    plain%mesh%reach = [0.0_dp, r%contact_ratio]
    call make_oscillator(plain, error)
    rpm = [3000.0_dp, r%rpm, 15000.0_dp]
    call map_stability(osc, rpm, [r%zeta, 0.01_dp], 1e-8_dp, map)
    call map_stability(plain, rpm, [r%zeta, 0.01_dp], 1e-8_dp, same)
    call check_close(t, 'out of reach', maxval(abs(map%modulus - same%modulus)), 0.0_dp, absolute=1e-7_dp)
    call solve(plain, r%rpm, options, point)
    call check_close(t, 'of a motion', point%steady%multiplier, map%modulus(2, 1), absolute=1e-6_dp)
    call make(r, osc)
    call map_stability(osc, rpm, [r%zeta, 0.01_dp], 1e-8_dp, map)
    call check_true(t, 'contact beyond A and E counts', maxval(abs(map%modulus - same%modulus)) > 1e-4_dp)
  end subroutine disturbances

  !> Where one motion exists, a sweep up and one down find it too.
  subroutine up_and_down(t)
    type(tally_t), intent(inout) :: t
    type(corner_row_t), allocatable :: rows(:)
    type(oscillator_t) :: osc
    type(sweep_options_t) :: options
    type(sweep_t) :: one, other
    type(error_t), allocatable :: error
    real(dp) :: rpm(24)
    integer :: k

    call read_rows(rows)
    rpm = [(1000 + 700.0_dp*k, k=0, 23)]
    call make(rows(2), osc)
    options%direction = each
    call run_sweep([osc], rpm, options, one, error)
    do k = 1, 2
      options%direction = merge(up, down, k == 1)
      call run_sweep([osc], rpm, options, other, error)
      call check_true(t, 'up and down', all(abs(other%dynamic_factor - one%dynamic_factor) <= other%estimate + one%estimate))
    end do
  end subroutine up_and_down

  !> Profile error from a table: splines between rows whose s comes twice.
  subroutine tables(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: s(9) = [-0.2_dp, -0.1_dp, -0.05_dp, 0.0_dp, 0.0_dp, 0.8_dp, 1.6_dp, 1.6_dp, 1.9_dp]
    type(piecewise_t) :: curve
    type(error_t), allocatable :: error

    call profile_table(1.6_dp, s, 1e-3_dp*merge(s**2 - s**3, merge(s - 1.6_dp, 0.0_dp, s > 1.6_dp), s < 0), curve, error)
    call check_no_error(t, 'table', error)
    call check_close(t, 'a cubic before A', curve%value(-0.17_dp), 1e-3_dp*(0.17_dp**2 + 0.17_dp**3), 1e-12_dp)
    call check_close(t, 'nothing between', curve%value(1.1_dp), 0.0_dp, absolute=1e-18_dp)
    call check_close(t, 'a line behind E', curve%value(1.75_dp), 0.15e-3_dp, 1e-12_dp)
    call check_true(t, 'breaks where s comes twice', .not. (curve%is_smooth_at(4) .or. curve%is_smooth_at(6)) .and. &
                    curve%is_smooth_at(2) .and. curve%is_smooth_at(5))
    call profile_table(1.6_dp, s(4:7), [0.0_dp, 0.0_dp, 0.0_dp, 0.0_dp], curve, error)
    call check_error(t, 'one row of a spline', error, 'comes twice at row 2')
    call profile_table(1.7_dp, s(5:7), [0.0_dp, 0.0_dp, 0.0_dp], curve, error)
    call check_error(t, 'too short', error, 'covers s = 0 to 1.6')
    call profile_table(1.6_dp, s(7:5:-1), [0.0_dp, 0.0_dp, 0.0_dp], curve, error)
    call check_error(t, 'unsorted', error, 'not ascending at row 2')
    call profile_table(1.6_dp, s(5:7), [0.0_dp, 1.0_dp, 0.0_dp], curve, error)
    call check_error(t, 'too large', error, 'at row 2 it is beyond')
    call profile_table(1.6_dp, s(5:5), [0.0_dp], curve, error)
    call check_error(t, 'one row', error, 'at least two rows')
  end subroutine tables
end module test_contact_beyond_path
