!> A text that grows line by line in linear time.
module gearsweep_lines
  use gearsweep_kinds, only: dp
  use gearsweep_text, only: str
  use, intrinsic :: iso_fortran_env, only: int64
  implicit none
  private
  public :: lines_t, bare, field, left, right

  type :: lines_t
    private
    character(:), allocatable :: buffer
    integer(int64) :: used = 0
  contains
    procedure :: add
    procedure :: text
  end type lines_t

  !> A table field: integers plain, reals with 15 significant digits.
  interface field
    module procedure field_real, field_integer
  end interface field

contains

  !> Appends `line` and a line end.
  pure subroutine add(self, line)
    class(lines_t), intent(inout) :: self
    character(*), intent(in) :: line
    character(:), allocatable :: larger
    integer(int64) :: needed

    needed = self%used + len(line, int64) + 1
    if (.not. allocated(self%buffer)) allocate (character(4096) :: self%buffer)
    if (needed > len(self%buffer, int64)) then
      allocate (character(2*needed) :: larger)
      larger(:self%used) = self%buffer(:self%used)
      call move_alloc(larger, self%buffer)
    end if
    self%buffer(self%used + 1:needed) = line//new_line('a')
    self%used = needed
  end subroutine add

  pure function text(self)
    class(lines_t), intent(in) :: self
    character(:), allocatable :: text

    text = ''
    if (self%used > 0) text = self%buffer(:self%used)
  end function text

  !> Without the carriage return that some editors leave.
  pure function bare(line)
    character(*), intent(in) :: line
    character(:), allocatable :: bare
    integer :: length

    length = len(line)
    if (length > 0) then
      if (line(length:) == achar(13)) length = length - 1
    end if
    bare = line(:length)
  end function bare

  !> `words` at the right end of a column.
  pure function right(words, width) result(column)
    character(*), intent(in) :: words
    integer, intent(in) :: width
    character(max(width, len(words))) :: column

    column = adjustr(repeat(' ', max(0, width - len(words)))//words)
  end function right

  !> `words` at the left end of a column.
  pure function left(words, width) result(column)
    character(*), intent(in) :: words
    integer, intent(in) :: width
    character(max(width, len(words))) :: column

    column = words
  end function left

  pure function field_real(x) result(word)
    real(dp), intent(in) :: x
    character(:), allocatable :: word
    character(24) :: buffer

    write (buffer, '(es23.14e3)') x
    word = trim(adjustl(buffer))
  end function field_real

  pure function field_integer(n) result(word)
    integer, intent(in) :: n
    character(:), allocatable :: word

    word = str(n)
  end function field_integer
end module gearsweep_lines
