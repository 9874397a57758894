!> One operating point to a tolerance: the number of steps follows from an error estimate by step doubling.
module gearsweep_accuracy
  use gearsweep_kinds, only: dp, pi
  use gearsweep_gauss, only: order, lanes
  use gearsweep_motion, only: oscillator_t, resolution_t, table_t, tabulate, graded_steps
  use gearsweep_maps, only: maps_t, begin_maps
  use gearsweep_steady, only: steady_t, steady_options_t, find_steady, find_in_lanes, solve_in_contact, settled, shoot, &
                              distance, near, unbounded, by_shooting
  use gearsweep_status, only: has_result, status_inexact, status_marginal, status_unresolved
  implicit none
  private
  public :: accuracy_t, tables_t, point_t, solve_point, solve_lanes, mesh_period

  real(dp), parameter :: root = 1.0_dp/order
  integer, parameter :: most_trials = 12

  type :: accuracy_t
    type(steady_options_t) :: steady
    integer :: steps = 0                         !< a period; 0: chosen for the tolerance
    integer :: most_steps = 2**18                !< a period; fewer where more than four pairs touch
  end type accuracy_t

  !> The answer at one speed.
  type :: point_t
    type(steady_t) :: steady
    real(dp) :: dynamic_factor = 0
    real(dp) :: estimate = 0                     !< of the error of the dynamic factor
    real(dp) :: step_error = 0                   !< its part that more steps reduce
    real(dp) :: work = 0                         !< steps in all, on every table tried; not told by lanes
    integer :: steps = 0                         !< of the period
    type(resolution_t) :: resolution             !< of the table that has them
  end type point_t

  !> Resolutions come in rungs of 2**(1/3), so that many speeds share a table; a table of half the steps
  !> lies `octave` rungs below.
  integer, parameter :: octave = 3, most_rungs = 48

  type :: rung_t
    type(table_t), allocatable :: table
  end type rung_t

  !> Tables made so far, and where the next point may start looking.
  type :: tables_t
    type(rung_t) :: rung(0:most_rungs)
    logical :: made(0:most_rungs) = .false.
    logical :: lacks = .false.                   !< the memory did not hold one: points have no answer
    real(dp) :: steps_per_second = 0             !< wanted by the last point, over its period
    type(maps_t) :: maps
  end type tables_t

contains

  !> Duration of one mesh period (s).
  elemental real(dp) function mesh_period(teeth, rpm)
    integer, intent(in) :: teeth
    real(dp), intent(in) :: rpm

    mesh_period = 60/(teeth*rpm)
  end function mesh_period

  elemental type(resolution_t) function resolution_of(rung)
    integer, intent(in) :: rung

    resolution_of = resolution_t(6*2**(modulo(rung, octave)/real(octave, dp)), 2**(rung/octave))
  end function resolution_of

  !> Steps of a period, before those that the breaks add.
  elemental real(dp) function rung_steps(rung)
    integer, intent(in) :: rung

    rung_steps = 6*2**(rung/real(octave, dp))
  end function rung_steps

  !> The first rung with at least `steps`, and a table of half as many.
  pure integer function rung_for(steps) result(rung)
    real(dp), intent(in) :: steps

    rung = min(most_rungs, octave + max(0, ceiling(octave*log(max(steps, 12.0_dp)/12)/log(2.0_dp) - 1e-9_dp)))
  end function rung_for

  !> Makes the tables of a rung and of its half, unless they are there. Of the
  !> large ones no others are kept: one of 2**18 steps takes 0.2 GB.
  pure subroutine need_rungs(osc, rung, tables)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: rung
    type(tables_t), intent(inout) :: tables
    real(dp), parameter :: large = 2**15
    integer :: i

    do i = 0, merge(most_rungs, -1, rung_steps(rung) > large .and. .not. tables%made(rung))
      if (rung_steps(i) <= large .or. i == rung - octave) cycle
      if (allocated(tables%rung(i)%table)) deallocate (tables%rung(i)%table)
      tables%made(i) = .false.
    end do
    do i = rung - octave, rung, octave
      if (.not. allocated(tables%rung(i)%table)) allocate (tables%rung(i)%table)
      if (.not. tables%made(i)) call tabulate(osc, resolution_of(i), tables%rung(i)%table)
      tables%made(i) = tables%rung(i)%table%steps > 0
      if (.not. tables%made(i)) tables%lacks = .true.
    end do
  end subroutine need_rungs

  !> Steady motion for a period of `duration` (s) on the branch `start` leads to.
  pure subroutine solve_point(osc, duration, options, tables, point, start)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration
    type(accuracy_t), intent(in) :: options
    type(tables_t), intent(inout) :: tables
    type(point_t), intent(out) :: point
    real(dp), intent(in), optional :: start(2)
    type(resolution_t) :: graded
    real(dp) :: least
    integer :: rung, last, trial
    logical :: done

    point%steady%status = status_unresolved
    if (tables%lacks) return
    if (options%steps > 0) then
      call solve_with_steps(osc, duration, options, tables, point, start)
      return
    end if
    graded = graded_resolution(osc, [duration], options, tables)
    if (graded%graded_for > 0) then
      call solve_one_graded(osc, duration, options, graded, tables, point, done, start)
      if (done) return
    end if
    point%steady%status = status_unresolved
    least = 2*resolving_steps(osc, duration)
    last = last_rung(osc, options)
    if (rung_steps(last) < least) return
    rung = min(last, rung_for(max(least, first_guess(osc, duration, options, tables))))
    do trial = 1, most_trials
      call need_rungs(osc, rung, tables)
      if (tables%lacks) exit
      call solve_on(osc, tables%rung(rung)%table, tables%rung(rung - octave)%table, duration, options, point, start)
      point%resolution = resolution_of(rung)
      if (.not. has_result(point%steady%status)) exit
      call next_rung(osc, options, point%step_error, duration, tables, rung, done)
      if (done) exit
    end do
    if (tables%lacks) point%steady%status = status_unresolved
    call note_inexact(options, point)
  end subroutine solve_point

  !> The same without `start` at several speeds at once, where Newton's method settles: `solved`. Wants
  !> the number of steps chosen.
  pure subroutine solve_lanes(osc, duration, options, tables, points, solved)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration(lanes)
    type(accuracy_t), intent(in) :: options
    type(tables_t), intent(inout) :: tables
    type(point_t), intent(out) :: points(lanes)
    logical, intent(out) :: solved(lanes)
    ! For the half's Newton iterations: of its solution, a twentieth counts.
    real(dp), parameter :: most_lane_steps = 4096, loose = 1000
    type(steady_t) :: half(lanes), full(lanes)
    type(resolution_t) :: graded
    real(dp) :: least, longest
    integer :: rung, trial
    logical :: done

    solved = .false.
    if (tables%lacks) return
    longest = maxval(duration)
    graded = graded_resolution(osc, duration, options, tables)
    if (graded%graded_for > 0) then
      call solve_graded(osc, duration, options, graded, tables, points, solved)
      if (any(solved)) return
      points = point_t(steady_t(), resolution=resolution_t())
    end if
    least = 2*resolving_steps(osc, longest)
    rung = rung_for(max(least, first_guess(osc, longest, options, tables)))
    do trial = 1, most_trials
      solved = .false.
      if (rung_steps(rung) > min(most_lane_steps, real(options%most_steps, dp)) .or. rung_steps(rung) < least) return
      call need_rungs(osc, rung, tables)
      if (tables%lacks) return
      call find_in_lanes(osc, tables%rung(rung - octave)%table, duration, loose*options%steady%tolerance, tables%maps, half)
      if (.not. any(settled(half))) return
      call find_in_lanes(osc, tables%rung(rung)%table, duration, options%steady%tolerance, tables%maps, full, half)
      points%steady = full
      solved = settled(half) .and. settled(full)
      if (.not. any(solved)) return
      call compare(osc, duration, half, points)
      points%steps = tables%rung(rung)%table%steps
      points%resolution = resolution_of(rung)
      call next_rung(osc, options, maxval(points%step_error, mask=solved), longest, tables, rung, done)
      if (done) exit
    end do
    call note_inexact(options, points)
  end subroutine solve_lanes

  !> Steps that grow behind each break, as many as the tolerance should want for these periods (s), where
  !> they are fewer than half of equal ones; else none.
  pure type(resolution_t) function graded_resolution(osc, duration, options, tables) result(resolution)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration(:)
    type(accuracy_t), intent(in) :: options
    type(tables_t), intent(in) :: tables
    ! Half of the table a radian behind the break, at 1e-6 or more.
    real(dp), parameter :: dense = 0.8_dp
    real(dp) :: shortest, longest, equal

    shortest = minval(duration)
    longest = maxval(duration)
    equal = max(2*resolving_steps(osc, longest), first_guess(osc, longest, options, tables))
    resolution = resolution_t(dense*max(1.0_dp, 1e-6_dp/options%steady%tolerance)**root*longest/shortest, 2, shortest)
    if (options%steady%method /= by_shooting .or. graded_steps(osc, resolution) > min(equal/2, real(options%most_steps, dp))) &
      resolution = resolution_t()
  end function graded_resolution

  !> One speed or all lanes in such steps, from a first resolution on. `solved` where all pairs stay in
  !> contact: a change of contact would want short steps behind it, too.
  pure subroutine solve_graded(osc, duration, options, first, tables, points, solved)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration(:)
    type(accuracy_t), intent(in) :: options
    type(resolution_t), intent(in) :: first
    type(tables_t), intent(inout) :: tables
    type(point_t), intent(inout) :: points(:)
    logical, intent(out) :: solved(:)
    type(steady_t) :: half(size(duration)), full(size(duration))
    type(table_t) :: fine, coarse
    type(resolution_t) :: resolution
    real(dp) :: excess
    integer :: trial

    resolution = first
    do trial = 1, most_trials
      solved = .false.
      call tabulate(osc, resolution, fine)
      tables%lacks = fine%steps == 0
      if (tables%lacks) return
      call hold(osc, fine, duration, options, tables, full)
      points%steady = full
      solved = in_contact(full)
      if (.not. any(solved)) return
      call tabulate(osc, resolution_t(resolution%base, 1, resolution%graded_for), coarse)
      tables%lacks = coarse%steps == 0
      if (tables%lacks) solved = .false.
      if (tables%lacks) return
      call hold(osc, coarse, duration, options, tables, half)
      solved = solved .and. in_contact(half)
      points%steps = fine%steps
      points%work = points%work + 2*(fine%steps + coarse%steps)
      points%resolution = resolution
      call compare(osc, duration, half, points)
      ! In coarse steps a pair may seem to part.
      excess = 10
      if (any(solved)) excess = maxval(points%step_error, mask=solved)/options%steady%tolerance
      if (excess <= 1) exit
      resolution%base = resolution%base*min(1.2_dp*excess**0.2_dp, 4.0_dp)
      if (graded_steps(osc, resolution) > options%most_steps) exit
    end do
    call note_inexact(options, points)
  end subroutine solve_graded

  !> Motions with all pairs in contact, at one speed or in all lanes.
  pure subroutine hold(osc, table, duration, options, tables, steady)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    real(dp), intent(in) :: duration(:)
    type(accuracy_t), intent(in) :: options
    type(tables_t), intent(inout) :: tables
    type(steady_t), intent(out) :: steady(:)
    real(dp) :: state(2)

    if (size(duration) == lanes) then
      call find_in_lanes(osc, table, duration, options%steady%tolerance, tables%maps, steady)
    else
      call begin_maps(table, tables%maps)
      call solve_in_contact(osc, table, duration(1), tables%maps, state, steady(1))
    end if
  end subroutine hold

  elemental logical function in_contact(steady)
    type(steady_t), intent(in) :: steady

    in_contact = settled(steady) .and. .not. steady%partial
  end function in_contact

  !> The same for one speed; on the branch `start` leads to.
  pure subroutine solve_one_graded(osc, duration, options, resolution, tables, point, solved, start)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration
    type(accuracy_t), intent(in) :: options
    type(resolution_t), intent(in) :: resolution
    type(tables_t), intent(inout) :: tables
    type(point_t), intent(inout) :: point
    logical, intent(out) :: solved
    real(dp), intent(in), optional :: start(2)
    type(point_t) :: points(1)
    logical :: all_solved(1)

    call solve_graded(osc, [duration], options, resolution, tables, points, all_solved)
    solved = all_solved(1)
    if (solved .and. present(start)) solved = distance(osc, duration, points(1)%steady%state - start) < near
    if (solved) point = points(1)
  end subroutine solve_one_graded

  !> Whether an error of the last rung is small enough; if not, the rung to try next.
  pure subroutine next_rung(osc, options, step_error, duration, tables, rung, done)
    type(oscillator_t), intent(in) :: osc
    type(accuracy_t), intent(in) :: options
    real(dp), intent(in) :: step_error, duration
    type(tables_t), intent(inout) :: tables
    integer, intent(inout) :: rung
    logical, intent(out) :: done
    real(dp) :: excess

    excess = min(step_error/options%steady%tolerance, 1e8_dp)
    tables%steps_per_second = rung_steps(rung)*min(max((2.5_dp*excess)**root, 0.5_dp), 2.0_dp)/duration
    done = excess <= 1 .or. rung >= last_rung(osc, options)
    if (.not. done) rung = min(rung_for(rung_steps(rung)*min(1.1_dp*excess**root, 4.0_dp)), last_rung(osc, options))
  end subroutine next_rung

  !> The finest rung that `options` and the memory allow.
  pure integer function last_rung(osc, options) result(rung)
    type(oscillator_t), intent(in) :: osc
    type(accuracy_t), intent(in) :: options
    real(dp) :: steps

    steps = options%most_steps*min(1.0_dp, 4.0_dp/osc%members)
    rung = min(most_rungs, floor(octave*log(steps/6)/log(2.0_dp) + 1e-9_dp))
  end function last_rung

  !> The same with the number of steps given.
  pure subroutine solve_with_steps(osc, duration, options, tables, point, start)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration
    type(accuracy_t), intent(in) :: options
    type(tables_t), intent(inout) :: tables
    type(point_t), intent(out) :: point
    real(dp), intent(in), optional :: start(2)
    type(table_t) :: fine, coarse
    type(resolution_t) :: resolution

    point%steady%status = status_unresolved
    if (options%steps < resolving_steps(osc, duration)) return
    resolution = resolution_t(options%steps/2.0_dp, 2)
    call tabulate(osc, resolution, fine)
    call tabulate(osc, resolution_t(resolution%base, 1), coarse)
    tables%lacks = fine%steps == 0 .or. coarse%steps == 0
    if (tables%lacks) return
    call solve_on(osc, fine, coarse, duration, options, point, start)
    point%resolution = resolution
    call note_inexact(options, point)
  end subroutine solve_with_steps

  elemental subroutine note_inexact(options, point)
    type(accuracy_t), intent(in) :: options
    type(point_t), intent(inout) :: point

    if (has_result(point%steady%status) .and. .not. point%estimate <= options%steady%tolerance) point%steady%status = status_inexact
  end subroutine note_inexact

  !> Solves on a table and on its half, and compares.
  pure subroutine solve_on(osc, fine, coarse, duration, options, point, start)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: fine, coarse
    real(dp), intent(in) :: duration
    type(accuracy_t), intent(in) :: options
    type(point_t), intent(inout) :: point
    real(dp), intent(in), optional :: start(2)
    type(steady_options_t) :: alike
    type(steady_t) :: half
    type(maps_t) :: maps

    call follow_or_find(osc, fine, duration, options, point%steady, start)
    point%steps = fine%steps
    point%work = point%work + point%steady%work
    if (.not. has_result(point%steady%status)) return
    if (point%steady%partial) then
      call begin_maps(coarse, maps)
      call shoot(osc, coarse, duration, options%steady%tolerance, point%steady%periods, point%steady%state, maps, half)
    else
      alike = options%steady
      alike%method = by_shooting
      call find_steady(osc, coarse, duration, alike, half)
    end if
    point%work = point%work + half%work
    call compare(osc, duration, half, point)
  end subroutine solve_on

  !> `steady` is known from fewer steps, or not yet. Where the search was long,
  !> Newton's method goes on from what it found.
  pure subroutine follow_or_find(osc, table, duration, options, steady, start)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    real(dp), intent(in) :: duration
    type(accuracy_t), intent(in) :: options
    type(steady_t), intent(inout) :: steady
    real(dp), intent(in), optional :: start(2)
    real(dp), parameter :: long = 40
    type(steady_t) :: before
    type(maps_t) :: maps
    real(dp) :: work

    work = 0
    if (has_result(steady%status) .and. steady%work > long*table%steps .and. options%steady%method == by_shooting) then
      before = steady
      call begin_maps(table, maps)
      call shoot(osc, table, duration, options%steady%tolerance, before%periods, before%state, maps, steady)
      if (has_result(steady%status) .and. distance(osc, duration, steady%state - before%state) < near) return
      work = steady%work
    end if
    call find_steady(osc, table, duration, options%steady, steady, start)
    steady%work = steady%work + work
  end subroutine follow_or_find

  !> Dynamic factor, and its error by the solution with half the steps.
  elemental subroutine compare(osc, duration, half, point)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration
    type(steady_t), intent(in) :: half
    type(point_t), intent(inout) :: point

    point%dynamic_factor = point%steady%peak/osc%load
    point%step_error = unbounded
    if (has_result(half%status)) then
      point%step_error = doubling_error(abs(point%steady%peak - half%peak)/osc%load, &
                                        max(distance(osc, duration, point%steady%state - half%state), &
                                            abs(point%steady%mark - half%mark)/osc%static_scale))
      ! Where strong drag ends contact within a step or two, the order does not show.
      if (osc%damping_ratio > 1 .and. point%steady%partial) point%step_error = 20*point%step_error
      if (point%resolution%graded_for > 0) &
        point%step_error = graded_error(point%step_error, abs(point%steady%mark - half%mark)/osc%static_scale)
      ! So near to 1 that the steps' error decides on which side.
      if (has_result(point%steady%status) .and. &
          abs(point%steady%multiplier - 1) < abs(point%steady%multiplier - half%multiplier)) point%steady%status = status_marginal
    end if
    point%estimate = point%step_error + point%steady%closure
  end subroutine compare

  !> Error of a result of sixth order from its difference to half the steps: a 63rd, three times raised,
  !> as the order is less where the stiffness is less smooth; the motion is asked too, as the peaks
  !> may differ little by chance.
  pure real(dp) function doubling_error(peak, state)
    real(dp), intent(in) :: peak, state

    doubling_error = max(peak, state/4)/20
  end function doubling_error

  !> The same in graded steps: again three times raised, as in long steps the order is less, down to the third
  !> where the stiffness is least smooth. The motion soon behind the breaks is asked in earnest, as its end
  !> has long forgotten the error there.
  pure real(dp) function graded_error(equal, behind)
    real(dp), intent(in) :: equal, behind

    graded_error = 3*max(equal, doubling_error(0.0_dp, 3*behind))
  end function graded_error

  !> Steps of a period that see the fastest natural motion: 2.6 rad of it, or of its decay, a step.
  pure real(dp) function resolving_steps(osc, duration)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration
    real(dp) :: fastest

    associate (zeta => osc%damping_ratio)
      fastest = osc%highest_frequency
      if (zeta > 1) fastest = fastest*(zeta + sqrt(zeta**2 - 1))
    end associate
    resolving_steps = fastest*duration/2.6_dp
  end function resolving_steps

  !> Steps for the tolerance, by the last point or by the phase that the
  !> natural motion goes through.
  pure real(dp) function first_guess(osc, duration, options, tables) result(steps)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration
    type(accuracy_t), intent(in) :: options
    type(tables_t), intent(in) :: tables

    if (tables%steps_per_second > 0) then
      steps = tables%steps_per_second*duration
    else
      steps = 1.2_dp*osc%natural_frequency*duration*(1e-6_dp/options%steady%tolerance)**root
    end if
    steps = max(steps, 12*(1e-6_dp/options%steady%tolerance)**root)
  end function first_guess
end module gearsweep_accuracy
