!> The gear mesh: how stiff and how far from the true involute each pair is, at
!> every phase of the mesh period. It comes from a gear pair, or is prescribed
!> with no geometry behind it.
!>
!> At mesh phase tau (0 to 1) the pairs stand at the path coordinates s = tau + n, n = 0, 1, ..., as long as s lies
!> below the contact ratio. Where a pair may be in contact before A or behind E, n begins below 0 or goes on.
module gearsweep_mesh
  use gearsweep_disc, only: disc_t
  use gearsweep_kinds, only: dp, pi
  use gearsweep_piecewise, only: piecewise_t
  use gearsweep_quadrature, only: gauss_legendre
  implicit none
  private
  public :: mesh_t, interval_t, smooth_intervals

  type :: mesh_t
    real(dp) :: contact_ratio = 0
    !> Path coordinates between which a pair may be in contact: the first at most 0 (A), the second at least the contact
    !> ratio (E). Both curves cover all of it. Beyond A and E the tip corner of one member touches.
    real(dp) :: reach(2) = 0
    type(piecewise_t) :: stiffness               !< K(s) of one pair between the turning discs, N/m
    type(disc_t) :: disc                         !< what the discs yield under all pairs together
    type(piecewise_t) :: profile_error           !< e(s) of one pair, m
    !> How much the compliance of a pair falls as its load grows e times, beside that at the nominal load, which the
    !> stiffness has: by Hertz, m/N. Known to the static load sharing alone.
    real(dp) :: flattening = 0
    !> For friction alone: teeth of both members, path coordinate of the pitch
    !> point, tangent of the working pressure angle.
    integer :: teeth(2) = 0
    real(dp) :: pitch_point = 0
    real(dp) :: tan_angle = 0
  contains
    procedure :: mean_stiffness
    procedure :: own_stiffness
    procedure :: curvature_ratio
    procedure :: reaches_beyond
  end type mesh_t

  !> A smooth interval: a part of the mesh period within which no coefficient has a break.
  type :: interval_t
    real(dp) :: first = 0, last = 0              !< phases
    integer :: pairs = 0                         !< that may be in contact
    integer :: offset = 0                        !< path coordinate of the first of them less the phase
    integer, allocatable :: piece(:, :)          !< first and last of the profile error; (2, pair)
    integer, allocatable :: stiffness_piece(:, :)    !< first and last of the stiffness; (2, pair)
    logical, allocatable :: recess(:)            !< the pair has passed the pitch point
    logical, allocatable :: between(:)           !< the pair is between A and E
    logical, allocatable :: carries(:)           !< in the reference contact: all, or those that carry a static load
  contains
    procedure :: place
  end type interval_t

  !> Breaks closer than this are one: no step could tell them apart.
  real(dp), parameter :: same_phase = 1e-11_dp

contains

  !> Mean over the period of the stiffness of all pairs between A and E together, without relief (N/m): of their sum or,
  !> where they share a compliance, of that in series with it.
  pure real(dp) function mean_stiffness(mesh)
    class(mesh_t), intent(in) :: mesh
    integer, parameter :: points = 8
    real(dp) :: node(points), weight(points), own
    real(dp), allocatable :: breaks(:)
    integer :: i, j, k

    mean_stiffness = mesh%stiffness%integral(0.0_dp, mesh%contact_ratio)
    if (.not. mesh%disc%shared > 0) return
    call gauss_legendre(node, weight)
    breaks = sorted([phase(mesh%contact_ratio), phase(mesh%stiffness%breaks)])
    mean_stiffness = 0
    do i = 1, size(breaks) - 1
      do k = 1, points
        associate (tau => (breaks(i) + breaks(i + 1) + node(k)*(breaks(i + 1) - breaks(i)))/2)
          own = sum([(mesh%own_stiffness(tau + j), j=0, ceiling(mesh%contact_ratio - tau) - 1)])
        end associate
        mean_stiffness = mean_stiffness + (breaks(i + 1) - breaks(i))/2*weight(k)*own/(1 + mesh%disc%shared*own)
      end do
    end do
  end function mean_stiffness

  !> Stiffness (N/m) of the pair at s beyond what it shares with the next one: in series with the
  !> shared compliance, which carries all pairs together, it is what the pair has alone.
  pure real(dp) function own_stiffness(mesh, s, among) result(stiffness)
    class(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: s
    integer, intent(in), optional :: among(2)    !< first and last piece in question; without it, all

    stiffness = mesh%stiffness%value(s, mesh%stiffness%locate(s, among))
    stiffness = stiffness/(1 - mesh%disc%shared*stiffness)
  end function own_stiffness

  !> May a pair be in contact before A or behind E?
  pure logical function reaches_beyond(mesh)
    class(mesh_t), intent(in) :: mesh

    reaches_beyond = mesh%reach(1) < 0 .or. mesh%reach(2) > mesh%contact_ratio
  end function reaches_beyond

  !> Path coordinate of pair j of an interval.
  elemental real(dp) function place(interval, phase, j) result(s)
    class(interval_t), intent(in) :: interval
    real(dp), intent(in) :: phase
    integer, intent(in) :: j

    s = phase + (j + interval%offset) - 1
  end function place

  !> Radius of curvature over base radius of a member at s.
  elemental real(dp) function curvature_ratio(mesh, member, s) result(ratio)
    class(mesh_t), intent(in) :: mesh
    integer, intent(in) :: member
    real(dp), intent(in) :: s
    real(dp) :: past

    past = (s - mesh%pitch_point)*2*pi/mesh%teeth(member)
    if (member == 2) past = -past
    ratio = mesh%tan_angle + past
  end function curvature_ratio

  !> Splits the period where a pair enters or leaves, where a relief begins, with friction at the pitch point and, where
  !> contact reaches beyond A and E, where the stiffness has a kink, as it may at A and E.
  pure function smooth_intervals(mesh, friction) result(intervals)
    type(mesh_t), intent(in) :: mesh
    logical, intent(in) :: friction
    type(interval_t), allocatable :: intervals(:)
    real(dp), allocatable :: breaks(:)
    integer :: i

    breaks = [0.0_dp, 1.0_dp, phase(mesh%contact_ratio), phase(mesh%reach)]
    do i = 2, size(mesh%profile_error%breaks) - 1
      if (.not. mesh%profile_error%is_smooth_at(i)) breaks = [breaks, phase(mesh%profile_error%breaks(i))]
    end do
    if (mesh%reaches_beyond()) then
      do i = 2, size(mesh%stiffness%breaks) - 1
        if (.not. mesh%stiffness%is_smooth_at(i)) breaks = [breaks, phase(mesh%stiffness%breaks(i))]
      end do
    end if
    if (friction .and. mesh%pitch_point > 0 .and. mesh%pitch_point < mesh%contact_ratio) then
      breaks = [breaks, phase(mesh%pitch_point)]
    end if
    breaks = sorted(breaks)

    allocate (intervals(size(breaks) - 1))
    do i = 1, size(intervals)
      intervals(i)%first = breaks(i)
      intervals(i)%last = breaks(i + 1)
      call list_pairs(mesh, (breaks(i) + breaks(i + 1))/2, intervals(i))
    end do
  end function smooth_intervals

  !> The pairs that may be in contact at the middle of an interval, and so in all of it.
  pure subroutine list_pairs(mesh, middle, interval)
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: middle               !< phase
    type(interval_t), intent(inout) :: interval
    integer :: j

    interval%offset = floor(mesh%reach(1) - middle) + 1
    interval%pairs = ceiling(mesh%reach(2) - middle) - interval%offset
    allocate (interval%piece(2, interval%pairs), interval%stiffness_piece(2, interval%pairs))
    associate (s => interval%place(middle, [(j, j=1, interval%pairs)]))
      do j = 1, interval%pairs
        interval%piece(:, j) = smooth_pieces(mesh%profile_error, s(j))
        interval%stiffness_piece(:, j) = [1, size(mesh%stiffness%breaks) - 1]
        if (mesh%reaches_beyond()) interval%stiffness_piece(:, j) = smooth_pieces(mesh%stiffness, s(j))
      end do
      interval%recess = s > mesh%pitch_point
      interval%between = s > 0 .and. s < mesh%contact_ratio
    end associate
    allocate (interval%carries(interval%pairs), source=.true.)
  end subroutine list_pairs

  !> First and last piece of the part of a curve around s within which it is smooth.
  pure function smooth_pieces(curve, s) result(piece)
    type(piecewise_t), intent(in) :: curve
    real(dp), intent(in) :: s
    integer :: piece(2)

    piece = curve%locate(s)
    do while (piece(1) > 1)
      if (.not. curve%is_smooth_at(piece(1))) exit
      piece(1) = piece(1) - 1
    end do
    do while (piece(2) < size(curve%breaks) - 1)
      if (.not. curve%is_smooth_at(piece(2) + 1)) exit
      piece(2) = piece(2) + 1
    end do
  end function smooth_pieces

  elemental real(dp) function phase(s)
    real(dp), intent(in) :: s

    phase = s - floor(s)
  end function phase

  !> Ascending, without what is the same; 0 and 1 stay exact.
  pure function sorted(values) result(list)
    real(dp), intent(in) :: values(:)
    real(dp), allocatable :: list(:)
    real(dp) :: next

    list = [0.0_dp]
    do
      next = minval(values, mask=values > list(size(list)) + same_phase)
      if (next > 1 - same_phase) exit
      list = [list, next]
    end do
    list = [list, 1.0_dp]
  end function sorted
end module gearsweep_mesh
