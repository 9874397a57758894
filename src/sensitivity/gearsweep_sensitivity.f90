!> How a steady motion changes with a number of its oscillator: derivatives of the dynamic factor and of the harmonics of the
!> dynamic transmission error.
!>
!> A motion with the state u at the begin of the mesh period solves P(u, q) = u, P the map of the mesh periods after which it
!> repeats and q the number. So (1 - M) du/dq = dP/dq (implicit function theorem), where M, the derivative of P by u, has the
!> jumps of the contact events (saltation: see gearsweep_contact_events). What is read off a motion is then differentiated along
!> the tangent (du/dq, 1). Both, P at the state u and what is read off along the tangent, are differences over q of single
!> maps: no motion is solved again, so that a sharp resonance does not matter.
!> Source: Leine, Nijmeijer 2004, Dynamics and Bifurcations of Non-Smooth Mechanical Systems, chapter 7, for the jumps of M.
module gearsweep_sensitivity
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan, ieee_quiet_nan, ieee_value
  use gearsweep_coefficients, only: resolution_t, scheme_collocation
  use gearsweep_difference, only: difference_t, make_difference
  use gearsweep_error, only: error_t
  use gearsweep_error_estimate, only: point_t
  use gearsweep_harmonics, only: find_harmonics, harmonics_t
  use gearsweep_kinds, only: dp
  use gearsweep_motion_reading, only: differentiable_t, nearest_change, read_motion, reading_t
  use gearsweep_oscillator, only: oscillator_t
  use gearsweep_period_map, only: discretise, period_map_t, set_durations
  use gearsweep_periodic_orbit, only: distance, near, newton_step, shoot, steady_t
  use gearsweep_status, only: has_result
  implicit none
  private
  public :: differentiable_t, variation_t, slopes_t, prepare_motion, differentiate_motion, differentiate_static, amplitude_slopes, &
            slope_name

  !> A number of an oscillator, and the oscillators with other values of it.
  type, abstract :: variation_t
    real(dp) :: value = 0
    real(dp) :: scale = 1                        !< a change of it that matters
    real(dp) :: least = -huge(1.0_dp)            !< there is no oscillator below
  contains
    procedure(vary), deferred :: vary
  end type variation_t

  abstract interface
    !> The oscillator with `change` more of the number, and the duration of its mesh period (s).
    subroutine vary(self, change, osc, duration, error)
      import :: dp, error_t, oscillator_t, variation_t
      class(variation_t), intent(in) :: self
      real(dp), intent(in) :: change
      type(oscillator_t), intent(out) :: osc
      real(dp), intent(out) :: duration
      type(error_t), allocatable, intent(out) :: error
    end subroutine vary
  end interface

  !> What there is of a derivative: it exists; it is that to larger numbers, as there are no smaller ones; the largest load
  !> changes its place; a pair that enters or leaves begins or ceases to touch; an overlap within the path does; a multiplier
  !> is 1, and the motion has no derivative; there is no motion, or none beside it.
  integer, parameter, public :: is_smooth = 1, is_least = 2, at_peak = 3, at_contact = 4, at_grazing = 5, at_fold = 6, is_none = 7
  character(*), parameter :: names(7) = [character(8) :: 'smooth', 'least', 'peak', 'contact', 'grazing', 'fold', 'none']

  !> Derivatives by one number, each over that number's unit; NaN where there is none.
  type :: slopes_t
    integer :: kind = is_none
    real(dp) :: dynamic_factor = 0
    real(dp) :: below = 0, above = 0             !< of the dynamic factor, to smaller and to larger numbers
    real(dp) :: estimate = 0                     !< of the error of the dynamic factor's
    real(dp), allocatable :: amplitude(:)        !< of the transmission error's mean and harmonics, m; (0:harmonics)
    real(dp), allocatable :: amplitude_estimate(:)         !< of their errors, m; (0:harmonics)
  end type slopes_t

  !> Derivatives in the steps of one level.
  type :: trial_t
    logical :: refused = .false.                 !< there is no oscillator so near
    logical :: alike = .true.                    !< contact changes in the same order all around
    logical :: solved = .true.                   !< M has no multiplier of 1
    logical :: one_sided = .false.               !< there is no oscillator below
    real(dp), allocatable :: slope(:), doubt(:)  !< of what is read, and how far it is uncertain by the differences
    real(dp) :: below = 0, above = 0
    real(dp) :: change = 0                       !< of the number, which the differences take
  end type trial_t

  !> Around a motion the number changes by so much of what changes the map much, and the state by so much of a deflection.
  real(dp), parameter :: closeness = 5e-3_dp
  integer, parameter :: coarse = 1, fine = 2

contains

  !> The word that stands for a kind in tables.
  elemental character(8) function slope_name(kind)
    integer, intent(in) :: kind

    slope_name = names(kind)
  end function slope_name

  !> A motion in steps of 0.1 rad of the natural motion, and in half as many; below some speed, in four times and twice those of
  !> its operating point.
  subroutine prepare_motion(osc, duration, point, harmonics, motion)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration             !< of the mesh period, s
    type(point_t), intent(in) :: point           !< the motion
    integer, intent(in) :: harmonics             !< of the mesh frequency
    type(differentiable_t), intent(out) :: motion  !< not `found` where it has no result, or the memory does not hold it
    type(period_map_t) :: map
    type(steady_t) :: steady
    integer :: level

    motion%osc = osc
    motion%duration = duration
    motion%harmonics = harmonics
    motion%periods = point%steady%periods
    motion%found = has_result(point%steady%status)
    if (motion%found) call choose_steps(osc, duration, point, motion)
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

  !> All intervals are shorter than a share, so that the number of their steps hardly depends on their lengths: nothing jumps where
  !> breaks move, but for one that passes a half, a quarter ... of the mesh period.
  pure subroutine choose_steps(osc, duration, point, motion)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration
    type(point_t), intent(in) :: point
    type(differentiable_t), intent(inout) :: motion
    real(dp), parameter :: angle = 0.1_dp, fewest = 48, most = 2.0_dp**15
    real(dp) :: steps

    steps = max(fewest, max(osc%natural_frequency, osc%highest_frequency*max(0.5_dp, osc%damping_ratio))*duration/angle)/2
    if (2*steps*size(osc%intervals) <= most) then
      motion%resolution = [resolution_t(1.0_dp, ceiling(steps)), resolution_t(1.0_dp, 2*ceiling(steps))]
    else
      motion%resolution = point%resolution
      motion%resolution%times = motion%resolution%times*[2, 4]
      motion%found = point%resolution%scheme == scheme_collocation
    end if
  end subroutine choose_steps

  !> Derivatives by a number. Around the motion the number changes less and less, while contact changes in another order there, the
  !> derivatives to both sides differ, or the differences are uncertain.
  subroutine differentiate_motion(motion, variation, slopes)
    type(differentiable_t), intent(in) :: motion
    class(variation_t), intent(in) :: variation
    type(slopes_t), intent(out) :: slopes
    integer, parameter :: most = 5
    real(dp), parameter :: exact = 1e-7_dp
    type(trial_t) :: trial, best
    real(dp) :: change, changed
    integer :: attempt

    call no_slopes(motion%harmonics, slopes)
    if (.not. motion%found) return
    changed = 0
    change = closeness*variation%scale/(1 + motion%osc%natural_frequency*motion%duration*motion%periods)
    do attempt = 1, most
      call try_change(motion, fine, variation, change, trial)
      if (is_kept(trial)) then
        changed = change
        best = trial
        if (trial%doubt(1) <= exact*abs(trial%slope(1)) + unimportant(motion, variation)) exit
      end if
      change = change/8
    end do
    if (changed > 0) then
      slopes%kind = merge(is_least, is_smooth, best%one_sided)
      call try_change(motion, coarse, variation, changed, trial)
      call conclude(motion, best, trial, slopes)
    else
      call explain(motion, trial, slopes)
    end if

  contains

    !> Are these derivatives, as far as they tell, and better than those known so far?
    logical function is_kept(trial)
      type(trial_t), intent(in) :: trial
      real(dp), parameter :: same = 1e-4_dp

      is_kept = trial%alike .and. trial%solved .and. .not. trial%refused
      if (is_kept .and. .not. ieee_is_nan(trial%below)) is_kept = &
        abs(trial%above - trial%below) <= same*(abs(trial%above) + abs(trial%below)) + 10*unimportant(motion, variation)
      if (is_kept .and. changed > 0) is_kept = trial%doubt(1) < best%doubt(1)
    end function is_kept
  end subroutine differentiate_motion

  !> A derivative of the dynamic factor by which nobody would notice a change of the number.
  pure real(dp) function unimportant(motion, variation)
    type(differentiable_t), intent(in) :: motion
    class(variation_t), intent(in) :: variation

    unimportant = 1e-9_dp*motion%reading(fine)%value(1)/variation%scale
  end function unimportant

  pure subroutine no_slopes(harmonics, slopes)
    integer, intent(in) :: harmonics
    type(slopes_t), intent(out) :: slopes
    real(dp) :: nan

    nan = ieee_value(1.0_dp, ieee_quiet_nan)
    slopes = slopes_t(is_none, nan, nan, nan, nan)
    allocate (slopes%amplitude(0:harmonics), slopes%amplitude_estimate(0:harmonics), source=nan)
  end subroutine no_slopes

  !> Derivatives by differences over a change of the number.
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

  !> What is read off the motions from given states with other values of the number.
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

  !> The derivatives in fine steps, and what half of the steps, the differences and rounding leave open: a tenth of the difference
  !> between the steps, six times what the sixth order would do.
  pure subroutine conclude(motion, best, rough, slopes)
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
  end subroutine conclude

  !> From the mean and the cosine and sine parts of harmonics, (mean, both parts of the first, of the second ...), to their
  !> amplitudes. One that is 0 has no derivative.
  pure subroutine amplitude_slopes(value, slope, estimate, slopes)
    real(dp), intent(in) :: value(:), slope(:)   !< m, and their derivatives
    real(dp), intent(in) :: estimate(:)          !< of the derivatives' errors
    type(slopes_t), intent(inout) :: slopes      !< with room for the harmonics
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
        ! NaN where it is not known: `norm2` compares.
        slopes%amplitude_estimate(k) = sqrt(sum(estimate(2*k:2*k + 1)**2))
      end associate
    end do
  end subroutine amplitude_slopes

  !> Why there is no derivative however near.
  subroutine explain(motion, trial, slopes)
    type(differentiable_t), intent(in) :: motion
    type(trial_t), intent(in) :: trial           ! the nearest
    type(slopes_t), intent(inout) :: slopes
    logical :: at_break

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
  end subroutine explain

  !> Derivatives of the static transmission error's mean and harmonics; those of the dynamic factor are left out.
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
end module gearsweep_sensitivity
