!> Text files: read whole, written under a temporary name and renamed, so that
!> no reader meets a half-written one.
module gearsweep_files
  use, intrinsic :: iso_c_binding, only: c_char, c_int, c_null_char
  use gearsweep_kinds, only: dp
  use gearsweep_error, only: error_t, fail, code_file, code_input
  use gearsweep_text, only: str
  implicit none
  private
  public :: read_text, write_text, make_folder, remove_folder, read_table, beside, folder_of

  interface
    integer(c_int) function c_rename(from, to) bind(c, name='rename')
      import :: c_char, c_int
      character(kind=c_char), intent(in) :: from(*), to(*)
    end function c_rename

    integer(c_int) function c_rmdir(path) bind(c, name='rmdir')
      import :: c_char, c_int
      character(kind=c_char), intent(in) :: path(*)
    end function c_rmdir

    integer(c_int) function c_mkdir(path, mode) bind(c, name='mkdir')
      import :: c_char, c_int
      character(kind=c_char), intent(in) :: path(*)
      integer(c_int), value :: mode
    end function c_mkdir
  end interface

contains

  !> The whole file as one text.
  subroutine read_text(path, text, error)
    character(*), intent(in) :: path
    character(:), allocatable, intent(out) :: text
    type(error_t), allocatable, intent(out) :: error
    character(256) :: reason
    integer :: unit, length, stat

    open (newunit=unit, file=path, status='old', action='read', access='stream', form='unformatted', &
          iostat=stat, iomsg=reason)
    if (stat == 0) then
      inquire (unit=unit, size=length)
      if (length > 0) then
        allocate (character(length) :: text)
        read (unit, iostat=stat, iomsg=reason) text
      else
        call read_stream(unit, text, stat, reason)
      end if
      close (unit)
    end if
    if (stat /= 0) call fail(error, code_file, 'cannot read '//path//': '//trim(reason))
  end subroutine read_text

  !> A pipe has no size: byte by byte.
  subroutine read_stream(unit, text, stat, reason)
    integer, intent(in) :: unit
    character(:), allocatable, intent(out) :: text
    integer, intent(out) :: stat
    character(*), intent(inout) :: reason
    character(1) :: byte

    text = ''
    do
      read (unit, iostat=stat, iomsg=reason) byte
      if (stat /= 0) exit
      text = text//byte
    end do
    if (is_iostat_end(stat)) stat = 0
  end subroutine read_stream

  !> Writes `text` to `path`, all or nothing.
  subroutine write_text(path, text, error)
    character(*), intent(in) :: path, text
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: temporary
    character(256) :: reason
    integer :: unit, stat, ignored

    temporary = path//'.part'
    open (newunit=unit, file=temporary, status='replace', action='write', access='stream', form='unformatted', &
          iostat=stat, iomsg=reason)
    if (stat == 0) then
      write (unit, iostat=stat, iomsg=reason) text
      if (stat == 0) then
        close (unit, iostat=stat, iomsg=reason)
      else
        close (unit, status='delete', iostat=ignored)
      end if
    end if
    if (stat == 0) then
      stat = c_rename(temporary//c_null_char, path//c_null_char)
      reason = 'something else of that name is in the way'
      if (stat /= 0) call remove(temporary)
    end if
    if (stat /= 0) call fail(error, code_file, 'cannot write '//path//': '//trim(reason))
  end subroutine write_text

  subroutine remove(path)
    character(*), intent(in) :: path
    integer :: unit, stat

    open (newunit=unit, file=path, status='old', iostat=stat)
    if (stat == 0) close (unit, status='delete', iostat=stat)
  end subroutine remove

  !> Removes a folder that `make_folder` made, if nothing is in it.
  subroutine remove_folder(path)
    character(*), intent(in) :: path
    integer(c_int) :: ignored

    ignored = c_rmdir(path//c_null_char)
  end subroutine remove_folder

  !> Makes the last folder of `path` if it is missing, and tries whether it takes files.
  subroutine make_folder(path, made, error)
    character(*), intent(in) :: path
    logical, intent(out) :: made                 !< it was missing
    type(error_t), allocatable, intent(out) :: error
    character(256) :: reason
    integer :: unit, stat

    made = c_mkdir(path//c_null_char, int(o'777', c_int)) == 0
    open (newunit=unit, file=path//'/.gearsweep.part', status='replace', action='write', iostat=stat, iomsg=reason)
    if (stat == 0) close (unit, status='delete', iostat=stat, iomsg=reason)
    if (stat /= 0) call fail(error, code_file, 'cannot write to the folder '//path//': '//trim(reason))
  end subroutine make_folder

  !> Folder of a path, with its slash; empty for none.
  pure function folder_of(path) result(folder)
    character(*), intent(in) :: path
    character(:), allocatable :: folder

    folder = path(:index(path, '/', back=.true.))
  end function folder_of

  !> A relative file lies in the folder, which has its slash.
  pure function beside(folder, file) result(path)
    character(*), intent(in) :: folder, file
    character(len(file) + merge(0, len(folder), index(file, '/') == 1)) :: path

    path = folder//file
    if (index(file, '/') == 1) path = file
  end function beside

  !> Two columns of numbers, separated by blanks, tabs, commas or semicolons;
  !> lines that begin with `#` or `!` are comments.
  subroutine read_table(path, first, second, error)
    character(*), intent(in) :: path
    real(dp), allocatable, intent(out) :: first(:), second(:)
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: text
    integer :: from, until, line, rows

    call read_text(path, text, error)
    if (allocated(error)) return
    allocate (first(count_lines(text)), second(count_lines(text)))
    rows = 0
    line = 0
    from = 1
    do while (from <= len(text))
      until = index(text(from:), new_line('a')) + from - 1
      if (until < from) until = len(text) + 1
      line = line + 1
      call read_row(text(from:until - 1))
      if (allocated(error)) return
      from = until + 1
    end do
    first = first(:rows)
    second = second(:rows)

  contains

    subroutine read_row(raw)
      character(*), intent(in) :: raw
      character(:), allocatable :: row
      character(40) :: words(2)
      character(1) :: surplus
      real(dp) :: numbers(2)
      integer :: k, stat

      row = raw
      do k = 1, len(row)
        if (index(achar(9)//achar(13)//',;', row(k:k)) > 0) row(k:k) = ' '
      end do
      row = adjustl(row)
      if (len_trim(row) == 0) return
      if (index('#!', row(1:1)) > 0) return
      read (row, *, iostat=stat) numbers
      if (stat == 0 .and. verify(trim(row), '0123456789+-.eEdD ') > 0) stat = 1
      if (stat == 0) then
        if (.not. all(abs(numbers) < huge(numbers))) stat = 1
        read (row, *, iostat=k) words, surplus
        if (k == 0) stat = 1
      end if
      if (stat /= 0) then
        call fail(error, code_input, path//' line '//str(line)//': must be two numbers, s and stiffness')
        return
      end if
      rows = rows + 1
      first(rows) = numbers(1)
      second(rows) = numbers(2)
    end subroutine read_row
  end subroutine read_table

  pure integer function count_lines(text) result(n)
    character(*), intent(in) :: text
    integer :: i

    n = 1
    do i = 1, len(text)
      if (text(i:i) == new_line('a')) n = n + 1
    end do
  end function count_lines
end module gearsweep_files
