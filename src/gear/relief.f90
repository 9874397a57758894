!> Profile modification: tip relief as a profile error along the path of contact.
module gearsweep_gear_relief
  use gearsweep_base, only: code_input, dp, error_t, fail, piecewise_t, str
  implicit none
  private
  public :: relief_t, profile_error, tip_relief

  integer, parameter, public :: linear = 1, parabolic = 2

  !> Tip relief of both gears: it grows from `start` to the tip.
  type :: relief_t
    real(dp) :: amount(2) = 0                    !< amount at the tips of pinion and gear, m
    !> Path coordinate at the start of each relief: the pinion's extends from there to E, the gear's from there back to A.
    real(dp) :: start(2) = 0
    integer :: shape = linear
  end type relief_t

contains

  !> Computes the profile error e(s) of one pair (m), the material missing on both flanks. Source: Dogan et al. 2021, section 2.2;
  !> linear in the roll angle.
  pure subroutine profile_error(relief, contact_ratio, curve, error)
    type(relief_t), intent(in) :: relief
    real(dp), intent(in) :: contact_ratio
    type(piecewise_t), intent(out) :: curve
    type(error_t), allocatable, intent(out) :: error
    real(dp) :: middle(2)
    logical :: on_path(2)
    integer :: i

    if (any(.not. relief%amount >= 0)) call fail(error, code_input, &
      'amount of relief: must be at least 0')
    associate (s => relief%start)
      on_path = [s(1) >= 0 .and. s(1) < contact_ratio, s(2) > 0 .and. s(2) <= contact_ratio]
    end associate
    do i = 1, 2
      if (relief%amount(i) > 0 .and. .not. on_path(i)) call fail(error, code_input, 'relief: the '// &
        trim(merge('pinion', 'gear  ', i == 1))//'''s relief begins at '//str(relief%start(i))// &
        ' base pitches, off the path of contact (0 to '//str(contact_ratio)//')')
    end do
    if (allocated(error)) return

    middle = merge(relief%start, [contact_ratio, 0.0_dp], relief%amount > 0)
    curve%breaks = [0.0_dp, minval(middle), maxval(middle), contact_ratio]
    curve%breaks = [curve%breaks(1), pack(curve%breaks(2:), curve%breaks(2:) - curve%breaks(:3) > 0)]
    allocate (curve%coef(0:2, size(curve%breaks) - 1))
    curve%coef = 0
    if (relief%amount(1) > 0) call add(curve, relief%start(1), contact_ratio, relief%amount(1), relief%shape)
    if (relief%amount(2) > 0) call add(curve, relief%start(2), 0.0_dp, relief%amount(2), relief%shape)
  end subroutine profile_error

  !> Relief (m) of a gear's flank at its contact at path coordinate `s`; beyond its tip, that of the tip.
  elemental real(dp) function tip_relief(relief, contact_ratio, gear, s)
    type(relief_t), intent(in) :: relief
    real(dp), intent(in) :: contact_ratio, s
    integer, intent(in) :: gear
    real(dp) :: part

    tip_relief = 0
    if (.not. relief%amount(gear) > 0) return
    part = (s - relief%start(gear))/(merge(contact_ratio, 0.0_dp, gear == 1) - relief%start(gear))
    part = min(1.0_dp, max(0.0_dp, part))
    tip_relief = relief%amount(gear)*merge(part, part**2, relief%shape == linear)
  end function tip_relief

  !> Adds one gear's relief to the pieces between `start` and its `tip`.
  pure subroutine add(curve, start, tip, amount, shape)
    type(piecewise_t), intent(inout) :: curve
    real(dp), intent(in) :: start, tip, amount
    integer, intent(in) :: shape
    real(dp) :: centre, half, base, rise
    integer :: i

    do i = 1, size(curve%coef, 2)
      centre = (curve%breaks(i) + curve%breaks(i + 1))/2
      half = (curve%breaks(i + 1) - curve%breaks(i))/2
      base = (centre - start)/(tip - start)
      rise = half/(tip - start)
      if (base < 0) cycle
      if (shape == linear) then
        curve%coef(0:1, i) = curve%coef(0:1, i) + amount*[base, rise]
      else
        curve%coef(:, i) = curve%coef(:, i) + amount*[base**2, 2*base*rise, rise**2]
      end if
    end do
  end subroutine add
end module gearsweep_gear_relief
