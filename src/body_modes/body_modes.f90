!> Natural modes of a complete gear in three dimensions, from one tooth sector on two grids.
module gearsweep_body_modes_body_modes
  use, intrinsic :: iso_c_binding, only: c_ptr
  use gearsweep_base, only: code_input, dp, error_t, fail, str
  use gearsweep_gear, only: gear_t
  use gearsweep_elastic, only: check_material, material_t
  use gearsweep_body_modes_sector, only: gear_blank_t, brick_matrices, brick_nodes, make_gear_sector, sector_t
  use gearsweep_body_modes_sector_modes, only: antisymmetric, find_sector_modes, radial, rigid_motions, sector_mode_t, support_t, &
    symmetric, tangential
  implicit none
  private
  public :: body_modes_t, body_options_t, find_body_modes, name_of, name_length

  integer, parameter :: name_length = 32

  type :: body_options_t
    type(gear_blank_t) :: blank
    type(support_t) :: support
    integer :: modes = 2                         !< number of modes of each nodal diameter and symmetry
    integer :: most_diameters = -1               !< largest nodal diameter; -1: all
    integer :: across = 4                        !< elements across a tooth; the other sizes follow from it
  end type body_options_t

  type :: body_modes_t
    type(sector_t) :: sector
    type(sector_mode_t), allocatable :: modes(:)  !< modes by frequency
    real(dp), allocatable :: error_estimate(:)   !< relative error estimate of each frequency
    integer :: rigid = 0                         !< number of rigid-body modes, which are omitted
    real(dp) :: mass = 0                         !< mass, kg
    real(dp) :: inertia = 0                      !< polar moment of inertia, kg m^2
  end type body_modes_t

contains

  !> Finds the lowest modes of each nodal diameter and symmetry.
  !>
  !> The error estimate is the difference to a grid of half the refinement over ratio**p - 1. If the bore is fixed, its edge on the
  !> face is singular: displacements vary with the distance to the power 0.71 for nu = 0.3 (Williams 1952, J. Appl. Mech. 19), so
  !> frequencies converge with p = 1.4; the corner between web and rim has 0.54, and the grid that is graded towards it some 1.8,
  !> set to 1.5 on the safe side.
  !> `stop`: flag of the caller; if it ended the search, `product%modes` is not allocated. `error`: code 2 if the gear has no bore
  !> or the body does not fit, 5 or 6 as in gearsweep_body_modes_sector_modes.
  subroutine find_body_modes(gear, material, options, stop, product, error)
    type(gear_t), intent(in) :: gear
    type(material_t), intent(in) :: material
    type(body_options_t), intent(in) :: options
    type(c_ptr), intent(in) :: stop
    type(body_modes_t), intent(out) :: product
    type(error_t), allocatable, intent(inout) :: error
    type(sector_mode_t), allocatable :: fine(:, :, :), coarse(:, :, :), all(:)
    type(sector_t) :: coarser
    real(dp) :: order
    integer :: across, most, i, k, n
    real(dp), allocatable :: estimate(:)
    logical, allocatable :: remains(:)

    call check_material(material, error)
    most = options%most_diameters
    if (most < 0) most = gear%spec%teeth/2
    if (most > gear%spec%teeth/2) call fail(error, code_input, 'nodal diameters = '//str(most)// &
      ': at most half the number of teeth, '//str(gear%spec%teeth/2))
    if (allocated(error)) return
    across = max(2, options%across/2)
    if (across == options%across) across = options%across + 1
    call make_gear_sector(gear, options%blank, options%across, product%sector, error)
    if (allocated(error)) return
    call make_gear_sector(gear, options%blank, across, coarser, error)
    if (allocated(error)) return
    call find_sector_modes(product%sector, material, options%support, options%modes, [0, most], stop, fine, error)
    if (allocated(error) .or. .not. allocated(fine)) return
    call find_sector_modes(coarser, material, options%support, options%modes, [0, most], stop, coarse, error)
    if (allocated(error) .or. .not. allocated(coarse)) return
    order = merge(1.5_dp, 1.4_dp, options%blank%web > 0)
    all = reshape(fine, [size(fine)])
    estimate = reshape(abs((coarse%frequency/fine%frequency - 1)/((real(options%across, dp)/across)**order - 1)), [size(fine)])
    n = size(all)
    allocate (remains(n), source=.true.)
    allocate (product%modes(n), product%error_estimate(n))
    do i = 1, n
      k = minloc(all%frequency, 1, mask=remains)
      remains(k) = .false.
      product%modes(i) = all(k)
      product%error_estimate(i) = estimate(k)
    end do
    product%rigid = sum([rigid_motions(options%support, symmetric, 0), rigid_motions(options%support, antisymmetric, 0), &
                         2*rigid_motions(options%support, symmetric, 1), 2*rigid_motions(options%support, antisymmetric, 1)])
    call weigh(product%sector, material, product%mass, product%inertia)
  end subroutine find_body_modes

  !> Mass and polar moment of inertia of the complete gear, from the elements.
  pure subroutine weigh(sector, material, mass, inertia)
    type(sector_t), intent(in) :: sector
    type(material_t), intent(in) :: material
    real(dp), intent(out) :: mass, inertia
    real(dp) :: k(3*brick_nodes, 3*brick_nodes), m(brick_nodes, brick_nodes), x(3, brick_nodes)
    integer :: e

    mass = 0
    inertia = 0
    do e = 1, size(sector%element, 2)
      x = sector%x(:, sector%element(:, e))
      call brick_matrices(x, [0.0_dp, 0.0_dp], material%density, k, m)
      mass = mass + sum(m)
      inertia = inertia + dot_product(x(1, :), matmul(m, x(1, :))) + dot_product(x(2, :), matmul(m, x(2, :)))
    end do
    mass = 2*sector%sectors*mass
    inertia = 2*sector%sectors*inertia
  end subroutine weigh

  !> Name of a mode, from its nodal diameter, its symmetry and the distribution of its kinetic energy.
  elemental function name_of(mode) result(name)
    type(sector_mode_t), intent(in) :: mode
    character(name_length) :: name

    select case (mode%diameter)
    case (0)
      select case (maxloc(mode%share, 1))
      case (radial)
        name = 'breathing'
      case (tangential)
        name = 'torsion'
      case default
        name = merge('umbrella', 'stretch ', mode%symmetry == antisymmetric)
      end select
    case (1)
      name = merge('rocking    ', 'translation', mode%symmetry == antisymmetric)
    case default
      name = 'nodal diameter '//str(mode%diameter)
      if (mode%symmetry == symmetric) name = trim(name)//' in the plane'
    end select
  end function name_of
end module gearsweep_body_modes_body_modes
