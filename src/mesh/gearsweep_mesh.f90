!> The gear mesh: how stiff and how far from the true involute each pair is, at
!> every phase of the mesh period. It comes from a gear pair, or is prescribed
!> with no geometry behind it.
!>
!> At mesh phase tau (0 to 1) the pairs j = 1, 2, ... stand at the path
!> coordinates s = tau + j - 1, as long as s lies below the contact ratio.
module gearsweep_mesh
  use gearsweep_disc, only: disc_t
  use gearsweep_kinds, only: dp, pi
  use gearsweep_piecewise, only: piecewise_t
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
    !> For friction alone: teeth of both members, path coordinate of the pitch
    !> point, tangent of the working pressure angle.
    integer :: teeth(2) = 0
    real(dp) :: pitch_point = 0
    real(dp) :: tan_angle = 0
  contains
    procedure :: mean_stiffness
    procedure :: own_stiffness
    procedure :: curvature_ratio
  end type mesh_t

  !> A smooth interval: a part of the mesh period within which no coefficient has a break.
  type :: interval_t
    real(dp) :: first = 0, last = 0              !< phases
    integer :: pairs = 0
    integer, allocatable :: piece(:)             !< of the profile error, for each pair
    logical, allocatable :: recess(:)            !< the pair has passed the pitch point
  end type interval_t

  !> Breaks closer than this are one: no step could tell them apart.
  real(dp), parameter :: same_phase = 1e-11_dp

contains

  !> Mean over the period of the sum of all pairs' stiffness without relief (N/m).
  pure real(dp) function mean_stiffness(mesh)
    class(mesh_t), intent(in) :: mesh

    mean_stiffness = mesh%stiffness%integral(0.0_dp, mesh%contact_ratio)
  end function mean_stiffness

  !> Stiffness (N/m) of the pair at s beyond what it shares with the next one: in series with the
  !> disc's compliance, which carries all pairs together, it is what the pair has alone.
  elemental real(dp) function own_stiffness(mesh, s) result(stiffness)
    class(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: s

    stiffness = mesh%stiffness%value(s)
    stiffness = stiffness/(1 - mesh%disc%shared*stiffness)
  end function own_stiffness

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

  !> Splits the period where a pair enters or leaves, where a relief begins and,
  !> with friction, at the pitch point.
  pure function smooth_intervals(mesh, friction) result(intervals)
    type(mesh_t), intent(in) :: mesh
    logical, intent(in) :: friction
    type(interval_t), allocatable :: intervals(:)
    real(dp), allocatable :: breaks(:)
    integer :: i, j

    breaks = [0.0_dp, 1.0_dp, phase(mesh%contact_ratio)]
    do i = 1, size(mesh%profile_error%breaks)
      breaks = [breaks, phase(mesh%profile_error%breaks(i))]
    end do
    if (friction .and. mesh%pitch_point > 0 .and. mesh%pitch_point < mesh%contact_ratio) then
      breaks = [breaks, phase(mesh%pitch_point)]
    end if
    breaks = sorted(breaks)

    allocate (intervals(size(breaks) - 1))
    do i = 1, size(intervals)
      intervals(i)%first = breaks(i)
      intervals(i)%last = breaks(i + 1)
      associate (middle => (breaks(i) + breaks(i + 1))/2)
        intervals(i)%pairs = ceiling(mesh%contact_ratio - middle)
        intervals(i)%piece = [(mesh%profile_error%locate(middle + j - 1), j=1, intervals(i)%pairs)]
        intervals(i)%recess = [(middle + j - 1 > mesh%pitch_point, j=1, intervals(i)%pairs)]
      end associate
    end do
  end function smooth_intervals

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
