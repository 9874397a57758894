!> What the pairs work on at the ends of steps, for a batch of motions: the deflection x, less what the pairs share.
module gearsweep_deflections
  use gearsweep_coefficients, only: coefficients_t
  use gearsweep_coupled_pairs, only: left_for
  use gearsweep_gauss, only: batch_size
  use gearsweep_integrator, only: integrator_t
  use gearsweep_kinds, only: dp
  use gearsweep_oscillator, only: oscillator_t
  use gearsweep_shared_coefficients, only: respond_at_end
  implicit none
  private
  public :: find_deflections, find_deflections_of

contains

  !> What the pairs work on at an end of a step, with its derivative over the phase: x, less what they share. Coupled pairs work
  !> each on their own: find_deflections_of.
  pure subroutine find_deflections(osc, table, step, end, state, w, slope)
    type(oscillator_t), intent(in) :: osc
    type(coefficients_t), intent(in) :: table
    integer, intent(in) :: step, end
    type(integrator_t), intent(in) :: state
    real(dp), intent(out), dimension(batch_size) :: w, slope       ! m
    ! Sums of K and K e over the pairs in contact, with their derivatives.
    real(dp), dimension(batch_size) :: a, a_slope, b, b_slope
    real(dp) :: c, c_slope
    integer :: at, j, l

    at = merge(state%from, state%to, end == 1)
    w = state%x(:, at)
    slope = state%y(:, at)
    if (.not. osc%shared > 0 .or. table%coupled(step)) return
    if (state%full_contact) then
      a = table%end_sums(0, 1, end, step)
      a_slope = table%end_sums(1, 1, end, step)
      b = table%end_sums(0, 2, end, step)
      b_slope = table%end_sums(1, 2, end, step)
    else
      a = 0
      a_slope = 0
      b = 0
      b_slope = 0
    end if
    do j = 1, merge(0, table%pairs(step), state%full_contact)
      associate (k => table%end_stiffness(:1, j, end, step), e => table%end_profile_error(:1, j, end, step), &
                 weight => state%contacts(j)%weight)
        do l = 1, batch_size
          a(l) = a(l) + weight(l)*k(1)
          a_slope(l) = a_slope(l) + weight(l)*k(2)
          b(l) = b(l) + weight(l)*(k(1)*e(1))
          b_slope(l) = b_slope(l) + weight(l)*(k(2)*e(1) + k(1)*e(2))
        end do
      end associate
    end do
    c = table%end_shared(0, 1, end, step)
    c_slope = table%end_shared(1, 1, end, step)
    do l = 1, batch_size
      w(l) = (w(l) + c*b(l))/(1 + c*a(l))
      slope(l) = (slope(l) + c*(b_slope(l) - a_slope(l)*w(l)) + c_slope*(b(l) - a(l)*w(l)))/(1 + c*a(l))
    end do
  end subroutine find_deflections

  !> The same for pair j of coupled pairs.
  pure subroutine find_deflections_of(j, osc, table, step, end, state, w, slope)
    integer, intent(in) :: j
    type(oscillator_t), intent(in) :: osc
    type(coefficients_t), intent(in) :: table
    integer, intent(in) :: step, end
    type(integrator_t), intent(in) :: state
    real(dp), intent(out), dimension(batch_size) :: w, slope       ! m
    real(dp) :: c(0:2, table%pairs(step), table%pairs(step)), working(0:2)
    real(dp), dimension(0:2, table%pairs(step)) :: g, h
    integer :: at, l, set, last_set

    at = merge(state%from, state%to, end == 1)
    last_set = -1
    do l = 1, batch_size
      ! The bit of the coast sides is beyond those of the pairs.
      set = ibits(state%contact_set(l), 0, table%pairs(step))
      if (set /= last_set) call respond_at_end(osc, table, step, end, set, c, g, h)
      last_set = set
      working = left_for(j, c, g, h, [state%x(l, at), state%y(l, at), 0.0_dp])
      w(l) = working(0)
      slope(l) = working(1)
    end do
  end subroutine find_deflections_of
end module gearsweep_deflections
