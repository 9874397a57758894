!> One spur gear, as its basic rack generates it (ISO 21771, ISO 53).
!>
!> Each flank has its own pressure angle: `drive` sets the path of contact,
!> `coast` only the tooth thickness. Lengths in m, angles in rad.
module gearsweep_gear
  use gearsweep_kinds, only: dp, pi
  use gearsweep_error, only: error_t, fail, code_input
  use gearsweep_text, only: str
  implicit none
  private
  public :: gear_t, gear_spec_t, make_gear, involute

  integer, parameter, public :: drive = 1, coast = 2

  !> What the designer states. Factors are in modules.
  type :: gear_spec_t
    character(6) :: name = ''                    !< for messages: pinion or gear
    integer :: teeth = 0
    real(dp) :: module = 0
    real(dp) :: pressure_angle(2) = 20*pi/180    !< of the rack: drive, coast
    real(dp) :: profile_shift = 0                !< x
    real(dp) :: addendum = 1                     !< h_aP*
    real(dp) :: dedendum = 1.25_dp               !< h_fP*
    real(dp) :: rack_tip_radius = 0.25_dp        !< rho_fP*
    real(dp) :: tip_alteration = 0               !< k*, negative where the tip is cut back
    real(dp) :: face_width = 0
    real(dp) :: bore_radius = 0
  end type gear_spec_t

  !> What follows from it.
  type :: gear_t
    type(gear_spec_t) :: spec
    real(dp) :: reference_radius = 0
    real(dp) :: base_radius(2) = 0
    real(dp) :: tip_radius = 0
    real(dp) :: root_radius = 0
    real(dp) :: form_radius(2) = 0               !< where the fillet ends and the involute begins
    real(dp) :: tip_form_radius = 0              !< where the involute ends at the tip, d_Na/2
  contains
    procedure :: half_angle
    procedure :: thickness
    procedure :: curvature
  end type gear_t

contains

  !> inv(angle) = tan(angle) - angle.
  elemental real(dp) function involute(angle)
    real(dp), intent(in) :: angle

    involute = tan(angle) - angle
  end function involute

  !> Derives the radii and refuses what cannot be cut: a rack whose tip radius
  !> does not fit, undercut, pointed teeth, a bore that reaches the root.
  !> Source: ISO 21771:2007, sections 4 and 7.
  subroutine make_gear(spec, gear, error)
    type(gear_spec_t), intent(in) :: spec
    type(gear_t), intent(out) :: gear
    type(error_t), allocatable, intent(out) :: error

    call check_spec(spec, error)
    if (allocated(error)) return
    gear%spec = spec
    associate (m => spec%module, r => gear%reference_radius)
      r = spec%teeth*m/2
      gear%base_radius = r*cos(spec%pressure_angle)
      gear%tip_radius = r + (spec%addendum + spec%profile_shift + spec%tip_alteration)*m
      gear%tip_form_radius = gear%tip_radius
      gear%root_radius = r - (spec%dedendum - spec%profile_shift)*m
    end associate
    call check_rack_tip(spec, error)
    call find_form_radius(gear, error)
    call check_tooth(gear, error)
  end subroutine make_gear

  subroutine check_spec(spec, error)
    type(gear_spec_t), intent(in) :: spec
    type(error_t), allocatable, intent(inout) :: error
    integer, parameter :: fewest = 5

    call demand(spec%teeth >= fewest, 'teeth', str(spec%teeth), 'must be at least '//str(fewest))
    call demand(spec%module > 0, 'module', str(spec%module), 'must be above 0')
    call demand(spec%face_width > 0, 'face width', str(spec%face_width), 'must be above 0')
    call demand(all(spec%pressure_angle > 0.05_dp .and. spec%pressure_angle < 0.8_dp), 'pressure angle', &
                str(spec%pressure_angle(1)), 'must lie between 0.05 and 0.8 rad')
    call demand(spec%addendum > 0, 'addendum', str(spec%addendum), 'must be above 0')
    call demand(spec%dedendum > 0, 'dedendum', str(spec%dedendum), 'must be above 0')
    call demand(spec%rack_tip_radius >= 0, 'rack_tip_radius', str(spec%rack_tip_radius), 'must be at least 0')
    call demand(abs(spec%profile_shift) < 5, 'profile_shift', str(spec%profile_shift), 'must lie between -5 and 5')

  contains

    subroutine demand(met, key, value, allowed)
      logical, intent(in) :: met
      character(*), intent(in) :: key, value, allowed

      if (.not. met) call fail(error, code_input, '&'//trim(spec%name)//' '//key//' = '//value//': '//allowed)
    end subroutine demand
  end subroutine check_spec

  !> The rounded corners of the rack's tooth must leave its tip land.
  pure subroutine check_rack_tip(spec, error)
    type(gear_spec_t), intent(in) :: spec
    type(error_t), allocatable, intent(inout) :: error
    real(dp) :: land, taken

    associate (angle => spec%pressure_angle)
      land = sum(pi/4 - spec%dedendum*tan(angle))
      taken = sum((1 - sin(angle))/cos(angle))
    end associate
    if (land < 0) then
      call fail(error, code_input, '&'//trim(spec%name)//' dedendum = '//str(spec%dedendum)// &
        ': the rack tooth is pointed above '//str(pi/2/sum(tan(spec%pressure_angle))))
    else if (spec%rack_tip_radius*taken > land*(1 + 1e-12_dp)) then
      call fail(error, code_input, '&'//trim(spec%name)//' rack_tip_radius = '//str(spec%rack_tip_radius)// &
        ': does not fit the rack; at most '//str(land/taken))
    end if
    if (spec%rack_tip_radius > spec%dedendum) call fail(error, code_input, '&'//trim(spec%name)// &
      ' rack_tip_radius = '//str(spec%rack_tip_radius)//': must not exceed the dedendum')
  end subroutine check_rack_tip

  !> The involute begins where the rack's straight flank ends; beyond the base
  !> circle the rack would cut it away again.
  pure subroutine find_form_radius(gear, error)
    type(gear_t), intent(inout) :: gear
    type(error_t), allocatable, intent(inout) :: error
    real(dp) :: depth, curvature, least
    integer :: side

    do side = drive, coast
      associate (spec => gear%spec, angle => gear%spec%pressure_angle(side))
        depth = spec%dedendum - spec%rack_tip_radius*(1 - sin(angle))
        curvature = gear%reference_radius*sin(angle) &
                    - (depth - spec%profile_shift)*spec%module/sin(angle)
        gear%form_radius(side) = hypot(gear%base_radius(side), max(curvature, 0.0_dp))
        if (curvature < -1e-12_dp*gear%reference_radius) then
          least = depth - spec%teeth*sin(angle)**2/2
          call fail(error, code_input, '&'//trim(spec%name)//' profile_shift = '//str(spec%profile_shift)// &
            ': undercut with '//str(spec%teeth)//' teeth; must be at least '//str(least))
        end if
      end associate
    end do
  end subroutine find_form_radius

  pure subroutine check_tooth(gear, error)
    type(gear_t), intent(in) :: gear
    type(error_t), allocatable, intent(inout) :: error
    character(:), allocatable :: group

    group = '&'//trim(gear%spec%name)//' '
    if (.not. gear%spec%bore_radius >= 0 .or. gear%spec%bore_radius >= gear%root_radius) then
      call fail(error, code_input, group//'bore_mm = '//str(2000*gear%spec%bore_radius)// &
      ': must be at least 0 and below the root diameter '//str(2000*gear%root_radius)//' mm')
    end if
    if (gear%tip_radius <= maxval(gear%form_radius)) then
      call fail(error, code_input, group//'addendum = '//str(gear%spec%addendum)// &
        ': no involute is left between fillet and tip')
    else if (gear%thickness(gear%tip_radius) <= 0) then
      call fail(error, code_input, group//'addendum = '//str(gear%spec%addendum)// &
        ': pointed teeth; the tip diameter must stay below '//str(2000*pointed_radius(gear))//' mm')
    end if
  end subroutine check_tooth

  !> Radius at which the two flanks meet, by bisection.
  pure real(dp) function pointed_radius(gear)
    type(gear_t), intent(in) :: gear
    real(dp) :: low, high
    integer :: i

    low = maxval(gear%form_radius)
    high = gear%tip_radius
    do i = 1, 60
      pointed_radius = (low + high)/2
      if (gear%thickness(pointed_radius) > 0) then
        low = pointed_radius
      else
        high = pointed_radius
      end if
    end do
  end function pointed_radius

  !> Angle from the tooth axis to the involute at `radius` (m), rad. The axis
  !> halves the reference thickness of the unshifted tooth.
  elemental real(dp) function half_angle(gear, side, radius)
    class(gear_t), intent(in) :: gear
    integer, intent(in) :: side
    real(dp), intent(in) :: radius

    associate (angle => gear%spec%pressure_angle(side))
      half_angle = (pi/2 + 2*gear%spec%profile_shift*tan(angle))/gear%spec%teeth + involute(angle) &
                   - involute(acos(min(1.0_dp, gear%base_radius(side)/radius)))
    end associate
  end function half_angle

  !> Tooth thickness along the circle of `radius` (m), on the involutes.
  elemental real(dp) function thickness(gear, radius)
    class(gear_t), intent(in) :: gear
    real(dp), intent(in) :: radius

    thickness = radius*(gear%half_angle(drive, radius) + gear%half_angle(coast, radius))
  end function thickness

  !> Radius of curvature of a flank at `radius` (m): the length of its generating line.
  elemental real(dp) function curvature(gear, side, radius)
    class(gear_t), intent(in) :: gear
    integer, intent(in) :: side
    real(dp), intent(in) :: radius

    curvature = sqrt(max(0.0_dp, (radius - gear%base_radius(side))*(radius + gear%base_radius(side))))
  end function curvature
end module gearsweep_gear
