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
      call add_field(table, rows, 'quantity', 'what is printed', is_index=.true.)
      call add_field(table, rows, 'place', 'where it is printed', is_index=.false.)
      call table%add('printed', '', 'the printed value, in the unit of its row', [rows%printed])
      call table%add('ours', '', 'our value; NaN where the tasks do not compute it', ours)
      call table%add('deviation', '', 'ours over the printed value, less 1', ours/rows%printed - 1)
      call add_field(table, rows, 'unit', 'of both values', is_index=.false.)
      call add_field(table, rows, 'status', 'of the inputs: stated, inferred, fitted or not reproducible', is_index=.false.)
      call add_field(table, rows, 'reason', 'for the status', is_index=.false.)
    end associate
  end subroutine published_table

  !> Adds one field of all rows; as an index where `is_index`. No function with a length of its own: callers at once would
  !> share that.
  pure subroutine add_field(table, rows, field, meaning, is_index)
    type(table_t), intent(inout) :: table
    type(published_t), intent(in) :: rows(:)
    character(*), intent(in) :: field, meaning
    logical, intent(in) :: is_index
    character(:), allocatable :: words(:), word
    integer :: i, longest

    longest = 1
    do i = 1, size(rows)
      call take_word(rows(i), field, word)
      longest = max(longest, len(word))
    end do
    allocate (character(longest) :: words(size(rows)))
    do i = 1, size(rows)
      call take_word(rows(i), field, word)
      words(i) = word
    end do
    if (is_index) call table%add_index(field, '', meaning, words)
    if (.not. is_index) call table%add_words(field, meaning, words)
  end subroutine add_field

  pure subroutine take_word(row, field, word)
    type(published_t), intent(in) :: row
    character(*), intent(in) :: field
    character(:), allocatable, intent(out) :: word

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
  end subroutine take_word
end module gearsweep_published_table
