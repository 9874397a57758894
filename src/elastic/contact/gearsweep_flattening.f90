!> Hertz's line contact, and how far a flank deflects between its surface and a depth.
module gearsweep_flattening
  use gearsweep_kinds, only: dp, pi
  use gearsweep_error, only: error_t, fail, code_input
  use gearsweep_material, only: harmonic_mean, material_t
  use gearsweep_text, only: str
  implicit none
  private
  public :: contact_half_width, surface_to_depth, load_dependence, check_contact

contains

  !> Half width (m) of the contact of two bodies of these materials under
  !> `line_load` (N/m), with the radii of curvature `r1`, `r2` (m). With the modulus E* of the contact,
  !> 1/E* = (1 - nu1**2)/E1 + (1 - nu2**2)/E2 in plane strain, without the squares in plane stress.
  !> Source: Johnson 1985, Contact Mechanics, Eqs. 4.21 and 4.43.
  elemental real(dp) function contact_half_width(first, second, plane_strain, line_load, r1, r2) result(a)
    type(material_t), intent(in) :: first, second
    logical, intent(in) :: plane_strain
    real(dp), intent(in) :: line_load, r1, r2
    real(dp) :: modulus

    modulus = harmonic_mean(half_modulus(first, plane_strain), half_modulus(second, plane_strain))
    a = sqrt(4*line_load*r1*r2/((r1 + r2)*pi*modulus))
  end function contact_half_width

  !> Half of a body's modulus, Pa: the modulus of a contact of two that are alike.
  elemental real(dp) function half_modulus(material, plane_strain)
    type(material_t), intent(in) :: material
    logical, intent(in) :: plane_strain

    half_modulus = material%young/2
    if (plane_strain) half_modulus = half_modulus/(1 - material%poisson**2)
  end function half_modulus

  !> Refuses a `line_load` (N/m) whose contact, of this largest half width (m), is
  !> wider than one module (m): no tooth is a half plane then.
  pure subroutine check_contact(half_width, module, line_load, error)
    real(dp), intent(in) :: half_width, module, line_load
    type(error_t), allocatable, intent(inout) :: error

    if (.not. 2*half_width <= module) call fail(error, code_input, 'line load (N/mm) = '//str(line_load/1000)// &
      ' (the load over the face width): flattens the flanks over '//str(2000*half_width, 3)// &
      ' mm, where Hertz''s contact does not hold; must be at most '//str(line_load/1000*(module/(2*half_width))**2, 3))
  end subroutine check_contact

  !> Displacement (m2/N, per line load) in a half plane of the middle of the
  !> contact under Hertz's pressure over the half width `a` (m), relative to the
  !> point at `depth` (m) below a point load. This, not the depth under the same
  !> pressure, completes what a grid gives for a point load; the two differ by (a/h)**2/4.
  !> Source: Weber, Banaschek 1953; Johnson 1985, Eq. 5.57; for plane stress
  !> with E and nu in place of E/(1 - nu**2) and nu/(1 - nu).
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

  !> How much the flattening of one flank of a pair, over its load (m2/N, per line load), falls as the load grows e times:
  !> the contact's half width grows with the root of the load, and the flattening falls with its logarithm, alike all along
  !> the path of contact.
  elemental real(dp) function load_dependence(material, plane_strain)
    type(material_t), intent(in) :: material
    logical, intent(in) :: plane_strain
    real(dp), parameter :: wider = exp(0.5_dp)

    load_dependence = surface_to_depth(material, plane_strain, 1.0_dp, 1.0_dp) &
                      - surface_to_depth(material, plane_strain, wider, 1.0_dp)
  end function load_dependence
end module gearsweep_flattening
