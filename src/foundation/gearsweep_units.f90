!> The units in which numbers come in and go out. Everything in between is in SI units, with angles in radians.
module gearsweep_units
  use gearsweep_kinds, only: dp, pi
  implicit none
  private
  public :: in_si, is_unit

  character(8), parameter :: names(*) = [character(8) :: '', 'mm', 'um', 'deg', 'GPa', 'N/um', 'um/N', 'N/mm', &
                                         'mm/s', '1/min', 'N', 'N m', 'kg', 'kg m^2', 'kg/m^3', 'mPa s', 'MPa', &
                                         '1/GPa', 'W/(m K)', 'J/(kg K)', 's', '1/s', 'h', 'Hz', &
                                         '1/min/s']
  !> Of a speed of rotation nothing is converted: it stays in revolutions per minute.
  real(dp), parameter :: values(size(names)) = [1.0_dp, 1e-3_dp, 1e-6_dp, pi/180, 1e9_dp, 1e6_dp, 1e-6_dp, 1e3_dp, &
                                                1e-3_dp, 1.0_dp, 1.0_dp, 1.0_dp, 1.0_dp, 1.0_dp, 1.0_dp, 1e-3_dp, 1e6_dp, 1e-9_dp, &
                                                1.0_dp, 1.0_dp, 1.0_dp, 1.0_dp, 3600.0_dp, 1.0_dp, 1.0_dp]

contains

  !> What one of this unit is in SI units; 1 for one that is not listed here.
  pure real(dp) function in_si(unit)
    character(*), intent(in) :: unit
    integer :: at

    at = findloc(names, unit, 1)
    in_si = 1
    if (at > 0) in_si = values(at)
  end function in_si

  !> Is this unit listed here? An empty one stands for a plain number.
  pure logical function is_unit(unit)
    character(*), intent(in) :: unit

    is_unit = any(names == unit)
  end function is_unit
end module gearsweep_units
