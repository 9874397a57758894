!> One step of x" + damping x' + omega_squared x = forcing by collocation at the three Radau points, the last of
!> which is the end: of fifth order, for steps that are too long to follow the natural motion. Such a step damps what
!> is left of the natural motion and balances the forces at its end, as the true motion would have long before; by
!> Gauss points the natural motion would be carried on from step to step undamped. Source: Hairer, Wanner, Solving
!> Ordinary Differential Equations II, section IV.5 (Radau IIA).
module gearsweep_radau
  use gearsweep_kinds, only: dp
  use gearsweep_gauss, only: batch_size
  use gearsweep_nodes, only: stiff_nodes
  implicit none
  private
  public :: collocate_stiffly

  real(dp), parameter :: r = sqrt(6.0_dp)

  !> Weights of the accelerations in the velocity at the nodes, of which the last is the end, and in the position.
  real(dp), parameter :: a(3, 3) = reshape([(88 - 7*r)/360, (296 + 169*r)/1800, (16 - r)/36, &
                                            (296 - 169*r)/1800, (88 + 7*r)/360, (16 + r)/36, &
                                            (-2 + 3*r)/225, (-2 - 3*r)/225, 1.0_dp/9], [3, 3])
  real(dp), parameter :: a2(3, 3) = matmul(a, a)

contains

  !> The affine map of the state over a step; arguments as those of `collocate` in gearsweep_gauss.
  pure subroutine collocate_stiffly(n, omega_squared, damping, forcing, map)
    integer, intent(in) :: n                     !< how many speeds of the batch
    !> (speed, node): omega^2 times the step squared, 2 zeta omega times the step, forcing times the step squared (m).
    real(dp), intent(in), dimension(batch_size, 3) :: omega_squared, damping, forcing
    !> (speed, element): what x, v and 1 contribute to x and v at the end of the step, two elements each.
    real(dp), intent(out) :: map(batch_size, 6)
    real(dp) :: q(3, 3), cofactor(3, 3), f(3), g(3), slowed(3)
    integer :: i, l

    do l = 1, n
      ! Accelerations at the nodes: q acceleration = forcing - omega_squared x - slowed v.
      do i = 1, 3
        q(i, :) = omega_squared(l, i)*a2(i, :) + damping(l, i)*a(i, :)
        q(i, i) = q(i, i) + 1
      end do
      slowed = stiff_nodes*omega_squared(l, :) + damping(l, :)
      do i = 1, 3
        cofactor(i, :) = cross_product(q(modulo(i, 3) + 1, :), q(modulo(i + 1, 3) + 1, :))
      end do
      ! Weights of the right-hand sides in the position (f) and the velocity (g) at the end.
      cofactor = cofactor/dot_product(q(1, :), cofactor(1, :))
      f = matmul(cofactor, a2(3, :))
      g = matmul(cofactor, a(3, :))
      map(l, :) = [1 - sum(f*omega_squared(l, :)), -sum(g*omega_squared(l, :)), 1 - sum(f*slowed), 1 - sum(g*slowed), &
                   sum(f*forcing(l, :)), sum(g*forcing(l, :))]
    end do
  end subroutine collocate_stiffly

  pure function cross_product(u, v) result(w)
    real(dp), intent(in) :: u(:), v(:)
    real(dp) :: w(3)

    w = [u(2)*v(3) - u(3)*v(2), u(3)*v(1) - u(1)*v(3), u(1)*v(2) - u(2)*v(1)]
  end function cross_product
end module gearsweep_radau
