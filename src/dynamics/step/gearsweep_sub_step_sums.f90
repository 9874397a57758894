!> Sums over the closed contacts within a step, where each speed of a batch has a place of its own.
module gearsweep_sub_step_sums
  use gearsweep_contact_set, only: contact_t
  use gearsweep_coupled_pairs, only: sum_response
  use gearsweep_gauss, only: batch_size
  use gearsweep_kinds, only: dp
  use gearsweep_mesh, only: coupling
  use gearsweep_period_map, only: period_map_t
  use gearsweep_quintic, only: value_of
  use gearsweep_shared_compliance, only: reduce_sums
  use gearsweep_sub_steps, only: places, sub_steps_t
  implicit none
  private
  public :: sum_contacts

contains

  !> Sums over the closed contacts at one place of the sub-steps.
  pure subroutine sum_contacts(map, contacts, k, c)
    type(period_map_t), intent(in) :: map
    type(contact_t), intent(in) :: contacts(:)
    integer, intent(in) :: k                     !< which of the places
    type(sub_steps_t), intent(inout) :: c
    real(dp), dimension(batch_size) :: place, omega_squared, forcing
    integer :: j

    place = c%left + c%width*places(k)
    omega_squared = 0
    forcing = 0
    if (map%table%coupled(c%step)) then
      call sum_coupled(map, contacts, place, c, omega_squared, forcing)
      if (map%osc%has_backlash) call add_coast(map, contacts, place, c, omega_squared, forcing)
      c%omega_squared(:, k) = omega_squared
      c%forcing(:, k) = forcing
      return
    end if
    if (map%osc%shared > 0) then
      call sum_in_series(map, contacts, place, c, omega_squared, forcing)
    else
      do j = 1, map%table%pairs(c%step)
        call add_pair(map%speeds, c%stiffness(:, j), c%profile_error(:, j), c%mobility(:, j), place, contacts(j)%weight, &
                      omega_squared, forcing)
      end do
    end if
    if (map%osc%has_backlash) call add_coast(map, contacts, place, c, omega_squared, forcing)
    c%omega_squared(:, k) = omega_squared
    c%forcing(:, k) = forcing
  end subroutine sum_contacts

  !> The sums over pairs that share a compliance.
  pure subroutine sum_in_series(map, contacts, place, c, omega_squared, forcing)
    type(period_map_t), intent(in) :: map
    type(contact_t), intent(in) :: contacts(:)
    real(dp), intent(in) :: place(batch_size)
    type(sub_steps_t), intent(in) :: c
    real(dp), intent(inout), dimension(batch_size) :: omega_squared, forcing
    real(dp), dimension(batch_size) :: a, b
    real(dp) :: t, k, e, mobility
    integer :: j, l

    a = 0
    b = 0
    do j = 1, map%table%pairs(c%step)
      associate (s => c%stiffness(:, j), p => c%profile_error(:, j), m => c%mobility(:, j), weight => contacts(j)%weight)
        do l = 1, map%speeds
          t = place(l)
          k = weight(l)*(((((s(6)*t + s(5))*t + s(4))*t + s(3))*t + s(2))*t + s(1))
          e = ((((p(6)*t + p(5))*t + p(4))*t + p(3))*t + p(2))*t + p(1)
          mobility = m(1) + m(2)*t
          a(l) = a(l) + k
          b(l) = b(l) + k*e
          omega_squared(l) = omega_squared(l) + k*mobility
          forcing(l) = forcing(l) + k*mobility*e
        end do
      end associate
    end do
    call reduce_sums(shared_by_two(c, place), a, b, omega_squared, forcing)
  end subroutine sum_in_series

  !> What the first two pairs share at a place of the step, m/N.
  pure function shared_by_two(c, place) result(shared)
    type(sub_steps_t), intent(in) :: c
    real(dp), intent(in) :: place(batch_size)
    real(dp) :: shared(batch_size)

    shared = c%shared(0, 1) + place*(c%shared(1, 1) + place*c%shared(2, 1))
  end function shared_by_two

  !> The sums over coupled pairs in contact.
  pure subroutine sum_coupled(map, contacts, place, c, omega_squared, forcing)
    type(period_map_t), intent(in) :: map
    type(contact_t), intent(in) :: contacts(:)
    real(dp), intent(in) :: place(batch_size)
    type(sub_steps_t), intent(in) :: c
    real(dp), intent(inout), dimension(batch_size) :: omega_squared, forcing
    real(dp), dimension(map%table%pairs(c%step)) :: error, mobility
    integer :: set, j, l

    do l = 1, map%speeds
      set = 0
      do j = 1, map%table%pairs(c%step)
        if (contacts(j)%weight(l) > 0) set = ibset(set, j - 1)
        error(j) = value_of(c%profile_error(:, j), place(l))
        mobility(j) = c%mobility(0, j) + c%mobility(1, j)*place(l)
      end do
      call sum_response(set, coupling_within(map, c, place(l)), error, mobility, omega_squared(l), forcing(l))
    end do
  end subroutine sum_coupled

  !> The matrix of coupled pairs at a place of the step, m/N.
  pure function coupling_within(map, c, place) result(matrix)
    type(period_map_t), intent(in) :: map
    type(sub_steps_t), intent(in) :: c
    real(dp), intent(in) :: place
    real(dp) :: matrix(map%table%pairs(c%step), map%table%pairs(c%step))
    integer :: j

    associate (p => map%table%pairs(c%step))
      matrix = coupling(map%osc%mesh, [(value_of(c%stiffness(:, j), place), j=1, p)], &
                        c%shared(0, :p - 1) + place*(c%shared(1, :p - 1) + place*c%shared(2, :p - 1)))
    end associate
  end function coupling_within

  !> The coast sides, backed by the stiffness of all pairs between A and E.
  pure subroutine add_coast(map, contacts, place, c, omega_squared, forcing)
    type(period_map_t), intent(in) :: map
    type(contact_t), intent(in) :: contacts(:)
    real(dp), intent(in) :: place(batch_size)
    type(sub_steps_t), intent(in) :: c
    real(dp), intent(inout), dimension(batch_size) :: omega_squared, forcing
    real(dp), dimension(batch_size) :: rate, pull
    real(dp) :: slack(0:5)
    integer :: j

    slack = 0
    slack(0) = -map%osc%backlash
    associate (osc => map%osc, coast => contacts(map%osc%contacts)%weight)
      if (map%table%coupled(c%step)) then
        call add_coupled_coast(map, coast, place, c, omega_squared, forcing)
      else if (osc%shared > 0) then
        rate = 0
        pull = 0
        do j = 1, map%table%pairs(c%step)
          if (.not. btest(map%table%between(c%step), j - 1)) cycle
          call add_pair(map%speeds, c%stiffness(:, j), slack, [1.0_dp, 0.0_dp], place, coast, rate, pull)
        end do
        omega_squared = omega_squared + sum(1/osc%mass)*rate/(1 + shared_by_two(c, place)*rate)
        forcing = forcing + sum(1/osc%mass)*pull/(1 + shared_by_two(c, place)*rate)
      else
        do j = 1, map%table%pairs(c%step)
          if (.not. btest(map%table%between(c%step), j - 1)) cycle
          call add_pair(map%speeds, c%stiffness(:, j), slack, [sum(1/osc%mass), 0.0_dp], place, coast, omega_squared, forcing)
        end do
      end if
    end associate
  end subroutine add_coast

  !> The same where pairs are coupled.
  pure subroutine add_coupled_coast(map, closed, place, c, omega_squared, forcing)
    type(period_map_t), intent(in) :: map
    real(dp), intent(in), dimension(batch_size) :: closed, place   ! 1 where the coast sides are in contact
    type(sub_steps_t), intent(in) :: c
    real(dp), intent(inout), dimension(batch_size) :: omega_squared, forcing
    real(dp), dimension(map%table%pairs(c%step)) :: slack, mobility
    real(dp) :: rate, pull
    integer :: l

    slack = -map%osc%backlash
    mobility = sum(1/map%osc%mass)
    do l = 1, map%speeds
      if (.not. closed(l) > 0) cycle
      call sum_response(map%table%between(c%step), coupling_within(map, c, place(l)), slack, mobility, rate, pull)
      omega_squared(l) = omega_squared(l) + rate
      forcing(l) = forcing(l) + pull
    end do
  end subroutine add_coupled_coast

  pure subroutine add_pair(n, stiffness, profile_error, mobility, place, weight, omega_squared, forcing)
    integer, intent(in) :: n
    real(dp), intent(in) :: stiffness(0:5), profile_error(0:5), mobility(0:1)
    real(dp), intent(in), dimension(batch_size) :: place, weight
    real(dp), intent(inout), dimension(batch_size) :: omega_squared, forcing
    real(dp) :: t, k, e, rate
    integer :: l

    associate (s => stiffness, p => profile_error)
      do l = 1, n
        t = place(l)
        k = ((((s(5)*t + s(4))*t + s(3))*t + s(2))*t + s(1))*t + s(0)
        e = ((((p(5)*t + p(4))*t + p(3))*t + p(2))*t + p(1))*t + p(0)
        rate = weight(l)*k*(mobility(0) + mobility(1)*t)
        omega_squared(l) = omega_squared(l) + rate
        forcing(l) = forcing(l) + rate*e
      end do
    end associate
  end subroutine add_pair
end module gearsweep_sub_step_sums
