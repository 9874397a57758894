!> What numbers a key allows, and the same in words.
module gearsweep_bounds
  use gearsweep_kinds, only: dp
  use gearsweep_text, only: str
  implicit none
  private
  public :: bounds_t, bound_real, bound_integer

  type :: bounds_t
    real(dp) :: low = -huge(1.0_dp), high = huge(1.0_dp)
    logical :: low_is_out = .false., high_is_out = .false.
    character(:), allocatable :: kind, rule
  contains
    procedure :: allow
  end type bounds_t

contains

  !> At most one lower and one upper bound; without any, the rule is the kind of number.
  pure subroutine bound_real(bounds, above, at_least, below, at_most)
    type(bounds_t), intent(out) :: bounds
    real(dp), intent(in), optional :: above, at_least, below, at_most

    bounds%kind = 'a number'
    bounds%rule = bounds%kind
    bounds%low_is_out = present(above)
    bounds%high_is_out = present(below)
    if (present(above)) call bound_low(bounds, above, 'above')
    if (present(at_least)) call bound_low(bounds, at_least, 'at least')
    if (present(below)) call bound_high(bounds, below, 'below')
    if (present(at_most)) call bound_high(bounds, at_most, 'at most')
  end subroutine bound_real

  pure subroutine bound_integer(bounds, at_least, at_most)
    type(bounds_t), intent(out) :: bounds
    integer, intent(in), optional :: at_least, at_most

    bounds%kind = 'an integer'
    bounds%rule = bounds%kind
    if (present(at_least)) call bound_low(bounds, real(at_least, dp), 'at least')
    if (present(at_most)) call bound_high(bounds, real(at_most, dp), 'at most')
  end subroutine bound_integer

  pure subroutine bound_low(bounds, low, words)
    type(bounds_t), intent(inout) :: bounds
    real(dp), intent(in) :: low
    character(*), intent(in) :: words

    bounds%low = low
    bounds%rule = words//' '//str(low, 12)
  end subroutine bound_low

  !> To be called after `bound_low`.
  pure subroutine bound_high(bounds, high, words)
    type(bounds_t), intent(inout) :: bounds
    real(dp), intent(in) :: high
    character(*), intent(in) :: words

    if (bounds%rule == bounds%kind) then
      bounds%rule = words//' '//str(high, 12)
    else
      bounds%rule = bounds%rule//' and '//words//' '//str(high, 12)
    end if
    bounds%high = high
  end subroutine bound_high

  pure logical function allow(self, number)
    class(bounds_t), intent(in) :: self
    real(dp), intent(in) :: number

    allow = .not. (number < self%low .or. number > self%high &
      & .or. (self%low_is_out .and. number <= self%low) &
      & .or. (self%high_is_out .and. number >= self%high))
  end function allow
end module gearsweep_bounds
