!> Protection of a call: memory claims, the caller's stop flag, the caller's floating-point traps.
!>
!> A stage claims the memory that it needs before its work begins, as one number estimated from the case; if memory is too small,
!> the stage fails with a message. Later allocations cannot be refused one by one, as the compiler makes hundreds of them. So an
!> estimate may be too high, never too low: test/cases/test_memory.sh runs each task at closely spaced limits. Memory that does not
!> grow with the case needs no claim, as a reserve is kept for it.
!>
!> The caller stops a long call by his own flag, which another thread or a signal may set. Floating-point traps are disabled
!> during a call.
!> See gearsweep_memory.c, gearsweep_stop.c and gearsweep_traps.c.
module gearsweep_base_memory
  use, intrinsic :: iso_c_binding, only: c_double, c_int, c_ptr
  use gearsweep_base_error, only: code_memory, error_t, fail
  use gearsweep_base_kinds, only: dp
  use gearsweep_base_text, only: str
  implicit none
  private
  public :: claim_memory, has_memory, release_claim, team, wants_stop, set_traps_aside, bring_traps_back, leader_traps, &
            share_traps

  interface
    pure subroutine c_claim(bytes, used, blas, lacks, need, left) bind(c, name='gearsweep_claim')
      import :: c_double, c_int
      real(c_double), value :: bytes, used
      integer(c_int), value :: blas
      integer(c_int), intent(out) :: lacks
      real(c_double), intent(out) :: need, left
    end subroutine c_claim

    !> Ends this thread's claim: its memory is allocated, or no longer needed; also at the end of a call.
    subroutine release_claim() bind(c, name='gearsweep_release_claim')
    end subroutine release_claim

    !> Number of threads that can be started, at most `wanted`, at least the caller's own.
    integer(c_int) function c_team(wanted) bind(c, name='gearsweep_team')
      import :: c_int
      integer(c_int), value :: wanted
    end function c_team
  end interface

  interface
    !> Reads the flag's present value; in C, as it may change at any time. 0 for a null pointer.
    pure subroutine look(flag, value) bind(c, name='gearsweep_look')
      import :: c_int, c_ptr
      type(c_ptr), value :: flag
      integer(c_int), intent(out) :: value
    end subroutine look
  end interface

  interface
    !> Disables traps at the start of a call; each call needs its `bring_traps_back`. From any thread.
    subroutine set_traps_aside() bind(c, name='gearsweep_set_traps_aside')
    end subroutine set_traps_aside

    !> Restores traps at the end of a call.
    subroutine bring_traps_back() bind(c, name='gearsweep_bring_traps_back')
    end subroutine bring_traps_back

    !> Traps that this thread has disabled, for the threads that it leads.
    type(c_ptr) function leader_traps() bind(c, name='gearsweep_leader_traps')
      import :: c_ptr
    end function leader_traps

    !> Disables the traps of each thread at the start of a parallel region (`inside` 1), and restores them at its end (0).
    subroutine share_traps(leader, inside) bind(c, name='gearsweep_share_traps')
      import :: c_int, c_ptr
      type(c_ptr), value :: leader
      integer(c_int), value :: inside
    end subroutine share_traps
  end interface

contains

  !> Fails unless `bytes` of memory are available in addition to other threads' claims. The claim replaces this thread's last one,
  !> which must have been allocated by then. `what`: the subject of the message. `used`: bytes that will be written, if fewer.
  !> `blas`: matrix products follow.
  pure subroutine claim_memory(bytes, what, error, used, blas)
    real(dp), intent(in) :: bytes
    character(*), intent(in) :: what
    type(error_t), allocatable, intent(inout) :: error
    real(dp), intent(in), optional :: used
    logical, intent(in), optional :: blas
    real(dp) :: written, need, left
    integer(c_int) :: products, lacks

    if (allocated(error)) return
    written = bytes
    if (present(used)) written = used
    products = 0
    if (present(blas)) products = merge(1_c_int, 0_c_int, blas)
    call c_claim(bytes, written, products, lacks, need, left)
    if (lacks /= 0) call fail(error, code_memory, what//': needs some '//str(megabytes(need))//' MB of memory; '// &
                              str(megabytes(left))//' MB can be had beside what is kept for the rest')
  end subroutine claim_memory

  pure integer function megabytes(bytes)
    real(dp), intent(in) :: bytes

    megabytes = ceiling(min(bytes, 1e15_dp)/1e6_dp)
  end function megabytes

  !> Claims memory, and returns whether it is available instead of an error.
  pure subroutine has_memory(bytes, yes)
    real(dp), intent(in) :: bytes
    logical, intent(out) :: yes
    real(dp) :: need, left
    integer(c_int) :: lacks

    call c_claim(bytes, bytes, 0_c_int, lacks, need, left)
    yes = lacks == 0
  end subroutine has_memory

  !> Number of threads that share the work: at most its parts, and at most those that can be started (see `c_team`).
  integer function team(threads, parts)
    !$ use omp_lib, only: omp_get_max_threads
    integer, intent(in) :: threads               !< requested; 0: all threads of the machine
    integer, intent(in) :: parts

    team = threads
    !$ if (team <= 0) team = omp_get_max_threads()
    team = c_team(int(max(1, min(team, parts)), c_int))
  end function team

  !> True if the flag (an integer) at this address is set.
  pure logical function wants_stop(flag)
    type(c_ptr), intent(in) :: flag
    integer(c_int) :: value

    call look(flag, value)
    wants_stop = value /= 0
  end function wants_stop
end module gearsweep_base_memory
