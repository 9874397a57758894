!> A smooth interval of the mesh: a part of the mesh period within which no coefficient has a break, and the pairs that may be in
!> contact in it.
module gearsweep_interval
  use gearsweep_kinds, only: dp
  implicit none
  private
  public :: interval_t, distinct_phases, phase_of

  !> A smooth interval: a part of the mesh period within which no coefficient has a break. Where pairs of teeth have errors of
  !> their own, a part of one of the mesh periods after which these repeat.
  type :: interval_t
    integer :: period = 0                        !< which, from 0
    real(dp) :: first = 0, last = 0              !< phases
    integer :: pairs = 0                         !< that may be in contact
    integer :: offset = 0                        !< path coordinate of the first of them less the phase
    integer, allocatable :: piece(:, :)          !< first and last of the profile error; (2, pair)
    integer, allocatable :: stiffness_piece(:, :)    !< first and last of the stiffness; (2, pair)
    logical, allocatable :: recess(:)            !< the pair has passed the pitch point
    logical, allocatable :: between(:)           !< the pair is between A and E
    !> What a pair shares with the next one (m/N), as a polynomial of the phase; (0:2, pair but the last, at least one).
    real(dp), allocatable :: shared(:, :)
    logical, allocatable :: carries(:)           !< in the reference contact: all, or those that carry a static load
    !> What the profile error of each pair is more by its teeth (m), as a polynomial of s; (0:degree, pair). Not allocated where no
    !> tooth deviates.
    real(dp), allocatable :: deviation(:, :)
  contains
    procedure :: place
    procedure :: shared_at
    procedure :: shared_by_two
    procedure :: shared_with_slopes
    procedure :: deviation_of
  end type interval_t

  !> Breaks closer than this are one: no step could tell them apart.
  real(dp), parameter :: same_phase = 1e-11_dp

contains

  !> Path coordinate of pair j of an interval.
  elemental real(dp) function place(interval, phase, j) result(s)
    class(interval_t), intent(in) :: interval
    real(dp), intent(in) :: phase
    integer, intent(in) :: j

    s = phase + (j + interval%offset) - 1
  end function place

  !> What each pair of an interval and the next one share, m/N; (pair but the last, at least one).
  pure function shared_at(interval, phase) result(shared)
    class(interval_t), intent(in) :: interval
    real(dp), intent(in) :: phase
    real(dp) :: shared(size(interval%shared, 2))

    shared = interval%shared(0, :) + phase*(interval%shared(1, :) + phase*interval%shared(2, :))
  end function shared_at

  !> What the first two pairs share, m/N.
  elemental real(dp) function shared_by_two(interval, phase) result(shared)
    class(interval_t), intent(in) :: interval
    real(dp), intent(in) :: phase

    shared = interval%shared(0, 1) + phase*(interval%shared(1, 1) + phase*interval%shared(2, 1))
  end function shared_by_two

  !> What each pair of an interval and the next one share, with its first and second derivative over the phase, m/N;
  !> (0:2, pair but the last, at least one).
  pure function shared_with_slopes(interval, phase) result(c)
    class(interval_t), intent(in) :: interval
    real(dp), intent(in) :: phase
    real(dp) :: c(0:2, size(interval%shared, 2))

    c(0, :) = interval%shared_at(phase)
    c(1, :) = interval%shared(1, :) + 2*phase*interval%shared(2, :)
    c(2, :) = 2*interval%shared(2, :)
  end function shared_with_slopes

  !> What that is more by the teeth of pair j (m), waves aside, with its first and second derivative over the phase; (0:2).
  pure function deviation_of(interval, phase, j) result(d)
    class(interval_t), intent(in) :: interval    !< with deviations
    real(dp), intent(in) :: phase
    integer, intent(in) :: j
    real(dp) :: d(0:2), s
    integer :: n

    s = interval%place(phase, j)
    d = 0
    do n = ubound(interval%deviation, 1), 0, -1
      d(2) = d(2)*s + 2*d(1)
      d(1) = d(1)*s + d(0)
      d(0) = d(0)*s + interval%deviation(n, j)
    end do
  end function deviation_of

  !> Mesh phase of a path coordinate.
  elemental real(dp) function phase_of(s) result(phase)
    real(dp), intent(in) :: s                    !< base pitches

    phase = s - floor(s)
  end function phase_of

  !> These phases, 0 and 1, ascending, without what is the same; 0 and 1 stay exact.
  pure function distinct_phases(values) result(list)
    real(dp), intent(in) :: values(:)            !< phases, 0 to 1
    real(dp), allocatable :: list(:)
    real(dp) :: next

    list = [0.0_dp]
    do
      next = minval(values, mask=values > list(size(list)) + same_phase)
      if (next > 1 - same_phase) exit
      list = [list, next]
    end do
    list = [list, 1.0_dp]
  end function distinct_phases
end module gearsweep_interval
