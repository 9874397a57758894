!> What the benchmark's programs share: arguments, a clock, errors that stop.
module bench_tools
  use, intrinsic :: iso_fortran_env, only: int64
  use gearsweep_base_error, only: error_t
  use gearsweep_base_kinds, only: dp
  implicit none
  private
  public :: word, number, real_number, seconds, median, check, numbers

  !> Any number of values on a line, read back without loss.
  character(*), parameter :: numbers = '(*(g0, 1x))'

contains

  function word(i) result(text)
    integer, intent(in) :: i
    character(:), allocatable :: text
    integer :: length

    call get_command_argument(i, length=length)
    allocate (character(length) :: text)
    call get_command_argument(i, text)
  end function word

  integer function number(i)
    integer, intent(in) :: i
    character(:), allocatable :: text

    text = word(i)
    read (text, *) number
  end function number

  real(dp) function real_number(i) result(number)
    integer, intent(in) :: i
    character(:), allocatable :: text

    text = word(i)
    read (text, *) number
  end function real_number

  real(dp) function seconds()
    integer(int64) :: now, rate

    call system_clock(now, rate)
    seconds = real(now, dp)/rate
  end function seconds

  pure real(dp) function median(values)
    real(dp), intent(in) :: values(:)
    real(dp) :: rest(size(values))
    integer :: i, at

    rest = values
    do i = 1, (size(values) + 1)/2
      at = minloc(rest, 1)
      median = rest(at)
      rest(at) = huge(median)
    end do
  end function median
  subroutine check(error)
    type(error_t), allocatable, intent(in) :: error

    if (allocated(error)) error stop error%message
  end subroutine check
end module bench_tools
