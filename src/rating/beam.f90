!> Closed forms of a loaded tooth: natural frequency and stress of a cantilever beam, and deflection by a formula.
!>
!> Beam: Hassan, Thanigaiyarasu, Ramamurti 2009, Eqs. 1 to 8. Deflection: Markovic, Vrcan 2016 (Influence of tip relief profile
!> modification on involute spur gear stress, Trans. FAMENA 40(2)), as printed by Thamba et al. 2020 (Eqs. 2 to 15), with their
!> misprints corrected, each of which doc/deflection_relief.md describes.
module gearsweep_rating_beam
  use gearsweep_base, only: code_input, dp, error_t, fail, pi
  use gearsweep_gear, only: drive, gear_t
  use gearsweep_elastic, only: material_t
  implicit none
  private
  public :: beam_t, hassan_shape, formula_deflection_t, formula_deflection, formula_relief

  !> A beam of uniform section. Lengths in m.
  type :: beam_t
    real(dp) :: length = 0
    real(dp) :: thickness = 0                    !< thickness in the plane of bending
    real(dp) :: width = 0                        !< face width
  contains
    procedure :: spring_frequency
    procedure :: rayleigh_frequency
    procedure :: exact_frequency
    procedure :: stress
  end type beam_t

  !> Shape x^5 - 5 x + 4 from the free end, coefficients in ascending powers (Eq. 6).
  real(dp), parameter :: hassan_shape(0:5) = [4, -5, 0, 0, 0, 1]

  type :: formula_deflection_t
    real(dp) :: height = 0                       !< y_p: height of the load above the root circle along the tooth's axis, m
    real(dp) :: bending = 0                      !< delta_b: deflection of the tooth by bending, m
    real(dp) :: flattening = 0                   !< delta_H: flattening of this flank at the contact, m
  end type formula_deflection_t

contains

  !> Angular frequency (rad/s) of the tip spring 3 E I/l^3 with the total mass of the beam on it (Eqs. 1 to 4).
  elemental real(dp) function spring_frequency(beam, material) result(omega)
    class(beam_t), intent(in) :: beam
    type(material_t), intent(in) :: material

    omega = sqrt(3.0_dp)*bending_speed(beam, material)/beam%length**2
  end function spring_frequency

  !> Angular frequency (rad/s) by Rayleigh's quotient (Eq. 5) for the shape sum_k c_k (x/l)^k, `coefficients` ascending from the
  !> constant; the free end may be at either end, as only the integrals enter.
  pure subroutine rayleigh_frequency(beam, material, coefficients, omega, error)
    class(beam_t), intent(in) :: beam
    type(material_t), intent(in) :: material
    real(dp), intent(in) :: coefficients(0:)
    real(dp), intent(out) :: omega
    type(error_t), allocatable, intent(out) :: error
    real(dp) :: bending, moving
    integer :: i, j

    omega = 0
    bending = 0
    moving = 0
    do i = 0, ubound(coefficients, 1)
      do j = 0, ubound(coefficients, 1)
        associate (both => coefficients(i)*coefficients(j))
          moving = moving + both/(i + j + 1)
          if (i >= 2 .and. j >= 2) bending = bending + both*i*(i - 1)*j*(j - 1)/(i + j - 3)
        end associate
      end do
    end do
    if (.not. (moving > 0 .and. bending > 0)) then
      call fail(error, code_input, 'Rayleigh quotient: the shape must move and bend')
      return
    end if
    omega = sqrt(bending/moving)*bending_speed(beam, material)/beam%length**2
  end subroutine rayleigh_frequency

  !> First angular frequency (rad/s) of the Euler-Bernoulli cantilever:
  !> (beta l)^2 with cos(beta l) cosh(beta l) = -1.
  elemental real(dp) function exact_frequency(beam, material) result(omega)
    class(beam_t), intent(in) :: beam
    type(material_t), intent(in) :: material
    real(dp), parameter :: root = 1.875104068711961_dp

    omega = (root/beam%length)**2*bending_speed(beam, material)
  end function exact_frequency

  !> Bending speed sqrt(E I/(rho A)), m2/s.
  elemental real(dp) function bending_speed(beam, material)
    type(beam_t), intent(in) :: beam
    type(material_t), intent(in) :: material

    bending_speed = beam%thickness*sqrt(material%young/(12*material%density))
  end function bending_speed

  !> Stress across (1) and along (2) the tooth (Pa) for `force` (N) at the end,
  !> inclined by `angle` (rad) to the normal of the axis (Eqs. 7 and 8).
  pure function stress(beam, force, angle) result(sigma)
    class(beam_t), intent(in) :: beam
    real(dp), intent(in) :: force, angle
    real(dp) :: sigma(2)

    sigma(1) = force*sin(angle)/(beam%width*beam%thickness)
    sigma(2) = 6*force*cos(angle)*beam%length/(beam%width*beam%thickness**2)
  end function stress

  !> Deflection of a tooth of `gear` under `line_load` (N/m) at `radius` (m) of its drive flank, along the line of action.
  !> `half_width` (m): of the contact there (Hertz), above 0.
  pure type(formula_deflection_t) function formula_deflection(gear, material, line_load, half_width, radius) result(tooth)
    type(gear_t), intent(in) :: gear
    type(material_t), intent(in) :: material
    real(dp), intent(in) :: line_load, half_width, radius
    real(dp), parameter :: milli = 1e3_dp
    real(dp) :: unit_deflection

    unit_deflection = line_load*(1 - material%poisson**2)/material%young
    associate (x => gear%spec%profile_shift, z => real(gear%spec%teeth, dp), m => gear%spec%module)
      ! Eqs. 8 to 13: the angle alpha_b - omega_b is that between the tooth's axis and the ray to the point.
      tooth%height = radius*cos(gear%half_angle(drive, radius)) - gear%root_radius
      tooth%bending = unit_deflection*(-1.05_dp + 153*exp(-8.1_dp*x)*z**(-(1.75_dp - 1.6_dp*x)) &
                                + (0.63_dp + (7.35_dp - 0.924_dp*x)/z)*exp((1.28_dp - (2.88_dp + 3.68_dp*x)/z)*tooth%height/m) &
                                - 1.06_dp + 0.638_dp*log(milli*m*z))
      tooth%flattening = 2/pi*unit_deflection*(1.27_dp + 0.781_dp*log(m/half_width))
    end associate
  end function formula_deflection

  !> Tip relief (m) by Eq. 16 for this deflection: bending and half the flattening, or all of it with `all`.
  elemental real(dp) function formula_relief(tooth, all) result(relief)
    type(formula_deflection_t), intent(in) :: tooth
    logical, intent(in) :: all

    relief = tooth%bending + merge(1.0_dp, 0.5_dp, all)*tooth%flattening
  end function formula_relief
end module gearsweep_rating_beam
