!> Tables of a study by name, and their files.
module gearsweep_api_tables
  use gearsweep_base, only: claim_memory, csv_start, dp, error_t, release_claim, str, table_t, write_csv
  use gearsweep_elastic, only: grid_t, vtu_field_t, vtu_start, write_vtu
  use gearsweep_study, only: column_of, file_set_t, get_result, published_table, split_names, study_t, table_length, task_slot_t
  use gearsweep_api_tasks, only: list_tasks
  implicit none
  private
  public :: table_names, make_table, column_of, write_table, write_results

  !> Tables that belong to no single task.
  character(*), parameter :: of_no_task = 'motion published'

contains

  !> Names of all tables that a study can have, padded with blanks; with `on_grid` only of those on a grid, or only of the others.
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

  !> Builds the table with this name. If the study has none, `table%is_there()` is false. `error`: out of memory. Any number of
  !> callers at once.
  pure subroutine make_table(study, name, table, error)
    type(study_t), intent(in) :: study
    character(*), intent(in) :: name
    type(table_t), intent(out) :: table
    type(error_t), allocatable, intent(inout) :: error

    call get_result(study, name, table, error)
    if (name == 'published' .and. .not. allocated(error)) call published_table(study, table, error)
  end subroutine make_table

  !> Writes the table with this name as CSV; `text` is not allocated if the study has none or after an `error`.
  pure subroutine write_table(study, name, text, error)
    type(study_t), intent(in) :: study
    character(*), intent(in) :: name
    character(:), allocatable, intent(out) :: text
    type(error_t), allocatable, intent(inout) :: error
    type(table_t) :: table

    call make_table(study, name, table, error)
    if (table%is_there()) call write_csv(table, study%case%text, text, error)
  end subroutine write_table

  !> Writes every table and grid of the study as `name`.sweep.csv and so on into an existing folder. They are published all at once
  !> or, after an error, not at all, and earlier files remain. Tables and grids with that name that this study does not have are of
  !> an earlier one and are renamed with the ending `.old`, as are files of other origin. `written` names the files, a line each;
  !> empty after an error.
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
        call files%mark_absent(name//'.'//trim(names(i))//'.csv', csv_start)
      end if
    end do
    do i = 1, size(study%tasks)
      call split_names(study%tasks(i)%info%fields, names)
      names = pack(names, names /= 'nodes' .and. names /= 'elements')
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

    !> Writes the grid of task `i` with the fields of `table`, if it has any.
    subroutine write_grid(of)
      character(*), intent(in) :: of

      if (.not. (allocated(study%tasks(i)%task%grid) .and. table%is_there())) then
        call files%mark_absent(name//'.'//of//'.vtu', vtu_start)
        return
      end if
      ! Memory of the text with its doubled copies, and of the copy that is returned.
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

  !> Upper bound of the length of a grid's text with the fields of a table, including one more copy of these.
  pure real(dp) function grid_bytes(grid, table)
    type(grid_t), intent(in) :: grid
    type(table_t), intent(in) :: table

    grid_bytes = 1e4_dp + 50.0_dp*size(grid%x, 2) + 120.0_dp*size(grid%part)
    grid_bytes = grid_bytes + 25.0_dp*table%rows*size(table%columns)
  end function grid_bytes

  !> Converts values at a grid's nodes to fields: for a table with another index before the node, a field of all columns for each of
  !> its values; otherwise one for each column.
  pure function fields_of(table) result(fields)
    type(table_t), intent(in) :: table
    type(vtu_field_t), allocatable :: fields(:)
    integer :: i, k, nodes

    if (size(table%extent) == 1) then
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
end module gearsweep_api_tables
