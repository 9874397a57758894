!> Stiffness models and static load sharing.
module test_mesh
  use test_support_gears, only: dogan_pair
  use gearsweep_base_kinds, only: dp, pi
  use gearsweep_elastic_disc, only: disc_t
  use gearsweep_base_error, only: error_t
  use gearsweep_elastic_flattening, only: contact_half_width, even_flattening, flattening_t, load_dependence, surface_to_depth
  use gearsweep_mesh_harmonics, only: find_harmonics, harmonics_t
  use gearsweep_elastic_material, only: material_t
  use gearsweep_mesh_mesh, only: joint_stiffness, mesh_t
  use gearsweep_motion_oscillator, only: oscillator_t
  use gearsweep_gear_pair, only: pair_t
  use gearsweep_base_piecewise, only: piecewise_t, polynomial, spline
  use gearsweep_mesh_sharing, only: share_apart, share_load, sharing_t
  use gearsweep_mesh_stiffness, only: gear_blank_factor, iso_options_t, iso_stiffness, polynomial_stiffness, table_stiffness, &
            weber_stiffness
  use gearsweep_base_text, only: str
  use test_support_random_numbers, only: random_t
  use test_support_reference_rows, only: prescribed
  use test_support_testing, only: tally_t, check_true, check_close, check_error, check_no_error
  implicit none
  private
  public :: run

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t

    if (t%wants('piecewise_exactness')) call piecewise_exactness(t)
    if (t%wants('spline_order')) call spline_order(t)
    if (t%wants('iso_numbers')) call iso_numbers(t)
    if (t%wants('iso_bodies')) call iso_bodies(t)
    if (t%wants('weber_against_iso')) call weber_against_iso(t)
    if (t%wants('tables')) call tables(t)
    if (t%wants('deflection')) call deflection(t)
    if (t%wants('own_flattening')) call own_flattening(t)
    if (t%wants('sharing_identities')) call sharing_identities(t)
    if (t%wants('slow_relief')) call slow_relief(t)
    if (t%wants('discs')) call discs(t)
    if (t%wants('three_pairs')) call three_pairs(t)
    if (t%wants('two_of_three')) call two_of_three(t)
  end subroutine run

  !> Values, slopes and integrals of polynomials in closed form.
  subroutine piecewise_exactness(t)
    type(tally_t), intent(inout) :: t
    type(piecewise_t) :: p
    real(dp), parameter :: x(5) = [0.0_dp, 0.4_dp, 0.5_dp, 1.1_dp, 2.0_dp]

    p = polynomial(0.0_dp, 2.0_dp, [1.0_dp, 2.0_dp, 3.0_dp, 4.0_dp, 5.0_dp])  ! u = x - 1
    call check_close(t, 'value', p%value(1.5_dp), 1 + 1 + 3*0.25_dp + 4*0.125_dp + 5*0.0625_dp)
    call check_close(t, 'slope', p%slope(1.5_dp), 2 + 3 + 12*0.25_dp + 20*0.125_dp)
    call check_close(t, 'integral', p%integral(0.0_dp, 2.0_dp), 2.0_dp + 2.0_dp + 2.0_dp)
    p = spline(x, 1 + x - x**2 + 2*x**3)
    call check_close(t, 'spline of a cubic', p%value(1.7_dp), 1 + 1.7_dp - 1.7_dp**2 + 2*1.7_dp**3, 1e-13_dp)
    call check_close(t, 'its slope', p%slope(0.45_dp), 1 - 2*0.45_dp + 6*0.45_dp**2, 1e-12_dp)
    call check_close(t, 'its integral', p%integral(0.3_dp, 1.9_dp), &
                     1.6_dp + (1.9_dp**2 - 0.3_dp**2)/2 - (1.9_dp**3 - 0.3_dp**3)/3 + (1.9_dp**4 - 0.3_dp**4)/2, 1e-12_dp)
    p = spline(x(:3), 2*x(:3)**2)
    call check_close(t, 'three points: a parabola', p%value(0.2_dp), 0.08_dp, 1e-12_dp)
    p = spline(x(:2), 3*x(:2))
    call check_close(t, 'two points: a line', p%value(0.1_dp), 0.3_dp, 1e-12_dp)
  end subroutine piecewise_exactness

  !> Fourth order on a smooth function.
  subroutine spline_order(t)
    type(tally_t), intent(inout) :: t
    real(dp) :: deviation(2)
    type(piecewise_t) :: p
    integer :: i, k, n

    do k = 1, 2
      n = 100*2**k
      p = spline([(2.0_dp*i/n, i=0, n)], sin(3*[(2.0_dp*i/n, i=0, n)]))
      deviation(k) = maxval([(abs(p%value(i/500.0_dp) - sin(3*i/500.0_dp)), i=0, 1000)])
    end do
    call check_close(t, 'order', log(deviation(1)/deviation(2))/log(2.0_dp), 4.0_dp, absolute=0.2_dp)
  end subroutine spline_order

  !> c'th of the standard's formula at z 25/25 and 25/116 by hand: 15.68, 17.96
  !> N/(um mm), times 0.8 (C_M) and 0.975 (C_B); the mean is 0.75 eps + 0.25 times that.
  subroutine iso_numbers(t)
    type(tally_t), intent(inout) :: t
    type(pair_t) :: pair
    type(piecewise_t) :: curve
    type(material_t) :: steel
    type(error_t), allocatable :: error
    real(dp) :: width

    pair = dogan_pair([25, 25])
    width = 25.4e-3_dp
    call iso_stiffness(pair, [steel, steel], 300e3_dp, curve, error)
    call check_close(t, 'c prime 25/25', curve%maximum()/width, 15.68e9_dp*0.8_dp*0.975_dp, 3e-4_dp)
    call check_close(t, 'c gamma', curve%integral(0.0_dp, pair%contact_ratio)/curve%maximum(), &
                     0.75_dp*pair%contact_ratio + 0.25_dp, 1e-12_dp)
    call iso_stiffness(dogan_pair([25, 116]), [steel, steel], 300e3_dp, curve, error)
    call check_close(t, 'c prime 25/116', curve%maximum()/width, 17.96e9_dp*0.8_dp*0.975_dp, 3e-4_dp)
    call iso_stiffness(pair, [steel, steel], 50e3_dp, curve, error)
    call check_close(t, 'low load', curve%maximum()/width, 15.68e9_dp*0.8_dp*0.975_dp*(0.5_dp*cos(pi/9))**0.25_dp, &
                     3e-4_dp)
  end subroutine iso_numbers

  !> K_A counts as load below 100 N/mm and not above. C_R by hand: web of 0.3 face widths under a rim of two modules: 1 +
  !> ln(0.3)/(5 exp(0.4)) = 0.838591; thinner than 0.2 face widths and a module: 1 + ln(0.2)/(5 exp(0.2)) = 0.736461; a web as
  !> wide as the face has none of it. The more flexible gear counts.
  subroutine iso_bodies(t)
    type(tally_t), intent(inout) :: t
    type(pair_t) :: pair
    type(piecewise_t) :: plain, changed
    type(material_t) :: steel
    type(error_t), allocatable :: error
    type(iso_options_t) :: options
    real(dp), parameter :: width = 25.4e-3_dp, module = 3.18e-3_dp

    pair = dogan_pair([25, 40])
    options%application_factor = 1.5_dp
    call iso_stiffness(pair, [steel, steel], 60e3_dp, plain, error)
    call iso_stiffness(pair, [steel, steel], 40e3_dp, changed, error, options)
    call check_close(t, 'K_A of a light load', changed%maximum(), plain%maximum(), 1e-14_dp)
    call iso_stiffness(pair, [steel, steel], 200e3_dp, plain, error)
    call iso_stiffness(pair, [steel, steel], 200e3_dp, changed, error, options)
    call check_close(t, 'K_A of a heavy load', changed%maximum(), plain%maximum(), 1e-14_dp)
    call check_close(t, 'C_R by hand', gear_blank_factor(0.3_dp*width, 2*module, width, module), 0.838591_dp, absolute=1e-6_dp)
    call check_close(t, 'least C_R', gear_blank_factor(0.1_dp*width, module/2, width, module), 0.736461_dp, absolute=1e-6_dp)
    call check_close(t, 'C_R of a full web', gear_blank_factor(width, 3*module, width, module), 1.0_dp, 1e-14_dp)
    call check_close(t, 'C_R of a solid disc', gear_blank_factor(0.0_dp, 0.0_dp, width, module), 1.0_dp, 1e-14_dp)
    options%web_thickness = [0.9_dp, 0.3_dp]*width
    options%rim_thickness = [4, 2]*module
    call iso_stiffness(pair, [steel, steel], 200e3_dp, changed, error, options)
    call check_close(t, 'the more flexible gear', changed%maximum(), 0.838591_dp*plain%maximum(), 2e-6_dp)
  end subroutine iso_bodies

  !> Independent methods: the standard's c'th was fitted to Weber-Banaschek
  !> calculations of such gears; 5 per cent over a range of tooth numbers.
  subroutine weber_against_iso(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: teeth(2, 5) = reshape([25, 25, 25, 116, 20, 60, 40, 40, 60, 60], [2, 5])
    type(piecewise_t) :: weber, iso
    type(material_t) :: steel
    type(error_t), allocatable :: error
    type(pair_t) :: pair
    integer :: i

    do i = 1, size(teeth, 2)
      pair = dogan_pair(teeth(:, i))
      call weber_stiffness(pair, [steel, steel], 300e3_dp, weber, error)
      call check_no_error(t, 'weber', error)
      call iso_stiffness(pair, [steel, steel], 300e3_dp, iso, error)
      call check_close(t, 'weber and c''th', weber%maximum(), iso%maximum()/(0.8_dp*0.975_dp), 0.05_dp)
    end do
    pair = dogan_pair([25, 25])
    call weber_stiffness(pair, [steel, steel], 300e3_dp, weber, error)
    associate (c => pair%contact_ratio)
      call check_close(t, 'equal gears: symmetric path', weber%value(0.2_dp*c), weber%value(0.8_dp*c), 1e-12_dp)
    end associate
    call weber_stiffness(pair, spread(material_t(2*steel%young, steel%poisson, steel%density), 1, 2), 600e3_dp, iso, error)
    call check_close(t, 'twice E and load: twice the stiffness', iso%value(0.3_dp), 2*weber%value(0.3_dp), 1e-12_dp)
    call weber_stiffness(pair, [steel, steel], 600e3_dp, iso, error)
    call check_true(t, 'flattening stiffens under load', iso%value(0.3_dp) > weber%value(0.3_dp))
  end subroutine weber_against_iso

  subroutine tables(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: s(4) = [0.0_dp, 0.5_dp, 1.0_dp, 1.6_dp]
    type(piecewise_t) :: curve
    type(error_t), allocatable :: error

    call table_stiffness(1.6_dp, s, 1 + s, curve, error)
    call check_no_error(t, 'table', error)
    call check_close(t, 'a line through the table', curve%value(0.77_dp), 1.77_dp, 1e-13_dp)
    call table_stiffness(1.7_dp, s, 1 + s, curve, error)
    call check_error(t, 'too short', error, 'covers s = 0 to 1.6')
    call table_stiffness(1.6_dp, s([1, 3, 2, 4]), 1 + s, curve, error)
    call check_error(t, 'unsorted', error, 'not ascending at row 3')
    call table_stiffness(1.6_dp, s([1, 2, 2, 4]), 1 + s, curve, error)
    call check_error(t, 'twice the same', error, 'not ascending at row 3')
    call table_stiffness(1.6_dp, s + 1e-3_dp, 1 + s, curve, error)
    call check_error(t, 'begins late', error, 'covers s = 0.001 to 1.601')
    call table_stiffness(1.5_dp, s - 0.1_dp, 1 + s, curve, error)
    call check_no_error(t, 'begins before and ends at the path''s end', error)
    call table_stiffness(1.6_dp, s, 1 + s(:3), curve, error)
    call check_error(t, 'one value short', error, 'at least two rows')
    call table_stiffness(1.6_dp, s(:1), s(:1), curve, error)
    call check_error(t, 'one row', error, 'at least two rows')
    call table_stiffness(1.6_dp, s, 1e18_dp*(1 + s), curve, error)
    call check_error(t, 'too stiff', error, 'at most 1e12 N/um; at row 2 it is beyond')
    call table_stiffness(1.6_dp, s, s - 0.5_dp, curve, error)
    call check_error(t, 'not positive', error, 'above 0')
    call polynomial_stiffness(1.6_dp, [100.0_dp, 0.0_dp, -120.0_dp], curve, error)
    call check_error(t, 'polynomial below 0', error, 'above 0')
  end subroutine tables

  !> Against all subsets of pairs: the true contact set is the one that is consistent.
  subroutine deflection(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: k(3) = [300, 250, 400], e(3) = [0.02_dp, 0.0_dp, 0.05_dp]
    real(dp), parameter :: rigid(3) = 0
    real(dp) :: load, x, expected, force(3)
    logical :: set(3)
    integer :: i, subset

    do i = 1, 40
      load = 0.5_dp*i
      call share_apart(k, e, load, rigid, x, force)
      expected = -1
      do subset = 1, 7
        set = [btest(subset, 0), btest(subset, 1), btest(subset, 2)]
        associate (trial => (load + sum(k*e, mask=set))/sum(k, mask=set))
          if (all((trial > e) .eqv. set)) expected = trial
        end associate
      end do
      call check_close(t, 'contact set', x, expected, 1e-14_dp)
    end do
    ! The deepest of two relieved pairs must not take the other one with it.
    call share_apart([1.0_dp, 1.0_dp, 1.0_dp], [0.0_dp, 1.0_dp, 9.0_dp], 2.0_dp, rigid, x, force)
    call check_close(t, 'one at a time', x, 1.5_dp)
  end subroutine deflection

  !> Hertz at each pair's own load: a pair deflects F (1/K - c log(F/nominal)), with c from Weber and Banaschek's formula at two
  !> loads; pairs that are alike carry alike; the loads balance whatever the gaps; at its nominal load a pair is as it was.
  subroutine own_flattening(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: k(3) = [300e6_dp, 250e6_dp, 400e6_dp], nominal = 7000
    real(dp), parameter :: c = 1.1e-10_dp, each(3) = c*[2.5_dp, 1.0_dp, 1.4_dp]
    type(flattening_t), parameter :: at_corners = flattening_t(1.0_dp, [1.4_dp, 1.5_dp], [2.4_dp, 2.6_dp], [0.1_dp, 0.2_dp], &
                                                               [0.02_dp, 0.03_dp])
    type(material_t), parameter :: steel = material_t()
    type(random_t) :: random
    real(dp) :: x, e(3), force(3), part(2), width(2), softer(3), gap
    integer :: i

    width = contact_half_width(steel, steel, .true., [1e5_dp, 3e5_dp], 0.01_dp, 0.02_dp)
    part = 2*surface_to_depth(steel, .true., width, 0.003_dp)
    call check_close(t, 'flattening at two loads', part(1) - part(2), 2*load_dependence(steel, .true.)*log(3.0_dp))
    width = contact_half_width(steel, steel, .false., [1e5_dp, 3e5_dp], 0.01_dp, 0.02_dp)
    part = 2*surface_to_depth(steel, .false., width, 0.003_dp)
    call check_close(t, 'and in plane stress', part(1) - part(2), 2*load_dependence(steel, .false.)*log(3.0_dp))
    do i = 1, 40
      e = [4e-6_dp, 0.0_dp, 1e-6_dp*i]
      call check_law(k, e, each)
    end do
    ! Also where the third pair only just carries or is only just apart.
    random%seed = 3
    do i = 1, 400
      softer = k*[random%between(0.2_dp, 1.0_dp), random%between(0.2_dp, 1.0_dp), random%between(0.2_dp, 1.0_dp)]
      e(:2) = [random%between(0.0_dp, 5e-6_dp), random%between(0.0_dp, 5e-6_dp)]
      call share_apart(softer(:2), e(:2), nominal, each(:2), x, force(:2))
      gap = 10.0_dp**random%between(-16.0_dp, -6.0_dp)
      e(3) = x + sign(gap, random%between(-1.0_dp, 1.0_dp))
      call check_law(softer, e, each*random%between(0.0_dp, 2.0_dp))
    end do
    call share_apart(k(:1), [0.0_dp], nominal, [c], x, force(:1))
    call check_close(t, 'one pair, as it was', x, nominal/k(1))
    call share_apart(k([1, 1]), [0.0_dp, 0.0_dp], nominal, [c, c], x, force(:2))
    call check_close(t, 'two alike', x, nominal/2*(1/k(1) + c*log(2.0_dp)))
    ! An eighth of what the edge adds is left half a zone within the path; half of what is left beyond it after log 2 lengths.
    do i = 1, 2
      associate (s => merge(0.0_dp, 1.6_dp, i == 1), out => merge(-1, 1, i == 1), f => at_corners)
        call check_close(t, 'where the edge is felt', f%at(s - out*f%zone(i)/2, 1.6_dp), (7*f%within + f%at_end(i))/8)
        call check_close(t, 'within the path', f%at(s - out*1.5_dp*f%zone(i), 1.6_dp), f%within)
        call check_close(t, 'at the edge', f%at(s, 1.6_dp), f%at_end(i))
        call check_close(t, 'just beyond', f%at(s + out*1e-12_dp, 1.6_dp), f%at_end(i), 1e-9_dp)
        call check_close(t, 'beyond', f%at(s + out*log(2.0_dp)*f%length(i), 1.6_dp), (f%at_end(i) + f%beyond(i))/2)
      end associate
    end do

  contains

    !> The loads balance, each follows its own law, and an open pair has none.
    subroutine check_law(stiffness, error, flattening)
      real(dp), intent(in) :: stiffness(3), error(3), flattening(3)

      call share_apart(stiffness, error, nominal, flattening, x, force)
      call check_close(t, 'loads balance', sum(force), nominal, 1e-12_dp)
      associate (by_law => force*(1/stiffness - flattening*log(max(force, 1e-9_dp)/nominal)))
        call check_close(t, 'each by its own law', maxval(abs(by_law - (x - error)), mask=x > error), 0.0_dp, absolute=1e-18_dp)
      end associate
      call check_true(t, 'none is pulled', all(force >= 0) .and. all((force > 0) .eqv. (x > error)))
    end subroutine check_law
  end subroutine own_flattening

  !> The loads balance at every phase; mean stiffness is the integral of K.
  subroutine sharing_identities(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: ratios(4) = [1.001_dp, 1.6_dp, 2.0_dp, 2.7_dp]
    type(oscillator_t) :: osc
    type(sharing_t) :: sharing
    integer :: i

    do i = 1, size(ratios)
      ! At a contact ratio of 2 short relief has no room.
      call prescribed(ratios(i), [400.0_dp, 20.0_dp, -110.0_dp], &
                      merge([0.0_dp, 0.0_dp], [12.0_dp, 5.0_dp], i == 3), 1, osc)
      call share_load(osc%mesh, 5000.0_dp, 300, sharing)
      call check_close(t, 'balance', maxval(abs(sum(sharing%load, 1) - 5000)), 0.0_dp, absolute=1e-8_dp)
      ! Integral of 400 + 20 u - 110 u^2 over the path.
      call check_close(t, 'mean stiffness', osc%mesh%mean_stiffness(), 1e6_dp*ratios(i)*(400 - 110/3.0_dp), 1e-12_dp)
      call check_true(t, 'pairs', maxval(sharing%pairs) == ceiling(ratios(i)))
    end do
  end subroutine sharing_identities

  !> Relief of F_s/K at the tips makes the handover smooth: with constant K the
  !> deflection at E equals the relief, so the load there is 0.
  subroutine slow_relief(t)
    type(tally_t), intent(inout) :: t
    type(oscillator_t) :: osc
    type(sharing_t) :: sharing

    call prescribed(1.5_dp, [400.0_dp], [20.0_dp, 20.0_dp], 1, osc)
    call share_load(osc%mesh, 8000.0_dp, 200, sharing)
    call check_close(t, 'load at A', sharing%load(1, 1), 0.0_dp, absolute=1e-8_dp)
    call check_close(t, 'single pair', maxval(sharing%load), 8000.0_dp, 1e-12_dp)
    call check_close(t, 'error of one pair', maxval(sharing%error), 20e-6_dp, 1e-12_dp)
    call check_close(t, 'no step left', minval(sharing%error), 20e-6_dp, 1e-12_dp)
  end subroutine slow_relief

  !> Three pairs of which neighbours share more than the first and the third, with relief so deep that pairs part: under the
  !> loads found, what all of them move a pair by, and its profile error, is the transmission error for each pair that carries,
  !> and no less for those that do not. With flattening a pair deflects by its own load.
  subroutine three_pairs(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: load = 9000, flattening(3) = [0.0_dp, 6e-11_dp, 6e-11_dp]
    ! The last is so deep that one pair carries alone.
    real(dp), parameter :: relief(2, 3) = reshape([14, 9, 14, 9, 80, 60], [2, 3])
    type(disc_t), parameter :: disc = disc_t(turn=2e-9_dp, shared=0.9e-9_dp, change=[0.1e-9_dp, -0.08e-9_dp], decline=0.5e-9_dp)
    type(oscillator_t) :: osc
    type(sharing_t) :: sharing
    type(harmonics_t) :: harmonics
    real(dp) :: moved, u, part
    integer :: i, j, k, n, apart, alone

    do n = 1, size(flattening)
      call prescribed(2.4_dp, [400.0_dp, 20.0_dp, -110.0_dp], relief(:, n), 1, osc)
      osc%mesh%disc = disc
      osc%mesh%flattening = even_flattening(flattening(n))
      call share_load(osc%mesh, load, 600, sharing)
      apart = 0
      do k = 1, size(sharing%phase)
        call check_close(t, 'three pairs carry the load', sum(sharing%load(:, k)), load, 1e-12_dp)
        do j = 1, sharing%pairs(k)
          moved = osc%mesh%profile_error%value(sharing%s(j, k)) + disc%turn*load
          do i = 1, sharing%pairs(k)
            u = max(-1.0_dp, min(1.0_dp, 2*sharing%s(min(i, j), k)/1.4_dp - 1))
            if (i == j) then
              part = 1/osc%mesh%stiffness%value(sharing%s(j, k))
              if (sharing%load(j, k) > 0) part = part - flattening(n)*log(sharing%load(j, k)/load)
            else if (abs(i - j) == 1) then
              part = disc%shared + disc%change(1)*u + disc%change(2)*(3*u**2 - 1)/2
            else
              part = disc%shared - disc%decline
            end if
            moved = moved + part*sharing%load(i, k)
          end do
          ! At a break the profile error is that of one side.
          if (any(abs(sharing%s(j, k) - [0.0_dp, 1.0_dp, 1.4_dp, 2.4_dp]) < 1e-9_dp)) cycle
          if (sharing%load(j, k) > 0) then
            call check_close(t, 'deflection of a pair', moved, sharing%error(k), 1e-11_dp)
          else
            apart = apart + 1
            call check_true(t, 'a pair apart', moved >= sharing%error(k)*(1 - 1e-12_dp))
          end if
        end do
      end do
      call check_true(t, 'pairs part', apart > 40, str(apart))
      alone = count(count(sharing%load > 0, 1) == 1 .and. sharing%pairs == 3)
      call check_true(t, 'one carries alone', alone > 20 .or. n < 3, str(alone))
      call find_harmonics(osc%mesh, load, 2, harmonics)
      call check_close(t, 'peak-to-peak of three pairs', harmonics%peak_to_peak(), maxval(sharing%error) - minval(sharing%error), &
                       5e-3_dp)
    end do
    ! Without relief and flattening the stiffness of all pairs is the load over the deflection.
    call prescribed(2.4_dp, [400.0_dp, 20.0_dp, -110.0_dp], [0.0_dp, 0.0_dp], 1, osc)
    osc%mesh%disc = disc_t(shared=disc%shared, change=disc%change, decline=disc%decline)
    call share_load(osc%mesh, load, 4000, sharing)
    call check_close(t, 'stiffness of three pairs', maxval(abs(sharing%stiffness*sharing%error/load - 1)), 0.0_dp, &
                     absolute=1e-12_dp)
    associate (tau => sharing%phase, k => sharing%stiffness)
      call check_close(t, 'mean stiffness of three pairs', osc%mesh%mean_stiffness(), &
                       sum((tau(2:) - tau(:size(tau) - 1))*(k(2:) + k(:size(k) - 1))/2), 1e-6_dp)
    end associate
  end subroutine three_pairs

  !> Of three pairs that share different compliances one is apart: the closed form of two springs with what these two share.
  subroutine two_of_three(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: stiffness(3) = [300e6_dp, 250e6_dp, 400e6_dp], shared(2) = [0.9e-9_dp, 0.7e-9_dp]
    real(dp), parameter :: between(3) = [shared(2), 0.4e-9_dp, shared(1)]      ! by the pairs but this one
    type(mesh_t) :: mesh
    integer :: apart, i

    mesh%disc = disc_t(shared=0.8e-9_dp, change=[-0.1e-9_dp, 0.0_dp], decline=0.4e-9_dp)
    do apart = 1, 3
      associate (c => 1/pack(stiffness, [(i /= apart, i=1, 3)]), both => between(apart))
        call check_close(t, 'two pairs of three', joint_stiffness(mesh, stiffness, shared, [(i /= apart, i=1, 3)]), &
                         (sum(c) - 2*both)/(product(c) - both**2))
      end associate
    end do
  end subroutine two_of_three

  !> Two pairs on discs, by their full compliance matrix: alone 1/K + turn, each under the other's load
  !> turn + shared. Each pair's deflection under both loads, and its profile error, is the same
  !> transmission error, which has the turn once.
  subroutine discs(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: load = 8000
    type(oscillator_t) :: osc
    type(sharing_t) :: rigid, sharing
    type(harmonics_t) :: harmonics
    real(dp) :: alone, other
    integer :: j, k

    call prescribed(1.5_dp, [400.0_dp, 20.0_dp, -110.0_dp], [8.0_dp, 5.0_dp], 1, osc)
    associate (mesh => osc%mesh)
      mesh%disc%turn = 5e-9_dp
      call share_load(mesh, load, 100, rigid)
      mesh%disc%shared = 0.8e-9_dp
      call share_load(mesh, load, 100, sharing)
      do k = 1, size(sharing%phase)
        call check_close(t, 'balance on discs', sum(sharing%load(:, k)), load, 1e-12_dp)
        do j = 1, 2
          if (.not. sharing%load(j, k) > 0) cycle
          alone = 1/mesh%stiffness%value(sharing%s(j, k)) + mesh%disc%turn
          other = mesh%disc%turn + mesh%disc%shared
          call check_close(t, 'deflection on discs', mesh%profile_error%value(sharing%s(j, k)) &
            + alone*sharing%load(j, k) + other*sharing%load(3 - j, k), sharing%error(k), 1e-12_dp)
        end do
      end do
      call find_harmonics(mesh, load, 2, harmonics)
    end associate
    call check_close(t, 'peak-to-peak on discs', harmonics%peak_to_peak(), maxval(sharing%error) - minval(sharing%error), 1e-3_dp)
    call check_true(t, 'mean has the turn', harmonics%mean > 40e-6_dp .and. harmonics%mean < 40e-6_dp + load/4e8_dp)
    call check_close(t, 'one pair feels no sharing', sharing%error(maxloc(sharing%error, 1)), maxval(rigid%error), 1e-12_dp)
    call check_true(t, 'two pairs do', minval(sharing%error) > minval(rigid%error) + 0.3e-9_dp*load)
  end subroutine discs
end module test_mesh
