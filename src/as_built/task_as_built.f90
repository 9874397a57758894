!> The task `as_built`: motion of gears with individual tooth errors, over the mesh periods after which these repeat.
!>
!> All speeds are swept for each drawn pair of gears, each assembly and each relief. The motions of one pair of gears and assembly
!> are computed over a revolution at chosen speeds: load of each pair of teeth, transmission error, orders.
module gearsweep_as_built_task_as_built
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use gearsweep_base, only: claim_memory, code_input, dp, error_t, fail, fixed, lines_t, no_number, str, wants_stop
  use gearsweep_gear, only: fit_flanks, flank_points_t, read_flank_points
  use gearsweep_mesh, only: smooth_intervals
  use gearsweep_motion, only: has_result, oscillator_t, scheme_collocation, sweep_t, turn_t
  use gearsweep_study, only: case_facts_t, check_reliefs, gear_names, is_prescribed, needs_gears, reader_t, &
    runnable_t, stage, stages_t, task_info_t, text_unless
  use gearsweep_as_built_deviation_keys, only: check_deviations, deviations_choice_t, read_deviations
  use gearsweep_as_built_specimens, only: deviating, draw_specimens, follow_turn, run_specimens, specimen_t, &
    sweep_each, unit_root_stress
  use gearsweep_as_built_tables, only: add_extremes, extremes_t, fill_loads, fill_orders, fill_points, fill_summary, fill_teeth, &
    fill_tolerances, fill_turn, fill_waterfall, fill_worst, find_extremes, report_extremes
  implicit none
  private
  public :: as_built_task_t

  type, extends(runnable_t) :: as_built_task_t
    type(deviations_choice_t) :: deviations
    real(dp), allocatable :: turn_rpm(:)         !< speeds of the motion over a revolution; not allocated: that of the largest load
    integer :: turn_draw = 1, turn_assembly = 1  !< draw and assembly of that motion
    integer :: mesh_orders = 3                   !< largest mesh order in the tables
    logical :: waterfall = .false.               !< true: orders at all speeds
    logical :: quick = .false.                   !< true: most pairs of gears to 1e-3 only
    logical :: with_ste = .false., with_root_stress = .false.  !< true: these for each pair of gears
    integer :: ste_harmonic = 0                  !< mesh harmonic of the static transmission error; 0: not requested
  contains
    procedure, nopass :: describe
    procedure :: read_keys, check, parse_files, count_points, run, add_report
  end type as_built_task_t

  character(*), parameter :: group = 'as_built'
  real(dp), parameter :: interval_bytes = 8e3_dp  !< memory of a smooth interval, with its tables

contains

  pure subroutine describe(info)
    type(task_info_t), intent(out) :: info

    info = task_info_t(group, needs=[stage%elasticity, stage%mesh, stage%reliefs, stage%amounts, stage%motion, stage%losses, &
                                     stage%accuracy, stage%speeds], &
                       tables='as_built as_built_summary as_built_worst as_built_teeth as_built_loads as_built_turn '// &
                       'as_built_orders as_built_waterfall tolerances', &
                       fields='', &
                       summary='dynamic factor of gears whose teeth have errors of their own, over whole turns: worst '// &
                       'assembly, load of each pair of teeth, orders of the transmission error')
  end subroutine describe

  subroutine read_keys(self, reader, error)
    class(as_built_task_t), intent(inout) :: self
    type(reader_t), intent(inout) :: reader
    type(error_t), allocatable, intent(inout) :: error
    integer :: i, k

    call reader%add_group(group, 'The task as_built: gears whose teeth have errors of their own.')
    call self%read_speeds(reader, group, error)
    call self%read_reliefs(reader, group, error)
    call reader%get(group, 'turn_rpm', self%turn_rpm, error, unit='1/min', tasks=group, at_least=1e-6_dp, at_most=1e9_dp, &
                    max_size=100, distinct=.true., default_note='that of the largest dynamic factor, of each relief', &
                    meaning='speeds of the pinion at which the motion is followed over the turn')
    call reader%get(group, 'turn_draw', self%turn_draw, error, tasks=group, at_least=1, at_most=10000, &
                    meaning='which pair of gears is followed over the turn, in the order in which they are drawn')
    call reader%get(group, 'turn_assembly', self%turn_assembly, error, tasks=group, at_least=1, at_most=100000, &
                    meaning='which assembly of it is')
    call reader%get(group, 'mesh_orders', self%mesh_orders, error, tasks=group, at_least=1, at_most=20, &
                    meaning='mesh orders up to which orders of the transmission error are listed')
    call reader%get(group, 'waterfall', self%waterfall, error, tasks=group, &
                    meaning='whether these orders are listed at all speeds, for the first relief')
    call reader%get(group, 'quick', self%quick, error, tasks=group, &
                    meaning='whether dynamic factors are found to 1e-3 only, in a small part of the time. Of the pairs '// &
                    'of gears and assemblies the first and one in ten, ten at most, are computed to the tolerance too; '// &
                    'sample_error is the difference')
    call reader%get(group, 'with_ste', self%with_ste, error, tasks=group, &
                    meaning='whether the peak-to-peak static transmission error of each pair of gears and assembly is computed')
    call reader%get(group, 'ste_harmonic', self%ste_harmonic, error, tasks=group, at_least=0, at_most=100, &
                    meaning='harmonic of the mesh frequency whose amplitude in the static transmission error of each pair of '// &
                    'gears and assembly is computed, over the turn; 0: none')
    call reader%get(group, 'with_root_stress', self%with_root_stress, error, tasks=group, &
                    not_allowed=text_unless(.not. is_prescribed(reader), needs_gears), &
                    meaning='whether the largest root stress of each pair of gears and assembly is computed, in motion at the '// &
                    'speed of its largest dynamic factor')
    call read_deviations(reader, self%deviations, error)
    allocate (self%files(count([(allocated(self%deviations%files(i)%name), i=1, 2)])))
    k = 0
    do i = 1, 2
      if (.not. allocated(self%deviations%files(i)%name)) cycle
      k = k + 1
      self%files(k)%name = self%deviations%files(i)%name
    end do
  end subroutine read_keys

  subroutine check(self, facts, error)
    class(as_built_task_t), intent(in) :: self
    type(case_facts_t), intent(in) :: facts
    type(error_t), allocatable, intent(inout) :: error
    integer :: teeth(2)

    call check_reliefs(self, facts, error)
    if (facts%scheme /= scheme_collocation) call fail(error, code_input, &
      '&numerics method: the methods of the literature know nominal teeth only; with the task as_built it must be collocation')
    call check_deviations(self%deviations, facts%spec, error)
    if (allocated(error)) return
    teeth = facts%spec%teeth
    associate (draws => self%deviations%draws, assemblies => self%deviations%assemblies(teeth))
      if (self%turn_draw > draws) call fail(error, code_input, '&as_built turn_draw = '//str(self%turn_draw)// &
        ': must be at most &deviations draws, '//str(draws))
      if (self%turn_assembly > assemblies) call fail(error, code_input, '&as_built turn_assembly = '//str(self%turn_assembly)// &
        ': must be at most the number of assemblies, '//str(assemblies))
      if (self%quick .and. draws*assemblies == 1) call fail(error, code_input, &
        '&as_built quick: does not go with a single pair of gears and assembly, as that is computed to the tolerance; needs '// &
        '&deviations draws above 1, or assembly = ''all'' of gears whose numbers of teeth have a common divisor')
    end associate
  end subroutine check

  !> Reads the files of measured flanks, in the order of `read_keys`.
  subroutine parse_files(self, stages, error)
    class(as_built_task_t), intent(inout) :: self
    type(stages_t), intent(in) :: stages         !< stages with the gears only
    type(error_t), allocatable, intent(inout) :: error
    type(flank_points_t) :: points
    integer :: i, k

    k = 0
    do i = 1, 2
      if (.not. allocated(self%deviations%files(i)%name)) cycle
      k = k + 1
      associate (file => self%files(k), choice => self%deviations%files(i), flanks => self%deviations%flanks(i))
        call read_flank_points(file%path, file%text, stages%pair%gear(i)%spec%teeth, choice%flank, points, error)
        if (.not. allocated(error)) call fit_flanks(file%path, points, stages%pair, i, flanks%measured, choice%residual, error)
      end associate
      if (allocated(error)) return
    end do
  end subroutine parse_files

  !> Counts each point of the sweeps.
  integer function count_points(self, stages) result(points)
    class(as_built_task_t), intent(in) :: self
    type(stages_t), intent(in) :: stages
    real(dp), allocatable :: rpm(:)
    integer, allocatable :: which(:)

    call self%list_speeds(stages, rpm)
    call self%list_reliefs(stages, which)
    points = size(rpm)*size(which)*(1 + self%deviations%draws*self%deviations%assemblies(stages%motion(1)%mesh%teeth))
  end function count_points

  subroutine run(self, stages, error)
    class(as_built_task_t), intent(inout) :: self
    type(stages_t), intent(in) :: stages
    type(error_t), allocatable, intent(inout) :: error
    type(specimen_t), allocatable :: specimens(:, :)         ! (assembly, draw)
    type(oscillator_t), allocatable :: followed(:)         ! (relief)
    type(turn_t), allocatable :: turns(:, :)               ! (speed, relief)
    type(turn_t), allocatable :: waterfall(:)              ! (speed)
    type(sweep_t) :: nominal
    type(extremes_t) :: extremes
    real(dp), allocatable :: rpm(:), sample_error(:)
    real(dp), allocatable :: unit_stress(:, :)   ! if the largest root stresses are requested
    integer, allocatable :: which(:)
    real(dp) :: specimen_bytes
    integer :: assemblies, draw, i

    call self%list_speeds(stages, rpm)
    call self%list_reliefs(stages, which)
    assemblies = self%deviations%assemblies(stages%motion(1)%mesh%teeth)
    associate (motion => stages%motion(1))
      specimen_bytes = 3.5e3_dp + 80*sum(motion%mesh%teeth) + size(which)*(400.0_dp*size(rpm) + 100)
      call claim_memory(specimen_bytes*assemblies*self%deviations%draws + &
                        interval_bytes*size(smooth_intervals(motion%mesh, motion%friction > 0))* &
                        self%deviations%turn(motion%mesh%teeth), &
                        '&deviations draws: '//str(self%deviations%draws)//' pairs of gears', error)
    end associate
    if (allocated(error)) return
    call sweep_each(stages, stages%motion(which), rpm, nominal, error)
    call draw_specimens(self%deviations, stages, assemblies, specimens, error)
    if (allocated(error)) return
    allocate (sample_error(size(which)), source=no_number())
    if (self%with_root_stress) unit_stress = unit_root_stress(stages%pair)
    call run_specimens(stages, which, rpm, self%quick, size(specimens), specimens, sample_error, error, unit_stress)
    if (allocated(error)) return
    call find_extremes(stages, which, nominal, specimens, self%with_ste, self%ste_harmonic, unit_stress, extremes, error)
    if (.not. wants_stop(stages%accuracy%steady%stop)) then
      followed = deviating(stages%motion(which), specimens(self%turn_assembly, self%turn_draw)%deviations, error)
      call follow(self, stages, followed, rpm, specimens(self%turn_assembly, self%turn_draw), turns, waterfall, error)
    end if
    if (allocated(error)) return
    self%is_stopped = wants_stop(stages%accuracy%steady%stop)
    if (self%is_stopped) then
      self%log = 'as_built: interrupted'
      self%is_done = .true.
      return
    end if
    associate (amount => stages%amount(which), teeth => stages%motion(1)%mesh%teeth, &
               specimen => specimens(self%turn_assembly, self%turn_draw))
      call fill_points(amount, nominal, specimens, self%tables(self%place('as_built')), error)
      call fill_summary(amount, nominal, specimens, self%deviations%class, sample_error, &
                        self%tables(self%place('as_built_summary')), error)
      call fill_worst(teeth, amount, nominal, specimens, self%tables(self%place('as_built_worst')), error)
      if (.not. allocated(error)) call add_extremes(extremes, self%tables(self%place('as_built_worst')))
      call fill_teeth(teeth, specimen%flanks, self%tables(self%place('as_built_teeth')), error)
      call fill_loads(stages, amount, turns, specimen, self%tables(self%place('as_built_loads')), error)
      call fill_turn(followed, amount, turns, self%tables(self%place('as_built_turn')), error)
      call fill_orders(followed, amount, turns, self%mesh_orders, self%tables(self%place('as_built_orders')), error)
      if (self%waterfall) call fill_waterfall(teeth, waterfall, self%mesh_orders, &
                                              self%tables(self%place('as_built_waterfall')), error)
    end associate
    if (any(self%deviations%class > 0)) &
      call fill_tolerances(stages%pair, self%deviations%class, self%tables(self%place('tolerances')), error)
    self%is_done = .true.
    self%failed = count(.not. has_result(nominal%status)) + &
                  merge(count(.not. has_result(turns%point%steady%status)), 0, allocated(self%turn_rpm)) + &
                  sum([((count(.not. has_result(specimens(i, draw)%sweep%status)), i=1, assemblies), draw=1, size(specimens, 2))])
    self%log = 'as_built: '//str(size(rpm)*size(which)*size(specimens))//' operating points over '// &
               str(followed(1)%mesh%deviations%periods)//' mesh periods each'
    do i = 1, 2
      if (allocated(self%deviations%files(i)%name)) self%log = self%log//'; the polynomials leave '// &
        str(1e6_dp*self%deviations%files(i)%residual, 3)//' um (root mean square) of '//trim(gear_names(i))//'_flanks_file'
    end do
  end subroutine run

  !> Computes the motions of one pair of gears over the revolution.
  subroutine follow(self, stages, osc, rpm, specimen, turns, waterfall, error)
    class(as_built_task_t), intent(in) :: self
    type(stages_t), intent(in) :: stages
    type(oscillator_t), intent(in) :: osc(:)     ! (relief)
    real(dp), intent(in) :: rpm(:)
    type(specimen_t), intent(in) :: specimen
    type(turn_t), allocatable, intent(out) :: turns(:, :), waterfall(:)
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: unit_stress(:, :)
    integer :: i, k, n

    if (allocated(stages%pair)) unit_stress = unit_root_stress(stages%pair)
    n = 1
    if (allocated(self%turn_rpm)) n = size(self%turn_rpm)
    allocate (turns(n, size(osc)), waterfall(merge(size(rpm), 0, self%waterfall)))
    do i = 1, size(osc)
      do k = 1, n
        if (allocated(self%turn_rpm)) then
          call follow_turn(osc(i), self%turn_rpm(k), stages, specimen%sweep, i, turns(k, i), error, unit_stress)
        else if (specimen%worst(i)%rpm > 0) then
          call follow_turn(osc(i), specimen%worst(i)%rpm, stages, specimen%sweep, i, turns(k, i), error, unit_stress)
        end if
        if (allocated(error)) return
      end do
    end do
    do k = 1, size(waterfall)
      call follow_turn(osc(1), rpm(k), stages, specimen%sweep, 1, waterfall(k), error)
      if (allocated(error)) return
    end do
  end subroutine follow

  pure subroutine add_report(self, lines)
    class(as_built_task_t), intent(in) :: self
    type(lines_t), intent(inout) :: lines
    integer :: specimens, row

    if (.not. self%tables(self%place('as_built_summary'))%is_there()) return
    call lines%add('')
    associate (summary => self%tables(self%place('as_built_summary')), worst => self%tables(self%place('as_built_worst')))
      specimens = worst%extent(2)*worst%extent(3)
      if (specimens > 1) then
        call lines%add('Gears as built: largest dynamic factor over the speeds; pairs of gears: '//str(worst%extent(2))// &
                       ', assemblies: '//str(worst%extent(3)))
        call summary%show(lines, 'relief_um nominal_factor least_factor median_factor quantile_95_factor largest_factor rpm '// &
                          'worst_draw worst_assembly')
      else
        call lines%add('Gears as built: largest dynamic factor over the speeds')
        call worst%show(lines, 'relief_um nominal_factor dynamic_factor rpm pinion_tooth gear_tooth')
      end if
      if (self%quick) then
        associate (off => [(summary%number('sample_error', row), row=1, summary%rows)])
          if (.not. all(ieee_is_nan(off))) call lines%add('   found quickly; those of a sample differ from those to the '// &
            'tolerance by at most '//str(maxval(pack(off, .not. ieee_is_nan(off))), 2))
          if (any(ieee_is_nan(off))) call lines%add('   found quickly; at a relief whose sample_error is NaN, no motion of the '// &
                                                    'sample is known both ways')
        end associate
      end if
      associate (share => summary%number('within_class', 1))
        if (.not. ieee_is_nan(share)) then
          if (share < 1) call lines%add('   within their class by f_p, F_p, f_Halpha and F_r: '//str(100*share, 2)// &
            ' % of the pairs of gears; &deviations accepted draws no others')
        end if
      end associate
      call report_extremes(worst, lines)
      associate (points => self%tables(self%place('as_built')))
        associate (coast => points%numbers('coast_factor'))
          if (any(pack(coast, .not. ieee_is_nan(coast)) > 0)) &
            call lines%add('   coast flanks touch; the profiles of coast flanks are nominal')
        end associate
        associate (seen => points%numbers('seen_dynamic_factor'))
          row = maxloc(seen, 1, mask=.not. ieee_is_nan(seen))
          if (row > 0) call lines%add('   '//str(count(.not. ieee_is_nan(seen)))//' of '//str(points%rows)//' points do not '// &
            'repeat; the largest dynamic factor seen in them is '//fixed(seen(row), 4)//' at '// &
            str(points%number('rpm', row))//' 1/min')
        end associate
      end associate
    end associate
    associate (orders => self%tables(self%place('as_built_orders')))
      do row = 1, orders%rows
        if (row > 1) then
          if (orders%number('order', row) > orders%number('order', row - 1)) cycle
        end if
        if (.not. (orders%number('rpm', row) > 0 .and. ieee_is_nan(orders%number('dte_amplitude_um', row)))) cycle
        call lines%add('   no motion to follow at a relief of '//str(orders%number('relief_um', row))//' um and '// &
                       str(orders%number('rpm', row))//' 1/min: '//trim(orders%word('status', row)))
      end do
    end associate
  end subroutine add_report
end module gearsweep_as_built_task_as_built
