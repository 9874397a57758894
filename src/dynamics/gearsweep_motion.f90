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
  use gearsweep_gauss, only: nodes
  use gearsweep_mesh, only: mesh_t, zone_t, make_zones
  use gearsweep_text, only: str
  implicit none
  private
  public :: oscillator_t, make_oscillator, resolution_t, table_t, tabulate, evaluate, pair_shapes, acceleration

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
  end type oscillator_t

  !> How finely the period is cut: each zone gets `times` steps for each of its shares of `base` steps.
  !> Tables of the same base nest.
  type :: resolution_t
    real(dp) :: base = 0
    integer :: times = 1
  end type resolution_t

  !> Coefficients of each step: at the nodes of the integration and at both ends, one-sided at the breaks.
  type :: table_t
    integer :: steps = 0
    integer :: members = 0             !< pairs at most, and the coast side
    type(zone_t), allocatable :: zones(:)
    integer, allocatable :: zone(:)    !< of each step
    integer, allocatable :: pairs(:)   !< of each step
    real(dp), allocatable :: left(:), width(:)      !< phases
    real(dp), allocatable :: rate(:, :, :)          !< (member, node, step)
    real(dp), allocatable :: error(:, :, :)         !< (member, node, step)
    real(dp), allocatable :: end_rate(:, :, :)      !< (member, end, step)
    !> Value, first and second derivative over the phase, (0:2, pair, end, step).
    real(dp), allocatable :: end_stiffness(:, :, :, :), end_error(:, :, :, :)
    !> Sums over all pairs at the nodes: w^2, sum of k e, w.
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

  contains

    subroutine demand(met, what, value, allowed)
      logical, intent(in) :: met
      character(*), intent(in) :: what, allowed
      real(dp), intent(in) :: value

      if (.not. met) call fail(error, code_input, what//' = '//str(value)//': '//allowed)
    end subroutine demand
  end subroutine make_oscillator

  !> Coefficients at `phase` within `zone`; arrays have osc%members elements,
  !> pairs beyond A to E have rate 0.
  pure subroutine evaluate(osc, zone, phase, rate, error)
    type(oscillator_t), intent(in) :: osc
    type(zone_t), intent(in) :: zone
    real(dp), intent(in) :: phase
    real(dp), intent(out) :: rate(:), error(:)
    real(dp) :: s, stiffness
    integer :: j

    rate = 0
    error = 0
    do j = 1, zone%pairs
      s = phase + j - 1
      stiffness = osc%mesh%stiffness%value(s)
      error(j) = osc%mesh%profile_error%value(s, zone%piece(j))
      rate(j) = stiffness*sum(factor(osc, s, zone%recess(j))/osc%mass)
      if (osc%has_backlash) rate(osc%members) = rate(osc%members) + stiffness*sum(1/osc%mass)
    end do
    if (osc%has_backlash) error(osc%members) = -osc%backlash
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

  !> K_j and e_j with their first and second derivatives over the phase, (0:2, pair).
  pure subroutine pair_shapes(osc, zone, phase, stiffness, error)
    type(oscillator_t), intent(in) :: osc
    type(zone_t), intent(in) :: zone
    real(dp), intent(in) :: phase
    real(dp), intent(out) :: stiffness(0:, :), error(0:, :)
    integer :: j

    stiffness = 0
    error = 0
    do j = 1, zone%pairs
      stiffness(:, j) = osc%mesh%stiffness%shape(phase + j - 1)
      error(:, j) = osc%mesh%profile_error%shape(phase + j - 1, zone%piece(j))
    end do
  end subroutine pair_shapes

  !> Acceleration over the phase (m) of the state x, y, driven by the members in contact.
  pure real(dp) function acceleration(osc, rate, error, contact, duration, x, y)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rate(:), error(:), duration, x, y
    logical, intent(in) :: contact(:)

    acceleration = duration**2*(osc%load*sum(1/osc%mass) - sum(rate*(x - error), mask=contact)) &
                   - 2*osc%damping_ratio*duration*sqrt(sum(rate, mask=contact))*y
  end function acceleration

  !> Tabulates the period at a resolution.
  pure subroutine tabulate(osc, resolution, table)
    type(oscillator_t), intent(in) :: osc
    type(resolution_t), intent(in) :: resolution
    type(table_t), intent(out) :: table
    integer, allocatable :: counts(:)
    integer :: i, k, step

    table%zones = make_zones(osc%mesh, osc%friction > 0)
    counts = resolution%times*max(1, ceiling(resolution%base*(table%zones%last - table%zones%first) - 1e-6_dp))
    call allocate_table(osc, sum(counts), table)
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
      allocate (table%rate(m, 3, steps), table%error(m, 3, steps), table%end_rate(m, 2, steps))
      allocate (table%end_stiffness(0:2, p, 2, steps), table%end_error(0:2, p, 2, steps))
      allocate (table%square(3, steps), table%push(3, steps), table%omega(3, steps))
    end associate
  end subroutine allocate_table

  pure subroutine fill_step(osc, step, table)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: step
    type(table_t), intent(inout) :: table
    real(dp) :: error(osc%members)
    integer :: place

    associate (zone => table%zones(table%zone(step)), pairs => table%pairs(step), &
               left => table%left(step), width => table%width(step))
      do place = 1, size(nodes)
        call evaluate(osc, zone, left + width*nodes(place), table%rate(:, place, step), table%error(:, place, step))
        table%square(place, step) = sum(table%rate(:pairs, place, step))
        table%push(place, step) = sum(table%rate(:pairs, place, step)*table%error(:pairs, place, step))
        table%omega(place, step) = sqrt(table%square(place, step))
      end do
      do place = 1, 2
        call evaluate(osc, zone, left + width*(place - 1), table%end_rate(:, place, step), error)
        call pair_shapes(osc, zone, left + width*(place - 1), table%end_stiffness(:, :, place, step), &
                         table%end_error(:, :, place, step))
      end do
    end associate
  end subroutine fill_step
end module gearsweep_motion
