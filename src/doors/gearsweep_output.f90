!> The results as files, for every door that writes them.
module gearsweep_output
  use gearsweep_error, only: error_t
  use gearsweep_files, only: write_text
  use gearsweep_study, only: study_t
  use gearsweep_tables, only: harmonics_table, load_table, mesh_table, mode_table, optimum_table, outline_table, &
                              published_table, root_table, sweep_table
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

    written = ''
    if (allocated(study%sharing)) call put('mesh.csv', mesh_table(study))
    if (allocated(study%harmonics)) call put('harmonics.csv', harmonics_table(study))
    if (allocated(study%response)) call put('load.csv', load_table(study))
    if (allocated(study%sweep)) call put('sweep.csv', sweep_table(study))
    if (allocated(study%optimum)) call put('vcurve.csv', optimum_table(study))
    if (allocated(study%section)) call put('outline.csv', outline_table(study))
    if (allocated(study%root)) call put('root.csv', root_table(study))
    if (allocated(study%modal)) call put('modes.csv', mode_table(study))
    if (allocated(study%published)) call put('published.csv', published_table(study))
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
