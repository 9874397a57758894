!> Coefficients of the equation of motion over one mesh period, step by step. They do not depend on the speed.
!>
!> The steps end at every break, so that the coefficients are smooth within a step. A contact is a pair that may be in
!> contact or, as the last one and only with backlash, the coast sides together.
!>
!> Full contact is the contact set about which the motion is linear: all pairs between A and E are in contact or, where
!> contact reaches beyond A and E, those that carry the static load.
module gearsweep_coefficients
  use gearsweep_coefficient_table, only: allocate_table, coefficients_t, kind_t, resolution_t, scheme_collocation, &
                                         scheme_constant, scheme_rk4, scheme_rk4_equal
  use gearsweep_grading, only: grading_t, make_grading, is_stiff, has_turned, expected_steps, count_steps, spread_steps
  use gearsweep_kinds, only: dp
  use gearsweep_mesh, only: interval_t
  use gearsweep_nodes, only: nodes, stiff_nodes
  use gearsweep_oscillator, only: oscillator_t, mobility
  use gearsweep_shared_coefficients, only: couple_coast, fill_shared, share_compliance, touching_at_end
  use gearsweep_shared_compliance, only: own_derivatives, sum_pairs, touching_deflection
  implicit none
  private
  public :: resolution_t, coefficients_t, tabulate, graded_steps
  public :: scheme_collocation, scheme_rk4, scheme_rk4_equal, scheme_constant

contains

  !> Tabulates the period at a resolution.
  pure subroutine tabulate(osc, resolution, table)
    type(oscillator_t), intent(in) :: osc
    type(resolution_t), intent(in) :: resolution
    type(coefficients_t), intent(inout) :: table           !< its memory serves again; without steps where memory lacks
    type(grading_t) :: grading(size(osc%intervals))
    integer :: counts(size(osc%intervals)), i, j, first, last

    if (resolution%graded_for > 0) then
      grading = gradings(osc, resolution)
      counts = resolution%times*count_steps(grading, osc%intervals%last - osc%intervals%first)
    else
      counts = equal_steps(osc%intervals%last - osc%intervals%first, resolution)
    end if
    call allocate_table(osc, sum(counts), table)
    if (table%steps == 0) return
    table%omega_squared(:, :) = 0
    table%forcing(:, :) = 0
    last = 0
    do i = 1, size(osc%intervals)
      first = last + 1
      last = last + counts(i)
      associate (interval => osc%intervals(i))
        table%interval(first:last) = i
        table%pairs(first:last) = interval%pairs
        table%full(first:last) = set_of(interval%carries)
        table%between(first:last) = set_of(interval%between)
        table%coupled(first:last) = osc%shared > 0 .and. osc%mesh%is_coupled(interval%pairs)
        table%kind(first:last) = kind_t()
        if (resolution%graded_for > 0) then
          call grade_interval(osc, i, resolution, grading(i), first, last, table)
        else
          table%kind(first) = kind_t(begins=.true., widens=.true.)
          table%width(first:last) = (interval%last - interval%first)/counts(i)
          table%left(first:last) = interval%first + [(j, j=0, counts(i) - 1)]*table%width(first)
        end if
        if (osc%shared > 0) call fill_shared(interval, first, last, table)
        do j = 1, interval%pairs
          call fill_pair(osc, interval, j, first, last, table)
        end do
      end associate
    end do
    if (osc%shared > 0) call share_compliance(osc, table)
    if (osc%has_backlash) call fill_coast(osc, table)
    call find_bounds(osc, table)
    table%omega(:, :) = sqrt(table%omega_squared)
  end subroutine tabulate

  !> How many steps a smooth interval of this length (mesh phase) has: `times` for each of its shares of `base` steps, and for one
  !> at least. So all steps are halved from one resolution to the next, and the error of each shows in the difference.
  elemental integer function equal_steps(length, resolution) result(steps)
    real(dp), intent(in) :: length
    type(resolution_t), intent(in) :: resolution

    steps = resolution%times*max(1, ceiling(resolution%base*length - 1e-6_dp))
  end function equal_steps

  !> The contact set of these pairs.
  pure integer function set_of(pairs) result(contact_set)
    logical, intent(in) :: pairs(:)
    integer :: j

    contact_set = 0
    do j = 1, size(pairs)
      if (pairs(j)) contact_set = ibset(contact_set, j - 1)
    end do
  end function set_of

  !> How the steps of each smooth interval grow behind its begin; (interval).
  pure function gradings(osc, resolution) result(grading)
    type(oscillator_t), intent(in) :: osc
    type(resolution_t), intent(in) :: resolution
    type(grading_t) :: grading(size(osc%intervals))

    grading = make_grading(osc%frequency(1, :), osc%frequency(2, :), osc%damping_ratio, resolution%base, resolution%graded_for)
  end function gradings

  !> About how many steps a graded period has.
  pure real(dp) function graded_steps(osc, resolution)
    type(oscillator_t), intent(in) :: osc
    type(resolution_t), intent(in) :: resolution           !< graded

    graded_steps = resolution%times*sum(expected_steps(gradings(osc, resolution), osc%intervals%last - osc%intervals%first))
  end function graded_steps

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

  !> From the highest deflection at which a pair in full contact touches at the ends of each step, the lowest of the others,
  !> and what their derivatives take from the motion's; not below the coast sides.
  pure subroutine find_bounds(osc, table)
    type(oscillator_t), intent(in) :: osc
    type(coefficients_t), intent(inout) :: table
    real(dp) :: highest, lowest, steepness(2), touching(0:2)
    integer :: end, i, j

    do i = 1, table%steps
      highest = -osc%backlash
      lowest = huge(lowest)
      steepness = 0
      do end = 1, 2
        associate (p => table%pairs(i), k => table%end_stiffness(:, :, end, i), e => table%end_profile_error(:, :, end, i))
          if (osc%shared > 0) call sum_pairs(table%full(i), k(:, :p), e(:, :p), table%end_sums(:, 1, end, i), &
                                             table%end_sums(:, 2, end, i))
          do j = 1, p
            touching = e(:, j)
            if (table%coupled(i)) then
              touching = touching_at_end(osc, table, i, end, table%full(i), j)
            else if (osc%shared > 0) then
              touching = touching_deflection(table%end_shared(:, 1, end, i), table%end_sums(:, 1, end, i), &
                                             table%end_sums(:, 2, end, i), e(:, j))
            end if
            if (btest(table%full(i), j - 1)) then
              highest = max(highest, touching(0))
              steepness(1) = max(steepness(1), abs(touching(1)))
            else
              lowest = min(lowest, touching(0))
              steepness(2) = max(steepness(2), abs(touching(1)))
            end if
          end do
        end associate
      end do
      table%upper_bound(i) = highest + steepness(1)*table%width(i)/2
      table%lower_bound(i) = lowest - steepness(2)*table%width(i)/2
    end do
  end subroutine find_bounds

  !> Pair j over the steps first to last, those of one smooth interval.
  pure subroutine fill_pair(osc, interval, j, first, last, table)
    type(oscillator_t), intent(in) :: osc
    type(interval_t), intent(in) :: interval
    integer, intent(in) :: j, first, last
    type(coefficients_t), intent(inout) :: table
    real(dp), dimension(3*(last - first + 1)) :: s, rate, error
    real(dp), dimension(0:last - first + 1) :: ends, end_rate
    real(dp), dimension(0:last - first + 1, 0:2) :: stiffness, deviation
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
    call osc%mesh%stiffness%sample(s, interval%stiffness_piece(:, j), rate)
    if (osc%shared > 0) then
      if (.not. table%coupled(first)) rate = rate/(1 - reshape(table%node_shared(1, :, first:last), [3*n])*rate)
      table%node_stiffness(j, :, first:last) = reshape(rate, [3, n])
    end if
    call weigh(osc, s, interval%recess(j), rate)
    call osc%mesh%profile_error%sample(s, interval%piece(:, j), error)
    ends(:n - 1) = interval%place(table%left(first:last), j)
    ends(n) = ends(n - 1) + table%width(last)
    call osc%mesh%stiffness%sample(ends, interval%stiffness_piece(:, j), stiffness(:, 0), stiffness(:, 1), stiffness(:, 2))
    call osc%mesh%profile_error%sample(ends, interval%piece(:, j), deviation(:, 0), deviation(:, 1), deviation(:, 2))
    if (osc%shared > 0 .and. .not. table%coupled(first)) then
      associate (phase => [table%left(first:last), table%left(last) + table%width(last)], c => interval%shared)
        call own_derivatives(interval%shared_by_two(phase), c(1, 1) + 2*phase*c(2, 1), 2*c(2, 1), stiffness(:, 0), &
                             stiffness(:, 1), stiffness(:, 2))
      end associate
    end if
    end_rate = stiffness(:, 0)
    call weigh(osc, ends, interval%recess(j), end_rate)
    do i = 1, n
      associate (step => first + i - 1)
        do k = 1, 3
          table%rate(j, k, step) = rate(3*i - 3 + k)
          table%profile_error(j, k, step) = error(3*i - 3 + k)
          if (.not. interval%carries(j)) cycle
          table%omega_squared(k, step) = table%omega_squared(k, step) + rate(3*i - 3 + k)
          table%forcing(k, step) = table%forcing(k, step) + rate(3*i - 3 + k)*error(3*i - 3 + k)
        end do
        do k = 1, 2
          table%end_stiffness(:, j, k, step) = stiffness(i + k - 2, :)
          table%end_profile_error(:, j, k, step) = deviation(i + k - 2, :)
          table%end_rate(j, k, step) = end_rate(i + k - 2)
        end do
      end associate
    end do
  end subroutine fill_pair

  !> Turns stiffness (N/m) into k_j (1/s^2) at the path coordinates s.
  pure subroutine weigh(osc, s, recess, rate)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: s(:)
    logical, intent(in) :: recess
    real(dp), intent(inout) :: rate(:)

    if (osc%friction > 0) then
      rate = rate*mobility(osc, s, recess)
    else
      rate = rate*(1/osc%mass(1) + 1/osc%mass(2))
    end if
  end subroutine weigh

  !> The coast sides as one more contact, backed by the stiffness of all pairs.
  pure subroutine fill_coast(osc, table)
    type(oscillator_t), intent(in) :: osc
    type(coefficients_t), intent(inout) :: table
    real(dp) :: s(3)
    integer :: i, j, k

    associate (coast => osc%contacts)
      table%rate(coast, :, :) = 0
      table%profile_error(coast, :, :) = -osc%backlash
      table%end_profile_error(:, coast, :, :) = 0
      table%end_profile_error(0, coast, :, :) = -osc%backlash
      do i = 1, table%steps
        associate (interval => osc%intervals(table%interval(i)))
          s = table%left(i) + table%width(i)*merge(stiff_nodes, nodes, table%kind(i)%stiff)
          do j = 1, interval%pairs
            if (.not. interval%between(j)) cycle
            do k = 1, size(nodes)
              table%rate(coast, k, i) = table%rate(coast, k, i) + table%rate(j, k, i)*sum(1/osc%mass) &
                /mobility(osc, interval%place(s(k), j), interval%recess(j))
            end do
          end do
        end associate
      end do
      if (.not. osc%shared > 0) return
      do i = 1, table%steps
        if (table%coupled(i)) then
          call couple_coast(osc, table, i)
        else
          table%rate(coast, :, i) = table%rate(coast, :, i)/(1 + table%node_shared(1, :, i)*table%rate(coast, :, i)/sum(1/osc%mass))
        end if
      end do
    end associate
  end subroutine fill_coast

end module gearsweep_coefficients
