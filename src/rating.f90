!> Strength: root stress under the load, ISO 6336, Lewis, life, losses.
!>
!> Other rooms use this module, and none of the room's own modules.
module gearsweep_rating
  ! Closed forms of a loaded tooth.
  use gearsweep_rating_beam, only: beam_t, formula_deflection, formula_deflection_t, formula_relief, hassan_shape
  ! Dynamic factor K_v by ISO 6336-1, Method B.
  use gearsweep_rating_dynamic_factor, only: counted_relief, deviations_of, dynamic_factor_a, dynamic_factor_b, grade_of, &
    method_b_t, no_grade, resonance_ratio
  ! Flank contact.
  use gearsweep_rating_flank, only: contact_stress, contact_t, flank_contact, flank_factors, flank_factors_t, load_factors_t, &
    nominal_flank_stress, rim_factor, root_face_load_factor, surfaces_t, tooth_root_stress
  ! Form factors of the tooth root from its true shape.
  use gearsweep_rating_form, only: deep_tooth_factor, iso_form, iso_form_t, lewis_factor, nominal_root_stress, &
    outer_single_contact
  ! Allowable stress numbers of common gear materials by quality grade, and their life factors.
  use gearsweep_rating_gear_materials, only: common_names, contact_life_curve, contact_number, gear_materials, grades, &
    life_curve_t, life_curve_words, life_factor, material_length, root_life_curve, root_number, sn_curve, test_gear_correction
  ! Power loss by friction in the mesh.
  use gearsweep_rating_mesh_losses, only: even_load_factor, followed_loss_factor, friction_rule_t, half_shares_factor, &
    mean_friction, static_loss_factor
  ! Nominal contact and tooth root stress by ISO 6336, and their factors.
  use gearsweep_rating_nominal_stress, only: nominal_of, nominal_t
  ! Passage of the load over a tooth.
  use gearsweep_rating_passage, only: load_places, pass_path, pass_static, passage_options_t, passage_t, place_radius
  ! Fatigue life of the tooth root under the loads of a pair over its path of contact.
  use gearsweep_rating_root_life, only: by_gerber, by_goodman, by_iso, by_soderberg, curve_t, damage_of, root_history, root_life, &
    root_life_t, strength_t
  ! Root stress over the path of contact under the actual load of each pair.
  use gearsweep_rating_root_rating, only: find_stress_field, load_positions, load_radius, outer_point, rate_root, root_options_t, &
    root_rating_t, shared_by_mesh, shared_equally, shares_stated, spaced_on_flank, spaced_on_path, stress_field_t
  ! Stress and displacement at a tooth's fillets while the load passes over it, by modal superposition on two grids.
  use gearsweep_rating_tooth_transient, only: damp_modes, damping_t, follow_tooth, sampling_t, tooth_transient_t
  implicit none
  public
end module gearsweep_rating
