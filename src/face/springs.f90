!> Pairs of helical gears as springs, for their motion.
!>
!> A pair is in contact over the total contact ratio; the length of its line of contact grows from 0 and decreases to 0. Under the
!> nominal load a pair carries F with the tangent stiffness K at the deflection x, which is that of all pairs. In the motion it
!> carries K (x - e), with e = x - F/K. This is exact at the nominal load; at other loads it holds as long as lines carry over their
!> whole length, but for the flattening of the flanks, whose stiffness rises with the load. A pair without a load has e = x, so that
!> it is about to touch. K and e include the compliance that neighbouring lines share.
module gearsweep_face_springs
  use gearsweep_base, only: dp, joined, piecewise_t, spline
  use gearsweep_face_load, only: face_load_t
  implicit none
  private
  public :: find_springs

  !> Stiffness where a pair does not carry, over the largest one.
  real(dp), parameter :: least = 1e-4_dp

contains

  !> Finds stiffness and profile error of a pair over its path coordinate, from 0 to the total contact ratio.
  pure subroutine find_springs(load, total, stiffness, profile_error)
    type(face_load_t), intent(in) :: load        !< load distribution over a mesh period
    real(dp), intent(in) :: total                !< total contact ratio
    type(piecewise_t), intent(out) :: stiffness  !< N/m
    type(piecewise_t), intent(out) :: profile_error        !< m
    real(dp), parameter :: close = 1e-9_dp
    real(dp), dimension(size(load%pair_load) + 2) :: s, k, e
    logical :: ends(size(load%pair_load) + 2)    ! a line begins, ends or reaches an end face there
    integer :: i, j, n

    ends = .false.
    n = 0
    do j = 1, size(load%pair_load, 1)
      do i = 1, size(load%phase)
        if (j > load%pairs(i)) cycle
        associate (at => load%phase(i) + j - 1)
          ! Both sides of a phase between two intervals are one place.
          if (n > 0) then
            ends(n) = ends(n) .or. at - s(n) < close
            if (at - s(n) < close) cycle
          end if
          if (at > total - close) cycle
          n = n + 1
          s(n) = at
          k(n) = load%pair_stiffness(j, i)
          e(n) = load%deflection(i)
          if (k(n) > 0) e(n) = e(n) - load%pair_load(j, i)/k(n)
        end associate
      end do
    end do
    n = n + 1
    s(n) = total
    k(n) = 0
    e(n) = load%deflection(size(load%deflection))
    ! Where the pair does not carry: e of the nearest place at which it does, as e changes little while K vanishes.
    do i = n - 1, 1, -1
      if (.not. k(i) > 0 .and. k(i + 1) > 0) e(i) = e(i + 1)
    end do
    do i = 2, n
      if (.not. k(i) > 0 .and. k(i - 1) > 0) e(i) = e(i - 1)
    end do
    k(:n) = max(k(:n), least*maxval(k(:n)))
    ends(n - 1:n) = .true.
    stiffness = through(s(:n), k(:n))
    profile_error = through(s(:n), e(:n))

  contains

    !> Splines between the places at which the slope jumps; straight lines in the first and the last interval, so that K stays
    !> above 0.
    pure type(piecewise_t) function through(s, values) result(curve)
      real(dp), intent(in) :: s(:), values(:)
      integer :: first, last

      curve = spline(s(:2), values(:2))
      first = 2
      do last = 3, size(s)
        if (.not. ends(last)) cycle
        curve = joined(curve, spline(s(first:last), values(first:last)))
        first = last
      end do
    end function through
  end subroutine find_springs
end module gearsweep_face_springs
