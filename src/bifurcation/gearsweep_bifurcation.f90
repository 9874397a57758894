!> Branches of periodic motions over one parameter of an oscillator, or two, and where the motion changes its kind along them. Other
!> rooms use this module and none beside it.
module gearsweep_bifurcation
  use gearsweep_branch, only: branch_point_t, end_name, follow_options_t
  use gearsweep_branch_curves, only: find_curves, special_curve_t
  use gearsweep_branch_search, only: branch_search_options_t, find_branches, whole_branch_t
  use gearsweep_motion_equations, only: family_t, kind_grazing, kind_name, width
  implicit none
  private
  public :: branch_point_t, branch_search_options_t, family_t, follow_options_t, special_curve_t, whole_branch_t
  public :: end_name, find_branches, find_curves, kind_grazing, kind_name, width
end module gearsweep_bifurcation
