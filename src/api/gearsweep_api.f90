!> What the calls of all languages do; gearsweep_flat_calls hands it to Fortran 77 and Python, gearsweep_c to C.
module gearsweep_api
  use, intrinsic :: iso_c_binding, only: c_loc
  use, intrinsic :: iso_fortran_env, only: int64
  use gearsweep_case, only: case_t
  use gearsweep_case_reader, only: check_keys, complete_case, read_case
  use gearsweep_describe, only: describe_case => describe
  use gearsweep_checkpoint, only: drop_checkpoint, load_record, save_record, try_checkpoint
  use gearsweep_edit, only: change_key, change_keys
  use gearsweep_error, only: code_input, code_ok, error_t, fail
  use gearsweep_files, only: check_folder, check_name, make_folder, remove_folder
  use gearsweep_kept, only: fail_name, find_column, find_table, kept_t, list_tables, release, take
  use gearsweep_kinds, only: dp
  use gearsweep_memory, only: claim_memory, release_claim
  use gearsweep_namelist, only: namelist_t
  use gearsweep_new_case, only: write_new_case
  use gearsweep_output, only: write_results
  use gearsweep_report, only: write_report
  use gearsweep_rows, only: judge, run_rows
  use gearsweep_study, only: record_t, run_study, study_t
  use gearsweep_table, only: column_t, kind_text, table_t
  use gearsweep_tables, only: make_table, table_names
  use gearsweep_text, only: join, split, str
  use gearsweep_traps, only: begin_call => set_traps_aside, bring_traps_back
  implicit none
  private
  public :: begin_call, end_call, describe, edit, run, run_with_rows, text_of, size_of, numbers_of, word_of, write_files
  public :: give, release
  public :: error_t, int64

  integer, parameter :: most_threads = 1024
  integer, parameter, public :: longest_text = 10**9

  !> What a text in the making takes, with the parts that it is made of.
  real(dp), parameter :: text_bytes = 4e6_dp

contains

  !> Code and message of a call; blank where all is well. Last of all in each call, which `begin_call` begins.
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

  !> What the library has: `tables` in JSON, or as gearsweep_describe has it.
  subroutine describe(what, words, error)
    character(*), intent(in) :: what
    character(:), allocatable, intent(out) :: words
    type(error_t), allocatable, intent(inout) :: error

    call claim_memory(text_bytes, 'the description', error)
    if (allocated(error)) return
    if (what /= 'tables') call describe_case(what, words, error)
    if (what == 'tables') words = '["'//join(table_names(), '", "')//'"]'
  end subroutine describe

  !> A case's text with every default (`complete`), with another value of a key or, where `group` and `key` are empty, of all
  !> keys that `value` has as a case has them (`change`), what it gives but does not use (`unused`), or a case to begin with
  !> for the tasks that `text` names with blanks between them, `--short` before them or not (`new`).
  subroutine edit(action, text, group, key, value, words, error)
    character(*), intent(in) :: action, text, group, key, value
    character(:), allocatable, intent(out) :: words
    type(error_t), allocatable, intent(inout) :: error
    character(63), allocatable :: names(:)
    type(namelist_t) :: keys
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
      call fail_name('action', action, [character(8) :: 'complete', 'change', 'unused', 'new'], error)
    end select
  end subroutine edit

  !> Runs a case. `study` is the number of what it found, which the caller owns. It is there also after an error with the
  !> codes `code_partial` and `code_stopped`, which only tell what it lacks.
  subroutine run(text, folder, threads, earlier, watch, resume, keep, study, error)
    character(*), intent(in) :: text, folder, resume, keep
    integer, intent(in) :: threads
    integer(int64), intent(in) :: earlier
    integer, intent(inout), target :: watch(3)
    integer(int64), intent(inout) :: study
    type(error_t), allocatable, intent(inout) :: error
    type(case_t) :: case
    type(kept_t), pointer :: kept
    type(study_t), pointer :: before             ! one that is not associated counts as not passed
    type(record_t), allocatable :: record        ! one that is not allocated counts as not passed
    type(error_t), allocatable :: lost           ! why what was done is not kept
    character(:), allocatable :: names(:)
    integer :: i

    call check_run(text, threads, earlier, before, error)
    if (.not. allocated(error)) call read_case(text, case, error)
    if (resume /= '' .or. keep /= '') allocate (record)
    if (.not. allocated(error) .and. resume /= '') call load_record(resume, case, place(folder), record, error)
    if (keep /= '') call try_checkpoint(keep, error)
    if (allocated(error)) return
    allocate (kept)
    call run_study(case, place(folder), threads, kept%study, error, watch=watch, record=record, &
                   earlier=before)
    names = table_names()
    allocate (kept%tables(size(names)))
    do i = 1, size(names)
      call make_table(kept%study, trim(names(i)), kept%tables(i), error)
    end do
    if (.not. allocated(error) .and. keep /= '') then
      if (kept%study%stopped) call save_record(record, case, place(folder), keep, lost)
      if (.not. kept%study%stopped) call drop_checkpoint(keep, case, place(folder))
    end if
    if (allocated(error)) then
      deallocate (kept)
      return
    end if
    study = transfer(c_loc(kept), study)
    call judge(kept%study, error)
    if (allocated(lost)) error%message = error%message//'; it is not kept: '//lost%message
  end subroutine run

  !> Runs a case once for each row of `values` of the keys in `names`; see gearsweep_rows. The study, which the caller owns, has the
  !> columns in `take`; it is there also after an error with the codes `code_partial` and `code_stopped`.
  subroutine run_with_rows(text, folder, threads, earlier, watch, names, rows, values, take, study, error)
    character(*), intent(in) :: text, folder, names, take
    integer, intent(in) :: threads, rows
    integer(int64), intent(in) :: earlier
    integer, intent(inout), target :: watch(3)
    real(dp), intent(in) :: values(*)            !< those of a row one after the other
    integer(int64), intent(inout) :: study
    type(error_t), allocatable, intent(inout) :: error
    type(kept_t), pointer :: kept
    type(study_t), pointer :: before
    character(1), allocatable :: words(:)

    call check_run(text, threads, earlier, before, error)
    if (rows < 1) call fail(error, code_input, 'rows = '//str(rows)//': must be at least 1')
    if (allocated(error)) return
    call split(names, words)
    allocate (kept)
    associate (n => size(words))
      call run_rows(text, place(folder), threads, before, watch, names, reshape(values(:n*rows), [n, rows]), take, kept, error)
    end associate
    if (.not. allocated(kept%tables)) then
      deallocate (kept)
    else
      study = transfer(c_loc(kept), study)
    end if
  end subroutine run_with_rows

  !> What every run needs; `before` is the earlier study, where one is given.
  subroutine check_run(text, threads, earlier, before, error)
    character(*), intent(in) :: text
    integer, intent(in) :: threads
    integer(int64), intent(in) :: earlier
    type(study_t), pointer, intent(out) :: before
    type(error_t), allocatable, intent(inout) :: error
    type(kept_t), pointer :: kept

    nullify (before)
    call check_length(text, error)
    if (allocated(error)) return
    if (earlier /= 0) then
      call take(earlier, kept, error)
      ! Of rows of values none may have run.
      if (allocated(kept%study%tasks)) before => kept%study
    end if
    if (threads < 0 .or. threads > most_threads) &
      call fail(error, code_input, 'threads = '//str(threads)//': must lie between 0 (all) and '//str(most_threads))
  end subroutine check_run

  !> One of a study's texts.
  subroutine text_of(study, what, words, error)
    integer(int64), intent(in) :: study
    character(*), intent(in) :: what
    character(:), allocatable, intent(out) :: words
    type(error_t), allocatable, intent(inout) :: error
    type(kept_t), pointer :: kept

    call take(study, kept, error)
    if (what /= 'tables') call check_whole(kept, error)
    if (.not. allocated(error)) call claim_memory(text_bytes, 'the text', error)
    if (allocated(error)) return
    select case (what)
    case ('report')
      call write_report(kept%study, words)
    case ('log')
      words = kept%study%log
    case ('tables')
      call list_tables(kept%tables, words)
    case ('case')
      words = kept%study%case%text
    case default
      call fail_name('what', what, [character(6) :: 'report', 'log', 'tables', 'case'], error)
    end select
  end subroutine text_of

  !> Refuses a study of rows of values.
  subroutine check_whole(kept, error)
    type(kept_t), pointer, intent(in) :: kept
    type(error_t), allocatable, intent(inout) :: error

    if (allocated(error)) return
    if (kept%is_of_rows) call fail(error, code_input, 'study: is of rows of values, of which there are numbers only')
  end subroutine check_whole

  !> How many rows a table has, of what kind a column of it is, and how long its longest text is.
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

  !> The numbers of a column into the first of `values`, of which the caller has `room`: below 0, as he says, is none.
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

  !> The words of a text column in one row; the first has the number `first`.
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
    type(kept_t), pointer :: kept

    call take(study, kept, error)
    call find_table(kept, table_name, table, error)
    call find_column(table, column_name, column, error)
  end subroutine find

  !> Writes the tables and grids as files name.sweep.csv and so on into a folder, which is made if missing. `written`
  !> names them, a line each.
  subroutine write_files(study, folder, name, written, error)
    integer(int64), intent(in) :: study
    character(*), intent(in) :: folder, name
    character(:), allocatable, intent(out) :: written
    type(error_t), allocatable, intent(inout) :: error
    type(kept_t), pointer :: kept
    logical :: made

    call take(study, kept, error)
    call check_whole(kept, error)
    if (folder == '') call fail(error, code_input, 'folder: is empty; the current one is .')
    call check_folder(folder, error)
    call check_name(name, error)
    if (allocated(error)) return
    call make_folder(folder, made, error)
    if (.not. allocated(error)) call write_results(kept%study, folder, name, written, error)
    if (allocated(error) .and. made) call remove_folder(folder)
  end subroutine write_files

  !> Hands a text out, or tells the length that it needs. Nothing is done after an error.
  subroutine give(name, words, buffer, length, error)
    character(*), intent(in) :: name
    character(:), allocatable, intent(in) :: words
    character(*), intent(inout) :: buffer
    integer, intent(inout) :: length
    type(error_t), allocatable, intent(inout) :: error

    if (allocated(error)) return
    length = len(words)
    call need_room('len('//name//')', len(buffer), length, error)
    if (.not. allocated(error)) buffer = words
  end subroutine give

  !> Refuses room that is too small.
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

  !> A folder as the study takes it: empty for the current one, else with its slash.
  pure function place(folder)
    character(*), intent(in) :: folder
    character(len_trim(folder) + merge(1, 0, index(folder, '/', back=.true.) /= len_trim(folder))) :: place

    place = folder
    if (len(place) > 0) place(len(place):) = '/'
  end function place
end module gearsweep_api
