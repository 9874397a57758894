!> Stiffness K(s) of one pair of teeth along the path of contact, full face width, in N/m.
!>
!> Every model has the same form, a positive piecewise polynomial over s = 0 (A) to the contact ratio (E), in base pitches.
!> Stated polynomials and tables, ISO 6336-1, and Weber and Banaschek's: each tooth bends as a beam of varying thickness on an
!> elastic half-plane, and the flanks flatten as in Hertz's line contact; plane strain.
!> Source: Weber, Banaschek 1953 (Formaenderung und Profilruecknahme bei gerad- und schraegverzahnten Raedern), with general
!> Poisson ratio.
module gearsweep_mesh_stiffness
  use gearsweep_base, only: code_input, dp, error_t, fail, pi, piecewise_t, polynomial, spline, str
  use gearsweep_gear, only: coast, drive, fillet_parameter, fillet_point, gear_t, involute_point, pair_t
  use gearsweep_elastic, only: check_contact, contact_half_width, harmonic_mean, material_t, surface_to_depth
  implicit none
  private
  public :: polynomial_stiffness, table_stiffness, iso_stiffness, iso_options_t, gear_blank_factor, weber_stiffness

  !> Load and gear bodies for ISO 6336-1, in addition to the teeth.
  type :: iso_options_t
    real(dp) :: application_factor = 1           !< K_A
    real(dp) :: web_thickness(2) = 0             !< b_s of pinion and gear, m; 0: a solid disc
    real(dp) :: rim_thickness(2) = 0             !< s_R, from the root circle inwards, m
  end type iso_options_t

  !> Limits of a pair stiffness, N/m.
  real(dp), parameter :: softest = 1e-6_dp, stiffest = 1e18_dp

  !> A tooth as a beam: half widths over the height, from the section where the fillet's tangent is at 30 degrees to the axis.
  type :: beam_t
    type(piecewise_t) :: half_width(2)
    real(dp) :: root = 0
  end type beam_t

contains

  !> Builds the stiffness from coefficients (N/m) in ascending powers of u = 2 s/contact_ratio - 1.
  pure subroutine polynomial_stiffness(contact_ratio, coefficients, curve, error)
    real(dp), intent(in) :: contact_ratio, coefficients(:)
    type(piecewise_t), intent(out) :: curve
    type(error_t), allocatable, intent(out) :: error

    curve = polynomial(0.0_dp, contact_ratio, coefficients)
    call check_positive(curve, 'stiffness polynomial', error)
  end subroutine polynomial_stiffness

  !> Builds a spline through a table: `s` in base pitches, ascending, from 0 or below to the contact ratio or above; `stiffness`
  !> in N/m.
  pure subroutine table_stiffness(contact_ratio, s, stiffness, curve, error)
    real(dp), intent(in) :: contact_ratio, s(:), stiffness(:)
    type(piecewise_t), intent(out) :: curve
    type(error_t), allocatable, intent(out) :: error
    real(dp), parameter :: slack = 1e-6_dp, far = 1e6_dp, closest = 1e-12_dp
    integer :: row

    if (size(s) < 2 .or. size(s) /= size(stiffness)) then
      call fail(error, code_input, 'stiffness table: needs at least two rows of s and stiffness')
    else if (any(s(2:) <= s(:size(s) - 1))) then
      call fail(error, code_input, 'stiffness table: s is not ascending at row '// &
                str(findloc(s(2:) <= s(:size(s) - 1), .true., 1) + 1))
    else if (s(1) > slack .or. s(size(s)) < contact_ratio - slack) then
      call fail(error, code_input, 'stiffness table: covers s = '//str(s(1))//' to '//str(s(size(s)))// &
                ' base pitches; the path of contact is 0 to '//str(contact_ratio))
    else if (any(abs(s) > far)) then
      call fail(error, code_input, 'stiffness table: s = '//str(s(findloc(abs(s) > far, .true., 1)))//': must be from '// &
                str(-far)//' to '//str(far))
    else if (any(s(2:) - s(:size(s) - 1) < closest)) then
      call fail(error, code_input, 'stiffness table: s is closer than '//str(closest)//' to the row before at row '// &
                str(findloc(s(2:) - s(:size(s) - 1) < closest, .true., 1) + 1))
    else if (any(.not. abs(stiffness) <= stiffest)) then
      ! Checked before the spline, which would overflow.
      row = findloc(abs(stiffness) <= stiffest, .false., 1)
      call fail(error, code_input, 'stiffness table: the pair stiffness must be at most '//str(stiffest*1e-6_dp)// &
                ' N/um; at row '//str(row)//' it is beyond')
    else
      curve = spline(s, stiffness)
      call check_positive(curve, 'stiffness table', error)
    end if
  end subroutine table_stiffness

  pure subroutine check_positive(curve, quantity, error)
    type(piecewise_t), intent(in) :: curve
    character(*), intent(in) :: quantity
    type(error_t), allocatable, intent(inout) :: error
    real(dp) :: least, largest

    least = curve%minimum()
    largest = curve%maximum()
    if (.not. least >= softest) then
      call fail(error, code_input, quantity//': the pair stiffness must be above 0 everywhere, at least '// &
                str(softest*1e-6_dp)//' N/um; it falls to '//str(least*1e-6_dp)//' N/um')
    else if (.not. largest <= stiffest) then
      call fail(error, code_input, quantity//': the pair stiffness must be at most '//str(stiffest*1e-6_dp)// &
                ' N/um; it rises to '//str(largest*1e-6_dp)//' N/um')
    end if
  end subroutine check_positive

  !> Computes ISO 6336-1:2006 method B: the largest single stiffness c' and, over the path, the parabola whose mean is the mesh
  !> stiffness c_gamma = c' (0.75 eps + 0.25); solid discs unless `options` specify webs. F_t K_A/b below 100 N/mm reduces c',
  !> where F_t is the tangential load on the reference circle; `line_load` (N/m) is that on the line of action. Of two gears with
  !> webs the C_R of the more flexible one counts: the standard defines it for a mate that is as stiff or stiffer. For materials
  !> other than steel the standard uses E/E_steel of the harmonic mean of both moduli.
  !> Source: ISO 6336-1:2006, clause 9, method B.
  pure subroutine iso_stiffness(pair, material, line_load, curve, error, options)
    type(pair_t), intent(in) :: pair
    type(material_t), intent(in) :: material(2)  !< material of pinion and gear
    real(dp), intent(in) :: line_load
    type(piecewise_t), intent(out) :: curve
    type(error_t), allocatable, intent(out) :: error
    type(iso_options_t), intent(in), optional :: options
    type(iso_options_t) :: extra
    real(dp), parameter :: steel = 206e9_dp, threshold = 100e3_dp, correction = 0.8_dp
    real(dp) :: rack, largest, bend, teeth(2)

    if (present(options)) extra = options
    associate (spec => pair%gear%spec)
      ! Of helical gears by the virtual numbers of teeth.
      teeth = spec%teeth/(cos(pair%gear%base_helix())**2*cos(spec%helix_angle))
      rack = (1 + 0.5_dp*(1.2_dp - sum(spec%dedendum)/2)) &
             *(1 - 0.02_dp*(20 - spec(1)%pressure_angle(drive)*57.29577951308232_dp))
      largest = 1e9_dp/flexibility()*correction*rack*harmonic_mean(material(1)%young, material(2)%young)/steel &
                *min(1.0_dp, extra%application_factor*line_load*cos(pair%gear(1)%transverse_angle(drive))/threshold)**0.25_dp &
                *minval(gear_blank_factor(extra%web_thickness, extra%rim_thickness, spec%face_width, spec%module)) &
                *cos(spec(1)%helix_angle)*minval(spec%face_width)
    end associate
    bend = 0.75_dp*(1 - 1/pair%contact_ratio)
    curve = polynomial(0.0_dp, pair%contact_ratio, largest*[1.0_dp, 0.0_dp, -bend])
    call check_positive(curve, 'model', error)

  contains

    !> Flexibility q' of the standard's thin-slice teeth, mm um/N.
    pure real(dp) function flexibility() result(q)
      associate (x => pair%gear%spec%profile_shift, z => teeth)
        q = 0.04723_dp + 0.15551_dp/z(1) + 0.25791_dp/z(2) &
            - 0.00635_dp*x(1) - 0.11654_dp*x(1)/z(1) - 0.00193_dp*x(2) - 0.24188_dp*x(2)/z(2) &
            + 0.00529_dp*x(1)**2 + 0.00182_dp*x(2)**2
      end associate
    end function flexibility
  end subroutine iso_stiffness

  !> Factor C_R of one gear: reduction of the stiffness by a thin web under a rim; 1 for a solid disc (`web` = 0). Thickness of
  !> web and rim, face width and module in m. Ratios beyond 0.2 and 1.2, and rims below a module, are set to these limits. Source:
  !> ISO 6336-1:2006, 9.3.1.3; formula and bounds as in other authors' programs, not compared with its curves.
  elemental real(dp) function gear_blank_factor(web, rim, width, module) result(factor)
    real(dp), intent(in) :: web, rim, width, module

    factor = 1
    if (web > 0) factor = 1 + log(min(1.2_dp, max(0.2_dp, web/width)))/(5*exp(max(1.0_dp, rim/module)/5))
  end function gear_blank_factor

  !> Computes K(s) in N/m for pinion and gear of these materials under `line_load` (N/m), on which only the flattening depends.
  pure subroutine weber_stiffness(pair, material, line_load, curve, error)
    type(pair_t), intent(in) :: pair
    type(material_t), intent(in) :: material(2)
    real(dp), intent(in) :: line_load
    type(piecewise_t), intent(out) :: curve
    type(error_t), allocatable, intent(out) :: error
    integer, parameter :: points = 33
    type(beam_t) :: beam(2)
    real(dp) :: s(points), stiffness(points)
    integer :: i

    beam(1) = tooth_beam(pair%gear(1))
    beam(2) = tooth_beam(pair%gear(2))
    s = [(pair%contact_ratio*i/(points - 1), i=0, points - 1)]
    call check_contact(maxval(contact_half_width(material(1), material(2), .true., line_load, pair%curvature(1, s), &
                                                 pair%curvature(2, s))), &
                       pair%gear(1)%spec%module, line_load, error)
    if (allocated(error)) return
    do i = 1, points
      stiffness(i) = minval(pair%gear%spec%face_width)/compliance(s(i))
    end do
    curve = spline(s, stiffness)
    call check_positive(curve, 'model', error)

  contains

    !> Deflection of the pair per line load (m^2/N) at path coordinate s.
    pure real(dp) function compliance(s)
      real(dp), intent(in) :: s
      real(dp) :: tooth(2), depth(2), width
      integer :: i

      do i = 1, 2
        call load_tooth(pair%gear(i), beam(i), material(i), pair%radius(i, s), tooth(i), depth(i))
      end do
      width = contact_half_width(material(1), material(2), .true., line_load, pair%curvature(1, s), pair%curvature(2, s))
      compliance = sum(tooth) + sum(surface_to_depth(material, .true., width, depth))
    end function compliance
  end subroutine weber_stiffness

  !> Samples fillet and involute of both flanks.
  pure function tooth_beam(gear) result(beam)
    type(gear_t), intent(in) :: gear
    type(beam_t) :: beam
    integer, parameter :: fillet = 12, flank = 20
    real(dp) :: points(2, fillet + flank), from, part
    integer :: side, i

    beam%root = 0
    do side = drive, coast
      from = fillet_parameter(gear, side, pi/6)
      do i = 1, fillet
        part = (i - 1.0_dp)/fillet
        points(:, i) = fillet_point(gear, side, from + (gear%fillet_start(side) - from)*part)
      end do
      do i = 1, flank
        part = (i - 1.0_dp)/(flank - 1)
        points(:, fillet + i) = involute_point(gear, side, gear%form_radius(side) &
                                               + (gear%tip_radius - gear%form_radius(side))*part**2)
      end do
      beam%half_width(side) = spline(points(2, :), points(1, :))
      beam%root = max(beam%root, points(2, 1))
    end do
  end function tooth_beam

  !> Deflections of one tooth per line load by bending, shear, compression and foundation (m^2/N), for a load normal to the drive
  !> flank at `radius`; `depth` is the length of the load line from the flank to the tooth axis, m.
  pure subroutine load_tooth(gear, beam, material, radius, compliance, depth)
    type(gear_t), intent(in) :: gear
    type(beam_t), intent(in) :: beam
    type(material_t), intent(in) :: material
    real(dp), intent(in) :: radius
    real(dp), intent(out) :: compliance, depth
    real(dp) :: angle, height, root_width, bending, shear, lever, y, w, step
    integer, parameter :: intervals = 12
    real(dp), parameter :: node(3) = [-sqrt(0.6_dp), 0.0_dp, sqrt(0.6_dp)], weight(3) = [5, 8, 5]/18.0_dp
    integer :: i, k

    lever = gear%half_angle(drive, radius)
    angle = acos(gear%base_radius(drive)/radius) - lever
    depth = radius*sin(lever)/cos(angle)
    height = gear%base_radius(drive)/cos(angle) - beam%root
    root_width = width(beam, beam%root)
    ! Integrals over the height of (height - y)^2/width^3 and 1/width, by the Gauss rule.
    bending = 0
    shear = 0
    step = height/intervals
    do i = 1, intervals
      do k = 1, 3
        y = step*(i - 0.5_dp + node(k)/2)
        w = width(beam, beam%root + y)
        bending = bending + step*weight(k)*(height - y)**2/w**3
        shear = shear + step*weight(k)/w
      end do
    end do
    associate (nu => material%poisson, t => tan(angle)**2, ratio => height/root_width)
      compliance = cos(angle)**2*(1 - nu**2)/material%young &
        *(12*bending + (2.4_dp/(1 - nu) + t)*shear &
          + 18/pi*ratio**2 + 2*(1 - 2*nu)/(1 - nu)*ratio + 4.8_dp/pi*(1 + (1 - nu)/2.4_dp*t))
    end associate
  end subroutine load_tooth

  pure real(dp) function width(beam, y)
    type(beam_t), intent(in) :: beam
    real(dp), intent(in) :: y

    width = beam%half_width(drive)%value(y) + beam%half_width(coast)%value(y)
  end function width
end module gearsweep_mesh_stiffness
