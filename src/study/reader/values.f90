!> Reads the values of a namelist entry as numbers, words and texts, with one clear error.
module gearsweep_study_reader_values
  use gearsweep_base, only: closest_word, code_input, dp, error_t, fail, find_odd, join, lower, shown, sorted, str, to_number
  use gearsweep_study_reader_keys, only: bounds_t
  use gearsweep_study_reader_namelist, only: entry_t
  use gearsweep_study_reader_unit_slips, only: other_unit
  implicit none
  private
  public :: read_numbers, shortest_digits, read_logical, read_texts, check_size, check_sizes, check_distinct, &
            describe_texts, fail_entry

contains

  !> Reads all values of the entry as numbers within bounds, times `scale`.
  pure subroutine read_numbers(entry, bounds, numbers, error, scale)
    type(entry_t), intent(in) :: entry
    type(bounds_t), intent(in) :: bounds
    real(dp), allocatable, intent(out) :: numbers(:)
    type(error_t), allocatable, intent(inout) :: error
    real(dp), intent(in), optional :: scale
    integer :: i
    character(:), allocatable :: rule, meant
    logical :: ok

    if (allocated(error)) return
    if (entry%bare_commas > 0 .and. entry%bare_blanks > 0) &
      call fail_entry(entry, 'has commas without a blank beside blanks without a comma: decimals take a point, as in 0.5, 10.5', &
                      error)
    allocate (numbers(size(entry%values)))
    if (size(numbers) > 2 .and. mod(size(numbers), 2) == 0 .and. entry%paired == size(numbers) - 1) &
      call fail_entry(entry, 'has pairs with a comma and no blank: decimals take a point, as in 0.5, 10.5', error)
    if (allocated(error)) return
    do i = 1, size(numbers)
      ! Data frames write whole numbers as 21.0.
      call to_number(entry%values(i)%text, numbers(i), ok)
      if (bounds%is_integer .and. ok) ok = abs(numbers(i)) <= huge(1) .and. abs(numbers(i) - anint(numbers(i))) <= 0
      if (.not. ok .or. entry%values(i)%quoted) then
        call fail_entry(entry, 'must be '//trim(merge('an integer', 'a number  ', bounds%is_integer)), error)
      else if (.not. bounds%allow(numbers(i))) then
        call bounds%describe(rule)
        call other_unit(entry%key, trim(bounds%unit), bounds, numbers(i), meant)
        call fail_entry(entry, 'must be '//rule//meant, error)
      end if
      if (allocated(error)) return
    end do
    if (.not. present(scale)) return
    if (any(abs(numbers) > huge(scale)/max(1.0_dp, abs(scale)))) then
      call fail_entry(entry, 'is too large', error)
    else
      numbers = numbers*scale
    end if
  end subroutine read_numbers

  !> Writes the shortest digits that `read_numbers` with this `scale` reads as `value`, bit for bit; `number` is the number in the
  !> key's unit. `found` is false if no number in this unit reads as the value.
  pure subroutine shortest_digits(value, scale, words, number, found)
    real(dp), intent(in) :: value, scale
    character(30), intent(out) :: words
    real(dp), intent(out) :: number
    logical, intent(out) :: found
    ! The quotient is rounded, and so was the value: the number is at most two floating-point numbers away.
    integer, parameter :: away = 2, fewest = 6, most = 17
    real(dp) :: near(-away:away)
    integer :: digits, i

    near(0) = value/scale
    do i = 1, away
      near(i) = nearest(near(i - 1), 1.0_dp)
      near(-i) = nearest(near(1 - i), -1.0_dp)
    end do
    do digits = fewest, most
      do i = 0, merge(away, 0, digits == most)
        call try_digits(near(i), digits, value, scale, words, number, found)
        if (.not. found) call try_digits(near(-i), digits, value, scale, words, number, found)
        if (found) return
      end do
    end do
  end subroutine shortest_digits

  !> Tests if `x` in so many digits reads as `value`.
  pure subroutine try_digits(x, digits, value, scale, words, number, found)
    real(dp), intent(in) :: x, value, scale
    integer, intent(in) :: digits
    character(30), intent(out) :: words
    real(dp), intent(out) :: number
    logical, intent(out) :: found
    real(dp) :: back

    words = str(x, digits)
    call to_number(trim(words), number, found)
    if (.not. found) return
    ! No difference is formed, as a compiler may use the unrounded product in it.
    back = number*scale
    found = .not. (back < value .or. back > value)
  end subroutine try_digits

  !> Reads `.true.`, `true`, `T` and the same for false.
  pure subroutine read_logical(entry, value, error)
    type(entry_t), intent(in) :: entry
    logical, intent(inout) :: value
    type(error_t), allocatable, intent(inout) :: error
    character(*), parameter :: yes(*) = [character(7) :: '.true.', 'true', '.t.', 't']
    character(*), parameter :: no(*) = [character(7) :: '.false.', 'false', '.f.', 'f']

    if (allocated(error)) return
    associate (word => entry%values(1))
      if (word%quoted .or. all([yes, no] /= lower(word%text))) then
        call fail_entry(entry, 'must be .true. or .false.', error)
      else
        value = any(yes == lower(word%text))
      end if
    end associate
  end subroutine read_logical

  !> Reads all values of the entry as texts, padded with blanks to the longest; with `allowed`, these words in any case, returned in
  !> lower case. Allowed words need no quotes, as they are unambiguous.
  pure subroutine read_texts(entry, texts, error, allowed)
    type(entry_t), intent(in) :: entry
    character(:), allocatable, intent(inout) :: texts(:)
    type(error_t), allocatable, intent(inout) :: error
    character(*), intent(in), optional :: allowed(:)
    character(:), allocatable :: rule, odd
    logical :: ok
    integer :: i, longest, closest

    if (allocated(error)) return
    do i = 1, size(entry%values)
      ok = entry%values(i)%quoted
      if (present(allowed)) ok = any(lower_all(allowed) == lower(entry%values(i)%text))
      if (ok) cycle
      call describe_texts(rule, allowed)
      closest = 0
      call find_odd(entry%values(i)%text, odd, alike=.true.)
      if (len(odd) > 0) call fail_entry(entry, odd, error)
      if (present(allowed)) closest = closest_meaning(lower(entry%values(i)%text), allowed)
      if (closest > 0) rule = rule//' (did you mean '//trim(allowed(closest))//'?)'
      call fail_entry(entry, 'must be '//rule, error)
      return
    end do
    if (allocated(texts)) deallocate (texts)
    longest = maxval([(len(entry%values(i)%text), i=1, size(entry%values))])
    allocate (character(longest) :: texts(size(entry%values)))
    do i = 1, size(texts)
      texts(i) = entry%values(i)%text
      if (present(allowed)) texts(i) = lower(texts(i))
    end do
  end subroutine read_texts

  !> Index of the closest word, or of the word whose meaning a short term of the field names; 0 for none.
  pure integer function closest_meaning(word, words) result(at)
    character(*), intent(in) :: word, words(:)

    select case (word)
    case ('ste', 'transmission_error')
      at = findloc(words == 'mesh', .true., 1)
    case ('dte', 'df', 'dynamic_factor')
      at = findloc(words == 'sweep', .true., 1)
    case default
      at = 0
    end select
    if (at == 0) at = closest_word(word, words)
  end function closest_meaning

  pure function lower_all(words) result(small)
    character(*), intent(in) :: words(:)
    character(len(words)) :: small(size(words))
    integer :: i

    do i = 1, size(words)
      small(i) = lower(words(i))
    end do
  end function lower_all

  !> Describes the rule for texts.
  pure subroutine describe_texts(rule, allowed)
    character(:), allocatable, intent(out) :: rule
    character(*), intent(in), optional :: allowed(:)

    rule = 'a text in quotes'
    if (.not. present(allowed)) return
    rule = ''''//join(allowed, ''', ''')//''''
    if (size(allowed) > 1) rule = 'one of '//rule
  end subroutine describe_texts

  pure subroutine check_size(entry, what, error)
    type(entry_t), intent(in) :: entry
    character(*), intent(in) :: what
    type(error_t), allocatable, intent(inout) :: error
    character(:), allocatable :: why

    if (size(entry%values) == 1) return
    why = 'must be a single '//what
    if (size(entry%values) == 2 .and. entry%bare_commas == 1) why = why//'; decimals take a point'
    call fail_entry(entry, why, error)
  end subroutine check_size

  pure subroutine check_sizes(entry, what, error, min_size, max_size)
    type(entry_t), intent(in) :: entry
    character(*), intent(in) :: what
    type(error_t), allocatable, intent(inout) :: error
    integer, intent(in), optional :: min_size, max_size

    if (present(min_size)) then
      if (size(entry%values) < min_size) &
        & call fail_entry(entry, 'must be at least '//str(min_size)//' '//what, error)
    end if
    if (present(max_size)) then
      if (size(entry%values) > max_size) &
        & call fail_entry(entry, 'must be at most '//str(max_size)//' '//what, error)
    end if
  end subroutine check_sizes

  !> Refuses equal values; `numbers`: those of the entry.
  pure subroutine check_distinct(entry, numbers, error)
    type(entry_t), intent(in) :: entry
    real(dp), intent(in) :: numbers(:)
    type(error_t), allocatable, intent(inout) :: error
    real(dp) :: list(size(numbers))
    integer :: i, at

    if (allocated(error)) return
    list = sorted(numbers)
    do i = 2, size(list)
      if (list(i) > list(i - 1)) cycle
      at = minloc(abs(numbers - list(i)), 1)
      call fail_entry(entry, entry%values(at)%text//' is given twice', error)
      return
    end do
  end subroutine check_distinct

  !> Fails with `&group key = values: why`.
  pure subroutine fail_entry(entry, why, error)
    type(entry_t), intent(in) :: entry
    character(*), intent(in) :: why
    type(error_t), allocatable, intent(inout) :: error
    integer, parameter :: enough = 100
    character(:), allocatable :: values
    integer :: i

    values = ''
    do i = 1, size(entry%values)
      if (i > 1) values = values//', '
      associate (value => entry%values(i))
        if (value%quoted) then
          values = values//''''//value%text//''''
        else
          values = values//value%text
        end if
      end associate
      if (len(values) > enough) exit
    end do
    call fail(error, code_input, '&'//shown(entry%group)//' '//shown(entry%key)//' = ' &
      & //shown(values)//': '//why)
  end subroutine fail_entry
end module gearsweep_study_reader_values
