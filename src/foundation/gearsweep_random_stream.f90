!> Random numbers that are the same on every machine: a stream without state outside its variable.
!> Source: L'Ecuyer 1999, Operations Research 47, 159-164, generator MRG32k3a.
module gearsweep_random_stream
  use, intrinsic :: iso_fortran_env, only: int64
  use gearsweep_kinds, only: dp, pi
  implicit none
  private
  public :: random_stream_t, begin_stream

  integer(int64), parameter :: m1 = 4294967087_int64, m2 = 4294944443_int64

  type :: random_stream_t
    private
    integer(int64) :: first(3) = 12345, second(3) = 12345
  contains
    procedure :: draw_normal
  end type random_stream_t

contains

  !> The stream of a seed.
  pure type(random_stream_t) function begin_stream(seed) result(stream)
    integer, intent(in) :: seed                  !< any
    integer(int64), parameter :: least = 2147483647_int64
    integer(int64) :: x
    integer :: i

    ! Lehmer's generator spreads the seed over the state.
    x = 1 + modulo(int(seed, int64), least - 1)
    do i = 1, 20
      x = modulo(48271*x, least)
      if (i > 14 .and. i <= 17) stream%first(i - 14) = x
      if (i > 17) stream%second(i - 17) = x
    end do
  end function begin_stream

  !> The next number, between 0 and 1, neither of which it is.
  pure subroutine next(stream, number)
    class(random_stream_t), intent(inout) :: stream
    real(dp), intent(out) :: number
    integer(int64) :: a, b

    a = modulo(1403580*stream%first(2) - 810728*stream%first(1), m1)
    stream%first = [stream%first(2:), a]
    b = modulo(527612*stream%second(3) - 1370589*stream%second(1), m2)
    stream%second = [stream%second(2:), b]
    number = merge(a - b, a - b + m1, a > b)/(m1 + 1.0_dp)
  end subroutine next

  !> Normal numbers, of mean 0 and standard deviation 1. Source: Box and Muller 1958, Annals of Mathematical Statistics 29, 610.
  pure subroutine draw_normal(stream, number)
    class(random_stream_t), intent(inout) :: stream
    real(dp), intent(out) :: number(:)
    real(dp) :: radius, turn
    integer :: i

    do i = 1, size(number)
      call next(stream, radius)
      call next(stream, turn)
      number(i) = sqrt(-2*log(radius))*cos(2*pi*turn)
    end do
  end subroutine draw_normal
end module gearsweep_random_stream
