!> How far a body deflects under all its teeth: closed forms of an annulus,
!> two teeth loaded at once, on whole gears and on sections, and that no share of the load changes it.
module test_elastic_disc
  use test_support_gears, only: dogan_gear
  use gearsweep_elastic_body, only: body_t, make_body
  use gearsweep_study_case_case, only: case_t
  use gearsweep_api_case_reader, only: read_case
  use gearsweep_elastic_compliance, only: deflection_at_depth, disc_compliance, flank_load, tooth_compliance, tooth_t, turning
  use gearsweep_elastic_disc, only: disc_t
  use gearsweep_base_error, only: error_t
  use gearsweep_elastic_fe_stiffness, only: fe_options_t, fe_stiffness
  use gearsweep_elastic_flattening, only: surface_to_depth
  use gearsweep_gear_gear, only: drive, gear_spec_t, gear_t, make_gear
  use gearsweep_elastic_grid, only: grid_t, make_grid
  use gearsweep_mesh_harmonics, only: find_harmonics, harmonics_t
  use gearsweep_base_kinds, only: dp, pi
  use gearsweep_elastic_material, only: material_t
  use gearsweep_mesh_mesh, only: mesh_t
  use gearsweep_gear_pair, only: make_pair, pair_t
  use gearsweep_base_piecewise, only: piecewise_t
  use gearsweep_gear_relief, only: profile_error, relief_t
  use gearsweep_elastic_section, only: make_section, section_options_t, section_t
  use gearsweep_study_run_study, only: run_study, study_t
  use gearsweep_api_tables, only: column_of
  use gearsweep_base_text, only: str
  use test_support_testing, only: tally_t, check_true, check_close, check_no_error
  implicit none
  private
  public :: run

  real(dp), parameter :: line_load = 280e3_dp

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t

    if (t%wants('annulus')) call annulus(t)
    if (t%wants('small_bores')) call small_bores(t)
    if (t%wants('superelement')) call superelement(t)
    if (t%wants('two_teeth')) call two_teeth(t)
    if (t%wants('shrinking_bore')) call shrinking_bore(t)
    if (t%wants('sections_share')) call sections_share(t)
    if (t%wants('third_tooth')) call third_tooth(t)
    if (t%wants('any_support')) call any_support(t)
    if (t%wants('exported_matrix')) call exported_matrix(t)
  end subroutine run

  !> An annulus held at its inner circle, under a couple M that pulls evenly along the outer one:
  !> u/r = M/(4 pi G t) (1/ri**2 - 1/r**2), whose mean over the moment of inertia has 2/(ro**2 + ri**2)
  !> in place of 1/r**2.
  subroutine annulus(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: columns = 24, rows = 16
    real(dp), parameter :: ri = 0.01_dp, ro = 0.05_dp, width = 0.02_dp, couple = 300
    type(material_t), parameter :: steel = material_t()
    type(grid_t) :: grid
    type(body_t) :: body
    type(error_t), allocatable :: error
    real(dp) :: points(2, 0:2*columns, 0:2*rows), per_couple
    real(dp), allocatable :: f(:, :), x(:), u(:, :)
    integer :: part(columns, rows), i, j

    do j = 0, 2*rows
      do i = 0, 2*columns
        associate (angle => pi*mod(i, 2*columns)/columns)
          points(:, i, j) = ri*(ro/ri)**(real(j, dp)/(2*rows))*[sin(angle), cos(angle)]
        end associate
      end do
    end do
    part = 0
    call make_grid(points, part, .true., grid, error)
    call check_no_error(t, 'annulus', error)
    call make_body(grid, steel, .false., width, spread(norm2(grid%x, 1) < 1.0001_dp*ri, 1, 2), 1e9_dp, body, error)
    call check_no_error(t, 'body of the annulus', error)
    allocate (f(2, size(grid%x, 2)), source=0.0_dp)
    do i = 0, 2*columns - 1
      associate (n => grid%node(i, 2*rows))
        ! Simpson's weights belong to even traction on quadratic edges.
        f(:, n) = merge(1, 2, mod(i, 2) == 0)*couple/(3*columns*ro)*[-grid%x(2, n), grid%x(1, n)]/ro
      end associate
    end do
    x = body%gather(f)
    call body%stiffness%solve(x, error)
    u = body%spread_out(x)
    per_couple = (1 + steel%poisson)/(2*pi*steel%young*width)
    call check_close(t, 'twist of an annulus', -u(1, grid%node(0, 2*rows))/ro, couple*per_couple*(1/ri**2 - 1/ro**2), 1e-4_dp)
    call check_close(t, 'its mean', dot_product(turning(body), x), couple*per_couple*(1/ri**2 - 2/(ro**2 + ri**2)), 1e-4_dp)
    ! The same the other way round: what turns with the mean under a couple on the whole body.
    x = turning(body)
    call body%stiffness%solve(x, error)
    call check_close(t, 'reciprocity', dot_product(body%gather(f), x), couple*per_couple*(1/ri**2 - 2/(ro**2 + ri**2)), 1e-4_dp)
  end subroutine annulus

  !> On a small bore nearly all of the twist is beside the bore, where the gear is an annulus: the
  !> same closed form with the couple of a unit force at the base circle, and teeth by their area.
  subroutine small_bores(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: bore(3) = [0.001_dp, 0.002_dp, 0.004_dp]
    type(material_t), parameter :: steel = material_t()
    type(section_t) :: section
    type(body_t) :: body
    type(disc_t) :: disc
    type(error_t), allocatable :: error
    real(dp) :: outer, expected
    integer :: i

    do i = 1, size(bore)
      call whole_gear(dogan_gear(25, bore(i)), 6, section, body, error)
      if (.not. allocated(error)) call disc_compliance(section, body, 0.006_dp, 0.020_dp, disc, error)
      call check_no_error(t, 'disc', error)
      outer = sqrt(section%grid%area()/pi + bore(i)**2)
      expected = section%gear%base_radius(drive)**2*(1 + steel%poisson)/(2*pi*steel%young) &
                 *(1/bore(i)**2 - 2/(outer**2 + bore(i)**2))
      call check_close(t, 'turn about a bore of '//str(1000*bore(i))//' mm', disc%turn, expected, relative=3e-3_dp)
    end do
  end subroutine small_bores

  !> A complete gear whose distant teeth are a superelement deflects as the same gear with a grid of all teeth: odd and even
  !> numbers of them, an assumed bore, other teeth coarser than the loaded one, unequal flanks.
  subroutine superelement(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: teeth(4) = [25, 31, 40, 13]
    real(dp), parameter :: bore(4) = [0.010_dp, 0.002_dp, 0.0_dp, 0.002_dp]
    type(fe_options_t) :: options
    type(gear_t) :: gear
    type(section_t) :: section
    type(body_t) :: body
    type(disc_t) :: disc
    type(tooth_t) :: tooth
    type(error_t), allocatable :: error
    real(dp) :: first, last, curvature, radius(1), depth(1), near(1), far(1), angle, chord, expected
    integer :: i

    options%section%teeth = 0
    options%section%elements_across = 8
    do i = 1, size(teeth)
      gear = dogan_gear(teeth(i), bore(i))
      if (i == 2) gear = dogan_gear(teeth(i), bore(i), [25.0_dp, 20.0_dp])
      associate (base => gear%base_radius(drive))
        last = sqrt(gear%tip_radius**2 - base**2)
        first = last - 1.3_dp*2*pi*base/teeth(i)
        ! At a knot of the spline, half of the positions up.
        curvature = first + (last - first)*sin(pi/4)
        radius = hypot(base, curvature)
      end associate
      call tooth_compliance(gear, material_t(), options, first, last, tooth, error)
      call check_no_error(t, 'with a superelement', error)
      if (.not. allocated(error)) call make_section(gear, options%section, section, error)
      if (.not. allocated(error)) call make_body(section%grid, material_t(), options%section%plane_strain, 1.0_dp, &
                                                 spread(section%is_held(), 1, 2), 8e9_dp, body, error)
      if (.not. allocated(error)) call disc_compliance(section, body, first, last, disc, error)
      call check_no_error(t, 'grid of all teeth', error)
      if (allocated(error)) return
      call check_true(t, 'all teeth', section%grid%closed .and. body%rest%teeth == 0)
      call check_close(t, 'turn', tooth%disc%turn, disc%turn, relative=1e-9_dp)
      call check_close(t, 'shared', tooth%disc%shared, disc%shared, relative=1e-9_dp)
      call check_close(t, 'decline', tooth%disc%decline, disc%decline, relative=1e-9_dp)
      call check_close(t, 'change', tooth%disc%change(1), disc%change(1), absolute=1e-9_dp*disc%shared)
      associate (m => gear%spec%module, steel => material_t(), strain => options%section%plane_strain)
        ! As deep as there: rounded off where the tooth is thin.
        angle = gear%half_angle(drive, radius(1))
        chord = 2*radius(1)*sin(angle)/cos(acos(gear%base_radius(drive)/radius(1)) - angle)
        depth = ((options%depth*m)**(-8) + (0.35_dp*chord)**(-8))**(-0.125_dp)
        call deflection_at_depth(section, body, radius, depth, 2*depth, near, far, error)
        expected = 2*(near(1) + surface_to_depth(steel, strain, m, depth(1))) &
                   - (far(1) + surface_to_depth(steel, strain, m, 2*depth(1))) - surface_to_depth(steel, strain, 1.0_dp, 1.0_dp) &
                   - disc%turn
        call check_close(t, 'tooth', tooth%compliance%value(curvature), expected, relative=1e-9_dp)
      end associate
    end do
  end subroutine superelement

  subroutine whole_gear(gear, across, section, body, error)
    type(gear_t), intent(in) :: gear
    integer, intent(in) :: across
    type(section_t), intent(out) :: section
    type(body_t), intent(out) :: body
    type(error_t), allocatable, intent(out) :: error

    call make_section(gear, section_options_t(teeth=0, plane_strain=.true., elements_across=across), section, error)
    if (.not. allocated(error)) call make_body(section%grid, material_t(), .true., 1.0_dp, spread(section%is_held(), 1, 2), &
                                               8e9_dp, body, error)
  end subroutine whole_gear

  !> Two neighbours loaded at once, all along their common path: what one moves the other by is the disc's turning and a
  !> parabola, within a five-hundredth of how far the tooth deflects alone; without the disc it is 28 to 97 %.
  subroutine two_teeth(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: bore(3) = [0.002_dp, 0.010_dp, 0.020_dp], module = 0.00318_dp
    integer, parameter :: places = 5
    type(section_t) :: section
    type(body_t) :: body
    type(pair_t) :: pair
    type(disc_t) :: disc
    type(error_t), allocatable :: error
    real(dp) :: radius(2), near(2), far(2), both, ends(2), shared(0:2)
    integer :: i, k

    do i = 1, size(bore)
      associate (gear => dogan_gear(25, bore(i)))
        call make_pair(gear, gear, 2*gear%reference_radius, pair, error)
        call whole_gear(gear, 8, section, body, error)
      end associate
      ends = pair%curvature(1, [0.0_dp, pair%contact_ratio])
      call disc_compliance(section, body, ends(1), ends(2), disc, error)
      call check_no_error(t, 'disc of '//str(1000*bore(i))//' mm', error)
      do k = 0, places - 1
        radius = pair%radius(1, (pair%contact_ratio - 1)*k/(places - 1) + [0, 1])
        both = moved(section, body, radius, 1)
        shared = disc%shared_at(2.0_dp*k/(places - 1) - 1)
        call deflection_at_depth(section, body, radius, [0.4_dp, 0.4_dp]*module, [0.8_dp, 0.8_dp]*module, near, far, error)
        call check_close(t, 'one tooth moves the next', disc%turn + shared(0), both, &
                         absolute=2e-3_dp*(minval(near) - disc%compliance()))
        call check_true(t, 'the disc is in it', disc%compliance() > 0.25_dp*minval(near), str(disc%compliance()/minval(near)))
      end do
    end do
  end subroutine two_teeth

  !> What a unit load on the loaded tooth at radius(1) moves the next one, or the one so many teeth ahead, by at radius(2), from
  !> a solution in full.
  real(dp) function moved(section, body, radius, ahead)
    type(section_t), intent(in) :: section
    type(body_t), intent(in) :: body
    real(dp), intent(in) :: radius(2)
    integer, intent(in) :: ahead
    type(error_t), allocatable :: error
    real(dp) :: x(body%unknowns), f(body%unknowns)

    x = 0
    f = 0
    call flank_load(section, body, radius(1), x, error)
    call flank_load(section, body, radius(2), f, error, section%loaded + ahead)
    call body%stiffness%solve(x, error)
    moved = dot_product(f, x)
  end function moved

  !> The smaller the bore, the more the discs turn; but that is the same in every position and
  !> whatever pairs carry. So the mean of the transmission error grows by the load times the turn,
  !> once, and its peak-to-peak hardly.
  subroutine shrinking_bore(t)
    type(tally_t), intent(inout) :: t
    type(mesh_t) :: small, smaller
    type(harmonics_t) :: before, after
    real(dp), parameter :: load = line_load*0.0254_dp

    small = whole_mesh(0.004_dp)
    smaller = whole_mesh(0.002_dp)
    call find_harmonics(small, load, 3, before)
    call find_harmonics(smaller, load, 3, after)
    associate (turned => (smaller%disc%turn - small%disc%turn)*load)
      call check_true(t, 'most is twist', turned > 2*before%mean, str(turned/before%mean))
      call check_close(t, 'counted once', after%mean - before%mean, turned, relative=1e-2_dp)
    end associate
    call check_close(t, 'peak-to-peak', after%peak_to_peak(), before%peak_to_peak(), relative=2e-2_dp)
    call check_close(t, 'first harmonic', after%amplitude(1), before%amplitude(1), relative=2e-2_dp)

  contains

    type(mesh_t) function whole_mesh(bore) result(mesh)
      real(dp), intent(in) :: bore
      type(fe_options_t) :: options
      type(pair_t) :: pair
      type(error_t), allocatable :: error

      associate (gear => dogan_gear(25, bore))
        call make_pair(gear, gear, 2*gear%reference_radius, pair, error)
      end associate
      mesh%contact_ratio = pair%contact_ratio
      mesh%reach = [0.0_dp, mesh%contact_ratio]
      options%section%teeth = 0
      options%section%elements_across = 8
      call fe_stiffness(pair, [material_t(), material_t()], options, line_load, mesh%stiffness, mesh%disc, error)
      call check_no_error(t, 'whole gears', error)
      call profile_error(relief_t(start=[1.0_dp, pair%contact_ratio - 1]), mesh%contact_ratio, mesh%profile_error, error)
    end function whole_mesh
  end subroutine shrinking_bore

  !> On a section held at its sides too, a tooth's load moves the next one: as a solution in full has it, along the path,
  !> within a thousandth of how far the tooth deflects alone. The two pairs' common deflection follows within a thousandth of
  !> what the transmission error varies by, where both gears' parts are one.
  subroutine sections_share(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: teeth(3) = [3, 5, 7], places = 9
    type(section_t) :: section
    type(body_t) :: body
    type(pair_t) :: pair
    type(disc_t) :: disc, both
    type(piecewise_t) :: curve
    type(fe_options_t) :: options
    type(error_t), allocatable :: error
    real(dp) :: c12(0:places - 1), c(2), s, exact(0:places - 1), ours(0:places - 1), most, shared(0:2)
    integer :: n, k

    options%section%elements_across = 8
    do n = 1, size(teeth)
      options%section%teeth = teeth(n)
      associate (gear => dogan_gear(25))
        call make_pair(gear, gear, 2*gear%reference_radius, pair, error)
        call make_section(gear, options%section, section, error)
      end associate
      call make_body(section%grid, material_t(), .true., 1.0_dp, spread(section%is_held(), 1, 2), 8e9_dp, body, error)
      associate (ends => pair%curvature(1, [0.0_dp, pair%contact_ratio]))
        call disc_compliance(section, body, ends(1), ends(2), disc, error)
      end associate
      call fe_stiffness(pair, [material_t(), material_t()], options, line_load, curve, both, error)
      call check_no_error(t, 'section of '//str(teeth(n))//' teeth', error)
      call check_close(t, 'a section does not turn', disc%turn, 0.0_dp)
      call check_close(t, 'both gears share', both%shared*0.0254_dp, 2*disc%shared, relative=1e-9_dp)
      most = 1/(curve%value(pair%contact_ratio/2)/0.0254_dp)/2
      do k = 0, places - 1
        s = (pair%contact_ratio - 1)*k/(places - 1)
        c12(k) = moved(section, body, pair%radius(1, s + [0, 1]), 1)
        shared = disc%shared_at(2.0_dp*k/(places - 1) - 1)
        call check_close(t, 'next tooth on a section', shared(0), c12(k), absolute=1e-3_dp*most)
      end do
      call check_true(t, 'it is shared', disc%shared > 0.02_dp*most, str(disc%shared/most))
      do k = 0, places - 1
        s = (pair%contact_ratio - 1)*k/(places - 1)
        c = 0.0254_dp/[curve%value(s), curve%value(s + 1)]
        ! The gear's teeth pass the path the other way round.
        exact(k) = together(c, c12(k) + c12(places - 1 - k))
        shared = both%shared_at(2.0_dp*k/(places - 1) - 1)
        ours(k) = together(c, 0.0254_dp*shared(0))
      end do
      associate (alone => 0.0254_dp/curve%value(pair%contact_ratio - 1 + 1e-6_dp))
        call check_close(t, 'both gears share', maxval(abs(ours - exact)), 0.0_dp, absolute=1e-3_dp*(alone - minval(exact)))
      end associate
    end do
  end subroutine sections_share

  !> Above a contact ratio of 2 the first of three pairs moves the third by less than the second: as a solution in full has it,
  !> along the path, within a two-hundredth of how far a tooth deflects alone; nothing where there is no such tooth on the section.
  subroutine third_tooth(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: teeth(3) = [0, 7, 3], places = 5
    type(section_options_t) :: options
    type(section_t) :: section
    type(body_t) :: body
    type(pair_t) :: pair
    type(disc_t) :: disc
    type(gear_spec_t) :: spec
    type(gear_t) :: gear
    type(error_t), allocatable :: error
    real(dp) :: ends(2), s, first, near(1), far(1)
    integer :: n, k

    spec = gear_spec_t(teeth=40, module=2.5e-3_dp, pressure_angle=17*pi/180, addendum=1.4_dp, dedendum=1.65_dp, &
                       rack_tip_radius=0.2_dp, face_width=0.01_dp, bore_radius=0.015_dp)
    call make_gear(spec, gear, error)
    call make_pair(gear, gear, 2*gear%reference_radius, pair, error)
    do n = 1, size(teeth)
      options = section_options_t(plane_strain=.true., elements_across=8, others_across=4, teeth=teeth(n))
      call make_section(gear, options, section, error)
      call make_body(section%grid, material_t(), .true., 1.0_dp, spread(section%is_held(), 1, 2), 8e9_dp, body, error)
      ends = pair%curvature(1, [0.0_dp, pair%contact_ratio])
      call disc_compliance(section, body, ends(1), ends(2), disc, error)
      call check_no_error(t, 'three pairs', error)
      call check_true(t, 'three pairs touch', pair%contact_ratio > 2.3_dp)
      if (teeth(n) == 3) then
        call check_close(t, 'no such tooth', disc%shared_beyond(), 0.0_dp, absolute=1e-25_dp)
        cycle
      end if
      do k = 0, places - 1
        s = (pair%contact_ratio - 2)*k/(places - 1)
        associate (radius => pair%radius(1, s + [0, 2]))
          call deflection_at_depth(section, body, radius(:1), [1e-3_dp], [2e-3_dp], near, far, error)
          call check_close(t, 'the tooth after the next one', disc%turn + disc%shared_beyond(), &
                           moved(section, body, radius, 2), absolute=5e-3_dp*(near(1) - disc%turn))
        end associate
        first = moved(section, body, pair%radius(1, s + [0, 1]), 1)
        call check_true(t, 'neighbours share more', first - disc%turn > 1.2_dp*disc%shared_beyond())
      end do
    end do
  end subroutine third_tooth

  !> Deflection under a unit load of two pairs with compliances `c` of their own and `coupling` between them.
  pure real(dp) function together(c, coupling)
    real(dp), intent(in) :: c(2), coupling

    together = (product(c) - coupling**2)/(sum(c) - 2*coupling)
  end function together

  !> With what neighbours share, the transmission error varies alike on any support that has neighbours on both sides; without
  !> it, the more the more body there is (an independent model found 7.11 to 7.16 um for Dogan et al. 2021, case 1).
  subroutine any_support(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: teeth(4) = [3, 5, 7, 0]
    type(mesh_t) :: mesh
    type(fe_options_t) :: options
    type(pair_t) :: pair
    type(harmonics_t) :: shared, alone
    type(error_t), allocatable :: error
    real(dp), parameter :: load = 276e3_dp*0.0254_dp
    integer :: n

    do n = 1, size(teeth)
      associate (gear => dogan_gear(25))
        call make_pair(gear, gear, 2*gear%reference_radius, pair, error)
      end associate
      options%section%teeth = teeth(n)
      mesh%contact_ratio = pair%contact_ratio
      mesh%reach = [0.0_dp, pair%contact_ratio]
      call profile_error(relief_t(start=[1.0_dp, pair%contact_ratio - 1]), mesh%contact_ratio, mesh%profile_error, error)
      options%tooth_coupling = .true.
      call fe_stiffness(pair, [material_t(), material_t()], options, load/0.0254_dp, mesh%stiffness, mesh%disc, error)
      call find_harmonics(mesh, load, 1, shared)
      options%tooth_coupling = .false.
      call fe_stiffness(pair, [material_t(), material_t()], options, load/0.0254_dp, mesh%stiffness, mesh%disc, error)
      call find_harmonics(mesh, load, 1, alone)
      call check_no_error(t, 'support', error)
      call check_close(t, 'no part is shared', mesh%disc%shared, 0.0_dp)
      call check_true(t, 'peak-to-peak on '//str(teeth(n))//' teeth', shared%peak_to_peak() > 7.10e-6_dp .and. &
                      shared%peak_to_peak() < 7.17e-6_dp, str(shared%peak_to_peak()))
      call check_true(t, 'each pair alone', alone%peak_to_peak() > 7.3e-6_dp, str(alone%peak_to_peak()))
    end do
  end subroutine any_support

  !> The table compliance is all that the load sharing has: without relief the pairs in contact have one deflection, so that the
  !> mesh stiffness of the table mesh is the sum of all elements of the inverse; one pair alone has its own stiffness; and a load
  !> here moves there what a load there moves here.
  subroutine exported_matrix(t)
    type(tally_t), intent(inout) :: t
    type(case_t) :: case
    type(study_t) :: study
    type(error_t), allocatable :: error
    real(dp), allocatable, dimension(:) :: phase, loaded, moved, compliance, s, mesh_stiffness, pair_stiffness
    real(dp) :: off(3), stiffness
    integer :: i, row, pairs, counted(2)

    call read_case('&case tasks = ''mesh'' / &pair module_mm = 3.18 pressure_angle_deg = 20 face_width_mm = 25.4 /'// &
                   '&pinion teeth = 25 addendum = 1 dedendum = 1.25 rack_tip_radius = 0.25 /'// &
                   '&gear teeth = 32 addendum = 1 dedendum = 1.25 rack_tip_radius = 0.25 /'// &
                   '&material young_gpa = 206 poisson = 0.3 / &load line_load_n_mm = 276 / &relief amount_um = 0 /'// &
                   '&mesh model = ''fe'' corner_contact = .false. nonlinear_contact = .false. /'// &
                   '&section teeth = 3 fixed = ''sides'', ''rim'' rim_mm = 8 /', case, error)
    call check_no_error(t, 'the case', error)
    if (allocated(error)) return
    call run_study(case, '', 1, study, error)
    call check_no_error(t, 'the study', error)
    phase = column_of(study, 'compliance', 'mesh_phase')
    loaded = column_of(study, 'compliance', 'loaded_s')
    moved = column_of(study, 'compliance', 'moved_s')
    compliance = column_of(study, 'compliance', 'compliance_um_n')
    s = column_of(study, 'mesh', 's')
    mesh_stiffness = column_of(study, 'mesh', 'mesh_stiffness_n_um')
    pair_stiffness = column_of(study, 'mesh', 'pair_stiffness_n_um')
    off = 0
    counted = 0
    row = 1
    do while (row <= size(phase))
      pairs = 1
      if (row < size(phase)) pairs = merge(2, 1, abs(loaded(row + 1) - moved(row + 1)) > 0)
      ! Of breaks, where one place has two stiffnesses, nothing is asked.
      if (count(abs(s - loaded(row)) < 1e-6_dp) == 1) then
        i = minloc(abs(s - loaded(row)), 1)
        counted(pairs) = counted(pairs) + 1
        if (pairs == 1) then
          off(1) = max(off(1), abs(compliance(row)*pair_stiffness(i) - 1))
        else
          associate (c => compliance(row:row + 3))
            stiffness = (c(1) + c(4) - c(2) - c(3))/(c(1)*c(4) - c(2)*c(3))
            off(2) = max(off(2), abs(stiffness/mesh_stiffness(i) - 1))
            off(3) = max(off(3), abs(c(2) - c(3))/c(1))
          end associate
        end if
      end if
      row = row + pairs**2
    end do
    call check_true(t, 'phases with one pair and with two', all(counted > 20), str(counted(1))//' '//str(counted(2)))
    call check_true(t, 'one pair', off(1) < 1e-12_dp, str(off(1)))
    call check_true(t, 'two pairs', off(2) < 1e-12_dp, str(off(2)))
    call check_true(t, 'reciprocal', off(3) < 1e-14_dp, str(off(3)))
  end subroutine exported_matrix
end module test_elastic_disc
