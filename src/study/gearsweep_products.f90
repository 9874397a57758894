!> What a study holds: the products of its stages, with the inputs that they were made from, and its tasks with their
!> results.
module gearsweep_products
  use gearsweep_case, only: case_t
  use gearsweep_published, only: published_t
  use gearsweep_stages, only: stages_t
  use gearsweep_sweep_state, only: most_sweeps, sweep_state_t
  use gearsweep_task, only: task_slot_t
  implicit none
  private
  public :: study_t, record_t

  !> Everything a case asked for; what it did not ask for stays unallocated.
  type, extends(stages_t) :: study_t
    type(case_t) :: case
    type(task_slot_t), allocatable :: tasks(:)   !< with their results
    type(published_t), allocatable :: published(:)  !< printed values to set beside ours
    type(task_slot_t), allocatable :: before(:)  !< what an interrupted run had done, as this one begins
    character(:), allocatable :: log             !< stages run and left out, a line each
    logical :: stopped = .false.                 !< the caller ended it: something that was asked for is missing
  end type study_t

  !> How far an interrupted study is: its sweeps, that of the task sweep and those of the optimum, and its other tasks.
  type :: record_t
    type(sweep_state_t) :: states(1 + most_sweeps)
    type(task_slot_t), allocatable :: tasks(:)
  end type record_t
end module gearsweep_products
