!> Long tables end on the screen after so many rows, and say how many there are beyond.
module gearsweep_long_tables
  use gearsweep_lines, only: lines_t
  use gearsweep_table, only: table_t
  use gearsweep_text, only: str
  implicit none
  private
  public :: most_rows, add_rest

  integer, parameter :: most_rows = 60

contains

  !> Says how many rows there are beyond `most_rows`, where there are.
  pure subroutine add_rest(table, lines)
    type(table_t), intent(in) :: table
    type(lines_t), intent(inout) :: lines

    if (table%rows > most_rows) call lines%add('   and '//str(table%rows - most_rows)//' more in the table '//table%name)
  end subroutine add_rest
end module gearsweep_long_tables
