!> Many gears that differ in the errors of their teeth alone, at many speeds, quickly: to 1e-3 of the dynamic factor in place of the
!> tolerance. Speeds near each other share steps and laws, all gears share these and the motions over the steps. The work is split
!> the same way for any number of threads, so that the results have the same bits.
module gearsweep_quick_sweep
  use, intrinsic :: iso_c_binding, only: c_ptr
  use gearsweep_deviations, only: deviations_t
  use gearsweep_kinds, only: dp, pi
  use gearsweep_memory, only: has_memory, release_claim, team
  use gearsweep_oscillator, only: frequency_ratio, oscillator_t
  use gearsweep_quick_steps, only: lanes, lay_maps, lay_steps, quick_maps_t, quick_steps_t
  use gearsweep_quick_turn, only: follow_quickly, lay_errors, quick_motion_t
  use gearsweep_stop, only: wants_stop
  use gearsweep_traps, only: leader_traps, share_traps
  implicit none
  private
  public :: quick_motion_t, run_quickly

  !> Length of a step: of the natural motion (rad), of the mesh period, and of a wave of the flanks (rad), as over a step the errors
  !> are parabolas.
  real(dp), parameter :: longest_turning = 1.0_dp, longest_part = 0.08_dp, longest_wave = 0.5_dp
  !> Speeds that share steps: how many, and how far the highest may be above the lowest.
  integer, parameter :: most_speeds = 16
  real(dp), parameter :: widest = 2.0_dp

contains

  !> The motions; none is found where the motion does not repeat after a turn, where the coast sides touch, where too many pairs may
  !> be in contact, where memory lacks or where the caller stops the run.
  subroutine run_quickly(osc, deviations, rpm, threads, stop, motions)
    type(oscillator_t), intent(in) :: osc        !< of nominal teeth
    !> Of each pair of gears; over the same turn, with waves of the same orders.
    type(deviations_t), intent(in) :: deviations(:)
    real(dp), intent(in) :: rpm(:)               !< speeds of the pinion, ascending, 1/min
    integer, intent(in) :: threads               !< 0: as many as the machine has
    type(c_ptr), intent(in) :: stop              !< of gearsweep_stop
    type(quick_motion_t), intent(out) :: motions(:, :)     !< (speed, pair of gears)
    integer, allocatable :: first(:)
    integer :: i
    type(c_ptr) :: traps

    first = [1]
    do i = 2, size(rpm)
      if (rpm(i) > widest*rpm(first(size(first))) .or. i - first(size(first)) == most_speeds) first = [first, i]
    end do
    first = [first, size(rpm) + 1]
    traps = leader_traps()
    !$omp parallel do default(none) shared(osc, deviations, rpm, stop, motions, first, traps) &
    !$omp schedule(dynamic, 1) num_threads(team(threads, size(first) - 1))
    do i = 1, size(first) - 1
      call share_traps(traps, 1)
      call run_group(osc, deviations, rpm(first(i):first(i + 1) - 1), stop, motions(first(i):first(i + 1) - 1, :))
      call release_claim()
      call share_traps(traps, 0)
    end do
    !$omp end parallel do
  end subroutine run_quickly

  !> Speeds that share steps.
  subroutine run_group(osc, deviations, rpm, stop, motions)
    type(oscillator_t), intent(in) :: osc
    type(deviations_t), intent(in) :: deviations(:)
    real(dp), intent(in) :: rpm(:)
    type(c_ptr), intent(in) :: stop
    type(quick_motion_t), intent(inout) :: motions(:, :)
    type(quick_steps_t) :: steps
    type(quick_maps_t) :: maps((size(rpm) - 1)/lanes + 1)
    type(quick_motion_t) :: beside
    real(dp), allocatable :: errors(:, :, :), turning(:)
    real(dp) :: longest
    logical :: fits
    integer :: i, k, last

    turning = 2*pi/frequency_ratio(osc, rpm)
    longest = min(longest_part, longest_turning/maxval(turning))
    associate (waves => deviations(1)%waves)
      if (size(waves) > 0) longest = min(longest, longest_wave/(2*pi*maxval(waves%order/real(osc%mesh%teeth(waves%gear), dp))))
      call lay_steps(osc, waves, longest, steps)
    end associate
    if (steps%steps == 0) return
    associate (sets => size(steps%law, 1), n => steps%steps)
      call has_memory(real(n, dp)*(sets*(storage_size(steps%law)/8 + 80.0_dp*lanes*size(maps)) + &
                                   96.0_dp*deviations(1)%periods), fits)
      if (.not. fits) return
    end associate
    do i = 1, size(maps)
      call lay_maps(steps, turning(lanes*(i - 1) + 1:min(lanes*i, size(rpm))), maps(i))
    end do
    do k = 1, size(deviations)
      if (wants_stop(stop)) return
      if (.not. alike(deviations(1), deviations(k))) cycle
      call lay_errors(steps, deviations(k), errors)
      beside = quick_motion_t()
      do i = 1, size(maps)
        last = min(lanes*i, size(rpm))
        call follow_quickly(steps, maps(i), errors, beside, motions(lanes*(i - 1) + 1:last, k))
        beside = motions(last, k)
      end do
    end do
  end subroutine run_group

  !> Do both repeat after the same turn, with waves of the same orders?
  pure logical function alike(a, b)
    type(deviations_t), intent(in) :: a, b

    alike = a%periods == b%periods .and. size(a%waves) == size(b%waves)
    if (alike) alike = all(a%waves%order == b%waves%order .and. a%waves%gear == b%waves%gear)
  end function alike
end module gearsweep_quick_sweep
