!> Record of a motion over one mesh period, and the overlaps of its contacts.
!>
!> Overlaps are recorded at their extrema over the mesh phase and at breaks, where they may decide on a change of contact. Where
!> such an overlap passes zero as the motion changes, a contact begins or ends (grazing).
module gearsweep_motion_trace
  use gearsweep_base, only: dp, maximum_of, quintic, value_of
  implicit none
  private
  public :: overlap_t, overlaps_t, watch_contact, trace_t, record, pair_paths

  type :: overlap_t
    integer :: contact = 0             !< index of the contact
    integer :: period = 0              !< index of the mesh period
    logical :: at_break = .false.      !< true: at a break, with any slope; false: at an extremum
    real(dp) :: phase = 0              !< mesh phase, 0 to 1
    real(dp) :: value = 0              !< overlap, m; negative where the flanks are apart
  end type overlap_t

  type :: overlaps_t
    integer :: period = 0              !< index of the mesh period being recorded
    integer :: count = 0
    type(overlap_t), allocatable :: list(:)      !< only the first `count` are used
  end type overlaps_t

  !> Motion in rows, in pairs for the two ends of a step, or of a part of it; only the first `rows` count.
  type :: trace_t
    integer :: rows = 0
    integer, allocatable :: pairs(:)             !< number of pairs that may be in contact; (row)
    integer, allocatable :: offset(:)            !< path coordinate of the first of them minus the phase; (row)
    integer, allocatable :: contact_set(:)       !< (row)
    real(dp), allocatable :: phase(:)            !< mesh phase, 0 to 1, or to the periods after which deviations repeat; (row)
    !> Dynamic transmission error (m), and the loads of the pairs and of the coast sides (N), each with its first and second
    !> derivative over the step; (0:2, row) and (0:2, contact, row).
    real(dp), allocatable :: x(:, :), load(:, :, :)
    type(overlaps_t), allocatable :: overlaps    !< recorded if allocated
  end type trace_t

contains

  !> Records the extrema of one contact over a part of a step without events.
  pure subroutine watch_contact(contact, phase, breaks, overlap, overlaps)
    integer, intent(in) :: contact
    real(dp), intent(in) :: phase(2)             !< mesh phases of both ends
    logical, intent(in) :: breaks(2)             !< true: a break at this end
    real(dp), intent(in) :: overlap(0:2, 2)      !< overlap with its derivatives over the step, at both ends, m
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
    ! Doubles the room.
    if (overlaps%count == size(overlaps%list)) overlaps%list = [overlaps%list, overlaps%list]
    overlaps%count = overlaps%count + 1
    overlaps%list(overlaps%count) = overlap
  end subroutine add

  !> Adds the two ends of a step.
  pure subroutine record(trace, pairs, offset, phase, contact_set, x, load)
    type(trace_t), intent(inout) :: trace
    integer, intent(in) :: pairs                 !< number of pairs that may be in contact
    integer, intent(in) :: offset(2)             !< path coordinate of the first of them minus the phase, at both ends
    real(dp), intent(in) :: phase(2)             !< mesh phases of both ends
    integer, intent(in) :: contact_set(2)        !< contact sets at both ends
    real(dp), intent(in) :: x(0:2, 2)            !< dynamic transmission error with its derivatives over the step, m; (, end)
    real(dp), intent(in) :: load(0:, :, :)       !< loads with their derivatives, N; (0:2, contact, end)
    integer :: k

    if (.not. allocated(trace%x)) call resize(trace, size(load, 2), 256)
    if (trace%rows + 2 > size(trace%phase)) call resize(trace, size(trace%load, 2), 2*size(trace%phase))
    do k = 1, 2
      trace%rows = trace%rows + 1
      trace%pairs(trace%rows) = pairs
      trace%offset(trace%rows) = offset(k)
      trace%phase(trace%rows) = phase(k)
      trace%contact_set(trace%rows) = contact_set(k)
      trace%x(:, trace%rows) = x(:, k)
      trace%load(:, :, trace%rows) = load(:, :, k)
    end do
  end subroutine record

  pure subroutine resize(trace, contacts, rows)
    type(trace_t), intent(inout) :: trace
    integer, intent(in) :: contacts, rows
    type(trace_t) :: larger

    allocate (larger%pairs(rows), larger%offset(rows), larger%phase(rows), larger%contact_set(rows))
    allocate (larger%x(0:2, rows), larger%load(0:2, contacts, rows))
    larger%rows = trace%rows
    if (allocated(trace%overlaps)) call move_alloc(trace%overlaps, larger%overlaps)
    associate (n => trace%rows)
      if (n > 0) then
        larger%pairs(:n) = trace%pairs(:n)
        larger%offset(:n) = trace%offset(:n)
        larger%phase(:n) = trace%phase(:n)
        larger%contact_set(:n) = trace%contact_set(:n)
        larger%x(:, :n) = trace%x(:, :n)
        larger%load(:, :, :n) = trace%load(:, :, :n)
      end if
    end associate
    trace = larger
  end subroutine resize

  !> Collects the loads of the pairs over their complete paths of contact. A pair enters with each mesh period, so that a motion
  !> that repeats after several has as many different pairs, which follow one another.
  pure subroutine pair_paths(trace, pair, s, load, x)
    type(trace_t), intent(in) :: trace(:)                  !< mesh periods after which the motion repeats
    integer, allocatable, intent(out) :: pair(:)           !< index of the period in which the pair entered; (row)
    real(dp), allocatable, intent(out) :: s(:)             !< path coordinate from A, base pitches; (row)
    real(dp), allocatable, intent(out) :: load(:)          !< load of this pair, N; (row)
    real(dp), allocatable, intent(out) :: x(:)             !< dynamic transmission error, m; (row)
    integer :: i, j, k, n, first, last, slot

    n = sum([(sum(trace(i)%pairs(:trace(i)%rows)), i=1, size(trace))])
    allocate (pair(n), s(n), load(n), x(n))
    n = 0
    first = minval(trace(1)%offset(:trace(1)%rows))
    last = maxval(trace(1)%offset(:trace(1)%rows) + trace(1)%pairs(:trace(1)%rows)) - 1
    do i = 1, size(trace)
      do slot = first, last
        associate (now => trace(1 + modulo(i + slot - 1, size(trace))))
          do k = 1, now%rows
            j = 1 + slot - now%offset(k)
            if (j < 1 .or. j > now%pairs(k)) cycle
            n = n + 1
            pair(n) = i
            s(n) = now%phase(k) + (j + now%offset(k)) - 1
            load(n) = max(0.0_dp, now%load(0, j, k))
            x(n) = now%x(0, k)
          end do
        end associate
      end do
    end do
  end subroutine pair_paths
end module gearsweep_motion_trace
