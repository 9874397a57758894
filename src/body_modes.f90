!> Natural modes of complete gear bodies by solid finite elements and cyclic symmetry.
!>
!> Other rooms use this module, and none of the room's own modules.
module gearsweep_body_modes
  ! The task `body_modes`.
  use gearsweep_body_modes_task_body_modes, only: body_modes_task_t
  implicit none
  public
end module gearsweep_body_modes
