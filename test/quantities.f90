!> The library's numbers by their names, from the text of a case: all that the suites of closed forms ask of it.
module quantities
  use gearsweep_calls, only: gs_geometry
  use gearsweep_case, only: case_t
  use gearsweep_case_reader, only: read_case
  use gearsweep_error, only: error_t
  use gearsweep_kinds, only: dp
  use gearsweep_numbers, only: list_numbers, numbers_t
  use gearsweep_study, only: run_study, study_t
  use testing, only: tally_t, check_true, check_no_error
  implicit none
  private
  public :: answer_t, ask, ask_geometry, refusal, number_behind

  !> Every number of a study: those of `mesh`, `motion`, `static` and so on under the names of the tables.
  type :: answer_t
    type(study_t) :: study
    type(numbers_t) :: numbers
    character(:), allocatable, private :: names
  contains
    procedure :: all_of
    procedure :: one
  end type answer_t

contains

  !> Runs the case of `text`.
  subroutine ask(t, text, answer)
    type(tally_t), intent(inout) :: t
    character(*), intent(in) :: text
    type(answer_t), intent(out) :: answer
    type(case_t) :: case
    type(error_t), allocatable :: error

    call read_case(text, case, error)
    if (.not. allocated(error)) call run_study(case, '', 1, answer%study, error)
    call check_no_error(t, text, error)
    if (.not. allocated(error)) call list_numbers(answer%study, answer%numbers, error)
    answer%names = answer%numbers%names%text()
  end subroutine ask

  !> All values of the array with this name, in the order of its elements; none where there is no such array.
  function all_of(answer, name) result(values)
    class(answer_t), intent(in) :: answer
    character(*), intent(in) :: name
    real(dp), allocatable :: values(:)
    character(:), allocatable :: line
    integer :: at, end, blank, from, extent(4)

    values = [real(dp) ::]
    at = 1
    from = 0
    do while (at <= len(answer%names))
      end = at + index(answer%names(at:), new_line('a')) - 2
      line = answer%names(at:end)//' 1 1 1 1'
      blank = index(line, ' ')
      read (line(blank:), *) extent
      if (line(:blank - 1) == name) then
        values = answer%numbers%values(from + 1:from + product(extent))
        return
      end if
      from = from + product(extent)
      at = end + 2
    end do
  end function all_of

  !> The only value of this name; a value far off where there is none.
  real(dp) function one(answer, name)
    class(answer_t), intent(in) :: answer
    character(*), intent(in) :: name
    real(dp), allocatable :: values(:)

    one = -huge(one)
    values = answer%all_of(name)
    if (size(values) == 1) one = values(1)
  end function one

  !> Geometry by the same names as the arguments of gs_geometry.
  subroutine ask_geometry(t, text, radius_mm, point, point_radius_mm, distance_mm, working_angle_deg, contact_ratio, &
                          base_pitch_mm, backlash_um)
    type(tally_t), intent(inout) :: t
    character(*), intent(in) :: text
    real(dp), intent(out) :: radius_mm(6, 2), point(5), point_radius_mm(5, 2), distance_mm, working_angle_deg(2)
    real(dp), intent(out) :: contact_ratio, base_pitch_mm, backlash_um
    character(200) :: message
    integer :: info

    radius_mm = -1
    point = -1
    point_radius_mm = -1
    distance_mm = -1
    working_angle_deg = -1
    contact_ratio = -1
    base_pitch_mm = -1
    backlash_um = -1
    call gs_geometry(text, radius_mm, point, point_radius_mm, distance_mm, working_angle_deg, contact_ratio, &
                     base_pitch_mm, backlash_um, info, message)
    call check_true(t, text, info == 0, trim(message))
  end subroutine ask_geometry

  !> What is said of a case that is refused; nothing where it is not.
  function refusal(text) result(message)
    character(*), intent(in) :: text
    character(:), allocatable :: message
    type(case_t) :: case
    type(study_t) :: study
    type(error_t), allocatable :: error

    message = ''
    call read_case(text, case, error)
    if (.not. allocated(error)) call run_study(case, '', 1, study, error)
    if (allocated(error)) message = error%message
  end function refusal

  !> The number that follows some words in a message; a value far off where the words are not there.
  real(dp) function number_behind(message, words) result(number)
    character(*), intent(in) :: message, words
    integer :: first, last

    number = -huge(number)
    first = index(message, words)
    if (first == 0) return
    first = first + len(words)
    last = first + verify(message(first:)//';', ' +-.0123456789Ee') - 2
    read (message(first:last), *) number
  end function number_behind
end module quantities
