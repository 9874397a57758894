!> Inertia at the bore (shaft, coupling, motor) and the gear body that turns between it and the teeth.
!>
!> A body of mass m_b on the line of action, with the mass m_h at its bore, turns about it by `twist` per load. Its teeth drive
!> both. While their vibration is slow compared with the body's own turning vibration, its load accelerates both alike, the share
!> mu = m_h/(m_b + m_h) of the load is transmitted to the bore, and the turning adds mu**2 twist to the compliance of the mesh:
!> the strain energy of the share. Without inertia at the bore that is zero, with a large one the full turning. The natural
!> frequencies of the chain of the four inertias show up to which mesh frequency this holds.
module gearsweep_elastic_hub
  use gearsweep_base, only: bracket_t, dp
  implicit none
  private
  public :: felt_twist, chain_frequencies

contains

  !> Part of the `twist` (m/N) of a gear body that the motion feels, with this share of its inertia at the bore, m/N.
  elemental real(dp) function felt_twist(hub_share, twist)
    real(dp), intent(in) :: hub_share, twist

    felt_twist = hub_share**2*twist
  end function felt_twist

  !> Finds the two lowest natural frequencies (rad/s) above 0 of the free chain hub, body, mesh, body, hub. A hub without mass or
  !> twist is one with its body; if no hub has both, the chain has no second frequency, and it is 0.
  !> Source: Den Hartog 1956, Mechanical Vibrations, section 5.2, by Sturm's sequence.
  pure function chain_frequencies(body_mass, hub_mass, compliance, twist) result(omega)
    real(dp), intent(in) :: body_mass(2), hub_mass(2)  !< masses of pinion and gear on the line of action, kg
    real(dp), intent(in) :: compliance           !< compliance of the mesh between the bodies, m/N
    real(dp), intent(in) :: twist(2)             !< twist of the bodies about their hubs, m/N
    real(dp) :: omega(2)
    real(dp), allocatable :: mass(:), compliances(:)
    integer :: i

    mass = body_mass
    compliances = [compliance]
    do i = 1, 2
      if (hub_mass(i) > 0 .and. twist(i) > 0) then
        mass = extended(mass, hub_mass(i), i)
        compliances = extended(compliances, twist(i), i)
      else
        mass(merge(1, size(mass), i == 1)) = mass(merge(1, size(mass), i == 1)) + hub_mass(i)
      end if
    end do
    omega = 0
    do i = 1, min(2, size(compliances))
      omega(i) = sqrt(eigenvalue(mass, 1/compliances, i))
    end do
  end function chain_frequencies

  !> List with one more number at the front or the end.
  pure function extended(list, more, side) result(longer)
    real(dp), intent(in) :: list(:), more
    integer, intent(in) :: side
    real(dp), allocatable :: longer(:)

    if (side == 1) then
      longer = [more, list]
    else
      longer = [list, more]
    end if
  end function extended

  !> Eigenvalue number n (1/s^2) of the loads in a free chain's springs, by bisection of Sturm's count.
  pure real(dp) function eigenvalue(mass, stiffness, n)
    real(dp), intent(in) :: mass(:), stiffness(:)  !< kg, N/m; one spring less than masses
    integer, intent(in) :: n
    type(bracket_t) :: scaled
    real(dp) :: bound

    ! In units of a bound, so that no square overflows.
    bound = 4*maxval(stiffness)/minval(mass)
    scaled = bracket_t(0.0_dp, 1.0_dp)
    do while (scaled%is_open())
      call scaled%halve(count_below(scaled%middle()) < n)
    end do
    eigenvalue = bound*scaled%middle()

  contains

    !> Number of eigenvalues below x: the negative pivots of the matrix minus x, whose diagonal is k_j (1/m_j + 1/m_j+1) and whose
    !> squared off-diagonals are k_j k_j+1/m_j+1**2.
    pure integer function count_below(x)
      real(dp), intent(in) :: x
      real(dp), parameter :: least = 1e-290_dp
      real(dp) :: pivot
      integer :: j

      count_below = 0
      pivot = 1
      do j = 1, size(stiffness)
        if (abs(pivot) < least) pivot = least
        if (j > 1) pivot = -(stiffness(j - 1)/mass(j)/bound)*(stiffness(j)/mass(j)/bound)/pivot
        if (j == 1) pivot = 0
        pivot = pivot + stiffness(j)/mass(j)/bound + stiffness(j)/mass(j + 1)/bound - x
        if (pivot < 0) count_below = count_below + 1
      end do
    end function count_below
  end function eigenvalue
end module gearsweep_elastic_hub
