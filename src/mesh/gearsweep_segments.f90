!> The intervals of the mesh period on which the static state is smooth: between the
!> places where a pair enters, leaves, separates or comes back, where a relief begins,
!> and where the stiffness passes from one polynomial to the next.
module gearsweep_segments
  use gearsweep_interval, only: interval_t
  use gearsweep_kinds, only: dp
  use gearsweep_mesh, only: mesh_t
  use gearsweep_sharing, only: solve_equilibrium_at
  use gearsweep_smooth_intervals, only: smooth_intervals
  implicit none
  private
  public :: balance_t, segment_t, smooth_segments, contact_intervals, carrying

  type :: segment_t
    real(dp) :: first = 0, last = 0              !< phases
    integer :: interval = 0                          !< in which it lies
  end type segment_t

  !> What the pairs' loads are in balance with: a static load or, with friction, what that makes of the acceleration of a motion,
  !> in which each pair counts by its `mobility`.
  type :: balance_t
    real(dp) :: load = 0                         !< N
    real(dp) :: friction = 0                     !< mu
    real(dp) :: mass(2) = 1                      !< of pinion and gear, for friction alone, kg
  end type balance_t

  !> Breaks closer than this are one.
  real(dp), parameter :: same_phase = 1e-12_dp

contains

  !> The segments under a static `load` (N), ascending, from phase 0 to 1, and the mesh's smooth intervals.
  pure subroutine smooth_segments(mesh, load, intervals, segments)
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: load
    type(interval_t), allocatable, intent(out) :: intervals(:)
    type(segment_t), allocatable, intent(out) :: segments(:)

    intervals = smooth_intervals(mesh, .false.)
    call split(mesh, balance_t(load), intervals, .true., segments)
  end subroutine smooth_segments

  !> The smooth intervals of a mesh, split also where a pair begins or ceases to carry load at rest, each with the pairs that do.
  pure function contact_intervals(mesh, balance) result(intervals)
    type(mesh_t), intent(in) :: mesh
    type(balance_t), intent(in) :: balance
    type(interval_t), allocatable :: intervals(:)
    type(interval_t), allocatable :: whole(:)
    type(segment_t), allocatable :: segments(:)
    integer :: i

    whole = smooth_intervals(mesh, balance%friction > 0)
    call split(mesh, balance, whole, .false., segments)
    allocate (intervals(size(segments)))
    do i = 1, size(segments)
      associate (part => segments(i))
        intervals(i) = whole(part%interval)
        intervals(i)%first = part%first
        intervals(i)%last = part%last
        intervals(i)%carries = carrying(mesh, balance, whole(part%interval), (part%first + part%last)/2)
      end associate
    end do
  end function contact_intervals

  !> Splits intervals where a pair begins or ceases to carry load at rest and, if wanted, where one passes a knot of the stiffness.
  pure subroutine split(mesh, balance, intervals, at_knots, segments)
    type(mesh_t), intent(in) :: mesh
    type(balance_t), intent(in) :: balance
    type(interval_t), intent(in) :: intervals(:)
    logical, intent(in) :: at_knots
    type(segment_t), allocatable, intent(out) :: segments(:)
    type :: phases_t
      real(dp), allocatable :: of(:)
    end type phases_t
    type(phases_t) :: breaks(size(intervals))
    integer :: i, k

    do i = 1, size(intervals)
      if (at_knots) then
        call stiffness_breaks(mesh, intervals(i), breaks(i)%of)
      else
        breaks(i)%of = [intervals(i)%first, intervals(i)%last]
      end if
      call add_contact_breaks(mesh, balance, intervals(i), breaks(i)%of)
    end do
    segments = [((segment_t(breaks(i)%of(k), breaks(i)%of(k + 1), i), k=1, size(breaks(i)%of) - 1), i=1, size(intervals))]
  end subroutine split

  !> Ends of the interval, and the phases between at which a pair passes a knot of the stiffness.
  pure subroutine stiffness_breaks(mesh, interval, breaks)
    type(mesh_t), intent(in) :: mesh
    type(interval_t), intent(in) :: interval
    real(dp), allocatable, intent(out) :: breaks(:)
    real(dp), allocatable :: knots(:)
    real(dp) :: next

    knots = mesh%stiffness%breaks - floor(mesh%stiffness%breaks)
    breaks = [interval%first]
    do
      next = minval(knots, mask=knots > breaks(size(breaks)) + same_phase)
      if (.not. next < interval%last - same_phase) exit
      breaks = [breaks, next]
    end do
    breaks = [breaks, interval%last]
  end subroutine stiffness_breaks

  !> Adds the phases at which the set of pairs that carry changes. Between two breaks the set is
  !> looked at in a few places; what comes and goes between them is too short to matter.
  pure subroutine add_contact_breaks(mesh, balance, interval, breaks)
    type(mesh_t), intent(in) :: mesh
    type(balance_t), intent(in) :: balance
    type(interval_t), intent(in) :: interval
    real(dp), allocatable, intent(inout) :: breaks(:)
    integer, parameter :: looks = 8
    real(dp), allocatable :: list(:)
    real(dp) :: from, until
    integer :: i, k

    if (interval%pairs == 1) return
    list = [breaks(1)]
    do i = 1, size(breaks) - 1
      from = breaks(i)
      do k = 1, looks
        until = breaks(i) + (breaks(i + 1) - breaks(i))*k/looks
        call find_changes(mesh, balance, interval, from, until, list)
        from = until
      end do
      if (breaks(i + 1) < list(size(list)) + same_phase) list = list(:size(list) - 1)
      list = [list, breaks(i + 1)]
    end do
    call move_alloc(list, breaks)
  end subroutine add_contact_breaks

  !> Adds the changes between `from` and `until` to `list`. Gaps that are nothing but rounding
  !> errors change without end; they do not matter.
  pure subroutine find_changes(mesh, balance, interval, from, until, list)
    type(mesh_t), intent(in) :: mesh
    type(balance_t), intent(in) :: balance
    real(dp), intent(in) :: from, until
    type(interval_t), intent(in) :: interval
    real(dp), allocatable, intent(inout) :: list(:)
    integer, parameter :: most = 8
    logical, dimension(interval%pairs) :: before, behind
    real(dp) :: low, high, middle
    integer :: n

    before = carrying(mesh, balance, interval, from)
    behind = carrying(mesh, balance, interval, until)
    low = from
    do n = 1, most
      if (all(before .eqv. behind)) return
      high = until
      do
        middle = (low + high)/2
        if (.not. (middle > low .and. middle < high)) exit
        if (all(carrying(mesh, balance, interval, middle) .eqv. before)) then
          low = middle
        else
          high = middle
        end if
      end do
      if (high > list(size(list)) + same_phase) list = [list, high]
      before = carrying(mesh, balance, interval, high)
      low = high
    end do
  end subroutine find_changes

  !> Which pairs carry load at rest at a phase of `interval`.
  pure function carrying(mesh, balance, interval, phase)
    type(mesh_t), intent(in) :: mesh
    type(balance_t), intent(in) :: balance
    real(dp), intent(in) :: phase
    type(interval_t), intent(in) :: interval
    logical :: carrying(interval%pairs)
    real(dp), parameter :: rounding = 1e-14_dp
    integer, parameter :: most = 50
    real(dp), dimension(interval%pairs) :: force, weight
    real(dp) :: deflection, load, last
    integer :: i, j

    load = balance%load
    if (balance%friction > 0) then
      weight = [(mesh%mobility(balance%mass, balance%friction, interval%place(phase, j), interval%recess(j)), &
                 j=1, interval%pairs)]/sum(1/balance%mass)
    end if
    do i = 1, most
      call solve_equilibrium_at(mesh, interval, load, phase, deflection, force)
      if (.not. balance%friction > 0) exit
      ! The weights are near 1 and near each other, so that this comes to rest in a few turns.
      last = load
      load = balance%load*last/sum(weight*force)
      if (abs(load - last) <= rounding*load) exit
    end do
    carrying = force > 0
  end function carrying
end module gearsweep_segments
