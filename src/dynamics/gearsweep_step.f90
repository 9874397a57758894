!> One step of the motion with the contact as it is, the piece that the period and the location of
!> contact changes share.
!>
!> The state is x (m) and its derivative y over the mesh phase (m).
module gearsweep_step
  use gearsweep_kinds, only: dp
  use gearsweep_gauss, only: collocate, lanes
  use gearsweep_motion, only: oscillator_t
  use gearsweep_quintic, only: quintic, top_of, value_of
  implicit none
  private
  public :: period_t, walk_t, step_t, step_of, follow, chain, note_contact, track, track_top

  !> What one period does.
  type :: period_t
    real(dp) :: state(2) = 0           !< at the end of the period
    real(dp) :: map(2, 2) = 0          !< derivative of that by the initial state
    real(dp) :: peak = 0               !< largest load on one pair, N
    integer :: events = 0              !< changes of contact within the period
    real(dp) :: work = 0               !< what it cost, in steps
    logical :: partial = .false.       !< a pair between A and E was apart for a while
    logical :: flight = .false.        !< all flanks were apart for a while
    logical :: coast = .false.         !< the coast sides touched
    logical :: failed = .false.        !< contact changed too often
  end type period_t

  !> The motion at one phase, while it is followed.
  type :: walk_t
    real(dp) :: x, y
    real(dp) :: map(2, 2)
    logical, allocatable :: contact(:)
    !> The step at hand, while contact changes in it: quintics over it, (0:5, pair) and (0:5, member).
    real(dp), allocatable :: stiffness(:, :), error(:, :)
  end type walk_t

  !> The affine map of the state over one step.
  type :: step_t
    real(dp) :: map(2, 2), shift(2)
  end type step_t

contains

  !> The step for given coefficients at its nodes: w^2, sum of k e, w of the members in contact.
  pure function step_of(osc, square, push, omega, duration, width) result(step)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: square(3), push(3), omega(3), duration, width
    type(step_t) :: step
    real(dp), dimension(lanes, 3) :: k, d, p
    real(dp) :: map(lanes, 6)

    associate (time => duration*width)
      k(1, :) = time**2*square
      d(1, :) = 2*osc%damping_ratio*time*omega
      p(1, :) = time**2*(push + osc%load*sum(1/osc%mass))
    end associate
    call collocate(1, k, d, p, map)
    step%map(:, 1) = [map(1, 1), map(1, 2)/width]
    step%map(:, 2) = [map(1, 3)*width, map(1, 4)]
    step%shift = [map(1, 5), map(1, 6)/width]
  end function step_of

  !> The state after the step.
  pure function follow(step, x, y) result(state)
    type(step_t), intent(in) :: step
    real(dp), intent(in) :: x, y
    real(dp) :: state(2)

    state(1) = step%map(1, 1)*x + step%map(1, 2)*y + step%shift(1)
    state(2) = step%map(2, 1)*x + step%map(2, 2)*y + step%shift(2)
  end function follow

  !> Lets the step follow what was before: the derivative by the initial state.
  pure subroutine chain(step, map)
    type(step_t), intent(in) :: step
    real(dp), intent(inout) :: map(2, 2)
    real(dp) :: x
    integer :: k

    do k = 1, 2
      x = map(1, k)
      map(1, k) = step%map(1, 1)*x + step%map(1, 2)*map(2, k)
      map(2, k) = step%map(2, 1)*x + step%map(2, 2)*map(2, k)
    end do
  end subroutine chain

  !> Notes that not every pair carries.
  pure subroutine note_contact(osc, contact, out)
    type(oscillator_t), intent(in) :: osc
    logical, intent(in) :: contact(:)
    type(period_t), intent(inout) :: out

    out%partial = .true.
    out%flight = out%flight .or. .not. any(contact)
    if (osc%has_backlash) out%coast = out%coast .or. contact(size(contact))
  end subroutine note_contact

  !> Raises `peak` to the larger of a pair's loads at the ends of a stretch; may a larger one lie
  !> between? Given value and slope over the stretch at its ends. A concave load stays below its tangents.
  pure subroutine track(load, peak, more)
    real(dp), intent(in) :: load(0:, :)
    real(dp), intent(inout) :: peak
    logical, intent(out) :: more

    peak = max(peak, load(0, 1), load(0, 2))
    more = load(1, 1) > 0 .and. load(1, 2) < 0
    if (more) more = max(load(0, 1), load(0, 2)) + (load(1, 1) - load(1, 2))/4 > peak
  end subroutine track

  !> Raises `peak` to the largest load within the stretch; given with its curvature.
  pure subroutine track_top(load, peak)
    real(dp), intent(in) :: load(0:2, 2)
    real(dp), intent(inout) :: peak
    real(dp) :: c(0:5)

    c = quintic(load(:, 1), load(:, 2))
    peak = max(peak, value_of(c, top_of(c)))
  end subroutine track_top
end module gearsweep_step
