!> What a load of a steady frequency does to a body in its modes: amplitude and phase, and where resonances peak.
!>
!> Source: Clough and Penzien 1993, Dynamics of Structures, sections 3.2 and 12.4; static correction: section 15.5.
module gearsweep_frequency_response
  use gearsweep_kinds, only: dp
  use gearsweep_modal_superposition, only: modal_model_t
  use gearsweep_sorting, only: sorted
  implicit none
  private
  public :: response_to, find_peak, frequencies_around

contains

  !> Some rows of `model` under a load of 1 N at place number `place`, of `angular` frequency (rad/s): complex amplitudes, whose
  !> argument is by how much they run ahead of the load. The static response is whole, whatever modes are left out: of each mode
  !> only what it has beyond rest is added, which is nothing at frequency 0.
  pure function response_to(model, rows, place, angular) result(amplitude)
    type(modal_model_t), intent(in) :: model
    integer, intent(in) :: rows(:), place
    real(dp), intent(in) :: angular
    complex(dp) :: amplitude(size(rows))
    complex(dp) :: modal(size(model%frequency))

    modal = model%force(:, place)*beyond_rest(model%frequency, model%damping, angular)
    amplitude = model%static(rows, place) + matmul(model%shape(rows, :), modal)
  end function response_to

  !> 1/(w^2 - a^2 + i c a) - 1/w^2, as one fraction: both are equal but for rounding where a is small.
  elemental complex(dp) function beyond_rest(w, c, angular)
    real(dp), intent(in) :: w, c, angular

    beyond_rest = cmplx(angular, -c, dp)*(angular/w**2)/cmplx((w - angular)*(w + angular), c*angular, dp)
  end function beyond_rest

  !> Where the amplitude of a row is largest about mode number `mode`, rad/s: within four bandwidths c of the mode and not beyond
  !> the middles to its neighbours. All modes are damped.
  pure real(dp) function find_peak(model, row, place, mode) result(angular)
    type(modal_model_t), intent(in) :: model
    integer, intent(in) :: row, place, mode
    real(dp), parameter :: golden = (sqrt(5.0_dp) - 1)/2
    !> Of a bandwidth: a peak is half a bandwidth to either side, so that the scan meets each. Closer than about the square root
    !> of rounding an amplitude tells no frequencies apart.
    real(dp), parameter :: step = 0.1_dp, close = 1e-7_dp
    integer, parameter :: scan = 40
    real(dp) :: low, high, a, b
    integer :: i

    associate (w => model%frequency, c => model%damping(mode))
      low = 0
      high = 2*w(mode)
      if (mode > 1) low = (w(mode - 1) + w(mode))/2
      if (mode < size(w)) high = (w(mode) + w(mode + 1))/2
      angular = w(mode)
      do i = -scan, scan
        a = max(low, min(high, w(mode) + i*step*c))
        if (size_at(a) > size_at(angular)) angular = a
      end do
      low = max(low, angular - step*c)
      high = min(high, angular + step*c)
    end associate
    do while (high - low > max(close*model%damping(mode), 8*epsilon(high)*high))
      a = high - golden*(high - low)
      b = low + golden*(high - low)
      if (size_at(a) > size_at(b)) then
        high = b
      else
        low = a
      end if
    end do
    angular = (low + high)/2

  contains

    pure real(dp) function size_at(at)
      real(dp), intent(in) :: at

      size_at = maxval(abs(response_to(model, [row], place, at)))
    end function size_at
  end function find_peak

  !> The stated frequencies with those that resolve the response between the first and the last of them: hundredths of the way, each
  !> mode, and up to 16 bandwidths to either side of it. Ascending, rad/s.
  pure function frequencies_around(model, stated) result(angular)
    type(modal_model_t), intent(in) :: model
    real(dp), intent(in) :: stated(:)            !< rad/s, ascending
    real(dp), allocatable :: angular(:)
    !> In bandwidths: ten within the one of the peak.
    real(dp), parameter :: one_side(*) = [0.1_dp, 0.2_dp, 0.3_dp, 0.4_dp, 0.5_dp, 0.75_dp, 1.0_dp, 1.5_dp, 2.0_dp, 4.0_dp, &
                                          8.0_dp, 16.0_dp]
    real(dp), parameter :: around(*) = [-one_side, 0.0_dp, one_side]
    integer, parameter :: between = 100
    !> Relative: rounding leaves one frequency, reached in two ways, so far apart at most.
    real(dp), parameter :: apart = 1e-12_dp
    integer :: i, k, n

    n = size(stated)
    angular = [stated, (stated(1) + i*(stated(n) - stated(1))/between, i=1, between - 1)]
    angular = [angular, ((model%frequency(k) + around(i)*model%damping(k), i=1, size(around)), k=1, size(model%frequency))]
    angular = sorted(pack(angular, angular >= stated(1) .and. angular <= stated(n)))
    angular = pack(angular, [.true., angular(2:) > angular(:size(angular) - 1)*(1 + apart)])
  end function frequencies_around
end module gearsweep_frequency_response
