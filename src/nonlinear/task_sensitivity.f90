!> The task `sensitivity`: derivatives of the dynamic factor and of the harmonics of dynamic and static transmission error by
!> each number of the motion, at chosen speeds (see gearsweep_nonlinear_sensitivity).
module gearsweep_nonlinear_task_sensitivity
  use gearsweep_base, only: axis, code_memory, dp, error_t, fail, lines_t, no_number, str, table_t, wants_stop
  use gearsweep_motion, only: has_result, levels_t, mesh_period, oscillator_t, point_t, solve_point
  use gearsweep_study, only: case_variation_t, motions_inputs_t, number_names, number_units, of_factor, &
    of_relief, of_speed, reader_t, relief_start, runnable_t, stage, stages_t, task_info_t, vary_amount, vary_backlash, &
    vary_damping, vary_force, vary_friction, vary_mass, vary_profile, vary_rpm, vary_start, vary_stiffness
  use gearsweep_nonlinear_sensitivity, only: differentiable_t, differentiate_motion, differentiate_static, prepare_motion, &
    slope_names, slopes_t, variation_t
  implicit none
  private
  public :: sensitivity_task_t

  !> Numbers of the derivatives, in the order of the tables.
  integer, parameter :: listed(13) = [vary_rpm, vary_force, vary_damping, vary_friction, vary_mass, vary_stiffness, vary_amount, &
    vary_start, vary_profile, vary_backlash]

  !> One number of a case with this relief at this speed.
  type, extends(variation_t) :: case_number_t
    integer :: which = 0                         !< index in gearsweep_study_run_case_variation
    type(case_variation_t) :: case
  contains
    procedure :: vary
  end type case_number_t

  type, extends(runnable_t) :: sensitivity_task_t
    integer :: harmonics = 3
  contains
    procedure, nopass :: describe
    procedure :: read_keys, run, add_report
  end type sensitivity_task_t

  !> One number of a motion, or of the mesh at rest (speed 0).
  type :: row_t
    real(dp) :: relief = 0, rpm = 0              !< m, 1/min
    integer :: which = 0                         !< index in `number_names`
    real(dp) :: value = 0, dynamic_factor = 0
    type(slopes_t) :: slopes
  end type row_t

  character(*), parameter :: group = 'sensitivity', of_unit = ', for one unit more of the number', &
    of_harmonic = '0 for the mean, 1, 2 ... for the mesh frequency', of_number = 'which number of the case, with its unit', &
    of_kind = 'smooth: there is a derivative; least: to larger values only, as there are no smaller ones; peak: the largest '// &
      'load changes its place; contact: a pair that enters or leaves begins or ceases to touch; grazing: flanks on the path '// &
      'do; fold: the motion ceases to be; none: no motion'

contains

  !> Lists the numbers with an effect in a case with this amount of relief (m) at a speed (1/min). Changes of amounts are relative
  !> to the deflection of a pair under the full load.
  subroutine list_numbers(inputs, relief, rpm, numbers)
    type(motions_inputs_t), intent(in) :: inputs
    real(dp), intent(in) :: relief, rpm
    type(case_number_t), allocatable, intent(out) :: numbers(:)
    type(case_variation_t) :: case
    type(case_number_t) :: of
    real(dp) :: deflection, start(2)
    integer :: i

    case = case_variation_t(inputs, relief, rpm)
    associate (motion => inputs%motion)
      deflection = motion%load/inputs%stiffness%value(motion%relief%contact_ratio/2)
    end associate
    start = relief_start(inputs%motion%relief)
    of%case = case
    of%least = 0
    allocate (numbers(0))
    do i = 1, size(listed)
      if (.not. has_effect(case, listed(i))) cycle
      associate (which => listed(i))
        of%which = which
        of%value = case%number(which)
        if (any(which == vary_start)) of%value = start(findloc(vary_start, which, 1))
        of%scale = of%value
        if (which == vary_damping) of%scale = max(of%value, 0.01_dp)
        if (any(which == vary_amount)) of%scale = max(of%value, deflection)
        if (any(which == vary_start)) of%scale = 1
        if (which == vary_backlash) of%scale = deflection
      end associate
      numbers = [numbers, of]
    end do
  end subroutine list_numbers

  !> True if the number has an effect. Without relief, its amount and start have none.
  pure logical function has_effect(case, which)
    type(case_variation_t), intent(in) :: case
    integer, intent(in) :: which
    logical :: relieved

    associate (inputs => case%inputs)
      relieved = case%relief > 0 .and. .not. allocated(inputs%profile_error%breaks)
      select case (which)
      case (vary_friction)
        has_effect = inputs%motion%friction > 0
      case (vary_profile)
        has_effect = allocated(inputs%profile_error%breaks)
        if (has_effect) has_effect = any(abs(inputs%profile_error%coef) > 0)
      case (vary_amount(1), vary_amount(2))
        has_effect = relieved
      case (vary_start(1), vary_start(2))
        has_effect = relieved .and. case%number(vary_amount(findloc(vary_start, which, 1))) > 0
      case (vary_backlash)
        has_effect = inputs%motion%has_backlash
      case default
        has_effect = .true.
      end select
    end associate
  end function has_effect

  !> Builds the oscillator of the case with the number increased by `change`, in SI units.
  subroutine vary(self, change, osc, duration, error)
    class(case_number_t), intent(in) :: self
    real(dp), intent(in) :: change
    type(oscillator_t), intent(out) :: osc
    real(dp), intent(out) :: duration
    type(error_t), allocatable, intent(out) :: error
    type(case_variation_t) :: case

    case = self%case
    call case%set(self%which, case%number(self%which) + change)
    duration = case%duration()
    call case%build(osc, error)
  end subroutine vary

  pure subroutine describe(info)
    type(task_info_t), intent(out) :: info

    info = task_info_t(group, needs=[stage%mesh, stage%reliefs, stage%amounts, stage%motion, stage%losses, stage%accuracy], &
                       tables='sensitivity dte_sensitivity ste_sensitivity', fields='', &
                       summary='derivatives of dynamic factor and transmission error by each number of the motion')
  end subroutine describe

  subroutine read_keys(self, reader, error)
    class(sensitivity_task_t), intent(inout) :: self
    type(reader_t), intent(inout) :: reader
    type(error_t), allocatable, intent(inout) :: error

    call reader%add_group(group, 'The task sensitivity, at speeds of its own.')
    call reader%get(group, 'rpm', self%own_rpm, error, unit='1/min', required=.true., tasks=group, at_least=1e-6_dp, &
                    at_most=1e9_dp, max_size=1000, distinct=.true., meaning='speeds of the pinion')
    call self%read_reliefs(reader, group, error)
    call reader%get(group, 'harmonics', self%harmonics, error, tasks=group, at_least=1, at_most=100, &
                    meaning='harmonics of the mesh frequency whose amplitudes are differentiated')
  end subroutine read_keys

  subroutine run(self, stages, error)
    class(sensitivity_task_t), intent(inout) :: self
    type(stages_t), intent(in) :: stages
    type(error_t), allocatable, intent(inout) :: error
    type(row_t), allocatable :: rows(:), static(:)
    type(row_t) :: row
    type(case_number_t), allocatable :: numbers(:)
    integer, allocatable :: which(:)
    integer :: i, k

    call self%list_reliefs(stages, which)
    allocate (rows(0), static(0))
    do i = 1, size(which)
      call list_numbers(stages%motions_inputs, stages%amount(which(i)), 0.0_dp, numbers)
      do k = 1, size(numbers)
        if (.not. any(numbers(k)%which == [vary_force, vary_stiffness, vary_amount, vary_start, vary_profile])) cycle
        numbers(k)%case%rpm = 1
        row = row_t(stages%amount(which(i)), 0.0_dp, numbers(k)%which, numbers(k)%value, no_number())
        call differentiate_static(numbers(k), self%harmonics, row%slopes)
        static = [static, row]
      end do
      do k = 1, size(self%own_rpm)
        if (wants_stop(stages%accuracy%steady%stop)) return
        call add_motion(self, stages, which(i), self%own_rpm(k), rows, error)
        if (allocated(error)) return
        call stages%running%report_progress(1, stages%accuracy%steady%stop)
      end do
    end do
    call fill_factors(rows, self%tables(self%place('sensitivity')), error)
    call fill_harmonics(rows, self%harmonics, 'dte', self%tables(self%place('dte_sensitivity')), error)
    call fill_harmonics(static, self%harmonics, 'ste', self%tables(self%place('ste_sensitivity')), error)
    self%is_done = .true.
    self%log = 'sensitivity: '//str(size(rows))//' derivatives'
  end subroutine run

  !> Adds the derivatives of the motion with a relief at a speed by each number.
  subroutine add_motion(self, stages, which, rpm, rows, error)
    class(sensitivity_task_t), intent(inout) :: self
    type(stages_t), intent(in) :: stages
    integer, intent(in) :: which
    real(dp), intent(in) :: rpm
    type(row_t), allocatable, intent(inout) :: rows(:)
    type(error_t), allocatable, intent(inout) :: error
    type(case_number_t), allocatable :: numbers(:)
    type(differentiable_t) :: motion
    type(point_t) :: point
    type(row_t) :: row
    type(levels_t) :: levels
    integer :: i

    call solve_point(stages%motion(which), mesh_period(stages%motion(which)%mesh%teeth(1), rpm), stages%accuracy, levels, point)
    if (levels%lacks) call fail(error, code_memory, '&sensitivity rpm = '//str(rpm)//': the memory does not hold the motion')
    if (allocated(error)) return
    if (.not. has_result(point%steady%status)) self%failed = self%failed + 1
    associate (osc => stages%motion(which))
      call prepare_motion(osc, mesh_period(osc%mesh%teeth(1), rpm), point, self%harmonics, motion)
    end associate
    call list_numbers(stages%motions_inputs, stages%amount(which), rpm, numbers)
    do i = 1, size(numbers)
      row = row_t(stages%amount(which), rpm, numbers(i)%which, numbers(i)%value, no_number())
      if (has_result(point%steady%status)) row%dynamic_factor = point%dynamic_factor
      call differentiate_motion(motion, numbers(i), row%slopes)
      rows = [rows, row]
    end do
  end subroutine add_motion

  !> Fills a row for each relief, speed and number.
  subroutine fill_factors(rows, table, error)
    type(row_t), intent(in) :: rows(:)
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp) :: unit(size(rows)), part(size(rows))

    call table%begin('how the dynamic factor changes with each number of the motion', size(rows), error)
    if (allocated(error)) return
    unit = number_units(rows%which)
    part = rows%value*rows%slopes%dynamic_factor/rows%dynamic_factor
    call table%add_index(axis('relief_um', 'um', of_relief, [rows%relief]))
    call table%add_index(axis('rpm', '1/min', of_speed, [rows%rpm]))
    call table%add_index(axis('number', '', of_number, [number_names(rows%which)]))
    call table%add('value', '', 'its value, in the unit of its name', rows%value/unit)
    call table%add('dynamic_factor', '', of_factor, [rows%dynamic_factor])
    call table%add('slope', '', 'derivative of DF'//of_unit//'; NaN where there is none', rows%slopes%dynamic_factor*unit)
    call table%add('error_estimate', '', 'estimated error of the slope; NaN where it is not known', rows%slopes%estimate*unit)
    call table%add('slope_below', '', 'derivative to smaller values; NaN where there are none or contact changes', &
                   rows%slopes%below*unit)
    call table%add('slope_above', '', 'derivative to larger values', rows%slopes%above*unit)
    call table%add('relative_slope', '', 'by how many per cent DF grows where the number grows by one per cent', part)
    call table%add_words('derivative', of_kind, [slope_names(rows%slopes%kind)])
  end subroutine fill_factors

  !> Fills a row for each relief, speed, number and harmonic; without speed for the static transmission error.
  subroutine fill_harmonics(rows, harmonics, name, table, error)
    type(row_t), intent(in) :: rows(:)
    integer, intent(in) :: harmonics
    character(*), intent(in) :: name             ! dte or ste
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp) :: values(size(rows)*(harmonics + 1), 4)
    integer :: which(size(rows)*(harmonics + 1)), harmonic(size(rows)*(harmonics + 1)), kind(size(rows)*(harmonics + 1))
    integer :: i, k, n

    if (allocated(error)) return
    n = 0
    do i = 1, size(rows)
      do k = 0, harmonics
        n = n + 1
        which(n) = rows(i)%which
        harmonic(n) = k
        kind(n) = rows(i)%slopes%kind
        values(n, :) = [rows(i)%relief, rows(i)%rpm, rows(i)%slopes%amplitude(k), rows(i)%slopes%amplitude_estimate(k)]
        values(n, 3:) = values(n, 3:)*number_units(which(n))
      end do
    end do
    call table%begin('how mean and harmonics of the '//trim(merge('dynamic', 'static ', name == 'dte'))// &
                     ' transmission error change with each number of the motion', n, error)
    if (allocated(error)) return
    call table%add_index(axis('relief_um', 'um', of_relief, values(:, 1)))
    if (name == 'dte') call table%add_index(axis('rpm', '1/min', of_speed, values(:, 2)))
    call table%add_index(axis('number', '', of_number, [number_names(which)]))
    call table%add_index(axis('harmonic', '', of_harmonic, harmonic))
    call table%add(name//'_slope_um', 'um', 'derivative of its amplitude'//of_unit//'; NaN where there is none', values(:, 3))
    call table%add('error_estimate', 'um', 'estimated error of the slope; NaN where it is not known', values(:, 4))
    call table%add_words('derivative', of_kind, [slope_names(kind)])
  end subroutine fill_harmonics

  pure subroutine add_report(self, lines)
    class(sensitivity_task_t), intent(in) :: self
    type(lines_t), intent(inout) :: lines

    associate (table => self%tables(self%place('sensitivity')))
      call lines%add('')
      call lines%add('Relative slope: by how many per cent the dynamic factor grows where a number grows by one per cent')
      call table%show(lines, 'relief_um rpm number value relative_slope slope error_estimate derivative')
    end associate
  end subroutine add_report
end module gearsweep_nonlinear_task_sensitivity
