!> One part of a load spectrum, as the task `life` takes it: the motion, or the static load, and what it does to the tooth roots.
module gearsweep_life_parts
  use gearsweep_case_variation, only: case_variation_t, of_force
  use gearsweep_error, only: error_t
  use gearsweep_fatigue, only: curve_t, strength_t
  use gearsweep_flank_paths, only: follow_motion, follow_static, path_t
  use gearsweep_kinds, only: dp
  use gearsweep_largest_motion, only: find_motion
  use gearsweep_oscillator, only: oscillator_t
  use gearsweep_response, only: response_t
  use gearsweep_root_life, only: root_life, root_life_t
  use gearsweep_stages, only: stages_t
  use gearsweep_status, only: has_result, status_ok
  implicit none
  private
  public :: life_rule_t, part_t, follow_part

  !> How loads become damage.
  type :: life_rule_t
    logical :: dynamic_load = .true.             !< that of the motion; otherwise the static one
    real(dp) :: stress_factor = 1                !< what raises the stress besides
    real(dp) :: stress_ratio = 0                 !< least stress of a revolution over its largest
    type(strength_t) :: strength
    type(curve_t) :: curve
  end type life_rule_t

  !> What a part of the spectrum does with one relief.
  type :: part_t
    integer :: status = status_ok                !< of the motion
    integer :: motions = 0                       !< how many there are; 0: not known, or no motion
    real(dp) :: dynamic_factor = 0               !< NaN for the static load
    real(dp) :: engagements(2) = 0               !< of a tooth of each gear
    type(root_life_t) :: root(2)
  end type part_t

contains

  !> One engagement after the other at one speed and load. `error`: the memory does not hold the motion.
  subroutine follow_part(stages, relief, rpm, load_factor, duration, rule, part, error)
    type(stages_t), intent(in) :: stages
    integer, intent(in) :: relief                !< its number among those of the case
    real(dp), intent(in) :: rpm                  !< speed of the pinion, 1/min
    real(dp), intent(in) :: load_factor          !< load over that of the case
    real(dp), intent(in) :: duration             !< s
    type(life_rule_t), intent(in) :: rule
    type(part_t), intent(out) :: part
    type(error_t), allocatable, intent(inout) :: error
    type(case_variation_t) :: case
    type(oscillator_t) :: osc
    type(response_t) :: response
    type(path_t) :: path
    real(dp) :: factor
    integer :: i

    case = case_variation_t(stages%motions_inputs, stages%amount(relief))
    call case%set(of_force, stages%load*load_factor)
    call case%build(osc, error)
    if (allocated(error)) return
    if (.not. rule%dynamic_load) then
      call follow_static(stages%pair, osc, path)
    else
      call find_motion(osc, rpm, stages%accuracy, response, part%motions)
      call follow_motion(stages%pair, response, osc%load, '&life rpm', path, error)
      if (allocated(error)) return
    end if
    part%status = path%status
    part%dynamic_factor = path%dynamic_factor
    associate (teeth => stages%pair%gear%spec%teeth)
      part%engagements = rpm/60*duration*teeth(1)/teeth
    end associate
    if (.not. has_result(part%status)) return
    factor = rule%stress_factor*stages%iso%application_factor
    do i = 1, 2
      part%root(i) = root_life(stages%pair, i, path%pair, path%s, factor*path%load, stages%iso%rim_thickness(i), &
                               rule%stress_ratio, rule%strength, rule%curve)
    end do
  end subroutine follow_part
end module gearsweep_life_parts
