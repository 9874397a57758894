!> The motion over one mesh period, recorded for tables and pictures.
module gearsweep_trace
  use gearsweep_kinds, only: dp
  implicit none
  private
  public :: trace_t, record, pair_paths

  !> Rows come in twos, the two ends of a step or sub-step; only the first `rows` count.
  type :: trace_t
    integer :: rows = 0
    integer, allocatable :: pairs(:)             !< between A and E; (row)
    real(dp), allocatable :: phase(:)            !< mesh phase, 0 to 1; (row)
    real(dp), allocatable :: x(:)                !< dynamic transmission error, m; (row)
    real(dp), allocatable :: load(:, :)          !< of each pair, N; (pair, row)
  end type trace_t

contains

  !> Adds the two ends of a step.
  pure subroutine record(trace, pairs, phase, x, stiffness, profile_error, closed)
    type(trace_t), intent(inout) :: trace
    integer, intent(in) :: pairs                 !< between A and E
    real(dp), intent(in) :: phase(2)             !< of both ends
    real(dp), intent(in) :: x(:)                 !< dynamic transmission error, m; (end)
    real(dp), intent(in) :: stiffness(:, :)      !< N/m; (pair, end)
    real(dp), intent(in) :: profile_error(:, :)  !< m; (pair, end)
    logical, intent(in) :: closed(:)             !< (contact)
    integer :: k

    if (.not. allocated(trace%x)) call resize(trace, size(closed), 256)
    if (trace%rows + 2 > size(trace%x)) call resize(trace, size(trace%load, 1), 2*size(trace%x))
    do k = 1, 2
      trace%rows = trace%rows + 1
      trace%pairs(trace%rows) = pairs
      trace%phase(trace%rows) = phase(k)
      trace%x(trace%rows) = x(k)
      trace%load(:, trace%rows) = 0
      where (closed(:pairs)) &
        trace%load(:pairs, trace%rows) = stiffness(:pairs, k)*max(0.0_dp, x(k) - profile_error(:pairs, k))
    end do
  end subroutine record

  pure subroutine resize(trace, pairs, rows)
    type(trace_t), intent(inout) :: trace
    integer, intent(in) :: pairs, rows
    type(trace_t) :: larger

    allocate (larger%pairs(rows), larger%phase(rows), larger%x(rows), larger%load(pairs, rows))
    larger%rows = trace%rows
    associate (n => trace%rows)
      if (n > 0) then
        larger%pairs(:n) = trace%pairs(:n)
        larger%phase(:n) = trace%phase(:n)
        larger%x(:n) = trace%x(:n)
        larger%load(:, :n) = trace%load(:, :n)
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
    integer :: i, j, k, n

    n = sum([(sum(trace(i)%pairs(:trace(i)%rows)), i=1, size(trace))])
    allocate (pair(n), s(n), load(n), x(n))
    n = 0
    do i = 1, size(trace)
      do j = 1, maxval(trace(1)%pairs(:trace(1)%rows))
        associate (now => trace(1 + modulo(i + j - 2, size(trace))))
          do k = 1, now%rows
            if (now%pairs(k) < j) cycle
            n = n + 1
            pair(n) = i
            s(n) = now%phase(k) + j - 1
            load(n) = now%load(j, k)
            x(n) = now%x(k)
          end do
        end associate
      end do
    end do
  end subroutine pair_paths
end module gearsweep_trace
