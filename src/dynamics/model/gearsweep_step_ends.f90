!> Pairs and motion at both ends of a step, where the table has stiffness and profile error with their derivatives.
module gearsweep_step_ends
  use gearsweep_coefficients, only: coefficients_t
  use gearsweep_coupled_pairs, only: closed_set, compliances, left_for, sum_response
  use gearsweep_kinds, only: dp
  use gearsweep_mesh, only: coupling
  use gearsweep_oscillator, only: acceleration, oscillator_t
  use gearsweep_shared_coefficients, only: respond_at_end
  use gearsweep_shared_compliance, only: closed_pairs, reduce_sums, sum_pairs, working_deflection
  implicit none
  private
  public :: contact_sets_at_begin, end_acceleration, deflection_at_end, coast_stiffness, coast_stiffness_at_end

contains

  !> What pair j works on at an end of a step, with its derivatives over the phase: x, less what the pairs share.
  pure function deflection_at_end(osc, table, step, end, contact_set, j, x) result(w)
    type(oscillator_t), intent(in) :: osc
    type(coefficients_t), intent(in) :: table
    integer, intent(in) :: step, end           !< which step; 1 its begin, 2 its end
    integer, intent(in) :: contact_set         !< bit j - 1: pair j is in contact
    integer, intent(in) :: j
    real(dp), intent(in) :: x(0:2)             !< with its derivatives over the phase, m
    real(dp) :: w(0:2), a(0:2), b(0:2)
    real(dp) :: c(0:2, table%pairs(step), table%pairs(step))
    real(dp), dimension(0:2, table%pairs(step)) :: g, h

    w = x
    if (.not. osc%shared > 0) return
    if (table%coupled(step)) then
      call respond_at_end(osc, table, step, end, contact_set, c, g, h)
      w = left_for(j, c, g, h, x)
      return
    end if
    associate (p => table%pairs(step))
      call sum_pairs(contact_set, table%end_stiffness(:, :p, end, step), table%end_profile_error(:, :p, end, step), a, b)
    end associate
    w = working_deflection(table%end_shared(:, 1, end, step), a, b, x)
  end function deflection_at_end

  !> Second derivative of x over the phase (m) at an end of a step.
  pure real(dp) function end_acceleration(osc, table, step, end, contact_set, duration, state)
    type(oscillator_t), intent(in) :: osc
    type(coefficients_t), intent(in) :: table
    integer, intent(in) :: step, end           !< which step; 1 its begin, 2 its end
    integer, intent(in) :: contact_set         !< bit j - 1: pair j is in contact
    real(dp), intent(in) :: duration           !< of the mesh period, s
    real(dp), intent(in) :: state(2)           !< x and its derivative over the phase there, m
    real(dp) :: omega_squared, forcing, coast(0:2)

    if (table%coupled(step)) then
      associate (p => table%pairs(step), k => table%end_stiffness(0, :, end, step))
        call sum_response(contact_set, coupling(osc%mesh, k(:p), table%end_shared(0, :p - 1, end, step)), &
                          table%end_profile_error(0, :p, end, step), table%end_rate(:p, end, step)/k(:p), omega_squared, forcing)
      end associate
    else
      call sum_apart(osc, table, step, end, contact_set, omega_squared, forcing)
    end if
    if (osc%has_backlash .and. btest(contact_set, osc%contacts - 1)) then
      coast = sum(1/osc%mass)*coast_stiffness_at_end(osc, table, step, end)
      omega_squared = omega_squared + coast(0)
      forcing = forcing - coast(0)*osc%backlash
    end if
    end_acceleration = acceleration(osc, omega_squared, forcing, duration, state(1), state(2))
  end function end_acceleration

  !> Sums of omega^2 (1/s^2) and k e (m/s^2) over pairs that are not coupled.
  pure subroutine sum_apart(osc, table, step, end, contact_set, omega_squared, forcing)
    type(oscillator_t), intent(in) :: osc
    type(coefficients_t), intent(in) :: table
    integer, intent(in) :: step, end, contact_set
    real(dp), intent(out) :: omega_squared, forcing
    real(dp) :: a, b
    integer :: j

    omega_squared = 0
    forcing = 0
    a = 0
    b = 0
    do j = 1, table%pairs(step)
      if (.not. btest(contact_set, j - 1)) cycle
      associate (k => table%end_stiffness(0, j, end, step), e => table%end_profile_error(0, j, end, step))
        a = a + k
        b = b + k*e
        omega_squared = omega_squared + table%end_rate(j, end, step)
        forcing = forcing + table%end_rate(j, end, step)*e
      end associate
    end do
    if (osc%shared > 0) call reduce_sums(table%end_shared(0, 1, end, step), a, b, omega_squared, forcing)
  end subroutine sum_apart

  !> Stiffness of the coast sides at an end of a step, with its derivatives over the phase (N/m).
  pure function coast_stiffness_at_end(osc, table, step, end) result(k)
    type(oscillator_t), intent(in) :: osc
    type(coefficients_t), intent(in) :: table
    integer, intent(in) :: step, end           !< which step; 1 its begin, 2 its end
    real(dp) :: k(0:2), shared(0:2), c(0:2, table%pairs(step), table%pairs(step))
    real(dp), dimension(0:2, table%pairs(step)) :: g, h
    integer :: j

    if (table%coupled(step)) then
      call respond_at_end(osc, table, step, end, table%between(step), c, g, h)
      k = sum(g, 2)
      return
    end if
    k = 0
    do j = 1, table%pairs(step)
      if (btest(table%between(step), j - 1)) k = k + table%end_stiffness(:, j, end, step)
    end do
    shared = 0
    if (osc%shared > 0) shared = table%end_shared(:, 1, end, step)
    k = coast_stiffness(shared, k)
  end function coast_stiffness_at_end

  !> Stiffness of the coast sides, with its derivatives: that of all pairs between A and E together, as these share a compliance.
  pure function coast_stiffness(shared, own) result(k)
    real(dp), intent(in) :: shared(0:2)        !< compliance, with its derivatives, m/N
    real(dp), intent(in) :: own(0:2)           !< sum of their own stiffness, with its derivatives, N/m
    real(dp) :: k(0:2), d(0:2)

    d = [1 + shared(0)*own(0), shared(1)*own(0) + shared(0)*own(1), &
         shared(2)*own(0) + 2*shared(1)*own(1) + shared(0)*own(2)]
    k(0) = own(0)/d(0)
    k(1) = (own(1) - k(0)*d(1))/d(0)
    k(2) = (own(2) - 2*k(1)*d(1) - k(0)*d(2))/d(0)
  end function coast_stiffness

  !> The contact sets of a batch at the begin of a step; where they are held, that of full contact.
  pure subroutine contact_sets_at_begin(osc, table, step, x, held, contact_set)
    type(oscillator_t), intent(in) :: osc
    type(coefficients_t), intent(in) :: table
    integer, intent(in) :: step                !< which
    real(dp), intent(in) :: x(:)               !< m; (speed)
    logical, intent(in) :: held(:)             !< (speed)
    integer, intent(out) :: contact_set(:)     !< (speed)
    real(dp), dimension(size(x)) :: w
    real(dp) :: a, b, c
    integer :: j, l

    associate (p => table%pairs(step), k => table%end_stiffness(0, :, 1, step), e => table%end_profile_error(0, :, 1, step))
      contact_set = 0
      if (table%coupled(step)) then
        do l = 1, size(x)
          contact_set(l) = closed_set(compliances(table%end_stiffness(:, :p, 1, step), table%end_shared(:, :p - 1, 1, step), &
                                                  osc%mesh%disc%shared_beyond()), table%end_profile_error(:, :p, 1, step), x(l))
        end do
      else
        w = x
        if (osc%shared > 0) then
          a = table%end_sums(0, 1, 1, step)
          b = table%end_sums(0, 2, 1, step)
          c = table%end_shared(0, 1, 1, step)
          w = (x + c*b)/(1 + c*a)
        end if
        do j = 1, p
          do l = 1, size(x)
            contact_set(l) = contact_set(l) + merge(ibset(0, j - 1), 0, w(l) > e(j))
          end do
        end do
        ! What pairs that share a compliance work on was that of full contact.
        do l = 1, merge(size(x), 0, osc%shared > 0)
          if (contact_set(l) /= table%full(step)) contact_set(l) = closed_pairs(c, k(:p), e(:p), x(l))
        end do
      end if
    end associate
    if (osc%has_backlash) where (x < -osc%backlash) contact_set = ibset(contact_set, osc%contacts - 1)
    where (held) contact_set = table%full(step)
  end subroutine contact_sets_at_begin
end module gearsweep_step_ends
