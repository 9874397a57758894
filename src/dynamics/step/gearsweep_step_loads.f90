!> Motion and loads at both ends of a step or sub-step, with first and second derivative over it: what a quintic takes.
!> The loads are those of the pairs and, as the last contact and only with backlash, of the coast sides.
module gearsweep_step_loads
  use gearsweep_coefficients, only: coefficients_t
  use gearsweep_coupled_pairs, only: compliances, respond
  use gearsweep_kinds, only: dp
  use gearsweep_load_peaks, only: cubic_curvature, may_exceed, raise_to_maximum, turns_too_far
  use gearsweep_oscillator, only: oscillator_t
  use gearsweep_period_map, only: period_map_t
  use gearsweep_step_ends, only: coast_stiffness, coast_stiffness_at_end, deflection_at_end, end_acceleration
  use gearsweep_sub_step, only: derivatives, own_at_ends, second_derivatives, second_derivatives_of_motion, working_at_ends
  use gearsweep_sub_steps, only: sub_steps_t
  implicit none
  private
  public :: loads_over_step, loads_over_sub_step, raise_coast_over_step, raise_coast_over_sub_step

contains

  !> Over a step in which the contact set stays as it is.
  pure subroutine loads_over_step(osc, table, step, contact_set, duration, state, x, load)
    type(oscillator_t), intent(in) :: osc
    type(coefficients_t), intent(in) :: table
    integer, intent(in) :: step, contact_set
    real(dp), intent(in) :: duration             !< of the mesh period, s
    real(dp), intent(in) :: state(2, 2)          !< x and its derivative over the phase (m) at both ends; (x or y, end)
    real(dp), intent(out) :: x(0:2, 2)           !< m; (derivative, end)
    real(dp), intent(out) :: load(0:2, osc%contacts, 2)      !< N; (derivative, contact, end)
    real(dp) :: gap(0:2), scale(0:2)
    integer :: end, j

    associate (width => table%width(step))
      scale = [1.0_dp, width, width**2]
      do end = 1, 2
        x(:1, end) = state(:, end)
        x(2, end) = end_acceleration(osc, table, step, end, contact_set, duration, state(:, end))
      end do
      if (turns_too_far(table, step, duration)) x(2, :) = cubic_curvature(x(0, :), width*x(1, :))/width**2
      load = 0
      do end = 1, 2
        do j = 1, table%pairs(step)
          if (.not. btest(contact_set, j - 1)) cycle
          gap = deflection_at_end(osc, table, step, end, contact_set, j, x(:, end)) - table%end_profile_error(:, j, end, step)
          load(:, j, end) = product_of(scale*table%end_stiffness(:, j, end, step), scale*gap)
        end do
        x(:, end) = scale*x(:, end)
        if (touches_coast(osc, contact_set)) load(:, osc%contacts, end) = coast_load(osc, &
          scale*coast_stiffness_at_end(osc, table, step, end), x(:, end))
      end do
    end associate
  end subroutine loads_over_step

  !> Over the sub-step of one motion of a batch.
  pure subroutine loads_over_sub_step(map, l, c, contact_set, x, load)
    type(period_map_t), intent(in) :: map
    integer, intent(in) :: l                     !< which speed of the batch
    type(sub_steps_t), intent(in) :: c
    integer, intent(in) :: contact_set           !< of the motion
    real(dp), intent(out) :: x(0:2, 2)           !< m; (derivative, end)
    real(dp), intent(out) :: load(0:2, map%osc%contacts, 2)  !< N; (derivative, contact, end)
    real(dp), dimension(0:2, map%osc%pairs, 2) :: k, e, w
    integer :: end, j

    call own_at_ends(map, l, c, contact_set, .true., k, e)
    w = working_at_ends(map, l, c, contact_set, k, e, .true.)
    call motion_over_sub_step(map, l, c, x)
    load = 0
    do j = 1, map%table%pairs(c%step)
      if (.not. btest(contact_set, j - 1)) cycle
      do end = 1, 2
        load(:, j, end) = product_of(k(:, j, end), w(:, j, end) - e(:, j, end))
      end do
    end do
    if (touches_coast(map%osc, contact_set)) load(:, map%osc%contacts, :) = coast_load_over_sub_step(map, l, c, x)
  end subroutine loads_over_sub_step

  !> Raises the largest load on the coast sides by that over a step, where they are in contact.
  pure subroutine raise_coast_over_step(osc, table, step, contact_set, duration, state, peak)
    type(oscillator_t), intent(in) :: osc
    type(coefficients_t), intent(in) :: table
    integer, intent(in) :: step, contact_set
    real(dp), intent(in) :: duration             !< of the mesh period, s
    real(dp), intent(in) :: state(2, 2)          !< x and its derivative over the phase (m) at both ends; (x or y, end)
    real(dp), intent(inout) :: peak              !< largest load so far, N
    real(dp) :: x(0:2, 2), load(0:2, osc%contacts, 2), coast(0:2, 2)

    if (.not. touches_coast(osc, contact_set)) return
    call loads_over_step(osc, table, step, contact_set, duration, state, x, load)
    coast = load(:, osc%contacts, :)
    call raise(coast, peak)
  end subroutine raise_coast_over_step

  !> The same over a sub-step.
  pure subroutine raise_coast_over_sub_step(map, l, c, contact_set, peak)
    type(period_map_t), intent(in) :: map
    integer, intent(in) :: l                     !< which speed of the batch
    type(sub_steps_t), intent(in) :: c
    integer, intent(in) :: contact_set           !< of the motion
    real(dp), intent(inout) :: peak              !< largest load so far, N
    real(dp) :: x(0:2, 2)

    if (.not. touches_coast(map%osc, contact_set)) return
    call motion_over_sub_step(map, l, c, x)
    call raise(coast_load_over_sub_step(map, l, c, x), peak)
  end subroutine raise_coast_over_sub_step

  pure subroutine raise(load, peak)
    real(dp), intent(in) :: load(0:2, 2)
    real(dp), intent(inout) :: peak

    peak = max(peak, load(0, 1), load(0, 2))
    if (may_exceed(load, peak)) call raise_to_maximum(load, peak)
  end subroutine raise

  pure logical function touches_coast(osc, contact_set)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: contact_set

    touches_coast = osc%has_backlash
    if (touches_coast) touches_coast = btest(contact_set, osc%contacts - 1)
  end function touches_coast

  pure subroutine motion_over_sub_step(map, l, c, x)
    type(period_map_t), intent(in) :: map
    integer, intent(in) :: l
    type(sub_steps_t), intent(in) :: c
    real(dp), intent(out) :: x(0:2, 2)

    x(0, :) = c%x(l, :)
    x(1, :) = c%width(l)*map%table%width(c%step)*c%y(l, :)
    x(2, :) = second_derivatives_of_motion(map, l, c)
  end subroutine motion_over_sub_step

  !> The load on the coast sides at both ends of a sub-step in which they are in contact (N), (derivative, end).
  pure function coast_load_over_sub_step(map, l, c, x) result(load)
    type(period_map_t), intent(in) :: map
    integer, intent(in) :: l
    type(sub_steps_t), intent(in) :: c
    real(dp), intent(in) :: x(0:2, 2)
    real(dp) :: load(0:2, 2), shared(0:2, size(c%shared, 2), 2)
    real(dp), dimension(0:2, map%osc%pairs, 2) :: own, error
    real(dp), dimension(0:2, map%table%pairs(c%step)) :: g, h
    real(dp) :: stiffness(0:2)
    integer :: end, j

    own = 0
    error = 0
    shared = 0
    associate (p => map%table%pairs(c%step), between => map%table%between(c%step))
      call own_at_ends(map, l, c, between, .true., own, error)
      do j = 1, merge(max(1, p - 1), 0, map%osc%shared > 0)
        shared(:1, j, :) = derivatives(c, l, [c%shared(:, j), 0.0_dp, 0.0_dp, 0.0_dp])
        shared(2, j, :) = second_derivatives(c, l, [c%shared(:, j), 0.0_dp, 0.0_dp, 0.0_dp])
      end do
      do end = 1, 2
        if (map%table%coupled(c%step)) then
          call respond(between, compliances(own(:, :p, end), shared(:, :p - 1, end), map%osc%mesh%disc%shared_beyond()), &
                       error(:, :p, end), g, h)
          stiffness = sum(g, 2)
        else
          stiffness = coast_stiffness(shared(:, 1, end), sum(own(:, :p, end), 2))
        end if
        load(:, end) = coast_load(map%osc, stiffness, x(:, end))
      end do
    end associate
  end function coast_load_over_sub_step

  pure function coast_load(osc, stiffness, x) result(load)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: stiffness(0:2), x(0:2)
    real(dp) :: load(0:2)

    load = product_of(stiffness, [-osc%backlash - x(0), -x(1), -x(2)])
  end function coast_load

  !> A product with its first and second derivative.
  pure function product_of(a, b) result(c)
    real(dp), intent(in) :: a(0:2), b(0:2)
    real(dp) :: c(0:2)

    c = [a(0)*b(0), a(1)*b(0) + a(0)*b(1), a(2)*b(0) + 2*a(1)*b(1) + a(0)*b(2)]
  end function product_of
end module gearsweep_step_loads
