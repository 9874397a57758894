!> The motion over one mesh period, recorded for tables and pictures.
module gearsweep_trace
  use gearsweep_kinds, only: dp
  use gearsweep_overlaps, only: overlaps_t
  implicit none
  private
  public :: trace_t, record, pair_paths

  !> Rows come in twos, the two ends of a step or sub-step; only the first `rows` count.
  type :: trace_t
    integer :: rows = 0
    integer, allocatable :: pairs(:)             !< that may be in contact; (row)
    integer, allocatable :: offset(:)            !< path coordinate of the first of them less the phase; (row)
    integer, allocatable :: contact_set(:)       !< (row)
    real(dp), allocatable :: phase(:)            !< mesh phase, 0 to 1, or to the periods after which deviations repeat; (row)
    !> Dynamic transmission error (m), and the loads of the pairs and of the coast sides (N), each with its first and second
    !> derivative over the step; (0:2, row) and (0:2, contact, row).
    real(dp), allocatable :: x(:, :), load(:, :, :)
    type(overlaps_t), allocatable :: overlaps    !< recorded too where this is allocated
  end type trace_t

contains

  !> Adds the two ends of a step.
  pure subroutine record(trace, pairs, offset, phase, contact_set, x, load)
    type(trace_t), intent(inout) :: trace
    integer, intent(in) :: pairs                 !< that may be in contact
    integer, intent(in) :: offset(2)             !< path coordinate of the first of them less the phase, at both ends
    real(dp), intent(in) :: phase(2)             !< of both ends
    integer, intent(in) :: contact_set(2)        !< at both ends
    real(dp), intent(in) :: x(0:2, 2)            !< dynamic transmission error with its derivatives over the step, m; (, end)
    real(dp), intent(in) :: load(0:, :, :)       !< the same of the loads, N; (0:2, contact, end)
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

  !> The loads of the pairs over their whole paths of contact. A pair enters with each mesh period, so that a motion
  !> that repeats after several has as many different pairs, which come one after the other.
  pure subroutine pair_paths(trace, pair, s, load, x)
    type(trace_t), intent(in) :: trace(:)                  !< the mesh periods after which the motion repeats
    integer, allocatable, intent(out) :: pair(:)           !< in which of them the pair entered; (row)
    real(dp), allocatable, intent(out) :: s(:)             !< path coordinate from A, base pitches; (row)
    real(dp), allocatable, intent(out) :: load(:)          !< of this pair, N; (row)
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
end module gearsweep_trace
