!> Equation of motion of the gear pair along the line of action, and its
!> coefficients over one mesh period, which do not depend on speed.
!>
!> x = x1 - x2; with the pairs in contact C and f = 1 -/+ mu rho/r_b,
!>   x" + 2 zeta w x' + w^2 x = (1/m1 + 1/m2) F_s + sum_C k_j e_j,
!>   k_j = K_j (f_1j/m1 + f_2j/m2),  w^2 = sum_C k_j.
!> Where the coast sides touch (x < -backlash), all pairs between A and E push
!> back with their stiffness, without profile error and friction.
!> Source: Dogan et al. 2021, Eqs. 9 to 20, misprints corrected.
module gearsweep_motion
  use gearsweep_kinds, only: dp
  use gearsweep_error, only: error_t, fail, code_input
  use gearsweep_mesh, only: mesh_t, zone_t, make_zones
  use gearsweep_text, only: str
  implicit none
  private
  public :: oscillator_t, make_oscillator, table_t, tabulate, evaluate, pair_slopes

  !> What is stated, checked by `make_oscillator`, and what follows once for all speeds.
  type :: oscillator_t
    type(mesh_t) :: mesh
    real(dp) :: mass(2) = 0            !< effective masses on the line of action, kg
    real(dp) :: load = 0               !< static load F_s, N
    real(dp) :: damping_ratio = 0      !< zeta
    real(dp) :: friction = 0           !< mu
    logical :: has_backlash = .false.  !< the coast sides can touch
    real(dp) :: backlash = 0           !< m, along the line of action
    integer :: pairs = 0               !< between A and E at most
    integer :: members = 0             !< these, and one for the coast side
    real(dp) :: natural_frequency = 0  !< at mean stiffness, without friction and relief, rad/s
    real(dp) :: highest_frequency = 0  !< bound of w over the period, rad/s
    real(dp) :: static_scale = 0       !< deflection at mean stiffness, m: the unit of residuals
    real(dp) :: rest = 0               !< deflection whose mean load over the period is the static one, m
  end type oscillator_t

  !> Coefficients at the left end, the middle and the right end of each step,
  !> one-sided at the breaks.
  type :: table_t
    integer :: steps = 0
    integer :: members = 0             !< pairs at most, and the coast side
    integer :: parts = 1               !< steps between two changes of contact within a step
    type(zone_t), allocatable :: zones(:)
    integer, allocatable :: zone(:)    !< of each step
    integer, allocatable :: pairs(:)   !< of each step
    real(dp), allocatable :: left(:), width(:)  !< phases
    real(dp), allocatable :: rate(:, :, :)      !< (member, place, step)
    real(dp), allocatable :: error(:, :, :)
    real(dp), allocatable :: stiffness(:, :, :)
    real(dp), allocatable :: error_slope(:, :, :)      !< (pair, end, step), per phase
    real(dp), allocatable :: stiffness_slope(:, :, :)
    !> Sums over all pairs: w^2, sum of k e, w.
    real(dp), allocatable :: square(:, :), push(:, :), omega(:, :)
  end type table_t

contains

  !> Checks and completes an oscillator whose mesh, masses, load, damping,
  !> friction and backlash are set.
  subroutine make_oscillator(osc, error)
    type(oscillator_t), intent(inout) :: osc
    type(error_t), allocatable, intent(out) :: error
    type(zone_t), allocatable :: zones(:)

    call demand(osc%mesh%contact_ratio > 1, 'contact ratio', osc%mesh%contact_ratio, 'must be above 1')
    call demand(all(osc%mass > 0), 'effective mass', minval(osc%mass), 'must be above 0')
    call demand(osc%load > 0, 'load', osc%load, 'must be above 0')
    call demand(osc%damping_ratio >= 0, 'damping_ratio', osc%damping_ratio, 'must be at least 0')
    call demand(osc%friction >= 0 .and. osc%friction < 1, 'friction', osc%friction, 'must be at least 0 and below 1')
    call demand(osc%backlash >= 0, 'backlash', osc%backlash, 'must be at least 0')
    call demand(osc%mesh%teeth(1) > 0, 'teeth', real(osc%mesh%teeth(1), dp), 'the pinion''s teeth give the mesh period')
    if (osc%friction > 0) call demand(all(osc%mesh%teeth > 0) .and. osc%mesh%tan_angle > 0, 'friction', &
      osc%friction, 'needs the teeth of both members and the pressure angle')
    if (allocated(error)) return
    zones = make_zones(osc%mesh, osc%friction > 0)
    osc%pairs = maxval(zones%pairs)
    osc%members = osc%pairs + merge(1, 0, osc%has_backlash)
    osc%natural_frequency = sqrt(osc%mesh%mean_stiffness()*sum(1/osc%mass))
    osc%highest_frequency = sqrt(osc%pairs*osc%mesh%stiffness%maximum()*sum(1/osc%mass)*(1 + osc%friction))
    osc%static_scale = osc%load/osc%mesh%mean_stiffness()
    osc%rest = mean_deflection(osc, zones)

  contains

    subroutine demand(met, what, value, allowed)
      logical, intent(in) :: met
      character(*), intent(in) :: what, allowed
      real(dp), intent(in) :: value

      if (.not. met) call fail(error, code_input, what//' = '//str(value)//': '//allowed)
    end subroutine demand
  end subroutine make_oscillator

  !> The deflection at which the pairs' mean load over the period, with relief, is
  !> the static one: the motion's limit at high speed. Newton's method from above
  !> comes down to it, as the load is convex in the deflection.
  pure real(dp) function mean_deflection(osc, zones) result(x)
    type(oscillator_t), intent(in) :: osc
    type(zone_t), intent(in) :: zones(:)
    integer, parameter :: samples = 32, most = 100
    real(dp), dimension(osc%pairs, samples, size(zones)) :: stiffness, error
    real(dp) :: excess, s
    integer :: i, j, k

    stiffness = 0
    error = 0
    do i = 1, size(zones)
      associate (zone => zones(i))
        do k = 1, samples
          do j = 1, zone%pairs
            s = zone%first + (zone%last - zone%first)*(k - 0.5_dp)/samples + j - 1
            stiffness(j, k, i) = osc%mesh%stiffness%value(s)*(zone%last - zone%first)/samples
            error(j, k, i) = osc%mesh%profile_error%value(s, zone%piece(j))
          end do
        end do
      end associate
    end do
    x = osc%load/sum(stiffness) + maxval(error)
    do i = 1, most
      excess = sum(stiffness*max(0.0_dp, x - error)) - osc%load
      if (excess <= 1e-12_dp*osc%load) exit
      x = x - excess/sum(stiffness, mask=x > error)
    end do
  end function mean_deflection

  !> Coefficients at `phase` within `zone`; arrays have osc%members elements,
  !> pairs beyond A to E have rate and stiffness 0.
  pure subroutine evaluate(osc, zone, phase, rate, error, stiffness)
    type(oscillator_t), intent(in) :: osc
    type(zone_t), intent(in) :: zone
    real(dp), intent(in) :: phase
    real(dp), intent(out) :: rate(:), error(:), stiffness(:)
    real(dp) :: s
    integer :: j, coast

    rate = 0
    error = 0
    stiffness = 0
    do j = 1, zone%pairs
      s = phase + j - 1
      stiffness(j) = osc%mesh%stiffness%value(s)
      error(j) = osc%mesh%profile_error%value(s, zone%piece(j))
      rate(j) = stiffness(j)*sum(factor(osc, s, zone%recess(j))/osc%mass)
    end do
    if (osc%has_backlash) then
      coast = size(rate)
      error(coast) = -osc%backlash
      stiffness(coast) = sum(stiffness(:zone%pairs))
      rate(coast) = stiffness(coast)*sum(1/osc%mass)
    end if
  end subroutine evaluate

  !> Friction factors of pinion and gear: the driving pinion's tooth slides
  !> inwards before the pitch point (-) and outwards after it (+).
  pure function factor(osc, s, recess) result(f)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: s
    logical, intent(in) :: recess
    real(dp) :: f(2)

    f = 1
    if (osc%friction > 0) f = 1 + merge(osc%friction, -osc%friction, recess) &
      *[osc%mesh%curvature_ratio(1, s), osc%mesh%curvature_ratio(2, s)]
  end function factor

  !> Slopes of K_j and e_j over the phase at `phase` within `zone`.
  pure subroutine pair_slopes(osc, zone, phase, stiffness, error)
    type(oscillator_t), intent(in) :: osc
    type(zone_t), intent(in) :: zone
    real(dp), intent(in) :: phase
    real(dp), intent(out) :: stiffness(:), error(:)
    integer :: j

    stiffness = 0
    error = 0
    do j = 1, zone%pairs
      stiffness(j) = osc%mesh%stiffness%slope(phase + j - 1)
      error(j) = osc%mesh%profile_error%slope(phase + j - 1, zone%piece(j))
    end do
  end subroutine pair_slopes

  !> Tabulates the period with about `steps` steps, `every` a divisor of the
  !> number in each zone. 2 gives tables that nest with their halves, also between
  !> the changes of contact within a step, where more steps would change nothing.
  pure subroutine tabulate(osc, steps, every, table)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: steps, every
    type(table_t), intent(out) :: table
    integer, allocatable :: counts(:)
    integer :: i, k, step

    table%zones = make_zones(osc%mesh, osc%friction > 0)
    allocate (counts(size(table%zones)))
    do i = 1, size(counts)
      counts(i) = every*max(1, ceiling(steps*(table%zones(i)%last - table%zones(i)%first)/every - 1e-6_dp))
    end do
    call allocate_table(osc, sum(counts), table)
    table%parts = every
    step = 0
    do i = 1, size(table%zones)
      do k = 0, counts(i) - 1
        step = step + 1
        associate (zone => table%zones(i))
          table%zone(step) = i
          table%pairs(step) = zone%pairs
          table%width(step) = (zone%last - zone%first)/counts(i)
          table%left(step) = zone%first + k*table%width(step)
        end associate
        call fill_step(osc, step, table)
      end do
    end do
  end subroutine tabulate

  pure subroutine allocate_table(osc, steps, table)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: steps
    type(table_t), intent(inout) :: table

    table%steps = steps
    table%members = osc%members
    associate (m => table%members, p => osc%pairs)
      allocate (table%zone(steps), table%pairs(steps), table%left(steps), table%width(steps))
      allocate (table%rate(m, 3, steps), table%error(m, 3, steps), table%stiffness(m, 3, steps))
      allocate (table%error_slope(p, 2, steps), table%stiffness_slope(p, 2, steps))
      allocate (table%square(3, steps), table%push(3, steps), table%omega(3, steps))
    end associate
  end subroutine allocate_table

  pure subroutine fill_step(osc, step, table)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: step
    type(table_t), intent(inout) :: table
    real(dp) :: phase
    integer :: place

    associate (zone => table%zones(table%zone(step)), pairs => table%pairs(step))
      do place = 1, 3
        phase = table%left(step) + table%width(step)*(place - 1)/2
        call evaluate(osc, zone, phase, table%rate(:, place, step), table%error(:, place, step), &
                      table%stiffness(:, place, step))
        table%square(place, step) = sum(table%rate(:pairs, place, step))
        table%push(place, step) = sum(table%rate(:pairs, place, step)*table%error(:pairs, place, step))
        table%omega(place, step) = sqrt(table%square(place, step))
        if (place /= 2) call pair_slopes(osc, zone, phase, table%stiffness_slope(:, (place + 1)/2, step), &
                                         table%error_slope(:, (place + 1)/2, step))
      end do
    end associate
  end subroutine fill_step
end module gearsweep_motion
