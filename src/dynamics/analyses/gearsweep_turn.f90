!> The steady motion of a gear pair whose teeth have errors of their own, over the mesh periods after which these repeat: the
!> largest load of each pair of teeth, and the dynamic transmission error.
module gearsweep_turn
  use gearsweep_error_estimate, only: accuracy_t, point_t
  use gearsweep_kinds, only: dp
  use gearsweep_motion_summary, only: gather_steps
  use gearsweep_operating_point, only: solve_point
  use gearsweep_oscillator, only: mesh_period, oscillator_t
  use gearsweep_quintic, only: bounds_of, place_of_largest, quintic, value_of
  use gearsweep_refinement, only: levels_t
  use gearsweep_response, only: trace_motion
  use gearsweep_status, only: has_result
  use gearsweep_trace, only: trace_t
  implicit none
  private
  public :: turn_t, find_turn, length_of

  type :: turn_t
    real(dp) :: rpm = 0                          !< speed of the pinion, 1/min
    type(point_t) :: point
    logical :: lacks = .false.                   !< the memory does not hold it
    !> Of each step, with a result alone: begin and length (mesh periods), and the quintic of the dynamic transmission error over 0
    !> to 1 in it (m); (step), (0:5, step)
    real(dp), allocatable :: left(:), width(:), error(:, :)
    !> Of the pair that enters with each mesh period: the largest load (N) and where on its path; (period)
    real(dp), allocatable :: load(:), place(:)
    !> Where a stress for a unit load is given, the largest stress that the pair's loads make in pinion and gear (Pa); (gear,
    !> period)
    real(dp), allocatable :: stress(:, :)
  end type turn_t

contains

  !> The motion at one speed.
  pure subroutine find_turn(osc, rpm, options, levels, turn, unit_stress)
    type(oscillator_t), intent(in) :: osc        !< with deviations in its mesh, or without: one mesh period
    real(dp), intent(in) :: rpm                  !< speed of the pinion, 1/min
    type(accuracy_t), intent(in) :: options
    type(levels_t), intent(inout) :: levels      !< of this oscillator
    type(turn_t), intent(out) :: turn
    !> Stress in pinion and gear under a unit load (Pa/N), at equal distances from A to E; (gear, place)
    real(dp), intent(in), optional :: unit_stress(:, :)
    type(trace_t), allocatable :: trace(:)
    real(dp) :: duration
    integer :: i

    turn%rpm = rpm
    duration = mesh_period(osc%mesh%teeth(1), rpm)
    call solve_point(osc, duration, options, levels, turn%point)
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

  !> How many values there are; none where there is no motion.
  pure integer function length_of(values)
    real(dp), allocatable, intent(in) :: values(:)         !< of a turn

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
          ! A tip corner takes its load where the path ends.
          along = max(0.0_dp, min(1.0_dp, along))*(size(unit_stress, 2) - 1)
          n = min(int(along), size(unit_stress, 2) - 2)
          stress(:, number) = max(stress(:, number), value_of(c, at)*(unit_stress(:, n + 1) + &
                                                                      (along - n)*(unit_stress(:, n + 2) - unit_stress(:, n + 1))))
        end do
      end do
    end do
  end subroutine read_stress
end module gearsweep_turn
