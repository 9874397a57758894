!> Compliance of a pair of teeth whose tip corner is in contact, before and behind the path of contact.
!>
!> The tooth whose corner touches is loaded there along the normal of the mate's flank, the mate where it is met. Both
!> bodies' finite elements give what lies deeper than the contact, and an edge on a cylinder what lies above.
module gearsweep_corner_stiffness
  use gearsweep_corner, only: corner_contact, corner_t
  use gearsweep_edge_contact, only: edge_compliance, edge_t, make_edge
  use gearsweep_error, only: error_t
  use gearsweep_flattening, only: contact_half_width
  use gearsweep_gear, only: drive
  use gearsweep_kinds, only: dp
  use gearsweep_pair, only: pair_t
  use gearsweep_material, only: material_t
  use gearsweep_tooth_compliance, only: most_tilt, tooth_t
  implicit none
  private
  public :: corner_compliance, compliance_slope, moved_contact, edge_zone

contains

  !> Compliance (m2/N) of the pair at the path coordinates `s` beyond A or E, all on one side, under each `line_load` (N/m; the
  !> largest first), the secant; (place, load). At A and E themselves the contact is cut in half. It is along the line of action:
  !> deflection and load along the mate's normal are both `part_along` (corner_t) of what they are there, that is, the one is that
  !> part of the other.
  subroutine corner_compliance(pair, tooth, material, plane_strain, line_load, s, compliance, error)
    type(pair_t), intent(in) :: pair
    type(tooth_t), intent(in) :: tooth(2)
    type(material_t), intent(in) :: material(2)
    logical, intent(in) :: plane_strain
    real(dp), intent(in) :: line_load(:), s(:)
    real(dp), intent(out) :: compliance(:, :)
    type(error_t), allocatable, intent(out) :: error
    type(edge_t) :: edge
    type(corner_t) :: corner
    real(dp) :: tip, end_of_path, close_up, curvature(2)
    integer :: k, l, member

    member = merge(2, 1, sum(s) < 0)
    end_of_path = merge(0.0_dp, pair%contact_ratio, member == 2)
    tip = pair%curvature(member, end_of_path)
    compliance = 0
    call make_edge(material([member, 3 - member]), plane_strain, pair%gear(member)%edge_angle(drive, tip), &
                   tooth(member)%corner_depth, contact_half_width(material(1), material(2), plane_strain, line_load(1), tip, &
                   pair%curvature(3 - member, end_of_path)), edge, error)
    do k = 1, size(s)
      corner = corner_contact(pair, s(k))
      curvature(member) = tip
      curvature(3 - member) = corner%curvature
      do l = 1, size(line_load)
        if (allocated(error)) return
        call edge_compliance(edge, line_load(l), corner%tilt, 1/tip + 1/corner%curvature, &
                             merge(-1, 1, member == 2)*compliance_slope(pair, tooth, curvature), pair%gear(1)%spec%module, &
                             close_up, error)
        compliance(k, l) = tooth(member)%corner%value(min(most_tilt, corner%tilt)) &
                           + tooth(3 - member)%compliance%value(corner%curvature) + close_up
      end do
      compliance(k, :) = compliance(k, :)/corner%part_along**2
    end do
  end subroutine corner_compliance

  !> How the compliance of a pair without its flattening changes as the contact moves along the flanks towards the pinion's tip,
  !> per length of flank (m/N). `curvature` (m): radii of curvature of both drive flanks where they touch.
  pure real(dp) function compliance_slope(pair, tooth, curvature) result(slope)
    type(pair_t), intent(in) :: pair
    type(tooth_t), intent(in) :: tooth(2)
    real(dp), intent(in) :: curvature(2)
    integer :: i

    slope = 0
    do i = 1, 2
      ! The arc of an involute grows with the square of its radius of curvature.
      slope = slope + merge(1, -1, i == 1)*tooth(i)%compliance%slope(curvature(i))*pair%gear(i)%base_radius(drive)/curvature(i)
    end do
  end function compliance_slope

  !> By how much a pair deflects less (m2/N) under `line_load` (N/m), as its contact moves to where the teeth are stiffer.
  !>
  !> A load F at the place u of the flanks turns them against each other by F C'/2 there, with the slope C' of the compliance: by
  !> reciprocity half of it is due to where the load is, half to where the displacement is seen. Where the curvature 1/R of both
  !> flanks together makes up for that, they touch: u = -F C' R/2, and F C + u**2/(2 R) is less by 3/8 F**2 C'**2 R. F is taken as
  !> what a pair carries near the path's ends, where C' is largest: 0.2 to 0.4 of the whole load.
  pure real(dp) function moved_contact(line_load, slope, curvature) result(less)
    real(dp), intent(in) :: line_load
    real(dp), intent(in) :: slope                !< of `compliance_slope`, m/N
    real(dp), intent(in) :: curvature(2)         !< radii of curvature of both flanks, m
    real(dp), parameter :: share = 0.3_dp

    less = 3*share*line_load*slope**2/(8*sum(1/curvature))
  end function moved_contact

  !> How far from A and from E, in base pitches, a contact within the path feels the edge under `line_load` (N/m).
  pure function edge_zone(pair, material, plane_strain, line_load) result(zone)
    type(pair_t), intent(in) :: pair
    type(material_t), intent(in) :: material(2)
    logical, intent(in) :: plane_strain
    real(dp), intent(in) :: line_load
    real(dp) :: zone(2)
    !> Between an edge on a cylinder and the same on a half plane nearly nothing is left so many half widths of Hertz's contact
    !> from the edge (suite elastic_corner).
    real(dp), parameter :: half_widths = 1.4_dp
    real(dp) :: tip, arc
    integer :: i

    do i = 1, 2
      associate (member => 3 - i, s => merge(0.0_dp, pair%contact_ratio, i == 1))
        tip = pair%curvature(member, s)
        arc = half_widths*contact_half_width(material(1), material(2), plane_strain, line_load, pair%curvature(1, s), &
                                             pair%curvature(2, s))
        ! The arc of an involute grows with the square of its radius of curvature.
        zone(i) = (tip - sqrt(max(0.0_dp, tip**2 - 2*pair%gear(member)%base_radius(drive)*arc)))/pair%base_pitch
      end associate
    end do
    zone = min(zone, pair%contact_ratio/8)
  end function edge_zone
end module gearsweep_corner_stiffness
