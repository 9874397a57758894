!> All branches of periodic motions over a range of a parameter, and the special points on them.
!>
!> Branches start from the attracting motions at some parameter values, each followed in both directions, and from each period
!> doubling, with the motion of twice the period. Special points are folds (a multiplier passes 1, and the branch turns back over
!> the parameter), doublings (a multiplier passes -1) and grazings (an overlap passes 0, so that a contact begins or ends).
!>
!> Between two neighbouring points of the branch, Newton's method corrects a point on their chord to the branch in the plane normal
!> to the chord. The zero of its test function is bracketed and narrowed by the Illinois method with interposed bisections; if the
!> corrected end points stay apart, as the branch leaves the chord, the search goes on with the chord between them. Changes of
!> contact divide a segment; folds and doublings are searched in each part, and across each change, where a test function may jump
!> across zero. Points that cannot be narrowed are reported with their bracket.
module gearsweep_nonlinear_branch_search
  use gearsweep_base, only: bracket_t, dp, error_t
  use gearsweep_motion, only: attractor_options_t, known_t, largest_multiplier, overlap_t, search_motions, status_ok, &
    status_stopped
  use gearsweep_nonlinear_branch, only: branch_point_t, curve_t, end_closed, end_doubling, end_stopped, follow, follow_options_t, &
    measure
  use gearsweep_nonlinear_motion_equations, only: correct, family_t, kind_doubling, kind_fold, kind_grazing, kind_unknown, &
    kind_vertical, make_equations, motion_equations_t, motion_t, width
  implicit none
  private
  public :: special_t, branch_search_options_t, whole_branch_t, find_branches

  type :: special_t
    integer :: kind = 0
    integer :: after = 0                         !< index of the point of the branch before it
    integer :: until = 0                         !< index of the last point of a vertical part of the branch
    type(branch_point_t) :: point
    type(overlap_t) :: overlap                   !< overlap of a grazing; contact 0: not known
    real(dp) :: enclosed = 0                     !< width of the bracket, in the parameter's unknown
    real(dp) :: start(3) = 0                     !< initial state of `point`, with its parameter: a solution of the equations
  end type special_t

  !> A motion of the branch, with the values compared between motions.
  type :: side_t
    real(dp) :: z(3) = 0
    real(dp) :: test(2) = 0                      !< test functions, as in `branch_point_t`
    real(dp) :: modulus = 0
    integer :: events = 0
    logical :: contact(3) = .false.              !< contact flags: partial, lost, coast
  end type side_t

  !> Segment of the branch over its chord.
  type :: segment_t
    real(dp) :: from(3) = 0, chord(3) = 0, normal(3) = 0, length = 0
    real(dp) :: jacobian(2, 3) = 0
    integer :: kind = 0
    type(side_t) :: begin
    logical :: by_overlap = .false.              !< true: grazing by the overlap `sought`; false: by the changes of contact
    type(overlap_t) :: sought
    real(dp) :: sign = 1                         !< sign that makes the test function positive at the start
  end type segment_t

  !> Part of the chord below which rounding errors dominate.
  real(dp), parameter :: finest = 1e-15_dp
  !> Distance below which two points are the same, in the equations' unknowns: the accuracy of Newton's method.
  real(dp), parameter :: same = 1e-10_dp

  type :: branch_search_options_t
    integer :: seeds = 9                         !< number of parameter values at which attracting motions are searched
    integer :: most_branches = 200
    real(dp) :: angle = 0.2_dp                   !< step, rad of the natural motion
    type(follow_options_t) :: follow
    type(attractor_options_t) :: search  !< options of the search; `most_periods` is also the limit for the branches' periods
  end type branch_search_options_t

  type :: whole_branch_t
    integer :: periods = 1                       !< mesh periods until the motions repeat
    real(dp) :: scale(2) = 1                     !< scales of the states, as in the equations, m and m/s
    type(branch_point_t), allocatable :: point(:)  !< points from one end to the other
    type(special_t), allocatable :: special(:)   !< special points in the same order
    integer :: ends(2) = 0                       !< kinds of the ends, as in gearsweep_nonlinear_branch
  end type whole_branch_t

contains

  !> Appends all special points between two neighbouring points of a branch.
  subroutine find_specials(equations, sense, after, a, b, specials)
    class(motion_equations_t), intent(inout) :: equations
    integer, intent(in) :: sense                 !< direction in which the branch is followed
    integer, intent(in) :: after                 !< index of the point `a`
    type(branch_point_t), intent(in) :: a, b
    type(special_t), allocatable, intent(inout) :: specials(:)
    type(side_t) :: left, right, low, high
    type(overlap_t) :: overlap
    integer :: i
    logical :: ok, goes_on
    integer, parameter :: most = 6               ! most grazings between two points
    real(dp), parameter :: rounding = 1e-6_dp, upright = 1e-8_dp

    call equations%choose_steps(a%z, ok)
    if (.not. ok .or. .not. norm2(b%z - a%z) > 0) return
    left = side_t(a%z, a%test, a%modulus, a%events, [a%partial, a%lost, a%coast])
    right = side_t(b%z, b%test, b%modulus, b%events, [b%partial, b%lost, b%coast])
    ! The branch is vertical: only the motion changes, and a multiplier is 1 throughout. A doubled branch in full contact, where
    ! the period map is linear, is an example.
    if (max(abs(left%test(1)), abs(right%test(1))) < rounding .and. abs(right%z(3) - left%z(3)) < &
        upright*norm2(right%z - left%z)) then
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
      call pass_change(equations, a%jacobian, right, left)
    end do
    if (.not. is_alike(left, right)) call add(equations, sense, after, kind_unknown, left, right, overlap_t(), specials)
    call find_in_part(equations, a%jacobian, sense, after, left, right, specials)
  end subroutine find_specials

  !> True if both motions have the same contact.
  pure logical function is_alike(a, b)
    type(side_t), intent(in) :: a, b

    is_alike = a%events == b%events .and. all(a%contact .eqv. b%contact)
  end function is_alike

  !> Finds folds and doublings between two motions; if only the stability differs, a point of unknown kind.
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

  !> Adds a special point between two motions, with the properties of the second.
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

  !> Moves to a motion just beyond a change of contact, at most to the end of the segment. If Newton's method fails, the motion
  !> remains unchanged.
  subroutine pass_change(equations, jacobian, right, left)
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
  end subroutine pass_change

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

  !> Narrows the bracket of a special point between two motions, on one chord after the other.
  subroutine narrow(equations, jacobian, kind, low, high, overlap)
    class(motion_equations_t), intent(inout) :: equations
    real(dp), intent(in) :: jacobian(2, 3)
    integer, intent(in) :: kind
    type(side_t), intent(inout) :: low, high
    type(overlap_t), intent(out) :: overlap      !< overlap of a grazing; contact 0: not known
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

  !> Narrows the bracket on one chord.
  subroutine narrow_on_chord(equations, segment, low, high)
    class(motion_equations_t), intent(inout) :: equations
    type(segment_t), intent(inout) :: segment
    type(side_t), intent(inout) :: low, high
    integer, parameter :: most = 120, bisections = 8
    !> Other points between the same two, for Newton's method if it fails at the first.
    real(dp), parameter :: parts(*) = [0.25_dp, 0.75_dp, 0.06_dp, 0.94_dp]
    type(side_t) :: middle
    type(motion_t) :: motion
    type(bracket_t) :: place
    real(dp) :: at, now
    integer :: trial, i
    logical :: ok

    place = bracket_t(0.0_dp, 1.0_dp, [1.0_dp, -1.0_dp])
    do trial = 1, most
      at = place%middle()
      if (trial > bisections .and. modulo(trial, 4) /= 0 .and. (segment%kind /= kind_grazing .or. segment%by_overlap)) &
        at = place%chord_zero()
      call side_at(equations, segment, at, middle, motion, now, ok)
      do i = 1, size(parts)
        if (ok) exit
        at = place%low + parts(i)*(place%high - place%low)
        if (at > place%low .and. at < place%high) call side_at(equations, segment, at, middle, motion, now, ok)
      end do
      if (.not. ok) exit
      if (now > 0) then
        low = middle
      else
        high = middle
      end if
      call place%narrow(at, now)
      if (trial == bisections .and. segment%kind == kind_grazing) &
        call choose_overlap(equations, segment, low, high, place%value)
      if (place%high - place%low <= max(finest, 1e-14_dp/segment%length) .or. .not. abs(now) > 1e-15_dp) exit
    end do
  end subroutine narrow_on_chord

  !> Corrects a point on the chord to the branch and returns the test function, with the sign that is positive at the start of the
  !> segment.
  subroutine side_at(equations, segment, place, side, motion, value, ok)
    class(motion_equations_t), intent(inout) :: equations
    type(segment_t), intent(in) :: segment
    real(dp), intent(in) :: place                ! position on the chord, 0 to 1
    type(side_t), intent(inout) :: side          ! unchanged if the correction fails
    type(motion_t), intent(out) :: motion
    real(dp), intent(out) :: value
    logical, intent(out) :: ok
    real(dp) :: jacobian(2, 3), z(3), trace, determinant, distance, best
    real(dp), parameter :: nearby = 0.05_dp
    integer :: i

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
      if (segment%by_overlap) then
        best = nearby
        do i = 1, motion%overlaps%count
          associate (now => motion%overlaps%list(i), sought => segment%sought)
            if (now%contact /= sought%contact .or. now%period /= sought%period .or. (now%at_break .neqv. sought%at_break)) cycle
            distance = abs(now%phase - sought%phase)
            if (distance >= best) cycle
            best = distance
            value = segment%sign*(now%value/equations%scale(1))
          end associate
        end do
      end if
    end if
  end subroutine side_at

  !> Chooses the overlap that passes zero between two motions: among those of one contact with different signs at the two motions,
  !> the one nearest to zero at both.
  subroutine choose_overlap(equations, segment, low, high, value)
    class(motion_equations_t), intent(inout) :: equations
    type(segment_t), intent(inout) :: segment
    type(side_t), intent(in) :: low, high
    real(dp), intent(inout) :: value(2)          ! test function at both motions
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

  !> Finds all branches, in the order of their discovery. `stopped`: the caller ended the search; `unresolved`: number of seeds
  !> whose speed is too low for the search.
  subroutine find_branches(family, options, branches, unresolved, stopped, error)
    class(family_t), intent(in) :: family
    type(branch_search_options_t), intent(in) :: options
    type(whole_branch_t), allocatable, intent(out) :: branches(:)
    integer, intent(out) :: unresolved
    logical, intent(out) :: stopped
    type(error_t), allocatable, intent(out) :: error
    type(motion_equations_t) :: equations
    type(known_t), allocatable :: known(:)
    integer, allocatable :: to(:)
    real(dp) :: z(3)
    integer :: seed, i, status, done
    logical :: ok

    allocate (branches(0))
    unresolved = 0
    stopped = .false.
    call make_equations(family, options%angle, equations, error)
    if (allocated(error)) return
    done = 0
    do seed = 1, options%seeds
      z = [0.0_dp, 0.0_dp, width*(seed - 1)/max(1, options%seeds - 1)]
      if (options%seeds == 1) z(3) = width/2
      call equations%need_oscillator(equations%value_at(z), ok)
      associate (duration => family%duration_at(equations%value_at(z)))
        status = status_stopped
        if (ok) call search_motions(equations%osc, duration, options%search, known, to, status)
        stopped = status == status_stopped
        if (stopped) return
        if (status /= status_ok) unresolved = unresolved + 1
        do i = 1, size(known)
          if (i > 1 .and. .not. known(i)%attracts) cycle
          equations%periods = size(known(i)%state, 2)
          if (equations%periods > options%search%most_periods) cycle
          z(:2) = known(i)%state(:, 1)/(equations%scale*[1.0_dp, duration])
          call correct_at(equations, z, [0.0_dp, 0.0_dp, 1.0_dp], ok)
          if (ok) call add_from(equations, z, options, branches)
          call add_doubled(equations, options, done, branches)
          if (size(branches) > 0) stopped = any(branches(size(branches))%ends == end_stopped)
          if (stopped) return
        end do
      end associate
    end do
  end subroutine find_branches

  !> Adds the branch through a motion, unless it is known.
  subroutine add_from(equations, z, options, branches)
    class(motion_equations_t), intent(inout) :: equations    ! equations with the motion's periods
    real(dp), intent(in) :: z(3)
    type(branch_search_options_t), intent(in) :: options
    type(whole_branch_t), allocatable, intent(inout) :: branches(:)
    type(whole_branch_t), allocatable :: longer(:)
    type(whole_branch_t) :: branch
    integer :: i

    if (size(branches) >= options%most_branches) return
    do i = 1, size(branches)
      if (branches(i)%periods == equations%periods) then
        if (is_on(equations, branches(i), z)) return
      end if
    end do
    call follow_both_ways(equations, z, options, branch)
    if (size(branch%point) < 2) return
    allocate (longer(size(branches) + 1))
    do i = 1, size(branches)
      longer(i) = branches(i)
    end do
    longer(size(longer)) = branch
    call move_alloc(longer, branches)
  end subroutine add_from

  !> Corrects a nearby point by Newton's method, in a plane.
  subroutine correct_at(equations, z, normal, ok)
    class(motion_equations_t), intent(inout) :: equations
    real(dp), intent(inout) :: z(3)
    real(dp), intent(in) :: normal(3)
    logical, intent(out) :: ok
    real(dp), parameter :: farthest = 0.1_dp
    real(dp) :: jacobian(2, 3), parameter_there

    parameter_there = z(3)
    call equations%choose_steps(z, ok)
    if (ok) call equations%differentiate(z, jacobian, ok)
    if (ok) call correct(equations, normal, farthest, jacobian, z, ok)
    if (abs(normal(3)) >= 1) z(3) = parameter_there
  end subroutine correct_at

  !> True if a motion is on a branch. Where the branch passes the motion's parameter, Newton's method finds the branch's motion,
  !> which is compared with it at any shift of the start by mesh periods.
  logical function is_on(equations, branch, z)
    class(motion_equations_t), intent(inout) :: equations
    type(whole_branch_t), intent(in) :: branch
    real(dp), intent(in) :: z(3)
    real(dp), parameter :: same = 1e-5_dp, nearby = 0.3_dp
    type(motion_t) :: motion
    real(dp) :: there(3), share
    integer :: i, k
    logical :: ok

    is_on = .false.
    call equations%run_motion(z, .false., motion, ok)
    if (.not. ok) return
    do i = 1, size(branch%point) - 1
      associate (a => branch%point(i)%z, b => branch%point(i + 1)%z)
        if ((a(3) - z(3))*(b(3) - z(3)) > 0 .or. .not. abs(b(3) - a(3)) > 0) cycle
        share = (z(3) - a(3))/(b(3) - a(3))
        there = a + share*(b - a)
      end associate
      there(3) = z(3)
      if (.not. any(is_near(motion%state, there(:2), nearby))) cycle
      call correct_at(equations, there, [0.0_dp, 0.0_dp, 1.0_dp], ok)
      is_on = ok .and. any([(all(abs(motion%state(:, k) - there(:2)) < same), k=1, equations%periods)])
      if (is_on) return
    end do
  end function is_on

  pure function is_near(states, state, distance) result(near)
    real(dp), intent(in) :: states(:, :), state(2), distance
    logical :: near(size(states, 2))

    near = maxval(abs(states - spread(state, 2, size(states, 2))), 1) < distance
  end function is_near

  !> Follows a branch in both directions from a motion on it, and finds its special points.
  subroutine follow_both_ways(equations, z, options, branch)
    class(motion_equations_t), intent(inout) :: equations
    real(dp), intent(in) :: z(3)
    type(branch_search_options_t), intent(in) :: options
    type(whole_branch_t), intent(out) :: branch
    type(curve_t) :: curve(2)
    integer :: i, n

    branch%periods = equations%periods
    branch%scale = equations%scale
    call follow(equations, z, 1, options%follow, curve(2))
    branch%ends = curve(2)%end
    if (curve(2)%end == end_closed) then
      branch%point = [curve(2)%point(:curve(2)%count - 1), curve(2)%point(1)]
    else
      call follow(equations, z, -1, options%follow, curve(1))
      branch%ends(1) = curve(1)%end
      do i = 1, 2
        if (curve(i)%end == end_doubling) call end_at_doubling(equations, options, curve(i))
      end do
      n = curve(1)%count
      branch%point = [curve(1)%point(n:2:-1), curve(2)%point(:curve(2)%count)]
      do i = 1, n - 1
        branch%point(i)%tangent = -branch%point(i)%tangent
      end do
    end if
    allocate (branch%special(0))
    do i = 1, size(branch%point) - 1
      if (.not. all(abs(branch%point(i + 1)%half) > 0) .and. modulo(branch%periods, 2) == 0) cycle
      if (.not. all(abs(branch%point(i)%half) > 0) .and. modulo(branch%periods, 2) == 0) cycle
      call find_specials(equations, 1, i, branch%point(i), branch%point(i + 1), branch%special)
    end do
  end subroutine follow_both_ways

  !> Replaces the last point of a curve, which has passed a motion of half the period, by that motion, where its period doubles.
  subroutine end_at_doubling(equations, options, curve)
    class(motion_equations_t), intent(inout) :: equations
    type(branch_search_options_t), intent(in) :: options
    type(curve_t), intent(inout) :: curve
    type(special_t), allocatable :: found(:)
    type(follow_options_t) :: short
    type(curve_t) :: half
    type(branch_point_t) :: point
    real(dp) :: z(3)
    integer :: sense, i
    logical :: ok

    associate (n => curve%count)
      z = curve%point(n - 1)%z
      z(:2) = z(:2) - curve%point(n - 1)%half/2
    end associate
    equations%periods = equations%periods/2
    allocate (found(0))
    call correct_at(equations, z, [0.0_dp, 0.0_dp, 1.0_dp], ok)
    short = options%follow
    short%most_points = 40
    short%longest = min(short%longest, norm2(curve%point(curve%count - 1)%half))
    do sense = -1, 1, 2
      if (.not. ok .or. size(found) > 0) exit
      call follow(equations, z, sense, short, half)
      do i = 1, half%count - 1
        if (half%point(i)%test(2)*half%point(i + 1)%test(2) < 0) &
          call find_specials(equations, sense, i, half%point(i), half%point(i + 1), found)
        if (size(found) > 0) exit
      end do
    end do
    equations%periods = 2*equations%periods
    found = pack(found, found%kind == kind_doubling)
    curve%count = curve%count - 1
    if (size(found) == 0) return
    call measure(equations, found(1)%start, 1, point, ok)
    point%half = 0
    if (ok) curve%count = curve%count + 1
    if (ok) curve%point(curve%count) = point
  end subroutine end_at_doubling

  !> Adds the branches of doubled period of all branches after the first `done`, of the added ones, and so on.
  subroutine add_doubled(equations, options, done, branches)
    class(motion_equations_t), intent(inout) :: equations
    type(branch_search_options_t), intent(in) :: options
    integer, intent(inout) :: done
    type(whole_branch_t), allocatable, intent(inout) :: branches(:)
    type(special_t), allocatable :: specials(:)
    real(dp) :: z(3)
    integer :: i
    logical :: ok

    do while (done < size(branches))
      done = done + 1
      if (2*branches(done)%periods > options%search%most_periods) cycle
      if (any(branches(size(branches))%ends == end_stopped)) return
      specials = branches(done)%special
      do i = 1, size(specials)
        if (specials(i)%kind /= kind_doubling) cycle
        equations%periods = branches(done)%periods
        if (is_known(equations, branches, specials(i)%start)) cycle
        call leave_doubling(equations, specials(i)%start, z, ok)
        if (ok) call add_from(equations, z, options, branches)
      end do
    end do
  end subroutine add_doubled

  !> True if a branch of twice the period ends at this motion.
  logical function is_known(equations, branches, z)
    class(motion_equations_t), intent(inout) :: equations
    type(whole_branch_t), intent(in) :: branches(:)
    real(dp), intent(in) :: z(3)
    real(dp), parameter :: same = 1e-5_dp
    type(motion_t) :: motion
    real(dp) :: end(3, 2)
    integer :: i, k
    logical :: ok

    call equations%run_motion(z, .false., motion, ok)
    is_known = .not. ok
    do i = 1, size(branches)
      if (is_known) return
      if (branches(i)%periods /= 2*equations%periods) cycle
      end(:, 1) = branches(i)%point(1)%z
      end(:, 2) = branches(i)%point(size(branches(i)%point))%z
      do k = 1, 2
        if (branches(i)%ends(k) /= end_doubling .or. abs(end(3, k) - z(3)) > same) cycle
        is_known = is_known .or. any(is_near(motion%state, end(:2, k), same))
      end do
    end do
  end function is_known

  !> Finds a motion of twice the period near a doubling, in the direction of the eigenvector of the multiplier -1.
  subroutine leave_doubling(equations, from, z, ok)
    class(motion_equations_t), intent(inout) :: equations    ! equations of the single, then of the double period
    real(dp), intent(in) :: from(3)
    real(dp), intent(out) :: z(3)
    logical, intent(out) :: ok
    real(dp), parameter :: sizes(*) = [0.02_dp, 0.01_dp, 0.005_dp, 0.002_dp, 0.05_dp]
    type(motion_t) :: motion
    real(dp) :: direction(2), other(2)
    integer :: i

    call equations%run_motion(from, .false., motion, ok)
    if (.not. ok) return
    direction = [motion%monodromy(1, 2), -1 - motion%monodromy(1, 1)]
    other = [-1 - motion%monodromy(2, 2), motion%monodromy(2, 1)]
    if (norm2(other) > norm2(direction)) direction = other
    ok = norm2(direction) > 0
    if (.not. ok) return
    direction = direction/norm2(direction)
    equations%periods = 2*equations%periods
    do i = 1, size(sizes)
      z = from + sizes(i)*[direction(1), direction(2), 0.0_dp]
      call correct_at(equations, z, [direction(1), direction(2), 0.0_dp], ok)
      if (ok) call equations%run_motion(z, .false., motion, ok)
      if (ok) ok = norm2(motion%state(:, equations%periods/2) - z(:2)) > sizes(i)/2
      if (ok) return
    end do
  end subroutine leave_doubling
end module gearsweep_nonlinear_branch_search
