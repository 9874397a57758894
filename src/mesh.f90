!> Stiffness of a pair of teeth, load sharing, static transmission error and mesh harmonics.
!>
!> Other rooms use this module, and none of the room's own modules.
module gearsweep_mesh
  ! Deviations of real teeth as profile errors on the line of action.
  use gearsweep_mesh_deviations, only: common_divisor, deviations_t, interval_t, length_of_turn, make_deviations, wave_t
  ! Flank deviations of one gear by ISO 1328, stated or drawn from a class, and the profile errors that follow.
  use gearsweep_mesh_flank_deviations, only: coast_pitch_position, draw_deviations, flank_deviations_t, frame_t, is_within, &
    place_deviations, make_frame, per_tooth, pitch_position, tooth_number
  ! Harmonics of the static transmission error.
  use gearsweep_mesh_harmonics, only: find_harmonics, find_orders, harmonics_t, static_range
  ! The gear mesh.
  use gearsweep_mesh_mesh, only: corner_uncertainty, coupling, mesh_of, mesh_t, own_corner_uncertainty
  ! Static load sharing over the mesh period.
  use gearsweep_mesh_sharing, only: balance_t, contact_intervals, load_share, segment_t, share_load, sharing_t, smooth_segments, &
    solve_equilibrium_at, transmission_error
  ! Smooth intervals of a mesh over its period, and the profile error of a prescribed mesh from a table.
  use gearsweep_mesh_smooth_intervals, only: intervals_of_period, profile_table, repeat_intervals, set_period, smooth_intervals
  ! Stiffness K(s) of one pair of teeth along the path of contact, full face width, in N/m.
  use gearsweep_mesh_stiffness, only: gear_blank_factor, iso_options_t, iso_stiffness, polynomial_stiffness, table_stiffness, &
    weber_stiffness
  implicit none
  public
end module gearsweep_mesh
