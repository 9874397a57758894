!> Contact of a tooth's tip corner before the path of contact and after it.
!>
!> Under load the pairs in contact deflect, so that the next pair closes before its nominal start A, and the leaving one opens
!> after its end E. There the corner at the end of an involute, the gear's before A and the pinion's after E, touches the mate's
!> flank off the line of action.
!>
!> The corner moves on its tip circle. Its distance from the mate's centre is least on the line of centres, so that it meets the
!> mate's involute above the place of A or E, never below: it cannot reach the fillet.
!> Munro, Morrish, Palmer 1999 (Gear transmission error outside the normal path of contact due to corner and top contact)
!> treat this contact and give approximations; here it is exact, by the involutes' own equations.
module gearsweep_gear_tip_corner
  use gearsweep_base, only: bracket_t, dp, interpolated, joined, piecewise_t
  use gearsweep_gear_gear, only: drive
  use gearsweep_gear_pair, only: pair_t
  use gearsweep_gear_relief, only: relief_t, tip_relief
  implicit none
  private
  public :: corner_t, corner_contact, corner_reach, contact_reach, add_corners, add_corner_stiffness, arm_change, touching_curvature

  !> Place of the tip corner, for one pair at one path coordinate.
  type :: corner_t
    !> Distance of the corner from the mate's flank, along the flank's normal, m; they touch after a rotation of the mate by this
    !> over its base radius.
    real(dp) :: gap = 0
    real(dp) :: curvature = 0                    !< radius of curvature of the mate's flank at the contact, m
    real(dp) :: s = 0                            !< path coordinate at which that place of the flank has its contact on the path
    real(dp) :: tilt = 0                         !< tilt of the mate's normal against that of the corner's own flank, rad
    !> Lever arm of the load about the centre of the corner's gear, over its base radius; the mate's is its base radius.
    real(dp) :: lever = 1
    !> Mean of both lever arms over their base radii: as both gears turn by half of a deflection x along the line of action each,
    !> corner and flank approach by this part of x along the mate's normal, and this part of their load is along the line.
    real(dp) :: part_along = 1
    !> Lever arm of friction about the centre of the corner's gear, m; the mate's is the radius of curvature.
    real(dp) :: friction_arm = 0
  end type corner_t

  !> Degree of polynomials for the square of the gap in base pitches, which is smooth over less than one base pitch: they fit it
  !> to about 1e-9 of itself.
  integer, parameter :: degree = 8

contains

  !> Computes corner and flank of the pair at path coordinate `s`, before A (below 0) or after E (above the contact ratio), as
  !> both gears turn without load. The gap is exact: the mate's flank is rotated until it passes through the corner, and the angle
  !> gives the gap along the line of action.
  elemental type(corner_t) function corner_contact(pair, s) result(corner)
    type(pair_t), intent(in) :: pair
    real(dp), intent(in) :: s
    real(dp) :: beyond, tangent, tip, turned, place(2), radius, angle
    integer :: tooth, mate

    tooth = corner_of(pair, s)
    mate = 3 - tooth
    beyond = pair%base_pitch*merge(-s, s - pair%contact_ratio, tooth == 2)
    tangent = pair%curvature(1, s) + pair%curvature(2, s)
    associate (own => pair%gear(tooth)%base_radius(drive), other => pair%gear(mate)%base_radius(drive))
      tip = pair%curvature(tooth, merge(0.0_dp, pair%contact_ratio, tooth == 2))
      turned = beyond/own
      ! From the mate's centre: x along the line of action, away from the mate's tangent point, y along its base radius.
      place = [tangent - own*sin(turned) - tip*cos(turned), own + other - own*cos(turned) + tip*sin(turned)]
      radius = norm2(place)
      corner%curvature = sqrt((radius - other)*(radius + other))
      ! Rotation of the mate's base radius to the line through the corner, tangent to the base circle.
      angle = atan2(place(1), place(2)) - atan2(corner%curvature, other)
      corner%gap = corner%curvature + other*angle - (tangent - tip - beyond)
      corner%tilt = turned - angle
      corner%lever = (tangent*sin(angle) + (own + other)*cos(angle) - other)/own
      corner%part_along = (1 + corner%lever)/2
      corner%friction_arm = sqrt(max(0.0_dp, own**2 + tip**2 - (corner%lever*own)**2))
      corner%s = (corner%curvature - pair%start_curvature)/pair%base_pitch
      if (mate == 2) corner%s = (tangent - corner%curvature - pair%start_curvature)/pair%base_pitch
    end associate
  end function corner_contact

  !> Gear whose corner it is: the gear (2) before the path's middle, the pinion (1) after it.
  elemental integer function corner_of(pair, s)
    type(pair_t), intent(in) :: pair
    real(dp), intent(in) :: s

    corner_of = merge(2, 1, s < pair%contact_ratio/2)
  end function corner_of

  !> Radius of curvature (m) of a gear's drive flank at its contact at path coordinate `s`: on the path of contact or, beyond it,
  !> at the tip corner and its contact with the mate.
  elemental real(dp) function touching_curvature(pair, gear, s) result(curvature)
    type(pair_t), intent(in) :: pair
    integer, intent(in) :: gear
    real(dp), intent(in) :: s
    type(corner_t) :: corner

    curvature = pair%curvature(gear, max(0.0_dp, min(pair%contact_ratio, s)))
    if (s >= 0 .and. s <= pair%contact_ratio) return
    if (gear == corner_of(pair, s)) return
    corner = corner_contact(pair, s)
    curvature = corner%curvature
  end function touching_curvature

  !> Change of the lever arm of friction about a gear's centre, over its base radius, per base pitch before A (`end` 1) or after E
  !> (2), off the line of action: the secant up to path coordinate `s`, at which the corner touches.
  pure real(dp) function arm_change(pair, gear, end, s) result(change)
    type(pair_t), intent(in) :: pair
    integer, intent(in) :: gear, end
    real(dp), intent(in) :: s
    type(corner_t) :: corner
    real(dp) :: from, arm

    from = merge(0.0_dp, pair%contact_ratio, end == 1)
    corner = corner_contact(pair, s)
    arm = merge(corner%friction_arm, corner%curvature, gear == corner_of(pair, s))
    change = (arm - pair%curvature(gear, from))/pair%gear(gear)%base_radius(drive)/(s - from)
  end function arm_change

  !> Path coordinates before A and after E at which the gap of the corner, without reliefs, is `depth` (m); at most 0.9 base
  !> pitches off, and no farther than the corner's contact with the mate's tip.
  pure function corner_reach(pair, depth) result(reach)
    type(pair_t), intent(in) :: pair
    real(dp), intent(in) :: depth
    real(dp) :: reach(2)
    real(dp), parameter :: farthest = 0.9_dp
    type(bracket_t) :: distance
    integer :: i

    do i = 1, 2
      distance = bracket_t(0.0_dp, farthest)
      do while (distance%is_open())
        call distance%halve(is_within(end_of(i) + merge(-1, 1, i == 1)*distance%middle()))
      end do
      reach(i) = end_of(i) + merge(-1, 1, i == 1)*distance%low
    end do

  contains

    pure real(dp) function end_of(i)
      integer, intent(in) :: i

      end_of = merge(0.0_dp, pair%contact_ratio, i == 1)
    end function end_of

    pure logical function is_within(s)
      real(dp), intent(in) :: s
      type(corner_t) :: corner

      corner = corner_contact(pair, s)
      is_within = corner%gap < depth .and. corner%s > 0 .and. corner%s < pair%contact_ratio
    end function is_within
  end function corner_reach

  !> Path coordinates between which a pair may be in contact under loads that deflect its softest place by `deflection` (m): at
  !> four times that gap of the corner no static load closes it, and in the motion only one above four times the nominal load on
  !> one pair. From A to E for loads too small to justify its short steps.
  pure function contact_reach(pair, deflection) result(reach)
    type(pair_t), intent(in) :: pair
    real(dp), intent(in) :: deflection
    real(dp) :: reach(2)
    real(dp), parameter :: margin = 4, shortest = 1e-4_dp

    reach = corner_reach(pair, margin*deflection)
    if (max(-reach(1), reach(2) - pair%contact_ratio) < shortest) reach = [0.0_dp, pair%contact_ratio]
  end function contact_reach

  !> Extends the stiffness `curve` of a pair (N/m), known from A to E, to the contact range under `load` (N). Beyond A and E the
  !> stiffness is that at the end of the path, reduced by the inclination of the load to the line of action (`part_along` of
  !> corner_t). Continuous at A and E.
  pure subroutine add_corner_stiffness(pair, load, curve)
    type(pair_t), intent(in) :: pair
    real(dp), intent(in) :: load
    type(piecewise_t), intent(inout) :: curve
    real(dp) :: reach(2)

    reach = contact_reach(pair, load/curve%minimum())
    if (reach(1) < 0) curve = joined(beyond(reach(1), 0.0_dp, curve%value(0.0_dp)), curve)
    if (reach(2) > pair%contact_ratio) &
      curve = joined(curve, beyond(pair%contact_ratio, reach(2), curve%value(pair%contact_ratio)))

  contains

    pure type(piecewise_t) function beyond(first, last, at_end)
      real(dp), intent(in) :: first, last
      real(dp), intent(in) :: at_end             ! stiffness, N/m
      type(corner_t) :: corner(0:degree)

      corner = corner_contact(pair, knots(first, last))
      beyond = interpolated(first, last, at_end*corner%part_along**2)
    end function beyond
  end subroutine add_corner_stiffness

  !> Extends the profile error `curve` (m), known from A to E, to `reach` (base pitches; see corner_reach): by the gap of the
  !> corner, the full relief of the corner, and the relief of the mate at the contact. Continuous at A and E. Along the line of
  !> action: the deflection that closes them (`part_along` of corner_t).
  pure subroutine add_corners(pair, relief, reach, curve)
    type(pair_t), intent(in) :: pair
    type(relief_t), intent(in) :: relief
    real(dp), intent(in) :: reach(2)
    type(piecewise_t), intent(inout) :: curve
    real(dp), allocatable :: breaks(:)
    integer :: i

    if (reach(1) < 0) then
      breaks = with_relief(0.0_dp, reach(1), 1)
      do i = 1, size(breaks) - 1
        curve = joined(piece(breaks(i + 1), breaks(i), 2), curve)
      end do
    end if
    if (reach(2) > pair%contact_ratio) then
      breaks = with_relief(pair%contact_ratio, reach(2), 2)
      do i = 1, size(breaks) - 1
        curve = joined(curve, piece(breaks(i), breaks(i + 1), 1))
      end do
    end if

  contains

    !> Places from the path's end to the reach, including that at which the corner meets the start of the mate's relief.
    pure function with_relief(from, until, mate) result(breaks)
      real(dp), intent(in) :: from, until
      integer, intent(in) :: mate
      real(dp), allocatable :: breaks(:)
      type(corner_t) :: corner
      type(bracket_t) :: place

      breaks = [from, until]
      if (.not. relief%amount(mate) > 0) return
      place = bracket_t(from, until)
      do while (place%is_open())
        corner = corner_contact(pair, place%middle())
        call place%halve(merge(corner%s < relief%start(mate), corner%s > relief%start(mate), mate == 1))
      end do
      if (abs(place%low - from) > 1e-9_dp .and. abs(until - place%low) > 1e-9_dp) breaks = [from, place%low, until]
    end function with_relief

    !> Smooth piece of the curve, through points that are denser towards its ends.
    pure type(piecewise_t) function piece(first, last, tooth)
      real(dp), intent(in) :: first, last
      integer, intent(in) :: tooth
      type(corner_t) :: corner(0:degree)

      corner = corner_contact(pair, knots(first, last))
      piece = interpolated(first, last, (corner%gap + relief%amount(tooth) &
                                         + tip_relief(relief, pair%contact_ratio, 3 - tooth, corner%s))/corner%part_along)
    end function piece
  end subroutine add_corners

  !> Places of the values for `interpolated`.
  pure function knots(first, last) result(s)
    real(dp), intent(in) :: first, last
    real(dp) :: s(0:degree)
    integer :: i

    s = [((first + last)/2 - (last - first)/2*cos(i*acos(-1.0_dp)/degree), i=0, degree)]
  end function knots
end module gearsweep_gear_tip_corner
