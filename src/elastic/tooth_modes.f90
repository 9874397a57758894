!> A loaded tooth of a section in its modes: effect of each mode and each place of the load on the fillets.
module gearsweep_elastic_tooth_modes
  use gearsweep_base, only: claim_memory, dp, error_t, pi, piecewise_t, spline, str
  use gearsweep_gear, only: coast, drive, fillet_parameter, fillet_point
  use gearsweep_elastic_compliance, only: flank_load
  use gearsweep_elastic_modal_response, only: modal_model_t
  use gearsweep_elastic_modes, only: assemble_mass, mass_matrix_t, modes_t
  use gearsweep_elastic_q8, only: edge_functions
  use gearsweep_elastic_section, only: section_body_t
  use gearsweep_elastic_stress, only: along_fillet, best, fillet_stress_t, root_stress_t
  implicit none
  private
  public :: tooth_modes_t, find_tooth_modes

  !> Rows for each chosen point of a fillet.
  integer, parameter, public :: per_point = 3, along = 1, moved_x = 2, moved_y = 3

  !> Loaded tooth in its modes. The rows of `model` are the stress along the surface (Pa) at all points of the drive fillet, then
  !> of the coast fillet, and then for each chosen point the stress along the surface there and both displacements (m), across and
  !> along the tooth.
  type :: tooth_modes_t
    type(modal_model_t) :: model                 !< modal model; the caller sets its damping
    type(fillet_stress_t) :: side(2)             !< points of the fillets; drive, coast
    real(dp), allocatable :: direction(:, :)     !< direction of the surface at each chosen point, in the tooth's frame (2, point)
    type(root_stress_t) :: unit                  !< static stress along the fillets under a unit load
  contains
    procedure :: first_of_side
    procedure :: row_of
  end type tooth_modes_t

contains

  !> Computes the modal model. `grid`: the section, held and factored; `modes`: its own (gearsweep_elastic_modes). `radius(:)`:
  !> places of the load (m). `tangent(:)`: the chosen points, by the angle of the fillet's tangent to the tooth's axis (rad), each
  !> on the drive and then on the coast side. `error`: a radius is not on the flank, a tangent not on the fillet, or memory is too
  !> small.
  subroutine find_tooth_modes(grid, modes, radius, tangent, product, error)
    type(section_body_t), intent(in) :: grid
    type(modes_t), intent(in) :: modes
    real(dp), intent(in) :: radius(:), tangent(:)
    type(tooth_modes_t), intent(out) :: product
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: load(:, :), moved(:, :), at_rest(:, :, :)
    real(dp) :: stiffer, width
    integer :: i

    if (allocated(error)) return
    associate (body => grid%body, count => size(modes%frequency))
      width = grid%section%gear%spec%face_width
      ! The body is one metre wide and as stiff as steel.
      stiffer = grid%material%young/body%material%young
      call claim_memory(size(radius)*(16.0_dp*body%unknowns + 16.0_dp*size(grid%section%grid%x, 2)), &
                        'places of a moving load = '//str(size(radius)), error, blas=.true.)
      if (allocated(error)) return
      allocate (load(body%unknowns, size(radius)), source=0.0_dp)
      allocate (at_rest(2, size(grid%section%grid%x, 2), size(radius)))
      do i = 1, size(radius)
        call flank_load(grid%section, body, radius(i), load(:, i), error)
        if (allocated(error)) return
      end do
      allocate (product%model%frequency, source=2*pi*modes%frequency)
      allocate (product%model%force(count, size(radius)))
      do i = 1, count
        product%model%force(i, :) = matmul(body%gather(modes%shape(:, :, i)), load)
      end do
      allocate (moved, source=load)
      call body%stiffness%solve(moved, error)
      if (allocated(error)) return
      do i = 1, size(radius)
        at_rest(:, :, i) = body%spread_out(moved(:, i))/(width*stiffer)
      end do
      call find_residual_frequency(grid, modes%shape, load, at_rest, product%model)
      deallocate (load, moved)
      call read_rows(grid, modes%shape, tangent, stiffer, product, product%model%shape, error)
      if (.not. allocated(error)) call read_rows(grid, at_rest, tangent, stiffer, product, product%model%static, error)
    end associate
  end subroutine find_tooth_modes

  !> Computes Rayleigh's quotient of the static displacements under each `load` that the modes `shape` omit: elastic over kinetic
  !> energy. It is at least the highest mode's, as all omitted modes are above; this limit applies if only rounding remains.
  pure subroutine find_residual_frequency(grid, shape, load, at_rest, model)
    type(section_body_t), intent(in) :: grid
    real(dp), intent(in) :: shape(:, :, :), load(:, :), at_rest(:, :, :)
    type(modal_model_t), intent(inout) :: model
    type(mass_matrix_t) :: mass
    real(dp) :: rest(2, size(shape, 2)), force(2, size(shape, 2)), elastic, kinetic
    integer :: i, k

    associate (body => grid%body, w => model%frequency)
      mass = assemble_mass(size(shape, 2), grid%section%grid%element, body%mass_matrices())
      allocate (model%residual_frequency(size(load, 2)), source=maxval(w))
      do i = 1, size(load, 2)
        rest = at_rest(:, :, i)
        do k = 1, size(w)
          rest = rest - shape(:, :, k)*(model%force(k, i)/w(k)**2)
        end do
        call mass%times(rest, force)
        elastic = dot_product(load(:, i), body%gather(rest))
        kinetic = sum(rest*force)*grid%section%gear%spec%face_width/body%thickness
        if (elastic > maxval(w)**2*kinetic .and. kinetic > 0) model%residual_frequency(i) = sqrt(elastic/kinetic)
      end do
    end associate
  end subroutine find_residual_frequency

  !> Computes the rows for displacements `u` (direction, node, column) of all nodes; other components of `product` are those of
  !> the last call.
  subroutine read_rows(grid, u, tangent, stiffer, product, rows, error)
    type(section_body_t), intent(in) :: grid
    real(dp), intent(in) :: u(:, :, :), tangent(:), stiffer
    type(tooth_modes_t), intent(inout) :: product
    real(dp), allocatable, intent(out) :: rows(:, :)
    type(error_t), allocatable, intent(inout) :: error
    real(dp), allocatable :: stress(:), components(:, :), moved(:, :, :)
    real(dp) :: direction(2), point(2), s
    integer :: side, i, row, k, d
    type(piecewise_t) :: curve

    product%unit%gear = grid%section%gear
    do side = drive, coast
      call along_fillet(grid%section, grid%body, u, side, product%unit%side(side))
      product%unit%side(side)%stress = stiffer*product%unit%side(side)%stress
    end do
    product%side = product%unit%side
    if (.not. allocated(product%direction)) allocate (product%direction(2, 2*size(tangent)))
    associate (points => [(size(product%side(i)%along), i=1, 2)])
      allocate (rows(sum(points) + 2*per_point*size(tangent), size(u, 3)))
      rows(:points(drive), :) = product%side(drive)%stress
      rows(points(drive) + 1:sum(points), :) = product%side(coast)%stress
    end associate
    do side = drive, coast
      call move_fillet(grid, u, side, size(product%side(side)%along), moved)
      do i = 1, size(tangent)
        call product%unit%at_tangent(side, tangent(i), stress, components, error, direction)
        if (allocated(error)) return
        product%direction(:, 2*(i - 1) + side) = direction
        row = product%row_of(2*(i - 1) + side)
        rows(row + along, :) = stress
        point = fillet_point(product%unit%gear, side, fillet_parameter(product%unit%gear, side, tangent(i)))
        curve = spline(product%side(side)%point(2, :), product%side(side)%along)
        s = curve%value(point(2))
        do k = 1, size(moved, 3)
          do d = 1, 2
            curve = spline(product%side(side)%along, moved(d, :, k))
            rows(row + moved_x + d - 1, k) = curve%value(s)
          end do
        end do
      end do
    end do
  end subroutine read_rows

  !> Computes the displacements (m) of the fillet's points in the tooth's frame (2, point, column).
  pure subroutine move_fillet(grid, u, side, points, moved)
    type(section_body_t), intent(in) :: grid
    real(dp), intent(in) :: u(:, :, :)
    integer, intent(in) :: side, points
    real(dp), allocatable, intent(out) :: moved(:, :, :)
    integer, allocatable :: nodes(:)
    real(dp) :: turn(2, 2), f(3)
    integer :: n, k, e

    associate (a => grid%section%axis(grid%section%loaded))
      turn = reshape([cos(a), sin(a), -sin(a), cos(a)], [2, 2])
    end associate
    nodes = grid%section%surface(grid%section%loaded, side)
    allocate (moved(2, points, size(u, 3)))
    do k = 1, size(u, 3)
      do n = 1, points
        e = (n + 1)/2
        f = edge_functions(merge(-best, best, modulo(n, 2) == 1))
        moved(:, n, k) = matmul(turn, matmul(u(:, nodes(2*e - 1:2*e + 1), k), f))
      end do
    end do
  end subroutine move_fillet

  !> Row before the first of a side's fillet.
  pure integer function first_of_side(self, side) result(row)
    class(tooth_modes_t), intent(in) :: self
    integer, intent(in) :: side

    row = merge(0, size(self%side(drive)%along), side == drive)
  end function first_of_side

  !> Row before those of a chosen point, counted from 1: drive side before coast side.
  pure integer function row_of(self, point) result(row)
    class(tooth_modes_t), intent(in) :: self
    integer, intent(in) :: point

    row = size(self%side(drive)%along) + size(self%side(coast)%along) + per_point*(point - 1)
  end function row_of
end module gearsweep_elastic_tooth_modes
