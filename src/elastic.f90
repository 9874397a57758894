!> Finite elements of a gear body: compliance, root stress, natural modes; contact compliance of the flanks.
!>
!> Other rooms use this module, and none of the room's own modules.
module gearsweep_elastic
  ! Deflection of the body under all teeth in contact together, as numbers.
  use gearsweep_elastic_disc, only: disc_t
  ! Pair stiffness by finite elements.
  use gearsweep_elastic_fe_stiffness, only: fe_deflection, fe_stiffness, plane_compliance, plane_tooth_t, teeth_t
  ! Hertzian line contact.
  use gearsweep_elastic_flattening, only: check_contact, contact_half_width, flattening_t, surface_to_depth
  ! Mapped grids of eight-node quadrilaterals, from a lattice of points.
  use gearsweep_elastic_grid, only: grid_t, make_grid, no_element
  ! Inertia at the bore (shaft, coupling, motor) and the gear body that turns between it and the teeth.
  use gearsweep_elastic_hub, only: chain_frequencies, felt_twist
  ! Elastic material, steel by default, and the options of the finite elements of a gear section.
  use gearsweep_elastic_material, only: check_material, fe_options_t, harmonic_mean, material_t, on_second_grid, section_options_t
  ! Response of a body in its modes.
  use gearsweep_elastic_modal_response, only: find_peak, frequencies_around, load_history_t, motion_record_t, response_to, &
    superpose
  ! Natural frequencies and mode shapes of a gear section, with their discretisation error.
  use gearsweep_elastic_modes, only: modal_t, section_modes
  ! The eight-node quadrilateral of the serendipity family.
  use gearsweep_elastic_q8, only: gauss_place, gauss_weight
  ! Section of a gear, from one tooth to the complete gear.
  use gearsweep_elastic_section, only: append, assumed_bore_radius, fillet_run, make_section, make_two_grids, section_body_t, &
    section_t, stress_error_share
  ! Stress at the tooth root while the load moves over the flank, and stress at all nodes of a section for pictures.
  use gearsweep_elastic_stress, only: find_peaks, loaded_stress, peak_difference, root_stress, root_stress_t, stress_peak_t
  ! One tooth above its fillets' 60 degree points, as a block of a mapped grid.
  use gearsweep_elastic_tooth_block, only: make_tooth_block, tooth_block_t
  ! A loaded tooth of a section in its modes.
  use gearsweep_elastic_tooth_modes, only: along, find_tooth_modes, moved_x, moved_y, per_point, tooth_modes_t
  ! Grids and fields for ParaView and similar programs (VTK's unstructured XML format), as text.
  use gearsweep_elastic_vtu, only: vtu_field_t, vtu_start, write_vtu
  implicit none
  public
end module gearsweep_elastic
