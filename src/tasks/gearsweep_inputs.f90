!> What the products of a study are made from.
!>
!> Each of these types holds all that its stage takes, and the stage has nothing else at hand: an input cannot be
!> forgotten. But for lists, which are compared one by one, they have no allocatable components, so that one `write`
!> gives all that they hold to the last bit; where somebody adds one, the compiler refuses that. Inputs that write the same
!> text are the same; those of the same bytes are without being written, but bytes between components may differ.
module gearsweep_inputs
  use, intrinsic :: iso_fortran_env, only: int64
  use gearsweep_disc, only: disc_t
  use gearsweep_elastic_options, only: fe_options_t, section_options_t
  use gearsweep_gear, only: gear_t
  use gearsweep_kinds, only: dp
  use gearsweep_material, only: material_t
  use gearsweep_own_flattening, only: flattening_t
  use gearsweep_pair, only: pair_t
  use gearsweep_piecewise, only: piecewise_t
  use gearsweep_steady_motion, only: steady_choice_t, step_choice_t
  implicit none
  private
  public :: elements_inputs_t, body_inputs_t, solid_inputs_t, unit_inputs_t, relief_inputs_t, motion_inputs_t
  public :: motions_inputs_t, choice_t, same, same_but_amounts

  !> Of the pair stiffness by finite elements, with its disc.
  type :: elements_inputs_t
    type(pair_t) :: pair
    type(material_t) :: material(2)
    type(fe_options_t) :: options
    real(dp) :: line_load = 0                    !< N/m
  end type elements_inputs_t

  !> Of one gear's section: its two grids, and their factored bodies.
  type :: body_inputs_t
    type(gear_t) :: gear
    type(material_t) :: material
    type(section_options_t) :: options
  end type body_inputs_t

  !> Of one gear's body in three dimensions.
  type :: solid_inputs_t
    type(gear_t) :: gear
    type(material_t) :: material
    real(dp) :: web = 0, rim = 0                 !< thickness, m; 0: a solid disc
  end type solid_inputs_t

  !> Of the root stress under unit loads.
  type :: unit_inputs_t
    type(body_inputs_t) :: body
    real(dp), allocatable :: radius(:)           !< where they act, m
  end type unit_inputs_t

  !> Of the profile error that an amount of relief makes.
  type :: relief_inputs_t
    logical :: prescribed = .false.              !< no pair is known
    type(pair_t) :: pair
    real(dp) :: base_pitch = 0                   !< m; 0: not known
    real(dp) :: contact_ratio = 0, pitch_point = 0
    real(dp) :: fraction(2) = 1
    integer :: shape = 0
    character(8) :: start = ''                   !< hpstc, pitch, length, roll
    real(dp) :: length = 0, roll(2) = 0          !< m, rad
    real(dp) :: shift(2) = 0                     !< by which the reliefs of pinion and gear begin later, base pitches
  end type relief_inputs_t

  !> Of an oscillator, beside pair stiffness and amount of relief.
  type :: motion_inputs_t
    type(relief_inputs_t) :: relief
    type(disc_t) :: disc
    real(dp) :: reach(2) = 0                     !< path coordinates between which a pair may be in contact
    type(flattening_t) :: flattening             !< as in mesh_t
    integer :: teeth(2) = 0
    real(dp) :: tan_angle = 0
    real(dp) :: arm_change(2, 2) = 0             !< as in mesh_t
    real(dp) :: load = 0, mass(2) = 0            !< N, kg
    real(dp) :: damping_ratio = 0, friction = 0
    logical :: has_backlash = .false.
    real(dp) :: backlash = 0                     !< m
  end type motion_inputs_t

  !> Of the oscillators: one for each amount of relief.
  type :: motions_inputs_t
    type(motion_inputs_t) :: motion
    type(piecewise_t) :: stiffness               !< of one pair, N/m over s
    type(piecewise_t) :: profile_error           !< of one pair, m over s; without breaks: the relief makes it
    real(dp), allocatable :: amount(:)           !< m
  end type motions_inputs_t

  !> What steady motions depend on beside the oscillator and the speed.
  type :: choice_t
    type(step_choice_t) :: steps
    type(steady_choice_t) :: steady
  end type choice_t

  interface same
    module procedure same_elements, same_bodies, same_solids, same_units, same_choices, same_list, same_number
  end interface same

  !> Every component: numbers with all their digits.
  character(*), parameter :: written = '(*(g0, 1x))'
  integer(int64), parameter :: bytes(1) = 0

contains

  !> Compares the bytes; each of the two texts has room for them eight times over.
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

  pure logical function same_solids(a, b) result(same)
    type(solid_inputs_t), intent(in) :: a, b
    character(storage_size(a)) :: words(2)

    same = all(transfer(a, bytes) == transfer(b, bytes))
    if (same) return
    write (words(1), written) a
    write (words(2), written) b
    same = words(1) == words(2)
  end function same_solids

  pure logical function same_units(a, b) result(same)
    type(unit_inputs_t), intent(in) :: a, b

    same = same_bodies(a%body, b%body) .and. same_list(a%radius, b%radius)
  end function same_units

  !> Whatever their amounts of relief.
  pure logical function same_but_amounts(a, b) result(same)
    type(motions_inputs_t), intent(in) :: a, b
    character(storage_size(a%motion)) :: words(2)

    same = all(transfer(a%motion, bytes) == transfer(b%motion, bytes))
    if (.not. same) then
      ! What is mostly changed.
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
end module gearsweep_inputs
