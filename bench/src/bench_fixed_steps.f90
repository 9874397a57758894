!> Methods of the literature, marched with equal steps until periodic: classical
!> Runge-Kutta steps that know nothing of breaks and contact, and steps over
!> which the coefficients are constant and the motion exact (Karpat et al. 2012).
module bench_fixed_steps
  use gearsweep_kinds, only: dp, pi
  use gearsweep_motion, only: oscillator_t
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  implicit none
  private
  public :: march_sweep

  integer, parameter, public :: runge_kutta = 1, constant = 2, constant_aligned = 3

  !> One period in equal steps, or in equal steps of each stretch between breaks.
  !> Coefficients are (pair, place), places being the left end and the middle of
  !> each step in turn; beyond A to E rate and stiffness are 0.
  type :: table_t
    real(dp), allocatable :: width(:)
    real(dp), allocatable :: rate(:, :), error(:, :), stiffness(:, :)
  end type table_t

  !> Exact motion over a step for the contact set in which it was made last.
  type :: step_t
    integer :: contact = -1                      !< bits
    real(dp) :: rest = 0, push = 0, map(2, 2) = 0
  end type step_t

contains

  !> Dynamic factors at all speeds (1/min), each marched from rest under the mean
  !> load until the transient is below `wanted` static deflections; NaN where the
  !> steps are too long.
  subroutine march_sweep(osc, rpm, method, steps, wanted, dynamic_factor)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm(:), wanted
    integer, intent(in) :: method, steps
    real(dp), intent(out) :: dynamic_factor(:)
    type(table_t) :: table
    integer :: i

    call tabulate(osc, steps, method == constant_aligned, table)
    do i = 1, size(rpm)
      dynamic_factor(i) = march(osc, table, 60/(osc%mesh%teeth(1)*rpm(i)), method, wanted)
    end do
  end subroutine march_sweep

  subroutine tabulate(osc, steps, aligned, table)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: steps
    logical, intent(in) :: aligned
    type(table_t), intent(out) :: table
    real(dp), allocatable :: breaks(:), left(:)
    integer, allocatable :: counts(:)
    integer :: i, k

    breaks = [0.0_dp, 1.0_dp]
    associate (change => modulo(osc%mesh%contact_ratio, 1.0_dp))
      if (aligned .and. change > 0) breaks = [0.0_dp, change, 1.0_dp]
    end associate
    counts = [(max(1, nint(steps*(breaks(i + 1) - breaks(i)))), i=1, size(breaks) - 1)]
    table%width = [(((breaks(i + 1) - breaks(i))/counts(i), k=1, counts(i)), i=1, size(counts))]
    left = [((breaks(i) + (breaks(i + 1) - breaks(i))*(k - 1)/counts(i), k=1, counts(i)), i=1, size(counts)), 1.0_dp]
    associate (n => size(table%width), pairs => osc%pairs)
      allocate (table%rate(pairs, 2*n + 1), table%error(pairs, 2*n + 1), table%stiffness(pairs, 2*n + 1), source=0.0_dp)
      do i = 1, 2*n + 1
        if (mod(i, 2) == 1) call fill(osc, left((i + 1)/2), i, table)
        if (mod(i, 2) == 0) call fill(osc, left(i/2) + table%width(i/2)/2, i, table)
      end do
    end associate
  end subroutine tabulate

  pure subroutine fill(osc, phase, place, table)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: phase
    integer, intent(in) :: place
    type(table_t), intent(inout) :: table
    real(dp) :: s
    integer :: j

    do j = 1, osc%pairs
      s = phase + j - 1
      if (s > osc%mesh%contact_ratio) cycle
      table%stiffness(j, place) = osc%mesh%stiffness%value(s)
      table%error(j, place) = osc%mesh%profile_error%value(s)
      table%rate(j, place) = table%stiffness(j, place)*sum(1/osc%mass)
    end do
  end subroutine fill

  real(dp) function march(osc, table, duration, method, wanted)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    real(dp), intent(in) :: duration, wanted
    integer, intent(in) :: method
    integer, parameter :: most_periods = 3000
    type(step_t), allocatable :: step(:)
    real(dp) :: state(2), before(2), moved, decay, peak
    integer :: period

    allocate (step(size(table%width)))
    associate (zeta => osc%damping_ratio, scale => osc%static_scale, turn => osc%natural_frequency*duration)
      decay = exp(-turn*(zeta - sqrt(max(0.0_dp, zeta**2 - 1))))
      state = [scale, 0.0_dp]
      do period = 1, most_periods
        before = state
        if (method == runge_kutta) then
          call run_rk4(osc, table, duration, state, peak)
        else
          call run_constant(osc, table, duration, step, state, peak)
        end if
        moved = max(abs(state(1) - before(1)), abs(state(2) - before(2))/turn)/scale
        if (.not. moved < 1e6_dp) exit
        if (moved*max(1.0_dp, decay/(1 - decay)) < wanted) exit
      end do
    end associate
    march = peak/osc%load
    if (.not. moved < 1e6_dp) march = ieee_value(1.0_dp, ieee_quiet_nan)
  end function march

  !> Over one period; state is x and its derivative over the phase, m.
  subroutine run_rk4(osc, table, duration, state, peak)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    real(dp), intent(in) :: duration
    real(dp), intent(inout) :: state(2)
    real(dp), intent(out) :: peak
    real(dp) :: h, drive, a(2, 4)
    integer :: i

    drive = osc%load*sum(1/osc%mass)
    peak = 0
    do i = 1, size(table%width)
      h = table%width(i)
      a(:, 1) = slope(2*i - 1, state)
      a(:, 2) = slope(2*i, state + h/2*a(:, 1))
      a(:, 3) = slope(2*i, state + h/2*a(:, 2))
      a(:, 4) = slope(2*i + 1, state + h*a(:, 3))
      state = state + h/6*(a(:, 1) + 2*(a(:, 2) + a(:, 3)) + a(:, 4))
      call raise(table, 2*i + 1, state(1), peak)
    end do

  contains

    pure function slope(place, z)
      integer, intent(in) :: place
      real(dp), intent(in) :: z(2)
      real(dp) :: slope(2), square, push
      integer :: j

      square = 0
      push = drive
      do j = 1, size(table%rate, 1)
        if (z(1) <= table%error(j, place)) cycle
        square = square + table%rate(j, place)
        push = push + table%rate(j, place)*table%error(j, place)
      end do
      slope = [z(2), duration*(duration*(push - square*z(1)) - 2*osc%damping_ratio*sqrt(square)*z(2))]
    end function slope
  end subroutine run_rk4

  !> Raises `peak` to the largest pair load at a place.
  pure subroutine raise(table, place, x, peak)
    type(table_t), intent(in) :: table
    integer, intent(in) :: place
    real(dp), intent(in) :: x
    real(dp), intent(inout) :: peak
    integer :: j

    do j = 1, size(table%rate, 1)
      peak = max(peak, table%stiffness(j, place)*(x - table%error(j, place)))
    end do
  end subroutine raise

  !> The same by exact steps; each keeps its map while its contact set stays.
  subroutine run_constant(osc, table, duration, step, state, peak)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    real(dp), intent(in) :: duration
    type(step_t), intent(inout) :: step(:)
    real(dp), intent(inout) :: state(2)
    real(dp), intent(out) :: peak
    real(dp) :: before(2)
    integer :: i, j, contact

    peak = 0
    do i = 1, size(step)
      contact = 0
      do j = 1, size(table%rate, 1)
        if (table%rate(j, 2*i) > 0 .and. state(1) > table%error(j, 2*i)) contact = ibset(contact, j)
      end do
      if (contact /= step(i)%contact) call make_step(osc, table, i, contact, duration, step(i))
      before = state
      before(1) = before(1) - step(i)%rest
      state(1) = step(i)%map(1, 1)*before(1) + step(i)%map(1, 2)*before(2) + step(i)%rest + step(i)%push*table%width(i)/2
      state(2) = step(i)%map(2, 1)*before(1) + step(i)%map(2, 2)*before(2) + step(i)%push
      call raise(table, 2*i + 1, state(1), peak)
    end do
  end subroutine run_constant

  !> Step i with the coefficients of its middle.
  pure subroutine make_step(osc, table, i, contact, duration, step)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: i, contact
    real(dp), intent(in) :: duration
    type(step_t), intent(out) :: step
    real(dp) :: square, push, width, omega, half_drag, root, c, s
    logical :: touches(size(table%rate, 1))
    integer :: j

    width = table%width(i)
    touches = [(btest(contact, j), j=1, size(touches))]
    square = sum(table%rate(:, 2*i), mask=touches)*duration**2
    push = (sum(table%rate(:, 2*i)*table%error(:, 2*i), mask=touches) + osc%load*sum(1/osc%mass))*duration**2
    step%contact = contact
    if (contact == 0) then                       ! free flight
      step%map = reshape([1.0_dp, 0.0_dp, width, 1.0_dp], [2, 2])
      step%push = push*width
      return
    end if
    step%rest = push/square
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
    step%map = reshape([c + half_drag*s, -square*s, s, c - half_drag*s], [2, 2])
  end subroutine make_step
end module bench_fixed_steps
