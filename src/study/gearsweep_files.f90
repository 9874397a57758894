!> Files and folders by name: reading with a bound, and what a name may be.
module gearsweep_files
  use, intrinsic :: iso_c_binding, only: c_int, c_null_char
  use gearsweep_characters, only: first_control
  use gearsweep_error, only: error_t, fail, code_file, code_input, code_memory
  use gearsweep_system, only: begin_files, close_file, end_files, make_folder_at, open_file, read_file, reason_of, &
                              remove_folder_at
  use gearsweep_text, only: shown
  implicit none
  private
  public :: read_text, make_folder, remove_folder, check_name, check_folder, beside, folder_of, fail_system

  !> Beyond this no file is a case, a table of stiffness or a list of printed values.
  integer, parameter, public :: longest_file = 10*1000*1000
  character(*), parameter, public :: too_long = 'longer than 10 MB'

contains

  !> The whole file as one text. With `stream` it may also be a pipe or a device, which is read to its end;
  !> otherwise only a regular file. `longest` is another bound than that of cases and tables.
  subroutine read_text(path, text, error, stream, longest)
    character(*), intent(in) :: path
    character(:), allocatable, intent(out) :: text
    type(error_t), allocatable, intent(out) :: error
    logical, intent(in), optional :: stream
    integer, intent(in), optional :: longest
    integer(c_int) :: file, any_kind
    integer :: bound

    bound = longest_file
    if (present(longest)) bound = longest
    any_kind = 0
    if (present(stream)) any_kind = merge(1_c_int, 0_c_int, stream)
    file = open_file(path//c_null_char, any_kind)
    if (file < 0) then
      call fail_system('cannot read '//path, file, error)
    else
      call read_all(path, file, bound, text, error)
      call close_file(file)
    end if
  end subroutine read_text

  !> Reads an open file to its end, in linear time.
  subroutine read_all(path, file, bound, text, error)
    character(*), intent(in) :: path
    integer(c_int), intent(in) :: file
    integer, intent(in) :: bound
    character(:), allocatable, intent(out) :: text
    type(error_t), allocatable, intent(inout) :: error
    character(:), allocatable :: larger
    integer :: used, room, stat
    integer(c_int) :: n

    used = 0
    room = 2**16
    allocate (character(room) :: text, stat=stat)
    do while (stat == 0)
      n = read_file(file, text(used + 1:), int(room - used, c_int))
      if (n <= 0) exit
      used = used + n
      if (used > bound) exit
      if (used < room) cycle
      room = 2*room
      allocate (character(room) :: larger, stat=stat)
      if (stat /= 0) exit
      larger(:used) = text
      call move_alloc(larger, text)
    end do
    if (stat /= 0) then
      call fail(error, code_memory, path//': does not fit into memory')
    else if (n < 0) then
      call fail_system('cannot read '//path, n, error)
    else if (used > bound) then
      call fail(error, code_input, path//': is '//too_long)
    else
      text = text(:used)
    end if
  end subroutine read_all

  !> Fails with the system's own words.
  subroutine fail_system(what, code, error)
    character(*), intent(in) :: what
    integer(c_int), intent(in) :: code
    type(error_t), allocatable, intent(inout) :: error
    character(:), allocatable :: reason

    call reason_of(code, reason)
    call fail(error, code_file, what//': '//reason)
  end subroutine fail_system

  !> Makes the last folder of `path` if it is missing, and tries whether it takes files.
  subroutine make_folder(path, made, error)
    character(*), intent(in) :: path
    logical, intent(out) :: made                 !< it was missing
    type(error_t), allocatable, intent(out) :: error
    integer(c_int) :: code, where(3)

    code = make_folder_at(path//c_null_char)
    made = code == 1
    if (code >= 0) then
      code = begin_files(path//c_null_char, where)
      if (code == 0) call end_files(where)
    end if
    if (code < 0) call fail_system('cannot write to the folder '//path, code, error)
  end subroutine make_folder

  !> Removes a folder that `make_folder` made, if nothing is in it.
  subroutine remove_folder(path)
    character(*), intent(in) :: path

    call remove_folder_at(path//c_null_char)
  end subroutine remove_folder

  !> Refuses what cannot be the beginning of a file's name in a folder.
  pure subroutine check_name(name, error)
    character(*), intent(in) :: name
    type(error_t), allocatable, intent(inout) :: error

    if (len_trim(name) == 0) then
      call fail(error, code_input, 'name: is empty; the tables are called NAME.sweep.csv and so on')
    else if (index(name, '/') > 0 .or. name == '.' .or. name == '..') then
      call fail(error, code_input, 'name = '//shown(name)//': must be a name without a folder')
    else if (has_controls(name)) then
      call fail(error, code_input, 'name = '//shown(name)//': must not have control characters')
    end if
  end subroutine check_name

  !> Refuses folders whose name would spoil the list of the files written.
  pure subroutine check_folder(folder, error)
    character(*), intent(in) :: folder
    type(error_t), allocatable, intent(inout) :: error

    if (has_controls(folder)) call fail(error, code_input, 'folder '//shown(folder)//': must not have control characters')
  end subroutine check_folder

  !> Names have no use for tabs and line ends either.
  pure logical function has_controls(name)
    character(*), intent(in) :: name

    has_controls = first_control(name) > 0 .or. scan(name, achar(9)//achar(10)//achar(13)) > 0
  end function has_controls

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
end module gearsweep_files
