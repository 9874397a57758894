!> All tasks. A new one is one line in `list_tasks`.
module gearsweep_tasks
  use gearsweep_task, only: task_info_t, task_length, task_t
  use gearsweep_task_attractors, only: attractors_task_t
  use gearsweep_task_body_modes, only: body_modes_task_t
  use gearsweep_task_branches, only: branches_task_t
  use gearsweep_task_deflection_relief, only: deflection_relief_task_t
  use gearsweep_task_flank, only: flank_task_t
  use gearsweep_task_geometry, only: geometry_task_t
  use gearsweep_task_harmonic, only: harmonic_task_t
  use gearsweep_task_hysteresis, only: hysteresis_task_t
  use gearsweep_task_life, only: life_task_t
  use gearsweep_task_load, only: load_task_t
  use gearsweep_task_mesh, only: mesh_task_t
  use gearsweep_task_modal, only: modal_task_t
  use gearsweep_task_optimum, only: optimum_task_t
  use gearsweep_task_poincare, only: poincare_task_t
  use gearsweep_task_precision, only: precision_task_t
  use gearsweep_task_rating, only: rating_task_t
  use gearsweep_task_section, only: section_task_t
  use gearsweep_task_stability, only: stability_task_t
  use gearsweep_task_static, only: static_task_t
  use gearsweep_task_sensitivity, only: sensitivity_task_t
  use gearsweep_task_sweep, only: sweep_task_t
  use gearsweep_task_torque, only: torque_task_t
  use gearsweep_task_transient, only: transient_task_t
  use gearsweep_uses, only: sentence_length
  implicit none
  private
  public :: task_slot_t, list_tasks, sentence_of, sentence_length

  type :: task_slot_t
    type(task_info_t) :: info
    class(task_t), allocatable :: task
    logical :: is_wanted = .false.               !< by the case at hand
    character(:), allocatable :: given           !< what the case says of its keys, as text
  contains
    procedure :: takes
  end type task_slot_t

contains

  !> Every task with the defaults of its keys, in the order in which they are told.
  subroutine list_tasks(slots)
    type(task_slot_t), allocatable, intent(out) :: slots(:)
    type(task_slot_t), allocatable :: room(:)
    integer, parameter :: most = 32
    integer :: n, i

    allocate (room(most))
    n = 0
    call add(geometry_task_t())
    call add(section_task_t())
    call add(mesh_task_t())
    call add(static_task_t())
    call add(modal_task_t())
    call add(load_task_t())
    call add(torque_task_t())
    call add(sweep_task_t())
    call add(optimum_task_t())
    call add(deflection_relief_task_t())
    call add(stability_task_t())
    call add(hysteresis_task_t())
    call add(poincare_task_t())
    call add(attractors_task_t())
    call add(branches_task_t())
    call add(sensitivity_task_t())
    call add(precision_task_t())
    call add(flank_task_t())
    call add(rating_task_t())
    call add(transient_task_t())
    call add(harmonic_task_t())
    call add(life_task_t())
    call add(body_modes_task_t())
    allocate (slots(n))
    do i = 1, n
      slots(i)%info = room(i)%info
      slots(i)%given = ''
      call move_alloc(room(i)%task, slots(i)%task)
    end do

  contains

    subroutine add(task)
      class(task_t), intent(in) :: task

      n = n + 1
      allocate (room(n)%task, source=task)
      call task%describe(room(n)%info)
    end subroutine add
  end subroutine list_tasks

  !> Does the case at hand name this task, and needs it this stage?
  pure logical function takes(self, stage)
    class(task_slot_t), intent(in) :: self
    character(*), intent(in) :: stage

    takes = self%is_wanted .and. self%task%uses(stage)
  end function takes

  !> The tasks that need this stage, or this other one, as in `load, sweep or optimum`.
  pure function sentence_of(slots, stage, other) result(words)
    type(task_slot_t), intent(in) :: slots(:)
    character(*), intent(in) :: stage
    character(*), intent(in), optional :: other
    character(sentence_length) :: words
    character(task_length) :: names(size(slots))
    integer :: i, n
    logical :: used

    n = 0
    do i = 1, size(slots)
      used = slots(i)%task%uses(stage)
      if (present(other)) used = used .or. slots(i)%task%uses(other)
      if (.not. used) cycle
      n = n + 1
      names(n) = slots(i)%info%name
    end do
    words = ''
    do i = 1, n
      if (i > 1) words = trim(words)//trim(merge(' or', ',  ', i == n))
      words = trim(words)//' '//names(i)
    end do
    words = adjustl(words)
  end function sentence_of
end module gearsweep_tasks
