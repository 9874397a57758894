!> The largest loads in a step within which one pair closes or opens.
module gearsweep_change_loads
  use gearsweep_gauss, only: batch_size
  use gearsweep_kinds, only: dp
  use gearsweep_load_peaks, only: may_exceed, raise_to_maximum
  use gearsweep_period_map, only: period_map_t
  use gearsweep_quintic, only: bounds_of, quintic
  use gearsweep_shared_compliance, only: sum_pairs, working_deflection
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

  !> Stiffness and profile error of the pairs over a step, as quintics, and what they stay below and above.
  type :: curves_t
    real(dp), allocatable :: k(:, :), e(:, :)    !< N/m, m; (0:5, pair)
    real(dp), allocatable :: stiffest(:), least(:)       !< N/m, m; (pair)
  end type curves_t

contains

  !> Raises the largest loads by those of the pairs in contact before and behind the change. Most are far below.
  pure subroutine raise_peaks(map, change, peak)
    type(period_map_t), intent(in) :: map
    type(change_t), intent(in) :: change
    real(dp), intent(inout) :: peak(batch_size)
    type(curves_t) :: curves
    real(dp) :: scale(0:2), bounds(2), highest
    integer :: j, l

    associate (table => map%table, step => change%step, p => map%table%pairs(change%step))
      allocate (curves%k(0:5, p), curves%e(0:5, p), curves%stiffest(p), curves%least(p))
      scale = [1.0_dp, table%width(step), table%width(step)**2]
      do j = 1, p
        curves%k(:, j) = quintic(scale*table%end_stiffness(:, j, 1, step), scale*table%end_stiffness(:, j, 2, step))
        curves%e(:, j) = quintic(scale*table%end_profile_error(:, j, 1, step), scale*table%end_profile_error(:, j, 2, step))
        bounds = bounds_of(curves%k(:, j))
        curves%stiffest(j) = bounds(2)
        bounds = bounds_of(curves%e(:, j))
        curves%least(j) = bounds(1)
      end do
    end associate
    do l = 1, batch_size
      if (.not. change%alike(l)) cycle
      associate (x => change%x(l), v => change%v(l), place => change%place(l))
        highest = max(change%first(l, 0), x) + place*(abs(change%first(l, 1)) + abs(v))/4
        if (may_have_more(change%before, curves, highest, peak(l))) &
          call raise_peak(map, change%step, change%before, [0.0_dp, place], change%first(l, :), curves, peak(l))
        highest = max(x, change%last_x(l)) + (1 - place)*(abs(v) + abs(change%last_v(l)))/4
        if (may_have_more(change%behind, curves, highest, peak(l))) &
          call raise_peak(map, change%step, change%behind, [place, 1.0_dp], change%second(l, :), curves, peak(l))
      end associate
    end do
  end subroutine raise_peaks

  !> May a pair in contact have a larger load than `peak` (N) while x stays below `highest` (m)? What pairs share lowers loads.
  pure logical function may_have_more(contact_set, curves, highest, peak)
    integer, intent(in) :: contact_set
    type(curves_t), intent(in) :: curves
    real(dp), intent(in) :: highest, peak
    integer :: j

    may_have_more = .false.
    do j = 1, size(curves%least)
      if (btest(contact_set, j - 1)) may_have_more = may_have_more .or. curves%stiffest(j)*(highest - curves%least(j)) > peak
    end do
  end function may_have_more

  !> Raises the largest load by those between two places of a motion.
  pure subroutine raise_peak(map, step, contact_set, place, motion, curves, peak)
    type(period_map_t), intent(in) :: map
    integer, intent(in) :: step, contact_set
    real(dp), intent(in) :: place(2), motion(:)  ! coefficients of x
    type(curves_t), intent(in) :: curves
    real(dp), intent(inout) :: peak
    real(dp), dimension(0:2, size(curves%least), 2) :: k, e
    real(dp) :: w(0:2, 2), shared(0:2, 2), a(0:2), b(0:2), load(0:2, 2), scale(0:2)
    integer :: end, j

    scale = [1.0_dp, place(2) - place(1), (place(2) - place(1))**2]
    k = 0
    e = 0
    do end = 1, 2
      call derive(motion, place(end), w(:, end))
      do j = 1, size(curves%least)
        if (.not. btest(contact_set, j - 1)) cycle
        call derive(curves%k(:, j), place(end), k(:, j, end))
        call derive(curves%e(:, j), place(end), e(:, j, end))
      end do
      if (.not. map%osc%shared > 0) cycle
      associate (c => map%table%end_shared(:, 1, 1, step), width => map%table%width(step))
        call derive([c(1), width*c(2), width**2*c(3)/2], place(end), shared(:, end))
      end associate
      call sum_pairs(contact_set, k(:, :, end), e(:, :, end), a, b)
      w(:, end) = working_deflection(shared(:, end), a, b, w(:, end))
    end do
    do j = 1, size(curves%least)
      if (.not. btest(contact_set, j - 1)) cycle
      load(0, :) = k(0, j, :)*(w(0, :) - e(0, j, :))
      load(1, :) = k(1, j, :)*(w(0, :) - e(0, j, :)) + k(0, j, :)*(w(1, :) - e(1, j, :))
      load(2, :) = k(2, j, :)*(w(0, :) - e(0, j, :)) + 2*k(1, j, :)*(w(1, :) - e(1, j, :)) + k(0, j, :)*(w(2, :) - e(2, j, :))
      peak = max(peak, load(0, 1), load(0, 2))
      load(1, :) = scale(1)*load(1, :)
      load(2, :) = scale(2)*load(2, :)
      if (may_exceed(load, peak)) call raise_to_maximum(load, peak)
    end do
  end subroutine raise_peak

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
