!> Motion and loads at both ends of a step or sub-step, with first and second derivative over it: what a quintic takes.
!> The loads are those of the pairs and, as the last contact and only with backlash, of the coast sides.
module gearsweep_step_loads
  use gearsweep_coefficients, only: need_law
  use gearsweep_contact_set, only: in_contact
  use gearsweep_kinds, only: dp
  use gearsweep_law_curves, only: load_over
  use gearsweep_load_peaks, only: load_over_step, may_exceed, motion_over_step, raise_to_maximum
  use gearsweep_oscillator, only: oscillator_t
  use gearsweep_period_map, only: period_map_t
  use gearsweep_sub_step, only: motion_over_sub_step, sub_steps_t
  implicit none
  private
  public :: loads_over_step, loads_over_sub_step, raise_coast_over_step, raise_coast_over_sub_step

contains

  !> Over a step in which the contact set stays as it is.
  pure subroutine loads_over_step(map, step, contact_set, duration, state, x, load)
    type(period_map_t), intent(inout) :: map
    integer, intent(in) :: step, contact_set
    real(dp), intent(in) :: duration             !< of the mesh period, s
    real(dp), intent(in) :: state(2, 2)          !< x and its derivative over the phase (m) at both ends; (x or y, end)
    real(dp), intent(out) :: x(0:2, 2)           !< m; (derivative, end)
    real(dp), intent(out) :: load(0:2, map%osc%contacts, 2)  !< N; (derivative, contact, end)
    real(dp) :: of_contact(0:2, 2)
    integer :: j, law

    call need_law(map%osc, step, contact_set, map%table, law)
    call motion_over_step(map%osc, map%table, step, law, duration, state, x)
    load = 0
    do j = 1, map%osc%contacts
      if (.not. in_contact(contact_set, j)) cycle
      call load_over_step(map%table, step, law, j, x, of_contact)
      load(:, j, :) = merge(-of_contact, of_contact, j > map%osc%pairs)
    end do
  end subroutine loads_over_step

  !> Over the sub-step of one motion of a batch.
  pure subroutine loads_over_sub_step(map, l, c, contact_set, x, load)
    type(period_map_t), intent(in) :: map
    integer, intent(in) :: l                     !< which speed of the batch
    type(sub_steps_t), intent(in) :: c
    integer, intent(in) :: contact_set           !< of the motion
    real(dp), intent(out) :: x(0:2, 2)           !< m; (derivative, end)
    real(dp), intent(out) :: load(0:2, map%osc%contacts, 2)  !< N; (derivative, contact, end)
    integer :: j

    x = motion_over_sub_step(map, l, c)
    load = 0
    do j = 1, map%osc%contacts
      if (.not. in_contact(contact_set, j)) cycle
      load(:, j, :) = load_over(c%curves(c%curve(l)), j, c%left(l) + [0.0_dp, c%width(l)], x)
      if (j > map%osc%pairs) load(:, j, :) = -load(:, j, :)
    end do
  end subroutine loads_over_sub_step

  !> Raises the largest load on the coast sides by that over a step, where they are in contact.
  pure subroutine raise_coast_over_step(map, step, contact_set, duration, state, peak)
    type(period_map_t), intent(inout) :: map
    integer, intent(in) :: step, contact_set
    real(dp), intent(in) :: duration             !< of the mesh period, s
    real(dp), intent(in) :: state(2, 2)          !< x and its derivative over the phase (m) at both ends; (x or y, end)
    real(dp), intent(inout) :: peak              !< largest load so far, N
    real(dp) :: x(0:2, 2), load(0:2, map%osc%contacts, 2), coast(0:2, 2)

    if (.not. touches_coast(map%osc, contact_set)) return
    call loads_over_step(map, step, contact_set, duration, state, x, load)
    coast = load(:, map%osc%contacts, :)
    call raise(coast, peak)
  end subroutine raise_coast_over_step

  !> The same over a sub-step.
  pure subroutine raise_coast_over_sub_step(map, l, c, contact_set, peak)
    type(period_map_t), intent(in) :: map
    integer, intent(in) :: l                     !< which speed of the batch
    type(sub_steps_t), intent(in) :: c
    integer, intent(in) :: contact_set           !< of the motion
    real(dp), intent(inout) :: peak              !< largest load so far, N

    if (.not. touches_coast(map%osc, contact_set)) return
    call raise(-load_over(c%curves(c%curve(l)), map%osc%contacts, c%left(l) + [0.0_dp, c%width(l)], &
                          motion_over_sub_step(map, l, c)), peak)
  end subroutine raise_coast_over_sub_step

  pure subroutine raise(load, peak)
    real(dp), intent(in) :: load(0:2, 2)
    real(dp), intent(inout) :: peak

    peak = max(peak, load(0, 1), load(0, 2))
    if (may_exceed(load, peak)) call raise_to_maximum(load, peak)
  end subroutine raise

  pure logical function touches_coast(osc, contact_set)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: contact_set

    touches_coast = osc%has_backlash
    if (touches_coast) touches_coast = in_contact(contact_set, osc%contacts)
  end function touches_coast
end module gearsweep_step_loads
