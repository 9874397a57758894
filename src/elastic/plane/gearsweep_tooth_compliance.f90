!> Compliance of one tooth on its body, from finite elements of a section, along its drive flank and at its tip corner.
module gearsweep_tooth_compliance
  use gearsweep_kinds, only: dp, pi
  use gearsweep_body, only: body_t, make_body
  use gearsweep_compliance, only: corner_deflection, deflection_at_depth
  use gearsweep_disc, only: disc_t
  use gearsweep_disc_compliance, only: disc_compliance
  use gearsweep_elastic_options, only: fe_options_t, section_options_t
  use gearsweep_error, only: error_t
  use gearsweep_flattening, only: surface_to_depth
  use gearsweep_gear, only: gear_t, drive
  use gearsweep_material, only: material_t
  use gearsweep_piecewise, only: piecewise_t, spline
  use gearsweep_section, only: section_t, make_section
  implicit none
  private
  public :: fe_options_t, tooth_t, tooth_compliance

  !> Compliances are per line load, m2/N.
  type :: tooth_t
    !> Over the radius of curvature of the drive flank (m), less `surface_to_depth` for the depth of one module. Of a
    !> whole gear also less what it turns about its bore, which `disc` has instead.
    type(piecewise_t) :: compliance
    type(disc_t) :: disc
    !> Of the tip corner, over the tilt of the load against the flank's normal there (rad): as the grid has it at
    !> `corner_depth` (m), twice, less that at twice the depth, along the load.
    type(piecewise_t) :: corner
    real(dp) :: corner_depth = 0
  end type tooth_t

  !> Tilts of the load at the tip corner.
  real(dp), parameter, public :: most_tilt = 0.4_dp
  integer, parameter :: tilts = 6

contains

  !> The `tooth` of `gear` over the radius of curvature of its drive flank from `first` to that of its tip, `last` (m).
  !>
  !> Seen from two depths, h and 2 h, and extrapolated to depth 0: what the
  !> grid adds to the half plane between surface and depth is linear in h.
  !> Near the tip h shrinks with the tooth.
  subroutine tooth_compliance(gear, material, options, first, last, tooth, error)
    type(gear_t), intent(in) :: gear
    type(material_t), intent(in) :: material
    type(fe_options_t), intent(in) :: options
    real(dp), intent(in) :: first, last
    type(tooth_t), intent(out) :: tooth
    type(error_t), allocatable, intent(out) :: error
    type(section_t) :: section
    type(body_t) :: body
    real(dp), dimension(max(4, options%positions)) :: curvature, radius, depth, near, far
    integer :: i, n

    call make_section(gear, options%section, section, error)
    if (allocated(error)) return
    call make_body(section%grid, material, options%section%plane_strain, 1.0_dp, &
                   spread(section%is_held(), 1, 2), options%section%most_memory, body, error)
    if (allocated(error)) return
    ! Denser towards the tip, where the compliance climbs.
    n = size(curvature)
    curvature = [(sin(pi/2*i/(n - 1)), i=0, n - 1)]
    curvature = first + (last - first)*curvature
    radius = min(hypot(gear%base_radius(drive), curvature), gear%tip_radius)
    depth = smaller(options%depth*gear%spec%module, 0.35_dp*chord(gear, radius))
    call deflection_at_depth(section, body, radius, depth, 2*depth, near, far, error)
    if (allocated(error)) return
    if (section%grid%closed .or. options%tooth_coupling) call disc_compliance(section, body, first, last, tooth%disc, error)
    if (options%corner_contact .and. .not. allocated(error)) &
      call corner_compliance(section, body, radius(n), depth(n), tooth, error)
    if (allocated(error)) return
    ! Beside a held side of a section of two, the next tooth may move the other way, by next to nothing.
    if (.not. (options%tooth_coupling .and. tooth%disc%shared > 0)) tooth%disc = disc_t(turn=tooth%disc%turn)
    near = near + surface_to_depth(material, options%section%plane_strain, gear%spec%module, depth)
    far = far + surface_to_depth(material, options%section%plane_strain, gear%spec%module, 2*depth)
    tooth%compliance = spline(curvature, 2*near - far + offset(material, options%section%plane_strain) - tooth%disc%turn)
  end subroutine tooth_compliance

  !> The tip corner under loads of all tilts.
  subroutine corner_compliance(section, body, radius, depth, tooth, error)
    type(section_t), intent(in) :: section
    type(body_t), intent(in) :: body
    real(dp), intent(in) :: radius, depth
    type(tooth_t), intent(inout) :: tooth
    type(error_t), allocatable, intent(inout) :: error
    real(dp), dimension(tilts) :: tilt, lever, near, far
    integer :: i

    tilt = [(most_tilt*i/(tilts - 1), i=0, tilts - 1)]
    call corner_deflection(section, body, radius, depth, tilt, near, far, error)
    if (allocated(error)) return
    ! Lever arm of a tilted load over the base radius: the gear body rotates under its couple and moves the corner less by that.
    associate (angle => acos(min(1.0_dp, section%gear%base_radius(drive)/radius)))
      lever = cos(angle + tilt)/cos(angle)
    end associate
    tooth%corner_depth = depth
    tooth%corner = spline(tilt, 2*near - far - tooth%disc%turn*lever**2)
  end subroutine corner_compliance

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
end module gearsweep_tooth_compliance
