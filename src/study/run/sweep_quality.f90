!> Lines of the task `sweep` on the accuracy of its points, the number of failed ones, and speeds with several attracting motions.
module gearsweep_study_run_sweep_quality
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use gearsweep_base, only: dp, fixed, left, lines_t, str, table_t
  use gearsweep_motion, only: status_meaning, status_name, status_stopped
  implicit none
  private
  public :: add_motions, add_quality

contains

  !> Adds a line on speeds with several attracting motions, if these were searched.
  pure subroutine add_motions(sweep, lines)
    type(table_t), intent(in) :: sweep
    type(lines_t), intent(inout) :: lines
    real(dp), allocatable :: motions(:), largest(:)

    if (sweep%position('motions') == 0) return
    motions = sweep%numbers('motions')
    largest = sweep%numbers('largest_dynamic_factor')
    largest = pack(largest, .not. ieee_is_nan(largest))
    motions = pack(motions, .not. ieee_is_nan(motions))
    if (any(motions > 1)) call lines%add(left('', 19)//str(count(motions > 1))// &
      ' with several motions; the largest DF of those that a start reaches is '//fixed(maxval(largest), 4))
  end subroutine add_motions

  !> Adds lines on the accuracy of the points and on those that failed.
  pure subroutine add_quality(all_points, lines)
    type(table_t), intent(in) :: all_points      ! sweep_summary
    type(lines_t), intent(inout) :: lines
    integer :: status, n, failed

    failed = nint(all_points%number('points_without_answer'))
    call lines%put(left('Points', 19)//str(nint(all_points%number('points')))//', without an answer '//str(failed))
    if (.not. ieee_is_nan(all_points%number('largest_error_estimate'))) then
      call lines%put('; estimated error of DF at most '//str(all_points%number('largest_error_estimate'), 2)// &
                     ' (asked for '//str(all_points%number('tolerance'))//')')
    else if (failed < nint(all_points%number('points'))) then
      call lines%put('; the error of DF is not known, as breaks lie within equal steps')
    end if
    call lines%add('')
    do status = 1, status_stopped
      n = nint(all_points%number('points_'//status_name(status)))
      if (n > 0) call lines%add(left('', 19)//str(n)//' '//status_name(status)//': '//status_meaning(status))
    end do
    if (.not. ieee_is_nan(all_points%number('seen_dynamic_factor'))) call lines%add(left('', 19)//'"seen": DF is at least '// &
      fixed(all_points%number('seen_dynamic_factor'), 4)//' in a motion that does not repeat, watched for '// &
      str(nint(all_points%number('seen_periods')))//' mesh periods')
    n = nint(all_points%number('points_with_contact_loss'))
    if (n == 0) return
    call lines%add(left('', 19)//str(n)//' with loss of contact, where several motions may exist: direction = ''all'' and the '// &
                   'task attractors show them')
    if (all_points%position('points_with_two_motions') == 0) return
    n = nint(all_points%number('points_with_two_motions'))
    if (n > 0) call lines%add(left('', 19)//str(n)//' with another motion as the speed falls than as it rises: the '// &
                              'larger counts, "other" is the worst in the direction in which that is smaller')
  end subroutine add_quality
end module gearsweep_study_run_sweep_quality
