!> Stiffness K(s) of one pair of teeth along the path of contact, whole face
!> width, in N/m. Every model ends in the same form, a positive piecewise
!> polynomial over s = 0 (A) to the contact ratio (E), in base pitches.
module gearsweep_stiffness
  use gearsweep_kinds, only: dp
  use gearsweep_error, only: error_t, fail, code_input
  use gearsweep_piecewise, only: piecewise_t, polynomial, spline
  use gearsweep_material, only: harmonic_mean, material_t
  use gearsweep_pair, only: pair_t
  use gearsweep_gear, only: drive
  use gearsweep_text, only: str
  implicit none
  private
  public :: polynomial_stiffness, table_stiffness, iso_stiffness, iso_options_t, gear_blank_factor, check_positive

  !> What ISO 6336-1 knows of load and gear bodies beside the teeth.
  type :: iso_options_t
    real(dp) :: application_factor = 1           !< K_A
    real(dp) :: web_thickness(2) = 0             !< b_s of pinion and gear, m; 0: a solid disc
    real(dp) :: rim_thickness(2) = 0             !< s_R, from the root circle inwards, m
  end type iso_options_t

  !> What a pair stiffness may be, N/m.
  real(dp), parameter :: softest = 1e-6_dp, stiffest = 1e18_dp

contains

  !> Coefficients (N/m) in ascending powers of u = 2 s/contact_ratio - 1.
  pure subroutine polynomial_stiffness(contact_ratio, coefficients, curve, error)
    real(dp), intent(in) :: contact_ratio, coefficients(:)
    type(piecewise_t), intent(out) :: curve
    type(error_t), allocatable, intent(out) :: error

    curve = polynomial(0.0_dp, contact_ratio, coefficients)
    call check_positive(curve, 'stiffness polynomial', error)
  end subroutine polynomial_stiffness

  !> Spline through a table: `s` in base pitches, ascending, from 0 or below to
  !> the contact ratio or above; `stiffness` in N/m.
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
      ! Before the spline, which would overflow.
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

  !> ISO 6336-1:2006 method B: the largest single stiffness c' and, over the
  !> path, the parabola whose mean gives the mesh stiffness
  !> c_gamma = c' (0.75 eps + 0.25); solid discs unless `options` say otherwise. F_t K_A/b below
  !> 100 N/mm lowers c', where F_t is the tangential load on the reference circle; `line_load` (N/m) is that on the line
  !> of action. Of two gears with webs the more flexible one's C_R counts: the standard gives it for a mate that is as
  !> stiff or stiffer. For materials other than steel the standard takes E/E_steel of the harmonic mean of both moduli.
  !> Source: ISO 6336-1:2006, clause 9, method B.
  pure subroutine iso_stiffness(pair, material, line_load, curve, error, options)
    type(pair_t), intent(in) :: pair
    type(material_t), intent(in) :: material(2)  !< of pinion and gear
    real(dp), intent(in) :: line_load
    type(piecewise_t), intent(out) :: curve
    type(error_t), allocatable, intent(out) :: error
    type(iso_options_t), intent(in), optional :: options
    type(iso_options_t) :: extra
    real(dp), parameter :: steel = 206e9_dp, threshold = 100e3_dp, correction = 0.8_dp
    real(dp) :: rack, largest, bend

    if (present(options)) extra = options
    associate (spec => pair%gear%spec)
      rack = (1 + 0.5_dp*(1.2_dp - sum(spec%dedendum)/2)) &
             *(1 - 0.02_dp*(20 - spec(1)%pressure_angle(drive)*57.29577951308232_dp))
      largest = 1e9_dp/flexibility()*correction*rack*harmonic_mean(material(1)%young, material(2)%young)/steel &
                *min(1.0_dp, extra%application_factor*line_load*cos(spec(1)%pressure_angle(drive))/threshold)**0.25_dp &
                *minval(gear_blank_factor(extra%web_thickness, extra%rim_thickness, spec%face_width, spec%module)) &
                *minval(spec%face_width)
    end associate
    bend = 0.75_dp*(1 - 1/pair%contact_ratio)
    curve = polynomial(0.0_dp, pair%contact_ratio, largest*[1.0_dp, 0.0_dp, -bend])
    call check_positive(curve, 'model', error)

  contains

    !> q', the flexibility of the standard's thin-slice teeth, mm um/N.
    pure real(dp) function flexibility() result(q)
      associate (x => pair%gear%spec%profile_shift, z => real(pair%gear%spec%teeth, dp))
        q = 0.04723_dp + 0.15551_dp/z(1) + 0.25791_dp/z(2) &
            - 0.00635_dp*x(1) - 0.11654_dp*x(1)/z(1) - 0.00193_dp*x(2) - 0.24188_dp*x(2)/z(2) &
            + 0.00529_dp*x(1)**2 + 0.00182_dp*x(2)**2
      end associate
    end function flexibility
  end subroutine iso_stiffness

  !> C_R of one gear: what a thin web under a rim takes from the stiffness; 1 for a solid disc (`web` = 0). Thickness of
  !> web and rim, face width and module in m. Ratios beyond 0.2 and 1.2, and rims below a module, count as these.
  !> Source: ISO 6336-1:2006, 9.3.1.3; formula and bounds as programs by others have them, not compared with its curves.
  elemental real(dp) function gear_blank_factor(web, rim, width, module) result(factor)
    real(dp), intent(in) :: web, rim, width, module

    factor = 1
    if (web > 0) factor = 1 + log(min(1.2_dp, max(0.2_dp, web/width)))/(5*exp(max(1.0_dp, rim/module)/5))
  end function gear_blank_factor
end module gearsweep_stiffness
