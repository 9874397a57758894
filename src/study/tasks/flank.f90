!> The task `flank`: sliding, contact pressure, temperature, film and friction along the path of contact, and the power loss of the
!> mesh, under the static load and under that of the motion at chosen speeds.
module gearsweep_study_tasks_flank
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use gearsweep_base, only: axis, claim_memory, code_input, dp, error_t, fail, lines_t, no_number, str, table_t, wants_stop
  use gearsweep_gear, only: drive
  use gearsweep_motion, only: has_result, response_t, status_stopped
  use gearsweep_rating, only: contact_t, even_load_factor, flank_contact, friction_rule_t, half_shares_factor, mean_friction, &
    surfaces_t
  use gearsweep_study_case_task, only: case_facts_t, check_reliefs, needs_moving, stage, task_info_t
  use gearsweep_study_reader_reader, only: first_nonblank, is_prescribed, needs_gears, reader_t, sentence_length, text_unless
  use gearsweep_study_run_flank_paths, only: angular, follow_motion, follow_static, path_t
  use gearsweep_study_run_points, only: add_several, find_motion, known_count, of_estimate, of_factor, of_motions, of_relief, &
    of_speed, of_status, words_of
  use gearsweep_study_run_stages, only: runnable_t, stages_t
  implicit none
  private
  public :: flank_task_t

  type, extends(runnable_t) :: flank_task_t
    logical :: dynamic_load = .true.             !< true: also with the load of the motion
    type(surfaces_t) :: surfaces                 !< surfaces; their materials are those of the case
    type(friction_rule_t) :: rule
  contains
    procedure, nopass :: describe
    procedure :: read_keys, run, add_report
    procedure :: check, uses
    procedure, private :: fill_losses
  end type flank_task_t

  character(*), parameter :: group = 'flank'
  integer, parameter :: stages_needed(*) = [stage%geometry, stage%elasticity, stage%density, stage%mesh, stage%reliefs, &
                                            stage%amounts, stage%motion, stage%losses, stage%accuracy]
  character(*), parameter :: loadings(2) = [character(7) :: 'static', 'dynamic']
  character(*), parameter :: of_loading = 'static: as stiffness and relief share the load; dynamic: that of the motion'

contains

  pure subroutine describe(info)
    type(task_info_t), intent(out) :: info

    info = task_info_t(group, needs=stages_needed, tables='flank flank_losses', fields='', &
                       summary='sliding, Hertz pressure, flash temperature, film and friction along the path, and the efficiency')
  end subroutine describe

  !> The motion is needed for the dynamic load only.
  pure logical function uses(self, which)
    class(flank_task_t), intent(in) :: self
    integer, intent(in) :: which                 !< index of the stage in `stage`

    uses = needs_moving(stages_needed, which, self%dynamic_load)
  end function uses

  subroutine read_keys(self, reader, error)
    class(flank_task_t), intent(inout) :: self
    type(reader_t), intent(inout) :: reader
    type(error_t), allocatable, intent(inout) :: error
    character(sentence_length) :: geared, by_formula
    logical :: stated
    real(dp), allocatable :: conductivity(:), specific_heat(:)

    call reader%add_group(group, 'The task flank: what happens between the flanks in contact, and what friction costs.')
    geared = text_unless(.not. is_prescribed(reader), needs_gears)
    call reader%get(group, 'rpm', self%own_rpm, error, unit='1/min', required=.true., tasks=group, not_allowed=geared, &
                    at_least=1e-6_dp, at_most=1e9_dp, max_size=1000, distinct=.true., meaning='speeds of the pinion')
    call self%read_reliefs(reader, group, error)
    call reader%get(group, 'dynamic_load', self%dynamic_load, error, tasks=group, not_allowed=geared, &
                    meaning='beside the static load, which stiffness and relief share, also that of the motion at each speed')
    call reader%get(group, 'friction_coefficient', self%rule%coefficient, error, is_stated=stated, tasks=group, &
                    not_allowed=geared, &
                    at_least=0.0_dp, below=1.0_dp, default_note='the mean one by ISO/TR 14179-2, from speed, load, oil and '// &
                    'roughness', meaning='coefficient of friction between the flanks, the same all along the path')
    by_formula = first_nonblank(geared, text_unless(.not. stated, 'friction_coefficient is given; remove one of the two'))
    call reader%get(group, 'roughness_um', self%rule%roughness, error, unit='um', tasks=group, not_allowed=by_formula, &
                    at_least=1e-3_dp, at_most=100.0_dp, &
                    meaning='arithmetic mean roughness Ra of both flanks, for the coefficient of friction')
    call reader%get(group, 'oil_factor', self%rule%oil_factor, error, tasks=group, not_allowed=by_formula, at_least=0.1_dp, &
                    at_most=10.0_dp, meaning='X_L of the oil, for the coefficient of friction: 1 for mineral oil')
    associate (surfaces => self%surfaces)
      call reader%get(group, 'viscosity_mpa_s', surfaces%viscosity, error, unit='mPa s', tasks=group, not_allowed=geared, &
                      at_least=1e-3_dp, at_most=1e6_dp, meaning='dynamic viscosity of the oil at the temperature at which it '// &
                      'enters the contact, for the film and the coefficient of friction')
      call reader%get(group, 'pressure_viscosity_1_gpa', surfaces%pressure_viscosity, error, unit='1/GPa', tasks=group, &
                      not_allowed=geared, at_least=0.1_dp, at_most=1000.0_dp, &
                      meaning='pressure-viscosity coefficient of the oil, for the film')
      conductivity = surfaces%conductivity(:1)
      specific_heat = surfaces%specific_heat(:1)
      call reader%get(group, 'conductivity_w_mk', conductivity, error, unit='W/(m K)', tasks=group, not_allowed=geared, &
                      at_least=1e-3_dp, at_most=1e4_dp, min_size=1, max_size=2, &
                      meaning='thermal conductivity of both gears, or of pinion and gear, for the flash temperature')
      call reader%get(group, 'specific_heat_j_kgk', specific_heat, error, unit='J/(kg K)', tasks=group, not_allowed=geared, &
                      at_least=1.0_dp, at_most=1e5_dp, min_size=1, max_size=2, &
                      meaning='specific heat capacity of both gears, or of pinion and gear, for the flash temperature')
      surfaces%conductivity = conductivity([1, size(conductivity)])
      surfaces%specific_heat = specific_heat([1, size(specific_heat)])
      self%rule%viscosity = surfaces%viscosity
    end associate
  end subroutine read_keys

  !> Refuses more paths than the table can hold.
  subroutine check(self, facts, error)
    class(flank_task_t), intent(in) :: self
    type(case_facts_t), intent(in) :: facts
    type(error_t), allocatable, intent(inout) :: error
    integer, parameter :: most_paths = 10000
    integer :: reliefs

    call check_reliefs(self, facts, error)
    if (.not. allocated(self%own_rpm)) return
    reliefs = size(facts%amount)
    if (allocated(self%own_relief)) reliefs = size(self%own_relief)
    if (size(self%own_rpm)*reliefs > most_paths) call fail(error, code_input, &
      '&flank rpm: with '//str(reliefs)//' reliefs more than '//str(most_paths)//' paths')
  end subroutine check

  subroutine run(self, stages, error)
    class(flank_task_t), intent(inout) :: self
    type(stages_t), intent(in) :: stages
    type(error_t), allocatable, intent(inout) :: error
    type(path_t), allocatable :: paths(:)
    integer :: i, k, n, kinds
    type(path_t) :: static
    type(response_t) :: response
    integer, allocatable :: which(:)

    self%surfaces%material = stages%material
    call self%list_reliefs(stages, which)
    kinds = merge(2, 1, self%dynamic_load)
    call claim_memory(kinds*size(which)*size(self%own_rpm)*20000.0_dp, '&flank rpm: '//str(size(which)*size(self%own_rpm))// &
                      ' paths', error)
    if (allocated(error)) return
    allocate (paths(kinds*size(which)*size(self%own_rpm)))
    n = 0
    do i = 1, size(which)
      associate (motion => stages%motion(which(i)))
        static = path_t(relief=stages%amount(which(i)))
        call follow_static(stages%pair, motion, static)
        do k = 1, size(self%own_rpm)
          if (wants_stop(stages%accuracy%steady%stop)) return
          static%rpm = self%own_rpm(k)
          static%friction = mean_friction(self%rule, stages%pair, stages%load, angular(static%rpm))
          static%input = stages%load*stages%pair%gear(1)%base_radius(drive)*angular(static%rpm)
          n = n + 1
          paths(n) = static
          if (.not. self%dynamic_load) cycle
          n = n + 1
          paths(n) = static
          call find_motion(motion, static%rpm, stages%accuracy, response, paths(n)%motions)
          call follow_motion(stages%pair, response, stages%load, '&flank rpm', paths(n), error)
          if (allocated(error)) return
          call stages%running%report_progress(1, stages%accuracy%steady%stop)
        end do
      end associate
    end do
    call claim_memory(sum([(size(paths(i)%s)*1.0_dp, i=1, size(paths))])*storage_size(contact_t())/8, 'the task flank', error)
    if (allocated(error)) return
    do i = 1, size(paths)
      associate (path => paths(i))
        path%contact = flank_contact(stages%pair, self%surfaces, path%friction, angular(path%rpm), path%s, path%load)
      end associate
    end do
    call fill_contacts(stages, paths, self%tables(self%place('flank')), error)
    call self%fill_losses(stages, paths, self%tables(self%place('flank_losses')), error)
    self%is_done = .true.
    self%is_stopped = any(paths%status == status_stopped)
    self%failed = count(.not. has_result(paths%status))
    self%log = 'flank: '//str(size(paths))//' paths of contact followed'
  end subroutine run

  !> Fills a row for each point of each path.
  pure subroutine fill_contacts(stages, paths, table, error)
    type(stages_t), intent(in) :: stages
    type(path_t), intent(in) :: paths(:)
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    type(contact_t), allocatable :: contact(:)
    integer, allocatable :: path(:)              ! index of the path; (row)
    real(dp), allocatable :: s(:), relief(:)
    integer :: i, k

    call table%begin('the contact of one pair along its path, from its first contact to its last', &
                     sum([(size(paths(i)%s), i=1, size(paths))]), error)
    if (allocated(error)) return
    path = [((i, k=1, size(paths(i)%s)), i=1, size(paths))]
    contact = [(paths(i)%contact, i=1, size(paths))]
    s = [(paths(i)%s, i=1, size(paths))]
    relief = paths%relief
    call table%add_index(axis('relief_um', 'um', of_relief, relief(path)))
    call table%add_index(axis('rpm', '1/min', of_speed, [paths(path)%rpm]))
    call table%add_index(axis('loading', '', of_loading, loadings(merge(2, 1, paths(path)%is_dynamic))))
    call table%add_index(axis('pair', '', 'index of the pair, from 1; 0 without an answer', &
                              [(paths(i)%pair, i=1, size(paths))]))
    call table%add_index(axis('s', '', 'path coordinate of the pair, in base pitches from A; below 0 before A', s))
    call table%add('path_mm', 'mm', 'distance from A on the line of action', s*stages%base_pitch)
    call table%add('pair_load_n', 'N', 'load of the pair', [(paths(i)%load, i=1, size(paths))])
    call table%add('pinion_rolling_m_s', 'm/s', 'speed at which the pinion''s flank rolls through the contact', &
                   [contact%rolling(1)])
    call table%add('gear_rolling_m_s', 'm/s', 'the same of the gear''s flank', [contact%rolling(2)])
    call table%add('sliding_m_s', 'm/s', 'sliding speed: that of the pinion less that of the gear', [contact%sliding])
    call table%add('pinion_specific_sliding', '', 'sliding speed over the pinion''s rolling speed', [contact%specific_sliding(1)])
    call table%add('gear_specific_sliding', '', 'the same of the gear, whose sliding speed has the other sign', &
                   [contact%specific_sliding(2)])
    call table%add('pressure_mpa', 'MPa', 'largest Hertz pressure; NaN beyond A and E, where a sharp corner touches, as is all '// &
                   'that follows from it', [contact%pressure])
    call table%add('half_width_um', 'um', 'half the width of the contact', [contact%half_width])
    call table%add('shear_stress_mpa', 'MPa', 'largest shear stress below the surface, without friction', [contact%shear_stress])
    call table%add('shear_depth_um', 'um', 'depth at which it lies', [contact%shear_depth])
    call table%add('friction_power_w', 'W', 'coefficient of friction times load and sliding speed', [contact%friction_power])
    call table%add('flash_temperature_k', 'K', 'by how much the flanks become hotter within the contact', [contact%flash])
    call table%add('film_thickness_um', 'um', 'least thickness of the oil film; NaN where no load is', [contact%film])
  end subroutine fill_contacts

  !> Fills a row for each path.
  pure subroutine fill_losses(self, stages, paths, table, error)
    class(flank_task_t), intent(in) :: self
    type(stages_t), intent(in) :: stages
    type(path_t), intent(in) :: paths(:)
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: loss(:)
    integer :: i, n

    n = size(paths)
    call table%begin('what the mesh loses by friction, and the extremes along the path', n, error, &
                     extent=[n/(merge(2, 1, self%dynamic_load)*size(self%own_rpm)), size(self%own_rpm), &
                             merge(2, 1, self%dynamic_load)])
    if (allocated(error)) return
    loss = paths%friction*paths%loss_factor*paths%input
    call table%add_index(axis('relief_um', 'um', of_relief, [paths%relief]))
    call table%add_index(axis('rpm', '1/min', of_speed, [paths%rpm]))
    call table%add_index(axis('loading', '', of_loading, loadings(merge(2, 1, paths%is_dynamic))))
    call table%add('friction_coefficient', '', 'mean coefficient of friction', [paths%friction])
    call table%add('viscosity_mpa_s', 'mPa s', 'of the case: viscosity of the oil', spread(self%surfaces%viscosity, 1, n))
    call table%add('roughness_um', 'um', 'of the case: roughness Ra; NaN where the coefficient of friction is stated', &
                   spread(merge(no_number(), self%rule%roughness, self%rule%coefficient >= 0), 1, n))
    call table%add('oil_factor', '', 'of the case: X_L of the oil; NaN where the coefficient of friction is stated', &
                   spread(merge(no_number(), self%rule%oil_factor, self%rule%coefficient >= 0), 1, n))
    call table%add('loss_factor', '', 'H_v: mean of load times sliding speed of all pairs, over static load and speed of the '// &
                   'base circles', [paths%loss_factor])
    call table%add('loss_factor_half_shares', '', 'the same in closed form where all pairs carry alike (Ohlendorf, '// &
                   'ISO/TR 14179-2)', &
                   [(half_shares_factor(stages%pair), i=1, n)])
    call table%add('loss_factor_even_load', '', 'the same in closed form for one load all along the path (ISO/TR 14179-1)', &
                   [(even_load_factor(stages%pair), i=1, n)])
    call table%add('input_power_w', 'W', 'power of the pinion''s torque', [paths%input])
    call table%add('friction_loss_w', 'W', 'mean power lost by friction in the mesh', loss)
    call table%add('efficiency', '', 'input power less that loss, over the input power', 1 - loss/paths%input)
    call table%add('largest_pressure_mpa', 'MPa', 'largest Hertz pressure along the path', &
                   [(largest([paths(i)%contact%pressure]), i=1, n)])
    call table%add('largest_flash_k', 'K', 'largest flash temperature along the path', &
                   [(largest([paths(i)%contact%flash]), i=1, n)])
    call table%add('least_film_um', 'um', 'least film thickness along the path', -[(largest(-paths(i)%contact%film), i=1, n)])
    call table%add('dynamic_factor', '', of_factor//', and for the static load', [paths%dynamic_factor])
    call table%add('error_estimate', '', of_estimate, [paths%estimate])
    call table%add_words('status', of_status, words_of([paths%status]))
    call table%add('motions', '', of_motions//'; also under the static load', known_count([paths%motions]))
  end subroutine fill_losses

  !> Largest of the values that are not NaN.
  pure real(dp) function largest(values)
    real(dp), intent(in) :: values(:)
    logical :: is_number(size(values))

    is_number = .not. ieee_is_nan(values)
    largest = no_number()
    if (any(is_number)) largest = maxval(values, mask=is_number)
  end function largest

  !> Source of the coefficient of friction, in words.
  pure function friction_of(losses) result(words)
    type(table_t), intent(in) :: losses
    character(80) :: words

    if (ieee_is_nan(losses%number('roughness_um', 1))) then
      words = 'coefficient of friction as stated'
    else
      words = 'X_L '//str(losses%number('oil_factor', 1), 4)//', roughness Ra '//str(losses%number('roughness_um', 1), 4)//' um'
    end if
  end function friction_of

  pure subroutine add_report(self, lines)
    class(flank_task_t), intent(in) :: self
    type(lines_t), intent(inout) :: lines

    associate (losses => self%tables(self%place('flank_losses')))
      call lines%add('')
      call lines%add('Flanks')
      call lines%add('   oil of '//str(losses%number('viscosity_mpa_s', 1), 5)// &
                     ' mPa s where it enters the contact, '//trim(friction_of(losses)))
      call losses%show(lines, 'relief_um rpm loading largest_pressure_mpa largest_flash_k least_film_um friction_coefficient '// &
                       'loss_factor efficiency')
      call add_several(losses, lines)
    end associate
  end subroutine add_report
end module gearsweep_study_tasks_flank
