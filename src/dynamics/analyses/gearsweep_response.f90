!> The steady motion at one speed, followed over the path of contact.
module gearsweep_response
  use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
  use gearsweep_coefficients, only: resolution_t, scheme_collocation
  use gearsweep_contact_set, only: period_t
  use gearsweep_error_estimate, only: accuracy_t, point_t
  use gearsweep_kinds, only: dp
  use gearsweep_memory, only: has_memory
  use gearsweep_motion_summary, only: motion_summary_t, summarise
  use gearsweep_operating_point, only: solve_point
  use gearsweep_oscillator, only: mesh_period, oscillator_t
  use gearsweep_period, only: run_period
  use gearsweep_period_map, only: discretise, period_map_t, set_durations
  use gearsweep_periodic_orbit, only: distance, near, shoot, solve_full_contact, steady_t
  use gearsweep_refinement, only: levels_t
  use gearsweep_status, only: has_result
  use gearsweep_trace, only: trace_t, pair_paths
  use gearsweep_transient, only: by_marching
  implicit none
  private
  public :: response_t, find_response, trace_motion

  type :: response_t
    real(dp) :: rpm = 0                          !< speed of the pinion, 1/min
    type(point_t) :: point
    logical :: lacks = .false.                   !< the memory does not hold it: no rows
    !> One row for each place on the paths of contact; without a result a single one of NaN. A motion that repeats
    !> after several mesh periods has as many different pairs, which come one after the other.
    integer, allocatable :: pair(:)              !< 1, 2 ...; (row)
    real(dp), allocatable :: s(:)                !< path coordinate of the pair, ascending, base pitches; (row)
    real(dp), allocatable :: load(:)             !< of that pair, N; (row)
    real(dp), allocatable :: error(:)            !< dynamic transmission error, m; (row)
    type(motion_summary_t) :: summary            !< where it is asked for and there is a result
  end type response_t

contains

  !> The pairs' loads and the transmission error over the path, in at least 200 steps of a period unless their number is
  !> given.
  pure subroutine find_response(osc, rpm, options, response, known, harmonics)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm                  !< speed of the pinion, 1/min
    type(accuracy_t), intent(in) :: options
    type(response_t), intent(out) :: response
    type(point_t), intent(in), optional :: known  !< as a sweep found it; without it, it is solved by itself
    integer, intent(in), optional :: harmonics    !< with it there is a summary, with so many of the mesh frequency
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

  !> The mesh periods after which the motion of a point with a result repeats, each in at least 200 steps unless their number is
  !> given; or in half as many, which tells how exact what is read off it is.
  pure subroutine trace_motion(osc, duration, options, point, trace, lacks, in_half)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration             !< of a mesh period, s
    type(accuracy_t), intent(in) :: options
    type(point_t), intent(in) :: point
    type(trace_t), allocatable, intent(out) :: trace(:)    !< (mesh period)
    logical, intent(out) :: lacks                !< the memory does not hold it
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

  !> At least `fewest` steps, and the state from which the motion of the point repeats in them.
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
      ! The motion that the point has, where more steps lead elsewhere.
      state = point%steady%state
      call discretise(osc, resolution, map)
    end if
  end subroutine refine
end module gearsweep_response
