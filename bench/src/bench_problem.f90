!> A problem of the benchmark: a prescribed mesh over speeds and reliefs, from
!> the text of a case.
module bench_problem
  use bench_tools, only: check
  use gearsweep, only: case_t, study_t, oscillator_t, error_t, read_case, run_study, dp
  use gearsweep_case, only: speeds, task_names
  use gearsweep_files, only: read_text
  implicit none
  private
  public :: problem_t, read_problem, write_problem

  type :: problem_t
    type(case_t) :: case
    type(oscillator_t), allocatable :: osc(:)    !< one for each relief
    real(dp), allocatable :: rpm(:)
  end type problem_t

contains

  !> Builds the oscillators and solves nothing.
  subroutine read_problem(path, problem)
    character(*), intent(in) :: path
    type(problem_t), intent(out) :: problem
    type(study_t) :: study
    type(error_t), allocatable :: error
    character(:), allocatable :: text

    call read_text(path, text, error)
    call check(error)
    call read_case(text, problem%case, error)
    call check(error)
    problem%rpm = speeds(problem%case)
    problem%case%wants = task_names == 'mesh'
    call run_study(problem%case, '', 1, study, error)
    call check(error)
    problem%osc = study%motion
  end subroutine read_problem

  !> For the other contenders, in SI: teeth and contact ratio; masses, load and
  !> damping ratio; stiffness; reliefs, linear and alike for both members from
  !> the HPSTC; speeds. Each list follows its length.
  subroutine write_problem(problem)
    type(problem_t), intent(in) :: problem
    character(*), parameter :: numbers = '(*(es24.16e3, 1x))'

    associate (osc => problem%osc(1), case => problem%case)
      if (any(case%fraction /= 1) .or. case%start /= 'hpstc' .or. case%friction > 0 .or. case%has_backlash) &
        error stop 'the other contenders know neither friction nor backlash, and short reliefs on both members only'
      print numbers, real(osc%mesh%teeth(1), dp), osc%mesh%contact_ratio
      print numbers, osc%mass, osc%load, osc%damping_ratio
      print '(i0)', size(case%coefficients)
      print numbers, case%coefficients
      print '(i0)', size(case%amount)
      print numbers, case%amount
      print '(i0)', size(problem%rpm)
      print numbers, problem%rpm
    end associate
  end subroutine write_problem
end module bench_problem
