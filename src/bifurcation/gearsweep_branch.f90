!> A branch of periodic motions over a parameter, followed as a curve in both directions: its points, attracting or not, and
!> what happens at its ends.
module gearsweep_branch
  use, intrinsic :: iso_c_binding, only: c_null_ptr, c_ptr
  use gearsweep_arclength, only: angle_between, correct, tangent_of
  use gearsweep_kinds, only: dp
  use gearsweep_motion_equations, only: factor_of_motion, motion_equations_t, motion_t, width
  use gearsweep_stop, only: wants_stop
  implicit none
  private
  public :: branch_point_t, follow_options_t, curve_t, follow, measure, end_name, end_range, end_closed, end_doubling, end_lost, &
            end_length, end_stopped

  !> How a branch ends.
  integer, parameter :: end_range = 1, end_closed = 2, end_doubling = 3, end_lost = 4, end_length = 5, end_stopped = 6
  character(*), parameter :: names(6) = [character(8) :: 'range', 'closed', 'doubling', 'lost', 'length', 'stopped']

  type :: branch_point_t
    real(dp) :: z(3) = 0                         !< state and parameter, as in gearsweep_motion_equations
    real(dp) :: tangent(3) = 0                   !< direction of the branch there
    real(dp) :: jacobian(2, 3) = 0
    real(dp) :: value = 0                        !< of the parameter
    real(dp) :: dynamic_factor = 0
    real(dp) :: modulus = 0                      !< largest of the Floquet multipliers
    real(dp) :: test(2) = 0                      !< det(M - 1), 0 at folds, and det(M + 1), 0 where the period doubles
    real(dp) :: half(2) = 0                      !< state less that half of the periods later; 0 where these are odd
    integer :: events = 0                        !< changes of contact
    logical :: partial = .false., lost = .false., coast = .false.  !< as in `period_t`
  end type branch_point_t

  type :: follow_options_t
    real(dp) :: longest = 0.05_dp                !< step along the branch: of the parameter's range this over `width`
    real(dp) :: shortest = 2e-6_dp
    integer :: most_points = 5000                !< in each direction
    type(c_ptr) :: stop = c_null_ptr             !< the caller's flag
  end type follow_options_t

  !> Points in the direction in which they were followed.
  type :: curve_t
    type(branch_point_t), allocatable :: point(:)
    integer :: count = 0
    integer :: end = 0                           !< how it ends
  end type curve_t

  !> Largest angle between the tangents of neighbouring points, rad; larger ones only at corners.
  real(dp), parameter :: most_angle = 0.25_dp

contains

  !> The word that stands for an end in tables.
  elemental character(8) function end_name(end)
    integer, intent(in) :: end

    end_name = names(end)
  end function end_name

  !> Follows a branch from a point on it until it ends.
  subroutine follow(equations, start, sense, options, curve)
    class(motion_equations_t), intent(inout) :: equations
    real(dp), intent(in) :: start(3)             !< on the branch
    integer, intent(in) :: sense                 !< 1 or -1: in which direction
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
      call take_step(equations, sense, options, here, step, there, accepted)
      curve%end = end_lost
      if (.not. accepted) exit
      here = there
      call append(here, curve)
      curve%end = how_it_ends(equations, curve)
      if (curve%end > 0) exit
    end do
  end subroutine follow

  !> Does it end at its last point? 0: no.
  integer function how_it_ends(equations, curve) result(end)
    class(motion_equations_t), intent(inout) :: equations
    type(curve_t), intent(in) :: curve

    end = 0
    associate (last => curve%point(curve%count), before => curve%point(curve%count - 1))
      if (.not. (last%z(3) > 0 .and. last%z(3) < width)) end = end_range
      if (dot_product(last%half, before%half) < 0) end = end_doubling
      if (end == 0 .and. curve%count > 3) then
        if (is_back(equations, curve%point(1), before, last)) end = end_closed
      end if
    end associate
  end function how_it_ends

  !> Does the step between two points pass the first one, in the same direction, wherever in its periods that begins?
  logical function is_back(equations, first, before, last)
    class(motion_equations_t), intent(inout) :: equations
    type(branch_point_t), intent(in) :: first, before, last
    type(motion_t) :: motion
    real(dp) :: chord(3), along, at(3), size
    integer :: i
    logical :: ok

    is_back = .false.
    chord = last%z - before%z
    size = norm2(chord)
    if (abs(first%z(3) - last%z(3)) > 2*size) return
    call equations%run_motion(first%z, .false., motion, ok)
    if (.not. ok) return
    do i = 1, equations%periods
      at = [motion%state(:, i), first%z(3)]
      along = dot_product(at - before%z, chord)/size**2
      is_back = along >= 0 .and. along < 1 .and. norm2(at - before%z - along*chord) < 0.2_dp*size .and. &
                (i < equations%periods .or. dot_product(chord, first%tangent) > 0)
      if (is_back) return
    end do
  end function is_back

  !> The next point. The step is halved until the branch bends little over it; at a corner, where it bends at once, it is as
  !> short as allowed.
  subroutine take_step(equations, sense, options, here, step, there, accepted)
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
  end subroutine take_step

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

  !> By longer steps to the next point: over a gap, as where contact begins or ends, the rounding and the error of the steps
  !> change, and with them the motion a little, the more the nearer two branches meet; or, with `turns`, round a corner in which
  !> the branch turns back, so that there is no point ahead. There, the tangent of what lies beyond the corner, oriented as all
  !> others, leads on.
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
      ! In the plane of a corner, there is also the way back.
      if (ok) ok = angle_between(from%tangent, there%tangent) < 1
      if (ok) return
    end do
  end subroutine leap

  !> What is said of a motion, and the direction of its branch.
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
    associate (value => equations%values_at(z))
      point%value = value(1)
    end associate
    found = factor_of_motion(equations%osc, motion)
    point%dynamic_factor = found(1)
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

    ! Room for as many points again.
    if (curve%count == size(curve%point)) curve%point = [curve%point, curve%point]
    curve%count = curve%count + 1
    curve%point(curve%count) = point
  end subroutine append
end module gearsweep_branch
