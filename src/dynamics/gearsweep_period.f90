!> One mesh period of the motion: Gauss collocation in mesh phase, with steps that end at every break,
!> a contact set that is frozen within a step, and changes of contact located inside it.
module gearsweep_period
  use gearsweep_kinds, only: dp
  use gearsweep_motion, only: oscillator_t, table_t, end_acceleration
  use gearsweep_step, only: period_t, walk_t, step_t, step_of, follow, chain, note_contact, track, track_top
  use gearsweep_contact, only: contact_changes, cross
  use gearsweep_trace, only: trace_t, record
  implicit none
  private
  public :: period_t, run_period, track_step

  !> A start of which less than this is left tells nothing; on its way to 0 it
  !> would slow the processor down.
  real(dp), parameter :: forgotten = 1e-150_dp

contains

  !> Follows the motion from `start` over one period of duration `duration` (s).
  !> With `hold` every pair between A and E stays in contact: an affine map.
  pure subroutine run_period(osc, table, duration, start, hold, out, trace)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    real(dp), intent(in) :: duration, start(2)
    logical, intent(in) :: hold
    type(period_t), intent(out) :: out
    type(trace_t), intent(inout), optional :: trace
    type(walk_t) :: walk
    type(step_t) :: step
    real(dp) :: square(3), push(3), state(2)
    logical :: all_hold, changed
    integer :: i, j, zone

    out%work = table%steps
    walk%x = start(1)
    walk%y = start(2)
    walk%map = reshape([1, 0, 0, 1], [2, 2])
    allocate (walk%contact(table%members), walk%stiffness(0:5, osc%pairs), walk%error(0:5, table%members))
    zone = 0
    all_hold = .false.
    do i = 1, table%steps
      if (table%zone(i) /= zone) then
        zone = table%zone(i)
        call enter_zone(osc, table, i, hold, walk)
        all_hold = full(osc, walk%contact, table%pairs(i))
      end if
      if (all_hold) then
        step = step_of(osc, table%square(:, i), table%push(:, i), table%omega(:, i), duration, table%width(i))
      else
        square = 0
        push = 0
        do j = 1, table%members
          if (.not. walk%contact(j)) cycle
          square = square + table%rate(j, :, i)
          push = push + table%rate(j, :, i)*table%error(j, :, i)
        end do
        step = step_of(osc, square, push, sqrt(square), duration, table%width(i))
        call note_contact(osc, walk%contact, out)
      end if
      state = follow(step, walk%x, walk%y)
      if (.not. hold) then
        if (contact_changes(osc, table, i, walk, state(1), state(2))) then
          call cross(osc, table, i, duration, state, walk, out, changed, trace)
          if (out%failed) return
          all_hold = full(osc, walk%contact, table%pairs(i))
          if (changed) cycle
        end if
      end if
      call track_step(osc, table, i, duration, walk, state, out%peak)
      if (present(trace)) call record(trace, table%pairs(i), table%left(i) + [0.0_dp, table%width(i)], &
        [walk%x, state(1)], table%end_stiffness(0, :, :, i), table%end_error(0, :, :, i), walk%contact)
      call chain(step, walk%map)
      if (modulo(i, 64) == 0 .and. all(abs(walk%map) < forgotten)) walk%map = 0
      walk%x = state(1)
      walk%y = state(2)
    end do
    out%state = [walk%x, walk%y]
    out%map = walk%map
  end subroutine run_period

  !> Every pair carries and the coast side does not.
  pure logical function full(osc, contact, pairs)
    type(oscillator_t), intent(in) :: osc
    logical, intent(in) :: contact(:)
    integer, intent(in) :: pairs

    full = all(contact(:pairs))
    if (osc%has_backlash) full = full .and. .not. contact(size(contact))
  end function full

  !> Which members touch where the zone of step i begins.
  pure subroutine enter_zone(osc, table, i, hold, walk)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: i
    logical, intent(in) :: hold
    type(walk_t), intent(inout) :: walk

    walk%contact = .false.
    associate (pairs => table%pairs(i))
      walk%contact(:pairs) = hold .or. walk%x > table%end_error(0, :pairs, 1, i)
    end associate
    if (osc%has_backlash .and. .not. hold) walk%contact(table%members) = walk%x < -osc%backlash
  end subroutine enter_zone

  !> Peaks of all pair loads over step i, which ends at `state`.
  pure subroutine track_step(osc, table, i, duration, walk, state, peak)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: i
    real(dp), intent(in) :: duration, state(2)
    type(walk_t), intent(in) :: walk
    real(dp), intent(inout) :: peak
    real(dp) :: gap(0:2, 2), load(0:2, 2), motion(0:2, 2)
    logical :: more
    integer :: j, k

    motion(0, :) = [walk%x, state(1)]
    motion(1, :) = [walk%y, state(2)]
    do j = 1, table%pairs(i)
      if (.not. walk%contact(j)) cycle
      associate (stiffness => table%end_stiffness(:, j, :, i), error => table%end_error(:, j, :, i), width => table%width(i))
        gap(:1, :) = motion(:1, :) - error(1:2, :)
        load(0, :) = stiffness(1, :)*gap(0, :)
        load(1, :) = width*(stiffness(2, :)*gap(0, :) + stiffness(1, :)*gap(1, :))
        call track(load, peak, more)
        if (.not. more) cycle
        do k = 1, 2
          motion(2, k) = end_acceleration(osc, table, i, k, walk%contact, duration, motion(0, k), motion(1, k))
        end do
        gap(2, :) = motion(2, :) - error(3, :)
        load(2, :) = width**2*(stiffness(3, :)*gap(0, :) + 2*stiffness(2, :)*gap(1, :) + stiffness(1, :)*gap(2, :))
        call track_top(load, peak)
      end associate
    end do
  end subroutine track_step
end module gearsweep_period
