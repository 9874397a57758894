!> Motions of a batch of speeds within the steps of a mesh period: contact laws, sub-steps and loads.
!>
!> The law of one contact set within a step is a set of quintics through the table's values at the step's ends, over a place from
!> 0 to 1. Sub-steps extend from one change of contact to the next; each speed has its own, and they are computed in parallel
!> lanes. The largest loads are also found in a step within which one pair closes or opens.
module gearsweep_motion_integrator
  use gearsweep_base, only: bounds_of, dp, quintic, value_of
  use gearsweep_motion_coefficients, only: coefficients_t, need_law
  use gearsweep_motion_contact_law, only: product_of
  use gearsweep_motion_contact_set, only: add_batch_to_dte, add_to_dte, contact_t, dte_batch_t, dte_t
  use gearsweep_motion_gauss, only: batch_size, collocate, nodes
  use gearsweep_motion_load_peaks, only: candidates_t, may_exceed, raise_to_maximum
  use gearsweep_motion_oscillator, only: acceleration, damping, oscillator_t
  use gearsweep_motion_period_map, only: last, law_curves_t, period_map_t, places, sub_steps_t
  implicit none
  private
  public :: derivatives, load_over, raise_peak, may_have_more, change_t, raise_peaks, enter_step, need_curves, &
            take_sub_step, move_end, sum_contacts, range_of_motion, motion_over_sub_step, integrator_t, watch_dte

  !> Change of contact of several speeds in one step. Places run from 0 to 1 over the step, and v is the derivative of x over it
  !> (m).
  type :: change_t
    integer :: step
    integer :: pair                              !< pair that closes or opens
    integer :: before, behind                    !< contact sets before and after
    logical :: alike(batch_size)                 !< true for the speeds with this change
    real(dp), dimension(batch_size) :: place, x, v                       !< place and state of the change
    real(dp), dimension(batch_size, 0:7) :: first, second                !< polynomials of the motions before and after it
    real(dp), dimension(batch_size) :: last_x, last_v                    !< state at the end of the step
    real(dp) :: propagator(batch_size, 4)        !< propagator of x and v
  end type change_t

  !> State of the integration. Second index of x and y: `from` for the start of the step and `to` for its end; they swap after it.
  type :: integrator_t
    integer :: from = 1, to = 2
    real(dp), dimension(batch_size, 2) :: x, y   !< state, m
    real(dp) :: monodromy(batch_size, 4)         !< derivative by the first state, columns one after the other
    real(dp) :: shrunk(batch_size)               !< logarithm of the factor removed from it
    real(dp) :: held(batch_size)                 !< 0 where contact may change, else a height above all profile errors, m
    type(contact_t), allocatable :: contacts(:)
    integer :: contact_set(batch_size)
    integer :: law(batch_size)                   !< index of the law in the step
    logical :: full_contact                      !< there is full contact at every speed
    logical :: all_full                          !< full contact in all steps so far, whose propagators are cached
    logical :: changes(batch_size)               !< contact may change (later: does change) within the step
    logical :: crosses                           !< gearsweep_motion_single_event handles single changes of contact
    type(sub_steps_t), allocatable :: sub_steps
    logical :: peaks                             !< true: compute the largest loads
    real(dp) :: peak(batch_size)                 !< largest load so far, N
    real(dp) :: coast_peak(batch_size)           !< largest load so far on the coast sides, N
    type(dte_batch_t) :: dte                     !< transmission error so far
    type(dte_t) :: single_dte                    !< transmission error of a batch of one
    type(candidates_t) :: candidates(batch_size)  !< candidates for larger loads
    type(change_t) :: change(4)                  !< steps with a change of contact that may have larger loads
    integer :: noted                             !< number of these
  end type integrator_t

contains

  !> Allocates the curves of an oscillator.
  pure subroutine make_curves(osc, curves)
    type(oscillator_t), intent(in) :: osc
    type(law_curves_t), intent(out) :: curves

    allocate (curves%effective(0:5, osc%contacts), curves%touching(0:5, osc%contacts), curves%most_effective(osc%contacts), &
              curves%touching_bounds(2, osc%contacts))
  end subroutine make_curves

  !> Computes the curves of a contact set in a step.
  pure subroutine find_curves(map, step, contact_set, curves)
    type(period_map_t), intent(inout) :: map
    integer, intent(in) :: step, contact_set
    type(law_curves_t), intent(inout) :: curves
    real(dp) :: scale(0:2), bounds(2)
    integer :: law, j

    call need_law(map%osc, step, contact_set, map%table, law)
    curves%contact_set = contact_set
    associate (table => map%table, osc => map%osc)
      curves%pairs = table%pairs(step)
      scale = [1.0_dp, table%width(step), table%width(step)**2]
      curves%omega_squared = quintic(scale*table%end_omega_squared(:, 1, law), scale*table%end_omega_squared(:, 2, law))
      curves%forcing = quintic(scale*table%end_forcing(:, 1, law), scale*table%end_forcing(:, 2, law))
      do j = 1, osc%contacts
        if (j > curves%pairs .and. j <= osc%pairs) cycle
        curves%effective(:, j) = quintic(scale*table%effective(:, j, 1, law), scale*table%effective(:, j, 2, law))
        curves%touching(:, j) = quintic(scale*table%touching(:, j, 1, law), scale*table%touching(:, j, 2, law))
        bounds = bounds_of(curves%effective(:, j))
        curves%most_effective(j) = bounds(2)
        curves%touching_bounds(:, j) = bounds_of(curves%touching(:, j))
      end do
    end associate
  end subroutine find_curves

  !> Value, first and second derivative of a quintic at both ends of a part of the step, over that part; (0:2, end).
  pure function derivatives(q, place) result(f)
    real(dp), intent(in) :: q(0:5)               !< coefficients
    real(dp), intent(in) :: place(2)             !< places of both ends
    real(dp) :: f(0:2, 2), length

    length = place(2) - place(1)
    f(0, :) = ((((q(5)*place + q(4))*place + q(3))*place + q(2))*place + q(1))*place + q(0)
    f(1, :) = length*((((5*q(5)*place + 4*q(4))*place + 3*q(3))*place + 2*q(2))*place + q(1))
    f(2, :) = length**2*(((20*q(5)*place + 12*q(4))*place + 6*q(3))*place + 2*q(2))
  end function derivatives

  !> Load of a pair in contact at both ends of a part of the step (N), with its derivatives over that part; (0:2, end). The load
  !> of the coast sides is negative.
  pure function load_over(curves, j, place, x) result(load)
    type(law_curves_t), intent(in) :: curves
    integer, intent(in) :: j                     !< index of the contact
    real(dp), intent(in) :: place(2)             !< places of both ends
    real(dp), intent(in) :: x(0:2, 2)            !< the deflection there, m
    real(dp), dimension(0:2, 2) :: load, effective, touching
    integer :: end

    effective = derivatives(curves%effective(:, j), place)
    touching = derivatives(curves%touching(:, j), place)
    do end = 1, 2
      load(:, end) = product_of(effective(:, end), x(:, end) - touching(:, end))
    end do
  end function load_over

  !> True if a pair in contact may have a larger load than `peak` (N) in the step while x stays below `highest` (m).
  pure logical function may_have_more(curves, highest, peak)
    type(law_curves_t), intent(in) :: curves
    real(dp), intent(in) :: highest, peak
    integer :: j

    may_have_more = .false.
    do j = 1, curves%pairs
      if (btest(curves%contact_set, j - 1)) may_have_more = may_have_more .or. &
        curves%most_effective(j)*(highest - curves%touching_bounds(1, j)) > peak
    end do
  end function may_have_more

  !> Raises the largest load by those of the pairs over a part of the step.
  pure subroutine raise_peak(curves, place, x, peak)
    type(law_curves_t), intent(in) :: curves
    real(dp), intent(in) :: place(2), x(0:2, 2)  !< as in `load_over`
    real(dp), intent(inout) :: peak              !< N
    real(dp) :: load(0:2, 2)
    integer :: j

    do j = 1, curves%pairs
      if (.not. btest(curves%contact_set, j - 1)) cycle
      load = load_over(curves, j, place, x)
      peak = max(peak, load(0, 1), load(0, 2))
      if (may_exceed(load, peak)) call raise_to_maximum(load, peak)
    end do
  end subroutine raise_peak

  !> Raises the largest loads by those of the pairs in contact before and after the change. Most are far below.
  pure subroutine raise_peaks(map, change, peak)
    type(period_map_t), intent(inout) :: map
    type(change_t), intent(in) :: change
    real(dp), intent(inout) :: peak(batch_size)
    type(law_curves_t) :: before, behind
    real(dp) :: highest
    integer :: l

    call make_curves(map%osc, before)
    call make_curves(map%osc, behind)
    call find_curves(map, change%step, change%before, before)
    call find_curves(map, change%step, change%behind, behind)
    do l = 1, batch_size
      if (.not. change%alike(l)) cycle
      associate (x => change%x(l), v => change%v(l), place => change%place(l))
        highest = max(change%first(l, 0), x) + place*(abs(change%first(l, 1)) + abs(v))/4
        if (may_have_more(before, highest, peak(l))) &
          call raise_peak(before, [0.0_dp, place], motion_between(change%first(l, :), 0.0_dp, place), peak(l))
        highest = max(x, change%last_x(l)) + (1 - place)*(abs(v) + abs(change%last_v(l)))/4
        if (may_have_more(behind, highest, peak(l))) &
          call raise_peak(behind, [place, 1.0_dp], motion_between(change%second(l, :), place, 1.0_dp), peak(l))
      end associate
    end do
  end subroutine raise_peaks

  !> Motion at two places with its derivatives over the part of the step between them, m; (0:2, end).
  pure function motion_between(c, from, to) result(x)
    real(dp), intent(in) :: c(0:)                ! coefficients in ascending powers
    real(dp), intent(in) :: from, to
    real(dp) :: x(0:2, 2)

    call derive(c, from, x(:, 1))
    call derive(c, to, x(:, 2))
    x(1, :) = (to - from)*x(1, :)
    x(2, :) = (to - from)**2*x(2, :)
  end function motion_between

  !> Computes value, first and second derivative of a polynomial at a place.
  pure subroutine derive(c, place, f)
    real(dp), intent(in) :: c(0:)                ! coefficients in ascending powers
    real(dp), intent(in) :: place
    real(dp), intent(out) :: f(0:)
    integer :: k

    f = 0
    do k = ubound(c, 1), 0, -1
      f(2) = f(2)*place + f(1)
      f(1) = f(1)*place + f(0)
      f(0) = f(0)*place + c(k)
    end do
    f(2) = 2*f(2)
  end subroutine derive

  !> Begins the sub-steps of a step.
  pure subroutine enter_step(map, step, c)
    type(period_map_t), intent(in) :: map
    integer, intent(in) :: step
    type(sub_steps_t), intent(inout) :: c

    c%step = step
    c%curves%contact_set = -1
    c%curve = 0
    if (map%osc%damping_ratio > 1) c%longest = longest_sub_step(map%osc, map%duration*map%table%width(step))
  end subroutine enter_step

  !> Finds the law of a contact set for motion l; the storage has room for one more than the others use.
  pure subroutine need_curves(map, l, contact_set, c)
    type(period_map_t), intent(inout) :: map
    integer, intent(in) :: l                     !< index of the speed in the batch
    integer, intent(in) :: contact_set           !< contact set of the motion
    type(sub_steps_t), intent(inout) :: c
    integer :: i, free

    free = 0
    do i = size(c%curves), 1, -1
      if (c%curves(i)%contact_set == contact_set) exit
      if (c%curves(i)%contact_set == -1) free = i
      if (free == 0 .and. .not. any(c%curve == i)) free = i
    end do
    if (i == 0) then
      i = free
      if (.not. allocated(c%curves(i)%effective)) call make_curves(map%osc, c%curves(i))
      call find_curves(map, c%step, contact_set, c%curves(i))
    end if
    c%curve(l) = i
  end subroutine need_curves

  !> Longest sub-step under strong damping, as a part of a step of this time (s). Changes of contact cut the steps of every
  !> refinement level at the same places, so that doubling the steps does not show the error of sub-steps: where a contact lasts
  !> shorter than a step, and damping changes the motion within it, they must be short.
  elemental real(dp) function longest_sub_step(osc, time)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: time
    real(dp), parameter :: decay = 0.05_dp

    longest_sub_step = 1
    if (time > 0) longest_sub_step = min(1.0_dp, decay/(damping(osc, osc%highest_frequency)*time))
  end function longest_sub_step

  !> Integrates the motion over the sub-steps, whose places are set. A sub-step of zero length is harmless.
  pure subroutine take_sub_step(map, c)
    type(period_map_t), intent(in) :: map
    type(sub_steps_t), intent(inout) :: c
    real(dp), dimension(batch_size, size(nodes)) :: omega_squared, damped, forcing
    real(dp) :: weight(batch_size, 6), time, width, load, factor, step_width
    integer :: k, l, n

    n = map%speeds
    do k = 1, last
      call sum_contacts(map%speeds, k, c)
    end do
    load = map%osc%load*sum(1/map%osc%mass)
    factor = damping(map%osc, 1.0_dp)
    step_width = map%table%width(c%step)
    do k = 1, size(nodes)
      do l = 1, n
        time = map%duration(l)*(c%width(l)*step_width)
        omega_squared(l, k) = time**2*c%omega_squared(l, k + 1)
        damped(l, k) = factor*time*sqrt(c%omega_squared(l, k + 1))
        forcing(l, k) = time**2*(c%forcing(l, k + 1) + load)
      end do
    end do
    call collocate(n, omega_squared, damped, forcing, c%propagator, weight)
    do l = 1, n
      width = c%width(l)*step_width
      c%propagator(l, 2) = c%propagator(l, 2)/max(width, tiny(width))
      c%propagator(l, 3) = c%propagator(l, 3)*width
      c%propagator(l, 6) = c%propagator(l, 6)/max(width, tiny(width))
      c%x(l, 2) = c%propagator(l, 1)*c%x(l, 1) + c%propagator(l, 3)*c%y(l, 1) + c%propagator(l, 5)
      c%y(l, 2) = c%propagator(l, 2)*c%x(l, 1) + c%propagator(l, 4)*c%y(l, 1) + c%propagator(l, 6)
    end do
  end subroutine take_sub_step

  !> Sums over the closed contacts at one place of the sub-steps.
  pure subroutine sum_contacts(speeds, k, c)
    integer, intent(in) :: speeds                !< number of speeds in the batch
    integer, intent(in) :: k                     !< index of the place
    type(sub_steps_t), intent(inout) :: c
    real(dp) :: place
    integer :: l

    do l = 1, speeds
      if (c%curve(l) == 0) cycle
      place = c%left(l) + c%width(l)*places(k)
      c%omega_squared(l, k) = value_of(c%curves(c%curve(l))%omega_squared, place)
      c%forcing(l, k) = value_of(c%curves(c%curve(l))%forcing, place)
    end do
  end subroutine sum_contacts

  !> Moves the end of a sub-step by a tiny part of the step, by the Taylor series there.
  pure subroutine move_end(map, l, part, c)
    type(period_map_t), intent(in) :: map
    integer, intent(in) :: l                     !< index of the speed in the batch
    real(dp), intent(in) :: part                 !< part of the step; forwards positive
    type(sub_steps_t), intent(inout) :: c
    real(dp) :: curvature, by, omega_squared, damped

    by = part*map%table%width(c%step)
    curvature = acceleration_at(map, l, last, c)
    c%width(l) = c%width(l) + part
    c%x(l, 2) = c%x(l, 2) + by*(c%y(l, 2) + by/2*curvature)
    c%y(l, 2) = c%y(l, 2) + by*curvature
    omega_squared = map%duration(l)**2*c%omega_squared(l, last)
    damped = damping(map%osc, map%duration(l))*sqrt(c%omega_squared(l, last))
    associate (p => c%propagator)
      p(l, 1:3:2) = p(l, 1:3:2) + by*p(l, 2:4:2)
      p(l, 2:4:2) = p(l, 2:4:2) - by*(omega_squared*p(l, 1:3:2) + damped*p(l, 2:4:2))
    end associate
  end subroutine move_end

  !> Second derivative of x over the phase (m) at the place k, an end of the sub-step.
  pure real(dp) function acceleration_at(map, l, k, c)
    type(period_map_t), intent(in) :: map
    integer, intent(in) :: l, k
    type(sub_steps_t), intent(in) :: c
    integer :: end

    end = merge(1, 2, k == 1)
    acceleration_at = acceleration(map%osc, c%omega_squared(l, k), c%forcing(l, k), map%duration(l), c%x(l, end), c%y(l, end))
  end function acceleration_at

  !> Deflection at both ends of the sub-step of motion l with its derivatives over it, m; (0:2, end).
  pure function motion_over_sub_step(map, l, c) result(x)
    type(period_map_t), intent(in) :: map
    integer, intent(in) :: l                     !< index of the speed in the batch
    type(sub_steps_t), intent(in) :: c
    real(dp) :: x(0:2, 2)

    associate (width => c%width(l)*map%table%width(c%step))
      x(0, :) = c%x(l, :)
      x(1, :) = width*c%y(l, :)
      x(2, :) = width**2*[acceleration_at(map, l, 1, c), acceleration_at(map, l, last, c)]
    end associate
  end function motion_over_sub_step

  !> Bounds of x (m) over the sub-step of motion l: a convex curve stays above its tangents, a concave one below.
  pure function range_of_motion(map, l, c) result(range)
    type(period_map_t), intent(in) :: map
    integer, intent(in) :: l                     !< index of the speed in the batch
    type(sub_steps_t), intent(in) :: c
    real(dp) :: range(2), turn

    turn = (abs(c%y(l, 1)) + abs(c%y(l, 2)))*c%width(l)*map%table%width(c%step)/4
    range = [min(c%x(l, 1), c%x(l, 2)) - turn, max(c%x(l, 1), c%x(l, 2)) + turn]
  end function range_of_motion

  !> Adds a step to the transmission error of all motions.
  pure subroutine watch_dte(table, speeds, level, step, state)
    type(coefficients_t), intent(in) :: table
    integer, intent(in) :: speeds                !< number of speeds in the batch
    real(dp), intent(in) :: level                !< reference level of the deflection, m
    integer, intent(in) :: step
    type(integrator_t), intent(inout) :: state

    associate (width => table%width(step), next => table%width(merge(1, step + 1, step == table%steps)), from => state%from, &
               to => state%to, x => state%x, y => state%y)
      if (speeds == 1) then
        call add_to_dte(width, next, [x(1, from), x(1, to)] - level, [y(1, from), y(1, to)], state%single_dte)
      else
        call add_batch_to_dte(width, next, level, x(:, from), y(:, from), x(:, to), y(:, to), state%dte)
      end if
    end associate
  end subroutine watch_dte
end module gearsweep_motion_integrator
