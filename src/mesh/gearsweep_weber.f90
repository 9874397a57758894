!> Pair stiffness after Weber and Banaschek: each tooth bends as a beam of
!> varying thickness on an elastic half-plane, and the flanks flatten as in
!> Hertz's line contact; plane strain.
!> Source: Weber, Banaschek 1953 (Formaenderung und Profilruecknahme bei gerad-
!> und schraegverzahnten Raedern), with general Poisson ratio.
module gearsweep_weber
  use gearsweep_kinds, only: dp, pi
  use gearsweep_error, only: error_t
  use gearsweep_piecewise, only: piecewise_t, spline
  use gearsweep_flattening, only: contact_half_width, surface_to_depth, check_contact
  use gearsweep_material, only: material_t
  use gearsweep_gear, only: gear_t, drive, coast
  use gearsweep_outline, only: involute_point, fillet_point, fillet_parameter
  use gearsweep_pair, only: pair_t
  use gearsweep_stiffness, only: check_positive
  implicit none
  private
  public :: weber_stiffness

  !> A tooth as a beam: half widths over the height, from the section where the
  !> fillet's tangent makes 30 degrees with the axis.
  type :: beam_t
    type(piecewise_t) :: half_width(2)
    real(dp) :: root = 0
  end type beam_t

contains

  !> K(s) in N/m for pinion and gear of these materials under `line_load` (N/m), on
  !> which only the flattening depends.
  pure subroutine weber_stiffness(pair, material, line_load, curve, error)
    type(pair_t), intent(in) :: pair
    type(material_t), intent(in) :: material(2)
    real(dp), intent(in) :: line_load
    type(piecewise_t), intent(out) :: curve
    type(error_t), allocatable, intent(out) :: error
    integer, parameter :: points = 33
    type(beam_t) :: beam(2)
    real(dp) :: s(points), stiffness(points)
    integer :: i

    beam(1) = tooth_beam(pair%gear(1))
    beam(2) = tooth_beam(pair%gear(2))
    s = [(pair%contact_ratio*i/(points - 1), i=0, points - 1)]
    call check_contact(maxval(contact_half_width(material(1), material(2), .true., line_load, pair%curvature(1, s), &
                                                 pair%curvature(2, s))), &
                       pair%gear(1)%spec%module, line_load, error)
    if (allocated(error)) return
    do i = 1, points
      stiffness(i) = minval(pair%gear%spec%face_width)/compliance(s(i))
    end do
    curve = spline(s, stiffness)
    call check_positive(curve, 'model', error)

  contains

    !> Deflection of the pair per line load (m^2/N) at path coordinate s.
    pure real(dp) function compliance(s)
      real(dp), intent(in) :: s
      real(dp) :: tooth(2), depth(2), width
      integer :: i

      do i = 1, 2
        call load_tooth(pair%gear(i), beam(i), material(i), pair%radius(i, s), tooth(i), depth(i))
      end do
      width = contact_half_width(material(1), material(2), .true., line_load, pair%curvature(1, s), pair%curvature(2, s))
      compliance = sum(tooth) + sum(surface_to_depth(material, .true., width, depth))
    end function compliance
  end subroutine weber_stiffness

  !> Samples fillet and involute of both flanks.
  pure function tooth_beam(gear) result(beam)
    type(gear_t), intent(in) :: gear
    type(beam_t) :: beam
    integer, parameter :: fillet = 12, flank = 20
    real(dp) :: points(2, fillet + flank), from, part
    integer :: side, i

    beam%root = 0
    do side = drive, coast
      from = fillet_parameter(gear, side, pi/6)
      do i = 1, fillet
        part = (i - 1.0_dp)/fillet
        points(:, i) = fillet_point(gear, side, from + (gear%fillet_start(side) - from)*part)
      end do
      do i = 1, flank
        part = (i - 1.0_dp)/(flank - 1)
        points(:, fillet + i) = involute_point(gear, side, gear%form_radius(side) &
                                               + (gear%tip_radius - gear%form_radius(side))*part**2)
      end do
      beam%half_width(side) = spline(points(2, :), points(1, :))
      beam%root = max(beam%root, points(2, 1))
    end do
  end function tooth_beam

  !> Bending, shear, compression and foundation of one tooth (m^2/N), for a
  !> load normal to the drive flank at `radius`; `depth` is the length of the
  !> load line from the flank to the tooth axis, m.
  pure subroutine load_tooth(gear, beam, material, radius, compliance, depth)
    type(gear_t), intent(in) :: gear
    type(beam_t), intent(in) :: beam
    type(material_t), intent(in) :: material
    real(dp), intent(in) :: radius
    real(dp), intent(out) :: compliance, depth
    real(dp) :: angle, height, root_width, bending, shear, lever

    lever = gear%half_angle(drive, radius)
    angle = acos(gear%base_radius(drive)/radius) - lever
    depth = radius*sin(lever)/cos(angle)
    height = gear%base_radius(drive)/cos(angle) - beam%root
    root_width = width(beam, beam%root)
    call beam_integrals(beam, height, bending, shear)
    associate (nu => material%poisson, t => tan(angle)**2, ratio => height/root_width)
      compliance = cos(angle)**2*(1 - nu**2)/material%young &
        *(12*bending + (2.4_dp/(1 - nu) + t)*shear &
          + 18/pi*ratio**2 + 2*(1 - 2*nu)/(1 - nu)*ratio + 4.8_dp/pi*(1 + (1 - nu)/2.4_dp*t))
    end associate
  end subroutine load_tooth

  !> Integrals over the height of (height - y)^2/width^3 and 1/width, by Gauss.
  pure subroutine beam_integrals(beam, height, bending, shear)
    type(beam_t), intent(in) :: beam
    real(dp), intent(in) :: height
    real(dp), intent(out) :: bending, shear
    integer, parameter :: intervals = 12
    real(dp), parameter :: node(3) = [-sqrt(0.6_dp), 0.0_dp, sqrt(0.6_dp)], weight(3) = [5, 8, 5]/18.0_dp
    real(dp) :: y, w, step
    integer :: i, k

    bending = 0
    shear = 0
    step = height/intervals
    do i = 1, intervals
      do k = 1, 3
        y = step*(i - 0.5_dp + node(k)/2)
        w = width(beam, beam%root + y)
        bending = bending + step*weight(k)*(height - y)**2/w**3
        shear = shear + step*weight(k)/w
      end do
    end do
  end subroutine beam_integrals

  pure real(dp) function width(beam, y)
    type(beam_t), intent(in) :: beam
    real(dp), intent(in) :: y

    width = beam%half_width(drive)%value(y) + beam%half_width(coast)%value(y)
  end function width
end module gearsweep_weber
