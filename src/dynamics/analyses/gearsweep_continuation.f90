!> Steady motions followed up and down over the speed, as a machine that speeds up and slows down slowly meets them, and
!> the speeds at which they change: jumps to another motion, doubled periods, the end of periodic motion.
module gearsweep_continuation
  use gearsweep_error_estimate, only: accuracy_t, point_t
  use gearsweep_kinds, only: dp
  use gearsweep_memory, only: has_memory
  use gearsweep_operating_point, only: solve_point
  use gearsweep_oscillator, only: mesh_period, oscillator_t
  use gearsweep_poincare, only: sample_section, section_points_t
  use gearsweep_refinement, only: levels_t
  use gearsweep_status, only: has_result, status_chatter, status_stopped, status_unbounded, status_unresolved
  use gearsweep_stop, only: wants_stop
  implicit none
  private
  public :: branch_t, change_t, branch_options_t, follow_branch, continue_to, carried

  !> Between two speeds, the motion before and the motion after.
  type :: change_t
    real(dp) :: rpm(2) = 0                       !< in the direction of travel, 1/min
    type(point_t) :: point(2)
  end type change_t

  type :: branch_t
    type(point_t), allocatable :: point(:)       !< at each speed; (speed)
    type(change_t), allocatable :: change(:)     !< in the order met
    logical :: lacks = .false.                   !< the memory does not hold it: nothing was followed
  end type branch_t

  !> What counts as a change of the motion.
  type :: branch_options_t
    type(accuracy_t) :: accuracy
    real(dp) :: jump = 0.01_dp                   !< of the dynamic factor between two speeds
    real(dp) :: closeness = 1e-4_dp              !< distance of the speeds between which a change is located, relative
  end type branch_options_t

  !> A point of the continuation: a motion and its speed; `state` also where it has no result.
  type :: continuation_point_t
    real(dp) :: rpm = 0
    real(dp) :: state(2) = 0
    type(point_t) :: point
  end type continuation_point_t

  !> Mesh periods for which a motion without a result is followed at each speed.
  integer, parameter :: lingering = 300

contains

  !> Follows the motion over the speeds, in steps so small that the dynamic factor changes by less than a jump or, where
  !> it does not, lies between speeds that are close: there the motion changes. Where the caller ends it, the rest has
  !> the status `stopped`.
  pure subroutine follow_branch(osc, rpm, options, branch)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm(:)               !< speeds of the pinion in the direction of travel, 1/min
    type(branch_options_t), intent(in) :: options
    type(branch_t), intent(out) :: branch
    type(levels_t), allocatable :: levels
    type(continuation_point_t) :: here
    logical :: fits
    integer :: i

    call has_memory(size(rpm)*storage_size(here%point)/8.0_dp, fits)
    branch%lacks = .not. fits
    if (branch%lacks) return
    allocate (levels, branch%point(size(rpm)), branch%change(0))
    do i = 1, size(rpm)
      if (i == 1) call move_to(osc, rpm(i), options%accuracy, levels, here)
      if (i > 1) call step_to(osc, rpm(i), options, levels, here, branch%change)
      branch%lacks = levels%lacks
      if (branch%lacks) return
      if (wants_stop(options%accuracy%steady%stop)) branch%point(i:)%steady%status = status_stopped
      if (branch%point(i)%steady%status == status_stopped) return
      branch%point(i) = here%point
    end do
  end subroutine follow_branch

  !> To the next speed, with the step halved while the motion there is another one.
  pure subroutine step_to(osc, rpm, options, levels, here, changes)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm
    type(branch_options_t), intent(in) :: options
    type(levels_t), intent(inout) :: levels
    type(continuation_point_t), intent(inout) :: here
    type(change_t), allocatable, intent(inout) :: changes(:)
    type(accuracy_t) :: enough
    type(continuation_point_t) :: there
    real(dp) :: step

    step = rpm - here%rpm
    do while (abs(rpm - here%rpm) > 0 .and. .not. (levels%lacks .or. wants_stop(options%accuracy%steady%stop)))
      if (abs(step) > 0.7_dp*abs(rpm - here%rpm)) step = rpm - here%rpm
      ! A few periods show whether the motion still exists.
      enough = options%accuracy
      if (has_result(here%point%steady%status)) enough%steady%most_cycles = min(options%accuracy%steady%most_cycles, 200)
      there = here
      call move_to(osc, merge(rpm, here%rpm + step, .not. abs(rpm - here%rpm) > abs(step)), enough, levels, there)
      if (is_alike(here%point, there%point, options%jump)) then
        here = there
        step = 2*step
      else if (abs(step) > options%closeness*rpm) then
        step = step/2
      else
        call accept_change(osc, rpm, options, levels, here, there, changes)
      end if
    end do
  end subroutine step_to

  !> The motion changes between `here` and `there`, which are close to each other. Just beyond, the old one may linger
  !> for so long that no result is found: then the one further on is taken, at most at `rpm`.
  pure subroutine accept_change(osc, rpm, options, levels, here, there, changes)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm
    type(branch_options_t), intent(in) :: options
    type(levels_t), intent(inout) :: levels
    type(continuation_point_t), intent(inout) :: here
    type(continuation_point_t), intent(in) :: there
    type(change_t), allocatable, intent(inout) :: changes(:)
    type(accuracy_t) :: patient
    type(continuation_point_t) :: beyond
    real(dp) :: step
    logical :: last

    patient = options%accuracy
    beyond = there
    step = there%rpm - here%rpm
    last = .false.
    do while (.not. (last .or. has_result(beyond%point%steady%status) .or. levels%lacks))
      step = 8*step
      last = abs(step) >= abs(rpm - here%rpm)
      if (last) patient%steady%most_cycles = 10*options%accuracy%steady%most_cycles
      beyond = here
      call move_to(osc, merge(rpm, here%rpm + step, last), patient, levels, beyond)
    end do
    if (.not. is_alike(here%point, beyond%point, options%jump)) &
      changes = [changes, change_t([here%rpm, there%rpm], [here%point, beyond%point])]
    here = beyond
  end subroutine accept_change

  !> The motion at `rpm` that the one at hand leads to; the first, by itself.
  pure subroutine move_to(osc, rpm, options, levels, here)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm
    type(accuracy_t), intent(in) :: options
    type(levels_t), intent(inout) :: levels
    type(continuation_point_t), intent(inout) :: here
    type(section_points_t) :: section
    type(point_t) :: next
    real(dp) :: duration, start(2)

    duration = mesh_period(osc%mesh%teeth(1), rpm)
    start = here%state*[1.0_dp, here%rpm/rpm]
    if (has_result(here%point%steady%status) .or. .not. here%rpm > 0) then
      call continue_to(osc, rpm, options, levels, here%point, here%rpm, next)
    else
      call solve_point(osc, duration, options, levels, next, start)
    end if
    here = continuation_point_t(rpm, next%steady%state, next)
    if (has_result(next%steady%status)) return
    call sample_section(osc, [rpm], lingering, 1, section, start/[1.0_dp, duration])
    here%state = start
    if (section%lacks) levels%lacks = .true.
    if (section%lacks) return
    if (all(section%status(1) /= [status_unresolved, status_chatter, status_unbounded])) &
      here%state = [section%x(1, 1), section%v(1, 1)*duration]
  end subroutine move_to

  !> The steady motion that the one at a neighbouring speed leads to; where that has no result, that of the speed by itself. While
  !> all
  !> pairs stay in contact there is one periodic motion, and nothing to follow.
  pure subroutine continue_to(osc, rpm, options, levels, neighbour, rpm_there, point)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm                  !< speed of the pinion, 1/min
    type(accuracy_t), intent(in) :: options
    type(levels_t), intent(inout) :: levels      !< of this oscillator
    type(point_t), intent(in) :: neighbour
    real(dp), intent(in) :: rpm_there            !< speed of the neighbour, 1/min
    type(point_t), intent(out) :: point
    real(dp) :: duration
    logical :: known

    duration = mesh_period(osc%mesh%teeth(1), rpm)
    known = has_result(neighbour%steady%status)
    if (.not. (known .and. neighbour%steady%partial)) then
      call solve_point(osc, duration, options, levels, point)
      if (.not. (known .and. point%steady%partial)) return
    end if
    call solve_point(osc, duration, options, levels, point, carried(neighbour, rpm_there, rpm))
  end subroutine continue_to

  !> The same position and velocity at another speed, as a state (m): the derivative over the phase scales with the
  !> period.
  pure function carried(point, rpm_from, rpm_to) result(state)
    type(point_t), intent(in) :: point
    real(dp), intent(in) :: rpm_from, rpm_to     !< 1/min
    real(dp) :: state(2)

    state = point%steady%state*[1.0_dp, rpm_from/rpm_to]
  end function carried

  !> Are these motions at neighbouring speeds one and the same? Those without a result count as such.
  pure logical function is_alike(a, b, jump)
    type(point_t), intent(in) :: a, b
    real(dp), intent(in) :: jump

    is_alike = has_result(a%steady%status) .eqv. has_result(b%steady%status)
    if (is_alike .and. has_result(a%steady%status)) is_alike = a%steady%periods == b%steady%periods .and. &
      abs(a%dynamic_factor - b%dynamic_factor) < jump
  end function is_alike
end module gearsweep_continuation
