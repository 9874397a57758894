!> Deflection of the pinion's shaft over the face width: twist and bending under an even load.
module gearsweep_face_shaft
  use gearsweep_base, only: code_input, dp, error_t, fail, pi, str
  implicit none
  private
  public :: shaft_t, check_shaft

  integer, parameter, public :: near = 1, far = 2

  !> Shaft of the pinion on two bearings, with the pinion between them. Places count along the shaft as z does along the face.
  type :: shaft_t
    real(dp) :: diameter = 0                     !< shaft diameter, m
    real(dp) :: span = 0                         !< distance between the bearings, m; 0: no shaft
    real(dp) :: offset = 0                       !< place of the middle of the face from the middle between the bearings, m
    integer :: torque_side = near                !< end of the face where the torque enters: near (z = 0) or far (z = b)
    real(dp) :: pinion_diameter = 0              !< reference diameter of the pinion, m
    !> Diameter of the pinion that twists, m: the reference diameter less the dedendum of the rack on one side.
    real(dp) :: core_diameter = 0
    real(dp) :: base_radius = 0                  !< of the pinion, m
    real(dp) :: young = 206e9_dp, poisson = 0.3_dp         !< E, Pa, and nu
  contains
    procedure :: gap
    procedure :: offset_to_torque
  end type shaft_t

  !> Mean shear over the largest of a circular section. Source: Timoshenko 1955, Strength of Materials I, section 39.
  real(dp), parameter :: shear_form = 10/9.0_dp

contains

  !> Place of the face from the middle between the bearings towards the end where the torque enters, m.
  pure real(dp) function offset_to_torque(shaft)
    class(shaft_t), intent(in) :: shaft

    offset_to_torque = merge(-1, 1, shaft%torque_side == near)*shaft%offset
  end function offset_to_torque

  !> Gap (m) between the flanks at places `z` along a face `width`, m, under an even `load` (N on the line of action): 0 where they
  !> are nearest. Twist brings them nearer where the torque enters, bending at both ends of the face and next to a bearing.
  pure function gap(shaft, load, width, z)
    class(shaft_t), intent(in) :: shaft
    real(dp), intent(in) :: load, width, z(:)
    real(dp) :: gap(size(z))

    gap = 0
    if (.not. shaft%span > 0) return
    gap = twist(shaft, load, width, merge(z, width - z, shaft%torque_side == near)) + bending(shaft, load, width, z)
    gap = gap - minval(gap)
  end function gap

  !> Displacement of the flank (m) by twist, at distances `y` (m) from the end of the face where the torque enters.
  elemental real(dp) function twist(shaft, load, width, y)
    type(shaft_t), intent(in) :: shaft
    real(dp), intent(in) :: load, width, y

    twist = load*shaft%base_radius**2/(shear_modulus(shaft)*pi*shaft%core_diameter**4/32)*(y - y**2/(2*width))
  end function twist

  pure real(dp) function shear_modulus(shaft)
    type(shaft_t), intent(in) :: shaft

    shear_modulus = shaft%young/(2*(1 + shaft%poisson))
  end function shear_modulus

  !> Deflection (m) at places `z` of the face of a shaft on two supports, by bending and shear: integrals of the bending moment
  !> over shaft, pinion and shaft, each from its left end.
  pure function bending(shaft, load, width, z) result(deflection)
    type(shaft_t), intent(in) :: shaft
    real(dp), intent(in) :: load, width, z(:)
    real(dp) :: deflection(size(z))
    real(dp) :: left, right, near_force, far_force, slope, start, at_end, end_slope, thin, thick, shear_thin, shear_thick

    left = shaft%span/2 + shaft%offset - width/2
    right = shaft%span - left - width
    near_force = load*(right + width/2)/shaft%span
    far_force = load - near_force
    thin = 64/(shaft%young*pi*shaft%diameter**4)
    thick = 64/(shaft%young*pi*shaft%pinion_diameter**4)
    shear_thin = shear_form*4/(shear_modulus(shaft)*pi*shaft%diameter**2)
    shear_thick = shear_form*4/(shear_modulus(shaft)*pi*shaft%pinion_diameter**2)
    slope = -thin*near_force*left**2/2
    start = -thin*near_force*left**3/6 + shear_thin*near_force*left
    end_slope = slope - thick*(near_force*left*width + near_force*width**2/2 - load*width**2/6)
    at_end = start + slope*width + over_pinion(width)
    at_end = at_end + end_slope*right - thin*far_force*right**3/3 - shear_thin*far_force*right
    deflection = start + slope*z + over_pinion(z) - at_end*(left + z)/shaft%span

  contains

    !> Deflection within the pinion, less that of its left end and the slope there.
    elemental real(dp) function over_pinion(t)
      real(dp), intent(in) :: t

      over_pinion = -thick*(near_force*left*t**2/2 + near_force*t**3/6 - load/width*t**4/24) &
                    + shear_thick*(near_force*t - load/width*t**2/2)
    end function over_pinion
  end function bending

  !> Refuses a pinion that is not between its bearings.
  pure subroutine check_shaft(shaft, width, error)
    type(shaft_t), intent(in) :: shaft
    real(dp), intent(in) :: width                !< face width, m
    type(error_t), allocatable, intent(inout) :: error

    if (.not. shaft%span > 0) return
    if (.not. (shaft%diameter > 0 .and. shaft%pinion_diameter > 0 .and. shaft%core_diameter > 0)) then
      call fail(error, code_input, 'shaft diameter (mm) = '//str(1000*shaft%diameter)//': must be above 0, as those of the pinion')
    else if (.not. abs(shaft%offset) <= (shaft%span - width)/2) then
      call fail(error, code_input, 'bearing offset (mm) = '//str(1000*shaft%offset)//': a face of '//str(1000*width)// &
                ' mm is not between bearings '//str(1000*shaft%span)// &
                ' mm apart; for an overhung pinion state the misalignment')
    end if
  end subroutine check_shaft
end module gearsweep_face_shaft
