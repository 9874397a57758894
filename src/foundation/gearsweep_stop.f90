!> How a caller ends a long call: by a flag of his own, which another thread or a signal may set.
module gearsweep_stop
  use, intrinsic :: iso_c_binding, only: c_int, c_ptr
  implicit none
  private
  public :: wants_stop

  interface
    !> The flag as it is now; C reads it, as it may change at any time. 0 for a null pointer.
    pure subroutine look(flag, value) bind(c, name='gearsweep_look')
      import :: c_int, c_ptr
      type(c_ptr), value :: flag
      integer(c_int), intent(out) :: value
    end subroutine look
  end interface

contains

  !> Is the flag (an integer) that this points to set?
  pure logical function wants_stop(flag)
    type(c_ptr), intent(in) :: flag
    integer(c_int) :: value

    call look(flag, value)
    wants_stop = value /= 0
  end function wants_stop
end module gearsweep_stop
