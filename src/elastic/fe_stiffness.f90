!> Pair stiffness by finite elements: the sections of both gears, loaded along the path of contact, with Hertz's flattening.
!>
!> The compliance of a tooth is stored with the inputs that it was computed from, so that no tooth is solved twice. A tooth
!> depends on its own gear and on the part of its flank that touches the mate, not on load, relief, face width, masses or
!> densities.
module gearsweep_elastic_fe_stiffness
  use, intrinsic :: iso_fortran_env, only: int64
  use gearsweep_base, only: code_input, code_numerical, dp, error_t, fail, interpolated, joined, pi, piecewise_t, polynomial, &
    spline, str
  use gearsweep_gear, only: contact_reach, gear_spec_t, gear_t, normal_section, pair_t
  use gearsweep_elastic_compliance, only: tooth_compliance, tooth_t
  use gearsweep_elastic_corner_stiffness, only: compliance_slope, corner_compliance, edge_zone, moved_contact
  use gearsweep_elastic_disc, only: disc_t
  use gearsweep_elastic_flattening, only: check_contact, contact_half_width, edge_share, even_flattening, flattening_t, &
    load_dependence, surface_to_depth
  use gearsweep_elastic_hub, only: felt_twist
  use gearsweep_elastic_material, only: fe_options_t, material_t
  implicit none
  private
  public :: teeth_t, fe_options_t, fe_stiffness, fe_deflection, plane_compliance, plane_tooth_t

  !> All inputs of a tooth: its solution uses no others. Without allocatable components, so that one `write` outputs all of it to
  !> the last bit.
  type :: tooth_inputs_t
    type(gear_t) :: gear
    type(material_t) :: material
    type(fe_options_t) :: options
    real(dp) :: first = 0, last = 0              !< radii of curvature at the ends of the drive flank's contact, m
  end type tooth_inputs_t

  type :: solved_tooth_t
    type(tooth_inputs_t) :: inputs
    character(:), allocatable :: words           !< the inputs as text
    type(tooth_t) :: tooth
  end type solved_tooth_t

  !> Most recently solved teeth, the newest first.
  type :: teeth_t
    type(solved_tooth_t), allocatable :: list(:)
    integer :: solved = 0, taken = 0             !< numbers of teeth solved and reused in this run
  contains
    procedure :: find
  end type teeth_t

  !> Plane compliance of one gear's teeth along the path of contact, per line load, m2/N.
  type :: plane_tooth_t
    real(dp) :: modulus = 0                      !< E/(1 - nu**2), Pa
    !> Compliance of a tooth over the path coordinate, with Hertz's pressure over a half width of one module; of a complete gear
    !> without its rotation about the bore.
    type(piecewise_t) :: compliance
    !> Deflection of the next tooth, over the path coordinate of the first from 0 to where it is alone; constant outside.
    type(piecewise_t) :: shared
    real(dp) :: beyond = 0                       !< deflection of the second tooth from the loaded one, and of all farther ones
    real(dp) :: turn = 0                         !< compliance by rotation about the bore
  end type plane_tooth_t

  !> Largest number stored; each needs about 6 kB.
  integer, parameter :: most = 64
  integer(int64), parameter :: bytes(1) = 0

  !> Knots of the stiffness over the path.
  integer, parameter, public :: fe_knots = 49
  !> Knots of corner contact beyond each end of the path, and within the path where the edge has an effect.
  integer, parameter :: corner_knots = 9, zone_knots = 6
  !> Fraction of the nominal load for the second flattening at a corner: the load of a pair near the path's ends.
  real(dp), parameter :: small = 0.3_dp

contains

  !> Finds the `tooth` of this gear, and solves it if it is not stored; arguments as of `tooth_compliance`, except that in
  !> `options` the rims of pinion and gear and the inertia at their bores have no effect.
  subroutine find(self, gear, material, options, first, last, tooth, error)
    class(teeth_t), intent(inout) :: self
    type(gear_t), intent(in) :: gear
    type(material_t), intent(in) :: material
    type(fe_options_t), intent(in) :: options
    real(dp), intent(in) :: first, last
    type(tooth_t), intent(out) :: tooth
    type(error_t), allocatable, intent(inout) :: error
    type(tooth_inputs_t) :: inputs
    character(storage_size(inputs)) :: words
    type(solved_tooth_t), allocatable :: others(:)
    type(gear_spec_t) :: usual_gear
    type(fe_options_t) :: usual
    type(material_t) :: steel
    integer :: at

    inputs = tooth_inputs_t(gear, material, options, first, last)
    ! Inputs without effect are set as in any other gear.
    inputs%gear%spec%name = usual_gear%name
    inputs%gear%spec%face_width = usual_gear%face_width
    inputs%gear%spec%pin_diameter = usual_gear%pin_diameter
    inputs%material%density = steel%density
    inputs%options%rim = usual%rim
    inputs%options%rim_teeth = usual%rim_teeth
    inputs%options%hub_share = usual%hub_share
    if (.not. allocated(self%list)) allocate (self%list(0))
    do at = size(self%list), 1, -1
      if (all(transfer(self%list(at)%inputs, bytes) == transfer(inputs, bytes))) exit
    end do
    ! Bytes may differ although the numbers agree: those of gaps and blanks have no meaning.
    if (at == 0) then
      write (words, '(*(g0, 1x))') inputs
      do at = size(self%list), 1, -1
        if (self%list(at)%words == words) exit
      end do
    end if
    if (at > 0) then
      self%taken = self%taken + 1
      tooth = self%list(at)%tooth
      return
    end if
    call tooth_compliance(inputs%gear, inputs%material, inputs%options, inputs%first, inputs%last, tooth, error)
    if (allocated(error)) return
    self%solved = self%solved + 1
    call move_alloc(self%list, others)
    allocate (self%list(min(most, size(others) + 1)))
    self%list(1)%inputs = inputs
    self%list(1)%words = trim(words)
    self%list(1)%tooth = tooth
    do at = 2, size(self%list)
      self%list(at) = others(at - 1)
    end do
  end subroutine find

  !> Computes K(s) of one pair (N/m, smaller face width) over the path coordinate s, without the turning of complete gears about
  !> their bores except for the part felt by the motion due to the inertia at their hubs, and the deflection of their bodies under
  !> all pairs together (m/N).
  !>
  !> `material` is that of pinion and gear; `line_load` (N/m) is the nominal load of the flattening (secant stiffness). Equal
  !> gears share the work.
  !>
  !> With corner contact the curve extends beyond A and E, to where a pair may be in contact (`contact_reach`).
  !>
  !> `teeth`: in: stored teeth; out: also those of this pair.
  subroutine fe_stiffness(pair, material, options, line_load, curve, disc, error, flattening, teeth)
    type(pair_t), intent(in) :: pair
    type(material_t), intent(in) :: material(2)
    type(fe_options_t), intent(in) :: options
    real(dp), intent(in) :: line_load
    type(piecewise_t), intent(out) :: curve
    type(disc_t), intent(out) :: disc
    type(error_t), allocatable, intent(out) :: error
    type(flattening_t), intent(out), optional :: flattening
    type(teeth_t), intent(inout), optional :: teeth
    type(tooth_t) :: tooth(2)
    real(dp), allocatable :: s(:), half_width(:), total(:)
    type(flattening_t) :: own
    real(dp) :: width, zone(2), felt
    integer :: i

    if (.not. line_load > 0) then
      call fail(error, code_input, 'line load (N/mm) = '//str(line_load/1000)//': must be above 0')
      return
    end if
    zone = 0
    if (options%corner_contact) zone = edge_zone(pair, material, options%section%plane_strain, line_load)
    s = path_knots(pair%contact_ratio, zone)
    associate (r1 => pair%curvature(1, s), r2 => pair%curvature(2, s), strain => options%section%plane_strain)
      half_width = contact_half_width(material(1), material(2), strain, line_load, r1, r2)
      call check_contact(maxval(half_width), pair%gear(1)%spec%module, line_load, error)
      if (.not. allocated(error)) call both_teeth(pair, material, options, tooth, error, teeth)
      if (allocated(error)) return
      associate (flat1 => surface_to_depth(material(1), strain, half_width, pair%gear(1)%spec%module), &
                 flat2 => surface_to_depth(material(2), strain, half_width, pair%gear(2)%spec%module))
        felt = sum(felt_twist(options%hub_share, tooth%disc%turn))
        total = values(tooth(1)%compliance, r1) + values(tooth(2)%compliance, r2) + (flat1 + flat2) + felt
        ! If contact ends at A and E it also stays on the line of action, as in models with that assumption.
        if (options%corner_contact) total = total - &
          [(moved_contact(line_load, compliance_slope(pair, tooth, [r1(i), r2(i)]), [r1(i), r2(i)]), i=1, size(s))]
      end associate
    end associate
    width = minval(pair%gear%spec%face_width)
    disc = both_discs([tooth(1)%disc, tooth(2)%disc], felt, width)
    call check_compliance(s, total - width*disc%most_shared(), error)
    if (allocated(error)) return
    own = even_flattening(sum(load_dependence(material, options%section%plane_strain))/width)
    if (options%corner_contact) then
      call find_with_corners()
    else
      curve = spline(s, width/total)
    end if
    if (present(flattening)) flattening = own

  contains

    !> Computes the path with the effect of the edges near its ends, and the parts beyond.
    subroutine find_with_corners()
      real(dp) :: beyond(corner_knots, 2), there(corner_knots, 2, 2), reach(2)
      integer :: i

      reach = contact_reach(pair, line_load*maxval(total))
      if (.not. (reach(1) < 0 .or. reach(2) > pair%contact_ratio)) then
        curve = spline(s, width/total)
        return
      end if
      beyond(:, 1) = reach(1)*[(1 - i/(corner_knots - 1.0_dp), i=0, corner_knots - 1)]
      beyond(:, 2) = pair%contact_ratio + (reach(2) - pair%contact_ratio)*[(i/(corner_knots - 1.0_dp), i=0, corner_knots - 1)]
      do i = 1, 2
        if (i == 2 .and. are_equal(pair, material, options)) then
          there(:, :, 2) = there(corner_knots:1:-1, :, 1)
          exit
        end if
        call corner_compliance(pair, tooth, material, options%section%plane_strain, [1.0_dp, small]*line_load, beyond(:, i), &
                               there(:, :, i), error)
        there(:, :, i) = there(:, :, i) + felt
        if (.not. allocated(error)) call check_compliance(beyond(:, i), there(:, 1, i) - width*disc%most_shared(), error)
        if (allocated(error)) return
      end do
      own%zone = zone
      call flatten_beyond(-beyond(corner_knots:1:-1, 1), there(corner_knots:1:-1, :, 1)/width, 1, own)
      call flatten_beyond(beyond(:, 2) - pair%contact_ratio, there(:, :, 2)/width, 2, own)
      total = total + (there(corner_knots, 1, 1) - total(1))*edge_share(s, zone(1)) &
              + (there(1, 1, 2) - total(size(s)))*edge_share(pair%contact_ratio - s, zone(2))
      ! Where the edge has an effect the stiffness falls within less than a step of the motion: one polynomial, with an end of a
      ! step at its ends too, costs fewer steps than a spline.
      associate (n => zone_knots, last => size(s), stiffness => width/total)
        curve = joined(interpolated(s(1), s(n + 1), stiffness(:n + 1)), spline(s(n + 1:last - n), stiffness(n + 1:last - n)))
        curve = joined(curve, interpolated(s(last - n), s(last), stiffness(last - n:)))
      end associate
      curve = joined(joined(spline(beyond(:, 1), width/there(:, 1, 1)), curve), spline(beyond(:, 2), width/there(:, 1, 2)))
    end subroutine find_with_corners
  end subroutine fe_stiffness

  !> Fills in the decrease of the flattening beyond A or E (`end` 1 or 2) with the load, from the compliances there under the
  !> nominal load and under the `small` fraction of it. Beyond the end of the path it approaches that of the edge alone, as the
  !> flanks tilt against each other: by an exponential through the places next to the end and farthest from it.
  pure subroutine flatten_beyond(past, compliance, end, flattening)
    real(dp), intent(in) :: past(:)              !< beyond the end of the path, ascending from 0, base pitches
    real(dp), intent(in) :: compliance(:, :)     !< m/N; (place, load)
    integer, intent(in) :: end
    type(flattening_t), intent(inout) :: flattening
    real(dp) :: fall(size(past))

    fall = (compliance(:, 2) - compliance(:, 1))/(-log(small))
    flattening%at_end(end) = fall(1)
    flattening%beyond(end) = fall(size(past))
    flattening%length(end) = past(2)
    associate (left => (fall(size(past)) - fall(2))/(fall(size(past)) - fall(1)))
      if (left > 0 .and. left < 1) flattening%length(end) = -past(2)/log(left)
    end associate
  end subroutine flatten_beyond

  !> Computes the deflection of each gear's tooth along the line of action under `line_load` (N/m) at its path coordinate in `s`
  !> (m): bending with its body, and its flattening for this half width of the contact (m), without the turning of complete gears
  !> about their bores.
  subroutine fe_deflection(pair, material, options, line_load, half_width, s, deflection, error)
    type(pair_t), intent(in) :: pair
    type(material_t), intent(in) :: material(2)
    type(fe_options_t), intent(in) :: options
    real(dp), intent(in) :: line_load, half_width(2), s(2)
    real(dp), intent(out) :: deflection(2)
    type(error_t), allocatable, intent(out) :: error
    type(fe_options_t) :: on_path
    type(tooth_t) :: tooth(2)
    integer :: i

    on_path = options
    on_path%corner_contact = .false.
    deflection = 0
    call both_teeth(pair, material, on_path, tooth, error)
    if (allocated(error)) return
    do i = 1, 2
      deflection(i) = line_load*(tooth(i)%compliance%value(pair%curvature(i, s(i))) + &
        surface_to_depth(material(i), options%section%plane_strain, half_width(i), pair%gear(i)%spec%module))
    end do
  end subroutine fe_deflection

  !> Computes the plane compliance of both gears' teeth, in plane strain: of helical gears that of the virtual gears of their normal
  !> section. Arguments as of `fe_stiffness`; corner contact and the inertia at the bores have no effect.
  subroutine plane_compliance(pair, material, options, plane, error, teeth)
    type(pair_t), intent(in) :: pair
    type(material_t), intent(in) :: material(2)
    type(fe_options_t), intent(in) :: options
    type(plane_tooth_t), intent(out) :: plane(2)           !< of pinion and gear
    type(error_t), allocatable, intent(out) :: error
    type(teeth_t), intent(inout), optional :: teeth
    type(tooth_t) :: tooth(2)
    type(pair_t) :: normal
    real(dp), allocatable :: s(:)
    integer :: i

    if (.not. options%section%plane_strain) then
      call fail(error, code_input, 'plane of the section: must be strain for teeth whose load varies over the face width')
      return
    end if
    if (pair%overlap_ratio > 0 .and. options%section%teeth >= minval(pair%gear%spec%teeth)) then
      call fail(error, code_input, 'teeth of the section = '//str(options%section%teeth)//': must be 0, for whole gears, or '// &
                'fewer than helical gears have')
      return
    end if
    call normal_section(pair, options%section%teeth == 0, normal, error)
    if (.not. allocated(error)) call both_teeth(normal, material, options, tooth, error, teeth)
    if (allocated(error)) return
    s = path_knots(pair%contact_ratio, [0.0_dp, 0.0_dp])
    do i = 1, 2
      associate (m => pair%gear(i)%spec%module, disc => tooth(i)%disc)
        plane(i)%modulus = material(i)%young/(1 - material(i)%poisson**2)
        plane(i)%compliance = spline(s, values(tooth(i)%compliance, normal%curvature(i, s)) &
                                        + surface_to_depth(material(i), .true., m, m))
        ! Legendre's polynomials over the interval; the path runs down the gear's flank.
        plane(i)%shared = polynomial(0.0_dp, pair%contact_ratio - 1, [disc%shared - disc%change(2)/2, &
                                     merge(1, -1, i == 1)*disc%change(1), 1.5_dp*disc%change(2)])
        plane(i)%beyond = disc%shared_beyond()
        plane(i)%turn = disc%turn
      end associate
    end do
  end subroutine plane_compliance

  !> Deflection of the bodies of pinion and gear together, including the part of their turning `felt` by the motion (m2/N). The
  !> path runs up the flank of the pinion and down that of the gear.
  pure type(disc_t) function both_discs(each, felt, width) result(disc)
    type(disc_t), intent(in) :: each(2)          !< under a unit line load, m2/N
    real(dp), intent(in) :: felt, width          !< m2/N, m

    disc = disc_t(turn=(sum(each%turn) - felt)/width, shared=(sum(each%shared) + felt)/width, &
                  change=[each(1)%change(1) - each(2)%change(1), each(1)%change(2) + each(2)%change(2)]/width, &
                  decline=sum(each%decline)/width, twist=each%turn/width)
  end function both_discs

  !> Path coordinates from A to E in equal steps, but in the zones (base pitches) at both ends those of `interpolated`.
  pure function path_knots(contact_ratio, zone) result(s)
    real(dp), intent(in) :: contact_ratio, zone(2)
    real(dp), allocatable :: s(:)
    real(dp) :: ascent(0:zone_knots)
    integer :: i

    s = [(contact_ratio*i/(fe_knots - 1), i=0, fe_knots - 1)]
    if (.not. any(zone > 0)) return
    ascent = [((1 - cos(pi*i/zone_knots))/2, i=0, zone_knots)]
    s = [zone(1)*ascent(0:zone_knots - 1), zone(1) + (contact_ratio - sum(zone))*s/contact_ratio, &
         contact_ratio - zone(2)*ascent(zone_knots - 1:0:-1)]
  end function path_knots

  pure function values(curve, x) result(f)
    type(piecewise_t), intent(in) :: curve
    real(dp), intent(in) :: x(:)
    real(dp) :: f(size(x))
    integer :: i

    f = [(curve%value(x(i)), i=1, size(x))]
  end function values

  !> Checks that a pair by itself has a positive compliance.
  pure subroutine check_compliance(s, alone, error)
    real(dp), intent(in) :: s(:), alone(:)
    type(error_t), allocatable, intent(inout) :: error

    if (any(.not. alone > 0)) call fail(error, code_numerical, 'pair stiffness: the pair compliance is not positive at s = '// &
      str(s(findloc(.not. alone > 0, .true., 1)))//'; the line load is too large')
  end subroutine check_compliance

  !> Finds the teeth of both gears; equal gears have equal ones.
  subroutine both_teeth(pair, material, options, tooth, error, teeth)
    type(pair_t), intent(in) :: pair
    type(material_t), intent(in) :: material(2)
    type(fe_options_t), intent(in) :: options
    type(tooth_t), intent(out) :: tooth(2)
    type(error_t), allocatable, intent(inout) :: error
    type(teeth_t), intent(inout), optional :: teeth  !< in: stored teeth; out: also these
    type(teeth_t) :: known
    type(fe_options_t) :: own
    real(dp) :: ends(2)
    integer :: i

    if (present(teeth)) known = teeth
    do i = 1, 2
      own = options
      ! A rim on a narrow strip of web: free below, between the sides of the section.
      if (options%rim(i) > 0) then
        own%section%rim = options%rim(i)
        own%section%teeth = options%rim_teeth
        own%section%fixed_sides = .true.
        own%section%fixed_rim = .false.
      end if
      ends = pair%curvature(i, [0.0_dp, pair%contact_ratio])
      if (i == 2 .and. are_equal(pair, material, options)) then
        tooth(2) = tooth(1)
      else
        call known%find(pair%gear(i), material(i), own, minval(ends), maxval(ends), tooth(i), error)
        if (allocated(error)) return
      end if
    end do
    if (present(teeth)) teeth = known
  end subroutine both_teeth

  !> True if both gears deflect alike.
  pure logical function are_equal(pair, material, options)
    type(pair_t), intent(in) :: pair
    type(material_t), intent(in) :: material(2)
    type(fe_options_t), intent(in) :: options

    associate (p => pair%gear(1)%spec, q => pair%gear(2)%spec)
      are_equal = p%teeth == q%teeth .and. all(same( &
        [p%module, p%pressure_angle, p%profile_shift, p%addendum, p%dedendum, p%rack_tip_radius, &
         p%tip_alteration, p%bore_radius, p%thinning, p%tip_diameter, p%tip_chamfer, p%tip_rounding, p%tip_form_diameter, &
         p%protuberance, p%grinding_stock], &
        [q%module, q%pressure_angle, q%profile_shift, q%addendum, q%dedendum, q%rack_tip_radius, &
         q%tip_alteration, q%bore_radius, q%thinning, q%tip_diameter, q%tip_chamfer, q%tip_rounding, q%tip_form_diameter, &
         q%protuberance, q%grinding_stock])) &
        .and. same(material(1)%young, material(2)%young) .and. same(material(1)%poisson, material(2)%poisson) &
        .and. same(options%rim(1), options%rim(2))
    end associate

  contains

    elemental logical function same(x, y)
      real(dp), intent(in) :: x, y

      same = .not. abs(x - y) > 0
    end function same
  end function are_equal
end module gearsweep_elastic_fe_stiffness
