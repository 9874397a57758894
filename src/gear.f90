!> Racks, gears and pairs (ISO 21771), tooth profiles, tip relief, measures and flank tolerances (ISO 1328).
!>
!> Other rooms use this module, and none of the room's own modules.
module gearsweep_gear
  ! One spur or helical gear in its transverse section, as its basic rack generates it (ISO 21771, ISO 53).
  use gearsweep_gear_gear, only: gear_t, make_gear
  ! Measured flanks of one gear.
  use gearsweep_gear_measured_flanks, only: fit_flanks, flank_points_t, read_flank_points
  ! Measures of a gear.
  use gearsweep_gear_measures, only: check_pin, find_measures, find_tolerances, has_web, measures_t, solid_inertia, &
    tolerances_t, web_inertia
  ! Two gears in mesh.
  use gearsweep_gear_pair, only: free_centre_distance, make_pair, normal_section, pair_t, tip_alteration
  ! Tooth profile in the transverse section.
  use gearsweep_gear_profile, only: fillet_parameter, fillet_point, involute_point, root_angle, shown_outline
  ! The basic rack that generates a gear, and the fillet cut by its rounded tip, a trochoid (ISO 53, ISO 21771).
  use gearsweep_gear_rack, only: coast, corner_depth, drive, gear_spec_t, generating_shift, teeth_around, transverse_angle
  ! Profile modification.
  use gearsweep_gear_relief, only: linear, parabolic, profile_error, relief_t, tip_relief
  ! Contact of a tooth's tip corner before the path of contact and after it.
  use gearsweep_gear_tip_corner, only: add_corner_stiffness, add_corners, arm_change, contact_reach, corner_contact, corner_reach, &
    corner_t, touching_curvature
  implicit none
  public
end module gearsweep_gear
