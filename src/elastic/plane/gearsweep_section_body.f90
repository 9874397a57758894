!> A section of a gear, held and factored. Stress and modes read the same two grids, whose
!> difference tells the error of either.
module gearsweep_section_body
  use gearsweep_kinds, only: dp
  use gearsweep_body, only: body_t, make_body
  use gearsweep_error, only: error_t
  use gearsweep_gear, only: gear_t
  use gearsweep_material, only: check_material, material_t
  use gearsweep_section, only: section_t, section_options_t, make_section
  implicit none
  private
  public :: section_body_t, make_section_body, make_two_grids, mean_step_ratio, stress_error_share

  !> The body is a metre wide and as stiff as steel, whatever the material: stress depends on neither, and
  !> frequencies and shapes follow from theirs by a factor.
  type :: section_body_t
    type(section_t) :: section
    type(material_t) :: material
    type(body_t) :: body
  end type section_body_t

contains

  !> Makes and factors a section of `gear`. What `product` held before is freed.
  subroutine make_section_body(gear, material, options, product, error)
    type(gear_t), intent(in) :: gear
    type(material_t), intent(in) :: material
    type(section_options_t), intent(in) :: options
    type(section_body_t), intent(inout) :: product
    type(error_t), allocatable, intent(out) :: error

    call check_material(material, error)
    if (allocated(error)) return
    product%material = material
    call make_section(gear, options, product%section, error)
    if (allocated(error)) return
    call make_body(product%section%grid, material_t(poisson=material%poisson, density=material%density), &
                   options%plane_strain, 1.0_dp, spread(product%section%is_held(), 1, 2), options%most_memory, &
                   product%body, error)
  end subroutine make_section_body

  !> The grid that is wanted, then one of half the fineness.
  subroutine make_two_grids(gear, material, options, grids, error)
    type(gear_t), intent(in) :: gear
    type(material_t), intent(in) :: material
    type(section_options_t), intent(in) :: options
    type(section_body_t), intent(inout) :: grids(2)
    type(error_t), allocatable, intent(out) :: error
    type(section_options_t) :: coarser

    coarser = options
    coarser%elements_across = max(3, options%elements_across/2)
    if (coarser%elements_across == options%elements_across) coarser%elements_across = options%elements_across + 1
    coarser%others_across = merge(0, max(3, options%others_across/2), options%others_across == 0)
    call make_section_body(gear, material, options, grids(1), error)
    if (allocated(error)) return
    call make_section_body(gear, material, coarser, grids(2), error)
  end subroutine make_two_grids

  !> Mean element size of the second grid over that of the first. Columns along the fillets and rows of the rim have least
  !> numbers, so that coarse grids differ less in it than in the elements across a tooth.
  pure real(dp) function mean_step_ratio(grids)
    type(section_body_t), intent(in) :: grids(2)

    mean_step_ratio = sqrt(real(size(grids(1)%section%grid%element, 2), dp)/size(grids(2)%section%grid%element, 2))
  end function mean_step_ratio

  !> The error of stress on the first grid over its difference to that on the second. Stress converges with second order once the
  !> grid suits the fillet; on coarser grids the order is lower and differs from gear to gear (`sh bench/run.sh honesty`).
  pure real(dp) function stress_error_share(grids) result(share)
    type(section_body_t), intent(in) :: grids(2)
    integer, parameter :: fine = 8
    real(dp) :: order

    associate (across => grids%section%options%elements_across)
      order = merge(2.0_dp, 1.5_dp, across(1) >= fine)
      share = 1/abs((real(across(1), dp)/across(2))**order - 1)
    end associate
  end function stress_error_share
end module gearsweep_section_body
