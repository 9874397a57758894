!> Many operating points: speeds times reliefs, in parallel.
!>
!> Blocks of speeds are solved in batches, then the branch through all speeds of a relief is followed. The work is divided in the
!> same way for any number of threads, so that the results have the same bits. It stops at the caller's request.
module gearsweep_motion_sweep
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan, ieee_quiet_nan, ieee_value
  use, intrinsic :: iso_c_binding, only: c_associated, c_f_pointer, c_int, c_null_ptr, c_ptr
  use, intrinsic :: iso_fortran_env, only: int64
  use gearsweep_base, only: claim_memory, code_memory, dp, error_t, fail, leader_traps, release_claim, share_traps, str, team, &
    wants_stop
  use gearsweep_motion_attractors, only: take_largest
  use gearsweep_motion_resolution, only: scheme_collocation
  use gearsweep_motion_contact_set, only: range_of, rms_of
  use gearsweep_motion_continuation, only: carried, continue_to
  use gearsweep_motion_error_estimate, only: forget_levels, levels_t
  use gearsweep_motion_gauss, only: batch_size
  use gearsweep_motion_operating_point, only: solve_batch, solve_point
  use gearsweep_motion_oscillator, only: mesh_period, oscillator_t
  use gearsweep_motion_periodic_orbit, only: distance
  use gearsweep_motion_steady_motion, only: accuracy_t, by_shooting, has_result, point_t, seen_t, status_stopped, &
    status_unbounded, status_unresolved, steady_t
  implicit none
  private
  public :: sweep_t, sweep_options_t, counter_t, progress_of_sweep, run_sweep, contact_name, contact_of

  !> Directions of a sweep: each point by itself, or continued from the point before, upwards or downwards.
  integer, parameter, public :: each = 0, up = 1, down = -1
  !> Upwards and, where contact was lost, downwards as well; of the two motions at a speed, the one of larger dynamic factor.
  integer, parameter, public :: both = 3
  !> Direction of a case, in addition to these: each point by itself, and all attracting motions at it.
  integer, parameter, public :: all_motions = 2

  !> Largest number of points: 1 GB of results.
  integer, parameter, public :: most_points = 10**7

  !> Value of `all_points` and `done_before` of a sweep whose progress is not reported.
  integer, parameter, public :: untold = -10**9

  type :: sweep_options_t
    type(accuracy_t) :: accuracy
    integer :: direction = both
    integer :: threads = 0                       !< number of threads; 0: all of the machine
    !> Selects with `each`, of several motions at a speed, the one of largest dynamic factor that a few starts reach.
    logical :: largest = .false.
    logical :: is_counted = .true.               !< its points are reported as done
    !> Progress: points of the call done before this sweep, and in total; 0: the points of this sweep.
    integer :: done_before = 0, all_points = 0
  end type sweep_options_t

  !> Block of speeds, first to last, of one relief.
  type :: block_t
    integer :: relief = 0, first = 1, last = 0
  end type block_t

  abstract interface
    !> Receives the number of finished points at intervals, from one thread at a time; it never falls.
    subroutine progress_of_sweep(done, total)
      integer, intent(in) :: done, total
    end subroutine progress_of_sweep
  end interface

  !> Counter of finished parts of points: the solution by itself, the sweep along the branch and, with both directions, the sweep
  !> down.
  type :: counter_t
    integer(int64) :: units = 0
    integer :: parts = 2                         !< parts of a point
    integer :: before = 0, total = 0
    procedure(progress_of_sweep), pointer, nopass :: progress => null()
    type(c_ptr) :: watch = c_null_ptr            !< three integers of the caller: stop, done, total
  contains
    procedure :: tick, tell
  end type counter_t

  !> Results; NaN where there is none. First index speed, second relief.
  type :: sweep_t
    real(dp), allocatable :: rpm(:)
    real(dp), allocatable :: dynamic_factor(:, :)
    real(dp), allocatable :: estimate(:, :)      !< error of the dynamic factor
    real(dp), allocatable :: dte_rms(:, :)       !< root mean square deviation of the transmission error, m
    real(dp), allocatable :: dte_range(:, :)     !< largest minus least transmission error, m
    real(dp), allocatable :: dte_estimate(:, :)  !< estimate of the errors of both, m
    !> Observations of a motion that does not repeat, over the mesh periods observed: the largest load on a pair over the static
    !> load, and root mean square and range of the transmission error, m. NaN where every motion found repeats.
    real(dp), allocatable :: seen_factor(:, :), seen_dte_rms(:, :), seen_dte_range(:, :)
    integer, allocatable :: seen_periods(:, :)   !< number of those periods; 0: none
    real(dp), allocatable :: coast_factor(:, :)  !< largest load on the coast sides over the static load
    real(dp), allocatable :: multiplier(:, :)    !< largest Floquet modulus
    real(dp), allocatable :: mesh_multiplier(:, :)         !< mean of `multiplier` over the mesh periods
    real(dp), allocatable :: residual(:, :)      !< residual of periodicity, in static deflections
    integer, allocatable :: status(:, :)         !< status_ok ... of gearsweep_motion_steady_motion
    integer, allocatable :: contact(:, :)        !< contact_full ... below
    integer, allocatable :: steps(:, :)          !< number of steps of a period
    real(dp), allocatable :: state(:, :, :)      !< state of the motion at the start of the mesh period, m; (2, speed, relief)
    integer, allocatable :: motions(:, :)        !< number of attracting motions found; 0: no search
    integer, allocatable :: periods(:, :)        !< mesh periods until the motion repeats
    !> True in a sweep up or down: the motion at the previous speed led to none, and this one was found without it.
    logical, allocatable :: branch_lost(:, :)
    !> Direction that led to the motion with `both`, 1 up, -1 down, 0 both, and the result of the other direction.
    integer, allocatable :: direction(:, :)
    integer, allocatable :: other_status(:, :)
    real(dp), allocatable :: other_factor(:, :)  !< dynamic factor, the same or smaller; NaN where it has none
    real(dp), allocatable :: other_dte_rms(:, :)  !< root mean square of the transmission error, m; NaN where it has none
  end type sweep_t

  integer, parameter, public :: contact_full = 0, contact_partial = 1, contact_lost = 2, contact_coast = 3

contains

  !> Computes dynamic factors over speeds and reliefs by all threads. A point that fails is marked and does not end the sweep. If
  !> the caller stops it, the remaining points have the status `stopped`.
  subroutine run_sweep(osc, rpm, options, sweep, error, progress)
    type(oscillator_t), intent(in) :: osc(:)                   !< one for each relief
    real(dp), intent(in) :: rpm(:)                             !< speeds of the pinion, ascending, 1/min
    type(sweep_options_t), intent(in) :: options
    type(sweep_t), intent(out) :: sweep
    type(error_t), allocatable, intent(out) :: error           !< too many points, or too little memory
    procedure(progress_of_sweep), optional :: progress
    type(block_t), allocatable :: blocks(:)
    type(point_t), allocatable :: points(:, :)      ! (speed, relief)
    logical, allocatable :: solved(:, :)            ! solved without the neighbouring speeds; (speed, relief)
    type(levels_t), allocatable :: levels
    type(counter_t) :: counter
    integer, allocatable :: missing(:)              ! number of unfinished blocks; (relief)
    integer :: i, relief, left
    type(c_ptr) :: traps
    logical :: lacks

    call claim_points(size(rpm), size(osc), error)
    if (allocated(error)) return
    call allocate_sweep(rpm, size(osc), sweep)
    blocks = make_blocks(size(rpm), size(osc))
    allocate (points(size(rpm), size(osc)))
    allocate (solved(size(rpm), size(osc)), source=.false.)
    counter = counter_t(parts=merge(3, 2, options%direction == both), before=options%done_before, total=options%all_points)
    if (options%is_counted) counter%watch = options%accuracy%steady%stop
    if (counter%total == 0) counter%total = size(sweep%status)
    if (options%is_counted .and. present(progress)) counter%progress => progress
    missing = [(count(blocks%relief == i), i=1, size(osc))]
    call release_claim()
    lacks = .false.
    traps = leader_traps()
    !$omp parallel default(none) shared(osc, rpm, options, sweep, blocks, points, solved, missing, counter, lacks, traps) &
    !$omp private(levels, relief, left) num_threads(team(options%threads, size(blocks)))
    call share_traps(traps, 1)
    relief = 0
    !$omp do schedule(dynamic, 1)
    do i = 1, size(blocks)
      if (blocks(i)%relief /= relief) call forget_levels(levels)
      relief = blocks(i)%relief
      call solve_block(osc(relief), rpm, options, blocks(i), counter, levels, points(:, relief), solved(:, relief))
      !$omp atomic capture seq_cst
      missing(relief) = missing(relief) - 1
      left = missing(relief)
      !$omp end atomic
      ! The thread that solves the last block of a relief continues with it, while others work.
      if (left == 0) &
        call finish_relief(osc(relief), rpm, options, counter, levels, points(:, relief), solved(:, relief), relief, sweep)
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
    if (lacks) call fail(error, code_memory, 'sweep: the memory does not hold the steps of a mesh period at some speeds; '// &
                         'fewer threads or a larger tolerance need less')
  end subroutine run_sweep

  !> Follows the branch of a relief whose blocks are solved, up, down or both, and stores its points.
  subroutine finish_relief(osc, rpm, options, counter, levels, points, solved, relief, sweep)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm(:)
    type(sweep_options_t), intent(in) :: options
    type(counter_t), intent(inout) :: counter
    type(levels_t), intent(inout) :: levels
    type(point_t), intent(inout) :: points(:)    ! (speed)
    logical, intent(in) :: solved(:)             ! solved without the neighbouring speeds; (speed)
    integer, intent(in) :: relief
    type(sweep_t), intent(inout) :: sweep
    logical, allocatable :: final(:)
    logical :: is_above

    final = solved
    if (options%direction /= each) call continue_sweep(osc, rpm, options, counter, levels, points, solved, final)
    if (options%direction == both) then
      is_above = all(final)
      final = .false.
      if (is_above) call return_from_above(osc, rpm, options, counter, levels, points, final)
    end if
    call store(osc%load, points, final, relief, sweep)
  end subroutine finish_relief

  !> Refuses too many points, by number or by memory.
  subroutine claim_points(speeds, reliefs, error)
    integer, intent(in) :: speeds, reliefs
    type(error_t), allocatable, intent(out) :: error
    type(point_t) :: point
    real(dp) :: points

    points = real(speeds, dp)*reliefs
    if (points > most_points) call fail(error, code_memory, 'sweep: '//str(speeds)//' speeds times '//str(reliefs)// &
                                        ' reliefs are too many points; at most '//str(most_points))
    ! Results and points, copies of one relief's points as they are stored, and the blocks.
    call claim_memory((points + 2*speeds)*(100 + storage_size(point)/8), &
                      'sweep: '//str(speeds)//' speeds times '//str(reliefs)//' reliefs', error)
  end subroutine claim_points

  subroutine allocate_sweep(rpm, reliefs, sweep)
    real(dp), intent(in) :: rpm(:)
    integer, intent(in) :: reliefs
    type(sweep_t), intent(out) :: sweep
    integer :: n

    n = size(rpm)
    allocate (sweep%dynamic_factor(n, reliefs), sweep%estimate(n, reliefs), sweep%multiplier(n, reliefs), &
              sweep%seen_factor(n, reliefs), sweep%seen_dte_rms(n, reliefs), sweep%seen_dte_range(n, reliefs), &
              sweep%seen_periods(n, reliefs), sweep%coast_factor(n, reliefs), sweep%mesh_multiplier(n, reliefs), &
              sweep%dte_rms(n, reliefs), sweep%dte_range(n, reliefs), sweep%dte_estimate(n, reliefs), &
              sweep%residual(n, reliefs), sweep%status(n, reliefs), sweep%contact(n, reliefs), &
              sweep%steps(n, reliefs), sweep%periods(n, reliefs), sweep%motions(n, reliefs), &
              sweep%state(2, n, reliefs), sweep%branch_lost(n, reliefs), &
              sweep%direction(n, reliefs), sweep%other_status(n, reliefs), sweep%other_factor(n, reliefs), &
              sweep%other_dte_rms(n, reliefs))
    sweep%rpm = rpm
  end subroutine allocate_sweep

  !> Stores the points of a relief; points that are not final have no result.
  subroutine store(load, points, final, relief, sweep)
    real(dp), intent(in) :: load                 ! static load, N
    type(point_t), intent(in) :: points(:)
    logical, intent(in) :: final(:)
    integer, intent(in) :: relief
    type(sweep_t), intent(inout) :: sweep
    real(dp) :: none
    logical, allocatable :: found(:), watched(:)

    none = ieee_value(1.0_dp, ieee_quiet_nan)
    found = final .and. has_result(points%steady%status)
    associate (steady => points%steady)
      sweep%dynamic_factor(:, relief) = merge(points%dynamic_factor, none, found)
      sweep%estimate(:, relief) = merge(points%estimate, none, found)
      sweep%dte_rms(:, relief) = merge(steady%dte_rms, none, found)
      sweep%dte_range(:, relief) = merge(steady%dte_range, none, found)
      sweep%dte_estimate(:, relief) = merge(points%dte_estimate, none, found)
      watched = final .and. steady%seen%periods > 0
      sweep%seen_periods(:, relief) = merge(steady%seen%periods, 0, watched)
      sweep%seen_factor(:, relief) = merge(steady%seen%peak/load, none, watched)
      sweep%seen_dte_rms(:, relief) = merge(rms_of(steady%seen%dte, max(1, steady%seen%periods)), none, watched)
      sweep%seen_dte_range(:, relief) = merge(range_of(steady%seen%dte), none, watched)
      sweep%coast_factor(:, relief) = merge(steady%coast_peak/load, none, found)
      ! The multiplier of a motion without a result is known if it repels, or is chaotic.
      sweep%multiplier(:, relief) = merge(steady%multiplier, none, found .or. (final .and. steady%multiplier > 0))
      sweep%mesh_multiplier(:, relief) = merge(steady%mesh_multiplier, none, found .or. (final .and. steady%mesh_multiplier > 0))
      sweep%residual(:, relief) = merge(steady%residual, none, final)
      sweep%status(:, relief) = merge(steady%status, status_stopped, final)
      sweep%steps(:, relief) = merge(points%steps, 0, final)
      sweep%state(1, :, relief) = steady%state(1)
      sweep%state(2, :, relief) = steady%state(2)
      sweep%motions(:, relief) = merge(points%motions, 0, final)
      sweep%periods(:, relief) = merge(steady%periods, 0, final)
      sweep%branch_lost(:, relief) = final .and. points%branch_lost
      sweep%contact(:, relief) = merge(contact_of(steady), contact_full, final)
    end associate
    sweep%direction(:, relief) = merge(points%direction, 0, final)
    sweep%other_status(:, relief) = sweep%status(:, relief)
    sweep%other_factor(:, relief) = sweep%dynamic_factor(:, relief)
    sweep%other_dte_rms(:, relief) = sweep%dte_rms(:, relief)
    where (sweep%direction(:, relief) /= 0)
      sweep%other_status(:, relief) = points%other_status
      sweep%other_factor(:, relief) = merge(points%other_factor, none, has_result(points%other_status))
      sweep%other_dte_rms(:, relief) = merge(points%other_dte_rms, none, has_result(points%other_status))
    end where
  end subroutine store

  !> Worst contact state in the period, one of contact_full ... of this module.
  elemental integer function contact_of(steady) result(contact)
    type(steady_t), intent(in) :: steady

    contact = contact_full
    if (steady%partial) contact = contact_partial
    if (steady%lost) contact = contact_lost
    if (steady%coast) contact = contact_coast
  end function contact_of

  !> Name of one of contact_full ... in tables.
  elemental function contact_name(contact) result(name)
    integer, intent(in) :: contact
    character(7) :: name
    character(7), parameter :: names(0:3) = [character(7) :: 'full', 'partial', 'lost', 'coast']

    name = names(contact)
  end function contact_name

  !> Divides the speeds into blocks that share an initial guess of the steps. Blocks grow in length, as slow speeds need more
  !> steps and more different tables. Blocks of one relief share tables and follow each other; those of large reliefs, where
  !> contact changes, are first.
  pure function make_blocks(speeds, reliefs) result(blocks)
    integer, intent(in) :: speeds, reliefs       !< their numbers
    type(block_t), allocatable :: blocks(:)
    integer, parameter :: shortest = 32, longest = 256
    integer :: first, length, r

    allocate (blocks(0))
    do r = reliefs, 1, -1
      first = 1
      length = shortest
      do while (first <= speeds)
        blocks = [blocks, block_t(r, first, min(first + length - 1, speeds))]
        first = first + length
        length = min(2*length, longest)
      end do
    end do
  end function make_blocks

  !> True if the caller has requested the sweep to end.
  logical function is_stopped(options)
    type(sweep_options_t), intent(in) :: options

    is_stopped = wants_stop(options%accuracy%steady%stop)
  end function is_stopped

  !> Adds this many finished parts of points; any thread may call it.
  subroutine tick(self, units)
    class(counter_t), intent(inout) :: self
    integer, intent(in) :: units

    if (units == 0 .or. .not. (associated(self%progress) .or. c_associated(self%watch))) return
    !$omp critical (gearsweep_progress)
    self%units = self%units + units
    call self%tell()
    !$omp end critical (gearsweep_progress)
  end subroutine tick

  !> Reports how many points are done; by one thread at a time.
  subroutine tell(self)
    class(counter_t), intent(in) :: self
    integer(c_int), pointer :: mark(:)
    integer :: done

    if (self%total < 0) return
    done = self%before + int(self%units/self%parts)
    if (c_associated(self%watch)) then
      call c_f_pointer(self%watch, mark, [3])
      ! The number never falls, even where an earlier task reported more points.
      done = max(done, mark(2))
      mark(2:3) = [done, self%total]
    end if
    if (associated(self%progress)) call self%progress(done, self%total)
  end subroutine tell

  !> Solves each speed of a block by itself. If a branch is to be followed, solves only those for which a batch converges, as full
  !> contact decides them.
  subroutine solve_block(osc, rpm, options, block, counter, levels, points, solved)
    type(oscillator_t), intent(in) :: osc            !< oscillator of the block's relief
    real(dp), intent(in) :: rpm(:)                   !< speeds of the pinion, ascending, 1/min
    type(sweep_options_t), intent(in) :: options
    type(block_t), intent(in) :: block
    type(counter_t), intent(inout) :: counter
    type(levels_t), intent(inout) :: levels          !< levels of this oscillator
    type(point_t), intent(inout) :: points(:)        !< (speed)
    logical, intent(inout) :: solved(:)              !< false on entry; true: solved without the neighbouring speeds; (speed)
    integer :: k, last, step
    logical :: in_batches

    ! The result must not depend on earlier use of the levels.
    levels%steps_per_second = 0
    ! A single speed is faster alone than in a batch.
    in_batches = size(rpm) > 1 .and. options%accuracy%steps == 0 .and. options%accuracy%steady%method == by_shooting .and. &
                 options%accuracy%scheme == scheme_collocation
    step = merge(batch_size, size(rpm), in_batches)
    do k = block%first, block%last, step
      if (is_stopped(options)) return
      last = min(k + step - 1, block%last)
      if (in_batches) call solve_group(osc, rpm(k:last), options, levels, points(k:last), solved(k:last))
      call counter%tick(merge(2*count(solved(k:last)), last - k + 1, options%direction == each))
    end do
    if (options%direction /= each) return
    do k = block%first, block%last
      if (solved(k)) cycle
      if (is_stopped(options)) return
      call solve_point(osc, mesh_period(osc%mesh%teeth(1), rpm(k)), options%accuracy, levels, points(k))
      if (points(k)%steady%status == status_stopped) return
      solved(k) = .true.
      call counter%tick(2)
    end do
    associate (first => block%first, last => block%last)
      if (options%largest) call take_largest(osc, rpm(first:last), options%accuracy, levels, points(first:last))
    end associate
  end subroutine solve_block

  !> Solves speeds in a batch; the last speed fills the remaining lanes.
  subroutine solve_group(osc, rpm, options, levels, points, solved)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm(:)
    type(sweep_options_t), intent(in) :: options
    type(levels_t), intent(inout) :: levels
    type(point_t), intent(inout) :: points(:)
    logical, intent(inout) :: solved(:)
    type(point_t) :: found(batch_size)
    logical :: ok(batch_size)
    integer :: k

    call solve_batch(osc, mesh_period(osc%mesh%teeth(1), [(rpm(min(k, size(rpm))), k=1, batch_size)]), options%accuracy, &
                     levels, found, ok)
    points = found(:size(rpm))
    solved = ok(:size(rpm))
  end subroutine solve_group

  !> Passes through the speeds of a relief, up or down, and solves those that are not solved yet or lie on another branch than the
  !> previous speed. Where that branch leads to no motion, the speed is solved by itself, unless its motion grows without bound:
  !> then no motion exists to return to.
  subroutine continue_sweep(osc, rpm, options, counter, levels, points, solved, final)
    type(oscillator_t), intent(in) :: osc            !< oscillator of the relief
    real(dp), intent(in) :: rpm(:)                   !< speeds of the pinion, ascending, 1/min
    type(sweep_options_t), intent(in) :: options
    type(counter_t), intent(inout) :: counter
    type(levels_t), intent(inout) :: levels          !< levels of this oscillator
    type(point_t), intent(inout) :: points(:)        !< (speed)
    logical, intent(in) :: solved(:)                 !< solved without the neighbouring speeds; (speed)
    logical, intent(out) :: final(:)                 !< passed before a stop; (speed)
    type(point_t) :: alone
    integer :: i, k, last

    final = .false.
    levels%steps_per_second = 0
    do i = 1, size(rpm)
      if (is_stopped(options)) return
      k = merge(size(rpm) + 1 - i, i, options%direction == down)
      last = merge(k + 1, k - 1, options%direction == down)
      if (i == 1) then
        if (.not. solved(k)) call solve_point(osc, mesh_period(osc%mesh%teeth(1), rpm(k)), options%accuracy, levels, points(k))
      else
        alone = points(k)
        if (.not. solved(k)) then
          call continue_sweep_to(osc, rpm(k), options, levels, points(last), rpm(last), points(k))
        else if (.not. is_beside(osc, points(last), rpm(last), points(k), rpm(k))) then
          call continue_sweep_to(osc, rpm(k), options, levels, points(last), rpm(last), points(k), alone)
        end if
        if (.not. has_result(points(last)%steady%status)) points(k)%branch_lost = .true.
      end if
      if (points(k)%steady%status == status_stopped) return
      final(k) = .true.
      call counter%tick(1)
    end do
  end subroutine continue_sweep

  !> Sweeps down after the sweep up, as far as it may meet another motion: to the speed, below the lowest at which the sweep up
  !> lost full contact, where both meet the same motion. Next to the last motion nothing is solved again unless contact is lost.
  !> Each point becomes the larger motion.
  subroutine return_from_above(osc, rpm, options, counter, levels, points, final)
    type(oscillator_t), intent(in) :: osc            !< oscillator of the relief
    real(dp), intent(in) :: rpm(:)                   !< speeds of the pinion, ascending, 1/min
    type(sweep_options_t), intent(in) :: options
    type(counter_t), intent(inout) :: counter
    type(levels_t), intent(inout) :: levels          !< levels of this oscillator
    type(point_t), intent(inout) :: points(:)        !< after the sweep up; (speed)
    logical, intent(inout) :: final(:)               !< set to true for each speed that is passed; (speed)
    type(point_t) :: above, here
    integer :: k, n, lowest

    n = size(rpm)
    lowest = findloc(points%steady%partial .or. loses_contact(points), .true., 1)
    if (lowest == 0) lowest = n + 1
    do k = n, 1, -1
      if (is_stopped(options)) return
      ! The lowest motion on the way up may also continue below.
      if (min(k + 1, n) < lowest .and. points(min(k + 1, n))%direction == 0) then
        final(:k) = .true.
        call counter%tick(k)
        return
      end if
      here = points(k)
      if (.not. meets_same(osc, rpm(k:min(k + 1, n)), above, here)) then
        call come_down(osc, rpm(k:min(k + 1, n)), options, levels, above, here)
        if (here%steady%status == status_stopped) return
        call take_larger(here, options%accuracy%steady%tolerance, points(k))
      end if
      above = here
      final(k) = .true.
      call counter%tick(1)
    end do
  end subroutine return_from_above

  !> True if the way down meets the motion of the way up: all pairs stay in contact next to the motion at the speed above, or both
  !> use the motion of the speed by itself.
  pure logical function meets_same(osc, rpm, above, point)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm(:)                   !< this speed and the one above, if any, 1/min
    type(point_t), intent(in) :: above, point        !< points on the way down at the speed above, and on the way up at this speed

    meets_same = .not. loses_contact(point)
    if (size(rpm) == 1) return
    if (.not. has_result(above%steady%status)) then
      meets_same = meets_same .or. point%branch_lost
    else if (meets_same) then
      meets_same = is_beside(osc, above, rpm(2), point, rpm(1))
    end if
  end function meets_same

  !> Computes the motion of a speed on the way down.
  subroutine come_down(osc, rpm, options, levels, above, point)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm(:)                   !< this speed and the one above, if any, 1/min
    type(sweep_options_t), intent(in) :: options
    type(levels_t), intent(inout) :: levels
    type(point_t), intent(in) :: above               !< point on the way down at the speed above
    type(point_t), intent(inout) :: point            !< in: point on the way up; out: point on the way down
    type(point_t) :: alone

    alone = point
    if (size(rpm) == 1) then
      call solve_point(osc, mesh_period(osc%mesh%teeth(1), rpm(1)), options%accuracy, levels, point)
      return
    end if
    if (alone%branch_lost .or. .not. alone%steady%partial) then
      call continue_sweep_to(osc, rpm(1), options, levels, above, rpm(2), point, alone)
    else
      call continue_sweep_to(osc, rpm(1), options, levels, above, rpm(2), point)
    end if
    if (.not. has_result(above%steady%status)) point%branch_lost = .true.
  end subroutine come_down

  !> True if all pairs were apart for a while, or if no periodic motion was found.
  elemental logical function loses_contact(point)
    type(point_t), intent(in) :: point

    loses_contact = point%steady%lost
    if (.not. (loses_contact .or. has_result(point%steady%status))) loses_contact = point%steady%status /= status_unresolved
  end function loses_contact

  !> Selects, of the motions at a speed on the ways up and down, the one of larger dynamic factor, or the one with a result. They
  !> count as one motion if their dynamic factors differ by no more than their errors and the tolerance.
  pure subroutine take_larger(from_above, tolerance, point)
    type(point_t), intent(in) :: from_above
    real(dp), intent(in) :: tolerance
    type(point_t), intent(inout) :: point            !< in: on the way up; out: the larger
    type(point_t) :: from_below
    type(seen_t) :: seen
    real(dp) :: estimate(2)
    logical :: known(2)

    from_below = point
    known = has_result([from_below%steady%status, from_above%steady%status])
    ! Observations of a motion that does not repeat stay with the point, whichever motion is selected.
    seen = merge(from_above%steady%seen, from_below%steady%seen, from_above%steady%seen%peak > from_below%steady%seen%peak)
    point%steady%seen = seen
    if (all(known)) then
      estimate = [from_below%estimate, from_above%estimate]
      if (abs(from_below%dynamic_factor - from_above%dynamic_factor) <= tolerance + &
          sum(estimate, mask=.not. ieee_is_nan(estimate))) return
    else if (.not. any(known)) then
      if (from_below%steady%status == from_above%steady%status) return
    end if
    if (known(2) .and. .not. (known(1) .and. from_below%dynamic_factor > from_above%dynamic_factor)) then
      point = from_above
      point%direction = down
      point%steady%seen = seen
      point%other_status = from_below%steady%status
      point%other_factor = from_below%dynamic_factor
      point%other_dte_rms = from_below%steady%dte_rms
    else
      point%direction = up
      point%other_status = from_above%steady%status
      point%other_factor = from_above%dynamic_factor
      point%other_dte_rms = from_above%steady%dte_rms
    end if
  end subroutine take_larger

  !> Computes the motion that the one of the previous speed leads to, else that of the speed by itself.
  subroutine continue_sweep_to(osc, rpm, options, levels, last, rpm_last, point, known)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm, rpm_last            !< 1/min
    type(sweep_options_t), intent(in) :: options
    type(levels_t), intent(inout) :: levels
    type(point_t), intent(in) :: last                !< point at the previous speed
    type(point_t), intent(out) :: point
    type(point_t), intent(in), optional :: known     !< solved by itself
    type(point_t) :: alone

    call continue_to(osc, rpm, options%accuracy, levels, last, rpm_last, point)
    if (has_result(point%steady%status) .or. .not. has_result(last%steady%status)) return
    if (point%steady%status == status_stopped .or. point%steady%status == status_unbounded) return
    if (present(known)) then
      alone = known
    else
      call solve_point(osc, mesh_period(osc%mesh%teeth(1), rpm), options%accuracy, levels, alone)
    end if
    if (.not. (has_result(alone%steady%status) .or. alone%steady%status == status_stopped)) return
    if (point%steady%seen%periods > 0) alone%steady%seen = point%steady%seen
    point = alone
    point%branch_lost = .true.
  end subroutine continue_sweep_to

  !> True if these motions of neighbouring speeds lie on one branch: all pairs stay in contact, or one of them has no result.
  pure logical function is_beside(osc, last, rpm_last, next, rpm_next)
    type(oscillator_t), intent(in) :: osc
    type(point_t), intent(in) :: last, next
    real(dp), intent(in) :: rpm_last, rpm_next
    real(dp), parameter :: beside = 0.1_dp           ! static deflections

    is_beside = .not. has_result(last%steady%status) .or. .not. (last%steady%partial .or. next%steady%partial)
    if (.not. is_beside) is_beside = distance(osc, mesh_period(osc%mesh%teeth(1), rpm_next), &
                                              next%steady%state - carried(last, rpm_last, rpm_next)) < beside
  end function is_beside
end module gearsweep_motion_sweep
