!> The limits that refusals tell are the true ones: each against its closed form or the geometry that it stands for.
module test_refusal_limits
  use gearsweep_gear_profile, only: tooth_outline
  use gearsweep_base_error, only: error_t
  use gearsweep_gear_gear, only: gear_spec_t, gear_t, make_gear
  use gearsweep_base_kinds, only: dp, pi
  use gearsweep_base_text, only: str
  use test_support_ask_by_name, only: number_behind, refusal
  use test_support_gears, only: stated_t, examples, text_of, involute, base_radius, tip_radius, working_angle, first_curvature, &
    & base_pitch, contact_ratio, half_tooth, degree, drive, coast
  use test_support_testing, only: tally_t, check_true, check_close, check_error, check_no_error
  implicit none
  private
  public :: run

  character(*), parameter :: task = '&case tasks=''geometry'' / '
  character(*), parameter :: impossible(12) = [character(50) :: 'teeth = 4: must be at least 5', 'module (m) = 0', &
    'face width (m) = 0', 'coast angle (rad) = 0.049', 'pressure angle (rad) = 0.81', 'addendum = 0', 'dedendum = 0', &
    'rack tip radius = -1e-9', 'profile shift = 5', 'profile shift = -5', 'bore diameter (mm) = ', 'must not exceed the dedendum']

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t

    if (t%wants('generation')) call generation(t)
    if (t%wants('meshing')) call meshing(t)
    if (t%wants('bodies_and_loads')) call bodies_and_loads(t)
    if (t%wants('impossible_gears')) call impossible_gears(t)
  end subroutine run

  !> The number behind `words` in what is said of a case.
  subroutine check_limit(t, text, words, expected, relative)
    type(tally_t), intent(inout) :: t
    character(*), intent(in) :: text, words
    real(dp), intent(in) :: expected, relative
    character(:), allocatable :: message

    message = refusal(text)
    call check_true(t, words, index(message, words) > 0, message)
    call check_close(t, words, number_behind(message, words), expected, relative=relative)
  end subroutine check_limit

  !> Undercut: the rack's straight flank must not reach below the point where its normal meets the base circle, depth
  !> z sin**2(alpha)/2 in modules. The rack's roundings share its tip land. Flanks meet where both half angles add up to 0.
  subroutine generation(t)
    type(tally_t), intent(inout) :: t
    type(stated_t) :: pair
    real(dp) :: low, high, alpha(2)
    integer :: i

    pair = stated_t(teeth=[11, 40], distance=76.5_dp)
    call check_limit(t, task//text_of(pair), 'undercut with 11 teeth takes working flank; to have none it must be at least ', &
                     1.25_dp - 0.25_dp*(1 - sin(20*degree)) - 11*sin(20*degree)**2/2, 1e-5_dp)
    pair = stated_t(angle=[24, 17], teeth=[30, 40], rounding=[0.6_dp, 0.2_dp], distance=105.0_dp)
    alpha = [24, 17]*degree
    call check_limit(t, task//text_of(pair), 'does not fit the rack; at most ', &
                     sum(pi/4 - 1.25_dp*tan(alpha))/sum((1 - sin(alpha))/cos(alpha)), 1e-5_dp)
    pair%dedendum(1) = 2.4_dp
    call check_limit(t, task//text_of(pair), 'the rack tooth is pointed above ', pi/2/sum(tan(alpha)), 1e-5_dp)
    pair = stated_t(teeth=[14, 40], shift=[0.9_dp, 0.0_dp], addendum=[1.3_dp, 1.0_dp], distance=84.0_dp)
    low = 21
    high = 30
    do i = 1, 60
      if (half_tooth(pair, 1, drive, (low + high)/2) + half_tooth(pair, 1, coast, (low + high)/2) > 0) then
        low = (low + high)/2
      else
        high = (low + high)/2
      end if
    end do
    call check_limit(t, task//text_of(pair), 'pointed teeth; the tip diameter must stay below ', 2*low, 1e-5_dp)
  end subroutine generation

  !> Jamming: the distance without backlash has inv(alpha_w) = inv(alpha) + 2 (x1 + x2) tan(alpha)/(z1 + z2), for unlike flanks
  !> that of both together. Contact ends where the path between the tips is one base pitch long. Interference: the path begins where
  !> the other's involute does, or the tip meets the root.
  subroutine meshing(t)
    type(tally_t), intent(inout) :: t
    type(stated_t) :: pair
    real(dp) :: low, high, rho, rb(2), excess
    integer :: i, k, side

    do k = 1, 2
      pair = stated_t(teeth=[20, 30], shift=[0.3_dp, 0.2_dp], rounding=[0.2_dp, 0.2_dp], distance=75.5_dp)
      if (k == 2) pair%angle = [25, 18]
      low = 75
      high = 78
      do i = 1, 60
        associate (a => pair%distance)
          a = (low + high)/2
          excess = sum([(involute(working_angle(pair, side)) - involute(pair%angle(side)*degree) &
                         - 2*sum(pair%shift)*tan(pair%angle(side)*degree)/sum(pair%teeth), side=1, 2)])
          if (excess < 0) then
            low = a
          else
            high = a
          end if
        end associate
      end do
      pair%distance = 75.5_dp
      call check_limit(t, task//text_of(pair), 'the teeth jam; must be at least ', low, 1e-7_dp)
    end do
    pair = stated_t(teeth=[20, 30], distance=79.0_dp)
    call check_limit(t, task//text_of(pair), 'contact would be interrupted; it must be below ', &
                     hypot(sum(sqrt(tip_radius(pair)**2 - base_radius(pair, drive)**2)) - base_pitch(pair), &
                           sum(base_radius(pair, drive))), 1e-5_dp)
    pair = stated_t(teeth=[24, 90], addendum=[1.0_dp, 1.4_dp], dedendum=[1.4_dp, 1.25_dp], rounding=[0.3_dp, 0.1_dp], &
                    shift=[0.15_dp, 0.0_dp], distance=171.6_dp)
    rb = base_radius(pair, drive)
    associate (alpha => 20*degree)
      rho = pair%module*24/2*sin(alpha) - pair%module*(1.4_dp - 0.3_dp*(1 - sin(alpha)) - 0.15_dp)/sin(alpha)
    end associate
    call check_limit(t, task//text_of(pair), ' mm reaches below the involute of the pinion; at most ', &
                     2*hypot(rb(2), pair%distance*sin(working_angle(pair, drive)) - rho), 1e-5_dp)
    pair = stated_t(teeth=[40, 40], addendum=[1.3_dp, 1.0_dp], distance=120.0_dp)
    call check_limit(t, task//text_of(pair), 'interference; its tip cuts ', 1.3_dp*3 - 1.25_dp*3, 1e-4_dp)
    call check_limit(t, task//text_of(pair), '; the tip diameter must stay below ', 2*(120 - (60 - 1.25_dp*3)), 1e-4_dp)
  end subroutine meshing

  !> Bore below the root, rim above the bore, relief within half the tip's thickness, Hertz's contact within one module.
  subroutine bodies_and_loads(t)
    type(tally_t), intent(inout) :: t
    type(stated_t) :: list(5), pair
    real(dp) :: ra(2), thick(2), rho(2), largest
    integer :: i

    list = examples()
    pair = list(2)
    call check_limit(t, task//text_of(pair, pinion=' bore_mm=60'), 'below the root diameter ', &
                     3*(19 - 2*(1.25_dp - 0.4_dp)), 1e-5_dp)
    call check_limit(t, '&case tasks=''modal'' / '//text_of(pair, pinion=' bore_mm=30')//'&section rim_mm=12 /', &
                     'reaches into the bore; at most ', 1.5_dp*(19 - 2*(1.25_dp - 0.4_dp)) - 15, 1e-5_dp)
    ! A tooth so thin at its tip that half of it is less than a tenth of the module.
    pair%addendum(1) = 1.3_dp
    pair%dedendum(2) = 1.5_dp
    ra = tip_radius(pair)
    thick = [(ra(i)*(half_tooth(pair, i, drive, ra(i)) + half_tooth(pair, i, coast, ra(i))), i=1, 2)]
    call check_limit(t, '&case tasks=''mesh'' / '//text_of(pair)//'&load line_load_n_mm=100 / &mesh model=''iso6336'' / '// &
                     '&relief amount_um=299 gear_fraction=1.5 /', 'with these fractions at most ', &
                     500*min(thick(1), thick(2)/1.5_dp), 1e-5_dp)
    pair = list(2)
    ! a = sqrt(8 w R (1 - nu**2)/(pi E)) is half a module at most, where 1/R = 1/rho1 + 1/rho2 is least.
    largest = 0
    do i = 0, 2000
      rho(1) = first_curvature(pair) + contact_ratio(pair)*base_pitch(pair)*i/2000
      rho(2) = pair%distance*sin(working_angle(pair, drive)) - rho(1)
      largest = max(largest, rho(1)*rho(2)/sum(rho))
    end do
    ! It is refused before any model is asked, by the key that is given.
    call check_limit(t, '&case tasks=''mesh'' / '//text_of(pair)//'&load line_load_n_mm=2.4e4 / &mesh model=''weber'' /', &
                     'with this face width it must be at most ', 1.5_dp**2*pi*206e3_dp/(8*0.91_dp*largest), 1e-2_dp)
    call check_limit(t, '&case tasks=''mesh'' / '//text_of(pair)//'&load normal_force_n=5e6 / &mesh model=''weber'' /', &
                     '&load normal_force_n = ', 5e6_dp, 1e-12_dp)
  end subroutine bodies_and_loads

  !> Where the section would overlap the next tooth's fillet; and every number of a gear that cannot be, each by its name
  !> and beside the last that can.
  subroutine impossible_gears(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: steps = 40
    type(stated_t) :: list(5)
    type(gear_spec_t) :: good, spec
    type(gear_t) :: gear
    type(error_t), allocatable :: error
    real(dp) :: points(2, 5*steps + 1), root(2), middle
    integer :: i

    list = examples()
    associate (pair => list(3))
      call make_gear(gear_spec_t('gear', pair%teeth(1), pair%module, pair%angle*degree, pair%shift(1), pair%addendum(1), &
        pair%dedendum(1), pair%rounding(1), face_width=1.0_dp), gear, error)
      points = tooth_outline(gear, steps)
      ! The outline begins and ends where the fillets meet the root circle; the cut is in the middle of the root's land.
      root = abs([atan2(points(1, 5*steps + 1), points(2, 5*steps + 1)), atan2(points(1, 1), points(2, 1))])
      middle = (root(drive) - root(coast))/2
      call check_limit(t, '&case tasks=''modal'' / '//text_of(pair)//'&section teeth=3 half_angle_deg=24 /', &
        ' (teeth cut) and ', (2*2*pi/pair%teeth(1) - max(root(drive) - middle, root(coast) + middle))/degree, 1e-5_dp)
    end associate
    good = gear_spec_t('gear', 25, 0.003_dp, face_width=0.02_dp)
    call make_gear(good, gear, error)
    call check_true(t, 'a gear that can be', .not. allocated(error))
    do i = 1, 12
      spec = good
      select case (i)
      case (1)
        spec%teeth = 4
      case (2)
        spec%module = 0
      case (3)
        spec%face_width = 0
      case (4)
        spec%pressure_angle(2) = 0.049_dp
      case (5)
        spec%pressure_angle(1) = 0.81_dp
      case (6)
        spec%addendum = 0
      case (7)
        spec%dedendum = 0
      case (8)
        spec%rack_tip_radius = -1e-9_dp
      case (9)
        spec%profile_shift = 5
      case (10)
        spec%profile_shift = -5
      case (11)
        spec%bore_radius = -1e-9_dp
      case (12)
        spec%dedendum = 0.2_dp
        spec%rack_tip_radius = 0.21_dp
      case default
        error stop 'more rounds than ways to be impossible'
      end select
      call make_gear(spec, gear, error)
      call check_error(t, 'impossible gear '//str(i), error, trim(impossible(i)))
    end do
    ! Ten teeth, a tip of 4.7 modules: above the drive flank's start, hypot(4.53, 0.47/tan 25), below the coast flank's.
    spec = gear_spec_t('gear', 10, 0.003_dp, [25, 18]*degree, -0.37_dp, 0.07_dp, 0.1_dp, 0.0_dp, face_width=0.02_dp)
    call make_gear(spec, gear, error)
    call check_error(t, 'one flank without an involute', error, 'no involute is left')
    spec = good
    spec%teeth = 5
    call make_gear(spec, gear, error)
    call check_no_error(t, 'five teeth are many enough', error)
    call check_true(t, 'but undercut', gear%is_undercut(drive))
    spec%profile_shift = -0.6_dp
    call make_gear(spec, gear, error)
    call check_error(t, 'undercut cuts five teeth off', error, 'undercut with 5 teeth leaves no tooth')
  end subroutine impossible_gears
end module test_refusal_limits
