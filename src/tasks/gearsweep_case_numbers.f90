!> The numbers of a case by which a motion is differentiated: their names, units and values, and the oscillators with other values.
module gearsweep_case_numbers
  use gearsweep_error, only: error_t
  use gearsweep_inputs, only: motions_inputs_t
  use gearsweep_kinds, only: dp
  use gearsweep_motions, only: build_motion, relief_start
  use gearsweep_oscillator, only: mesh_period, oscillator_t
  use gearsweep_sensitivity, only: variation_t
  implicit none
  private
  public :: case_number_t, list_numbers, number_names, number_units, is_static

  integer, parameter, public :: of_rpm = 1, of_force = 2, of_damping = 3, of_friction = 4, of_mass(2) = [5, 6], of_stiffness = 7, &
                                of_amount(2) = [8, 9], of_start(2) = [10, 11], of_profile = 12, of_backlash = 13
  character(*), parameter :: number_names(13) = [character(20) :: 'rpm', 'normal_force_n', 'damping_ratio', 'friction', &
    'pinion_mass_kg', 'gear_mass_kg', 'stiffness_factor', 'pinion_relief_um', 'gear_relief_um', 'pinion_relief_start', &
    'gear_relief_start', 'profile_factor', 'backlash_um']
  !> What one of their units is in SI units.
  real(dp), parameter :: number_units(13) = [1.0_dp, 1.0_dp, 1.0_dp, 1.0_dp, 1.0_dp, 1.0_dp, 1.0_dp, 1e-6_dp, 1e-6_dp, 1.0_dp, &
                                             1.0_dp, 1.0_dp, 1e-6_dp]

  !> One number of a case with this relief at this speed.
  type, extends(variation_t) :: case_number_t
    integer :: which = 0
    type(motions_inputs_t) :: inputs
    real(dp) :: amount(2) = 0                    !< of relief at the tips of pinion and gear, m
    real(dp) :: rpm = 0                          !< speed of the pinion, 1/min
  contains
    procedure :: vary
  end type case_number_t

contains

  !> Those that matter for a case with this amount of relief (m) at a speed (1/min).
  subroutine list_numbers(inputs, relief, rpm, numbers)
    type(motions_inputs_t), intent(in) :: inputs
    real(dp), intent(in) :: relief, rpm
    type(case_number_t), allocatable, intent(out) :: numbers(:)
    type(case_number_t) :: all(size(number_names))
    logical :: matters(size(number_names))
    real(dp) :: deflection
    integer :: i

    associate (motion => inputs%motion)
      do i = 1, size(all)
        all(i)%which = i
        all(i)%least = 0
        all(i)%inputs = inputs
        all(i)%amount = relief*motion%relief%fraction
        all(i)%rpm = rpm
      end do
      all%value = [rpm, motion%load, motion%damping_ratio, motion%friction, motion%mass, 1.0_dp, all(1)%amount, &
                   relief_start(motion%relief), 1.0_dp, motion%backlash]
      deflection = motion%load/inputs%stiffness%value(motion%relief%contact_ratio/2)
      all%scale = all%value
      all(of_damping)%scale = max(all(of_damping)%value, 0.01_dp)
      all(of_amount)%scale = max(all(of_amount)%value, deflection)
      all(of_start)%scale = 1
      all(of_backlash)%scale = deflection
      matters = .true.
      matters(of_friction) = motion%friction > 0
      matters(of_profile) = allocated(inputs%profile_error%breaks)
      if (matters(of_profile)) matters(of_profile) = any(abs(inputs%profile_error%coef) > 0)
      ! Without relief, where and how it begins does not matter.
      matters(of_amount) = relief > 0 .and. .not. allocated(inputs%profile_error%breaks)
      matters(of_start) = matters(of_amount) .and. all(of_amount)%value > 0
      matters(of_backlash) = motion%has_backlash
    end associate
    numbers = pack(all, matters)
  end subroutine list_numbers

  !> Does the static transmission error depend on it?
  elemental logical function is_static(which)
    integer, intent(in) :: which

    is_static = any(which == [of_force, of_stiffness, of_amount, of_start, of_profile])
  end function is_static

  !> The case with `change` more of the number, in SI units. The stiffness changes as a whole, with what teeth share and the
  !> bodies behind them, as it would with the modulus of elasticity.
  subroutine vary(self, change, osc, duration, error)
    class(case_number_t), intent(in) :: self
    real(dp), intent(in) :: change
    type(oscillator_t), intent(out) :: osc
    real(dp), intent(out) :: duration
    type(error_t), allocatable, intent(out) :: error
    type(motions_inputs_t) :: inputs
    real(dp) :: amount(2), rpm

    inputs = self%inputs
    amount = self%amount
    rpm = self%rpm
    associate (motion => inputs%motion)
      select case (self%which)
      case (of_rpm)
        rpm = rpm + change
      case (of_force)
        motion%load = motion%load + change
      case (of_damping)
        motion%damping_ratio = motion%damping_ratio + change
      case (of_friction)
        motion%friction = motion%friction + change
      case (of_stiffness)
        call stiffen(1 + change, inputs)
      case (of_profile)
        inputs%profile_error%coef = (1 + change)*inputs%profile_error%coef
      case (of_backlash)
        motion%backlash = motion%backlash + change
      case default
        ! Of one of the gears.
        where (of_mass == self%which) motion%mass = motion%mass + change
        where (of_amount == self%which) amount = amount + change
        where (of_start == self%which) motion%relief%shift = motion%relief%shift + change
      end select
      motion%relief%fraction = amount
      duration = mesh_period(motion%teeth(1), rpm)
      call build_motion(motion, inputs%stiffness, inputs%profile_error, merge(1.0_dp, 0.0_dp, any(amount > 0)), osc, error)
    end associate
  end subroutine vary

  pure subroutine stiffen(factor, inputs)
    real(dp), intent(in) :: factor
    type(motions_inputs_t), intent(inout) :: inputs

    inputs%stiffness%coef = factor*inputs%stiffness%coef
    associate (motion => inputs%motion, disc => inputs%motion%disc)
      motion%flattening = motion%flattening%scaled(1/factor)
      disc%turn = disc%turn/factor
      disc%shared = disc%shared/factor
      disc%change = disc%change/factor
      disc%decline = disc%decline/factor
      disc%twist = disc%twist/factor
    end associate
  end subroutine stiffen
end module gearsweep_case_numbers
