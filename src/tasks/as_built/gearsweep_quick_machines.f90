!> The pairs of gears of the task `as_built` with `quick`: a sample to the tolerance, the others quickly.
module gearsweep_quick_machines
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use gearsweep_as_built_machines, only: deviating, machine_t, run_exactly, tooth_t
  use gearsweep_deviations, only: deviations_t
  use gearsweep_error, only: error_t, fail
  use gearsweep_kinds, only: dp
  use gearsweep_quick_sweep, only: quick_motion_t, run_quickly
  use gearsweep_stages, only: stages_t
  use gearsweep_status, only: has_result, status_inexact, status_ok, status_stopped
  use gearsweep_stop, only: wants_stop
  use gearsweep_sweep, only: each, run_sweep, sweep_options_t, sweep_t
  use gearsweep_table, only: no_number
  implicit none
  private
  public :: run_mostly_quickly

  !> The quick way's dynamic factors are told to this.
  real(dp), parameter :: tolerance = 1e-3_dp

contains

  !> All pairs of gears. Ends early where the caller stops the run.
  subroutine run_mostly_quickly(stages, which, rpm, machines, sample_error, error, unit_stress)
    type(stages_t), intent(in) :: stages
    integer, intent(in) :: which(:)              !< reliefs of the case
    real(dp), intent(in) :: rpm(:)               !< speeds of the pinion, 1/min
    type(machine_t), intent(inout) :: machines(:, :)       !< as drawn; (assembly, draw)
    real(dp), intent(inout) :: sample_error(:)   !< largest difference of both ways' dynamic factors, NaN where none; (relief)
    real(dp), allocatable, intent(in) :: unit_stress(:, :)           !< as of `run_exactly`
    type(error_t), allocatable, intent(inout) :: error
    type(deviations_t), allocatable :: deviations(:)
    type(quick_motion_t), allocatable :: motions(:, :)     ! (speed, machine)
    logical :: in_sample(size(machines))
    integer :: a, d, k, r

    in_sample = sampled(size(machines))
    do k = 1, size(machines)
      if (.not. in_sample(k)) cycle
      if (allocated(error) .or. wants_stop(stages%accuracy%steady%stop)) return
      call locate(k, a, d)
      call run_exactly(stages, which, rpm, machines(a, d), error, unit_stress)
    end do
    if (allocated(error)) return
    deviations = [((machines(a, d)%deviations, a=1, size(machines, 1)), d=1, size(machines, 2))]
    allocate (motions(size(rpm), size(machines)))
    do r = 1, size(which)
      call run_quickly(stages%motion(which(r)), deviations, rpm, stages%running%threads, stages%accuracy%steady%stop, motions)
      if (wants_stop(stages%accuracy%steady%stop)) return
      call stages%running%tell(size(rpm)*count(.not. in_sample), stages%accuracy%steady%stop)
      sample_error(r) = -1
      do k = 1, size(machines)
        call locate(k, a, d)
        if (in_sample(k)) sample_error(r) = max(sample_error(r), difference(motions(:, k), machines(a, d)%sweep, r))
      end do
      if (sample_error(r) < 0) sample_error(r) = no_number()
      do k = 1, size(machines)
        if (in_sample(k)) cycle
        call locate(k, a, d)
        if (r == 1) call allocate_results(size(rpm), size(which), machines(a, d))
        call take(stages, which(r), rpm, motions(:, k), sample_error(r), r, machines(a, d), error)
        if (allocated(error)) return
      end do
    end do

  contains

    pure subroutine locate(k, a, d)
      integer, intent(in) :: k
      integer, intent(out) :: a, d

      a = 1 + modulo(k - 1, size(machines, 1))
      d = 1 + (k - 1)/size(machines, 1)
    end subroutine locate

    !> The largest; below 0 where no motion is known both ways.
    pure real(dp) function difference(found, sweep, relief)
      type(quick_motion_t), intent(in) :: found(:)         ! (speed)
      type(sweep_t), intent(in) :: sweep
      integer, intent(in) :: relief
      logical :: known(size(found))

      known = found%is_found .and. has_result(sweep%status(:, relief))
      difference = maxval(abs(found%peak/stages%motion(1)%load - sweep%dynamic_factor(:, relief)), mask=known)
    end function difference
  end subroutine run_mostly_quickly

  !> Which of so many pairs of gears are computed both ways: the first, and one in ten, ten at most.
  pure function sampled(machines) result(in_sample)
    integer, intent(in) :: machines
    logical :: in_sample(machines)
    integer :: i

    in_sample = .false.
    associate (n => min(10, 1 + (machines - 1)/10))
      in_sample([(1 + i*(machines - 1)/max(1, n - 1), i=0, n - 1)]) = .true.
    end associate
  end function sampled

  pure subroutine allocate_results(speeds, reliefs, machine)
    integer, intent(in) :: speeds, reliefs
    type(machine_t), intent(inout) :: machine

    associate (sweep => machine%sweep)
      allocate (sweep%rpm(speeds))
      allocate (sweep%dynamic_factor(speeds, reliefs), sweep%estimate(speeds, reliefs), sweep%dte_rms(speeds, reliefs), &
                sweep%dte_range(speeds, reliefs), sweep%mesh_multiplier(speeds, reliefs), source=no_number())
      allocate (sweep%status(speeds, reliefs), source=status_stopped)
      allocate (sweep%periods(speeds, reliefs), source=1)
      allocate (machine%worst(reliefs))
    end associate
  end subroutine allocate_results

  !> Takes the motions of a pair of gears, and computes those that are not found to the tolerance.
  subroutine take(stages, which, rpm, motions, sample_error, relief, machine, error)
    type(stages_t), intent(in) :: stages
    integer, intent(in) :: which                 ! relief of the case
    real(dp), intent(in) :: rpm(:)
    type(quick_motion_t), intent(in) :: motions(:)         ! (speed)
    real(dp), intent(in) :: sample_error
    integer, intent(in) :: relief
    type(machine_t), intent(inout) :: machine
    type(error_t), allocatable, intent(inout) :: error
    logical :: is_near
    integer :: k

    is_near = .not. ieee_is_nan(sample_error)
    if (is_near) is_near = sample_error <= tolerance
    associate (sweep => machine%sweep)
      sweep%rpm = rpm
      where (motions%is_found)
        sweep%dynamic_factor(:, relief) = motions%peak/stages%motion(which)%load
        sweep%estimate(:, relief) = sample_error
        sweep%dte_rms(:, relief) = sqrt(max(0.0_dp, motions%sums(2) - motions%sums(1)**2))
        sweep%dte_range(:, relief) = motions%largest - motions%least
        sweep%status(:, relief) = merge(status_ok, status_inexact, is_near)
      end where
      if (.not. all(motions%is_found)) call solve_rest(stages, which, rpm, motions, relief, machine, error)
      if (allocated(error) .or. .not. any(has_result(sweep%status(:, relief)))) return
      k = maxloc(sweep%dynamic_factor(:, relief), 1, mask=has_result(sweep%status(:, relief)))
      machine%worst(relief) = tooth_t(rpm(k), sweep%dynamic_factor(k, relief), motions(k)%pair, motions(k)%place)
      if (.not. motions(k)%is_found) machine%worst(relief)%pair = -1
    end associate
  end subroutine take

  !> The speeds that the quick way left.
  subroutine solve_rest(stages, which, rpm, motions, relief, machine, error)
    type(stages_t), intent(in) :: stages
    integer, intent(in) :: which, relief
    real(dp), intent(in) :: rpm(:)
    type(quick_motion_t), intent(in) :: motions(:)         ! (speed)
    type(machine_t), intent(inout) :: machine
    type(error_t), allocatable, intent(inout) :: error
    type(error_t), allocatable :: refused
    type(sweep_options_t) :: options
    type(sweep_t) :: found
    integer, allocatable :: left(:)
    integer :: i

    left = pack([(i, i=1, size(rpm))], .not. motions%is_found)
    options = stages%sweep_options()
    options%direction = each
    options%is_counted = .false.
    call run_sweep(deviating(stages%motion([which]), machine%deviations, error), rpm(left), options, found, refused)
    if (allocated(refused)) then
      call fail(error, refused%code, refused%message)
      return
    end if
    associate (sweep => machine%sweep)
      sweep%dynamic_factor(left, relief) = found%dynamic_factor(:, 1)
      sweep%estimate(left, relief) = found%estimate(:, 1)
      sweep%dte_rms(left, relief) = found%dte_rms(:, 1)
      sweep%dte_range(left, relief) = found%dte_range(:, 1)
      sweep%mesh_multiplier(left, relief) = found%mesh_multiplier(:, 1)
      sweep%status(left, relief) = found%status(:, 1)
      sweep%periods(left, relief) = found%periods(:, 1)
    end associate
  end subroutine solve_rest
end module gearsweep_quick_machines
