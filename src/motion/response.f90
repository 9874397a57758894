!> Response of a steady motion in addition to its dynamic factor: transmission error, mesh load and their harmonics, loads over
!> the path.
!>
!> The motion at one speed is integrated over the path of contact or, where teeth have errors of their own, over the mesh periods
!> after which these repeat, with the largest load of each pair of teeth. The corner estimate is the uncertainty of a dynamic
!> factor due to that of the stiffness at tip corners.
module gearsweep_motion_response
  use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
  use gearsweep_base, only: bounds_of, dp, error_t, has_memory, place_of_largest, quintic, value_of
  use gearsweep_mesh, only: corner_uncertainty
  use gearsweep_motion_attractors, only: take_largest
  use gearsweep_motion_resolution, only: resolution_t, scheme_collocation
  use gearsweep_motion_contact_set, only: period_t
  use gearsweep_motion_error_estimate, only: accuracy_t, levels_t, point_t
  use gearsweep_motion_operating_point, only: solve_point
  use gearsweep_motion_oscillator, only: make_oscillator, mesh_period, oscillator_t, touches_coast
  use gearsweep_motion_period, only: run_period
  use gearsweep_motion_period_map, only: discretise, period_map_t, set_durations
  use gearsweep_motion_periodic_orbit, only: distance, near, shoot, solve_full_contact, steady_t
  use gearsweep_motion_spectrum, only: find_spectrum, spectrum_t
  use gearsweep_motion_steady_motion, only: by_marching, has_result
  use gearsweep_motion_trace, only: pair_paths, trace_t
  implicit none
  private
  public :: motion_summary_t, summarise, response_t, find_response, trace_motion, turn_t, find_turn, length_of, &
            find_corner_estimate

  type :: motion_summary_t
    type(spectrum_t) :: error                    !< dynamic transmission error, m
    type(spectrum_t) :: load                     !< elastic load of the mesh: all pairs minus the coast sides, N
    real(dp) :: pair_rms = 0                     !< root mean square of the load on a pair over its path, N
    real(dp) :: impacts = 0                      !< impacts of flanks after all were apart, per mesh period
    real(dp) :: reversals = 0                    !< changes of the load to the other sides of the teeth, per mesh period
    real(dp) :: apart = 0                        !< part of the time during which all flanks are apart
  end type motion_summary_t

  type :: response_t
    real(dp) :: rpm = 0                          !< speed of the pinion, 1/min
    type(point_t) :: point
    logical :: lacks = .false.                   !< memory is too small: no rows
    !> One row for each place on the paths of contact; without a result a single one of NaN. A motion that repeats after several
    !> mesh periods has as many different pairs, which follow one another.
    integer, allocatable :: pair(:)              !< index of the pair from 1; (row)
    real(dp), allocatable :: s(:)                !< path coordinate of the pair, ascending, base pitches; (row)
    real(dp), allocatable :: load(:)             !< load of that pair, N; (row)
    real(dp), allocatable :: error(:)            !< dynamic transmission error, m; (row)
    type(motion_summary_t) :: summary            !< allocated on request if there is a result
  end type response_t

  type :: turn_t
    real(dp) :: rpm = 0                          !< speed of the pinion, 1/min
    type(point_t) :: point
    logical :: lacks = .false.                   !< memory is too small
    !> Steps of a motion with a result: start and length (mesh periods), and the quintic of the dynamic transmission error over 0
    !> to 1 in each (m); (step), (0:5, step)
    real(dp), allocatable :: left(:), width(:), error(:, :)
    !> Largest load of the pair that enters with each mesh period (N) and its place on the path; (period)
    real(dp), allocatable :: load(:), place(:)
    !> Largest stress from the pair's loads in pinion and gear, if a stress per unit load is specified (Pa); (gear, period)
    real(dp), allocatable :: stress(:, :)
  end type turn_t

contains

  !> Computes the summary of a motion. Its harmonics are those of the time after which it repeats: of the mesh frequency over the
  !> number of mesh periods.
  pure subroutine summarise(osc, trace, count, summary)
    type(oscillator_t), intent(in) :: osc
    type(trace_t), intent(in) :: trace(:)        !< mesh periods after which the motion repeats
    integer, intent(in) :: count                 !< number of harmonics
    type(motion_summary_t), intent(out) :: summary
    real(dp), allocatable :: left(:), width(:), error(:, :), load(:, :)

    call gather_steps(trace, 1, left, width, error)
    left = left/size(trace)
    width = width/size(trace)
    load = mesh_load(osc, trace)
    call find_spectrum(left, width, error, count, summary%error)
    call find_spectrum(left, width, load, count, summary%load)
    summary%pair_rms = mean_square_load(osc, trace)
    call count_meetings(osc, trace, summary)
  end subroutine summarise

  !> Collects the steps of a motion.
  pure subroutine gather_steps(trace, periods, left, width, error)
    type(trace_t), intent(in) :: trace(:)
    integer, intent(in) :: periods               !< number of mesh periods of each trace
    real(dp), allocatable, intent(out) :: left(:), width(:)          !< start and length, mesh periods; (step)
    !> Quintic of the dynamic transmission error over 0 to 1 in the step, m; (0:5, step)
    real(dp), allocatable, intent(out) :: error(:, :)
    integer :: i, k, n

    n = sum(trace%rows)/2
    allocate (left(n), width(n), error(0:5, n))
    n = 0
    do i = 1, size(trace)
      do k = 1, trace(i)%rows, 2
        n = n + 1
        left(n) = (i - 1)*periods + trace(i)%phase(k)
        width(n) = trace(i)%phase(k + 1) - trace(i)%phase(k)
        error(:, n) = quintic(trace(i)%x(:, k), trace(i)%x(:, k + 1))
      end do
    end do
  end subroutine gather_steps

  !> Elastic load of the mesh as a quintic in each of these steps, N; (0:5, step).
  pure function mesh_load(osc, trace) result(load)
    type(oscillator_t), intent(in) :: osc
    type(trace_t), intent(in) :: trace(:)
    real(dp) :: load(0:5, sum(trace%rows)/2)
    real(dp) :: total(0:2, 2)
    integer :: i, k, n

    n = 0
    do i = 1, size(trace)
      do k = 1, trace(i)%rows, 2
        n = n + 1
        total = sum(trace(i)%load(:, :osc%pairs, [k, k + 1]), 2)
        total = total - sum(trace(i)%load(:, osc%pairs + 1:osc%contacts, [k, k + 1]), 2)
        load(:, n) = quintic(total(:, 1), total(:, 2))
      end do
    end do
  end function mesh_load

  !> Root mean square of the load on a pair over the path on which it may be in contact.
  pure real(dp) function mean_square_load(osc, trace) result(rms)
    type(oscillator_t), intent(in) :: osc
    type(trace_t), intent(in) :: trace(:)
    type(spectrum_t) :: part
    real(dp) :: path
    integer :: i, j, k

    rms = 0
    path = 0
    do i = 1, size(trace)
      do k = 1, trace(i)%rows, 2
        associate (width => trace(i)%phase(k + 1) - trace(i)%phase(k), ends => trace(i)%load(:, :, k:k + 1))
          do j = 1, min(trace(i)%pairs(k), osc%pairs)
            call find_spectrum([0.0_dp], [1.0_dp], reshape(quintic(ends(:, j, 1), ends(:, j, 2)), [6, 1]), 0, part)
            rms = rms + width*(part%mean**2 + part%rms**2)
            path = path + width
          end do
        end associate
      end do
    end do
    rms = sqrt(rms/path)
  end function mean_square_load

  !> Counts the impacts of flanks and the changes of the loaded side, and measures the time with all flanks apart.
  pure subroutine count_meetings(osc, trace, summary)
    type(oscillator_t), intent(in) :: osc
    type(trace_t), intent(in) :: trace(:)
    type(motion_summary_t), intent(inout) :: summary
    integer, parameter :: nowhere = 0, drive = 1, coast = 2
    integer :: side, last, last_loaded, i, k, pass

    last = nowhere
    last_loaded = nowhere
    ! The first pass finds the state at the end, which precedes the start.
    do pass = 1, 2
      summary%impacts = 0
      summary%reversals = 0
      summary%apart = 0
      do i = 1, size(trace)
        do k = 1, trace(i)%rows
          side = merge(nowhere, drive, trace(i)%contact_set(k) == 0)
          if (touches_coast(osc, trace(i)%contact_set(k))) side = coast
          if (side == nowhere) then
            if (modulo(k, 2) == 1) summary%apart = summary%apart + (trace(i)%phase(k + 1) - trace(i)%phase(k))
          else
            if (last == nowhere) summary%impacts = summary%impacts + 1
            if (last_loaded /= nowhere .and. side /= last_loaded) summary%reversals = summary%reversals + 1
            last_loaded = side
          end if
          last = side
        end do
      end do
    end do
    summary%impacts = summary%impacts/size(trace)
    summary%reversals = summary%reversals/size(trace)
    summary%apart = summary%apart/size(trace)
  end subroutine count_meetings

  !> Computes the pairs' loads and the transmission error over the path, in at least 200 steps of a period unless their number is
  !> specified.
  pure subroutine find_response(osc, rpm, options, response, known, harmonics)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm                  !< speed of the pinion, 1/min
    type(accuracy_t), intent(in) :: options
    type(response_t), intent(out) :: response
    type(point_t), intent(in), optional :: known  !< result of a sweep; if absent, it is solved by itself
    integer, intent(in), optional :: harmonics    !< if present, `summary` has this many of the mesh frequency
    type(levels_t), allocatable :: levels
    type(trace_t), allocatable :: trace(:)
    real(dp) :: duration

    response%rpm = rpm
    duration = mesh_period(osc%mesh%teeth(1), rpm)
    if (present(known)) then
      response%point = known
    else
      allocate (levels)
      call solve_point(osc, duration, options, levels, response%point)
      response%lacks = levels%lacks
      if (response%lacks) return
    end if
    if (.not. has_result(response%point%steady%status)) then
      allocate (response%pair(1), source=0)
      allocate (response%s(1), response%load(1), response%error(1), source=ieee_value(1.0_dp, ieee_quiet_nan))
      return
    end if
    call trace_motion(osc, duration, options, response%point, trace, response%lacks)
    if (response%lacks) return
    call pair_paths(trace, response%pair, response%s, response%load, response%error)
    if (present(harmonics)) call summarise(osc, trace, harmonics*size(trace), response%summary)
  end subroutine find_response

  !> Integrates the mesh periods after which the motion of a point with a result repeats, each in at least 200 steps unless their
  !> number is specified; or in half as many, to estimate the error of quantities derived from it.
  pure subroutine trace_motion(osc, duration, options, point, trace, lacks, in_half)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration             !< duration of a mesh period, s
    type(accuracy_t), intent(in) :: options
    type(point_t), intent(in) :: point
    type(trace_t), allocatable, intent(out) :: trace(:)    !< (mesh period)
    logical, intent(out) :: lacks                !< memory is too small
    logical, intent(in), optional :: in_half
    ! Bytes of a step's two rows, in memory that doubles and is copied, and then sorted by pair.
    real(dp), parameter :: trace_bytes = 2*4*80.0_dp
    type(period_map_t) :: map
    type(period_t) :: run
    type(point_t) :: as_fine
    logical :: fits
    real(dp) :: state(2)
    integer :: i, fewest

    as_fine = point
    fewest = 200
    if (present(in_half)) then
      if (in_half) then
        as_fine%resolution%base = point%resolution%base/2
        as_fine%steps = point%steps/2
        fewest = fewest/2
      end if
    end if
    call refine(osc, duration, options, as_fine, fewest, map, state)
    lacks = map%steps == 0
    if (lacks) return
    call has_memory(point%steady%periods*map%steps*trace_bytes*osc%contacts, fits)
    lacks = .not. fits
    if (lacks) return
    call set_durations(map, [duration])
    allocate (trace(point%steady%periods))
    do i = 1, size(trace)
      call run_period(map, state, run, trace(i))
      state = run%state
    end do
  end subroutine trace_motion

  !> Finds at least `fewest` steps, and the state from which the motion of the point repeats in them.
  pure subroutine refine(osc, duration, options, point, fewest, map, state)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration
    type(accuracy_t), intent(in) :: options
    type(point_t), intent(in) :: point
    integer, intent(in) :: fewest
    type(period_map_t), intent(inout) :: map
    real(dp), intent(out) :: state(2)
    type(resolution_t) :: resolution
    type(steady_t) :: steady

    resolution = point%resolution
    state = point%steady%state
    if (resolution%graded_for > 0) resolution%times = resolution%times*ceiling(fewest/real(point%steps, dp))
    if (resolution%graded_for > 0 .or. resolution%scheme /= scheme_collocation .or. point%steps >= fewest .or. &
        options%steps > 0) then
      call discretise(osc, resolution, map)
      return
    end if
    call discretise(osc, resolution_t(fewest/2.0_dp, 2), map)
    if (map%steps == 0) return
    call set_durations(map, [duration])
    if (options%steady%method == by_marching) return
    if (point%steady%departs) then
      call shoot(map, options%steady%tolerance, point%steady%periods, state, steady)
    else
      call solve_full_contact(map, state, steady)
    end if
    if (has_result(steady%status) .and. distance(osc, duration, steady%state - point%steady%state) < near) then
      state = steady%state
    else
      ! Where more steps lead elsewhere, the motion of the point is kept.
      state = point%steady%state
      call discretise(osc, resolution, map)
    end if
  end subroutine refine

  !> Finds the motion at one speed; of several the one of largest dynamic factor that `take_largest` finds.
  subroutine find_turn(osc, rpm, options, levels, turn, unit_stress, start)
    type(oscillator_t), intent(in) :: osc        !< with deviations in its mesh, or without: one mesh period
    real(dp), intent(in) :: rpm                  !< speed of the pinion, 1/min
    type(accuracy_t), intent(in) :: options
    type(levels_t), intent(inout) :: levels      !< levels of this oscillator
    type(turn_t), intent(out) :: turn
    !> Stress in pinion and gear under a unit load (Pa/N), at equal distances from A to E; (gear, place)
    real(dp), intent(in), optional :: unit_stress(:, :)
    real(dp), intent(in), optional :: start(2)   !< initial state of the turn for the search of the motion, m
    type(trace_t), allocatable :: trace(:)
    type(point_t) :: point(1)
    real(dp) :: duration
    integer :: i

    turn%rpm = rpm
    duration = mesh_period(osc%mesh%teeth(1), rpm)
    call solve_point(osc, duration, options, levels, point(1), start)
    if (.not. present(start)) call take_largest(osc, [rpm], options, levels, point)
    turn%point = point(1)
    turn%lacks = levels%lacks
    if (turn%lacks .or. .not. has_result(turn%point%steady%status)) return
    call trace_motion(osc, duration, options, turn%point, trace, turn%lacks)
    if (turn%lacks) return
    associate (periods => osc%mesh%deviations%periods)
      allocate (turn%load(size(trace)*periods), turn%place(size(trace)*periods), source=0.0_dp)
      do i = 1, size(trace)
        call read_loads(trace(i), (i - 1)*periods, osc%pairs, turn)
      end do
      if (present(unit_stress)) then
        allocate (turn%stress(2, size(turn%load)), source=0.0_dp)
        do i = 1, size(trace)
          call read_stress(trace(i), (i - 1)*periods, osc%pairs, unit_stress, osc%mesh%contact_ratio, turn%stress)
        end do
      end if
      call gather_steps(trace, periods, turn%left, turn%width, turn%error)
    end associate
  end subroutine find_turn

  !> Number of values; 0 where there is no motion.
  pure integer function length_of(values)
    real(dp), allocatable, intent(in) :: values(:)         !< values of a turn

    length_of = 0
    if (allocated(values)) length_of = size(values)
  end function length_of

  !> Raises the largest loads of the pairs.
  pure subroutine read_loads(trace, before, pairs, turn)
    type(trace_t), intent(in) :: trace
    integer, intent(in) :: before                ! mesh periods before this trace
    integer, intent(in) :: pairs
    type(turn_t), intent(inout) :: turn
    real(dp) :: c(0:5), at, bounds(2), load
    integer :: j, k, number

    do k = 1, trace%rows, 2
      do j = 1, min(trace%pairs(k), pairs)
        number = 1 + modulo(before - (j + trace%offset(k) - 1), size(turn%load))
        c = quintic(trace%load(:, j, k), trace%load(:, j, k + 1))
        bounds = bounds_of(c)
        if (bounds(2) <= turn%load(number)) cycle
        at = place_of_largest(c)
        load = value_of(c, at)
        if (load <= turn%load(number)) cycle
        turn%load(number) = load
        turn%place(number) = trace%phase(k) + at*(trace%phase(k + 1) - trace%phase(k)) + (j + trace%offset(k) - 1)
      end do
    end do
  end subroutine read_loads

  !> Raises the largest stresses, at a few places of each step.
  pure subroutine read_stress(trace, before, pairs, unit_stress, contact_ratio, stress)
    type(trace_t), intent(in) :: trace
    integer, intent(in) :: before                ! mesh periods before this trace
    integer, intent(in) :: pairs
    real(dp), intent(in) :: unit_stress(:, :), contact_ratio
    real(dp), intent(inout) :: stress(:, :)
    integer, parameter :: places = 4
    real(dp) :: c(0:5), at, along
    integer :: i, j, k, n, number

    do k = 1, trace%rows, 2
      do j = 1, min(trace%pairs(k), pairs)
        number = 1 + modulo(before - (j + trace%offset(k) - 1), size(stress, 2))
        c = quintic(trace%load(:, j, k), trace%load(:, j, k + 1))
        do i = 0, places
          at = real(i, dp)/places
          along = (trace%phase(k) + at*(trace%phase(k + 1) - trace%phase(k)) + (j + trace%offset(k) - 1))/contact_ratio
          ! A load at a tip corner counts at the end of the path.
          along = max(0.0_dp, min(1.0_dp, along))*(size(unit_stress, 2) - 1)
          n = min(int(along), size(unit_stress, 2) - 2)
          stress(:, number) = max(stress(:, number), value_of(c, at)*(unit_stress(:, n + 1) + &
                                                                      (along - n)*(unit_stress(:, n + 2) - unit_stress(:, n + 1))))
        end do
      end do
    end do
  end subroutine read_stress

  !> Finds the change of the dynamic factor when the stiffness beyond A and E is reduced by `corner_uncertainty` of it; NaN where
  !> one of both has no result. With softer tip corners the motion is searched near the `known` one; without `known`, both are
  !> solved by themselves.
  subroutine find_corner_estimate(osc, rpm, options, estimate, known)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm                  !< speed of the pinion, 1/min
    type(accuracy_t), intent(in) :: options
    real(dp), intent(out) :: estimate            !< change of the dynamic factor
    type(point_t), intent(in), optional :: known
    type(oscillator_t) :: softer
    type(point_t) :: point, other
    type(error_t), allocatable :: error

    estimate = ieee_value(1.0_dp, ieee_quiet_nan)
    if (present(known)) then
      point = known
    else
      call solve(osc, point)
    end if
    if (.not. has_result(point%steady%status)) return
    softer = osc
    softer%mesh = osc%mesh%with_softer_corners(corner_uncertainty)
    call make_oscillator(softer, error)
    if (allocated(error)) return
    if (present(known)) then
      call solve(softer, other, known%steady%state)
    else
      call solve(softer, other)
    end if
    if (has_result(other%steady%status)) estimate = abs(other%dynamic_factor - point%dynamic_factor)

  contains

    subroutine solve(one, found, start)
      type(oscillator_t), intent(in) :: one
      type(point_t), intent(out) :: found
      real(dp), intent(in), optional :: start(2)
      type(levels_t), allocatable :: levels

      allocate (levels)
      call solve_point(one, mesh_period(one%mesh%teeth(1), rpm), options, levels, found, start)
    end subroutine solve
  end subroutine find_corner_estimate
end module gearsweep_motion_response
