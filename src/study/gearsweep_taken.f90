!> What a resumed run takes over of the one that was interrupted.
module gearsweep_taken
  use, intrinsic :: iso_fortran_env, only: int64
  use gearsweep_case, only: case_t
  use gearsweep_products, only: record_t, study_t
  use gearsweep_stages, only: points_of
  use gearsweep_sweep_state, only: all_motions, both, counter_t, each, sweep_state_t, units_done
  use gearsweep_task, only: task_t
  use gearsweep_task_record, only: is_recorded
  use gearsweep_text, only: str
  implicit none
  private
  public :: taken_of, is_taken, has_begun, take_up, tell_taken

  character(*), parameter :: owners(2) = [character(7) :: 'sweep', 'optimum']

contains

  !> As `67 % of sweep, load, stability`, or `nothing`.
  function taken_of(record, case) result(words)
    type(record_t), intent(in) :: record
    type(case_t), intent(in) :: case
    character(800) :: words                      ! of fixed length, so that threads do not share it
    character(:), allocatable :: list
    integer :: i

    list = ''
    if (allocated(record%states(1)%points) .and. .not. recorded(owners(1))) &
      list = ', '//str(int(100*sum(units_of(record%states(:1), case))/parts_of(case)/size(record%states(1)%points)))//' % of sweep'
    if (any([(allocated(record%states(i)%points), i=2, size(record%states))]) .and. .not. recorded(owners(2))) &
      list = list//', a part of optimum'
    do i = 1, size(case%tasks)
      associate (slot => case%tasks(i))
        if (slot%is_wanted .and. recorded(slot%info%name)) list = list//', '//trim(slot%info%name)
      end associate
    end do
    if (len(list) == 0) list = ', nothing'
    words = list(3:)

  contains

    logical function recorded(name)
      character(*), intent(in) :: name
      integer :: k

      recorded = .false.
      if (.not. allocated(record%tasks)) return
      do k = 1, size(record%tasks)
        if (record%tasks(k)%info%name == name) recorded = is_recorded(record%tasks(k)%task)
      end do
    end function recorded
  end function taken_of

  !> Had the interrupted run done task number `i`?
  pure logical function is_taken(study, i)
    type(study_t), intent(in) :: study
    integer, intent(in) :: i

    is_taken = allocated(study%before)
    if (is_taken) is_taken = is_recorded(study%before(i)%task)
  end function is_taken

  !> Had it begun with the sweeps of task number `i`? What is there of them takes no time to be had again.
  logical function has_begun(study, i)
    type(study_t), intent(in) :: study
    integer, intent(in) :: i
    integer :: k

    has_begun = .false.
    if (.not. associated(study%running%states)) return
    do k = 1, size(study%running%states)
      if (allocated(study%running%states(k)%points)) &
        has_begun = has_begun .or. study%tasks(i)%info%name == owners(merge(1, 2, k == 1))
    end do
  end function has_begun

  !> Takes over what was done.
  subroutine take_up(before, task)
    class(task_t), intent(in) :: before
    class(task_t), intent(inout) :: task

    task%tables = before%tables
    task%failed = before%failed
    task%log = before%log
    task%is_done = .true.
  end subroutine take_up

  !> Counts the points of the tasks that were done, and tells them with those of the sweep that had begun. Within `optimum` nothing
  !> is told yet: it also counts points that no sweep of its own holds.
  subroutine tell_taken(study)
    type(study_t), intent(inout) :: study
    type(counter_t) :: counter
    integer :: i

    associate (running => study%running)
      do i = 1, size(study%tasks)
        associate (slot => study%tasks(i))
          if (slot%is_wanted .and. is_taken(study, i)) running%done = running%done + points_of(slot%task, study%stages_t)
        end associate
      end do
      counter = counter_t(parts=parts_of(study%case), before=running%done, total=running%all_points, &
                          watch=study%accuracy%steady%stop)
      if (associated(running%progress)) counter%progress => running%progress
      if (associated(running%states)) then
        if (any([(allocated(running%states(i)%points), i=2, size(running%states))])) return
        counter%units = sum(units_of(running%states(:1), study%case))
      end if
      if (counter%before + counter%units > 0) call counter%tell()
    end associate
  end subroutine tell_taken

  !> How many parts a point has in a sweep.
  pure integer function parts_of(case)
    type(case_t), intent(in) :: case

    parts_of = merge(3, 2, case%direction == both)
  end function parts_of

  !> How many parts of points of each sweep are done.
  function units_of(states, case) result(units)
    type(sweep_state_t), intent(in) :: states(:)
    type(case_t), intent(in) :: case
    integer(int64) :: units(size(states))
    integer :: i

    units = 0
    do i = 1, size(states)
      if (allocated(states(i)%points)) units(i) = units_done(states(i), merge(each, case%direction, case%direction == all_motions))
    end do
  end function units_of
end module gearsweep_taken
