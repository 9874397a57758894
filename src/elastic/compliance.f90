!> Compliance of a tooth on its body by finite elements: along the flank, at the tip corner, and through the body.
!>
!> The displacement under a point load grows without bound as the grid is refined. So the grid determines the displacement of the
!> point at a small depth along the line of action, which converges, and the deflection of the flank from the surface to that
!> depth is Hertz's, in closed form (gearsweep_elastic_flattening).
!>
!> All loads of a gear mesh are on one line, tangent to the base circle. So a complete gear held at its bore turns by the same
!> angle for any loaded tooth, and on any body the neighbouring teeth move too. The body's share is therefore one compliance for
!> all pairs in contact; a spring in each pair would count it once a pair.
module gearsweep_elastic_compliance
  use gearsweep_base, only: bracket_t, claim_memory, code_input, dp, error_t, fail, pi, piecewise_t, spline, str
  use gearsweep_gear, only: drive, gear_t, teeth_around
  use gearsweep_elastic_body, only: body_t, elastic_law, make_body
  use gearsweep_elastic_disc, only: disc_t
  use gearsweep_elastic_flattening, only: surface_to_depth
  use gearsweep_elastic_material, only: check_material, fe_options_t, material_t, section_options_t
  use gearsweep_elastic_q8, only: edge_functions, nodes_per_element, shape_functions
  use gearsweep_elastic_section, only: make_section, section_t, select_near_teeth
  use gearsweep_elastic_superelement, only: add_angular_momentum, make_superelement, superelement_t
  implicit none
  private
  public :: deflection_at_depth, load_line, flank_load, disc_compliance, turning, tooth_t, tooth_compliance

  !> Compliances of a tooth, per line load, m2/N.
  type :: tooth_t
    !> Compliance over the radius of curvature of the drive flank (m), minus `surface_to_depth` for the depth of one module. Of a
    !> complete gear also minus its rotation about the bore, which is in `disc`.
    type(piecewise_t) :: compliance
    type(disc_t) :: disc
    !> Compliance of the tip corner, over the tilt of the load against the flank's normal there (rad): twice that of the grid at
    !> `corner_depth` (m), minus that at twice the depth, along the load.
    type(piecewise_t) :: corner
    real(dp) :: corner_depth = 0
  end type tooth_t

  !> Largest tilt of the load at the tip corner.
  real(dp), parameter, public :: most_tilt = 0.4_dp
  integer, parameter :: tilts = 6

contains

  !> Computes the displacements, along the line of action, of the points at `near(i)` and `far(i)` (m) inside the drive flank of
  !> the loaded tooth, for a unit line load on the flank at `radius(i)` (m); m2/N. All loads are solved at once.
  subroutine deflection_at_depth(section, body, radius, near, far, at_near, at_far, error)
    type(section_t), intent(in) :: section
    type(body_t), intent(in) :: body
    real(dp), intent(in) :: radius(:), near(:), far(:)
    real(dp), intent(out) :: at_near(:), at_far(:)
    type(error_t), allocatable, intent(out) :: error
    real(dp), allocatable :: x(:, :)
    integer :: i

    call claim_memory(16.0_dp*body%unknowns*size(radius), 'elements across a tooth: the compliance on '// &
                      str(body%unknowns)//' unknowns', error)
    if (allocated(error)) return
    allocate (x(body%unknowns, size(radius)), source=0.0_dp)
    do i = 1, size(radius)
      call flank_load(section, body, radius(i), x(:, i), error)
      if (allocated(error)) return
    end do
    call body%stiffness%solve(x, error)
    if (allocated(error)) return
    do i = 1, size(radius)
      call read_depth(section, body, radius(i), near(i), x(:, i), at_near(i), error)
      if (.not. allocated(error)) call read_depth(section, body, radius(i), far(i), x(:, i), at_far(i), error)
      if (allocated(error)) return
    end do
    at_near = body%thickness*at_near
    at_far = body%thickness*at_far
  end subroutine deflection_at_depth

  !> Finds the point and the unit vector of a load on a tooth's drive flank: by default on the loaded tooth and along the flank's
  !> normal, optionally on another `tooth` or with a `tilt` (rad) towards the root.
  pure subroutine load_line(section, radius, point, direction, tooth, tilt)
    type(section_t), intent(in) :: section
    real(dp), intent(in) :: radius
    real(dp), intent(out) :: point(2), direction(2)
    integer, intent(in), optional :: tooth
    real(dp), intent(in), optional :: tilt
    real(dp) :: angle, along

    angle = section%axis(section%loaded) + section%gear%half_angle(drive, radius)
    if (present(tooth)) angle = section%axis(tooth) + section%gear%half_angle(drive, radius)
    point = radius*[sin(angle), cos(angle)]
    along = angle - acos(min(1.0_dp, section%gear%base_radius(drive)/radius))
    if (present(tilt)) along = along - tilt
    direction = [-cos(along), sin(along)]
  end subroutine load_line

  !> Adds a unit force, normal to a tooth's drive flank at `radius` (m), to the unknowns' forces `x`: consistent on the quadratic
  !> edge there. By default it acts on the loaded tooth; it may have a `tilt` (rad) against the normal.
  subroutine flank_load(section, body, radius, x, error, tooth, tilt)
    type(section_t), intent(in) :: section
    type(body_t), intent(in) :: body
    real(dp), intent(in) :: radius
    real(dp), intent(inout) :: x(:)
    type(error_t), allocatable, intent(out) :: error
    integer, intent(in), optional :: tooth
    real(dp), intent(in), optional :: tilt
    real(dp) :: point(2), direction(2), share(3), local
    integer :: nodes(3), on, i, d

    on = section%loaded
    if (present(tooth)) on = tooth
    call find_edge(section, on, radius, nodes, local)
    if (nodes(1) == 0) then
      call fail(error, code_input, 'load at radius '//str(1000*radius, 8)// &
        ' mm: off the flank, which runs from '//str(1000*section%gear%form_radius(drive), 8)//' to '// &
        str(1000*section%gear%tip_radius, 8)//' mm')
      return
    end if
    call load_line(section, radius, point, direction, on, tilt)
    share = edge_functions(local)
    do i = 1, size(nodes)
      do d = 1, 2
        associate (at => body%equation(d, nodes(i)))
          if (at > 0) x(at) = x(at) + share(i)*direction(d)
        end associate
      end do
    end do
  end subroutine flank_load

  !> Finds the edge of a tooth's drive flank that contains `radius`, and the place on it in [-1, 1].
  pure subroutine find_edge(section, tooth, radius, nodes, local)
    type(section_t), intent(in) :: section
    integer, intent(in) :: tooth
    real(dp), intent(in) :: radius
    integer, intent(out) :: nodes(3)
    real(dp), intent(out) :: local
    type(bracket_t) :: place
    real(dp) :: slack
    integer :: line, j, k

    line = section%flank_line(tooth, drive)
    nodes = 0
    local = 0
    slack = 1e-9_dp*radius
    if (radius < section%gear%form_radius(drive) - slack .or. radius > section%gear%tip_radius + slack) return
    associate (node => section%grid%node, x => section%grid%x)
      do j = findloc(node(line, :) > 0, .true., 1, back=.true.) - 3, 2*section%rim_rows, -2
        if (norm2(x(:, node(line, j))) <= radius + slack) exit
      end do
      j = max(j, 2*section%rim_rows)
      nodes = node(line, j:j + 2)
      place = bracket_t(-1.0_dp, 1.0_dp)
      do k = 1, 50
        local = place%middle()
        call place%halve(norm2(matmul(x(:, nodes), edge_functions(local))) < radius)
      end do
    end associate
  end subroutine find_edge

  !> Computes the displacement (m) along the line of action at a depth (m) below the flank, from the unknowns `x` (m).
  subroutine read_depth(section, body, radius, depth, x, displacement, error, tilt)
    type(section_t), intent(in) :: section
    type(body_t), intent(in) :: body
    real(dp), intent(in) :: radius, depth, x(:)
    real(dp), intent(out) :: displacement
    type(error_t), allocatable, intent(inout) :: error
    real(dp), intent(in), optional :: tilt
    real(dp) :: point(2), direction(2), local(2), share(nodes_per_element)
    integer :: element, i, d

    displacement = 0
    call load_line(section, radius, point, direction, tilt=tilt)
    point = point + depth*direction
    call section%grid%find(point, section%loaded, element, local)
    if (element == 0) call section%grid%find(point, 0, element, local)
    if (element == 0) then
      call fail(error, code_input, 'load at radius '//str(1000*radius, 8)//' mm: the point '// &
        str(1000*depth)//' mm below lies outside the grid')
      return
    end if
    share = shape_functions(local)
    do i = 1, nodes_per_element
      do d = 1, 2
        associate (at => body%equation(d, section%grid%element(i, element)))
          if (at > 0) displacement = displacement + share(i)*direction(d)*x(at)
        end associate
      end do
    end do
  end subroutine read_depth

  !> Computes `disc` of a section of two teeth or more under a unit line load (m2/N), over radii of curvature of the drive flank
  !> from `first` to `last` (m): over the interval where two teeth touch, by Gauss's rule. A section of one tooth has no neighbour
  !> and shares no compliance; one that is not a complete gear is held at its sides and does not turn. The compliance shared by
  !> the tooth after the next one hardly changes along the path: it is computed at one place, and is zero outside a section.
  subroutine disc_compliance(section, body, first, last, disc, error)
    type(section_t), intent(in) :: section
    type(body_t), intent(in) :: body
    real(dp), intent(in) :: first, last
    type(disc_t), intent(out) :: disc
    type(error_t), allocatable, intent(out) :: error
    integer, parameter :: places = 3
    real(dp), parameter :: node(places) = 0.5_dp + [-0.5_dp, 0.0_dp, 0.5_dp]*sqrt(0.6_dp)
    real(dp), parameter :: weight(places) = [5, 8, 5]/18.0_dp
    real(dp), allocatable :: x(:, :), next_tooth(:, :), couple(:)
    real(dp) :: pitch, curvature, turn(places), both(places)
    integer :: i

    if (section%options%teeth == 1) return
    call claim_memory(8.0_dp*body%unknowns*(2*places + 6), 'teeth of the section: what neighbours share, on '// &
                      str(body%unknowns)//' unknowns', error)
    if (allocated(error)) return
    allocate (x(body%unknowns, places), next_tooth(body%unknowns, places), source=0.0_dp)
    pitch = 2*pi*section%gear%base_radius(drive)/teeth_around(section%gear%spec)
    do i = 1, places
      curvature = first + (last - pitch - first)*node(i)
      call load_tooth(section%loaded, curvature, x(:, i))
      if (.not. allocated(error)) call load_tooth(section%loaded + 1, curvature + pitch, next_tooth(:, i))
      if (allocated(error)) return
    end do
    allocate (couple(body%unknowns), source=0.0_dp)
    if (is_complete(body)) couple = section%gear%base_radius(drive)*turning(body)
    call body%stiffness%solve(x, error)
    if (allocated(error)) return
    turn = body%thickness*[(dot_product(x(:, i), couple), i=1, places)]
    both = body%thickness*[(dot_product(x(:, i), next_tooth(:, i)), i=1, places)] - turn
    disc%turn = sum(weight*turn)
    disc%shared = sum(weight*both)
    disc%change = [3*sum(weight*(2*node - 1)*both), 5*sum(weight*(1.5_dp*(2*node - 1)**2 - 0.5_dp)*both)]
    disc%decline = disc%shared
    if (section%loaded + 2 > section%options%teeth) return
    next_tooth(:, 1) = 0
    curvature = first + (last - pitch - first)*node(1)
    call load_tooth(section%loaded + 2, min(last, curvature + 2*pitch), next_tooth(:, 1))
    if (allocated(error)) return
    disc%decline = disc%shared - (body%thickness*dot_product(x(:, 1), next_tooth(:, 1)) - turn(1))

  contains

    subroutine load_tooth(tooth, curvature, force)
      integer, intent(in) :: tooth
      real(dp), intent(in) :: curvature
      real(dp), intent(inout) :: force(:)

      call flank_load(section, body, contact_radius(section%gear, curvature), force, error, tooth)
    end subroutine load_tooth
  end subroutine disc_compliance

  !> Weights of the displacements in the angle (rad) by which `body` turns about the origin: angular momentum over moment of
  !> inertia, for uniform density. As forces they are a unit couple.
  pure function turning(body) result(weights)
    type(body_t), intent(in) :: body
    real(dp) :: weights(body%unknowns)
    real(dp) :: momentum(2, size(body%grid%x, 2)), inertia
    integer :: e

    momentum = 0
    inertia = 0
    do e = 1, size(body%grid%element, 2)
      call add_angular_momentum(body%grid%x(:, body%grid%element(:, e)), body%grid%element(:, e), momentum, inertia)
    end do
    if (body%rest%teeth > 0) then
      momentum(:, body%rest%node) = momentum(:, body%rest%node) + body%rest%momentum
      inertia = inertia + body%rest%inertia
    end if
    weights = body%gather(momentum)/inertia
  end function turning

  !> True for the body of a complete gear.
  pure logical function is_complete(body)
    type(body_t), intent(in) :: body

    is_complete = body%grid%closed .or. body%rest%teeth > 0
  end function is_complete

  !> Computes the `tooth` of `gear` over the radius of curvature of its drive flank from `first` to that of its tip, `last` (m).
  !>
  !> Computed from two depths, h and 2 h, and extrapolated to depth 0: the difference between the grid and the half plane from
  !> surface to depth is linear in h. Near the tip h decreases with the tooth.
  subroutine tooth_compliance(gear, material, options, first, last, tooth, error)
    type(gear_t), intent(in) :: gear
    type(material_t), intent(in) :: material
    type(fe_options_t), intent(in) :: options
    real(dp), intent(in) :: first, last
    type(tooth_t), intent(out) :: tooth
    type(error_t), allocatable, intent(out) :: error
    type(section_t) :: section
    type(body_t) :: body
    real(dp), dimension(max(4, options%positions)) :: curvature, radius, depth, near, far
    integer :: i, n

    call make_near_teeth(gear, material, options%section, section, body, error)
    if (allocated(error)) return
    ! Denser towards the tip, where the compliance rises steeply.
    n = size(curvature)
    curvature = [(sin(pi/2*i/(n - 1)), i=0, n - 1)]
    curvature = first + (last - first)*curvature
    radius = contact_radius(gear, curvature)
    ! The smaller of two lengths, rounded off so that the depth has no kink.
    depth = ((options%depth*gear%spec%module)**(-8) + (0.35_dp*chord(gear, radius))**(-8))**(-0.125_dp)
    call deflection_at_depth(section, body, radius, depth, 2*depth, near, far, error)
    if (allocated(error)) return
    if (is_complete(body) .or. options%tooth_coupling) call disc_compliance(section, body, first, last, tooth%disc, error)
    if (options%corner_contact .and. .not. allocated(error)) &
      call corner_compliance(section, body, radius(n), depth(n), tooth, error)
    if (allocated(error)) return
    ! Next to a held side of a section of two, the next tooth may move the other way by a negligible amount.
    if (.not. (options%tooth_coupling .and. tooth%disc%shared > 0)) tooth%disc = disc_t(turn=tooth%disc%turn)
    near = near + surface_to_depth(material, options%section%plane_strain, gear%spec%module, depth)
    far = far + surface_to_depth(material, options%section%plane_strain, gear%spec%module, 2*depth)
    ! The constant of the half plane is counted once with the flattening.
    tooth%compliance = spline(curvature, 2*near - far - surface_to_depth(material, options%section%plane_strain, 1.0_dp, 1.0_dp) &
                                         - tooth%disc%turn)
  end subroutine tooth_compliance

  !> Builds and factors the section of a tooth and its neighbours; of a complete gear, with the other teeth as a superelement.
  subroutine make_near_teeth(gear, material, options, section, body, error)
    type(gear_t), intent(in) :: gear
    type(material_t), intent(in) :: material
    type(section_options_t), intent(in) :: options
    type(section_t), intent(out) :: section
    type(body_t), intent(inout) :: body          !< one metre wide; its previous content is freed
    type(error_t), allocatable, intent(out) :: error
    type(section_options_t) :: near
    type(superelement_t) :: rest
    integer :: others

    call select_near_teeth(gear, options, near, others)
    call make_section(gear, near, section, error)
    if (.not. allocated(error)) call check_material(material, error)
    if (allocated(error)) return
    associate (held => section%is_held())
      if (others > 0) call make_superelement(section%grid, section%first_column(2) - section%first_column(1), others, &
                                             elastic_law(material, options%plane_strain), held, rest, error)
      if (allocated(error)) return
      call make_body(section%grid, material, options%plane_strain, 1.0_dp, spread(held, 1, 2), options%most_memory, body, error, &
                     rest)
    end associate
  end subroutine make_near_teeth

  !> Radius (m) of the contact with this radius of curvature (m) on the drive flank. The ends of a virtual gear's involute are
  !> nearly those of the helical gear's.
  elemental real(dp) function contact_radius(gear, curvature) result(radius)
    type(gear_t), intent(in) :: gear
    real(dp), intent(in) :: curvature

    radius = min(hypot(gear%base_radius(drive), curvature), gear%tip_radius)
    if (gear%spec%virtual_teeth > 0) radius = max(radius, gear%form_radius(drive))
  end function contact_radius

  !> Computes the compliance of the tip corner under loads of all tilts.
  subroutine corner_compliance(section, body, radius, depth, tooth, error)
    type(section_t), intent(in) :: section
    type(body_t), intent(in) :: body
    real(dp), intent(in) :: radius, depth
    type(tooth_t), intent(inout) :: tooth
    type(error_t), allocatable, intent(inout) :: error
    real(dp), dimension(tilts) :: tilt, lever, near, far
    integer :: i
    real(dp), allocatable :: x(:, :), both(:)

    tilt = [(most_tilt*i/(tilts - 1), i=0, tilts - 1)]
    ! Displacements for loads along the flank normal and across it; each tilted load is a combination of both.
    allocate (x(body%unknowns, 2), source=0.0_dp)
    call flank_load(section, body, radius, x(:, 1), error)
    if (.not. allocated(error)) call flank_load(section, body, radius, x(:, 2), error, tilt=pi/2)
    if (.not. allocated(error)) call body%stiffness%solve(x, error)
    if (allocated(error)) return
    do i = 1, size(tilt)
      both = x(:, 1)*cos(tilt(i)) + x(:, 2)*sin(tilt(i))
      call read_depth(section, body, radius, depth, both, near(i), error, tilt(i))
      if (.not. allocated(error)) call read_depth(section, body, radius, 2*depth, both, far(i), error, tilt(i))
      if (allocated(error)) return
    end do
    near = body%thickness*near
    far = body%thickness*far
    ! Lever arm of a tilted load over the base radius: the gear body rotates under its couple, which reduces the corner's motion.
    associate (angle => acos(min(1.0_dp, section%gear%base_radius(drive)/radius)))
      lever = cos(angle + tilt)/cos(angle)
    end associate
    tooth%corner_depth = depth
    tooth%corner = spline(tilt, 2*near - far - tooth%disc%turn*lever**2)
  end subroutine corner_compliance

  !> Length (m) of the line of action within the tooth, on involutes of the drive flank.
  elemental real(dp) function chord(gear, radius)
    type(gear_t), intent(in) :: gear
    real(dp), intent(in) :: radius
    real(dp) :: angle

    angle = gear%half_angle(drive, radius)
    chord = 2*radius*sin(angle)/cos(acos(min(1.0_dp, gear%base_radius(drive)/radius)) - angle)
  end function chord
end module gearsweep_elastic_compliance
