!> Equation of motion of the gear pair along the line of action.
!>
!> x = x1 - x2 is the dynamic transmission error; with the pairs in contact C and f = 1 -/+ mu rho/r_b,
!>   x" + 2 zeta omega x' + omega^2 x = (1/m1 + 1/m2) F_s + sum_C k_j e_j,
!>   k_j = K_j (f_1j/m1 + f_2j/m2),  omega^2 = sum_C k_j.
!> Pairs that share a compliance have the effective stiffness and touching deflection of gearsweep_motion_contact_law for K_j and
!> e_j.
!> Where the coast sides are in contact (x < -backlash), all pairs between A and E push back with their stiffness, without profile
!> error and friction. Where teeth have position errors, the coast flanks next to each pair are a contact of their own:
!> F_j = K_j (-x - b - d_j), with their additional gap d_j of gearsweep_mesh_deviations.
!> Source: Dogan et al. 2021, Eqs. 9 to 20, misprints corrected.
module gearsweep_motion_oscillator
  use gearsweep_base, only: code_input, dp, error_t, fail, pi, str
  use gearsweep_elastic, only: flattening_t
  use gearsweep_mesh, only: balance_t, contact_intervals, deviations_t, interval_t, intervals_of_period, mesh_t, &
    repeat_intervals, set_period
  use gearsweep_motion_contact_law, only: find_closed, find_law_values, springs_at, springs_t
  implicit none
  private
  public :: oscillator_t, make_oscillator, split_by_load, mesh_period, frequency_ratio, resolving_steps
  public :: mobility, damping, acceleration, touches_coast

  !> Oscillator. The caller sets the first seven components; `make_oscillator` checks them and computes the others, which hold for
  !> all speeds.
  type :: oscillator_t
    type(mesh_t) :: mesh
    real(dp) :: mass(2) = 0            !< effective masses of pinion and gear on the line of action, kg
    real(dp) :: load = 0               !< static load F_s, N
    real(dp) :: damping_ratio = 0      !< zeta
    real(dp) :: friction = 0           !< mu
    logical :: has_backlash = .false.  !< the coast sides can come into contact
    real(dp) :: backlash = 0           !< m, along the line of action
    integer :: pairs = 0               !< largest number of pairs that may be in contact
    !> Contacts of coast sides: 0 without backlash, one for all together or, where teeth have position errors, one next to each
    !> pair.
    integer :: coasts = 0
    integer :: contacts = 0            !< number of pairs and coast contacts
    real(dp) :: coast_below = 0        !< the coast sides are apart above this deflection, m
    real(dp) :: natural_frequency = 0  !< natural frequency at mean stiffness, without friction and relief, rad/s
    real(dp) :: highest_frequency = 0  !< upper bound of omega over the period, rad/s
    real(dp) :: static_deflection = 0  !< load over mean stiffness, m: the unit of residuals
    real(dp) :: mean_deflection = 0    !< deflection whose mean load over the period is the static one, m
    real(dp) :: largest_error = 0      !< upper bound of the profile error, m
    !> Smooth intervals of a mesh period: no coefficient has a break within. Where teeth deviate, with the deviations of the first
    !> mesh period, or of that of `set_period`.
    type(interval_t), allocatable :: intervals(:)
    logical :: by_load = .false.       !< intervals also end where pairs begin and cease to carry the static load
    !> Lowest and highest omega of each interval of a mesh period, rad/s; (2, interval)
    real(dp), allocatable :: frequency(:, :)
  end type oscillator_t

contains

  !> Checks an oscillator and completes it.
  subroutine make_oscillator(osc, error)
    type(oscillator_t), intent(inout) :: osc               !< in: its first seven components; out: all
    type(error_t), allocatable, intent(out) :: error       !< a value that is not allowed, with its name
    real(dp) :: stiffest, mean_stiffness

    stiffest = osc%mesh%stiffness%maximum()
    call demand(osc%mesh%contact_ratio > 1, 'contact ratio', osc%mesh%contact_ratio, 'must be above 1')
    call demand(osc%mesh%disc%shared >= 0, 'shared compliance', osc%mesh%disc%shared, 'must be at least 0')
    call demand(osc%mesh%disc%most_shared()*stiffest < 1, 'shared compliance', osc%mesh%disc%shared, &
                'must be below the compliance of a pair, of which it is a part')
    call demand(all(osc%mass > 0), 'effective mass', minval(osc%mass), 'must be above 0')
    call demand(osc%load > 0, 'load', osc%load, 'must be above 0')
    call demand(osc%damping_ratio >= 0, 'damping_ratio', osc%damping_ratio, 'must be at least 0')
    call demand(osc%friction >= 0 .and. osc%friction < 1, 'friction', osc%friction, 'must be at least 0 and below 1')
    call demand(osc%backlash >= 0, 'backlash', osc%backlash, 'must be at least 0')
    call demand(osc%mesh%teeth(1) > 0, 'teeth', real(osc%mesh%teeth(1), dp), 'the pinion''s teeth give the mesh period')
    if (osc%friction > 0) call demand(all(osc%mesh%teeth > 0) .and. osc%mesh%tan_angle > 0, 'friction', &
      osc%friction, 'needs the teeth of both gears and the pressure angle')
    if (allocated(error)) return
    osc%by_load = osc%mesh%reaches_beyond()
    if (osc%by_load) then
      osc%intervals = rest_intervals(osc)
    else
      osc%intervals = intervals_of_period(osc%mesh, osc%friction > 0)
    end if
    osc%pairs = maxval(osc%intervals%pairs)
    osc%coasts = merge(1, 0, osc%has_backlash)
    if (osc%has_backlash .and. osc%mesh%deviations%moves_coast()) osc%coasts = osc%pairs
    osc%contacts = osc%pairs + osc%coasts
    osc%coast_below = osc%mesh%deviations%largest_of_coast() - osc%backlash
    mean_stiffness = osc%mesh%mean_stiffness()
    if (osc%mesh%spacing > 0) mean_stiffness = osc%mesh%stiffness_of(osc%intervals)
    osc%natural_frequency = sqrt(mean_stiffness*sum(1/osc%mass))
    osc%highest_frequency = sqrt(osc%pairs*stiffest*sum(1/osc%mass)*(1 + osc%friction))
    osc%static_deflection = osc%load/mean_stiffness
    osc%largest_error = osc%mesh%largest_error()
    osc%mean_deflection = mean_deflection(osc)
    osc%frequency = interval_frequencies(osc)

  contains

    subroutine demand(met, what, value, allowed)
      logical, intent(in) :: met
      character(*), intent(in) :: what, allowed
      real(dp), intent(in) :: value

      if (.not. met) call fail(error, code_input, what//' = '//str(value)//': '//allowed)
    end subroutine demand
  end subroutine make_oscillator

  !> Splits the smooth intervals also where pairs begin and cease to carry the static load, which the motion follows far below
  !> resonance. The reference contact of the linear motion is then that of the pairs that carry.
  pure subroutine split_by_load(osc)
    type(oscillator_t), intent(inout) :: osc

    if (osc%by_load) return
    osc%by_load = .true.
    osc%intervals = rest_intervals(osc)
    osc%frequency = interval_frequencies(osc)
  end subroutine split_by_load

  !> Finds the smooth intervals by the static load of gears without deviations, so that all mesh periods share them. The motion's
  !> stiffness is that at the nominal load, at any load on a pair.
  pure function rest_intervals(osc) result(intervals)
    type(oscillator_t), intent(in) :: osc
    type(interval_t), allocatable :: intervals(:)
    type(mesh_t) :: mesh

    mesh = osc%mesh
    mesh%flattening = flattening_t()
    mesh%deviations = deviations_t()
    intervals = contact_intervals(mesh, balance_t(osc%load, osc%friction, osc%mass))
    call set_period(osc%mesh, 0, intervals)
  end function rest_intervals

  !> Deflection (m) at which the pairs' mean load over the period, with relief, is the static one: at high speed the motion tends
  !> to it. The load is convex in the deflection, so that Newton's method from above converges monotonically.
  pure real(dp) function mean_deflection(osc) result(x)
    type(oscillator_t), intent(in) :: osc
    integer, parameter :: most = 100
    type(interval_t), allocatable :: intervals(:)
    type(springs_t), allocatable :: springs(:)
    real(dp), dimension(1, osc%pairs) :: effective, touching
    real(dp) :: load, slope
    integer :: contact_set, i, k, n, samples

    ! Samples of an interval: over the many mesh periods of a turn their errors cancel.
    samples = max(2, 32/osc%mesh%deviations%periods)
    intervals = repeat_intervals(osc%mesh, osc%intervals)
    allocate (springs(size(intervals)))
    do i = 1, size(intervals)
      associate (interval => intervals(i))
        call springs_at(osc%mesh, interval, interval%first + (interval%last - interval%first)* &
                        [(k - 0.5_dp, k=1, samples)]/samples, springs(i))
      end associate
    end do
    x = 2*osc%static_deflection + osc%largest_error
    do n = 1, most
      load = 0
      slope = 0
      do i = 1, size(intervals)
        associate (p => intervals(i)%pairs, &
                   weight => (intervals(i)%last - intervals(i)%first)/(samples*osc%mesh%deviations%periods))
          do k = 1, samples
            call find_closed(springs(i)%kind, springs(i)%stiffness(k:k, :), springs(i)%profile_error(k:k, :), &
                             springs(i)%shared(k:k, :), x, contact_set, effective(:, :p), touching(:, :p))
            load = load + weight*sum(effective(1, :p)*(x - touching(1, :p)))
            slope = slope + weight*sum(effective(1, :p))
          end do
        end associate
      end do
      if (load - osc%load <= 1e-12_dp*osc%load) exit
      x = x - (load - osc%load)/slope
    end do
  end function mean_deflection

  !> Lowest and highest omega (rad/s) of each smooth interval of a mesh period in the reference contact, (2, interval).
  pure function interval_frequencies(osc) result(frequency)
    type(oscillator_t), intent(in) :: osc
    integer, parameter :: samples = 17
    real(dp) :: frequency(2, size(osc%intervals))
    type(springs_t) :: springs
    real(dp), dimension(samples) :: omega_squared, phase
    real(dp), dimension(samples, osc%pairs) :: effective, touching
    integer :: carrying, i, j, k

    do i = 1, size(frequency, 2)
      associate (interval => osc%intervals(i), p => osc%intervals(i)%pairs)
        carrying = sum([(merge(ibset(0, j - 1), 0, interval%carries(j)), j=1, p)])
        phase = interval%first + (interval%last - interval%first)*[(k, k=0, samples - 1)]/(samples - 1)
        call springs_at(osc%mesh, interval, phase, springs)
        call find_law_values(carrying, springs%kind, springs%stiffness, springs%profile_error, springs%shared, &
                             effective(:, :p), touching(:, :p))
        omega_squared = 0
        do j = 1, p
          omega_squared = omega_squared + effective(:, j)*mobility(osc, interval%place(phase, j), interval%recess(j))
        end do
      end associate
      frequency(:, i) = sqrt([minval(omega_squared), maxval(omega_squared)])
    end do
  end function interval_frequencies

  !> Duration of one mesh period (s).
  elemental real(dp) function mesh_period(teeth, rpm)
    integer, intent(in) :: teeth       !< number of teeth of the pinion
    real(dp), intent(in) :: rpm        !< speed of the pinion, 1/min

    mesh_period = 60/(teeth*rpm)
  end function mesh_period

  !> Mesh frequency over the natural frequency of the mean mesh stiffness.
  elemental real(dp) function frequency_ratio(osc, rpm)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm        !< speed of the pinion, 1/min

    frequency_ratio = 2*pi/mesh_period(osc%mesh%teeth(1), rpm)/osc%natural_frequency
  end function frequency_ratio

  !> Number of steps of a period that resolve the fastest natural motion, or its decay: 2.6 rad a step.
  pure real(dp) function resolving_steps(osc, duration)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration             !< duration of the mesh period, s
    real(dp) :: fastest

    associate (zeta => osc%damping_ratio)
      fastest = osc%highest_frequency
      if (zeta > 1) fastest = fastest*(zeta + sqrt(zeta**2 - 1))
    end associate
    resolving_steps = fastest*duration/2.6_dp
  end function resolving_steps

  !> Acceleration of x per load of a pair (1/kg).
  elemental real(dp) function mobility(osc, s, recess)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: s          !< path coordinate of the pair from A, base pitches
    logical, intent(in) :: recess      !< the pair has passed the pitch point

    mobility = osc%mesh%mobility(osc%mass, osc%friction, s, recess)
  end function mobility

  !> True if coast sides are in contact.
  elemental logical function touches_coast(osc, contact_set)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: contact_set           !< bit j - 1: contact j is closed

    touches_coast = osc%coasts > 0
    if (touches_coast) touches_coast = shiftr(contact_set, osc%pairs) > 0
  end function touches_coast

  !> Coefficient 2 zeta omega of the velocity in the equation of motion, in the unit of `omega`. It is linear in omega, so that
  !> the value at 1 serves as a factor where many are needed.
  elemental real(dp) function damping(osc, omega)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: omega      !< rad/s, or rad over the period

    damping = 2*osc%damping_ratio*omega
  end function damping

  !> Second derivative of x over the mesh phase (m), from the equation of motion.
  pure real(dp) function acceleration(osc, omega_squared, forcing, duration, x, y)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: omega_squared  !< sum of k_j over the contacts, 1/s^2
    real(dp), intent(in) :: forcing        !< sum of k_j e_j over the contacts, m/s^2
    real(dp), intent(in) :: duration       !< duration of the mesh period, s
    real(dp), intent(in) :: x, y           !< dynamic transmission error and its derivative over the phase, m

    acceleration = duration**2*(osc%load*(1/osc%mass(1) + 1/osc%mass(2)) + forcing - omega_squared*x) &
                   - damping(osc, duration)*sqrt(omega_squared)*y
  end function acceleration
end module gearsweep_motion_oscillator
