!> Geometry against closed forms and brute force, for equal and unequal flanks, shifted and spread gears:
!> radii, the path of contact, backlash, the outline as the rack cuts it.
module test_geometry_closed_forms
  use gearsweep_study_case_case, only: case_t
  use gearsweep_api_case_reader, only: read_case
  use gearsweep_gear_profile, only: shown_outline, tooth_outline
  use gearsweep_base_error, only: error_t
  use gearsweep_gear_gear, only: gear_spec_t, gear_t, make_gear
  use gearsweep_base_kinds, only: dp, pi
  use gearsweep_gear_pair, only: pair_t
  use gearsweep_study_run_mesh_stage, only: build_pair
  use gearsweep_base_text, only: str
  use test_support_ask_by_name, only: ask_geometry
  use test_support_gears, only: stated_t, examples, text_of, involute, base_radius, tip_radius, working_angle, first_curvature, &
    & base_pitch, contact_ratio, half_tooth, degree, drive, coast
  use test_support_testing, only: tally_t, check_true, check_close, check_equal, check_error, check_no_error
  implicit none
  private
  public :: run

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t

    if (t%wants('radii')) call radii(t)
    if (t%wants('backlash_by_turning')) call backlash_by_turning(t)
    if (t%wants('stated_backlash')) call stated_backlash(t)
    if (t%wants('outline_as_cut')) call outline_as_cut(t)
    if (t%wants('protuberance_as_cut')) call protuberance_as_cut(t)
    if (t%wants('tips_and_outlines')) call tips_and_outlines(t)
  end subroutine run

  !> The geometry call, number by number. Backlash after ISO 21771: pitch less both thicknesses on the working circles,
  !> times cos(alpha_w).
  subroutine radii(t)
    type(tally_t), intent(inout) :: t
    type(stated_t) :: list(5)
    real(dp) :: radius(6, 2), point(5), at(5, 2), distance, angle(2), ratio, pitch, backlash, rho
    real(dp) :: working(2), thick
    integer :: i, k, n

    list = examples()
    do n = 1, size(list)
      associate (pair => list(n), name => 'pair '//str(n)//': ')
        call ask_geometry(t, '&case tasks=''geometry'' / '//text_of(pair), radius, point, at, distance, angle, ratio, &
                          pitch, backlash)
        do i = 1, 2
          associate (r => pair%module*pair%teeth(i)/2)
            call check_close(t, name//'tip radius', radius(1, i), r + pair%module*(pair%addendum(i) + pair%shift(i)))
            call check_close(t, name//'reference radius', radius(2, i), r)
            call check_close(t, name//'drive base radius', radius(3, i), r*cos(pair%angle(1)*degree))
            call check_close(t, name//'coast base radius', radius(4, i), r*cos(pair%angle(2)*degree))
            call check_close(t, name//'root radius', radius(5, i), r - pair%module*(pair%dedendum(i) - pair%shift(i)))
            call check_close(t, name//'start of the drive involute', radius(6, i), involute_start(pair, i), relative=1e-12_dp)
          end associate
        end do
        call check_close(t, name//'centre distance', distance, pair%distance)
        call check_close(t, name//'base pitch', pitch, base_pitch(pair))
        call check_close(t, name//'contact ratio', ratio, contact_ratio(pair))
        do k = 1, 2
          call check_close(t, name//'working angle', angle(k), working_angle(pair, k)/degree)
        end do
        working = pair%distance*pair%teeth/sum(pair%teeth)
        thick = 0
        do i = 1, 2
          thick = thick + working(i)*(half_tooth(pair, i, drive, working(i)) + half_tooth(pair, i, coast, working(i)))
        end do
        call check_close(t, name//'backlash on the line of action', backlash, 1e3_dp*cos(working_angle(pair, drive)) &
          *(2*pi*working(1)/pair%teeth(1) - thick), absolute=1e-8_dp)
        ! A, B, pitch point, D, E.
        call check_close(t, name//'A, B, D, E', maxval(abs(point([1, 2, 4, 5]) - [0.0_dp, ratio - 1, 1.0_dp, ratio])), 0.0_dp, &
                         absolute=1e-12_dp)
        do k = 1, 5
          rho = first_curvature(pair) + point(k)*pitch
          call check_close(t, name//'pinion radius on the path', at(k, 1), hypot(radius(3, 1), rho))
          rho = pair%distance*sin(working_angle(pair, drive)) - rho
          call check_close(t, name//'gear radius on the path', at(k, 2), hypot(radius(3, 2), rho))
        end do
        do i = 1, 2
          call check_close(t, name//'pitch point on the working circle', at(3, i), working(i))
        end do
      end associate
    end do
  end subroutine radii

  !> The rack's straight flank ends where its rounding begins, h_fP - rho_fP (1 - sin(alpha)) below its reference line;
  !> the point of the line of action at that depth cuts the start of the involute.
  pure real(dp) function involute_start(pair, i) result(radius)
    type(stated_t), intent(in) :: pair
    integer, intent(in) :: i
    real(dp) :: depth, beside

    associate (alpha => pair%angle(1)*degree)
      depth = pair%module*(pair%dedendum(i) - pair%rounding(i)*(1 - sin(alpha)) - pair%shift(i))
      beside = depth/tan(alpha)
      radius = hypot(pair%module*pair%teeth(i)/2 - depth, beside)
    end associate
  end function involute_start

  !> Backlash by brute force: the gear, a space of it on the line of centres, is turned until its flank meets the
  !> pinion's, one way and the other; its base circle rolls off the backlash meanwhile.
  subroutine backlash_by_turning(t)
    type(tally_t), intent(inout) :: t
    type(stated_t) :: list(5)
    real(dp) :: radius(6, 2), point(5), at(5, 2), distance, angle(2), ratio, pitch, backlash, rb(2)
    integer :: n

    list = examples()
    do n = 2, size(list)
      call ask_geometry(t, '&case tasks=''geometry'' / '//text_of(list(n)), radius, point, at, distance, angle, ratio, &
                        pitch, backlash)
      rb = base_radius(list(n), drive)
      call check_close(t, 'pair '//str(n)//': backlash by turning', backlash, &
                       1e3_dp*rb(2)*(free_turn(list(n), drive) + free_turn(list(n), coast)), absolute=2e-3_dp)
      call check_true(t, 'pair '//str(n)//' has backlash', backlash > 10)
    end do
  end subroutine backlash_by_turning

  !> The backlash that a case states is the pair's, whatever its tasks; where none is stated and none is left, it is 0 and no
  !> rounding of the arithmetic (5e-12 um here).
  subroutine stated_backlash(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: gears = 'module_mm = 2.5 face_width_mm = 25 / &pinion teeth = 17 profile_shift = 0.45 / '// &
      '&gear teeth = 43 profile_shift = 0.25 / &load torque_nm = 50 / &mesh model = ''weber'' / '
    real(dp) :: radius(6, 2), point(5), at(5, 2), distance, angle(2), ratio, pitch, backlash(3)

    call ask_geometry(t, '&case tasks=''mesh'' / &pair '//gears, radius, point, at, distance, angle, ratio, pitch, backlash(1))
    call ask_geometry(t, '&case tasks=''load'' / &sweep load_rpm = 3000 / &pair backlash_um = 80 '//gears, radius, point, at, &
                      distance, angle, ratio, pitch, backlash(2))
    call ask_geometry(t, '&case tasks=''mesh'' / &pair backlash_um = 80 '//gears, radius, point, at, distance, angle, ratio, &
                      pitch, backlash(3))
    call check_close(t, 'no rounding', backlash(1), 0.0_dp, absolute=tiny(1.0_dp))
    call check_close(t, 'as stated', backlash(2), 80.0_dp, relative=1e-12_dp)
    call check_close(t, 'as stated, without a motion', backlash(3), 80.0_dp, relative=1e-12_dp)
  end subroutine stated_backlash

  !> Angle (rad) by which the gear's space turns until its flank of one side touches the pinion's tooth, both
  !> sampled: the least distance, as an angle about the gear's centre, of the pinion's points from the gear's flank.
  !> The pinion's centre is at 0, the gear's on the line of centres; mirrored for the coast side.
  real(dp) function free_turn(pair, side) result(turn)
    type(stated_t), intent(in) :: pair
    integer, intent(in) :: side
    integer, parameter :: samples = 20000
    real(dp) :: rb(2), ra(2), r, angle, x, y, from
    integer :: i

    rb = base_radius(pair, side)
    ra = tip_radius(pair)
    from = max(rb(1)*(1 + 1e-9_dp), pair%distance - ra(2))
    turn = 1
    do i = 0, samples
      r = from + (ra(1) - from)*i/samples
      angle = half_tooth(pair, 1, side, r)
      x = r*sin(angle)
      y = pair%distance - r*cos(angle)
      r = hypot(x, y)
      if (r <= rb(2) .or. r > ra(2)) cycle
      turn = min(turn, pi/pair%teeth(2) - half_tooth(pair, 2, side, r) - atan2(x, y))
    end do
  end function free_turn

  !> The outline as the rack leaves it: no point of it is ever inside the rack's tooth while that rolls by,
  !> and each is once on its edge.
  subroutine outline_as_cut(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: steps = 6
    type(stated_t) :: list(12)
    type(gear_t) :: gear
    type(error_t), allocatable :: error
    real(dp) :: points(2, 5*steps + 1), least, farthest
    integer :: n, i, k, side

    list(:5) = examples()
    ! Undercut: harmless, deep, of one flank or both, by a sharp rack and by a round one.
    list(6) = stated_t(teeth=[17, 16], rounding=[0.38_dp, 0.38_dp])
    list(7) = stated_t(module=4.5_dp, teeth=[24, 18], shift=[-0.5_dp, 0.0_dp], rounding=[0.38_dp, 0.25_dp])
    list(8) = stated_t(teeth=[8, 12], shift=[0.0_dp, -0.2_dp], rounding=[0.1_dp, 0.25_dp])
    list(9) = stated_t(angle=[25, 15], teeth=[14, 19], rounding=[0.2_dp, 0.0_dp])
    ! Helical gears: in the normal section of the rack. One is undercut, one is not.
    list(10) = stated_t(teeth=[25, 40], shift=[0.3_dp, -0.1_dp], helix=30.0_dp)
    list(11) = stated_t(teeth=[18, 60], shift=[0.2_dp, 0.0_dp], rounding=[0.38_dp, 0.1_dp], helix=-15.0_dp)
    list(12) = stated_t(teeth=[10, 11], rounding=[0.3_dp, 0.2_dp], helix=20.0_dp)
    do n = 1, size(list)
      associate (pair => list(n))
        do i = 1, 2
          call make_gear(gear_spec_t('gear', pair%teeth(i), pair%module, pair%angle*degree, pair%shift(i), pair%addendum(i), &
            pair%dedendum(i), pair%rounding(i), face_width=1.0_dp, helix_angle=pair%helix*degree), gear, error)
          call check_no_error(t, 'gear to be cut', error)
          call check_true(t, 'pair '//str(n)//': undercut', any(gear%is_undercut([drive, coast])) .eqv. &
                          any(n == [6, 7, 8, 9, 12]))
          points = tooth_outline(gear, steps)
          farthest = 0
          least = 0
          do k = 1, 5*steps + 1
            side = merge(drive, coast, points(1, k) > 0)
            ! The tip land is the blank's own edge.
            if (k > 2*steps + 1 .and. k < 3*steps + 1) cycle
            associate (room => cut(pair, i, side, [abs(points(1, k)), points(2, k)]))
              least = min(least, room)
              farthest = max(farthest, room)
            end associate
          end do
          call check_close(t, 'pair '//str(n)//': nothing is cut off', least, 0.0_dp, absolute=1e-8_dp*pair%module)
          call check_close(t, 'pair '//str(n)//': nothing is left over', farthest, 0.0_dp, absolute=1e-8_dp*pair%module)
        end do
      end associate
    end do
  end subroutine outline_as_cut

  !> The same for teeth that a tool with protuberance cuts before their flanks are ground: as if both tools were one, which cuts
  !> flanks as the grinding wheel and fillets as its rounded tip does, s_pr beside them. How far its tip's own flank rises, at
  !> 8 degrees, does not show. Undercut by generation, harmless or deep, comes on top.
  subroutine protuberance_as_cut(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: steps = 6
    real(dp), parameter :: depths(3) = [0.004_dp, 0.02_dp, 0.045_dp]
    type(stated_t) :: list(4)
    type(gear_spec_t) :: spec
    type(gear_t) :: gear, plain
    type(error_t), allocatable :: error
    real(dp) :: points(2, 5*steps + 1), least, farthest
    integer :: n, i, k, m, side

    list(1) = stated_t(teeth=[25, 40], shift=[0.3_dp, -0.1_dp], dedendum=[1.4_dp, 1.4_dp], rounding=[0.3_dp, 0.38_dp])
    list(2) = stated_t(module=2.0_dp, teeth=[17, 90], dedendum=[1.4_dp, 1.4_dp], rounding=[0.38_dp, 0.38_dp])
    list(3) = stated_t(teeth=[14, 16], shift=[0.0_dp, -0.2_dp], rounding=[0.1_dp, 0.25_dp])
    list(4) = stated_t(angle=[25, 18], teeth=[24, 31], shift=[0.3_dp, -0.1_dp], rounding=[0.2_dp, 0.15_dp])
    do n = 1, size(list)
      associate (pair => list(n), name => 'protuberance, pair '//str(n))
        do i = 1, 2
          do m = 1, size(depths)
            spec = gear_spec_t('gear', pair%teeth(i), pair%module, pair%angle*degree, pair%shift(i), pair%addendum(i), &
                               pair%dedendum(i), pair%rounding(i), face_width=1.0_dp)
            call make_gear(spec, plain, error)
            spec%grinding_stock = 0.05_dp*pair%module
            spec%protuberance = (0.05_dp + depths(m))*pair%module
            call make_gear(spec, gear, error)
            call check_no_error(t, name, error)
            call check_true(t, name//': flanks begin higher', all(gear%form_radius > plain%form_radius))
            points = tooth_outline(gear, steps)
            farthest = 0
            least = 0
            do k = 1, 5*steps + 1
              side = merge(drive, coast, points(1, k) > 0)
              if (k > 2*steps + 1 .and. k < 3*steps + 1) cycle
              associate (room => cut(pair, i, side, [abs(points(1, k)), points(2, k)], depths(m)))
                least = min(least, room)
                farthest = max(farthest, room)
              end associate
            end do
            call check_close(t, name//': nothing is cut off', least, 0.0_dp, absolute=1e-8_dp*pair%module)
            call check_close(t, name//': nothing is left over', farthest, 0.0_dp, absolute=1e-8_dp*pair%module)
          end do
          spec%protuberance = spec%grinding_stock
          call make_gear(spec, gear, error)
          call check_true(t, name//': as much stock', all(abs(tooth_outline(gear, steps) - tooth_outline(plain, steps)) <= 0))
          spec%protuberance = 0.9_dp*spec%grinding_stock
          call make_gear(spec, gear, error)
          call check_error(t, name//': more stock', error, 'grinding stock (mm) = ')
          spec%protuberance = 2*pair%module
          call make_gear(spec, gear, error)
          call check_true(t, name//': too much', allocated(error))
        end do
      end associate
    end do
  end subroutine protuberance_as_cut

  !> Least distance (mm) of a point of the gear from the rack's tooth that cuts this side, over all positions of
  !> the rack; negative where the rack reaches beyond. By a scan and golden section. `beside_flank`: what the rack's tip stands
  !> out of its flank, in modules.
  real(dp) function cut(pair, gear, side, point, beside_flank) result(room)
    type(stated_t), intent(in) :: pair
    integer, intent(in) :: gear, side
    real(dp), intent(in) :: point(2)
    real(dp), intent(in), optional :: beside_flank
    integer, parameter :: scan = 400
    real(dp), parameter :: golden = (sqrt(5.0_dp) - 1)/2, reach = 1.2_dp
    real(dp) :: low, high, middle(2)
    integer :: i, best

    best = minloc([(beside(-reach + 2*reach*i/scan), i=0, scan)], 1) - 1
    low = -reach + 2*reach*(best - 1)/scan
    high = -reach + 2*reach*(best + 1)/scan
    do i = 1, 60
      middle = [high - golden*(high - low), low + golden*(high - low)]
      if (beside(middle(1)) < beside(middle(2))) then
        high = middle(2)
      else
        low = middle(1)
      end if
    end do
    room = beside((low + high)/2)

  contains

    !> Distance from the rack's tooth when the gear has turned by `roll` (rad).
    pure real(dp) function beside(roll)
      real(dp), intent(in) :: roll

      beside = beside_tip(roll, 0.0_dp, pair%angle(side)*degree)
      if (present(beside_flank)) beside = min(beside, beside_tip(roll, beside_flank, 8*degree))
    end function beside

    !> The rack's tooth is a disc of the rounding's radius that has swept all that lies beyond the lines which its centre
    !> follows: the tip land and a flank at `alpha` (rad). It stands out of the flank by `depth` (modules).
    pure real(dp) function beside_tip(roll, depth, alpha) result(beside)
      real(dp), intent(in) :: roll, depth, alpha
      real(dp) :: p(2), centre(2), flank, floor_line

      associate (m => pair%module, x => pair%shift(gear), rho => pair%rounding(gear), angle => pair%angle(side)*degree)
        ! In the rack's frame: across from the middle of its space, and up from its reference line.
        p = [point(1)*cos(roll) - point(2)*sin(roll), point(1)*sin(roll) + point(2)*cos(roll) - m*x]
        associate (radius => m*pair%teeth(gear)/2/cos(pair%helix*degree))
          p = p + radius*[roll, -1.0_dp]
        end associate
        ! Lengths across the rack in its normal section.
        p(1) = p(1)*cos(pair%helix*degree)
        centre = m*[pi/4 + (pair%dedendum(gear) - rho)*tan(angle) + (rho - depth)/cos(angle), rho - pair%dedendum(gear)]
        p = p - centre
        flank = -(p(1)*cos(alpha) + p(2)*sin(alpha))
        floor_line = -p(2)
        ! Within the corner between both normals, the disc's own arc.
        if (p(1) < 0 .and. p(1)*sin(alpha) - p(2)*cos(alpha) > 0) then
          beside = norm2(p) - rho*m
        else
          beside = max(flank, floor_line) - rho*m
        end if
      end associate
    end function beside_tip
  end function cut

  !> Tip alteration k = y - (x1 + x2), where y is the centre distance beyond the standard one in modules, and never above 0.
  !> The outline closes; of more than 500 teeth there is one tooth.
  subroutine tips_and_outlines(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: distances(2) = [93.1_dp, 93.2_dp]
    type(stated_t) :: list(5)
    real(dp) :: radius(6, 2), point(5), at(5, 2), distance, angle(2), ratio, pitch, backlash, x(40000), y(40000)
    integer :: i, k, points

    list = examples()
    associate (pair => list(2))
      do k = 1, 2
        pair%distance = distances(k)
        call ask_geometry(t, '&case tasks=''geometry'' / '//'&pair tip_alteration=.true. '//text_without_pair(), radius, &
                          point, at, distance, angle, ratio, pitch, backlash)
        do i = 1, 2
          call check_close(t, 'altered tips', radius(1, i), 3*(pair%teeth(i)/2.0_dp + 1 + pair%shift(i) &
                           + min(0.0_dp, (pair%distance - 91.5_dp)/3 - sum(pair%shift))))
        end do
      end do
    end associate
    ! Profile C of ISO 53 unless said: addendum 1, dedendum 1.25, tip radius 0.25, 20 degrees on both flanks.
    call ask_geometry(t, '&case tasks=''geometry'' / &pair module_mm=3 face_width_mm=20 / &pinion teeth=30 / &gear teeth=40 /', &
                      radius, point, at, distance, angle, ratio, pitch, backlash)
    do i = 1, 2
      associate (plain => stated_t(teeth=[30, 40], distance=105.0_dp), r => merge(45.0_dp, 60.0_dp, i == 1))
        call check_close(t, 'default rack', maxval(abs(radius(:, i) - [r + 3, r, r*cos(20*degree), r*cos(20*degree), r - 3.75_dp, &
                         involute_start(plain, i)])), 0.0_dp, absolute=1e-10_dp)
      end associate
    end do
    do k = 500, 501
      call outline('&case tasks=''geometry'' / &pair module_mm=1 face_width_mm=9 / &pinion teeth=40 / &gear teeth='//str(k)// &
                   ' /', 2)
      if (k == 500) call check_equal(t, 'all teeth', points, 500*72)
      if (k == 501) call check_equal(t, 'one tooth', points, 61)
    end do
    call outline('&case tasks=''geometry'' / '//text_of(list(3)), 1)
    ! Clockwise, so that the enclosed area counts negative; every chord is short, the closing one too.
    call check_true(t, 'clockwise', sum(x(:points)*cshift(y(:points), 1) - y(:points)*cshift(x(:points), 1)) < 0)
    associate (dx => x(:points) - cshift(x(:points), 1), dy => y(:points) - cshift(y(:points), 1))
      call check_true(t, 'closed, without gaps', maxval(hypot(dx, dy)) < 1)
    end associate

  contains

    !> Points (mm) on the outline of one gear of a case.
    subroutine outline(text, gear)
      character(*), intent(in) :: text
      integer, intent(in) :: gear
      type(case_t) :: case
      type(pair_t) :: gears
      type(error_t), allocatable :: error
      real(dp), allocatable :: found(:, :)

      call read_case(text, case, error)
      if (.not. allocated(error)) call build_pair(case, gears, error)
      call check_no_error(t, 'outline', error)
      if (allocated(error)) return
      call shown_outline(gears%gear(gear), found)
      points = size(found, 2)
      x(:points) = 1000*found(1, :)
      y(:points) = 1000*found(2, :)
    end subroutine outline

    !> The case's groups, going on in &pair.
    function text_without_pair() result(text)
      character(:), allocatable :: text

      text = text_of(list(2))
      text = text(len('&pair ') + 1:)
    end function text_without_pair
  end subroutine tips_and_outlines
end module test_geometry_closed_forms
