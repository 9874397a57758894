!> gearsweep: how a spur-gear pair behaves. The public nouns and verbs.
!>
!>     use gearsweep, only: case_t, study_t, error_t, read_case, run_study, report
!>     type(case_t) :: case
!>     type(study_t) :: study
!>     type(error_t), allocatable :: error
!>     call read_case(text, case, error)                 ! text: the namelist case
!>     if (.not. allocated(error)) call run_study(case, '', 0, study, error)
!>     if (.not. allocated(error)) answer = report(study)
!>     factor = column_of(study, 'sweep', 'dynamic_factor')    ! numbers by the names of table and column
!>
!> Nothing here prints or stops; an allocated `error` means that a call failed.
!> The modules behind it can be used by themselves, stage by stage.
module gearsweep
  use gearsweep_kinds, only: dp
  use gearsweep_version, only: version
  use gearsweep_error, only: error_t, code_ok, code_input, code_usage, code_file, code_partial, code_numerical, code_memory
  use gearsweep_gear, only: gear_spec_t, gear_t, make_gear, drive, coast
  use gearsweep_pair, only: pair_t, make_pair, free_centre_distance, tip_alteration
  use gearsweep_relief, only: relief_t, profile_error, linear, parabolic
  use gearsweep_corner, only: corner_t, corner_contact, corner_reach, add_corners
  use gearsweep_material, only: material_t
  use gearsweep_stiffness, only: polynomial_stiffness, table_stiffness, iso_stiffness
  use gearsweep_weber, only: weber_stiffness
  use gearsweep_disc, only: disc_t
  use gearsweep_fe_stiffness, only: fe_options_t, fe_stiffness
  use gearsweep_section, only: section_options_t, section_t, make_section
  use gearsweep_section_body, only: section_body_t, make_two_grids
  use gearsweep_modal, only: modal_t, section_modes
  use gearsweep_stress, only: root_stress_t, root_stress
  use gearsweep_root_rating, only: root_options_t, root_rating_t, rate_root
  use gearsweep_beam, only: beam_t, hassan_shape
  use gearsweep_form, only: iso_form_t, iso_form, lewis_factor
  use gearsweep_vtu, only: vtu_field_t, vtu_text
  use gearsweep_mesh, only: mesh_t
  use gearsweep_sharing, only: sharing_t, share_load
  use gearsweep_harmonics, only: harmonics_t, find_harmonics
  use gearsweep_attractor_search, only: attractor_options_t
  use gearsweep_attractors, only: attractor_t, attractors_t, find_attractors
  use gearsweep_continuation, only: branch_t, change_t, branch_options_t, follow_branch
  use gearsweep_error_estimate, only: accuracy_t
  use gearsweep_optimum, only: optimum_t, peak_t, find_optimum, find_resonances
  use gearsweep_oscillator, only: oscillator_t, make_oscillator
  use gearsweep_poincare, only: section_points_t, sample_section
  use gearsweep_response, only: response_t, find_response
  use gearsweep_stability, only: stability_t, map_stability
  use gearsweep_sweep, only: sweep_t, sweep_options_t, run_sweep, each, up, down
  use gearsweep_tongues, only: tongue_t, find_tongues
  use gearsweep_case, only: case_t
  use gearsweep_case_reader, only: read_case
  use gearsweep_study, only: study_t, run_study
  use gearsweep_report, only: report, write_report, failed_points
  use gearsweep_table, only: table_t, column_t, kind_real, kind_integer, kind_text
  use gearsweep_tables, only: table_names, make_table, column_of, write_table
  implicit none
  public
end module gearsweep
