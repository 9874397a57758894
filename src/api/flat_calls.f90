! Calls for Fortran 77, for Python (python/gearsweep/flat.pyf), and for other languages: the same eleven as for C, with the same
! arguments, which never change. include/gearsweep.h describes each call and its arguments. Here
!
! study, earlier  are integer*8; 0: none.
! texts           are padded with blanks at their end, which do not count; blank: none.
! buffer, length  are a text for the caller, lines ended by char(10), and its length; if buffer is too short, info is 1,
!                 length is the required one, and buffer is unchanged.
! watch           is required.
! row             is counted from 1.
! info, message   are the code and the message, always the last arguments: 0 and blank, or one of the header's codes. A message
!                 that is too long is cut.

!> Version of the library, as 0.1.0.
subroutine gs_version(version, info, message)
  use gearsweep_base, only: this => version
  use gearsweep_api_api, only: begin_call, end_call, error_t, return_text
  implicit none
  character(*), intent(inout) :: version
  integer, intent(out) :: info
  character(*), intent(out) :: message
  type(error_t), allocatable :: error
  character(:), allocatable :: words
  integer :: length

  call begin_call()
  words = this
  call return_text('version', words, version, length, error)
  call end_call(error, info, message)
end subroutine gs_version

!> Describes what the library has, as text in JSON.
subroutine gs_describe(what, buffer, length, info, message)
  use gearsweep_api_api, only: begin_call, describe, end_call, error_t, return_text
  implicit none
  character(*), intent(in) :: what
  character(*), intent(inout) :: buffer
  integer, intent(inout) :: length
  integer, intent(out) :: info
  character(*), intent(out) :: message
  type(error_t), allocatable :: error
  character(:), allocatable :: words

  call begin_call()
  call describe(trim(what), words, error)
  call return_text('buffer', words, buffer, length, error)
  call end_call(error, info, message)
end subroutine gs_describe

!> Works on the text of a case.
subroutine gs_edit(action, text, group, key, value, buffer, length, info, message)
  use gearsweep_api_api, only: begin_call, edit, end_call, error_t, return_text
  implicit none
  character(*), intent(in) :: action, text, group, key, value
  character(*), intent(inout) :: buffer
  integer, intent(inout) :: length
  integer, intent(out) :: info
  character(*), intent(out) :: message
  type(error_t), allocatable :: error
  character(:), allocatable :: words

  call begin_call()
  call edit(trim(action), text, trim(group), trim(key), trim(value), words, error)
  call return_text('buffer', words, buffer, length, error)
  call end_call(error, info, message)
end subroutine gs_edit

!> Runs a case: all its tasks.
subroutine gs_run(text, folder, threads, earlier, watch, resume, keep, study, info, message)
  use gearsweep_api_api, only: begin_call, end_call, error_t, int64, run
  implicit none
  character(*), intent(in) :: text, folder, resume, keep
  integer, intent(in) :: threads
  integer(int64), intent(in) :: earlier
  integer, intent(inout), target :: watch(3)
  integer(int64), intent(inout) :: study
  integer, intent(out) :: info
  character(*), intent(out) :: message
  type(error_t), allocatable :: error

  call begin_call()
  call run(text, trim(folder), threads, earlier, watch, trim(resume), trim(keep), study, error)
  call end_call(error, info, message)
end subroutine gs_run

!> Runs a case once for each row of values of some of its keys.
subroutine gs_rows(text, folder, threads, earlier, watch, names, rows, values, take, study, info, message)
  use gearsweep_api_api, only: begin_call, end_call, error_t, int64, run_with_rows
  implicit none
  character(*), intent(in) :: text, folder, names, take
  integer, intent(in) :: threads, rows
  integer(int64), intent(in) :: earlier
  integer, intent(inout), target :: watch(3)
  double precision, intent(in) :: values(*)
  integer(int64), intent(inout) :: study
  integer, intent(out) :: info
  character(*), intent(out) :: message
  type(error_t), allocatable :: error

  call begin_call()
  call run_with_rows(text, trim(folder), threads, earlier, watch, names, rows, values, take, study, error)
  call end_call(error, info, message)
end subroutine gs_rows

!> Returns one of the texts of a study.
subroutine gs_text(study, what, buffer, length, info, message)
  use gearsweep_api_api, only: begin_call, end_call, error_t, int64, return_text, text_of
  implicit none
  integer(int64), intent(in) :: study
  character(*), intent(in) :: what
  character(*), intent(inout) :: buffer
  integer, intent(inout) :: length
  integer, intent(out) :: info
  character(*), intent(out) :: message
  type(error_t), allocatable :: error
  character(:), allocatable :: words

  call begin_call()
  call text_of(study, trim(what), words, error)
  call return_text('buffer', words, buffer, length, error)
  call end_call(error, info, message)
end subroutine gs_text

!> Returns the number of rows of a table, and kind and width of a column.
subroutine gs_size(study, table, column, rows, kind, width, info, message)
  use gearsweep_api_api, only: begin_call, end_call, error_t, int64, size_of
  implicit none
  integer(int64), intent(in) :: study
  character(*), intent(in) :: table, column
  integer, intent(inout) :: rows, kind, width
  integer, intent(out) :: info
  character(*), intent(out) :: message
  type(error_t), allocatable :: error

  call begin_call()
  call size_of(study, table, column, rows, kind, width, error)
  call end_call(error, info, message)
end subroutine gs_size

!> The numbers of a column; `rows` is the room in `values`.
subroutine gs_column(study, table, column, rows, values, info, message)
  use gearsweep_api_api, only: begin_call, end_call, error_t, int64, numbers_of
  implicit none
  integer(int64), intent(in) :: study
  character(*), intent(in) :: table, column
  integer, intent(in) :: rows
  double precision, intent(inout) :: values(rows)
  integer, intent(out) :: info
  character(*), intent(out) :: message
  type(error_t), allocatable :: error

  call begin_call()
  call numbers_of(study, table, column, rows, values, error)
  call end_call(error, info, message)
end subroutine gs_column

!> The words of a column in one row.
subroutine gs_words(study, table, column, row, word, info, message)
  use gearsweep_api_api, only: begin_call, end_call, error_t, int64, return_text, word_of
  implicit none
  integer(int64), intent(in) :: study
  character(*), intent(in) :: table, column
  integer, intent(in) :: row
  character(*), intent(inout) :: word
  integer, intent(out) :: info
  character(*), intent(out) :: message
  type(error_t), allocatable :: error
  character(:), allocatable :: words
  integer :: length

  call begin_call()
  call word_of(study, table, column, row, 1, words, error)
  call return_text('word', words, word, length, error)
  call end_call(error, info, message)
end subroutine gs_words

!> Writes a study's tables and grids as files.
subroutine gs_write(study, folder, name, buffer, length, info, message)
  use gearsweep_api_api, only: begin_call, end_call, error_t, int64, return_text, write_files
  implicit none
  integer(int64), intent(in) :: study
  character(*), intent(in) :: folder, name
  character(*), intent(inout) :: buffer
  integer, intent(inout) :: length
  integer, intent(out) :: info
  character(*), intent(out) :: message
  type(error_t), allocatable :: error
  character(:), allocatable :: words

  call begin_call()
  call write_files(study, trim(folder), trim(name), words, error)
  call return_text('buffer', words, buffer, length, error)
  call end_call(error, info, message)
end subroutine gs_write

!> Frees a study, which nobody may read meanwhile, and sets it to 0; a study of 0 stays.
subroutine gs_free(study)
  use gearsweep_api_api, only: int64, release
  implicit none
  integer(int64), intent(inout) :: study

  call release(study)
end subroutine gs_free
