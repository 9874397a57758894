!> The Poincare section of the motion: its state once a mesh period, as a new pair enters. That is one point where the
!> motion repeats with the mesh, n points where it repeats after n periods, and a cloud where it never does. And the
!> Lyapunov exponent: how fast disturbances grow.
module gearsweep_poincare
  use gearsweep_coefficients, only: resolution_t
  use gearsweep_contact_set, only: period_t
  use gearsweep_kinds, only: dp
  use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
  use, intrinsic :: iso_c_binding, only: c_ptr
  use gearsweep_memory, only: has_memory
  use gearsweep_oscillator, only: mesh_period, oscillator_t
  use gearsweep_period, only: run_period
  use gearsweep_period_map, only: discretise, period_map_t, set_durations
  use gearsweep_periodic_orbit, only: is_bounded
  use gearsweep_status, only: status_aperiodic, status_chaotic, status_chatter, status_ok, status_stopped, &
    status_subharmonic, status_transient, status_unbounded, status_unresolved
  use gearsweep_stop, only: wants_stop
  use gearsweep_transient, only: sure_growth
  implicit none
  private
  public :: section_points_t, sample_section

  !> Samples at each speed; NaN where the motion was not followed.
  type :: section_points_t
    real(dp), allocatable :: x(:, :)             !< dynamic transmission error, m; (sample, speed)
    real(dp), allocatable :: v(:, :)             !< its rate, m/s; (sample, speed)
    !> Largest Lyapunov exponent, per mesh period: the mean logarithm by which a disturbance grows. Below 0 where the
    !> motion repeats, above 0 where it is chaotic; (speed)
    real(dp), allocatable :: exponent(:)
    !> ok, subharmonic, chaotic; transient, without damping aperiodic: neither repeats nor is surely chaotic, as far as it
    !> was followed; unbounded, unresolved, chatter. (speed)
    integer, allocatable :: status(:)
    integer, allocatable :: periods(:)           !< mesh periods until the motion repeats; 0: it does not; (speed)
    logical :: lacks = .false.                   !< the memory does not hold it: nothing was followed
  end type section_points_t

  !> A step of this angle (rad) of the natural motion makes errors of some 1e-9.
  real(dp), parameter :: angle = 0.2_dp
  integer, parameter :: fewest_steps = 24, most_steps = 2**16

contains

  !> Follows the motion at each speed: first the transient, then the samples. At each speed it goes on from where it was
  !> at the one before.
  pure subroutine sample_section(osc, rpm, transient, samples, section, start, stop)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm(:)               !< speeds of the pinion, 1/min
    integer, intent(in) :: transient             !< mesh periods that are not sampled, at each speed
    integer, intent(in) :: samples               !< mesh periods sampled at each speed
    type(section_points_t), intent(out) :: section
    real(dp), intent(in), optional :: start(2)   !< x (m) and its rate (m/s); without it, rest at the mean deflection
    type(c_ptr), intent(in), optional :: stop    !< an integer: where it is not 0, the rest has the status `stopped`
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

  !> The samples at speed i; `state` (m, m/s) goes from its begin to its end, unless the steps are too many (unresolved),
  !> contact changes without end (chatter), or the motion passes all bounds.
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

  !> The status at speed i of a motion that was followed to the end, and after how many mesh periods it repeats, by the
  !> later half of the samples.
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
end module gearsweep_poincare
