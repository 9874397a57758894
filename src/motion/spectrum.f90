!> A periodic quantity with one quintic a step: its mean, root mean square and harmonics, exactly.
module gearsweep_motion_spectrum
  use gearsweep_base, only: dp, gauss_legendre, pi, place_of_largest, value_of
  implicit none
  private
  public :: spectrum_t, find_spectrum

  !> Series over the time tau: mean + sum of amplitude(k) cos(2 pi k base tau + phase(k)), with one cycle a period as the base or
  !> another.
  type :: spectrum_t
    real(dp) :: mean = 0
    real(dp) :: rms = 0                          !< root mean square of the deviation from the mean
    real(dp) :: least = 0, largest = 0
    real(dp), allocatable :: amplitude(:), phase(:)    !< amplitude of harmonics 1, 2 ...; phase in rad
  end type spectrum_t

  integer, parameter :: points = 12              !< points of Gauss's rule

contains

  !> Computes the spectrum of a quantity over its period, which the steps fill.
  pure subroutine find_spectrum(left, width, c, count, spectrum, base)
    real(dp), intent(in) :: left(:), width(:)    !< start and length of each step; (step)
    real(dp), intent(in) :: c(0:, :)             !< coefficients of its quintic, over 0 to 1 in the step; (0:5, step)
    integer, intent(in) :: count                 !< number of harmonics
    type(spectrum_t), intent(out) :: spectrum
    !> Cycles of the first harmonic in the unit of `left`; 1 if absent. Only harmonics with a whole number of cycles in the period
    !> are meaningful.
    real(dp), intent(in), optional :: base
    real(dp) :: deviation(0:5), node(points), weight(points), cycles, period
    complex(dp) :: part(count)
    integer :: i

    period = sum(width)
    spectrum%mean = sum([(width(i)*integral(c(:, i)), i=1, size(width))])/period
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
      spectrum%largest = max(spectrum%largest, value_of(c(:, i), place_of_largest(c(:, i))))
      spectrum%least = min(spectrum%least, value_of(c(:, i), place_of_largest(-c(:, i))))
    end do
    spectrum%rms = sqrt(max(0.0_dp, spectrum%rms)/period)
    cycles = 1
    if (present(base)) cycles = base
    part = 0
    do i = 1, size(width)
      deviation = c(:, i)
      deviation(0) = deviation(0) - spectrum%mean
      call add_step(cycles*left(i), cycles*width(i), 2*width(i)/period*deviation, node, weight, part)
    end do
    spectrum%amplitude = abs(part)
    spectrum%phase = atan2(aimag(part), real(part, dp))
  end subroutine find_spectrum

  !> Adds the integrals of the quintic times exp(-2 pi i k tau), over its step, to part(k): by Gauss's rule while the exponent
  !> turns by less than a cycle, which is exact to rounding, else by parts.
  pure subroutine add_step(left, width, c, node, weight, part)
    real(dp), intent(in) :: left, width          ! start and width of the step, in cycles of the first harmonic
    real(dp), intent(in) :: c(0:5)
    real(dp), intent(in) :: node(points), weight(points)     ! nodes and weights on 0 to 1
    complex(dp), intent(inout) :: part(:)
    complex(dp), dimension(points) :: turn, term
    integer :: few, i, k

    few = size(part)
    if (few*width >= 1) few = ceiling(1/width) - 1
    turn = exp(cmplx(0.0_dp, -2*pi*modulo(left + width*node, 1.0_dp), dp))
    term = weight*[(value_of(c, node(i)), i=1, points)]
    do k = 1, few
      term = term*turn
      part(k) = part(k) + sum(term)
    end do
    do k = few + 1, size(part)
      part(k) = part(k) + exp(cmplx(0.0_dp, -2*pi*modulo(k*left, 1.0_dp), dp))*moment(c, 2*pi*k*width)
    end do
  end subroutine add_step

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

  !> Integral of the quintic times exp(-i angle t) from 0 to 1, by parts.
  pure complex(dp) function moment(c, angle)
    real(dp), intent(in) :: c(0:5), angle
    real(dp) :: d(0:5)
    complex(dp) :: rate, divisor, turn
    integer :: i

    moment = 0
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
end module gearsweep_motion_spectrum
