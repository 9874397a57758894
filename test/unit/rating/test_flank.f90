!> The contact of the flanks against closed forms and integrals: kinematics from radii alone, Hertz's stresses, Blok's
!> temperature, loss factors; and the task `flank`.
module test_flank
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use gearsweep_study_case_case, only: case_t
  use gearsweep_api_case_reader, only: read_case
  use gearsweep_base_error, only: error_t
  use gearsweep_motion_error_estimate, only: accuracy_t
  use gearsweep_rating_flank, only: contact_t, flank_contact, flash_factor, rolling_arm, sliding_ratio, surfaces_t
  use gearsweep_gear_gear, only: drive, gear_spec_t, gear_t, make_gear
  use gearsweep_mesh_deviations, only: interval_t
  use gearsweep_base_kinds, only: dp, pi
  use gearsweep_elastic_material, only: material_t
  use gearsweep_mesh_mesh, only: mesh_t
  use gearsweep_rating_mesh_losses, only: even_load_factor, followed_loss_factor, friction_rule_t, half_shares_factor, &
            mean_friction, static_loss_factor
  use gearsweep_motion_oscillator, only: make_oscillator, mesh_period, mobility, oscillator_t
  use gearsweep_gear_pair, only: free_centre_distance, make_pair, pair_t
  use gearsweep_base_piecewise, only: constant, polynomial
  use gearsweep_motion_response, only: find_response, response_t
  use gearsweep_mesh_sharing, only: pairs_at
  use gearsweep_motion_steady_motion, only: status_ok
  use gearsweep_study_run_study, only: run_study, study_t
  use gearsweep_api_tables, only: column_of
  use gearsweep_base_text, only: str
  use test_support_testing, only: check_close, check_error, check_no_error, check_true, tally_t
  implicit none
  private
  public :: run

  real(dp), parameter :: speed = 150, load = 6000      ! rad/s, N

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t

    if (t%wants('kinematics')) call kinematics(t)
    if (t%wants('beyond_the_path')) call beyond_the_path(t)
    if (t%wants('hertz')) call hertz(t)
    if (t%wants('flash')) call flash(t)
    if (t%wants('film')) call film(t)
    if (t%wants('loss_factors')) call loss_factors(t)
    if (t%wants('friction')) call friction(t)
    if (t%wants('swapped_gears')) call swapped_gears(t)
    if (t%wants('one_task')) call one_task(t)
    if (t%wants('dynamic_loads')) call dynamic_loads(t)
    if (t%wants('energy')) call energy(t)
    if (t%wants('refusals')) call refusals(t)
  end subroutine run

  !> Pairs of different kinds; `swapped` lets the gear drive.
  type(pair_t) function example(t, kind, swapped) result(pair)
    type(tally_t), intent(inout) :: t
    integer, intent(in) :: kind
    logical, intent(in), optional :: swapped
    type(gear_spec_t) :: spec(2)
    type(gear_t) :: gear(2)
    type(error_t), allocatable :: error
    real(dp) :: distance
    integer :: i

    spec = gear_spec_t('pinion', 16, 0.0045_dp, face_width=0.014_dp)
    spec(2)%teeth = 24
    spec%profile_shift = [0.1817_dp, 0.1715_dp]
    distance = 0.0915_dp
    if (kind == 2) then        ! a high ratio, with a pitch point far off the middle of the path
      spec%teeth = [17, 61]
      spec%profile_shift = [0.4_dp, 0.1_dp]
      distance = 0
    else if (kind == 3) then   ! unequal flanks
      spec%teeth = [30, 43]
      spec%profile_shift = 0
      spec(1)%pressure_angle = [27, 20]*pi/180
      spec(2)%pressure_angle = [27, 20]*pi/180
      spec(1)%rack_tip_radius = 0.1_dp
      spec(2)%rack_tip_radius = 0.1_dp
      distance = 0
    end if
    if (present(swapped)) then
      if (swapped) spec = spec([2, 1])
    end if
    do i = 1, 2
      call make_gear(spec(i), gear(i), error)
      call check_no_error(t, 'gear of pair '//str(kind), error)
    end do
    if (distance <= 0) distance = free_centre_distance(gear(1), gear(2))
    call make_pair(gear(1), gear(2), distance, pair, error)
    call check_no_error(t, 'pair '//str(kind), error)
  end function example

  !> A mesh of pairs that are as stiff everywhere and have no relief.
  type(mesh_t) function even_mesh(pair) result(mesh)
    type(pair_t), intent(in) :: pair
    real(dp) :: points(5)

    points = pair%points()
    mesh%contact_ratio = pair%contact_ratio
    mesh%reach = [0.0_dp, pair%contact_ratio]
    mesh%stiffness = constant(0.0_dp, pair%contact_ratio, 3e8_dp)
    mesh%profile_error = constant(0.0_dp, pair%contact_ratio, 0.0_dp)
    mesh%teeth = pair%gear%spec%teeth
    mesh%pitch_point = points(3)
    mesh%tan_angle = tan(pair%working_angle(drive))
  end function even_mesh

  !> On the path: sliding is the sum of both speeds of rotation times the distance from the pitch point, where both flanks
  !> roll alike; specific sliding as in ISO 21771.
  subroutine kinematics(t)
    type(tally_t), intent(inout) :: t
    type(pair_t) :: pair
    type(contact_t) :: c
    type(surfaces_t) :: surfaces
    real(dp) :: points(5), s, second
    integer :: kind, i

    do kind = 1, 3
      pair = example(t, kind)
      points = pair%points()
      c = flank_contact(pair, surfaces, 0.05_dp, speed, points(3), load)
      associate (pitch_radius => pair%centre_distance/(1 + real(pair%gear(2)%spec%teeth, dp)/pair%gear(1)%spec%teeth))
        call check_close(t, 'pure rolling at the pitch point', c%sliding, 0.0_dp, absolute=1e-13_dp*c%rolling(1))
        call check_close(t, 'with the speed of the pitch circles', c%rolling(1), &
                         speed*pitch_radius*sin(pair%working_angle(drive)), 1e-13_dp)
      end associate
      second = speed*pair%gear(1)%spec%teeth/pair%gear(2)%spec%teeth
      do i = 0, 8
        s = pair%contact_ratio*i/8
        c = flank_contact(pair, surfaces, 0.05_dp, speed, s, load)
        call check_close(t, 'sliding', c%sliding, (speed + second)*(s - points(3))*pair%base_pitch, 1e-12_dp, 1e-14_dp)
        call check_close(t, 'as in the geometry', c%sliding, pair%sliding_speed(s, speed), 1e-12_dp, 1e-14_dp)
        call check_close(t, 'specific sliding, pinion', c%specific_sliding(1), 1 - c%rolling(2)/c%rolling(1), 1e-12_dp, 1e-14_dp)
        call check_close(t, 'specific sliding, gear', c%specific_sliding(2), 1 - c%rolling(1)/c%rolling(2), 1e-12_dp, 1e-14_dp)
        call check_close(t, 'friction power', c%friction_power, 0.05_dp*load*abs(c%sliding), 1e-14_dp)
        call check_close(t, 'sliding over the base circles'' speed', sliding_ratio(pair, s)*speed* &
                         pair%gear(1)%base_radius(drive), c%sliding, 1e-12_dp, 1e-13_dp)
      end do
    end do
  end subroutine kinematics

  !> Beyond the path, from the three sides of the triangle of both centres and the corner alone: the relative velocity there is
  !> the sum of both speeds of rotation times the vector from the pitch point, and its part across the mate's normal is the
  !> sliding speed. The arms pass over steadily at A and E.
  subroutine beyond_the_path(t)
    type(tally_t), intent(inout) :: t
    type(pair_t) :: pair
    type(contact_t) :: c
    real(dp) :: s, end, mate, corner, base, x, y, pitch, along(2), ratio
    integer :: kind, side, tooth, other, i

    do kind = 1, 3
      pair = example(t, kind)
      do side = 1, 2
        tooth = 3 - side                         ! whose corner it is: the gear's before A
        other = side
        end = merge(0.0_dp, pair%contact_ratio, side == 1)
        do i = 1, 2
          call check_close(t, 'steady at the end of the path', rolling_arm(pair, i, end + merge(-1e-9_dp, 1e-9_dp, side == 1)), &
                           pair%curvature(i, end), absolute=1e-6_dp*pair%base_pitch)
        end do
        s = end + merge(-0.15_dp, 0.15_dp, side == 1)
        c = flank_contact(pair, surfaces_t(), 0.05_dp, speed, s, load)
        ! From the mate's centre, x towards the other's: place of the corner and direction of the mate's normal there.
        base = pair%gear(other)%base_radius(drive)
        mate = hypot(base, rolling_arm(pair, other, s))
        corner = pair%radius(tooth, end)
        x = (pair%centre_distance**2 + mate**2 - corner**2)/(2*pair%centre_distance)
        y = sqrt(mate**2 - x**2)
        pitch = pair%centre_distance/(1 + pair%gear(tooth)%base_radius(drive)/base)
        ! Of both tangents to the base circle the one that goes on towards the pitch point.
        along = tangent_through(x, y, base, 1)
        if ((pitch - x)*along(1) - y*along(2) < 0) along = tangent_through(x, y, base, -1)
        associate (arm => x*along(1) + y*along(2))
          call check_close(t, 'the normal touches the base circle', arm, rolling_arm(pair, other, s), 1e-10_dp)
        end associate
        associate (z => pair%gear%spec%teeth)
          ratio = 1 + real(z(1), dp)/z(2)
          call check_close(t, 'sliding of the corner of pair '//str(kind)//', end '//str(side), &
                           abs(c%sliding), speed*ratio*abs((x - pitch)*along(1) + y*along(2)), 1e-9_dp)
        end associate
        call check_true(t, 'a corner has no Hertz pressure', ieee_is_nan(c%pressure))
        call check_close(t, 'but friction', c%friction_power, 0.05_dp*load*abs(c%sliding), 1e-14_dp)
      end do
    end do

  contains

    !> Unit vector from the point where the tangent through (x, y) touches the circle about the origin, towards (x, y).
    pure function tangent_through(x, y, radius, way) result(unit)
      real(dp), intent(in) :: x, y, radius
      integer, intent(in) :: way
      real(dp) :: unit(2), angle

      angle = atan2(y, x) + way*acos(radius/hypot(x, y))
      unit = [x - radius*cos(angle), y - radius*sin(angle)]
      unit = unit/norm2(unit)
    end function tangent_through
  end subroutine beyond_the_path

  !> Half width and pressure carry the load; pressure as in Johnson's Eq. 4.44 with two moduli; the shear stress is the largest
  !> of those under the middle of the contact (Eqs. 4.46), at its depth.
  subroutine hertz(t)
    type(tally_t), intent(inout) :: t
    type(pair_t) :: pair
    type(surfaces_t) :: surfaces
    type(contact_t) :: c
    real(dp) :: modulus, line_load, radius, depth, shear(0:2000)
    integer :: i, at

    surfaces%material(2) = material_t(young=120e9_dp, poisson=0.25_dp)
    pair = example(t, 1)
    c = flank_contact(pair, surfaces, 0.05_dp, speed, 0.6_dp, load)
    line_load = load/0.014_dp
    radius = 1/(1/pair%curvature(1, 0.6_dp) + 1/pair%curvature(2, 0.6_dp))
    modulus = 1/((1 - 0.3_dp**2)/206e9_dp + (1 - 0.25_dp**2)/120e9_dp)
    call check_close(t, 'pressure', c%pressure, sqrt(line_load*modulus/(pi*radius)), 1e-12_dp)
    call check_close(t, 'pressure over the half width is the load', pi/2*c%pressure*c%half_width, line_load, 1e-13_dp)
    do i = 0, 2000
      depth = 2*c%half_width*i/2000
      associate (root => hypot(c%half_width, depth))
        shear(i) = c%pressure/c%half_width*abs((c%half_width**2 + 2*depth**2)/root - 2*depth - c%half_width**2/root)/2
      end associate
    end do
    at = maxloc(shear, 1) - 1
    call check_close(t, 'largest shear stress', c%shear_stress, shear(at), 1e-6_dp)
    call check_close(t, 'its depth', c%shear_depth, 2*c%half_width*at/2000, absolute=2*c%half_width/2000)
    c = flank_contact(pair, surfaces, 0.05_dp, speed, 0.6_dp, 0.0_dp)
    call check_close(t, 'no load, no pressure', c%pressure + c%shear_stress + c%half_width + c%flash + c%friction_power, 0.0_dp, &
                     absolute=1e-300_dp)
    call check_true(t, 'and no film', ieee_is_nan(c%film))
  end subroutine hertz

  !> The factor from the temperature of a half plane under a band of heat, distributed as Hertz's pressure, that moves over it;
  !> and the share of either flank such that both are as hot everywhere.
  subroutine flash(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: places = 400, panels = 4000
    type(pair_t) :: pair
    type(surfaces_t) :: surfaces
    type(contact_t) :: c
    real(dp) :: heat, b(2), part, x, angle, reach, sum_of, largest
    integer :: i, k

    ! T(x) = 1/(B sqrt(pi v)) times the integral of q(xi)/sqrt(x - xi) up to x, with q = 2 Q/(pi a) sqrt(1 - (xi/a)**2) and
    ! x - xi = reach**2 sin(angle)**2.
    largest = 0
    do i = 1, places
      x = -1 + 2.0_dp*i/places
      reach = sqrt(x + 1)
      sum_of = 0
      do k = 1, panels
        angle = pi/2*(k - 0.5_dp)/panels
        sum_of = sum_of + sqrt(max(0.0_dp, 1 - (x - (reach*sin(angle))**2)**2))*2*reach*cos(angle)*pi/2/panels
      end do
      largest = max(largest, sum_of*2*sqrt(2.0_dp)/pi**1.5_dp)
    end do
    call check_close(t, 'largest temperature of a moving band of heat', flash_factor, largest, 1e-5_dp)
    call check_close(t, 'Blok''s 1.11', flash_factor, 1.11_dp, absolute=0.005_dp)
    surfaces%material(2) = material_t(young=120e9_dp, poisson=0.25_dp, density=7100.0_dp)
    surfaces%conductivity(2) = 30
    surfaces%specific_heat(2) = 520
    pair = example(t, 1)
    c = flank_contact(pair, surfaces, 0.06_dp, speed, 0.1_dp, load)
    heat = c%friction_power/0.014_dp
    b = sqrt([49*7850*484.0_dp, 30*7100*520.0_dp])
    ! Each flank alone with its share of the heat.
    part = b(1)*sqrt(c%rolling(1))/(b(1)*sqrt(c%rolling(1)) + b(2)*sqrt(c%rolling(2)))
    call check_close(t, 'flash of the pinion', c%flash, flash_factor*part*heat/(b(1)*sqrt(2*c%half_width*c%rolling(1))), 1e-12_dp)
    call check_close(t, 'flash of the gear', c%flash, flash_factor*(1 - part)*heat/(b(2)*sqrt(2*c%half_width*c%rolling(2))), &
                     1e-12_dp)
  end subroutine flash

  !> Dowson's powers, and that the formula has no units: another unit of length changes nothing.
  subroutine film(t)
    type(tally_t), intent(inout) :: t
    type(pair_t) :: pair
    type(surfaces_t) :: surfaces, other
    type(contact_t) :: c, d
    real(dp) :: modulus, radius, u, g, w

    pair = example(t, 1)
    c = flank_contact(pair, surfaces, 0.05_dp, speed, 0.6_dp, load)
    ! In mm, N, s.
    modulus = 206e3_dp/(1 - 0.3_dp**2)
    radius = 1e3_dp/(1/pair%curvature(1, 0.6_dp) + 1/pair%curvature(2, 0.6_dp))
    u = 0.03e-6_dp*1e3_dp*sum(c%rolling)/2/(modulus*radius)
    g = 0.02_dp*modulus
    w = load/14/(modulus*radius)
    call check_close(t, 'film', 1e3_dp*c%film, 2.65_dp*radius*u**0.7_dp*g**0.54_dp*w**(-0.13_dp), 1e-12_dp)
    other = surfaces
    other%viscosity = 2*surfaces%viscosity
    d = flank_contact(pair, other, 0.05_dp, speed, 0.6_dp, load)
    call check_close(t, 'twice the viscosity is twice the speed', d%film, film_at(2*speed, load), 1e-12_dp)
    call check_close(t, 'twice the load', film_at(speed, 2*load)/c%film, 2**(-0.13_dp), 1e-12_dp)
    call check_close(t, 'friction does not change it', c%film, film_at(speed, load), 1e-15_dp)

  contains

    real(dp) function film_at(speed, load)
      real(dp), intent(in) :: speed, load
      type(contact_t) :: contact

      contact = flank_contact(pair, surfaces, 0.0_dp, speed, 0.6_dp, load)
      film_at = contact%film
    end function film_at
  end subroutine film

  !> Pairs that carry alike give Ohlendorf's closed form, one load all along the path the other one; the sum over the rows of a
  !> motion comes to the integral in the second order of their distance.
  subroutine loss_factors(t)
    type(tally_t), intent(inout) :: t
    type(pair_t) :: pair
    real(dp), allocatable :: s(:), half(:)
    real(dp) :: points(5), found(3)
    integer :: kind, i, k, n

    do kind = 1, 3
      pair = example(t, kind)
      points = pair%points()
      call check_true(t, 'the pitch point is where one pair carries', points(2) < points(3) .and. points(3) < points(4))
      call check_close(t, 'half shares', static_loss_factor(pair, even_mesh(pair), load), half_shares_factor(pair), 1e-13_dp)
      s = [0.0_dp, points(3), pair%contact_ratio]
      call check_close(t, 'even load', followed_loss_factor(pair, [1, 1, 1], s, spread(load/pair%contact_ratio, 1, 3), load), &
                       even_load_factor(pair), 1e-13_dp)
      ! A motion that repeats after two mesh periods and whose pairs carry alike.
      call check_close(t, 'even load, two mesh periods', followed_loss_factor(pair, [1, 1, 1, 2, 2, 2], [s, s], &
                                                          spread(load/pair%contact_ratio, 1, 6), load), &
                       even_load_factor(pair), 1e-13_dp)
      do k = 1, 3
        n = 50*2**k
        s = [(points(2)*i/n, i=0, n), (points(2) + (points(3) - points(2))*i/n, i=0, n), &
             (points(3) + (points(4) - points(3))*i/n, i=0, n), (points(4) + (points(5) - points(4))*i/n, i=0, n)]
        ! Shares that bend, of pairs that stand a base pitch apart.
        half = [(0.5_dp*(1 + sin(pi*i/n)), i=0, n), (1.0_dp, i=1, 2*(n + 1)), (0.5_dp*(1 - sin(pi*i/n)), i=0, n)]
        found(k) = followed_loss_factor(pair, spread(1, 1, size(s)), s, load*half, load)
      end do
      call check_close(t, 'second order', (found(1) - found(2))/(found(2) - found(3)), 4.0_dp, 1e-2_dp)
    end do
  end subroutine loss_factors

  !> The mean coefficient of friction that GEARpie prints for the FZG type C gears, 40 mm wide (REPORT/C40.txt; the roughness
  !> from its list of gears), to its digits.
  subroutine friction(t)
    type(tally_t), intent(inout) :: t
    type(pair_t) :: pair
    type(friction_rule_t) :: rule
    real(dp) :: found

    pair = example(t, 1)
    pair%gear%spec%face_width = 0.04_dp
    rule = friction_rule_t(roughness=0.355e-6_dp, oil_factor=0.65_dp, viscosity=0.04985_dp)
    found = mean_friction(rule, pair, 6370.7_dp, 188.4956_dp)
    call check_close(t, 'C40', found, 0.0256_dp, absolute=0.00005_dp)
    rule%coefficient = 0.07_dp
    call check_close(t, 'stated', mean_friction(rule, pair, 6370.7_dp, 188.4956_dp), 0.07_dp, 1e-15_dp)
    rule%coefficient = 0
    call check_close(t, 'none', mean_friction(rule, pair, 6370.7_dp, 188.4956_dp), 0.0_dp, absolute=1e-300_dp)
  end subroutine friction

  !> With the gear driving at its own speed, the path is passed the other way, and all is as before.
  subroutine swapped_gears(t)
    type(tally_t), intent(inout) :: t
    type(pair_t) :: pair, other
    type(surfaces_t) :: surfaces, exchanged
    type(contact_t) :: a, b
    real(dp) :: s, ratio
    integer :: i, kind

    surfaces%material(2) = material_t(young=120e9_dp, poisson=0.25_dp)
    surfaces%conductivity(2) = 30
    exchanged = surfaces
    exchanged%material = surfaces%material([2, 1])
    exchanged%conductivity = surfaces%conductivity([2, 1])
    do kind = 1, 3
      pair = example(t, kind)
      other = example(t, kind, swapped=.true.)
      ratio = real(pair%gear(1)%spec%teeth, dp)/pair%gear(2)%spec%teeth
      do i = -1, 11
        s = pair%contact_ratio*i/10
        a = flank_contact(pair, surfaces, 0.05_dp, speed, s, load)
        b = flank_contact(other, exchanged, 0.05_dp, speed*ratio, pair%contact_ratio - s, load)
        call check_close(t, 'rolling', a%rolling(1), b%rolling(2), 1e-9_dp)
        call check_close(t, 'sliding', a%sliding, -b%sliding, 1e-9_dp, 1e-9_dp)
        call check_close(t, 'friction', a%friction_power, b%friction_power, 1e-8_dp, 1e-6_dp)
        if (i < 1 .or. i > 9) cycle
        call check_close(t, 'pressure', a%pressure, b%pressure, 1e-11_dp)
        call check_close(t, 'flash', a%flash, b%flash, 1e-9_dp, 1e-9_dp)
        call check_close(t, 'film', a%film, b%film, 1e-11_dp)
      end do
      call check_close(t, 'loss factor', half_shares_factor(pair), half_shares_factor(other), 1e-12_dp)
      call check_close(t, 'loss factor, integrated', static_loss_factor(pair, even_mesh(pair), load), &
                       static_loss_factor(other, even_mesh(other), load), 1e-12_dp)
    end do
  end subroutine swapped_gears

  subroutine study_of(t, keys, study)
    type(tally_t), intent(inout) :: t
    character(*), intent(in) :: keys
    type(study_t), intent(out) :: study
    type(case_t) :: case
    type(error_t), allocatable :: error

    call read_case('&case tasks = ''mesh'', ''flank'' / &pair module_mm = 3 face_width_mm = 20 / &pinion teeth = 21 / '// &
                   '&gear teeth = 34 / &load torque_nm = 150 / &relief amount_um = 0, 12 / '//keys, case, error)
    call check_no_error(t, 'case '//keys, error)
    if (allocated(error)) return
    call run_study(case, '', 1, study, error)
    call check_no_error(t, 'study '//keys, error)
  end subroutine study_of

  !> The static rows are the load sharing of the task mesh; friction power along the path adds up to the loss; relief takes load
  !> off the ends, where flanks slide most, and so lowers the loss.
  subroutine one_task(t)
    type(tally_t), intent(inout) :: t
    type(study_t) :: study
    real(dp), allocatable :: s(:), power(:), loss(:), relief(:), factor(:), input(:)
    real(dp) :: sum_of(2)
    integer :: i, k

    ! Without corners: where pairs begin and cease to carry under load, the task mesh has rows besides.
    call study_of(t, '&mesh model = ''weber'' corner_contact = .false. / '// &
                  '&flank rpm = 3000 dynamic_load = .false. friction_coefficient = 0.05 /', study)
    s = column_of(study, 'flank', 's')
    relief = column_of(study, 'flank', 'relief_um')
    power = column_of(study, 'flank', 'friction_power_w')
    loss = column_of(study, 'flank_losses', 'friction_loss_w')
    factor = column_of(study, 'flank_losses', 'loss_factor')
    input = column_of(study, 'flank_losses', 'input_power_w')
    call check_true(t, 'places of the task mesh', size(s) == size(column_of(study, 'mesh', 's')))
    call check_close(t, 'loads of the task mesh', maxval(abs(column_of(study, 'flank', 'pair_load_n')/study%load &
                     - column_of(study, 'mesh', 'load_share'))), 0.0_dp, absolute=1e-14_dp)
    call check_close(t, 'input power', input(1), 150*3000*pi/30, 1e-12_dp)
    sum_of = 0
    do i = 1, size(s) - 1
      k = merge(1, 2, relief(i) < 1)
      if (relief(i + 1) - relief(i) > 1) cycle
      sum_of(k) = sum_of(k) + (s(i + 1) - s(i))*(power(i) + power(i + 1))/2
    end do
    do k = 1, 2
      call check_close(t, 'power over the path', sum_of(k), loss(k), 1e-4_dp)
      call check_close(t, 'of the loss factor', loss(k), 0.05_dp*factor(k)*input(k), 1e-13_dp)
    end do
    call check_true(t, 'relief lowers the loss', loss(2) < 0.95_dp*loss(1))
  end subroutine one_task

  !> At creeping speed the motion's load is the static one; the dynamic rows are the loads of
  !> the task load.
  subroutine dynamic_loads(t)
    type(tally_t), intent(inout) :: t
    type(study_t) :: study
    real(dp), allocatable :: factor(:)

    call study_of(t, '&mesh model = ''weber'' / &flank rpm = 30 relief_um = 12 / &dynamics damping_ratio = 1 /', study)
    factor = column_of(study, 'flank_losses', 'loss_factor')
    call check_true(t, 'static and dynamic', size(factor) == 2)
    call check_close(t, 'the same in the limit', factor(2), factor(1), 1e-3_dp)
  end subroutine dynamic_loads

  !> The balance of a motion with friction and damping over a mesh period, followed by Runge-Kutta in many steps from where the
  !> library's motion begins: it repeats; what the tooth forces give to the vibration, damping takes; and the power that the
  !> pinion gives less that which the gear gets is what friction takes, the loss of the task.
  subroutine energy(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: steps = 4000
    type(pair_t) :: pair
    type(oscillator_t) :: osc
    type(accuracy_t) :: accuracy
    type(response_t) :: response
    type(error_t), allocatable :: error
    real(dp) :: state(7), slope(7, 4), width, duration, rim
    integer :: i, k

    pair = example(t, 1)
    osc%mesh = even_mesh(pair)
    osc%mesh%stiffness = polynomial(0.0_dp, pair%contact_ratio, [3.2e8_dp, 1e7_dp, -8e7_dp])
    osc%mass = [0.5_dp, 0.9_dp]
    osc%load = load
    osc%damping_ratio = 0.08_dp
    osc%friction = 0.06_dp
    call make_oscillator(osc, error)
    call check_no_error(t, 'oscillator', error)
    accuracy%steady%tolerance = 1e-11_dp
    call find_response(osc, speed*30/pi, accuracy, response)
    call check_true(t, 'all pairs stay in contact', response%point%steady%status == status_ok .and. all(response%load > 0))
    duration = mesh_period(osc%mesh%teeth(1), speed*30/pi)
    rim = speed*pair%gear(1)%base_radius(drive)
    state = 0
    state(1:2) = response%point%steady%state/[1.0_dp, duration]
    do i = 1, size(osc%intervals)
      associate (interval => osc%intervals(i))
        width = (interval%last - interval%first)/steps
        do k = 0, steps - 1
          slope(:, 1) = slopes(interval, interval%first + k*width, state)
          slope(:, 2) = slopes(interval, interval%first + (k + 0.5_dp)*width, state + duration*width/2*slope(:, 1))
          slope(:, 3) = slopes(interval, interval%first + (k + 0.5_dp)*width, state + duration*width/2*slope(:, 2))
          slope(:, 4) = slopes(interval, interval%first + (k + 1)*width, state + duration*width*slope(:, 3))
          state = state + duration*width/6*(slope(:, 1) + 2*slope(:, 2) + 2*slope(:, 3) + slope(:, 4))
        end do
      end associate
    end do
    call check_close(t, 'the motion repeats', state(1), response%point%steady%state(1), absolute=1e-8_dp*osc%static_deflection)
    call check_true(t, 'damping takes power', state(3) > 0)
    call check_close(t, 'work of the tooth forces and damping', state(4), -state(3), 1e-8_dp)
    call check_close(t, 'friction takes what the gear gets less', state(5) - state(6), state(7), 1e-8_dp)
    call check_close(t, 'the loss of the motion', osc%friction*load*rim*followed_loss_factor(pair, response%pair, response%s, &
                     response%load, load), state(7)/duration, 1e-4_dp)

  contains

    !> Per time, of x and its rate, and of the energies: taken by damping, given by the tooth forces to the vibration, given by
    !> the pinion, got by the gear, taken by friction at the speed of the gears.
    function slopes(interval, phase, now) result(rate)
      type(interval_t), intent(in) :: interval
      real(dp), intent(in) :: phase, now(7)
      real(dp) :: rate(7), reduced, damping_force
      real(dp), dimension(interval%pairs) :: stiffness, error, force, share, s, sense
      integer :: j

      reduced = product(osc%mass)/sum(osc%mass)
      call pairs_at(osc%mesh, interval, phase, stiffness, error)
      s = interval%place(phase, [(j, j=1, interval%pairs)])
      force = stiffness*(now(1) - error)
      share = reduced*mobility(osc, s, interval%recess)
      sense = merge(osc%friction, -osc%friction, interval%recess)
      damping_force = reduced*2*osc%damping_ratio*sqrt(sum(stiffness*share)/reduced)*now(2)
      rate(1) = now(2)
      rate(2) = (osc%load - sum(force*share) - damping_force)/reduced
      rate(3) = damping_force*now(2)
      rate(4) = sum(force*share)*now(2)
      rate(5) = rim*sum(force*(1 + sense*osc%mesh%curvature_ratio(1, s)))
      rate(6) = rim*sum(force*(1 + sense*osc%mesh%curvature_ratio(2, s)))
      rate(7) = osc%friction*sum(force*abs(sliding_ratio(pair, s)))*rim
    end function slopes
  end subroutine energy

  subroutine refusals(t)
    type(tally_t), intent(inout) :: t
    type(case_t) :: case
    type(error_t), allocatable :: error
    character(*), parameter :: gears = '&case tasks = ''flank'' / &pair module_mm = 3 face_width_mm = 20 / '// &
      '&pinion teeth = 21 / &gear teeth = 34 / &load torque_nm = 150 / '

    call read_case(gears, case, error)
    call check_error(t, 'no speed', error, '&flank rpm: missing')
    call read_case(gears//'&flank rpm = 0 /', case, error)
    call check_error(t, 'no speed at all', error, '&flank rpm = 0')
    call read_case(gears//'&flank rpm = 100 friction_coefficient = 0.05 roughness_um = 1 /', case, error)
    call check_error(t, 'two ways to friction', error, 'friction_coefficient is given')
    call read_case(gears//'&flank rpm = 100 viscosity_mpa_s = -1 /', case, error)
    call check_error(t, 'viscosity', error, '&flank viscosity_mpa_s = -1')
    call read_case(gears//'&flank rpm = 100 relief_um = 3 /', case, error)
    call check_error(t, 'no such relief', error, '&flank relief_um = 3: is none of &relief amount_um')
    call read_case('&case tasks = ''flank'' / &pinion teeth = 25 effective_mass_kg = 0.8 / &gear effective_mass_kg = 0.8 / '// &
                   '&load normal_force_n = 7000 / &mesh model = ''polynomial'' contact_ratio = 1.6 coefficients = 400 /', &
                   case, error)
    call check_error(t, 'no gears', error, '&case tasks = ''flank'': needs gears; a prescribed mesh')
  end subroutine refusals
end module test_flank
