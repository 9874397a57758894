!> List of all tasks. A new task is one line in `list_tasks`.
module gearsweep_api_tasks
  use gearsweep_study, only: deflection_relief_task_t, face_load_task_t, flank_task_t, geometry_task_t, harmonic_task_t, &
    life_task_t, load_task_t, mesh_task_t, modal_task_t, optimum_task_t, precision_task_t, rating_task_t, static_task_t, &
    sweep_task_t, task_length, task_slot_t, task_t, transient_task_t
  use gearsweep_nonlinear, only: attractors_task_t, branches_task_t, hysteresis_task_t, poincare_task_t, sensitivity_task_t, &
    stability_task_t
  use gearsweep_as_built, only: as_built_task_t
  use gearsweep_body_modes, only: body_modes_task_t
  implicit none
  private
  public :: list_tasks, list_task_names, find_former_task

contains

  !> Lists every task with the defaults of its keys, in the order of the output.
  subroutine list_tasks(slots)
    type(task_slot_t), allocatable, intent(out) :: slots(:)
    type(task_slot_t), allocatable :: room(:)
    integer, parameter :: most = 32
    integer :: n, i

    allocate (room(most))
    n = 0
    call add(geometry_task_t())
    call add(mesh_task_t())
    call add(static_task_t())
    call add(modal_task_t())
    call add(face_load_task_t())
    call add(load_task_t())
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
      slots(i)%key_text = ''
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

  !> Lists the names of all tasks.
  subroutine list_task_names(names)
    character(task_length), allocatable, intent(out) :: names(:)
    type(task_slot_t), allocatable :: slots(:)
    integer :: i

    call list_tasks(slots)
    names = [(slots(i)%info%name, i=1, size(slots))]
  end subroutine list_task_names

  !> Explains which task writes the tables of a task of earlier versions; empty for another name.
  pure subroutine find_former_task(name, now)
    character(*), intent(in) :: name             !< in lower case
    character(:), allocatable, intent(out) :: now

    select case (name)
    case ('section')
      now = 'no task; its table outline is one of the task geometry, and section, nodes and elements are tables of static and modal'
    case ('torque')
      now = 'no task; the task load writes its tables, with &sweep load_rpm and load_torque = .true.'
    case default
      now = ''
    end select
  end subroutine find_former_task
end module gearsweep_api_tasks
