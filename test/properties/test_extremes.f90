!> Stiff and extreme cases: each ends in a right answer with its error, or in a
!> word that there is none and why, after a bounded number of steps. The table
!> test/properties/extreme/cases.txt says where each expected value comes from. Random ones
!> besides: of these only the end is known.
module test_extremes
  use gearsweep_base_kinds, only: dp
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use gearsweep_base_text, only: str
  use test_properties_extreme_cases, only: row_t, read_cases, is_case, outcome_t, outcome_of, same_bits, expected_value
  use test_properties_random_extremes, only: random_row
  use test_support_testing, only: tally_t, check_true, check_close, check_equal
  implicit none
  private
  public :: run

  !> Steps that one point may take; a second or so.
  real(dp), parameter :: most_work = 2e7_dp
  integer, parameter :: fewest = 60, draws = 100

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t
    type(row_t), allocatable :: rows(:)
    type(outcome_t), allocatable :: outcomes(:)
    type(outcome_t) :: again
    real(dp), allocatable :: values(:)
    logical, allocatable :: wanted(:)
    integer :: i

    call read_cases(rows)
    allocate (outcomes(size(rows)), wanted(size(rows)))
    do i = 1, size(rows)
      wanted(i) = is_case(rows(i))
      if (wanted(i)) wanted(i) = t%wants(rows(i)%title)
      if (.not. wanted(i)) cycle
      call outcome_of(rows(i), 1, outcomes(i))
      call outcome_of(rows(i), 2, again)
      call check_true(t, rows(i)%title//': same bits with two threads', same_bits(outcomes(i), again))
    end do
    values = outcomes%value
    do i = 1, size(rows)
      if (wanted(i)) call check_case(t, rows(i), outcomes(i), expected_value(rows(i), rows, values))
    end do
    if (t%wants('cases')) call check_true(t, 'cases', count([(is_case(rows(i)), i=1, size(rows))]) >= fewest)
    if (t%wants('random_cases')) call random_cases(t)
  end subroutine run

  !> An end within the work allowed: a number where the status says so, and only there. Most must have one.
  subroutine random_cases(t)
    type(tally_t), intent(inout) :: t
    type(row_t) :: row
    type(outcome_t) :: outcome
    logical :: answered
    integer :: i, answers

    answers = 0
    do i = 1, draws
      row = random_row(i)
      call outcome_of(row, 1, outcome)
      answered = any(outcome%status == [character(11) :: 'ok', 'marginal', 'subharmonic', 'inexact'])
      if (answered) answers = answers + 1
      call check_true(t, row%title//': number and status', answered .neqv. ieee_is_nan(outcome%value), &
                      outcome%status//', '//row%changes)
      call check_true(t, row%title//': work', outcome%work <= most_work, row%changes)
      call check_true(t, row%title//': accepted', .not. allocated(outcome%message), row%changes)
    end do
    call check_true(t, 'random cases with an answer', answers >= draws/2, str(answers))
  end subroutine random_cases

  subroutine check_case(t, row, outcome, expected)
    type(tally_t), intent(inout) :: t
    type(row_t), intent(in) :: row
    type(outcome_t), intent(in) :: outcome
    real(dp), intent(in) :: expected

    call check_equal(t, row%title//': status', outcome%status, row%status)
    call check_true(t, row%title//': work', outcome%work <= most_work, str(outcome%work))
    if (allocated(outcome%message)) then
      call check_true(t, row%title//': message', index(outcome%message, row%expected) > 0, outcome%message)
    else if (len(row%expected) == 0) then
      call check_true(t, row%title//': no number', ieee_is_nan(outcome%value))
    else
      call check_value(t, row, outcome, expected)
    end if
  end subroutine check_case

  !> Within twice the estimated error and what is known of the expected value; grids of the same
  !> fineness err alike, so that they compare by the latter only. In a batch and by itself the same.
  subroutine check_value(t, row, outcome, expected)
    type(tally_t), intent(inout) :: t
    type(row_t), intent(in) :: row
    type(outcome_t), intent(in) :: outcome
    real(dp), intent(in) :: expected
    real(dp) :: allowed

    allowed = row%within
    if (row%base == 'prescribed' .or. index(row%expected, '=') /= 1) allowed = allowed + 2*outcome%error
    call check_close(t, row%title, outcome%value, expected, allowed)
    if (outcome%alone > 0) call check_close(t, row%title//': alone', outcome%alone, outcome%value, &
                                            2*(outcome%error + outcome%alone_error) + 1e-13_dp)
  end subroutine check_value
end module test_extremes
