!> Steady motion at one speed, or at all speeds of a batch, by Newton's method on the period map or by marching.
module gearsweep_steady
  use gearsweep_contact_set, only: period_t
  use gearsweep_gauss, only: batch_size
  use gearsweep_kinds, only: dp
  use gearsweep_period, only: run_batch, run_period
  use gearsweep_oscillator, only: oscillator_t
  use gearsweep_period_map, only: period_map_t, run_full_contact
  use gearsweep_periodic_orbit, only: steady_t, near, settled, shoot, is_closed, closure_of, newton_step, judge, distance
  use gearsweep_transient, only: march, steady_options_t, by_shooting
  implicit none
  private
  public :: find_steady, find_batch, find_settled, solve_full_contact, is_one_branch

contains

  !> The steady motion at the speed of a map, on the branch that `start` leads to; without `start`, the motion in full
  !> contact if there is one, else what a start at rest at the mean deflection leads to.
  pure subroutine find_steady(map, options, steady, start)
    type(period_map_t), intent(inout) :: map         !< with the duration of one speed
    type(steady_options_t), intent(in) :: options
    type(steady_t), intent(out) :: steady
    real(dp), intent(in), optional :: start(2)       !< state, m
    real(dp) :: rest(2), from(2), work

    associate (osc => map%osc, duration => map%duration(1))
      rest = [osc%mean_deflection, 0.0_dp]
      from = rest
      work = 0
      if (options%method == by_shooting .and. .not. present(start)) then
        call solve_full_contact(map, from, steady)
        if (settled(steady)) return
        work = steady%work
        ! Far from rest Newton's method may find a motion that no start leads to.
        if (distance(osc, duration, from - rest) > near .and. .not. is_one_branch(osc, steady%partial)) from = rest
      end if
      if (present(start)) from = start
      if (options%method == by_shooting) then
        call shoot(map, options%tolerance, 1, from, steady)
        steady%work = steady%work + work
        if (settled(steady) .and. (distance(osc, duration, steady%state - from) < near .or. &
                                   is_one_branch(osc, steady%partial))) return
      end if
      if (.not. present(start)) from = rest
      call march(map, options, from, steady)
    end associate
  end subroutine find_steady

  !> The steady motion that Newton's method finds from that in full contact, without marching, at one speed: that motion
  !> itself or, where contact reaches beyond A and E, one in which only pairs beyond them come and go.
  pure subroutine find_settled(map, tolerance, steady)
    type(period_map_t), intent(inout) :: map         !< with the duration of one speed
    real(dp), intent(in) :: tolerance                !< of the dynamic factor
    type(steady_t), intent(out) :: steady            !< without a result where there is none
    real(dp) :: state(2), work

    call solve_full_contact(map, state, steady)
    if (settled(steady) .or. .not. map%osc%mesh%reaches_beyond()) return
    work = steady%work
    call shoot(map, tolerance, 1, state, steady)
    steady%work = steady%work + work
  end subroutine find_settled

  !> Is there one motion only, wherever it starts? So it is taken to be while all pairs between A and E stay in contact,
  !> though pairs beyond come and go.
  pure logical function is_one_branch(osc, partial)
    type(oscillator_t), intent(in) :: osc
    logical, intent(in) :: partial               !< a pair between A and E was apart for a while

    is_one_branch = osc%mesh%reaches_beyond() .and. .not. partial
  end function is_one_branch

  !> The motion in full contact. Its period map is affine: one period gives the periodic state, a second one checks that
  !> no pair separates, and finds the largest load.
  pure subroutine solve_full_contact(map, state, steady)
    type(period_map_t), intent(inout) :: map         !< with the duration of one speed
    real(dp), intent(out) :: state(2)                !< periodic if no pair separates, m
    type(steady_t), intent(out) :: steady            !< without a result where a pair separates
    type(period_t) :: run(1)
    real(dp) :: step(2)
    logical :: solved

    call run_full_contact(map, reshape([0.0_dp, 0.0_dp], [2, 1]), run)
    call newton_step(run(1)%monodromy, run(1)%state, step, solved)
    state = merge(step, [map%osc%mean_deflection, 0.0_dp], solved)
    steady%work = map%steps
    if (.not. solved) return
    call run_period(map, state, run(1))
    associate (osc => map%osc, duration => map%duration(1))
      if (.not. (run(1)%departs .or. run(1)%failed)) &
        call judge(osc, duration, state, run(1), closure_of(osc, duration, state, run(1)), 1, steady)
    end associate
    steady%work = 2*map%steps
  end subroutine solve_full_contact

  !> `find_steady` without marching, at all speeds of a batch. What stays unsettled is for `find_steady`.
  pure subroutine find_batch(map, tolerance, steady, guide)
    type(period_map_t), intent(inout) :: map         !< with the durations of a batch
    real(dp), intent(in) :: tolerance                !< of the dynamic factor
    type(steady_t), intent(out) :: steady(batch_size)
    !> The motions in coarser steps: where pairs separate there, the search starts from them.
    type(steady_t), intent(in), optional :: guide(batch_size)
    real(dp) :: start(2, batch_size)
    logical :: parts(batch_size), active(batch_size)
    integer :: l

    parts = .false.
    active = .true.
    if (present(guide)) then
      parts = guide%departs .or. .not. settled(guide)
      active = settled(guide)
      do l = 1, batch_size
        start(:, l) = guide(l)%state
      end do
    end if
    if (.not. all(parts)) call start_in_full_contact(map, parts, start)
    if (any(active)) call shoot_batch(map, tolerance, start, parts, active, steady)
  end subroutine find_batch

  !> The periodic states in full contact, where no pair separates.
  pure subroutine start_in_full_contact(map, parts, start)
    type(period_map_t), intent(inout) :: map
    logical, intent(in) :: parts(batch_size)
    real(dp), intent(inout) :: start(2, batch_size)
    real(dp), parameter :: zero(2, batch_size) = 0
    type(period_t) :: run(batch_size)
    real(dp) :: step(2)
    logical :: solved
    integer :: l

    call run_full_contact(map, zero, run)
    do l = 1, batch_size
      if (parts(l)) cycle
      call newton_step(run(l)%monodromy, run(l)%state, step, solved)
      start(:, l) = merge(step, [map%osc%mean_deflection, 0.0_dp], solved)
    end do
  end subroutine start_in_full_contact

  !> Newton's method as in `shoot`, but without halving its steps, for the speeds `active`. A start in full contact of
  !> which pairs do separate may be far from rest: then rest is the start.
  pure subroutine shoot_batch(map, tolerance, start, parts, active, steady)
    type(period_map_t), intent(inout) :: map
    real(dp), intent(in) :: tolerance, start(2, batch_size)
    logical, intent(in) :: parts(batch_size)
    logical, intent(inout) :: active(batch_size)
    type(steady_t), intent(inout) :: steady(batch_size)
    integer, parameter :: most_iterations = 8
    type(period_t) :: run(batch_size)
    real(dp) :: state(2, batch_size), from(2, batch_size), step(2), rest(2), closure
    logical :: peaks, last
    integer :: iteration, l

    associate (osc => map%osc, duration => map%duration)
      rest = [osc%mean_deflection, 0.0_dp]
      from = start
      state = start
      ! Only a run that closes the motion needs the largest loads; the next one may be it where Newton's step was small.
      peaks = .not. all(parts)
      do iteration = 1, most_iterations
        call run_batch(map, state, active, peaks, run)
        last = .false.
        do l = 1, batch_size
          if (.not. active(l)) cycle
          closure = closure_of(osc, duration(l), state(:, l), run(l))
          if (is_closed(closure, tolerance)) then
            last = .true.
            active(l) = .not. peaks
            if (peaks .and. (distance(osc, duration(l), state(:, l) - from(:, l)) < near .or. &
                             is_one_branch(osc, run(l)%partial))) &
              call judge(osc, duration(l), state(:, l), run(l), closure, 1, steady(l))
          else if (iteration == 1 .and. .not. parts(l) .and. distance(osc, duration(l), state(:, l) - rest) > near .and. &
                   .not. is_one_branch(osc, run(l)%partial)) then
            from(:, l) = rest
            state(:, l) = rest
          else
            call newton_step(run(l)%monodromy, run(l)%state - state(:, l), step, active(l))
            state(:, l) = state(:, l) + step
            active(l) = active(l) .and. .not. run(l)%failed .and. (is_one_branch(osc, run(l)%partial) .or. &
                        distance(osc, duration(l), state(:, l) - from(:, l)) < 2*near)
            last = last .or. distance(osc, duration(l), step)**2 < tolerance
          end if
        end do
        peaks = last
        if (.not. any(active)) exit
      end do
    end associate
  end subroutine shoot_batch
end module gearsweep_steady
