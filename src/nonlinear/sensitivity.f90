!> Derivatives of the dynamic factor and of transmission error harmonics by a number of the oscillator.
!>
!> A motion with the state u at the start of the mesh period solves P(u, q) = u, where P is the map of the mesh periods after which
!> the motion repeats and q the number. Hence (1 - M) du/dq = dP/dq (implicit function theorem), where M, the derivative of P by u,
!> has the jumps of the contact events (saltation: see gearsweep_motion_contact_events). The results are then differentiated along
!> the tangent (du/dq, 1). P at the state u and the results along the tangent are differentiated by differences of single maps over
!> q: no steady motion is solved again, so that a sharp resonance causes no difficulty.
!> Source: Leine, Nijmeijer 2004, Dynamics and Bifurcations of Non-Smooth Mechanical Systems, chapter 7, for the jumps of M.
!>
!> Differences are of sixth order over seven places, and of fifth or fourth order over fewer.
!> Source: Fornberg 1988, Generation of finite difference formulas on arbitrarily spaced grids.
module gearsweep_nonlinear_sensitivity
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan, ieee_quiet_nan, ieee_value
  use gearsweep_base, only: dp, error_t, gauss_legendre, pi, quintic, value_of
  use gearsweep_mesh, only: find_harmonics, harmonics_t
  use gearsweep_motion, only: discretise, distance, has_result, near, newton_step, oscillator_t, period_map_t, period_t, point_t, &
    resolution_t, run_period, scheme_collocation, set_durations, shoot, steady_t, trace_t
  implicit none
  private
  public :: difference_t, make_difference, differentiable_t, variation_t, slopes_t, prepare_motion, differentiate_motion, &
            differentiate_static, amplitude_slopes, slope_names

  !> Stencil of seven points: three on each side of the centre or, without smaller values, six above it.
  type :: difference_t
    logical :: one_sided = .false.
    real(dp) :: step = 1
    real(dp) :: offset(0:6) = 0                  !< offsets of the points from the centre, which is the first
  contains
    procedure :: slope, rougher_slope, slope_below, slope_above
  end type difference_t

  !> Stencil offsets in steps: central (0, 1, 2, 3, -1, -2, -3) and forward (0 to 6).
  real(dp), parameter :: central(0:6) = [0, 45, -9, 1, -45, 9, -1]/60.0_dp, &
    central_rough(0:6) = [0, 8, -1, 0, -8, 1, 0]/12.0_dp, &
    ahead(0:6) = [-147, 360, -450, 400, -225, 72, -10]/60.0_dp, &
    ahead_rough(0:6) = [-137, 300, -300, 200, -75, 12, 0]/60.0_dp, &
    one_side(0:3) = [-11, 18, -9, 2]/6.0_dp

  type :: reading_t
    logical :: found = .false.                   !< true unless contact changes too often or memory is short
    real(dp) :: state(2) = 0                     !< state after the mesh periods, m
    real(dp) :: monodromy(2, 2) = 0              !< its derivative by the state before them
    !> Checksum of the contact sets in their order: different sequences most likely differ in it.
    integer :: contacts = 0
    !> Dynamic factor; mean of the transmission error; cosine and sine part of each harmonic, m.
    real(dp), allocatable :: value(:)
  end type reading_t

  !> A motion, in coarse and in fine steps.
  type :: differentiable_t
    type(oscillator_t) :: osc
    real(dp) :: duration = 0                     !< mesh period, s
    integer :: periods = 1                       !< mesh periods until it repeats
    integer :: harmonics = 0                     !< number of mesh harmonics
    logical :: found = .false.
    type(resolution_t) :: resolution(2)
    real(dp) :: start(2, 2) = 0                  !< state at the start, m; (state, level)
    type(reading_t) :: reading(2)
  end type differentiable_t

  !> A number of an oscillator, and the oscillators with other values of it.
  type, abstract :: variation_t
    real(dp) :: value = 0
    real(dp) :: scale = 1                        !< typical change of the number
    real(dp) :: least = -huge(1.0_dp)            !< least value for which an oscillator exists
  contains
    procedure(vary), deferred :: vary
  end type variation_t

  abstract interface
    !> Builds the oscillator with the number increased by `change`, and returns its mesh period (s).
    subroutine vary(self, change, osc, duration, error)
      import :: dp, error_t, oscillator_t, variation_t
      class(variation_t), intent(in) :: self
      real(dp), intent(in) :: change
      type(oscillator_t), intent(out) :: osc
      real(dp), intent(out) :: duration
      type(error_t), allocatable, intent(out) :: error
    end subroutine vary
  end interface

  !> Kinds of a derivative: smooth; one-sided, towards larger numbers, as there are no smaller ones; the largest load changes its
  !> place; contact begins or ends where a pair enters or leaves; or within the path (grazing); a multiplier is 1, and the motion
  !> has no derivative (fold); there is no motion, or none nearby.
  integer, parameter, public :: is_smooth = 1, is_least = 2, at_peak = 3, at_contact = 4, at_grazing = 5, at_fold = 6, is_none = 7
  character(*), parameter :: slope_names(7) = [character(8) :: 'smooth', 'least', 'peak', 'contact', 'grazing', 'fold', 'none']

  !> Derivatives by one number, per unit of it; NaN for none.
  type :: slopes_t
    integer :: kind = is_none
    real(dp) :: dynamic_factor = 0
    real(dp) :: below = 0, above = 0             !< of the dynamic factor, towards smaller and larger numbers
    real(dp) :: estimate = 0                     !< error estimate of the derivative of the dynamic factor
    real(dp), allocatable :: amplitude(:)        !< derivatives of the transmission error's mean and harmonics, m; (0:harmonics)
    real(dp), allocatable :: amplitude_estimate(:)         !< error estimates of these, m; (0:harmonics)
  end type slopes_t

  !> Derivatives with the steps of one level.
  type :: trial_t
    logical :: refused = .false.                 !< true if there is no oscillator with a value so near
    logical :: alike = .true.                    !< true if contact changes in the same order at all points
    logical :: solved = .true.                   !< true if M has no multiplier of 1
    logical :: one_sided = .false.               !< true if there is no oscillator with a smaller value
    real(dp), allocatable :: slope(:), doubt(:)  !< derivatives of the results, and their uncertainty by the differences
    real(dp) :: below = 0, above = 0
    real(dp) :: change = 0                       !< change of the number in the differences
  end type trial_t

  !> Relative change in the differences: of the number over its typical change, and of the state over the deflection.
  real(dp), parameter :: closeness = 5e-3_dp
  integer, parameter :: coarse = 1, fine = 2

contains

  !> Builds differences around `value` with `step` between the points.
  pure type(difference_t) function make_difference(value, least, step) result(difference)
    real(dp), intent(in) :: value, least         !< least value of the function's argument
    real(dp), intent(in) :: step
    integer :: i

    difference%step = step
    difference%one_sided = value - 3*step < least
    difference%offset = step*[0, 1, 2, 3, -1, -2, -3]
    if (difference%one_sided) difference%offset = step*[(i, i=0, 6)]
  end function make_difference

  pure real(dp) function slope(self, value)
    class(difference_t), intent(in) :: self
    real(dp), intent(in) :: value(0:6)           !< values of the function, at `offset`

    slope = dot_product(merge(ahead, central, self%one_sided), value)/self%step
  end function slope

  !> Slope from fewer points: its difference to the full stencil shows the uncertainty.
  pure real(dp) function rougher_slope(self, value) result(slope)
    class(difference_t), intent(in) :: self
    real(dp), intent(in) :: value(0:6)

    slope = dot_product(merge(ahead_rough, central_rough, self%one_sided), value)/self%step
  end function rougher_slope

  !> Slope from the points below only; NaN if there are none.
  pure real(dp) function slope_below(self, value) result(slope)
    class(difference_t), intent(in) :: self
    real(dp), intent(in) :: value(0:6)

    slope = ieee_value(1.0_dp, ieee_quiet_nan)
    if (.not. self%one_sided) slope = -dot_product(one_side, [value(0), value(4:)])/self%step
  end function slope_below

  !> Slope from the points above only.
  pure real(dp) function slope_above(self, value) result(slope)
    class(difference_t), intent(in) :: self
    real(dp), intent(in) :: value(0:6)

    slope = dot_product(one_side, value(:3))/self%step
    if (self%one_sided) slope = self%slope(value)
  end function slope_above

  !> Computes the motion from a state, with the mesh periods, harmonics and steps of another one.
  subroutine read_motion(motion, level, osc, duration, start, map, reading)
    type(differentiable_t), intent(in) :: motion
    integer, intent(in) :: level                 !< level of the steps
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration             !< mesh period, s
    real(dp), intent(in) :: start(2)             !< initial state, m
    type(period_map_t), intent(inout) :: map     !< reused for its memory
    type(reading_t), intent(out) :: reading
    type(trace_t) :: trace
    type(period_t) :: run
    real(dp) :: peak, sums(2*motion%harmonics + 1)
    integer :: i, k, last
    integer, parameter :: many = 1000003

    call discretise(osc, motion%resolution(level), map)
    if (map%steps == 0) return
    call set_durations(map, [duration])
    reading%state = start
    reading%monodromy = reshape([1.0_dp, 0.0_dp, 0.0_dp, 1.0_dp], [2, 2])
    peak = 0
    sums = 0
    do i = 1, motion%periods
      trace%rows = 0
      call run_period(map, reading%state, run, trace)
      if (run%failed) return
      reading%state = run%state
      reading%monodromy = matmul(run%monodromy, reading%monodromy)
      peak = max(peak, run%peak)
      ! Checksum of the contact sets in their order.
      last = -1
      do k = 1, trace%rows
        if (trace%contact_set(k) == last) cycle
        last = trace%contact_set(k)
        reading%contacts = modulo(31*reading%contacts + last + 1, many)
      end do
      call add_harmonics(trace, motion%harmonics, sums)
    end do
    reading%found = all(abs(reading%state) < huge(1.0_dp))
    reading%value = [peak/osc%load, sums/motion%periods]
  end subroutine read_motion

  !> Adds a mesh period's integrals of the transmission error x: of x, 2 x cos(2 pi k tau) and -2 x sin(2 pi k tau), so that the
  !> amplitude's phase is that of gearsweep_motion_spectrum. Gauss's rule is accurate for steps much shorter than a cycle.
  pure subroutine add_harmonics(trace, harmonics, sums)
    type(trace_t), intent(in) :: trace
    integer, intent(in) :: harmonics
    real(dp), intent(inout) :: sums(:)
    integer, parameter :: points = 8
    real(dp) :: node(points), weight(points), c(0:5), x
    complex(dp) :: turn, term
    integer :: i, k, row

    call gauss_legendre(node, weight)
    do row = 1, trace%rows, 2
      c = quintic(trace%x(:, row), trace%x(:, row + 1))
      associate (width => trace%phase(row + 1) - trace%phase(row))
        do i = 1, points
          x = value_of(c, (1 + node(i))/2)*width*weight(i)/2
          sums(1) = sums(1) + x
          turn = exp(cmplx(0.0_dp, -2*pi*(trace%phase(row) + width*(1 + node(i))/2), dp))
          term = 2*x
          do k = 1, harmonics
            term = term*turn
            sums(2*k:2*k + 1) = sums(2*k:2*k + 1) + [real(term, dp), aimag(term)]
          end do
        end do
      end associate
    end do
  end subroutine add_harmonics

  !> True if the smallest overlap that decides on contact is at a break, where a pair enters or leaves.
  subroutine nearest_change(motion, level, at_break)
    type(differentiable_t), intent(in) :: motion
    integer, intent(in) :: level
    logical, intent(out) :: at_break
    type(period_map_t) :: map
    type(trace_t) :: trace
    type(period_t) :: run
    real(dp) :: state(2), nearest
    integer :: i, k

    call discretise(motion%osc, motion%resolution(level), map)
    call set_durations(map, [motion%duration])
    allocate (trace%overlaps)
    state = motion%start(:, level)
    at_break = .false.
    nearest = huge(nearest)
    do i = 1, motion%periods
      trace%rows = 0
      trace%overlaps%count = 0
      call run_period(map, state, run, trace)
      state = run%state
      do k = 1, trace%overlaps%count
        associate (overlap => trace%overlaps%list(k))
          if (abs(overlap%value) >= nearest) cycle
          nearest = abs(overlap%value)
          at_break = overlap%at_break
        end associate
      end do
    end do
  end subroutine nearest_change

  !> Prepares a motion in steps of 0.1 rad of the natural motion, and in half as many; below some speed, in four times and twice the
  !> steps of its operating point.
  subroutine prepare_motion(osc, duration, point, harmonics, motion)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration             !< mesh period, s
    type(point_t), intent(in) :: point           !< operating point of the motion
    integer, intent(in) :: harmonics             !< number of mesh harmonics
    type(differentiable_t), intent(out) :: motion  !< not `found` if the point did not converge or memory is short
    type(period_map_t) :: map
    type(steady_t) :: steady
    integer :: level
    real(dp), parameter :: angle = 0.1_dp, fewest = 48, most = 2.0_dp**15
    real(dp) :: steps

    motion%osc = osc
    motion%duration = duration
    motion%harmonics = harmonics
    motion%periods = point%steady%periods
    motion%found = has_result(point%steady%status)
    if (motion%found) then
      ! All intervals are shorter than a share, so that the number of their steps hardly depends on their lengths: no step number
      ! jumps where breaks move, except where an interval passes a half, a quarter ... of the mesh period.
      steps = max(fewest, max(osc%natural_frequency, osc%highest_frequency*max(0.5_dp, osc%damping_ratio))*duration/angle)/2
      if (2*steps*size(osc%intervals) <= most) then
        motion%resolution = [resolution_t(1.0_dp, ceiling(steps)), resolution_t(1.0_dp, 2*ceiling(steps))]
      else
        motion%resolution = point%resolution
        motion%resolution%times = motion%resolution%times*[2, 4]
        motion%found = point%resolution%scheme == scheme_collocation
      end if
    end if
    do level = coarse, fine
      if (.not. motion%found) return
      call discretise(osc, motion%resolution(level), map)
      motion%found = map%steps > 0
      if (.not. motion%found) return
      call set_durations(map, [duration])
      call shoot(map, 1e-9_dp, motion%periods, point%steady%state, steady)
      motion%found = has_result(steady%status) .and. distance(osc, duration, steady%state - point%steady%state) < near
      motion%start(:, level) = steady%state
      if (motion%found) call read_motion(motion, level, osc, duration, steady%state, map, motion%reading(level))
      motion%found = motion%found .and. motion%reading(level)%found
    end do
  end subroutine prepare_motion

  !> Differentiates a motion by a number. The change of the number is reduced while contact changes in another order at some point,
  !> the derivatives to both sides differ, or the differences are uncertain.
  subroutine differentiate_motion(motion, variation, slopes)
    type(differentiable_t), intent(in) :: motion
    class(variation_t), intent(in) :: variation
    type(slopes_t), intent(out) :: slopes
    integer, parameter :: most = 5
    real(dp), parameter :: exact = 1e-7_dp
    type(trial_t) :: trial, best
    real(dp) :: change, changed, unimportant
    integer :: attempt
    logical :: at_break

    call no_slopes(motion%harmonics, slopes)
    if (.not. motion%found) return
    ! Derivative of the dynamic factor below which a change of the number has no noticeable effect.
    unimportant = 1e-9_dp*motion%reading(fine)%value(1)/variation%scale
    changed = 0
    change = closeness*variation%scale/(1 + motion%osc%natural_frequency*motion%duration*motion%periods)
    do attempt = 1, most
      call try_change(motion, fine, variation, change, trial)
      if (is_kept(trial)) then
        changed = change
        best = trial
        if (trial%doubt(1) <= exact*abs(trial%slope(1)) + unimportant) exit
      end if
      change = change/8
    end do
    if (changed > 0) then
      slopes%kind = merge(is_least, is_smooth, best%one_sided)
      call try_change(motion, coarse, variation, changed, trial)
      call store_slopes(motion, best, trial, slopes)
    else
      ! The reason why there is no derivative even for the smallest change.
      if (trial%refused) return
      if (.not. trial%alike) then
        call nearest_change(motion, fine, at_break)
        slopes%kind = merge(at_contact, at_grazing, at_break)
      else if (.not. trial%solved) then
        slopes%kind = at_fold
      else
        slopes%kind = at_peak
        slopes%below = trial%below
        slopes%above = trial%above
      end if
    end if

  contains

    !> True if these derivatives are valid as far as can be seen, and better than the previous ones.
    logical function is_kept(trial)
      type(trial_t), intent(in) :: trial
      real(dp), parameter :: same = 1e-4_dp

      is_kept = trial%alike .and. trial%solved .and. .not. trial%refused
      if (is_kept .and. .not. ieee_is_nan(trial%below)) is_kept = &
        abs(trial%above - trial%below) <= same*(abs(trial%above) + abs(trial%below)) + 10*unimportant
      if (is_kept .and. changed > 0) is_kept = trial%doubt(1) < best%doubt(1)
    end function is_kept
  end subroutine differentiate_motion

  pure subroutine no_slopes(harmonics, slopes)
    integer, intent(in) :: harmonics
    type(slopes_t), intent(out) :: slopes
    real(dp) :: nan

    nan = ieee_value(1.0_dp, ieee_quiet_nan)
    slopes = slopes_t(is_none, nan, nan, nan, nan)
    allocate (slopes%amplitude(0:harmonics), slopes%amplitude_estimate(0:harmonics), source=nan)
  end subroutine no_slopes

  !> Differentiates by differences over a change of the number.
  subroutine try_change(motion, level, variation, change, trial)
    type(differentiable_t), intent(in) :: motion
    integer, intent(in) :: level
    class(variation_t), intent(in) :: variation
    real(dp), intent(in) :: change
    type(trial_t), intent(out) :: trial
    type(difference_t) :: difference
    type(period_map_t) :: map
    type(reading_t), allocatable :: reading(:)
    real(dp) :: by_number(2), tangent(2), smaller, around(2, 0:6)
    integer :: i

    difference = make_difference(variation%value, variation%least, change)
    around = spread(motion%start(:, level), 2, 7)
    call read_around(motion, level, variation, difference, around, map, reading, trial)
    if (trial%refused .or. .not. trial%alike) return
    do i = 1, 2
      by_number(i) = difference%slope([motion%reading(level)%state(i), reading%state(i)])
    end do
    call newton_step(motion%reading(level)%monodromy, by_number, tangent, trial%solved)
    if (.not. trial%solved) return
    smaller = min(change, closeness/max(distance(motion%osc, motion%duration, tangent), tiny(1.0_dp)))
    difference = make_difference(variation%value, variation%least, smaller)
    trial%change = smaller
    trial%one_sided = difference%one_sided
    do i = 0, 6
      around(:, i) = motion%start(:, level) + difference%offset(i)*tangent
    end do
    call read_around(motion, level, variation, difference, around, map, reading, trial)
    if (trial%refused .or. .not. trial%alike) return
    associate (n => size(motion%reading(level)%value))
      allocate (trial%slope(n), trial%doubt(n))
      do i = 1, n
        call take_slope(i)
      end do
    end associate

  contains

    subroutine take_slope(i)
      integer, intent(in) :: i
      real(dp) :: value(0:6)
      integer :: k

      value(0) = motion%reading(level)%value(i)
      do k = 1, 6
        value(k) = reading(k)%value(i)
      end do
      trial%slope(i) = difference%slope(value)
      trial%doubt(i) = abs(trial%slope(i) - difference%rougher_slope(value))
      if (i == 1) trial%below = difference%slope_below(value)
      if (i == 1) trial%above = difference%slope_above(value)
    end subroutine take_slope
  end subroutine try_change

  !> Computes the results of the motions from given states with other values of the number.
  subroutine read_around(motion, level, variation, difference, around, map, reading, trial)
    type(differentiable_t), intent(in) :: motion
    integer, intent(in) :: level
    class(variation_t), intent(in) :: variation
    type(difference_t), intent(in) :: difference
    real(dp), intent(in) :: around(2, 0:6)       ! states, m
    type(period_map_t), intent(inout) :: map
    type(reading_t), allocatable, intent(out) :: reading(:)
    type(trial_t), intent(inout) :: trial
    type(oscillator_t) :: osc
    type(error_t), allocatable :: error
    real(dp) :: duration
    integer :: i

    allocate (reading(6))
    do i = 1, 6
      call variation%vary(difference%offset(i), osc, duration, error)
      trial%refused = allocated(error)
      if (trial%refused) return
      call read_motion(motion, level, osc, duration, around(:, i), map, reading(i))
      trial%alike = reading(i)%found
      if (trial%alike) trial%alike = reading(i)%contacts == motion%reading(level)%contacts
      if (.not. trial%alike) return
    end do
  end subroutine read_around

  !> Stores the derivatives in fine steps and their error estimates from steps, differences and rounding: a tenth of the difference
  !> between the steps, six times the value for the sixth order.
  pure subroutine store_slopes(motion, best, rough, slopes)
    type(differentiable_t), intent(in) :: motion
    type(trial_t), intent(in) :: best, rough
    type(slopes_t), intent(inout) :: slopes
    real(dp), parameter :: rounding = 10*epsilon(1.0_dp)
    real(dp) :: estimate(size(best%slope))

    estimate = ieee_value(1.0_dp, ieee_quiet_nan)
    if (allocated(rough%slope)) then
      estimate = best%doubt + abs(best%slope - rough%slope)/10
      associate (value => motion%reading(fine)%value)
        estimate(1) = estimate(1) + rounding/best%change*abs(value(1))
        estimate(2:) = estimate(2:) + rounding/best%change*maxval(abs(value(2:)))
      end associate
    end if
    slopes%dynamic_factor = best%slope(1)
    slopes%below = best%below
    slopes%above = best%above
    slopes%estimate = estimate(1)
    call amplitude_slopes(motion%reading(fine)%value(2:), best%slope(2:), estimate(2:), slopes)
  end subroutine store_slopes

  !> Computes derivatives of amplitudes from the mean and the cosine and sine parts of harmonics, (mean, both parts of the first, of
  !> the second ...). An amplitude of 0 has no derivative.
  pure subroutine amplitude_slopes(value, slope, estimate, slopes)
    real(dp), intent(in) :: value(:), slope(:)   !< values, m, and their derivatives
    real(dp), intent(in) :: estimate(:)          !< error estimates of the derivatives
    type(slopes_t), intent(inout) :: slopes      !< allocated for the harmonics
    real(dp), parameter :: nothing = 1e-12_dp
    real(dp) :: amplitude
    integer :: k

    slopes%amplitude(0) = slope(1)
    slopes%amplitude_estimate(0) = estimate(1)
    do k = 1, ubound(slopes%amplitude, 1)
      associate (part => value(2*k:2*k + 1))
        amplitude = norm2(part)
        if (.not. amplitude > nothing*abs(value(1))) cycle
        slopes%amplitude(k) = dot_product(part, slope(2*k:2*k + 1))/amplitude
        ! NaN if it is not known: `norm2` compares.
        slopes%amplitude_estimate(k) = sqrt(sum(estimate(2*k:2*k + 1)**2))
      end associate
    end do
  end subroutine amplitude_slopes

  !> Differentiates the static transmission error's mean and harmonics; the derivatives of the dynamic factor are not set.
  subroutine differentiate_static(variation, harmonics, slopes)
    class(variation_t), intent(in) :: variation
    integer, intent(in) :: harmonics
    type(slopes_t), intent(out) :: slopes
    type(difference_t) :: difference
    type(harmonics_t) :: ste
    type(oscillator_t) :: osc
    type(error_t), allocatable :: error
    real(dp), dimension(0:6, 2*harmonics + 1) :: value
    real(dp), dimension(2*harmonics + 1) :: slope, doubt
    real(dp) :: duration
    integer :: i, k

    call no_slopes(harmonics, slopes)
    difference = make_difference(variation%value, variation%least, closeness*variation%scale)
    do i = 0, 6
      call variation%vary(difference%offset(i), osc, duration, error)
      if (allocated(error)) return
      call find_harmonics(osc%mesh, osc%load, harmonics, ste)
      value(i, 1) = ste%mean
      value(i, 2::2) = ste%amplitude*cos(ste%phase)
      value(i, 3::2) = ste%amplitude*sin(ste%phase)
    end do
    do k = 1, size(slope)
      slope(k) = difference%slope(value(:, k))
      doubt(k) = abs(slope(k) - difference%rougher_slope(value(:, k)))
    end do
    slopes%kind = merge(is_least, is_smooth, difference%one_sided)
    call amplitude_slopes([value(0, :)], slope, doubt, slopes)
  end subroutine differentiate_static
end module gearsweep_nonlinear_sensitivity
