!> Steady motions in full contact for many amounts of one relief, at the speeds of a batch.
!>
!> While all pairs carry, the equation of motion is linear, and the profile error of a relief is its amount times a shape.
!> So the motion is that of the load without relief and, times the amount, that of the relief without load: two motions
!> of one map serve all amounts. The load of a pair is linear in the amount as well, and its largest value convex.
module gearsweep_superposition
  use gearsweep_coefficients, only: coefficients_t
  use gearsweep_contact_set, only: period_t
  use gearsweep_dte, only: dte_batch_t, dte_of, dte_t, raise_range, some_turn, weights_of_end
  use gearsweep_gauss, only: batch_size
  use gearsweep_kinds, only: dp
  use gearsweep_load_peaks, only: largest_within, load_over_step, may_exceed
  use gearsweep_oscillator, only: acceleration
  use gearsweep_period_map, only: compose, flush_to_zero, period_map_t, propagate_alike, take_step
  use gearsweep_periodic_orbit, only: closure_of, judge, newton_step, steady_t
  implicit none
  private
  public :: superpose

  !> By the load alone, and by the profile error alone.
  integer, parameter :: by_load = 1, by_relief = 2

  !> The two motions over a period.
  type :: motions_t
    real(dp), allocatable :: x(:, :, :, :)         !< x and y at the ends of steps, m; (speed, x or y, motion, 0:steps)
    real(dp) :: monodromy(batch_size, 4) = 0       !< columns one after the other
    real(dp) :: checksum(batch_size, 2) = 0        !< as in period_t; (speed, motion)
    !> Integrals of the deflections, of their squares, and between these of twice the product.
    real(dp) :: first(batch_size, 2) = 0, second(batch_size, 3) = 0
    logical :: solved(batch_size) = .false.
  end type motions_t

  !> Loads at both ends of a step with their derivatives over it, N; (speed, derivative, end, motion).
  type :: ends_t
    real(dp) :: load(batch_size, 0:1, 2, 2)
  end type ends_t

  !> The largest loads so far of one amount, and maxima within steps that may be larger.
  integer, parameter :: most_candidates = 24
  type :: search_t
    logical :: carries(batch_size) = .true.        !< all pairs so far, all the time
    type(dte_batch_t) :: range                     !< of the transmission error so far
    real(dp) :: peak(batch_size) = 0               !< N
    integer :: count(batch_size) = 0               !< of candidates
    integer :: step(most_candidates, batch_size), pair(most_candidates, batch_size)
    real(dp) :: bound(most_candidates, batch_size)  !< N
  end type search_t

contains

  !> The steady motions with these parts of the profile error of the map's oscillator.
  pure subroutine superpose(map, part, with_dte, steady)
    type(period_map_t), intent(in) :: map              !< with the durations of a batch
    real(dp), intent(in) :: part(:)                    !< of the profile error, as a factor; (amount)
    logical, intent(in) :: with_dte                    !< false: `dte_rms` and `dte_range` are 0
    !> (speed, amount); without a result where a pair may part, or the map has no periodic motion.
    type(steady_t), intent(out) :: steady(:, :)
    type(motions_t) :: motions
    type(search_t) :: search(size(part))
    integer :: i, l, r

    call find_motions(map, with_dte, motions)
    call search_peaks(map, motions, part, with_dte, search)
    do r = 1, size(part)
      do l = 1, map%speeds
        if (.not. (search(r)%carries(l) .and. motions%solved(l))) cycle
        do i = 1, search(r)%count(l)
          if (search(r)%bound(i, l) > search(r)%peak(l)) &
            call refine_peak(map, motions, l, part(r), search(r)%step(i, l), search(r)%pair(i, l), search(r)%peak(l))
        end do
        call conclude(map, motions, l, part(r), search(r)%peak(l), dte_of(search(r)%range, l), steady(l, r))
      end do
    end do
  end subroutine superpose

  !> Two periods from rest give the periodic states, and two more the motions from there.
  pure subroutine find_motions(map, with_dte, motions)
    type(period_map_t), intent(in) :: map
    logical, intent(in) :: with_dte
    type(motions_t), intent(inout) :: motions
    real(dp), parameter :: forced(2, 2) = reshape([1.0_dp, 0.0_dp, 0.0_dp, 1.0_dp], [2, 2])
    real(dp), allocatable :: propagator(:, :, :)   ! as in period_map_t, with the affine part of the other motion; (, , step)
    real(dp) :: other(batch_size, 6), step(2)
    logical :: solved
    integer :: i, k, l

    associate (table => map%table, n => map%table%steps)
      allocate (motions%x(batch_size, 2, 2, 0:n), propagator(batch_size, 8, n))
      propagator = 0
      other = 0
      motions%x(:, :, :, 0) = 0
      motions%monodromy(:, 1) = 1
      motions%monodromy(:, 4) = 1
      do i = 1, n
        call propagate_alike(map%osc, table, i, map%duration(:map%speeds), i, forced(:, 1), propagator(:, :6, i))
        call propagate_alike(map%osc, table, i, map%duration(:map%speeds), i, forced(:, 2), other)
        propagator(:, 7:8, i) = other(:, 5:6)
        call compose(propagator(:, :6, i), motions%monodromy)
        if (modulo(i, 64) == 0) call flush_to_zero(motions%monodromy)
        call take_steps(propagator(:, :, i), motions%x(:, :, :, i - 1), motions%x(:, :, :, i))
      end do
      motions%solved(:map%speeds) = .true.
      do l = 1, map%speeds
        do k = 1, 2
          call newton_step(reshape(motions%monodromy(l, :), [2, 2]), [motions%x(l, 1, k, n), motions%x(l, 2, k, n)], step, solved)
          motions%x(l, :, k, 0) = step
          motions%solved(l) = motions%solved(l) .and. solved
        end do
      end do
      do i = 1, n
        if (table%kind(i)%begins) motions%checksum = motions%checksum + motions%x(:, 1, :, i - 1)
        call take_steps(propagator(:, :, i), motions%x(:, :, :, i - 1), motions%x(:, :, :, i))
        if (with_dte) call add_integrals(table, i, motions)
      end do
    end associate
  end subroutine find_motions

  !> A step of both motions.
  pure subroutine take_steps(propagator, before, after)
    real(dp), intent(in) :: propagator(batch_size, 8)
    real(dp), intent(in) :: before(batch_size, 2, 2)
    real(dp), intent(out) :: after(batch_size, 2, 2)
    integer :: l

    call take_step(propagator(:, :6), before(:, 1, 1), before(:, 2, 1), after(:, 1, 1), after(:, 2, 1))
    do l = 1, batch_size
      after(l, 1, 2) = propagator(l, 1)*before(l, 1, 2) + propagator(l, 3)*before(l, 2, 2) + propagator(l, 7)
      after(l, 2, 2) = propagator(l, 2)*before(l, 1, 2) + propagator(l, 4)*before(l, 2, 2) + propagator(l, 8)
    end do
  end subroutine take_steps

  !> Largest loads at the ends of steps, where all pairs carry, and candidates for larger ones between them.
  pure subroutine search_peaks(map, motions, part, with_dte, search)
    type(period_map_t), intent(in) :: map
    type(motions_t), intent(in) :: motions
    real(dp), intent(in) :: part(:)
    logical, intent(in) :: with_dte
    type(search_t), intent(inout) :: search(:)
    type(ends_t) :: ends
    integer :: i, j, r

    do r = 1, size(part)
      search(r)%carries(map%speeds + 1:) = .false.
    end do
    do i = 1, map%table%steps
      do r = 1, merge(size(part), 0, with_dte)
        if (any(search(r)%carries)) call watch_range(map%table%width(i), motions%x(:, :, :, i - 1:i), part(r), search(r)%range)
      end do
      do j = 1, map%table%pairs(i)
        call find_loads(map, motions, i, j, ends)
        do r = 1, size(part)
          if (any(search(r)%carries)) call try_step(map, motions, part(r), i, j, ends, search(r))
        end do
      end do
    end do
  end subroutine search_peaks

  !> The integrals of the transmission error by the end of a step, counted from where each motion begins.
  pure subroutine add_integrals(table, step, motions)
    type(coefficients_t), intent(in) :: table
    integer, intent(in) :: step
    type(motions_t), intent(inout) :: motions
    real(dp) :: place, slope, x(2), y(2)
    integer :: l

    call weights_of_end(table%width(step), table%width(merge(1, step + 1, step == table%steps)), place, slope)
    do l = 1, batch_size
      x = motions%x(l, 1, :, step) - motions%x(l, 1, :, 0)
      y = slope*motions%x(l, 2, :, step)
      motions%first(l, :) = motions%first(l, :) + place*x + y
      motions%second(l, 1) = motions%second(l, 1) + (place*x(1) + 2*y(1))*x(1)
      motions%second(l, 2) = motions%second(l, 2) + 2*((place*x(1) + y(1))*x(2) + x(1)*y(2))
      motions%second(l, 3) = motions%second(l, 3) + (place*x(2) + 2*y(2))*x(2)
    end do
  end subroutine add_integrals

  !> The range of the transmission error of one amount over a step.
  pure subroutine watch_range(width, x, part, dte)
    real(dp), intent(in) :: width
    real(dp), intent(in) :: x(batch_size, 2, 2, 2)         ! as in motions_t; (speed, x or y, motion, end)
    real(dp), intent(in) :: part
    type(dte_batch_t), intent(inout) :: dte
    real(dp), dimension(batch_size) :: left, right

    left = x(:, 2, by_load, 1) + part*x(:, 2, by_relief, 1)
    right = x(:, 2, by_load, 2) + part*x(:, 2, by_relief, 2)
    if (.not. some_turn(left, right)) return
    call raise_range(width, x(:, 1, by_load, 1) + part*x(:, 1, by_relief, 1), left, &
                     x(:, 1, by_load, 2) + part*x(:, 1, by_relief, 2), right, dte)
  end subroutine watch_range

  !> The loads of pair j at both ends of a step, by each of the two motions.
  pure subroutine find_loads(map, motions, step, j, ends)
    type(period_map_t), intent(in) :: map
    type(motions_t), intent(in) :: motions
    integer, intent(in) :: step, j
    type(ends_t), intent(inout) :: ends
    real(dp) :: g(0:1), t(0:1), w, slope
    integer :: end, m, l

    associate (table => map%table, width => map%table%width(step))
      do end = 1, 2
        g = table%effective(:1, j, end, step)
        do m = by_load, by_relief
          t = 0
          if (m == by_relief) t = table%touching(:1, j, end, step)
          do l = 1, batch_size
            w = motions%x(l, 1, m, step + end - 2) - t(0)
            slope = motions%x(l, 2, m, step + end - 2) - t(1)
            ends%load(l, 0, end, m) = g(0)*w
            ends%load(l, 1, end, m) = width*(g(1)*w + g(0)*slope)
          end do
        end do
      end do
    end associate
  end subroutine find_loads

  !> A convex load stays above its tangents, a concave one below.
  pure subroutine try_step(map, motions, part, step, j, ends, search)
    type(period_map_t), intent(in) :: map
    type(motions_t), intent(in) :: motions
    real(dp), intent(in) :: part
    integer, intent(in) :: step, j
    type(ends_t), intent(in) :: ends
    type(search_t), intent(inout) :: search
    real(dp), dimension(batch_size) :: left, right, bound, lowest
    real(dp) :: left_slope, right_slope, up(2), down(2)
    integer :: l

    do l = 1, batch_size
      left(l) = ends%load(l, 0, 1, 1) + part*ends%load(l, 0, 1, 2)
      right(l) = ends%load(l, 0, 2, 1) + part*ends%load(l, 0, 2, 2)
      left_slope = ends%load(l, 1, 1, 1) + part*ends%load(l, 1, 1, 2)
      right_slope = ends%load(l, 1, 2, 1) + part*ends%load(l, 1, 2, 2)
      up(1) = max(0.0_dp, left_slope)
      up(2) = max(0.0_dp, -right_slope)
      down(1) = max(0.0_dp, -left_slope)
      down(2) = max(0.0_dp, right_slope)
      bound(l) = max(left(l), right(l)) + min(up(1), up(2), (up(1) + up(2))/4)
      lowest(l) = min(left(l), right(l)) - min(down(1), down(2), (down(1) + down(2))/4)
    end do
    search%carries = search%carries .and. lowest > 0
    do l = 1, batch_size
      search%peak(l) = max(search%peak(l), left(l), right(l))
    end do
    if (.not. any(bound > search%peak)) return
    do l = 1, map%speeds
      if (search%carries(l) .and. bound(l) > search%peak(l)) call add_candidate(map, motions, l, part, step, j, bound(l), search)
    end do
  end subroutine try_step

  !> Where there is no room, those that the largest load has passed meanwhile are dropped, or the maximum is found at once.
  pure subroutine add_candidate(map, motions, l, part, step, j, bound, search)
    type(period_map_t), intent(in) :: map
    type(motions_t), intent(in) :: motions
    integer, intent(in) :: l, step, j
    real(dp), intent(in) :: part, bound
    type(search_t), intent(inout) :: search
    integer :: i, n

    n = search%count(l)
    if (n == most_candidates) then
      n = 0
      do i = 1, most_candidates
        if (.not. search%bound(i, l) > search%peak(l)) cycle
        n = n + 1
        search%bound(n, l) = search%bound(i, l)
        search%step(n, l) = search%step(i, l)
        search%pair(n, l) = search%pair(i, l)
      end do
      search%count(l) = n
    end if
    if (n == most_candidates) then
      call refine_peak(map, motions, l, part, step, j, search%peak(l))
    else
      search%count(l) = n + 1
      search%bound(n + 1, l) = bound
      search%step(n + 1, l) = step
      search%pair(n + 1, l) = j
    end if
  end subroutine add_candidate

  !> Raises the largest load by that of a pair within a step.
  pure subroutine refine_peak(map, motions, l, part, step, j, peak)
    type(period_map_t), intent(in) :: map
    type(motions_t), intent(in) :: motions
    integer, intent(in) :: l, step, j
    real(dp), intent(in) :: part
    real(dp), intent(inout) :: peak
    real(dp) :: x(0:2, 2), load(0:2, 2)

    x = motion_over(map, motions, l, part, step)
    call load_over_step(map%table, step, step, j, x, load, part)
    if (may_exceed(load, peak)) peak = max(peak, largest_within(map%osc, map%table, step, step, j, x, load, part))
  end subroutine refine_peak

  !> The deflection at both ends of a step with its derivatives over it, m; (derivative, end).
  pure function motion_over(map, motions, l, part, step) result(x)
    type(period_map_t), intent(in) :: map
    type(motions_t), intent(in) :: motions
    integer, intent(in) :: l, step
    real(dp), intent(in) :: part
    real(dp) :: x(0:2, 2)
    integer :: end

    associate (table => map%table, width => map%table%width(step))
      do end = 1, 2
        x(:1, end) = motions%x(l, :, by_load, step + end - 2) + part*motions%x(l, :, by_relief, step + end - 2)
        x(2, end) = acceleration(map%osc, table%end_omega_squared(0, end, step), part*table%end_forcing(0, end, step), &
                                 map%duration(l), x(0, end), x(1, end))
      end do
      x(1, :) = width*x(1, :)
      x(2, :) = width**2*x(2, :)
    end associate
  end function motion_over

  !> The steady motion of one speed and amount.
  pure subroutine conclude(map, motions, l, part, peak, range, steady)
    type(period_map_t), intent(in) :: map
    type(motions_t), intent(in) :: motions
    integer, intent(in) :: l
    real(dp), intent(in) :: part, peak
    type(dte_t), intent(in) :: range             ! its least and largest transmission error
    type(steady_t), intent(out) :: steady
    type(period_t) :: run
    real(dp) :: state(2)

    associate (x => motions%x, n => map%table%steps)
      state = x(l, :, by_load, 0) + part*x(l, :, by_relief, 0)
      run%state = x(l, :, by_load, n) + part*x(l, :, by_relief, n)
      ! Not by `reshape`, a call of the run-time library at each point.
      run%monodromy(:, 1) = motions%monodromy(l, 1:2)
      run%monodromy(:, 2) = motions%monodromy(l, 3:4)
      run%peak = peak
      run%dte = range
      run%dte%first = motions%first(l, 1) + part*motions%first(l, 2)
      run%dte%second = motions%second(l, 1) + part*(motions%second(l, 2) + part*motions%second(l, 3))
      run%checksum = motions%checksum(l, by_load) + part*motions%checksum(l, by_relief)
      call judge(map%osc, map%duration(l), state, run, closure_of(map%osc, map%duration(l), state, run), 1, steady)
    end associate
  end subroutine conclude
end module gearsweep_superposition
