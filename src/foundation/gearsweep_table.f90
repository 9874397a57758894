!> A result as a table: named columns with unit, meaning and values, one below the other in rows of equal length.
!> Every exit (CSV, VTU, screen, Fortran, C, Python) reads tables in a loop and knows no result by its name.
!>
!>     call table%over('dynamic factor over speed and relief', error, axis('relief_um', 'um', 'tip relief', amount), &
!>                     axis('rpm', '1/min', 'speed of the pinion', rpm))
!>     if (allocated(error)) return
!>     call table%add('dynamic_factor', '', 'largest load of a pair over the static load', [dynamic_factor])
module gearsweep_table
  use gearsweep_error, only: error_t
  use gearsweep_kinds, only: dp
  use gearsweep_memory, only: claim_memory
  use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
  implicit none
  private
  public :: column_t, table_t, axis, each, no_number

  !> What the values of a column are.
  integer, parameter, public :: kind_real = 1, kind_integer = 2, kind_text = 3

  !> Of what `word` tells.
  integer, parameter :: word_length = 32

  type :: column_t
    character(:), allocatable :: name            !< in full, with its unit: pair_load_n
    character(:), allocatable :: unit            !< such as N; empty for none
    character(:), allocatable :: meaning         !< a plain sentence or part of one
    integer :: kind = kind_real
    logical :: is_index = .false.                !< it says where its row lies; the others say what is found there
    !> The same input gives the same bits. Times that were measured are not.
    logical :: is_reproducible = .true.
    real(dp), allocatable :: numbers(:)          !< of kind_real and kind_integer, one a row
    character(:), allocatable :: words(:)        !< of kind_text, one a row, padded with blanks
  end type column_t

  type :: table_t
    character(:), allocatable :: name
    character(:), allocatable :: meaning         !< what its rows are; not allocated: the study has no such table
    integer :: rows = 0
    type(column_t), allocatable :: columns(:)    !< the index columns stand first
    !> Where the rows are all combinations of the index columns' values, how many values each of these has. The first
    !> varies slowest and the last fastest, as the indices of an array in C do. Otherwise not allocated.
    integer, allocatable :: extent(:)
    !> Name of the grid whose nodes or elements the rows are, in their order; where there are other indices too, for
    !> each of their combinations. Otherwise empty.
    character(:), allocatable :: grid
    !> A column that the memory does not hold: it and those behind it are left out, and the task fails once it has run.
    type(error_t), allocatable :: error
  contains
    procedure :: begin, over, along
    procedure, private :: add_reals, add_integers
    !> `call table%add(name, unit, meaning, numbers)`, `numbers(rows)` of either kind.
    generic :: add => add_reals, add_integers
    procedure :: add_index
    procedure :: add_words
    procedure :: add_times
    procedure :: is_there
    procedure :: position
    procedure :: numbers
    procedure :: number
    procedure :: word
    procedure :: bytes
    procedure :: text_bytes
  end type table_t

  !> `axis(name, unit, meaning, values)`: an index column's different values, numbers or words, for `over`.
  interface axis
    module procedure axis_of_reals, axis_of_integers, axis_of_words
  end interface axis

  !> Each value so many times before the next.
  interface each
    module procedure each_real, each_integer
  end interface each

  !> Memory for so many columns is claimed before a table is filled, for the arrays that tasks fill them from too.
  integer, parameter :: columns_at_first = 8

contains

  !> Begins a table without columns. `error` where the memory does not hold so many rows. `extent` and `grid`: see the type.
  pure subroutine begin(self, meaning, rows, error, extent, grid)
    class(table_t), intent(inout) :: self
    character(*), intent(in) :: meaning
    integer, intent(in) :: rows
    type(error_t), allocatable, intent(inout) :: error
    integer, intent(in), optional :: extent(:)
    character(*), intent(in), optional :: grid

    if (.not. allocated(self%name)) self%name = ''
    ! Each column once more as it is made; words are longer than numbers.
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

  !> Which value of this axis each row has; (row)
  pure function places(self, which) result(place)
    class(table_t), intent(in) :: self
    integer, intent(in) :: which
    integer :: place(self%rows), inner, row

    inner = product(self%extent(which + 1:))
    place = [(1 + modulo((row - 1)/inner, self%extent(which)), row=1, self%rows)]
  end function places

  !> Numbers that differ along one of the axes only, one for each of its values, for all rows; (row)
  pure function along(self, which, numbers) result(rows)
    class(table_t), intent(in) :: self
    integer, intent(in) :: which                 !< of the axes
    real(dp), intent(in) :: numbers(:)
    real(dp) :: rows(self%rows)

    rows = numbers(places(self, which))
  end function along

  pure subroutine add_axis(self, axis, place)
    type(table_t), intent(inout) :: self
    type(column_t), intent(in) :: axis
    integer, intent(in) :: place(:)              !< which of its values each row has
    integer :: row

    call add_column(self, axis%name, axis%unit, axis%meaning, axis%kind, is_index=.true.)
    if (allocated(self%error)) return
    associate (to => self%columns(size(self%columns)))
      if (axis%kind == kind_text) then
        ! gfortran 12 takes no list of places of such words.
        allocate (character(len(axis%words)) :: to%words(self%rows))
        do row = 1, self%rows
          to%words(row) = axis%words(place(row))
        end do
      else
        to%numbers = axis%numbers(place)
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

  !> Appends a column without values; `error` of the table where the memory does not hold one more.
  pure subroutine add_column(self, name, unit, meaning, kind, is_index)
    class(table_t), intent(inout) :: self
    character(*), intent(in) :: name, unit, meaning
    integer, intent(in) :: kind
    logical, intent(in) :: is_index
    type(column_t), allocatable :: larger(:)
    integer :: i, n

    n = size(self%columns)
    if (n >= columns_at_first) call claim_memory(16.0_dp*self%rows, 'the table '//self%name, self%error)
    if (allocated(self%error)) return
    allocate (larger(n + 1))
    do i = 1, n
      call move_column(self%columns(i), larger(i))
    end do
    larger(n + 1) = head(name, unit, meaning, kind, is_index)
    call move_alloc(larger, self%columns)
  end subroutine add_column

  !> A column without values.
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

  !> Without a copy of its values.
  pure subroutine move_column(from, to)
    type(column_t), intent(inout) :: from
    type(column_t), intent(out) :: to

    call move_alloc(from%name, to%name)
    call move_alloc(from%unit, to%unit)
    call move_alloc(from%meaning, to%meaning)
    to%kind = from%kind
    to%is_index = from%is_index
    to%is_reproducible = from%is_reproducible
    call move_alloc(from%numbers, to%numbers)
    call move_alloc(from%words, to%words)
  end subroutine move_column

  pure subroutine add_reals(self, name, unit, meaning, numbers)
    class(table_t), intent(inout) :: self
    character(*), intent(in) :: name, unit, meaning
    real(dp), intent(in) :: numbers(:)

    call add_column(self, name, unit, meaning, kind_real, is_index=.false.)
    if (.not. allocated(self%error)) self%columns(size(self%columns))%numbers = numbers
  end subroutine add_reals

  pure subroutine add_integers(self, name, unit, meaning, numbers)
    class(table_t), intent(inout) :: self
    character(*), intent(in) :: name, unit, meaning
    integer, intent(in) :: numbers(:)

    call add_column(self, name, unit, meaning, kind_integer, is_index=.false.)
    if (.not. allocated(self%error)) self%columns(size(self%columns))%numbers = real(numbers, dp)
  end subroutine add_integers

  !> `words(rows)`; they have no unit.
  pure subroutine add_words(self, name, meaning, words)
    class(table_t), intent(inout) :: self
    character(*), intent(in) :: name, meaning, words(:)

    call add_column(self, name, '', meaning, kind_text, is_index=.false.)
    if (.not. allocated(self%error)) self%columns(size(self%columns))%words = words
  end subroutine add_words

  !> Run times (s), `seconds(rows)`: they differ from run to run.
  pure subroutine add_times(self, name, meaning, seconds)
    class(table_t), intent(inout) :: self
    character(*), intent(in) :: name, meaning
    real(dp), intent(in) :: seconds(:)

    call add_column(self, name, 's', meaning, kind_real, is_index=.false.)
    if (.not. allocated(self%error)) self%columns(size(self%columns))%numbers = seconds
    if (.not. allocated(self%error)) self%columns(size(self%columns))%is_reproducible = .false.
  end subroutine add_times

  !> An index column, one value a row.
  pure subroutine add_index(self, column)
    class(table_t), intent(inout) :: self
    type(column_t), intent(in) :: column         !< of `axis`
    integer :: i

    call add_axis(self, column, [(i, i=1, self%rows)])
  end subroutine add_index

  !> Does the study that was asked have this table?
  pure logical function is_there(self)
    class(table_t), intent(in) :: self

    is_there = allocated(self%meaning)
  end function is_there

  !> Of the column with this name; 0 where there is none.
  pure integer function position(self, name) result(at)
    class(table_t), intent(in) :: self
    character(*), intent(in) :: name

    do at = size(self%columns), 1, -1
      if (self%columns(at)%name == name) exit
    end do
  end function position

  !> The numbers of the column with this name, which the table must have unless the memory did not hold it; (row)
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

  !> One of them, of the first row or another.
  pure real(dp) function number(self, name, row)
    class(table_t), intent(in) :: self
    character(*), intent(in) :: name
    integer, intent(in), optional :: row
    integer :: at

    at = 1
    if (present(row)) at = row
    number = self%columns(self%position(name))%numbers(at)
  end function number

  !> The word in a row of the column with this name, which the table must have.
  pure character(word_length) function word(self, name, row)
    class(table_t), intent(in) :: self
    character(*), intent(in) :: name
    integer, intent(in) :: row

    word = self%columns(self%position(name))%words(row)
  end function word

  !> What all values take in memory.
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

  !> Length of all values as text, at most, with what separates them.
  pure real(dp) function text_bytes(self) result(bytes)
    class(table_t), intent(in) :: self
    real(dp), parameter :: number = 24
    integer :: i

    bytes = 0
    do i = 1, size(self%columns)
      associate (column => self%columns(i))
        bytes = bytes + 100 + len(column%name) + len(column%unit) + len(column%meaning)
        if (column%kind /= kind_text) bytes = bytes + number*self%rows
        ! A word may be one that quotation marks are doubled in.
        if (column%kind == kind_text) bytes = bytes + (2.0_dp*len(column%words) + 4)*self%rows
      end associate
    end do
  end function text_bytes

  !> What stands where there is no result.
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
end module gearsweep_table
