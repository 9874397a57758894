!> Stress and rating against Hooke's law, brute force on the outline, and the whole stress field beside the fillet's.
module test_stress_closed_forms
  use gearsweep_elastic_body, only: body_t, make_body
  use gearsweep_gear_profile, only: tooth_outline
  use gearsweep_base_error, only: error_t
  use gearsweep_gear_gear, only: gear_spec_t, gear_t, make_gear
  use gearsweep_elastic_grid, only: grid_t
  use gearsweep_base_kinds, only: dp, pi
  use gearsweep_elastic_material, only: material_t
  use gearsweep_elastic_stress, only: nodal_stress
  use gearsweep_base_text, only: str
  use test_support_ask_by_name, only: answer_t, ask
  use test_support_gears, only: stated_t, examples, text_of, involute, base_radius, tip_radius, working_angle, first_curvature, &
    & base_pitch, contact_ratio, half_tooth, degree, drive, coast
  use test_support_plain_grids, only: rectangle_grid
  use test_support_testing, only: tally_t, check_true, check_close, check_equal, check_no_error
  implicit none
  private
  public :: run

  character(*), parameter :: task = '&case tasks=''static'' / ', loaded = '&mesh model=''iso6336'' / &load line_load_n_mm=210 / '
  character(*), parameter :: gear_names(2) = [character(6) :: 'pinion', 'gear']

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t

    if (t%wants('constant_strain')) call constant_strain(t)
    if (t%wants('formulas_on_the_outline')) call formulas_on_the_outline(t)
    if (t%wants('root_section_with_protuberance')) call root_section_with_protuberance(t)
    if (t%wants('stress_with_protuberance')) call stress_with_protuberance(t)
    if (t%wants('components_of_the_field')) call components_of_the_field(t)
    if (t%wants('peaks_and_tangents')) call peaks_and_tangents(t)
    if (t%wants('positions_and_shares')) call positions_and_shares(t)
  end subroutine run

  !> Displacements that are linear in x and y, on a crooked grid: stress by Hooke's law at every node, and work of the
  !> nodal forces. Stretches, shear, a rotation, and one pull along an inclined axis.
  subroutine constant_strain(t)
    type(tally_t), intent(inout) :: t
    type(material_t), parameter :: material = material_t(70e9_dp, 0.33_dp, 2700.0_dp)
    real(dp), parameter :: thickness = 0.04_dp, tilt = 0.4_dp
    type(grid_t) :: grid
    type(body_t) :: body
    type(error_t), allocatable :: error
    real(dp) :: slopes(2, 2, 5), sigma(3, 5), area
    real(dp), allocatable :: u(:, :), forces(:, :), stress(:, :), moved(:, :)
    integer :: i, k, plane

    call rectangle_grid(reshape([0.0_dp, 0.0_dp, 3.1_dp, 0.4_dp, 2.6_dp, 2.2_dp, 0.3_dp, 1.3_dp], [2, 4]), 3, 2, grid, error)
    area = (3.1_dp*2.2_dp - 2.6_dp*0.4_dp + 2.6_dp*1.3_dp - 0.3_dp*2.2_dp)/2
    do plane = 0, 1
      call make_body(grid, material, plane == 1, thickness, spread(grid%x(1, :) < 0.31_dp, 1, 2), 1e9_dp, body, error)
      call check_no_error(t, 'crooked body', error)
      slopes = 1e-4_dp*reshape([1, 0, 0, 0, 0, 0, 0, 1, 0, 1, 0, 0, 0, -1, 1, 0, 0, 0, 0, 0], [2, 2, 5])
      slopes(:, :, 5) = pulled(tilt)
      allocate (moved(2*size(grid%x, 2), 5))
      do k = 1, 5
        u = matmul(slopes(:, :, k), grid%x)
        stress = nodal_stress(body, u)
        sigma(:, k) = hooke(slopes(:, :, k))
        do i = 1, 3
          call check_close(t, 'constant stress, field '//str(k)//', component '//str(i), maxval(abs(stress(i, :) - sigma(i, k))), &
                           0.0_dp, absolute=1e-7_dp*material%young*1e-4_dp)
        end do
        moved(:, k) = reshape(u, [size(u)])
      end do
      forces = body%stiffness_times(moved)
      do k = 1, 5
        do i = 1, 5
          call check_close(t, 'work of one field on another', dot_product(moved(:, i), forces(:, k)), area*thickness &
            *(sigma(1, k)*slopes(1, 1, i) + sigma(2, k)*slopes(2, 2, i) + sigma(3, k)*(slopes(1, 2, i) + slopes(2, 1, i))), &
            absolute=1e-9_dp*material%young*1e-8_dp)
        end do
      end do
      deallocate (moved)
      associate (c => cos(tilt), s => sin(tilt))
        do i = 1, 3
          call check_close(t, 'a pull of 1e-4 E along an inclined axis', sigma(i, 5), 1e-4_dp*material%young &
                           *merge(c**2, merge(s**2, c*s, i == 2), i == 1)/merge(1 - material%poisson**2, 1.0_dp, plane == 1), &
                           relative=1e-12_dp)
        end do
      end associate
    end do

  contains

    !> Stress of displacement slopes, with the strain or the stress across the plane zero.
    pure function hooke(h) result(sigma)
      real(dp), intent(in) :: h(2, 2)
      real(dp) :: sigma(3), volume, lambda, shear

      shear = material%young/(2*(1 + material%poisson))
      lambda = 2*shear*material%poisson/(1 - 2*material%poisson)
      volume = h(1, 1) + h(2, 2)
      ! In plane stress the body thins by nu/(1 - nu) of what it spreads.
      if (plane == 0) volume = volume*(1 - material%poisson/(1 - material%poisson))
      sigma = [lambda*volume + 2*shear*h(1, 1), lambda*volume + 2*shear*h(2, 2), shear*(h(1, 2) + h(2, 1))]
    end function hooke

    !> Slopes of a field that stretches by 1e-4 along an inclined axis and shrinks as that asks across it.
    pure function pulled(angle) result(h)
      real(dp), intent(in) :: angle
      real(dp) :: h(2, 2), turn(2, 2), across

      across = -material%poisson
      if (plane == 1) across = -material%poisson/(1 - material%poisson)
      turn = reshape([cos(angle), sin(angle), -sin(angle), cos(angle)], [2, 2])
      h = 1e-4_dp*matmul(matmul(turn, reshape([1.0_dp, 0.0_dp, 0.0_dp, across], [2, 2])), transpose(turn))
    end function pulled
  end subroutine constant_strain

  !> One tooth of a gear, sampled: coast fillet, coast involute, tip, drive involute, drive fillet.
  function sampled(pair, which, steps) result(points)
    type(stated_t), intent(in) :: pair
    integer, intent(in) :: which, steps
    real(dp) :: points(2, 5*steps + 1)
    type(gear_t) :: gear
    type(error_t), allocatable :: error

    call make_gear(gear_spec_t('gear', pair%teeth(which), pair%module, pair%angle*degree, pair%shift(which), &
      pair%addendum(which), pair%dedendum(which), pair%rounding(which), face_width=1.0_dp), gear, error)
    points = tooth_outline(gear, steps)
  end function sampled

  !> ISO 6336-3:2006, 6.2 to 6.4, for a tool with protuberance: E = pi/4 m - h_fP tan(alpha) + s_pr/cos(alpha) - (1 - sin(alpha))
  !> rho_fP/cos(alpha), G = rho_fP/m - h_fP/m + x, H = 2/z (pi/2 - E/m) - pi/3, theta = 2 G/z tan(theta) - H, and from these s_Fn,
  !> rho_F and h_Fe at the outer point of single contact. Both flanks alike, with and without s_pr.
  subroutine root_section_with_protuberance(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: depths(3) = [0.0_dp, 0.008_dp, 0.02_dp]
    type(stated_t) :: list(5)
    type(answer_t) :: answer
    character(:), allocatable :: tool
    real(dp) :: e, g, h, theta, rho, rb(2), r, angle, gamma, tilt, alpha
    integer :: n, k, i, gear

    list = examples()
    do n = 1, 2
      ! Short teeth, so that their tips stay above the fillets.
      list(n)%addendum = 0.7_dp
      list(n)%dedendum = 1.4_dp
      do k = 1, size(depths)
        do gear = 1, 2
          associate (pair => list(n), z => real(list(n)%teeth(gear), dp), x => list(n)%shift(gear), &
                     h_fp => list(n)%dedendum(gear), rho_fp => list(n)%rounding(gear))
            alpha = pair%angle(1)*degree
            tool = 'grinding_stock_mm=0.1 protuberance_mm='//str(0.1_dp + depths(k)*pair%module, 17)
            call ask(t, task//text_of(pair, tool, tool)//loaded//'&static positions=3 / &section elements_across=4 gear='''// &
                     trim(gear_names(gear))//''' /', answer)
            e = pi/4 - h_fp*tan(alpha) + depths(k)/cos(alpha) - (1 - sin(alpha))*rho_fp/cos(alpha)
            g = rho_fp - h_fp + x
            h = 2/z*(pi/2 - e) - pi/3
            theta = pi/6
            do i = 1, 200
              theta = 2*g/z*tan(theta) - h
            end do
            rho = first_curvature(pair) + merge(1.0_dp, contact_ratio(pair) - 1, gear == 1)*base_pitch(pair)
            if (gear == 2) rho = pair%distance*sin(working_angle(pair, drive)) - rho
            rb = base_radius(pair, drive)
            r = hypot(rb(gear), rho)
            angle = acos(rb(gear)/r)
            gamma = (pi/2 + 2*x*tan(alpha))/z + involute(alpha) - involute(angle)
            tilt = angle - gamma
            call check_close(t, 's_Fn', answer%one('root_rating.iso_thickness_mm'), pair%module*(z*sin(pi/3 - theta) &
                             + sqrt(3.0_dp)*(g/cos(theta) - rho_fp)), relative=1e-9_dp)
            call check_close(t, 'h_Fe', answer%one('root_rating.iso_lever_mm'), pair%module/2*((cos(gamma) - sin(gamma)*tan(tilt)) &
                             *2*r/pair%module - z*cos(pi/3 - theta) - (g/cos(theta) - rho_fp)), relative=1e-9_dp)
            call check_close(t, 'rho_F', answer%one('root_rating.iso_radius_mm'), pair%module*(rho_fp + 2*g**2/(cos(theta) &
                             *(z*cos(theta)**2 - 2*g))), relative=1e-9_dp)
          end associate
        end do
      end do
    end do
  end subroutine root_section_with_protuberance

  !> Finite elements of a tooth with protuberance against ISO 6336-3, which sees its thinner root by closed forms alone: both rise
  !> alike, within half a per cent. A grid half as fine has the stress within twice its estimate.
  subroutine stress_with_protuberance(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: depths(3) = [0.0_dp, 0.06_dp, 0.1_dp]
    type(answer_t) :: plain, answer, coarse
    integer :: k

    do k = 1, size(depths)
      call ask(t, text(depths(k), 16), answer)
      if (k == 1) plain = answer
      call check_close(t, 'rise of the root stress', tension(answer)/tension(plain), answer%one('root_rating.iso_mpa') &
                       /plain%one('root_rating.iso_mpa'), relative=5e-3_dp)
      call ask(t, text(depths(k), 8), coarse)
      call check_close(t, 'on a coarser grid', tension(coarse), tension(answer), &
                       relative=2*coarse%one('root_stress.error_estimate'))
    end do
    call check_true(t, 'it does rise', tension(answer) > 1.03_dp*tension(plain))

  contains

    real(dp) function tension(of)
      type(answer_t), intent(in) :: of

      tension = of%one('root_stress.tension_mpa')
    end function tension

    function text(depth, across)
      real(dp), intent(in) :: depth
      integer, intent(in) :: across
      character(:), allocatable :: text, tool

      tool = ' dedendum=1.4 addendum=0.8 rack_tip_radius=0.3 protuberance_mm='//str(depth)//' / '
      text = task//'&pair module_mm=3 face_width_mm=20 / &pinion teeth=25 profile_shift=0.3'//tool//'&gear teeth=40'// &
             tool//loaded//'&section elements_across='//str(across)//' /'
    end function text
  end subroutine stress_with_protuberance

  !> Lewis: the largest bending stress 6 F cos(alpha_F) h/(b s**2) over the sections of the drive fillet. ISO 6336-3: the
  !> points of 30 degrees sought on the outline, the notch's radius from three points of it, and the standard's formulas
  !> Y_F = 6 h cos(alpha_F)/m/((s/m)**2 cos(alpha)), Y_S = (1.2 + 0.13 L) q_s**(1/(1.21 + 2.3/L)); unlike flanks too.
  subroutine formulas_on_the_outline(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: steps = 1500
    real(dp), parameter :: force = 210*20
    type(stated_t) :: list(5)
    type(answer_t) :: answer
    real(dp) :: points(2, 5*steps + 1), rb(2), r, rho, angle, apex, lewis, s, h, notch, y_f, y_s, drive_point(2), coast_point(2)
    real(dp) :: radius(2)
    integer :: n, k, gear

    list = examples()
    do n = 1, size(list)
      do gear = 1, 2
        associate (pair => list(n))
          call ask(t, task//text_of(pair)//loaded//'&static positions=3 / &section elements_across=4 gear='''// &
                   trim(gear_names(gear))//''' /', answer)
          points = sampled(pair, gear, steps)
          ! The outer point of single contact: D on the pinion, B on the gear.
          rho = first_curvature(pair) + merge(1.0_dp, contact_ratio(pair) - 1, gear == 1)*base_pitch(pair)
          if (gear == 2) rho = pair%distance*sin(working_angle(pair, drive)) - rho
          rb = base_radius(pair, drive)
          r = hypot(rb(gear), rho)
          angle = acos(rb(gear)/r) - half_tooth(pair, gear, drive, r)
          apex = rb(gear)/cos(angle)
          lewis = 0
          do k = 4*steps + 1, 5*steps + 1
            if (points(2, k) < points(2, 1)) exit
            s = points(1, k) + coast_width(points(:, 1:2*steps + 1), points(2, k))
            lewis = max(lewis, 6*force*cos(angle)*(apex - points(2, k))/(20*s**2))
          end do
          call check_close(t, 'Lewis stress, pair '//str(n), answer%one('root_rating.lewis_mpa'), lewis, relative=1e-5_dp)
          call at_30_degrees(points(:, 4*steps + 1:), drive_point, radius(1))
          call at_30_degrees(points(:, 1:steps + 1), coast_point, radius(2))
          s = drive_point(1) + abs(coast_point(1))
          h = apex - drive_point(2)
          notch = radius(1)
          y_f = 6*(h/pair%module)*cos(angle)/((s/pair%module)**2*cos(pair%angle(1)*degree))
          y_s = (1.2_dp + 0.13_dp*(s/h))*(s/(2*notch))**(1/(1.21_dp + 2.3_dp/(s/h)))
          call check_close(t, 'ISO 6336-3 stress, pair '//str(n), answer%one('root_rating.iso_mpa'), &
                           force*cos(pair%angle(1)*degree)/(20*pair%module)*y_f*y_s, relative=5e-4_dp)
          call check_close(t, 'form factor', answer%one('root_rating.iso_form_factor'), y_f, relative=1e-4_dp)
          call check_close(t, 'stress correction factor', answer%one('root_rating.iso_stress_correction'), y_s, relative=5e-4_dp)
        end associate
      end do
    end do
  end subroutine formulas_on_the_outline

  !> Half width at a height, on a fillet's chords.
  pure real(dp) function coast_width(points, height) result(x)
    real(dp), intent(in) :: points(:, :), height
    integer :: k

    k = findloc(points(2, 2:) > height, .true., 1)
    associate (p => points(:, k), q => points(:, k + 1))
      x = abs(p(1) + (q(1) - p(1))*(height - p(2))/(q(2) - p(2)))
    end associate
  end function coast_width

  !> Where a fillet makes 30 degrees with the tooth's axis, between the middles of two chords, and its radius of curvature:
  !> length over turn of these chords, which is what the notch's radius is good to, some 1e-3.
  pure subroutine at_30_degrees(points, place, radius)
    real(dp), intent(in) :: points(:, :)
    real(dp), intent(out) :: place(2), radius
    real(dp) :: angle(size(points, 2) - 1), middle(2, 2)
    integer :: k, n

    n = size(angle)
    angle = atan2(abs(points(1, 2:) - points(1, :n)), abs(points(2, 2:) - points(2, :n))) - pi/6
    k = findloc(angle(:n - 1) > 0 .neqv. angle(2:) > 0, .true., 1)
    middle = (points(:, k:k + 1) + points(:, k + 1:k + 2))/2
    place = middle(:, 1) + (middle(:, 2) - middle(:, 1))*angle(k)/(angle(k) - angle(k + 1))
    radius = norm2(middle(:, 2) - middle(:, 1))/abs(angle(k + 1) - angle(k))
  end subroutine at_30_degrees

  !> The components that are told at the fillet's tangent, signs and all, beside the stress field at the surface node nearest to
  !> that point: tension on the drive side leans inwards, compression on the coast side too.
  subroutine components_of_the_field(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: steps = 400, position = 4
    character(:), allocatable :: text
    type(stated_t) :: list(5)
    type(answer_t) :: answer
    real(dp), allocatable :: x(:), y(:), field(:, :), along(:)
    real(dp) :: points(2, 5*steps + 1), place(2), radius, told(3), largest
    integer :: side, node, i

    list = examples()
    text = text_of(list(3))//loaded//'&section elements_across=14 / &static positions=7 field_position=4 /'
    call ask(t, task//text, answer)
    along = answer%all_of('static.sigma_mpa')
    x = answer%all_of('nodes.x_mm')
    y = answer%all_of('nodes.y_mm')
    allocate (field(3, size(x)))
    field(1, :) = answer%all_of('stress.sigma_x_mpa')
    field(2, :) = answer%all_of('stress.sigma_y_mpa')
    field(3, :) = answer%all_of('stress.tau_xy_mpa')
    call check_close(t, 'same position', answer%one('stress_load.s'), value_at(answer%all_of('static.s'), 2*position), 1e-14_dp)
    call check_close(t, 'same share', answer%one('stress_load.load_share'), &
                     value_at(answer%all_of('static.load_share'), 2*position), 1e-14_dp)
    points = sampled(list(3), 1, steps)
    do side = drive, coast
      if (side == drive) call at_30_degrees(points(:, 4*steps + 1:), place, radius)
      if (side == coast) call at_30_degrees(points(:, 1:steps + 1), place, radius)
      node = minloc((x - place(1))**2 + (y - place(2))**2, 1)
      told = [value_at(answer%all_of('static.sigma_x_mpa'), 2*(position - 1) + side), &
              value_at(answer%all_of('static.sigma_y_mpa'), 2*(position - 1) + side), &
              value_at(answer%all_of('static.tau_xy_mpa'), 2*(position - 1) + side)]
      largest = maxval(abs(told))
      do i = 1, 3
        call check_close(t, 'component '//str(i)//' beside the field, side '//str(side), told(i), field(i, node), &
                         absolute=0.08_dp*largest)
      end do
      call check_true(t, 'tension, then compression', merge(1, -1, side == drive)*told(2) > 0)
      call check_close(t, 'along the surface', along(2*(position - 1) + side), told(1) + told(2), 1e-12_dp)
      call check_true(t, 'leans inwards', told(3)*told(2)*merge(-1, 1, side == drive) > 0.1_dp*told(2)**2)
    end do
  end subroutine components_of_the_field

  pure real(dp) function value_at(values, i)
    real(dp), intent(in) :: values(:)
    integer, intent(in) :: i

    value_at = values(i)
  end function value_at

  !> The peak is the largest of what is told at the tangents: asked for at the peak's own tangent, the same stress comes
  !> out; beside it, less. Tension on the drive side, compression on the coast side.
  subroutine peaks_and_tangents(t)
    type(tally_t), intent(inout) :: t
    character(:), allocatable :: text
    type(stated_t) :: list(5)
    type(answer_t) :: answer
    real(dp) :: peak(2), tangent(2), found(2)
    integer :: side, k, n

    list = examples()
    do n = 2, 3
      text = task//text_of(list(n))//loaded//'&section elements_across=8 / &static positions=9 tangent_deg='
      call ask(t, text//'30 /', answer)
      peak = [answer%one('root_stress.tension_mpa'), answer%one('root_stress.compression_mpa')]
      tangent = [answer%one('root_stress.tension_deg'), answer%one('root_stress.compression_deg')]
      do side = drive, coast
        do k = -1, 1
          call ask(t, text//str(tangent(side) + 4*k, 17)//' /', answer)
          found = extremes(answer%all_of('static.sigma_mpa'))
          if (k == 0) call check_close(t, 'peak at its tangent, side '//str(side), found(side), peak(side), relative=1e-3_dp)
          if (k /= 0) call check_true(t, 'less beside it', abs(found(side)) < abs(peak(side)), str(found(side)/peak(side)))
        end do
      end do
    end do

  contains

    !> Largest on the drive side, least on the coast side.
    pure function extremes(sigma) result(of)
      real(dp), intent(in) :: sigma(:)
      real(dp) :: of(2)

      of = [maxval(sigma(1::2)), minval(sigma(2::2))]
    end function extremes
  end subroutine peaks_and_tangents

  !> Positions of the load: equal steps of the path, and equal arcs of the flank, whose length from the base circle is
  !> rho**2/(2 r_b); shares as stated, equal, and by the mesh; on both gears.
  subroutine positions_and_shares(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: stated = '0.4,0.7,1,0.9,0.3'
    real(dp), parameter :: shares(5) = [0.4_dp, 0.7_dp, 1.0_dp, 0.9_dp, 0.3_dp]
    type(stated_t) :: list(5)
    type(answer_t) :: answer
    real(dp), allocatable :: s(:), radius(:), share(:), sigma(:)
    real(dp) :: rb(2), rho(2), single
    integer :: gear, i

    list = examples()
    associate (pair => list(2))
      rb = base_radius(pair, drive)
      do gear = 1, 2
        call static('shares='//stated)
        call check_equal(t, 'positions of stated shares', size(s), 5)
        single = sigma(1)/shares(1)
        do i = 1, size(s)
          rho(1) = first_curvature(pair) + s(i)*base_pitch(pair)
          rho(2) = pair%distance*sin(working_angle(pair, drive)) - rho(1)
          call check_close(t, 'radius of the load', radius(i), hypot(rb(gear), rho(gear)), 1e-12_dp)
          call check_close(t, 'stated share', share(i), shares(i))
          call check_close(t, 'equal arcs', hypot(rb(gear), arc(gear, i)), radius(i), 1e-9_dp)
        end do
        call check_close(t, 'from the tip', radius(1), gear_tip(gear), 1e-12_dp)
        call static('positions=9 sharing=''equal''')
        ! Nine even steps, and where a pair comes or goes both sides of it.
        call check_equal(t, 'positions on the path', size(s), 13)
        call check_true(t, 'in order', all(s(2:) > s(:size(s) - 1)))
        call check_close(t, 'even steps', minval(abs(s - contact_ratio(pair)*3/8)), 0.0_dp, absolute=1e-12_dp)
        do i = -1, 1, 2
          call check_close(t, 'beside D', minval(abs(s - 1 - i*1e-9_dp)), 0.0_dp, absolute=1e-12_dp)
          call check_close(t, 'beside B', minval(abs(s - contact_ratio(pair) + 1 - i*1e-9_dp)), 0.0_dp, absolute=1e-12_dp)
        end do
        do i = 1, size(s)
          call check_close(t, 'equal shares', share(i), merge(1.0_dp, 0.5_dp, s(i) > contact_ratio(pair) - 1 .and. s(i) < 1))
        end do
        call check_close(t, 'stress follows the share', sigma(nearest_tip(gear))/share(nearest_tip(gear)), &
                         single, 1e-9_dp)
      end do
    end associate

  contains

    subroutine static(options)
      character(*), intent(in) :: options

      call ask(t, task//text_of(list(2))//loaded//'&section elements_across=4 gear='''//trim(gear_names(gear))// &
               ''' / &static '//options//' /', answer)
      s = answer%all_of('static.s')
      radius = answer%all_of('static.radius_mm')
      share = answer%all_of('static.load_share')
      sigma = answer%all_of('static.sigma_mpa')
      ! Of the two sides, the drive side.
      s = s(1::2)
      radius = radius(1::2)
      share = share(1::2)
      sigma = sigma(1::2)
    end subroutine static

    pure real(dp) function gear_tip(gear)
      integer, intent(in) :: gear
      real(dp) :: ra(2)

      ra = tip_radius(list(2))
      gear_tip = ra(gear)
    end function gear_tip

    !> Radius of curvature after i - 1 of four equal arcs from the tip to the other end of the path.
    pure real(dp) function arc(gear, i)
      integer, intent(in) :: gear, i
      real(dp) :: ends(2)

      associate (pair => list(2))
        ends = first_curvature(pair) + [contact_ratio(pair), 0.0_dp]*base_pitch(pair)
        if (gear == 2) ends = pair%distance*sin(working_angle(pair, drive)) - ends(2:1:-1)
        arc = sqrt(ends(1)**2 + (ends(2)**2 - ends(1)**2)*(i - 1)/4)
      end associate
    end function arc

    !> The position at the gear's tip among those on the path.
    pure integer function nearest_tip(gear)
      integer, intent(in) :: gear

      nearest_tip = merge(size(s), 1, gear == 1)
    end function nearest_tip
  end subroutine positions_and_shares
end module test_stress_closed_forms
