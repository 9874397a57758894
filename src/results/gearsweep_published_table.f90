!> Printed values beside ours, as a table.
module gearsweep_published_table
  use gearsweep_error, only: error_t
  use gearsweep_kinds, only: dp
  use gearsweep_published, only: published_t
  use gearsweep_quantities, only: our_value
  use gearsweep_study, only: study_t
  use gearsweep_table, only: no_number, table_t
  implicit none
  private
  public :: published_table

contains

  !> Printed values beside ours; NaN where the tasks do not compute it.
  pure subroutine published_table(study, table, error)
    type(study_t), intent(in) :: study
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: ours(:)
    logical :: known
    integer :: i

    if (.not. allocated(study%published)) return
    associate (rows => study%published)
      call table%begin('printed values and ours', size(rows), 16, error)
      if (allocated(error)) return
      allocate (ours(size(rows)))
      do i = 1, size(rows)
        call our_value(study, rows(i)%quantity, ours(i), known)
        if (.not. known) ours(i) = no_number()
      end do
      call table%add_index('quantity', '', 'what is printed', words_of(rows, 'quantity'))
      call table%add_words('place', 'where it is printed', words_of(rows, 'place'))
      call table%add('printed', '', 'the printed value, in the unit of its row', [rows%printed])
      call table%add('ours', '', 'our value; NaN where the tasks do not compute it', ours)
      call table%add('deviation', '', 'ours over the printed value, less 1', ours/rows%printed - 1)
      call table%add_words('unit', 'of both values', words_of(rows, 'unit'))
      call table%add_words('status', 'of the inputs: stated, inferred, fitted or not reproducible', words_of(rows, 'status'))
      call table%add_words('reason', 'for the status', words_of(rows, 'reason'))
    end associate
  end subroutine published_table

  !> One field of all rows, padded to one length.
  pure function words_of(rows, field) result(words)
    type(published_t), intent(in) :: rows(:)
    character(*), intent(in) :: field
    character(:), allocatable :: words(:)
    integer :: i, longest

    longest = 1
    do i = 1, size(rows)
      longest = max(longest, len(word_of(rows(i), field)))
    end do
    allocate (character(longest) :: words(size(rows)))
    do i = 1, size(rows)
      words(i) = word_of(rows(i), field)
    end do
  end function words_of

  pure function word_of(row, field) result(word)
    type(published_t), intent(in) :: row
    character(*), intent(in) :: field
    character(:), allocatable :: word

    select case (field)
    case ('quantity')
      word = row%quantity
    case ('place')
      word = row%place
    case ('unit')
      word = row%unit
    case ('status')
      word = row%status
    case default
      word = row%reason
    end select
  end function word_of
end module gearsweep_published_table
