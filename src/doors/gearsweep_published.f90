!> Printed values to set beside ours: a file names quantities, where they are
!> printed, how much, and whether they follow from the stated inputs.
module gearsweep_published
  use gearsweep_kinds, only: dp
  use gearsweep_error, only: error_t, fail, code_input
  use gearsweep_text, only: str, to_number
  implicit none
  private
  public :: published_t, read_published

  type :: published_t
    character(:), allocatable :: quantity, place, unit, status, reason
    real(dp) :: printed = 0
  end type published_t

  character(*), parameter :: header = 'quantity,place,printed,unit,status,reason'

contains

  !> Reads `text`: comment lines (#), the header, then a row a value; the reason
  !> is the rest of its line. `path` is for messages.
  subroutine read_published(path, text, rows, error)
    character(*), intent(in) :: path, text
    type(published_t), allocatable, intent(out) :: rows(:)
    type(error_t), allocatable, intent(out) :: error
    integer :: from, until, line
    logical :: begun

    allocate (rows(0))
    begun = .false.
    from = 1
    line = 0
    do while (from <= len(text))
      until = index(text(from:), new_line('a')) + from - 1
      if (until < from) until = len(text) + 1
      line = line + 1
      call take(trim(text(from:until - 1)))
      if (allocated(error)) return
      from = until + 1
    end do
    if (.not. begun) call fail(error, code_input, path//': lacks the line '//header)

  contains

    subroutine take(row)
      character(*), intent(in) :: row

      if (len(row) == 0) return
      if (row(1:1) == '#') return
      if (.not. begun) then
        begun = row == header
        if (.not. begun) call fail(error, code_input, path//' line '//str(line)//': must be '//header)
      else
        rows = [rows, row_of(row)]
      end if
    end subroutine take

    type(published_t) function row_of(row) result(entry)
      character(*), intent(in) :: row
      character(:), allocatable :: rest, number
      logical :: ok

      rest = row
      call cut(rest, entry%quantity)
      call cut(rest, entry%place)
      call cut(rest, number)
      call cut(rest, entry%unit)
      call cut(rest, entry%status)
      entry%reason = rest
      call to_number(number, entry%printed, ok)
      if (.not. ok) call fail(error, code_input, path//' line '//str(line)//': printed = '//number//': must be a number')
      if (all(entry%status /= [character(16) :: 'stated', 'inferred', 'not reproducible'])) &
        call fail(error, code_input, path//' line '//str(line)//': status = '//entry%status// &
        ': must be stated, inferred or not reproducible')
    end function row_of
  end subroutine read_published

  !> Takes the first field off a row.
  pure subroutine cut(rest, field)
    character(:), allocatable, intent(inout) :: rest
    character(:), allocatable, intent(out) :: field
    integer :: at

    at = index(rest, ',')
    if (at == 0) at = len(rest) + 1
    field = rest(:at - 1)
    rest = rest(min(at + 1, len(rest) + 1):)
  end subroutine cut
end module gearsweep_published
