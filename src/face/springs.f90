!> Pairs of helical gears as springs, for their motion.
!>
!> A pair is in contact over the total contact ratio, and its line of contact grows from nothing and shrinks to nothing. Under the
!> nominal load it has a load F and a tangent stiffness K over the deflection x that all pairs share. The motion has the load
!> K (x - e) instead, with e = x - F/K: exact at the nominal load, and at others as far as lines bear over their whole length and
!> flanks flatten alike. What neighbouring lines deflect of their bodies is in K and e.
module gearsweep_face_springs
  use gearsweep_base, only: dp, joined, piecewise_t, spline
  use gearsweep_face_load, only: face_load_t
  implicit none
  private
  public :: find_springs

  !> Stiffness where a pair does not carry, over the largest one.
  real(dp), parameter :: least = 1e-4_dp

contains

  !> Finds stiffness and profile error of a pair over its path coordinate, from 0 to the sum of `contact_ratio` and `overlap_ratio`.
  pure subroutine find_springs(load, contact_ratio, overlap_ratio, stiffness, profile_error)
    type(face_load_t), intent(in) :: load        !< load distribution over a mesh period
    real(dp), intent(in) :: contact_ratio, overlap_ratio
    type(piecewise_t), intent(out) :: stiffness  !< N/m
    type(piecewise_t), intent(out) :: profile_error        !< m
    real(dp), parameter :: close = 1e-9_dp
    real(dp), dimension(size(load%pair_load) + 2) :: s, k, e
    real(dp) :: total
    integer :: i, j, n

    total = contact_ratio + overlap_ratio
    n = 0
    do j = 1, size(load%pair_load, 1)
      do i = 1, size(load%phase)
        if (j > load%pairs(i)) cycle
        associate (at => load%phase(i) + j - 1)
          ! Both sides of a phase between two intervals are one place.
          if (n > 0) then
            if (at - s(n) < close) cycle
          end if
          if (at > total - close) cycle
          n = n + 1
          s(n) = at
          k(n) = load%pair_stiffness(j, i)
          e(n) = 0
          if (k(n) > 0) e(n) = load%deflection(i) - load%pair_load(j, i)/k(n)
        end associate
      end do
    end do
    n = n + 1
    s(n) = total
    k(n) = 0
    call carry_over(k(:n), e(:n))
    k(:n) = max(k(:n), least*maxval(k(:n)))
    stiffness = through(s(:n), k(:n))
    profile_error = through(s(:n), e(:n))

  contains

    !> Spline through all places, in parts between which its slope jumps: where the line has reached its full length, and where it
    !> begins to shrink; straight lines at the ends.
    pure type(piecewise_t) function through(s, values) result(curve)
      real(dp), intent(in) :: s(:), values(:)
      integer :: ends(6), part

      ends = [1, 2, minloc(abs(s - min(contact_ratio, overlap_ratio)), 1), minloc(abs(s - max(contact_ratio, overlap_ratio)), 1), &
              size(s) - 1, size(s)]
      ends(3:4) = max(ends(2), min(ends(3:4), ends(5)))
      curve = spline(s(:2), values(:2))
      do part = 2, 5
        if (ends(part + 1) > ends(part)) curve = joined(curve, spline(s(ends(part):ends(part + 1)), &
                                                                      values(ends(part):ends(part + 1))))
      end do
    end function through
  end subroutine find_springs

  !> Gives pairs that do not carry the profile error of the nearest place before or after at which they do.
  pure subroutine carry_over(k, e)
    real(dp), intent(in) :: k(:)
    real(dp), intent(inout) :: e(:)
    integer :: i, before, after

    do i = 1, size(k)
      if (k(i) > 0) cycle
      before = findloc(k(:i) > 0, .true., 1, back=.true.)
      after = findloc(k(i:) > 0, .true., 1) + i - 1
      if (before == 0 .and. after < i) cycle
      if (before == 0) then
        e(i) = e(after)
      else if (after < i) then
        e(i) = e(before)
      else
        e(i) = merge(e(before), e(after), i - before <= after - i)
      end if
    end do
  end subroutine carry_over
end module gearsweep_face_springs
