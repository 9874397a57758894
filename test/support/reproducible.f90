!> Tables without what differs from run to run, such as run times: the rest is the same bits for the same input.
module test_support_reproducible
  use gearsweep_base_table, only: column_t, table_t, write_csv
  use gearsweep_base_error, only: error_t
  use gearsweep_study_run_study, only: study_t
  use gearsweep_api_tables, only: make_table
  implicit none
  private
  public :: write_reproducible

contains

  !> The table of this name as CSV, without the columns that are declared as not reproducible; `text` is not allocated where
  !> the study has no such table.
  subroutine write_reproducible(study, name, text, error)
    type(study_t), intent(in) :: study
    character(*), intent(in) :: name
    character(:), allocatable, intent(out) :: text
    type(error_t), allocatable, intent(inout) :: error
    type(table_t) :: table
    type(column_t), allocatable :: kept(:)
    integer :: i

    call make_table(study, name, table, error)
    if (allocated(error) .or. .not. table%is_there()) return
    allocate (kept(0))
    do i = 1, size(table%columns)
      if (table%columns(i)%is_reproducible) kept = [kept, table%columns(i)]
    end do
    table%columns = kept
    call write_csv(table, study%case%text, text, error)
  end subroutine write_reproducible
end module test_support_reproducible
