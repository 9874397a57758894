!> Sub-steps of one step, from one change of contact to the next. Each speed of a batch has its own; their arithmetic
!> is done side by side.
module gearsweep_sub_step
  use gearsweep_contact_set, only: contact_t
  use gearsweep_gauss, only: batch_size, collocate
  use gearsweep_kinds, only: dp
  use gearsweep_nodes, only: nodes
  use gearsweep_oscillator, only: oscillator_t, acceleration, damping, mobility
  use gearsweep_period_map, only: period_map_t
  use gearsweep_quintic, only: quintic
  use gearsweep_shared_compliance, only: reduce_sums, sum_pairs, touching_deflection, working_deflection
  implicit none
  private
  public :: sub_steps_t, event_t, make_sub_steps, enter_step, sum_contacts, take_sub_step, move_end, derivatives, &
            second_derivatives, second_derivatives_of_motion, need_error, own_at_ends, working_at_ends, last

  !> Places in a sub-step at which its coefficients are known: both ends, and the nodes of the integration between.
  real(dp), parameter :: places(5) = [0.0_dp, nodes, 1.0_dp]
  integer, parameter :: last = size(places)
  integer, parameter :: none_yet = -1

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

  !> Own stiffness and profile error within the step are quintics through what the table has at its ends, (0:5, pair) and
  !> (0:5, contact); the mobility is linear, (0:1, pair). Places count from 0 to 1 over the step.
  type :: sub_steps_t
    integer :: step = 0
    real(dp), allocatable :: stiffness(:, :), profile_error(:, :), mobility(:, :)
    !> The deflection x that decides on contact, a quintic too, (0:5, contact): the profile error or, where pairs share a
    !> compliance, what `need_error` makes of it while these others are in contact, as a contact set, (pair).
    real(dp), allocatable :: error(:, :)
    integer, allocatable :: others(:)
    real(dp), dimension(batch_size) :: longest = 1                     !< sub-step that is allowed, part of the step
    type(event_t) :: event(batch_size)
    real(dp), dimension(batch_size) :: left = 0, width = 0             !< begin and length of the sub-step
    !> omega^2 (1/s^2) and sum of k e (m/s^2) of the contacts; (speed, place)
    real(dp), dimension(batch_size, last) :: omega_squared = 0, forcing = 0
    real(dp), dimension(batch_size, 2) :: x = 0, y = 0                 !< state at both ends, m
    real(dp) :: propagator(batch_size, 6) = 0
  end type sub_steps_t

contains

  !> Memory for the sub-steps of one step.
  pure subroutine make_sub_steps(osc, c)
    type(oscillator_t), intent(in) :: osc
    type(sub_steps_t), allocatable, intent(out) :: c

    allocate (c)
    allocate (c%stiffness(0:5, osc%pairs), c%profile_error(0:5, osc%contacts), c%mobility(0:1, osc%pairs))
    allocate (c%error(0:5, osc%contacts), c%others(osc%pairs))
  end subroutine make_sub_steps

  !> The coefficients within a step.
  pure subroutine enter_step(map, step, c)
    type(period_map_t), intent(in) :: map
    integer, intent(in) :: step
    type(sub_steps_t), intent(inout) :: c
    real(dp) :: scale(0:2)
    integer :: j

    c%step = step
    associate (osc => map%osc, table => map%table)
      scale = [1.0_dp, table%width(step), table%width(step)**2]
      do j = 1, table%pairs(step)
        c%stiffness(:, j) = quintic(scale*table%end_stiffness(:, j, 1, step), scale*table%end_stiffness(:, j, 2, step))
        associate (left => osc%intervals(table%interval(step))%place(table%left(step), j), &
                   recess => osc%intervals(table%interval(step))%recess(j))
          c%mobility(0, j) = mobility(osc, left, recess)
          c%mobility(1, j) = mobility(osc, left + table%width(step), recess) - c%mobility(0, j)
        end associate
      end do
      do j = 1, osc%contacts
        c%profile_error(:, j) = 0
        if (j > table%pairs(step) .and. j <= osc%pairs) cycle
        c%profile_error(:, j) = quintic(scale*table%end_profile_error(:, j, 1, step), &
                                        scale*table%end_profile_error(:, j, 2, step))
      end do
      c%error(:, :) = c%profile_error
      c%others(:) = none_yet
      if (osc%damping_ratio > 1) c%longest = longest_sub_step(osc, map%duration*table%width(step))
    end associate
  end subroutine enter_step

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

  !> Sums over the closed contacts at one place of the sub-steps.
  pure subroutine sum_contacts(map, contacts, k, c)
    type(period_map_t), intent(in) :: map
    type(contact_t), intent(in) :: contacts(:)
    integer, intent(in) :: k                     !< which of the places
    type(sub_steps_t), intent(inout) :: c
    real(dp), dimension(batch_size) :: place, omega_squared, forcing
    integer :: j

    place = c%left + c%width*places(k)
    omega_squared = 0
    forcing = 0
    do j = 1, map%table%pairs(c%step)
      call add_pair(map%speeds, c%stiffness(:, j), c%profile_error(:, j), c%mobility(:, j), place, contacts(j)%weight, &
                    omega_squared, forcing)
    end do
    if (map%osc%shared > 0) call share_compliance(map, contacts, place, c, omega_squared, forcing)
    if (map%osc%has_backlash) call add_coast(map, contacts, place, c, omega_squared, forcing)
    c%omega_squared(:, k) = omega_squared
    c%forcing(:, k) = forcing
  end subroutine sum_contacts

  !> Turns the sums over the pairs in contact into those of pairs that share a compliance.
  pure subroutine share_compliance(map, contacts, place, c, omega_squared, forcing)
    type(period_map_t), intent(in) :: map
    type(contact_t), intent(in) :: contacts(:)
    real(dp), intent(in) :: place(batch_size)
    type(sub_steps_t), intent(in) :: c
    real(dp), intent(inout), dimension(batch_size) :: omega_squared, forcing
    real(dp), dimension(batch_size) :: a, b
    integer :: j

    a = 0
    b = 0
    do j = 1, map%table%pairs(c%step)
      call add_pair(map%speeds, c%stiffness(:, j), c%profile_error(:, j), [1.0_dp, 0.0_dp], place, contacts(j)%weight, a, b)
    end do
    call reduce_sums(map%osc%shared, a, b, omega_squared, forcing)
  end subroutine share_compliance

  !> The coast sides, backed by the stiffness of all pairs between A and E.
  pure subroutine add_coast(map, contacts, place, c, omega_squared, forcing)
    type(period_map_t), intent(in) :: map
    type(contact_t), intent(in) :: contacts(:)
    real(dp), intent(in) :: place(batch_size)
    type(sub_steps_t), intent(in) :: c
    real(dp), intent(inout), dimension(batch_size) :: omega_squared, forcing
    real(dp), dimension(batch_size) :: rate, pull
    real(dp) :: slack(0:5)
    integer :: j

    slack = 0
    slack(0) = -map%osc%backlash
    associate (osc => map%osc, coast => contacts(map%osc%contacts)%weight)
      if (osc%shared > 0) then
        rate = 0
        pull = 0
        do j = 1, map%table%pairs(c%step)
          if (.not. btest(map%table%between(c%step), j - 1)) cycle
          call add_pair(map%speeds, c%stiffness(:, j), slack, [1.0_dp, 0.0_dp], place, coast, rate, pull)
        end do
        omega_squared = omega_squared + sum(1/osc%mass)*rate/(1 + osc%shared*rate)
        forcing = forcing + sum(1/osc%mass)*pull/(1 + osc%shared*rate)
      else
        do j = 1, map%table%pairs(c%step)
          if (.not. btest(map%table%between(c%step), j - 1)) cycle
          call add_pair(map%speeds, c%stiffness(:, j), slack, [sum(1/osc%mass), 0.0_dp], place, coast, omega_squared, forcing)
        end do
      end if
    end associate
  end subroutine add_coast

  pure subroutine add_pair(n, stiffness, profile_error, mobility, place, weight, omega_squared, forcing)
    integer, intent(in) :: n
    real(dp), intent(in) :: stiffness(0:5), profile_error(0:5), mobility(0:1)
    real(dp), intent(in), dimension(batch_size) :: place, weight
    real(dp), intent(inout), dimension(batch_size) :: omega_squared, forcing
    real(dp) :: t, k, e, rate
    integer :: l

    associate (s => stiffness, p => profile_error)
      do l = 1, n
        t = place(l)
        k = ((((s(5)*t + s(4))*t + s(3))*t + s(2))*t + s(1))*t + s(0)
        e = ((((p(5)*t + p(4))*t + p(3))*t + p(2))*t + p(1))*t + p(0)
        rate = weight(l)*k*(mobility(0) + mobility(1)*t)
        omega_squared(l) = omega_squared(l) + rate
        forcing(l) = forcing(l) + rate*e
      end do
    end associate
  end subroutine add_pair

  !> The motion over the sub-steps, whose places are set. A sub-step of no length does no harm.
  pure subroutine take_sub_step(map, contacts, c)
    type(period_map_t), intent(in) :: map
    type(contact_t), intent(in) :: contacts(:)
    type(sub_steps_t), intent(inout) :: c
    real(dp), dimension(batch_size, size(nodes)) :: omega_squared, damped, forcing
    real(dp) :: time, width, load, factor, step_width
    integer :: k, l, n

    n = map%speeds
    do k = 1, last
      call sum_contacts(map, contacts, k, c)
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

  !> Second derivatives of x over the sub-step (m) at both ends.
  pure function second_derivatives_of_motion(map, l, c) result(f)
    type(period_map_t), intent(in) :: map
    integer, intent(in) :: l                     !< which speed of the batch
    type(sub_steps_t), intent(in) :: c
    real(dp) :: f(2)

    f(1) = acceleration_at(map, l, 1, c)
    f(2) = acceleration_at(map, l, last, c)
    f = (c%width(l)*map%table%width(c%step))**2*f
  end function second_derivatives_of_motion

  !> Value and first derivative over the sub-step, at both ends, of a quintic over the step; (0:1, end).
  pure function derivatives(c, l, q) result(f)
    type(sub_steps_t), intent(in) :: c
    integer, intent(in) :: l                     !< which speed of the batch
    real(dp), intent(in) :: q(0:5)               !< coefficients
    real(dp) :: f(0:1, 2), t(2)

    ! Written out, as this is asked for every motion at every event.
    t = c%left(l) + [0.0_dp, c%width(l)]
    f(0, :) = ((((q(5)*t + q(4))*t + q(3))*t + q(2))*t + q(1))*t + q(0)
    f(1, :) = (((5*q(5)*t + 4*q(4))*t + 3*q(3))*t + 2*q(2))*t + q(1)
    f(1, :) = f(1, :)*c%width(l)
  end function derivatives

  !> Second derivatives over the sub-step, at both ends, of a quintic over the step.
  pure function second_derivatives(c, l, q) result(f)
    type(sub_steps_t), intent(in) :: c
    integer, intent(in) :: l                     !< which speed of the batch
    real(dp), intent(in) :: q(0:5)               !< coefficients
    real(dp) :: f(2), t(2)

    t = c%left(l) + [0.0_dp, c%width(l)]
    f = (((20*q(5)*t + 12*q(4))*t + 6*q(3))*t + 2*q(2))*c%width(l)**2
  end function second_derivatives

  !> Makes `error` of pair j the deflection at which it touches under a contact set, unless it is. Whether the pair itself is in
  !> contact does not matter.
  pure subroutine need_error(map, contact_set, j, c)
    type(period_map_t), intent(in) :: map
    integer, intent(in) :: contact_set           !< of the motion
    integer, intent(in) :: j
    type(sub_steps_t), intent(inout) :: c
    real(dp), dimension(0:2) :: a, b, scale
    real(dp) :: error(0:2, 2)
    integer :: others, end

    if (.not. map%osc%shared > 0 .or. j > map%osc%pairs) return
    others = ibclr(contact_set, j - 1)
    if (others == c%others(j)) return
    c%others(j) = others
    associate (width => map%table%width(c%step))
      scale = [1.0_dp, width, width**2]
    end associate
    do end = 1, 2
      associate (p => map%table%pairs(c%step), k => map%table%end_stiffness(:, :, end, c%step), &
                 e => map%table%end_profile_error(:, :, end, c%step))
        call sum_pairs(others, k(:, :p), e(:, :p), a, b)
        error(:, end) = touching_deflection(map%osc%shared, a, b, e(:, j))
      end associate
    end do
    c%error(:, j) = quintic(scale*error(:, 1), scale*error(:, 2))
  end subroutine need_error

  !> Own stiffness and profile error of the pairs in contact at both ends of the sub-step of motion l, with their derivatives
  !> over the sub-step; (0:2, pair, end). The second ones only where the path is wanted `bent`.
  pure subroutine own_at_ends(map, l, c, contact_set, bent, stiffness, profile_error)
    type(period_map_t), intent(in) :: map
    integer, intent(in) :: l                     !< which speed of the batch
    type(sub_steps_t), intent(in) :: c
    integer, intent(in) :: contact_set           !< of the motion
    logical, intent(in) :: bent
    real(dp), intent(inout), dimension(0:2, map%osc%pairs, 2) :: stiffness, profile_error    !< N/m, m; of others as they were
    integer :: j

    do j = 1, map%table%pairs(c%step)
      if (.not. btest(contact_set, j - 1)) cycle
      stiffness(:1, j, :) = derivatives(c, l, c%stiffness(:, j))
      profile_error(:1, j, :) = derivatives(c, l, c%profile_error(:, j))
      stiffness(2, j, :) = 0
      profile_error(2, j, :) = 0
      if (.not. bent) cycle
      stiffness(2, j, :) = second_derivatives(c, l, c%stiffness(:, j))
      profile_error(2, j, :) = second_derivatives(c, l, c%profile_error(:, j))
    end do
  end subroutine own_at_ends

  !> What the pairs work on at both ends of the sub-step of motion l (m), with its derivatives over the sub-step: x, less what
  !> they share; (0:2, end). The second derivative only where the path is wanted `bent`.
  pure function working_at_ends(map, l, c, contact_set, own, own_error, bent) result(w)
    type(period_map_t), intent(in) :: map
    integer, intent(in) :: l                     !< which speed of the batch
    type(sub_steps_t), intent(in) :: c
    integer, intent(in) :: contact_set           !< of the motion
    real(dp), intent(in), dimension(0:2, map%osc%pairs, 2) :: own, own_error   !< of `own_at_ends`
    logical, intent(in) :: bent
    real(dp) :: w(0:2, 2), a(0:2), b(0:2)
    integer :: end

    w(0, :) = c%x(l, :)
    w(1, :) = c%width(l)*map%table%width(c%step)*c%y(l, :)
    w(2, :) = 0
    if (bent) w(2, :) = second_derivatives_of_motion(map, l, c)
    if (.not. map%osc%shared > 0) return
    associate (p => map%table%pairs(c%step))
      do end = 1, 2
        call sum_pairs(contact_set, own(:, :p, end), own_error(:, :p, end), a, b)
        w(:, end) = working_deflection(map%osc%shared, a, b, w(:, end))
      end do
    end associate
  end function working_at_ends
end module gearsweep_sub_step
