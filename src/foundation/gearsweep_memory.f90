!> Memory that a stage needs is claimed before its work begins, as one number estimated from what the case asks
!> for; where it is not there, the stage fails with a message. See gearsweep_memory.c for what is asked.
!>
!> Of the allocations that follow none can be refused, hundreds as there are, many made by the compiler. So an
!> estimate may be too high, but not too low: test/test_memory.sh runs every task at limits that lie close
!> together. What does not grow with the case needs no claim: a reserve is kept for it.
module gearsweep_memory
  use, intrinsic :: iso_c_binding, only: c_double, c_int
  use gearsweep_error, only: code_memory, error_t, fail
  use gearsweep_kinds, only: dp
  use gearsweep_text, only: str
  implicit none
  private
  public :: claim_memory, has_memory, release_claim, team

  interface
    pure subroutine c_claim(bytes, used, blas, lacks, need, left) bind(c, name='gearsweep_claim')
      import :: c_double, c_int
      real(c_double), value :: bytes, used
      integer(c_int), value :: blas
      integer(c_int), intent(out) :: lacks
      real(c_double), intent(out) :: need, left
    end subroutine c_claim

    !> What this thread claimed is allocated, or no longer wanted; also as a call ends.
    subroutine release_claim() bind(c, name='gearsweep_release_claim')
    end subroutine release_claim

    !> Of so many threads those that there can be, the caller's own at least.
    integer(c_int) function c_team(wanted) bind(c, name='gearsweep_team')
      import :: c_int
      integer(c_int), value :: wanted
    end function c_team
  end interface

contains

  !> Fails unless `bytes` can be had, beside what other threads have claimed. It takes the place of this
  !> thread's last claim, which must have been allocated by then. `what`: what the message says is too large.
  !> `used`: so many of them will be written to, where not all. `blas`: matrix products follow.
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

  !> The same as an answer.
  pure subroutine has_memory(bytes, yes)
    real(dp), intent(in) :: bytes
    logical, intent(out) :: yes
    real(dp) :: need, left
    integer(c_int) :: lacks

    call c_claim(bytes, bytes, 0_c_int, lacks, need, left)
    yes = lacks == 0
  end subroutine has_memory

  !> How many threads share the work: no more than it has parts, and than there can be (see `c_team`).
  integer function team(threads, parts)
    !$ use omp_lib, only: omp_get_max_threads
    integer, intent(in) :: threads               !< wanted; 0: as many as the machine has
    integer, intent(in) :: parts

    team = threads
    !$ if (team <= 0) team = omp_get_max_threads()
    team = c_team(int(max(1, min(team, parts)), c_int))
  end function team
end module gearsweep_memory
