!> Random numbers that are the same on every machine: a stream with all state in its variable.
!> Source: L'Ecuyer 1999, Operations Research 47, 159-164, generator MRG32k3a.
module gearsweep_base_random_stream
  use, intrinsic :: iso_fortran_env, only: int64
  use gearsweep_base_kinds, only: dp, pi
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

  !> Stream of a seed. Streams of neighbouring seeds are unrelated, as each number of the state is a hash of the seed.
  pure type(random_stream_t) function begin_stream(seed) result(stream)
    integer, intent(in) :: seed                  !< any value
    integer :: i

    do i = 1, 3
      stream%first(i) = 1 + modulo(hash(hash(int(seed, int64)) + i), m1 - 1)
      stream%second(i) = 1 + modulo(hash(hash(int(seed, int64)) + i + 3), m2 - 1)
    end do
  end function begin_stream

  !> Hash of 32 bits that depends on all bits of a number. Source: Appleby 2011, MurmurHash3, finalizer `fmix32`.
  elemental integer(int64) function hash(number) result(bits)
    integer(int64), intent(in) :: number
    integer(int64), parameter :: whole = 4294967295_int64

    bits = iand(number, whole)
    bits = times(ieor(bits, ishft(bits, -16)), 2246822507_int64)
    bits = times(ieor(bits, ishft(bits, -13)), 3266489909_int64)
    bits = ieor(bits, ishft(bits, -16))

  contains

    !> Product modulo 2**32, in two parts that fit into 64 bits.
    elemental integer(int64) function times(a, b)
      integer(int64), intent(in) :: a, b

      times = iand(a*iand(b, 65535_int64) + ishft(iand(a*ishft(b, -16), 65535_int64), 16), whole)
    end function times
  end function hash

  !> Draws the next number, above 0 and below 1.
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

  !> Draws normal numbers, of mean 0 and standard deviation 1. Source: Box and Muller 1958, Annals of Mathematical Statistics 29,
  !> 610.
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
end module gearsweep_base_random_stream
