!> The table of coefficients of the equation of motion over one mesh period, and how finely it is cut into steps.
!> gearsweep_coefficients fills it.
module gearsweep_coefficient_table
  use gearsweep_kinds, only: dp
  use gearsweep_memory, only: has_memory
  use gearsweep_oscillator, only: oscillator_t
  implicit none
  private
  public :: resolution_t, kind_t, coefficients_t, allocate_table

  !> Methods of integration.
  integer, parameter, public :: &
    scheme_collocation = 0, &          !< Gauss collocation in steps that end at the breaks; contact events are located
    scheme_rk4 = 1, &                  !< classical Runge-Kutta in steps that end at the breaks
    scheme_rk4_equal = 2, &            !< classical Runge-Kutta in equal steps (Dogan et al. 2021)
    scheme_constant = 3                !< exact motion over equal steps with constant coefficients (Karpat et al. 2012)

  !> The method, and how finely it cuts the period into steps: each smooth interval gets `times` steps for each of its shares of
  !> `base` steps, one share at least. The steps of a larger `times` nest in those of the same base.
  type :: resolution_t
    real(dp) :: base = 0               !< steps of a period; where graded, of a radian of the natural motion behind a break
    integer :: times = 1
    real(dp) :: graded_for = 0         !< duration of the mesh period for which the steps grow behind breaks, s; 0: equal steps
    integer :: scheme = scheme_collocation
    logical :: by_load = .false.       !< smooth intervals end also where pairs begin and cease to carry the static load
  end type resolution_t

  !> What is special about a step.
  type :: kind_t
    !> A smooth interval begins, or, where steps are graded, three quarters of a cycle of the natural motion
    !> behind that.
    logical :: begins = .false.
    logical :: widens = .false.        !< a smooth interval begins, or the step before was shorter
    logical :: stiff = .false.         !< too long to follow the natural motion: integrated at Radau's points
  end type kind_t

  !> The coefficients at the three nodes of the integration and at both ends of each step, one-sided at breaks.
  type :: coefficients_t
    integer :: steps = 0               !< of the period; 0: the memory does not hold them
    integer :: contacts = 0            !< pairs at most, and the coast sides
    integer, allocatable :: interval(:)    !< smooth interval that a step lies in; (step)
    integer, allocatable :: pairs(:)       !< that may be in contact; (step)
    integer, allocatable :: full(:)        !< contact set of full contact: bit j - 1 for pair j; (step)
    integer, allocatable :: between(:)     !< the pairs between A and E, in the same way; (step)
    !> Three pairs or more share different compliances: `rate` and stiffness are those of a pair that carries alone; (step)
    logical, allocatable :: coupled(:)
    type(kind_t), allocatable :: kind(:)   !< (step)
    real(dp), allocatable :: left(:), width(:)     !< begin and length of a step, mesh phase 0 to 1; (step)
    real(dp), allocatable :: rate(:, :, :)         !< k_j, 1/s^2; (contact, node, step)
    real(dp), allocatable :: profile_error(:, :, :)    !< e_j, m; (contact, node, step)
    real(dp), allocatable :: end_rate(:, :, :)     !< k_j, 1/s^2; (pair, end, step)
    !> Own stiffness K_j (N/m) with its first and second derivative over the phase; (0:2, pair, end, step)
    real(dp), allocatable :: end_stiffness(:, :, :, :)
    !> e_j (m) with its first and second derivative over the phase; (0:2, contact, end, step)
    real(dp), allocatable :: end_profile_error(:, :, :, :)
    !> Bounds (m) of the profile errors: a motion whose tangents at the ends of the step stay above the upper one keeps the
    !> pairs of full contact in contact, and below the lower one the others apart; (step)
    real(dp), allocatable :: upper_bound(:), lower_bound(:)
    !> Sums over the pairs of full contact: omega^2 (1/s^2), k e (m/s^2), omega (rad/s); (node, step)
    real(dp), allocatable :: omega_squared(:, :), forcing(:, :), omega(:, :)
    !> Where pairs share a compliance, also their own stiffness at the nodes (N/m), (pair, node, step), and `sum_pairs` of full
    !> contact at the ends: sums of K (N/m) and K e (N), with derivatives over the phase, (0:2, of K or K e, end, step).
    real(dp), allocatable :: node_stiffness(:, :, :), end_sums(:, :, :, :)
    !> And what neighbours share (m/N): at the nodes, (pair but the last, node, step), and at the ends with its derivatives over
    !> the phase, (0:2, pair but the last, end, step).
    real(dp), allocatable :: node_shared(:, :, :), end_shared(:, :, :, :)
  end type coefficients_t
contains

  !> Memory for so many steps; what the last table took serves again where it is as large. Pairs that a smooth
  !> interval does not have stay undefined.
  pure subroutine allocate_table(osc, steps, table)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: steps
    type(coefficients_t), intent(inout) :: table
    ! A thread keeps so few tables below this size (bytes) that the reserve holds them.
    real(dp), parameter :: small = 256e3_dp
    logical :: fits

    if (allocated(table%interval)) then
      if (steps == table%steps .and. osc%contacts == table%contacts .and. osc%pairs == size(table%end_stiffness, 2) .and. &
          (osc%shared > 0 .eqv. allocated(table%node_stiffness))) return
      table = coefficients_t()
    end if
    fits = .true.
    if (steps*step_bytes(osc) > small) call has_memory(steps*step_bytes(osc), fits)
    if (.not. fits) return
    table%steps = steps
    table%contacts = osc%contacts
    associate (m => table%contacts, p => osc%pairs)
      allocate (table%interval(steps), table%pairs(steps), table%left(steps), table%width(steps), table%upper_bound(steps))
      allocate (table%kind(steps), table%full(steps), table%between(steps), table%lower_bound(steps), table%coupled(steps))
      allocate (table%rate(m, 3, steps), table%profile_error(m, 3, steps), table%end_rate(p, 2, steps))
      allocate (table%end_stiffness(0:2, p, 2, steps), table%end_profile_error(0:2, m, 2, steps))
      allocate (table%omega_squared(3, steps), table%forcing(3, steps), table%omega(3, steps))
      if (osc%shared > 0) allocate (table%node_stiffness(p, 3, steps), table%end_sums(0:2, 2, 2, steps), &
                                    table%node_shared(max(1, p - 1), 3, steps), table%end_shared(0:2, max(1, p - 1), 2, steps))
    end associate
  end subroutine allocate_table

  !> Memory of a step (bytes): its rows of the table, and what filling them takes meanwhile.
  pure real(dp) function step_bytes(osc)
    type(oscillator_t), intent(in) :: osc

    step_bytes = 8*(60 + 14*osc%contacts + 6*osc%pairs)
    if (osc%shared > 0) step_bytes = step_bytes + 8*(12*osc%pairs + 12)
  end function step_bytes
end module gearsweep_coefficient_table
