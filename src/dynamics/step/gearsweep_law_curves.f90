!> The law of one contact set within a step: quintics through what the table has at the step's ends, and the loads that they give.
!> Places count from 0 to 1 over the step.
module gearsweep_law_curves
  use gearsweep_coefficients, only: need_law
  use gearsweep_contact_law, only: product_of
  use gearsweep_kinds, only: dp
  use gearsweep_load_peaks, only: may_exceed, raise_to_maximum
  use gearsweep_oscillator, only: oscillator_t
  use gearsweep_period_map, only: period_map_t
  use gearsweep_quintic, only: bounds_of, quintic
  implicit none
  private
  public :: law_curves_t, make_curves, find_curves, derivatives, load_over, raise_peak, may_have_more

  type :: law_curves_t
    integer :: contact_set = -1
    integer :: pairs = 0                         !< that the step has
    real(dp), dimension(0:5) :: omega_squared, forcing         !< sums of k (1/s^2) and k e (m/s^2) over the contacts
    !> Effective stiffness (N/m) and touching deflection (m), and what they stay below, or between; (0:5, contact), (contact) and
    !> (least or most, contact).
    real(dp), allocatable :: effective(:, :), touching(:, :), most_effective(:), touching_bounds(:, :)
  end type law_curves_t

contains

  !> Memory for the curves of an oscillator.
  pure subroutine make_curves(osc, curves)
    type(oscillator_t), intent(in) :: osc
    type(law_curves_t), intent(out) :: curves

    allocate (curves%effective(0:5, osc%contacts), curves%touching(0:5, osc%contacts), curves%most_effective(osc%contacts), &
              curves%touching_bounds(2, osc%contacts))
  end subroutine make_curves

  !> The curves of a contact set in a step.
  pure subroutine find_curves(map, step, contact_set, curves)
    type(period_map_t), intent(inout) :: map
    integer, intent(in) :: step, contact_set
    type(law_curves_t), intent(inout) :: curves
    real(dp) :: scale(0:2), bounds(2)
    integer :: law, j

    call need_law(map%osc, step, contact_set, map%table, law)
    curves%contact_set = contact_set
    associate (table => map%table, osc => map%osc)
      curves%pairs = table%pairs(step)
      scale = [1.0_dp, table%width(step), table%width(step)**2]
      curves%omega_squared = quintic(scale*table%end_omega_squared(:, 1, law), scale*table%end_omega_squared(:, 2, law))
      curves%forcing = quintic(scale*table%end_forcing(:, 1, law), scale*table%end_forcing(:, 2, law))
      do j = 1, osc%contacts
        if (j > curves%pairs .and. j <= osc%pairs) cycle
        curves%effective(:, j) = quintic(scale*table%effective(:, j, 1, law), scale*table%effective(:, j, 2, law))
        curves%touching(:, j) = quintic(scale*table%touching(:, j, 1, law), scale*table%touching(:, j, 2, law))
        bounds = bounds_of(curves%effective(:, j))
        curves%most_effective(j) = bounds(2)
        curves%touching_bounds(:, j) = bounds_of(curves%touching(:, j))
      end do
    end associate
  end subroutine find_curves

  !> Value, first and second derivative of a quintic at both ends of a part of the step, over that part; (0:2, end).
  pure function derivatives(q, place) result(f)
    real(dp), intent(in) :: q(0:5)               !< coefficients
    real(dp), intent(in) :: place(2)             !< of both ends
    real(dp) :: f(0:2, 2), length

    length = place(2) - place(1)
    f(0, :) = ((((q(5)*place + q(4))*place + q(3))*place + q(2))*place + q(1))*place + q(0)
    f(1, :) = length*((((5*q(5)*place + 4*q(4))*place + 3*q(3))*place + 2*q(2))*place + q(1))
    f(2, :) = length**2*(((20*q(5)*place + 12*q(4))*place + 6*q(3))*place + 2*q(2))
  end function derivatives

  !> The load of a pair in contact at both ends of a part of the step (N), with its derivatives over that part; (0:2, end). That of
  !> the coast sides is negative.
  pure function load_over(curves, j, place, x) result(load)
    type(law_curves_t), intent(in) :: curves
    integer, intent(in) :: j                     !< which contact
    real(dp), intent(in) :: place(2)             !< of both ends
    real(dp), intent(in) :: x(0:2, 2)            !< the deflection there, m
    real(dp), dimension(0:2, 2) :: load, effective, touching
    integer :: end

    effective = derivatives(curves%effective(:, j), place)
    touching = derivatives(curves%touching(:, j), place)
    do end = 1, 2
      load(:, end) = product_of(effective(:, end), x(:, end) - touching(:, end))
    end do
  end function load_over

  !> May a pair in contact have a larger load than `peak` (N) in the step while x stays below `highest` (m)?
  pure logical function may_have_more(curves, highest, peak)
    type(law_curves_t), intent(in) :: curves
    real(dp), intent(in) :: highest, peak
    integer :: j

    may_have_more = .false.
    do j = 1, curves%pairs
      if (btest(curves%contact_set, j - 1)) may_have_more = may_have_more .or. &
        curves%most_effective(j)*(highest - curves%touching_bounds(1, j)) > peak
    end do
  end function may_have_more

  !> Raises the largest load by those of the pairs over a part of the step.
  pure subroutine raise_peak(curves, place, x, peak)
    type(law_curves_t), intent(in) :: curves
    real(dp), intent(in) :: place(2), x(0:2, 2)  !< as in `load_over`
    real(dp), intent(inout) :: peak              !< N
    real(dp) :: load(0:2, 2)
    integer :: j

    do j = 1, curves%pairs
      if (.not. btest(curves%contact_set, j - 1)) cycle
      load = load_over(curves, j, place, x)
      peak = max(peak, load(0, 1), load(0, 2))
      if (may_exceed(load, peak)) call raise_to_maximum(load, peak)
    end do
  end subroutine raise_peak
end module gearsweep_law_curves
