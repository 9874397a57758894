!> Tables of numbers that a case names.
module gearsweep_table_file
  use gearsweep_kinds, only: dp
  use gearsweep_error, only: error_t, fail, code_input
  use gearsweep_files, only: read_text
  use gearsweep_text, only: str, to_number
  use gearsweep_text_rows, only: find_lines, row_t
  implicit none
  private
  public :: read_table

  character(*), parameter :: separators = ' ,;'//achar(9)//achar(13)

contains

  !> Two columns of numbers, separated by blanks, tabs, commas or semicolons;
  !> lines that begin with `#` or `!` are comments.
  subroutine read_table(path, first, second, error)
    character(*), intent(in) :: path
    real(dp), allocatable, intent(out) :: first(:), second(:)
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: text
    real(dp) :: numbers(2)
    logical :: ok, blank
    type(row_t), allocatable :: lines(:)
    integer :: i, rows

    call read_text(path, text, error)
    if (allocated(error)) return
    call find_lines(text, lines)
    allocate (first(size(lines)), second(size(lines)))
    rows = 0
    do i = 1, size(lines)
      call read_row(text(lines(i)%first:lines(i)%last), numbers, blank, ok)
      if (.not. ok) then
        call fail(error, code_input, path//' line '//str(i)//': must be two numbers')
        return
      end if
      if (blank) cycle
      rows = rows + 1
      first(rows) = numbers(1)
      second(rows) = numbers(2)
    end do
    first = first(:rows)
    second = second(:rows)
  end subroutine read_table

  !> Two numbers of a row, unless it is `blank` or a comment; `ok`: it is one of these.
  pure subroutine read_row(row, numbers, blank, ok)
    character(*), intent(in) :: row
    real(dp), intent(out) :: numbers(2)
    logical, intent(out) :: blank, ok
    integer :: from, length, i

    numbers = 0
    ok = .true.
    from = verify(row, separators)
    blank = from == 0
    if (.not. blank) blank = scan(row(from:from), '#!') == 1
    if (blank) return
    do i = 1, 2
      length = scan(row(from:)//' ', separators) - 1
      call to_number(row(from:from + length - 1), numbers(i), ok)
      if (.not. ok) return
      from = from + length
      length = verify(row(from:), separators) - 1
      if (length < 0) exit
      from = from + length
    end do
    ! Nothing may stand behind the second number, nor too little.
    ok = i == 2
  end subroutine read_row
end module gearsweep_table_file
