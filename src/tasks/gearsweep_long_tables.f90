!> Long tables end on the screen after so many rows, and say how many there are beyond.
module gearsweep_long_tables
  use gearsweep_lines, only: lines_t
  use gearsweep_text, only: str
  implicit none
  private
  public :: most_rows, add_rest

  integer, parameter :: most_rows = 60

contains

  !> Says how many rows there are beyond `most_rows`, where there are.
  pure subroutine add_rest(rows, table, lines)
    integer, intent(in) :: rows                  !< in all
    character(*), intent(in) :: table            !< name of the table that has them all
    type(lines_t), intent(inout) :: lines

    if (rows > most_rows) call lines%add('   and '//str(rows - most_rows)//' more in the table '//trim(table))
  end subroutine add_rest
end module gearsweep_long_tables
