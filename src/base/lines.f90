!> A text that grows in linear time: lines for the screen, rows for tables.
module gearsweep_base_lines
  use gearsweep_base_kinds, only: dp
  use gearsweep_base_decimal, only: write_decimal
  use gearsweep_base_text, only: str
  use, intrinsic :: iso_fortran_env, only: int64
  implicit none
  private
  public :: lines_t, left, right

  type :: lines_t
    private
    character(:), allocatable :: buffer
    integer(int64) :: used = 0
  contains
    procedure :: put, add, add_wrapped, text
    !> Adds a field of a table's row: `call lines%cell(x)` for each field, then `call lines%end_row()`. Numbers have 15
    !> significant digits. `call lines%text_cell(words)` is for texts of users.
    generic :: cell => cell_word, cell_integer, cell_real, cell_reals
    procedure, private :: cell_word, cell_integer, cell_real, cell_reals
    procedure :: text_cell, end_row
    procedure :: json_text
  end type lines_t

contains

  !> Appends `words`.
  pure subroutine put(self, words)
    class(lines_t), intent(inout) :: self
    character(*), intent(in) :: words
    character(:), allocatable :: larger
    integer(int64) :: needed

    needed = self%used + len(words, int64)
    if (.not. allocated(self%buffer)) allocate (character(4096) :: self%buffer)
    if (needed > len(self%buffer, int64)) then
      allocate (character(2*needed) :: larger)
      larger(:self%used) = self%buffer(:self%used)
      call move_alloc(larger, self%buffer)
    end if
    self%buffer(self%used + 1:needed) = words
    self%used = needed
  end subroutine put

  !> Appends `line` and a line end.
  pure subroutine add(self, line)
    class(lines_t), intent(inout) :: self
    character(*), intent(in) :: line

    call self%put(line)
    call self%put(new_line('a'))
  end subroutine add

  !> Appends words as lines of at most 90 characters after `indent`, divided at blanks, beginning with a capital.
  pure subroutine add_wrapped(self, words, indent)
    class(lines_t), intent(inout) :: self
    character(*), intent(in) :: words, indent
    integer, parameter :: wide = 90
    character(:), allocatable :: rest
    integer :: at

    rest = words
    if (rest(1:1) >= 'a' .and. rest(1:1) <= 'z') rest(1:1) = achar(iachar(rest(1:1)) - 32)
    do while (len(rest) > wide)
      at = index(rest(:wide), ' ', back=.true.)
      if (at == 0) exit
      call self%add(indent//rest(:at - 1))
      rest = rest(at + 1:)
    end do
    call self%add(indent//rest)
  end subroutine add_wrapped

  pure subroutine cell_word(self, word)
    class(lines_t), intent(inout) :: self
    character(*), intent(in) :: word

    call self%put(word)
    call self%put(',')
  end subroutine cell_word

  pure subroutine cell_integer(self, n)
    class(lines_t), intent(inout) :: self
    integer, intent(in) :: n

    call self%cell_word(str(n))
  end subroutine cell_integer

  pure subroutine cell_real(self, x)
    class(lines_t), intent(inout) :: self
    real(dp), intent(in) :: x
    character(24) :: word
    integer :: length

    call write_decimal(x, 15, word, length)
    call self%cell_word(word(:length))
  end subroutine cell_real

  pure subroutine cell_reals(self, x)
    class(lines_t), intent(inout) :: self
    real(dp), intent(in) :: x(:)
    integer :: i

    do i = 1, size(x)
      call self%cell_real(x(i))
    end do
  end subroutine cell_reals

  !> Appends any text as CSV requires (RFC 4180): in quotation marks, doubled inside, if it has a comma, a mark or a line end. An
  !> apostrophe before text that a spreadsheet would treat as a formula makes it a text.
  pure subroutine text_cell(self, words)
    class(lines_t), intent(inout) :: self
    character(*), intent(in) :: words
    logical :: quoted, formula
    integer :: i

    ! A formula of a spreadsheet begins with one of these. A single sign, as for no unit, is none.
    formula = len_trim(words) > 1
    if (formula) formula = scan(words(max(1, verify(words, ' '//achar(9))):), '=+-@') == 1
    quoted = formula .or. scan(words, ',"'//achar(13)//new_line('a')) > 0
    if (.not. quoted) then
      call self%cell_word(words)
      return
    end if
    call self%put('"')
    if (formula) call self%put('''')
    do i = 1, len(words)
      call self%put(words(i:i))
      if (words(i:i) == '"') call self%put('"')
    end do
    call self%put('",')
  end subroutine text_cell

  !> Ends a row of at least one cell.
  pure subroutine end_row(self)
    class(lines_t), intent(inout) :: self

    self%buffer(self%used:self%used) = new_line('a')
  end subroutine end_row

  pure function text(self)
    class(lines_t), intent(in) :: self
    character(self%used) :: text

    if (self%used > 0) text = self%buffer(:self%used)
  end function text

  !> Text `words` at the right end of a column.
  pure function right(words, width) result(column)
    character(*), intent(in) :: words
    integer, intent(in) :: width
    character(max(width, len(words))) :: column

    column = adjustr(repeat(' ', max(0, width - len(words)))//words)
  end function right

  !> Text `words` at the left end of a column.
  pure function left(words, width) result(column)
    character(*), intent(in) :: words
    integer, intent(in) :: width
    character(max(width, len(words))) :: column

    column = words
  end function left

  !> Appends a text as JSON (RFC 8259): in quotation marks, with escapes for characters that are not allowed.
  pure subroutine json_text(self, words)
    class(lines_t), intent(inout) :: self
    character(*), intent(in) :: words
    character(*), parameter :: figures = '0123456789abcdef'
    integer :: i, code

    call self%put('"')
    do i = 1, len(words)
      code = iachar(words(i:i))
      if (words(i:i) == '"' .or. words(i:i) == '\') call self%put('\')
      if (code >= 32) then
        call self%put(words(i:i))
      else
        call self%put('\u00'//figures(code/16 + 1:code/16 + 1)//figures(modulo(code, 16) + 1:modulo(code, 16) + 1))
      end if
    end do
    call self%put('"')
  end subroutine json_text
end module gearsweep_base_lines
