!> The oscillators of a case over one of its numbers, or two: speed, damping ratio, amount of relief, load.
module gearsweep_case_family
  use gearsweep_bifurcation, only: family_t
  use gearsweep_case_variation, only: case_variation_t, number_names, number_units, of_force, of_relief, of_rpm
  use gearsweep_error, only: code_input, error_t, fail
  use gearsweep_kinds, only: dp
  use gearsweep_oscillator, only: mesh_period, oscillator_t
  use gearsweep_text, only: str
  implicit none
  private
  public :: case_family_t, make_case_family

  !> The first of a case's numbers are what branches may be followed over.
  integer, parameter, public :: parameters = of_force
  character(*), parameter, public :: parameter_names(parameters) = number_names(:parameters)

  type, extends(family_t) :: case_family_t
    type(case_variation_t) :: case
    integer :: which(2) = [of_rpm, 0]            !< of its numbers are the parameters; 0: there is no second one
  contains
    procedure :: oscillator_at, duration_at, numbers_at
  end type case_family_t

contains

  !> The family of a case, after a look at both ends of its ranges.
  subroutine make_case_family(case, which, range, family, error)
    type(case_variation_t), intent(in) :: case
    integer, intent(in) :: which(2)              !< the parameters; 0: no second one
    real(dp), intent(in) :: range(2, 2)          !< their first and last values; (end, parameter)
    type(case_family_t), intent(out) :: family
    type(error_t), allocatable, intent(inout) :: error
    type(error_t), allocatable :: refused
    type(oscillator_t) :: osc
    character(80) :: words
    integer :: end

    family%case = case
    family%which = which
    family%first = range(1, :)
    family%last = range(2, :)
    family%is_speed = which == of_rpm .or. which == 0
    family%least = merge(1e-3_dp*family%first, 0.0_dp, which == of_rpm .or. which == of_force)
    if (any(which == of_relief) .and. allocated(case%inputs%profile_error%breaks)) &
      call fail(error, code_input, '&branches parameter = ''relief_um'': the profile error is prescribed')
    do end = 1, 2
      if (allocated(error)) return
      call family%oscillator_at([range(end, 1), range(end, 2)], osc, refused)
      if (.not. allocated(refused)) cycle
      words = trim(merge('first', 'last ', end == 1))//' = '//str(range(end, 1)/number_units(which(1)))
      if (which(2) > 0) words = trim(words)//', second_'//trim(merge('first', 'last ', end == 1))//' = '// &
                                str(range(end, 2)/number_units(which(2)))
      call fail(error, code_input, '&branches '//trim(words)//': '//refused%message)
    end do
  end subroutine make_case_family

  !> The numbers that may be parameters, where the parameters have these values.
  pure function numbers_at(self, value) result(numbers)
    class(case_family_t), intent(in) :: self
    real(dp), intent(in) :: value(2)
    real(dp) :: numbers(parameters)
    integer :: i

    numbers = [(self%case%number(i), i=1, parameters)]
    do i = 1, 2
      if (self%which(i) > 0) numbers(self%which(i)) = value(i)
    end do
  end function numbers_at

  subroutine oscillator_at(self, value, osc, error)
    class(case_family_t), intent(in) :: self
    real(dp), intent(in) :: value(2)
    type(oscillator_t), intent(out) :: osc
    type(error_t), allocatable, intent(out) :: error
    type(case_variation_t) :: case
    integer :: i

    case = self%case
    do i = 1, 2
      call case%set(self%which(i), value(i))
    end do
    call case%build(osc, error)
  end subroutine oscillator_at

  !> Duration of the mesh period, s.
  pure real(dp) function duration_at(self, value)
    class(case_family_t), intent(in) :: self
    real(dp), intent(in) :: value(2)
    real(dp) :: numbers(parameters)

    numbers = self%numbers_at(value)
    duration_at = mesh_period(self%case%inputs%motion%teeth(1), numbers(of_rpm))
  end function duration_at
end module gearsweep_case_family
