!> The tip corner before and behind the path of contact: its gap against brute force on points of the flanks, and the
!> profile error that it makes beyond the path, with reliefs.
module test_tip_corner
  use gearsweep_gear_tip_corner, only: add_corner_stiffness, add_corners, arm_change, corner_contact, corner_reach, corner_t, &
            touching_curvature
  use gearsweep_base_error, only: error_t
  use gearsweep_gear_gear, only: drive, gear_spec_t, gear_t, make_gear
  use gearsweep_base_kinds, only: dp, pi
  use gearsweep_mesh_mesh, only: mesh_t
  use gearsweep_gear_profile, only: involute_point
  use gearsweep_gear_pair, only: make_pair, pair_t
  use gearsweep_base_piecewise, only: interpolated, joined, piecewise_t, polynomial
  use gearsweep_gear_relief, only: parabolic, profile_error, relief_t
  use gearsweep_base_text, only: str
  use test_support_testing, only: tally_t, check_close, check_no_error, check_true
  implicit none
  private
  public :: run

  real(dp), parameter :: micro = 1e-6_dp

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t

    if (t%wants('stated_gaps')) call stated_gaps(t)
    if (t%wants('brute_force')) call brute_force(t)
    if (t%wants('friction_arms')) call friction_arms(t)
    if (t%wants('both_ends')) call both_ends(t)
    if (t%wants('reach')) call reach_of_corner(t)
    if (t%wants('profile_errors')) call profile_errors(t)
    if (t%wants('closes')) call closes(t)
    if (t%wants('end_stiffness')) call end_stiffness(t)
    if (t%wants('interpolation')) call interpolation(t)
  end subroutine run

  !> Pairs of different kinds: the first is that of Dogan et al. 2021, case 1.
  type(pair_t) function example(kind, t) result(pair)
    integer, intent(in) :: kind
    type(tally_t), intent(inout) :: t
    type(gear_spec_t) :: spec(2)
    type(gear_t) :: gear(2)
    type(error_t), allocatable :: error
    real(dp) :: distance
    integer :: i

    spec = gear_spec_t('pinion', 25, 0.00318_dp, face_width=0.0254_dp)
    distance = 0.0795_dp
    select case (kind)
    case (2)  ! shifted gears of a high ratio at an own centre distance
      spec%teeth = [17, 61]
      spec%profile_shift = [0.4_dp, 0.1_dp]
      distance = 0.1262_dp
    case (3)  ! unequal flanks
      spec%teeth = [30, 43]
      spec(1)%pressure_angle = [27, 20]*pi/180
      spec(2)%pressure_angle = [27, 20]*pi/180
      spec(1)%rack_tip_radius = 0.1_dp
      spec(2)%rack_tip_radius = 0.1_dp
      distance = 0.00318_dp*36.5_dp
    case (4)  ! slender teeth: two and three pairs in contact
      spec%teeth = [50, 60]
      spec%addendum = 1.35_dp
      spec%dedendum = 1.6_dp
      spec(1)%rack_tip_radius = 0.1_dp
      spec(2)%rack_tip_radius = 0.1_dp
      distance = 0.00318_dp*55
    case default  ! equal gears
    end select
    do i = 1, 2
      call make_gear(spec(i), gear(i), error)
      call check_no_error(t, 'gear of pair '//str(kind), error)
    end do
    call make_pair(gear(1), gear(2), distance, pair, error)
    call check_no_error(t, 'pair '//str(kind), error)
  end function example

  !> Of case 1, worked out apart from the library when this contact was examined first.
  subroutine stated_gaps(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: before(4) = [0.02_dp, 0.05_dp, 0.1_dp, 0.2_dp], gap(4) = [1.2097_dp, 7.6050_dp, 30.741_dp, 125.66_dp]
    type(corner_t) :: corner
    integer :: i

    do i = 1, size(gap)
      corner = corner_contact(example(1, t), -before(i))
      call check_close(t, 'gap '//str(before(i))//' base pitches before A', corner%gap/micro, gap(i), relative=5e-5_dp)
    end do
  end subroutine stated_gaps

  !> Both gears are put on their centres with their flanks touching in the pitch point and rolled to s. The mate's flank is
  !> a dense row of points about its centre; how far it must turn until it meets the corner is the gap.
  subroutine brute_force(t)
    type(tally_t), intent(inout) :: t
    type(pair_t) :: pair
    type(corner_t) :: corner
    real(dp) :: s, off
    integer :: kind, i, side

    do kind = 1, 4
      pair = example(kind, t)
      do side = 1, 2
        do i = 1, 6
          off = 0.04_dp*i
          s = merge(-off, pair%contact_ratio + off, side == 1)
          corner = corner_contact(pair, s)
          call check_close(t, 'gap of pair '//str(kind)//merge(' before A', ' behind E', side == 1), corner%gap, &
                           rolled_gap(pair, s, 3 - side), absolute=1e-11_dp)
          call check_close(t, 'where the mate touches', touching_curvature(pair, side, s), corner%curvature)
          call check_close(t, 'where the corner is', hypot(touching_curvature(pair, 3 - side, s), &
            pair%gear(3 - side)%base_radius(drive)), pair%gear(3 - side)%tip_radius)
          call check_true(t, 'the corner meets the mate above the end of the path', &
                          merge(corner%s > 0, corner%s < pair%contact_ratio, side == 1))
        end do
      end do
    end do
  end subroutine brute_force

  !> Friction acts along the mate's flank where the corner touches it. Its lever arms are the distances of both centres from that
  !> tangent, which brute force has from points of the flank beside. In the motion they are straight lines from A and E on, exact
  !> half way to the reach.
  subroutine friction_arms(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: h = 1e-6_dp, reach = 0.15_dp
    type(pair_t) :: pair
    type(corner_t) :: corner
    type(mesh_t) :: mesh
    real(dp) :: s, points(5), tip(2), place(2), tangent(2), radius, exact(2), angle, line
    integer :: kind, i, side, which

    do kind = 1, 4
      pair = example(kind, t)
      points = pair%points()
      mesh%teeth = pair%gear%spec%teeth
      mesh%contact_ratio = pair%contact_ratio
      mesh%pitch_point = points(3)
      mesh%tan_angle = tan(pair%working_angle(drive))
      do side = 1, 2
        do i = 1, 3
          s = merge(-i*reach/2, pair%contact_ratio + i*reach/2, side == 1)
          corner = corner_contact(pair, s)
          associate (mate => pair%gear(side), gear => pair%gear(3 - side))
            tip = turned(involute_point(gear, drive, gear%tip_radius), turn_of(pair, s, 3 - side))
            place = [0.0_dp, pair%centre_distance] - tip
            radius = norm2(place)
            tangent = involute_point(mate, drive, radius + h) - involute_point(mate, drive, radius - h)
            tangent = tangent/norm2(tangent)
            exact(side) = abs(cross(involute_point(mate, drive, radius), tangent))
            associate (flank => involute_point(mate, drive, radius))
              angle = atan2(place(1), place(2)) - atan2(flank(1), flank(2))
            end associate
            exact(3 - side) = abs(cross(tip, turned(tangent, angle)))
          end associate
          call check_close(t, 'friction arm at the mate', corner%curvature, exact(side), relative=1e-6_dp)
          call check_close(t, 'friction arm at the corner', corner%friction_arm, exact(3 - side), relative=1e-6_dp)
          if (i > 1) cycle
          do which = 1, 2
            line = merge(2*pi, -2*pi, which == 1)/pair%gear(which)%spec%teeth
            mesh%arm_change(which, side) = arm_change(pair, which, side, s) - line
            associate (ratio => mesh%curvature_ratio(which, s), rb => pair%gear(which)%base_radius(drive))
              call check_close(t, 'friction arm in the motion', ratio*rb, exact(which), relative=1e-6_dp)
            end associate
          end do
        end do
        ! On the whole reach the straight lines stay near.
        do which = 1, 2
          associate (ratio => mesh%curvature_ratio(which, merge(-reach, pair%contact_ratio + reach, side == 1)))
            s = merge(-reach, pair%contact_ratio + reach, side == 1)
            corner = corner_contact(pair, s)
            call check_close(t, 'straight line', ratio*pair%gear(which)%base_radius(drive), &
                             merge(corner%curvature, corner%friction_arm, which == side), relative=2e-2_dp)
          end associate
        end do
      end do
    end do
  end subroutine friction_arms

  pure real(dp) function cross(a, b)
    real(dp), intent(in) :: a(2), b(2)

    cross = a(1)*b(2) - a(2)*b(1)
  end function cross

  !> How far a gear is turned (rad) at s: positive angles lead from the line of centres to where the pinion pushes, and for the
  !> gear against it.
  pure real(dp) function turn_of(pair, s, which) result(turn)
    type(pair_t), intent(in) :: pair
    real(dp), intent(in) :: s
    integer, intent(in) :: which
    real(dp) :: points(5)

    points = pair%points()
    associate (gear => pair%gear(which))
      turn = -gear%half_angle(drive, pair%centre_distance*gear%spec%teeth/sum(pair%gear%spec%teeth)) &
             + merge(1, -1, which == 1)*(s - points(3))*pair%base_pitch/gear%base_radius(drive)
    end associate
  end function turn_of

  !> `tooth` is the gear whose corner it is. Each gear may be turned by half of a deflection x along the line of action.
  real(dp) function rolled_gap(pair, s, tooth, x) result(gap)
    type(pair_t), intent(in) :: pair
    real(dp), intent(in) :: s
    integer, intent(in) :: tooth
    real(dp), intent(in), optional :: x
    integer, parameter :: points = 40000
    real(dp) :: turn(2), corner(2), place(2), low, high, place_low(2), place_high(2), part
    integer :: i, mate

    mate = 3 - tooth
    turn = [(turn_of(pair, s, i), i=1, 2)]
    if (present(x)) turn = turn + x/2/[(pair%gear(i)%base_radius(drive), i=1, 2)]
    ! The corner from the mate's centre; from either centre y points to the other one.
    corner = turned(involute_point(pair%gear(tooth), drive, pair%gear(tooth)%tip_radius), turn(tooth))
    place = [0.0_dp, pair%centre_distance] - corner
    gap = huge(gap)
    high = 0
    place_high = 0
    do i = 0, points
      associate (gear => pair%gear(mate))
        low = high
        place_low = place_high
        high = gear%form_radius(drive) + (gear%tip_radius - gear%form_radius(drive))*i/points
        place_high = involute_point(gear, drive, high)
        if (norm2(place) > high .or. i == 0) cycle
        part = (norm2(place) - low)/(high - low)
        associate (flank => place_low + part*(place_high - place_low))
          gap = gear%base_radius(drive)*(atan2(place(1), place(2)) - atan2(flank(1), flank(2)) - turn(mate))
        end associate
        exit
      end associate
    end do
  end function rolled_gap

  !> A point turned towards positive x by an angle (rad).
  pure function turned(point, angle) result(moved)
    real(dp), intent(in) :: point(2), angle
    real(dp) :: moved(2)

    moved = [point(1)*cos(angle) + point(2)*sin(angle), point(2)*cos(angle) - point(1)*sin(angle)]
  end function turned

  !> At the ends of the path there is no gap, and it begins as a parabola: nothing is tilted there. Equal gears have equal
  !> gaps at both ends. The load's lever arm is how the gap falls as the corner's gear turns alone.
  subroutine both_ends(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: small = 1e-4_dp, h = 1e-5_dp
    type(pair_t) :: pair
    type(corner_t) :: start, finish, here
    integer :: kind

    do kind = 1, 4
      pair = example(kind, t)
      start = corner_contact(pair, 0.0_dp)
      finish = corner_contact(pair, pair%contact_ratio)
      call check_close(t, 'no gap at A and E', max(abs(start%gap), abs(finish%gap)), 0.0_dp, absolute=1e-16_dp)
      call check_close(t, 'no tilt at A and E', max(abs(start%tilt), abs(finish%tilt)), 0.0_dp, absolute=1e-13_dp)
      call check_close(t, 'lever arm at A', start%lever, 1.0_dp)
      start = corner_contact(pair, -small)
      finish = corner_contact(pair, -2*small)
      call check_close(t, 'begins as a parabola', finish%gap/start%gap, 4.0_dp, relative=2e-3_dp)
    end do
    pair = example(1, t)
    start = corner_contact(pair, -0.13_dp)
    finish = corner_contact(pair, pair%contact_ratio + 0.13_dp)
    call check_close(t, 'equal gears: gap', start%gap, finish%gap, relative=1e-9_dp)
    call check_close(t, 'equal gears: place', start%s, pair%contact_ratio - finish%s, relative=1e-9_dp)
    call check_close(t, 'equal gears: lever arm', start%lever, finish%lever, relative=1e-9_dp)
    here = corner_contact(pair, -0.073_dp)
    call check_close(t, 'lever arm where contact begins', here%lever, 0.952_dp, absolute=5e-4_dp)
    ! On the path both gears turn by s base pitches. The mate alone closes the gap by that; so the corner's gear alone by
    ! its lever arm in place of its base radius, and both together by the difference.
    here = corner_contact(pair, -0.13_dp)
    start = corner_contact(pair, -0.13_dp - h)
    finish = corner_contact(pair, -0.13_dp + h)
    call check_close(t, 'lever arm', 1 - here%lever, (start%gap - finish%gap)/(2*h*pair%base_pitch), relative=1e-6_dp)
  end subroutine both_ends

  !> The reach is where the gap has the depth that is asked for, and never a whole base pitch.
  subroutine reach_of_corner(t)
    type(tally_t), intent(inout) :: t
    type(pair_t) :: pair
    type(corner_t) :: corner(2)
    real(dp) :: reach(2)
    integer :: kind

    do kind = 1, 4
      pair = example(kind, t)
      reach = corner_reach(pair, 50*micro)
      corner = corner_contact(pair, reach)
      call check_close(t, 'gap before A at the reach', corner(1)%gap, 50*micro, relative=1e-9_dp)
      call check_close(t, 'gap behind E at the reach', corner(2)%gap, 50*micro, relative=1e-9_dp)
      reach = corner_reach(pair, 1.0_dp)
      call check_true(t, 'less than a base pitch', reach(1) > -1 .and. reach(1) < -0.1_dp .and. &
                      reach(2) < pair%contact_ratio + 1 .and. reach(2) > pair%contact_ratio + 0.1_dp)
    end do
  end subroutine reach_of_corner

  !> Beyond the path the profile error is the gap, the whole relief of the corner, and what the mate lacks where they meet: by
  !> roll angle, linear or as a parabola, all along the line of action. It is continuous at A and E, and inside as it was.
  subroutine profile_errors(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: amount(2) = [12*micro, 7*micro]
    type(pair_t) :: pair
    type(piecewise_t) :: inside, whole
    type(corner_t) :: corner
    type(error_t), allocatable :: error
    real(dp) :: reach(2), s, mate, start(2)
    integer :: kind, shape, i, long

    do kind = 1, 4
      pair = example(kind, t)
      reach = corner_reach(pair, 90*micro)
      do shape = 1, 2
        do long = 1, 2
          ! Short, or so long that the mates are relieved where the corners meet them.
          start = merge([0.75_dp, 0.25_dp], [0.1_dp, 0.9_dp], long == 1)*pair%contact_ratio
          associate (relief => relief_t(amount, start, shape))
            call profile_error(relief, pair%contact_ratio, inside, error)
            whole = inside
            call add_corners(pair, relief, reach, whole)
          end associate
          call check_close(t, 'begins at the reach', whole%breaks(1), reach(1))
          call check_close(t, 'ends at the reach', whole%breaks(size(whole%breaks)), reach(2))
          do i = 0, 40
            s = reach(1)*(i/40.0_dp)
            corner = corner_contact(pair, s)
            mate = max(0.0_dp, (corner%s - start(1))/(pair%contact_ratio - start(1)))
            call check_close(t, 'before A', whole%value(s), (corner%gap + amount(2) &
                             + amount(1)*merge(mate**2, mate, shape == parabolic))*2/(1 + corner%lever), absolute=1e-12_dp)
            s = pair%contact_ratio + (reach(2) - pair%contact_ratio)*(i/40.0_dp)
            corner = corner_contact(pair, s)
            mate = max(0.0_dp, (start(2) - corner%s)/start(2))
            call check_close(t, 'behind E', whole%value(s), (corner%gap + amount(1) &
                             + amount(2)*merge(mate**2, mate, shape == parabolic))*2/(1 + corner%lever), absolute=1e-12_dp)
            s = pair%contact_ratio*(i + 0.5_dp)/41
            call check_close(t, 'within the path', whole%value(s), inside%value(s), absolute=1e-20_dp)
          end do
          call check_close(t, 'continuous at A', whole%value(-1e-12_dp), inside%value(1e-12_dp), absolute=1e-15_dp)
          call check_close(t, 'continuous at E', whole%value(pair%contact_ratio + 1e-12_dp), &
                           inside%value(pair%contact_ratio - 1e-12_dp), absolute=1e-15_dp)
        end do
      end do
    end do
  end subroutine profile_errors

  !> Half of the profile error as a turn of either gear closes the gap, but for what the lever arm changes on the way.
  subroutine closes(t)
    type(tally_t), intent(inout) :: t
    type(pair_t) :: pair
    type(piecewise_t) :: whole
    type(error_t), allocatable :: error
    real(dp) :: reach(2), s, gap
    integer :: kind, side, i

    do kind = 1, 4
      pair = example(kind, t)
      reach = corner_reach(pair, 40*micro)
      associate (relief => relief_t([0.0_dp, 0.0_dp], [0.75_dp, 0.25_dp]*pair%contact_ratio, parabolic))
        call profile_error(relief, pair%contact_ratio, whole, error)
        call add_corners(pair, relief, reach, whole)
      end associate
      do side = 1, 2
        do i = 1, 3
          s = merge(reach(1)*i/3, pair%contact_ratio + (reach(2) - pair%contact_ratio)*i/3, side == 1)
          gap = rolled_gap(pair, s, 3 - side)
          call check_close(t, 'closed, pair '//str(kind)//' at '//str(s), rolled_gap(pair, s, 3 - side, whole%value(s)), 0.0_dp, &
                           absolute=3e-3_dp*gap)
        end do
      end do
    end do
  end subroutine closes

  !> Teeth that deflect along the mate's normal as at the path's end: their stiffness there, times the square of how much of a
  !> deflection closes the gap, which brute force has from both gears turned. Up to where the gap is four static deflections of the
  !> softest place, and inside as it was. Under a load that next to nothing deflects the curve ends at A and E.
  subroutine end_stiffness(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: x = 1e-4_dp, load = 7000
    type(pair_t) :: pair
    type(piecewise_t) :: inside, whole
    type(corner_t) :: ends(2)
    real(dp) :: s, part
    integer :: kind, side, i

    do kind = 1, 4
      pair = example(kind, t)
      inside = polynomial(0.0_dp, pair%contact_ratio, 1e6_dp*[400.0_dp, 30.0_dp, -110.0_dp])
      whole = inside
      call add_corner_stiffness(pair, load, whole)
      ends = corner_contact(pair, whole%breaks([1, size(whole%breaks)]))
      call check_close(t, 'four deflections before A', ends(1)%gap, 4*load/260e6_dp, relative=1e-9_dp)
      call check_close(t, 'four deflections behind E', ends(2)%gap, 4*load/260e6_dp, relative=1e-9_dp)
      call check_close(t, 'inside as it was', whole%value(0.4_dp), inside%value(0.4_dp))
      do side = 1, 2
        do i = 0, 3
          s = whole%breaks(1)*i/3
          if (side == 2) s = pair%contact_ratio + (whole%breaks(size(whole%breaks)) - pair%contact_ratio)*i/3
          part = 1
          if (i > 0) part = (rolled_gap(pair, s, 3 - side, -x) - rolled_gap(pair, s, 3 - side, x))/(2*x)
          call check_close(t, 'stiffness of pair '//str(kind)//' at '//str(s), whole%value(s), &
                           part**2*merge(260e6_dp, 320e6_dp, side == 1), relative=1e-4_dp)
        end do
      end do
      whole = inside
      call add_corner_stiffness(pair, 1e-6_dp, whole)
      call check_close(t, 'no reach', whole%breaks(size(whole%breaks)) - whole%breaks(1), pair%contact_ratio)
    end do
  end subroutine end_stiffness

  !> A polynomial comes back from its values, exactly.
  subroutine interpolation(t)
    type(tally_t), intent(inout) :: t
    type(piecewise_t) :: p, two
    real(dp) :: x(0:5)
    integer :: k

    x = [(2.5_dp - 1.5_dp*cos(pi*k/5), k=0, 5)]
    p = interpolated(1.0_dp, 4.0_dp, 3 - x + 0.5_dp*x**3 - 0.01_dp*x**5)
    call check_close(t, 'polynomial of degree 5', p%value(3.3_dp), 3 - 3.3_dp + 0.5_dp*3.3_dp**3 - 0.01_dp*3.3_dp**5)
    two = joined(p, interpolated(4.0_dp, 5.0_dp, [7.0_dp, 9.0_dp]))
    call check_close(t, 'left of the joint', two%value(3.3_dp), p%value(3.3_dp))
    call check_close(t, 'right of the joint', two%value(4.5_dp), 8.0_dp)
  end subroutine interpolation
end module test_tip_corner
