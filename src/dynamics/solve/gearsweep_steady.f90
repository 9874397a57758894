!> Steady motion at one speed, or at all speeds of a batch, by Newton's method on the period map or by marching.
module gearsweep_steady
  use gearsweep_contact_set, only: period_t
  use gearsweep_full_contact, only: run_full_contact
  use gearsweep_gauss, only: batch_size
  use gearsweep_kinds, only: dp
  use gearsweep_ladder, only: try_in_turn, double
  use gearsweep_oscillator, only: oscillator_t
  use gearsweep_period, only: run_batch
  use gearsweep_period_map, only: period_map_t
  use gearsweep_periodic_orbit, only: adopt, closure_of, distance, is_closed, has_converged, judge, near, newton_step, shoot, &
                                      solve_full_contact, steady_t
  use gearsweep_status, only: has_result, status_unstable
  use gearsweep_transient, only: march, steady_options_t, by_shooting
  implicit none
  private
  public :: find_steady, find_batch, find_beside, find_converged, is_one_branch

contains

  !> The steady motion at the speed of a map: the one that `start` leads to; without `start`, the motion in full contact if
  !> there is one, else what gearsweep_ladder finds.
  pure subroutine find_steady(map, options, steady, start)
    type(period_map_t), intent(inout) :: map         !< with the duration of one speed
    type(steady_options_t), intent(in) :: options
    type(steady_t), intent(out) :: steady
    real(dp), intent(in), optional :: start(2)       !< state, m
    real(dp) :: linear(2)

    if (present(start)) then
      if (options%method == by_shooting) call find_beside(map, options, start, steady)
      if (.not. has_result(steady%status)) call march(map, options, start, steady)
    else if (options%method == by_shooting) then
      call solve_full_contact(map, linear, steady)
      if (.not. has_converged(steady)) call try_in_turn(map, options, linear, steady)
    else
      call march(map, options, [map%osc%mean_deflection, 0.0_dp], steady)
    end if
  end subroutine find_steady

  !> The motion that Newton's method finds near `start`, on the same branch: that of one mesh period or, where it repels so,
  !> of two and more.
  pure subroutine find_beside(map, options, start, steady)
    type(period_map_t), intent(inout) :: map         !< with the duration of one speed
    type(steady_options_t), intent(in) :: options
    real(dp), intent(in) :: start(2)                 !< state, m
    type(steady_t), intent(out) :: steady            !< without a result where there is none
    type(steady_t) :: doubled

    call shoot(map, options%tolerance, 1, start, steady)
    if (.not. (is_near(steady) .or. is_one_branch(map%osc, steady%partial))) then
      steady = steady_t(work=steady%work)
    else if (steady%status == status_unstable .and. .not. allocated(map%literature)) then
      call double(map, options, steady, doubled)
      if (has_result(doubled%status) .and. is_near(doubled)) then
        call adopt(doubled, steady)
      else
        steady%work = steady%work + doubled%work
      end if
    end if

  contains

    pure logical function is_near(motion)
      type(steady_t), intent(in) :: motion

      is_near = distance(map%osc, map%duration(1), motion%state - start) < near
    end function is_near
  end subroutine find_beside

  !> The steady motion that Newton's method finds from that in full contact, without marching, at one speed: that motion
  !> itself or, where steps end by the static load too, one in which pairs come and go near there.
  pure subroutine find_converged(map, tolerance, steady)
    type(period_map_t), intent(inout) :: map         !< with the duration of one speed
    real(dp), intent(in) :: tolerance                !< of the dynamic factor
    type(steady_t), intent(out) :: steady            !< without a result where there is none
    real(dp) :: state(2), work

    call solve_full_contact(map, state, steady)
    if (has_converged(steady) .or. .not. map%osc%by_load) return
    work = steady%work
    call shoot(map, tolerance, 1, state, steady)
    steady%work = steady%work + work
  end subroutine find_converged

  !> Is there one motion only, wherever it starts? So it is taken to be while all pairs between A and E stay in contact,
  !> though pairs beyond come and go.
  pure logical function is_one_branch(osc, partial)
    type(oscillator_t), intent(in) :: osc
    logical, intent(in) :: partial               !< a pair between A and E was apart for a while

    is_one_branch = osc%mesh%reaches_beyond() .and. .not. partial
  end function is_one_branch

  !> `find_steady` without marching, at all speeds of a batch. What stays unsettled is for `find_steady`.
  pure subroutine find_batch(map, tolerance, steady, guide)
    type(period_map_t), intent(inout) :: map         !< with the durations of a batch
    real(dp), intent(in) :: tolerance                !< of the dynamic factor
    type(steady_t), intent(out) :: steady(batch_size)
    !> The motions in coarser steps: where pairs separate there, the search starts from them.
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

  !> The periodic states in full contact, where no other is known.
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

  !> Newton's method as in `shoot`, for the speeds `active`, as long as it needs no halved steps: there it ends on the same
  !> motion. From a `guide` it is to stay on that motion.
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
      ! Only a run that closes the motion needs the largest loads: the first one where the motion is linear, else the next one after
      ! a small step of Newton's. Tip corners come and go in nearly every motion.
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
end module gearsweep_steady
