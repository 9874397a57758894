!> The numbers of a case by which a motion is differentiated, and the oscillators with other values of them.
module gearsweep_case_numbers
  use gearsweep_case_variation, only: case_variation_t, of_amount, of_backlash, of_damping, of_force, of_friction, of_mass, &
                                      of_profile, of_rpm, of_start, of_stiffness
  use gearsweep_error, only: error_t
  use gearsweep_inputs, only: motions_inputs_t
  use gearsweep_kinds, only: dp
  use gearsweep_motions, only: relief_start
  use gearsweep_oscillator, only: oscillator_t
  use gearsweep_sensitivity, only: variation_t
  implicit none
  private
  public :: case_number_t, list_numbers, is_static

  !> Which, in the order of the tables.
  integer, parameter :: listed(13) = [of_rpm, of_force, of_damping, of_friction, of_mass, of_stiffness, of_amount, of_start, &
                                      of_profile, of_backlash]

  !> One number of a case with this relief at this speed.
  type, extends(variation_t) :: case_number_t
    integer :: which = 0                         !< of gearsweep_case_variation
    type(case_variation_t) :: case
  contains
    procedure :: vary
  end type case_number_t

contains

  !> Those that matter for a case with this amount of relief (m) at a speed (1/min).
  subroutine list_numbers(inputs, relief, rpm, numbers)
    type(motions_inputs_t), intent(in) :: inputs
    real(dp), intent(in) :: relief, rpm
    type(case_number_t), allocatable, intent(out) :: numbers(:)
    type(case_variation_t) :: case
    real(dp) :: deflection
    integer :: i

    case = case_variation_t(inputs, relief, rpm)
    associate (motion => inputs%motion)
      deflection = motion%load/inputs%stiffness%value(motion%relief%contact_ratio/2)
    end associate
    allocate (numbers(0))
    do i = 1, size(listed)
      if (matters(case, listed(i))) numbers = [numbers, number_of(case, listed(i), deflection)]
    end do
  end subroutine list_numbers

  !> `deflection` (m) of a pair under the whole load is what changes of amounts are measured by.
  pure type(case_number_t) function number_of(case, which, deflection) result(of)
    type(case_variation_t), intent(in) :: case
    integer, intent(in) :: which
    real(dp), intent(in) :: deflection
    real(dp) :: start(2)

    of%which = which
    of%case = case
    of%least = 0
    of%value = case%number(which)
    start = relief_start(case%inputs%motion%relief)
    if (any(which == of_start)) of%value = start(findloc(of_start, which, 1))
    of%scale = of%value
    if (which == of_damping) of%scale = max(of%value, 0.01_dp)
    if (any(which == of_amount)) of%scale = max(of%value, deflection)
    if (any(which == of_start)) of%scale = 1
    if (which == of_backlash) of%scale = deflection
  end function number_of

  !> Without relief, where and how it begins does not matter.
  pure logical function matters(case, which)
    type(case_variation_t), intent(in) :: case
    integer, intent(in) :: which
    logical :: relieved

    associate (inputs => case%inputs)
      relieved = case%relief > 0 .and. .not. allocated(inputs%profile_error%breaks)
      select case (which)
      case (of_friction)
        matters = inputs%motion%friction > 0
      case (of_profile)
        matters = allocated(inputs%profile_error%breaks)
        if (matters) matters = any(abs(inputs%profile_error%coef) > 0)
      case (of_amount(1), of_amount(2))
        matters = relieved
      case (of_start(1), of_start(2))
        matters = relieved .and. case%number(of_amount(findloc(of_start, which, 1))) > 0
      case (of_backlash)
        matters = inputs%motion%has_backlash
      case default
        matters = .true.
      end select
    end associate
  end function matters

  !> Does the static transmission error depend on it?
  elemental logical function is_static(which)
    integer, intent(in) :: which

    is_static = any(which == [of_force, of_stiffness, of_amount, of_start, of_profile])
  end function is_static

  !> The case with `change` more of the number, in SI units.
  subroutine vary(self, change, osc, duration, error)
    class(case_number_t), intent(in) :: self
    real(dp), intent(in) :: change
    type(oscillator_t), intent(out) :: osc
    real(dp), intent(out) :: duration
    type(error_t), allocatable, intent(out) :: error
    type(case_variation_t) :: case

    case = self%case
    call case%set(self%which, case%number(self%which) + change)
    duration = case%duration()
    call case%build(osc, error)
  end subroutine vary
end module gearsweep_case_numbers
