!> The motion seen once a mesh period, as a new pair enters: one point where it repeats with the mesh, n
!> points where it repeats after n periods, a cloud where it never does; and how fast disturbances grow.
module gearsweep_strobe
  use gearsweep_kinds, only: dp
  use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
  use gearsweep_accuracy, only: mesh_period
  use gearsweep_motion, only: oscillator_t, resolution_t, table_t, tabulate
  use gearsweep_period, only: period_t, run_period
  implicit none
  private
  public :: strobe_t, strobe_motion

  !> First index mesh period, second speed; NaN where the motion was not followed.
  type :: strobe_t
    real(dp), allocatable :: x(:, :)             !< m
    real(dp), allocatable :: v(:, :)             !< m/s
    !> Largest Lyapunov exponent, of a mesh period: the mean logarithm by which a disturbance grows. Below 0
    !> where the motion repeats, above 0 where it is chaotic.
    real(dp), allocatable :: exponent(:)
  end type strobe_t

  !> A step of this angle of the natural motion makes errors of some 1e-9.
  real(dp), parameter :: angle = 0.2_dp
  integer, parameter :: fewest_steps = 24, most_steps = 2**16

contains

  !> Follows the transient for `settle` mesh periods at each pinion speed of `rpm` (1/min), then the motion for
  !> `keep` more. It starts from `start` (m, m/s) or at rest under the static load, then at each speed where it
  !> was at the one before.
  pure subroutine strobe_motion(osc, rpm, settle, keep, strobe, start)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm(:)
    integer, intent(in) :: settle, keep
    type(strobe_t), intent(out) :: strobe
    real(dp), intent(in), optional :: start(2)
    real(dp) :: state(2)
    integer :: i

    allocate (strobe%x(keep, size(rpm)), strobe%v(keep, size(rpm)), strobe%exponent(size(rpm)), &
              source=ieee_value(1.0_dp, ieee_quiet_nan))
    state = [osc%rest, 0.0_dp]
    if (present(start)) state = start*[1.0_dp, mesh_period(osc%mesh%teeth(1), rpm(1))]
    do i = 1, size(rpm)
      if (i > 1) state(2) = state(2)*rpm(i - 1)/rpm(i)
      call follow(osc, mesh_period(osc%mesh%teeth(1), rpm(i)), settle, state, strobe%x(:, i), strobe%v(:, i), &
                  strobe%exponent(i))
    end do
  end subroutine strobe_motion

  !> The same at one speed; `state` goes from its begin to its end, unless its steps are too many.
  pure subroutine follow(osc, duration, settle, state, x, v, exponent)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration
    integer, intent(in) :: settle
    real(dp), intent(inout) :: state(2), x(:), v(:), exponent
    type(table_t) :: table
    type(period_t) :: run
    real(dp) :: steps, unit, disturbance(2), growth
    integer :: i

    steps = max(osc%natural_frequency, osc%highest_frequency*max(0.5_dp, osc%damping_ratio))*duration/angle
    if (steps > most_steps) return
    call tabulate(osc, resolution_t(max(steps, real(fewest_steps, dp))), table)
    unit = max(1.0_dp, osc%natural_frequency*duration)
    disturbance = 1
    growth = 0
    do i = 1 - settle, size(x)
      call run_period(osc, table, duration, state, .false., run)
      if (run%failed) return
      state = run%state
      disturbance = matmul(run%map, disturbance*[1.0_dp, unit])/[1.0_dp, unit]
      if (i > 0) then
        x(i) = state(1)
        v(i) = state(2)/duration
        growth = growth + log(norm2(disturbance))
      end if
      disturbance = disturbance/norm2(disturbance)
    end do
    exponent = growth/size(x)
  end subroutine follow
end module gearsweep_strobe
