!> The lines of a text, and the rows of one that has a header.
module gearsweep_text_rows
  use gearsweep_characters, only: find_control
  use gearsweep_error, only: code_input, error_t, fail
  use gearsweep_kinds, only: dp
  use gearsweep_lines, only: count_lines
  use gearsweep_memory, only: claim_memory
  use gearsweep_text, only: shown, str
  implicit none
  private
  public :: row_t, find_lines, find_rows

  !> Where a line stands in a text.
  type :: row_t
    integer :: first = 1, last = 0               !< its characters, without line end and carriage return
    integer :: line = 0                          !< its number, from 1
  end type row_t

contains

  !> All lines.
  pure subroutine find_lines(text, lines)
    character(*), intent(in) :: text
    type(row_t), allocatable, intent(out) :: lines(:)
    integer :: from, i, until

    allocate (lines(count_lines(text)))
    from = 1
    do i = 1, size(lines)
      until = from - 1 + index(text(from:), new_line('a'))
      if (until < from) until = len(text) + 1
      lines(i) = row_t(from, until - 1, i)
      if (until > from) then
        if (text(until - 1:until - 1) == achar(13)) lines(i)%last = until - 2
      end if
      from = until + 1
    end do
  end subroutine find_lines

  !> The lines below the header. Blank lines, and those that begin with `#`, do not count, nor blanks in the header and the mark of
  !> UTF-8 that spreadsheets put in front. Fails where the first line that counts is not the header, at a control character, and
  !> where memory lacks.
  subroutine find_rows(text, path, header, rows, error)
    character(*), intent(in) :: text
    character(*), intent(in) :: path             !< for messages
    character(*), intent(in) :: header
    type(row_t), allocatable, intent(out) :: rows(:)
    type(error_t), allocatable, intent(inout) :: error
    character(*), parameter :: mark = achar(239)//achar(187)//achar(191)
    real(dp), parameter :: row_bytes = 64
    character(:), allocatable :: control
    logical, allocatable :: counts(:)
    integer :: i, line

    call find_control(text, line, control)
    if (line > 0) call fail(error, code_input, path//' line '//str(line)//': '//control)
    call claim_memory(row_bytes*count_lines(text), path//': '//str(count_lines(text))//' lines', error)
    if (allocated(error)) return
    call find_lines(text, rows)
    if (index(text, mark) == 1) rows(1)%first = 1 + len(mark)
    allocate (counts(size(rows)))
    do i = 1, size(rows)
      associate (row => text(rows(i)%first:rows(i)%last))
        counts(i) = verify(row, ' '//achar(9)) > 0
        if (counts(i)) counts(i) = row(1:1) /= '#'
      end associate
    end do
    rows = pack(rows, counts)
    if (size(rows) == 0) then
      call fail(error, code_input, path//': lacks the line '//header)
      return
    end if
    associate (first => rows(1))
      if (without_blanks(text(first%first:first%last)) /= header) call fail(error, code_input, path//' line '// &
        str(first%line)//': '//shown(text(first%first:first%last))//': must be '//header)
    end associate
    rows = rows(2:)
  end subroutine find_rows

  pure function without_blanks(text) result(rest)
    character(*), intent(in) :: text
    character(len(text)) :: rest
    integer :: i, n

    rest = ''
    n = 0
    do i = 1, len(text)
      if (text(i:i) == ' ' .or. text(i:i) == achar(9)) cycle
      n = n + 1
      rest(n:n) = text(i:i)
    end do
  end function without_blanks
end module gearsweep_text_rows
