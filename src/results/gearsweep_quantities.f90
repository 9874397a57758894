!> Our values of the quantities that papers print, by name.
module gearsweep_quantities
  use gearsweep_kinds, only: dp
  use gearsweep_beam, only: beam_t, hassan_shape
  use gearsweep_error, only: error_t
  use gearsweep_gear, only: coast, drive
  use gearsweep_published, only: split_quantity
  use gearsweep_study, only: study_t
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
    character(:), allocatable :: name
    integer :: n

    value = 0
    known = allocated(study%pair)
    if (.not. known) return
    call split_quantity(quantity, name, n)
    associate (angle => study%pair%gear(1)%spec%pressure_angle(drive))
      select case (name)
      case ('contact_ratio')
        value = study%pair%contact_ratio
      case ('tangential_force_n')
        known = study%load > 0
        value = study%load*cos(angle)
      case ('radial_force_n')
        known = study%load > 0
        value = study%load*sin(angle)
      case ('mode_#_hz')
        known = allocated(study%modal) .and. n <= study%case%modes
        if (known) value = study%modal%modes%frequency(n)
      case ('step_#_sigma_x_mpa')
        call step_value(study, n, 1, value, known)
      case ('step_#_sigma_y_mpa')
        call step_value(study, n, 2, value, known)
      case ('step_#_tau_xy_mpa')
        call step_value(study, n, 3, value, known)
      case default
        call beam_value(study, name, value, known)
      end select
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
        known = study%load > 0
        beam%length = gear%reference_radius - gear%root_radius
        stress = beam%stress(study%load, gear%spec%pressure_angle(drive))
        value = 1e-6_dp*merge(stress(1), stress(2), quantity == 'beam_sigma_x_mpa')
      case default
        known = .false.
      end select
    end associate
  end subroutine beam_value

  !> Size of a stress component on the coast side, under one position of the load.
  pure subroutine step_value(study, n, component, value, known)
    type(study_t), intent(in) :: study
    integer, intent(in) :: n, component
    real(dp), intent(out) :: value
    logical, intent(out) :: known

    value = 0
    known = allocated(study%root)
    if (known) known = n <= size(study%root(1)%s)
    if (known) value = 1e-6_dp*abs(study%root(1)%components(component, coast, n))
  end subroutine step_value
end module gearsweep_quantities
