!> The steady motion at one speed, followed over the path of contact.
module gearsweep_response
  use gearsweep_kinds, only: dp
  use gearsweep_motion, only: oscillator_t, table_t, tabulate
  use gearsweep_period, only: period_t, maps_t, begin_maps, run_period
  use gearsweep_steady, only: has_answer
  use gearsweep_accuracy, only: accuracy_t, tables_t, point_t, solve_point, mesh_period
  use gearsweep_trace, only: trace_t, pair_path
  implicit none
  private
  public :: response_t, find_response

  type :: response_t
    real(dp) :: rpm = 0
    type(point_t) :: point
    real(dp), allocatable :: s(:)                !< path coordinate of one pair, ascending, base pitches
    real(dp), allocatable :: load(:)             !< of that pair, N
    real(dp), allocatable :: error(:)            !< dynamic transmission error, m
  end type response_t

contains

  !> One pair's load and the transmission error at pinion speed `rpm` (1/min);
  !> without rows where there is no answer. At least 200 steps a period.
  pure subroutine find_response(osc, rpm, options, response)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm
    type(accuracy_t), intent(in) :: options
    type(response_t), intent(out) :: response
    integer, parameter :: fewest = 200
    type(tables_t), allocatable :: tables
    type(accuracy_t) :: dense
    type(table_t) :: table
    type(trace_t) :: trace
    type(period_t) :: run
    type(maps_t) :: maps

    response%rpm = rpm
    allocate (tables)
    call solve_point(osc, mesh_period(osc%mesh%teeth(1), rpm), options, tables, response%point)
    if (has_answer(response%point%steady%status) .and. response%point%steps < fewest .and. options%steps == 0) then
      dense = options
      dense%steps = fewest
      call solve_point(osc, mesh_period(osc%mesh%teeth(1), rpm), dense, tables, response%point)
    end if
    allocate (response%s(0), response%load(0), response%error(0))
    if (.not. has_answer(response%point%steady%status)) return
    call tabulate(osc, response%point%resolution, table)
    call begin_maps(table, maps)
    call run_period(osc, table, mesh_period(osc%mesh%teeth(1), rpm), response%point%steady%state, maps, run, trace)
    call pair_path(trace, response%s, response%load, response%error)
  end subroutine find_response
end module gearsweep_response
