!> Where a branch of periodic motions changes its kind: folds (a multiplier passes 1, and the branch turns back over the
!> parameter), doublings (a multiplier passes -1) and grazing (an overlap passes 0, so that a contact begins or ends).
!>
!> Between two neighbouring points of the branch, the point over a place on their chord is found by Newton's method in the
!> plane normal to the chord. The place where a test function of it passes zero is enclosed and narrowed by the Illinois
!> method with bisections between; where the points at both ends stay apart, as the branch leaves the chord, on the chord
!> between these. Changes of contact part a segment, and folds and doublings are looked for in each part, and across each change,
!> where a test function may jump over zero. What cannot be narrowed is told with the enclosure so far.
module gearsweep_special_points
  use gearsweep_arclength, only: correct
  use gearsweep_branch, only: branch_point_t, measure
  use gearsweep_kinds, only: dp
  use gearsweep_motion_equations, only: kind_doubling, kind_fold, kind_grazing, kind_unknown, kind_vertical, motion_equations_t, &
                                        motion_t
  use gearsweep_overlaps, only: overlap_t
  use gearsweep_periodic_orbit, only: largest_multiplier
  implicit none
  private
  public :: special_t, find_specials

  type :: special_t
    integer :: kind = 0
    integer :: after = 0                         !< the point of the branch before it
    integer :: until = 0                         !< where the branch is vertical: the last such point
    type(branch_point_t) :: point
    type(overlap_t) :: overlap                   !< of grazing; contact 0: not known
    real(dp) :: enclosed = 0                     !< the place is known to this, of the parameter's unknown
    real(dp) :: start(3) = 0                     !< of `point`, with its parameter: a solution of the equations
  end type special_t

  !> A motion of the branch, and what is compared of it.
  type :: side_t
    real(dp) :: z(3) = 0
    real(dp) :: test(2) = 0                      !< as in `branch_point_t`
    real(dp) :: modulus = 0
    integer :: events = 0
    logical :: contact(3) = .false.              !< partial, lost, coast
  end type side_t

  !> A segment of the branch over its chord.
  type :: segment_t
    real(dp) :: from(3) = 0, chord(3) = 0, normal(3) = 0, length = 0
    real(dp) :: jacobian(2, 3) = 0
    integer :: kind = 0
    type(side_t) :: begin
    logical :: by_overlap = .false.              !< grazing by the overlap `sought`; otherwise, by the changes of contact
    type(overlap_t) :: sought
    real(dp) :: sign = 1                         !< which makes the test function positive at its begin
  end type segment_t

  !> A part of the chord below which rounding rules.
  real(dp), parameter :: finest = 1e-15_dp
  !> Distance of two points below which they are one, in the equations' unknowns: Newton's method leaves so much.
  real(dp), parameter :: same = 1e-10_dp

contains

  !> All between two neighbouring points of a branch, appended.
  subroutine find_specials(equations, sense, after, a, b, specials)
    class(motion_equations_t), intent(inout) :: equations
    integer, intent(in) :: sense                 !< in which the branch is followed
    integer, intent(in) :: after                 !< which point `a` is
    type(branch_point_t), intent(in) :: a, b
    type(special_t), allocatable, intent(inout) :: specials(:)
    type(side_t) :: left, right, low, high
    type(overlap_t) :: overlap
    integer :: i
    logical :: ok, goes_on
    integer, parameter :: most = 6               ! grazings between two points

    call equations%choose_steps(a%z, ok)
    if (.not. ok .or. .not. norm2(b%z - a%z) > 0) return
    left = side_t(a%z, a%test, a%modulus, a%events, [a%partial, a%lost, a%coast])
    right = side_t(b%z, b%test, b%modulus, b%events, [b%partial, b%lost, b%coast])
    if (is_vertical(left, right)) then
      i = size(specials)
      goes_on = .false.
      if (i > 0) goes_on = specials(i)%until == after
      if (.not. goes_on) call add(equations, sense, after, kind_vertical, left, left, overlap_t(), specials)
      if (size(specials) > 0) specials(size(specials))%until = after + 1
      return
    end if
    do i = 1, most
      if (is_alike(left, right)) exit
      low = left
      high = right
      call narrow(equations, a%jacobian, kind_grazing, low, high, overlap)
      call find_in_part(equations, a%jacobian, sense, after, left, low, specials)
      call add(equations, sense, after, kind_grazing, low, high, overlap, specials)
      call find_in_part(equations, a%jacobian, sense, after, low, high, specials)
      left = high
      call step_beyond(equations, a%jacobian, right, left)
    end do
    if (.not. is_alike(left, right)) call add(equations, sense, after, kind_unknown, left, right, overlap_t(), specials)
    call find_in_part(equations, a%jacobian, sense, after, left, right, specials)
  end subroutine find_specials

  !> Does the branch run along a line on which only the motion changes, and a multiplier is 1 all along? So does a doubled branch
  !> in full contact, where the map is linear.
  pure logical function is_vertical(a, b)
    type(side_t), intent(in) :: a, b
    real(dp), parameter :: rounding = 1e-6_dp, upright = 1e-8_dp

    is_vertical = max(abs(a%test(1)), abs(b%test(1))) < rounding .and. abs(b%z(3) - a%z(3)) < upright*norm2(b%z - a%z)
  end function is_vertical

  !> Is contact the same?
  pure logical function is_alike(a, b)
    type(side_t), intent(in) :: a, b

    is_alike = a%events == b%events .and. all(a%contact .eqv. b%contact)
  end function is_alike

  !> Folds and doublings between two motions; where only the stability differs, that.
  subroutine find_in_part(equations, jacobian, sense, after, a, b, specials)
    class(motion_equations_t), intent(inout) :: equations
    real(dp), intent(in) :: jacobian(2, 3)
    integer, intent(in) :: sense, after
    type(side_t), intent(in) :: a, b
    type(special_t), allocatable, intent(inout) :: specials(:)
    !> A test function below `rounding` has no sign, as at the end of a vertical line.
    real(dp), parameter :: neutral = 1e-6_dp, rounding = 1e-10_dp
    type(side_t) :: low, high
    type(overlap_t) :: overlap
    integer :: kind

    do kind = kind_fold, kind_doubling
      if (.not. a%test(kind)*b%test(kind) < 0 .or. min(abs(a%test(kind)), abs(b%test(kind))) < rounding) cycle
      low = a
      high = b
      call narrow(equations, jacobian, kind, low, high, overlap)
      call add(equations, sense, after, kind, low, high, overlap_t(), specials)
    end do
    if (any(a%test*b%test < 0)) return
    if ((a%modulus - 1)*(b%modulus - 1) < 0 .and. min(abs(a%modulus - 1), abs(b%modulus - 1)) > neutral) &
      call add(equations, sense, after, kind_unknown, a, b, overlap_t(), specials)
  end subroutine find_in_part

  !> A place between two motions, told by the second.
  subroutine add(equations, sense, after, kind, low, high, overlap, specials)
    class(motion_equations_t), intent(inout) :: equations
    integer, intent(in) :: sense, after, kind
    type(side_t), intent(in) :: low, high
    type(overlap_t), intent(in) :: overlap
    type(special_t), allocatable, intent(inout) :: specials(:)
    type(special_t) :: found
    logical :: ok

    found = special_t(kind, after, overlap=overlap, enclosed=norm2(high%z - low%z), start=high%z)
    call measure(equations, found%start, sense, found%point, ok)
    if (ok) specials = [specials, found]
  end subroutine add

  !> A little beyond a change of contact, where that is past for certain; at the end of the segment, its end. Where Newton's method
  !> fails, the motion stays.
  subroutine step_beyond(equations, jacobian, right, left)
    class(motion_equations_t), intent(inout) :: equations
    real(dp), intent(in) :: jacobian(2, 3)
    type(side_t), intent(in) :: right
    type(side_t), intent(inout) :: left
    real(dp), parameter :: steps(*) = [1e-9_dp, 1e-8_dp, 1e-7_dp, 1e-6_dp]
    type(segment_t) :: segment
    type(motion_t) :: motion
    real(dp) :: value
    integer :: i
    logical :: ok

    ok = norm2(right%z - left%z) > 2*maxval(steps)
    if (.not. ok) left = right
    if (.not. ok) return
    segment = segment_between(left, right, kind_fold, jacobian)
    do i = 1, size(steps)
      call side_at(equations, segment, steps(i)/segment%length, left, motion, value, ok)
      if (ok) return
    end do
  end subroutine step_beyond

  pure type(segment_t) function segment_between(low, high, kind, jacobian) result(segment)
    type(side_t), intent(in) :: low, high
    integer, intent(in) :: kind
    real(dp), intent(in) :: jacobian(2, 3)

    segment%from = low%z
    segment%chord = high%z - low%z
    segment%length = norm2(segment%chord)
    segment%normal = segment%chord/segment%length
    segment%jacobian = jacobian
    segment%kind = kind
    segment%begin = low
    if (kind /= kind_grazing) segment%sign = sign(1.0_dp, low%test(kind))
  end function segment_between

  !> Narrows the place of a change between two motions, on one chord after the other.
  subroutine narrow(equations, jacobian, kind, low, high, overlap)
    class(motion_equations_t), intent(inout) :: equations
    real(dp), intent(in) :: jacobian(2, 3)
    integer, intent(in) :: kind
    type(side_t), intent(inout) :: low, high
    type(overlap_t), intent(out) :: overlap      !< of grazing; contact 0: not known
    integer, parameter :: most_chords = 40
    real(dp), parameter :: shrinks = 0.7_dp
    type(segment_t) :: segment
    integer :: chord

    do chord = 1, most_chords
      if (.not. norm2(high%z - low%z) > same) exit
      segment = segment_between(low, high, kind, jacobian)
      call narrow_on_chord(equations, segment, low, high)
      if (segment%by_overlap) overlap = segment%sought
      if (.not. norm2(high%z - low%z) < shrinks*segment%length) exit
    end do
  end subroutine narrow

  !> The same on one chord.
  subroutine narrow_on_chord(equations, segment, low, high)
    class(motion_equations_t), intent(inout) :: equations
    type(segment_t), intent(inout) :: segment
    type(side_t), intent(inout) :: low, high
    integer, parameter :: most = 120, bisections = 8
    type(side_t) :: middle
    type(motion_t) :: motion
    real(dp) :: at, place(2), value(2), now
    integer :: trial, last
    logical :: ok

    place = [0.0_dp, 1.0_dp]
    value = [1.0_dp, -1.0_dp]
    last = 0
    do trial = 1, most
      at = sum(place)/2
      if (trial > bisections .and. modulo(trial, 4) /= 0 .and. (segment%kind /= kind_grazing .or. segment%by_overlap)) &
        at = place(1) + (place(2) - place(1))*value(1)/(value(1) - value(2))
      if (.not. (at > place(1) .and. at < place(2))) at = sum(place)/2
      call try_places(equations, segment, place, at, middle, motion, now, ok)
      if (.not. ok) exit
      if (now > 0) then
        place(1) = at
        value(1) = now
        low = middle
        if (last == 1) value(2) = value(2)/2
        last = 1
      else
        place(2) = at
        value(2) = now
        high = middle
        if (last == 2) value(1) = value(1)/2
        last = 2
      end if
      if (trial == bisections .and. segment%kind == kind_grazing) call choose_overlap(equations, segment, low, high, value)
      if (place(2) - place(1) <= max(finest, 1e-14_dp/segment%length) .or. .not. abs(now) > 1e-15_dp) exit
    end do
  end subroutine narrow_on_chord

  !> The branch over a place on the chord or, where Newton's method fails there, over another between the same two.
  subroutine try_places(equations, segment, between, at, side, motion, value, ok)
    class(motion_equations_t), intent(inout) :: equations
    type(segment_t), intent(in) :: segment
    real(dp), intent(in) :: between(2)
    real(dp), intent(inout) :: at
    type(side_t), intent(out) :: side
    type(motion_t), intent(out) :: motion
    real(dp), intent(out) :: value
    logical, intent(out) :: ok
    real(dp), parameter :: parts(*) = [0.25_dp, 0.75_dp, 0.06_dp, 0.94_dp]
    integer :: i

    call side_at(equations, segment, at, side, motion, value, ok)
    do i = 1, size(parts)
      if (ok) return
      at = between(1) + parts(i)*(between(2) - between(1))
      if (at > between(1) .and. at < between(2)) call side_at(equations, segment, at, side, motion, value, ok)
    end do
  end subroutine try_places

  !> The branch over a place on the chord, and the test function there, positive as at the begin of the segment.
  subroutine side_at(equations, segment, place, side, motion, value, ok)
    class(motion_equations_t), intent(inout) :: equations
    type(segment_t), intent(in) :: segment
    real(dp), intent(in) :: place                ! 0 to 1
    type(side_t), intent(inout) :: side          ! unchanged where that fails
    type(motion_t), intent(out) :: motion
    real(dp), intent(out) :: value
    logical, intent(out) :: ok
    real(dp) :: jacobian(2, 3), z(3), trace, determinant

    z = segment%from + place*segment%chord
    jacobian = segment%jacobian
    value = 0
    call correct(equations, segment%normal, max(segment%length, 1e-9_dp), jacobian, z, ok)
    if (ok) call equations%run_motion(z, segment%kind == kind_grazing, motion, ok)
    if (.not. ok) return
    associate (m => motion%monodromy)
      trace = m(1, 1) + m(2, 2)
      determinant = m(1, 1)*m(2, 2) - m(1, 2)*m(2, 1)
    end associate
    side = side_t(z, 1 + determinant + [-trace, trace], largest_multiplier(motion%monodromy), motion%events, &
                  [motion%partial, motion%lost, motion%coast])
    if (segment%kind /= kind_grazing) then
      value = segment%sign*side%test(segment%kind)
    else
      value = merge(1, -1, is_alike(side, segment%begin))
      if (segment%by_overlap) call value_of_overlap(equations, segment, motion, value)
    end if
  end subroutine side_at

  !> The overlap sought over the static deflection; where it is not found, the value stays.
  subroutine value_of_overlap(equations, segment, motion, value)
    class(motion_equations_t), intent(inout) :: equations
    type(segment_t), intent(in) :: segment
    type(motion_t), intent(in) :: motion
    real(dp), intent(inout) :: value
    real(dp) :: found
    logical :: ok

    equations%kind = segment%kind
    equations%overlap = segment%sought
    call equations%special_value(motion, found, ok)
    equations%kind = 0
    if (ok) value = segment%sign*found
  end subroutine value_of_overlap

  !> The overlap that passes zero between two motions: of those of one contact that have different signs there, the one that is
  !> nearest to zero at both.
  subroutine choose_overlap(equations, segment, low, high, value)
    class(motion_equations_t), intent(inout) :: equations
    type(segment_t), intent(inout) :: segment
    type(side_t), intent(in) :: low, high
    real(dp), intent(inout) :: value(2)          ! of the test function at both
    real(dp), parameter :: nearby = 0.02_dp
    type(motion_t) :: at_low, at_high
    real(dp) :: best, now, found(2)
    integer :: i, k
    logical :: ok

    call equations%run_motion(low%z, .true., at_low, ok)
    if (ok) call equations%run_motion(high%z, .true., at_high, ok)
    if (.not. ok) return
    best = huge(best)
    do i = 1, at_low%overlaps%count
      do k = 1, at_high%overlaps%count
        associate (a => at_low%overlaps%list(i), b => at_high%overlaps%list(k))
          if (a%contact /= b%contact .or. a%period /= b%period .or. (a%at_break .neqv. b%at_break)) cycle
          if (abs(a%phase - b%phase) > nearby .or. .not. a%value*b%value < 0) cycle
          now = abs(a%value) + abs(b%value)
          if (now >= best) cycle
          best = now
          segment%by_overlap = .true.
          segment%sought = b
          segment%sign = sign(1.0_dp, a%value)
          found = abs([a%value, b%value])*[1, -1]/equations%scale(1)
        end associate
      end do
    end do
    if (segment%by_overlap) value = found
  end subroutine choose_overlap
end module gearsweep_special_points
