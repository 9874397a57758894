!> Parts of the motion by themselves: what an oscillator refuses and derives, the quintics between the ends of a
!> step with their turning points and zeros, and the list of places where a load may be largest.
module test_oscillator
  use gearsweep_base_kinds, only: dp
  use gearsweep_base_error, only: error_t
  use gearsweep_motion_coefficients, only: coefficients_t, tabulate
  use gearsweep_motion_resolution, only: resolution_t
  use gearsweep_motion_contact_law, only: find_closed, find_law, find_law_values, shared_t
  use gearsweep_motion_load_peaks, only: add_candidate, candidate_t, candidates_t, may_exceed, raise_to_maximum
  use gearsweep_motion_oscillator, only: make_oscillator, oscillator_t
  use gearsweep_motion_search, only: growth_t
  use gearsweep_base_quintic, only: derivative_of, first_zero, maximum_of, may_cross_zero, over_part, place_of_largest, quintic, &
            value_of
  use gearsweep_base_text, only: str
  use test_support_random_numbers, only: random_t
  use test_support_reference_rows, only: prescribed
  use test_support_solve_one_point, only: mesh_of
  use test_support_testing, only: check_close, check_equal, check_error, check_no_error, check_true, tally_t
  implicit none
  private
  public :: run

  real(dp), parameter :: none(2) = 0, ratio = 1.6_dp

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t

    if (t%wants('refusals')) call refusals(t)
    if (t%wants('derived')) call derived(t)
    if (t%wants('disturbances')) call disturbances(t)
    if (t%wants('laws')) call laws(t)
    if (t%wants('quintics')) call quintics(t)
    if (t%wants('turning_points')) call turning_points(t)
    if (t%wants('first_zeros')) call first_zeros(t)
    if (t%wants('tops')) call tops(t)
  end subroutine run

  !> Each value out of its range is refused by name; at the bounds that belong to it none is.
  subroutine refusals(t)
    type(tally_t), intent(inout) :: t
    type(oscillator_t) :: osc
    type(error_t), allocatable :: error

    osc = stated()
    osc%mesh%contact_ratio = 1
    call refused('contact ratio = 1: must be above 1')
    osc = stated()
    osc%mass(2) = 0
    call refused('effective mass = 0: must be above 0')
    osc = stated()
    osc%load = 0
    call refused('load = 0: must be above 0')
    osc = stated()
    osc%damping_ratio = -1e-9_dp
    call refused('damping_ratio = -1e-9: must be at least 0')
    osc = stated()
    osc%friction = 1
    call refused('friction = 1: must be at least 0 and below 1')
    osc = stated()
    osc%friction = -0.1_dp
    call refused('friction = -0.1')
    osc = stated()
    osc%backlash = -1e-6_dp
    call refused('backlash = -1e-6: must be at least 0')
    osc = stated()
    osc%mesh%teeth = 0
    call refused('teeth = 0')
    osc = stated()
    osc%friction = 0.1_dp
    osc%mesh%tan_angle = 0
    call refused('friction = 0.1: needs the teeth of both gears and the pressure angle')
    osc = stated()
    osc%friction = 0.1_dp
    osc%mesh%teeth(2) = 0
    call refused('friction = 0.1: needs')
    osc = stated()
    osc%damping_ratio = 0
    osc%backlash = 0
    call make_oscillator(osc, error)
    call check_no_error(t, 'bounds belong to their ranges', error)

  contains

    subroutine refused(message)
      character(*), intent(in) :: message

      call make_oscillator(osc, error)
      call check_error(t, message, error, message)
    end subroutine refused
  end subroutine refusals

  type(oscillator_t) function stated() result(osc)
    call prescribed(ratio, [400.0_dp], none, 1, osc)
    osc%mesh%teeth = [25, 30]
    osc%mesh%pitch_point = ratio/2
    osc%mesh%tan_angle = 0.36_dp
    osc%mass = [0.8_dp, 0.9_dp]
    osc%load = 7000
    osc%damping_ratio = 0.1_dp
  end function stated

  !> Frequencies and deflections of a constant pair stiffness, and with relief the deflection whose mean load,
  !> summed here, is the static one.
  subroutine derived(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: samples = 20000
    type(oscillator_t) :: osc
    type(error_t), allocatable :: error
    real(dp) :: mean, s
    integer :: i

    osc = stated()
    call make_oscillator(osc, error)
    call check_no_error(t, 'oscillator', error)
    call check_equal(t, 'pairs', osc%pairs, 2)
    call check_equal(t, 'pairs in contact', osc%contacts, 2)
    call check_close(t, 'natural frequency', osc%natural_frequency, sqrt(ratio*400e6_dp*(1/0.8_dp + 1/0.9_dp)), 1e-12_dp)
    call check_true(t, 'two pairs are no faster than the bound', osc%highest_frequency >= &
                    (1 - 1e-12_dp)*sqrt(2*400e6_dp*(1/0.8_dp + 1/0.9_dp)))
    call check_close(t, 'mean deflection', osc%static_deflection, 7000/(ratio*400e6_dp), 1e-12_dp)
    call check_close(t, 'at high speed', osc%mean_deflection, 7000/(ratio*400e6_dp), 1e-9_dp)
    call check_close(t, 'lowest interval frequency', minval(osc%frequency), sqrt(400e6_dp*(1/0.8_dp + 1/0.9_dp)), 1e-9_dp)
    call check_close(t, 'highest interval frequency', maxval(osc%frequency), sqrt(800e6_dp*(1/0.8_dp + 1/0.9_dp)), 1e-9_dp)
    osc = stated()
    osc%has_backlash = .true.
    osc%backlash = 1e-4_dp
    call make_oscillator(osc, error)
    call check_equal(t, 'the coast side is a contact', osc%contacts, 3)
    osc = mesh_of(ratio, [400.0_dp, 30.0_dp, -110.0_dp], [14.0_dp, 9.0_dp], 0.1_dp)
    mean = 0
    do i = 1, samples
      s = ratio*(i - 0.5_dp)/samples
      mean = mean + max(0.0_dp, osc%mesh%stiffness%value(s)*(osc%mean_deflection - osc%mesh%profile_error%value(s)))*ratio/samples
    end do
    call check_close(t, 'mean load at high speed', mean, 7000.0_dp, 1e-3_dp)
    ! The relief of 14 um at the pinion's tip is the larger one.
    call check_close(t, 'largest profile error', osc%largest_error, 14e-6_dp, 1e-9_dp)
  end subroutine derived

  !> A disturbance of a map that doubles x, and takes a quarter off y, grows by log 2 a period, and is sure after 500.
  subroutine disturbances(t)
    type(tally_t), intent(inout) :: t
    type(growth_t) :: growth
    integer :: i

    do i = 1, 499
      call growth%add(reshape([2.0_dp, 0.0_dp, 0.0_dp, 0.75_dp], [2, 2]), 3.0_dp)
    end do
    call check_true(t, 'not sure before 500 periods', .not. growth%is_sure())
    call growth%add(reshape([2.0_dp, 0.0_dp, 0.0_dp, 0.75_dp], [2, 2]), 3.0_dp)
    call check_true(t, 'sure after 500 periods', growth%is_sure())
    call check_close(t, 'growth over a period', growth%per_period(), log(2.0_dp), 1e-6_dp)
  end subroutine disturbances

  !> The loads of random pairs and contact sets fulfil C F = x - e, with C written down here; a pair touches where its load, or its
  !> gap, is 0; the contact set at a deflection is the only one of all whose loads and gaps have the right signs; derivatives are
  !> those of small differences.
  subroutine laws(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: pairs = 3, apart = 1, in_series = 2, coupled = 3
    character(*), parameter :: names(3) = [character(9) :: 'apart', 'in series', 'coupled']
    real(dp), parameter :: h = 1e-4_dp
    type(random_t) :: random
    real(dp) :: k(0:2, pairs), e(0:2, pairs), shared(0:2, pairs - 1), beyond, matrix(pairs, pairs), x
    real(dp), dimension(0:2, pairs) :: effective, touching
    real(dp), dimension(1, pairs) :: before, behind, touching_before, touching_behind
    real(dp), dimension(pairs) :: load, gap
    integer :: kind, set, found, right, i, j

    do kind = apart, coupled
      do i = 1, 6
        k = reshape([(random%between(-30.0_dp, 30.0_dp), j=1, 3*pairs)], [3, pairs])
        k(0, :) = 300 + k(0, :)
        e = reshape([(random%between(-10.0_dp, 10.0_dp), j=1, 3*pairs)], [3, pairs])
        shared = reshape([(random%between(0.0_dp, 4e-4_dp), j=1, 3*(pairs - 1))], [3, pairs - 1])
        if (kind == in_series) shared(:, 2) = shared(:, 1)
        beyond = shared(0, 1)
        if (kind == coupled) beyond = 1e-4_dp
        x = random%between(-10.0_dp, 20.0_dp)
        matrix = compliance(kind, 0.0_dp)
        right = -1
        do set = 0, 2**pairs - 1
          call find_law(set, shared_t(kind > apart, kind == coupled, beyond), k, e, shared, effective, touching)
          load = effective(0, :)*(x - touching(0, :))
          gap = e(0, :) + matmul(matrix, load) - x
          do j = 1, pairs
            associate (name => names(kind)//' '//str(i)//', set '//str(set)//', pair '//str(j))
              if (btest(set, j - 1)) then
                call check_close(t, name//' has no gap', gap(j), 0.0_dp, absolute=1e-12_dp)
              else
                call check_close(t, name//' has no load', load(j), 0.0_dp)
                ! The pair's own gap closes as its touching deflection is reached, while the others' loads grow.
                associate (others => effective(0, :)*(touching(0, j) - touching(0, :)))
                  call check_close(t, name//' touches', e(0, j) + dot_product(matrix(j, :), others), touching(0, j), &
                                   absolute=1e-12_dp)
                end associate
              end if
            end associate
          end do
          if (all(merge(load > 0, gap > 0, btest(set, [(j, j=0, pairs - 1)])))) right = set
          call differences(set)
        end do
        call find_closed(shared_t(kind > apart, kind == coupled, beyond), k(0:0, :), e(0:0, :), shared(0:0, :), x, found, before, &
                         behind)
        call check_equal(t, names(kind)//' '//str(i)//', the contact set', found, right)
      end do
    end do

  contains

    !> What a load on each pair moves each pair by at a place near 0, um/N.
    function compliance(kind, place) result(c)
      integer, intent(in) :: kind
      real(dp), intent(in) :: place
      real(dp) :: c(pairs, pairs), own(pairs), between(pairs - 1)

      own = 1/(k(0, :) + place*(k(1, :) + place/2*k(2, :)))      ! of a pair alone
      between = shared(0, :) + place*(shared(1, :) + place/2*shared(2, :))
      c = 0
      if (kind == in_series) then
        c = between(1)
      else if (kind == coupled) then
        c = beyond
        c(1, 2) = between(1)
        c(2, 1) = between(1)
        c(2, 3) = between(2)
        c(3, 2) = between(2)
      end if
      do j = 1, pairs
        c(j, j) = own(j)
      end do
    end function compliance

    subroutine differences(set)
      integer, intent(in) :: set
      call at(-h, before, touching_before)
      call at(h, behind, touching_behind)
      do j = 1, pairs
        associate (name => names(kind)//' '//str(i)//', set '//str(set)//', pair '//str(j), g => effective(0:2, j), &
                   s => touching(0:2, j))
          call check_close(t, name//': slope of g', (behind(1, j) - before(1, j))/(2*h), g(2), absolute=1e-4_dp)
          call check_close(t, name//': slope of t', (touching_behind(1, j) - touching_before(1, j))/(2*h), s(2), absolute=1e-5_dp)
          call check_close(t, name//': bend of g', (behind(1, j) - 2*g(1) + before(1, j))/h**2, g(3), absolute=1e-3_dp)
          call check_close(t, name//': bend of t', (touching_behind(1, j) - 2*s(1) + touching_before(1, j))/h**2, s(3), &
                           absolute=1e-3_dp)
        end associate
      end do
    end subroutine differences

    !> The law's values at a place near 0.
    subroutine at(place, g, s)
      real(dp), intent(in) :: place
      real(dp), intent(out), dimension(1, pairs) :: g, s
      real(dp) :: series(0:2)

      series = [1.0_dp, place, place**2/2]
      call find_law_values(set, shared_t(kind > apart, kind == coupled, beyond), reshape(matmul(series, k), [1, pairs]), &
                           reshape(matmul(series, e), [1, pairs]), reshape(matmul(series, shared), [1, pairs - 1]), g, s)
    end subroutine at
  end subroutine laws

  !> A quintic has the values, slopes and curvatures at both ends from which it is made; its value is that of
  !> Taylor's series about the middle; its slope is that of small differences.
  subroutine quintics(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: h = 1e-4_dp
    type(random_t) :: random
    real(dp) :: ends(0:2, 2), c(0:5), at
    integer :: i, k

    do i = 1, 5
      ends = reshape([(random%between(-1.0_dp, 1.0_dp), k=1, 6)], [3, 2])
      c = quintic(ends(:, 1), ends(:, 2))
      do k = 1, 2
        call check_close(t, 'value at end '//str(k)//' of '//str(i), value_of(c, k - 1.0_dp), ends(0, k), absolute=1e-13_dp)
        call check_close(t, 'slope at end '//str(k)//' of '//str(i), derivative_of(c, k - 1.0_dp), ends(1, k), absolute=1e-12_dp)
        ! Of the powers from the second on.
        call check_close(t, 'second derivative at end '//str(k)//' of '//str(i), &
                         merge(2*c(2), sum([2, 6, 12, 20]*c(2:)), k == 1), ends(2, k), absolute=1e-12_dp)
      end do
      at = random%between(0.1_dp, 0.9_dp)
      call check_close(t, 'value of '//str(i), value_of(c, at), sum(c*[1.0_dp, at, at**2, at**3, at**4, at**5]), absolute=1e-13_dp)
      call check_close(t, 'slope of '//str(i), derivative_of(c, at), (value_of(c, at + h) - value_of(c, at - h))/(2*h), &
                       absolute=1e-5_dp)
      ! Over the part from a third of this place to it, of whose length the derivatives have the powers.
      ends = over_part(c, [at/3, at])
      call check_close(t, 'value at the end of a part of '//str(i), ends(0, 2), value_of(c, at), absolute=1e-13_dp)
      call check_close(t, 'slope at the end of a part of '//str(i), ends(1, 2), 2*at/3*derivative_of(c, at), absolute=1e-12_dp)
      call check_close(t, 'second derivative at the start of a part of '//str(i), ends(2, 1), &
                       (2*at/3)**2*sum([2, 6, 12, 20]*c(2:)*[1.0_dp, at/3, (at/3)**2, (at/3)**3]), absolute=1e-12_dp)
    end do
  end subroutine quintics

  !> Products of a falling slope's zero and what is positive: the turning point is where it was put, and a load
  !> with it raises the peak to its top, as a scan finds it.
  subroutine turning_points(t)
    type(tally_t), intent(inout) :: t
    type(random_t) :: random
    real(dp) :: place, b, load(0:2, 2), c(0:5), peak, top
    integer :: i, k

    do i = 1, 12
      place = random%between(0.02_dp, 0.98_dp)
      b = random%between(0.2_dp, 3.0_dp)
      ! y' = (place - x)(1 + b x^2), y(0) = 1.
      load(:, 1) = [1.0_dp, place, -1.0_dp]
      load(:, 2) = [1 + place - 0.5_dp + b*(place/3 - 0.25_dp), (place - 1)*(1 + b), -(1 + b) + (place - 1)*2*b]
      c = quintic(load(:, 1), load(:, 2))
      call check_close(t, 'turning point '//str(i), maximum_of(c), place, absolute=1e-8_dp)
      call check_true(t, 'may have a top '//str(i), may_exceed(load, max(load(0, 1), load(0, 2))))
      peak = 0
      call raise_to_maximum(load, peak)
      top = maxval([(value_of(c, k/1000.0_dp), k=0, 1000)])
      call check_close(t, 'top '//str(i), peak, top, absolute=3e-6_dp)
      peak = 100
      call raise_to_maximum(load, peak)
      call check_close(t, 'a higher peak stays '//str(i), peak, 100.0_dp)
    end do
    ! y' = (place - x)(b - x) with place < b: a top and a hollow, and the largest value is at the top or, where b is not much
    ! above it, at the end.
    do i = 1, 12
      place = random%between(0.15_dp, 0.5_dp)
      b = random%between(place + 0.2_dp, 0.98_dp)
      c = [0.0_dp, place*b, -(place + b)/2, 1/3.0_dp, 0.0_dp, 0.0_dp]
      top = place
      if (value_of(c, 1.0_dp) > value_of(c, place)) top = 1
      call check_close(t, 'place of the largest '//str(i), place_of_largest(c), top, absolute=1e-8_dp)
    end do
    call check_true(t, 'rising has no top', .not. may_exceed(ends(1.0_dp, 1.0_dp, 2.0_dp, 1.0_dp), 0.0_dp))
    call check_true(t, 'falling has none', .not. may_exceed(ends(2.0_dp, -1.0_dp, 1.0_dp, -1.0_dp), 0.0_dp))
    call check_true(t, 'below the peak', .not. may_exceed(ends(1.0_dp, 1.0_dp, 1.0_dp, -1.0_dp), 1.51_dp))
    call check_true(t, 'above it', may_exceed(ends(1.0_dp, 1.0_dp, 1.0_dp, -1.0_dp), 1.49_dp))
  end subroutine turning_points

  !> A load with its slope at the left end, and at the right; without curvature.
  pure function ends(load, slope, next_load, next_slope) result(both)
    real(dp), intent(in) :: load, slope, next_load, next_slope
    real(dp) :: both(0:2, 2)

    both = reshape([load, slope, 0.0_dp, next_load, next_slope, 0.0_dp], [3, 2])
  end function ends

  !> Functions with zeros put in place: one that passes zero once, and one that dips below it and comes back.
  subroutine first_zeros(t)
    type(tally_t), intent(inout) :: t
    type(random_t) :: random
    real(dp) :: a, b, place, c(0:5)
    logical :: found
    integer :: i

    do i = 1, 12
      a = random%between(0.05_dp, 0.9_dp)
      b = random%between(a + 0.05_dp, 0.98_dp)
      ! (a - x)(1 + x^2)
      c = [a, -1.0_dp, a, -1.0_dp, 0.0_dp, 0.0_dp]
      call first_zero(c, place, found)
      call check_true(t, 'passes zero '//str(i), found)
      call check_close(t, 'place '//str(i), place, a, absolute=1e-9_dp)
      call check_true(t, 'may pass '//str(i), &
                      may_cross_zero(value_of(c, 0.0_dp), value_of(c, 1.0_dp), c(1), derivative_of(c, 1.0_dp)))
      ! (a - x)(b - x)
      c = [a*b, -(a + b), 1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp]
      call first_zero(c, place, found)
      call check_true(t, 'dips below zero '//str(i), found)
      call check_close(t, 'first of two places '//str(i), place, a, absolute=1e-9_dp)
      call check_true(t, 'may dip '//str(i), &
                      may_cross_zero(value_of(c, 0.0_dp), value_of(c, 1.0_dp), c(1), derivative_of(c, 1.0_dp)))
      ! The same, lifted above zero.
      c(0) = c(0) + (b - a)**2/4 + 0.01_dp
      call first_zero(c, place, found)
      call check_true(t, 'stays above zero '//str(i), .not. found)
    end do
    call check_true(t, 'far above', .not. may_cross_zero(2.0_dp, 2.0_dp, -1.0_dp, 1.0_dp))
  end subroutine first_zeros

  !> More places than the list holds: those below the peak are forgotten; if there are none, all are looked at,
  !> and the peak is that of all.
  subroutine tops(t)
    type(tally_t), intent(inout) :: t
    type(oscillator_t) :: osc
    type(coefficients_t) :: table
    type(candidates_t) :: list
    type(candidate_t) :: top
    real(dp) :: duration, peak
    integer :: i

    osc = mesh_of(ratio, [400.0_dp], none, 0.1_dp)
    call tabulate(osc, resolution_t(40.0_dp, 1), table)
    duration = 60/(25*8000.0_dp)
    top = candidate_t(bound=10.0_dp, x=[1e-5_dp, 1e-5_dp], y=[1e-6_dp, -1e-6_dp], step=30, pair=1, contact_set=1)
    list%count = 0
    peak = 20
    do i = 1, 17
      call add_candidate(osc, table, duration, top, list, peak)
    end do
    call check_equal(t, 'what the peak has passed is forgotten', list%count, 1)
    call check_close(t, 'the peak stays', peak, 20.0_dp)
    ! A load of 400 N/um on 10 um, and slopes that lift it by up to their difference over four.
    list%count = 0
    peak = 0
    do i = 1, 17
      top%bound = 1e5_dp + i
      call add_candidate(osc, table, duration, top, list, peak)
    end do
    call check_equal(t, 'all are looked at', list%count, 1)
    call check_true(t, 'and raise the peak', peak > 4000 .and. peak < 4500, str(peak))
  end subroutine tops
end module test_oscillator
