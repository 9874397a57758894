!> Gears of Dogan et al. 2021: module 3.18 mm, 25.4 mm wide, of the standard rack unless said.
module dogan_gears
  use gearsweep_base_error, only: error_t
  use gearsweep_gear_gear, only: gear_spec_t, gear_t, make_gear
  use gearsweep_base_kinds, only: dp, pi
  use gearsweep_gear_pair, only: make_pair, pair_t
  implicit none
  private
  public :: dogan_gear, dogan_pair

contains

  !> A gear. `bore`: radius, m; `angles`: pressure angles of the drive and the coast flank, degrees.
  type(gear_t) function dogan_gear(teeth, bore, angles) result(gear)
    integer, intent(in) :: teeth
    real(dp), intent(in), optional :: bore, angles(2)
    type(gear_spec_t) :: spec
    type(error_t), allocatable :: error

    spec = gear_spec_t('pinion', teeth, 0.00318_dp, face_width=0.0254_dp)
    if (present(bore)) spec%bore_radius = bore
    if (present(angles)) spec%pressure_angle = angles*pi/180
    ! Between steeper flanks there is no room for the standard's rounding.
    if (present(angles)) spec%rack_tip_radius = 0.1_dp
    call make_gear(spec, gear, error)
    if (allocated(error)) error stop 'gear of dogan_gears'
  end function dogan_gear

  !> Two of them without backlash.
  type(pair_t) function dogan_pair(teeth, bore, angles) result(pair)
    integer, intent(in) :: teeth(2)
    real(dp), intent(in), optional :: bore, angles(2)
    type(gear_t) :: gear(2)
    type(error_t), allocatable :: error

    gear(1) = dogan_gear(teeth(1), bore, angles)
    gear(2) = dogan_gear(teeth(2), bore, angles)
    call make_pair(gear(1), gear(2), sum(gear%reference_radius), pair, error)
    if (allocated(error)) error stop 'pair of dogan_gears'
  end function dogan_pair
end module dogan_gears
