!> Pairs in contact that share a compliance: one spring in series with all of them.
!>
!> A load on one tooth moves its neighbours on the same body too, by C per load. With own stiffness K_j and profile error
!> e_j of the pairs in contact, A = sum K_j and B = sum K_j e_j, the load of all of them under the deflection x is
!>   S = (A x - B)/(1 + C A),
!> and each pair works on what is left, F_j = K_j (x - C S - e_j). The same loads have pairs without shared compliance whose
!> stiffness is K_j/(1 + C A) and whose profile error is e_j + C sum_i K_i (e_j - e_i): the effective ones. A pair that is
!> open closes where x exceeds its effective profile error, so that contact needs no other unknown than x.
module gearsweep_shared_compliance
  use gearsweep_kinds, only: dp
  implicit none
  private
  public :: reduce_sums, effective_pair, closed_pairs, own_derivatives

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

  !> Effective stiffness and profile error of pair j while the pairs of a contact set are in contact, each with its first
  !> and second derivative over whatever the arguments are derived by.
  pure subroutine effective_pair(shared, contact_set, j, stiffness, profile_error, k, e)
    real(dp), intent(in) :: shared               !< compliance C, m/N
    integer, intent(in) :: contact_set           !< bit i - 1: pair i is in contact
    integer, intent(in) :: j                     !< pair, in contact or not
    real(dp), intent(in) :: stiffness(0:, :)     !< own stiffness and its derivatives, N/m; (0:2, pair)
    real(dp), intent(in) :: profile_error(0:, :)  !< with its derivatives, m; (0:2, pair)
    real(dp), intent(out) :: k(0:2), e(0:2)      !< N/m, m
    real(dp) :: gap(0:2), soft(0:2)
    integer :: i

    e = profile_error(:2, j)
    soft = [1.0_dp, 0.0_dp, 0.0_dp]
    do i = 1, size(stiffness, 2)
      if (.not. btest(contact_set, i - 1)) cycle
      soft = soft + shared*stiffness(:2, i)
      if (i == j) cycle
      gap = profile_error(:2, j) - profile_error(:2, i)
      e(0) = e(0) + shared*stiffness(0, i)*gap(0)
      e(1) = e(1) + shared*(stiffness(1, i)*gap(0) + stiffness(0, i)*gap(1))
      e(2) = e(2) + shared*(stiffness(2, i)*gap(0) + 2*stiffness(1, i)*gap(1) + stiffness(0, i)*gap(2))
    end do
    k(0) = stiffness(0, j)/soft(0)
    k(1) = (stiffness(1, j) - k(0)*soft(1))/soft(0)
    k(2) = (stiffness(2, j) - 2*k(1)*soft(1) - k(0)*soft(2))/soft(0)
  end subroutine effective_pair

  !> The contact set at a deflection x: the pairs close one after the other, as each raises the effective profile errors of
  !> those that are farther apart.
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
      ! (x + C B)/(1 + C A) is what the pairs work on.
      if (.not. x + shared*b > profile_error(next)*(1 + shared*a)) exit
      apart(next) = .false.
      contact_set = ibset(contact_set, next - 1)
      a = a + stiffness(next)
      b = b + stiffness(next)*profile_error(next)
    end do
  end function closed_pairs

  !> Turns the stiffness of a pair, which has the shared compliance in it, into its own, with the first and second
  !> derivative.
  elemental subroutine own_derivatives(shared, k, slope, curvature)
    real(dp), intent(in) :: shared               !< compliance C, m/N
    real(dp), intent(inout) :: k                 !< N/m
    real(dp), intent(inout) :: slope, curvature  !< its derivatives
    real(dp) :: part

    part = 1/(1 - shared*k)
    curvature = part**2*(curvature + 2*shared*part*slope**2)
    slope = part**2*slope
    k = part*k
  end subroutine own_derivatives
end module gearsweep_shared_compliance
