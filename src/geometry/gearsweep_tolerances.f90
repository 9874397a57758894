!> Flank tolerances of a cylindrical gear by its flank tolerance class.
!> Source: ISO 1328-1:2013, the formulas of class 5 and the factor sqrt(2) from class to class; the run-out tolerance is the
!> standard's informative one. The standard's text was not at hand: the formulas are those of several public programs.
module gearsweep_tolerances
  use gearsweep_error, only: error_t, fail, code_input
  use gearsweep_kinds, only: dp
  use gearsweep_text, only: str
  implicit none
  private
  public :: tolerances_t, find_tolerances

  !> All in um.
  type :: tolerances_t
    real(dp) :: single_pitch = 0                 !< f_p
    real(dp) :: cumulative_pitch = 0             !< F_p
    real(dp) :: profile_slope = 0                !< f_Halpha
    real(dp) :: profile_form = 0                 !< f_falpha
    real(dp) :: profile = 0                      !< F_alpha
    real(dp) :: helix_slope = 0                  !< f_Hbeta
    real(dp) :: helix_form = 0                   !< f_fbeta
    real(dp) :: helix = 0                        !< F_beta
    real(dp) :: runout = 0                       !< F_r
  end type tolerances_t

contains

  !> The tolerances of a class, rounded as the standard does, or exactly.
  pure subroutine find_tolerances(class, teeth, module_mm, face_width_mm, tolerances, error, exactly)
    integer, intent(in) :: class                 !< flank tolerance class A, 1 to 11
    integer, intent(in) :: teeth                 !< 5 to 1000
    real(dp), intent(in) :: module_mm            !< normal module, 0.5 to 70 mm
    real(dp), intent(in) :: face_width_mm        !< 4 to 1200 mm
    type(tolerances_t), intent(out) :: tolerances
    type(error_t), allocatable, intent(out) :: error       !< a value out of the standard's range
    logical, intent(in), optional :: exactly     !< without rounding
    real(dp) :: d, factor
    logical :: rounds

    d = teeth*module_mm
    call demand('flank tolerance class', real(class, dp), 1.0_dp, 11.0_dp, error)
    call demand('number of teeth', real(teeth, dp), 5.0_dp, 1000.0_dp, error)
    call demand('module (mm)', module_mm, 0.5_dp, 70.0_dp, error)
    call demand('reference diameter (mm)', d, 5.0_dp, 15000.0_dp, error)
    call demand('face width (mm)', face_width_mm, 4.0_dp, 1200.0_dp, error)
    if (allocated(error)) return
    rounds = .true.
    if (present(exactly)) rounds = .not. exactly
    factor = sqrt(2.0_dp)**(class - 5)
    associate (m => module_mm, b => face_width_mm, t => tolerances)
      t%single_pitch = factor*(0.001_dp*d + 0.4_dp*m + 5)
      t%cumulative_pitch = factor*(0.002_dp*d + 0.55_dp*sqrt(d) + 0.7_dp*m + 12)
      t%profile_slope = factor*(0.4_dp*m + 0.001_dp*d + 4)
      t%profile_form = factor*(0.55_dp*m + 5)
      t%profile = hypot(t%profile_slope, t%profile_form)
      t%helix_slope = factor*(0.05_dp*sqrt(d) + 0.35_dp*sqrt(b) + 4)
      t%helix_form = factor*(0.07_dp*sqrt(d) + 0.45_dp*sqrt(b) + 4)
      t%helix = hypot(t%helix_slope, t%helix_form)
      t%runout = 0.9_dp*t%cumulative_pitch
      if (rounds) t = tolerances_t(rounded(t%single_pitch), rounded(t%cumulative_pitch), rounded(t%profile_slope), &
                                   rounded(t%profile_form), rounded(t%profile), rounded(t%helix_slope), rounded(t%helix_form), &
                                   rounded(t%helix), rounded(t%runout))
    end associate
  end subroutine find_tolerances

  pure subroutine demand(what, value, least, largest, error)
    character(*), intent(in) :: what
    real(dp), intent(in) :: value, least, largest
    type(error_t), allocatable, intent(inout) :: error

    if (.not. (value >= least .and. value <= largest)) call fail(error, code_input, what//' = '//str(value)// &
      ': ISO 1328-1 has tolerances from '//str(least)//' to '//str(largest))
  end subroutine demand

  !> To whole um above 10 um, to 0.5 um from 5 to 10, to 0.1 um below 5; halves away from 0.
  elemental real(dp) function rounded(value)
    real(dp), intent(in) :: value                !< um

    if (value > 10) then
      rounded = anint(value)
    else if (value >= 5) then
      rounded = anint(2*value)/2
    else
      rounded = anint(10*value)/10
    end if
  end function rounded
end module gearsweep_tolerances
