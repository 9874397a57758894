!> Sub-steps of one step, from one change of contact to the next. Each speed of a batch has its own; their arithmetic
!> is done side by side.
module gearsweep_sub_step
  use gearsweep_contact_set, only: contact_t
  use gearsweep_coupled_pairs, only: compliances, left_for, respond
  use gearsweep_gauss, only: collocate, batch_size
  use gearsweep_kinds, only: dp
  use gearsweep_nodes, only: nodes
  use gearsweep_oscillator, only: acceleration, damping
  use gearsweep_period_map, only: period_map_t
  use gearsweep_quintic, only: bounds_of, quintic
  use gearsweep_shared_coefficients, only: touching_at_end
  use gearsweep_shared_compliance, only: sum_pairs, touching_deflection, working_deflection
  use gearsweep_sub_step_sums, only: sum_contacts
  use gearsweep_sub_steps, only: event_t, last, sub_steps_t
  implicit none
  private
  public :: take_sub_step, move_end, range_of_motion, derivatives, second_derivatives, second_derivatives_of_motion, need_error, &
            own_at_ends, working_at_ends

contains

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

  !> What x (m) stays above and below over the sub-step of motion l: a convex curve stays above its tangents, a concave one below.
  pure function range_of_motion(map, l, c) result(range)
    type(period_map_t), intent(in) :: map
    integer, intent(in) :: l                     !< which speed of the batch
    type(sub_steps_t), intent(in) :: c
    real(dp) :: range(2), turn

    turn = (abs(c%y(l, 1)) + abs(c%y(l, 2)))*c%width(l)*map%table%width(c%step)/4
    range = [min(c%x(l, 1), c%x(l, 2)) - turn, max(c%x(l, 1), c%x(l, 2)) + turn]
  end function range_of_motion

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
        if (map%table%coupled(c%step)) then
          error(:, end) = touching_at_end(map%osc, map%table, c%step, end, ibits(others, 0, p), j)
        else
          call sum_pairs(others, k(:, :p), e(:, :p), a, b)
          error(:, end) = touching_deflection(map%table%end_shared(:, 1, end, c%step), a, b, e(:, j))
        end if
      end associate
    end do
    c%error(:, j) = quintic(scale*error(:, 1), scale*error(:, 2))
    c%error_bounds(:, j) = bounds_of(c%error(:, j))
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

  !> What each pair works on at both ends of the sub-step of motion l (m), with its derivatives over the sub-step: x, less what
  !> the pairs share; (0:2, pair, end). The second derivative only where the path is wanted `bent`.
  pure function working_at_ends(map, l, c, contact_set, own, own_error, bent) result(working)
    type(period_map_t), intent(in) :: map
    integer, intent(in) :: l                     !< which speed of the batch
    type(sub_steps_t), intent(in) :: c
    integer, intent(in) :: contact_set           !< of the motion
    real(dp), intent(in), dimension(0:2, map%osc%pairs, 2) :: own, own_error   !< of `own_at_ends`
    logical, intent(in) :: bent
    real(dp) :: working(0:2, map%osc%pairs, 2), w(0:2, 2), shared(0:2, 2), a(0:2), b(0:2)
    integer :: end, j

    w(0, :) = c%x(l, :)
    w(1, :) = c%width(l)*map%table%width(c%step)*c%y(l, :)
    w(2, :) = 0
    if (bent) w(2, :) = second_derivatives_of_motion(map, l, c)
    if (map%table%coupled(c%step)) then
      working = coupled_at_ends(map, l, c, contact_set, own, own_error, w)
      return
    end if
    if (map%osc%shared > 0) then
      shared = shared_at_ends(c, l, 1)
      do end = 1, 2
        associate (p => map%table%pairs(c%step))
          call sum_pairs(contact_set, own(:, :p, end), own_error(:, :p, end), a, b)
        end associate
        w(:, end) = working_deflection(shared(:, end), a, b, w(:, end))
      end do
    end if
    do j = 1, map%table%pairs(c%step)
      working(:, j, :) = w
    end do
  end function working_at_ends

  !> What pair j and the next one share at both ends of the sub-step of motion l (m/N), with its derivatives over the sub-step;
  !> (0:2, end).
  pure function shared_at_ends(c, l, j) result(shared)
    type(sub_steps_t), intent(in) :: c
    integer, intent(in) :: l, j
    real(dp) :: shared(0:2, 2), t(2)

    associate (q0 => c%shared(0, j), q1 => c%shared(1, j), q2 => c%shared(2, j), width => c%width(l))
      t = c%left(l) + [0.0_dp, width]
      shared(0, :) = (q2*t + q1)*t + q0
      shared(1, :) = (2*q2*t + q1)*width
      shared(2, :) = 2*q2*width**2
    end associate
  end function shared_at_ends

  !> What each of coupled pairs works on, from the deflection x (m) at both ends.
  pure function coupled_at_ends(map, l, sub, contact_set, own, own_error, x) result(w)
    type(period_map_t), intent(in) :: map
    integer, intent(in) :: l
    type(sub_steps_t), intent(in) :: sub
    integer, intent(in) :: contact_set
    real(dp), intent(in), dimension(0:, :, :) :: own, own_error    !< of `own_at_ends`
    real(dp), intent(in) :: x(0:2, 2)
    real(dp) :: w(0:2, size(own, 2), 2)
    real(dp) :: c(0:2, map%table%pairs(sub%step), map%table%pairs(sub%step))
    real(dp), dimension(0:2, map%table%pairs(sub%step)) :: k, e, g, h
    real(dp) :: shared(0:2, map%table%pairs(sub%step) - 1, 2)
    integer :: end, j, p

    p = map%table%pairs(sub%step)
    do j = 1, p - 1
      shared(:, j, :) = shared_at_ends(sub, l, j)
    end do
    w = 0
    k = 0
    e = 0
    do end = 1, 2
      do j = 1, p
        if (.not. btest(contact_set, j - 1)) cycle
        k(:, j) = own(:, j, end)
        e(:, j) = own_error(:, j, end)
      end do
      c = compliances(k, shared(:, :, end), map%osc%mesh%disc%shared_beyond())
      call respond(ibits(contact_set, 0, p), c, e, g, h)
      do j = 1, p
        w(:, j, end) = left_for(j, c, g, h, x(:, end))
      end do
    end do
  end function coupled_at_ends
end module gearsweep_sub_step
