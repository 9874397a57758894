!> Pairs of teeth as springs, for their motion: one spring for a pair of helical gears whose faces are parallel, several where the
!> load over the face is uneven.
!>
!> A pair of helical gears is in contact over the total contact ratio; the length of its line of contact grows from 0 and decreases
!> to 0. Under the nominal load a pair carries F with the tangent stiffness K at the deflection x, which is that of all pairs. In
!> the motion it carries K (x - e), with e = x - F/K. This is exact at the nominal load; at other loads it holds as long as lines
!> carry over their whole length, but for the flattening of the flanks, whose stiffness rises with the load. A pair without a load
!> has e = x, so that it is about to touch. K and e include the compliance that neighbouring lines share.
!>
!> A misaligned or crowned face touches at one place, and more of it carries the larger the load is. The load F(x) of a pair then
!> has a slope that rises with x, and chords stand for it: from where the pair touches to a tenth of the static load, on to 0.4,
!> 0.9, 1.6 and 2.8 times this load, and beyond. Where several pairs carry, the chords of each end at the same fractions of the
!> load that it has while all together carry 2.8 times the static load. A chord is a spring of the pair in parallel to those before
!> it: it touches where it begins, at e, and its stiffness K is the rise of the slope there.
module gearsweep_face_springs
  use gearsweep_base, only: constant, dp, joined, piecewise_t, spline
  use gearsweep_face_load, only: face_load_t, pair_loads_t
  implicit none
  private
  public :: find_chords, find_springs

  !> Stiffness where a pair does not carry, over the largest one.
  real(dp), parameter :: least = 1e-4_dp

  !> Springs of a pair whose load over the face is uneven, and the loads over the largest at which they begin and the last ends.
  integer, parameter, public :: springs_of_pair = 5
  real(dp), parameter :: begins(0:springs_of_pair) = [0.0_dp, 0.1_dp, 0.4_dp, 0.9_dp, 1.6_dp, 2.8_dp]/2.8_dp
  !> Loads of all pairs together for which the load distribution is solved, over the static load.
  real(dp), parameter, public :: chord_loads(*) = [0.03_dp, 0.1_dp, 0.25_dp, 0.4_dp, 0.65_dp, 0.9_dp, 1.25_dp, 1.6_dp, 2.2_dp, &
                                                   2.8_dp]

contains

  !> Finds stiffness and profile error of the springs of a pair over the path coordinate of a mesh with this `spacing` (`mesh_t`).
  pure subroutine find_chords(loads, total, spacing, stiffness, profile_error)
    type(pair_loads_t), intent(in) :: loads      !< of the pairs under `chord_loads`
    real(dp), intent(in) :: total                !< contact ratio, of helical gears the total one
    integer, intent(in) :: spacing               !< base pitches, at least `total`
    type(piecewise_t), intent(out) :: stiffness  !< N/m
    type(piecewise_t), intent(out) :: profile_error        !< m
    real(dp), parameter :: close = 1e-9_dp
    ! At each place of a pair: the stiffness of its springs, N/m, where the first touches, and the distance to the next, m.
    real(dp) :: k(springs_of_pair, size(loads%touching)), step(springs_of_pair - 1, size(loads%touching))
    real(dp), dimension(size(loads%touching)) :: s, first
    logical, dimension(size(loads%touching)) :: is_known, ends
    type(piecewise_t) :: e
    real(dp) :: beyond
    integer :: i, j, m, n, row

    n = 0
    do j = 1, size(loads%load, 2)
      do row = 1, size(loads%phase)
        if (j > loads%pairs(row)) cycle
        n = n + 1
        s(n) = loads%phase(row) + (j - 1)
        call split_load(loads, j, row, k(:, n), first(n), step(:, n), is_known(n))
        ! An interval with the same pairs ends: the next row has the same place, or this one is the last.
        ends(n) = row == size(loads%phase)
        if (.not. ends(n)) ends(n) = loads%phase(row + 1) - loads%phase(row) < close
      end do
    end do
    call fill_gaps(is_known(:n), k(:, :n), first(:n), step(:, :n))
    beyond = 10*maxval(first(:n) + sum(step(:, :n), 1))
    stiffness = over_path(k(1, :n), .true.)
    profile_error = over_path(first(:n), .false.)
    e = profile_error
    do m = 2, springs_of_pair
      call place_before(over_path(k(m, :n), .true.), 0.0_dp, stiffness)
      e = sum_of(e, over_path(step(m - 1, :n), .true.))
      call place_before(e, beyond, profile_error)
    end do

  contains

    !> Curve through the values at all places, with a break wherever the number of pairs changes.
    pure type(piecewise_t) function over_path(values, is_positive) result(curve)
      real(dp), intent(in) :: values(:)
      logical, intent(in) :: is_positive         ! nowhere below 0
      type(piecewise_t) :: part
      integer :: from, i

      from = 1
      do i = 1, n
        if (.not. ends(i)) cycle
        if (is_positive) then
          part = positive(s(from:i), values(from:i))
        else
          part = spline(s(from:i), values(from:i))
        end if
        if (from > 1) part = joined(curve, part)
        curve = part
        from = i + 1
      end do
    end function over_path

    !> Adds spring m of the pair to a curve, in front of spring m - 1. `level` is its value past E.
    pure subroutine place_before(spring, level, curve)
      type(piecewise_t), intent(in) :: spring
      real(dp), intent(in) :: level
      type(piecewise_t), intent(inout) :: curve
      type(piecewise_t) :: before

      before = spring
      if (spacing > total + close) before = joined(before, constant(total, real(spacing, dp), level))
      before%breaks = before%breaks - (m - 1)*spacing
      curve = joined(before, curve)
    end subroutine place_before
  end subroutine find_chords

  !> Splits the load of pair j at a row into springs.
  pure subroutine split_load(loads, j, row, stiffness, first, step, is_known)
    type(pair_loads_t), intent(in) :: loads
    integer, intent(in) :: j, row
    real(dp), intent(out) :: stiffness(:), first, step(:)  ! as in `find_chords`
    logical, intent(out) :: is_known             ! true if the pair carries
    ! Power of the load in which the deflection is about linear, between those of an even face and of one that touches at a corner.
    real(dp), parameter :: power = 0.7_dp, negligible = 1e-9_dp
    real(dp), dimension(0:size(loads%deflection, 1)) :: x, u
    real(dp), dimension(springs_of_pair) :: length, slope
    real(dp) :: at(0:springs_of_pair), least
    integer :: i, m, n

    least = negligible*maxval(loads%load)
    associate (force => loads%load(:, j, row), most => loads%load(size(u) - 1, j, row), deflection => loads%deflection(:, row))
      stiffness = 0
      step = 0
      first = max(loads%touching(j, row), maxval(deflection, mask=.not. force > least))
      is_known = most > least
      if (.not. is_known) return
      x(0) = first
      u(0) = 0
      n = 0
      do i = 1, size(force)
        if (.not. (force(i) > least .and. deflection(i) > x(n) .and. (force(i)/most)**power > u(n))) cycle
        n = n + 1
        x(n) = deflection(i)
        u(n) = (force(i)/most)**power
      end do
      ! A pair that begins to carry beside others touches later than its gap says, as those deflect the bodies.
      if (n > 1 .and. .not. minval(force) > least) first = max(first, x(1) - u(1)*(x(2) - x(1))/(u(2) - u(1)))
      x(0) = first
      do m = 0, springs_of_pair
        i = min(n - 1, count(u(1:n) <= begins(m)**power))
        at(m) = x(i) + (x(i + 1) - x(i))*(begins(m)**power - u(i))/(u(i + 1) - u(i))
      end do
      length = at(1:) - at(:springs_of_pair - 1)
      slope = most*(begins(1:) - begins(:springs_of_pair - 1))/length
    end associate
    ! Other pairs deflect the bodies too, so that a slope may fall. The nearest slopes that do not fall replace them all.
    ! Source: Barlow et al. 1972, Statistical Inference under Order Restrictions, max-min formula.
    slope = [(maxval([(minval([(dot_product(slope(m:n), length(m:n))/sum(length(m:n)), n=i, springs_of_pair)]), m=1, i)]), &
              i=1, springs_of_pair)]
    stiffness = slope - [0.0_dp, slope(:springs_of_pair - 1)]
    step = length(:springs_of_pair - 1)
  end subroutine split_load

  !> Copies the springs from the nearest place at which a pair carries to the places at which it carries under none of the loads. A
  !> pair without a line of contact keeps its stiffness of 0; one whose line does not touch keeps the deflection at which its first
  !> spring touches.
  pure subroutine fill_gaps(is_known, stiffness, first, step)
    logical, intent(in) :: is_known(:)
    real(dp), intent(inout) :: stiffness(:, :), first(:), step(:, :)
    real(dp), parameter :: far = 1               ! m
    integer :: i, k, near(size(first))

    near = 0
    do i = 1, size(first)
      do k = 0, size(first)
        if (near(i) == 0 .and. i + k <= size(first)) near(i) = merge(i + k, 0, is_known(min(i + k, size(first))))
        if (near(i) == 0 .and. i - k >= 1) near(i) = merge(i - k, 0, is_known(max(i - k, 1)))
      end do
    end do
    do i = 1, size(first)
      if (is_known(i)) cycle
      step(:, i) = step(:, near(i))
      if (first(i) < far) stiffness(:, i) = stiffness(:, near(i))
      if (.not. first(i) < far) first(i) = first(near(i))
    end do
  end subroutine fill_gaps

  !> Curve through values of at least 0 that is nowhere below 0: the square of a spline through their roots, and straight lines to
  !> ends that are 0.
  pure type(piecewise_t) function positive(s, values) result(curve)
    real(dp), intent(in) :: s(:), values(:)
    type(piecewise_t) :: root
    integer :: first, last, i, k, n

    n = size(s)
    first = merge(1, 2, values(1) > 0)
    last = merge(n, n - 1, values(n) > 0)
    if (last > first) then
      root = spline(s(first:last), sqrt(values(first:last)))
      associate (most => ubound(root%coef, 1))
        curve%breaks = root%breaks
        allocate (curve%coef(0:2*most, last - first), source=0.0_dp)
        do k = 0, most
          do i = 0, most
            curve%coef(i + k, :) = curve%coef(i + k, :) + root%coef(i, :)*root%coef(k, :)
          end do
        end do
      end associate
      if (first == 2) curve = joined(spline(s(:2), values(:2)), curve)
    else
      curve = spline(s(:2), values(:2))
      last = 2
    end if
    if (last < n) curve = joined(curve, spline(s(n - 1:), values(n - 1:)))
  end function positive

  !> Sum of two curves with the same breaks.
  pure type(piecewise_t) function sum_of(a, b) result(curve)
    type(piecewise_t), intent(in) :: a, b

    curve%breaks = a%breaks
    allocate (curve%coef(0:max(ubound(a%coef, 1), ubound(b%coef, 1)), size(a%coef, 2)), source=0.0_dp)
    curve%coef(:ubound(a%coef, 1), :) = a%coef
    curve%coef(:ubound(b%coef, 1), :) = curve%coef(:ubound(b%coef, 1), :) + b%coef
  end function sum_of

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
    ! Where the pair does not carry, F/K is not known. There e is that of the nearest place at which the pair carries: towards the
    ! ends of a pair's contact K falls to 0, while e hardly changes.
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
