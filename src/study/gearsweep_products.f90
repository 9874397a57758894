!> What a study holds: the products of its stages, each with the inputs that it was made from.
module gearsweep_products
  use gearsweep_case, only: case_t
  use gearsweep_harmonics, only: harmonics_t
  use gearsweep_inputs, only: elements_inputs_t, modes_inputs_t, motions_inputs_t, points_inputs_t, unit_inputs_t
  use gearsweep_modal, only: modal_t
  use gearsweep_optimum, only: most_sweeps, optimum_t, peak_t
  use gearsweep_published, only: published_t
  use gearsweep_response, only: response_t
  use gearsweep_root_rating, only: root_rating_t
  use gearsweep_section, only: section_t
  use gearsweep_sharing, only: sharing_t
  use gearsweep_stop, only: wants_stop
  use gearsweep_stress, only: root_stress_t
  use gearsweep_stress_field, only: stress_field_t
  use gearsweep_sweep, only: sweep_options_t, sweep_state_t, sweep_t
  use gearsweep_task, only: stages_t
  use gearsweep_tasks, only: task_slot_t
  implicit none
  private
  public :: study_t, record_t, note, ends_here

  !> Everything a case asked for; what it did not ask for stays unallocated.
  type, extends(stages_t) :: study_t
    type(case_t) :: case
    type(task_slot_t), allocatable :: tasks(:)   !< with the results of those that are one file each
    type(elements_inputs_t), allocatable :: elements_inputs  !< of its stiffness, where that is by finite elements
    type(motions_inputs_t) :: motions_inputs     !< of these, and so of all that follows but for the section
    type(sharing_t), allocatable :: sharing(:)   !< one for each relief
    type(harmonics_t), allocatable :: harmonics(:)  !< of the static transmission error, one for each relief
    type(response_t), allocatable :: response(:, :)  !< one for each relief and load_rpm
    type(points_inputs_t) :: response_inputs
    type(section_t), allocatable :: section      !< of the member that is looked at
    type(modal_t), allocatable :: modal          !< of that section
    type(modes_inputs_t) :: modes_inputs
    type(root_stress_t), allocatable :: unit_stress  !< at that member's root, under unit loads
    type(unit_inputs_t) :: unit_inputs
    type(root_rating_t), allocatable :: root(:)  !< of that member, one for each relief
    type(stress_field_t), allocatable :: field   !< all over its section
    type(sweep_t), allocatable :: sweep
    type(points_inputs_t) :: sweep_inputs
    type(peak_t), allocatable :: resonance(:)    !< of the least relieved mesh
    type(optimum_t), allocatable :: optimum
    type(points_inputs_t) :: optimum_inputs
    type(published_t), allocatable :: published(:)  !< printed values to set beside ours
    character(:), allocatable :: log             !< stages run and left out, a line each
    integer :: threads = 0
    logical :: stopped = .false.                 !< the caller ended it: something that was asked for is missing
  end type study_t

  !> How far the sweeps of a study are: that of the task sweep, then those of the optimum.
  type :: record_t
    type(sweep_state_t) :: states(1 + most_sweeps)
  end type record_t

contains

  !> Did the caller end the run? Then the log says what comes no more.
  logical function ends_here(study, options, what)
    type(study_t), intent(inout) :: study
    type(sweep_options_t), intent(in) :: options
    character(*), intent(in) :: what

    ends_here = wants_stop(options%accuracy%steady%stop)
    if (ends_here) call note(study, what//' left out: the run was interrupted')
    study%stopped = study%stopped .or. ends_here
  end function ends_here

  subroutine note(study, line)
    type(study_t), intent(inout) :: study
    character(*), intent(in) :: line

    study%log = study%log//line//new_line('a')
  end subroutine note
end module gearsweep_products
