!> Every input counts: changing a key's value changes an output by far more than rounding, or the answer names
!> the key as not used and not a bit of the output changes, or the key is refused. For every key, model and task; a task is run
!> to its end where no other key has changed as little of what it reads. And a run that takes over what it can from a study whose
!> case differs in one key gives bit for bit what a fresh one gives. One task alone: the test walk_ and its name.
module test_inputs
  use, intrinsic :: iso_c_binding, only: c_int
  use gearsweep_study_case_case, only: case_t
  use gearsweep_api_case_reader, only: read_case
  use gearsweep_base_error, only: code_input, error_t
  use gearsweep_study_run_files, only: read_text
  use gearsweep_base_kinds, only: dp
  use gearsweep_study_results_report, only: write_report
  use gearsweep_study_run_study, only: run_study, study_t
  use gearsweep_api_tables, only: table_names
  use gearsweep_study_case_task, only: stage, task_length, task_slot_t
  use gearsweep_api_tasks, only: list_task_names, list_tasks
  use test_support_reproducible, only: write_reproducible
  use test_support_testing, only: check_equal, check_true, new_folder, remove_folder, tally_t
  use test_support_changed_inputs, only: parts_apart, same_products
  implicit none
  private
  public :: run

  character, parameter :: lf = new_line('a')
  !> The stiffness by finite elements, behind the tasks in `is_reused`; how its line of a log begins.
  character(*), parameter :: by_elements = 'mesh: pair stiffness by model fe'
  logical, allocatable :: is_reused(:)            !< by tasks, and the stiffness: taken over from an earlier study, once at least
  !> Where the cases look for their stiffness tables.
  character(:), allocatable :: folder

  !> What is computed for the sake of these tasks shall not take long.
  character(*), parameter :: few = 'stability damping_count 4;stability tongues 2;poincare settling_periods 20;'// &
                                   'poincare kept_periods 10;hysteresis closeness 1e-2;attractors starts 2;'// &
                                   'branches first 17000;branches last 19000;branches seeds 1;branches points 10;'// &
                                   'branches most_periods 1;sensitivity rpm 20000;'// &
                                   'precision most_steps 50;'// &
                                   'precision most_samples 64;precision rpm 18000'

  !> A value that a case gives to a key; a blank one takes the key out.
  type :: setting_t
    character(20) :: group
    character(32) :: key
    character(60) :: value = ''
  end type setting_t

  !> What to change. `kind`: for gears (g), a prescribed mesh (p) or both (blank). `beside`: settings that
  !> it needs, in both cases that are compared; `only`: in the second one. As `group key value;`.
  type :: change_t
    type(setting_t) :: setting
    character :: kind = ' '
    character(260) :: beside = '', only = ''
    logical :: counted = .false.                 !< it changed something that a task reads
    character(:), allocatable :: parts           !< which, in the walk at hand
    integer :: count = 0                         !< how many parts; 0: nothing to run
    logical :: is_run = .false.                  !< in the walk at hand, to the end
  end type change_t

  type :: output_t
    character(:), allocatable :: case            !< as text
    character(:), allocatable :: text
    type(study_t) :: study
  end type output_t

contains

  subroutine run(t)
    type(tally_t), intent(inout) :: t
    type(change_t), allocatable :: changes(:)
    character(*), parameter :: models(5) = [character(10) :: 'weber', 'iso6336', 'polynomial', 'table', 'fe']
    integer, parameter :: costly(3) = [stage%mesh, stage%body, stage%solid]
    character(task_length), allocatable :: tasks(:)
    type(task_slot_t), allocatable :: slots(:)
    logical :: counted
    integer :: i, k

    call list_task_names(tasks)
    folder = new_folder()
    call write_stiffness(folder//'/1.csv', 400)
    call write_stiffness(folder//'/2.csv', 350)
    call write_error(folder//'/4.csv', 2)
    call write_error(folder//'/5.csv', 5)
    call write_flanks(folder//'/pinion6.csv', 21, 2)
    call write_flanks(folder//'/pinion7.csv', 21, 5)
    call write_flanks(folder//'/gear6.csv', 34, 2)
    call write_flanks(folder//'/gear7.csv', 34, 5)
    call list_changes(changes)
    call list_tasks(slots)
    is_reused = [(.false., i=0, size(slots))]
    if (t%wants('judge_changes')) call judge_changes(t)
    do i = 1, size(models)
      do k = 1, size(tasks)
        ! The model makes the mesh, and only that by finite elements has more than a stiffness.
        if (i > 1 .and. tasks(k) /= 'mesh' .and. .not. (models(i) == 'fe' .and. any(tasks(k) == ['static', 'load  ']))) cycle
        if (t%wants('walk_'//trim(tasks(k)))) call walk(t, geared(trim(models(i)), trim(tasks(k))), 'g', changes)
      end do
    end do
    do k = 1, size(tasks)
      if (any(slots(k)%info%needs == stage%geometry)) cycle  ! a prescribed mesh has none
      if (t%wants('walk_'//trim(tasks(k)))) call walk(t, prescribed('polynomial', trim(tasks(k))), 'p', changes)
    end do
    if (t%wants('walk_mesh')) call walk(t, prescribed('table', 'mesh'), 'p', changes)
    do i = 1, size(changes)
      if (.not. t%wants('walk')) exit
      associate (s => changes(i)%setting)
        counted = .false.
        do k = 1, size(changes)
          if (changes(k)%counted) counted = counted .or. same_in([changes(k)%setting], s) > 0
        end do
        call check_true(t, '&'//trim(s%group)//' '//trim(s%key)//' counts somewhere', counted)
      end associate
    end do
    if (t%wants('compare_keys')) call compare_keys(t, changes)
    do i = 1, size(slots)
      ! What needs none of these costs nothing, and is made anew.
      if (.not. any([(slots(i)%info%needs == costly(k), k=1, size(costly))])) cycle
      if (t%wants('walk')) call check_true(t, 'taken over from some study: the task '//trim(slots(i)%info%name), is_reused(i), &
        'the walk in test/unit/study/test_inputs.f90 has no study of which it is known; see is_current in src/study/run/study.f90')
    end do
    if (t%wants('walk')) call check_true(t, 'taken over from some study: '//by_elements, is_reused(size(slots) + 1))
    call remove_folder(folder)
  end subroutine run

  ! --- what is walked ---------------------------------------------------------

  !> A second value for each key.
  subroutine list_changes(list)
    type(change_t), allocatable, intent(out) :: list(:)
    character(*), parameter :: by_torque = 'load normal_force_n ;load torque_nm 100', by_line = 'load normal_force_n ;'
    character(*), parameter :: by_torques = 'case tasks ''optimum'';load normal_force_n ;'// &
                                             'load torques_nm 80, 100'
    character(*), parameter :: rubbing = 'dynamics friction 0.04;gear teeth 34;'
    character(*), parameter :: stated = 'mesh coefficients ;mesh file ;'

    character(*), parameter :: eccentric = 'deviations gear_runout_um 4;deviations gear_runout_phase_deg 10'
    character(*), parameter :: drawn = 'deviations pinion_runout_um ;deviations pinion_runout_phase_deg ;deviations pinion_class 6'

    character(*), parameter :: shaft = 'face shaft_diameter_mm 30;face bearing_span_mm 80;face torque_side ''near'''

    character(*), parameter :: by_material = 'life curve_cycles ;life curve_stress_mpa ;life tensile_strength_mpa ;'// &
                                             'rating material ''case_hardened'''

    allocate (list(0))
    call add('case title', '''another''')
    call add('case tasks', '''mesh'', ''load''')
    call add('case published', '''../../data/hassan2009.csv''')
    call add('pair module_mm', '3.1')
    call add('pair face_width_mm', '21', 'g')
    call add('pair face_width_mm', '21', 'p', by_line//'load line_load_n_mm 200;pair face_width_mm 20')
    call add('pair pressure_angle_deg', '21', 'g')
    call add('pair pressure_angle_deg', '21', 'p', rubbing)
    call add('pair coast_angle_deg', '22')
    call add('pair helix_angle_deg', '15')
    call add('pair pinion_hand', '''left''', 'g', 'case tasks ''geometry'';pair helix_angle_deg 15')
    call add('pair pinion_hand', '''left''')
    call add('pair loaded_flanks', '''coast''', 'g', 'pair coast_angle_deg 22')
    call add('pair loaded_flanks', '''coast''')
    call add('pair centre_distance_mm', '82.6')
    call add('pair tip_alteration', '.true.', 'g', 'pinion profile_shift 0.3;gear profile_shift 0.3')
    call add('pair shorten_path', '.true.')
    call add('pair backlash_um', '1')
    call add_gear('pinion', '22')
    call add_gear('gear', '35')
    call add_deviations('pinion', '21')
    call add_deviations('gear', '34')
    call add('deviations seed', '2', 'g', drawn)
    call add('deviations draws', '2', 'g', drawn)
    call add('deviations accepted', '.true.', 'g', drawn//';deviations draws 9')
    call add('deviations assembly', '''all''', 'g', 'gear teeth 28;'//eccentric)
    call add('deviations assembly', '''all''', 'p', 'pinion teeth 17;'//eccentric)
    call add('as_built rpm', '15000')
    call add('as_built relief_um', '5')
    call add('as_built turn_rpm', '15000')
    call add('as_built turn_draw', '2', 'g', drawn//';deviations draws 2')
    call add('as_built turn_assembly', '2', 'g', 'gear teeth 28;deviations assembly ''all'';'//eccentric)
    call add('as_built mesh_orders', '2')
    call add('as_built waterfall', '.true.')
    call add('as_built with_ste', '.true.')
    call add('as_built ste_harmonic', '1')
    call add('as_built with_root_stress', '.true.', 'g')
    call add('as_built quick', '.true.', 'g', 'gear teeth 28;deviations assembly ''all'';'//eccentric)
    call add('pinion teeth', '22', 'p')
    call add('gear teeth', '35', 'p', rubbing)
    call add('material young_gpa', '200')
    call add('material poisson', '0.28')
    call add('material density_kgm3', '7000')
    call add('material young_gpa', '200', 'g', 'pinion young_gpa 190;gear young_gpa 180')
    call add('material poisson', '0.28', 'g', 'gear poisson 0.29')
    call add('material density_kgm3', '7000', 'g', 'pinion density_kgm3 7800')
    call add('load torque_nm', '110', 'g', by_torque)
    call add('load torque_nm', '110', 'p', by_torque//';mesh base_pitch_mm 9')
    call add('load torques_nm', '110', 'g', 'load normal_force_n ;load torques_nm 100')
    call add('load normal_force_n', '4100')
    call add('load application_factor', '1.25', 'g', by_line//'load line_load_n_mm 60')
    call add('load application_factor', '1.25')
    call add('load line_load_n_mm', '210', 'g', by_line//'load line_load_n_mm 200')
    call add('load line_load_n_mm', '210', 'p', by_line//'load line_load_n_mm 200;pair face_width_mm 20')
    call add('relief amount_um', '0, 40')
    call add('relief pinion_fraction', '0.9')
    call add('relief gear_fraction', '0.9')
    call add('relief start', '''pitch''')
    call add('relief shape', '''parabolic''')
    call add('relief shape', '''parabolic''', ' ', 'relief amount_um 0')
    call add('relief start', '''pitch''', ' ', 'relief amount_um 0')
    call add('relief length_mm', '3.5', 'g', 'relief length_mm 3')
    call add('relief length_mm', '3.5', 'p', 'relief length_mm 3;mesh base_pitch_mm 9')
    call add('relief pinion_roll_deg', '26', 'g', 'relief pinion_roll_deg 25;relief gear_roll_deg 24')
    call add('relief gear_roll_deg', '25', 'g', 'relief pinion_roll_deg 25;relief gear_roll_deg 24')
    call add('mesh model', '''weber''', 'g', only=stated)
    call add('mesh model', '''iso6336''', 'g', only=stated)
    call add('mesh model', '''table''', 'p', only='mesh coefficients ;mesh file ''1.csv''')
    call add('mesh coefficients', '410, 0, -50')
    call add('mesh file', '''2.csv''')
    call add('mesh contact_ratio', '1.5', 'p')
    call add('mesh base_pitch_mm', '10', 'p', 'mesh base_pitch_mm 9')
    call add('mesh base_pitch_mm', '10', 'p', by_torque//';mesh base_pitch_mm 9')
    call add('mesh base_pitch_mm', '10', 'g')
    call add('mesh pitch_point', '0.6', 'p', rubbing)
    call add('mesh pitch_point', '0.6', 'p', 'relief start ''pitch''')
    call add('mesh pitch_point', '0.6', 'p', 'relief start ''pitch'';relief amount_um 0')
    call add('mesh pitch_point', '0.6', 'p', 'relief start ''hpstc'';deviations pinion_profile_slope_um 5')
    call add('mesh pitch_point', '0.6', 'g')
    call add('mesh ste_harmonics', '3')
    call add('sweep motion_harmonics', '3')
    call add('mesh tooth_coupling', '.false.', 'g', 'section teeth 3')
    call add('mesh tooth_coupling', '.false.')
    call add('mesh shared_compliance_um_n', '4e-4', 'p')
    call add('mesh profile_error_file', '''5.csv''', 'p', 'relief amount_um 0;mesh profile_error_file ''4.csv''')
    call add('mesh corner_contact', '.false.')
    call add('mesh nonlinear_contact', '.false.')
    call add('section teeth', '3')
    call add('section half_angle_deg', '8', 'g', 'gear teeth 21')
    call add('section rim_mm', '5')
    call add('section fixed', '''rim''')
    call add('section plane', '''stress''')
    call add('section elements_across', '4')
    call add('section gear', '''gear''')
    call add('static positions', '4')
    call add('static spacing', '''flank''')
    call add('static sharing', '''equal''')
    call add('static shares', '0.5, 1', only='static positions ;')
    call add('static tangent_deg', '35')
    call add('static field_position', '0')
    call add('modal modes', '3')
    call add('dynamics damping_ratio', '0.03')
    call add('dynamics friction', '0.05', 'g')
    call add('dynamics friction', '0.05', 'p', rubbing)
    call add('sweep rpm_first', '15000')
    call add('sweep rpm_last', '24000')
    call add('sweep rpm_step', '1000')
    call add('sweep direction', '''up''')
    call add('sweep direction', '''down''')
    call add('sweep direction', '''all''')
    call add('sweep load_rpm', '5000')
    call add('numerics method', '''rk4''')
    call add('numerics steps_per_period', '300')
    call add('numerics tolerance', '1e-10')
    ! Where tip corners touch, what a march comes to may be the same to the last digits.
    call add('numerics steady_state', '''march''', 'g', 'mesh corner_contact .false.')
    call add('numerics steady_state', '''march''', 'p')
    call add('stability rpm', '17000, 21000')
    call add('stability damping_first', '0.01')
    call add('stability damping_last', '0.3')
    call add('stability damping_count', '5')
    call add('stability tongues', '3')
    call add('hysteresis rpm', '17000, 21000')
    call add('hysteresis relief_um', '5')
    call add('hysteresis jump', '0.5')
    call add('hysteresis closeness', '2e-3')
    call add('hysteresis ramp_rpm_s', '1e5')
    call add('poincare rpm', '17000, 21000')
    call add('poincare relief_um', '5')
    call add('poincare settling_periods', '30')
    call add('poincare kept_periods', '12')
    call add('attractors rpm', '17000, 21000')
    call add('attractors relief_um', '5')
    call add('attractors starts', '3')
    call add('attractors span', '3')
    call add('attractors most_periods', '1')
    call add('attractors followed_periods', '1')
    call add('branches parameter', '''damping_ratio''', only='branches first 0.02;branches last 0.04;branches rpm 18000')
    call add('branches first', '16500')
    call add('branches last', '19500')
    call add('branches rpm', '19000', beside='branches parameter ''damping_ratio'';branches first 0.02;branches last 0.04;'// &
             'branches rpm 18000')
    call add('branches relief_um', '5')
    call add('branches most_periods', '2')
    call add('branches seeds', '2')
    call add('branches points', '12')
    call add('optimum with_length', '.true.')
    call add('optimum each_gear', '.true.')
    call add('optimum judged', '''ste_peak_to_peak''')
    call add('optimum judged', '''dte_rms''')
    call add('optimum harmonic', '2')
    call add('optimum over_torques', '''weighted''', 'g', by_torques)
    call add('load torque_shares', '1, 3', 'g', by_torques//';optimum over_torques ''weighted'';load torque_shares 1, 1')
    call add('load torques_nm', '90, 100', 'g', by_torques)
    call add('face misalignment_um', '12', 'g')
    call add('face misalignment_um', '12', 'g', stated//'mesh model ''fe'';face misalignment_um 5')
    call add('face slices', '16', 'g')
    call add('face_load misalignment_um', '0, 20', 'g')
    call add('face shaft_diameter_mm', '35', 'g', shaft//';face bearing_offset_mm 5')
    call add('face bearing_span_mm', '90', 'g', shaft//';face bearing_offset_mm 5')
    call add('face bearing_offset_mm', '10', 'g', shaft)
    call add('face torque_side', '''far''', 'g', shaft)
    call add('deflection_relief point', '''hpstc''', 'g')
    call add('deflection_relief pinion_diameter_mm', '66, 68', 'g')
    call add('deflection_relief gear_diameter_mm', '105, 107', 'g')
    call add('sensitivity rpm', '17000')
    call add('sensitivity relief_um', '5')
    call add('sensitivity harmonics', '1')
    call add('precision rpm', '17000, 21000')
    call add('precision relief_um', '5')
    call add('precision most_steps', '60')
    call add('precision most_samples', '40')
    call add('precision harmonics', '2')
    call add('precision most_elements', '5')
    call add('precision modes', '1')
    call add('poincare start_um', '2', ' ', 'poincare start_um 1;poincare start_mm_s 0')
    call add('poincare start_mm_s', '2', ' ', 'poincare start_um 1;poincare start_mm_s 0')
    call add('flank rpm', '17000, 19000', 'g')
    call add('flank relief_um', '5', 'g')
    call add('flank dynamic_load', '.false.', 'g')
    call add('flank friction_coefficient', '0.04', 'g')
    call add('flank roughness_um', '0.8', 'g')
    call add('flank oil_factor', '0.8', 'g')
    call add('flank viscosity_mpa_s', '50', 'g')
    call add('flank pressure_viscosity_1_gpa', '15', 'g')
    call add('flank conductivity_w_mk', '40', 'g')
    call add('flank conductivity_w_mk', '49, 40', 'g')
    call add('flank specific_heat_j_kgk', '460', 'g')
    call add('flank specific_heat_j_kgk', '484, 460', 'g')
    call add('dynamics damping_ratio', '0.03', 'g', 'flank dynamic_load .false.')
    call add('rating rpm', '17000, 19000', 'g')
    call add('rating dynamic_factor_method', '''a''', 'g', 'rating dynamic_factor_method ''b''')
    call add('rating dynamic_factor_method', '''b''', 'g', 'rating dynamic_factor_method ''a''')
    call add('rating accuracy_grade', '7', 'g')
    call add('rating pitch_deviation_um', '9', 'g')
    call add('rating profile_deviation_um', '9', 'g')
    call add('rating accuracy_grade', '7', 'g', 'rating pitch_deviation_um 9;rating profile_deviation_um 8')
    call add('rating running_in', '0.2', 'g')
    call add('rating face_load_factor', '1.2', 'g')
    call add('rating transverse_load_factor', '1.1', 'g')
    call add('rating contact_limit_mpa', '1400', 'g')
    call add('rating contact_limit_mpa', '1400, 1500', 'g', 'rating contact_limit_mpa 1400')
    call add('rating root_limit_mpa', '800', 'g')
    call add('rating root_limit_mpa', '800, 700', 'g', 'rating root_limit_mpa 800')
    call add('rating material', '''case_hardened''', 'g')
    call add('rating contact_limit_mpa', '1400', 'g', 'rating material ''case_hardened''')
    call add('rating root_limit_mpa', '800', 'g', 'rating material ''case_hardened''')
    call add('rating material', '''case_hardened'', ''grey_cast_iron''', 'g', 'rating material ''case_hardened''')
    call add('rating material_grade', '''me''', 'g', 'rating material ''case_hardened''')
    call add('rating material_grade', '''me''', 'g')
    call add('rating life_h', '8000', 'g', 'rating material ''case_hardened''')
    call add('rating life_h', '8000', 'g')
    call add('rating long_life_factor', '0.9', 'g', 'rating material ''case_hardened'';rating life_h 9000')
    call add('rating long_life_factor', '0.9', 'g')
    call add('sweep load_torque', '.true.', 'g')
    call add('transient rpm', '17000, 19000', 'g')
    call add('transient relief_um', '5', 'g')
    call add('transient modes', '3', 'g')
    call add('transient damping_ratio', '0.02', 'g')
    call add('transient rayleigh_alpha_1_s', '200', 'g')
    call add('transient rayleigh_beta_s', '1e-7', 'g')
    call add('transient static_correction', '.false.', 'g')
    call add('transient tangent_deg', '35', 'g')
    call add('transient positions', '12', 'g')
    call add('transient sharing', '''equal''', 'g')
    call add('transient sharing', '''motion''', 'g')
    call add('transient spacing', '''flank''', 'g')
    call add('transient shares', '0.5, 1, 1, 0.6', 'g', only='transient positions ')
    call add('transient jump_at', '0.3', 'g', 'transient spacing ''flank''')
    call add('transient passage_periods', '1', 'g', 'transient spacing ''flank''')
    call add('transient travel', '''inwards''', 'g')
    call add('transient after_periods', '0.5', 'g')
    call add('transient samples', '30', 'g')
    call add('transient time_step_s', '1e-5', 'g', 'transient samples ')
    call add('mesh nonlinear_contact', '.false.', 'g', 'transient sharing ''equal''')
    call add('harmonic frequency_hz', '0, 9e4', 'g')
    call add('harmonic modes', '3', 'g')
    call add('harmonic rayleigh_alpha_1_s', '200', 'g')
    call add('harmonic rayleigh_beta_s', '1e-7', 'g')
    call add('harmonic damping_ratio', '0.02', 'g')
    call add('harmonic tangent_deg', '35', 'g')
    call add('harmonic s', '0.9', 'g')
    call add('harmonic amplitude_n', '100', 'g')
    call add('harmonic harmonics', '3', 'g')
    call add('relief shape', '''parabolic''', 'g', 'transient sharing ''equal''')
    call add('dynamics damping_ratio', '0.03', 'g', 'transient sharing ''motion''')
    call add('life rpm', '17000', 'g')
    call add('life duration_h', '11', 'g')
    call add('life load_factor', '1.1', 'g')
    call add('life relief_um', '5', 'g')
    call add('life dynamic_load', '.false.', 'g')
    call add('life stress_factor', '1.2', 'g')
    call add('life stress_ratio', '-0.3', 'g')
    call add('life mean_stress', '''gerber''', 'g')
    call add('life mean_stress', '''soderberg''', 'g', only='life tensile_strength_mpa ;life yield_strength_mpa 1000')
    call add('life tensile_strength_mpa', '1600', 'g')
    call add('life yield_strength_mpa', '1000', 'g', 'life mean_stress ''soderberg'';life tensile_strength_mpa ;'// &
             'life yield_strength_mpa 1100')
    call add('life curve_cycles', '1e3, 1e8', 'g')
    call add('life curve_stress_mpa', '900, 80', 'g')
    call add('rating material', '''C45''', 'g', by_material)
    call add('rating material', '''case_hardened'', ''C45''', 'g', by_material)
    call add('rating material_grade', '''me''', 'g', by_material)
    call add('rating long_life_factor', '0.9', 'g', by_material)
    call add('rating face_load_factor', '1.2', 'g', by_material)
    call add('rating transverse_load_factor', '1.2', 'g', by_material)
    call add('material young_gpa', '200', 'g', by_material)
    call add('life endless', '.false.', 'g', 'life curve_cycles 1e4, 1e8;life curve_stress_mpa 5000, 3000')
    call add('dynamics damping_ratio', '0.03', 'g', 'life dynamic_load .false.')
    call add('dynamics friction', '0.05', 'g', 'flank dynamic_load .false.')
    call add('body_modes modes', '2', 'g')
    call add('body_modes nodal_diameters', '1', 'g')
    call add('body_modes held', '''radial'', ''tangential''', 'g')
    call add('body_modes held', '''nothing''', 'g')
    call add('body_modes hub_diameter_mm', '26', 'g', 'body_modes hub_diameter_mm 24;pinion web_thickness_mm 5;'// &
             'pinion rim_thickness_mm 7')
    call add('body_modes elements_across', '3', 'g')
    call add('body_modes shapes', '2', 'g')
    call add('body_modes harmonics', '2', 'g')
    call add('numerics tolerance', '1e-10', 'g', 'flank dynamic_load .false.')
    call add('material young_gpa', '200', 'g', 'mesh file ;mesh model ''polynomial'';mesh coefficients 400, 0, -60')
    call add('material poisson', '0.28', 'g', 'mesh file ;mesh model ''polynomial'';mesh coefficients 400, 0, -60')
    call add('material density_kgm3', '7000', 'g', 'mesh file ;mesh model ''polynomial'';mesh coefficients 400, 0, -60')

  contains

    subroutine add_gear(gear, teeth)
      character(*), intent(in) :: gear, teeth

      call add(gear//' teeth', teeth, 'g')
      call add(gear//' profile_shift', '0.1')
      call add(gear//' thickness_allowance_um', '-30')
      call add(gear//' generating_shift', '-0.02')
      call add(gear//' pin_diameter_mm', '5.2')
      call add(gear//' addendum', '0.95')
      call add(gear//' addendum', '0.95', 'g', gear//' tip_diameter_mm '//merge('68.5 ', '107.5', gear == 'pinion'))
      call add(gear//' tip_diameter_mm', merge('68.5 ', '107.5', gear == 'pinion'))
      call add(gear//' tip_diameter_mm', merge('68.5 ', '107.5', gear == 'pinion'), 'g', 'pair tip_alteration .true.')
      call add(gear//' tip_chamfer_mm', '0.1')
      call add(gear//' tip_rounding_mm', '0.1')
      call add(gear//' tip_form_diameter_mm', merge('68.8 ', '107.8', gear == 'pinion'))
      call add(gear//' dedendum', '1.3')
      call add(gear//' rack_tip_radius', '0.2')
      call add(gear//' coast_rack_tip_radius', '0.2')
      call add(gear//' protuberance_mm', '0.006', 'g', gear//' dedendum 1.4')
      call add(gear//' protuberance_mm', '0.006', 'p')
      call add(gear//' grinding_stock_mm', '0.003', 'g', gear//' dedendum 1.4;'//gear//' protuberance_mm 0.006')
      call add(gear//' grinding_stock_mm', '0.003', 'p')
      call add(gear//' web_thickness_mm', '6', 'g', gear//' web_thickness_mm 5;'//gear//' rim_thickness_mm 7')
      call add(gear//' rim_thickness_mm', '9', 'g', gear//' web_thickness_mm 5;'//gear//' rim_thickness_mm 7')
      call add(gear//' bore_mm', '12')
      call add(gear//' bore_mm', '12', 'g', 'section rim_mm 5')
      call add(gear//' bore_mm', '12', 'g', gear//' effective_mass_kg 0.5')
      call add(gear//' lead_slope_um', '5', 'g')
      call add(gear//' crowning_um', '6', 'g')
      call add(gear//' end_relief_um', '7', 'g', gear//' end_relief_um 5;'//gear//' end_relief_mm 4')
      call add(gear//' end_relief_mm', '3', 'g', gear//' end_relief_um 5;'//gear//' end_relief_mm 4')
      call add(gear//' young_gpa', '120')
      call add(gear//' poisson', '0.25')
      call add(gear//' density_kgm3', '7200')
      call add(gear//' hub_inertia_kgm2', '1e-3')
      call add(gear//' hub_inertia_kgm2', '1e-3', 'g', 'section teeth 0;section fixed ''rim'';pinion bore_mm 20')
      call add(gear//' effective_mass_kg', '0.6')
      call add(gear//' inertia_kgm2', '2e-3', 'g', gear//' inertia_kgm2 1e-3')
      call add(gear//' inertia_kgm2', '2e-3', 'p', gear//' effective_mass_kg ;'//gear//' inertia_kgm2 1e-3;'// &
               'mesh base_pitch_mm 9;'//gear//' teeth '//merge('21', '34', gear == 'pinion'))
    end subroutine add_gear

    !> Of a gear with so many teeth, by lists that say how the teeth are counted.
    subroutine add_deviations(gear, teeth)
      character(*), intent(in) :: gear, teeth
      character(*), parameter :: alone = 'deviations pinion_runout_um ;deviations pinion_runout_phase_deg ;'
      character(:), allocatable :: own, counted

      ! What deviates on the other gear would make the period a hunting period.
      own = 'deviations '//gear//'_'
      counted = ';'//own//'counting ''clockwise'';'//own//'flank ''left'';'//own//'tooth 1'
      call add(own//'class', '7', 'g', alone//own//'class 6')
      call add(own//'single_pitch_um', '2, -2, '//rest(teeth, 2)//'*0', &
               beside=alone//own//'single_pitch_um 3, -3, '//rest(teeth, 2)//'*0'//counted)
      call add(own//'cumulative_pitch_um', '2, '//rest(teeth, 1)//'*0', &
               beside=alone//own//'cumulative_pitch_um 3, '//rest(teeth, 1)//'*0'//counted)
      call add(own//'coast_pitch_um', '2, '//rest(teeth, 1)//'*0', &
               beside='pair backlash_um 5;'//alone//own//'coast_pitch_um 3, '//rest(teeth, 1)//'*0'//counted)
      call add(own//'profile_slope_um', '4', beside=alone//own//'profile_slope_um 3')
      call add(own//'profile_form_um', '4', beside=alone//own//'profile_form_um 3')
      call add(own//'flanks_file', ''''//gear//'7.csv''', 'g', alone//own//'flanks_file '''//gear//'6.csv'''//counted)
      call add(own//'counting', '''counterclockwise''', &
               beside=alone//own//'single_pitch_um 3, -1, -2, '//rest(teeth, 3)//'*0'//counted)
      call add(own//'flank', '''right''', beside=alone//own//'single_pitch_um 3, -1, -2, '//rest(teeth, 3)//'*0'//counted)
      call add(own//'tooth', '2', beside=alone//own//'single_pitch_um 3, -1, -2, '//rest(teeth, 3)//'*0'//counted)
      call add(own//'runout_um', '8', beside=alone//own//'runout_um 5;'//own//'runout_phase_deg 20')
      call add(own//'runout_phase_deg', '50', beside=alone//own//'runout_um 5;'//own//'runout_phase_deg 20')
      call add(own//'wave_order', '4', beside=alone//own//'wave_order 3;'//own//'wave_um 1;'//own//'wave_phase_deg 20')
      call add(own//'wave_um', '2', beside=alone//own//'wave_order 3;'//own//'wave_um 1;'//own//'wave_phase_deg 20')
      call add(own//'wave_phase_deg', '50', beside=alone//own//'wave_order 3;'//own//'wave_um 1;'//own//'wave_phase_deg 20')
    end subroutine add_deviations

    !> So many teeth less some.
    pure function rest(teeth, less) result(left)
      character(*), intent(in) :: teeth
      integer, intent(in) :: less
      character(2) :: left
      integer :: number

      read (teeth, *) number
      write (left, '(i0)') number - less
    end function rest

    subroutine add(name, value, kind, beside, only)
      character(*), intent(in) :: name, value
      character(*), intent(in), optional :: kind, beside, only
      type(change_t) :: change

      change%setting = setting_t(name(:index(name, ' ') - 1), name(index(name, ' ') + 1:), value)
      if (present(kind)) change%kind = kind
      if (present(beside)) change%beside = beside
      if (present(only)) change%only = only
      list = [list, change]
    end subroutine add
  end subroutine list_changes

  !> Low-damped and near resonance, so that contact is lost and motions coexist; solid bodies; a coarse section.
  !> The tips are relieved unequally: equal reliefs share the load alike whatever their shape.
  function geared(model, task) result(settings)
    character(*), intent(in) :: model, task
    type(setting_t), allocatable :: settings(:)

    call set(settings, 'case tasks '''//task//''';pair module_mm 3;pair face_width_mm 20;pinion teeth 21;gear teeth 34;'// &
             'load normal_force_n 4000;relief amount_um 0, 5;relief gear_fraction 0.4;mesh model '''//model//''';'// &
             'section teeth 1;section elements_across 3;static positions 9;modal modes 2;dynamics damping_ratio 0.02;'// &
             'numerics tolerance 1e-3;precision most_elements 4;precision modes 2;flank rpm 20000;rating rpm 20000;'// &
             'transient rpm 20000;transient modes 2;transient positions 9;transient samples 20;'// &
             'harmonic frequency_hz 0, 1e5;harmonic modes 2;'// &
             'life rpm 20000;life duration_h 9;'// &
             'life tensile_strength_mpa 1500;life curve_cycles 1e4, 1e8;life curve_stress_mpa 900, 90;'// &
             'body_modes modes 1;body_modes nodal_diameters 0;body_modes elements_across 2;body_modes shapes 1;'//few)
    if (task == 'face_load') call set(settings, 'mesh model ''fe'';face misalignment_um 10')
    if (task == 'body_modes') call set(settings, 'pinion bore_mm 20;gear bore_mm 30')
    ! A turn of the pinion is the period then; light damping would take long over it.
    if (task == 'as_built') call set(settings, 'dynamics damping_ratio 0.1;deviations pinion_runout_um 6;deviations '// &
      'pinion_runout_phase_deg 30')
    ! Steady motions take longer with tip corners; these are walked with the tasks that have them here.
    if (.not. any(task == [character(task_length) :: 'mesh', 'load', 'static', 'sweep', 'transient', 'harmonic'])) &
      call set(settings, 'mesh corner_contact .false.')
    if (model == 'polynomial') call set(settings, 'mesh coefficients 400, 0, -60')
    if (model == 'table') call set(settings, 'mesh file ''1.csv''')
    select case (model)
    case ('weber')
      call set(settings, 'sweep rpm_first 16000;sweep rpm_last 20000;sweep rpm_step 4000;sweep load_rpm 20000')
    case ('iso6336')
      call set(settings, 'sweep rpm_first 14000;sweep rpm_last 18000;sweep rpm_step 4000;sweep load_rpm 18000')
    case default
      call set(settings, 'sweep rpm_first 18000;sweep rpm_last 22000;sweep rpm_step 4000;sweep load_rpm 22000')
    end select
  end function geared

  function prescribed(model, task) result(settings)
    character(*), intent(in) :: model, task
    type(setting_t), allocatable :: settings(:)

    call set(settings, 'case tasks '''//task//''';pinion teeth 21;pinion effective_mass_kg 0.5;gear effective_mass_kg 0.9;'// &
             'load normal_force_n 4000;relief amount_um 0, 5;mesh model '''//model//''';mesh contact_ratio 1.6;'// &
             'dynamics damping_ratio 0.02;numerics tolerance 1e-3;sweep rpm_first 14000;sweep rpm_last 18000;'// &
             'sweep rpm_step 4000;sweep load_rpm 18000;'//few//';precision rpm 17000;branches first 19000;branches last 21000')
    if (model == 'polynomial') call set(settings, 'mesh coefficients 400, 0, -60')
    if (model == 'table') call set(settings, 'mesh file ''1.csv''')
    if (task == 'as_built') call set(settings, 'gear teeth 34;dynamics damping_ratio 0.1;'// &
                                               'deviations pinion_runout_um 6;deviations pinion_runout_phase_deg 30')
  end function prescribed

  !> A line of constant stiffness (N/um).
  subroutine write_stiffness(path, stiffness)
    character(*), intent(in) :: path
    integer, intent(in) :: stiffness
    integer :: unit

    open (newunit=unit, file=path, status='replace', action='write')
    write (unit, '(a, i0)') '0 ', stiffness, '1 ', stiffness - 20, '2 ', stiffness
    close (unit)
  end subroutine write_stiffness

  !> A profile error of some um at A, with a kink at B.
  subroutine write_error(path, error)
    character(*), intent(in) :: path
    integer, intent(in) :: error
    integer :: unit

    open (newunit=unit, file=path, status='replace', action='write')
    write (unit, '(a, i0)') '0 ', error, '0.6 ', 0, '0.6 ', 0, '2 ', 0
    close (unit)
  end subroutine write_error

  !> Measured flanks of a gear, of which only the first tooth has a slope: so many um over 20 mm.
  subroutine write_flanks(path, teeth, slope)
    character(*), intent(in) :: path
    integer, intent(in) :: teeth, slope
    integer :: unit, tooth, roll

    open (newunit=unit, file=path, status='replace', action='write')
    write (unit, '(a)') 'tooth,flank,roll_mm,deviation_um'
    do tooth = 1, teeth
      do roll = 0, 40
        write (unit, '(i0, a, i0, a, f0.2)') tooth, ',left,', roll, ',', merge(slope*roll/20.0_dp, 0.0_dp, tooth == 1)
      end do
    end do
    close (unit)
  end subroutine write_flanks

  ! --- the walk ---------------------------------------------------------------

  !> All changes to one case. Those that the answer names as not used are tried together. Of the others, those of the task's own
  !> keys are run to the end, and those that change least of what the task reads beside these. One that changes all of this and
  !> more changes the outputs too, and nothing of the task is taken over: there only the products of the stages are compared.
  subroutine walk(t, base, kind, changes)
    type(tally_t), intent(inout) :: t
    type(setting_t), intent(in) :: base(:)
    character, intent(in) :: kind
    type(change_t), intent(inout) :: changes(:)
    type(setting_t), allocatable :: first(:), second(:), idle(:), more(:)
    type(output_t) :: plain, beside, staged, after
    integer, allocatable :: order(:)
    integer :: i, k, n

    call find_output(t, text_of(base), plain)
    beside%case = ''
    staged%case = ''
    idle = base
    changes%count = 0
    changes%is_run = .false.
    do i = 1, size(changes)
      associate (change => changes(i))
        if (change%kind /= ' ' .and. change%kind /= kind) cycle
        call cases_of(base, change, first, second)
        if (any(first%group == change%setting%group .and. first%key == change%setting%key .and. &
                first%value == change%setting%value)) cycle
        if (change%beside == '' .and. change%only == '') then
          more = idle
          call put(more, change%setting)
          if (is_unused(more, change%setting)) then
            call move_alloc(more, idle)
            cycle
          end if
        end if
        call compare_products(t, first, second, plain, beside, staged, change)
      end associate
    end do
    order = pack([(i, i=1, size(changes))], changes%count > 0)
    do n = 1, size(order)
      k = n - 1 + minloc(changes(order(n:))%count, 1)
      order([n, k]) = order([k, n])
      if (any([(includes_all(changes(order(n))%parts, changes(order(i))%parts) .and. changes(order(i))%is_run, i=1, n - 1)])) cycle
      call cases_of(base, changes(order(n)), first, second)
      call compare(t, first, second, plain, beside, changes(order(n)))
    end do
    call find_from(t, text_of(idle), plain, after)
    call check_true(t, text_of(idle), plain%text == after%text, 'some key is said to be unused, but changes an output')
  end subroutine walk

  !> The two cases that a change compares.
  subroutine cases_of(base, change, first, second)
    type(setting_t), intent(in) :: base(:)
    type(change_t), intent(in) :: change
    type(setting_t), allocatable, intent(out) :: first(:), second(:)

    first = base
    call set(first, change%beside)
    second = first
    call set(second, change%only)
    call put(second, change%setting)
  end subroutine cases_of

  !> Whether the key is refused; what it changes of what the task reads; and whether the stages, from those of the case before,
  !> give what they give afresh. Changes that only a run to the end can judge are run. A key that is not used, and changes nothing
  !> of what the task reads, changes no output. `staged`: the stages of the last case with something beside.
  subroutine compare_products(t, first, second, plain, beside, staged, change)
    type(tally_t), intent(inout) :: t
    type(setting_t), intent(in) :: first(:), second(:)
    type(output_t), intent(in) :: plain
    type(output_t), intent(inout) :: beside, staged
    type(change_t), intent(inout) :: change
    type(case_t) :: case
    type(error_t), allocatable :: error
    character(:), allocatable :: key, text
    logical :: is_idle

    key = '&'//trim(change%setting%group)//' '//trim(change%setting%key)
    text = text_of(second)
    call read_case(text, case, error)
    if (allocated(error)) then
      call check_true(t, key//' = '//trim(change%setting%value)//' in '//text, is_refusal(error, key), error%message)
      return
    end if
    if (change%beside == '') then
      call compare_stages(t, case, text, plain%study, change)
    else
      if (staged%case /= text_of(first)) call find_staged(t, text_of(first), staged)
      call compare_stages(t, case, text, staged%study, change)
    end if
    is_idle = names(case%unused, change%setting)
    if (.not. is_idle) change%counted = .true.
    if (is_idle .and. change%count == 0) return
    ! What changes the gears alone changes the tables of the geometry, which come with every task.
    if (.not. (is_idle .or. includes_all(change%parts, ' keys') .or. includes_all(' pinion gear path', change%parts))) return
    change%count = 0
    call compare(t, first, second, plain, beside, change)
  end subroutine compare_products

  !> Which parts of what the task reads the case has otherwise than the study before.
  subroutine compare_stages(t, case, text, before, change)
    type(tally_t), intent(inout) :: t
    type(case_t), intent(in) :: case
    character(*), intent(in) :: text
    type(study_t), intent(in) :: before
    type(change_t), intent(inout) :: change
    type(study_t) :: after, fresh
    integer :: i

    call find_stages(t, case, text, after, before)
    ! The stages are the same whatever task needs them. What takes over nothing is afresh.
    if (case%requests('mesh')) then
      if (takes_over(after)) then
        call find_stages(t, case, text, fresh)
        call check_true(t, 'stages from an earlier study: '//text, same_products(after, fresh))
      else
        call check_true(t, 'stages from an earlier study: '//text, .true.)
      end if
    end if
    change%parts = parts_apart(before, after, fine=.not. (case%needs(stage%motion) .or. case%needs(stage%solid) .or. &
                                case%needs_elements()))
    change%count = count([(change%parts(i:i) == ' ', i=1, len(change%parts))])
  end subroutine compare_stages

  !> Does the list `parts` have all that `least` has? Each has a blank before every word.
  pure logical function includes_all(parts, least)
    character(*), intent(in) :: parts, least
    integer :: from, until

    includes_all = .true.
    from = 1
    do while (from <= len(least) .and. includes_all)
      until = from + index(least(from + 1:)//' ', ' ') - 1
      includes_all = index(parts//' ', least(from:until)//' ') > 0
      from = until + 1
    end do
  end function includes_all

  !> Both cases run to the end: the key is named as not used and changes nothing, or changes an output by more than rounding.
  !> `plain`: the output of the case with nothing beside. `beside`: of the last case with something beside.
  subroutine compare(t, first, second, plain, beside, change)
    type(tally_t), intent(inout) :: t
    type(setting_t), intent(in) :: first(:), second(:)
    type(output_t), intent(in) :: plain
    type(output_t), intent(inout) :: beside
    type(change_t), intent(inout) :: change

    change%is_run = .true.
    if (change%beside == '') then
      call compare_to(t, plain, second, change)
      return
    end if
    if (beside%case /= text_of(first)) call find_output(t, text_of(first), beside)
    call compare_to(t, beside, second, change)
  end subroutine compare

  subroutine compare_to(t, before, second, change)
    type(tally_t), intent(inout) :: t
    type(output_t), intent(in) :: before
    type(setting_t), intent(in) :: second(:)
    type(change_t), intent(in) :: change
    type(output_t) :: after
    character(:), allocatable :: name, text

    text = text_of(second)
    name = '&'//trim(change%setting%group)//' '//trim(change%setting%key)//' = '//trim(change%setting%value)//' in '//text
    call find_from(t, text, before, after)
    if (is_unused(second, change%setting)) then
      call check_true(t, name, before%text == after%text, 'is said to be unused, but changes an output')
    else
      call check_true(t, name, are_apart(before%text, after%text), 'changes nothing by more than rounding')
    end if
  end subroutine compare_to

  subroutine find_staged(t, text, staged)
    type(tally_t), intent(inout) :: t
    character(*), intent(in) :: text
    type(output_t), intent(out) :: staged
    type(case_t) :: case
    type(error_t), allocatable :: error

    staged%case = text
    call read_case(text, case, error)
    if (allocated(error)) call check_true(t, text, .false., error%message)
    if (.not. allocated(error)) call find_stages(t, case, text, staged%study)
  end subroutine find_staged

  !> The products of the stages of a case; its tasks that take time are not run, as if the caller had ended the run.
  subroutine find_stages(t, case, text, study, earlier)
    type(tally_t), intent(inout) :: t
    type(case_t), intent(in) :: case
    character(*), intent(in) :: text
    type(study_t), intent(out) :: study
    type(study_t), intent(in), optional :: earlier
    type(error_t), allocatable :: error
    integer(c_int) :: watch(3)

    watch = 1
    call run_study(case, folder//'/', 1, study, error, watch=watch, earlier=earlier)
    if (allocated(error)) call check_true(t, text, .false., error%message)
  end subroutine find_stages

  !> Does the study have something of an earlier one?
  logical function takes_over(study)
    type(study_t), intent(in) :: study

    takes_over = allocated(study%log)
    if (takes_over) takes_over = index(study%log, ', taken over') > 0
  end function takes_over

  !> The case is read, and the answer will name this key as not used.
  logical function is_unused(settings, setting)
    type(setting_t), intent(in) :: settings(:), setting
    type(case_t) :: case
    type(error_t), allocatable :: error

    is_unused = .false.
    call read_case(text_of(settings), case, error)
    if (.not. allocated(error)) is_unused = names(case%unused, setting)
  end function is_unused

  !> Do two outputs differ by more than rounding: in their words, or in a number by more than 1e-9 of it, 1e-9 of its
  !> unit (um, N/um, MPa, Hz, ...; residuals are smaller) and one and a half of its last decimal?
  logical function are_apart(before, after)
    character(*), intent(in) :: before, after
    real(dp) :: a, b, last_a, last_b
    character :: mark_a, mark_b
    integer :: at, to

    at = 1
    to = 1
    are_apart = .false.
    do while (.not. are_apart)
      call next_item(before, at, mark_a, a, last_a)
      call next_item(after, to, mark_b, b, last_b)
      are_apart = mark_a /= mark_b .or. abs(a - b) > max(1e-9_dp*max(1.0_dp, abs(a), abs(b)), 1.5_dp*max(last_a, last_b))
      if (mark_a == achar(0)) return
    end do
  end function are_apart

  !> What rounding is and what is more.
  subroutine judge_changes(t)
    type(tally_t), intent(inout) :: t

    call check_true(t, 'rounding in a table is no change', &
                    .not. are_apart('x,-3.14159265358979E+02,1.2E-17', 'x, -3.14159265358970E+02,-3.4E-15'))
    call check_true(t, 'rounding in an answer is no change', .not. are_apart('worst DF 1.024 at 880', 'worst DF 1.025 at 880'))
    call check_true(t, 'a change in a table', are_apart('x,3.14159265358979E+02', 'x,3.14159275358979E+02'))
    call check_true(t, 'a change in an answer', are_apart('worst DF 1.024 at 880', 'worst DF 1.026 at 880'))
    call check_true(t, 'a count is a change', are_apart('points 12', 'points 13'))
    call check_true(t, 'a word is a change', are_apart('1.5,ok', '1.5,marginal'))
    call check_true(t, 'a row more is a change', are_apart('1.5', '1.5'//lf//'1.5'))
    call check_true(t, 'a sign is a change', are_apart('a -1.5', 'a 1.5'))
  end subroutine judge_changes

  !> The next number of a text, with `mark` = '0' and the worth of its last decimal (0 for integers), or the next
  !> character that is no blank, or achar(0) at the end. `at`: where to look, and then behind what was found.
  subroutine next_item(text, at, mark, value, last)
    character(*), intent(in) :: text
    integer, intent(inout) :: at
    character, intent(out) :: mark
    real(dp), intent(out) :: value, last
    character(*), parameter :: digits = '0123456789'
    integer :: from, until, point, info

    mark = achar(0)
    value = 0
    last = 0
    at = behind(text, at, ' ')
    if (at > len(text)) return
    mark = text(at:at)
    until = at
    from = at + merge(1, 0, mark == '-' .and. at < len(text))
    if (index(digits, text(from:from)) > 0) then
      mark = '0'
      until = behind(text, from, digits//'.') - 1
      point = index(text(from:until), '.')
      if (point > 0) last = 10.0_dp**(from + point - 1 - until)
      if (is_exponent(text(until + 1:))) until = behind(text, until + 3, digits) - 1
      read (text(at:until), *, iostat=info) value
      if (info /= 0) value = 0
      if (scan(text(at:until), 'eE') > 0) last = 0
    end if
    at = until + 1
  end subroutine next_item

  !> The first place from `at` on whose character is none of a set. Texts are long: none is copied.
  pure integer function behind(text, at, set) result(place)
    character(*), intent(in) :: text, set
    integer, intent(in) :: at

    do place = at, len(text)
      if (index(set, text(place:place)) == 0) exit
    end do
  end function behind

  !> Does the text begin as `E+01`?
  pure logical function is_exponent(text)
    character(*), intent(in) :: text

    is_exponent = .false.
    if (len(text) >= 3) is_exponent = scan(text(1:1), 'eE') == 1 .and. scan(text(2:2), '+-') == 1 .and. &
                                      verify(text(3:3), '0123456789') == 0
  end function is_exponent

  !> True if the key itself, the tasks or the model of the mesh is at fault, and not the size of a number.
  logical function is_refusal(error, key)
    type(error_t), intent(in) :: error
    character(*), intent(in) :: key

    is_refusal = error%code == code_input .and. index(error%message, 'must be a') == 0 .and. &
                 (index(error%message, key) == 1 .or. index(error%message, '&case tasks') == 1 .or. &
                  index(error%message, '&mesh model = ') == 1)
  end function is_refusal

  !> Does a list as `tasks: &group key, key; &group key` name the key?
  logical function names(list, setting)
    character(*), intent(in) :: list
    type(setting_t), intent(in) :: setting
    character(:), allocatable :: keys
    integer :: from, until

    names = .false.
    from = index(list, '&'//trim(setting%group)//' ')
    do while (from > 0)
      until = from + scan(list(from:)//lf, ';'//lf) - 2
      keys = list(from + len_trim(setting%group) + 1:until)//','
      names = names .or. index(keys, ' '//trim(setting%key)//',') > 0
      until = index(list(from + 1:), '&'//trim(setting%group)//' ')
      if (until == 0) exit
      from = from + until
    end do
  end function names

  !> All that a case gives: its answer but for what it names as not used, and its tables but for their
  !> echo of the case.
  subroutine find_output(t, text, output, earlier)
    type(tally_t), intent(inout) :: t
    character(*), intent(in) :: text
    type(output_t), intent(out) :: output
    type(study_t), intent(in), optional :: earlier
    type(case_t) :: case
    type(error_t), allocatable :: error
    character(:), allocatable :: part, names(:)
    integer :: i

    output%text = ''
    output%case = text
    call read_case(text, case, error)
    if (.not. allocated(error)) call run_study(case, folder//'/', 1, output%study, error, earlier=earlier)
    if (allocated(error)) then
      call check_true(t, text, .false., error%message)
      return
    end if
    call write_report(output%study, part)
    output%text = without_times(part(:index(part//lf//'Not used', lf//'Not used')))
    names = table_names(on_grid=.false.)
    do i = 1, size(names)
      call write_reproducible(output%study, names(i), part, error)
      if (.not. allocated(part)) cycle
      part = part(index(part, lf//'#', back=.true.) + 1:)
      output%text = output%text//part(index(part, lf):)
    end do
  end subroutine find_output

  !> A report without the column of run times in the lines of the task precision, which ends them.
  function without_times(report) result(text)
    character(*), intent(in) :: report
    character(:), allocatable :: text, line
    logical :: has_times
    integer :: from, until

    text = ''
    has_times = .false.
    from = 1
    do while (from <= len(report))
      until = from + index(report(from:)//lf, lf) - 2
      line = report(from:until)
      has_times = line(:min(9, len(line))) == 'Precision' .or. (has_times .and. len(line) > 0)
      if (has_times .and. len(line) > 9) line = line(:len(line) - 9)
      text = text//line//lf
      from = until + 2
    end do
  end function without_times

  !> What a case gives. From the study of another case it gives bit for bit what it gives afresh; where it takes over nothing,
  !> that one run is afresh.
  subroutine find_from(t, text, before, fresh)
    type(tally_t), intent(inout) :: t
    character(*), intent(in) :: text
    type(output_t), intent(in) :: before
    type(output_t), intent(out) :: fresh
    type(output_t) :: output

    call find_output(t, text, fresh, before%study)
    if (takes_over(fresh%study)) then
      output = fresh
      call find_output(t, text, fresh)
      call note_taken(output%study)
      call check_true(t, 'from an earlier study: '//text, output%text == fresh%text)
    else
      call check_true(t, 'from an earlier study: '//text, .true.)
    end if
  end subroutine find_from

  !> Which tasks are taken over in this study, and whether the stiffness is.
  subroutine note_taken(study)
    type(study_t), intent(in) :: study
    integer :: i

    associate (n => size(study%tasks), tasks => study%tasks)
      do i = 1, n
        if (.not. (tasks(i)%is_requested .and. allocated(tasks(i)%task%log))) cycle
        is_reused(i) = is_reused(i) .or. index(study%log, tasks(i)%task%log//', taken over') > 0
      end do
      is_reused(n + 1) = is_reused(n + 1) .or. index(study%log, by_elements//', taken over') > 0
    end associate
  end subroutine note_taken

  ! --- settings ---------------------------------------------------------------

  !> Takes settings as `group key value;group key value`.
  subroutine set(settings, list)
    type(setting_t), allocatable, intent(inout) :: settings(:)
    character(*), intent(in) :: list
    integer :: from, until, at

    if (.not. allocated(settings)) allocate (settings(0))
    from = 1
    do while (from <= len_trim(list))
      until = from + index(list(from:)//';', ';') - 2
      associate (item => list(from:until))
        at = index(item, ' ')
        call put(settings, setting_t(item(:at - 1), item(at + 1:at + index(item(at + 1:)//' ', ' ') - 1), &
                                     item(min(len(item) + 1, at + index(item(at + 1:)//' ', ' ') + 1):)))
      end associate
      from = until + 2
    end do
  end subroutine set

  subroutine put(settings, setting)
    type(setting_t), allocatable, intent(inout) :: settings(:)
    type(setting_t), intent(in) :: setting

    settings = [pack(settings, settings%group /= setting%group .or. settings%key /= setting%key), setting]
  end subroutine put

  function text_of(settings) result(text)
    type(setting_t), intent(in) :: settings(:)
    character(:), allocatable :: text
    integer :: i, k

    text = ''
    do i = 1, size(settings)
      if (any(settings(:i - 1)%group == settings(i)%group)) cycle
      text = text//'&'//trim(settings(i)%group)
      do k = i, size(settings)
        if (settings(k)%group == settings(i)%group .and. settings(k)%value /= '') then
          text = text//' '//trim(settings(k)%key)//' = '//trim(settings(k)%value)
        end if
      end do
      text = text//' / '
    end do
  end function text_of

  ! --- which keys there are ---------------------------------------------------

  !> The keys of the reference of the case, of the reader and of the walk are the same.
  subroutine compare_keys(t, changes)
    type(tally_t), intent(inout) :: t
    type(change_t), intent(in) :: changes(:)
    type(setting_t), allocatable :: documented(:), known(:), walked(:)
    integer :: i

    call read_reference(documented)
    call ask_reader(known)
    walked = changes%setting
    call check_true(t, 'keys are documented', size(documented) > 60)
    do i = 1, size(known)
      call check_true(t, 'documented once: &'//known(i)%group//known(i)%key, same_in(documented, known(i)) == 1, &
                      'build/run/check-release reference prints doc/case.md with it')
      call check_true(t, 'walked: &'//known(i)%group//known(i)%key, same_in(walked, known(i)) > 0, &
                      'add a second value of it to list_changes in test/unit/study/test_inputs.f90')
    end do
    do i = 1, size(documented)
      call check_true(t, 'known: &'//documented(i)%group//documented(i)%key, same_in(known, documented(i)) == 1, &
                      'doc/case.md has it, but no file declares it')
    end do
  end subroutine compare_keys

  integer function same_in(list, setting)
    type(setting_t), intent(in) :: list(:), setting

    same_in = count(list%group == setting%group .and. list%key == setting%key)
  end function same_in

  !> The rows ``| `key` |`` of the table `| key |` under each heading `### group` or `### group and group`
  !> of doc/case.md.
  subroutine read_reference(keys)
    type(setting_t), allocatable, intent(out) :: keys(:)
    character(*), parameter :: letters = 'abcdefghijklmnopqrstuvwxyz_0123456789'
    character(:), allocatable :: text, heading, line
    type(error_t), allocatable :: error
    logical :: of_keys
    integer :: from, until, last

    allocate (keys(0))
    call read_text('doc/case.md', text, error)
    if (allocated(error)) return
    text = text(:index(text, lf//'## Finite elements'))
    heading = ''
    of_keys = .false.
    from = 1
    do while (from <= len(text))
      until = from + index(text(from:), lf) - 2
      line = text(from:until)
      from = until + 2
      if (index(line, '### ') == 1) heading = line(5:)
      if (index(line, '|') /= 1) of_keys = .false.
      if (index(line, '| key ') == 1) of_keys = .true.
      if (index(line, '| `') /= 1 .or. .not. of_keys) cycle
      ! The keys of the first column: one, or one of each gear.
      line = line(:index(line(3:), ' |') + 1)
      do while (index(line, '`') > 0)
        line = line(index(line, '`') + 1:)
        last = verify(line, letters) - 1
        if (last < 1 .or. line(last + 1:last + 1) /= '`') exit
        call note(heading(:index(heading//' ', ' ') - 1), line(:last))
        if (index(heading, ' and ') > 0) call note(heading(index(heading, ' and ') + 5:), line(:last))
        line = line(last + 2:)
      end do
    end do

  contains

    subroutine note(group, key)
      character(*), intent(in) :: group, key

      keys = [keys, setting_t(group, key)]
    end subroutine note
  end subroutine read_reference

  !> The reader tells its groups and keys where one is unknown.
  subroutine ask_reader(keys)
    type(setting_t), allocatable, intent(out) :: keys(:)
    character(:), allocatable :: groups, group, names
    integer :: from, until

    allocate (keys(0))
    groups = told('&nothing /', 'the groups are ')//','
    from = 1
    do while (from <= len(groups))
      until = from + index(groups(from:), ',') - 2
      group = trim(adjustl(groups(from:until)))
      from = until + 2
      names = told('&'//group//' nothing = 1 /', 'the keys of &'//group//' are ')
      call set(keys, listed(group, names))
    end do

  contains

    !> `a, b` as `group a;group b`.
    function listed(group, names) result(list)
      character(*), intent(in) :: group, names
      character(:), allocatable :: list
      integer :: i

      list = group//' '
      do i = 1, len(names)
        if (names(i:i) == ',') list = list//' ;'//group
        if (names(i:i) /= ',') list = list//names(i:i)
      end do
      list = list//' '
    end function listed

    function told(text, mark) result(words)
      character(*), intent(in) :: text, mark
      character(:), allocatable :: words
      type(case_t) :: case
      type(error_t), allocatable :: error

      call read_case(text, case, error)
      words = error%message(index(error%message, mark) + len(mark):)
    end function told
  end subroutine ask_reader
end module test_inputs
