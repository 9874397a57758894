!> Report for the screen: the pair and the results of its tasks.
module gearsweep_study_results_report
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use gearsweep_base, only: dp, error_t, left, lines_t, right, str, table_t
  use gearsweep_study_results_motion_table, only: add_motion
  use gearsweep_study_results_results, only: published_table
  use gearsweep_study_run_study, only: study_t
  implicit none
  private
  public :: write_report, failed_points

contains

  !> Writes the report as text, the same in every run apart from the rounded run times of the task `precision`.
  pure subroutine write_report(study, text)
    type(study_t), intent(in) :: study
    character(:), allocatable, intent(out) :: text
    type(lines_t) :: lines
    integer :: i

    if (len(study%case%title) > 0) call lines%add(study%case%title)
    if (allocated(study%case%cautions)) call add_words('Caution', '', study%case%cautions, lines, .true.)
    do i = 1, size(study%tasks)
      if (study%tasks(i)%task%is_done) call study%tasks(i)%task%add_report(lines)
      ! Tasks after the first one (geometry) start from the mesh and its load.
      if (i == 1) call add_motion(study, lines)
    end do
    if (study%stopped) call lines%add(left('Interrupted', 19)//'what is missing above was not computed')
    if (allocated(study%published)) call add_published(study, lines)
    if (allocated(study%case%unused)) call add_words('Not used', 'for ', study%case%unused, lines, .false.)
    text = lines%text()
  end subroutine write_report

  !> Adds the notes on the case's keys, a line each, the first one or `each` with `name` in front of it.
  pure subroutine add_words(name, front, text, lines, each)
    character(*), intent(in) :: name, front, text
    type(lines_t), intent(inout) :: lines
    logical, intent(in) :: each
    integer :: from, until

    from = 1
    do while (from <= len(text))
      until = from + index(text(from:), new_line('a')) - 2
      call lines%put(left(merge(name, repeat(' ', len(name)), each .or. from == 1), 19))
      call lines%add(front//text(from:until))
      from = until + 2
    end do
  end subroutine add_words

  !> Adds printed and computed values, and below a row with a new status its reason.
  pure subroutine add_published(study, lines)
    type(study_t), intent(in) :: study
    type(lines_t), intent(inout) :: lines
    type(table_t) :: table
    type(error_t), allocatable :: error
    character(:), allocatable :: reason, before
    integer :: i

    before = ''
    table%name = 'published'
    call published_table(study, table, error)
    if (allocated(error)) return
    call lines%add('')
    call lines%add('Printed values and ours')
    call lines%add('   quantity                    place           printed        ours   deviation   status')
    do i = 1, table%rows
      call lines%put('   '//left(trim(table%word('quantity', i)), 28)//left(trim(table%word('place', i)), 12)// &
                     right(str(table%number('printed', i)), 11))
      if (ieee_is_nan(table%number('ours', i))) then
        call lines%add(right('-', 12)//right('-', 12)//'   not computed by these tasks')
      else
        call lines%add(right(str(table%number('ours', i)), 12)//right(trim(percent(table%number('deviation', i))), 12)// &
                       '   '//trim(table%word('status', i)))
      end if
      reason = study%published(i)%reason
      if (len(reason) > 0 .and. reason /= before) call lines%add_wrapped(reason//'.', '      ')
      before = reason
    end do
  end subroutine add_published

  !> Percentage with its sign.
  pure function percent(x) result(words)
    real(dp), intent(in) :: x
    character(24) :: words

    words = str(100*x, 3)//' %'
    if (x > 0) words = '+'//words
  end function percent

  !> Number of operating points without a converged result, over all tasks.
  pure integer function failed_points(study) result(n)
    type(study_t), intent(in) :: study
    integer :: i

    n = 0
    if (.not. allocated(study%tasks)) return
    do i = 1, size(study%tasks)
      n = n + study%tasks(i)%task%failed
    end do
  end function failed_points
end module gearsweep_study_results_report
