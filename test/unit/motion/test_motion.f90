!> Periodic motion against independent references, closed forms and identities.
module test_motion
  use gearsweep_base_kinds, only: dp, pi
  use gearsweep_base_error, only: error_t
  use gearsweep_motion_resolution, only: resolution_t
  use gearsweep_motion_contact_set, only: period_t
  use gearsweep_motion_error_estimate, only: accuracy_t, point_t
  use gearsweep_motion_oscillator, only: make_oscillator, mesh_period, oscillator_t, resolving_steps
  use gearsweep_motion_period, only: run_full_contact, run_period
  use gearsweep_motion_period_map, only: discretise, period_map_t, set_durations
  use gearsweep_motion_periodic_orbit, only: largest_multiplier
  use gearsweep_motion_response, only: find_response, response_t
  use gearsweep_motion_steady_motion, only: by_marching
  use gearsweep_motion_steady_motion, only: has_result, status_marginal, status_name, status_ok, status_unresolved
  use gearsweep_base_text, only: str
  use test_support_reference_rows, only: next_row, oscillator_of, read_rows, row_t
  use test_support_solve_one_point, only: mesh_of, solve
  use test_support_testing, only: tally_t, check_true, check_close, check_equal
  implicit none
  private
  public :: run

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t

    if (t%wants('references constant_stiffness')) call references(t, 'constant_stiffness')
    if (t%wants('references constant_stiffness_contact_loss')) call references(t, 'constant_stiffness_contact_loss')
    if (t%wants('references smooth_stiffness')) call references(t, 'smooth_stiffness')
    if (t%wants('changes at one place')) call changes_at_one_place(t)
    if (t%wants('order_of_convergence')) call order_of_convergence(t)
    if (t%wants('tight_tolerance')) call tight_tolerance(t)
    if (t%wants('slow_and_fast')) call slow_and_fast(t)
    if (t%wants('marching')) call marching(t)
    if (t%wants('scaling')) call scaling(t)
    if (t%wants('friction_of_a_symmetric_mesh')) call friction_of_a_symmetric_mesh(t)
    if (t%wants('backlash_out_of_reach')) call backlash_out_of_reach(t)
    if (t%wants('meissner_boundaries')) call meissner_boundaries(t)
    if (t%wants('meissner_closing')) call meissner_closing(t)
    if (t%wants('subharmonic')) call subharmonic(t)
    if (t%wants('refused_steps')) call refused_steps(t)
    if (t%wants('path_of_a_pair')) call path_of_a_pair(t)
  end subroutine run

  !> Every row of a reference table, from its own initial state where motions
  !> coexist: dynamic factor within twice the estimate, which is below the
  !> tolerance, and the multiplier.
  subroutine references(t, name)
    type(tally_t), intent(inout) :: t
    character(*), intent(in) :: name
    type(row_t), allocatable :: rows(:)
    type(oscillator_t) :: osc
    type(accuracy_t) :: options
    type(point_t) :: point
    character(:), allocatable :: row
    integer :: i

    call read_rows('test/reference/'//name//'.dat', rows)
    call check_true(t, name//' has rows', size(rows) >= 17)
    options%steady%tolerance = 1e-9_dp
    do i = 1, size(rows)
      row = name//' row '//str(rows(i)%id)
      call oscillator_of(rows(i), osc)
      if (rows(i)%loss > 0) then
        call solve(osc, rows(i)%rpm, options, point, &
                   [rows(i)%x*1e-6_dp, rows(i)%v*mesh_period(rows(i)%teeth(1), rows(i)%rpm)])
      else
        call solve(osc, rows(i)%rpm, options, point)
      end if
      call check_close(t, row, point%dynamic_factor, rows(i)%dynamic_factor, absolute=2e-9_dp)
      call check_true(t, row//' keeps to the tolerance', point%estimate <= options%steady%tolerance)
      call check_true(t, row//' estimate', &
                      abs(point%dynamic_factor - rows(i)%dynamic_factor) <= 2*point%estimate + 1e-12_dp)
      call check_close(t, row//' multiplier', point%steady%multiplier, rows(i)%multiplier, absolute=2e-8_dp)
      call check_true(t, row//' contact', (rows(i)%loss > 0 .eqv. point%steady%partial) .and. &
                      (rows(i)%loss > 1 .eqv. point%steady%lost) .and. (rows(i)%loss > 2 .eqv. point%steady%coast))
      call check_equal(t, row//' status', point%steady%status, merge(status_marginal, status_ok, rows(i)%zeta <= 0))
    end do
  end subroutine references

  !> Pairs without profile error part and meet at one place, many times within one step where steps are long: the number of changes
  !> over a period from the reference's state is the same for any steps.
  subroutine changes_at_one_place(t)
    type(tally_t), intent(inout) :: t
    type(row_t), allocatable :: rows(:)
    type(oscillator_t) :: osc
    type(period_map_t) :: map
    type(period_t) :: period
    ! Over the fewest that resolve the natural motion.
    real(dp), parameter :: steps(5) = [1.2_dp, 1.5_dp, 2.0_dp, 2.7_dp, 20.0_dp]
    integer :: events(size(steps)), i, k

    call read_rows('test/reference/constant_stiffness_contact_loss.dat', rows)
    do i = 1, size(rows)
      associate (row => rows(i), duration => mesh_period(rows(i)%teeth(1), rows(i)%rpm))
        if (any(abs(row%relief) > 0)) cycle
        call oscillator_of(row, osc)
        do k = 1, size(steps)
          call discretise(osc, resolution_t(steps(k)*resolving_steps(osc, duration), 1), map)
          call set_durations(map, [duration])
          call run_period(map, [row%x*1e-6_dp, row%v*duration], period)
          events(k) = period%events
        end do
        call check_true(t, 'changes of contact, row '//str(row%id), all(events == events(size(steps))) .and. events(1) > 0, &
                        str(events(1))//' '//str(events(size(steps))))
      end associate
    end do
  end subroutine changes_at_one_place

  !> Sixth order by halving the steps twice, from two steps for a radian of the natural motion, with all
  !> pairs in contact, with partial contact and with free flight; errors against the reference tables.
  subroutine order_of_convergence(t)
    type(tally_t), intent(inout) :: t
    type(row_t), allocatable :: smooth(:), lossy(:)

    call read_rows('test/reference/smooth_stiffness.dat', smooth)
    call read_rows('test/reference/constant_stiffness_contact_loss.dat', lossy)
    call order_of(smooth(1))
    call order_of(smooth(5))
    call order_of(lossy(1))
    call order_of(lossy(2))
    call order_of(lossy(13))
    call order_of(smooth(16))

  contains

    subroutine order_of(row)
      type(row_t), intent(in) :: row
      type(oscillator_t) :: osc
      type(accuracy_t) :: options
      type(point_t) :: point
      real(dp) :: deviation(3), duration
      integer :: k

      options%steady%tolerance = 1e-12_dp
      call oscillator_of(row, osc)
      duration = mesh_period(row%teeth(1), row%rpm)
      do k = 1, 3
        options%steps = ceiling(osc%natural_frequency*duration)*2**k
        call solve(osc, row%rpm, options, point, [row%x*1e-6_dp, row%v*duration])
        deviation(k) = abs(point%dynamic_factor - row%dynamic_factor)
      end do
      ! Where an event falls within its step moves the error by a factor of some two.
      call check_true(t, 'order, zeta '//str(row%zeta)//', '//str(row%rpm)//' rpm', &
                      log(deviation(1)/deviation(3))/log(4.0_dp) > 5.5_dp)
    end subroutine order_of
  end subroutine order_of_convergence

  !> The tightest tolerance, 1e-10, against the reference.
  subroutine tight_tolerance(t)
    type(tally_t), intent(inout) :: t
    type(row_t), allocatable :: rows(:)
    type(oscillator_t) :: osc
    type(accuracy_t) :: options
    type(point_t) :: point
    integer, parameter :: chosen(4) = [2, 18, 30, 34]
    integer :: i

    call read_rows('test/reference/constant_stiffness.dat', rows)
    options%steady%tolerance = 1e-10_dp
    do i = 1, size(chosen)
      associate (row => rows(chosen(i)))
        call oscillator_of(row, osc)
        call solve(osc, row%rpm, options, point)
        call check_close(t, '1e-10, row '//str(row%id), point%dynamic_factor, row%dynamic_factor, absolute=1e-10_dp)
      end associate
    end do
  end subroutine tight_tolerance

  !> Slow: the deflection comes to rest in each smooth interval, and where the second pair leaves
  !> it overshoots from F_s/(K_A + K_D) to F_s/K: DF = 1 + K_A/(K_A + K_D) exp(-pi zeta/sqrt(1 - zeta^2)),
  !> exact for constant stiffness (K_A = K_D). Fast: the inertia holds the
  !> deflection at F_s/mean K: DF = largest K/mean K.
  subroutine slow_and_fast(t)
    type(tally_t), intent(inout) :: t
    type(oscillator_t) :: osc
    type(accuracy_t) :: options
    type(point_t) :: point
    real(dp), parameter :: zeta = 0.17_dp

    osc = mesh_of(1.6_dp, [400.0_dp], [0.0_dp, 0.0_dp], zeta)
    call solve(osc, 100.0_dp, options, point)
    call check_close(t, 'slow limit', point%dynamic_factor, 1 + 0.5_dp*exp(-pi*zeta/sqrt(1 - zeta**2)), absolute=2e-6_dp)
    osc = mesh_of(1.6_dp, [400.0_dp, 0.0_dp, -110.0_dp], [0.0_dp, 0.0_dp], zeta)
    call solve(osc, 1e8_dp, options, point)
    call check_close(t, 'fast limit', point%dynamic_factor, 400/(1.6_dp*(400 - 110/3.0_dp)), absolute=2e-6_dp)
  end subroutine slow_and_fast

  !> Marching through the transient ends in the motion that shooting finds, with
  !> and without loss of contact.
  subroutine marching(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: rpm(4) = [3000, 8000, 13500, 24000], relief(2) = [8, 20]
    type(oscillator_t) :: osc
    type(accuracy_t) :: shooting, march
    type(point_t) :: one, other
    integer :: i, k

    march%steady%method = by_marching
    do k = 1, 2
      osc = mesh_of(1.6_dp, [400.0_dp, 0.0_dp, -110.0_dp], relief(k)*[1.0_dp, 1.0_dp], 0.1_dp)
      do i = 1, size(rpm)
        call solve(osc, rpm(i), shooting, one)
        call solve(osc, rpm(i), march, other)
        call check_close(t, 'marching', other%dynamic_factor, one%dynamic_factor, absolute=2e-6_dp)
      end do
    end do
  end subroutine marching

  !> Without relief the load drops out; with relief only relief over load
  !> matters; so it is with stiffness, mass and speed squared.
  subroutine scaling(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: coef(3) = [400.0_dp, 0.0_dp, -110.0_dp], none(2) = 0, deep(2) = [15.0_dp, 18.0_dp]
    type(oscillator_t) :: osc
    type(accuracy_t) :: options
    type(point_t) :: one, other
    type(error_t), allocatable :: error

    options%steps = 600
    osc = mesh_of(1.6_dp, coef, none, 0.1_dp)
    call solve(osc, 9000.0_dp, options, one)
    osc%load = 1e-3_dp*osc%load
    call make_oscillator(osc, error)
    call solve(osc, 9000.0_dp, options, other)
    call check_close(t, 'load drops out', other%dynamic_factor, one%dynamic_factor, 1e-12_dp)

    osc = mesh_of(1.6_dp, coef, deep, 0.1_dp)
    call solve(osc, 9000.0_dp, options, one)
    osc = mesh_of(1.6_dp, coef, 3*deep, 0.1_dp)
    osc%load = 3*osc%load
    call make_oscillator(osc, error)
    call solve(osc, 9000.0_dp, options, other)
    call check_close(t, 'relief over load', other%dynamic_factor, one%dynamic_factor, 1e-11_dp)

    osc = mesh_of(1.6_dp, 4*coef, deep/4, 0.1_dp)
    call solve(osc, 18000.0_dp, options, other)
    call check_close(t, 'four times the stiffness, twice the speed', other%dynamic_factor, one%dynamic_factor, 1e-11_dp)
    osc = mesh_of(1.6_dp, coef, deep, 0.1_dp)
    osc%mass = [0.5_dp, 2.0_dp]                   ! the same effective mass m1 m2/(m1 + m2)
    call make_oscillator(osc, error)
    call solve(osc, 9000.0_dp, options, other)
    call check_close(t, 'only the effective mass counts', other%dynamic_factor, one%dynamic_factor, 1e-11_dp)
  end subroutine scaling

  !> At the pitch point friction changes sign; its effect on DF is of the order
  !> of mu and vanishes with it.
  subroutine friction_of_a_symmetric_mesh(t)
    type(tally_t), intent(inout) :: t
    type(oscillator_t) :: osc
    type(accuracy_t) :: options
    type(point_t) :: point(3)
    type(error_t), allocatable :: error
    integer :: i

    do i = 1, 3
      osc = mesh_of(1.6_dp, [400.0_dp, 0.0_dp, -110.0_dp], [0.0_dp, 0.0_dp], 0.17_dp)
      osc%friction = 0.001_dp*(i - 1)
      call make_oscillator(osc, error)
      call solve(osc, 9000.0_dp, options, point(i))
    end do
    call check_true(t, 'friction acts', abs(point(2)%dynamic_factor - point(1)%dynamic_factor) > 1e-5_dp)
    call check_close(t, 'in proportion', (point(3)%dynamic_factor - point(1)%dynamic_factor) &
                     /(point(2)%dynamic_factor - point(1)%dynamic_factor), 2.0_dp, 0.1_dp)
  end subroutine friction_of_a_symmetric_mesh

  !> A coast side that is never reached changes nothing.
  subroutine backlash_out_of_reach(t)
    type(tally_t), intent(inout) :: t
    type(oscillator_t) :: osc
    type(accuracy_t) :: options
    type(point_t) :: free, bounded
    type(error_t), allocatable :: error

    osc = mesh_of(1.6_dp, [400.0_dp, 0.0_dp, -110.0_dp], [20.0_dp, 20.0_dp], 0.05_dp)
    call solve(osc, 13000.0_dp, options, free)
    osc%has_backlash = .true.
    osc%backlash = 1e-3_dp
    call make_oscillator(osc, error)
    call solve(osc, 13000.0_dp, options, bounded)
    call check_close(t, 'wide backlash', bounded%dynamic_factor, free%dynamic_factor, 1e-12_dp)
    call check_true(t, 'not reached', .not. bounded%steady%coast)
  end subroutine backlash_out_of_reach

  !> The closed form of Meissner's square wave: just inside a tongue the motion
  !> with all pairs in contact repels, just outside it does not.
  subroutine meissner_boundaries(t)
    type(tally_t), intent(inout) :: t
    real(dp) :: ratio, stiffness, mass(2), rpm, closing(2), boundary(2)
    integer :: unit, teeth, tongue, rows
    character(1000) :: line

    open (newunit=unit, file='test/reference/meissner.dat', status='old', action='read')
    rows = 0
    do while (next_row(unit, line))
      rows = rows + 1
      read (line, *) teeth, ratio, stiffness, mass, rpm, tongue, closing
      if (modulo(rows, 2) == 1) then
        boundary(1) = rpm
        cycle
      end if
      boundary(2) = rpm
      associate (margin => 1e-3_dp*(boundary(2) - boundary(1)))
        call check_true(t, 'below tongue', attracts(boundary(1) - margin))
        call check_true(t, 'lower edge', .not. attracts(boundary(1) + margin))
        call check_true(t, 'upper edge', .not. attracts(boundary(2) - margin))
        call check_true(t, 'above tongue', attracts(boundary(2) + margin))
      end associate
    end do
    close (unit)
    call check_equal(t, 'boundaries read', rows, 30)

  contains

    !> While all pairs stay in contact.
    logical function attracts(rpm)
      real(dp), intent(in) :: rpm
      type(oscillator_t) :: osc
      type(error_t), allocatable :: error
      type(period_t) :: run(1)
      type(period_map_t) :: map

      osc = mesh_of(ratio, [stiffness], [0.0_dp, 0.0_dp], 0.0_dp)
      osc%mass = mass
      osc%mesh%teeth = teeth
      call make_oscillator(osc, error)
      call discretise(osc, resolution_t(4000.0_dp, 1), map)
      call set_durations(map, [mesh_period(teeth, rpm)])
      call run_full_contact(map, reshape([0.0_dp, 0.0_dp], [2, 1]), run)
      attracts = largest_multiplier(run(1)%monodromy) < 1 + 1e-7_dp
    end function attracts
  end subroutine meissner_boundaries

  !> A tongue closes at the damping of the reference table.
  subroutine meissner_closing(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: closing = 0.094091850897349_dp, rpm = 30384.898344295983_dp
    type(oscillator_t) :: osc
    type(accuracy_t) :: options
    type(point_t) :: point

    options%steady%most_cycles = 3
    osc = mesh_of(1.6_dp, [400.0_dp], [0.0_dp, 0.0_dp], closing*1.001_dp)
    call solve(osc, rpm, options, point)
    call check_equal(t, 'closed', status_name(point%steady%status), 'ok')
    osc = mesh_of(1.6_dp, [400.0_dp], [0.0_dp, 0.0_dp], closing*0.999_dp)
    call solve(osc, rpm, options, point)
    ! Another motion may attract there.
    call check_true(t, 'open', .not. has_result(point%steady%status) .or. point%steady%departs)
  end subroutine meissner_closing

  !> In the main parametric tongue the motion repeats after two mesh periods with
  !> loss of contact: independent value by tools/reference/make_subharmonic.py.
  !> Beside the tongue it is periodic with the mesh.
  subroutine subharmonic(t)
    type(tally_t), intent(inout) :: t
    type(oscillator_t) :: osc
    type(accuracy_t) :: options
    type(point_t) :: point

    osc = mesh_of(1.6_dp, [400.0_dp, 0.0_dp, -110.0_dp], [0.0_dp, 0.0_dp], 0.03_dp)
    options%steady%tolerance = 1e-9_dp
    call solve(osc, 29000.0_dp, options, point)
    call check_equal(t, 'status in the tongue', status_name(point%steady%status), 'subharmonic')
    call check_equal(t, 'two periods', point%steady%periods, 2)
    call check_close(t, 'its dynamic factor', point%dynamic_factor, 1.5806300622426337_dp, absolute=2e-9_dp)
    call check_true(t, 'it loses contact and attracts', point%steady%lost .and. point%steady%multiplier < 1)
    call solve(osc, 32000.0_dp, options, point)
    call check_equal(t, 'status beside it', status_name(point%steady%status), 'ok')
  end subroutine subharmonic

  !> Steps that do not see the natural motion are refused, not answered.
  subroutine refused_steps(t)
    type(tally_t), intent(inout) :: t
    type(oscillator_t) :: osc
    type(accuracy_t) :: options
    type(point_t) :: point

    options%steps = 50
    osc = mesh_of(1.6_dp, [400.0_dp], [0.0_dp, 0.0_dp], 0.17_dp)
    call solve(osc, 400.0_dp, options, point)
    call check_equal(t, 'too few steps', point%steady%status, status_unresolved)
    options%steps = 0
    osc = mesh_of(1.6_dp, [400.0_dp], [0.0_dp, 0.0_dp], 0.0_dp)
    call solve(osc, 1e-3_dp, options, point)
    call check_equal(t, 'too slow without damping', point%steady%status, status_unresolved)
  end subroutine refused_steps

  !> The followed pair: its largest load is the dynamic factor; the loads of the
  !> pairs at one phase add up through the table.
  subroutine path_of_a_pair(t)
    type(tally_t), intent(inout) :: t
    type(oscillator_t) :: osc
    type(accuracy_t) :: options
    type(response_t) :: response

    osc = mesh_of(1.6_dp, [400.0_dp, 0.0_dp, -110.0_dp], [8.0_dp, 8.0_dp], 0.17_dp)
    call find_response(osc, 6000.0_dp, options, response)
    call check_true(t, 'path covered', response%s(1) <= 0 .and. abs(response%s(size(response%s)) - 1.6_dp) < 1e-12_dp)
    call check_close(t, 'largest load', maxval(response%load)/osc%load, response%point%dynamic_factor, 1e-4_dp)
    call check_true(t, 'never above', maxval(response%load)/osc%load <= response%point%dynamic_factor*(1 + 1e-12_dp))
  end subroutine path_of_a_pair
end module test_motion
