!> The results as files, for every door that writes them.
module gearsweep_output
  use gearsweep_error, only: error_t
  use gearsweep_files, only: write_text
  use gearsweep_study, only: study_t
  use gearsweep_tables, only: has_table, table_names, write_table
  use gearsweep_text, only: str
  use gearsweep_vtu, only: vtu_field_t, vtu_text
  implicit none
  private
  public :: write_results

contains

  !> Writes every table and grid that the study has as `path`.sweep.csv and so
  !> on; `written` names the files, a line each, up to the first that fails.
  subroutine write_results(study, path, written, error)
    type(study_t), intent(in) :: study
    character(*), intent(in) :: path
    character(:), allocatable, intent(out) :: written
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: table
    integer :: i

    written = ''
    do i = 1, size(table_names)
      if (.not. has_table(study, table_names(i))) cycle
      call write_table(study, table_names(i), table)
      call put(trim(table_names(i))//'.csv', table)
    end do
    if (allocated(study%section)) call put('section.vtu', vtu_text(study%section%grid, [vtu_field_t ::]))
    if (allocated(study%modal)) call put('modes.vtu', vtu_text(study%modal%section%grid, shapes(study)))

  contains

    subroutine put(ending, text)
      character(*), intent(in) :: ending, text

      if (allocated(error)) return
      call write_text(path//'.'//ending, text, error)
      if (.not. allocated(error)) written = written//path//'.'//ending//new_line('a')
    end subroutine put
  end subroutine write_results

  !> The mode shapes as fields of the grid.
  pure function shapes(study) result(fields)
    type(study_t), intent(in) :: study
    type(vtu_field_t) :: fields(size(study%modal%modes%frequency))
    integer :: i

    do i = 1, size(fields)
      fields(i)%name = 'mode_'//str(i)
      fields(i)%values = study%modal%modes%shape(:, :, i)
    end do
  end function shapes
end module gearsweep_output
