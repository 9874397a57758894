!> The tables of a study, by name.
module gearsweep_tables
  use gearsweep_csv, only: write_csv
  use gearsweep_error, only: error_t
  use gearsweep_published_table, only: published_table
  use gearsweep_results, only: column_of, get_result
  use gearsweep_study, only: study_t
  use gearsweep_table, only: table_t
  use gearsweep_task, only: split_names, table_length, task_slot_t
  use gearsweep_tasks, only: list_tasks
  implicit none
  private
  public :: table_names, make_table, column_of, write_table

  !> What belongs to no task alone.
  character(*), parameter :: of_no_task = 'motion published'

contains

  !> Names of all tables that a study can have, padded with blanks; only of those that belong to a grid, or of the
  !> others, where `on_grid` says so.
  function table_names(on_grid) result(names)
    logical, intent(in), optional :: on_grid
    character(table_length), allocatable :: names(:)
    type(task_slot_t), allocatable :: slots(:)
    character(:), allocatable :: tables, fields
    integer :: i

    call list_tasks(slots)
    tables = ''
    fields = ''
    do i = 1, size(slots)
      tables = tables//' '//slots(i)%info%tables
      fields = fields//' '//slots(i)%info%fields
    end do
    tables = tables//' '//of_no_task
    if (present(on_grid)) then
      if (on_grid) tables = ''
      if (.not. on_grid) fields = ''
    end if
    call split_names(tables//' '//fields, names)
    ! Several tasks may have the same grid.
    names = pack(names, [(all(names(:i - 1) /= names(i)), i=1, size(names))])
  end function table_names

  !> The table of this name. Where the study has none, `table%is_there()` is false. `error`: the memory does not hold it.
  !> Any number of callers at once.
  pure subroutine make_table(study, name, table, error)
    type(study_t), intent(in) :: study
    character(*), intent(in) :: name
    type(table_t), intent(out) :: table
    type(error_t), allocatable, intent(inout) :: error

    call get_result(study, name, table, error)
    if (name == 'published' .and. .not. allocated(error)) call published_table(study, table, error)
  end subroutine make_table

  !> The table of this name as CSV; `text` is not allocated where the study has none or after an `error`.
  pure subroutine write_table(study, name, text, error)
    type(study_t), intent(in) :: study
    character(*), intent(in) :: name
    character(:), allocatable, intent(out) :: text
    type(error_t), allocatable, intent(inout) :: error
    type(table_t) :: table

    call make_table(study, name, table, error)
    if (table%is_there()) call write_csv(table, study%case%text, text, error)
  end subroutine write_table
end module gearsweep_tables
