!> What a case says of the motion: &dynamics, &sweep and &numerics.
module gearsweep_motion_keys
  use gearsweep_kinds, only: dp
  use gearsweep_case, only: case_t
  use gearsweep_error, only: error_t
  use gearsweep_reader, only: reader_t
  use gearsweep_steady, only: by_marching, by_shooting
  use gearsweep_sweep, only: down, each, up
  use gearsweep_uses, only: for_tasks, with_motion
  implicit none
  private
  public :: read_dynamics, read_sweep, read_numerics

contains

  subroutine read_dynamics(reader, case, error)
    type(reader_t), intent(inout) :: reader
    type(case_t), intent(inout) :: case
    type(error_t), allocatable, intent(inout) :: error

    call reader%get('dynamics', 'damping_ratio', case%damping_ratio, error, waits=for_tasks(case, with_motion), &
                    at_least=0.0_dp, at_most=1000.0_dp)
    call reader%get('dynamics', 'friction', case%friction, error, waits=for_tasks(case, with_motion), &
                    at_least=0.0_dp, below=1.0_dp)
  end subroutine read_dynamics

  subroutine read_sweep(reader, case, error)
    type(reader_t), intent(inout) :: reader
    type(case_t), intent(inout) :: case
    type(error_t), allocatable, intent(inout) :: error
    character(*), parameter :: ways(*) = [character(4) :: 'up', 'down', 'each'], over_speed = 'sweep or optimum'
    integer, parameter :: directions(*) = [up, down, each]
    character(:), allocatable :: direction

    call reader%get('sweep', 'rpm_first', case%rpm_first, error, required=.true., waits=for_tasks(case, over_speed), &
                    at_least=1e-6_dp, at_most=1e9_dp)
    call reader%get('sweep', 'rpm_last', case%rpm_last, error, required=.true., waits=for_tasks(case, over_speed), &
                    at_least=1e-6_dp, at_most=1e9_dp)
    call reader%get('sweep', 'rpm_step', case%rpm_step, error, required=.true., waits=for_tasks(case, over_speed), &
                    at_least=1e-9_dp)
    direction = 'up'
    call reader%get('sweep', 'direction', direction, error, waits=for_tasks(case, over_speed), allowed=ways)
    call reader%get('sweep', 'load_rpm', case%load_rpm, error, required=.true., waits=for_tasks(case, 'load'), &
                    at_least=1e-6_dp, at_most=1e9_dp, max_size=1000)
    case%direction = sum(pack(directions, ways == direction))
  end subroutine read_sweep

  subroutine read_numerics(reader, case, error)
    type(reader_t), intent(inout) :: reader
    type(case_t), intent(inout) :: case
    type(error_t), allocatable, intent(inout) :: error
    character(:), allocatable :: method

    associate (accuracy => case%accuracy)
      call reader%get('numerics', 'steps_per_period', accuracy%steps, error, waits=for_tasks(case, with_motion), &
                      at_least=0, at_most=accuracy%most_steps)
      call reader%get('numerics', 'tolerance', accuracy%steady%tolerance, error, waits=for_tasks(case, with_motion), &
                      at_least=1e-11_dp, at_most=0.1_dp)
      method = 'shooting'
      call reader%get('numerics', 'steady_state', method, error, waits=for_tasks(case, with_motion), &
                      allowed=[character(8) :: 'shooting', 'march'])
      accuracy%steady%method = merge(by_marching, by_shooting, method == 'march')
    end associate
  end subroutine read_numerics
end module gearsweep_motion_keys
