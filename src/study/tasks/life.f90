!> The task `life`: life of the tooth roots and flanks of both gears under a load spectrum.
!>
!> The root stress of each engagement follows from the load of the motion, or from the static load, in each part of the
!> spectrum.
module gearsweep_study_tasks_life
  use gearsweep_base, only: axis, claim_memory, code_input, dp, each, error_t, fail, lines_t, no_number, str, &
    table_t, wants_stop
  use gearsweep_motion, only: has_result, oscillator_t, response_t, status_ok, status_stopped
  use gearsweep_rating, only: by_gerber, by_goodman, by_iso, by_soderberg, contact_stress, curve_t, damage_of, &
    dynamic_factor_a, load_factors_t, material_length, no_grade, nominal_t, root_history, root_life, root_life_t, sn_curve, &
    strength_t
  use gearsweep_study_case_task, only: case_facts_t, check_reliefs, gear_names, needs_moving, stage, task_info_t
  use gearsweep_study_reader_reader, only: first_nonblank, is_prescribed, needs_gears, reader_t, sentence_length, text_unless
  use gearsweep_study_run_case_variation, only: case_variation_t, vary_force
  use gearsweep_study_run_face_stage, only: build_face_motion
  use gearsweep_study_run_flank_paths, only: follow_motion, follow_static, path_t
  use gearsweep_study_run_points, only: add_caution, add_equal_flanks, add_several, find_motion, known_count, of_factor, &
    of_motions, of_relief, of_speed, of_status, words_of
  use gearsweep_study_run_stages, only: runnable_t, stages_t
  use gearsweep_study_tasks_rating, only: add_life_curves, face_load_factor, find_nominal, largest_share, limits_t, &
    read_load_factors, read_material
  implicit none
  private
  public :: life_task_t

  !> Rules from loads to damage.
  type :: life_rule_t
    logical :: dynamic_load = .true.             !< true: load of the motion; false: static load
    real(dp) :: stress_factor = 1                !< factor on the root stress beyond the computed one
    real(dp) :: root_face_load = 1               !< K_F_beta by the load over the face width
    logical :: has_face = .false.                !< face load factors follow from the load over the face width
    real(dp) :: stress_ratio = 0                 !< least stress of a revolution over its largest
    type(strength_t) :: strength(2)              !< strength of pinion and gear
    type(curve_t) :: curve(2)                    !< S-N curves of their tooth roots
    type(curve_t) :: contact(2)                  !< S-N curves of their flanks, sigma_H in Pa; not allocated: not known
    type(load_factors_t) :: factors              !< load factors of the contact stress
  contains
    procedure :: has_contact
  end type life_rule_t

  !> Results of a part of the spectrum with one relief.
  type :: part_t
    integer :: status = status_ok                !< status of the motion
    integer :: motions = 0                       !< number of motions; 0: not known, or no motion
    real(dp) :: dynamic_factor = 0               !< dynamic factor; NaN for the static load
    real(dp) :: engagements(2) = 0               !< engagements of a tooth of each gear
    type(root_life_t) :: root(2)
    real(dp) :: contact(2) = 0                   !< contact stress sigma_H of pinion and gear, Pa
    real(dp) :: contact_damage(2) = 0            !< Miner's sum of the flanks in this part
    logical :: contact_is_over(2) = .false.      !< true if sigma_H is above the static strength
  end type part_t

  !> A load spectrum, part by part.
  type :: spectrum_t
    real(dp), allocatable :: rpm(:)              !< speed of the pinion, 1/min
    real(dp), allocatable :: load_factor(:)      !< load over that of the case
    real(dp), allocatable :: duration(:)         !< durations, s
  end type spectrum_t

  real(dp), parameter :: mega = 1e-6_dp
  integer, parameter :: word_length = 10

  type, extends(runnable_t) :: life_task_t
    real(dp), allocatable :: load_factor(:)      !< load over that of the case, for each part of the spectrum
    real(dp), allocatable :: duration(:)         !< duration of each part, s
    type(life_rule_t) :: rule
    type(limits_t) :: limits                     !< limits of the material, if the case names it
  contains
    procedure, nopass :: describe
    procedure :: read_keys, check, uses, run, add_report
    procedure, private :: read_strength, read_curves
  end type life_task_t

  character(*), parameter :: group = 'life'
  integer, parameter :: stages_needed(*) = [stage%geometry, stage%elasticity, stage%rims, stage%mesh, stage%reliefs, &
                                            stage%amounts, stage%motion, stage%losses, stage%accuracy, stage%face]

contains

  !> True if there are S-N curves of the flanks.
  pure logical function has_contact(self)
    class(life_rule_t), intent(in) :: self

    has_contact = allocated(self%contact(1)%stress)
  end function has_contact

  !> Computes the damage of all engagements at one speed and load. `error`: out of memory for the motion.
  subroutine follow_part(stages, relief, rpm, load_factor, duration, rule, nominal, part, error)
    type(stages_t), intent(in) :: stages
    integer, intent(in) :: relief                !< index among the reliefs of the case
    real(dp), intent(in) :: rpm                  !< speed of the pinion, 1/min
    real(dp), intent(in) :: load_factor          !< load over that of the case
    real(dp), intent(in) :: duration             !< duration, s
    type(life_rule_t), intent(in) :: rule
    type(nominal_t), intent(in) :: nominal       !< nominal stresses under the load of the case
    type(part_t), intent(out) :: part
    type(error_t), allocatable, intent(inout) :: error
    type(case_variation_t) :: case
    type(oscillator_t) :: osc
    type(response_t) :: response
    type(path_t) :: path
    real(dp) :: factor, dynamic
    logical :: is_helical
    integer :: i

    is_helical = stages%pair%overlap_ratio > 0
    if (.not. is_helical) then
      case = case_variation_t(stages%motions_inputs, stages%amount(relief))
      call case%set(vary_force, stages%load*load_factor)
      call case%build(osc, error)
    else if (rule%dynamic_load) then
      call build_face_motion(stages, .false., relief, stages%load*load_factor, osc, error)
    end if
    if (allocated(error)) return
    path%dynamic_factor = no_number()
    if (rule%dynamic_load) then
      call find_motion(osc, rpm, stages%accuracy, response, part%motions)
      call follow_motion(stages%pair, response, osc%load, '&life rpm', path, error)
      if (allocated(error)) return
    else if (.not. is_helical) then
      call follow_static(stages%pair, osc, path)
    end if
    part%status = path%status
    part%dynamic_factor = path%dynamic_factor
    associate (teeth => stages%pair%gear%spec%teeth)
      part%engagements = rpm/60*duration*teeth(1)/teeth
    end associate
    if (.not. has_result(part%status)) return
    dynamic = 1
    if (rule%dynamic_load .and. (rule%has_contact() .or. is_helical)) &
      dynamic = dynamic_factor_a(part%dynamic_factor, largest_share(osc))
    factor = rule%stress_factor*rule%root_face_load*stages%iso%application_factor
    do i = 1, 2
      associate (strength => rule%strength(i), curve => rule%curve(i), rim => stages%iso%rim_thickness(i))
        if (is_helical) then
          ! Form factors are known for one place of the load only: an engagement is one load cycle.
          ! Source: ISO 6336-3:2006, clause 5, and ISO 6336-6:2006, clause 5.
          part%root(i) = root_life([1], [factor*dynamic*load_factor*nominal%root(i)], rule%stress_ratio, strength, curve)
        else
          part%root(i) = root_life(path%pair, root_history(stages%pair, i, path%s, factor*path%load, rim), rule%stress_ratio, &
                                   strength, curve)
        end if
      end associate
    end do
    if (rule%has_contact()) then
      ! K_v by Method A as in the task `rating`, and one load cycle for each engagement.
      ! Source: ISO 6336-2 and ISO 6336-6:2006, clause 5 (Miner's sum).
      part%contact = contact_stress(nominal%contact, nominal%flank%single_pair, rule%factors, dynamic)*sqrt(load_factor)
      do i = 1, 2
        part%contact_is_over(i) = part%contact(i) > rule%contact(i)%stress(1)
        part%contact_damage(i) = part%engagements(i)*damage_of(rule%contact(i), part%contact(i))
      end do
    end if
  end subroutine follow_part

  !> Fills a row for each relief, part and gear.
  subroutine fill_parts(rule, spectrum, amount, parts, table, error)
    type(life_rule_t), intent(in) :: rule
    type(spectrum_t), intent(in) :: spectrum
    real(dp), intent(in) :: amount(:)            !< amounts of relief, m
    type(part_t), intent(in) :: parts(:, :)
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    type(root_life_t), allocatable :: root(:)
    real(dp), allocatable :: engagements(:)
    integer :: i, k, m, n

    n = size(parts, 1)
    m = size(parts, 2)
    call table%over('what each part of the load spectrum does to the tooth roots', error, &
                    axis('relief_um', 'um', of_relief, amount), &
                    axis('part', '', 'of the load spectrum, from 1', [(k, k=1, n)]), &
                    axis('gear', '', 'pinion or gear', gear_names))
    if (allocated(error)) return
    root = [((parts(k, i)%root, k=1, n), i=1, m)]
    engagements = [((parts(k, i)%engagements, k=1, n), i=1, m)]
    call table%add('rpm', '1/min', of_speed, table%along(2, spectrum%rpm))
    call table%add('load_factor', '', 'load over that of the case', table%along(2, spectrum%load_factor))
    call table%add('dynamic_factor', '', of_factor//', and for the static load', each([parts%dynamic_factor], 2))
    call table%add_words('status', of_status, words_of(each([parts%status], 2)))
    call table%add('motions', '', of_motions//'; also under the static load', known_count(each([parts%motions], 2)))
    call table%add('engagements', '', 'how often a tooth carries', engagements)
    call table%add('root_stress_mpa', 'MPa', 'largest tooth root stress by ISO 6336-3, of spur gears with the load where '// &
                   'it acts', [root%largest])
    call table%add('amplitude_mpa', 'MPa', 'stress amplitude of the cycle that does most harm', [root%worst%amplitude])
    call table%add('mean_mpa', 'MPa', 'mean stress of that cycle', [root%worst%mean])
    call table%add('equivalent_amplitude_mpa', 'MPa', 'amplitude that does the same harm without mean stress; NaN where the '// &
                   'mean stress alone is above the strength', [root%equivalent])
    call table%add('cycles', '', 'cycles of an engagement, by the rainflow method', [root%cycles])
    call table%add('damage', '', 'Miner''s sum of the root in this part of one pass', [root%damage]*engagements)
    if (.not. rule%has_contact()) return
    call table%add('contact_stress_mpa', 'MPa', 'contact stress sigma_H by ISO 6336-2', [((parts(k, i)%contact, k=1, n), i=1, m)])
    call table%add('contact_damage', '', 'Miner''s sum of the flank in this part of one pass', &
                   [((parts(k, i)%contact_damage, k=1, n), i=1, m)])
  end subroutine fill_parts

  !> Fills a row for each relief and gear.
  subroutine fill_life(rule, spectrum, amount, parts, table, error)
    type(life_rule_t), intent(in) :: rule
    type(spectrum_t), intent(in) :: spectrum
    real(dp), intent(in) :: amount(:)            !< amounts of relief, m
    type(part_t), intent(in) :: parts(:, :)
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp) :: damage(2*size(amount)), largest(2*size(amount))
    character(word_length) :: word(2*size(amount))
    type(root_life_t), allocatable :: root(:)
    integer :: k, m, n, row, worst(2*size(amount))

    m = size(amount)
    call table%over('how long the tooth roots last', error, axis('relief_um', 'um', of_relief, amount), &
                    axis('gear', '', 'pinion or gear', gear_names))
    if (allocated(error)) return
    n = size(parts, 1)
    do row = 1, 2*m
      associate (relief => (row + 1)/2, gear => 2 - modulo(row, 2))
        root = [(parts(k, relief)%root(gear), k=1, n)]
        call sum_damage([parts(:, relief)%status], root%damage*[(parts(k, relief)%engagements(gear), k=1, n)], [root%largest], &
                        [root%is_over], damage(row), largest(row), worst(row), word(row))
      end associate
    end do
    call table%add_words('kind', 'of the root: finite: damage adds up; endless: no cycle harms; overloaded: some cycle is '// &
                         'above the static strength of the material or has a mean stress above the strength; unknown: some '// &
                         'part has no motion', word)
    call table%add('damage', '', 'Miner''s sum of the root in one pass of the spectrum', damage)
    call table%add('passes', '', 'of the spectrum until the sum is 1; NaN unless finite', lasting(word, damage, 1.0_dp))
    call table%add('life_h', 'h', 'time until then', lasting(word, damage, sum(spectrum%duration)))
    call table%add('largest_root_stress_mpa', 'MPa', 'largest tooth root stress of all parts', largest)
    call table%add('worst_part', '', 'part that does most harm to the root; 0 where none does', worst)
    if (.not. rule%has_contact()) return
    do row = 1, 2*m
      associate (relief => (row + 1)/2, gear => 2 - modulo(row, 2))
        call sum_damage([parts(:, relief)%status], [(parts(k, relief)%contact_damage(gear), k=1, n)], &
                        [(parts(k, relief)%contact(gear), k=1, n)], [(parts(k, relief)%contact_is_over(gear), k=1, n)], &
                        damage(row), largest(row), worst(row), word(row))
      end associate
    end do
    call table%add_words('contact_kind', 'of the flank, as kind', word)
    call table%add('contact_damage', '', 'Miner''s sum of the flank in one pass of the spectrum', damage)
    call table%add('contact_life_h', 'h', 'time until the sum of the flank is 1; NaN unless finite', &
                   lasting(word, damage, sum(spectrum%duration)))
    call table%add('largest_contact_stress_mpa', 'MPa', 'largest contact stress sigma_H of all parts', largest)
    call table%add('worst_contact_part', '', 'part that does most harm to the flank; 0 where none does', worst)
  end subroutine fill_life

  !> Sums damage over all parts of the spectrum with one relief.
  pure subroutine sum_damage(status, harm, stress, is_over, damage, largest, worst, word)
    integer, intent(in) :: status(:)             !< status of the motion in each part
    real(dp), intent(in) :: harm(:), stress(:)   !< Miner's sum and largest stress (Pa) in each part
    logical, intent(in) :: is_over(:)            !< true if a stress is above the static strength
    real(dp), intent(out) :: damage, largest
    integer, intent(out) :: worst
    character(word_length), intent(out) :: word

    word = 'unknown'
    damage = no_number()
    largest = no_number()
    worst = 0
    if (.not. all(has_result(status))) return
    damage = sum(harm)
    largest = maxval(stress)
    word = 'overloaded'
    if (any(is_over)) return
    word = 'endless'
    if (.not. damage > 0) return
    word = 'finite'
    worst = maxloc(harm, 1)
  end subroutine sum_damage

  !> Life in time or passes: that of one pass, `whole`, over its damage.
  elemental real(dp) function lasting(word, damage, whole)
    character(*), intent(in) :: word
    real(dp), intent(in) :: damage, whole

    lasting = no_number()
    if (word == 'finite') lasting = whole/damage
  end function lasting

  !> Fills the S-N curves of roots or flanks: one for both gears or, if their materials differ, that of the pinion, then of the
  !> gear.
  subroutine fill_curve(curves, unit_meaning, names, table, error)
    type(curve_t), intent(in) :: curves(2)       !< curves of pinion and gear
    character(*), intent(in) :: unit_meaning     !< meaning of the stress of the curve
    character(material_length), intent(in) :: names(2)  !< names of the materials of the curves
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    integer, allocatable :: gear(:)
    integer :: i, k, n

    n = merge(1, 2, names(1) == names(2))
    gear = [((i, k=1, size(curves(i)%cycles)), i=1, n)]
    call table%begin('the S-N curve', size(gear), error)
    if (allocated(error)) return
    call table%add_index(axis('failure_cycles', '', 'cycles to failure', [(curves(i)%cycles, i=1, n)]))
    call table%add('stress_mpa', 'MPa', unit_meaning, [(curves(i)%stress, i=1, n)])
    call table%add('life_factor', '', 'stress over that at the second point: Y_NT or Z_NT of a material', &
                   [(curves(i)%stress/curves(i)%stress(2), i=1, n)])
    call table%add_words('gear', 'pinion, gear or both', [(merge('both  ', gear_names(gear(k)), n == 1), k=1, size(gear))])
    call table%add_words('curve', 'the material whose curve by ISO 6336-2 or -3 it is, or stated', names(gear))
  end subroutine fill_curve

  pure subroutine describe(info)
    type(task_info_t), intent(out) :: info

    info = task_info_t(group, needs=stages_needed, tables='life life_parts life_curve contact_curve', fields='', &
                       has_helical=.true., &
                       summary='how long tooth roots and flanks last under a load spectrum, by S-N curves and Miner''s sum')
  end subroutine describe

  !> The motion is needed for the dynamic load only, the elasticity for the contact stress.
  pure logical function uses(self, which)
    class(life_task_t), intent(in) :: self
    integer, intent(in) :: which                 !< index of the stage in `stage`

    uses = needs_moving(stages_needed, which, self%rule%dynamic_load)
    if (which == stage%elasticity) uses = self%rule%has_contact()
  end function uses

  subroutine read_keys(self, reader, error)
    class(life_task_t), intent(inout) :: self
    type(reader_t), intent(inout) :: reader
    type(error_t), allocatable, intent(inout) :: error
    character(sentence_length) :: geared
    integer, parameter :: most = 1000

    call reader%add_group(group, 'The task life: fatigue of tooth roots and flanks under a load spectrum.')
    geared = text_unless(.not. is_prescribed(reader), needs_gears)
    call reader%get(group, 'rpm', self%own_rpm, error, unit='1/min', required=.true., tasks=group, not_allowed=geared, &
                    at_least=1e-6_dp, at_most=1e9_dp, max_size=most, &
                    meaning='speed of the pinion in each part of the load spectrum')
    call reader%get(group, 'load_factor', self%load_factor, error, tasks=group, not_allowed=geared, at_least=1e-6_dp, &
                    at_most=1e6_dp, max_size=most, default_note='1 in each part', &
                    meaning='load of each part over that of the case')
    call reader%get(group, 'duration_h', self%duration, error, unit='h', required=.true., tasks=group, not_allowed=geared, &
                    above=0.0_dp, at_most=1e12_dp, max_size=most, &
                    meaning='how long each part lasts within one pass of the spectrum')
    call self%read_reliefs(reader, group, error)
    call reader%get(group, 'dynamic_load', self%rule%dynamic_load, error, tasks=group, not_allowed=geared, &
                    meaning='the load of the motion at each speed; false: the static load, as stiffness and relief share it')
    call reader%get(group, 'stress_factor', self%rule%stress_factor, error, tasks=group, not_allowed=geared, at_least=0.01_dp, &
                    at_most=100.0_dp, &
                    meaning='what raises the root stress beside K_A and the dynamic load: K_F_beta K_F_alpha, with '// &
                    '&face or a lead K_F_alpha alone')
    call reader%get(group, 'stress_ratio', self%rule%stress_ratio, error, tasks=group, not_allowed=geared, at_least=-10.0_dp, &
                    at_most=0.0_dp, meaning='least stress of a revolution over its largest: 0 for teeth loaded on one flank, '// &
                    '-1 or less for an idler, whose teeth are loaded on both')
    call self%read_curves(reader, geared, error)
  end subroutine read_keys

  !> Reads the rule for the mean stress, for an S-N curve of the case.
  subroutine read_strength(self, reader, not_allowed, error)
    class(life_task_t), intent(inout) :: self
    type(reader_t), intent(inout) :: reader
    character(*), intent(in) :: not_allowed          ! reason why none of its keys is allowed, or blank
    type(error_t), allocatable, intent(inout) :: error
    character(*), parameter :: rules(0:3) = [character(9) :: 'none', 'goodman', 'gerber', 'soderberg']
    character(:), allocatable :: rule
    character(2*sentence_length) :: no_tensile, no_yield
    real(dp) :: tensile, yield_point

    rule = 'goodman'
    call reader%get(group, 'mean_stress', rule, error, tasks=group, not_allowed=not_allowed, allowed=rules, &
                    meaning='how the mean stress of a cycle counts, with curve_cycles')
    self%rule%strength%rule = findloc(rules == rule, .true., 1) - 1
    associate (number => self%rule%strength(1)%rule)
      no_tensile = first_nonblank(not_allowed, text_unless(any(number == [by_goodman, by_gerber]), &
                                            'mean_stress is neither goodman nor gerber; remove it'))
      no_yield = first_nonblank(not_allowed, text_unless(number == by_soderberg, 'mean_stress is not soderberg; remove it'))
    end associate
    tensile = 0
    yield_point = 0
    call reader%get(group, 'tensile_strength_mpa', tensile, error, unit='MPa', tasks=group, not_allowed=no_tensile, &
                    required=len_trim(no_tensile) == 0, above=0.0_dp, at_most=1e6_dp, &
                    default_note='required by goodman and gerber', meaning='tensile strength R_m')
    call reader%get(group, 'yield_strength_mpa', yield_point, error, unit='MPa', tasks=group, not_allowed=no_yield, &
                    required=len_trim(no_yield) == 0, above=0.0_dp, at_most=1e6_dp, default_note='required by soderberg', &
                    meaning='yield strength R_e')
    self%rule%strength%limit = merge(yield_point, tensile, self%rule%strength(1)%rule == by_soderberg)
  end subroutine read_strength

  !> Reads the S-N curves: those of the material, and instead of that of the root the curve of the case.
  subroutine read_curves(self, reader, geared, error)
    class(life_task_t), intent(inout) :: self
    type(reader_t), intent(inout) :: reader
    character(*), intent(in) :: geared
    type(error_t), allocatable, intent(inout) :: error
    character(*), parameter :: of_own = 'needs curve_cycles: the S-N curve of a material has a rule of its own'
    integer, parameter :: most = 1000
    real(dp), allocatable :: cycles(:), stress(:)
    logical :: is_endless, has(2)
    integer :: i

    call read_material(reader, geared, self%limits, error)
    call read_load_factors(reader, geared, self%limits%has_material(), self%rule%factors, error)
    call reader%get(group, 'curve_cycles', cycles, error, tasks=group, is_stated=has(1), not_allowed=geared, &
                    at_least=1.0_dp, at_most=1e30_dp, max_size=most, default_note='the S-N curve of &rating material', &
                    meaning='cycles to failure at the points of an S-N curve of the tooth root, ascending, in place of that of '// &
                    '&rating material')
    call reader%get(group, 'curve_stress_mpa', stress, error, unit='MPa', tasks=group, is_stated=has(2), not_allowed=geared, &
                    above=0.0_dp, at_most=1e6_dp, max_size=most, default_note='the S-N curve of &rating material', &
                    meaning='stress amplitude at these points, fully reversed, descending')
    is_endless = .true.
    call reader%get(group, 'endless', is_endless, error, tasks=group, &
                    not_allowed=first_nonblank(geared, text_unless(any(has), of_own)), &
                    meaning='amplitudes below the last point of the curve do no harm; false: its last line goes on')
    call self%read_strength(reader, first_nonblank(geared, text_unless(any(has), of_own)), error)
    if (allocated(error)) return
    if (has(1) .neqv. has(2)) then
      call fail(error, code_input, '&life curve_'//trim(merge('stress_mpa', 'cycles    ', has(1)))// &
                ': is missing; curve_cycles and curve_stress_mpa go together')
    else if (has(1)) then
      if (size(cycles) /= size(stress)) then
        call fail(error, code_input, '&life curve_stress_mpa: has '//str(size(stress))//' numbers, curve_cycles has '// &
                  str(size(cycles)))
      else if (size(cycles) < 2) then
        call fail(error, code_input, '&life curve_cycles: a curve has two points or more')
      end if
      if (allocated(error)) return
      do i = 2, size(cycles)
        if (cycles(i) <= cycles(i - 1)) call fail(error, code_input, '&life curve_cycles: must ascend; '//str(cycles(i))// &
                                                  ' comes after '//str(cycles(i - 1)))
        if (stress(i) >= stress(i - 1)) call fail(error, code_input, '&life curve_stress_mpa: must descend; '// &
                                                  str(mega*stress(i))//' comes after '//str(mega*stress(i - 1)))
      end do
    end if
    do i = 1, 2
      if (self%limits%has_material()) self%rule%contact(i) = sn_curve(self%limits%contact(i), self%limits%contact_life(i))
      if (has(1)) then
        self%rule%curve(i) = curve_t(cycles, stress, is_endless)
      else if (self%limits%has_material()) then
        ! Amplitude: half of the stress that rises from zero.
        self%rule%curve(i) = sn_curve(self%limits%root(i)/2, self%limits%root_life(i))
        self%rule%strength(i) = strength_t(by_iso, self%rule%curve(i)%stress(1))
      end if
    end do
  end subroutine read_curves

  !> Checks that the lists of the spectrum have the same length.
  subroutine check(self, facts, error)
    class(life_task_t), intent(in) :: self
    type(case_facts_t), intent(in) :: facts
    type(error_t), allocatable, intent(inout) :: error

    call check_reliefs(self, facts, error)
    if (.not. allocated(self%own_rpm)) return
    call compare('duration_h', self%duration)
    call compare('load_factor', self%load_factor)

  contains

    subroutine compare(key, list)
      character(*), intent(in) :: key
      real(dp), allocatable, intent(in) :: list(:)

      if (.not. allocated(list)) return
      if (size(list) /= size(self%own_rpm)) call fail(error, code_input, '&life '//key//': has '//str(size(list))// &
        ' numbers, rpm has '//str(size(self%own_rpm)))
    end subroutine compare
  end subroutine check

  subroutine run(self, stages, error)
    class(life_task_t), intent(inout) :: self
    type(stages_t), intent(in) :: stages
    type(error_t), allocatable, intent(inout) :: error
    type(part_t), allocatable :: parts(:, :)             ! (part of the spectrum, relief)
    type(spectrum_t) :: spectrum
    type(nominal_t) :: nominal
    character(material_length) :: of_root(2)
    integer, allocatable :: which(:)
    integer :: i, k

    if (allocated(error)) return
    self%rule%factors%application = stages%iso%application_factor
    self%rule%factors%face_load = face_load_factor(stages, self%rule%factors%face_load)
    self%rule%has_face = stages%faces%are_uneven()
    call find_nominal(stages, self%rule%factors%face_load, no_grade, nominal, error)
    if (self%rule%has_face) self%rule%root_face_load = nominal%root_face_load
    if (.not. allocated(self%load_factor)) allocate (self%load_factor(size(self%own_rpm)), source=1.0_dp)
    call self%list_reliefs(stages, which)
    call claim_memory(1000.0_dp*size(which)*size(self%own_rpm), '&life rpm: '//str(size(which)*size(self%own_rpm))// &
                      ' parts', error)
    if (allocated(error)) return
    allocate (parts(size(self%own_rpm), size(which)))
    do i = 1, size(which)
      do k = 1, size(self%own_rpm)
        if (wants_stop(stages%accuracy%steady%stop)) return
        call follow_part(stages, which(i), self%own_rpm(k), self%load_factor(k), self%duration(k), self%rule, &
                         nominal, parts(k, i), error)
        if (allocated(error)) return
        if (self%rule%dynamic_load) call stages%running%report_progress(1, stages%accuracy%steady%stop)
      end do
    end do
    spectrum = spectrum_t(self%own_rpm, self%load_factor, self%duration)
    call fill_parts(self%rule, spectrum, stages%amount(which), parts, self%tables(self%place('life_parts')), error)
    call fill_life(self%rule, spectrum, stages%amount(which), parts, self%tables(self%place('life')), error)
    if (.not. allocated(error)) call add_equal_flanks(stages%pair, 2*size(which), self%tables(self%place('life')))
    of_root = self%limits%material
    if (self%rule%strength(1)%rule /= by_iso) of_root = 'stated'
    call fill_curve(self%rule%curve, 'root stress amplitude: fully reversed of a stated curve, of a material with a stress '// &
                    'that rises from zero', of_root, self%tables(self%place('life_curve')), error)
    if (self%rule%has_contact()) call fill_curve(self%rule%contact, 'contact stress sigma_H', self%limits%material, &
                                                 self%tables(self%place('contact_curve')), error)
    self%is_done = .true.
    self%is_stopped = any(parts%status == status_stopped)
    self%failed = count(.not. has_result(parts%status))
    self%log = 'life: '//str(size(parts))//' parts of load spectra followed'
  end subroutine run

  pure subroutine add_report(self, lines)
    class(life_task_t), intent(in) :: self
    type(lines_t), intent(inout) :: lines

    associate (life => self%tables(self%place('life')))
      call lines%add('')
      call lines%add('Life of the tooth roots'//trim(merge(' and flanks', '           ', self%rule%has_contact())))
      if (self%rule%strength(1)%rule /= by_iso) then
        associate (curve => self%rule%curve(1), n => size(self%rule%curve(1)%cycles))
          call lines%add('   S-N curve of the root, as stated: '//str(mega*curve%stress(1), 5)//' MPa at '//str(curve%cycles(1))// &
                         ' cycles to '//str(mega*curve%stress(n), 5)//' MPa at '//str(curve%cycles(n)))
        end associate
      end if
      if (self%rule%has_contact()) call add_life_curves(self%limits, lines)
      if (self%rule%has_face) call lines%add('   flanks with K_H_beta '//str(self%rule%factors%face_load, 4)// &
        ', roots with K_F_beta '//str(self%rule%root_face_load, 4)//' by the load over the face width')
      call life%show(lines, 'relief_um gear largest_root_stress_mpa damage kind life_h largest_contact_stress_mpa '// &
                     'contact_damage contact_kind contact_life_h')
      call add_several(self%tables(self%place('life_parts')), lines)
      call add_caution(life, lines)
    end associate
  end subroutine add_report
end module gearsweep_study_tasks_life
