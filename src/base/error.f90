!> Errors as values: an allocated `error_t` means that the call failed.
!>
!> The codes are the same for the program (its exit code), Fortran, C and Python.
module gearsweep_base_error
  use gearsweep_base_text, only: visible
  implicit none
  private
  public :: error_t, fail

  integer, parameter, public :: code_ok = 0
  !> The case, or an argument, is not usable: the message names it and the allowed values.
  integer, parameter, public :: code_input = 1
  !> The command line is not usable.
  integer, parameter, public :: code_usage = 2
  !> A file or folder cannot be read or written.
  integer, parameter, public :: code_file = 3
  !> Some operating points have no result; the others were computed.
  integer, parameter, public :: code_partial = 4
  !> A numerical method failed, although the input is valid.
  integer, parameter, public :: code_numerical = 5
  !> The work does not fit into the memory.
  integer, parameter, public :: code_memory = 6
  !> The caller stopped the call; earlier results are available.
  integer, parameter, public :: code_stopped = 130

  type :: error_t
    integer :: code = code_ok
    character(:), allocatable :: message
  end type error_t

contains

  !> Sets `error`; the first failure is kept, as it is the cause of later ones. The message becomes one line of UTF-8 with any
  !> quoted text.
  pure subroutine fail(error, code, message)
    type(error_t), allocatable, intent(inout) :: error
    integer, intent(in) :: code
    character(*), intent(in) :: message

    if (allocated(error)) return
    allocate (error)
    error%code = code
    error%message = visible(message)
  end subroutine fail
end module gearsweep_base_error
