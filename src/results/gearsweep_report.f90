!> The answer for the screen: what the pair is and what its tasks found.
module gearsweep_report
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use gearsweep_error, only: error_t
  use gearsweep_kinds, only: dp
  use gearsweep_lines, only: left, lines_t, right
  use gearsweep_motion_table, only: add_motion
  use gearsweep_published_table, only: published_table
  use gearsweep_study, only: study_t
  use gearsweep_table, only: table_t
  use gearsweep_text, only: str
  implicit none
  private
  public :: report, write_report, failed_points

contains

  !> The answer as text, without timings, so that it is the same in every run.
  pure function report(study) result(text)
    type(study_t), intent(in) :: study
    character(:), allocatable :: text

    call write_report(study, text)
  end function report

  !> The same for several callers at once.
  pure subroutine write_report(study, text)
    type(study_t), intent(in) :: study
    character(:), allocatable, intent(out) :: text
    type(lines_t) :: lines
    integer :: i

    if (len(study%case%title) > 0) call lines%add(study%case%title)
    do i = 1, size(study%tasks)
      if (study%tasks(i)%task%is_done) call study%tasks(i)%task%add_report(lines)
      ! All others go on from the mesh and its load.
      if (i == 1) call add_motion(study, lines)
    end do
    if (study%stopped) call lines%add(left('Interrupted', 19)//'what is missing above was not computed')
    if (allocated(study%published)) call add_published(study, lines)
    if (allocated(study%case%unused)) call add_unused(study, lines)
    text = lines%text()
  end subroutine write_report

  !> Keys that the case gives but does not use.
  pure subroutine add_unused(study, lines)
    type(study_t), intent(in) :: study
    type(lines_t), intent(inout) :: lines
    integer :: from, until

    associate (text => study%case%unused)
      from = 1
      do while (from <= len(text))
        until = from + index(text(from:), new_line('a')) - 2
        call lines%add(left(merge('Not used', '        ', from == 1), 19)//'for '//text(from:until))
        from = until + 2
      end do
    end associate
  end subroutine add_unused

  !> Printed values beside ours.
  pure subroutine add_published(study, lines)
    type(study_t), intent(in) :: study
    type(lines_t), intent(inout) :: lines
    type(table_t) :: table
    type(error_t), allocatable :: error
    integer :: i

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
    end do
  end subroutine add_published

  !> With its sign.
  pure function percent(x) result(words)
    real(dp), intent(in) :: x
    character(24) :: words

    words = str(100*x, 3)//' %'
    if (x > 0) words = '+'//words
  end function percent

  !> Operating points without an answer, of all tasks.
  pure integer function failed_points(study) result(n)
    type(study_t), intent(in) :: study
    integer :: i

    n = 0
    if (.not. allocated(study%tasks)) return
    do i = 1, size(study%tasks)
      n = n + study%tasks(i)%task%failed
    end do
  end function failed_points
end module gearsweep_report
