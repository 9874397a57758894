!> Interfaces of the calls for modern Fortran, whose compiler then checks the arguments. What they mean is told in
!> gearsweep_flat_calls.f90.
module gearsweep_calls
  implicit none
  private
  public :: gs_version, gs_describe, gs_edit, gs_run, gs_text, gs_size, gs_column, gs_words, gs_write, gs_free

  interface
    subroutine gs_version(version, info, message)
      character(*), intent(inout) :: version
      integer, intent(out) :: info
      character(*), intent(out) :: message
    end subroutine gs_version

    subroutine gs_describe(what, buffer, length, info, message)
      character(*), intent(in) :: what
      character(*), intent(inout) :: buffer
      integer, intent(inout) :: length
      integer, intent(out) :: info
      character(*), intent(out) :: message
    end subroutine gs_describe

    subroutine gs_edit(action, text, group, key, value, buffer, length, info, message)
      character(*), intent(in) :: action, text, group, key, value
      character(*), intent(inout) :: buffer
      integer, intent(inout) :: length
      integer, intent(out) :: info
      character(*), intent(out) :: message
    end subroutine gs_edit

    subroutine gs_run(text, folder, threads, earlier, watch, resume, keep, study, info, message)
      use, intrinsic :: iso_fortran_env, only: int64
      character(*), intent(in) :: text, folder, resume, keep
      integer, intent(in) :: threads
      integer(int64), intent(in) :: earlier
      integer, intent(inout), target :: watch(3)
      integer(int64), intent(inout) :: study
      integer, intent(out) :: info
      character(*), intent(out) :: message
    end subroutine gs_run

    subroutine gs_text(study, what, buffer, length, info, message)
      use, intrinsic :: iso_fortran_env, only: int64
      integer(int64), intent(in) :: study
      character(*), intent(in) :: what
      character(*), intent(inout) :: buffer
      integer, intent(inout) :: length
      integer, intent(out) :: info
      character(*), intent(out) :: message
    end subroutine gs_text

    subroutine gs_size(study, table, column, rows, kind, width, info, message)
      use, intrinsic :: iso_fortran_env, only: int64
      integer(int64), intent(in) :: study
      character(*), intent(in) :: table, column
      integer, intent(inout) :: rows, kind, width
      integer, intent(out) :: info
      character(*), intent(out) :: message
    end subroutine gs_size

    subroutine gs_column(study, table, column, rows, values, info, message)
      use, intrinsic :: iso_fortran_env, only: int64
      integer(int64), intent(in) :: study
      character(*), intent(in) :: table, column
      integer, intent(in) :: rows
      double precision, intent(inout) :: values(rows)
      integer, intent(out) :: info
      character(*), intent(out) :: message
    end subroutine gs_column

    subroutine gs_words(study, table, column, row, word, info, message)
      use, intrinsic :: iso_fortran_env, only: int64
      integer(int64), intent(in) :: study
      character(*), intent(in) :: table, column
      integer, intent(in) :: row
      character(*), intent(inout) :: word
      integer, intent(out) :: info
      character(*), intent(out) :: message
    end subroutine gs_words

    subroutine gs_write(study, folder, name, buffer, length, info, message)
      use, intrinsic :: iso_fortran_env, only: int64
      integer(int64), intent(in) :: study
      character(*), intent(in) :: folder, name
      character(*), intent(inout) :: buffer
      integer, intent(inout) :: length
      integer, intent(out) :: info
      character(*), intent(out) :: message
    end subroutine gs_write

    subroutine gs_free(study)
      use, intrinsic :: iso_fortran_env, only: int64
      integer(int64), intent(inout) :: study
    end subroutine gs_free
  end interface
end module gearsweep_calls
