!> One step of the motion with the contact as it is, the piece that the period and the location of
!> contact changes share.
!>
!> The state is x (m) and its derivative y over the mesh phase (m).
module gearsweep_step
  use gearsweep_kinds, only: dp
  use gearsweep_gauss, only: collocate
  use gearsweep_motion, only: oscillator_t
  use gearsweep_quintic, only: quintic, top_of, value_of
  implicit none
  private
  public :: period_t, walk_t, step_t, step_of, follow, note_contact, track

  !> What one period does.
  type :: period_t
    real(dp) :: state(2) = 0           !< at the end of the period
    real(dp) :: map(2, 2) = 0          !< derivative of that by the initial state
    real(dp) :: peak = 0               !< largest load on one pair, N
    integer :: events = 0              !< changes of contact within the period
    logical :: partial = .false.       !< a pair between A and E was apart for a while
    logical :: flight = .false.        !< all flanks were apart for a while
    logical :: coast = .false.         !< the coast sides touched
    logical :: failed = .false.        !< contact changed too often within one step
  end type period_t

  !> The motion at one phase, while it is followed.
  type :: walk_t
    real(dp) :: x, y
    real(dp) :: map(2, 2)
    logical, allocatable :: contact(:)
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
    real(dp) :: k(3), d(3), p(3)

    associate (time => duration*width)
      k = time**2*square
      d = 2*osc%damping_ratio*time*omega
      p = time**2*(push + osc%load*sum(1/osc%mass))
    end associate
    call collocate(k(1), k(2), k(3), d(1), d(2), d(3), p(1), p(2), p(3), step%map(1, 1), step%map(1, 2), &
                   step%map(2, 1), step%map(2, 2), step%shift(1), step%shift(2))
    step%map(1, 2) = step%map(1, 2)*width
    step%map(2, 1) = step%map(2, 1)/width
    step%shift(2) = step%shift(2)/width
  end function step_of

  !> The state after the step.
  pure function follow(step, x, y) result(state)
    type(step_t), intent(in) :: step
    real(dp), intent(in) :: x, y
    real(dp) :: state(2)

    state = step%shift + step%map(:, 1)*x + step%map(:, 2)*y
  end function follow

  !> Notes that not every pair carries.
  pure subroutine note_contact(osc, contact, out)
    type(oscillator_t), intent(in) :: osc
    logical, intent(in) :: contact(:)
    type(period_t), intent(inout) :: out

    out%partial = .true.
    out%flight = out%flight .or. .not. any(contact)
    if (osc%has_backlash) out%coast = out%coast .or. contact(size(contact))
  end subroutine note_contact

  !> Raises `peak` to the largest load of one pair over a stretch. Stiffness and overlap, second index
  !> left and right, hold value, first and second derivative over the stretch.
  pure subroutine track(stiffness, overlap, peak)
    real(dp), intent(in) :: stiffness(0:2, 2), overlap(0:2, 2)
    real(dp), intent(inout) :: peak
    real(dp) :: load(0:2, 2), c(0:5)

    load(0, :) = stiffness(0, :)*overlap(0, :)
    load(1, :) = stiffness(1, :)*overlap(0, :) + stiffness(0, :)*overlap(1, :)
    peak = max(peak, load(0, 1), load(0, 2))
    if (.not. (load(1, 1) > 0 .and. load(1, 2) < 0)) return
    ! Between its ends a concave load stays below its tangents.
    if (maxval(load(0, :)) + (load(1, 1) - load(1, 2))/4 <= peak) return
    load(2, :) = stiffness(2, :)*overlap(0, :) + 2*stiffness(1, :)*overlap(1, :) + stiffness(0, :)*overlap(2, :)
    c = quintic(load(:, 1), load(:, 2))
    peak = max(peak, value_of(c, top_of(c)))
  end subroutine track
end module gearsweep_step
