!> The design whose largest dynamic factor over all speeds and several loads is least, over several numbers of a case at once.
!>
!> The worst of many dynamic factors has ridges along which no number by itself makes it less. So around the best design so far the
!> dynamic factor at each speed is taken to be linear in the numbers, with the slopes of differences. Of these linear functions the
!> largest is made least within a step up and down; where that design is no better in truth, the step is halved (sequential linear
!> programming for minimax: Madsen, Schjaer-Jacobsen 1978, Linearly constrained minimax optimization, Math. Programming 14).
!> A design is evaluated first at the worst speeds of the best one so far, and dropped if it is worse there.
module gearsweep_joint_optimum
  use gearsweep_error, only: error_t
  use gearsweep_kinds, only: dp
  use gearsweep_optimum, only: peak_t, worst_of
  use gearsweep_oscillator, only: oscillator_t
  use gearsweep_status, only: status_stopped
  use gearsweep_sweep, only: run_sweep, sweep_options_t, sweep_t
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  implicit none
  private
  public :: design_t, joint_optimum_t, starts_t, find_joint_optimum, build_design

  !> Numbers of a case, and what they lead to.
  type :: design_t
    real(dp), allocatable :: number(:)           !< parts of their ranges, 0 to 1
    type(peak_t), allocatable :: worst(:)        !< largest dynamic factor over the speeds; (load)
    integer, allocatable :: failed(:)            !< speeds without a result; (load)
  end type design_t

  !> Designs to begin with: the search goes down from the best of them.
  type :: starts_t
    real(dp), allocatable :: number(:, :)        !< parts of their ranges, 0 to 1; (number, design)
  end type starts_t

  type :: joint_optimum_t
    type(design_t) :: best                       !< without `worst`: no design has a result
    real(dp) :: within = 1                       !< last step, of the ranges
    integer :: tried = 0                         !< designs
    logical :: stopped = .false.                 !< the caller ended the search
  end type joint_optimum_t

  abstract interface
    !> The oscillators of a design, one for each load. A module procedure, as `build_motion` of gearsweep_optimum is.
    subroutine build_design(context, number, motion, error)
      import :: dp, error_t, oscillator_t
      class(*), intent(in) :: context
      real(dp), intent(in) :: number(:)          !< parts of their ranges, 0 to 1
      type(oscillator_t), allocatable, intent(out) :: motion(:)
      type(error_t), allocatable, intent(out) :: error
    end subroutine build_design
  end interface

  real(dp), parameter :: first_step = 1/8.0_dp, last_step = 1/512.0_dp
  integer, parameter :: most_steps = 60

contains

  !> The best of the designs that are best around the best one of each group of starts, as there are several valleys: none of the
  !> starts that were tried at all speeds is better.
  subroutine find_joint_optimum(build, context, starts, rpm, options, optimum, error)
    procedure(build_design) :: build
    class(*), intent(in) :: context              !< for `build`
    type(starts_t), intent(in) :: starts(:)      !< in groups
    real(dp), intent(in) :: rpm(:)               !< speeds of the pinion, ascending, 1/min
    type(sweep_options_t), intent(in) :: options
    type(joint_optimum_t), intent(out) :: optimum
    type(error_t), allocatable, intent(out) :: error
    type(sweep_options_t) :: rough
    type(joint_optimum_t) :: of_group
    integer :: i

    ! A dynamic factor to 1e-5 places the optimum far better than it can be made.
    rough = options
    rough%accuracy%steady%tolerance = max(options%accuracy%steady%tolerance, 1e-5_dp)
    rough%is_counted = .false.
    do i = 1, size(starts)
      call descend(build, context, starts(i)%number, rpm, rough, of_group, error)
      if (allocated(error)) return
      of_group%tried = of_group%tried + optimum%tried
      optimum%tried = of_group%tried
      optimum%stopped = of_group%stopped
      if (optimum%stopped) return
      if (.not. allocated(of_group%best%worst)) cycle
      if (allocated(optimum%best%worst)) then
        if (.not. is_less(of_group%best, optimum%best)) cycle
      end if
      optimum = of_group
    end do
  end subroutine find_joint_optimum

  !> The best design around the best of some.
  subroutine descend(build, context, starts, rpm, options, optimum, error)
    procedure(build_design) :: build
    class(*), intent(in) :: context
    real(dp), intent(in) :: starts(:, :)         ! (number, design)
    real(dp), intent(in) :: rpm(:)
    type(sweep_options_t), intent(in) :: options
    type(joint_optimum_t), intent(out) :: optimum
    type(error_t), allocatable, intent(inout) :: error
    real(dp) :: step
    logical :: better
    integer :: i

    do i = 1, size(starts, 2)
      call try_design(build, context, starts(:, i), rpm, options, optimum, better, error)
      if (allocated(error) .or. optimum%stopped) return
    end do
    if (.not. allocated(optimum%best%worst)) return
    step = first_step
    do i = 1, most_steps
      call take_step(build, context, step, rpm, options, optimum, better, error)
      if (allocated(error) .or. optimum%stopped) return
      optimum%within = step
      if (.not. better) step = step/2
      if (step < last_step) exit
    end do
  end subroutine descend

  !> From the best design to that whose linear functions have the least largest value, if it is better.
  subroutine take_step(build, context, step, rpm, options, optimum, better, error)
    procedure(build_design) :: build
    class(*), intent(in) :: context
    real(dp), intent(in) :: step                 ! at most, in each number
    real(dp), intent(in) :: rpm(:)
    type(sweep_options_t), intent(in) :: options
    type(joint_optimum_t), intent(inout) :: optimum
    logical, intent(out) :: better
    type(error_t), allocatable, intent(inout) :: error
    type(design_t) :: beside
    real(dp), dimension(size(optimum%best%number)) :: centre, number
    real(dp), allocatable :: factor(:), other(:), slope(:, :)
    logical, allocatable :: known(:)
    real(dp) :: shift
    integer :: k

    better = .false.
    centre = optimum%best%number
    call sweep_number(build, context, centre, rpm, options, beside, factor, optimum%stopped, error)
    if (allocated(error) .or. optimum%stopped) return
    allocate (slope(size(factor), size(centre)))
    known = .not. ieee_is_nan(factor)
    do k = 1, size(centre)
      shift = sign(step/4, 0.5_dp - centre(k))
      number = centre
      number(k) = number(k) + shift
      call sweep_number(build, context, number, rpm, options, beside, other, optimum%stopped, error)
      if (allocated(error) .or. optimum%stopped) return
      known = known .and. .not. ieee_is_nan(other)
      slope(:, k) = (other - factor)/shift
    end do
    optimum%tried = optimum%tried + size(centre)
    do k = 1, size(centre)
      slope(:count(known), k) = pack(slope(:, k), known)
    end do
    factor = pack(factor, known)
    number = centre + least_largest(factor, slope(:size(factor), :), max(-step, -centre), min(step, 1 - centre))
    call try_design(build, context, number, rpm, options, optimum, better, error)
  end subroutine take_step

  !> Where between two corners the largest of linear functions is least: by samples that fill the box evenly (additive recurrence),
  !> and again, in ever smaller boxes around the best one.
  pure function least_largest(value, slope, low, high) result(place)
    real(dp), intent(in) :: value(:), slope(:, :)          ! at 0; (function), (function, coordinate)
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

  !> Takes a design for the best one if it is. At first only at the speeds around those that are worst for the best one so far.
  subroutine try_design(build, context, number, rpm, options, optimum, better, error)
    procedure(build_design) :: build
    class(*), intent(in) :: context
    real(dp), intent(in) :: number(:), rpm(:)
    type(sweep_options_t), intent(in) :: options
    type(joint_optimum_t), intent(inout) :: optimum
    logical, intent(out) :: better
    type(error_t), allocatable, intent(inout) :: error
    type(oscillator_t), allocatable :: motion(:)
    type(design_t) :: design
    logical, allocatable :: some(:)

    better = .false.
    call build(context, number, motion, error)
    if (allocated(error)) return
    optimum%tried = optimum%tried + 1
    design%number = number
    if (allocated(optimum%best%worst)) then
      some = around_worst(optimum%best, rpm)
      call sweep_design(motion, pack(rpm, some), options, design, optimum%stopped, error)
      if (allocated(error) .or. optimum%stopped) return
      if (.not. is_less(design, optimum%best)) return
    end if
    call sweep_design(motion, rpm, options, design, optimum%stopped, error)
    if (allocated(error) .or. optimum%stopped) return
    better = any(design%worst%rpm > 0)
    if (better .and. allocated(optimum%best%worst)) better = is_less(design, optimum%best)
    if (better) optimum%best = design
  end subroutine try_design

  !> The speeds next to the worst one of each load.
  pure function around_worst(best, rpm) result(some)
    type(design_t), intent(in) :: best
    real(dp), intent(in) :: rpm(:)
    logical :: some(size(rpm))
    integer, parameter :: beside = 3
    integer :: i, at

    some = .false.
    do i = 1, size(best%worst)
      if (.not. best%worst(i)%rpm > 0) cycle
      at = minloc(abs(rpm - best%worst(i)%rpm), 1)
      some(max(1, at - beside):min(size(rpm), at + beside)) = .true.
    end do
  end function around_worst

  !> Is a design better by more than its dynamic factors may err? Fewer speeds without a result come first.
  pure logical function is_less(design, best)
    type(design_t), intent(in) :: design, best
    real(dp), parameter :: clear = 2e-5_dp

    is_less = sum(design%failed) <= sum(best%failed) .and. largest(design) < largest(best) - clear
  end function is_less

  pure real(dp) function largest(design)
    type(design_t), intent(in) :: design

    largest = maxval(design%worst%dynamic_factor, mask=design%worst%rpm > 0)
  end function largest

  !> All dynamic factors of a design, load after load; NaN where there is no result.
  subroutine sweep_number(build, context, number, rpm, options, design, factor, stopped, error)
    procedure(build_design) :: build
    class(*), intent(in) :: context
    real(dp), intent(in) :: number(:), rpm(:)
    type(sweep_options_t), intent(in) :: options
    type(design_t), intent(inout) :: design
    real(dp), allocatable, intent(out) :: factor(:)
    logical, intent(out) :: stopped
    type(error_t), allocatable, intent(inout) :: error
    type(oscillator_t), allocatable :: motion(:)

    stopped = .false.
    call build(context, number, motion, error)
    if (.not. allocated(error)) call sweep_design(motion, rpm, options, design, stopped, error, factor)
  end subroutine sweep_number

  !> A design at these speeds, with all loads.
  subroutine sweep_design(motion, rpm, options, design, stopped, error, factor)
    type(oscillator_t), intent(in) :: motion(:)  ! (load)
    real(dp), intent(in) :: rpm(:)
    type(sweep_options_t), intent(in) :: options
    type(design_t), intent(inout) :: design
    logical, intent(out) :: stopped
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable, intent(out), optional :: factor(:)  ! all, load after load
    type(sweep_t) :: sweep
    integer :: i

    stopped = .false.
    call run_sweep(motion, rpm, options, sweep, error)
    if (allocated(error)) return
    stopped = any(sweep%status == status_stopped)
    design%worst = [(worst_of(sweep%rpm, sweep%dynamic_factor(:, i)), i=1, size(motion))]
    design%failed = count(ieee_is_nan(sweep%dynamic_factor), 1)
    if (present(factor)) factor = [sweep%dynamic_factor]
  end subroutine sweep_design
end module gearsweep_joint_optimum
