!> The calls for other languages under run-time checks: what they give, what they refuse, what they leave alone.
module test_calls
  use, intrinsic :: iso_fortran_env, only: int64
  use gearsweep_calls, only: gs_column, gs_describe, gs_edit, gs_free, gs_run, gs_size, gs_text, gs_version, gs_words, gs_write
  use gearsweep_case, only: case_t
  use gearsweep_case_reader, only: read_case
  use gearsweep_error, only: code_file, code_input, code_ok, error_t
  use gearsweep_kinds, only: dp
  use gearsweep_study, only: run_study, study_t
  use gearsweep_table, only: kind_text, table_t
  use gearsweep_tables, only: make_table, table_names
  use gearsweep_text, only: str
  use random_numbers, only: random_t
  use testing, only: check_equal, check_true, new_folder, remove_folder, tally_t
  implicit none
  private
  public :: run

  character(*), parameter :: pair = '&pair module_mm = 3 face_width_mm = 20 / '// &
    '&pinion teeth = 21 effective_mass_kg = 0.5 / &gear teeth = 34 effective_mass_kg = 0.9 / '// &
    '&load normal_force_n = 4000 / &relief amount_um = 0, 10 / &section elements_across = 4 / '
  character(*), parameter :: text = '&case tasks = ''mesh'', ''load'', ''sweep'', ''static'', ''modal'', ''section'' / '// &
    pair//'&mesh model = ''fe'' / &static positions = 5 / &modal modes = 3 / '// &
    '&sweep rpm_first = 3000 rpm_last = 6000 rpm_step = 1000 load_rpm = 4000 /    '
  character(*), parameter :: small = '&case tasks = ''mesh'' / '//pair
  integer(int64), parameter :: none = 0
  real(dp), parameter :: mark = -7

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t

    if (t%wants('columns')) call test_columns(t)
    if (t%wants('earlier')) call test_earlier(t)
    if (t%wants('threads')) call test_threads(t)
    if (t%wants('texts')) call test_texts(t)
    if (t%wants('refusals')) call test_refusals(t)
    if (t%wants('edit')) call test_edit(t)
    if (t%wants('complete_texts')) call test_complete_texts(t)
    if (t%wants('files')) call test_files(t)
  end subroutine run

  !> Every column of every table is what the study holds; the study is made a second time, by itself.
  subroutine test_columns(t)
    type(tally_t), intent(inout) :: t
    type(case_t) :: case
    type(study_t) :: own
    type(table_t) :: table
    type(error_t), allocatable :: error
    character(200) :: message
    character(:), allocatable :: names(:)
    integer(int64) :: study
    integer :: watch(3), info, i, k, tables

    watch = 0
    study = 0
    call gs_run(text, '', 1, none, watch, '', '', study, info, message)
    call check_true(t, 'a run makes a study', info == code_ok .and. message == '' .and. study /= 0)
    call check_true(t, 'it told how far it was', watch(1) == 0 .and. watch(2) == 10 .and. watch(3) == 10)
    call read_case(text, case, error)
    call run_study(case, '', 2, own, error)
    tables = 0
    names = table_names()
    do i = 1, size(names)
      call make_table(own, trim(names(i)), table, error)
      if (.not. table%is_there()) cycle
      tables = tables + 1
      do k = 1, size(table%columns)
        call compare_column(t, study, table, k)
      end do
    end do
    call check_true(t, 'tables', tables > 5)
    call gs_free(study)
    call check_true(t, 'a study that is freed is 0', study == 0)
    call gs_free(study)
    call check_true(t, 'and may be freed again', study == 0)
  end subroutine test_columns

  subroutine compare_column(t, study, table, k)
    type(tally_t), intent(inout) :: t
    integer(int64), intent(in) :: study
    type(table_t), intent(in) :: table
    integer, intent(in) :: k
    real(dp), allocatable :: values(:)
    character(:), allocatable :: word
    character(200) :: message
    integer :: rows, kind, width, info, i
    logical :: same

    associate (column => table%columns(k))
      call gs_size(study, table%name, column%name, rows, kind, width, info, message)
      call check_true(t, table%name//' '//column%name, info == code_ok .and. rows == table%rows .and. kind == column%kind)
      if (kind == kind_text) then
        same = .true.
        allocate (character(width) :: word)
        do i = 1, rows
          call gs_words(study, table%name, column%name, i, word, info, message)
          same = same .and. info == code_ok .and. word == column%words(i)
        end do
      else
        allocate (values(rows + 1), source=mark)
        call gs_column(study, table%name, column%name, rows + 1, values, info, message)
        same = info == code_ok .and. all(transfer(values(:rows), [0_int64]) == transfer(column%numbers, [0_int64])) .and. &
               .not. abs(values(rows + 1) - mark) > 0
      end if
      call check_true(t, table%name//' '//column%name//': its values, and no more', same)
    end associate
  end subroutine compare_column

  !> What an earlier study has of the same inputs is taken over, and the log says so; all else is made anew.
  subroutine test_earlier(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: n = 40
    character(n), parameter :: fe = 'stiffness by model fe, taken over', modes = 'modes, taken over', &
      shared = 'transmission error, taken over', swept = 'operating points, taken over', root = 'of the load, taken over', &
      followed = 'over the path, taken over', factored = 'factored'
    integer(int64) :: study
    integer :: watch(3), info
    character(200) :: message

    watch = 0
    study = 0
    call gs_run(text, '', 2, none, watch, '', '', study, info, message)
    call try('case', 'title', '''again''', [fe, modes, shared, swept, root, followed], [factored])
    call try('relief', 'amount_um', '0, 10, 20', [fe, modes, root], [shared, swept, factored])
    call try('sweep', 'rpm_step', '500', [fe, modes, shared, root], [swept, followed])
    call try('dynamics', 'damping_ratio', '0.1', [fe, modes, root], [swept, followed])
    call try('pinion', 'effective_mass_kg', '0.6', [fe, modes, root], [swept, followed])
    call try('static', 'positions', '6', [fe, modes, swept], [root])
    call try('modal', 'modes', '4', [fe, root, swept], [modes])
    call try('section', 'elements_across', '5', [character(n) ::], [fe, modes, root, swept])
    call try('load', 'normal_force_n', '4001', [modes, root], [fe, shared, swept])
    call gs_free(study)

  contains

    subroutine try(group, key, value, taken, made)
      character(*), intent(in) :: group, key, value, taken(:), made(:)
      character(3000) :: changed, log
      integer(int64) :: later
      integer :: length, i

      call gs_edit('change', text, group, key, value, changed, length, info, message)
      later = 0
      call gs_run(changed(:length), '', 1, study, watch, '', '', later, info, message)
      call gs_text(later, 'log', log, length, info, message)
      call check_true(t, 'from an earlier study: &'//group//' '//key, info == code_ok .and. &
                      all([(index(log, trim(taken(i))) > 0, i=1, size(taken))]) .and. &
                      .not. any([(index(log, trim(made(i))) > 0, i=1, size(made))]), trim(log))
      call gs_free(later)
    end subroutine try
  end subroutine test_earlier

  !> Four threads at once: each runs a case of its own from a study that all read, and reads that study.
  subroutine test_threads(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: threads = 4
    character(*), parameter :: relief(threads) = [character(2) :: '0', '5', '10', '20']
    integer(int64) :: study
    character(3000) :: alone(threads), found(threads)
    character(200) :: message
    integer :: watch(3), info, i

    watch = 0
    study = 0
    call gs_run(text, '', 1, none, watch, '', '', study, info, message)
    do i = 1, threads
      call look(study, relief(i), alone(i))
    end do
    !$omp parallel do default(none) shared(study, found) num_threads(threads) schedule(static, 1)
    do i = 1, threads
      call look(study, relief(i), found(i))
    end do
    !$omp end parallel do
    call check_true(t, 'four threads at once find what each finds alone', all(found == alone) .and. all(len_trim(alone) > 1000))
    call check_true(t, 'and each its own', found(1) /= found(2) .and. found(2) /= found(3))
    call gs_free(study)
  end subroutine test_threads

  !> The report of a case with another relief, and two columns: of its own study and of the one that it starts from.
  subroutine look(study, relief, found)
    integer(int64), intent(in) :: study
    character(*), intent(in) :: relief
    character(*), intent(out) :: found
    character(3000) :: changed
    character(200) :: message
    integer(int64) :: own
    real(dp) :: values(8)
    integer :: watch(3), length, info

    found = ''
    watch = 0
    own = 0
    call gs_edit('change', text, 'relief', 'amount_um', relief, changed, length, info, message)
    if (info == code_ok) call gs_run(changed(:length), '', 1, study, watch, '', '', own, info, message)
    if (info == code_ok) call gs_text(own, 'report', found, length, info, message)
    if (info == code_ok) call gs_column(own, 'sweep', 'dynamic_factor', 8, values, info, message)
    if (info == code_ok) write (found(length + 1:), '(4z17)') values(:4)
    if (info == code_ok) call gs_column(study, 'sweep', 'dynamic_factor', 8, values, info, message)
    if (info == code_ok) write (found(length + 69:), '(8z17)') values
    if (info /= code_ok) found = message
    call gs_free(own)
  end subroutine look

  subroutine test_texts(t)
    type(tally_t), intent(inout) :: t
    character(20000) :: buffer
    character(200) :: message
    character(5) :: version
    integer(int64) :: study
    integer :: watch(3), length, info

    call gs_version(version, info, message)
    call check_true(t, 'version', info == code_ok .and. index(version, '.') > 0)
    call gs_version(version(:2), info, message)
    call check_true(t, 'version: too little room', info == code_input .and. index(message, 'at least 5') > 0)
    call gs_describe('tasks', buffer, length, info, message)
    call check_true(t, 'tasks', info == code_ok .and. index(buffer, '{"name": "geometry"') > 0)
    call gs_describe('task', buffer, length, info, message)
    call check_true(t, 'what is not described', info == code_input .and. index(message, 'did you mean tasks?') > 0)
    watch = 0
    study = 0
    call gs_run(small, '', 1, none, watch, '', '', study, info, message)
    buffer = 'x'
    length = 0
    call gs_text(study, 'report', buffer(:9), length, info, message)
    call check_true(t, 'a text needs room', info == code_input .and. length > 9 .and. buffer == 'x')
    call gs_text(study, 'report', buffer, length, info, message)
    call check_true(t, 'the report', info == code_ok .and. index(buffer, 'Pair ') == 1 .and. len_trim(buffer) <= length)
    call gs_text(study, 'log', buffer, length, info, message)
    call check_true(t, 'the log', index(buffer(:length), 'sweep left out: not among the tasks') > 0)
    call gs_text(study, 'case', buffer, length, info, message)
    call check_true(t, 'the case', buffer == small)
    call gs_text(study, 'tables', buffer, length, info, message)
    call check_true(t, 'the tables', index(buffer, '{"name": "mesh", ') > 0 .and. &
                    index(buffer, '{"name": "load_share", "unit": "", ') > 0 .and. index(buffer, '"sweep"') == 0)
    call gs_text(study, 'tabels', buffer, length, info, message)
    call check_true(t, 'a text that is none', info == code_input .and. index(message, 'did you mean tables?') > 0)
    call gs_free(study)
  end subroutine test_texts

  !> What is refused leaves all as it was.
  subroutine test_refusals(t)
    type(tally_t), intent(inout) :: t
    character(200) :: message
    character(6) :: short
    integer(int64) :: study
    real(dp) :: values(2)
    integer :: watch(3), info, rows, kind, width

    watch = 0
    study = -7
    call gs_run('', '', 1, none, watch, '', '', study, info, message)
    call check_true(t, 'an empty case', info == code_input .and. index(message, '&') > 0 .and. study == -7)
    call gs_run('&colour red = 1 /', '', 1, none, watch, '', '', study, info, short)
    call check_true(t, 'a short message is cut', info == code_input .and. len_trim(short) == 6 .and. study == -7)
    call gs_run(small, '', -1, none, watch, '', '', study, info, message)
    call check_true(t, 'threads', info == code_input .and. index(message, 'threads = -1') == 1 .and. study == -7)
    call gs_run(small, '', 1, none, watch, 'no/such.checkpoint', '', study, info, message)
    call check_true(t, 'no checkpoint', info == code_file .and. study == -7)
    study = 0
    call gs_size(study, 'mesh', 's', rows, kind, width, info, message)
    call check_true(t, 'no study', info == code_input .and. index(message, 'study: is 0') == 1)
    call gs_run(small, '', 1, none, watch, '', '', study, info, message)
    rows = -7
    call gs_size(study, 'meshes', 's', rows, kind, width, info, message)
    call check_true(t, 'a misspelt table', info == code_input .and. rows == -7 .and. &
                    index(message, 'table = meshes: unknown (did you mean mesh?)') == 1)
    call gs_size(study, 'mesh', 'load_shar', rows, kind, width, info, message)
    call check_true(t, 'a misspelt column', info == code_input .and. rows == -7 .and. &
                    index(message, 'column of mesh = load_shar: unknown (did you mean load_share?)') == 1)
    call gs_size(study, 'mesh', 'colour', rows, kind, width, info, message)
    call check_true(t, 'another column: all are told', info == code_input .and. index(message, 'there is relief_um, s, ') > 0)
    values = mark
    call gs_column(study, 'mesh', 's', 2, values, info, message)
    call check_true(t, 'too few rows', info == code_input .and. index(message, 'rows = 2: too small, must be at least ') == 1 &
                    .and. all(.not. abs(values - mark) > 0))
    call gs_words(study, 'mesh', 's', 1, short, info, message)
    call check_true(t, 'numbers are no words', info == code_input .and. index(message, 'column = s: has numbers') == 1)
    call gs_free(study)
  end subroutine test_refusals

  subroutine test_edit(t)
    type(tally_t), intent(inout) :: t
    character(9000) :: complete, changed
    integer :: length, info
    character(200) :: message

    call edit('change', text, 'pair', 'module_mm', '3.5')
    call check_true(t, 'a key is changed', info == code_ok .and. index(changed, 'module_mm = 3.5 face') > 0)
    call edit('change', text, 'pair', 'backlash_um', '')
    call check_true(t, 'a key that is not there is taken out', info == code_ok .and. changed == text)
    call edit('change', text, 'pair', 'backlash_um', '5 / &x y = 1')
    call check_equal(t, 'one key and no more', info, code_input)
    call edit('change', text, 'pair', 'modul_mm', '3.5')
    call check_true(t, 'a misspelt key', info == code_input .and. &
                    index(message, '&pair modul_mm: unknown key (did you mean module_mm?)') == 1)
    call edit('change', text, 'pairs', 'module_mm', '3.5')
    call check_true(t, 'a misspelt group', info == code_input .and. &
                    index(message, '&pairs: unknown group (did you mean &pair?)') == 1)
    call edit('change', text, 'pair', 'modul_mm', '')
    call check_equal(t, 'a misspelt key taken out', info, code_input)
    call edit('change', '&pair modul_mm = 3 /', 'pair', 'modul_mm', '')
    call check_true(t, 'one that the text has is taken out', info == code_ok .and. index(changed, 'modul') == 0)
    call gs_edit('complete', text, '', '', '', complete(:5), length, info, message)
    call check_true(t, 'the complete case needs room', info == code_input .and. length > len(text))
    call edit('complete', text, '', '', '')
    complete = changed
    call check_true(t, 'defaults', info == code_ok .and. index(complete, 'damping_ratio = 0.17') > 0)
    call edit('complete', complete(:length), '', '', '')
    call check_true(t, 'the complete case is complete', info == code_ok .and. changed == complete)
    call edit('unused', '&case tasks = ''geometry'' / '//text(index(text, '/') + 1:), '', '', '')
    call check_true(t, 'what other tasks would use', info == code_ok .and. &
                    index(changed(:length), 'hysteresis or poincare: &sweep rpm_first, rpm_last, rpm_step'//achar(10)) > 0)
    call edit('unused', text, '', '', '')
    call check_true(t, 'all is used', info == code_ok .and. length == 0)
    call edit('chance', text, '', '', '')
    call check_true(t, 'what is no action', info == code_input .and. index(message, 'did you mean change?') > 0)

  contains

    subroutine edit(action, case, group, key, value)
      character(*), intent(in) :: action, case, group, key, value

      call gs_edit(action, case, group, key, value, changed, length, info, message)
    end subroutine edit
  end subroutine test_edit

  !> Random texts, with values of 1 to 17 digits and keys left out at random: where a text is accepted, so is the
  !> complete one; that completes to itself, and has the same tables bit by bit.
  subroutine test_complete_texts(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: draws = 400
    type(random_t) :: random
    character(:), allocatable :: case
    character(9000) :: complete, again
    character(200) :: message
    integer(int64), allocatable :: ours(:), other(:)
    integer :: i, length, info, accepted, unlike

    accepted = 0
    unlike = 0
    do i = 1, draws
      call draw_case(random, case)
      call find_bits(case, ours, info)
      if (info /= code_ok) cycle
      accepted = accepted + 1
      call gs_edit('complete', case, '', '', '', complete, length, info, message)
      if (info == code_ok) call gs_edit('complete', complete(:length), '', '', '', again, length, info, message)
      if (info == code_ok) info = merge(0, 1, again == complete)
      if (info == code_ok) call find_bits(complete(:length), other, info)
      if (info == code_ok .and. size(ours) == size(other) .and. size(ours) > 0) then
        if (all(ours == other)) cycle
      end if
      if (unlike == 0) print '(a)', case, trim(message)
      unlike = unlike + 1
    end do
    call check_true(t, 'most random texts are accepted', 2*accepted > draws, str(accepted)//' of '//str(draws))
    call check_equal(t, 'complete texts with another result', unlike, 0)
  end subroutine test_complete_texts

  !> The bits of all numbers of all tables.
  subroutine find_bits(text, bits, info)
    character(*), intent(in) :: text
    integer(int64), allocatable, intent(out) :: bits(:)
    integer, intent(out) :: info
    type(case_t) :: case
    type(study_t) :: study
    type(table_t) :: table
    type(error_t), allocatable :: error
    character(18), allocatable :: names(:)
    integer :: i, k

    allocate (bits(0))
    call read_case(text, case, error)
    if (.not. allocated(error)) call run_study(case, '', 1, study, error)
    info = merge(code_input, code_ok, allocated(error))
    if (allocated(error)) return
    names = table_names()
    do i = 1, size(names)
      call make_table(study, trim(names(i)), table, error)
      if (.not. table%is_there()) cycle
      do k = 1, size(table%columns)
        if (table%columns(k)%kind /= kind_text) bits = [bits, transfer(table%columns(k)%numbers, [0_int64])]
      end do
    end do
  end subroutine find_bits

  subroutine draw_case(random, case)
    type(random_t), intent(inout) :: random
    character(:), allocatable, intent(out) :: case

    case = '&case tasks = ''geometry'', ''mesh'' / &pair'
    case = case//key('module_mm', 1.0_dp, 5.0_dp, .false.)//key('face_width_mm', 10.0_dp, 30.0_dp, .false.)
    case = case//key('pressure_angle_deg', 17.0_dp, 24.0_dp, .true.)//key('backlash_um', 0.0_dp, 50.0_dp, .true.)
    case = case//' / &pinion teeth = 25'//key('profile_shift', 0.0_dp, 0.2_dp, .true.)//key('addendum', 0.9_dp, 1.0_dp, .true.)
    case = case//key('bore_mm', 0.0_dp, 5.0_dp, .true.)
    case = case//' / &gear teeth = 31'//key('dedendum', 1.2_dp, 1.3_dp, .true.)//key('rack_tip_radius', 0.2_dp, 0.3_dp, .true.)
    case = case//' / &material'//key('young_gpa', 190.0_dp, 215.0_dp, .true.)//key('poisson', 0.2_dp, 0.4_dp, .true.)
    case = case//' / &load'//key('line_load_n_mm', 50.0_dp, 500.0_dp, .false.)//' / &relief'
    case = case//key('amount_um', 0.0_dp, 30.0_dp, .false.)//key('gear_fraction', 0.0_dp, 1.0_dp, .true.)//' /'

  contains

    !> ` name = value`; where it may be left out, each second time.
    function key(name, low, high, may_lack) result(words)
      character(*), intent(in) :: name
      real(dp), intent(in) :: low, high
      logical, intent(in) :: may_lack
      character(:), allocatable :: words
      integer :: digits

      words = ''
      ! Not in one condition: the compiler would decide whether a number is drawn.
      if (may_lack) then
        if (random%uniform() < 0.5_dp) return
      end if
      digits = 1 + int(17*random%uniform())
      words = ' '//name//' = '//str(random%between(low, high), digits)
    end function key
  end subroutine draw_case

  subroutine test_files(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: bad(*) = [character(4) :: '', '.', '..', '../x', 'a/b', '/x', 'a'//achar(10)//'b', achar(27)]
    character(:), allocatable :: folder
    character(2000) :: files
    character(200) :: message
    integer(int64) :: study
    integer :: watch(3), length, info, i
    logical :: there

    folder = new_folder()
    watch = 0
    study = 0
    call gs_run(small, '', 1, none, watch, '', '', study, info, message)
    call gs_write(study, folder, 'case', files, length, info, message)
    inquire (file=folder//'/case.mesh.csv', exist=there)
    call check_true(t, 'files', info == code_ok .and. there .and. index(files, folder//'/case.mesh.csv'//new_line('a')) > 0)
    call gs_write(study, folder//'/no/folder', 'case', files, length, info, message)
    call check_equal(t, 'no folder', info, code_file)
    call gs_write(study, ' ', 'case', files, length, info, message)
    call check_true(t, 'a folder without a name', info == code_input .and. index(message, 'folder') == 1)
    do i = 1, size(bad)
      call gs_write(study, folder, bad(i), files, length, info, message)
      call check_true(t, 'no name: '//bad(i), info == code_input .and. index(message, 'name') == 1)
    end do
    call gs_free(study)
    call remove_folder(folder)
  end subroutine test_files
end module test_calls
