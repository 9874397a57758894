!> The units of keys and of tables' columns. The library computes in SI units, with angles in radians: the reader multiplies by the
!> unit of a key, and a table divides by the unit of a column.
module gearsweep_base_units
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use gearsweep_base_kinds, only: dp, pi
  implicit none
  private
  public :: in_si, in_unit, is_unit

  type :: unit_t
    character(9) :: name
    real(dp) :: in_si                            !< value of one in SI units
    !> Number of them in one SI unit, where a table multiplies by it, as powers of ten below one are not exact; 0: it divides.
    real(dp) :: per_si = 0
  end type unit_t

  !> Speeds of rotation are not converted: they stay in revolutions per minute.
  type(unit_t), parameter :: units(*) = [ &
    unit_t('', 1.0_dp), unit_t('mm', 1e-3_dp, 1e3_dp), unit_t('um', 1e-6_dp, 1e6_dp), unit_t('mm2', 1e-6_dp, 1e6_dp), &
    unit_t('deg', pi/180), unit_t('s', 1.0_dp), unit_t('ms', 1e-3_dp, 1e3_dp), unit_t('us', 1e-6_dp, 1e6_dp), &
    unit_t('h', 3600.0_dp), unit_t('1/s', 1.0_dp), unit_t('Hz', 1.0_dp), unit_t('1/min', 1.0_dp), unit_t('1/min/s', 1.0_dp), &
    unit_t('m/s', 1.0_dp), unit_t('mm/s', 1e-3_dp, 1e3_dp), unit_t('N', 1.0_dp), unit_t('N m', 1.0_dp), unit_t('W', 1.0_dp), &
    unit_t('MPa', 1e6_dp, 1e-6_dp), unit_t('sqrt(MPa)', 1e3_dp, 1e-3_dp), unit_t('GPa', 1e9_dp), unit_t('1/GPa', 1e-9_dp, 1e9_dp), &
    unit_t('mPa s', 1e-3_dp, 1e3_dp), unit_t('N/um', 1e6_dp), unit_t('um/N', 1e-6_dp, 1e6_dp), unit_t('um/m', 1e-6_dp, 1e6_dp), &
    unit_t('N/mm', 1e3_dp), unit_t('N/(mm um)', 1e9_dp, 1e-9_dp), unit_t('kg', 1.0_dp), unit_t('kg/mm', 1e3_dp, 1e-3_dp), &
    unit_t('kg m^2', 1.0_dp), unit_t('kg**-0.5', 1.0_dp), unit_t('kg/m^3', 1.0_dp), unit_t('K', 1.0_dp), &
    unit_t('W/(m K)', 1.0_dp), unit_t('J/(kg K)', 1.0_dp)]

contains

  !> Value of one of this unit in SI units; 1 for a unit that is not listed here.
  pure real(dp) function in_si(unit)
    character(*), intent(in) :: unit
    integer :: at

    at = place_of(unit)
    in_si = 1
    if (at > 0) in_si = units(at)%in_si
  end function in_si

  !> Numbers in this unit of values in SI units. A number that differs by rounding from a decimal of at most nine places becomes
  !> this decimal: a key's value returns as the user wrote it.
  pure function in_unit(values, unit) result(numbers)
    real(dp), intent(in) :: values(:)            !< in SI units
    character(*), intent(in) :: unit             !< must be listed here
    real(dp) :: numbers(size(values))
    real(dp), parameter :: places = 1e9_dp, largest = 1e6_dp
    type(unit_t) :: of
    real(dp) :: decimal
    integer :: i

    numbers = values
    of = units(place_of(unit))
    if (abs(of%in_si - 1) <= 0) return
    if (of%per_si > 0) then
      numbers = of%per_si*values
    else
      numbers = values/of%in_si
    end if
    do i = 1, size(numbers)
      if (ieee_is_nan(numbers(i))) cycle
      if (abs(numbers(i)) > largest) cycle
      decimal = anint(places*numbers(i))/places
      if (abs(decimal - numbers(i)) <= 2*spacing(numbers(i))) numbers(i) = decimal
    end do
  end function in_unit

  !> True if this unit is listed here. An empty one is that of a plain number.
  pure logical function is_unit(unit)
    character(*), intent(in) :: unit

    is_unit = place_of(unit) > 0
  end function is_unit

  !> Index of a unit; 0 for one that is not listed.
  pure integer function place_of(unit) result(at)
    character(*), intent(in) :: unit

    at = findloc(units%name == unit, .true., 1)
  end function place_of
end module gearsweep_base_units
