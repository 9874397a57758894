!> gearsweep CASE.nml: reads a case, computes, prints the answer, leaves tables.
!> The only place that prints or stops.
program gearsweep_program
  use, intrinsic :: iso_c_binding, only: c_int, c_int64_t
  use, intrinsic :: iso_fortran_env, only: error_unit, int64
  use gearsweep
  use gearsweep_base, only: closest_word, code_stopped, print_text, str, to_number, visible
  use gearsweep_study, only: check_folder, check_name, fail_system, folder_of, make_folder, read_text, remove_folder
  use gearsweep_api, only: describe, help_on, resuming_is_gone, write_new_case, write_results
  use gearsweep_interruption, only: catch_signals, drop_unread, watch
  use gearsweep_progress, only: show_progress
  implicit none

  interface
    integer(c_int) function c_isatty(descriptor) bind(c, name='isatty')
      import :: c_int
      integer(c_int), value :: descriptor
    end function c_isatty

    subroutine c_exit(code) bind(c, name='exit')
      import :: c_int
      integer(c_int), value :: code
    end subroutine c_exit
  end interface

  type :: arguments_t
    character(:), allocatable :: case, out, name
    integer :: threads = 0
    logical :: verbose = .false., quiet = .false.
  end type arguments_t

  type(arguments_t) :: arguments
  type(case_t) :: case
  type(study_t) :: study
  type(error_t), allocatable :: error
  character(:), allocatable :: text, written
  integer :: made = 0
  character, parameter :: lf = new_line('a')
  integer(int64) :: began, ended, rate

  call system_clock(began, rate)
  call drop_unread()
  call read_arguments(arguments)
  call read_text(place_of(arguments%case), text, error, stream=.true.)
  if (allocated(error)) call suggest_command(error)
  ! Not before: a signal ends a program that waits for its case.
  call catch_signals()
  call check(error)
  call check_folder(arguments%out, error)
  call check_name(arguments%name, error)
  call check(error)
  call read_case(text, case, error)
  call check(error)
  call make_folder(arguments%out, made, error)
  call check(error)
  if (progress_wanted()) then
    call run_study(case, folder_of(arguments%case), arguments%threads, study, error, show_progress, watch=watch)
    write (error_unit, '(a)', advance='no') achar(13)//repeat(' ', 60)//achar(13)
  else
    call run_study(case, folder_of(arguments%case), arguments%threads, study, error, watch=watch)
  end if
  call check(error)
  call system_clock(ended)
  ! Before anything is printed: whoever reads may leave, and the process with him.
  call write_results(study, arguments%out, arguments%name, written, error)
  if (.not. arguments%quiet) call show_answer()
  call check(error)
  if (study%stopped) call end_interrupted()
  if (failed_points(study) > 0) call finish(code_partial)

contains

  subroutine show_answer()
    character(:), allocatable :: text

    call write_report(study, text)
    call print_line('gearsweep '//version)
    call print_out(text)
    call print_line('Time               '//str(real(ended - began, dp)/rate, 3)//' s')
    if (arguments%verbose) call print_out(lf//study%log)
    call show_files()
  end subroutine show_answer

  !> What was written: of several tables how many, unless all names are wanted.
  subroutine show_files()
    character(*), parameter :: table = '.csv'//lf
    character(:), allocatable :: others, line
    integer :: from, until, tables

    others = ''
    tables = 0
    from = 1
    do while (from <= len(written))
      until = from + index(written(from:), lf) - 1
      line = written(from:until)
      from = until + 1
      if (line(max(1, len(line) - len(table) + 1):) == table) tables = tables + 1
      if (line(max(1, len(line) - len(table) + 1):) /= table) others = others//'Wrote              '//line
      if (arguments%verbose) call print_out('Wrote              '//line)
    end do
    if (arguments%verbose) return
    if (tables > 0) call print_line('Wrote              '//str(tables)//' tables: '//arguments%out//'/'//arguments%name//'.*.csv')
    call print_out(others)
  end subroutine show_files

  subroutine print_line(line)
    character(*), intent(in) :: line

    call print_out(line//lf)
  end subroutine print_line

  !> Prints to the standard output, and ends where that takes no more; that tables are missing weighs more.
  subroutine print_out(words)
    character(*), intent(in) :: words
    integer(c_int) :: code

    code = print_text(words, len(words, c_int64_t))
    if (code == 0) return
    call fail_system('cannot write to the standard output', code, error)
    call check(error)
  end subroutine print_out

  subroutine end_interrupted()
    write (error_unit, '(a)') 'gearsweep: interrupted; the tables have what was computed by then'
    call finish(code_stopped)
  end subroutine end_interrupted

  !> The place of the case: `-` is standard input.
  function place_of(word) result(path)
    character(*), intent(in) :: word
    character(:), allocatable :: path

    path = word
    if (word == '-') path = '/dev/stdin'
  end function place_of

  !> A word without a folder or an ending may be a command of the Python package that is misspelt.
  subroutine suggest_command(error)
    type(error_t), intent(inout) :: error
    character(5), parameter :: commands(*) = ['panel', 'many ']
    integer :: closest

    closest = closest_word(arguments%case, commands)
    if (closest > 0 .and. scan(arguments%case, './') == 0) error%message = error%message//' (did you mean the command '// &
      trim(commands(closest))//' of the Python package?)'
  end subroutine suggest_command

  !> File name without folder and ending.
  pure function stem(path) result(name)
    character(*), intent(in) :: path
    character(:), allocatable :: name

    name = path(len(folder_of(path)) + 1:)
    if (index(name, '.', back=.true.) > 1) name = name(:index(name, '.', back=.true.) - 1)
  end function stem

  logical function progress_wanted()
    progress_wanted = .false.
    if (.not. arguments%quiet) progress_wanted = c_isatty(2_c_int) == 1
  end function progress_wanted

  subroutine read_arguments(arguments)
    type(arguments_t), intent(out) :: arguments
    character(:), allocatable :: word
    logical :: ok, all_names                     ! behind --
    integer :: i

    all_names = .false.
    arguments%out = 'results'
    i = 0
    do while (i < command_argument_count())
      i = i + 1
      word = argument(i)
      if (all_names) then
        call take_case(word)
        cycle
      end if
      select case (word)
      case ('--')
        all_names = .true.
      case ('--help', '-h')
        call show_help_on(i + 1)
        call finish(code_ok)
      case ('--describe')
        call show_description(i + 1)
        call finish(code_ok)
      case ('--new')
        call show_new_case(i + 1)
        call finish(code_ok)
      case ('--version', '-v', '-V')
        call print_line('gearsweep '//version)
        call finish(code_ok)
      case ('--verbose')
        arguments%verbose = .true.
      case ('--quiet')
        arguments%quiet = .true.
      case ('--out')
        arguments%out = following(i, word)
      case ('--name')
        arguments%name = following(i, word)
        if (index(arguments%name, '/') > 0) call usage('--name: '//arguments%name//' must be a name without a folder')
      case ('--resume')
        call usage('--resume: '//resuming_is_gone)
      case ('--threads')
        call to_number(following(i, word), arguments%threads, ok)
        if (.not. ok .or. arguments%threads < 1 .or. arguments%threads > 1024) then
          call usage('--threads: must be an integer from 1 to 1024')
        end if
      case default
        if (word == '--report' .or. ((word == 'many' .or. word == 'panel') .and. i == 1)) call usage(word//' is of the Python '// &
          'package, whose command is called gearsweep too: python -m gearsweep; see README.md')
        if (index(word, '-') == 1 .and. len(word) > 1) call usage('unknown option '//word)
        call take_case(word)
      end select
    end do
    if (.not. allocated(arguments%case)) call usage('no case given')
    if (allocated(arguments%name)) return
    arguments%name = stem(arguments%case)
    if (arguments%case == '-') arguments%name = 'stdin'
  end subroutine read_arguments

  subroutine take_case(word)
    character(*), intent(in) :: word

    if (allocated(arguments%case)) call usage('one case at a time: '//arguments%case//' and '//word)
    if (len(word) == 0) call usage('the case has an empty name')
    arguments%case = word
  end subroutine take_case

  !> The word behind an option; steps over it.
  function following(i, option) result(word)
    integer, intent(inout) :: i
    character(*), intent(in) :: option
    character(:), allocatable :: word

    i = i + 1
    if (i > command_argument_count()) call usage(option//': a value must follow')
    word = argument(i)
    if (len(word) == 0) call usage(option//': the value is empty')
    if (index(word, '--') == 1) call usage(option//': a value must follow, not '//word)
  end function following

  function argument(i) result(word)
    integer, intent(in) :: i
    character(:), allocatable :: word
    integer :: length

    call get_command_argument(i, length=length)
    allocate (character(length) :: word)
    call get_command_argument(i, word)
  end function argument

  !> Help on what the arguments from `first` on name or mean; on the command line where there are none.
  subroutine show_help_on(first)
    integer, intent(in) :: first
    character(:), allocatable :: words
    type(error_t), allocatable :: unknown

    words = arguments_from(first)
    if (len(words) == 0 .or. index(words, '-') == 1) then
      call show_help()
      return
    end if
    call help_on(arguments_from(first), words, unknown)
    if (allocated(unknown)) call usage('--help: '//unknown%message)
    call print_out(words)
  end subroutine show_help_on

  subroutine show_description(first)
    integer, intent(in) :: first
    character(:), allocatable :: words
    type(error_t), allocatable :: unknown

    if (first > command_argument_count()) then
      call describe('all', words, unknown)
    else
      call describe(arguments_from(first), words, unknown)
    end if
    if (allocated(unknown)) call usage('--describe: '//unknown%message)
    call print_out(words)
  end subroutine show_description

  !> A case to begin with, for the tasks from argument `first` on.
  subroutine show_new_case(first)
    integer, intent(in) :: first
    integer, parameter :: longest = 63
    character(longest) :: tasks(max(0, command_argument_count() - first + 1))
    character(:), allocatable :: words
    type(error_t), allocatable :: unknown
    integer :: i

    do i = 1, size(tasks)
      tasks(i) = argument(first + i - 1)
    end do
    call write_new_case(tasks, words, unknown)
    if (allocated(unknown)) call usage('--new: '//unknown%message)
    call print_out(words)
  end subroutine show_new_case

  !> These arguments with a blank between them.
  function arguments_from(first) result(words)
    integer, intent(in) :: first
    character(:), allocatable :: words
    integer :: i

    words = ''
    do i = first, command_argument_count()
      words = words//argument(i)//' '
    end do
    words = trim(words)
  end function arguments_from

  subroutine show_help()
    call print_line( &
      'gearsweep '//version//': dynamic factor of a spur-gear pair over speed and tip relief'//lf// &
      lf// &
      'usage: gearsweep CASE.nml [options]      (- reads the case from standard input)'//lf// &
      lf// &
      '  --out FOLDER    where the tables go (results); missing folders are made'//lf// &
      '  --name NAME     how the tables are called (as the case; stdin for -)'//lf// &
      '  --threads N     threads of the sweep (all); the answer is the same for any number'//lf// &
      '  --verbose       also list the stages that ran and what was omitted'//lf// &
      '  --quiet         print errors only'//lf// &
      '  --version, -v   print the version'//lf// &
      '  --help          print this'//lf// &
      '  --help WORD...  describe a task, a group, a key or GROUP KEY of a case, or search the descriptions'//lf// &
      '  --new TASK...   print a case for these tasks with every key, its default and its meaning'//lf// &
      '  --new --short TASK...  the same with the required and the common keys only'//lf// &
      '  --describe      print all tasks, groups and keys as JSON'//lf// &
      lf// &
      'exit code: 0 done, 1 unusable case, 2 unusable command line, 3 file or folder,'//lf// &
      '           4 some operating points have no answer, 5 a method failed, 6 memory,'//lf// &
      '           130 interrupted: the tables have what was computed by then'//lf// &
      'doc/case.md describes the case.')
  end subroutine show_help

  subroutine usage(message)
    character(*), intent(in) :: message

    call complain(message//'; gearsweep --help has more')
    call finish(code_usage)
  end subroutine usage

  !> Prints an error and ends with its code.
  subroutine check(error)
    type(error_t), allocatable, intent(in) :: error

    if (.not. allocated(error)) return
    if (made > 0) call remove_folder(arguments%out, made)
    call complain(error%message)
    call finish(error%code)
  end subroutine check

  !> Says what is wrong; where not even that can be said, the exit code does.
  subroutine complain(message)
    character(*), intent(in) :: message
    integer :: ignored

    write (error_unit, '(a)', iostat=ignored) 'gearsweep: '//visible(message)
    flush (error_unit, iostat=ignored)
  end subroutine complain

  subroutine finish(code)
    integer, intent(in) :: code
    integer :: ignored

    flush (error_unit, iostat=ignored)
    call c_exit(int(code, c_int))
  end subroutine finish
end program gearsweep_program
