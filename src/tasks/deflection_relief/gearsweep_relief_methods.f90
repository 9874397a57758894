!> Tip reliefs of both gears that different methods lead to, and what each of them does to the static transmission error and to the
!> dynamic factor.
module gearsweep_relief_methods
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use gearsweep_case_variation, only: case_variation_t, with_relief
  use gearsweep_error, only: error_t
  use gearsweep_harmonics, only: find_harmonics, harmonics_t
  use gearsweep_inputs, only: motions_inputs_t
  use gearsweep_kinds, only: dp
  use gearsweep_optimum, only: peak_t, worst_of
  use gearsweep_oscillator, only: oscillator_t
  use gearsweep_status, only: status_stopped
  use gearsweep_sweep, only: run_sweep, sweep_options_t, sweep_t
  implicit none
  private
  public :: relief_method_t, judge_reliefs, least_error_relief, error_range

  !> A relief, the method that led to it, and what it does.
  type :: relief_method_t
    character(18) :: name = ''
    real(dp) :: amount(2) = 0                    !< at the tips of pinion and gear, m
    real(dp) :: within = -1                      !< so near lies the least that the method looks for, m; below 0: it looks for none
    real(dp) :: error_range = 0                  !< peak-to-peak static transmission error, m
    type(peak_t) :: worst                        !< largest dynamic factor over the speeds; speed 0: none has an answer
    integer :: failed = 0                        !< speeds without an answer
  end type relief_method_t

contains

  !> What the reliefs of all methods do, at these speeds (1/min). `inputs`: of the case's motions, whose reliefs begin at the
  !> same places. Not whole where the caller ends the run: `stopped`.
  subroutine judge_reliefs(inputs, rpm, options, methods, stopped, error)
    type(motions_inputs_t), intent(in) :: inputs
    real(dp), intent(in) :: rpm(:)
    type(sweep_options_t), intent(in) :: options
    type(relief_method_t), intent(inout) :: methods(:)
    logical, intent(out) :: stopped
    type(error_t), allocatable, intent(inout) :: error
    type(oscillator_t) :: motion(size(methods))
    type(sweep_t) :: sweep
    integer :: i

    stopped = .false.
    do i = 1, size(methods)
      call relieve_both(inputs, methods(i)%amount, motion(i), error)
      if (allocated(error)) return
      methods(i)%error_range = error_range(motion(i))
    end do
    call run_sweep(motion, rpm, options, sweep, error)
    if (allocated(error)) return
    stopped = any(sweep%status == status_stopped)
    do i = 1, size(methods)
      methods(i)%worst = worst_of(sweep%rpm, sweep%dynamic_factor(:, i))
      methods(i)%failed = count(ieee_is_nan(sweep%dynamic_factor(:, i)))
    end do
  end subroutine judge_reliefs

  !> The motion of a case with these amounts of relief at the tips of pinion and gear (m).
  subroutine relieve_both(inputs, amount, motion, error)
    type(motions_inputs_t), intent(in) :: inputs
    real(dp), intent(in) :: amount(2)
    type(oscillator_t), intent(out) :: motion
    type(error_t), allocatable, intent(inout) :: error
    type(case_variation_t) :: case

    case = case_variation_t(inputs, maxval(amount))
    if (case%relief > 0) case%inputs%motion%relief%fraction = amount/case%relief
    call case%build(motion, error)
  end subroutine relieve_both

  !> Peak-to-peak static transmission error under the static load of a motion (m).
  pure real(dp) function error_range(motion)
    type(oscillator_t), intent(in) :: motion
    type(harmonics_t) :: harmonics

    call find_harmonics(motion%mesh, motion%load, 1, harmonics)
    error_range = harmonics%peak_to_peak()
  end function error_range

  !> The amount of relief (m) between 0 and `largest` whose peak-to-peak static transmission error is least: a scan, then ever
  !> finer scans around the best one, as the curve has kinks. It lies `within` so much (m) of the least.
  subroutine least_error_relief(inputs, largest, amount, within, error)
    type(motions_inputs_t), intent(in) :: inputs
    real(dp), intent(in) :: largest
    real(dp), intent(out) :: amount, within
    type(error_t), allocatable, intent(inout) :: error
    integer, parameter :: scan = 16, rounds = 4
    type(oscillator_t) :: motion
    real(dp) :: range(0:scan), first, last
    integer :: i, round, best

    first = 0
    last = largest
    do round = 1, rounds
      do i = 0, scan
        call with_relief(inputs, first + (last - first)*i/scan, motion, error)
        if (allocated(error)) return
        range(i) = error_range(motion)
      end do
      best = minloc(range, 1) - 1
      amount = first + (last - first)*best/scan
      within = (last - first)/scan
      first = max(0.0_dp, amount - within)
      last = min(largest, amount + within)
    end do
  end subroutine least_error_relief
end module gearsweep_relief_methods
