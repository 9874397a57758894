!> Pair stiffness from finite elements: both gears' sections, loaded along the
!> path of contact, with Hertz's flattening.
module gearsweep_fe_stiffness
  use gearsweep_kinds, only: dp, pi
  use gearsweep_body, only: body_t, make_body
  use gearsweep_compliance, only: deflection_at_depth
  use gearsweep_disc, only: disc_t, disc_compliance
  use gearsweep_flattening, only: contact_half_width, surface_to_depth, check_contact
  use gearsweep_error, only: error_t, fail, code_input, code_numerical
  use gearsweep_gear, only: gear_t, drive
  use gearsweep_material, only: material_t
  use gearsweep_pair, only: pair_t
  use gearsweep_piecewise, only: piecewise_t, spline
  use gearsweep_section, only: section_t, section_options_t, make_section
  use gearsweep_text, only: str
  implicit none
  private
  public :: fe_options_t, fe_stiffness, tooth_compliance

  !> Knots of the stiffness over the path.
  integer, parameter, public :: fe_knots = 49

  !> Teeth are wide, hence plane strain unless said. The default grid holds the
  !> pair stiffness of usual gears to 0.1 %, of narrow tips to 0.3 %.
  type :: fe_options_t
    type(section_options_t) :: section = &
      section_options_t(plane_strain=.true., elements_across=16, others_across=4)
    !> Where the grid's share ends and Hertz's begins, in modules.
    real(dp) :: depth = 0.4_dp
    integer :: positions = 17                    !< of the load along the path
  end type fe_options_t

contains

  !> K(s) of one pair (N/m, smaller face width) over the path coordinate s, without the turning of
  !> whole gears about their bores, and what their discs yield under all pairs together (m/N).
  !>
  !> Both members are of `material`; `line_load` (N/m) is the nominal load that
  !> the flattening is taken at (secant stiffness). Equal gears share the work.
  subroutine fe_stiffness(pair, material, options, line_load, curve, disc, error)
    type(pair_t), intent(in) :: pair
    type(material_t), intent(in) :: material
    type(fe_options_t), intent(in) :: options
    real(dp), intent(in) :: line_load
    type(piecewise_t), intent(out) :: curve
    type(disc_t), intent(out) :: disc
    type(error_t), allocatable, intent(out) :: error
    type(piecewise_t) :: tooth(2)
    type(disc_t) :: part(2)
    real(dp) :: s(fe_knots), half_width(fe_knots), flat(fe_knots), total(fe_knots), width
    integer :: i

    if (.not. line_load > 0) then
      call fail(error, code_input, '&load line_load_n_mm = '//str(line_load/1000)//': must be above 0')
      return
    end if
    s = [(pair%contact_ratio*i/(fe_knots - 1), i=0, fe_knots - 1)]
    associate (r1 => pair%curvature(1, s), r2 => pair%curvature(2, s), strain => options%section%plane_strain)
      half_width = contact_half_width(material, strain, line_load, r1, r2)
      call check_contact(maxval(half_width), pair%gear(1)%spec%module, line_load, error)
      if (.not. allocated(error)) call both_teeth(pair, material, options, tooth, part, error)
      if (allocated(error)) return
      flat = surface_to_depth(material, strain, half_width, pair%gear(1)%spec%module)
      do i = 1, fe_knots
        total(i) = tooth(1)%value(r1(i)) + tooth(2)%value(r2(i)) + 2*flat(i)
      end do
    end associate
    associate (alone => total - sum(part%shared))
      if (any(.not. alone > 0)) then
        call fail(error, code_numerical, '&mesh model: the pair compliance is not positive at s = '// &
          str(s(findloc(.not. alone > 0, .true., 1)))//'; the line load is too large')
        return
      end if
    end associate
    width = minval(pair%gear%spec%face_width)
    curve = spline(s, width/total)
    disc = disc_t(turn=sum(part%turn)/width, shared=sum(part%shared)/width)
  end subroutine fe_stiffness

  subroutine both_teeth(pair, material, options, tooth, disc, error)
    type(pair_t), intent(in) :: pair
    type(material_t), intent(in) :: material
    type(fe_options_t), intent(in) :: options
    type(piecewise_t), intent(out) :: tooth(2)
    type(disc_t), intent(out) :: disc(2)
    type(error_t), allocatable, intent(inout) :: error
    real(dp) :: ends(2)
    integer :: i

    do i = 1, 2
      ends = pair%curvature(i, [0.0_dp, pair%contact_ratio])
      if (i == 2 .and. are_equal(pair%gear(1), pair%gear(2))) then
        tooth(2) = tooth(1)
        disc(2) = disc(1)
      else
        call tooth_compliance(pair%gear(i), material, options, minval(ends), maxval(ends), tooth(i), disc(i), error)
        if (allocated(error)) return
      end if
    end do
  end subroutine both_teeth

  !> Compliance (m2/N, per line load) of one tooth on its body over the radius
  !> of curvature of its drive flank from `first` to `last` (m), less
  !> `surface_to_depth` for the depth of one module. Of a whole gear also less
  !> what it turns about its bore, which `disc` has instead.
  !>
  !> Seen from two depths, h and 2 h, and extrapolated to depth 0: what the
  !> grid adds to the half plane between surface and depth is linear in h.
  !> Near the tip h shrinks with the tooth.
  subroutine tooth_compliance(gear, material, options, first, last, curve, disc, error)
    type(gear_t), intent(in) :: gear
    type(material_t), intent(in) :: material
    type(fe_options_t), intent(in) :: options
    real(dp), intent(in) :: first, last
    type(piecewise_t), intent(out) :: curve
    type(disc_t), intent(out) :: disc
    type(error_t), allocatable, intent(out) :: error
    type(section_t) :: section
    type(body_t) :: body
    real(dp), dimension(max(4, options%positions)) :: curvature, radius, depth, near, far
    integer :: i

    call make_section(gear, options%section, section, error)
    if (allocated(error)) return
    call make_body(section%grid, material, options%section%plane_strain, 1.0_dp, &
                   spread(section%is_held(), 1, 2), options%section%most_memory, body, error)
    if (allocated(error)) return
    ! Denser towards the tip, where the compliance climbs.
    curvature = [(sin(pi/2*i/(size(curvature) - 1)), i=0, size(curvature) - 1)]
    curvature = first + (last - first)*curvature
    radius = min(hypot(gear%base_radius(drive), curvature), gear%tip_radius)
    depth = smaller(options%depth*gear%spec%module, 0.35_dp*chord(gear, radius))
    call deflection_at_depth(section, body, radius, depth, 2*depth, near, far, error)
    if (.not. allocated(error) .and. section%grid%closed) call disc_compliance(section, body, first, last, disc, error)
    if (allocated(error)) return
    near = near + surface_to_depth(material, options%section%plane_strain, gear%spec%module, depth)
    far = far + surface_to_depth(material, options%section%plane_strain, gear%spec%module, 2*depth)
    curve = spline(curvature, 2*near - far + offset(material, options%section%plane_strain) - disc%turn)
  end subroutine tooth_compliance

  !> Length (m) of the line of action within the tooth, on involutes of the drive flank.
  elemental real(dp) function chord(gear, radius)
    type(gear_t), intent(in) :: gear
    real(dp), intent(in) :: radius
    real(dp) :: angle

    angle = gear%half_angle(drive, radius)
    chord = 2*radius*sin(angle)/cos(acos(min(1.0_dp, gear%base_radius(drive)/radius)) - angle)
  end function chord

  !> The smaller of two lengths, rounded so that it has no kink.
  elemental real(dp) function smaller(a, b)
    real(dp), intent(in) :: a, b

    smaller = (a**(-8) + b**(-8))**(-0.125_dp)
  end function smaller

  !> The half plane's constant, which is counted once with the flattening.
  elemental real(dp) function offset(material, plane_strain)
    type(material_t), intent(in) :: material
    logical, intent(in) :: plane_strain

    offset = -surface_to_depth(material, plane_strain, 1.0_dp, 1.0_dp)
  end function offset

  pure logical function are_equal(a, b)
    type(gear_t), intent(in) :: a, b

    associate (p => a%spec, q => b%spec)
      are_equal = p%teeth == q%teeth .and. all(same( &
        [p%module, p%pressure_angle, p%profile_shift, p%addendum, p%dedendum, p%rack_tip_radius, &
         p%tip_alteration, p%bore_radius], &
        [q%module, q%pressure_angle, q%profile_shift, q%addendum, q%dedendum, q%rack_tip_radius, &
         q%tip_alteration, q%bore_radius]))
    end associate

  contains

    elemental logical function same(x, y)
      real(dp), intent(in) :: x, y

      same = .not. abs(x - y) > 0
    end function same
  end function are_equal
end module gearsweep_fe_stiffness
