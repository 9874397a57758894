!> Coefficients of the equation of motion over one mesh period, step by step. They do not depend on the speed.
!>
!> The steps end at every break, so that the coefficients are smooth within a step. A contact is a pair that may be in
!> contact or, as the last one and only with backlash, the coast sides together.
!>
!> Full contact is the contact set about which the motion is linear: all pairs between A and E are in contact or, where
!> contact reaches beyond A and E, those that carry the static load.
module gearsweep_coefficients
  use gearsweep_coefficient_table, only: allocate_table, coefficients_t, fill_pairs, kind_t, resolution_t, scheme_collocation, &
                                         scheme_constant, scheme_rk4, scheme_rk4_equal
  use gearsweep_contact_law, only: find_law, find_law_values, shared_t
  use gearsweep_grading, only: grading_t, make_grading, is_stiff, has_turned, expected_steps, count_steps, spread_steps
  use gearsweep_kinds, only: dp
  use gearsweep_oscillator, only: oscillator_t
  implicit none
  private
  public :: resolution_t, coefficients_t, tabulate, need_law, forget_laws, contact_sets_at_begin, graded_steps
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
        call fill_pairs(osc, interval, first, last, table)
      end associate
    end do
    table%laws = table%steps
    do i = 1, table%steps
      call fill_law(osc, i, table%full(i), i, table)
      table%next(i) = 0
    end do
    call find_bounds(osc, table)
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
    real(dp) :: highest, lowest, steepness(2)
    integer :: end, i, j

    do i = 1, table%steps
      highest = -osc%backlash
      lowest = huge(lowest)
      steepness = 0
      do end = 1, 2
        do j = 1, table%pairs(i)
          associate (touching => table%touching(:1, j, end, i))
            if (btest(table%full(i), j - 1)) then
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

  !> The law of a contact set over a step, by its number. Laws are few, so that there is room for all of them but rarely; then
  !> those that are not of full contact are forgotten.
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
  end subroutine need_law

  !> Forgets the laws that are not of full contact.
  pure subroutine forget_laws(table)
    type(coefficients_t), intent(inout) :: table

    table%laws = table%steps
    table%next(:table%steps) = 0
  end subroutine forget_laws

  !> Fills a law.
  pure subroutine fill_law(osc, step, contact_set, law, table)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: step, contact_set, law
    type(coefficients_t), intent(inout) :: table
    ! As many pairs as a contact set has room for: memory of the heap for each law would take longer than the rest.
    real(dp), dimension(3, bit_size(contact_set)) :: effective, touching
    real(dp), dimension(0:2) :: k, g, t, omega_squared, forcing
    real(dp) :: slope
    logical :: coast
    integer :: end, j

    associate (p => table%pairs(step), kind => kind_of(osc, table, step))
      table%contact_set(law) = contact_set
      coast = osc%has_backlash
      if (coast) coast = btest(contact_set, osc%contacts - 1)
      call find_law_values(contact_set, kind, table%stiffness(:, :p, step), table%profile_error(:, :p, step), &
                           table%shared(:, :, step), effective(:, :p), touching(:, :p))
      omega_squared = 0
      forcing = 0
      do j = 1, p
        effective(:, j) = effective(:, j)*table%mobility(1:3, j, step)
        omega_squared = omega_squared + effective(:, j)
        forcing = forcing + effective(:, j)*touching(:, j)
      end do
      table%omega_squared(1:3, law) = omega_squared
      table%forcing(1:3, law) = forcing
      do end = 1, 2
        call find_law(contact_set, kind, table%end_stiffness(:, :p, end, step), &
                      table%end_profile_error(:, :p, end, step), table%end_shared(:, :, end, step), &
                      table%effective(:, :p, end, law), table%touching(:, :p, end, law))
        omega_squared = 0
        forcing = 0
        ! Products with derivatives; the mobility is linear over the step.
        do j = 1, p
          g = table%effective(0:2, j, end, law)
          t = table%touching(0:2, j, end, law)
          associate (m => table%end_mobility(j, end, step))
            slope = (table%end_mobility(j, 2, step) - table%end_mobility(j, 1, step))/table%width(step)
            k(0) = g(0)*m
            k(1) = g(1)*m + g(0)*slope
            k(2) = g(2)*m + 2*g(1)*slope
          end associate
          omega_squared = omega_squared + k
          forcing(0) = forcing(0) + k(0)*t(0)
          forcing(1) = forcing(1) + k(1)*t(0) + k(0)*t(1)
          forcing(2) = forcing(2) + k(2)*t(0) + 2*k(1)*t(1) + k(0)*t(2)
        end do
        table%end_omega_squared(0:2, end, law) = omega_squared
        table%end_forcing(0:2, end, law) = forcing
      end do
    end associate
    if (osc%has_backlash) call add_coast(osc, step, coast, law, table)
    table%omega(1:3, law) = sqrt(table%omega_squared(1:3, law))
  end subroutine fill_law

  !> How the pairs share compliance in a step.
  pure type(shared_t) function kind_of(osc, table, step)
    type(oscillator_t), intent(in) :: osc
    type(coefficients_t), intent(in) :: table
    integer, intent(in) :: step

    kind_of = shared_t(osc%shared > 0, table%coupled(step), osc%mesh%disc%shared_beyond())
  end function kind_of

  !> Adds the coast sides to a law: they touch at x = -backlash, backed by the stiffness of all pairs between A and E.
  pure subroutine add_coast(osc, step, closed, law, table)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: step, law
    logical, intent(in) :: closed                ! they are in contact
    type(coefficients_t), intent(inout) :: table
    real(dp), dimension(3, table%pairs(step)) :: at_node, node_touching
    real(dp), dimension(0:2, table%pairs(step)) :: at_end, touching
    real(dp) :: k(3)
    integer :: end

    associate (p => table%pairs(step), kind => kind_of(osc, table, step), coast => osc%contacts, between => table%between(step))
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

  !> The contact sets of a batch at the begin of a step; where they are held, that of full contact. The first contact that touches
  !> on the wrong side changes until there is none (`closed_set` of gearsweep_contact_law).
  pure subroutine contact_sets_at_begin(osc, step, x, held, table, contact_set)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: step                !< which
    real(dp), intent(in) :: x(:)               !< m; (speed)
    logical, intent(in) :: held(:)             !< (speed)
    type(coefficients_t), intent(inout) :: table
    integer, intent(out) :: contact_set(:)     !< (speed)
    integer :: i, j, l, law, coast

    do l = 1, size(x)
      contact_set(l) = table%full(step)
      if (held(l)) cycle
      coast = 0
      if (osc%has_backlash) coast = merge(ibset(0, osc%contacts - 1), 0, x(l) < -osc%backlash)
      do i = 1, 4*2**min(table%pairs(step), 10)
        call need_law(osc, step, contact_set(l), table, law)
        do j = 1, table%pairs(step)
          if (btest(contact_set(l), j - 1) .neqv. x(l) > table%touching(0, j, 1, law)) exit
        end do
        if (j > table%pairs(step)) exit
        contact_set(l) = ieor(contact_set(l), ibset(0, j - 1))
      end do
      contact_set(l) = ior(contact_set(l), coast)
    end do
  end subroutine contact_sets_at_begin
end module gearsweep_coefficients
