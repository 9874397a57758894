!> What a task of a case is. A task is one file that extends `task_t`: what it needs, the keys of its own group, how it
!> runs and what it yields. One line in gearsweep_tasks lists it.
!>
!> As a case is read, each task takes its keys. In a run, a task that the case names gets the products of the stages
!> that it needs, and keeps its result; its tables and lines for the screen are made of that.
module gearsweep_task
  use gearsweep_decimal, only: in_um
  use gearsweep_error, only: code_input, error_t, fail
  use gearsweep_error_estimate, only: accuracy_t
  use gearsweep_kinds, only: dp
  use gearsweep_lines, only: lines_t
  use gearsweep_mesh, only: mesh_t
  use gearsweep_oscillator, only: oscillator_t
  use gearsweep_pair, only: pair_t
  use gearsweep_reader, only: reader_t
  use gearsweep_table, only: table_t
  use gearsweep_text, only: str
  implicit none
  private
  public :: task_t, task_info_t, stages_t, includes

  integer, parameter, public :: task_length = 12

  !> Products of the stages that several tasks share. Those that no wanted task needs are not allocated.
  type :: stages_t
    type(pair_t), allocatable :: pair            !< none for a prescribed mesh
    type(mesh_t), allocatable :: mesh            !< without relief
    real(dp) :: base_pitch = 0                   !< m; 0: not known of a prescribed mesh
    real(dp) :: load = 0                         !< static load on the line of action, N
    real(dp) :: mass(2) = 0                      !< effective masses, kg
    type(oscillator_t), allocatable :: motion(:)  !< one for each relief
    real(dp), allocatable :: amount(:)           !< the reliefs, m
    real(dp), allocatable :: rpm(:)              !< speeds of &sweep, 1/min, ascending
    type(accuracy_t) :: accuracy                 !< with the flag that ends the run
  end type stages_t

  !> What is said of a task. `needs` names stages, blanks between them:
  !>   geometry  gears, which a prescribed mesh has not
  !>   body      one gear's body by finite elements
  !>   mesh      load, masses and stiffness
  !>   reliefs   the result depends on the relief
  !>   motion    the equation of motion, and so friction
  !>   losses    damping, and what follows once flanks part: backlash
  !>   accuracy  &numerics
  !>   speeds    those of &sweep
  type :: task_info_t
    character(task_length) :: name = ''
    character(:), allocatable :: needs
    character(:), allocatable :: gives           !< what it computes, without a full stop
    character(:), allocatable :: tables          !< names of all tables that it can fill, blanks between them
  end type task_info_t

  !> A task with the values of its keys and, after its run, its result.
  type, abstract :: task_t
    ! Keys that several tasks have, each in its own group:
    real(dp), allocatable :: own_rpm(:)          !< 1/min; not allocated: it takes the speeds of &sweep
    real(dp), allocatable :: own_relief(:)       !< m; not allocated: it takes all of the case
    logical :: is_done = .false.                 !< there is a result
    integer :: failed = 0                        !< operating points without a result
    character(:), allocatable :: log             !< what was done, a line without its end
  contains
    procedure(describe_task), deferred, nopass :: describe
    procedure(read_task), deferred :: read_keys
    procedure(run_task), deferred :: run
    procedure(fill_task), deferred :: fill_table
    procedure(report_task), deferred :: add_report
    procedure :: read_speeds, read_reliefs, check_reliefs, list_speeds, list_reliefs
  end type task_t

  abstract interface
    pure subroutine describe_task(info)
      import :: task_info_t
      type(task_info_t), intent(out) :: info
    end subroutine describe_task

    !> Adds the groups of its keys and takes these, whether the case names the task or not.
    subroutine read_task(self, reader, error)
      import :: error_t, reader_t, task_t
      class(task_t), intent(inout) :: self
      type(reader_t), intent(inout) :: reader
      type(error_t), allocatable, intent(inout) :: error
    end subroutine read_task

    !> Computes the result from what the stages have.
    subroutine run_task(self, stages, error)
      import :: error_t, stages_t, task_t
      class(task_t), intent(inout) :: self
      type(stages_t), intent(in) :: stages
      type(error_t), allocatable, intent(inout) :: error
    end subroutine run_task

    !> Fills a table, which has its name already, from the result.
    pure subroutine fill_task(self, table, error)
      import :: error_t, table_t, task_t
      class(task_t), intent(in) :: self
      type(table_t), intent(inout) :: table
      type(error_t), allocatable, intent(inout) :: error
    end subroutine fill_task

    !> Some lines for the screen.
    pure subroutine report_task(self, lines)
      import :: lines_t, task_t
      class(task_t), intent(in) :: self
      type(lines_t), intent(inout) :: lines
    end subroutine report_task
  end interface

contains

  !> Does a task with these `needs` need this stage?
  pure logical function includes(needs, stage)
    character(*), intent(in) :: needs, stage

    includes = index(' '//needs//' ', ' '//stage//' ') > 0
  end function includes

  !> The key `rpm` of the group that is called as the task. `order`: what is said of their order; without, they must
  !> ascend.
  subroutine read_speeds(self, reader, group, error, order)
    class(task_t), intent(inout) :: self
    type(reader_t), intent(inout) :: reader
    character(*), intent(in) :: group
    type(error_t), allocatable, intent(inout) :: error
    character(*), intent(in), optional :: order
    integer, parameter :: most = 100000
    character(:), allocatable :: meaning
    integer :: i

    meaning = 'speeds of the pinion, ascending'
    if (present(order)) meaning = 'speeds of the pinion, '//order
    call reader%get(group, 'rpm', self%own_rpm, error, unit='1/min', tasks=group, at_least=1e-6_dp, at_most=1e9_dp, &
                    max_size=most, otherwise='those of &sweep', meaning=meaning)
    if (present(order) .or. .not. allocated(self%own_rpm)) return
    do i = 2, size(self%own_rpm)
      if (self%own_rpm(i) <= self%own_rpm(i - 1)) call fail(error, code_input, '&'//group//' rpm: must ascend; '// &
        str(self%own_rpm(i))//' comes after '//str(self%own_rpm(i - 1)))
    end do
  end subroutine read_speeds

  !> The key `relief_um` of the group that is called as the task.
  subroutine read_reliefs(self, reader, group, error)
    class(task_t), intent(inout) :: self
    type(reader_t), intent(inout) :: reader
    character(*), intent(in) :: group
    type(error_t), allocatable, intent(inout) :: error

    call reader%get(group, 'relief_um', self%own_relief, error, unit='um', tasks=group, at_least=0.0_dp, at_most=1e9_dp, &
                    max_size=10000, otherwise='all of &relief amount_um', &
                    meaning='amounts of tip relief to take, each of which &relief amount_um has')
  end subroutine read_reliefs

  !> The reliefs that it takes must be among the case's, `amount` (m).
  subroutine check_reliefs(self, group, amount, error)
    class(task_t), intent(in) :: self
    character(*), intent(in) :: group
    real(dp), intent(in) :: amount(:)
    type(error_t), allocatable, intent(inout) :: error
    integer :: i

    if (.not. allocated(self%own_relief)) return
    do i = 1, size(self%own_relief)
      if (minval(abs(amount - self%own_relief(i))) > 1e-9_dp*self%own_relief(i)) call fail(error, code_input, &
        '&'//trim(group)//' relief_um = '//str(in_um(self%own_relief(i)))//': is none of &relief amount_um')
    end do
  end subroutine check_reliefs

  !> The speeds that it takes (1/min).
  pure subroutine list_speeds(self, stages, rpm)
    class(task_t), intent(in) :: self
    type(stages_t), intent(in) :: stages
    real(dp), allocatable, intent(out) :: rpm(:)

    if (allocated(self%own_rpm)) rpm = self%own_rpm
    if (.not. allocated(self%own_rpm)) rpm = stages%rpm
  end subroutine list_speeds

  !> Which of the case's reliefs it takes.
  pure subroutine list_reliefs(self, stages, which)
    class(task_t), intent(in) :: self
    type(stages_t), intent(in) :: stages
    integer, allocatable, intent(out) :: which(:)
    integer :: i

    if (allocated(self%own_relief)) then
      which = [(minloc(abs(stages%amount - self%own_relief(i)), 1), i=1, size(self%own_relief))]
    else
      which = [(i, i=1, size(stages%amount))]
    end if
  end subroutine list_reliefs
end module gearsweep_task
