!> Steps of a mesh period for a batch of gears in quick turns: contact laws, motion over a step, and changes of contact.
!>
!> Gears that differ only in the errors of their teeth share all steps. The time is in radians of the mean natural motion.
!> While one contact set holds,
!>
!>     x" = r - omega^2 x - rate x',  r = A0 + sum over the pairs of q_i e_i,
!>
!> with the contact law of gearsweep_motion_contact_law: the touching deflections are linear in the profile errors e_i, and so is
!> r. Over a step omega^2, the rate and r are the parabolas through their values at its start, middle and end. So the motion at
!> the end is linear in the state at the start and the three r, whatever the errors.
!>
!> Where a pair closes or opens, the motion is corrected from there on by a series; where more happens, the step is divided into
!> small parts.
module gearsweep_motion_quick_steps
  use gearsweep_base, only: derivative_of, dp, first_zero, pi, quintic, value_of
  use gearsweep_mesh, only: interval_t, mesh_t, smooth_intervals, wave_t
  use gearsweep_motion_contact_law, only: find_law_values, springs_at, springs_t
  use gearsweep_motion_oscillator, only: damping, mobility, oscillator_t
  implicit none
  private
  public :: quick_steps_t, quick_maps_t, lay_steps, lay_maps, need_map, by_errors, quick_motion_t, state_t, follow_step

  !> Largest number of pairs that may be in contact.
  integer, parameter, public :: most_pairs = 4
  !> Speeds integrated in parallel lanes.
  integer, parameter, public :: lanes = 8

  !> Contact law of a contact set over a step, at its start, middle and end.
  type :: quick_law_t
    logical :: is_known = .false.
    real(dp), dimension(3) :: omega_squared = 0, rate = 0  !< per rad^2 and rad of the mean natural motion
    real(dp) :: pull(most_pairs, 3) = 0                    !< q, per rad^2; (pair, node)
    real(dp) :: effective(most_pairs, 3) = 0               !< N/m; 0 for a pair out of contact; (pair, node)
    !> Contribution of a pair's error to the touching deflection of each pair; (pair with the error, node, pair that touches)
    real(dp) :: touching(most_pairs, 3, most_pairs) = 0
    real(dp) :: stiffest(most_pairs) = 0                   !< the largest of `effective`; (pair)
    !> Sense of the gap: the law holds while sense times the gap is above 0: 1 for a pair in contact, -1 for a pair out of
    !> contact. For a pair that does not exist the limit is -1 m, which always holds; (pair)
    real(dp) :: sense(most_pairs) = 0, spare(most_pairs) = 1
  end type quick_law_t

  type :: quick_steps_t
    type(oscillator_t) :: osc                    !< oscillator of the nominal teeth
    integer :: steps = 0                         !< number of steps of a mesh period
    integer, allocatable :: pairs(:), offset(:)  !< as in interval_t; (step)
    logical, allocatable :: begins(:)            !< true: the pairs differ from those before, or their properties jump; (step)
    real(dp), allocatable :: left(:), width(:)   !< mesh phase; (step)
    type(interval_t), allocatable :: intervals(:)
    integer, allocatable :: interval(:)          !< (step)
    type(springs_t), allocatable :: springs(:)   !< nominal pairs at the three nodes; (step)
    real(dp), allocatable :: phase(:)            !< (node of all steps)
    !> Path coordinate minus half the contact ratio, kept between A and E; (node of all steps, pair)
    real(dp), allocatable :: along(:, :)
    real(dp), allocatable :: nominal(:, :)       !< profile errors of nominal teeth; (pair, node of all steps)
    real(dp), allocatable :: cosine(:, :), sine(:, :)      !< cosine and sine of a wave of phase 0; (node of all steps, wave)
    type(quick_law_t), allocatable :: law(:, :)  !< (contact set from 0, step)
  end type quick_steps_t

  !> Motions over the steps at some speeds: x and x' at the end (m) for x, x' at the start and r at the three nodes.
  type :: quick_maps_t
    integer :: speeds = 0                        !< number of lanes used
    real(dp) :: turning(lanes) = 0               !< mean natural motion of a mesh period, rad; (speed)
    logical, allocatable :: is_known(:, :)       !< (contact set from 0, step)
    real(dp), allocatable :: of(:, :, :, :, :)   !< (speed, cause, x or x', contact set from 0, step)
  end type quick_maps_t

  type :: quick_motion_t
    logical :: is_found = .false.                !< the motion repeats after a turn, and the coast sides stay apart
    real(dp) :: peak = 0                         !< largest load of a pair, N
    integer :: pair = -1                         !< number of that pair, from 0
    real(dp) :: place = 0                        !< path coordinate of that load, base pitches
    real(dp) :: least = huge(1.0_dp), largest = -huge(1.0_dp)        !< transmission error, m
    real(dp) :: begin(2) = 0                     !< x and its derivative at time 0, m
    real(dp) :: sums(2) = 0                      !< sums of the deviation from the mean deflection, and of its square, over the turn
    logical :: lost = .false.                    !< all flanks were apart for a while
    !> Difference of the peak from that in steps twice as long, N; 0 where it was not computed.
    real(dp) :: off = 0
    integer :: motions = 0                       !< number of attracting motions found, of which this has the largest load
  end type quick_motion_t

  type :: state_t
    real(dp) :: x = 0, v = 0                     !< m
    real(dp) :: r = 0                            !< r at the start of the step, m
    integer :: set = 0                           !< contact set
    real(dp) :: gap(most_pairs) = 0              !< x minus the touching deflections, m
  end type state_t

contains

  !> Divides a mesh period into steps.
  pure subroutine lay_steps(osc, waves, longest, steps)
    type(oscillator_t), intent(in) :: osc        !< oscillator of nominal teeth
    type(wave_t), intent(in) :: waves(:)         !< waves of the gears: gear and order count
    real(dp), intent(in) :: longest              !< largest length of a step, mesh phase
    type(quick_steps_t), intent(out) :: steps    !< no steps where more than `most_pairs` pairs may be in contact
    real(dp), allocatable :: ends(:)
    integer :: i, j, k, n, pairs

    steps%osc = osc
    steps%intervals = smooth_intervals(osc%mesh, osc%friction > 0)
    pairs = maxval(steps%intervals%pairs)
    if (pairs > most_pairs) return
    allocate (ends(0), steps%interval(0))
    do i = 1, size(steps%intervals)
      associate (interval => steps%intervals(i))
        n = max(1, ceiling((interval%last - interval%first)/longest - 1e-9_dp))
        do k = 1, n
          call add_steps(osc%mesh, interval, interval%first + (k - 1)*(interval%last - interval%first)/n, &
                         interval%first + k*(interval%last - interval%first)/n, ends)
        end do
        steps%interval = [steps%interval, (i, k=size(steps%interval) + 1, size(ends))]
      end associate
    end do
    n = size(ends)
    steps%steps = n
    steps%pairs = steps%intervals(steps%interval)%pairs
    steps%offset = steps%intervals(steps%interval)%offset
    steps%left = [0.0_dp, ends(:n - 1)]
    steps%width = ends - steps%left
    allocate (steps%begins(n), source=.false.)
    allocate (steps%springs(n), steps%phase(3*n), steps%law(0:2**pairs - 1, n))
    allocate (steps%along(3*n, pairs), steps%nominal(pairs, 3*n), source=0.0_dp)
    do k = 1, n
      associate (interval => steps%intervals(steps%interval(k)), middle => osc%mesh%contact_ratio/2)
        steps%phase(3*k - 2:3*k) = steps%left(k) + steps%width(k)*[0.0_dp, 0.5_dp, 1.0_dp]
        do j = 1, interval%pairs
          steps%along(3*k - 2:3*k, j) = max(-middle, min(middle, interval%place(steps%phase(3*k - 2:3*k), j) - middle))
        end do
        call springs_at(osc%mesh, interval, steps%phase(3*k - 2:3*k), steps%springs(k))
        steps%nominal(:interval%pairs, 3*k - 2:3*k) = transpose(steps%springs(k)%profile_error)
      end associate
    end do
    do i = 1, steps%steps
      steps%begins(i) = i == 1 .or. osc%friction > 0
      if (.not. steps%begins(i)) steps%begins(i) = .not. goes_on(steps, i)
    end do
    allocate (steps%cosine(size(steps%phase), size(waves)), steps%sine(size(steps%phase), size(waves)))
    do i = 1, size(waves)
      steps%cosine(:, i) = cos(2*pi*waves(i)%order/osc%mesh%teeth(waves(i)%gear)*steps%phase)
      steps%sine(:, i) = sin(2*pi*waves(i)%order/osc%mesh%teeth(waves(i)%gear)*steps%phase)
    end do
  end subroutine lay_steps

  !> Adds the ends of steps from one phase to another: one step, or halves where the stiffness of a pair is not near its parabola,
  !> as at A and E with tip corner contact.
  pure recursive subroutine add_steps(mesh, interval, from, to, ends)
    type(mesh_t), intent(in) :: mesh
    type(interval_t), intent(in) :: interval
    real(dp), intent(in) :: from, to
    real(dp), allocatable, intent(inout) :: ends(:)
    real(dp), parameter :: shortest = 1e-3_dp, near = 2e-4_dp
    type(springs_t) :: springs
    logical :: is_near
    integer :: j

    is_near = to - from < shortest
    if (.not. is_near) then
      call springs_at(mesh, interval, from + (to - from)*[0.0_dp, 0.5_dp, 1.0_dp, 0.25_dp], springs)
      is_near = all([(abs(parabola(springs%stiffness(:3, j), 0.25_dp) - springs%stiffness(4, j)) <= near*springs%stiffness(4, j), &
                      j=1, interval%pairs)])
    end if
    if (is_near) then
      ends = [ends, to]
    else
      call add_steps(mesh, interval, from, (from + to)/2, ends)
      call add_steps(mesh, interval, (from + to)/2, to, ends)
    end if
  end subroutine add_steps

  !> True if the pairs at the start of a step continue those at the end of the previous step.
  pure logical function goes_on(steps, step)
    type(quick_steps_t), intent(in) :: steps
    integer, intent(in) :: step
    real(dp), parameter :: rounding = 1e-9_dp

    goes_on = steps%pairs(step) == steps%pairs(step - 1) .and. steps%offset(step) == steps%offset(step - 1)
    if (.not. goes_on) return
    associate (before => steps%springs(step - 1), now => steps%springs(step), static => steps%osc%static_deflection)
      goes_on = all(abs(now%stiffness(1, :) - before%stiffness(3, :)) <= rounding*before%stiffness(3, :)) .and. &
                all(abs(now%profile_error(1, :) - before%profile_error(3, :)) <= rounding*static) .and. &
                all(abs(now%shared(1, :) - before%shared(3, :)) <= rounding*before%shared(3, :))
    end associate
  end function goes_on

  !> Computes the law of a contact set over a step unless it is known.
  pure subroutine need_law(steps, set, step)
    type(quick_steps_t), intent(inout) :: steps
    integer, intent(in) :: set                   !< bit j - 1: pair j is in contact
    integer, intent(in) :: step
    real(dp), dimension(steps%pairs(step), steps%pairs(step)) :: stiffness, error, effective, touching
    real(dp) :: weight
    integer :: j, node, p

    associate (law => steps%law(set, step), springs => steps%springs(step), osc => steps%osc, &
               interval => steps%intervals(steps%interval(step)))
      if (law%is_known) return
      law%is_known = .true.
      p = interval%pairs
      error = 0
      do j = 1, p
        error(j, j) = 1
      end do
      do node = 1, 3
        stiffness = spread(springs%stiffness(node, :), 1, p)
        call find_law_values(set, springs%kind, stiffness, error, spread(springs%shared(node, :), 1, p), effective, touching)
        do j = 1, p
          weight = effective(1, j)*mobility(osc, interval%place(steps%phase(3*step - 3 + node), j), interval%recess(j))/ &
                   osc%natural_frequency**2
          law%effective(j, node) = effective(1, j)
          law%touching(:p, node, j) = touching(:, j)
          law%omega_squared(node) = law%omega_squared(node) + weight
          law%pull(:p, node) = law%pull(:p, node) + weight*touching(:, j)
        end do
        law%rate(node) = damping(osc, sqrt(law%omega_squared(node)))
      end do
      law%stiffest = maxval(law%effective, 2)
      law%sense(:p) = merge(1, -1, btest(set, [(j, j=0, p - 1)]))
      law%spare(:p) = 0
    end associate
  end subroutine need_law

  !> Allocates the motions over the steps. Unused lanes have the last speed.
  pure subroutine lay_maps(steps, turning, maps)
    type(quick_steps_t), intent(in) :: steps
    real(dp), intent(in) :: turning(:)           !< (speed), at most as many as there are lanes
    type(quick_maps_t), intent(out) :: maps

    maps%speeds = size(turning)
    maps%turning = turning(size(turning))
    maps%turning(:size(turning)) = turning
    associate (last => ubound(steps%law, 1))
      allocate (maps%is_known(0:last, steps%steps), source=.false.)
      allocate (maps%of(lanes, 5, 2, 0:last, steps%steps))
    end associate
  end subroutine lay_maps

  !> Computes the motion over a step under a contact set unless it is known.
  pure subroutine need_map(steps, set, step, maps)
    type(quick_steps_t), intent(inout) :: steps
    integer, intent(in) :: set                   !< bit j - 1: pair j is in contact
    integer, intent(in) :: step
    type(quick_maps_t), intent(inout) :: maps
    integer, parameter :: parts = 8
    real(dp) :: x(5), v(5), r(3, 5)
    integer :: i

    if (maps%is_known(set, step)) return
    maps%is_known(set, step) = .true.
    call need_law(steps, set, step)
    r = 0
    do i = 1, 3
      r(i, i + 2) = 1
    end do
    do i = 1, lanes
      x = [1, 0, 0, 0, 0]
      v = [0, 1, 0, 0, 0]
      call advance(steps%law(set, step), steps%width(step)*maps%turning(i), 0.0_dp, 1.0_dp, parts, r, x, v)
      maps%of(i, :, 1, set, step) = x
      maps%of(i, :, 2, set, step) = v
    end do
  end subroutine need_map

  !> Integrates motions over a part of a step under one law, by the classical Runge-Kutta method.
  pure subroutine advance(law, span, from, to, parts, r, x, v)
    type(quick_law_t), intent(in) :: law
    real(dp), intent(in) :: span                 !< length of the step, rad
    real(dp), intent(in) :: from, to             !< place in the step, 0 to 1
    integer, intent(in) :: parts                 !< number of Runge-Kutta steps
    real(dp), intent(in) :: r(:, :)              !< r at the three nodes of the step, m; (3, motion)
    real(dp), intent(inout) :: x(:), v(:)        !< m; (motion)
    real(dp) :: a(4), dx, h, place(3), rate(3), square(3), weight(3, 3)
    integer :: i, k

    h = span*(to - from)/parts
    do k = 1, parts
      place = from + (k - 1 + [0.0_dp, 0.5_dp, 1.0_dp])*(to - from)/parts
      do i = 1, 3
        weight(:, i) = [(1 - place(i))*(1 - 2*place(i)), 4*place(i)*(1 - place(i)), place(i)*(2*place(i) - 1)]
        square(i) = sum(weight(:, i)*law%omega_squared)
        rate(i) = sum(weight(:, i)*law%rate)
      end do
      do i = 1, size(x)
        associate (begin => sum(weight(:, 1)*r(:, i)), middle => sum(weight(:, 2)*r(:, i)), end => sum(weight(:, 3)*r(:, i)))
          a(1) = begin - square(1)*x(i) - rate(1)*v(i)
          a(2) = middle - square(2)*(x(i) + h/2*v(i)) - rate(2)*(v(i) + h/2*a(1))
          dx = h/2*v(i) + h**2/4*a(1)
          a(3) = middle - square(2)*(x(i) + dx) - rate(2)*(v(i) + h/2*a(2))
          a(4) = end - square(3)*(x(i) + h*v(i) + h**2/2*a(2)) - rate(3)*(v(i) + h*a(3))
        end associate
        x(i) = x(i) + h*v(i) + h**2/6*(a(1) + a(2) + a(3))
        v(i) = v(i) + h/6*(a(1) + 2*a(2) + 2*a(3) + a(4))
      end do
    end do
  end subroutine advance

  !> Sum over the pairs of a factor times the pair's error, at the nodes of a step.
  pure function by_errors(factor, error) result(values)
    real(dp), intent(in) :: factor(most_pairs, 3)          !< (pair, node)
    real(dp), intent(in) :: error(most_pairs, 3)           !< m; (pair, node)
    real(dp) :: values(3)

    values = (factor(1, :)*error(1, :) + factor(2, :)*error(2, :)) + (factor(3, :)*error(3, :) + factor(4, :)*error(4, :))
  end function by_errors

  !> Parabola through values at the start, middle and end of a step.
  pure real(dp) function parabola(values, at)
    real(dp), intent(in) :: values(:)            !< (3)
    real(dp), intent(in) :: at                   !< 0 to 1

    parabola = values(1) + at*(4*values(2) - 3*values(1) - values(3) + 2*at*(values(1) - 2*values(2) + values(3)))
  end function parabola

  !> Upper estimate of the largest load (N) within a step and at its end, from the parabola through the values at start, middle
  !> and end.
  pure real(dp) function top_load(law, span, hollow, state, next) result(top)
    type(quick_law_t), intent(in) :: law
    real(dp), intent(in) :: span
    real(dp), intent(in) :: hollow(most_pairs)   ! increase of the gaps in the middle, where the errors are smaller, m
    type(state_t), intent(in) :: state, next
    real(dp), parameter :: margin = 1/32.0_dp
    real(dp) :: bend, curve, load(3)
    integer :: j

    top = 0
    bend = span/8*(state%v - next%v)
    do j = 1, most_pairs
      load = law%effective(j, :)*[state%gap(j), (state%gap(j) + next%gap(j))/2 + bend + hollow(j), next%gap(j)]
      top = max(top, load(3))
      curve = 2*load(2) - load(1) - load(3)
      if (abs(load(3) - load(1)) < 3*curve) top = max(top, load(2) + (load(3) - load(1))**2/(8*curve) + margin*curve)
    end do
  end function top_load

  !> Finds the pairs in contact at a place of a step, and the gaps.
  pure subroutine close_gaps(steps, error, step, at, state)
    type(quick_steps_t), intent(inout) :: steps
    real(dp), intent(in) :: error(most_pairs, 3)           ! profile errors of the pairs at the nodes, m
    integer, intent(in) :: step
    real(dp), intent(in) :: at                   ! 0 to 1
    type(state_t), intent(inout) :: state
    integer :: i, j

    associate (p => steps%pairs(step))
      do i = 1, 4*2**p
        if (.not. steps%law(state%set, step)%is_known) call need_law(steps, state%set, step)
        do j = 1, p
          state%gap(j) = state%x - parabola(by_errors(steps%law(state%set, step)%touching(:, :, j), error), at)
        end do
        do j = 1, p
          if (btest(state%set, j - 1) .neqv. state%gap(j) > 0) exit
        end do
        if (j > p) exit
        state%set = ieor(state%set, ibset(0, j - 1))
      end do
    end associate
  end subroutine close_gaps

  !> Quintic of x over the step.
  pure function course(law, span, state, next) result(c)
    type(quick_law_t), intent(in) :: law
    real(dp), intent(in) :: span
    type(state_t), intent(in) :: state, next
    real(dp) :: c(0:5)

    c = quintic([state%x, span*state%v, span**2*(state%r - law%omega_squared(1)*state%x - law%rate(1)*state%v)], &
                [next%x, span*next%v, span**2*(next%r - law%omega_squared(3)*next%x - law%rate(3)*next%v)])
  end function course

  !> Corrects the motion where one pair closes or opens within a step. From there on the motion differs from that under the
  !> previous law by y,
  !>
  !>   y" + rate y' + omega^2 y = -(change of omega^2) gap - (change of the rate) x',
  !>
  !> where the right side is that of the motion under the previous law, and y a series up to the sixth derivative.
  pure subroutine change(steps, error, step, span, state, next, wrong)
    type(quick_steps_t), intent(inout) :: steps
    real(dp), intent(in) :: error(most_pairs, 3)           ! profile errors of the pairs at the nodes, m
    integer, intent(in) :: step
    real(dp), intent(in) :: span
    type(state_t), intent(in) :: state
    type(state_t), intent(inout) :: next         ! in: the end under the previous law; out: corrected
    logical, intent(out) :: wrong                ! true: more than one change happens
    real(dp) :: at, c(0:5), d, gap(0:5), right(3), t(3), u, w, y(2:6)
    integer :: j, k, p
    logical :: found

    wrong = .true.
    p = steps%pairs(step)
    do j = 1, p
      if (btest(state%set, j - 1) .neqv. next%gap(j) > 0) exit
    end do
    next%set = ieor(state%set, ibset(0, j - 1))
    if (.not. steps%law(next%set, step)%is_known) call need_law(steps, next%set, step)
    associate (old => steps%law(state%set, step), new => steps%law(next%set, step), &
               sense => merge(1, -1, btest(state%set, j - 1)))
      t = by_errors(old%touching(:, :, j), error)
      c = course(old, span, state, next)
      gap = c
      gap(:2) = gap(:2) - [t(1), 4*t(2) - 3*t(1) - t(3), 2*(t(1) - 2*t(2) + t(3))]
      call first_zero(sense*gap, at, found)
      if (.not. found) return
      u = span*(1 - at)
      do k = 1, 3
        associate (place => at + (k - 1)*(1 - at)/2)
          right(k) = -parabola(new%omega_squared - old%omega_squared, place)*value_of(gap, place) - &
                     parabola(new%rate - old%rate, place)*derivative_of(c, place)/span
        end associate
      end do
      w = parabola(new%omega_squared, (1 + at)/2)
      d = parabola(new%rate, (1 + at)/2)
      y(2) = right(1)
      y(3) = (4*right(2) - 3*right(1) - right(3))/max(u, tiny(u)) - d*y(2)
      y(4) = 4*(right(1) - 2*right(2) + right(3))/max(u**2, tiny(u)) - w*y(2) - d*y(3)
      y(5) = -w*y(3) - d*y(4)
      y(6) = -w*y(4) - d*y(5)
      next%x = next%x + u**2*(y(2)/2 + u*(y(3)/6 + u*(y(4)/24 + u*(y(5)/120 + u*y(6)/720))))
      next%v = next%v + u*(y(2) + u*(y(3)/2 + u*(y(4)/6 + u*(y(5)/24 + u*y(6)/120))))
      t = steps%osc%static_deflection + by_errors(new%pull, error)
      next%r = t(3)
      wrong = .false.
      do j = 1, p
        t = by_errors(new%touching(:, :, j), error)
        next%gap(j) = next%x - t(3)
        wrong = wrong .or. (btest(next%set, j - 1) .neqv. next%gap(j) > 0)
      end do
    end associate
  end subroutine change

  !> Integrates a step in small parts. A pair that closes or opens within a part does so at the zero of the straight line through
  !> the gaps at its ends.
  pure subroutine go_through(steps, error, step, period, span, state, motion)
    type(quick_steps_t), intent(inout) :: steps
    real(dp), intent(in) :: error(most_pairs, 3)           ! profile errors of the pairs at the nodes, m
    integer, intent(in) :: step, period
    real(dp), intent(in) :: span
    type(state_t), intent(inout) :: state
    type(quick_motion_t), intent(inout) :: motion
    integer, parameter :: parts = 24
    type(state_t) :: before
    real(dp) :: at, from, r(3), to
    integer :: j, k

    do k = 1, parts
      from = (k - 1.0_dp)/parts
      to = real(k, dp)/parts
      before = state
      call go_on(steps, error, step, span, from, to, state)
      associate (p => steps%pairs(step))
        do j = 1, p
          state%gap(j) = state%x - parabola(by_errors(steps%law(state%set, step)%touching(:, :, j), error), to)
          if (btest(state%set, j - 1) .neqv. state%gap(j) > 0) exit
        end do
        if (j <= p) then
          at = before%gap(j)/(before%gap(j) - state%gap(j))
          at = from + (to - from)*merge(at, 0.0_dp, at > 0 .and. at < 1)
          state = before
          call go_on(steps, error, step, span, from, at, state)
          state%set = ieor(state%set, ibset(0, j - 1))
          call go_on(steps, error, step, span, at, to, state)
        end if
        call close_gaps(steps, error, step, to, state)
        do j = 1, p
          call raise(steps, step, period, to, parabola(steps%law(state%set, step)%effective(j, :), to)*state%gap(j), j, motion)
        end do
      end associate
    end do
    r = steps%osc%static_deflection + by_errors(steps%law(state%set, step)%pull, error)
    state%r = r(3)
  end subroutine go_through

  !> Integrates the motion over a part of a step under the law of its contact set.
  pure subroutine go_on(steps, error, step, span, from, to, state)
    type(quick_steps_t), intent(inout) :: steps
    real(dp), intent(in) :: error(most_pairs, 3)           ! profile errors of the pairs at the nodes, m
    integer, intent(in) :: step
    real(dp), intent(in) :: span, from, to
    type(state_t), intent(inout) :: state
    real(dp) :: r(3, 1), x(1), v(1)

    if (.not. steps%law(state%set, step)%is_known) call need_law(steps, state%set, step)
    r(:, 1) = steps%osc%static_deflection + by_errors(steps%law(state%set, step)%pull, error)
    x = state%x
    v = state%v
    call advance(steps%law(state%set, step), span, from, to, 1, r, x, v)
    state%x = x(1)
    state%v = v(1)
  end subroutine go_on

  !> Finds the largest loads within a step.
  pure subroutine look_inside(steps, error, step, period, span, state, next, motion)
    type(quick_steps_t), intent(in) :: steps
    real(dp), intent(in) :: error(most_pairs, 3)           ! profile errors of the pairs at the nodes, m
    integer, intent(in) :: step, period
    real(dp), intent(in) :: span
    type(state_t), intent(in) :: state, next
    type(quick_motion_t), intent(inout) :: motion
    integer, parameter :: parts = 8
    real(dp) :: c(0:5), load(0:parts), t(3), off
    integer :: j, k

    associate (law => steps%law(state%set, step))
      c = course(law, span, state, next)
      do j = 1, steps%pairs(step)
        if (.not. btest(state%set, j - 1)) cycle
        t = by_errors(law%touching(:, :, j), error)
        do k = 0, parts
          associate (at => real(k, dp)/parts)
            load(k) = parabola(law%effective(j, :), at)*(value_of(c, at) - parabola(t, at))
          end associate
        end do
        k = maxloc(load, 1) - 1
        call raise(steps, step, period, real(k, dp)/parts, load(k), j, motion)
        k = max(1, min(parts - 1, k))
        off = (load(k + 1) - load(k - 1))/2
        associate (curve => 2*load(k) - load(k + 1) - load(k - 1))
          if (abs(off) < curve) call raise(steps, step, period, (k + off/curve)/parts, load(k) + off**2/(2*curve), j, motion)
        end associate
      end do
    end associate
  end subroutine look_inside

  !> Raises the largest load.
  pure subroutine raise(steps, step, period, at, load, j, motion)
    type(quick_steps_t), intent(in) :: steps
    integer, intent(in) :: step, period, j
    real(dp), intent(in) :: at                   ! place in the step, 0 to 1
    real(dp), intent(in) :: load                 ! N
    type(quick_motion_t), intent(inout) :: motion

    if (load <= motion%peak) return
    motion%peak = load
    motion%pair = period - (j + steps%offset(step) - 1)
    motion%place = steps%left(step) + at*steps%width(step) + (j + steps%offset(step) - 1)
  end subroutine raise

  !> Integrates the motion at one speed over a step.
  pure subroutine follow_step(steps, maps, error, step, period, lane, state, motion)
    type(quick_steps_t), intent(inout) :: steps
    type(quick_maps_t), intent(inout) :: maps
    real(dp), intent(in) :: error(most_pairs, 3)           !< profile errors of the pairs at the nodes, m
    integer, intent(in) :: step, period, lane
    type(state_t), intent(inout) :: state        !< x, its derivative and the contact set; in: at the start, out: at the end
    type(quick_motion_t), intent(inout) :: motion
    type(state_t) :: next
    real(dp) :: bend, r(3), span, top, touching(3, most_pairs)
    real(dp), dimension(most_pairs) :: between, bound, curve, hollow, right
    logical :: inside, wrong
    integer :: j

    if (steps%begins(step)) call begin_interval(steps, error, step, period, state, motion)
    if (.not. maps%is_known(state%set, step)) call need_map(steps, state%set, step, maps)
    span = steps%width(step)*maps%turning(lane)
    associate (law => steps%law(state%set, step), map => maps%of(lane, :, :, state%set, step))
      r = steps%osc%static_deflection + by_errors(law%pull, error)
      touching = 0
      do j = 1, steps%pairs(step)
        touching(:, j) = by_errors(law%touching(:, :, j), error)
      end do
      state%r = r(1)
      state%gap = state%x - touching(1, :)
      next%x = sum(map(:, 1)*[state%x, state%v, r])
      next%v = sum(map(:, 2)*[state%x, state%v, r])
      next%r = r(3)
      next%set = state%set
      next%gap = next%x - touching(3, :)
      ! By the cubic through the states at the ends, x in the middle is the mean plus `bend`; a pair's gap increases by the
      ! difference between the mean of its touching deflections and that in the middle. The parabola through the three gaps may
      ! touch zero in between.
      bend = span/8*(state%v - next%v)
      hollow = (touching(1, :) + touching(3, :))/2 - touching(2, :)
      right = law%sense*next%gap + law%spare
      curve = -2*law%sense*(bend + hollow)
      between = law%sense*(state%gap + next%gap)/2 - curve/2 + law%spare
      wrong = any(right <= 0)
      inside = any(abs(next%gap - state%gap) < 2*curve .and. 8*curve*between <= (next%gap - state%gap)**2 .and. right > 0)
      bound = law%stiffest*(merge(state%gap, next%gap, state%gap > next%gap) + 1.25_dp*abs(bend + hollow))
      top = 0
      if (any(bound > motion%peak) .or. wrong) top = top_load(law, span, hollow, state, next)
    end associate
    if (wrong) then
      if (top <= motion%peak .and. .not. inside) call change(steps, error, step, span, state, next, wrong)
      if (.not. wrong) wrong = top_load(steps%law(next%set, step), span, hollow, state, next) > motion%peak
    end if
    if (wrong .or. inside) then
      next = state
      call go_through(steps, error, step, period, span, next, motion)
    else if (top > motion%peak) then
      call look_inside(steps, error, step, period, span, state, next, motion)
    end if
    state = next
  end subroutine follow_step

  !> Finds the pairs in contact at the start of an interval, and their loads.
  pure subroutine begin_interval(steps, error, step, period, state, motion)
    type(quick_steps_t), intent(inout) :: steps
    real(dp), intent(in) :: error(most_pairs, 3)           ! profile errors of the pairs at the nodes, m
    integer, intent(in) :: step, period
    type(state_t), intent(inout) :: state
    type(quick_motion_t), intent(inout) :: motion
    integer :: j

    call close_gaps(steps, error, step, 0.0_dp, state)
    associate (law => steps%law(state%set, step))
      do j = 1, steps%pairs(step)
        call raise(steps, step, period, 0.0_dp, law%effective(j, 1)*state%gap(j), j, motion)
      end do
    end associate
  end subroutine begin_interval
end module gearsweep_motion_quick_steps
