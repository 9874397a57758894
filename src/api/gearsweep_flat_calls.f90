! The calls for Fortran 77, for Python (python/gearsweep/flat.pyf), and for whatever can call them. Their arguments never
! change; gearsweep_api has what they do, include/gearsweep.h the same calls for C.
!
! text           the case, as the program reads it; groups may follow each other on one line.
! folder         where files that the case names lie; blank: the current folder.
! study          integer*8: a study that gs_run made. The caller owns it: it stays until gs_free. Any number of threads
!                may read one study at once, and each may run its own. 0: none.
! table, column  their names, as in the files NAME.TABLE.csv and in gs_text's list; a misspelt one is answered with the
!                closest.
! buffer, length a text for the caller, lines ended by char(10), and its length; where buffer is too short, info is 1,
!                length tells what is needed, and buffer is as it was.
! info, message  0 and blank; else a code of gearsweep_error: 1 case or argument unusable (room too small: the message
!                says how much is needed), 3 file or folder, 4 some operating points have no answer (NaN; all else is
!                there), 5 a method failed, 6 memory, 130 interrupted (what was computed by then is there). But for 4
!                and 130, the results are as they were. A message that is too long is cut.
!
! Nothing prints, stops or keeps state. While a study runs, OpenBLAS is kept to one thread; the number before comes back
! when the last run ends.

!> Version of the library, as 0.1.0.
subroutine gs_version(version, info, message)
  use gearsweep_api, only: begin_call, end_call, give
  use gearsweep_error, only: error_t
  use gearsweep_version, only: this => version
  implicit none
  character(*), intent(inout) :: version
  integer, intent(out) :: info
  character(*), intent(out) :: message
  type(error_t), allocatable :: error
  character(:), allocatable :: words
  integer :: length

  call begin_call()
  words = this
  call give('version', words, version, length, error)
  call end_call(error, info, message)
end subroutine gs_version

!> What the library has, as text in JSON.
!>
!> what  'tasks': what a case can ask for; 'groups' and 'keys': what a case may say, with units, defaults and bounds;
!>       'key GROUP KEY': one of the keys; 'all': these three together; 'tables': the tables that there can be
subroutine gs_describe(what, buffer, length, info, message)
  use gearsweep_api, only: begin_call, describe, end_call, give
  use gearsweep_error, only: error_t
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
  call give('buffer', words, buffer, length, error)
  call end_call(error, info, message)
end subroutine gs_describe

!> Works on the text of a case.
!>
!> action  'complete': the case with every key that it leaves to its default written out; it gives the same result
!>         'change': the case with another value of one key; the rest of the text stays as it is, with its remarks.
!>         A key that no case has is refused, unless it is taken out of a text that has it. Whether this case allows
!>         the key and the value is told by the run
!>         'unused': the keys that the case gives but does not use, mostly for tasks that it does not name: for each use
!>         that they would have, a line `use: &group key, key; &group key`
!>         'new': a case for the tasks in `text`, separated by blanks, with every key of theirs and its default
!> group   without &; one that is missing is added. This and the next two are for 'change' alone
!> key     its name
!> value   as it stands in a case, such as 0, 5, 10 or 'fe'; blank: the key is taken out
subroutine gs_edit(action, text, group, key, value, buffer, length, info, message)
  use gearsweep_api, only: begin_call, edit, end_call, give
  use gearsweep_error, only: error_t
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
  call give('buffer', words, buffer, length, error)
  call end_call(error, info, message)
end subroutine gs_edit

!> Runs a case: all its tasks.
!>
!> threads   of the sweep; 0: all. The results are the same for any number
!> earlier   a study whose products are taken over where they were made from the same inputs, so that they cost nothing;
!>           the results are the same bits as without. It stays as it is. 0: none
!> watch(1)  0; whoever sets it to another number while the call computes, a signal or another thread, ends the run
!>           soon: info is 130, and operating points that are not computed have the status stopped and NaN
!> watch(2)  operating points done, as the call goes on; never fewer than before
!> watch(3)  of how many
!> resume    file that an interrupted run left: what was done by then is taken over, to the same bits. One of another
!>           version, or of a case that differs, is refused. Blank: begins anew
!> keep      file that is written where the run is interrupted, and removed where it is not; may be that of resume.
!>           Blank: none
!> study     what was found; untouched after an error
subroutine gs_run(text, folder, threads, earlier, watch, resume, keep, study, info, message)
  use, intrinsic :: iso_fortran_env, only: int64
  use gearsweep_api, only: begin_call, end_call, run
  use gearsweep_error, only: error_t
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

!> One of the texts of a study.
!>
!> what  'report': what the program prints; 'log': which stages ran, which were taken over and which left out, a line
!>       each; 'tables': in JSON, the tables with their columns, units and meanings; 'case': the case that was run
subroutine gs_text(study, what, buffer, length, info, message)
  use, intrinsic :: iso_fortran_env, only: int64
  use gearsweep_api, only: begin_call, end_call, give, text_of
  use gearsweep_error, only: error_t
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
  call give('buffer', words, buffer, length, error)
  call end_call(error, info, message)
end subroutine gs_text

!> How many rows a table has, and what a column of it holds.
!>
!> kind   1 real numbers, 2 whole numbers, both for gs_column; 3 words, for gs_words
!> width  of the longest words, 0 for numbers
subroutine gs_size(study, table, column, rows, kind, width, info, message)
  use, intrinsic :: iso_fortran_env, only: int64
  use gearsweep_api, only: begin_call, end_call, size_of
  use gearsweep_error, only: error_t
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

!> The numbers of a column.
!>
!> rows    room in values, at least the table's rows; what lies beyond those is not touched
!> values  in the unit that the column's name ends with; NaN where there is no result
subroutine gs_column(study, table, column, rows, values, info, message)
  use, intrinsic :: iso_fortran_env, only: int64
  use gearsweep_api, only: begin_call, end_call, numbers_of
  use gearsweep_error, only: error_t
  implicit none
  integer(int64), intent(in) :: study
  character(*), intent(in) :: table, column
  integer, intent(in) :: rows
  double precision, intent(inout) :: values(rows)
  integer, intent(out) :: info
  character(*), intent(out) :: message
  type(error_t), allocatable :: error

  call begin_call()
  call numbers_of(study, table, column, values, error)
  call end_call(error, info, message)
end subroutine gs_column

!> The words of a column in one row.
!>
!> row   from 1
!> word  at least as long as gs_size says
subroutine gs_words(study, table, column, row, word, info, message)
  use, intrinsic :: iso_fortran_env, only: int64
  use gearsweep_api, only: begin_call, end_call, give, word_of
  use gearsweep_error, only: error_t
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
  call give('word', words, word, length, error)
  call end_call(error, info, message)
end subroutine gs_words

!> Writes a study's tables and grids as files NAME.TABLE.csv and NAME.GRID.vtu: all, or none where one cannot be written,
!> and then what was there before stays. Calls at once into one folder are served one after the other. Files of an
!> earlier call with this name that this study has not get the ending .old.
!>
!> folder  without a slash at its end; it is made if missing
!> name    without a folder and control characters
!> buffer  the files that were written, a line each; they are written also where buffer is too short
subroutine gs_write(study, folder, name, buffer, length, info, message)
  use, intrinsic :: iso_fortran_env, only: int64
  use gearsweep_api, only: begin_call, end_call, give, write_files
  use gearsweep_error, only: error_t
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
  call give('buffer', words, buffer, length, error)
  call end_call(error, info, message)
end subroutine gs_write

!> Frees a study, which nobody may read meanwhile, and sets it to 0; a study of 0 stays.
subroutine gs_free(study)
  use, intrinsic :: iso_fortran_env, only: int64
  use gearsweep_kept, only: release
  implicit none
  integer(int64), intent(inout) :: study

  call release(study)
end subroutine gs_free
