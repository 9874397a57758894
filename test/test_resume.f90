!> A run that its caller ends keeps what is done, and goes on from there to the bits of a run in one piece.
module test_resume
  use, intrinsic :: iso_c_binding, only: c_int
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use, intrinsic :: iso_fortran_env, only: int64
  use gearsweep_case, only: case_t
  use gearsweep_case_reader, only: read_case
  use gearsweep_checkpoint, only: load_record, save_record
  use gearsweep_error, only: error_t
  use gearsweep_files, only: read_text
  use gearsweep_kinds, only: dp
  use gearsweep_record_file, only: opening_length, record_reader_t, record_writer_t
  use gearsweep_status, only: status_name, status_stopped
  use gearsweep_study, only: record_t, run_study, study_t
  use gearsweep_table, only: table_t
  use gearsweep_tables, only: column_of, make_table, table_names
  use gearsweep_taken, only: taken_of
  use gearsweep_text, only: str
  use testing, only: check_equal, check_error, check_no_error, check_true, new_folder, remove_folder, tally_t
  implicit none
  private
  public :: run

  character(*), parameter :: gears = '&pinion teeth = 25 effective_mass_kg = 0.8 / &gear effective_mass_kg = 0.9 /'// &
    '&load normal_force_n = 6858 / &relief amount_um = 0, 2, 15 / &dynamics damping_ratio = 0.01 /'// &
    '&mesh model = ''polynomial'' contact_ratio = 1.6 coefficients = 400, 0, -120 /'

  !> What a run is told and counts; only the tests of this module use it, one after the other.
  integer(c_int), target :: watch(3)
  integer :: last_done, allowed
  logical :: fell, beyond
  character(:), allocatable :: file

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t
    character(:), allocatable :: folder

    folder = new_folder()
    file = folder//'/test.checkpoint'
    if (t%wants('whole_again up')) call whole_again(t, 'up', '''sweep'', ''load''', '', 1)
    if (t%wants('whole_again down')) call whole_again(t, 'down', '''sweep'', ''load''', '', 2)
    if (t%wants('whole_again both')) call whole_again(t, 'both', '''sweep'', ''load''', '', 2)
    if (t%wants('whole_again each')) call whole_again(t, 'each', '''sweep'', ''load''', '', 2)
    if (t%wants('whole_again up')) call whole_again(t, 'up', '''sweep'', ''optimum''', '', 2)
    if (t%wants('whole_again march')) then
      call whole_again(t, 'each', '''sweep''', '&numerics steady_state = ''march'' tolerance = 1e-4 /', 1)
    end if
    if (t%wants('whole_again tasks')) call whole_again(t, 'up', &
      '''stability'', ''hysteresis'', ''poincare'', ''attractors'', ''load''', &
      '&stability damping_count = 3 tongues = 1 / &hysteresis rpm = 6700, 6800, 6900 closeness = 1e-2 /'// &
      '&poincare rpm = 6800, 7000 settling_periods = 20 kept_periods = 9 / &attractors rpm = 6800, 7000 starts = 2 /', 2)
    if (t%wants('ended_again')) call ended_again(t)
    if (t%wants('pieces')) call pieces_of_a_file(t)
    if (t%wants('refused')) call refused(t)
    if (t%wants('ended_at_once')) call ended_at_once(t)
    call remove_folder(folder)
  end subroutine run

  subroutine read(t, direction, tasks, more, case)
    type(tally_t), intent(inout) :: t
    character(*), intent(in) :: direction, tasks, more
    type(case_t), intent(out) :: case
    type(error_t), allocatable :: error

    call read_case('&case tasks = '//tasks//' / '//gears//more//'&sweep rpm_first = 5000 rpm_last = 9000 rpm_step = 50 '// &
                   'load_rpm = 6800, 7010 direction = '''//direction//''' /', case, error)
    call check_no_error(t, 'the case', error)
  end subroutine read

  !> Counts, and ends the run once as many more points are done as it was allowed.
  subroutine follow(done, total)
    integer, intent(in) :: done, total

    fell = fell .or. done < last_done
    beyond = beyond .or. done > total
    if (done >= allowed) watch(1) = 1
    last_done = done
  end subroutine follow

  !> Ended again and again, each time further on; by the file in between.
  subroutine whole_again(t, direction, tasks, more, threads)
    type(tally_t), intent(inout) :: t
    character(*), intent(in) :: direction, tasks, more
    integer, intent(in) :: threads
    integer, parameter :: most = 100
    type(case_t) :: case
    type(study_t) :: whole, piece
    type(record_t) :: record
    type(error_t), allocatable :: error
    character(:), allocatable :: what
    integer :: pieces, step

    what = direction//' '//tasks//more//': '
    call read(t, direction, tasks, more, case)
    call run_study(case, '', 1, whole, error)
    call check_no_error(t, what//'in one piece', error)
    step = merge(400, 60, index(tasks, 'optimum') > 0)
    if (index(tasks, 'stability') > 0) step = 5
    last_done = 0
    fell = .false.
    beyond = .false.
    do pieces = 1, most
      watch = 0
      allowed = pieces*step
      ! A sweep goes on where it was ended, another task from its beginning.
      if (index(tasks, 'stability') > 0) last_done = 0
      call run_study(case, '', threads, piece, error, follow, watch=watch, record=record)
      call check_no_error(t, what//'a piece', error)
      if (.not. piece%stopped) exit
      if (size(column_of(piece, 'sweep', 'rpm')) > 0) call check_part(t, what, piece, whole)
      call save_record(record, case, '', file, error)
      call check_no_error(t, what//'kept', error)
      record = record_t()
      call load_record(file, case, '', record, error)
      call check_no_error(t, what//'taken up', error)
    end do
    call check_true(t, what//'several pieces', pieces > 2 .and. pieces < most, str(pieces))
    call check_true(t, what//'the count never falls, nor passes the whole', .not. (fell .or. beyond))
    call check_true(t, what//'the caller reads the count', watch(2) == last_done .and. watch(3) >= watch(2))
    call check_same(t, what, piece, whole)
  end subroutine whole_again

  !> What is there is right, and what is not says so and has no number.
  subroutine check_part(t, what, piece, whole)
    type(tally_t), intent(inout) :: t
    character(*), intent(in) :: what
    type(study_t), intent(in) :: piece, whole

    type(table_t) :: some, all_points
    type(error_t), allocatable :: error

    call make_table(piece, 'sweep', some, error)
    call make_table(whole, 'sweep', all_points, error)
    associate (status => some%columns(some%position('status'))%words, &
               right => all_points%columns(all_points%position('status'))%words, factor => some%numbers('dynamic_factor'))
      associate (done => status /= status_name(status_stopped))
        call check_true(t, what//'done points have their status', all(status == right .or. .not. done))
        call check_true(t, what//'and their bits', all(bits(factor) == bits(all_points%numbers('dynamic_factor')) .or. .not. done))
        call check_true(t, what//'the others have no number', all(ieee_is_nan(factor) .or. done))
      end associate
    end associate
  end subroutine check_part

  subroutine check_same(t, what, piece, whole)
    type(tally_t), intent(inout) :: t
    character(*), intent(in) :: what
    type(study_t), intent(in) :: piece, whole
    type(table_t) :: one, other
    type(error_t), allocatable :: error
    character(18), allocatable :: names(:)
    integer :: i, k

    names = table_names()
    do i = 1, size(names)
      call make_table(piece, names(i), one, error)
      call make_table(whole, names(i), other, error)
      call check_true(t, what//'has the table '//trim(names(i)), one%is_there() .eqv. other%is_there())
      if (.not. (one%is_there() .and. other%is_there())) cycle
      do k = 1, size(other%columns)
        associate (a => one%columns(k), b => other%columns(k))
          if (allocated(b%numbers)) call check_true(t, what//trim(names(i))//' '//b%name, all(bits(a%numbers) == bits(b%numbers)))
          if (allocated(b%words)) call check_true(t, what//trim(names(i))//' '//b%name, all(a%words == b%words))
        end associate
      end do
    end do
  end subroutine check_same

  pure function bits(x)
    real(dp), intent(in) :: x(:)
    integer(int64) :: bits(size(x))

    bits = transfer(x, [0_int64])
  end function bits

  !> A resumed run that is ended before it begins keeps all that the first one had done: its tables, and the checkpoint.
  subroutine ended_again(t)
    type(tally_t), intent(inout) :: t
    character(*), parameter :: done(*) = [character(18) :: 'load', 'sweep', 'sweep_worst', 'resonances', 'sweep_summary', &
                                          'stability', 'tongues', 'tongue_edges']
    type(case_t) :: case
    type(study_t) :: first, again
    type(record_t) :: record
    type(table_t) :: one, other
    type(error_t), allocatable :: error
    integer :: i, k, round, part

    ! Ended after the 6 points of load, 243 of the sweep and 81 of stability; or within the sweep.
    do part = 1, 2
      call read(t, 'up', '''sweep'', ''stability'', ''load'', ''poincare''', '&stability damping_count = 3 tongues = 1 /'// &
                '&poincare rpm = 6800, 7000 settling_periods = 20 kept_periods = 9 /', case)
      watch = 0
      last_done = 0
      allowed = merge(6 + 243 + 81, 100, part == 1)
      record = record_t()
      call run_study(case, '', 1, first, error, follow, watch=watch, record=record)
      call check_true(t, 'ended: the first', first%stopped .and. watch(2) >= allowed)
      do round = 1, 2
        call save_record(record, case, '', file, error)
        record = record_t()
        call load_record(file, case, '', record, error)
        call check_no_error(t, 'ended at once: taken up', error)
        if (part == 1) call check_equal(t, 'ended at once: what is taken over', trim(taken_of(record, case)), &
                                        'load, sweep, stability')
        if (part == 2) call check_true(t, 'ended at once: how much', index(taken_of(record, case), ' % of sweep, load') > 0)
        watch = [1, 0, 0]
        call run_study(case, '', 1, again, error, watch=watch, record=record)
        call check_no_error(t, 'ended at once', error)
        call check_true(t, 'ended at once: the count begins where it ended', watch(2) >= allowed - 1 .and. again%stopped)
      end do
      do i = 1, merge(size(done), 5, part == 1)
        call make_table(first, done(i), one, error)
        call make_table(again, done(i), other, error)
        call check_true(t, 'ended at once: keeps '//done(i), one%is_there() .and. other%is_there())
        if (.not. (one%is_there() .and. other%is_there())) cycle
        do k = 1, size(one%columns)
          if (allocated(one%columns(k)%numbers)) call check_true(t, 'ended at once: bits of '//trim(done(i))//' '// &
            one%columns(k)%name, all(bits(one%columns(k)%numbers) == bits(other%columns(k)%numbers)))
        end do
      end do
    end do
  end subroutine ended_again

  !> More words than are written or read at once, texts among them; each bit counts.
  subroutine pieces_of_a_file(t)
    type(tally_t), intent(inout) :: t
    integer, parameter :: n = 150001
    type(record_writer_t) :: writer
    type(record_reader_t) :: reader
    type(error_t), allocatable :: error
    character(opening_length) :: opening
    character(:), allocatable :: text, whole
    integer(int64), allocatable :: words(:), found(:)
    integer :: i, at

    words = [(i*7919_int64**3 - 5, i=1, n)]
    found = 0*words
    call writer%begin(file, 'an opening', error)
    call writer%put(words(:7))
    call writer%put_text('a text of 22 letters..')
    call writer%put_text('')
    call writer%put(words(8:))
    call writer%finish(error)
    call check_no_error(t, 'pieces: written', error)
    call reader%begin(file, opening, error)
    call check_equal(t, 'pieces: the opening', opening(:10), 'an opening')
    call reader%look_through(file, error)
    call check_true(t, 'pieces: whole', reader%is_good)
    ! Two texts have their lengths, and 22 letters take 3 words.
    call check_equal(t, 'pieces: how many words', int(reader%words), n + 2 + 3)
    call reader%take(found(:7))
    call reader%take_text(text)
    call check_equal(t, 'pieces: a text', text, 'a text of 22 letters..')
    call reader%take_text(text)
    call check_equal(t, 'pieces: an empty text', text, '')
    call reader%take(found(8:))
    call check_true(t, 'pieces: the words', all(found == words) .and. reader%is_good)
    call reader%finish()
    call read_text(file, whole, error)
    do i = 1, 40
      at = 1 + int((len(whole) - 1)*(i - 1)/39.0_dp)
      call put(whole(:at - 1)//achar(ieor(iachar(whole(at:at)), ishft(1, modulo(i, 8))))//whole(at + 1:))
      call reader%begin(file, opening, error)
      call reader%look_through(file, error)
      call check_true(t, 'pieces: another bit is seen', .not. reader%is_good)
      call reader%finish()
    end do
    call put(whole(:len(whole) - 3))
    call reader%begin(file, opening, error)
    call reader%look_through(file, error)
    call check_true(t, 'pieces: a cut is seen', .not. reader%is_good)
    call reader%finish()
  end subroutine pieces_of_a_file

  !> A file of another case, version or kind, and a damaged one.
  subroutine refused(t)
    type(tally_t), intent(inout) :: t
    type(case_t) :: case, other
    type(study_t) :: study
    type(record_t) :: record
    type(error_t), allocatable :: error
    character(:), allocatable :: text
    integer :: at

    call read(t, 'up', '''sweep''', '', case)
    watch = [1, 0, 0]
    call run_study(case, '', 1, study, error, watch=watch, record=record)
    watch = 0
    allowed = 50
    call run_study(case, '', 1, study, error, follow, watch=watch, record=record)
    call check_true(t, 'ended', study%stopped)
    call save_record(record, case, '', file, error)
    call read(t, 'down', '''sweep''', '', other)
    call check_refused(t, 'another case', file, other, 'is of another case')
    call read_text(file, text, error)
    at = index(text, 'version ')
    call put(text(:at + 7)//'9'//text(at + 9:))
    call check_refused(t, 'another version', file, case, 'is of another version')
    at = len(text)/2
    call put(text(:at - 1)//merge('1', '2', text(at:at) == '2')//text(at + 1:))
    call check_refused(t, 'damaged', file, case, 'is damaged')
    call put(text(:at))
    call check_refused(t, 'cut', file, case, 'is damaged')
    call put('gearsweep checkpoint 2'//text(23:))
    call check_refused(t, 'the format before', file, case, 'is of another version')
    call put('something else')
    call check_refused(t, 'no checkpoint', file, case, 'is no checkpoint')
    call check_refused(t, 'no file', file//'.none', case, 'cannot read')
  end subroutine refused

  subroutine check_refused(t, name, path, case, why)
    type(tally_t), intent(inout) :: t
    character(*), intent(in) :: name, path, why
    type(case_t), intent(in) :: case
    type(record_t) :: record
    type(error_t), allocatable :: error

    call load_record(path, case, '', record, error)
    call check_error(t, name, error, why)
  end subroutine check_refused

  subroutine put(text)
    character(*), intent(in) :: text
    integer :: unit

    open (newunit=unit, file=file, status='replace', action='write', access='stream', form='unformatted')
    write (unit) text
    close (unit)
  end subroutine put

  !> A flag that is set before: nothing is computed, and nothing goes wrong.
  subroutine ended_at_once(t)
    type(tally_t), intent(inout) :: t
    type(case_t) :: case
    type(study_t) :: study
    type(error_t), allocatable :: error

    call read(t, 'up', '''mesh'', ''sweep''', '', case)
    watch = [1, 0, 0]
    call run_study(case, '', 2, study, error, watch=watch)
    call check_no_error(t, 'ended at once', error)
    call check_true(t, 'the mesh is there', size(column_of(study, 'mesh', 'ste_um')) > 0)
    call check_true(t, 'the sweep is not', study%stopped .and. size(column_of(study, 'sweep', 'rpm')) == 0)
    call check_true(t, 'the log says so', index(study%log, 'sweep left out: the run was interrupted') > 0)
    call check_equal(t, 'nothing was counted', int(watch(2)), 0)
  end subroutine ended_at_once
end module test_resume
