!> The contact law: the loads of the pairs in contact as affine functions of the deflection x,
!>
!>   F_j = g_j (x - t_j).
!>
!> The effective stiffness g_j and the touching deflection t_j hold while the pairs of one contact set are in contact, at one
!> place of the mesh period. Pair j touches at x = t_j, whether it belongs to the set or not: the set holds where x > t_j for
!> exactly its pairs.
!> Three kinds of compliance enter the law; the integration uses the law alone and is the same for all of them:
!>
!> - pairs that share no compliance: g_j is their stiffness K_j and t_j their profile error e_j;
!> - pairs that share one compliance C, a spring in series with all of them. With their own stiffness k_j = K_j/(1 - C K_j),
!>   A = sum k_j and B = sum k_j e_j over the set: g_j = k_j/(1 + C A), t_j = e_j (1 + C A) - C B;
!> - three pairs and more, of which neighbours share more than others. The matrix C has the deflection of each pair per load on a
!> pair; its diagonal is 1/K_j, the compliance of a pair that carries alone. C F = x - e over the set gives F = g x - h with C g =
!> 1 and C h = e, and t_j = (e_j - sum C_ji h_i)/(1 - sum C_ji g_i) over the others.
!>
!> `find_law` returns the law at one place with its first and second derivatives over the variable of the arguments' derivatives,
!> (0:2, pair), `find_law_values` values alone at several places, (place, pair).
module gearsweep_motion_contact_law
  use gearsweep_base, only: dp, solve_small
  use gearsweep_mesh, only: interval_t, mesh_t
  implicit none
  private
  public :: shared_t, springs_t, find_law, find_law_values, springs_at, find_law_of_pair, find_closed, product_of

  !> Kind of compliance that the pairs share.
  type :: shared_t
    logical :: any = .false.                     !< true: they share one compliance
    logical :: coupled = .false.                 !< true: the compliance is a matrix
    real(dp) :: beyond = 0                       !< compliance shared by pairs that are farther apart than neighbours, m/N
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

  !> Computes the law of a contact set at one place, with derivatives.
  pure subroutine find_law(contact_set, kind, stiffness, profile_error, shared, effective, touching)
    integer, intent(in) :: contact_set           !< bit j - 1: pair j is in contact
    type(shared_t), intent(in) :: kind
    real(dp), intent(in) :: stiffness(0:, :), profile_error(0:, :), shared(0:, :)  !< as in springs_t; (0:2, pair)
    real(dp), intent(out) :: effective(0:, :)    !< g_j, N/m; 0 for an open pair; (0:2, pair)
    real(dp), intent(out) :: touching(0:, :)     !< t_j, m; (0:2, pair)
    integer :: j

    if (kind%coupled) then
      call find_coupled(contact_set, compliances(stiffness, shared, kind%beyond), profile_error, effective, touching)
    else if (kind%any) then
      call find_in_series(contact_set, stiffness, profile_error, shared(:, 1), effective, touching)
    else
      do j = 1, size(stiffness, 2)
        effective(0:2, j) = 0
        if (btest(contact_set, j - 1)) effective(0:2, j) = stiffness(0:2, j)
        touching(0:2, j) = profile_error(0:2, j)
      end do
    end if
  end subroutine find_law

  !> Computes the law of pairs that share one compliance.
  pure subroutine find_in_series(contact_set, stiffness, profile_error, shared, effective, touching)
    integer, intent(in) :: contact_set
    real(dp), intent(in) :: stiffness(0:, :), profile_error(0:, :), shared(0:2)
    real(dp), intent(out) :: effective(0:, :), touching(0:, :)
    real(dp), dimension(0:2) :: a, b, soft
    integer :: j

    a = 0
    b = 0
    do j = 1, size(stiffness, 2)
      effective(0:2, j) = 0
      if (.not. btest(contact_set, j - 1)) cycle
      effective(0:2, j) = own_stiffness(shared, stiffness(0:2, j))
      a = a + effective(0:2, j)
      b = b + product_of(effective(0:2, j), profile_error(0:2, j))
    end do
    soft = product_of(shared, a)
    soft(0) = 1 + soft(0)
    b = product_of(shared, b)
    do j = 1, size(stiffness, 2)
      effective(0:2, j) = quotient_of(effective(0:2, j), soft)
      touching(0:2, j) = product_of(profile_error(0:2, j), soft) - b
    end do
  end subroutine find_in_series

  !> Computes the law of a contact set at several places, values alone.
  pure subroutine find_law_values(contact_set, kind, stiffness, profile_error, shared, effective, touching)
    integer, intent(in) :: contact_set           !< bit j - 1: pair j is in contact
    type(shared_t), intent(in) :: kind
    real(dp), intent(in) :: stiffness(:, :), profile_error(:, :), shared(:, :)     !< as in springs_t
    real(dp), intent(out) :: effective(:, :)     !< g_j, N/m; 0 for an open pair; (place, pair)
    real(dp), intent(out) :: touching(:, :)      !< t_j, m; (place, pair)
    real(dp) :: a, b
    integer :: j, k

    do k = 1, merge(size(stiffness, 1), 0, kind%coupled)
      call find_coupled(contact_set, compliances(stiffness(k:k, :), shared(k:k, :), kind%beyond), profile_error(k:k, :), &
                        effective(k:k, :), touching(k:k, :))
    end do
    if (kind%coupled) return
    do j = 1, size(stiffness, 2)
      effective(:, j) = 0
      if (btest(contact_set, j - 1)) effective(:, j) = stiffness(:, j)
      touching(:, j) = profile_error(:, j)
    end do
    do k = 1, merge(size(stiffness, 1), 0, kind%any)
      a = 0
      b = 0
      do j = 1, size(stiffness, 2)
        effective(k, j) = effective(k, j)/(1 - shared(k, 1)*effective(k, j))
        a = a + effective(k, j)
        b = b + effective(k, j)*profile_error(k, j)
      end do
      do j = 1, size(stiffness, 2)
        effective(k, j) = effective(k, j)/(1 + shared(k, 1)*a)
        touching(k, j) = profile_error(k, j)*(1 + shared(k, 1)*a) - shared(k, 1)*b
      end do
    end do
  end subroutine find_law_values

  !> Computes the law of coupled pairs; without derivatives where the arrays have none.
  pure subroutine find_coupled(contact_set, c, profile_error, effective, touching)
    integer, intent(in) :: contact_set
    real(dp), intent(in) :: c(0:, :, :)          ! compliance matrix
    real(dp), intent(in) :: profile_error(0:, :)
    real(dp), intent(out) :: effective(0:, :), touching(0:, :)
    real(dp), dimension(0:ubound(c, 1), size(c, 3)) :: h
    real(dp), dimension(0:2) :: part, left, with
    integer :: i, j, n

    n = ubound(c, 1)
    call respond(contact_set, c, profile_error, effective, h)
    with = 0
    do j = 1, size(c, 3)
      part = 0
      part(0) = 1
      left = 0
      left(:n) = profile_error(:, j)
      do i = 1, size(c, 3)
        if (i == j) cycle
        with(:n) = c(:, j, i)
        part = part - product_of(with, padded(effective(:, i)))
        left = left - product_of(with, padded(h(:, i)))
      end do
      left = quotient_of(left, part)
      touching(:, j) = left(:n)
    end do
  end subroutine find_coupled

  !> Extends an array by derivatives of 0 where it has none.
  pure function padded(a) result(b)
    real(dp), intent(in) :: a(:)
    real(dp) :: b(0:2)

    b = 0
    b(:size(a) - 1) = a
  end function padded

  !> Compliance matrix (m/N); (0:2, pair, pair).
  pure function compliances(stiffness, shared, beyond) result(c)
    real(dp), intent(in) :: stiffness(0:, :), shared(0:, :), beyond
    real(dp) :: c(0:ubound(stiffness, 1), size(stiffness, 2), size(stiffness, 2)), own(0:2)
    integer :: j

    c = 0
    c(0, :, :) = beyond
    do j = 1, size(stiffness, 2)
      c(:, j, j) = 0
      ! A pair that is not yet in contact range has no stiffness.
      if (stiffness(0, j) > 0) then
        own = quotient_of([1.0_dp, 0.0_dp, 0.0_dp], padded(stiffness(:, j)))
        c(:, j, j) = own(:ubound(c, 1))
      end if
      if (j == size(stiffness, 2)) exit
      c(:, j, j + 1) = shared(:, j)
      c(:, j + 1, j) = shared(:, j)
    end do
  end function compliances

  !> Solves for g (N/m) and h (N) of coupled pairs; 0 for open pairs.
  pure subroutine respond(contact_set, c, profile_error, g, h)
    integer, intent(in) :: contact_set
    real(dp), intent(in) :: c(0:, :, :), profile_error(0:, :)
    real(dp), intent(out), dimension(0:, :) :: g, h
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
    ! The first and second derivatives of the equations have the same matrix.
    do k = 0, ubound(c, 1)
      b(:, 1) = merge(1, 0, k == 0)
      b(:, 2) = profile_error(k, :)
      do j = 1, merge(size(c, 3), 0, k > 0)
        b(j, 1) = b(j, 1) - k*dot_product(c(1, j, :), g(k - 1, :))
        b(j, 2) = b(j, 2) - k*dot_product(c(1, j, :), h(k - 1, :))
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

  !> Computes the pairs of an interval at some phases; one-sided at the interval's ends.
  pure subroutine springs_at(mesh, interval, phase, springs)
    type(mesh_t), intent(in) :: mesh
    type(interval_t), intent(in) :: interval
    real(dp), intent(in) :: phase(:)             !< 0 to 1
    type(springs_t), intent(out) :: springs
    real(dp) :: s
    integer :: j, k

    springs%kind%any = mesh%disc%shared > 0
    springs%kind%coupled = springs%kind%any .and. mesh%is_coupled(interval%pairs)
    springs%kind%beyond = mesh%disc%shared_beyond()
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

    if (.not. mesh%disc%shared > 0) then
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

  !> Own stiffness of a pair (N/m), without the shared compliance, all of which acts on it while it carries alone.
  pure function own_stiffness(shared, stiffness) result(own)
    real(dp), intent(in) :: shared(0:2)          !< compliance C, m/N
    real(dp), intent(in) :: stiffness(0:2)       !< K, N/m
    real(dp) :: own(0:2), rest(0:2)

    rest = -product_of(shared, stiffness)
    rest(0) = 1 + rest(0)
    own = quotient_of(stiffness, rest)
  end function own_stiffness

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

  !> Quotient with its first and second derivative.
  pure function quotient_of(a, b) result(c)
    real(dp), intent(in) :: a(0:2), b(0:2)
    real(dp) :: c(0:2)

    c(0) = a(0)/b(0)
    c(1) = (a(1) - c(0)*b(1))/b(0)
    c(2) = (a(2) - 2*c(1)*b(1) - c(0)*b(2))/b(0)
  end function quotient_of
end module gearsweep_motion_contact_law
