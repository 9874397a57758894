!> The table of stiff and extreme cases, test/properties/extreme/cases.txt, and what becomes
!> of each case.
module test_properties_extreme_cases
  use gearsweep_base_kinds, only: dp
  use, intrinsic :: iso_fortran_env, only: int64
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan, ieee_quiet_nan, ieee_value
  use gearsweep_motion_error_estimate, only: levels_t, point_t, work_of
  use gearsweep_motion_operating_point, only: solve_point
  use gearsweep_motion_oscillator, only: mesh_period
  use gearsweep_motion_sweep, only: down, each
  use gearsweep_study_case_case, only: case_t
  use gearsweep_api_case_reader, only: read_case
  use gearsweep_study_reader_edit, only: change_key
  use gearsweep_base_error, only: error_t
  use gearsweep_study_run_files, only: read_text
  use gearsweep_motion_steady_motion, only: status_name
  use gearsweep_study_run_study, only: run_study, study_t
  use gearsweep_base_table, only: table_t
  use gearsweep_api_tables, only: column_of, make_table
  use gearsweep_base_text, only: to_number
  implicit none
  private
  public :: row_t, read_cases, is_case, outcome_t, outcome_of, same_bits, expected_value

  character(*), parameter :: folder = 'test/properties/extreme/'

  !> Stiffness by formulas is meant to be as exact, relative; no estimate comes along.
  real(dp), parameter :: formulas = 1e-6_dp

  !> One line of the table; of a heading, only the title.
  type :: row_t
    character(:), allocatable :: title, base, changes, quantity, status, expected, origin
    real(dp) :: within = 0
  end type row_t

  !> What became of a case.
  type :: outcome_t
    character(:), allocatable :: message         !< where it was refused
    character(:), allocatable :: status          !< of the point, or ok
    real(dp) :: value = 0, error = 0             !< error: estimated, relative
    real(dp) :: work = 0                         !< steps that the point took, by itself
    real(dp) :: alone = 0                        !< the dynamic factor without a batch, where it must be the same
    real(dp) :: alone_error = 0                  !< estimated, relative
    real(dp) :: seconds = 0
  end type outcome_t

contains

  subroutine read_cases(rows)
    type(row_t), allocatable, intent(out) :: rows(:)
    type(row_t) :: row
    character(1000) :: line
    integer :: unit, stat

    allocate (rows(0))
    open (newunit=unit, file=folder//'cases.txt', status='old', action='read')
    do
      read (unit, '(a)', iostat=stat) line
      if (stat /= 0) exit
      if (len_trim(line) == 0 .or. line(1:1) == '#') cycle
      ! By way of a variable, as gfortran never frees a function's result in an array constructor.
      row = row_of(trim(line))
      rows = [rows, row]
    end do
    close (unit)
  end subroutine read_cases

  type(row_t) function row_of(line) result(row)
    character(*), intent(in) :: line
    logical :: ok

    if (line(1:1) == '=') then
      row%title = trim(line(3:))
      return
    end if
    row%title = field(line, 1)
    row%base = field(line, 2)
    row%changes = field(line, 3)
    row%quantity = field(line, 4)
    row%status = field(line, 5)
    row%expected = field(line, 6)
    call to_number('0'//field(line, 7), row%within, ok)
    row%origin = field(line, 8)
  end function row_of

  logical function is_case(row)
    type(row_t), intent(in) :: row

    is_case = allocated(row%base)
  end function is_case

  !> Field number `n` of those that bars part.
  pure function field(line, n) result(text)
    character(*), intent(in) :: line
    integer, intent(in) :: n
    character(:), allocatable :: text
    integer :: first, i

    first = 1
    do i = 2, n
      first = first + index(line(first:), '|')
    end do
    text = line(first:)
    if (index(text, '|') > 0) text = text(:index(text, '|') - 1)
    text = trim(adjustl(text))
  end function field

  subroutine outcome_of(row, threads, outcome)
    type(row_t), intent(in) :: row
    integer, intent(in) :: threads
    type(outcome_t), intent(out) :: outcome
    type(error_t), allocatable :: error
    type(study_t) :: study
    type(case_t) :: case
    character(:), allocatable :: text
    integer(int64) :: start, finish, rate

    call system_clock(start, rate)
    call build_case(row, text, error)
    if (.not. allocated(error)) call read_case(text, case, error)
    if (.not. allocated(error)) call run_study(case, folder, threads, study, error)
    if (allocated(error)) then
      outcome%status = 'refused'
      outcome%message = error%message
    else
      outcome%status = 'ok'
      call take(row, study, outcome)
    end if
    call system_clock(finish)
    outcome%seconds = real(finish - start, dp)/rate
  end subroutine outcome_of

  !> The quantity that is asked for.
  subroutine take(row, study, outcome)
    type(row_t), intent(in) :: row
    type(study_t), intent(in) :: study
    type(outcome_t), intent(inout) :: outcome

    select case (row%quantity)
    case ('df', 'multiplier')
      call take_point(row, study, outcome)
    case ('ratio')
      outcome%value = study%mesh%contact_ratio
    case ('stiffness')
      outcome%value = study%mesh%stiffness%maximum()*1e-6_dp
    case ('compliance')
      outcome%value = 1e6_dp/study%mesh%stiffness%value(study%mesh%contact_ratio/2)
      outcome%error = formulas
    case ('frequency')
      outcome%value = first('modal', 'frequency_hz')
      outcome%error = first('modal', 'error_estimate')
    case ('tension')
      outcome%value = first('root_stress', 'tension_mpa')
      outcome%error = first('root_stress', 'error_estimate')
    case default
      error stop 'extreme/cases.txt asks for an unknown quantity'
    end select

  contains

    real(dp) function first(table, column)
      character(*), intent(in) :: table, column
      real(dp), allocatable :: numbers(:)

      numbers = column_of(study, table, column)
      first = numbers(1)
    end function first
  end subroutine take

  logical function same_bits(a, b)
    type(outcome_t), intent(in) :: a, b

    same_bits = a%status == b%status .and. all(transfer([a%value, a%error], [0_int64]) == transfer([b%value, b%error], [0_int64]))
  end function same_bits

  !> The base with the changes; `rpm` stands for the first and the last speed.
  subroutine build_case(row, text, error)
    type(row_t), intent(in) :: row
    character(:), allocatable, intent(out) :: text
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: rest, change

    call read_text(folder//row%base//'.nml', text, error)
    rest = row%changes//';'
    do while (len_trim(rest) > 1 .and. .not. allocated(error))
      change = adjustl(rest(:index(rest, ';') - 1))
      rest = rest(index(rest, ';') + 1:)
      if (index(change, 'rpm ') == 1) then
        call apply('sweep rpm_first'//change(4:))
        call apply('sweep rpm_last'//change(4:))
      else
        call apply(change)
      end if
    end do

  contains

    subroutine apply(change)
      character(*), intent(in) :: change
      character(:), allocatable :: changed
      integer :: blank, equals

      if (allocated(error)) return
      blank = index(change, ' ')
      equals = index(change, '=')
      call change_key(text, change(:blank - 1), trim(change(blank + 1:equals - 1)), trim(adjustl(change(equals + 1:))), &
                      changed, error)
      if (.not. allocated(error)) text = changed
    end subroutine apply
  end subroutine build_case

  !> The point that the sweep comes to last, and the same by itself.
  subroutine take_point(row, study, outcome)
    type(row_t), intent(in) :: row
    type(study_t), intent(in) :: study
    type(outcome_t), intent(inout) :: outcome
    type(levels_t), allocatable :: tables
    type(point_t) :: point
    type(table_t) :: sweep
    type(error_t), allocatable :: error
    integer :: k

    allocate (tables)
    call make_table(study, 'sweep', sweep, error)
    associate (motion => study%motion(1), accuracy => study%case%accuracy)
      k = merge(1, sweep%extent(2), study%case%direction == down)
      outcome%status = trim(sweep%word('status', k))
      outcome%value = sweep%number('dynamic_factor', k)
      if (.not. ieee_is_nan(outcome%value)) outcome%error = sweep%number('error_estimate', k)/outcome%value
      call solve_point(motion, mesh_period(motion%mesh%teeth(1), sweep%number('rpm', k)), accuracy, tables, point)
      outcome%work = work_of(tables)
      if (row%quantity == 'multiplier') then
        ! No estimate comes along.
        outcome%value = sweep%number('floquet_modulus', k)
        outcome%error = accuracy%steady%tolerance
      else if (study%case%direction == each) then
        outcome%alone = point%dynamic_factor
        if (outcome%alone > 0) outcome%alone_error = point%estimate/outcome%alone
      end if
    end associate
  end subroutine take_point

  !> A number, or what another case gives times a factor: `= title`, `= 2 * title`.
  real(dp) function expected_value(row, rows, values) result(value)
    type(row_t), intent(in) :: row, rows(:)
    real(dp), intent(in) :: values(:)
    character(:), allocatable :: text
    real(dp) :: factor
    integer :: i, star
    logical :: ok

    value = ieee_value(1.0_dp, ieee_quiet_nan)
    if (index(row%expected, '=') /= 1) then
      call to_number(row%expected, factor, ok)
      if (ok) value = factor
      return
    end if
    text = adjustl(row%expected(2:))
    factor = 1
    star = index(text, ' * ')
    if (star > 0) then
      call to_number(text(:star - 1), factor, ok)
      text = text(star + 3:)
    end if
    do i = 1, size(rows)
      if (rows(i)%title == text) value = factor*values(i)
    end do
  end function expected_value
end module test_properties_extreme_cases
