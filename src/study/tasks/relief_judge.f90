!> Reliefs that the task `optimum` varies, and its criteria.
!>
!> The variables are one amount of relief, or amounts and lengths of both gears' reliefs, under one load or several. The criteria
!> are dynamic factor or dynamic transmission error over the speeds, or static transmission error.
module gearsweep_study_tasks_relief_judge
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use gearsweep_base, only: dp, error_t, no_number, wants_stop
  use gearsweep_mesh, only: find_harmonics, harmonics_t, static_range
  use gearsweep_motion, only: design_t, optimum_t, oscillator_t, starts_t, sweep_design, sweep_options_t
  use gearsweep_study_run_case_variation, only: case_variation_t, largest_relief, relief_start
  use gearsweep_study_run_inputs, only: motions_inputs_t
  use gearsweep_study_run_stages, only: running_t
  implicit none
  private
  public :: designs_t, make_designs, relief_of, design_starts, amount_curve_t, curve_of, errors_t, find_errors, judge, judge_t, &
            scan_amounts

  !> Designs of a case: their variables are one amount, or that of each gear, and one length, or that of each gear, if it is varied.
  !> The design with the case's own lengths and the best single amount is one of them.
  type :: designs_t
    logical :: with_length = .false., each_gear = .false.
    type(motions_inputs_t), allocatable :: of_load(:)      !< inputs of the oscillators, one for each load
    type(motions_inputs_t) :: inputs             !< inputs under the largest load
    real(dp) :: largest(2) = 0                   !< largest amounts at the tips, m
    !> Lengths of both reliefs in base pitches, and the parts of their ranges at the case's own ones.
    real(dp), dimension(2) :: shortest = 0, own = 0, longest = 0, own_part = 0
  end type designs_t

  !> Shortest relief, as a part of the path of contact.
  real(dp), parameter :: least_length = 0.05_dp

  !> Criteria, in the order of `judged_words`.
  integer, parameter, public :: by_factor = 1, by_range = 2, by_harmonic = 3, by_dte = 4
  character(*), parameter, public :: judged_words(4) = [character(16) :: 'dynamic_factor', 'ste_peak_to_peak', 'mesh_harmonic', &
                                                        'dte_rms']

  type :: judge_t
    integer :: by = by_factor
    integer :: harmonic = 1                      !< mesh harmonic whose amplitude is minimised
    real(dp), allocatable :: share(:)            !< weight of each load in the mean; not allocated: the largest value counts
    type(designs_t) :: designs
    real(dp), allocatable :: rpm(:)              !< pinion speeds, ascending, 1/min
    type(sweep_options_t) :: options
  contains
    procedure :: combined, needs_motion
  end type judge_t

  !> Static transmission error under each load, m; (load).
  type :: errors_t
    real(dp), allocatable :: range(:)            !< peak-to-peak value
    real(dp), allocatable :: amplitude(:)        !< amplitude of the harmonic
  end type errors_t

  !> Results of the tried amounts of relief, ascending.
  type :: amount_curve_t
    real(dp), allocatable :: amount(:)           !< amounts, m
    real(dp), allocatable :: of_load(:, :)       !< criterion; NaN if not converged; (load, amount)
    real(dp), allocatable :: rpm(:, :)           !< speed of its largest value, 1/min; 0: none
    integer, allocatable :: failed(:, :)         !< number of speeds that did not converge
    real(dp), allocatable :: value(:)            !< criterion over all loads; (amount)
    type(errors_t), allocatable :: errors(:)
    logical, allocatable :: is_bound(:)          !< true if some speeds ruled the amount out, and the others were skipped
    integer :: best = 0                          !< index of the best amount; 0 if none converged
    real(dp) :: resolution = 0                   !< distance of the best amount from the true optimum at most, m
    logical :: stopped = .false.                 !< true if the caller ended the search: the curve is incomplete
  end type amount_curve_t

contains

  !> Fills `largest` and the lengths from the other components.
  subroutine make_designs(designs, amount)
    type(designs_t), intent(inout) :: designs
    real(dp), intent(in) :: amount               !< best single amount, m; 0: not known
    type(motions_inputs_t) :: inputs

    inputs = designs%inputs
    if (designs%each_gear) inputs%motion%relief%fraction = 1
    associate (relief => designs%inputs%motion%relief, low => designs%shortest, own => designs%own, high => designs%longest)
      designs%largest = largest_relief(inputs)
      if (designs%each_gear) then
        designs%largest = max(designs%largest, amount*relief%fraction)
      else
        designs%largest = max(designs%largest, amount)*relief%fraction
      end if
      own = relief_start(relief)
      own(1) = relief%contact_ratio - own(1)
      low = min(least_length*relief%contact_ratio, own)
      ! The relief begins at the pitch point at the earliest.
      high = max([relief%contact_ratio - relief%pitch_point, relief%pitch_point], own)
      designs%own_part = (own - low)/max(high - low, tiny(1.0_dp))
      if (.not. designs%each_gear) designs%own_part = sum(designs%own_part)/2
    end associate
  end subroutine make_designs

  !> Computes the amounts of relief at the tips of pinion and gear (m), and the path coordinates of their starts.
  pure subroutine relief_of(designs, number, amount, start)
    type(designs_t), intent(in) :: designs
    real(dp), intent(in) :: number(:)            !< parts of the variables' ranges, 0 to 1
    real(dp), intent(out) :: amount(2), start(2)
    real(dp) :: part(2), length(2)

    associate (relief => designs%inputs%motion%relief)
      amount = designs%largest*[number(1), number(merge(2, 1, designs%each_gear))]
      start = relief_start(relief)
      if (.not. designs%with_length) return
      part = [number(size(number) - merge(1, 0, designs%each_gear)), number(size(number))]
      length = length_at(part, designs%own_part, designs%shortest, designs%own, designs%longest)
      start = [relief%contact_ratio - length(1), length(2)]
    end associate
  end subroutine relief_of

  !> Length at a part of its range: piecewise linear, with the case's own length at the joint.
  elemental real(dp) function length_at(part, own_part, shortest, own, longest) result(length)
    real(dp), intent(in) :: part, own_part, shortest, own, longest

    if (part < own_part) then
      length = shortest + (own - shortest)*(part/own_part)
    else
      length = own
      if (own_part < 1) length = own + (longest - own)*((part - own_part)/(1 - own_part))
    end if
  end function length_at

  !> Start designs: the best single amount, and a grid over the ranges, with the same parts of them for both gears; a group for each
  !> length.
  pure function design_starts(designs, amount) result(starts)
    type(designs_t), intent(in) :: designs
    real(dp), intent(in) :: amount               !< best single amount, m; below 0: none converged
    integer, parameter :: amounts = 8, lengths = 4
    type(starts_t), allocatable :: starts(:)
    real(dp), allocatable :: number(:, :)
    real(dp) :: tip(2), of_amount(2)
    integer :: each, groups, first, i, k

    each = merge(2, 1, designs%each_gear)
    groups = merge(lengths, 1, designs%with_length)
    first = merge(1, 0, amount >= 0)
    allocate (starts(first + groups), number(each*merge(2, 1, designs%with_length), amounts + 1))
    do k = 1, groups
      do i = 0, amounts
        number(:each, i + 1) = i/real(amounts, dp)
        number(each + 1:, i + 1) = k/real(lengths, dp)
      end do
      starts(first + k)%number = number
    end do
    if (first == 0) return
    tip = amount*designs%inputs%motion%relief%fraction
    of_amount = 0
    where (designs%largest > 0) of_amount = tip/designs%largest
    if (.not. designs%each_gear) of_amount = maxval(of_amount)
    number(:each, 1) = min(1.0_dp, of_amount(:each))
    if (designs%with_length) number(each + 1:, 1) = designs%own_part(:each)
    starts(1)%number = number(:, :1)
  end function design_starts

  !> Builds the oscillators of a design, one for each load.
  subroutine with_design(designs, number, motion, error)
    type(designs_t), intent(in) :: designs
    real(dp), intent(in) :: number(:)
    type(oscillator_t), allocatable, intent(out) :: motion(:)
    type(error_t), allocatable, intent(out) :: error
    type(case_variation_t) :: case
    real(dp) :: amount(2), start(2)
    integer :: i

    call relief_of(designs, number, amount, start)
    allocate (motion(size(designs%of_load)))
    do i = 1, size(motion)
      case%inputs = designs%of_load(i)
      associate (relief => case%inputs%motion%relief)
        ! With a variable length, the conditions of short relief do not apply.
        if (designs%with_length) relief%start = 'pitch'
        relief%shift = relief%shift + start - relief_start(relief)
      end associate
      call case%set_reliefs(amount)
      call case%build(motion(i), error)
      if (allocated(error)) return
    end do
  end subroutine with_design

  !> Criterion over all loads: the largest value, or the weighted mean; NaN if one did not converge.
  pure real(dp) function combined(self, of_load)
    class(judge_t), intent(in) :: self
    real(dp), intent(in) :: of_load(:)

    if (allocated(self%share)) then
      combined = sum(self%share*of_load)
    else
      combined = no_number()
      if (.not. all(ieee_is_nan(of_load))) combined = maxval(of_load, mask=.not. ieee_is_nan(of_load))
    end if
  end function combined

  pure logical function needs_motion(self)
    class(judge_t), intent(in) :: self

    needs_motion = any(self%by == [by_factor, by_dte])
  end function needs_motion

  !> Computes the criterion of a design, for `find_joint_optimum`.
  subroutine judge(context, number, design, stopped, error, best)
    class(*), intent(in) :: context              !< judge_t
    real(dp), intent(in) :: number(:)
    type(design_t), intent(out) :: design
    logical, intent(out) :: stopped
    type(error_t), allocatable, intent(out) :: error
    type(design_t), intent(in), optional :: best
    type(oscillator_t), allocatable :: motion(:)
    type(errors_t) :: errors
    real(dp), allocatable :: rms(:, :)
    integer :: i

    stopped = .false.
    select type (context)
    type is (judge_t)
      stopped = wants_stop(context%options%accuracy%steady%stop)
      ! A part of the speeds bounds the largest value, but no mean.
      if (present(best) .and. (context%by /= by_factor .or. allocated(context%share))) return
      if (stopped) return
      if (context%needs_motion()) then
        call with_design(context%designs, number, motion, error)
        if (.not. allocated(error)) call sweep_design(motion, context%rpm, context%options, design, stopped, error, best, rms)
        if (allocated(error)) return
        ! The criterion of the dynamic transmission error is its root mean square over the speeds.
        do i = 1, merge(0, size(motion), context%by == by_factor)
          associate (known => .not. ieee_is_nan(rms(:, i)))
            if (.not. any(known)) cycle
            design%of_load(i) = sqrt(sum(rms(:, i)**2, mask=known)/count(known))
            design%rpm(i) = context%rpm(maxloc(rms(:, i), 1, mask=known))
          end associate
        end do
      else
        call find_errors(context, number, errors, error, judged_only=.true.)
        if (.not. allocated(error)) call judge_static(context, errors, design)
      end if
      if (allocated(error)) return
      design%number = number
      if (context%by /= by_factor) design%value = design%of_load
      if (allocated(context%share)) design%value = [context%combined(design%of_load)]
    end select
  end subroutine judge

  pure subroutine judge_static(self, errors, design)
    type(judge_t), intent(in) :: self
    type(errors_t), intent(in) :: errors
    type(design_t), intent(inout) :: design

    if (self%by == by_range) design%of_load = errors%range
    if (self%by == by_harmonic) design%of_load = errors%amplitude
    allocate (design%rpm(size(design%of_load)), source=0.0_dp)
    allocate (design%failed(size(design%of_load)), source=0)
  end subroutine judge_static

  !> Computes the static transmission errors of a design; `judged_only`: a harmonic only if it is the criterion, as its integrals
  !> take longer.
  subroutine find_errors(self, number, errors, error, judged_only)
    type(judge_t), intent(in) :: self
    real(dp), intent(in) :: number(:)            !< variables of the design
    type(errors_t), intent(out) :: errors
    type(error_t), allocatable, intent(inout) :: error
    logical, intent(in), optional :: judged_only
    type(oscillator_t), allocatable :: motion(:)
    type(harmonics_t) :: found
    integer :: i

    call with_design(self%designs, number, motion, error)
    if (allocated(error)) return
    if (present(judged_only) .and. self%by == by_range) then
      errors%range = [(static_range(motion(i)%mesh, motion(i)%load), i=1, size(motion))]
      return
    end if
    allocate (errors%range(size(motion)), errors%amplitude(size(motion)))
    do i = 1, size(motion)
      call find_harmonics(motion(i)%mesh, motion(i)%load, self%harmonic, found)
      errors%range(i) = found%peak_to_peak()
      errors%amplitude(i) = found%amplitude(self%harmonic)
    end do
  end subroutine find_errors

  !> Finds the best amount of relief: a scan, then finer scans around the best amount, as the curve has kinks. Amounts are ordered
  !> by the number of speeds that did not converge first.
  subroutine scan_amounts(self, largest, running, curve, error)
    type(judge_t), intent(in) :: self            !< its designs have one variable
    real(dp), intent(in) :: largest              !< largest amount, m; the least is 0
    type(running_t), intent(inout) :: running    !< counter of the operating points
    type(amount_curve_t), intent(out) :: curve
    type(error_t), allocatable, intent(inout) :: error
    integer, parameter :: scan = 16, inner = 6, rounds = 4
    real(dp) :: low, high
    integer :: round, i, n

    n = size(self%designs%of_load)
    allocate (curve%amount(0), curve%of_load(n, 0), curve%rpm(n, 0), curve%failed(n, 0), curve%value(0), curve%errors(0), &
              curve%is_bound(0))
    do i = 0, scan
      call try_amount(largest*i/scan)
    end do
    do round = 1, rounds
      if (allocated(error) .or. curve%stopped .or. curve%best == 0) return
      low = curve%amount(max(1, curve%best - 1))
      high = curve%amount(min(size(curve%amount), curve%best + 1))
      do i = 1, inner
        call try_amount(low + (high - low)*i/(inner + 1.0_dp))
      end do
    end do
    if (curve%best > 0) then
      associate (amount => curve%amount, best => curve%best)
        curve%resolution = max(amount(best) - amount(max(1, best - 1)), amount(min(size(amount), best + 1)) - amount(best))
      end associate
    end if

  contains

    subroutine try_amount(amount)
      real(dp), intent(in) :: amount
      type(design_t) :: design
      type(errors_t) :: errors
      logical, allocatable :: known(:)
      integer, allocatable :: failed(:)
      integer :: at, k, tried

      if (allocated(error) .or. curve%stopped .or. any(abs(curve%amount - amount) <= 1e-12_dp*amount)) return
      call find_errors(self, [amount/largest], errors, error)
      if (allocated(error)) return
      if (self%needs_motion()) then
        call judge(self, [amount/largest], design, curve%stopped, error)
        if (allocated(error) .or. curve%stopped) return
        call running%report_progress(n*size(self%rpm), self%options%accuracy%steady%stop)
      else
        call judge_static(self, errors, design)
        curve%stopped = wants_stop(self%options%accuracy%steady%stop)
      end if
      tried = size(curve%amount) + 1
      at = 1 + count(curve%amount < amount)
      associate (order => [(k, k=1, at - 1), tried, (k, k=at, tried - 1)], loads => size(design%of_load))
        curve%of_load = reshape([curve%of_load, design%of_load], [loads, tried])
        curve%of_load = curve%of_load(:, order)
        curve%rpm = reshape([curve%rpm, design%rpm], [loads, tried])
        curve%rpm = curve%rpm(:, order)
        curve%failed = reshape([curve%failed, design%failed], [loads, tried])
        curve%failed = curve%failed(:, order)
        curve%errors = [curve%errors, errors]
        curve%errors = curve%errors(order)
      end associate
      curve%amount = [curve%amount(:at - 1), amount, curve%amount(at:)]
      curve%value = [curve%value(:at - 1), self%combined(design%of_load), curve%value(at:)]
      curve%is_bound = [curve%is_bound, .false.]
      known = .not. ieee_is_nan(curve%value)
      curve%best = 0
      if (.not. any(known)) return
      failed = sum(curve%failed, 1)
      curve%best = minloc(curve%value, 1, mask=known .and. failed == minval(failed, mask=known))
    end subroutine try_amount
  end subroutine scan_amounts

  !> Curve of a search for the least dynamic factor under one load, between amounts 0 and `largest` (m).
  subroutine curve_of(self, largest, optimum, curve, error)
    type(judge_t), intent(in) :: self
    real(dp), intent(in) :: largest
    type(optimum_t), intent(in) :: optimum
    type(amount_curve_t), intent(out) :: curve
    type(error_t), allocatable, intent(inout) :: error
    integer :: i, n

    n = size(optimum%amount)
    curve%amount = optimum%amount
    curve%of_load = reshape(optimum%dynamic_factor, [1, n])
    curve%rpm = reshape(optimum%rpm, [1, n])
    curve%failed = reshape(optimum%failed, [1, n])
    curve%value = optimum%dynamic_factor
    curve%is_bound = optimum%is_bound
    curve%best = optimum%best
    curve%resolution = optimum%resolution
    curve%stopped = optimum%stopped
    allocate (curve%errors(n))
    do i = 1, n
      if (.not. allocated(error)) call find_errors(self, curve%amount(i:i)/largest, curve%errors(i), error)
    end do
  end subroutine curve_of
end module gearsweep_study_tasks_relief_judge
