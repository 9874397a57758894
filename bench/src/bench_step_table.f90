!> Coefficients over one mesh period for methods with a given number of steps.
module bench_step_table
  use gearsweep_base_kinds, only: dp
  use gearsweep_motion_oscillator, only: oscillator_t
  implicit none
  private
  public :: step_table_t, tabulate

  !> Of each pair at the left end, the middle and the right end of each step;
  !> beyond A to E rate and stiffness are 0.
  type :: step_table_t
    logical :: aligned = .false.                 !< steps end at the breaks, where coefficients are one-sided
    real(dp), allocatable :: width(:)            !< phase
    real(dp), allocatable :: rate(:, :, :), error(:, :, :), stiffness(:, :, :)       !< (pair, place, step)
    real(dp), allocatable :: error_slope(:, :, :), stiffness_slope(:, :, :)          !< over the phase
  contains
    procedure :: raise
  end type step_table_t

contains

  subroutine tabulate(osc, steps, aligned, table)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: steps
    logical, intent(in) :: aligned
    type(step_table_t), intent(out) :: table
    real(dp), allocatable :: breaks(:), left(:)
    integer, allocatable :: counts(:)
    integer :: i, k, place

    breaks = [0.0_dp, 1.0_dp]
    associate (change => modulo(osc%mesh%contact_ratio, 1.0_dp))
      if (aligned .and. change > 0) breaks = [0.0_dp, change, 1.0_dp]
    end associate
    counts = [(max(1, nint(steps*(breaks(i + 1) - breaks(i)))), i=1, size(breaks) - 1)]
    table%aligned = aligned
    table%width = [(((breaks(i + 1) - breaks(i))/counts(i), k=1, counts(i)), i=1, size(counts))]
    left = [((breaks(i) + (breaks(i + 1) - breaks(i))*(k - 1)/counts(i), k=1, counts(i)), i=1, size(counts))]
    associate (n => size(left), p => osc%pairs)
      allocate (table%rate(p, 3, n), table%error(p, 3, n), table%stiffness(p, 3, n), source=0.0_dp)
      allocate (table%error_slope(p, 3, n), table%stiffness_slope(p, 3, n), source=0.0_dp)
    end associate
    do i = 1, size(left)
      do place = 1, 3
        call fill(osc, left(i), i, place, table)
      end do
    end do
  end subroutine tabulate

  !> Aligned: the pairs of the step's middle; else those at the place itself.
  subroutine fill(osc, left, i, place, table)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: left
    integer, intent(in) :: i, place
    type(step_table_t), intent(inout) :: table
    real(dp) :: s, decides
    integer :: j, piece

    associate (mesh => osc%mesh)
      do j = 1, osc%pairs
        s = left + table%width(i)*(place - 1)/2 + j - 1
        decides = s
        if (table%aligned) decides = left + table%width(i)/2 + j - 1
        if (decides > mesh%contact_ratio) cycle
        piece = mesh%profile_error%locate(decides)
        table%stiffness(j, place, i) = mesh%stiffness%value(s)
        table%stiffness_slope(j, place, i) = mesh%stiffness%slope(s)
        table%error(j, place, i) = mesh%profile_error%value(s, piece)
        table%error_slope(j, place, i) = mesh%profile_error%slope(s, piece)
        table%rate(j, place, i) = table%stiffness(j, place, i)*sum(1/osc%mass)
      end do
    end associate
  end subroutine fill

  !> Raises `peak` to the largest pair load in step i between two states; an
  !> aligned table takes the maximum of the cubic through loads and slopes.
  pure subroutine raise(table, i, before, state, peak)
    class(step_table_t), intent(in) :: table
    integer, intent(in) :: i
    real(dp), intent(in) :: before(2), state(2)
    real(dp), intent(inout) :: peak
    real(dp) :: load(2), slope(2)
    integer :: j

    do j = 1, size(table%rate, 1)
      load = table%stiffness(j, ::2, i)*([before(1), state(1)] - table%error(j, ::2, i))
      peak = max(peak, load(2))
      if (.not. table%aligned) cycle
      slope = table%stiffness_slope(j, ::2, i)*([before(1), state(1)] - table%error(j, ::2, i)) &
              + table%stiffness(j, ::2, i)*([before(2), state(2)] - table%error_slope(j, ::2, i))
      if (slope(1) > 0 .and. slope(2) < 0) peak = max(peak, top(load, table%width(i)*slope))
    end do
  end subroutine raise

  !> Maximum of the cubic with values `a` and slopes `d`, rising and then falling, at 0 and 1.
  pure real(dp) function top(a, d)
    real(dp), intent(in) :: a(2), d(2)
    real(dp) :: p, q, t

    p = d(1) + d(2) - 2*(a(2) - a(1))
    q = 3*(a(2) - a(1)) - 2*d(1) - d(2)
    t = d(1)/(sqrt(q**2 - 3*p*d(1)) - q)
    top = a(1) + t*(d(1) + t*(q + t*p))
  end function top
end module bench_step_table
