!> The gear mesh: stiffness and profile error of each pair, at every phase of the mesh period. It follows from a gear pair, or is
!> prescribed without a geometry.
!>
!> At mesh phase tau (0 to 1) the pairs are at the path coordinates s = tau + n, n = 0, 1, ..., as long as s is below the contact
!> ratio. If a pair may be in contact before A or after E, n begins below 0 or continues.
module gearsweep_mesh_mesh
  use gearsweep_base, only: dp, gauss_legendre, pi, piecewise_t, solve_small
  use gearsweep_gear, only: drive, pair_t
  use gearsweep_elastic, only: disc_t, flattening_t
  use gearsweep_mesh_deviations, only: deviations_t, distinct_phases, interval_t, phase_of
  implicit none
  private
  public :: mesh_t, mesh_of, coupling, joint_stiffness

  !> Relative uncertainty of the stiffness at a tip corner: the secant at the full load is too stiff for a small load by up to the
  !> first; if a pair deflects by its own load, the second remains for grid and depth of the contact problem (suite
  !> elastic_corner).
  real(dp), parameter, public :: corner_uncertainty = 0.1_dp, own_corner_uncertainty = 0.03_dp

  type :: mesh_t
    real(dp) :: contact_ratio = 0
    !> Path coordinates between which a pair may be in contact: the first at most 0 (A), the second at least the contact ratio
    !> (E). Both curves cover all of it. Beyond A and E the tip corner of one gear touches.
    real(dp) :: reach(2) = 0
    !> Base pitches from one spring of a pair to the next on both curves; 0: a pair is one spring. Several springs in parallel stand
    !> for a pair whose load is not linear in its deflection. The one that touches first is at the path coordinate s of the pair,
    !> the next at s - spacing, and so on to the begin of `reach`, a multiple of the spacing. Past E their stiffness is 0.
    integer :: spacing = 0
    type(piecewise_t) :: stiffness               !< K(s) of one pair between the turning discs, N/m
    type(disc_t) :: disc                         !< deflection of the discs under all pairs together
    type(piecewise_t) :: profile_error           !< e(s) of one pair, m
    type(deviations_t) :: deviations             !< additional profile errors of each pair of teeth
    !> Decrease of the compliance of a pair with its load, relative to that at the nominal load, which the stiffness has. Used
    !> only by the static load sharing.
    type(flattening_t) :: flattening
    !> For friction only: teeth of both gears, path coordinate of the pitch point, tangent of the working pressure angle.
    integer :: teeth(2) = 0
    real(dp) :: pitch_point = 0
    real(dp) :: tan_angle = 0
    !> Additional change of the lever arms of friction over the base radii per base pitch beyond A and E, off the line of action,
    !> for a load at a tip corner; (gear, before A or after E).
    real(dp) :: arm_change(2, 2) = 0
  contains
    procedure :: mean_stiffness
    procedure :: stiffness_of
    procedure :: shared_from
    procedure :: are_joint
    procedure :: is_coupled
    procedure :: curvature_ratio
    procedure :: mobility
    procedure :: reaches_beyond
    procedure :: with_softer_corners
    procedure :: largest_error
    procedure :: error_at
  end type mesh_t

contains

  !> Mesh of a pair of gears over its path of contact (ISO 21771); stiffness and profile error are still to be set.
  pure type(mesh_t) function mesh_of(pair) result(mesh)
    type(pair_t), intent(in) :: pair
    real(dp) :: points(5)

    points = pair%points()
    mesh%teeth = pair%gear%spec%teeth
    mesh%contact_ratio = pair%contact_ratio
    mesh%pitch_point = points(3)
    mesh%tan_angle = tan(pair%working_angle(drive))
    mesh%reach = [0.0_dp, mesh%contact_ratio]
  end function mesh_of

  !> Mean over the period of the stiffness of all pairs between A and E together, without relief (N/m): of their sum or, if they
  !> share a compliance, of that in series with it.
  pure real(dp) function mean_stiffness(mesh)
    class(mesh_t), intent(in) :: mesh
    integer, parameter :: points = 8
    real(dp) :: node(points), weight(points)
    real(dp), allocatable :: breaks(:), s(:), shared(:, :)
    integer :: i, j, k

    mean_stiffness = mesh%stiffness%integral(0.0_dp, mesh%contact_ratio)
    if (.not. mesh%disc%shared > 0) return
    call gauss_legendre(node, weight)
    breaks = distinct_phases([phase_of(mesh%contact_ratio), phase_of(mesh%stiffness%breaks)], 0.0_dp, 1.0_dp)
    mean_stiffness = 0
    do i = 1, size(breaks) - 1
      do k = 1, points
        associate (tau => (breaks(i) + breaks(i + 1) + node(k)*(breaks(i + 1) - breaks(i)))/2)
          s = [(tau + j, j=0, ceiling(mesh%contact_ratio - tau) - 1)]
        end associate
        shared = reshape([(mesh%shared_from(s(j)), j=1, max(1, size(s) - 1))], [3, max(1, size(s) - 1)])
        mean_stiffness = mean_stiffness + (breaks(i + 1) - breaks(i))/2*weight(k)*joint_stiffness( &
                         mesh, [(mesh%stiffness%value(s(j), mesh%stiffness%locate(s(j))), j=1, size(s))], shared(1, :), &
                         spread(.true., 1, size(s)))
      end do
    end do
  end function mean_stiffness

  !> Mean over the period of the stiffness (N/m) of those springs that carry in each of its intervals; for pairs of several springs.
  pure real(dp) function stiffness_of(mesh, intervals) result(mean)
    class(mesh_t), intent(in) :: mesh
    type(interval_t), intent(in) :: intervals(:)           !< of a mesh period
    integer :: i, j

    mean = 0
    do i = 1, size(intervals)
      associate (one => intervals(i))
        do j = 1, one%pairs
          if (one%carries(j)) mean = mean + mesh%stiffness%integral(one%place(one%first, j), one%place(one%last, j))
        end do
      end associate
    end do
  end function stiffness_of

  !> Stiffness (N/m) of the loaded pairs in contact together, without the turning of discs. The pairs follow one another along the
  !> path.
  pure real(dp) function joint_stiffness(mesh, stiffness, shared, carries) result(joint)
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: stiffness(:)         !< stiffness of each pair that carries alone, N/m
    real(dp), intent(in) :: shared(:)  !< compliance shared by a pair and the next one, m/N; (pair but the last, at least one)
    logical, intent(in) :: carries(:)            !< (pair)
    real(dp) :: matrix(size(stiffness), size(stiffness)), load(size(stiffness), 1)
    integer :: i, j

    if (mesh%is_coupled(size(stiffness))) then
      matrix = coupling(mesh, stiffness, shared)
      do j = 1, size(stiffness)
        if (.not. carries(j)) matrix(j, :) = [(merge(1, 0, i == j), i=1, size(stiffness))]
      end do
      load(:, 1) = merge(1, 0, carries)
      call solve_small(matrix, load)
      joint = sum(load)
    else
      joint = sum(stiffness/(1 - shared(1)*stiffness), mask=carries)
      joint = joint/(1 + shared(1)*joint)
    end if
  end function joint_stiffness

  !> Compliance shared by the pair at s and the next one (m/N), with its first and second derivative over s; (0:2). It is constant
  !> where one of them is beyond A or E. On a smooth interval any coordinate in it serves as `about`.
  pure function shared_from(mesh, s, about) result(c)
    class(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: s
    real(dp), intent(in), optional :: about
    real(dp) :: c(0:2), half, side

    half = (mesh%contact_ratio - 1)/2
    side = s
    if (present(about)) side = about
    if (side <= 0) then
      c = [1, 0, 0]*mesh%disc%shared_at(-1.0_dp)
    else if (side >= 2*half) then
      c = [1, 0, 0]*mesh%disc%shared_at(1.0_dp)
    else
      c = mesh%disc%shared_at(s/half - 1)/[1.0_dp, half, half**2]
    end if
  end function shared_from

  !> True if pairs share a compliance, or are springs of one pair.
  elemental logical function are_joint(mesh)
    class(mesh_t), intent(in) :: mesh

    are_joint = mesh%disc%shared > 0 .or. mesh%spacing > 0
  end function are_joint

  !> True if this many pairs share different compliances. Two pairs share one: a spring in series with both.
  elemental logical function is_coupled(mesh, pairs)
    class(mesh_t), intent(in) :: mesh
    integer, intent(in) :: pairs

    is_coupled = pairs > 2 .and. (abs(mesh%disc%decline) > 0 .or. any(abs(mesh%disc%change) > 0))
  end function is_coupled

  !> Compliance matrix (m/N): deflection of each pair per load on a pair, for neighbours the shared compliance, for others less.
  !> The pairs follow one another, with this stiffness (N/m) of each while it carries alone.
  pure function coupling(mesh, stiffness, shared) result(compliance)
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: stiffness(:)         !< (pair)
    real(dp), intent(in) :: shared(:)            !< m/N; (pair but the last)
    real(dp) :: compliance(size(stiffness), size(stiffness))
    integer :: j

    compliance = mesh%disc%shared_beyond()
    do j = 1, size(stiffness)
      compliance(j, j) = 0                       ! for a pair out of contact range
      if (stiffness(j) > 0) compliance(j, j) = 1/stiffness(j)
      if (j == size(stiffness)) exit
      compliance(j, j + 1) = shared(j)
      compliance(j + 1, j) = shared(j)
    end do
  end function coupling

  !> True if a pair may be in contact before A or after E.
  pure logical function reaches_beyond(mesh)
    class(mesh_t), intent(in) :: mesh

    reaches_beyond = mesh%reach(1) < 0 .or. mesh%reach(2) > mesh%contact_ratio
  end function reaches_beyond

  !> Mesh with its stiffness beyond A and E reduced by a `part` of it.
  pure type(mesh_t) function with_softer_corners(mesh, part) result(softer)
    class(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: part
    integer :: i

    softer = mesh
    do i = 1, size(mesh%stiffness%breaks) - 1
      associate (middle => (mesh%stiffness%breaks(i) + mesh%stiffness%breaks(i + 1))/2)
        if (middle < 0 .or. middle > mesh%contact_ratio) softer%stiffness%coef(:, i) = (1 - part)*mesh%stiffness%coef(:, i)
      end associate
    end do
  end function with_softer_corners

  !> Upper bound of the profile error (m), including that of single teeth.
  pure real(dp) function largest_error(mesh)
    class(mesh_t), intent(in) :: mesh

    largest_error = mesh%profile_error%maximum() + mesh%deviations%largest(mesh%contact_ratio)
  end function largest_error

  !> Profile error (m) of pair j at a phase of an interval, one-sided at its ends.
  pure real(dp) function error_at(mesh, interval, phase, j) result(e)
    class(mesh_t), intent(in) :: mesh
    type(interval_t), intent(in) :: interval
    real(dp), intent(in) :: phase
    integer, intent(in) :: j
    real(dp) :: s, d(0:2, 1)

    s = interval%place(phase, j)
    e = mesh%profile_error%value(s, mesh%profile_error%locate(s, interval%piece(:, j)))
    if (.not. allocated(interval%deviation)) return
    d(:, 1) = mesh%deviations%wave_at(interval%period, phase)
    call interval%add_deviation([phase], j, d)
    e = e + d(0, 1)
  end function error_at

  !> Radius of curvature over base radius of a gear at s; beyond A and E the lever arm of friction over the base radius.
  elemental real(dp) function curvature_ratio(mesh, gear, s) result(ratio)
    class(mesh_t), intent(in) :: mesh
    integer, intent(in) :: gear
    real(dp), intent(in) :: s
    real(dp) :: past

    past = (s - mesh%pitch_point)*2*pi/mesh%teeth(gear)
    if (gear == 2) past = -past
    ratio = mesh%tan_angle + past
    if (s < 0) ratio = ratio + mesh%arm_change(gear, 1)*s
    if (s > mesh%contact_ratio) ratio = ratio + mesh%arm_change(gear, 2)*(s - mesh%contact_ratio)
  end function curvature_ratio

  !> Acceleration of the motion per load of a pair (1/kg): the friction factors of pinion and gear over their masses. The driving
  !> pinion's tooth slides inwards before the pitch point (-) and outwards after it (+).
  pure real(dp) function mobility(mesh, mass, friction, s, recess)
    class(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: mass(2)              !< masses of pinion and gear, kg
    real(dp), intent(in) :: friction             !< mu
    real(dp), intent(in) :: s                    !< path coordinate of the pair from A, base pitches
    logical, intent(in) :: recess                !< the pair has passed the pitch point
    real(dp) :: sense

    mobility = 1/mass(1) + 1/mass(2)
    if (.not. friction > 0) return
    sense = merge(friction, -friction, recess)
    mobility = mobility + sense*(mesh%curvature_ratio(1, s)/mass(1) + mesh%curvature_ratio(2, s)/mass(2))
  end function mobility
end module gearsweep_mesh_mesh
