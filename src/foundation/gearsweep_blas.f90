!> Keeps OpenBLAS to one thread while the library computes, and to one caller at a time where memory is limited;
!> see gearsweep_blas.c and gearsweep_memory.c.
module gearsweep_blas
  implicit none
  private
  public :: hold_blas, release_blas, begin_products, end_products

  interface
    !> On entry; each call needs its `release_blas`. From any thread.
    subroutine hold_blas() bind(c, name='gearsweep_hold_blas')
    end subroutine hold_blas

    !> On leaving.
    subroutine release_blas() bind(c, name='gearsweep_release_blas')
    end subroutine release_blas

    !> Before calls of BLAS and LAPACK; each needs its `end_products`, with no other between them.
    subroutine begin_products() bind(c, name='gearsweep_begin_products')
    end subroutine begin_products

    subroutine end_products() bind(c, name='gearsweep_end_products')
    end subroutine end_products
  end interface
end module gearsweep_blas
