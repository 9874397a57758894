!> Many operating points: speeds times reliefs, in parallel. The work is split
!> the same way for any number of threads, so the bits of the answer are the same.
module gearsweep_sweep
  use gearsweep_kinds, only: dp
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  use gearsweep_branches, only: carried, go_on
  use gearsweep_error, only: error_t, fail, code_memory
  use gearsweep_motion, only: oscillator_t
  use gearsweep_gauss, only: lanes
  use gearsweep_steady, only: steady_t, has_answer, distance, by_shooting
  use gearsweep_accuracy, only: accuracy_t, tables_t, point_t, solve_point, solve_lanes, mesh_period
  use gearsweep_text, only: str
  implicit none
  private
  public :: sweep_t, sweep_options_t, run_sweep, progress_of_sweep, contact_of

  !> Each point by itself, or on the branch of the point before.
  integer, parameter, public :: each = 0, up = 1, down = -1

  type :: sweep_options_t
    type(accuracy_t) :: accuracy
    integer :: direction = up
    integer :: threads = 0                       !< 0: as many as the machine has
    real(dp), allocatable :: keep(:)             !< speeds (1/min) whose points are wanted whole
  end type sweep_options_t

  !> Answers; first index speed, second relief. NaN where there is none.
  type :: sweep_t
    real(dp), allocatable :: rpm(:)
    real(dp), allocatable :: dynamic_factor(:, :)
    real(dp), allocatable :: estimate(:, :)      !< error of the dynamic factor
    real(dp), allocatable :: multiplier(:, :)    !< largest Floquet modulus
    real(dp), allocatable :: residual(:, :)      !< of periodicity, in static deflections
    integer, allocatable :: status(:, :)         !< point_ok ... of gearsweep_steady
    integer, allocatable :: contact(:, :)        !< contact_full ... below
    integer, allocatable :: steps(:, :)          !< a period
    integer, allocatable :: periods(:, :)        !< mesh periods until the motion repeats
    type(point_t), allocatable :: kept(:, :)     !< at the speeds to keep
  end type sweep_t

  integer, parameter, public :: contact_full = 0, contact_partial = 1, contact_lost = 2, contact_coast = 3

  !> More points than this are refused: 1 GB of answers.
  integer, parameter, public :: most_points = 10**7

  abstract interface
    !> Told now and then, by one thread at a time, how many points are done.
    subroutine progress_of_sweep(done, total)
      integer, intent(in) :: done, total
    end subroutine progress_of_sweep
  end interface

  !> Speeds first to last of one relief.
  type :: block_t
    integer :: relief, first, last
  end type block_t

contains

  !> Dynamic factors of `osc` (one for each relief) at the pinion speeds `rpm`
  !> (ascending, 1/min). A point that fails is marked and does not end the sweep.
  subroutine run_sweep(osc, rpm, options, sweep, error, progress)
    type(oscillator_t), intent(in) :: osc(:)
    real(dp), intent(in) :: rpm(:)
    type(sweep_options_t), intent(in) :: options
    type(sweep_t), intent(out) :: sweep
    type(error_t), allocatable, intent(out) :: error
    procedure(progress_of_sweep), optional :: progress
    type(block_t), allocatable :: blocks(:)
    type(point_t), allocatable :: points(:, :)
    type(tables_t), allocatable :: tables
    logical, allocatable :: solved(:, :)
    integer, allocatable :: open(:)              ! blocks of each relief
    integer :: i, done, now, relief, left

    call allocate_sweep(rpm, size(osc), sweep, error)
    if (allocated(error)) return
    i = 0
    if (allocated(options%keep)) i = size(options%keep)
    allocate (sweep%kept(i, size(osc)))
    allocate (points(size(rpm), size(osc)))
    allocate (solved(size(rpm), size(osc)), source=.false.)
    blocks = make_blocks(size(rpm), size(osc))
    open = [(count(blocks%relief == i), i=1, size(osc))]
    done = 0
    !$omp parallel default(none) shared(osc, rpm, options, sweep, blocks, points, solved, open, done) &
    !$omp private(now, tables, relief, left) num_threads(team(options%threads, size(blocks)))
    relief = 0
    !$omp do schedule(dynamic, 1)
    do i = 1, size(blocks)
      if (blocks(i)%relief /= relief) call forget(tables)
      relief = blocks(i)%relief
      call solve_block(osc(relief), rpm, blocks(i), options, tables, points(:, relief), solved(:, relief))
      !$omp atomic capture seq_cst
      open(relief) = open(relief) - 1
      left = open(relief)
      !$omp end atomic
      ! Who solves the last block of a relief goes on with it, while others work.
      if (left == 0) then
        if (options%direction /= each) call follow_branch(osc(relief), rpm, options, tables, points(:, relief), solved(:, relief))
        call store(points(:, relief), relief, sweep)
        call keep_points(osc(relief), rpm, options, tables, points(:, relief), sweep%kept(:, relief))
      end if
      !$omp atomic capture
      done = done + (blocks(i)%last - blocks(i)%first + 1)
      now = done
      !$omp end atomic
      if (present(progress)) then
        !$omp critical (gearsweep_progress)
        call progress(now, size(sweep%status))
        !$omp end critical (gearsweep_progress)
      end if
    end do
    !$omp end do
    !$omp end parallel
  end subroutine run_sweep

  !> Tables of another relief keep their room.
  subroutine forget(tables)
    type(tables_t), allocatable, intent(inout) :: tables

    if (.not. allocated(tables)) allocate (tables)
    tables%made = .false.
  end subroutine forget

  integer function team(threads, blocks)
    !$ use omp_lib, only: omp_get_max_threads
    integer, intent(in) :: threads, blocks

    team = threads
    !$ if (team <= 0) team = omp_get_max_threads()
    team = max(1, min(team, blocks))
  end function team

  subroutine allocate_sweep(rpm, reliefs, sweep, error)
    real(dp), intent(in) :: rpm(:)
    integer, intent(in) :: reliefs
    type(sweep_t), intent(out) :: sweep
    type(error_t), allocatable, intent(out) :: error
    integer :: n, stat

    n = size(rpm)
    stat = 0
    if (real(n, dp)*reliefs > most_points) stat = 1
    if (stat == 0) allocate (sweep%dynamic_factor(n, reliefs), sweep%estimate(n, reliefs), &
                             sweep%multiplier(n, reliefs), sweep%residual(n, reliefs), sweep%status(n, reliefs), &
                             sweep%contact(n, reliefs), sweep%steps(n, reliefs), sweep%periods(n, reliefs), stat=stat)
    if (stat /= 0) then
      call fail(error, code_memory, '&sweep: '//str(n)//' speeds times '//str(reliefs)// &
                ' reliefs are too many points; at most '//str(most_points))
      return
    end if
    sweep%rpm = rpm
  end subroutine allocate_sweep

  !> Speeds that share a guess of the steps: blocks of growing length, as the slow ones need more steps and
  !> more different tables. Blocks of one relief, which share tables, come in a row; those of large reliefs,
  !> where contact changes, first.
  pure function make_blocks(speeds, reliefs) result(blocks)
    integer, intent(in) :: speeds, reliefs
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

  !> Each speed of a block by itself; where a branch is to be followed, only what all pairs in contact
  !> decide.
  subroutine solve_block(osc, rpm, block, options, tables, points, solved)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm(:)
    type(block_t), intent(in) :: block
    type(sweep_options_t), intent(in) :: options
    type(tables_t), intent(inout) :: tables
    type(point_t), intent(inout) :: points(:)
    logical, intent(inout) :: solved(:)
    integer :: k

    ! The answer shall not depend on what the tables were used for before.
    tables%steps_per_second = 0
    ! One speed by itself is faster without lanes.
    if (size(rpm) > 1 .and. options%accuracy%steps == 0 .and. options%accuracy%steady%method == by_shooting) then
      do k = block%first, block%last, lanes
        call solve_group(osc, rpm, k, min(k + lanes - 1, block%last), options, tables, points, solved)
      end do
    end if
    if (options%direction /= each) return
    do k = block%first, block%last
      if (solved(k)) cycle
      call solve_point(osc, mesh_period(osc%mesh%teeth(1), rpm(k)), options%accuracy, tables, points(k))
      solved(k) = .true.
    end do
  end subroutine solve_block

  !> Speeds first to last in lanes; the last one fills what is left.
  subroutine solve_group(osc, rpm, first, last, options, tables, points, solved)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm(:)
    integer, intent(in) :: first, last
    type(sweep_options_t), intent(in) :: options
    type(tables_t), intent(inout) :: tables
    type(point_t), intent(inout) :: points(:)
    logical, intent(inout) :: solved(:)
    type(point_t) :: found(lanes)
    logical :: ok(lanes)
    integer :: k

    call solve_lanes(osc, mesh_period(osc%mesh%teeth(1), [(rpm(min(k, last)), k=first, first + lanes - 1)]), &
                     options%accuracy, tables, found, ok)
    points(first:last) = found(:last - first + 1)
    solved(first:last) = ok(:last - first + 1)
  end subroutine solve_group

  !> Goes through the speeds, up or down, and solves what is left, or lies on another branch than the
  !> speed before.
  subroutine follow_branch(osc, rpm, options, tables, points, solved)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm(:)
    type(sweep_options_t), intent(in) :: options
    type(tables_t), intent(inout) :: tables
    type(point_t), intent(inout) :: points(:)
    logical, intent(inout) :: solved(:)
    integer :: i, k, last

    tables%steps_per_second = 0
    do i = 1, size(rpm)
      k = merge(i, size(rpm) + 1 - i, options%direction == up)
      last = merge(k - 1, k + 1, options%direction == up)
      if (i == 1) then
        if (.not. solved(k)) call solve_point(osc, mesh_period(osc%mesh%teeth(1), rpm(k)), options%accuracy, tables, points(k))
      else
        if (solved(k)) solved(k) = is_beside(osc, points(last), rpm(last), points(k), rpm(k))
        if (.not. solved(k)) call go_on(osc, rpm(k), options%accuracy, tables, points(last), rpm(last), points(k))
      end if
      solved(k) = .true.
    end do
  end subroutine follow_branch

  !> Do these motions of neighbouring speeds lie on one branch? So they do where all pairs stay in contact,
  !> and where nothing is known of one.
  pure logical function is_beside(osc, last, rpm_last, next, rpm_next)
    type(oscillator_t), intent(in) :: osc
    type(point_t), intent(in) :: last, next
    real(dp), intent(in) :: rpm_last, rpm_next
    real(dp), parameter :: beside = 0.1_dp       ! static deflections

    is_beside = .not. has_answer(last%steady%status) .or. .not. (last%steady%partial .or. next%steady%partial)
    if (.not. is_beside) is_beside = distance(osc, mesh_period(osc%mesh%teeth(1), rpm_next), &
                                              next%steady%state - carried(last, rpm_last, rpm_next)) < beside
  end function is_beside

  subroutine store(points, relief, sweep)
    type(point_t), intent(in) :: points(:)
    integer, intent(in) :: relief
    type(sweep_t), intent(inout) :: sweep

    associate (steady => points%steady, answered => has_answer(points%steady%status))
      sweep%dynamic_factor(:, relief) = merge(points%dynamic_factor, ieee_value(1.0_dp, ieee_quiet_nan), answered)
      sweep%estimate(:, relief) = merge(points%estimate, ieee_value(1.0_dp, ieee_quiet_nan), answered)
      sweep%multiplier(:, relief) = steady%multiplier
      sweep%residual(:, relief) = steady%residual
      sweep%status(:, relief) = steady%status
      sweep%steps(:, relief) = points%steps
      sweep%periods(:, relief) = steady%periods
      sweep%contact(:, relief) = contact_of(steady)
    end associate
  end subroutine store

  !> The points at the speeds to keep. One that is no speed of the sweep is solved from the speed before, as if it
  !> were, or by itself where the sweep follows no branch.
  subroutine keep_points(osc, rpm, options, tables, points, kept)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rpm(:)
    type(sweep_options_t), intent(in) :: options
    type(tables_t), intent(inout) :: tables
    type(point_t), intent(in) :: points(:)
    type(point_t), intent(out) :: kept(:)
    real(dp), parameter :: same = 1e-12_dp
    integer :: i, k, before

    do i = 1, size(kept)
      k = minloc(abs(rpm - options%keep(i)), 1)
      if (abs(rpm(k) - options%keep(i)) <= same*rpm(k)) then
        kept(i) = points(k)
        cycle
      end if
      before = 0
      if (options%direction == up) before = count(rpm < options%keep(i))
      if (options%direction == down) before = modulo(count(rpm < options%keep(i)) + 1, size(rpm) + 1)
      tables%steps_per_second = 0
      if (before > 0) then
        call go_on(osc, options%keep(i), options%accuracy, tables, points(before), rpm(before), kept(i))
      else
        call solve_point(osc, mesh_period(osc%mesh%teeth(1), options%keep(i)), options%accuracy, tables, kept(i))
      end if
    end do
  end subroutine keep_points

  elemental integer function contact_of(steady) result(contact)
    type(steady_t), intent(in) :: steady

    contact = contact_full
    if (steady%partial) contact = contact_partial
    if (steady%flight) contact = contact_lost
    if (steady%coast) contact = contact_coast
  end function contact_of
end module gearsweep_sweep
