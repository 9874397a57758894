!> The contact law: the loads of the pairs in contact as affine functions of the deflection x,
!>
!>   F_j = g_j (x - t_j).
!>
!> The effective stiffness g_j and the touching deflection t_j hold while the pairs of one contact set are in contact, at one
!> place of the mesh period. Pair j touches at x = t_j, whether it belongs to the set or not: the set holds where x > t_j for
!> exactly its pairs.
!> The loads of the pairs in contact follow from one equation,
!>
!>   (I + K C) F = K (x - e),
!>
!> with the stiffness K_j of a pair that carries alone, 0 where it is open, its profile error e_j, and the deflection C_ji of a pair
!> per load on another one: 0 where pairs share no compliance, the same for all where they share one spring in series, and larger
!> for neighbours among three pairs and more. The solution is F = W (x - e), so g = W 1. Pair j touches where its own load vanishes
!> beside those of the others: t_j = (e_j - sum C_ji W_ik e_k)/(1 - sum C_ji g_i) is linear in the profile errors. Its weights
!> do not depend on these, so that all mesh periods of gears with deviations share them. The integration uses the law alone.
!>
!> A pair whose load is not affine in x is several springs in parallel, each with a stiffness and a profile error of its own, which
!> touch one after the other (`mesh_t%spacing`). The spring of the pair that touches first carries the load of all its springs in
!> contact, g = sum K_i and t = sum K_i e_i/g, and the others none; each of these touches at its profile error.
!>
!> Arrays (0:2, pair) hold a value at one place with its first and second derivative over the variable of the arguments'
!> derivatives, arrays (0:0, pair) the value alone; `find_law_values` finds values at several places, (place, pair).
module gearsweep_motion_contact_law
  use gearsweep_base, only: dp
  use gearsweep_mesh, only: interval_t, mesh_t
  implicit none
  private
  public :: shared_t, springs_t, kind_of, find_law, find_law_values, find_response, find_touching, springs_at, find_law_of_pair, &
            find_closed, product_of

  !> Kind of dependence of the pairs on one another.
  type :: shared_t
    logical :: any = .false.                     !< true: they share one compliance, or are springs of one pair
    logical :: coupled = .false.                 !< true: the compliance is a matrix
    real(dp) :: beyond = 0                       !< compliance shared by pairs that are farther apart than neighbours, m/N
    integer :: spacing = 0                       !< as in mesh_t: springs of one pair follow one another by this number
  end type shared_t

  !> Pairs at some places of a smooth interval.
  type :: springs_t
    type(shared_t) :: kind
    real(dp), allocatable :: stiffness(:, :)     !< K_j, N/m, of a pair that carries alone; (place, pair)
    real(dp), allocatable :: profile_error(:, :)     !< e_j, m; (place, pair)
    !> Compliance shared by a pair and the next (m/N); if not coupled, the first is that of all pairs; (place, pair but the last).
    real(dp), allocatable :: shared(:, :)
  end type springs_t

contains

  !> Kind of dependence of this many pairs of a mesh on one another.
  pure type(shared_t) function kind_of(mesh, pairs) result(kind)
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: pairs

    kind = shared_t(mesh%are_joint(), mesh%disc%shared > 0 .and. mesh%is_coupled(pairs), mesh%disc%shared_beyond(), mesh%spacing)
  end function kind_of

  !> Computes the response of a contact set at one place: the effective stiffness, and the touching deflections as sums of the
  !> profile errors times `weight`. With derivatives where the arrays have them: (0:2, pair), else (0:0, pair).
  pure subroutine find_response(contact_set, kind, stiffness, shared, effective, weight)
    integer, intent(in) :: contact_set           !< bit j - 1: pair j is in contact
    type(shared_t), intent(in) :: kind
    real(dp), intent(in) :: stiffness(0:, :), shared(0:, :)  !< as in springs_t; (derivative, pair)
    real(dp), intent(out) :: effective(0:, :)    !< g_j, N/m; 0 for an open pair; (derivative, pair)
    real(dp), intent(out) :: weight(0:, :, :)    !< w_ji of t_j = sum w_ji e_i; (derivative, pair j, pair i)
    real(dp), dimension(size(stiffness, 2), size(stiffness, 2), 0:ubound(stiffness, 1)) :: c, a, w, cw
    real(dp), dimension(size(stiffness, 2), size(stiffness, 2)) :: inverse
    real(dp), dimension(0:ubound(stiffness, 1), size(stiffness, 2)) :: k
    real(dp) :: less(0:ubound(stiffness, 1))
    integer :: i, j, n, p

    n = ubound(stiffness, 1)
    p = size(stiffness, 2)
    do j = 1, p
      k(:, j) = merge(stiffness(0:n, j), 0.0_dp, btest(contact_set, j - 1))
    end do
    weight(0:n, :, :) = 0
    do j = 1, p
      weight(0, j, j) = 1
    end do
    if (.not. kind%any) then
      effective(0:n, :) = k
      return
    end if
    if (kind%spacing > 0) then
      call join_springs(contact_set, kind%spacing, k, effective, weight)
      return
    end if
    c = 0
    c(:, :, 0) = kind%beyond
    do j = 1, p
      do i = 1, p
        if (i == j) then
          c(i, j, :) = 0
        else if (.not. kind%coupled) then
          c(i, j, :) = shared(0:n, 1)
        else if (abs(i - j) == 1) then
          c(i, j, :) = shared(0:n, min(i, j))
        end if
      end do
    end do
    ! (I + K C) F = K (x - e): its matrix is inverted once, as the derivatives of the equation have the same one.
    do j = 1, p
      a(:, j, 0) = k(0, :)*c(:, j, 0)
      a(j, j, 0) = a(j, j, 0) + 1
    end do
    call invert(a(:, :, 0), inverse)
    do j = 1, p
      w(:, j, 0) = inverse(:, j)*k(0, j)
    end do
    cw(:, :, 0) = matmul(c(:, :, 0), w(:, :, 0))
    if (n == 2) then
      do j = 1, p
        a(:, j, 1) = k(1, :)*c(:, j, 0) + k(0, :)*c(:, j, 1)
        a(:, j, 2) = k(2, :)*c(:, j, 0) + 2*k(1, :)*c(:, j, 1) + k(0, :)*c(:, j, 2)
      end do
      w(:, :, 1) = -matmul(a(:, :, 1), w(:, :, 0))
      do j = 1, p
        w(j, j, 1) = w(j, j, 1) + k(1, j)
      end do
      w(:, :, 1) = matmul(inverse, w(:, :, 1))
      w(:, :, 2) = -matmul(a(:, :, 2), w(:, :, 0)) - 2*matmul(a(:, :, 1), w(:, :, 1))
      do j = 1, p
        w(j, j, 2) = w(j, j, 2) + k(2, j)
      end do
      w(:, :, 2) = matmul(inverse, w(:, :, 2))
      cw(:, :, 1) = matmul(c(:, :, 1), w(:, :, 0)) + matmul(c(:, :, 0), w(:, :, 1))
      cw(:, :, 2) = matmul(c(:, :, 2), w(:, :, 0)) + 2*matmul(c(:, :, 1), w(:, :, 1)) + matmul(c(:, :, 0), w(:, :, 2))
    end if
    do j = 1, p
      effective(0:n, j) = sum(w(j, :, :), 1)
      ! Pair j without load: (1 - sum C g) x = e_j - sum C W e over the others.
      less = sum(cw(j, :, :), 1)
      less(0) = 1 - less(0)
      weight(0, j, :) = (weight(0, j, :) - cw(j, :, 0))/less(0)
      if (n < 2) cycle
      weight(1, j, :) = (less(1)*weight(0, j, :) - cw(j, :, 1))/less(0)
      weight(2, j, :) = (less(2)*weight(0, j, :) + 2*less(1)*weight(1, j, :) - cw(j, :, 2))/less(0)
    end do
  end subroutine find_response

  !> Adds up the loads of all closed springs of a pair. The sum is the load of the spring that touches first, the last of them.
  pure subroutine join_springs(contact_set, spacing, stiffness, effective, weight)
    integer, intent(in) :: contact_set, spacing
    real(dp), intent(in) :: stiffness(0:, :)     !< 0 for a spring that is open; (derivative, spring)
    real(dp), intent(out) :: effective(0:, :)    !< as in `find_response`
    real(dp), intent(inout) :: weight(0:, :, :)  !< in: the touching deflection of each spring is its profile error
    integer :: i, j, n, pair

    n = ubound(stiffness, 1)
    effective(0:n, :) = 0
    do pair = 1, min(spacing, size(stiffness, 2))
      j = 0
      do i = pair, size(stiffness, 2), spacing
        if (btest(contact_set, i - 1)) j = i
      end do
      if (j == 0) cycle
      do i = pair, j, spacing
        effective(0:n, j) = effective(0:n, j) + stiffness(:, i)
      end do
      associate (g => effective(:, j))
        if (.not. g(1) > 0) cycle
        do i = pair, j, spacing
          weight(0, j, i) = stiffness(0, i)/g(1)
          if (n < 2) cycle
          weight(1, j, i) = (stiffness(1, i) - g(2)*weight(0, j, i))/g(1)
          weight(2, j, i) = (stiffness(2, i) - 2*g(2)*weight(1, j, i) - g(3)*weight(0, j, i))/g(1)
        end do
      end associate
    end do
  end subroutine join_springs

  !> Inverts a small matrix whose leading minors are positive, by Gauss elimination without pivoting.
  pure subroutine invert(matrix, inverse)
    real(dp), intent(in) :: matrix(:, :)
    real(dp), intent(out) :: inverse(:, :)
    real(dp) :: pivot, column(size(matrix, 1))
    integer :: j, k, n

    n = size(matrix, 1)
    inverse = matrix
    do k = 1, n
      pivot = 1/inverse(k, k)
      column = -pivot*inverse(:, k)
      column(k) = pivot
      do j = 1, n
        if (j == k) cycle
        associate (factor => inverse(k, j))
          inverse(:k - 1, j) = inverse(:k - 1, j) + column(:k - 1)*factor
          inverse(k + 1:, j) = inverse(k + 1:, j) + column(k + 1:)*factor
        end associate
        inverse(k, j) = pivot*inverse(k, j)
      end do
      inverse(:, k) = column
    end do
  end subroutine invert

  !> Computes touching deflections (m) from the weights of `find_response`, with derivatives where the arrays have them.
  pure subroutine find_touching(weight, profile_error, touching)
    real(dp), intent(in) :: weight(0:, :, :)     !< (derivative, pair j, pair i)
    real(dp), intent(in) :: profile_error(0:, :)           !< e_i, m; (derivative, pair)
    real(dp), intent(out) :: touching(0:, :)     !< t_j, m; (derivative, pair)
    integer :: i, j, n

    n = ubound(profile_error, 1)
    do j = 1, size(touching, 2)
      touching(0:n, j) = 0
      do i = 1, size(touching, 2)
        associate (w => weight(:, j, i), e => profile_error(:, i))
          touching(0, j) = touching(0, j) + w(1)*e(1)
          if (n < 2) cycle
          touching(1, j) = touching(1, j) + w(2)*e(1) + w(1)*e(2)
          touching(2, j) = touching(2, j) + w(3)*e(1) + 2*w(2)*e(2) + w(1)*e(3)
        end associate
      end do
    end do
  end subroutine find_touching

  !> Computes the law of a contact set at one place, with derivatives where the arrays have them.
  pure subroutine find_law(contact_set, kind, stiffness, profile_error, shared, effective, touching)
    integer, intent(in) :: contact_set           !< bit j - 1: pair j is in contact
    type(shared_t), intent(in) :: kind
    real(dp), intent(in) :: stiffness(0:, :), profile_error(0:, :), shared(0:, :)  !< as in springs_t; (derivative, pair)
    real(dp), intent(out) :: effective(0:, :)    !< g_j, N/m; 0 for an open pair; (derivative, pair)
    real(dp), intent(out) :: touching(0:, :)     !< t_j, m; (derivative, pair)
    real(dp) :: weight(0:ubound(stiffness, 1), size(stiffness, 2), size(stiffness, 2))

    call find_response(contact_set, kind, stiffness, shared, effective, weight)
    call find_touching(weight, profile_error, touching)
  end subroutine find_law

  !> Computes the law of a contact set at several places, values alone.
  pure subroutine find_law_values(contact_set, kind, stiffness, profile_error, shared, effective, touching)
    integer, intent(in) :: contact_set           !< bit j - 1: pair j is in contact
    type(shared_t), intent(in) :: kind
    real(dp), intent(in) :: stiffness(:, :), profile_error(:, :), shared(:, :)     !< as in springs_t
    real(dp), intent(out) :: effective(:, :)     !< g_j, N/m; 0 for an open pair; (place, pair)
    real(dp), intent(out) :: touching(:, :)      !< t_j, m; (place, pair)
    integer :: j, k

    if (kind%any) then
      do k = 1, size(stiffness, 1)
        call find_law(contact_set, kind, stiffness(k:k, :), profile_error(k:k, :), shared(k:k, :), effective(k:k, :), &
                      touching(k:k, :))
      end do
    else
      do j = 1, size(stiffness, 2)
        effective(:, j) = merge(stiffness(:, j), 0.0_dp, btest(contact_set, j - 1))
        touching(:, j) = profile_error(:, j)
      end do
    end if
  end subroutine find_law_values

  !> Computes the pairs of an interval at some phases; one-sided at the interval's ends.
  pure subroutine springs_at(mesh, interval, phase, springs)
    type(mesh_t), intent(in) :: mesh
    type(interval_t), intent(in) :: interval
    real(dp), intent(in) :: phase(:)             !< 0 to 1
    type(springs_t), intent(out) :: springs
    real(dp) :: s
    integer :: j, k

    springs%kind = kind_of(mesh, interval%pairs)
    allocate (springs%stiffness(size(phase), interval%pairs), springs%profile_error(size(phase), interval%pairs))
    allocate (springs%shared(size(phase), size(interval%shared, 2)))
    do j = 1, size(interval%shared, 2)
      springs%shared(:, j) = interval%shared(0, j) + phase*(interval%shared(1, j) + phase*interval%shared(2, j))
    end do
    do j = 1, interval%pairs
      do k = 1, size(phase)
        s = interval%place(phase(k), j)
        springs%stiffness(k, j) = mesh%stiffness%value(s, mesh%stiffness%locate(s, interval%stiffness_piece(:, j)))
        springs%profile_error(k, j) = mesh%error_at(interval, phase(k), j)
      end do
    end do
  end subroutine springs_at

  !> Computes the law of one pair of an interval in contact at a phase, values alone.
  pure subroutine find_law_of_pair(mesh, interval, phase, contact_set, pair, effective, touching)
    type(mesh_t), intent(in) :: mesh
    type(interval_t), intent(in) :: interval
    real(dp), intent(in) :: phase                !< 0 to 1
    integer, intent(in) :: contact_set           !< bit j - 1: pair j is in contact
    integer, intent(in) :: pair
    real(dp), intent(out) :: effective, touching  !< N/m, m
    type(springs_t) :: springs
    real(dp), dimension(1, interval%pairs) :: all_effective, all_touching
    real(dp) :: s

    if (.not. mesh%are_joint()) then
      s = interval%place(phase, pair)
      effective = mesh%stiffness%value(s, mesh%stiffness%locate(s, interval%stiffness_piece(:, pair)))
      touching = mesh%error_at(interval, phase, pair)
    else
      call springs_at(mesh, interval, [phase], springs)
      call find_law_values(contact_set, springs%kind, springs%stiffness, springs%profile_error, springs%shared, all_effective, &
                           all_touching)
      effective = all_effective(1, pair)
      touching = all_touching(1, pair)
    end if
  end subroutine find_law_of_pair

  !> Finds the contact set at a deflection and one place, and its law: the first pair that touches on the wrong side changes until
  !> there is none. Source: Murty 1974, Linear Algebra and its Applications 9, 65-108: it ends if the compliance is positive
  !> definite.
  pure subroutine find_closed(kind, stiffness, profile_error, shared, x, contact_set, effective, touching)
    type(shared_t), intent(in) :: kind
    real(dp), intent(in) :: stiffness(:, :), profile_error(:, :), shared(:, :)     !< as in springs_t; (1, pair)
    real(dp), intent(in) :: x                    !< m
    integer, intent(out) :: contact_set
    real(dp), intent(out) :: effective(:, :), touching(:, :)       !< (1, pair)
    integer :: i, j, p

    p = size(stiffness, 2)
    contact_set = 0
    do j = 1, p
      ! A pair that cannot touch here has no stiffness.
      if (stiffness(1, j) > 0) contact_set = ibset(contact_set, j - 1)
    end do
    do i = 1, 4*2**min(p, 10)
      call find_law_values(contact_set, kind, stiffness, profile_error, shared, effective, touching)
      do j = 1, p
        if (stiffness(1, j) > 0 .and. (btest(contact_set, j - 1) .neqv. x > touching(1, j))) exit
      end do
      if (j > p) return
      contact_set = ieor(contact_set, ibset(0, j - 1))
    end do
  end subroutine find_closed

  !> Product with its first and second derivative.
  pure function product_of(a, b) result(c)
    real(dp), intent(in) :: a(0:2), b(0:2)
    real(dp) :: c(0:2)

    c = [a(0)*b(0), a(1)*b(0) + a(0)*b(1), a(2)*b(0) + 2*a(1)*b(1) + a(0)*b(2)]
  end function product_of

end module gearsweep_motion_contact_law
