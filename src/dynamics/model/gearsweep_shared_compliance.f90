!> Pairs in contact that share a compliance: one spring in series with all of them.
!>
!> A load on one tooth moves its neighbours on the same body too, by C per load. With own stiffness K_j and profile error
!> e_j of the pairs in contact, A = sum K_j and B = sum K_j e_j, the load of all of them under the deflection x is
!>   S = (A x - B)/(1 + C A),
!> and each pair works on what is left, its working deflection w = x - C S = (x + C B)/(1 + C A): F_j = K_j (w - e_j). A pair
!> that is open closes where w exceeds its profile error, so that contact needs no other unknown than x. C may change with the
!> phase. Three pairs and more share different compliances: gearsweep_coupled_pairs.
module gearsweep_shared_compliance
  use gearsweep_kinds, only: dp
  implicit none
  private
  public :: reduce_sums, sum_pairs, working_deflection, touching_deflection, closed_pairs, own_derivatives

contains

  !> Turns the sums over the pairs in contact that share nothing into those of pairs that share a compliance.
  elemental subroutine reduce_sums(shared, a, b, omega_squared, forcing)
    real(dp), intent(in) :: shared               !< compliance C, m/N
    real(dp), intent(in) :: a, b                 !< sums of K (N/m) and K e (N)
    real(dp), intent(inout) :: omega_squared     !< sum of k, 1/s^2
    real(dp), intent(inout) :: forcing           !< sum of k e, m/s^2

    forcing = forcing - shared*b*omega_squared/(1 + shared*a)
    omega_squared = omega_squared/(1 + shared*a)
  end subroutine reduce_sums

  !> Sums of K and K e over the pairs of a contact set, each with its first and second derivative over whatever the
  !> arguments are derived by.
  pure subroutine sum_pairs(contact_set, stiffness, profile_error, a, b)
    integer, intent(in) :: contact_set           !< bit j - 1: pair j is in contact
    real(dp), intent(in) :: stiffness(0:, :)     !< own stiffness and its derivatives, N/m; (0:2, pair)
    real(dp), intent(in) :: profile_error(0:, :)  !< with its derivatives, m; (0:2, pair)
    real(dp), intent(out) :: a(0:2), b(0:2)      !< N/m, N
    integer :: j

    a = 0
    b = 0
    do j = 1, size(stiffness, 2)
      if (.not. btest(contact_set, j - 1)) cycle
      associate (k => stiffness(:, j), e => profile_error(:, j))
        a = a + k
        b(0) = b(0) + k(1)*e(1)
        b(1) = b(1) + k(2)*e(1) + k(1)*e(2)
        b(2) = b(2) + k(3)*e(1) + 2*k(2)*e(2) + k(1)*e(3)
      end associate
    end do
  end subroutine sum_pairs

  !> What the pairs in contact work on while all of them are deflected by x, with first and second derivatives.
  pure function working_deflection(shared, a, b, x) result(w)
    real(dp), intent(in) :: shared(0:2)          !< compliance C with its derivatives, m/N
    real(dp), intent(in) :: a(0:2), b(0:2)       !< of `sum_pairs`
    real(dp), intent(in) :: x(0:2)               !< m
    real(dp) :: w(0:2)

    associate (c => shared, soft => 1 + shared(0)*a(0))
      w(0) = (x(0) + c(0)*b(0))/soft
      w(1) = (x(1) + c(0)*(b(1) - a(1)*w(0)) + c(1)*(b(0) - a(0)*w(0)))/soft
      w(2) = (x(2) + c(0)*(b(2) - a(2)*w(0) - 2*a(1)*w(1)) + 2*c(1)*(b(1) - a(1)*w(0) - a(0)*w(1)) &
              + c(2)*(b(0) - a(0)*w(0)))/soft
    end associate
  end function working_deflection

  !> The deflection x at which a pair of this profile error just touches, with first and second derivatives.
  pure function touching_deflection(shared, a, b, profile_error) result(x)
    real(dp), intent(in) :: shared(0:2)          !< compliance C with its derivatives, m/N
    real(dp), intent(in) :: a(0:2), b(0:2)       !< of `sum_pairs`
    real(dp), intent(in) :: profile_error(0:2)   !< m
    real(dp) :: x(0:2)

    associate (e => profile_error, c => shared)
      x(0) = e(0)*(1 + c(0)*a(0)) - c(0)*b(0)
      x(1) = e(1)*(1 + c(0)*a(0)) + c(0)*(e(0)*a(1) - b(1)) + c(1)*(e(0)*a(0) - b(0))
      x(2) = e(2)*(1 + c(0)*a(0)) + c(0)*(2*e(1)*a(1) + e(0)*a(2) - b(2)) + 2*c(1)*(e(1)*a(0) + e(0)*a(1) - b(1)) &
             + c(2)*(e(0)*a(0) - b(0))
    end associate
  end function touching_deflection

  !> The contact set at a deflection x: the pairs close one after the other, as each takes from what those that are farther
  !> apart work on.
  pure integer function closed_pairs(shared, stiffness, profile_error, x) result(contact_set)
    real(dp), intent(in) :: shared               !< compliance C, m/N
    real(dp), intent(in) :: stiffness(:)         !< own stiffness, N/m; (pair)
    real(dp), intent(in) :: profile_error(:)     !< m; (pair)
    real(dp), intent(in) :: x                    !< m
    logical :: apart(size(stiffness))
    real(dp) :: a, b
    integer :: i, next

    contact_set = 0
    apart = .true.
    a = 0
    b = 0
    do i = 1, size(stiffness)
      next = minloc(profile_error, 1, mask=apart)
      if (.not. x + shared*b > profile_error(next)*(1 + shared*a)) exit
      apart(next) = .false.
      contact_set = ibset(contact_set, next - 1)
      a = a + stiffness(next)
      b = b + stiffness(next)*profile_error(next)
    end do
  end function closed_pairs

  !> Turns the stiffness of a pair, which has the shared compliance in it, into its own, with the first and second
  !> derivative.
  elemental subroutine own_derivatives(shared, shared_slope, shared_curvature, k, slope, curvature)
    real(dp), intent(in) :: shared               !< compliance C, m/N
    real(dp), intent(in) :: shared_slope, shared_curvature     !< its derivatives
    real(dp), intent(inout) :: k                 !< N/m
    real(dp), intent(inout) :: slope, curvature  !< its derivatives
    real(dp) :: part, own

    part = 1/(1 - shared*k)
    own = part*k
    curvature = part**2*(curvature + 2*shared*part*slope**2) + 2*own*shared_slope*(2*part**2*slope + own**2*shared_slope) &
                + own**2*shared_curvature
    slope = part**2*slope + own**2*shared_slope
    k = own
  end subroutine own_derivatives
end module gearsweep_shared_compliance
