!> gearsweep: how a spur-gear pair behaves. The public nouns and verbs.
!>
!>     use gearsweep, only: case_t, study_t, error_t, read_case, run_study, write_report
!>     type(case_t) :: case
!>     type(study_t) :: study
!>     type(error_t), allocatable :: error
!>     call read_case(text, case, error)                 ! text: the namelist case
!>     if (.not. allocated(error)) call run_study(case, '', 0, study, error)
!>     if (.not. allocated(error)) call write_report(study, answer)
!>     factor = column_of(study, 'sweep', 'dynamic_factor')    ! numbers by the names of table and column
!>
!> Nothing here prints or stops; an allocated `error` means that a call failed.
!> The modules behind it can be used by themselves, stage by stage.
module gearsweep
  use gearsweep_base, only: code_file, code_input, code_memory, code_numerical, code_ok, code_partial, code_usage, column_t, dp, &
    error_t, kind_integer, kind_real, kind_text, table_t, version
  use gearsweep_gear, only: add_corners, coast, corner_contact, corner_reach, corner_t, drive, free_centre_distance, gear_spec_t, &
    gear_t, linear, make_gear, make_pair, pair_t, parabolic, profile_error, relief_t, tip_alteration
  use gearsweep_elastic, only: disc_t, fe_options_t, fe_stiffness, make_section, make_two_grids, material_t, modal_t, root_stress, &
    root_stress_t, section_body_t, section_modes, section_options_t, section_t, vtu_field_t, write_vtu
  use gearsweep_mesh, only: find_harmonics, harmonics_t, iso_stiffness, mesh_t, polynomial_stiffness, share_load, sharing_t, &
    table_stiffness, weber_stiffness
  use gearsweep_face, only: alignment_t, face_load_t, face_mesh_t, find_face_load, lead_t, make_face_mesh
  use gearsweep_motion, only: accuracy_t, attractor_options_t, attractor_t, attractors_t, branch_options_t, branch_t, change_t, &
    down, each, find_attractors, find_optimum, find_resonances, find_response, follow_branch, make_oscillator, optimum_t, &
    oscillator_t, peak_t, response_t, run_sweep, sample_section, section_points_t, sweep_options_t, sweep_t, up
  use gearsweep_rating, only: beam_t, hassan_shape, iso_form, iso_form_t, lewis_factor, rate_root, root_options_t, root_rating_t
  use gearsweep_study, only: case_t, column_of, failed_points, run_study, study_t, write_report
  use gearsweep_nonlinear, only: find_tongues, map_stability, stability_t, tongue_t
  use gearsweep_api, only: make_table, read_case, table_names, write_table
  implicit none
  public
end module gearsweep
