!> Adds the overlaps of all contacts over a step, or a sub-step between changes of contact, to those that a trace records.
module gearsweep_overlap_watch
  use gearsweep_kinds, only: dp
  use gearsweep_overlaps, only: overlaps_t, watch_contact
  use gearsweep_period_map, only: period_map_t
  use gearsweep_step_ends, only: deflection_at_end, end_acceleration
  use gearsweep_sub_step, only: derivatives, own_at_ends, second_derivatives, second_derivatives_of_motion, working_at_ends
  use gearsweep_sub_steps, only: sub_steps_t
  implicit none
  private
  public :: watch_step, watch_sub_step

contains

  !> A step without events, of the first motion of the map.
  pure subroutine watch_step(map, step, states, contact_set, overlaps)
    type(period_map_t), intent(in) :: map
    integer, intent(in) :: step, contact_set
    real(dp), intent(in) :: states(2, 2)         !< at both ends, m; (x or y, end)
    type(overlaps_t), intent(inout) :: overlaps
    real(dp), dimension(0:2, 2) :: motion, overlap
    real(dp) :: width, scale(0:2)
    integer :: j, end

    associate (osc => map%osc, table => map%table)
      width = table%width(step)
      scale = [1.0_dp, width, width**2]
      do end = 1, 2
        motion(:1, end) = states(:, end)
        motion(2, end) = end_acceleration(osc, table, step, end, contact_set, map%duration(1), states(:, end))
      end do
      do j = 1, osc%contacts
        if (j > table%pairs(step) .and. j <= osc%pairs) cycle
        overlap = motion
        do end = 1, 2
          if (j <= osc%pairs) overlap(:, end) = deflection_at_end(osc, table, step, end, contact_set, j, motion(:, end))
          overlap(:, end) = scale*(overlap(:, end) - table%end_profile_error(:, j, end, step))
        end do
        if (j > osc%pairs) overlap = -overlap
        call watch_contact(j, table%left(step) + [0.0_dp, width], breaks_at(map, step), overlap, overlaps)
      end do
    end associate
  end subroutine watch_step

  !> Is there a break at the begin and at the end of a step?
  pure function breaks_at(map, step) result(breaks)
    type(period_map_t), intent(in) :: map
    integer, intent(in) :: step
    logical :: breaks(2)

    breaks(1) = map%table%kind(step)%begins
    breaks(2) = step == map%table%steps
    if (.not. breaks(2)) breaks(2) = map%table%kind(step + 1)%begins
  end function breaks_at

  !> The sub-step of motion l.
  pure subroutine watch_sub_step(map, l, contact_set, c, overlaps)
    type(period_map_t), intent(in) :: map
    integer, intent(in) :: l, contact_set
    type(sub_steps_t), intent(in) :: c
    type(overlaps_t), intent(inout) :: overlaps
    real(dp), dimension(0:2, 2) :: motion, overlap, error
    real(dp), dimension(0:2, map%osc%pairs, 2) :: k, e, w
    logical :: breaks(2)
    integer :: j

    call own_at_ends(map, l, c, contact_set, .true., k, e)
    w = working_at_ends(map, l, c, contact_set, k, e, .true.)
    breaks = breaks_at(map, c%step) .and. [.not. c%left(l) > 0, c%left(l) + c%width(l) >= 1]
    motion(0, :) = c%x(l, :)
    motion(1, :) = c%width(l)*map%table%width(c%step)*c%y(l, :)
    motion(2, :) = second_derivatives_of_motion(map, l, c)
    associate (osc => map%osc, table => map%table)
      do j = 1, osc%contacts
        if (j > table%pairs(c%step) .and. j <= osc%pairs) cycle
        error(:1, :) = derivatives(c, l, c%profile_error(:, j))
        error(2, :) = second_derivatives(c, l, c%profile_error(:, j))
        overlap = motion - error
        if (j <= osc%pairs) overlap = w(:, j, :) - error
        if (j > osc%pairs) overlap = -overlap
        call watch_contact(j, table%left(c%step) + table%width(c%step)*(c%left(l) + [0.0_dp, c%width(l)]), breaks, overlap, &
                           overlaps)
      end do
    end associate
  end subroutine watch_sub_step
end module gearsweep_overlap_watch
