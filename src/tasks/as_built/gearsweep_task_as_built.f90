!> The task `as_built`: the motion of gears whose teeth have errors of their own, over the mesh periods after which these repeat.
!>
!> All speeds are swept for each pair of gears that is drawn, each assembly and each relief. The motions of the first gears and
!> assembly are followed over the turn at chosen speeds: load of each pair of teeth, transmission error, orders.
module gearsweep_task_as_built
  use gearsweep_as_built_tables, only: fill_loads, fill_orders, fill_points, fill_summary, fill_tolerances, &
                                       fill_turn, fill_waterfall, fill_worst, machine_t, tooth_t
  use gearsweep_deviation_keys, only: check_deviations, deviations_choice_t, read_deviations
  use gearsweep_deviations, only: deviations_t
  use gearsweep_error, only: code_memory, error_t, fail
  use gearsweep_flank_file, only: flank_points_t, read_flank_points
  use gearsweep_flank_deviations, only: draw_deviations, flank_deviations_t, frame_t, lay_deviations, make_frame
  use gearsweep_form, only: iso_form, nominal_root_stress
  use gearsweep_kinds, only: dp
  use gearsweep_lines, only: lines_t, right
  use gearsweep_measured_flanks, only: fit_flanks
  use gearsweep_memory, only: claim_memory
  use gearsweep_oscillator, only: make_oscillator, oscillator_t
  use gearsweep_pair, only: pair_t
  use gearsweep_points, only: factor_in
  use gearsweep_rack, only: gear_spec_t
  use gearsweep_random_stream, only: begin_stream, random_stream_t
  use gearsweep_reader, only: reader_t
  use gearsweep_refinement, only: levels_t
  use gearsweep_stages, only: runnable_t, stages_t
  use gearsweep_status, only: has_result, status_stopped
  use gearsweep_stop, only: wants_stop
  use gearsweep_sweep, only: each, run_sweep, sweep_options_t, sweep_t
  use gearsweep_task, only: members, stage, task_info_t
  use gearsweep_text, only: str
  use gearsweep_tolerances, only: find_tolerances, tolerances_t
  use gearsweep_turn, only: curve_t, find_static_turn, find_turn, turn_t
  implicit none
  private
  public :: as_built_task_t

  type, extends(runnable_t) :: as_built_task_t
    type(deviations_choice_t) :: deviations
    real(dp), allocatable :: turn_rpm(:)         !< speeds at which the motion is followed; without, that of the largest load
    integer :: mesh_orders = 3                   !< up to which orders are told
    logical :: waterfall = .false.               !< orders at all speeds are wanted
  contains
    procedure, nopass :: describe
    procedure :: read_keys, check_gears, take_files, count_points, run, add_report
  end type as_built_task_t

  character(*), parameter :: group = 'as_built'

contains

  pure subroutine describe(info)
    type(task_info_t), intent(out) :: info

    info = task_info_t(group, needs=[stage%elasticity, stage%mesh, stage%reliefs, stage%amounts, stage%motion, stage%losses, &
                                     stage%accuracy, stage%speeds], &
                       tables='as_built as_built_summary as_built_worst as_built_loads as_built_turn as_built_orders '// &
                       'as_built_waterfall '// &
                       'tolerances', &
                       fields='', &
                       gives='dynamic factor of gears whose teeth have errors of their own, over whole turns: worst assembly, '// &
                       'load of each pair of teeth, orders of the transmission error')
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
                    max_size=100, distinct=.true., otherwise='that of the largest dynamic factor, of each relief', &
                    meaning='speeds of the pinion at which the motion is followed over the turn')
    call reader%get(group, 'mesh_orders', self%mesh_orders, error, tasks=group, at_least=1, at_most=20, &
                    meaning='mesh orders up to which orders of the transmission error are told')
    call reader%get(group, 'waterfall', self%waterfall, error, tasks=group, &
                    meaning='whether these orders are told at all speeds, for the first relief')
    call read_deviations(reader, self%deviations, error)
    allocate (self%files(count([(allocated(self%deviations%files(i)%name), i=1, 2)])))
    k = 0
    do i = 1, 2
      if (.not. allocated(self%deviations%files(i)%name)) cycle
      k = k + 1
      self%files(k)%name = self%deviations%files(i)%name
    end do
  end subroutine read_keys

  subroutine check_gears(self, spec, error)
    class(as_built_task_t), intent(in) :: self
    type(gear_spec_t), intent(in) :: spec(2)
    type(error_t), allocatable, intent(inout) :: error

    call check_deviations(self%deviations, spec, error)
  end subroutine check_gears

  !> The files of measured flanks, in the order of `read_keys`.
  subroutine take_files(self, stages, error)
    class(as_built_task_t), intent(inout) :: self
    type(stages_t), intent(in) :: stages         !< with the gears
    type(error_t), allocatable, intent(inout) :: error
    type(flank_points_t) :: points
    integer :: i, k

    k = 0
    do i = 1, 2
      if (.not. allocated(self%deviations%files(i)%name)) cycle
      k = k + 1
      associate (file => self%files(k), choice => self%deviations%files(i), flanks => self%deviations%flanks(i))
        call read_flank_points(file%path, file%text, stages%pair%gear(i)%spec%teeth, choice%flank, points, error)
        if (.not. allocated(error)) call fit_flanks(file%path, points, stages%pair, i, flanks%measured, choice%rest, error)
      end associate
      if (allocated(error)) return
    end do
  end subroutine take_files

  !> Each point of the sweeps.
  integer function count_points(self, stages) result(points)
    class(as_built_task_t), intent(in) :: self
    type(stages_t), intent(in) :: stages
    real(dp), allocatable :: rpm(:)
    integer, allocatable :: which(:)

    call self%list_speeds(stages, rpm)
    call self%list_reliefs(stages, which)
    points = size(rpm)*size(which)*(1 + self%deviations%draws*assemblies_of(self%deviations, stages))
  end function count_points

  !> How many assemblies are taken.
  integer function assemblies_of(choice, stages) result(assemblies)
    type(deviations_choice_t), intent(in) :: choice
    type(stages_t), intent(in) :: stages
    integer :: x, y, rest

    assemblies = 1
    if (.not. choice%all_assemblies) return
    x = stages%motion(1)%mesh%teeth(1)
    y = stages%motion(1)%mesh%teeth(2)
    do while (y > 0)
      rest = modulo(x, y)
      x = y
      y = rest
    end do
    assemblies = x
  end function assemblies_of

  subroutine run(self, stages, error)
    class(as_built_task_t), intent(inout) :: self
    type(stages_t), intent(in) :: stages
    type(error_t), allocatable, intent(inout) :: error
    type(machine_t), allocatable :: machines(:, :)         ! (assembly, draw)
    type(turn_t), allocatable :: turns(:, :)               ! (speed, relief)
    type(curve_t), allocatable :: static(:)                ! (relief)
    type(turn_t), allocatable :: waterfall(:)              ! (speed)
    type(flank_deviations_t) :: flanks(2)
    type(random_stream_t) :: random(2)
    type(sweep_t) :: nominal
    type(frame_t) :: frame
    type(oscillator_t), allocatable :: osc(:), first(:)
    real(dp), allocatable :: rpm(:)
    integer, allocatable :: which(:)
    integer :: assemblies, draw, i

    call self%list_speeds(stages, rpm)
    call self%list_reliefs(stages, which)
    assemblies = assemblies_of(self%deviations, stages)
    call claim_memory(200.0_dp*size(rpm)*size(which)*assemblies*self%deviations%draws, &
                      '&deviations draws: '//str(self%deviations%draws)//' pairs of gears', error)
    if (allocated(error)) return
    if (allocated(stages%pair)) then
      frame = make_frame(stages%motion(1), stages%pair)
    else
      frame = make_frame(stages%motion(1))
    end if
    call sweep(stages, stages%motion(which), rpm, nominal, error)
    allocate (machines(assemblies, self%deviations%draws))
    random = [(begin_stream(2*self%deviations%seed + i), i=1, 2)]
    do draw = 1, self%deviations%draws
      flanks = self%deviations%flanks
      call draw_flanks(self%deviations, stages, random, flanks, error)
      do i = 1, assemblies
        if (allocated(error) .or. wants_stop(stages%accuracy%steady%stop)) exit
        associate (motion => stages%motion(which(1)))
          osc = deviating(stages%motion(which), &
                          lay_deviations(flanks, frame, motion%mesh%teeth, motion%mesh%contact_ratio, i - 1), error)
        end associate
        if (.not. allocated(first)) first = osc
        machines(i, draw)%flanks = flanks
        machines(i, draw)%turn = osc(1)%mesh%deviations%periods
        machines(i, draw)%offset = i - 1
        if (.not. allocated(error)) call sweep(stages, osc, rpm, machines(i, draw)%sweep, error)
        if (.not. allocated(error)) call find_worst(stages, osc, machines(i, draw), error)
      end do
    end do
    self%is_stopped = wants_stop(stages%accuracy%steady%stop)
    if (allocated(error)) return
    if (self%is_stopped) then
      self%log = 'as_built: interrupted'
      self%is_done = .true.
      return
    end if
    call follow(self, stages, first, rpm, machines(1, 1), turns, static, waterfall, error)
    if (allocated(error)) return
    associate (amount => stages%amount(which), teeth => stages%motion(1)%mesh%teeth)
      call fill_points(amount, nominal, machines, self%tables(self%place('as_built')), error)
      call fill_summary(amount, nominal, machines, self%tables(self%place('as_built_summary')), error)
      call fill_worst(teeth, amount, nominal, machines, self%tables(self%place('as_built_worst')), error)
      call fill_loads(stages, amount, turns, machines(1, 1), self%tables(self%place('as_built_loads')), error)
      call fill_turn(teeth, amount, turns, static, self%tables(self%place('as_built_turn')), error)
      call fill_orders(teeth, amount, turns, static, self%mesh_orders, self%tables(self%place('as_built_orders')), error)
      if (self%waterfall) call fill_waterfall(teeth, waterfall, self%mesh_orders, &
                                              self%tables(self%place('as_built_waterfall')), error)
    end associate
    if (any(self%deviations%class > 0)) &
      call fill_tolerances(stages%pair, self%deviations%class, self%tables(self%place('tolerances')), error)
    self%is_done = .true.
    self%failed = sum([((count(.not. has_result(machines(i, draw)%sweep%status)), i=1, assemblies), draw=1, size(machines, 2))])
    self%log = 'as_built: '//str(size(rpm)*size(which)*size(machines))//' operating points over '// &
               str(first(1)%mesh%deviations%periods)//' mesh periods each'
    do i = 1, 2
      if (allocated(self%deviations%files(i)%name)) self%log = self%log//'; the polynomials leave '// &
        str(1e6_dp*self%deviations%files(i)%rest, 3)//' um (root mean square) of '//trim(members(i))//'_flanks_file'
    end do
  end subroutine run

  !> The oscillators with these deviations.
  function deviating(motion, deviations, error) result(osc)
    type(oscillator_t), intent(in) :: motion(:)  ! (relief)
    type(deviations_t), intent(in) :: deviations
    type(error_t), allocatable, intent(inout) :: error
    type(oscillator_t) :: osc(size(motion))
    type(error_t), allocatable :: refused
    integer :: i

    osc = motion
    do i = 1, size(osc)
      osc(i)%mesh%deviations = deviations
      osc(i)%by_load = .false.
      call make_oscillator(osc(i), refused)
      if (allocated(refused)) call fail(error, refused%code, refused%message)
    end do
  end function deviating

  !> All speeds and reliefs, each point by itself.
  subroutine sweep(stages, osc, rpm, found, error)
    type(stages_t), intent(in) :: stages
    type(oscillator_t), intent(in) :: osc(:)     ! (relief)
    real(dp), intent(in) :: rpm(:)
    type(sweep_t), intent(out) :: found
    type(error_t), allocatable, intent(inout) :: error
    type(sweep_options_t) :: options

    if (allocated(error)) return
    options = stages%sweep_options()
    options%direction = each
    if (associated(stages%running%progress)) then
      call run_sweep(osc, rpm, options, found, error, stages%running%progress)
    else
      call run_sweep(osc, rpm, options, found, error)
    end if
    stages%running%done = stages%running%done + size(rpm)*size(osc)
  end subroutine sweep

  !> Draws the flanks of the gears that have a class.
  subroutine draw_flanks(choice, stages, random, flanks, error)
    type(deviations_choice_t), intent(in) :: choice
    type(stages_t), intent(in) :: stages
    type(random_stream_t), intent(inout) :: random(2)      ! of pinion and gear, behind those drawn before
    type(flank_deviations_t), intent(inout) :: flanks(2)
    type(error_t), allocatable, intent(inout) :: error
    type(error_t), allocatable :: outside
    type(tolerances_t) :: tolerances
    integer :: i

    do i = 1, 2
      if (choice%class(i) == 0) cycle
      associate (spec => stages%pair%gear(i)%spec)
        call find_tolerances(choice%class(i), spec%teeth, 1e3_dp*spec%module, 1e3_dp*spec%face_width, tolerances, outside)
        if (allocated(outside)) call fail(error, outside%code, outside%message)
        call draw_deviations(tolerances, spec%teeth, random(i), flanks(i))
      end associate
    end do
  end subroutine draw_flanks

  !> Which teeth carry the largest load of each relief, and where on their path.
  subroutine find_worst(stages, osc, machine, error)
    type(stages_t), intent(in) :: stages
    type(oscillator_t), intent(in) :: osc(:)     ! (relief)
    type(machine_t), intent(inout) :: machine
    type(error_t), allocatable, intent(inout) :: error
    type(turn_t) :: turn
    integer :: i, k

    allocate (machine%worst(size(osc)))
    do i = 1, size(osc)
      associate (factor => machine%sweep%dynamic_factor(:, i), found => has_result(machine%sweep%status(:, i)))
        if (.not. any(found)) cycle
        k = maxloc(factor, 1, mask=found)
        call find_one(osc(i), machine%sweep%rpm(k), stages, turn, error)
        if (allocated(error)) return
        machine%worst(i) = tooth_t(machine%sweep%rpm(k), factor(k))
        if (.not. allocated(turn%load)) cycle
        machine%worst(i)%pair = maxloc(turn%load, 1) - 1
        machine%worst(i)%place = turn%place(machine%worst(i)%pair + 1)
      end associate
    end do
  end subroutine find_worst

  subroutine find_one(osc, rpm, stages, turn, error)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm
    type(stages_t), intent(in) :: stages
    type(turn_t), intent(out) :: turn
    type(error_t), allocatable, intent(inout) :: error
    type(levels_t), allocatable :: levels

    allocate (levels)
    if (allocated(stages%pair)) then
      call find_turn(osc, rpm, stages%accuracy, levels, turn, unit_root_stress(stages%pair))
    else
      call find_turn(osc, rpm, stages%accuracy, levels, turn)
    end if
    if (turn%lacks) call fail(error, code_memory, 'as_built at '//str(rpm)//' 1/min: the memory does not hold the motion')
  end subroutine find_one

  !> Nominal root stress of pinion and gear under a unit load that acts from A to E (Pa/N); (gear, place)
  pure function unit_root_stress(pair) result(stress)
    type(pair_t), intent(in) :: pair
    integer, parameter :: places = 101
    real(dp) :: stress(2, places)
    integer :: i, k

    do k = 1, places
      do i = 1, 2
        associate (radius => pair%radius(i, pair%contact_ratio*(k - 1)/(places - 1)))
          stress(i, k) = nominal_root_stress(pair, i, iso_form(pair%gear(i), radius), 1.0_dp)
        end associate
      end do
    end do
  end function unit_root_stress

  !> The motions of the first gears and assembly over the turn.
  subroutine follow(self, stages, osc, rpm, machine, turns, static, waterfall, error)
    class(as_built_task_t), intent(in) :: self
    type(stages_t), intent(in) :: stages
    type(oscillator_t), intent(in) :: osc(:)     ! (relief)
    real(dp), intent(in) :: rpm(:)
    type(machine_t), intent(in) :: machine
    type(turn_t), allocatable, intent(out) :: turns(:, :), waterfall(:)
    type(curve_t), allocatable, intent(out) :: static(:)
    type(error_t), allocatable, intent(inout) :: error
    integer :: i, k, n

    n = 1
    if (allocated(self%turn_rpm)) n = size(self%turn_rpm)
    allocate (turns(n, size(osc)), static(size(osc)), waterfall(merge(size(rpm), 0, self%waterfall)))
    do i = 1, size(osc)
      call find_static_turn(osc(i), static(i))
      do k = 1, n
        if (allocated(self%turn_rpm)) then
          call find_one(osc(i), self%turn_rpm(k), stages, turns(k, i), error)
        else if (machine%worst(i)%rpm > 0) then
          call find_one(osc(i), machine%worst(i)%rpm, stages, turns(k, i), error)
        end if
        if (allocated(error)) return
      end do
    end do
    do k = 1, size(waterfall)
      call find_one(osc(1), rpm(k), stages, waterfall(k), error)
      if (allocated(error)) return
    end do
  end subroutine follow

  pure subroutine add_report(self, lines)
    class(as_built_task_t), intent(in) :: self
    type(lines_t), intent(inout) :: lines
    integer :: machines, row

    if (.not. self%tables(self%place('as_built_summary'))%is_there()) return
    call lines%add('')
    associate (summary => self%tables(self%place('as_built_summary')), worst => self%tables(self%place('as_built_worst')))
      machines = worst%extent(2)*worst%extent(3)
      if (machines > 1) then
        call lines%add('Gears as built: largest dynamic factor over the speeds; pairs of gears: '//str(worst%extent(2))// &
                       ', assemblies: '//str(worst%extent(3)))
        call lines%add('   relief um   nominal     least    median      95 %   largest      at rpm')
      else
        call lines%add('Gears as built: largest dynamic factor over the speeds')
        call lines%add('   relief um   nominal  as built      at rpm   pinion tooth   gear tooth')
      end if
      do row = 1, summary%rows
        call lines%put(right(str(summary%number('relief_um', row)), 12)//factor_in(summary%number('nominal_factor', row)))
        if (machines > 1) then
          call lines%add(factor_in(summary%number('least_factor', row))//factor_in(summary%number('median_factor', row))// &
                         factor_in(summary%number('quantile_95_factor', row))// &
                         factor_in(summary%number('largest_factor', row))//right(str(summary%number('rpm', row)), 12))
        else
          call lines%add(factor_in(worst%number('dynamic_factor', row))//right(str(worst%number('rpm', row)), 12)// &
                         right(str(worst%number('pinion_tooth', row)), 15)//right(str(worst%number('gear_tooth', row)), 13))
        end if
      end do
    end associate
  end subroutine add_report
end module gearsweep_task_as_built
