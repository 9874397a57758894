!> The answer for the screen: what the motion does, where it resonates and which relief is best.
module gearsweep_motion_report
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use gearsweep_kinds, only: dp
  use gearsweep_lines, only: left, lines_t, right
  use gearsweep_motion_tables, only: find_best, worst_near
  use gearsweep_optimum, only: peak_t, worst_of
  use gearsweep_status, only: has_result, status_meaning, status_name, status_stopped
  use gearsweep_study, only: study_t
  use gearsweep_text, only: fixed, str
  implicit none
  private
  public :: add_responses, add_sweep, add_optimum

  real(dp), parameter :: micro = 1e6_dp

contains

  pure subroutine add_responses(study, lines)
    type(study_t), intent(in) :: study
    type(lines_t), intent(inout) :: lines
    integer :: i, k

    call lines%add('')
    call lines%add('Dynamic factor at chosen speeds')
    call lines%add('   relief um         rpm        DF     error est.   status')
    do k = 1, size(study%response, 2)
      do i = 1, size(study%response, 1)
        associate (response => study%response(i, k), point => study%response(i, k)%point)
          call lines%put(right(str(micro*study%case%amount(i)), 12)//right(str(response%rpm), 12))
          if (has_result(point%steady%status)) then
            call lines%put(right(fixed(point%dynamic_factor, 4), 10)//right(str(point%estimate, 2), 15))
          else
            call lines%put(right('none', 10)//right('-', 15))
          end if
          call lines%add('   '//status_name(point%steady%status))
        end associate
      end do
    end do
  end subroutine add_responses

  pure subroutine add_sweep(study, lines)
    type(study_t), intent(in) :: study
    type(lines_t), intent(inout) :: lines
    integer :: k

    associate (rpm => study%sweep%rpm, resonance => study%resonance)
      call lines%add('')
      call lines%add('Dynamic factor over '//str(size(rpm))//' speeds, '//str(rpm(1))//' to '//str(rpm(size(rpm)))//' rpm')
      call lines%put('   relief um     worst    at rpm')
      if (size(resonance) > 0) then
        call lines%add('   in resonance at rpm (within 15 %)')
        call lines%put(repeat(' ', 32))
        do k = 1, size(resonance)
          call lines%put(right(str(anint(resonance(k)%rpm)), 10))
        end do
      end if
      call lines%add('')
    end associate
    call add_reliefs(study, lines)
    call add_quality(study, lines)
  end subroutine add_sweep

  !> A line for each relief, and which is the best.
  pure subroutine add_reliefs(study, lines)
    type(study_t), intent(in) :: study
    type(lines_t), intent(inout) :: lines
    type(peak_t) :: worst, best
    integer :: i, k, least

    associate (sweep => study%sweep, amount => study%case%amount)
      do i = 1, size(amount)
        worst = worst_of(sweep%rpm, sweep%dynamic_factor(:, i))
        call lines%put(right(str(micro*amount(i)), 12)//factor_of(worst))
        if (worst%rpm > 0) then
          call lines%put(right(str(worst%rpm), 10))
          do k = 1, size(study%resonance)
            call lines%put(factor_of(worst_near(sweep%rpm, sweep%dynamic_factor(:, i), study%resonance(k)%rpm)))
          end do
        end if
        call lines%add('')
      end do
      call find_best(study, least, best)
      if (least > 0 .and. size(amount) > 1) call lines%add(left('Best of the list', 19)//str(micro*amount(least))// &
        ' um: worst DF '//fixed(best%dynamic_factor, 4))
    end associate
  end subroutine add_reliefs

  !> Its dynamic factor, if there is any.
  pure character(10) function factor_of(peak)
    type(peak_t), intent(in) :: peak

    factor_of = right('none', 10)
    if (peak%rpm > 0) factor_of = right(fixed(peak%dynamic_factor, 4), 10)
  end function factor_of

  !> How exact, and what failed.
  pure subroutine add_quality(study, lines)
    type(study_t), intent(in) :: study
    type(lines_t), intent(inout) :: lines
    logical, allocatable :: known(:, :)
    integer :: status, n

    associate (sweep => study%sweep)
      n = count(.not. has_result(sweep%status))
      call lines%put(left('Points', 19)//str(size(sweep%status))//', without an answer '//str(n))
      known = has_result(sweep%status) .and. .not. ieee_is_nan(sweep%estimate)
      if (any(known)) then
        call lines%put('; estimated error of DF at most '//str(maxval(sweep%estimate, mask=known), 2)// &
                       ' (asked for '//str(study%case%accuracy%steady%tolerance)//')')
      else if (n < size(sweep%status)) then
        call lines%put('; the error of DF is not known, as breaks lie within equal steps')
      end if
      call lines%add('')
      do status = 1, status_stopped
        n = count(sweep%status == status)
        if (n > 0) call lines%add(left('', 19)//str(n)//' '//status_name(status)//': '//status_meaning(status))
      end do
      n = count(sweep%contact >= 2)
      if (n > 0) call lines%add(left('', 19)//str(n)//' with loss of contact')
    end associate
  end subroutine add_quality

  pure subroutine add_optimum(study, lines)
    type(study_t), intent(in) :: study
    type(lines_t), intent(inout) :: lines

    associate (optimum => study%optimum)
      if (optimum%best == 0) then
        call lines%add(left('Optimum relief', 19)//'none: no operating point has an answer')
        return
      end if
      call lines%add(left('Optimum relief', 19)//str(micro*optimum%amount(optimum%best), 4)//' um (within '// &
                     str(micro*optimum%resolution, 1)//'): worst DF '// &
                     fixed(optimum%dynamic_factor(optimum%best), 4)//' at '//str(optimum%rpm(optimum%best))//' rpm')
      if (optimum%best == size(optimum%amount)) call lines%add(left('', 19)// &
        'at the end of the range searched: more relief may be better still')
      if (optimum%failed(optimum%best) > 0) call lines%add(left('', 19)//str(optimum%failed(optimum%best))// &
                                                           ' speeds have no answer there')
    end associate
  end subroutine add_optimum
end module gearsweep_motion_report
