!> The map of the state over one mesh period, for a batch of speeds: the equation of motion, its coefficients, the durations of
!> the period, and the propagator of each step.
!>
!> Over a step whose contact set does not change, the state at the end is an affine function of that at the start: the step's
!> propagator. It depends on the contact set alone, so it is cached for the next motion through the period. All speeds of a batch
!> share the coefficients, which are read once for all. Where teeth deviate, the period is that of all mesh periods after which the
!> deviations repeat: the parts of the state are the same in each, and the part of 1 is the sum of the forcing at the nodes times
!> weights that are.
module gearsweep_motion_period_map
  use, intrinsic :: iso_c_binding, only: c_null_ptr, c_ptr
  use gearsweep_base, only: dp, wants_stop
  use gearsweep_motion_coefficients, only: coefficients_t, enter_period, forget_laws, need_law, tabulate
  use gearsweep_motion_gauss, only: batch_size, collocate, collocate_stiffly
  use gearsweep_motion_literature, only: exact_step_t, literature_table_t, tabulate_literature
  use gearsweep_motion_oscillator, only: damping, oscillator_t, split_by_load
  use gearsweep_motion_resolution, only: resolution_t, scheme_collocation
  implicit none
  private
  public :: period_map_t, discretise, set_durations, need_laws, need_propagator, take_step, compose, flush_to_zero
  public :: enter, leave_full_contact, propagate_alike, is_cut

  !> Step in which contact changes, before or after the change, with the motion within it (gearsweep_motion_dense_step).
  type :: dense_step_t
    integer :: step = 0, contact_set = 0
    real(dp) :: propagator(batch_size, 6) = 0    !< as in period_map_t, of x and its derivative over the step
    real(dp) :: c(batch_size, 0:7, 3) = 0        !< coefficients in ascending powers; (speed, power, by what)
  end type dense_step_t

  type :: period_map_t
    type(oscillator_t) :: osc
    integer :: steps = 0                         !< steps of the period; 0: memory is too small for them
    type(coefficients_t) :: table                !< coefficients of one mesh period
    !> Table of a method of the literature, used instead of `table` and the propagators; one speed at a time.
    type(literature_table_t), allocatable :: literature
    integer :: speeds = 0                        !< number of speeds used in the batch
    real(dp) :: duration(batch_size) = 0         !< duration of the mesh period at each speed, s
    !> True: each step stores its propagator; for periods of more than `most_cached` steps only the last is kept.
    logical :: cached = .false.
    !> Contributions of x, y and 1 to x and y at the end of the step, two elements each; (speed, element, place)
    real(dp), allocatable :: propagator(:, :, :)
    real(dp), allocatable :: weight(:, :, :)     !< weights of the forcing, as of `collocate`; (speed, element, place)
    integer, allocatable :: contact_set(:, :)    !< contact set of the propagator; (speed, place)
    integer, allocatable :: period(:)            !< mesh period of the propagator's part of 1; (place)
    logical :: all_full = .false.                !< true: all contact sets are full, and `monodromy` is valid
    real(dp) :: monodromy(batch_size, 4) = 0     !< product of all propagators, columns one after the other
    real(dp) :: shrunk(batch_size) = 0           !< logarithm of the factor removed from that
    real(dp) :: mesh_monodromy(batch_size, 4) = 0, mesh_shrunk(batch_size) = 0   !< the same of one mesh period
    type(dense_step_t) :: dense(8)               !< most recent ones
    integer :: denses = 0                        !< number computed so far
    real(dp) :: work = 0                         !< steps computed so far, of all motions
    type(c_ptr) :: stop = c_null_ptr             !< stop flag of gearsweep_base_memory
  end type period_map_t
  integer, parameter :: most_cached = 2048, not_made = -1

  !> Size below which a derivative by the first state is negligible; on its way to 0 it would slow the processor down.
  real(dp), parameter :: negligible = 1e-150_dp

contains

  !> Divides the period into steps and tabulates the coefficients; call `set_durations` next.
  pure subroutine discretise(osc, resolution, map)
    type(oscillator_t), intent(in) :: osc
    type(resolution_t), intent(in) :: resolution
    type(period_map_t), intent(inout) :: map     !< map; its memory is reused; no steps if memory is too small

    map%osc = osc
    if (resolution%by_load) call split_by_load(map%osc)
    if (resolution%scheme == scheme_collocation) then
      if (allocated(map%literature)) deallocate (map%literature)
      call tabulate(map%osc, resolution, map%table)
      map%steps = map%table%steps*map%osc%mesh%deviations%periods
    else
      if (.not. allocated(map%literature)) allocate (map%literature)
      call tabulate_literature(osc, resolution, map%literature)
      map%steps = map%literature%steps
    end if
  end subroutine discretise

  !> Sets the durations of the period (s) at up to `batch_size` speeds, and deletes all propagators.
  pure subroutine set_durations(map, duration, stop)
    type(period_map_t), intent(inout) :: map
    real(dp), intent(in) :: duration(:)          !< duration of one speed, or of all speeds of a batch, s
    !> Stop flag of gearsweep_base_memory, for the motions from now on
    type(c_ptr), intent(in), optional :: stop
    integer :: places

    if (present(stop)) map%stop = stop
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
      if (size(map%contact_set, 2) < places) deallocate (map%contact_set, map%propagator, map%weight, map%period)
    end if
    if (.not. allocated(map%contact_set)) then
      allocate (map%contact_set(batch_size, places), map%propagator(batch_size, 6, places))
      allocate (map%weight(batch_size, 6, places), map%period(places))
      ! Unused places of a batch are computed with the others, with a zero state.
      map%propagator = 0
    end if
    map%contact_set(:, :places) = not_made
    map%all_full = .false.
    map%denses = 0
  end subroutine set_durations

  !> Enters one of the mesh periods after which the deviations repeat.
  pure subroutine enter(map, period)
    type(period_map_t), intent(inout) :: map
    integer, intent(in) :: period                !< index from 0

    if (period == map%table%period) return
    call enter_period(map%osc, period, map%table)
    map%denses = 0
  end subroutine enter

  !> True if the caller stops the run in this step of a period. Only turns of many mesh periods take so long that this matters.
  pure logical function is_cut(map, step)
    type(period_map_t), intent(in) :: map
    integer, intent(in) :: step
    integer, parameter :: unheard = 4096         ! steps between two looks at the flag

    is_cut = modulo(map%table%period*map%table%steps + step, unheard) == 0
    if (is_cut) is_cut = wants_stop(map%stop)
  end function is_cut

  !> Finds the laws of a batch of contact sets in a step.
  pure subroutine need_laws(map, step, contact_set, law)
    type(period_map_t), intent(inout) :: map
    integer, intent(in) :: step
    integer, intent(in) :: contact_set(batch_size)         !< contact sets of each speed
    integer, intent(out) :: law(batch_size)                !< indices, valid until the next call
    integer :: l

    if (map%table%laws + batch_size > size(map%table%next)) call forget_laws(map%table)
    call need_law(map%osc, step, contact_set(1), map%table, law(1))
    do l = 2, batch_size
      law(l) = law(l - 1)
      if (contact_set(l) /= contact_set(l - 1)) call need_law(map%osc, step, contact_set(l), map%table, law(l))
    end do
  end subroutine need_laws

  !> Computes the propagator of a step unless it is cached.
  pure subroutine need_propagator(map, step, contact_set, place)
    type(period_map_t), intent(inout) :: map
    integer, intent(in) :: step
    integer, intent(in) :: contact_set(batch_size)         !< contact sets of each speed
    integer, intent(out) :: place                          !< index of the propagator in the cache
    integer :: law(batch_size)

    place = merge(step, 1, map%cached)
    if (map%cached .and. are_same(contact_set, map%contact_set(:, place))) then
      if (map%period(place) == map%table%period) return
      call need_laws(map, step, contact_set, law)
      call push(map, step, law, place)
    else
      call need_laws(map, step, contact_set, law)
      if (all(law == law(1))) then
        call propagate_alike(map%osc, map%table, step, map%duration(:map%speeds), law(1), map%propagator(:, :, place), &
                             map%weight(:, :, place))
      else
        call propagate(map%osc, map%table, step, map%duration(:map%speeds), law, map%propagator(:, :, place), &
                       map%weight(:, :, place))
      end if
      map%contact_set(:, place) = contact_set
    end if
    map%period(place) = map%table%period
  end subroutine need_propagator

  !> Computes a propagator's part of 1 by the forcing in this mesh period.
  pure subroutine push(map, step, law, place)
    type(period_map_t), intent(inout) :: map
    integer, intent(in) :: step, law(batch_size), place
    real(dp) :: load, time, f(3)
    integer :: l

    load = map%osc%load*sum(1/map%osc%mass)
    associate (table => map%table, p => map%propagator(:, :, place), w => map%weight(:, :, place))
      do l = 1, map%speeds
        time = map%duration(l)*table%width(step)
        f = (table%forcing(:, law(l)) + load)*time**2
        p(l, 5) = w(l, 1)*f(1) + w(l, 2)*f(2) + w(l, 3)*f(3)
        p(l, 6) = (w(l, 4)*f(1) + w(l, 5)*f(2) + w(l, 6)*f(3))/table%width(step)
      end do
    end associate
  end subroutine push

  pure logical function are_same(a, b)
    integer, intent(in), dimension(batch_size) :: a, b
    integer :: other, l

    other = 0
    do l = 1, batch_size
      other = ior(other, ieor(a(l), b(l)))
    end do
    are_same = other == 0
  end function are_same

  !> Computes the propagator of one law at all speeds.
  pure subroutine propagate_alike(osc, table, step, duration, law, propagator, weight)
    type(oscillator_t), intent(in) :: osc
    type(coefficients_t), intent(in) :: table
    integer, intent(in) :: step, law
    real(dp), intent(in) :: duration(:)                    !< duration of the mesh period at each speed, s
    real(dp), intent(inout) :: propagator(batch_size, 6)   !< (speed, element)
    real(dp), intent(inout) :: weight(batch_size, 6)       !< as of `collocate`; (speed, element)
    real(dp), dimension(batch_size, 3) :: omega_squared, damped, forcing
    real(dp), dimension(3) :: dampings, forcings
    real(dp) :: time
    integer :: l

    dampings = damping(osc, 1.0_dp)*table%omega(:, law)
    forcings = table%forcing(:, law) + osc%load*sum(1/osc%mass)
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
    call collocate_step(size(duration), table%width(step), table%kind(step)%stiff, omega_squared, damped, forcing, propagator, &
                        weight)
  end subroutine propagate_alike

  !> Computes the propagator where each speed has its own law.
  pure subroutine propagate(osc, table, step, duration, law, propagator, weight)
    type(oscillator_t), intent(in) :: osc
    type(coefficients_t), intent(in) :: table
    integer, intent(in) :: step
    real(dp), intent(in) :: duration(:)
    integer, intent(in) :: law(batch_size)
    real(dp), intent(inout) :: propagator(batch_size, 6), weight(batch_size, 6)
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
    call collocate_step(size(duration), table%width(step), table%kind(step)%stiff, omega_squared, damped, forcing, propagator, &
                        weight)
  end subroutine propagate

  !> Integrates a step by collocation, from displacements over the step to derivatives over the phase. It divides by the width, as
  !> the rounding of a factor 1/width would be the same in each of many steps.
  pure subroutine collocate_step(n, width, stiff, omega_squared, damped, forcing, propagator, weight)
    integer, intent(in) :: n
    real(dp), intent(in) :: width
    logical, intent(in) :: stiff
    real(dp), intent(in), dimension(batch_size, 3) :: omega_squared, damped, forcing
    real(dp), intent(inout), dimension(batch_size, 6) :: propagator, weight    ! elements of unused speeds stay unchanged
    integer :: l

    if (stiff) then
      call collocate_stiffly(n, omega_squared, damped, forcing, propagator, weight)
    else
      call collocate(n, omega_squared, damped, forcing, propagator, weight)
    end if
    do l = 1, n
      propagator(l, 2) = propagator(l, 2)/width
      propagator(l, 3) = propagator(l, 3)*width
      propagator(l, 6) = propagator(l, 6)/width
    end do
  end subroutine collocate_step

  !> Computes the state after a step, for all speeds of a batch.
  pure subroutine take_step(propagator, x, y, x_next, y_next)
    real(dp), intent(in) :: propagator(batch_size, 6)
    real(dp), intent(in), dimension(batch_size) :: x, y              !< state at the start of the step, m
    real(dp), intent(out), dimension(batch_size) :: x_next, y_next   !< state at the end of the step, m
    integer :: l

    do l = 1, batch_size
      x_next(l) = propagator(l, 1)*x(l) + propagator(l, 3)*y(l) + propagator(l, 5)
      y_next(l) = propagator(l, 2)*x(l) + propagator(l, 4)*y(l) + propagator(l, 6)
    end do
  end subroutine take_step

  !> Multiplies the monodromy matrix by the propagator of the next step, or that of the next mesh period.
  pure subroutine compose(propagator, monodromy)
    real(dp), intent(in) :: propagator(batch_size, 4)      !< its parts of x and y, or a monodromy matrix
    !> Derivative of the state by that at the start of the period, columns one after the other; (speed, element)
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

  !> Ends full contact after this many steps of the mesh period: composes the propagators up to there, and marks that other contact
  !> sets follow.
  pure subroutine leave_full_contact(map, steps, monodromy, shrunk)
    type(period_map_t), intent(inout) :: map
    integer, intent(in) :: steps
    real(dp), intent(inout) :: monodromy(batch_size, 4), shrunk(batch_size)    !< as in `flush_to_zero`
    integer :: i

    do i = 1, map%table%period
      call compose(map%mesh_monodromy, monodromy)
      shrunk = shrunk + map%mesh_shrunk
      call flush_to_zero(monodromy, shrunk)
    end do
    do i = 1, steps
      call compose(map%propagator(:, :4, i), monodromy)
      if (modulo(i, 64) == 0) call flush_to_zero(monodromy, shrunk)
    end do
    map%all_full = .false.
  end subroutine leave_full_contact

  !> Sets a negligible derivative to zero. With `shrunk`, scales it up instead, and adds the logarithm of the scale to `shrunk`.
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
end module gearsweep_motion_period_map
