!> Errors as values: an allocated `error_t` means that the call failed.
!>
!> The codes are the same for the program (its exit code), Fortran, C and Python.
module gearsweep_error
  implicit none
  private
  public :: error_t, fail

  integer, parameter, public :: code_ok = 0
  !> The case, or an argument, is not usable: the message names what and what is allowed.
  integer, parameter, public :: code_input = 1
  !> The command line is not usable.
  integer, parameter, public :: code_usage = 2
  !> A file or folder cannot be read or written.
  integer, parameter, public :: code_file = 3
  !> Some operating points have no answer; the others were computed.
  integer, parameter, public :: code_partial = 4
  !> A numerical method did not deliver, although the input is valid.
  integer, parameter, public :: code_numerical = 5
  !> The work does not fit into the memory.
  integer, parameter, public :: code_memory = 6
  !> The caller ended the call; what was done by then is there.
  integer, parameter, public :: code_stopped = 130

  type :: error_t
    integer :: code = code_ok
    character(:), allocatable :: message
  end type error_t

contains

  !> Fills `error`; the first failure is kept, as it is the cause of later ones.
  pure subroutine fail(error, code, message)
    type(error_t), allocatable, intent(inout) :: error
    integer, intent(in) :: code
    character(*), intent(in) :: message

    if (allocated(error)) return
    allocate (error)
    error%code = code
    error%message = message
  end subroutine fail
end module gearsweep_error
