!> The case: what is wanted, in SI units.
module gearsweep_case
  use gearsweep_kinds, only: dp
  use gearsweep_gear, only: gear_spec_t
  use gearsweep_material, only: material_t
  use gearsweep_elastic_options, only: section_options_t
  use gearsweep_relief, only: linear
  use gearsweep_stiffness, only: iso_options_t
  use gearsweep_steady_motion, only: accuracy_t
  use gearsweep_sweep_state, only: both
  use gearsweep_task, only: sentence_of, stage, task_slot_t
  use gearsweep_uses, only: sentence_length, unless
  implicit none
  private
  public :: case_t, for_iso, for_stage, speed_count, speeds

  type :: case_t
    character(:), allocatable :: text            !< as read
    character(:), allocatable :: title
    type(task_slot_t), allocatable :: tasks(:)   !< all there are; those that the case names are wanted
    logical :: prescribed = .false.              !< a mesh with no geometry behind it
    ! &pair, &pinion, &gear
    type(gear_spec_t) :: spec(2)
    real(dp) :: centre_distance = 0              !< 0: without backlash
    logical :: tip_alteration = .false.
    logical :: shorten_path = .false.
    logical :: has_allowance = .false.           !< of the tooth thickness, on either gear
    logical :: has_backlash = .false.
    real(dp) :: backlash = 0
    real(dp) :: mass(2) = 0, inertia(2) = 0      !< 0: not given
    real(dp) :: hub_inertia(2) = 0               !< at the bores, beside the gears' own, kg m^2
    type(material_t) :: material(2)              !< of pinion and gear
    ! &load, one of them
    real(dp) :: torque = 0, normal_force = 0, line_load = 0
    ! &relief
    real(dp), allocatable :: amount(:)
    real(dp) :: fraction(2) = 1
    integer :: shape = linear
    character(:), allocatable :: start           !< hpstc, pitch, length, roll
    real(dp) :: length = 0, roll(2) = 0
    ! &mesh
    character(:), allocatable :: model, file, profile_error_file
    real(dp) :: shared_compliance = 0            !< m/N
    real(dp), allocatable :: coefficients(:)
    real(dp) :: contact_ratio = 0, base_pitch = 0
    type(iso_options_t) :: iso                   !< K_A and the gears' blanks; its keys stand with load and gears
    real(dp) :: pitch_point = -1                 !< below 0: half the contact ratio
    logical :: tooth_coupling = .true., corner_contact = .true., nonlinear_contact = .true.
    ! &dynamics
    real(dp) :: damping_ratio = 0.17_dp, friction = 0
    ! &sweep, &numerics
    real(dp) :: rpm_first = 0, rpm_last = 0, rpm_step = 0
    integer :: direction = both
    type(accuracy_t) :: accuracy
    ! &section
    type(section_options_t) :: section
    logical :: has_support = .false., has_extent = .false.  !< the case says what is held, and how many teeth it has
    integer :: member = 1                        !< whose section is taken: 1 pinion, 2 gear
    character(:), allocatable :: published       !< file of printed values to set beside ours
    !> Keys that are given but not used: a line for each use that they would have.
    character(:), allocatable :: unused
  contains
    procedure :: want
    procedure :: asks
    procedure :: relieves
    procedure :: needs
    procedure :: tasks_for
    procedure :: needs_elements
    procedure :: models_teeth
    procedure :: touches_beyond
    procedure :: weighs
  end type case_t

contains

  !> Makes these its tasks, of all that there are, and no others.
  subroutine want(self, tasks)
    class(case_t), intent(inout) :: self
    character(*), intent(in) :: tasks(:)
    integer :: i

    do i = 1, size(self%tasks)
      self%tasks(i)%is_wanted = any(tasks == self%tasks(i)%info%name)
    end do
  end subroutine want

  !> Is this one of the tasks?
  pure logical function asks(self, task)
    class(case_t), intent(in) :: self
    character(*), intent(in) :: task
    integer :: i

    asks = any([(self%tasks(i)%is_wanted .and. self%tasks(i)%info%name == task, i=1, size(self%tasks))])
  end function asks

  !> Do its reliefs matter: is an amount above 0, or does a task look for amounts of its own?
  pure logical function relieves(self)
    class(case_t), intent(in) :: self

    relieves = any(self%amount > 0) .or. self%asks('optimum') .or. self%asks('deflection_relief')
  end function relieves

  !> Does one of the case's tasks need this stage ?
  pure logical function needs(self, which)
    class(case_t), intent(in) :: self
    integer, intent(in) :: which                 !< of `stage`
    integer :: i

    needs = any([(self%tasks(i)%takes(which), i=1, size(self%tasks))])
  end function needs

  !> All tasks that need this stage, whether the case names them or not, as in `load, sweep or optimum`.
  pure function tasks_for(self, which) result(words)
    class(case_t), intent(in) :: self
    integer, intent(in) :: which                 !< of `stage`
    character(sentence_length) :: words

    words = sentence_of(self%tasks, which)
  end function tasks_for

  !> What a key lacks: the tasks that need this stage, told as in `load, sweep or optimum`, or nothing where the
  !> case names one of them.
  pure function for_stage(case, which) result(what)
    type(case_t), intent(in) :: case
    integer, intent(in) :: which                 !< of `stage`
    character(sentence_length) :: what

    what = unless(case%needs(which), trim(case%tasks_for(which)))
  end function for_stage

  !> What a key of ISO 6336 lacks: tasks that need this stage, or a stiffness by ISO 6336.
  pure function for_iso(case, which) result(what)
    type(case_t), intent(in) :: case
    integer, intent(in) :: which                 !< of `stage`
    character(sentence_length) :: what

    what = unless(case%needs(which) .or. case%needs(stage%mesh) .and. case%model == 'iso6336', &
                  trim(case%tasks_for(which))//' or a stiffness by iso6336')
  end function for_iso

  !> Does a task need both gears' stiffness by finite elements?
  pure logical function needs_elements(self)
    class(case_t), intent(in) :: self

    needs_elements = self%needs(stage%mesh) .and. self%model == 'fe'
  end function needs_elements

  !> Does the pair stiffness come from the gears' teeth, rather than from stated numbers?
  pure logical function models_teeth(self)
    class(case_t), intent(in) :: self

    models_teeth = any(self%model == [character(7) :: 'fe', 'weber', 'iso6336'])
  end function models_teeth

  !> May a pair touch before A and behind E too?
  pure logical function touches_beyond(self)
    class(case_t), intent(in) :: self

    touches_beyond = self%corner_contact .and. self%models_teeth()
  end function touches_beyond

  !> Is a gear's mass taken from its body, as neither mass nor inertia is given?
  pure logical function weighs(self, member)
    class(case_t), intent(in) :: self
    integer, intent(in) :: member

    weighs = self%needs(stage%mesh) .and. .not. (self%mass(member) > 0 .or. self%inertia(member) > 0)
  end function weighs

  !> How many speeds the sweep has.
  pure integer function speed_count(case)
    type(case_t), intent(in) :: case

    ! A hair of slack keeps the last speed where the step divides the range.
    speed_count = 1 + int((case%rpm_last - case%rpm_first)/case%rpm_step + 1e-9_dp)
  end function speed_count

  !> The pinion speeds of the sweep (1/min), ascending.
  pure function speeds(case) result(rpm)
    type(case_t), intent(in) :: case
    real(dp), allocatable :: rpm(:)
    integer :: i

    allocate (rpm(speed_count(case)))
    do i = 1, size(rpm)
      rpm(i) = case%rpm_first + case%rpm_step*(i - 1)
    end do
  end function speeds
end module gearsweep_case
