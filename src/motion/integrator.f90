!> State of the integration of a batch of motions over a mesh period, and the loads of the contacts over steps and parts of steps.
!>
!> Where a contact changes within a step, its motion consists of arcs, one for each contact set. The largest loads over arcs are
!> found at the end of the mesh period, when most are known to be too low to matter.
module gearsweep_motion_integrator
  use gearsweep_base, only: bounds_of, dp, over_part
  use gearsweep_motion_coefficients, only: coefficients_t, need_law
  use gearsweep_motion_contact_set, only: add_batch_to_dte, add_to_dte, contact_t, dte_batch_t, dte_t, in_contact
  use gearsweep_motion_dense_step, only: states_at
  use gearsweep_motion_gauss, only: batch_size
  use gearsweep_motion_load_peaks, only: candidates_t, curve_over, in_part, load_over, may_exceed, raise_to_maximum
  use gearsweep_motion_oscillator, only: touches_coast
  use gearsweep_motion_period_map, only: period_map_t
  use gearsweep_motion_trace, only: record, trace_t, watch_contact
  implicit none
  private
  public :: arc_t, integrator_t, note_arc, raise_by_arcs, motion_in, raise_coast, record_part, watch_dte

  !> Arcs in one step with one contact set. Places run from 0 to 1 over the step.
  type :: arc_t
    integer :: step, contact_set
    logical :: alike(batch_size)                 !< true: the motion has this arc
    real(dp), dimension(batch_size) :: from, to  !< places of its ends
    real(dp), dimension(batch_size) :: left, width       !< start and length of the part over which the polynomial's variable runs
    real(dp) :: c(batch_size, 0:7)               !< polynomial of the motion, ascending powers, m; (speed, power)
  end type arc_t

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
    logical :: peaks                             !< true: compute the largest loads
    real(dp) :: peak(batch_size)                 !< largest load so far, N
    real(dp) :: coast_peak(batch_size)           !< largest load so far on the coast sides, N
    type(dte_batch_t) :: dte                     !< transmission error so far
    type(dte_t) :: single_dte                    !< transmission error of a batch of one
    type(candidates_t) :: candidates(batch_size)  !< candidates for larger loads
    type(arc_t) :: arc(8)                        !< arcs that may have larger loads
    integer :: arcs                              !< number of these
  end type integrator_t

contains

  !> Notes arcs whose loads are still to be looked at.
  pure subroutine note_arc(map, arc, state)
    type(period_map_t), intent(inout) :: map
    type(arc_t), intent(in) :: arc
    type(integrator_t), intent(inout) :: state

    if (state%arcs == size(state%arc)) call raise_by_arcs(map, state)
    state%arcs = state%arcs + 1
    state%arc(state%arcs) = arc
  end subroutine note_arc

  !> Raises the largest loads by those of the pairs over the arcs noted.
  pure subroutine raise_by_arcs(map, state)
    type(period_map_t), intent(inout) :: map
    type(integrator_t), intent(inout) :: state
    real(dp), dimension(batch_size, 2) :: x, v
    real(dp) :: highest(batch_size)
    integer :: i, j, law

    do i = 1, state%arcs
      associate (arc => state%arc(i), n => map%speeds)
        call need_law(map%osc, arc%step, arc%contact_set, map%table, law)
        call states_at(n, arc%c, (arc%from - arc%left)/arc%width, x(:, 1), v(:, 1))
        call states_at(n, arc%c, (arc%to - arc%left)/arc%width, x(:, 2), v(:, 2))
        ! A concave curve stays below its tangents.
        highest(:n) = max(x(:n, 1), x(:n, 2)) + (abs(v(:n, 1)) + abs(v(:n, 2)))*(arc%to(:n) - arc%from(:n))/(4*arc%width(:n))
        do j = 1, map%table%pairs(arc%step)
          if (in_contact(arc%contact_set, j)) call raise_by_pair(map%table, arc, law, j, highest(:n), state%peak)
        end do
      end associate
    end do
    state%arcs = 0
  end subroutine raise_by_arcs

  !> Raises the largest loads by those of one pair over arcs.
  pure subroutine raise_by_pair(table, arc, law, j, highest, peak)
    type(coefficients_t), intent(in) :: table
    type(arc_t), intent(in) :: arc
    integer, intent(in) :: law, j
    real(dp), intent(in) :: highest(:)           ! upper bound of the deflection, m; (speed)
    real(dp), intent(inout) :: peak(batch_size)
    real(dp) :: load(0:2, 2), stiffest, lowest
    integer :: l

    stiffest = maxval(bounds_of(curve_over(table%effective(:, j, :, law), table%width(arc%step))))
    lowest = minval(bounds_of(curve_over(table%touching(:, j, :, law), table%width(arc%step))))
    do l = 1, size(highest)
      if (.not. arc%alike(l) .or. .not. stiffest*(highest(l) - lowest) > peak(l)) cycle
      call load_over(table, arc%step, law, j, [arc%from(l), arc%to(l)], motion_in(arc, l), load)
      call raise(load, peak(l))
    end do
  end subroutine raise_by_pair

  !> Motion at both ends of an arc with its derivatives over the arc, m; (derivative, end).
  pure function motion_in(arc, l) result(motion)
    type(arc_t), intent(in) :: arc
    integer, intent(in) :: l                     !< index of the motion in the batch
    real(dp) :: motion(0:2, 2)

    motion = over_part(arc%c(l, :), ([arc%from(l), arc%to(l)] - arc%left(l))/arc%width(l))
  end function motion_in

  !> Raises the largest load by one over a part of a step.
  pure subroutine raise(load, peak)
    real(dp), intent(in) :: load(0:2, 2)         ! with its derivatives over the part, N; (derivative, end)
    real(dp), intent(inout) :: peak              ! N

    peak = max(peak, load(0, 1), load(0, 2))
    if (may_exceed(load, peak)) call raise_to_maximum(load, peak)
  end subroutine raise

  !> Raises the largest load on the coast sides by that over a part of a step, where they are in contact.
  pure subroutine raise_coast(map, step, contact_set, places, motion, peak)
    type(period_map_t), intent(inout) :: map
    integer, intent(in) :: step, contact_set
    real(dp), intent(in) :: places(2)            !< start and end of the part, 0 to 1 over the step
    real(dp), intent(in) :: motion(0:2, 2)       !< deflection there with its derivatives over the part, m; (derivative, end)
    real(dp), intent(inout) :: peak              !< largest load so far, N
    real(dp) :: load(0:2, map%osc%contacts, 2)

    if (.not. touches_coast(map%osc, contact_set)) return
    call find_loads(map, step, contact_set, places, motion, load)
    call raise(sum(load(:, map%osc%pairs + 1:, :), 2), peak)
  end subroutine raise_coast

  !> Computes the loads of all contacts over a part of a step, N; (derivative, contact, end).
  pure subroutine find_loads(map, step, contact_set, places, motion, load)
    type(period_map_t), intent(inout) :: map
    integer, intent(in) :: step, contact_set
    real(dp), intent(in) :: places(2), motion(0:2, 2)    ! as in `raise_coast`
    real(dp), intent(out) :: load(0:2, map%osc%contacts, 2)
    real(dp) :: of_contact(0:2, 2)
    integer :: j, law

    call need_law(map%osc, step, contact_set, map%table, law)
    load = 0
    do j = 1, map%osc%contacts
      if (.not. in_contact(contact_set, j)) cycle
      call load_over(map%table, step, law, j, places, motion, of_contact)
      load(:, j, :) = merge(-of_contact, of_contact, j > map%osc%pairs)
    end do
  end subroutine find_loads

  !> Adds a part of a step of the first motion of a map to a trace, and the overlaps of its contacts.
  pure subroutine record_part(map, step, contact_set, places, motion, trace)
    type(period_map_t), intent(inout) :: map
    integer, intent(in) :: step, contact_set
    real(dp), intent(in) :: places(2), motion(0:2, 2)    !< as in `raise_coast`
    type(trace_t), intent(inout) :: trace
    real(dp) :: load(0:2, map%osc%contacts, 2), overlap(0:2, 2), phase(2)
    logical :: breaks(2)
    integer :: j, law

    call find_loads(map, step, contact_set, places, motion, load)
    call need_law(map%osc, step, contact_set, map%table, law)
    associate (osc => map%osc, table => map%table)
      phase = table%left(step) + table%width(step)*places
      associate (interval => osc%intervals(table%interval(step)))
        call record(trace, table%pairs(step), spread(interval%offset - interval%period, 1, 2), interval%period + phase, &
                    spread(contact_set, 1, 2), motion, load)
      end associate
      if (.not. allocated(trace%overlaps)) return
      breaks(1) = table%kind(step)%begins .and. .not. places(1) > 0
      breaks(2) = step == table%steps
      if (.not. breaks(2)) breaks(2) = table%kind(step + 1)%begins
      breaks(2) = breaks(2) .and. places(2) >= 1
      do j = 1, osc%contacts
        if (j > table%pairs(step) .and. j <= osc%pairs) cycle
        overlap = motion - in_part(table%touching(:, j, :, law), table%width(step), places)
        call watch_contact(j, phase, breaks, merge(-overlap, overlap, j > osc%pairs), trace%overlaps)
      end do
    end associate
  end subroutine record_part

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
