!> Keeps OpenBLAS to one thread while the library computes; see gearsweep_blas.c.
module gearsweep_blas
  implicit none
  private
  public :: hold_blas, release_blas

  interface
    !> On entry; each call needs its `release_blas`. From any thread.
    subroutine hold_blas() bind(c, name='gearsweep_hold_blas')
    end subroutine hold_blas

    !> On leaving.
    subroutine release_blas() bind(c, name='gearsweep_release_blas')
    end subroutine release_blas
  end interface
end module gearsweep_blas
