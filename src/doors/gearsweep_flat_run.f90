! The flat layer: a whole run that can be watched, ended and gone on with. What the arguments are is told in
! gearsweep_flat.

!> As gs_files, and the caller may watch the run, end it, and go on from there.
!>
!> watch(1)  0; whoever sets it to another number while the call computes, a signal or another thread, ends the run
!>           soon: tables of what is done are written, operating points that are not computed have the status 9
!>           (stopped) and NaN, and info is 130
!> watch(2)  operating points done, as the call goes on; never fewer than before
!> watch(3)  of how many
!> resume    file that an interrupted run left: what was done by then is taken over, to the same bits. One of another
!>           version, or of a case that differs, is refused. Blank: begins anew
!> keep      file that is written where the run is interrupted, and removed where it is not; may be that of resume.
!>           Blank: none
subroutine gs_all(text, folder, nwork, work, threads, out, name, watch, resume, keep, room, values, used, names, answer, &
                  length, stages, files, info, message)
  use gearsweep_border, only: begin_call, in_folder, open_case, run_case, tell
  use gearsweep_case, only: case_t
  use gearsweep_checkpoint, only: drop_checkpoint, load_record, save_record
  use gearsweep_error, only: error_t
  use gearsweep_files, only: check_folder, check_name, make_folder, remove_folder
  use gearsweep_numbers, only: list_numbers, numbers_t
  use gearsweep_output, only: write_results
  use gearsweep_report, only: write_report
  use gearsweep_study, only: record_t, study_t
  implicit none
  character(*), intent(in) :: text, folder, out, name, resume, keep
  integer, intent(in) :: nwork, threads, room
  integer, intent(inout), target :: watch(3)
  double precision, intent(in) :: work(*)
  double precision, intent(inout) :: values(room)
  character(*), intent(inout) :: names, answer, stages, files
  integer, intent(inout) :: used, length
  integer, intent(out) :: info
  character(*), intent(out) :: message
  type(case_t) :: case
  type(study_t) :: study
  type(record_t), allocatable :: record        ! one that is not allocated counts as not passed
  type(numbers_t) :: numbers
  type(error_t), allocatable :: error
  character(:), allocatable :: words, written
  logical :: made

  call begin_call()
  made = .false.
  call open_case(text, 'all', threads, case, error)
  if (.not. allocated(error)) then
    ! Only the answer compares.
    if (out == '' .and. allocated(case%published)) deallocate (case%published)
    if (out /= '') then
      call check_folder(trim(out), error)
      call check_name(trim(name), error)
      if (.not. allocated(error)) call make_folder(trim(out), made, error)
    end if
  end if
  if (resume /= '' .or. keep /= '') allocate (record)
  if (.not. allocated(error) .and. resume /= '') call load_record(trim(resume), case, in_folder(folder), record, error)
  call run_case(case, nwork, work, threads, study, error, in_folder(folder), watch, record)
  if (.not. allocated(error)) then
    stages = study%log
    files = ''
  end if
  if (.not. allocated(error) .and. room > 0) then
    call list_numbers(study, numbers, error)
    if (.not. allocated(error)) then
      used = numbers%used
      names = numbers%names%text()
      if (used <= room) values(:used) = numbers%values(:used)
    end if
  end if
  if (.not. allocated(error) .and. out /= '') then
    call write_report(study, words)
    length = len(words)
    answer = words
    call write_results(study, trim(out), trim(name), written, error)
    files = written
  end if
  if (.not. allocated(error) .and. keep /= '') then
    if (study%stopped) call save_record(record, case, in_folder(folder), trim(keep), error)
    if (.not. study%stopped) call drop_checkpoint(trim(keep))
  end if
  if (allocated(error) .and. made) call remove_folder(trim(out))
  call tell(error, info, message, study)
end subroutine gs_all
