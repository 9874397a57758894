!> The work of a sweep: blocks of speeds in batches, then the branch through all speeds of a relief. Both stop where the
!> caller wants it, and go on from there.
module gearsweep_sweep_work
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use gearsweep_coefficients, only: scheme_collocation
  use gearsweep_continuation, only: carried, continue_to
  use gearsweep_error_estimate, only: point_t
  use gearsweep_gauss, only: batch_size
  use gearsweep_kinds, only: dp
  use gearsweep_operating_point, only: solve_batch, solve_family, solve_point
  use gearsweep_oscillator, only: mesh_period, oscillator_t
  use gearsweep_periodic_orbit, only: distance
  use gearsweep_refinement, only: levels_t
  use gearsweep_status, only: has_result, status_stopped, status_unbounded, status_unresolved
  use gearsweep_sweep_state, only: block_t, counter_t, down, each, is_stopped, sweep_options_t, sweep_state_t, up
  use gearsweep_transient, only: by_shooting
  implicit none
  private
  public :: solve_family_block, solve_block, continue_sweep, return_from_above

contains

  !> Speeds first to last with all reliefs of a family, as far as all pairs stay in contact.
  subroutine solve_family_block(osc, part, rpm, options, block, counter, levels, points, solved)
    type(oscillator_t), intent(in) :: osc            !< the family's reference
    real(dp), intent(in) :: part(:)                  !< of its profile error; (relief)
    real(dp), intent(in) :: rpm(:)                   !< speeds of the pinion, ascending, 1/min
    type(sweep_options_t), intent(in) :: options
    type(block_t), intent(inout) :: block            !< of the first relief
    type(counter_t), intent(inout) :: counter
    type(levels_t), intent(inout) :: levels          !< of this oscillator
    type(point_t), intent(inout) :: points(:, :)     !< (speed, relief)
    logical, intent(inout) :: solved(:, :)           !< (speed, relief)
    type(point_t) :: found(batch_size, size(part))
    logical :: ok(batch_size, size(part))
    integer :: first, more, i, k, l

    levels%steps_per_second = block%pace_together
    do while (block%together < block%last)
      if (is_stopped(options)) return
      first = block%together + 1
      call solve_family(osc, part, mesh_period(osc%mesh%teeth(1), [(rpm(min(first + l, block%last)), l=0, batch_size - 1)]), &
                        options%accuracy, levels, found, ok)
      more = 0
      do i = 1, size(part)
        do l = 1, min(batch_size, block%last - first + 1)
          k = first + l - 1
          if (solved(k, i) .or. .not. ok(l, i)) cycle
          points(k, i) = found(l, i)
          solved(k, i) = .true.
          more = more + 1
        end do
      end do
      block%together = min(first + batch_size - 1, block%last)
      block%pace_together = levels%steps_per_second
      if (options%direction == each) call counter%tick(2*more)
    end do
  end subroutine solve_family_block

  !> Each speed of a block by itself. Where a branch is to be followed, only those for which a batch converges, as full
  !> contact decides them.
  subroutine solve_block(osc, rpm, options, block, counter, levels, points, solved)
    type(oscillator_t), intent(in) :: osc            !< of the block's relief
    real(dp), intent(in) :: rpm(:)                   !< speeds of the pinion, ascending, 1/min
    type(sweep_options_t), intent(in) :: options
    type(block_t), intent(inout) :: block
    type(counter_t), intent(inout) :: counter
    type(levels_t), intent(inout) :: levels          !< of this oscillator
    type(point_t), intent(inout) :: points(:)        !< (speed)
    logical, intent(inout) :: solved(:)              !< (speed)
    integer :: k, last, before

    ! The result shall not depend on what the levels were used for before.
    levels%steps_per_second = block%pace
    do while (block%grouped < block%last)
      if (is_stopped(options)) return
      k = block%grouped + 1
      last = block%last
      before = count(solved(k:last))
      ! A single speed is faster by itself than in a batch.
      if (size(rpm) > 1 .and. options%accuracy%steps == 0 .and. options%accuracy%steady%method == by_shooting .and. &
          options%accuracy%scheme == scheme_collocation) then
        last = min(k + batch_size - 1, last)
        before = count(solved(k:last))
        if (.not. all(solved(k:last))) call solve_group(osc, rpm(k:last), options, levels, points(k:last), solved(k:last))
      end if
      block%grouped = last
      block%pace = levels%steps_per_second
      call counter%tick(merge(2*(count(solved(k:last)) - before), last - k + 1, options%direction == each))
    end do
    if (options%direction /= each) return
    do while (block%single < block%last)
      k = block%single + 1
      if (.not. solved(k)) then
        if (is_stopped(options)) return
        call solve_point(osc, mesh_period(osc%mesh%teeth(1), rpm(k)), options%accuracy, levels, points(k))
        if (points(k)%steady%status == status_stopped) return
        solved(k) = .true.
        call counter%tick(2)
      end if
      block%single = k
      block%pace = levels%steps_per_second
    end do
  end subroutine solve_block

  !> Speeds in a batch, of which some may be solved already; the last one fills the places that are left.
  subroutine solve_group(osc, rpm, options, levels, points, solved)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm(:)
    type(sweep_options_t), intent(in) :: options
    type(levels_t), intent(inout) :: levels
    type(point_t), intent(inout) :: points(:)
    logical, intent(inout) :: solved(:)
    type(point_t) :: found(batch_size)
    logical :: ok(batch_size)
    integer :: k

    call solve_batch(osc, mesh_period(osc%mesh%teeth(1), [(rpm(min(k, size(rpm))), k=1, batch_size)]), options%accuracy, &
                     levels, found, ok)
    do k = 1, size(rpm)
      if (solved(k)) cycle
      points(k) = found(k)
      solved(k) = ok(k)
    end do
  end subroutine solve_group

  !> Goes through the speeds of a relief, up or down, and solves what is left, or lies on another branch than the speed
  !> before. Where that branch leads to no motion, the speed is solved by itself, unless its motion grows without bound:
  !> then there is none to come back to.
  subroutine continue_sweep(osc, rpm, options, relief, counter, levels, state)
    type(oscillator_t), intent(in) :: osc            !< of the relief
    real(dp), intent(in) :: rpm(:)                   !< speeds of the pinion, ascending, 1/min
    type(sweep_options_t), intent(in) :: options
    integer, intent(in) :: relief                    !< which
    type(counter_t), intent(inout) :: counter
    type(levels_t), intent(inout) :: levels          !< of this oscillator
    type(sweep_state_t), intent(inout) :: state
    type(point_t) :: alone
    integer :: k, last

    associate (points => state%points(:, relief), solved => state%solved(:, relief), followed => state%followed(relief))
      levels%steps_per_second = state%pace(relief)
      do while (followed < size(rpm))
        if (is_stopped(options)) return
        k = merge(size(rpm) - followed, followed + 1, options%direction == down)
        last = merge(k + 1, k - 1, options%direction == down)
        if (followed == 0) then
          if (.not. solved(k)) &
            call solve_point(osc, mesh_period(osc%mesh%teeth(1), rpm(k)), options%accuracy, levels, points(k))
        else
          alone = points(k)
          if (.not. solved(k)) then
            call continue_sweep_to(osc, rpm(k), options, levels, points(last), rpm(last), points(k))
          else if (.not. is_beside(osc, points(last), rpm(last), points(k), rpm(k))) then
            call continue_sweep_to(osc, rpm(k), options, levels, points(last), rpm(last), points(k), alone)
          end if
          if (.not. has_result(points(last)%steady%status)) points(k)%branch_lost = .true.
        end if
        if (points(k)%steady%status == status_stopped) then
          ! Another call goes on from here.
          if (solved(k)) points(k) = alone
          return
        end if
        solved(k) = .true.
        followed = followed + 1
        state%pace(relief) = levels%steps_per_second
        call counter%tick(1)
      end do
    end associate
  end subroutine continue_sweep

  !> After the way up the way down, as far as it may meet another motion: to where, below the lowest speed at which the way up
  !> left full contact, both meet the same motion. Beside the last motion nothing is solved anew, unless contact is lost. A
  !> point becomes the larger motion.
  subroutine return_from_above(osc, rpm, options, relief, counter, levels, state)
    type(oscillator_t), intent(in) :: osc            !< of the relief
    real(dp), intent(in) :: rpm(:)                   !< speeds of the pinion, ascending, 1/min
    type(sweep_options_t), intent(in) :: options
    integer, intent(in) :: relief                    !< which
    type(counter_t), intent(inout) :: counter
    type(levels_t), intent(inout) :: levels          !< of this oscillator
    type(sweep_state_t), intent(inout) :: state      !< with the way up
    type(point_t) :: here
    integer :: k, n, lowest

    n = size(rpm)
    associate (points => state%points(:, relief), returned => state%returned(relief), above => state%above(relief))
      lowest = findloc(points(:n - returned)%steady%partial .or. loses_contact(points(:n - returned)), .true., 1)
      if (lowest == 0) lowest = n + 1
      levels%steps_per_second = state%pace(relief)
      do while (returned < n)
        if (is_stopped(options)) return
        k = n - returned
        ! Also the lowest motion on the way up may go on below.
        if (min(k + 1, n) < lowest .and. points(min(k + 1, n))%direction == 0) then
          call counter%tick(k)
          returned = n
          return
        end if
        here = points(k)
        if (.not. meets_same(osc, rpm(k:min(k + 1, n)), above, here)) then
          call come_down(osc, rpm(k:min(k + 1, n)), options, levels, above, here)
          if (here%steady%status == status_stopped) return
          call take_larger(here, options%accuracy%steady%tolerance, points(k))
        end if
        above = here
        returned = returned + 1
        state%pace(relief) = levels%steps_per_second
        call counter%tick(1)
      end do
    end associate
  end subroutine return_from_above

  !> Does the way down meet the motion of the way up? So it does where all pairs stay in contact, beside the motion above,
  !> and where both take the motion of the speed by itself.
  pure logical function meets_same(osc, rpm, above, point)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm(:)                   !< this speed and the one above, if there is one, 1/min
    type(point_t), intent(in) :: above, point        !< of the way down, at that one; of the way up, at this one

    meets_same = .not. loses_contact(point)
    if (size(rpm) == 1) return
    if (.not. has_result(above%steady%status)) then
      meets_same = meets_same .or. point%branch_lost
    else if (meets_same) then
      meets_same = is_beside(osc, above, rpm(2), point, rpm(1))
    end if
  end function meets_same

  !> The motion of a speed on the way down.
  subroutine come_down(osc, rpm, options, levels, above, point)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm(:)                   !< this speed and the one above, if there is one, 1/min
    type(sweep_options_t), intent(in) :: options
    type(levels_t), intent(inout) :: levels
    type(point_t), intent(in) :: above               !< of the way down, at that one
    type(point_t), intent(inout) :: point            !< of the way up, then of the way down
    type(point_t) :: alone

    alone = point
    if (size(rpm) == 1) then
      call solve_point(osc, mesh_period(osc%mesh%teeth(1), rpm(1)), options%accuracy, levels, point)
      return
    end if
    if (alone%branch_lost .or. .not. alone%steady%partial) then
      call continue_sweep_to(osc, rpm(1), options, levels, above, rpm(2), point, alone)
    else
      call continue_sweep_to(osc, rpm(1), options, levels, above, rpm(2), point)
    end if
    if (.not. has_result(above%steady%status)) point%branch_lost = .true.
  end subroutine come_down

  !> Were all pairs apart for a while, or is there no periodic motion to tell?
  elemental logical function loses_contact(point)
    type(point_t), intent(in) :: point

    loses_contact = point%steady%lost
    if (.not. (loses_contact .or. has_result(point%steady%status))) loses_contact = point%steady%status /= status_unresolved
  end function loses_contact

  !> Of the motions that the ways up and down meet at a speed the one of larger dynamic factor, or the one that has a result.
  !> They count as one where their dynamic factors differ by no more than their errors and the tolerance.
  pure subroutine take_larger(from_above, tolerance, point)
    type(point_t), intent(in) :: from_above
    real(dp), intent(in) :: tolerance
    type(point_t), intent(inout) :: point            !< of the way up, then the larger
    type(point_t) :: from_below
    real(dp) :: estimate(2)
    logical :: known(2)

    from_below = point
    known = has_result([from_below%steady%status, from_above%steady%status])
    if (all(known)) then
      estimate = [from_below%estimate, from_above%estimate]
      if (abs(from_below%dynamic_factor - from_above%dynamic_factor) <= tolerance + &
          sum(estimate, mask=.not. ieee_is_nan(estimate))) return
    else if (.not. any(known)) then
      if (from_below%steady%status == from_above%steady%status) return
    end if
    if (known(2) .and. .not. (known(1) .and. from_below%dynamic_factor > from_above%dynamic_factor)) then
      point = from_above
      point%direction = down
      point%other_status = from_below%steady%status
      point%other_factor = from_below%dynamic_factor
    else
      point%direction = up
      point%other_status = from_above%steady%status
      point%other_factor = from_above%dynamic_factor
    end if
  end subroutine take_larger

  !> The motion that the one of the speed before leads to, else that of the speed by itself.
  subroutine continue_sweep_to(osc, rpm, options, levels, last, rpm_last, point, known)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm, rpm_last            !< 1/min
    type(sweep_options_t), intent(in) :: options
    type(levels_t), intent(inout) :: levels
    type(point_t), intent(in) :: last                !< of the speed before
    type(point_t), intent(out) :: point
    type(point_t), intent(in), optional :: known     !< by itself
    type(point_t) :: alone

    call continue_to(osc, rpm, options%accuracy, levels, last, rpm_last, point)
    if (has_result(point%steady%status) .or. .not. has_result(last%steady%status)) return
    if (point%steady%status == status_stopped .or. point%steady%status == status_unbounded) return
    if (present(known)) then
      alone = known
    else
      call solve_point(osc, mesh_period(osc%mesh%teeth(1), rpm), options%accuracy, levels, alone)
    end if
    if (.not. (has_result(alone%steady%status) .or. alone%steady%status == status_stopped)) return
    point = alone
    point%branch_lost = .true.
  end subroutine continue_sweep_to

  !> Do these motions of neighbouring speeds lie on one branch? So they do where all pairs stay in contact, and where
  !> nothing is known of one.
  pure logical function is_beside(osc, last, rpm_last, next, rpm_next)
    type(oscillator_t), intent(in) :: osc
    type(point_t), intent(in) :: last, next
    real(dp), intent(in) :: rpm_last, rpm_next
    real(dp), parameter :: beside = 0.1_dp           ! static deflections

    is_beside = .not. has_result(last%steady%status) .or. .not. (last%steady%partial .or. next%steady%partial)
    if (.not. is_beside) is_beside = distance(osc, mesh_period(osc%mesh%teeth(1), rpm_next), &
                                              next%steady%state - carried(last, rpm_last, rpm_next)) < beside
  end function is_beside
end module gearsweep_sweep_work
