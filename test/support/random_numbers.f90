!> Random numbers that are the same everywhere, by Park and Miller's generator.
module test_support_random_numbers
  use, intrinsic :: iso_fortran_env, only: int64
  use gearsweep_base_kinds, only: dp
  implicit none
  private
  public :: random_t

  type :: random_t
    integer(int64) :: seed = 1
  contains
    procedure :: uniform, between, power
  end type random_t

contains

  real(dp) function uniform(self)
    class(random_t), intent(inout) :: self
    integer(int64), parameter :: modulus = 2147483647_int64

    self%seed = mod(48271_int64*self%seed, modulus)
    uniform = real(self%seed, dp)/modulus
  end function uniform

  real(dp) function between(self, low, high)
    class(random_t), intent(inout) :: self
    real(dp), intent(in) :: low, high

    between = low + (high - low)*self%uniform()
  end function between

  !> Evenly spread logarithm.
  real(dp) function power(self, low, high)
    class(random_t), intent(inout) :: self
    real(dp), intent(in) :: low, high

    power = low*(high/low)**self%uniform()
  end function power
end module test_support_random_numbers
