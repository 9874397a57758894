!> Lists as text in JSON (RFC 8259), for callers that read them by program.
module gearsweep_json
  use gearsweep_lines, only: lines_t
  use gearsweep_table, only: column_t, kind_integer, kind_real, kind_text, table_t
  use gearsweep_text, only: str
  implicit none
  private
  public :: list_tables

  character(*), parameter :: kind_names(kind_real:kind_text) = [character(7) :: 'real', 'integer', 'text']

contains

  !> The tables that are there, with all but their values: name, meaning, rows, extent (null where the rows are not all
  !> combinations of the index columns' values), grid and columns;
  !> of each column name, unit, meaning, kind, whether it is an index and whether the same input gives the same bits.
  pure subroutine list_tables(tables, words)
    type(table_t), intent(in) :: tables(:)
    character(:), allocatable, intent(out) :: words
    type(lines_t) :: lines
    integer :: i, k, listed

    call lines%put('[')
    listed = 0
    do i = 1, size(tables)
      if (.not. tables(i)%is_there()) cycle
      if (listed > 0) call lines%put(',')
      listed = listed + 1
      associate (table => tables(i))
        call lines%add('')
        call lines%put('{"name": ')
        call lines%json_text(table%name)
        call lines%put(', "meaning": ')
        call lines%json_text(table%meaning)
        call lines%put(', "rows": '//str(table%rows)//', "extent": ')
        call put_extent(table, lines)
        call lines%put(', "grid": ')
        call lines%json_text(table%grid)
        call lines%put(', "columns": [')
        do k = 1, size(table%columns)
          if (k > 1) call lines%put(',')
          call lines%add('')
          call put_column(table%columns(k), lines)
        end do
        call lines%put(']}')
      end associate
    end do
    call lines%add(']')
    words = lines%text()
  end subroutine list_tables

  pure subroutine put_extent(table, lines)
    type(table_t), intent(in) :: table
    type(lines_t), intent(inout) :: lines
    integer :: i

    if (.not. allocated(table%extent)) then
      call lines%put('null')
      return
    end if
    call lines%put('[')
    do i = 1, size(table%extent)
      if (i > 1) call lines%put(', ')
      call lines%put(str(table%extent(i)))
    end do
    call lines%put(']')
  end subroutine put_extent

  pure subroutine put_column(column, lines)
    type(column_t), intent(in) :: column
    type(lines_t), intent(inout) :: lines

    call lines%put('  {"name": ')
    call lines%json_text(column%name)
    call lines%put(', "unit": ')
    call lines%json_text(column%unit)
    call lines%put(', "meaning": ')
    call lines%json_text(column%meaning)
    call lines%put(', "kind": "'//trim(kind_names(column%kind))//'", "index": ')
    call lines%put(trim(merge('true ', 'false', column%is_index)))
    call lines%put(', "reproducible": '//trim(merge('true} ', 'false}', column%is_reproducible)))
  end subroutine put_column
end module gearsweep_json
