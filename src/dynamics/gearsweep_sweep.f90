!> Many operating points: speeds times reliefs, in parallel. The work is split
!> the same way for any number of threads, so the bits of the answer are the same.
module gearsweep_sweep
  use gearsweep_kinds, only: dp
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  use gearsweep_error, only: error_t, fail, code_memory
  use gearsweep_motion, only: oscillator_t
  use gearsweep_steady, only: has_answer
  use gearsweep_accuracy, only: accuracy_t, tables_t, point_t, solve_point, mesh_period
  use gearsweep_text, only: str
  implicit none
  private
  public :: sweep_t, sweep_options_t, run_sweep, progress_of_sweep

  !> Each point by itself, or on the branch of the point before.
  integer, parameter, public :: each = 0, up = 1, down = -1

  type :: sweep_options_t
    type(accuracy_t) :: accuracy
    integer :: direction = up
    integer :: threads = 0                       !< 0: as many as the machine has
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
    integer :: i, done, now

    call allocate_sweep(rpm, size(osc), sweep, error)
    if (allocated(error)) return
    blocks = make_blocks(size(rpm), size(osc), options%direction)
    done = 0
    !$omp parallel do default(none) shared(osc, rpm, options, sweep, blocks, done) private(now) &
    !$omp schedule(dynamic, 1) num_threads(team(options%threads, size(blocks)))
    do i = 1, size(blocks)
      call sweep_block(osc(blocks(i)%relief), blocks(i), options, sweep)
      !$omp atomic capture
      done = done + blocks(i)%last - blocks(i)%first + 1
      now = done
      !$omp end atomic
      if (present(progress)) then
        !$omp critical (gearsweep_progress)
        call progress(now, size(sweep%status))
        !$omp end critical (gearsweep_progress)
      end if
    end do
    !$omp end parallel do
  end subroutine run_sweep

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

  !> Following a branch makes one block of a relief; else 32 speeds share tables.
  pure function make_blocks(speeds, reliefs, direction) result(blocks)
    integer, intent(in) :: speeds, reliefs, direction
    type(block_t), allocatable :: blocks(:)
    integer :: length, per_relief, i, r

    length = merge(32, speeds, direction == each)
    per_relief = (speeds + length - 1)/length
    allocate (blocks(per_relief*reliefs))
    do r = 1, reliefs
      do i = 1, per_relief
        blocks((r - 1)*per_relief + i) = block_t(r, (i - 1)*length + 1, min(i*length, speeds))
      end do
    end do
  end function make_blocks

  !> Goes through the speeds of one block.
  subroutine sweep_block(osc, block, options, sweep)
    type(oscillator_t), intent(in) :: osc
    type(block_t), intent(in) :: block
    type(sweep_options_t), intent(in) :: options
    type(sweep_t), intent(inout) :: sweep
    type(tables_t), allocatable :: tables
    type(point_t) :: point
    real(dp) :: duration, before, state(2)
    logical :: follow
    integer :: first, last, k

    allocate (tables)
    first = block%first
    last = block%last
    if (options%direction == down) then
      first = block%last
      last = block%first
    end if
    follow = .false.
    before = 0
    do k = first, last, merge(-1, 1, options%direction == down)
      duration = mesh_period(osc%mesh%teeth(1), sweep%rpm(k))
      if (follow) then
        ! The same motion in time: the derivative over the phase scales with the period.
        call solve_point(osc, duration, options%accuracy, tables, point, [state(1), state(2)*duration/before])
      else
        call solve_point(osc, duration, options%accuracy, tables, point)
      end if
      call store(point, k, block%relief, sweep)
      ! While all pairs stay in contact there is one periodic motion: nothing to follow.
      follow = options%direction /= each .and. point%steady%partial .and. has_answer(point%steady%status)
      state = point%steady%state
      before = duration
    end do
  end subroutine sweep_block

  subroutine store(point, k, relief, sweep)
    type(point_t), intent(in) :: point
    integer, intent(in) :: k, relief
    type(sweep_t), intent(inout) :: sweep

    associate (steady => point%steady)
      sweep%dynamic_factor(k, relief) = point%dynamic_factor
      sweep%estimate(k, relief) = point%estimate
      if (.not. has_answer(steady%status)) then
        sweep%dynamic_factor(k, relief) = ieee_value(1.0_dp, ieee_quiet_nan)
        sweep%estimate(k, relief) = ieee_value(1.0_dp, ieee_quiet_nan)
      end if
      sweep%multiplier(k, relief) = steady%multiplier
      sweep%residual(k, relief) = steady%residual
      sweep%status(k, relief) = steady%status
      sweep%steps(k, relief) = point%steps
      sweep%periods(k, relief) = steady%periods
      sweep%contact(k, relief) = contact_full
      if (steady%partial) sweep%contact(k, relief) = contact_partial
      if (steady%flight) sweep%contact(k, relief) = contact_lost
      if (steady%coast) sweep%contact(k, relief) = contact_coast
    end associate
  end subroutine store
end module gearsweep_sweep
