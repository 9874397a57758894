!> Quick turns: motions of many gears with errors of single teeth, at many speeds, to 1e-3 of the dynamic factor.
!>
!> A turn is integrated in few long steps, first until the transient has decayed, then once in full; the motion at its end must be
!> that at its start. Neighbouring speeds mostly have the same pairs in contact, and then share steps and laws; all gears share
!> these and the motions over the steps. The work is divided in the same way for any number of threads, so that the results have
!> the same bits.
module gearsweep_motion_quick_turn
  use, intrinsic :: iso_c_binding, only: c_ptr
  use gearsweep_base, only: dp, has_memory, leader_traps, pi, release_claim, share_traps, team, wants_stop
  use gearsweep_mesh, only: deviations_t
  use gearsweep_motion_oscillator, only: frequency_ratio, oscillator_t
  use gearsweep_motion_quick_steps, only: by_errors, follow_step, lanes, lay_maps, lay_steps, most_pairs, need_map, quick_maps_t, &
    quick_motion_t, quick_steps_t, state_t
  use gearsweep_motion_search, only: few_starts, start_alike, start_decay
  implicit none
  private
  public :: quick_motion_t, lay_errors, follow_again, follow_quickly, run_quickly

  type :: speeds_t
    integer :: set(lanes) = 0                    !< contact sets
    real(dp), dimension(lanes) :: x = 0, v = 0   !< m
    real(dp), dimension(lanes) :: least = huge(1.0_dp), largest = -huge(1.0_dp)      !< transmission error, m
    real(dp) :: sums(lanes, 2) = 0               !< as in quick_motion_t
    logical :: lost(lanes) = .false.             !< all flanks were apart at the end of a step
    type(quick_motion_t) :: motion(lanes)
  end type speeds_t

  !> Limits of the length of a step: of the natural motion (rad), of the mesh period, and of a wave of the flanks (rad), as the
  !> errors are parabolas over a step.
  real(dp), parameter :: longest_turning = 1.0_dp, longest_part = 0.08_dp, longest_wave = 0.5_dp
  !> Limits of a group of speeds that shares steps: number of speeds, and ratio of the highest to the lowest.
  integer, parameter :: most_speeds = 16
  real(dp), parameter :: widest = 2.0_dp

contains

  !> Computes the profile errors (m) at all nodes over the turn; (pair, node of all steps, mesh period).
  pure subroutine lay_errors(steps, deviations, errors)
    type(quick_steps_t), intent(in) :: steps
    type(deviations_t), intent(in) :: deviations           !< its waves have the orders of those of the steps
    real(dp), allocatable, intent(inout) :: errors(:, :, :)
    real(dp), allocatable :: c(:)
    real(dp) :: cosine, e, rate, sine
    integer :: first, i, j, k, last, n

    if (.not. allocated(errors)) allocate (errors(most_pairs, size(steps%phase), 0:deviations%periods - 1), source=0.0_dp)
    associate (teeth => deviations%teeth)
      do k = 0, deviations%periods - 1
        last = 0
        do while (last < steps%steps)
          first = last + 1
          last = first + count(steps%interval == steps%interval(first)) - 1
          do j = 1, steps%pairs(first)
            call deviations%of_both_teeth(k - (j + steps%offset(first) - 1), c)
            do i = 3*first - 2, 3*last
              e = c(ubound(c, 1))
              do n = ubound(c, 1) - 1, 0, -1
                e = e*steps%along(i, j) + c(n)
              end do
              errors(j, i, k) = e + steps%nominal(j, i)
            end do
          end do
        end do
        do i = 1, size(deviations%waves)
          associate (wave => deviations%waves(i))
            rate = 2*pi*wave%order/teeth(wave%gear)
            rate = rate*modulo(k + merge(deviations%offset, 0, wave%gear == 2), teeth(wave%gear)) + wave%phase
            cosine = wave%amplitude*sin(rate)
            sine = wave%amplitude*cos(rate)
            do n = 1, size(errors, 2)
              errors(:, n, k) = errors(:, n, k) + (cosine*steps%cosine(n, i) + sine*steps%sine(n, i))
            end do
          end associate
        end do
      end do
    end associate
  end subroutine lay_errors

  !> Finds the motions over a turn: of several that attract at a speed, the one of largest load among those that starts lead to.
  !> None counts as found where one of them does not repeat after a turn.
  pure subroutine follow_quickly(steps, maps, errors, coast_below, motions)
    type(quick_steps_t), intent(inout) :: steps
    type(quick_maps_t), intent(inout) :: maps    !< motions over the steps at the speeds
    real(dp), contiguous, intent(in) :: errors(:, :, 0:)   !< result of `lay_errors`
    real(dp), intent(in) :: coast_below(0:)      !< the coast sides are apart above this deflection, m; (mesh period)
    type(quick_motion_t), intent(out) :: motions(:)        !< (speed)
    integer, parameter :: most_periods = 2000
    type(quick_motion_t) :: others(size(motions))
    type(speeds_t) :: now
    real(dp) :: begin(2), begins(2, size(motions), size(few_starts, 2)), forgets, marks(lanes, 2)
    logical :: apart(size(motions))
    integer :: i, k, looked, s

    associate (static => steps%osc%static_deflection, n => size(motions))
      forgets = steps%osc%damping_ratio*minval(maps%turning)
      if (2*start_decay > most_periods*forgets) return
      looked = ceiling(start_decay/forgets)
      do s = 1, size(few_starts, 2)
        now = speeds_t()
        now%x = steps%osc%mean_deflection + static*few_starts(1, s)
        now%v = static*few_starts(2, s)
        call pass_transient(steps, maps, errors, 0, looked, now)
        if (s == 1) then
          call pass_transient(steps, maps, errors, looked, looked, now)
          call close_turn(steps, maps, errors, coast_below, 2*looked, looked, now, motions, marks)
          motions%motions = merge(1, 0, motions%is_found)
          begins(1, :, 1) = motions%begin(1)
          begins(2, :, 1) = motions%begin(2)
          cycle
        end if
        apart = motions%is_found .and. .not. hypot(now%x(:n) - marks(:n, 1), now%v(:n) - marks(:n, 2)) < start_alike*static
        if (.not. any(apart)) cycle
        call pass_transient(steps, maps, errors, looked, looked, now)
        call close_turn(steps, maps, errors, coast_below, 2*looked, looked, now, others)
        do i = 1, n
          if (.not. apart(i)) cycle
          motions(i)%is_found = others(i)%is_found
          begin = others(i)%begin
          if (any([(norm2(begin - begins(:, i, k)) < start_alike*static, k=1, motions(i)%motions)])) cycle
          others(i)%motions = motions(i)%motions + 1
          begins(:, i, others(i)%motions) = begin
          motions(i)%motions = others(i)%motions
          if (others(i)%is_found .and. others(i)%peak > motions(i)%peak) motions(i) = others(i)
        end do
      end do
    end associate
  end subroutine follow_quickly

  !> Integrates known motions of other steps again, and finds the differences between the largest loads.
  pure subroutine follow_again(steps, maps, errors, coast_below, motions)
    type(quick_steps_t), intent(inout) :: steps
    type(quick_maps_t), intent(inout) :: maps    !< motions over the steps at the speeds
    real(dp), contiguous, intent(in) :: errors(:, :, 0:)   !< result of `lay_errors`
    real(dp), intent(in) :: coast_below(0:)      !< the coast sides are apart above this deflection, m; (mesh period)
    type(quick_motion_t), intent(inout) :: motions(:)      !< (speed)
    type(quick_motion_t) :: found(size(motions))
    type(speeds_t) :: now
    integer :: i, looked

    looked = ceiling(start_decay/(steps%osc%damping_ratio*minval(maps%turning)))
    now%x(:size(motions)) = motions%begin(1)
    now%v(:size(motions)) = motions%begin(2)
    call pass_transient(steps, maps, errors, 0, looked, now)
    call close_turn(steps, maps, errors, coast_below, looked, 0, now, found)
    found%off = abs(found%peak - motions%peak)
    found%motions = motions%motions
    do i = 1, size(motions)
      found(i)%is_found = found(i)%is_found .and. motions(i)%is_found .and. &
                          norm2(found(i)%begin - motions(i)%begin) < start_alike*steps%osc%static_deflection
    end do
    motions = found
  end subroutine follow_again

  !> Integrates the motions over this many mesh periods from the time `first`, without evaluating them.
  pure subroutine pass_transient(steps, maps, errors, first, periods, now)
    type(quick_steps_t), intent(inout) :: steps
    type(quick_maps_t), intent(inout) :: maps
    real(dp), contiguous, intent(in) :: errors(:, :, 0:)
    integer, intent(in) :: first, periods
    type(speeds_t), intent(inout) :: now
    integer :: k

    now%motion%peak = huge(1.0_dp)
    do k = first, first + periods - 1
      call follow_period(steps, maps, errors(:, :, modulo(k, size(errors, 3))), k, .false., now)
    end do
  end subroutine pass_transient

  !> Integrates the motions over a turn from the time `first`, and over further turns where they do not yet repeat.
  pure subroutine close_turn(steps, maps, errors, coast_below, first, looked, now, motions, marks)
    type(quick_steps_t), intent(inout) :: steps
    type(quick_maps_t), intent(inout) :: maps
    real(dp), contiguous, intent(in) :: errors(:, :, 0:)
    real(dp), intent(in) :: coast_below(0:)
    integer, intent(in) :: first, looked
    type(speeds_t), intent(inout) :: now
    type(quick_motion_t), intent(out) :: motions(:)        ! (speed)
    !> States at the time `looked` of a turn, m; (speed, x or v)
    real(dp), intent(out), optional :: marks(lanes, 2)
    real(dp), parameter :: near = 3e-4_dp        ! largest distance of the ends of a turn, in static deflections
    integer, parameter :: most_turns = 4
    real(dp) :: before(lanes, 2), begin(lanes, 2), at(lanes, 2)
    real(dp), dimension(lanes) :: least, nearest           ! transmission error, and its least height above coast contact, m
    logical :: awaited(lanes)
    integer :: i, k, start, turn

    associate (static => steps%osc%static_deflection, n => maps%speeds, periods => size(errors, 3))
      awaited = [(i <= n, i=1, lanes)]
      start = first
      if (present(marks)) marks = 0
      do turn = 1, most_turns
        before(:, 1) = now%x
        before(:, 2) = now%v
        now = speeds_t(now%set, now%x, now%v)
        least = huge(least)
        nearest = huge(nearest)
        do k = start, start + periods - 1
          if (modulo(k, periods) == 0) then
            begin(:, 1) = now%x
            begin(:, 2) = now%v
          end if
          if (modulo(k - looked, periods) == 0) then
            at(:, 1) = now%x
            at(:, 2) = now%v
          end if
          now%least = now%x
          call follow_period(steps, maps, errors(:, :, modulo(k, periods)), k, .true., now)
          least = min(least, now%least)
          nearest = min(nearest, now%least - coast_below(modulo(k, periods)))
        end do
        do i = 1, n
          if (.not. awaited(i)) cycle
          awaited(i) = abs(now%x(i)) < 1e4_dp*static
          if (.not. awaited(i) .or. hypot(now%x(i) - before(i, 1), now%v(i) - before(i, 2)) >= near*static) cycle
          awaited(i) = .false.
          motions(i) = quick_motion_t(nearest(i) > 0, now%motion(i)%peak, modulo(now%motion(i)%pair, periods), &
                                      now%motion(i)%place, least(i), now%largest(i), begin(i, :), now%sums(i, :)/periods, &
                                      lost=now%lost(i))
          if (present(marks)) marks(i, :) = at(i, :)
        end do
        if (.not. any(awaited)) return
        where (.not. abs(now%x) < 1e4_dp*static)
          now%x = 0
          now%v = 0
        end where
      end do
    end associate
  end subroutine close_turn

  !> Integrates the motions over one mesh period.
  pure subroutine follow_period(steps, maps, errors, period, is_noted, now)
    type(quick_steps_t), intent(inout) :: steps
    type(quick_maps_t), intent(inout) :: maps
    real(dp), contiguous, intent(in) :: errors(:, :)        ! (pair, node of all steps)
    integer, intent(in) :: period
    logical, intent(in) :: is_noted              ! true: record extremes and sums
    type(speeds_t), intent(inout) :: now
    real(dp), dimension(lanes) :: apart, bend, off, peak, trouble, v, x
    real(dp) :: hollow, r(3), touching(3)
    type(state_t) :: state
    integer :: usual, i, j, k, l, shift

    peak = now%motion%peak
    usual = most_common(now%set(:maps%speeds))
    apart = merge(-1, 1, now%set == usual)
    do i = 1, steps%steps
      if (steps%begins(i)) then
        k = merge(steps%steps, i - 1, i == 1)
        shift = steps%offset(k) - steps%offset(i) + merge(1, 0, i == 1)
        now%set = iand(ishft(now%set, shift), 2**steps%pairs(i) - 1)
        usual = iand(ishft(usual, shift), 2**steps%pairs(i) - 1)
      end if
      if (.not. maps%is_known(usual, i)) call need_map(steps, usual, i, maps)
      associate (law => steps%law(usual, i), a => maps%of(:, :, :, usual, i), error => errors(:, 3*i - 2:3*i))
        r = steps%osc%static_deflection + by_errors(law%pull, error)
        do l = 1, lanes
          x(l) = (a(l, 1, 1)*now%x(l) + a(l, 2, 1)*now%v(l)) + (a(l, 3, 1)*r(1) + a(l, 4, 1)*r(2) + a(l, 5, 1)*r(3))
          v(l) = (a(l, 1, 2)*now%x(l) + a(l, 2, 2)*now%v(l)) + (a(l, 3, 2)*r(1) + a(l, 4, 2)*r(2) + a(l, 5, 2)*r(3))
          bend(l) = steps%width(i)/8*maps%turning(l)*(now%v(l) - v(l))
        end do
        trouble = apart
        do j = 1, steps%pairs(i)
          touching = by_errors(law%touching(:, :, j), error)
          hollow = (touching(1) + touching(3))/2 - touching(2)
          if (btest(usual, j - 1)) then
            do l = 1, lanes
              off(l) = abs(bend(l) + hollow)
              trouble(l) = max(trouble(l), off(l) - min(now%x(l) - touching(1), x(l) - touching(3)), &
                               law%stiffest(j)*(max(now%x(l) - touching(1), x(l) - touching(3)) + 1.25_dp*off(l)) - peak(l))
            end do
          else
            do l = 1, lanes
              trouble(l) = max(trouble(l), max(now%x(l) - touching(1), x(l) - touching(3)) + abs(bend(l) + hollow))
            end do
          end if
        end do
      end associate
      if (largest_of(trouble) > 0) then
        do l = 1, maps%speeds
          if (.not. trouble(l) > 0) cycle
          state = state_t(now%x(l), now%v(l), set=now%set(l))
          call follow_step(steps, maps, errors(:, 3*i - 2:3*i), i, period, l, state, now%motion(l))
          x(l) = state%x
          v(l) = state%v
          now%set(l) = state%set
          peak(l) = now%motion(l)%peak
        end do
        usual = most_common(now%set(:maps%speeds))
        apart = merge(-1, 1, now%set == usual)
      end if
      if (is_noted) now%lost = now%lost .or. now%set == 0
      if (is_noted) call note_errors(maps%turning, steps%width(i), steps%osc%mean_deflection, x, v, now)
      now%x = x
      now%v = v
    end do
  end subroutine follow_period

  !> Largest value of all lanes.
  pure real(dp) function largest_of(values) result(largest)
    real(dp), intent(in) :: values(lanes)
    real(dp) :: half(lanes/2), quarter(lanes/4)

    ! The compiler turns maxima of halves into vector instructions.
    half = max(values(:lanes/2), values(lanes/2 + 1:))
    quarter = max(half(:lanes/4), half(lanes/4 + 1:))
    largest = maxval(quarter)
  end function largest_of

  !> Most frequent contact set of the speeds.
  pure integer function most_common(set)
    integer, intent(in) :: set(:)
    integer :: i, most

    most_common = set(1)
    if (all(set == set(1))) return
    most = 0
    do i = 1, size(set)
      if (count(set == set(i)) <= most) cycle
      most_common = set(i)
      most = count(set == set(i))
    end do
  end function most_common

  !> Adds extremes and sums of the transmission error over a step, by the cubic through the states at both ends.
  pure subroutine note_errors(turning, width, centre, x, v, now)
    real(dp), intent(in) :: turning(lanes), width, centre
    real(dp), intent(in) :: x(lanes), v(lanes)   ! state at the end of the step, m
    type(speeds_t), intent(inout) :: now         ! motions at the start of the step
    real(dp) :: at, beyond(lanes), c(0:3), extreme, middle(lanes), slope, span
    integer :: l

    do l = 1, lanes
      middle(l) = width/8*turning(l)*(now%v(l) - v(l))
      ! Between velocities of different sign, the cubic exceeds its ends by at most 32/27 of this.
      beyond(l) = max(max(now%x(l), x(l)) - now%largest(l), now%least(l) - min(now%x(l), x(l))) + 1.25_dp*abs(middle(l))
      middle(l) = (now%x(l) + x(l))/2 - centre + middle(l)
      now%sums(l, 1) = now%sums(l, 1) + width/6*(now%x(l) + x(l) - 2*centre + 4*middle(l))
      now%sums(l, 2) = now%sums(l, 2) + width/6*((now%x(l) - centre)**2 + (x(l) - centre)**2 + 4*middle(l)**2)
      now%least(l) = min(now%least(l), x(l))
      now%largest(l) = max(now%largest(l), x(l))
    end do
    if (.not. largest_of(beyond) > 0) return
    do l = 1, lanes
      if (.not. beyond(l) > 0 .or. now%v(l)*v(l) >= 0) cycle
      span = width*turning(l)
      c(0) = now%x(l)
      c(1) = span*now%v(l)
      c(2) = 3*(x(l) - now%x(l)) - span*(2*now%v(l) + v(l))
      c(3) = 2*(now%x(l) - x(l)) + span*(now%v(l) + v(l))
      at = now%v(l)/(now%v(l) - v(l))
      slope = 2*c(2) + 6*at*c(3)
      if (abs(slope) > abs(c(2))/8) at = max(0.0_dp, min(1.0_dp, at - (c(1) + at*(2*c(2) + 3*at*c(3)))/slope))
      extreme = c(0) + at*(c(1) + at*(c(2) + at*c(3)))
      now%least(l) = min(now%least(l), extreme)
      now%largest(l) = max(now%largest(l), extreme)
    end do
  end subroutine note_errors

  !> Finds the motions at all speeds for all pairs of gears. None is found where one does not repeat after a turn, where the coast
  !> sides touch, where neighbouring speeds have other numbers of motions, where too many pairs may be in contact, where memory is
  !> short or where the caller stops the run.
  subroutine run_quickly(osc, deviations, rpm, threads, stop, motions)
    type(oscillator_t), intent(in) :: osc        !< oscillator of nominal teeth
    !> Deviations of each pair of gears, over the same turn and with waves of the same orders.
    type(deviations_t), intent(in) :: deviations(:)
    real(dp), intent(in) :: rpm(:)               !< speeds of the pinion, ascending, 1/min
    integer, intent(in) :: threads               !< 0: all threads of the machine
    type(c_ptr), intent(in) :: stop              !< stop flag of gearsweep_base_memory
    type(quick_motion_t), intent(out) :: motions(:, :)     !< (speed, pair of gears)
    integer, allocatable :: first(:)
    integer :: i
    type(c_ptr) :: traps

    first = [1]
    do i = 2, size(rpm)
      if (rpm(i) > widest*rpm(first(size(first))) .or. i - first(size(first)) == most_speeds) first = [first, i]
    end do
    first = [first, size(rpm) + 1]
    traps = leader_traps()
    !$omp parallel do default(none) shared(osc, deviations, rpm, stop, motions, first, traps) &
    !$omp schedule(dynamic, 1) num_threads(team(threads, size(first) - 1))
    do i = 1, size(first) - 1
      call share_traps(traps, 1)
      call run_group(osc, deviations, rpm(first(i):first(i + 1) - 1), stop, motions(first(i):first(i + 1) - 1, :))
      call release_claim()
      call share_traps(traps, 0)
    end do
    !$omp end parallel do
    do i = 1, size(motions, 2)
      where (are_edges(motions(:, i))) motions(:, i)%is_found = .false.
    end do
  end subroutine run_quickly

  !> True for the speeds next to a change in the number of motions: there a start may be near the boundary between two motions,
  !> and lead to the other one in other steps.
  pure function are_edges(motions)
    type(quick_motion_t), intent(in) :: motions(:)         ! (speed)
    logical :: are_edges(size(motions)), differ(size(motions) - 1)

    associate (n => size(motions))
      differ = motions(2:)%motions /= motions(:n - 1)%motions
      are_edges = [differ, .false.] .or. [.false., differ]
    end associate
  end function are_edges

  !> Finds the motions of a group of speeds that shares steps.
  subroutine run_group(osc, deviations, rpm, stop, motions)
    type(oscillator_t), intent(in) :: osc
    type(deviations_t), intent(in) :: deviations(:)
    real(dp), intent(in) :: rpm(:)
    type(c_ptr), intent(in) :: stop
    type(quick_motion_t), intent(inout) :: motions(:, :)
    type(quick_steps_t) :: fine, steps           ! `fine` has steps half as long
    type(quick_maps_t), dimension((size(rpm) - 1)/lanes + 1) :: fine_maps, maps
    type(quick_motion_t) :: again(lanes)
    real(dp), allocatable :: coast_below(:), errors(:, :, :), fine_errors(:, :, :), turning(:)
    real(dp) :: longest
    logical :: fits
    integer :: i, k, last

    turning = 2*pi/frequency_ratio(osc, rpm)
    longest = min(longest_part, longest_turning/maxval(turning))
    associate (waves => deviations(1)%waves)
      if (size(waves) > 0) longest = min(longest, longest_wave/(2*pi*maxval(waves%order/real(osc%mesh%teeth(waves%gear), dp))))
      call lay_steps(osc, waves, longest, steps)
    end associate
    if (steps%steps == 0) return
    associate (sets => size(steps%law, 1), n => steps%steps)
      call has_memory(3*real(n, dp)*(sets*(storage_size(steps%law)/8 + 80.0_dp*lanes*size(maps)) + &
                                   96.0_dp*deviations(1)%periods), fits)
      if (.not. fits) return
    end associate
    do i = 1, size(maps)
      call lay_maps(steps, turning(lanes*(i - 1) + 1:min(lanes*i, size(rpm))), maps(i))
    end do
    do k = 1, size(deviations)
      if (wants_stop(stop)) return
      if (.not. alike(deviations(1), deviations(k))) cycle
      call lay_errors(steps, deviations(k), errors)
      coast_below = [(-huge(1.0_dp), i=1, deviations(k)%periods)]
      if (osc%has_backlash) coast_below = [(deviations(k)%coast_nearer(i, osc%pairs) - osc%backlash, &
                                            i=0, deviations(k)%periods - 1)]
      do i = 1, size(maps)
        last = min(lanes*i, size(rpm))
        call follow_quickly(steps, maps(i), errors, coast_below, motions(lanes*(i - 1) + 1:last, k))
      end do
      ! Where all flanks part, long steps may have larger errors than the sample shows.
      if (.not. any(motions(:, k)%lost)) cycle
      if (fine%steps == 0) then
        call lay_steps(osc, deviations(1)%waves, longest/2, fine)
        if (fine%steps == 0) return
        do i = 1, size(maps)
          call lay_maps(fine, turning(lanes*(i - 1) + 1:min(lanes*i, size(rpm))), fine_maps(i))
        end do
      end if
      call lay_errors(fine, deviations(k), fine_errors)
      do i = 1, size(maps)
        last = min(lanes*i, size(rpm))
        associate (some => motions(lanes*(i - 1) + 1:last, k))
          if (.not. any(some%lost)) cycle
          again(:size(some)) = some
          call follow_again(fine, fine_maps(i), fine_errors, coast_below, again(:size(some)))
          where (some%lost) some = again(:size(some))
        end associate
      end do
    end do
  end subroutine run_group

  !> True if both deviations repeat after the same turn, with waves of the same orders.
  pure logical function alike(a, b)
    type(deviations_t), intent(in) :: a, b

    alike = a%periods == b%periods .and. size(a%waves) == size(b%waves)
    if (alike) alike = all(a%waves%order == b%waves%order .and. a%waves%gear == b%waves%gear)
  end function alike
end module gearsweep_motion_quick_turn
