!> Changes of contact within a step (events), found one after the other on the dense polynomials of the motions.
!>
!> After an event the motion starts from the same state under the new contact set. Extrapolated back to the start of the step, it
!> uses that set's propagator over the whole step. Where damping or a long step forbids that, it continues in parts of the step,
!> from the event on, each with a propagator of its own. Motions of a batch whose contact sets are the same share all this.
module gearsweep_motion_contact_events
  use gearsweep_base, only: derivative_of, dp, evaluate, first_zero, maximum_of, may_cross_zero, quintic, value_of
  use gearsweep_motion_coefficients, only: need_law
  use gearsweep_motion_contact_set, only: in_contact, period_t, record_contact, set_contact
  use gearsweep_motion_dense_step, only: by_force, by_place, by_speed, is_smooth, motions_from, need_dense_part, need_dense_step, &
    states_at
  use gearsweep_motion_gauss, only: batch_size
  use gearsweep_motion_integrator, only: arc_t, integrator_t, motion_in, note_arc, raise_coast, record_part
  use gearsweep_motion_load_peaks, only: curve_over, in_part
  use gearsweep_motion_oscillator, only: damping, resolving_steps, touches_coast
  use gearsweep_motion_period_map, only: period_map_t
  use gearsweep_motion_trace, only: trace_t
  implicit none
  private
  public :: locate_events

  !> Largest number of events within one step, and within one period beyond those of free oscillation; contact with more events
  !> chatters.
  integer, parameter :: most_events = 40, most_extra = 1000

  !> Longest step over which a motion is extrapolated, rad of the natural motion. Half way the polynomial of an oscillation of unit
  !> amplitude has the error (1.5/2)^8/8! = 2.5e-6.
  real(dp), parameter :: longest_extrapolated = 1.5_dp

  !> Computing time of an event, in steps.
  real(dp), parameter :: cost = 1

  !> Motions of a batch between two events of one step. Places run from 0 to 1 over the step.
  type :: motions_t
    logical, dimension(batch_size) :: extrapolates       !< after an event the motion uses propagators of the whole step
    logical, dimension(batch_size) :: active     !< the end of the step is not reached
    logical, dimension(batch_size) :: found      !< contact has changed
    integer, dimension(batch_size) :: events     !< number of changes
    integer, dimension(batch_size) :: changed    !< contacts that have changed at `from`: bit j - 1 for contact j
    real(dp), dimension(batch_size) :: from      !< place from which the contact set holds
    real(dp), dimension(batch_size) :: left, width       !< start and length of the part that the polynomial covers
    real(dp), dimension(batch_size) :: x, v      !< state at the start of the part: x and its derivative over the part, m
    real(dp) :: derivative(batch_size, 4)        !< of that by x and y at the start of the step, columns one after the other
    integer, dimension(batch_size) :: contact    !< contact that changes next; 0: none
    real(dp), dimension(batch_size) :: place     !< where it does
    real(dp), dimension(batch_size) :: behind    !< a place behind that, where its overlap is below 0
  end type motions_t

contains

  !> Integrates the motions whose contact may change (`state%changes`) over a step. Where it does change, updates the final state,
  !> propagator, contacts and largest loads; elsewhere sets `state%changes` to false.
  pure subroutine locate_events(map, step, state, propagator, period, trace)
    type(period_map_t), intent(inout) :: map
    integer, intent(in) :: step
    type(integrator_t), intent(inout) :: state   !< in: the end of the step is that without events
    real(dp), intent(inout) :: propagator(batch_size, 6)
    type(period_t), intent(inout) :: period(:)   !< results at each speed
    type(trace_t), intent(inout), optional :: trace    !< trace of the first motion
    type(motions_t) :: motions
    type(arc_t) :: arc
    integer :: l, which

    call begin(map, step, state, motions)
    arc%step = step
    do l = 1, map%speeds
      do while (motions%active(l))
        arc%contact_set = state%contact_set(l)
        arc%alike = motions%active .and. state%contact_set == arc%contact_set .and. &
                    (motions%extrapolates .eqv. motions%extrapolates(l)) .and. (motions%width >= 1 .eqv. motions%width(l) >= 1)
        arc%from = motions%from
        arc%left = motions%left
        arc%width = motions%width
        if (motions%width(l) >= 1) then
          call need_dense_step(map, step, arc%contact_set, which)
        else
          call need_dense_part(map, step, arc%contact_set, arc%left, arc%width, which)
        end if
        call motions_from(map%speeds, map%dense(which)%c, motions%x, motions%v, arc%c)
        call find_next(map, state, arc, motions)
        call finish(map, arc, which, motions, state, propagator, trace)
        call change(map, arc, which, motions, state, period, trace)
      end do
    end do
    state%changes = motions%found
  end subroutine locate_events

  !> Begins with the whole step.
  pure subroutine begin(map, step, state, motions)
    type(period_map_t), intent(in) :: map
    integer, intent(in) :: step
    type(integrator_t), intent(in) :: state
    type(motions_t), intent(out) :: motions

    motions%extrapolates = is_smooth(map, step) .and. &
                           .not. map%osc%highest_frequency*map%duration*map%table%width(step) > longest_extrapolated
    motions%active = state%changes
    motions%active(map%speeds + 1:) = .false.
    motions%found = .false.
    motions%events = 0
    motions%changed = 0
    motions%from = 0
    motions%left = 0
    motions%width = 1
    motions%x = state%x(:, state%from)
    motions%v = map%table%width(step)*state%y(:, state%from)
    motions%derivative = 0
    motions%derivative(:, 1) = 1
    motions%derivative(:, 4) = map%table%width(step)
  end subroutine begin

  !> Longest part of a step under strong damping. Changes of contact cut the steps of every refinement level at the same places, so
  !> that doubling the steps does not show the error of the parts: where a contact lasts shorter than a step, and damping changes
  !> the motion within it, they must be short.
  pure real(dp) function longest_part(map, step, l) result(longest)
    type(period_map_t), intent(in) :: map
    integer, intent(in) :: step, l
    real(dp), parameter :: decay = 0.05_dp

    longest = 1
    if (map%osc%damping_ratio > 1) &
      longest = min(1.0_dp, decay/(damping(map%osc, map%osc%highest_frequency)*map%duration(l)*map%table%width(step)))
  end function longest_part

  !> Finds the next event of each motion of an arc: the contact that changes, and an estimate of the place.
  pure subroutine find_next(map, state, arc, motions)
    type(period_map_t), intent(inout) :: map
    type(integrator_t), intent(in) :: state
    type(arc_t), intent(inout) :: arc            !< out: with its ends, as far as no contact changes
    type(motions_t), intent(inout) :: motions
    real(dp) :: touching(0:5), overlap(2), slope(2), touch(2), turn(2)
    real(dp), dimension(batch_size, 2) :: x, v
    integer :: j, l, law

    call need_law(map%osc, arc%step, arc%contact_set, map%table, law)
    arc%to = arc%left + arc%width
    call states_at(map%speeds, arc%c, (arc%from - arc%left)/arc%width, x(:, 1), v(:, 1))
    call states_at(map%speeds, arc%c, (arc%to - arc%left)/arc%width, x(:, 2), v(:, 2))
    motions%contact = 0
    motions%place = arc%to
    motions%behind = arc%to
    do j = 1, map%osc%contacts
      if (j > map%table%pairs(arc%step) .and. j <= map%osc%pairs) cycle
      touching = curve_over(map%table%touching(:, j, :, law), map%table%width(arc%step))
      do l = 1, map%speeds
        if (.not. arc%alike(l)) cycle
        associate (from => arc%from(l), to => arc%to(l), sense => state%contacts(j)%sense(l))
          call evaluate(touching, from, touch(1), turn(1))
          call evaluate(touching, to, touch(2), turn(2))
          overlap = sense*(x(l, :) - touch)
          ! Rounding must not decide on which side of zero a contact is that has just changed.
          if (btest(motions%changed(l), j - 1)) overlap(1) = 0
          slope = sense*(to - from)*(v(l, :)/arc%width(l) - turn)
          if (.not. may_cross_zero(overlap(1), overlap(2), slope(1), slope(2))) cycle
          if (motions%contact(l) > 0 .or. overlap(2) >= 0 .or. btest(motions%changed(l), j - 1)) then
            call place_first(map, arc, l, law, [j, motions%contact(l)], state, motions)
          else
            motions%contact(l) = j
            motions%behind(l) = to
            motions%place(l) = from + (to - from)*max(0.0_dp, overlap(1))/(max(0.0_dp, overlap(1)) - overlap(2))
          end if
        end associate
      end do
    end do
  end subroutine find_next

  !> Finds which of two contacts changes first in a motion, and an estimate of the place, on quintics through the overlaps at the
  !> ends of the arc.
  pure subroutine place_first(map, arc, l, law, contacts, state, motions)
    type(period_map_t), intent(in) :: map
    type(arc_t), intent(in) :: arc
    integer, intent(in) :: l, law
    integer, intent(in) :: contacts(:)           !< 0: none
    type(integrator_t), intent(in) :: state
    type(motions_t), intent(inout) :: motions
    real(dp) :: overlap(0:2, 2), c(0:5), at, part, touch, turn, x(batch_size), v(batch_size)
    logical :: found
    integer :: i, j

    motions%contact(l) = 0
    motions%place(l) = arc%to(l)
    do i = 1, size(contacts)
      j = contacts(i)
      if (j == 0) cycle
      associate (sense => state%contacts(j)%sense(l), table => map%table, from => arc%from(l), to => arc%to(l))
        overlap = sense*(motion_in(arc, l) - in_part(table%touching(:, j, :, law), table%width(arc%step), [from, to]))
        if (btest(motions%changed(l), j - 1)) overlap(0, 1) = 0
        c = quintic(overlap(:, 1), overlap(:, 2))
        at = to
        found = overlap(0, 2) < 0
        if (.not. found) then
          ! Where contact changes for a short time, the polynomial of the motion decides, at the least value of the quintic.
          at = from + maximum_of(c)*(to - from)
          call states_at(map%speeds, arc%c, (spread(at, 1, batch_size) - arc%left)/arc%width, x, v)
          call evaluate(curve_over(table%touching(:, j, :, law), table%width(arc%step)), at, touch, turn)
          found = sense*(x(l) - touch) < 0
        end if
        if (.not. found) cycle
        call first_zero(c, part, found)
        part = from + merge(part, 0.5_dp, found)*(merge(to, at, found) - from)
        if (motions%contact(l) > 0 .and. part >= motions%place(l)) cycle
        motions%contact(l) = j
        motions%place(l) = min(part, at)
        motions%behind(l) = at
      end associate
    end do
  end subroutine place_first

  !> Changes the contacts at the next events of an arc's motions.
  pure subroutine change(map, arc, which, motions, state, period, trace)
    type(period_map_t), intent(inout) :: map
    type(arc_t), intent(in) :: arc
    integer, intent(in) :: which                 !< index of its polynomials
    type(motions_t), intent(inout) :: motions
    type(integrator_t), intent(inout) :: state
    type(period_t), intent(inout) :: period(:)
    type(trace_t), intent(inout), optional :: trace
    type(arc_t) :: closing
    logical :: alike(batch_size)
    real(dp) :: part
    integer :: l

    alike = arc%alike .and. motions%contact > 0
    do l = 1, map%speeds
      if (.not. alike(l) .or. motions%extrapolates(l) .or. motions%width(l) < 1) cycle
      part = longest_part(map, arc%step, l)
      ! The part ends just after the event: near the end of a part its polynomial has the accuracy of the propagator.
      if (is_smooth(map, arc%step)) part = min(part, 1.01_dp*motions%place(l))
      if (part >= 1) cycle
      ! The step is repeated in parts.
      motions%found(l) = .true.
      motions%v(l) = motions%v(l)*part
      motions%derivative(l, 2::2) = motions%derivative(l, 2::2)*part
      motions%width(l) = part
      alike(l) = .false.
    end do
    closing = arc
    do l = 1, map%speeds
      if (.not. alike(l)) cycle
      closing%alike = alike .and. motions%contact == motions%contact(l)
      alike = alike .and. .not. closing%alike
      closing%to = arc%to
      call find_places(map, closing, motions%contact(l), state, motions)
      closing%to = motions%place
      call cross(map, closing, motions%contact(l), which, motions, state, period)
      call keep_loads(map, closing, state, trace)
    end do
  end subroutine change

  !> Finds the places of events on the motions' polynomials by Newton's method within brackets, from estimates.
  pure subroutine find_places(map, arc, contact, state, motions)
    type(period_map_t), intent(inout) :: map
    type(arc_t), intent(in) :: arc
    integer, intent(in) :: contact
    type(integrator_t), intent(in) :: state
    type(motions_t), intent(inout) :: motions
    ! `tight`: the next correction would be its square. `beyond`: at the event itself the side is undefined.
    real(dp), parameter :: tight = 1e-8_dp, beyond = 1e-13_dp
    integer, parameter :: most_iterations = 60
    real(dp) :: touching(0:5), overlap, slope, place, longest, touch, turn
    real(dp), dimension(batch_size) :: x, v, low, high
    integer :: iteration, l, law

    call need_law(map%osc, arc%step, arc%contact_set, map%table, law)
    touching = curve_over(map%table%touching(:, contact, :, law), map%table%width(arc%step))
    low = arc%from
    high = motions%behind
    do iteration = 1, most_iterations
      call states_at(map%speeds, arc%c, (motions%place - arc%left)/arc%width, x, v)
      longest = 0
      do l = 1, map%speeds
        if (.not. arc%alike(l)) cycle
        place = motions%place(l)
        associate (sense => state%contacts(contact)%sense(l))
          call evaluate(touching, place, touch, turn)
          overlap = sense*(x(l) - touch)
          slope = sense*(v(l)/arc%width(l) - turn)
        end associate
        if (overlap >= 0) then
          low(l) = place
        else
          high(l) = place
        end if
        if (slope < 0) place = place - overlap/slope
        if (.not. (slope < 0 .and. place >= low(l) .and. place <= high(l))) place = (low(l) + high(l))/2
        longest = max(longest, abs(place - motions%place(l)))
        motions%place(l) = place
      end do
      if (.not. longest > tight) exit
    end do
    where (arc%alike) motions%place = min(motions%place + beyond, arc%to)
  end subroutine find_places

  !> Opens or closes a contact at the places found.
  pure subroutine cross(map, arc, contact, which, motions, state, period)
    type(period_map_t), intent(inout) :: map
    type(arc_t), intent(in) :: arc
    integer, intent(in) :: contact
    integer, intent(in) :: which                 !< index of the arc's polynomials
    type(motions_t), intent(inout) :: motions
    type(integrator_t), intent(inout) :: state
    type(period_t), intent(inout) :: period(:)
    real(dp), parameter :: same = 1e-9_dp        ! events so near are at one place
    real(dp) :: approach(batch_size)
    logical :: extrapolates
    integer :: before, l, contact_set

    contact_set = ieor(arc%contact_set, ibset(0, contact - 1))
    extrapolates = any(arc%alike .and. motions%extrapolates)
    before = which
    ! Polynomials of a whole step may have been replaced since.
    if (extrapolates) call need_dense_step(map, arc%step, arc%contact_set, before)
    call reach(map, arc, contact, contact_set, before, motions, approach)
    do l = 1, map%speeds
      if (.not. arc%alike(l)) cycle
      call set_contact(map%osc, l, contact, .not. in_contact(arc%contact_set, contact), state%contact_set(l), &
                       state%contacts(contact))
      call record_contact(map%osc, contact_set, map%table%full(arc%step), map%table%between(arc%step), period(l))
      motions%found(l) = .true.
      ! Pairs without profile error open, and close, all at once: the same contact must not change again there.
      if (arc%to(l) - motions%from(l) > same) motions%changed(l) = 0
      motions%changed(l) = ibset(motions%changed(l), contact - 1)
      motions%events(l) = motions%events(l) + 1
      motions%from(l) = arc%to(l)
      period(l)%events = period(l)%events + 1
      map%work = map%work + cost
      period(l)%failed = period(l)%failed .or. chatters(map, l, motions, period(l)) .or. &
                         excites(map, arc%step, l, abs(approach(l)), arc%to(l))
      motions%active(l) = .not. period(l)%failed
    end do
    if (extrapolates) then
      call extrapolate(map, arc, contact_set, motions)
    else
      do l = 1, map%speeds
        if (arc%alike(l)) call begin_part(map, arc%step, l, arc%to(l), motions)
      end do
    end if
  end subroutine cross

  !> Computes the motions' states at their events and the derivatives of these, over the step.
  pure subroutine reach(map, arc, contact, contact_set, before, motions, approach)
    type(period_map_t), intent(inout) :: map
    type(arc_t), intent(in) :: arc
    integer, intent(in) :: contact               !< the contact that changes
    integer, intent(in) :: contact_set           !< contact set after the event
    integer, intent(in) :: before                !< index of the polynomials before the event
    type(motions_t), intent(inout) :: motions
    real(dp), intent(out) :: approach(batch_size)        !< relative speed of the flanks, m over the step
    real(dp), dimension(batch_size) :: u, x0, v0, x1, v1, x2, v2
    real(dp), dimension(0:5) :: touching, k1, k2
    real(dp) :: jump
    integer :: l, law

    associate (n => map%speeds, step => arc%step, table => map%table, v => motions%v, p => motions%derivative)
      call need_law(map%osc, step, arc%contact_set, map%table, law)
      touching = curve_over(table%touching(:, contact, :, law), table%width(step))
      k1 = curve_over(table%end_omega_squared(:, :, law), table%width(step))
      call need_law(map%osc, step, contact_set, map%table, law)
      k2 = curve_over(table%end_omega_squared(:, :, law), table%width(step))
      u = (arc%to - arc%left)/arc%width
      call states_at(n, map%dense(before)%c(:, :, by_place), u, x1, v1)
      call states_at(n, map%dense(before)%c(:, :, by_speed), u, x2, v2)
      call states_at(n, arc%c, u, x0, v0)
      approach = 0
      do l = 1, n
        if (.not. arc%alike(l)) cycle
        associate (place => arc%to(l), width => arc%width(l))
          motions%x(l) = x0(l)
          v(l) = v0(l)/width
          approach(l) = v(l) - derivative_of(touching, place)
          p(l, :) = [x1(l)*p(l, 1) + x2(l)*p(l, 2), (v1(l)*p(l, 1) + v2(l)*p(l, 2))/width, &
                     x1(l)*p(l, 3) + x2(l)*p(l, 4), (v1(l)*p(l, 3) + v2(l)*p(l, 4))/width]
          if (.not. abs(approach(l)) > 0) cycle
          ! Only damping jumps with the contact; it enters by the derivative of the event's place (saltation).
          jump = damping(map%osc, map%duration(l)*table%width(step))*(sqrt(max(0.0_dp, value_of(k2, place))) - &
                                                                      sqrt(max(0.0_dp, value_of(k1, place))))
          p(l, 2::2) = p(l, 2::2) - jump*v(l)/approach(l)*p(l, 1::2)
        end associate
      end do
    end associate
  end subroutine reach

  !> Extrapolates the motions from their events back to the start of the step, under the contact set that holds after the events.
  pure subroutine extrapolate(map, arc, contact_set, motions)
    type(period_map_t), intent(inout) :: map
    type(arc_t), intent(in) :: arc
    integer, intent(in) :: contact_set
    type(motions_t), intent(inout) :: motions    !< in: the states at the events and their derivatives; out: those at the start
    real(dp), dimension(batch_size) :: x1, v1, x2, v2, f, g
    real(dp) :: x, v
    integer :: i, l, which

    call need_dense_step(map, arc%step, contact_set, which)
    associate (n => map%speeds, c => map%dense(which)%c, p => motions%derivative)
      call states_at(n, c(:, :, by_place), arc%to, x1, v1)
      call states_at(n, c(:, :, by_speed), arc%to, x2, v2)
      call states_at(n, c(:, :, by_force), arc%to, f, g)
      do l = 1, n
        if (.not. arc%alike(l)) cycle
        associate (det => x1(l)*v2(l) - x2(l)*v1(l))
          x = motions%x(l) - f(l)
          v = motions%v(l) - g(l)
          motions%x(l) = (v2(l)*x - x2(l)*v)/det
          motions%v(l) = (x1(l)*v - v1(l)*x)/det
          do i = 1, 3, 2
            p(l, i:i + 1) = [v2(l)*p(l, i) - x2(l)*p(l, i + 1), x1(l)*p(l, i + 1) - v1(l)*p(l, i)]/det
          end do
        end associate
      end do
    end associate
  end subroutine extrapolate

  !> Begins a part of the step at a place, from the state there over the step.
  pure subroutine begin_part(map, step, l, place, motions)
    type(period_map_t), intent(in) :: map
    integer, intent(in) :: step, l
    real(dp), intent(in) :: place
    type(motions_t), intent(inout) :: motions

    associate (width => motions%width(l))
      width = max(tiny(place), min(1 - place, longest_part(map, step, l)))
      motions%left(l) = place
      motions%from(l) = place
      motions%v(l) = motions%v(l)*width
      motions%derivative(l, 2::2) = motions%derivative(l, 2::2)*width
    end associate
  end subroutine begin_part

  !> Ends arcs without an event: at the end of the step, or of a part of it.
  pure subroutine finish(map, arc, which, motions, state, propagator, trace)
    type(period_map_t), intent(inout) :: map
    type(arc_t), intent(in) :: arc
    integer, intent(in) :: which                 !< index of its polynomials
    type(motions_t), intent(inout) :: motions
    type(integrator_t), intent(inout) :: state
    real(dp), intent(inout) :: propagator(batch_size, 6)
    type(trace_t), intent(inout), optional :: trace
    type(arc_t) :: closing
    real(dp) :: x, v
    integer :: i, l

    closing = arc
    closing%alike = arc%alike .and. motions%contact == 0 .and. motions%found
    if (any(closing%alike)) call keep_loads(map, closing, state, trace)
    do l = 1, map%speeds
      if (.not. arc%alike(l) .or. motions%contact(l) > 0) cycle
      if (.not. motions%found(l)) then
        motions%active(l) = .false.
        cycle
      end if
      associate (q => map%dense(which)%propagator(l, :), p => motions%derivative(l, :), width => motions%width(l))
        x = q(1)*motions%x(l) + q(3)*motions%v(l) + q(5)
        v = (q(2)*motions%x(l) + q(4)*motions%v(l) + q(6))/width
        do i = 1, 3, 2
          p(i:i + 1) = [q(1)*p(i) + q(3)*p(i + 1), (q(2)*p(i) + q(4)*p(i + 1))/width]
        end do
        motions%left(l) = motions%left(l) + width
        if (motions%left(l) >= 1) then
          motions%active(l) = .false.
          state%x(l, state%to) = x
          state%y(l, state%to) = v/map%table%width(arc%step)
          propagator(l, :4) = p
          propagator(l, 2:4:2) = p(2:4:2)/map%table%width(arc%step)
        else
          motions%changed(l) = 0
          motions%x(l) = x
          motions%v(l) = v
          call begin_part(map, arc%step, l, motions%left(l), motions)
        end if
      end associate
    end do
  end subroutine finish

  !> Keeps what is wanted of the loads over arcs with their ends.
  pure subroutine keep_loads(map, arc, state, trace)
    type(period_map_t), intent(inout) :: map
    type(arc_t), intent(in) :: arc
    type(integrator_t), intent(inout) :: state
    type(trace_t), intent(inout), optional :: trace
    integer :: l

    if (state%peaks) then
      call note_arc(map, arc, state)
      if (touches_coast(map%osc, arc%contact_set)) then
        do l = 1, map%speeds
          if (arc%alike(l)) call raise_coast(map, arc%step, arc%contact_set, [arc%from(l), arc%to(l)], motion_in(arc, l), &
                                             state%coast_peak(l))
        end do
      end if
    end if
    if (.not. present(trace)) return
    if (arc%alike(1)) call record_part(map, arc%step, arc%contact_set, [arc%from(1), arc%to(1)], motion_in(arc, 1), trace)
  end subroutine keep_loads

  !> True if contact changes too often in a step or a period.
  pure logical function chatters(map, l, motions, period)
    type(period_map_t), intent(in) :: map
    integer, intent(in) :: l
    type(motions_t), intent(in) :: motions
    type(period_t), intent(in) :: period

    chatters = motions%events(l) > most_events .or. &
               period%events > most_extra + map%osc%contacts*map%osc%highest_frequency*map%duration(l)* &
                               map%osc%mesh%deviations%periods
  end function chatters

  !> True if a change of contact excites a natural motion that the remainder of a stiff step is too long to follow.
  pure logical function excites(map, step, l, approach, place)
    type(period_map_t), intent(in) :: map
    integer, intent(in) :: step, l
    real(dp), intent(in) :: approach             ! relative speed of the flanks that meet or part, m over the step
    real(dp), intent(in) :: place
    ! `negligible`: amplitude of the natural motion (static deflections) that may be neglected. `near`: angle of the natural motion
    ! (rad) by which damping advances the closing and opening of pairs.
    real(dp), parameter :: negligible = 1e-7_dp, near = 4

    associate (width => map%table%width(step))
      excites = map%table%kind(step)%stiff
      if (excites) excites = approach > negligible*map%osc%static_deflection*map%osc%natural_frequency*map%duration(l)*width .and. &
                             (1 - place)*width*resolving_steps(map%osc, map%duration(l)) > near
    end associate
  end function excites
end module gearsweep_motion_contact_events
