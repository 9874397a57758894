!> The map of the state over one mesh period, for a batch of speeds: the equation of motion, its coefficients, the
!> durations of the period, and what each step makes of the state.
!>
!> Over a step whose contact set does not change, the state at the end is an affine function of that at the begin:
!> the step's propagator. It depends on the contact set alone, so it is cached for the next motion through the
!> period. All speeds of a batch share the coefficients, which are read once for all.
module gearsweep_period_map
  use gearsweep_coefficients, only: coefficients_t, forget_laws, need_law, resolution_t, scheme_collocation, tabulate
  use gearsweep_gauss, only: batch_size, collocate
  use gearsweep_kinds, only: dp
  use gearsweep_literature_table, only: exact_step_t, literature_table_t, tabulate_literature
  use gearsweep_oscillator, only: oscillator_t, damping, split_by_load
  use gearsweep_radau, only: collocate_stiffly
  implicit none
  private
  public :: dense_step_t, period_map_t, discretise, set_durations, need_laws, need_propagator, take_step, compose, flush_to_zero
  public :: leave_full_contact, propagate_alike, whole

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

  !> The laws of a batch of contact sets in a step.
  pure subroutine need_laws(map, step, contact_set, law)
    type(period_map_t), intent(inout) :: map
    integer, intent(in) :: step
    integer, intent(in) :: contact_set(batch_size)         !< of each speed
    integer, intent(out) :: law(batch_size)                !< by number, until the next are needed
    integer :: l

    if (map%table%laws + batch_size > size(map%table%next)) call forget_laws(map%table)
    call need_law(map%osc, step, contact_set(1), map%table, law(1))
    do l = 2, batch_size
      law(l) = law(l - 1)
      if (contact_set(l) /= contact_set(l - 1)) call need_law(map%osc, step, contact_set(l), map%table, law(l))
    end do
  end subroutine need_laws

  !> Makes the propagator of a step unless it is cached.
  pure subroutine need_propagator(map, step, contact_set, place)
    type(period_map_t), intent(inout) :: map
    integer, intent(in) :: step
    integer, intent(in) :: contact_set(batch_size)         !< of each speed
    integer, intent(out) :: place                          !< of the propagator in the cache
    integer :: law(batch_size)

    place = merge(step, 1, map%cached)
    if (map%cached .and. are_same(contact_set, map%contact_set(:, place))) return
    call need_laws(map, step, contact_set, law)
    if (all(law == law(1))) then
      call propagate_alike(map%osc, map%table, step, map%duration(:map%speeds), law(1), whole, map%propagator(:, :, place))
    else
      call propagate(map%osc, map%table, step, map%duration(:map%speeds), law, map%propagator(:, :, place))
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

  !> The propagator of one law at all speeds.
  pure subroutine propagate_alike(osc, table, step, duration, law, parts, propagator)
    type(oscillator_t), intent(in) :: osc
    type(coefficients_t), intent(in) :: table
    integer, intent(in) :: step, law
    real(dp), intent(in) :: duration(:)                    !< of the mesh period at each speed, s
    real(dp), intent(in) :: parts(2)                       !< of the load and of the profile error that force the motion
    real(dp), intent(inout) :: propagator(batch_size, 6)   !< (speed, element)
    real(dp), dimension(batch_size, 3) :: omega_squared, damped, forcing
    real(dp), dimension(3) :: dampings, forcings
    real(dp) :: time
    integer :: l

    dampings = damping(osc, 1.0_dp)*table%omega(:, law)
    forcings = parts(2)*table%forcing(:, law) + parts(1)*(osc%load*sum(1/osc%mass))
    do l = 1, size(duration)
      time = duration(l)*table%width(step)
      damped(l, 1) = dampings(1)*time
      damped(l, 2) = dampings(2)*time
      damped(l, 3) = dampings(3)*time
      time = time**2
      omega_squared(l, 1) = table%omega_squared(1, law)*time
      omega_squared(l, 2) = table%omega_squared(2, law)*time
      omega_squared(l, 3) = table%omega_squared(3, law)*time
      forcing(l, 1) = forcings(1)*time
      forcing(l, 2) = forcings(2)*time
      forcing(l, 3) = forcings(3)*time
    end do
    call collocate_step(size(duration), table%width(step), table%kind(step)%stiff, omega_squared, damped, forcing, propagator)
  end subroutine propagate_alike

  !> The propagator where each speed has a law of its own.
  pure subroutine propagate(osc, table, step, duration, law, propagator)
    type(oscillator_t), intent(in) :: osc
    type(coefficients_t), intent(in) :: table
    integer, intent(in) :: step
    real(dp), intent(in) :: duration(:)
    integer, intent(in) :: law(batch_size)
    real(dp), intent(inout) :: propagator(batch_size, 6)
    real(dp), dimension(batch_size, 3) :: omega_squared, damped, forcing
    real(dp) :: time, factor, load
    integer :: k, l

    factor = damping(osc, 1.0_dp)
    load = osc%load*sum(1/osc%mass)
    do k = 1, 3
      do l = 1, size(duration)
        time = duration(l)*table%width(step)
        damped(l, k) = factor*table%omega(k, law(l))*time
        time = time**2
        omega_squared(l, k) = table%omega_squared(k, law(l))*time
        forcing(l, k) = (table%forcing(k, law(l)) + load)*time
      end do
    end do
    call collocate_step(size(duration), table%width(step), table%kind(step)%stiff, omega_squared, damped, forcing, propagator)
  end subroutine propagate

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
end module gearsweep_period_map
