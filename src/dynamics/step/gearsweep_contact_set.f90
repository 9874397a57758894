!> Which contacts are closed, and what one mesh period of the motion does.
!>
!> A contact is a pair that may be in contact or, as the last one and only with backlash, the coast sides together. A
!> contact set is an integer: bit j - 1 is set where contact j is closed. The state of the motion is x (m) and its
!> derivative y over the mesh phase (m).
module gearsweep_contact_set
  use gearsweep_dte, only: dte_t
  use gearsweep_gauss, only: batch_size
  use gearsweep_kinds, only: dp
  use gearsweep_oscillator, only: oscillator_t
  implicit none
  private
  public :: period_t, contact_t, in_contact, set_contact, set_contacts, record_contact, keep_derivative

  !> What one mesh period of the motion does.
  type :: period_t
    real(dp) :: state(2) = 0           !< x, y at the end of the period, m
    real(dp) :: monodromy(2, 2) = 0    !< derivative of that by the state at its begin; 0 where nothing is left of that
    real(dp) :: scaled(2, 2) = 0       !< the same over exp(shrunk), which does not underflow
    real(dp) :: shrunk = 0             !< below 0 where the monodromy matrix is 0
    real(dp) :: peak = 0               !< largest load on one pair, N
    real(dp) :: coast_peak = 0         !< largest load on the coast sides, N
    !> Phase checksum (m): the sum of x where smooth intervals begin. It shows errors that the largest load may hide.
    real(dp) :: checksum = 0
    type(dte_t) :: dte                 !< where largest loads are wanted; from the mean static deflection
    integer :: events = 0              !< changes of contact
    real(dp) :: work = 0               !< computing time, in steps
    logical :: departs = .false.       !< it was not all in full contact, about which the motion is linear
    logical :: partial = .false.       !< a pair between A and E was apart for a while
    logical :: lost = .false.          !< all flanks were apart for a while
    logical :: coast = .false.         !< the coast sides came into contact
    logical :: failed = .false.        !< contact changed too often
  end type period_t

  !> One contact in all motions of a batch; the load is that where the last step ended.
  type :: contact_t
    real(dp), dimension(batch_size) :: sense = 1       !< sign that makes the overlap positive until the contact changes
    real(dp), dimension(batch_size) :: load = 0        !< N
    real(dp), dimension(batch_size) :: load_slope = 0  !< its derivative over the step, N
  end type contact_t

contains

  !> Keeps a period's derivative, columns one after the other, out of which exp(shrunk) was taken.
  pure subroutine keep_derivative(columns, shrunk, period)
    real(dp), intent(in) :: columns(:), shrunk     ! 4, not always next to each other
    type(period_t), intent(inout) :: period

    period%scaled = reshape(columns, [2, 2])
    period%shrunk = shrunk
    period%monodromy = 0
    if (.not. shrunk < 0) period%monodromy = period%scaled
  end subroutine keep_derivative

  !> Is contact j closed?
  elemental logical function in_contact(contact_set, j)
    integer, intent(in) :: contact_set
    integer, intent(in) :: j           !< which contact

    in_contact = btest(contact_set, j - 1)
  end function in_contact

  !> Closes or opens a contact of one motion.
  elemental subroutine set_contact(osc, l, j, closed, contact_set, contact)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: l           !< which motion of the batch
    integer, intent(in) :: j           !< which contact
    logical, intent(in) :: closed
    integer, intent(inout) :: contact_set      !< of this motion
    type(contact_t), intent(inout) :: contact  !< contact j

    contact_set = merge(ibset(contact_set, j - 1), ibclr(contact_set, j - 1), closed)
    contact%sense(l) = merge(1, -1, closed .eqv. j <= osc%pairs)
  end subroutine set_contact

  !> Contact j of all motions of a batch, as their contact sets have it.
  pure subroutine set_contacts(osc, j, contact_set, contact)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: j           !< which contact
    integer, intent(in) :: contact_set(batch_size)     !< (motion)
    type(contact_t), intent(inout) :: contact  !< contact j
    integer :: l

    do l = 1, batch_size
      contact%sense(l) = merge(1, -1, in_contact(contact_set(l), j) .eqv. j <= osc%pairs)
    end do
  end subroutine set_contacts

  !> Records in a period what contact there is.
  pure subroutine record_contact(osc, contact_set, full, between, period)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: contact_set
    integer, intent(in) :: full                !< contact set of full contact
    integer, intent(in) :: between             !< that of all pairs between A and E
    type(period_t), intent(inout) :: period
    logical :: coast

    coast = osc%has_backlash
    if (coast) coast = in_contact(contact_set, osc%contacts)
    period%departs = period%departs .or. contact_set /= full
    period%partial = period%partial .or. iand(contact_set, between) /= between .or. coast
    period%lost = period%lost .or. contact_set == 0
    period%coast = period%coast .or. coast
  end subroutine record_contact
end module gearsweep_contact_set
