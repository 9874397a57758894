!> Steady motion at one speed, or at all speeds of a batch, by Newton's method on the period map or by marching.
module gearsweep_motion_steady
  use gearsweep_base, only: dp, pi
  use gearsweep_motion_contact_set, only: period_t
  use gearsweep_motion_gauss, only: batch_size
  use gearsweep_motion_known_motions, only: add_known, known_t
  use gearsweep_motion_oscillator, only: oscillator_t
  use gearsweep_motion_period, only: run_batch, run_full_contact
  use gearsweep_motion_period_map, only: period_map_t
  use gearsweep_motion_periodic_orbit, only: closure_of, distance, has_converged, is_closed, judge, near, newton_step, shoot, &
    solve_full_contact
  use gearsweep_motion_search, only: double, find_first, find_from, search_t
  use gearsweep_motion_steady_motion, only: by_shooting, has_result, status_aperiodic, status_chaotic, status_chatter, &
    status_stopped, status_transient, status_unbounded, status_unstable, steady_options_t, steady_t
  implicit none
  private
  public :: find_steady, find_batch, find_beside, find_converged, is_one_branch

contains

  !> Finds the steady motion at the speed of a map: the one that `start` leads to; without `start`, the motion in full contact or
  !> that of Newton's method from there, else the one that rest leads to. If that does not repeat soon, other starts are tried for
  !> a few mesh periods, too few for rounding errors to grow, and then rest for as many as the options allow.
  pure subroutine find_steady(map, options, steady, start)
    type(period_map_t), intent(inout) :: map         !< map with the duration of one speed
    type(steady_options_t), intent(in) :: options
    type(steady_t), intent(out) :: steady
    real(dp), intent(in), optional :: start(2)       !< state, m
    integer, parameter :: soon = 100, few = 16       ! mesh periods
    type(search_t) :: search
    real(dp) :: first(2)
    integer :: motion

    if (present(start) .and. options%method == by_shooting) then
      call find_beside(map, options, start, steady)
      if (has_result(steady%status)) return
    end if
    call find_first(map, options, search)
    motion = 0
    first = [map%osc%mean_deflection, 0.0_dp]
    if (present(start)) then
      first = start
    else
      motion = findloc(search%known%attracts, .true., 1)
      if (size(search%known) > 0) steady = search%known(max(1, motion))%steady
      if (motion > 0) return
      ! With the methods of the literature Newton's method converges only from nearby, and marching does not use it.
      if (.not. allocated(map%literature) .and. options%method == by_shooting) then
        call find_from(map, options, soon, reshape(first, [2, 1]), search, motion)
        if (search%ends(1)%status == status_chatter) then
          ! If contact changes without end from rest, it does so from other starts too.
          steady%status = status_chatter
          return
        end if
        first = search%ends(1)%state
        if (motion == 0) call find_from(map, options, few, starts_around_rest(map), search, motion)
      end if
    end if
    if (motion == 0) call find_from(map, options, options%most_cycles, reshape(first, [2, 1]), search, motion)
    if (motion > 0) then
      steady = search%known(motion)%steady
    else
      call conclude(map%osc%damping_ratio, search, steady)
    end if
  end subroutine find_steady

  !> Starts around rest, m: on a spiral with the golden angle between them, so that they never line up; the distances repeat after
  !> eight. (2, start)
  pure function starts_around_rest(map) result(state)
    type(period_map_t), intent(in) :: map            !< map with the duration of one speed
    integer, parameter :: starts = 24
    real(dp), parameter :: widest = 6, golden = pi*(3 - sqrt(5.0_dp))      ! static deflections, rad
    real(dp) :: state(2, starts), radius
    integer :: i

    associate (osc => map%osc)
      do i = 1, starts
        radius = widest*(modulo(i - 1, batch_size) + 0.5_dp)/batch_size*osc%static_deflection
        state(:, i) = [osc%mean_deflection, 0.0_dp] &
                      + radius*[cos(golden*i), osc%natural_frequency*map%duration(1)*sin(golden*i)]
      end do
    end associate
  end function starts_around_rest

  !> Finds why the first start leads to no steady motion.
  pure subroutine conclude(damping_ratio, search, steady)
    real(dp), intent(in) :: damping_ratio
    type(search_t), intent(in) :: search
    type(steady_t), intent(inout) :: steady          !< in: a motion that repels, if one is known

    associate (end => search%ends(1))
      if (search%stopped) then
        steady%status = status_stopped
      else if (any(end%status == [status_chatter, status_unbounded])) then
        steady%status = end%status
      else if (end%status == status_chaotic) then
        steady = search%watched
        steady%status = status_chaotic
        steady%multiplier = exp(end%growth)
      else if (steady%status /= status_unstable) then
        steady%status = merge(status_transient, status_aperiodic, damping_ratio > 0)
      end if
      if (any(end%status == [status_chaotic, status_transient])) steady%seen = search%watched%seen
    end associate
  end subroutine conclude

  !> Finds the motion near `start` by Newton's method, on the same branch: that of one mesh period or, where it repels by period
  !> doubling, of two and more.
  pure subroutine find_beside(map, options, start, steady)
    type(period_map_t), intent(inout) :: map         !< map with the duration of one speed
    type(steady_options_t), intent(in) :: options
    real(dp), intent(in) :: start(2)                 !< state, m
    type(steady_t), intent(out) :: steady            !< motion; without a result if there is none
    type(known_t), allocatable :: known(:)
    type(steady_t) :: doubled
    integer :: which

    call shoot(map, options%tolerance, 1, start, steady)
    if (.not. (is_near(steady) .or. is_one_branch(map%osc, steady%partial))) then
      steady = steady_t()
    else if (steady%status == status_unstable .and. .not. allocated(map%literature)) then
      call double(map, options, steady, doubled)
      allocate (known(0))
      call add_known(map, doubled, known, which)
      if (which == 0) return
      if (known(1)%attracts .and. is_near(known(1)%steady)) steady = known(1)%steady
    end if

  contains

    pure logical function is_near(motion)
      type(steady_t), intent(in) :: motion

      is_near = distance(map%osc, map%duration(1), motion%state - start) < near
    end function is_near
  end subroutine find_beside

  !> Finds the steady motion by Newton's method from full contact, without marching, at one speed: that motion itself or, where
  !> steps also end by the static load, one in which pairs close and open near there.
  pure subroutine find_converged(map, tolerance, steady)
    type(period_map_t), intent(inout) :: map         !< map with the duration of one speed
    real(dp), intent(in) :: tolerance                !< tolerance of the dynamic factor
    type(steady_t), intent(out) :: steady            !< motion; without a result if there is none
    real(dp) :: state(2)

    call solve_full_contact(map, state, steady)
    if (has_converged(steady) .or. .not. map%osc%by_load) return
    call shoot(map, tolerance, 1, state, steady)
  end subroutine find_converged

  !> True if there is only one motion, from any start. This is assumed while all pairs between A and E stay in contact, even if
  !> pairs beyond close and open.
  pure logical function is_one_branch(osc, partial)
    type(oscillator_t), intent(in) :: osc
    logical, intent(in) :: partial               !< a pair between A and E was apart for a while

    is_one_branch = osc%mesh%reaches_beyond() .and. .not. partial
  end function is_one_branch

  !> Applies `find_steady` without marching, at all speeds of a batch. Motions it does not decide need `find_steady`.
  pure subroutine find_batch(map, tolerance, steady, guide)
    type(period_map_t), intent(inout) :: map         !< map with the durations of a batch
    real(dp), intent(in) :: tolerance                !< tolerance of the dynamic factor
    type(steady_t), intent(out) :: steady(batch_size)
    !> Motions in coarser steps: where pairs separate there, the search starts from them.
    type(steady_t), intent(in), optional :: guide(batch_size)
    real(dp) :: start(2, batch_size)
    logical :: guided(batch_size), active(batch_size)
    integer :: l

    guided = .false.
    active = .true.
    if (present(guide)) then
      guided = guide%departs .or. .not. has_converged(guide)
      active = has_converged(guide)
      do l = 1, batch_size
        start(:, l) = guide(l)%state
      end do
    end if
    if (.not. all(guided)) call start_in_full_contact(map, guided, start)
    if (any(active)) call shoot_batch(map, tolerance, start, guided, active, steady)
  end subroutine find_batch

  !> Computes the periodic states in full contact, where no other is known.
  pure subroutine start_in_full_contact(map, known, start)
    type(period_map_t), intent(inout) :: map
    logical, intent(in) :: known(batch_size)
    real(dp), intent(inout) :: start(2, batch_size)
    real(dp), parameter :: zero(2, batch_size) = 0
    type(period_t) :: run(batch_size)
    real(dp) :: step(2)
    logical :: solved
    integer :: l

    call run_full_contact(map, zero, run)
    do l = 1, batch_size
      if (known(l)) cycle
      call newton_step(run(l)%monodromy, run(l)%state, step, solved)
      start(:, l) = merge(step, [map%osc%mean_deflection, 0.0_dp], solved)
    end do
  end subroutine start_in_full_contact

  !> Applies Newton's method as in `shoot`, at the speeds `active`, as long as it needs no halved steps: then it ends on the same
  !> motion. From a `guide` it must stay on that motion.
  pure subroutine shoot_batch(map, tolerance, start, guided, active, steady)
    type(period_map_t), intent(inout) :: map
    real(dp), intent(in) :: tolerance, start(2, batch_size)
    logical, intent(in) :: guided(batch_size)
    logical, intent(inout) :: active(batch_size)
    type(steady_t), intent(inout) :: steady(batch_size)
    integer, parameter :: most_iterations = 12
    type(period_t) :: run(batch_size)
    real(dp) :: state(2, batch_size), step(2), closure, residual(batch_size), last_residual
    logical :: peaks, ends
    integer :: iteration, l

    associate (osc => map%osc, duration => map%duration)
      state = start
      residual = huge(residual)
      ! The largest loads are needed only in the run that confirms the motion. A linear motion is confirmed by its first run, others
      ! by the run after a small Newton step. With tip corners, contact begins and ends in nearly every motion.
      peaks = .not. (all(guided) .or. osc%mesh%reaches_beyond())
      do iteration = 1, most_iterations
        call run_batch(map, state, active, peaks, run)
        ends = .false.
        do l = 1, batch_size
          if (.not. active(l)) cycle
          closure = closure_of(osc, duration(l), state(:, l), run(l))
          last_residual = residual(l)
          residual(l) = distance(osc, duration(l), run(l)%state - state(:, l))
          if (is_closed(closure, tolerance)) then
            ends = .true.
            active(l) = .not. peaks
            if (peaks) call judge(osc, duration(l), state(:, l), run(l), closure, 1, steady(l))
          else
            call newton_step(run(l)%monodromy, run(l)%state - state(:, l), step, active(l))
            state(:, l) = state(:, l) + step
            active(l) = active(l) .and. .not. run(l)%failed .and. residual(l) < last_residual
            ends = ends .or. distance(osc, duration(l), step)**2 < tolerance
          end if
          if (guided(l) .and. .not. is_one_branch(osc, run(l)%partial) .and. &
              .not. distance(osc, duration(l), state(:, l) - start(:, l)) < near) then
            active(l) = .false.
            steady(l) = steady_t()
          end if
        end do
        peaks = ends
        if (.not. any(active)) exit
      end do
    end associate
  end subroutine shoot_batch
end module gearsweep_motion_steady
