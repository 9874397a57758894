!> The task `branches`: periodic motions over speed, damping ratio, relief or load, attracting or not, with their folds,
!> doublings and grazings (see gearsweep_nonlinear_branch_search).
module gearsweep_nonlinear_task_branches
  use gearsweep_base, only: axis, code_input, dp, error_t, fail, lines_t, no_number, str, table_t
  use gearsweep_motion, only: attractor_options_t, contact_name, contact_of, mesh_period, oscillator_t, steady_t
  use gearsweep_study, only: case_variation_t, number_names, number_units, of_dte_range, &
    of_dte_rms, of_periods, of_relief, of_speed, reader_t, runnable_t, stage, stages_t, task_info_t, &
    vary_damping, vary_force, vary_relief, vary_rpm
  use gearsweep_nonlinear_branch, only: branch_point_t, end_names, follow_options_t
  use gearsweep_nonlinear_branch_search, only: branch_search_options_t, find_branches, special_t, whole_branch_t
  use gearsweep_nonlinear_motion_equations, only: family_t, kind_names, width
  implicit none
  private
  public :: branches_task_t

  !> The first ones of a case's numbers can be parameters of branches.
  integer, parameter, public :: parameters = vary_force
  character(*), parameter, public :: parameter_names(parameters) = number_names(:parameters)

  type, extends(family_t) :: case_family_t
    type(case_variation_t) :: case
    integer :: which = vary_rpm                  !< index of the parameter among these numbers
  contains
    procedure :: oscillator_at, duration_at, numbers_at, in_key_unit
  end type case_family_t

  !> Branches with one amount of relief.
  type :: branch_set_t
    type(case_family_t) :: family
    type(whole_branch_t), allocatable :: branch(:)
    integer :: unresolved = 0                    !< number of seeds whose speed is too low
  end type branch_set_t

  !> Row of branches.
  type :: branch_row_t
    real(dp) :: relief                           !< m; NaN where it is the parameter
    real(dp) :: least, largest                   !< values of the parameter, in the unit of its name
    real(dp) :: dynamic_factor                   !< the largest on the branch
    integer :: periods, points, stable_points
    integer :: ends(2)                           !< kinds of the ends
  end type branch_row_t

  !> Row of branch_points or branch_changes.
  type :: row_t
    integer :: branch = 0, at = 0                !< index of the branch over all sets, and of the point on it
    integer :: periods = 0                       !< mesh periods until the motion repeats
    real(dp) :: numbers(parameters) = 0          !< numbers of the case, SI units
    real(dp) :: state(2) = 0                     !< m and m/s
    type(special_t) :: special                   !< of a point of a branch: its point only
    real(dp) :: enclosed = 0                     !< width of the bracket, in the unit of the parameter's name
  end type row_t

  integer, parameter :: word = 8
  real(dp), parameter :: neutral = 1e-7_dp        ! tolerance for a multiplier of 1
  character(*), parameter :: of_branch = 'which branch', of_damping_ratio = 'damping ratio', of_normal_force = 'static load', &
    of_dynamic_factor = 'dynamic factor DF: largest load of a pair over the static load', &
    of_contact = 'full; partial: a pair was apart for a while; lost: all were; coast: the coast sides touched'

  type, extends(runnable_t) :: branches_task_t
    integer :: parameter = vary_rpm              !< parameter, an index of gearsweep_study_run_case_variation
    real(dp) :: range(2) = 0                     !< first and last value, SI units
    real(dp) :: rpm = 0                          !< speed if it is not the parameter, 1/min
    integer :: most_periods = 4, seeds = 9, points = 200
  contains
    procedure, nopass :: describe
    procedure :: read_keys, run, add_report, uses, count_points
  end type branches_task_t

  character(*), parameter :: group = 'branches'

contains

  !> Builds the family of a case, after checks at both ends of its range.
  subroutine make_case_family(case, which, range, family, error)
    type(case_variation_t), intent(in) :: case
    integer, intent(in) :: which                 !< the parameter
    real(dp), intent(in) :: range(2)             !< its first and last value
    type(case_family_t), intent(out) :: family
    type(error_t), allocatable, intent(inout) :: error
    type(error_t), allocatable :: refused
    type(oscillator_t) :: osc
    integer :: end

    family%case = case
    family%which = which
    family%first = range(1)
    family%last = range(2)
    family%is_speed = which == vary_rpm
    family%least = merge(1e-3_dp*family%first, 0.0_dp, which == vary_rpm .or. which == vary_force)
    if (which == vary_relief .and. allocated(case%inputs%profile_error%breaks)) &
      call fail(error, code_input, '&branches parameter = ''relief_um'': the profile error is prescribed')
    do end = 1, 2
      if (allocated(error)) return
      call family%oscillator_at(range(end), osc, refused)
      if (.not. allocated(refused)) cycle
      call fail(error, code_input, '&branches '//trim(merge('first', 'last ', end == 1))//' = '// &
                str(range(end)/number_units(which))//': '//refused%message)
    end do
  end subroutine make_case_family

  !> Numbers of the case, where the parameter has this value.
  pure function numbers_at(self, value) result(numbers)
    class(case_family_t), intent(in) :: self
    real(dp), intent(in) :: value
    real(dp) :: numbers(parameters)
    integer :: i

    numbers = [(self%case%number(i), i=1, parameters)]
    numbers(self%which) = value
  end function numbers_at

  subroutine oscillator_at(self, value, osc, error)
    class(case_family_t), intent(in) :: self
    real(dp), intent(in) :: value
    type(oscillator_t), intent(out) :: osc
    type(error_t), allocatable, intent(out) :: error
    type(case_variation_t) :: case

    case = self%case
    call case%set(self%which, value)
    call case%build(osc, error)
  end subroutine oscillator_at

  !> Duration of the mesh period, s.
  pure real(dp) function duration_at(self, value)
    class(case_family_t), intent(in) :: self
    real(dp), intent(in) :: value
    real(dp) :: numbers(parameters)

    numbers = self%numbers_at(value)
    duration_at = mesh_period(self%case%inputs%motion%teeth(1), numbers(vary_rpm))
  end function duration_at

  !> Value of the parameter in the unit of its name.
  pure real(dp) function in_key_unit(self, value)
    class(case_family_t), intent(in) :: self
    real(dp), intent(in) :: value

    in_key_unit = value*merge(1e6_dp, 1.0_dp, self%which == vary_relief)
  end function in_key_unit

  !> Fills a row for each branch.
  pure subroutine fill_branches(found, table, error)
    type(branch_set_t), intent(in) :: found(:)
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    type(branch_row_t), allocatable :: rows(:)
    integer :: i, k, n

    n = sum([(size(found(i)%branch), i=1, size(found))])
    call table%begin('branches of periodic motions over the parameter', n, error)
    if (allocated(error)) return
    allocate (rows(n))
    n = 0
    do i = 1, size(found)
      do k = 1, size(found(i)%branch)
        n = n + 1
        associate (b => found(i)%branch(k), family => found(i)%family)
          rows(n) = branch_row_t(merge(no_number(), family%case%relief, family%which == vary_relief), &
            family%in_key_unit(min(minval(b%point%value), minval(b%special%point%value))), &
            family%in_key_unit(max(maxval(b%point%value), maxval(b%special%point%value))), &
            max(maxval(b%point%dynamic_factor), maxval(b%special%point%dynamic_factor)), &
            b%periods, size(b%point), count(b%point%modulus < 1 - neutral), b%ends)
        end associate
      end do
    end do
    call table%add_index(axis('branch', '', of_branch, [(i, i=1, n)]))
    call table%add('relief_um', 'um', of_relief//'; NaN where it is the parameter', [rows%relief])
    call table%add('mesh_periods', '', of_periods, [rows%periods])
    call table%add('least', '', 'least value of the parameter, in the unit of its name', [rows%least])
    call table%add('largest', '', 'largest value of the parameter', [rows%largest])
    call table%add('largest_dynamic_factor', '', 'largest DF on the branch', [rows%dynamic_factor])
    call table%add('points', '', 'points followed', [rows%points])
    call table%add('stable_points', '', 'of these, where the motion attracts', [rows%stable_points])
    call table%add_words('first_end', 'how it ends where its points begin: range: of the parameter; closed: in itself; '// &
                         'doubling: in a motion of half the period, whose period doubles there; lost: Newton''s method does '// &
                         'not go on; length: so many points', [end_names(rows%ends(1))])
    call table%add_words('last_end', 'how it ends where its points end', [end_names(rows%ends(2))])
  end subroutine fill_branches

  !> Fills a row for each point of each branch.
  pure subroutine fill_points(found, table, error)
    type(branch_set_t), intent(in) :: found(:)
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    type(row_t), allocatable :: rows(:)

    call list_rows(found, .false., rows)
    call table%begin('points of the branches, from one end to the other', size(rows), error)
    if (allocated(error)) return
    call table%add_index(axis('branch', '', of_branch, [rows%branch]))
    call table%add_index(axis('point', '', 'number of the point on its branch', [rows%at]))
    call add_motions(rows, table)
    call table%add('dte_um', 'um', 'dynamic transmission error as a new pair enters', [rows%state(1)])
    call table%add('dte_rate_mm_s', 'mm/s', 'rate of the dynamic transmission error as a new pair enters: the motion can be '// &
                   'continued from both', [rows%state(2)])
  end subroutine fill_points

  !> Fills a row for each fold, doubling and grazing.
  pure subroutine fill_changes(found, table, error)
    type(branch_set_t), intent(in) :: found(:)
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    type(row_t), allocatable :: rows(:)

    call list_rows(found, .true., rows)
    call table%begin('where the motion changes its kind along a branch', size(rows), error)
    if (allocated(error)) return
    call table%add_index(axis('branch', '', of_branch, [rows%branch]))
    call table%add_words('kind', 'fold: a Floquet multiplier is 1, and the branch turns back; doubling: one is -1; '// &
                         'grazing: the overlap of a contact is 0 where it is smallest or largest, or where a pair enters or '// &
                         'leaves; vertical: a line of motions begins at one value of the parameter; unknown: contact or '// &
                         'stability changes between this point and the one before, and it is not known how', &
                         [kind_names(rows%special%kind)])
    call table%add('after_point', '', 'the point of the branch before it', [rows%special%after])
    call add_motions(rows, table)
    associate (overlap => rows%special%overlap)
      call table%add('phase', '', 'of grazing, the mesh phase; NaN where it is not known or no grazing', &
                     merge(overlap%phase, no_number(), overlap%contact > 0))
      call table%add('in_period', '', 'of grazing, in which of the mesh periods; 0 as above', [overlap%period])
    end associate
    call table%add('enclosed', '', 'between motions so far apart it is enclosed, as a distance in the unit of the parameter''s '// &
                   'name', [rows%enclosed])
  end subroutine fill_changes

  !> Adds the columns of a motion.
  pure subroutine add_motions(rows, table)
    type(row_t), intent(in) :: rows(:)
    type(table_t), intent(inout) :: table
    character(word) :: stability(size(rows))
    integer :: i

    call table%add('rpm', '1/min', of_speed, [rows%numbers(vary_rpm)])
    call table%add('damping_ratio', '', of_damping_ratio, [rows%numbers(vary_damping)])
    call table%add('relief_um', 'um', of_relief, [rows%numbers(vary_relief)])
    call table%add('normal_force_n', 'N', of_normal_force, [rows%numbers(vary_force)])
    associate (point => rows%special%point)
      stability = 'unstable'
      where (point%modulus <= 1 + neutral) stability = 'marginal'
      where (point%modulus < 1 - neutral) stability = 'stable'
      call table%add('dynamic_factor', '', of_dynamic_factor, [point%dynamic_factor])
      call table%add('mesh_periods', '', of_periods, [rows%periods])
      call table%add('floquet_modulus', '', 'largest modulus of the Floquet multipliers', [point%modulus])
      call table%add_words('stability', 'stable: the motion attracts; unstable: it repels; marginal: neither, to 1e-7', stability)
      call table%add_words('contact', of_contact, contact_name([(contact_of(steady_t(partial=point(i)%partial, &
                           lost=point(i)%lost, coast=point(i)%coast)), i=1, size(rows))]))
      call table%add('dte_rms_um', 'um', of_dte_rms, [point%dte_rms])
      call table%add('dte_peak_to_peak_um', 'um', of_dte_range, [point%dte_range])
    end associate
  end subroutine add_motions

  !> Lists the rows: one for each point or special point. Branches are counted over all sets.
  pure subroutine list_rows(found, special, rows)
    type(branch_set_t), intent(in) :: found(:)
    logical, intent(in) :: special               ! true: special points; false: points of branches
    type(row_t), allocatable, intent(out) :: rows(:)
    integer :: i, k, m, n, branch

    allocate (rows(sum([((merge(size(found(i)%branch(k)%special), size(found(i)%branch(k)%point), special), &
                          k=1, size(found(i)%branch)), i=1, size(found))])))
    n = 0
    branch = 0
    do i = 1, size(found)
      do k = 1, size(found(i)%branch)
        branch = branch + 1
        associate (b => found(i)%branch(k), family => found(i)%family)
          do m = 1, merge(size(b%special), size(b%point), special)
            n = n + 1
            if (special) rows(n)%special = b%special(m)
            if (.not. special) rows(n)%special%point = b%point(m)
            rows(n)%branch = branch
            rows(n)%at = m
            rows(n)%periods = b%periods
            associate (point => rows(n)%special%point)
              rows(n)%numbers = family%numbers_at(point%value)
              rows(n)%state = b%scale*point%z(:2)
            end associate
            rows(n)%enclosed = family%in_key_unit(rows(n)%special%enclosed/width*(family%last - family%first))
          end do
        end associate
      end do
    end do
  end subroutine list_rows

  pure subroutine describe(info)
    type(task_info_t), intent(out) :: info

    info = task_info_t(group, needs=[stage%mesh, stage%reliefs, stage%amounts, stage%motion, stage%losses], &
                       tables='branches branch_points branch_changes', fields='', &
                       summary='whole branches of periodic motions, attracting or not, with folds, doubled periods and grazing')
  end subroutine describe

  !> With the relief as parameter, the reliefs of &relief are not used.
  pure logical function uses(self, which)
    class(branches_task_t), intent(in) :: self
    integer, intent(in) :: which                 !< index of the stage in `stage`

    uses = any(self%needs == which)
    if (which == stage%amounts) uses = self%parameter /= vary_relief
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
    call reader%get(group, 'rpm', self%rpm, error, unit='1/min', tasks=group, is_stated=has_rpm, at_least=1e-6_dp, at_most=far, &
                    default_note='parameter = ''rpm'': none', meaning='speed where another number is the parameter')
    call self%read_reliefs(reader, group, error)
    call reader%get(group, 'most_periods', self%most_periods, error, tasks=group, at_least=1, at_most=64, &
                    meaning='mesh periods after which the motions repeat, at most')
    call reader%get(group, 'seeds', self%seeds, error, tasks=group, at_least=1, at_most=10000, &
                    meaning='values over the range, its ends among them, at which attracting motions are looked for at first')
    call reader%get(group, 'points', self%points, error, tasks=group, at_least=10, at_most=100000, &
                    meaning='points of a branch over the whole range, at least')
    self%range = self%range*number_units(self%parameter)
    if (.not. allocated(error) .and. self%range(2) > 0) call check_range(self, has_rpm, error)
  end subroutine read_keys

  !> Checks range and speed against the parameter.
  pure subroutine check_range(self, has_rpm, error)
    class(branches_task_t), intent(in) :: self
    logical, intent(in) :: has_rpm
    type(error_t), allocatable, intent(inout) :: error

    if (self%parameter /= vary_rpm) then
      if (.not. has_rpm) call fail(error, code_input, '&branches parameter = '''// &
        trim(parameter_names(self%parameter))//''': needs rpm, the speed')
    else if (has_rpm) then
      call fail(error, code_input, '&branches rpm: the speed is the parameter; its range is first to last')
    end if
    if (self%parameter == vary_relief .and. allocated(self%own_relief)) &
      call fail(error, code_input, '&branches relief_um: the relief is the parameter; its range is first to last')
    associate (shown => self%range/number_units(self%parameter))
      if (.not. shown(1) < shown(2)) call fail(error, code_input, '&branches last = '//str(shown(2))//': must be above first = '// &
                                               str(shown(1)))
      if (any(self%parameter == [vary_rpm, vary_force]) .and. .not. shown(1) > 0) &
        call fail(error, code_input, '&branches first = '//str(shown(1))//': must be above 0 where parameter is rpm or load')
    end associate
  end subroutine check_range

  !> Number of the parameter values at which motions are searched.
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
    type(branch_search_options_t) :: options

    which = [1]
    if (self%uses(stage%amounts)) call self%list_reliefs(stages, which)
    allocate (found(size(which)))
    options%seeds = self%seeds
    options%follow = follow_options_t(longest=width/self%points, most_points=max(5000, 50*self%points), &
                                      stop=stages%accuracy%steady%stop)
    options%search = attractor_options_t(most_cycles=500, most_periods=self%most_periods)
    options%search%accuracy%steady%stop = stages%accuracy%steady%stop
    do i = 1, size(which)
      call make_case_family(case_variation_t(stages%motions_inputs, stages%amount(which(i)), self%rpm), self%parameter, &
                            self%range, found(i)%family, error)
      if (allocated(error)) return
      call find_branches(found(i)%family, options, found(i)%branch, found(i)%unresolved, stopped, error)
      if (allocated(error) .or. stopped) return
      call stages%running%report_progress(self%seeds, stages%accuracy%steady%stop)
    end do
    call fill_branches(found, self%tables(self%place('branches')), error)
    call fill_points(found, self%tables(self%place('branch_points')), error)
    call fill_changes(found, self%tables(self%place('branch_changes')), error)
    if (allocated(error)) return
    self%failed = sum(found%unresolved)
    self%is_done = .true.
    total = sum([(size(found(i)%branch), i=1, size(found))])
    self%log = 'branches: '//str(total)//' branches from motions at '//str(self%seeds*size(which))//' places'
  end subroutine run

  pure subroutine add_report(self, lines)
    class(branches_task_t), intent(in) :: self
    type(lines_t), intent(inout) :: lines
    character(:), allocatable :: name

    name = trim(parameter_names(self%parameter))
    associate (branches => self%tables(self%place('branches')), changes => self%tables(self%place('branch_changes')))
      call lines%add('')
      call lines%add('Branches of periodic motions over '//name//', from motions at '//str(self%seeds)//' places')
      call branches%show(lines, 'branch mesh_periods least largest largest_dynamic_factor first_end last_end')
      call changes%show(lines, 'branch kind '//name//' dynamic_factor')
    end associate
  end subroutine add_report
end module gearsweep_nonlinear_task_branches
