!> What numbers a key allows, and the same in words.
module gearsweep_bounds
  use gearsweep_kinds, only: dp
  use gearsweep_text, only: str
  implicit none
  private
  public :: bounds_t, bound_real, bound_integer

  type :: bounds_t
    logical :: whole = .false.                   !< integers only
    real(dp) :: low = -huge(1.0_dp), high = huge(1.0_dp)
    logical :: low_is_out = .false., high_is_out = .false.
    character(12) :: unit = ''                   !< of the numbers
  contains
    procedure :: allow, describe, describe_range
  end type bounds_t

contains

  !> At most one lower and one upper bound.
  pure subroutine bound_real(bounds, unit, above, at_least, below, at_most)
    type(bounds_t), intent(out) :: bounds
    character(*), intent(in) :: unit
    real(dp), intent(in), optional :: above, at_least, below, at_most

    bounds%unit = unit
    bounds%low_is_out = present(above)
    bounds%high_is_out = present(below)
    if (present(above)) bounds%low = above
    if (present(at_least)) bounds%low = at_least
    if (present(below)) bounds%high = below
    if (present(at_most)) bounds%high = at_most
  end subroutine bound_real

  pure subroutine bound_integer(bounds, at_least, at_most)
    type(bounds_t), intent(out) :: bounds
    integer, intent(in), optional :: at_least, at_most

    bounds%whole = .true.
    if (present(at_least)) bounds%low = at_least
    if (present(at_most)) bounds%high = at_most
  end subroutine bound_integer

  pure logical function allow(self, number)
    class(bounds_t), intent(in) :: self
    real(dp), intent(in) :: number

    allow = .not. (number < self%low .or. number > self%high &
      & .or. (self%low_is_out .and. number <= self%low) &
      & .or. (self%high_is_out .and. number >= self%high))
  end function allow

  !> As in `above 0 and at most 1000`; without bounds, the kind of number.
  pure subroutine describe(self, words, farthest)
    class(bounds_t), intent(in) :: self
    character(:), allocatable, intent(out) :: words
    real(dp), intent(in), optional :: farthest   !< of the bounds that are told; without it, all
    real(dp) :: most

    most = huge(most)
    if (present(farthest)) most = farthest
    words = ''
    if (self%low > -most) words = trim(merge('above   ', 'at least', self%low_is_out))//' '//str(self%low, 12)
    if (self%high < most) then
      if (len(words) > 0) words = words//' and '
      words = words//trim(merge('below  ', 'at most', self%high_is_out))//' '//str(self%high, 12)
    end if
    if (len(words) == 0) words = trim(merge('an integer', 'a number  ', self%whole))
  end subroutine describe

  !> The same for a table, as in `0.001 to 1000` or `above 3, below 45`; empty without bounds.
  pure subroutine describe_range(self, words)
    class(bounds_t), intent(in) :: self
    character(:), allocatable, intent(out) :: words
    logical :: has_low, has_high

    has_low = self%low > -huge(self%low)
    has_high = self%high < huge(self%high)
    words = ''
    if (has_low .and. has_high .and. .not. (self%low_is_out .or. self%high_is_out)) then
      words = trim(in_short(self%low))//' to '//trim(in_short(self%high))
      return
    end if
    if (has_low) words = trim(merge('above   ', 'at least', self%low_is_out))//' '//trim(in_short(self%low))
    if (has_low .and. has_high) words = words//', '
    if (has_high) words = words//trim(merge('below  ', 'at most', self%high_is_out))//' '//trim(in_short(self%high))
  end subroutine describe_range

  !> As in 0.001, 100000 or 1e9.
  pure function in_short(number) result(words)
    real(dp), intent(in) :: number
    character(20) :: words
    integer :: power

    words = str(number, 12)
    if (abs(number) < 1e6_dp) return
    power = nint(log10(abs(number)))
    if (abs(abs(number) - 10.0_dp**power) > 0) return
    words = '1e'//str(power)
    if (number < 0) words = '-'//words
  end function in_short
end module gearsweep_bounds
