!> One mesh period of the motion: fourth-order Runge-Kutta in mesh phase, with
!> steps that end at every break, a contact set that is frozen within a step,
!> and changes of contact located inside it.
module gearsweep_period
  use gearsweep_kinds, only: dp
  use gearsweep_motion, only: oscillator_t, table_t
  use gearsweep_step, only: period_t, walk_t, step_t, advance, advance_map, decay_over, blend, &
                            note_contact, track
  use gearsweep_contact, only: contact_changes, cross
  use gearsweep_trace, only: trace_t, record
  implicit none
  private
  public :: period_t, run_period

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
    real(dp) :: steady_push, x, y
    logical :: all_hold
    integer :: i, zone

    out%work = table%steps
    walk%x = start(1)
    walk%y = start(2)
    walk%map = reshape([1, 0, 0, 1], [2, 2])
    allocate (walk%contact(table%members))
    steady_push = osc%load*sum(1/osc%mass)*duration**2
    zone = 0
    all_hold = .false.
    do i = 1, table%steps
      if (table%zone(i) /= zone) then
        zone = table%zone(i)
        call enter_zone(osc, table, i, hold, walk)
        all_hold = full(osc, walk%contact, table%pairs(i))
      end if
      if (all_hold) then
        step%push = steady_push + table%push(:, i)*duration**2
        step%square = table%square(:, i)*duration**2
        step%drag = 2*osc%damping_ratio*duration*table%omega(:, i)
      else
        call blend(osc, table%rate(:, :, i), table%error(:, :, i), walk%contact, duration, step)
        call note_contact(osc, walk%contact, out)
      end if
      step%width = table%width(i)
      x = walk%x
      y = walk%y
      call advance(step, x, y)
      if (.not. hold) then
        if (contact_changes(osc, table, i, walk, x, y)) then
          call cross(osc, table, i, duration, walk, out, trace)
          if (out%failed) return
          all_hold = full(osc, walk%contact, table%pairs(i))
          cycle
        end if
      end if
      call track_step(table, i, walk, x, y, out%peak)
      if (present(trace)) call record(trace, table%pairs(i), table%left(i) + [0.0_dp, table%width(i)], &
                                      [walk%x, x], table%stiffness(:, ::2, i), table%error(:, ::2, i), walk%contact)
      call advance_map(step, walk%map)
      if (modulo(i, 64) == 0 .and. all(abs(walk%map) < forgotten)) walk%map = 0
      out%decay = out%decay + decay_over(step)
      walk%x = x
      walk%y = y
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
      walk%contact(:pairs) = hold .or. walk%x > table%error(:pairs, 1, i)
    end associate
    if (osc%has_backlash .and. .not. hold) walk%contact(table%members) = walk%x < -osc%backlash
  end subroutine enter_zone

  !> Peaks of all pair loads over step i.
  pure subroutine track_step(table, i, walk, x, y, peak)
    type(table_t), intent(in) :: table
    integer, intent(in) :: i
    type(walk_t), intent(in) :: walk
    real(dp), intent(in) :: x, y
    real(dp), intent(inout) :: peak
    integer :: j

    do j = 1, table%pairs(i)
      if (walk%contact(j)) call track(table%width(i), table%stiffness(j, ::2, i), table%stiffness_slope(j, :, i), &
                                      [walk%x, x] - table%error(j, ::2, i), &
                                      [walk%y, y] - table%error_slope(j, :, i), peak)
    end do
  end subroutine track_step
end module gearsweep_period
