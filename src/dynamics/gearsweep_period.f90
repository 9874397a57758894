!> One mesh period of the motion: Gauss collocation in mesh phase, with steps that end at every break,
!> a contact set that is frozen within a step, and changes of contact located inside it.
module gearsweep_period
  use gearsweep_kinds, only: dp
  use gearsweep_motion, only: oscillator_t, table_t, acceleration
  use gearsweep_step, only: period_t, walk_t, step_t, step_of, follow, note_contact, track
  use gearsweep_contact, only: contact_changes, cross
  use gearsweep_trace, only: trace_t, record
  implicit none
  private
  public :: period_t, run_period

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
    logical :: all_hold
    integer :: i, zone, node

    walk%x = start(1)
    walk%y = start(2)
    walk%map = reshape([1, 0, 0, 1], [2, 2])
    allocate (walk%contact(table%members))
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
        do node = 1, 3
          square(node) = sum(table%rate(:, node, i), mask=walk%contact)
          push(node) = sum(table%rate(:, node, i)*table%error(:, node, i), mask=walk%contact)
        end do
        step = step_of(osc, square, push, sqrt(square), duration, table%width(i))
        call note_contact(osc, walk%contact, out)
      end if
      state = follow(step, walk%x, walk%y)
      if (.not. hold) then
        if (contact_changes(osc, table, i, walk, state(1), state(2))) then
          call cross(osc, table, i, duration, walk, out, trace)
          if (out%failed) return
          all_hold = full(osc, walk%contact, table%pairs(i))
          cycle
        end if
      end if
      call track_step(osc, table, i, duration, walk, state, out%peak)
      if (present(trace)) call record(trace, table%pairs(i), table%left(i) + [0.0_dp, table%width(i)], &
        [walk%x, state(1)], table%end_stiffness(0, :, :, i), table%end_error(0, :, :, i), walk%contact)
      walk%map = matmul(step%map, walk%map)
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
    real(dp) :: scale(0:2), motion(0:2, 2), error(table%members)
    integer :: j

    scale = [1.0_dp, table%width(i), table%width(i)**2]
    error = 0
    if (osc%has_backlash) error(table%members) = -osc%backlash
    motion(0, :) = [walk%x, state(1)]
    motion(1, :) = [walk%y, state(2)]
    do j = 1, 2
      error(:osc%pairs) = table%end_error(0, :, j, i)
      motion(2, j) = acceleration(osc, table%end_rate(:, j, i), error, walk%contact, duration, motion(0, j), motion(1, j))
    end do
    do j = 1, table%pairs(i)
      if (walk%contact(j)) call track(spread(scale, 2, 2)*table%end_stiffness(:, j, :, i), &
                                      spread(scale, 2, 2)*(motion - table%end_error(:, j, :, i)), peak)
    end do
  end subroutine track_step
end module gearsweep_period
