!> Stability, Poincare sections, attractors, hysteresis, branches and sensitivity of motions, with their tasks.
!>
!> Other rooms use this module, and none of the room's own modules.
module gearsweep_nonlinear
  ! Parametric stability of the motion in full contact over speed and damping, and the tongues of instability.
  use gearsweep_nonlinear_stability, only: find_tongues, map_stability, stability_t, tongue_t
  ! The task `attractors`.
  use gearsweep_nonlinear_task_attractors, only: attractors_task_t
  ! The task `branches`.
  use gearsweep_nonlinear_task_branches, only: branches_task_t
  ! The task `hysteresis`.
  use gearsweep_nonlinear_task_hysteresis, only: hysteresis_task_t
  ! The task `poincare`.
  use gearsweep_nonlinear_task_poincare, only: poincare_task_t
  ! The task `sensitivity`.
  use gearsweep_nonlinear_task_sensitivity, only: sensitivity_task_t
  ! The task `stability`.
  use gearsweep_nonlinear_task_stability, only: stability_task_t
  implicit none
  public
end module gearsweep_nonlinear
