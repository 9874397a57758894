!> The oscillators of a case over one of its numbers, or two: speed, damping ratio, amount of relief, load.
module gearsweep_case_family
  use gearsweep_error, only: code_input, error_t, fail
  use gearsweep_inputs, only: motion_inputs_t, motions_inputs_t
  use gearsweep_kinds, only: dp
  use gearsweep_motion_equations, only: family_t
  use gearsweep_motions, only: build_motion
  use gearsweep_oscillator, only: mesh_period, oscillator_t
  use gearsweep_text, only: str
  implicit none
  private
  public :: case_family_t, make_case_family, parameter_names, parameter_units

  !> Which number; their names are those of the keys and columns.
  integer, parameter, public :: of_speed = 1, of_damping = 2, of_relief = 3, of_load = 4
  character(*), parameter :: parameter_names(4) = [character(14) :: 'rpm', 'damping_ratio', 'relief_um', 'normal_force_n']
  !> What one of their units is in SI units.
  real(dp), parameter :: parameter_units(4) = [1.0_dp, 1.0_dp, 1e-6_dp, 1.0_dp]

  type, extends(family_t) :: case_family_t
    type(motions_inputs_t) :: inputs
    real(dp) :: base(4) = 0                      !< the case's numbers, 1/min, -, m, N
    integer :: which(2) = [of_speed, 0]          !< of them are the parameters; 0: there is no second one
  contains
    procedure :: oscillator_at, duration_at, numbers_at
  end type case_family_t

contains

  !> The family of a case, after a look at both ends of its ranges.
  subroutine make_case_family(inputs, base, which, range, family, error)
    type(motions_inputs_t), intent(in) :: inputs
    real(dp), intent(in) :: base(4)              !< speed (1/min), damping ratio, relief (m), load (N) of the case
    integer, intent(in) :: which(2)              !< the parameters; 0: no second one
    real(dp), intent(in) :: range(2, 2)          !< their first and last values; (end, parameter)
    type(case_family_t), intent(out) :: family
    type(error_t), allocatable, intent(inout) :: error
    type(error_t), allocatable :: refused
    type(oscillator_t) :: osc
    character(80) :: words
    integer :: end

    family%inputs = inputs
    family%base = base
    family%which = which
    family%first = range(1, :)
    family%last = range(2, :)
    family%is_speed = which == of_speed .or. which == 0
    family%least = merge(1e-3_dp*family%first, 0.0_dp, which == of_speed .or. which == of_load)
    if (any(which == of_relief) .and. allocated(inputs%profile_error%breaks)) &
      call fail(error, code_input, '&branches parameter = ''relief_um'': the profile error is prescribed')
    do end = 1, 2
      if (allocated(error)) return
      call family%oscillator_at([range(end, 1), range(end, 2)], osc, refused)
      if (.not. allocated(refused)) cycle
      words = trim(merge('first', 'last ', end == 1))//' = '//str(range(end, 1)/parameter_units(which(1)))
      if (which(2) > 0) words = trim(words)//', second_'//trim(merge('first', 'last ', end == 1))//' = '// &
                                str(range(end, 2)/parameter_units(which(2)))
      call fail(error, code_input, '&branches '//trim(words)//': '//refused%message)
    end do
  end subroutine make_case_family

  !> All four numbers where the parameters have these values.
  pure function numbers_at(self, value) result(numbers)
    class(case_family_t), intent(in) :: self
    real(dp), intent(in) :: value(2)
    real(dp) :: numbers(4)
    integer :: i

    numbers = self%base
    do i = 1, 2
      if (self%which(i) > 0) numbers(self%which(i)) = value(i)
    end do
  end function numbers_at

  subroutine oscillator_at(self, value, osc, error)
    class(case_family_t), intent(in) :: self
    real(dp), intent(in) :: value(2)
    type(oscillator_t), intent(out) :: osc
    type(error_t), allocatable, intent(out) :: error
    type(motion_inputs_t) :: motion
    real(dp) :: numbers(4)

    numbers = self%numbers_at(value)
    motion = self%inputs%motion
    motion%damping_ratio = numbers(of_damping)
    motion%load = numbers(of_load)
    call build_motion(motion, self%inputs%stiffness, self%inputs%profile_error, numbers(of_relief), osc, error)
  end subroutine oscillator_at

  !> Duration of the mesh period, s.
  pure real(dp) function duration_at(self, value)
    class(case_family_t), intent(in) :: self
    real(dp), intent(in) :: value(2)
    real(dp) :: numbers(4)

    numbers = self%numbers_at(value)
    duration_at = mesh_period(self%inputs%motion%teeth(1), numbers(of_speed))
  end function duration_at
end module gearsweep_case_family
