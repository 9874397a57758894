!> The largest loads in a step within which one pair closes or opens.
module gearsweep_change_loads
  use gearsweep_gauss, only: batch_size
  use gearsweep_kinds, only: dp
  use gearsweep_law_curves, only: find_curves, law_curves_t, make_curves, may_have_more, raise_peak
  use gearsweep_period_map, only: period_map_t
  implicit none
  private
  public :: change_t, raise_peaks

  !> A change of contact of several speeds in one step. Places count from 0 to 1 over the step, and v is the derivative of x
  !> over it (m).
  type :: change_t
    integer :: step
    integer :: pair                              !< that closes or opens
    integer :: before, behind                    !< contact sets
    logical :: alike(batch_size)                 !< the speeds
    real(dp), dimension(batch_size) :: place, x, v                       !< the change
    real(dp), dimension(batch_size, 0:7) :: first, second                !< polynomials of the motions before and behind it
    real(dp), dimension(batch_size) :: last_x, last_v                    !< the end of the step
    real(dp) :: propagator(batch_size, 4)        !< of x and v
  end type change_t

contains

  !> Raises the largest loads by those of the pairs in contact before and behind the change. Most are far below.
  pure subroutine raise_peaks(map, change, peak)
    type(period_map_t), intent(inout) :: map
    type(change_t), intent(in) :: change
    real(dp), intent(inout) :: peak(batch_size)
    type(law_curves_t) :: before, behind
    real(dp) :: highest
    integer :: l

    call make_curves(map%osc, before)
    call make_curves(map%osc, behind)
    call find_curves(map, change%step, change%before, before)
    call find_curves(map, change%step, change%behind, behind)
    do l = 1, batch_size
      if (.not. change%alike(l)) cycle
      associate (x => change%x(l), v => change%v(l), place => change%place(l))
        highest = max(change%first(l, 0), x) + place*(abs(change%first(l, 1)) + abs(v))/4
        if (may_have_more(before, highest, peak(l))) &
          call raise_peak(before, [0.0_dp, place], motion_between(change%first(l, :), 0.0_dp, place), peak(l))
        highest = max(x, change%last_x(l)) + (1 - place)*(abs(v) + abs(change%last_v(l)))/4
        if (may_have_more(behind, highest, peak(l))) &
          call raise_peak(behind, [place, 1.0_dp], motion_between(change%second(l, :), place, 1.0_dp), peak(l))
      end associate
    end do
  end subroutine raise_peaks

  !> A motion at two places with its derivatives over the part of the step between them, m; (0:2, end).
  pure function motion_between(c, from, to) result(x)
    real(dp), intent(in) :: c(0:)                ! coefficients in ascending powers
    real(dp), intent(in) :: from, to
    real(dp) :: x(0:2, 2)

    call derive(c, from, x(:, 1))
    call derive(c, to, x(:, 2))
    x(1, :) = (to - from)*x(1, :)
    x(2, :) = (to - from)**2*x(2, :)
  end function motion_between

  !> Value, first and second derivative of a polynomial at a place.
  pure subroutine derive(c, place, f)
    real(dp), intent(in) :: c(0:)                ! coefficients in ascending powers
    real(dp), intent(in) :: place
    real(dp), intent(out) :: f(0:)
    integer :: k

    f = 0
    do k = ubound(c, 1), 0, -1
      f(2) = f(2)*place + f(1)
      f(1) = f(1)*place + f(0)
      f(0) = f(0)*place + c(k)
    end do
    f(2) = 2*f(2)
  end subroutine derive
end module gearsweep_change_loads
