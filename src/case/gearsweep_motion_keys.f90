!> What a case says of the motion: &dynamics, &sweep and &numerics.
module gearsweep_motion_keys
  use gearsweep_kinds, only: dp
  use gearsweep_case, only: case_t
  use gearsweep_coefficient_table, only: scheme_collocation, scheme_constant, scheme_rk4, scheme_rk4_equal
  use gearsweep_error, only: error_t
  use gearsweep_reader, only: reader_t
  use gearsweep_sweep_state, only: all_motions, both, down, each, up
  use gearsweep_steady_motion, only: by_marching, by_shooting
  use gearsweep_task, only: stage
  use gearsweep_uses, only: sentence_length
  implicit none
  private
  public :: read_dynamics, read_sweep, read_numerics

contains

  subroutine read_dynamics(reader, case, error)
    type(reader_t), intent(inout) :: reader
    type(case_t), intent(inout) :: case
    type(error_t), allocatable, intent(inout) :: error

    call reader%get('dynamics', 'damping_ratio', case%damping_ratio, error, tasks=case%tasks_for(stage%losses), at_least=0.0_dp, &
                    at_most=1000.0_dp, meaning='damping ratio zeta; the damping force follows the stiffness of the pairs in '// &
                    'contact and vanishes when no flanks touch')
    call reader%get('dynamics', 'friction', case%friction, error, tasks=case%tasks_for(stage%motion), &
                    at_least=0.0_dp, below=1.0_dp, &
                    meaning='coefficient of friction, with the sign of the sliding before and after the pitch point')
  end subroutine read_dynamics

  subroutine read_sweep(reader, case, error)
    type(reader_t), intent(inout) :: reader
    type(case_t), intent(inout) :: case
    type(error_t), allocatable, intent(inout) :: error
    character(*), parameter :: ways(*) = [character(4) :: 'both', 'up', 'down', 'each', 'all']
    integer, parameter :: directions(*) = [both, up, down, each, all_motions]
    character(:), allocatable :: direction
    character(sentence_length) :: over_speed

    over_speed = case%tasks_for(stage%speeds)
    call reader%get('sweep', 'rpm_first', case%rpm_first, error, unit='1/min', required=.true., tasks=over_speed, &
                    at_least=1e-6_dp, at_most=1e9_dp, meaning='first speed of the pinion')
    call reader%get('sweep', 'rpm_last', case%rpm_last, error, unit='1/min', required=.true., tasks=over_speed, &
                    at_least=1e-6_dp, at_most=1e9_dp, meaning='speed beyond which no speed lies; not below rpm_first')
    call reader%get('sweep', 'rpm_step', case%rpm_step, error, unit='1/min', required=.true., tasks=over_speed, &
                    at_least=1e-9_dp, meaning='step from one speed to the next; speeds times reliefs may be at most 1e7')
    direction = 'both'
    call reader%get('sweep', 'direction', direction, error, tasks=case%tasks_for(stage%direction), allowed=ways, &
                    meaning='where several steady motions exist: follow the one found at the speed below (up), at the speed '// &
                    'above (down), or up and, where that loses contact, down too, and take the one of larger dynamic factor '// &
                    '(both); or take each speed by itself (each), and in the sweep also tell how many motions attract there (all)')
    case%direction = sum(pack(directions, ways == direction))
  end subroutine read_sweep

  subroutine read_numerics(reader, case, error)
    type(reader_t), intent(inout) :: reader
    type(case_t), intent(inout) :: case
    type(error_t), allocatable, intent(inout) :: error
    character(*), parameter :: methods(*) = [character(11) :: 'collocation', 'rk4', 'rk4_equal', 'constant']
    integer, parameter :: schemes(*) = [scheme_collocation, scheme_rk4, scheme_rk4_equal, scheme_constant]
    character(:), allocatable :: method

    method = 'collocation'
    call reader%get('numerics', 'method', method, error, tasks=case%tasks_for(stage%accuracy), allowed=methods, &
                    meaning='how the equation of motion is integrated: Gauss collocation with changes of contact located '// &
                    '(collocation), or as in the literature, to reproduce it: Runge-Kutta in steps that end at the breaks '// &
                    '(rk4), in equal steps (rk4_equal, Dogan et al. 2021), or the exact motion over equal steps with '// &
                    'constant coefficients (constant, Karpat et al. 2012)')
    case%accuracy%scheme = sum(pack(schemes, methods == method))
    associate (accuracy => case%accuracy)
      call reader%get('numerics', 'steps_per_period', accuracy%steps, error, tasks=case%tasks_for(stage%accuracy), at_least=0, &
                      at_most=accuracy%most_steps, meaning='steps in a mesh period, about, as steps end where stiffness or '// &
                      'relief has a break; 0 chooses them for the tolerance at each speed, or 200 by the methods of the literature')
      call reader%get('numerics', 'tolerance', accuracy%steady%tolerance, error, tasks=case%tasks_for(stage%accuracy), &
                      at_least=1e-11_dp, at_most=0.1_dp, meaning='largest estimated error of a dynamic factor; the search for '// &
                      'the optimum relief uses 1e-5 where this is smaller')
      method = 'shooting'
      call reader%get('numerics', 'steady_state', method, error, tasks=case%tasks_for(stage%accuracy), &
                      allowed=[character(8) :: 'shooting', 'march'], &
                      meaning='how the steady motion is found: Newton''s method on the map of one period (shooting), or '// &
                      'marching until the transients have died out (march)')
      accuracy%steady%method = merge(by_marching, by_shooting, method == 'march')
    end associate
  end subroutine read_numerics
end module gearsweep_motion_keys
