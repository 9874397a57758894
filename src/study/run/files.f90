!> Files and folders by name: bounded reading, allowed names, and sets of files that appear all at once or not at all.
module gearsweep_study_run_files
  use, intrinsic :: iso_c_binding, only: c_int, c_int64_t, c_null_char
  use gearsweep_base, only: add_file, begin_files, close_file, code_file, code_input, code_memory, end_files, error_t, fail, &
    first_control, make_folder_at, open_file, read_file, reason_of, remove_folder_at, show_files, shown
  implicit none
  private
  public :: read_text, make_folder, remove_folder, check_name, check_folder, path_in, folder_of, fail_system, file_set_t

  !> Largest size (bytes) of a case, a table of stiffness or a list of printed values.
  integer, parameter, public :: longest_file = 10*1000*1000
  character(*), parameter, public :: too_long = 'longer than 10 MB'

  !> Use: `call files%begin(folder, error)`; for each file `call files%add(name, start, text, error)`, where `start` is the
  !> beginning of the text of such files; for each possible file that this set does not have,
  !> `call files%mark_absent(name, start)`; then
  !> `call files%finish(error)`, also after a failed call: later calls do nothing after a failure. Each set has one caller; any
  !> number of sets may be open at once, also in one folder.
  type :: file_set_t
    integer(c_int) :: where(3) = -1
    logical :: begun = .false.
    character(:), allocatable :: folder
    integer :: files = 0, absent_count = 0
    character(:), allocatable :: names           !< names of the files, each with a NUL after it
    character(:), allocatable :: absent_names    !< names and beginnings of absent files, each with a NUL after it
    integer, allocatable :: first(:), last(:)      !< of each file's name in `names`
  contains
    procedure :: begin, add, mark_absent, finish, leave
  end type file_set_t

contains

  !> Reads a file into one text. With `stream` it may also be a pipe or a device, which is read to its end; otherwise only a regular
  !> file. `longest`: largest size in bytes, if not that of cases and tables.
  subroutine read_text(path, text, error, stream, longest)
    character(*), intent(in) :: path
    character(:), allocatable, intent(out) :: text
    type(error_t), allocatable, intent(out) :: error
    logical, intent(in), optional :: stream
    integer, intent(in), optional :: longest
    integer(c_int) :: file, any_kind
    integer :: bound, used, room, stat
    character(:), allocatable :: larger
    integer(c_int) :: n

    bound = longest_file
    if (present(longest)) bound = longest
    any_kind = 0
    if (present(stream)) any_kind = merge(1_c_int, 0_c_int, stream)
    file = open_file(path//c_null_char, any_kind)
    if (file < 0) then
      call fail_system('cannot read '//path, file, error)
    else
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
      call close_file(file)
    end if
  end subroutine read_text

  !> Fails with the message of the system.
  subroutine fail_system(what, code, error)
    character(*), intent(in) :: what
    integer(c_int), intent(in) :: code
    type(error_t), allocatable, intent(inout) :: error
    character(:), allocatable :: reason

    call reason_of(code, reason)
    call fail(error, code_file, what//': '//reason)
  end subroutine fail_system

  !> Makes the folder `path` and its missing parents, and checks that files can be written there.
  subroutine make_folder(path, made, error)
    character(*), intent(in) :: path
    integer, intent(out) :: made                 !< number of folders made
    type(error_t), allocatable, intent(out) :: error
    integer(c_int) :: code, where(3)

    code = make_folder_at(path//c_null_char)
    made = max(0, int(code))
    if (code >= 0) then
      code = begin_files(path//c_null_char, where)
      if (code == 0) call end_files(where)
    end if
    if (code < 0) call fail_system('cannot write to the folder '//path, code, error)
  end subroutine make_folder

  !> Removes the `made` folders of `make_folder`, if they are empty.
  subroutine remove_folder(path, made)
    character(*), intent(in) :: path
    integer, intent(in) :: made

    call remove_folder_at(path//c_null_char, int(made, c_int))
  end subroutine remove_folder

  !> Refuses text that cannot be the beginning of a file's name in a folder.
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

  !> Refuses folder names that would spoil the list of written files.
  pure subroutine check_folder(folder, error)
    character(*), intent(in) :: folder
    type(error_t), allocatable, intent(inout) :: error

    if (has_controls(folder)) call fail(error, code_input, 'folder '//shown(folder)//': must not have control characters')
  end subroutine check_folder

  !> True if the name has control characters, such as tabs and line ends.
  pure logical function has_controls(name)
    character(*), intent(in) :: name

    has_controls = first_control(name) > 0 .or. scan(name, achar(9)//achar(10)//achar(13)) > 0
  end function has_controls

  !> Folder of a path, with its slash; empty if it has none.
  pure function folder_of(path) result(folder)
    character(*), intent(in) :: path
    character(:), allocatable :: folder

    folder = path(:index(path, '/', back=.true.))
  end function folder_of

  !> Path of a file that is named relative to the folder, which has its slash.
  pure function path_in(folder, file) result(path)
    character(*), intent(in) :: folder, file
    character(len(file) + merge(0, len(folder), index(file, '/') == 1)) :: path

    path = folder//file
    if (index(file, '/') == 1) path = file
  end function path_in

  !> Opens a set of files in an existing folder.
  subroutine begin(self, folder, error)
    class(file_set_t), intent(inout) :: self
    character(*), intent(in) :: folder
    type(error_t), allocatable, intent(inout) :: error
    integer(c_int) :: code

    if (allocated(error)) return
    self%folder = folder
    self%names = ''
    self%absent_names = ''
    allocate (self%first(0), self%last(0))
    code = begin_files(folder//c_null_char, self%where)
    self%begun = code == 0
    if (code < 0) call fail_system('cannot write to the folder '//folder, code, error)
  end subroutine begin

  !> Writes a file under a temporary name. An existing file of this name that does not begin with `start` is the user's: it is
  !> renamed with the ending `.old`.
  subroutine add(self, name, start, text, error)
    class(file_set_t), intent(inout) :: self
    character(*), intent(in) :: name, start, text
    type(error_t), allocatable, intent(inout) :: error
    integer(c_int) :: code

    if (allocated(error)) return
    self%files = self%files + 1
    self%first = [self%first, len(self%names) + 1]
    self%last = [self%last, len(self%names) + len(name)]
    self%names = self%names//name//c_null_char//start//c_null_char
    code = add_file(self%where, int(self%files, c_int), text, len(text, c_int64_t))
    if (code < 0) call fail_system('cannot write '//self%folder//'/'//name, code, error)
  end subroutine add

  !> Marks a file that this set does not have. An existing file of this name that begins with `start` is of an earlier set: it is
  !> renamed with the ending `.old`.
  subroutine mark_absent(self, name, start)
    class(file_set_t), intent(inout) :: self
    character(*), intent(in) :: name, start

    if (.not. self%begun) return
    self%absent_count = self%absent_count + 1
    self%absent_names = self%absent_names//name//c_null_char//start//c_null_char
  end subroutine mark_absent

  !> Renames the temporary files to their final names, unless a call failed.
  subroutine finish(self, error)
    class(file_set_t), intent(inout) :: self
    type(error_t), allocatable, intent(inout) :: error
    integer(c_int) :: code, failed

    if (.not. self%begun) return
    if (.not. allocated(error)) then
      code = show_files(self%where, int(self%files, c_int), int(self%absent_count, c_int), self%names//self%absent_names// &
                        c_null_char, failed)
      if (code < 0) call fail_system('cannot write '//self%folder//'/'// &
                                     self%names(self%first(failed):self%last(failed)), code, error)
    end if
    call self%leave()
  end subroutine finish

  !> Closes the set and deletes files that were not published.
  subroutine leave(self)
    class(file_set_t), intent(inout) :: self

    if (self%begun) call end_files(self%where)
    self%begun = .false.
  end subroutine leave
end module gearsweep_study_run_files
