!> Results of the tasks of a study, by the names of tables and columns.
module gearsweep_study_results_results
  use gearsweep_base, only: claim_memory, dp, error_t, table_t
  use gearsweep_study_results_motion_table, only: motion_table
  use gearsweep_study_run_study, only: study_t
  implicit none
  private
  public :: get_result, column_of

contains

  !> Copies the table of this name; an empty one if no task has it. `error`: out of memory.
  pure subroutine get_result(study, name, table, error)
    type(study_t), intent(in) :: study
    character(*), intent(in) :: name
    type(table_t), intent(out) :: table
    type(error_t), allocatable, intent(inout) :: error
    integer :: i, at

    table%name = trim(name)
    if (name == 'motion') call motion_table(study, table, error)
    if (allocated(error) .or. .not. allocated(study%tasks)) return
    do i = 1, size(study%tasks)
      associate (task => study%tasks(i)%task)
        if (.not. task%is_done) cycle
        at = task%place(trim(name))
        if (at == 0) cycle
        if (.not. task%tables(at)%is_there()) cycle
        call claim_memory(task%tables(at)%bytes(), 'the table '//trim(name), error)
        if (.not. allocated(error)) table = task%tables(at)
        return
      end associate
    end do
  end subroutine get_result

  !> Numbers of a column by the names of table and column; none if the study does not have the table.
  pure function column_of(study, table_name, name) result(numbers)
    type(study_t), intent(in) :: study
    character(*), intent(in) :: table_name, name
    real(dp), allocatable :: numbers(:)
    type(table_t) :: table
    type(error_t), allocatable :: error

    allocate (numbers(0))
    call get_result(study, table_name, table, error)
    if (table%is_there()) numbers = table%numbers(name)
  end function column_of
end module gearsweep_study_results_results
