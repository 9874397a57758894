!> Files that belong together: they appear in their folder all at once when all are written, or not at all.
module gearsweep_file_set
  use, intrinsic :: iso_c_binding, only: c_int, c_int64_t, c_null_char
  use gearsweep_error, only: error_t
  use gearsweep_files, only: fail_system
  use gearsweep_system, only: add_file, begin_files, end_files, show_files
  implicit none
  private
  public :: file_set_t

  !> `call files%begin(folder, error)`; for each file `call files%add(name, start, text, error)`, where `start` is how
  !> such files begin; for each file that the set could have but has not, `call files%lacks(name, start)`; then
  !> `call files%finish(error)`, whether a call failed or not: each does nothing once one has. Of each set, one caller;
  !> any number of sets at once, also in one folder.
  type :: file_set_t
    private
    integer(c_int) :: where(3) = -1
    logical :: begun = .false.
    character(:), allocatable :: folder
    integer :: files = 0, lacking = 0
    character(:), allocatable :: names, lacked     !< each with its NUL, and how it begins with a NUL
    integer, allocatable :: first(:), last(:)      !< of each file's name in `names`
  contains
    procedure :: begin, add, append, lacks, finish, leave
  end type file_set_t

contains

  !> The folder is there already.
  subroutine begin(self, folder, error)
    class(file_set_t), intent(inout) :: self
    character(*), intent(in) :: folder
    type(error_t), allocatable, intent(inout) :: error
    integer(c_int) :: code

    if (allocated(error)) return
    self%folder = folder
    self%names = ''
    self%lacked = ''
    allocate (self%first(0), self%last(0))
    code = begin_files(folder//c_null_char, self%where)
    self%begun = code == 0
    if (code < 0) call fail_system('cannot write to the folder '//folder, code, error)
  end subroutine begin

  !> Writes a file, not yet under its name. A file of this name that is there and does not begin with `start` is
  !> somebody's: its name gets the ending `.old`.
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
    code = add_file(self%where, int(self%files, c_int), text, len(text, c_int64_t), 0_c_int)
    if (code < 0) call fail_system('cannot write '//self%folder//'/'//name, code, error)
  end subroutine add

  !> Writes more of the file that was added last.
  subroutine append(self, text, error)
    class(file_set_t), intent(inout) :: self
    character(*), intent(in) :: text
    type(error_t), allocatable, intent(inout) :: error
    integer(c_int) :: code

    if (allocated(error)) return
    code = add_file(self%where, int(self%files, c_int), text, len(text, c_int64_t), 1_c_int)
    if (code < 0) call fail_system('cannot write '//self%folder//'/'// &
                                   self%names(self%first(self%files):self%last(self%files)), code, error)
  end subroutine append

  !> A file of this name is of an earlier set, if it begins with `start`: then its name gets the ending `.old`.
  subroutine lacks(self, name, start)
    class(file_set_t), intent(inout) :: self
    character(*), intent(in) :: name, start

    if (.not. self%begun) return
    self%lacking = self%lacking + 1
    self%lacked = self%lacked//name//c_null_char//start//c_null_char
  end subroutine lacks

  !> Shows the files under their names, unless a call failed.
  subroutine finish(self, error)
    class(file_set_t), intent(inout) :: self
    type(error_t), allocatable, intent(inout) :: error
    integer(c_int) :: code, failed

    if (.not. self%begun) return
    if (.not. allocated(error)) then
      code = show_files(self%where, int(self%files, c_int), int(self%lacking, c_int), self%names//self%lacked//c_null_char, &
                        failed)
      if (code < 0) call fail_system('cannot write '//self%folder//'/'// &
                                     self%names(self%first(failed):self%last(failed)), code, error)
    end if
    call self%leave()
  end subroutine finish

  !> Ends the set; what was not shown is gone.
  subroutine leave(self)
    class(file_set_t), intent(inout) :: self

    if (self%begun) call end_files(self%where)
    self%begun = .false.
  end subroutine leave
end module gearsweep_file_set
