!> The task `optimum`: the relief that is best over all speeds and torques, by dynamic factor, static or dynamic transmission error;
!> also amounts and lengths of both gears' reliefs together.
module gearsweep_study_tasks_optimum
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use gearsweep_base, only: axis, code_input, code_memory, dp, error_t, fail, fixed, left, lines_t, no_number, pi, str, table_t
  use gearsweep_motion, only: find_joint_optimum, find_optimum, has_result, joint_optimum_t, most_tried, optimum_t, oscillator_t, &
    point_t, sweep_options_t
  use gearsweep_study_case_task, only: case_facts_t, stage, task_info_t
  use gearsweep_study_reader_reader, only: first_nonblank, reader_t, sentence_length, text_unless
  use gearsweep_study_run_case_variation, only: largest_relief, with_relief
  use gearsweep_study_run_points, only: find_point
  use gearsweep_study_run_stages, only: runnable_t, stages_t
  use gearsweep_study_tasks_relief_judge, only: amount_curve_t, by_dte, by_factor, by_harmonic, by_range, curve_of, design_starts, &
    designs_t, errors_t, find_errors, judge, judge_t, judged_words, make_designs, relief_of, scan_amounts
  implicit none
  private
  public :: optimum_task_t, fill_best, fill_curve

  character(*), parameter :: names(4) = [character(20) :: 'worst_dynamic_factor', 'ste_peak_to_peak_um', 'mesh_harmonic_um', &
                                         'dte_rms_um']
  character(*), parameter :: of_factor = 'largest DF over the speeds; NaN where none has an answer', &
    of_dte = 'root mean square of the dynamic transmission error about its mean: the quadratic mean over the speeds; NaN where '// &
    'none has an answer', of_range = 'peak-to-peak static transmission error', of_harmonic = 'amplitude of the harmonic of the '// &
    'static transmission error that &optimum harmonic names', of_rpm = 'speed of the pinion '// &
    'where what is judged is largest', of_failed = 'speeds without an answer', &
    of_bound = '1: computed at a few speeds only, which show that this relief is not the best; the largest DF is theirs; else 0'

  type, extends(runnable_t) :: optimum_task_t
    logical :: with_length = .false., each_gear = .false.
    type(judge_t) :: judge                       !< quantity to minimise, from the keys, and in a run the designs
    logical :: is_weighted = .false.
    real(dp), allocatable :: share(:)            !< weight of each torque; not allocated: equal weights
    real(dp), allocatable :: torque(:)           !< in a run, torque of each load, N m; NaN: not known
  contains
    procedure, nopass :: describe
    procedure :: read_keys, check, uses, run, add_report, count_points
    procedure, private :: is_joint, set_loads, find_amount, search_jointly, add_judged
  end type optimum_task_t

  character(*), parameter :: group = 'optimum'
  integer, parameter :: stages_needed(*) = [stage%mesh, stage%reliefs, stage%motion, stage%losses, stage%accuracy, stage%speeds, &
                                            stage%direction]

contains

  pure subroutine describe(info)
    type(task_info_t), intent(out) :: info

    info = task_info_t(group, needs=stages_needed, &
                       tables='optimum optimum_curve optimum_map optimum_design optimum_loads', fields='', &
                       summary='the relief of least dynamic factor or transmission error over all speeds and several torques')
  end subroutine describe

  !> The motion and its speeds are needed if the criterion depends on them.
  pure logical function uses(self, which)
    class(optimum_task_t), intent(in) :: self
    integer, intent(in) :: which                 !< index of the stage in `stage`

    uses = any(stages_needed == which) .and. (self%judge%needs_motion() .or. any([stage%mesh, stage%reliefs] == which))
  end function uses

  subroutine read_keys(self, reader, error)
    class(optimum_task_t), intent(inout) :: self
    type(reader_t), intent(inout) :: reader
    type(error_t), allocatable, intent(inout) :: error
    character(:), allocatable :: word
    character(sentence_length) :: several

    call reader%add_group(group, 'The task optimum: by what reliefs are judged, and what is varied beside their amount.')
    if (reader%has(group, 'load_factors')) call fail(error, code_input, &
      '&optimum load_factors: is no key; list the torques in &load torques_nm')
    several = text_unless(reader%has('load', 'torques_nm'), '&load torques_nm')
    word = trim(judged_words(self%judge%by))
    call reader%get(group, 'judged', word, error, tasks=group, allowed=judged_words, &
                    meaning='what is to be least: the largest dynamic factor over the speeds, the peak-to-peak static '// &
                    'transmission error, the amplitude of one of its harmonics, or the quadratic mean over the speeds of the '// &
                    'dynamic transmission error''s root mean square; by the static ones no motion is computed')
    self%judge%by = max(1, findloc(judged_words == word, .true., 1))
    call reader%get(group, 'harmonic', self%judge%harmonic, error, tasks=group, at_least=1, at_most=100, &
                    meaning='harmonic of the mesh frequency in mesh_harmonic')
    word = 'worst'
    call reader%get(group, 'over_torques', word, error, tasks=group, unused_without=merge(several, repeat(' ', sentence_length), &
                    reader%requests(group)), allowed=[character(8) :: 'worst', 'weighted'], &
                    meaning='of several torques the worst one counts, or the mean weighted by torque_shares')
    self%is_weighted = word == 'weighted'
    call reader%get('load', 'torque_shares', self%share, error, tasks=group, &
                    not_allowed=first_nonblank(text_unless(self%is_weighted, 'needs &optimum over_torques = ''weighted'''), &
                    text_unless(len_trim(several) == 0, 'needs torques_nm')), &
                    above=0.0_dp, at_most=1e12_dp, min_size=1, max_size=20, default_note='all alike', &
                    meaning='what each of torques_nm counts in the weighted mean, such as its share of time; divided by their sum')
    call reader%get(group, 'with_length', self%with_length, error, tasks=group, &
                    meaning='amount and length of the relief are varied together; its shape stays')
    call reader%get(group, 'each_gear', self%each_gear, error, tasks=group, &
                    meaning='the reliefs of pinion and gear are varied each by itself, instead of by gear_fraction')
  end subroutine read_keys

  !> Checks that there are as many weights as torques.
  subroutine check(self, facts, error)
    class(optimum_task_t), intent(in) :: self
    type(case_facts_t), intent(in) :: facts
    type(error_t), allocatable, intent(inout) :: error

    if (.not. allocated(self%share)) return
    if (size(self%share) /= size(facts%torque)) call fail(error, code_input, '&load torque_shares: '//str(size(self%share))// &
      ' numbers for '//str(size(facts%torque))//' of torques_nm; must be one for each')
  end subroutine check

  !> Upper bound of the operating points, as the search may try some reliefs twice.
  integer function count_points(self, stages) result(points)
    class(optimum_task_t), intent(in) :: self
    type(stages_t), intent(in) :: stages

    points = most_tried*merge(size(stages%rpm), 0, self%uses(stage%speeds))
    if (allocated(stages%torque)) points = points*size(stages%torque)
  end function count_points

  subroutine run(self, stages, error)
    class(optimum_task_t), intent(inout) :: self
    type(stages_t), intent(in) :: stages
    type(error_t), allocatable, intent(inout) :: error
    type(amount_curve_t) :: curve
    real(dp) :: largest

    call self%set_loads(stages)
    call make_designs(self%judge%designs, 0.0_dp)
    call self%find_amount(stages, curve, error)
    if (allocated(error) .or. curve%stopped) return
    call find_largest(self%judge, stages, curve, largest, error)
    associate (judge => self%judge, best => curve%best)
      call fill_best(judge, self%torque, curve, largest, self%tables(self%place('optimum')), error)
      call fill_curve(judge, curve, self%tables(self%place('optimum_curve')), error)
      if (.not. ieee_is_nan(self%torque(1))) then
        call fill_map(judge, self%torque, curve, self%tables(self%place('optimum_map')), error)
        if (best > 0 .and. .not. self%is_joint()) call fill_loads(judge, self%torque, curve%of_load(:, best), &
          curve%rpm(:, best), curve%failed(:, best), curve%errors(best), self%tables(self%place('optimum_loads')), error)
      end if
    end associate
    self%failed = merge(sum(curve%failed(:, max(1, curve%best))), sum(curve%failed), curve%best > 0)
    if (.not. allocated(error)) call self%search_jointly(stages, curve, error)
    if (allocated(error) .or. self%is_stopped) return
    self%is_done = .true.
    self%judge%options = sweep_options_t()       ! they point to flags of this run
    self%log = 'optimum: '//str(size(curve%amount))//' reliefs '//trim(merge('swept ', 'judged', self%judge%needs_motion()))
  end subroutine run

  !> Sets the loads of the case and the inputs of the speeds.
  subroutine set_loads(self, stages)
    class(optimum_task_t), intent(inout) :: self
    type(stages_t), intent(in) :: stages
    type(designs_t) :: designs

    associate (judge => self%judge, inputs => stages%motions_inputs)
      judge%options = stages%sweep_options()
      judge%rpm = stages%rpm
      if (allocated(stages%torque)) then
        self%torque = stages%torque
        designs%of_load = stages%of_torque
      else
        self%torque = [no_number()]
        if (stages%base_pitch > 0 .and. inputs%motion%teeth(1) > 0) &
          self%torque = [stages%load*stages%base_pitch*inputs%motion%teeth(1)/(2*pi)]
        ! An array constructor of such a type leaks memory with gfortran 12.
        allocate (designs%of_load(1))
        designs%of_load(1) = inputs
      end if
      designs%inputs = inputs
      judge%designs = designs
      if (self%is_weighted) then
        judge%share = spread(1.0_dp, 1, size(self%torque))
        if (allocated(self%share)) judge%share = self%share
        judge%share = judge%share/sum(judge%share)
      end if
    end associate
  end subroutine set_loads

  !> Finds the best single amount. Under one load, the search for the least dynamic factor skips speeds that cannot be the worst.
  subroutine find_amount(self, stages, curve, error)
    class(optimum_task_t), intent(in) :: self
    type(stages_t), intent(in) :: stages
    type(amount_curve_t), intent(out) :: curve
    type(error_t), allocatable, intent(inout) :: error
    type(optimum_t) :: optimum

    associate (inputs => stages%motions_inputs, judge => self%judge)
      if (judge%by /= by_factor .or. size(self%torque) > 1) then
        call scan_amounts(judge, largest_relief(inputs), stages%running, curve, error)
        return
      end if
      if (associated(stages%running%progress)) then
        call find_optimum(with_relief, inputs, largest_relief(inputs), stages%rpm, judge%options, optimum, error, &
                          stages%running%progress)
      else
        call find_optimum(with_relief, inputs, largest_relief(inputs), stages%rpm, judge%options, optimum, error)
      end if
      if (.not. allocated(error)) call curve_of(judge, largest_relief(inputs), optimum, curve, error)
      if (allocated(error)) return
      if (.not. curve%stopped) stages%running%done = stages%running%done + size(curve%amount)*size(stages%rpm)
    end associate
  end subroutine find_amount

  !> Finds the largest dynamic factor of all known motions with the best relief at its worst speed and load: its own, and those that
  !> a start reaches; NaN: there is none.
  subroutine find_largest(judge, stages, curve, largest, error)
    type(judge_t), intent(in) :: judge
    type(stages_t), intent(in) :: stages
    type(amount_curve_t), intent(in) :: curve
    real(dp), intent(out) :: largest
    type(error_t), allocatable, intent(inout) :: error
    type(oscillator_t) :: motion
    type(point_t) :: point
    integer :: motions, worst
    logical :: out_of_memory

    largest = no_number()
    if (allocated(error) .or. curve%best == 0 .or. judge%by /= by_factor) return
    worst = maxloc(curve%of_load(:, curve%best), 1)
    call with_relief(judge%designs%of_load(worst), curve%amount(curve%best), motion, error)
    if (allocated(error)) return
    call find_point(motion, curve%rpm(worst, curve%best), stages%accuracy, point, motions, out_of_memory)
    if (out_of_memory) call fail(error, code_memory, '&case tasks = ''optimum'': the memory does not hold all motions at a speed')
    largest = curve%of_load(worst, curve%best)
    if (has_result(point%steady%status)) largest = max(largest, point%dynamic_factor)
  end subroutine find_largest

  !> True if several variables are optimised.
  pure logical function is_joint(self)
    class(optimum_task_t), intent(in) :: self

    is_joint = self%with_length .or. self%each_gear
  end function is_joint

  !> Optimises several variables at once, if the keys request it.
  subroutine search_jointly(self, stages, curve, error)
    class(optimum_task_t), intent(inout) :: self
    type(stages_t), intent(in) :: stages
    type(amount_curve_t), intent(in) :: curve    ! curve of a single amount
    type(error_t), allocatable, intent(inout) :: error
    type(joint_optimum_t) :: optimum
    type(errors_t) :: errors
    real(dp) :: amount

    if (.not. self%is_joint()) return
    amount = -1
    if (curve%best > 0) amount = curve%amount(curve%best)
    self%judge%designs%with_length = self%with_length
    self%judge%designs%each_gear = self%each_gear
    call make_designs(self%judge%designs, amount)
    self%judge%options = stages%sweep_options()
    call find_joint_optimum(judge, self%judge, design_starts(self%judge%designs, amount), optimum, error)
    if (allocated(error)) return
    self%is_stopped = optimum%stopped
    if (self%is_stopped) return
    associate (best => optimum%best)
      if (allocated(best%value)) self%failed = sum(best%failed)
      if (allocated(best%value)) call find_errors(self%judge, best%number, errors, error)
      call fill_design(self%judge, optimum, errors, self%tables(self%place('optimum_design')), error)
      if (allocated(best%value) .and. .not. ieee_is_nan(self%torque(1))) call fill_loads(self%judge, self%torque, best%of_load, &
        best%rpm, best%failed, errors, self%tables(self%place('optimum_loads')), error)
    end associate
  end subroutine search_jointly

  !> Reports one optimum: of the amount, or of all variables.
  pure subroutine add_report(self, lines)
    class(optimum_task_t), intent(in) :: self
    type(lines_t), intent(inout) :: lines
    real(dp), parameter :: alike = 1e-4_dp       ! relative tolerance, as printed
    character(20) :: name
    real(dp) :: value
    integer :: i

    associate (best => self%tables(self%place('optimum')), design => self%tables(self%place('optimum_design')))
      if (ieee_is_nan(best%number('relief_um'))) then
        call lines%add(left('Best relief', 19)//'none: no operating point has an answer')
        return
      end if
      if (.not. design%is_there()) then
        name = value_name(self%judge)
        associate (curve => self%tables(self%place('optimum_curve')), loads => self%tables(self%place('optimum_loads')))
          call lines%add(left('Best single amount', 19)//str(best%number('relief_um'), 4)//' um (within '// &
                         str(best%number('within_um'), 1)//'),')
          call self%add_judged(lines)
          call lines%put(left('', 19)//trim(value_in(self%judge, best%number(trim(name)))))
          if (.not. allocated(self%judge%share)) then
            if (best%position('rpm') > 0) call lines%put(' at '//str(best%number('rpm'))//' rpm')
            if (size(self%torque) > 1) call lines%put(' under '//str(best%number('torque_nm'))//' N m')
          end if
          if (.not. self%judge%needs_motion()) call lines%put('; without relief '//str(curve%number(trim(name), 1), 4)//' um')
          call lines%add('')
          if (best%position('largest_dynamic_factor') > 0) then
            value = best%number('worst_dynamic_factor')
            if (loads%is_there()) value = maxval(loads%numbers('worst_dynamic_factor'))
            if (best%number('largest_dynamic_factor') > (1 + alike)*value) call lines%add(left('', 19)// &
              'of all motions that a start reaches at this speed, the largest has DF '// &
              fixed(best%number('largest_dynamic_factor'), 4)//' (task attractors)')
          end if
          if (.not. best%number('relief_um') < curve%number('relief_um', curve%rows)) call lines%add(left('', 19)// &
            'at the end of the range searched: more relief may be better still')
        end associate
      else if (.not. ieee_is_nan(design%number('pinion_relief_um'))) then
        call lines%add(left('Best design', 19)//'pinion '//trim(relief_in(design, 'pinion'))//', gear '// &
                       trim(relief_in(design, 'gear'))//',')
        call self%add_judged(lines)
        call lines%add(left('', 19)//trim(value_in(self%judge, design%number(trim(value_name(self%judge))))))
      end if
    end associate
    if (self%failed > 0) call lines%add(left('', 19)//str(self%failed)//' speeds have no answer there')
    associate (loads => self%tables(self%place('optimum_loads')))
      if (size(self%torque) < 2 .or. .not. loads%is_there()) return
      do i = 1, loads%rows
        value = loads%number(trim(value_name(self%judge)), i)
        if (ieee_is_nan(value)) cycle
        call lines%put(left('', 19)//'   '//str(loads%number('torque_nm', i))//' N m: '//trim(value_in(self%judge, value)))
        if (loads%position('rpm') > 0) call lines%put(' at '//str(loads%number('rpm', i))//' rpm')
        call lines%add('')
      end do
    end associate
  end subroutine add_report

  !> Adds the line with the criterion of the reliefs and the load or torques.
  pure subroutine add_judged(self, lines)
    class(optimum_task_t), intent(in) :: self
    type(lines_t), intent(inout) :: lines
    character(:), allocatable :: words
    integer :: i

    select case (self%judge%by)
    case (by_factor)
      words = left('', 19)//'judged by the largest dynamic factor over the speeds'
    case (by_range)
      words = left('', 19)//'judged by the peak-to-peak static transmission error'
    case (by_harmonic)
      words = left('', 19)//'judged by mesh harmonic '//str(self%judge%harmonic)//' of the static transmission error'
    case default
      words = left('', 19)//'judged by the rms of the dynamic transmission error over the speeds'
    end select
    if (size(self%torque) == 1) then
      if (.not. ieee_is_nan(self%torque(1))) words = words//', under '//str(self%torque(1), 6)//' N m'
      call lines%add(words)
      return
    end if
    words = words//trim(merge(', weighted mean over torques', ', worst over torques        ', allocated(self%judge%share)))
    do i = 1, size(self%torque)
      if (i > 1) words = words//','
      words = words//' '//str(self%torque(i))
    end do
    call lines%add(words//' N m')
  end subroutine add_judged

  !> Name of the criterion's column.
  pure function value_name(judge) result(name)
    type(judge_t), intent(in) :: judge
    character(len(names)) :: name

    name = names(judge%by)
  end function value_name

  !> Fills one row: the best amount.
  pure subroutine fill_best(judge, torque, curve, largest, table, error)
    type(judge_t), intent(in) :: judge
    real(dp), intent(in) :: torque(:)            !< torque of each load, N m; NaN: not known
    type(amount_curve_t), intent(in) :: curve
    real(dp), intent(in) :: largest              !< largest dynamic factor of all motions at the worst speed
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp) :: best(6)
    integer :: failed, at

    if (allocated(error)) return
    call table%begin('the best amount of relief, and by what it is judged', 1, error)
    if (allocated(error)) return
    best = no_number()
    failed = sum(curve%failed)
    if (curve%best > 0) then
      associate (k => curve%best)
        at = maxloc(curve%of_load(:, k), 1)
        best = [curve%amount(k), curve%value(k), judge%combined(curve%errors(k)%range), &
                judge%combined(curve%errors(k)%amplitude), curve%rpm(at, k), torque(at)]
        failed = sum(curve%failed(:, k))
      end associate
    end if
    call table%add('relief_um', 'um', 'best amount of relief; NaN where no point has an answer', best(1:1))
    if (judge%needs_motion()) then
      call add_value(judge, best(2:2), ' (over several torques as over_torques says)', table)
      call table%add('rpm', '1/min', of_rpm//', under the worst torque', best(5:5))
    end if
    if (judge%by == by_factor) call table%add('largest_dynamic_factor', '', 'largest DF at that speed of all motions that are '// &
      'known: its own, and those that a start reaches; NaN where there is none', [largest])
    call table%add('within_um', 'um', 'largest distance to the true optimum', [curve%resolution])
    if (judge%needs_motion()) call table%add('points_without_answer', '', 'speeds without an answer there; of all reliefs '// &
      'where no point has one', [failed])
    call table%add('ste_peak_to_peak_um', 'um', of_range//', over several torques as over_torques says', best(3:3))
    call table%add('mesh_harmonic_um', 'um', of_harmonic//', over several torques as over_torques says', best(4:4))
    call table%add('torque_nm', 'N m', 'the torque on the pinion under which what is judged is largest; NaN: not known', best(6:6))
    call table%add_words('judged', 'what is judged: &optimum judged', [judged_words(judge%by)])
    call table%add_words('over_torques', 'which of several torques counts: the worst, or their weighted mean', &
                         [merge('weighted', 'worst   ', allocated(judge%share))])
  end subroutine fill_best

  !> Fills the curve over the amounts (of largest dynamic factors: Dogan et al. 2021, Fig. 8).
  pure subroutine fill_curve(judge, curve, table, error)
    type(judge_t), intent(in) :: judge
    type(amount_curve_t), intent(in) :: curve
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    integer :: i, n
    integer, allocatable :: at(:)

    if (allocated(error)) return
    n = size(curve%amount)
    call table%over('what is judged against the relief, all torques together', error, &
                    axis('relief_um', 'um', 'amount of relief, ascending', curve%amount))
    if (allocated(error)) return
    if (judge%needs_motion()) then
      at = [(max(1, maxloc(curve%of_load(:, i), 1)), i=1, n)]
      call add_value(judge, curve%value, '', table)
      call table%add('rpm', '1/min', of_rpm, [(curve%rpm(at(i), i), i=1, n)])
      call table%add('points_without_answer', '', of_failed, sum(curve%failed, 1))
      call table%add('at_least', '', of_bound, merge(1, 0, curve%is_bound))
    end if
    call table%add('ste_peak_to_peak_um', 'um', of_range, [(judge%combined(curve%errors(i)%range), i=1, n)])
    call table%add('mesh_harmonic_um', 'um', of_harmonic, [(judge%combined(curve%errors(i)%amplitude), i=1, n)])
  end subroutine fill_curve

  !> Fills the map over amounts and torques.
  pure subroutine fill_map(judge, torque, curve, table, error)
    type(judge_t), intent(in) :: judge
    real(dp), intent(in) :: torque(:)            !< torque of each load, N m
    type(amount_curve_t), intent(in) :: curve
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    integer :: i, n

    if (allocated(error)) return
    n = size(curve%amount)
    call table%over('transmission error and what is judged, for each relief that was tried under each torque', error, &
                    axis('relief_um', 'um', 'amount of relief, ascending', curve%amount), &
                    axis('torque_nm', 'N m', 'torque on the pinion', torque))
    if (allocated(error)) return
    call table%add('ste_peak_to_peak_um', 'um', of_range, [(curve%errors(i)%range, i=1, n)])
    call table%add('mesh_harmonic_um', 'um', of_harmonic, [(curve%errors(i)%amplitude, i=1, n)])
    if (.not. judge%needs_motion()) return
    call add_value(judge, [curve%of_load], '', table)
    call table%add('rpm', '1/min', of_rpm, where_known([curve%rpm]))
    call table%add('points_without_answer', '', of_failed, [curve%failed])
    call table%add('at_least', '', of_bound, [(spread(merge(1, 0, curve%is_bound(i)), 1, size(torque)), i=1, size(curve%amount))])
  end subroutine fill_map

  !> Fills the best design and its error estimates.
  pure subroutine fill_design(judge, optimum, errors, table, error)
    type(judge_t), intent(in) :: judge
    type(joint_optimum_t), intent(in) :: optimum
    type(errors_t), intent(in) :: errors         !< errors of the design
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp) :: amount(2), start(2), diameter(2), value(3)

    if (allocated(error)) return
    call table%begin('the best reliefs of both gears, by what is judged', 1, error)
    if (allocated(error)) return
    amount = no_number()
    start = no_number()
    diameter = no_number()
    value = no_number()
    if (allocated(optimum%best%value)) then
      call relief_of(judge%designs, optimum%best%number, amount, start)
      associate (relief => judge%designs%inputs%motion%relief)
        if (.not. relief%prescribed) diameter = 2*relief%pair%radius([1, 2], start)
      end associate
      value = [judge%combined(optimum%best%of_load), judge%combined(errors%range), judge%combined(errors%amplitude)]
    end if
    call table%add('pinion_relief_um', 'um', 'amount of relief at the pinion''s tip; NaN where no point has an answer', amount(1:1))
    call table%add('gear_relief_um', 'um', 'at the gear''s', amount(2:2))
    call table%add('pinion_relief_start', '', 'path coordinate at which the pinion''s relief begins, in base pitches from A', &
                   start(1:1))
    call table%add('gear_relief_start', '', 'at which the gear''s begins', start(2:2))
    call table%add('pinion_start_diameter_mm', 'mm', 'diameter of the pinion at which its relief begins; NaN for a '// &
                   'prescribed mesh', diameter(1:1))
    call table%add('gear_start_diameter_mm', 'mm', 'the same of the gear', diameter(2:2))
    if (judge%needs_motion()) call add_value(judge, value(1:1), ' (over several torques as over_torques says)', table)
    call table%add('within', '', 'no better design was found within this part of the ranges, up and down', [optimum%within])
    call table%add('designs_tried', '', 'designs tried', [optimum%tried])
    call table%add('ste_peak_to_peak_um', 'um', of_range//', over several torques as over_torques says', value(2:2))
    call table%add('mesh_harmonic_um', 'um', of_harmonic//', over several torques as over_torques says', value(3:3))
  end subroutine fill_design

  !> Fills the results of the best reliefs under each torque.
  pure subroutine fill_loads(judge, torque, of_load, rpm, failed, errors, table, error)
    type(judge_t), intent(in) :: judge
    real(dp), intent(in) :: torque(:), of_load(:), rpm(:)  !< torque, N m; value of the criterion; speed, 1/min; (load)
    integer, intent(in) :: failed(:)             !< number of speeds that did not converge
    type(errors_t), intent(in) :: errors
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error

    if (allocated(error)) return
    call table%over('the best reliefs under each torque', error, axis('torque_nm', 'N m', 'torque on the pinion', torque))
    if (allocated(error)) return
    call table%add('ste_peak_to_peak_um', 'um', of_range, errors%range)
    call table%add('mesh_harmonic_um', 'um', of_harmonic, errors%amplitude)
    if (allocated(judge%share)) call table%add('share', '', 'of this torque in the weighted mean', judge%share)
    if (.not. judge%needs_motion()) return
    call add_value(judge, of_load, '', table)
    call table%add('rpm', '1/min', of_rpm, where_known(rpm))
    call table%add('points_without_answer', '', of_failed, failed)
  end subroutine fill_loads

  !> Adds the column of the criterion, if that depends on the motion.
  pure subroutine add_value(judge, value, more, table)
    type(judge_t), intent(in) :: judge
    real(dp), intent(in) :: value(:)             ! dynamic factors, or lengths in m
    character(*), intent(in) :: more
    type(table_t), intent(inout) :: table

    if (judge%by == by_factor) call table%add(trim(names(by_factor)), '', of_factor//more, value)
    if (judge%by == by_dte) call table%add(trim(names(by_dte)), 'um', of_dte//more, value)
  end subroutine add_value

  !> Speeds, NaN for none.
  elemental real(dp) function where_known(rpm)
    real(dp), intent(in) :: rpm

    where_known = rpm
    if (.not. rpm > 0) where_known = no_number()
  end function where_known

  !> Value in the unit of tables, with its name and unit.
  pure function value_in(judge, value) result(words)
    type(judge_t), intent(in) :: judge
    real(dp), intent(in) :: value
    character(40) :: words

    select case (judge%by)
    case (by_factor)
      words = 'worst DF '//fixed(value, 4)
    case (by_range)
      words = 'peak-to-peak STE '//str(value, 4)//' um'
    case (by_harmonic)
      words = 'amplitude '//str(value, 4)//' um'
    case default
      words = 'DTE rms '//str(value, 4)//' um'
    end select
  end function value_in

  !> Amount of a gear's relief and its start: a diameter, if the gear is known.
  pure function relief_in(table, gear) result(text)
    type(table_t), intent(in) :: table
    character(*), intent(in) :: gear             ! pinion or gear
    character(80) :: text

    text = str(table%number(gear//'_relief_um'), 4)//' um from'
    if (ieee_is_nan(table%number(gear//'_start_diameter_mm'))) then
      text = trim(text)//' s = '//str(table%number(gear//'_relief_start'), 4)
    else
      text = trim(text)//' '//fixed(table%number(gear//'_start_diameter_mm'), 3)//' mm diameter'
    end if
  end function relief_in
end module gearsweep_study_tasks_optimum
