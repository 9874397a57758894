!> The results as files, for every door that writes them.
module gearsweep_output
  use gearsweep_csv, only: csv_start
  use gearsweep_error, only: error_t
  use gearsweep_file_set, only: file_set_t
  use gearsweep_grid, only: grid_t
  use gearsweep_kinds, only: dp
  use gearsweep_memory, only: claim_memory, settle_memory
  use gearsweep_study, only: study_t
  use gearsweep_tables, only: make_table, table_names, write_table
  use gearsweep_table, only: table_t
  use gearsweep_text, only: str
  use gearsweep_vtu, only: vtu_field_t, vtu_start, write_vtu
  implicit none
  private
  public :: write_results

contains

  !> Writes every table and grid that the study has as `name`.sweep.csv and so on into a folder that is there. They
  !> appear all at once or, after an error, not at all, and what was there before stays. Tables and grids of that name
  !> that this study lacks are of an earlier one and get the ending `.old`, as does what is no table of ours.
  !> `written` names the files, a line each; empty after an error.
  subroutine write_results(study, folder, name, written, error)
    type(study_t), intent(in) :: study
    character(*), intent(in) :: folder, name
    character(:), allocatable, intent(out) :: written
    type(error_t), allocatable, intent(out) :: error
    type(file_set_t) :: files
    character(:), allocatable :: text, names(:)
    type(table_t) :: shapes
    integer :: i

    written = ''
    call files%begin(folder, error)
    names = table_names(on_grid=.false.)
    do i = 1, size(names)
      call write_table(study, names(i), text, error)
      if (allocated(text)) then
        call put(trim(names(i))//'.csv', csv_start)
      else
        call files%lacks(name//'.'//trim(names(i))//'.csv', csv_start)
      end if
    end do
    if (allocated(study%section)) then
      call claim_text('section.vtu', grid_bytes(study%section%grid, 0))
      if (.not. allocated(error)) call write_vtu(study%section%grid, [vtu_field_t ::], text)
      call put('section.vtu', vtu_start)
    else
      call files%lacks(name//'.section.vtu', vtu_start)
    end if
    call make_table(study, 'mode_shapes', shapes, error)
    if (shapes%is_there()) then
      call claim_text('mode_shapes.vtu', grid_bytes(study%modal%section%grid, size(study%modal%modes%frequency)))
      if (.not. allocated(error)) call write_vtu(study%modal%section%grid, fields_of(shapes), text)
      call put('mode_shapes.vtu', vtu_start)
    else
      call files%lacks(name//'.mode_shapes.vtu', vtu_start)
    end if
    call settle_memory()
    call files%finish(error)
    if (allocated(error)) written = ''

  contains

    !> In room that doubles and is copied, then handed over once more.
    subroutine claim_text(ending, bytes)
      character(*), intent(in) :: ending
      real(dp), intent(in) :: bytes

      call claim_memory(5*bytes, 'the text of '//name//'.'//ending, error)
    end subroutine claim_text

    subroutine put(ending, start)
      character(*), intent(in) :: ending, start

      if (allocated(error)) return
      call files%add(name//'.'//ending, start, text, error)
      written = written//folder//'/'//name//'.'//ending//new_line('a')
    end subroutine put
  end subroutine write_results

  !> Length of a grid's text, at most, with vector fields, which are copied once more.
  pure real(dp) function grid_bytes(grid, fields)
    type(grid_t), intent(in) :: grid
    integer, intent(in) :: fields

    grid_bytes = 1e4_dp + size(grid%x, 2)*(50 + 45.0_dp*fields) + 120.0_dp*size(grid%part)
  end function grid_bytes

  !> A table of a grid's nodes as fields: for each value of the index that stands before the node, one of all values.
  pure function fields_of(table) result(fields)
    type(table_t), intent(in) :: table
    type(vtu_field_t) :: fields(table%extent(1))
    integer :: i, k, nodes

    nodes = table%extent(2)
    do i = 1, size(fields)
      fields(i)%name = table%columns(1)%name//'_'//str(nint(table%columns(1)%numbers(i*nodes)))
      allocate (fields(i)%values(size(table%columns) - 2, nodes))
      do k = 3, size(table%columns)
        fields(i)%values(k - 2, :) = table%columns(k)%numbers((i - 1)*nodes + 1:i*nodes)
      end do
    end do
  end function fields_of
end module gearsweep_output
