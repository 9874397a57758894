!> What the calls of all languages do, under run-time checks: what they give, what they refuse, what they leave alone. That
!> Fortran 77, C and Python get just this is told by test/cases/test_callers.sh.
module test_calls
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use gearsweep_api_api, only: begin_call, describe, edit, end_call, error_t, int64, numbers_of, release, return_text, &
            run_case => run, run_with_rows, size_of, text_of, word_of, write_files
  use gearsweep_study_case_case, only: case_t
  use gearsweep_api_case_reader, only: read_case
  use gearsweep_study_reader_edit, only: change_key
  use gearsweep_base_error, only: code_file, code_input, code_ok, code_partial, code_stopped
  use gearsweep_base_kinds, only: dp
  use gearsweep_study_run_study, only: run_study, study_t
  use gearsweep_base_table, only: column_t, kind_text, table_t
  use gearsweep_base_text, only: str
  use gearsweep_api_tables, only: make_table, table_names
  use test_support_testing, only: check_equal, check_error, check_no_error, check_true, new_folder, remove_folder, tally_t
  implicit none
  private
  public :: run

  character(*), parameter :: pair = '&pair module_mm = 3 face_width_mm = 20 / '// &
    '&pinion teeth = 21 effective_mass_kg = 0.5 / &gear teeth = 34 effective_mass_kg = 0.9 / '// &
    '&load normal_force_n = 4000 / &relief amount_um = 0, 10 / &section elements_across = 4 / '
  character(*), parameter :: text = '&case tasks = ''mesh'', ''load'', ''sweep'', ''static'', ''modal'' / '// &
    pair//'&mesh model = ''fe'' / &static positions = 5 / &modal modes = 3 / '// &
    '&sweep rpm_first = 3000 rpm_last = 6000 rpm_step = 1000 load_rpm = 4000 /    '
  character(*), parameter :: small = '&case tasks = ''mesh'' / '//pair
  real(dp), parameter :: mark = -7

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t

    if (t%wants('columns')) call test_columns(t)
    if (t%wants('texts')) call test_texts(t)
    if (t%wants('refusals')) call test_refusals(t)
    if (t%wants('rows')) call test_rows(t)
    if (t%wants('edit')) call test_edit(t)
    if (t%wants('files')) call test_files(t)
  end subroutine run

  !> The number of a case's study.
  subroutine make(case, study, error)
    character(*), intent(in) :: case
    integer(int64), intent(out) :: study
    type(error_t), allocatable, intent(inout) :: error
    integer :: watch(3)

    study = 0
    watch = 0
    call run_case(case, '', 1, 0_int64, watch, '', '', study, error)
  end subroutine make

  !> The error is there and its message begins so; afterwards there is none.
  subroutine refused(t, name, error, begin)
    type(tally_t), intent(inout) :: t
    character(*), intent(in) :: name, begin
    type(error_t), allocatable, intent(inout) :: error

    call check_error(t, name, error, begin)
    if (allocated(error)) call check_equal(t, name//': code', error%code, code_input)
    if (allocated(error)) deallocate (error)
  end subroutine refused

  !> Every column of every table is what the study holds; the study is made a second time, by itself.
  subroutine test_columns(t)
    type(tally_t), intent(inout) :: t
    type(case_t) :: case
    type(study_t) :: own
    type(table_t) :: table
    type(error_t), allocatable :: error
    character(:), allocatable :: names(:)
    integer(int64) :: study
    integer :: watch(3), i, k

    watch = 0
    study = 0
    call run_case(text, '', 1, 0_int64, watch, '', '', study, error)
    call check_no_error(t, 'a run makes a study', error)
    call check_true(t, 'it told how far it was', study /= 0 .and. all(watch == [0, 10, 10]))
    call read_case(text, case, error)
    call run_study(case, '', 2, own, error)
    names = table_names()
    do i = 1, size(names)
      call make_table(own, trim(names(i)), table, error)
      if (.not. table%is_there()) cycle
      do k = 1, size(table%columns)
        call compare_column(t, study, table, table%columns(k))
      end do
    end do
    call release(study)
    call check_true(t, 'a study that is freed is 0', study == 0)
    call release(study)
    call check_true(t, 'and may be freed again', study == 0)
  end subroutine test_columns

  subroutine compare_column(t, study, table, column)
    type(tally_t), intent(inout) :: t
    integer(int64), intent(in) :: study
    type(table_t), intent(in) :: table
    type(column_t), intent(in) :: column
    type(error_t), allocatable :: error
    real(dp) :: values(table%rows + 1)
    character(:), allocatable :: word
    integer :: rows, kind, width, i
    logical :: same

    call size_of(study, table%name, column%name, rows, kind, width, error)
    same = rows == table%rows .and. kind == column%kind
    values = mark
    do i = 1, merge(rows, 0, kind == kind_text)
      call word_of(study, table%name, column%name, i, 1, word, error)
      same = same .and. word == column%words(i) .and. len(word) <= width
    end do
    if (kind /= kind_text) call numbers_of(study, table%name, column%name, size(values), values, error)
    if (kind /= kind_text) same = same .and. all(transfer(values(:rows), [0_int64]) == transfer(column%numbers, [0_int64]))
    same = same .and. .not. abs(values(rows + 1) - mark) > 0
    call check_true(t, table%name//' '//column%name//': its values, and no more', same .and. .not. allocated(error))
  end subroutine compare_column

  subroutine test_texts(t)
    type(tally_t), intent(inout) :: t
    character(:), allocatable :: words
    character(5) :: buffer
    type(error_t), allocatable :: error
    integer(int64) :: study
    integer :: length

    call describe('tasks', words, error)
    call check_true(t, 'tasks', index(words, '{"name": "geometry"') > 0)
    call describe('tables', words, error)
    call check_true(t, 'tables', index(words, '["geometry", "gears", ') == 1 .and. index(words, '"sweep"') > 0)
    call describe('task', words, error)
    call refused(t, 'what is not described', error, 'task: cannot be described (did you mean tasks?)')
    call make(small, study, error)
    call text_of(study, 'report', words, error)
    call check_true(t, 'the report', index(words, 'Pair ') == 1)
    buffer = 'x'
    length = 0
    call return_text('buffer', words, buffer, length, error)
    call check_true(t, 'a text needs room', length == len(words) .and. buffer == 'x')
    call refused(t, 'a text needs room', error, 'len(buffer) = 5: too small, must be at least ')
    words = 'brief'
    call return_text('buffer', words, buffer, length, error)
    call check_true(t, 'just enough room', buffer == 'brief' .and. length == 5 .and. .not. allocated(error))
    call text_of(study, 'log', words, error)
    call check_true(t, 'the log', index(words, 'sweep left out: not among the tasks') > 0)
    call text_of(study, 'case', words, error)
    call check_true(t, 'the case', words == small)
    call text_of(study, 'tables', words, error)
    call check_true(t, 'the tables', index(words, '{"name": "mesh", ') > 0 .and. &
                    index(words, '{"name": "load_share", "unit": "", ') > 0 .and. index(words, '"sweep"') == 0)
    call text_of(study, 'tabels', words, error)
    call refused(t, 'a text that is none', error, 'what = tabels: unknown (did you mean tables?)')
    call release(study)
  end subroutine test_texts

  !> What is refused leaves all as it was.
  subroutine test_refusals(t)
    type(tally_t), intent(inout) :: t
    type(error_t), allocatable :: error
    character(:), allocatable :: word
    character(6) :: short
    integer(int64) :: study
    real(dp) :: values(2)
    integer :: watch(3), rows, kind, width, info

    watch = 0
    study = -7
    call run_case('', '', 1, 0_int64, watch, '', '', study, error)
    call refused(t, 'an empty case', error, '&')
    call run_case('&colour red = 1 /', '', 1, 0_int64, watch, '', '', study, error)
    call begin_call()
    call end_call(error, info, short)
    call check_true(t, 'a short message is cut', info == code_input .and. len_trim(short) == 6)
    call refused(t, 'a group that is none', error, '&colour: unknown group')
    call run_case(small, '', -1, 0_int64, watch, '', '', study, error)
    call refused(t, 'threads', error, 'threads = -1')
    call run_case(small, '', 1, 0_int64, watch, 'a.checkpoint', 'another', study, error)
    call check_true(t, 'resuming makes no study', study == -7 .and. watch(3) == 0)
    call refused(t, 'resuming', error, 'resume = a.checkpoint: a single run is no longer resumed from a file: a run that is '// &
                 'stopped keeps its finished tables, and a long study goes on from the store of `gearsweep many`')
    call run_case(small, '', 1, 0_int64, watch, '', 'another', study, error)
    call refused(t, 'keeping the state of a run', error, 'keep = another: a single run is no longer resumed from a file')
    study = 0
    call size_of(study, 'mesh', 's', rows, kind, width, error)
    call refused(t, 'no study', error, 'study: 0 is no study')
    call make(small, study, error)
    rows = -7
    call size_of(study, 'meshes', 's', rows, kind, width, error)
    call refused(t, 'a misspelt table', error, 'table = meshes: unknown (did you mean mesh?)')
    call size_of(study, 'mesh', 'load_shar', rows, kind, width, error)
    call refused(t, 'a misspelt column', error, 'column of mesh = load_shar: unknown (did you mean load_share?)')
    call size_of(study, 'mesh', 'colour', rows, kind, width, error)
    call refused(t, 'another column: all are told', error, 'column of mesh = colour: unknown; there is relief_um, s, ')
    values = mark
    call numbers_of(study, 'mesh', 's', size(values), values, error)
    call refused(t, 'too few rows', error, 'rows = 2: too small, must be at least ')
    call numbers_of(study, 'mesh', 's', -5, values(:0), error)
    call refused(t, 'rows below 0, as they were given', error, 'rows = -5: too small, must be at least ')
    call check_true(t, 'what is refused leaves all as it was', rows == -7 .and. all(.not. abs(values - mark) > 0))
    call word_of(study, 'mesh', 's', 1, 1, word, error)
    call refused(t, 'numbers are no words', error, 'column = s: has numbers')
    call release(study)
  end subroutine test_refusals

  !> Each row has what the case with its values has by itself, to the last bit, also behind one that is refused.
  subroutine test_rows(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: n = 5, bad = 3
    character(*), parameter :: names = 'load.normal_force_n relief.amount_um gear.teeth', groups(3) = [character(6) :: 'load', &
      'relief', 'gear'], keys(3) = [character(14) :: 'normal_force_n', 'amount_um', 'teeth']
    character(*), parameter :: take = 'sweep.dynamic_factor geometry.contact_ratio sweep.rpm'
    real(dp), parameter :: values(3, n) = reshape([4000.0_dp, 10.0_dp, 34.0_dp, 4001.5_dp, 10.0_dp, 34.0_dp, -1.0_dp, 10.0_dp, &
                                                   34.0_dp, 4000.0_dp, 1/3.0_dp, 35.0_dp, 4000.0_dp, 0.0_dp, 34.0_dp], [3, n])
    character(:), allocatable :: case, changed, word
    type(error_t), allocatable :: error
    integer(int64) :: study, alone, later
    real(dp) :: code(n), found(4*n), expected(4), ratio(n), one(1)
    integer :: watch(3), i, k, rows, kind, width

    case = '&case tasks = ''sweep'' / '//pair//'&sweep rpm_first = 3000 rpm_last = 6000 rpm_step = 1000 /'
    watch = 0
    study = 0
    call run_with_rows(case, '', 2, 0_int64, watch, names, n, [values], take, study, error)
    call check_equal(t, 'a row that is refused', error%code, code_partial)
    call check_equal(t, 'a row that is refused: what is said', error%message, &
                     '1 of 5 rows of values lack results; their code and message say why')
    deallocate (error)
    call check_true(t, 'all rows are told', all(watch == [0, n, n]))
    call numbers_of(study, 'rows', 'code', n, code, error)
    call numbers_of(study, 'sweep', 'dynamic_factor', size(found), found, error)
    call numbers_of(study, 'geometry', 'contact_ratio', n, ratio, error)
    call size_of(study, 'sweep', 'dynamic_factor', rows, kind, width, error)
    call check_equal(t, 'as many numbers of each row', rows, size(found))
    do i = 1, n
      changed = case
      do k = 1, 3
        call change_key(changed, trim(groups(k)), trim(keys(k)), str(values(k, i), 17), word, error)
        call move_alloc(word, changed)
      end do
      call word_of(study, 'rows', 'message', i, 1, word, error)
      call make(changed, alone, error)
      if (i == bad) then
        call check_equal(t, 'the message of its own run', error%message, word)
        call check_true(t, 'no numbers', nint(code(i)) == code_input .and. all(ieee_is_nan(found(4*i - 3:4*i))))
        deallocate (error)
        cycle
      end if
      call numbers_of(alone, 'sweep', 'dynamic_factor', 4, expected, error)
      call numbers_of(alone, 'geometry', 'contact_ratio', 1, one, error)
      call check_true(t, 'the bits of row '//str(i), nint(code(i)) == code_ok .and. word == '' .and. &
                      all(transfer([found(4*i - 3:4*i), ratio(i)], [0_int64]) == transfer([expected, one], [0_int64])))
      call release(alone)
    end do
    call check_no_error(t, 'rows and their own runs', error)
    call text_of(study, 'tables', word, error)
    call check_true(t, 'the tables of rows', index(word, '{"name": "rows", ') > 0 .and. index(word, '{"name": "sweep", ') > 0)
    call text_of(study, 'report', word, error)
    call refused(t, 'rows have no report', error, 'study: is of rows of values')
    call write_files(study, '.', 'rows', word, error)
    call refused(t, 'rows have no files', error, 'study: is of rows of values')
    later = 0
    call run_case(case, '', 1, study, watch, '', '', later, error)
    call text_of(later, 'log', word, error)
    call check_true(t, 'rows can be earlier', index(word, 'pair stiffness by model fe, t') > 0)
    call release(later)
    call release(study)
    watch(1) = 1
    call run_with_rows(case, '', 1, 0_int64, watch, names, n, [values], take, study, error)
    call check_equal(t, 'interrupted', error%code, code_stopped)
    deallocate (error)
    call numbers_of(study, 'rows', 'code', n, code, error)
    call check_true(t, 'what is not run', all(nint(code) == code_stopped))
    call size_of(study, 'sweep', 'dynamic_factor', rows, kind, width, error)
    call refused(t, 'nothing is there of what is not run', error, 'table = sweep: unknown')
    call release(study)
    watch = 0
    study = -7
    call refuse('gear.tooth', 'sweep.rpm', 1, '&gear tooth: unknown key (did you mean teeth?)')
    call refuse('gear.teeth', 'sweep.rps', 1, 'column of sweep = rps: unknown (did you mean rpm?)')
    call refuse('gear.teeth', 'sweeep.rpm', 1, 'table = sweeep: unknown (did you mean sweep?)')
    call refuse('gear.teeth', 'sweep.status', 1, 'column = status: has words, not numbers')
    call refuse('gear', 'sweep.rpm', 1, 'names = gear: must be two names')
    call refuse('gear.teeth', 'sweep', 1, 'take = sweep: must be two names')
    call refuse('gear.teeth', 'sweep.rpm', 0, 'rows = 0: must be at least 1')

  contains

    subroutine refuse(names, take, rows, begin)
      character(*), intent(in) :: names, take, begin
      integer, intent(in) :: rows

      call run_with_rows(case, '', 1, 0_int64, watch, names, rows, [34.0_dp], take, study, error)
      call refused(t, 'rows: '//begin, error, begin)
      call check_true(t, 'no study: '//begin, study == -7)
    end subroutine refuse
  end subroutine test_rows

  subroutine test_edit(t)
    type(tally_t), intent(inout) :: t
    character(:), allocatable :: changed
    type(error_t), allocatable :: error

    call change('change', text, 'pair', 'module_mm', '3.5')
    call check_true(t, 'a key is changed', index(changed, 'module_mm = 3.5 face') > 0)
    call change('change', text, 'pair', 'backlash_um', '')
    call check_true(t, 'a key that is not there is taken out', changed == text)
    call change('change', text, 'pair', 'backlash_um', '5 / &x y = 1')
    call refused(t, 'one key and no more', error, '&pair backlash_um')
    call change('change', text, 'pair', 'modul_mm', '3.5')
    call refused(t, 'a misspelt key', error, '&pair modul_mm: unknown key (did you mean module_mm?)')
    call change('change', text, 'pairs', 'module_mm', '3.5')
    call refused(t, 'a misspelt group', error, '&pairs: unknown group (did you mean &pair?)')
    call change('change', text, 'pair', 'modul_mm', '')
    call refused(t, 'a misspelt key taken out', error, '&pair modul_mm: unknown key')
    call change('change', '&pair modul_mm = 3 /', 'pair', 'modul_mm', '')
    call check_true(t, 'one that the text has is taken out', index(changed, 'modul') == 0)
    call change('change', text, '', '', '&pair module_mm = 3.5 backlash_um = 5 / &numerics tolerance = 1e-5 /')
    call check_true(t, 'several keys are changed', index(changed, 'module_mm = 3.5 face') > 0 .and. &
                    index(changed, 'backlash_um = 5 /') > 0 .and. index(changed, '&numerics tolerance = 1e-5 /') > 0)
    call change('change', text, '', '', '&pair module_mm = 3.5 backlash = 5 /')
    call refused(t, 'one of several is misspelt', error, '&pair backlash: unknown key')
    call change('complete', text, '', '', '')
    call check_true(t, 'defaults', index(changed, 'damping_ratio = 0.1') > 0)
    call change('unused', '&case tasks = ''geometry'' / '//text(index(text, '/') + 1:), '', '', '')
    call check_true(t, 'what other tasks would use', index(changed, ': &sweep rpm_first, rpm_last, rpm_step'//new_line('a')) > 0)
    call change('unused', text, '', '', '')
    call check_equal(t, 'all is used', changed, '')
    call change('new', ' sweep  geometry', '', '', '')
    call check_true(t, 'a new case', index(changed, 'tasks = ''sweep'', ''geometry''') > 0)
    call change('chance', text, '', '', '')
    call refused(t, 'what is no action', error, 'action = chance: unknown (did you mean change?)')

  contains

    subroutine change(action, case, group, key, value)
      character(*), intent(in) :: action, case, group, key, value

      changed = ''
      call edit(action, case, group, key, value, changed, error)
      if (.not. allocated(changed)) changed = ''
    end subroutine change
  end subroutine test_edit

  subroutine test_files(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: bad(*) = [character(4) :: '', '.', '..', '../x', 'a/b', '/x', 'a'//achar(10)//'b', achar(27)]
    character(:), allocatable :: folder, files
    type(error_t), allocatable :: error
    integer(int64) :: study
    integer :: i
    logical :: there

    folder = new_folder()
    call make(small, study, error)
    call write_files(study, folder, 'case', files, error)
    inquire (file=folder//'/case.mesh.csv', exist=there)
    call check_true(t, 'files', there .and. index(files, folder//'/case.mesh.csv'//new_line('a')) > 0)
    call write_files(study, folder//'/new/folder', 'case', files, error)
    inquire (file=folder//'/new/folder/case.mesh.csv', exist=there)
    call check_true(t, 'folders that are missing are made', there .and. .not. allocated(error))
    call write_files(study, folder//'/case.mesh.csv/folder', 'case', files, error)
    call check_equal(t, 'a file in place of a folder', error%code, code_file)
    deallocate (error)
    call write_files(study, '', 'case', files, error)
    call refused(t, 'a folder without a name', error, 'folder')
    do i = 1, size(bad)
      call write_files(study, folder, trim(bad(i)), files, error)
      call refused(t, 'no name: '//bad(i), error, 'name')
    end do
    call release(study)
    call remove_folder(folder)
  end subroutine test_files
end module test_calls
