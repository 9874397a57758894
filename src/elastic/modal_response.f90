!> Response of a body in its modes: amplitude and phase under a harmonic load, and the history under a load that moves.
!>
!> Harmonic load: Clough and Penzien 1993, Dynamics of Structures, sections 3.2 and 12.4; static correction: section 15.5.
!>
!> Moving load: each mode is one oscillator whose modal force is linear in time between two points of the history, so that its
!> motion is known in closed form, and the length of a step decides only how often the motion is sampled. The static correction,
!> which the omitted modes would add to a slow load, follows the load as one oscillator for each place.
!> Sources: Clough and Penzien 1993, sections 4.2, 8.5 (Rayleigh's quotient) and 15.5 (where the correction follows the load at
!> once); the piecewise exact method in Chopra 2012, Dynamics of Structures, section 5.2.
module gearsweep_elastic_modal_response
  use gearsweep_base, only: claim_memory, dp, error_t, sorted
  implicit none
  private
  public :: response_to, find_peak, frequencies_around, modal_model_t, load_history_t, motion_record_t, superpose, advance_mode

  !> Body in its modes, with observed quantities (stresses, displacements ...) as rows.
  type :: modal_model_t
    real(dp), allocatable :: frequency(:)        !< frequencies of the modes, rad/s
    real(dp), allocatable :: damping(:)          !< c of p" + c p' + w^2 p = force, 1/s; (mode)
    real(dp), allocatable :: shape(:, :)         !< shape of each row for a modal coordinate of 1 (row, mode)
    real(dp), allocatable :: force(:, :)         !< force on each mode by a unit load at each place (mode, place)
    real(dp), allocatable :: static(:, :)        !< static response of each row to a unit load at each place (row, place)
    !> Rayleigh's quotient of the static displacements under a unit load at each place that the modes omit, rad/s; (place)
    real(dp), allocatable :: residual_frequency(:)
  end type modal_model_t

  !> Load in time. Between two of its points it changes linearly in time; two points at one time are a jump.
  type :: load_history_t
    real(dp), allocatable :: time(:)             !< s, not descending
    real(dp), allocatable :: load(:)             !< N
    real(dp), allocatable :: weight(:, :)        !< fraction of the load at each place (place, point)
  end type load_history_t

  !> Motion from rest, and its extremes.
  type :: motion_record_t
    real(dp), allocatable :: time(:)             !< times of the samples, s
    real(dp), allocatable :: value(:, :)         !< values of the recorded rows (row, sample)
    real(dp), allocatable :: static(:, :)        !< static values under the load of that time
    real(dp), allocatable :: highest(:), lowest(:)  !< extremes of all rows, over all times evaluated
    real(dp), allocatable :: time_highest(:), time_lowest(:)  !< s
    real(dp), allocatable :: static_highest(:), static_lowest(:)  !< extremes of all rows in the static response
  end type motion_record_t

  !> Times evaluated together.
  integer, parameter :: block_size = 64
  !> Damping ratio of the omitted part: it consists of many modes, whose oscillations get out of phase and cancel within about one
  !> cycle, even with little damping of each.
  real(dp), parameter :: residual_damping = 0.5_dp

contains

  !> Complex amplitudes of some rows of `model` under a load of 1 N at place number `place`, of `angular` frequency (rad/s); their
  !> argument is the phase lead over the load. The static response is complete for any number of modes: each mode adds only the
  !> difference from its static response, which is zero at frequency 0.
  pure function response_to(model, rows, place, angular) result(amplitude)
    type(modal_model_t), intent(in) :: model
    integer, intent(in) :: rows(:), place
    real(dp), intent(in) :: angular
    complex(dp) :: amplitude(size(rows))
    complex(dp) :: modal(size(model%frequency))

    modal = model%force(:, place)*beyond_static(model%frequency, model%damping, angular)
    amplitude = model%static(rows, place) + matmul(model%shape(rows, :), modal)
  end function response_to

  !> Difference 1/(w^2 - a^2 + i c a) - 1/w^2, as one fraction: both are equal but for rounding where a is small.
  elemental complex(dp) function beyond_static(w, c, angular)
    real(dp), intent(in) :: w, c, angular

    beyond_static = cmplx(angular, -c, dp)*(angular/w**2)/cmplx((w - angular)*(w + angular), c*angular, dp)
  end function beyond_static

  !> Frequency of the largest amplitude of a row near mode number `mode`, rad/s: within four bandwidths c of the mode and not
  !> beyond the middles to its neighbours. All modes are damped.
  pure real(dp) function find_peak(model, row, place, mode) result(angular)
    type(modal_model_t), intent(in) :: model
    integer, intent(in) :: row, place, mode
    real(dp), parameter :: golden = (sqrt(5.0_dp) - 1)/2
    !> Step of the scan and distance of equal frequencies, in bandwidths: a peak extends half a bandwidth to either side, so that
    !> the scan meets each. Frequencies closer than about the square root of rounding have the same amplitude.
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

  !> Stated frequencies and those that resolve the response between the first and the last of them: hundredths of the interval,
  !> each mode, and up to 16 bandwidths to either side of it. Ascending, rad/s.
  pure function frequencies_around(model, stated) result(angular)
    type(modal_model_t), intent(in) :: model
    real(dp), intent(in) :: stated(:)            !< rad/s, ascending
    real(dp), allocatable :: angular(:)
    !> Distances from a mode, in bandwidths: ten within that of the peak.
    real(dp), parameter :: one_side(*) = [0.1_dp, 0.2_dp, 0.3_dp, 0.4_dp, 0.5_dp, 0.75_dp, 1.0_dp, 1.5_dp, 2.0_dp, 4.0_dp, &
                                          8.0_dp, 16.0_dp]
    real(dp), parameter :: around(*) = [-one_side, 0.0_dp, one_side]
    integer, parameter :: between = 100
    !> Largest relative rounding difference of one frequency computed in two ways.
    real(dp), parameter :: apart = 1e-12_dp
    integer :: i, k, n

    n = size(stated)
    angular = [stated, (stated(1) + i*(stated(n) - stated(1))/between, i=1, between - 1)]
    angular = [angular, ((model%frequency(k) + around(i)*model%damping(k), i=1, size(around)), k=1, size(model%frequency))]
    angular = sorted(pack(angular, angular >= stated(1) .and. angular <= stated(n)))
    angular = pack(angular, [.true., angular(2:) > angular(:size(angular) - 1)*(1 + apart)])
  end function frequencies_around

  !> Computes the motion of `model` from rest at the history's first time.
  !>
  !> `recorded(:)`: rows whose values are stored at each sample. `sample(:)`: times, ascending, from the history's first. `finer`:
  !> number of equal steps between two samples in the search for the largest values. `corrected`: with the static correction,
  !> which needs `residual_frequency`. `error`: memory is too small.
  subroutine superpose(model, history, recorded, sample, finer, corrected, record, error)
    type(modal_model_t), intent(in) :: model
    type(load_history_t), intent(in) :: history
    integer, intent(in) :: recorded(:), finer
    real(dp), intent(in) :: sample(:)
    logical, intent(in) :: corrected
    type(motion_record_t), intent(out) :: record
    type(error_t), allocatable, intent(inout) :: error
    type(modal_model_t) :: whole
    real(dp), allocatable :: force(:, :), static(:, :), weighted(:, :), p(:), v(:), modal(:, :)
    real(dp) :: time(block_size), part(block_size), now
    integer :: from(block_size), piece, i, n, looks, row

    associate (rows => size(model%shape, 1), places => size(history%weight, 1), points => size(history%time), &
               modes => size(model%frequency) + size(history%weight, 1))
      call claim_memory(8.0_dp*(points*(1.0_dp*rows + modes + places) + (2.0_dp*rows + places)*modes &
                                + 2.0_dp*size(recorded)*size(sample) + 6.0_dp*rows + (2.0_dp*rows + modes)*block_size), &
                        'the motion of a tooth under a moving load', error)
      if (allocated(error)) return
      whole = model
      if (corrected) call add_residual_modes(whole)
      allocate (weighted, source=history%weight*spread(history%load, 1, places))
      allocate (force, source=matmul(whole%force, weighted))
      allocate (static, source=matmul(model%static, weighted))
      allocate (p(size(whole%frequency)), v(size(whole%frequency)), source=0.0_dp)
      allocate (modal(size(p), block_size))
      allocate (record%time, source=sample)
      allocate (record%value(size(recorded), size(sample)), record%static(size(recorded), size(sample)))
      allocate (record%highest(rows), source=-huge(1.0_dp))
      allocate (record%lowest(rows), source=huge(1.0_dp))
      allocate (record%time_highest(rows), record%time_lowest(rows), source=0.0_dp)
    end associate
    record%static_highest = maxval(static, 2)
    record%static_lowest = minval(static, 2)
    now = history%time(1)
    piece = 1
    looks = (size(sample) - 1)*finer + 1
    n = 0
    do i = 0, looks - 1
      n = n + 1
      time(n) = time_of(i)
      call proceed(whole, history%time, force, time(n), piece, now, p, v)
      modal(:, n) = p
      from(n) = piece
      part(n) = share_of(history%time, piece, now)
      if (n < block_size .and. i < looks - 1) cycle
      call look(i - n + 1)
      n = 0
    end do

  contains

    !> Time of sample number `k`, from 0.
    pure real(dp) function time_of(k)
      integer, intent(in) :: k
      integer :: last

      last = min(k/finer + 1, size(sample) - 1)
      time_of = sample(size(sample))
      if (size(sample) > 1 .and. k < looks - 1) time_of = sample(last) + (sample(last + 1) - sample(last))*modulo(k, finer)/finer
    end function time_of

    !> Evaluates all rows at the times of the block, whose first time has number `first`.
    subroutine look(first)
      integer, intent(in) :: first
      real(dp) :: seen(size(model%shape, 1), block_size)
      integer :: j, at

      seen(:, :n) = matmul(whole%shape, modal(:, :n))
      do j = 1, n
        do row = 1, size(seen, 1)
          if (seen(row, j) > record%highest(row)) record%time_highest(row) = time(j)
          record%highest(row) = max(record%highest(row), seen(row, j))
          if (seen(row, j) < record%lowest(row)) record%time_lowest(row) = time(j)
          record%lowest(row) = min(record%lowest(row), seen(row, j))
        end do
        if (modulo(first + j - 1, finer) /= 0) cycle
        at = (first + j - 1)/finer + 1
        record%value(:, at) = seen(recorded, j)
        record%static(:, at) = between(static(recorded, :), from(j), part(j))
      end do
    end subroutine look
  end subroutine superpose

  !> Adds the omitted part of a load at each place as one more oscillator, so that the static response is exact.
  pure subroutine add_residual_modes(model)
    type(modal_model_t), intent(inout) :: model
    real(dp), allocatable :: rest(:, :), force(:, :)
    integer :: modes, i

    modes = size(model%frequency)
    allocate (rest, source=model%static - matmul(model%shape/spread(model%frequency**2, 1, size(model%shape, 1)), model%force))
    associate (w => model%residual_frequency)
      allocate (force(modes + size(w), size(w)), source=0.0_dp)
      force(:modes, :) = model%force
      do i = 1, size(w)
        force(modes + i, i) = w(i)**2
      end do
      model%frequency = [model%frequency, w]
      model%damping = [model%damping, 2*residual_damping*w]
    end associate
    model%shape = reshape([model%shape, rest], [size(rest, 1), size(force, 1)])
    call move_alloc(force, model%force)
  end subroutine add_residual_modes

  !> Advances the modes from `now` to the time `until`, through the points of the history between; `piece` is the one that ends
  !> there.
  pure subroutine proceed(model, time, force, until, piece, now, p, v)
    type(modal_model_t), intent(in) :: model
    real(dp), intent(in) :: time(:), force(:, :), until
    integer, intent(inout) :: piece
    real(dp), intent(inout) :: now, p(:), v(:)
    real(dp) :: next

    do
      next = until
      if (piece < size(time) - 1) next = min(until, time(piece + 1))
      if (next > now) call advance_mode(model%frequency, model%damping, next - now, &
                                        between(force, piece, share_of(time, piece, now)), &
                                        between(force, piece, share_of(time, piece, next)), p, v)
      now = max(now, next)
      if (piece >= size(time) - 1) return
      if (time(piece + 1) > until) return
      piece = piece + 1
    end do
  end subroutine proceed

  !> Fraction of a piece of the history up to a time, 0 to 1.
  pure real(dp) function share_of(time, piece, now) result(share)
    real(dp), intent(in) :: time(:), now
    integer, intent(in) :: piece

    share = 1
    if (time(piece + 1) > time(piece)) share = min(1.0_dp, (now - time(piece))/(time(piece + 1) - time(piece)))
  end function share_of

  pure function between(values, piece, share) result(value)
    real(dp), intent(in) :: values(:, :), share
    integer, intent(in) :: piece
    real(dp) :: value(size(values, 1))

    value = values(:, piece)*(1 - share) + values(:, piece + 1)*share
  end function between

  !> Integrates a mode over the time `h` (s) under a force that changes linearly from `before` to `after`: p" + c p' + w^2 p =
  !> force, in closed form. `p`, `v`: the modal coordinate and its rate, updated.
  elemental subroutine advance_mode(w, c, h, before, after, p, v)
    real(dp), intent(in) :: w, c, h, before, after
    real(dp), intent(inout) :: p, v
    real(dp) :: even, odd, rate, transient, transient_rate, square, d, fast, slow
    real(dp), parameter :: small = 1e-3_dp

    rate = (after - before)/h/w**2
    ! The transient part (total minus quasi-static) decays as free vibration.
    transient = p - (before/w**2 - c*rate/w**2)
    transient_rate = v - rate
    ! exp(-c h/2) times cos(d h) and sin(d h)/d with d^2 = w^2 - (c/2)^2 of either sign.
    square = (w - c/2)*(w + c/2)
    d = sqrt(abs(square))
    if (d*h < small) then
      ! Three terms of the series: the next is below rounding.
      associate (x => square*h**2)
        even = exp(-c*h/2)*(1 - x/2*(1 - x/12*(1 - x/30)))
        odd = exp(-c*h/2)*h*(1 - x/6*(1 - x/20*(1 - x/42)))
      end associate
    else if (square > 0) then
      even = exp(-c*h/2)*cos(d*h)
      odd = exp(-c*h/2)*sin(d*h)/d
    else
      ! The slower exponent, without the difference of two large numbers.
      fast = exp(-(c/2 + d)*h)
      slow = exp(-w**2/(c/2 + d)*h)
      even = (slow + fast)/2
      odd = (slow - fast)/(2*d)
    end if
    p = (even + c/2*odd)*transient + odd*transient_rate + after/w**2 - c*rate/w**2
    v = (even - c/2*odd)*transient_rate - w**2*odd*transient + rate
  end subroutine advance_mode
end module gearsweep_elastic_modal_response
