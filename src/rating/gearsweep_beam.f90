!> The tooth as a cantilever beam: natural frequency and stress in closed form.
!> Source: Hassan, Thanigaiyarasu, Ramamurti 2009, Eqs. 1 to 8.
module gearsweep_beam
  use gearsweep_kinds, only: dp, pi
  use gearsweep_error, only: error_t, fail, code_input
  use gearsweep_material, only: material_t
  implicit none
  private
  public :: beam_t, hassan_shape

  !> A beam of uniform section. Lengths in m.
  type :: beam_t
    real(dp) :: length = 0
    real(dp) :: thickness = 0                    !< in the plane of bending
    real(dp) :: width = 0                        !< the face width
  contains
    procedure :: spring_frequency
    procedure :: rayleigh_frequency
    procedure :: exact_frequency
    procedure :: stress
  end type beam_t

  !> x^5 - 5 x + 4 from the free end, coefficients in ascending powers (Eq. 6).
  real(dp), parameter :: hassan_shape(0:5) = [4, -5, 0, 0, 0, 1]

contains

  !> Angular frequency (rad/s) of the tip spring 3 E I/l^3 with the whole mass
  !> of the beam on it (Eqs. 1 to 4).
  elemental real(dp) function spring_frequency(beam, material) result(omega)
    class(beam_t), intent(in) :: beam
    type(material_t), intent(in) :: material

    omega = sqrt(3.0_dp)*bending_speed(beam, material)/beam%length**2
  end function spring_frequency

  !> Angular frequency (rad/s) by Rayleigh's quotient (Eq. 5) for the shape
  !> sum_k c_k (x/l)^k, `coefficients` ascending from the constant; the free
  !> end may be at either end, as only the integrals count.
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

  !> sqrt(E I/(rho A)), m2/s.
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
end module gearsweep_beam
