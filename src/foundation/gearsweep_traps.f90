!> Sets the caller's floating-point traps aside while the library computes; see gearsweep_traps.c.
module gearsweep_traps
  use, intrinsic :: iso_c_binding, only: c_int, c_ptr
  implicit none
  private
  public :: set_traps_aside, bring_traps_back, leader_traps, share_traps

  interface
    !> On entry; each call needs its `bring_traps_back`. From any thread.
    subroutine set_traps_aside() bind(c, name='gearsweep_set_traps_aside')
    end subroutine set_traps_aside

    !> On leaving.
    subroutine bring_traps_back() bind(c, name='gearsweep_bring_traps_back')
    end subroutine bring_traps_back

    !> What this thread has set aside, for the threads that it leads.
    type(c_ptr) function leader_traps() bind(c, name='gearsweep_leader_traps')
      import :: c_ptr
    end function leader_traps

    !> By each thread as a parallel region begins, `inside` 1, and ends, 0.
    subroutine share_traps(leader, inside) bind(c, name='gearsweep_share_traps')
      import :: c_int, c_ptr
      type(c_ptr), value :: leader
      integer(c_int), value :: inside
    end subroutine share_traps
  end interface
end module gearsweep_traps
