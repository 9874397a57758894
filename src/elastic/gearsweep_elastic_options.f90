!> Options of the finite elements: of a gear's section, and of the pair stiffness that two sections give.
module gearsweep_elastic_options
  use gearsweep_kinds, only: dp
  implicit none
  private
  public :: fe_options_t, section_options_t

  !> A section, from one tooth to the whole gear.
  type :: section_options_t
    integer :: teeth = 3                         !< 0: the whole gear
    real(dp) :: half_angle = 0                   !< of the sector, rad; 0: up to the middle of the next spaces
    !> Thickness below the root circle, m; 0: down to the gear's bore or, when it
    !> has none, 2.5 tooth heights (the backup ratio of Hassan et al. 2009).
    real(dp) :: rim = 0
    logical :: fixed_sides = .true., fixed_rim = .true.
    logical :: plane_strain = .false.
    integer :: elements_across = 8               !< the tooth; everything else follows
    integer :: others_across = 0                 !< the unloaded teeth; 0: as the loaded one
    real(dp) :: most_memory = 8e9_dp             !< for the stiffness matrix, bytes
  end type section_options_t

  !> Teeth are wide, hence plane strain unless said. The default grid holds the
  !> pair stiffness of usual gears to 0.1 %, of narrow tips to 0.3 %.
  type :: fe_options_t
    type(section_options_t) :: section = &
      section_options_t(plane_strain=.true., elements_across=16, others_across=4)
    !> Where the grid's share ends and Hertz's begins, in modules.
    real(dp) :: depth = 0.4_dp
    integer :: positions = 17                    !< of the load along the path
    logical :: tooth_coupling = .true.           !< neighbouring teeth share what their body deflects
    real(dp) :: rim(2) = 0                       !< of a section that ends below the rim of pinion or gear, m; 0: as `section` says
    integer :: rim_teeth = 5                     !< of such a section
    real(dp) :: hub_share(2) = 0                 !< of the inertia of pinion and gear, what sits at their bores
    logical :: corner_contact = .false.          !< the path goes on beyond A and E with the tip corners' contact
  end type fe_options_t
end module gearsweep_elastic_options
