!> Torque of the mesh on pinion and gear, over the time after which a motion repeats.
!>
!> On gear i act F_i = sum_j F_j f_ij + D: the elastic loads F_j of the pairs, minus that of the coast sides, with the friction
!> factors f_ij = 1 -/+ mu rho_ij/r_bi (before and after the pitch point), and the damping force D; the torque is r_bi F_i. D
!> follows from the equation of motion, D/m_e = F_s/m_e - sum_j F_j (f_1j/m_1 + f_2j/m_2) - x", with 1/m_e = 1/m_1 + 1/m_2. With
!> the friction force R_i = sum_j F_j (f_ij - 1), this is F_i = F_s - m_e x" + R_i - m_e (R_1/m_1 + R_2/m_2).
!> Source: Karpat et al. 2012, Eqs. 1, 2 and 15 to 18, whose sign of friction in approach is wrong for a driving pinion; Dogan et
!> al. 2021, Eqs. 9 and 10.
module gearsweep_motion_mesh_torque
  use gearsweep_base, only: dp, quintic
  use gearsweep_motion_oscillator, only: oscillator_t
  use gearsweep_motion_spectrum, only: find_spectrum, spectrum_t
  use gearsweep_motion_trace, only: trace_t
  implicit none
  private
  public :: mesh_torque_t, find_torque

  !> Forces on the line of action; times the base radius of a gear, they are its torques.
  type :: mesh_torque_t
    real(dp), allocatable :: tau(:)              !< time in mesh periods, ascending, in pairs: both ends of a step; (row)
    real(dp), allocatable :: error(:)            !< dynamic transmission error, m; (row)
    real(dp), allocatable :: elastic(:)          !< loads of the pairs minus that of the coast sides, N; (row)
    real(dp), allocatable :: damping(:)          !< damping force, N; (row)
    real(dp), allocatable :: friction(:, :)      !< friction force on pinion and gear, N; (gear, row)
    type(spectrum_t) :: force(2)                 !< spectra of the total force on each gear, N
    real(dp) :: mean_friction(2) = 0             !< contribution of friction to the mean force, N
  end type mesh_torque_t

contains

  !> Computes the forces of a motion at the ends of its steps, and their spectra and means, with transmission error and loads as
  !> quintics between.
  pure subroutine find_torque(osc, duration, trace, count, torque)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration             !< duration of a mesh period, s
    type(trace_t), intent(in) :: trace(:)        !< mesh periods after which the motion repeats
    integer, intent(in) :: count                 !< number of harmonics of that time
    type(mesh_torque_t), intent(out) :: torque
    real(dp), allocatable :: left(:), width(:), force(:, :, :), friction(:, :, :)
    type(spectrum_t) :: share
    real(dp) :: load(0:2, 2), added(0:2, 2, 2), inertia(0:5), reduced
    integer :: i, k, n, gear

    n = 2*sum([(count_steps(trace(i)), i=1, size(trace))])
    allocate (torque%tau(n), torque%error(n), torque%elastic(n), torque%damping(n), torque%friction(2, n))
    allocate (left(n/2), width(n/2), force(0:5, n/2, 2), friction(0:5, n/2, 2))
    reduced = 1/sum(1/osc%mass)
    n = 0
    do i = 1, size(trace)
      do k = 1, trace(i)%rows, 2
        if (.not. lasts(trace(i), k)) cycle
        n = n + 1
        associate (rows => [2*n - 1, 2*n], phase => trace(i)%phase(k:k + 1))
          left(n) = (i - 1 + phase(1))/size(trace)
          width(n) = (phase(2) - phase(1))/size(trace)
          inertia = reduced*acceleration(trace(i)%x(:, k:k + 1), (phase(2) - phase(1))*duration, osc%highest_frequency)
          call add_up(osc, trace(i), k, load, added)
          torque%tau(rows) = i - 1 + phase
          torque%error(rows) = trace(i)%x(0, k:k + 1)
          torque%elastic(rows) = load(0, :)
          torque%friction(:, rows) = added(0, :, :)
          torque%damping(rows) = osc%load - load(0, :) - reduced*(added(0, 1, :)/osc%mass(1) + added(0, 2, :)/osc%mass(2)) &
                                 - [inertia(0), sum(inertia)]
          do gear = 1, 2
            friction(:, n, gear) = quintic(added(:, gear, 1), added(:, gear, 2))
          end do
          force(:, n, 1) = -inertia - reduced*(friction(:, n, 1)/osc%mass(1) + friction(:, n, 2)/osc%mass(2))
          force(0, n, 1) = force(0, n, 1) + osc%load
          force(:, n, 2) = force(:, n, 1) + friction(:, n, 2)
          force(:, n, 1) = force(:, n, 1) + friction(:, n, 1)
        end associate
      end do
    end do
    do gear = 1, 2
      call find_spectrum(left, width, force(:, :, gear), count, torque%force(gear))
      call find_spectrum(left, width, friction(:, :, gear), 0, share)
      torque%mean_friction(gear) = share%mean
    end do
  end subroutine find_torque

  !> Number of steps of a mesh period whose length is known.
  pure integer function count_steps(trace)
    type(trace_t), intent(in) :: trace
    integer :: k

    count_steps = count([(lasts(trace, k), k=1, trace%rows, 2)])
  end function count_steps

  !> True if the length of a step, a difference of phases, is far above their rounding. Between contacts that change at one place
  !> it is not.
  pure logical function lasts(trace, k)
    type(trace_t), intent(in) :: trace
    integer, intent(in) :: k                     ! first row of the step
    real(dp), parameter :: shortest = 1e-9_dp    ! mesh periods

    lasts = trace%phase(k + 1) - trace%phase(k) > shortest
  end function lasts

  !> Acceleration over a step (m/s^2) as a polynomial of the time from 0 to 1 in it: that of the quintic. In steps much shorter
  !> than the fastest natural motion rounding spoils it; there a straight line is as exact.
  pure function acceleration(x, time, frequency) result(c)
    real(dp), intent(in) :: x(0:, :)             ! transmission error with its derivatives over the step at both ends, m; (0:2, end)
    real(dp), intent(in) :: time                 ! duration of the step, s
    real(dp), intent(in) :: frequency            ! highest natural frequency, rad/s
    real(dp), parameter :: short = 1e-3_dp
    real(dp) :: c(0:5)

    c = 0
    if (frequency*time < short) then
      c(:1) = [x(2, 1), x(2, 2) - x(2, 1)]
    else
      associate (of => quintic(x(:, 1), x(:, 2)))
        c(:3) = [2*of(3), 6*of(4), 12*of(5), 20*of(6)]
      end associate
    end if
    c = c/time**2
  end function acceleration

  !> Computes the loads at both ends of a step and the friction force on each gear (N), with first and second derivative over it.
  pure subroutine add_up(osc, trace, k, load, added)
    type(oscillator_t), intent(in) :: osc
    type(trace_t), intent(in) :: trace
    integer, intent(in) :: k                     ! first row of the step
    real(dp), intent(out) :: load(0:2, 2)        ! (derivative, end)
    real(dp), intent(out) :: added(0:2, 2, 2)    ! (derivative, gear, end)
    real(dp) :: s(2), f(0:2), arm(0:1), sense
    integer :: end, j, gear

    load = sum(trace%load(:, :osc%pairs, k:k + 1), 2)
    load = load - sum(trace%load(:, osc%pairs + 1:osc%contacts, k:k + 1), 2)
    added = 0
    if (.not. osc%friction > 0) return
    do j = 1, min(trace%pairs(k), osc%pairs)
      s = trace%phase(k:k + 1) + (j - 1 + trace%offset(k:k + 1))
      ! Steps end at the pitch point.
      sense = merge(osc%friction, -osc%friction, sum(s)/2 > osc%mesh%pitch_point)
      do gear = 1, 2
        do end = 1, 2
          arm(0) = sense*osc%mesh%curvature_ratio(gear, s(end))
          arm(1) = sense*(osc%mesh%curvature_ratio(gear, s(2)) - osc%mesh%curvature_ratio(gear, s(1)))
          f = trace%load(:, j, k + end - 1)
          added(:, gear, end) = added(:, gear, end) + [f(0)*arm(0), f(1)*arm(0) + f(0)*arm(1), f(2)*arm(0) + 2*f(1)*arm(1)]
        end do
      end do
    end do
  end subroutine add_up
end module gearsweep_motion_mesh_torque
