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
  use gearsweep_grading, only: grading_t, make_grading, is_stiff, has_turned, expected_steps, count_steps, spread_steps
  use gearsweep_memory, only: has_memory
  use gearsweep_radau, only: stiff_nodes
  use gearsweep_mesh, only: mesh_t, zone_t, make_zones
  use gearsweep_text, only: str
  implicit none
  private
  public :: oscillator_t, make_oscillator, resolution_t, table_t, tabulate, graded_steps, mobility, acceleration, end_acceleration

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
    type(zone_t), allocatable :: zones(:)
    real(dp), allocatable :: frequency(:, :)  !< lowest and highest w of each zone, rad/s; (2, zone)
  end type oscillator_t

  !> How finely the period is cut: each zone gets `times` steps for each of its shares of `base` steps.
  !> Tables of the same base nest.
  type :: resolution_t
    real(dp) :: base = 0               !< a period; where graded, a radian of the natural motion behind a break
    integer :: times = 1
    real(dp) :: graded_for = 0         !< duration of the period, s; 0: equal steps
  end type resolution_t

  !> What is special about a step.
  type :: kind_t
    !> A zone begins, or, where steps are graded, three quarters of a turn of the natural motion behind that.
    logical :: begins = .false.
    logical :: widens = .false.        !< a zone begins, or the step before was shorter
    logical :: stiff = .false.         !< too long to see the natural motion: by Radau's points
  end type kind_t

  !> Coefficients of each step: at the nodes of the integration and at both ends, one-sided at the breaks.
  type :: table_t
    integer :: steps = 0               !< 0: the memory does not hold them
    integer :: members = 0             !< pairs at most, and the coast side
    integer, allocatable :: zone(:)    !< of each step
    integer, allocatable :: pairs(:)   !< of each step
    type(kind_t), allocatable :: kind(:)
    real(dp), allocatable :: left(:), width(:)      !< phases
    real(dp), allocatable :: rate(:, :, :)          !< (member, node, step)
    real(dp), allocatable :: error(:, :, :)         !< (member, node, step)
    real(dp), allocatable :: end_rate(:, :, :)      !< (pair, end, step)
    !> Value, first and second derivative over the phase, (0:2, pair or member, end, step).
    real(dp), allocatable :: end_stiffness(:, :, :, :), end_error(:, :, :, :)
    real(dp), allocatable :: crest(:)               !< a motion whose tangents stay above keeps all pairs in contact
    !> Sums over all pairs at the nodes: w^2, sum of k e, w.
    real(dp), allocatable :: square(:, :), push(:, :), omega(:, :)
  end type table_t

contains

  !> Checks and completes an oscillator whose mesh, masses, load, damping,
  !> friction and backlash are set.
  subroutine make_oscillator(osc, error)
    type(oscillator_t), intent(inout) :: osc
    type(error_t), allocatable, intent(out) :: error

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
    osc%zones = make_zones(osc%mesh, osc%friction > 0)
    osc%pairs = maxval(osc%zones%pairs)
    osc%members = osc%pairs + merge(1, 0, osc%has_backlash)
    osc%natural_frequency = sqrt(osc%mesh%mean_stiffness()*sum(1/osc%mass))
    osc%highest_frequency = sqrt(osc%pairs*osc%mesh%stiffness%maximum()*sum(1/osc%mass)*(1 + osc%friction))
    osc%static_scale = osc%load/osc%mesh%mean_stiffness()
    osc%rest = mean_deflection(osc)
    osc%frequency = frequencies(osc)

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
  pure real(dp) function mean_deflection(osc) result(x)
    type(oscillator_t), intent(in) :: osc
    integer, parameter :: samples = 32, most = 100
    real(dp), dimension(osc%pairs, samples, size(osc%zones)) :: stiffness, error
    real(dp) :: excess, s
    integer :: i, j, k

    stiffness = 0
    error = 0
    do i = 1, size(osc%zones)
      associate (zone => osc%zones(i))
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

  !> Lowest and highest w (rad/s) of each zone while all pairs carry, (2, zone).
  pure function frequencies(osc) result(frequency)
    type(oscillator_t), intent(in) :: osc
    integer, parameter :: samples = 17
    real(dp) :: frequency(2, size(osc%zones)), square(samples), s(samples), rate(samples)
    integer :: i, j, k

    do i = 1, size(osc%zones)
      associate (zone => osc%zones(i))
        square = 0
        do j = 1, zone%pairs
          s = zone%first + (zone%last - zone%first)*[(k, k=0, samples - 1)]/(samples - 1) + j - 1
          call osc%mesh%stiffness%sample(s, 0, rate)
          square = square + rate*mobility(osc, s, zone%recess(j))
        end do
      end associate
      frequency(:, i) = sqrt([minval(square), maxval(square)])
    end do
  end function frequencies

  !> What a pair's force makes of the acceleration (1/kg): the friction factors of pinion and gear over
  !> their masses. The driving pinion's tooth slides inwards before the pitch point (-) and outwards
  !> after it (+).
  elemental real(dp) function mobility(osc, s, recess)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: s
    logical, intent(in) :: recess
    real(dp) :: sense

    mobility = 1/osc%mass(1) + 1/osc%mass(2)
    if (.not. osc%friction > 0) return
    sense = merge(osc%friction, -osc%friction, recess)
    mobility = mobility + sense*(osc%mesh%curvature_ratio(1, s)/osc%mass(1) + osc%mesh%curvature_ratio(2, s)/osc%mass(2))
  end function mobility

  !> From stiffness to what it makes of the acceleration.
  pure subroutine weigh(osc, s, recess, rate)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: s(:)
    logical, intent(in) :: recess
    real(dp), intent(inout) :: rate(:)

    if (osc%friction > 0) then
      rate = rate*mobility(osc, s, recess)
    else
      rate = rate*(1/osc%mass(1) + 1/osc%mass(2))
    end if
  end subroutine weigh

  !> Acceleration over the phase (m) of the state x, y; `square` and `push` are w^2 and the sum of k e of
  !> the members in contact.
  pure real(dp) function acceleration(osc, square, push, duration, x, y)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: square, push, duration, x, y

    acceleration = duration**2*(osc%load*(1/osc%mass(1) + 1/osc%mass(2)) + push - square*x) &
                   - 2*osc%damping_ratio*duration*sqrt(square)*y
  end function acceleration

  !> The same at an end of step i, where the pairs touch that the bits of `touch` tell; the coast sides do not, as
  !> what is asked for is the load of a pair.
  pure real(dp) function end_acceleration(osc, table, i, end, touch, duration, x, y)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    integer, intent(in) :: i, end, touch
    real(dp), intent(in) :: duration, x, y
    real(dp) :: square, push
    integer :: j

    square = 0
    push = 0
    do j = 1, osc%pairs
      if (.not. btest(touch, j - 1)) cycle
      square = square + table%end_rate(j, end, i)
      push = push + table%end_rate(j, end, i)*table%end_error(0, j, end, i)
    end do
    end_acceleration = acceleration(osc, square, push, duration, x, y)
  end function end_acceleration

  !> Tabulates the period at a resolution; without steps where the memory does not hold them.
  pure subroutine tabulate(osc, resolution, table)
    type(oscillator_t), intent(in) :: osc
    type(resolution_t), intent(in) :: resolution
    type(table_t), intent(inout) :: table
    type(grading_t) :: grading(size(osc%zones))
    integer :: counts(size(osc%zones)), i, j, first, last

    if (resolution%graded_for > 0) then
      grading = gradings(osc, resolution)
      counts = resolution%times*count_steps(grading, osc%zones%last - osc%zones%first)
    else
      counts = resolution%times*max(1, ceiling(resolution%base*(osc%zones%last - osc%zones%first) - 1e-6_dp))
    end if
    call allocate_table(osc, sum(counts), table)
    if (table%steps == 0) return
    table%square(:, :) = 0
    table%push(:, :) = 0
    last = 0
    do i = 1, size(osc%zones)
      first = last + 1
      last = last + counts(i)
      associate (zone => osc%zones(i))
        table%zone(first:last) = i
        table%pairs(first:last) = zone%pairs
        table%kind(first:last) = kind_t()
        if (resolution%graded_for > 0) then
          call grade_zone(osc, i, resolution, grading(i), first, last, table)
        else
          table%kind(first) = kind_t(begins=.true., widens=.true.)
          table%width(first:last) = (zone%last - zone%first)/counts(i)
          table%left(first:last) = zone%first + [(j, j=0, counts(i) - 1)]*table%width(first)
        end if
        do j = 1, zone%pairs
          call fill_pair(osc, zone, j, first, last, table)
        end do
      end associate
    end do
    if (osc%has_backlash) call fill_coast(osc, table)
    call find_crests(osc, table)
    table%omega(:, :) = sqrt(table%square)
  end subroutine tabulate

  !> How the steps of each zone grow behind its begin.
  pure function gradings(osc, resolution) result(grading)
    type(oscillator_t), intent(in) :: osc
    type(resolution_t), intent(in) :: resolution
    type(grading_t) :: grading(size(osc%zones))

    grading = make_grading(osc%frequency(1, :), osc%frequency(2, :), osc%damping_ratio, resolution%base, resolution%graded_for)
  end function gradings

  !> About how many steps a graded table has.
  pure real(dp) function graded_steps(osc, resolution)
    type(oscillator_t), intent(in) :: osc
    type(resolution_t), intent(in) :: resolution

    graded_steps = resolution%times*sum(expected_steps(gradings(osc, resolution), osc%zones%last - osc%zones%first))
  end function graded_steps

  !> Places the steps first to last of zone i.
  pure subroutine grade_zone(osc, i, resolution, grading, first, last, table)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: i, first, last
    type(resolution_t), intent(in) :: resolution
    type(grading_t), intent(in) :: grading
    type(table_t), intent(inout) :: table
    real(dp) :: widths((last - first + 1)/resolution%times), behind
    logical :: noted
    integer :: k, step

    call spread_steps(grading, osc%zones(i)%last - osc%zones(i)%first, widths)
    behind = 0
    noted = .false.
    do k = 0, last - first
      step = first + k
      table%width(step) = widths(1 + k/resolution%times)/resolution%times
      table%left(step) = osc%zones(i)%first + behind
      associate (kind => table%kind(step))
        kind%stiff = is_stiff(grading, table%width(step))
        kind%widens = modulo(k, resolution%times) == 0
        kind%begins = k == 0 .or. (kind%widens .and. .not. noted .and. has_turned(grading, behind))
        noted = noted .or. (k > 0 .and. kind%begins)
      end associate
      behind = behind + table%width(step)
    end do
  end subroutine grade_zone

  !> Room for so many steps; that of the last table stays where it is as large. Pairs that a zone does not
  !> have stay undefined.
  pure subroutine allocate_table(osc, steps, table)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: steps
    type(table_t), intent(inout) :: table
    ! Of these a thread keeps few enough for what is in reserve.
    real(dp), parameter :: small = 256e3_dp
    logical :: fits

    if (allocated(table%zone)) then
      if (steps == table%steps .and. osc%members == table%members .and. osc%pairs == size(table%end_stiffness, 2)) return
      table = table_t()
    end if
    fits = .true.
    if (steps*step_bytes(osc) > small) call has_memory(steps*step_bytes(osc), fits)
    if (.not. fits) return
    table%steps = steps
    table%members = osc%members
    associate (m => table%members, p => osc%pairs)
      allocate (table%zone(steps), table%pairs(steps), table%left(steps), table%width(steps), table%crest(steps))
      allocate (table%kind(steps))
      allocate (table%rate(m, 3, steps), table%error(m, 3, steps), table%end_rate(p, 2, steps))
      allocate (table%end_stiffness(0:2, p, 2, steps), table%end_error(0:2, m, 2, steps))
      allocate (table%square(3, steps), table%push(3, steps), table%omega(3, steps))
    end associate
  end subroutine allocate_table

  !> What a step takes: its rows of a table, and of what `fill_pair` and those after it keep meanwhile.
  pure real(dp) function step_bytes(osc)
    type(oscillator_t), intent(in) :: osc

    step_bytes = 8*(60 + 14*osc%members + 6*osc%pairs)
  end function step_bytes

  !> The highest profile error at the ends of each step and what its slopes take from the motion's; at least the
  !> coast side.
  pure subroutine find_crests(osc, table)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(inout) :: table
    real(dp) :: height, steepness
    integer :: i, j

    do i = 1, table%steps
      height = -osc%backlash
      steepness = 0
      do j = 1, table%pairs(i)
        height = max(height, table%end_error(0, j, 1, i), table%end_error(0, j, 2, i))
        steepness = max(steepness, abs(table%end_error(1, j, 1, i)), abs(table%end_error(1, j, 2, i)))
      end do
      table%crest(i) = height + steepness*table%width(i)/2
    end do
  end subroutine find_crests

  !> Pair j over the steps first to last, those of one zone.
  pure subroutine fill_pair(osc, zone, j, first, last, table)
    type(oscillator_t), intent(in) :: osc
    type(zone_t), intent(in) :: zone
    integer, intent(in) :: j, first, last
    type(table_t), intent(inout) :: table
    real(dp), dimension(3*(last - first + 1)) :: s, rate, error
    real(dp), dimension(0:last - first + 1) :: ends, end_rate
    real(dp), dimension(0:last - first + 1, 0:2) :: stiffness, deviation
    integer :: i, k, n

    n = last - first + 1
    do i = 1, n
      associate (step => first + i - 1)
        if (table%kind(step)%stiff) then
          s(3*i - 2:3*i) = table%left(step) + j - 1 + table%width(step)*stiff_nodes
        else
          s(3*i - 2:3*i) = table%left(step) + j - 1 + table%width(step)*nodes
        end if
      end associate
    end do
    call osc%mesh%stiffness%sample(s, 0, rate)
    call weigh(osc, s, zone%recess(j), rate)
    call osc%mesh%profile_error%sample(s, zone%piece(j), error)
    ends(:n - 1) = table%left(first:last) + j - 1
    ends(n) = ends(n - 1) + table%width(last)
    call osc%mesh%stiffness%sample(ends, 0, stiffness(:, 0), stiffness(:, 1), stiffness(:, 2))
    call osc%mesh%profile_error%sample(ends, zone%piece(j), deviation(:, 0), deviation(:, 1), deviation(:, 2))
    end_rate = stiffness(:, 0)
    call weigh(osc, ends, zone%recess(j), end_rate)
    do i = 1, n
      associate (step => first + i - 1)
        do k = 1, 3
          table%rate(j, k, step) = rate(3*i - 3 + k)
          table%error(j, k, step) = error(3*i - 3 + k)
          table%square(k, step) = table%square(k, step) + rate(3*i - 3 + k)
          table%push(k, step) = table%push(k, step) + rate(3*i - 3 + k)*error(3*i - 3 + k)
        end do
        do k = 1, 2
          table%end_stiffness(:, j, k, step) = stiffness(i + k - 2, :)
          table%end_error(:, j, k, step) = deviation(i + k - 2, :)
          table%end_rate(j, k, step) = end_rate(i + k - 2)
        end do
      end associate
    end do
  end subroutine fill_pair

  !> The coast side as one more member, which all pairs' stiffness backs.
  pure subroutine fill_coast(osc, table)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(inout) :: table
    real(dp) :: s(3)
    integer :: i, j, k

    associate (coast => osc%members)
      table%rate(coast, :, :) = 0
      table%error(coast, :, :) = -osc%backlash
      table%end_error(:, coast, :, :) = 0
      table%end_error(0, coast, :, :) = -osc%backlash
      do i = 1, table%steps
        associate (zone => osc%zones(table%zone(i)))
          s = table%left(i) + table%width(i)*merge(stiff_nodes, nodes, table%kind(i)%stiff)
          do j = 1, zone%pairs
            do k = 1, size(nodes)
              table%rate(coast, k, i) = table%rate(coast, k, i) + table%rate(j, k, i)*sum(1/osc%mass) &
                /mobility(osc, s(k) + j - 1, zone%recess(j))
            end do
          end do
        end associate
      end do
    end associate
  end subroutine fill_coast
end module gearsweep_motion
