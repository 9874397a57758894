!> Stiff and extreme cases: each ends in a right answer with its error, or in a
!> word that there is none and why, after a bounded number of steps. The table
!> test/extreme/cases.txt says where each expected value comes from; `print_limits`
!> makes doc/limits.md of it.
module test_extremes
  use gearsweep_kinds, only: dp
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use gearsweep_text, only: str
  use extreme_cases, only: row_t, read_cases, is_case, outcome_t, outcome_of, expected_value
  use testing, only: tally_t, check_true, check_close, check_equal
  implicit none
  private
  public :: run, print_limits

  !> Steps that one point may take; a second or so.
  real(dp), parameter :: most_work = 2e7_dp
  integer, parameter :: fewest = 60

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t
    type(row_t), allocatable :: rows(:)
    type(outcome_t), allocatable :: outcomes(:)
    integer :: i

    call read_cases(rows)
    call run_all(rows, outcomes)
    do i = 1, size(rows)
      if (.not. is_case(rows(i))) cycle
      call check_equal(t, rows(i)%title//': status', outcomes(i)%status, rows(i)%status)
      call check_true(t, rows(i)%title//': work', outcomes(i)%work <= most_work, str(outcomes(i)%work))
      if (allocated(outcomes(i)%message)) then
        call check_true(t, rows(i)%title//': message', index(outcomes(i)%message, rows(i)%expected) > 0, outcomes(i)%message)
      else if (len(rows(i)%expected) == 0) then
        call check_true(t, rows(i)%title//': no number', rows(i)%quantity /= 'df' .or. ieee_is_nan(outcomes(i)%value))
      else
        call check_value(t, rows(i), outcomes(i), expected_value(rows(i), rows, outcomes%value))
      end if
    end do
    call check_true(t, 'cases', count([(is_case(rows(i)), i=1, size(rows))]) >= fewest)
  end subroutine run

  subroutine run_all(rows, outcomes)
    type(row_t), intent(in) :: rows(:)
    type(outcome_t), allocatable, intent(out) :: outcomes(:)
    integer :: i

    allocate (outcomes(size(rows)))
    do i = 1, size(rows)
      if (is_case(rows(i))) call outcome_of(rows(i), outcomes(i))
    end do
  end subroutine run_all

  !> Within what is known of the expected value and twice the estimated error; by
  !> lanes and by itself the same.
  subroutine check_value(t, row, outcome, expected)
    type(tally_t), intent(inout) :: t
    type(row_t), intent(in) :: row
    type(outcome_t), intent(in) :: outcome
    real(dp), intent(in) :: expected

    call check_close(t, row%title, outcome%value, expected, row%within + 2*outcome%error)
    if (outcome%alone > 0) call check_close(t, row%title//': alone', outcome%alone, outcome%value, &
                                            4*outcome%error + 1e-13_dp)
  end subroutine check_value

  !> The table of doc/limits.md, as Markdown.
  subroutine print_limits()
    type(row_t), allocatable :: rows(:)
    type(outcome_t), allocatable :: outcomes(:)
    integer :: i

    call read_cases(rows)
    call run_all(rows, outcomes)
    do i = 1, size(rows)
      if (is_case(rows(i))) then
        print '(a)', limit_line(rows(i), outcomes(i), expected_value(rows(i), rows, outcomes%value))
      else
        print '(/a//a/a)', '### '//rows(i)%title, '| case | changes | outcome | error estimate | expected | off by | from |', &
          '|---|---|---|---|---|---|---|'
      end if
    end do
  end subroutine print_limits

  function limit_line(row, outcome, expected) result(line)
    type(row_t), intent(in) :: row
    type(outcome_t), intent(in) :: outcome
    real(dp), intent(in) :: expected
    character(:), allocatable :: line

    line = '| '//row%title//' | `'//row%changes//'` | '
    if (allocated(outcome%message)) then
      line = line//'refused: '//outcome%message//' | | | | '//row%origin//' |'
    else if (len(row%expected) == 0) then
      line = line//outcome%status//' | | | | '//row%origin//' |'
    else
      line = line//str(outcome%value, 9)
      if (outcome%status /= 'ok') line = line//' '//outcome%status
      line = line//' | '//merge(str(outcome%error, 2)//repeat(' ', 9), '                  ', outcome%error > 0)
      line = trim(line)//' | '//str(expected, 9)//' | '//str(abs(outcome%value - expected)/abs(expected), 1)//' | '
      line = line//row%origin//' |'
    end if
  end function limit_line
end module test_extremes
