!> Cache keys of the stages of a study: two products are the same if their inputs are.
!>
!> Each type holds all inputs of one stage, and the stage has no others, so that no input can be forgotten. Apart from lists, which
!> are compared one by one, the types have no allocatable components: one `write` prints all components to the last bit, and the
!> compiler refuses it once somebody adds an allocatable one. Inputs with the same text are equal. Inputs with the same bytes are
!> equal without being written; padding bytes may differ between equal inputs.
module gearsweep_study_run_inputs
  use, intrinsic :: iso_fortran_env, only: int64
  use gearsweep_base, only: dp, piecewise_t
  use gearsweep_gear, only: gear_t, pair_t
  use gearsweep_elastic, only: disc_t, fe_options_t, flattening_t, material_t, section_options_t
  use gearsweep_motion, only: steady_choice_t, step_choice_t
  use gearsweep_study_case_case, only: faces_t
  implicit none
  private
  public :: elements_inputs_t, body_inputs_t, unit_inputs_t, relief_inputs_t, motion_inputs_t
  public :: motions_inputs_t, choice_t, same, same_but_amounts

  !> Inputs of the pair stiffness by finite elements, with its disc.
  type :: elements_inputs_t
    type(pair_t) :: pair
    type(material_t) :: material(2)
    type(fe_options_t) :: options
    real(dp) :: line_load = 0                    !< line load, N/m
  end type elements_inputs_t

  !> Inputs of one gear's section, its two grids and their factored bodies; or of its body in three dimensions.
  type :: body_inputs_t
    type(gear_t) :: gear
    type(material_t) :: material
    type(section_options_t) :: options = section_options_t()  !< of the section
    real(dp) :: web = 0, rim = 0                 !< thicknesses of the body, m; 0: a solid disc
  end type body_inputs_t

  !> Inputs of the root stress under unit loads.
  type :: unit_inputs_t
    type(body_inputs_t) :: body
    real(dp), allocatable :: radius(:)           !< radii of the loads, m
  end type unit_inputs_t

  !> Inputs of the profile error of an amount of relief.
  type :: relief_inputs_t
    logical :: prescribed = .false.              !< true if no pair is known
    type(pair_t) :: pair
    real(dp) :: base_pitch = 0                   !< base pitch, m; 0: not known
    real(dp) :: contact_ratio = 0, pitch_point = 0
    real(dp) :: fraction(2) = 1
    integer :: shape = 0
    character(8) :: start = ''                   !< key word of the start: hpstc, pitch, length or roll
    real(dp) :: length = 0, roll(2) = 0          !< length, m, and roll angles, rad, of the relief
    real(dp) :: shift(2) = 0                     !< shift of the start of the reliefs of pinion and gear, base pitches
  end type relief_inputs_t

  !> Inputs of an oscillator apart from pair stiffness and amount of relief.
  type :: motion_inputs_t
    type(relief_inputs_t) :: relief
    type(disc_t) :: disc
    integer :: spacing = 0                       !< of the springs of a pair, as in mesh_t
    real(dp) :: reach(2) = 0                     !< path coordinates between which a pair may be in contact, base pitches
    type(flattening_t) :: flattening             !< flattening of the flanks, as in mesh_t
    integer :: teeth(2) = 0
    real(dp) :: tan_angle = 0
    real(dp) :: arm_change(2, 2) = 0             !< changes of the lever arms, as in mesh_t
    real(dp) :: load = 0, mass(2) = 0            !< static load, N, and effective masses, kg
    real(dp) :: damping_ratio = 0, friction = 0
    logical :: has_backlash = .false.
    real(dp) :: backlash = 0                     !< backlash, m
  end type motion_inputs_t

  !> Inputs of the oscillators, one for each amount of relief.
  type :: motions_inputs_t
    type(motion_inputs_t) :: motion
    type(piecewise_t) :: stiffness               !< stiffness of one pair, N/m over s
    type(piecewise_t) :: profile_error           !< profile error of one pair, m over s; without breaks it follows from the relief
    real(dp), allocatable :: amount(:)           !< amounts of relief, m
  end type motions_inputs_t

  !> Inputs of steady motions apart from oscillator and speed.
  type :: choice_t
    type(step_choice_t) :: steps
    type(steady_choice_t) :: steady
  end type choice_t

  interface same
    module procedure same_elements, same_bodies, same_faces, same_units, same_choices, same_list, same_number
  end interface same

  !> Format of every component: numbers with all their digits.
  character(*), parameter :: written = '(*(g0, 1x))'
  integer(int64), parameter :: bytes(1) = 0

contains

  !> True if the bytes are equal; each of the two texts has room for them eight times over.
  pure logical function same_elements(a, b) result(same)
    type(elements_inputs_t), intent(in) :: a, b
    character(storage_size(a)) :: words(2)

    same = all(transfer(a, bytes) == transfer(b, bytes))
    if (same .or. abs(a%line_load - b%line_load) > 0) return
    write (words(1), written) a
    write (words(2), written) b
    same = words(1) == words(2)
  end function same_elements

  pure logical function same_bodies(a, b) result(same)
    type(body_inputs_t), intent(in) :: a, b
    character(storage_size(a)) :: words(2)

    same = all(transfer(a, bytes) == transfer(b, bytes))
    if (same) return
    write (words(1), written) a
    write (words(2), written) b
    same = words(1) == words(2)
  end function same_bodies

  pure logical function same_faces(a, b) result(same)
    type(faces_t), intent(in) :: a, b
    character(storage_size(a)) :: words(2)

    write (words(1), written) a
    write (words(2), written) b
    same = words(1) == words(2)
  end function same_faces

  pure logical function same_units(a, b) result(same)
    type(unit_inputs_t), intent(in) :: a, b

    same = same_bodies(a%body, b%body) .and. same_list(a%radius, b%radius)
  end function same_units

  !> True if all inputs but the amounts of relief are the same.
  pure logical function same_but_amounts(a, b) result(same)
    type(motions_inputs_t), intent(in) :: a, b
    character(storage_size(a%motion)) :: words(2)

    same = all(transfer(a%motion, bytes) == transfer(b%motion, bytes))
    if (.not. same) then
      ! The components that change most often are compared first.
      if (any(abs([a%motion%load, a%motion%damping_ratio] - [b%motion%load, b%motion%damping_ratio]) > 0)) return
      write (words(1), written) a%motion
      write (words(2), written) b%motion
      same = words(1) == words(2)
    end if
    same = same .and. same_curve(a%stiffness, b%stiffness) .and. same_curve(a%profile_error, b%profile_error)
  end function same_but_amounts

  pure logical function same_curve(a, b) result(same)
    type(piecewise_t), intent(in) :: a, b

    same = allocated(a%breaks) .eqv. allocated(b%breaks)
    if (.not. (same .and. allocated(a%breaks))) return
    same = same_list(a%breaks, b%breaks) .and. size(a%coef, 1) == size(b%coef, 1)
    if (same) same = .not. any(abs(a%coef - b%coef) > 0)
  end function same_curve

  pure logical function same_choices(a, b) result(same)
    type(choice_t), intent(in) :: a, b
    character(storage_size(a)) :: words(2)

    same = all(transfer(a, bytes) == transfer(b, bytes))
    if (same) return
    write (words(1), written) a
    write (words(2), written) b
    same = words(1) == words(2)
  end function same_choices

  pure logical function same_number(a, b) result(same)
    real(dp), intent(in) :: a, b

    same = .not. abs(a - b) > 0
  end function same_number

  pure logical function same_list(a, b) result(same)
    real(dp), intent(in) :: a(:), b(:)

    same = size(a) == size(b)
    if (same) same = .not. any(abs(a - b) > 0)
  end function same_list
end module gearsweep_study_run_inputs
