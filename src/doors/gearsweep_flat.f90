! The flat layer: external subroutines for Fortran 77 and whatever can call it; here those for the case
! as a whole, in gearsweep_flat_motion and gearsweep_flat_body those for single tasks.
!
! text            the case, as the program reads it; groups may follow each other on one line.
! folder          where files that the case names lie; blank: the current folder. Calls without it read
!                 them from the current folder, or need none of them where work is given.
! nwork, work     the pair stiffness from gs_prepare, for cases with the same gears, material,
!                 section and load; nwork = 0: each call finds it itself (work is not touched).
! threads         of the sweep; 0: all. The answer is the same for any number.
! info, message   0 and blank; else a code of gearsweep_error: 1 case or argument unusable (an
!                 array too small: the message says the size), 3 file or folder, 4 some operating points
!                 have no answer (NaN; all else is filled), 5 a method failed, 6 memory. But for 4,
!                 the results are as they were. A message that is too long is cut.
!
! A call runs one task, which the case must name among its tasks. Arrays belong to the caller; they
! may be larger than gs_sizes says, and what lies beyond is not touched. Units are those of the case
! and the tables. Nothing prints, stops or keeps state: any number of callers at once. While a call
! computes, OpenBLAS is kept to one thread; the number before comes back when the last call ends.
! gearsweep_calls has the interfaces for modern Fortran.

!> Sizes of the results, 0 for tasks that the case does not name. No finite elements run.
!>
!> speeds, reliefs  of the sweep                rows             of gs_mesh, over all reliefs
!> tried            most reliefs of gs_optimum  positions        of the load, gs_root
!> modes            of gs_modes                 nodes, elements  of the section's grid, gs_section
!> harmonics        of gs_harmonics             nwork            of gs_prepare
subroutine gs_sizes(text, folder, speeds, reliefs, rows, tried, positions, modes, nodes, elements, harmonics, &
                    nwork, info, message)
  use gearsweep_border, only: begin_call, in_folder, measure, open_case, tell, work_size
  use gearsweep_case, only: case_t, speed_count
  use gearsweep_error, only: error_t
  use gearsweep_optimum, only: most_tried
  use gearsweep_root_rating, only: load_positions
  use gearsweep_study, only: study_t
  implicit none
  character(*), intent(in) :: text, folder
  integer, intent(inout) :: speeds, reliefs, rows, tried, positions, modes, nodes, elements, harmonics, nwork
  integer, intent(out) :: info
  character(*), intent(out) :: message
  type(case_t) :: case
  type(study_t) :: study
  type(error_t), allocatable :: error
  integer :: i

  call begin_call()
  call open_case(text, 'all', 1, case, error)
  call measure(case, in_folder(folder), study, error)
  if (.not. allocated(error)) then
    speeds = 0
    rows = 0
    positions = 0
    nodes = 0
    elements = 0
    if (case%asks('sweep') .or. case%asks('optimum')) speeds = speed_count(case)
    reliefs = size(case%amount)
    tried = merge(most_tried, 0, case%asks('optimum'))
    if (case%asks('mesh')) rows = sum([(sum(study%sharing(i)%pairs), i=1, reliefs)])
    if (case%asks('static')) positions = size(load_positions(study%pair, case%root))
    modes = merge(case%modes, 0, case%asks('modal'))
    harmonics = merge(case%harmonics, 0, case%asks('mesh'))
    if (allocated(study%section)) then
      nodes = size(study%section%grid%x, 2)
      elements = size(study%section%grid%element, 2)
    end if
    nwork = work_size(study)
  end if
  call tell(error, info, message)
end subroutine gs_sizes

!> The pair stiffness, by finite elements where the case says so: the costly part of a mesh, kept in
!> work(nwork) for the calls below. It holds for cases that differ in reliefs, speeds, masses,
!> damping, friction, backlash or tasks.
subroutine gs_prepare(text, folder, nwork, work, info, message)
  use gearsweep_border, only: begin_call, in_folder, open_case, pack_stiffness, run_case, tell
  use gearsweep_case, only: case_t
  use gearsweep_error, only: error_t
  use gearsweep_study, only: study_t
  implicit none
  character(*), intent(in) :: text, folder
  integer, intent(in) :: nwork
  double precision, intent(inout) :: work(*)
  integer, intent(out) :: info
  character(*), intent(out) :: message
  type(case_t) :: case
  type(study_t) :: study
  type(error_t), allocatable :: error

  call begin_call()
  call open_case(text, 'motion', 1, case, error)
  call run_case(case, 0, work, 1, study, error, in_folder(folder))
  if (.not. allocated(error)) call pack_stiffness(study, nwork, work, error)
  call tell(error, info, message)
end subroutine gs_prepare

!> The whole answer as text, lines ended by char(10), as the program prints it: all tasks.
!>
!> length  of the answer; also where `answer` is too short for it (then info is 1 and `answer` as it
!>         was)
subroutine gs_report(text, folder, nwork, work, threads, answer, length, info, message)
  use gearsweep_border, only: begin_call, give_text, in_folder, open_case, run_case, tell
  use gearsweep_case, only: case_t
  use gearsweep_error, only: error_t
  use gearsweep_report, only: write_report
  use gearsweep_study, only: study_t
  implicit none
  character(*), intent(in) :: text, folder
  integer, intent(in) :: nwork, threads
  double precision, intent(in) :: work(*)
  character(*), intent(inout) :: answer
  integer, intent(inout) :: length
  integer, intent(out) :: info
  character(*), intent(out) :: message
  type(case_t) :: case
  type(study_t) :: study
  type(error_t), allocatable :: error
  character(:), allocatable :: words

  call begin_call()
  call open_case(text, 'all', threads, case, error)
  call run_case(case, nwork, work, threads, study, error, in_folder(folder))
  if (.not. allocated(error)) then
    call write_report(study, words)
    call give_text('answer', words, answer, length, error)
  end if
  call tell(error, info, message, study)
end subroutine gs_report

!> What the program does with a case: the answer, and its tables and grids as files; and all numbers of all
!> tasks, of which what several need is computed once.
!>
!> out              folder of the files, without a slash at its end; it is made if missing. Blank: only the
!>                  numbers are wanted, no files and no answer
!> name             of the files: name.sweep.csv and so on; without a folder and control characters
!> values(room)     the numbers, array after array; room = 0: they are not wanted
!> used             how many there are; also where room is too small for them (then values is as it was)
!> names            of the arrays, a line each, ended by char(10): as `sweep.dynamic_factor 327 5`, with its
!>                  shape; task and argument of the call for that task alone
!> answer, length   as from gs_report
!> stages           which ran and which were left out, a line each, for a curious reader
!> files            that were written, a line each, ended by char(10): all, or none where one cannot be written,
!>                  and then what was there before stays. Calls at once into one folder are served one after the
!>                  other. Tables of an earlier call with this name that this one has not get the ending `.old`
!>
!> The texts are cut where they are too long; `length` is that of the whole answer. They are filled also
!> where a file cannot be written.
subroutine gs_files(text, folder, nwork, work, threads, out, name, room, values, used, names, answer, length, stages, &
                    files, info, message)
  use gearsweep_old_calls, only: gs_all
  implicit none
  character(*), intent(in) :: text, folder, out, name
  integer, intent(in) :: nwork, threads, room
  double precision, intent(in) :: work(*)
  double precision, intent(inout) :: values(room)
  character(*), intent(inout) :: names, answer, stages, files
  integer, intent(inout) :: used, length
  integer, intent(out) :: info
  character(*), intent(out) :: message
  integer :: watch(3)

  watch = 0
  call gs_all(text, folder, nwork, work, threads, out, name, watch, '', '', room, values, used, names, answer, length, &
              stages, files, info, message)
end subroutine gs_files

!> The case with every key that it leaves to its default written out, lines ended by char(10). It gives
!> the same answer.
!>
!> length  of `complete`; also where that is too short for it (then info is 1 and `complete` as it was)
subroutine gs_complete(text, complete, length, info, message)
  use gearsweep_border, only: begin_call, give_text, tell
  use gearsweep_case_reader, only: complete_case
  use gearsweep_error, only: error_t
  implicit none
  character(*), intent(in) :: text
  character(*), intent(inout) :: complete
  integer, intent(inout) :: length
  integer, intent(out) :: info
  character(*), intent(out) :: message
  type(error_t), allocatable :: error
  character(:), allocatable :: words

  call begin_call()
  call complete_case(text, words, error)
  if (.not. allocated(error)) call give_text('complete', words, complete, length, error)
  call tell(error, info, message)
end subroutine gs_complete

!> The keys that a case gives but does not use, mostly for tasks that it does not name. They are read and
!> checked, but change nothing; the program's answer names them, too.
!>
!> unused  for each use that they would have, a line `use: &group key, key; &group key` ended by char(10)
!> length  of `unused`; also where that is too short for it (then info is 1 and `unused` as it was)
subroutine gs_unused(text, unused, length, info, message)
  use gearsweep_border, only: begin_call, give_text, open_case, tell
  use gearsweep_case, only: case_t
  use gearsweep_error, only: error_t
  implicit none
  character(*), intent(in) :: text
  character(*), intent(inout) :: unused
  integer, intent(inout) :: length
  integer, intent(out) :: info
  character(*), intent(out) :: message
  type(case_t) :: case
  type(error_t), allocatable :: error

  call begin_call()
  call open_case(text, 'all', 1, case, error)
  if (.not. allocated(error)) call give_text('unused', case%unused, unused, length, error)
  call tell(error, info, message)
end subroutine gs_unused

!> Sets one key of a case, and leaves the rest of the text as it is, with its remarks.
!>
!> group, key  without &; a group that is missing is added
!> value       as it stands in a case, such as 0, 5, 10 or 'fe'; blank: the key is taken out
!> length      of `changed`; also where that is too short for it (then info is 1 and `changed` as it was)
!>
!> A key that no case has is an error (info 1, with the closest key), unless it is taken out of a text that has it.
!> Whether this case allows the key and the value is told by the call that reads it.
subroutine gs_change(text, group, key, value, changed, length, info, message)
  use gearsweep_border, only: begin_call, give_text, tell
  use gearsweep_case_reader, only: check_key
  use gearsweep_edit, only: change_key
  use gearsweep_error, only: error_t
  implicit none
  character(*), intent(in) :: text, group, key, value
  character(*), intent(inout) :: changed
  integer, intent(inout) :: length
  integer, intent(out) :: info
  character(*), intent(out) :: message
  type(error_t), allocatable :: error
  character(:), allocatable :: words

  call begin_call()
  call change_key(text, trim(group), trim(key), trim(value), words, error)
  if (.not. allocated(error)) then
    if (len_trim(value) > 0 .or. words == text) call check_key(trim(group), trim(key), error)
  end if
  if (.not. allocated(error)) call give_text('changed', words, changed, length, error)
  call tell(error, info, message)
end subroutine gs_change
