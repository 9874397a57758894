!> Interfaces to the operating system and to BLAS: files, the clock of a thread, one BLAS thread.
!>
!> Texts passed to C end with a NUL. Codes below 0 are failures; `reason_of` gives them in words. The stopwatch returns the
!> shortest of several laps in the calling thread, which other work on the machine hardly changes:
!>
!>     type(stopwatch_t) :: watch
!>     do while (watch%goes_on())
!>       call work()
!>     end do
!>     seconds = watch%shortest
!>
!> See gearsweep_system.c, gearsweep_clock.c and gearsweep_blas.c.
module gearsweep_base_system
  use, intrinsic :: iso_c_binding, only: c_char, c_double, c_int, c_int64_t, c_null_char, c_size_t
  use gearsweep_base_kinds, only: dp
  implicit none
  private
  public :: open_file, read_file, close_file, print_text, reason_of, make_folder_at, remove_folder_at, begin_files, add_file, &
            show_files, end_files, stopwatch_t, hold_blas, release_blas, begin_products, end_products

  interface
    !> Opens a file and returns its descriptor; only a regular file unless `stream` is 1.
    integer(c_int) function open_file(path, stream) bind(c, name='gearsweep_open')
      import :: c_char, c_int
      character(kind=c_char), intent(in) :: path(*)
      integer(c_int), value :: stream
    end function open_file

    !> Reads at most `room` characters, and returns their number; 0 at the end.
    integer(c_int) function read_file(file, to, room) bind(c, name='gearsweep_read')
      import :: c_char, c_int
      integer(c_int), value :: file, room
      character(kind=c_char), intent(inout) :: to(*)
    end function read_file

    subroutine close_file(file) bind(c, name='gearsweep_close')
      import :: c_int
      integer(c_int), value :: file
    end subroutine close_file

    !> Prints to the standard output; returns 0 also if nobody reads any more.
    integer(c_int) function print_text(text, length) bind(c, name='gearsweep_print')
      import :: c_char, c_int, c_int64_t
      character(kind=c_char), intent(in) :: text(*)
      integer(c_int64_t), value :: length
    end function print_text

    !> Makes a folder and its missing parents; returns how many were missing.
    integer(c_int) function make_folder_at(path) bind(c, name='gearsweep_make_folder')
      import :: c_char, c_int
      character(kind=c_char), intent(in) :: path(*)
    end function make_folder_at

    !> Removes the last `depth` folders of a path, as far as they are empty.
    subroutine remove_folder_at(path, depth) bind(c, name='gearsweep_remove_folder')
      import :: c_char, c_int
      character(kind=c_char), intent(in) :: path(*)
      integer(c_int), value :: depth
    end subroutine remove_folder_at

    !> Begins a set of files in a folder, and returns its handle `where`. If it returns 0, it needs its `end_files`.
    integer(c_int) function begin_files(folder, where) bind(c, name='gearsweep_begin_set')
      import :: c_char, c_int
      character(kind=c_char), intent(in) :: folder(*)
      integer(c_int), intent(out) :: where(3)
    end function begin_files

    !> Writes file number `i` under a temporary name.
    integer(c_int) function add_file(where, i, text, length) bind(c, name='gearsweep_add_file')
      import :: c_char, c_int, c_int64_t
      integer(c_int), intent(in) :: where(3)
      integer(c_int), value :: i
      character(kind=c_char), intent(in) :: text(*)
      integer(c_int64_t), value :: length
    end function add_file

    !> Publishes `n` files under their names, all or none; `failed` is the number of one that failed. `names` has the names, each
    !> with the first words of such a file, and `m` more names of files not in this set. Files of an earlier set and of others get
    !> the ending .old.
    integer(c_int) function show_files(where, n, m, names, failed) bind(c, name='gearsweep_show_set')
      import :: c_char, c_int
      integer(c_int), intent(in) :: where(3)
      integer(c_int), value :: n, m
      character(kind=c_char), intent(in) :: names(*)
      integer(c_int), intent(out) :: failed
    end function show_files

    !> Closes the set and deletes files that were not published.
    subroutine end_files(where) bind(c, name='gearsweep_end_set')
      import :: c_int
      integer(c_int), intent(in) :: where(3)
    end subroutine end_files

    subroutine c_reason(code, words, length) bind(c, name='gearsweep_reason')
      import :: c_char, c_int, c_size_t
      integer(c_int), value :: code
      character(kind=c_char), intent(out) :: words(*)
      integer(c_size_t), value :: length
    end subroutine c_reason
  end interface

  type :: stopwatch_t
    integer :: fewest = 3                        !< smallest number of laps
    real(dp) :: shortest = huge(1.0_dp)          !< shortest lap, s of processor time
    real(dp), private :: began = 0, total = 0    !< s
    integer, private :: laps = -1                !< -1: no lap has begun
  contains
    procedure :: goes_on
  end type stopwatch_t

  interface
    real(c_double) function thread_seconds() bind(c, name='gearsweep_thread_seconds')
      import :: c_double
    end function thread_seconds
  end interface

  interface
    !> Sets BLAS to one thread at the start of a call; each call needs its `release_blas`. From any thread.
    subroutine hold_blas() bind(c, name='gearsweep_hold_blas')
    end subroutine hold_blas

    !> Restores the threads of BLAS at the end of a call.
    subroutine release_blas() bind(c, name='gearsweep_release_blas')
    end subroutine release_blas

    !> Prepares calls of BLAS and LAPACK; each needs its `end_products`, with no other between them.
    subroutine begin_products() bind(c, name='gearsweep_begin_products')
    end subroutine begin_products

    subroutine end_products() bind(c, name='gearsweep_end_products')
    end subroutine end_products
  end interface

contains

  !> Finds the reason of a failure, such as `No space left on device`.
  subroutine reason_of(code, reason)
    integer(c_int), intent(in) :: code
    character(:), allocatable, intent(out) :: reason
    character(256) :: words

    words = ''
    call c_reason(code, words, len(words, c_size_t))
    reason = words(:index(words, c_null_char) - 1)
  end subroutine reason_of

  !> Ends a lap; true if another one begins: of short laps more than `fewest` are measured.
  logical function goes_on(self)
    class(stopwatch_t), intent(inout) :: self
    real(dp), parameter :: enough = 1e-3_dp      ! s; the clock's resolution is nanoseconds
    real(dp) :: now

    now = thread_seconds()
    if (self%laps >= 0) then
      self%shortest = min(self%shortest, now - self%began)
      self%total = self%total + (now - self%began)
    end if
    self%laps = self%laps + 1
    goes_on = self%laps < self%fewest .or. (self%total < enough .and. self%laps < 1000)
    self%began = thread_seconds()
  end function goes_on
end module gearsweep_base_system
