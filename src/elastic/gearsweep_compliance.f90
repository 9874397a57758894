!> Compliance of a tooth on its body along the flank.
!>
!> The displacement under a point load grows without bound as the grid is
!> refined. So the grid gives the displacement of the point at a small depth
!> along the line of action, which converges, and the yield of the flank from
!> the surface to that depth is Hertz's, in closed form (gearsweep_flattening).
module gearsweep_compliance
  use gearsweep_kinds, only: dp, pi
  use gearsweep_body, only: body_t
  use gearsweep_error, only: error_t, fail, code_input
  use gearsweep_gear, only: gear_t, drive, coast
  use gearsweep_memory, only: claim_memory
  use gearsweep_outline, only: involute_point
  use gearsweep_q8, only: shape_functions, edge_functions
  use gearsweep_section, only: section_t
  use gearsweep_text, only: str
  implicit none
  private
  public :: deflection_at_depth, load_line, flank_load

contains

  !> Displacements, along the line of action, of the points at `near(i)` and
  !> `far(i)` (m) inside the drive flank of the loaded tooth, for a unit line
  !> load on the flank at `radius(i)` (m); m2/N. One forward sweep serves all:
  !> f' K^-1 g = (L^-1 f)' (L^-1 g).
  subroutine deflection_at_depth(section, body, radius, near, far, at_near, at_far, error)
    type(section_t), intent(in) :: section
    type(body_t), intent(in) :: body
    real(dp), intent(in) :: radius(:), near(:), far(:)
    real(dp), intent(out) :: at_near(:), at_far(:)
    type(error_t), allocatable, intent(out) :: error
    real(dp), allocatable :: x(:, :)
    integer :: i, n, first

    n = size(radius)
    ! Forces, and which are not zero.
    call claim_memory(16.0_dp*body%unknowns*3*n, '&section elements_across: the compliance on '//str(body%unknowns)//' unknowns', &
                      error, blas=.true.)
    if (allocated(error)) return
    allocate (x(body%unknowns, 3*n), source=0.0_dp)
    do i = 1, n
      call flank_load(section, body, radius(i), x(:, i), error)
      if (.not. allocated(error)) call depth_load(section, body, radius(i), near(i), x(:, n + i), error)
      if (.not. allocated(error)) call depth_load(section, body, radius(i), far(i), x(:, 2*n + i), error)
      if (allocated(error)) return
    end do
    first = findloc(any(abs(x) > 0, dim=2), .true., 1)
    call body%stiffness%forward(x, first)
    do i = 1, n
      at_near(i) = body%thickness*dot_product(x(first:, i), x(first:, n + i))
      at_far(i) = body%thickness*dot_product(x(first:, i), x(first:, 2*n + i))
    end do
  end subroutine deflection_at_depth

  !> Where a load on a tooth's drive flank acts, and along which unit vector; on the loaded tooth unless said.
  pure subroutine load_line(section, radius, point, direction, tooth)
    type(section_t), intent(in) :: section
    real(dp), intent(in) :: radius
    real(dp), intent(out) :: point(2), direction(2)
    integer, intent(in), optional :: tooth
    real(dp) :: angle, along

    angle = section%axis(section%loaded) + section%gear%half_angle(drive, radius)
    if (present(tooth)) angle = section%axis(tooth) + section%gear%half_angle(drive, radius)
    point = radius*[sin(angle), cos(angle)]
    along = angle - acos(min(1.0_dp, section%gear%base_radius(drive)/radius))
    direction = [-cos(along), sin(along)]
  end subroutine load_line

  !> Adds a unit force, normal to a tooth's drive flank at `radius` (m), to the
  !> unknowns' forces `x`: consistent on the quadratic edge there. It is the
  !> loaded tooth unless said.
  subroutine flank_load(section, body, radius, x, error, tooth)
    type(section_t), intent(in) :: section
    type(body_t), intent(in) :: body
    real(dp), intent(in) :: radius
    real(dp), intent(inout) :: x(:)
    type(error_t), allocatable, intent(out) :: error
    integer, intent(in), optional :: tooth
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
    call load_line(section, radius, point, direction, on)
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

  !> Adds a unit force at a depth along the line of action.
  subroutine depth_load(section, body, radius, depth, x, error)
    type(section_t), intent(in) :: section
    type(body_t), intent(in) :: body
    real(dp), intent(in) :: radius, depth
    real(dp), intent(inout) :: x(:)
    type(error_t), allocatable, intent(out) :: error
    real(dp) :: point(2), direction(2), local(2)
    integer :: element

    call load_line(section, radius, point, direction)
    point = point + depth*direction
    call section%grid%find(point, section%loaded, element, local)
    if (element == 0) call section%grid%find(point, 0, element, local)
    if (element == 0) then
      call fail(error, code_input, 'load at radius '//str(1000*radius, 8)//' mm: the point '// &
        str(1000*depth)//' mm below lies outside the grid')
      return
    end if
    call add_force(body, section%grid%element(:, element), shape_functions(local), direction, x)
  end subroutine depth_load

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
