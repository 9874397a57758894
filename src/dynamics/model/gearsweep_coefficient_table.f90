!> The table of coefficients of the equation of motion over one mesh period, how finely it is cut into steps, and
!> what the pairs of teeth are in each. gearsweep_coefficients fills the rest.
module gearsweep_coefficient_table
  use gearsweep_interval, only: interval_t
  use gearsweep_kinds, only: dp
  use gearsweep_memory, only: has_memory
  use gearsweep_nodes, only: nodes, stiff_nodes
  use gearsweep_oscillator, only: mobility, oscillator_t
  implicit none
  private
  public :: resolution_t, kind_t, coefficients_t, allocate_table, fill_pairs

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

  !> The coefficients at the three nodes of the integration and at both ends of each step, one-sided at breaks: what the pairs are,
  !> and the contact laws (gearsweep_contact_law) that follow. Derivatives are over the mesh phase.
  type :: coefficients_t
    integer :: steps = 0               !< of the period; 0: the memory does not hold them
    integer :: contacts = 0            !< pairs at most, and the coast sides
    integer, allocatable :: interval(:)    !< smooth interval that a step lies in; (step)
    integer, allocatable :: pairs(:)       !< that may be in contact; (step)
    integer, allocatable :: full(:)        !< contact set of full contact: bit j - 1 for pair j; (step)
    integer, allocatable :: between(:)     !< the pairs between A and E, in the same way; (step)
    logical, allocatable :: coupled(:)     !< three pairs or more share different compliances; (step)
    type(kind_t), allocatable :: kind(:)   !< (step)
    real(dp), allocatable :: left(:), width(:)     !< begin and length of a step, mesh phase 0 to 1; (step)
    !> K_j (N/m) of a pair while it carries alone, e_j (m) and what a load makes of the acceleration (1/kg); (node, pair, step)
    real(dp), allocatable, dimension(:, :, :) :: stiffness, profile_error, mobility
    !> The same at the ends, with derivatives; (0:2, pair, end, step) and, as it is linear, (pair, end, step)
    real(dp), allocatable, dimension(:, :, :, :) :: end_stiffness, end_profile_error
    real(dp), allocatable :: end_mobility(:, :, :)
    !> What neighbours share (m/N); (node, pair but the last, step) and (0:2, pair but the last, end, step).
    real(dp), allocatable :: shared(:, :, :), end_shared(:, :, :, :)
    !> Bounds (m) of the touching deflections in full contact: a motion whose tangents at the ends of the step stay above the upper
    !> one keeps the pairs of full contact in contact, and below the lower one the others apart; (step)
    real(dp), allocatable :: upper_bound(:), lower_bound(:)
    !> The laws. That of full contact in step i is law i; the others of a step follow from there by `next`, as far as they were
    !> asked for. A law of pairs that a smooth interval does not have stays undefined.
    integer :: laws = 0                          !< how many there are
    integer, allocatable :: contact_set(:), next(:)    !< next: 0 where there is none; (law)
    !> Sums over the contacts at the nodes: omega^2 (1/s^2), omega (rad/s), k e (m/s^2); (node, law)
    real(dp), allocatable, dimension(:, :) :: omega_squared, omega, forcing
    real(dp), allocatable, dimension(:, :, :) :: end_omega_squared, end_forcing    !< at the ends; (0:2, end, law)
    !> Effective stiffness (N/m; 0 where a contact is apart) and touching deflection (m); (0:2, contact, end, law)
    real(dp), allocatable, dimension(:, :, :, :) :: effective, touching
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
      if (steps == table%steps .and. osc%contacts == table%contacts .and. osc%pairs == size(table%end_stiffness, 2)) return
      table = coefficients_t()
    end if
    fits = .true.
    if (table_bytes(osc, steps) > small) call has_memory(table_bytes(osc, steps), fits)
    if (.not. fits) return
    table%steps = steps
    table%contacts = osc%contacts
    associate (m => table%contacts, p => osc%pairs, q => max(1, osc%pairs - 1), n => steps + further_laws(steps))
      allocate (table%interval(steps), table%pairs(steps), table%left(steps), table%width(steps), table%upper_bound(steps))
      allocate (table%kind(steps), table%full(steps), table%between(steps), table%lower_bound(steps), table%coupled(steps))
      allocate (table%stiffness(3, p, steps), table%profile_error(3, p, steps), table%mobility(3, p, steps))
      allocate (table%end_stiffness(0:2, p, 2, steps), table%end_profile_error(0:2, p, 2, steps), table%end_mobility(p, 2, steps))
      allocate (table%shared(3, q, steps), table%end_shared(0:2, q, 2, steps))
      allocate (table%contact_set(n), table%next(n), table%omega_squared(3, n), table%omega(3, n), table%forcing(3, n))
      allocate (table%end_omega_squared(0:2, 2, n), table%end_forcing(0:2, 2, n))
      allocate (table%effective(0:2, m, 2, n), table%touching(0:2, m, 2, n))
    end associate
  end subroutine allocate_table

  !> Laws beside those of full contact: a motion meets few.
  pure integer function further_laws(steps)
    integer, intent(in) :: steps

    further_laws = 32 + min(steps, 1024)
  end function further_laws

  !> Memory of a table (bytes): its steps and laws, and what filling them takes meanwhile.
  pure real(dp) function table_bytes(osc, steps)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: steps

    table_bytes = 8*(real(steps, dp)*(50 + 32*osc%pairs) + real(steps + further_laws(steps), dp)*(23 + 12*osc%contacts))
  end function table_bytes

  !> What the pairs of a smooth interval are over its steps, first to last.
  pure subroutine fill_pairs(osc, interval, first, last, table)
    type(oscillator_t), intent(in) :: osc
    type(interval_t), intent(in) :: interval
    integer, intent(in) :: first, last
    type(coefficients_t), intent(inout) :: table           !< with intervals, kinds, begins and widths of the steps
    integer :: j

    call fill_shared(interval, first, last, table)
    do j = 1, interval%pairs
      call fill_pair(osc, interval, j, first, last, table)
    end do
    if (.not. allocated(interval%deviation)) return
    do j = first, last
      call add_deviations(osc, interval, j, table)
    end do
  end subroutine fill_pairs

  !> What neighbours share over the steps first to last, those of one smooth interval.
  pure subroutine fill_shared(interval, first, last, table)
    type(interval_t), intent(in) :: interval
    integer, intent(in) :: first, last
    type(coefficients_t), intent(inout) :: table
    real(dp) :: phase
    integer :: i, j, k

    do i = first, last
      do j = 1, size(interval%shared, 2)
        associate (c0 => interval%shared(0, j), c1 => interval%shared(1, j), c2 => interval%shared(2, j))
          do k = 1, 3
            phase = table%left(i) + table%width(i)*merge(stiff_nodes(k), nodes(k), table%kind(i)%stiff)
            table%shared(k, j, i) = c0 + phase*(c1 + phase*c2)
          end do
          do k = 1, 2
            phase = table%left(i) + (k - 1)*table%width(i)
            table%end_shared(0, j, k, i) = c0 + phase*(c1 + phase*c2)
            table%end_shared(1, j, k, i) = c1 + 2*phase*c2
            table%end_shared(2, j, k, i) = 2*c2
          end do
        end associate
      end do
    end do
  end subroutine fill_shared

  !> Pair j over the steps first to last, those of one smooth interval.
  pure subroutine fill_pair(osc, interval, j, first, last, table)
    type(oscillator_t), intent(in) :: osc
    type(interval_t), intent(in) :: interval
    integer, intent(in) :: j, first, last
    type(coefficients_t), intent(inout) :: table
    real(dp), dimension(3*(last - first + 1)) :: s, at_node, error
    real(dp), dimension(0:last - first + 1) :: ends
    real(dp), dimension(0:last - first + 1, 0:2) :: stiffness, slopes
    integer :: i, k, n

    n = last - first + 1
    do i = 1, n
      associate (step => first + i - 1)
        if (table%kind(step)%stiff) then
          s(3*i - 2:3*i) = interval%place(table%left(step), j) + table%width(step)*stiff_nodes
        else
          s(3*i - 2:3*i) = interval%place(table%left(step), j) + table%width(step)*nodes
        end if
      end associate
    end do
    call osc%mesh%stiffness%sample(s, interval%stiffness_piece(:, j), at_node)
    call osc%mesh%profile_error%sample(s, interval%piece(:, j), error)
    ends(:n - 1) = interval%place(table%left(first:last), j)
    ends(n) = ends(n - 1) + table%width(last)
    call osc%mesh%stiffness%sample(ends, interval%stiffness_piece(:, j), stiffness(:, 0), stiffness(:, 1), stiffness(:, 2))
    call osc%mesh%profile_error%sample(ends, interval%piece(:, j), slopes(:, 0), slopes(:, 1), slopes(:, 2))
    do i = 1, n
      associate (step => first + i - 1)
        do k = 1, 3
          table%stiffness(k, j, step) = at_node(3*i - 3 + k)
          table%profile_error(k, j, step) = error(3*i - 3 + k)
          table%mobility(k, j, step) = mobility(osc, s(3*i - 3 + k), interval%recess(j))
        end do
        do k = 1, 2
          table%end_stiffness(:, j, k, step) = stiffness(i + k - 2, :)
          table%end_profile_error(:, j, k, step) = slopes(i + k - 2, :)
          table%end_mobility(j, k, step) = mobility(osc, ends(i + k - 2), interval%recess(j))
        end do
      end associate
    end do
  end subroutine fill_pair

  !> Adds the errors of single teeth and the waves over a step.
  pure subroutine add_deviations(osc, interval, step, table)
    type(oscillator_t), intent(in) :: osc
    type(interval_t), intent(in) :: interval
    integer, intent(in) :: step
    type(coefficients_t), intent(inout) :: table
    real(dp) :: phase(5), wave(0:2), d(0:2)
    integer :: j, k

    phase(:3) = table%left(step) + table%width(step)*merge(stiff_nodes, nodes, table%kind(step)%stiff)
    phase(4:) = table%left(step) + table%width(step)*[0, 1]
    do k = 1, 5
      wave = osc%mesh%deviations%wave_at(interval%period, phase(k))
      do j = 1, interval%pairs
        d = wave + interval%deviation_of(phase(k), j)
        if (k <= 3) then
          table%profile_error(k, j, step) = table%profile_error(k, j, step) + d(0)
        else
          table%end_profile_error(:, j, k - 3, step) = table%end_profile_error(:, j, k - 3, step) + d
        end if
      end do
    end do
  end subroutine add_deviations
end module gearsweep_coefficient_table
