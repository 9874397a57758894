!> Coefficients of the equation of motion over one mesh period, step by step; they do not depend on the speed.
!>
!> Teeth that deviate change the profile errors from one mesh period to the next, and nothing else: steps, stiffness and response
!> of a contact set serve all periods. `enter_period` fills in the profile errors of one; the contact laws are linear in them.
!>
!> The steps end at every break, so that the coefficients are smooth within a step. A contact is a pair that may be in contact or,
!> after these and only with backlash, the coast sides: all together or, where teeth have position errors, those next to each
!> pair. Full contact is the contact set about which the motion is linear: all pairs between A and E are in contact or, where
!> contact reaches beyond A and E, those that carry the static load.
module gearsweep_motion_coefficients
  use gearsweep_base, only: dp, has_memory
  use gearsweep_mesh, only: interval_t, set_period
  use gearsweep_motion_contact_law, only: find_law, find_law_values, find_response, find_touching, kind_of, product_of, shared_t
  use gearsweep_motion_gauss, only: nodes, stiff_nodes
  use gearsweep_motion_oscillator, only: mobility, oscillator_t, touches_coast
  use gearsweep_motion_resolution, only: count_steps, equal_steps, grading_t, gradings, has_turned, is_stiff, resolution_t, &
    spread_steps
  implicit none
  private
  public :: coefficients_t, tabulate, enter_period, need_law, forget_laws, contact_sets_at_begin

  !> Properties of a step.
  type :: kind_t
    !> True: a smooth interval begins, or, where steps are graded, three quarters of a cycle of the natural motion have passed
    !> since it began.
    logical :: begins = .false.
    logical :: widens = .false.        !< a smooth interval begins, or the previous step was shorter
    logical :: stiff = .false.         !< too long to follow the natural motion: integrated at Radau's points
  end type kind_t

  !> Coefficients at the three nodes of the integration and at both ends of each step, one-sided at breaks: the properties of the
  !> pairs, and the contact laws (gearsweep_motion_contact_law) that follow. Derivatives are over the mesh phase.
  type :: coefficients_t
    integer :: steps = 0               !< steps of the mesh period; 0: memory is too small for them
    integer :: period = 0              !< index from 0 of the one whose profile errors the table holds
    integer :: contacts = 0            !< largest number of pairs, plus the coast sides
    integer, allocatable :: interval(:)    !< smooth interval of a step; (step)
    integer, allocatable :: pairs(:)       !< pairs that may be in contact; (step)
    integer, allocatable :: full(:)        !< contact set of full contact: bit j - 1 for pair j; (step)
    integer, allocatable :: between(:)     !< contact set of the pairs between A and E; (step)
    type(kind_t), allocatable :: kind(:)   !< (step)
    real(dp), allocatable :: left(:), width(:)     !< start and length of a step, mesh phase 0 to 1; (step)
    !> K_j (N/m) of a pair that carries alone, e_j (m) and acceleration per load (1/kg); (node, pair, step)
    real(dp), allocatable, dimension(:, :, :) :: stiffness, profile_error, mobility
    !> Profile error without deviations, as `profile_error` and `end_profile_error`; of size 0 if no tooth deviates.
    real(dp), allocatable :: ideal_error(:, :, :), end_ideal_error(:, :, :, :)
    !> Waves of the deviations: their rates, rad over the phase, and cosine and sine of rate times phase at the nodes, the end
    !> and the start; (wave) and (cosine or sine, wave, point, step).
    real(dp), allocatable :: rate(:), wave(:, :, :, :)
    !> Stiffness and profile error at the ends, with derivatives (0:2, pair, end, step); the mobility is linear: (pair, end, step)
    real(dp), allocatable, dimension(:, :, :, :) :: end_stiffness, end_profile_error
    real(dp), allocatable :: end_mobility(:, :, :)
    !> Gap of the coast flanks next to each pair at x = 0 (m), where teeth have position errors; (node, pair, step) and (0:2, pair,
    !> end, step). Size 0 in the pairs where all coast flanks share one contact.
    real(dp), allocatable :: coast_gap(:, :, :), end_coast_gap(:, :, :, :)
    !> Compliance shared by neighbouring pairs (m/N); (node, pair but the last, step) and (0:2, pair but the last, end, step).
    real(dp), allocatable :: shared(:, :, :), end_shared(:, :, :, :)
    !> Bounds (m) of the touching deflections in full contact: a motion whose tangents at the ends of the step stay above the
    !> upper bound keeps the pairs of full contact in contact, and one below the lower bound keeps the others apart; (step)
    real(dp), allocatable :: upper_bound(:), lower_bound(:)
    !> Contact laws. Law i is that of full contact in step i; the other laws of a step follow from there by `next`, as far as they
    !> were needed. A law of pairs that a smooth interval does not have stays undefined.
    integer :: laws = 0                          !< number of laws
    integer, allocatable :: contact_set(:), next(:)    !< next: 0 at the end of the list; (law)
    integer, allocatable :: law_period(:)        !< mesh period whose profile errors the law has; (law)
    !> Sums over the contacts at the nodes: omega^2 (1/s^2), omega (rad/s), k e (m/s^2); (node, law)
    real(dp), allocatable, dimension(:, :) :: omega_squared, omega, forcing
    real(dp), allocatable :: weight(:, :, :)     !< forcing per profile error (1/s^2); (node, pair, law)
    !> Touching deflection of pair j per profile error of pair i, (0:2, pair j, pair i, end, law). Size 0 in the pairs where these
    !> share no compliance and touch at their profile error.
    real(dp), allocatable :: share(:, :, :, :, :)
    real(dp), allocatable, dimension(:, :, :) :: end_omega_squared, end_forcing    !< at the ends; (0:2, end, law)
    !> Effective stiffness (N/m; 0 where a contact is open) and touching deflection (m); (0:2, contact, end, law)
    real(dp), allocatable, dimension(:, :, :, :) :: effective, touching
  end type coefficients_t

  !> Touching deflection (m) of coast flanks that do not exist, far from any motion's.
  real(dp), parameter :: nowhere = -1e3_dp

contains

  !> Allocates the memory for this many steps; memory of the previous table is reused if it is as large. Pairs that a smooth
  !> interval does not have stay undefined.
  pure subroutine allocate_table(osc, steps, table)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: steps
    type(coefficients_t), intent(inout) :: table
    ! Tables below this size (bytes) fit into the reserve, as a thread keeps few of them.
    real(dp), parameter :: small = 256e3_dp
    integer :: shares, ideal, waves
    logical :: fits

    shares = merge(osc%pairs, 0, osc%mesh%are_joint())
    ideal = merge(osc%pairs, 0, osc%mesh%deviations%any())
    waves = size(osc%mesh%deviations%rates())
    if (allocated(table%interval)) then
      if (steps == table%steps .and. osc%contacts == table%contacts .and. osc%pairs == size(table%end_stiffness, 2) .and. &
          shares == size(table%share, 2) .and. ideal == size(table%ideal_error, 2) .and. waves == size(table%rate)) return
      table = coefficients_t()
    end if
    fits = .true.
    if (table_bytes(osc, steps) > small) call has_memory(table_bytes(osc, steps), fits)
    if (.not. fits) return
    table%steps = steps
    table%contacts = osc%contacts
    associate (m => table%contacts, p => osc%pairs, q => max(1, osc%pairs - 1), n => steps + further_laws(steps))
      allocate (table%interval(steps), table%pairs(steps), table%left(steps), table%width(steps), table%upper_bound(steps))
      allocate (table%kind(steps), table%full(steps), table%between(steps), table%lower_bound(steps))
      allocate (table%stiffness(3, p, steps), table%profile_error(3, p, steps), table%mobility(3, p, steps))
      allocate (table%end_stiffness(0:2, p, 2, steps), table%end_profile_error(0:2, p, 2, steps), table%end_mobility(p, 2, steps))
      allocate (table%shared(3, q, steps), table%end_shared(0:2, q, 2, steps))
      associate (c => merge(osc%coasts, 0, osc%coasts > 1))
        allocate (table%coast_gap(3, c, steps), table%end_coast_gap(0:2, c, 2, steps))
      end associate
      allocate (table%contact_set(n), table%next(n), table%law_period(n))
      allocate (table%omega_squared(3, n), table%omega(3, n), table%forcing(3, n))
      allocate (table%end_omega_squared(0:2, 2, n), table%end_forcing(0:2, 2, n))
      allocate (table%effective(0:2, m, 2, n), table%touching(0:2, m, 2, n))
      allocate (table%weight(3, p, n), table%share(0:2, shares, shares, 2, n))
      allocate (table%ideal_error(3, ideal, steps), table%end_ideal_error(0:2, ideal, 2, steps))
      allocate (table%rate(waves), table%wave(2, waves, 5, steps))
    end associate
  end subroutine allocate_table

  !> Number of laws in addition to those of full contact: a motion meets few.
  pure integer function further_laws(steps)
    integer, intent(in) :: steps

    further_laws = 32 + 4*min(steps, 1024)
  end function further_laws

  !> Memory of a table (bytes): its steps and laws, and the temporary arrays while it is filled.
  pure real(dp) function table_bytes(osc, steps)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: steps

    table_bytes = 8*(real(steps, dp)*(50 + 41*osc%pairs + 9*osc%coasts + 10*size(osc%mesh%deviations%rates())) + &
                     real(steps + further_laws(steps), dp)*(23 + 12*osc%contacts + 3*osc%pairs + 6*osc%pairs**2))
  end function table_bytes

  !> Computes stiffness, profile error and mobility of all pairs in the steps `first` to `last` of a smooth interval, without
  !> deviations.
  pure subroutine fill_pairs(osc, interval, first, last, table)
    type(oscillator_t), intent(in) :: osc
    type(interval_t), intent(in) :: interval
    integer, intent(in) :: first, last
    type(coefficients_t), intent(inout) :: table           !< with intervals, kinds, starts and widths of the steps
    integer :: j

    call fill_shared(interval, first, last, table)
    do j = 1, interval%pairs
      call fill_pair(osc, interval, j, first, last, table)
    end do
  end subroutine fill_pairs

  !> Fills in the shared compliance of neighbours in the steps first to last of one smooth interval.
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

  !> Fills in pair j in the steps first to last of one smooth interval.
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

  !> Fills in the profile errors of one of the mesh periods after which the deviations repeat, and what follows from them: the
  !> laws of full contact, and the bounds. The other laws follow as they are needed.
  pure subroutine enter_period(osc, period, table)
    type(oscillator_t), intent(inout) :: osc     !< oscillator whose intervals enter the mesh period too
    integer, intent(in) :: period                !< index from 0
    type(coefficients_t), intent(inout) :: table
    integer :: i

    if (period == table%period) return
    table%period = period
    call set_period(osc%mesh, period, osc%intervals)
    call add_deviations(osc, table)
    do i = 1, table%steps
      call renew_law(osc, i, i, table)
    end do
    call find_bounds(osc, table)
  end subroutine enter_period

  !> Computes what a law has of the profile errors of this mesh period.
  pure subroutine renew_law(osc, step, law, table)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: step, law
    type(coefficients_t), intent(inout) :: table

    if (touches_coast(osc, table%contact_set(law))) then
      call fill_law(osc, step, table%contact_set(law), law, table)
    else
      call apply_errors(osc, step, law, table)
      if (osc%coasts > 1) call add_coast_flanks(osc, step, 0, law, table)
      table%law_period(law) = table%period
    end if
  end subroutine renew_law

  !> Adds the errors of single teeth and the waves to the profile errors without deviations.
  pure subroutine add_deviations(osc, table)
    type(oscillator_t), intent(in) :: osc
    type(coefficients_t), intent(inout) :: table
    real(dp) :: phase(5), amplitude(2, size(table%rate)), wave(0:2, 5), of_coast(0:2, 5), d(0:2, 5)
    integer :: drive, i, j, n

    drive = size(osc%mesh%deviations%waves)
    call osc%mesh%deviations%amplitudes_in(table%period, amplitude)
    do i = 1, table%steps
      phase = points_of(table, i)
      n = merge(4, 5, continues(table, i, i))
      associate (interval => osc%intervals(table%interval(i)))
        call sum_waves(amplitude(:, :drive), table%rate(:drive), table%wave(:, :drive, :n, i), wave)
        if (osc%coasts > 1) &
          call sum_waves(amplitude(:, drive + 1:), table%rate(drive + 1:), table%wave(:, drive + 1:, :n, i), of_coast)
        do j = 1, interval%pairs
          d(:, :n) = wave(:, :n)
          call interval%add_deviation(phase(:n), j, d)
          table%profile_error(:, j, i) = table%ideal_error(:, j, i) + d(0, :3)
          table%end_profile_error(:, j, 2, i) = table%end_ideal_error(:, j, 2, i) + d(:, 4)
          if (n == 4) then
            table%end_profile_error(:, j, 1, i) = table%end_profile_error(:, j, 2, i - 1)
          else
            table%end_profile_error(:, j, 1, i) = table%end_ideal_error(:, j, 1, i) + d(:, 5)
          end if
          if (osc%coasts < 2) cycle
          d(:, :n) = of_coast(:, :n)
          d(0, :n) = d(0, :n) + osc%backlash + interval%coast(j)
          table%coast_gap(:, j, i) = d(0, :3)
          table%end_coast_gap(:, j, 2, i) = d(:, 4)
          if (n == 4) then
            table%end_coast_gap(:, j, 1, i) = table%end_coast_gap(:, j, 2, i - 1)
          else
            table%end_coast_gap(:, j, 1, i) = d(:, 5)
          end if
        end do
      end associate
    end do
  end subroutine add_deviations

  !> Phases of the nodes, the end and the start of a step.
  pure function points_of(table, step) result(phase)
    type(coefficients_t), intent(in) :: table
    integer, intent(in) :: step
    real(dp) :: phase(5)

    phase(:3) = table%left(step) + table%width(step)*merge(stiff_nodes, nodes, table%kind(step)%stiff)
    phase(4:) = table%left(step) + table%width(step)*[1, 0]
  end function points_of

  !> Sum of waves at some of the points of a step, with its first and second derivative over the phase; (0:2, point).
  pure subroutine sum_waves(amplitude, rate, wave, w)
    real(dp), intent(in) :: amplitude(:, :)      ! m; (cosine or sine, wave)
    real(dp), intent(in) :: rate(:), wave(:, :, :)         ! as in coefficients_t
    real(dp), intent(out) :: w(0:2, 5)
    integer :: i, k

    w = 0
    do k = 1, size(wave, 3)
      do i = 1, size(rate)
        associate (a => amplitude(:, i), c => wave(1, i, k), s => wave(2, i, k))
          w(0, k) = w(0, k) + a(1)*c + a(2)*s
          w(1, k) = w(1, k) + rate(i)*(a(2)*c - a(1)*s)
          w(2, k) = w(2, k) - rate(i)**2*(a(1)*c + a(2)*s)
        end associate
      end do
    end do
  end subroutine sum_waves

  !> Tabulates the period at a resolution.
  pure subroutine tabulate(osc, resolution, table)
    type(oscillator_t), intent(in) :: osc
    type(resolution_t), intent(in) :: resolution
    type(coefficients_t), intent(inout) :: table           !< table; its memory is reused; no steps if memory is too small
    type(grading_t) :: grading(size(osc%frequency, 2))
    real(dp) :: phase(5)
    integer :: counts(size(osc%frequency, 2)), i, j, n, first, last

    n = size(counts)
    if (resolution%graded_for > 0) then
      grading = gradings(osc, resolution)
      counts = resolution%times*count_steps(grading, osc%intervals(:n)%last - osc%intervals(:n)%first)
    else
      counts = equal_steps(osc%intervals(:n)%last - osc%intervals(:n)%first, resolution)
    end if
    call allocate_table(osc, sum(counts), table)
    if (table%steps == 0) return
    table%period = 0
    last = 0
    do i = 1, n
      first = last + 1
      last = last + counts(i)
      associate (interval => osc%intervals(i))
        table%interval(first:last) = i
        table%pairs(first:last) = interval%pairs
        table%full(first:last) = set_of(interval%carries)
        table%between(first:last) = set_of(interval%between)
        table%kind(first:last) = kind_t()
        if (resolution%graded_for > 0) then
          call grade_interval(osc, i, resolution, grading(i), first, last, table)
        else
          table%kind(first) = kind_t(begins=.true., widens=.true.)
          table%width(first:last) = (interval%last - interval%first)/counts(i)
          table%left(first:last) = interval%first + [(j, j=0, counts(i) - 1)]*table%width(first)
        end if
        call fill_pairs(osc, interval, first, last, table)
      end associate
    end do
    if (osc%mesh%deviations%any()) then
      table%ideal_error(:, :, :) = table%profile_error
      table%end_ideal_error(:, :, :, :) = table%end_profile_error
      table%rate(:) = osc%mesh%deviations%rates()
      do i = 1, table%steps
        phase = points_of(table, i)
        do j = 1, size(phase)
          table%wave(1, :, j, i) = cos(table%rate*phase(j))
          table%wave(2, :, j, i) = sin(table%rate*phase(j))
        end do
      end do
      call add_deviations(osc, table)
    end if
    table%laws = table%steps
    do i = 1, table%steps
      call fill_law(osc, i, table%full(i), i, table)
      table%next(i) = 0
    end do
    call find_bounds(osc, table)
  end subroutine tabulate

  !> Contact set of these pairs.
  pure integer function set_of(pairs) result(contact_set)
    logical, intent(in) :: pairs(:)
    integer :: j

    contact_set = 0
    do j = 1, size(pairs)
      if (pairs(j)) contact_set = ibset(contact_set, j - 1)
    end do
  end function set_of

  !> Places the steps first to last of smooth interval i.
  pure subroutine grade_interval(osc, i, resolution, grading, first, last, table)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: i, first, last
    type(resolution_t), intent(in) :: resolution
    type(grading_t), intent(in) :: grading
    type(coefficients_t), intent(inout) :: table
    real(dp) :: widths((last - first + 1)/resolution%times), behind
    logical :: noted
    integer :: k, step

    call spread_steps(grading, osc%intervals(i)%last - osc%intervals(i)%first, widths)
    behind = 0
    noted = .false.
    do k = 0, last - first
      step = first + k
      table%width(step) = widths(1 + k/resolution%times)/resolution%times
      table%left(step) = osc%intervals(i)%first + behind
      associate (kind => table%kind(step))
        kind%stiff = is_stiff(grading, table%width(step))
        kind%widens = modulo(k, resolution%times) == 0
        kind%begins = k == 0 .or. (kind%widens .and. .not. noted .and. has_turned(grading, behind))
        noted = noted .or. (k > 0 .and. kind%begins)
      end associate
      behind = behind + table%width(step)
    end do
  end subroutine grade_interval

  !> Computes the bounds of full contact: from the highest deflection at which a pair in full contact touches at the ends of each
  !> step and the lowest of the others, with an allowance for their derivatives; not below the coast sides.
  pure subroutine find_bounds(osc, table)
    type(oscillator_t), intent(in) :: osc
    type(coefficients_t), intent(inout) :: table
    real(dp) :: highest, lowest, steepness(2)
    integer :: end, i, j

    do i = 1, table%steps
      highest = -huge(highest)
      lowest = huge(lowest)
      steepness = 0
      do end = 1, 2
        do j = 1, osc%contacts
          if (j > table%pairs(i) .and. j <= osc%pairs) cycle
          associate (touching => table%touching(:1, j, end, i))
            if (btest(table%full(i), j - 1) .or. j > osc%pairs) then
              highest = max(highest, touching(1))
              steepness(1) = max(steepness(1), abs(touching(2)))
            else
              lowest = min(lowest, touching(1))
              steepness(2) = max(steepness(2), abs(touching(2)))
            end if
          end associate
        end do
      end do
      table%upper_bound(i) = highest + steepness(1)*table%width(i)/2
      table%lower_bound(i) = lowest - steepness(2)*table%width(i)/2
    end do
  end subroutine find_bounds

  !> Returns the index of the law of a contact set over a step. Laws are few, so that memory is rarely too small for all of them;
  !> then those that are not of full contact are deleted.
  pure subroutine need_law(osc, step, contact_set, table, law)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: step, contact_set
    type(coefficients_t), intent(inout) :: table
    integer, intent(out) :: law

    law = step
    do while (table%contact_set(law) /= contact_set)
      if (table%next(law) == 0) then
        if (table%laws == size(table%next)) call forget_laws(table)
        table%laws = table%laws + 1
        call fill_law(osc, step, contact_set, table%laws, table)
        table%next(table%laws) = table%next(step)
        table%next(step) = table%laws
        law = table%laws
        return
      end if
      law = table%next(law)
    end do
    if (table%law_period(law) /= table%period) call renew_law(osc, step, law, table)
  end subroutine need_law

  !> Deletes the laws that are not of full contact.
  pure subroutine forget_laws(table)
    type(coefficients_t), intent(inout) :: table

    table%laws = table%steps
    table%next(:table%steps) = 0
  end subroutine forget_laws

  !> Computes a law.
  pure subroutine fill_law(osc, step, contact_set, law, table)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: step, contact_set, law
    type(coefficients_t), intent(inout) :: table

    call fill_response(kind_of(osc%mesh, table%pairs(step)), step, contact_set, law, table)
    call apply_errors(osc, step, law, table)
    if (osc%coasts == 1) call add_coast(osc, step, touches_coast(osc, contact_set), law, table)
    if (osc%coasts > 1) call add_coast_flanks(osc, step, shiftr(contact_set, osc%pairs), law, table)
    table%omega(1:3, law) = sqrt(table%omega_squared(1:3, law))
    table%law_period(law) = table%period
  end subroutine fill_law

  !> Computes what a law has without profile errors.
  pure subroutine fill_response(kind, step, contact_set, law, table)
    type(shared_t), intent(in) :: kind
    integer, intent(in) :: step, contact_set, law
    type(coefficients_t), intent(inout) :: table
    ! Size for as many pairs as a contact set can hold: heap memory for each law would take longer than the arithmetic.
    real(dp), dimension(3, bit_size(contact_set)) :: effective
    real(dp) :: share(0:0, table%pairs(step), table%pairs(step))
    integer :: begin, end, j, node

    associate (p => table%pairs(step))
      table%contact_set(law) = contact_set
      do node = 1, merge(3, 0, kind%any)
        call find_response(contact_set, kind, table%stiffness(node:node, :p, step), table%shared(node:node, :, step), &
                           effective(node:node, :p), share)
        effective(node, :p) = effective(node, :p)*table%mobility(node, :p, step)
        table%weight(node, :p, law) = matmul(effective(node, :p), share(0, :, :))
      end do
      table%omega_squared(1:3, law) = 0
      do j = 1, p
        if (.not. kind%any) then
          effective(:, j) = 0
          if (btest(contact_set, j - 1)) effective(:, j) = table%stiffness(1:3, j, step)*table%mobility(1:3, j, step)
          table%weight(1:3, j, law) = effective(:, j)
        end if
        table%omega_squared(1:3, law) = table%omega_squared(1:3, law) + effective(:, j)
      end do
      begin = 1
      if (continues(table, step, law)) then
        begin = 2
        table%effective(:, :p, 1, law) = table%effective(:, :p, 2, law - 1)
        table%share(:, :, :, 1, law) = table%share(:, :, :, 2, law - 1)
        table%end_omega_squared(:, 1, law) = table%end_omega_squared(:, 2, law - 1)
      end if
      do end = begin, 2
        if (kind%any) then
          call find_response(contact_set, kind, table%end_stiffness(:, :p, end, step), table%end_shared(:, :, end, step), &
                             table%effective(:, :p, end, law), table%share(:, :p, :p, end, law))
        else
          do j = 1, p
            table%effective(0:2, j, end, law) = 0
            if (btest(contact_set, j - 1)) table%effective(0:2, j, end, law) = table%end_stiffness(0:2, j, end, step)
          end do
        end if
        table%end_omega_squared(0:2, end, law) = 0
        do j = 1, p
          table%end_omega_squared(0:2, end, law) = table%end_omega_squared(0:2, end, law) + accelerating(table, step, law, end, j)
        end do
      end do
    end associate
  end subroutine fill_response

  !> True for a law of full contact whose step begins within a smooth interval: there it is that of the previous step.
  pure logical function continues(table, step, law)
    type(coefficients_t), intent(in) :: table
    integer, intent(in) :: step, law

    continues = law == step .and. step > 1
    if (continues) continues = table%interval(step - 1) == table%interval(step)
  end function continues

  !> Acceleration per deflection (1/s^2) by the pair j at an end of a step, with its derivatives; the mobility is linear.
  pure function accelerating(table, step, law, end, j) result(k)
    type(coefficients_t), intent(in) :: table
    integer, intent(in) :: step, law, end, j
    real(dp) :: k(0:2), slope

    associate (g => table%effective(0:2, j, end, law), m => table%end_mobility(j, end, step))
      slope = (table%end_mobility(j, 2, step) - table%end_mobility(j, 1, step))/table%width(step)
      k(0) = g(1)*m
      k(1) = g(2)*m + g(1)*slope
      k(2) = g(3)*m + 2*g(2)*slope
    end associate
  end function accelerating

  !> Computes the forcing and the touching deflections of a law from the profile errors in its step.
  pure subroutine apply_errors(osc, step, law, table)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: step, law
    type(coefficients_t), intent(inout) :: table
    real(dp) :: k(0:2), forcing(0:2)
    integer :: begin, end, j

    associate (p => table%pairs(step))
      table%forcing(1:3, law) = 0
      do j = 1, p
        table%forcing(1:3, law) = table%forcing(1:3, law) + table%weight(1:3, j, law)*table%profile_error(1:3, j, step)
      end do
      begin = 1
      if (continues(table, step, law)) then
        begin = 2
        table%touching(:, :p, 1, law) = table%touching(:, :p, 2, law - 1)
        table%end_forcing(:, 1, law) = table%end_forcing(:, 2, law - 1)
      end if
      do end = begin, 2
        if (osc%mesh%are_joint()) then
          call find_touching(table%share(:, :p, :p, end, law), table%end_profile_error(:, :p, end, step), &
                             table%touching(:, :p, end, law))
        else
          table%touching(0:2, :p, end, law) = table%end_profile_error(0:2, :p, end, step)
        end if
        forcing = 0
        do j = 1, p
          k = accelerating(table, step, law, end, j)
          associate (t => table%touching(0:2, j, end, law))
            forcing(0) = forcing(0) + k(0)*t(1)
            forcing(1) = forcing(1) + k(1)*t(1) + k(0)*t(2)
            forcing(2) = forcing(2) + k(2)*t(1) + 2*k(1)*t(2) + k(0)*t(3)
          end associate
        end do
        table%end_forcing(0:2, end, law) = forcing
      end do
    end associate
  end subroutine apply_errors

  !> Adds the coast sides to a law: they touch at x = -backlash, backed by the stiffness of all pairs between A and E; of pairs of
  !> several springs by that under the static load.
  pure subroutine add_coast(osc, step, closed, law, table)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: step, law
    logical, intent(in) :: closed                ! true: they are in contact
    type(coefficients_t), intent(inout) :: table
    real(dp), dimension(3, table%pairs(step)) :: at_node, node_touching
    real(dp), dimension(0:2, table%pairs(step)) :: at_end, touching
    real(dp) :: k(3)
    integer :: end

    associate (p => table%pairs(step), kind => kind_of(osc%mesh, table%pairs(step)), coast => osc%contacts, &
               between => merge(table%full(step), table%between(step), osc%mesh%spacing > 0))
      table%effective(:, coast, :, law) = 0
      table%touching(:, coast, :, law) = 0
      table%touching(0, coast, :, law) = -osc%backlash
      if (.not. closed) return
      call find_law_values(between, kind, table%stiffness(:, :p, step), table%profile_error(:, :p, step), &
                           table%shared(:, :, step), at_node, node_touching)
      k = sum(at_node, 2)*sum(1/osc%mass)
      table%omega_squared(:, law) = table%omega_squared(:, law) + k
      table%forcing(:, law) = table%forcing(:, law) - k*osc%backlash
      do end = 1, 2
        call find_law(between, kind, table%end_stiffness(:, :p, end, step), &
                      table%end_profile_error(:, :p, end, step), table%end_shared(:, :, end, step), at_end, touching)
        table%effective(:, coast, end, law) = sum(at_end, 2)
        table%end_omega_squared(:, end, law) = table%end_omega_squared(:, end, law) + sum(at_end, 2)*sum(1/osc%mass)
        table%end_forcing(:, end, law) = table%end_forcing(:, end, law) - sum(at_end, 2)*sum(1/osc%mass)*osc%backlash
      end do
    end associate
  end subroutine add_coast

  !> Adds the coast flanks next to each pair between A and E to a law. They share compliance as the pairs do.
  pure subroutine add_coast_flanks(osc, step, coast_set, law, table)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: step, law
    integer, intent(in) :: coast_set             ! bit j - 1: those next to pair j are in contact
    type(coefficients_t), intent(inout) :: table
    real(dp), dimension(3, table%pairs(step)) :: at_node, node_touching
    real(dp), dimension(0:2, table%pairs(step)) :: at_end, touching
    real(dp) :: mobility
    integer :: end, j

    mobility = sum(1/osc%mass)
    associate (p => table%pairs(step), kind => kind_of(osc%mesh, table%pairs(step)))
      if (coast_set > 0) then
        call find_law_values(coast_set, kind, table%stiffness(:, :p, step), table%coast_gap(:, :p, step), &
                             table%shared(:, :, step), at_node, node_touching)
        table%omega_squared(:, law) = table%omega_squared(:, law) + mobility*sum(at_node, 2)
        table%forcing(:, law) = table%forcing(:, law) - mobility*sum(at_node*node_touching, 2)
      end if
      do end = 1, 2
        call find_law(coast_set, kind, table%end_stiffness(:, :p, end, step), table%end_coast_gap(:, :p, end, step), &
                      table%end_shared(:, :, end, step), at_end, touching)
        table%effective(:, osc%pairs + 1:, end, law) = 0
        table%touching(:, osc%pairs + 1:, end, law) = 0
        table%touching(0, osc%pairs + 1:, end, law) = nowhere
        do j = 1, p
          if (.not. btest(table%between(step), j - 1)) cycle
          table%effective(:, osc%pairs + j, end, law) = at_end(:, j)
          table%touching(:, osc%pairs + j, end, law) = -touching(:, j)
          table%end_omega_squared(:, end, law) = table%end_omega_squared(:, end, law) + mobility*at_end(:, j)
          table%end_forcing(:, end, law) = table%end_forcing(:, end, law) - mobility*product_of(at_end(:, j), touching(:, j))
        end do
      end do
    end associate
  end subroutine add_coast_flanks

  !> Finds the contact sets of a batch at the start of a step; where they are held, that of full contact. The first contact that
  !> touches on the wrong side changes until there is none (`closed_set` of gearsweep_motion_contact_law).
  pure subroutine contact_sets_at_begin(osc, step, x, held, table, contact_set)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: step                !< index of the step
    real(dp), intent(in) :: x(:)               !< m; (speed)
    logical, intent(in) :: held(:)             !< (speed)
    type(coefficients_t), intent(inout) :: table
    integer, intent(out) :: contact_set(:)     !< (speed)
    integer :: i, j, l, law

    do l = 1, size(x)
      contact_set(l) = table%full(step)
      if (held(l)) cycle
      do i = 1, 4*2**min(osc%contacts, 10)
        call need_law(osc, step, contact_set(l), table, law)
        do j = 1, osc%contacts
          if (j > table%pairs(step) .and. j <= osc%pairs) cycle
          associate (touching => table%touching(0, j, 1, law))
            if (btest(contact_set(l), j - 1) .neqv. merge(x(l) < touching, x(l) > touching, j > osc%pairs)) exit
          end associate
        end do
        if (j > osc%contacts) exit
        contact_set(l) = ieor(contact_set(l), ibset(0, j - 1))
      end do
    end do
  end subroutine contact_sets_at_begin
end module gearsweep_motion_coefficients
