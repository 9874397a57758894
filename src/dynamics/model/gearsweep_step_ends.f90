!> Pairs and motion at both ends of a step, where the table has stiffness and profile error with their derivatives.
module gearsweep_step_ends
  use gearsweep_coefficients, only: coefficients_t
  use gearsweep_kinds, only: dp
  use gearsweep_oscillator, only: acceleration, oscillator_t
  use gearsweep_shared_compliance, only: effective_pair, reduce_sums
  implicit none
  private
  public :: end_acceleration, pair_at_end

contains

  !> Stiffness and profile error of pair j at an end of a step, the effective ones where pairs share a compliance, each with
  !> its first and second derivative over the phase.
  pure subroutine pair_at_end(osc, table, step, end, contact_set, j, stiffness, profile_error)
    type(oscillator_t), intent(in) :: osc
    type(coefficients_t), intent(in) :: table
    integer, intent(in) :: step, end           !< which step; 1 its begin, 2 its end
    integer, intent(in) :: contact_set         !< bit i - 1: pair i is in contact
    integer, intent(in) :: j                   !< pair
    real(dp), intent(out) :: stiffness(0:2), profile_error(0:2)    !< N/m, m

    if (osc%shared > 0 .and. contact_set /= table%full(step)) then
      associate (p => table%pairs(step))
        call effective_pair(osc%shared, contact_set, j, table%own_stiffness(:, :p, end, step), &
                            table%own_profile_error(:, :p, end, step), stiffness, profile_error)
      end associate
    else
      stiffness = table%end_stiffness(:, j, end, step)
      profile_error = table%end_profile_error(:, j, end, step)
    end if
  end subroutine pair_at_end

  !> Second derivative of x over the phase (m) at an end of a step. The coast sides count as apart, as this is
  !> asked for the load of a pair in contact.
  pure real(dp) function end_acceleration(osc, table, step, end, contact_set, duration, state)
    type(oscillator_t), intent(in) :: osc
    type(coefficients_t), intent(in) :: table
    integer, intent(in) :: step, end           !< which step; 1 its begin, 2 its end
    integer, intent(in) :: contact_set         !< bit j - 1: pair j is in contact
    real(dp), intent(in) :: duration           !< of the mesh period, s
    real(dp), intent(in) :: state(2)           !< x and its derivative over the phase there, m
    real(dp) :: omega_squared, forcing, a, b
    integer :: j

    omega_squared = 0
    forcing = 0
    if (osc%shared > 0) then
      a = 0
      b = 0
      do j = 1, osc%pairs
        if (.not. btest(contact_set, j - 1)) cycle
        associate (k => table%own_stiffness(0, j, end, step), e => table%own_profile_error(0, j, end, step))
          a = a + k
          b = b + k*e
          omega_squared = omega_squared + table%end_rate(j, end, step)
          forcing = forcing + table%end_rate(j, end, step)*e
        end associate
      end do
      call reduce_sums(osc%shared, a, b, omega_squared, forcing)
    else
      do j = 1, osc%pairs
        if (.not. btest(contact_set, j - 1)) cycle
        omega_squared = omega_squared + table%end_rate(j, end, step)
        forcing = forcing + table%end_rate(j, end, step)*table%end_profile_error(0, j, end, step)
      end do
    end if
    end_acceleration = acceleration(osc, omega_squared, forcing, duration, state(1), state(2))
  end function end_acceleration
end module gearsweep_step_ends
