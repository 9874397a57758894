!> Steady motions followed up and down over the speed, as a machine that speeds up and slows down slowly
!> meets them, and the speeds at which they change: jumps to another motion, doubled periods, the end of
!> periodic motion.
module gearsweep_branches
  use gearsweep_kinds, only: dp
  use gearsweep_accuracy, only: accuracy_t, mesh_period, point_t, solve_point, tables_t
  use gearsweep_memory, only: has_memory
  use gearsweep_motion, only: oscillator_t
  use gearsweep_status, only: has_result, status_chatter, status_unresolved
  use gearsweep_strobe, only: strobe_motion, strobe_t
  implicit none
  private
  public :: branch_t, change_t, follow_branch, go_on, carried

  !> Between two speeds, the motion before and the motion after.
  type :: change_t
    real(dp) :: rpm(2) = 0                       !< in the direction of travel
    type(point_t) :: point(2)
  end type change_t

  type :: branch_t
    type(point_t), allocatable :: point(:)       !< at each speed
    type(change_t), allocatable :: change(:)     !< in the order met
    logical :: lacks = .false.                   !< the memory does not hold it: nothing was followed
  end type branch_t

  !> A motion and where it is; `state` also where it has no answer.
  type :: stand_t
    real(dp) :: rpm = 0
    real(dp) :: state(2) = 0
    type(point_t) :: point
  end type stand_t

  !> Mesh periods for which a motion without an answer is followed at each speed.
  integer, parameter :: lingering = 300

contains

  !> Goes through the speeds `rpm` (1/min, in the direction of travel), by steps so small that the dynamic
  !> factor changes by less than `jump` or, where it does not, lies between speeds that are closer than
  !> `closeness` (relative): there the motion changes.
  pure subroutine follow_branch(osc, rpm, options, jump, closeness, branch)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm(:), jump, closeness
    type(accuracy_t), intent(in) :: options
    type(branch_t), intent(out) :: branch
    type(tables_t), allocatable :: tables
    type(stand_t) :: here
    logical :: fits
    integer :: i

    call has_memory(size(rpm)*storage_size(here%point)/8.0_dp, fits)
    branch%lacks = .not. fits
    if (branch%lacks) return
    allocate (tables, branch%point(size(rpm)), branch%change(0))
    do i = 1, size(rpm)
      if (i == 1) call step_to(osc, rpm(i), options, tables, here)
      if (i > 1) call travel(osc, rpm(i), options, jump, closeness, tables, here, branch%change)
      branch%lacks = tables%lacks
      if (branch%lacks) return
      branch%point(i) = here%point
    end do
  end subroutine follow_branch

  !> To the next speed, by half the step where the motion there is another one.
  pure subroutine travel(osc, rpm, options, jump, closeness, tables, here, changes)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm, jump, closeness
    type(accuracy_t), intent(in) :: options
    type(tables_t), intent(inout) :: tables
    type(stand_t), intent(inout) :: here
    type(change_t), allocatable, intent(inout) :: changes(:)
    type(accuracy_t) :: enough
    type(stand_t) :: there
    real(dp) :: step

    step = rpm - here%rpm
    do while (abs(rpm - here%rpm) > 0 .and. .not. tables%lacks)
      if (abs(step) > 0.7_dp*abs(rpm - here%rpm)) step = rpm - here%rpm
      ! Whether a motion is still there is clear soon.
      enough = options
      if (has_result(here%point%steady%status)) enough%steady%most_cycles = min(options%steady%most_cycles, 200)
      there = here
      call step_to(osc, merge(rpm, here%rpm + step, .not. abs(rpm - here%rpm) > abs(step)), enough, tables, there)
      if (is_alike(here%point, there%point, jump)) then
        here = there
        step = 2*step
      else if (abs(step) > closeness*rpm) then
        step = step/2
      else
        call land(osc, rpm, options, tables, here, there, jump, changes)
      end if
    end do
  end subroutine travel

  !> The motion changes between `here` and `there`, which are close to each other. Just beyond, the old one may
  !> linger for so long that no answer is found: then the one further on is taken, at most at `rpm`.
  pure subroutine land(osc, rpm, options, tables, here, there, jump, changes)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm, jump
    type(accuracy_t), intent(in) :: options
    type(tables_t), intent(inout) :: tables
    type(stand_t), intent(inout) :: here
    type(stand_t), intent(in) :: there
    type(change_t), allocatable, intent(inout) :: changes(:)
    type(accuracy_t) :: patient
    type(stand_t) :: landing
    real(dp) :: step
    logical :: last

    patient = options
    landing = there
    step = there%rpm - here%rpm
    last = .false.
    do while (.not. (last .or. has_result(landing%point%steady%status) .or. tables%lacks))
      step = 8*step
      last = abs(step) >= abs(rpm - here%rpm)
      if (last) patient%steady%most_cycles = 10*options%steady%most_cycles
      landing = here
      call step_to(osc, merge(rpm, here%rpm + step, last), patient, tables, landing)
    end do
    if (.not. is_alike(here%point, landing%point, jump)) &
      changes = [changes, change_t([here%rpm, there%rpm], [here%point, landing%point])]
    here = landing
  end subroutine land

  !> The motion at `rpm` that the one at hand leads to; the first, from rest.
  pure subroutine step_to(osc, rpm, options, tables, stand)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm
    type(accuracy_t), intent(in) :: options
    type(tables_t), intent(inout) :: tables
    type(stand_t), intent(inout) :: stand
    type(strobe_t) :: strobe
    type(point_t) :: next
    real(dp) :: duration, start(2)

    duration = mesh_period(osc%mesh%teeth(1), rpm)
    start = stand%state*[1.0_dp, stand%rpm/rpm]
    if (has_result(stand%point%steady%status) .or. .not. stand%rpm > 0) then
      call go_on(osc, rpm, options, tables, stand%point, stand%rpm, next)
    else
      call solve_point(osc, duration, options, tables, next, start)
    end if
    stand = stand_t(rpm, next%steady%state, next)
    if (has_result(next%steady%status)) return
    call strobe_motion(osc, [rpm], lingering, 1, strobe, start/[1.0_dp, duration])
    stand%state = start
    if (strobe%lacks) tables%lacks = .true.
    if (strobe%lacks) return
    if (strobe%status(1) /= status_unresolved .and. strobe%status(1) /= status_chatter) &
      stand%state = [strobe%x(1, 1), strobe%v(1, 1)*duration]
  end subroutine step_to

  !> The steady motion at `rpm` that the one at a neighbouring speed leads to; where that has no answer, as
  !> from rest. While all pairs stay in contact there is one periodic motion, and nothing to follow.
  pure subroutine go_on(osc, rpm, options, tables, neighbour, rpm_there, point)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm, rpm_there
    type(accuracy_t), intent(in) :: options
    type(tables_t), intent(inout) :: tables
    type(point_t), intent(in) :: neighbour
    type(point_t), intent(out) :: point
    real(dp) :: duration
    logical :: known

    duration = mesh_period(osc%mesh%teeth(1), rpm)
    known = has_result(neighbour%steady%status)
    if (.not. (known .and. neighbour%steady%partial)) then
      call solve_point(osc, duration, options, tables, point)
      if (.not. (known .and. point%steady%partial)) return
    end if
    call solve_point(osc, duration, options, tables, point, carried(neighbour, rpm_there, rpm))
  end subroutine go_on

  !> The same state in time: the derivative over the phase scales with the period.
  pure function carried(point, rpm_from, rpm_to) result(state)
    type(point_t), intent(in) :: point
    real(dp), intent(in) :: rpm_from, rpm_to
    real(dp) :: state(2)

    state = point%steady%state*[1.0_dp, rpm_from/rpm_to]
  end function carried

  !> Are these motions at neighbouring speeds one and the same? Those without an answer count as such.
  pure logical function is_alike(a, b, jump)
    type(point_t), intent(in) :: a, b
    real(dp), intent(in) :: jump

    is_alike = has_result(a%steady%status) .eqv. has_result(b%steady%status)
    if (is_alike .and. has_result(a%steady%status)) is_alike = a%steady%periods == b%steady%periods .and. &
      abs(a%dynamic_factor - b%dynamic_factor) < jump
  end function is_alike
end module gearsweep_branches
