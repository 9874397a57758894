!> A table as CSV text. Lines that begin with `#` carry version, meaning, the columns' units and meanings, and the case;
!> numbers have 15 significant digits.
module gearsweep_csv
  use gearsweep_error, only: error_t
  use gearsweep_kinds, only: dp
  use gearsweep_lines, only: bare, lines_t
  use gearsweep_memory, only: claim_memory
  use gearsweep_table, only: kind_integer, kind_text, table_t
  use gearsweep_version, only: version
  implicit none
  private
  public :: write_csv

  !> How every table begins.
  character(*), parameter, public :: csv_start = '# gearsweep '

contains

  !> `case_text`: the text of the case that the table belongs to. `error`: the memory does not hold the text.
  pure subroutine write_csv(table, case_text, text, error)
    type(table_t), intent(in) :: table
    character(*), intent(in) :: case_text
    character(:), allocatable, intent(out) :: text
    type(error_t), allocatable, intent(inout) :: error
    type(lines_t) :: lines
    integer :: i, k

    ! In room that doubles and is copied, then handed over once more.
    call claim_memory(5*(1e5_dp + table%text_bytes() + 3.0_dp*len(case_text)), 'the text of the table '//table%name, error)
    if (allocated(error)) return
    call add_introduction(table, case_text, lines)
    do i = 1, size(table%columns)
      call lines%cell(table%columns(i)%name)
    end do
    call lines%end_row()
    do i = 1, table%rows
      do k = 1, size(table%columns)
        associate (column => table%columns(k))
          select case (column%kind)
          case (kind_text)
            call lines%text_cell(trim(column%words(i)))
          case (kind_integer)
            call lines%cell(nint(column%numbers(i)))
          case default
            call lines%cell(column%numbers(i))
          end select
        end associate
      end do
      call lines%end_row()
    end do
    text = lines%text()
  end subroutine write_csv

  pure subroutine add_introduction(table, case_text, lines)
    type(table_t), intent(in) :: table
    character(*), intent(in) :: case_text
    type(lines_t), intent(inout) :: lines
    integer :: i, from, length

    call lines%add(csv_start//version//': '//table%meaning)
    call lines%add('# columns:')
    do i = 1, size(table%columns)
      associate (column => table%columns(i))
        call lines%put('#   '//column%name)
        if (column%unit /= '') call lines%put(' ('//column%unit//')')
        call lines%add(': '//column%meaning)
      end associate
    end do
    call lines%add('# case:')
    from = 1
    do while (from <= len(case_text))
      length = index(case_text(from:), new_line('a')) - 1
      if (length < 0) length = len(case_text) - from + 1
      call lines%add('#   '//bare(case_text(from:from + length - 1)))
      from = from + length + 1
    end do
  end subroutine add_introduction
end module gearsweep_csv
