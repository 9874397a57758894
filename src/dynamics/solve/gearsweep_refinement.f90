!> How many steps a tolerance needs. The numbers of steps come in refinement levels of 2**(1/3), so that many speeds
!> share the coefficients of a level.
module gearsweep_refinement
  use gearsweep_coefficients, only: resolution_t
  use gearsweep_error_estimate, only: accuracy_t
  use gearsweep_gauss, only: order
  use gearsweep_kinds, only: dp
  use gearsweep_oscillator, only: oscillator_t, resolving_steps
  use gearsweep_period_map, only: discretise, period_map_t
  implicit none
  private
  public :: levels_t, forget_levels, resolution_of, level_steps, level_for, first_level, last_level, search_level
  public :: need_level, need_batch_level, next_level
  public :: first_guess, root, need_given, given_resolution, given_steps

  real(dp), parameter :: root = 1.0_dp/order

  !> Half the steps lie so many levels below.
  integer, parameter, public :: per_doubling = 3
  integer, parameter :: most_levels = 48

  type :: level_t
    type(period_map_t), allocatable :: map
  end type level_t

  !> The levels discretised so far, and where the next operating point may begin.
  type :: levels_t
    type(level_t) :: level(0:most_levels)
    logical :: made(0:most_levels) = .false.
    type(level_t) :: given(2)                    !< where the number of steps is given: that, and half of it
    logical :: given_made = .false.
    logical :: lacks = .false.                   !< the memory did not hold one: points have no result
    real(dp) :: steps_per_second = 0             !< that the last point needed, over its period
  end type levels_t

contains

  !> Another oscillator comes: what is discretised does not hold for it, but its memory serves again.
  pure subroutine forget_levels(levels)
    type(levels_t), allocatable, intent(inout) :: levels

    if (.not. allocated(levels)) allocate (levels)
    levels%made = .false.
    levels%given_made = .false.
  end subroutine forget_levels

  !> The resolution of a level.
  elemental type(resolution_t) function resolution_of(level)
    integer, intent(in) :: level

    resolution_of = resolution_t(6*2**(modulo(level, per_doubling)/real(per_doubling, dp)), 2**(level/per_doubling))
  end function resolution_of

  !> Steps of a period at a level, before those that the breaks add.
  elemental real(dp) function level_steps(level)
    integer, intent(in) :: level

    level_steps = 6*2**(level/real(per_doubling, dp))
  end function level_steps

  !> The lowest level with at least so many steps that has one of half as many.
  pure integer function level_for(steps) result(level)
    real(dp), intent(in) :: steps                !< of a period

    level = min(most_levels, &
                per_doubling + max(0, ceiling(per_doubling*log(max(steps, 12.0_dp)/12)/log(2.0_dp) - 1e-9_dp)))
  end function level_for

  !> The level at which an operating point begins, above which its natural motion is followed.
  pure integer function first_level(osc, duration, options, levels) result(level)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration             !< of the mesh period, s
    type(accuracy_t), intent(in) :: options
    type(levels_t), intent(in) :: levels

    level = level_for(max(2*resolving_steps(osc, duration), first_guess(osc, duration, options, levels)))
  end function first_level

  !> The level on which motions are looked for. It follows from the oscillator and the speed alone, so that which motion
  !> is found depends neither on the tolerance nor on what else is solved.
  pure integer function search_level(osc, duration, options) result(level)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration             !< of the mesh period, s
    type(accuracy_t), intent(in) :: options
    real(dp), parameter :: per_radian = 1.5_dp, fewest = 24

    level = level_for(max(fewest, per_radian*osc%natural_frequency*duration, 2*resolving_steps(osc, duration)))
    level = min(level, last_level(osc, options))
  end function search_level

  !> The highest level that the options and the memory allow.
  pure integer function last_level(osc, options) result(level)
    type(oscillator_t), intent(in) :: osc
    type(accuracy_t), intent(in) :: options
    real(dp) :: steps

    steps = options%most_steps*min(1.0_dp, 4.0_dp/osc%contacts)
    level = min(most_levels, floor(per_doubling*log(steps/6)/log(2.0_dp) + 1e-9_dp))
  end function last_level

  !> Discretises a level and that of half its steps, unless they are there. Of large ones no others are kept: one of
  !> 2**18 steps takes 0.2 GB.
  pure subroutine need_level(osc, level, levels)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: level
    type(levels_t), intent(inout) :: levels      !< lacks: the memory does not hold them
    real(dp), parameter :: large = 2**15
    integer :: i

    do i = 0, merge(most_levels, -1, level_steps(level) > large .and. .not. levels%made(level))
      if (level_steps(i) <= large .or. i == level - per_doubling) cycle
      if (allocated(levels%level(i)%map)) deallocate (levels%level(i)%map)
      levels%made(i) = .false.
    end do
    do i = level - per_doubling, level, per_doubling
      if (.not. allocated(levels%level(i)%map)) allocate (levels%level(i)%map)
      if (.not. levels%made(i)) call discretise(osc, resolution_of(i), levels%level(i)%map)
      levels%made(i) = levels%level(i)%map%table%steps > 0
      if (.not. levels%made(i)) levels%lacks = .true.
    end do
  end subroutine need_level

  !> The same for a batch of speeds, whose coefficients are to stay small and to follow the natural motion at all of them.
  pure subroutine need_batch_level(osc, level, longest, options, levels, ready)
    type(oscillator_t), intent(in) :: osc
    integer, intent(in) :: level
    real(dp), intent(in) :: longest              !< duration of the mesh period at the lowest speed, s
    type(accuracy_t), intent(in) :: options
    type(levels_t), intent(inout) :: levels      !< lacks: the memory does not hold them
    logical, intent(out) :: ready                !< false: the speeds are for one by one
    real(dp), parameter :: most = 4096

    ready = level_steps(level) <= min(most, real(options%most_steps, dp)) .and. &
            level_steps(level) >= 2*resolving_steps(osc, longest)
    if (ready) call need_level(osc, level, levels)
    ready = ready .and. .not. levels%lacks
  end subroutine need_batch_level

  !> Discretises the number of steps that is given, and half of it, unless they are there.
  pure subroutine need_given(osc, options, levels)
    type(oscillator_t), intent(in) :: osc
    type(accuracy_t), intent(in) :: options
    type(levels_t), intent(inout) :: levels      !< lacks: the memory does not hold them
    type(resolution_t) :: resolution
    integer :: i

    if (levels%given_made) return
    do i = 1, 2
      resolution = given_resolution(options)
      resolution%times = resolution%times/i
      if (.not. allocated(levels%given(i)%map)) allocate (levels%given(i)%map)
      call discretise(osc, resolution, levels%given(i)%map)
      levels%lacks = levels%lacks .or. levels%given(i)%map%steps == 0
    end do
    levels%given_made = .not. levels%lacks
  end subroutine need_given

  !> The resolution where the number of steps is given.
  pure type(resolution_t) function given_resolution(options) result(resolution)
    type(accuracy_t), intent(in) :: options

    resolution = resolution_t(given_steps(options)/2.0_dp, 2, scheme=options%scheme)
  end function given_resolution

  !> The number of steps that is given; where it is left out, that of Karpat et al. 2012.
  pure integer function given_steps(options) result(steps)
    type(accuracy_t), intent(in) :: options
    integer, parameter :: of_the_literature = 200

    steps = options%steps
    if (steps == 0) steps = of_the_literature
  end function given_steps

  !> Whether the error of a level is small enough; if not, the level to try next.
  pure subroutine next_level(osc, options, step_error, duration, levels, level, done)
    type(oscillator_t), intent(in) :: osc
    type(accuracy_t), intent(in) :: options
    real(dp), intent(in) :: step_error           !< of the dynamic factor
    real(dp), intent(in) :: duration             !< of the mesh period, s
    type(levels_t), intent(inout) :: levels      !< learns how many steps are needed
    integer, intent(inout) :: level
    logical, intent(out) :: done
    real(dp) :: excess

    excess = min(step_error/options%steady%tolerance, 1e8_dp)
    levels%steps_per_second = level_steps(level)*min(max((2.5_dp*excess)**root, 0.5_dp), 2.0_dp)/duration
    done = excess <= 1 .or. level >= last_level(osc, options)
    if (.not. done) level = min(level_for(level_steps(level)*min(1.1_dp*excess**root, 4.0_dp)), last_level(osc, options))
  end subroutine next_level

  !> Steps of a period that the tolerance may need: as the last point did, or by the angle that the natural motion goes
  !> through in the period.
  pure real(dp) function first_guess(osc, duration, options, levels) result(steps)
    type(oscillator_t), intent(in) :: osc
    real(dp), intent(in) :: duration             !< of the mesh period, s
    type(accuracy_t), intent(in) :: options
    type(levels_t), intent(in) :: levels

    if (levels%steps_per_second > 0) then
      steps = levels%steps_per_second*duration
    else
      steps = 1.2_dp*osc%natural_frequency*duration*(1e-6_dp/options%steady%tolerance)**root
    end if
    steps = max(steps, 12*(1e-6_dp/options%steady%tolerance)**root)
  end function first_guess
end module gearsweep_refinement
