!> Where folds, doublings and grazings lie over two parameters: from each of them on a branch, the curve of three equations for
!> state and both parameters, x(nT) = x(0) and the test function that is 0 there, followed as the branches are. At places where
!> test functions jump over 0 instead, as a fold in a corner of a branch, no curve begins.
!> Source: Kuznetsov 2004, Elements of Applied Bifurcation Theory, section 10.3, with pseudo-arclength as in gearsweep_arclength.
module gearsweep_branch_curves
  use gearsweep_arclength, only: angle_between, correct, tangent_of
  use gearsweep_branch, only: end_closed, end_length, end_lost, end_range, end_stopped, follow_options_t
  use gearsweep_branch_search, only: whole_branch_t
  use gearsweep_error, only: error_t
  use gearsweep_kinds, only: dp
  use gearsweep_motion_equations, only: factor_of_motion, family_t, kind_grazing, make_equations, motion_equations_t, motion_t, &
                                        width
  use gearsweep_special_points, only: special_t
  use gearsweep_stop, only: wants_stop
  implicit none
  private
  public :: curve_point_t, special_curve_t, find_curves

  type :: curve_point_t
    real(dp) :: z(4) = 0                         !< state and both parameters, as in gearsweep_motion_equations
    real(dp) :: tangent(4) = 0
    real(dp) :: jacobian(3, 4) = 0
    real(dp) :: value(2) = 0                     !< of the parameters
    real(dp) :: dynamic_factor = 0
    real(dp) :: phase = 0                        !< of the overlap that is 0
  end type curve_point_t

  type :: special_curve_t
    integer :: kind = 0                          !< kind_fold ...
    integer :: periods = 1                       !< mesh periods until its motions repeat
    type(curve_point_t), allocatable :: point(:)
    integer :: ends(2) = 0                       !< how it ends at its first and its last point (end_range ...)
  end type special_curve_t

  !> Largest angle between the tangents of neighbouring points, rad.
  real(dp), parameter :: most_angle = 0.25_dp

contains

  !> All curves through the places on the branches. `second`: the second parameter's value on these.
  subroutine find_curves(family, angle, second, branches, options, curves, stopped)
    class(family_t), intent(in) :: family        !< with both parameters
    real(dp), intent(in) :: angle                !< as in `make_equations`
    real(dp), intent(in) :: second
    type(whole_branch_t), intent(in) :: branches(:)
    type(follow_options_t), intent(in) :: options
    type(special_curve_t), allocatable, intent(out) :: curves(:)
    logical, intent(out) :: stopped
    type(motion_equations_t) :: equations
    type(error_t), allocatable :: error
    integer :: i, k

    allocate (curves(0))
    stopped = .false.
    call make_equations(family, angle, equations, error)
    if (allocated(error)) return
    do i = 1, size(branches)
      equations%periods = branches(i)%periods
      do k = 1, size(branches(i)%special)
        call add_curve(equations, branches(i)%special(k), equations%unknown_of(2, second), &
                       branches(i)%scale/equations%scale, options, curves)
        stopped = wants_stop(options%stop)
        if (stopped) return
      end do
    end do
  end subroutine find_curves

  !> Adds the curve through a place, unless one of those that are there passes it or the place is a corner, where no test
  !> function is 0.
  subroutine add_curve(equations, special, second, rescale, options, curves)
    class(motion_equations_t), intent(inout) :: equations
    type(special_t), intent(in) :: special
    real(dp), intent(in) :: second               ! the unknown of the second parameter
    real(dp), intent(in) :: rescale(2)           ! from the branches' states to the curves'
    type(follow_options_t), intent(in) :: options
    type(special_curve_t), allocatable, intent(inout) :: curves(:)
    type(special_curve_t), allocatable :: longer(:)
    type(curve_point_t), allocatable :: part(:, :)
    type(special_curve_t) :: curve
    type(curve_point_t) :: start
    integer :: count(2), i, way
    logical :: ok

    if (special%kind > kind_grazing .or. special%kind == kind_grazing .and. special%overlap%contact == 0) return
    equations%kind = special%kind
    equations%overlap = special%overlap
    call find_start(equations, [special%start(:2)*rescale, special%start(3), second], start, ok)
    if (.not. ok) return
    do i = 1, size(curves)
      if (curves(i)%kind == equations%kind .and. curves(i)%periods == equations%periods) then
        if (passes(equations, curves(i), start%z)) return
      end if
    end do
    allocate (part(options%most_points, 2))
    count(1) = 1
    do way = 2, 1, -1
      equations%overlap = special%overlap
      call follow_curve(equations, start, 2*way - 3, options, part(:, way), count(way), curve%ends(way))
      if (curve%ends(way) == end_closed) exit
    end do
    curve%kind = equations%kind
    curve%periods = equations%periods
    curve%point = [part(count(1):2:-1, 1), part(:count(2), 2)]
    if (any(curve%ends == end_closed)) then
      curve%ends = end_closed
      curve%point = [curve%point, start]
    end if
    if (size(curve%point) < 2) return
    allocate (longer(size(curves) + 1))
    do i = 1, size(curves)
      longer(i) = curves(i)
    end do
    longer(size(longer)) = curve
    call move_alloc(longer, curves)
  end subroutine add_curve

  !> The place of a branch, as these equations have it.
  subroutine find_start(equations, from, start, ok)
    class(motion_equations_t), intent(inout) :: equations
    real(dp), intent(in) :: from(4)
    type(curve_point_t), intent(out) :: start
    logical, intent(out) :: ok
    real(dp), parameter :: farthest = 1e-3_dp
    real(dp) :: jacobian(3, 4), z(4)

    z = from
    call equations%choose_steps(z, ok)
    if (ok) call equations%differentiate(z, jacobian, ok)
    if (ok) call correct(equations, [0.0_dp, 0.0_dp, 0.0_dp, 1.0_dp], farthest, jacobian, z, ok)
    z(4) = from(4)
    if (ok) call measure_place(equations, z, 1, start, ok)
  end subroutine find_start

  !> Does a curve pass a place, wherever in its periods the motion begins?
  logical function passes(equations, curve, z)
    class(motion_equations_t), intent(inout) :: equations
    type(special_curve_t), intent(in) :: curve
    real(dp), intent(in) :: z(4)
    real(dp), parameter :: near = 0.02_dp
    type(motion_t) :: motion
    real(dp) :: there(4), share
    integer :: i, k
    logical :: ok

    passes = .false.
    call equations%run_motion(z, .false., motion, ok)
    if (.not. ok) return
    do i = 1, size(curve%point) - 1
      associate (a => curve%point(i)%z, b => curve%point(i + 1)%z)
        if ((a(4) - z(4))*(b(4) - z(4)) > 0 .or. .not. abs(b(4) - a(4)) > 0) cycle
        share = (z(4) - a(4))/(b(4) - a(4))
        there = a + share*(b - a)
      end associate
      if (abs(there(3) - z(3)) > near) cycle
      passes = any([(all(abs(motion%state(:, k) - there(:2)) < near), k=1, equations%periods)])
      if (passes) return
    end do
  end function passes

  !> Follows a curve one way until it leaves a range, comes back or is lost.
  subroutine follow_curve(equations, start, sense, options, points, count, end)
    class(motion_equations_t), intent(inout) :: equations
    type(curve_point_t), intent(in) :: start
    integer, intent(in) :: sense
    type(follow_options_t), intent(in) :: options
    type(curve_point_t), intent(inout) :: points(:)
    integer, intent(out) :: count
    integer, intent(out) :: end                  !< end_range ...
    type(curve_point_t) :: here, there
    real(dp) :: step
    logical :: accepted

    here = start
    here%tangent = sense*start%tangent
    points(1) = here
    count = 1
    end = end_length
    step = options%longest/10
    do while (count < size(points))
      if (wants_stop(options%stop)) then
        end = end_stopped
        exit
      end if
      call try_step(equations, sense, here, step, there, accepted)
      if (accepted) accepted = angle_between(here%tangent, there%tangent) < most_angle
      if (.not. accepted) then
        step = step/2
        if (step >= options%shortest) cycle
        end = end_lost
        exit
      end if
      if (angle_between(here%tangent, there%tangent) < most_angle/3) step = min(options%longest, 1.5_dp*step)
      here = there
      equations%overlap%phase = here%phase
      count = count + 1
      points(count) = here
      if (any(here%z(3:) <= 0 .or. here%z(3:) >= width)) then
        end = end_range
      else if (count > 4 .and. norm2(here%z - start%z) < step .and. dot_product(here%tangent, points(1)%tangent) > 0.9_dp) then
        end = end_closed
      else
        cycle
      end if
      exit
    end do
  end subroutine follow_curve

  !> The next point; at the ends of a range, that on it.
  subroutine try_step(equations, sense, here, step, there, ok)
    class(motion_equations_t), intent(inout) :: equations
    integer, intent(in) :: sense
    type(curve_point_t), intent(in) :: here
    real(dp), intent(in) :: step
    type(curve_point_t), intent(out) :: there
    logical, intent(out) :: ok
    real(dp) :: z(4), normal(4), jacobian(3, 4), bound, part
    integer :: i, fixed

    z = here%z + step*here%tangent
    normal = here%tangent
    part = 1
    fixed = 0
    bound = 0
    do i = 3, 4
      if (z(i) >= 0 .and. z(i) <= width) cycle
      associate (share => (merge(0.0_dp, width, z(i) < 0) - here%z(i))/(step*here%tangent(i)))
        if (share >= part) cycle
        part = share
        fixed = i
        bound = merge(0.0_dp, width, z(i) < 0)
      end associate
    end do
    if (fixed > 0) then
      z = here%z + part*step*here%tangent
      z(fixed) = bound
      normal = 0
      normal(fixed) = 1
    end if
    call equations%choose_steps(z, ok)
    if (.not. ok) return
    jacobian = here%jacobian
    call correct(equations, normal, step, jacobian, z, ok)
    if (fixed > 0) z(fixed) = bound
    if (ok) call measure_place(equations, z, sense, there, ok)
  end subroutine try_step

  !> What is said of a place, and the direction of the curve.
  subroutine measure_place(equations, z, sense, point, ok)
    class(motion_equations_t), intent(inout) :: equations
    real(dp), intent(in) :: z(4)
    integer, intent(in) :: sense
    type(curve_point_t), intent(out) :: point
    logical, intent(out) :: ok
    type(motion_t) :: motion
    real(dp) :: found(2), value

    call equations%run_motion(z, equations%kind == kind_grazing, motion, ok)
    if (ok) call equations%special_value(motion, value, ok, point%phase)
    if (.not. ok) return
    point%z = z
    point%value = equations%values_at(z)
    found = factor_of_motion(equations%osc, motion)
    point%dynamic_factor = found(1)
    call equations%differentiate(z, point%jacobian, ok)
    if (ok) point%tangent = sense*tangent_of(point%jacobian)
  end subroutine measure_place
end module gearsweep_branch_curves
