!> The pairs of gears that the task `as_built` computes: drawn, put together and swept over the speeds.
module gearsweep_as_built_machines
  use gearsweep_deviation_keys, only: deviations_choice_t
  use gearsweep_deviations, only: deviations_t
  use gearsweep_error, only: code_memory, error_t, fail
  use gearsweep_flank_deviations, only: draw_deviations, flank_deviations_t, frame_t, lay_deviations, make_frame
  use gearsweep_kinds, only: dp
  use gearsweep_oscillator, only: make_oscillator, oscillator_t
  use gearsweep_pair, only: pair_t
  use gearsweep_random_stream, only: begin_stream, random_stream_t
  use gearsweep_refinement, only: levels_t
  use gearsweep_root_life, only: root_history
  use gearsweep_stages, only: stages_t
  use gearsweep_status, only: has_result
  use gearsweep_sweep, only: each, run_sweep, sweep_options_t, sweep_t
  use gearsweep_text, only: str
  use gearsweep_tolerances, only: find_tolerances, tolerances_t
  use gearsweep_turn, only: find_turn, turn_t
  implicit none
  private
  public :: machine_t, tooth_t, draw_machines, run_exactly, deviating, sweep_each, follow_turn, unit_root_stress

  !> Where a largest load is.
  type :: tooth_t
    real(dp) :: rpm = 0                          !< 0: there is none
    real(dp) :: dynamic_factor = 0
    integer :: pair = -1                         !< number of the pair, from 0; -1: not known
    real(dp) :: place = 0                        !< path coordinate, base pitches
    !> Largest nominal root stress over that turn, where it was asked for, Pa; (gear)
    real(dp), allocatable :: stress(:)
  end type tooth_t

  !> Two gears, put together with certain teeth meeting.
  type :: machine_t
    type(flank_deviations_t) :: flanks(2)
    type(deviations_t) :: deviations             !< that follow
    integer :: offset = 0                        !< by how many teeth of the gear the assembly is not the stated one
    type(sweep_t) :: sweep
    type(tooth_t), allocatable :: worst(:)       !< (relief)
  end type machine_t

contains

  !> All pairs of gears: (assembly, draw).
  subroutine draw_machines(choice, stages, assemblies, machines, error)
    type(deviations_choice_t), intent(in) :: choice
    type(stages_t), intent(in) :: stages
    integer, intent(in) :: assemblies
    type(machine_t), allocatable, intent(out) :: machines(:, :)
    type(error_t), allocatable, intent(inout) :: error
    type(flank_deviations_t) :: flanks(2)
    type(random_stream_t) :: random(2)
    type(frame_t) :: frame
    integer :: draw, i

    if (allocated(stages%pair)) then
      frame = make_frame(stages%motion(1), stages%pair)
    else
      frame = make_frame(stages%motion(1))
    end if
    allocate (machines(assemblies, choice%draws))
    random = [(begin_stream(2*choice%seed + i), i=1, 2)]
    do draw = 1, choice%draws
      flanks = choice%flanks
      call draw_flanks(choice, stages, random, flanks, error)
      do i = 1, assemblies
        associate (mesh => stages%motion(1)%mesh, machine => machines(i, draw))
          machine%flanks = flanks
          machine%offset = i - 1
          machine%deviations = lay_deviations(flanks, frame, mesh%teeth, mesh%contact_ratio, i - 1)
        end associate
      end do
    end do
  end subroutine draw_machines

  !> All speeds and reliefs of a pair of gears, each to the tolerance, and its worst teeth.
  subroutine run_exactly(stages, which, rpm, machine, error, unit_stress)
    type(stages_t), intent(in) :: stages
    integer, intent(in) :: which(:)              !< reliefs of the case
    real(dp), intent(in) :: rpm(:)               !< speeds of the pinion, 1/min
    type(machine_t), intent(inout) :: machine
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable, intent(in) :: unit_stress(:, :)   !< of `unit_root_stress`; not allocated: no stress is wanted
    type(oscillator_t) :: osc(size(which))       ! (relief)

    osc = deviating(stages%motion(which), machine%deviations, error)
    call sweep_each(stages, osc, rpm, machine%sweep, error)
    if (.not. allocated(error)) call find_worst(stages, osc, machine, error, unit_stress)
  end subroutine run_exactly

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
  subroutine sweep_each(stages, osc, rpm, found, error)
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
  end subroutine sweep_each

  !> Which teeth carry the largest load of each relief, and where on their path.
  subroutine find_worst(stages, osc, machine, error, unit_stress)
    type(stages_t), intent(in) :: stages
    type(oscillator_t), intent(in) :: osc(:)     ! (relief)
    type(machine_t), intent(inout) :: machine
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable, intent(in) :: unit_stress(:, :)
    type(turn_t) :: turn
    integer :: i, k

    allocate (machine%worst(size(osc)))
    do i = 1, size(osc)
      associate (factor => machine%sweep%dynamic_factor(:, i), found => has_result(machine%sweep%status(:, i)))
        if (.not. any(found)) cycle
        k = maxloc(factor, 1, mask=found)
        call follow_turn(osc(i), machine%sweep%rpm(k), stages, turn, error, unit_stress)
        if (allocated(error)) return
        machine%worst(i) = tooth_t(machine%sweep%rpm(k), factor(k))
        if (.not. allocated(turn%load)) cycle
        machine%worst(i)%pair = maxloc(turn%load, 1) - 1
        machine%worst(i)%place = turn%place(machine%worst(i)%pair + 1)
        if (allocated(turn%stress)) machine%worst(i)%stress = maxval(turn%stress, 2)
      end associate
    end do
  end subroutine find_worst

  !> The motion of one oscillator over the turn.
  subroutine follow_turn(osc, rpm, stages, turn, error, unit_stress)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm                  !< speed of the pinion, 1/min
    type(stages_t), intent(in) :: stages
    type(turn_t), intent(out) :: turn
    type(error_t), allocatable, intent(inout) :: error
    real(dp), intent(in), optional :: unit_stress(:, :)    !< of `unit_root_stress`; without it, there is no stress
    type(levels_t), allocatable :: levels

    allocate (levels)
    call find_turn(osc, rpm, stages%accuracy, levels, turn, unit_stress)
    if (turn%lacks) call fail(error, code_memory, 'as_built at '//str(rpm)//' 1/min: the memory does not hold the motion')
  end subroutine follow_turn

  !> Nominal root stress of pinion and gear under a unit load that acts from A to E (Pa/N); (gear, place).
  pure function unit_root_stress(pair) result(stress)
    type(pair_t), intent(in) :: pair
    integer, parameter :: places = 101
    real(dp), parameter :: solid = 0             ! thickness of a rim
    real(dp) :: stress(2, places)
    integer :: i, k

    do i = 1, 2
      stress(i, :) = root_history(pair, i, pair%contact_ratio*[(k, k=0, places - 1)]/(places - 1), &
                                  spread(1.0_dp, 1, places), solid)
    end do
  end function unit_root_stress
end module gearsweep_as_built_machines
