!> A case with other numbers: which they are, their names and units, and the oscillator that they lead to.
module gearsweep_case_variation
  use gearsweep_error, only: error_t
  use gearsweep_inputs, only: motions_inputs_t
  use gearsweep_kinds, only: dp
  use gearsweep_motions, only: build_motion
  use gearsweep_oscillator, only: mesh_period, oscillator_t
  implicit none
  private
  public :: case_variation_t, with_relief

  integer, parameter, public :: of_rpm = 1, of_damping = 2, of_relief = 3, of_force = 4, of_friction = 5, of_mass(2) = [6, 7], &
    of_stiffness = 8, of_amount(2) = [9, 10], of_start(2) = [11, 12], of_profile = 13, of_backlash = 14
  !> As keys and columns call them.
  character(*), parameter, public :: number_names(14) = [character(20) :: 'rpm', 'damping_ratio', 'relief_um', 'normal_force_n', &
    'friction', 'pinion_mass_kg', 'gear_mass_kg', 'stiffness_factor', 'pinion_relief_um', 'gear_relief_um', 'pinion_relief_start', &
    'gear_relief_start', 'profile_factor', 'backlash_um']
  !> What one of their units is in SI units.
  real(dp), parameter, public :: number_units(14) = [1.0_dp, 1.0_dp, 1e-6_dp, 1.0_dp, 1.0_dp, 1.0_dp, 1.0_dp, 1.0_dp, 1e-6_dp, &
                                                     1e-6_dp, 1.0_dp, 1.0_dp, 1.0_dp, 1e-6_dp]

  type :: case_variation_t
    type(motions_inputs_t) :: inputs
    real(dp) :: relief = 0                       !< amount, which the fractions of `inputs` multiply, m
    real(dp) :: rpm = 0                          !< speed of the pinion, 1/min
  contains
    procedure :: number, set, set_reliefs, build, duration
  end type case_variation_t

contains

  !> One of its numbers in SI units; of where relief begins, by how much later than the case says; of factors, 1.
  pure real(dp) function number(self, which)
    class(case_variation_t), intent(in) :: self
    integer, intent(in) :: which
    real(dp) :: all(size(number_names))

    associate (motion => self%inputs%motion)
      all = [self%rpm, motion%damping_ratio, self%relief, motion%load, motion%friction, motion%mass, 1.0_dp, &
             self%relief*motion%relief%fraction, motion%relief%shift, 1.0_dp, motion%backlash]
    end associate
    number = all(which)
  end function number

  !> The same case with another value of that number. The stiffness changes as a whole, with what teeth share and the
  !> bodies behind them, as it would with the modulus of elasticity.
  pure subroutine set(self, which, value)
    class(case_variation_t), intent(inout) :: self
    integer, intent(in) :: which
    real(dp), intent(in) :: value
    real(dp) :: amount(2)

    associate (motion => self%inputs%motion)
      select case (which)
      case (of_rpm)
        self%rpm = value
      case (of_damping)
        motion%damping_ratio = value
      case (of_relief)
        self%relief = value
      case (of_force)
        motion%load = value
      case (of_friction)
        motion%friction = value
      case (of_stiffness)
        call stiffen(value, self%inputs)
      case (of_profile)
        self%inputs%profile_error%coef = value*self%inputs%profile_error%coef
      case (of_backlash)
        motion%backlash = value
      case default
        ! Of one of the gears.
        amount = self%relief*motion%relief%fraction
        where (of_amount == which) amount = value
        if (any(of_amount == which)) call self%set_reliefs(amount)
        where (of_mass == which) motion%mass = value
        where (of_start == which) motion%relief%shift = value
      end select
    end associate
  end subroutine set

  !> The same case with these amounts of relief at the tips of pinion and gear (m).
  pure subroutine set_reliefs(self, amount)
    class(case_variation_t), intent(inout) :: self
    real(dp), intent(in) :: amount(2)

    self%inputs%motion%relief%fraction = amount
    self%relief = merge(1.0_dp, 0.0_dp, any(amount > 0))
  end subroutine set_reliefs

  subroutine build(self, osc, error)
    class(case_variation_t), intent(in) :: self
    type(oscillator_t), intent(out) :: osc
    type(error_t), allocatable, intent(out) :: error

    call build_motion(self%inputs, self%relief, osc, error)
  end subroutine build

  !> Of the mesh period, s.
  pure real(dp) function duration(self)
    class(case_variation_t), intent(in) :: self

    duration = mesh_period(self%inputs%motion%teeth(1), self%rpm)
  end function duration

  !> A case with another amount of relief (m), for `find_optimum`; `context` is the case.
  subroutine with_relief(context, amount, motion, error)
    class(*), intent(in) :: context
    real(dp), intent(in) :: amount
    type(oscillator_t), intent(out) :: motion
    type(error_t), allocatable, intent(out) :: error

    select type (context)
    type is (motions_inputs_t)
      call build_motion(context, amount, motion, error)
    end select
  end subroutine with_relief

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
end module gearsweep_case_variation
