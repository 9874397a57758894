!> Reader, case, stages of a run and tasks: from the text of a case to its tables.
!>
!> Other rooms use this module, and none of the room's own modules.
module gearsweep_study
  ! The case.
  use gearsweep_study_case_case, only: case_t
  ! Checks of combinations of the keys of a case.
  use gearsweep_study_case_case_checks, only: add_length_cautions, check_case
  ! Keys of the load over the face width.
  use gearsweep_study_case_face_keys, only: read_face
  ! Keys of the gears.
  use gearsweep_study_case_gear_keys, only: read_direction, read_gear, read_materials, read_pair, read_section
  ! Keys of mesh and motion.
  use gearsweep_study_case_mesh_keys, only: read_dynamics, read_load, read_model, read_numerics, read_path, read_relief, &
    read_sweep
  ! Interface between a case and a task.
  use gearsweep_study_case_task, only: case_facts_t, check_reliefs, gear_names, split_names, stage, stage_words, table_length, &
    task_info_t, task_length, task_slot_t, task_t
  ! Changes one key in the text of a case; all other text, comments included, remains unchanged.
  use gearsweep_study_reader_edit, only: change_key, change_keys
  ! Keys of a format.
  use gearsweep_study_reader_keys, only: key_t, keys_t, kind_logical, kind_number, kind_text
  ! Splits Fortran namelist text into groups, keys and values.
  use gearsweep_study_reader_namelist, only: name_length, namelist_t, parse_namelist
  ! Reads typed values from namelist text, each with its unit, its bounds and one clear error.
  use gearsweep_study_reader_reader, only: first_nonblank, is_prescribed, needs_gears, open_list, open_reader, reader_t, &
    sentence_length, text_unless
  ! Reads the values of a namelist entry as numbers, words and texts, with one clear error.
  use gearsweep_study_reader_values, only: shortest_digits
  ! Report for the screen.
  use gearsweep_study_results_report, only: failed_points, write_report
  ! Results of the tasks of a study, by the names of tables and columns.
  use gearsweep_study_results_results, only: column_of, get_result, published_table
  ! Variation of a case by its numbers.
  use gearsweep_study_run_case_variation, only: case_variation_t, number_names, number_units, relief_start, vary_amount, &
    vary_backlash, vary_damping, vary_force, vary_friction, vary_mass, vary_profile, vary_relief, vary_rpm, vary_start, &
    vary_stiffness
  ! Files and folders by name.
  use gearsweep_study_run_files, only: check_folder, check_name, fail_system, file_set_t, folder_of, make_folder, read_text, &
    remove_folder
  ! Cache keys of the stages of a study.
  use gearsweep_study_run_inputs, only: motions_inputs_t
  ! Texts, limits and helpers of the tables of several tasks.
  use gearsweep_study_run_points, only: add_seen, known_count, of_coast, of_dte_estimate, &
    of_dte_range, of_dte_rms, of_estimate, of_factor, of_motions, of_periods, of_relief, of_speed, of_status, status_length, &
    words_of
  ! Products of the stages that several tasks use, the section of a gear among them, and the type of a task that can be run.
  use gearsweep_study_run_stages, only: runnable_t, stages_t, study_t
  ! A study: from a case to its results, stage by stage.
  use gearsweep_study_run_study, only: run_study
  ! The task `deflection_relief`.
  use gearsweep_study_tasks_deflection_relief, only: deflection_relief_task_t
  ! The task `face_load`.
  use gearsweep_study_tasks_face_load, only: face_load_task_t
  ! The task `flank`.
  use gearsweep_study_tasks_flank, only: flank_task_t
  ! The task `geometry`.
  use gearsweep_study_tasks_geometry, only: geometry_task_t
  ! The task `harmonic`.
  use gearsweep_study_tasks_harmonic, only: harmonic_task_t
  ! The task `life`.
  use gearsweep_study_tasks_life, only: life_task_t
  ! The task `load`.
  use gearsweep_study_tasks_load, only: load_task_t
  ! The task `mesh`.
  use gearsweep_study_tasks_mesh, only: mesh_task_t
  ! The task `modal`.
  use gearsweep_study_tasks_modal, only: modal_task_t
  ! The task `optimum`.
  use gearsweep_study_tasks_optimum, only: optimum_task_t
  ! The task `precision`.
  use gearsweep_study_tasks_precision, only: precision_task_t
  ! The task `rating`.
  use gearsweep_study_tasks_rating, only: rating_task_t
  ! The task `static`.
  use gearsweep_study_tasks_static, only: static_task_t
  ! The task `sweep`.
  use gearsweep_study_tasks_sweep, only: sweep_task_t
  ! The task `transient`.
  use gearsweep_study_tasks_transient, only: transient_task_t
  implicit none
  public
end module gearsweep_study
