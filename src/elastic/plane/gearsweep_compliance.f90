!> Compliance of a tooth on its body along the flank.
!>
!> The displacement under a point load grows without bound as the grid is
!> refined. So the grid gives the displacement of the point at a small depth
!> along the line of action, which converges, and the deflection of the flank from
!> the surface to that depth is Hertz's, in closed form (gearsweep_flattening).
module gearsweep_compliance
  use gearsweep_kinds, only: dp, pi
  use gearsweep_body, only: body_t
  use gearsweep_error, only: error_t, fail, code_input
  use gearsweep_gear, only: gear_t, drive, coast
  use gearsweep_memory, only: claim_memory
  use gearsweep_outline, only: involute_point
  use gearsweep_q8, only: edge_functions, nodes_per_element, shape_functions
  use gearsweep_section, only: section_t
  use gearsweep_text, only: str
  implicit none
  private
  public :: deflection_at_depth, corner_deflection, load_line, flank_load

contains

  !> Displacements, along the line of action, of the points at `near(i)` and
  !> `far(i)` (m) inside the drive flank of the loaded tooth, for a unit line
  !> load on the flank at `radius(i)` (m); m2/N. All loads are solved for at once.
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

  !> The same for a unit line load on the tip corner at `radius` (m), each with its own `tilt` (rad) from the flank's
  !> normal towards the tip land's, read along the load.
  subroutine corner_deflection(section, body, radius, depth, tilt, at_near, at_far, error)
    type(section_t), intent(in) :: section
    type(body_t), intent(in) :: body
    real(dp), intent(in) :: radius, depth, tilt(:)
    real(dp), intent(out) :: at_near(:), at_far(:)
    type(error_t), allocatable, intent(out) :: error
    real(dp), allocatable :: x(:, :), both(:)
    integer :: i

    call claim_memory(32.0_dp*body%unknowns, 'corner contact: the tip corner on '//str(body%unknowns)//' unknowns', error)
    if (allocated(error)) return
    allocate (x(body%unknowns, 2), source=0.0_dp)
    call flank_load(section, body, radius, x(:, 1), error)
    if (.not. allocated(error)) call flank_load(section, body, radius, x(:, 2), error, tilt=pi/2)
    if (.not. allocated(error)) call body%stiffness%solve(x, error)
    if (allocated(error)) return
    do i = 1, size(tilt)
      both = x(:, 1)*cos(tilt(i)) + x(:, 2)*sin(tilt(i))
      call read_depth(section, body, radius, depth, both, at_near(i), error, tilt(i))
      if (.not. allocated(error)) call read_depth(section, body, radius, 2*depth, both, at_far(i), error, tilt(i))
      if (allocated(error)) return
    end do
    at_near = body%thickness*at_near
    at_far = body%thickness*at_far
  end subroutine corner_deflection

  !> Where a load on a tooth's drive flank acts, and along which unit vector: on the loaded tooth and along the flank's
  !> normal, unless a tooth or a `tilt` (rad) towards the root is said.
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

  !> Adds a unit force, normal to a tooth's drive flank at `radius` (m), to the
  !> unknowns' forces `x`: consistent on the quadratic edge there. It is the
  !> loaded tooth unless said, and the force may have a `tilt` (rad) against the normal.
  subroutine flank_load(section, body, radius, x, error, tooth, tilt)
    type(section_t), intent(in) :: section
    type(body_t), intent(in) :: body
    real(dp), intent(in) :: radius
    real(dp), intent(inout) :: x(:)
    type(error_t), allocatable, intent(out) :: error
    integer, intent(in), optional :: tooth
    real(dp), intent(in), optional :: tilt
    real(dp) :: point(2), direction(2), share(3), local
    integer :: nodes(3), on

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
    call add_force(body, nodes, share, direction, x)
  end subroutine flank_load

  !> The edge of a tooth's drive flank that holds `radius`, and the place on it in [-1, 1].
  pure subroutine find_edge(section, tooth, radius, nodes, local)
    type(section_t), intent(in) :: section
    integer, intent(in) :: tooth
    real(dp), intent(in) :: radius
    integer, intent(out) :: nodes(3)
    real(dp), intent(out) :: local
    real(dp) :: low, high, slack
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
      low = -1
      high = 1
      do k = 1, 50
        local = (low + high)/2
        if (norm2(matmul(x(:, nodes), edge_functions(local))) < radius) then
          low = local
        else
          high = local
        end if
      end do
    end associate
  end subroutine find_edge

  !> The displacement (m) along the line of action at a depth (m) below the flank, of the unknowns `x` (m).
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

  pure subroutine add_force(body, nodes, share, force, x)
    type(body_t), intent(in) :: body
    integer, intent(in) :: nodes(:)
    real(dp), intent(in) :: share(:), force(2)
    real(dp), intent(inout) :: x(:)
    integer :: i, d

    do i = 1, size(nodes)
      do d = 1, 2
        associate (at => body%equation(d, nodes(i)))
          if (at > 0) x(at) = x(at) + share(i)*force(d)
        end associate
      end do
    end do
  end subroutine add_force
end module gearsweep_compliance
