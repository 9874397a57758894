!> Tooth thickness and tips: allowances and the backlash that follows, span and diameter over pins, chamfers and roundings.
module test_measures
  use gearsweep_base_kinds, only: dp, pi
  use gearsweep_gear_profile, only: involute_point, tip_break_point, tooth_outline
  use gearsweep_base_error, only: error_t
  use gearsweep_gear_gear, only: coast, drive, gear_spec_t, gear_t, involute, make_gear
  use gearsweep_gear_measures, only: check_pin, find_measures, measures_t
  use gearsweep_gear_pair, only: free_centre_distance, make_pair, pair_t
  use test_support_testing, only: check_close, check_equal, check_error, check_no_error, check_true, tally_t
  implicit none
  private
  public :: run

  real(dp), parameter :: degree = pi/180, mm = 1e-3_dp
  integer, parameter :: samples = 200000

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t

    if (t%wants('allowance')) call allowance(t)
    if (t%wants('tight_by_rounding')) call tight_by_rounding(t)
    if (t%wants('measures_by_jaws_and_pins')) call measures_by_jaws_and_pins(t)
    if (t%wants('pins_that_measure_nothing')) call pins_that_measure_nothing(t)
    if (t%wants('tip_diameter')) call tip_diameter(t)
    if (t%wants('tip_breaks')) call tip_breaks(t)
    if (t%wants('tips_that_are_refused')) call tips_that_are_refused(t)
  end subroutine run

  type(gear_spec_t) function spec_of(teeth, shift) result(spec)
    integer, intent(in) :: teeth
    real(dp), intent(in) :: shift

    spec%name = 'pinion'
    spec%teeth = teeth
    spec%module = 3*mm
    spec%profile_shift = shift
    spec%face_width = 20*mm
  end function spec_of

  !> Thinner by A_s on the reference circle, for unequal flanks too; root circle with the rack, tip circle not; gears without
  !> profile shift, whose reference circles roll, have backlash by as much, times cos(alpha) on the line of action.
  subroutine allowance(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: thinner = -0.08_dp*mm, angles(2, 2) = reshape([20, 20, 25, 18], [2, 2])*degree
    type(gear_spec_t) :: spec
    type(gear_t) :: whole, thin, mate
    type(pair_t) :: pair
    type(error_t), allocatable :: error
    integer :: i

    do i = 1, 2
      spec = spec_of(25, 0.0_dp)
      spec%rack_tip_radius = 0.2_dp
      spec%pressure_angle = angles(:, i)
      call make_gear(spec, whole, error)
      spec%thinning = thinner/(spec%module*sum(tan(angles(:, i))))
      call make_gear(spec, thin, error)
      call check_no_error(t, 'a thinner tooth', error)
      call check_close(t, 'thinner on the reference circle', thin%thickness(37.5_dp*mm) - whole%thickness(37.5_dp*mm), thinner, &
                       1e-12_dp)
      call check_close(t, 'same tip circle', thin%tip_radius, whole%tip_radius)
      call check_close(t, 'root circle of the generating shift', thin%root_radius - whole%root_radius, &
                       thinner/sum(tan(angles(:, i))), 1e-10_dp)
      spec = spec_of(40, 0.0_dp)
      spec%rack_tip_radius = 0.2_dp
      spec%pressure_angle = angles(:, i)
      call make_gear(spec, mate, error)
      call make_pair(thin, mate, free_centre_distance(thin, mate), pair, error)
      call check_no_error(t, 'a thinner tooth in mesh', error)
      call check_close(t, 'centre distance of the whole teeth', pair%centre_distance, 97.5_dp*mm)
      call check_close(t, 'backlash', pair%backlash, -thinner*cos(angles(drive, i)), 1e-10_dp)
    end do
  end subroutine allowance

  !> FZG type C with its published centre distance, which profile shifts with four digits miss by 0.08 um.
  subroutine tight_by_rounding(t)
    type(tally_t), intent(inout) :: t
    type(gear_spec_t) :: spec
    type(gear_t) :: gears(2)
    type(pair_t) :: pair
    type(error_t), allocatable :: error

    spec = spec_of(16, 0.1817_dp)
    spec%module = 4.5_dp*mm
    call make_gear(spec, gears(1), error)
    spec%teeth = 24
    spec%profile_shift = 0.1715_dp
    call make_gear(spec, gears(2), error)
    call make_pair(gears(1), gears(2), 91.5_dp*mm, pair, error)
    call check_no_error(t, 'FZG type C at 91.5 mm', error)
    call check_close(t, 'what it lacks', pair%rounding, free_centre_distance(gears(1), gears(2)) - 91.5_dp*mm, 1e-12_dp)
    call check_close(t, 'that is 0.08 um', pair%rounding, 0.0786e-6_dp, absolute=5e-11_dp)
    call check_true(t, 'no backlash', .not. abs(pair%backlash) > 0)
    call check_close(t, 'its working angle is that of the stated distance', cos(pair%working_angle(drive)), &
                     90*cos(20*degree)/91.5_dp, 1e-14_dp)
    call make_pair(gears(1), gears(2), 91.4997_dp*mm, pair, error)
    call check_no_error(t, 'half a unit of the fourth digit of both', error)
    call make_pair(gears(1), gears(2), 91.4995_dp*mm, pair, error)
    call check_error(t, 'more', error, 'the teeth jam; must be at least 91.5000')
  end subroutine tight_by_rounding

  !> Span and diameter over pins or balls against jaws and pins that are pushed against sampled flanks; and a published span: module
  !> 2 mm, 20 teeth, over three of them (machinecalcs.com, span measurement over teeth).
  subroutine measures_by_jaws_and_pins(t)
    type(tally_t), intent(inout) :: t
    type(gear_spec_t) :: spec
    type(gear_t) :: gear
    type(measures_t) :: measures
    type(error_t), allocatable :: error
    integer, parameter :: teeth(9) = [20, 25, 51, 12, 17, 40, 24, 31, 70]
    real(dp), parameter :: shift(9) = [0.0_dp, 0.3_dp, -0.203_dp, 0.5_dp, -0.1_dp, 0.0_dp, 0.4_dp, 0.0_dp, -0.2_dp]
    real(dp), parameter :: helix(9) = [0, 0, 0, 0, 0, 0, 25, -10, 30]*degree
    integer :: i

    do i = 1, 9
      spec = spec_of(teeth(i), shift(i))
      spec%helix_angle = helix(i)
      if (i == 9) spec%face_width = 60*mm
      if (i == 2) spec%thinning = -0.05_dp
      if (i == 3) spec%pin_diameter = 5.5_dp*mm
      ! So thin that a pin which touches at the V circle is below the tip circle.
      if (i == 6) spec%thinning = -0.75_dp
      call make_gear(spec, gear, error)
      call check_no_error(t, 'gear to be measured', error)
      measures = find_measures(gear)
      call check_close(t, 'span', measures%span/mm, by_jaws(gear, measures%span_teeth)/mm, absolute=1e-6_dp)
      call check_close(t, 'over pins', measures%over_pins/mm, over_pins(gear, measures%pin_diameter)/mm, absolute=1e-6_dp)
      if (i == 6) call check_close(t, 'pins of thin teeth extend a tenth of a module', measures%over_pins/mm, &
                                   2*gear%tip_radius/mm + 2*spec%module/10/mm, absolute=1e-9_dp)
      if (i == 3) call check_close(t, 'stated pins', measures%pin_diameter, 5.5_dp*mm)
    end do
    ! On a face narrower than W sin(beta_b), the jaws would miss one of the flanks: one tooth fewer, or none on the narrowest.
    i = measures%span_teeth
    spec%face_width = measures%span*sin(30*degree)*cos(20*degree)*(1 - 1e-9_dp)
    call make_gear(spec, gear, error)
    measures = find_measures(gear)
    call check_equal(t, 'one tooth fewer on a narrow face', measures%span_teeth, i - 1)
    spec%face_width = 5*mm
    call make_gear(spec, gear, error)
    measures = find_measures(gear)
    call check_equal(t, 'no span on the narrowest face', measures%span_teeth, 0)
    spec = spec_of(20, 0.0_dp)
    spec%module = 2*mm
    call make_gear(spec, gear, error)
    measures = find_measures(gear)
    call check_equal(t, 'teeth in the span', measures%span_teeth, 3)
    call check_close(t, 'published span', measures%span/mm, 15.321_dp, absolute=5e-4_dp)
    call check_close(t, 'published circle of contact', 2*hypot(gear%base_radius(drive), measures%span/2)/mm, 40.59_dp, &
                     absolute=5e-3_dp)
  end subroutine measures_by_jaws_and_pins

  !> Twice the farthest that the outer flank of `teeth` teeth reaches sidewards, of a helical gear in the direction of the flanks'
  !> normals, which all have the slope beta_b, and at that transverse section (height z) where it reaches farthest.
  real(dp) function by_jaws(gear, teeth) result(span)
    type(gear_t), intent(in) :: gear
    integer, intent(in) :: teeth
    real(dp) :: r, angle, slope, twist, turned
    integer :: i

    span = 0
    slope = atan(tan(gear%spec%helix_angle)*gear%base_radius(drive)/gear%reference_radius)
    twist = tan(gear%spec%helix_angle)/gear%reference_radius
    do i = 0, samples
      r = gear%form_radius(drive) + (gear%tip_radius - gear%form_radius(drive))*i/samples
      angle = (teeth - 1)*pi/gear%spec%teeth + gear%half_angle(drive, r)
      if (.not. abs(twist) > 0) then
        span = max(span, 2*r*sin(angle))
        cycle
      end if
      ! Where the derivative by z of r sin(angle + twist z) cos(slope) - z sin(slope) is zero.
      turned = acos(min(1.0_dp, sin(slope)/(r*twist*cos(slope))))
      span = max(span, 2*(r*sin(turned)*cos(slope) - (turned - angle)/twist*sin(slope)))
    end do
  end function by_jaws

  !> Over two opposite pins that are lowered into their spaces until they touch a flank.
  real(dp) function over_pins(gear, diameter) result(over)
    type(gear_t), intent(in) :: gear
    real(dp), intent(in) :: diameter
    real(dp) :: low, high, centre, r, angle, least, twist, z
    integer :: i, k, n

    twist = tan(gear%spec%helix_angle)/gear%reference_radius
    low = gear%root_radius
    high = gear%tip_radius + diameter
    do k = 1, 45
      centre = (low + high)/2
      least = 1
      do i = 0, samples/10
        r = gear%form_radius(drive) + (gear%tip_radius - gear%form_radius(drive))*i/(samples/10)
        angle = pi/gear%spec%teeth - gear%half_angle(drive, r)
        ! Height of the flank's point that is nearest to the centre of a ball, by Newton's method.
        z = 0
        if (abs(twist) > 0) then
          do n = 1, 4
            z = z - (z + r*centre*twist*sin(angle + twist*z))/(1 + r*centre*twist**2*cos(angle + twist*z))
          end do
        end if
        least = min(least, norm2([r*sin(angle + twist*z), r*cos(angle + twist*z) - centre, z]))
      end do
      if (least < diameter/2) then
        low = centre
      else
        high = centre
      end if
    end do
    over = 2*centre*merge(1.0_dp, cos(pi/2/gear%spec%teeth), mod(gear%spec%teeth, 2) == 0) + diameter
  end function over_pins

  subroutine pins_that_measure_nothing(t)
    type(tally_t), intent(inout) :: t
    type(gear_spec_t) :: spec
    type(gear_t) :: gear
    type(measures_t) :: measures
    type(error_t), allocatable :: error
    real(dp), parameter :: pins(3) = [2.0_dp, 10.0_dp, 4.0_dp]
    character(*), parameter :: why(3) = [character(40) :: 'touches no involute; must be from', &
                                         'touches no involute; must be from', 'must stand out beyond the tip diameter']
    integer :: i

    do i = 1, 3
      spec = spec_of(25, 0.0_dp)
      spec%pin_diameter = pins(i)*mm
      if (i == 3) spec%addendum = 1.3_dp
      call make_gear(spec, gear, error)
      call check_pin(gear, error)
      call check_error(t, 'pin '//why(i), error, trim(why(i)))
      measures = find_measures(gear)
      call check_true(t, 'no diameter over this pin', .not. measures%over_pins > 0)
    end do
    deallocate (error)
    spec = spec_of(25, 0.0_dp)
    spec%rack_tip_radius = 0.1_dp
    spec%pressure_angle(coast) = 25*degree
    spec%pin_diameter = 5*mm
    call make_gear(spec, gear, error)
    call check_pin(gear, error)
    call check_error(t, 'pins in unequal spaces', error, 'equal pressure angles only')
    measures = find_measures(gear)
    call check_equal(t, 'unequal flanks have no span', measures%span_teeth, 0)
  end subroutine pins_that_measure_nothing

  !> Stated, it is what addendum and profile shift would give.
  subroutine tip_diameter(t)
    type(tally_t), intent(inout) :: t
    type(gear_spec_t) :: spec
    type(gear_t) :: one, other
    type(error_t), allocatable :: error

    spec = spec_of(25, 0.2_dp)
    spec%addendum = 0.9_dp
    call make_gear(spec, one, error)
    spec%addendum = 1
    spec%tip_diameter = 3*(25 + 2*1.1_dp)*mm
    call make_gear(spec, other, error)
    call check_no_error(t, 'tip diameter', error)
    call check_close(t, 'tip diameter', other%tip_radius, one%tip_radius, 1e-14_dp)
    call check_close(t, 'the involute ends there', other%tip_form_radius, other%tip_radius)
    call check_close(t, 'no chamfer takes any of the tip', other%tip_half_angle(drive), other%half_angle(drive, other%tip_radius))
  end subroutine tip_diameter

  !> Chamfers and roundings: contact ends where they begin, as with shorter teeth; a chamfer's slope to the flank is what
  !> 45 degrees and the pressure angle leave on the reference circle; a rounding is an arc that touches flank and tip circle.
  subroutine tip_breaks(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: tiny = 1e-6_dp, radius = 0.3_dp*mm
    type(gear_spec_t) :: spec
    type(gear_t) :: gear, mate, short
    type(pair_t) :: pair, stubby
    type(error_t), allocatable :: error
    real(dp) :: p(2), q(2), centre(2), along(2), flank(2), outline(2, 0:35)
    integer :: side

    spec = spec_of(40, 0.0_dp)
    call make_gear(spec, mate, error)
    spec = spec_of(25, 0.1_dp)
    spec%tip_chamfer = 0.25_dp*mm
    call make_gear(spec, gear, error)
    call check_no_error(t, 'chamfer', error)
    call check_close(t, 'involute ends below the chamfer', gear%tip_form_radius, gear%tip_radius - 0.25_dp*mm, 1e-14_dp)
    spec%tip_chamfer = 0
    spec%tip_diameter = 2*gear%tip_form_radius
    call make_gear(spec, short, error)
    call make_pair(gear, mate, 98*mm, pair, error)
    call check_no_error(t, 'chamfered pair', error)
    call make_pair(short, mate, 98*mm, stubby, error)
    call check_close(t, 'contact ratio of teeth that end there', pair%contact_ratio, stubby%contact_ratio, 1e-13_dp)
    call make_pair(mate, gear, 98*mm, stubby, error)
    call check_close(t, 'chamfer of the driven gear', pair%contact_ratio, stubby%contact_ratio, 1e-13_dp)
    spec%tip_diameter = 0
    spec%tip_form_diameter = 2*gear%tip_form_radius
    call make_gear(spec, short, error)
    call check_close(t, 'stated by where it begins', short%tip_half_angle(coast), gear%tip_half_angle(coast), 1e-12_dp)
    ! A hob with an edge of 45 degrees: slopes of chamfer and involute to the ray, from the base circles r cos(45) and r cos(20).
    p = tip_break_point(gear, drive, 0.0_dp)
    q = tip_break_point(gear, drive, tiny)
    call check_close(t, 'chamfer meets the involute', norm2(p - involute_point(gear, drive, gear%tip_form_radius)), 0.0_dp, &
                     absolute=1e-15_dp)
    along = (q - p)/norm2(q - p)
    ! The material between the involute below the edge and the chamfer above it, or the tip circle.
    flank = involute_point(gear, drive, gear%tip_form_radius*(1 - tiny)) - p
    associate (edge => gear%edge_angle(drive, gear%curvature(drive, gear%tip_form_radius)), bare => mate%edge_angle( &
               drive, mate%curvature(drive, mate%tip_radius)))
      call check_close(t, 'edge of the chamfer', edge, acos(dot_product(flank, along)/norm2(flank)), absolute=1e-4_dp)
      centre = involute_point(mate, drive, mate%tip_radius)
      flank = involute_point(mate, drive, mate%tip_radius*(1 - tiny)) - centre
      ! Along the tip circle into the tooth.
      centre = [-centre(2), centre(1)]/norm2(centre)
      call check_close(t, 'edge of a tip without one', bare, acos(dot_product(flank, centre)/norm2(flank)), absolute=1e-4_dp)
      call check_true(t, 'a chamfer is a blunter edge', edge > bare + 20*degree)
    end associate
    call check_close(t, 'slope of the chamfer', dot_product(along, p)/norm2(p), 37.5_dp*mm*cos(45*degree)/norm2(p), 1e-6_dp)
    spec = gear%spec
    spec%helix_angle = 20*degree
    call make_gear(spec, short, error)
    p = tip_break_point(short, drive, 0.0_dp)
    along = tip_break_point(short, drive, tiny) - p
    ! The hob's edge is at 45 degrees in the normal section.
    call check_close(t, 'slope of the chamfer of a helical gear', dot_product(along, p)/norm2(along), &
                     37.5_dp*mm/cos(20*degree)*cos(atan(1/cos(20*degree))), 1e-6_dp)
    outline = tooth_outline(gear, 5)
    call check_close(t, 'outline reaches the tip circle', maxval(norm2(outline, 1)), gear%tip_radius, 1e-14_dp)
    call check_close(t, 'tip land of the outline', norm2(outline(:, 20) - outline(:, 15)), &
                     2*gear%tip_radius*sin((gear%tip_half_angle(drive) + gear%tip_half_angle(coast))/2), 1e-12_dp)

    spec = spec_of(25, 0.0_dp)
    spec%pressure_angle = [20, 25]*degree
    spec%rack_tip_radius = 0.2_dp
    spec%tip_rounding = radius
    call make_gear(spec, gear, error)
    call check_no_error(t, 'rounding', error)
    do side = drive, coast
      centre = (gear%tip_radius - radius)*[sin(gear%tip_half_angle(side)), cos(gear%tip_half_angle(side))]
      p = tip_break_point(gear, side, 0.0_dp)
      q = tip_break_point(gear, side, 1.0_dp)
      flank = involute_point(gear, side, gear%flank_end(side))
      call check_close(t, 'rounding meets the involute', norm2(p - flank), 0.0_dp, absolute=1e-15_dp)
      call check_close(t, 'its radius', norm2(p - centre), radius, 1e-12_dp)
      flank = flank - involute_point(gear, side, gear%flank_end(side)*(1 - tiny))
      call check_close(t, 'it touches the involute', dot_product(flank, p - centre)/norm2(flank)/radius, 0.0_dp, absolute=1e-4_dp)
      call check_close(t, 'it ends on the tip circle', norm2(q), gear%tip_radius, 1e-14_dp)
      call check_close(t, 'and touches it', (q(1)*centre(2) - q(2)*centre(1))/norm2(q)/norm2(centre), 0.0_dp, absolute=1e-14_dp)
    end do
  end subroutine tip_breaks

  subroutine tips_that_are_refused(t)
    type(tally_t), intent(inout) :: t
    type(gear_spec_t) :: spec
    type(gear_t) :: gear
    type(error_t), allocatable :: error

    spec = spec_of(25, 0.0_dp)
    spec%tip_chamfer = 2*mm
    call make_gear(spec, gear, error)
    call check_error(t, 'a chamfer as wide as the tip', error, 'pinion tip chamfer (mm) = 2: takes the whole tip')
    spec%tip_chamfer = 6*mm
    call make_gear(spec, gear, error)
    call check_error(t, 'a chamfer down to the fillet', error, 'no involute is left between fillet and tip with this chamfer')
    spec%tip_chamfer = 0
    spec%tip_rounding = 6*mm
    call make_gear(spec, gear, error)
    call check_error(t, 'a rounding as high as the tooth', error, 'pinion tip rounding (mm) = 6')
    spec%tip_rounding = 2.2_dp*mm
    call make_gear(spec, gear, error)
    call check_error(t, 'a rounding as wide as the tip', error, 'pinion tip rounding (mm) = 2.2: takes the whole tip')
    spec%tip_rounding = 0
    spec%tip_form_diameter = 81.1_dp*mm
    call make_gear(spec, gear, error)
    call check_error(t, 'involute beyond the tip', error, 'tip form diameter (mm) = 81.1: must be at most the tip diameter 81')
    spec%tip_form_diameter = 0
    spec%tip_diameter = 70*mm
    call make_gear(spec, gear, error)
    call check_error(t, 'tip below the fillet', error, 'pinion tip diameter (mm) = 70: no involute is left')
    spec%tip_diameter = 95*mm
    call make_gear(spec, gear, error)
    call check_error(t, 'tip beyond the point', error, 'pinion tip diameter (mm) = 95: pointed teeth')
    spec%tip_diameter = 0
    spec%thinning = -3
    call make_gear(spec, gear, error)
    call check_error(t, 'thinned away', error, 'leaves no tooth as thin as generating shift or allowance make it')
  end subroutine tips_that_are_refused
end module test_measures
