!> Largest load on one pair, also between the ends of steps.
!>
!> Most maxima within steps are too low to matter. So the steps only note candidates with an upper bound, and at the end the
!> maxima are computed whose bound is still above the largest load found.
module gearsweep_motion_load_peaks
  use gearsweep_base, only: dp, maximum_of, over_part, quintic, value_of
  use gearsweep_motion_coefficients, only: coefficients_t, need_law
  use gearsweep_motion_contact_law, only: find_law_of_pair, product_of
  use gearsweep_motion_oscillator, only: acceleration, oscillator_t
  implicit none
  private
  public :: candidate_t, candidates_t, add_candidate, evaluate_candidates, may_exceed, raise_to_maximum, cubic_curvature, &
            motion_over_step, load_over, in_part, curve_over, turns_too_far

  !> Step within which the load of a pair has a maximum.
  type :: candidate_t
    real(dp) :: bound                  !< upper bound of the maximum, N
    real(dp) :: x(2), y(2)             !< state at both ends of the step, m
    integer :: step, pair, contact_set
  end type candidate_t

  integer, parameter :: most_candidates = 16
  type :: candidates_t
    integer :: count
    type(candidate_t) :: candidate(most_candidates)
  end type candidates_t

contains

  !> Adds a candidate. If there is no room, candidates with a bound below the largest load are dropped, or all are evaluated.
  pure subroutine add_candidate(osc, table, duration, candidate, candidates, peak)
    type(oscillator_t), intent(in) :: osc
    type(coefficients_t), intent(inout) :: table   !< in: its laws
    real(dp), intent(in) :: duration               !< duration of the mesh period, s
    type(candidate_t), intent(in) :: candidate
    type(candidates_t), intent(inout) :: candidates
    real(dp), intent(inout) :: peak                !< largest load so far, N
    integer :: k, kept

    if (candidates%count == most_candidates) then
      kept = 0
      do k = 1, most_candidates
        if (candidates%candidate(k)%bound <= peak) cycle
        kept = kept + 1
        candidates%candidate(kept) = candidates%candidate(k)
      end do
      candidates%count = kept
      if (kept == most_candidates) call evaluate_candidates(osc, table, duration, candidates, peak)
    end if
    candidates%count = candidates%count + 1
    candidates%candidate(candidates%count) = candidate
  end subroutine add_candidate

  !> Raises the largest load by all candidates; the one with the highest bound first, which makes most others unnecessary.
  pure subroutine evaluate_candidates(osc, table, duration, candidates, peak)
    type(oscillator_t), intent(in) :: osc
    type(coefficients_t), intent(inout) :: table
    real(dp), intent(in) :: duration               !< duration of the mesh period, s
    type(candidates_t), intent(inout) :: candidates    !< out: empty
    real(dp), intent(inout) :: peak                !< largest load so far, N
    integer :: k

    do while (candidates%count > 0)
      k = maxloc(candidates%candidate(:candidates%count)%bound, 1)
      if (candidates%candidate(k)%bound > peak) call refine_maximum(osc, table, duration, candidates%candidate(k), peak)
      candidates%candidate(k) = candidates%candidate(candidates%count)
      candidates%count = candidates%count - 1
    end do
  end subroutine evaluate_candidates

  !> Raises the largest load by the maximum within the step of a candidate.
  pure subroutine refine_maximum(osc, table, duration, candidate, peak)
    type(oscillator_t), intent(in) :: osc
    type(coefficients_t), intent(inout) :: table
    real(dp), intent(in) :: duration
    type(candidate_t), intent(in) :: candidate
    real(dp), intent(inout) :: peak
    real(dp) :: state(2, 2)
    real(dp), dimension(0:2, 2) :: x, load
    integer :: law

    associate (j => candidate%pair, step => candidate%step)
      call need_law(osc, step, candidate%contact_set, table, law)
      state(1, :) = candidate%x
      state(2, :) = candidate%y
      call motion_over_step(osc, table, step, law, duration, state, x)
      call load_over(table, step, law, j, [0.0_dp, 1.0_dp], x, load)
      if (may_exceed(load, peak)) peak = max(peak, largest_within(osc, table, step, law, j, x, load))
    end associate
  end subroutine refine_maximum

  !> Computes the deflection at both ends of a step with its derivatives over it, m; (derivative, end).
  pure subroutine motion_over_step(osc, table, step, law, duration, state, motion)
    type(oscillator_t), intent(in) :: osc
    type(coefficients_t), intent(in) :: table
    integer, intent(in) :: step
    integer, intent(in) :: law                     !< index of the law of its contact set
    real(dp), intent(in) :: duration               !< duration of the mesh period, s
    real(dp), intent(in) :: state(2, 2)            !< x and its derivative over the phase (m) at both ends; (x or y, end)
    real(dp), intent(out) :: motion(0:2, 2)
    integer :: end

    associate (width => table%width(step), p => table%pairs(step))
      motion(0, :) = state(1, :)
      motion(1, :) = width*state(2, :)
      if (turns_too_far(duration*width*sqrt(maxval(sum(table%end_stiffness(0, :p, :, step)*table%end_mobility(:p, :, step), &
                                                        1))))) then
        motion(2, :) = cubic_curvature(state(1, :), width*state(2, :))
      else
        do end = 1, 2
          motion(2, end) = width**2*acceleration(osc, table%end_omega_squared(0, end, law), table%end_forcing(0, end, law), &
                                                 duration, state(1, end), state(2, end))
        end do
      end if
    end associate
  end subroutine motion_over_step

  !> Computes the load of a contact at both ends of a part of a step with its derivatives over the part, N; (derivative, end). The
  !> load of the coast sides is negative.
  pure subroutine load_over(table, step, law, j, places, motion, load)
    type(coefficients_t), intent(in) :: table
    integer, intent(in) :: step
    integer, intent(in) :: law                     !< index of the law of its contact set
    integer, intent(in) :: j                       !< index of the contact
    real(dp), intent(in) :: places(2)              !< start and end of the part, 0 to 1 over the step
    real(dp), intent(in) :: motion(0:2, 2)         !< deflection there with its derivatives over the part, m; (derivative, end)
    real(dp), intent(out) :: load(0:2, 2)
    real(dp), dimension(0:2, 2) :: effective, gap
    integer :: end

    effective = in_part(table%effective(:, j, :, law), table%width(step), places)
    gap = motion - in_part(table%touching(:, j, :, law), table%width(step), places)
    do end = 1, 2
      load(:, end) = product_of(effective(:, end), gap(:, end))
    end do
  end subroutine load_over

  !> Value of the table at both ends of a part of a step with its derivatives over the part; (derivative, end).
  pure function in_part(values, width, places) result(f)
    real(dp), intent(in) :: values(0:, :)          !< as of `curve_over`
    real(dp), intent(in) :: width                  !< width of the step
    real(dp), intent(in) :: places(2)              !< as in `load_over`
    real(dp) :: f(0:2, 2)

    if (places(1) > 0 .or. places(2) < 1) then
      f = over_part(curve_over(values, width), places)
    else
      f = values*spread([1.0_dp, width, width**2], 2, 2)
    end if
  end function in_part

  !> Quintic through the values of the table at both ends of a step, over places from 0 to 1.
  pure function curve_over(values, width) result(c)
    real(dp), intent(in) :: values(0:, :)          !< with derivatives over the mesh phase; (derivative, end)
    real(dp), intent(in) :: width                  !< width of the step
    real(dp) :: c(0:5)

    c = quintic([values(0, 1), width*values(1, 1), width**2*values(2, 1)], &
                [values(0, 2), width*values(1, 2), width**2*values(2, 2)])
  end function curve_over

  !> Load (N) of a pair in contact at its maximum within a step, from the motion and the properties of all pairs at that place:
  !> a stiffness with several knots in the step is not one polynomial.
  pure real(dp) function largest_within(osc, table, step, law, pair, motion, load) result(largest)
    type(oscillator_t), intent(in) :: osc
    type(coefficients_t), intent(in) :: table
    integer, intent(in) :: step
    integer, intent(in) :: law                     !< index of the law of its contact set
    integer, intent(in) :: pair
    real(dp), intent(in) :: motion(0:2, 2)         !< result of `motion_over_step`
    real(dp), intent(in) :: load(0:2, 2)           !< result of `load_over`
    real(dp) :: place, effective, touching

    place = maximum_of(quintic(load(:, 1), load(:, 2)))
    call find_law_of_pair(osc%mesh, osc%intervals(table%interval(step)), table%left(step) + place*table%width(step), &
                          table%contact_set(law), pair, effective, touching)
    largest = effective*(value_of(quintic(motion(:, 1), motion(:, 2)), place) - touching)
  end function largest_within

  !> True for steps of so many rad of the natural motion that the acceleration is a small difference of large forces.
  pure logical function turns_too_far(angle)
    real(dp), intent(in) :: angle                  !< angle of the natural motion in the step, rad
    real(dp), parameter :: most = 3e3_dp

    turns_too_far = .not. angle < most
  end function turns_too_far

  !> True if a load may exceed `peak` between two places: a concave one stays below its tangents.
  pure logical function may_exceed(load, peak)
    real(dp), intent(in) :: load(0:2, 2)           !< value and first derivative over the distance at both, N
    real(dp), intent(in) :: peak                   !< N

    may_exceed = load(1, 1) > 0 .and. load(1, 2) < 0
    if (may_exceed) may_exceed = max(load(0, 1), load(0, 2)) + (load(1, 1) - load(1, 2))/4 > peak
  end function may_exceed

  !> Raises `peak` to the maximum of a load between two places, if there is one.
  pure subroutine raise_to_maximum(load, peak)
    real(dp), intent(in) :: load(0:2, 2)           !< value, first and second derivative over the distance at both, N
    real(dp), intent(inout) :: peak                !< N
    real(dp) :: c(0:5)

    c = quintic(load(:, 1), load(:, 2))
    peak = max(peak, value_of(c, maximum_of(c)))
  end subroutine raise_to_maximum

  !> Second derivatives at both ends of the cubic with these values and first derivatives there, over 0 ... 1.
  pure function cubic_curvature(value, slope) result(curvature)
    real(dp), intent(in) :: value(:), slope(2)     !< at 0 and at 1; two each
    real(dp) :: curvature(2)

    associate (rise => value(2) - value(1))
      curvature = [6*rise - 4*slope(1) - 2*slope(2), -6*rise + 2*slope(1) + 4*slope(2)]
    end associate
  end function cubic_curvature
end module gearsweep_motion_load_peaks
