!> A branch of periodic motions over a parameter, followed as a curve in both directions: its points, attracting or not, and
!> its ends.
module gearsweep_nonlinear_branch
  use, intrinsic :: iso_c_binding, only: c_null_ptr, c_ptr
  use gearsweep_base, only: dp, wants_stop
  use gearsweep_motion, only: range_of, rms_of
  use gearsweep_nonlinear_motion_equations, only: angle_between, correct, factor_of_motion, motion_equations_t, motion_t, &
    tangent_of, width
  implicit none
  private
  public :: branch_point_t, follow_options_t, curve_t, follow, measure, end_names, end_range, end_closed, end_doubling, end_lost, &
            end_length, end_stopped

  !> Kinds of the end of a branch.
  integer, parameter :: end_range = 1, end_closed = 2, end_doubling = 3, end_lost = 4, end_length = 5, end_stopped = 6
  character(*), parameter :: end_names(6) = [character(8) :: 'range', 'closed', 'doubling', 'lost', 'length', 'stopped']

  type :: branch_point_t
    real(dp) :: z(3) = 0                         !< state and parameter, as in gearsweep_nonlinear_motion_equations
    real(dp) :: tangent(3) = 0                   !< direction of the branch there
    real(dp) :: jacobian(2, 3) = 0
    real(dp) :: value = 0                        !< value of the parameter
    real(dp) :: dynamic_factor = 0
    real(dp) :: dte_rms = 0, dte_range = 0       !< root mean square about the mean, and peak to peak, of the DTE, m
    real(dp) :: modulus = 0                      !< largest of the Floquet multipliers
    real(dp) :: test(2) = 0                      !< det(M - 1), 0 at folds, and det(M + 1), 0 where the period doubles
    real(dp) :: half(2) = 0                      !< state less the state half of the periods later; 0 for an odd number of periods
    integer :: events = 0                        !< changes of contact
    logical :: partial = .false., lost = .false., coast = .false.  !< as in `period_t`
  end type branch_point_t

  type :: follow_options_t
    real(dp) :: longest = 0.05_dp  !< largest step along the branch: that part of the parameter's range is this over `width`
    real(dp) :: shortest = 2e-6_dp
    integer :: most_points = 5000                !< largest number of points in each direction
    type(c_ptr) :: stop = c_null_ptr             !< flag of the caller, which ends the run
  end type follow_options_t

  !> Points in the direction of travel.
  type :: curve_t
    type(branch_point_t), allocatable :: point(:)
    integer :: count = 0
    integer :: end = 0                           !< kind of the end
  end type curve_t

  !> Largest angle between the tangents of neighbouring points, rad; larger ones only at corners.
  real(dp), parameter :: most_angle = 0.25_dp

contains

  !> Follows a branch from a point on it until it ends.
  subroutine follow(equations, start, sense, options, curve)
    class(motion_equations_t), intent(inout) :: equations
    real(dp), intent(in) :: start(3)             !< point on the branch
    integer, intent(in) :: sense                 !< direction, 1 or -1
    type(follow_options_t), intent(in) :: options
    type(curve_t), intent(out) :: curve
    type(branch_point_t) :: here, there
    real(dp) :: step
    logical :: ok, accepted

    allocate (curve%point(64))
    call equations%choose_steps(start, ok)
    if (ok) call measure(equations, start, sense, here, ok)
    curve%end = end_lost
    if (.not. ok) return
    call append(here, curve)
    curve%end = end_range
    if (.not. (start(3) > 0 .or. here%tangent(3) > 0) .or. .not. (start(3) < width .or. here%tangent(3) < 0)) return
    step = options%longest/10
    do
      curve%end = end_length
      if (curve%count >= options%most_points) exit
      curve%end = end_stopped
      if (wants_stop(options%stop)) exit
      call find_next(equations, sense, options, here, step, there, accepted)
      curve%end = end_lost
      if (.not. accepted) exit
      here = there
      call append(here, curve)
      curve%end = 0
      associate (last => curve%point(curve%count), before => curve%point(curve%count - 1))
        if (.not. (last%z(3) > 0 .and. last%z(3) < width)) curve%end = end_range
        if (dot_product(last%half, before%half) < 0) curve%end = end_doubling
        if (curve%end == 0 .and. curve%count > 3) then
          if (is_closed(equations, curve%point(1), before, last)) curve%end = end_closed
        end if
      end associate
      if (curve%end > 0) exit
    end do
  end subroutine follow

  !> True if the step between two points passes the first one, in the same direction, at any shift of the motion's start by mesh
  !> periods.
  logical function is_closed(equations, first, before, last)
    class(motion_equations_t), intent(inout) :: equations
    type(branch_point_t), intent(in) :: first, before, last
    type(motion_t) :: motion
    real(dp) :: chord(3), along, at(3), size
    integer :: i
    logical :: ok

    is_closed = .false.
    chord = last%z - before%z
    size = norm2(chord)
    if (abs(first%z(3) - last%z(3)) > 2*size) return
    call equations%run_motion(first%z, .false., motion, ok)
    if (.not. ok) return
    do i = 1, equations%periods
      at = [motion%state(:, i), first%z(3)]
      along = dot_product(at - before%z, chord)/size**2
      is_closed = along >= 0 .and. along < 1 .and. norm2(at - before%z - along*chord) < 0.2_dp*size .and. &
                (i < equations%periods .or. dot_product(chord, first%tangent) > 0)
      if (is_closed) return
    end do
  end function is_closed

  !> Finds the next point. The step is halved until the branch bends little over it; at a corner, where it bends sharply, it is the
  !> shortest allowed.
  subroutine find_next(equations, sense, options, here, step, there, accepted)
    class(motion_equations_t), intent(inout) :: equations
    integer, intent(in) :: sense
    type(follow_options_t), intent(in) :: options
    type(branch_point_t), intent(in) :: here
    real(dp), intent(inout) :: step
    type(branch_point_t), intent(out) :: there
    logical, intent(out) :: accepted
    real(dp) :: angle

    do
      call try_step(equations, sense, here, here%tangent, step, there, accepted)
      if (accepted) then
        if (dot_product(here%half, there%half) < 0) return
        angle = angle_between(here%tangent, there%tangent)
        if (angle < most_angle/3) step = min(options%longest, 1.5_dp*step)
        if (angle < most_angle .or. step < options%shortest) return
      else if (step < options%shortest) then
        call leap(equations, sense, here, options%shortest, .false., there, accepted)
        if (.not. accepted) call leap(equations, sense, here, options%shortest, .true., there, accepted)
        return
      end if
      step = step/2
    end do
  end subroutine find_next

  !> Predicts along a direction and corrects, at the ends of the range in the plane of constant parameter.
  subroutine try_step(equations, sense, here, direction, step, there, ok)
    class(motion_equations_t), intent(inout) :: equations
    integer, intent(in) :: sense
    type(branch_point_t), intent(in) :: here
    real(dp), intent(in) :: direction(3), step
    type(branch_point_t), intent(out) :: there
    logical, intent(out) :: ok
    real(dp) :: z(3), normal(3), jacobian(2, 3), bound

    z = here%z + step*direction
    normal = direction
    bound = min(max(z(3), 0.0_dp), width)
    if (abs(z(3) - bound) > 0) then
      z = here%z + (bound - here%z(3))/direction(3)*direction
      z(3) = bound
      normal = [0.0_dp, 0.0_dp, 1.0_dp]
    end if
    call equations%choose_steps(z, ok)
    if (.not. ok) return
    jacobian = here%jacobian
    call correct(equations, normal, step, jacobian, z, ok)
    if (abs(normal(3)) >= 1) z(3) = bound
    if (ok) call measure(equations, z, sense, there, ok)
  end subroutine try_step

  !> Finds the next point by longer steps: across a gap, as where contact begins or ends, the rounding and the error of the steps
  !> change, and the motion with them, the more so the nearer two branches meet; or, with `turns`, around a corner at which the
  !> branch turns back, so that there is no point ahead. The tangent beyond the corner, oriented as all others, then gives the
  !> direction.
  subroutine leap(equations, sense, here, shortest, turns, there, ok)
    class(motion_equations_t), intent(inout) :: equations
    integer, intent(in) :: sense
    type(branch_point_t), intent(in) :: here
    real(dp), intent(in) :: shortest
    logical, intent(in) :: turns
    type(branch_point_t), intent(out) :: there
    logical, intent(out) :: ok
    type(branch_point_t) :: from
    real(dp) :: step
    integer :: trial

    from = here
    do trial = 1, merge(5, 7, turns)
      step = 4**trial*shortest
      if (turns) then
        call measure(equations, here%z + step*here%tangent, sense, from, ok)
        if (.not. ok) cycle
        from%z = here%z
      end if
      call try_step(equations, sense, from, from%tangent, step, there, ok)
      ! The plane at a corner also meets the branch that was followed.
      if (ok) ok = angle_between(from%tangent, there%tangent) < 1
      if (ok) return
    end do
  end subroutine leap

  !> Fills in the properties of a motion, and the direction of its branch.
  subroutine measure(equations, z, sense, point, ok)
    class(motion_equations_t), intent(inout) :: equations
    real(dp), intent(in) :: z(3)
    integer, intent(in) :: sense
    type(branch_point_t), intent(out) :: point
    logical, intent(out) :: ok
    type(motion_t) :: motion
    real(dp) :: found(2), trace, determinant

    call equations%run_motion(z, .false., motion, ok)
    if (.not. ok) return
    point%z = z
    point%value = equations%value_at(z)
    found = factor_of_motion(equations%osc, motion)
    point%dynamic_factor = found(1)
    point%dte_rms = rms_of(motion%dte, equations%periods)
    point%dte_range = range_of(motion%dte)
    point%modulus = found(2)
    associate (m => motion%monodromy)
      trace = m(1, 1) + m(2, 2)
      determinant = m(1, 1)*m(2, 2) - m(1, 2)*m(2, 1)
    end associate
    point%test = 1 + determinant + [-trace, trace]
    if (modulo(equations%periods, 2) == 0) point%half = z(:2) - motion%state(:, equations%periods/2)
    point%events = motion%events
    point%partial = motion%partial
    point%lost = motion%lost
    point%coast = motion%coast
    call equations%differentiate(z, point%jacobian, ok)
    if (ok) point%tangent = sense*tangent_of(point%jacobian)
  end subroutine measure

  subroutine append(point, curve)
    type(branch_point_t), intent(in) :: point
    type(curve_t), intent(inout) :: curve

    ! Doubles the list.
    if (curve%count == size(curve%point)) curve%point = [curve%point, curve%point]
    curve%count = curve%count + 1
    curve%point(curve%count) = point
  end subroutine append
end module gearsweep_nonlinear_branch
