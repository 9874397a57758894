!> All attracting motions of operating points: what the search finds, each solved to the tolerance, with the share of the
!> starts that lead to it. The points are shared among threads, and each is the same for any number of them.
module gearsweep_attractors
  use, intrinsic :: iso_c_binding, only: c_ptr
  use gearsweep_attractor_search, only: attractor_options_t, search_motions
  use gearsweep_coefficients, only: scheme_collocation
  use gearsweep_error_estimate, only: accuracy_t, compare, mark_inexact, point_t
  use gearsweep_kinds, only: dp
  use gearsweep_known_motion, only: known_t
  use gearsweep_memory, only: has_memory, release_claim, team
  use gearsweep_operating_point, only: solve_point
  use gearsweep_oscillator, only: mesh_period, oscillator_t
  use gearsweep_period_map, only: set_durations
  use gearsweep_periodic_orbit, only: distance, shoot, steady_t
  use gearsweep_refinement, only: first_level, last_level, levels_t, need_level, next_level, per_doubling, resolution_of
  use gearsweep_status, only: has_result, status_ok, status_stopped, status_unresolved
  use gearsweep_traps, only: leader_traps, share_traps
  implicit none
  private
  public :: attractor_t, attractors_t, find_attractors, attractors_at, largest_motion

  !> An attracting motion.
  type :: attractor_t
    type(point_t) :: point                       !< to the tolerance
    type(known_t) :: known                       !< as the search has it
    integer :: starts = 0                        !< that lead to it
  end type attractor_t

  !> Those at one speed, the one to which most starts lead first.
  type :: attractors_t
    type(attractor_t), allocatable :: motion(:)
    integer, allocatable :: to(:)                !< of each start, the motion that it leads to; 0: none; (start)
    type(point_t) :: alone                       !< the motion of a sweep that takes each speed by itself
    integer :: alone_is = 0                      !< which of the motions that is; 0: none of them
    integer :: status = status_stopped           !< ok; unresolved: too many steps; stopped
    logical :: lacks = .false.                   !< the memory does not hold it: nothing was found
  end type attractors_t

contains

  !> All motions at many speeds.
  subroutine find_attractors(osc, rpm, options, found)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm(:)               !< speeds of the pinion, 1/min
    type(attractor_options_t), intent(in) :: options
    type(attractors_t), intent(out) :: found(:)  !< (speed)
    integer :: i
    type(c_ptr) :: traps

    call release_claim()
    traps = leader_traps()
    !$omp parallel default(none) shared(osc, rpm, options, found, traps) num_threads(team(options%threads, size(rpm)))
    call share_traps(traps, 1)
    !$omp do schedule(dynamic, 1)
    do i = 1, size(rpm)
      call attractors_at(osc, mesh_period(osc%mesh%teeth(1), rpm(i)), options, found(i))
    end do
    !$omp end do
    call release_claim()
    call share_traps(traps, 0)
    !$omp end parallel
  end subroutine find_attractors

  !> All motions at one speed.
  pure subroutine attractors_at(osc, duration, options, found)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration             !< of the mesh period, s
    type(attractor_options_t), intent(in) :: options
    type(attractors_t), intent(out) :: found
    type(levels_t) :: levels

    call solve_point(osc, duration, options%accuracy, levels, found%alone)
    call search_beside(osc, duration, options, levels, found)
  end subroutine attractors_at

  !> The motion of largest dynamic factor at one speed: of those to which starts lead, and the one that is found without. Where
  !> the natural motion decays between the breaks of the stiffness there is one only; nothing is looked for there. Nor is it by a
  !> method of the literature, which does not hold every motion that the search finds.
  pure subroutine largest_motion(osc, duration, options, point, motions, lacks)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration             !< of the mesh period, s
    type(attractor_options_t), intent(in) :: options
    type(point_t), intent(out) :: point
    integer, intent(out) :: motions              !< how many there are; 0: not known, or the search takes too many steps
    logical, intent(out) :: lacks                !< the memory does not hold it
    type(levels_t) :: levels
    type(attractors_t) :: found
    logical :: fits
    integer :: i

    motions = 0
    call solve_point(osc, duration, options%accuracy, levels, point)
    call has_memory(1e4_dp + 40.0_dp*options%starts**2, fits)
    lacks = levels%lacks .or. .not. fits
    if (lacks .or. point%steady%status == status_stopped .or. options%accuracy%scheme /= scheme_collocation) return
    motions = 1
    if (point%resolution%graded_for > 0) return
    found%alone = point
    call search_beside(osc, duration, options, levels, found)
    lacks = found%lacks
    if (found%status == status_stopped) point%steady%status = status_stopped
    if (found%status /= status_ok) motions = 0
    if (lacks .or. motions == 0) return
    motions = count(found%motion%starts > 0)
    if (has_result(point%steady%status)) then
      if (found%alone_is == 0) motions = motions + 1
      if (found%alone_is > 0) motions = motions + count([found%motion(found%alone_is)%starts == 0])
    end if
    do i = 1, size(found%motion)
      if (found%motion(i)%starts > 0 .and. i /= found%alone_is .and. is_larger(found%motion(i)%point, point)) &
        point = found%motion(i)%point
    end do
  end subroutine largest_motion

  !> Is this dynamic factor clearly the larger? Of two that are alike to rounding the one that comes first is taken.
  pure logical function is_larger(point, than)
    type(point_t), intent(in) :: point, than
    real(dp), parameter :: alike = 1e-6_dp

    is_larger = has_result(point%steady%status)
    if (is_larger .and. has_result(than%steady%status)) is_larger = point%dynamic_factor > (1 + alike)*than%dynamic_factor
  end function is_larger

  !> All motions at one speed, where the one that is found without the search is known.
  pure subroutine search_beside(osc, duration, options, levels, found)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration             !< of the mesh period, s
    type(attractor_options_t), intent(in) :: options
    type(levels_t), intent(inout) :: levels
    type(attractors_t), intent(inout) :: found   !< `alone` is known
    type(known_t), allocatable :: known(:)
    integer, allocatable :: to(:), rank(:)
    integer :: i

    call search_motions(osc, duration, options, known, to, found%status)
    allocate (found%motion(count(known%attracts)), found%to(size(to)))
    found%to = 0
    if (found%status == status_stopped) return
    rank = most_first(known, [(count(to == i), i=1, size(known))])
    do i = 1, size(rank)
      where (to == rank(i)) found%to = i
      found%motion(i)%known = known(rank(i))
      found%motion(i)%starts = count(to == rank(i))
      if (is_of(osc, duration, found%alone, known(rank(i)))) then
        if (found%alone_is == 0) found%alone_is = i
        found%motion(i)%point = found%alone
      else
        call solve_known(osc, duration, options%accuracy, levels, found%motion(i))
      end if
      if (found%motion(i)%point%steady%status == status_stopped) found%status = status_stopped
    end do
    if (found%alone%steady%status == status_stopped) found%status = status_stopped
    found%lacks = levels%lacks
  end subroutine search_beside

  !> Those that attract, in the order of falling numbers of starts; equal ones as they were found.
  pure function most_first(known, starts) result(rank)
    type(known_t), intent(in) :: known(:)
    integer, intent(in) :: starts(:)             ! how many lead to each
    integer, allocatable :: rank(:)
    integer :: i, k

    allocate (rank(0))
    do i = 1, size(starts)
      if (.not. known(i)%attracts) cycle
      k = count(starts(rank) >= starts(i))
      rank = [rank(:k), i, rank(k + 1:)]
    end do
  end function most_first

  !> A motion to the tolerance: as an operating point that starts on it, and if that leads elsewhere, by Newton's method over
  !> its mesh periods.
  pure subroutine solve_known(osc, duration, options, levels, motion)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration
    type(accuracy_t), intent(in) :: options
    type(levels_t), intent(inout) :: levels
    type(attractor_t), intent(inout) :: motion

    levels%steps_per_second = 0
    if (motion%known%steady%departs) then
      call solve_point(osc, duration, options, levels, motion%point, motion%known%state(:, 1))
    else
      call solve_point(osc, duration, options, levels, motion%point)
    end if
    if (motion%point%steady%status == status_stopped .or. levels%lacks) return
    if (is_of(osc, duration, motion%point, motion%known)) return
    if (options%scheme == scheme_collocation .and. options%steps == 0) &
      call refine(osc, duration, options, levels, motion%known%steady, motion%point)
  end subroutine solve_known

  !> Is this point, solved to the tolerance, a known motion?
  pure logical function is_of(osc, duration, point, known)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration
    type(point_t), intent(in) :: point
    type(known_t), intent(in) :: known
    real(dp), parameter :: close = 0.01_dp       ! static deflections
    integer :: i

    is_of = has_result(point%steady%status) .and. point%steady%periods == size(known%state, 2)
    if (.not. is_of) return
    do i = 1, size(known%state, 2)
      is_of = distance(osc, duration, point%steady%state - known%state(:, i)) < close
      if (is_of) return
    end do
  end function is_of

  !> Newton's method from a motion that is nearly known, with some number of steps and with half of it, until the tolerance is
  !> met.
  pure subroutine refine(osc, duration, options, levels, nearly, point)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration
    type(accuracy_t), intent(in) :: options
    type(levels_t), intent(inout) :: levels
    type(steady_t), intent(in) :: nearly
    type(point_t), intent(out) :: point
    integer, parameter :: most_trials = 12
    type(steady_t) :: half
    integer :: level, trial
    logical :: done

    point%steady%status = status_unresolved
    level = min(last_level(osc, options), first_level(osc, duration, options, levels))
    do trial = 1, most_trials
      call need_level(osc, level, levels)
      if (levels%lacks) return
      associate (fine => levels%level(level)%map, coarse => levels%level(level - per_doubling)%map)
        call set_durations(fine, [duration])
        call set_durations(coarse, [duration])
        call shoot(fine, options%steady%tolerance, nearly%periods, nearly%state, point%steady)
        if (.not. has_result(point%steady%status)) return
        call shoot(coarse, options%steady%tolerance, nearly%periods, point%steady%state, half)
        point%steps = fine%steps
      end associate
      point%resolution = resolution_of(level)
      call compare(osc, duration, half, point)
      call next_level(osc, options, point%step_error, duration, levels, level, done)
      if (done) exit
    end do
    call mark_inexact(options, point)
  end subroutine refine
end module gearsweep_attractors
