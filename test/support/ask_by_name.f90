!> The library's numbers by their names, from the text of a case: all that the suites of closed forms ask of it.
module test_support_ask_by_name
  use gearsweep_study_case_case, only: case_t
  use gearsweep_api_case_reader, only: read_case
  use gearsweep_base_error, only: error_t
  use gearsweep_base_kinds, only: dp
  use gearsweep_study_run_study, only: run_study, study_t
  use gearsweep_base_table, only: table_t
  use gearsweep_api_tables, only: make_table
  use test_support_testing, only: tally_t, check_no_error
  implicit none
  private
  public :: answer_t, ask, ask_geometry, elements_of, refusal, number_behind

  !> A study, whose numbers are asked for by table and column.
  type :: answer_t
    type(study_t) :: study
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
  end subroutine ask

  !> The numbers of a column, `table.column`, row by row; none where there is no such column.
  function all_of(answer, name) result(values)
    class(answer_t), intent(in) :: answer
    character(*), intent(in) :: name
    real(dp), allocatable :: values(:)
    type(table_t) :: table
    type(error_t), allocatable :: error
    integer :: at

    values = [real(dp) ::]
    call make_table(answer%study, name(:index(name, '.') - 1), table, error)
    if (.not. table%is_there()) return
    at = table%position(name(index(name, '.') + 1:))
    if (at > 0) values = table%columns(at)%numbers
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

  !> Geometry: radii (6, gear) of the tip, reference, drive base, coast base and root circle and where the drive involute
  !> begins; path coordinates of A, B, P, D, E and the radii (5, gear) there; the working angles of both sides.
  subroutine ask_geometry(t, text, radius_mm, point, point_radius_mm, distance_mm, working_angle_deg, contact_ratio, &
                          base_pitch_mm, backlash_um)
    type(tally_t), intent(inout) :: t
    character(*), intent(in) :: text
    real(dp), intent(out) :: radius_mm(6, 2), point(5), point_radius_mm(5, 2), distance_mm, working_angle_deg(2)
    real(dp), intent(out) :: contact_ratio, base_pitch_mm, backlash_um
    type(answer_t) :: answer

    call ask(t, text, answer)
    radius_mm(1, :) = answer%all_of('gears.tip_diameter_mm')/2
    radius_mm(2, :) = answer%all_of('gears.reference_diameter_mm')/2
    radius_mm(3, :) = answer%all_of('gears.base_diameter_mm')/2
    radius_mm(4, :) = answer%all_of('gears.coast_base_diameter_mm')/2
    radius_mm(5, :) = answer%all_of('gears.root_diameter_mm')/2
    radius_mm(6, :) = answer%all_of('gears.form_diameter_mm')/2
    point = answer%all_of('contact_points.s')
    point_radius_mm(:, 1) = answer%all_of('contact_points.pinion_radius_mm')
    point_radius_mm(:, 2) = answer%all_of('contact_points.gear_radius_mm')
    distance_mm = answer%one('geometry.centre_distance_mm')
    working_angle_deg = [answer%one('geometry.working_angle_deg'), answer%one('geometry.coast_working_angle_deg')]
    contact_ratio = answer%one('geometry.contact_ratio')
    base_pitch_mm = answer%one('geometry.base_pitch_mm')
    backlash_um = answer%one('geometry.backlash_um')
  end subroutine ask_geometry

  !> Nodes of the elements (8, elements).
  function elements_of(answer) result(element)
    type(answer_t), intent(in) :: answer
    integer, allocatable :: element(:, :)
    integer :: i

    allocate (element(8, size(answer%all_of('elements.tooth'))))
    do i = 1, 8
      element(i, :) = nint(answer%all_of('elements.node_'//achar(iachar('0') + i)))
    end do
  end function elements_of

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
end module test_support_ask_by_name
