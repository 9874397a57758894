!> What one step and one period of the motion consist of: members and their contact side by side in
!> lanes. The state is x (m) and its derivative y over the mesh phase (m). What touches in a lane is told
!> by the bits of an integer, member j by bit j - 1.
module gearsweep_step
  use gearsweep_kinds, only: dp
  use gearsweep_gauss, only: lanes
  use gearsweep_motion, only: oscillator_t, table_t
  implicit none
  private
  public :: period_t, member_t, touches, all_pairs, set_contact, note_contact

  !> What one period does.
  type :: period_t
    real(dp) :: state(2) = 0           !< at the end of the period
    real(dp) :: map(2, 2) = 0          !< derivative of that by the initial state
    real(dp) :: peak = 0               !< largest load on one pair, N
    real(dp) :: mark = 0               !< sum of x where zones begin, m: shows errors that the peak may not
    integer :: events = 0              !< changes of contact within the period
    real(dp) :: work = 0               !< what it cost, in steps
    logical :: partial = .false.       !< a pair between A and E was apart for a while
    logical :: flight = .false.        !< all flanks were apart for a while
    logical :: coast = .false.         !< the coast sides touched
    logical :: failed = .false.        !< contact changed too often
  end type period_t

  !> One member, a pair or the coast side, at the last end of a step; slopes over the step. `sense` is the
  !> overlap's sign while its contact stays as it is, `weight` 1 in contact and 0 apart.
  type :: member_t
    real(dp), dimension(lanes) :: weight = 0, sense = 1
    real(dp), dimension(lanes) :: load = 0, load_slope = 0
  end type member_t

contains

  elemental logical function touches(touch, j)
    integer, intent(in) :: touch, j

    touches = btest(touch, j - 1)
  end function touches

  !> Every pair between A and E in step i.
  pure integer function all_pairs(table, i)
    type(table_t), intent(in) :: table
    integer, intent(in) :: i

    all_pairs = 2**table%pairs(i) - 1
  end function all_pairs

  !> Lets member j touch or not in lane l.
  elemental subroutine set_contact(osc, l, j, contact, touch, member)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: l, j
    logical, intent(in) :: contact
    integer, intent(inout) :: touch
    type(member_t), intent(inout) :: member

    touch = merge(ibset(touch, j - 1), ibclr(touch, j - 1), contact)
    member%weight(l) = merge(1, 0, contact)
    member%sense(l) = merge(1, -1, contact .eqv. j <= osc%pairs)
  end subroutine set_contact

  !> Notes that not every pair carries.
  pure subroutine note_contact(osc, touch, out)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: touch
    type(period_t), intent(inout) :: out

    out%partial = .true.
    out%flight = out%flight .or. touch == 0
    if (osc%has_backlash) out%coast = out%coast .or. touches(touch, osc%members)
  end subroutine note_contact
end module gearsweep_step
