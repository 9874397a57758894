!> The tip corner in contact: an edge on a half plane against closed forms, and the pair's stiffness beyond the path.
module test_elastic_corner
  use test_support_gears, only: dogan_pair
  use gearsweep_gear_tip_corner, only: add_corner_stiffness, corner_contact, corner_t
  use gearsweep_elastic_disc, only: disc_t
  use gearsweep_elastic_corner_stiffness, only: edge_compliance, edge_deflection, edge_t, make_edge
  use gearsweep_base_error, only: error_t
  use gearsweep_elastic_fe_stiffness, only: fe_options_t, fe_stiffness
  use gearsweep_elastic_flattening, only: flattening_t, surface_to_depth
  use gearsweep_gear_gear, only: drive
  use gearsweep_base_kinds, only: dp, pi
  use gearsweep_elastic_material, only: material_t
  use gearsweep_gear_pair, only: pair_t
  use gearsweep_base_piecewise, only: piecewise_t
  use gearsweep_base_text, only: str
  use gearsweep_elastic_compliance, only: tooth_compliance, tooth_t
  use test_support_ask_by_name, only: answer_t, ask
  use test_support_testing, only: check_close, check_no_error, check_true, tally_t
  implicit none
  private
  public :: run

  type(material_t), parameter :: steel = material_t()
  real(dp), parameter :: load = 276e3_dp, depth = 0.7e-3_dp, mate_depth = 3e-3_dp, half_width = 0.12e-3_dp
  !> E/(1 - nu**2).
  real(dp), parameter :: modulus = 206e9_dp/0.91_dp

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t

    if (t%wants('loaded_wedge')) call loaded_wedge(t)
    if (t%wants('punch')) call punch(t, steel)
    if (t%wants('punch')) call punch(t, material_t(young=70e9_dp, poisson=0.34_dp))
    if (t%wants('self_similar')) call self_similar(t)
    if (t%wants('beyond_the_path')) call beyond_the_path(t)
    if (t%wants('stiff_corner')) call stiff_corner(t)
    if (t%wants('whole_case')) call whole_case(t)
    if (t%wants('stiff_as_the_end')) call stiff_as_the_end(t)
    if (t%wants('creeping')) call creeping(t)
    if (t%wants('root_share')) call root_share(t)
    if (t%wants('any_load')) call any_load(t)
    if (t%wants('own_load')) call own_load(t)
    if (t%wants('moved_down')) call moved_down(t)
    if (t%wants('corner_estimate')) call corner_estimate(t)
  end subroutine run

  !> A wedge under a load P on its edge: radial stress alone, along the load's line u(h) - u(2 h) = P ln 2/E' times this (Michell
  !> 1900; Timoshenko, Goodier, Theory of Elasticity, art. 38). `angle`: between faces; `off`: of the load from the bisector.
  pure real(dp) function michell(angle, off)
    real(dp), intent(in) :: angle, off

    michell = 2*cos(off)**2/(angle + sin(angle)) + 2*sin(off)**2/(angle - sin(angle))
  end function michell

  subroutine loaded_wedge(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: angles(4) = [95, 121, 140, 180]*pi/180, tilts(3) = [0.0_dp, 0.1_dp, 0.3_dp]
    type(edge_t) :: edge
    type(error_t), allocatable :: error
    integer :: i, k

    do i = 1, size(angles)
      call make_edge([steel, steel], .true., angles(i), depth, half_width, edge, error)
      call check_no_error(t, 'wedge', error)
      do k = 1, size(tilts)
        call check_close(t, 'wedge of '//str(angles(i)*180/pi, 3)//' degrees', &
                         edge_deflection(edge, depth, tilts(k)) - edge_deflection(edge, 2*depth, tilts(k)), &
                         michell(angles(i), pi/2 - angles(i)/2 - tilts(k))*log(2.0_dp)/modulus, relative=1e-2_dp)
      end do
    end do
  end subroutine loaded_wedge

  !> A half plane under a punch that has an edge, tilted by g and rounded by 1/R: contact from the edge to c, with
  !> pressure E*/2 ((x + c/2)/R + g) sqrt((c - x)/x) and so a load of pi E* (3 c**2/(16 R) + g c/4) (Muskhelishvili's inversion,
  !> bounded at c: Johnson 1985, Contact Mechanics, section 2.7). With two half planes 1/E* = 2/E'. The approach is that of
  !> the edge, through the mean of the logarithm. The mate may be of another material.
  subroutine punch(t, mate)
    type(tally_t), intent(inout) :: t
    type(material_t), intent(in) :: mate
    real(dp), parameter :: tilts(4) = [0.0_dp, 0.02_dp, 0.06_dp, 0.15_dp], curvature = 1/4.4e-3_dp
    integer, parameter :: points = 400
    type(edge_t) :: edge
    type(error_t), allocatable :: error
    real(dp) :: c, mean, found, p, weight
    integer :: i, k

    call make_edge([steel, mate], .true., pi, depth, half_width, edge, error)
    call check_no_error(t, 'half plane', error)
    do k = 1, size(tilts)
      associate (a => 3*curvature/16, b => tilts(k)/4)
        c = (-b + sqrt(b**2 + 4*a*load/pi*(1/modulus + (1 - mate%poisson**2)/mate%young)))/(2*a)
      end associate
      ! x = c sin(u)**2 takes the root away.
      mean = 0
      weight = 0
      do i = 1, points
        associate (u => pi/2*(i - 0.5_dp)/points)
          p = cos(u)**2*(c*curvature*(sin(u)**2 + 0.5_dp) + tilts(k))
          mean = mean + p*log(c*sin(u)**2)
          weight = weight + p
        end associate
      end do
      mean = mean/weight
      call edge_compliance(edge, load, tilts(k), curvature, 0.0_dp, mate_depth, found, error)
      call check_no_error(t, 'punch', error)
      ! The load's line, and with it the depth's, leans by the tilt.
      call check_close(t, 'edge of a punch, tilt '//str(tilts(k)), found, 2*kernel(steel, depth) - kernel(steel, 2*depth) &
                       + kernel(mate, mate_depth), relative=2e-2_dp)
    end do

  contains

    !> Surface at the mean distance to a depth: Hertz's pressure has the mean logarithm log(a/2) - 1/2.
    real(dp) function kernel(material, below)
      type(material_t), intent(in) :: material
      real(dp), intent(in) :: below

      kernel = surface_to_depth(material, .true., 2*exp(mean + 0.5_dp), below)
    end function kernel
  end subroutine punch

  !> Flat faces at an angle have no length of their own: half the load presses on half the width, and both surfaces go down by
  !> their logarithms of it.
  subroutine self_similar(t)
    type(tally_t), intent(inout) :: t
    type(edge_t) :: edge
    type(error_t), allocatable :: error
    real(dp) :: whole, half
    real(dp), parameter :: angle = 121*pi/180, tilt = 0.08_dp

    call make_edge([steel, steel], .true., angle, depth, half_width, edge, error)
    call edge_compliance(edge, load, tilt, 0.0_dp, 0.0_dp, mate_depth, whole, error)
    call edge_compliance(edge, load/2, tilt, 0.0_dp, 0.0_dp, mate_depth, half, error)
    call check_no_error(t, 'flat faces', error)
    call check_close(t, 'half the load', half - whole, (michell(angle, pi/2 - angle/2 - tilt) + 2/pi)*log(2.0_dp)/modulus, &
                     relative=3e-2_dp)
  end subroutine self_similar

  !> Within the path the corners change nothing under a load that hardly bends the teeth. Under more, each contact moves down the
  !> flank of the tooth that deflects more: to the place u = -F R C'(u)/2, found step by step along both teeth's compliances, where
  !> the pair deflects F C(u) + u**2/(2 R); F is 0.3 of the load.
  subroutine moved_down(t)
    type(tally_t), intent(inout) :: t
    type(fe_options_t) :: options
    type(pair_t) :: pair
    type(tooth_t) :: tooth(2)
    type(piecewise_t) :: plain, curve
    type(disc_t) :: disc
    type(error_t), allocatable :: error
    real(dp), parameter :: h = 1e-6_dp
    real(dp) :: s, ends(2), here(2), radius, u, expected
    integer :: i, k

    pair = dogan_pair([22, 41])
    do k = 1, 2
      associate (line_load => merge(load/100, load, k == 1))
        options%corner_contact = .false.
        call fe_stiffness(pair, [steel, steel], options, line_load, plain, disc, error)
        options%corner_contact = .true.
        call fe_stiffness(pair, [steel, steel], options, line_load, curve, disc, error)
        call check_no_error(t, 'stiffness with corners', error)
        do i = 1, 2
          ends = pair%curvature(i, [0.0_dp, pair%contact_ratio])
          call tooth_compliance(pair%gear(i), steel, options, minval(ends), maxval(ends), tooth(i), error)
          call check_no_error(t, 'tooth', error)
        end do
        do i = 0, 40
          s = 0.05_dp + (pair%contact_ratio - 0.1_dp)*i/40
          if (k == 1) call check_close(t, 'as without corners', curve%value(s), plain%value(s), relative=2e-4_dp)
          here = [pair%curvature(1, s), pair%curvature(2, s)]
          radius = 1/sum(1/here)
          u = 0
          u = -0.3_dp*line_load*radius*(yield_at(u + h) - yield_at(u - h))/(4*h)
          u = -0.3_dp*line_load*radius*(yield_at(u + h) - yield_at(u - h))/(4*h)
          expected = yield_at(0.0_dp) - yield_at(u) - u**2/(2*radius*0.3_dp*line_load)
          call check_close(t, 'contact moved', pair%gear(1)%spec%face_width*(1/plain%value(s) - 1/curve%value(s)), expected, &
                           absolute=3e-4_dp*pair%gear(1)%spec%face_width/plain%value(s))
        end do
      end associate
    end do

  contains

    !> How far both teeth deflect (m2/N) with the contact u farther up the pinion's flank, m.
    real(dp) function yield_at(u)
      real(dp), intent(in) :: u

      yield_at = tooth(1)%compliance%value(sqrt(here(1)**2 + 2*u*pair%gear(1)%base_radius(drive))) &
                 + tooth(2)%compliance%value(sqrt(here(2)**2 - 2*u*pair%gear(2)%base_radius(drive)))
    end function yield_at
  end subroutine moved_down

  !> Continuous at A and E, alike at both ends of equal gears; softer beyond.
  subroutine beyond_the_path(t)
    type(tally_t), intent(inout) :: t
    type(fe_options_t) :: options
    type(pair_t) :: pair
    type(piecewise_t) :: plain, curve
    type(disc_t) :: disc
    type(error_t), allocatable :: error
    integer, parameter :: teeth(2, 2) = reshape([25, 25, 22, 41], [2, 2])
    real(dp) :: ends(2), hair
    integer :: i, k

    do k = 1, 2
      options%corner_contact = .false.
      pair = dogan_pair(teeth(:, k))
      call fe_stiffness(pair, [steel, steel], options, load, plain, disc, error)
      options%corner_contact = .true.
      call fe_stiffness(pair, [steel, steel], options, load, curve, disc, error)
      call check_no_error(t, 'stiffness with corners', error)
      ends = curve%breaks([1, size(curve%breaks)])
      call check_true(t, 'reaches beyond the path', ends(1) < -0.1_dp .and. ends(2) > pair%contact_ratio + 0.1_dp, str(ends(1)))
      hair = 1e-9_dp
      call check_close(t, 'continuous at A', curve%value(-hair), curve%value(hair), relative=1e-6_dp)
      call check_close(t, 'continuous at E', curve%value(pair%contact_ratio - hair), curve%value(pair%contact_ratio + hair), &
                       relative=1e-6_dp)
      do i = 0, 40
        if (k == 1) call check_close(t, 'equal gears', curve%value(ends(1) + (ends(2) - ends(1))*i/40), &
                                     curve%value(ends(2) - (ends(2) - ends(1))*i/40), relative=1e-9_dp)
      end do
      call check_true(t, 'an edge is softer', curve%value(-0.05_dp) < 0.97_dp*plain%value(0.0_dp) .and. &
                      curve%value(-0.05_dp) > 0.8_dp*plain%value(0.0_dp), str(curve%value(-0.05_dp)/plain%value(0.0_dp)))
    end do
  end subroutine beyond_the_path

  !> A tooth far stiffer than its mate has a stiff corner: at A, where the gear's touches, and at E, where the pinion's does, the
  !> contact is that of a punch with an edge on the mate alone. What it deflects beside Hertz's contact, cut nowhere, is the
  !> difference of two logarithms (see `punch`). The other way round the corner deflects and the mate does not, which is another.
  subroutine stiff_corner(t)
    type(tally_t), intent(inout) :: t
    type(material_t), parameter :: diamond = material_t(young=206e15_dp)
    integer, parameter :: points = 400
    ! The difference is the same under any load, and teeth that hardly bend do not move the contact.
    real(dp), parameter :: light = load/100
    type(fe_options_t) :: options
    type(pair_t) :: pair
    type(piecewise_t) :: plain, curve
    type(disc_t) :: disc
    type(error_t), allocatable :: error
    type(material_t) :: both(2)
    real(dp) :: s, a, c, mean, weight, expected
    integer :: i, end_of_path

    pair = dogan_pair([25, 32])
    options%section%elements_across = 8
    do end_of_path = 1, 2
      both = [steel, diamond]
      s = -1e-9_dp
      if (end_of_path == 2) both = [diamond, steel]
      if (end_of_path == 2) s = pair%contact_ratio + 1e-9_dp
      options%corner_contact = .false.
      call fe_stiffness(pair, both, options, light, plain, disc, error)
      options%corner_contact = .true.
      call fe_stiffness(pair, both, options, light, curve, disc, error)
      call check_no_error(t, 'a stiff gear', error)
      associate (sum_of => 1/pair%curvature(1, s) + 1/pair%curvature(2, s))
        a = sqrt(4*light/(pi*modulus*sum_of))
        c = sqrt(16*light/(3*pi*modulus*sum_of))
      end associate
      mean = 0
      weight = 0
      do i = 1, points
        associate (u => pi/2*(i - 0.5_dp)/points)
          mean = mean + cos(u)**2*(sin(u)**2 + 0.5_dp)*log(c*sin(u)**2)
          weight = weight + cos(u)**2*(sin(u)**2 + 0.5_dp)
        end associate
      end do
      expected = 2/(pi*modulus)*(log(a/2) - 0.5_dp - mean/weight)
      call check_close(t, 'a stiff corner', pair%gear(1)%spec%face_width*(1/curve%value(s) - 1/plain%value(min( &
                       pair%contact_ratio, max(0.0_dp, s)))), expected, absolute=2e-2_dp/modulus)
    end do
  end subroutine stiff_corner

  !> Dogan et al. 2021, case 1, as the program has it, against an independent model with the exact gap of the corner, whose
  !> corner was as stiff as A: transmission error, where contact begins, and the same with neighbours and Hertz by own load.
  subroutine whole_case(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: text = '&case tasks=''mesh'' / &pair module_mm=3.18 face_width_mm=25.4 / &section teeth=3 / '// &
      '&pinion teeth=25 / &gear teeth=25 / &load line_load_n_mm=276 / &relief amount_um=0, 10 / &mesh model=''fe'''
    character(*), parameter :: alone = ' tooth_coupling=.false. nonlinear_contact=.false.'
    type(answer_t) :: answer
    type(corner_t), allocatable :: corner(:)
    real(dp), allocatable :: peak(:), length(:), s(:), share(:), touched(:)

    call ask(t, text//alone//' /', answer)
    peak = answer%all_of('transmission_error.peak_to_peak_um')
    length = answer%all_of('transmission_error.effective_contact_ratio')
    call check_close(t, 'peak-to-peak with corners', peak(1), 7.159_dp, relative=5e-3_dp)
    call check_close(t, 'and 10 um', peak(2), 2.669_dp, relative=2e-2_dp)
    call check_close(t, 'contact begins early', (length(1) - answer%one('geometry.contact_ratio'))/2, 0.073_dp, absolute=1.5e-3_dp)
    call check_close(t, 'and with 10 um', (length(2) - answer%one('geometry.contact_ratio'))/2, 0.047_dp, absolute=1.5e-3_dp)
    s = answer%all_of('mesh.s')
    share = answer%all_of('mesh.load_share')
    touched = answer%all_of('mesh.pinion_radius_mm')
    call check_true(t, 'load at the tip corner', maxval(share, mask=s < -0.03_dp) > 0.02_dp .and. all(share >= 0))
    ! A radius of 37.836 mm.
    call check_true(t, 'the corner meets the pinion above A', minval(touched, mask=s < -1e-3_dp) > 37.84_dp)
    call ask(t, text//' /', answer)
    peak = answer%all_of('transmission_error.peak_to_peak_um')
    call check_close(t, 'with neighbours and own flattening', peak(1), 6.63_dp, relative=5e-3_dp)
    call ask(t, text//alone//' corner_contact=.false. /', answer)
    peak = answer%all_of('transmission_error.peak_to_peak_um')
    call check_close(t, 'without corners', peak(1), 7.375_dp, relative=5e-3_dp)
    length = answer%all_of('transmission_error.effective_contact_ratio')
    call check_close(t, 'ends at A and E', length(1), answer%one('geometry.contact_ratio'), relative=1e-9_dp)
  end subroutine whole_case

  !> What models that know teeth on the path alone take beyond A and E, the stiffness of the end with the lever arm of the corner,
  !> against finite elements with the edge: these are softer, at A by 2 % and where contact begins, 0.073 base pitches before A
  !> (`whole_case`), by nearly a tenth.
  subroutine stiff_as_the_end(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: teeth(2, 3) = reshape([25, 25, 22, 41, 19, 60], [2, 3])
    type(fe_options_t) :: options
    type(pair_t) :: pair
    type(piecewise_t) :: curve, plain
    type(disc_t) :: disc
    type(error_t), allocatable :: error
    real(dp) :: softer(0:10)
    integer :: kind, i

    do kind = 1, size(teeth, 2)
      pair = dogan_pair(teeth(:, kind))
      options%corner_contact = .true.
      call fe_stiffness(pair, [steel, steel], options, load, curve, disc, error)
      call check_no_error(t, 'with the edge', error)
      options%corner_contact = .false.
      call fe_stiffness(pair, [steel, steel], options, load, plain, disc, error)
      call check_no_error(t, 'without', error)
      call add_corner_stiffness(pair, load*pair%gear(1)%spec%face_width, plain)
      softer = [(1 - curve%value(-0.0073_dp*i)/plain%value(-0.0073_dp*i), i=0, 10)]
      call check_true(t, 'softer than the end', all(softer > 0 .and. softer < 0.1_dp), str(maxval(softer)))
      if (kind > 1) cycle
      call check_close(t, 'at A', softer(0), 0.02_dp, absolute=5e-3_dp)
      call check_close(t, 'where contact begins', softer(10), 0.095_dp, absolute=3e-3_dp)
    end do
  end subroutine stiff_as_the_end

  !> Where pairs come and go under load beyond A and E nothing jumps, so that a motion of 1 rpm is the static one: its largest pair
  !> load is that of the static load sharing, with any model of the teeth, damping and relief. In the last pair two and three share
  !> the load. What the corners' stiffness leaves open is told. Without the corners a pair takes up its load in one blow.
  subroutine creeping(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: gears(2) = [character(120) :: '&pinion teeth=25 / &gear teeth=25', &
      '&pinion teeth=40 addendum=1.35 dedendum=1.5 / &gear teeth=60 addendum=1.35 dedendum=1.5']
    character(*), parameter :: models(3) = [character(7) :: 'weber', 'iso6336', 'fe']
    character(*), parameter :: ratios(3) = [character(4) :: '0.03', '0.1', '0.17']
    type(answer_t) :: answer
    real(dp), allocatable :: found(:), share(:)
    integer :: i, k, pair

    do pair = 1, size(gears)
      do i = 1, size(models)
        do k = 1, size(ratios)
          call ask(t, '&case tasks=''mesh'', ''sweep'' / &pair module_mm=3 face_width_mm=20 / '// &
            trim(gears(pair))//' / &load line_load_n_mm=276 / &relief amount_um=0, 8, 20 / &section elements_across=4 / '// &
            '&mesh nonlinear_contact=.false. model='''//trim(models(i))//''' / &dynamics damping_ratio='//ratios(k)// &
            ' / &sweep rpm_first=1 rpm_last=1 rpm_step=1 /', answer)
          found = answer%all_of('sweep_worst.worst_dynamic_factor')
          share = answer%all_of('transmission_error.largest_load_share')
          call check_close(t, trim(models(i))//', damping ratio '//ratios(k), maxval(abs(found - share)), 0.0_dp, absolute=1e-3_dp)
          found = answer%all_of('sweep_worst.corner_estimate')
          share = answer%all_of('transmission_error.corner_estimate_um')
          call check_true(t, 'what is left open of the corners', all(found >= 0) .and. all(share >= 0) &
                          .and. found(1) > 0 .and. share(1) > 0)
        end do
      end do
    end do
    do k = 1, size(ratios)
      call ask(t, '&case tasks=''sweep'' / &pair module_mm=3.18 face_width_mm=25.4 / &pinion teeth=25 / &gear teeth=25 / '// &
        '&load line_load_n_mm=276 / &section teeth=3 / &mesh corner_contact=.false. / &dynamics damping_ratio='//ratios(k)// &
        ' / &sweep rpm_first=1 rpm_last=1 rpm_step=1 /', answer)
      associate (blow => answer%one('sweep_worst.worst_dynamic_factor'))
        call check_true(t, 'a blow at A', blow > 1.2_dp .and. blow < 1.4_dp, str(blow))
      end associate
    end do
  end subroutine creeping

  !> With corners the share has no jumps where a pair comes, and the largest root stress lies before: the default positions of
  !> the load find it nearly as well as ten times as many. It is less than without, as the load is alone on a shorter way.
  subroutine root_share(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: text = '&case tasks=''static'' / &pair module_mm=3.18 face_width_mm=25.4 / '// &
      '&pinion teeth=25 / &gear teeth=25 / &load line_load_n_mm=276 / &relief amount_um=0, 10 / '// &
      '&section elements_across=6 / &mesh model=''fe'''
    type(answer_t) :: answer
    real(dp), allocatable :: usual(:), many(:), without(:), s(:), share(:)
    integer :: i

    call ask(t, text//' /', answer)
    usual = answer%all_of('root_stress.tension_mpa')
    s = answer%all_of('static.s')
    share = answer%all_of('static.load_share')
    call ask(t, text//' / &static positions=330 /', answer)
    many = answer%all_of('root_stress.tension_mpa')
    call ask(t, text//' corner_contact=.false. /', answer)
    without = answer%all_of('root_stress.tension_mpa')
    do i = 1, 2
      call check_close(t, 'largest root tension', usual(i), many(i), relative=6e-3_dp)
      call check_true(t, 'less than without corners', many(i) < 0.99_dp*without(i))
    end do
    call check_true(t, 'load on the tip', minval(share, mask=s < 1e-6_dp) > 0.05_dp, str(minval(share, mask=s < 1e-6_dp)))
  end subroutine root_share

  !> A pair deflects by its own load beyond A and E too: the compliance that its contact problem has under a smaller load is that
  !> under the nominal one and what the load's logarithm adds, from half of the load to a thirtieth.
  subroutine own_load(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: teeth(2, 2) = reshape([25, 25, 22, 41], [2, 2])
    real(dp), parameter :: parts(3) = [0.5_dp, 0.1_dp, 0.03_dp], within(3) = [1e-2_dp, 1e-2_dp, 2e-2_dp]
    type(fe_options_t) :: options
    type(flattening_t) :: flattening
    type(pair_t) :: pair
    type(piecewise_t) :: whole, small
    type(disc_t) :: disc
    type(error_t), allocatable :: error
    integer :: i, j, k

    options%corner_contact = .true.
    do k = 1, size(teeth, 2)
      pair = dogan_pair(teeth(:, k))
      call fe_stiffness(pair, [steel, steel], options, load, whole, disc, error, flattening)
      call check_no_error(t, 'stiffness with flattening', error)
      do i = 1, size(parts)
        call fe_stiffness(pair, [steel, steel], options, parts(i)*load, small, disc, error)
        do j = 0, 8
          ! As far as the smaller load reaches.
          associate (before => small%breaks(1)*j/8, behind => (small%breaks(size(small%breaks)) - pair%contact_ratio)*j/8)
            call check_close(t, 'before A under '//str(parts(i))//' of the load', 1/small%value(before), &
                             by_law(before, parts(i)), relative=within(i))
            call check_close(t, 'behind E under '//str(parts(i))//' of the load', 1/small%value(pair%contact_ratio + behind), &
                             by_law(pair%contact_ratio + behind, parts(i)), relative=within(i))
          end associate
        end do
      end do
      call check_true(t, 'an edge deflects more to a small load', all(flattening%at_end > 1.3_dp*flattening%within) .and. &
                      all(flattening%beyond > 2*flattening%within))
    end do

  contains

    real(dp) function by_law(s, part)
      real(dp), intent(in) :: s, part

      by_law = 1/whole%value(s) - flattening%at(s, pair%contact_ratio)*log(part)
    end function by_law
  end subroutine own_load

  !> Contact beyond the path grows with the load and vanishes with it.
  subroutine any_load(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: loads(5) = [1e-6_dp, 1.0_dp, 1e3_dp, 1e5_dp, 1e6_dp]
    type(fe_options_t) :: options
    type(pair_t) :: pair
    type(piecewise_t) :: curve
    type(disc_t) :: disc
    type(corner_t) :: corner
    type(error_t), allocatable :: error
    real(dp) :: before
    integer :: i, k

    pair = dogan_pair([25, 25])
    options%corner_contact = .true.
    options%section%elements_across = 8
    before = 0
    do i = 1, size(loads)
      call fe_stiffness(pair, [steel, steel], options, loads(i), curve, disc, error)
      call check_no_error(t, 'stiffness under any load', error)
      if (i == 1) call check_close(t, 'no load to speak of', curve%breaks(1), 0.0_dp, absolute=1e-15_dp)
      if (i > 2) call check_true(t, 'farther under more load', curve%breaks(1) < before, str(curve%breaks(1)))
      before = curve%breaks(1)
      ! At the corner along the mate's normal.
      corner = corner_contact(pair, curve%breaks(1))
      call check_true(t, 'softest at a corner, stiffest on the path', &
                      curve%minimum()/corner%part_along**2 > 0.75_dp*curve%value(0.05_dp) .and. &
                      curve%maximum() < 1.001_dp*maxval([(curve%value(pair%contact_ratio*k/200), k=0, 200)]), str(loads(i))//' '// &
                      str(curve%minimum()/curve%value(0.05_dp))//' '//str(curve%maximum()/curve%value(pair%contact_ratio/2)))
    end do
  end subroutine any_load

  !> What is ours to choose moves the stiffness beyond the path little: the grid, and the depth at which it ends.
  subroutine corner_estimate(t)
    type(tally_t), intent(inout) :: t
    type(fe_options_t) :: options
    type(pair_t) :: pair
    type(piecewise_t) :: usual, other
    type(disc_t) :: disc
    type(error_t), allocatable :: error
    integer :: i

    pair = dogan_pair([25, 25])
    options%corner_contact = .true.
    call fe_stiffness(pair, [steel, steel], options, load, usual, disc, error)
    options%section%elements_across = 32
    options%section%others_across = 4
    call fe_stiffness(pair, [steel, steel], options, load, other, disc, error)
    do i = 0, 8
      call check_close(t, 'corner, finer grid', usual%value(-0.02_dp*i), other%value(-0.02_dp*i), relative=1e-2_dp)
    end do
    options%depth = 0.25_dp
    call fe_stiffness(pair, [steel, steel], options, load, other, disc, error)
    do i = 0, 8
      call check_close(t, 'corner, other depth', usual%value(-0.02_dp*i), other%value(-0.02_dp*i), relative=2e-2_dp)
    end do
    call check_no_error(t, 'stiffness with corners', error)
  end subroutine corner_estimate
end module test_elastic_corner
