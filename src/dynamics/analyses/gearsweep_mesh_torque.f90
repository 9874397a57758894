!> The torque that the mesh takes from the pinion and gives to the gear, over the time after which a motion repeats.
!>
!> On member i act F_i = sum_j F_j f_ij + D: the elastic loads F_j of the pairs, less that of the coast sides, with the friction
!> factors f_ij = 1 -/+ mu rho_ij/r_bi (before and behind the pitch point), and what damping carries, D; the torque is r_bi F_i.
!> D follows from the equation of motion, D/m_e = F_s/m_e - sum_j F_j (f_1j/m_1 + f_2j/m_2) - x", with 1/m_e = 1/m_1 + 1/m_2.
!> Source: Karpat et al. 2012, Eqs. 1, 2 and 15 to 18, whose sign of friction in approach is wrong for a driving pinion; Dogan et
!> al. 2021, Eqs. 9 and 10.
module gearsweep_mesh_torque
  use gearsweep_kinds, only: dp
  use gearsweep_oscillator, only: oscillator_t
  use gearsweep_quintic, only: quintic
  use gearsweep_spectrum, only: find_spectrum, spectrum_t
  use gearsweep_trace, only: trace_t
  implicit none
  private
  public :: mesh_torque_t, find_torque

  !> Forces on the line of action; times the base radius of a member, they are its torques.
  type :: mesh_torque_t
    real(dp), allocatable :: tau(:)              !< time in mesh periods, ascending, in twos: both ends of a step; (row)
    real(dp), allocatable :: error(:)            !< dynamic transmission error, m; (row)
    real(dp), allocatable :: elastic(:)          !< loads of the pairs less that of the coast sides, N; (row)
    real(dp), allocatable :: damping(:)          !< what damping carries, N; (row)
    real(dp), allocatable :: friction(:, :)      !< what friction adds on pinion and gear, N; (member, row)
    real(dp) :: mean(2) = 0                      !< mean of the whole force on each member, N
    real(dp) :: mean_friction(2) = 0             !< of which friction's, N
  end type mesh_torque_t

contains

  !> The forces of a motion at the ends of its steps, and their means, which take the loads as quintics between.
  pure subroutine find_torque(osc, duration, trace, torque)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration             !< of a mesh period, s
    type(trace_t), intent(in) :: trace(:)        !< the mesh periods after which the motion repeats
    type(mesh_torque_t), intent(out) :: torque
    real(dp), allocatable :: left(:), width(:), elastic(:, :), friction(:, :, :)
    real(dp) :: x(0:2, 2), load(0:2, 2), share(0:2, 2, 2), reduced
    integer :: i, k, n, member

    n = sum(trace%rows)
    allocate (torque%tau(n), torque%error(n), torque%elastic(n), torque%damping(n), torque%friction(2, n))
    allocate (left(n/2), width(n/2), elastic(0:5, n/2), friction(0:5, n/2, 2))
    reduced = 1/sum(1/osc%mass)
    n = 0
    do i = 1, size(trace)
      do k = 1, trace(i)%rows, 2
        n = n + 1
        associate (rows => [2*n - 1, 2*n], phase => trace(i)%phase(k:k + 1))
          x = trace(i)%x(:, k:k + 1)
          left(n) = (i - 1 + phase(1))/size(trace)
          width(n) = (phase(2) - phase(1))/size(trace)
          call add_up(osc, trace(i), k, load, share)
          elastic(:, n) = quintic(load(:, 1), load(:, 2))
          torque%tau(rows) = i - 1 + phase
          torque%error(rows) = x(0, :)
          torque%elastic(rows) = load(0, :)
          torque%friction(:, rows) = share(0, :, :)
          torque%damping(rows) = osc%load - load(0, :) - reduced*(share(0, 1, :)/osc%mass(1) + share(0, 2, :)/osc%mass(2) &
                                                                  + x(2, :)/((phase(2) - phase(1))*duration)**2)
          do member = 1, 2
            friction(:, n, member) = quintic(share(:, member, 1), share(:, member, 2))
          end do
        end associate
      end do
    end do
    call find_means(osc, left, width, elastic, friction, torque)
  end subroutine find_torque

  !> Loads at both ends of a step and what friction adds to them on each member (N), with first and second derivative over it.
  pure subroutine add_up(osc, trace, k, load, share)
    type(oscillator_t), intent(in) :: osc
    type(trace_t), intent(in) :: trace
    integer, intent(in) :: k                     ! first row of the step
    real(dp), intent(out) :: load(0:2, 2)        ! (derivative, end)
    real(dp), intent(out) :: share(0:2, 2, 2)    ! (derivative, member, end)
    real(dp) :: s(2), f(0:2), arm(0:1), sense
    integer :: end, j, member

    load = sum(trace%load(:, :osc%pairs, k:k + 1), 2)
    if (osc%has_backlash) load = load - trace%load(:, osc%contacts, k:k + 1)
    share = 0
    if (.not. osc%friction > 0) return
    do j = 1, min(trace%pairs(k), osc%pairs)
      s = trace%phase(k:k + 1) + (j - 1 + trace%offset(k:k + 1))
      ! A step ends at the pitch point.
      sense = merge(osc%friction, -osc%friction, sum(s)/2 > osc%mesh%pitch_point)
      do member = 1, 2
        do end = 1, 2
          arm(0) = sense*osc%mesh%curvature_ratio(member, s(end))
          arm(1) = sense*(osc%mesh%curvature_ratio(member, s(2)) - osc%mesh%curvature_ratio(member, s(1)))
          f = trace%load(:, j, k + end - 1)
          share(:, member, end) = share(:, member, end) + [f(0)*arm(0), f(1)*arm(0) + f(0)*arm(1), f(2)*arm(0) + 2*f(1)*arm(1)]
        end do
      end do
    end do
  end subroutine add_up

  !> The acceleration of a motion that repeats is nothing in the mean, so that the mean of D follows from those of the loads.
  pure subroutine find_means(osc, left, width, elastic, friction, torque)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: left(:), width(:), elastic(0:, :), friction(0:, :, :)
    type(mesh_torque_t), intent(inout) :: torque
    type(spectrum_t) :: spectrum
    integer :: member

    do member = 1, 2
      call find_spectrum(left, width, friction(:, :, member), 0, spectrum)
      torque%mean_friction(member) = spectrum%mean
    end do
    call find_spectrum(left, width, elastic, 0, spectrum)
    associate (damping => osc%load - spectrum%mean - sum(torque%mean_friction/osc%mass)/sum(1/osc%mass))
      torque%mean = spectrum%mean + torque%mean_friction + damping
    end associate
  end subroutine find_means
end module gearsweep_mesh_torque
