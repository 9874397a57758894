!> Modal superposition under a load that moves: each mode is one oscillator, and what is looked at is a sum over the modes.
!>
!> Between two points of its history each modal force is linear in time. Over such a piece an oscillator's motion is known in
!> closed form, so that the length of a step changes how often a motion is looked at and not the motion. What the modes that
!> are left out would add to a slow load (the static correction) follows the load as one oscillator for each place.
!>
!> Sources: Clough and Penzien 1993, Dynamics of Structures, sections 4.2, 8.5 (Rayleigh's quotient) and 15.5 (static correction,
!> which there follows the load at once); the piecewise exact method in Chopra 2012, Dynamics of Structures, section 5.2.
module gearsweep_modal_superposition
  use gearsweep_error, only: error_t
  use gearsweep_kinds, only: dp
  use gearsweep_memory, only: claim_memory
  implicit none
  private
  public :: modal_model_t, load_history_t, motion_record_t, superpose, advance_mode

  !> What a body does in its modes, and what is looked at: stresses, displacements ... each a row.
  type :: modal_model_t
    real(dp), allocatable :: frequency(:)        !< of the modes, rad/s
    real(dp), allocatable :: damping(:)          !< c of p" + c p' + w^2 p = force, 1/s; (mode)
    real(dp), allocatable :: shape(:, :)         !< of each row for a modal coordinate of 1 (row, mode)
    real(dp), allocatable :: force(:, :)         !< on each mode by a unit load at each place (mode, place)
    real(dp), allocatable :: static(:, :)        !< of each row, under a unit load at rest at each place (row, place)
    !> Of what the modes leave out of the displacements under a unit load at rest at each place: Rayleigh's quotient, rad/s; (place)
    real(dp), allocatable :: rest_frequency(:)
  end type modal_model_t

  !> A load in time. Between two of its points it changes linearly in time, with all that follows from it; two points at one
  !> time are a jump.
  type :: load_history_t
    real(dp), allocatable :: time(:)             !< s, not descending
    real(dp), allocatable :: load(:)             !< N
    real(dp), allocatable :: weight(:, :)        !< by how much it stands at each place (place, point)
  end type load_history_t

  !> The motion from rest.
  type :: motion_record_t
    real(dp), allocatable :: time(:)             !< of the samples, s
    real(dp), allocatable :: value(:, :)         !< of the rows that are recorded (row, sample)
    real(dp), allocatable :: static(:, :)        !< the same under the load of that time, were it at rest
    real(dp), allocatable :: highest(:), lowest(:)  !< of all rows, over all times looked at
    real(dp), allocatable :: time_highest(:), time_lowest(:)  !< s
    real(dp), allocatable :: static_highest(:), static_lowest(:)  !< of all rows under the load at rest
  end type motion_record_t

  !> Times that are looked at together.
  integer, parameter :: block_size = 64
  !> Damping ratio of what the modes leave out: it is many modes, whose swings part from each other and cancel within about one of
  !> them, however little each is damped.
  real(dp), parameter :: rest_damping = 0.5_dp

contains

  !> The motion of `model` from rest at the history's first time.
  !>
  !> `recorded(:)`: rows whose values are kept at each sample. `sample(:)`: times, ascending, from the history's first.
  !> `finer`: into so many equal steps each time between two samples is cut to look for the largest values.
  !> `corrected`: with the static correction, which needs `rest_frequency`. `error`: the memory does not hold it.
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
      if (corrected) call add_rest(whole)
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

    !> All rows at the times of the block, whose first look has number `first`.
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

  !> Adds what the modes leave out of a load at each place as one more oscillator, so that the model is exact at rest.
  pure subroutine add_rest(model)
    type(modal_model_t), intent(inout) :: model
    real(dp), allocatable :: rest(:, :), force(:, :)
    integer :: modes, i

    modes = size(model%frequency)
    allocate (rest, source=model%static - matmul(model%shape/spread(model%frequency**2, 1, size(model%shape, 1)), model%force))
    associate (w => model%rest_frequency)
      allocate (force(modes + size(w), size(w)), source=0.0_dp)
      force(:modes, :) = model%force
      do i = 1, size(w)
        force(modes + i, i) = w(i)**2
      end do
      model%frequency = [model%frequency, w]
      model%damping = [model%damping, 2*rest_damping*w]
    end associate
    model%shape = reshape([model%shape, rest], [size(rest, 1), size(force, 1)])
    call move_alloc(force, model%force)
  end subroutine add_rest

  !> From `now` to the time `until`, through the points of the history that lie between; `piece` is the one that ends there.
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

  !> How far a time lies in a piece of the history, 0 to 1.
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

  !> A mode over the time `h` (s) under a force that changes linearly from `before` to `behind`: p" + c p' + w^2 p = force, in
  !> closed form. `p`, `v`: the modal coordinate and its rate, which change.
  elemental subroutine advance_mode(w, c, h, before, behind, p, v)
    real(dp), intent(in) :: w, c, h, before, behind
    real(dp), intent(inout) :: p, v
    real(dp) :: even, odd, rate, rest, rest_rate

    rate = (behind - before)/h/w**2
    ! What is left when the motion that follows the force is taken off dies away freely.
    rest = p - (before/w**2 - c*rate/w**2)
    rest_rate = v - rate
    call free_motion(w, c, h, even, odd)
    p = (even + c/2*odd)*rest + odd*rest_rate + behind/w**2 - c*rate/w**2
    v = (even - c/2*odd)*rest_rate - w**2*odd*rest + rate
  end subroutine advance_mode

  !> exp(-c h/2) times cos(d h) and sin(d h)/d with d^2 = w^2 - (c/2)^2 of either sign.
  elemental subroutine free_motion(w, c, h, even, odd)
    real(dp), intent(in) :: w, c, h
    real(dp), intent(out) :: even, odd
    real(dp), parameter :: small = 1e-3_dp
    real(dp) :: square, d, fast, slow

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
      ! The slow exponent without the difference of two large numbers.
      fast = exp(-(c/2 + d)*h)
      slow = exp(-w**2/(c/2 + d)*h)
      even = (slow + fast)/2
      odd = (slow - fast)/(2*d)
    end if
  end subroutine free_motion
end module gearsweep_modal_superposition
