!> What a sweep is asked for, and how far it is: from there it can go on, to the same bits.
module gearsweep_sweep_state
  use, intrinsic :: iso_c_binding, only: c_associated, c_f_pointer, c_int, c_null_ptr, c_ptr
  use, intrinsic :: iso_fortran_env, only: int64
  use gearsweep_kinds, only: dp
  use gearsweep_steady_motion, only: accuracy_t, point_t
  use gearsweep_stop, only: wants_stop
  implicit none
  private
  public :: sweep_options_t, sweep_state_t, block_t, counter_t, progress_of_sweep
  public :: begin_state, fits, is_stopped, find_final, units_done

  !> Each point by itself, or on the branch of the point before.
  integer, parameter, public :: each = 0, up = 1, down = -1
  !> Up and, where contact was lost on the way, down too: of the two motions at a speed, the one of larger dynamic factor.
  integer, parameter, public :: both = 3
  !> What a case may ask for besides: each point by itself, and all motions that attract there.
  integer, parameter, public :: all_motions = 2

  !> More points than this are refused: 1 GB of results.
  integer, parameter, public :: most_points = 10**7

  !> So many points in all, and those of the run, are not told.
  integer, parameter, public :: untold = -10**9

  !> Sweeps of one search for the best relief.
  integer, parameter, public :: most_sweeps = 5

  type :: sweep_options_t
    type(accuracy_t) :: accuracy
    integer :: direction = both
    integer :: threads = 0                       !< 0: as many as the machine has
    !> Only points that one map serves for all reliefs, as all pairs stay in contact; the others are left out as `stopped`.
    logical :: full_contact_only = .false.
    logical :: is_counted = .true.               !< its points are told as done
    !> For progress: points of the call that were done before this sweep, and that there are in all; 0: this sweep's.
    integer :: done_before = 0, all_points = 0
  end type sweep_options_t

  !> Speeds first to last of one relief, and how far they are solved.
  type :: block_t
    integer :: relief = 0, first = 1, last = 0
    !> Of the first relief, last speed that has been through a batch of all reliefs, and steps per second needed there.
    integer :: together = 0
    real(dp) :: pace_together = 0
    integer :: grouped = 0                       !< last speed that has been through a batch
    integer :: single = 0                        !< last speed that is solved, by itself or in a batch, with `each`
    real(dp) :: pace = 0                         !< steps per second needed there
  end type block_t

  type :: sweep_state_t
    type(block_t), allocatable :: blocks(:)
    integer, allocatable :: followed(:)          !< of each relief, speeds that the branch has passed
    integer, allocatable :: returned(:)          !< of each relief, speeds that the way down has passed after the way up
    type(point_t), allocatable :: above(:)       !< of each relief, what the way down has last met
    real(dp), allocatable :: pace(:)             !< of each relief, steps per second needed there
    type(point_t), allocatable :: points(:, :)   !< speed, relief
    logical, allocatable :: solved(:, :)         !< by itself, without regard to the speeds beside it
  end type sweep_state_t

  abstract interface
    !> Told now and then, by one thread at a time, how many points are done; never fewer than before.
    subroutine progress_of_sweep(done, total)
      integer, intent(in) :: done, total
    end subroutine progress_of_sweep
  end interface

  !> Counts parts of points: solved by itself, passed by the branch and, in a sweep up and down, passed on the way down.
  type :: counter_t
    integer(int64) :: units = 0
    integer :: parts = 2                         !< of a point
    integer :: before = 0, total = 0
    procedure(progress_of_sweep), pointer, nopass :: progress => null()
    type(c_ptr) :: watch = c_null_ptr            !< three integers of the caller: stop, done, total
  contains
    procedure :: tick, tell
  end type counter_t

contains

  !> A sweep that has not begun.
  pure subroutine begin_state(speeds, reliefs, state)
    integer, intent(in) :: speeds, reliefs       !< how many
    type(sweep_state_t), intent(out) :: state

    state%blocks = make_blocks(speeds, reliefs)
    allocate (state%followed(reliefs), source=0)
    allocate (state%pace(reliefs), source=0.0_dp)
    allocate (state%returned(reliefs), source=0)
    allocate (state%above(reliefs))
    allocate (state%points(speeds, reliefs))
    allocate (state%solved(speeds, reliefs), source=.false.)
  end subroutine begin_state

  !> Is this the state of a sweep of so many speeds and reliefs?
  pure logical function fits(state, speeds, reliefs)
    type(sweep_state_t), intent(in) :: state
    integer, intent(in) :: speeds, reliefs       !< how many

    fits = allocated(state%points)
    if (fits) fits = all(shape(state%points) == [speeds, reliefs])
  end function fits

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
        blocks = [blocks, block_t(r, first, min(first + length - 1, speeds), first - 1, &
                                   grouped=first - 1, single=first - 1)]
        first = first + length
        length = min(2*length, longest)
      end do
    end do
  end function make_blocks

  !> Does the caller want the sweep to end?
  logical function is_stopped(options)
    type(sweep_options_t), intent(in) :: options

    is_stopped = wants_stop(options%accuracy%steady%stop)
  end function is_stopped

  !> The points of one relief that are done.
  pure subroutine find_final(state, direction, relief, final)
    type(sweep_state_t), intent(in) :: state
    integer, intent(in) :: direction                       !< each, up, down or both
    integer, intent(in) :: relief                          !< which
    logical, allocatable, intent(out) :: final(:)          !< (speed)

    final = state%solved(:, relief)
    if (direction == each) return
    final(:) = .false.
    associate (n => size(final), passed => state%followed(relief))
      if (direction == up) final(:passed) = .true.
      if (direction == down) final(n + 1 - passed:) = .true.
      if (direction == both) final(n + 1 - state%returned(relief):) = .true.
    end associate
  end subroutine find_final

  !> How many parts of points are done, as `counter_t` counts them.
  pure integer(int64) function units_done(state, direction) result(units)
    type(sweep_state_t), intent(in) :: state
    integer, intent(in) :: direction                       !< each, up, down or both

    if (direction == each) then
      units = 2*count(state%solved, kind=int64)
    else
      units = sum(int(state%blocks%grouped - state%blocks%first + 1, int64)) + sum(int(state%followed, int64)) + &
              sum(int(state%returned, int64))
    end if
  end function units_done

  !> So many parts of points more are done; any thread may tell.
  subroutine tick(self, units)
    class(counter_t), intent(inout) :: self
    integer, intent(in) :: units

    if (units == 0 .or. .not. (associated(self%progress) .or. c_associated(self%watch))) return
    !$omp critical (gearsweep_progress)
    self%units = self%units + units
    call self%tell()
    !$omp end critical (gearsweep_progress)
  end subroutine tick

  !> Tells how many points are done; by one thread at a time.
  subroutine tell(self)
    class(counter_t), intent(in) :: self
    integer(c_int), pointer :: mark(:)
    integer :: done

    if (self%total < 0) return
    done = self%before + int(self%units/self%parts)
    if (c_associated(self%watch)) then
      call c_f_pointer(self%watch, mark, [3])
      ! What is taken over of a task that follows was told before.
      done = max(done, mark(2))
      mark(2:3) = [done, self%total]
    end if
    if (associated(self%progress)) call self%progress(done, self%total)
  end subroutine tell
end module gearsweep_sweep_state
