!> A tiny test harness: named checks that print only when they fail.
module test_support_testing
  use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_null_char, c_ptr
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite, ieee_is_nan
  use, intrinsic :: iso_fortran_env, only: int64, output_unit
  use gearsweep_base_error, only: error_t
  use gearsweep_base_kinds, only: dp
  use gearsweep_base_text, only: str
  implicit none
  private
  public :: tally_t, suite_t, suite_i
  public :: check_true, check_close, check_equal, check_error, check_no_error
  public :: new_folder, remove_folder

  !> A check: what bears one name in a suite, as often as it is looked at. Passed where it always held.
  type :: check_t
    character(:), allocatable :: name
    logical :: passed
  end type check_t

  !> What the checks of a suite came to. Each name counts once.
  type :: tally_t
    character(:), allocatable :: only            !< part of the names of the tests that are wanted; empty for all
    character(:), allocatable :: tests           !< the tests that the suite could have run, a line each
    integer :: count = 0
    type(check_t), allocatable :: check(:)
    integer(int64), allocatable, private :: mark(:)    !< of the names
  contains
    procedure :: passed, failed, wants
    procedure, private :: note
  end type tally_t

  abstract interface
    subroutine suite_i(t)
      import :: tally_t
      type(tally_t), intent(inout) :: t
    end subroutine suite_i
  end interface

  !> One row in the table of suites.
  type :: suite_t
    character(24) :: name
    procedure(suite_i), pointer, nopass :: run
  end type suite_t

  interface
    !> Of POSIX: makes a folder of a name that nothing has, in place of the X at the end of the template.
    function mkdtemp(template) bind(c)
      import :: c_char, c_ptr
      character(c_char), intent(inout) :: template(*)
      type(c_ptr) :: mkdtemp
    end function mkdtemp
  end interface

  !> `actual` and `expected` are the same, exactly.
  interface check_equal
    module procedure check_equal_integer, check_equal_text
  end interface check_equal

contains

  pure integer function passed(self)
    class(tally_t), intent(in) :: self

    passed = 0
    if (self%count > 0) passed = count(self%check(:self%count)%passed)
  end function passed

  pure integer function failed(self)
    class(tally_t), intent(in) :: self

    failed = self%count - self%passed()
  end function failed

  !> Whether to run the test of this name, which is then in the list of tests.
  logical function wants(self, test)
    class(tally_t), intent(inout) :: self
    character(*), intent(in) :: test

    if (.not. allocated(self%only)) self%only = ''
    if (.not. allocated(self%tests)) self%tests = new_line('a')
    if (index(self%tests, new_line('a')//test//new_line('a')) == 0) self%tests = self%tests//test//new_line('a')
    wants = index(test, self%only) > 0
  end function wants

  subroutine note(self, name, held)
    class(tally_t), intent(inout) :: self
    character(*), intent(in) :: name
    logical, intent(in) :: held
    integer(int64) :: mark
    integer :: at

    if (.not. allocated(self%check)) allocate (self%check(16), self%mark(16))
    mark = mark_of(name)
    at = findloc(self%mark(:self%count), mark, 1)
    if (at > 0) then
      self%check(at)%passed = self%check(at)%passed .and. held
      return
    end if
    if (self%count == size(self%check)) then
      self%check = [self%check, self%check]
      self%mark = [self%mark, self%mark]
    end if
    self%count = self%count + 1
    self%check(self%count)%name = name
    self%check(self%count)%passed = held
    self%mark(self%count) = mark
  end subroutine note

  !> A number of 54 bits that no two names of a suite share.
  pure integer(int64) function mark_of(name) result(mark)
    character(*), intent(in) :: name
    integer(int64), parameter :: prime = 2_int64**54 - 33
    integer :: i

    mark = len(name)
    do i = 1, len(name)
      mark = modulo(257*mark + ichar(name(i:i)), prime)
    end do
  end function mark_of

  subroutine check_true(t, name, condition, detail)
    type(tally_t), intent(inout) :: t
    character(*), intent(in) :: name
    logical, intent(in) :: condition
    character(*), intent(in), optional :: detail

    call t%note(name, condition)
    if (condition) return
    if (present(detail)) then
      print '(a)', '  FAILED '//name//': '//detail
    else
      print '(a)', '  FAILED '//name
    end if
    flush (output_unit)
  end subroutine check_true

  !> |actual - expected| is at most the larger of `relative`*|expected| and `absolute`.
  !> With neither given: 1e-12 relative.
  subroutine check_close(t, name, actual, expected, relative, absolute)
    type(tally_t), intent(inout) :: t
    character(*), intent(in) :: name
    real(dp), intent(in) :: actual, expected
    real(dp), intent(in), optional :: relative, absolute
    real(dp) :: tolerance, deviation
    logical :: is_close

    tolerance = 0
    if (present(relative)) tolerance = relative*abs(expected)
    if (present(absolute)) tolerance = max(tolerance, absolute)
    if (.not. (present(relative) .or. present(absolute))) tolerance = 1e-12_dp*abs(expected)
    ! Differences of what is not finite would trap.
    if (ieee_is_finite(actual) .and. ieee_is_finite(expected)) then
      deviation = actual - expected
      is_close = abs(deviation) <= tolerance
    else
      deviation = 0
      is_close = .false.
      if (.not. (ieee_is_nan(actual) .or. ieee_is_nan(expected))) is_close = .not. (actual < expected .or. actual > expected)
    end if
    call check_true(t, name, is_close, str(actual, 15)//', expected '//str(expected, 15) &
      & //', deviation '//str(deviation, 3)//', tolerance '//str(tolerance, 3))
  end subroutine check_close

  subroutine check_equal_integer(t, name, actual, expected)
    type(tally_t), intent(inout) :: t
    character(*), intent(in) :: name
    integer, intent(in) :: actual, expected

    call check_true(t, name, actual == expected, str(actual)//', expected '//str(expected))
  end subroutine check_equal_integer

  !> Trailing blanks count.
  subroutine check_equal_text(t, name, actual, expected)
    type(tally_t), intent(inout) :: t
    character(*), intent(in) :: name, actual, expected

    call check_true(t, name, len(actual) == len(expected) .and. actual == expected, &
      & '"'//actual//'", expected "'//expected//'"')
  end subroutine check_equal_text

  !> The call failed, and its message contains this text.
  subroutine check_error(t, name, error, contains)
    type(tally_t), intent(inout) :: t
    character(*), intent(in) :: name
    type(error_t), allocatable, intent(in) :: error
    character(*), intent(in) :: contains

    if (.not. allocated(error)) then
      call check_true(t, name, .false., 'no error, expected one with "'//contains//'"')
    else
      call check_true(t, name, index(error%message, contains) > 0, &
        & '"'//error%message//'", expected to contain "'//contains//'"')
    end if
  end subroutine check_error

  subroutine check_no_error(t, name, error)
    type(tally_t), intent(inout) :: t
    character(*), intent(in) :: name
    type(error_t), allocatable, intent(in) :: error

    if (allocated(error)) then
      call check_true(t, name, .false., 'error: '//error%message)
    else
      call check_true(t, name, .true.)
    end if
  end subroutine check_no_error

  !> A new folder below build/, of this process alone: tests may run at the same time.
  function new_folder() result(path)
    character(:), allocatable :: path
    character(:, c_char), allocatable :: template

    template = 'build/tests.XXXXXX'//c_null_char
    if (.not. c_associated(mkdtemp(template))) error stop 'no folder for the tests can be made in build/'
    path = template(:len(template) - 1)
  end function new_folder

  !> Takes away a folder that new_folder has made, with all that is in it.
  subroutine remove_folder(path)
    character(*), intent(in) :: path

    if (index(path, 'build/tests.') == 1) call execute_command_line('rm -rf -- '//path)
  end subroutine remove_folder
end module test_support_testing
