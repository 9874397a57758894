!> Methods of the literature with a given number of steps: classical Runge-Kutta,
!> with equal steps that know nothing of breaks or with steps that end at them,
!> and steps over which the coefficients are constant and the motion exact
!> (Karpat et al. 2012). None of them locates changes of contact.
module bench_fixed_steps
  use bench_step_table, only: step_table_t, tabulate
  use gearsweep_base_kinds, only: dp
  use gearsweep_motion_oscillator, only: oscillator_t
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  implicit none
  private
  public :: solve_with_steps

  integer, parameter, public :: runge_kutta = 1, constant = 2
  integer, parameter, public :: by_marching = 1, by_shooting = 2

  !> Exact motion over a step for the contact set in which it was made last.
  type :: exact_step_t
    integer :: contact = -1                      !< bits
    real(dp) :: rest = 0, push = 0, map(2, 2) = 0
  end type exact_step_t

contains

  !> Dynamic factors at all speeds (1/min), from rest under the mean load until
  !> the motion repeats but for `wanted` static deflections; NaN where it grows
  !> without bound. `aligned` steps end at the breaks and have their peaks refined.
  subroutine solve_with_steps(osc, rpm, method, steady_by, aligned, steps, wanted, dynamic_factor)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm(:), wanted
    integer, intent(in) :: method, steady_by, steps
    logical, intent(in) :: aligned
    real(dp), intent(out) :: dynamic_factor(:)
    type(step_table_t) :: table
    type(exact_step_t), allocatable :: exact(:)
    integer :: i

    call tabulate(osc, steps, aligned, table)
    do i = 1, size(rpm)
      exact = spread(exact_step_t(), 1, size(table%width))
      if (steady_by == by_marching) then
        dynamic_factor(i) = march(osc, table, 60/(osc%mesh%teeth(1)*rpm(i)), method, wanted, exact)
      else
        dynamic_factor(i) = shoot(osc, table, 60/(osc%mesh%teeth(1)*rpm(i)), method, wanted, exact)
      end if
    end do
  end subroutine solve_with_steps

  real(dp) function march(osc, table, duration, method, wanted, exact)
    type(oscillator_t), intent(in) :: osc
    type(step_table_t), intent(in) :: table
    real(dp), intent(in) :: duration, wanted
    integer, intent(in) :: method
    type(exact_step_t), intent(inout) :: exact(:)
    integer, parameter :: most_periods = 3000
    real(dp) :: state(2), before(2), moved, decay, peak
    integer :: period

    associate (zeta => osc%damping_ratio)
      decay = exp(-osc%natural_frequency*duration*(zeta - sqrt(max(0.0_dp, zeta**2 - 1))))
    end associate
    state = [osc%static_deflection, 0.0_dp]
    do period = 1, most_periods
      before = state
      call run_period(osc, table, duration, method, exact, state, peak)
      moved = distance(osc, duration, state - before)
      if (.not. moved < 1e6_dp) exit
      if (moved*max(1.0_dp, decay/(1 - decay)) < wanted) exit
    end do
    march = bounded(osc, moved, peak)
  end function march

  !> Newton's method on the map of a period, its derivative by differences:
  !> exact while contact holds, as the map is affine then.
  real(dp) function shoot(osc, table, duration, method, wanted, exact)
    type(oscillator_t), intent(in) :: osc
    type(step_table_t), intent(in) :: table
    real(dp), intent(in) :: duration, wanted
    integer, intent(in) :: method
    type(exact_step_t), intent(inout) :: exact(:)
    integer, parameter :: most_iterations = 30
    real(dp) :: state(2), next(2), shifted(2), a(2, 2), defect(2), move(2), unit(2), moved, peak
    integer :: iteration, i

    unit = 1e-4_dp*osc%static_deflection*[1.0_dp, osc%natural_frequency*duration]
    state = [osc%static_deflection, 0.0_dp]
    do iteration = 1, most_iterations
      next = state
      call run_period(osc, table, duration, method, exact, next, peak)
      defect = next - state
      moved = distance(osc, duration, defect)
      if (.not. moved < 1e6_dp) exit
      do i = 1, 2
        shifted = state
        shifted(i) = shifted(i) + unit(i)
        move = shifted
        call run_period(osc, table, duration, method, exact, shifted)
        a(:, i) = (move - state - shifted + next)/unit(i)
      end do
      move = [a(2, 2)*defect(1) - a(1, 2)*defect(2), a(1, 1)*defect(2) - a(2, 1)*defect(1)] &
             /(a(1, 1)*a(2, 2) - a(1, 2)*a(2, 1))
      if (distance(osc, duration, move) < wanted) exit
      state = state + move
    end do
    shoot = bounded(osc, moved, peak)
  end function shoot

  !> Size of a difference of states, in static deflections.
  pure real(dp) function distance(osc, duration, difference)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration, difference(2)

    distance = max(abs(difference(1)), abs(difference(2))/(osc%natural_frequency*duration))/osc%static_deflection
  end function distance

  pure real(dp) function bounded(osc, moved, peak)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: moved, peak

    bounded = peak/osc%load
    if (.not. moved < 1e6_dp) bounded = ieee_value(1.0_dp, ieee_quiet_nan)
  end function bounded

  !> From a state (x and its derivative over the phase, m) over one period; the
  !> largest pair load on the way, N.
  subroutine run_period(osc, table, duration, method, exact, state, peak)
    type(oscillator_t), intent(in) :: osc
    type(step_table_t), intent(in) :: table
    real(dp), intent(in) :: duration
    integer, intent(in) :: method
    type(exact_step_t), intent(inout) :: exact(:)
    real(dp), intent(inout) :: state(2)
    real(dp), intent(out), optional :: peak
    real(dp) :: before(2)
    integer :: i

    if (present(peak)) peak = 0
    do i = 1, size(table%width)
      before = state
      if (method == runge_kutta) then
        call step_rk4(osc, table, i, duration, state)
      else
        call step_exactly(osc, table, i, duration, exact(i), state)
      end if
      if (present(peak)) call table%raise(i, before, state, peak)
    end do
  end subroutine run_period

  subroutine step_rk4(osc, table, i, duration, state)
    type(oscillator_t), intent(in) :: osc
    type(step_table_t), intent(in) :: table
    integer, intent(in) :: i
    real(dp), intent(in) :: duration
    real(dp), intent(inout) :: state(2)
    real(dp) :: h, drive, a(2, 4)

    drive = osc%load*sum(1/osc%mass)
    h = table%width(i)
    a(:, 1) = slope(1, state)
    a(:, 2) = slope(2, state + h/2*a(:, 1))
    a(:, 3) = slope(2, state + h/2*a(:, 2))
    a(:, 4) = slope(3, state + h*a(:, 3))
    state = state + h/6*(a(:, 1) + 2*(a(:, 2) + a(:, 3)) + a(:, 4))

  contains

    pure function slope(place, z)
      integer, intent(in) :: place
      real(dp), intent(in) :: z(2)
      real(dp) :: slope(2), square, push
      integer :: j

      square = 0
      push = drive
      do j = 1, size(table%rate, 1)
        if (z(1) <= table%error(j, place, i)) cycle
        square = square + table%rate(j, place, i)
        push = push + table%rate(j, place, i)*table%error(j, place, i)
      end do
      slope = [z(2), duration*(duration*(push - square*z(1)) - 2*osc%damping_ratio*sqrt(square)*z(2))]
    end function slope
  end subroutine step_rk4

  !> With the coefficients of the step's middle and the contact of its beginning.
  subroutine step_exactly(osc, table, i, duration, exact, state)
    type(oscillator_t), intent(in) :: osc
    type(step_table_t), intent(in) :: table
    integer, intent(in) :: i
    real(dp), intent(in) :: duration
    type(exact_step_t), intent(inout) :: exact
    real(dp), intent(inout) :: state(2)
    real(dp) :: x, y
    integer :: j, contact

    contact = 0
    do j = 1, size(table%rate, 1)
      if (table%rate(j, 2, i) > 0 .and. state(1) > table%error(j, 2, i)) contact = ibset(contact, j)
    end do
    if (contact /= exact%contact) call make_exact(osc, table, i, contact, duration, exact)
    x = state(1) - exact%rest
    y = state(2)
    state(1) = exact%map(1, 1)*x + exact%map(1, 2)*y + exact%rest + exact%push*table%width(i)/2
    state(2) = exact%map(2, 1)*x + exact%map(2, 2)*y + exact%push
  end subroutine step_exactly

  pure subroutine make_exact(osc, table, i, contact, duration, exact)
    type(oscillator_t), intent(in) :: osc
    type(step_table_t), intent(in) :: table
    integer, intent(in) :: i, contact
    real(dp), intent(in) :: duration
    type(exact_step_t), intent(out) :: exact
    real(dp) :: square, push, omega, half_drag, root, c, s
    logical :: touches(size(table%rate, 1))
    integer :: j

    touches = [(btest(contact, j), j=1, size(touches))]
    square = sum(table%rate(:, 2, i), mask=touches)*duration**2
    push = (sum(table%rate(:, 2, i)*table%error(:, 2, i), mask=touches) + osc%load*sum(1/osc%mass))*duration**2
    exact%contact = contact
    associate (width => table%width(i))
      if (contact == 0) then                     ! free flight
        exact%map = reshape([1.0_dp, 0.0_dp, width, 1.0_dp], [2, 2])
        exact%push = push*width
        return
      end if
      exact%rest = push/square
      omega = sqrt(square)
      half_drag = osc%damping_ratio*omega
      root = omega*sqrt(abs(1 - osc%damping_ratio**2))
      if (osc%damping_ratio < 1) then
        c = exp(-half_drag*width)*cos(root*width)
        s = exp(-half_drag*width)*sin(root*width)/root
      else if (osc%damping_ratio > 1) then
        c = (exp((root - half_drag)*width) + exp(-(root + half_drag)*width))/2
        s = (exp((root - half_drag)*width) - exp(-(root + half_drag)*width))/(2*root)
      else
        c = exp(-half_drag*width)
        s = c*width
      end if
    end associate
    exact%map = reshape([c + half_drag*s, -square*s, s, c - half_drag*s], [2, 2])
  end subroutine make_exact
end module bench_fixed_steps
