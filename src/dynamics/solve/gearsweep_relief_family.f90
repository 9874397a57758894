!> Oscillators that differ in the amount of one relief: one map serves all, as far as all pairs stay in contact.
module gearsweep_relief_family
  use gearsweep_coefficients, only: scheme_collocation
  use gearsweep_error_estimate, only: accuracy_t
  use gearsweep_kinds, only: dp
  use gearsweep_oscillator, only: oscillator_t
  use gearsweep_piecewise, only: piecewise_t
  use gearsweep_transient, only: by_shooting
  implicit none
  private
  public :: relief_family_t, find_family

  !> Oscillators that differ in the amount of their relief alone.
  type :: relief_family_t
    integer :: reference = 0                     !< that with the largest profile error; 0: they are no family
    real(dp), allocatable :: part(:)             !< of that profile error that each has; (oscillator)
  end type relief_family_t

contains

  !> What makes a family of these oscillators, if they are one and the options let steps be chosen.
  pure subroutine find_family(osc, options, family)
    type(oscillator_t), intent(in) :: osc(:)
    type(accuracy_t), intent(in) :: options
    type(relief_family_t), intent(out) :: family
    integer :: i, reference
    logical :: is_part

    if (size(osc) < 2 .or. options%steps > 0 .or. options%scheme /= scheme_collocation .or. &
        options%steady%method /= by_shooting) return
    reference = maxloc([(osc(i)%mesh%profile_error%maximum(), i=1, size(osc))], 1)
    ! Flanks that stand out may bring the coast sides into contact while the pairs carry.
    if (osc(reference)%mesh%profile_error%minimum() < 0) return
    allocate (family%part(size(osc)))
    do i = 1, size(osc)
      if (.not. are_alike(osc(i), osc(reference))) return
      call compare_curves(osc(i)%mesh%profile_error, osc(reference)%mesh%profile_error, family%part(i), is_part)
      if (.not. is_part) return
    end do
    family%reference = reference
  end subroutine find_family

  !> Are they the same but for the profile error, of which no tooth has its own, is there contact between A and E only, and are
  !> pairs
  !> not coupled?
  pure logical function are_alike(a, b)
    type(oscillator_t), intent(in) :: a, b

    are_alike = .not. (a%mesh%deviations%any() .or. b%mesh%deviations%any() .or. &
                       a%mesh%reaches_beyond() .or. b%mesh%reaches_beyond() .or. &
                       (a%shared > 0 .and. a%mesh%is_coupled(a%pairs)))
    are_alike = are_alike .and. .not. any(abs([a%mass - b%mass, a%load - b%load, a%damping_ratio - b%damping_ratio, &
                                               a%friction - b%friction, a%shared - b%shared]) > 0)
    are_alike = are_alike .and. all(a%mesh%teeth == b%mesh%teeth)
    are_alike = are_alike .and. (a%has_backlash .eqv. b%has_backlash)
    if (are_alike) are_alike = all(shape(a%mesh%stiffness%coef) == shape(b%mesh%stiffness%coef))
    if (are_alike) are_alike = .not. any(abs(a%mesh%stiffness%coef - b%mesh%stiffness%coef) > 0)
  end function are_alike

  !> Whether a curve is a part of another one, and which part, up to rounding.
  pure subroutine compare_curves(curve, whole, part, is_part)
    type(piecewise_t), intent(in) :: curve, whole
    real(dp), intent(out) :: part
    logical, intent(out) :: is_part
    real(dp), parameter :: rounding = 1e-13_dp
    real(dp) :: largest

    part = 0
    is_part = .not. any(abs(curve%coef) > 0)
    if (is_part) return
    is_part = all(shape(curve%coef) == shape(whole%coef))
    if (.not. is_part) return
    largest = maxval(abs(whole%coef))
    part = sum(curve%coef*whole%coef)/sum(whole%coef**2)
    is_part = all(abs(curve%breaks - whole%breaks) <= rounding*maxval(abs(whole%breaks))) .and. &
              all(abs(curve%coef - part*whole%coef) <= rounding*largest)
  end subroutine compare_curves
end module gearsweep_relief_family
