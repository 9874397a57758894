!> Stress at the tooth root while the load moves over the flank, and stress at all nodes of a section for pictures.
!>
!> The fillet carries no load, so the stress there acts along the surface alone and follows from the surface strain. It is
!> evaluated at two points of each edge where the strain of a quadratic edge is one order better than elsewhere, and a spline
!> joins them.
module gearsweep_elastic_stress
  use gearsweep_base, only: claim_memory, code_input, dp, error_t, fail, pi, piecewise_t, spline, str
  use gearsweep_gear, only: coast, drive, fillet_parameter, fillet_point, gear_t
  use gearsweep_elastic_body, only: body_t, elastic_law
  use gearsweep_elastic_compliance, only: flank_load
  use gearsweep_elastic_q8, only: edge_functions, edge_slopes, element_gradients, nodes_per_element
  use gearsweep_elastic_section, only: section_body_t, section_t, stress_error_share
  implicit none
  private
  public :: root_stress_t, stress_peak_t, fillet_stress_t, find_root_stress, root_stress, along_fillet, find_peaks, &
            peak_difference, nodal_stress, loaded_stress

  !> Largest value, with its place and the index of its load.
  type :: stress_peak_t
    real(dp) :: stress = 0                       !< Pa
    real(dp) :: point(2) = 0                     !< in the tooth's frame, axis along y, m
    real(dp) :: tangent = 0                      !< angle of the surface to the tooth axis, rad
    integer :: load = 0
    integer :: side = 0                          !< drive or coast
  end type stress_peak_t

  !> Stress along one side's fillet and half its root land, upwards.
  type :: fillet_stress_t
    real(dp), allocatable :: along(:)            !< length along the surface from the middle of the root land, m
    real(dp), allocatable :: point(:, :)         !< in the tooth's frame (2, points), m
    real(dp), allocatable :: tangent(:)          !< angle to the tooth axis, rad
    real(dp), allocatable :: stress(:, :)        !< along the surface (points, loads), Pa
  end type fillet_stress_t

  type :: root_stress_t
    type(gear_t) :: gear
    type(fillet_stress_t) :: side(2)             !< drive, coast
    type(stress_peak_t) :: tension, compression         !< largest over both sides and all loads
    real(dp) :: error_estimate = 0               !< relative error of the larger; 0: not estimated
  contains
    procedure :: at_tangent
    procedure :: under_loads
  end type root_stress_t

  !> Points at which the derivative of a quadratic is exact for a cubic.
  real(dp), parameter, public :: best = 1/sqrt(3.0_dp)

contains

  !> Computes the root stress of the loaded tooth, from its section's two grids (make_two_grids); their largest difference around
  !> the peaks is the error estimate.
  !>
  !> `radius(:)` (m) and `line_load(:)` (N/m) are place and load of this tooth at each position, that is with its share of the
  !> load.
  subroutine root_stress(grids, radius, line_load, product, error)
    type(section_body_t), intent(in) :: grids(2)
    real(dp), intent(in) :: radius(:), line_load(:)
    type(root_stress_t), intent(out) :: product
    type(error_t), allocatable, intent(out) :: error
    type(root_stress_t) :: coarse

    call find_root_stress(grids(1)%section, grids(1)%body, radius, line_load, product, error)
    if (allocated(error)) return
    call find_root_stress(grids(2)%section, grids(2)%body, radius, line_load, coarse, error)
    if (allocated(error)) return
    product%error_estimate = max(peak_difference(product, coarse, product%tension), &
                                 peak_difference(product, coarse, product%compression))
    product%error_estimate = product%error_estimate*stress_error_share(grids)
  end subroutine root_stress

  !> Largest relative difference of two grids where the stress is within a tenth of the peak, or largest where only two points are
  !> so near to it: the peaks alone may agree by chance. The length along the surface identifies the points, as a root land or an
  !> undercut fillet has two points of one height.
  pure real(dp) function peak_difference(fine, coarse, peak) result(most)
    type(root_stress_t), intent(in) :: fine, coarse
    type(stress_peak_t), intent(in) :: peak
    type(piecewise_t) :: curve
    real(dp) :: near
    integer :: i

    most = 0
    if (peak%load == 0) return
    associate (f => fine%side(peak%side), c => coarse%side(peak%side))
      curve = spline(c%along, c%stress(:, peak%load))
      near = min(0.9_dp, maxval(f%stress(:, peak%load)/peak%stress))
      do i = 1, size(f%along)
        if (f%stress(i, peak%load)/peak%stress < near) cycle
        most = max(most, abs((f%stress(i, peak%load) - curve%value(f%along(i)))/peak%stress))
      end do
    end associate
  end function peak_difference

  !> Computes the root stress on one grid, without an estimate.
  subroutine find_root_stress(section, body, radius, line_load, product, error)
    type(section_t), intent(in) :: section
    type(body_t), intent(in) :: body
    real(dp), intent(in) :: radius(:), line_load(:)
    type(root_stress_t), intent(out) :: product
    type(error_t), allocatable, intent(out) :: error
    real(dp), allocatable :: x(:, :), u(:, :, :)
    integer :: i

    if (size(radius) < 1 .or. size(radius) /= size(line_load)) then
      call fail(error, code_input, 'line loads: as many line loads as positions are needed, and at least one')
      return
    end if
    ! Memory of forces and displacements, and of the stress along the fillets.
    call claim_memory(size(radius)*(8.0_dp*body%unknowns + 16.0_dp*size(section%grid%x, 2) &
                                    + 64.0_dp*size(section%grid%node, 2)), &
                      'positions of the load = '//str(size(radius)), error, blas=.true.)
    if (allocated(error)) return
    allocate (x(body%unknowns, size(radius)), u(2, size(section%grid%x, 2), size(radius)))
    x = 0
    do i = 1, size(radius)
      call flank_load(section, body, radius(i), x(:, i), error)
      if (allocated(error)) return
      x(:, i) = x(:, i)*line_load(i)*body%thickness
    end do
    call body%stiffness%solve(x, error)
    if (allocated(error)) return
    do i = 1, size(radius)
      u(:, :, i) = body%spread_out(x(:, i))
    end do
    product%gear = section%gear
    call along_fillet(section, body, u, drive, product%side(drive))
    call along_fillet(section, body, u, coast, product%side(coast))
    call find_peaks(product)
  end subroutine find_root_stress

  !> Computes the stress at the best points of each edge below the form circle.
  pure subroutine along_fillet(section, body, u, side, fillet)
    type(section_t), intent(in) :: section
    type(body_t), intent(in) :: body
    real(dp), intent(in) :: u(:, :, :)
    integer, intent(in) :: side
    type(fillet_stress_t), intent(out) :: fillet
    integer, allocatable :: nodes(:)
    integer :: e, edges, n, g, load
    real(dp) :: law(3), modulus, tangent(2), rise(2)

    law = elastic_law(body%material, body%plane_strain)
    modulus = law(1) - law(2)**2/law(1)
    nodes = section%surface(section%loaded, side)
    edges = count(norm2(section%grid%x(:, nodes(2::2)), 1) < section%gear%form_radius(side))
    allocate (fillet%along(2*edges), fillet%point(2, 2*edges), fillet%tangent(2*edges))
    allocate (fillet%stress(2*edges, size(u, 3)))
    do e = 1, edges
      do g = 1, 2
        n = 2*(e - 1) + g
        associate (t => merge(-best, best, g == 1), on => nodes(2*e - 1:2*e + 1))
          fillet%point(:, n) = in_tooth_frame(matmul(section%grid%x(:, on), edge_functions(t)))
          tangent = matmul(section%grid%x(:, on), edge_slopes(t))
          rise = in_tooth_frame(tangent)
          ! Undercut is inclined the other way.
          fillet%tangent(n) = atan2(merge(-rise(1), rise(1), side == drive), rise(2))
          do load = 1, size(u, 3)
            fillet%stress(n, load) = modulus*dot_product(tangent, matmul(u(:, on, load), edge_slopes(t)))/sum(tangent**2)
          end do
        end associate
      end do
    end do
    fillet%along(1) = norm2(fillet%point(:, 1) - in_tooth_frame(section%grid%x(:, nodes(1))))
    do n = 2, 2*edges
      fillet%along(n) = fillet%along(n - 1) + norm2(fillet%point(:, n) - fillet%point(:, n - 1))
    end do

  contains

    pure function in_tooth_frame(v) result(w)
      real(dp), intent(in) :: v(2)
      real(dp) :: w(2)

      associate (a => section%axis(section%loaded))
        w = [v(1)*cos(a) - v(2)*sin(a), v(1)*sin(a) + v(2)*cos(a)]
      end associate
    end function in_tooth_frame
  end subroutine along_fillet

  !> Scales the stress by a factor for each load, with the resulting peaks.
  pure function under_loads(product, factor) result(scaled)
    class(root_stress_t), intent(in) :: product
    real(dp), intent(in) :: factor(:)
    type(root_stress_t) :: scaled
    integer :: side, load

    scaled%gear = product%gear
    scaled%error_estimate = product%error_estimate
    do side = drive, coast
      scaled%side(side) = product%side(side)
      do load = 1, size(factor)
        scaled%side(side)%stress(:, load) = product%side(side)%stress(:, load)*factor(load)
      end do
    end do
    call find_peaks(scaled)
  end function under_loads

  !> Finds the peaks of the splines, on a fine scan.
  pure subroutine find_peaks(product)
    type(root_stress_t), intent(inout) :: product
    integer, parameter :: scan = 16
    type(piecewise_t) :: curve
    real(dp) :: s, value
    integer :: side, load, i, k

    do side = drive, coast
      associate (fillet => product%side(side))
        do load = 1, size(fillet%stress, 2)
          curve = spline(fillet%along, fillet%stress(:, load))
          do i = 1, size(fillet%along) - 1
            do k = 0, scan
              s = fillet%along(i) + (fillet%along(i + 1) - fillet%along(i))*k/scan
              value = curve%value(s, i)
              if (value > product%tension%stress) call note(product%tension)
              if (value < product%compression%stress) call note(product%compression)
            end do
          end do
        end do
      end associate
    end do

  contains

    pure subroutine note(peak)
      type(stress_peak_t), intent(inout) :: peak
      type(piecewise_t) :: part

      associate (fillet => product%side(side))
        peak%stress = value
        peak%side = side
        peak%load = load
        part = spline(fillet%along, fillet%point(1, :))
        peak%point(1) = part%value(s)
        part = spline(fillet%along, fillet%point(2, :))
        peak%point(2) = part%value(s)
        part = spline(fillet%along, fillet%tangent)
        peak%tangent = part%value(s)
      end associate
    end subroutine note
  end subroutine find_peaks

  !> Computes the stress where the fillet's tangent is at the angle `tangent` (rad) to the tooth axis, for all loads: along the
  !> surface (Pa), and its components sigma_x, sigma_y, tau_xy (3, loads) with y along the tooth axis and x towards the drive
  !> side. `along_surface`: the surface's direction there.
  subroutine at_tangent(product, side, tangent, along, components, error, along_surface)
    class(root_stress_t), intent(in) :: product
    integer, intent(in) :: side
    real(dp), intent(in) :: tangent
    real(dp), allocatable, intent(out) :: along(:), components(:, :)
    type(error_t), allocatable, intent(out) :: error
    real(dp), intent(out), optional :: along_surface(2)
    type(piecewise_t) :: place, curve
    real(dp) :: point(2), s, direction(2)
    integer :: load

    associate (fillet => product%side(side))
      if (.not. (tangent >= minval(fillet%tangent) .and. tangent <= maxval(fillet%tangent))) then
        call fail(error, code_input, 'tangent at the fillet (deg) = '//str(tangent*180/pi)// &
          ': must lie between '//str(minval(fillet%tangent)*180/pi)//' and '//str(maxval(fillet%tangent)*180/pi))
        return
      end if
      point = fillet_point(product%gear, side, fillet_parameter(product%gear, side, tangent))
      place = spline(fillet%point(2, :), fillet%along)
      s = place%value(point(2))
      direction = [sin(tangent)*merge(-1, 1, side == drive), cos(tangent)]
      if (present(along_surface)) along_surface = direction
      allocate (along(size(fillet%stress, 2)), components(3, size(fillet%stress, 2)))
      do load = 1, size(along)
        curve = spline(fillet%along, fillet%stress(:, load))
        along(load) = curve%value(s)
        components(:, load) = along(load)*[direction(1)**2, direction(2)**2, direction(1)*direction(2)]
      end do
    end associate
  end subroutine at_tangent

  !> Stress components sigma_x, sigma_y, tau_xy (3, nodes) of displacements `u`
  !> (2, nodes) at the nodes, averaged over the elements that meet there; for pictures.
  pure function nodal_stress(body, u) result(stress)
    type(body_t), intent(in) :: body
    real(dp), intent(in) :: u(:, :)
    real(dp) :: stress(3, size(body%grid%x, 2))
    real(dp), parameter :: place(2, nodes_per_element) = reshape([real(dp) :: &
      -1, -1, 1, -1, 1, 1, -1, 1, 0, -1, 1, 0, 0, 1, -1, 0], [2, nodes_per_element])
    real(dp) :: law(3), g(nodes_per_element, 2), h(2, 2), det
    integer :: meeting(size(body%grid%x, 2)), e, i

    law = elastic_law(body%material, body%plane_strain)
    stress = 0
    meeting = 0
    do e = 1, size(body%grid%element, 2)
      associate (list => body%grid%element(:, e))
        do i = 1, nodes_per_element
          call element_gradients(body%grid%x(:, list), place(:, i), g, det)
          h = matmul(u(:, list), g)
          stress(:, list(i)) = stress(:, list(i)) + [law(1)*h(1, 1) + law(2)*h(2, 2), &
            law(2)*h(1, 1) + law(1)*h(2, 2), law(3)*(h(1, 2) + h(2, 1))]
          meeting(list(i)) = meeting(list(i)) + 1
        end do
      end associate
    end do
    stress = stress/spread(meeting, 1, 3)
  end function nodal_stress

  !> Computes the stress at the nodes of a factored section under a load on the drive flank.
  subroutine loaded_stress(grid, radius, line_load, stress, error)
    type(section_body_t), intent(in) :: grid
    real(dp), intent(in) :: radius               !< radius of the load on the drive flank, m
    real(dp), intent(in) :: line_load            !< N/m
    real(dp), allocatable, intent(out) :: stress(:, :)   !< sigma_x, sigma_y, tau_xy at the nodes (3, nodes), Pa
    type(error_t), allocatable, intent(inout) :: error   !< memory is too small, or the radius is not on the flank
    real(dp), allocatable :: x(:, :)

    allocate (x(grid%body%unknowns, 1), source=0.0_dp)
    call flank_load(grid%section, grid%body, radius, x(:, 1), error)
    if (allocated(error)) return
    call grid%body%stiffness%solve(x, error)
    if (allocated(error)) return
    stress = line_load*nodal_stress(grid%body, grid%body%spread_out(x(:, 1)))
  end subroutine loaded_stress
end module gearsweep_elastic_stress
