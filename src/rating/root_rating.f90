!> Root stress over the path of contact under the actual load of each pair.
module gearsweep_rating_root_rating
  use gearsweep_base, only: claim_memory, dp, error_t, pi, sorted, str
  use gearsweep_gear, only: coast, drive, pair_t
  use gearsweep_elastic, only: root_stress_t
  use gearsweep_mesh, only: load_share, mesh_t
  use gearsweep_rating_form, only: iso_form, iso_form_t, lewis_factor, nominal_root_stress
  implicit none
  private
  public :: root_options_t, root_rating_t, rate_root, load_positions, load_radius, load_shares, outer_point

  integer, parameter, public :: shared_by_mesh = 0, shared_equally = 1, shares_stated = 2
  integer, parameter, public :: spaced_on_path = 0, spaced_on_flank = 1

  type :: root_options_t
    integer :: gear = 1                        !< 1 pinion, 2 gear
    integer :: positions = 33                    !< number of positions of the load, from A to E
    integer :: spacing = spaced_on_path          !< spacing: equal steps of s, or of the arc from tip to A
    integer :: sharing = shared_by_mesh
    real(dp), allocatable :: shares(:)           !< with `shares_stated`: share of the load at each position
    real(dp) :: tangent = pi/6                   !< fillet tangent angle of the printed stress, rad
    !> Position of the load for the stress field, from 1; 0: that of the largest tension; -1: no field.
    integer :: field_position = -1
  end type root_options_t

  type :: root_rating_t
    real(dp), allocatable :: s(:)                !< path coordinate of the load, base pitches
    real(dp), allocatable :: radius(:)           !< radius of the load on the gear, m
    real(dp), allocatable :: share(:)            !< share of the static load
    !> Stress at the fillet tangent, along the surface, drive and coast side, Pa (2, positions).
    real(dp), allocatable :: along(:, :)
    !> Stress components across and along the tooth axis and in shear, Pa (3, 2, positions).
    real(dp), allocatable :: components(:, :, :)
    type(root_stress_t) :: stress                !< fillet stress with the peaks and the error estimate
    type(iso_form_t) :: iso                      !< form factors at the outer point of single contact
    real(dp) :: lewis = 0                        !< Lewis form factor there
    real(dp) :: iso_stress = 0                   !< sigma_F0 = F_t/(b m) Y_F Y_S, Pa
    real(dp) :: lewis_stress = 0                 !< bending stress by Lewis, Pa
  end type root_rating_t

contains

  !> Rates the root of one gear under `load` (N) on the line of action, for each of the meshes, which differ in their relief, from
  !> one solution for unit loads. `unit` is that of `root_stress`, for a line load of 1 N/m at each of the positions
  !> `load_positions`.
  subroutine rate_root(pair, mesh, load, unit, options, rating, error)
    type(pair_t), intent(in) :: pair
    type(mesh_t), intent(in) :: mesh(:)
    real(dp), intent(in) :: load
    type(root_stress_t), intent(in) :: unit
    type(root_options_t), intent(in) :: options
    type(root_rating_t), allocatable, intent(out) :: rating(:)
    type(error_t), allocatable, intent(out) :: error
    real(dp), allocatable :: s(:), radius(:)
    integer :: i

    allocate (rating(size(mesh)))
    s = load_positions(pair, options, mesh(1)%reach)
    allocate (radius, source=load_radius(pair, options, s))
    ! Memory for each relief's stress along both fillets, and a copy while it is computed.
    call claim_memory((size(mesh) + 2.0_dp)*(size(s)*(100 + 8.0_dp*sum([(size(unit%side(i)%along), i=1, 2)])) &
                      + 50.0_dp*sum([(size(unit%side(i)%along), i=1, 2)])), &
                      'positions of the load = '//str(size(s))//': '//str(size(mesh))//' reliefs', error)
    if (allocated(error)) return
    do i = 1, size(mesh)
      rating(i)%s = s
      rating(i)%radius = radius
      rating(i)%share = load_shares(mesh(i), load, options, s)
      rating(i)%stress = unit%under_loads(rating(i)%share*load/minval(pair%gear%spec%face_width))
      call read_off(options%tangent, rating(i), error)
      if (allocated(error)) return
      call compare(pair, load, options%gear, rating(i))
    end do
  end subroutine rate_root

  !> Reads the stress at the fillet tangent on both sides.
  subroutine read_off(tangent, rating, error)
    real(dp), intent(in) :: tangent
    type(root_rating_t), intent(inout) :: rating
    type(error_t), allocatable, intent(out) :: error
    real(dp), allocatable :: along(:), components(:, :)
    integer :: side

    associate (n => size(rating%s))
      allocate (rating%along(2, n), rating%components(3, 2, n))
    end associate
    do side = drive, coast
      call rating%stress%at_tangent(side, tangent, along, components, error)
      if (allocated(error)) return
      rating%along(side, :) = along
      rating%components(:, side, :) = components
    end do
  end subroutine read_off

  !> Computes form factors for the full load at the outermost point of single contact.
  pure subroutine compare(pair, load, which, rating)
    type(pair_t), intent(in) :: pair
    real(dp), intent(in) :: load
    integer, intent(in) :: which
    type(root_rating_t), intent(inout) :: rating
    real(dp) :: nominal

    associate (gear => pair%gear(which), width => minval(pair%gear%spec%face_width))
      rating%iso = iso_form(gear, outer_point(pair, which))
      rating%lewis = lewis_factor(gear, outer_point(pair, which))
      nominal = load/(width*gear%spec%module)
      rating%iso_stress = nominal_root_stress(pair, which, rating%iso, load)
      rating%lewis_stress = nominal*cos(rating%iso%load_angle)/rating%lewis
    end associate
  end subroutine compare

  !> Outermost radius (m) at which the gear carries load with the fewest pairs.
  pure real(dp) function outer_point(pair, gear)
    type(pair_t), intent(in) :: pair
    integer, intent(in) :: gear
    real(dp) :: s(5)

    s = pair%points()
    outer_point = pair%radius(gear, merge(s(4), s(2), gear == 1))
  end function outer_point

  !> Path coordinates of the load. On the path, each jump of the share has a position on both sides; on the flank, equal arcs lead
  !> from the tip down. If tip corners touch within `reach` (see mesh_t), the share has no jumps, but falls off steeply where
  !> another pair begins beyond the path: there the positions are denser.
  pure function load_positions(pair, options, reach) result(s)
    type(pair_t), intent(in) :: pair
    type(root_options_t), intent(in) :: options
    real(dp), intent(in) :: reach(2)
    real(dp), allocatable :: s(:)
    real(dp), parameter :: beside = 1e-9_dp
    !> Reach of corner contact beyond A and E under usual loads, base pitches; the same for any load, so that one solution for unit
    !> loads is valid for all loads.
    real(dp), parameter :: step = 0.01_dp, farthest = 0.12_dp
    real(dp) :: curvature(2), base
    real(dp), allocatable :: corners(:)
    integer :: i, n

    n = max(2, options%positions)
    corners = step*[(i, i=1, nint(farthest/step))]
    if (options%spacing == spaced_on_path) then
      ! A pair enters or leaves at integer s and at integers before E.
      s = [(pair%contact_ratio*i/(n - 1), i=0, n - 1)]
      do i = 1, int(pair%contact_ratio)
        s = [s, i + [-beside, beside], pair%contact_ratio - i + [-beside, beside]]
        if (options%sharing /= shared_by_mesh) cycle
        if (reach(1) < 0) s = [s, i - corners]
        if (reach(2) > pair%contact_ratio) s = [s, pair%contact_ratio - i + corners]
      end do
      s = sorted(max(0.0_dp, min(pair%contact_ratio, s)))
    else
      ! The arc of an involute is proportional to the square of the radius of curvature.
      base = pair%gear(options%gear)%base_radius(drive)
      curvature = pair%curvature(options%gear, [0.0_dp, pair%contact_ratio])
      curvature = [maxval(curvature), minval(curvature)]
      s = [(sqrt(curvature(1)**2 + (curvature(2)**2 - curvature(1)**2)*i/(n - 1)), i=0, n - 1)]
      s = (s - pair%curvature(options%gear, 0.0_dp))/pair%base_pitch
      if (options%gear == 2) s = -s
      s = max(0.0_dp, min(pair%contact_ratio, s))
    end if
  end function load_positions

  !> Radii of the load on the gear (m) at the path coordinates `s`.
  pure function load_radius(pair, options, s) result(radius)
    type(pair_t), intent(in) :: pair
    type(root_options_t), intent(in) :: options
    real(dp), intent(in) :: s(:)
    real(dp) :: radius(size(s))

    radius = min(pair%radius(options%gear, s), pair%gear(options%gear)%tip_radius)
  end function load_radius

  !> Share of one pair in the static `load` (N) at the path coordinates `s`.
  pure function load_shares(mesh, load, options, s) result(share)
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: load, s(:)
    type(root_options_t), intent(in) :: options
    real(dp) :: share(size(s))
    integer :: i

    select case (options%sharing)
    case (shares_stated)
      share = options%shares
    case (shared_equally)
      share = 1.0_dp/(1 + floor(s) + max(0, ceiling(mesh%contact_ratio - s) - 1))
    case default
      share = [(load_share(mesh, load, s(i)), i=1, size(s))]
    end select
  end function load_shares
end module gearsweep_rating_root_rating
