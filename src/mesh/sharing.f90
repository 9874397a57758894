!> Static load sharing over the mesh period: the load of each pair and the static transmission error.
!>
!> The result is smooth within segments that end where a pair enters, leaves, separates or returns, where a relief begins, and
!> where the stiffness changes from one polynomial to the next.
!>
!> The pairs are springs in parallel; the compliance of the discs of complete gears, which two pairs share, is one spring in
!> series, which no relief or load share changes. Three pairs and more share different compliances, neighbours more than others:
!> then a matrix has the deflection of each pair under each load.
module gearsweep_mesh_sharing
  use gearsweep_base, only: bracket_t, dp, solve_small
  use gearsweep_mesh_deviations, only: distinct_phases, interval_t, phase_of
  use gearsweep_mesh_mesh, only: coupling, joint_stiffness, mesh_t
  use gearsweep_mesh_smooth_intervals, only: smooth_intervals
  implicit none
  private
  public :: balance_t, segment_t, smooth_segments, contact_intervals, carrying, sharing_t, share_load, load_share, pairs_at, &
            solve_equilibrium_at, share_apart, transmission_error

  type :: segment_t
    real(dp) :: first = 0, last = 0              !< phases
    integer :: interval = 0                          !< index of its interval
  end type segment_t

  !> Equilibrium of the pairs' loads: with a static load or, with friction, with the acceleration it causes, to which each pair
  !> contributes by its `mobility`.
  type :: balance_t
    real(dp) :: load = 0                         !< N
    real(dp) :: friction = 0                     !< mu
    real(dp) :: mass(2) = 1                      !< masses of pinion and gear, for friction only, kg
  end type balance_t

  !> Breaks closer than this count as one.
  real(dp), parameter :: same_phase = 1e-12_dp

  !> Static state along the mesh period or, if teeth deviate, the periods after which the deviations repeat; one-sided at every
  !> break.
  type :: sharing_t
    real(dp), allocatable :: phase(:)            !< ascending, breaks twice; from 0, in mesh periods
    real(dp), allocatable :: error(:)            !< static transmission error, m
    real(dp), allocatable :: stiffness(:)        !< stiffness of the loaded pairs and the discs, N/m
    real(dp), allocatable :: s(:, :)             !< path coordinate of each pair; 2nd index as phase
    real(dp), allocatable :: load(:, :)          !< load of each pair, N; 0 where separated
    integer, allocatable :: pairs(:)             !< number of pairs that may be in contact
    integer, allocatable :: offset(:)            !< path coordinate of the first of them minus the phase
  end type sharing_t

contains

  !> Finds the segments under a static `load` (N), ascending, from phase 0 to 1, and the mesh's smooth intervals.
  pure subroutine smooth_segments(mesh, load, intervals, segments)
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: load
    type(interval_t), allocatable, intent(out) :: intervals(:)
    type(segment_t), allocatable, intent(out) :: segments(:)

    intervals = smooth_intervals(mesh, .false.)
    call split(mesh, balance_t(load), intervals, .true., segments)
  end subroutine smooth_segments

  !> Smooth intervals of a mesh, split also where a pair begins or ceases to carry static load, each with its loaded pairs.
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

  !> Splits intervals where a pair begins or ceases to carry static load and, if wanted, where one passes a knot of the stiffness.
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
    integer, parameter :: most_looks = 8         ! of an interval without knots
    real(dp), allocatable :: list(:)
    real(dp) :: from, until
    integer :: i, j, k, looks, n

    do i = 1, size(intervals)
      if (at_knots) then
        breaks(i)%of = distinct_phases(phase_of(mesh%stiffness%breaks), intervals(i)%first, intervals(i)%last, same_phase)
      else
        breaks(i)%of = [intervals(i)%first, intervals(i)%last]
      end if
      if (intervals(i)%pairs == 1) cycle
      ! Between two breaks the set of loaded pairs is checked at a few places; a change and its reverse between them are too short
      ! to matter.
      associate (of => breaks(i)%of)
        list = [of, of]
        n = 1
        do j = 1, size(of) - 1
          from = of(j)
          looks = ceiling(most_looks*(of(j + 1) - of(j))/(intervals(i)%last - intervals(i)%first))
          do k = 1, looks
            until = of(j) + (of(j + 1) - of(j))*k/looks
            call find_changes(mesh, balance, intervals(i), from, until, list, n)
            from = until
          end do
          if (of(j + 1) < list(n) + same_phase) n = n - 1
          call append(list, n, of(j + 1))
        end do
      end associate
      breaks(i)%of = list(:n)
    end do
    segments = [((segment_t(breaks(i)%of(k), breaks(i)%of(k + 1), i), k=1, size(breaks(i)%of) - 1), i=1, size(intervals))]
  end subroutine split

  !> Appends to the first `n` of a list, which grows in linear time.
  pure subroutine append(list, n, value)
    real(dp), allocatable, intent(inout) :: list(:)
    integer, intent(inout) :: n
    real(dp), intent(in) :: value

    if (n == size(list)) list = [list, list]
    n = n + 1
    list(n) = value
  end subroutine append

  !> Adds the changes between `from` and `until` to the first `listed` of `list`. Gaps that are only rounding errors change
  !> without end; they do not matter.
  pure subroutine find_changes(mesh, balance, interval, from, until, list, listed)
    type(mesh_t), intent(in) :: mesh
    type(balance_t), intent(in) :: balance
    real(dp), intent(in) :: from, until
    type(interval_t), intent(in) :: interval
    real(dp), allocatable, intent(inout) :: list(:)
    integer, intent(inout) :: listed
    integer, parameter :: most = 8
    logical, dimension(interval%pairs) :: before, after
    type(bracket_t) :: change
    integer :: n

    before = carrying(mesh, balance, interval, from)
    after = carrying(mesh, balance, interval, until)
    change = bracket_t(from, until)
    do n = 1, most
      if (all(before .eqv. after)) return
      do while (change%is_open())
        call change%halve(all(carrying(mesh, balance, interval, change%middle()) .eqv. before))
      end do
      if (change%high > list(listed) + same_phase) call append(list, listed, change%high)
      before = carrying(mesh, balance, interval, change%high)
      change = bracket_t(change%high, until)
    end do
  end subroutine find_changes

  !> True for the pairs that carry static load at a phase of `interval`.
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
      ! The weights are near 1 and near each other, so that this converges in a few iterations.
      last = load
      load = balance%load*last/sum(weight*force)
      if (abs(load - last) <= rounding*load) exit
    end do
    carrying = force > 0
  end function carrying

  !> Finds the common deflection (m) of pairs that are springs apart, and the load (N) of each, 0 if it is open: together they
  !> carry the nominal `load` (N). `stiffness` (N/m) and `error` (m) of the pairs, any number; `flattening` (m/N) as in `approach`.
  !>
  !> Without flattening each load is K_j max(0, x - e_j), in closed form. With it, Newton's method follows from there, on all loads
  !> and the deflection at once.
  pure subroutine share_apart(stiffness, error, load, flattening, deflection, force)
    real(dp), intent(in) :: stiffness(:), error(:), load, flattening(:)    !< (pair)
    real(dp), intent(out) :: deflection
    real(dp), intent(out) :: force(:)            !< (pair)
    ! Newton's method squares a relative change; a load of rounding errors alone may come and go without end.
    real(dp), parameter :: near = 1e-8_dp, rounding = 1e-15_dp
    integer, parameter :: most = 50
    logical :: carries(size(stiffness))
    real(dp), dimension(size(stiffness)) :: before, slope
    real(dp) :: change
    integer :: i, last

    carries = .true.
    deflection = 0
    do i = 1, size(stiffness)
      deflection = (load + sum(stiffness*error, mask=carries))/sum(stiffness, mask=carries)
      ! One pair at a time: the deflection rises when a pair drops out, which may keep the next one.
      last = maxloc(error, 1, mask=carries)
      if (deflection > error(last)) exit
      carries(last) = .false.
    end do
    force = stiffness*max(0.0_dp, deflection - error)
    if (.not. any(flattening > 0)) return
    do i = 1, most
      before = force
      call approach(deflection - error, stiffness, load, flattening, force, slope)
      change = (load - sum(force))/sum(slope)
      deflection = deflection + change
      force = max(0.0_dp, force + slope*change)
      if (all(abs(force - before) <= near*force + rounding*load) .and. abs(change)*sum(slope) <= near*load) exit
    end do
  end subroutine share_apart

  !> Brings the load F (N) of a pair compressed by `depth` (m) nearer to the solution of
  !> depth = F (1/K - flattening log(F/nominal)) by one step of Newton's method, and computes the slope dF/d depth (N/m) at the
  !> former load; an open pair has none. K (N/m) is the secant stiffness at the `nominal` load (N).
  !> Source: Johnson 1985, Contact Mechanics, Eq. 5.57.
  elemental subroutine approach(depth, stiffness, nominal, flattening, force, slope)
    real(dp), intent(in) :: depth, stiffness, nominal, flattening
    real(dp), intent(inout) :: force             !< 0 if the pair was open
    real(dp), intent(out) :: slope
    real(dp), parameter :: least = 1e-250_dp

    if (.not. depth > 0) then
      force = 0
      slope = 0
      return
    end if
    if (.not. force > 0) force = stiffness*depth
    if (flattening > 0 .and. force > least*nominal) then
      slope = 1/(1/stiffness - flattening*(1 + log(force/nominal)))
      force = (depth - flattening*force)*slope
    else
      slope = stiffness
      force = stiffness*depth
    end if
  end subroutine approach

  !> Computes the common deflection (m), without the turning of discs, and the loads (N) of neighbouring pairs that carry the
  !> nominal `load` (N) together. `stiffness` (N/m) is that of each pair while it carries alone, `flattening` (m/N) as in
  !> `approach`, `error` (m) its profile error, `shared` (m/N) the compliance shared with the next pair.
  pure subroutine solve_equilibrium(mesh, load, stiffness, flattening, error, shared, deflection, force)
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: load
    real(dp), intent(in) :: stiffness(:), flattening(:), error(:)     !< (pair)
    real(dp), intent(in) :: shared(:)                      !< (pair but the last, at least one)
    real(dp), intent(out) :: deflection
    real(dp), intent(out) :: force(:)                      !< (pair); 0 for an open pair

    if (mesh%is_coupled(size(stiffness))) then
      call solve_coupled(coupling(mesh, stiffness, shared), error, load, flattening, deflection, force)
    else
      call share_apart(stiffness/(1 - shared(1)*stiffness), error, load, flattening, deflection, force)
      deflection = deflection + shared(1)*load
    end if
  end subroutine solve_equilibrium

  !> Solves the equilibrium of pairs coupled by the matrix `compliance` (m/N), whose diagonal is that of each pair alone: each
  !> load is that of `approach` at the deflection minus that due to the other loads. Newton's method on all loads and the
  !> deflection; the loads' slopes jump where a pair parts, so that it may alternate there: then it makes half a step.
  pure subroutine solve_coupled(compliance, error, load, flattening, deflection, force)
    real(dp), intent(in) :: compliance(:, :), error(:), load, flattening(:)
    real(dp), intent(out) :: deflection, force(:)
    real(dp), parameter :: rounding = 1e-14_dp, near = 1e-10_dp
    integer, parameter :: most = 200, whole_steps = 20
    real(dp), dimension(size(error)) :: own, depth, carried, slope
    real(dp) :: matrix(size(error) + 1, size(error) + 1), step(size(error) + 1, 1)
    integer :: i, j, n

    n = size(error)
    own = [(compliance(j, j), j=1, n)]
    force = load/n
    deflection = maxval(error) + load*maxval(own)
    do i = 1, most
      depth = deflection - error - matmul(compliance, force) + own*force
      carried = force
      call approach(depth, 1/own, load, flattening, carried, slope)
      matrix = 0
      do j = 1, n
        matrix(j, :n) = slope(j)*compliance(j, :)
        matrix(j, j) = 1
        matrix(j, n + 1) = -slope(j)
      end do
      matrix(n + 1, :n) = 1
      step(:n, 1) = carried - force
      step(n + 1, 1) = load - sum(force)
      call solve_small(matrix, step)
      if (i > whole_steps) step = step/2
      force = force + step(:n, 1)
      deflection = deflection + step(n + 1, 1)
      ! One pair alone has its load at once, but not its deflection, which may bring others into contact.
      if (all(abs(step(:n, 1)) <= rounding*load) .and. abs(step(n + 1, 1)) <= near*load*maxval(own)) exit
    end do
    where (.not. depth > 0) force = 0
  end subroutine solve_coupled

  !> Computes the deflection (m), without the turning of discs, and loads (N) of the pairs at a phase of `interval`, one-sided at
  !> its ends.
  pure subroutine solve_equilibrium_at(mesh, interval, load, phase, deflection, force)
    type(mesh_t), intent(in) :: mesh
    type(interval_t), intent(in) :: interval
    real(dp), intent(in) :: load, phase
    real(dp), intent(out) :: deflection
    real(dp), intent(out) :: force(interval%pairs)
    real(dp), dimension(interval%pairs) :: stiffness, flattening, error
    integer :: j

    call pairs_at(mesh, interval, phase, stiffness, error)
    flattening = mesh%flattening%at(interval%place(phase, [(j, j=1, interval%pairs)]), mesh%contact_ratio)
    call solve_equilibrium(mesh, load, stiffness, flattening, error, interval%shared_at(phase), deflection, force)
  end subroutine solve_equilibrium_at

  !> Finds the stiffness (N/m) of each pair while it carries alone, and its profile error (m), at a phase of `interval`, one-sided
  !> at its ends.
  pure subroutine pairs_at(mesh, interval, phase, stiffness, error)
    type(mesh_t), intent(in) :: mesh
    type(interval_t), intent(in) :: interval
    real(dp), intent(in) :: phase
    real(dp), intent(out) :: stiffness(interval%pairs), error(interval%pairs)
    integer :: j

    do j = 1, interval%pairs
      associate (s => interval%place(phase, j))
        stiffness(j) = mesh%stiffness%value(s, mesh%stiffness%locate(s, interval%stiffness_piece(:, j)))
        error(j) = mesh%error_at(interval, phase, j)
      end associate
    end do
  end subroutine pairs_at

  !> Static transmission error (m) under `load` (N) at a phase of `interval`.
  pure real(dp) function transmission_error(mesh, interval, load, phase)
    type(mesh_t), intent(in) :: mesh
    type(interval_t), intent(in) :: interval
    real(dp), intent(in) :: load, phase
    real(dp) :: force(interval%pairs)

    call solve_equilibrium_at(mesh, interval, load, phase, transmission_error, force)
    transmission_error = transmission_error + mesh%disc%turn*load
  end function transmission_error

  !> Samples each mesh period with about `samples` points: between the breaks of the mesh, or of known `intervals` as from
  !> `contact_intervals` of gearsweep_mesh_sharing, which also end where pairs begin and cease to carry. Source: Dogan et al.
  !> 2021, Eqs. 7, 8, with separation.
  pure subroutine share_load(mesh, load, samples, sharing, known)
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: load
    integer, intent(in) :: samples
    type(sharing_t), intent(out) :: sharing
    type(interval_t), intent(in), optional :: known(:)     !< intervals of the full period
    type(interval_t), allocatable :: intervals(:)
    integer, allocatable :: counts(:)
    integer :: i, k, row

    if (present(known)) then
      intervals = known
    else
      intervals = smooth_intervals(mesh, .false.)
    end if
    counts = [(1 + max(1, nint(samples*(intervals(i)%last - intervals(i)%first))), i=1, size(intervals))]
    associate (n => sum(counts), most => maxval(intervals%pairs))
      allocate (sharing%phase(n), sharing%error(n), sharing%stiffness(n), sharing%pairs(n), sharing%offset(n))
      allocate (sharing%s(most, n), sharing%load(most, n), source=0.0_dp)
    end associate
    row = 0
    do i = 1, size(intervals)
      do k = 0, counts(i) - 1
        row = row + 1
        associate (phase => intervals(i)%first + (intervals(i)%last - intervals(i)%first)*k/(counts(i) - 1))
          call share_at(mesh, intervals(i), load, phase, row, sharing)
        end associate
      end do
    end do
  end subroutine share_load

  pure subroutine share_at(mesh, interval, load, phase, row, sharing)
    type(mesh_t), intent(in) :: mesh
    type(interval_t), intent(in) :: interval
    real(dp), intent(in) :: load, phase
    integer, intent(in) :: row
    type(sharing_t), intent(inout) :: sharing
    real(dp), dimension(interval%pairs) :: stiffness, error, force
    real(dp) :: deflection, pairs
    integer :: j

    sharing%phase(row) = interval%period + phase
    sharing%offset(row) = interval%offset
    sharing%s(:interval%pairs, row) = interval%place(phase, [(j, j=1, interval%pairs)])
    sharing%pairs(row) = interval%pairs
    call solve_equilibrium_at(mesh, interval, load, phase, deflection, force)
    sharing%error(row) = deflection + mesh%disc%turn*load
    sharing%load(:interval%pairs, row) = force
    call pairs_at(mesh, interval, phase, stiffness, error)
    pairs = joint_stiffness(mesh, stiffness, interval%shared_at(phase), force > 0)
    sharing%stiffness(row) = pairs/(1 + mesh%disc%turn*pairs)
  end subroutine share_at

  !> Share of `load` (N) on the pair at path coordinate `s`.
  pure real(dp) function load_share(mesh, load, s)
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: load, s
    real(dp), allocatable :: stiffness(:), flattening(:), error(:), shared(:, :), force(:)
    real(dp) :: place, deflection
    integer :: before, after, j

    ! Numbers of pairs before and after this one.
    before = max(0, floor(s - mesh%reach(1)))
    after = max(0, ceiling(mesh%reach(2) - s) - 1)
    allocate (stiffness(-before:after), flattening(-before:after), error(-before:after), force(-before:after))
    allocate (shared(0:2, -before:max(after - 1, -before)))
    do j = -before, after
      place = s - floor(s) + (floor(s) + j + 1) - 1
      stiffness(j) = mesh%stiffness%value(place, mesh%stiffness%locate(place))
      flattening(j) = mesh%flattening%at(place, mesh%contact_ratio)
      error(j) = mesh%profile_error%value(place)
      if (j <= ubound(shared, 2)) shared(:, j) = mesh%shared_from(place)
    end do
    call solve_equilibrium(mesh, load, stiffness, flattening, error, shared(0, :), deflection, force)
    load_share = force(0)/load
  end function load_share
end module gearsweep_mesh_sharing
