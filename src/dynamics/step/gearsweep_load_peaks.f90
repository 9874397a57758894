!> The largest load on one pair, also between the ends of steps.
!>
!> Most maxima within steps are too low to matter. So the steps only note candidates with an upper bound, and the
!> maxima are computed in the end, where the bound is still above the largest load found.
module gearsweep_load_peaks
  use gearsweep_coefficients, only: coefficients_t
  use gearsweep_coupled_pairs, only: compliances, respond
  use gearsweep_kinds, only: dp
  use gearsweep_mesh, only: interval_t
  use gearsweep_oscillator, only: oscillator_t
  use gearsweep_quintic, only: quintic, maximum_of, value_of
  use gearsweep_sharing, only: pairs_at
  use gearsweep_step_ends, only: deflection_at_end, end_acceleration
  implicit none
  private
  public :: candidate_t, candidates_t, add_candidate, evaluate_candidates, may_exceed, raise_to_maximum, load_within, &
            cubic_curvature, turns_too_far

  !> A step within which the load of a pair has a maximum.
  type :: candidate_t
    real(dp) :: bound                  !< the maximum lies below, N
    real(dp) :: x(2), y(2)             !< state at both ends of the step, m
    integer :: step, pair, contact_set
  end type candidate_t

  integer, parameter :: most_candidates = 16
  type :: candidates_t
    integer :: count
    type(candidate_t) :: candidate(most_candidates)
  end type candidates_t

contains

  !> Adds a candidate. Where there is no room, those that the largest load has passed meanwhile are dropped, or all
  !> are evaluated.
  pure subroutine add_candidate(osc, table, duration, candidate, candidates, peak)
    type(oscillator_t), intent(in) :: osc
    type(coefficients_t), intent(in) :: table
    real(dp), intent(in) :: duration               !< of the mesh period, s
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

  !> Raises the largest load by all candidates; the one with the highest bound first, which spares most others.
  pure subroutine evaluate_candidates(osc, table, duration, candidates, peak)
    type(oscillator_t), intent(in) :: osc
    type(coefficients_t), intent(in) :: table
    real(dp), intent(in) :: duration               !< of the mesh period, s
    type(candidates_t), intent(inout) :: candidates    !< empty afterwards
    real(dp), intent(inout) :: peak                !< largest load so far, N
    integer :: k

    do while (candidates%count > 0)
      k = maxloc(candidates%candidate(:candidates%count)%bound, 1)
      if (candidates%candidate(k)%bound > peak) call refine_maximum(osc, table, duration, candidates%candidate(k), peak)
      candidates%candidate(k) = candidates%candidate(candidates%count)
      candidates%count = candidates%count - 1
    end do
  end subroutine evaluate_candidates

  !> Raises the largest load by that within the step of a candidate.
  pure subroutine refine_maximum(osc, table, duration, candidate, peak)
    type(oscillator_t), intent(in) :: osc
    type(coefficients_t), intent(in) :: table
    real(dp), intent(in) :: duration
    type(candidate_t), intent(in) :: candidate
    real(dp), intent(inout) :: peak
    real(dp), dimension(0:2, 2) :: x, gap, load
    real(dp) :: place
    logical :: bent
    integer :: k, pass

    associate (stiffness => table%end_stiffness(:, candidate%pair, :, candidate%step), set => candidate%contact_set, &
               error => table%end_profile_error(:, candidate%pair, :, candidate%step), i => candidate%step, j => candidate%pair)
      associate (width => table%width(i))
        bent = .not. turns_too_far(table, i, duration)
        ! Most need no second derivative.
        do pass = 1, 2
          do k = 1, 2
            x(:, k) = [candidate%x(k), candidate%y(k), 0.0_dp]
            if (pass == 2 .and. bent) x(2, k) = end_acceleration(osc, table, i, k, set, duration, x(:1, k))
            gap(:, k) = deflection_at_end(osc, table, i, k, set, j, x(:, k)) - error(:, k)
          end do
          if (pass == 2 .and. .not. bent) then
            x(2, :) = cubic_curvature(x(0, :), width*x(1, :))/width**2
            gap(2, :) = cubic_curvature(gap(0, :), width*gap(1, :))/width**2
          end if
          load(0, :) = stiffness(1, :)*gap(0, :)
          load(1, :) = width*(stiffness(2, :)*gap(0, :) + stiffness(1, :)*gap(1, :))
          load(2, :) = width**2*(stiffness(3, :)*gap(0, :) + 2*stiffness(2, :)*gap(1, :) + stiffness(1, :)*gap(2, :))
          if (.not. may_exceed(load, peak)) return
        end do
        place = maximum_of(quintic(load(:, 1), load(:, 2)))
        x(1, :) = width*x(1, :)
        x(2, :) = width**2*x(2, :)
        peak = max(peak, load_within(osc, table, i, set, j, place, value_of(quintic(x(:, 1), x(:, 2)), place), 1.0_dp))
      end associate
    end associate
  end subroutine refine_maximum

  !> Load (N) of a pair in contact at a place within a step, by the motion there and by what all pairs have at that very place: a
  !> stiffness through many knots is no polynomial from one end of the step to the other.
  pure real(dp) function load_within(osc, table, step, contact_set, pair, place, x, part) result(load)
    type(oscillator_t), intent(in) :: osc
    type(coefficients_t), intent(in) :: table
    integer, intent(in) :: step, contact_set, pair
    real(dp), intent(in) :: place                  !< 0 to 1
    real(dp), intent(in) :: x                      !< the deflection there, m
    real(dp), intent(in) :: part                   !< of the profile error that the pairs have
    real(dp) :: phase

    phase = table%left(step) + place*table%width(step)
    associate (interval => osc%intervals(table%interval(step)))
      if (osc%shared > 0) then
        load = load_of_shared(osc, interval, phase, contact_set, pair, x, part)
      else
        load = osc%mesh%stiffness%value(interval%place(phase, pair))* &
               (x - part*osc%mesh%profile_error%value(interval%place(phase, pair)))
      end if
    end associate
  end function load_within

  !> The same where pairs share a compliance.
  pure real(dp) function load_of_shared(osc, interval, phase, contact_set, pair, x, part) result(load)
    type(oscillator_t), intent(in) :: osc
    type(interval_t), intent(in) :: interval
    real(dp), intent(in) :: phase, x, part
    integer, intent(in) :: contact_set, pair
    real(dp), dimension(interval%pairs) :: stiffness, error
    real(dp), dimension(0:2, interval%pairs) :: stiffnesses, errors, g, h
    real(dp) :: shared
    logical :: closed(interval%pairs)
    integer :: j

    call pairs_at(osc%mesh, interval, phase, stiffness, error)
    error = part*error
    if (osc%mesh%is_coupled(interval%pairs)) then
      stiffnesses = 0
      stiffnesses(0, :) = stiffness
      errors = 0
      errors(0, :) = error
      call respond(contact_set, compliances(stiffnesses, interval%shared_with_slopes(phase), osc%mesh%disc%shared_beyond()), &
                   errors, g, h)
      load = g(0, pair)*x - h(0, pair)
    else
      closed = btest(contact_set, [(j, j=0, size(closed) - 1)])
      shared = interval%shared_by_two(phase)
      stiffness = stiffness/(1 - shared*stiffness)
      load = stiffness(pair)*((x + shared*sum(stiffness*error, mask=closed))/(1 + shared*sum(stiffness, mask=closed)) &
                              - error(pair))
    end if
  end function load_of_shared

  !> In steps of more rad of the natural motion the acceleration is a small difference of large forces.
  pure logical function turns_too_far(table, step, duration)
    type(coefficients_t), intent(in) :: table
    integer, intent(in) :: step
    real(dp), intent(in) :: duration               !< of the mesh period, s
    real(dp), parameter :: most = 3e3_dp

    turns_too_far = .not. duration*table%width(step)*sqrt(maxval(sum(table%end_rate(:table%pairs(step), :, step), 1))) < most
  end function turns_too_far

  !> May a load exceed `peak` between two places? A concave one stays below its tangents.
  pure logical function may_exceed(load, peak)
    real(dp), intent(in) :: load(0:2, 2)           !< value and first derivative over the distance at both, N
    real(dp), intent(in) :: peak                   !< N

    may_exceed = load(1, 1) > 0 .and. load(1, 2) < 0
    if (may_exceed) may_exceed = max(load(0, 1), load(0, 2)) + (load(1, 1) - load(1, 2))/4 > peak
  end function may_exceed

  !> Raises `peak` to the maximum of a load between two places, given that there is one.
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
end module gearsweep_load_peaks
