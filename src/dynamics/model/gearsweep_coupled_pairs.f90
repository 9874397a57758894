!> Three pairs in contact and more, of which neighbours share more than others.
!>
!> The matrix C says what a load on a pair moves each pair by; its diagonal is what a pair deflects while it carries alone. With
!> the profile errors e, the loads F of the pairs in contact under the deflection x follow from C F = x - e, and are affine
!> in x: F = g x - h with C g = 1 and C h = e. What the other pairs' loads leave of the deflection for pair j is its working
!> deflection w_j = x - sum C_ji F_i over the others: F_j = (w_j - e_j)/C_jj, and an open pair closes where w_j exceeds e_j.
!> Two pairs need no matrix: they are in series with what they share (gearsweep_shared_compliance).
module gearsweep_coupled_pairs
  use gearsweep_kinds, only: dp
  use gearsweep_small_system, only: solve_small
  implicit none
  private
  public :: compliances, respond, left_for, touching, closed_set, sum_response

contains

  !> The matrix with its first and second derivative over whatever the arguments are derived by; (0:2, pair, pair).
  pure function compliances(stiffness, shared, others) result(c)
    real(dp), intent(in) :: stiffness(0:, :)     !< of each pair while it carries alone, N/m; (0:2, pair)
    real(dp), intent(in) :: shared(0:, :)        !< by a pair and the next one, m/N; (0:2, pair but the last)
    real(dp), intent(in) :: others               !< by pairs that are farther apart, m/N
    real(dp) :: c(0:2, size(stiffness, 2), size(stiffness, 2))
    integer :: j

    c = 0
    c(0, :, :) = others
    do j = 1, size(stiffness, 2)
      c(:, j, j) = 0
      ! A pair that is not there yet has no stiffness.
      if (stiffness(0, j) > 0) then
        associate (own => 1/stiffness(0, j))
          c(:, j, j) = [own, -stiffness(1, j)*own**2, (2*stiffness(1, j)**2*own - stiffness(2, j))*own**2]
        end associate
      end if
      if (j == size(stiffness, 2)) exit
      c(:, j, j + 1) = shared(:, j)
      c(:, j + 1, j) = shared(:, j)
    end do
  end function compliances

  !> g (N/m) and h (N) of a contact set with their derivatives; 0 of pairs that are apart.
  pure subroutine respond(contact_set, c, profile_error, g, h)
    integer, intent(in) :: contact_set           !< bit j - 1: pair j is in contact
    real(dp), intent(in) :: c(0:, :, :)          !< of `compliances`
    real(dp), intent(in) :: profile_error(0:, :)  !< with its derivatives, m; (0:2, pair)
    real(dp), intent(out), dimension(0:2, size(c, 3)) :: g, h
    real(dp) :: matrix(size(c, 3), size(c, 3)), b(size(c, 3), 2)
    logical :: closed(size(c, 3))
    integer :: j, k

    closed = btest(contact_set, [(j, j=0, size(c, 3) - 1)])
    matrix = c(0, :, :)
    do j = 1, size(c, 3)
      if (closed(j)) cycle
      matrix(j, :) = 0
      matrix(j, j) = 1
    end do
    g = 0
    h = 0
    do k = 0, 2
      b(:, 1) = merge(1, 0, k == 0)
      b(:, 2) = profile_error(k, :)
      do j = 1, size(c, 3)
        b(j, 1) = b(j, 1) - k*dot_product(c(1, j, :), g(max(0, k - 1), :))
        b(j, 2) = b(j, 2) - k*dot_product(c(1, j, :), h(max(0, k - 1), :))
        if (k < 2) cycle
        b(j, 1) = b(j, 1) - dot_product(c(2, j, :), g(0, :))
        b(j, 2) = b(j, 2) - dot_product(c(2, j, :), h(0, :))
      end do
      b(:, 1) = merge(b(:, 1), 0.0_dp, closed)
      b(:, 2) = merge(b(:, 2), 0.0_dp, closed)
      call solve_small(matrix, b)
      g(k, :) = b(:, 1)
      h(k, :) = b(:, 2)
    end do
  end subroutine respond

  !> Sums of omega^2 (1/s^2) and k e (m/s^2) over the pairs, each times what a force on it makes of the acceleration.
  pure subroutine sum_response(contact_set, c, profile_error, mobility, omega_squared, forcing)
    integer, intent(in) :: contact_set           !< bit j - 1: pair j is in contact
    real(dp), intent(in) :: c(:, :)              !< the matrix itself, m/N
    real(dp), intent(in) :: profile_error(:)     !< m; (pair)
    real(dp), intent(in) :: mobility(:)          !< 1/kg; (pair)
    real(dp), intent(out) :: omega_squared, forcing
    real(dp) :: b(size(c, 1), 2), matrix(size(c, 1), size(c, 1))
    integer :: j

    matrix = c
    b(:, 1) = 1
    b(:, 2) = profile_error
    do j = 1, size(c, 1)
      if (btest(contact_set, j - 1)) cycle
      matrix(j, :) = 0
      matrix(j, j) = 1
      b(j, :) = 0
    end do
    call solve_small(matrix, b)
    omega_squared = dot_product(mobility, b(:, 1))
    forcing = dot_product(mobility, b(:, 2))
  end subroutine sum_response

  !> The working deflection of pair j under the deflection x, with their derivatives, m; (0:2).
  pure function left_for(j, c, g, h, x) result(w)
    integer, intent(in) :: j
    real(dp), intent(in) :: c(0:, :, :)          !< of `compliances`
    real(dp), intent(in), dimension(0:, :) :: g, h   !< of `respond`
    real(dp), intent(in) :: x(0:2)               !< m
    real(dp) :: w(0:2), f(0:2)
    integer :: i

    w = x
    do i = 1, size(g, 2)
      if (i == j) cycle
      f(0) = g(0, i)*x(0) - h(0, i)
      f(1) = g(1, i)*x(0) + g(0, i)*x(1) - h(1, i)
      f(2) = g(2, i)*x(0) + 2*g(1, i)*x(1) + g(0, i)*x(2) - h(2, i)
      w(0) = w(0) - c(0, j, i)*f(0)
      w(1) = w(1) - c(1, j, i)*f(0) - c(0, j, i)*f(1)
      w(2) = w(2) - c(2, j, i)*f(0) - 2*c(1, j, i)*f(1) - c(0, j, i)*f(2)
    end do
  end function left_for

  !> The deflection x at which pair j just touches, with its derivatives, m; (0:2).
  pure function touching(j, c, profile_error, g, h) result(x)
    integer, intent(in) :: j
    real(dp), intent(in) :: c(0:, :, :)          !< of `compliances`
    real(dp), intent(in) :: profile_error(0:)    !< of pair j, with its derivatives, m
    real(dp), intent(in), dimension(0:, :) :: g, h   !< of `respond`, for the others in contact
    real(dp) :: x(0:2), part(0:2), reach(0:2)

    ! w_j = part x + reach
    part = left_for(j, c, g, 0*h, [1.0_dp, 0.0_dp, 0.0_dp])
    reach = left_for(j, c, 0*g, h, [0.0_dp, 0.0_dp, 0.0_dp])
    x(0) = (profile_error(0) - reach(0))/part(0)
    x(1) = (profile_error(1) - reach(1) - part(1)*x(0))/part(0)
    x(2) = (profile_error(2) - reach(2) - part(2)*x(0) - 2*part(1)*x(1))/part(0)
  end function touching

  !> The contact set at a deflection x (m), of all pairs: the first one whose load or gap has the wrong sign
  !> changes until there is none. Source: Murty 1974, Linear Algebra and its Applications 9, 65-108: it ends where C is
  !> positive definite.
  pure integer function closed_set(c, profile_error, x) result(contact_set)
    real(dp), intent(in) :: c(0:, :, :)          !< of `compliances`
    real(dp), intent(in) :: profile_error(0:, :)  !< m; (0:2, pair)
    real(dp), intent(in) :: x
    real(dp), dimension(0:2, size(c, 3)) :: g, h
    real(dp) :: w(0:2)
    integer :: i, j

    contact_set = 0
    do i = 1, 4*2**min(size(c, 3), 10)
      call respond(contact_set, c, profile_error, g, h)
      do j = 1, size(c, 3)
        w = left_for(j, c, g, h, [x, 0.0_dp, 0.0_dp])
        if (btest(contact_set, j - 1) .neqv. w(0) > profile_error(0, j)) exit
      end do
      if (j > size(c, 3)) return
      contact_set = ieor(contact_set, ibset(0, j - 1))
    end do
  end function closed_set
end module gearsweep_coupled_pairs
