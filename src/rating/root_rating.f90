!> Root stress over the path of contact under the actual load of each pair.
module gearsweep_rating_root_rating
  use gearsweep_base, only: claim_memory, code_input, dp, error_t, fail, pi, sorted, str
  use gearsweep_gear, only: coast, drive, pair_t
  use gearsweep_elastic, only: grid_t, loaded_stress, root_stress_t, section_body_t
  use gearsweep_mesh, only: load_share, mesh_t
  use gearsweep_rating_form, only: iso_form, iso_form_t, lewis_factor, nominal_root_stress
  implicit none
  private
  public :: root_options_t, root_rating_t, rate_root, load_positions, load_radius, load_shares, outer_point, stress_field_t, &
            find_stress_field

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

  !> Stress field of a section under one position of the load, for pictures.
  type :: stress_field_t
    integer :: relief = 0                        !< index of the relief
    integer :: position = 0                      !< index of the load position
    type(grid_t) :: grid
    real(dp), allocatable :: stress(:, :)        !< sigma_x, sigma_y, tau_xy at the nodes (3, nodes), Pa
  end type stress_field_t

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
    real(dp), allocatable :: s(:), radius(:), along(:), components(:, :)
    integer :: i, side
    real(dp) :: nominal

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
      associate (n => size(rating(i)%s))
        allocate (rating(i)%along(2, n), rating(i)%components(3, 2, n))
      end associate
      do side = drive, coast
        call rating(i)%stress%at_tangent(side, options%tangent, along, components, error)
        if (allocated(error)) return
        rating(i)%along(side, :) = along
        rating(i)%components(:, side, :) = components
      end do
      ! Form factors for the full load at the outermost point of single contact.
      associate (gear => pair%gear(options%gear), width => minval(pair%gear%spec%face_width))
        rating(i)%iso = iso_form(gear, outer_point(pair, options%gear))
        rating(i)%lewis = lewis_factor(gear, outer_point(pair, options%gear))
        nominal = load/(width*gear%spec%module)
        rating(i)%iso_stress = nominal_root_stress(pair, options%gear, rating(i)%iso, load)
        rating(i)%lewis_stress = nominal*cos(rating(i)%iso%load_angle)/rating(i)%lewis
      end associate
    end do
  end subroutine rate_root

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

  !> Finds the stress field of the relief with the largest tension, under the load position of that tension or under another one.
  subroutine find_stress_field(section, rating, load, position, field, error)
    type(section_body_t), intent(in) :: section  !< section of `rating`, the finer of the two
    type(root_rating_t), intent(in) :: rating(:)  !< one for each relief
    real(dp), intent(in) :: load                 !< static load over the face width, N/m
    integer, intent(in) :: position              !< index of the load position, from 1; 0: that of the largest tension
    type(stress_field_t), intent(out) :: field
    type(error_t), allocatable, intent(inout) :: error   !< position out of range, or out of memory

    field%relief = maxloc(rating%stress%tension%stress, 1)
    associate (worst => rating(field%relief))
      field%position = position
      if (position == 0) field%position = worst%stress%tension%load
      if (field%position > size(worst%s)) then
        call fail(error, code_input, 'position of the load of the stress field = '//str(position)//': must be at most '// &
                  str(size(worst%s))// &
                  ', as the load has so many positions')
        return
      end if
      call loaded_stress(section, worst%radius(field%position), load*worst%share(field%position), field%stress, error)
      field%grid = section%section%grid
    end associate
  end subroutine find_stress_field
end module gearsweep_rating_root_rating
