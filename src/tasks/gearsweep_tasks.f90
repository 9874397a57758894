!> All tasks. A new one is one line in `list_tasks`.
module gearsweep_tasks
  use gearsweep_task, only: task_length, task_slot_t, task_t
  use gearsweep_task_as_built, only: as_built_task_t
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
  implicit none
  private
  public :: list_tasks, list_task_names

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
    call add(as_built_task_t())
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
      associate (needs => room(n)%info%needs)
        room(n)%task%needs(:size(needs)) = needs
      end associate
    end subroutine add
  end subroutine list_tasks

  !> The names of all tasks.
  subroutine list_task_names(names)
    character(task_length), allocatable, intent(out) :: names(:)
    type(task_slot_t), allocatable :: slots(:)
    integer :: i

    call list_tasks(slots)
    names = [(slots(i)%info%name, i=1, size(slots))]
  end subroutine list_task_names
end module gearsweep_tasks
