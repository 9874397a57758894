!> Elastic material, steel by default, and the options of the finite elements of a gear section.
module gearsweep_elastic_material
  use gearsweep_base, only: code_input, dp, error_t, fail
  implicit none
  private
  public :: material_t, check_material, harmonic_mean, fe_options_t, section_options_t, on_second_grid

  type :: material_t
    real(dp) :: young = 206e9_dp       !< E, Pa
    real(dp) :: poisson = 0.3_dp       !< nu
    real(dp) :: density = 7850         !< kg/m^3
  end type material_t

  !> Section of a gear, from one tooth to the complete gear.
  type :: section_options_t
    integer :: teeth = 3                         !< 0: the complete gear
    real(dp) :: half_angle = 0                   !< half angle of the sector, rad; 0: up to the middle of the next spaces
    !> Thickness below the root circle, m; 0: down to the gear's bore. Without a bore, a complete gear extends down to an assumed
    !> one, other sections by 2.5 tooth heights (the backup ratio of Hassan et al. 2009).
    real(dp) :: rim = 0
    logical :: fixed_sides = .true., fixed_rim = .true.
    logical :: plane_strain = .false.
    integer :: elements_across = 8               !< elements across the tooth, which determine all others
    integer :: others_across = 0                 !< elements across the unloaded teeth; 0: as the loaded one
    real(dp) :: most_memory = 8e9_dp             !< limit of memory for the stiffness matrix, bytes
  end type section_options_t

  !> Options of the finite elements. Teeth are wide, hence plane strain by default. With the default grid the pair stiffness of
  !> usual gears is accurate to 0.1 %, that of narrow tips to 0.3 %.
  type :: fe_options_t
    type(section_options_t) :: section = &
      section_options_t(plane_strain=.true., elements_across=16, others_across=4)
    !> Depth of the change from the grid's share to Hertz's, in modules.
    real(dp) :: depth = 0.4_dp
    integer :: positions = 17                    !< number of positions of the load along the path
    logical :: tooth_coupling = .true.           !< neighbouring teeth share the deflection of their body
    real(dp) :: rim(2) = 0  !< rim thickness of a section that ends below the rim of pinion or gear, m; 0: as in `section`
    integer :: rim_teeth = 5                     !< teeth of that section
    real(dp) :: hub_share(2) = 0                 !< fraction of the inertia of pinion and gear at their bores
    logical :: corner_contact = .false.          !< true: the path extends beyond A and E with tip corner contact
  end type fe_options_t

contains

  !> Harmonic mean 2 a b/(a + b) of two positive numbers: the modulus equivalent to those of two bodies in series, each with half
  !> of the deflection. It is the same to the last bit in any order; of two equal numbers, it is that number.
  elemental real(dp) function harmonic_mean(a, b) result(mean)
    real(dp), intent(in) :: a, b

    mean = min(a, b)*(2*max(a, b)/(a + b))
  end function harmonic_mean

  !> Refuses values that no elastic body has.
  pure subroutine check_material(material, error)
    type(material_t), intent(in) :: material
    type(error_t), allocatable, intent(inout) :: error

    if (.not. material%young > 0) call fail(error, code_input, 'Young''s modulus: must be above 0')
    if (.not. (material%poisson > -1 .and. material%poisson < 0.5_dp)) then
      call fail(error, code_input, 'Poisson''s ratio: must lie between -1 and 0.5')
    end if
  end subroutine check_material

  !> Options of the section on a grid of half the fineness, for the error of the first; of the coarsest one, on a finer grid.
  elemental type(section_options_t) function on_second_grid(options) result(second)
    type(section_options_t), intent(in) :: options

    second = options
    second%elements_across = max(3, options%elements_across/2)
    if (second%elements_across == options%elements_across) second%elements_across = options%elements_across + 1
    second%others_across = merge(0, max(3, options%others_across/2), options%others_across == 0)
  end function on_second_grid
end module gearsweep_elastic_material
