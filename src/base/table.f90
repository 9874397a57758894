!> Table of results: named columns with unit, meaning and values, in rows of equal length; its text as CSV.
!>
!> Every output (CSV, VTU, screen, Fortran, C, Python) reads tables in a loop and knows no result by its name.
!>
!> Numbers come in SI units and are converted to the unit of their column (`gearsweep_base_units`), as keys are when they are read.
!>
!>     call table%over('dynamic factor over speed and relief', error, axis('relief_um', 'um', 'tip relief', amount), &
!>                     axis('rpm', '1/min', 'speed of the pinion', rpm))
!>     if (allocated(error)) return
!>     call table%add('dynamic_factor', '', 'largest load of a pair over the static load', [dynamic_factor])
!>
!> In CSV, lines that begin with `#` carry version, meaning, the columns' units and meanings, and the case;
!> numbers have 15 significant digits.
module gearsweep_base_table
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan, ieee_quiet_nan, ieee_value
  use gearsweep_base_error, only: code_numerical, error_t, fail
  use gearsweep_base_kinds, only: dp
  use gearsweep_base_lines, only: left, lines_t, right
  use gearsweep_base_memory, only: claim_memory
  use gearsweep_base_text, only: fixed, lower, str, with_blanks
  use gearsweep_base_text_rows, only: find_lines, row_t
  use gearsweep_base_units, only: in_unit, is_unit
  use gearsweep_base_version, only: version
  implicit none
  private
  public :: column_t, table_t, axis, each, no_number, write_csv

  !> Kinds of the values of a column.
  integer, parameter, public :: kind_real = 1, kind_integer = 2, kind_text = 3

  !> Length of the result of `word`.
  integer, parameter :: word_length = 32

  type :: column_t
    character(:), allocatable :: name            !< full name with its unit: pair_load_n
    character(:), allocatable :: unit            !< such as N; empty for none
    character(:), allocatable :: meaning         !< a plain sentence or part of one
    integer :: kind = kind_real
    logical :: is_index = .false.                !< true: an input or place of the row; false: a result
    !> True if the same input always produces the same bits; measured times do not.
    logical :: is_reproducible = .true.
    real(dp), allocatable :: numbers(:)          !< of kind_real and kind_integer, one per row
    character(:), allocatable :: words(:)        !< of kind_text, one per row, padded with blanks
  end type column_t

  type :: table_t
    character(:), allocatable :: name
    character(:), allocatable :: meaning         !< meaning of its rows; not allocated: the study has no such table
    integer :: rows = 0
    type(column_t), allocatable :: columns(:)    !< columns, the index columns first
    !> Number of values of each index column, if the rows are all combinations of these values. The first varies slowest and the
    !> last fastest, as the indices of an array in C do. Otherwise not allocated.
    integer, allocatable :: extent(:)
    !> Name of the grid whose nodes or elements the rows are, in their order; with other indices, for each of their combinations.
    !> Otherwise empty.
    character(:), allocatable :: grid
    !> Error of a column for which memory is too small or whose unit is not in the list: it and later columns are missing, and the
    !> task fails at its end.
    type(error_t), allocatable :: error
  contains
    procedure :: begin, over, along
    procedure, private :: add_reals, add_integers
    !> Adds a column: `call table%add(name, unit, meaning, numbers)`, `numbers(rows)` of either kind, in SI units.
    generic :: add => add_reals, add_integers
    procedure :: add_index, add_copy
    procedure :: add_words
    procedure :: add_times
    procedure :: is_there
    procedure :: position
    procedure :: numbers
    procedure :: number
    procedure :: word
    procedure :: show
    procedure :: bytes
    procedure :: text_bytes
  end type table_t

  !> Axis for `over`: `axis(name, unit, meaning, values)` with an index column's different values, numbers in SI units or words.
  interface axis
    module procedure axis_of_reals, axis_of_integers, axis_of_words
  end interface axis

  !> Repeats each value several times before the next.
  interface each
    module procedure each_real, each_integer
  end interface each

  !> Number of columns whose memory is claimed before a table is filled, also for the arrays from which tasks fill them.
  integer, parameter :: columns_at_first = 8

  !> Start of every table.
  character(*), parameter, public :: csv_start = '# gearsweep '

contains

  !> Begins a table without columns. `error` if memory is too small for its rows. `extent` and `grid`: see the type.
  pure subroutine begin(self, meaning, rows, error, extent, grid)
    class(table_t), intent(inout) :: self
    character(*), intent(in) :: meaning
    integer, intent(in) :: rows
    type(error_t), allocatable, intent(inout) :: error
    integer, intent(in), optional :: extent(:)
    character(*), intent(in), optional :: grid

    if (.not. allocated(self%name)) self%name = ''
    ! Twice, as each column is copied once; words are longer than numbers.
    call claim_memory(16.0_dp*rows*(columns_at_first + 1), 'the table '//self%name, error)
    if (allocated(error)) return
    self%meaning = meaning
    self%rows = rows
    if (present(extent)) self%extent = extent
    self%grid = ''
    if (present(grid)) self%grid = grid
    allocate (self%columns(0))
  end subroutine begin

  !> Begins a table whose rows are all combinations of up to four axes' values, with these as its index columns.
  pure subroutine over(self, meaning, error, first, second, third, fourth, grid)
    class(table_t), intent(inout) :: self
    character(*), intent(in) :: meaning
    type(error_t), allocatable, intent(inout) :: error
    type(column_t), intent(in) :: first
    type(column_t), intent(in), optional :: second, third, fourth
    character(*), intent(in), optional :: grid
    integer :: extent(4), axes

    extent = 1
    extent(1) = length(first)
    if (present(second)) extent(2) = length(second)
    if (present(third)) extent(3) = length(third)
    if (present(fourth)) extent(4) = length(fourth)
    axes = 1 + count([present(second), present(third), present(fourth)])
    call self%begin(meaning, product(extent), error, extent(:axes), grid)
    if (allocated(error)) return
    call add_axis(self, first, places(self, 1))
    if (present(second)) call add_axis(self, second, places(self, 2))
    if (present(third)) call add_axis(self, third, places(self, 3))
    if (present(fourth)) call add_axis(self, fourth, places(self, 4))
  end subroutine over

  !> Index of this axis' value in each row; (row)
  pure function places(self, which) result(place)
    class(table_t), intent(in) :: self
    integer, intent(in) :: which
    integer :: place(self%rows), inner, row

    inner = product(self%extent(which + 1:))
    place = [(1 + modulo((row - 1)/inner, self%extent(which)), row=1, self%rows)]
  end function places

  !> Expands numbers that depend on one of the axes only, one for each of its values, to all rows; (row)
  pure function along(self, which, numbers) result(rows)
    class(table_t), intent(in) :: self
    integer, intent(in) :: which                 !< index of the axis
    real(dp), intent(in) :: numbers(:)
    real(dp) :: rows(self%rows)

    rows = numbers(places(self, which))
  end function along

  pure subroutine add_axis(self, axis, place)
    type(table_t), intent(inout) :: self
    type(column_t), intent(in) :: axis
    integer, intent(in) :: place(:)              !< index of the value in each row
    real(dp), allocatable :: numbers(:)
    integer :: row

    call add_column(self, axis%name, axis%unit, axis%meaning, axis%kind, is_index=.true.)
    if (allocated(self%error)) return
    associate (to => self%columns(size(self%columns)))
      if (axis%kind == kind_text) then
        ! gfortran 12 does not allow a vector subscript of such words.
        allocate (character(len(axis%words)) :: to%words(self%rows))
        do row = 1, self%rows
          to%words(row) = axis%words(place(row))
        end do
      else
        numbers = in_unit(axis%numbers, axis%unit)
        to%numbers = numbers(place)
      end if
    end associate
  end subroutine add_axis

  pure integer function length(column)
    type(column_t), intent(in) :: column

    if (column%kind == kind_text) then
      length = size(column%words)
    else
      length = size(column%numbers)
    end if
  end function length

  pure type(column_t) function axis_of_reals(name, unit, meaning, values) result(column)
    character(*), intent(in) :: name, unit, meaning
    real(dp), intent(in) :: values(:)

    column = head(name, unit, meaning, kind_real, .true.)
    column%numbers = values
  end function axis_of_reals

  pure type(column_t) function axis_of_integers(name, unit, meaning, values) result(column)
    character(*), intent(in) :: name, unit, meaning
    integer, intent(in) :: values(:)

    column = head(name, unit, meaning, kind_integer, .true.)
    column%numbers = real(values, dp)
  end function axis_of_integers

  pure type(column_t) function axis_of_words(name, unit, meaning, values) result(column)
    character(*), intent(in) :: name, unit, meaning, values(:)

    column = head(name, unit, meaning, kind_text, .true.)
    column%words = values
  end function axis_of_words

  !> Appends a column without values; sets the table's `error` if memory is too small for it or its unit is not in the list.
  pure subroutine add_column(self, name, unit, meaning, kind, is_index)
    class(table_t), intent(inout) :: self
    character(*), intent(in) :: name, unit, meaning
    integer, intent(in) :: kind
    logical, intent(in) :: is_index
    type(column_t), allocatable :: larger(:)
    integer :: i, n

    n = size(self%columns)
    if (.not. is_unit(unit)) call fail(self%error, code_numerical, 'the table '//self%name//': the unit '//unit//' of '//name// &
                                       ' is not in the list of units')
    if (n >= columns_at_first) call claim_memory(16.0_dp*self%rows, 'the table '//self%name, self%error)
    if (allocated(self%error)) return
    allocate (larger(n + 1))
    do i = 1, n
      call move_alloc(self%columns(i)%name, larger(i)%name)
      call move_alloc(self%columns(i)%unit, larger(i)%unit)
      call move_alloc(self%columns(i)%meaning, larger(i)%meaning)
      larger(i)%kind = self%columns(i)%kind
      larger(i)%is_index = self%columns(i)%is_index
      larger(i)%is_reproducible = self%columns(i)%is_reproducible
      call move_alloc(self%columns(i)%numbers, larger(i)%numbers)
      call move_alloc(self%columns(i)%words, larger(i)%words)
    end do
    larger(n + 1) = head(name, unit, meaning, kind, is_index)
    call move_alloc(larger, self%columns)
  end subroutine add_column

  !> Column without values.
  pure type(column_t) function head(name, unit, meaning, kind, is_index) result(column)
    character(*), intent(in) :: name, unit, meaning
    integer, intent(in) :: kind
    logical, intent(in) :: is_index

    column%name = name
    column%unit = unit
    column%meaning = meaning
    column%kind = kind
    column%is_index = is_index
  end function head

  pure subroutine add_reals(self, name, unit, meaning, numbers)
    class(table_t), intent(inout) :: self
    character(*), intent(in) :: name, unit, meaning
    real(dp), intent(in) :: numbers(:)

    call add_column(self, name, unit, meaning, kind_real, is_index=.false.)
    if (.not. allocated(self%error)) self%columns(size(self%columns))%numbers = in_unit(numbers, unit)
  end subroutine add_reals

  pure subroutine add_integers(self, name, unit, meaning, numbers)
    class(table_t), intent(inout) :: self
    character(*), intent(in) :: name, unit, meaning
    integer, intent(in) :: numbers(:)

    call add_column(self, name, unit, meaning, kind_integer, is_index=.false.)
    if (.not. allocated(self%error)) self%columns(size(self%columns))%numbers = real(numbers, dp)
  end subroutine add_integers

  !> Adds a column with name, unit and meaning of another one, whose `numbers(rows)` are in this unit already.
  pure subroutine add_copy(self, column, numbers)
    class(table_t), intent(inout) :: self
    type(column_t), intent(in) :: column
    real(dp), intent(in) :: numbers(:)

    call add_column(self, column%name, column%unit, column%meaning, kind_real, is_index=.false.)
    if (.not. allocated(self%error)) self%columns(size(self%columns))%numbers = numbers
  end subroutine add_copy

  !> Adds a column of `words(rows)`, without a unit.
  pure subroutine add_words(self, name, meaning, words)
    class(table_t), intent(inout) :: self
    character(*), intent(in) :: name, meaning, words(:)

    call add_column(self, name, '', meaning, kind_text, is_index=.false.)
    if (.not. allocated(self%error)) self%columns(size(self%columns))%words = words
  end subroutine add_words

  !> Adds a column of run times (s), `seconds(rows)`: they differ from run to run.
  pure subroutine add_times(self, name, meaning, seconds)
    class(table_t), intent(inout) :: self
    character(*), intent(in) :: name, meaning
    real(dp), intent(in) :: seconds(:)

    call add_column(self, name, 's', meaning, kind_real, is_index=.false.)
    if (.not. allocated(self%error)) self%columns(size(self%columns))%numbers = seconds
    if (.not. allocated(self%error)) self%columns(size(self%columns))%is_reproducible = .false.
  end subroutine add_times

  !> Adds an index column, one value per row.
  pure subroutine add_index(self, column)
    class(table_t), intent(inout) :: self
    type(column_t), intent(in) :: column         !< result of `axis`
    integer :: i

    call add_axis(self, column, [(i, i=1, self%rows)])
  end subroutine add_index

  !> True if the study has this table.
  pure logical function is_there(self)
    class(table_t), intent(in) :: self

    is_there = allocated(self%meaning)
  end function is_there

  !> Index of the column with this name; 0 if there is none.
  pure integer function position(self, name) result(at)
    class(table_t), intent(in) :: self
    character(*), intent(in) :: name

    do at = size(self%columns), 1, -1
      if (self%columns(at)%name == name) exit
    end do
  end function position

  !> Numbers of the column with this name, which the table must have unless memory was too small; (row)
  pure function numbers(self, name)
    class(table_t), intent(in) :: self
    character(*), intent(in) :: name
    real(dp), allocatable :: numbers(:)

    if (allocated(self%error)) then
      allocate (numbers(self%rows), source=no_number())
    else
      numbers = self%columns(self%position(name))%numbers
    end if
  end function numbers

  !> Number of the column with this name in a row, by default the first.
  pure real(dp) function number(self, name, row)
    class(table_t), intent(in) :: self
    character(*), intent(in) :: name
    integer, intent(in), optional :: row
    integer :: at

    at = 1
    if (present(row)) at = row
    number = self%columns(self%position(name))%numbers(at)
  end function number

  !> Word of the column with this name in a row; the table must have it.
  pure character(word_length) function word(self, name, row)
    class(table_t), intent(in) :: self
    character(*), intent(in) :: name
    integer, intent(in) :: row

    word = self%columns(self%position(name))%words(row)
  end function word

  !> Adds columns of the table to the screen, each below its name and unit. Columns that the table lacks or that have no number in
  !> any row shown are omitted; of a long table the first rows are shown.
  pure subroutine show(self, screen, columns)
    class(table_t), intent(in) :: self
    type(lines_t), intent(inout) :: screen
    character(*), intent(in) :: columns          !< names of the columns, a blank between two
    integer, parameter :: most = 60, line_length = 300
    character(line_length) :: line(-1:min(self%rows, most))  ! two for the names
    character(word_length) :: cells(-1:min(self%rows, most))
    integer :: first, last, at, row, used, width

    line = ''
    used = 0
    last = -1
    do while (last < len(columns))
      first = last + 2
      last = first + index(columns(first:)//' ', ' ') - 2
      at = self%position(columns(first:last))
      if (at == 0) cycle
      cells(0) = heading(self%columns(at))
      width = index(cells(0)(:len_trim(cells(0))/2 + 1), ' ', back=.true.)
      cells(-1) = cells(0)(:width)
      cells(0) = cells(0)(width + 1:)
      do row = 1, ubound(cells, 1)
        cells(row) = cell(self%columns(at), row)
      end do
      if (all(cells(1:) == '-')) cycle
      width = maxval(len_trim(cells))
      do row = -1, ubound(cells, 1)
        line(row)(used + 4:) = right(trim(cells(row)), width)
        if (self%columns(at)%kind == kind_text) line(row)(used + 4:) = left(cells(row), width)
      end do
      used = used + 3 + width
    end do
    if (used == 0) return
    do row = merge(0, -1, line(-1) == ''), ubound(line, 1)
      call screen%add(trim(line(row)))
    end do
    if (self%rows > most) call screen%add('   and '//str(self%rows - most)//' more in the table '//self%name)
  end subroutine show

  !> Name of a column in words, with its unit.
  pure character(word_length) function heading(column)
    type(column_t), intent(in) :: column
    character(9) :: suffix
    integer :: i

    heading = with_blanks(column%name)
    ! Names end in their units: relief_um, pinion_mean_nm.
    suffix = lower(column%unit)
    if (suffix == 'n m') suffix = 'nm'
    i = len_trim(heading) - len_trim(suffix)
    if (i > 1) then
      if (heading(i:) == ' '//suffix) heading(i + 1:) = column%unit
    end if
  end function heading

  !> Value of a column for the screen: of errors two digits, of factors four decimals, of other results five digits.
  pure character(word_length) function cell(column, row)
    type(column_t), intent(in) :: column
    integer, intent(in) :: row

    if (column%kind == kind_text) then
      cell = column%words(row)
    else if (ieee_is_nan(column%numbers(row))) then
      cell = '-'
    else if (column%kind == kind_integer) then
      cell = str(nint(column%numbers(row)))
    else if (column%is_index) then
      cell = str(column%numbers(row))
    else if (index(column%name, 'error_estimate') > 0 .or. column%name == 'residual') then
      cell = str(column%numbers(row), 2)
    else if (index(column%name, 'factor') > 0) then
      cell = fixed(column%numbers(row), 4)
    else
      cell = str(column%numbers(row), merge(6, 5, abs(column%numbers(row)) >= 1e5_dp))
    end if
  end function cell

  !> Memory of all values in bytes.
  pure real(dp) function bytes(self)
    class(table_t), intent(in) :: self
    integer :: i

    bytes = 0
    if (.not. allocated(self%columns)) return
    do i = 1, size(self%columns)
      bytes = bytes + 300 + 8.0_dp*self%rows
      if (self%columns(i)%kind == kind_text) bytes = bytes + real(len(self%columns(i)%words), dp)*self%rows
    end do
  end function bytes

  !> Upper bound of the length of all values as text, with separators.
  pure real(dp) function text_bytes(self) result(bytes)
    class(table_t), intent(in) :: self
    real(dp), parameter :: number = 24
    integer :: i

    bytes = 0
    do i = 1, size(self%columns)
      associate (column => self%columns(i))
        bytes = bytes + 100 + len(column%name) + len(column%unit) + len(column%meaning)
        if (column%kind /= kind_text) bytes = bytes + number*self%rows
        ! A word may have quotation marks, which are doubled.
        if (column%kind == kind_text) bytes = bytes + (2.0_dp*len(column%words) + 4)*self%rows
      end associate
    end do
  end function text_bytes

  !> Value without a result, NaN.
  pure real(dp) function no_number()
    no_number = ieee_value(1.0_dp, ieee_quiet_nan)
  end function no_number

  pure function each_real(values, times) result(rows)
    real(dp), intent(in) :: values(:)
    integer, intent(in) :: times
    real(dp) :: rows(size(values)*times)
    integer :: i

    do i = 1, size(values)
      rows((i - 1)*times + 1:i*times) = values(i)
    end do
  end function each_real

  pure function each_integer(values, times) result(rows)
    integer, intent(in) :: values(:), times
    integer :: rows(size(values)*times)

    rows = nint(each_real(real(values, dp), times))
  end function each_integer

  !> Writes the table as CSV. `case_text`: the text of the table's case. `error`: memory is too small for the text.
  pure subroutine write_csv(table, case_text, text, error)
    type(table_t), intent(in) :: table
    character(*), intent(in) :: case_text
    character(:), allocatable, intent(out) :: text
    type(error_t), allocatable, intent(inout) :: error
    type(lines_t) :: lines
    integer :: i, k
    type(row_t), allocatable :: rows(:)

    ! Memory of a buffer that doubles and is copied, and of its final copy.
    call claim_memory(5*(1e5_dp + table%text_bytes() + 3.0_dp*len(case_text)), 'the text of the table '//table%name, error)
    if (allocated(error)) return
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
    call find_lines(case_text, rows)
    do i = 1, size(rows)
      if (i < size(rows) .or. rows(i)%last >= rows(i)%first) call lines%add('#   '//case_text(rows(i)%first:rows(i)%last))
    end do
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
end module gearsweep_base_table
