!> Design of least noise or load over several numbers of a case at once, and over several loads.
!>
!> A judge returns several values of a design, whose maximum is to be minimized: all dynamic factors, one transmission error for
!> each load, or one mean of them. The maximum of many values has ridges along which no number by itself lowers it. So around the
!> best design so far each value is approximated as linear in the numbers, with slopes from differences. The maximum of these
!> linear functions is minimized within a step up and down; if that design is not really better, the step is halved (sequential
!> linear programming for minimax: Madsen, Schjaer-Jacobsen 1978, Linearly constrained minimax optimization, Math. Programming
!> 14). A design is judged first at the worst speeds of the best one so far, and dropped if it is worse there.
module gearsweep_motion_joint_optimum
  use gearsweep_base, only: dp, error_t
  use gearsweep_motion_optimum, only: peak_t, worst_of
  use gearsweep_motion_oscillator, only: oscillator_t
  use gearsweep_motion_steady_motion, only: status_stopped
  use gearsweep_motion_sweep, only: run_sweep, sweep_options_t, sweep_t
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  implicit none
  private
  public :: design_t, joint_optimum_t, starts_t, find_joint_optimum, sweep_design, largest_value

  !> Numbers of a case, and their results.
  type :: design_t
    real(dp), allocatable :: number(:)           !< parts of their ranges, 0 to 1
    real(dp), allocatable :: value(:)            !< values whose maximum is minimized; NaN where there is no result
    real(dp), allocatable :: of_load(:)          !< judged value under each load; NaN where there is no result
    real(dp), allocatable :: rpm(:)              !< speed at which that is largest, 1/min; 0: no speed; (load)
    integer, allocatable :: failed(:)            !< number of speeds without a result; (load)
  end type design_t

  !> Initial designs: the search descends from the best of them.
  type :: starts_t
    real(dp), allocatable :: number(:, :)        !< parts of their ranges, 0 to 1; (number, design)
  end type starts_t

  type :: joint_optimum_t
    type(design_t) :: best                       !< best design; without `value`: no design has a result
    real(dp) :: within = 1                       !< last step, of the ranges
    integer :: tried = 0                         !< number of designs
    logical :: stopped = .false.                 !< the caller ended the search
  end type joint_optimum_t

  abstract interface
    !> Computes all components of `design`. A module procedure, as `build_motion` of gearsweep_motion_optimum is.
    subroutine judge_design(context, number, design, stopped, error, best)
      import :: design_t, dp, error_t
      class(*), intent(in) :: context
      real(dp), intent(in) :: number(:)          !< parts of their ranges, 0 to 1
      type(design_t), intent(out) :: design
      logical, intent(out) :: stopped            !< the caller ended the search
      type(error_t), allocatable, intent(out) :: error
      !> Best design so far. If present, only the speeds around its worst ones are computed; where a few speeds cannot show that a
      !> design is not the best, all results stay unallocated.
      type(design_t), intent(in), optional :: best
    end subroutine judge_design
  end interface

  real(dp), parameter :: first_step = 1/8.0_dp, last_step = 1/512.0_dp
  integer, parameter :: most_steps = 60

contains

  !> Descends from the best start of each group, as there are several local minima, and returns the best design. No start that was
  !> judged at all speeds is better.
  subroutine find_joint_optimum(judge, context, starts, optimum, error)
    procedure(judge_design) :: judge
    class(*), intent(in) :: context              !< passed to `judge`
    type(starts_t), intent(in) :: starts(:)      !< in groups
    type(joint_optimum_t), intent(out) :: optimum
    type(error_t), allocatable, intent(out) :: error
    type(joint_optimum_t) :: of_group
    integer :: i

    do i = 1, size(starts)
      call descend(judge, context, starts(i)%number, of_group, error)
      if (allocated(error)) return
      of_group%tried = of_group%tried + optimum%tried
      optimum%tried = of_group%tried
      optimum%stopped = of_group%stopped
      if (optimum%stopped) return
      if (.not. allocated(of_group%best%value)) cycle
      if (allocated(optimum%best%value)) then
        if (.not. is_less(of_group%best, optimum%best)) cycle
      end if
      optimum = of_group
    end do
  end subroutine find_joint_optimum

  !> Finds the best design near the best of some starts.
  subroutine descend(judge, context, starts, optimum, error)
    procedure(judge_design) :: judge
    class(*), intent(in) :: context
    real(dp), intent(in) :: starts(:, :)         ! (number, design)
    type(joint_optimum_t), intent(out) :: optimum
    type(error_t), allocatable, intent(inout) :: error
    real(dp) :: step
    logical :: better
    integer :: i

    do i = 1, size(starts, 2)
      call try_design(judge, context, starts(:, i), optimum, better, error)
      if (allocated(error) .or. optimum%stopped) return
    end do
    if (.not. allocated(optimum%best%value)) return
    step = first_step
    do i = 1, most_steps
      call take_step(judge, context, step, optimum, better, error)
      if (allocated(error) .or. optimum%stopped) return
      optimum%within = step
      if (.not. better) step = step/2
      if (step < last_step) exit
    end do
  end subroutine descend

  !> Moves from the best design to the minimum of the linear functions' maximum, if that design is better.
  subroutine take_step(judge, context, step, optimum, better, error)
    procedure(judge_design) :: judge
    class(*), intent(in) :: context
    real(dp), intent(in) :: step                 ! largest change of each number
    type(joint_optimum_t), intent(inout) :: optimum
    logical, intent(out) :: better
    type(error_t), allocatable, intent(inout) :: error
    type(design_t) :: beside
    real(dp), dimension(size(optimum%best%number)) :: centre, number
    real(dp), allocatable :: value(:), slope(:, :)
    logical, allocatable :: known(:)
    real(dp) :: shift
    integer :: k

    better = .false.
    centre = optimum%best%number
    call judge(context, centre, beside, optimum%stopped, error)
    if (allocated(error) .or. optimum%stopped) return
    value = beside%value
    allocate (slope(size(value), size(centre)))
    known = .not. ieee_is_nan(value)
    do k = 1, size(centre)
      shift = sign(step/4, 0.5_dp - centre(k))
      number = centre
      number(k) = number(k) + shift
      call judge(context, number, beside, optimum%stopped, error)
      if (allocated(error) .or. optimum%stopped) return
      known = known .and. .not. ieee_is_nan(beside%value)
      slope(:, k) = (beside%value - value)/shift
    end do
    optimum%tried = optimum%tried + size(centre)
    do k = 1, size(centre)
      slope(:count(known), k) = pack(slope(:, k), known)
    end do
    value = pack(value, known)
    number = centre + least_largest(value, slope(:size(value), :), max(-step, -centre), min(step, 1 - centre))
    call try_design(judge, context, number, optimum, better, error)
  end subroutine take_step

  !> Point between two corners at which the maximum of linear functions is least: by samples that fill the box evenly (additive
  !> recurrence), repeated in smaller and smaller boxes around the best one.
  pure function least_largest(value, slope, low, high) result(place)
    real(dp), intent(in) :: value(:), slope(:, :)          ! at the origin; (function), (function, coordinate)
    real(dp), intent(in) :: low(:), high(:)
    real(dp) :: place(size(low))
    integer, parameter :: rounds = 14, samples = 300
    real(dp), parameter :: shrinks = 0.6_dp, ratio(4) = [0.8566748838545029_dp, 0.7338918566271260_dp, 0.6287067210378087_dp, &
                                                         0.5385972572236101_dp]
    real(dp) :: centre(size(low)), width(size(low)), trial(size(low)), least, largest
    integer :: i, k, round

    place = 0
    least = maxval(value)
    centre = (low + high)/2
    width = (high - low)/2
    do round = 1, rounds
      do i = 1, samples
        do k = 1, size(low)
          trial(k) = centre(k) + width(k)*(2*modulo(i*ratio(k), 1.0_dp) - 1)
        end do
        trial = min(high, max(low, trial))
        largest = maxval(value + matmul(slope, trial))
        if (largest >= least) cycle
        least = largest
        place = trial
      end do
      centre = place
      width = shrinks*width
    end do
  end function least_largest

  !> Replaces the best design if this one is better. First compares only the speeds around the worst ones of the best so far.
  subroutine try_design(judge, context, number, optimum, better, error)
    procedure(judge_design) :: judge
    class(*), intent(in) :: context
    real(dp), intent(in) :: number(:)
    type(joint_optimum_t), intent(inout) :: optimum
    logical, intent(out) :: better
    type(error_t), allocatable, intent(inout) :: error
    type(design_t) :: design

    better = .false.
    optimum%tried = optimum%tried + 1
    if (allocated(optimum%best%value)) then
      call judge(context, number, design, optimum%stopped, error, optimum%best)
      if (allocated(error) .or. optimum%stopped) return
      if (allocated(design%value)) then
        if (.not. is_less(design, optimum%best)) return
      end if
    end if
    call judge(context, number, design, optimum%stopped, error)
    if (allocated(error) .or. optimum%stopped) return
    better = .not. all(ieee_is_nan(design%value))
    if (better .and. allocated(optimum%best%value)) better = is_less(design, optimum%best)
    if (better) optimum%best = design
  end subroutine try_design

  !> True if a design is better by more than the errors of its values. Fewer speeds without a result are better.
  pure logical function is_less(design, best)
    type(design_t), intent(in) :: design, best
    real(dp), parameter :: clear = 2e-5_dp

    is_less = sum(design%failed) <= sum(best%failed) .and. &
              largest_value(design) < largest_value(best) - clear*min(1.0_dp, largest_value(best))
  end function is_less

  pure real(dp) function largest_value(design)
    type(design_t), intent(in) :: design

    largest_value = maxval(design%value, mask=.not. ieee_is_nan(design%value))
  end function largest_value

  !> Computes the dynamic factors of a design over its loads, for `judge_design`: each is a value.
  subroutine sweep_design(motion, rpm, options, design, stopped, error, best, dte_rms)
    type(oscillator_t), intent(in) :: motion(:)  !< (load)
    real(dp), intent(in) :: rpm(:)               !< speeds of the pinion, ascending, 1/min
    type(sweep_options_t), intent(in) :: options
    type(design_t), intent(inout) :: design
    logical, intent(out) :: stopped
    type(error_t), allocatable, intent(inout) :: error
    type(design_t), intent(in), optional :: best
    real(dp), allocatable, intent(out), optional :: dte_rms(:, :)  !< m; NaN where there is no result; (speed, load)
    type(sweep_options_t) :: rough
    type(sweep_t) :: sweep
    type(peak_t) :: worst(size(motion))
    integer :: i

    ! A dynamic factor to 1e-5 locates the optimum far more exactly than it can be made.
    rough = options
    rough%accuracy%steady%tolerance = max(options%accuracy%steady%tolerance, 1e-5_dp)
    rough%is_counted = .false.
    stopped = .false.
    if (present(best)) then
      call run_sweep(motion, pack(rpm, around_worst(best, rpm)), rough, sweep, error)
    else
      call run_sweep(motion, rpm, rough, sweep, error)
    end if
    if (allocated(error)) return
    stopped = any(sweep%status == status_stopped)
    worst = [(worst_of(sweep%rpm, sweep%dynamic_factor(:, i)), i=1, size(motion))]
    design%of_load = worst%dynamic_factor
    design%rpm = worst%rpm
    design%failed = count(ieee_is_nan(sweep%dynamic_factor), 1)
    design%value = [sweep%dynamic_factor]
    if (present(dte_rms)) call move_alloc(sweep%dte_rms, dte_rms)
  end subroutine sweep_design

  !> Selects the speeds next to the worst one of each load.
  pure function around_worst(best, rpm) result(some)
    type(design_t), intent(in) :: best
    real(dp), intent(in) :: rpm(:)
    logical :: some(size(rpm))
    integer, parameter :: beside = 3
    integer :: i, at

    some = .false.
    do i = 1, size(best%rpm)
      if (.not. best%rpm(i) > 0) cycle
      at = minloc(abs(rpm - best%rpm(i)), 1)
      some(max(1, at - beside):min(size(rpm), at + beside)) = .true.
    end do
  end function around_worst
end module gearsweep_motion_joint_optimum
