!> Gears with deviations of each tooth: specimens, revolutions and tables.
!>
!> Other rooms use this module, and none of the room's own modules.
module gearsweep_as_built
  ! The task `as_built`.
  use gearsweep_as_built_task_as_built, only: as_built_task_t
  implicit none
  public
end module gearsweep_as_built
