!> Hertzian line contact: approach of the flank's surface and a depth, and the change of that approach with the load.
!>
!> The flattening grows less than in proportion to the load: by Hertz the flattening over the load falls with the load's
!> logarithm, alike along the path of contact. Where a tip corner is in contact it falls faster, because a smaller load acts
!> nearer to the edge: up to two and a half times as fast where the edge alone touches.
module gearsweep_elastic_flattening
  use gearsweep_base, only: code_input, dp, error_t, fail, pi, str
  use gearsweep_elastic_material, only: harmonic_mean, material_t
  implicit none
  private
  public :: contact_half_width, surface_to_depth, load_dependence, check_contact, flattening_t, even_flattening, edge_share

  !> Decrease of the compliance of a pair per factor e of its load, m/N. Arrays: at or before A, at or after E.
  type :: flattening_t
    real(dp) :: within = 0                       !< decrease along the path
    real(dp) :: at_end(2) = 0                    !< decrease at A and E, where the contact ends at the edge
    real(dp) :: beyond(2) = 0                    !< decrease far beyond, where the edge alone touches
    real(dp) :: zone(2) = 0                      !< length of path from A and from E with an effect of the edge, base pitches
    real(dp) :: length(2) = 1                    !< length in which the difference from `beyond` falls by a factor e, base pitches
  contains
    procedure :: at
    procedure :: scaled
  end type flattening_t

contains

  !> Half width (m) of the contact of two bodies of these materials under `line_load` (N/m), with the radii of curvature `r1`,
  !> `r2` (m). With the modulus E* of the contact, 1/E* = (1 - nu1**2)/E1 + (1 - nu2**2)/E2 in plane strain, without the squares
  !> in plane stress.
  !> Source: Johnson 1985, Contact Mechanics, Eqs. 4.21 and 4.43.
  elemental real(dp) function contact_half_width(first, second, plane_strain, line_load, r1, r2) result(a)
    type(material_t), intent(in) :: first, second
    logical, intent(in) :: plane_strain
    real(dp), intent(in) :: line_load, r1, r2
    real(dp) :: modulus

    modulus = harmonic_mean(half_modulus(first, plane_strain), half_modulus(second, plane_strain))
    a = sqrt(4*line_load*r1*r2/((r1 + r2)*pi*modulus))
  end function contact_half_width

  !> Half of a body's modulus, Pa: the modulus of a contact of two equal bodies.
  elemental real(dp) function half_modulus(material, plane_strain)
    type(material_t), intent(in) :: material
    logical, intent(in) :: plane_strain

    half_modulus = material%young/2
    if (plane_strain) half_modulus = half_modulus/(1 - material%poisson**2)
  end function half_modulus

  !> Refuses a `line_load` (N/m) whose contact, of this largest half width (m), is wider than one module (m): then a tooth is not
  !> like a half plane.
  pure subroutine check_contact(half_width, module, line_load, error)
    real(dp), intent(in) :: half_width, module, line_load
    type(error_t), allocatable, intent(inout) :: error

    if (.not. 2*half_width <= module) call fail(error, code_input, 'line load (N/mm) = '//str(line_load/1000)// &
      ' (the load over the face width): flattens the flanks over '//str(2000*half_width, 3)// &
      ' mm, where Hertz''s contact does not hold; must be at most '//str(line_load/1000*(module/(2*half_width))**2, 3))
  end subroutine check_contact

  !> Displacement (m2/N, per line load) in a half plane of the middle of the contact under Hertz's pressure over the half width
  !> `a` (m), relative to the point at `depth` (m) below a point load. Added to a grid's displacement under a point load, this is
  !> the deflection of the surface; the depth under Hertz's pressure would differ by (a/h)**2/4. Source: Weber, Banaschek 1953;
  !> Johnson 1985, Eq. 5.57; for plane stress with E and nu in place of E/(1 - nu**2) and nu/(1 - nu).
  elemental real(dp) function surface_to_depth(material, plane_strain, a, depth) result(deflection)
    type(material_t), intent(in) :: material
    logical, intent(in) :: plane_strain
    real(dp), intent(in) :: a, depth

    associate (nu => material%poisson)
      if (plane_strain) then
        deflection = (1 + nu)*((1 - nu)*2*log(2*depth/a) - nu)
      else
        deflection = 2*log(2*depth/a) - nu
      end if
    end associate
    deflection = deflection/(pi*material%young)
  end function surface_to_depth

  !> Decrease of the flattening of one flank of a pair over its load (m2/N, per line load) per factor e of the load: the contact's
  !> half width grows with the root of the load, and the flattening falls with its logarithm, alike along the path of contact.
  elemental real(dp) function load_dependence(material, plane_strain)
    type(material_t), intent(in) :: material
    logical, intent(in) :: plane_strain
    real(dp), parameter :: wider = exp(0.5_dp)

    load_dependence = surface_to_depth(material, plane_strain, 1.0_dp, 1.0_dp) &
                      - surface_to_depth(material, plane_strain, wider, 1.0_dp)
  end function load_dependence

  !> Flattening without edges: the same all along the path.
  pure type(flattening_t) function even_flattening(level)
    real(dp), intent(in) :: level                !< m/N

    even_flattening = flattening_t(within=level, at_end=[level, level], beyond=[level, level])
  end function even_flattening

  !> Decrease of the compliance at a path coordinate `s` of a path of this length (contact ratio), both in base pitches; m/N.
  elemental real(dp) function at(self, s, contact_ratio)
    class(flattening_t), intent(in) :: self
    real(dp), intent(in) :: s, contact_ratio
    real(dp) :: past
    integer :: i

    i = merge(1, 2, s < contact_ratio/2)
    past = merge(-s, s - contact_ratio, i == 1)
    if (past > 0) then
      at = self%beyond(i) + (self%at_end(i) - self%beyond(i))*exp(-past/self%length(i))
    else
      at = self%within + (self%at_end(i) - self%within)*edge_share(-past, self%zone(i))
    end if
  end function at

  pure type(flattening_t) function scaled(self, factor)
    class(flattening_t), intent(in) :: self
    real(dp), intent(in) :: factor

    scaled = flattening_t(factor*self%within, factor*self%at_end, factor*self%beyond, self%zone, self%length)
  end function scaled

  !> Effect of the edge on a contact at a distance within the path from its end, relative to that at the end: from 1 to 0 over the
  !> `zone`, smooth up to the second derivative.
  elemental real(dp) function edge_share(distance, zone)
    real(dp), intent(in) :: distance, zone

    edge_share = 0
    if (distance < zone) edge_share = (1 - distance/zone)**3
  end function edge_share
end module gearsweep_elastic_flattening
