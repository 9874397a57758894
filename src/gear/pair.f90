!> Two gears in mesh: centre distance, working pressure angle and path of contact, all in the transverse section.
!>
!> The path coordinate s runs from the start of contact A (0) to its end E
!> (the contact ratio), in base pitches. Gear 1 is the pinion, which drives.
module gearsweep_gear_pair
  use gearsweep_base, only: bracket_t, code_input, dp, error_t, fail, pi, str
  use gearsweep_gear_gear, only: coast, drive, gear_t, involute, make_virtual_gear, tip_quantity
  use gearsweep_gear_rack, only: fillet_undercut, generating_shift, least_shift, teeth_around
  implicit none
  private
  public :: pair_t, make_pair, free_centre_distance, tip_alteration, normal_section

  character(*), parameter :: names(2) = ['pinion', 'gear  ']
  !> Largest interference, in modules on the centre distance, that counts as no backlash: profile shifts have four digits, and
  !> half a unit of the last digit of both makes that much.
  real(dp), parameter :: noticeable = 1e-4_dp
  !> Backlash below which it is rounding of the arithmetic, in modules.
  real(dp), parameter :: nothing = 1e-12_dp

  type :: pair_t
    type(gear_t) :: gear(2)
    real(dp) :: centre_distance = 0              !< a, m
    real(dp) :: working_angle(2) = 0             !< alpha_wt of the drive and the coast flanks, rad
    real(dp) :: base_pitch = 0                   !< p_bt, base pitch of the drive flanks, m
    real(dp) :: contact_ratio = 0                !< epsilon_alpha
    real(dp) :: overlap_ratio = 0                !< epsilon_beta = b sin(beta)/(pi m_n)
    real(dp) :: start_curvature = 0              !< radius of curvature of the pinion flank at A, m
    real(dp) :: coast_contact_ratio = 0          !< contact ratio of the coast flanks, where they carry
    real(dp) :: backlash = 0                     !< along the drive line of action, m
    !> Centre distance without backlash minus the centre distance, m: so little that it is rounding of the inputs.
    real(dp) :: rounding = 0
    logical :: may_shorten = .false.             !< true: the path may end where undercut ends an involute
    real(dp) :: lost(2) = 0                      !< reduction of the path of contact by undercut of each gear, m
  contains
    procedure :: lag
    procedure :: curvature
    procedure :: radius
    procedure :: sliding_speed
    procedure :: points
  end type pair_t

contains

  !> Pairs two gears at `centre_distance` (m), or refuses them. If undercut of one gear removes flank that the other's tip would
  !> contact, `shorten` lets the path of contact end there; by default, that is refused.
  !> Source: ISO 21771:2007, sections 5 and 6.
  pure subroutine make_pair(pinion, gear, centre_distance, pair, error, shorten)
    type(gear_t), intent(in) :: pinion, gear
    real(dp), intent(in) :: centre_distance
    type(pair_t), intent(out) :: pair
    type(error_t), allocatable, intent(out) :: error
    logical, intent(in), optional :: shorten
    real(dp) :: least, shifts
    real(dp), parameter :: same = 1e-12_dp
    integer :: i

    if (abs(pinion%spec%module - gear%spec%module) > same*pinion%spec%module) then
      call fail(error, code_input, 'module: pinion and gear must have the same module')
    end if
    if (any(abs(pinion%spec%pressure_angle - gear%spec%pressure_angle) > same)) then
      call fail(error, code_input, 'pressure angle: pinion and gear must have the same angles')
    end if
    if (abs(pinion%spec%helix_angle + gear%spec%helix_angle) > same) then
      call fail(error, code_input, 'helix angle: one gear must be right-handed and the other left-handed by the same angle')
    end if
    if (allocated(error)) return
    pair%gear = [pinion, gear]
    pair%centre_distance = centre_distance
    shifts = sum(generating_shift(pair%gear%spec))
    least = closest(pinion, gear, shifts)
    pair%backlash = -gap(pair%gear, shifts, centre_distance)*cos(working_angle(pair%gear, drive, centre_distance))
    if (abs(pair%backlash) < nothing*pinion%spec%module) pair%backlash = 0
    if (.not. centre_distance >= least*(1 - 1e-9_dp)) then
      pair%rounding = least - centre_distance
      pair%backlash = 0
    end if
    if (.not. pair%rounding <= noticeable*pinion%spec%module) then
      call fail(error, code_input, 'centre distance (mm) = '//str(1000*centre_distance, 9)// &
        ': the teeth jam; must be at least '//str(1000*least, 9))
      return
    end if
    pair%working_angle = [working_angle(pair%gear, drive, centre_distance), &
                          working_angle(pair%gear, coast, centre_distance)]
    pair%base_pitch = 2*pi*pinion%base_radius(drive)/pinion%spec%teeth
    pair%overlap_ratio = minval(pair%gear%spec%face_width)*sin(abs(pinion%spec%helix_angle))/(pi*pinion%spec%module)
    call find_path(pair, error)
    if (present(shorten)) then
      pair%may_shorten = shorten
      if (shorten) then
        do i = 1, 2
          if (pair%gear(i)%is_undercut(drive)) pair%lost(i) = max(0.0_dp, lacking(pair, i, drive))
        end do
        pair%start_curvature = pair%start_curvature + pair%lost(1)
        pair%contact_ratio = pair%contact_ratio - sum(pair%lost)/pair%base_pitch
      end if
    end if
    call check_path(pair, error)
  end subroutine make_pair

  !> Working pressure angle of a side at a centre distance.
  pure real(dp) function working_angle(gears, side, centre_distance)
    type(gear_t), intent(in) :: gears(2)
    integer, intent(in) :: side
    real(dp), intent(in) :: centre_distance

    working_angle = acos(min(1.0_dp, sum(gears%base_radius(side))/centre_distance))
  end function working_angle

  !> Sum of tooth thicknesses minus pitch, on the working pitch circles (m), with profile shift coefficients that add up to
  !> `shifts`: positive if teeth interfere.
  pure real(dp) function gap(gears, shifts, centre_distance)
    type(gear_t), intent(in) :: gears(2)
    real(dp), intent(in) :: shifts, centre_distance
    real(dp) :: angle
    integer :: side

    associate (z => gears%spec%teeth)
      gap = 0
      do side = drive, coast
        angle = gears(1)%spec%pressure_angle(side)
        gap = gap + 2*shifts*tan(angle) &
              + sum(z)*(involute(gears(1)%transverse_angle(side)) - involute(working_angle(gears, side, centre_distance)))
      end do
      gap = gap*centre_distance/sum(z)
    end associate
  end function gap

  !> Centre distance (m) without backlash of teeth without thickness allowance.
  pure real(dp) function free_centre_distance(pinion, gear) result(distance)
    type(gear_t), intent(in) :: pinion, gear

    distance = closest(pinion, gear, pinion%spec%profile_shift + gear%spec%profile_shift)
  end function free_centre_distance

  !> Centre distance (m) without backlash of teeth whose profile shift coefficients add up to `shifts`, by bisection: `gap` falls
  !> with the distance.
  pure real(dp) function closest(pinion, gear, shifts) result(distance)
    type(gear_t), intent(in) :: pinion, gear
    real(dp), intent(in) :: shifts
    type(bracket_t) :: between

    distance = pinion%reference_radius + gear%reference_radius
    if (abs(shifts) <= 0) return
    between = bracket_t(maxval(pinion%base_radius + gear%base_radius), 3*maxval(pinion%base_radius + gear%base_radius))
    do while (between%is_open())
      call between%halve(gap([pinion, gear], shifts, between%middle()) > 0)
    end do
    distance = between%middle()
  end function closest

  !> Tip alteration factor k that keeps the rack's bottom clearance at this
  !> centre distance (ISO 21771:2007, Eq. 25): k = (a - a_d)/m - (x1 + x2), never above 0.
  pure real(dp) function tip_alteration(pinion, gear, centre_distance) result(k)
    type(gear_t), intent(in) :: pinion, gear
    real(dp), intent(in) :: centre_distance

    k = min(0.0_dp, (centre_distance - pinion%reference_radius - gear%reference_radius)/pinion%spec%module &
            - pinion%spec%profile_shift - gear%spec%profile_shift)
  end function tip_alteration

  !> Finds the path of contact between the tip circles, and checks it.
  pure subroutine find_path(pair, error)
    type(pair_t), intent(inout) :: pair
    type(error_t), allocatable, intent(inout) :: error
    real(dp) :: clearance
    integer :: i

    associate (first => mate_reach(pair, 1, drive), last => mate_reach(pair, 2, drive))
      pair%start_curvature = first
      pair%contact_ratio = (tangent(pair, drive) - first - last)/pair%base_pitch
    end associate
    ! Undercut of a coast flank shortens the path there and is not refused, as it does not carry the load.
    associate (first => mate_reach(pair, 1, coast) + max(0.0_dp, lacking(pair, 1, coast)), &
               last => mate_reach(pair, 2, coast) + max(0.0_dp, lacking(pair, 2, coast)))
      pair%coast_contact_ratio = (tangent(pair, coast) - first - last)/ &
                                 (2*pi*pair%gear(1)%base_radius(coast)/pair%gear(1)%spec%teeth)
    end associate
    do i = 1, 2
      clearance = pair%centre_distance - pair%gear(3 - i)%tip_radius - pair%gear(i)%root_radius
      if (clearance <= 0) call fail(error, code_input, trim(names(3 - i))//' '//trim(tip_quantity(pair%gear(3 - i)))// &
        ': interference; its tip cuts '//str(-1000*clearance)//' mm into the root of the '//trim(names(i))// &
        '; the tip diameter must stay below '//str(2000*(pair%centre_distance - pair%gear(i)%root_radius))//' mm')
    end do
  end subroutine find_path

  !> Length (m) of a side's line of action between the base circles.
  pure real(dp) function tangent(pair, side)
    type(pair_t), intent(in) :: pair
    integer, intent(in) :: side

    tangent = pair%centre_distance*sin(pair%working_angle(side))
  end function tangent

  !> Radius of curvature (m) of a side's flank of gear `i` at the innermost contact with the mate's tip.
  pure real(dp) function mate_reach(pair, i, side)
    type(pair_t), intent(in) :: pair
    integer, intent(in) :: i, side

    associate (mate => pair%gear(3 - i))
      mate_reach = tangent(pair, side) - mate%curvature(side, mate%flank_end(side))
    end associate
  end function mate_reach

  !> Length of the path of contact between the tips beyond the root end of the involute of a side of gear `i` (m); below 0 if it
  !> fits.
  pure real(dp) function lacking(pair, i, side)
    type(pair_t), intent(in) :: pair
    integer, intent(in) :: i, side

    lacking = pair%gear(i)%curvature(side, pair%gear(i)%form_radius(side)) - mate_reach(pair, i, side)
  end function lacking

  !> Checks that each point of the path has two involutes, and that the next pair enters before this one leaves.
  pure subroutine check_path(pair, error)
    type(pair_t), intent(in) :: pair
    type(error_t), allocatable, intent(inout) :: error
    real(dp) :: reach, farthest
    integer :: i, side

    do side = drive, coast
      do i = 1, 2
        call check_flank(pair, i, side, error)
      end do
    end do
    if (pair%contact_ratio > 1) return
    ! Reach at which the path between the tips is one base pitch.
    reach = sum([(pair%gear(i)%curvature(drive, pair%gear(i)%flank_end(drive)), i=1, 2)]) - pair%base_pitch
    farthest = hypot(reach, pair%gear(1)%base_radius(drive) + pair%gear(2)%base_radius(drive))
    if (reach > 0 .and. pair%centre_distance > farthest .and. farthest > closest(pair%gear(1), pair%gear(2), &
                                                                               sum(generating_shift(pair%gear%spec)))) then
      call fail(error, code_input, 'centre distance (mm) = '//str(1000*pair%centre_distance, 9)//': contact ratio '// &
        str(pair%contact_ratio)//' is not above 1: contact would be interrupted; it must be below '//str(1000*farthest))
    else
      call fail(error, code_input, &
        'path of contact: contact ratio '//str(pair%contact_ratio)//' is not above 1: contact would be interrupted')
    end if
  end subroutine check_path

  !> Checks that the mate's tip does not reach below the involute of gear `i` on this side. Undercut makes room for the tip; on
  !> the coast side, which does not carry, that is enough.
  pure subroutine check_flank(pair, i, side, error)
    type(pair_t), intent(in) :: pair
    integer, intent(in) :: i, side
    type(error_t), allocatable, intent(inout) :: error
    real(dp) :: deepest
    logical :: has_room
    integer :: k

    k = 3 - i
    has_room = pair%gear(i)%is_undercut(side)
    if (side == coast .and. (has_room .or. fillet_undercut(pair%gear(i)%spec) > 0)) return
    if (lacking(pair, i, side) - merge(pair%lost(i), 0.0_dp, side == drive) <= 1e-9_dp*pair%centre_distance) return
    ! Tip diameter of the mate (mm) that just reaches the end of the involute.
    deepest = 2000*hypot(pair%gear(k)%base_radius(side), tangent(pair, side) &
                         - pair%gear(i)%curvature(side, pair%gear(i)%form_radius(side)))
    if (has_room) then
      call fail(error, code_input, trim(names(i))//' profile shift = '//str(pair%gear(i)%spec%profile_shift)// &
        ': undercut with '//str(pair%gear(i)%spec%teeth)//' teeth takes working flank; to have none it must be at least '// &
        str(least_shift(pair%gear(i)%spec, side))//', or the tip diameter of the '//trim(names(k))//' at most '// &
        str(deepest)//' mm; shortened path = .true. ends the path of contact where the involute ends')
    else
      call fail(error, code_input, trim(names(k))//' '//trim(tip_quantity(pair%gear(k)))//': interference; its tip diameter '// &
        str(2000*pair%gear(k)%flank_end(side))//' mm reaches below the involute of the '//trim(names(i))// &
        trim(merge(' on the coast flanks', repeat(' ', 20), side == coast))//'; at most '//str(deepest)//' mm')
    end if
  end subroutine check_flank

  !> Finds the virtual gears of a helical pair and the curvatures of their flanks in contact: those of the normal section over the
  !> same path coordinate, rho/cos(beta_b). A spur pair is its own. The result is not a pair that can run: its base pitch and
  !> centre distance serve to compute curvatures only.
  subroutine normal_section(pair, is_whole, normal, error)
    type(pair_t), intent(in) :: pair
    logical, intent(in) :: is_whole              !< as of `make_virtual_gear`
    type(pair_t), intent(out) :: normal
    type(error_t), allocatable, intent(out) :: error
    real(dp) :: farther(2)
    integer :: i

    normal = pair
    if (.not. pair%overlap_ratio > 0) return
    do i = 1, 2
      call make_virtual_gear(pair%gear(i), is_whole, normal%gear(i), error)
      if (allocated(error)) return
    end do
    associate (slant => cos(pair%gear(1)%base_helix()), spec => normal%gear%spec, helix => pair%gear%spec%helix_angle)
      ! Distance by which rounding of the number of teeth moves the pitch point along the line of action.
      farther = (teeth_around(spec) - pair%gear%spec%teeth/(slant**2*cos(helix)))*spec%module/2*sin(spec%pressure_angle(drive))
      normal%base_pitch = pair%base_pitch/slant
      normal%start_curvature = pair%start_curvature/slant + farther(1)
      normal%centre_distance = pair%centre_distance/slant + sum(farther)/sin(pair%working_angle(drive))
    end associate
  end subroutine normal_section

  !> Fall of the path coordinate along a line of contact per length of the face, 1/m: tan(beta_b)/p_bt; 0 for spur gears. The line
  !> enters contact where z = 0.
  elemental real(dp) function lag(pair)
    class(pair_t), intent(in) :: pair

    lag = pair%overlap_ratio/minval(pair%gear%spec%face_width)
  end function lag

  !> Radius of curvature (m) of a gear's drive flank at path coordinate s.
  elemental real(dp) function curvature(pair, gear, s)
    class(pair_t), intent(in) :: pair
    integer, intent(in) :: gear
    real(dp), intent(in) :: s

    curvature = pair%start_curvature + s*pair%base_pitch
    if (gear == 2) curvature = pair%centre_distance*sin(pair%working_angle(drive)) - curvature
  end function curvature

  !> Radius (m) of a gear's contact at path coordinate s.
  elemental real(dp) function radius(pair, gear, s)
    class(pair_t), intent(in) :: pair
    integer, intent(in) :: gear
    real(dp), intent(in) :: s

    radius = hypot(pair%gear(gear)%base_radius(drive), pair%curvature(gear, s))
  end function radius

  !> Sliding speed (m/s) at s for a pinion speed (rad/s): zero at the pitch
  !> point, negative in approach.
  elemental real(dp) function sliding_speed(pair, s, speed)
    class(pair_t), intent(in) :: pair
    real(dp), intent(in) :: s, speed

    associate (z => pair%gear%spec%teeth)
      sliding_speed = speed*(1 + real(z(1), dp)/z(2))*(pair%curvature(1, s) &
                      - pair%gear(1)%base_radius(drive)*tan(pair%working_angle(drive)))
    end associate
  end function sliding_speed

  !> Path coordinates of A, B, P, D, E. Above a contact ratio of 2, B ends the first and D begins the last interval with the
  !> larger number of pairs in contact.
  pure function points(pair) result(s)
    class(pair_t), intent(in) :: pair
    real(dp) :: s(5)

    associate (ratio => pair%contact_ratio)
      s = [0.0_dp, ratio - aint(ratio), &
           (pair%gear(1)%base_radius(drive)*tan(pair%working_angle(drive)) - pair%start_curvature)/pair%base_pitch, &
           aint(ratio), ratio]
    end associate
  end function points
end module gearsweep_gear_pair
