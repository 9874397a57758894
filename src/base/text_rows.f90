!> The lines of a text, and the reader of all tables: rows of fields from spreadsheets, data frames and editors.
!>
!> Fields are separated by semicolons, commas, tabs or blanks, whichever the first row has; two numbers per row may have a
!> different separator in each row. Unless the comma separates fields, it may be the decimal point. Lines end in LF, CRLF or CR.
!> Ignored are lines that begin with `#` or `!`, lines with only empty fields, empty fields at the end of a row, and the byte
!> order mark of spreadsheets. A field may be in quotation marks.
module gearsweep_base_text_rows
  use gearsweep_base_text, only: find_control, find_odd, join, lower, shown, str, to_number, utf8
  use gearsweep_base_error, only: code_input, error_t, fail
  use gearsweep_base_kinds, only: dp
  use gearsweep_base_lines, only: lines_t
  use gearsweep_base_memory, only: claim_memory
  implicit none
  private
  public :: row_t, rows_t, find_lines, find_rows

  !> Position of a line in a text.
  type :: row_t
    integer :: first = 1, last = 0               !< indices of its characters, without line end
    integer :: line = 0                          !< number of the line, from 1
  end type row_t

  !> Rows of a table below its header.
  type :: rows_t
    character(:), allocatable :: text, path
    character(:), allocatable :: header          !< names of the columns with commas; empty: two columns of numbers without names
    type(row_t), allocatable :: rows(:)
    character :: separator = ','                 !< separator of the first row; a blank: any number of blanks and tabs
    logical :: comma_is_decimal = .false.        !< no comma separates in the first row, though it has one or a semicolon
  contains
    procedure :: fields, number, whole_number, refuse, write_json
  end type rows_t

  character, parameter :: tab = achar(9), lf = achar(10), cr = achar(13), end_mark = achar(26)
  character(*), parameter :: blanks = ' '//tab, figures = '0123456789'

contains

  !> Number of lines of a text; one more than it has line ends.
  pure integer function count_lines(text) result(n)
    character(*), intent(in) :: text
    integer :: i

    n = 1
    do i = 1, len(text)
      if (ends_line(text, i)) n = n + 1
    end do
  end function count_lines

  !> True if a line ends with this character; CRLF ends at its LF.
  pure logical function ends_line(text, at)
    character(*), intent(in) :: text
    integer, intent(in) :: at

    ends_line = text(at:at) == lf .or. (text(at:at) == cr .and. text(min(at + 1, len(text)):min(at + 1, len(text))) /= lf)
  end function ends_line

  !> Finds all lines, without the end marks of some old programs.
  pure subroutine find_lines(text, lines)
    character(*), intent(in) :: text
    type(row_t), allocatable, intent(out) :: lines(:)
    integer :: from, i, at

    allocate (lines(count_lines(text)))
    from = 1
    i = 1
    do at = 1, len(text)
      if (.not. ends_line(text, at)) cycle
      lines(i) = row_t(from, at - 1, i)
      if (at > from .and. text(at:at) == lf) then
        if (text(at - 1:at - 1) == cr) lines(i)%last = at - 2
      end if
      from = at + 1
      i = i + 1
    end do
    lines(i) = row_t(from, len(text), i)
    do i = 1, size(lines)
      associate (line => lines(i))
        line%last = line%first - 1 + verify(text(line%first:line%last), end_mark, back=.true.)
      end associate
    end do
  end subroutine find_lines

  !> Finds the rows below the header. Fails if the first row is not the header, at a control character, and if memory is too
  !> small. With an empty `header` there are two columns of numbers, and a first row of two words is skipped. If any header is
  !> allowed, it remains the first row.
  subroutine find_rows(text, path, header, table, error)
    character(*), intent(in) :: text
    character(*), intent(in) :: path             !< path of the file, for messages
    character(*), intent(in) :: header           !< names of the columns with commas, in lower case; may be empty; `*` for any
    type(rows_t), intent(out) :: table
    type(error_t), allocatable, intent(inout) :: error
    character(*), parameter :: mark = achar(239)//achar(187)//achar(191)
    real(dp), parameter :: row_bytes = 64
    character(:), allocatable :: control
    integer :: line

    call find_control(text, line, control)
    if (line > 0) call fail(error, code_input, path//' line '//str(line)//': '//control)
    call claim_memory(row_bytes*count_lines(text) + 3.0_dp*len(text), path//': '//str(count_lines(text))//' lines', error)
    if (allocated(error)) return
    table%text = utf8(text)
    table%path = path
    table%header = header
    call find_lines(table%text, table%rows)
    if (index(table%text, mark) == 1) table%rows(1)%first = 1 + len(mark)
    table%rows = pack(table%rows, [(counts(table%text(table%rows(line)%first:table%rows(line)%last)), line=1, size(table%rows))])
    if (size(table%rows) > 0) then
      associate (first => table%rows(1))
        table%separator = separator_of(table%text(first%first:first%last), len(header) > 0)
        table%comma_is_decimal = table%separator == ';' .or. (table%separator /= ',' .and. &
                                                               index(table%text(first%first:first%last), ',') > 0)
      end associate
    end if
    if (header /= '*') call check_header(table, error)
  end subroutine find_rows

  !> True if this line is a row, and not empty.
  pure logical function counts(line)
    character(*), intent(in) :: line
    integer :: first

    first = verify(line, blanks)
    counts = first > 0
    if (counts) counts = scan(line(first:first), '#!') == 0 .and. verify(line, blanks//',;"') > 0
  end function counts

  pure character function separator_of(row, named) result(separator)
    character(*), intent(in) :: row
    logical, intent(in) :: named                 !< true: the first row has names
    integer :: first, last, at

    first = verify(row, blanks)
    last = verify(row, blanks, back=.true.)
    separator = ' '
    if (index(row, ';') > 0) then
      separator = ';'
    else if (named .and. index(row, ',') > 0) then
      separator = ','
    else if (named .and. index(row, tab) > 0) then
      separator = tab
    else if (index(row, ',') > 0) then
      separator = ','
      ! Between two numbers with blanks, these commas are decimal points.
      if (scan(row(first:last), blanks) == 0) return
      do at = first, last
        if (row(at:at) == ',' .and. scan(row(at - 1:min(at + 1, len(row))), blanks) > 0) return
      end do
      separator = ' '
    end if
  end function separator_of

  !> Checks the names of the columns, which must be those of `header`, and skips them; for two columns of numbers, any two words.
  subroutine check_header(table, error)
    type(rows_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    character(:), allocatable :: names(:)
    integer :: wanted, i
    logical :: ok

    if (size(table%rows) == 0) then
      if (len(table%header) > 0) call fail(error, code_input, table%path//': lacks the line '//table%header)
      return
    end if
    wanted = 1 + count([(table%header(i:i) == ',', i=1, len(table%header))])
    if (len(table%header) == 0) wanted = 2
    call table%fields(1, wanted, names, ok)
    if (len(table%header) == 0) then
      if (.not. ok .or. any(scan(names, figures) == 1) .or. any(scan(names, '+-.,') == 1)) return
    else
      if (ok) then
        do i = 1, wanted
          names(i) = lower(names(i))
        end do
        ok = join(names, ',') == table%header
      end if
      if (.not. ok) call table%refuse(1, shown(table%text(table%rows(1)%first:table%rows(1)%last))//': must be '//table%header, &
                                      error)
    end if
    table%rows = table%rows(2:)
  end subroutine check_header

  !> Splits a row into this many fields, without the blanks around them; further fields must be empty. With `open_end` the last
  !> extends to the end of the line, and fields may be missing.
  pure subroutine fields(self, i, wanted, found, ok, open_end)
    class(rows_t), intent(in) :: self
    integer, intent(in) :: i                     !< index of the row
    integer, intent(in) :: wanted
    character(:), allocatable, intent(out) :: found(:)
    logical, intent(out) :: ok                   !< true: the row has exactly these fields
    logical, intent(in), optional :: open_end
    character(:), allocatable :: word
    character :: separator
    integer :: from, n, first
    logical :: is_open

    is_open = .false.
    if (present(open_end)) is_open = open_end
    first = self%rows(i)%first
    associate (row => self%text(first:first - 1 + verify(self%text(first:self%rows(i)%last), blanks, back=.true.)))
      separator = self%separator
      ! Two numbers may have a different separator in each row, except commas that may be decimal points.
      if (len(self%header) == 0) separator = separator_of(row, .false.)
      if (separator == ',' .and. self%comma_is_decimal) separator = self%separator
      allocate (character(len(row)) :: found(wanted))
      found = ''
      ok = .true.
      n = 0
      from = verify(row, merge('  ', ' '//tab, self%separator == tab))
      do while (from <= len(row) + 1)
        n = n + 1
        call read_field(row, separator, is_open .and. n == wanted, from, word)
        if (n <= wanted) found(n) = word
        if (n > wanted .and. len(word) > 0) ok = .false.
      end do
      if (n < wanted .and. .not. is_open) ok = .false.
    end associate
  end subroutine fields

  !> Reads the field that begins at `from`, and moves `from` to the next one, or to one beyond the end if there is none.
  pure subroutine read_field(row, separator, to_end, from, word)
    character(*), intent(in) :: row
    character, intent(in) :: separator
    logical, intent(in) :: to_end                !< the field is the remainder, unless it is in quotation marks
    integer, intent(inout) :: from
    character(:), allocatable, intent(out) :: word
    character(2) :: ends
    integer :: first, until

    ends = separator
    if (separator == ' ') ends = blanks
    if (separator == tab) first = behind(row, from, ' ')
    if (separator /= tab) first = behind(row, from, blanks)
    call unquote(row(first:), word, until)
    ! After the closing mark the field must end, or the marks are part of it.
    if (until > 0) then
      until = first - 1 + until
      if (separator /= ' ') until = behind(row, until, ' ')
      if (until <= len(row) .and. scan(row(until:min(until, len(row))), ends) == 0) until = 0
    end if
    if (until == 0) then
      until = first - 1 + scan(row(first:), trim(ends))
      if (separator == ' ') until = first - 1 + scan(row(first:), blanks)
      if (until < first .or. to_end) until = len(row) + 1
      word = row(first:first - 1 + verify(row(first:until - 1), blanks, back=.true.))
    end if
    from = until + 1
    if (separator == ' ' .and. from <= len(row)) from = behind(row, from, blanks)
  end subroutine read_field

  !> First place from `at` on with none of these characters; one beyond the end if there is none.
  pure integer function behind(row, at, set)
    character(*), intent(in) :: row, set
    integer, intent(in) :: at

    behind = at - 1 + verify(row(at:), set)
    if (behind < at) behind = len(row) + 1
  end function behind

  !> Reads the words of a text that begins with a quotation mark, up to the next one; marks inside are doubled. `behind`: the
  !> place after the closing mark; 0 if there is none.
  pure subroutine unquote(text, word, behind)
    character(*), intent(in) :: text
    character(:), allocatable, intent(out) :: word
    integer, intent(out) :: behind
    integer :: at, n

    behind = 0
    if (index(text, '"') /= 1) return
    at = 2
    do
      n = index(text(at:), '"')
      if (n == 0) return
      at = at + n
      if (text(at:min(at, len(text))) /= '"') exit
      at = at + 1
    end do
    behind = at
    allocate (character(behind - 3) :: word)
    n = 0
    at = 2
    do while (at < behind - 1)
      n = n + 1
      word(n:n) = text(at:at)
      at = at + merge(2, 1, text(at:at) == '"')
    end do
    word = word(:n)
  end subroutine unquote

  !> Writes names and rows of a table with any header as JSON: `[[line, field, field ...], ...]`, the names first. Decimals have a
  !> point. Fails if a row has another number of fields.
  subroutine write_json(self, text, error)
    class(rows_t), intent(in) :: self
    character(:), allocatable, intent(out) :: text
    type(error_t), allocatable, intent(inout) :: error
    type(lines_t) :: lines
    integer :: columns, i

    columns = 0
    call lines%put('[')
    do i = 1, size(self%rows)
      if (i > 1) call lines%add(',')
      call lines%put('['//str(self%rows(i)%line))
      associate (row => self%text(self%rows(i)%first:self%rows(i)%last))
        if (i == 1) call put_fields(row(:verify(row, blanks//trim(self%separator), back=.true.)))
        if (i > 1) call put_fields(row)
      end associate
      if (allocated(error)) return
      call lines%put(']')
    end do
    call lines%put(']')
    text = lines%text()

  contains

    subroutine put_fields(row)
      character(*), intent(in) :: row
      character(:), allocatable :: word
      real(dp) :: value
      integer :: from, comma, n
      logical :: ok

      n = 0
      from = 1
      do while (from <= len(row) + 1)
        call read_field(row, self%separator, .false., from, word)
        n = n + 1
        if (i > 1 .and. n > columns .and. len(word) == 0) cycle
        call self%number(word, value, ok)
        comma = index(word, ',')
        if (ok .and. comma > 0) word(comma:comma) = '.'
        call lines%put(', ')
        call lines%json_text(word)
        if (i == 1) columns = n
        if (n > columns) exit
      end do
      if (n < columns .or. (n > columns .and. len(word) > 0)) call self%refuse(i, 'must have '//str(columns)// &
        ' fields, as the line of names has', error)
    end subroutine put_fields
  end subroutine write_json

  !> Converts a field to a number, whose decimal point may be a comma if no comma separates.
  pure subroutine number(self, field, value, ok)
    class(rows_t), intent(in) :: self
    character(*), intent(in) :: field
    real(dp), intent(out) :: value
    logical, intent(out) :: ok
    character(len_trim(field)) :: word
    integer :: comma

    word = field
    comma = index(word, ',')
    if (self%separator /= ',' .and. comma > 0 .and. scan(word, '.') == 0) word(comma:comma) = '.'
    call to_number(word, value, ok)
  end subroutine number

  !> Converts a field to an integer, which spreadsheets and data frames may write as `21.0`.
  pure subroutine whole_number(self, field, value, ok)
    class(rows_t), intent(in) :: self
    character(*), intent(in) :: field
    integer, intent(out) :: value
    logical, intent(out) :: ok
    real(dp) :: x

    value = 0
    call self%number(field, x, ok)
    if (ok) ok = abs(x) < 1e9_dp .and. abs(x - anint(x)) <= 0
    if (ok) value = nint(x)
  end subroutine whole_number

  !> Reports the error of a row, and whether a comma or a character of a text program may be the cause.
  subroutine refuse(self, i, why, error)
    class(rows_t), intent(in) :: self
    integer, intent(in) :: i
    character(*), intent(in) :: why
    type(error_t), allocatable, intent(inout) :: error
    character(:), allocatable :: hint
    integer :: at

    if (allocated(error)) return
    associate (row => self%text(self%rows(i)%first:self%rows(i)%last))
      call find_odd(row, hint, alike=.true.)
      if (len(hint) > 0) hint = '; '//hint
      do at = 2, len(row) - 1
        if (row(at:at) /= ',' .or. len(hint) > 0) cycle
        if (scan(row(at - 1:at - 1), figures) == 1 .and. scan(row(at + 1:at + 1), figures) == 1) &
          hint = '; decimals take a point, or a comma where semicolons or tabs separate'
      end do
    end associate
    call fail(error, code_input, self%path//' line '//str(self%rows(i)%line)//': '//why//hint)
  end subroutine refuse
end module gearsweep_base_text_rows
