!> Motion of pairs as springs by the classical Runge-Kutta method, on tables of their loads over the deflection, for tests of
!> springs of one pair (`mesh_t%spacing`), without friction and coast flanks.
module test_support_springs_in_motion
  use gearsweep_base_error, only: error_t
  use gearsweep_base_kinds, only: dp
  use gearsweep_base_sorting, only: sorted
  use gearsweep_face_springs, only: springs_of_pair
  use gearsweep_motion_oscillator, only: make_oscillator, oscillator_t
  use test_support_testing, only: check_no_error, tally_t
  implicit none
  private
  public :: table_t, steps, set_in_motion, tabulate_springs, add_up, march

  !> Steps of a mesh period.
  integer, parameter :: steps = 240

  !> Loads of the pairs over the deflection at the half steps of a mesh period.
  type :: table_t
    real(dp), allocatable :: deflection(:, :)    !< m; (load, half step)
    real(dp), allocatable :: force(:, :, :)      !< N; (load, pair, half step)
  end type table_t

contains

  !> Completes an oscillator whose mesh has its springs: 25 teeth, masses of 1 kg, a damping ratio of 0.07, this load (N).
  subroutine set_in_motion(t, load, osc)
    type(tally_t), intent(inout) :: t
    real(dp), intent(in) :: load
    type(oscillator_t), intent(inout) :: osc
    type(error_t), allocatable :: error

    osc%mesh%teeth = 25
    osc%mass = 1
    osc%load = load
    osc%damping_ratio = 0.07_dp
    call make_oscillator(osc, error)
    call check_no_error(t, 'oscillator', error)
  end subroutine set_in_motion

  !> Base pitches from one spring of a pair to the next, which is also the largest number of pairs.
  pure integer function spacing_of(osc) result(spacing)
    type(oscillator_t), intent(in) :: osc

    spacing = ceiling(osc%mesh%contact_ratio)
  end function spacing_of

  !> Computes the load (N) of each pair at a mesh phase and a deflection (m), and the stiffness of all (N/m), from their springs.
  pure subroutine add_up(osc, phase, x, force, stiffness)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: phase, x
    real(dp), intent(out) :: force(:), stiffness
    real(dp) :: s
    integer :: j, m

    force = 0
    stiffness = 0
    do j = 1, size(force)
      s = max(phase, 1e-9_dp) + (j - 1)
      if (s > osc%mesh%contact_ratio) cycle
      do m = 0, merge(springs_of_pair, 1, osc%mesh%spacing > 0) - 1
        associate (e => osc%mesh%profile_error%value(s - m*spacing_of(osc)), k => osc%mesh%stiffness%value(s - m*spacing_of(osc)))
          if (.not. x > e) cycle
          force(j) = force(j) + k*(x - e)
          stiffness = stiffness + k
        end associate
      end do
    end do
  end subroutine add_up

  !> Tabulates the loads of the pairs over the deflection, at each half step at those deflections at which a spring begins to carry:
  !> between them the loads are linear.
  pure subroutine tabulate_springs(osc, table)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(out) :: table
    real(dp), allocatable :: corner(:)
    real(dp) :: s, slope
    integer :: at, i, j, m, n, springs

    springs = merge(springs_of_pair, 1, osc%mesh%spacing > 0)
    associate (p => spacing_of(osc))
      allocate (corner(springs*p + 1), table%deflection(springs*p + 1, 0:2*steps), table%force(springs*p + 1, p, 0:2*steps))
      do at = 0, 2*steps
        n = 0
        do j = 1, p
          do m = 0, springs - 1
            s = at/(2.0_dp*steps) + (j - 1) - m*p
            n = n + 1
            corner(n) = osc%mesh%profile_error%value(min(s, osc%mesh%contact_ratio - m*p))
          end do
        end do
        corner(n + 1) = maxval(corner(:n)) + 1
        corner = sorted(corner)
        table%deflection(:, at) = corner
        do i = 1, size(corner)
          call add_up(osc, at/(2.0_dp*steps), corner(i), table%force(i, :, at), slope)
        end do
      end do
    end associate
  end subroutine tabulate_springs

  !> Interpolates the loads of the pairs (N) and the tangent stiffness of the mesh (N/m) at a half step and a deflection (m).
  pure subroutine look_up(table, at, x, force, stiffness)
    type(table_t), intent(in) :: table
    integer, intent(in) :: at
    real(dp), intent(in) :: x
    real(dp), intent(out) :: force(:), stiffness
    integer :: low, high, middle

    force = 0
    stiffness = 0
    low = lbound(table%deflection, 1)
    high = ubound(table%deflection, 1)
    if (.not. x > table%deflection(low, at)) return
    do while (high - low > 1)
      middle = (low + high)/2
      if (x < table%deflection(middle, at)) then
        high = middle
      else
        low = middle
      end if
    end do
    associate (left => table%deflection(low, at), right => table%deflection(high, at), f => table%force(low, :, at), &
               g => table%force(high, :, at))
      force = f + (g - f)*(x - left)/(right - left)
      stiffness = sum(g - f)/(right - left)
    end associate
  end subroutine look_up

  !> Marches 60 mesh periods of this duration (s) by the classical Runge-Kutta method, and finds the largest force of the mesh and
  !> of a pair over the load in the last three.
  subroutine march(osc, table, duration, is_even, state, largest)
    type(oscillator_t), intent(in) :: osc
    type(table_t), intent(in) :: table
    real(dp), intent(in) :: duration
    logical, intent(in) :: is_even               ! a constant damping coefficient; false: it follows the stiffness
    real(dp), intent(inout) :: state(2)
    real(dp), intent(out) :: largest(2)
    real(dp) :: rate(2, 4), h, force(size(table%force, 2)), stiffness
    integer :: period, step

    h = duration/steps
    largest = 0
    do period = 1, 60
      do step = 0, steps - 1
        rate(:, 1) = change(2*step, state)
        rate(:, 2) = change(2*step + 1, state + h/2*rate(:, 1))
        rate(:, 3) = change(2*step + 1, state + h/2*rate(:, 2))
        rate(:, 4) = change(2*step + 2, state + h*rate(:, 3))
        state = state + h/6*(rate(:, 1) + 2*rate(:, 2) + 2*rate(:, 3) + rate(:, 4))
        if (period < 58) cycle
        call look_up(table, 2*step + 2, state(1), force, stiffness)
        largest = max(largest, [sum(force), maxval(force)]/osc%load)
      end do
    end do

  contains

    !> Derivative of deflection and its rate at a half step.
    pure function change(at, state) result(rate)
      integer, intent(in) :: at
      real(dp), intent(in) :: state(2)
      real(dp) :: rate(2), force(size(table%force, 2)), stiffness

      call look_up(table, at, state(1), force, stiffness)
      associate (mobility => sum(1/osc%mass))
        rate = [state(2), mobility*(osc%load - sum(force)) &
                - 2*osc%damping_ratio*merge(osc%natural_frequency, sqrt(mobility*stiffness), is_even)*state(2)]
      end associate
    end function change
  end subroutine march
end module test_support_springs_in_motion
