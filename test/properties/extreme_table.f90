!> The table of stiff and extreme cases with what becomes of each, as Markdown;
!> test/properties/extreme/table.sh makes test/properties/extreme/table.md of it.
module test_properties_extreme_table
  use gearsweep_base_kinds, only: dp
  use gearsweep_base_text, only: str
  use test_properties_extreme_cases, only: row_t, read_cases, is_case, outcome_t, outcome_of, expected_value
  implicit none
  private
  public :: print_limits

contains

  subroutine print_limits()
    type(row_t), allocatable :: rows(:)
    type(outcome_t), allocatable :: outcomes(:)
    integer :: i

    call read_cases(rows)
    allocate (outcomes(size(rows)))
    do i = 1, size(rows)
      if (is_case(rows(i))) call outcome_of(rows(i), 1, outcomes(i))
    end do
    do i = 1, size(rows)
      if (is_case(rows(i))) then
        print '(a)', line_of(rows(i), outcomes(i), expected_value(rows(i), rows, outcomes%value))
      else
        print '(/a//a/a)', '## '//rows(i)%title, '| case | asked | what happens | estimate | off by | checked against |', &
          '|---|---|---|---|---|---|'
      end if
    end do
    i = maxloc(outcomes%seconds, 1)
    print '(/a)', str(count([(is_case(rows(i)), i=1, size(rows))]))//' cases. The longest, *'//rows(i)%title//'*, took '// &
      str(outcomes(i)%seconds, 2)//' s.'
  end subroutine print_limits

  function line_of(row, outcome, expected) result(line)
    type(row_t), intent(in) :: row
    type(outcome_t), intent(in) :: outcome
    real(dp), intent(in) :: expected
    character(:), allocatable :: line

    line = '| '//row%title//' | '//asked(row)//' | '
    if (allocated(outcome%message)) then
      line = line//'refused: `'//outcome%message//'` | | | '//row%origin//' |'
    else if (len(row%expected) == 0) then
      line = line//meaning(outcome%status)//' | | | '//row%origin//' |'
    else
      line = line//number_of(row, outcome)//' | '
      if (outcome%error > 0 .and. is_estimated(row%quantity)) line = line//str(outcome%error, 1)
      line = line//' | '//str(abs(outcome%value/expected - 1), 1)//' | '//source_of(row)//' |'
    end if
  end function line_of

  logical function is_estimated(quantity)
    character(*), intent(in) :: quantity

    is_estimated = any(quantity == [character(9) :: 'df', 'frequency', 'tension'])
  end function is_estimated

  !> What is changed in the base.
  function asked(row) result(text)
    type(row_t), intent(in) :: row
    character(:), allocatable :: text

    text = '`'//row%changes//'`'
    if (len(row%changes) == 0) text = 'nothing changed'
  end function asked

  !> The value with its unit and what the status adds.
  function number_of(row, outcome) result(text)
    type(row_t), intent(in) :: row
    type(outcome_t), intent(in) :: outcome
    character(:), allocatable :: text

    text = str(outcome%value, 9)
    select case (row%quantity)
    case ('df')
      text = 'DF '//text
    case ('multiplier')
      text = 'multiplier '//text
    case ('ratio')
      text = 'contact ratio '//text
    case ('stiffness')
      text = text//' N/um'
    case ('compliance')
      text = text//' um/N'
    case ('frequency')
      text = text//' Hz'
    case ('tension')
      text = text//' MPa'
    case default
      error stop 'extreme/cases.txt asks for an unknown quantity'
    end select
    if (outcome%status /= 'ok') text = text//', '//meaning(outcome%status)
  end function number_of

  function meaning(status) result(text)
    character(*), intent(in) :: status
    character(:), allocatable :: text

    text = '`'//status//'`'
    select case (status)
    case ('marginal')
      text = text//': disturbances do not die out'
    case ('subharmonic')
      text = text//': repeats after several mesh periods'
    case ('inexact')
      text = text//': the estimate exceeds the tolerance'
    case ('unstable')
      text = text//', no DF: the periodic motion repels'
    case ('aperiodic')
      text = text//', no DF: no periodic motion is reached'
    case ('unresolved')
      text = text//', no DF: more steps than allowed'
    case ('chatter')
      text = text//', no DF: contact opens and closes without end'
    case ('chaotic')
      text = text//', no DF: no periodic motion, disturbances grow'
    case ('transient')
      text = text//', no DF: the transient had not died away when the march ended'
    case ('unbounded')
      text = text//', no DF: no bound was seen'
    case default
      error stop 'a status that the table has no words for'
    end select
  end function meaning

  !> Where the expected value comes from, in words for the reader.
  function source_of(row) result(text)
    type(row_t), intent(in) :: row
    character(:), allocatable :: text

    text = row%origin
    if (index(row%expected, '=') == 1) text = '*'//trim(adjustl(row%expected(2:)))//'*: '//text
  end function source_of
end module test_properties_extreme_table
