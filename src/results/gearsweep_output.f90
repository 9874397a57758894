!> The results as files, for every interface that writes them.
module gearsweep_output
  use gearsweep_csv, only: csv_start
  use gearsweep_error, only: error_t
  use gearsweep_file_set, only: file_set_t
  use gearsweep_grid, only: grid_t
  use gearsweep_kinds, only: dp
  use gearsweep_memory, only: claim_memory, release_claim
  use gearsweep_study, only: study_t
  use gearsweep_tables, only: make_table, table_names, write_table
  use gearsweep_table, only: table_t
  use gearsweep_task, only: split_names, table_length
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
    character(:), allocatable :: text
    character(table_length), allocatable :: names(:)
    type(table_t) :: table
    integer :: i, k

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
    do i = 1, size(study%tasks)
      call split_names(study%tasks(i)%info%fields, names)
      names = pack(names, names /= 'nodes' .and. names /= 'elements')
      ! A grid by itself is called as its task, with fields as their table.
      if (size(names) == 0 .and. len(study%tasks(i)%info%fields) > 0) call write_grid(trim(study%tasks(i)%info%name))
      do k = 1, size(names)
        call make_table(study, names(k), table, error)
        call write_grid(trim(names(k)))
        if (table%is_there()) deallocate (table%meaning)
      end do
    end do
    call release_claim()
    call files%finish(error)
    if (allocated(error)) written = ''

  contains

    !> The grid of task `i` with the fields of `table`, if it has any.
    subroutine write_grid(of)
      character(*), intent(in) :: of

      if (.not. allocated(study%tasks(i)%task%grid) .or. .not. (table%is_there() .or. size(names) == 0)) then
        call files%lacks(name//'.'//of//'.vtu', vtu_start)
        return
      end if
      ! In room that doubles and is copied, then handed over once more.
      call claim_memory(5*grid_bytes(study%tasks(i)%task%grid, table), 'the text of '//name//'.'//of//'.vtu', error)
      if (.not. allocated(error)) call write_vtu(study%tasks(i)%task%grid, fields_of(table), text)
      call put(of//'.vtu', vtu_start)
    end subroutine write_grid

    subroutine put(ending, start)
      character(*), intent(in) :: ending, start

      if (allocated(error)) return
      call files%add(name//'.'//ending, start, text, error)
      written = written//folder//'/'//name//'.'//ending//new_line('a')
    end subroutine put
  end subroutine write_results

  !> Length of a grid's text with the fields of a table, at most; these are copied once more.
  pure real(dp) function grid_bytes(grid, table)
    type(grid_t), intent(in) :: grid
    type(table_t), intent(in) :: table

    grid_bytes = 1e4_dp + 50.0_dp*size(grid%x, 2) + 120.0_dp*size(grid%part)
    if (table%is_there()) grid_bytes = grid_bytes + 25.0_dp*table%rows*size(table%columns)
  end function grid_bytes

  !> The values at a grid's nodes as fields: of a table with another index before the node, for each of its values a field
  !> of all columns; otherwise each column.
  pure function fields_of(table) result(fields)
    type(table_t), intent(in) :: table
    type(vtu_field_t), allocatable :: fields(:)
    integer :: i, k, nodes

    if (.not. table%is_there()) then
      allocate (fields(0))
    else if (size(table%extent) == 1) then
      allocate (fields(size(table%columns) - 1))
      do i = 1, size(fields)
        fields(i)%name = table%columns(i + 1)%name
        fields(i)%values = reshape(table%columns(i + 1)%numbers, [1, table%rows])
      end do
    else
      nodes = table%extent(2)
      allocate (fields(table%extent(1)))
      do i = 1, size(fields)
        fields(i)%name = table%columns(1)%name//'_'//str(nint(table%columns(1)%numbers(i*nodes)))
        allocate (fields(i)%values(size(table%columns) - 2, nodes))
        do k = 3, size(table%columns)
          fields(i)%values(k - 2, :) = table%columns(k)%numbers((i - 1)*nodes + 1:i*nodes)
        end do
      end do
    end if
  end function fields_of
end module gearsweep_output
