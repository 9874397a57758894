!> Ctrl-C and `kill` end a run soon, and what is done by then is kept; the second time they end it at once.
module gearsweep_interruption
  use, intrinsic :: iso_c_binding, only: c_funloc, c_funptr, c_int, c_intptr_t
  use gearsweep_base, only: code_stopped
  implicit none
  private
  public :: catch_signals, drop_unread

  !> For `run_study`: stop, points done, of how many.
  integer(c_int), target, volatile, public :: watch(3) = 0

  interface
    type(c_funptr) function c_signal(number, handler) bind(c, name='signal')
      import :: c_funptr, c_int
      integer(c_int), value :: number
      type(c_funptr), value :: handler
    end function c_signal

    subroutine c_leave(code) bind(c, name='_exit')
      import :: c_int
      integer(c_int), value :: code
    end subroutine c_leave
  end interface

contains

  subroutine catch_signals()
    integer(c_int), parameter :: interrupt = 2, terminate = 15
    type(c_funptr) :: before

    before = c_signal(interrupt, c_funloc(note_signal))
    before = c_signal(terminate, c_funloc(note_signal))
  end subroutine catch_signals

  !> Who reads may leave: what is left to print is dropped then.
  subroutine drop_unread()
    integer(c_int), parameter :: broken_pipe = 13
    integer(c_intptr_t), parameter :: ignore = 1
    type(c_funptr) :: before

    before = c_signal(broken_pipe, transfer(ignore, before))
  end subroutine drop_unread

  subroutine note_signal(number) bind(c)
    integer(c_int), value :: number

    if (watch(1) /= 0) call c_leave(int(code_stopped, c_int))
    watch(1) = number
  end subroutine note_signal
end module gearsweep_interruption
