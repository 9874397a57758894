!> How far the contacts of a motion overlap where that may decide on a change of contact: at the overlap's extrema over the
!> mesh phase, and at breaks. Where such an overlap passes zero as the motion changes, a contact begins or ends (grazing).
module gearsweep_overlaps
  use gearsweep_kinds, only: dp
  use gearsweep_quintic, only: maximum_of, quintic, value_of
  implicit none
  private
  public :: overlap_t, overlaps_t, watch_contact

  type :: overlap_t
    integer :: contact = 0             !< which of the mesh period's contacts
    integer :: period = 0              !< in which of the mesh periods recorded
    logical :: at_break = .false.      !< at a break, whatever the slope; otherwise at an extremum
    real(dp) :: phase = 0              !< mesh phase, 0 to 1
    real(dp) :: value = 0              !< overlap, m; negative where the flanks are apart
  end type overlap_t

  type :: overlaps_t
    integer :: period = 0              !< which mesh period is being recorded
    integer :: count = 0
    type(overlap_t), allocatable :: list(:)      !< only the first `count` are used
  end type overlaps_t

contains

  !> One contact over a step or sub-step without events.
  pure subroutine watch_contact(contact, phase, breaks, overlap, overlaps)
    integer, intent(in) :: contact
    real(dp), intent(in) :: phase(2)             !< of both ends
    logical, intent(in) :: breaks(2)             !< is there a break at the ends?
    real(dp), intent(in) :: overlap(0:2, 2)      !< with its derivatives over the step, at both ends, m
    type(overlaps_t), intent(inout) :: overlaps
    real(dp) :: c(0:5), place
    integer :: end

    do end = 1, 2
      if (breaks(end)) call add(overlap_t(contact, overlaps%period, .true., phase(end), overlap(0, end)), overlaps)
    end do
    if (.not. overlap(1, 1)*overlap(1, 2) < 0) return
    c = quintic(overlap(:, 1), overlap(:, 2))
    place = maximum_of(c)
    call add(overlap_t(contact, overlaps%period, .false., phase(1) + place*(phase(2) - phase(1)), value_of(c, place)), overlaps)
  end subroutine watch_contact

  pure subroutine add(overlap, overlaps)
    type(overlap_t), intent(in) :: overlap
    type(overlaps_t), intent(inout) :: overlaps

    if (.not. allocated(overlaps%list)) allocate (overlaps%list(32))
    ! Room for as many again.
    if (overlaps%count == size(overlaps%list)) overlaps%list = [overlaps%list, overlaps%list]
    overlaps%count = overlaps%count + 1
    overlaps%list(overlaps%count) = overlap
  end subroutine add
end module gearsweep_overlaps
