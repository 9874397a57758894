!> A periodic quantity that is known as one quintic a step: its mean, root mean square and harmonics, exactly.
module gearsweep_spectrum
  use gearsweep_kinds, only: dp, pi
  use gearsweep_quadrature, only: gauss_legendre
  use gearsweep_quintic, only: maximum_of, value_of
  implicit none
  private
  public :: spectrum_t, find_spectrum

  !> Over the time tau, 0 to 1 in a period: mean + sum of amplitude(k) cos(2 pi k tau + phase(k)).
  type :: spectrum_t
    real(dp) :: mean = 0
    real(dp) :: rms = 0                          !< root mean square of the deviation from the mean
    real(dp) :: least = 0, largest = 0
    real(dp), allocatable :: amplitude(:), phase(:)    !< of harmonic 1, 2 ...; phase in rad
  end type spectrum_t

  integer, parameter :: points = 12              !< of Gauss's rule

contains

  !> The spectrum of a quantity over one period, which the steps fill.
  pure subroutine find_spectrum(left, width, c, count, spectrum)
    real(dp), intent(in) :: left(:), width(:)    !< begin and length of each step, parts of the period; (step)
    real(dp), intent(in) :: c(0:, :)             !< coefficients of its quintic, over 0 to 1 in the step; (0:5, step)
    integer, intent(in) :: count                 !< harmonics
    type(spectrum_t), intent(out) :: spectrum
    real(dp) :: deviation(0:5), node(points), weight(points)
    complex(dp) :: part
    integer :: i, k

    spectrum%mean = sum([(width(i)*integral(c(:, i)), i=1, size(width))])/sum(width)
    spectrum%least = huge(1.0_dp)
    spectrum%largest = -huge(1.0_dp)
    allocate (spectrum%amplitude(count), spectrum%phase(count))
    call gauss_legendre(node, weight)
    node = (1 + node)/2
    weight = weight/2
    do i = 1, size(width)
      deviation = c(:, i)
      deviation(0) = deviation(0) - spectrum%mean
      spectrum%rms = spectrum%rms + width(i)*integral_of_square(deviation)
      spectrum%largest = max(spectrum%largest, maximum(c(:, i)))
      spectrum%least = min(spectrum%least, -maximum(-c(:, i)))
    end do
    spectrum%rms = sqrt(max(0.0_dp, spectrum%rms)/sum(width))
    do k = 1, count
      part = 0
      do i = 1, size(width)
        deviation = c(:, i)
        deviation(0) = deviation(0) - spectrum%mean
        part = part + 2*width(i)*exp(cmplx(0.0_dp, -2*pi*k*left(i), dp))*moment(deviation, 2*pi*k*width(i), node, weight)
      end do
      spectrum%amplitude(k) = abs(part)
      spectrum%phase(k) = atan2(aimag(part), real(part, dp))
    end do
  end subroutine find_spectrum

  pure real(dp) function integral(c)
    real(dp), intent(in) :: c(0:5)

    integral = c(0) + c(1)/2 + c(2)/3 + c(3)/4 + c(4)/5 + c(5)/6
  end function integral

  pure real(dp) function integral_of_square(c) result(total)
    real(dp), intent(in) :: c(0:5)
    integer :: i, j

    total = 0
    do i = 0, 5
      do j = 0, 5
        total = total + c(i)*c(j)/(i + j + 1)
      end do
    end do
  end function integral_of_square

  !> Integral of the quintic times exp(-i angle t) from 0 to 1: by Gauss's rule while that turns by less than a cycle, which
  !> is exact to rounding, else by parts.
  pure complex(dp) function moment(c, angle, node, weight)
    real(dp), intent(in) :: c(0:5), angle
    real(dp), intent(in) :: node(points), weight(points)     ! on 0 to 1
    real(dp) :: d(0:5)
    complex(dp) :: rate, divisor, turn
    integer :: i, k

    moment = 0
    if (angle < 2*pi) then
      do k = 1, points
        moment = moment + weight(k)*value_of(c, node(k))*exp(cmplx(0.0_dp, -angle*node(k), dp))
      end do
      return
    end if
    rate = cmplx(0.0_dp, angle, dp)
    turn = exp(-rate)
    divisor = 1
    d = c
    do i = 0, 5
      divisor = divisor*rate
      moment = moment + (d(0) - turn*sum(d))/divisor
      d = [([d(1:), 0.0_dp])]*[1, 2, 3, 4, 5, 6]
    end do
  end function moment

  !> The largest value from 0 to 1, of a quintic with at most one maximum between them.
  pure real(dp) function maximum(c)
    real(dp), intent(in) :: c(0:5)

    maximum = max(c(0), sum(c))
    if (c(1) > 0 .and. c(1) + 2*c(2) + 3*c(3) + 4*c(4) + 5*c(5) < 0) maximum = max(maximum, value_of(c, maximum_of(c)))
  end function maximum
end module gearsweep_spectrum
