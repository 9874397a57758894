!> The task `branches`: whole branches of periodic motions over speed, damping ratio, relief or load, attracting or not, with
!> their folds, doublings and grazings (see gearsweep_branch_search).
module gearsweep_task_branches
  use gearsweep_attractor_search, only: attractor_options_t
  use gearsweep_bifurcation, only: branch_search_options_t, find_branches, find_curves, follow_options_t, whole_branch_t, width
  use gearsweep_branch_tables, only: branch_set_t, fill_branches, fill_changes, fill_curves, fill_points
  use gearsweep_case_family, only: case_family_t, make_case_family, parameter_names
  use gearsweep_case_variation, only: case_variation_t, number_units, of_force, of_relief, of_rpm
  use gearsweep_error, only: code_input, error_t, fail
  use gearsweep_kinds, only: dp
  use gearsweep_lines, only: left, lines_t, right
  use gearsweep_long_tables, only: add_rest, most_rows
  use gearsweep_points, only: factor_in
  use gearsweep_reader, only: reader_t
  use gearsweep_table, only: table_t
  use gearsweep_stages, only: runnable_t, stages_t
  use gearsweep_task, only: stage, task_info_t
  use gearsweep_text, only: str
  use gearsweep_uses, only: sentence_length, unless
  implicit none
  private
  public :: branches_task_t

  type, extends(runnable_t) :: branches_task_t
    integer :: parameter = of_rpm              !< of gearsweep_case_variation
    real(dp) :: range(2) = 0                     !< first and last value, SI units
    integer :: second = 0                        !< second parameter, over which changes are followed; 0: none
    real(dp) :: second_range(2) = 0
    real(dp) :: rpm = 0                          !< speed where it is not the parameter, 1/min
    integer :: most_periods = 4, seeds = 9, points = 200
  contains
    procedure, nopass :: describe
    procedure :: read_keys, run, add_report, uses, count_points
  end type branches_task_t

  character(*), parameter :: group = 'branches'

contains

  pure subroutine describe(info)
    type(task_info_t), intent(out) :: info

    info = task_info_t(group, needs=[stage%mesh, stage%reliefs, stage%amounts, stage%motion, stage%losses], &
                       tables='branches branch_points branch_changes branch_curves', fields='', &
                       gives='whole branches of periodic motions, attracting or not, with folds, doubled periods and grazing')
  end subroutine describe

  !> The relief as parameter makes those of &relief idle.
  pure logical function uses(self, which)
    class(branches_task_t), intent(in) :: self
    integer, intent(in) :: which                 !< of `stage`

    uses = any(self%needs == which)
    if (which == stage%amounts) uses = self%parameter /= of_relief
  end function uses

  subroutine read_keys(self, reader, error)
    class(branches_task_t), intent(inout) :: self
    type(reader_t), intent(inout) :: reader
    type(error_t), allocatable, intent(inout) :: error
    real(dp), parameter :: far = 1e9_dp
    character(:), allocatable :: parameter
    logical :: has_rpm
    integer :: i

    parameter = trim(parameter_names(self%parameter))
    call reader%add_group(group, 'The task branches, over a range of speed or of another number of the case.')
    call reader%get(group, 'parameter', parameter, error, tasks=group, allowed=parameter_names, &
                    meaning='over what the branches are followed: speed, damping ratio, relief or load, in the unit of its name')
    if (allocated(error)) return
    do i = 1, size(parameter_names)
      if (parameter_names(i) == parameter) self%parameter = i
    end do
    call reader%get(group, 'first', self%range(1), error, required=.true., tasks=group, at_least=0.0_dp, below=far, &
                    meaning='where the range of the parameter begins; above 0 for rpm and load')
    call reader%get(group, 'last', self%range(2), error, required=.true., tasks=group, above=0.0_dp, at_most=far, &
                    meaning='where it ends')
    call reader%get(group, 'rpm', self%rpm, error, unit='1/min', tasks=group, given=has_rpm, at_least=1e-6_dp, at_most=far, &
                    otherwise='parameter = ''rpm'': none', meaning='speed where another number is the parameter')
    call self%read_reliefs(reader, group, error)
    call reader%get(group, 'most_periods', self%most_periods, error, tasks=group, at_least=1, at_most=64, &
                    meaning='mesh periods after which the motions repeat, at most')
    call reader%get(group, 'seeds', self%seeds, error, tasks=group, at_least=1, at_most=10000, &
                    meaning='values over the range, its ends among them, at which attracting motions are looked for at first')
    call reader%get(group, 'points', self%points, error, tasks=group, at_least=10, at_most=100000, &
                    meaning='points of a branch over the whole range, at least')
    self%range = self%range*number_units(self%parameter)
    call read_second(self, reader, error)
    if (.not. allocated(error) .and. self%range(2) > 0) call check_range(self, has_rpm, error)
  end subroutine read_keys

  !> The second parameter and its range.
  subroutine read_second(self, reader, error)
    class(branches_task_t), intent(inout) :: self
    type(reader_t), intent(inout) :: reader
    type(error_t), allocatable, intent(inout) :: error
    real(dp), parameter :: far = 1e9_dp
    character(*), parameter :: nothing = 'second = ''none'': none'
    character(:), allocatable :: second
    character(sentence_length) :: alone
    logical :: has_second
    integer :: i

    second = 'none'
    call reader%get(group, 'second', second, error, tasks=group, allowed=[character(20) :: 'none', parameter_names], &
                    meaning='second number of the case, over which folds, doublings and grazings are followed as curves')
    if (allocated(error)) return
    do i = 1, size(parameter_names)
      if (parameter_names(i) == second) self%second = i
    end do
    has_second = self%second > 0
    alone = unless(has_second, 'needs second')
    call reader%get(group, 'second_first', self%second_range(1), error, tasks=group, required=has_second, refused=alone, &
                    otherwise=nothing, at_least=0.0_dp, below=far, &
                    meaning='where its range begins, in the unit of its name; the case''s own value lies in the range')
    call reader%get(group, 'second_last', self%second_range(2), error, tasks=group, required=has_second, refused=alone, &
                    otherwise=nothing, above=0.0_dp, at_most=far, meaning='where it ends')
    if (allocated(error) .or. .not. has_second) return
    self%second_range = self%second_range*number_units(self%second)
    if (self%second == self%parameter) call fail(error, code_input, '&branches second = '''//second//''': is the first parameter')
    ! Where only the keys are declared, the required ones are 0.
    if (self%second_range(2) > 0) call check_ends(self%second, self%second_range, 'second_', error)
  end subroutine read_second

  !> The ends of a parameter's range.
  pure subroutine check_ends(parameter, range, prefix, error)
    integer, intent(in) :: parameter
    real(dp), intent(in) :: range(2)             ! SI units
    character(*), intent(in) :: prefix           ! of their keys
    type(error_t), allocatable, intent(inout) :: error

    associate (shown => range/number_units(parameter))
      if (.not. range(1) < range(2)) call fail(error, code_input, '&branches '//prefix//'last = '//str(shown(2))// &
                                               ': must be above '//prefix//'first = '//str(shown(1)))
      if (any(parameter == [of_rpm, of_force]) .and. .not. range(1) > 0) &
        call fail(error, code_input, '&branches '//prefix//'first = '//str(shown(1))//': must be above 0 where '//prefix// &
                  'parameter is rpm or load')
    end associate
  end subroutine check_ends

  !> What the parameter asks for.
  pure subroutine check_range(self, has_rpm, error)
    class(branches_task_t), intent(in) :: self
    logical, intent(in) :: has_rpm
    type(error_t), allocatable, intent(inout) :: error

    if (self%parameter /= of_rpm) then
      if (.not. has_rpm) call fail(error, code_input, '&branches parameter = '''// &
        trim(parameter_names(self%parameter))//''': needs rpm, the speed')
    else if (has_rpm) then
      call fail(error, code_input, '&branches rpm: the speed is the parameter; its range is first to last')
    end if
    if (self%parameter == of_relief .and. allocated(self%own_relief)) &
      call fail(error, code_input, '&branches relief_um: the relief is the parameter; its range is first to last')
    call check_ends(self%parameter, self%range, '', error)
  end subroutine check_range

  !> The values at which motions are looked for.
  integer function count_points(self, stages) result(points)
    class(branches_task_t), intent(in) :: self
    type(stages_t), intent(in) :: stages
    integer, allocatable :: which(:)

    points = self%seeds
    if (.not. self%uses(stage%amounts)) return
    call self%list_reliefs(stages, which)
    points = points*size(which)
  end function count_points

  subroutine run(self, stages, error)
    class(branches_task_t), intent(inout) :: self
    type(stages_t), intent(in) :: stages
    type(error_t), allocatable, intent(inout) :: error
    type(branch_set_t), allocatable :: found(:)
    integer, allocatable :: which(:)
    integer :: i, total
    logical :: stopped

    which = [1]
    if (self%uses(stage%amounts)) call self%list_reliefs(stages, which)
    allocate (found(size(which)))
    do i = 1, size(which)
      call make_family(self, stages, stages%amount(which(i)), found(i)%family, error)
      if (allocated(error)) return
      call find_branches(found(i)%family, options_of(self, stages), found(i)%branch, found(i)%unresolved, stopped, error)
      if (.not. (allocated(error) .or. stopped)) call follow_changes(self, stages, found(i), stopped, error)
      if (allocated(error) .or. stopped) return
      call stages%running%tell(self%seeds, stages%accuracy%steady%stop)
    end do
    call fill_branches(found, self%tables(self%place('branches')), error)
    call fill_points(found, self%tables(self%place('branch_points')), error)
    call fill_changes(found, self%tables(self%place('branch_changes')), error)
    if (self%second > 0) call fill_curves(found, self%tables(self%place('branch_curves')), error)
    if (allocated(error)) return
    self%failed = sum(found%unresolved)
    self%is_done = .true.
    total = sum([(size(found(i)%branch), i=1, size(found))])
    self%log = 'branches: '//str(total)//' branches from motions at '//str(self%seeds*size(which))//' places'
  end subroutine run

  !> The curves of all changes over the second parameter.
  subroutine follow_changes(self, stages, found, stopped, error)
    class(branches_task_t), intent(in) :: self
    type(stages_t), intent(in) :: stages
    type(branch_set_t), intent(inout) :: found
    logical, intent(out) :: stopped
    type(error_t), allocatable, intent(inout) :: error
    type(branch_search_options_t) :: options
    real(dp) :: value

    stopped = .false.
    if (self%second == 0) return
    value = found%family%case%number(self%second)
    if (value < self%second_range(1) .or. value > self%second_range(2)) then
      associate (unit => number_units(self%second))
        call fail(error, code_input, '&branches second_first = '//str(self%second_range(1)/unit)//', second_last = '// &
                  str(self%second_range(2)/unit)//': must have the case''s '//trim(parameter_names(self%second))//' = '// &
                  str(value/unit)//' between them')
      end associate
      return
    end if
    call make_case_family(found%family%case, [self%parameter, self%second], &
                          reshape([self%range, self%second_range], [2, 2]), found%plane, error)
    if (allocated(error)) return
    options = options_of(self, stages)
    call find_curves(found%plane, options%angle, value, found%branch, options%follow, found%curve, stopped)
  end subroutine follow_changes

  type(branch_search_options_t) function options_of(self, stages) result(options)
    class(branches_task_t), intent(in) :: self
    type(stages_t), intent(in) :: stages

    options%seeds = self%seeds
    options%follow = follow_options_t(longest=width/self%points, most_points=max(5000, 50*self%points), &
                                      stop=stages%accuracy%steady%stop)
    options%search = attractor_options_t(most_cycles=500, most_periods=self%most_periods)
    options%search%accuracy%steady%stop = stages%accuracy%steady%stop
  end function options_of

  !> The case with this relief (m), over the parameter.
  subroutine make_family(self, stages, relief, family, error)
    class(branches_task_t), intent(in) :: self
    type(stages_t), intent(in) :: stages
    real(dp), intent(in) :: relief
    type(case_family_t), intent(out) :: family
    type(error_t), allocatable, intent(inout) :: error
    real(dp) :: range(2, 2)

    range = 0
    range(:, 1) = self%range
    call make_case_family(case_variation_t(stages%motions_inputs, relief, self%rpm), [self%parameter, 0], range, family, error)
  end subroutine make_family

  pure subroutine add_report(self, lines)
    class(branches_task_t), intent(in) :: self
    type(lines_t), intent(inout) :: lines
    character(:), allocatable :: name
    integer :: i

    name = trim(parameter_names(self%parameter))
    associate (branches => self%tables(self%place('branches')), changes => self%tables(self%place('branch_changes')))
      call lines%add('')
      call lines%add('Branches of periodic motions over '//name//', from motions at '//str(self%seeds)//' places')
      call lines%add('    branch   periods         least       largest  largest DF   ends')
      do i = 1, min(branches%rows, most_rows)
        call lines%add(right(str(nint(branches%number('branch', i))), 10)// &
                       right(str(nint(branches%number('mesh_periods', i))), 10)// &
                       right(str(branches%number('least', i), 7), 14)//right(str(branches%number('largest', i), 7), 14)// &
                       factor_in(branches%number('largest_dynamic_factor', i))//'     '// &
                       trim(branches%word('first_end', i))//', '//trim(branches%word('last_end', i)))
      end do
      call add_rest(branches%rows, branches%name, lines)
      call lines%add('    branch   change at '//left(name, 19)//'DF')
      do i = 1, min(changes%rows, most_rows)
        call lines%add(right(str(nint(changes%number('branch', i))), 10)//'   '//left(trim(changes%word('kind', i)), 10)// &
                       left(str(changes%number(name, i), 10), 15)//factor_in(changes%number('dynamic_factor', i)))
      end do
      call add_rest(changes%rows, changes%name, lines)
    end associate
    if (self%second > 0) call add_curves(self%tables(self%place('branch_curves')), name, &
                                         trim(parameter_names(self%second)), lines)
  end subroutine add_report

  !> Each curve over both parameters: where it begins and ends, and why.
  pure subroutine add_curves(curves, first, second, lines)
    type(table_t), intent(in) :: curves
    character(*), intent(in) :: first, second    ! names of the parameters
    type(lines_t), intent(inout) :: lines
    integer :: row, begin, count

    call lines%add('     curve   of          '//left(first, 26)//left(second, 26)//'ends')
    begin = 1
    count = 0
    do row = 1, curves%rows
      if (row < curves%rows) then
        if (nint(curves%number('curve', row + 1)) == nint(curves%number('curve', begin))) cycle
      end if
      count = count + 1
      if (count <= most_rows) call lines%add(right(str(count), 10)//'   '//left(trim(curves%word('kind', begin)), 12)// &
                                        left(span(curves, first, begin, row), 26)//left(span(curves, second, begin, row), 26)// &
                                        trim(curves%word('first_end', row))//', '//trim(curves%word('last_end', row)))
      begin = row + 1
    end do
    call add_rest(count, curves%name, lines)
  end subroutine add_curves

  !> From the curve's first point to its last.
  pure function span(curves, name, first, last) result(text)
    type(table_t), intent(in) :: curves
    character(*), intent(in) :: name             ! of the parameter
    integer, intent(in) :: first, last           ! rows
    character(26) :: text

    text = str(curves%number(name, first), 6)//' to '//str(curves%number(name, last), 6)
  end function span
end module gearsweep_task_branches
