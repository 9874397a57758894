!> How fast the sweep's innermost procedure is, beside what a core can do at best in the same build.
module bench_kernel
  use bench_tools, only: seconds, median
  use gearsweep_motion_gauss, only: batch_size, collocate
  use gearsweep_base_kinds, only: dp
  implicit none
  private
  public :: collocation_rate, best_rate

  integer, parameter :: rounds = 21

contains

  !> Operations a second of `collocate` for a whole batch, its data in the nearest cache; `call_time` in seconds.
  subroutine collocation_rate(rate, call_time)
    real(dp), intent(out) :: rate, call_time
    !> Additions, multiplications and the division for one motion, as they stand in the source.
    integer, parameter :: operations = 138, calls = 20000
    real(dp), dimension(batch_size, 3) :: square, drag, push
    real(dp) :: map(batch_size, 6), weight(batch_size, 6), taken(rounds), from
    integer :: i, k

    call random_number(square)
    call random_number(drag)
    call random_number(push)
    do k = 1, rounds
      from = seconds()
      do i = 1, calls
        call collocate(batch_size, square, drag, push, map, weight)
        ! Each call waits for the last one's answer, as in a sweep.
        push(:, 1) = 0.5_dp*map(:, 5)
      end do
      taken(k) = seconds() - from
    end do
    call_time = minval(taken)/calls
    rate = operations*batch_size/call_time
  end subroutine collocation_rate

  !> The most multiplications and additions a second that a loop over registers reaches.
  real(dp) function best_rate()
    integer, parameter :: repeats = 200000
    real(dp) :: taken(rounds, 2), from, rest
    integer :: k

    rest = 0
    do k = 1, rounds
      from = seconds()
      call work_on_32(repeats, rest)
      taken(k, 1) = (seconds() - from)/32
      from = seconds()
      call work_on_64(repeats, rest)
      taken(k, 2) = (seconds() - from)/64
    end do
    best_rate = 2*repeats/minval(taken)
    if (rest < 0) best_rate = 0
  end function best_rate

  subroutine work_on_32(repeats, rest)
    integer, intent(in) :: repeats
    real(dp), intent(inout) :: rest
    real(dp) :: x(32)
    integer :: i, l

    x = [(rest + l, l=1, 32)]
    do i = 1, repeats
      do l = 1, 32
        x(l) = x(l)*0.999999_dp + 1e-7_dp
      end do
    end do
    rest = sum(x)/32
  end subroutine work_on_32

  subroutine work_on_64(repeats, rest)
    integer, intent(in) :: repeats
    real(dp), intent(inout) :: rest
    real(dp) :: x(64)
    integer :: i, l

    x = [(rest + l, l=1, 64)]
    do i = 1, repeats
      do l = 1, 64
        x(l) = x(l)*0.999999_dp + 1e-7_dp
      end do
    end do
    rest = sum(x)/64
  end subroutine work_on_64
end module bench_kernel
