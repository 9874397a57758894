!> The gear mesh: how stiff and how far from the true involute each pair is, at
!> every phase of the mesh period. It comes from a gear pair, or is prescribed
!> with no geometry behind it.
!>
!> At mesh phase tau (0 to 1) the pairs stand at the path coordinates s = tau + n, n = 0, 1, ..., as long as s lies
!> below the contact ratio. Where a pair may be in contact before A or behind E, n begins below 0 or goes on.
module gearsweep_mesh
  use gearsweep_deviations, only: deviations_t
  use gearsweep_disc, only: disc_t
  use gearsweep_interval, only: distinct_phases, interval_t, phase_of
  use gearsweep_kinds, only: dp, pi
  use gearsweep_own_flattening, only: flattening_t
  use gearsweep_piecewise, only: piecewise_t
  use gearsweep_quadrature, only: gauss_legendre
  use gearsweep_small_system, only: solve_small
  implicit none
  private
  public :: mesh_t, coupling, joint_stiffness

  !> How well the stiffness at a tip corner is known: the secant at the whole load is too stiff for a small one by up to this part;
  !> where a pair deflects by its own load, grid and depth of the contact problem are left (suite elastic_corner).
  real(dp), parameter, public :: corner_uncertainty = 0.1_dp, own_corner_uncertainty = 0.03_dp

  type :: mesh_t
    real(dp) :: contact_ratio = 0
    !> Path coordinates between which a pair may be in contact: the first at most 0 (A), the second at least the contact
    !> ratio (E). Both curves cover all of it. Beyond A and E the tip corner of one gear touches.
    real(dp) :: reach(2) = 0
    type(piecewise_t) :: stiffness               !< K(s) of one pair between the turning discs, N/m
    type(disc_t) :: disc                         !< what the discs deflect under all pairs together
    type(piecewise_t) :: profile_error           !< e(s) of one pair, m
    type(deviations_t) :: deviations             !< what that is more for each pair of teeth by itself
    !> How the compliance of a pair falls as its load grows, beside that at the nominal load, which the stiffness has. Known to
    !> the static load sharing alone.
    type(flattening_t) :: flattening
    !> For friction alone: teeth of both gears, path coordinate of the pitch
    !> point, tangent of the working pressure angle.
    integer :: teeth(2) = 0
    real(dp) :: pitch_point = 0
    real(dp) :: tan_angle = 0
    !> What the lever arms of friction over the base radii change by per base pitch beyond A and E, off the line of action, more
    !> than they do on it: of a load at a tip corner; (gear, before A or behind E).
    real(dp) :: arm_change(2, 2) = 0
  contains
    procedure :: mean_stiffness
    procedure :: shared_from
    procedure :: is_coupled
    procedure :: curvature_ratio
    procedure :: mobility
    procedure :: reaches_beyond
    procedure :: with_softer_corners
    procedure :: largest_error
    procedure :: error_at
  end type mesh_t

contains

  !> Mean over the period of the stiffness of all pairs between A and E together, without relief (N/m): of their sum or,
  !> where they share a compliance, of that in series with it.
  pure real(dp) function mean_stiffness(mesh)
    class(mesh_t), intent(in) :: mesh
    integer, parameter :: points = 8
    real(dp) :: node(points), weight(points)
    real(dp), allocatable :: breaks(:), s(:), shared(:, :)
    integer :: i, j, k

    mean_stiffness = mesh%stiffness%integral(0.0_dp, mesh%contact_ratio)
    if (.not. mesh%disc%shared > 0) return
    call gauss_legendre(node, weight)
    breaks = distinct_phases([phase_of(mesh%contact_ratio), phase_of(mesh%stiffness%breaks)])
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

  !> Stiffness (N/m) of the pairs that carry, in contact together and without the turning of discs. The pairs stand one behind
  !> the other.
  pure real(dp) function joint_stiffness(mesh, stiffness, shared, carries) result(joint)
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: stiffness(:)         !< of each pair while it carries alone, N/m
    real(dp), intent(in) :: shared(:)            !< by a pair and the next one, m/N; (pair but the last, at least one)
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

  !> What the pair at s and the next one share (m/N), with its first and second derivative over s; (0:2). It is constant
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

  !> Do so many pairs share different compliances? Two share one, whatever it is: a spring in series with both.
  elemental logical function is_coupled(mesh, pairs)
    class(mesh_t), intent(in) :: mesh
    integer, intent(in) :: pairs

    is_coupled = pairs > 2 .and. (abs(mesh%disc%decline) > 0 .or. any(abs(mesh%disc%change) > 0))
  end function is_coupled

  !> What a unit load on a pair moves each pair by (m/N): neighbours by what they share, others by less. For pairs one behind
  !> the other, of which each has this stiffness (N/m) while it carries alone.
  pure function coupling(mesh, stiffness, shared) result(compliance)
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: stiffness(:)         !< (pair)
    real(dp), intent(in) :: shared(:)            !< m/N; (pair but the last)
    real(dp) :: compliance(size(stiffness), size(stiffness))
    integer :: j

    compliance = mesh%disc%shared_beyond()
    do j = 1, size(stiffness)
      compliance(j, j) = 0                       ! of a pair that is not there
      if (stiffness(j) > 0) compliance(j, j) = 1/stiffness(j)
      if (j == size(stiffness)) exit
      compliance(j, j + 1) = shared(j)
      compliance(j + 1, j) = shared(j)
    end do
  end function coupling

  !> May a pair be in contact before A or behind E?
  pure logical function reaches_beyond(mesh)
    class(mesh_t), intent(in) :: mesh

    reaches_beyond = mesh%reach(1) < 0 .or. mesh%reach(2) > mesh%contact_ratio
  end function reaches_beyond

  !> The mesh with its stiffness beyond A and E less by a `part` of it.
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

  !> Bound of the profile error (m), that of single teeth included.
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
    real(dp) :: s

    s = interval%place(phase, j)
    e = mesh%profile_error%value(s, mesh%profile_error%locate(s, interval%piece(:, j)))
    if (.not. allocated(interval%deviation)) return
    associate (deviation => interval%deviation_of(phase, j), wave => mesh%deviations%wave_at(interval%period, phase))
      e = e + deviation(1) + wave(1)
    end associate
  end function error_at

  !> Radius of curvature over base radius of a gear at s; beyond A and E the lever arm of friction over the base radius.
  elemental real(dp) function curvature_ratio(mesh, member, s) result(ratio)
    class(mesh_t), intent(in) :: mesh
    integer, intent(in) :: member
    real(dp), intent(in) :: s
    real(dp) :: past

    past = (s - mesh%pitch_point)*2*pi/mesh%teeth(member)
    if (member == 2) past = -past
    ratio = mesh%tan_angle + past
    if (s < 0) ratio = ratio + mesh%arm_change(member, 1)*s
    if (s > mesh%contact_ratio) ratio = ratio + mesh%arm_change(member, 2)*(s - mesh%contact_ratio)
  end function curvature_ratio

  !> What the load of a pair makes of the acceleration of the motion (1/kg): the friction factors of pinion and gear over their
  !> masses. The driving pinion's tooth slides inwards before the pitch point (-) and outwards after it (+).
  pure real(dp) function mobility(mesh, mass, friction, s, recess)
    class(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: mass(2)              !< of pinion and gear, kg
    real(dp), intent(in) :: friction             !< mu
    real(dp), intent(in) :: s                    !< path coordinate of the pair from A, base pitches
    logical, intent(in) :: recess                !< the pair has passed the pitch point
    real(dp) :: sense

    mobility = 1/mass(1) + 1/mass(2)
    if (.not. friction > 0) return
    sense = merge(friction, -friction, recess)
    mobility = mobility + sense*(mesh%curvature_ratio(1, s)/mass(1) + mesh%curvature_ratio(2, s)/mass(2))
  end function mobility
end module gearsweep_mesh
