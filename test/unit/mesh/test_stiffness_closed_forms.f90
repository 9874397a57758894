!> Pair and mesh stiffness against the standards' formulas written out anew, closed forms, and a solver of load
!> sharing in a few lines; unlike gears by exchanging them.
module test_stiffness_closed_forms
  use gearsweep_gear_profile, only: tooth_outline
  use gearsweep_elastic_disc, only: disc_t
  use gearsweep_base_error, only: error_t
  use gearsweep_gear_gear, only: gear_spec_t, gear_t, make_gear
  use gearsweep_base_kinds, only: dp, pi
  use gearsweep_motion_oscillator, only: oscillator_t
  use gearsweep_mesh_sharing, only: share_load, sharing_t
  use gearsweep_base_text, only: str
  use test_support_ask_by_name, only: answer_t, ask
  use test_support_reference_rows, only: prescribed
  use test_support_gears, only: stated_t, examples, text_of, base_radius, working_angle, first_curvature, base_pitch, &
    & contact_ratio, half_tooth, degree, drive
  use test_support_testing, only: tally_t, check_true, check_close, check_no_error
  implicit none
  private
  public :: run

  !> The models along the path alone.
  character(*), parameter :: by_standard = '&mesh model=''iso6336'' corner_contact=.false. / ', &
                             by_weber = '&mesh model=''weber'' corner_contact=.false. / '

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t

    if (t%wants('iso_single_stiffness')) call iso_single_stiffness(t)
    if (t%wants('weber_by_printed_constants')) call weber_by_printed_constants(t)
    if (t%wants('two_materials')) call two_materials(t)
    if (t%wants('parted_pairs')) call parted_pairs(t)
    if (t%wants('slope_of_the_load')) call slope_of_the_load(t)
    if (t%wants('unlike_gears')) call unlike_gears(t)
  end subroutine run

  !> ISO 6336-1:2006, 9.3: q' of Table 8, c'_th = 1/q', c' = c'_th C_M C_R C_B E/E_st with C_M = 0.8, C_R = 1 for solid
  !> discs and C_B = [1 + 0.5 (1.2 - h_fP/m)] [1 - 0.02 (20 - alpha_P)], the mean of C_B where the racks differ; below
  !> F_t/b = 100 N/mm, where F_t = F cos(alpha), times (F_t/b/100)**0.25. Over the path it is c' at the middle, and its mean
  !> that of c_gamma = c' (0.75 eps +
  !> 0.25) over eps pairs. N/(mm um).
  pure real(dp) function iso_c_prime(pair, young_gpa, line_load_n_mm) result(c)
    type(stated_t), intent(in) :: pair
    real(dp), intent(in) :: young_gpa, line_load_n_mm
    real(dp), parameter :: c1 = 0.04723_dp, c2 = 0.15551_dp, c3 = 0.25791_dp, c4 = -0.00635_dp, c5 = -0.11654_dp, &
      c6 = -0.00193_dp, c7 = -0.24188_dp, c8 = 0.00529_dp, c9 = 0.00182_dp
    real(dp) :: q, c_b(2)

    associate (z1 => pair%teeth(1), z2 => pair%teeth(2), x1 => pair%shift(1), x2 => pair%shift(2))
      q = c1 + c2/z1 + c3/z2 + c4*x1 + c5*x1/z1 + c6*x2 + c7*x2/z2 + c8*x1*x1 + c9*x2*x2
    end associate
    c_b = (1 + 0.5_dp*(1.2_dp - pair%dedendum))*(1 - 0.02_dp*(20 - pair%angle(1)))
    c = 0.8_dp/q*sum(c_b)/2*young_gpa/206
    associate (tangential => line_load_n_mm*cos(pair%angle(1)*degree))
      if (tangential < 100) c = c*(tangential/100)**0.25_dp
    end associate
  end function iso_c_prime

  !> At other angles than 20 degrees, with shift, unlike dedenda, another modulus and light load. A steeper rack is
  !> stiffer: +10 % at 25 degrees.
  subroutine iso_single_stiffness(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: light(2) = [104.0_dp, 40.0_dp], young(2) = [206.0_dp, 175.0_dp]
    type(stated_t) :: list(5), plain
    type(answer_t) :: answer
    real(dp), allocatable :: s(:), found(:)
    real(dp) :: ratio, u
    integer :: n, i, k

    list = examples()
    do n = 1, size(list)
      do i = 1, 2
        associate (pair => list(n))
          call ask(t, '&case tasks=''mesh'' / '//text_of(pair)//by_standard//'&material young_gpa='//str(young(i))// &
                   ' / &load line_load_n_mm='//str(light(i))//' /', answer)
          ratio = contact_ratio(pair)
          s = answer%all_of('mesh.s')
          found = answer%all_of('mesh.pair_stiffness_n_um')
          call check_true(t, 'rows of the stiffness', size(s) > 100)
          do k = 1, size(s), 11
            u = 2*s(k)/ratio - 1
            call check_close(t, 'ISO 6336-1, pair '//str(n), found(k), 20*iso_c_prime(pair, young(i), light(i)) &
                             *(1 - 0.75_dp*(1 - 1/ratio)*u**2), relative=1e-10_dp)
          end do
          call check_close(t, 'c_gamma, pair '//str(n), answer%one('motion.mean_mesh_stiffness_n_um'), &
                           20*iso_c_prime(pair, young(i), light(i))*(0.75_dp*ratio + 0.25_dp), relative=1e-10_dp)
        end associate
      end do
    end do
    ! By hand: z 30/30, x 0, h_fP 1.25: q' = 0.061011, c' = 0.8 0.975/q' = 12.785; at 25 degrees 14.063, at 18 degrees 12.273.
    plain = stated_t(teeth=[30, 30], rounding=[0.1_dp, 0.1_dp], distance=90.0_dp)
    call check_close(t, 'c'' by hand, 20 degrees', largest([20, 20]), 12.7846_dp, 1e-4_dp)
    call check_close(t, 'c'' by hand, 25 degrees', largest([25, 25]), 14.0631_dp, 1e-4_dp)
    call check_close(t, 'c'' by hand, 18 degrees', largest([18, 25]), 12.2733_dp, 1e-4_dp)

  contains

    !> Of c_gamma, N/(mm um).
    real(dp) function largest(angle)
      integer, intent(in) :: angle(2)

      plain%angle = angle
      call ask(t, '&case tasks=''mesh'' / '//text_of(plain)//by_standard//'&load line_load_n_mm=300 /', answer)
      largest = answer%one('motion.mean_mesh_stiffness_n_um')/20/(0.75_dp*contact_ratio(plain) + 0.25_dp)
    end function largest
  end subroutine iso_single_stiffness

  !> Weber and Banaschek as printed for steel, constants rounded there: bending and shear 10.92 I3 + 3.1 (1 + 0.294 tan**2) I1,
  !> foundation 5.2 (l/s)**2 + l/s + 1.4 (1 + 0.294 tan**2), each cos**2/E; flattening 2 (1 - nu**2)/(pi E) (ln(4 t1 t2/a**2)
  !> - nu/(1 - nu)). On the sampled outline, from the section at the 30 degree tangent; within 1 % as the constants are. With
  !> those of any nu, of which they are the rounded ones, as close as the sampling.
  subroutine weber_by_printed_constants(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: young = 206e3_dp, nu = 0.3_dp, line_load = 250
    !> Bending, shear, share of tan**2 in it, foundation: by the square and the first power of l/s, the rest.
    real(dp), parameter :: constants(6, 2) = reshape([10.92_dp, 3.1_dp, 0.294_dp, 5.2_dp, 1.0_dp, 1.4_dp, 12*(1 - nu**2), &
      2.4_dp*(1 + nu), (1 - nu)/2.4_dp, 18*(1 - nu**2)/pi, 2*(1 + nu)*(1 - 2*nu), 4.8_dp*(1 - nu**2)/pi], [6, 2])
    real(dp), parameter :: within(2) = [0.01_dp, 3e-4_dp]
    type(stated_t) :: list(5)
    type(answer_t) :: answer
    real(dp), allocatable :: s(:), found(:)
    real(dp) :: rho(2), depth(2), tooth, a
    integer :: n, i, k, set

    list = examples()
    do n = 1, 4
      if (n == 2) cycle
      associate (pair => list(n))
        call ask(t, '&case tasks=''mesh'' / '//text_of(pair)//by_weber//'&load line_load_n_mm='//str(line_load)// &
                 ' /', answer)
        s = answer%all_of('mesh.s')
        found = answer%all_of('mesh.pair_stiffness_n_um')
        do k = 1, size(s), 29
          rho(1) = first_curvature(pair) + s(k)*base_pitch(pair)
          rho(2) = pair%distance*sin(working_angle(pair, drive)) - rho(1)
          a = sqrt(8*line_load*(1 - nu**2)/(pi*young)*rho(1)*rho(2)/sum(rho))
          do set = 1, 2
            tooth = 0
            do i = 1, 2
              call bend_tooth(pair, i, rho(i), constants(:, set), tooth, depth(i))
            end do
            tooth = tooth/young + 2*(1 - nu**2)/(pi*young)*(log(4*depth(1)*depth(2)/a**2) - nu/(1 - nu))
            call check_close(t, 'Weber and Banaschek, pair '//str(n), found(k), 20/tooth/1000, relative=within(set))
          end do
        end do
      end associate
    end do
  end subroutine weber_by_printed_constants

  !> Two materials. Weber and Banaschek: each tooth with its own E and nu, and of the flattening too, on the half width of both,
  !> a**2 = 4 w r/pi [(1 - nu1**2)/E1 + (1 - nu2**2)/E2] (Johnson 1985, Eqs. 4.21, 4.43). ISO 6336-1: E/E_steel with E = 2 E1 E2/
  !> (E1 + E2), for which the standard prints 0.74 for steel with grey cast iron and 0.59 for grey cast iron with itself: both
  !> are those of 121 GPa. Solid discs weigh by their own density.
  subroutine two_materials(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: young(2) = [121e3_dp, 70e3_dp], nu(2) = [0.26_dp, 0.34_dp], line_load = 90
    character(*), parameter :: own(2) = [character(50) :: 'young_gpa=121 poisson=0.26 density_kgm3=7200', &
                                         'young_gpa=70 density_kgm3=2700']
    character(*), parameter :: rest = ' &material poisson=0.34 / &load line_load_n_mm=90 /'
    type(stated_t) :: list(5)
    type(answer_t) :: answer
    real(dp), allocatable :: s(:), found(:)
    real(dp) :: rho(2), depth(2), part, total, a, steel
    integer :: i, k

    list = examples()
    associate (pair => list(1))
      call ask(t, '&case tasks=''mesh'' / '//text_of(pair, own(1), own(2))//by_weber//rest, answer)
      s = answer%all_of('mesh.s')
      found = answer%all_of('mesh.pair_stiffness_n_um')
      do k = 1, size(s), 29
        rho(1) = first_curvature(pair) + s(k)*base_pitch(pair)
        rho(2) = pair%distance*sin(working_angle(pair, drive)) - rho(1)
        a = sqrt(4*line_load/pi*rho(1)*rho(2)/sum(rho)*sum((1 - nu**2)/young))
        total = 0
        do i = 1, 2
          part = 0
          call bend_tooth(pair, i, rho(i), [12*(1 - nu(i)**2), 2.4_dp*(1 + nu(i)), (1 - nu(i))/2.4_dp, 18*(1 - nu(i)**2)/pi, &
                          2*(1 + nu(i))*(1 - 2*nu(i)), 4.8_dp*(1 - nu(i)**2)/pi], part, depth(i))
          total = total + (part + (1 - nu(i)**2)/pi*(2*log(2*depth(i)/a) - nu(i)/(1 - nu(i))))/young(i)
        end do
        call check_close(t, 'Weber and Banaschek, two materials', found(k), 20/total/1000, relative=3e-4_dp)
      end do
      associate (rb => base_radius(pair, drive)/1000, r => pair%module*pair%teeth/2000)
        call check_close(t, 'mass of a light gear', answer%one('motion.gear_mass_kg'), &
                         pi/2*2700*0.02_dp*r(2)**4/rb(2)**2, relative=1e-12_dp)
        call check_close(t, 'mass of its pinion', answer%one('motion.pinion_mass_kg'), &
                         pi/2*7200*0.02_dp*r(1)**4/rb(1)**2, relative=1e-12_dp)
      end associate
      call ask(t, '&case tasks=''mesh'' / '//text_of(pair, own(1), own(2))//by_standard//rest, answer)
      call check_close(t, 'c_gamma of two materials', answer%one('motion.mean_mesh_stiffness_n_um'), &
                       20*iso_c_prime(pair, 2*121*70/191.0_dp, line_load)*(0.75_dp*contact_ratio(pair) + 0.25_dp), 1e-10_dp)
      steel = c_gamma('206', '206')
      call check_close(t, 'steel with grey cast iron', c_gamma('206', '121')/steel, 0.74_dp, absolute=5e-3_dp)
      call check_close(t, 'cast iron with steel', c_gamma('121', '206')/steel, 0.74_dp, absolute=5e-3_dp)
      call check_close(t, 'grey cast iron with itself', c_gamma('121', '121')/steel, 0.59_dp, absolute=5e-3_dp)
    end associate

  contains

    real(dp) function c_gamma(pinion, gear)
      character(*), intent(in) :: pinion, gear

      call ask(t, '&case tasks=''mesh'' / '//text_of(list(1), 'young_gpa='//pinion, 'young_gpa='//gear)// &
               by_standard//'&load line_load_n_mm=300 /', answer)
      c_gamma = answer%one('motion.mean_mesh_stiffness_n_um')
    end function c_gamma
  end subroutine two_materials

  !> Adds what one tooth of `gear` deflects under a unit line load, times E, where the flank has this radius of curvature (mm);
  !> `depth` is the way from there to the tooth's axis along the load.
  subroutine bend_tooth(pair, which, rho, c, deflect, depth)
    type(stated_t), intent(in) :: pair
    integer, intent(in) :: which
    real(dp), intent(in) :: rho, c(6)
    real(dp), intent(inout) :: deflect
    real(dp), intent(out) :: depth
    integer, parameter :: steps = 400
    type(gear_t) :: gear
    type(error_t), allocatable :: error
    real(dp) :: points(2, 5*steps + 1), rb(2), r, lever, angle, apex, root, width, y, z, i1, i3
    integer :: i

    call make_gear(gear_spec_t('gear', pair%teeth(which), pair%module, pair%angle*degree, pair%shift(which), &
      pair%addendum(which), pair%dedendum(which), pair%rounding(which), face_width=1.0_dp), gear, error)
    points = tooth_outline(gear, steps)
    rb = base_radius(pair, drive)
    r = hypot(rb(which), rho)
    lever = half_tooth(pair, which, drive, r)
    angle = acos(rb(which)/r) - lever
    depth = r*sin(lever)/cos(angle)
    apex = rb(which)/cos(angle)
    root = max(tangent_of_30(points(:, 1:steps + 1)), tangent_of_30(points(:, 4*steps + 1:)))
    width = across(root)
    i1 = 0
    i3 = 0
    do i = 1, steps
      y = root + (apex - root)*(i - 0.5_dp)/steps
      z = across(y)
      i1 = i1 + (apex - root)/steps/z
      i3 = i3 + (apex - root)/steps*(apex - y)**2/z**3
    end do
    associate (t2 => tan(angle)**2, slender => (apex - root)/width)
      deflect = deflect + cos(angle)**2*(c(1)*i3 + c(2)*(1 + c(3)*t2)*i1 + c(4)*slender**2 + c(5)*slender + c(6)*(1 + c(3)*t2))
    end associate

  contains

    !> The tooth's width at a height, by the outline's chords.
    real(dp) function across(height)
      real(dp), intent(in) :: height
      integer :: k

      across = 0
      do k = 1, 5*steps
        if (k > 2*steps .and. k <= 3*steps) cycle
        associate (p => points(:, k), q => points(:, k + 1))
          if (p(2) > height .neqv. q(2) > height) then
            across = across + abs(p(1) + (q(1) - p(1))*(height - p(2))/(q(2) - p(2)))
            if (k > 3*steps) exit
          end if
        end associate
      end do
    end function across
  end subroutine bend_tooth

  !> Height at which a fillet's outline makes 30 degrees with the tooth's axis: between the middles of two chords.
  pure real(dp) function tangent_of_30(points) result(height)
    real(dp), intent(in) :: points(:, :)
    real(dp) :: angle(size(points, 2) - 1)
    integer :: k, n

    n = size(angle)
    angle = abs(atan2(abs(points(1, 2:) - points(1, :n)), abs(points(2, 2:) - points(2, :n)))) - pi/6
    k = findloc(angle(:n - 1) > 0 .neqv. angle(2:) > 0, .true., 1)
    associate (middle => (points(2, k:k + 1) + points(2, k + 1:k + 2))/2)
      height = middle(1) + (middle(2) - middle(1))*angle(k)/(angle(k) - angle(k + 1))
    end associate
  end function tangent_of_30

  !> Deep reliefs part the pairs: transmission error, shares and mesh stiffness by bisection of sum K max(0, x - e) = F, with
  !> the stiffness as the slope of the load over x.
  subroutine parted_pairs(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: coef(3) = [400, 20, -110], ratios(3) = [1.6_dp, 1.25_dp, 2.4_dp], reliefs(2) = [14, 45], load = 4500
    real(dp), parameter :: h = 1e-5_dp
    type(answer_t) :: answer
    real(dp), allocatable :: s(:), amount(:), stiffness(:), error(:), share(:), mesh(:)
    real(dp) :: x, first, ratio
    integer :: n, k, parted

    do n = 1, size(ratios)
      ratio = ratios(n)
      call ask(t, '&case tasks=''mesh'' / &pinion teeth=25 effective_mass_kg=1 / &gear effective_mass_kg=1 / '// &
        '&load normal_force_n='//str(load)//' / &mesh model=''polynomial'' contact_ratio='//str(ratio)// &
        ' coefficients=400,20,-110 / &relief amount_um='//str(reliefs(1))//','//str(reliefs(2))//' gear_fraction=0.8 /', answer)
      s = answer%all_of('mesh.s')
      amount = answer%all_of('mesh.relief_um')
      stiffness = answer%all_of('mesh.pair_stiffness_n_um')
      error = answer%all_of('mesh.profile_error_um')
      share = answer%all_of('mesh.load_share')
      mesh = answer%all_of('mesh.mesh_stiffness_n_um')
      parted = 0
      do k = 1, size(s), 3
        first = modulo(s(k), 1.0_dp)
        ! One-sided rows stand where pairs come and go.
        if (min(first, 1 - first, abs(first - modulo(ratio, 1.0_dp))) < 1e-6_dp) cycle
        x = deflection(amount(k), first)
        associate (all_of_ste => answer%all_of('mesh.ste_um'))
          call check_close(t, 'transmission error', all_of_ste(k), x, 1e-9_dp)
        end associate
        call check_close(t, 'pair stiffness', stiffness(k), pair_stiffness(s(k)), 1e-9_dp)
        call check_close(t, 'profile error', error(k), relief(amount(k), s(k)), absolute=1e-9_dp)
        call check_close(t, 'load share', share(k), pair_stiffness(s(k))*max(0.0_dp, x - relief(amount(k), s(k)))/load, &
                         absolute=1e-8_dp)
        ! At the place of a parting the slope jumps.
        if (abs(slope(h) - slope(-h)) > 1e-6_dp*slope(h)) cycle
        call check_close(t, 'mesh stiffness', mesh(k), slope(h), 1e-6_dp)
        if (share(k) <= 0) parted = parted + 1
      end do
      call check_true(t, 'pairs that have parted', parted > 6, str(parted))
    end do

  contains

    pure real(dp) function pair_stiffness(s)
      real(dp), intent(in) :: s

      associate (u => 2*s/ratio - 1)
        pair_stiffness = coef(1) + coef(2)*u + coef(3)*u**2
      end associate
    end function pair_stiffness

    !> Short reliefs: from where the smaller number of pairs carries.
    pure real(dp) function relief(amount, s)
      real(dp), intent(in) :: amount, s

      associate (zone => ratio - aint(ratio))
        relief = amount*(max(0.0_dp, (s - aint(ratio))/zone) + 0.8_dp*max(0.0_dp, (zone - s)/zone))
      end associate
    end function relief

    pure real(dp) function force(amount, first, x)
      real(dp), intent(in) :: amount, first, x
      integer :: j

      force = sum([(pair_stiffness(first + j)*max(0.0_dp, x - relief(amount, first + j)), j=0, ceiling(ratio - first) - 1)])
    end function force

    pure real(dp) function deflection(amount, first) result(x)
      real(dp), intent(in) :: amount, first
      real(dp) :: low, high
      integer :: i

      low = 0
      high = 1000
      do i = 1, 60
        x = (low + high)/2
        if (force(amount, first, x) < load) then
          low = x
        else
          high = x
        end if
      end do
    end function deflection

    real(dp) function slope(step)
      real(dp), intent(in) :: step

      slope = (force(amount(k), first, x + step) - force(amount(k), first, x))/step
    end function slope
  end subroutine parted_pairs

  !> With whole gears' discs in series, and three pairs: the mesh stiffness is by how much more load gives how much more
  !> transmission error, at every phase where no pair parts just then.
  subroutine slope_of_the_load(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: load = 5000, more = 1e-3_dp
    type(oscillator_t) :: osc
    type(sharing_t) :: before, behind
    integer :: k, checked

    call prescribed(2.3_dp, [350.0_dp, -15.0_dp, -90.0_dp], [25.0_dp, 14.0_dp], 1, osc)
    osc%mesh%disc = disc_t(turn=1.5e-9_dp, shared=0.6e-9_dp)
    call share_load(osc%mesh, load, 150, before)
    call share_load(osc%mesh, load + more, 150, behind)
    checked = 0
    do k = 1, size(before%phase)
      if (any((before%load(:, k) > 0) .neqv. (behind%load(:, k) > 0))) cycle
      checked = checked + 1
      call check_close(t, 'slope of the load', before%stiffness(k), more/(behind%error(k) - before%error(k)), 1e-4_dp)
    end do
    call check_true(t, 'slopes', checked > 140 .and. count(before%load <= 0) > 20)
  end subroutine slope_of_the_load

  !> Gears that differ in one number only are not equal: exchanged, they mirror the stiffness, and it is not that of two
  !> equal gears. Each of both is looked at by itself, whatever it shares with the other.
  subroutine unlike_gears(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: differing(8) = [character(40) :: 'profile_shift=0.2', 'addendum=0.9', 'dedendum=1.15', &
                                               'rack_tip_radius=0.1', 'bore_mm=30', 'young_gpa=110', 'poisson=0.25', 'teeth=26']
    real(dp), allocatable :: equal(:), one(:), other(:)
    character(:), allocatable :: pinion, gear
    integer :: i

    equal = curve('teeth=25', 'teeth=25')
    do i = 1, size(differing)
      pinion = 'teeth=25 '//trim(differing(i))
      gear = 'teeth=25'
      if (i == size(differing)) pinion = trim(differing(i))
      one = curve(pinion, gear)
      other = curve(gear, pinion)
      call check_true(t, 'as many rows', size(one) == size(other) .and. size(one) > 100)
      call check_close(t, 'exchanged gears mirror, '//trim(differing(i)), maxval(abs(other(size(other):1:-1)/one - 1)), 0.0_dp, &
                       absolute=1e-8_dp)
      call check_true(t, 'they are not equal, '//trim(differing(i)), abs(one(size(one)/2)/equal(size(equal)/2) - 1) > 1e-4_dp, &
                      str(one(size(one)/2)/equal(size(equal)/2)))
      call check_true(t, 'nor symmetric, '//trim(differing(i)), maxval(abs(one(size(one):1:-1)/one - 1)) > 1e-4_dp)
    end do

  contains

    !> Pair stiffness along the path.
    function curve(pinion, gear) result(values)
      character(*), intent(in) :: pinion, gear
      real(dp), allocatable :: values(:)
      type(answer_t) :: answer

      call ask(t, '&case tasks=''mesh'' / &pair module_mm=3 face_width_mm=20 / &pinion '//pinion//' / &gear '//gear// &
               ' / &mesh model=''fe'' / &section elements_across=4 / &load line_load_n_mm=200 /', answer)
      values = answer%all_of('mesh.pair_stiffness_n_um')
      ! In the order of the path.
      values = values(order(answer%all_of('mesh.s')))
    end function curve

    pure function order(s) result(list)
      real(dp), intent(in) :: s(:)
      integer :: list(size(s)), k

      list = [(1 + count(s < s(k)) + count(.not. abs(s(:k - 1) - s(k)) > 0), k=1, size(s))]
      list(list) = [(k, k=1, size(s))]
    end function order
  end subroutine unlike_gears
end module test_stiffness_closed_forms
