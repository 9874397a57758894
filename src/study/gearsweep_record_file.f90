!> A file of words of 64 bits, as a checkpoint is: written in pieces, shown whole or not at all, and read once its sum is right.
!>
!> It begins with a line of text of `opening_length` characters, and ends with a sum over all before it: against accidents, not
!> against intent.
module gearsweep_record_file
  use, intrinsic :: iso_c_binding, only: c_int, c_null_char
  use, intrinsic :: iso_fortran_env, only: int64
  use gearsweep_error, only: error_t
  use gearsweep_file_set, only: file_set_t
  use gearsweep_files, only: fail_system
  use gearsweep_system, only: close_file, open_file, read_file
  implicit none
  private
  public :: record_writer_t, record_reader_t, sum_of_text, words_of_text

  integer, parameter, public :: opening_length = 128
  integer, parameter :: piece = 2**16            ! words that are written or read at once
  integer, parameter :: bytes = 8                ! of a word

  !> `call writer%begin(path, opening, error)`, then `put` and `put_text` as often as wanted, and `call writer%finish(error)`: the
  !> first failure is told there.
  type :: record_writer_t
    private
    type(file_set_t) :: files
    type(error_t), allocatable :: failure
    integer(int64), allocatable :: buffer(:)
    integer :: used = 0
    integer(int64) :: sums(2) = 0
  contains
    procedure :: begin => begin_writing
    procedure :: put, put_text
    procedure :: finish => finish_writing
  end type record_writer_t

  !> `call reader%begin(path, opening, error)`, then `call reader%look_through(path, error)`: `is_good` tells whether the file is
  !> whole. Then `take` and `take_text` what was put; `is_good` falls where there is less. `call reader%finish()` in any case.
  type :: record_reader_t
    logical :: is_good = .false.
    integer(int64) :: words = 0                  !< between the first line and the sum
    integer(c_int), private :: file = -1
    integer(int64), private, allocatable :: buffer(:)
    integer, private :: at = 0, there = 0
  contains
    procedure :: begin => begin_reading
    procedure :: look_through, take, take_text
    procedure :: finish => finish_reading
    procedure, private :: next_piece
  end type record_reader_t

contains

  !> A file that is there under this name and does not have the same `opening` is somebody's, and gets the ending `.old`.
  subroutine begin_writing(self, path, opening, error)
    class(record_writer_t), intent(inout) :: self
    character(*), intent(in) :: path, opening
    type(error_t), allocatable, intent(inout) :: error
    character(:), allocatable :: folder
    character(opening_length) :: line

    if (allocated(error)) return
    ! Not by folder_of: callers at once would share the length of its result.
    folder = path(:index(path, '/', back=.true.))
    line = opening
    line(opening_length:) = new_line('a')
    call self%files%begin(folder//'.', error)
    call self%files%add(path(len(folder) + 1:), opening//' ', '', error)
    if (allocated(error)) then
      call self%files%leave()
      return
    end if
    allocate (self%buffer(piece))
    call self%put(transfer(line, [0_int64]))
  end subroutine begin_writing

  subroutine put(self, words)
    class(record_writer_t), intent(inout) :: self
    integer(int64), intent(in) :: words(:)
    integer :: done, more

    done = 0
    do while (done < size(words))
      more = min(size(words) - done, piece - self%used)
      self%buffer(self%used + 1:self%used + more) = words(done + 1:done + more)
      self%used = self%used + more
      done = done + more
      if (self%used == piece) call flush_words(self)
    end do
  end subroutine put

  !> Its length, and its letters in words.
  subroutine put_text(self, text)
    class(record_writer_t), intent(inout) :: self
    character(*), intent(in) :: text

    call self%put([len(text, int64)])
    call self%put(words_of_text(text))
  end subroutine put_text

  subroutine flush_words(self)
    class(record_writer_t), intent(inout) :: self
    character(:), allocatable :: text

    allocate (character(bytes*self%used) :: text)
    call add_to_sums(self%buffer(:self%used), self%sums)
    text = transfer(self%buffer(:self%used), text)
    call self%files%append(text, self%failure)
    self%used = 0
  end subroutine flush_words

  !> The file appears under its name where nothing failed; else the first failure is told.
  subroutine finish_writing(self, error)
    class(record_writer_t), intent(inout) :: self
    type(error_t), allocatable, intent(inout) :: error

    if (.not. allocated(error)) then
      call flush_words(self)
      call self%put([sum_of(self%sums)])
      call flush_words(self)
      if (allocated(self%failure)) call move_alloc(self%failure, error)
    end if
    call self%files%finish(error)
  end subroutine finish_writing

  !> Opens a regular file, waiting for nothing; `opening` is its first line, or what there is of it.
  subroutine begin_reading(self, path, opening, error)
    class(record_reader_t), intent(inout) :: self
    character(*), intent(in) :: path
    character(opening_length), intent(out) :: opening
    type(error_t), allocatable, intent(inout) :: error
    integer(int64) :: line(opening_length/bytes)

    opening = ''
    if (allocated(error)) return
    self%file = open_file(path//c_null_char, 0_c_int)
    if (self%file < 0) then
      call fail_system('cannot read '//path, self%file, error)
      return
    end if
    if (.not. allocated(self%buffer)) allocate (self%buffer(piece))
    self%is_good = .true.
    self%at = 0
    self%there = 0
    line = 0
    call self%take(line)
    ! Of one that was cut within a word.
    if (.not. self%is_good) line(:min(self%there, size(line))) = self%buffer(:min(self%there, size(line)))
    opening = transfer(line, opening)
  end subroutine begin_reading

  !> Reads the file to its end. Where its sum is right, it is begun anew, behind its first line; else it is not good.
  subroutine look_through(self, path, error)
    class(record_reader_t), intent(inout) :: self
    character(*), intent(in) :: path
    type(error_t), allocatable, intent(inout) :: error
    integer(int64) :: sums(2), last, there
    character(opening_length) :: opening

    sums = 0
    there = 0
    ! What was read for the opening is still in the buffer.
    do while (self%is_good .and. self%there > 0)
      if (there > 0) call add_to_sums([last], sums)
      call add_to_sums(self%buffer(:self%there - 1), sums)
      last = self%buffer(self%there)
      there = there + self%there
      call self%next_piece()
    end do
    call self%finish()
    self%words = there - opening_length/bytes - 1
    self%is_good = self%is_good .and. self%words >= 0
    if (self%is_good) self%is_good = last == sum_of(sums)
    if (self%is_good) call self%begin(path, opening, error)
  end subroutine look_through

  !> The next words; those that are missing stay as they are.
  subroutine take(self, words)
    class(record_reader_t), intent(inout) :: self
    integer(int64), intent(inout) :: words(:)
    integer :: done, more

    done = 0
    do while (self%is_good .and. done < size(words))
      if (self%at == self%there) call self%next_piece()
      self%is_good = self%is_good .and. self%there > 0
      if (.not. self%is_good) return
      more = min(size(words) - done, self%there - self%at)
      words(done + 1:done + more) = self%buffer(self%at + 1:self%at + more)
      self%at = self%at + more
      done = done + more
    end do
  end subroutine take

  subroutine take_text(self, text)
    class(record_reader_t), intent(inout) :: self
    character(:), allocatable, intent(out) :: text
    integer(int64) :: length(1)
    integer(int64), allocatable :: words(:)

    length = 0
    call self%take(length)
    self%is_good = self%is_good .and. length(1) >= 0 .and. length(1)/bytes <= self%words
    text = ''
    if (.not. self%is_good) return
    allocate (words((length(1) + bytes - 1)/bytes))
    call self%take(words)
    if (.not. self%is_good) return
    deallocate (text)
    allocate (character(length(1)) :: text)
    text = transfer(words, text)
  end subroutine take_text

  !> None where the file ends; not good where it ends within a word, or cannot be read.
  subroutine next_piece(self)
    class(record_reader_t), intent(inout) :: self
    character(:), allocatable :: text
    integer :: used
    integer(c_int) :: n

    allocate (character(bytes*piece) :: text)
    used = 0
    do while (used < len(text))
      n = read_file(self%file, text(used + 1:), int(len(text) - used, c_int))
      if (n <= 0) exit
      used = used + n
    end do
    self%at = 0
    self%there = used/bytes
    self%is_good = n >= 0 .and. modulo(used, bytes) == 0
    self%buffer(:self%there) = transfer(text(:used), self%buffer, self%there)
  end subroutine next_piece

  subroutine finish_reading(self)
    class(record_reader_t), intent(inout) :: self

    if (self%file >= 0) call close_file(self%file)
    self%file = -1
  end subroutine finish_reading

  !> A text's letters, with blanks behind them.
  pure function words_of_text(text) result(words)
    character(*), intent(in) :: text
    integer(int64) :: words((len(text, int64) + bytes - 1)/bytes)

    words = transfer(text//repeat(' ', bytes), words, size(words))
  end function words_of_text

  pure integer(int64) function sum_of_text(text) result(sum)
    character(*), intent(in) :: text
    integer(int64) :: sums(2)

    sums = [0_int64, len(text, int64)]
    call add_to_sums(words_of_text(text), sums)
    sum = sum_of(sums)
  end function sum_of_text

  pure integer(int64) function sum_of(sums)
    integer(int64), intent(in) :: sums(2)

    sum_of = ior(ishft(sums(2), 32), sums(1))
  end function sum_of

  !> Fletcher's two sums over the halves of words, modulo a prime. So few words at once that neither sum passes 2**62 before.
  pure subroutine add_to_sums(words, sums)
    integer(int64), intent(in) :: words(:)
    integer(int64), intent(inout) :: sums(2)
    integer(int64), parameter :: modulus = 2147483647_int64, half = 4294967295_int64
    integer, parameter :: few = 2**13
    integer(int64) :: first, second
    integer :: from, i

    do from = 1, size(words), few
      first = sums(1)
      second = sums(2)
      do i = from, min(from + few - 1, size(words))
        first = first + iand(words(i), half)
        second = second + first
        first = first + ishft(words(i), -32)
        second = second + first
      end do
      sums = [modulo(first, modulus), modulo(second, modulus)]
    end do
  end subroutine add_to_sums
end module gearsweep_record_file
