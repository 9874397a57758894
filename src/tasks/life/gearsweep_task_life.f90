!> The task `life`: how long the tooth roots of both gears last under a load spectrum, from the root stress of each engagement
!> under the load of the motion.
module gearsweep_task_life
  use gearsweep_decimal, only: in_um
  use gearsweep_equal_flanks, only: add_caution, add_equal_flanks
  use gearsweep_error, only: code_input, error_t, fail
  use gearsweep_fatigue, only: by_gerber, by_goodman, by_soderberg, structural_steel
  use gearsweep_kinds, only: dp
  use gearsweep_life_parts, only: follow_part, life_rule_t, part_t
  use gearsweep_lines, only: left, lines_t, right
  use gearsweep_memory, only: claim_memory
  use gearsweep_points, only: add_several, known_count, of_factor, of_motions, of_relief, of_speed, of_status, words_of
  use gearsweep_reader, only: reader_t
  use gearsweep_root_life, only: root_life_t
  use gearsweep_status, only: has_result, status_stopped
  use gearsweep_stop, only: wants_stop
  use gearsweep_table, only: axis, each, no_number, table_t
  use gearsweep_stages, only: runnable_t, stages_t
  use gearsweep_task, only: case_facts_t, check_reliefs, members, needs_moving, stage, task_info_t
  use gearsweep_text, only: str
  use gearsweep_uses, only: first_of, is_prescribed, needs_gears, sentence_length, unless
  implicit none
  private
  public :: life_task_t

  type, extends(runnable_t) :: life_task_t
    real(dp), allocatable :: load_factor(:)      !< of each part of the spectrum: its load over that of the case
    real(dp), allocatable :: duration(:)         !< of each part, s
    type(life_rule_t) :: rule
  contains
    procedure, nopass :: describe
    procedure :: read_keys, check, uses, run, add_report
    procedure, private :: read_spectrum, read_strength, read_curve, follow, fill_parts, fill_life, fill_curve
  end type life_task_t

  character(*), parameter :: group = 'life'
  integer, parameter :: stages_needed(*) = [stage%geometry, stage%rims, stage%mesh, stage%reliefs, stage%amounts, stage%motion, &
                                            stage%losses, stage%accuracy]
  real(dp), parameter :: mega = 1e-6_dp, hour = 3600
  integer, parameter :: word_length = 10

contains

  pure subroutine describe(info)
    type(task_info_t), intent(out) :: info

    info = task_info_t(group, needs=stages_needed, tables='life life_parts life_curve', fields='', &
                       gives='how long the tooth roots last under a load spectrum, by S-N curve, mean stress and Miner''s sum')
  end subroutine describe

  !> The motion matters for the dynamic load alone.
  pure logical function uses(self, which)
    class(life_task_t), intent(in) :: self
    integer, intent(in) :: which                 !< of `stage`

    uses = needs_moving(stages_needed, which, self%rule%dynamic_load)
  end function uses

  subroutine read_keys(self, reader, error)
    class(life_task_t), intent(inout) :: self
    type(reader_t), intent(inout) :: reader
    type(error_t), allocatable, intent(inout) :: error
    character(sentence_length) :: geared

    call reader%add_group(group, 'The task life: fatigue of the tooth roots under a load spectrum.')
    geared = unless(.not. is_prescribed(reader), needs_gears)
    call self%read_spectrum(reader, geared, error)
    call self%read_reliefs(reader, group, error)
    call reader%get(group, 'dynamic_load', self%rule%dynamic_load, error, tasks=group, refused=geared, &
                    meaning='the load of the motion at each speed; false: the static load, as stiffness and relief share it')
    call reader%get(group, 'stress_factor', self%rule%stress_factor, error, tasks=group, refused=geared, at_least=0.01_dp, &
                    at_most=100.0_dp, meaning='what raises the root stress beside K_A and the dynamic load: K_F_beta K_F_alpha')
    call reader%get(group, 'stress_ratio', self%rule%stress_ratio, error, tasks=group, refused=geared, at_least=-10.0_dp, &
                    at_most=0.0_dp, meaning='least stress of a revolution over its largest: 0 for teeth loaded on one flank, '// &
                    '-1 or less for an idler, whose teeth are loaded on both')
    call self%read_strength(reader, geared, error)
    call self%read_curve(reader, geared, error)
  end subroutine read_keys

  subroutine read_spectrum(self, reader, geared, error)
    class(life_task_t), intent(inout) :: self
    type(reader_t), intent(inout) :: reader
    character(*), intent(in) :: geared
    type(error_t), allocatable, intent(inout) :: error
    integer, parameter :: most = 1000

    call reader%get(group, 'rpm', self%own_rpm, error, unit='1/min', required=.true., tasks=group, refused=geared, &
                    at_least=1e-6_dp, at_most=1e9_dp, max_size=most, &
                    meaning='speed of the pinion in each part of the load spectrum')
    call reader%get(group, 'load_factor', self%load_factor, error, tasks=group, refused=geared, at_least=1e-6_dp, &
                    at_most=1e6_dp, max_size=most, otherwise='1 in each part', &
                    meaning='load of each part over that of the case')
    call reader%get(group, 'duration_h', self%duration, error, unit='h', required=.true., tasks=group, refused=geared, &
                    above=0.0_dp, at_most=1e12_dp, max_size=most, &
                    meaning='how long each part lasts within one pass of the spectrum')
  end subroutine read_spectrum

  subroutine read_strength(self, reader, geared, error)
    class(life_task_t), intent(inout) :: self
    type(reader_t), intent(inout) :: reader
    character(*), intent(in) :: geared
    type(error_t), allocatable, intent(inout) :: error
    character(*), parameter :: rules(0:3) = [character(9) :: 'none', 'goodman', 'gerber', 'soderberg']
    character(:), allocatable :: rule
    character(sentence_length) :: no_tensile, no_yield
    real(dp) :: tensile, yield_point

    rule = 'goodman'
    call reader%get(group, 'mean_stress', rule, error, tasks=group, refused=geared, allowed=rules, &
                    meaning='how the mean stress of a cycle counts')
    self%rule%strength%rule = findloc(rules == rule, .true., 1) - 1
    no_tensile = first_of(geared, unless(any(self%rule%strength%rule == [by_goodman, by_gerber]), &
                                         'mean_stress is neither goodman nor gerber; remove it'))
    no_yield = first_of(geared, unless(self%rule%strength%rule == by_soderberg, 'mean_stress is not soderberg; remove it'))
    tensile = 0
    yield_point = 0
    call reader%get(group, 'tensile_strength_mpa', tensile, error, unit='MPa', tasks=group, refused=no_tensile, &
                    required=len_trim(no_tensile) == 0, above=0.0_dp, at_most=1e6_dp, &
                    otherwise='required by goodman and gerber', meaning='tensile strength R_m')
    call reader%get(group, 'yield_strength_mpa', yield_point, error, unit='MPa', tasks=group, refused=no_yield, &
                    required=len_trim(no_yield) == 0, above=0.0_dp, at_most=1e6_dp, otherwise='required by soderberg', &
                    meaning='yield strength R_e')
    self%rule%strength%limit = merge(yield_point, tensile, self%rule%strength%rule == by_soderberg)
  end subroutine read_strength

  subroutine read_curve(self, reader, geared, error)
    class(life_task_t), intent(inout) :: self
    type(reader_t), intent(inout) :: reader
    character(*), intent(in) :: geared
    type(error_t), allocatable, intent(inout) :: error
    integer, parameter :: most = 1000
    logical :: has(2)
    integer :: i

    self%rule%curve = structural_steel()
    call reader%get(group, 'curve_cycles', self%rule%curve%cycles, error, tasks=group, given=has(1), refused=geared, &
                    at_least=1.0_dp, at_most=1e30_dp, max_size=most, otherwise='structural steel', &
                    meaning='cycles to failure at the points of an S-N curve, ascending')
    call reader%get(group, 'curve_stress_mpa', self%rule%curve%stress, error, unit='MPa', tasks=group, given=has(2), &
                    refused=geared, above=0.0_dp, at_most=1e6_dp, max_size=most, otherwise='structural steel', &
                    meaning='stress amplitude at these points, fully reversed, descending')
    call reader%get(group, 'endless', self%rule%curve%is_endless, error, tasks=group, refused=geared, &
                    meaning='amplitudes below the last point of the curve do no harm; false: its last line goes on')
    if (allocated(error)) return
    associate (cycles => self%rule%curve%cycles, stress => self%rule%curve%stress)
      if (has(1) .neqv. has(2)) then
        call fail(error, code_input, '&life curve_'//trim(merge('stress_mpa', 'cycles    ', has(1)))// &
                  ': is missing; curve_cycles and curve_stress_mpa go together')
      else if (size(cycles) /= size(stress)) then
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
    end associate
  end subroutine read_curve

  !> The lists of the spectrum are of one length.
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
    type(part_t), allocatable :: parts(:, :)
    integer, allocatable :: which(:)

    if (allocated(error)) return
    if (.not. allocated(self%load_factor)) allocate (self%load_factor(size(self%own_rpm)), source=1.0_dp)
    call self%list_reliefs(stages, which)
    call self%follow(stages, which, parts, error)
    if (allocated(error) .or. .not. allocated(parts)) return
    call self%fill_parts(stages%amount(which), parts, self%tables(self%place('life_parts')), error)
    call self%fill_life(stages%amount(which), parts, self%tables(self%place('life')), error)
    if (.not. allocated(error)) call add_equal_flanks(stages%pair, 2*size(which), self%tables(self%place('life')))
    call self%fill_curve(self%tables(self%place('life_curve')), error)
    self%is_done = .true.
    self%is_stopped = any(parts%status == status_stopped)
    self%failed = count(.not. has_result(parts%status))
    self%log = 'life: '//str(size(parts))//' parts of load spectra followed'
  end subroutine run

  !> Each part of the spectrum with each relief; not allocated where the run was interrupted.
  subroutine follow(self, stages, which, parts, error)
    class(life_task_t), intent(in) :: self
    type(stages_t), intent(in) :: stages
    integer, intent(in) :: which(:)
    type(part_t), allocatable, intent(out) :: parts(:, :)  ! (part of the spectrum, relief)
    type(error_t), allocatable, intent(inout) :: error
    type(part_t), allocatable :: found(:, :)
    integer :: i, k

    call claim_memory(1000.0_dp*size(which)*size(self%own_rpm), '&life rpm: '//str(size(which)*size(self%own_rpm))// &
                      ' parts', error)
    if (allocated(error)) return
    allocate (found(size(self%own_rpm), size(which)))
    do i = 1, size(which)
      do k = 1, size(self%own_rpm)
        if (wants_stop(stages%accuracy%steady%stop)) return
        call follow_part(stages, which(i), self%own_rpm(k), self%load_factor(k), self%duration(k), self%rule, &
                         found(k, i), error)
        if (allocated(error)) return
        if (self%rule%dynamic_load) call stages%running%tell(1, stages%accuracy%steady%stop)
      end do
    end do
    call move_alloc(found, parts)
  end subroutine follow

  !> A row for each relief, part and gear.
  subroutine fill_parts(self, amount, parts, table, error)
    class(life_task_t), intent(in) :: self
    real(dp), intent(in) :: amount(:)
    type(part_t), intent(in) :: parts(:, :)
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    type(root_life_t), allocatable :: root(:)
    real(dp), allocatable :: engagements(:)
    integer :: i, k, m, n

    n = size(parts, 1)
    m = size(parts, 2)
    call table%over('what each part of the load spectrum does to the tooth roots', error, &
                    axis('relief_um', 'um', of_relief, in_um(amount)), &
                    axis('part', '', 'of the load spectrum, from 1', [(k, k=1, n)]), &
                    axis('member', '', 'pinion or gear', members))
    if (allocated(error)) return
    root = [((parts(k, i)%root, k=1, n), i=1, m)]
    engagements = [((parts(k, i)%engagements, k=1, n), i=1, m)]
    call table%add('rpm', '1/min', of_speed, table%along(2, self%own_rpm))
    call table%add('load_factor', '', 'load over that of the case', table%along(2, self%load_factor))
    call table%add('dynamic_factor', '', of_factor//', and for the static load', each([parts%dynamic_factor], 2))
    call table%add_words('status', of_status, words_of(each([parts%status], 2)))
    call table%add('motions', '', of_motions//'; also under the static load', known_count(each([parts%motions], 2)))
    call table%add('engagements', '', 'how often a tooth carries', engagements)
    call table%add('root_stress_mpa', 'MPa', 'largest tooth root stress, by ISO 6336-3 with the load where it acts', &
                   mega*[root%largest])
    call table%add('amplitude_mpa', 'MPa', 'stress amplitude of the cycle that does most harm', mega*[root%worst%amplitude])
    call table%add('mean_mpa', 'MPa', 'mean stress of that cycle', mega*[root%worst%mean])
    call table%add('equivalent_amplitude_mpa', 'MPa', 'amplitude that does the same harm without mean stress; NaN where the '// &
                   'mean stress alone is above the strength', mega*[root%equivalent])
    call table%add('cycles', '', 'cycles of an engagement, by the rainflow method', [root%cycles])
    call table%add('damage', '', 'Miner''s sum of this part in one pass', [root%damage]*engagements)
  end subroutine fill_parts

  !> A row for each relief and gear.
  subroutine fill_life(self, amount, parts, table, error)
    class(life_task_t), intent(in) :: self
    real(dp), intent(in) :: amount(:)
    type(part_t), intent(in) :: parts(:, :)
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp) :: damage(2*size(amount)), largest(2*size(amount))
    character(word_length) :: word(2*size(amount))
    integer :: m, row, worst(2*size(amount))

    m = size(amount)
    call table%over('how long the tooth roots last', error, axis('relief_um', 'um', of_relief, in_um(amount)), &
                    axis('member', '', 'pinion or gear', members))
    if (allocated(error)) return
    do row = 1, 2*m
      call sum_up(parts(:, (row + 1)/2), 2 - modulo(row, 2), damage(row), largest(row), worst(row), word(row))
    end do
    call table%add_words('kind', 'finite: damage adds up; endless: no cycle harms; overloaded: the mean stress of some cycle '// &
                         'alone is above the strength; unknown: some part has no motion', word)
    call table%add('damage', '', 'Miner''s sum of one pass of the spectrum', damage)
    call table%add('passes', '', 'of the spectrum until the sum is 1; NaN unless finite', lasting(word, damage, 1.0_dp))
    call table%add('life_h', 'h', 'time until then', lasting(word, damage, sum(self%duration)/hour))
    call table%add('largest_root_stress_mpa', 'MPa', 'largest tooth root stress of all parts', mega*largest)
    call table%add('worst_part', '', 'part that does most harm; 0 where none does', worst)
  end subroutine fill_life

  !> One gear over all parts of the spectrum with one relief.
  pure subroutine sum_up(parts, member, damage, largest, worst, word)
    type(part_t), intent(in) :: parts(:)
    integer, intent(in) :: member
    real(dp), intent(out) :: damage, largest
    integer, intent(out) :: worst
    character(word_length), intent(out) :: word
    type(root_life_t) :: root(size(parts))
    real(dp) :: harm(size(parts))
    integer :: k

    word = 'unknown'
    damage = no_number()
    largest = no_number()
    worst = 0
    if (.not. all(has_result(parts%status))) return
    root = [(parts(k)%root(member), k=1, size(parts))]
    harm = root%damage*[(parts(k)%engagements(member), k=1, size(parts))]
    damage = sum(harm)
    largest = maxval(root%largest)
    word = 'overloaded'
    if (any(root%is_over)) return
    word = 'endless'
    if (.not. damage > 0) return
    word = 'finite'
    worst = maxloc(harm, 1)
  end subroutine sum_up

  !> Time or passes over the damage of one pass.
  elemental real(dp) function lasting(word, damage, whole)
    character(*), intent(in) :: word
    real(dp), intent(in) :: damage, whole

    lasting = no_number()
    if (word == 'finite') lasting = whole/damage
  end function lasting

  subroutine fill_curve(self, table, error)
    class(life_task_t), intent(in) :: self
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error

    call table%begin('the S-N curve, fully reversed', size(self%rule%curve%cycles), error)
    if (allocated(error)) return
    call table%add_index(axis('failure_cycles', '', 'cycles to failure', self%rule%curve%cycles))
    call table%add('amplitude_mpa', 'MPa', 'stress amplitude', mega*self%rule%curve%stress)
  end subroutine fill_curve

  pure subroutine add_report(self, lines)
    class(life_task_t), intent(in) :: self
    type(lines_t), intent(inout) :: lines
    integer :: i

    associate (life => self%tables(self%place('life')))
      call lines%add('')
      call lines%add('Life of the tooth roots')
      call lines%add('   relief um   member   stress MPa       damage      life h')
      do i = 1, life%rows
        call lines%put(right(str(life%number('relief_um', i)), 12)//'   '//left(trim(life%word('member', i)), 6)// &
                       right(str(life%number('largest_root_stress_mpa', i), 5), 13)// &
                       right(str(life%number('damage', i), 4), 13))
        if (life%word('kind', i) == 'finite') then
          call lines%add(right(str(life%number('life_h', i), 4), 12))
        else
          call lines%add(right(trim(life%word('kind', i)), 12))
        end if
      end do
      call add_several(self%tables(self%place('life_parts')), lines)
      call add_caution(life, lines)
    end associate
  end subroutine add_report
end module gearsweep_task_life
