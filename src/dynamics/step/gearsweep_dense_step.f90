!> The motion at any place of a step whose contact set stays as it is: the polynomial of seventh degree through value and
!> first three derivatives at both ends, which follow from the equation of motion. Two degrees more than the step's order
!> asks for, so that a step may be left half way without loss.
!>
!> Places count from 0 to 1 over the step, and the state is x and v, its derivative over the step (both m).
module gearsweep_dense_step
  use gearsweep_coefficients, only: need_law
  use gearsweep_gauss, only: batch_size
  use gearsweep_kinds, only: dp
  use gearsweep_oscillator, only: damping
  use gearsweep_period_map, only: dense_step_t, period_map_t, propagate_alike, whole
  implicit none
  private
  public :: find_dense_step, motions_from, evaluate, evaluate_curvature

  !> What makes the motion of each speed: of a unit of x and of v at the begin, and of load and profile error.
  integer, parameter, public :: by_place = 1, by_speed = 2, by_force = 3

  !> At both ends of a step: x" = f - k x - d v with the slopes of k, d and f, all over the step; (speed, end).
  type :: ends_t
    real(dp), dimension(batch_size, 2) :: k, k_slope, d, d_slope, f, f_slope
  end type ends_t

contains

  !> Where the map keeps propagator and polynomials of a step, which are made unless they are there. The contact set is the same
  !> at all speeds.
  pure subroutine find_dense_step(map, step, contact_set, which)
    type(period_map_t), intent(inout) :: map
    integer, intent(in) :: step, contact_set
    integer, intent(out) :: which                !< of map%dense
    integer :: law

    do which = 1, min(map%denses, size(map%dense))
      if (map%dense(which)%step == step .and. map%dense(which)%contact_set == contact_set) return
    end do
    ! Where there is no room, the oldest goes.
    which = modulo(map%denses, size(map%dense)) + 1
    map%denses = map%denses + 1
    associate (dense => map%dense(which))
      dense%step = step
      dense%contact_set = contact_set
      call need_law(map%osc, step, contact_set, map%table, law)
      call propagate_alike(map%osc, map%table, step, map%duration, law, whole, dense%propagator)
      call describe_step(map, step, law, dense%propagator, dense%c)
    end associate
  end subroutine find_dense_step

  !> The polynomials of a step at all speeds of a map.
  pure subroutine describe_step(map, step, law, propagator, c)
    type(period_map_t), intent(in) :: map
    integer, intent(in) :: step, law
    real(dp), intent(in) :: propagator(batch_size, 6)    ! of this contact set
    real(dp), intent(out) :: c(batch_size, 0:7, 3)       ! coefficients in ascending powers; (speed, power, by what)
    real(dp), dimension(0:1, 2) :: omega_squared, forcing
    real(dp), dimension(batch_size, 2) :: begin, last
    type(ends_t) :: ends
    real(dp) :: time, load, width
    integer :: end, l

    width = map%table%width(step)
    omega_squared = map%table%end_omega_squared(:1, :, law)
    forcing = map%table%end_forcing(:1, :, law)
    omega_squared(1, :) = width*omega_squared(1, :)
    forcing(1, :) = width*forcing(1, :)
    load = map%osc%load*sum(1/map%osc%mass)
    do end = 1, 2
      do l = 1, batch_size
        time = map%duration(l)*width
        ends%k(l, end) = omega_squared(0, end)*time**2
        ends%k_slope(l, end) = omega_squared(1, end)*time**2
        ends%d(l, end) = damping(map%osc, sqrt(omega_squared(0, end))*time)
        ends%d_slope(l, end) = ends%d(l, end)*omega_squared(1, end)/(2*omega_squared(0, end))
        ends%f(l, end) = (forcing(0, end) + load)*time**2
        ends%f_slope(l, end) = forcing(1, end)*time**2
      end do
    end do
    begin(:, 1) = 0
    begin(:, 2) = 0
    last(:, 1) = propagator(:, 5)
    last(:, 2) = propagator(:, 6)*width
    call interpolate(ends, begin, last, c(:, :, by_force))
    ends%f = 0
    ends%f_slope = 0
    begin(:, 1) = 1
    last(:, 1) = propagator(:, 1)
    last(:, 2) = propagator(:, 2)*width
    call interpolate(ends, begin, last, c(:, :, by_place))
    begin(:, 1) = 0
    begin(:, 2) = 1
    last(:, 1) = propagator(:, 3)/width
    last(:, 2) = propagator(:, 4)
    call interpolate(ends, begin, last, c(:, :, by_speed))
  end subroutine describe_step

  !> Through the states (x, v) at both ends.
  pure subroutine interpolate(ends, begin, last, c)
    type(ends_t), intent(in) :: ends
    real(dp), intent(in), dimension(batch_size, 2) :: begin, last        ! m; (speed, x or v)
    real(dp), intent(out) :: c(batch_size, 0:7)
    real(dp) :: a0, j0, a1, j1, value, slope, curvature, jerk
    integer :: l

    associate (k => ends%k, d => ends%d, f => ends%f)
      do l = 1, batch_size
        a0 = f(l, 1) - k(l, 1)*begin(l, 1) - d(l, 1)*begin(l, 2)
        j0 = ends%f_slope(l, 1) - ends%k_slope(l, 1)*begin(l, 1) - (k(l, 1) + ends%d_slope(l, 1))*begin(l, 2) - d(l, 1)*a0
        a1 = f(l, 2) - k(l, 2)*last(l, 1) - d(l, 2)*last(l, 2)
        j1 = ends%f_slope(l, 2) - ends%k_slope(l, 2)*last(l, 1) - (k(l, 2) + ends%d_slope(l, 2))*last(l, 2) - d(l, 2)*a1
        value = last(l, 1) - (begin(l, 1) + begin(l, 2) + a0/2 + j0/6)
        slope = last(l, 2) - (begin(l, 2) + a0 + j0/2)
        curvature = a1 - (a0 + j0)
        jerk = j1 - j0
        c(l, 0) = begin(l, 1)
        c(l, 1) = begin(l, 2)
        c(l, 2) = a0/2
        c(l, 3) = j0/6
        c(l, 4) = 35*value - 15*slope + 2.5_dp*curvature - jerk/6
        c(l, 5) = -84*value + 39*slope - 7*curvature + jerk/2
        c(l, 6) = 70*value - 34*slope + 6.5_dp*curvature - jerk/2
        c(l, 7) = -20*value + 10*slope - 2*curvature + jerk/6
      end do
    end associate
  end subroutine interpolate

  !> The polynomials of the motions from these states at the begin of the step.
  pure subroutine motions_from(dense, x, v, c)
    real(dp), intent(in) :: dense(batch_size, 0:7, 3)
    real(dp), intent(in), dimension(batch_size) :: x, v  !< m
    real(dp), intent(out) :: c(batch_size, 0:7)
    integer :: k, l

    do k = 0, 7
      do l = 1, batch_size
        c(l, k) = x(l)*dense(l, k, by_place) + v(l)*dense(l, k, by_speed) + dense(l, k, by_force)
      end do
    end do
  end subroutine motions_from

  !> Value and first derivative of a polynomial of each speed at a place of its own.
  pure subroutine evaluate(c, place, f, slope)
    real(dp), intent(in) :: c(batch_size, 0:7)
    real(dp), intent(in) :: place(batch_size)
    real(dp), intent(out), dimension(batch_size) :: f, slope
    integer :: k, l

    f = c(:, 7)
    slope = 0
    do k = 6, 0, -1
      do l = 1, batch_size
        slope(l) = slope(l)*place(l) + f(l)
        f(l) = f(l)*place(l) + c(l, k)
      end do
    end do
  end subroutine evaluate

  !> Second derivative.
  pure subroutine evaluate_curvature(c, place, curvature)
    real(dp), intent(in) :: c(batch_size, 0:7)
    real(dp), intent(in) :: place(batch_size)
    real(dp), intent(out) :: curvature(batch_size)
    integer :: k, l

    curvature = 0
    do k = 7, 2, -1
      do l = 1, batch_size
        curvature(l) = curvature(l)*place(l) + k*(k - 1)*c(l, k)
      end do
    end do
  end subroutine evaluate_curvature
end module gearsweep_dense_step
