!> Parametric stability of the motion in full contact, over speed and damping: with all pairs between A and E in contact or,
!> where contact reaches beyond, with those that carry the static load.
!>
!> A disturbance d of that motion obeys Hill's equation, d" + 2 zeta omega d' + omega^2 d = 0 with omega of mesh period
!> T: load and relief drop out. The two Floquet multipliers follow from the trace of its monodromy matrix and from the
!> determinant, exp(-2 zeta T mean omega) by Liouville's formula. That is at most 1, so the motion can only be lost
!> through a real multiplier: at 1 (fold) or at -1 (flip).
module gearsweep_stability
  use gearsweep_coefficients, only: coefficients_t, resolution_t
  use gearsweep_contact_set, only: period_t
  use gearsweep_error, only: error_t
  use gearsweep_full_contact, only: run_full_contact
  use gearsweep_gauss, only: batch_size
  use gearsweep_kinds, only: dp
  use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
  use, intrinsic :: iso_c_binding, only: c_null_ptr, c_ptr
  use gearsweep_memory, only: has_memory
  use gearsweep_oscillator, only: damping, make_oscillator, mesh_period, oscillator_t
  use gearsweep_period_map, only: discretise, period_map_t, set_durations
  use gearsweep_piecewise, only: constant
  use gearsweep_stop, only: wants_stop
  implicit none
  private
  public :: hill_t, make_hill, disturb, stability_t, map_stability

  !> Hill's equation, discretised.
  type :: hill_t
    type(oscillator_t) :: osc
    type(period_map_t) :: map
    real(dp) :: frequency = 0                    !< mean of omega over the period, rad/s
    logical :: lacks = .false.                   !< the memory does not hold the steps
    type(c_ptr) :: stop = c_null_ptr             !< an integer of the caller: once it is not 0, nothing more is computed
  end type hill_t

  type :: stability_t
    real(dp), allocatable :: modulus(:, :)       !< largest Floquet multiplier; NaN where unresolved; (speed, damping)
    integer, allocatable :: sense(:, :)          !< its sign where it is real, 0 for a complex pair; (speed, damping)
    logical :: lacks = .false.                   !< the memory does not hold it: nothing was found
  end type stability_t

  integer, parameter :: most_steps = 2**16

contains

  !> The multipliers over speeds and damping ratios, whatever damping the oscillator has. Once the integer behind `stop` is not
  !> 0 the rest is left out, and the map is not to be used.
  subroutine map_stability(osc, rpm, damping_ratio, tolerance, map, stop)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm(:)               !< speeds of the pinion, ascending, 1/min
    real(dp), intent(in) :: damping_ratio(:)
    real(dp), intent(in) :: tolerance            !< of the trace of the monodromy matrix
    type(stability_t), intent(out) :: map
    type(c_ptr), intent(in), optional :: stop
    type(hill_t) :: hill
    real(dp) :: duration(batch_size), longest
    logical :: resolved, fits
    integer :: first, last, i, k

    call has_memory(12.0_dp*size(rpm)*size(damping_ratio), fits)
    map%lacks = .not. fits
    if (map%lacks) return
    allocate (map%modulus(size(rpm), size(damping_ratio)), map%sense(size(rpm), size(damping_ratio)))
    if (size(damping_ratio) == 0) return
    if (present(stop)) hill%stop = stop
    longest = huge(longest)
    first = 1
    do while (first <= size(rpm))
      last = first
      do while (last < min(first + batch_size - 1, size(rpm)))
        if (rpm(last + 1) > 2*rpm(first)) exit
        last = last + 1
      end do
      duration = mesh_period(osc%mesh%teeth(1), [(rpm(min(i, last)), i=first, first + batch_size - 1)])
      ! A discretisation serves until half its steps would do.
      if (duration(1) < longest/2) then
        longest = duration(1)
        call make_hill(osc, longest, [minval(damping_ratio), maxval(damping_ratio)], tolerance, hill, resolved)
        map%lacks = hill%lacks
        if (map%lacks) return
      end if
      do k = 1, size(damping_ratio)
        if (wants_stop(hill%stop)) return
        call judge(hill, damping_ratio(k), duration, resolved, map%modulus(first:last, k), map%sense(first:last, k))
      end do
      first = last + 1
    end do
  end subroutine map_stability

  !> The largest multipliers of the first speeds of a batch.
  pure subroutine judge(hill, damping_ratio, duration, resolved, modulus, sense)
    type(hill_t), intent(inout) :: hill
    real(dp), intent(in) :: damping_ratio, duration(batch_size)
    logical, intent(in) :: resolved
    real(dp), intent(out) :: modulus(:)
    integer, intent(out) :: sense(:)
    real(dp) :: trace(batch_size), determinant(batch_size), square
    integer :: l

    modulus = ieee_value(1.0_dp, ieee_quiet_nan)
    sense = 0
    if (.not. resolved) return
    call disturb(hill, damping_ratio, duration, trace, determinant)
    do l = 1, size(modulus)
      square = trace(l)**2/4 - determinant(l)
      modulus(l) = sqrt(determinant(l))
      if (square < 0) cycle
      modulus(l) = abs(trace(l))/2 + sqrt(square)
      sense(l) = merge(1, -1, trace(l) > 0)
    end do
  end subroutine judge

  !> Trace and determinant of the monodromy matrix, for a batch of durations.
  pure subroutine disturb(hill, damping_ratio, duration, trace, determinant)
    type(hill_t), intent(inout) :: hill
    real(dp), intent(in) :: damping_ratio
    real(dp), intent(in) :: duration(batch_size)                     !< of the mesh period, s
    real(dp), intent(out), dimension(batch_size) :: trace, determinant   !< at each duration
    type(period_t) :: run(batch_size)
    real(dp), parameter :: rest(2, batch_size) = 0
    integer :: l

    hill%map%osc%damping_ratio = damping_ratio
    call set_durations(hill%map, duration)
    call run_full_contact(hill%map, rest, run)
    do l = 1, batch_size
      trace(l) = run(l)%monodromy(1, 1) + run(l)%monodromy(2, 2)
    end do
    determinant = exp(-damping(hill%map%osc, hill%frequency)*duration)
  end subroutine disturb

  !> Doubles the steps until the trace at the slowest speed is known to the tolerance with each damping ratio: a method
  !> of sixth order leaves less than a twentieth of what half the steps differ by, also where splines have their knots.
  subroutine make_hill(osc, duration, damping_ratio, tolerance, hill, resolved)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration             !< of the mesh period at the slowest speed, s
    real(dp), intent(in) :: damping_ratio(:)
    real(dp), intent(in) :: tolerance            !< of the trace
    type(hill_t), intent(inout) :: hill
    logical, intent(out) :: resolved             !< not where the speed is too low for the steps there may be
    real(dp) :: coarse(size(damping_ratio)), fine(size(damping_ratio)), fastest
    type(error_t), allocatable :: error
    integer :: steps

    hill%osc = osc
    resolved = .false.
    if (osc%mesh%reaches_beyond()) then
      ! The contact is that under the static load, with relief.
      hill%osc%mesh%profile_error = osc%mesh%profile_error%scaled(0.0_dp)
    else
      hill%osc%mesh%profile_error = constant(0.0_dp, osc%mesh%contact_ratio, 0.0_dp)
      call make_oscillator(hill%osc, error)
      if (allocated(error)) return
    end if
    fastest = osc%highest_frequency*max(1.0_dp, 2*maxval(damping_ratio))
    steps = 8
    do while (steps < fastest*duration)
      steps = 2*steps
      if (steps > most_steps) return
    end do
    call take_steps(hill, steps, duration, damping_ratio, fine)
    do while (steps < most_steps .and. .not. (hill%lacks .or. wants_stop(hill%stop)))
      steps = 2*steps
      coarse = fine
      call take_steps(hill, steps, duration, damping_ratio, fine)
      if (hill%lacks .or. wants_stop(hill%stop)) exit
      resolved = all(abs(fine - coarse) <= 20*tolerance*max(1.0_dp, abs(fine)))
      if (resolved) return
    end do
  end subroutine make_hill

  !> Discretises with about `steps` steps; the trace with each damping ratio.
  pure subroutine take_steps(hill, steps, duration, damping_ratio, trace)
    type(hill_t), intent(inout) :: hill
    integer, intent(in) :: steps
    real(dp), intent(in) :: duration, damping_ratio(:)
    real(dp), intent(out) :: trace(size(damping_ratio))
    real(dp), dimension(batch_size) :: of_speed, determinant
    integer :: k

    call discretise(hill%osc, resolution_t(real(steps, dp)), hill%map)
    hill%lacks = hill%map%table%steps == 0
    if (hill%lacks) return
    hill%frequency = mean_frequency(hill%map%table)
    trace = 0
    do k = 1, size(damping_ratio)
      if (wants_stop(hill%stop)) return
      call disturb(hill, damping_ratio(k), spread(duration, 1, batch_size), of_speed, determinant)
      trace(k) = of_speed(1)
    end do
  end subroutine take_steps

  !> Mean of omega over the period (rad/s), by Gauss.
  pure real(dp) function mean_frequency(table)
    type(coefficients_t), intent(in) :: table
    real(dp), parameter :: weight(3) = [5, 8, 5]/18.0_dp

    mean_frequency = sum(table%width*matmul(weight, table%omega(:, :table%steps)))
  end function mean_frequency
end module gearsweep_stability
