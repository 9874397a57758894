!> Static load sharing: which pairs carry how much, and the static transmission error.
!>
!> The pairs stand beside each other, each with its own stiffness; what the discs of whole gears
!> yield under all of them is one spring in series, which no relief or share changes.
module gearsweep_sharing
  use gearsweep_kinds, only: dp
  use gearsweep_mesh, only: mesh_t, interval_t, smooth_intervals
  implicit none
  private
  public :: sharing_t, share_load, load_share, pairs_at, static_deflection, pair_load, transmission_error

  !> The static state along the mesh period; one-sided at every break.
  type :: sharing_t
    real(dp), allocatable :: phase(:)            !< ascending, breaks twice
    real(dp), allocatable :: error(:)            !< static transmission error, m
    real(dp), allocatable :: stiffness(:)        !< of the pairs that carry load and the discs, N/m
    real(dp), allocatable :: s(:, :)             !< path coordinate of each pair; 2nd index as phase
    real(dp), allocatable :: load(:, :)          !< load of each pair, N; 0 where separated
    integer, allocatable :: pairs(:)             !< that may be in contact
    integer, allocatable :: offset(:)            !< path coordinate of the first of them less the phase
  end type sharing_t

contains

  !> Common deflection x that carries the nominal `load` (N): the sum of the pairs' loads at x - e_j (see pair_load).
  !> `stiffness` (N/m) and `error` (m) of the pairs, any number; `flattening` (m/N; without it, 0) as in mesh_t.
  !>
  !> Without flattening each load is K_j max(0, x - e_j), in closed form. With it, loads grow more than in proportion to
  !> the deflection: Newton's method, from its second step on, comes down to the solution from above without passing it.
  pure real(dp) function static_deflection(stiffness, error, load, flattening) result(x)
    real(dp), intent(in) :: stiffness(:), error(:), load
    real(dp), intent(in), optional :: flattening
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
    if (.not. flattening > 0) return
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

  !> Own stiffness (N/m) and profile error (m) of each pair at a phase of `interval`, one-sided at its ends.
  pure subroutine pairs_at(mesh, interval, phase, stiffness, error)
    type(mesh_t), intent(in) :: mesh
    type(interval_t), intent(in) :: interval
    real(dp), intent(in) :: phase
    real(dp), intent(out) :: stiffness(interval%pairs), error(interval%pairs)
    integer :: j

    do j = 1, interval%pairs
      associate (s => interval%place(phase, j))
        stiffness(j) = mesh%own_stiffness(s, interval%stiffness_piece(:, j))
        error(j) = mesh%profile_error%value(s, mesh%profile_error%locate(s, interval%piece(:, j)))
      end associate
    end do
  end subroutine pairs_at

  !> The static transmission error (m) under `load` (N) at a phase of `interval`.
  pure real(dp) function transmission_error(mesh, interval, load, phase)
    type(mesh_t), intent(in) :: mesh
    type(interval_t), intent(in) :: interval
    real(dp), intent(in) :: load, phase
    real(dp), dimension(interval%pairs) :: stiffness, error

    call pairs_at(mesh, interval, phase, stiffness, error)
    transmission_error = static_deflection(stiffness, error, load, mesh%flattening) + mesh%disc%yield()*load
  end function transmission_error

  !> Samples the period with about `samples` points. Source: Dogan et al. 2021,
  !> Eqs. 7, 8, with separation.
  pure subroutine share_load(mesh, load, samples, sharing)
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: load
    integer, intent(in) :: samples
    type(sharing_t), intent(out) :: sharing
    type(interval_t), allocatable :: intervals(:)
    integer, allocatable :: counts(:)
    integer :: i, k, row

    intervals = smooth_intervals(mesh, .false.)
    counts = [(1 + max(1, nint(samples*(intervals(i)%last - intervals(i)%first))), i=1, size(intervals))]
    associate (n => sum(counts), most => maxval(intervals%pairs))
      allocate (sharing%phase(n), sharing%error(n), sharing%stiffness(n), sharing%pairs(n), sharing%offset(n))
      allocate (sharing%s(most, n), sharing%load(most, n), source=0.0_dp)
    end associate
    row = 0
    do i = 1, size(intervals)
      do k = 0, counts(i) - 1
        row = row + 1
        sharing%phase(row) = intervals(i)%first + (intervals(i)%last - intervals(i)%first)*k/(counts(i) - 1)
        call share_at(mesh, intervals(i), load, row, sharing)
      end do
    end do
  end subroutine share_load

  pure subroutine share_at(mesh, interval, load, row, sharing)
    type(mesh_t), intent(in) :: mesh
    type(interval_t), intent(in) :: interval
    real(dp), intent(in) :: load
    integer, intent(in) :: row
    type(sharing_t), intent(inout) :: sharing
    real(dp), dimension(interval%pairs) :: stiffness, error, force, slope
    real(dp) :: deflection
    integer :: j

    sharing%offset(row) = interval%offset
    sharing%s(:interval%pairs, row) = interval%place(sharing%phase(row), [(j, j=1, interval%pairs)])
    call pairs_at(mesh, interval, sharing%phase(row), stiffness, error)
    sharing%pairs(row) = interval%pairs
    deflection = static_deflection(stiffness, error, load, mesh%flattening)
    call pair_load(deflection - error, stiffness, load, mesh%flattening, force, slope)
    sharing%error(row) = deflection + mesh%disc%yield()*load
    sharing%load(:interval%pairs, row) = force
    associate (pairs => sum(stiffness, mask=deflection > error))
      sharing%stiffness(row) = pairs/(1 + mesh%disc%yield()*pairs)
    end associate
  end subroutine share_at

  !> Share of `load` (N) that the pair at path coordinate `s` carries.
  pure real(dp) function load_share(mesh, load, s)
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: load, s
    real(dp), allocatable :: stiffness(:), error(:)
    real(dp) :: place, force, slope
    integer :: before, behind, j

    ! So many pairs stand before and behind this one.
    before = max(0, floor(s - mesh%reach(1)))
    behind = max(0, ceiling(mesh%reach(2) - s) - 1)
    allocate (stiffness(-before:behind), error(-before:behind))
    do j = -before, behind
      place = s - floor(s) + (floor(s) + j + 1) - 1
      stiffness(j) = mesh%own_stiffness(place)
      error(j) = mesh%profile_error%value(place)
    end do
    call pair_load(static_deflection(stiffness, error, load, mesh%flattening) - error(0), stiffness(0), load, &
                   mesh%flattening, force, slope)
    load_share = force/load
  end function load_share
end module gearsweep_sharing
