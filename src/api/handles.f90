!> Handles: a study that a caller of another language owns, its number for the caller (its address), and its results by name.
module gearsweep_api_handles
  use, intrinsic :: iso_c_binding, only: c_f_pointer, c_ptr
  use, intrinsic :: iso_fortran_env, only: int64
  use gearsweep_base, only: closest_word, code_input, column_t, error_t, fail, join, kind_real, kind_text, lines_t, shown, str, &
    table_t
  use gearsweep_study, only: study_t
  implicit none
  private
  public :: handle_t, find_study, release, find_table, find_column, fail_name, list_tables

  !> A kept study with its tables. It does not change once it is built, so that any number of threads may read it.
  type :: handle_t
    type(study_t) :: study
    logical :: is_of_rows = .false.  !< true if its tables are the results of rows of values; the study is that of one row
    type(table_t), allocatable :: tables(:)      !< tables of its results; tables without result are absent
  end type handle_t

  integer, parameter :: longest_name = 63
  character(*), parameter :: kind_names(kind_real:kind_text) = [character(7) :: 'real', 'integer', 'text']

contains

  !> Returns the study with this number; none for 0.
  subroutine find_study(study, handle, error)
    integer(int64), intent(in) :: study
    type(handle_t), pointer, intent(out) :: handle
    type(error_t), allocatable, intent(inout) :: error
    type(c_ptr) :: address

    nullify (handle)
    if (study == 0) call fail(error, code_input, 'study: 0 is no study; a run returns one, and freeing it sets it to 0')
    if (allocated(error)) return
    address = transfer(study, address)
    call c_f_pointer(address, handle)
  end subroutine find_study

  !> Frees a study and sets its number to 0; does nothing for 0.
  subroutine release(study)
    integer(int64), intent(inout) :: study
    type(handle_t), pointer :: handle
    type(error_t), allocatable :: none

    call find_study(study, handle, none)
    if (associated(handle)) deallocate (handle)
    study = 0
  end subroutine release

  !> Finds the table with this name; the error names the closest one, or all.
  subroutine find_table(handle, name, table, error)
    type(handle_t), pointer, intent(in) :: handle
    character(*), intent(in) :: name
    type(table_t), pointer, intent(out) :: table
    type(error_t), allocatable, intent(inout) :: error
    character(longest_name), allocatable :: names(:)
    integer :: i, n

    nullify (table)
    if (allocated(error)) return
    n = 0
    allocate (names(size(handle%tables)))
    do i = 1, size(handle%tables)
      if (.not. handle%tables(i)%is_there()) cycle
      n = n + 1
      names(n) = handle%tables(i)%name
      if (names(n) == name) table => handle%tables(i)
    end do
    if (.not. associated(table)) call fail_name('table', trim(name), names(:n), error)
  end subroutine find_table

  !> Finds the column with this name.
  subroutine find_column(table, name, column, error)
    type(table_t), pointer, intent(in) :: table
    character(*), intent(in) :: name
    type(column_t), pointer, intent(out) :: column
    type(error_t), allocatable, intent(inout) :: error
    character(longest_name), allocatable :: names(:)
    integer :: i

    nullify (column)
    if (allocated(error)) return
    allocate (names(size(table%columns)))
    do i = 1, size(names)
      names(i) = table%columns(i)%name
      if (names(i) == name) column => table%columns(i)
    end do
    if (.not. associated(column)) call fail_name('column of '//table%name, trim(name), names, error)
  end subroutine find_column

  !> Fails with the unknown name, and a suggestion: the closest of the words, or all of them.
  subroutine fail_name(what, name, words, error)
    character(*), intent(in) :: what, name, words(:)
    type(error_t), allocatable, intent(inout) :: error
    integer :: best

    best = closest_word(name, words)
    if (best > 0) then
      call fail(error, code_input, what//' = '//shown(name)//': unknown (did you mean '//trim(words(best))//'?)')
    else if (size(words) == 0) then
      call fail(error, code_input, what//' = '//shown(name)//': unknown; there is none')
    else
      call fail(error, code_input, what//' = '//shown(name)//': unknown; there is '//join(words, ', '))
    end if
  end subroutine fail_name

  !> Lists the tables in JSON, without their values; a line for each table and each column.
  pure subroutine list_tables(tables, words)
    type(table_t), intent(in) :: tables(:)
    character(:), allocatable, intent(out) :: words
    type(lines_t) :: lines
    character(:), allocatable :: mark
    integer :: i, k

    mark = '['
    do i = 1, size(tables)
      if (.not. tables(i)%is_there()) cycle
      associate (table => tables(i))
        call lines%add(mark)
        call put_text('{"name": ', table%name, lines)
        call put_text(', "meaning": ', table%meaning, lines)
        call put_text(', "grid": ', table%grid, lines)
        call lines%put(', "rows": '//str(table%rows)//', "extent": ')
        if (.not. allocated(table%extent)) call lines%put('null')
        if (allocated(table%extent)) then
          do k = 1, size(table%extent)
            call lines%put(merge('[ ', ', ', k == 1)//str(table%extent(k)))
          end do
          call lines%put(']')
        end if
        do k = 1, size(table%columns)
          if (k == 1) call lines%add(', "columns": [')
          if (k > 1) call lines%add(',')
          call put_text('  {"name": ', table%columns(k)%name, lines)
          call put_text(', "unit": ', table%columns(k)%unit, lines)
          call put_text(', "meaning": ', table%columns(k)%meaning, lines)
          call put_text(', "kind": ', trim(kind_names(table%columns(k)%kind)), lines)
          call lines%put(', "index": '//str(table%columns(k)%is_index)//', "reproducible": '// &
            str(table%columns(k)%is_reproducible)//'}')
        end do
        mark = ']},'
      end associate
    end do
    call lines%add(merge(']}]', '[] ', mark /= '['))
    words = lines%text()
  end subroutine list_tables

  pure subroutine put_text(name, words, lines)
    character(*), intent(in) :: name, words
    type(lines_t), intent(inout) :: lines

    call lines%put(name)
    call lines%json_text(words)
  end subroutine put_text
end module gearsweep_api_handles
