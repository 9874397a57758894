!> The task `optimum`: the relief whose largest dynamic factor over all speeds is least; also amounts and lengths of both gears'
!> reliefs together, under several loads.
module gearsweep_task_optimum
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use gearsweep_case_variation, only: with_relief
  use gearsweep_decimal, only: in_um
  use gearsweep_error, only: code_memory, error_t, fail
  use gearsweep_error_estimate, only: point_t
  use gearsweep_joint_designs, only: design_starts, designs_t, fill_design, fill_loads, make_designs, with_design
  use gearsweep_joint_optimum, only: find_joint_optimum, joint_optimum_t
  use gearsweep_kinds, only: dp
  use gearsweep_largest_motion, only: find_point
  use gearsweep_lines, only: left, lines_t
  use gearsweep_motions, only: largest_relief
  use gearsweep_optimum, only: find_optimum, most_tried, optimum_t
  use gearsweep_oscillator, only: oscillator_t
  use gearsweep_points, only: of_worst
  use gearsweep_reader, only: reader_t
  use gearsweep_status, only: has_result
  use gearsweep_sweep, only: sweep_options_t, sweep_state_t
  use gearsweep_table, only: axis, no_number, table_t
  use gearsweep_stages, only: runnable_t, stages_t
  use gearsweep_task, only: stage, task_info_t
  use gearsweep_text, only: fixed, str
  implicit none
  private
  public :: optimum_task_t

  type, extends(runnable_t) :: optimum_task_t
    logical :: with_length = .false., each_gear = .false.
    real(dp), allocatable :: load_factor(:)
  contains
    procedure, nopass :: describe
    procedure :: read_keys, run, add_report, count_points
    procedure, private :: search_jointly, has_loads, add_design
  end type optimum_task_t

  character(*), parameter :: group = 'optimum'
  character(28), parameter :: of_load(2) = [character(28) :: '', ', under the load of the case']

contains

  pure subroutine describe(info)
    type(task_info_t), intent(out) :: info

    info = task_info_t(group, needs=[stage%mesh, stage%reliefs, stage%motion, stage%losses, stage%accuracy, stage%speeds, &
                                     stage%direction], &
                       tables='optimum optimum_curve optimum_design optimum_loads', fields='', &
                       gives='the relief whose largest dynamic factor over all speeds is least')
  end subroutine describe

  subroutine read_keys(self, reader, error)
    class(optimum_task_t), intent(inout) :: self
    type(reader_t), intent(inout) :: reader
    type(error_t), allocatable, intent(inout) :: error

    self%load_factor = [1.0_dp]
    call reader%add_group(group, 'The task optimum: what is varied beside the amount of relief.')
    call reader%get(group, 'with_length', self%with_length, error, tasks=group, &
                    meaning='amount and length of the relief are varied together; its shape stays')
    call reader%get(group, 'each_gear', self%each_gear, error, tasks=group, &
                    meaning='the reliefs of pinion and gear are varied each by itself, instead of by gear_fraction')
    call reader%get(group, 'load_factors', self%load_factor, error, tasks=group, at_least=1e-3_dp, at_most=1e3_dp, min_size=1, &
                    max_size=20, meaning='loads over that of the case: the largest dynamic factor under all of them counts')
  end subroutine read_keys

  !> At most, as the search may try some reliefs twice.
  integer function count_points(self, stages) result(points)
    class(optimum_task_t), intent(in) :: self
    type(stages_t), intent(in) :: stages

    points = most_tried*merge(size(stages%rpm), 0, self%uses(stage%speeds))
  end function count_points

  subroutine run(self, stages, error)
    class(optimum_task_t), intent(inout) :: self
    type(stages_t), intent(in) :: stages
    type(error_t), allocatable, intent(inout) :: error
    type(sweep_state_t), pointer :: states(:)
    type(sweep_options_t) :: options
    type(optimum_t) :: optimum
    real(dp) :: largest

    nullify (states)
    if (associated(stages%running%states)) states => stages%running%states(2:)
    options = stages%sweep_options()
    associate (inputs => stages%motions_inputs)
      if (associated(stages%running%progress)) then
        call find_optimum(with_relief, inputs, largest_relief(inputs), stages%rpm, options, optimum, error, &
                          stages%running%progress, states)
      else
        call find_optimum(with_relief, inputs, largest_relief(inputs), stages%rpm, options, optimum, error, states=states)
      end if
    end associate
    if (allocated(error) .or. optimum%stopped) return
    stages%running%done = stages%running%done + size(optimum%amount)*size(stages%rpm)
    call find_largest(stages, optimum, largest, error)
    call fill_best(optimum, largest, self%tables(self%place('optimum')), error)
    call fill_curve(optimum, self%tables(self%place('optimum_curve')), error)
    if (.not. allocated(error)) call self%search_jointly(stages, options, optimum, error)
    if (allocated(error) .or. self%is_stopped) return
    self%is_done = .true.
    self%failed = nint(self%tables(self%place('optimum'))%number('points_without_answer'))
    self%log = 'optimum: '//str(size(optimum%amount))//' reliefs swept'
  end subroutine run

  !> The largest dynamic factor of all motions that are known with the best relief at its worst speed: its own, and those that a
  !> start reaches; NaN: there is none.
  subroutine find_largest(stages, optimum, largest, error)
    type(stages_t), intent(in) :: stages
    type(optimum_t), intent(in) :: optimum
    real(dp), intent(out) :: largest
    type(error_t), allocatable, intent(inout) :: error
    type(oscillator_t) :: motion
    type(point_t) :: point
    integer :: motions
    logical :: lacks

    largest = no_number()
    if (allocated(error) .or. optimum%best == 0) return
    call with_relief(stages%motions_inputs, optimum%amount(optimum%best), motion, error)
    if (allocated(error)) return
    call find_point(motion, optimum%rpm(optimum%best), stages%accuracy, point, motions, lacks)
    if (lacks) call fail(error, code_memory, '&case tasks = ''optimum'': the memory does not hold all motions at a speed')
    largest = optimum%dynamic_factor(optimum%best)
    if (has_result(point%steady%status)) largest = max(largest, point%dynamic_factor)
  end subroutine find_largest

  !> Are there other loads than that of the case?
  pure logical function has_loads(self)
    class(optimum_task_t), intent(in) :: self

    has_loads = size(self%load_factor) > 1 .or. any(abs(self%load_factor - 1) > 0)
  end function has_loads

  !> Several numbers at once, or several loads, where the keys ask for that.
  subroutine search_jointly(self, stages, options, of_amount, error)
    class(optimum_task_t), intent(inout) :: self
    type(stages_t), intent(in) :: stages
    type(sweep_options_t), intent(in) :: options
    type(optimum_t), intent(in) :: of_amount     ! where one amount is varied
    type(error_t), allocatable, intent(inout) :: error
    type(designs_t) :: designs
    type(joint_optimum_t) :: optimum
    real(dp) :: amount

    if (.not. (self%with_length .or. self%each_gear .or. self%has_loads())) return
    amount = -1
    if (of_amount%best > 0) amount = of_amount%amount(of_amount%best)
    designs = designs_t(self%with_length, self%each_gear, self%load_factor, stages%motions_inputs)
    call make_designs(designs, amount)
    call find_joint_optimum(with_design, designs, design_starts(designs, amount), stages%rpm, options, optimum, error)
    if (allocated(error)) return
    self%is_stopped = optimum%stopped
    if (self%is_stopped) return
    call fill_design(designs, optimum, self%tables(self%place('optimum_design')), error)
    call fill_loads(designs, optimum, self%tables(self%place('optimum_loads')), error)
  end subroutine search_jointly

  !> The optimum relief.
  pure subroutine fill_best(optimum, largest, table, error)
    type(optimum_t), intent(in) :: optimum
    real(dp), intent(in) :: largest              !< dynamic factor of all motions there
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(dp) :: best(3)
    integer :: failed

    call table%begin('the relief whose largest dynamic factor over the speeds is least', 1, error)
    if (allocated(error)) return
    best = no_number()
    failed = sum(optimum%failed)
    if (optimum%best > 0) then
      best = [in_um(optimum%amount(optimum%best)), optimum%dynamic_factor(optimum%best), optimum%rpm(optimum%best)]
      failed = optimum%failed(optimum%best)
    end if
    call table%add('relief_um', 'um', 'optimum relief; NaN where no point has an answer', best(1:1))
    call table%add('worst_dynamic_factor', '', of_worst, best(2:2))
    call table%add('rpm', '1/min', 'speed of the pinion where that is', best(3:3))
    call table%add('largest_dynamic_factor', '', 'largest DF at that speed of all motions that are known: its own, and '// &
                   'those that a start reaches; NaN where there is none', [largest])
    call table%add('within_um', 'um', 'the true optimum lies so near', [1e6_dp*optimum%resolution])
    call table%add('points_without_answer', '', 'speeds without an answer there; of all reliefs where no point has one', &
                   [failed])
  end subroutine fill_best

  !> Largest dynamic factor over the speeds against the relief (Dogan et al. 2021, Fig. 8).
  pure subroutine fill_curve(optimum, table, error)
    type(optimum_t), intent(in) :: optimum
    type(table_t), intent(inout) :: table
    type(error_t), allocatable, intent(inout) :: error

    call table%over('largest dynamic factor over the speeds against the relief', error, &
                    axis('relief_um', 'um', 'amount of relief, ascending', in_um(optimum%amount)))
    if (allocated(error)) return
    call table%add('worst_dynamic_factor', '', of_worst, optimum%dynamic_factor)
    call table%add('rpm', '1/min', 'speed of the pinion where that is', optimum%rpm)
    call table%add('points_without_answer', '', 'speeds without an answer', optimum%failed)
    call table%add('at_least', '', '1: a few speeds showed that this relief is not the best, and the largest DF is that of '// &
                   'these; else 0', merge(1, 0, optimum%is_bound))
  end subroutine fill_curve

  pure subroutine add_report(self, lines)
    class(optimum_task_t), intent(in) :: self
    type(lines_t), intent(inout) :: lines
    real(dp), parameter :: alike = 1e-4_dp       ! as shown

    associate (best => self%tables(self%place('optimum')), curve => self%tables(self%place('optimum_curve')))
      if (ieee_is_nan(best%number('rpm'))) then
        call lines%add(left('Optimum relief', 19)//'none: no operating point has an answer')
        return
      end if
      call lines%add(left('Optimum relief', 19)//str(best%number('relief_um'), 4)//' um (within '// &
                     str(best%number('within_um'), 1)//'): worst DF '//fixed(best%number('worst_dynamic_factor'), 4)// &
                     ' at '//str(best%number('rpm'))//' rpm'//trim(of_load(merge(2, 1, self%has_loads()))))
      if (best%number('largest_dynamic_factor') > (1 + alike)*best%number('worst_dynamic_factor')) call lines%add(left('', 19)// &
        'of all motions that a start reaches at this speed, the largest has DF '// &
        fixed(best%number('largest_dynamic_factor'), 4)//' (task attractors)')
      if (.not. best%number('relief_um') < curve%number('relief_um', curve%rows)) call lines%add(left('', 19)// &
        'at the end of the range searched: more relief may be better still')
      if (self%failed > 0) call lines%add(left('', 19)//str(self%failed)//' speeds have no answer there')
    end associate
    call self%add_design(lines)
  end subroutine add_report

  !> The design of several numbers, with the load of each dynamic factor.
  pure subroutine add_design(self, lines)
    class(optimum_task_t), intent(in) :: self
    type(lines_t), intent(inout) :: lines
    integer :: i

    associate (best => self%tables(self%place('optimum_design')), loads => self%tables(self%place('optimum_loads')))
      if (.not. best%is_there()) return
      if (ieee_is_nan(best%number('worst_dynamic_factor'))) return
      call lines%add(left('Optimum design', 19)//'pinion '//trim(relief_in(best, 'pinion'))//', gear '// &
                     trim(relief_in(best, 'gear'))//': worst DF '//fixed(best%number('worst_dynamic_factor'), 4))
      if (.not. self%has_loads()) return
      do i = 1, loads%rows
        if (ieee_is_nan(loads%number('rpm', i))) cycle
        call lines%add(left('', 19)//'under '//str(loads%number('load_factor', i))//' times the load of the case: worst DF '// &
                       fixed(loads%number('worst_dynamic_factor', i), 4)//' at '//str(loads%number('rpm', i))//' rpm')
      end do
    end associate
  end subroutine add_design

  !> Amount of a gear's relief, and where it begins: at a diameter, where the gear is known.
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
end module gearsweep_task_optimum
