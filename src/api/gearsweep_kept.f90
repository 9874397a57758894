!> A study that a caller of another language owns, the number by which he names it (its address), and what he finds in it by name.
module gearsweep_kept
  use, intrinsic :: iso_c_binding, only: c_f_pointer, c_ptr
  use, intrinsic :: iso_fortran_env, only: int64
  use gearsweep_error, only: code_input, error_t, fail
  use gearsweep_lines, only: lines_t
  use gearsweep_study, only: study_t
  use gearsweep_table, only: column_t, kind_integer, kind_real, kind_text, table_t
  use gearsweep_text, only: closest_word, join, shown, str
  implicit none
  private
  public :: kept_t, take, release, find_table, find_column, fail_name, list_tables

  !> Nothing in it changes once it is made, so that any number of threads may read it.
  type :: kept_t
    type(study_t) :: study
    logical :: is_of_rows = .false.              !< its tables have what came of rows of values, of which the study is one
    type(table_t), allocatable :: tables(:)      !< its results; those that it lacks are not there
  end type kept_t

  integer, parameter :: longest_name = 63
  character(*), parameter :: kind_names(kind_real:kind_text) = [character(7) :: 'real', 'integer', 'text']

contains

  !> The study with this number; 0 is none.
  subroutine take(study, kept, error)
    integer(int64), intent(in) :: study
    type(kept_t), pointer, intent(out) :: kept
    type(error_t), allocatable, intent(inout) :: error
    type(c_ptr) :: address

    nullify (kept)
    if (study == 0) call fail(error, code_input, 'study: is 0, which is none; a run makes one, and it is 0 again once freed')
    if (allocated(error)) return
    address = transfer(study, address)
    call c_f_pointer(address, kept)
  end subroutine take

  !> Frees a study and sets its number to 0; 0 stays.
  subroutine release(study)
    integer(int64), intent(inout) :: study
    type(kept_t), pointer :: kept
    type(error_t), allocatable :: none

    call take(study, kept, none)
    if (associated(kept)) deallocate (kept)
    study = 0
  end subroutine release

  !> The table of this name; the error tells the closest one, or all.
  subroutine find_table(kept, name, table, error)
    type(kept_t), pointer, intent(in) :: kept
    character(*), intent(in) :: name
    type(table_t), pointer, intent(out) :: table
    type(error_t), allocatable, intent(inout) :: error
    character(longest_name), allocatable :: names(:)
    integer :: i, n

    nullify (table)
    if (allocated(error)) return
    n = 0
    allocate (names(size(kept%tables)))
    do i = 1, size(kept%tables)
      if (.not. kept%tables(i)%is_there()) cycle
      n = n + 1
      names(n) = kept%tables(i)%name
      if (names(n) == name) table => kept%tables(i)
    end do
    if (.not. associated(table)) call fail_name('table', trim(name), names(:n), error)
  end subroutine find_table

  !> The column of this name.
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

  !> Fails with the name that is not there, and what may have been meant: the closest of the words, or one of all.
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

  !> The tables that are there, in JSON, with all but their values; a line for each table and each column.
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
          call put_column(table%columns(k), lines)
        end do
        mark = ']},'
      end associate
    end do
    call lines%add(merge(']}]', '[] ', mark /= '['))
    words = lines%text()
  end subroutine list_tables

  pure subroutine put_column(column, lines)
    type(column_t), intent(in) :: column
    type(lines_t), intent(inout) :: lines

    call put_text('  {"name": ', column%name, lines)
    call put_text(', "unit": ', column%unit, lines)
    call put_text(', "meaning": ', column%meaning, lines)
    call put_text(', "kind": ', trim(kind_names(column%kind)), lines)
    call lines%put(', "index": '//str(column%is_index)//', "reproducible": '//str(column%is_reproducible)//'}')
  end subroutine put_column

  pure subroutine put_text(name, words, lines)
    character(*), intent(in) :: name, words
    type(lines_t), intent(inout) :: lines

    call lines%put(name)
    call lines%json_text(words)
  end subroutine put_text
end module gearsweep_kept
