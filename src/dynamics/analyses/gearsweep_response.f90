!> The steady motion at one speed, followed over the path of contact.
module gearsweep_response
  use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
  use gearsweep_kinds, only: dp
  use gearsweep_memory, only: has_memory
  use gearsweep_motion, only: oscillator_t, resolution_t, table_t, tabulate
  use gearsweep_period, only: period_t, maps_t, begin_maps, run_period
  use gearsweep_steady, only: by_marching, distance, near, shoot, solve_in_contact, steady_t
  use gearsweep_status, only: has_result
  use gearsweep_accuracy, only: accuracy_t, tables_t, point_t, solve_point, mesh_period
  use gearsweep_trace, only: trace_t, pair_paths
  implicit none
  private
  public :: response_t, find_response

  type :: response_t
    real(dp) :: rpm = 0
    type(point_t) :: point
    logical :: lacks = .false.                   !< the memory does not hold it: no rows
    !> One row for each place on the paths of contact; with no answer a single one of NaN. A motion that repeats
    !> after several mesh periods has as many different pairs, which come after each other.
    integer, allocatable :: pair(:)              !< 1, 2 ...
    real(dp), allocatable :: s(:)                !< path coordinate of the pair, ascending, base pitches
    real(dp), allocatable :: load(:)             !< of that pair, N
    real(dp), allocatable :: error(:)            !< dynamic transmission error, m
  end type response_t

contains

  !> The pairs' loads and the transmission error at pinion speed `rpm` (1/min), in at least 200 steps a
  !> period unless their number is given. `known` is the point as a sweep found it; without it, it is solved
  !> by itself.
  pure subroutine find_response(osc, rpm, options, response, known)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm
    type(accuracy_t), intent(in) :: options
    type(response_t), intent(out) :: response
    type(point_t), intent(in), optional :: known
    ! Of a step's two rows, in room that doubles and is copied; then sorted by pair.
    real(dp), parameter :: trace_bytes = 2*4*40.0_dp
    type(tables_t), allocatable :: tables
    type(trace_t), allocatable :: trace(:)
    type(table_t) :: table
    type(period_t) :: run
    type(maps_t) :: maps
    logical :: fits
    real(dp) :: state(2)
    integer :: i

    response%rpm = rpm
    if (present(known)) then
      response%point = known
    else
      allocate (tables)
      call solve_point(osc, mesh_period(osc%mesh%teeth(1), rpm), options, tables, response%point)
      response%lacks = tables%lacks
      if (response%lacks) return
    end if
    if (.not. has_result(response%point%steady%status)) then
      allocate (response%pair(1), source=0)
      allocate (response%s(1), response%load(1), response%error(1), source=ieee_value(1.0_dp, ieee_quiet_nan))
      return
    end if
    call refine(osc, mesh_period(osc%mesh%teeth(1), rpm), options, response%point, table, state)
    response%lacks = table%steps == 0
    if (response%lacks) return
    call has_memory(response%point%steady%periods*table%steps*trace_bytes*osc%members, fits)
    response%lacks = .not. fits
    if (response%lacks) return
    call begin_maps(table, maps)
    allocate (trace(response%point%steady%periods))
    do i = 1, size(trace)
      call run_period(osc, table, mesh_period(osc%mesh%teeth(1), rpm), state, maps, run, trace(i))
      state = run%state
    end do
    call pair_paths(trace, response%pair, response%s, response%load, response%error)
  end subroutine find_response

  !> A table of at least 200 steps, and the state from which the point's motion repeats there.
  pure subroutine refine(osc, duration, options, point, table, state)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration
    type(accuracy_t), intent(in) :: options
    type(point_t), intent(in) :: point
    type(table_t), intent(inout) :: table
    real(dp), intent(out) :: state(2)
    integer, parameter :: fewest = 200
    type(resolution_t) :: resolution
    type(steady_t) :: steady
    type(maps_t) :: maps

    resolution = point%resolution
    state = point%steady%state
    if (resolution%graded_for > 0) resolution%times = resolution%times*ceiling(fewest/real(point%steps, dp))
    if (resolution%graded_for > 0 .or. point%steps >= fewest .or. options%steps > 0) then
      call tabulate(osc, resolution, table)
      return
    end if
    call tabulate(osc, resolution_t(fewest/2.0_dp, 2), table)
    if (table%steps == 0) return
    call begin_maps(table, maps)
    if (options%steady%method == by_marching) return
    if (point%steady%partial) then
      call shoot(osc, table, duration, options%steady%tolerance, point%steady%periods, state, maps, steady)
    else
      call solve_in_contact(osc, table, duration, maps, state, steady)
    end if
    if (has_result(steady%status) .and. distance(osc, duration, steady%state - point%steady%state) < near) then
      state = steady%state
    else
      ! The motion that the point has, where more steps lead elsewhere.
      state = point%steady%state
      call tabulate(osc, resolution, table)
    end if
  end subroutine refine
end module gearsweep_response
