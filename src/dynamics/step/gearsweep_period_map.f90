!> The map of the state over one mesh period, for a batch of speeds: the equation of motion, its coefficients, the
!> durations of the period, and what each step makes of the state.
!>
!> Over a step whose contact set does not change, the state at the end is an affine function of that at the begin:
!> the step's propagator. It depends on the contact set alone, so it is cached for the next motion through the
!> period. All speeds of a batch share the coefficients, which are read once for all.
module gearsweep_period_map
  use gearsweep_coefficients, only: coefficients_t, resolution_t, scheme_collocation, tabulate
  use gearsweep_contact_set, only: contact_t, keep_derivative, period_t
  use gearsweep_gauss, only: batch_size, collocate
  use gearsweep_kinds, only: dp
  use gearsweep_literature_period, only: run_literature_period
  use gearsweep_literature_table, only: exact_step_t, literature_table_t, tabulate_literature
  use gearsweep_oscillator, only: oscillator_t, damping, split_by_load
  use gearsweep_radau, only: collocate_stiffly
  use gearsweep_shared_coefficients, only: sum_at_node
  use gearsweep_shared_compliance, only: reduce_sums
  implicit none
  private
  public :: dense_step_t, period_map_t, discretise, set_durations, need_propagator, take_step, compose, flush_to_zero
  public :: leave_full_contact, run_full_contact, propagate_alike, whole

  !> A step in which contact changes, before the change or behind it: also the motion within (gearsweep_dense_step).
  type :: dense_step_t
    integer :: step = 0, contact_set = 0
    real(dp) :: propagator(batch_size, 6) = 0    !< as below
    real(dp) :: c(batch_size, 0:7, 3) = 0        !< coefficients in ascending powers; (speed, power, by what)
  end type dense_step_t

  type :: period_map_t
    type(oscillator_t) :: osc
    integer :: steps = 0                         !< of the period; 0: the memory does not hold them
    type(coefficients_t) :: table
    !> In place of `table` and the propagators, for the methods of the literature; one speed at a time.
    type(literature_table_t), allocatable :: literature
    integer :: speeds = 0                        !< of the batch that are used
    real(dp) :: duration(batch_size) = 0         !< of the mesh period at each speed, s
    !> Every step has a place for its propagator; of longer periods than `most_cached` steps only the last is kept.
    logical :: cached = .false.
    !> What x, y and 1 contribute to x and y at the end of the step, two elements each; (speed, element, place)
    real(dp), allocatable :: propagator(:, :, :)
    integer, allocatable :: contact_set(:, :)    !< for which it is; (speed, place)
    logical :: all_full = .false.                !< all are those of full contact, and then:
    real(dp) :: monodromy(batch_size, 4) = 0     !< all of them composed, columns one after the other
    real(dp) :: shrunk(batch_size) = 0           !< logarithm of what was taken out of that
    type(dense_step_t) :: dense(8)               !< those made last
    integer :: denses = 0                        !< how many have been made
  end type period_map_t
  integer, parameter :: most_cached = 2048, not_made = -1

  !> All of load and profile error.
  real(dp), parameter :: whole(2) = 1

  !> A derivative by the first state below this tells nothing; on its way to 0 it would slow the processor down.
  real(dp), parameter :: negligible = 1e-150_dp

contains

  !> Cuts the period into steps and tabulates the coefficients; `set_durations` comes next.
  pure subroutine discretise(osc, resolution, map)
    type(oscillator_t), intent(in) :: osc
    type(resolution_t), intent(in) :: resolution
    type(period_map_t), intent(inout) :: map     !< its memory serves again; without steps where memory lacks

    map%osc = osc
    if (resolution%by_load) call split_by_load(map%osc)
    if (resolution%scheme == scheme_collocation) then
      if (allocated(map%literature)) deallocate (map%literature)
      call tabulate(map%osc, resolution, map%table)
      map%steps = map%table%steps
    else
      if (.not. allocated(map%literature)) allocate (map%literature)
      call tabulate_literature(osc, resolution, map%literature)
      map%steps = map%literature%steps
    end if
  end subroutine discretise

  !> Sets the durations of the period (s) at up to `batch_size` speeds, and forgets all propagators.
  pure subroutine set_durations(map, duration)
    type(period_map_t), intent(inout) :: map
    real(dp), intent(in) :: duration(:)          !< of one speed, or of a whole batch, s
    integer :: places

    map%speeds = size(duration)
    map%duration = duration(size(duration))
    map%duration(:size(duration)) = duration
    if (allocated(map%literature)) then
      if (map%steps > 0) map%literature%exact = exact_step_t()
      return
    end if
    map%cached = map%table%steps <= most_cached
    places = merge(map%table%steps, 1, map%cached)
    if (allocated(map%contact_set)) then
      if (size(map%contact_set, 2) < places) deallocate (map%contact_set, map%propagator)
    end if
    if (.not. allocated(map%contact_set)) then
      allocate (map%contact_set(batch_size, places), map%propagator(batch_size, 6, places))
      ! The places of a batch that are not used are computed with the others, at rest.
      map%propagator = 0
    end if
    map%contact_set(:, :places) = not_made
    map%all_full = .false.
    map%denses = 0
  end subroutine set_durations

  !> Makes the propagator of a step unless it is cached.
  pure subroutine need_propagator(map, step, contact_set, contacts, place)
    type(period_map_t), intent(inout) :: map
    integer, intent(in) :: step
    integer, intent(in) :: contact_set(batch_size)         !< of each speed
    type(contact_t), intent(in) :: contacts(:)             !< the same, contact by contact
    integer, intent(out) :: place                          !< of the propagator in the cache
    integer :: full(batch_size)

    place = merge(step, 1, map%cached)
    if (map%cached .and. are_same(contact_set, map%contact_set(:, place))) return
    full = map%table%full(step)
    if (are_same(contact_set, full)) then
      call propagate_alike(map%osc, map%table, step, map%duration(:map%speeds), whole, map%propagator(:, :, place))
    else
      call propagate(map%osc, map%table, step, map%duration(:map%speeds), contacts, map%propagator(:, :, place))
    end if
    map%contact_set(:, place) = contact_set
  end subroutine need_propagator

  pure logical function are_same(a, b)
    integer, intent(in), dimension(batch_size) :: a, b
    integer :: other, l

    other = 0
    do l = 1, batch_size
      other = ior(other, ieor(a(l), b(l)))
    end do
    are_same = other == 0
  end function are_same

  !> The propagator of a contact set that is the same at all speeds: of full contact, whose sums the table has, or of another one.
  pure subroutine propagate_alike(osc, table, step, duration, parts, propagator, contact_set)
    type(oscillator_t), intent(in) :: osc
    type(coefficients_t), intent(in) :: table
    integer, intent(in) :: step
    real(dp), intent(in) :: duration(:)                    !< of the mesh period at each speed, s
    real(dp), intent(in) :: parts(2)                       !< of the load and of the profile error that force the motion
    real(dp), intent(inout) :: propagator(batch_size, 6)   !< (speed, element)
    integer, intent(in), optional :: contact_set           !< of pairs that are not coupled
    real(dp), dimension(batch_size, 3) :: omega_squared, damped, forcing
    real(dp), dimension(3) :: omegas_squared, dampings, forcings
    real(dp) :: time
    integer :: l

    if (present(contact_set)) then
      call sum_at_nodes(osc, table, step, contact_set, omegas_squared, forcings)
      dampings = damping(osc, 1.0_dp)*sqrt(omegas_squared)
      forcings = parts(2)*forcings + parts(1)*(osc%load*sum(1/osc%mass))
    else
      omegas_squared = table%omega_squared(:, step)
      dampings = damping(osc, 1.0_dp)*table%omega(:, step)
      forcings = parts(2)*table%forcing(:, step) + parts(1)*(osc%load*sum(1/osc%mass))
    end if
    do l = 1, size(duration)
      time = duration(l)*table%width(step)
      damped(l, 1) = dampings(1)*time
      damped(l, 2) = dampings(2)*time
      damped(l, 3) = dampings(3)*time
      time = time**2
      omega_squared(l, 1) = omegas_squared(1)*time
      omega_squared(l, 2) = omegas_squared(2)*time
      omega_squared(l, 3) = omegas_squared(3)*time
      forcing(l, 1) = forcings(1)*time
      forcing(l, 2) = forcings(2)*time
      forcing(l, 3) = forcings(3)*time
    end do
    call collocate_step(size(duration), table%width(step), table%kind(step)%stiff, omega_squared, damped, forcing, propagator)
  end subroutine propagate_alike

  !> Sums of omega^2 (1/s^2) and k e (m/s^2) at the nodes of a step.
  pure subroutine sum_at_nodes(osc, table, step, contact_set, omega_squared, forcing)
    type(oscillator_t), intent(in) :: osc
    type(coefficients_t), intent(in) :: table
    integer, intent(in) :: step, contact_set
    real(dp), intent(out), dimension(3) :: omega_squared, forcing
    real(dp), dimension(3) :: a, b
    integer :: j

    omega_squared = 0
    forcing = 0
    a = 0
    b = 0
    do j = 1, table%pairs(step)
      if (.not. btest(contact_set, j - 1)) cycle
      omega_squared = omega_squared + table%rate(j, :, step)
      forcing = forcing + table%rate(j, :, step)*table%profile_error(j, :, step)
      if (.not. osc%shared > 0) cycle
      a = a + table%node_stiffness(j, :, step)
      b = b + table%node_stiffness(j, :, step)*table%profile_error(j, :, step)
    end do
    if (osc%shared > 0) call reduce_sums(table%node_shared(1, :, step), a, b, omega_squared, forcing)
  end subroutine sum_at_nodes

  !> The propagator where each speed has contacts of its own.
  pure subroutine propagate(osc, table, step, duration, contacts, propagator)
    type(oscillator_t), intent(in) :: osc
    type(coefficients_t), intent(in) :: table
    integer, intent(in) :: step
    real(dp), intent(in) :: duration(:)
    type(contact_t), intent(in) :: contacts(:)
    real(dp), intent(inout) :: propagator(batch_size, 6)
    real(dp), dimension(batch_size, 3) :: omega_squared, damped, forcing
    real(dp) :: time, rate, pull, factor
    integer :: j, k, l

    omega_squared = 0
    forcing = 0
    do j = 1, osc%contacts
      if (j > table%pairs(step) .and. j <= osc%pairs) cycle
      if (j > osc%pairs .and. osc%shared > 0) call share_compliance(osc, table, step, contacts, omega_squared, forcing)
      if (j <= osc%pairs .and. table%coupled(step)) cycle
      do k = 1, 3
        rate = table%rate(j, k, step)
        pull = rate*table%profile_error(j, k, step)
        do l = 1, size(duration)
          omega_squared(l, k) = omega_squared(l, k) + contacts(j)%weight(l)*rate
          forcing(l, k) = forcing(l, k) + contacts(j)%weight(l)*pull
        end do
      end do
    end do
    if (osc%shared > 0 .and. .not. osc%has_backlash) call share_compliance(osc, table, step, contacts, omega_squared, forcing)
    factor = damping(osc, 1.0_dp)
    do k = 1, 3
      do l = 1, size(duration)
        time = duration(l)*table%width(step)
        damped(l, k) = factor*sqrt(omega_squared(l, k))*time
        time = time**2
        omega_squared(l, k) = omega_squared(l, k)*time
        forcing(l, k) = (forcing(l, k) + osc%load*sum(1/osc%mass))*time
      end do
    end do
    call collocate_step(size(duration), table%width(step), table%kind(step)%stiff, omega_squared, damped, forcing, propagator)
  end subroutine propagate

  !> Turns the sums over the pairs in contact into those of pairs that share a compliance.
  pure subroutine share_compliance(osc, table, step, contacts, omega_squared, forcing)
    type(oscillator_t), intent(in) :: osc
    type(coefficients_t), intent(in) :: table
    integer, intent(in) :: step
    type(contact_t), intent(in) :: contacts(:)
    real(dp), intent(inout), dimension(batch_size, 3) :: omega_squared, forcing
    real(dp), dimension(batch_size) :: a, b
    integer :: set, j, k, l

    if (table%coupled(step)) then
      do l = 1, batch_size
        set = 0
        do j = 1, table%pairs(step)
          if (contacts(j)%weight(l) > 0) set = ibset(set, j - 1)
        end do
        do k = 1, 3
          call sum_at_node(osc, table, step, k, set, omega_squared(l, k), forcing(l, k))
        end do
      end do
      return
    end if
    do k = 1, 3
      a = 0
      b = 0
      do j = 1, table%pairs(step)
        a = a + contacts(j)%weight*table%node_stiffness(j, k, step)
        b = b + contacts(j)%weight*(table%node_stiffness(j, k, step)*table%profile_error(j, k, step))
      end do
      call reduce_sums(table%node_shared(1, k, step), a, b, omega_squared(:, k), forcing(:, k))
    end do
  end subroutine share_compliance

  !> Collocation over a step, from displacements over the step to derivatives over the phase. It divides by the
  !> width, as the rounding of a factor 1/width would be the same in each of many steps.
  pure subroutine collocate_step(n, width, stiff, omega_squared, damped, forcing, propagator)
    integer, intent(in) :: n
    real(dp), intent(in) :: width
    logical, intent(in) :: stiff
    real(dp), intent(in), dimension(batch_size, 3) :: omega_squared, damped, forcing
    real(dp), intent(inout) :: propagator(batch_size, 6)   ! of speeds that are not used: as it was
    integer :: l

    if (stiff) then
      call collocate_stiffly(n, omega_squared, damped, forcing, propagator)
    else
      call collocate(n, omega_squared, damped, forcing, propagator)
    end if
    do l = 1, n
      propagator(l, 2) = propagator(l, 2)/width
      propagator(l, 3) = propagator(l, 3)*width
      propagator(l, 6) = propagator(l, 6)/width
    end do
  end subroutine collocate_step

  !> The state after a step, for a whole batch.
  pure subroutine take_step(propagator, x, y, x_next, y_next)
    real(dp), intent(in) :: propagator(batch_size, 6)
    real(dp), intent(in), dimension(batch_size) :: x, y              !< at the begin of the step, m
    real(dp), intent(out), dimension(batch_size) :: x_next, y_next   !< at its end, m
    integer :: l

    do l = 1, batch_size
      x_next(l) = propagator(l, 1)*x(l) + propagator(l, 3)*y(l) + propagator(l, 5)
      y_next(l) = propagator(l, 2)*x(l) + propagator(l, 4)*y(l) + propagator(l, 6)
    end do
  end subroutine take_step

  !> Lets a step follow what was before it.
  pure subroutine compose(propagator, monodromy)
    real(dp), intent(in) :: propagator(batch_size, 6)
    !> Derivative of the state by that at the begin of the period, columns one after the other; (speed, element)
    real(dp), intent(inout) :: monodromy(batch_size, 4)
    real(dp) :: x, y
    integer :: k, l

    do k = 1, 3, 2
      do l = 1, batch_size
        x = monodromy(l, k)
        y = monodromy(l, k + 1)
        monodromy(l, k) = propagator(l, 1)*x + propagator(l, 3)*y
        monodromy(l, k + 1) = propagator(l, 2)*x + propagator(l, 4)*y
      end do
    end do
  end subroutine compose

  !> Leaves full contact after so many steps: composes these and marks that what follows has other contact sets.
  pure subroutine leave_full_contact(map, steps, monodromy, shrunk)
    type(period_map_t), intent(inout) :: map
    integer, intent(in) :: steps
    real(dp), intent(inout) :: monodromy(batch_size, 4), shrunk(batch_size)    !< as in `flush_to_zero`
    integer :: i

    do i = 1, steps
      call compose(map%propagator(:, :, i), monodromy)
      if (modulo(i, 64) == 0) call flush_to_zero(monodromy, shrunk)
    end do
    map%all_full = .false.
  end subroutine leave_full_contact

  !> Sets a derivative to zero that has decayed to nothing. With `shrunk`, scales it up instead, and adds the logarithm of the
  !> scale to `shrunk`.
  pure subroutine flush_to_zero(monodromy, shrunk)
    real(dp), intent(inout) :: monodromy(batch_size, 4)    !< as in `compose`
    real(dp), intent(inout), optional :: shrunk(batch_size)
    integer :: l

    do l = 1, batch_size
      if (.not. all(abs(monodromy(l, :)) < negligible)) cycle
      if (present(shrunk)) then
        monodromy(l, :) = monodromy(l, :)/negligible
        shrunk(l) = shrunk(l) + log(negligible)
      else
        monodromy(l, :) = 0
      end if
    end do
  end subroutine flush_to_zero

  !> One period in which full contact stays, whether a pair pushes or pulls: the state after it and the monodromy matrix,
  !> but no loads.
  pure subroutine run_full_contact(map, start, period)
    type(period_map_t), intent(inout) :: map
    real(dp), intent(in) :: start(:, :)                    !< x, y (m) at the begin; (2, speed)
    type(period_t), intent(inout) :: period(:)             !< of each speed
    real(dp) :: monodromy(batch_size, 4), shrunk(batch_size), x(batch_size, 2), y(batch_size, 2)
    integer :: place, from, to, i, l

    if (allocated(map%literature)) then
      call run_literature_period(map%osc, map%literature, map%duration(1), start(:, 1), .true., period(1))
      return
    end if
    from = 1
    to = 2
    x(:, from) = 0
    y(:, from) = 0
    x(:map%speeds, from) = start(1, :)
    y(:map%speeds, from) = start(2, :)
    monodromy = 0
    monodromy(:, 1) = 1
    monodromy(:, 4) = 1
    shrunk = 0
    do i = 1, map%table%steps
      place = merge(i, 1, map%cached)
      call propagate_alike(map%osc, map%table, i, map%duration(:map%speeds), whole, map%propagator(:, :, place))
      map%contact_set(:, place) = map%table%full(i)
      call compose(map%propagator(:, :, place), monodromy)
      if (modulo(i, 64) == 0) call flush_to_zero(monodromy, shrunk)
      call take_step(map%propagator(:, :, place), x(:, from), y(:, from), x(:, to), y(:, to))
      from = to
      to = 3 - from
    end do
    map%all_full = map%cached
    map%monodromy = monodromy
    map%shrunk = shrunk
    do l = 1, map%speeds
      call keep_derivative(monodromy(l, :), shrunk(l), period(l))
      period(l)%state = [x(l, from), y(l, from)]
    end do
  end subroutine run_full_contact
end module gearsweep_period_map
