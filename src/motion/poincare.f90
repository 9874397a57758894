!> The Poincare section of the motion: its state once a mesh period, as a new pair enters. That is one point where the motion
!> repeats with the mesh, n points where it repeats after n periods, and a cloud where it never does. And the Lyapunov exponent,
!> the rate at which disturbances grow.
module gearsweep_motion_poincare
  use gearsweep_base, only: dp
  use gearsweep_motion_resolution, only: resolution_t
  use gearsweep_motion_contact_set, only: period_t
  use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
  use, intrinsic :: iso_c_binding, only: c_ptr
  use gearsweep_base, only: has_memory, wants_stop
  use gearsweep_motion_oscillator, only: mesh_period, oscillator_t
  use gearsweep_motion_period, only: run_period
  use gearsweep_motion_period_map, only: discretise, period_map_t, set_durations
  use gearsweep_motion_periodic_orbit, only: is_bounded
  use gearsweep_motion_steady_motion, only: status_aperiodic, status_chaotic, status_chatter, status_ok, status_stopped, &
    status_subharmonic, status_transient, status_unbounded, status_unresolved
  use gearsweep_motion_search, only: sure_growth
  implicit none
  private
  public :: section_points_t, sample_section

  !> Samples at each speed; NaN where the motion was not integrated.
  type :: section_points_t
    real(dp), allocatable :: x(:, :)             !< dynamic transmission error, m; (sample, speed)
    real(dp), allocatable :: v(:, :)             !< rate of the transmission error, m/s; (sample, speed)
    !> Largest Lyapunov exponent, per mesh period: the mean logarithmic growth of a disturbance. Below 0 where the motion repeats,
    !> above 0 where it is chaotic; (speed)
    real(dp), allocatable :: exponent(:)
    !> ok, subharmonic, chaotic; transient, without damping aperiodic: neither periodic nor certainly chaotic in the time
    !> integrated; unbounded, unresolved, chatter. (speed)
    integer, allocatable :: status(:)
    integer, allocatable :: periods(:)           !< mesh periods until the motion repeats; 0: it does not; (speed)
    logical :: lacks = .false.                   !< memory is too small: nothing was integrated
  end type section_points_t

  !> Step angle of the natural motion (rad); its errors are about 1e-9.
  real(dp), parameter :: angle = 0.2_dp
  integer, parameter :: fewest_steps = 24, most_steps = 2**16

contains

  !> Integrates the motion at each speed: first the transient, then the samples. Each speed continues from the last state of the
  !> one before.
  pure subroutine sample_section(osc, rpm, transient, samples, section, start, stop)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm(:)               !< speeds of the pinion, 1/min
    integer, intent(in) :: transient             !< mesh periods that are not sampled, at each speed
    integer, intent(in) :: samples               !< mesh periods sampled at each speed
    type(section_points_t), intent(out) :: section
    real(dp), intent(in), optional :: start(2)   !< x (m) and its rate (m/s); if absent, rest at the mean deflection
    type(c_ptr), intent(in), optional :: stop    !< an integer: if not 0, the remaining speeds have the status `stopped`
    real(dp) :: state(2)
    logical :: fits
    integer :: i

    call has_memory(size(rpm)*(24 + 17.0_dp*samples), fits)
    section%lacks = .not. fits
    if (section%lacks) return
    allocate (section%x(samples, size(rpm)), section%v(samples, size(rpm)), section%exponent(size(rpm)), &
              source=ieee_value(1.0_dp, ieee_quiet_nan))
    allocate (section%status(size(rpm)), section%periods(size(rpm)))
    state = [osc%mean_deflection, 0.0_dp]
    if (present(start)) state = start
    section%periods = 0
    section%status = status_stopped
    do i = 1, size(rpm)
      if (present(stop)) then
        if (wants_stop(stop)) return
      end if
      call follow(osc, rpm(i), transient, i, state, section, stop)
      if (section%lacks .or. section%status(i) == status_stopped) return
      call name_motion(osc, mesh_period(osc%mesh%teeth(1), rpm(i)), i, section)
    end do
  end subroutine sample_section

  !> Computes the samples at speed i. `state` (m, m/s) changes from the initial to the final state, unless the steps are too many
  !> (unresolved), contact changes without end (chatter), or the motion passes all bounds.
  pure subroutine follow(osc, rpm, transient, i, state, section, stop)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm
    integer, intent(in) :: transient, i
    real(dp), intent(inout) :: state(2)
    type(section_points_t), intent(inout) :: section
    type(c_ptr), intent(in), optional :: stop
    type(period_map_t) :: map
    type(period_t) :: run
    real(dp) :: duration, steps, unit, from(2), disturbance(2), growth, derivative(2, 2)
    integer :: k

    duration = mesh_period(osc%mesh%teeth(1), rpm)
    steps = max(osc%natural_frequency, osc%highest_frequency*max(0.5_dp, osc%damping_ratio))*duration/angle
    section%status(i) = status_unresolved
    if (steps > most_steps) return
    section%status(i) = status_chatter
    call discretise(osc, resolution_t(max(steps, real(fewest_steps, dp))), map)
    section%lacks = map%table%steps == 0
    if (section%lacks) return
    call set_durations(map, [duration])
    unit = max(1.0_dp, osc%natural_frequency*duration)
    from = state*[1.0_dp, duration]
    disturbance = 1
    growth = 0
    do k = 1 - transient, size(section%x, 1)
      if (present(stop)) then
        if (wants_stop(stop)) section%status(i) = status_stopped
        if (section%status(i) == status_stopped) return
      end if
      call run_period(map, from, run)
      if (run%failed) return
      from = run%state
      if (.not. is_bounded(osc, duration, from)) then
        section%status(i) = status_unbounded
        section%x(:, i) = ieee_value(1.0_dp, ieee_quiet_nan)
        section%v(:, i) = section%x(:, i)
        return
      end if
      derivative = run%monodromy
      if (run%shrunk < 0) derivative = run%scaled
      disturbance = matmul(derivative, disturbance*[1.0_dp, unit])/[1.0_dp, unit]
      if (k > 0) then
        section%x(k, i) = from(1)
        section%v(k, i) = from(2)/duration
        growth = growth + log(norm2(disturbance)) + run%shrunk
      end if
      disturbance = disturbance/norm2(disturbance)
    end do
    state = from/[1.0_dp, duration]
    section%exponent(i) = growth/size(section%x, 1)
    section%status(i) = merge(status_transient, status_aperiodic, osc%damping_ratio > 0)
  end subroutine follow

  !> Finds the status of the motion at speed i after its last sample, and the mesh periods after which it repeats, from the second
  !> half of the samples.
  pure subroutine name_motion(osc, duration, i, section)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration
    integer, intent(in) :: i
    type(section_points_t), intent(inout) :: section
    real(dp), parameter :: same = 1e-4_dp        ! static deflections
    real(dp) :: unit
    integer :: n, last

    associate (x => section%x(:, i), v => section%v(:, i))
      section%periods(i) = 0
      if (section%status(i) /= status_transient .and. section%status(i) /= status_aperiodic) return
      unit = duration/max(1.0_dp, osc%natural_frequency*duration)
      last = size(x)
      do n = 1, last/4
        if (any(abs(x(last/2 + n:) - x(last/2:last - n)) > same*osc%static_deflection)) cycle
        if (any(unit*abs(v(last/2 + n:) - v(last/2:last - n)) > same*osc%static_deflection)) cycle
        section%periods(i) = n
        section%status(i) = merge(status_ok, status_subharmonic, n == 1)
        return
      end do
      if (section%exponent(i)*last > sure_growth) section%status(i) = status_chaotic
    end associate
  end subroutine name_motion
end module gearsweep_motion_poincare
