!> One step of x" + drag x' + square x = push by collocation at the three Radau points, the last of them the
!> end: of fifth order, and for steps that do not see the natural motion. What is left of it, dies; the
!> motion balances the forces at the end of the step, as it would have long before. (By Gauss points it
!> would be handed on from step to step for ever.) Source: Hairer, Wanner, Solving Ordinary Differential
!> Equations II, section IV.5 (Radau IIA).
module gearsweep_radau
  use gearsweep_kinds, only: dp
  use gearsweep_gauss, only: lanes
  implicit none
  private
  public :: collocate_stiffly, stiff_nodes

  real(dp), parameter :: r = sqrt(6.0_dp)

  !> Places within the step.
  real(dp), parameter :: stiff_nodes(3) = [(4 - r)/10, (4 + r)/10, 1.0_dp]

  !> Weights of the accelerations in the velocity at the nodes, of which the last is the end, and in the position.
  real(dp), parameter :: a(3, 3) = reshape([(88 - 7*r)/360, (296 + 169*r)/1800, (16 - r)/36, &
                                            (296 - 169*r)/1800, (88 + 7*r)/360, (16 + r)/36, &
                                            (-2 + 3*r)/225, (-2 - 3*r)/225, 1.0_dp/9], [3, 3])
  real(dp), parameter :: a2(3, 3) = matmul(a, a)

contains

  !> As `collocate` of `gearsweep_gauss`; second index of square, drag, push: node.
  pure subroutine collocate_stiffly(n, square, drag, push, map)
    integer, intent(in) :: n
    real(dp), intent(in), dimension(lanes, 3) :: square, drag, push
    real(dp), intent(out) :: map(lanes, 6)
    real(dp) :: q(3, 3), cofactor(3, 3), f(3), g(3), slowed(3)
    integer :: i, l

    do l = 1, n
      ! Accelerations at the nodes: q acceleration = push - square x - slowed v.
      do i = 1, 3
        q(i, :) = square(l, i)*a2(i, :) + drag(l, i)*a(i, :)
        q(i, i) = q(i, i) + 1
      end do
      slowed = stiff_nodes*square(l, :) + drag(l, :)
      do i = 1, 3
        cofactor(i, :) = cross_product(q(modulo(i, 3) + 1, :), q(modulo(i + 1, 3) + 1, :))
      end do
      ! What the right-hand sides weigh in the end's position (f) and velocity (g).
      cofactor = cofactor/dot_product(q(1, :), cofactor(1, :))
      f = matmul(cofactor, a2(3, :))
      g = matmul(cofactor, a(3, :))
      map(l, :) = [1 - sum(f*square(l, :)), -sum(g*square(l, :)), 1 - sum(f*slowed), 1 - sum(g*slowed), &
                   sum(f*push(l, :)), sum(g*push(l, :))]
    end do
  end subroutine collocate_stiffly

  pure function cross_product(u, v) result(w)
    real(dp), intent(in) :: u(:), v(:)
    real(dp) :: w(3)

    w = [u(2)*v(3) - u(3)*v(2), u(3)*v(1) - u(1)*v(3), u(1)*v(2) - u(2)*v(1)]
  end function cross_product
end module gearsweep_radau
