!> A body of equal sectors around an axis, from one sector: displacements differ from sector to sector by the phase n times the
!> pitch angle, n the nodal diameter (Thomas 1979, Int. J. Numer. Meth. Engng 14).
!>
!> All nodes have radial, tangential and axial displacements, so that those in the far cut are those in the near cut
!> times exp(i n pitch). The inner unknowns of the sector do not depend on n: they are eliminated once, in real arithmetic. The part
!> that depends on n is in gearsweep_body_modes_sector_modes.
module gearsweep_body_modes_cyclic
  use gearsweep_base, only: claim_memory, dp, elements_t, error_t, factor_inner, sparse_t, str
  use gearsweep_elastic, only: material_t
  use gearsweep_body_modes_sector, only: brick_matrices, brick_nodes, sector_t
  implicit none
  private
  public :: cyclic_t, make_cyclic

  integer, parameter, public :: unknowns_each = 3*brick_nodes  !< unknowns of an element
  integer, parameter :: triangle = unknowns_each*(unknowns_each + 1)/2

  !> A sector with supports, factored apart from its cuts: K + shift M.
  type :: cyclic_t
    type(sector_t) :: sector
    integer :: inner = 0, cut = 0                !< number of unknowns inside, and in each cut
    integer, allocatable :: equation(:, :)       !< equation of each node's displacements, 0 where fixed: inner ones first, then the
                                                 !< near cut's, then the far one's (3, nodes)
    real(dp) :: shift = 0                        !< 1/s^2
    real(dp), allocatable :: stiffness(:, :, :)  !< element stiffness, with the shift, N/m (60, 60, elements)
    real(dp), allocatable :: mass(:, :, :)       !< element mass, in each direction, kg (20, 20, elements)
    real(dp), allocatable :: frame(:, :)         !< cosine and sine of each node's angle (2, nodes)
    type(sparse_t) :: factor                     !< factor of the inner unknowns
    real(dp), allocatable :: border(:, :)        !< matrix of near and far cut after the elimination of the others
  end type cyclic_t

contains

  !> Assembles and factors a sector of `material`.
  !>
  !> `held(3, nodes)`: radial, tangential and axial displacements that are zero, the same in both cuts. `shift` (1/s^2): above
  !> 0, so that a body with rigid-body motions can be factored too. Earlier contents of `cyclic` are freed.
  subroutine make_cyclic(sector, material, held, shift, cyclic, error)
    type(sector_t), intent(in) :: sector
    type(material_t), intent(in) :: material
    logical, intent(in) :: held(:, :)
    real(dp), intent(in) :: shift
    type(cyclic_t), intent(inout) :: cyclic
    type(error_t), allocatable, intent(inout) :: error
    type(elements_t) :: matrices
    character(:), allocatable :: what
    integer :: elements, nodes, e

    elements = size(sector%element, 2)
    nodes = size(sector%x, 2)
    call cyclic%factor%free()
    if (allocated(cyclic%equation)) deallocate (cyclic%equation, cyclic%stiffness, cyclic%mass, cyclic%frame, cyclic%border)
    what = 'elements across a tooth of the body: the grid with '//str(nodes)//' nodes'
    call claim_memory(elements*(8.0_dp*(unknowns_each**2 + brick_nodes**2 + triangle) + 1000) + 100.0_dp*nodes, what, error)
    if (allocated(error)) return
    cyclic%sector = sector
    cyclic%shift = shift
    call number_unknowns(held, cyclic)
    call make_matrices(material, cyclic)
    call matrices%begin(elements, unknowns_each)
    do e = 1, elements
      call matrices%add(reshape(cyclic%equation(:, sector%element(:, e)), [unknowns_each]), cyclic%stiffness(:, :, e))
    end do
    call matrices%finish()
    call claim_memory(8.0_dp*(2*cyclic%cut)**2, what, error)
    if (allocated(error)) return
    allocate (cyclic%border(2*cyclic%cut, 2*cyclic%cut))
    call factor_inner(cyclic%inner + 2*cyclic%cut, matrices%first, matrices%at, matrices%values, what, &
                      cyclic%factor, cyclic%border, error)
  end subroutine make_cyclic

  pure subroutine number_unknowns(held, cyclic)
    logical, intent(in) :: held(:, :)
    type(cyclic_t), intent(inout) :: cyclic
    logical :: is_inner(size(held, 2))
    integer :: n, p, d, last

    associate (near => cyclic%sector%near, far => cyclic%sector%far)
      allocate (cyclic%equation(3, size(held, 2)), source=0)
      is_inner = .true.
      is_inner(near) = .false.
      is_inner(far) = .false.
      last = 0
      do p = 1, size(held, 2)
        if (.not. is_inner(p)) cycle
        do d = 1, 3
          if (held(d, p)) cycle
          last = last + 1
          cyclic%equation(d, p) = last
        end do
      end do
      cyclic%inner = last
      cyclic%cut = 3*size(near) - count(held(:, near))
      do n = 1, size(near)
        do d = 1, 3
          if (held(d, near(n))) cycle
          last = last + 1
          cyclic%equation(d, near(n)) = last
          cyclic%equation(d, far(n)) = last + cyclic%cut
        end do
      end do
    end associate
  end subroutine number_unknowns

  !> Computes the element matrices, in each node's own directions.
  pure subroutine make_matrices(material, cyclic)
    type(material_t), intent(in) :: material
    type(cyclic_t), intent(inout) :: cyclic
    real(dp) :: lame(2), turned(unknowns_each), c, s
    integer :: e, p, k, a, i

    associate (sector => cyclic%sector, young => material%young, nu => material%poisson)
      lame = young/(2*(1 + nu))*[2*nu/(1 - 2*nu), 1.0_dp]
      allocate (cyclic%frame(2, size(sector%x, 2)))
      do p = 1, size(sector%x, 2)
        cyclic%frame(:, p) = sector%x(:2, p)/norm2(sector%x(:2, p))
      end do
      allocate (cyclic%stiffness(unknowns_each, unknowns_each, size(sector%element, 2)))
      allocate (cyclic%mass(brick_nodes, brick_nodes, size(sector%element, 2)))
      do e = 1, size(sector%element, 2)
        associate (k_e => cyclic%stiffness(:, :, e), m_e => cyclic%mass(:, :, e), list => sector%element(:, e))
          call brick_matrices(sector%x(:, list), lame, material%density, k_e, m_e)
          do k = 1, brick_nodes
            do i = 1, 3
              k_e(i::3, 3*k - 3 + i) = k_e(i::3, 3*k - 3 + i) + cyclic%shift*m_e(:, k)
            end do
          end do
          do k = 1, brick_nodes
            a = 3*k - 2
            c = cyclic%frame(1, list(k))
            s = cyclic%frame(2, list(k))
            turned = c*k_e(:, a) + s*k_e(:, a + 1)
            k_e(:, a + 1) = c*k_e(:, a + 1) - s*k_e(:, a)
            k_e(:, a) = turned
          end do
          do k = 1, brick_nodes
            a = 3*k - 2
            c = cyclic%frame(1, list(k))
            s = cyclic%frame(2, list(k))
            turned = c*k_e(a, :) + s*k_e(a + 1, :)
            k_e(a + 1, :) = c*k_e(a + 1, :) - s*k_e(a, :)
            k_e(a, :) = turned
          end do
        end associate
      end do
    end associate
  end subroutine make_matrices
end module gearsweep_body_modes_cyclic
