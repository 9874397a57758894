!> Front of the branches of periodic motions over one parameter of an oscillator, and of the bifurcations along them.
module gearsweep_nonlinear_bifurcation
  use gearsweep_nonlinear_branch, only: branch_point_t, end_name, follow_options_t
  use gearsweep_nonlinear_branch_search, only: branch_search_options_t, find_branches, whole_branch_t
  use gearsweep_nonlinear_motion_equations, only: family_t, kind_name, width
  implicit none
  private
  public :: branch_point_t, branch_search_options_t, family_t, follow_options_t, whole_branch_t
  public :: end_name, find_branches, kind_name, width
end module gearsweep_nonlinear_bifurcation
