!> Many operating points: speeds times reliefs, in parallel. The work is split
!> the same way for any number of threads, so that the results have the same bits.
module gearsweep_sweep
  use gearsweep_kinds, only: dp
  use, intrinsic :: iso_c_binding, only: c_ptr
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  use gearsweep_error, only: error_t, fail, code_memory
  use gearsweep_error_estimate, only: point_t
  use gearsweep_oscillator, only: oscillator_t
  use gearsweep_periodic_orbit, only: steady_t
  use gearsweep_refinement, only: forget_levels, levels_t
  use gearsweep_relief_family, only: relief_family_t, find_family
  use gearsweep_status, only: has_result, status_stopped
  use gearsweep_sweep_state, only: begin_state, both, counter_t, down, each, find_final, fits, most_points, &
                                   progress_of_sweep, sweep_options_t, sweep_state_t, units_done, up
  use gearsweep_sweep_work, only: continue_sweep, return_from_above, solve_block, solve_family_block
  use gearsweep_memory, only: claim_memory, release_claim, team
  use gearsweep_text, only: str
  use gearsweep_traps, only: leader_traps, share_traps
  implicit none
  private
  public :: sweep_t, sweep_options_t, sweep_state_t, run_sweep, progress_of_sweep, contact_name, contact_of, each, up, down, both

  !> Results; NaN where there is none. First index speed, second relief.
  type :: sweep_t
    real(dp), allocatable :: rpm(:)
    real(dp), allocatable :: dynamic_factor(:, :)
    real(dp), allocatable :: estimate(:, :)      !< error of the dynamic factor
    real(dp), allocatable :: dte_rms(:, :)       !< of what the transmission error differs from its mean, m
    real(dp), allocatable :: dte_range(:, :)     !< largest less least transmission error, m
    real(dp), allocatable :: dte_estimate(:, :)  !< of the errors of both, m
    real(dp), allocatable :: coast_factor(:, :)  !< largest load on the coast sides over the static load
    real(dp), allocatable :: multiplier(:, :)    !< largest Floquet modulus
    real(dp), allocatable :: mesh_multiplier(:, :)         !< its mean over the mesh periods
    real(dp), allocatable :: residual(:, :)      !< of periodicity, in static deflections
    integer, allocatable :: status(:, :)         !< status_ok ... of gearsweep_status
    integer, allocatable :: contact(:, :)        !< contact_full ... below
    integer, allocatable :: steps(:, :)          !< of a period
    integer, allocatable :: periods(:, :)        !< mesh periods until the motion repeats
    !> Up or down: the motion at the speed before led to none, and this one was found without it.
    logical, allocatable :: branch_lost(:, :)
    !> With `both`: the direction that led to the motion, 1 up, -1 down, 0 both, and what the other led to.
    integer, allocatable :: direction(:, :)
    integer, allocatable :: other_status(:, :)
    real(dp), allocatable :: other_factor(:, :)  !< dynamic factor, the same or smaller; NaN where it has none
  end type sweep_t

  integer, parameter, public :: contact_full = 0, contact_partial = 1, contact_lost = 2, contact_coast = 3

contains

  !> Dynamic factors over speeds and reliefs. A point that fails is marked and does not end the sweep. Where the caller
  !> ends it, the points that are left have the status `stopped`.
  subroutine run_sweep(osc, rpm, options, sweep, error, progress, state)
    type(oscillator_t), intent(in) :: osc(:)                   !< one for each relief
    real(dp), intent(in) :: rpm(:)                             !< speeds of the pinion, ascending, 1/min
    type(sweep_options_t), intent(in) :: options
    type(sweep_t), intent(out) :: sweep
    type(error_t), allocatable, intent(out) :: error           !< too many points, or too little memory
    procedure(progress_of_sweep), optional :: progress
    type(sweep_state_t), intent(inout), optional :: state      !< with it, another call goes on from where this one was ended
    type(sweep_state_t) :: own
    logical :: begun

    begun = .false.
    if (present(state)) begun = fits(state, size(rpm), size(osc))
    call claim_points(size(rpm), size(osc), begun, error)
    if (allocated(error)) return
    call allocate_sweep(rpm, size(osc), sweep)
    if (present(state)) then
      call go_through(osc, rpm, options, sweep, state, error, progress)
    else
      call go_through(osc, rpm, options, sweep, own, error, progress)
    end if
  end subroutine run_sweep

  !> The work, by all threads.
  subroutine go_through(osc, rpm, options, sweep, state, error, progress)
    type(oscillator_t), intent(in) :: osc(:)
    real(dp), intent(in) :: rpm(:)
    type(sweep_options_t), intent(in) :: options
    type(sweep_t), intent(inout) :: sweep
    type(sweep_state_t), intent(inout) :: state
    type(error_t), allocatable, intent(inout) :: error
    procedure(progress_of_sweep), optional :: progress
    type(levels_t), allocatable :: levels
    type(counter_t) :: counter
    type(relief_family_t) :: family
    integer, allocatable :: missing(:)              ! blocks of each relief
    integer :: i, relief, left
    type(c_ptr) :: traps
    logical :: lacks

    if (.not. fits(state, size(rpm), size(osc))) call begin_state(size(rpm), size(osc), state)
    counter = counter_t(units_done(state, options%direction), merge(3, 2, options%direction == both), options%done_before, &
                        options%all_points)
    if (options%is_counted) counter%watch = options%accuracy%steady%stop
    if (counter%total == 0) counter%total = size(sweep%status)
    if (options%is_counted .and. present(progress)) counter%progress => progress
    missing = [(count(state%blocks%relief == i), i=1, size(osc))]
    if (size(rpm) > 1 .or. options%full_contact_only) call find_family(osc, options%accuracy, family)
    call release_claim()
    lacks = .false.
    traps = leader_traps()
    !$omp parallel default(none) shared(osc, rpm, options, sweep, state, family, missing, counter, lacks, traps) &
    !$omp private(levels, relief, left) num_threads(team(options%threads, size(state%blocks)))
    call share_traps(traps, 1)
    if (family%reference > 0) then
      call forget_levels(levels)
      !$omp do schedule(dynamic, 1)
      do i = 1, size(state%blocks)
        ! All reliefs have the same blocks.
        if (state%blocks(i)%relief /= 1) cycle
        call solve_family_block(osc(family%reference), family%part, rpm, options, state%blocks(i), &
                                counter, levels, state%points, state%solved)
      end do
      !$omp end do
    end if
    relief = 0
    !$omp do schedule(dynamic, 1)
    do i = 1, merge(0, size(state%blocks), options%full_contact_only)
      if (state%blocks(i)%relief /= relief) call forget_levels(levels)
      relief = state%blocks(i)%relief
      call solve_block(osc(relief), rpm, options, state%blocks(i), counter, levels, state%points(:, relief), &
                       state%solved(:, relief))
      !$omp atomic capture seq_cst
      missing(relief) = missing(relief) - 1
      left = missing(relief)
      !$omp end atomic
      ! Who solves the last block of a relief goes on with it, while others work.
      if (left == 0) call finish_relief(osc(relief), rpm, options, relief, counter, levels, state, sweep)
    end do
    !$omp end do
    if (allocated(levels)) then
      !$omp critical (gearsweep_lack)
      lacks = lacks .or. levels%lacks
      !$omp end critical (gearsweep_lack)
    end if
    call release_claim()
    call share_traps(traps, 0)
    !$omp end parallel
    if (options%full_contact_only) then
      do i = 1, size(osc)
        call store(osc(i)%load, state%points(:, i), state%solved(:, i), i, sweep)
      end do
    end if
    if (lacks) call fail(error, code_memory, 'sweep: the memory does not hold the steps of a mesh period at some speeds; '// &
                         'fewer threads or a larger tolerance need less')
  end subroutine go_through

  !> Follows the branch of a relief whose blocks are solved, up, down or both, and hands its points out.
  subroutine finish_relief(osc, rpm, options, relief, counter, levels, state, sweep)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm(:)
    type(sweep_options_t), intent(in) :: options
    integer, intent(in) :: relief
    type(counter_t), intent(inout) :: counter
    type(levels_t), intent(inout) :: levels
    type(sweep_state_t), intent(inout) :: state
    type(sweep_t), intent(inout) :: sweep
    logical, allocatable :: final(:)

    if (options%direction /= each .and. all(state%blocks%grouped == state%blocks%last .or. state%blocks%relief /= relief)) &
      call continue_sweep(osc, rpm, options, relief, counter, levels, state)
    if (options%direction == both .and. state%followed(relief) == size(rpm)) &
      call return_from_above(osc, rpm, options, relief, counter, levels, state)
    call find_final(state, options%direction, relief, final)
    call store(osc%load, state%points(:, relief), final, relief, sweep)
  end subroutine finish_relief

  !> Refuses more points than anyone reads, or than the memory holds.
  subroutine claim_points(speeds, reliefs, begun, error)
    integer, intent(in) :: speeds, reliefs
    logical, intent(in) :: begun                 !< the points themselves are there
    type(error_t), allocatable, intent(out) :: error
    type(point_t) :: point
    real(dp) :: points

    points = real(speeds, dp)*reliefs
    if (points > most_points) call fail(error, code_memory, 'sweep: '//str(speeds)//' speeds times '//str(reliefs)// &
                                        ' reliefs are too many points; at most '//str(most_points))
    ! Results and work, copies of one relief's points as they are stored, and the blocks.
    call claim_memory((points + 2*speeds)*(100 + storage_size(point)/8) - merge(points*storage_size(point)/8, 0.0_dp, begun), &
                      'sweep: '//str(speeds)//' speeds times '//str(reliefs)//' reliefs', error)
  end subroutine claim_points

  subroutine allocate_sweep(rpm, reliefs, sweep)
    real(dp), intent(in) :: rpm(:)
    integer, intent(in) :: reliefs
    type(sweep_t), intent(out) :: sweep
    integer :: n

    n = size(rpm)
    allocate (sweep%dynamic_factor(n, reliefs), sweep%estimate(n, reliefs), sweep%multiplier(n, reliefs), &
              sweep%coast_factor(n, reliefs), sweep%mesh_multiplier(n, reliefs), &
              sweep%dte_rms(n, reliefs), sweep%dte_range(n, reliefs), sweep%dte_estimate(n, reliefs), &
              sweep%residual(n, reliefs), sweep%status(n, reliefs), sweep%contact(n, reliefs), &
              sweep%steps(n, reliefs), sweep%periods(n, reliefs), sweep%branch_lost(n, reliefs), &
              sweep%direction(n, reliefs), sweep%other_status(n, reliefs), sweep%other_factor(n, reliefs))
    sweep%rpm = rpm
  end subroutine allocate_sweep

  !> What is not final has no result, and nothing is known of it.
  subroutine store(load, points, final, relief, sweep)
    real(dp), intent(in) :: load                 ! static, N
    type(point_t), intent(in) :: points(:)
    logical, intent(in) :: final(:)
    integer, intent(in) :: relief
    type(sweep_t), intent(inout) :: sweep
    real(dp) :: none
    logical, allocatable :: found(:)

    none = ieee_value(1.0_dp, ieee_quiet_nan)
    found = final .and. has_result(points%steady%status)
    associate (steady => points%steady)
      sweep%dynamic_factor(:, relief) = merge(points%dynamic_factor, none, found)
      sweep%estimate(:, relief) = merge(points%estimate, none, found)
      sweep%dte_rms(:, relief) = merge(steady%dte_rms, none, found)
      sweep%dte_range(:, relief) = merge(steady%dte_range, none, found)
      sweep%dte_estimate(:, relief) = merge(points%dte_estimate, none, found)
      sweep%coast_factor(:, relief) = merge(steady%coast_peak/load, none, found)
      ! Of a motion without a result it is known where it repels, and of a chaotic one.
      sweep%multiplier(:, relief) = merge(steady%multiplier, none, found .or. (final .and. steady%multiplier > 0))
      sweep%mesh_multiplier(:, relief) = merge(steady%mesh_multiplier, none, found .or. (final .and. steady%mesh_multiplier > 0))
      sweep%residual(:, relief) = merge(steady%residual, none, final)
      sweep%status(:, relief) = merge(steady%status, status_stopped, final)
      sweep%steps(:, relief) = merge(points%steps, 0, final)
      sweep%periods(:, relief) = merge(steady%periods, 0, final)
      sweep%branch_lost(:, relief) = final .and. points%branch_lost
      sweep%contact(:, relief) = merge(contact_of(steady), contact_full, final)
    end associate
    sweep%direction(:, relief) = merge(points%direction, 0, final)
    sweep%other_status(:, relief) = sweep%status(:, relief)
    sweep%other_factor(:, relief) = sweep%dynamic_factor(:, relief)
    where (sweep%direction(:, relief) /= 0)
      sweep%other_status(:, relief) = points%other_status
      sweep%other_factor(:, relief) = merge(points%other_factor, none, has_result(points%other_status))
    end where
  end subroutine store

  !> What contact there was over the period: contact_full ... of this module.
  elemental integer function contact_of(steady) result(contact)
    type(steady_t), intent(in) :: steady

    contact = contact_full
    if (steady%partial) contact = contact_partial
    if (steady%lost) contact = contact_lost
    if (steady%coast) contact = contact_coast
  end function contact_of

  !> The word that stands for one of contact_full ... in tables.
  elemental function contact_name(contact) result(name)
    integer, intent(in) :: contact
    character(7) :: name
    character(7), parameter :: names(0:3) = [character(7) :: 'full', 'partial', 'lost', 'coast']

    name = names(contact)
  end function contact_name
end module gearsweep_sweep
