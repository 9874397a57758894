!> Files by the operating system's own calls; see gearsweep_system.c.
!>
!> Texts that go in end with a NUL. Codes below 0 are failures, which `reason_of` tells in words.
module gearsweep_system
  use, intrinsic :: iso_c_binding, only: c_char, c_int, c_int64_t, c_null_char, c_size_t
  implicit none
  private
  public :: open_file, read_file, close_file, print_text, reason_of
  public :: make_folder_at, remove_folder_at, begin_files, add_file, show_files, end_files, drop_file

  interface
    !> Descriptor; unless `stream` is 1, only of a regular file.
    integer(c_int) function open_file(path, stream) bind(c, name='gearsweep_open')
      import :: c_char, c_int
      character(kind=c_char), intent(in) :: path(*)
      integer(c_int), value :: stream
    end function open_file

    !> How many characters were read, at most `room`; 0 at the end.
    integer(c_int) function read_file(file, to, room) bind(c, name='gearsweep_read')
      import :: c_char, c_int
      integer(c_int), value :: file, room
      character(kind=c_char), intent(inout) :: to(*)
    end function read_file

    subroutine close_file(file) bind(c, name='gearsweep_close')
      import :: c_int
      integer(c_int), value :: file
    end subroutine close_file

    !> Prints to the standard output; where nobody reads any more, 0 too.
    integer(c_int) function print_text(text, length) bind(c, name='gearsweep_print')
      import :: c_char, c_int, c_int64_t
      character(kind=c_char), intent(in) :: text(*)
      integer(c_int64_t), value :: length
    end function print_text

    !> 1: it was missing; 0: it was there.
    integer(c_int) function make_folder_at(path) bind(c, name='gearsweep_make_folder')
      import :: c_char, c_int
      character(kind=c_char), intent(in) :: path(*)
    end function make_folder_at

    !> If nothing is in it.
    subroutine remove_folder_at(path) bind(c, name='gearsweep_remove_folder')
      import :: c_char
      character(kind=c_char), intent(in) :: path(*)
    end subroutine remove_folder_at

    !> Begins a set of files in a folder; `where` stands for it. Needs its `end_files` where this gives 0.
    integer(c_int) function begin_files(folder, where) bind(c, name='gearsweep_begin_set')
      import :: c_char, c_int
      character(kind=c_char), intent(in) :: folder(*)
      integer(c_int), intent(out) :: where(3)
    end function begin_files

    !> Writes file number `i`, not yet under its name; with `more` 1, at the end of what it has.
    integer(c_int) function add_file(where, i, text, length, more) bind(c, name='gearsweep_add_file')
      import :: c_char, c_int, c_int64_t
      integer(c_int), intent(in) :: where(3)
      integer(c_int), value :: i, more
      character(kind=c_char), intent(in) :: text(*)
      integer(c_int64_t), value :: length
    end function add_file

    !> Shows `n` files under their names, all or none; `failed` tells which could not be. `names` has them, each with how
    !> such a file begins, and `m` more that this set lacks. Files of an earlier set and of others get the ending .old.
    integer(c_int) function show_files(where, n, m, names, failed) bind(c, name='gearsweep_show_set')
      import :: c_char, c_int
      integer(c_int), intent(in) :: where(3)
      integer(c_int), value :: n, m
      character(kind=c_char), intent(in) :: names(*)
      integer(c_int), intent(out) :: failed
    end function show_files

    !> Ends a set; what was not shown is gone.
    subroutine end_files(where) bind(c, name='gearsweep_end_set')
      import :: c_int
      integer(c_int), intent(in) :: where(3)
    end subroutine end_files

    !> Removes a regular file that begins with these words.
    subroutine drop_file(path, words) bind(c, name='gearsweep_drop_file')
      import :: c_char
      character(kind=c_char), intent(in) :: path(*), words(*)
    end subroutine drop_file

    subroutine c_reason(code, words, length) bind(c, name='gearsweep_reason')
      import :: c_char, c_int, c_size_t
      integer(c_int), value :: code
      character(kind=c_char), intent(out) :: words(*)
      integer(c_size_t), value :: length
    end subroutine c_reason
  end interface

contains

  !> Why a call failed, such as `No space left on device`.
  subroutine reason_of(code, reason)
    integer(c_int), intent(in) :: code
    character(:), allocatable, intent(out) :: reason
    character(256) :: words

    words = ''
    call c_reason(code, words, len(words, c_size_t))
    reason = words(:index(words, c_null_char) - 1)
  end subroutine reason_of
end module gearsweep_system
