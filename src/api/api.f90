!> Implementation of the calls of all languages; gearsweep_api_flat_calls passes it to Fortran 77 and Python, gearsweep_api_c to C.
module gearsweep_api_api
  use, intrinsic :: iso_c_binding, only: c_loc
  use, intrinsic :: iso_fortran_env, only: int64
  use gearsweep_base, only: begin_call => set_traps_aside, bring_traps_back, claim_memory, code_input, code_ok, column_t, dp, &
    error_t, fail, find_rows, join, kind_text, release_claim, rows_t, shown, split, str, table_t
  use gearsweep_study, only: case_t, change_key, change_keys, check_folder, check_name, make_folder, namelist_t, &
    remove_folder, run_study, study_t, write_report
  use gearsweep_api_case_reader, only: check_keys, complete_case, read_case
  use gearsweep_api_describe, only: describe_case => describe
  use gearsweep_api_handles, only: fail_name, find_column, find_study, find_table, handle_t, list_tables, release
  use gearsweep_api_new_case, only: write_new_case
  use gearsweep_api_rows, only: check_study, run_rows
  use gearsweep_api_tables, only: make_table, table_names, write_results
  implicit none
  private
  public :: begin_call, end_call, describe, edit, run, run_with_rows, text_of, size_of, numbers_of, word_of, write_files
  public :: return_text, release
  public :: error_t, int64

  integer, parameter :: most_threads = 1024
  integer, parameter, public :: longest_text = 10**9

  !> Message for a caller that wants to resume a single run, or to keep its state.
  character(*), parameter, public :: resuming_is_gone = 'a single run is no longer resumed from a file: a run that is stopped '// &
    'keeps its finished tables, and a long study goes on from the store of `gearsweep many`'

  !> Memory of a text under construction, with its parts.
  real(dp), parameter :: text_bytes = 4e6_dp

contains

  !> Returns code and message of a call; blank if there is no error. It ends each call, which `begin_call` begins.
  subroutine end_call(error, info, message)
    type(error_t), allocatable, intent(in) :: error
    integer, intent(out) :: info
    character(*), intent(out) :: message

    info = code_ok
    message = ''
    if (allocated(error)) then
      info = error%code
      message = error%message
    end if
    call release_claim()
    call bring_traps_back()
  end subroutine end_call

  !> Describes what the library has: `tables` in JSON, or as in gearsweep_api_describe.
  subroutine describe(what, words, error)
    character(*), intent(in) :: what
    character(:), allocatable, intent(out) :: words
    type(error_t), allocatable, intent(inout) :: error

    call claim_memory(text_bytes, 'the description', error)
    if (allocated(error)) return
    if (what /= 'tables') call describe_case(what, words, error)
    if (what == 'tables') words = '["'//join(table_names(), '", "')//'"]'
  end subroutine describe

  !> Edits the text of a case: adds every default (`complete`); changes a key or, if `group` and `key` are empty, all keys in
  !> `value`, which has the form of a case (`change`); lists keys of the text that are not used (`unused`); or writes a template for
  !> the tasks in `text`, separated by blanks, with or without `--short` before them (`new`). Or writes the rows of a table as JSON
  !> (`table`); `key` is then its name for messages.
  subroutine edit(action, text, group, key, value, words, error)
    character(*), intent(in) :: action, text, group, key, value
    character(:), allocatable, intent(out) :: words
    type(error_t), allocatable, intent(inout) :: error
    character(63), allocatable :: names(:)
    type(namelist_t) :: keys
    type(rows_t) :: table
    type(case_t) :: case

    call check_length(text, error)
    if (allocated(error)) return
    select case (action)
    case ('complete')
      call complete_case(text, words, error)
    case ('unused')
      call read_case(text, case, error)
      if (.not. allocated(error)) words = case%unused
    case ('new')
      call claim_memory(text_bytes, 'the new case', error)
      call split(text, names)
      if (.not. allocated(error)) call write_new_case(names, words, error)
    case ('table')
      call find_rows(text, key, '*', table, error)
      if (.not. allocated(error)) call table%write_json(words, error)
    case ('change')
      if (len(group) == 0 .and. len(key) == 0) then
        call change_keys(text, value, words, keys, error)
      else
        call change_key(text, group, key, value, words, error)
        allocate (keys%entries(1))
        keys%entries(1)%group = group
        keys%entries(1)%key = key
      end if
      if (allocated(error)) return
      if (len(value) > 0 .or. words == text) call check_keys(words, keys, error)
    case default
      call fail_name('action', action, [character(8) :: 'complete', 'change', 'unused', 'new', 'table'], error)
    end select
  end subroutine edit

  !> Runs a case. `study` is the handle of its results, which the caller owns. It is also set after an error with the codes
  !> `code_partial` and `code_stopped`, which only report missing results. `resume` and `keep` must be empty: callers of older
  !> versions name files there.
  subroutine run(text, folder, threads, earlier, watch, resume, keep, study, error)
    character(*), intent(in) :: text, folder, resume, keep
    integer, intent(in) :: threads
    integer(int64), intent(in) :: earlier
    integer, intent(inout), target :: watch(3)
    integer(int64), intent(inout) :: study
    type(error_t), allocatable, intent(inout) :: error
    type(case_t) :: case
    type(handle_t), pointer :: handle
    type(study_t), pointer :: before             ! if not associated, it counts as absent
    character(:), allocatable :: names(:)
    integer :: i

    if (resume /= '') call fail(error, code_input, 'resume = '//shown(resume)//': '//resuming_is_gone)
    if (keep /= '') call fail(error, code_input, 'keep = '//shown(keep)//': '//resuming_is_gone)
    call check_run(text, threads, earlier, before, error)
    if (.not. allocated(error)) call read_case(text, case, error)
    if (allocated(error)) return
    allocate (handle)
    call run_study(case, with_slash(folder), threads, handle%study, error, watch=watch, earlier=before)
    names = table_names()
    allocate (handle%tables(size(names)))
    do i = 1, size(names)
      call make_table(handle%study, trim(names(i)), handle%tables(i), error)
    end do
    if (allocated(error)) then
      deallocate (handle)
      return
    end if
    study = transfer(c_loc(handle), study)
    call check_study(handle%study, error)
  end subroutine run

  !> Runs a case once for each row of `values` of the keys in `names`; see gearsweep_api_rows. The study, which the caller owns,
  !> has the columns in `take`; it also exists after an error with the codes `code_partial` and `code_stopped`.
  subroutine run_with_rows(text, folder, threads, earlier, watch, names, rows, values, take, study, error)
    character(*), intent(in) :: text, folder, names, take
    integer, intent(in) :: threads, rows
    integer(int64), intent(in) :: earlier
    integer, intent(inout), target :: watch(3)
    real(dp), intent(in) :: values(*)            !< values row by row
    integer(int64), intent(inout) :: study
    type(error_t), allocatable, intent(inout) :: error
    type(handle_t), pointer :: handle
    type(study_t), pointer :: before
    character(1), allocatable :: words(:)

    call check_run(text, threads, earlier, before, error)
    if (rows < 1) call fail(error, code_input, 'rows = '//str(rows)//': must be at least 1')
    if (allocated(error)) return
    call split(names, words)
    allocate (handle)
    associate (n => size(words))
      call run_rows(text, with_slash(folder), threads, before, watch, names, reshape(values(:n*rows), [n, rows]), take, handle, &
                    error)
    end associate
    if (.not. allocated(handle%tables)) then
      deallocate (handle)
    else
      study = transfer(c_loc(handle), study)
    end if
  end subroutine run_with_rows

  !> Checks the arguments of a run; `before` is the earlier study, if there is one.
  subroutine check_run(text, threads, earlier, before, error)
    character(*), intent(in) :: text
    integer, intent(in) :: threads
    integer(int64), intent(in) :: earlier
    type(study_t), pointer, intent(out) :: before
    type(error_t), allocatable, intent(inout) :: error
    type(handle_t), pointer :: handle

    nullify (before)
    call check_length(text, error)
    if (allocated(error)) return
    if (earlier /= 0) then
      call find_study(earlier, handle, error)
      ! A study of rows may have no row that ran.
      if (allocated(handle%study%tasks)) before => handle%study
    end if
    if (threads < 0 .or. threads > most_threads) &
      call fail(error, code_input, 'threads = '//str(threads)//': must lie between 0 (all) and '//str(most_threads))
  end subroutine check_run

  !> Returns one of a study's texts.
  subroutine text_of(study, what, words, error)
    integer(int64), intent(in) :: study
    character(*), intent(in) :: what
    character(:), allocatable, intent(out) :: words
    type(error_t), allocatable, intent(inout) :: error
    type(handle_t), pointer :: handle

    call find_study(study, handle, error)
    if (what /= 'tables') call refuse_rows(handle, error)
    if (.not. allocated(error)) call claim_memory(text_bytes, 'the text', error)
    if (allocated(error)) return
    select case (what)
    case ('report')
      call write_report(handle%study, words)
    case ('log')
      words = handle%study%log
    case ('tables')
      call list_tables(handle%tables, words)
    case ('case')
      words = handle%study%case%text
    case default
      call fail_name('what', what, [character(6) :: 'report', 'log', 'tables', 'case'], error)
    end select
  end subroutine text_of

  !> Refuses a study of rows of values.
  subroutine refuse_rows(handle, error)
    type(handle_t), pointer, intent(in) :: handle
    type(error_t), allocatable, intent(inout) :: error

    if (allocated(error)) return
    if (handle%is_of_rows) call fail(error, code_input, 'study: is of rows of values, of which there are numbers only')
  end subroutine refuse_rows

  !> Returns the number of rows of a table, and the kind of a column and the length of its longest text.
  subroutine size_of(study, table_name, column_name, rows, kind, width, error)
    integer(int64), intent(in) :: study
    character(*), intent(in) :: table_name, column_name
    integer, intent(inout) :: rows, kind, width
    type(error_t), allocatable, intent(inout) :: error
    type(table_t), pointer :: table
    type(column_t), pointer :: column

    call find(study, table_name, column_name, table, column, error)
    if (allocated(error)) return
    rows = table%rows
    kind = column%kind
    width = 0
    if (kind == kind_text) width = maxval([0, len_trim(column%words)])
  end subroutine size_of

  !> Returns the numbers of a column in the first of `values`, an array of `room` elements: a negative size is none.
  subroutine numbers_of(study, table_name, column_name, room, values, error)
    integer(int64), intent(in) :: study
    character(*), intent(in) :: table_name, column_name
    integer, intent(in) :: room
    real(dp), intent(inout) :: values(:)
    type(error_t), allocatable, intent(inout) :: error
    type(table_t), pointer :: table
    type(column_t), pointer :: column

    call find(study, table_name, column_name, table, column, error)
    if (allocated(error)) return
    if (column%kind == kind_text) then
      call fail(error, code_input, 'column = '//column%name//': has words, not numbers')
    else
      call need_room('rows', room, table%rows, error)
    end if
    if (.not. allocated(error)) values(:table%rows) = column%numbers
  end subroutine numbers_of

  !> Returns the word of a text column in one row; `first` is the number of the first row.
  subroutine word_of(study, table_name, column_name, row, first, word, error)
    integer(int64), intent(in) :: study
    character(*), intent(in) :: table_name, column_name
    integer, intent(in) :: row, first
    character(:), allocatable, intent(out) :: word
    type(error_t), allocatable, intent(inout) :: error
    type(table_t), pointer :: table
    type(column_t), pointer :: column

    call find(study, table_name, column_name, table, column, error)
    if (allocated(error)) return
    if (column%kind /= kind_text) then
      call fail(error, code_input, 'column = '//column%name//': has numbers, not words')
    else if (row < first .or. row > table%rows - 1 + first) then
      call fail(error, code_input, 'row = '//str(row)//': must be from '//str(first)//' to '//str(table%rows - 1 + first))
    else
      word = trim(column%words(row - first + 1))
    end if
  end subroutine word_of

  subroutine find(study, table_name, column_name, table, column, error)
    integer(int64), intent(in) :: study
    character(*), intent(in) :: table_name, column_name
    type(table_t), pointer, intent(out) :: table
    type(column_t), pointer, intent(out) :: column
    type(error_t), allocatable, intent(inout) :: error
    type(handle_t), pointer :: handle

    call find_study(study, handle, error)
    call find_table(handle, table_name, table, error)
    call find_column(table, column_name, column, error)
  end subroutine find

  !> Writes the tables and grids as files name.sweep.csv and so on into a folder, which is made if missing. `written`
  !> names them, a line each.
  subroutine write_files(study, folder, name, written, error)
    integer(int64), intent(in) :: study
    character(*), intent(in) :: folder, name
    character(:), allocatable, intent(out) :: written
    type(error_t), allocatable, intent(inout) :: error
    type(handle_t), pointer :: handle
    integer :: made

    call find_study(study, handle, error)
    call refuse_rows(handle, error)
    if (folder == '') call fail(error, code_input, 'folder: is empty; the current one is .')
    call check_folder(folder, error)
    call check_name(name, error)
    if (allocated(error)) return
    call make_folder(folder, made, error)
    if (.not. allocated(error)) call write_results(handle%study, folder, name, written, error)
    if (allocated(error)) call remove_folder(folder, made)
  end subroutine write_files

  !> Returns a text in a buffer, or the length that it needs. Does nothing after an error.
  subroutine return_text(name, words, buffer, length, error)
    character(*), intent(in) :: name
    character(:), allocatable, intent(in) :: words
    character(*), intent(inout) :: buffer
    integer, intent(inout) :: length
    type(error_t), allocatable, intent(inout) :: error

    if (allocated(error)) return
    length = len(words)
    call need_room('len('//name//')', len(buffer), length, error)
    if (.not. allocated(error)) buffer = words
  end subroutine return_text

  !> Refuses a buffer that is too small.
  subroutine need_room(name, have, need, error)
    character(*), intent(in) :: name
    integer, intent(in) :: have, need
    type(error_t), allocatable, intent(inout) :: error

    if (have < need) call fail(error, code_input, name//' = '//str(have)//': too small, must be at least '//str(need))
  end subroutine need_room

  subroutine check_length(text, error)
    character(*), intent(in) :: text
    type(error_t), allocatable, intent(inout) :: error

    if (len(text, int64) > longest_text) &
      call fail(error, code_input, 'text: longer than '//str(longest_text)//' characters')
  end subroutine check_length

  !> Folder in the form of a study: empty for the current one, otherwise with its slash.
  pure function with_slash(folder)
    character(*), intent(in) :: folder
    character(len_trim(folder) + merge(1, 0, index(folder, '/', back=.true.) /= len_trim(folder))) :: with_slash

    with_slash = folder
    if (len(with_slash) > 0) with_slash(len(with_slash):) = '/'
  end function with_slash
end module gearsweep_api_api
