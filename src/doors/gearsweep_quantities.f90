!> Our values of the quantities that papers print, by name.
module gearsweep_quantities
  use gearsweep_kinds, only: dp
  use gearsweep_beam, only: beam_t, hassan_shape
  use gearsweep_error, only: error_t
  use gearsweep_gear, only: coast, drive
  use gearsweep_study, only: study_t
  use gearsweep_text, only: to_number
  implicit none
  private
  public :: our_value

contains

  !> Our value of a named quantity; `known` is false where the study lacks it.
  pure subroutine our_value(study, quantity, value, known)
    type(study_t), intent(in) :: study
    character(*), intent(in) :: quantity
    real(dp), intent(out) :: value
    logical, intent(out) :: known
    integer :: n

    value = 0
    known = allocated(study%pair)
    if (.not. known) return
    associate (angle => study%pair%gear(1)%spec%pressure_angle(drive))
      if (quantity == 'contact_ratio') then
        value = study%pair%contact_ratio
      else if (quantity == 'tangential_force_n') then
        value = study%load*cos(angle)
      else if (quantity == 'radial_force_n') then
        value = study%load*sin(angle)
      else if (index(quantity, 'beam_') == 1 .or. index(quantity, 'rayleigh_') == 1) then
        call beam_value(study, quantity, value, known)
      else if (index(quantity, 'mode_') == 1) then
        n = number_in(quantity)
        known = allocated(study%modal) .and. n > 0 .and. n <= study%case%modes
        if (known) value = study%modal%modes%frequency(n)
      else if (index(quantity, 'step_') == 1) then
        call step_value(study, quantity, value, known)
      else
        known = .false.
      end if
    end associate
  end subroutine our_value

  !> The tooth as a beam of its height, for stress of the height from root to
  !> reference circle, as thick as the tooth on the reference circle.
  pure subroutine beam_value(study, quantity, value, known)
    type(study_t), intent(in) :: study
    character(*), intent(in) :: quantity
    real(dp), intent(out) :: value
    logical, intent(out) :: known
    type(error_t), allocatable :: error
    type(beam_t) :: beam
    real(dp) :: stress(2)

    known = .true.
    value = 0
    associate (gear => study%pair%gear(study%case%root%member))
      beam = beam_t(gear%tip_radius - gear%root_radius, gear%thickness(gear%reference_radius), gear%spec%face_width)
      select case (quantity)
      case ('beam_frequency_rad_s')
        value = beam%spring_frequency(study%case%material)
      case ('rayleigh_frequency_rad_s')
        call beam%rayleigh_frequency(study%case%material, hassan_shape, value, error)
        known = .not. allocated(error)
      case ('beam_sigma_x_mpa', 'beam_sigma_y_mpa')
        beam%length = gear%reference_radius - gear%root_radius
        stress = beam%stress(study%load, gear%spec%pressure_angle(drive))
        value = 1e-6_dp*merge(stress(1), stress(2), quantity == 'beam_sigma_x_mpa')
      case default
        known = .false.
      end select
    end associate
  end subroutine beam_value

  !> Size of the stress components on the coast side, under one position of the load.
  pure subroutine step_value(study, quantity, value, known)
    type(study_t), intent(in) :: study
    character(*), intent(in) :: quantity
    real(dp), intent(out) :: value
    logical, intent(out) :: known
    integer :: n, component

    value = 0
    n = number_in(quantity)
    component = 0
    if (index(quantity, '_sigma_x_mpa') > 0) component = 1
    if (index(quantity, '_sigma_y_mpa') > 0) component = 2
    if (index(quantity, '_tau_xy_mpa') > 0) component = 3
    known = allocated(study%root) .and. n > 0 .and. component > 0
    if (known) known = n <= size(study%root(1)%s)
    if (known) value = 1e-6_dp*abs(study%root(1)%components(component, coast, n))
  end subroutine step_value

  !> The number between the first two underscores; 0 for none.
  pure integer function number_in(quantity) result(n)
    character(*), intent(in) :: quantity
    integer :: from, length
    logical :: ok

    from = index(quantity, '_') + 1
    length = index(quantity(from:), '_') - 1
    n = 0
    if (length > 0) call to_number(quantity(from:from + length - 1), n, ok)
  end function number_in
end module gearsweep_quantities
