!> The values of a namelist entry as numbers, words and texts, with one clear error.
module gearsweep_values
  use gearsweep_bounds, only: bounds_t
  use gearsweep_error, only: code_input, error_t, fail
  use gearsweep_kinds, only: dp
  use gearsweep_namelist, only: entry_t, value_t
  use gearsweep_sorting, only: sorted
  use gearsweep_text, only: closest_word, join, lower, shown, str, to_number
  implicit none
  private
  public :: read_numbers, tell_number, read_logical, read_texts, check_size, check_sizes, check_distinct, &
            describe_texts, fail_entry

contains

  !> All values of the entry as numbers within bounds, times `scale`.
  pure subroutine read_numbers(entry, bounds, numbers, error, scale)
    type(entry_t), intent(in) :: entry
    type(bounds_t), intent(in) :: bounds
    real(dp), allocatable, intent(out) :: numbers(:)
    type(error_t), allocatable, intent(inout) :: error
    real(dp), intent(in), optional :: scale
    integer :: i

    if (allocated(error)) return
    if (entry%bare_commas > 0 .and. entry%bare_blanks > 0) &
      call fail_entry(entry, 'has commas without a blank beside blanks without a comma: decimals take a point, as in 0.5, 10.5', &
                      error)
    allocate (numbers(size(entry%values)))
    if (size(numbers) > 2 .and. mod(size(numbers), 2) == 0 .and. entry%paired == size(numbers) - 1) &
      call fail_entry(entry, 'has pairs with a comma and no blank: decimals take a point, as in 0.5, 10.5', error)
    if (allocated(error)) return
    do i = 1, size(numbers)
      call read_number(entry%values(i), bounds, numbers(i), error, entry)
      if (allocated(error)) return
    end do
    if (.not. present(scale)) return
    if (any(abs(numbers) > huge(scale)/max(1.0_dp, abs(scale)))) then
      call fail_entry(entry, 'is too large', error)
    else
      numbers = numbers*scale
    end if
  end subroutine read_numbers

  pure subroutine read_number(value, bounds, number, error, entry)
    type(value_t), intent(in) :: value
    type(bounds_t), intent(in) :: bounds
    real(dp), intent(out) :: number
    type(error_t), allocatable, intent(inout) :: error
    type(entry_t), intent(in) :: entry
    character(:), allocatable :: rule
    integer :: whole
    logical :: ok

    if (bounds%whole) then
      call to_number(value%text, whole, ok)
      number = whole
    else
      call to_number(value%text, number, ok)
    end if
    if (.not. ok .or. value%quoted) then
      call fail_entry(entry, 'must be '//trim(merge('an integer', 'a number  ', bounds%whole)), error)
    else if (.not. bounds%allow(number)) then
      call bounds%describe(rule)
      ! A length in metres is a likely slip.
      if (bounds%unit == 'mm' .and. number > 0 .and. bounds%allow(1000*number)) &
        rule = rule//'; if '//str(number)//' m is meant, write '//str(1000*number)
      call fail_entry(entry, 'must be '//rule, error)
    end if
  end subroutine read_number

  !> What `read_numbers` with this `scale` reads as `value`, bit for bit, in as few digits as do; `number` is
  !> that in the key's unit. `found` is false where no number in this unit gives the value.
  pure subroutine tell_number(value, scale, words, number, found)
    real(dp), intent(in) :: value, scale
    character(30), intent(out) :: words
    real(dp), intent(out) :: number
    logical, intent(out) :: found
    ! The quotient is rounded, and what is sought was, too: it lies at most two numbers away.
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
  end subroutine tell_number

  !> Does `x` in so many digits read as `value`?
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
    ! No difference, which could be of an unrounded product.
    back = number*scale
    found = .not. (back < value .or. back > value)
  end subroutine try_digits

  !> `.true.`, `true`, `T` and the same for false.
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

  !> All values of the entry as texts, padded with blanks to the longest; with `allowed`, these words
  !> in any case, returned in lower case. Bare words pass where they are allowed ones: they cannot
  !> mean anything else.
  pure subroutine read_texts(entry, texts, error, allowed)
    type(entry_t), intent(in) :: entry
    character(:), allocatable, intent(inout) :: texts(:)
    type(error_t), allocatable, intent(inout) :: error
    character(*), intent(in), optional :: allowed(:)
    character(:), allocatable :: rule
    logical :: ok
    integer :: i, longest, closest

    if (allocated(error)) return
    do i = 1, size(entry%values)
      ok = entry%values(i)%quoted
      if (present(allowed)) ok = any(lower_all(allowed) == lower(entry%values(i)%text))
      if (ok) cycle
      call describe_texts(rule, allowed)
      closest = 0
      if (present(allowed)) closest = closest_word(lower(entry%values(i)%text), allowed)
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

  pure function lower_all(words) result(small)
    character(*), intent(in) :: words(:)
    character(len(words)) :: small(size(words))
    integer :: i

    do i = 1, size(words)
      small(i) = lower(words(i))
    end do
  end function lower_all

  !> What texts must be.
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

  !> `numbers`: those of the entry, none of which may be there twice.
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

  !> `&group key = values: why`
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
end module gearsweep_values
