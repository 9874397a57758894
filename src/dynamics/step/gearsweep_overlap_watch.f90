!> Adds the overlaps of all contacts over a step, or a sub-step between changes of contact, to those that a trace records.
module gearsweep_overlap_watch
  use gearsweep_coefficients, only: need_law
  use gearsweep_kinds, only: dp
  use gearsweep_law_curves, only: derivatives
  use gearsweep_load_peaks, only: motion_over_step
  use gearsweep_overlaps, only: overlaps_t, watch_contact
  use gearsweep_period_map, only: period_map_t
  use gearsweep_sub_step, only: motion_over_sub_step, sub_steps_t
  implicit none
  private
  public :: watch_step, watch_sub_step

contains

  !> A step without events, of the first motion of the map.
  pure subroutine watch_step(map, step, states, contact_set, overlaps)
    type(period_map_t), intent(inout) :: map
    integer, intent(in) :: step, contact_set
    real(dp), intent(in) :: states(2, 2)         !< at both ends, m; (x or y, end)
    type(overlaps_t), intent(inout) :: overlaps
    real(dp), dimension(0:2, 2) :: motion, overlap
    real(dp) :: scale(0:2)
    integer :: j, end, law

    call need_law(map%osc, step, contact_set, map%table, law)
    associate (osc => map%osc, table => map%table, width => map%table%width(step))
      scale = [1.0_dp, width, width**2]
      call motion_over_step(osc, table, step, law, map%duration(1), states, motion)
      do j = 1, osc%contacts
        if (j > table%pairs(step) .and. j <= osc%pairs) cycle
        do end = 1, 2
          overlap(:, end) = motion(:, end) - scale*table%touching(:, j, end, law)
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
  pure subroutine watch_sub_step(map, l, c, overlaps)
    type(period_map_t), intent(in) :: map
    integer, intent(in) :: l
    type(sub_steps_t), intent(in) :: c
    type(overlaps_t), intent(inout) :: overlaps
    real(dp), dimension(0:2, 2) :: motion, overlap
    real(dp) :: place(2)
    logical :: breaks(2)
    integer :: j

    place = c%left(l) + [0.0_dp, c%width(l)]
    breaks = breaks_at(map, c%step) .and. [.not. c%left(l) > 0, c%left(l) + c%width(l) >= 1]
    motion = motion_over_sub_step(map, l, c)
    associate (osc => map%osc, table => map%table)
      do j = 1, osc%contacts
        if (j > table%pairs(c%step) .and. j <= osc%pairs) cycle
        overlap = motion - derivatives(c%curves(c%curve(l))%touching(:, j), place)
        if (j > osc%pairs) overlap = -overlap
        call watch_contact(j, table%left(c%step) + table%width(c%step)*place, breaks, overlap, overlaps)
      end do
    end associate
  end subroutine watch_sub_step
end module gearsweep_overlap_watch
