!> Coefficients of the equation of motion for the methods of the literature, in a given number of steps: at the begin,
!> the middle and the end of each.
!>
!> Steps that end at the breaks have one-sided coefficients there. Equal steps know nothing of breaks: which pairs may be
!> in contact is asked at each of the three places by itself.
module gearsweep_literature_table
  use gearsweep_coefficient_table, only: resolution_t, scheme_rk4
  use gearsweep_contact_law, only: find_law, shared_t
  use gearsweep_interval, only: interval_t
  use gearsweep_kinds, only: dp
  use gearsweep_memory, only: has_memory
  use gearsweep_oscillator, only: oscillator_t, mobility
  implicit none
  private
  public :: literature_table_t, exact_step_t, tabulate_literature

  !> The exact motion over a step with constant coefficients, for the contact set that it was last needed for.
  type :: exact_step_t
    integer :: contact_set = -1                  !< -1: not made
    real(dp) :: balance = 0                      !< deflection at which the forces balance, m
    real(dp) :: drift = 0                        !< of y over the step where nothing is in contact, m
    real(dp) :: propagator(2, 2) = 0             !< of the distance from balance
  end type exact_step_t

  type :: literature_table_t
    integer :: scheme = 0                        !< scheme_rk4 ... of gearsweep_coefficients
    integer :: steps = 0                         !< of the period; 0: the memory does not hold them
    real(dp), allocatable :: left(:), width(:)   !< begin and length of a step, mesh phase; (step)
    integer, allocatable :: pairs(:)             !< that may be in contact at any of its places; (step)
    integer, allocatable :: offset(:, :)         !< path coordinate of the first of them less the phase; (place, step)
    integer, allocatable :: between(:, :)        !< those between A and E, as a contact set; (place, step)
    !> K_j (N/m) of a pair while it carries alone, 0 for one that cannot be in contact, and e_j (m), with first
    !> derivatives over the phase; the second ones, which no method asks for, are 0. (0:2, pair, place, step)
    real(dp), allocatable, dimension(:, :, :, :) :: stiffness, profile_error
    real(dp), allocatable :: mobility(:, :, :)   !< what a load makes of the acceleration, 1/kg; (pair, place, step)
    !> What neighbours share (m/N) with its derivatives over the phase; (0:2, pair but the last, place, step).
    real(dp), allocatable :: shared(:, :, :, :)
    real(dp), allocatable :: coast(:, :)         !< stiffness of the coast sides, N/m; (place, step)
    type(shared_t) :: kind                       !< how pairs share compliance
    type(exact_step_t), allocatable :: exact(:)  !< with constant coefficients; (step)
  end type literature_table_t

contains

  !> Tabulates the period.
  pure subroutine tabulate_literature(osc, resolution, table)
    type(oscillator_t), intent(in) :: osc
    type(resolution_t), intent(in) :: resolution             !< with the scheme; not graded
    type(literature_table_t), intent(out) :: table           !< without steps where memory lacks
    integer, allocatable :: counts(:)
    integer :: i, k, step

    associate (intervals => osc%intervals)
      table%scheme = resolution%scheme
      table%kind = shared_t(osc%shared > 0, osc%shared > 0 .and. osc%mesh%is_coupled(osc%pairs), osc%mesh%disc%shared_beyond())
      if (table%scheme == scheme_rk4) then
        counts = resolution%times*max(1, ceiling(resolution%base*(intervals%last - intervals%first) - 1e-6_dp))
      else
        counts = [max(1, nint(resolution%times*resolution%base))]
      end if
      call allocate_table(osc, sum(counts), table)
      if (table%steps == 0) return
      step = 0
      do i = 1, size(counts)
        do k = 1, counts(i)
          step = step + 1
          if (table%scheme == scheme_rk4) then
            table%width(step) = (intervals(i)%last - intervals(i)%first)/counts(i)
            table%left(step) = intervals(i)%first + (k - 1)*table%width(step)
            call fill_aligned(osc, intervals(i), step, table)
          else
            table%width(step) = 1.0_dp/counts(i)
            table%left(step) = real(k - 1, dp)/counts(i)
            call fill_equal(osc, step, table)
          end if
        end do
      end do
    end associate
  end subroutine tabulate_literature

  pure subroutine allocate_table(osc, steps, table)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: steps
    type(literature_table_t), intent(inout) :: table
    real(dp), parameter :: small = 256e3_dp
    real(dp) :: bytes
    logical :: fits

    associate (p => osc%pairs)
      bytes = 8.0_dp*steps*(20 + 30*p)
      fits = .true.
      if (bytes > small) call has_memory(bytes, fits)
      if (.not. fits) return
      table%steps = steps
      allocate (table%left(steps), table%width(steps), table%pairs(steps), table%exact(steps))
      allocate (table%stiffness(0:2, p, 3, steps), table%profile_error(0:2, p, 3, steps), table%mobility(p, 3, steps), &
                table%shared(0:2, max(1, p - 1), 3, steps), table%coast(3, steps), source=0.0_dp)
      allocate (table%offset(3, steps), table%between(3, steps), source=0)
    end associate
  end subroutine allocate_table

  !> A step within a smooth interval.
  pure subroutine fill_aligned(osc, interval, step, table)
    type(oscillator_t), intent(in) :: osc
    type(interval_t), intent(in) :: interval
    integer, intent(in) :: step
    type(literature_table_t), intent(inout) :: table
    integer :: j, place

    table%pairs(step) = interval%pairs
    table%offset(:, step) = interval%offset
    do place = 1, 3
      table%shared(:, :size(interval%shared, 2), place, step) = interval%shared_with_slopes(phase_of(table, place, step))
      do j = 1, interval%pairs
        associate (s => interval%place(phase_of(table, place, step), j))
          call fill_pair(osc, j, place, step, s, interval%stiffness_piece(:, j), interval%piece(:, j), interval%recess(j), table)
        end associate
        if (interval%between(j)) table%between(place, step) = ibset(table%between(place, step), j - 1)
      end do
      call fill_coast(osc, place, step, table)
    end do
  end subroutine fill_aligned

  !> A step that may lie across breaks.
  pure subroutine fill_equal(osc, step, table)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: step
    type(literature_table_t), intent(inout) :: table
    ! At the end of the period no pair has begun that is not there before.
    real(dp), parameter :: before_end = 1 - 1e-12_dp
    real(dp) :: s
    integer :: j, place

    table%pairs(step) = 0
    associate (mesh => osc%mesh)
      do place = 1, 3
        table%offset(place, step) = ceiling(mesh%reach(1) - min(phase_of(table, place, step), before_end))
        do j = 1, size(table%shared, 2)
          table%shared(:, j, place, step) = mesh%shared_from(phase_of(table, place, step) + (j + table%offset(place, step)) - 1)
        end do
        do j = 1, osc%pairs
          s = phase_of(table, place, step) + (j + table%offset(place, step)) - 1
          if (s > mesh%reach(2)) cycle
          table%pairs(step) = max(table%pairs(step), j)
          call fill_pair(osc, j, place, step, s, [1, size(mesh%stiffness%breaks) - 1], spread(mesh%profile_error%locate(s), 1, 2), &
                         s > mesh%pitch_point, table)
          if (s >= 0 .and. s <= mesh%contact_ratio) table%between(place, step) = ibset(table%between(place, step), j - 1)
        end do
        call fill_coast(osc, place, step, table)
      end do
    end associate
  end subroutine fill_equal

  pure real(dp) function phase_of(table, place, step) result(phase)
    type(literature_table_t), intent(in) :: table
    integer, intent(in) :: place, step

    phase = table%left(step) + table%width(step)*(place - 1)/2
  end function phase_of

  !> Pair j, at the path coordinate s, from these pieces of stiffness and profile error.
  pure subroutine fill_pair(osc, j, place, step, s, stiffness_piece, piece, recess, table)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: j, place, step, stiffness_piece(2), piece(2)
    real(dp), intent(in) :: s
    logical, intent(in) :: recess
    type(literature_table_t), intent(inout) :: table
    real(dp) :: k, slope
    integer :: i

    i = osc%mesh%stiffness%locate(s, stiffness_piece)
    k = osc%mesh%stiffness%value(s, i)
    slope = osc%mesh%stiffness%slope(s, i)
    table%stiffness(:, j, place, step) = [k, slope, 0.0_dp]
    table%mobility(j, place, step) = mobility(osc, s, recess)
    i = osc%mesh%profile_error%locate(s, piece)
    table%profile_error(:, j, place, step) = [osc%mesh%profile_error%value(s, i), osc%mesh%profile_error%slope(s, i), 0.0_dp]
  end subroutine fill_pair

  !> The coast sides, backed by the stiffness of all pairs between A and E.
  pure subroutine fill_coast(osc, place, step, table)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: place, step
    type(literature_table_t), intent(inout) :: table
    real(dp), dimension(0:2, osc%pairs) :: effective, touching

    if (.not. osc%has_backlash) return
    call find_law(table%between(place, step), table%kind, table%stiffness(:, :, place, step), &
                  table%profile_error(:, :, place, step), table%shared(:, :, place, step), effective, touching)
    table%coast(place, step) = sum(effective(0, :))
  end subroutine fill_coast
end module gearsweep_literature_table
