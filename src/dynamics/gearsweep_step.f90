!> One Runge-Kutta step of the motion, the pieces that the period and the
!> location of contact changes share.
!>
!> The state is x (m) and its derivative y over the mesh phase (m).
module gearsweep_step
  use gearsweep_kinds, only: dp
  use gearsweep_motion, only: oscillator_t
  implicit none
  private
  public :: period_t, walk_t, step_t, advance, advance_map, decay_over, blend, note_contact
  public :: may_change, turning_point, track

  !> What one period does.
  type :: period_t
    real(dp) :: state(2) = 0           !< at the end of the period
    real(dp) :: map(2, 2) = 0          !< derivative of that by the initial state
    real(dp) :: decay = 0              !< -log of the map's determinant: the integral of the drag
    real(dp) :: peak = 0               !< largest load on one pair, N
    integer :: events = 0              !< changes of contact within the period
    real(dp) :: work = 0               !< what it cost, in Runge-Kutta steps
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
  end type walk_t

  !> Coefficients of y' = push - square x - drag y at the three places of a step.
  type :: step_t
    real(dp) :: push(3), square(3), drag(3), width
  end type step_t

contains

  !> Coefficients for the members in contact.
  pure subroutine blend(osc, rate, error, contact, duration, step)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: rate(:, :), error(:, :), duration
    logical, intent(in) :: contact(:)
    type(step_t), intent(inout) :: step
    integer :: place

    do place = 1, 3
      step%square(place) = sum(rate(:, place), mask=contact)
      step%push(place) = sum(rate(:, place)*error(:, place), mask=contact) + osc%load*sum(1/osc%mass)
    end do
    step%drag = 2*osc%damping_ratio*duration*sqrt(step%square)
    step%push = step%push*duration**2
    step%square = step%square*duration**2
  end subroutine blend

  !> One Runge-Kutta step of the state.
  pure subroutine advance(step, x, y)
    type(step_t), intent(in) :: step
    real(dp), intent(inout) :: x, y
    real(dp) :: h, x2, x3, x4, y2, y3, y4, a1, a2, a3, a4

    h = step%width
    a1 = step%push(1) - step%square(1)*x - step%drag(1)*y
    x2 = x + h/2*y
    y2 = y + h/2*a1
    a2 = step%push(2) - step%square(2)*x2 - step%drag(2)*y2
    x3 = x + h/2*y2
    y3 = y + h/2*a2
    a3 = step%push(2) - step%square(2)*x3 - step%drag(2)*y3
    x4 = x + h*y3
    y4 = y + h*a3
    a4 = step%push(3) - step%square(3)*x4 - step%drag(3)*y4
    x = x + h/6*(y + 2*(y2 + y3) + y4)
    y = y + h/6*(a1 + 2*(a2 + a3) + a4)
  end subroutine advance

  !> The same step of the map's two columns, which nothing pushes.
  pure subroutine advance_map(step, map)
    type(step_t), intent(in) :: step
    real(dp), intent(inout) :: map(2, 2)
    type(step_t) :: free

    free = step
    free%push = 0
    call advance(free, map(1, 1), map(2, 1))
    call advance(free, map(1, 2), map(2, 2))
  end subroutine advance_map

  !> Integral of the drag over the step.
  pure real(dp) function decay_over(step)
    type(step_t), intent(in) :: step

    decay_over = step%width/6*(step%drag(1) + 4*step%drag(2) + step%drag(3))
  end function decay_over

  !> Notes that not every pair carries.
  pure subroutine note_contact(osc, contact, out)
    type(oscillator_t), intent(in) :: osc
    logical, intent(in) :: contact(:)
    type(period_t), intent(inout) :: out

    out%partial = .true.
    out%flight = out%flight .or. .not. any(contact)
    if (osc%has_backlash) out%coast = out%coast .or. contact(size(contact))
  end subroutine note_contact

  !> Overlaps a, b and their slopes da, db at the ends: a change of sign, or a
  !> cubic between them that may dip through zero.
  pure logical function may_change(contact, a, b, da, db)
    logical, intent(in) :: contact
    real(dp), intent(in) :: a, b, da, db

    if (contact) then
      may_change = b < 0
      if (da < 0 .and. db > 0) may_change = may_change .or. min(a, b) < (db - da)*4/27
    else
      may_change = b > 0
      if (da > 0 .and. db < 0) may_change = may_change .or. max(a, b) > (db - da)*4/27
    end if
  end function may_change

  !> Place between 0 and 1 of the cubic's extremum.
  pure real(dp) function turning_point(value, slope) result(t)
    real(dp), intent(in) :: value(2), slope(2)
    real(dp) :: a, b

    a = slope(1) + slope(2) - 2*(value(2) - value(1))
    b = 3*(value(2) - value(1)) - 2*slope(1) - slope(2)
    ! Root of slope(1) + 2 b t + 3 a t^2 at which the slope changes sign as from left to right.
    t = slope(1)/(-b + sign(sqrt(max(0.0_dp, b**2 - 3*a*slope(1))), slope(1)))
    if (.not. (t > 0 .and. t < 1)) t = 0.5_dp
  end function turning_point

  !> Raises `peak` to the largest load of one pair over a stretch: the maximum
  !> of the cubic through the loads and their slopes at both ends.
  pure subroutine track(width, stiffness, stiffness_slope, overlap, overlap_slope, peak)
    real(dp), intent(in) :: width
    real(dp), dimension(2), intent(in) :: stiffness, stiffness_slope, overlap, overlap_slope
    real(dp), intent(inout) :: peak
    real(dp) :: load(2), slope(2), a, b, t

    load = stiffness*overlap
    peak = max(peak, load(1), load(2))
    slope = width*(stiffness_slope*overlap + stiffness*overlap_slope)
    if (.not. (slope(1) > 0 .and. slope(2) < 0)) return
    if (maxval(load) + (slope(1) - slope(2))*4/27 <= peak) return
    a = slope(1) + slope(2) - 2*(load(2) - load(1))
    b = 3*(load(2) - load(1)) - 2*slope(1) - slope(2)
    t = turning_point(load, slope)
    peak = max(peak, load(1) + t*(slope(1) + t*(b + t*a)))
  end subroutine track
end module gearsweep_step
