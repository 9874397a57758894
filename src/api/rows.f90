!> Runs one case with many rows of values for some of its keys: its text is split once, and each row has the same columns, with the
!> same bits as a run of its own.
module gearsweep_api_rows
  use, intrinsic :: iso_c_binding, only: c_loc
  use gearsweep_base, only: claim_memory, code_input, code_ok, code_partial, code_stopped, column_t, dp, error_t, fail, kind_text, &
    lower, no_number, shown, split, str, table_t, wants_stop
  use gearsweep_study, only: case_t, change_key, failed_points, name_length, namelist_t, parse_namelist, run_study, &
    shortest_digits, study_t
  use gearsweep_api_case_reader, only: check_keys, read_list
  use gearsweep_api_handles, only: find_column, find_table, handle_t
  use gearsweep_api_tables, only: make_table, table_names
  implicit none
  private
  public :: run_rows, check_study

  !> A name of two parts: group and key of a key, or table and column of a column.
  type :: place_t
    character(name_length) :: first = '', second = ''
  end type place_t

  !> A selected column and its numbers.
  type :: selected_t
    type(column_t) :: column
    integer :: each = 0                          !< numbers of the column for one row of values
    real(dp), allocatable :: numbers(:, :)       !< (number of one row, row)
  end type selected_t

  !> Result of a row of values.
  type :: outcome_t
    integer :: code = code_stopped
    character(:), allocatable :: message
  end type outcome_t

contains

  !> Runs the case once for each row of `values` (name, row) of the keys in `names`, each as group.key, separated by blanks. The
  !> columns in `take`, each as table.column, are collected in tables of `handle`, whose first, `rows`, has each row's code and
  !> message. A row without a result has NaN. The first row that runs sets the count of numbers for each row. `handle%study` is that
  !> of the last row that ran; products of `earlier` and of earlier rows with the same inputs are reused.
  subroutine run_rows(text, folder, threads, earlier, watch, names, values, take, handle, error)
    character(*), intent(in) :: text, folder, names, take
    integer, intent(in) :: threads
    type(study_t), pointer, intent(in) :: earlier
    integer, intent(inout), target :: watch(3)
    real(dp), intent(in) :: values(:, :)
    type(handle_t), pointer, intent(in) :: handle
    type(error_t), allocatable, intent(inout) :: error
    type(place_t), allocatable :: keys(:), places(:)
    type(selected_t), allocatable :: selected(:)
    type(outcome_t), allocatable :: outcomes(:)
    type(error_t), allocatable :: wrong
    type(namelist_t) :: list
    type(case_t) :: case
    type(study_t), pointer :: now, before
    character(:), allocatable :: full_text
    integer, allocatable :: at(:)
    integer :: row, k
    logical :: is_own

    call split_places('names', names, keys, error)
    call split_places('take', take, places, error)
    if (allocated(error)) return
    call put_keys(text, keys, values, full_text, list, at, error)
    call claim_memory(200.0_dp*size(values, 2), 'rows = '//str(size(values, 2)), error)
    if (allocated(error)) return
    allocate (outcomes(size(values, 2)))
    watch(2:3) = [0, size(values, 2)]
    handle%is_of_rows = .true.
    before => earlier
    is_own = .false.                             ! true once `before` is the study of a row
    do row = 1, size(values, 2)
      if (wants_stop(c_loc(watch))) exit
      if (allocated(wrong)) deallocate (wrong)
      call read_row(full_text, list, at, values(:, row), case, wrong)
      allocate (now)
      if (.not. allocated(wrong)) call run_study(case, folder, threads, now, wrong, watch=watch, earlier=before, &
        has_progress=.false.)
      if (.not. allocated(wrong)) then
        if (.not. now%stopped) call copy_columns(now, places, row, size(values, 2), selected, wrong, error)
        call check_study(now, wrong)
        if (is_own) deallocate (before)
        before => now
        is_own = .true.
      else
        deallocate (now)
      end if
      if (allocated(error)) exit
      call fail(wrong, code_ok, '')
      outcomes(row)%code = wrong%code
      outcomes(row)%message = wrong%message
      watch(2) = row
    end do
    do k = row, size(outcomes)
      outcomes(k)%message = 'not run, as the call was interrupted'
    end do
    if (.not. allocated(error)) call fill_tables(outcomes, places, selected, handle%tables, error)
    if (is_own) then
      handle%study = before
      deallocate (before)
    end if
    if (any(outcomes%code == code_stopped)) call fail(error, code_stopped, 'interrupted: rows that were done by then are there')
    if (any(outcomes%code /= code_ok)) call fail(error, code_partial, str(count(outcomes%code /= code_ok))//' of '// &
      str(size(outcomes))//' rows of values lack results; their code and message say why')
  end subroutine run_rows

  !> Sets the error of a study with missing results.
  subroutine check_study(study, error)
    type(study_t), intent(in) :: study
    type(error_t), allocatable, intent(inout) :: error

    if (study%stopped) then
      call fail(error, code_stopped, 'interrupted: what was computed by then is there; points that were not have the '// &
                'status stopped')
    else if (failed_points(study) > 0) then
      call fail(error, code_partial, str(failed_points(study))//' operating points have no answer (NaN); their '// &
                'status says why')
    end if
  end subroutine check_study

  subroutine split_places(what, list, places, error)
    character(*), intent(in) :: what, list
    type(place_t), allocatable, intent(out) :: places(:)
    type(error_t), allocatable, intent(inout) :: error
    character(2*name_length + 1), allocatable :: words(:)
    integer :: i, dot

    call split(list, words)
    allocate (places(size(words)))
    do i = 1, size(words)
      dot = index(words(i), '.')
      if (dot == 0 .or. any(words(:i - 1) == words(i))) call fail(error, code_input, what//' = '//shown(trim(words(i)))// &
        ': must be two names with a point between them, and each pair once')
      places(i) = place_t(words(i)(:dot - 1), words(i)(dot + 1:))
    end do
  end subroutine split_places

  !> Builds the text with the first row's values, splits it, and finds the entries of the keys.
  subroutine put_keys(text, keys, values, full_text, list, at, error)
    character(*), intent(in) :: text
    type(place_t), intent(in) :: keys(:)
    real(dp), intent(in) :: values(:, :)         !< (key, row)
    character(:), allocatable, intent(out) :: full_text
    type(namelist_t), intent(out) :: list
    integer, allocatable, intent(out) :: at(:)
    type(error_t), allocatable, intent(inout) :: error
    type(namelist_t) :: asked
    character(:), allocatable :: next
    integer :: i

    full_text = text
    allocate (asked%entries(size(keys)), at(size(keys)))
    do i = 1, size(keys)
      if (allocated(error)) return
      asked%entries(i)%group = trim(keys(i)%first)
      asked%entries(i)%key = trim(keys(i)%second)
      call change_key(full_text, trim(keys(i)%first), trim(keys(i)%second), trim(shortest_text(values(i, 1))), next, error)
      if (.not. allocated(error)) call move_alloc(next, full_text)
    end do
    call check_keys(full_text, asked, error)
    if (.not. allocated(error)) call parse_namelist(full_text, list, error)
    if (allocated(error)) return
    do i = 1, size(keys)
      at(i) = list%position(lower(keys(i)%first), lower(keys(i)%second))
      if (any(at(:i - 1) == at(i))) call fail(error, code_input, 'names = '//trim(keys(i)%first)//'.'//trim(keys(i)%second)// &
        ': is given twice')
    end do
  end subroutine put_keys

  !> Reads the case with one row's values.
  subroutine read_row(text, list, at, values, case, error)
    character(*), intent(in) :: text
    type(namelist_t), intent(inout) :: list
    integer, intent(in) :: at(:)                 !< entries of the keys
    real(dp), intent(in) :: values(:)
    type(case_t), intent(out) :: case
    type(error_t), allocatable, intent(out) :: error
    character(30) :: words
    integer :: k, pass

    do pass = 1, 2
      do k = 1, size(at)
        write (words, '(es24.16e3)') values(k)
        ! A number that is no integer is written with the fewest digits, for messages. If the text with integers in exponential form
        ! is
        ! refused, the second pass writes them as integers, which keys of integers require.
        if (pass == 2 .or. .not. abs(values(k) - anint(values(k))) > 0) words = shortest_text(values(k))
        list%entries(at(k))%values(1)%text = trim(adjustl(words))
      end do
      call read_list(text, list, case, error)
      if (.not. allocated(error)) return
    end do
  end subroutine read_row

  !> Number in the fewest digits that read back to the same bits.
  function shortest_text(value) result(words)
    real(dp), intent(in) :: value
    character(30) :: words
    real(dp) :: number
    logical :: found

    words = str(value)
    if (abs(value) <= huge(value)) call shortest_digits(value, 1.0_dp, words, number, found)
  end function shortest_text

  !> Copies the numbers of the columns into this row of `selected`; `wrong` if this row has another count than the first one. A
  !> column missing in the first row that runs is an `error` of the call.
  subroutine copy_columns(study, places, row, rows, selected, wrong, error)
    type(study_t), intent(in) :: study
    type(place_t), intent(in) :: places(:)
    integer, intent(in) :: row, rows
    type(selected_t), allocatable, intent(inout) :: selected(:)
    type(error_t), allocatable, intent(inout) :: wrong, error
    type(selected_t) :: found(size(places))
    type(table_t) :: table
    integer :: i, at

    do i = 1, size(places)
      if (.not. table_is(places(i)%first)) call make_table(study, trim(places(i)%first), table, wrong)
      if (allocated(wrong)) return
      at = 0
      if (table%is_there()) at = table%position(trim(places(i)%second))
      if (at > 0) then
        if (table%columns(at)%kind == kind_text) at = 0
      end if
      if (at == 0) call explain(study, places(i), wrong)
      if (allocated(wrong)) exit
      found(i)%column = table%columns(at)
      found(i)%each = table%rows
      if (.not. allocated(selected)) cycle
      if (table%rows /= selected(i)%each) call fail(wrong, code_input, trim(places(i)%first)//': has '//str(table%rows)// &
        ' rows, and '//str(selected(i)%each)//' with the first values that ran; they must be as many with all values')
    end do
    if (.not. allocated(selected)) then
      if (allocated(wrong)) call fail(error, wrong%code, wrong%message)
      call claim_memory(8.0_dp*rows*sum(found%each), 'rows = '//str(rows)//': their columns', error)
      if (allocated(error)) return
      selected = found
      do i = 1, size(selected)
        allocate (selected(i)%numbers(selected(i)%each, rows), source=no_number())
      end do
    end if
    if (allocated(wrong)) return
    do i = 1, size(selected)
      selected(i)%numbers(:, row) = found(i)%column%numbers
    end do

  contains

    !> True if this is the name of the current table.
    logical function table_is(name)
      character(*), intent(in) :: name

      table_is = allocated(table%name)
      if (table_is) table_is = table%name == name
    end function table_is
  end subroutine copy_columns

  !> Explains why a column is not available.
  subroutine explain(study, place, error)
    type(study_t), intent(in) :: study
    type(place_t), intent(in) :: place
    type(error_t), allocatable, intent(inout) :: error
    type(handle_t), pointer :: all
    type(table_t), pointer :: table
    type(column_t), pointer :: column
    integer :: i

    allocate (all)
    associate (names => table_names())
      allocate (all%tables(size(names)))
      do i = 1, size(names)
        call make_table(study, trim(names(i)), all%tables(i), error)
      end do
    end associate
    call find_table(all, trim(place%first), table, error)
    call find_column(table, trim(place%second), column, error)
    call fail(error, code_input, 'column = '//trim(place%second)//': has words, not numbers')
    deallocate (all)
  end subroutine explain

  !> Fills the table `rows`, and one for each table with a selected column.
  subroutine fill_tables(outcomes, places, selected, tables, error)
    type(outcome_t), intent(in) :: outcomes(:)
    type(place_t), intent(in) :: places(:)
    type(selected_t), allocatable, intent(in) :: selected(:)
    type(table_t), allocatable, intent(out) :: tables(:)
    type(error_t), allocatable, intent(inout) :: error
    character(:), allocatable :: messages(:)
    integer :: i, k

    allocate (tables(1 + size(places)))
    allocate (character(maxval([(len(outcomes(i)%message), i=1, size(outcomes))])) :: messages(size(outcomes)))
    do i = 1, size(outcomes)
      messages(i) = outcomes(i)%message
    end do
    tables(1)%name = 'rows'
    call tables(1)%begin('what came of each row of values', size(outcomes), error)
    if (allocated(error)) return
    call tables(1)%add('code', '', 'what went wrong: 0 is nothing, the others are those of a run', [outcomes%code])
    call tables(1)%add_words('message', 'the same in words', messages)
    do i = 1, merge(size(places), 0, allocated(selected))
      k = findloc(places%first == places(i)%first, .true., 1)
      associate (table => tables(1 + k), one => selected(i))
        if (.not. table%is_there()) then
          table%name = trim(places(i)%first)
          call table%begin('the rows of this table with the first row of values, then with the second, and so on', &
                           size(one%numbers), error)
        end if
        if (allocated(error)) return
        ! Integers are stored as reals, as a row without a result has NaN.
        call table%add_copy(one%column, reshape(one%numbers, [size(one%numbers)]))
      end associate
    end do
  end subroutine fill_tables
end module gearsweep_api_rows
