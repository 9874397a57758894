!> Parametric stability of the motion with all pairs in contact, over speed and damping.
!>
!> A disturbance d of that motion obeys Hill's equation, d" + 2 zeta w d' + w^2 d = 0 with w of mesh
!> period T: load and relief drop out. The two Floquet multipliers follow from the trace of its map
!> over T and its determinant, exp(-2 zeta T mean w) by Liouville's formula. That is at most 1, so the
!> motion can only be lost through a real multiplier: at 1 (fold) or at -1 (flip).
module gearsweep_stability
  use gearsweep_kinds, only: dp
  use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
  use gearsweep_accuracy, only: mesh_period
  use gearsweep_error, only: error_t
  use gearsweep_gauss, only: lanes
  use gearsweep_maps, only: maps_t, begin_maps, hold_lanes
  use gearsweep_memory, only: has_memory
  use gearsweep_motion, only: make_oscillator, oscillator_t, resolution_t, table_t, tabulate
  use gearsweep_piecewise, only: constant
  use gearsweep_step, only: period_t
  implicit none
  private
  public :: hill_t, make_hill, disturb, stability_t, map_stability

  !> Hill's equation on a table.
  type :: hill_t
    type(oscillator_t) :: osc
    type(table_t) :: table
    real(dp) :: frequency = 0                    !< mean of w over the period, rad/s
    logical :: lacks = .false.                   !< the memory does not hold the table
    type(maps_t) :: maps
  end type hill_t

  !> First index speed, second damping ratio.
  type :: stability_t
    real(dp), allocatable :: modulus(:, :)       !< largest of the multipliers; NaN where unresolved
    integer, allocatable :: sense(:, :)          !< its sign where it is real, 0 for a complex pair
    logical :: lacks = .false.                   !< the memory does not hold it: nothing was found
  end type stability_t

  integer, parameter :: most_steps = 2**16

contains

  !> The multipliers at pinion speeds `rpm` (1/min, ascending) and the damping ratios `damping`, whatever
  !> damping the oscillator has; `tolerance` is that of the trace.
  subroutine map_stability(osc, rpm, damping, tolerance, map)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm(:), damping(:), tolerance
    type(stability_t), intent(out) :: map
    type(hill_t) :: hill
    real(dp) :: duration(lanes), longest
    logical :: resolved, fits
    integer :: first, last, i, k

    call has_memory(12.0_dp*size(rpm)*size(damping), fits)
    map%lacks = .not. fits
    if (map%lacks) return
    allocate (map%modulus(size(rpm), size(damping)), map%sense(size(rpm), size(damping)))
    if (size(damping) == 0) return
    longest = huge(longest)
    first = 1
    do while (first <= size(rpm))
      last = first
      do while (last < min(first + lanes - 1, size(rpm)))
        if (rpm(last + 1) > 2*rpm(first)) exit
        last = last + 1
      end do
      duration = mesh_period(osc%mesh%teeth(1), [(rpm(min(i, last)), i=first, first + lanes - 1)])
      ! A table serves until half its steps would do.
      if (duration(1) < longest/2) then
        longest = duration(1)
        call make_hill(osc, longest, [minval(damping), maxval(damping)], tolerance, hill, resolved)
        map%lacks = hill%lacks
        if (map%lacks) return
      end if
      do k = 1, size(damping)
        call judge(hill, damping(k), duration, resolved, map%modulus(first:last, k), map%sense(first:last, k))
      end do
      first = last + 1
    end do
  end subroutine map_stability

  !> The largest multipliers of the first lanes.
  pure subroutine judge(hill, damping, duration, resolved, modulus, sense)
    type(hill_t), intent(inout) :: hill
    real(dp), intent(in) :: damping, duration(lanes)
    logical, intent(in) :: resolved
    real(dp), intent(out) :: modulus(:)
    integer, intent(out) :: sense(:)
    real(dp) :: trace(lanes), determinant(lanes), square
    integer :: l

    modulus = ieee_value(1.0_dp, ieee_quiet_nan)
    sense = 0
    if (.not. resolved) return
    call disturb(hill, damping, duration, trace, determinant)
    do l = 1, size(modulus)
      square = trace(l)**2/4 - determinant(l)
      modulus(l) = sqrt(determinant(l))
      if (square < 0) cycle
      modulus(l) = abs(trace(l))/2 + sqrt(square)
      sense(l) = merge(1, -1, trace(l) > 0)
    end do
  end subroutine judge

  !> Trace and determinant of the map of a disturbance over periods of these durations (s).
  pure subroutine disturb(hill, damping, duration, trace, determinant)
    type(hill_t), intent(inout) :: hill
    real(dp), intent(in) :: damping, duration(lanes)
    real(dp), intent(out), dimension(lanes) :: trace, determinant
    type(period_t) :: run(lanes)
    real(dp), parameter :: rest(2, lanes) = 0
    integer :: l

    hill%osc%damping_ratio = damping
    call begin_maps(hill%table, hill%maps)
    call hold_lanes(hill%osc, hill%table, lanes, duration, rest, hill%maps, run)
    do l = 1, lanes
      trace(l) = run(l)%map(1, 1) + run(l)%map(2, 2)
    end do
    determinant = exp(-2*damping*hill%frequency*duration)
  end subroutine disturb

  !> Steps are doubled until the trace at the slowest speed, of mesh period `duration` (s), is known to
  !> `tolerance` with each of `damping`: a method of sixth order leaves less than a twentieth of what
  !> half the steps differ by, also where splines have their knots. Not `resolved`: too slow for the
  !> steps there may be.
  subroutine make_hill(osc, duration, damping, tolerance, hill, resolved)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration, damping(:), tolerance
    type(hill_t), intent(inout) :: hill
    logical, intent(out) :: resolved
    real(dp) :: coarse(size(damping)), fine(size(damping)), fastest
    type(error_t), allocatable :: error
    integer :: steps

    hill%osc = osc
    hill%osc%mesh%profile_error = constant(0.0_dp, osc%mesh%contact_ratio, 0.0_dp)
    call make_oscillator(hill%osc, error)
    resolved = .false.
    if (allocated(error)) return
    fastest = osc%highest_frequency*max(1.0_dp, 2*maxval(damping))
    steps = 8
    do while (steps < fastest*duration)
      steps = 2*steps
      if (steps > most_steps) return
    end do
    call take_steps(hill, steps, duration, damping, fine)
    do while (steps < most_steps .and. .not. hill%lacks)
      steps = 2*steps
      coarse = fine
      call take_steps(hill, steps, duration, damping, fine)
      if (hill%lacks) exit
      resolved = all(abs(fine - coarse) <= 20*tolerance*max(1.0_dp, abs(fine)))
      if (resolved) return
    end do
  end subroutine make_hill

  !> Tabulates with about `steps` steps; the trace with each of `damping`.
  pure subroutine take_steps(hill, steps, duration, damping, trace)
    type(hill_t), intent(inout) :: hill
    integer, intent(in) :: steps
    real(dp), intent(in) :: duration, damping(:)
    real(dp), intent(out) :: trace(size(damping))
    real(dp), dimension(lanes) :: of_lane, determinant
    integer :: k

    call tabulate(hill%osc, resolution_t(real(steps, dp)), hill%table)
    hill%lacks = hill%table%steps == 0
    if (hill%lacks) return
    hill%frequency = mean_frequency(hill%table)
    do k = 1, size(damping)
      call disturb(hill, damping(k), spread(duration, 1, lanes), of_lane, determinant)
      trace(k) = of_lane(1)
    end do
  end subroutine take_steps

  !> Mean of w over the period (rad/s), by Gauss.
  pure real(dp) function mean_frequency(table)
    type(table_t), intent(in) :: table
    real(dp), parameter :: weight(3) = [5, 8, 5]/18.0_dp

    mean_frequency = sum(table%width*matmul(weight, table%omega))
  end function mean_frequency
end module gearsweep_stability
