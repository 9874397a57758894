!> The energy of steady motions over the time after which they repeat: what the loads of the pairs do, with friction, damping
!> takes.
module test_energy
  use gearsweep_motion_resolution, only: resolution_t
  use gearsweep_motion_contact_set, only: in_contact, period_t
  use gearsweep_motion_error_estimate, only: accuracy_t, point_t
  use gearsweep_base_kinds, only: dp
  use gearsweep_motion_oscillator, only: mesh_period, mobility, oscillator_t
  use gearsweep_motion_period, only: run_period
  use gearsweep_motion_period_map, only: discretise, period_map_t, set_durations
  use gearsweep_motion_periodic_orbit, only: shoot, steady_t
  use gearsweep_base_quadrature, only: gauss_legendre
  use gearsweep_base_quintic, only: quintic, value_of
  use gearsweep_motion_steady_motion, only: has_result
  use gearsweep_base_text, only: str
  use gearsweep_motion_trace, only: trace_t
  use test_support_solve_one_point, only: mesh_of, solve
  use test_support_testing, only: check_close, check_true, tally_t
  implicit none
  private
  public :: run

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t

    if (t%wants('balance')) call balance(t)
  end subroutine run

  !> Times the velocity, the equation of motion says that over the time after which a motion repeats the work of the loads,
  !> friction's part of it and what damping takes are 0 together: kinetic energy comes back, and the static load does no work on x.
  subroutine balance(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: coef(3) = [400.0_dp, 0.0_dp, -110.0_dp], relief(2) = [8.0_dp, 5.0_dp]
    integer :: lost

    lost = 0
    call check(mesh_of(1.6_dp, coef, relief, 0.17_dp), 5000.0_dp)
    call check(mesh_of(1.6_dp, coef, relief, 0.05_dp), 10500.0_dp)
    call check(mesh_of(1.6_dp, coef, relief, 0.02_dp), 7700.0_dp)
    call check(mesh_of(1.6_dp, coef, relief, 0.04_dp, 0.1_dp), 10000.0_dp)
    call check(mesh_of(2.3_dp, coef, relief, 0.1_dp, 0.05_dp), 6000.0_dp)
    call check_true(t, 'contact is lost', lost > 0, str(lost))

  contains

    subroutine check(osc, rpm)
      type(oscillator_t), intent(in) :: osc
      real(dp), intent(in) :: rpm
      type(point_t) :: point
      type(period_map_t) :: map
      type(steady_t) :: steady
      type(trace_t) :: trace
      type(period_t) :: period
      real(dp) :: state(2), work(3), duration
      integer :: i

      call solve(osc, rpm, accuracy_t(), point)
      call check_true(t, 'a motion at '//str(rpm), has_result(point%steady%status))
      if (.not. has_result(point%steady%status)) return
      duration = mesh_period(osc%mesh%teeth(1), rpm)
      call discretise(osc, resolution_t(1.0_dp, 300), map)
      call set_durations(map, [duration])
      call shoot(map, 1e-9_dp, point%steady%periods, point%steady%state, steady)
      state = steady%state
      work = 0
      do i = 1, steady%periods
        trace%rows = 0
        call run_period(map, state, period, trace)
        state = period%state
        call add_work(osc, trace, duration, work)
      end do
      if (steady%lost) lost = lost + 1
      call check_true(t, 'damping takes energy', work(3) > 0)
      call check_close(t, 'energy at '//str(rpm), (work(1) + work(2))/work(3), -1.0_dp, absolute=1e-8_dp)
    end subroutine check
  end subroutine balance

  !> Adds the work of the pairs' loads, of friction, and what damping takes over a mesh period, J.
  subroutine add_work(osc, trace, duration, work)
    type(oscillator_t), intent(in) :: osc
    type(trace_t), intent(in) :: trace
    real(dp), intent(in) :: duration             ! s
    real(dp), intent(inout) :: work(3)
    integer, parameter :: points = 10
    real(dp) :: node(points), weight(points), x(0:5), load(0:5), slope, s, part, mass, rate
    integer :: i, j, row

    mass = 1/sum(1/osc%mass)
    call gauss_legendre(node, weight)
    do row = 1, trace%rows, 2
      x = quintic(trace%x(:, row), trace%x(:, row + 1))
      associate (width => trace%phase(row + 1) - trace%phase(row))
        if (.not. width > 0) cycle
        do i = 1, points
          associate (place => (1 + node(i))/2)
            slope = value_of([x(1), 2*x(2), 3*x(3), 4*x(4), 5*x(5), 0.0_dp], place)
            rate = 0
            do j = 1, min(trace%pairs(row), osc%pairs)
              if (.not. in_contact(trace%contact_set(row), j)) cycle
              s = trace%phase(row) + place*width + j + trace%offset(row) - 1
              part = mass*mobility(osc, s, s > osc%mesh%pitch_point)
              load = quintic(trace%load(:, j, row), trace%load(:, j, row + 1))
              work(1) = work(1) + weight(i)/2*value_of(load, place)*slope
              work(2) = work(2) + weight(i)/2*value_of(load, place)*slope*(part - 1)
              rate = rate + part/mass*osc%mesh%stiffness%value(s)
            end do
            work(3) = work(3) + weight(i)/2*mass*2*osc%damping_ratio*sqrt(rate)*slope**2/(width*duration)
          end associate
        end do
      end associate
    end do
  end subroutine add_work
end module test_energy
