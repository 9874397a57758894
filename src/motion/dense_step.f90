!> The motion within a step, or within the part of it that begins at a change of contact, while one contact set holds.
!>
!> It is a polynomial of seventh degree that matches the value and the first three derivatives at both ends, which follow from the
!> equation of motion. Its degree is two above the order of the step, so that a motion may change its contact half way without
!> loss of accuracy. It is linear in the state at the start: one polynomial by unit x, one by unit v, and one by load and profile
!> error. v (m) is the derivative of x (m) over the step or the part, whose places run from 0 to 1. Where damping or the length of
!> a step forbids it (`is_smooth`), the polynomial is of fifth degree and matches two derivatives only: the third would be a small
!> difference of large forces.
module gearsweep_motion_dense_step
  use gearsweep_base, only: derivative_of, dp, quintic, value_of
  use gearsweep_motion_coefficients, only: need_law
  use gearsweep_motion_gauss, only: batch_size, collocate, nodes
  use gearsweep_motion_load_peaks, only: cubic_curvature, turns_too_far
  use gearsweep_motion_oscillator, only: damping
  use gearsweep_motion_period_map, only: period_map_t, propagate_alike
  implicit none
  private
  public :: by_place, by_speed, by_force, is_smooth, need_dense_step, need_dense_part, motions_from, states_at

  !> Indices of the polynomials: by unit x and by unit v at the start, and by load and profile error.
  integer, parameter :: by_place = 1, by_speed = 2, by_force = 3

  !> Values at both ends: x" = f - k x - d v with the slopes of k, d and f; (speed, end).
  type :: ends_t
    real(dp), dimension(batch_size, 2) :: k, k_slope, d, d_slope, f, f_slope
  end type ends_t

contains

  !> True if the motion in a step is so smooth that its third derivative at the ends is known, and that it may be extrapolated to
  !> the start of the step.
  pure logical function is_smooth(map, step)
    type(period_map_t), intent(in) :: map
    integer, intent(in) :: step

    is_smooth = .not. (map%osc%damping_ratio > 1 .or. map%table%kind(step)%stiff)
  end function is_smooth

  !> Finds propagator and polynomials of a whole step in the map, and computes them if they are missing.
  pure subroutine need_dense_step(map, step, contact_set, which)
    type(period_map_t), intent(inout) :: map
    integer, intent(in) :: step
    integer, intent(in) :: contact_set           !< the same at all speeds
    integer, intent(out) :: which                !< index into map%dense
    type(ends_t) :: ends
    real(dp) :: weight(batch_size, 6), k(0:1), f(0:1), time, width, load
    integer :: end, l, law

    do which = 1, min(map%denses, size(map%dense))
      if (map%dense(which)%step == step .and. map%dense(which)%contact_set == contact_set) return
    end do
    call replace_oldest(map, which)
    call need_law(map%osc, step, contact_set, map%table, law)
    width = map%table%width(step)
    load = map%osc%load*sum(1/map%osc%mass)
    associate (dense => map%dense(which), n => map%speeds)
      dense%step = step
      dense%contact_set = contact_set
      call propagate_alike(map%osc, map%table, step, map%duration(:n), law, dense%propagator, weight)
      dense%propagator(:n, 2) = dense%propagator(:n, 2)*width
      dense%propagator(:n, 3) = dense%propagator(:n, 3)/width
      dense%propagator(:n, 6) = dense%propagator(:n, 6)*width
      do end = 1, 2
        k = map%table%end_omega_squared(:1, end, law)*[1.0_dp, width]
        f = map%table%end_forcing(:1, end, law)*[1.0_dp, width]
        do l = 1, n
          time = map%duration(l)*width
          call set_end(damping(map%osc, time), time, k, f, load, l, end, ends)
        end do
      end do
      call describe(n, is_smooth(map, step), ends, dense%propagator, dense%c)
    end associate
  end subroutine need_dense_step

  !> Computes propagator and polynomials of a part of a step, at each speed another one, by Gauss points within it.
  pure subroutine need_dense_part(map, step, contact_set, left, width, which)
    type(period_map_t), intent(inout) :: map
    integer, intent(in) :: step
    integer, intent(in) :: contact_set           !< the same at all speeds
    real(dp), intent(in), dimension(batch_size) :: left, width     !< start and length of the part, as parts of the step
    integer, intent(out) :: which                !< index into map%dense
    type(ends_t) :: ends
    real(dp), dimension(batch_size, size(nodes)) :: omega_squared, damped, forcing
    real(dp) :: k(0:5), f(0:5), weight(batch_size, 6), scale(0:2), time, place, load
    integer :: end, i, l, law

    call replace_oldest(map, which)
    call need_law(map%osc, step, contact_set, map%table, law)
    scale = [1.0_dp, map%table%width(step), map%table%width(step)**2]
    k = quintic(scale*map%table%end_omega_squared(:, 1, law), scale*map%table%end_omega_squared(:, 2, law))
    f = quintic(scale*map%table%end_forcing(:, 1, law), scale*map%table%end_forcing(:, 2, law))
    load = map%osc%load*sum(1/map%osc%mass)
    associate (dense => map%dense(which), n => map%speeds)
      dense%step = 0                             ! no other part is the same
      do l = 1, n
        time = map%duration(l)*map%table%width(step)*width(l)
        do i = 1, size(nodes)
          place = left(l) + width(l)*nodes(i)
          omega_squared(l, i) = time**2*value_of(k, place)
          damped(l, i) = damping(map%osc, time)*sqrt(value_of(k, place))
          forcing(l, i) = time**2*(value_of(f, place) + load)
        end do
        do end = 1, 2
          place = left(l) + (end - 1)*width(l)
          call set_end(damping(map%osc, time), time, [value_of(k, place), width(l)*derivative_of(k, place)], &
                       [value_of(f, place), width(l)*derivative_of(f, place)], load, l, end, ends)
        end do
      end do
      call collocate(n, omega_squared, damped, forcing, dense%propagator, weight)
      call describe(n, .true., ends, dense%propagator, dense%c)
    end associate
  end subroutine need_dense_part

  !> Returns free room for a description, else that of the oldest one.
  pure subroutine replace_oldest(map, which)
    type(period_map_t), intent(inout) :: map
    integer, intent(out) :: which                !< index into map%dense

    which = modulo(map%denses, size(map%dense)) + 1
    map%denses = map%denses + 1
  end subroutine replace_oldest

  !> Sets the values at one end for one speed.
  pure subroutine set_end(damping, time, omega_squared, forcing, load, l, end, ends)
    real(dp), intent(in) :: damping              ! 2 zeta times `time`, s
    real(dp), intent(in) :: time                 ! duration of the step or the part, s
    real(dp), intent(in) :: omega_squared(0:1), forcing(0:1)       ! with their derivatives over it, 1/s^2 and m/s^2
    real(dp), intent(in) :: load                 ! its acceleration, m/s^2
    integer, intent(in) :: l, end
    type(ends_t), intent(inout) :: ends

    ends%k(l, end) = omega_squared(0)*time**2
    ends%k_slope(l, end) = omega_squared(1)*time**2
    ends%d(l, end) = damping*sqrt(omega_squared(0))
    ends%d_slope(l, end) = 0
    if (omega_squared(0) > 0) ends%d_slope(l, end) = ends%d(l, end)*omega_squared(1)/(2*omega_squared(0))
    ends%f(l, end) = (forcing(0) + load)*time**2
    ends%f_slope(l, end) = forcing(1)*time**2
  end subroutine set_end

  !> Computes the polynomials from the propagator.
  pure subroutine describe(n, smooth, ends, propagator, c)
    integer, intent(in) :: n                     ! number of speeds
    logical, intent(in) :: smooth                ! true: with third derivatives
    type(ends_t), intent(inout) :: ends
    real(dp), intent(in) :: propagator(batch_size, 6)    ! of x and v; (speed, element)
    real(dp), intent(out) :: c(batch_size, 0:7, 3)       ! coefficients in ascending powers; (speed, power, by what)

    call interpolate(n, smooth, ends, 0.0_dp, 0.0_dp, propagator(:, 5), propagator(:, 6), c(:, :, by_force))
    ends%f = 0
    ends%f_slope = 0
    call interpolate(n, smooth, ends, 1.0_dp, 0.0_dp, propagator(:, 1), propagator(:, 2), c(:, :, by_place))
    call interpolate(n, smooth, ends, 0.0_dp, 1.0_dp, propagator(:, 3), propagator(:, 4), c(:, :, by_speed))
  end subroutine describe

  !> Interpolates the states at both ends.
  pure subroutine interpolate(n, smooth, ends, x0, v0, x1, v1, c)
    integer, intent(in) :: n
    logical, intent(in) :: smooth
    type(ends_t), intent(in) :: ends
    real(dp), intent(in) :: x0, v0                       ! state at the start, m
    real(dp), intent(in), dimension(batch_size) :: x1, v1          ! state at the end, m
    real(dp), intent(out) :: c(batch_size, 0:7)
    real(dp) :: a0, j0, a1, j1, value, slope, curvature(2), jerk
    integer :: l

    associate (k => ends%k, d => ends%d, f => ends%f)
      do l = 1, merge(0, n, smooth)
        a0 = f(l, 1) - k(l, 1)*x0 - d(l, 1)*v0
        a1 = f(l, 2) - k(l, 2)*x1(l) - d(l, 2)*v1(l)
        curvature = [a0, a1]
        if (turns_too_far(sqrt(max(k(l, 1), k(l, 2))))) curvature = cubic_curvature([x0, x1(l)], [v0, v1(l)])
        c(l, :5) = quintic([x0, v0, curvature(1)], [x1(l), v1(l), curvature(2)])
        c(l, 6:) = 0
      end do
      do l = 1, merge(n, 0, smooth)
        a0 = f(l, 1) - k(l, 1)*x0 - d(l, 1)*v0
        j0 = ends%f_slope(l, 1) - ends%k_slope(l, 1)*x0 - (k(l, 1) + ends%d_slope(l, 1))*v0 - d(l, 1)*a0
        a1 = f(l, 2) - k(l, 2)*x1(l) - d(l, 2)*v1(l)
        j1 = ends%f_slope(l, 2) - ends%k_slope(l, 2)*x1(l) - (k(l, 2) + ends%d_slope(l, 2))*v1(l) - d(l, 2)*a1
        value = x1(l) - (x0 + v0 + a0/2 + j0/6)
        slope = v1(l) - (v0 + a0 + j0/2)
        curvature(1) = a1 - (a0 + j0)
        jerk = j1 - j0
        c(l, 0) = x0
        c(l, 1) = v0
        c(l, 2) = a0/2
        c(l, 3) = j0/6
        c(l, 4) = 35*value - 15*slope + 2.5_dp*curvature(1) - jerk/6
        c(l, 5) = -84*value + 39*slope - 7*curvature(1) + jerk/2
        c(l, 6) = 70*value - 34*slope + 6.5_dp*curvature(1) - jerk/2
        c(l, 7) = -20*value + 10*slope - 2*curvature(1) + jerk/6
      end do
    end associate
  end subroutine interpolate

  !> Computes the polynomials of the motions from the states at the start.
  pure subroutine motions_from(n, dense, x, v, c)
    integer, intent(in) :: n                             !< number of speeds
    real(dp), intent(in) :: dense(batch_size, 0:7, 3)    !< polynomials of the step; (speed, power, by what)
    real(dp), intent(in), dimension(batch_size) :: x, v  !< m
    real(dp), intent(out) :: c(batch_size, 0:7)          !< coefficients in ascending powers, m; (speed, power)
    integer :: k, l

    do k = 0, 7
      do l = 1, n
        c(l, k) = x(l)*dense(l, k, by_place) + v(l)*dense(l, k, by_speed) + dense(l, k, by_force)
      end do
    end do
  end subroutine motions_from

  !> Computes the state of each motion at its own place.
  pure subroutine states_at(n, c, place, x, v)
    integer, intent(in) :: n                             !< number of speeds
    real(dp), intent(in) :: c(batch_size, 0:7)           !< coefficients in ascending powers, m; (speed, power)
    real(dp), intent(in) :: place(batch_size)
    real(dp), intent(out), dimension(batch_size) :: x, v           !< x and its derivative, m
    integer :: k, l

    x(:n) = c(:n, 7)
    v(:n) = 0
    if (n == batch_size) then
      do k = 6, 0, -1
        ! A loop over a constant number of lanes is one of vectors.
        do l = 1, batch_size
          v(l) = v(l)*place(l) + x(l)
          x(l) = x(l)*place(l) + c(l, k)
        end do
      end do
    else
      do k = 6, 0, -1
        do l = 1, n
          v(l) = v(l)*place(l) + x(l)
          x(l) = x(l)*place(l) + c(l, k)
        end do
      end do
    end if
  end subroutine states_at
end module gearsweep_motion_dense_step
