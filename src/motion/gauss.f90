!> One step of x" + damping x' + omega_squared x = forcing by collocation at three Gauss or three Radau points; affine in the
!> state.
!>
!> Gauss: sixth order, stable for any step. Source: Hairer, Noersett, Wanner, Solving Ordinary Differential Equations I,
!> section II.7 (Kuntzmann-Butcher methods). Radau: fifth order, with the last point at the end, for steps that are too long to
!> follow the natural motion. Such a step damps the remaining natural motion and balances the forces at its end, as the true
!> motion would have long before; by Gauss points the natural motion would continue from step to step undamped. Source: Hairer,
!> Wanner, Solving Ordinary Differential Equations II, section IV.5 (Radau IIA).
module gearsweep_motion_gauss
  use gearsweep_base, only: dp
  implicit none
  private
  public :: collocate, batch_size, order, collocate_stiffly

  real(dp), parameter :: r15 = sqrt(15.0_dp), r6 = sqrt(6.0_dp)

  !> Places within the step, 0 to 1: Gauss points and, for steps that do not resolve the natural motion, Radau points.
  real(dp), parameter, public :: nodes(3) = [0.5_dp - r15/10, 0.5_dp, 0.5_dp + r15/10]
  real(dp), parameter, public :: stiff_nodes(3) = [(4 - r6)/10, (4 + r6)/10, 1.0_dp]

  !> Speeds of a batch: their motions are computed side by side in the lanes of the processor's vectors.
  integer, parameter :: batch_size = 8

  integer, parameter :: order = 6
  real(dp), parameter :: r = sqrt(15.0_dp)

  !> Weights of the accelerations in the velocity at the nodes (a) and at the end (b), and in the
  !> position (a2 = a a, b2).
  real(dp), parameter :: a(3, 3) = reshape([5.0_dp/36, 5.0_dp/36 + r/24, 5.0_dp/36 + r/30, &
                                            2.0_dp/9 - r/15, 2.0_dp/9, 2.0_dp/9 + r/15, &
                                            5.0_dp/36 - r/30, 5.0_dp/36 - r/24, 5.0_dp/36], [3, 3])
  real(dp), parameter :: a2(3, 3) = matmul(a, a)
  real(dp), parameter :: b(3) = [5.0_dp/18, 4.0_dp/9, 5.0_dp/18]
  real(dp), parameter :: b2(3) = b*(1 - nodes)

  real(dp), parameter :: r_stiff = sqrt(6.0_dp)

  !> Weights of the accelerations in the velocity at the nodes, of which the last is the end, and in the position.
  real(dp), parameter :: a_stiff(3, 3) = reshape([(88 - 7*r_stiff)/360, (296 + 169*r_stiff)/1800, (16 - r_stiff)/36, &
                                            (296 - 169*r_stiff)/1800, (88 + 7*r_stiff)/360, (16 + r_stiff)/36, &
                                            (-2 + 3*r_stiff)/225, (-2 - 3*r_stiff)/225, 1.0_dp/9], [3, 3])
  real(dp), parameter :: a2_stiff(3, 3) = matmul(a_stiff, a_stiff)

contains

  !> Computes the affine map of the state over a step, for the first speeds of a batch. The state is (x, v), where v is the
  !> displacement (m) at constant velocity over the full step.
  pure subroutine collocate(n, omega_squared, damping, forcing, map, weight)
    integer, intent(in) :: n                     !< number of speeds
    !> Coefficients at the nodes, (speed, node): omega^2 times the step squared, 2 zeta omega times the step, and the forcing
    !> times the step squared (m).
    real(dp), intent(in), dimension(batch_size, 3) :: omega_squared, damping, forcing
    !> (speed, element): contributions of x, v and 1 to x and v at the end of the step, two elements each.
    real(dp), intent(out) :: map(batch_size, 6)
    !> Contributions of the forcing at each node to x, then to v, at the end of the step; (speed, element).
    real(dp), intent(out) :: weight(batch_size, 6)
    real(dp) :: q11, q12, q13, q21, q22, q23, q31, q32, q33, c11, c12, c13, c21, c22, c23, c31, c32, c33
    real(dp) :: k1, k2, k3, d1, d2, d3, scale, g1, g2, g3, f1, f2, f3, e1, e2, e3
    integer :: l

    do l = 1, n
      k1 = omega_squared(l, 1)
      k2 = omega_squared(l, 2)
      k3 = omega_squared(l, 3)
      d1 = damping(l, 1)
      d2 = damping(l, 2)
      d3 = damping(l, 3)
      ! Accelerations at the nodes: (I + K a2 + D a) acceleration = p - k x - (c k + d) v.
      q11 = 1 + k1*a2(1, 1) + d1*a(1, 1)
      q12 = k1*a2(1, 2) + d1*a(1, 2)
      q13 = k1*a2(1, 3) + d1*a(1, 3)
      q21 = k2*a2(2, 1) + d2*a(2, 1)
      q22 = 1 + k2*a2(2, 2) + d2*a(2, 2)
      q23 = k2*a2(2, 3) + d2*a(2, 3)
      q31 = k3*a2(3, 1) + d3*a(3, 1)
      q32 = k3*a2(3, 2) + d3*a(3, 2)
      q33 = 1 + k3*a2(3, 3) + d3*a(3, 3)
      ! Cofactors.
      c11 = q22*q33 - q23*q32
      c12 = q23*q31 - q21*q33
      c13 = q21*q32 - q22*q31
      c21 = q13*q32 - q12*q33
      c22 = q11*q33 - q13*q31
      c23 = q12*q31 - q11*q32
      c31 = q12*q23 - q13*q22
      c32 = q13*q21 - q11*q23
      c33 = q11*q22 - q12*q21
      scale = 1/(q11*c11 + q12*c12 + q13*c13)
      ! Weights of the right-hand sides in the velocity (g) and the position (f) at the end.
      g1 = scale*(b(1)*c11 + b(2)*c12 + b(3)*c13)
      g2 = scale*(b(1)*c21 + b(2)*c22 + b(3)*c23)
      g3 = scale*(b(1)*c31 + b(2)*c32 + b(3)*c33)
      f1 = scale*(b2(1)*c11 + b2(2)*c12 + b2(3)*c13)
      f2 = scale*(b2(1)*c21 + b2(2)*c22 + b2(3)*c23)
      f3 = scale*(b2(1)*c31 + b2(2)*c32 + b2(3)*c33)
      e1 = nodes(1)*k1 + d1
      e2 = nodes(2)*k2 + d2
      e3 = nodes(3)*k3 + d3
      map(l, 1) = 1 - (f1*k1 + f2*k2 + f3*k3)
      map(l, 2) = -(g1*k1 + g2*k2 + g3*k3)
      map(l, 3) = 1 - (f1*e1 + f2*e2 + f3*e3)
      map(l, 4) = 1 - (g1*e1 + g2*e2 + g3*e3)
      map(l, 5) = f1*forcing(l, 1) + f2*forcing(l, 2) + f3*forcing(l, 3)
      map(l, 6) = g1*forcing(l, 1) + g2*forcing(l, 2) + g3*forcing(l, 3)
      weight(l, 1) = f1
      weight(l, 2) = f2
      weight(l, 3) = f3
      weight(l, 4) = g1
      weight(l, 5) = g2
      weight(l, 6) = g3
    end do
  end subroutine collocate

  !> Computes the affine map of the state over a step at Radau points; arguments as those of `collocate`.
  pure subroutine collocate_stiffly(n, omega_squared, damping, forcing, map, weight)
    integer, intent(in) :: n                     !< number of speeds in the batch
    !> (speed, node): omega^2 times the step squared, 2 zeta omega times the step, forcing times the step squared (m).
    real(dp), intent(in), dimension(batch_size, 3) :: omega_squared, damping, forcing
    !> (speed, element): contributions of x, v and 1 to x and v at the end of the step, two elements each.
    real(dp), intent(out) :: map(batch_size, 6), weight(batch_size, 6)
    real(dp) :: q(3, 3), cofactor(3, 3), f(3), g(3), slowed(3)
    integer :: i, l

    do l = 1, n
      ! Accelerations at the nodes: q acceleration = forcing - omega_squared x - slowed v.
      do i = 1, 3
        q(i, :) = omega_squared(l, i)*a2_stiff(i, :) + damping(l, i)*a_stiff(i, :)
        q(i, i) = q(i, i) + 1
      end do
      slowed = stiff_nodes*omega_squared(l, :) + damping(l, :)
      do i = 1, 3
        cofactor(i, :) = cross_product(q(modulo(i, 3) + 1, :), q(modulo(i + 1, 3) + 1, :))
      end do
      ! Weights of the right-hand sides in the position (f) and the velocity (g) at the end.
      cofactor = cofactor/dot_product(q(1, :), cofactor(1, :))
      f = matmul(cofactor, a2_stiff(3, :))
      g = matmul(cofactor, a_stiff(3, :))
      map(l, :) = [1 - sum(f*omega_squared(l, :)), -sum(g*omega_squared(l, :)), 1 - sum(f*slowed), 1 - sum(g*slowed), &
                   sum(f*forcing(l, :)), sum(g*forcing(l, :))]
      weight(l, :) = [f, g]
    end do
  end subroutine collocate_stiffly

  pure function cross_product(u, v) result(w)
    real(dp), intent(in) :: u(:), v(:)
    real(dp) :: w(3)

    w = [u(2)*v(3) - u(3)*v(2), u(3)*v(1) - u(1)*v(3), u(1)*v(2) - u(2)*v(1)]
  end function cross_product
end module gearsweep_motion_gauss
