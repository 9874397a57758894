!> The motion seen once a mesh period, as a new pair enters: one point where it repeats with the mesh, n
!> points where it repeats after n periods, a cloud where it never does; and how fast disturbances grow.
module gearsweep_strobe
  use gearsweep_kinds, only: dp
  use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
  use gearsweep_accuracy, only: mesh_period
  use gearsweep_march, only: sure_growth
  use gearsweep_memory, only: has_memory
  use gearsweep_motion, only: oscillator_t, resolution_t, table_t, tabulate
  use gearsweep_status, only: status_aperiodic, status_chaotic, status_chatter, status_ok, status_subharmonic, status_unresolved
  use gearsweep_period, only: period_t, maps_t, begin_maps, run_period
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
    !> ok, subharmonic, chaotic; aperiodic: neither repeats nor is surely chaotic, as far as it was followed;
    !> unresolved, chatter.
    integer, allocatable :: status(:)
    integer, allocatable :: periods(:)           !< mesh periods until the motion repeats; 0: it does not
    logical :: lacks = .false.                   !< the memory does not hold it: nothing was followed
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
    logical :: fits
    integer :: i

    call has_memory(size(rpm)*(24 + 17.0_dp*keep), fits)
    strobe%lacks = .not. fits
    if (strobe%lacks) return
    allocate (strobe%x(keep, size(rpm)), strobe%v(keep, size(rpm)), strobe%exponent(size(rpm)), &
              source=ieee_value(1.0_dp, ieee_quiet_nan))
    allocate (strobe%status(size(rpm)), strobe%periods(size(rpm)))
    state = [osc%rest, 0.0_dp]
    if (present(start)) state = start
    do i = 1, size(rpm)
      associate (duration => mesh_period(osc%mesh%teeth(1), rpm(i)))
        call follow(osc, duration, settle, state, strobe%x(:, i), strobe%v(:, i), strobe%exponent(i), strobe%status(i), &
                    strobe%lacks)
        if (strobe%lacks) return
        call name_motion(osc, duration, strobe%x(:, i), strobe%v(:, i), strobe%exponent(i), strobe%status(i), &
                         strobe%periods(i))
      end associate
    end do
  end subroutine strobe_motion

  !> The same at one speed; `state` (m, m/s) goes from its begin to its end, unless its steps are too many
  !> (unresolved) or contact changes without end (chatter).
  pure subroutine follow(osc, duration, settle, state, x, v, exponent, status, lacks)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration
    integer, intent(in) :: settle
    real(dp), intent(inout) :: state(2), x(:), v(:), exponent
    integer, intent(out) :: status
    logical, intent(inout) :: lacks
    type(table_t) :: table
    type(period_t) :: run
    type(maps_t) :: maps
    real(dp) :: steps, unit, from(2), disturbance(2), growth
    integer :: i

    steps = max(osc%natural_frequency, osc%highest_frequency*max(0.5_dp, osc%damping_ratio))*duration/angle
    status = status_unresolved
    if (steps > most_steps) return
    status = status_chatter
    call tabulate(osc, resolution_t(max(steps, real(fewest_steps, dp))), table)
    lacks = table%steps == 0
    if (lacks) return
    call begin_maps(table, maps)
    unit = max(1.0_dp, osc%natural_frequency*duration)
    from = state*[1.0_dp, duration]
    disturbance = 1
    growth = 0
    do i = 1 - settle, size(x)
      call run_period(osc, table, duration, from, maps, run)
      if (run%failed) return
      from = run%state
      disturbance = matmul(run%map, disturbance*[1.0_dp, unit])/[1.0_dp, unit]
      if (i > 0) then
        x(i) = from(1)
        v(i) = from(2)/duration
        growth = growth + log(norm2(disturbance))
      end if
      disturbance = disturbance/norm2(disturbance)
    end do
    state = from/[1.0_dp, duration]
    exponent = growth/size(x)
    status = status_aperiodic
  end subroutine follow

  !> The status of a motion that was followed to the end, and after how many mesh periods it repeats, judged
  !> by the later half of what was kept.
  pure subroutine name_motion(osc, duration, x, v, exponent, status, periods)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration, x(:), v(:), exponent
    integer, intent(inout) :: status
    integer, intent(out) :: periods
    real(dp), parameter :: same = 1e-4_dp        ! static deflections
    real(dp) :: unit
    integer :: n, last

    periods = 0
    if (status /= status_aperiodic) return
    unit = duration/max(1.0_dp, osc%natural_frequency*duration)
    last = size(x)
    do n = 1, last/4
      if (any(abs(x(last/2 + n:) - x(last/2:last - n)) > same*osc%static_scale)) cycle
      if (any(unit*abs(v(last/2 + n:) - v(last/2:last - n)) > same*osc%static_scale)) cycle
      periods = n
      status = merge(status_ok, status_subharmonic, n == 1)
      return
    end do
    if (exponent*last > sure_growth) status = status_chaotic
  end subroutine name_motion
end module gearsweep_strobe
