!> The steps of a mesh period in which a batch of gears goes through its turns (gearsweep_quick_turn): what nominal teeth are in
!> them, the contact laws, and the motion over a step under each law. Gears that differ in the errors of their teeth alone share
!> them all.
!>
!> The time is in radians of the mean natural motion. While one contact set holds,
!>
!>   x" = r - omega^2 x - rate x',  r = A0 + sum over the pairs of q_i e_i,
!>
!> with what gearsweep_contact_law says: the touching deflections are linear in the profile errors e_i, and so is r. Over a step
!> omega^2, the rate and r are the parabolas through their values at its begin, middle and end. So the motion at the end is linear
!> in the state at the begin and the three r, whatever the errors.
module gearsweep_quick_steps
  use gearsweep_contact_law, only: find_law_values, springs_at, springs_t
  use gearsweep_deviations, only: wave_t
  use gearsweep_interval, only: interval_t
  use gearsweep_kinds, only: dp, pi
  use gearsweep_mesh, only: mesh_t
  use gearsweep_oscillator, only: damping, mobility, oscillator_t
  use gearsweep_smooth_intervals, only: smooth_intervals
  implicit none
  private
  public :: quick_law_t, quick_steps_t, quick_maps_t, lay_steps, lay_maps, need_map, need_law, advance, by_errors, parabola

  !> Pairs that may be in contact, at most.
  integer, parameter, public :: most_pairs = 4
  !> Speeds that are followed side by side.
  integer, parameter, public :: lanes = 8

  !> The law of a contact set over a step, at its begin, middle and end.
  type :: quick_law_t
    logical :: is_known = .false.
    real(dp), dimension(3) :: omega_squared = 0, rate = 0  !< per rad^2 and rad of the mean natural motion
    real(dp) :: pull(most_pairs, 3) = 0                    !< q, per rad^2; (pair, node)
    real(dp) :: effective(most_pairs, 3) = 0               !< N/m; 0 of a pair that is apart; (pair, node)
    !> What a pair's error adds to the touching deflection of each; (pair with the error, node, pair that touches)
    real(dp) :: touching(most_pairs, 3, most_pairs) = 0
    real(dp) :: stiffest(most_pairs) = 0                   !< the largest of `effective`; (pair)
    !> The law holds while sense times the gap is above 0: 1 for a pair in contact, -1 for one apart, or, of one that is not there,
    !> above -1 m, which it always is; (pair)
    real(dp) :: sense(most_pairs) = 0, spare(most_pairs) = 1
  end type quick_law_t

  type :: quick_steps_t
    type(oscillator_t) :: osc                    !< of the nominal teeth
    integer :: steps = 0                         !< of a mesh period
    integer, allocatable :: pairs(:), offset(:)  !< as in interval_t; (step)
    logical, allocatable :: begins(:)            !< the pairs are others than before, or not what they were; (step)
    real(dp), allocatable :: left(:), width(:)   !< mesh phase; (step)
    type(interval_t), allocatable :: intervals(:)
    integer, allocatable :: interval(:)          !< (step)
    type(springs_t), allocatable :: springs(:)   !< nominal pairs at the three nodes; (step)
    real(dp), allocatable :: phase(:)            !< (node of all steps)
    !> Path coordinate less half of the contact ratio, kept between A and E; (node of all steps, pair)
    real(dp), allocatable :: along(:, :)
    real(dp), allocatable :: nominal(:, :)       !< profile errors of nominal teeth; (pair, node of all steps)
    real(dp), allocatable :: cosine(:, :), sine(:, :)      !< of a wave of phase 0; (node of all steps, wave)
    type(quick_law_t), allocatable :: law(:, :)  !< (contact set from 0, step)
  end type quick_steps_t

  !> The motions over the steps at some speeds: x and x' at the end (m) for x, x' at the begin and r at the three nodes.
  type :: quick_maps_t
    integer :: speeds = 0                        !< how many of the lanes
    real(dp) :: turning(lanes) = 0               !< mean natural motion of a mesh period, rad; (speed)
    logical, allocatable :: is_known(:, :)       !< (contact set from 0, step)
    real(dp), allocatable :: of(:, :, :, :, :)   !< (speed, cause, x or x', contact set from 0, step)
  end type quick_maps_t

contains

  !> Lays the steps of a mesh period.
  pure subroutine lay_steps(osc, waves, longest, steps)
    type(oscillator_t), intent(in) :: osc        !< of nominal teeth
    type(wave_t), intent(in) :: waves(:)         !< of the gears: gear and order count
    real(dp), intent(in) :: longest              !< length of a step, mesh phase
    type(quick_steps_t), intent(out) :: steps    !< none where more pairs than `most_pairs` may be in contact
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

  !> Adds the ends of steps from one phase to another: one step or, where the stiffness of a pair is not near its parabola, as
  !> beside A and E where a tip corner takes over, halves.
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

  !> Are the pairs at the begin of a step what they are at the end of the one before?
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

  !> Sees to it that the law of a contact set over a step is known.
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

  !> Makes room for the motions over the steps. Lanes that are left have the last speed.
  pure subroutine lay_maps(steps, turning, maps)
    type(quick_steps_t), intent(in) :: steps
    real(dp), intent(in) :: turning(:)           !< (speed), as many as there are lanes at most
    type(quick_maps_t), intent(out) :: maps

    maps%speeds = size(turning)
    maps%turning = turning(size(turning))
    maps%turning(:size(turning)) = turning
    associate (last => ubound(steps%law, 1))
      allocate (maps%is_known(0:last, steps%steps), source=.false.)
      allocate (maps%of(lanes, 5, 2, 0:last, steps%steps))
    end associate
  end subroutine lay_maps

  !> Sees to it that the motion over a step under a contact set is known.
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

  !> Follows motions over a part of a step under one law, by the classical method of Runge and Kutta.
  pure subroutine advance(law, span, from, to, parts, r, x, v)
    type(quick_law_t), intent(in) :: law
    real(dp), intent(in) :: span                 !< length of the step, rad
    real(dp), intent(in) :: from, to             !< of the step, 0 to 1
    integer, intent(in) :: parts                 !< into which this is cut
    real(dp), intent(in) :: r(:, :)              !< at the three nodes of the step, m; (3, motion)
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

  !> What is proportional to the errors of the pairs, at the nodes of a step.
  pure function by_errors(factor, error) result(values)
    real(dp), intent(in) :: factor(most_pairs, 3)          !< (pair, node)
    real(dp), intent(in) :: error(most_pairs, 3)           !< m; (pair, node)
    real(dp) :: values(3)

    values = (factor(1, :)*error(1, :) + factor(2, :)*error(2, :)) + (factor(3, :)*error(3, :) + factor(4, :)*error(4, :))
  end function by_errors

  !> The parabola through values at the begin, middle and end of a step.
  pure real(dp) function parabola(values, at)
    real(dp), intent(in) :: values(:)            !< (3)
    real(dp), intent(in) :: at                   !< 0 to 1

    parabola = values(1) + at*(4*values(2) - 3*values(1) - values(3) + 2*at*(values(1) - 2*values(2) + values(3)))
  end function parabola
end module gearsweep_quick_steps
