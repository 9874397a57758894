!> Harmonics of the static transmission error against closed forms.
module test_harmonics
  use gearsweep_mesh_harmonics, only: find_harmonics, harmonics_t
  use gearsweep_mesh_deviations, only: interval_t
  use gearsweep_base_kinds, only: dp, pi
  use gearsweep_motion_oscillator, only: oscillator_t
  use gearsweep_base_quadrature, only: gauss_legendre
  use gearsweep_mesh_sharing, only: segment_t, share_load, sharing_t, smooth_segments
  use test_support_reference_rows, only: prescribed
  use test_support_testing, only: tally_t, check_true, check_close
  implicit none
  private
  public :: run

  !> Constant pair stiffness of 400 N/um under 6000 N: one pair deflects 15 um.
  real(dp), parameter :: load = 6000, single = 15e-6_dp, ratio = 1.6_dp, double = ratio - 1

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t

    if (t%wants('quadrature')) call quadrature(t)
    if (t%wants('rectangle')) call rectangle(t)
    if (t%wants('ramp_with_separation')) call ramp_with_separation(t)
    if (t%wants('trapezium')) call trapezium(t)
    if (t%wants('close_changes')) call close_changes(t)
    if (t%wants('samples_converge')) call samples_converge(t)
    if (t%wants('energy')) call energy(t)
    if (t%wants('smooth_meshes')) call smooth_meshes(t)
    if (t%wants('summits')) call summits(t)
    if (t%wants('summits_near_ends')) call summits_near_ends(t)
  end subroutine run

  !> Polynomials up to degree 2 n - 1 are integrated exactly.
  subroutine quadrature(t)
    type(tally_t), intent(inout) :: t
    real(dp) :: node(16), weight(16)
    integer :: degree

    call gauss_legendre(node, weight)
    do degree = 0, 31
      call check_close(t, 'integral of a power', sum(weight*node**degree), merge(2.0_dp/(degree + 1), 0.0_dp, &
                       mod(degree, 2) == 0), absolute=3e-15_dp)
    end do
    call check_true(t, 'nodes ascend within the interval', all(node(2:) > node(:15)) .and. abs(node(1)) < 1)
  end subroutine quadrature

  !> A piecewise linear x: at each of the phases `at` it jumps by `jump` and its slope by `kink`.
  !> Twice partial integration gives c_k = sum (jump/(2 pi i k) + kink/(2 pi i k)^2) exp(-2 pi i k at).
  pure complex(dp) function coefficient(k, at, jump, kink)
    integer, intent(in) :: k
    real(dp), intent(in) :: at(:), jump(:), kink(:)
    complex(dp) :: turns

    turns = cmplx(0.0_dp, 2*pi*k, dp)
    coefficient = sum((jump/turns + kink/turns**2)*exp(-turns*at))
  end function coefficient

  !> All harmonics against the closed form, and phases where there is an amplitude.
  subroutine check_linear(t, name, harmonics, at, jump, kink)
    type(tally_t), intent(inout) :: t
    character(*), intent(in) :: name
    type(harmonics_t), intent(in) :: harmonics
    real(dp), intent(in) :: at(:), jump(:), kink(:)
    complex(dp) :: c, ours
    integer :: k

    do k = 1, size(harmonics%amplitude)
      c = coefficient(k, at, jump, kink)
      ours = harmonics%amplitude(k)/2*exp(cmplx(0.0_dp, harmonics%phase(k), dp))
      call check_close(t, name//': harmonic', abs(ours - c)/single, 0.0_dp, absolute=1e-12_dp)
    end do
    call check_true(t, name//': error estimate', harmonics%error_estimate < 1e-12_dp*single)
  end subroutine check_linear

  !> No relief: two pairs until `double`, then one.
  subroutine rectangle(t)
    type(tally_t), intent(inout) :: t
    type(oscillator_t) :: osc
    type(harmonics_t) :: harmonics
    integer :: k

    call prescribed(ratio, [400.0_dp], [0.0_dp, 0.0_dp], 1, osc)
    call find_harmonics(osc%mesh, load, 40, harmonics)
    call check_linear(t, 'rectangle', harmonics, [0.0_dp, double], single/2*[-1, 1], [0.0_dp, 0.0_dp])
    do k = 1, 40
      call check_close(t, 'rectangular wave', harmonics%amplitude(k), single*abs(sin(pi*k*double))/(pi*k), &
                       absolute=1e-12_dp*single)
    end do
    call check_close(t, 'mean', harmonics%mean, single*(1 - double/2), 1e-13_dp)
    call check_close(t, 'peak to peak', harmonics%peak_to_peak(), single/2, 1e-13_dp)
    call check_close(t, 'rms', harmonics%rms, single/2*sqrt(double*(1 - double)), 1e-12_dp)
  end subroutine rectangle

  !> The pinion alone relieved, by more than one pair deflects: the pair that leaves separates where its
  !> relief, 24 um times phase/double, reaches that.
  subroutine ramp_with_separation(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: tip = 24e-6_dp, apart = double*single/tip, slope = tip/(2*double)
    type(oscillator_t) :: osc
    type(harmonics_t) :: harmonics
    type(interval_t), allocatable :: intervals(:)
    type(segment_t), allocatable :: segments(:)

    call prescribed(ratio, [400.0_dp], [1e6_dp*tip, 0.0_dp], 1, osc)
    call smooth_segments(osc%mesh, load, intervals, segments)
    call check_close(t, 'place of the separation', minval(abs(segments%first - apart)), 0.0_dp, absolute=1e-14_dp)
    call find_harmonics(osc%mesh, load, 40, harmonics)
    call check_linear(t, 'ramp', harmonics, [0.0_dp, apart], [-single/2, 0.0_dp], [slope, -slope])
    call check_close(t, 'mean of the ramp', harmonics%mean, single - single/4*apart, 1e-13_dp)
    call check_close(t, 'peak to peak of the ramp', harmonics%peak_to_peak(), single/2, 1e-13_dp)
  end subroutine ramp_with_separation

  !> Both relieved by more than one pair deflects: x is continuous, with four kinks.
  subroutine trapezium(t)
    type(tally_t), intent(inout) :: t
    type(oscillator_t) :: osc
    type(harmonics_t) :: harmonics
    real(dp) :: at(4), kink(4)

    call make_trapezium(osc, at, kink)
    call find_harmonics(osc%mesh, load, 40, harmonics)
    call check_linear(t, 'trapezium', harmonics, at, [0.0_dp, 0.0_dp, 0.0_dp, 0.0_dp], kink)
    call check_close(t, 'height of the trapezium', harmonics%peak_to_peak(), kink(1)*at(2), 1e-12_dp)
    call check_close(t, 'its mean', harmonics%mean, single + kink(1)*at(2)*(at(3) - at(1)), 1e-13_dp)
  end subroutine trapezium

  !> The entering pair carries from `at(2)` on, the leaving one until `at(3)`.
  subroutine make_trapezium(osc, at, kink)
    type(oscillator_t), intent(out) :: osc
    real(dp), intent(out) :: at(4), kink(4)
    real(dp), parameter :: tip = 20e-6_dp, early = double/2*(1 - single/tip)

    call prescribed(ratio, [400.0_dp], 1e6_dp*[tip, tip], 1, osc)
    at = [0.0_dp, early, double - early, double]
    kink = tip/double*[1, -1, -1, 1]
  end subroutine make_trapezium

  !> Reliefs of many deflections: the entering pair begins to carry shortly before the leaving one parts, at phases q*double where
  !> tip(2) (1 - q) is the deflection of the leaving pair alone, and where tip(1) q is that of the entering one.
  subroutine close_changes(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: tip(2) = single*[18, 14], at(4) = double*[0.0_dp, 13/32.0_dp, 15/32.0_dp, 1.0_dp]
    real(dp), parameter :: kink(4) = [tip(1), -sum(tip)/2, -sum(tip)/2, tip(2)]/double
    type(oscillator_t) :: osc
    type(harmonics_t) :: harmonics
    type(interval_t), allocatable :: intervals(:)
    type(segment_t), allocatable :: segments(:)
    integer :: i

    call prescribed(ratio, [400.0_dp], 1e6_dp*tip, 1, osc)
    call smooth_segments(osc%mesh, load, intervals, segments)
    do i = 2, 3
      call check_close(t, 'place of a close change', minval(abs(segments%first - at(i))), 0.0_dp, absolute=1e-14_dp)
    end do
    call find_harmonics(osc%mesh, load, 40, harmonics)
    call check_linear(t, 'close changes', harmonics, at, [0.0_dp, 0.0_dp, 0.0_dp, 0.0_dp], kink)
  end subroutine close_changes

  !> The transform of n samples comes to the same: as 1/n where x jumps, as 1/n**2 where it has
  !> kinks. The largest error among many n, as it depends on how the samples meet the breaks.
  subroutine samples_converge(t)
    type(tally_t), intent(inout) :: t
    type(oscillator_t) :: osc
    real(dp) :: at(4), kink(4)

    call prescribed(ratio, [400.0_dp], [0.0_dp, 0.0_dp], 1, osc)
    call check_close(t, 'order with jumps', order_of_samples(osc), 1.0_dp, absolute=0.1_dp)
    call make_trapezium(osc, at, kink)
    call check_close(t, 'order with kinks', order_of_samples(osc), 2.0_dp, absolute=0.1_dp)
  end subroutine samples_converge

  real(dp) function order_of_samples(osc) result(order)
    type(oscillator_t), intent(in) :: osc
    integer, parameter :: few = 101, more = 1616
    type(harmonics_t) :: harmonics
    real(dp) :: off(2)
    integer :: n

    call find_harmonics(osc%mesh, load, 5, harmonics)
    off = 0
    do n = 0, 40
      off = max(off, [deviation(few + n), deviation(more + 16*n)])
    end do
    order = log(off(1)/off(2))/log(16.0_dp)

  contains

    !> Of the first harmonics by the midpoint rule.
    real(dp) function deviation(n)
      integer, intent(in) :: n
      type(sharing_t) :: sharing
      complex(dp) :: c
      real(dp) :: x(n), phase(n)
      integer :: i, k, row

      call share_load(osc%mesh, load, 20000, sharing)
      phase = [((i - 0.5_dp)/n, i=1, n)]
      row = 1
      do i = 1, n
        do while (sharing%phase(row + 1) < phase(i))
          row = row + 1
        end do
        ! x is linear in between.
        associate (p => sharing%phase(row:row + 1), e => sharing%error(row:row + 1))
          x(i) = e(1) + (e(2) - e(1))*(phase(i) - p(1))/(p(2) - p(1))
        end associate
      end do
      deviation = 0
      do k = 1, 5
        c = sum(x*exp(cmplx(0.0_dp, -2*pi*k*phase, dp)))/n
        deviation = max(deviation, abs(2*c - harmonics%amplitude(k)*exp(cmplx(0.0_dp, harmonics%phase(k), dp))))
      end do
    end function deviation
  end function order_of_samples

  !> Parseval: the mean square about the mean is half the sum of the squared amplitudes. What n
  !> harmonics leave out is known for the rectangle and falls as 1/n**3 for the trapezium.
  subroutine energy(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: n = 1000
    type(oscillator_t) :: osc
    type(harmonics_t) :: harmonics
    real(dp) :: at(4), kink(4), left(2)

    call prescribed(ratio, [400.0_dp], [0.0_dp, 0.0_dp], 1, osc)
    call find_harmonics(osc%mesh, load, n, harmonics)
    ! sin**2 repeats every five harmonics with 1/2 on the mean; what is left of the sum over 1/k**2 is 1/n.
    call check_close(t, 'energy of the rectangle', harmonics%rms**2 - sum(harmonics%amplitude**2)/2, &
                     (single/pi)**2/4/n, 1e-5_dp)
    call make_trapezium(osc, at, kink)
    call find_harmonics(osc%mesh, load, n, harmonics)
    left = harmonics%rms**2 - [sum(harmonics%amplitude(:50)**2), sum(harmonics%amplitude(:400)**2)]/2
    call check_close(t, 'energy of the trapezium', sum(harmonics%amplitude**2)/2, harmonics%rms**2, 1e-8_dp)
    call check_close(t, 'order of what is left out', log(left(1)/left(2))/log(8.0_dp), 3.0_dp, absolute=0.1_dp)
  end subroutine energy

  !> Curved stiffness, parabolic relief, one to three pairs: against a fine trapezoidal rule between
  !> the breaks of the sampled state, which is of second order.
  subroutine smooth_meshes(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: ratios(3) = [1.03_dp, 1.6_dp, 2.7_dp]
    type(oscillator_t) :: osc
    type(harmonics_t) :: harmonics
    type(sharing_t) :: sharing
    complex(dp) :: c
    integer :: i, k

    do i = 1, size(ratios)
      call prescribed(ratios(i), [400.0_dp, 20.0_dp, -110.0_dp], [22.0_dp, 9.0_dp], 2, osc)
      call find_harmonics(osc%mesh, load, 6, harmonics)
      call share_load(osc%mesh, load, 40000, sharing)
      call check_close(t, 'mean by samples', harmonics%mean, real(transformed(0), dp), 1e-8_dp)
      do k = 1, 6
        c = harmonics%amplitude(k)/2*exp(cmplx(0.0_dp, harmonics%phase(k), dp))
        call check_close(t, 'harmonics by samples', abs(c - transformed(k)), 0.0_dp, absolute=1e-8_dp*single)
      end do
      ! The summit is a kink, which the samples miss.
      call check_close(t, 'peak to peak by samples', harmonics%peak_to_peak(), &
                       maxval(sharing%error) - minval(sharing%error), 2e-4_dp)
      call check_true(t, 'no sample beyond the extremes', maxval(sharing%error) <= harmonics%largest*(1 + 1e-14_dp) &
                      .and. minval(sharing%error) >= harmonics%least*(1 - 1e-14_dp))
    end do

  contains

    complex(dp) function transformed(k)
      integer, intent(in) :: k
      complex(dp) :: x(size(sharing%phase))

      associate (p => sharing%phase, n => size(sharing%phase))
        x = sharing%error*exp(cmplx(0.0_dp, -2*pi*k*p, dp))
        transformed = sum((p(2:) - p(:n - 1))*(x(2:) + x(:n - 1)))/2
      end associate
    end function transformed
  end subroutine smooth_meshes

  !> Extremes within a segment: with K = 400 - 110 u**2 two pairs deflect least midway between A and B,
  !> one pair most at B and D; with K = 400 + 300 u**2 one pair deflects most at u = 0.
  subroutine summits(t)
    type(tally_t), intent(inout) :: t
    type(oscillator_t) :: osc
    type(harmonics_t) :: harmonics

    call prescribed(1.01_dp, [400.0_dp, 0.0_dp, -110.0_dp], [0.0_dp, 0.0_dp], 1, osc)
    call find_harmonics(osc%mesh, load, 1, harmonics)
    associate (u => 1 - [0.02_dp, 0.01_dp]/1.01_dp)
      call check_close(t, 'largest', harmonics%largest, load/(1e6_dp*(400 - 110*u(1)**2)), 1e-12_dp)
      call check_close(t, 'least', harmonics%least, load/(1e6_dp*(800 - 220*u(2)**2)), 1e-12_dp)
    end associate
    call prescribed(1.01_dp, [400.0_dp, 0.0_dp, 300.0_dp], [0.0_dp, 0.0_dp], 1, osc)
    call find_harmonics(osc%mesh, load, 1, harmonics)
    call check_close(t, 'summit in the middle', harmonics%largest, load/400e6_dp, 1e-12_dp)
  end subroutine summits

  !> Two pairs always, K = 400 + way 110 ((1 - 2 p) u + u**2) of each: their sum has its only extreme at phase p, near either end.
  subroutine summits_near_ends(t)
    type(tally_t), intent(inout) :: t
    real(dp), parameter :: near(2) = [0.012_dp, 0.988_dp]
    type(oscillator_t) :: osc
    type(harmonics_t) :: harmonics
    integer :: i, way

    do i = 1, 2
      do way = -1, 1, 2
        associate (p => near(i))
          call prescribed(2.0_dp, [400.0_dp, way*110*(1 - 2*p), way*110.0_dp], [0.0_dp, 0.0_dp], 1, osc)
          call find_harmonics(osc%mesh, load, 1, harmonics)
          call check_close(t, 'summit near an end', merge(harmonics%largest, harmonics%least, way > 0), &
                           load/(1e6_dp*(800 + way*220*p*(1 - p))), 1e-12_dp)
        end associate
      end do
    end do
  end subroutine summits_near_ends
end module test_harmonics
