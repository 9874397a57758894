!> The caution beside all values of ISO 6336-3 for asymmetric teeth: a column of their tables, and a line on the screen.
module gearsweep_equal_flanks
  use gearsweep_gear, only: coast, drive
  use gearsweep_lines, only: lines_t
  use gearsweep_pair, only: pair_t
  use gearsweep_table, only: table_t
  implicit none
  private
  public :: add_equal_flanks, add_caution

  character(*), parameter :: column = 'equal_flanks'

contains

  !> Adds the column, the same in so many rows.
  pure subroutine add_equal_flanks(pair, rows, table)
    type(pair_t), intent(in) :: pair
    integer, intent(in) :: rows
    type(table_t), intent(inout) :: table

    associate (angle => pair%gear(1)%spec%pressure_angle)
      call table%add(column, '', '1 where both flanks have one pressure angle, as ISO 6336-3 means it, else 0', &
                     spread(merge(0, 1, abs(angle(coast) - angle(drive)) > 0), 1, rows))
    end associate
  end subroutine add_equal_flanks

  !> Adds the line where the flanks of a table are unequal.
  pure subroutine add_caution(table, lines)
    type(table_t), intent(in) :: table
    type(lines_t), intent(inout) :: lines

    if (.not. table%number(column, 1) > 0) &
      call lines%add('   ISO 6336-3 is made for equal flanks: here its section lies between the 30 degree tangents of unequal '// &
                     'ones, which nothing confirms')
  end subroutine add_caution
end module gearsweep_equal_flanks
