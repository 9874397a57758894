!> All branches of periodic motions over a range of a parameter that spread starts lead to: from the attracting motions at
!> some values, each followed both ways, and from each place where the period doubles, the motion of twice the period.
module gearsweep_branch_search
  use gearsweep_arclength, only: correct
  use gearsweep_attractor_search, only: attractor_options_t, search_motions
  use gearsweep_branch, only: branch_point_t, curve_t, end_closed, end_doubling, end_stopped, follow, follow_options_t, measure
  use gearsweep_error, only: error_t
  use gearsweep_kinds, only: dp
  use gearsweep_known_motion, only: known_t
  use gearsweep_motion_equations, only: family_t, kind_doubling, make_equations, motion_equations_t, motion_t, width
  use gearsweep_special_points, only: find_specials, special_t
  use gearsweep_status, only: status_ok, status_stopped
  implicit none
  private
  public :: branch_search_options_t, whole_branch_t, find_branches

  type :: branch_search_options_t
    integer :: seeds = 9                         !< values of the parameter at which attracting motions are looked for
    integer :: most_branches = 200
    real(dp) :: angle = 0.2_dp                   !< of the natural motion in a step, rad
    type(follow_options_t) :: follow
    type(attractor_options_t) :: search          !< `most_periods` bounds the branches' periods too
  end type branch_search_options_t

  type :: whole_branch_t
    integer :: periods = 1                       !< mesh periods until its motions repeat
    real(dp) :: scale(2) = 1                     !< of its states, as in the equations, m and m/s
    type(branch_point_t), allocatable :: point(:)  !< from one end to the other
    type(special_t), allocatable :: special(:)   !< in the same order
    integer :: ends(2) = 0                       !< how it ends, as in gearsweep_branch
  end type whole_branch_t

contains

  !> All branches that are found, in the order found. `stopped`: the caller ended the search; `unresolved`: at so many seeds
  !> the speed is too low to be searched.
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
      call equations%need_oscillator(equations%values_at(z), ok)
      associate (duration => family%duration_at(equations%values_at(z)))
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

  !> Adds the branch through a motion, unless it is there.
  subroutine add_from(equations, z, options, branches)
    class(motion_equations_t), intent(inout) :: equations    ! with the motion's periods
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

  !> Newton's method from nearby, in a plane.
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

  !> Is a motion on a branch? Where the branch passes its parameter, Newton's method leads to the branch's motion there, which is
  !> compared with the one at hand wherever in its periods that begins.
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

  !> A branch from a motion on it, with what is special on it.
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

  !> The last point of a curve, which has passed the motion of half the period, becomes that motion where its period doubles.
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

  !> Adds the branches of doubled period of all branches behind the first `done`, of theirs, and so on.
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
        call step_aside(equations, specials(i)%start, z, ok)
        if (ok) call add_from(equations, z, options, branches)
      end do
    end do
  end subroutine add_doubled

  !> Does a branch of twice the period end at this motion?
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

  !> From a motion whose period doubles to one of twice the period nearby: along the direction of the multiplier -1.
  subroutine step_aside(equations, from, z, ok)
    class(motion_equations_t), intent(inout) :: equations    ! of the period before, and then of twice that
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
  end subroutine step_aside
end module gearsweep_branch_search
