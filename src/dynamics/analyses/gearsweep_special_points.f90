!> Where a branch of periodic motions changes its kind: folds (a multiplier passes 1, and the branch turns back over the
!> parameter), doublings (a multiplier passes -1) and grazing (an overlap passes 0, so that a contact begins or ends).
!>
!> Between two neighbouring points of the branch, the point over a place on their chord is found by Newton's method in the
!> plane normal to the chord. The place where a test function of it passes zero is enclosed and narrowed by the Illinois
!> method with bisections between. At corners of the branch a test function may jump over zero; there, the corner is enclosed.
module gearsweep_special_points
  use gearsweep_arclength, only: correct
  use gearsweep_branch, only: branch_point_t, measure
  use gearsweep_kinds, only: dp
  use gearsweep_motion_equations, only: kind_doubling, kind_fold, kind_grazing, motion_equations_t, motion_t
  use gearsweep_overlaps, only: overlap_t
  implicit none
  private
  public :: special_t, find_specials

  type :: special_t
    integer :: kind = 0
    integer :: after = 0                         !< the point of the branch before it
    type(branch_point_t) :: point
    type(overlap_t) :: overlap                   !< of grazing; contact 0: not known
    real(dp) :: enclosed = 0                     !< the place is known to this, of the parameter's unknown
    real(dp) :: start(3) = 0                     !< of `point`, with its parameter: a solution of the equations
  end type special_t

  !> A stretch of the branch over its chord.
  type :: stretch_t
    real(dp) :: from(3) = 0, chord(3) = 0, normal(3) = 0, length = 0
    real(dp) :: jacobian(2, 3) = 0
    integer :: kind = 0
    integer :: events = 0                        !< changes of contact at its begin
    logical :: by_overlap = .false.              !< grazing by the overlap `sought`; otherwise, by the changes of contact
    type(overlap_t) :: sought
    real(dp) :: sign = 1                         !< which makes the test function positive at its begin
  end type stretch_t

  !> A part of the chord below which rounding rules.
  real(dp), parameter :: finest = 1e-15_dp

contains

  !> All between two neighbouring points of a branch, appended.
  subroutine find_specials(equations, sense, after, a, b, specials)
    class(motion_equations_t), intent(inout) :: equations
    integer, intent(in) :: sense                 !< in which the branch is followed
    integer, intent(in) :: after                 !< which point `a` is
    type(branch_point_t), intent(in) :: a, b
    type(special_t), allocatable, intent(inout) :: specials(:)
    type(stretch_t) :: stretch
    real(dp) :: from, next
    integer :: kind, i
    logical :: ok
    integer, parameter :: most = 6               ! grazings between two points

    call equations%settle_steps(a%z, ok)
    if (.not. ok .or. .not. norm2(b%z - a%z) > 0) return
    stretch = stretch_t(a%z, b%z - a%z, (b%z - a%z)/norm2(b%z - a%z), norm2(b%z - a%z), a%jacobian, events=a%events)
    do kind = kind_fold, kind_doubling
      stretch%kind = kind
      stretch%sign = sign(1.0_dp, a%test(kind))
      if (a%test(kind)*b%test(kind) < 0) call locate(equations, sense, after, stretch, 0.0_dp, next, specials)
    end do
    stretch%kind = kind_grazing
    from = 0
    do i = 1, most
      if (stretch%events == b%events) exit
      stretch%by_overlap = .false.
      stretch%sign = 1
      call locate(equations, sense, after, stretch, from, next, specials)
      if (.not. next < 1) exit
      from = next
    end do
  end subroutine find_specials

  !> Narrows the place between `first` and the end of the stretch, and tells what is there. For grazing, `next` is just beyond
  !> it, and the stretch's changes of contact are those there.
  subroutine locate(equations, sense, after, stretch, first, next, specials)
    class(motion_equations_t), intent(inout) :: equations
    integer, intent(in) :: sense, after
    type(stretch_t), intent(inout) :: stretch
    real(dp), intent(in) :: first
    real(dp), intent(out) :: next
    type(special_t), allocatable, intent(inout) :: specials(:)
    integer, parameter :: most = 120, bisections = 8
    real(dp) :: low, high, at, value(2), middle
    type(special_t) :: found
    type(motion_t) :: motion
    real(dp) :: z(3)
    integer :: trial, last
    logical :: ok

    low = first
    high = 1
    next = 1
    value = [1.0_dp, -1.0_dp]
    last = 0
    do trial = 1, most
      at = (low + high)/2
      if (trial > bisections .and. modulo(trial, 4) /= 0 .and. (stretch%kind /= kind_grazing .or. stretch%by_overlap)) &
        at = low + (high - low)*value(1)/(value(1) - value(2))
      if (.not. (at > low .and. at < high)) at = (low + high)/2
      call test_at(equations, stretch, at, z, motion, middle, ok)
      if (.not. ok) return
      if (middle > 0) then
        low = at
        value(1) = middle
        if (last == 1) value(2) = value(2)/2
        last = 1
      else
        high = at
        value(2) = middle
        if (last == 2) value(1) = value(1)/2
        last = 2
      end if
      if (trial == bisections .and. stretch%kind == kind_grazing) call choose_overlap(equations, stretch, low, high, value)
      if (high - low <= max(finest, 1e-14_dp/stretch%length) .or. .not. abs(middle) > 1e-15_dp) exit
    end do
    call test_at(equations, stretch, high, z, motion, middle, ok)
    if (.not. ok) return
    found = special_t(stretch%kind, after, enclosed=(high - low)*abs(stretch%chord(3)), start=z)
    if (stretch%kind == kind_grazing) then
      if (stretch%by_overlap) found%overlap = stretch%sought
      next = min(1.0_dp, high + max(4*(high - low), 1e-9_dp))
      call test_at(equations, stretch, next, z, motion, middle, ok)
      if (.not. ok) return
      stretch%events = motion%events
    end if
    call measure(equations, found%start, sense, found%point, ok)
    if (ok) specials = [specials, found]
  end subroutine locate

  !> The branch over a place on the chord, and the test function there, positive as at the begin of the stretch.
  subroutine test_at(equations, stretch, place, z, motion, value, ok)
    class(motion_equations_t), intent(inout) :: equations
    type(stretch_t), intent(in) :: stretch
    real(dp), intent(in) :: place                ! 0 to 1
    real(dp), intent(out) :: z(3)
    type(motion_t), intent(out) :: motion
    real(dp), intent(out) :: value
    logical, intent(out) :: ok
    real(dp) :: jacobian(2, 3)

    z = stretch%from + place*stretch%chord
    jacobian = stretch%jacobian
    value = 0
    call correct(equations, stretch%normal, max(stretch%length, 1e-9_dp), jacobian, z, ok)
    if (ok) call equations%run_motion(z, stretch%kind == kind_grazing, motion, ok)
    if (.not. ok) return
    if (stretch%kind == kind_grazing .and. .not. stretch%by_overlap) then
      value = merge(1, -1, motion%events == stretch%events)
    else
      call value_of(equations, stretch, motion, value)
      value = stretch%sign*value
    end if
  end subroutine test_at

  !> The test function of the stretch's kind; where its overlap is not found, whether contact changes as at the begin decides.
  subroutine value_of(equations, stretch, motion, value)
    class(motion_equations_t), intent(inout) :: equations
    type(stretch_t), intent(in) :: stretch
    type(motion_t), intent(in) :: motion
    real(dp), intent(out) :: value
    logical :: ok

    equations%kind = stretch%kind
    equations%overlap = stretch%sought
    call equations%special_value(motion, value, ok)
    equations%kind = 0
    if (.not. ok) value = stretch%sign*merge(1, -1, motion%events == stretch%events)
  end subroutine value_of

  !> The overlap that passes zero between two places: of those of one contact that have different signs there, the one that is
  !> nearest to zero at both.
  subroutine choose_overlap(equations, stretch, low, high, value)
    class(motion_equations_t), intent(inout) :: equations
    type(stretch_t), intent(inout) :: stretch
    real(dp), intent(in) :: low, high
    real(dp), intent(inout) :: value(2)          ! of the test function at both
    real(dp), parameter :: nearby = 0.02_dp
    type(motion_t) :: at_low, at_high
    real(dp) :: z(3), best, now, found(2)
    integer :: i, k
    logical :: ok

    call test_at(equations, stretch, low, z, at_low, now, ok)
    if (ok) call test_at(equations, stretch, high, z, at_high, now, ok)
    if (.not. ok) return
    best = huge(best)
    do i = 1, at_low%overlaps%count
      do k = 1, at_high%overlaps%count
        associate (a => at_low%overlaps%list(i), b => at_high%overlaps%list(k))
          if (a%contact /= b%contact .or. a%period /= b%period .or. (a%at_break .neqv. b%at_break)) cycle
          if (abs(a%phase - b%phase) > nearby .or. .not. a%value*b%value < 0) cycle
          now = abs(a%value) + abs(b%value)
          if (now >= best) cycle
          best = now
          stretch%by_overlap = .true.
          stretch%sought = b
          stretch%sign = sign(1.0_dp, a%value)
          found = abs([a%value, b%value])*[1, -1]/equations%scale(1)
        end associate
      end do
    end do
    if (stretch%by_overlap) value = found
  end subroutine choose_overlap
end module gearsweep_special_points
