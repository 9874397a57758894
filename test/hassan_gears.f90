!> Gears of Hassan et al. 2009: module 25 mm, 125 mm wide; the rack tip radius is inferred.
module hassan_gears
  use gearsweep_base_error, only: error_t
  use gearsweep_gear_gear, only: gear_spec_t, gear_t, make_gear
  use gearsweep_base_kinds, only: dp, pi
  use gearsweep_gear_pair, only: make_pair, pair_t
  use gearsweep_elastic_section, only: section_options_t
  implicit none
  private
  public :: hassan_gear, hassan_pair, hassan_options

contains

  !> The pinion has 30 teeth, the gear 60.
  type(gear_t) function hassan_gear(teeth) result(gear)
    integer, intent(in) :: teeth
    type(error_t), allocatable :: error

    call make_gear(gear_spec_t('pinion', teeth, 0.025_dp, face_width=0.125_dp, rack_tip_radius=0.30_dp), gear, error)
    if (allocated(error)) error stop 'gear of hassan_gears'
  end function hassan_gear

  type(pair_t) function hassan_pair() result(pair)
    type(error_t), allocatable :: error

    call make_pair(hassan_gear(30), hassan_gear(60), 1.125_dp, pair, error)
    if (allocated(error)) error stop 'pair of hassan_gears'
  end function hassan_pair

  !> The paper's section of three teeth.
  type(section_options_t) function hassan_options(across) result(options)
    integer, intent(in) :: across

    options%half_angle = 17.5_dp*pi/180
    options%rim = 0.140625_dp
    options%elements_across = across
  end function hassan_options
end module hassan_gears
