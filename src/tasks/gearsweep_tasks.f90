!> All tasks. A new one is one line in `list_tasks`.
module gearsweep_tasks
  use gearsweep_task, only: includes, task_info_t, task_length, task_t
  use gearsweep_task_hysteresis, only: hysteresis_task_t
  use gearsweep_task_poincare, only: poincare_task_t
  use gearsweep_task_stability, only: stability_task_t
  implicit none
  private
  public :: task_slot_t, list_tasks, sentence_of

  !> Of a list of tasks as in a sentence.
  integer, parameter, public :: sentence_length = 160

  type :: task_slot_t
    type(task_info_t) :: info
    !> Not allocated for tasks whose keys, run and tables still stand in rooms of their own.
    class(task_t), allocatable :: task
    logical :: is_wanted = .false.               !< by the case at hand
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
    call older('geometry', 'geometry', '', 'diameters, centre distance, working pressure angle, path of contact')
    call older('section', 'geometry body', 'outline', 'the grid of a section of one gear')
    call older('mesh', 'mesh reliefs', 'mesh harmonics', &
               'pair and mesh stiffness, load sharing, static transmission error and its harmonics')
    call older('static', 'geometry body mesh reliefs', 'root', &
               'root stress of one gear under the moving load, beside the values by ISO 6336-3 and Lewis')
    call older('modal', 'geometry body', 'modes', 'natural frequencies and mode shapes of the section')
    call older('load', 'mesh reliefs motion losses accuracy', 'load', 'load of one pair along its path at chosen speeds')
    call older('sweep', 'mesh reliefs motion losses accuracy speeds', 'sweep', &
               'dynamic factor over speed and relief, resonances, best of the listed reliefs')
    call older('optimum', 'mesh reliefs motion losses accuracy speeds', 'vcurve', &
               'the relief whose largest dynamic factor over all speeds is least')
    call add(stability_task_t())
    call add(hysteresis_task_t())
    call add(poincare_task_t())
    allocate (slots(n))
    do i = 1, n
      slots(i)%info = room(i)%info
      call move_alloc(room(i)%task, slots(i)%task)
    end do

  contains

    subroutine add(task)
      class(task_t), intent(in) :: task

      n = n + 1
      allocate (room(n)%task, source=task)
      call task%describe(room(n)%info)
    end subroutine add

    subroutine older(name, needs, tables, gives)
      character(*), intent(in) :: name, needs, tables, gives

      n = n + 1
      room(n)%info = task_info_t(name, needs, gives, tables)
    end subroutine older
  end subroutine list_tasks

  !> Does the case at hand name this task, and needs it this stage? Speeds of its own make those of &sweep idle.
  pure logical function takes(self, stage)
    class(task_slot_t), intent(in) :: self
    character(*), intent(in) :: stage

    takes = self%is_wanted .and. includes(self%info%needs, stage)
    if (.not. takes .or. stage /= 'speeds' .or. .not. allocated(self%task)) return
    takes = .not. allocated(self%task%own_rpm)
  end function takes

  !> The tasks that need this stage, but one of them, as in `load, sweep or optimum`.
  pure function sentence_of(slots, stage, but) result(words)
    type(task_slot_t), intent(in) :: slots(:)
    character(*), intent(in) :: stage
    character(*), intent(in), optional :: but
    character(sentence_length) :: words
    character(task_length) :: names(size(slots))
    integer :: i, n

    n = 0
    do i = 1, size(slots)
      if (.not. includes(slots(i)%info%needs, stage)) cycle
      if (present(but)) then
        if (slots(i)%info%name == but) cycle
      end if
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
