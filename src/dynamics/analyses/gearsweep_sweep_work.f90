!> The work of a sweep: blocks of speeds side by side, then the branch through all speeds of a relief. Each stops
!> where the caller wants it, and goes on from there.
module gearsweep_sweep_work
  use gearsweep_accuracy, only: mesh_period, point_t, solve_lanes, solve_point, tables_t
  use gearsweep_branches, only: carried, go_on
  use gearsweep_gauss, only: lanes
  use gearsweep_kinds, only: dp
  use gearsweep_motion, only: oscillator_t
  use gearsweep_steady, only: by_shooting, distance
  use gearsweep_status, only: has_result, status_stopped
  use gearsweep_sweep_state, only: block_t, counter_t, down, each, is_stopped, sweep_options_t, up
  implicit none
  private
  public :: solve_block, follow_branch, keep_points

contains

  !> Each speed of a block by itself; where a branch is to be followed, only what all pairs in contact
  !> decide.
  subroutine solve_block(osc, rpm, options, block, counter, tables, points, solved)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm(:)
    type(sweep_options_t), intent(in) :: options
    type(block_t), intent(inout) :: block
    type(counter_t), intent(inout) :: counter
    type(tables_t), intent(inout) :: tables
    type(point_t), intent(inout) :: points(:)
    logical, intent(inout) :: solved(:)
    integer :: k, last

    ! The answer shall not depend on what the tables were used for before.
    tables%steps_per_second = block%pace
    do while (block%grouped < block%last)
      if (is_stopped(options)) return
      k = block%grouped + 1
      last = block%last
      ! One speed by itself is faster without lanes.
      if (size(rpm) > 1 .and. options%accuracy%steps == 0 .and. options%accuracy%steady%method == by_shooting) then
        last = min(k + lanes - 1, last)
        call solve_group(osc, rpm, k, last, options, tables, points, solved)
      end if
      block%grouped = last
      block%pace = tables%steps_per_second
      call counter%tick(merge(2*count(solved(k:last)), last - k + 1, options%direction == each))
    end do
    if (options%direction /= each) return
    do while (block%single < block%last)
      k = block%single + 1
      if (.not. solved(k)) then
        if (is_stopped(options)) return
        call solve_point(osc, mesh_period(osc%mesh%teeth(1), rpm(k)), options%accuracy, tables, points(k))
        if (points(k)%steady%status == status_stopped) return
        solved(k) = .true.
        call counter%tick(2)
      end if
      block%single = k
      block%pace = tables%steps_per_second
    end do
  end subroutine solve_block

  !> Speeds first to last in lanes; the last one fills what is left.
  subroutine solve_group(osc, rpm, first, last, options, tables, points, solved)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm(:)
    integer, intent(in) :: first, last
    type(sweep_options_t), intent(in) :: options
    type(tables_t), intent(inout) :: tables
    type(point_t), intent(inout) :: points(:)
    logical, intent(inout) :: solved(:)
    type(point_t) :: found(lanes)
    logical :: ok(lanes)
    integer :: k

    call solve_lanes(osc, mesh_period(osc%mesh%teeth(1), [(rpm(min(k, last)), k=first, first + lanes - 1)]), &
                     options%accuracy, tables, found, ok)
    points(first:last) = found(:last - first + 1)
    solved(first:last) = ok(:last - first + 1)
  end subroutine solve_group

  !> Goes through the speeds, up or down, and solves what is left, or lies on another branch than the
  !> speed before. `followed` speeds are done; there `pace` steps a second were wanted.
  subroutine follow_branch(osc, rpm, options, counter, tables, points, solved, followed, pace)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm(:)
    type(sweep_options_t), intent(in) :: options
    type(counter_t), intent(inout) :: counter
    type(tables_t), intent(inout) :: tables
    type(point_t), intent(inout) :: points(:)
    logical, intent(inout) :: solved(:)
    integer, intent(inout) :: followed
    real(dp), intent(inout) :: pace
    integer :: k, last

    tables%steps_per_second = pace
    do while (followed < size(rpm))
      if (is_stopped(options)) return
      k = merge(followed + 1, size(rpm) - followed, options%direction == up)
      last = merge(k - 1, k + 1, options%direction == up)
      if (followed == 0) then
        if (.not. solved(k)) call solve_point(osc, mesh_period(osc%mesh%teeth(1), rpm(k)), options%accuracy, tables, points(k))
      else
        if (solved(k)) solved(k) = is_beside(osc, points(last), rpm(last), points(k), rpm(k))
        if (.not. solved(k)) call go_on(osc, rpm(k), options%accuracy, tables, points(last), rpm(last), points(k))
      end if
      if (points(k)%steady%status == status_stopped) return
      solved(k) = .true.
      followed = followed + 1
      pace = tables%steps_per_second
      call counter%tick(1)
    end do
  end subroutine follow_branch

  !> Do these motions of neighbouring speeds lie on one branch? So they do where all pairs stay in contact,
  !> and where nothing is known of one.
  pure logical function is_beside(osc, last, rpm_last, next, rpm_next)
    type(oscillator_t), intent(in) :: osc
    type(point_t), intent(in) :: last, next
    real(dp), intent(in) :: rpm_last, rpm_next
    real(dp), parameter :: beside = 0.1_dp       ! static deflections

    is_beside = .not. has_result(last%steady%status) .or. .not. (last%steady%partial .or. next%steady%partial)
    if (.not. is_beside) is_beside = distance(osc, mesh_period(osc%mesh%teeth(1), rpm_next), &
                                              next%steady%state - carried(last, rpm_last, rpm_next)) < beside
  end function is_beside

  !> The points at the speeds to keep. One that is no speed of the sweep is solved from the speed before, as if it
  !> were, or by itself where the sweep follows no branch.
  subroutine keep_points(osc, rpm, options, tables, points, final, kept)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm(:)
    type(sweep_options_t), intent(in) :: options
    type(tables_t), intent(inout) :: tables
    type(point_t), intent(in) :: points(:)
    logical, intent(in) :: final(:)
    type(point_t), intent(out) :: kept(:)
    real(dp), parameter :: same = 1e-12_dp
    integer :: i, k, before

    do i = 1, size(kept)
      k = minloc(abs(rpm - options%keep(i)), 1)
      if (abs(rpm(k) - options%keep(i)) <= same*rpm(k)) then
        if (final(k)) kept(i) = points(k)
        if (.not. final(k)) kept(i)%steady%status = status_stopped
        cycle
      end if
      kept(i)%steady%status = status_stopped
      if (is_stopped(options)) cycle
      before = 0
      if (options%direction == up) before = count(rpm < options%keep(i))
      if (options%direction == down) before = modulo(count(rpm < options%keep(i)) + 1, size(rpm) + 1)
      tables%steps_per_second = 0
      if (before == 0) then
        call solve_point(osc, mesh_period(osc%mesh%teeth(1), options%keep(i)), options%accuracy, tables, kept(i))
      else if (final(before)) then
        call go_on(osc, options%keep(i), options%accuracy, tables, points(before), rpm(before), kept(i))
      end if
    end do
  end subroutine keep_points
end module gearsweep_sweep_work
