!> Data of a study: the products of its stages with their inputs, and its tasks with their results.
module gearsweep_study_run_products
  use gearsweep_study_case_case, only: case_t
  use gearsweep_study_case_published, only: published_t
  use gearsweep_study_case_task, only: task_slot_t
  use gearsweep_study_run_stages, only: stages_t
  implicit none
  private
  public :: study_t

  !> Products and results of a case; those that it did not request are not allocated.
  type, extends(stages_t) :: study_t
    type(case_t) :: case
    type(task_slot_t), allocatable :: tasks(:)   !< tasks with their results
    type(published_t), allocatable :: published(:)  !< printed values for comparison
    character(:), allocatable :: log             !< stages that ran and those that did not, a line each
    logical :: stopped = .false.                 !< true if the caller ended the run: some requested result is missing
  end type study_t
end module gearsweep_study_run_products
