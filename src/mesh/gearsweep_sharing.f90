!> Static load sharing: which pairs carry how much, and the static transmission error.
!>
!> The pairs stand beside each other, each with its own stiffness; what the discs of whole gears turn
!> and what two pairs share is one spring in series, which no relief or load share changes. Three pairs and more share different
!> compliances, neighbours more than others: what each load moves each pair by is a matrix then.
module gearsweep_sharing
  use gearsweep_interval, only: interval_t
  use gearsweep_kinds, only: dp
  use gearsweep_mesh, only: mesh_t, coupling, joint_stiffness
  use gearsweep_small_system, only: solve_small
  use gearsweep_smooth_intervals, only: smooth_intervals
  implicit none
  private
  public :: sharing_t, share_load, load_share, pairs_at, solve_equilibrium, solve_equilibrium_at, static_deflection, pair_load, &
            transmission_error

  !> The static state along the mesh period or, where teeth deviate, the periods after which the deviations repeat; one-sided at
  !> every break.
  type :: sharing_t
    real(dp), allocatable :: phase(:)            !< ascending, breaks twice; from 0, in mesh periods
    real(dp), allocatable :: error(:)            !< static transmission error, m
    real(dp), allocatable :: stiffness(:)        !< of the pairs that carry load and the discs, N/m
    real(dp), allocatable :: s(:, :)             !< path coordinate of each pair; 2nd index as phase
    real(dp), allocatable :: load(:, :)          !< load of each pair, N; 0 where separated
    integer, allocatable :: pairs(:)             !< that may be in contact
    integer, allocatable :: offset(:)            !< path coordinate of the first of them less the phase
  end type sharing_t

contains

  !> Common deflection x that carries the nominal `load` (N): the sum of the pairs' loads at x - e_j (see pair_load).
  !> `stiffness` (N/m) and `error` (m) of the pairs, any number; `flattening` (m/N; without it, 0) as in `pair_load`.
  !>
  !> Without flattening each load is K_j max(0, x - e_j), in closed form. With it, loads grow more than in proportion to
  !> the deflection: Newton's method, from its second step on, comes down to the solution from above without passing it.
  pure real(dp) function static_deflection(stiffness, error, load, flattening) result(x)
    real(dp), intent(in) :: stiffness(:), error(:), load
    real(dp), intent(in), optional :: flattening(:)
    real(dp), parameter :: rounding = 1e-14_dp
    integer, parameter :: most = 50
    logical :: carries(size(stiffness))
    real(dp), dimension(size(stiffness)) :: force, slope
    integer :: i, last

    carries = .true.
    x = 0
    do i = 1, size(stiffness)
      x = (load + sum(stiffness*error, mask=carries))/sum(stiffness, mask=carries)
      ! One at a time: x rises as a pair drops out, which may keep the next one.
      last = maxloc(error, 1, mask=carries)
      if (x > error(last)) exit
      carries(last) = .false.
    end do
    if (.not. present(flattening)) return
    if (.not. any(flattening > 0)) return
    do i = 1, most
      call pair_load(x - error, stiffness, load, flattening, force, slope)
      associate (excess => sum(force) - load)
        if (abs(excess) <= rounding*load) exit
        x = x - excess/sum(slope)
      end associate
    end do
  end function static_deflection

  !> Load F (N) of a pair that is pressed together by `depth` (m), 0 where it is apart, and its slope dF/d depth (N/m):
  !> depth = F (1/K - flattening log(F/nominal)), with K (N/m) the secant stiffness at the `nominal` load (N).
  !> Newton's method from K depth, without flattening the solution. Source: Johnson 1985, Contact Mechanics, Eq. 5.57.
  elemental subroutine pair_load(depth, stiffness, nominal, flattening, force, slope)
    real(dp), intent(in) :: depth, stiffness, nominal, flattening
    real(dp), intent(out) :: force, slope
    real(dp), parameter :: rounding = 1e-15_dp, least = 1e-250_dp
    integer, parameter :: most = 30
    real(dp) :: before
    integer :: i

    force = 0
    slope = 0
    if (.not. depth > 0) return
    force = stiffness*depth
    slope = stiffness
    if (.not. (flattening > 0 .and. force > least*nominal)) return
    do i = 1, most
      before = force
      slope = 1/(1/stiffness - flattening*(1 + log(force/nominal)))
      force = (depth - flattening*force)*slope
      if (abs(force - before) <= rounding*force) exit
    end do
  end subroutine pair_load

  !> The common deflection (m), but for the turning of discs, and the loads (N) of pairs one behind the other that carry the
  !> nominal `load` (N) together. `stiffness` (N/m) is that of each pair while it carries alone, `flattening` (m/N) as in
  !> `pair_load`, `error` (m) its profile error, `shared` (m/N) what it shares with the next one.
  pure subroutine solve_equilibrium(mesh, load, stiffness, flattening, error, shared, deflection, force)
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: load
    real(dp), intent(in) :: stiffness(:), flattening(:), error(:)     !< (pair)
    real(dp), intent(in) :: shared(:)                      !< (pair but the last, at least one)
    real(dp), intent(out) :: deflection
    real(dp), intent(out) :: force(:)                      !< (pair); 0 where a pair is apart
    real(dp), dimension(size(stiffness)) :: own, slope

    if (mesh%is_coupled(size(stiffness))) then
      call solve_coupled(coupling(mesh, stiffness, shared), error, load, flattening, deflection, force)
    else
      own = stiffness/(1 - shared(1)*stiffness)
      deflection = static_deflection(own, error, load, flattening)
      call pair_load(deflection - error, own, load, flattening, force, slope)
      deflection = deflection + shared(1)*load
    end if
  end subroutine solve_equilibrium

  !> The same for pairs of which each is moved by the others' loads as the matrix `compliance` says (m/N), whose diagonal they have
  !> alone: each load is that of `pair_load` on what the others leave of the deflection. Newton's method on all loads and the
  !> deflection; the loads' slopes jump where a pair parts, so that it may step back and forth there: then half of a step.
  pure subroutine solve_coupled(compliance, error, load, flattening, deflection, force)
    real(dp), intent(in) :: compliance(:, :), error(:), load, flattening(:)
    real(dp), intent(out) :: deflection, force(:)
    real(dp), parameter :: rounding = 1e-14_dp
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
      call pair_load(depth, 1/own, load, flattening, carried, slope)
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
      if (all(abs(step(:n, 1)) <= rounding*load)) exit
    end do
    where (.not. depth > 0) force = 0
  end subroutine solve_coupled

  !> Deflection (m), but for the turning of discs, and loads (N) of the pairs at a phase of `interval`, one-sided at its ends.
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

  !> Stiffness (N/m), while it carries alone, and profile error (m) of each pair at a phase of `interval`, one-sided at its ends.
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

  !> The static transmission error (m) under `load` (N) at a phase of `interval`.
  pure real(dp) function transmission_error(mesh, interval, load, phase)
    type(mesh_t), intent(in) :: mesh
    type(interval_t), intent(in) :: interval
    real(dp), intent(in) :: load, phase
    real(dp) :: force(interval%pairs)

    call solve_equilibrium_at(mesh, interval, load, phase, transmission_error, force)
    transmission_error = transmission_error + mesh%disc%turn*load
  end function transmission_error

  !> Samples each mesh period with about `samples` points: between the breaks of the mesh, or of the `intervals` that are given, as
  !> `contact_intervals` of gearsweep_segments, which end where pairs begin and cease to carry too. Source: Dogan et al. 2021,
  !> Eqs. 7, 8, with separation.
  pure subroutine share_load(mesh, load, samples, sharing, known)
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: load
    integer, intent(in) :: samples
    type(sharing_t), intent(out) :: sharing
    type(interval_t), intent(in), optional :: known(:)     !< intervals, of the whole period
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

  !> Share of `load` (N) that the pair at path coordinate `s` carries.
  pure real(dp) function load_share(mesh, load, s)
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: load, s
    real(dp), allocatable :: stiffness(:), flattening(:), error(:), shared(:, :), force(:)
    real(dp) :: place, deflection
    integer :: before, behind, j

    ! So many pairs stand before and behind this one.
    before = max(0, floor(s - mesh%reach(1)))
    behind = max(0, ceiling(mesh%reach(2) - s) - 1)
    allocate (stiffness(-before:behind), flattening(-before:behind), error(-before:behind), force(-before:behind))
    allocate (shared(0:2, -before:max(behind - 1, -before)))
    do j = -before, behind
      place = s - floor(s) + (floor(s) + j + 1) - 1
      stiffness(j) = mesh%stiffness%value(place, mesh%stiffness%locate(place))
      flattening(j) = mesh%flattening%at(place, mesh%contact_ratio)
      error(j) = mesh%profile_error%value(place)
      if (j <= ubound(shared, 2)) shared(:, j) = mesh%shared_from(place)
    end do
    call solve_equilibrium(mesh, load, stiffness, flattening, error, shared(0, :), deflection, force)
    load_share = force(0)/load
  end function load_share
end module gearsweep_sharing
