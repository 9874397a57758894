!> Sub-steps of one step, from one change of contact to the next. Each speed of a batch has its own; their arithmetic
!> is done side by side.
module gearsweep_sub_step
  use gearsweep_gauss, only: batch_size, collocate
  use gearsweep_kinds, only: dp
  use gearsweep_law_curves, only: find_curves, law_curves_t, make_curves
  use gearsweep_nodes, only: nodes
  use gearsweep_oscillator, only: acceleration, damping, oscillator_t
  use gearsweep_period_map, only: period_map_t
  use gearsweep_quintic, only: value_of
  implicit none
  private
  public :: sub_steps_t, event_t, enter_step, need_curves, take_sub_step, move_end, sum_contacts, range_of_motion, &
            motion_over_sub_step, last

  !> Places in a sub-step at which its coefficients are known: both ends, and the nodes of the integration between.
  real(dp), parameter :: places(5) = [0.0_dp, nodes, 1.0_dp]
  integer, parameter :: last = size(places)

  !> The search for changes of contact (events) of one speed in its step.
  type :: event_t
    logical :: active = .false.
    logical :: found = .false.                   !< the contact does change in this step
    integer :: contact = 0                       !< whose event is bracketed; 0: none has been detected
    integer :: trials = 0, events = 0
    real(dp) :: length = 1                       !< of the sub-step in which it was detected, part of the step
    real(dp) :: part = 1, low = 0, high = 1      !< estimate and bracket of the event, parts of this length
    logical :: jumps = .false.                   !< contact has just changed:
    real(dp) :: before = 0                       !< omega^2 before the change, 1/s^2
    real(dp) :: ratio = 0                        !< y over the speed of approach
    real(dp) :: propagator(4) = [1, 0, 0, 1]     !< of the sub-steps so far, columns one after the other
  end type event_t

  !> Places count from 0 to 1 over the step.
  type :: sub_steps_t
    integer :: step = 0
    !> The laws of the contact sets that were met in the step, and which of them holds for each speed.
    type(law_curves_t) :: curves(2*batch_size)
    integer :: curve(batch_size) = 0
    real(dp), dimension(batch_size) :: longest = 1                     !< sub-step that is allowed, part of the step
    type(event_t) :: event(batch_size)
    real(dp), dimension(batch_size) :: left = 0, width = 0             !< begin and length of the sub-step
    !> omega^2 (1/s^2) and sum of k e (m/s^2) of the contacts; (speed, place)
    real(dp), dimension(batch_size, last) :: omega_squared = 0, forcing = 0
    real(dp), dimension(batch_size, 2) :: x = 0, y = 0                 !< state at both ends, m
    real(dp) :: propagator(batch_size, 6) = 0
  end type sub_steps_t

contains

  !> Begins the sub-steps of a step.
  pure subroutine enter_step(map, step, c)
    type(period_map_t), intent(in) :: map
    integer, intent(in) :: step
    type(sub_steps_t), intent(inout) :: c

    c%step = step
    c%curves%contact_set = -1
    c%curve = 0
    if (map%osc%damping_ratio > 1) c%longest = longest_sub_step(map%osc, map%duration*map%table%width(step))
  end subroutine enter_step

  !> The law of a contact set for motion l; there is room for one more than the others have.
  pure subroutine need_curves(map, l, contact_set, c)
    type(period_map_t), intent(inout) :: map
    integer, intent(in) :: l                     !< which speed of the batch
    integer, intent(in) :: contact_set           !< of the motion
    type(sub_steps_t), intent(inout) :: c
    integer :: i, free

    free = 0
    do i = size(c%curves), 1, -1
      if (c%curves(i)%contact_set == contact_set) exit
      if (c%curves(i)%contact_set == -1) free = i
      if (free == 0 .and. .not. any(c%curve == i)) free = i
    end do
    if (i == 0) then
      i = free
      if (.not. allocated(c%curves(i)%effective)) call make_curves(map%osc, c%curves(i))
      call find_curves(map, c%step, contact_set, c%curves(i))
    end if
    c%curve(l) = i
  end subroutine need_curves

  !> The longest sub-step under strong damping, as a part of a step of this time (s). Changes of contact cut the steps
  !> of every refinement level at the same places, so that doubling the steps does not show the error of sub-steps:
  !> where a contact lasts shorter than a step, and damping changes the motion within it, they are made short.
  elemental real(dp) function longest_sub_step(osc, time)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: time
    real(dp), parameter :: decay = 0.05_dp

    longest_sub_step = 1
    if (time > 0) longest_sub_step = min(1.0_dp, decay/(damping(osc, osc%highest_frequency)*time))
  end function longest_sub_step

  !> The motion over the sub-steps, whose places are set. A sub-step of no length does no harm.
  pure subroutine take_sub_step(map, c)
    type(period_map_t), intent(in) :: map
    type(sub_steps_t), intent(inout) :: c
    real(dp), dimension(batch_size, size(nodes)) :: omega_squared, damped, forcing
    real(dp) :: time, width, load, factor, step_width
    integer :: k, l, n

    n = map%speeds
    do k = 1, last
      call sum_contacts(map%speeds, k, c)
    end do
    load = map%osc%load*sum(1/map%osc%mass)
    factor = damping(map%osc, 1.0_dp)
    step_width = map%table%width(c%step)
    do k = 1, size(nodes)
      do l = 1, n
        time = map%duration(l)*(c%width(l)*step_width)
        omega_squared(l, k) = time**2*c%omega_squared(l, k + 1)
        damped(l, k) = factor*time*sqrt(c%omega_squared(l, k + 1))
        forcing(l, k) = time**2*(c%forcing(l, k + 1) + load)
      end do
    end do
    call collocate(n, omega_squared, damped, forcing, c%propagator)
    do l = 1, n
      width = c%width(l)*step_width
      c%propagator(l, 2) = c%propagator(l, 2)/max(width, tiny(width))
      c%propagator(l, 3) = c%propagator(l, 3)*width
      c%propagator(l, 6) = c%propagator(l, 6)/max(width, tiny(width))
      c%x(l, 2) = c%propagator(l, 1)*c%x(l, 1) + c%propagator(l, 3)*c%y(l, 1) + c%propagator(l, 5)
      c%y(l, 2) = c%propagator(l, 2)*c%x(l, 1) + c%propagator(l, 4)*c%y(l, 1) + c%propagator(l, 6)
    end do
  end subroutine take_sub_step

  !> Sums over the closed contacts at one place of the sub-steps.
  pure subroutine sum_contacts(speeds, k, c)
    integer, intent(in) :: speeds                !< of the batch
    integer, intent(in) :: k                     !< which of the places
    type(sub_steps_t), intent(inout) :: c
    real(dp) :: place
    integer :: l

    do l = 1, speeds
      if (c%curve(l) == 0) cycle
      place = c%left(l) + c%width(l)*places(k)
      c%omega_squared(l, k) = value_of(c%curves(c%curve(l))%omega_squared, place)
      c%forcing(l, k) = value_of(c%curves(c%curve(l))%forcing, place)
    end do
  end subroutine sum_contacts

  !> Moves the end of a sub-step by a tiny part of the step, by the Taylor series there.
  pure subroutine move_end(map, l, part, c)
    type(period_map_t), intent(in) :: map
    integer, intent(in) :: l                     !< which speed of the batch
    real(dp), intent(in) :: part                 !< of the step; forwards positive
    type(sub_steps_t), intent(inout) :: c
    real(dp) :: curvature, by, omega_squared, damped

    by = part*map%table%width(c%step)
    curvature = acceleration_at(map, l, last, c)
    c%width(l) = c%width(l) + part
    c%x(l, 2) = c%x(l, 2) + by*(c%y(l, 2) + by/2*curvature)
    c%y(l, 2) = c%y(l, 2) + by*curvature
    omega_squared = map%duration(l)**2*c%omega_squared(l, last)
    damped = damping(map%osc, map%duration(l))*sqrt(c%omega_squared(l, last))
    associate (p => c%propagator)
      p(l, 1:3:2) = p(l, 1:3:2) + by*p(l, 2:4:2)
      p(l, 2:4:2) = p(l, 2:4:2) - by*(omega_squared*p(l, 1:3:2) + damped*p(l, 2:4:2))
    end associate
  end subroutine move_end

  !> Second derivative of x over the phase (m) at the place k, an end of the sub-step.
  pure real(dp) function acceleration_at(map, l, k, c)
    type(period_map_t), intent(in) :: map
    integer, intent(in) :: l, k
    type(sub_steps_t), intent(in) :: c
    integer :: end

    end = merge(1, 2, k == 1)
    acceleration_at = acceleration(map%osc, c%omega_squared(l, k), c%forcing(l, k), map%duration(l), c%x(l, end), c%y(l, end))
  end function acceleration_at

  !> The deflection at both ends of the sub-step of motion l with its derivatives over it, m; (0:2, end).
  pure function motion_over_sub_step(map, l, c) result(x)
    type(period_map_t), intent(in) :: map
    integer, intent(in) :: l                     !< which speed of the batch
    type(sub_steps_t), intent(in) :: c
    real(dp) :: x(0:2, 2)

    associate (width => c%width(l)*map%table%width(c%step))
      x(0, :) = c%x(l, :)
      x(1, :) = width*c%y(l, :)
      x(2, :) = width**2*[acceleration_at(map, l, 1, c), acceleration_at(map, l, last, c)]
    end associate
  end function motion_over_sub_step

  !> What x (m) stays above and below over the sub-step of motion l: a convex curve stays above its tangents, a concave one below.
  pure function range_of_motion(map, l, c) result(range)
    type(period_map_t), intent(in) :: map
    integer, intent(in) :: l                     !< which speed of the batch
    type(sub_steps_t), intent(in) :: c
    real(dp) :: range(2), turn

    turn = (abs(c%y(l, 1)) + abs(c%y(l, 2)))*c%width(l)*map%table%width(c%step)/4
    range = [min(c%x(l, 1), c%x(l, 2)) - turn, max(c%x(l, 1), c%x(l, 2)) + turn]
  end function range_of_motion
end module gearsweep_sub_step
