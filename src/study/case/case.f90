!> The case: the tasks and the input values, in SI units.
module gearsweep_study_case_case
  use gearsweep_base, only: dp
  use gearsweep_gear, only: gear_spec_t, linear
  use gearsweep_elastic, only: material_t, section_options_t
  use gearsweep_face, only: alignment_t, shaft_t
  use gearsweep_mesh, only: iso_options_t
  use gearsweep_motion, only: accuracy_t, both
  use gearsweep_study_case_task, only: sentence_of, stage, task_slot_t
  use gearsweep_study_reader_reader, only: sentence_length, text_unless
  implicit none
  private
  public :: case_t, faces_t, for_iso, for_stage, speed_count, speeds

  !> How the faces of the gears meet.
  type :: faces_t
    type(alignment_t) :: alignment               !< misalignment, and the leads of both gears
    type(shaft_t) :: shaft                       !< of the pinion; in a case without the pinion's numbers
    integer :: slices = 0                        !< slices of the face; 0: automatic
  contains
    procedure :: are_uneven
  end type faces_t

  type :: case_t
    character(:), allocatable :: text            !< as read
    character(:), allocatable :: title
    type(task_slot_t), allocatable :: tasks(:)   !< all tasks of the program; those of the case are marked
    logical :: prescribed = .false.              !< true for a mesh without gear geometry
    ! &pair, &pinion, &gear
    type(gear_spec_t) :: spec(2)
    real(dp) :: centre_distance = 0              !< centre distance, m; 0: without backlash
    logical :: tip_alteration = .false.
    logical :: shorten_path = .false.
    logical :: has_allowance = .false.           !< tooth thickness allowance of either gear
    logical :: has_backlash = .false.
    real(dp) :: backlash = 0
    real(dp) :: mass(2) = 0, inertia(2) = 0      !< effective mass, kg, and polar inertia, kg m^2; 0: not stated
    real(dp) :: hub_inertia(2) = 0               !< inertia at the bores, without the gears' own, kg m^2
    type(material_t) :: material(2)              !< materials of pinion and gear
    type(faces_t) :: faces                       !< &face, and the leads of &pinion and &gear
    ! &load, exactly one of these
    real(dp) :: torque = 0, normal_force = 0, line_load = 0
    real(dp), allocatable :: torques(:)          !< torques, N m; if allocated, `torque` is the largest
    ! &relief
    real(dp), allocatable :: amount(:)
    real(dp) :: fraction(2) = 1
    integer :: shape = linear
    character(:), allocatable :: start           !< key word of the start of the relief: hpstc, pitch, length or roll
    real(dp) :: length = 0, roll(2) = 0
    ! &mesh
    character(:), allocatable :: model, file, profile_error_file
    real(dp) :: shared_compliance = 0            !< shared compliance, m/N
    real(dp), allocatable :: coefficients(:)
    real(dp) :: contact_ratio = 0, base_pitch = 0
    type(iso_options_t) :: iso                   !< K_A and the gear bodies; its keys are in &load and in the gears' groups
    real(dp) :: pitch_point = -1                 !< path coordinate of the pitch point; below 0: half the contact ratio
    logical :: tooth_coupling = .true., corner_contact = .true., nonlinear_contact = .true.
    ! &dynamics
    real(dp) :: damping_ratio = 0.1_dp, friction = 0
    logical :: has_damping = .false.             !< true if the case states the damping ratio
    ! &sweep, &numerics
    real(dp) :: rpm_first = 0, rpm_last = 0, rpm_step = 0
    integer :: direction = both
    type(accuracy_t) :: accuracy
    ! &section
    type(section_options_t) :: section
    logical :: has_support = .false., has_extent = .false.  !< true if the case states the fixed edge, and the number of teeth
    integer :: gear = 1                        !< gear of the section: 1 pinion, 2 gear
    character(:), allocatable :: published       !< file of printed values for comparison
    !> Keys of the text that are not used: a line for each use that they would have.
    character(:), allocatable :: unused
    character(:), allocatable :: cautions        !< numbers that are likely in another unit, a line each
  contains
    procedure :: request
    procedure :: requests
    procedure :: has_relief
    procedure :: needs
    procedure :: needs_face_load
    procedure :: has_uneven_motion
    procedure :: is_helical
    procedure :: tasks_for
    procedure :: needs_elements
    procedure :: stiffness_body
    procedure :: models_teeth
    procedure :: has_corner_contact
    procedure :: computes_mass
    procedure :: uses_masses
  end type case_t

contains

  !> True if a misalignment, a lead, or a shaft that deflects makes the faces meet unevenly.
  pure logical function are_uneven(faces)
    class(faces_t), intent(in) :: faces

    associate (lead => faces%alignment%lead)
      are_uneven = abs(faces%alignment%misalignment) > 0 .or. any(abs(lead%slope) > 0) .or. any(abs(lead%crowning) > 0) .or. &
                   any(lead%end_relief > 0) .or. faces%shaft%span > 0
    end associate
  end function are_uneven

  !> True if a task computes the load over the face width or uses it: other tasks than `face_load` where it is uneven.
  pure logical function needs_face_load(case)
    class(case_t), intent(in) :: case
    integer :: i

    associate (tasks => case%tasks)
      needs_face_load = case%requests('face_load') .or. (case%faces%are_uneven() .and. &
                        any([(tasks(i)%needs(stage%face) .and. .not. tasks(i)%info%has_uneven_motion, i=1, size(tasks))]))
    end associate
  end function needs_face_load

  !> True if a task follows a motion in which the faces meet unevenly.
  pure logical function has_uneven_motion(case)
    class(case_t), intent(in) :: case
    integer :: i

    associate (tasks => case%tasks)
      has_uneven_motion = case%faces%are_uneven() .and. any([(tasks(i)%is_requested .and. tasks(i)%info%has_uneven_motion, &
                                                              i=1, size(tasks))])
    end associate
  end function has_uneven_motion

  !> True for helical gears.
  pure logical function is_helical(case)
    class(case_t), intent(in) :: case

    is_helical = any(abs(case%spec%helix_angle) > 0)
  end function is_helical

  !> Requests these tasks and no others.
  subroutine request(self, tasks)
    class(case_t), intent(inout) :: self
    character(*), intent(in) :: tasks(:)
    integer :: i

    do i = 1, size(self%tasks)
      self%tasks(i)%is_requested = any(tasks == self%tasks(i)%info%name)
    end do
  end subroutine request

  !> True if the case requests this task.
  pure logical function requests(self, task)
    class(case_t), intent(in) :: self
    character(*), intent(in) :: task
    integer :: i

    requests = any([(self%tasks(i)%is_requested .and. self%tasks(i)%info%name == task, i=1, size(self%tasks))])
  end function requests

  !> True if reliefs have an effect: an amount is above 0, or a task varies the amount.
  pure logical function has_relief(self)
    class(case_t), intent(in) :: self

    has_relief = any(self%amount > 0) .or. self%requests('optimum') .or. self%requests('deflection_relief')
  end function has_relief

  !> True if one of the case's tasks needs this stage.
  pure logical function needs(self, which)
    class(case_t), intent(in) :: self
    integer, intent(in) :: which                 !< index of the stage in `stage`
    integer :: i

    needs = any([(self%tasks(i)%needs(which), i=1, size(self%tasks))])
  end function needs

  !> Lists all tasks that need this stage, requested or not, as in `load, sweep or optimum`.
  pure function tasks_for(self, which) result(words)
    class(case_t), intent(in) :: self
    integer, intent(in) :: which                 !< index of the stage in `stage`
    character(sentence_length) :: words

    words = sentence_of(self%tasks, which)
  end function tasks_for

  !> What a key lacks: the tasks that need this stage, as in `load, sweep or optimum`; empty if the case requests one of them.
  pure function for_stage(case, which) result(what)
    type(case_t), intent(in) :: case
    integer, intent(in) :: which                 !< index of the stage in `stage`
    character(sentence_length) :: what

    what = text_unless(case%needs(which), trim(case%tasks_for(which)))
  end function for_stage

  !> What a key of ISO 6336 lacks: tasks that need this stage, or a stiffness by ISO 6336.
  pure function for_iso(case, which) result(what)
    type(case_t), intent(in) :: case
    integer, intent(in) :: which                 !< index of the stage in `stage`
    character(sentence_length) :: what

    what = text_unless(case%needs(which) .or. case%needs(stage%mesh) .and. case%model == 'iso6336', &
                  trim(case%tasks_for(which))//' or a stiffness by iso6336')
  end function for_iso

  !> True if a task needs both gears' stiffness by finite elements.
  pure logical function needs_elements(self)
    class(case_t), intent(in) :: self

    needs_elements = self%needs(stage%mesh) .and. self%model == 'fe'
  end function needs_elements

  !> Gear body for the pair stiffness by elements, as in &section; the complete gear fixed at its bore if that states neither the
  !> teeth nor the fixed edge.
  pure function stiffness_body(self) result(body)
    class(case_t), intent(in) :: self
    type(section_options_t) :: body

    body = self%section
    ! The unloaded teeth may have larger elements.
    body%others_across = min(4, body%elements_across)
    if (self%has_extent .or. self%has_support) return
    body%teeth = 0
    body%fixed_sides = .false.
    body%fixed_rim = .true.
  end function stiffness_body

  !> True if the pair stiffness comes from the teeth, not from stated numbers.
  pure logical function models_teeth(self)
    class(case_t), intent(in) :: self

    models_teeth = any(self%model == [character(7) :: 'fe', 'weber', 'iso6336'])
  end function models_teeth

  !> True if a pair may be in contact before A and after E too.
  pure logical function has_corner_contact(self)
    class(case_t), intent(in) :: self

    has_corner_contact = self%corner_contact .and. self%models_teeth() .and. .not. self%is_helical()
  end function has_corner_contact

  !> True if a gear's mass is computed from its body, as neither mass nor inertia is stated.
  pure logical function computes_mass(self, gear)
    class(case_t), intent(in) :: self
    integer, intent(in) :: gear

    computes_mass = self%needs(stage%mesh) .and. .not. (self%mass(gear) > 0 .or. self%inertia(gear) > 0) .and. self%uses_masses()
  end function computes_mass

  !> True if a result depends on the masses: of helical gears those of the motion.
  pure logical function uses_masses(self)
    class(case_t), intent(in) :: self

    uses_masses = .not. self%is_helical() .or. self%needs(stage%motion)
  end function uses_masses

  !> Number of speeds of the sweep.
  pure integer function speed_count(case)
    type(case_t), intent(in) :: case

    ! A small tolerance keeps the last speed if the step divides the range.
    speed_count = 1 + int((case%rpm_last - case%rpm_first)/case%rpm_step + 1e-9_dp)
  end function speed_count

  !> Pinion speeds of the sweep (1/min), ascending.
  pure function speeds(case) result(rpm)
    type(case_t), intent(in) :: case
    real(dp), allocatable :: rpm(:)
    integer :: i

    allocate (rpm(speed_count(case)))
    do i = 1, size(rpm)
      rpm(i) = case%rpm_first + case%rpm_step*(i - 1)
    end do
  end function speeds
end module gearsweep_study_case_case
